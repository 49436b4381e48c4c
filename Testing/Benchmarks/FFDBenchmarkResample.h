// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDResampleVolume against vtkImageReslice on the same job.
#ifndef FFDBenchmarkResample_h
#define FFDBenchmarkResample_h

#include "FFDBenchmarkGroup.h"

#include <memory>
#include <string>

namespace ffdBenchmark
{

/**
 * Rows "reslice" (vtkImageReslice through a vtkBSplineTransform) and "pullback" (ours, the same
 * map), "reslice_inverse" (through its inverse) and "exact" (ours), "firstorder" (ours): the engine
 * at side^3 voxels on its own grid, deformed by smooth45 scaled with the side. A row of ours is
 * refused when more than 1 in 1000 values differ by more than 1 from those of vtkImageReslice.
 */
std::shared_ptr<void> PrepareResample(
  Group& group, int side, bool cubic, const std::string& folder);

/// How many times faster ours must be.
constexpr double ResampleGain = 3.0;

} // namespace ffdBenchmark

#endif
