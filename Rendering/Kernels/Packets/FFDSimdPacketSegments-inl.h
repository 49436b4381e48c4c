// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The segments that the rays of a packet go through. Included once per target of Highway.
#if defined(FFD_SIMD_PACKET_SEGMENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PACKET_SEGMENTS_INL_H_
#undef FFD_SIMD_PACKET_SEGMENTS_INL_H_
#else
#define FFD_SIMD_PACKET_SEGMENTS_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"
#include "FFDTileSegment.h"

#include "FFDSimdMath-inl.h"
#include "FFDSimdSegmentTrees-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Parts of a segment, before End.
struct PartRange
{
  int First;
  int End;
};

/// Finds the segments of a tile, and the parts of these, that hold samples of a packet and in which
/// something may be visible.
class PacketSegments
{
public:
  /// (x, y): first pixel of the packet, from that of the roots. `range`: samples of all its rays.
  HWY_INLINE PacketSegments(
    const PacketScene& scene, SegmentTrees& trees, int x, int y, const SampleRange& range)
    : X(x)
    , Y(y)
    , FirstSample(range.First)
    , EndSample(range.End)
    , Trees(trees)
    , SamplesPerRoot(scene.SamplesPerRoot)
    , FirstRoot(std::max(trees.GetFirst(), FloorDivide(range.First, scene.SamplesPerRoot)))
    , LastRoot(std::min(trees.GetLast(), FloorDivide(range.End - 1, scene.SamplesPerRoot)))
  {
  }

  /// Calls visit(segment) for the segments without children, front to back, until it returns false.
  template <class Visit>
  HWY_INLINE void ForLeaves(const Visit& visit)
  {
    for (int root = this->FirstRoot; root <= this->LastRoot; ++root)
    {
      if (!this->ForLeavesOf(this->Trees.GetRoot(root), visit))
      {
        return;
      }
    }
  }

  /// ForLeaves() of the root that holds the sample n, if there is one.
  template <class Visit>
  void ForLeavesAt(int n, const Visit& visit)
  {
    const int root = FloorDivide(n, this->SamplesPerRoot);
    if (root >= this->FirstRoot && root <= this->LastRoot)
    {
      this->ForLeavesOf(this->Trees.GetRoot(root), visit);
    }
  }

  /// The parts of a segment that hold samples of the packet.
  HWY_INLINE PartRange FindParts(const TileSegment& segment) const
  {
    const int samples = std::min(segment.Samples, this->EndSample - segment.FirstSample);
    return { std::max(0, this->FirstSample - segment.FirstSample) / segment.SamplesPerPart,
      (samples + segment.SamplesPerPart - 1) / segment.SamplesPerPart };
  }

  /// The block of a segment that the packet is.
  HWY_INLINE int BlockIn(const TileSegment& segment) const
  {
    return (this->Y - segment.Y) / BlockSide * (segment.Side / BlockSide) +
      (this->X - segment.X) / BlockSide;
  }

  /// Finds the first part from `part` on, before `end`, in which something may be visible; `end` or
  /// more if there is none.
  HWY_INLINE int FindNeeded(TileSegment& segment, int block, int part, int end)
  {
    while (part < end)
    {
      this->Trees.NeedPart(segment, part);
      const std::uint32_t needed = segment.Needed[static_cast<std::size_t>(block)] >> part;
      if (needed != 0)
      {
        return part + static_cast<int>(hwy::Num0BitsBelowLS1Bit_Nonzero32(needed));
      }
      part = segment.KnownParts;
    }
    return part;
  }

  const int X; ///< first pixel, from that of the roots
  const int Y;
  const int FirstSample; ///< of all rays
  const int EndSample;

private:
  static int FloorDivide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

  HWY_INLINE bool HasSamplesIn(const TileSegment& segment) const
  {
    return segment.FirstSample < this->EndSample &&
      segment.FirstSample + segment.Samples > this->FirstSample;
  }

  /// The quarter of a segment that the packet is in.
  HWY_INLINE TileSegment& QuarterOf(const TileSegment& segment) const
  {
    const int half = segment.Side / 2;
    const std::size_t right = this->X - segment.X >= half ? 1 : 0;
    const std::size_t high = this->Y - segment.Y >= half ? 2 : 0;
    return *segment.Children[right + high];
  }

  /// ForLeaves() of a segment; returns false if visit() did.
  template <class Visit>
  bool ForLeavesOf(TileSegment& segment, const Visit& visit)
  {
    if (!this->HasSamplesIn(segment))
    {
      return true;
    }
    switch (this->Trees.Find(segment))
    {
      case TileSegment::State::Empty:
        return true;
      case TileSegment::State::Halved:
        return this->ForLeavesOf(*segment.Children[0], visit) &&
          this->ForLeavesOf(*segment.Children[1], visit);
      case TileSegment::State::Quartered:
        return this->ForLeavesOf(this->QuarterOf(segment), visit);
      default:
        return visit(segment);
    }
  }

  SegmentTrees& Trees;
  const int SamplesPerRoot;
  const int FirstRoot;
  const int LastRoot;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
