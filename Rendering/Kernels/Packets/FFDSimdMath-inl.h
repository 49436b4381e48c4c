// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Small vector types and functions of the packet kernels. Included once per target of Highway.
#if defined(FFD_SIMD_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_MATH_INL_H_
#undef FFD_SIMD_MATH_INL_H_
#else
#define FFD_SIMD_MATH_INL_H_
#endif

#include "FFDPacketVolume.h"

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

// GCC does not put lambdas in line by itself that several places call.
#undef FFD_INLINE_LAMBDA
#if HWY_COMPILER_GCC || HWY_COMPILER_CLANG
#define FFD_INLINE_LAMBDA __attribute__((always_inline))
#else
#define FFD_INLINE_LAMBDA
#endif

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{
namespace hn = hwy::HWY_NAMESPACE;

/// Lanes of a packet: neighboring rays, at most 16.
using Df = hn::CappedTag<float, 16>;
using Di = hn::RebindToSigned<Df>;
using Vf = hn::Vec<Df>;
using Vi = hn::Vec<Di>;
using Mf = hn::Mask<Df>;
using Mi = hn::Mask<Di>;

/// Three coordinates of every lane.
struct Vec3
{
  Vf x;
  Vf y;
  Vf z;
};

/// A copy for functions that are not in line and seldom called: what is copied as a whole, or whose
/// address is passed on, compilers keep in memory wherever else it is used.
HWY_INLINE Vec3 Copy(const Vec3& v) { return { v.x, v.y, v.z }; }

HWY_INLINE Vf Splat(float value) { return hn::Set(Df(), value); }

HWY_INLINE Vec3 Broadcast(const float v[3]) { return { Splat(v[0]), Splat(v[1]), Splat(v[2]) }; }

HWY_INLINE Vf Clamp(Vf x, Vf lo, Vf hi) { return hn::Min(hn::Max(x, lo), hi); }

/// The whole parts of numbers that fit 32 bits: hn::ConvertTo() without the saturation of those
/// that do not.
HWY_INLINE Vi Truncate(Vf v)
{
#if !HWY_ARCH_X86 || HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
  return hn::ConvertTo(Di(), v);
#elif HWY_TARGET <= HWY_AVX3
  return Vi{ _mm512_cvttps_epi32(v.raw) };
#elif HWY_TARGET == HWY_AVX2
  return Vi{ _mm256_cvttps_epi32(v.raw) };
#else
  return Vi{ _mm_cvttps_epi32(v.raw) };
#endif
}

/// a + t * (b - a)
HWY_INLINE Vf Lerp(Vf a, Vf b, Vf t) { return hn::MulAdd(t, hn::Sub(b, a), a); }
HWY_INLINE Vec3 Lerp(const Vec3& a, const Vec3& b, Vf t)
{
  return { Lerp(a.x, b.x, t), Lerp(a.y, b.y, t), Lerp(a.z, b.z, t) };
}

HWY_INLINE Vf Dot(const Vec3& a, const Vec3& b)
{
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE Vec3 Cross(const Vec3& a, const Vec3& b)
{
  return { hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
    hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)), hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x)) };
}

HWY_INLINE Vec3 Add(const Vec3& a, const Vec3& b)
{
  return { hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z) };
}

HWY_INLINE Vec3 Sub(const Vec3& a, const Vec3& b)
{
  return { hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z) };
}

/// a + s * b
HWY_INLINE Vec3 MulAdd(Vf s, const Vec3& b, const Vec3& a)
{
  return { hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z) };
}

HWY_INLINE Vec3 Scale(Vf s, const Vec3& a)
{
  return { hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z) };
}

/// The next smaller number of each lane; of positive ones.
HWY_INLINE Vf JustBelow(Vf x)
{
  const Di di;
  return hn::BitCast(Df(), hn::Sub(hn::BitCast(di, x), hn::Set(di, 1)));
}

/// The lanes of `mask` from `yes`, the others from `no`.
HWY_INLINE Vec3 Select(Mf mask, const Vec3& yes, const Vec3& no)
{
  return { hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
    hn::IfThenElse(mask, yes.z, no.z) };
}

