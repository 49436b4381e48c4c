// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDLatticeWidget
 * @brief   shape a lattice, and so the volume it deforms, by hand
 *
 * Lets the user take hold of the control points of a vtkFFDLattice, or of the volume itself, and
 * move them; a volume mapper that deforms by the lattice follows the mouse. What is shown and how
 * edits are made is up to the vtkFFDLatticeRepresentation.
 *
 * @code
 * vtkNew<vtkFFDLatticeWidget> widget;
 * widget->SetInteractor(interactor);
 * widget->GetLatticeRepresentation()->SetLattice(lattice);
 * widget->GetLatticeRepresentation()->SetProp(volume);
 * widget->On();
 * @endcode
 *
 * Mouse, where a control point or the handle is under it; else it is the camera's:
 * - left click: select; with shift: add; with control: toggle. Drag: move the selection.
 * - shift or control and drag from an empty place: rubber band, adds or toggles.
 * - wheel, during a drag or over a point or the handle, with proportional editing on: its radius.
 * - in VOLUME mode, left drag on the volume: the material follows; shift and click: pin it.
 *
 * Keys (keys that mean nothing at the moment are left to others, such as r to the camera while
 * nothing is selected):
 * - x, y, z: constrain to an axis, again: free; with shift: to the plane across it; with alt: add
 *   the rows of the selection along it, with alt and shift: the planes across it.
 * - g, r, s: handle that moves, turns, scales.
 * - a: select all; A: none; I: invert; plus, minus: grow, shrink; b: the next drag is a rubber
 *   band.
 * - arrows: nudge; with shift: ten times as far; with control: a tenth.
 * - o: proportional editing; O: its falloff. m: symmetry across x, y, z, none. l: lock the
 *   boundary. v: fold guard clamps, warns, is off.
 * - d: volume or control points (direct manipulation); P: no pins.
 * - Delete: reset the selection; with shift: the point under the mouse; with control: all.
 * - control + z: undo; control + y, control + shift + z: redo; Escape: cancel the drag.
 *
 * All of it goes through the vtkWidgetEventTranslator (GetEventTranslator()), by the
 * WidgetEventIds below, so that an application can give other keys:
 * @code
 * widget->GetEventTranslator()->SetTranslation(vtkCommand::KeyPressEvent, vtkEvent::NoModifier,
 *   0, 0, "u", vtkFFDLatticeWidget::UndoEdit);
 * @endcode
 * and Perform() does what a key does.
 *
 * Events: vtkCommand::StartInteractionEvent, InteractionEvent (at each step) and
 * EndInteractionEvent of drags and of edits by key; vtkCommand::WidgetValueChangedEvent once per
 * edit, also those made by script on the representation, with its name as call data (const char*;
 * in Python: CallDataType "string0"), and vtkCommand::SelectionChangedEvent. During a drag the
 * window has the interactor's DesiredUpdateRate, so that volume mappers may use fewer samples; at
 * its end it has the still one, and is drawn again.
 *
 * After each edit the clipping range of the camera is looked after: it stays as it is, bit for bit,
 * while it holds all visible props (vtkRenderer::ComputeVisiblePropBounds()) and is no wider than
 * twice what vtkRenderer::ResetCameraClippingRange() would give. While it does, the mapper casts
 * only those parts of the picture anew that see the edit (FrameCoherence); another range makes the
 * whole picture. When the range must change it is reset with room for the next steps, a quarter of
 * the depth of the scene at least before and behind it, as far as the renderer's
 * NearClippingPlaneTolerance allows.
 *
 * @sa vtkFFDLatticeRepresentation vtkFFDLattice
 */
#ifndef vtkFFDLatticeWidget_h
#define vtkFFDLatticeWidget_h

#include "vtkAbstractWidget.h"
#include "vtkFFDWidgetsModule.h" // For export macro

#include <initializer_list> // for std::initializer_list
#include <string>           // for std::string

class vtkCallbackCommand;
class vtkFFDLatticeRepresentation;

