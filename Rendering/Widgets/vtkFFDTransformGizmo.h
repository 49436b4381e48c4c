// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this library: not installed.
#ifndef vtkFFDTransformGizmo_h
#define vtkFFDTransformGizmo_h

#include "vtkFFDLatticeScene.h"
#include "vtkFFDProjection.h"

#include "FFDDragGeometry.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

/**
 * The handle of the selection: three arms with tips or three rings along the data axes, and a part
 * in the middle. Makes the shapes that are drawn, finds the part at a position of the window, and
 * says what a drag of a part means. It also makes the guides of an edit.
 */
class vtkFFDTransformGizmo
{
public:
  using Shape = vtkFFDLatticeScene::Shape;
  using Color = vtkFFDLatticeScene::Color;

  /// The values are those of vtkFFDLatticeRepresentation::HandleModes.
  enum class Mode
  {
    Off = 0,
    Translate, ///< arms with cones
    Rotate,    ///< rings
    Scale      ///< arms with cubes
  };

  static constexpr int NoPart = -1;
  static constexpr int MiddlePart = 3; ///< after those of the axes, 0 to 2

  vtkFFDTransformGizmo();

  /// Position and appearance of the handle.
  struct State
  {
    Mode Kind = Mode::Off;
    glm::dvec3 Center{ 0.0 }; ///< data coordinates
    glm::dmat4 DataToWorld{ 1.0 };
    double Size = 80.0; ///< of an arm, pixels
    bool HasMiddle = true;
    int HighlightedPart = NoPart;
    int DraggedPart = NoPart; ///< it is drawn whole, however it is seen
    Color HighlightColor{};
  };

  /// Appends the shapes of the handle as the viewer sees it; these are what FindPart() finds. An
  /// arm near the line of sight is faded and cannot be found.
  void Build(const State& state, const vtkFFDProjection& projection, std::vector<Shape>& shapes);

  /**
   * The part nearest to a position of the window, nearer than `tolerance`, or NoPart. Sets
   * `distance` (all in pixels) where there is one.
   */
  int FindPart(const vtkFFDProjection& projection, const glm::dvec2& display, double tolerance,
    double& distance) const;

  /// Appends lines through a point along the axes in which a constraint lets it move, `reach` long
  /// on either side (data coordinates).
  static void AddConstraintGuides(ffd::MoveConstraint constraint, const glm::dvec3& point,
    double reach, const glm::dmat4& dataToWorld, std::vector<Shape>& shapes);

  /// Appends a circle that faces the viewer; world coordinates.
  static void AddCircle(const glm::dvec3& center, double radius, const vtkFFDProjection& projection,
    std::vector<Shape>& shapes);

private:
  struct Part
  {
    int Id;
    std::vector<glm::dvec3> Path; // world
  };
  std::vector<Part> Parts;

  // Corners of triangles, three each; the arm points along x, the unit is half the tip's width.
  std::vector<glm::dvec3> Cone;
  std::vector<glm::dvec3> Cube;
};

#endif
