// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What users switch on, by the same scene without it.
#ifndef FFDBenchmarkOptions_h
#define FFDBenchmarkOptions_h

#include "FFDBenchmarkGroup.h"

#include <memory>
#include <string>
#include <vector>

namespace ffdBenchmark
{

/// An option of the mapper, the property or the input, and what a frame with it may take.
struct FrameOption
{
  const char* Name; ///< of its row
  const char* By;   ///< the row that it is compared with
  double Limit;     ///< of the ratio of their times; NaN: there is none
};

/// All of them; rows without a limit are what others are compared with, or VTK's.
const std::vector<FrameOption>& GetFrameOptions();

/**
 * Frames of an opaque, shaded volume (its points 8-bit numbers), one row for each option. A row
 * whose picture is not that of the reference kernels is refused.
 * @param deformed a lattice that bends the volume by 45 voxels in 256; false: none
 */
std::shared_ptr<void> PrepareOptions(
  Group& group, const std::string& folder, const std::string& volume, bool deformed);

} // namespace ffdBenchmark

#endif
