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
 * Largest differences of pictures with which a row is reported (Difference: mean over the covered
 * pixels, of 255, and part of the covered pixels with outliers). Two ray casters differ by how
 * they round: vtkFixedPointVolumeRayCastMapper takes shading from encoded gradients of the voxels
 * and quantised positions; resampling interpolates twice.
 */
struct Tolerance
{
  double Mean;
  double Outliers;
};
constexpr Tolerance FixedPointTolerance{ 8.0, 0.05 }; ///< ours undeformed by fixed point
constexpr Tolerance ResampleTolerance{ 10.0, 0.08 };  ///< resample routes by ours
constexpr Tolerance OracleTolerance{ 0.5, 0.002 };    ///< ours by its reference kernels
constexpr Tolerance PaperTolerance{ 2.0, 0.01 };      ///< the paper's polyline by the true curve

/// All groups of the chosen mode. Names: Frame/<volume>/<opacity>/<size>/<deformation>,
/// Drag/<side>, Edit/<side>, Limit.
std::vector<std::unique_ptr<Group>> MakeGroups(const Options& options);

} // namespace ffdBenchmark

#endif
