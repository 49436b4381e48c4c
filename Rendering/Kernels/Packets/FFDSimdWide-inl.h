// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Voxels of types whose values single precision does not hold. Included once per target of Highway.
#if defined(FFD_SIMD_WIDE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_WIDE_INL_H_
#undef FFD_SIMD_WIDE_INL_H_
#else
#define FFD_SIMD_WIDE_INL_H_
#endif

#include "FFDPacketVolume.h"
#include "FFDRounding.h"
#include "FFDScalarDispatch.h"

#include "FFDSimdMath-inl.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Four numbers of every lane.
struct Row4
{
  Vf A;
  Vf B;
  Vf C;
  Vf D;
};

/// Two numbers of every lane.
struct Row2
{
  Vf A;
  Vf B;
};

/// Loads neighboring numbers of every lane as (scalar - Shift) * Scale, in the order of the
/// components, which is found in double precision.
class WideVoxels
{
public:
  /// Those from `delta` elements behind the offset of each lane on.
  template <class Row>
  static HWY_INLINE Row Load(const PacketVolume& v, const int* offsets, std::ptrdiff_t delta)
  {
#if HWY_TARGET != HWY_SCALAR
    if (HWY_LIKELY(v.Type == ScalarType::Float64))
    {
      const Row row = LoadOf<double, Row>(v, offsets, delta);
      return HWY_LIKELY(!v.MayOverflow || IsFinite(row)) ? row
                                                         : LoadOneByOne<Row>(v, offsets, delta);
    }
#endif
    return LoadAny<Row>(v, offsets, delta);
  }

private:
  template <class Row>
  static HWY_NOINLINE Row LoadAny(const PacketVolume& v, const int* offsets, std::ptrdiff_t delta)
  {
#if HWY_TARGET != HWY_SCALAR
    Row row;
    bool known = true;
    switch (v.Type)
    {
      case ScalarType::Int32:
        row = LoadOf<std::int32_t, Row>(v, offsets, delta);
        break;
      case ScalarType::UInt32:
        row = LoadOf<std::uint32_t, Row>(v, offsets, delta);
        break;
      case ScalarType::Int64:
        row = LoadOf<std::int64_t, Row>(v, offsets, delta);
        break;
      case ScalarType::UInt64:
        row = LoadOf<std::uint64_t, Row>(v, offsets, delta);
        break;
      default:
        known = false;
        break;
    }
    if (HWY_LIKELY(known && (!v.MayOverflow || IsFinite(row))))
    {
      return row;
    }
#endif
    return LoadOneByOne<Row>(v, offsets, delta);
  }

  /// Keeps values beyond single precision finite.
  template <class Row>
  static HWY_NOINLINE Row LoadOneByOne(
    const PacketVolume& v, const int* offsets, std::ptrdiff_t delta)
  {
    constexpr int Count = sizeof(Row) / sizeof(Vf);
    const Df d;
    HWY_ALIGN float values[4][16];
    DispatchScalarType(v.Type, [&](auto zero) {
      const auto* const p = static_cast<const decltype(zero)*>(v.Scalars) + delta;
      for (std::size_t i = 0; i < hn::Lanes(d); ++i)
      {
        for (int k = 0; k < Count; ++k)
        {
          values[k][i] =
            ToSingle((static_cast<double>(p[offsets[i] + k]) - v.Shift[k]) * v.Scale[k]);
        }
      }
    });
    if constexpr (Count == 2)
    {
      return { hn::Load(d, values[0]), hn::Load(d, values[1]) };
    }
    else
    {
      return { hn::Load(d, values[0]), hn::Load(d, values[1]), hn::Load(d, values[2]),
        hn::Load(d, values[3]) };
    }
  }

#if HWY_TARGET != HWY_SCALAR
  using Doubles = hn::Repartition<double, Df>;
  using Halves = hn::Half<Df>; ///< as many floats as there are doubles

  static HWY_INLINE Mf IsBeyond(Vf values)
  {
    return hn::Gt(hn::Abs(values), Splat(std::numeric_limits<float>::max()));
  }
  static HWY_INLINE bool IsFinite(const Row2& row)
  {
    return hn::AllFalse(Df(), hn::Or(IsBeyond(row.A), IsBeyond(row.B)));
  }
  static HWY_INLINE bool IsFinite(const Row4& row)
  {
    return hn::AllFalse(Df(),
      hn::Or(hn::Or(IsBeyond(row.A), IsBeyond(row.B)), hn::Or(IsBeyond(row.C), IsBeyond(row.D))));
  }

  static HWY_INLINE auto ToFloats(
    hn::Vec<Doubles> scalars, hn::Vec<Doubles> shift, hn::Vec<Doubles> scale)
  {
    return hn::DemoteTo(Halves(), hn::Mul(hn::Sub(scalars, shift), scale));
  }

