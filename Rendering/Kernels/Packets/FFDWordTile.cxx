// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Tiles of volumes of integers of 32 bits that are read by PacketWords.
#define FFD_TILE_CASTER CastWordTile
#define FFD_TILE_SCALAR WordScalar
#include "FFDTileCaster-inl.h"
