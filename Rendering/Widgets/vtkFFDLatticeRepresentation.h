// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDLatticeRepresentation
 * @brief   shows a lattice in the scene, and edits it: the representation of vtkFFDLatticeWidget
 *
 * Draws the control points of a vtkFFDLattice as balls of constant size on screen, the
 * lines between them, and the outline of the volume as it is deformed. What lies behind or within
 * something is seen through it, dimmed by HiddenOpacity.
 *
 * It also holds the selection and makes the edits, so that a script can do all that the mouse can:
 *
 * @code{.py}
 * rep.SelectPoint(3, 3, 3)
 * rep.GrowSelection()
 * rep.TranslateSelection(10, 0, 0)
 * rep.MoveMaterial((20, 30, 40), (25, 30, 40))   # grab the volume itself
 * rep.Undo()
 * @endcode
 *
 * Every edit obeys the options below: proportional editing, symmetry, the lock of the boundary and
 * the fold guard. Edits invoke vtkCommand::WidgetValueChangedEvent, whose call data is the name of
 * the edit (const char*): "Translate", "Rotate", "Scale", "Material", "Nudge", "Reset", "Set",
 * "Undo" or "Redo"; GetChangedPoints() names the control points. A change of the selection invokes
 * vtkCommand::SelectionChangedEvent.
 *
 * Points and lengths are in the data coordinates of the lattice unless said otherwise; the matrix
 * of the prop (SetProp()) takes them to the world. Control points are named by (i, j, k) or by
 * their index, i + nx * (j + ny * k). Methods that edit return 1 if they changed something, else 0.
 * Bad indices and numbers that are not finite are errors and change nothing.
 *
 * When the dimensions of the lattice change, the selection and the undo history are emptied.
 *
 * @sa vtkFFDLatticeWidget vtkFFDLattice
 */
#ifndef vtkFFDLatticeRepresentation_h
#define vtkFFDLatticeRepresentation_h

#include "vtkFFDWidgetsModule.h" // For export macro
#include "vtkWidgetRepresentation.h"

#include <memory> // For std::unique_ptr

class vtkAbstractPicker;
class vtkFFDLattice;
class vtkIdTypeArray;
class vtkProp3D;
class vtkProperty;
class vtkProperty2D;
class vtkTextProperty;

class VTKFFDWIDGETS_EXPORT vtkFFDLatticeRepresentation : public vtkWidgetRepresentation
{
public:
  static vtkFFDLatticeRepresentation* New();
  vtkTypeMacro(vtkFFDLatticeRepresentation, vtkWidgetRepresentation);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The lattice that is shown and edited. Default: one of its own, 4 x 4 x 4 over the unit cube.
   * Null is refused.
   */
  virtual void SetLattice(vtkFFDLattice* lattice);
  vtkFFDLattice* GetLattice();
  ///@}

  ///@{
  /**
   * The volume (or actor) that the lattice deforms: its matrix takes data coordinates to the
   * world. Default: none, the world is the data coordinates. Nothing else of it is used.
   */
  virtual void SetProp(vtkProp3D* prop);
  vtkProp3D* GetProp();
  ///@}

  ///@{
  /**
   * Bounds of the volume at rest, (xmin, xmax, ...): the outline shows what they become. Default:
   * the domain of the lattice.
   */
  void SetOutlineBounds(const double bounds[6]);
  void GetOutlineBounds(double bounds[6]);
  ///@}

  ///@{
  /**
   * PlaceWidget() makes `bounds`, enlarged by PlaceFactor (default 1) about their center, the
   * domain of the lattice, and takes `bounds` for the outline. Displacements stay. Bounds must be
   * finite with min <= max and some extent; flat axes are widened as by vtkFFDLattice::FitToBounds.
   * A lattice that fits already needs no placing.
   */
  void PlaceWidget(double bounds[6]) override;
  void BuildRepresentation() override;
  ///@}

  //----------------------------------------------------------------------------
  // Selection

  /// Operations that change the present selection by new points.
  enum SelectionOperations
  {
    REPLACE, ///< the new points alone are selected
    ADD,     ///< the new points are selected, too
    TOGGLE   ///< new points that are selected are left out, others are added
  };

  ///@{
  /**
   * Select one control point. The point selected last is the active one: it is where drags of a
   * symmetric selection take their side from. -1: none.
   */
  int SelectPoint(int i, int j, int k, int operation = REPLACE);
  int SelectPoint(vtkIdType point, int operation = REPLACE);
  int IsPointSelected(int i, int j, int k);
  int IsPointSelected(vtkIdType point);
  vtkIdType GetActivePoint();
  ///@}

