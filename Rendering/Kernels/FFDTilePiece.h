// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTilePiece_h
#define FFDTilePiece_h

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace ffd
{

/// Pixels of a tile, along each axis of the image.
constexpr int TileSide = 32;
/// Nodes of an interpolant, along each axis of the image.
constexpr int NodesPerSide = 4;
constexpr int TileNodes = NodesPerSide * NodesPerSide;
/// Layers of nodes along the rays: a quartic passes through them.
constexpr int TileLayers = 5;
/// Pixels of a block, along each axis of the image: what is tested for emptiness together.
constexpr int BlockSide = 4;
constexpr int BlocksPerTile = (TileSide / BlockSide) * (TileSide / BlockSide);
/// Parts of a piece that a block is tested in: a bit each.
constexpr int LargestNumberOfParts = 32;
/// Parts that are tested at once.
constexpr int PartsAtOnce = 8;

/// A vector at each of the 16 nodes, by component.
using NodeVectors = std::array<std::array<float, TileNodes>, 3>;

/**
 * The rays of a square of pixels over some of their samples, bent: where the pull-back is replaced
 * by an interpolant, bicubic over 4 x 4 nodes in the square and quartic along the rays.
 */
struct alignas(64) TilePiece
{
  enum class State : unsigned char
  {
    Unknown,   ///< nobody has asked yet
    Empty,     ///< nothing can be seen in it
    Curves,    ///< the interpolant is close enough
    Halved,    ///< along the rays: two children
    Quartered, ///< across them: four children
    PerSample  ///< each sample is pulled back by itself
  };
  State Known = State::Unknown;
  bool HasColumns = false;
  bool LeapsRays = false; ///< whether single rays leap in it, too
  int Side = TileSide;    ///< pixels
  int X = 0;              ///< first pixel, from that of the tile
  int Y = 0;
  int FirstSample = 0; ///< samples n: t = (n + phase) * sample distance, phase in [0, 1)
  int Samples = 0;
  float T0 = 0.0f;           ///< t of the first sample at phase 0
  float Dt = 0.0f;           ///< to the end of the last interval
  float Error = 0.0f;        ///< measured, with its safety factor, voxels
  float ErrorBefore = 1e30f; ///< that of the parent, if the parent was halved
  std::array<TilePiece*, 4> Children{};

  /// Terms of s^k at the nodes, index coordinates; s runs from 0 to 1.
  alignas(64) std::array<NodeVectors, TileLayers> Terms;

  /// For each block of 4 x 4 pixels, x fastest: parts of the piece in which something may be seen,
  /// and parts in which all that a sample and its gradient need lies between voxels; found front to
  /// back.
  alignas(64) std::array<std::uint32_t, BlocksPerTile> Needed;
  alignas(64) std::array<std::uint32_t, BlocksPerTile> Inside;
  alignas(64) std::array<float, BlocksPerTile> SkippedParts; ///< before the next one to look at
  int SamplesPerPart = 1;
  int Parts = 0;
  int KnownParts = 0;
  float Up[3];     ///< most that a ray moves along each axis from sample to sample, index units
  float Down[3];   ///< the same the other way
  float Radius[3]; ///< most that rays of a block are from its middle at the same s, index units

  /// Terms of s^k in the middle of each block; the fourth component is zero.
  alignas(64) std::array<std::array<std::array<float, 4>, BlocksPerTile>, TileLayers> MiddleTerms;

  /// Terms at the pixel columns of the square, for each row of nodes, and their derivatives by
  /// pixels.
  using ColumnTerms = std::array<std::array<std::array<float, TileSide>, NodesPerSide>, 3>;
  alignas(64) std::array<ColumnTerms, TileLayers> Columns;
  alignas(64) std::array<ColumnTerms, TileLayers> ColumnSlopes;
};

/// The pieces of a tile, kept for the next one.
class TilePiecePool
{
public:
  void Clear() { this->Used = 0; }

  /// A piece that stays where it is.
  TilePiece& Add()
  {
    if (this->Used == this->Pieces.size())
    {
      this->Pieces.emplace_back(new TilePiece);
    }
    TilePiece& piece = *this->Pieces[this->Used++];
    piece.Known = TilePiece::State::Unknown;
    piece.HasColumns = false;
    piece.ErrorBefore = 1e30f;
    return piece;
  }

private:
  std::vector<std::unique_ptr<TilePiece>> Pieces;
  std::size_t Used = 0;
};

} // namespace ffd

#endif
