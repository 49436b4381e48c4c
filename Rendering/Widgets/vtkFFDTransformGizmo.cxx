// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTransformGizmo.h"

#include "vtkCellArray.h"
#include "vtkConeSource.h"
#include "vtkCubeSource.h"
#include "vtkIdList.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPolyData.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <cmath>

namespace
{

/// Cosine of 15 degrees: arms that are nearer to the line of sight are faded.
constexpr double FadedArm = 0.9659258;
constexpr unsigned char FadedAlpha = 40;

constexpr int RingSegments = 64;

// Lengths by that of an arm.
constexpr double ArmStart = 0.18;
constexpr double HalfCone = 0.06;
constexpr double HalfCube = 0.05;
constexpr double HalfMiddle = 0.12;
constexpr double ViewRing = 1.2;

/// Length of a cone by half its width.
constexpr double ConeLength = 3.5;

constexpr vtkFFDLatticeScene::Color AxisColors[3] = { { 235, 70, 70 }, { 90, 205, 80 },
  { 80, 130, 255 } };
constexpr vtkFFDLatticeScene::Color MiddleColor = { 235, 235, 235 };

/// The polygons of a surface as triangles; they are convex.
std::vector<glm::dvec3> GetTriangles(vtkPolyData* surface)
{
  std::vector<glm::dvec3> corners;
  vtkNew<vtkIdList> cell;
  vtkCellArray* polygons = surface->GetPolys();
  for (polygons->InitTraversal(); polygons->GetNextCell(cell);)
  {
    for (vtkIdType c = 1; c + 1 < cell->GetNumberOfIds(); ++c)
    {
      for (const vtkIdType point : { cell->GetId(0), cell->GetId(c), cell->GetId(c + 1) })
      {
        glm::dvec3 p;
        surface->GetPoint(point, &p.x);
        corners.push_back(p);
      }
    }
  }
  return corners;
}

/// A regular polygon, closed, with its first corner at `start` sides from u.
std::vector<glm::dvec3> MakeRing(const glm::dvec3& center, double radius, const glm::dvec3& u,
  const glm::dvec3& v, int sides = RingSegments, double start = 0.0)
{
  std::vector<glm::dvec3> ring;
  for (int s = 0; s <= sides; ++s)
  {
    const double angle = 2.0 * vtkMath::Pi() * (s + start) / sides;
    ring.push_back(center + radius * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return ring;
}

double DistanceToSegment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b)
{
  const glm::dvec2 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? glm::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - a - t * along);
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDTransformGizmo::vtkFFDTransformGizmo()
{
  vtkNew<vtkConeSource> cone;
  cone->SetResolution(12);
  cone->SetRadius(1.0);
  cone->SetHeight(ConeLength);
  cone->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  cone->Update();
  this->Cone = GetTriangles(cone->GetOutput());
  for (glm::dvec3& corner : this->Cone)
  {
    corner.x += 0.5 * ConeLength; // the base in the origin
  }
  vtkNew<vtkCubeSource> cube;
  cube->SetXLength(2.0);
  cube->SetYLength(2.0);
  cube->SetZLength(2.0);
  cube->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  cube->Update();
  this->Cube = GetTriangles(cube->GetOutput());
}

//------------------------------------------------------------------------------
void vtkFFDTransformGizmo::Build(
  const State& state, const vtkFFDProjection& projection, std::vector<Shape>& shapes)
{
  this->Parts.clear();
  const glm::dvec3 middle = vtkFFDTransformPoint(state.DataToWorld, state.Center);
  const double length = state.Size * projection.GetPixelSize(middle);
  if (state.Kind == Mode::Off || !(length > 0.0))
  {
    return;
  }
  const glm::dvec3 sight = projection.GetSight(middle);
  const bool rotates = state.Kind == Mode::Rotate;
  const bool scales = state.Kind == Mode::Scale;
  for (int a = 0; a < 3; ++a)
  {
    const glm::dvec3 axis = glm::normalize(glm::dmat3(state.DataToWorld) * ffd::GetUnitVector(a));
    const glm::dvec3 u =
      glm::normalize(glm::cross(axis, ffd::GetUnitVector(std::abs(axis.x) < 0.6 ? 0 : 1)));
    const glm::dvec3 v = glm::cross(axis, u);
    const bool faded =
      !rotates && std::abs(glm::dot(axis, sight)) > FadedArm && state.DraggedPart != a;
    Shape shape;
    shape.Rgb = state.HighlightedPart == a ? state.HighlightColor : AxisColors[a];
    shape.Alpha = faded ? FadedAlpha : 255;
    if (rotates)
    {
      shape.Line = MakeRing(middle, length, u, v);
    }
    else
    {
      const glm::dvec3 tip = middle + length * axis;
      const double half = (scales ? HalfCube : HalfCone) * length;
      shape.Line = { middle + ArmStart * length * axis, tip };
      for (const glm::dvec3& corner : scales ? this->Cube : this->Cone)
      {
        shape.Triangles.push_back(tip + half * (corner.x * axis + corner.y * u + corner.z * v));
      }
    }
    if (!faded)
    {
      this->Parts.push_back({ a, shape.Line });
    }
    shapes.push_back(shape);
  }
  if (state.HasMiddle)
  {
    Shape shape;
    shape.Rgb = state.HighlightedPart == MiddlePart ? state.HighlightColor : MiddleColor;
    shape.Line = rotates
      ? MakeRing(middle, ViewRing * length, projection.Right, projection.Up, RingSegments, 0.5)
      : MakeRing(middle, HalfMiddle * length, projection.Right, projection.Up, 4, 0.5);
    std::vector<glm::dvec3> path = shape.Line;
    if (!rotates)
    {
      path.push_back(middle);
    }
    this->Parts.push_back({ MiddlePart, path });
    shapes.push_back(shape);
  }
}

//------------------------------------------------------------------------------
int vtkFFDTransformGizmo::FindPart(const vtkFFDProjection& projection, const glm::dvec2& display,
  double tolerance, double& distance) const
{
  int found = NoPart;
  double nearest = tolerance;
  for (const Part& part : this->Parts)
  {
    glm::dvec3 before(0.0);
    for (std::size_t n = 0; n < part.Path.size(); ++n)
    {
      glm::dvec3 at;
      if (!projection.ToDisplay(part.Path[n], at))
      {
        break;
      }
      const double here = n == 0 ? glm::length(glm::dvec2(at) - display)
                                 : DistanceToSegment(display, glm::dvec2(before), glm::dvec2(at));
      if (here < nearest)
      {
        nearest = here;
        found = part.Id;
      }
      before = at;
    }
  }
  distance = found == NoPart ? distance : nearest;
  return found;
}

//------------------------------------------------------------------------------
void vtkFFDTransformGizmo::AddConstraintGuides(ffd::MoveConstraint constraint,
  const glm::dvec3& point, double reach, const glm::dmat4& dataToWorld, std::vector<Shape>& shapes)
{
  for (int a = 0; a < 3; ++a)
  {
    if (constraint != ffd::MoveConstraint::Free &&
      ffd::IsAlongAxis(constraint) == (ffd::GetAxis(constraint) == a))
    {
      Shape shape;
      shape.Rgb = AxisColors[a];
      const glm::dvec3 along = reach * ffd::GetUnitVector(a);
      shape.Line = { vtkFFDTransformPoint(dataToWorld, point - along),
        vtkFFDTransformPoint(dataToWorld, point + along) };
      shapes.push_back(shape);
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformGizmo::AddCircle(const glm::dvec3& center, double radius,
  const vtkFFDProjection& projection, std::vector<Shape>& shapes)
{
  Shape shape;
  shape.Rgb = MiddleColor;
  shape.Line = MakeRing(center, radius, projection.Right, projection.Up);
  shapes.push_back(shape);
}
