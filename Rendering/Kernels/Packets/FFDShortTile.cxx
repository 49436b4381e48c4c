// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Tiles of volumes of integers of 16 bits.
#define FFD_TILE_CASTER CastShortTile
#define FFD_TILE_SCALAR std::uint16_t
#include "FFDTileCaster-inl.h"
