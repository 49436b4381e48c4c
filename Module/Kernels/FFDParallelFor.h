// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDParallelFor_h
#define FFDParallelFor_h

#include <cstddef>
#include <functional>
#include <type_traits>
#include <utility>

namespace ffd
{

/**
 * Runs work(first, last) over [0, count), split over threads by what it is made of: a function
 * object with the same arguments, vtkFFDParallelFor for instance. A default-constructed one runs
 * the work in one go on the calling thread.
 */
class ParallelFor
{
public:
  using Work = std::function<void(std::size_t first, std::size_t last)>;

  ParallelFor() = default;
  template <class Splitter,
    class = std::enable_if_t<!std::is_same<std::decay_t<Splitter>, ParallelFor>::value>>
  ParallelFor(Splitter&& splitter)
    : Split(std::forward<Splitter>(splitter))
  {
  }

  void operator()(std::size_t count, const Work& work) const
  {
    if (count == 0)
    {
      return;
    }
    if (this->Split)
    {
      this->Split(count, work);
    }
    else
    {
      work(0, count);
    }
  }

private:
  std::function<void(std::size_t count, const Work& work)> Split;
};

/// Runs two functions, at the same time if there are threads for both.
inline void RunBoth(const ParallelFor& parallelFor, const std::function<void()>& one,
  const std::function<void()>& other)
{
  parallelFor(2, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
    {
      i == 0 ? one() : other();
    }
  });
}

} // namespace ffd

#endif
