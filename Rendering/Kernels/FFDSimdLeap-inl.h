// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Empty-space queries and leaps. Included once per target of Highway.
#if defined(FFD_SIMD_LEAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_LEAP_INL_H_
#undef FFD_SIMD_LEAP_INL_H_
#else
#define FFD_SIMD_LEAP_INL_H_
#endif

#include "FFDDistanceMap.h"
#include "FFDMinMaxBlocks.h"
#include "FFDPacketCaster.h"

#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdMath-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Numbers, along an axis, of the blocks that hold positions. Positions outside of the volume count
/// as in the nearest block.
HWY_INLINE Vf BlockOf(const PacketScene& scene, Vf x, int a)
{
  constexpr float PerVoxel = 1.0f / static_cast<float>(MinMaxBlocks::BlockSize);
  return hn::Floor(Clamp(hn::Mul(x, Splat(PerVoxel)), hn::Zero(Df()), Splat(scene.LastBlock[a])));
}

/// The codes of blocks (DistanceMap::GetData()).
HWY_INLINE Vi CodesOf(const PacketScene& scene, const Vf block[3])
{
  const Di di;
  const Vi index = hn::Add(Truncate(block[0]),
    hn::Mul(hn::Set(di, scene.Blocks[0]),
      hn::Add(Truncate(block[1]), hn::Mul(hn::Set(di, scene.Blocks[1]), Truncate(block[2])))));
  HWY_ALIGN int offsets[16];
  StoreIndices(index, offsets);
  return hn::And(LoadLanes<int, 1>(scene.Distances, 0, offsets), hn::Set(di, 0xff));
}

/// Looks up the bounds of the values in boxes from the lowest corners of the lanes, whose sides fit
/// in a cell of `grid`.
HWY_INLINE Vi PeaksFrom(const ValuePeaks::Grid& grid, const Vec3& low)
{
  const Df d;
  const Di di;
  const Vf perVoxel = Splat(1.0f / grid.Edge);
  const auto along = [&](Vf x, int a) {
    const Vf last = Splat(static_cast<float>(grid.Size[a] - 1));
    return Truncate(Clamp(hn::Mul(x, perVoxel), hn::Zero(d), last));
  };
  const Vi index = hn::Add(along(low.x, 0),
    hn::Mul(hn::Set(di, grid.Size.x),
      hn::Add(along(low.y, 1), hn::Mul(hn::Set(di, grid.Size.y), along(low.z, 2)))));
  HWY_ALIGN int offsets[16];
  StoreIndices(index, offsets);
  return hn::And(LoadLanes<int, 1>(grid.Codes.data(), 0, offsets), hn::Set(di, 0xff));
}

/// No radius: boxes that are points.
constexpr float NoRadius[3] = {};

/// The steps that boxes take to move by an index unit up and down along each axis, at least.
struct BoxSteps
{
  Vf PerUp[3];
  Vf PerDown[3];

  /// A step moves by at most `up` and `down`, index units, not negative, times `scale`.
  BoxSteps(const float up[3], const float down[3], float scale)
  {
    for (int a = 0; a < 3; ++a)
    {
      this->PerUp[a] = Splat(1.0f / std::max(scale * up[a], Slowest));
      this->PerDown[a] = Splat(1.0f / std::max(scale * down[a], Slowest));
    }
  }

  /// A step moves by `move`, index units, or by something up to `change` from there.
  BoxSteps(const Vec3& move, const Vec3& change)
  {
    const auto find = [&](Vf v, Vf c, int a) {
      const auto steps = [](
                           Vf most) { return hn::Div(Splat(1.0f), hn::Max(most, Splat(Slowest))); };
      this->PerUp[a] = steps(hn::Add(c, v));
      this->PerDown[a] = steps(hn::Sub(c, v));
    };
    find(move.x, change.x, 0);
    find(move.y, change.y, 1);
    find(move.z, change.z, 2);
  }

private:
  static constexpr float Slowest = 1e-6f;
};

