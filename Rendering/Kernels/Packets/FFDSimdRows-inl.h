// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Trilinear samples and their gradients, a position a lane. Included once per target of Highway.
#if defined(FFD_SIMD_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_ROWS_INL_H_
#undef FFD_SIMD_ROWS_INL_H_
#else
#define FFD_SIMD_ROWS_INL_H_
#endif

#include "FFDPacketVolume.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"

#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// The four rows of a cell, kept by a sample for its gradient, and their values at the position.
template <class T>
struct SampleRows
{
  typename Fetch<T>::Row R00;
  typename Fetch<T>::Row R10; // y + 1
  typename Fetch<T>::Row R01; // z + 1
  typename Fetch<T>::Row R11;
  typename Fetch<T>::Along M00;
  typename Fetch<T>::Along M10;
  typename Fetch<T>::Along M01;
  typename Fetch<T>::Along M11;
};

/// Interpolates along y and z between four values along x.
template <class T>
HWY_INLINE Vf Across(const SamplePosition& at, typename Fetch<T>::Along a00,
  typename Fetch<T>::Along a10, typename Fetch<T>::Along a01, typename Fetch<T>::Along a11)
{
  using F = Fetch<T>;
  if constexpr (std::is_same<typename F::Along, Vf>::value)
  {
    return Between(Between(a00, a10, at.Fy, at), Between(a01, a11, at.Fy, at), at.Fz, at);
  }
  else
  {
    // Whole numbers are finite: weights of zero and one do.
    return Lerp(Lerp(F::ToFloat(a00), F::ToFloat(a10), at.Fy),
      Lerp(F::ToFloat(a01), F::ToFloat(a11), at.Fy), at.Fz);
  }
}

/// Difference along x, over two voxels, in a row.
template <class T>
HWY_INLINE typename Fetch<T>::Along Slope(
  const SamplePosition& at, const typename Fetch<T>::Row& row)
{
  return hn::Sub(Fetch<T>::Behind(row, at), Fetch<T>::Before(row, at));
}

/**
 * Rows of voxels that lie dy and dz from those of the cells, loaded lane by lane. Row() gives all
 * four voxels, Middle() what Fetch::Middle() does of those of the cell.
 */
template <class T>
class OffsetRows
{
public:
  /// Fetches from the cells of `lanes`, FindInterior(); other lanes get a cell that can be fetched.
  HWY_INLINE void Fit(const PacketVolume& v, const SampleCells& cells, Mf lanes)
  {
    this->Voxels.Fit(v, cells, lanes, this->Offsets);
  }

  /// Uses cells at offsets, elements, that the caller knows.
  HWY_INLINE void Set(const PacketVolume& v, const int offsets[16])
  {
    this->Voxels.Set(v);
    std::copy_n(offsets, 16, this->Offsets);
  }

  /// All voxels are at hand for Gradient().
  HWY_INLINE void Widen() const {}

  /// Whether the outermost voxels are repeated beyond the volume.
  static constexpr bool IsRepeating() { return false; }

  HWY_INLINE typename Fetch<T>::Row Row(int dy, int dz) const
  {
    return Fetch<T>::LoadRow(this->Voxels.Get(), this->Offsets, this->Delta(dy, dz));
  }
  HWY_INLINE typename Fetch<T>::Along Middle(int dy, int dz, const SamplePosition& at) const
  {
    return Fetch<T>::Middle(this->Voxels.Get(), this->Offsets, this->Delta(dy, dz), at);
  }

private:
  HWY_INLINE int Delta(int dy, int dz) const
  {
    return dy * this->Voxels.Get().IncrementY + dz * this->Voxels.Get().IncrementZ;
  }

  VoxelsInReach Voxels;
  HWY_ALIGN int Offsets[16]; ///< elements
};

/// Rows of voxels as OffsetRows, or those of any cells, with the outermost voxels of the volume
/// repeated beyond it.
template <class T>
class FaceRows
{
public:
  /// Whether Repeat() can be used: not where a slice may be out of reach, or a line too short.
  static HWY_INLINE bool CanRepeat(const PacketVolume& v)
  {
    return v.SlicesInReach <= 0 && v.Dimensions[0] >= 4;
  }

  /// As OffsetRows::Fit().
  HWY_INLINE void Fit(const PacketVolume& v, const SampleCells& cells, Mf lanes)
  {
    this->Repeating = false;
    this->Inner.Fit(v, cells, lanes);
  }

