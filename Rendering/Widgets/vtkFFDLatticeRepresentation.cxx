// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The representation as a prop: what is shown, how it looks, drags. The editing methods are in
// vtkFFDLatticeRepresentationEditing.cxx.
#include "vtkFFDLatticeRepresentationInternals.h"

#include "vtkFFDLatticeData.h"

#include "vtkAssemblyPath.h"
#include "vtkAssemblyPaths.h"
#include "vtkMath.h"
#include "vtkObjectFactory.h"
#include "vtkPickingManager.h"
#include "vtkProperty2D.h"
#include "vtkRenderer.h"
#include "vtkTextProperty.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <string>

vtkStandardNewMacro(vtkFFDLatticeRepresentation);

//------------------------------------------------------------------------------
vtkFFDLatticeRepresentation::vtkFFDLatticeRepresentation()
  : Internals(new vtkInternals(this))
{
  this->InteractionState = Outside;
  this->HandleSize = 9.0;
  this->PlaceFactor = 1.0;
  vtkMath::UninitializeBounds(this->Bounds);
  this->Internals->Load();
}

//------------------------------------------------------------------------------
vtkFFDLatticeRepresentation::~vtkFFDLatticeRepresentation() = default;

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const vtkInternals& in = *this->Internals;
  const auto line = [&os, &indent](
                      const char* name) -> ostream& { return os << indent << name << ": "; };
  line("Lattice") << in.Lattice.Get() << "\n";
  line("Prop") << in.Prop.Get() << "\n";
  line("SurfacePicker") << in.SurfacePicker.Get() << "\n";
  double b[6];
  this->GetOutlineBounds(b);
  line("OutlineBounds") << b[0] << ", " << b[1] << ", " << b[2] << ", " << b[3] << ", " << b[4]
                        << ", " << b[5] << "\n";
  line("NumberOfSelectedPoints") << this->GetNumberOfSelectedPoints() << "\n";
  line("ActivePoint") << in.Editor.GetActive() << "\n";
  line("HoveredPoint") << in.Hovered << "\n";
  line("NumberOfPins") << in.Editor.GetPins().size() << "\n";
  line("NumberOfUndos") << in.Editor.GetHistory().GetNumberOfUndos() << "\n";
  line("NumberOfRedos") << in.Editor.GetHistory().GetNumberOfRedos() << "\n";
  line("UndoMemoryLimit") << in.Editor.GetHistory().GetMemoryLimit() << "\n";
  line("UndoMemorySize") << in.Editor.GetHistory().GetMemorySize() << "\n";
  line("LastEdit") << in.Editor.GetLastEdit() << "\n";
  line("Constraint") << this->Constraint << "\n";
  line("ProportionalEditing") << this->ProportionalEditing << "\n";
  line("ProportionalRadius") << this->ProportionalRadius << "\n";
  line("Falloff") << this->Falloff << "\n";
  line("Symmetry") << this->Symmetry[0] << ", " << this->Symmetry[1] << ", " << this->Symmetry[2]
                   << "\n";
  line("LockBoundary") << this->LockBoundary << "\n";
  line("LockedLayers") << this->LockedLayers << "\n";
  line("FoldGuard") << this->FoldGuard << "\n";
  line("MinimumDeterminant") << this->MinimumDeterminant << "\n";
  line("NudgeStep") << this->NudgeStep << "\n";
  line("ManipulationMode") << this->ManipulationMode << "\n";
  line("HandleMode") << this->HandleMode << "\n";
  line("LineMode") << this->LineMode << "\n";
  line("PointVisibility") << this->PointVisibility << "\n";
  line("InteriorVisibility") << this->InteriorVisibility << "\n";
  line("LineVisibility") << this->LineVisibility << "\n";
  line("OutlineVisibility") << this->OutlineVisibility << "\n";
  line("LabelVisibility") << this->LabelVisibility << "\n";
  line("HiddenOpacity") << this->HiddenOpacity << "\n";
  line("CullHidden") << this->CullHidden << "\n";
  line("TransformHandleSize") << this->TransformHandleSize << "\n";
  line("PickTolerance") << this->PickTolerance << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetLattice(vtkFFDLattice* lattice)
{
  if (!lattice)
  {
    vtkErrorMacro("SetLattice: the lattice is null. Give a vtkFFDLattice.");
    return;
  }
  vtkInternals& in = *this->Internals;
  if (in.Lattice != lattice)
  {
    this->CancelInteraction();
    in.Lattice = lattice;
    in.Editor.StartWith(vtkInternals::FindUsableValue(lattice));
    in.Hovered = -1;
    in.HoveredPart = vtkFFDTransformGizmo::NoPart;
    this->InteractionState = Outside;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDLatticeRepresentation::GetLattice() { return this->Internals->Lattice; }

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetProp(vtkProp3D* prop)
{
  if (this->Internals->Prop != prop)
  {
    this->Internals->Prop = prop;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkProp3D* vtkFFDLatticeRepresentation::GetProp() { return this->Internals->Prop; }

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetOutlineBounds(const double bounds[6])
{
  if (!bounds)
  {
    vtkErrorMacro("SetOutlineBounds: the bounds are null. Give (xmin, xmax, ymin, ...).");
    return;
  }
  for (int a = 0; a < 3; ++a)
  {
    if (!(bounds[2 * a] <= bounds[2 * a + 1]) || !vtkFFDAreFinite(bounds[2 * a], bounds[2 * a + 1]))
    {
      vtkErrorMacro("SetOutlineBounds: bounds of axis "
        << a << " are " << bounds[2 * a] << " to " << bounds[2 * a + 1]
        << "; they must be finite, the lower one first.");
      return;
    }
  }
  std::array<double, 6> wanted;
  std::copy_n(bounds, 6, wanted.begin());
  if (this->Internals->OutlineBounds != wanted)
  {
    this->Internals->OutlineBounds = wanted;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GetOutlineBounds(double bounds[6])
{
  if (!this->Internals->IsGiven(
        bounds, "GetOutlineBounds", "there is no place for the six bounds. Give one"))
  {
    return;
  }
  const vtkInternals& in = *this->Internals;
  if (in.OutlineBounds)
  {
    std::copy_n(in.OutlineBounds->begin(), 6, bounds);
  }
  else
  {
    in.Lattice->GetDomain(bounds);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::PlaceWidget(double bounds[6])
{
  bool usable = bounds != nullptr;
  bool extent = false;
  for (int a = 0; a < 3 && usable; ++a)
  {
    usable =
      bounds[2 * a] <= bounds[2 * a + 1] && vtkFFDAreFinite(bounds[2 * a], bounds[2 * a + 1]);
    extent = extent || bounds[2 * a] < bounds[2 * a + 1];
  }
  if (!usable || !extent)
  {
    vtkErrorMacro("PlaceWidget: the bounds must be finite, each lower one first, and not all flat. "
                  "Give those of the image, for instance vtkImageData::GetBounds().");
    return;
  }
  double placed[6];
  double center[3];
  this->AdjustBounds(bounds, placed, center);
  this->Internals->Lattice->FitToBounds(placed);
  this->SetOutlineBounds(bounds);
  std::copy_n(placed, 6, this->InitialBounds);
  this->InitialLength = std::sqrt((placed[1] - placed[0]) * (placed[1] - placed[0]) +
    (placed[3] - placed[2]) * (placed[3] - placed[2]) +
    (placed[5] - placed[4]) * (placed[5] - placed[4]));
  this->Placed = 1;
  this->ValidPick = 1;
  this->BuildRepresentation();
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDLatticeRepresentation::GetMTime()
{
  const vtkInternals& in = *this->Internals;
  vtkMTimeType time = std::max(this->Superclass::GetMTime(), in.Lattice->GetMTime());
  if (in.Prop)
  {
    time = std::max(time, in.Prop->GetMTime());
  }
  for (const vtkNew<vtkProperty>& look : in.Looks)
  {
    time = std::max(time, look->GetMTime());
  }
  return time;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::BuildRepresentation() { this->Internals->Build(); }

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetConstraint(int constraint)
{
  if (constraint < FREE || constraint > ACROSS_Z)
  {
    vtkErrorMacro("SetConstraint: " << constraint << " is none of FREE (0) to ACROSS_Z (6).");
    return;
  }
  if (this->Constraint != constraint)
  {
    this->Constraint = constraint;
    this->Modified();
    this->Internals->RepeatDrag();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetProportionalEditing(vtkTypeBool on)
{
  if (this->ProportionalEditing != on)
  {
    this->ProportionalEditing = on;
    this->Modified();
    this->Internals->RepeatDrag();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetProportionalRadius(double radius)
{
  const double before = this->ProportionalRadius;
  this->Internals->SetLength(
    "SetProportionalRadius", this->ProportionalRadius, radius, "two of the widest spacings");
  if (this->ProportionalRadius != before)
  {
    this->Internals->RepeatDrag();
  }
}

//------------------------------------------------------------------------------
double vtkFFDLatticeRepresentation::GetEffectiveRadius()
{
  this->Internals->Load();
  return this->Internals->Editor.GetEffectiveRadius();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetSymmetry(vtkTypeBool x, vtkTypeBool y, vtkTypeBool z)
{
  const vtkTypeBool symmetry[3] = { x, y, z };
  this->SetSymmetry(symmetry);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetSymmetry(const vtkTypeBool symmetry[3])
{
  if (this->Internals->IsGiven(symmetry, "SetSymmetry", "the flags are null. Give one per axis") &&
    !std::equal(symmetry, symmetry + 3, this->Symmetry))
  {
    std::copy_n(symmetry, 3, this->Symmetry);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetFalloff(int falloff)
{
  if (falloff < SMOOTH || falloff > CONSTANT)
  {
    vtkErrorMacro("SetFalloff: " << falloff << " is none of SMOOTH (0) to CONSTANT (4).");
    return;
  }
  if (this->Falloff != falloff)
  {
    this->Falloff = falloff;
    this->Modified();
    this->Internals->RepeatDrag();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetMinimumDeterminant(double determinant)
{
  if (!(determinant >= 0.0 && determinant < 1.0))
  {
    vtkErrorMacro("SetMinimumDeterminant: " << determinant << " is not from 0 to below 1.");
    return;
  }
  if (this->MinimumDeterminant != determinant)
  {
    this->MinimumDeterminant = determinant;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::IsFolded()
{
  return this->Internals->Lattice->GetMinimumJacobianBound() < this->MinimumDeterminant ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetNudgeStep(double step)
{
  this->Internals->SetLength(
    "SetNudgeStep", this->NudgeStep, step, "a twentieth of the smallest spacing");
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetHiddenOpacity(double opacity)
{
  this->Internals->SetClamped("SetHiddenOpacity", this->HiddenOpacity, opacity, 0.0, 1.0);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetHandleSize(double size)
{
  this->Internals->SetClamped("SetHandleSize", this->HandleSize, size, 0.001, 1000.0);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetPlaceFactor(double factor)
{
  this->Internals->SetClamped("SetPlaceFactor", this->PlaceFactor, factor, 0.01, VTK_DOUBLE_MAX);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetTransformHandleSize(double size)
{
  this->Internals->SetClamped(
    "SetTransformHandleSize", this->TransformHandleSize, size, 10.0, 1000.0);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetPickTolerance(double tolerance)
{
  this->Internals->SetClamped("SetPickTolerance", this->PickTolerance, tolerance, 1.0, 100.0);
}

//------------------------------------------------------------------------------
vtkProperty* vtkFFDLatticeRepresentation::GetPointProperty()
{
  return this->Internals->Looks[vtkInternals::PointLook];
}

//------------------------------------------------------------------------------
vtkProperty* vtkFFDLatticeRepresentation::GetSelectedPointProperty()
{
  return this->Internals->Looks[vtkInternals::SelectedLook];
}

//------------------------------------------------------------------------------
vtkProperty* vtkFFDLatticeRepresentation::GetHoveredPointProperty()
{
  return this->Internals->Looks[vtkInternals::HoveredLook];
}

//------------------------------------------------------------------------------
vtkProperty* vtkFFDLatticeRepresentation::GetLockedPointProperty()
{
  return this->Internals->Looks[vtkInternals::LockedLook];
}

//------------------------------------------------------------------------------
vtkProperty* vtkFFDLatticeRepresentation::GetPinProperty()
{
  return this->Internals->Looks[vtkInternals::PinLook];
}

//------------------------------------------------------------------------------
vtkProperty* vtkFFDLatticeRepresentation::GetLineProperty()
{
  return this->Internals->Looks[vtkInternals::LineLook];
}

//------------------------------------------------------------------------------
vtkProperty* vtkFFDLatticeRepresentation::GetOutlineProperty()
{
  return this->Internals->Looks[vtkInternals::OutlineLook];
}

//------------------------------------------------------------------------------
vtkProperty* vtkFFDLatticeRepresentation::GetWarningProperty()
{
  return this->Internals->Looks[vtkInternals::WarningLook];
}

//------------------------------------------------------------------------------
vtkProperty* vtkFFDLatticeRepresentation::GetHandleProperty()
{
  return this->Internals->Looks[vtkInternals::HandleLook];
}

//------------------------------------------------------------------------------
vtkProperty2D* vtkFFDLatticeRepresentation::GetRubberBandProperty()
{
  return this->Internals->Scene.GetRubberBandProperty();
}

//------------------------------------------------------------------------------
vtkTextProperty* vtkFFDLatticeRepresentation::GetLabelTextProperty()
{
  return this->Internals->Scene.GetLabelTextProperty();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::ComputeInteractionState(int x, int y, int)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (this->IsInteracting())
  {
    return this->InteractionState;
  }
  vtkIdType point = -1;
  int part = -1;
  if (this->ManipulationMode == CONTROL_POINTS && in.HasView())
  {
    this->BuildRepresentation();
    // Through the picking manager, which may say that another widget is in front.
    if (this->GetAssemblyPath(x, y, 0.0, in.Picker))
    {
      in.FindNearest(glm::dvec2(x, y), point, part);
    }
  }
  if (point != in.Hovered || part != in.HoveredPart)
  {
    in.Hovered = point;
    in.HoveredPart = part;
    this->Modified();
  }
  this->InteractionState = part >= 0 ? OnHandle : point >= 0 ? OnPoint : Outside;
  return this->InteractionState;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::StartWidgetInteraction(double position[2])
{
  if (!this->Internals->IsGiven(
        position, "StartWidgetInteraction", "the position is null. Give two display coordinates"))
  {
    return;
  }
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (this->IsInteracting())
  {
    this->CancelInteraction();
  }
  if (!in.RequireView("StartWidgetInteraction"))
  {
    return;
  }
  this->StartEventPosition[0] = position[0];
  this->StartEventPosition[1] = position[1];
  this->StartEventPosition[2] = 0.0;
  in.DragFrom = { position[0], position[1] };
  in.DragTo = in.DragFrom;
  in.Motion = glm::dvec3(0.0);
  in.Angle = 0.0;
  if (this->ManipulationMode == VOLUME)
  {
    this->InteractionState = Outside;
    glm::dvec3 world;
    if (!this->PickSurface(position[0], position[1], &world.x))
    {
      return;
    }
    in.Anchor = vtkFFDTransformPoint(glm::inverse(in.GetMatrix()), world);
    in.Load();
    const std::string problem = in.Editor.FindMaterial(in.Anchor, in.Material);
    if (!problem.empty())
    {
      vtkWarningMacro("The volume cannot be taken hold of: " << problem << ".");
      return;
    }
    in.StartDrag("Material", ffd::PointSet(in.Editor.GetNumberOfPoints(), 0),
      ffd::LatticeEditor::None, MovingMaterial);
  }
  else if (in.HoveredPart >= 0)
  {
    static const char* const names[] = { "", "Translate", "Rotate", "Scale" };
    in.Load();
    in.Editor.GetSelectionCenter(in.Anchor);
    in.Part = in.HoveredPart;
    in.StartDrag(
      names[this->HandleMode], in.Editor.GetSelected(), in.Editor.GetActive(), MovingHandle);
  }
  else if (in.Editor.IsPoint(in.Hovered))
  {
    const auto point = static_cast<std::size_t>(in.Hovered);
    in.Load();
    in.Anchor = in.Editor.GetLattice().GetControlPoint(point);
    ffd::PointSet set = in.Editor.GetSelected();
    set[point] = 1;
    in.StartDrag("Translate", set, in.Hovered, MovingPoints);
  }
  else
  {
    this->InteractionState = Outside;
  }
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::StartRegion(const double position[2], int operation)
{
  if (!this->Internals->IsGiven(
        position, "StartRegion", "the position is null. Give two display coordinates"))
  {
    return;
  }
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!in.IsOperation("StartRegion", operation))
  {
    return;
  }
  this->CancelInteraction();
  in.DragFrom = { position[0], position[1] };
  in.DragTo = in.DragFrom;
  in.RegionOperation = operation;
  in.Ended = false;
  this->InteractionState = SelectingRegion;
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::WidgetInteraction(double position[2])
{
  if (!this->Internals->IsGiven(
        position, "WidgetInteraction", "the position is null. Give two display coordinates"))
  {
    return;
  }
  vtkInternals& in = *this->Internals;
  in.Sync();
  // An observer may have taken the renderer away in the middle of a drag.
  if (!this->IsInteracting() || !in.HasView() || !vtkFFDAreFinite(position[0], position[1]))
  {
    return;
  }
  const glm::dvec2 before = in.DragTo;
  in.DragTo = { position[0], position[1] };
  this->Modified();
  if (this->InteractionState == SelectingRegion)
  {
    return;
  }
  in.Load();
  if (this->InteractionState == MovingHandle)
  {
    in.DragHandle(before);
  }
  else
  {
    in.Motion = in.FindMotion(this->Constraint);
    if (this->InteractionState == MovingPoints)
    {
      in.Editor.TranslateGrabbed(in.Motion);
    }
    else
    {
      // Failure needs no report: the material does not move, which the user sees.
      in.Editor.MoveMaterial(in.Material, in.Anchor + in.Motion);
    }
  }
  in.Store();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::EndWidgetInteraction(double position[2])
{
  if (!this->Internals->IsGiven(
        position, "EndWidgetInteraction", "the position is null. Give two display coordinates"))
  {
    return;
  }
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!this->IsInteracting())
  {
    return;
  }
  this->WidgetInteraction(position);
  const int state = this->InteractionState;
  in.Ended = true;
  this->InteractionState = Outside;
  this->Modified();
  if (state == SelectingRegion)
  {
    this->SelectRegion(in.DragFrom.x, in.DragFrom.y, in.DragTo.x, in.DragTo.y, in.RegionOperation);
  }
  else
  {
    in.Load();
    if (in.Editor.Commit())
    {
      in.ReportEdit();
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::CancelInteraction()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (this->IsInteracting())
  {
    in.Ended = true;
    this->InteractionState = Outside;
    in.Load();
    if (in.Editor.IsEditing())
    {
      in.Editor.Rollback();
      in.Store();
    }
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::IsInteracting() { return this->Internals->Ended ? 0 : 1; }

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::Highlight(int on)
{
  vtkInternals& in = *this->Internals;
  if (!on && (in.Hovered >= 0 || in.HoveredPart >= 0))
  {
    in.Hovered = -1;
    in.HoveredPart = -1;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
double* vtkFFDLatticeRepresentation::GetBounds()
{
  this->BuildRepresentation();
  return this->Bounds;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GetActors(vtkPropCollection* actors)
{
  if (!this->Internals->IsGiven(
        actors, "GetActors", "the collection is null. Give a vtkPropCollection"))
  {
    return;
  }
  this->Internals->Scene.GetActors(actors);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Internals->Scene.ReleaseGraphicsResources(window);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::RenderOpaqueGeometry(vtkViewport* viewport)
{
  if (!this->Internals->IsGiven(
        viewport, "RenderOpaqueGeometry", "the viewport is null. Give the renderer that draws"))
  {
    return 0;
  }
  this->BuildRepresentation();
  return this->Internals->Scene.RenderOpaqueGeometry(viewport);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::RenderTranslucentPolygonalGeometry(vtkViewport* viewport)
{
  if (!this->Internals->IsGiven(viewport, "RenderTranslucentPolygonalGeometry",
        "the viewport is null. Give the renderer that draws"))
  {
    return 0;
  }
  return this->Internals->Scene.RenderTranslucentPolygonalGeometry(
    viewport, this->GetPropertyKeys());
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::RenderOverlay(vtkViewport* viewport)
{
  if (!this->Internals->IsGiven(
        viewport, "RenderOverlay", "the viewport is null. Give the renderer that draws"))
  {
    return 0;
  }
  vtkRenderer* renderer = vtkRenderer::SafeDownCast(viewport);
  vtkFFDPixelBox part;
  if (renderer && this->CullHidden)
  {
    part = vtkFFDFindHiding(renderer, this);
  }
  else
  {
    int size[2];
    viewport->GetTiledSizeAndOrigin(&size[0], &size[1], &part.Low.x, &part.Low.y);
    part.High = part.Low + glm::ivec2(size[0], size[1]);
  }
  return this->Internals->Scene.RenderOverlay(viewport, part);
}

//------------------------------------------------------------------------------
vtkTypeBool vtkFFDLatticeRepresentation::HasTranslucentPolygonalGeometry()
{
  this->BuildRepresentation();
  return this->Internals->Scene.HasTranslucentPolygonalGeometry() ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::RegisterPickers()
{
  vtkPickingManager* manager = this->GetPickingManager();
  if (manager)
  {
    manager->AddPicker(this->Internals->Picker, this);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::BuildPaths(vtkAssemblyPaths* paths, vtkAssemblyPath* path)
{
  if (this->Internals->IsGiven(paths, "BuildPaths", "the paths are null. Give vtkAssemblyPaths") &&
    this->Internals->IsGiven(path, "BuildPaths", "the path is null. Give a vtkAssemblyPath"))
  {
    this->Superclass::BuildPaths(paths, path);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ShallowCopy(vtkProp* prop)
{
  if (!this->Internals->IsGiven(
        prop, "ShallowCopy", "the prop to copy is null. Give a vtkFFDLatticeRepresentation"))
  {
    return;
  }
  auto* other = vtkFFDLatticeRepresentation::SafeDownCast(prop);
  if (other && other != this)
  {
    other->Internals->Sync();
    const vtkInternals& from = *other->Internals;
    vtkInternals& in = *this->Internals;
    this->CancelInteraction();
    this->SetLattice(from.Lattice);
    in.Sync();
    this->SetProp(from.Prop);
    this->SetSurfacePicker(from.SurfacePicker);
    in.OutlineBounds = from.OutlineBounds;
    in.Editor.SetSelected(from.Editor.GetSelected(), from.Editor.GetActive());
    in.Editor.SetPins(from.Editor.GetPins());
    this->SetUndoMemoryLimit(other->GetUndoMemoryLimit());
    this->Constraint = other->Constraint;
    this->ProportionalEditing = other->ProportionalEditing;
    this->ProportionalRadius = other->ProportionalRadius;
    this->Falloff = other->Falloff;
    std::copy_n(other->Symmetry, 3, this->Symmetry);
    this->LockBoundary = other->LockBoundary;
    this->LockedLayers = other->LockedLayers;
    this->FoldGuard = other->FoldGuard;
    this->MinimumDeterminant = other->MinimumDeterminant;
    this->NudgeStep = other->NudgeStep;
    this->ManipulationMode = other->ManipulationMode;
    this->HandleMode = other->HandleMode;
    this->LineMode = other->LineMode;
    this->PointVisibility = other->PointVisibility;
    this->InteriorVisibility = other->InteriorVisibility;
    this->LineVisibility = other->LineVisibility;
    this->OutlineVisibility = other->OutlineVisibility;
    this->LabelVisibility = other->LabelVisibility;
    this->HiddenOpacity = other->HiddenOpacity;
    this->CullHidden = other->CullHidden;
    this->TransformHandleSize = other->TransformHandleSize;
    this->PickTolerance = other->PickTolerance;
    this->HandleSize = other->HandleSize;
    this->PlaceFactor = other->PlaceFactor;
    for (int look = 0; look < vtkInternals::NumberOfLooks; ++look)
    {
      in.Looks[look]->DeepCopy(from.Looks[look]);
    }
    this->GetRubberBandProperty()->DeepCopy(other->GetRubberBandProperty());
    this->GetLabelTextProperty()->ShallowCopy(other->GetLabelTextProperty());
    this->Modified();
  }
  this->Superclass::ShallowCopy(prop);
}
