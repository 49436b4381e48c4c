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
#include "FFDPacketScene.h"

#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdMath-inl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

constexpr float BlocksPerVoxel = 1.0f / static_cast<float>(MinMaxBlocks::BlockSize);

/// The codes of blocks (DistanceMap::GetData()), in the lowest byte of each lane.
HWY_INLINE Vi LoadCodes(const PacketScene& scene, const Vi block[3])
{
  const Di di;
  const Vi index = hn::Add(block[0],
    hn::Mul(hn::Set(di, scene.Blocks[0]),
      hn::Add(block[1], hn::Mul(hn::Set(di, scene.Blocks[1]), block[2]))));
  HWY_ALIGN int offsets[16];
  StoreIndices(index, offsets);
  return LoadLanes<int, 1>(scene.Distances, 0, offsets);
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
  return LoadBytes(grid.Codes.data(), index);
}

/// Kept between boxes and the faces of cells that bound the values in them, index units: rounding
/// errors.
constexpr float PeakGuard = 2e-3f;

/// Whether boxes lie beyond a face of the volume.
HWY_INLINE Mf AreBesideVolume(const PacketScene& scene, const Vec3& low, const Vec3& high)
{
  const auto beside = [&](Vf from, Vf to, int a) {
    return hn::Or(hn::Lt(to, Splat(scene.Lower)), hn::Gt(from, Splat(scene.Upper[a])));
  };
  return hn::Or(
    beside(low.x, high.x, 0), hn::Or(beside(low.y, high.y, 1), beside(low.z, high.z, 2)));
}

/// The steps that points take to move by an index unit up and down along each axis, at least.
struct StepsPerUnit
{
  Vf Up[3];
  Vf Down[3];

  /// A step moves by at most `up` and `down`, index units, not negative.
  StepsPerUnit(const float up[3], const float down[3])
  {
    for (int a = 0; a < 3; ++a)
    {
      this->Up[a] = Splat(1.0f / std::max(up[a], Slowest));
      this->Down[a] = Splat(1.0f / std::max(down[a], Slowest));
    }
  }

  /// A step moves by `move`, index units, or by something up to `change` from there.
  StepsPerUnit(const Vec3& move, const Vec3& change)
  {
    const auto find = [&](Vf v, Vf c, int a) {
      const auto steps = [](
                           Vf most) { return hn::Div(Splat(1.0f), hn::Max(most, Splat(Slowest))); };
      this->Up[a] = steps(hn::Add(c, v));
      this->Down[a] = steps(hn::Sub(c, v));
    };
    find(move.x, change.x, 0);
    find(move.y, change.y, 1);
    find(move.z, change.z, 2);
  }

private:
  static constexpr float Slowest = 1e-6f;
};

/// The empty cubes of blocks around the blocks that hold positions, by the distance map.
class EmptyCubes
{
public:
  /// `q`: index coordinates; positions outside of the volume count as in the nearest block.
  HWY_INLINE EmptyCubes(const PacketScene& scene, const Vec3& q)
    : Position{ q.x, q.y, q.z }
  {
    const Df d;
    const Di di;
    const Vf zero = hn::Zero(d);
    Vi block[3];
    for (int a = 0; a < 3; ++a)
    {
      const Vf inBlocks = hn::Mul(this->Position[a], Splat(BlocksPerVoxel));
      block[a] = Truncate(Clamp(inBlocks, zero, Splat(scene.LastBlock[a])));
    }
    const Vi code = hn::And(LoadCodes(scene, block), hn::Set(di, 0xff));
    this->Empty = hn::RebindMask(d, hn::Gt(code, hn::Zero(di)));
    const auto isNear = hn::Gt(code, hn::Set(di, DistanceMap::NearCode - 1));
    const Vf distance = hn::ConvertTo(d, hn::IfThenElse(isNear, hn::Set(di, 1), code));
    const Vf edge = Splat(static_cast<float>(MinMaxBlocks::BlockSize));
    const Vf far = Splat(Far);
    for (int a = 0; a < 3; ++a)
    {
      // The blocks at the faces extend beyond the volume.
      const Vf number = hn::ConvertTo(d, block[a]);
      const Vf low = hn::Add(hn::Sub(number, distance), Splat(1.0f));
      const Vf high = hn::Add(number, distance);
      this->Low[a] = hn::IfThenElse(hn::Le(low, zero), hn::Neg(far), hn::Mul(edge, low));
      this->High[a] =
        hn::IfThenElse(hn::Gt(high, Splat(scene.LastBlock[a])), far, hn::Mul(edge, high));
    }
  }

