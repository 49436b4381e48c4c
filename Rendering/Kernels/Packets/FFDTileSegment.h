// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTileSegment_h
#define FFDTileSegment_h

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace ffd
{

/// Pixels of a tile, along each axis of the image.
constexpr int TileSide = 32;
/// Pixels along each side of a root that several tiles share.
constexpr int SharedRootSide = 2 * TileSide;
/// Nodes of an interpolant, along each axis of the image.
constexpr int NodesPerSide = 4;
constexpr int TileNodes = NodesPerSide * NodesPerSide;
/// Layers of nodes along the rays, through which a quartic passes.
constexpr int TileLayers = 5;
/// Pixels, along each axis of the image, of a block: rays that share empty-space queries.
constexpr int BlockSide = 4;
constexpr int BlocksPerTile = (TileSide / BlockSide) * (TileSide / BlockSide);
/// Largest number of the parts of a segment; an empty-space query covers a block in a part, and a
/// bit holds its answer.
constexpr int LargestNumberOfParts = 32;
/// Parts that are queried together.
constexpr int PartsAtOnce = 8;

/// Largest number of channels whose extremes are looked for.
constexpr int LargestNumberOfChannels = 4;

/// A vector at each of the 16 nodes, by component.
using NodeVectors = std::array<std::array<float, TileNodes>, 3>;

/**
 * A segment of the deformed rays of a square of pixels: an interpolant that replaces the pull-back
 * over some of their samples, bicubic over 4 x 4 nodes in the square and quartic along the rays. A
 * segment whose interpolant is not close enough has children.
 */
struct alignas(64) TileSegment
{
  enum class State : unsigned char
  {
    Unknown,   ///< not found yet
    Empty,     ///< nothing in it is visible
    Curves,    ///< the interpolant is close enough
    Halved,    ///< along the rays: two children
    Quartered, ///< across the rays: four children
    PerSample  ///< each sample is pulled back by itself
  };
  /// Which layers of nodes are estimates, as long as the segment is not used.
  enum class Estimates : unsigned char
  {
    None,
    Odd, ///< every second one: those between the layers of the parent
    All
  };
  State Known = State::Unknown;
  Estimates Estimated = Estimates::None;
  bool HasColumns = false;
  bool LeapsRays = false; ///< whether single rays leap in it, too
  bool IsClose = false;   ///< whether its interpolant is that of its parent, which is close enough
  int Side = TileSide;    ///< pixels along each side of the square
  int X = 0;              ///< first pixel, relative to that of the root
  int Y = 0;
  int FirstSample = 0; ///< samples n: t = (n + phase) * sample distance, phase in [0, 1)
  int Samples = 0;
  float T0 = 0.0f;    ///< t of the first sample at phase 0
  float Dt = 0.0f;    ///< to the end of the last interval
  float Error = 0.0f; ///< of the interpolant, with the safety factor, voxels; first of the parent's
  float ErrorBefore = 1e30f; ///< Error of the parent, if the parent was halved
  std::array<TileSegment*, 4> Children{};

  /// Terms of s^k at the nodes, index coordinates of the whole that the volume is a part of; s runs
  /// from 0 to 1. So those below.
  alignas(64) std::array<NodeVectors, TileLayers> Terms;

  /// For each block of 4 x 4 pixels, x fastest, a bit a part, found front to back. Needed:
  /// something in the part may be visible. Inside: all voxels that samples and their gradients need
  /// exist.
  alignas(64) std::array<std::uint32_t, BlocksPerTile> Needed;
  alignas(64) std::array<std::uint32_t, BlocksPerTile> Inside;
  /// Where extremes are looked for, a bound of the values of each channel in each needed part: a
  /// code of ValuePeaks.
  using PartPeaks = std::array<std::array<std::uint8_t, BlocksPerTile>, LargestNumberOfParts>;
  alignas(64) std::array<PartPeaks, LargestNumberOfChannels> Peaks;
  int SamplesPerPart = 1;
  int Parts = 0;
  int KnownParts = 0;
  // Bounds, index units along each axis.
  float Up[3];     ///< of the motion of a ray from sample to sample, in positive direction
  float Down[3];   ///< of that in negative direction
  float Radius[3]; ///< of the distance of the rays of a block from its middle at the same s
  /// Samples, a whole number, over which no ray leaves a box that fits in a cell of
  /// PacketScene::Peaks.
  float StepsPerPeak = 0.0f;

  /// Terms of s^k in the middle of each block; the fourth component is zero.
  alignas(64) std::array<std::array<std::array<float, 4>, BlocksPerTile>, TileLayers> MiddleTerms;

  /// Terms at the pixel columns of the square, for each row of nodes, and their derivatives by
  /// pixels.
  using ColumnTerms = std::array<std::array<std::array<float, TileSide>, NodesPerSide>, 3>;
  alignas(64) std::array<ColumnTerms, TileLayers> Columns;
  alignas(64) std::array<ColumnTerms, TileLayers> ColumnSlopes;
};

/// Holds the segments of a tile, and keeps their memory for the next tile.
class TileSegmentPool
{
public:
  void Clear() { this->Used = 0; }

  /// Adds a segment, whose address does not change.
  TileSegment& Add()
  {
    if (this->Used == this->Segments.size())
    {
      this->Segments.emplace_back(new TileSegment);
    }
    TileSegment& segment = *this->Segments[this->Used++];
    segment.Known = TileSegment::State::Unknown;
    segment.HasColumns = false;
    segment.IsClose = false;
    segment.Estimated = TileSegment::Estimates::None;
    segment.ErrorBefore = 1e30f;
    return segment;
  }

private:
  std::vector<std::unique_ptr<TileSegment>> Segments;
  std::size_t Used = 0;
};

/**
 * The roots of the trees of segments in a square of pixels, as far as they are made. They are kept
 * from tile to tile of the square: what they are does not depend on the tile.
 */
class SegmentRoots
{
public:
  /// Begins a tile of the square whose first pixel is (x, y), of the scene with a number.
  void Begin(std::uint64_t scene, int x, int y)
  {
    if (scene != this->Scene || x != this->X || y != this->Y)
    {
      this->Scene = scene;
      this->X = x;
      this->Y = y;
      this->Roots.clear();
      this->Pool.Clear();
    }
  }

  /// The root number `index`, which is null before it is made.
  TileSegment*& At(int index)
  {
    if (this->Roots.empty())
    {
      this->First = index;
    }
    if (index < this->First)
    {
      this->Roots.insert(
        this->Roots.begin(), static_cast<std::size_t>(this->First - index), nullptr);
      this->First = index;
    }
    const std::size_t at = static_cast<std::size_t>(index - this->First);
    if (at >= this->Roots.size())
    {
      this->Roots.resize(at + 1, nullptr);
    }
    return this->Roots[at];
  }

  /// Front to back; those that are not made are null.
  const std::vector<TileSegment*>& GetAll() const { return this->Roots; }

  /// Adds a segment to the trees.
  TileSegment& Add() { return this->Pool.Add(); }

private:
  std::uint64_t Scene = 0;
  int X = 0;
  int Y = 0;
  int First = 0; ///< number of the first of Roots
  std::vector<TileSegment*> Roots;
  TileSegmentPool Pool;
};

} // namespace ffd

#endif
