// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this library: not installed.
#ifndef vtkFFDLatticeRepresentationInternals_h
#define vtkFFDLatticeRepresentationInternals_h

#include "vtkFFDLatticeGeometry.h"
#include "vtkFFDLatticePicker.h"
#include "vtkFFDLatticeRepresentation.h"
#include "vtkFFDLatticeScene.h"
#include "vtkFFDProjection.h"
#include "vtkFFDTransformGizmo.h"

#include "FFDDragGeometry.h"
#include "FFDLatticeEditor.h"

#include "vtkAbstractPicker.h"
#include "vtkFFDLattice.h"
#include "vtkNew.h"
#include "vtkProp3D.h"
#include "vtkProperty.h"
#include "vtkSmartPointer.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

/// False for NaN and infinite values.
inline bool vtkFFDAreFinite(double a, double b, double c = 0.0) { return std::isfinite(a + b + c); }

/**
 * Connects the editor, which knows the lattice as a value, with the vtkFFDLattice, and holds what
 * is drawn and dragged. Load() and Store() are the only places where displacements cross.
 */
class vtkFFDLatticeRepresentation::vtkInternals
{
public:
  explicit vtkInternals(vtkFFDLatticeRepresentation* self);

  vtkFFDLatticeRepresentation* const Self;
  vtkSmartPointer<vtkFFDLattice> Lattice = vtkSmartPointer<vtkFFDLattice>::New();
  vtkSmartPointer<vtkProp3D> Prop;
  vtkSmartPointer<vtkAbstractPicker> SurfacePicker;
  vtkNew<vtkFFDLatticePicker> Picker;
  std::optional<std::array<double, 6>> OutlineBounds;
  std::optional<glm::dvec3> SurfacePoint; ///< what an observer of StartPickEvent has said

  //----------------------------------------------------------------------------
  // Edits

  ffd::LatticeEditor Editor;

  /// Follows a change of the dimensions, which ends all that was going on.
  void Sync();
  /// Takes the lattice and the options as they are now over into the editor.
  void Load();
  /// The lattice as it is now. One whose image or array was given a size that is not possible,
  /// which the lattice itself reports, counts as the smallest one at rest.
  static ffd::Lattice FindUsableValue(vtkFFDLattice* lattice);
  void LoadOptions();
  /// Writes the displacements of the editor into the lattice.
  void Store();
  /// Makes a whole edit and tells observers. Returns 1 if it changed anything; an error while a
  /// drag is going on.
  int Edit(const char* name, const std::function<bool()>& edit);
  /// Invokes the event of the last edit.
  void ReportEdit();
  /// Makes a change of the selection and tells observers.
  void ChangeSelection(const std::function<void()>& change);

  /// Index of a control point; -1, and an error that starts with `name`, where there is none.
  vtkIdType FindIndex(const char* name, int i, int j, int k);
  /// Whether a pointer that a caller gives points at something; an error, if not.
  bool IsGiven(const void* pointer, const char* name, const char* what);
  /// Whether a number is that of a selection operation; an error, if not.
  bool IsOperation(const char* name, int operation);
  /// Whether there is a renderer in a window; an error that adds `advice`, if not.
  bool RequireView(const char* name, const char* advice = "");
  /// Sets an option within limits; NaN is refused. (vtkSetClampMacro would let it through.)
  void SetClamped(const char* name, double& member, double value, double low, double high);
  /// Sets a length that is finite and not negative.
  void SetLength(const char* name, double& member, double value, const char* meaningOfZero);

  //----------------------------------------------------------------------------
  // Targets at a position of the window

  vtkIdType Hovered = -1;
  int HoveredPart = vtkFFDTransformGizmo::NoPart;

  bool HasView() const;
  glm::dmat4 GetMatrix() const { return vtkFFDGetMatrix(this->Prop); }
  vtkFFDDataView GetDataView() const { return { this->Self->Renderer, this->GetMatrix() }; }

  /// The control point at a position, or -1; `pixels` is how far it is from it.
  vtkIdType FindPoint(const glm::dvec2& display, double* pixels = nullptr);
  /// Finds the nearest target at a position: a control point or a part of the handle, the other is
  /// -1; both are -1 if there is none.
  void FindNearest(const glm::dvec2& display, vtkIdType& point, int& part);
  /// For vtkPickingManager: where in the world something is.
  bool FindPicked(double x, double y, double world[3]);
  /// The first opaque geometry of the scene but ours, from the depth buffer.
  bool PickDepth(const glm::dvec2& display, glm::dvec3& world) const;

  //----------------------------------------------------------------------------
  // A drag

  bool Ended = true;          ///< no drag
  glm::dvec2 DragFrom{ 0.0 }; ///< display
  glm::dvec2 DragTo{ 0.0 };
  glm::dvec3 Anchor{ 0.0 };   ///< what was taken hold of, data coordinates
  glm::dvec3 Material{ 0.0 }; ///< at rest
  glm::dvec3 Motion{ 0.0 };   ///< of the anchor, so far
  int Part = vtkFFDTransformGizmo::NoPart;
  double Angle = 0.0;
  int RegionOperation = REPLACE;

  /// Begins an edit of points that the mouse moves from now on.
  void StartDrag(
    const char* name, const ffd::PointSet& points, std::ptrdiff_t leader, int interactionState);
  /// Follows the mouse again, after an option has changed.
  void RepeatDrag();
  /// Finds the motion of the anchor with the mouse, data coordinates; the last one when the axis is
  /// seen end on.
  glm::dvec3 FindMotion(int constraint) const;
  void DragHandle(const glm::dvec2& before);
  void RotateHandle(const glm::dvec2& before);
  void ScaleHandle();

  //----------------------------------------------------------------------------
  // Drawing

  enum Looks
  {
    PointLook,
    SelectedLook,
    HoveredLook,
    LockedLook,
    PinLook,
    LineLook,
    OutlineLook,
    WarningLook,
    HandleLook,
    NumberOfLooks
  };
  vtkNew<vtkProperty> Looks[NumberOfLooks];
  vtkFFDLatticeScene Scene;
  vtkFFDTransformGizmo Gizmo;

  /// Makes what is stale, each part when its key differs, so that no setter has to tell, and none
  /// can forget to.
  void Build();

private:
  struct ShapeKey ///< of the lines, the outline and the bounds
  {
    const vtkFFDLattice* Lattice = nullptr;
    vtkMTimeType LatticeTime = 0;
    glm::dmat4 Matrix{ 1.0 };
    std::array<double, 6> OutlineBounds{};
    int LineMode = -1;
    vtkTypeBool Interior = 0;
    bool operator==(const ShapeKey& other) const
    {
      return this->Lattice == other.Lattice && this->LatticeTime == other.LatticeTime &&
        this->Matrix == other.Matrix && this->OutlineBounds == other.OutlineBounds &&
        this->LineMode == other.LineMode && this->Interior == other.Interior;
    }
  };
  ShapeKey FindShapeKey() const;
  void BuildLines(const vtkFFDLatticeGeometry& geometry);
  void BuildGlyphs(const vtkFFDLatticeGeometry& geometry);
  void BuildHandle(const vtkFFDProjection& projection);
  void BuildLook();
  bool HandleIsShown() const;

  ShapeKey BuiltShape;
  vtkMTimeType LookTime = 0;    ///< of the glyphs and all that follows options
  bool HasViewGeometry = false; ///< handle and sizes on screen are those of BuiltView and LookTime
  vtkFFDProjection BuiltView;
};

#endif