  /// Words of 32 bits, which are of type T and component c.
  template <class T>
  static HWY_INLINE Vf ToFloats(const PacketVolume& v, Vi words, int c)
  {
    const hn::Rebind<int, Halves> halves;
    const auto convert = [&](auto half) FFD_INLINE_LAMBDA {
      const auto shift = hn::Set(Doubles(), v.Shift[c]);
      const auto scale = hn::Set(Doubles(), v.Scale[c]);
      if constexpr (std::is_signed<T>::value)
      {
        return ToFloats(hn::PromoteTo(Doubles(), half), shift, scale);
      }
      else
      {
        // As signed ones, from which the vectors of all targets are made.
        constexpr int Lowest = std::numeric_limits<int>::min();
        const auto scalars = hn::PromoteTo(Doubles(), hn::Xor(half, hn::Set(halves, Lowest)));
        return ToFloats(
          hn::Add(scalars, hn::Set(Doubles(), -static_cast<double>(Lowest))), shift, scale);
      }
    };
    return hn::Combine(
      Df(), convert(hn::UpperHalf(halves, words)), convert(hn::LowerHalf(halves, words)));
  }

  /// Pairs of numbers of 64 bits that are of type T, components c and c + 1.
  template <class T>
  static HWY_INLINE auto PairsToFloats(const PacketVolume& v, Vf pairs, int c)
  {
    const auto shift = hn::Load(Doubles(), v.Shift + c);
    const auto scale = hn::Load(Doubles(), v.Scale + c);
    if constexpr (std::is_same<T, double>::value)
    {
      return ToFloats(hn::BitCast(Doubles(), pairs), shift, scale);
    }
    else
    {
      const auto whole = hn::BitCast(hn::Rebind<T, Doubles>(), pairs);
      return ToFloats(hn::ConvertTo(Doubles(), whole), shift, scale);
    }
  }

  /// Two numbers of 64 bits.
  template <class T>
  static HWY_INLINE auto LoadPair(const T* from)
  {
    return hn::BitCast(hn::CappedTag<float, 4>(), hn::LoadU(hn::CappedTag<T, 2>(), from));
  }

  /// Four numbers of 64 bits.
  template <class T>
  static HWY_INLINE auto LoadFour(const T* from)
  {
    return hn::BitCast(hn::CappedTag<float, 8>(), hn::LoadU(hn::CappedTag<T, 4>(), from));
  }

  template <class T, class Row>
  static HWY_INLINE Row LoadOf(const PacketVolume& v, const int* offsets, std::ptrdiff_t delta)
  {
    const Df d;
    constexpr int Blocks = static_cast<int>(hn::MaxLanes(Df())) / 4; // of 128 bits, in a vector
    const T* const scalars = static_cast<const T*>(v.Scalars) + delta;
    if constexpr (std::is_same<Row, Row2>::value && sizeof(T) == 4)
    {
      const Pairs words = LoadPairLanes<4>(scalars, 0, offsets);
      return { ToFloats<T>(v, words.x, 0), ToFloats<T>(v, words.y, 1) };
    }
    else if constexpr (std::is_same<Row, Row2>::value)
    {
      // The pairs of a quarter of the lanes.
      const auto part = [&](int i) FFD_INLINE_LAMBDA {
        const Vf pairs = JoinQuads(d, [&](int block) FFD_INLINE_LAMBDA {
          return LoadPair(scalars + offsets[Blocks * i + block]);
        });
        return PairsToFloats<T>(v, pairs, 0);
      };
      const Vf first = hn::Combine(d, part(1), part(0));
      const Vf second = hn::Combine(d, part(3), part(2));
      return { hn::ConcatEven(d, second, first), hn::ConcatOdd(d, second, first) };
    }
    else if constexpr (sizeof(T) == 4)
    {
      const Quads words = LoadQuadLanes<4>(scalars, 0, offsets);
      return { ToFloats<T>(v, words.x, 0), ToFloats<T>(v, words.y, 1), ToFloats<T>(v, words.z, 2),
        ToFloats<T>(v, words.w, 3) };
    }
    else
    {
      // A column has four numbers of each of its lanes, of which half a vector holds two or more.
      const auto half = [&](int k, int i) FFD_INLINE_LAMBDA {
        if constexpr (Blocks == 1)
        {
          return PairsToFloats<T>(v, LoadPair(scalars + offsets[k] + 2 * i), 2 * i);
        }
        else
        {
          constexpr int Rows = Blocks / 2;
          const auto load = [&](int row) FFD_INLINE_LAMBDA {
            return LoadFour(scalars + offsets[4 * (Rows * i + row) + k]);
          };
          if constexpr (Rows == 1)
          {
            return PairsToFloats<T>(v, load(0), 0);
          }
          else
          {
            return PairsToFloats<T>(v, hn::Combine(d, load(1), load(0)), 0);
          }
        }
      };
      const Quads words = TransposeColumns([&](int k) FFD_INLINE_LAMBDA {
        return hn::BitCast(Di(), hn::Combine(d, half(k, 1), half(k, 0)));
      });
      return { hn::BitCast(d, words.x), hn::BitCast(d, words.y), hn::BitCast(d, words.z),
        hn::BitCast(d, words.w) };
    }
  }
#endif
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
