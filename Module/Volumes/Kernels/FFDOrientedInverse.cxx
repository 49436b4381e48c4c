// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDOrientedInverse.h"

#include "FFDPullBack.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace ffd
{
namespace
{

/// Seeds along each axis of the volume, as those of the packets.
constexpr int SeedsPerAxis = 7;

/// The number of seeds that are tried.
constexpr std::size_t SeedsTried = 6;

} // namespace

//------------------------------------------------------------------------------
OrientedInverse::OrientedInverse(
  const BSplineField& field, double tolerance, const VolumeView& volume, const Box& rest)
  : Field(field)
  , Tolerance(tolerance)
  , Volume(volume)
  , Rest(rest)
{
  std::vector<Seed> all;
  for (int i = 0; i < SeedsPerAxis * SeedsPerAxis * SeedsPerAxis; ++i)
  {
    const glm::dvec3 part(
      i % SeedsPerAxis, i / SeedsPerAxis % SeedsPerAxis, i / SeedsPerAxis / SeedsPerAxis);
    const glm::dvec3 index =
      glm::mix(rest.Min, rest.Max, part / static_cast<double>(SeedsPerAxis - 1));
    all.push_back(this->MakeSeed(volume.FirstVoxel + volume.IndexToData * index));
    int stride = 1;
    for (int a = 0; a < 3; ++a, stride *= SeedsPerAxis)
    {
      if (part[a] > 0.0)
      {
        const Seed& before = all[static_cast<std::size_t>(i - stride)];
        this->Reach = std::max(this->Reach, glm::length(all.back().Image - before.Image));
      }
    }
  }
  const auto positive =
    std::count_if(all.begin(), all.end(), [](const Seed& seed) { return seed.Positive; });
  this->Positive = 2 * positive >= static_cast<std::ptrdiff_t>(all.size());
  std::copy_if(all.begin(), all.end(), std::back_inserter(this->Seeds),
    [this](const Seed& seed) { return seed.Positive == this->Positive; });
}

//------------------------------------------------------------------------------
OrientedInverse::Seed OrientedInverse::MakeSeed(const glm::dvec3& point) const
{
  glm::dmat3 jacobian;
  const glm::dvec3 image = point + this->Field.Displacement(point, jacobian);
  return { point, image, glm::determinant(glm::dmat3(1.0) + jacobian) > 0.0 };
}

//------------------------------------------------------------------------------
bool OrientedInverse::Solve(
  const glm::dvec3& p, const glm::dvec3& start, glm::dvec3& q, int& evaluations) const
{
  bool found = false;
  const auto counts = [&](const glm::dvec3& from) {
    glm::dvec3 solution;
    if (!SolveInverseNear(this->Field, p, from, this->Tolerance, solution, evaluations))
    {
      return false;
    }
    const glm::dvec3 index = this->Volume.ToIndex(solution);
    const bool inside = glm::all(glm::greaterThanEqual(index, this->Rest.Min)) &&
      glm::all(glm::lessThanEqual(index, this->Rest.Max));
    const bool kept = inside && this->MakeSeed(solution).Positive == this->Positive;
    if (kept || (!inside && !found))
    {
      q = solution;
      found = true;
    }
    return kept;
  };
  if (counts(start))
  {
    return true;
  }
  std::vector<std::pair<double, const Seed*>> nearest;
  for (const Seed& seed : this->Seeds)
  {
    const double distance = glm::length(p - seed.Image);
    if (distance <= this->Reach)
    {
      nearest.emplace_back(distance, &seed);
    }
  }
  std::sort(nearest.begin(), nearest.end());
  nearest.resize(std::min(nearest.size(), SeedsTried));
  for (const auto& each : nearest)
  {
    if (counts(each.second->Point))
    {
      return true;
    }
  }
  if (!found)
  {
    constexpr double Far = 1e3;
    q = this->Volume.FirstVoxel +
      this->Volume.IndexToData * (this->Rest.Max + Far * (this->Rest.Max - this->Rest.Min));
  }
  return found;
}

} // namespace ffd
