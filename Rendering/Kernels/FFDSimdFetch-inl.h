// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Trilinear samples and their gradients, a position a lane. Included once per target of Highway.
#if defined(FFD_SIMD_FETCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_FETCH_INL_H_
#undef FFD_SIMD_FETCH_INL_H_
#else
#define FFD_SIMD_FETCH_INL_H_
#endif

#include "FFDPacketVolume.h"
#include "FFDScalarDispatch.h"

#include "FFDSimdMath-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Where the lanes sample: cell, position in it, offset of its first voxel.
struct SamplePosition
{
  Vf Fx;
  Vf Fy;
  Vf Fz;
  HWY_ALIGN int Offsets[16]; ///< elements
  Mf Interior; ///< the voxels one further out on each side exist, too
};

/// Values of four neighbouring voxels of a row, from one before the cell to one behind it.
struct Row4
{
  Vf A;
  Vf B;
  Vf C;
  Vf D;
};

/// First voxel, along an axis, of the cell that holds a position.
HWY_INLINE Vf CellOf(const PacketVolume& v, Vf x, int a)
{
  return hn::Floor(
    Clamp(x, hn::Zero(Df()), Splat(static_cast<float>(v.Dimensions[a] - 2))));
}

/// `lanes`: those that will be sampled.
HWY_INLINE SamplePosition FindCells(const PacketVolume& v, const Vec3& q, Mf lanes)
{
  const Df d;
  const Di di;
  const Vf x = CellOf(v, q.x, 0);
  const Vf y = CellOf(v, q.y, 1);
  const Vf z = CellOf(v, q.z, 2);
  SamplePosition at;
  at.Fx = hn::Sub(q.x, x);
  at.Fy = hn::Sub(q.y, y);
  at.Fz = hn::Sub(q.z, z);
  if (v.Nearest)
  {
    // The nearest voxel is linear interpolation with weights of zero and one.
    const auto snap = [&](Vf f)
    { return hn::IfThenElseZero(hn::Ge(f, Splat(0.5f)), Splat(1.0f)); };
    at.Fx = snap(at.Fx);
    at.Fy = snap(at.Fy);
    at.Fz = snap(at.Fz);
  }
  const auto within = [&](Vf c, int a)
  {
    return hn::And(hn::Ge(c, Splat(1.0f)), hn::Le(c, Splat(static_cast<float>(v.Dimensions[a] - 3))));
  };
  at.Interior = hn::And(within(x, 0), hn::And(within(y, 1), within(z, 2)));
  const Vi offset = hn::Add(hn::ConvertTo(di, x),
    hn::Add(hn::Mul(hn::ConvertTo(di, y), hn::Set(di, v.IncrementY)),
      hn::Mul(hn::ConvertTo(di, z), hn::Set(di, v.IncrementZ))));
  // Lanes that may not be fetched from read the first cell that may.
  const Vi safe = hn::Set(di, 1 + v.IncrementY + v.IncrementZ);
  hn::Store(
    hn::IfThenElse(hn::RebindMask(di, hn::And(at.Interior, lanes)), offset, safe), di, at.Offsets);
  return at;
}

/**
 * Fetches for one scalar type. Offsets name the voxel at the start of the cell; a fetch may read
 * from the voxel before it to the second one behind it, never more.
 */
template <class T>
struct Fetch;

/// Stands for all types whose values single precision does not hold.
struct WideScalar
{
};

