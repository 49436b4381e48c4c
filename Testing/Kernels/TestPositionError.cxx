// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// No position that ERROR_BOUND samples is farther from the true one than the tolerance, where T is
// one to one: random lattices, shapes and cameras, all inverse modes. FFD_POSITION_SCENES and
// FFD_POSITION_SAMPLES ask for more scenes, and more samples of each.
#include "EveryTarget.h"
#include "PositionError.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace
{

int FromEnvironment(const char* name, int otherwise)
{
  const char* value = std::getenv(name);
  return value ? std::atoi(value) : otherwise;
}

} // namespace

TEST(PositionError, IsWithinTheTolerance)
{
  const int scenes = FromEnvironment("FFD_POSITION_SCENES", 40);
  const int samples = FromEnvironment("FFD_POSITION_SAMPLES", 8000);
  const std::vector<std::int64_t> targets = ffd::FindTargets();
  positionError::Tally all;
  for (int i = 0; i < scenes; ++i)
  {
    // Five scenes in turn for each instruction set.
    ffd::UseTarget(targets[static_cast<std::size_t>(i / 5) % targets.size()]);
    RandomLattice random(static_cast<unsigned int>(i + 1));
    const glm::dvec3 extent(64.0, random.Number(32.0, 64.0), random.Number(32.0, 64.0));
    std::string name;
    const ffd::BSplineField field = positionError::MakeField(random, extent, name);
    const ffd::PullBackKind kind = i % 5 == 0 ? ffd::PullBackKind::FirstOrder
      : i % 5 == 1                            ? ffd::PullBackKind::Forward
                                              : ffd::PullBackKind::Exact;
    positionError::Scene scene(field, kind, extent, random.Integer(40, 400));
    scene.SetCamera(positionError::MakeCamera(random, extent), 64 << random.Integer(0, 3));
    const double tolerance = i % 4 == 3 ? 0.02 : 0.1;
    scene.Settings.ErrorBound.PositionTolerance = tolerance;
    positionError::Tally tally;
    scene.Measure(random, static_cast<std::size_t>(samples), tally);
    const double rays = static_cast<double>(std::max<std::int64_t>(1, tally.Statistics.Rays));
    std::string line = "scene " + std::to_string(i) + ", " + name + ", kind " +
      std::to_string(static_cast<int>(kind)) + ": " + std::to_string(tally.Errors.size()) +
      " samples, largest " + std::to_string(tally.Largest() / tolerance) + " tolerances, above " +
      std::to_string(tally.Share(tolerance)) + ", mean " +
      std::to_string(tally.Mean() / tolerance) + ", evaluations a ray " +
      std::to_string(tally.Statistics.Evaluations / rays);
    EXPECT_LE(tally.Largest(), tolerance) << line;
    EXPECT_EQ(tally.Lost, 0) << line;
    if (std::getenv("FFD_POSITION_PRINT"))
    {
      std::printf("%s\n", line.c_str());
    }
    for (const double error : tally.Errors)
    {
      all.Errors.push_back(error / tolerance);
    }
  }
  ffd::UseTarget(0);
  std::printf("%zu samples: mean %.4f, above 0.5: %.2g, above 0.9: %.2g, largest %.3f tolerances\n",
    all.Errors.size(), all.Mean(), all.Share(0.5), all.Share(0.9), all.Largest());
  EXPECT_GT(all.Errors.size(), static_cast<std::size_t>(scenes) * 1000);
}
