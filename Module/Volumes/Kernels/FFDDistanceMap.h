// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDDistanceMap_h
#define FFDDistanceMap_h

#include "FFDExport.h"
#include "FFDGridIndex.h"
#include "FFDMinMaxBlocks.h"
#include "FFDTransferTable.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace ffd
{

/// A box of index space known to hold nothing visible; unbounded on some sides outside the volume.
struct EmptyBox
{
  glm::dvec3 Min;
  glm::dvec3 Max;
};

/**
 * Distance coding of the empty space (section 4.6 of the paper, after its reference [24]): for
 * every block of MinMaxBlocks the Chebyshev distance, in blocks, to the nearest block that can
 * hold something visible under the current transfer function. A block at distance d is the center
 * of an empty cube of 2d - 1 blocks. Blocks at distance 1 know which of the blocks behind them are
 * empty, so that one look-up answers for two blocks along each axis.
 */
class FFD_VOLUMES_EXPORT DistanceMap
{
public:
  DistanceMap() = default;

  /// `mask`: null, or blocks of as many voxels; nothing is visible in those that hold no number
  /// above 0. `hidden`: null, or for each block, x fastest, whether nothing is visible in it.
  DistanceMap(const MinMaxBlocks& blocks, const TransferTable& table,
    const ParallelFor& parallelFor = ParallelFor(), const MinMaxBlocks* mask = nullptr,
    const std::vector<std::uint8_t>* hidden = nullptr);

  /// Whether nothing is visible where scalars are within limits, one each for the components.
  using IsEmpty = std::function<bool(const MinMaxBlocks::Limits* limits)>;

  /// The same for several components (at most 4), whose blocks have equal sizes.
  DistanceMap(const std::vector<const MinMaxBlocks*>& components, const IsEmpty& isEmpty,
    const ParallelFor& parallelFor = ParallelFor(), const MinMaxBlocks* mask = nullptr,
    const std::vector<std::uint8_t>* hidden = nullptr);

  const glm::ivec3& GetBlocks() const { return this->Blocks; }

  /// Distance of a block, 0 when it may be visible; at most 127.
  int GetDistance(const glm::ivec3& block) const
  {
    const int code = this->Codes[GridIndex(block, this->Blocks)];
    return code < NearCode ? code : 1;
  }

  /// Whether a block is empty, and those behind it that are on the `sides`: the block beyond it
  /// along x (1), y (2) and z (4), and those at the corners between these.
  bool IsEmptyFrom(const glm::ivec3& block, int sides) const
  {
    const int code = this->Codes[GridIndex(block, this->Blocks)];
    return code < NearCode ? code > 0 : ((code - NearCode) << 1 >> sides & 1) == 0;
  }

  /**
   * Empty surroundings of a point in index coordinates. Returns false when the block of the point
   * may be visible. A point outside of the volume [0, upper] is surrounded by the half space
   * beyond the side that it is farthest from. The volume may begin and end up to half a voxel
   * beyond its voxels, at -margin.
   */
  bool FindEmptyBox(
    const glm::dvec3& q, const glm::dvec3& upper, EmptyBox& box, double margin = 0.0) const;

  /// Whether nothing is visible in a box of index coordinates, of which what is outside of the
  /// volume [-margin, upper] does not matter.
  bool IsEmptyIn(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& upper,
    double margin = 0.0) const;

  /// Whether any block may be visible.
  bool IsAnythingVisible() const;

  /// Codes of blocks below this are distances; others stand for distance 1.
  static constexpr int NearCode = 128;

  /// The map itself, x fastest: a code of each block. With NearCode the bit `sides` - 1 tells that
  /// something may be visible in the blocks of IsEmptyFrom(), where that is not so for any of them
  /// the code is 1. Three more bytes can be read behind the last block.
  const std::uint8_t* GetData() const { return this->Codes.data(); }

  std::size_t GetMemorySize() const { return this->Codes.capacity(); }

private:
  /// What hides blocks, see DistanceMap().
  struct Cover
  {
    const MinMaxBlocks* Mask;
    const std::vector<std::uint8_t>* Hidden;

    bool IsNeeded() const { return this->Mask || (this->Hidden && !this->Hidden->empty()); }
    bool Hides(const glm::ivec3& block, std::size_t index) const;
  };

  /// `test` knows which parents and which of their blocks are empty.
  template <class Test>
  void Build(const MinMaxBlocks& blocks, const Test& test, const Cover& cover,
    const ParallelFor& parallelFor);
  template <class Test>
  void FindOccupancy(
    const glm::ivec3& parents, const Test& test, const Cover& cover, int parentPlane);
  void TransformPlane(int k);
  void AddNeighbors(int k);

  glm::ivec3 Blocks{ 0 };
  std::vector<std::uint8_t> Codes; // x fastest
};

} // namespace ffd

#endif
