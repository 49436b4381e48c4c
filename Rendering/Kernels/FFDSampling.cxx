// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSampling.h"

#include "FFDScalarDispatch.h"

#include <glm/common.hpp>

#include <algorithm>

namespace ffd
{
namespace
{

/// Lower corner of the cell that holds a position, and the position in the cell.
struct CellPosition
{
  std::int64_t Offset; ///< elements from voxel (0, 0, 0)
  glm::dvec3 Weight;
};

CellPosition FindCell(const VolumeView& v, const glm::dvec3& q)
{
  CellPosition cell{ 0, glm::dvec3(0.0) };
  for (int a = 0; a < 3; ++a)
  {
    const int i = std::clamp(static_cast<int>(q[a]), 0, v.Dimensions[a] - 2);
    cell.Offset += i * v.Increments[a];
    cell.Weight[a] = q[a] - i;
  }
  return cell;
}

double Lerp(double a, double b, double t)
{
  return a + t * (b - a);
}

template <class T>
double TrilinearValue(const VolumeView& v, const glm::dvec3& q)
{
  const CellPosition cell = FindCell(v, q);
  const T* p = static_cast<const T*>(v.Scalars) + cell.Offset;
  const std::int64_t x = v.Increments[0];
  const std::int64_t y = v.Increments[1];
  const std::int64_t z = v.Increments[2];
  const auto row = [&](std::int64_t at)
  { return Lerp(static_cast<double>(p[at]), static_cast<double>(p[at + x]), cell.Weight.x); };
  return Lerp(Lerp(row(0), row(y), cell.Weight.y), Lerp(row(z), row(y + z), cell.Weight.y),
    cell.Weight.z);
}

template <class T>
double NearestValue(const VolumeView& v, const glm::dvec3& q)
{
  std::int64_t offset = 0;
  for (int a = 0; a < 3; ++a)
  {
    offset += std::clamp(static_cast<int>(q[a] + 0.5), 0, v.Dimensions[a] - 1) * v.Increments[a];
  }
  return static_cast<double>(static_cast<const T*>(v.Scalars)[offset]);
}

template <class T>
glm::dvec3 CentralDifferences(const VolumeView& v, const glm::dvec3& q)
{
  const glm::dvec3 upper = v.UpperIndex();
  glm::dvec3 gradient;
  for (int a = 0; a < 3; ++a)
  {
    glm::dvec3 before = q;
    glm::dvec3 after = q;
    before[a] = std::max(q[a] - 1.0, 0.0);
    after[a] = std::min(q[a] + 1.0, upper[a]);
    gradient[a] = 0.5 * (TrilinearValue<T>(v, after) - TrilinearValue<T>(v, before));
  }
  return gradient;
}

} // namespace

//------------------------------------------------------------------------------
SampleFunctions SelectSampleFunctions(ScalarType type, Interpolation interpolation)
{
  return DispatchScalarType(type,
    [interpolation](auto zero)
    {
      using T = decltype(zero);
      return SampleFunctions{ interpolation == Interpolation::Linear ? &TrilinearValue<T>
                                                                     : &NearestValue<T>,
        &CentralDifferences<T> };
    });
}

} // namespace ffd
