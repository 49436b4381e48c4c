// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef EveryTarget_h
#define EveryTarget_h

#define FFD_PERMUTES_BYTES  // All instruction sets that any kernel is compiled for.
#include "FFDSimdTargets.h" // Before Highway's headers.

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>
#include <vector>

namespace ffd
{

/// The instruction sets that the vector kernels are compiled for and that this machine has.
inline std::vector<std::int64_t> FindTargets()
{
  hwy::SetSupportedTargetsForTest(0);
  return hwy::SupportedAndGeneratedTargets();
}

/// Kernels use this target from now on, or the best of the worse ones, which have larger numbers,
/// if they are not compiled for it; 0: the best ones.
inline void UseTarget(std::int64_t target)
{
  hwy::SetSupportedTargetsForTest(0);
  if (target != 0)
  {
    hwy::SetSupportedTargetsForTest(hwy::SupportedTargets() & ~(target - 1));
  }
  hwy::GetChosenTarget().DeInit();
}

/// Calls `check` once for every instruction set, with it in force.
template <class Check>
void ForEveryTarget(const Check& check)
{
  for (const std::int64_t target : FindTargets())
  {
    UseTarget(target);
    SCOPED_TRACE(hwy::TargetName(target));
    check();
  }
  UseTarget(0);
}

} // namespace ffd

#endif
