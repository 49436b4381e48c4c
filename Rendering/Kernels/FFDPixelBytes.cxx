// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSimdTargets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "FFDPixelBytes.cxx"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once per instruction set.
#include <hwy/highway.h>

#include "FFDPixelBytes.h"

#include "Packets/FFDSimdMath-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// As many pixels as a vector has lanes.
HWY_INLINE void WriteLanes(const float* colors, bool premultiplied, std::uint8_t* bytes)
{
  const Df d;
  const Vf zero = hn::Zero(d);
  const Vf one = Splat(1.0f);
  Vf red;
  Vf green;
  Vf blue;
  Vf alpha;
  hn::LoadInterleaved4(d, colors, red, green, blue, alpha);
  const Vf scale =
    premultiplied ? one : hn::IfThenElseZero(hn::Gt(alpha, zero), hn::Div(one, alpha));
  const hn::Rebind<std::uint8_t, Df> db;
  const auto toBytes = [&](Vf value) {
    // What is not a number becomes 0.
    const Vf clamped = Clamp(value, zero, one);
    return hn::DemoteTo(db, Truncate(hn::Add(hn::Mul(clamped, Splat(255.0f)), Splat(0.5f))));
  };
  hn::StoreInterleaved4(toBytes(hn::Mul(red, scale)), toBytes(hn::Mul(green, scale)),
    toBytes(hn::Mul(blue, scale)), toBytes(alpha), db, bytes);
}

void WriteBytes(const float* colors, std::size_t pixels, bool premultiplied, std::uint8_t* bytes)
{
  const std::size_t lanes = hn::Lanes(Df());
  std::size_t i = 0;
  for (; i + lanes <= pixels; i += lanes)
  {
    WriteLanes(colors + 4 * i, premultiplied, bytes + 4 * i);
  }
  if (i < pixels)
  {
    float lastColors[4 * 16] = {};
    std::uint8_t lastBytes[4 * 16];
    std::copy(colors + 4 * i, colors + 4 * pixels, lastColors);
    WriteLanes(lastColors, premultiplied, lastBytes);
    std::copy_n(lastBytes, 4 * (pixels - i), bytes + 4 * i);
  }
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ffd
{

HWY_EXPORT(WriteBytes);

//------------------------------------------------------------------------------
void WritePixelBytes(
  const float* colors, std::size_t pixels, bool premultiplied, std::uint8_t* bytes)
{
  HWY_DYNAMIC_DISPATCH(WriteBytes)(colors, pixels, premultiplied, bytes);
}

} // namespace ffd
#endif
