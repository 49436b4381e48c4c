// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this library: not installed.
#ifndef vtkFFDLatticeGeometry_h
#define vtkFFDLatticeGeometry_h

#include "vtkFFDLatticeScene.h"

#include "FFDLatticeEditor.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

class vtkFFDLattice;

/**
 * Makes what shows a lattice, in world coordinates: the lines between its control points, a box as
 * it deforms, and a ball for each control point.
 */
class vtkFFDLatticeGeometry
{
public:
  using Color = vtkFFDLatticeScene::Color;
  using Lines = vtkFFDLatticeScene::Lines;

  /// The lattice is kept by reference. Without `interior` only control points of the outside, and
  /// lines between these, are shown.
  vtkFFDLatticeGeometry(const ffd::Lattice& lattice, const glm::dmat4& dataToWorld, bool interior);

  bool IsShown(std::size_t point) const;

  /// Position of a control point in the world.
  const glm::dvec3& GetPosition(std::size_t point) const { return this->Positions[point]; }

  /// From control point to control point.
  Lines MakeStraightLines() const;
  /// The deformed grid lines of the lattice; straight ones for a lattice with a problem.
  Lines MakeCurvedLines() const;
  /// The edges of a box (xmin, xmax, ymin, ...), deformed by a transform.
  Lines MakeOutline(vtkFFDLattice* transform, const double bounds[6]) const;

  /// Bounds (xmin, xmax, ...) of all control points and of lines; uninitialized bounds for nothing
  /// that is finite.
  void FindBounds(const std::vector<const Lines*>& lines, double bounds[6]) const;

  struct GlyphLook
  {
    double Size = 9.0; ///< diameter of a control point, pixels
    Color Plain{};
    Color Selected{};
    Color Hovered{};
    Color Locked{};
  };
  /// A ball for each control point that is shown.
  std::vector<vtkFFDLatticeScene::Glyph> MakeGlyphs(
    const ffd::LatticeEditor& editor, std::ptrdiff_t hovered, const GlyphLook& look) const;
  /// "i, j, k" beside the selected control points and the hovered one.
  std::vector<vtkFFDLatticeScene::Label> MakeLabels(
    const ffd::LatticeEditor& editor, std::ptrdiff_t hovered) const;

private:
  template <class MakeLine>
  Lines MakeLines(const MakeLine& makeLine) const;

  const ffd::Lattice& Lattice;
  glm::dmat4 DataToWorld;
  bool Interior;
  std::vector<glm::dvec3> Positions; // of the control points, world
};

#endif
