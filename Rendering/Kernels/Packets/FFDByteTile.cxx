// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Tiles of volumes of integers of 8 bits.
#define FFD_PERMUTES_BYTES
#define FFD_TILE_CASTER CastByteTile
#define FFD_TILE_SCALAR std::uint8_t
#include "FFDTileCaster-inl.h"
