// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDGatherLoop.h"

#include "FFDSimdTargets.h" // Those of the ray caster.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "FFDGatherLoop.cxx"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ffdBenchmark
{
namespace HWY_NAMESPACE
{
namespace hn = hwy::HWY_NAMESPACE;

// What a ray moves per sample, voxels: the view of the frame benchmarks.
constexpr float StepX = -0.427f;
constexpr float StepY = -0.299f;
constexpr float StepZ = -0.853f;

std::size_t GatherRowOnTarget(const GatherVolume& volume, int row, float& checksum)
{
  const hn::CappedTag<float, 16> d;
  const hn::RebindToSigned<decltype(d)> di;
  using V = hn::Vec<decltype(d)>;
  using I = hn::Vec<decltype(di)>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int nx = volume.Dimensions[0];
  const int ny = volume.Dimensions[1];
  const int nz = volume.Dimensions[2];
  const int samples = static_cast<int>(static_cast<float>(nz - 3) / -StepZ);
  const float startX = -StepX * static_cast<float>(samples) + 1.0f;
  const float startY = -StepY * static_cast<float>(samples) + 1.0f + static_cast<float>(4 * row);
  const auto* bytes = reinterpret_cast<const std::int32_t*>(volume.Voxels);
  const I low = hn::Set(di, 255);
  const auto pair = [&](I offset, V fx) {
    // One gather fetches two neighbors along x.
    const I both = hn::GatherOffset(di, bytes, offset);
    const V a = hn::ConvertTo(d, hn::And(both, low));
    const V b = hn::ConvertTo(d, hn::And(hn::ShiftRight<8>(both), low));
    return hn::MulAdd(fx, hn::Sub(b, a), a);
  };
  // Lanes: 4 rays high, lanes / 4 wide, as the packets of the ray caster.
  const I index = hn::Iota(di, 0);
  const V laneX = hn::ConvertTo(d, hn::ShiftRight<2>(index));
  const V laneY = hn::ConvertTo(d, hn::And(index, hn::Set(di, 3)));
  const float width = static_cast<float>(lanes / 4);
  V sum = hn::Zero(d);
  std::size_t count = 0;
  for (float x0 = startX; x0 + width < static_cast<float>(nx - 3); x0 += width)
  {
    V x = hn::Add(laneX, hn::Set(d, x0));
    V y = hn::Min(hn::Add(laneY, hn::Set(d, startY)), hn::Set(d, static_cast<float>(ny - 3)));
    V z = hn::Set(d, static_cast<float>(nz - 2) - 0.1f);
    for (int s = 0; s < samples; ++s)
    {
      const I ix = hn::ConvertTo(di, x);
      const I iy = hn::ConvertTo(di, y);
      const I iz = hn::ConvertTo(di, z);
      const V fx = hn::Sub(x, hn::ConvertTo(d, ix));
      const V fy = hn::Sub(y, hn::ConvertTo(d, iy));
      const V fz = hn::Sub(z, hn::ConvertTo(d, iz));
      const I offset =
        hn::Add(ix, hn::Add(hn::Mul(iy, hn::Set(di, nx)), hn::Mul(iz, hn::Set(di, nx * ny))));
      const V v00 = pair(offset, fx);
      const V v10 = pair(hn::Add(offset, hn::Set(di, nx)), fx);
      const V v01 = pair(hn::Add(offset, hn::Set(di, nx * ny)), fx);
      const V v11 = pair(hn::Add(offset, hn::Set(di, nx * ny + nx)), fx);
      const V v0 = hn::MulAdd(fy, hn::Sub(v10, v00), v00);
      const V v1 = hn::MulAdd(fy, hn::Sub(v11, v01), v01);
      sum = hn::Add(sum, hn::MulAdd(fz, hn::Sub(v1, v0), v0));
      x = hn::Add(x, hn::Set(d, StepX));
      y = hn::Add(y, hn::Set(d, StepY));
      z = hn::Add(z, hn::Set(d, StepZ));
    }
    count += static_cast<std::size_t>(samples) * static_cast<std::size_t>(lanes);
  }
  checksum += hn::GetLane(hn::SumOfLanes(d, sum));
  return count;
}

const char* TargetName() { return hwy::TargetName(HWY_TARGET); }

} // namespace HWY_NAMESPACE
} // namespace ffdBenchmark
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ffdBenchmark
{
HWY_EXPORT(GatherRowOnTarget);
HWY_EXPORT(TargetName);

//------------------------------------------------------------------------------
std::size_t GatherRow(const GatherVolume& volume, int row, float& checksum)
{
  return HWY_DYNAMIC_DISPATCH(GatherRowOnTarget)(volume, row, checksum);
}

//------------------------------------------------------------------------------
int GetNumberOfGatherRows(const GatherVolume& volume)
{
  // As far as a ray moves down.
  const float drop = 0.299f / 0.853f * static_cast<float>(volume.Dimensions[2]);
  return static_cast<int>((static_cast<float>(volume.Dimensions[1]) - drop - 8.0f) / 4.0f);
}

//------------------------------------------------------------------------------
const char* GetGatherTarget() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

} // namespace ffdBenchmark
#endif