/// m * a for a 3 x 3 matrix stored row by row.
HWY_INLINE Vec3 Transform(const float m[9], const Vec3& a)
{
  const auto row = [&](const float* r) {
    return hn::MulAdd(Splat(r[0]), a.x, hn::MulAdd(Splat(r[1]), a.y, hn::Mul(Splat(r[2]), a.z)));
  };
  return { row(m), row(m + 3), row(m + 6) };
}

#if HWY_TARGET != HWY_SCALAR
/**
 * Vector whose lanes 4 b + k are lane k of quad(b), a function that returns 128 bits. Not for
 * vectors of fewer than four lanes.
 */
template <class D, class Quad>
HWY_INLINE auto JoinQuads(D d, const Quad& quad)
{
  constexpr std::size_t Lanes = hn::MaxLanes(D());
  if constexpr (Lanes == 4)
  {
    return quad(0);
  }
  else
  {
    const hn::CappedTag<hn::TFromD<D>, 8> half;
    const auto low = hn::Combine(half, quad(1), quad(0));
    if constexpr (Lanes == 8)
    {
      return low;
    }
    else
    {
      return hn::Combine(d, hn::Combine(half, quad(3), quad(2)), low);
    }
  }
}
#endif

/**
 * Does what a gather of unaligned words does, `Scale` bytes an offset: loads lane by lane, which
 * take less time than the gathers of the processors measured (NOTES.md). `offsets`: one per lane.
 */
template <class Word, int Scale>
HWY_INLINE auto LoadLanes(const void* base, std::ptrdiff_t bytes, const int* offsets)
{
  static_assert(sizeof(Word) == sizeof(float), "words of 32 bits are loaded");
  const hn::Rebind<Word, Df> d;
  const char* from = static_cast<const char*>(base) + bytes;
  // As floats, which compilers load into vector registers without a detour.
  const auto load = [&](int lane) FFD_INLINE_LAMBDA {
    float word;
    std::memcpy(&word, from + static_cast<std::ptrdiff_t>(offsets[lane]) * Scale, sizeof(word));
    return word;
  };
#if HWY_TARGET == HWY_SCALAR
  return hn::BitCast(d, hn::Set(Df(), load(0)));
#else
  return hn::BitCast(d, JoinQuads(Df(), [&](int block) FFD_INLINE_LAMBDA {
    const int first = 4 * block;
    HWY_ALIGN const float words[4] = { load(first), load(first + 1), load(first + 2),
      load(first + 3) };
    return hn::Load(hn::CappedTag<float, 4>(), words);
  }));
#endif
}

/// 1 - f and f, in units of 1 / FixedOne, in the lower and the upper half of each lane; 0 <= f
/// <= 1.
HWY_INLINE Vi PairWeights(Vf f)
{
  const Vi upper = Truncate(hn::MulAdd(f, Splat(static_cast<float>(FixedOne)), Splat(0.5f)));
  return hn::Add(hn::Sub(hn::ShiftLeft<16>(upper), upper), hn::Set(Di(), FixedOne));
}

/// Sum of the products of the signed lower halves and of the upper halves of each lane.
HWY_INLINE Vi MultiplyPairs(Vi a, Vi b)
{
#if HWY_TARGET == HWY_SCALAR
  const auto low = [](Vi v) { return hn::ShiftRight<16>(hn::ShiftLeft<16>(v)); };
  return hn::Add(hn::Mul(low(a), low(b)), hn::Mul(hn::ShiftRight<16>(a), hn::ShiftRight<16>(b)));
#else
  const Di di;
  const hn::Repartition<std::int16_t, Di> halves;
  Vi odd = hn::Zero(di);
  const Vi even = hn::ReorderWidenMulAccumulate(
    di, hn::BitCast(halves, a), hn::BitCast(halves, b), hn::Zero(di), odd);
  return hn::RearrangeToOddPlusEven(even, odd);
#endif
}

/// Stores numbers that are read one by one: compilers that see the store take them out of the
/// vector instead, which takes more instructions than to load them.
HWY_INLINE void StoreIndices(Vi indices, int (&to)[16])
{
  hn::Store(indices, Di(), to);
#if HWY_COMPILER_GCC || HWY_COMPILER_CLANG
  asm("" : "+m"(to));
#endif
}