class VTKFFDWIDGETS_EXPORT vtkFFDLatticeWidget : public vtkAbstractWidget
{
public:
  static vtkFFDLatticeWidget* New();
  vtkTypeMacro(vtkFFDLatticeWidget, vtkAbstractWidget);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The representation. Default: made when asked for. Null: the default is made again.
   */
  void SetRepresentation(vtkFFDLatticeRepresentation* representation);
  vtkFFDLatticeRepresentation* GetLatticeRepresentation();
  void CreateDefaultRepresentation() override;
  ///@}

  /// Besides vtkWidgetEvent::Select, EndSelect and Move.
  enum WidgetEventIds
  {
    AddSelect = 7000,
    ToggleSelect,
    SelectEverything,
    SelectNothing,
    InvertSelection,
    GrowSelection,
    ShrinkSelection,
    RowsX,
    RowsY,
    RowsZ,
    PlanesX,
    PlanesY,
    PlanesZ,
    ArmRegion,
    ConstrainX,
    ConstrainY,
    ConstrainZ,
    ConstrainAcrossX,
    ConstrainAcrossY,
    ConstrainAcrossZ,
    HandleTranslate,
    HandleRotate,
    HandleScale,
    NudgeLeft,
    NudgeRight,
    NudgeDown,
    NudgeUp,
    NudgeFarLeft,
    NudgeFarRight,
    NudgeFarDown,
    NudgeFarUp,
    NudgeFineLeft,
    NudgeFineRight,
    NudgeFineDown,
    NudgeFineUp,
    ToggleProportional,
    NextFalloff,
    IncreaseRadius,
    DecreaseRadius,
    NextSymmetry,
    ToggleLock,
    NextFoldGuard,
    ToggleManipulation,
    RemovePins,
    ResetSelection,
    ResetHovered,
    ResetAll,
    UndoEdit,
    RedoEdit,
    CancelDrag,
    ConsumeCharacter, ///< keeps a key that was used from the interactor style
    LeaveWindow,
    OtherButton
  };

  /**
   * Do what a widget event of these does, SelectEverything to CancelDrag. Returns 1, or 0 if it
   * means nothing at the moment (nothing selected, nothing to undo, ...).
   */
  int Perform(int widgetEvent);

  /// Whether a drag is going on.
  int IsInteracting();

  void SetEnabled(int enabling) override;

  /// Overridden so that one that is deleted is let go of, whoever has the focus.
  void SetInteractor(vtkRenderWindowInteractor* interactor) override;

protected:
  vtkFFDLatticeWidget();
  ~vtkFFDLatticeWidget() override;

  static void SelectAction(vtkAbstractWidget* widget);
  static void AddSelectAction(vtkAbstractWidget* widget);
  static void ToggleSelectAction(vtkAbstractWidget* widget);
  static void EndSelectAction(vtkAbstractWidget* widget);
  static void MoveAction(vtkAbstractWidget* widget);
  static void LeaveAction(vtkAbstractWidget* widget);
  static void OtherButtonAction(vtkAbstractWidget* widget);
  static void CharacterAction(vtkAbstractWidget* widget);
  template <int WidgetEvent>
  static void KeyAction(vtkAbstractWidget* widget);

  void SetCursor(int state) override;

private:
  vtkFFDLatticeWidget(const vtkFFDLatticeWidget&) = delete;
  void operator=(const vtkFFDLatticeWidget&) = delete;

  template <int WidgetEvent>
  void BindKeys(int modifier, std::initializer_list<const char*> symbols);
  void BindAllKeys();
  void Press(int operation);
  void AdjustClippingRange();
  /// Whether there is an interactor with a window: observers may take either away, and an
  /// interactor that is being deleted has no window.
  bool HasWindow() const;
  void BeginDrag();
  void EndDrag();
  void Attach(vtkFFDLatticeRepresentation* representation);
  int Edit(int changed);
  int Nudge(double right, double up);
  int ToggleConstraint(int constraint);
  static void ForwardEvent(vtkObject* caller, unsigned long event, void* client, void* data);

  vtkCallbackCommand* Forwarder;
  vtkCallbackCommand* InteractorWatch;
  bool Dragging = false;
  bool Moved = false;
  bool RegionArmed = false;
  bool ConstraintOfDrag = false;
  vtkIdType Pressed = -1;
  std::string UsedKey;
};

#endif
