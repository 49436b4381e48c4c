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
#include "Optics/FFDTransferInterval.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdRows-inl.h"
#include "FFDSimdTable-inl.h"

#include <cstddef>

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

/// A texel before values along an axis, and the part of the way from it to the next one.
struct TexelPosition
{
  Vf First; ///< a whole number
  Vf Part;
};

/// The positions of values along an axis; that of the first texel where they are not `known`.
HWY_INLINE TexelPosition FindTexels(const PacketPlane& plane, Vf value, Mf known, int a)
{
  const Df d;
  const Vf last = Splat(static_cast<float>(plane.Size[a] - 1));
  const Vf texel = hn::Mul(hn::Sub(value, Splat(plane.Low[a])), Splat(plane.Scale[a]));
  const Vf at = hn::IfThenElseZero(known, Clamp(texel, hn::Zero(d), last));
  const Vf first = hn::Floor(plane.Nearest ? hn::Add(at, Splat(0.5f)) : at);
  return { first, plane.Nearest ? hn::Zero(d) : hn::Sub(at, first) };
}

/// Interpolates the texels of rows. `intervals`: the texels that `columns` are counted from.
HWY_INLINE PlaneTexel InterpolateAlongRow(
  const TransferInterval* intervals, Vi columns, Vf part, Vi weights)
{
  const Quads texels = LoadIntervals(intervals, columns);
  return { InterpolateColors(texels, weights), InterpolateEnds(texels, part) };
}

/// Looks up the texels at (x, y); transparent where x or y is not a number.
HWY_NOINLINE inline PlaneTexel LookUpPlane(const PacketPlane& plane, Vf x, Vf y)
{
  const Mf known = hn::And(hn::Eq(x, x), hn::Eq(y, y));
  const TexelPosition u = FindTexels(plane, x, known, 0);
  const TexelPosition v = FindTexels(plane, y, known, 1);
  const Vi width = hn::Set(Di(), plane.Size[0]);
  const Vi column = Truncate(u.First);
  const Vi row = Truncate(v.First);
  const Vi weights = PairWeights(u.Part);
  const auto inRow = [&](Vi number) FFD_INLINE_LAMBDA {
    return InterpolateAlongRow(
      plane.Intervals, hn::Add(hn::Mul(number, width), column), u.Part, weights);
  };
  PlaneTexel texel = inRow(row);
  if (!plane.Nearest)
  {
    const PlaneTexel next =
      inRow(hn::Min(hn::Add(row, hn::Set(Di(), 1)), hn::Set(Di(), plane.Size[1] - 1)));
    texel.Color = Lerp(texel.Color, next.Color, v.Part);
    texel.Opacity = Lerp(texel.Opacity, next.Opacity, v.Part);
  }
  texel.Opacity = hn::IfThenElseZero(known, texel.Opacity);
  return texel;
}

/// The texels of the last row, which is that of the largest gradients.
HWY_INLINE const TransferInterval* FindLastRow(const PacketPlane& plane)
{
  return plane.Intervals +
    static_cast<std::ptrdiff_t>(plane.Size[0]) * static_cast<std::ptrdiff_t>(plane.Size[1] - 1);
}

/// Looks up the texels at values whose gradients count as large; as LookUpPlane().
HWY_NOINLINE inline PlaneTexel LookUpLastRow(const PacketPlane& plane, Vf x)
{
  const Mf known = hn::Eq(x, x);
  const TexelPosition u = FindTexels(plane, x, known, 0);
  PlaneTexel texel =
    InterpolateAlongRow(FindLastRow(plane), Truncate(u.First), u.Part, PairWeights(u.Part));
  texel.Opacity = hn::IfThenElseZero(known, texel.Opacity);
  return texel;
}

/// The opacity of LookUpLastRow().
HWY_NOINLINE inline Vf FindOpacityOfLastRow(const PacketPlane& plane, Vf x)
{
  const Mf known = hn::Eq(x, x);
  const TexelPosition u = FindTexels(plane, x, known, 0);
  return hn::IfThenElseZero(known, InterpolatePairs(FindLastRow(plane), Truncate(u.First), u.Part));
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
