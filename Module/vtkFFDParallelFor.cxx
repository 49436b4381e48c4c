// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDParallelFor.h"

#include "vtkSMPTools.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <utility>

namespace
{

/// Small pieces keep all workers busy to the end of the loop.
constexpr std::size_t PiecesPerWorker = 32;

} // namespace

//------------------------------------------------------------------------------
vtkFFDParallelFor::vtkFFDParallelFor(int threads, Listener listener)
  : Workers(threads > 0 ? threads : std::max(1, vtkSMPTools::GetEstimatedNumberOfThreads()))
  , Progress(std::move(listener))
{
}

//------------------------------------------------------------------------------
void vtkFFDParallelFor::RunWorkers(const std::function<void(int worker)>& work) const
{
  if (this->Workers == 1)
  {
    work(0);
    return;
  }
  // An exception, of an allocation for instance, would end the process if it left a thread.
  std::exception_ptr error;
  std::mutex mutex;
  vtkSMPTools::For(0, this->Workers, 1, [&work, &error, &mutex](vtkIdType first, vtkIdType last) {
    try
    {
      for (vtkIdType i = first; i < last; ++i)
      {
        work(static_cast<int>(i));
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

//------------------------------------------------------------------------------
void vtkFFDParallelFor::operator()(
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
      this->Progress.Report(std::min(1.0, static_cast<double>(next) / static_cast<double>(count)));
    }
  }
}
