// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Distance look-ups and leaps of packets. Included once per target of Highway.
#if defined(FFD_SIMD_LEAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_LEAP_INL_H_
#undef FFD_SIMD_LEAP_INL_H_
#else
#define FFD_SIMD_LEAP_INL_H_
#endif

#include "FFDMinMaxBlocks.h"
#include "FFDPacketCaster.h"

#include "FFDSimdMath-inl.h"
#include "FFDSimdTile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

constexpr float BlockEdge = static_cast<float>(MinMaxBlocks::BlockSize);

/// Distance, in blocks, of the block that holds each position of `inside`.
HWY_INLINE Vf LookUpDistance(const PacketScene& scene, const Vec3& q, Mf inside, Vec3& block)
{
  const Df d;
  const Di di;
  // A position on the upper face belongs to the last block.
  const auto blockOf = [&](Vf x, int a)
  {
    return hn::IfThenElseZero(inside,
      hn::Min(hn::Floor(hn::Mul(x, Splat(1.0f / BlockEdge))), Splat(scene.LastBlock[a])));
  };
  block = { blockOf(q.x, 0), blockOf(q.y, 1), blockOf(q.z, 2) };
  if (HWY_UNLIKELY(scene.Lower != 0.0f))
  {
    // What lies before the first voxels belongs to their blocks.
    const Vf zero = hn::Zero(d);
    block = { hn::Max(block.x, zero), hn::Max(block.y, zero), hn::Max(block.z, zero) };
  }
  const Vi index = hn::Add(hn::ConvertTo(di, block.x),
    hn::Mul(hn::Set(di, scene.Blocks[0]),
      hn::Add(hn::ConvertTo(di, block.y),
        hn::Mul(hn::Set(di, scene.Blocks[1]), hn::ConvertTo(di, block.z)))));
  HWY_ALIGN int offsets[16];
  hn::Store(index, di, offsets);
  const Vi word = LoadLanes<int, 1>(scene.Distances, 0, offsets);
  return hn::ConvertTo(d, hn::And(word, hn::Set(di, 255)));
}

HWY_INLINE Mf IsInside(const PacketScene& scene, const Vec3& q)
{
  const Vf lower = Splat(scene.Lower);
  const auto within = [&](Vf x, int a)
  { return hn::And(hn::Ge(x, lower), hn::Le(x, Splat(scene.Upper[a]))); };
  return hn::And(within(q.x, 0), hn::And(within(q.y, 1), within(q.z, 2)));
}

/**
 * How many samples of a piece each ray may pass over for certain: no ray moves farther along an
 * axis from sample to sample than the larger of its velocities at the two ends of a parabola.
 */
class PieceLeap
{
public:
  /// `v0`, `v1`: velocities at start and end of the piece, `ds`: parameter between samples.
  HWY_INLINE PieceLeap(const Vec3& v0, const Vec3& v1, Vf ds)
    : X(v0.x, v1.x, ds)
    , Y(v0.y, v1.y, ds)
    , Z(v0.z, v1.z, ds)
  {
  }

  /// Steps to the first sample that may lie outside of the empty cube around `block`; at least 1.
  HWY_INLINE Vf StepsInside(const Vec3& q, const Vec3& block, Vf distance) const
  {
    const Vf margin =
      hn::MulAdd(Splat(BlockEdge), distance, Splat(-BlockEdge - LeapGuard));
    return Whole(hn::Min(this->X.Steps(q.x, block.x, margin),
      hn::Min(this->Y.Steps(q.y, block.y, margin), this->Z.Steps(q.z, block.z, margin))));
  }

  /// The same for rays outside of the volume: to the first sample that may be inside.
  HWY_INLINE Vf StepsOutside(const PacketScene& scene, const Vec3& q) const
  {
    const auto beyond = [&](Vf x, int a, const Axis& axis)
    {
      const Vf gap = hn::Max(hn::Sub(Splat(scene.Lower), x), hn::Sub(x, Splat(scene.Upper[a])));
      return hn::Mul(hn::Sub(gap, Splat(LeapGuard)), axis.Inverse);
    };
    return Whole(hn::Max(
      beyond(q.x, 0, this->X), hn::Max(beyond(q.y, 1, this->Y), beyond(q.z, 2, this->Z))));
  }

private:
  static constexpr float LeapGuard = 1e-3f; ///< index units, rounding errors

  struct Axis
  {
    Vf Inverse; ///< samples for one index unit, at least
    Vf Offset;  ///< the face ahead: at Offset + Slope * position in its block
    Vf Slope;

    HWY_INLINE Axis(Vf v0, Vf v1, Vf ds)
    {
      const Vf zero = hn::Zero(Df());
      const Vf lo = hn::Min(v0, v1);
      const Vf hi = hn::Max(v0, v1);
      const Vf speed = hn::Mul(hn::Max(hi, hn::Neg(lo)), ds);
      this->Inverse = hn::Div(Splat(1.0f), hn::Max(speed, Splat(1e-9f)));
      const Mf up = hn::Ge(lo, zero);
      const Mf down = hn::Le(hi, zero);
      this->Offset = hn::IfThenElseZero(up, Splat(BlockEdge));
      // Rays that turn around count on neither face, only on the blocks between.
      this->Slope = hn::IfThenElse(
        up, Splat(-1.0f), hn::IfThenElseZero(down, Splat(1.0f)));
    }

