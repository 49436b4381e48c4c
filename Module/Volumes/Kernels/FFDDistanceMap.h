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
 * of an empty cube of 2d - 1 blocks.
 */
class FFD_VOLUMES_EXPORT DistanceMap
{
public:
  DistanceMap() = default;

  /// `mask`: null, or blocks of as many voxels; nothing is visible in those that hold no number
  /// above 0.
  DistanceMap(const MinMaxBlocks& blocks, const TransferTable& table,
    const ParallelFor& parallelFor = ParallelFor(), const MinMaxBlocks* mask = nullptr);

  /// Whether nothing is visible where scalars are within limits, one each for the components.
  using IsEmpty = std::function<bool(const MinMaxBlocks::Limits* limits)>;

  /// The same for several components (at most 4), whose blocks have equal sizes.
  DistanceMap(const std::vector<const MinMaxBlocks*>& components, const IsEmpty& isEmpty,
    const ParallelFor& parallelFor = ParallelFor(), const MinMaxBlocks* mask = nullptr);

  const glm::ivec3& GetBlocks() const { return this->Blocks; }

  /// Distance of a block, 0 when it may be visible; at most 255.
  int GetDistance(const glm::ivec3& block) const
  {
    return this->Distances[GridIndex(block, this->Blocks)];
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

  /// The map itself, x fastest; three more bytes can be read behind the last block.
  const std::uint8_t* GetData() const { return this->Distances.data(); }

  std::size_t GetMemorySize() const { return this->Distances.capacity(); }

private:
  /// `test` knows which parents and which of their blocks are empty.
  template <class Test>
  void Build(const MinMaxBlocks& blocks, const Test& test, const MinMaxBlocks* mask,
    const ParallelFor& parallelFor);
  template <class Test>
  void FindOccupancy(
    const glm::ivec3& parents, const Test& test, const MinMaxBlocks* mask, int parentPlane);
  void TransformPlane(int k);

  glm::ivec3 Blocks{ 0 };
  std::vector<std::uint8_t> Distances; // x fastest
};

} // namespace ffd

#endif
