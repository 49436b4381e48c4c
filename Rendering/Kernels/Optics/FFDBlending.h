// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDBlending_h
#define FFDBlending_h

#include "FFDExport.h"
#include "FFDTransferTable.h"

#include <glm/vec3.hpp>

#include <cmath>
#include <limits>
#include <vector>

namespace ffd
{

/// The blend modes of vtkVolumeMapper: rules that combine the samples of a ray.
enum class BlendMode
{
  Composite,  ///< front to back, opacities corrected for the lengths of intervals
  Maximum,    ///< color and opacity of the largest value
  Minimum,    ///< color and opacity of the smallest value
  Average,    ///< mean of value times opacity, gray
  Additive,   ///< integral of value times opacity, gray
  Isosurface, ///< lit surfaces where the value crosses one of those given
  Slice       ///< the values on a plane
};

/// A value whose isosurface is shown, its color and its opacity.
struct IsoValue
{
  double Value;
  glm::vec3 Color;
  float Opacity;
};

/// The blend mode and all that it takes. Arrays are indexed by channel: dependent components are
/// one, see SampleClassifier::GetNumberOfChannels().
struct Blending
{
  static constexpr int LargestNumberOfComponents = 4;

  BlendMode Mode = BlendMode::Composite;

  /// Values of Isosurface in ascending order: intensities of the channel IsoComponent.
  std::vector<IsoValue> IsoValues;
  int IsoComponent = 0;

  /// The range of Average: other values do not count.
  double AverageMin = -std::numeric_limits<double>::infinity();
  double AverageMax = std::numeric_limits<double>::infinity();

  /// The range of the values: ends that Maximum and Minimum cannot pass, and black and white of
  /// Average and Additive. Of dependent components that of what is looked up for opacity, or that
  /// of the intensity.
  double Low[LargestNumberOfComponents] = { 0.0, 0.0, 0.0, 0.0 };
  double High[LargestNumberOfComponents] = { 1.0, 1.0, 1.0, 1.0 };
  double Weight[LargestNumberOfComponents] = { 1.0, 1.0, 1.0, 1.0 };
  /// The unit distance of Additive: the length, data units, over which a value of full opacity
  /// counts once.
  double UnitDistance[LargestNumberOfComponents] = { 1.0, 1.0, 1.0, 1.0 };

  /// The plane of Slice, data coordinates.
  glm::dvec3 SliceOrigin{ 0.0 };
  glm::dvec3 SliceNormal{ 0.0, 0.0, 1.0 };

  /// Whether what is between two samples matters, not the samples.
  bool UsesIntervals() const { return this->Mode == BlendMode::Isosurface; }
};

/**
 * Makes the table of the distance map, `leaps`, from the transfer function of the picture, `table`.
 * It is transparent over a range of values exactly if no sample in that range can change the
 * picture, so that blocks of such values can be leaped over. An interval counts as empty if both of
 * its ends lie in such blocks. Returns false where every sample counts: then nothing may be leaped
 * over.
 */
FFD_RENDERING_EXPORT bool MakeLeapTable(
  const Blending& blend, const TransferTable& table, TransferTable& leaps);

/**
 * Part of a sample interval, 0 to 0.98, by which the samples of a ray are moved on: trades the
 * rings of samples on equal depths for noise. A low-discrepancy pattern over the pixels.
 */
inline double FindJitter(int x, int y)
{
  const auto fraction = [](double v) { return v - std::floor(v); };
  // Weights of the generalized golden ratio in two dimensions.
  return 0.98 * fraction(0.7548776662466927 * x + 0.5698402909980532 * y);
}

} // namespace ffd

#endif