    HWY_INLINE Vf Steps(Vf x, Vf block, Vf margin) const
    {
      const Vf inBlock = hn::NegMulAdd(Splat(BlockEdge), block, x);
      return hn::Mul(
        hn::Add(margin, hn::MulAdd(this->Slope, inBlock, this->Offset)), this->Inverse);
    }
  };

  static HWY_INLINE Vf Whole(Vf steps)
  {
    return hn::Add(Splat(1.0f), hn::Floor(Clamp(steps, hn::Zero(Df()), Splat(1e6f))));
  }

  Axis X;
  Axis Y;
  Axis Z;
};

/// What is around positions, one a lane: which of them stand in empty space, and how much of it.
struct PacketLook
{
  Vec3 Position;
  Vec3 Block;
  Vf Distance;
  Mf Empty;   ///< inside of the volume, in empty blocks
  Mf Outside; ///< of the volume

  PacketLook() = default;

  HWY_INLINE PacketLook(
    const PacketScene& scene, const Vec3& q, Mf lanes, CastStatistics& statistics)
    : Position(q)
  {
    const Df d;
    const Mf inside = hn::And(lanes, IsInside(scene, q));
    this->Distance = LookUpDistance(scene, q, inside, this->Block);
    this->Empty = hn::And(inside, hn::Gt(this->Distance, hn::Zero(d)));
    this->Outside = hn::AndNot(inside, lanes);
    statistics.DistanceLookups += static_cast<std::int64_t>(hn::CountTrue(d, this->Empty));
  }

  HWY_INLINE Mf GetFree() const { return hn::Or(this->Empty, this->Outside); }

  /// Samples that are empty for certain, from the position on; none where it is not free.
  HWY_INLINE Vf CountSteps(const PacketScene& scene, const PieceLeap& leaps) const
  {
    Vf steps = hn::IfThenElseZero(
      this->Empty, leaps.StepsInside(this->Position, this->Block, this->Distance));
    if (HWY_UNLIKELY(!hn::AllFalse(Df(), this->Outside)))
    {
      steps = hn::IfThenElse(this->Outside, leaps.StepsOutside(scene, this->Position), steps);
    }
    return steps;
  }
};

/**
 * What is left of the distances from positions, one a lane, to the faces of the empty boxes around
 * them, while they are followed along their rays without being evaluated: LIPSCHITZ.
 */
class LeapSlack
{
public:
  void Clear() { this->Valid = false; }

  /// Whether all lanes of `lanes` are free; if so, keep their distances, less `guard` on each axis
  /// (index units).
  HWY_INLINE bool Find(
    const PacketScene& scene, const PacketLook& look, Mf lanes, const float guard[3])
  {
    const Df d;
    this->Valid = hn::AllTrue(d, hn::Or(look.GetFree(), hn::Not(lanes)));
    if (!this->Valid)
    {
      return false;
    }
    const Vf edge = Splat(BlockEdge);
    const Vf far = Splat(Far);
    const Vf axis[3] = { look.Position.x, look.Position.y, look.Position.z };
    const Vf blocks[3] = { look.Block.x, look.Block.y, look.Block.z };
    for (int a = 0; a < 3; ++a)
    {
      const Vf low = hn::Sub(
        axis[a], hn::Mul(edge, hn::Sub(hn::Add(blocks[a], Splat(1.0f)), look.Distance)));
      const Vf high = hn::Sub(hn::Mul(edge, hn::Add(blocks[a], look.Distance)), axis[a]);
      this->Low[a] = hn::Sub(hn::IfThenElse(look.Empty, low, far), Splat(guard[a]));
      this->High[a] = hn::Sub(hn::IfThenElse(look.Empty, high, far), Splat(guard[a]));
    }
    if (!hn::AllFalse(d, look.Outside))
    {
      this->FindOutside(scene, axis, look.Outside, guard);
    }
    return true;
  }

  /// Whether a piece of length dt with velocities [lo, hi] stays inside; if so, pass it.
  HWY_INLINE bool Pass(const float lo[3], const float hi[3], float dt)
  {
    if (!this->Valid)
    {
      return false;
    }
    const Df d;
    Vf least = Splat(Far);
    for (int a = 0; a < 3; ++a)
    {
      // Distance that is gained on a face the rays move away from is not counted.
      this->Low[a] = hn::Add(this->Low[a], Splat(std::min(lo[a], 0.0f) * dt));
      this->High[a] = hn::Sub(this->High[a], Splat(std::max(hi[a], 0.0f) * dt));
      least = hn::Min(least, hn::Min(this->Low[a], this->High[a]));
    }
    this->Valid = hn::AllTrue(d, hn::Ge(least, hn::Zero(d)));
    return this->Valid;
  }

private:
  static constexpr float Far = 1e30f;