/// The bytes at places, a whole number a lane; three more may be read behind the last one.
HWY_INLINE Vi LoadBytes(const std::uint8_t* bytes, Vi places)
{
  HWY_ALIGN int offsets[16];
  StoreIndices(places, offsets);
  return hn::And(LoadLanes<int, 1>(bytes, 0, offsets), hn::Set(Di(), 0xff));
}

/// Whether a number is the same in all lanes.
HWY_INLINE bool IsCommon(Vi numbers)
{
  const Di di;
  return hn::AllTrue(di, hn::Eq(numbers, hn::Set(di, hn::GetLane(numbers))));
}

/// Four words of every lane.
struct Quads
{
  Vi x;
  Vi y;
  Vi z;
  Vi w;
};

#if HWY_TARGET != HWY_SCALAR
/// The words of every lane, of which column(k) returns those of lanes k, k + 4, k + 8 .., 128 bits
/// of each, in one vector.
template <class Column>
HWY_INLINE Quads TransposeColumns(const Column& column)
{
  const Di di;
  const Vi a = column(0);
  const Vi b = column(1);
  const Vi c = column(2);
  const Vi e = column(3);
  // Transposition of 4 x 4 words in every block of 128 bits.
  const hn::Repartition<std::uint64_t, Di> pairs;
  const auto lowAB = hn::BitCast(pairs, hn::InterleaveLower(di, a, b));
  const auto lowCE = hn::BitCast(pairs, hn::InterleaveLower(di, c, e));
  const auto highAB = hn::BitCast(pairs, hn::InterleaveUpper(di, a, b));
  const auto highCE = hn::BitCast(pairs, hn::InterleaveUpper(di, c, e));
  return { hn::BitCast(di, hn::InterleaveLower(pairs, lowAB, lowCE)),
    hn::BitCast(di, hn::InterleaveUpper(pairs, lowAB, lowCE)),
    hn::BitCast(di, hn::InterleaveLower(pairs, highAB, highCE)),
    hn::BitCast(di, hn::InterleaveUpper(pairs, highAB, highCE)) };
}

/// The words of load(lane), 128 bits for each lane; permute(v) is applied to several of them at
/// once, in blocks of 128 bits.
template <class Load, class Permute>
HWY_INLINE Quads TransposeQuads(const Load& load, const Permute& permute)
{
  return TransposeColumns([&](int k) FFD_INLINE_LAMBDA {
    return permute(
      JoinQuads(Di(), [&](int block) FFD_INLINE_LAMBDA { return load(4 * block + k); }));
  });
}
#endif

/// Does what LoadLanes() does with 128 bits, permuted as by TransposeQuads().
template <int Scale, class Permute>
HWY_INLINE Quads LoadQuadLanes(
  const void* base, std::ptrdiff_t bytes, const int* offsets, const Permute& permute)
{
#if HWY_TARGET == HWY_SCALAR
  static_cast<void>(permute);
  return { LoadLanes<int, Scale>(base, bytes, offsets),
    LoadLanes<int, Scale>(base, bytes + 4, offsets),
    LoadLanes<int, Scale>(base, bytes + 8, offsets),
    LoadLanes<int, Scale>(base, bytes + 12, offsets) };
#else
  const char* from = static_cast<const char*>(base) + bytes;
  const hn::CappedTag<std::uint8_t, 16> d;
  return TransposeQuads(
    [&](int lane) FFD_INLINE_LAMBDA {
      return hn::BitCast(hn::CappedTag<int, 4>(),
        hn::LoadU(d,
          reinterpret_cast<const std::uint8_t*>(
            from + static_cast<std::ptrdiff_t>(offsets[lane]) * Scale)));
    },
    permute);
#endif
}

template <int Scale>
HWY_INLINE Quads LoadQuadLanes(const void* base, std::ptrdiff_t bytes, const int* offsets)
{
  return LoadQuadLanes<Scale>(
    base, bytes, offsets, [](Vi quads) FFD_INLINE_LAMBDA { return quads; });
}

/// Two words of every lane.
struct Pairs
{
  Vi x;
  Vi y;
};

