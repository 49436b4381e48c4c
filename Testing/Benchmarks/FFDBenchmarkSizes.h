// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// First frames and frames of volumes of many sizes, and errors of pictures by distances of samples.
#ifndef FFDBenchmarkSizes_h
#define FFDBenchmarkSizes_h

#include "FFDBenchmarkGroup.h"

#include <memory>
#include <string>
#include <vector>

namespace ffdBenchmark
{

/// A cube of noise with a ball in it.
struct SizedVolume
{
  const char* Name; ///< <side>/<type>
  int Side;         ///< voxels
  int ScalarType;   ///< VTK's number of it
};

const std::vector<SizedVolume>& GetSizedVolumes();

/**
 * Rows "copy" (the scalars, by one thread), "first" (16 x 16 pixels with scalars that are new: all
 * that is made of them), "second" (the same again), "undeformed" and "bend45" (512 x 512, opaque).
 */
std::shared_ptr<void> PrepareSizes(Group& group, const SizedVolume& volume);

/**
 * An opaque, shaded volume whose opacity is a step, bent: rows "samples 1", "samples 0.25" and
 * "intervals 1" (pre-integrated), 256 x 256. Their counters "mean_error" are mean differences from
 * a sample distance of 0.05 over covered pixels, of 255.
 */
std::shared_ptr<void> PrepareErrors(
  Group& group, const std::string& folder, const std::string& volume);

} // namespace ffdBenchmark

#endif