  /// Lanes whose blocks are empty.
  HWY_INLINE Mf IsEmpty() const { return this->Empty; }

  /// Lanes whose positions are at least `margin` inside of their cubes.
  HWY_INLINE Mf Hold(const std::array<float, 3>& margin) const
  {
    Mf within = this->Empty;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const Vf m = Splat(margin[a]);
      within = hn::And(within,
        hn::And(hn::Ge(hn::Sub(this->Position[a], m), this->Low[a]),
          hn::Le(hn::Add(this->Position[a], m), this->High[a])));
    }
    return within;
  }

  /// Counts the steps, a whole number, after which each lane's position is still at least `margin`
  /// inside of its cube; negative if it is not so at all.
  HWY_INLINE Vf CountSteps(const float margin[3], const StepsPerUnit& steps) const
  {
    Vf count = Splat(Most);
    for (int a = 0; a < 3; ++a)
    {
      const Vf m = Splat(margin[a]);
      const Vf above = hn::Sub(hn::Sub(this->High[a], this->Position[a]), m);
      const Vf below = hn::Sub(hn::Sub(this->Position[a], this->Low[a]), m);
      count = hn::Min(count, hn::Min(hn::Mul(above, steps.Up[a]), hn::Mul(below, steps.Down[a])));
    }
    return hn::IfThenElse(this->Empty, hn::Floor(count), Splat(-1.0f));
  }

  /// Counts the steps, a whole number, after which each lane's position is still at least `margin`
  /// beyond a face of the volume; negative if it is not beside the volume.
  HWY_INLINE Vf CountStepsBeside(
    const PacketScene& scene, const float margin[3], const StepsPerUnit& steps) const
  {
    Vf count = Splat(-1.0f);
    for (int a = 0; a < 3; ++a)
    {
      const Vf below = hn::Sub(Splat(scene.Lower - margin[a]), this->Position[a]);
      const Vf beyond = hn::Sub(this->Position[a], Splat(scene.Upper[a] + margin[a]));
      count = hn::Max(count, hn::Max(hn::Mul(below, steps.Up[a]), hn::Mul(beyond, steps.Down[a])));
    }
    return hn::Floor(hn::Min(count, Splat(Most)));
  }

private:
  static constexpr float Far = 1e30f;
  static constexpr float Most = 1e6f;

  Vf Position[3];
  Vf Low[3];
  Vf High[3];
  Mf Empty;
};

/**
 * Asks the distance map whether boxes of one size may hold something visible. One look-up answers
 * for a box that is no wider than a block; wider ones are asked about part by part, and of those
 * that have too many parts it is known only whether they lie in the empty cubes around their
 * middles.
 */
class BoxQuery
{
public:
  /// `radius`: half the width of the boxes, index units.
  BoxQuery(const PacketScene& scene, const std::array<float, 3>& radius)
    : Scene(scene)
    , Radius(radius)
    , Tells(TellsAll(radius))
  {
    for (std::size_t a = 0; a < 3; ++a)
    {
      this->Parts[a] = static_cast<int>(CountParts(radius[a]));
      this->PartRadius[a] = radius[a] / static_cast<float>(this->Parts[a]);
      this->BlocksPerRadius[a] = Splat(BlocksPerVoxel * this->PartRadius[a]);
      this->LastBlock[a] = Splat(scene.LastBlock[a]);
    }
  }

