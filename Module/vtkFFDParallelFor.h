// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the project: not installed.
#ifndef vtkFFDParallelFor_h
#define vtkFFDParallelFor_h

#include "vtkFFDCoreModule.h" // For export macro

#include <chrono>
#include <cstddef>
#include <functional>

/**
 * Splits loops over threads of vtkSMPTools, as the kernels ask for it (ffd::ParallelFor). The
 * number of threads is that of the object, not of the process: so many workers, at most, take
 * pieces of the loop in turn. Several threads may do this at the same time, each with objects of
 * its own.
 */
class vtkFFDParallelFor
{
public:
  using Clock = std::chrono::steady_clock;

  /// Is told how much of a loop is done, 0 to 1, once `Due()` has passed: by the thread that runs
  /// the loop, while the others rest. `Report` may throw to end the loop.
  struct Listener
  {
    std::function<Clock::time_point()> Due;
    std::function<void(double part)> Report;
  };

  /// 0: as many threads as vtkSMPTools uses.
  VTKFFDCORE_EXPORT explicit vtkFFDParallelFor(int threads = 0, Listener listener = Listener());

  int GetNumberOfWorkers() const { return this->Workers; }

  /// Runs work(i) for each i in [0, GetNumberOfWorkers()), at the same time as far as there are
  /// threads: whichever starts first must be able to do all the work.
  VTKFFDCORE_EXPORT void RunWorkers(const std::function<void(int worker)>& work) const;

  /// Runs work(first, last) over [0, count), in pieces of one size.
  VTKFFDCORE_EXPORT void operator()(
    std::size_t count, const std::function<void(std::size_t first, std::size_t last)>& work) const;

private:
  int Workers;
  Listener Progress;
};

#endif
