// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef EveryTarget_h
#define EveryTarget_h

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

/// Kernels use these targets from now on; 0: the best ones.
inline void UseTargets(std::int64_t targets)
{
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().DeInit();
}

/// Calls `check` once for every instruction set, with it in force.
template <class Check>
void ForEveryTarget(const Check& check)
{
  for (const std::int64_t target : FindTargets())
  {
    UseTargets(target);
    SCOPED_TRACE(hwy::TargetName(target));
    check();
  }
  UseTargets(0);
}

} // namespace ffd

#endif