  /// Fetches from all cells. Keeps a pointer to `v`.
  HWY_INLINE void Repeat(const PacketVolume& v, const SampleCells& cells)
  {
    const Di di;
    const Vi zero = hn::Zero(di);
    this->Repeating = true;
    this->Volume = &v;
    this->First = hn::Eq(cells.X, zero);
    this->Last = hn::Eq(cells.X, hn::Set(di, v.Dimensions[0] - 2));
    this->AtEnds = !hn::AllFalse(di, hn::Or(this->First, this->Last));
    this->X = hn::Min(hn::Max(cells.X, hn::Set(di, 1)), hn::Set(di, v.Dimensions[0] - 3));
    for (int i = 0; i < 4; ++i)
    {
      const auto offset = [&](Vi cell, int a, int increment) {
        const Vi place = hn::Add(cell, hn::Set(di, i - 1));
        return hn::Mul(
          hn::Min(hn::Max(place, zero), hn::Set(di, v.Dimensions[a] - 1)), hn::Set(di, increment));
      };
      this->Y[i] = offset(cells.Y, 1, v.IncrementY);
      this->Z[i] = offset(cells.Z, 2, v.IncrementZ);
    }
  }

  HWY_INLINE void Widen() const {}

  HWY_INLINE bool IsRepeating() const { return this->Repeating; }

  HWY_INLINE typename Fetch<T>::Row Row(int dy, int dz) const
  {
    if (HWY_LIKELY(!this->Repeating))
    {
      return this->Inner.Row(dy, dz);
    }
    HWY_ALIGN int offsets[16];
    hn::Store(hn::Add(this->X, hn::Add(this->Y[1 + dy], this->Z[1 + dz])), Di(), offsets);
    const auto row = Fetch<T>::LoadRow(*this->Volume, offsets, 0);
    return this->AtEnds ? Fetch<T>::Repeat(row, this->First, this->Last) : row;
  }

  HWY_INLINE typename Fetch<T>::Along Middle(int dy, int dz, const SamplePosition& at) const
  {
    return HWY_LIKELY(!this->Repeating) ? this->Inner.Middle(dy, dz, at)
                                        : Fetch<T>::Middle(this->Row(dy, dz), at);
  }

private:
  bool Repeating = false;
  bool AtEnds = false; ///< of lines along x
  OffsetRows<T> Inner;
  const PacketVolume* Volume = nullptr;
  Mi First;
  Mi Last;
  Vi X;    ///< of the first voxel of the cell from which a line has all four, elements
  Vi Y[4]; ///< of lines from one before the cell to one behind it, elements
  Vi Z[4];
};

/// Trilinear scalar of interior lanes; rows are kept for Gradient.
template <class T, class Source>
HWY_INLINE Vf Sample(const Source& source, const SamplePosition& at, SampleRows<T>& rows)
{
  using F = Fetch<T>;
  rows.R00 = source.Row(0, 0);
  rows.R10 = source.Row(1, 0);
  rows.R01 = source.Row(0, 1);
  rows.R11 = source.Row(1, 1);
  rows.M00 = F::Middle(rows.R00, at);
  rows.M10 = F::Middle(rows.R10, at);
  rows.M01 = F::Middle(rows.R01, at);
  rows.M11 = F::Middle(rows.R11, at);
  return F::Value(Across<T>(at, rows.M00, rows.M10, rows.M01, rows.M11), at);
}

/**
 * f(q + e) - f(q - e) by index coordinates, e one voxel along each axis: central differences of
 * interpolated samples, from the 32 voxels that the seven samples touch. The inner eight, and the
 * eight beside them along x, come with the sample.
 */
template <class T, class Source>
HWY_INLINE Vec3 Gradient(const Source& source, const SamplePosition& at, const SampleRows<T>& rows)
{
  using F = Fetch<T>;
  const auto middle = [&](int dy, int dz) { return source.Middle(dy, dz, at); };
  const Vec3 g{ //
    Across<T>(at, Slope<T>(at, rows.R00), Slope<T>(at, rows.R10), Slope<T>(at, rows.R01),
      Slope<T>(at, rows.R11)),
    Across<T>(at, hn::Sub(rows.M10, middle(-1, 0)), hn::Sub(middle(2, 0), rows.M00),
      hn::Sub(rows.M11, middle(-1, 1)), hn::Sub(middle(2, 1), rows.M01)),
    Across<T>(at, hn::Sub(rows.M01, middle(0, -1)), hn::Sub(rows.M11, middle(1, -1)),
      hn::Sub(middle(0, 2), rows.M00), hn::Sub(middle(1, 2), rows.M10))
  };
  return F::Difference(g, at);
}

/// Values one voxel behind and one voxel before samples along each axis.
struct NeighborValues
{
  Vf Behind[3];
  Vf Before[3];
};