  ///@{
  /**
   * The selection as a whole. SetSelectedPoints() takes indices; a bad one is an error and leaves
   * the selection as it is.
   */
  int SetSelectedPoints(vtkIdTypeArray* points);
  void GetSelectedPoints(vtkIdTypeArray* points);
  vtkIdType GetNumberOfSelectedPoints();
  void SelectAll();
  void ClearSelection();
  void InvertSelection();
  ///@}

  ///@{
  /**
   * Add the neighbors along the axes; take away what has a neighbor that is not selected; add
   * the rows along, or the planes across, an axis (0, 1, 2) that selected points lie in.
   */
  void GrowSelection();
  void ShrinkSelection();
  int SelectRows(int axis);
  int SelectPlanes(int axis);
  ///@}

  /**
   * Select by a rectangle of the window (display coordinates, pixels), also points that something
   * covers, but none that PointVisibility or InteriorVisibility leaves out. Needs a renderer.
   * Returns the number of points within.
   */
  int SelectRegion(double x0, double y0, double x1, double y1, int operation = REPLACE);

  ///@{
  /**
   * The control point at a position of the window (display coordinates): the nearest one within
   * PickTolerance, and of those that cover each other the one in front; -1: none.
   */
  vtkIdType FindPoint(double x, double y);
  vtkIdType GetHoveredPoint();
  ///@}

  //----------------------------------------------------------------------------
  // Edits

  ///@{
  /**
   * Move, turn (degrees, about an axis through the center of the selection) or scale (from the
   * center) the selected control points.
   */
  int TranslateSelection(double dx, double dy, double dz);
  int RotateSelection(double degrees, double axisX, double axisY, double axisZ);
  int ScaleSelection(double sx, double sy, double sz);
  ///@}

  /// Center of the selected control points. Returns 0, and the center of the domain, for none.
  int GetSelectionCenter(double center[3]);

  /**
   * Move one control point to a position, as vtkFFDLattice::SetControlPoint() but as an edit: with
   * symmetry, lock, fold guard and undo. The selection stays and plays no part.
   */
  int SetControlPoint(int i, int j, int k, double x, double y, double z);

  /**
   * Move the selection by steps of NudgeStep: in the plane of the view, in the constraint plane, or
   * along the constraint axis (by right + up). Needs a renderer.
   */
  int NudgeSelection(double right, double up);

  ///@{
  /**
   * Displacement zero for one control point, the selected ones, or all. Soft editing plays no
   * part.
   */
  int ResetPoint(int i, int j, int k);
  int ResetSelection();
  int ResetAll();
  ///@}

  //----------------------------------------------------------------------------
  // Direct manipulation of the volume

  ///@{
  /**
   * Direct manipulation: the material that is at `from` now moves to `to`, exactly, by the
   * smallest changes of the control points (least sum of squares), while pinned material holds
   * still. A position is a deformed one, where the picture shows it. An error if `from` cannot be
   * taken back to rest (a fold), if pins, locks or the end of the lattice leave no control point
   * to move it with, or for a lattice with its InverseFlag set. The fold guard may stop it short.
   */
  int MoveMaterial(const double from[3], const double to[3]);
  int MoveMaterial(double x0, double y0, double z0, double x1, double y1, double z1);
  ///@}

  ///@{
  /**
   * Pins: the material at a (deformed) position holds still in direct manipulation. AddPin(), and
   * AddPinAtWorld(), which takes world coordinates, return 1, or 0 after an error. GetPin() gives
   * where the pin is now.
   */
  int AddPin(double x, double y, double z);
  int AddPinAtWorld(const double world[3]);
  int GetNumberOfPins();
  void GetPin(int pin, double position[3]);
  void ClearPins();
  ///@}

  ///@{
  /**
   * Find the visible surface under a position of the window, for direct manipulation by the mouse.
   * The first of these that finds one decides:
   * 1. observers of this object's vtkCommand::StartPickEvent (call data: double[2], the display
   *    position), by SetSurfacePoint() in world coordinates;
   * 2. SurfacePicker, any vtkAbstractPicker: its PickPosition. vtkFFDVolumePicker sees the volume
   *    that the lattice deforms;
   * 3. without a picker, the depth buffer: what opaque geometry of the scene is there. Volumes
   *    write no depth, so it is not enough for them.
   * PickSurface() returns 1 and a world position, or 0. Default: none.
   */
  virtual void SetSurfacePicker(vtkAbstractPicker* picker);
  vtkAbstractPicker* GetSurfacePicker();
  void SetSurfacePoint(double x, double y, double z);
  int PickSurface(double x, double y, double world[3]);
  ///@}

