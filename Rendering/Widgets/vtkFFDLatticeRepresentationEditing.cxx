// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The editing methods of the representation, for scripts and keys: they check what they are given
// and leave the rest to ffd::LatticeEditor.
#include "vtkFFDLatticeRepresentationInternals.h"

#include "vtkCommand.h"
#include "vtkIdTypeArray.h"
#include "vtkMath.h"
#include "vtkRenderer.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace
{

/// Length of a nudge, as a part of the smallest spacing.
constexpr double DefaultNudge = 0.05;

ffd::SelectionOperation ToOperation(int operation)
{
  return static_cast<ffd::SelectionOperation>(operation);
}

} // namespace

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SelectPoint(int i, int j, int k, int operation)
{
  const vtkIdType point = this->Internals->FindIndex("SelectPoint", i, j, k);
  return point < 0 ? 0 : this->SelectPoint(point, operation);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SelectPoint(vtkIdType point, int operation)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!in.Editor.IsPoint(point))
  {
    vtkErrorMacro("SelectPoint: there is no control point "
      << point << "; the lattice has " << in.Editor.GetNumberOfPoints() << ".");
    return 0;
  }
  if (!in.IsOperation("SelectPoint", operation))
  {
    return 0;
  }
  in.ChangeSelection(
    [&] { in.Editor.Select(static_cast<std::size_t>(point), ToOperation(operation)); });
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::IsPointSelected(int i, int j, int k)
{
  this->Internals->Sync();
  return this->IsPointSelected(this->Internals->Editor.FindPoint({ i, j, k }));
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::IsPointSelected(vtkIdType point)
{
  this->Internals->Sync();
  return this->Internals->Editor.IsSelected(point) ? 1 : 0;
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLatticeRepresentation::GetActivePoint()
{
  this->Internals->Sync();
  return this->Internals->Editor.GetActive();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SetSelectedPoints(vtkIdTypeArray* points)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!in.IsGiven(points, "SetSelectedPoints", "the array is null"))
  {
    return 0;
  }
  ffd::PointSet selected(in.Editor.GetNumberOfPoints(), 0);
  std::ptrdiff_t last = ffd::LatticeEditor::None;
  for (vtkIdType p = 0; p < points->GetNumberOfValues(); ++p)
  {
    last = points->GetValue(p);
    if (!in.Editor.IsPoint(last))
    {
      vtkErrorMacro("SetSelectedPoints: there is no control point "
        << last << "; the lattice has " << in.Editor.GetNumberOfPoints() << ".");
      return 0;
    }
    selected[static_cast<std::size_t>(last)] = 1;
  }
  in.ChangeSelection([&] { in.Editor.SetSelected(selected, last); });
  return 1;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GetSelectedPoints(vtkIdTypeArray* points)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!in.IsGiven(points, "GetSelectedPoints", "the array is null"))
  {
    return;
  }
  points->SetNumberOfComponents(1);
  points->SetNumberOfTuples(0);
  const ffd::PointSet& selected = in.Editor.GetSelected();
  for (std::size_t p = 0; p < selected.size(); ++p)
  {
    if (selected[p])
    {
      points->InsertNextValue(static_cast<vtkIdType>(p));
    }
  }
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLatticeRepresentation::GetNumberOfSelectedPoints()
{
  this->Internals->Sync();
  return static_cast<vtkIdType>(this->Internals->Editor.GetNumberOfSelected());
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SelectAll()
{
  this->Internals->ChangeSelection([this] { this->Internals->Editor.SelectAll(); });
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ClearSelection()
{
  this->Internals->ChangeSelection([this] { this->Internals->Editor.ClearSelection(); });
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::InvertSelection()
{
  this->Internals->ChangeSelection([this] { this->Internals->Editor.InvertSelection(); });
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GrowSelection()
{
  this->Internals->ChangeSelection([this] { this->Internals->Editor.GrowSelection(); });
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ShrinkSelection()
{
  this->Internals->ChangeSelection([this] { this->Internals->Editor.ShrinkSelection(); });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SelectRows(int axis)
{
  if (axis < 0 || axis > 2)
  {
    vtkErrorMacro("SelectRows: axis " << axis << " is none of 0, 1 and 2.");
    return 0;
  }
  this->Internals->ChangeSelection([this, axis] { this->Internals->Editor.SelectRows(axis); });
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SelectPlanes(int axis)
{
  if (axis < 0 || axis > 2)
  {
    vtkErrorMacro("SelectPlanes: axis " << axis << " is none of 0, 1 and 2.");
    return 0;
  }
  this->Internals->ChangeSelection([this, axis] { this->Internals->Editor.SelectPlanes(axis); });
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SelectRegion(
  double x0, double y0, double x1, double y1, int operation)
{
  vtkInternals& in = *this->Internals;
  if (!in.RequireView("SelectRegion") || !in.IsOperation("SelectRegion", operation))
  {
    return 0;
  }
  in.Load();
  const vtkFFDProjection projection(this->Renderer);
  const vtkFFDLatticeGeometry geometry(
    in.Editor.GetLattice(), in.GetMatrix(), this->InteriorVisibility != 0);
  ffd::PointSet within(in.Editor.GetNumberOfPoints(), 0);
  int found = 0;
  for (std::size_t p = 0; p < within.size(); ++p)
  {
    glm::dvec3 at;
    if (geometry.IsShown(p) && projection.ToDisplay(geometry.GetPosition(p), at) &&
      at.x >= std::min(x0, x1) && at.x <= std::max(x0, x1) && at.y >= std::min(y0, y1) &&
      at.y <= std::max(y0, y1))
    {
      within[p] = 1;
      ++found;
    }
  }
  in.ChangeSelection([&] { in.Editor.Select(within, ToOperation(operation)); });
  return found;
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLatticeRepresentation::FindPoint(double x, double y)
{
  this->Internals->Sync();
  return this->Internals->FindPoint({ x, y });
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLatticeRepresentation::GetHoveredPoint()
{
  this->Internals->Sync();
  return this->Internals->Hovered;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::GetSelectionCenter(double center[3])
{
  vtkInternals& in = *this->Internals;
  if (!in.IsGiven(center, "GetSelectionCenter",
        "there is no place for the center. Give one for three coordinates"))
  {
    return 0;
  }
  in.Load();
  glm::dvec3 found;
  const bool any = in.Editor.GetSelectionCenter(found);
  std::copy_n(&found.x, 3, center);
  return any ? 1 : 0;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::TranslateSelection(double dx, double dy, double dz)
{
  vtkInternals& in = *this->Internals;
  if (!vtkFFDAreFinite(dx, dy, dz))
  {
    vtkErrorMacro("TranslateSelection: (" << dx << ", " << dy << ", " << dz << ") is not finite.");
    return 0;
  }
  return in.Edit("Translate", [&] { return in.Editor.TranslateSelection({ dx, dy, dz }); });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::RotateSelection(
  double degrees, double axisX, double axisY, double axisZ)
{
  vtkInternals& in = *this->Internals;
  const glm::dvec3 axis(axisX, axisY, axisZ);
  if (!vtkFFDAreFinite(axisX, axisY, axisZ) || !std::isfinite(degrees) ||
    !(glm::length(axis) > 0.0))
  {
    vtkErrorMacro(
      "RotateSelection: " << degrees << " degrees about (" << axisX << ", " << axisY << ", "
                          << axisZ << ") is no rotation: all must be finite, the axis not zero.");
    return 0;
  }
  return in.Edit("Rotate", [&] {
    return in.Editor.RotateSelection(vtkMath::RadiansFromDegrees(degrees), glm::normalize(axis));
  });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::ScaleSelection(double sx, double sy, double sz)
{
  vtkInternals& in = *this->Internals;
  if (!vtkFFDAreFinite(sx, sy, sz))
  {
    vtkErrorMacro("ScaleSelection: (" << sx << ", " << sy << ", " << sz << ") is not finite.");
    return 0;
  }
  return in.Edit("Scale", [&] { return in.Editor.ScaleSelection({ sx, sy, sz }); });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SetControlPoint(int i, int j, int k, double x, double y, double z)
{
  vtkInternals& in = *this->Internals;
  if (!vtkFFDAreFinite(x, y, z))
  {
    vtkErrorMacro("SetControlPoint: (" << x << ", " << y << ", " << z << ") is not finite.");
    return 0;
  }
  const vtkIdType point = in.FindIndex("SetControlPoint", i, j, k);
  return point < 0 ? 0 : in.Edit("Set", [&] {
    return in.Editor.SetControlPoint(static_cast<std::size_t>(point), { x, y, z });
  });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::NudgeSelection(double right, double up)
{
  vtkInternals& in = *this->Internals;
  if (!vtkFFDAreFinite(right, up))
  {
    vtkErrorMacro("NudgeSelection: (" << right << ", " << up << ") is not finite.");
    return 0;
  }
  if (!in.RequireView("NudgeSelection", "; TranslateSelection() needs none"))
  {
    return 0;
  }
  const vtkFFDProjection projection(this->Renderer);
  const glm::dmat3 toData = glm::inverse(glm::dmat3(in.GetMatrix()));
  return in.Edit("Nudge", [&] {
    const double step =
      this->NudgeStep > 0.0 ? this->NudgeStep : DefaultNudge * in.Editor.GetSmallestSpacing();
    return in.Editor.TranslateSelection(step *
        ffd::FindScreenMove(static_cast<ffd::MoveConstraint>(this->Constraint), right, up,
          toData * projection.Right, toData * projection.Up),
      "Nudge");
  });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::ResetPoint(int i, int j, int k)
{
  vtkInternals& in = *this->Internals;
  const vtkIdType point = in.FindIndex("ResetPoint", i, j, k);
  return point < 0 ? 0 : in.Edit("Reset", [&] {
    ffd::PointSet points(in.Editor.GetNumberOfPoints(), 0);
    points[static_cast<std::size_t>(point)] = 1;
    return in.Editor.Reset(points);
  });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::ResetSelection()
{
  vtkInternals& in = *this->Internals;
  return in.Edit("Reset", [&in] { return in.Editor.Reset(in.Editor.GetSelected()); });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::ResetAll()
{
  vtkInternals& in = *this->Internals;
  return in.Edit("Reset", [&in] { return in.Editor.ResetAll(); });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::MoveMaterial(const double from[3], const double to[3])
{
  vtkInternals& in = *this->Internals;
  if (!from || !to || !vtkFFDAreFinite(from[0], from[1], from[2]) ||
    !vtkFFDAreFinite(to[0], to[1], to[2]))
  {
    vtkErrorMacro("MoveMaterial: both positions must be finite.");
    return 0;
  }
  std::string problem;
  const int changed = in.Edit("Material", [&] {
    return in.Editor.MoveMaterialAt(
      { from[0], from[1], from[2] }, { to[0], to[1], to[2] }, problem);
  });
  if (!problem.empty())
  {
    vtkErrorMacro("MoveMaterial: the material at (" << from[0] << ", " << from[1] << ", " << from[2]
                                                    << ") cannot be moved: " << problem << ".");
  }
  return changed;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::MoveMaterial(
  double x0, double y0, double z0, double x1, double y1, double z1)
{
  const double from[3] = { x0, y0, z0 };
  const double to[3] = { x1, y1, z1 };
  return this->MoveMaterial(from, to);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::AddPin(double x, double y, double z)
{
  vtkInternals& in = *this->Internals;
  in.Load();
  glm::dvec3 rest;
  const std::string problem = vtkFFDAreFinite(x, y, z) ? in.Editor.FindMaterial({ x, y, z }, rest)
                                                       : "the position is not finite";
  if (!problem.empty())
  {
    vtkErrorMacro("AddPin: no pin at (" << x << ", " << y << ", " << z << "): " << problem << ".");
    return 0;
  }
  std::vector<glm::dvec3> pins = in.Editor.GetPins();
  pins.push_back(rest);
  in.Editor.SetPins(pins);
  this->Modified();
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::AddPinAtWorld(const double world[3])
{
  if (!this->Internals->IsGiven(
        world, "AddPinAtWorld", "the position is null. Give three world coordinates"))
  {
    return 0;
  }
  const glm::dvec3 p = vtkFFDTransformPoint(
    glm::inverse(this->Internals->GetMatrix()), { world[0], world[1], world[2] });
  return this->AddPin(p.x, p.y, p.z);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::GetNumberOfPins()
{
  return static_cast<int>(this->Internals->Editor.GetPins().size());
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GetPin(int pin, double position[3])
{
  vtkInternals& in = *this->Internals;
  if (!in.IsGiven(
        position, "GetPin", "there is no place for the position. Give one for three coordinates"))
  {
    return;
  }
  if (pin < 0 || pin >= this->GetNumberOfPins())
  {
    vtkErrorMacro("GetPin: there is no pin " << pin << " of " << this->GetNumberOfPins() << ".");
    std::fill_n(position, 3, 0.0);
    return;
  }
  in.Lattice->Update();
  in.Lattice->InternalTransformPoint(
    &in.Editor.GetPins()[static_cast<std::size_t>(pin)].x, position);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ClearPins()
{
  if (this->GetNumberOfPins() > 0)
  {
    this->Internals->Editor.SetPins({});
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetSurfacePicker(vtkAbstractPicker* picker)
{
  if (this->Internals->SurfacePicker != picker)
  {
    this->Internals->SurfacePicker = picker;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkAbstractPicker* vtkFFDLatticeRepresentation::GetSurfacePicker()
{
  return this->Internals->SurfacePicker;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetSurfacePoint(double x, double y, double z)
{
  if (!vtkFFDAreFinite(x, y, z))
  {
    vtkErrorMacro("SetSurfacePoint: (" << x << ", " << y << ", " << z << ") is not finite.");
    return;
  }
  this->Internals->SurfacePoint = glm::dvec3(x, y, z);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::PickSurface(double x, double y, double world[3])
{
  vtkInternals& in = *this->Internals;
  if (!in.IsGiven(world, "PickSurface",
        "there is no place for the position. Give one for three world coordinates") ||
    !in.RequireView("PickSurface") || !vtkFFDAreFinite(x, y))
  {
    return 0;
  }
  in.SurfacePoint.reset();
  double display[2] = { x, y };
  this->InvokeEvent(vtkCommand::StartPickEvent, display);
  if (in.SurfacePoint)
  {
    std::copy_n(&in.SurfacePoint->x, 3, world);
    return 1;
  }
  if (!in.RequireView("PickSurface")) // an observer may have taken it away
  {
    return 0;
  }
  if (in.SurfacePicker)
  {
    if (!in.SurfacePicker->Pick(x, y, 0.0, this->Renderer))
    {
      return 0;
    }
    in.SurfacePicker->GetPickPosition(world);
    return vtkFFDAreFinite(world[0], world[1], world[2]) ? 1 : 0;
  }
  glm::dvec3 point;
  if (!in.PickDepth({ x, y }, point))
  {
    return 0;
  }
  std::copy_n(&point.x, 3, world);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::Undo()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  return in.Editor.IsEditing() ? 0 : in.Edit("Undo", [&in] { return in.Editor.Undo(); });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::Redo()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  return in.Editor.IsEditing() ? 0 : in.Edit("Redo", [&in] { return in.Editor.Redo(); });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::GetNumberOfUndos()
{
  this->Internals->Sync();
  return static_cast<int>(this->Internals->Editor.GetHistory().GetNumberOfUndos());
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::GetNumberOfRedos()
{
  this->Internals->Sync();
  return static_cast<int>(this->Internals->Editor.GetHistory().GetNumberOfRedos());
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ClearHistory() { this->Internals->Editor.GetHistory().Clear(); }

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetUndoMemoryLimit(vtkTypeInt64 bytes)
{
  if (bytes < 0)
  {
    vtkErrorMacro("SetUndoMemoryLimit: " << bytes << " bytes; it must not be negative.");
    return;
  }
  this->Internals->Editor.GetHistory().SetMemoryLimit(static_cast<std::size_t>(bytes));
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkFFDLatticeRepresentation::GetUndoMemoryLimit()
{
  return static_cast<vtkTypeInt64>(this->Internals->Editor.GetHistory().GetMemoryLimit());
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkFFDLatticeRepresentation::GetUndoMemorySize()
{
  return static_cast<vtkTypeInt64>(this->Internals->Editor.GetHistory().GetMemorySize());
}

//------------------------------------------------------------------------------
const char* vtkFFDLatticeRepresentation::GetLastEdit()
{
  return this->Internals->Editor.GetLastEdit().c_str();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GetChangedPoints(vtkIdTypeArray* points)
{
  if (!this->Internals->IsGiven(points, "GetChangedPoints", "the array is null"))
  {
    return;
  }
  points->SetNumberOfComponents(1);
  points->SetNumberOfTuples(0);
  for (std::size_t point : this->Internals->Editor.GetChangedPoints())
  {
    points->InsertNextValue(static_cast<vtkIdType>(point));
  }
}
