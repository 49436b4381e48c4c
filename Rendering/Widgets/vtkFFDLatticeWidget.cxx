// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLatticeWidget.h"

#include "vtkFFDLattice.h"
#include "vtkFFDLatticeRepresentation.h"

#include "vtkCallbackCommand.h"
#include "vtkCamera.h"
#include "vtkCommand.h"
#include "vtkEvent.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkObjectFactory.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkSmartPointer.h"
#include "vtkWidgetCallbackMapper.h"
#include "vtkWidgetEvent.h"
#include "vtkWidgetEventTranslator.h"

#include <algorithm>
#include <cmath>

vtkStandardNewMacro(vtkFFDLatticeWidget);

namespace
{

using Rep = vtkFFDLatticeRepresentation;

/// Factor of a step of the wheel for the radius of proportional editing.
constexpr double WheelFactor = 1.1;

constexpr double FarNudge = 10.0;
constexpr double FineNudge = 0.1;

/// Clipping planes stay where they are until they are this many times as far apart as need be.
constexpr double WidestRange = 2.0;
/// Part of the depth of the scene that is left in front of it and behind it when they move.
constexpr double RangeRoom = 0.25;
/// As vtkRenderer::ResetCameraClippingRange(): breathing room at the planes.
constexpr double PlaneMargin = 0.01;

/// Computes the distances from the camera at which a box begins and ends.
void GetDepths(vtkCamera* camera, const double bounds[6], double& nearest, double& farthest)
{
  const vtkMatrix4x4* view = camera->GetModelViewTransformMatrix();
  nearest = farthest = -view->GetElement(2, 3);
  for (int a = 0; a < 3; ++a)
  {
    const double z = -view->GetElement(2, a);
    nearest += std::min(z * bounds[2 * a], z * bounds[2 * a + 1]);
    farthest += std::max(z * bounds[2 * a], z * bounds[2 * a + 1]);
  }
  nearest = std::max(nearest, 0.0);
}

/// Observers of what a widget does may remove it and let go of the last reference to it: it stays
/// until it is done.
vtkSmartPointer<vtkFFDLatticeWidget> Keep(vtkAbstractWidget* widget)
{
  return static_cast<vtkFFDLatticeWidget*>(widget);
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDLatticeWidget::vtkFFDLatticeWidget()
  : Forwarder(vtkCallbackCommand::New())
  , InteractorWatch(vtkCallbackCommand::New())
{
  this->Forwarder->SetClientData(this);
  this->Forwarder->SetCallback(vtkFFDLatticeWidget::ForwardEvent);
  // vtkInteractorObserver lets go of an interactor that is deleted, but does not hear of it while
  // the interactor style or another widget has grabbed the focus. Passive observers are told first.
  this->InteractorWatch->SetPassiveObserver(1);
  this->InteractorWatch->SetClientData(this);
  this->InteractorWatch->SetCallback([](vtkObject*, unsigned long, void* client, void*) {
    static_cast<vtkFFDLatticeWidget*>(client)->ReleaseFocus();
  });
  // The first translation that fits counts, so those with modifiers come first.
  vtkWidgetCallbackMapper* mapper = this->CallbackMapper;
  mapper->SetCallbackMethod(vtkCommand::LeftButtonPressEvent, vtkEvent::ShiftModifier, 0, 0,
    nullptr, AddSelect, this, vtkFFDLatticeWidget::AddSelectAction);
  mapper->SetCallbackMethod(vtkCommand::LeftButtonPressEvent, vtkEvent::ControlModifier, 0, 0,
    nullptr, ToggleSelect, this, vtkFFDLatticeWidget::ToggleSelectAction);
  mapper->SetCallbackMethod(vtkCommand::LeftButtonPressEvent, vtkWidgetEvent::Select, this,
    vtkFFDLatticeWidget::SelectAction);
  mapper->SetCallbackMethod(vtkCommand::LeftButtonReleaseEvent, vtkWidgetEvent::EndSelect, this,
    vtkFFDLatticeWidget::EndSelectAction);
  mapper->SetCallbackMethod(
    vtkCommand::MouseMoveEvent, vtkWidgetEvent::Move, this, vtkFFDLatticeWidget::MoveAction);
  mapper->SetCallbackMethod(
    vtkCommand::LeaveEvent, LeaveWindow, this, vtkFFDLatticeWidget::LeaveAction);
  for (const unsigned long event :
    { vtkCommand::RightButtonPressEvent, vtkCommand::RightButtonReleaseEvent,
      vtkCommand::MiddleButtonPressEvent, vtkCommand::MiddleButtonReleaseEvent })
  {
    mapper->SetCallbackMethod(event, OtherButton, this, vtkFFDLatticeWidget::OtherButtonAction);
  }
  mapper->SetCallbackMethod(vtkCommand::MouseWheelForwardEvent, IncreaseRadius, this,
    vtkFFDLatticeWidget::KeyAction<IncreaseRadius>);
  mapper->SetCallbackMethod(vtkCommand::MouseWheelBackwardEvent, DecreaseRadius, this,
    vtkFFDLatticeWidget::KeyAction<DecreaseRadius>);
  mapper->SetCallbackMethod(
    vtkCommand::CharEvent, ConsumeCharacter, this, vtkFFDLatticeWidget::CharacterAction);
  this->BindAllKeys();
}

//------------------------------------------------------------------------------
vtkFFDLatticeWidget::~vtkFFDLatticeWidget()
{
  if (this->WidgetRep)
  {
    this->WidgetRep->RemoveObserver(this->Forwarder);
  }
  if (this->Interactor)
  {
    this->Interactor->RemoveObserver(this->InteractorWatch);
  }
  if (this->Dragging)
  {
    // The representation and the window go on without it.
    this->GetLatticeRepresentation()->CancelInteraction();
    if (this->HasWindow())
    {
      this->ReleaseFocus();
      this->EndInteraction();
    }
  }
  this->Forwarder->Delete();
  this->InteractorWatch->Delete();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::SetInteractor(vtkRenderWindowInteractor* interactor)
{
  if (interactor == this->Interactor)
  {
    return;
  }
  // Observers of what that ends may set another one meanwhile.
  this->SetEnabled(0);
  if (this->Interactor)
  {
    this->Interactor->RemoveObserver(this->InteractorWatch);
  }
  this->Superclass::SetInteractor(interactor);
  if (this->Interactor)
  {
    this->Interactor->AddObserver(vtkCommand::DeleteEvent, this->InteractorWatch);
  }
}

//------------------------------------------------------------------------------
template <int WidgetEvent>
void vtkFFDLatticeWidget::BindKeys(int modifier, std::initializer_list<const char*> symbols)
{
  for (const char* symbol : symbols)
  {
    this->CallbackMapper->SetCallbackMethod(vtkCommand::KeyPressEvent, modifier, 0, 0, symbol,
      WidgetEvent, this, vtkFFDLatticeWidget::KeyAction<WidgetEvent>);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::BindAllKeys()
{
  const int none = vtkEvent::NoModifier;
  const int shift = vtkEvent::ShiftModifier;
  const int control = vtkEvent::ControlModifier;
  const int alt = vtkEvent::AltModifier;
  const int any = vtkEvent::AnyModifier;
  // With shift, toolkits differ in whether they name the small or the capital letter.
  this->BindKeys<UndoEdit>(control, { "z" });
  this->BindKeys<RedoEdit>(control, { "y" });
  this->BindKeys<RedoEdit>(control | shift, { "z", "Z" });
  this->BindKeys<RowsX>(alt, { "x" });
  this->BindKeys<RowsY>(alt, { "y" });
  this->BindKeys<RowsZ>(alt, { "z" });
  this->BindKeys<PlanesX>(alt | shift, { "x", "X" });
  this->BindKeys<PlanesY>(alt | shift, { "y", "Y" });
  this->BindKeys<PlanesZ>(alt | shift, { "z", "Z" });
  this->BindKeys<ConstrainX>(none, { "x" });
  this->BindKeys<ConstrainY>(none, { "y" });
  this->BindKeys<ConstrainZ>(none, { "z" });
  this->BindKeys<ConstrainAcrossX>(shift, { "x", "X" });
  this->BindKeys<ConstrainAcrossY>(shift, { "y", "Y" });
  this->BindKeys<ConstrainAcrossZ>(shift, { "z", "Z" });
  this->BindKeys<HandleTranslate>(none, { "g" });
  this->BindKeys<HandleRotate>(none, { "r" });
  this->BindKeys<HandleScale>(none, { "s" });
  this->BindKeys<SelectEverything>(none, { "a" });
  this->BindKeys<SelectNothing>(shift, { "a", "A" });
  this->BindKeys<InvertSelection>(shift, { "i", "I" });
  this->BindKeys<GrowSelection>(any, { "plus", "equal", "KP_Add" });
  this->BindKeys<ShrinkSelection>(any, { "minus", "underscore", "KP_Subtract" });
  this->BindKeys<ArmRegion>(none, { "b" });
  this->BindKeys<NudgeLeft>(none, { "Left" });
  this->BindKeys<NudgeRight>(none, { "Right" });
  this->BindKeys<NudgeDown>(none, { "Down" });
  this->BindKeys<NudgeUp>(none, { "Up" });
  this->BindKeys<NudgeFarLeft>(shift, { "Left" });
  this->BindKeys<NudgeFarRight>(shift, { "Right" });
  this->BindKeys<NudgeFarDown>(shift, { "Down" });
  this->BindKeys<NudgeFarUp>(shift, { "Up" });
  this->BindKeys<NudgeFineLeft>(control, { "Left" });
  this->BindKeys<NudgeFineRight>(control, { "Right" });
  this->BindKeys<NudgeFineDown>(control, { "Down" });
  this->BindKeys<NudgeFineUp>(control, { "Up" });
  this->BindKeys<ToggleProportional>(none, { "o" });
  this->BindKeys<NextFalloff>(shift, { "o", "O" });
  this->BindKeys<NextSymmetry>(none, { "m" });
  this->BindKeys<ToggleLock>(none, { "l" });
  this->BindKeys<NextFoldGuard>(none, { "v" });
  this->BindKeys<ToggleManipulation>(none, { "d" });
  this->BindKeys<RemovePins>(shift, { "p", "P" });
  this->BindKeys<ResetHovered>(shift, { "Delete" });
  this->BindKeys<ResetAll>(control, { "Delete" });
  this->BindKeys<ResetSelection>(none, { "Delete" });
  this->BindKeys<CancelDrag>(any, { "Escape" });
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Dragging: " << this->Dragging << "\n";
  os << indent << "RegionArmed: " << this->RegionArmed << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::Attach(vtkFFDLatticeRepresentation* representation)
{
  representation->AddObserver(vtkCommand::WidgetValueChangedEvent, this->Forwarder);
  representation->AddObserver(vtkCommand::SelectionChangedEvent, this->Forwarder);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::SetRepresentation(vtkFFDLatticeRepresentation* representation)
{
  if (representation == this->WidgetRep)
  {
    return;
  }
  if (this->WidgetRep)
  {
    this->EndDrag();
    this->WidgetRep->RemoveObserver(this->Forwarder);
  }
  if (representation)
  {
    this->Attach(representation);
  }
  this->SetWidgetRepresentation(representation);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::CreateDefaultRepresentation()
{
  if (!this->WidgetRep)
  {
    auto* representation = vtkFFDLatticeRepresentation::New();
    this->Attach(representation);
    this->WidgetRep = representation;
  }
}

//------------------------------------------------------------------------------
vtkFFDLatticeRepresentation* vtkFFDLatticeWidget::GetLatticeRepresentation()
{
  this->CreateDefaultRepresentation();
  return static_cast<vtkFFDLatticeRepresentation*>(this->WidgetRep);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::ForwardEvent(vtkObject*, unsigned long event, void* client, void* data)
{
  Keep(static_cast<vtkFFDLatticeWidget*>(client))->InvokeEvent(event, data);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::SetEnabled(int enabling)
{
  const bool wasEnabled = this->Enabled != 0;
  this->Superclass::SetEnabled(enabling);
  if (!wasEnabled || this->Enabled)
  {
    return;
  }
  // Whoever follows changes of the representation is to see a widget that is off, not one to turn
  // off: ParaView's representation of widgets does, and its view is gone then. Others take away
  // what the widget works with.
  if (this->Dragging)
  {
    this->Perform(CancelDrag);
    if (this->HasWindow())
    {
      this->Render();
    }
  }
  this->RegionArmed = false;
  this->GetLatticeRepresentation()->Highlight(0);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::SetCursor(int state)
{
  if (this->ManagesCursor && this->HasWindow())
  {
    this->RequestCursorShape(
      state == Rep::OnPoint || state == Rep::OnHandle ? VTK_CURSOR_HAND : VTK_CURSOR_DEFAULT);
  }
}

//------------------------------------------------------------------------------
int vtkFFDLatticeWidget::IsInteracting() { return this->Dragging ? 1 : 0; }

//------------------------------------------------------------------------------
bool vtkFFDLatticeWidget::HasWindow() const
{
  return this->Interactor && this->Interactor->GetRenderWindow();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::BeginDrag()
{
  if (!this->Enabled || !this->HasWindow())
  {
    this->GetLatticeRepresentation()->CancelInteraction();
    return;
  }
  this->Dragging = true;
  this->Moved = false;
  this->ConstraintOfDrag = false;
  this->EventCallbackCommand->SetAbortFlag(1);
  this->GrabFocus(this->EventCallbackCommand);
  this->StartInteraction();
  this->InvokeEvent(vtkCommand::StartInteractionEvent, nullptr);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::EndDrag()
{
  if (!this->Dragging)
  {
    return;
  }
  this->Dragging = false;
  this->ReleaseFocus();
  if (this->ConstraintOfDrag)
  {
    this->GetLatticeRepresentation()->SetConstraint(Rep::FREE);
    this->ConstraintOfDrag = false;
  }
  // The still update rate again, so that the frame that follows has full quality.
  if (this->HasWindow())
  {
    this->EndInteraction();
  }
  this->InvokeEvent(vtkCommand::EndInteractionEvent, nullptr);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::AdjustClippingRange()
{
  vtkRenderer* renderer = this->CurrentRenderer;
  if (!renderer)
  {
    return;
  }
  vtkCamera* camera = renderer->GetActiveCamera();
  const double tolerance = renderer->GetNearClippingPlaneTolerance();
  double bounds[6];
  renderer->ComputeVisiblePropBounds(bounds);
  // The tolerance is found by the first reset.
  if (!vtkMath::AreBoundsInitialized(bounds) || camera->GetUseOffAxisProjection() ||
    !(tolerance > 0.0))
  {
    renderer->ResetCameraClippingRange();
    return;
  }
  double nearest;
  double farthest;
  GetDepths(camera, bounds, nearest, farthest);
  // A flat scene is given some depth, as a reset does.
  const double gap = camera->GetParallelProjection()
    ? 0.1 * camera->GetParallelScale()
    : 0.2 * std::tan(0.5 * vtkMath::RadiansFromDegrees(camera->GetViewAngle())) * farthest;
  const double depth = std::max(farthest - nearest, gap);
  const double wanted[2] = { (1.0 - PlaneMargin) * nearest, (1.0 + PlaneMargin) * farthest };
  const double expansion = renderer->GetClippingRangeExpansion() * depth;
  const double needed =
    wanted[1] + expansion - std::max(wanted[0] - expansion, tolerance * (wanted[1] + expansion));
  double range[2];
  camera->GetClippingRange(range);
  // The near plane of the camera need be no nearer than it may be, for props that hold the camera.
  constexpr double rounding = 1e-9;
  const double least = tolerance * range[1];
  const bool holds =
    range[0] <= std::max(wanted[0], (1.0 + rounding) * least) && range[1] >= wanted[1];
  const bool precise = range[0] >= (1.0 - rounding) * least;
  if (holds && precise && range[1] - range[0] <= WidestRange * needed)
  {
    return;
  }
  renderer->ResetCameraClippingRange();
  camera->GetClippingRange(range);
  const double farPlane = std::max(range[1], wanted[1] + RangeRoom * depth);
  const double nearPlane =
    std::max(std::min(range[0], wanted[0] - RangeRoom * depth), tolerance * farPlane);
  if (nearPlane != range[0] || farPlane != range[1])
  {
    camera->SetClippingRange(nearPlane, farPlane);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::Press(int operation)
{
  const vtkSmartPointer<Rep> rep(this->GetLatticeRepresentation());
  const int x = this->Interactor->GetEventPosition()[0];
  const int y = this->Interactor->GetEventPosition()[1];
  if (this->Dragging || !this->CurrentRenderer || !this->CurrentRenderer->IsInViewport(x, y))
  {
    return;
  }
  double position[2] = { static_cast<double>(x), static_cast<double>(y) };
  const int state = rep->ComputeInteractionState(x, y);
  this->Pressed = -1;
  if (this->RegionArmed)
  {
    this->RegionArmed = false;
    rep->StartRegion(position, operation);
  }
  else if (rep->GetManipulationMode() == Rep::VOLUME)
  {
    if (operation == Rep::ADD)
    {
      double p[3];
      if (rep->PickSurface(x, y, p))
      {
        this->EventCallbackCommand->SetAbortFlag(1);
        rep->AddPinAtWorld(p);
        this->Render();
      }
      return;
    }
    rep->StartWidgetInteraction(position);
  }
  else if (state == Rep::OnPoint)
  {
    const vtkIdType point = rep->GetHoveredPoint();
    if (operation == Rep::TOGGLE)
    {
      this->EventCallbackCommand->SetAbortFlag(1);
      rep->SelectPoint(point, Rep::TOGGLE);
      this->Render();
      return;
    }
    if (operation == Rep::REPLACE && rep->IsPointSelected(point))
    {
      // Perhaps a drag of the whole selection; if not, the release selects the point alone.
      this->Pressed = point;
    }
    else
    {
      rep->SelectPoint(point, operation);
    }
    rep->StartWidgetInteraction(position);
  }
  else if (state == Rep::OnHandle)
  {
    rep->StartWidgetInteraction(position);
  }
  else if (operation != Rep::REPLACE)
  {
    rep->StartRegion(position, operation);
  }
  if (rep->IsInteracting())
  {
    this->BeginDrag();
    this->Render();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::SelectAction(vtkAbstractWidget* widget)
{
  Keep(widget)->Press(Rep::REPLACE);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::AddSelectAction(vtkAbstractWidget* widget)
{
  Keep(widget)->Press(Rep::ADD);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::ToggleSelectAction(vtkAbstractWidget* widget)
{
  Keep(widget)->Press(Rep::TOGGLE);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::MoveAction(vtkAbstractWidget* widget)
{
  const vtkSmartPointer<vtkFFDLatticeWidget> self(Keep(widget));
  const vtkSmartPointer<Rep> rep(self->GetLatticeRepresentation());
  const int x = self->Interactor->GetEventPosition()[0];
  const int y = self->Interactor->GetEventPosition()[1];
  if (!self->Dragging)
  {
    if (!self->CurrentRenderer)
    {
      return;
    }
    const vtkMTimeType before = rep->GetMTime();
    if (self->CurrentRenderer->IsInViewport(x, y))
    {
      self->SetCursor(rep->ComputeInteractionState(x, y));
    }
    else
    {
      rep->Highlight(0);
      self->SetCursor(Rep::Outside);
    }
    if (rep->GetMTime() != before)
    {
      self->Render();
    }
    return;
  }
  self->Moved = true;
  double position[2] = { static_cast<double>(x), static_cast<double>(y) };
  rep->WidgetInteraction(position);
  self->EventCallbackCommand->SetAbortFlag(1);
  self->InvokeEvent(vtkCommand::InteractionEvent, nullptr);
  if (rep->GetInteractionState() != Rep::SelectingRegion)
  {
    self->AdjustClippingRange();
  }
  self->Render();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::EndSelectAction(vtkAbstractWidget* widget)
{
  const vtkSmartPointer<vtkFFDLatticeWidget> self(Keep(widget));
  if (!self->Dragging)
  {
    return;
  }
  const vtkSmartPointer<Rep> rep(self->GetLatticeRepresentation());
  const int x = self->Interactor->GetEventPosition()[0];
  const int y = self->Interactor->GetEventPosition()[1];
  if (!self->Moved && rep->GetInteractionState() != Rep::SelectingRegion)
  {
    // A click is no edit, whatever the hand trembled between two events.
    rep->CancelInteraction();
    if (self->Pressed >= 0)
    {
      rep->SelectPoint(self->Pressed, Rep::REPLACE);
    }
  }
  else
  {
    double position[2] = { static_cast<double>(x), static_cast<double>(y) };
    rep->EndWidgetInteraction(position);
  }
  self->EventCallbackCommand->SetAbortFlag(1);
  self->EndDrag();
  self->SetCursor(rep->ComputeInteractionState(x, y));
  self->AdjustClippingRange();
  self->Render();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::LeaveAction(vtkAbstractWidget* widget)
{
  const vtkSmartPointer<vtkFFDLatticeWidget> self(Keep(widget));
  Rep* rep = self->GetLatticeRepresentation();
  const vtkMTimeType before = rep->GetMTime();
  if (!self->Dragging)
  {
    rep->Highlight(0);
  }
  if (rep->GetMTime() != before)
  {
    self->Render();
  }
}

//------------------------------------------------------------------------------
/// In the middle of a drag other buttons do nothing: the interactor style would take the focus, and
/// with it the event that ends the drag.
void vtkFFDLatticeWidget::OtherButtonAction(vtkAbstractWidget* widget)
{
  const vtkSmartPointer<vtkFFDLatticeWidget> self(Keep(widget));
  if (self->Dragging)
  {
    self->EventCallbackCommand->SetAbortFlag(1);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeWidget::CharacterAction(vtkAbstractWidget* widget)
{
  const vtkSmartPointer<vtkFFDLatticeWidget> self(Keep(widget));
  const char* symbol = self->Interactor->GetKeySym();
  if (symbol && self->UsedKey == symbol)
  {
    self->EventCallbackCommand->SetAbortFlag(1);
  }
  self->UsedKey.clear();
}

//------------------------------------------------------------------------------
template <int WidgetEvent>
void vtkFFDLatticeWidget::KeyAction(vtkAbstractWidget* widget)
{
  const vtkSmartPointer<vtkFFDLatticeWidget> self(Keep(widget));
  constexpr bool wheel = WidgetEvent == IncreaseRadius || WidgetEvent == DecreaseRadius;
  if (wheel && !self->Dragging &&
    self->GetLatticeRepresentation()->GetInteractionState() != Rep::OnPoint &&
    self->GetLatticeRepresentation()->GetInteractionState() != Rep::OnHandle)
  {
    return; // the camera's
  }
  self->UsedKey.clear();
  const char* symbol = self->Interactor->GetKeySym();
  const std::string key = !wheel && symbol ? symbol : "";
  if (self->Perform(WidgetEvent))
  {
    self->UsedKey = key;
    self->EventCallbackCommand->SetAbortFlag(1);
  }
}

//------------------------------------------------------------------------------
int vtkFFDLatticeWidget::Edit(int changed)
{
  if (changed)
  {
    this->InvokeEvent(vtkCommand::StartInteractionEvent, nullptr);
    this->InvokeEvent(vtkCommand::InteractionEvent, nullptr);
    this->InvokeEvent(vtkCommand::EndInteractionEvent, nullptr);
  }
  return changed;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeWidget::Nudge(double right, double up)
{
  Rep* rep = this->GetLatticeRepresentation();
  return rep->GetNumberOfSelectedPoints() > 0 && !this->Dragging && this->CurrentRenderer
    ? this->Edit(rep->NudgeSelection(right, up))
    : 0;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeWidget::ToggleConstraint(int constraint)
{
  Rep* rep = this->GetLatticeRepresentation();
  const bool off = rep->GetConstraint() == constraint;
  rep->SetConstraint(off ? Rep::FREE : constraint);
  this->ConstraintOfDrag = this->Dragging && !off;
  if (this->Dragging)
  {
    this->InvokeEvent(vtkCommand::InteractionEvent, nullptr);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeWidget::Perform(int widgetEvent)
{
  const vtkSmartPointer<Rep> rep(this->GetLatticeRepresentation());
  const bool selected = rep->GetNumberOfSelectedPoints() > 0;
  const vtkMTimeType before = rep->GetLattice()->GetMTime();
  // In the middle of a drag only what shapes or ends it.
  const bool shapesDrag = (widgetEvent >= ConstrainX && widgetEvent <= ConstrainAcrossZ) ||
    (widgetEvent >= ToggleProportional && widgetEvent <= DecreaseRadius) ||
    widgetEvent == CancelDrag;
  if (this->Dragging && !shapesDrag)
  {
    return 0;
  }
  int done = 1;
  switch (widgetEvent)
  {
    case SelectEverything:
      rep->SelectAll();
      break;
    case SelectNothing:
      rep->ClearSelection();
      break;
    case InvertSelection:
      rep->InvertSelection();
      break;
    case GrowSelection:
      rep->GrowSelection();
      done = selected;
      break;
    case ShrinkSelection:
      rep->ShrinkSelection();
      done = selected;
      break;
    case RowsX:
    case RowsY:
    case RowsZ:
      done = selected ? rep->SelectRows(widgetEvent - RowsX) : 0;
      break;
    case PlanesX:
    case PlanesY:
    case PlanesZ:
      done = selected ? rep->SelectPlanes(widgetEvent - PlanesX) : 0;
      break;
    case ArmRegion:
      this->RegionArmed = true;
      break;
    case ConstrainX:
    case ConstrainY:
    case ConstrainZ:
      done = this->ToggleConstraint(Rep::ALONG_X + widgetEvent - ConstrainX);
      break;
    case ConstrainAcrossX:
    case ConstrainAcrossY:
    case ConstrainAcrossZ:
      done = this->ToggleConstraint(Rep::ACROSS_X + widgetEvent - ConstrainAcrossX);
      break;
    case HandleTranslate:
    case HandleRotate:
    case HandleScale:
      if (selected)
      {
        rep->SetHandleMode(Rep::HANDLE_TRANSLATE + widgetEvent - HandleTranslate);
      }
      done = selected;
      break;
    case NudgeLeft:
      done = this->Nudge(-1.0, 0.0);
      break;
    case NudgeRight:
      done = this->Nudge(1.0, 0.0);
      break;
    case NudgeDown:
      done = this->Nudge(0.0, -1.0);
      break;
    case NudgeUp:
      done = this->Nudge(0.0, 1.0);
      break;
    case NudgeFarLeft:
      done = this->Nudge(-FarNudge, 0.0);
      break;
    case NudgeFarRight:
      done = this->Nudge(FarNudge, 0.0);
      break;
    case NudgeFarDown:
      done = this->Nudge(0.0, -FarNudge);
      break;
    case NudgeFarUp:
      done = this->Nudge(0.0, FarNudge);
      break;
    case NudgeFineLeft:
      done = this->Nudge(-FineNudge, 0.0);
      break;
    case NudgeFineRight:
      done = this->Nudge(FineNudge, 0.0);
      break;
    case NudgeFineDown:
      done = this->Nudge(0.0, -FineNudge);
      break;
    case NudgeFineUp:
      done = this->Nudge(0.0, FineNudge);
      break;
    case ToggleProportional:
      rep->SetProportionalEditing(!rep->GetProportionalEditing());
      break;
    case NextFalloff:
      rep->SetFalloff((rep->GetFalloff() + 1) % (Rep::CONSTANT + 1));
      break;
    case IncreaseRadius:
    case DecreaseRadius:
      done = rep->GetProportionalEditing() ? 1 : 0;
      if (done)
      {
        rep->SetProportionalRadius(rep->GetEffectiveRadius() *
          (widgetEvent == IncreaseRadius ? WheelFactor : 1.0 / WheelFactor));
        if (this->Dragging)
        {
          this->InvokeEvent(vtkCommand::InteractionEvent, nullptr);
        }
      }
      break;
    case NextSymmetry:
    {
      const vtkTypeBool* now = rep->GetSymmetry();
      const int next = now[0] ? 1 : now[1] ? 2 : now[2] ? 3 : 0;
      rep->SetSymmetry(next == 0, next == 1, next == 2);
      break;
    }
    case ToggleLock:
      rep->SetLockBoundary(!rep->GetLockBoundary());
      break;
    case NextFoldGuard:
      rep->SetFoldGuard((rep->GetFoldGuard() + 1) % (Rep::GUARD_WARN + 1));
      break;
    case ToggleManipulation:
      rep->SetManipulationMode(
        rep->GetManipulationMode() == Rep::VOLUME ? Rep::CONTROL_POINTS : Rep::VOLUME);
      break;
    case RemovePins:
      done = rep->GetNumberOfPins() > 0 ? 1 : 0;
      rep->ClearPins();
      break;
    case ResetSelection:
      done = selected ? this->Edit(rep->ResetSelection()) : 0;
      break;
    case ResetHovered:
    {
      const vtkIdType point = rep->GetHoveredPoint();
      int n[3];
      rep->GetLattice()->GetDimensions(n);
      done = point >= 0 ? this->Edit(rep->ResetPoint(static_cast<int>(point % n[0]),
                            static_cast<int>(point / n[0] % n[1]),
                            static_cast<int>(point / (static_cast<vtkIdType>(n[0]) * n[1]))))
                        : 0;
      break;
    }
    case ResetAll:
      done = this->Edit(rep->ResetAll());
      break;
    case UndoEdit:
      done = this->Edit(rep->Undo());
      break;
    case RedoEdit:
      done = this->Edit(rep->Redo());
      break;
    case CancelDrag:
      done = this->Dragging || this->RegionArmed;
      this->RegionArmed = false;
      rep->CancelInteraction();
      this->EndDrag();
      break;
    default:
      vtkErrorMacro("Perform: " << widgetEvent << " is none of SelectEverything ("
                                << SelectEverything << ") to CancelDrag (" << CancelDrag << ").");
      return 0;
  }
  if (done && this->Enabled && this->Interactor)
  {
    if (rep->GetLattice()->GetMTime() != before)
    {
      this->AdjustClippingRange();
    }
    this->Render();
  }
  return done;
}
