// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Casts the packets of a tile. Included once per target of Highway.
#if defined(FFD_SIMD_TILE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_TILE_INL_H_
#undef FFD_SIMD_TILE_INL_H_
#else
#define FFD_SIMD_TILE_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"
#include "FFDSamplePhase.h"

#include "FFDSimdCaster-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdSegmentTrees-inl.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Gives access to what is found of the rays of a tile before they are cast, packet by packet, in
/// PacketScratch. Rays are Set() with what FindLines() needs.
struct StoredPackets
{
  PacketScratch& Scratch;

  HWY_INLINE void Set(std::size_t packet, const RayPacket& rays, Vf inverseLength,
    const SampleNumbers& numbers, const SampleRange& range) const
  {
    const Df d;
    float* const to = this->At(packet);
    hn::StoreU(rays.From, d, to);
    hn::StoreU(rays.To, d, to + RaysPerTile);
    hn::StoreU(numbers.Phase, d, to + 2 * RaysPerTile);
    hn::StoreU(numbers.First, d, to + 3 * RaysPerTile);
    hn::StoreU(numbers.Stop, d, to + 4 * RaysPerTile);
    hn::StoreU(inverseLength, d, to + 5 * RaysPerTile);
    this->Scratch.SampleRanges[packet] = range;
  }

  /// Notes that no ray of a packet meets anything.
  HWY_INLINE void SetEmpty(std::size_t packet) const
  {
    this->Scratch.SampleRanges[packet].IsCast = false;
  }

  /// Whether any ray of a packet may meet something.
  HWY_INLINE bool IsCast(std::size_t packet) const { return this->GetRange(packet).IsCast; }
  HWY_INLINE const SampleRange& GetRange(std::size_t packet) const
  {
    return this->Scratch.SampleRanges[packet];
  }

  HWY_INLINE void Get(
    std::size_t packet, RayPacket& rays, Vf& inverseLength, SampleNumbers& numbers) const
  {
    const Df d;
    const float* const from = this->At(packet);
    rays.From = hn::LoadU(d, from);
    rays.To = hn::LoadU(d, from + RaysPerTile);
    numbers.Phase = hn::LoadU(d, from + 2 * RaysPerTile);
    numbers.First = hn::LoadU(d, from + 3 * RaysPerTile);
    numbers.Stop = hn::LoadU(d, from + 4 * RaysPerTile);
    inverseLength = hn::LoadU(d, from + 5 * RaysPerTile);
  }

private:
  static constexpr std::size_t RaysPerTile = TileSide * TileSide;

  HWY_INLINE float* At(std::size_t packet) const
  {
    return this->Scratch.Rays.data() + packet * hn::Lanes(Df());
  }
};

/// The shape of a packet, which is up to four rays wide.
struct PacketShape
{
  int Lanes;
  int Width;
  int Height;
};

HWY_INLINE PacketShape GetPacketShape()
{
  const int lanes = static_cast<int>(hn::Lanes(Df()));
  const int width = lanes < 4 ? lanes : 4;
  return { lanes, width, lanes / width };
}

/// FindJitter() of the pixels of a packet.
HWY_NOINLINE inline Vf JitterOf(const PacketScene& scene, int x0, int y0)
{
  const Df d;
  const PacketShape shape = GetPacketShape();
  const glm::ivec2 origin = scene.Source->Camera.PixelOrigin;
  HWY_ALIGN float jitter[16];
  for (int lane = 0; lane < shape.Lanes; ++lane)
  {
    jitter[lane] = static_cast<float>(
      FindJitter(x0 + lane % shape.Width + origin.x, y0 + lane / shape.Width + origin.y));
  }
  return hn::Load(d, jitter);
}