  /// Outside of the volume: the half space beyond the side a position is farthest from.
  HWY_INLINE void FindOutside(
    const PacketScene& scene, const Vf axis[3], Mf outside, const float guard[3])
  {
    const Vf far = Splat(Far);
    Vf below[3];
    Vf above[3];
    Vf most = Splat(-Far);
    for (int a = 0; a < 3; ++a)
    {
      below[a] = hn::Sub(Splat(scene.Lower), axis[a]);
      above[a] = hn::Sub(axis[a], Splat(scene.Upper[a]));
      most = hn::Max(most, hn::Max(below[a], above[a]));
    }
    for (int a = 0; a < 3; ++a)
    {
      // Back through the side it is beyond of is what a ray outside may not go.
      const Vf low = hn::IfThenElse(hn::Eq(above[a], most), above[a], far);
      const Vf high = hn::IfThenElse(hn::Eq(below[a], most), below[a], far);
      this->Low[a] = hn::IfThenElse(outside, hn::Sub(low, Splat(guard[a])), this->Low[a]);
      this->High[a] = hn::IfThenElse(outside, hn::Sub(high, Splat(guard[a])), this->High[a]);
    }
  }

  bool Valid = false;
  Vf Low[3];
  Vf High[3];
};

/// What leaps keep away from visible blocks over a span, index units: errors of positions.
HWY_INLINE float FindLeapGuard(const PacketScene& scene, const TileSpans::Span& span)
{
  constexpr float Rounding = 2e-3f;
  return static_cast<float>(span.PositionError + 2.0 * scene.Settings.InverseTolerance) + Rounding;
}

/**
 * Which spans are empty for all rays of a tile: the 4 x 4 nodes are followed as a bundle, each
 * standing for the rays around it. Found span by span from the first, as far as anybody asks.
 */
class TileBeam
{
public:
  TileBeam(const PacketScene& scene, TileGrid& grid, PacketScratch& scratch)
    : Scene(scene)
    , Grid(grid)
    , Scratch(scratch)
  {
    scratch.EmptySpans.clear();
  }

  HWY_INLINE bool IsEmpty(int index)
  {
    const std::size_t at = static_cast<std::size_t>(index - this->Scratch.Spans.GetFirst());
    while (this->Scratch.EmptySpans.size() <= at)
    {
      this->Next();
    }
    return this->Scratch.EmptySpans[at] != 0;
  }

private:
  static constexpr int Bundles = TileNodes / static_cast<int>(hn::MaxLanes(Df()));

  HWY_NOINLINE void Next()
  {
    TileSpans& spans = this->Scratch.Spans;
    const int number = static_cast<int>(this->Scratch.EmptySpans.size());
    const TileSpans::Span& span = spans.Get(spans.GetFirst() + number);
    bool empty = span.Bounded;
    if (empty)
    {
      const float lo[3] = { static_cast<float>(span.VelocityMin.x),
        static_cast<float>(span.VelocityMin.y), static_cast<float>(span.VelocityMin.z) };
      const float hi[3] = { static_cast<float>(span.VelocityMax.x),
        static_cast<float>(span.VelocityMax.y), static_cast<float>(span.VelocityMax.z) };
      const float length = static_cast<float>(spans.GetLength());
      empty = this->Pass(lo, hi, length) ||
        (this->Find(span, number * this->Grid.GetStepsPerSpan()) && this->Pass(lo, hi, length));
    }
    this->Valid = empty;
    this->Scratch.EmptySpans.push_back(empty ? 1 : 0);
  }

  bool Pass(const float lo[3], const float hi[3], float length)
  {
    for (int b = 0; b < Bundles && this->Valid; ++b)
    {
      this->Valid = this->Slack[b].Pass(lo, hi, length);
    }
    return this->Valid;
  }

  bool Find(const TileSpans::Span& span, int step)
  {
    const Df d;
    const TileLayer& layer = this->Grid.GetLayer(step);
    const float guard = FindLeapGuard(this->Scene, span);
    const float guards[3] = { guard + static_cast<float>(span.NodeRadius.x),
      guard + static_cast<float>(span.NodeRadius.y),
      guard + static_cast<float>(span.NodeRadius.z) };
    this->Valid = true;
    for (int b = 0; b < Bundles && this->Valid; ++b)
    {
      const std::size_t i = static_cast<std::size_t>(b) * hn::Lanes(d);
      const Vec3 q{ hn::LoadU(d, layer.X + i), hn::LoadU(d, layer.Y + i),
        hn::LoadU(d, layer.Z + i) };
      const Mf all = hn::FirstN(d, hn::Lanes(d));
      const PacketLook look(this->Scene, q, all, this->Scratch.Statistics);
      this->Valid = this->Slack[b].Find(this->Scene, look, all, guards);
    }
    return this->Valid;
  }

  const PacketScene& Scene;
  TileGrid& Grid;
  PacketScratch& Scratch;
  bool Valid = false;
  LeapSlack Slack[Bundles];
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