/// Wide types: one scalar load a lane, made relative to the table in double precision. The type is
/// looked at for each load, so that five types do not need five copies of everything.
template <>
struct Fetch<WideScalar>
{
  static HWY_NOINLINE Vf Load(const PacketVolume& v, const int* offsets, int delta)
  {
    const Df d;
    HWY_ALIGN float values[16];
    DispatchScalarType(v.Type,
      [&](auto zero)
      {
        const auto* p = static_cast<const decltype(zero)*>(v.Scalars) + delta;
        for (std::size_t i = 0; i < hn::Lanes(d); ++i)
        {
          values[i] = static_cast<float>((static_cast<double>(p[offsets[i]]) - v.Shift) * v.Scale);
        }
      });
    return hn::Load(d, values);
  }
  static Row4 LoadRow4(const PacketVolume& v, const int* offsets, int delta)
  {
    return { Load(v, offsets, delta - 1), Load(v, offsets, delta), Load(v, offsets, delta + 1),
      Load(v, offsets, delta + 2) };
  }
  static void LoadPair(const PacketVolume& v, const int* offsets, int delta, Vf& b, Vf& c)
  {
    b = Load(v, offsets, delta);
    c = Load(v, offsets, delta + 1);
  }
};

template <>
struct Fetch<float>
{
  static Vf Load(const PacketVolume& v, const int* offsets, int delta)
  {
    return LoadLanes<float, 4>(v.Scalars, 4 * static_cast<std::ptrdiff_t>(delta), offsets);
  }
  static Row4 LoadRow4(const PacketVolume& v, const int* offsets, int delta)
  {
    return { Load(v, offsets, delta - 1), Load(v, offsets, delta), Load(v, offsets, delta + 1),
      Load(v, offsets, delta + 2) };
  }
  static void LoadPair(const PacketVolume& v, const int* offsets, int delta, Vf& b, Vf& c)
  {
    b = Load(v, offsets, delta);
    c = Load(v, offsets, delta + 1);
  }
};

/// 8-bit types: one 32-bit load holds the four voxels of a row.
template <class T, bool Signed>
struct FetchBytes
{
  template <int Byte>
  static Vf Extract(Vi word)
  {
    const Df d;
    const Di di;
    if constexpr (Signed)
    {
      return hn::ConvertTo(d, hn::ShiftRight<24>(hn::ShiftLeft<24 - 8 * Byte>(word)));
    }
    else
    {
      return hn::ConvertTo(d, hn::And(hn::ShiftRight<8 * Byte>(word), hn::Set(di, 255)));
    }
  }
  static Row4 LoadRow4(const PacketVolume& v, const int* offsets, int delta)
  {
    const Vi word = LoadLanes<int, 1>(v.Scalars, delta - 1, offsets);
    return { Extract<0>(word), Extract<1>(word), Extract<2>(word), Extract<3>(word) };
  }
  static void LoadPair(const PacketVolume& v, const int* offsets, int delta, Vf& b, Vf& c)
  {
    const Vi word = LoadLanes<int, 1>(v.Scalars, delta - 1, offsets);
    b = Extract<1>(word);
    c = Extract<2>(word);
  }
};
template <>
struct Fetch<std::uint8_t> : FetchBytes<std::uint8_t, false>
{
};
template <>
struct Fetch<std::int8_t> : FetchBytes<std::int8_t, true>
{
};

/// 16-bit types: a 32-bit load holds two voxels.
template <class T, bool Signed>
struct FetchWords
{
  static Vf Low(Vi word)
  {
    const Df d;
    const Di di;
    if constexpr (Signed)
    {
      return hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(word)));
    }
    else
    {
      return hn::ConvertTo(d, hn::And(word, hn::Set(di, 0xFFFF)));
    }
  }
  static Vf High(Vi word)
  {
    const Df d;
    const Di di;
    if constexpr (Signed)
    {
      return hn::ConvertTo(d, hn::ShiftRight<16>(word));
    }
    else
    {
      return hn::ConvertTo(d, hn::And(hn::ShiftRight<16>(word), hn::Set(di, 0xFFFF)));
    }
  }
  static Vi Words(const PacketVolume& v, const int* offsets, int delta)
  {
    return LoadLanes<int, 2>(v.Scalars, 2 * static_cast<std::ptrdiff_t>(delta), offsets);
  }
  static Row4 LoadRow4(const PacketVolume& v, const int* offsets, int delta)
  {
    const Vi first = Words(v, offsets, delta - 1);
    const Vi second = Words(v, offsets, delta + 1);
    return { Low(first), High(first), Low(second), High(second) };
  }
  static void LoadPair(const PacketVolume& v, const int* offsets, int delta, Vf& b, Vf& c)
  {
    const Vi word = Words(v, offsets, delta);
    b = Low(word);
    c = High(word);
  }
};
template <>
struct Fetch<std::uint16_t> : FetchWords<std::uint16_t, false>
{
};
template <>
struct Fetch<std::int16_t> : FetchWords<std::int16_t, true>
{
};

