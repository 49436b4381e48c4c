// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Tiles of volumes of numbers of single precision.
#define FFD_TILE_CASTER CastFloatTile
#define FFD_TILE_SCALAR float
#include "FFDTileCaster-inl.h"
