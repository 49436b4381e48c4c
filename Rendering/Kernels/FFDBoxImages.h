// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDBoxImages_h
#define FFDBoxImages_h

#include "Bounds/FFDBox.h"
#include "FFDBSplineField.h"
#include "FFDCastScene.h"
#include "FFDExport.h"
#include "FFDSplineGrid.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <vector>

namespace ffd
{

/// Equal boxes that a box is cut into, aligned with the axes of data coordinates.
struct FFD_RENDERING_EXPORT BoxGrid
{
  glm::dvec3 First; ///< lowest corner
  glm::dvec3 Edge;
  glm::ivec3 Count;

  /// About `number` boxes, with edges of at least `smallestEdge`, data units.
  BoxGrid(const Box& bounds, double number, double smallestEdge);

  double At(int a, int i) const { return this->First[a] + i * this->Edge[a]; }
  Box Get(const glm::ivec3& index) const
  {
    const glm::dvec3 low = this->First + glm::dvec3(index) * this->Edge;
    return { low, low + this->Edge };
  }
  bool operator==(const BoxGrid& other) const
  {
    return this->First == other.First && this->Edge == other.Edge && this->Count == other.Count;
  }
};

/// The coefficients that D follows from in the cells from `first` on, before `end`: from those of
/// first - 1 on.
Grid<glm::dvec3> CopyCoefficients(
  const BSplineField& field, const glm::ivec3& first, const glm::ivec3& end);

/// Bounds of what x + sign * D(x) makes of boxes.
class FFD_RENDERING_EXPORT BoxImages
{
public:
  /// `field`: D, null for zero.
  BoxImages(const BoxGrid& boxes, const BSplineField* field, double sign);

  const BoxGrid& GetBoxes() const { return this->Boxes; }
  double GetSign() const { return this->Sign; }

  /// The hull of the images of the corners, and of what D is in between.
  Box Find(const glm::ivec3& index) const;

  /// The mean change of x + sign * D(x) along the edges of the boxes from `first` on, before `end`:
  /// a column for each axis, which is about the Jacobian in their middle.
  glm::dmat3 FindMeanJacobian(const glm::ivec3& first, const glm::ivec3& end) const;

  std::size_t GetMemorySize() const { return this->Corners.Values.capacity() * sizeof(glm::dvec3); }

private:
  void FindDisplacements(const BSplineField& field);

  BoxGrid Boxes;
  double Sign;
  Grid<glm::dvec3> Corners;       ///< displacements of the corners of boxes
  glm::dvec3 Bulge{ 0.0 };        ///< largest distance of D from what it is at corners interpolated
  std::vector<bool> IsInCells[3]; ///< by the box along each axis
};

/// The images of boxes by the map of a scene, x + sign * D(x); what is kept of its field is used.
std::shared_ptr<const BoxImages> FindBoxImages(
  const CastScene& scene, const BoxGrid& boxes, double sign);

/// Kept around boxes and their images for what is rounded, voxels.
constexpr double BoxGuard = 0.5;

/// Bounds of a volume at rest, data coordinates.
FFD_RENDERING_EXPORT Box FindBoundsAtRest(const VolumeView& volume);

/// Whether the distance map of a scene shows that nothing is visible in a box at rest, data
/// coordinates; `around`: of the box, voxels.
bool ShowsNothing(const CastScene& scene, const Box& box, double around);

} // namespace ffd

#endif
