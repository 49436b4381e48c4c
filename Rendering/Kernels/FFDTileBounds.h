// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTileBounds_h
#define FFDTileBounds_h

#include "FFDCastScene.h"
#include "FFDExport.h"
#include "FFDParallelFor.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace ffd
{

/**
 * For each tile of an image a box in deformed space that holds all that may be seen through it:
 * rays are cut to it, and tiles without one need no rays.
 *
 * For T^-1 the volume at rest is cut into some 2000 boxes. Those in which the distance map shows
 * nothing visible are left out; T takes the others forward, for which no inverse is needed, to
 * hulls of their corners. T is not linear in between: the hulls are widened by what second
 * differences of the control points allow. The same as proxy geometry for the leaping of empty
 * space (Hadwiger, Al-Awami, Beyer, Agus, Pfister 2018), with bent boxes. For pull-backs that are
 * evaluated where the rays are, 2P - T(P) and T itself, the deformed bounds are cut, and boxes are
 * left out if the distance map shows nothing visible in the hulls that these take them to.
 */
class FFD_RENDERING_EXPORT TileBounds
{
public:
  /// A box, relative to the origin, single precision; empty if Min > Max.
  struct Limits
  {
    float Min[3];
    float Max[3];

    bool IsEmpty() const { return this->Min[0] > this->Max[0]; }
  };

  /// Nothing is known.
  TileBounds() = default;

  /**
   * Finds the boxes of the tiles of the image of a scene; nothing is known where the pull-back is
   * 2P - T^-1(P), and nothing of an image that is too small for it to pay.
   * `tolerance`: largest distance of samples from the pull-back, voxels. `reach`: kept around what
   * may be visible, data units. `origin`: data coordinates.
   */
  TileBounds(const CastScene& scene, double tolerance, double reach, const glm::dvec3& origin,
    const ParallelFor& parallelFor = ParallelFor());

  /// The box of the tile whose first pixel is (x0, y0); null if nothing is known of it.
  const Limits* Find(int x0, int y0) const;

private:
  glm::ivec2 Tiles{ 0 };
  std::vector<Limits> Boxes; ///< x fastest
};

} // namespace ffd

#endif