/// Does what LoadLanes() does with 64 bits.
template <int Scale>
HWY_INLINE Pairs LoadPairLanes(const void* base, std::ptrdiff_t bytes, const int* offsets)
{
#if HWY_TARGET == HWY_SCALAR
  return { LoadLanes<int, Scale>(base, bytes, offsets),
    LoadLanes<int, Scale>(base, bytes + 4, offsets) };
#else
  const Di di;
  const char* from = static_cast<const char*>(base) + bytes;
  // As LoadLanes().
  const auto load = [&](int lane) FFD_INLINE_LAMBDA {
    double words;
    std::memcpy(&words, from + static_cast<std::ptrdiff_t>(offsets[lane]) * Scale, sizeof(words));
    return words;
  };
  // The pairs of lanes k and k + 1, k + 4 and k + 5 ... in one vector.
  const auto column = [&](int k) FFD_INLINE_LAMBDA {
    return JoinQuads(di, [&](int block) FFD_INLINE_LAMBDA {
      HWY_ALIGN const double pairs[2] = { load(4 * block + k), load(4 * block + k + 1) };
      return hn::BitCast(hn::CappedTag<int, 4>(), hn::Load(hn::CappedTag<double, 2>(), pairs));
    });
  };
  const Vi a = column(0);
  const Vi b = column(2);
  const Vi even = hn::InterleaveLower(di, a, b);
  const Vi odd = hn::InterleaveUpper(di, a, b);
  return { hn::InterleaveLower(di, even, odd), hn::InterleaveUpper(di, even, odd) };
#endif
}

/**
 * The four words at `table + 4 * index` of each lane: one load a lane and a transposition, where
 * four gathers would load four times.
 */
HWY_INLINE Quads LoadQuads(const std::uint32_t* table, Vi index)
{
  const int* words = reinterpret_cast<const int*>(table);
#if HWY_TARGET == HWY_SCALAR
  const Di di;
  const Vi at = hn::ShiftLeft<2>(index);
  return { hn::GatherIndex(di, words, at), hn::GatherIndex(di, words + 1, at),
    hn::GatherIndex(di, words + 2, at), hn::GatherIndex(di, words + 3, at) };
#else
  HWY_ALIGN int at[16];
  StoreIndices(hn::ShiftLeft<2>(index), at);
  return TransposeQuads(
    [&](int lane)
      FFD_INLINE_LAMBDA { return hn::LoadU(hn::CappedTag<int, 4>(), words + at[lane]); },
    [](Vi quads) FFD_INLINE_LAMBDA { return quads; });
#endif
}

HWY_INLINE float SmallestLane(Vf v) { return hn::GetLane(hn::MinOfLanes(Df(), v)); }

HWY_INLINE float LargestLane(Vf v) { return hn::GetLane(hn::MaxOfLanes(Df(), v)); }

/// 2^x for x <= 0; relative error below 3e-7, zero below -80.
HWY_INLINE Vf Exp2(Vf x)
{
  const Vf least = Splat(-80.0f);
  const Mf some = hn::Ge(x, least);
  x = hn::Max(x, least);
  const Vf whole = hn::Floor(x);
  const Vf f = hn::Sub(x, whole);
  // Minimax polynomial of 2^f on [0, 1].
  Vf p = Splat(1.8775767e-3f);
  p = hn::MulAdd(p, f, Splat(8.9893397e-3f));
  p = hn::MulAdd(p, f, Splat(5.5826318e-2f));
  p = hn::MulAdd(p, f, Splat(2.4015361e-1f));
  p = hn::MulAdd(p, f, Splat(6.9315308e-1f));
  p = hn::MulAdd(p, f, Splat(9.9999994e-1f));
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  return Vf{ _mm512_maskz_scalef_ps(some.raw, p.raw, whole.raw) };
#else
  const Vi exponent = hn::ShiftLeft<23>(hn::Add(Truncate(whole), hn::Set(Di(), 127)));
  return hn::IfThenElseZero(some, hn::Mul(p, hn::BitCast(Df(), exponent)));
#endif
}

