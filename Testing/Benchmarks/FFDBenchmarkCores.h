// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// How much faster frames and edits are with more threads.
#ifndef FFDBenchmarkCores_h
#define FFDBenchmarkCores_h

#include "FFDBenchmarkGroup.h"
#include "FFDBenchmarkScene.h"

#include <memory>
#include <string>
#include <vector>

namespace ffdBenchmark
{

/// Numbers of threads that are measured, as names of rows: 1, 2, 4, ... up to all processors.
std::vector<std::string> GetThreadCounts();

/**
 * Pictures of the engine made by RenderToImage(), without a window, whose drawing has threads of
 * its own. One row for each number of threads.
 * @param edited one control point moves before each picture
 */
std::shared_ptr<void> PrepareCores(Group& group, const std::string& folder, Opacity opacity,
  int size, const Deformation& deformation, bool edited);

} // namespace ffdBenchmark

#endif
