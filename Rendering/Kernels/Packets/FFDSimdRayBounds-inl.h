// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Bounds of viewing rays. Included once per target of Highway.
#if defined(FFD_SIMD_RAY_BOUNDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_RAY_BOUNDS_INL_H_
#undef FFD_SIMD_RAY_BOUNDS_INL_H_
#else
#define FFD_SIMD_RAY_BOUNDS_INL_H_
#endif

#include "FFDVisibleSpace.h"

#include "FFDSimdMath-inl.h"

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Bounds of rays, and of all rays between them.
class RayBounds
{
public:
  HWY_INLINE void Include(const Vec3& origin, const Vec3& direction)
  {
    const auto include = [this](Vf o, Vf v, int a) {
      this->OriginLow[a] = std::min(this->OriginLow[a], SmallestLane(o));
      this->OriginHigh[a] = std::max(this->OriginHigh[a], LargestLane(o));
      this->DirectionLow[a] = std::min(this->DirectionLow[a], SmallestLane(v));
      this->DirectionHigh[a] = std::max(this->DirectionHigh[a], LargestLane(v));
    };
    include(origin.x, direction.x, 0);
    include(origin.y, direction.y, 1);
    include(origin.z, direction.z, 2);
  }

  /// Whether something may be visible where the rays are from t = `from` to `to`, local lengths, in
  /// boxes of about the given length each.
  bool Meet(const VisibleSpace& space, float from, float to, float length) const
  {
    const float beyond = this->FindStretch();
    const int count = static_cast<int>(std::clamp((to - from) / length, 1.0f, 32.0f));
    const float step = (to - from) / static_cast<float>(count);
    for (int i = 0; i < count; ++i)
    {
      const float first = std::max(from + static_cast<float>(i) * step, 0.0f);
      const float last = beyond * (first + step);
      float low[3];
      float high[3];
      for (int a = 0; a < 3; ++a)
      {
        low[a] = this->OriginLow[a] +
          std::min(first * this->DirectionLow[a], last * this->DirectionLow[a]);
        high[a] = this->OriginHigh[a] +
          std::max(first * this->DirectionHigh[a], last * this->DirectionHigh[a]);
      }
      if (space.Meets(low, high))
      {
        return true;
      }
    }
    return false;
  }

private:
  /// How much farther the rays between those that are included may be than the chords of these:
  /// directions are unit vectors within a distance of the middle of their box.
  float FindStretch() const
  {
    float middle = 0.0f;
    float around = 0.0f;
    for (int a = 0; a < 3; ++a)
    {
      const float c = 0.5f * (this->DirectionLow[a] + this->DirectionHigh[a]);
      const float r = 0.5f * (this->DirectionHigh[a] - this->DirectionLow[a]);
      middle += c * c;
      around += r * r;
    }
    const float chord = 0.5f * (1.0f + middle - around) / std::sqrt(std::max(middle, 1e-6f));
    return 1.0f / std::clamp(chord, 0.01f, 1.0f);
  }

  float OriginLow[3] = { 1e30f, 1e30f, 1e30f };
  float OriginHigh[3] = { -1e30f, -1e30f, -1e30f };
  float DirectionLow[3] = { 1e30f, 1e30f, 1e30f };
  float DirectionHigh[3] = { -1e30f, -1e30f, -1e30f };
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
