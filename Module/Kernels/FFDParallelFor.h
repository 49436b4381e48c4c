// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDParallelFor_h
#define FFDParallelFor_h

#include <cstddef>
#include <functional>

namespace ffd
{

/// Runs work(first, last) over [0, count), possibly split over threads. An empty one stands for
/// one thread: see RunFor().
using ParallelFor = std::function<void(std::size_t count,
  const std::function<void(std::size_t first, std::size_t last)>& work)>;

/// work(first, last) over [0, count): by `parallelFor`, or in one go if that is empty.
inline void RunFor(const ParallelFor& parallelFor, std::size_t count,
  const std::function<void(std::size_t first, std::size_t last)>& work)
{
  if (count == 0)
  {
    return;
  }
  if (parallelFor)
  {
    parallelFor(count, work);
  }
  else
  {
    work(0, count);
  }
}

} // namespace ffd

#endif