/// The values whose differences Gradient() gives, from the same voxels.
template <class T, class Source>
HWY_INLINE NeighborValues FindNeighborValues(
  const Source& source, const SamplePosition& at, const SampleRows<T>& rows)
{
  using F = Fetch<T>;
  using Along = typename F::Along;
  const auto value = [&](Along a00, Along a10, Along a01, Along a11) FFD_INLINE_LAMBDA {
    return F::Value(Across<T>(at, a00, a10, a01, a11), at);
  };
  const auto middle = [&](int dy, int dz) { return source.Middle(dy, dz, at); };
  const auto behind = [&](const typename F::Row& row) { return F::Behind(row, at); };
  const auto before = [&](const typename F::Row& row) { return F::Before(row, at); };
  NeighborValues of;
  of.Behind[0] = value(behind(rows.R00), behind(rows.R10), behind(rows.R01), behind(rows.R11));
  of.Before[0] = value(before(rows.R00), before(rows.R10), before(rows.R01), before(rows.R11));
  of.Behind[1] = value(rows.M10, middle(2, 0), rows.M11, middle(2, 1));
  of.Before[1] = value(middle(-1, 0), rows.M00, middle(-1, 1), rows.M01);
  of.Behind[2] = value(rows.M01, rows.M11, middle(0, 2), middle(1, 2));
  of.Before[2] = value(middle(0, -1), middle(1, -1), rows.M00, rows.M10);
  return of;
}

/// The positions around which FindDifferences() takes differences: in the volume, or of the nearest
/// voxels.
HWY_INLINE Vec3 FindMiddle(const PacketVolume& v, const Vec3& q)
{
  const auto within = [&](Vf x, int a) {
    const Vf last = Splat(static_cast<float>(v.Dimensions[a] - 1));
    const Vf inside = Clamp(x, hn::Zero(Df()), last);
    return v.Nearest ? hn::Min(hn::Floor(hn::Add(inside, Splat(0.5f))), last) : inside;
  };
  return { within(q.x, 0), within(q.y, 1), within(q.z, 2) };
}

/// The coordinate of a position.
HWY_INLINE Vf& CoordinateOf(Vec3& q, int a) { return a == 0 ? q.x : a == 1 ? q.y : q.z; }

/// Moves positions of FindMiddle() by `step` voxels along an axis, in the volume.
HWY_INLINE Vec3 MoveAlong(const PacketVolume& v, Vec3 middle, int a, float step)
{
  Vf& x = CoordinateOf(middle, a);
  x =
    Clamp(hn::Add(x, Splat(step)), hn::Zero(Df()), Splat(static_cast<float>(v.Dimensions[a] - 1)));
  return middle;
}

/// The positions, voxel coordinates, between which gradients are differences along each axis.
struct DifferenceEnds
{
  Vec3 Behind[3];
  Vec3 Before[3];
};

/// Those of FindDifferences() at voxel coordinates, where no cell is hidden.
HWY_NOINLINE inline DifferenceEnds FindEnds(const PacketVolume& v, const Vec3& voxel)
{
  const Vec3 middle = FindMiddle(v, voxel);
  DifferenceEnds ends;
  for (int a = 0; a < 3; ++a)
  {
    ends.Behind[a] = MoveAlong(v, middle, a, 1.0f);
    ends.Before[a] = MoveAlong(v, middle, a, -1.0f);
  }
  return ends;
}

/// Rescales gradients from repeated voxels at q: their differences are over less than two voxels at
/// the faces of the volume.
HWY_INLINE Vec3 AtFaces(const PacketVolume& v, const Vec3& q, const Vec3& gradient)
{
  const Vec3 middle = FindMiddle(v, q);
  const auto scale = [&](Vf x, int a) {
    const Vf one = Splat(1.0f);
    const Vf after = hn::Min(hn::Add(x, one), Splat(static_cast<float>(v.Dimensions[a] - 1)));
    return hn::Div(Splat(2.0f), hn::Sub(after, hn::Max(hn::Sub(x, one), hn::Zero(Df()))));
  };
  return { hn::Mul(gradient.x, scale(middle.x, 0)), hn::Mul(gradient.y, scale(middle.y, 1)),
    hn::Mul(gradient.z, scale(middle.z, 2)) };
}

/// The gradients, as Gradient() gives them, of what has these values around the samples q, of which
/// those of `border` lie at faces.
HWY_INLINE Vec3 GradientOfNeighbors(
  const PacketVolume& v, const Vec3& q, Mf border, const NeighborValues& of)
{
  const auto difference = [&](int a) { return hn::Sub(of.Behind[a], of.Before[a]); };
  const Vec3 gradient{ difference(0), difference(1), difference(2) };
  return HWY_LIKELY(hn::AllFalse(Df(), border)) ? gradient
                                                : Select(border, AtFaces(v, q, gradient), gradient);
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
