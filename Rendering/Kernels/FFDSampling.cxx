// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSampling.h"

#include "FFDScalarDispatch.h"
#include "Optics/FFDDifferences.h"

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
    const double x = std::clamp(q[a], 0.0, static_cast<double>(v.Dimensions[a] - 1));
    const int i = std::clamp(static_cast<int>(x), 0, v.Dimensions[a] - 2);
    cell.Offset += i * v.Increments[a];
    cell.Weight[a] = x - i;
  }
  return cell;
}

/// Where voxels are cells, positions may be those of voxels: beside hidden cells and beyond the
/// outermost ones. The other voxel does not count: what is not a finite number would, whatever its
/// weight in a sum.
double Lerp(const VolumeView& v, double a, double b, double t)
{
  if (v.Margin > 0.0 && (t == 0.0 || t == 1.0))
  {
    return t == 0.0 ? a : b;
  }
  return a + t * (b - a);
}

/// Trilinear value in a cell of one component; `scalars`: that component of voxel (0, 0, 0).
template <class T>
double ValueInCell(const VolumeView& v, const CellPosition& cell, const T* scalars)
{
  const T* p = scalars + cell.Offset;
  const std::int64_t x = v.Increments[0];
  const std::int64_t y = v.Increments[1];
  const std::int64_t z = v.Increments[2];
  const auto row = [&](std::int64_t at) {
    return Lerp(v, static_cast<double>(p[at]), static_cast<double>(p[at + x]), cell.Weight.x);
  };
  return Lerp(v, Lerp(v, row(0), row(y), cell.Weight.y), Lerp(v, row(z), row(y + z), cell.Weight.y),
    cell.Weight.z);
}

template <class T>
double TrilinearValue(const VolumeView& v, const glm::dvec3& q)
{
  return ValueInCell(v, FindCell(v, q), static_cast<const T*>(v.Scalars));
}

template <class T>
void TrilinearValues(const VolumeView& v, const glm::dvec3& q, double* values)
{
  const CellPosition cell = FindCell(v, q);
  for (int c = 0; c < v.Components; ++c)
  {
    values[c] = ValueInCell(v, cell, static_cast<const T*>(v.Scalars) + c);
  }
}

std::int64_t FindNearestVoxel(const VolumeView& v, const glm::dvec3& q)
{
  std::int64_t offset = 0;
  for (int a = 0; a < 3; ++a)
  {
    offset += std::clamp(static_cast<int>(q[a] + 0.5), 0, v.Dimensions[a] - 1) * v.Increments[a];
  }
  return offset;
}

template <class T>
double NearestValue(const VolumeView& v, const glm::dvec3& q)
{
  return static_cast<double>(static_cast<const T*>(v.Scalars)[FindNearestVoxel(v, q)]);
}

template <class T>
void NearestValues(const VolumeView& v, const glm::dvec3& q, double* values)
{
  const T* p = static_cast<const T*>(v.Scalars) + FindNearestVoxel(v, q);
  std::transform(p, p + v.Components, values, [](T value) { return static_cast<double>(value); });
}

template <class T>
glm::dvec3 TrilinearGradient(const VolumeView& v, const glm::dvec3& q)
{
  return FindDifferences(
    v, q, false, nullptr, [&v](const glm::dvec3& at, bool) { return TrilinearValue<T>(v, at); });
}

template <class T>
glm::dvec3 NearestGradient(const VolumeView& v, const glm::dvec3& q)
{
  return FindDifferences(
    v, q, true, nullptr, [&v](const glm::dvec3& at, bool) { return NearestValue<T>(v, at); });
}

} // namespace

//------------------------------------------------------------------------------
VolumeView GetComponent(const VolumeView& volume, int component)
{
  VolumeView view = volume;
  view.Components = 1;
  DispatchScalarType(volume.Type, [&](auto zero) {
    view.Scalars = static_cast<const decltype(zero)*>(volume.Scalars) + component;
  });
  return view;
}

//------------------------------------------------------------------------------
SampleFunctions SelectSampleFunctions(ScalarType type, Interpolation interpolation)
{
  return DispatchScalarType(type, [interpolation](auto zero) {
    using T = decltype(zero);
    return interpolation == Interpolation::Linear
      ? SampleFunctions{ &TrilinearValue<T>, &TrilinearValues<T>, &TrilinearGradient<T> }
      : SampleFunctions{ &NearestValue<T>, &NearestValues<T>, &NearestGradient<T> };
  });
}

} // namespace ffd