  /// Whether all empty boxes of a radius are told.
  static bool TellsAll(const std::array<float, 3>& radius)
  {
    return CountParts(radius[0]) * CountParts(radius[1]) * CountParts(radius[2]) <= MostParts;
  }

  /// The lanes of `lanes` whose boxes around q, index coordinates, may hold something visible.
  /// Positions outside of the volume count as in the nearest block.
  HWY_INLINE Mf MayShow(const Vec3& q, Mf lanes) const
  {
    if (HWY_UNLIKELY(!this->Tells))
    {
      return hn::AndNot(EmptyCubes(this->Scene, q).Hold(this->Radius), lanes);
    }
    const int parts = this->Parts[0] * this->Parts[1] * this->Parts[2];
    if (parts == 1)
    {
      return hn::And(lanes, this->PartMayShow(q));
    }
    Mf rest = lanes;
    for (int i = 0; i < parts && !hn::AllFalse(Df(), rest); ++i)
    {
      const auto middleOf = [&](Vf x, std::size_t a, int number) {
        const float steps = static_cast<float>(2 * number + 1 - this->Parts[a]);
        return hn::Add(x, Splat(steps * this->PartRadius[a]));
      };
      const Vec3 middle{ middleOf(q.x, 0, i % this->Parts[0]),
        middleOf(q.y, 1, i / this->Parts[0] % this->Parts[1]),
        middleOf(q.z, 2, i / this->Parts[0] / this->Parts[1]) };
      rest = hn::AndNot(this->PartMayShow(middle), rest);
    }
    return hn::AndNot(rest, lanes);
  }

private:
  /// Parts that are asked about, at most: as many as a box has that is two blocks wide.
  static constexpr float MostParts = 8.0f;

  /// The parts of a box along an axis, a whole number.
  static float CountParts(float radius)
  {
    const float blocks = 2.0f * radius * BlocksPerVoxel;
    return blocks <= 1.0f ? 1.0f : std::ceil(std::min(2.0f * MostParts, blocks));
  }

  /// Whether boxes of the radius PartRadius may hold something visible.
  HWY_INLINE Mf PartMayShow(const Vec3& q) const
  {
    const Di di;
    const Vf position[3] = { q.x, q.y, q.z };
    Vi first[3];
    Vi sides = hn::Zero(di);
    for (int a = 0; a < 3; ++a)
    {
      const Vf middle = hn::Mul(position[a], Splat(BlocksPerVoxel));
      const Vf low = hn::Sub(middle, this->BlocksPerRadius[a]);
      const Vf high = hn::Add(middle, this->BlocksPerRadius[a]);
      first[a] = Truncate(Clamp(low, hn::Zero(Df()), this->LastBlock[a]));
      const Vi last = Truncate(hn::Min(high, this->LastBlock[a]));
      const auto extends = hn::Gt(last, first[a]);
      sides = hn::Or(sides, hn::IfThenElseZero(extends, hn::Set(di, 1 << a)));
    }
    const Vi code = LoadCodes(this->Scene, first);
    // With NearCode, which is a bit of its own, the bit `sides` - 1 tells.
    static_assert(DistanceMap::NearCode == 128, "a bit of its own");
    const auto isNear = hn::TestBit(code, hn::Set(di, DistanceMap::NearCode));
    const auto isShown = hn::TestBit(hn::ShiftLeft<1>(code) >> sides, hn::Set(di, 1));
    const auto isVisible = hn::Eq(hn::And(code, hn::Set(di, 0xff)), hn::Zero(di));
    return hn::RebindMask(Df(), hn::Or(isVisible, hn::And(isNear, isShown)));
  }

  const PacketScene& Scene;
  std::array<float, 3> Radius;
  bool Tells;               ///< TellsAll()
  std::array<int, 3> Parts; ///< along each axis
  std::array<float, 3> PartRadius;
  Vf BlocksPerRadius[3]; ///< blocks along PartRadius
  Vf LastBlock[3];
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
