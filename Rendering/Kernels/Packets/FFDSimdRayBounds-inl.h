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

/**
 * Bounds of rays, and of all rays between them. Directions d of these, of unit length or less, are
 * means of those that are included. So are the points where t is zero, but for a shift along the
 * ray: parallel rays have none; others meet at a distance of these points, and the mean of unit
 * vectors is shorter by at most a quarter of the square of how far they are apart. What lies along
 * a unit vector is farther than along d by no more than 1 / |d|.
 */
class RayBounds
{
public:
  /// `distance`: PacketRays::EyeDistance.
  explicit RayBounds(float distance)
    : Distance(distance)
  {
  }

  HWY_INLINE void Include(const Vec3& origin, const Vec3& direction)
  {
    this->Origins.Include(origin);
    this->Directions.Include(direction);
  }

  /// Whether something may be visible where the rays are from t = `from` to `to`, local lengths, in
  /// boxes of about the given length each.
  bool Meet(const SpaceCells& space, float from, float to, float length) const
  {
    const float stretch = this->FindStretch();
    const float shift = 0.25f * this->Distance * this->Directions.FindSquaredDiagonal();
    const int count = static_cast<int>(std::clamp((to - from) / length, 1.0f, 32.0f));
    const float step = (to - from) / static_cast<float>(count);
    for (int i = 0; i < count; ++i)
    {
      const float first = from + static_cast<float>(i) * step;
      const float last = first + step + shift;
      const float t[2] = { std::min(first, stretch * first), std::max(last, stretch * last) };
      float low[3];
      float high[3];
      for (int a = 0; a < 3; ++a)
      {
        const float d0 = this->Directions.Low[a];
        const float d1 = this->Directions.High[a];
        low[a] = this->Origins.Low[a] + std::min({ t[0] * d0, t[0] * d1, t[1] * d0, t[1] * d1 });
        high[a] = this->Origins.High[a] + std::max({ t[0] * d0, t[0] * d1, t[1] * d0, t[1] * d1 });
      }
      if (space.Meets(low, high))
      {
        return true;
      }
    }
    return false;
  }

private:
  struct Limits
  {
    float Low[3] = { 1e30f, 1e30f, 1e30f };
    float High[3] = { -1e30f, -1e30f, -1e30f };

    HWY_INLINE void Include(const Vec3& v)
    {
      const auto include = [this](Vf x, int a) {
        this->Low[a] = std::min(this->Low[a], SmallestLane(x));
        this->High[a] = std::max(this->High[a], LargestLane(x));
      };
      include(v.x, 0);
      include(v.y, 1);
      include(v.z, 2);
    }

    float FindSquaredDiagonal() const
    {
      float squared = 0.0f;
      for (int a = 0; a < 3; ++a)
      {
        squared += (this->High[a] - this->Low[a]) * (this->High[a] - this->Low[a]);
      }
      return squared;
    }
  };

  /// Bounds 1 / |d| of the rays between those that are included: directions of these are unit
  /// vectors within a distance of the middle of their box.
  float FindStretch() const
  {
    float middle = 0.0f;
    float around = 0.0f;
    for (int a = 0; a < 3; ++a)
    {
      const float c = 0.5f * (this->Directions.Low[a] + this->Directions.High[a]);
      const float r = 0.5f * (this->Directions.High[a] - this->Directions.Low[a]);
      middle += c * c;
      around += r * r;
    }
    const float chord = 0.5f * (1.0f + middle - around) / std::sqrt(std::max(middle, 1e-6f));
    return 1.0f / std::clamp(chord, 0.01f, 1.0f);
  }

  float Distance;
  Limits Origins;
  Limits Directions;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
