// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the project: not installed.
#ifndef vtkFFDParallelFor_h
#define vtkFFDParallelFor_h

#include "vtkSMPTools.h"

#include <cstddef>
#include <functional>

/// Splits a loop over threads with vtkSMPTools, as the kernels ask for it.
inline void vtkFFDParallelFor(
  std::size_t count, const std::function<void(std::size_t first, std::size_t last)>& work)
{
  vtkSMPTools::For(0, static_cast<vtkIdType>(count),
    [&work](vtkIdType first, vtkIdType last)
    { work(static_cast<std::size_t>(first), static_cast<std::size_t>(last)); });
}

/// Run `work` with at most `threads` threads; 0: as many as vtkSMPTools uses.
inline void vtkFFDWithThreads(int threads, const std::function<void()>& work)
{
  if (threads > 0)
  {
    vtkSMPTools::LocalScope(vtkSMPTools::Config{ threads }, work);
  }
  else
  {
    work();
  }
}

#endif
