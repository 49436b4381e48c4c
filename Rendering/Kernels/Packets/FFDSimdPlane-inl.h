// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Two-dimensional transfer functions, a sample a lane. Included once per target of Highway.
#if defined(FFD_SIMD_PLANE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PLANE_INL_H_
#undef FFD_SIMD_PLANE_INL_H_
#else
#define FFD_SIMD_PLANE_INL_H_
#endif

#include "FFDPacketPlane.h"
#include "FFDScalarDispatch.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdRows-inl.h"

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Texels of a two-dimensional transfer function, interpolated.
struct PlaneTexel
{
  Vec3 Color;
  Vf Opacity;
};

/// Does what FindSecondAxis() does where offsets do not lead over all scalars side by side.
HWY_NOINLINE inline Vf FindSecondAxisByLane(
  const PacketPlane& plane, const SampleCells& cells, const SamplePosition& at)
{
  const Df d;
  const Di di;
  const PacketVolume& v = plane.SecondAxis;
  HWY_ALIGN int first[3][16];
  hn::Store(cells.X, di, first[0]);
  hn::Store(cells.Y, di, first[1]);
  hn::Store(cells.Z, di, first[2]);
  HWY_ALIGN float corners[8][16];
  DispatchScalarType(v.Type, [&](auto zero) {
    const auto* const scalars = static_cast<const decltype(zero)*>(v.Scalars);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      std::ptrdiff_t cell = 0;
      for (int a = 0; a < 3; ++a)
      {
        cell += first[a][lane] * plane.AxisIncrements[a];
      }
      for (std::size_t corner = 0; corner < 8; ++corner)
      {
        const std::ptrdiff_t to = ((corner & 1) != 0 ? plane.AxisIncrements[0] : 0) +
          ((corner & 2) != 0 ? plane.AxisIncrements[1] : 0) +
          ((corner & 4) != 0 ? plane.AxisIncrements[2] : 0);
        corners[corner][lane] = static_cast<float>(scalars[cell + to]);
      }
    }
  });
  const auto along = [&](std::size_t corner) {
    return Between(hn::Load(d, corners[corner]), hn::Load(d, corners[corner + 1]), at.Fx, at);
  };
  return Between(
    Between(along(0), along(2), at.Fy, at), Between(along(4), along(6), at.Fy, at), at.Fz, at);
}

/// Interpolates the scalars of the second axis at positions in the volume.
HWY_NOINLINE inline Vf FindSecondAxis(const PacketPlane& plane, const Vec3& q)
{
  const Df d;
  const PacketVolume& v = plane.SecondAxis;
  SampleCells cells;
  SamplePosition at = FindCells(v, q, false, cells);
  // The outermost voxels hold beyond the volume.
  at.Fx = Clamp(at.Fx, hn::Zero(d), Splat(1.0f));
  at.Fy = Clamp(at.Fy, hn::Zero(d), Splat(1.0f));
  at.Fz = Clamp(at.Fz, hn::Zero(d), Splat(1.0f));
  if (HWY_UNLIKELY(plane.AxisByLane))
  {
    return FindSecondAxisByLane(plane, cells, at);
  }
  at.Weights = PairWeights(at.Fx);
  return ForFetched(v, [&](auto zero) {
    FaceRows<decltype(zero)> voxels;
    voxels.Repeat(v, cells);
    SampleRows<decltype(zero)> rows;
    return Sample<decltype(zero)>(voxels, at, rows);
  });
}

/// Two neighboring texels along an axis, and the part of the way from one to the other.
struct TexelPair
{
  Vi First;
  Vi Second;
  Vf Part;
};

/// The texels around values along an axis; the first ones where they are not `known`.
HWY_INLINE TexelPair FindTexels(const PacketPlane& plane, Vf value, Mf known, int a)
{
  const Df d;
  const Vf last = Splat(static_cast<float>(plane.Size[a] - 1));
  const Vf texel = hn::Mul(hn::Sub(value, Splat(plane.Low[a])), Splat(plane.Scale[a]));
  const Vf at = hn::IfThenElseZero(known, Clamp(texel, hn::Zero(d), last));
  const Vf first = hn::Floor(plane.Nearest ? hn::Add(at, Splat(0.5f)) : at);
  return { Truncate(first), Truncate(hn::Min(hn::Add(first, Splat(1.0f)), last)),
    plane.Nearest ? hn::Zero(d) : hn::Sub(at, first) };
}

/// Interpolates in the rows of texels whose first ones are `begin`.
HWY_INLINE PlaneTexel InterpolateTexels(const PacketPlane& plane, Vi begin, const TexelPair& u)
{
  const Df d;
  const auto* const words = reinterpret_cast<const std::uint32_t*>(plane.Texels);
  const Quads a = LoadQuads(words, hn::Add(begin, u.First));
  const Quads b = LoadQuads(words, hn::Add(begin, u.Second));
  const auto mix = [&](Vi first, Vi second) {
    return Lerp(hn::BitCast(d, first), hn::BitCast(d, second), u.Part);
  };
  return { { mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z) }, mix(a.w, b.w) };
}

/// Looks up the texels at (x, y); transparent where x or y is not a number.
HWY_NOINLINE inline PlaneTexel LookUpPlane(const PacketPlane& plane, Vf x, Vf y)
{
  const Mf known = hn::And(hn::Eq(x, x), hn::Eq(y, y));
  const TexelPair u = FindTexels(plane, x, known, 0);
  const TexelPair v = FindTexels(plane, y, known, 1);
  const Vi width = hn::Set(Di(), plane.Size[0]);
  PlaneTexel texel = InterpolateTexels(plane, hn::Mul(v.First, width), u);
  if (!plane.Nearest)
  {
    const PlaneTexel next = InterpolateTexels(plane, hn::Mul(v.Second, width), u);
    texel.Color = { Lerp(texel.Color.x, next.Color.x, v.Part),
      Lerp(texel.Color.y, next.Color.y, v.Part), Lerp(texel.Color.z, next.Color.z, v.Part) };
    texel.Opacity = Lerp(texel.Opacity, next.Opacity, v.Part);
  }
  texel.Opacity = hn::IfThenElseZero(known, texel.Opacity);
  return texel;
}

/// The first texel of the last row, which is that of the largest gradients.
HWY_INLINE int FindLastRow(const PacketPlane& plane) { return plane.Size[0] * (plane.Size[1] - 1); }

/// Looks up the texels at values whose gradients count as large; as LookUpPlane().
HWY_NOINLINE inline PlaneTexel LookUpLastRow(const PacketPlane& plane, Vf x)
{
  const Mf known = hn::Eq(x, x);
  PlaneTexel texel =
    InterpolateTexels(plane, hn::Set(Di(), FindLastRow(plane)), FindTexels(plane, x, known, 0));
  texel.Opacity = hn::IfThenElseZero(known, texel.Opacity);
  return texel;
}

/// The opacity of LookUpLastRow().
HWY_NOINLINE inline Vf FindOpacityOfLastRow(const PacketPlane& plane, Vf x)
{
  const Mf known = hn::Eq(x, x);
  const TexelPair u = FindTexels(plane, x, known, 0);
  const float* const opacities = plane.Texels + 4 * FindLastRow(plane) + 3;
  HWY_ALIGN int first[16];
  HWY_ALIGN int second[16];
  StoreIndices(u.First, first);
  StoreIndices(u.Second, second);
  return hn::IfThenElseZero(known,
    Lerp(LoadLanes<float, 16>(opacities, 0, first), LoadLanes<float, 16>(opacities, 0, second),
      u.Part));
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