/// The four rows of a cell, kept by a sample for its gradient.
struct SampleRows
{
  Row4 R00;
  Row4 R10; // y + 1
  Row4 R01; // z + 1
  Row4 R11;
};

/// Trilinear scalar of interior lanes; rows are kept for Gradient.
template <class T>
HWY_INLINE Vf Sample(const PacketVolume& v, const SamplePosition& at, SampleRows& rows)
{
  const int y = v.IncrementY;
  const int z = v.IncrementZ;
  rows.R00 = Fetch<T>::LoadRow4(v, at.Offsets, 0);
  rows.R10 = Fetch<T>::LoadRow4(v, at.Offsets, y);
  rows.R01 = Fetch<T>::LoadRow4(v, at.Offsets, z);
  rows.R11 = Fetch<T>::LoadRow4(v, at.Offsets, y + z);
  const auto along = [&](const Row4& r) { return Lerp(r.B, r.C, at.Fx); };
  return Lerp(Lerp(along(rows.R00), along(rows.R10), at.Fy),
    Lerp(along(rows.R01), along(rows.R11), at.Fy), at.Fz);
}

/**
 * f(q + e) - f(q - e) by index coordinates, e one voxel along each axis: central differences of
 * interpolated samples, from the 32 voxels that the seven samples touch. The inner eight, and the
 * eight beside them along x, come with the sample.
 */
template <class T>
HWY_INLINE Vec3 Gradient(const PacketVolume& v, const SamplePosition& at, const SampleRows& rows)
{
  const int y = v.IncrementY;
  const int z = v.IncrementZ;
  const auto slope = [&](const Row4& r)
  { return Lerp(hn::Sub(r.C, r.A), hn::Sub(r.D, r.B), at.Fx); };
  const auto along = [&](const Row4& r) { return Lerp(r.B, r.C, at.Fx); };
  const auto fetch = [&](int delta)
  {
    Vf b;
    Vf c;
    Fetch<T>::LoadPair(v, at.Offsets, delta, b, c);
    return Lerp(b, c, at.Fx);
  };
  const Vf r00 = along(rows.R00);
  const Vf r10 = along(rows.R10);
  const Vf r01 = along(rows.R01);
  const Vf r11 = along(rows.R11);
  Vec3 g;
  g.x = Lerp(Lerp(slope(rows.R00), slope(rows.R10), at.Fy),
    Lerp(slope(rows.R01), slope(rows.R11), at.Fy), at.Fz);
  g.y = Lerp(Lerp(hn::Sub(r10, fetch(-y)), hn::Sub(fetch(2 * y), r00), at.Fy),
    Lerp(hn::Sub(r11, fetch(z - y)), hn::Sub(fetch(z + 2 * y), r01), at.Fy), at.Fz);
  g.z = Lerp(Lerp(hn::Sub(r01, fetch(-z)), hn::Sub(r11, fetch(y - z)), at.Fy),
    Lerp(hn::Sub(fetch(2 * z), r00), hn::Sub(fetch(y + 2 * z), r10), at.Fy), at.Fz);
  return g;
}

