// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Looks up transfer functions: in registers, or in tables. Included once per target of Highway.
#if defined(FFD_SIMD_LOOKUP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_LOOKUP_INL_H_
#undef FFD_SIMD_LOOKUP_INL_H_
#else
#define FFD_SIMD_LOOKUP_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDTransferTable.h"

#include "FFDSimdMath-inl.h"
#include "FFDSimdPieces-inl.h"
#include "FFDSimdTable-inl.h"

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// The opacity over `length` that an extinction gives; zero for zero.
HWY_INLINE Vf OpacityOver(Vf extinction, float length)
{
  return hn::IfThenElseZero(hn::Gt(extinction, hn::Zero(Df())),
    hn::Sub(Splat(1.0f), Exp2(hn::Neg(hn::Mul(extinction, Splat(length))))));
}

/// The extinction that gives `length` an opacity; an opacity of one is opaque over any interval.
HWY_INLINE Vf ExtinctionOver(Vf opacity, float length)
{
  const Vf one = Splat(1.0f);
  // For small opacities 1 - opacity loses digits, but its logarithm is nearly linear.
  const Vf passed = hn::Sub(one, opacity);
  const Vf logarithm = hn::IfThenElse(hn::Lt(opacity, Splat(1e-3f)),
    hn::Mul(hn::Mul(opacity, Splat(1.4426950409f)), hn::MulAdd(opacity, Splat(0.5f), one)),
    hn::Neg(Log2(hn::Max(passed, Splat(1e-30f)))));
  const Vf depth = hn::IfThenElse(hn::Ge(opacity, one),
    Splat(static_cast<float>(TransferTable::OpaqueExtinction)), hn::Max(logarithm, hn::Zero(Df())));
  return hn::Mul(depth, Splat(1.0f / length));
}

/// Looks values up in transfer functions; Color() interpolates when it is called.
class OpticsLookup
{
public:
  OpticsLookup() = default;

  /// `values`: as they are fetched (PacketVolume); `table`: number of the table.
  HWY_INLINE OpticsLookup(const PacketScene& scene, Vf values, std::size_t table = 0)
  {
    const PiecewiseOptics& optics = scene.Table.GetPieces(table);
    this->Length = optics.Length;
    this->ByPieces = PieceLookup::Knows(optics);
    if (HWY_LIKELY(this->ByPieces))
    {
      this->Pieces = PieceLookup(optics, values);
      this->Density = this->Pieces.Opacity();
    }
    else
    {
      this->Table = TableLookup(scene, values, table);
      this->Density = this->Table.Extinction();
    }
  }

  /// `tables`: number of the table of each lane, whose opacities are over the same length.
  HWY_INLINE OpticsLookup(const PacketScene& scene, Vf values, Vi tables)
  {
    if (HWY_LIKELY(IsCommon(tables)))
    {
      *this = OpticsLookup(scene, values, static_cast<std::size_t>(hn::GetLane(tables)));
      return;
    }
    this->Length = scene.Table.GetPieces(0).Length;
    this->Table = TableLookup(scene, values, tables);
    this->Density = this->Table.Extinction();
  }

  HWY_INLINE Mf IsVisible() const { return hn::Gt(this->Density, hn::Zero(Df())); }

  /// Over PiecewiseOptics::Length.
  HWY_INLINE Vf Opacity() const
  {
    return HWY_LIKELY(this->ByPieces) ? this->Density : OpacityOver(this->Density, this->Length);
  }

  /// Per data unit, where PacketScene::ByExtinctions is true.
  HWY_INLINE Vf Extinction() const { return this->Density; }

  HWY_INLINE Vec3 Color() const
  {
    return HWY_LIKELY(this->ByPieces) ? this->Pieces.Color() : this->Table.Color();
  }

private:
  bool ByPieces = false;
  float Length = 1.0f;
  Vf Density; ///< opacity of pieces, extinction of tables
  PieceLookup Pieces;
  TableLookup Table;
};

/// Opacities of values over the unit distance; of what is no number that of the first entry.
HWY_INLINE Vf FindOpacity(const PacketScene& scene, Vf values, std::size_t table)
{
  const PiecewiseOptics& optics = scene.Table.GetUnitPieces(table);
  if (HWY_LIKELY(PieceLookup::Knows(optics)))
  {
    return PieceLookup(optics, values).Opacity();
  }
  const PacketTable::Range& range = scene.Table.GetRange(table);
  const Vf entry =
    FindEntries(values, Splat(range.Low), Splat(range.Scale), Splat(range.Intervals));
  const Vf whole = hn::Min(hn::Floor(entry), Splat(range.Intervals - 1.0f));
  const Vi first = hn::Add(hn::Set(Di(), range.First), Truncate(whole));
  return hn::Max(
    hn::Zero(Df()), InterpolatePairs(scene.Table.GetOpacities(), first, hn::Sub(entry, whole)));
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