/// Asks the distance map about boxes around positions, no wider than a block, by one look-up:
/// whether they are empty, and how far they may move in the empty cube around their first block.
class EmptySpaceQuery
{
public:
  /// `q`: index coordinates; positions outside of the volume count as in the nearest block.
  HWY_INLINE EmptySpaceQuery(const PacketScene& scene, const Vec3& q, const float radius[3])
  {
    const Df d;
    const Di di;
    const Vf position[3] = { q.x, q.y, q.z };
    Vf block[3];
    Vi sides = hn::Zero(di);
    for (int a = 0; a < 3; ++a)
    {
      const Vf r = Splat(radius[a]);
      this->Begin[a] = hn::Sub(position[a], r);
      this->End[a] = hn::Add(position[a], r);
      block[a] = BlockOf(scene, this->Begin[a], a);
      const Mf beyond = hn::Gt(BlockOf(scene, this->End[a], a), block[a]);
      sides = hn::Or(sides, hn::IfThenElseZero(hn::RebindMask(di, beyond), hn::Set(di, 1 << a)));
    }
    const Vi code = CodesOf(scene, block);
    const auto isNear = hn::Gt(code, hn::Set(di, DistanceMap::NearCode - 1));
    // The bit `sides` of these tells that something may be visible.
    const Vi ofNear = hn::ShiftLeft<1>(hn::Sub(code, hn::Set(di, DistanceMap::NearCode)));
    const Vi ofOthers = hn::IfThenElseZero(hn::Eq(code, hn::Zero(di)), hn::Set(di, 0xff));
    const Vi bits = hn::And(hn::IfThenElse(isNear, ofNear, ofOthers) >> sides, hn::Set(di, 1));
    this->Empty = hn::RebindMask(d, hn::Eq(bits, hn::Zero(di)));
    const Vf distance = hn::ConvertTo(d, hn::IfThenElse(isNear, hn::Set(di, 1), code));
    const Vf zero = hn::Zero(d);
    const Vf edge = Splat(BlockEdge);
    const Vf far = Splat(Far);
    for (int a = 0; a < 3; ++a)
    {
      // The blocks at the faces extend beyond the volume.
      const Vf low = hn::Add(hn::Sub(block[a], distance), Splat(1.0f));
      const Vf high = hn::Add(block[a], distance);
      this->Low[a] = hn::IfThenElse(hn::Le(low, zero), hn::Neg(far), hn::Mul(edge, low));
      this->High[a] =
        hn::IfThenElse(hn::Gt(high, Splat(scene.LastBlock[a])), far, hn::Mul(edge, high));
    }
  }

  /// Lanes whose boxes are empty.
  HWY_INLINE Mf IsEmpty() const { return this->Empty; }

  /// Counts the steps, a whole number, after which each lane's box, extended by `radius`, is still
  /// in its empty cube; negative if it is not in it at all.
  HWY_INLINE Vf CountSteps(const float radius[3], const BoxSteps& box) const
  {
    Vf steps = Splat(Most);
    for (int a = 0; a < 3; ++a)
    {
      const Vf r = Splat(radius[a]);
      const Vf above = hn::Sub(hn::Sub(this->High[a], this->End[a]), r);
      const Vf below = hn::Sub(hn::Sub(this->Begin[a], this->Low[a]), r);
      steps = hn::Min(steps, hn::Min(hn::Mul(above, box.PerUp[a]), hn::Mul(below, box.PerDown[a])));
    }
    return hn::IfThenElse(this->Empty, hn::Floor(steps), Splat(-1.0f));
  }

private:
  static constexpr float BlockEdge = static_cast<float>(MinMaxBlocks::BlockSize);
  static constexpr float Far = 1e30f;
  static constexpr float Most = 1e6f;

  // The boxes, and the empty cubes around their first blocks.
  Vf Begin[3];
  Vf End[3];
  Vf Low[3];
  Vf High[3];
  Mf Empty;
};

/// Whether FindEmptyBoxes() tells of all empty boxes of a radius that they are empty.
inline bool CanQueryBoxes(const std::array<float, 3>& radius)
{
  return std::max({ radius[0], radius[1], radius[2] }) <=
    static_cast<float>(MinMaxBlocks::BlockSize);
}

/// Finds the lanes of `lanes` whose boxes around q are known to be empty. `steps`: at most, and not
/// negative, after which they still are, see EmptySpaceQuery.
HWY_INLINE Mf FindEmptyBoxes(const PacketScene& scene, const Vec3& q,
  const std::array<float, 3>& radius, const BoxSteps& moves, Mf lanes, Vf& steps)
{
  const Df d;
  const Vf zero = hn::Zero(d);
  int parts[3];
  float part[3];
  bool whole = true;
  for (std::size_t a = 0; a < 3; ++a)
  {
    parts[a] = 2.0f * radius[a] <= static_cast<float>(MinMaxBlocks::BlockSize) ? 1 : 2;
    part[a] = radius[a] / static_cast<float>(parts[a]);
    whole = whole && parts[a] == 1;
  }
  if (HWY_LIKELY(whole))
  {
    const EmptySpaceQuery query(scene, q, part);
    steps = hn::Max(query.CountSteps(NoRadius, moves), zero);
    return hn::And(lanes, query.IsEmpty());
  }
  const EmptySpaceQuery middle(scene, q, NoRadius);
  steps = middle.CountSteps(radius.data(), moves);
  const Mf inCube = hn::And(lanes, hn::Ge(steps, zero));
  steps = hn::Max(steps, zero);
  if (!CanQueryBoxes(radius))
  {
    return inCube;
  }
  // Boxes that are wider than a block are asked about in halves.
  Mf others = hn::AndNot(inCube, hn::And(lanes, middle.IsEmpty()));
  for (int i = 0; i < parts[0] * parts[1] * parts[2] && !hn::AllFalse(d, others); ++i)
  {
    const auto middleOf = [&](Vf x, int a, int number) {
      return parts[a] == 1 ? x : hn::Add(x, Splat(number == 0 ? -part[a] : part[a]));
    };
    const Vec3 at{ middleOf(q.x, 0, i % parts[0]), middleOf(q.y, 1, i / parts[0] % parts[1]),
      middleOf(q.z, 2, i / parts[0] / parts[1]) };
    others = hn::And(others, EmptySpaceQuery(scene, at, part).IsEmpty());
  }
  return hn::Or(inCube, others);
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