/// What Gradient() gives of repeated voxels, over as much of the two voxels as the volume has.
HWY_INLINE Vec3 AtFaces(const PacketVolume& v, const Vec3& q, const Vec3& gradient)
{
  const auto scale = [&](Vf x, int a)
  {
    const Vf one = Splat(1.0f);
    const Vf after = hn::Min(hn::Add(x, one), Splat(static_cast<float>(v.Dimensions[a] - 1)));
    return hn::Div(Splat(2.0f), hn::Sub(after, hn::Max(hn::Sub(x, one), hn::Zero(Df()))));
  };
  return { hn::Mul(gradient.x, scale(q.x, 0)), hn::Mul(gradient.y, scale(q.y, 1)),
    hn::Mul(gradient.z, scale(q.z, 2)) };
}

/**
 * The 4 x 4 x 4 voxels around the cells of some lanes, those at the faces of the volume repeated
 * beyond it: with them a sample near a face is fetched as any other.
 */
template <class T>
class RepeatedVoxels
{
public:
  /// `lanes`: positions that lie between voxels of the volume, at least one.
  HWY_NOINLINE void Fill(const PacketVolume& v, const Vec3& q, Mf lanes)
  {
    const Df d;
    const Di di;
    this->View = v;
    this->View.Scalars = this->Voxels;
    this->View.IncrementY = Side;
    this->View.IncrementZ = Side * Side;
    HWY_ALIGN int cells[3][16];
    const auto locate = [&](Vf x, int a)
    {
      const Vf cell = CellOf(v, x, a);
      hn::Store(hn::ConvertTo(di, cell), di, cells[a]);
      return hn::Sub(x, cell);
    };
    this->At.Fx = locate(q.x, 0);
    this->At.Fy = locate(q.y, 1);
    this->At.Fz = locate(q.z, 2);
    this->At.Interior = lanes;
    HWY_ALIGN float flags[16];
    hn::Store(hn::IfThenElseZero(lanes, Splat(1.0f)), d, flags);
    int block = 0;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      // Where there is nothing to sample, voxels of others will do.
      this->At.Offsets[lane] = 1 + Side + Side * Side;
      if (flags[lane] != 0.0f)
      {
        const int cell[3] = { cells[0][lane], cells[1][lane], cells[2][lane] };
        Copy(v, cell, this->Voxels + block);
        this->At.Offsets[lane] += block;
        block += Side * Side * Side;
      }
    }
  }

  HWY_INLINE Vf Sample(SampleRows& rows) const
  {
    return HWY_NAMESPACE::Sample<T>(this->View, this->At, rows);
  }
  HWY_INLINE Vec3 Gradient(const SampleRows& rows) const
  {
    return HWY_NAMESPACE::Gradient<T>(this->View, this->At, rows);
  }

private:
  static constexpr int Side = 4;

  /// From one voxel before the cell to one behind it.
  static void Copy(const PacketVolume& v, const int cell[3], T* to)
  {
    const T* const from = static_cast<const T*>(v.Scalars);
    const auto place = [&](int a, int i)
    { return static_cast<std::ptrdiff_t>(std::clamp(cell[a] + i - 1, 0, v.Dimensions[a] - 1)); };
    const std::ptrdiff_t x[Side] = { place(0, 0), place(0, 1), place(0, 2), place(0, 3) };
    const bool whole = x[3] - x[0] == Side - 1;
    for (int k = 0; k < Side; ++k)
    {
      for (int j = 0; j < Side; ++j, to += Side)
      {
        // As words, which is how they are read: loads wait for smaller stores.
        const T* const row = from + place(1, j) * v.IncrementY + place(2, k) * v.IncrementZ;
        if (whole)
        {
          std::memcpy(to, row + x[0], Side * sizeof(T));
        }
        else
        {
          const T voxels[Side] = { row[x[0]], row[x[1]], row[x[2]], row[x[3]] };
          std::memcpy(to, voxels, sizeof(voxels));
        }
      }
    }
  }

  HWY_ALIGN T Voxels[16 * Side * Side * Side];
  PacketVolume View;
  SamplePosition At;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
