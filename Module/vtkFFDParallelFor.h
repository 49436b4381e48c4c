// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the project: not installed.
#ifndef vtkFFDParallelFor_h
#define vtkFFDParallelFor_h

#include "vtkSMPTools.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <utility>

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
  explicit vtkFFDParallelFor(int threads = 0, Listener listener = Listener())
    : Workers(threads > 0 ? threads : std::max(1, vtkSMPTools::GetEstimatedNumberOfThreads()))
    , Progress(std::move(listener))
  {
  }

  int GetNumberOfWorkers() const { return this->Workers; }

  /// Runs worker(i) for each i in [0, GetNumberOfWorkers()), at the same time as far as there are
  /// threads: whichever starts first must be able to do all the work.
  template <class Worker>
  void RunWorkers(const Worker& worker) const
  {
    if (this->Workers == 1)
    {
      worker(0);
      return;
    }
    // An exception, of an allocation for instance, would end the process if it left a thread.
    std::exception_ptr error;
    std::mutex mutex;
    vtkSMPTools::For(
      0, this->Workers, 1, [&worker, &error, &mutex](vtkIdType first, vtkIdType last) {
        try
        {
          for (vtkIdType i = first; i < last; ++i)
          {
            worker(static_cast<int>(i));
          }
        }
        catch (...)
        {
          const std::lock_guard<std::mutex> lock(mutex);
          error = std::current_exception();
        }
      });
    if (error)
    {
      std::rethrow_exception(error);
    }
  }

  /// Runs work(first, last) over [0, count), in pieces of one size.
  void operator()(
    std::size_t count, const std::function<void(std::size_t first, std::size_t last)>& work) const
  {
    const std::size_t piece =
      std::max<std::size_t>(1, count / (PiecesPerWorker * static_cast<std::size_t>(this->Workers)));
    std::atomic<std::size_t> next{ 0 };
    while (next < count)
    {
      const Clock::time_point due =
        this->Progress.Due ? this->Progress.Due() : Clock::time_point::max();
      this->RunWorkers([count, piece, due, &next, &work](int) {
        do
        {
          const std::size_t first = next.fetch_add(piece);
          if (first >= count)
          {
            return;
          }
          work(first, std::min(first + piece, count));
        } while (due == Clock::time_point::max() || Clock::now() < due);
      });
      if (due != Clock::time_point::max() && Clock::now() >= due)
      {
        this->Progress.Report(
          std::min(1.0, static_cast<double>(next) / static_cast<double>(count)));
      }
    }
  }

private:
  /// Small pieces keep all workers busy to the end of the loop.
  static constexpr std::size_t PiecesPerWorker = 32;

  int Workers;
  Listener Progress;
};

#endif
