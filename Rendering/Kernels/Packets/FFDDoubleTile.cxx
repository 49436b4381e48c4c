// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Tiles of volumes of numbers of double precision, and of all types that no other file is for.
#define FFD_TILE_CASTER CastDoubleTile
#define FFD_TILE_SCALAR double
#include "FFDTileCaster-inl.h"