  //----------------------------------------------------------------------------
  // Undo

  ///@{
  /**
   * Take back or repeat edits, any number within UndoMemoryLimit (bytes, default 64 MiB; the
   * oldest go first). A drag is one edit.
   */
  int Undo();
  int Redo();
  int GetNumberOfUndos();
  int GetNumberOfRedos();
  void ClearHistory();
  void SetUndoMemoryLimit(vtkTypeInt64 bytes);
  vtkTypeInt64 GetUndoMemoryLimit();
  vtkTypeInt64 GetUndoMemorySize();
  ///@}

  ///@{
  /**
   * Name of the last edit, and the control points that it changed.
   */
  const char* GetLastEdit();
  void GetChangedPoints(vtkIdTypeArray* points);
  ///@}

  //----------------------------------------------------------------------------
  // Options of edits

  /// Constraints of drags and nudges: data axes, or the planes across them.
  enum Constraints
  {
    FREE,
    ALONG_X,
    ALONG_Y,
    ALONG_Z,
    ACROSS_X,
    ACROSS_Y,
    ACROSS_Z
  };
  ///@{
  /**
   * Default: FREE, the plane of the view. May change in the middle of a drag.
   */
  void SetConstraint(int constraint);
  vtkGetMacro(Constraint, int);
  ///@}

  ///@{
  /**
   * Proportional (soft) editing: control points near the selection follow, by Falloff of their
   * distance over ProportionalRadius (data units; 0, the default: two spacings, of the widest
   * axis). Default: off. The radius may change in the middle of a drag.
   */
  enum Falloffs
  {
    SMOOTH,  ///< 1 - 3 t^2 + 2 t^3
    LINEAR,  ///< 1 - t
    SPHERE,  ///< sqrt(1 - t^2)
    SHARP,   ///< (1 - t)^2
    CONSTANT ///< 1
  };
  void SetProportionalEditing(vtkTypeBool on);
  vtkGetMacro(ProportionalEditing, vtkTypeBool);
  vtkBooleanMacro(ProportionalEditing, vtkTypeBool);
  void SetProportionalRadius(double radius);
  vtkGetMacro(ProportionalRadius, double);
  double GetEffectiveRadius();
  void SetFalloff(int falloff);
  vtkGetMacro(Falloff, int);
  ///@}

