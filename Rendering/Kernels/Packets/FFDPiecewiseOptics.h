// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPiecewiseOptics_h
#define FFDPiecewiseOptics_h

#include "FFDExport.h"
#include "FFDTransferTable.h"

namespace ffd
{

/**
 * A transfer function as a few linear pieces, which packets look up in registers. Most functions
 * are straight between the few points that the user has set; what a table of them has in between is
 * not needed then.
 */
struct PiecewiseOptics
{
  static constexpr int LargestNumberOfPieces = 16;

  /// Opacity over the unit distance, red, green and blue.
  static constexpr int NumberOfChannels = 4;
  /// Where pieces begin, and the change by a unit of values. Opacities may be below zero where they
  /// are to be 0.
  struct Channel
  {
    alignas(64) float Begin[LargestNumberOfPieces] = {};
    alignas(64) float Slope[LargestNumberOfPieces] = {};
  };

  int Pieces = 0; ///< 0: the function is not made of so few
  /// Values as fetched from which pieces on, ascending; the first and the last value hold beyond.
  alignas(64) float Begin[LargestNumberOfPieces] = {};
  float End = 0.0f;
  Channel Channels[NumberOfChannels];
};

/// Finds the pieces of a table. `low`: the value of its first entry as fetched (PacketVolume);
/// `scale`: entries a unit of these values.
FFD_RENDERING_EXPORT PiecewiseOptics FindPiecewiseOptics(
  const TransferTable& table, double low, double scale);

} // namespace ffd

#endif
