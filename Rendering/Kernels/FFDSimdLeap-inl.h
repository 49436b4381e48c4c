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
    Vf NotLow;  ///< far, if no ray moves towards the lower face; else zero
    Vf NotHigh;

    HWY_INLINE Axis(Vf v0, Vf v1, Vf ds)
    {
      const Vf zero = hn::Zero(Df());
      const Vf lo = hn::Min(v0, v1);
      const Vf hi = hn::Max(v0, v1);
      const Vf speed = hn::Mul(hn::Max(hi, hn::Neg(lo)), ds);
      this->Inverse = hn::Div(Splat(1.0f), hn::Max(speed, Splat(1e-9f)));
      this->NotLow = hn::IfThenElseZero(hn::Ge(lo, zero), Splat(1e30f));
      this->NotHigh = hn::IfThenElseZero(hn::Le(hi, zero), Splat(1e30f));
    }

    /// Of what is free on both sides of the block, in index units: `margin`.
    HWY_INLINE Vf Steps(Vf x, Vf block, Vf margin) const
    {
      const Vf inBlock = hn::NegMulAdd(Splat(BlockEdge), block, x);
      const Vf low = hn::Add(inBlock, this->NotLow);
      const Vf high = hn::Add(hn::Sub(Splat(BlockEdge), inBlock), this->NotHigh);
      return hn::Mul(hn::Add(margin, hn::Min(low, high)), this->Inverse);
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

  static HWY_INLINE PacketLook Nothing()
  {
    const Vf zero = hn::Zero(Df());
    const Mf nobody = hn::FirstN(Df(), 0);
    PacketLook look;
    look.Position = { zero, zero, zero };
    look.Block = look.Position;
    look.Distance = zero;
    look.Empty = nobody;
    look.Outside = nobody;
    return look;
  }

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

  /// Take the cubes of an earlier look for those of `lanes` whose positions are still in them.
  HWY_INLINE Mf FindKept(const Vec3& q, Mf lanes) const
  {
    const auto within = [&](Vf x, Vf block)
    {
      const Vf edge = Splat(BlockEdge);
      const Vf one = Splat(1.0f);
      return hn::And(
        hn::Gt(x, hn::Mul(edge, hn::Sub(hn::Add(block, one), this->Distance))),
        hn::Lt(x, hn::Mul(edge, hn::Add(block, this->Distance))));
    };
    return hn::And(hn::And(lanes, this->Empty),
      hn::And(within(q.x, this->Block.x),
        hn::And(within(q.y, this->Block.y), within(q.z, this->Block.z))));
  }

  /// What `other` knows of its `lanes`, at the positions here.
  HWY_INLINE void Take(const PacketLook& other, Mf lanes)
  {
    this->Block = { hn::IfThenElse(lanes, other.Block.x, this->Block.x),
      hn::IfThenElse(lanes, other.Block.y, this->Block.y),
      hn::IfThenElse(lanes, other.Block.z, this->Block.z) };
    this->Distance = hn::IfThenElse(lanes, other.Distance, this->Distance);
    this->Empty = hn::Or(hn::AndNot(lanes, this->Empty), hn::And(lanes, other.Empty));
    this->Outside = hn::AndNot(lanes, this->Outside);
  }

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
  LeapSlack()
  {
    for (int a = 0; a < 3; ++a)
    {
      this->Low[a] = hn::Zero(Df());
      this->High[a] = hn::Zero(Df());
    }
    this->Clear();
  }

  /// Nothing is known of any lane.
  HWY_INLINE void Clear() { this->Forget(hn::FirstN(Df(), hn::Lanes(Df()))); }

  /// Nothing is known of these lanes.
  HWY_INLINE void Forget(Mf lanes)
  {
    this->Low[0] = hn::IfThenElse(lanes, Splat(-Far), this->Low[0]);
  }

  /// Keep the distances of the lanes of `look`, less `more` on each axis (index units).
  HWY_INLINE void Find(
    const PacketScene& scene, const PacketLook& look, Mf lanes, const float more[3])
  {
    const Df d;
    const Vf edge = Splat(BlockEdge);
    const Vf far = Splat(Far);
    const Vf axis[3] = { look.Position.x, look.Position.y, look.Position.z };
    const Vf blocks[3] = { look.Block.x, look.Block.y, look.Block.z };
    for (int a = 0; a < 3; ++a)
    {
      const Vf low = hn::Sub(
        axis[a], hn::Mul(edge, hn::Sub(hn::Add(blocks[a], Splat(1.0f)), look.Distance)));
      const Vf high = hn::Sub(hn::Mul(edge, hn::Add(blocks[a], look.Distance)), axis[a]);
      const auto less = [&](Vf distance)
      { return hn::Sub(hn::IfThenElse(look.Empty, distance, far), Splat(more[a])); };
      this->Low[a] = hn::IfThenElse(lanes, less(low), this->Low[a]);
      this->High[a] = hn::IfThenElse(lanes, less(high), this->High[a]);
    }
    const Mf outside = hn::And(lanes, look.Outside);
    if (!hn::AllFalse(d, outside))
    {
      this->FindOutside(scene, axis, outside, more);
    }
    this->Forget(hn::AndNot(look.GetFree(), lanes));
  }

  /**
   * Follow the lanes over a piece of length dt with velocities [lo, hi]; returns those that stay
   * inside of their boxes by `guard` (index units).
   */
  HWY_INLINE Mf Pass(Mf lanes, const float lo[3], const float hi[3], float dt, float guard)
  {
    const Df d;
    Vf least = Splat(Far);
    for (int a = 0; a < 3; ++a)
    {
      // Distance that is gained on a face the rays move away from is not counted.
      const Vf down = hn::IfThenElseZero(lanes, Splat(std::min(lo[a], 0.0f) * dt));
      const Vf up = hn::IfThenElseZero(lanes, Splat(std::max(hi[a], 0.0f) * dt));
      this->Low[a] = hn::Add(this->Low[a], down);
      this->High[a] = hn::Sub(this->High[a], up);
      least = hn::Min(least, hn::Min(this->Low[a], this->High[a]));
    }
    const Mf inside = hn::Ge(least, Splat(guard));
    this->Forget(hn::AndNot(inside, hn::FirstN(d, hn::Lanes(d))));
    return inside;
  }

private:
  static constexpr float Far = 1e30f;

  /// Outside of the volume: the half space beyond the side a position is farthest from.
  HWY_INLINE void FindOutside(
    const PacketScene& scene, const Vf axis[3], Mf outside, const float more[3])
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
      this->Low[a] = hn::IfThenElse(outside, hn::Sub(low, Splat(more[a])), this->Low[a]);
      this->High[a] = hn::IfThenElse(outside, hn::Sub(high, Splat(more[a])), this->High[a]);
    }
  }

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
      const float guard = FindLeapGuard(this->Scene, span);
      empty = this->Pass(lo, hi, length, guard) ||
        (this->Find(span, number * this->Grid.GetStepsPerSpan()) &&
          this->Pass(lo, hi, length, guard));
    }
    this->Valid = empty;
    this->Scratch.EmptySpans.push_back(empty ? 1 : 0);
  }

  bool Pass(const float lo[3], const float hi[3], float length, float guard)
  {
    const Df d;
    const Mf all = hn::FirstN(d, hn::Lanes(d));
    for (int b = 0; b < Bundles && this->Valid; ++b)
    {
      this->Valid = hn::AllTrue(d, this->Slack[b].Pass(all, lo, hi, length, guard));
    }
    return this->Valid;
  }

  bool Find(const TileSpans::Span& span, int step)
  {
    const Df d;
    const TileLayer& layer = this->Grid.GetLayer(step);
    const float radius[3] = { static_cast<float>(span.NodeRadius.x),
      static_cast<float>(span.NodeRadius.y), static_cast<float>(span.NodeRadius.z) };
    this->Valid = true;
    for (int b = 0; b < Bundles && this->Valid; ++b)
    {
      const std::size_t i = static_cast<std::size_t>(b) * hn::Lanes(d);
      const Vec3 q{ hn::LoadU(d, layer.X + i), hn::LoadU(d, layer.Y + i),
        hn::LoadU(d, layer.Z + i) };
      const Mf all = hn::FirstN(d, hn::Lanes(d));
      const PacketLook look(this->Scene, q, all, this->Scratch.Statistics);
      this->Valid = hn::AllTrue(d, look.GetFree());
      this->Slack[b].Find(this->Scene, look, all, radius);
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