  ///@{
  /**
   * Symmetric editing across the mid-plane of the lattice normal to an axis: what is done on one
   * side is done, mirrored, on the other. The active point says which side leads. Default: off.
   */
  void SetSymmetry(vtkTypeBool x, vtkTypeBool y, vtkTypeBool z);
  void SetSymmetry(const vtkTypeBool symmetry[3]);
  vtkGetVector3Macro(Symmetry, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Keep the outermost layers of control points as they are. Default: off. LockedLayers, 0 to 3, is
   * how many. Default: 3. With three, nothing moves outside the domain and on its faces, so that
   * the surroundings of the volume stay; that leaves n - 6 control points per axis to edit.
   */
  vtkSetMacro(LockBoundary, vtkTypeBool);
  vtkGetMacro(LockBoundary, vtkTypeBool);
  vtkBooleanMacro(LockBoundary, vtkTypeBool);
  vtkSetClampMacro(LockedLayers, int, 0, 3);
  vtkGetMacro(LockedLayers, int);
  ///@}

  /// Reactions to edits that fold the lattice.
  enum FoldGuards
  {
    GUARD_OFF,   ///< nothing
    GUARD_CLAMP, ///< stop on the way to the folded state
    GUARD_WARN   ///< show the lattice in the color of the WarningProperty
  };
  ///@{
  /**
   * Fold guard. Default: GUARD_OFF. GUARD_CLAMP stops an edit where the proven lower bound of det
   * J_T in the domain reaches MinimumDeterminant (0 to below 1, default 0.05); a lattice that is
   * below it already may be made better, not worse. IsFolded() asks whether the bound is below
   * MinimumDeterminant now.
   */
  vtkSetClampMacro(FoldGuard, int, GUARD_OFF, GUARD_WARN);
  vtkGetMacro(FoldGuard, int);
  void SetMinimumDeterminant(double determinant);
  vtkGetMacro(MinimumDeterminant, double);
  int IsFolded();
  ///@}

  ///@{
  /**
   * Length of a nudge in data units; 0, the default: a twentieth of the smallest spacing.
   */
  void SetNudgeStep(double step);
  vtkGetMacro(NudgeStep, double);
  ///@}

  /// Targets of a press of the mouse.
  enum ManipulationModes
  {
    CONTROL_POINTS, ///< control points and the handle
    VOLUME          ///< the material that is seen: direct manipulation
  };
  ///@{
  /**
   * Default: CONTROL_POINTS.
   */
  vtkSetClampMacro(ManipulationMode, int, CONTROL_POINTS, VOLUME);
  vtkGetMacro(ManipulationMode, int);
  ///@}

  /// The handle at the center of the selection.
  enum HandleModes
  {
    HANDLE_OFF,
    HANDLE_TRANSLATE,
    HANDLE_ROTATE,
    HANDLE_SCALE
  };
  ///@{
  /**
   * Default: HANDLE_TRANSLATE. The handle is shown while points are selected, for rotating and
   * scaling a single one only with proportional editing (else there is nothing to turn). Its arms
   * are along the data axes; in its middle it moves in the plane of the view, turns about the line
   * of sight, or scales all axes. An arm within 15 degrees of the line of sight is faded and cannot
   * be picked: it would hide the point, and a drag along it would mean nothing. A press on a
   * selected point drags the points, even where an arm or a ring passes over it.
   */
  vtkSetClampMacro(HandleMode, int, HANDLE_OFF, HANDLE_SCALE);
  vtkGetMacro(HandleMode, int);
  ///@}

  //----------------------------------------------------------------------------
  // Look

  /// Course of the lines of the lattice.
  enum LineModes
  {
    STRAIGHT, ///< from control point to control point
    CURVED    ///< what the grid lines of the lattice at rest become
  };
  ///@{
  /**
   * Default: STRAIGHT.
   */
  vtkSetClampMacro(LineMode, int, STRAIGHT, CURVED);
  vtkGetMacro(LineMode, int);
  ///@}

  ///@{
  /**
   * Visibility of the parts. Defaults: all but labels, which name the selected and the hovered
   * points (i, j, k). Interior: control points that are not on the outside of the lattice; those
   * that are not shown cannot be picked.
   */
  vtkSetMacro(PointVisibility, vtkTypeBool);
  vtkGetMacro(PointVisibility, vtkTypeBool);
  vtkBooleanMacro(PointVisibility, vtkTypeBool);
  vtkSetMacro(InteriorVisibility, vtkTypeBool);
  vtkGetMacro(InteriorVisibility, vtkTypeBool);
  vtkBooleanMacro(InteriorVisibility, vtkTypeBool);
  vtkSetMacro(LineVisibility, vtkTypeBool);
  vtkGetMacro(LineVisibility, vtkTypeBool);
  vtkBooleanMacro(LineVisibility, vtkTypeBool);
  vtkSetMacro(OutlineVisibility, vtkTypeBool);
  vtkGetMacro(OutlineVisibility, vtkTypeBool);
  vtkBooleanMacro(OutlineVisibility, vtkTypeBool);
  vtkSetMacro(LabelVisibility, vtkTypeBool);
  vtkGetMacro(LabelVisibility, vtkTypeBool);
  vtkBooleanMacro(LabelVisibility, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Opacity of what is hidden by something: 0, not seen, to 1, as if nothing were there. Clamped;
   * NaN is refused. Default: 0.25.
   */
  void SetHiddenOpacity(double opacity);
  vtkGetMacro(HiddenOpacity, double);
  ///@}

  ///@{
  /**
   * Whether that is drawn only where something may hide the lattice: within the bounds, on screen,
   * of the other visible props of the renderer. It is most of what a lattice costs with a software
   * rasterizer. Turn it off where something else hides the lattice: what another renderer or
   * process draws. Default: on.
   */
  vtkSetMacro(CullHidden, vtkTypeBool);
  vtkGetMacro(CullHidden, vtkTypeBool);
  vtkBooleanMacro(CullHidden, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Diameter of a control point on screen in pixels, whatever the distance, 0.001 to 1000: nine
   * tenths of it in a lattice of more than 150, three quarters of more than 400, so that they do
   * not cover the volume. Clamped; NaN is refused. Default: 9.
   */
  void SetHandleSize(double size) override;
  ///@}

  ///@{
  /**
   * Factor by which PlaceWidget() enlarges its bounds, at least 0.01. Clamped; NaN is refused.
   * Default: 1.
   */
  void SetPlaceFactor(double factor) override;
  ///@}

  ///@{
  /**
   * Sizes on screen in pixels, whatever the distance: TransformHandleSize is the length of an arm
   * of the handle (10 to 1000), PickTolerance how far from its middle a point is hit (1 to 100).
   * Clamped; NaN is refused. Defaults: 80 and 8.
   */
  void SetTransformHandleSize(double size);
  vtkGetMacro(TransformHandleSize, double);
  void SetPickTolerance(double tolerance);
  vtkGetMacro(PickTolerance, double);
  ///@}

  ///@{
  /**
   * Colors, line widths, opacities. Of the property of a kind of point only the color counts,
   * but for PointProperty, whose opacity and lighting hold for all points.
   */
  vtkProperty* GetPointProperty();
  vtkProperty* GetSelectedPointProperty();
  vtkProperty* GetHoveredPointProperty();
  vtkProperty* GetLockedPointProperty();
  vtkProperty* GetPinProperty();
  vtkProperty* GetLineProperty();
  vtkProperty* GetOutlineProperty();
  vtkProperty* GetWarningProperty();
  vtkProperty* GetHandleProperty();
  vtkProperty2D* GetRubberBandProperty();
  vtkTextProperty* GetLabelTextProperty();
  ///@}

  //----------------------------------------------------------------------------
  // Interaction, as the widget drives it

  /// The target under the mouse, or the state of a drag.
  enum InteractionStates
  {
    Outside = 0,
    OnPoint,
    OnHandle,
    MovingPoints,
    MovingHandle,
    MovingMaterial,
    SelectingRegion
  };

  ///@{
  /**
   * Finds the target at a position of the window, Outside, OnPoint or OnHandle, and highlights it
   * from then on. During a drag it returns the state of the drag.
   */
  int ComputeInteractionState(int x, int y, int modify = 0) override;
  ///@}

  ///@{
  /**
   * A drag. StartWidgetInteraction() takes hold of what ComputeInteractionState() found: the handle
   * or the selection (of which the point found must be part), or in VOLUME mode what PickSurface()
   * finds; StartRegion() begins a rubber band instead. GetInteractionState() tells what became of
   * it. CancelInteraction() puts back what the drag has moved. What others set meanwhile stays only
   * of control points that the drag does not move. Display coordinates. Without a renderer in a
   * window (SetRenderer()) no drag starts, and one that has started moves nothing more.
   */
  void StartWidgetInteraction(double position[2]) override;
  void StartRegion(const double position[2], int operation);
  void WidgetInteraction(double position[2]) override;
  void EndWidgetInteraction(double position[2]) override;
  void CancelInteraction();
  ///@}

  /// Whether a drag is going on.
  int IsInteracting();

  /// Off: nothing is hovered any more.
  void Highlight(int on) override;

  ///@{
  /**
   * As a prop. The bounds are in world coordinates, and always those of the present lattice, prop
   * and options.
   */
  double* GetBounds() VTK_SIZEHINT(6) override;
  void GetActors(vtkPropCollection* actors) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;
  int RenderOpaqueGeometry(vtkViewport* viewport) override;
  int RenderTranslucentPolygonalGeometry(vtkViewport* viewport) override;
  int RenderOverlay(vtkViewport* viewport) override;
  vtkTypeBool HasTranslucentPolygonalGeometry() override;
  void ShallowCopy(vtkProp* prop) override;
  vtkMTimeType GetMTime() override;
  void RegisterPickers() override;
  void BuildPaths(vtkAssemblyPaths* paths, vtkAssemblyPath* path) override;
  ///@}

protected:
  vtkFFDLatticeRepresentation();
  ~vtkFFDLatticeRepresentation() override;

private:
  vtkFFDLatticeRepresentation(const vtkFFDLatticeRepresentation&) = delete;
  void operator=(const vtkFFDLatticeRepresentation&) = delete;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;

  int Constraint = FREE;
  vtkTypeBool ProportionalEditing = 0;
  double ProportionalRadius = 0.0;
  int Falloff = SMOOTH;
  vtkTypeBool Symmetry[3] = { 0, 0, 0 };
  vtkTypeBool LockBoundary = 0;
  int LockedLayers = 3;
  int FoldGuard = GUARD_OFF;
  double MinimumDeterminant = 0.05;
  double NudgeStep = 0.0;
  int ManipulationMode = CONTROL_POINTS;
  int HandleMode = HANDLE_TRANSLATE;
  int LineMode = STRAIGHT;
  vtkTypeBool PointVisibility = 1;
  vtkTypeBool InteriorVisibility = 1;
  vtkTypeBool LineVisibility = 1;
  vtkTypeBool OutlineVisibility = 1;
  vtkTypeBool LabelVisibility = 0;
  double HiddenOpacity = 0.25;
  vtkTypeBool CullHidden = 1;
  double TransformHandleSize = 80.0;
  double PickTolerance = 8.0;
  double Bounds[6];
};

#endif
