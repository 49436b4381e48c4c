// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What is measured: the groups of competing configurations.
#ifndef FFDBenchmarkSuites_h
#define FFDBenchmarkSuites_h

#include "FFDBenchmarkGroup.h"

#include <memory>
#include <string>
#include <vector>

namespace ffdBenchmark
{

struct Options
{
  std::string DataFolder;
  bool Quick = false;
  int Rounds = 0; ///< of each row; 0: the row's own number
};

/**
 * Largest differences of pictures with which a row is reported, see Difference. Two ray casters
 * never agree in every pixel: resampling interpolates twice, the paper's polyline has its samples
 * elsewhere. vtkFixedPointVolumeRayCastMapper rounds values and normals, so it judges no frame of
 * ours.
 */
struct Tolerance
{
  int Block; ///< pixels
  double Mean;
  double Outliers;
};
constexpr Tolerance BlendTolerance{ 8, 12.0, 0.05 };    ///< blend modes by VTK's mappers
constexpr Tolerance ResampleTolerance{ 8, 12.0, 0.05 }; ///< resample routes by ours
/// The paper's polyline by the curve. Its samples count from where a ray enters the volume, and are
/// equidistant in the volume at rest, not on the viewing ray: where the material ends with the
/// volume, as on the engine's front, they are all equally deep in it, and elsewhere at other
/// depths.
constexpr Tolerance PaperTolerance{ 8, 12.0, 0.3 };
constexpr Tolerance OracleTolerance{ 1, 0.5, 0.002 }; ///< ours by its reference kernels

/// All groups of the chosen mode. Names: Frame/<volume>/<opacity>/<size>/<deformation>,
/// Drag/<side>, Edit/<side>, Resample/<side>/<interpolation>, Blend/<mode>,
/// Composite/<what>, Limit.
std::vector<std::unique_ptr<Group>> MakeGroups(const Options& options);

} // namespace ffdBenchmark

#endif
