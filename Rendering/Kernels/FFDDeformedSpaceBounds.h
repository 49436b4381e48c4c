// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDDeformedSpaceBounds_h
#define FFDDeformedSpaceBounds_h

#include "FFDExport.h"
#include "FFDPullBackBounds.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ffd
{

/**
 * The bounds of a pull-back arranged by where the rays run: a grid over deformed space whose cells
 * hold what PullBackBounds proves about every rest point that can map into the cell. Built once
 * per edit; afterwards a piece of a ray asks with its own box, whatever the kind of pull-back.
 */
class FFD_KERNEL_EXPORT DeformedSpaceBounds
{
public:
  DeformedSpaceBounds() = default;

  /// `region`: the part of deformed space, data coordinates, that rays will ask about.
  DeformedSpaceBounds(const PullBack& pullBack, const PullBackBounds& bounds, const Box& region);

  /// Bounds of Phi over a box of deformed space; unbounded when the box leaves the region.
  MapBounds Over(const Box& box) const;

  std::size_t GetMemorySize() const { return this->Bounds.capacity() * sizeof(CellBounds); }

private:
  /**
   * MapBounds, rounded outwards to the upper halves of floats (8 bits of precision): a grid of
   * them is small. As upper bounds all of them: of the entries of the Jacobian, of the negative
   * entries, of the second and of the third derivative.
   */
  struct CellBounds
  {
    std::uint16_t Upper[20];

    void Include(const MapBounds& bounds);
  };

  glm::ivec3 CellOf(const glm::dvec3& p) const;
  std::size_t IndexOf(int i, int j, int k) const;
  void FillFromDeformedRegions(const PullBackBounds& bounds);
  void FillFromRestRegions(const PullBackBounds& bounds, const BSplineField& field);

  bool Identity = false; ///< then the bounds are those of the identity, everywhere
  Box Region;
  glm::ivec3 Cells{ 1 };
  glm::dvec3 CellSize{ 1.0 };
  std::vector<CellBounds> Bounds; // x fastest
};

} // namespace ffd

#endif