/// Calls work(lane, pixel) for the pixels of a packet that are in the image.
template <class Work>
HWY_INLINE void ForPixels(const CastImage& image, int x0, int y0, const Work& work)
{
  const PacketShape shape = GetPacketShape();
  for (int lane = 0; lane < shape.Lanes; ++lane)
  {
    const int x = x0 + lane % shape.Width;
    const int y = y0 + lane / shape.Width;
    if (x < image.Width && y < image.Height)
    {
      work(lane, static_cast<std::size_t>(y) * image.Width + x);
    }
  }
}

/// Ends rays where something opaque was drawn (CastScene::Depths).
HWY_INLINE void ClipToDepths(const PacketScene& scene, const CastImage& image, int x0, int y0,
  const WindowDepths& along, RayPacket& rays)
{
  const Df d;
  HWY_ALIGN float depths[16];
  hn::Store(Splat(1.0f), d, depths);
  ForPixels(image, x0, y0,
    [&](int lane, std::size_t pixel) { depths[lane] = scene.Source->Depths[pixel]; });
  const Vf depth = hn::Load(d, depths);
  rays.To = hn::IfThenElse(hn::Lt(depth, Splat(1.0f)), hn::Min(rays.To, along.ToT(depth)), rays.To);
}

/// Stores window depths of the pixels of a packet.
HWY_NOINLINE inline void StoreDepths(const CastImage& image, int x0, int y0, Vf depths)
{
  HWY_ALIGN float stored[16];
  hn::Store(depths, Df(), stored);
  ForPixels(
    image, x0, y0, [&](int lane, std::size_t pixel) { image.Depths[pixel] = stored[lane]; });
}

HWY_INLINE void StorePixels(
  const CastImage& image, int x0, int y0, Mf active, const PacketPixels& pixels)
{
  const Df d;
  const PacketShape shape = GetPacketShape();
  const auto shown = [&](Vf v) { return hn::IfThenElseZero(active, v); };
  HWY_ALIGN float colors[4 * 16];
  hn::StoreInterleaved4(shown(pixels.Color.x), shown(pixels.Color.y), shown(pixels.Color.z),
    shown(hn::Sub(Splat(1.0f), pixels.Transmittance)), d, colors);
  const int width = std::min(shape.Width, image.Width - x0);
  const int height = std::min(shape.Height, image.Height - y0);
  if (width <= 0)
  {
    return;
  }
  const std::size_t step = 4 * static_cast<std::size_t>(image.GetColorsInRow());
  float* to = image.GetColor(x0, y0);
  for (int row = 0; row < height; ++row, to += step)
  {
    const float* from = colors + 4 * row * shape.Width;
    if (HWY_LIKELY(width == 4))
    {
      std::copy_n(from, 16, to);
    }
    else
    {
      std::copy_n(from, 4 * width, to);
    }
  }
}

/// Stores the pixels of a packet none of whose rays meets the volume.
HWY_INLINE void ClearPixels(const CastImage& image, int x0, int y0)
{
  const Mf none = hn::FirstN(Df(), 0);
  StorePixels(image, x0, y0, none, PacketState(none).Out);
  if (image.Depths)
  {
    StoreDepths(image, x0, y0, Splat(1.0f));
  }
}

/// Collects CastImage::Reaches of the subtiles of a tile.
class TileReaches
{
public:
  TileReaches(int x0, int y0, unsigned int subtiles, const CastImage& image)
    : X(x0)
    , Y(y0)
    , Subtiles(subtiles)
    , Image(image)
  {
  }

  /// Whether the packet at a pixel belongs to a subtile that is asked for.
  HWY_INLINE bool IsWanted(int x, int y) const
  {
    return (this->Subtiles >> this->At(x, y) & 1) != 0;
  }

  HWY_INLINE void Include(int x, int y, float reach)
  {
    float& here = this->Reaches[this->At(x, y)];
    here = std::max(here, reach);
  }

