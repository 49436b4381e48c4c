// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLatticeRepresentationInternals.h"

#include "vtkFFDLatticeData.h"

#include "FFDGridIndex.h"

#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkInteractorObserver.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkSmartPointer.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <limits>
#include <vector>

namespace
{

/// Control points whose pictures are nearer to each other than this cover each other, pixels.
constexpr double Covering = 2.0;

vtkFFDLatticeScene::Color ToBytes(const double rgb[3])
{
  vtkFFDLatticeScene::Color bytes;
  for (std::size_t c = 0; c < 3; ++c)
  {
    bytes[c] = static_cast<unsigned char>(std::lround(255.0 * glm::clamp(rgb[c], 0.0, 1.0)));
  }
  return bytes;
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDLatticeRepresentation::vtkInternals::vtkInternals(vtkFFDLatticeRepresentation* self)
  : Self(self)
{
  this->Looks[PointLook]->SetColor(0.85, 0.87, 0.9);
  this->Looks[PointLook]->SetAmbient(0.35);
  this->Looks[PointLook]->SetDiffuse(0.65);
  this->Looks[SelectedLook]->SetColor(1.0, 0.6, 0.1);
  this->Looks[HoveredLook]->SetColor(1.0, 0.95, 0.3);
  this->Looks[LockedLook]->SetColor(0.45, 0.47, 0.5);
  this->Looks[PinLook]->SetColor(0.95, 0.25, 0.6);
  this->Looks[LineLook]->SetColor(0.55, 0.65, 0.75);
  this->Looks[LineLook]->LightingOff();
  this->Looks[OutlineLook]->SetColor(0.95, 0.95, 0.95);
  this->Looks[OutlineLook]->SetLineWidth(2.0f);
  this->Looks[OutlineLook]->LightingOff();
  this->Looks[WarningLook]->SetColor(1.0, 0.15, 0.1);
  this->Looks[HandleLook]->SetLineWidth(3.0f);
  this->Looks[HandleLook]->LightingOff();
  this->Picker->SetOwner(
    self, [this](double x, double y, double world[3]) { return this->FindPicked(x, y, world); });
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::Sync()
{
  glm::ivec3 nodes;
  this->Lattice->GetDimensions(&nodes.x);
  if (nodes != this->Editor.GetLattice().Net.Nodes)
  {
    this->Load();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::Load()
{
  this->LoadOptions();
  if (this->Editor.SetLattice(FindUsableValue(this->Lattice)))
  {
    this->Hovered = -1;
    this->HoveredPart = vtkFFDTransformGizmo::NoPart;
    this->Ended = true;
    this->Self->InteractionState = Outside;
    this->Self->Modified();
  }
}

//------------------------------------------------------------------------------
ffd::Lattice vtkFFDLatticeRepresentation::vtkInternals::FindUsableValue(vtkFFDLattice* lattice)
{
  ffd::Lattice value = vtkFFDGetLatticeValue(lattice);
  const bool usable =
    value.HasPossibleDimensions() && value.Net.Values.size() == ffd::GridSize(value.Net.Nodes);
  return usable ? value : ffd::Lattice();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::LoadOptions()
{
  const vtkFFDLatticeRepresentation* self = this->Self;
  ffd::EditOptions& options = this->Editor.Options;
  options.Proportional = self->ProportionalEditing != 0;
  options.Radius = self->ProportionalRadius;
  options.RadialFalloff = static_cast<ffd::Falloff>(self->Falloff);
  for (int a = 0; a < 3; ++a)
  {
    options.Mirror[a] = self->Symmetry[a] != 0;
  }
  options.LockedLayers = self->LockBoundary ? self->LockedLayers : 0;
  options.StopsAtFolds = self->FoldGuard == GUARD_CLAMP;
  options.MinimumDeterminant = self->MinimumDeterminant;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::Store()
{
  if (vtkFFDWriteTuples(this->Editor.GetLattice().Net.Values, this->Lattice->GetDisplacements()))
  {
    this->Lattice->Modified();
    this->Self->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::vtkInternals::Edit(
  const char* name, const std::function<bool()>& edit)
{
  this->Load();
  if (this->Editor.IsEditing())
  {
    vtkErrorWithObjectMacro(this->Self, << name << ": a drag is going on. End or cancel it first.");
    return 0;
  }
  this->Editor.TakeRefusal(); // of a drag
  const bool changed = edit();
  if (this->Editor.TakeRefusal())
  {
    vtkErrorWithObjectMacro(
      this->Self, << name
                  << ": control points would be displaced by more than 1e100, "
                     "or by what is not a number; all stay. Move them less.");
  }
  if (changed)
  {
    this->Store();
    this->ReportEdit();
  }
  return changed ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::ReportEdit()
{
  std::string name = this->Editor.GetLastEdit(); // a copy: the call data is not const
  this->Self->InvokeEvent(vtkCommand::WidgetValueChangedEvent, &name[0]);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::ChangeSelection(const std::function<void()>& change)
{
  this->Sync();
  change();
  this->Self->Modified();
  this->Self->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLatticeRepresentation::vtkInternals::FindIndex(
  const char* name, int i, int j, int k)
{
  this->Sync();
  const std::ptrdiff_t point = this->Editor.FindPoint({ i, j, k });
  if (point == ffd::LatticeEditor::None)
  {
    const glm::ivec3& nodes = this->Editor.GetLattice().Net.Nodes;
    vtkErrorWithObjectMacro(this->Self, << name << ": there is no control point (" << i << ", " << j
                                        << ", " << k << "); the lattice has " << nodes.x << " x "
                                        << nodes.y << " x " << nodes.z << ".");
  }
  return point;
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeRepresentation::vtkInternals::IsGiven(
  const void* pointer, const char* name, const char* what)
{
  if (!pointer)
  {
    vtkErrorWithObjectMacro(this->Self, << name << ": " << what << ".");
  }
  return pointer != nullptr;
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeRepresentation::vtkInternals::IsOperation(const char* name, int operation)
{
  const bool known = operation >= REPLACE && operation <= TOGGLE;
  if (!known)
  {
    vtkErrorWithObjectMacro(
      this->Self, << name << ": " << operation << " is none of REPLACE, ADD and TOGGLE.");
  }
  return known;
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeRepresentation::vtkInternals::RequireView(const char* name, const char* advice)
{
  if (!this->HasView())
  {
    vtkErrorWithObjectMacro(this->Self,
      << name << ": there is no renderer in a window. Enable the widget, or call SetRenderer()"
      << advice << ".");
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::SetClamped(
  const char* name, double& member, double value, double low, double high)
{
  if (std::isnan(value))
  {
    vtkErrorWithObjectMacro(this->Self,
      << name << ": the value is not a number. Give one from " << low << " to " << high << ".");
    return;
  }
  value = glm::clamp(value, low, high);
  if (member != value)
  {
    member = value;
    this->Self->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::SetLength(
  const char* name, double& member, double value, const char* meaningOfZero)
{
  if (!std::isfinite(value) || value < 0.0)
  {
    vtkErrorWithObjectMacro(this->Self,
      << name << ": " << value
      << " is no length; it must be finite and not negative (0: " << meaningOfZero << ").");
    return;
  }
  if (member != value)
  {
    member = value;
    this->Self->Modified();
  }
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeRepresentation::vtkInternals::HasView() const
{
  return this->Self->Renderer && this->Self->Renderer->GetRenderWindow();
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLatticeRepresentation::vtkInternals::FindPoint(
  const glm::dvec2& display, double* pixels)
{
  if (!this->HasView() || !this->Self->PointVisibility)
  {
    return -1;
  }
  this->Load();
  const vtkFFDProjection projection(this->Self->Renderer);
  const vtkFFDLatticeGeometry geometry(
    this->Editor.GetLattice(), this->GetMatrix(), this->Self->InteriorVisibility != 0);
  struct Candidate
  {
    double Distance;
    double Depth;
    vtkIdType Point;
  };
  std::vector<Candidate> candidates;
  double nearest = this->Self->PickTolerance;
  for (std::size_t p = 0; p < this->Editor.GetNumberOfPoints(); ++p)
  {
    glm::dvec3 at;
    if (geometry.IsShown(p) && projection.ToDisplay(geometry.GetPosition(p), at))
    {
      const double distance = glm::length(glm::dvec2(at) - display);
      if (distance <= this->Self->PickTolerance)
      {
        candidates.push_back({ distance, at.z, static_cast<vtkIdType>(p) });
        nearest = std::min(nearest, distance);
      }
    }
  }
  const Candidate* best = nullptr;
  for (const Candidate& candidate : candidates)
  {
    if (candidate.Distance <= nearest + Covering && (!best || candidate.Depth < best->Depth))
    {
      best = &candidate;
    }
  }
  if (best && pixels)
  {
    *pixels = best->Distance;
  }
  return best ? best->Point : -1;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::FindNearest(
  const glm::dvec2& display, vtkIdType& point, int& part)
{
  double toPoint = std::numeric_limits<double>::infinity();
  double toPart = std::numeric_limits<double>::infinity();
  point = this->FindPoint(display, &toPoint);
  part = vtkFFDTransformGizmo::NoPart;
  if (this->HasView())
  {
    part = this->Gizmo.FindPart(
      vtkFFDProjection(this->Self->Renderer), display, this->Self->PickTolerance, toPart);
  }
  // The handle is on top, but it must not keep a selected point from being moved again.
  const bool onBall = this->Editor.IsSelected(point) && part != vtkFFDTransformGizmo::MiddlePart &&
    toPoint <= 0.5 * this->Self->HandleSize;
  if (onBall || toPoint + 1.0 < toPart)
  {
    part = vtkFFDTransformGizmo::NoPart;
  }
  else
  {
    point = -1;
  }
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeRepresentation::vtkInternals::FindPicked(double x, double y, double world[3])
{
  this->Self->BuildRepresentation();
  vtkIdType point;
  int part;
  this->FindNearest({ x, y }, point, part);
  glm::dvec3 at;
  if (part >= 0)
  {
    this->Editor.GetSelectionCenter(at);
  }
  else if (point >= 0)
  {
    at = this->Editor.GetLattice().GetControlPoint(static_cast<std::size_t>(point));
  }
  else
  {
    return false;
  }
  at = vtkFFDTransformPoint(this->GetMatrix(), at);
  std::copy_n(&at.x, 3, world);
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeRepresentation::vtkInternals::PickDepth(
  const glm::dvec2& display, glm::dvec3& world) const
{
  // Observers of the window may take either away.
  const vtkSmartPointer<vtkRenderer> renderer(this->Self->Renderer);
  const vtkSmartPointer<vtkRenderWindow> window(renderer->GetRenderWindow());
  if (!window)
  {
    return false;
  }
  // Drawn again without us, and not shown: nothing flickers.
  const vtkTypeBool visible = this->Self->GetVisibility();
  const vtkTypeBool swap = window->GetSwapBuffers();
  this->Self->SetVisibility(0);
  window->SetSwapBuffers(0);
  window->Render();
  const double depth = renderer->GetZ(static_cast<int>(display.x), static_cast<int>(display.y));
  window->SetSwapBuffers(swap);
  this->Self->SetVisibility(visible);
  if (!(depth > 0.0 && depth < 1.0))
  {
    return false;
  }
  double point[4];
  vtkInteractorObserver::ComputeDisplayToWorld(renderer, display.x, display.y, depth, point);
  world = { point[0], point[1], point[2] };
  return true;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::StartDrag(
  const char* name, const ffd::PointSet& points, std::ptrdiff_t leader, int interactionState)
{
  if (this->Editor.Begin(name))
  {
    this->Editor.GrabPoints(points, leader);
    this->Self->InteractionState = interactionState;
    this->Ended = false;
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::RepeatDrag()
{
  if (this->Self->IsInteracting())
  {
    this->LoadOptions();
    this->Editor.UpdateWeights();
    double at[2] = { this->DragTo.x, this->DragTo.y };
    this->Self->WidgetInteraction(at);
  }
}

//------------------------------------------------------------------------------
glm::dvec3 vtkFFDLatticeRepresentation::vtkInternals::FindMotion(int constraint) const
{
  const vtkFFDDataView view = this->GetDataView();
  if (constraint == FREE)
  {
    const double depth = view.ToDisplay(this->Anchor).z;
    return view.ToData(this->DragTo, depth) - view.ToData(this->DragFrom, depth);
  }
  return ffd::FindConstrainedMove(static_cast<ffd::MoveConstraint>(constraint), this->Anchor,
    view.GetLineOfSight(this->DragFrom), view.GetLineOfSight(this->DragTo))
    .value_or(this->Motion);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::DragHandle(const glm::dvec2& before)
{
  switch (this->Self->HandleMode)
  {
    case HANDLE_TRANSLATE:
      this->Motion =
        this->FindMotion(this->Part == vtkFFDTransformGizmo::MiddlePart ? this->Self->Constraint
                                                                        : ALONG_X + this->Part);
      this->Editor.TranslateGrabbed(this->Motion);
      break;
    case HANDLE_ROTATE:
      this->RotateHandle(before);
      break;
    default:
      this->ScaleHandle();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::RotateHandle(const glm::dvec2& before)
{
  const vtkFFDDataView view = this->GetDataView();
  const glm::dvec3 forward =
    view.GetLineOfSight(glm::dvec2(view.ToDisplay(this->Anchor))).Direction;
  const glm::dvec3 axis =
    this->Part == vtkFFDTransformGizmo::MiddlePart ? -forward : ffd::GetUnitVector(this->Part);
  const std::optional<double> turn = ffd::FindDragAngle(
    axis, this->Anchor, forward, view.GetLineOfSight(before), view.GetLineOfSight(this->DragTo));
  if (turn)
  {
    this->Angle += *turn; // turn by turn, so that more than half a turn counts
  }
  else
  {
    // The ring is seen edge on: its front moves across the line of sight.
    const glm::dvec3 front = glm::normalize(glm::cross(axis, -forward));
    const double length = this->Editor.GetSmallestSpacing();
    const glm::dvec2 tangent(
      view.ToDisplay(this->Anchor + length * front) - view.ToDisplay(this->Anchor));
    const double size = glm::length(tangent);
    if (size > 0.0)
    {
      this->Angle +=
        glm::dot(this->DragTo - before, tangent) / size / this->Self->TransformHandleSize;
    }
  }
  this->Editor.RotateGrabbed(this->Angle, axis);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::ScaleHandle()
{
  glm::dvec3 factor(1.0);
  if (this->Part == vtkFFDTransformGizmo::MiddlePart)
  {
    const glm::dvec2 drag = this->DragTo - this->DragFrom;
    factor = glm::dvec3(std::exp((drag.x + drag.y) / (1.5 * this->Self->TransformHandleSize)));
  }
  else
  {
    const vtkFFDDataView view = this->GetDataView();
    factor[this->Part] = ffd::FindDragFactor(this->Part, this->Anchor,
      view.GetLineOfSight(this->DragFrom), view.GetLineOfSight(this->DragTo))
                           .value_or(1.0);
  }
  this->Editor.ScaleGrabbed(factor);
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeRepresentation::vtkInternals::HandleIsShown() const
{
  const int mode = this->Self->HandleMode;
  if (mode == HANDLE_OFF || this->Self->ManipulationMode != CONTROL_POINTS ||
    !this->Self->PointVisibility || this->Self->InteractionState == SelectingRegion)
  {
    return false;
  }
  const std::size_t count = this->Editor.GetNumberOfSelected();
  return count > 1 || (count == 1 && (mode == HANDLE_TRANSLATE || this->Self->ProportionalEditing));
}

//------------------------------------------------------------------------------
vtkFFDLatticeRepresentation::vtkInternals::ShapeKey
vtkFFDLatticeRepresentation::vtkInternals::FindShapeKey() const
{
  ShapeKey key;
  key.Lattice = this->Lattice;
  key.LatticeTime = this->Lattice->GetMTime();
  key.Matrix = this->GetMatrix();
  this->Self->GetOutlineBounds(key.OutlineBounds.data());
  key.LineMode = this->Self->LineMode;
  key.Interior = this->Self->InteriorVisibility;
  return key;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::Build()
{
  this->Sync();
  const ShapeKey shape = this->FindShapeKey();
  const vtkMTimeType lookTime = this->Self->GetMTime();
  const bool lines = !(this->BuiltShape == shape);
  if (lines || this->LookTime != lookTime)
  {
    this->Load();
    const vtkFFDLatticeGeometry geometry(
      this->Editor.GetLattice(), shape.Matrix, this->Self->InteriorVisibility != 0);
    if (lines)
    {
      this->BuildLines(geometry);
      this->BuiltShape = shape;
    }
    this->BuildGlyphs(geometry);
    this->BuildLook();
    this->LookTime = lookTime;
    this->HasViewGeometry = false;
    this->Self->BuildTime.Modified();
  }
  if (!this->HasView())
  {
    // Sizes follow as soon as there is a view.
    this->HasViewGeometry = false;
    return;
  }
  const vtkFFDProjection projection(this->Self->Renderer);
  if (!this->HasViewGeometry || !(this->BuiltView == projection))
  {
    this->Scene.ScaleGlyphs(projection);
    this->Scene.SimplifyLines(projection);
    this->BuildHandle(projection);
    if (this->Self->InteractionState == SelectingRegion)
    {
      this->Scene.SetRubberBand(
        this->DragFrom - projection.Origin, this->DragTo - projection.Origin);
    }
    this->BuiltView = projection;
    this->HasViewGeometry = true;
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::BuildLines(const vtkFFDLatticeGeometry& geometry)
{
  const vtkFFDLatticeScene::Lines lines =
    this->Self->LineMode == CURVED ? geometry.MakeCurvedLines() : geometry.MakeStraightLines();
  double bounds[6];
  this->Self->GetOutlineBounds(bounds);
  const vtkFFDLatticeScene::Lines outline = geometry.MakeOutline(this->Lattice, bounds);
  this->Scene.SetLines(lines);
  this->Scene.SetOutline(outline);
  geometry.FindBounds({ &lines, &outline }, this->Self->Bounds);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::BuildGlyphs(const vtkFFDLatticeGeometry& geometry)
{
  vtkFFDLatticeGeometry::GlyphLook look;
  look.Size = this->Self->HandleSize;
  look.Plain = ToBytes(this->Looks[PointLook]->GetColor());
  look.Selected = ToBytes(this->Looks[SelectedLook]->GetColor());
  look.Hovered = ToBytes(this->Looks[HoveredLook]->GetColor());
  look.Locked = ToBytes(this->Looks[LockedLook]->GetColor());
  std::vector<vtkFFDLatticeScene::Glyph> glyphs =
    geometry.MakeGlyphs(this->Editor, this->Hovered, look);
  for (int pin = 0; pin < this->Self->GetNumberOfPins(); ++pin)
  {
    glm::dvec3 p;
    this->Self->GetPin(pin, &p.x);
    glyphs.push_back({ vtkFFDTransformPoint(this->GetMatrix(), p), 1.2 * this->Self->HandleSize,
      ToBytes(this->Looks[PinLook]->GetColor()) });
  }
  this->Scene.SetGlyphs(glyphs);
  this->Scene.SetLabels(this->Self->LabelVisibility
      ? geometry.MakeLabels(this->Editor, this->Hovered)
      : std::vector<vtkFFDLatticeScene::Label>());
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::BuildHandle(const vtkFFDProjection& projection)
{
  const vtkFFDLatticeRepresentation* self = this->Self;
  const bool dragged = self->InteractionState == MovingHandle;
  const bool translates = self->HandleMode == HANDLE_TRANSLATE;

  vtkFFDTransformGizmo::State state;
  const bool any = this->Editor.GetSelectionCenter(state.Center);
  state.Kind = this->HandleIsShown() ? static_cast<vtkFFDTransformGizmo::Mode>(self->HandleMode)
                                     : vtkFFDTransformGizmo::Mode::Off;
  state.DataToWorld = this->GetMatrix();
  state.Size = self->TransformHandleSize;
  state.HasMiddle = this->Editor.GetNumberOfSelected() != 1 || !translates;
  state.HighlightedPart = dragged ? this->Part : this->HoveredPart;
  state.DraggedPart = dragged ? this->Part : vtkFFDTransformGizmo::NoPart;
  state.HighlightColor = ToBytes(this->Looks[HoveredLook]->GetColor());
  std::vector<vtkFFDLatticeScene::Shape> shapes;
  this->Gizmo.Build(state, projection, shapes);

  // Guides: the axes of the constraint, and how far proportional editing reaches.
  const bool moving = self->InteractionState == MovingPoints ||
    self->InteractionState == MovingMaterial || (dragged && translates);
  if (any || moving)
  {
    const int constraint = dragged && this->Part != vtkFFDTransformGizmo::MiddlePart
      ? ALONG_X + this->Part
      : self->Constraint;
    const ffd::Box domain = this->Editor.GetLattice().GetDomain();
    vtkFFDTransformGizmo::AddConstraintGuides(static_cast<ffd::MoveConstraint>(constraint),
      moving ? this->Anchor : state.Center, glm::length(domain.Max - domain.Min), state.DataToWorld,
      shapes);
  }
  if (self->ProportionalEditing && any && self->ManipulationMode == CONTROL_POINTS)
  {
    const double scale = std::cbrt(std::abs(glm::determinant(glm::dmat3(state.DataToWorld))));
    vtkFFDTransformGizmo::AddCircle(vtkFFDTransformPoint(state.DataToWorld, state.Center),
      scale * this->Editor.GetEffectiveRadius(), projection, shapes);
  }
  this->Scene.SetHandle(shapes);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::BuildLook()
{
  const vtkFFDLatticeRepresentation* self = this->Self;
  vtkFFDLatticeScene::Look look;
  look.Points = this->Looks[PointLook];
  look.Lines = this->Looks[LineLook];
  look.Outline = this->Looks[OutlineLook];
  look.Handle = this->Looks[HandleLook];
  look.Warning = self->FoldGuard == GUARD_WARN && this->Self->IsFolded()
    ? this->Looks[WarningLook].Get()
    : nullptr;
  look.HiddenOpacity = self->HiddenOpacity;
  look.ShowPoints = self->PointVisibility != 0;
  look.ShowLines = self->LineVisibility != 0;
  look.ShowOutline = self->OutlineVisibility != 0;
  look.ShowHandle = true;
  look.ShowRubberBand = self->InteractionState == SelectingRegion;
  look.ShowLabels = self->LabelVisibility != 0;
  this->Scene.SetLook(look);
}
