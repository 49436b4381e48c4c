// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPiecewiseOptics_h
#define FFDPiecewiseOptics_h

#include "FFDExport.h"
#include "FFDTransferTable.h"

#include <vector>

namespace ffd
{

/**
 * A transfer function as a few linear pieces, which packets look up in registers. Most functions
 * are straight between the few points that the user has set; what a table of them has in between is
 * not needed then.
 */
struct PiecewiseOptics
{
  static constexpr int LargestNumberOfPieces = 32;

  /// Opacity over Length, red, green and blue.
  static constexpr int NumberOfChannels = 4;
  /// Where pieces begin, and the change by a unit of values. Opacities may be below zero where they
  /// are to be 0.
  struct Channel
  {
    alignas(64) float Begin[LargestNumberOfPieces] = {};
    alignas(64) float Slope[LargestNumberOfPieces] = {};
  };

  float Length = 1.0f; ///< data units that opacities are over
  int Pieces = 0;      ///< 0: the function is not made of so few
  /// Values as fetched from which pieces on, ascending, and infinity behind them; the first and the
  /// last value hold beyond.
  alignas(64) float Begin[LargestNumberOfPieces] = {};
  float End = 0.0f;
  Channel Channels[NumberOfChannels];
};

/// Largest differences of pieces from the entries of a table: of opacities a part of each and a
/// little, and of colors. Pictures differ by less than the last and 0.4 of the first: an optical
/// depth x that is wrong by a part of it, by that part of x exp(-x).
struct PieceTolerance
{
  double Relative = 2e-3;
  double Least = 1e-6;
  double Color = 1.0 / 1024.0;
};

/// What is as straight as single precision tells, so that differences of opacities are those of the
/// table; colors have no meaning.
constexpr PieceTolerance StraightOpacities{ 1e-5, 1e-7, 1.0 };

/// Finds the pieces of a table. `low`: the value of its first entry as fetched (PacketVolume);
/// `scale`: entries a unit of these values; `length`: that opacities are over, in data units.
FFD_RENDERING_EXPORT PiecewiseOptics FindPiecewiseOptics(const TransferTable& table, double low,
  double scale, double length, const PieceTolerance& tolerance = {});

/// Finds the pieces of factors of opacities, which take the place of these, by the number of the
/// factor; colors are black.
FFD_RENDERING_EXPORT PiecewiseOptics FindPiecewiseFactors(const std::vector<float>& factors);

} // namespace ffd

#endif
