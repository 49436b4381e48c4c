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

HWY_INLINE void BlendPixel(const std::uint8_t* over, std::uint8_t* below)
{
  const unsigned int rest = 255u - over[3];
  for (int c = 0; c < 4; ++c)
  {
    // Divided by 255, rounded.
    const unsigned int seen = below[c] * rest + 128u;
    const unsigned int sum = over[c] + ((seen + (seen >> 8)) >> 8);
    below[c] = static_cast<std::uint8_t>(std::min(sum, 255u));
  }
}

#if HWY_TARGET != HWY_SCALAR
/// BlendPixel() of as many pixels as a vector of words holds.
HWY_INLINE void BlendLanes(const std::uint8_t* over, std::uint8_t* below)
{
  const hn::ScalableTag<std::uint16_t> d;
  const hn::Rebind<std::uint8_t, decltype(d)> db;
  const hn::Repartition<std::uint8_t, decltype(d)> bytes;
  HWY_ALIGN static constexpr std::uint8_t fourth[16] = { 6, 7, 6, 7, 6, 7, 6, 7, 14, 15, 14, 15, 14,
    15, 14, 15 };
  const auto colors = hn::PromoteTo(d, hn::LoadU(db, over));
  const auto alpha =
    hn::BitCast(d, hn::TableLookupBytes(hn::BitCast(bytes, colors), hn::LoadDup128(bytes, fourth)));
  const auto rest = hn::Sub(hn::Set(d, 255), alpha);
  const auto seen = hn::Add(hn::Mul(hn::PromoteTo(d, hn::LoadU(db, below)), rest), hn::Set(d, 128));
  const auto sum = hn::Add(colors, hn::ShiftRight<8>(hn::Add(seen, hn::ShiftRight<8>(seen))));
  const hn::RebindToSigned<decltype(d)> words;
  hn::StoreU(hn::DemoteTo(db, hn::BitCast(words, sum)), db, below);
}
#endif

void BlendBytes(const std::uint8_t* over, std::size_t pixels, std::uint8_t* below)
{
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const std::size_t lanes = hn::Lanes(hn::ScalableTag<std::uint16_t>()) / 4;
  for (; i + lanes <= pixels; i += lanes)
  {
    BlendLanes(over + 4 * i, below + 4 * i);
  }
#endif
  for (; i < pixels; ++i)
  {
    BlendPixel(over + 4 * i, below + 4 * i);
  }
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ffd
{

HWY_EXPORT(WriteBytes);
HWY_EXPORT(BlendBytes);

//------------------------------------------------------------------------------
void WritePixelBytes(
  const float* colors, std::size_t pixels, bool premultiplied, std::uint8_t* bytes)
{
  HWY_DYNAMIC_DISPATCH(WriteBytes)(colors, pixels, premultiplied, bytes);
}

//------------------------------------------------------------------------------
void BlendPixelBytes(const std::uint8_t* over, std::size_t pixels, std::uint8_t* below)
{
  HWY_DYNAMIC_DISPATCH(BlendBytes)(over, pixels, below);
}

} // namespace ffd
#endif
