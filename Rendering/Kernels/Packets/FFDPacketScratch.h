// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketScratch_h
#define FFDPacketScratch_h

#include "FFDCastScene.h"
#include "FFDTileSegment.h"

#include <array>
#include <vector>

namespace ffd
{

/// A position that was sampled, for measurements of its error: pixel, t (PacketRays), and index
/// coordinates.
struct SampledPosition
{
  int X;
  int Y;
  float T;
  float Index[3];
};

/// The samples that any ray of a packet takes.
struct SampleRange
{
  bool IsCast = false; ///< whether there are rays
  int First = 0;
  int End = 0; ///< behind the last one
};

/// Buffers that a thread keeps between tiles.
struct PacketScratch
{
  SegmentRoots Roots;
  /// Of the rays of a tile: the ranges of t (from, to), SampleNumbers, inverse lengths.
  std::array<float, 6 * TileSide * TileSide> Rays;
  std::array<SampleRange, TileSide * TileSide> SampleRanges; ///< of its packets
  /// Voxels around samples at faces of the volume: 4 x 4 x 4 of up to 32 bytes for each of 16
  /// lanes, and what vectors may read beyond them.
  alignas(64) std::array<unsigned char, 16 * 64 * 32 + 16> BorderVoxels;
  CastStatistics Statistics;
  std::vector<SampledPosition>* Positions = nullptr; ///< to which samples are added, or null
};

} // namespace ffd

#endif