/// 1 / x for normal x whose reciprocal is one; relative error below 3e-7.
HWY_INLINE Vf Reciprocal(Vf x)
{
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  // An estimate of 12 bits and more, and one step of Newton's method.
  const Vf y = hn::ApproximateReciprocal(x);
  return hn::Mul(y, hn::NegMulAdd(x, y, Splat(2.0f)));
#else
  return hn::Div(Splat(1.0f), x);
#endif
}

/// 1 / x for normal x whose reciprocal is one; relative error below 4e-4.
HWY_INLINE Vf RoughReciprocal(Vf x)
{
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  return hn::ApproximateReciprocal(x);
#else
  return hn::Div(Splat(1.0f), x);
#endif
}

/// log2(x) for positive normal x; absolute error below 1e-5.
HWY_INLINE Vf Log2(Vf x)
{
  const Df d;
  const Di di;
  const Vi bits = hn::BitCast(di, x);
  const Vi exponent = hn::Sub(hn::ShiftRight<23>(bits), hn::Set(di, 127));
  const Vi mantissa = hn::Or(hn::And(bits, hn::Set(di, 0x007FFFFF)), hn::Set(di, 0x3F800000));
  const Vf m = hn::BitCast(d, mantissa); // 1 <= m < 2
  // log2(m) = 2 / ln 2 * atanh(u), u = (m - 1) / (m + 1) <= 1 / 3.
  const Vf u = hn::Mul(hn::Sub(m, Splat(1.0f)), Reciprocal(hn::Add(m, Splat(1.0f))));
  const Vf u2 = hn::Mul(u, u);
  Vf s = Splat(1.0f / 9.0f);
  s = hn::MulAdd(s, u2, Splat(1.0f / 7.0f));
  s = hn::MulAdd(s, u2, Splat(1.0f / 5.0f));
  s = hn::MulAdd(s, u2, Splat(1.0f / 3.0f));
  s = hn::MulAdd(s, u2, Splat(1.0f));
  return hn::MulAdd(hn::Mul(Splat(2.8853900818f), u), s, hn::ConvertTo(d, exponent));
}

/// 1 / sqrt(x) for positive normal x; relative error below 3e-7.
HWY_INLINE Vf InverseSqrt(Vf x)
{
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  // Estimates of 12 bits and more, and one step of Newton's method.
  const Vf y = hn::ApproximateReciprocalSqrt(x);
  const Vf half = hn::Mul(hn::Mul(x, y), Splat(0.5f));
  return hn::Mul(y, hn::NegMulAdd(half, y, Splat(1.5f)));
#else
  return hn::Div(Splat(1.0f), hn::Sqrt(x));
#endif
}

/// 1 / sqrt(x) for positive normal x; relative error below 4e-4.
HWY_INLINE Vf RoughInverseSqrt(Vf x)
{
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  return hn::ApproximateReciprocalSqrt(x);
#else
  return hn::Div(Splat(1.0f), hn::Sqrt(x));
#endif
}

/// sqrt(x) for x >= 0 not near the largest number; relative error below 3e-7, from 1e-30 on.
HWY_INLINE Vf FastSqrt(Vf x) { return hn::Mul(x, InverseSqrt(hn::Max(x, Splat(1e-30f)))); }

/// x^power for 0 <= x and whole numbers power >= 0.
HWY_INLINE Vf WholePower(Vf x, int power)
{
  Vf result = (power & 1) != 0 ? x : Splat(1.0f);
  while ((power >>= 1) != 0)
  {
    x = hn::Mul(x, x);
    result = (power & 1) != 0 ? hn::Mul(result, x) : result;
  }
  return result;
}

/// x^power for 0 <= x <= 1; 0 where x is.
HWY_INLINE Vf Power(Vf x, float power)
{
  constexpr float LargestExponent = 100.0f;
  const Mf zero = hn::Lt(x, Splat(1e-20f));
  const Vf exponent = hn::Mul(Splat(power), Log2(hn::Max(x, Splat(1e-20f))));
  // By rounding x may be more than 1.
  const Vf y = Exp2(hn::Min(exponent, Splat(power < 0.0f ? LargestExponent : 0.0f)));
  return hn::IfThenZeroElse(zero, y);
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