  HWY_INLINE void Store() const
  {
    if (!this->Image.Reaches)
    {
      return;
    }
    const int perRow = (this->Image.Width + SubtileSide - 1) / SubtileSide;
    for (int subtile = 0; subtile < 4; ++subtile)
    {
      const int x = this->X + subtile % 2 * SubtileSide;
      const int y = this->Y + subtile / 2 * SubtileSide;
      if (x < this->Image.Width && y < this->Image.Height && this->IsWanted(x, y))
      {
        this->Image.Reaches[y / SubtileSide * perRow + x / SubtileSide] = this->Reaches[subtile];
      }
    }
  }

private:
  static constexpr int SubtileSide = TileSide / 2;

  HWY_INLINE int At(int x, int y) const
  {
    return (x - this->X >= SubtileSide ? 1 : 0) + (y - this->Y >= SubtileSide ? 2 : 0);
  }

  int X;
  int Y;
  unsigned int Subtiles;
  const CastImage& Image;
  float Reaches[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
};

template <class T>
HWY_NOINLINE int CastTile(const PacketScene& scene, int x0, int y0, unsigned int subtiles,
  const CastImage& image, PacketScratch& scratch, int first, Deadline deadline)
{
  const Df d;
  const PacketShape shape = GetPacketShape();
  const StoredPackets stored{ scratch };

  HWY_ALIGN float laneX[16];
  HWY_ALIGN float laneY[16];
  for (int lane = 0; lane < shape.Lanes; ++lane)
  {
    laneX[lane] = static_cast<float>(lane % shape.Width);
    laneY[lane] = static_cast<float>(lane / shape.Width);
  }
  const Vf dx = hn::Load(d, laneX);
  const Vf dy = hn::Load(d, laneY);
  // Image positions of the pixels of the packet at pixel x or y.
  const auto columnsFrom = [dx](int x) { return hn::Add(Splat(static_cast<float>(x) + 0.5f), dx); };
  const auto rowsFrom = [dy](int y) { return hn::Add(Splat(static_cast<float>(y) + 0.5f), dy); };

  Vf tMin = Splat(1e30f);
  Vf tMax = Splat(-1e30f);
  TileReaches reaches(x0, y0, subtiles, image);
  const TileBounds::Limits* const seen = scene.Seen.Find(x0, y0);
  const bool empty = seen && seen->IsEmpty();
  const std::size_t firstPacket = static_cast<std::size_t>(first);
  std::size_t packet = 0;
  for (int y = y0; y < y0 + TileSide; y += shape.Height)
  {
    for (int x = x0; x < x0 + TileSide; x += shape.Width, ++packet)
    {
      if (!reaches.IsWanted(x, y))
      {
        continue;
      }
      if (HWY_UNLIKELY(empty && !scene.Settings.CountsRays))
      {
        ClearPixels(image, x, y);
        reaches.Include(x, y, std::numeric_limits<float>::infinity());
        continue;
      }
      const Vf px = columnsFrom(x);
      const Vf py = rowsFrom(y);
      Vf inverseLength;
      RayPacket rays = MakeRays(scene.Rays, px, py, inverseLength);
      const Vf near = rays.From;
      if (scene.Source->Depths)
      {
        ClipToDepths(scene, image, x, y, WindowDepths(scene.Rays, rays, px, py), rays);
      }
      Vf seenFrom;
      Vf seenTo;
      ClipToBounds(scene, seen, rays, seenFrom, seenTo);
      const Mf inImage = hn::And(hn::Lt(px, Splat(static_cast<float>(image.Width))),
        hn::Lt(py, Splat(static_cast<float>(image.Height))));
      const Mf hit = hn::And(inImage, hn::Lt(rays.From, rays.To));
      scratch.Statistics.Rays +=
        firstPacket > 0 ? 0 : static_cast<std::int64_t>(hn::CountTrue(d, hit));
      rays.From = hn::Max(rays.From, seenFrom);
      rays.To = hn::Min(rays.To, seenTo);
      const Mf active = empty ? hn::FirstN(d, 0) : hn::And(hit, hn::Lt(rays.From, rays.To));
      // Rays that miss the volume now may meet it after an edit. The reach of rays that were cast
      // before the last stop is not known any more.
      if (packet < firstPacket || !hn::AllFalse(d, hn::AndNot(active, inImage)))
      {
        reaches.Include(x, y, std::numeric_limits<float>::infinity());
      }
      if (hn::AllFalse(d, active))
      {
        stored.SetEmpty(packet);
        continue;
      }
      rays.To = hn::IfThenElse(active, rays.To, rays.From);
      const Vf jitter = scene.Settings.Jitter ? JitterOf(scene, x, y) : hn::Zero(d);
      SampleNumbers numbers;
      numbers.Phase = scene.Intervals ? hn::Zero(d) : PhaseOf(scene, rays, near, jitter);
      const SampleRange range = FindSamples(scene, rays, active, numbers);
      stored.Set(packet, rays, inverseLength, numbers, range);
      tMin = hn::IfThenElse(active, hn::Min(tMin, rays.From), tMin);
      tMax = hn::IfThenElse(active, hn::Max(tMax, rays.To), tMax);
    }
  }

  const int side = scene.RootSide;
  SegmentTrees trees(scene, scratch, x0 / side * side, y0 / side * side);
  if (empty && !scene.Settings.CountsRays)
  {
    // All pixels are cleared, and what is stored is of another tile.
    reaches.Store();
    return 0;
  }
  const float nearest = SmallestLane(tMin);
  const float farthest = LargestLane(tMax);
  if (nearest < farthest && !scene.Slices)
  {
    trees.Start(nearest, farthest);
  }

  packet = 0;
  for (int y = y0; y < y0 + TileSide; y += shape.Height)
  {
    ExtremeSamples extremes;
    for (int x = x0; x < x0 + TileSide; x += shape.Width, ++packet)
    {
      if (packet < firstPacket || !reaches.IsWanted(x, y))
      {
        continue;
      }
      if (!stored.IsCast(packet))
      {
        ClearPixels(image, x, y);
        continue;
      }
      const Vf px = columnsFrom(x);
      const Vf py = rowsFrom(y);
      RayPacket rays;
      Vf inverseLength;
      SampleNumbers numbers;
      stored.Get(packet, rays, inverseLength, numbers);
      FindLines(scene.Rays, px, py, inverseLength, rays);
      const Mf active = hn::Lt(rays.From, rays.To);
      Packet<T> cast(scene, trees, scratch, rays, x - trees.GetX(), y - trees.GetY(), dy, numbers,
        stored.GetRange(packet), active, extremes);
      if (HWY_UNLIKELY(scene.Slices))
      {
        cast.CastSlice();
      }
      else if (HWY_UNLIKELY(scene.Sampling != PacketSampling::Composite))
      {
        cast.Blend();
      }
      else
      {
        cast.Cast();
      }
      const PacketPixels& pixels = cast.GetPixels();
      StorePixels(image, x, y, active, pixels);
      if (image.Depths)
      {
        const Vf seenAt = pixels.FirstVisible;
        const Vf depths = WindowDepths(scene.Rays, rays, px, py).ToDepth(seenAt);
        StoreDepths(image, x, y,
          hn::IfThenElse(hn::And(active, hn::Lt(seenAt, Splat(1e29f))), depths, Splat(1.0f)));
      }
      if (image.Reaches)
      {
        const Vf near = TimeAtPlane(scene.Rays.NearPlane, rays);
        reaches.Include(x, y, cast.GetReach() - SmallestLane(near));
      }
    }
    const bool more = packet > firstPacket && y + shape.Height < y0 + TileSide;
    if (more && deadline != NoDeadline && std::chrono::steady_clock::now() >= deadline)
    {
      return static_cast<int>(packet);
    }
  }
  reaches.Store();
  return 0;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
