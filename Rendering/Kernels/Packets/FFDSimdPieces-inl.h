// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Looks up piecewise linear transfer functions in registers, a value a lane. Included once per
// target of Highway.
#if defined(FFD_SIMD_PIECES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PIECES_INL_H_
#undef FFD_SIMD_PIECES_INL_H_
#else
#define FFD_SIMD_PIECES_INL_H_
#endif

#include "FFDPiecewiseOptics.h"

#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// The elements `numbers` of an array of twice as many as there are lanes.
HWY_INLINE Vf SelectOfTwo(const float* elements, Vi numbers)
{
  const Df d;
  const Vf first = hn::Load(d, elements);
  const Vf second = hn::Load(d, elements + hn::Lanes(d));
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
  return Vf{ _mm512_permutex2var_ps(first.raw, numbers.raw, second.raw) };
#else
  const Di di;
  const Vi lanes = hn::Set(di, static_cast<int>(hn::Lanes(d)));
  const Mf isFirst = hn::RebindMask(d, hn::Lt(numbers, lanes));
  const auto at = hn::IndicesFromVec(d, hn::And(numbers, hn::Sub(lanes, hn::Set(di, 1))));
  return hn::IfThenElse(isFirst, hn::TableLookupLanes(first, at), hn::TableLookupLanes(second, at));
#endif
}

/// Looks values up in PiecewiseOptics; Opacity() and Color() interpolate when they are called.
class PieceLookup
{
public:
  /// Whether the pieces fit in two vectors, and are there.
  static HWY_INLINE bool Knows(const PiecewiseOptics& optics)
  {
    return optics.Pieces > 0 && optics.Pieces <= 2 * static_cast<int>(hn::Lanes(Df()));
  }

  PieceLookup() = default;

  /// `values`: as they are fetched; what is no number counts as the first one of the first piece.
  HWY_INLINE PieceLookup(const PiecewiseOptics& optics, Vf values)
    : Optics(&optics)
    , Piece(hn::Zero(Di()))
  {
    const Vf value = Clamp(values, Splat(optics.Begin[0]), Splat(optics.End));
    constexpr int FewPieces = 8;
    if (HWY_LIKELY(optics.Pieces <= FewPieces))
    {
      for (int i = 1; i < optics.Pieces; ++i)
      {
        this->AddReached(value, Splat(optics.Begin[i]), 1);
      }
    }
    else
    {
      this->Bisect(value);
    }
    const Vf offset = hn::Sub(value, this->Select(optics.Begin, this->Piece));
    this->Offset = hn::IfThenElseZero(hn::Eq(offset, offset), offset);
  }

  /// Over PiecewiseOptics::Length.
  HWY_INLINE Vf Opacity() const { return hn::Max(hn::Zero(Df()), this->Find(0)); }

  HWY_INLINE Vec3 Color() const { return { this->Find(1), this->Find(2), this->Find(3) }; }

private:
  /// Adds `pieces` where the values have reached `begin`.
  HWY_INLINE void AddReached(Vf value, Vf begin, int pieces)
  {
    const Di di;
    this->Piece = hn::Add(this->Piece,
      hn::IfThenElseZero(hn::RebindMask(di, hn::Ge(value, begin)), hn::Set(di, pieces)));
  }

  HWY_INLINE void Bisect(Vf value)
  {
    const float* const begin = this->Optics->Begin;
    const int lanes = static_cast<int>(hn::Lanes(Df()));
    if (!this->FitsInOne())
    {
      this->AddReached(value, Splat(begin[lanes]), lanes);
    }
    for (int step = lanes / 2; step > 0; step /= 2)
    {
      this->AddReached(value, this->Select(begin, hn::Add(this->Piece, hn::Set(Di(), step))), step);
    }
  }

  HWY_INLINE bool FitsInOne() const
  {
    return this->Optics->Pieces <= static_cast<int>(hn::Lanes(Df()));
  }

  HWY_INLINE Vf Select(const float* ofPieces, Vi pieces) const
  {
    const Df d;
    return HWY_LIKELY(this->FitsInOne())
      ? hn::TableLookupLanes(hn::Load(d, ofPieces), hn::IndicesFromVec(d, pieces))
      : SelectOfTwo(ofPieces, pieces);
  }

  HWY_INLINE Vf Find(int channel) const
  {
    const PiecewiseOptics::Channel& of = this->Optics->Channels[channel];
    return hn::MulAdd(
      this->Offset, this->Select(of.Slope, this->Piece), this->Select(of.Begin, this->Piece));
  }

  const PiecewiseOptics* Optics = nullptr;
  Vi Piece;
  Vf Offset; ///< from where the piece begins
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
