// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDOrientedInverse_h
#define FFDOrientedInverse_h

#include "Bounds/FFDBox.h"
#include "FFDBSplineField.h"
#include "FFDExport.h"
#include "FFDVolumeView.h"

#include <vector>

namespace ffd
{

/**
 * Inverts T where it may fold, so that several rest points lead to a deformed point: those in the
 * volume count at which T keeps the orientation that it has at most points of the volume, wherever
 * else it folds. For all that goes point by point; the packet kernels do the same by
 * PacketScene::Orientation.
 */
class FFD_VOLUMES_EXPORT OrientedInverse
{
public:
  /// `rest`: the volume at rest, index coordinates. `field` must outlive this object.
  OrientedInverse(
    const BSplineField& field, double tolerance, const VolumeView& volume, const Box& rest);

  /**
   * Solves T(q) = p by Newton's method, from `start` and then from the points of a grid whose
   * images are nearest to p. If no solution counts, q is a solution outside of the volume. False if
   * there is none either; q is then far outside.
   */
  bool Solve(const glm::dvec3& p, const glm::dvec3& start, glm::dvec3& q, int& evaluations) const;

private:
  struct Seed
  {
    glm::dvec3 Point;
    glm::dvec3 Image;
    bool Positive; // whether T keeps the orientation there
  };
  Seed MakeSeed(const glm::dvec3& point) const;

  const BSplineField& Field;
  double Tolerance;
  VolumeView Volume;
  Box Rest;
  std::vector<Seed> Seeds;
  bool Positive = true;
  double Reach = 0.0; // largest distance of the images of neighboring seeds
};

} // namespace ffd

#endif
