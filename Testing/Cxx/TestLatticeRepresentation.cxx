// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Longer than other files, because its cases share one scene: a lattice, a prop and a window, with
// the helpers that drag and pick in it.
// The representation by its methods: edits in closed form, direct manipulation, fold guard, lock,
// undo, picking of the surface, bounds, bad input.
#include "FFDTestWidget.h"

#include "vtkActor.h"
#include "vtkCellPicker.h"
#include "vtkPickingManager.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSphereSource.h"
#include "vtkTransform.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

using ffdTest::Rep;
using ffdTest::WidgetScene;

namespace
{

using Vec3 = std::array<double, 3>;

Vec3 TransformPoint(vtkFFDLattice* lattice, const Vec3& p)
{
  Vec3 q;
  lattice->TransformPoint(p.data(), q.data());
  return q;
}

Vec3 Moved(vtkFFDLattice* lattice, int i, int j, int k)
{
  Vec3 d;
  lattice->GetDisplacement(i, j, k, d.data());
  return d;
}

//------------------------------------------------------------------------------
int TestEdits()
{
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(6, 6, 6);
  lattice->SetDomain(0.0, 30.0, 0.0, 30.0, 0.0, 30.0);
  vtkNew<vtkFFDLatticeRepresentation> rep;
  rep->SetLattice(lattice);
  // Nothing selected: nothing to do.
  FFD_CHECK(rep->TranslateSelection(1.0, 2.0, 3.0) == 0 && rep->GetNumberOfUndos() == 0);
  rep->SelectPoint(2, 2, 2);
  rep->SelectPoint(4, 2, 2, Rep::ADD);
  FFD_CHECK(rep->TranslateSelection(1.0, 2.0, 3.0) == 1);
  FFD_CHECK((Moved(lattice, 2, 2, 2) == Vec3{ 1.0, 2.0, 3.0 }));
  FFD_CHECK((Moved(lattice, 4, 2, 2) == Vec3{ 1.0, 2.0, 3.0 }));
  FFD_CHECK(rep->Undo() == 1 && lattice->IsIdentity());
  // A quarter turn about z: (-10, 0) from the center goes to (0, -10).
  FFD_CHECK(rep->RotateSelection(90.0, 0.0, 0.0, 2.0) == 1);
  FFD_CHECK_NEAR(Moved(lattice, 2, 2, 2)[0], 10.0, 1e-12);
  FFD_CHECK_NEAR(Moved(lattice, 2, 2, 2)[1], -10.0, 1e-12);
  FFD_CHECK_NEAR(Moved(lattice, 4, 2, 2)[1], 10.0, 1e-12);
  rep->Undo();
  FFD_CHECK(rep->ScaleSelection(1.5, 7.0, 1.0) == 1);
  FFD_CHECK((Moved(lattice, 2, 2, 2) == Vec3{ -5.0, 0.0, 0.0 }));
  double center[3];
  FFD_CHECK(rep->GetSelectionCenter(center) == 1 && center[0] == 20.0 && center[1] == 10.0);
  FFD_CHECK(rep->ResetPoint(2, 2, 2) == 1 && Moved(lattice, 2, 2, 2)[0] == 0.0);
  FFD_CHECK(rep->ResetPoint(2, 2, 2) == 0); // it was
  FFD_CHECK(rep->ResetSelection() == 1 && lattice->IsIdentity());

  // Proportional: radius and falloff in closed form, from the nearest of the selected ones.
  rep->SelectPoint(2, 2, 2);
  rep->ProportionalEditingOn();
  rep->SetProportionalRadius(25.0);
  rep->SetFalloff(Rep::SHARP);
  rep->TranslateSelection(10.0, 0.0, 0.0);
  FFD_CHECK_NEAR(Moved(lattice, 3, 2, 2)[0], 10.0 * 0.6 * 0.6, 1e-12);
  FFD_CHECK_NEAR(Moved(lattice, 4, 2, 2)[0], 10.0 * 0.2 * 0.2, 1e-12);
  FFD_CHECK(Moved(lattice, 5, 2, 2)[0] == 0.0);
  rep->SetFalloff(Rep::SMOOTH);
  rep->Undo();
  rep->TranslateSelection(10.0, 0.0, 0.0);
  FFD_CHECK_NEAR(Moved(lattice, 3, 2, 2)[0], 10.0 * (1.0 - 0.16 * (3.0 - 0.8)), 1e-12);
  rep->ResetAll();
  rep->ProportionalEditingOff();

  // Symmetry on two axes at once; the selected side leads, whatever was selected on the other.
  rep->SetSymmetry(1, 1, 0);
  rep->SelectPoint(0, 0, 3, Rep::ADD);
  rep->SelectPoint(5, 1, 1);
  FFD_CHECK(rep->TranslateSelection(3.0, 2.0, 1.0) == 1);
  FFD_CHECK((Moved(lattice, 5, 1, 1) == Vec3{ 3.0, 2.0, 1.0 }));
  FFD_CHECK((Moved(lattice, 0, 1, 1) == Vec3{ -3.0, 2.0, 1.0 }));
  FFD_CHECK((Moved(lattice, 5, 4, 1) == Vec3{ 3.0, -2.0, 1.0 }));
  FFD_CHECK((Moved(lattice, 0, 4, 1) == Vec3{ -3.0, -2.0, 1.0 }));
  vtkNew<vtkIdTypeArray> changed;
  rep->GetChangedPoints(changed);
  FFD_CHECK(changed->GetNumberOfValues() == 4);
  FFD_CHECK(rep->ResetSelection() == 1 && lattice->IsIdentity());
  rep->SetSymmetry(0, 0, 0);

  // The history is bounded by memory; dimensions that change empty it and the selection.
  rep->ClearHistory();
  for (int n = 0; n < 300; ++n)
  {
    rep->TranslateSelection(0.01, 0.0, 0.0);
  }
  FFD_CHECK(rep->GetNumberOfUndos() == 300);
  const vtkTypeInt64 used = rep->GetUndoMemorySize();
  rep->SetUndoMemoryLimit(used / 3);
  FFD_CHECK(rep->GetUndoMemorySize() <= used / 3 && rep->GetUndoMemoryLimit() == used / 3);
  FFD_CHECK(rep->GetNumberOfUndos() >= 95 && rep->GetNumberOfUndos() <= 100);
  lattice->SetDimensions(7, 7, 7);
  FFD_CHECK(rep->GetNumberOfUndos() == 0 && rep->GetNumberOfSelectedPoints() == 0);
  FFD_CHECK(rep->Undo() == 0 && rep->Redo() == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestDirectManipulation()
{
  FFDRandom random(7);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(8, 8, 8);
  lattice->SetDomain(0.0, 100.0, 0.0, 100.0, 0.0, 100.0);
  lattice->SetDisplacementScale(0.5);
  random.Shape(lattice, 0.3);
  vtkNew<vtkFFDLatticeRepresentation> rep;
  rep->SetLattice(lattice);
  const Vec3 pinsAtRest[3] = { { 20.0, 30.0, 40.0 }, { 70.0, 60.0, 50.0 }, { 50.0, 80.0, 20.0 } };
  for (const Vec3& pin : pinsAtRest)
  {
    const Vec3 p = TransformPoint(lattice, pin);
    FFD_CHECK(rep->AddPin(p[0], p[1], p[2]) == 1);
  }
  FFD_CHECK(rep->GetNumberOfPins() == 3);
  Vec3 before[3];
  for (int p = 0; p < 3; ++p)
  {
    rep->GetPin(p, before[p].data());
  }
  // The material goes exactly where it should, the pins hold.
  const Vec3 rest = { 45.0, 45.0, 45.0 };
  Vec3 from = TransformPoint(lattice, rest);
  for (int step = 0; step < 5; ++step)
  {
    const Vec3 to = { from[0] + 3.0, from[1] - 1.0, from[2] + 2.0 };
    FFD_CHECK(rep->MoveMaterial(from.data(), to.data()) == 1);
    const Vec3 now = TransformPoint(lattice, rest);
    FFD_CHECK(FFDDistance(now.data(), to.data()) < 1e-5);
    for (int p = 0; p < 3; ++p)
    {
      Vec3 pin;
      rep->GetPin(p, pin.data());
      FFD_CHECK(FFDDistance(pin.data(), before[p].data()) < 1e-5);
    }
    from = now;
  }
  FFD_CHECK(std::string(rep->GetLastEdit()) == "Material" && rep->GetNumberOfUndos() == 5);
  vtkNew<FFDErrorLog> errors;
  errors->Watch(rep);
  // A pin cannot be moved; nothing changes.
  const vtkMTimeType time = lattice->GetMTime();
  const Vec3 to = { before[0][0] + 5.0, before[0][1], before[0][2] };
  FFD_CHECK(rep->MoveMaterial(before[0].data(), to.data()) == 0 && errors->Had("pins"));
  FFD_CHECK(lattice->GetMTime() == time && rep->GetNumberOfUndos() == 5);
  rep->ClearPins();
  FFD_CHECK(rep->MoveMaterial(before[0].data(), to.data()) == 1);
  const Vec3 now = TransformPoint(lattice, pinsAtRest[0]);
  FFD_CHECK(FFDDistance(now.data(), to.data()) < 1e-5);

  // Symmetric: the mirror image of the material moves as the mirror image.
  lattice->Reset();
  rep->SetSymmetry(1, 0, 0);
  FFD_CHECK(rep->MoveMaterial(30.0, 40.0, 50.0, 35.0, 42.0, 49.0) == 1);
  const Vec3 image = TransformPoint(lattice, { 70.0, 40.0, 50.0 });
  FFD_CHECK_NEAR(image[0], 65.0, 1e-5);
  FFD_CHECK_NEAR(image[1], 42.0, 1e-5);
  FFD_CHECK_NEAR(image[2], 49.0, 1e-5);
  rep->SetSymmetry(0, 0, 0);
  // Out of the lattice's reach, folded, inverse, scale 0.
  lattice->Reset();
  lattice->SetBorderModeToZero();
  FFD_CHECK(rep->MoveMaterial(500.0, 0.0, 0.0, 501.0, 0.0, 0.0) == 0 && errors->Had("end of"));
  lattice->SetBorderModeToEdge();
  lattice->SetDisplacementScale(0.0);
  FFD_CHECK(rep->MoveMaterial(50.0, 50.0, 50.0, 51.0, 0.0, 0.0) == 0 && errors->Had("Scale"));
  lattice->SetDisplacementScale(1.0);
  lattice->Inverse();
  FFD_CHECK(rep->MoveMaterial(50.0, 50.0, 50.0, 51.0, 0.0, 0.0) == 0 && errors->Had("InverseFlag"));
  FFD_CHECK(rep->AddPin(50.0, 50.0, 50.0) == 0 && errors->Had("InverseFlag"));
  lattice->Inverse();
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestFoldGuardAndLock()
{
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(8, 8, 8);
  lattice->SetDomain(0.0, 50.0, 0.0, 50.0, 0.0, 50.0);
  vtkNew<vtkFFDLatticeRepresentation> rep;
  rep->SetLattice(lattice);
  rep->SelectPoint(3, 3, 3);
  rep->TranslateSelection(40.0, 0.0, 0.0);
  FFD_CHECK(!lattice->IsFoldFree() && rep->IsFolded());
  rep->Undo();
  FFD_CHECK(!rep->IsFolded());
  rep->SetFoldGuard(Rep::GUARD_CLAMP);
  rep->SetMinimumDeterminant(0.2);
  FFD_CHECK(rep->TranslateSelection(40.0, 0.0, 0.0) == 1);
  const double clamped = Moved(lattice, 3, 3, 3)[0];
  FFD_CHECK(clamped > 5.0 && clamped < 40.0);
  FFD_CHECK(lattice->GetMinimumJacobianBound() >= 0.199);
  FFD_CHECK(lattice->GetMinimumJacobianBound() < 0.24); // as near as can be
  rep->Undo();
  rep->SetMinimumDeterminant(0.6);
  rep->TranslateSelection(40.0, 0.0, 0.0);
  FFD_CHECK(Moved(lattice, 3, 3, 3)[0] < 0.7 * clamped);
  rep->ResetAll();
  // Warning only: the edit is made as asked for.
  rep->SetFoldGuard(Rep::GUARD_WARN);
  rep->TranslateSelection(40.0, 0.0, 0.0);
  FFD_CHECK(Moved(lattice, 3, 3, 3)[0] == 40.0 && rep->IsFolded());
  rep->SetFoldGuard(Rep::GUARD_CLAMP);
  // Direct manipulation is guarded, too.
  rep->ResetAll();
  FFD_CHECK(rep->MoveMaterial(25.0, 25.0, 25.0, 49.0, 25.0, 25.0) == 1);
  FFD_CHECK(lattice->GetMinimumJacobianBound() >= 0.59);
  rep->ResetAll();
  rep->SetFoldGuard(Rep::GUARD_OFF);

  // Lock: with three layers nothing moves on the faces of the domain and outside.
  rep->LockBoundaryOn();
  rep->SelectAll();
  FFD_CHECK(rep->TranslateSelection(3.0, 4.0, 5.0) == 1);
  FFD_CHECK(Moved(lattice, 2, 3, 3)[0] == 0.0 && Moved(lattice, 3, 3, 3)[0] == 3.0);
  for (const Vec3& p : { Vec3{ 0.0, 20.0, 30.0 }, Vec3{ 50.0, 25.0, 25.0 }, Vec3{ 25.0, 0.0, 25.0 },
         Vec3{ 25.0, 25.0, 50.0 }, Vec3{ -7.0, 25.0, 25.0 }, Vec3{ 60.0, 60.0, 60.0 } })
  {
    const Vec3 q = TransformPoint(lattice, p);
    FFD_CHECK(FFDDistance(p.data(), q.data()) < 1e-12);
  }
  const Vec3 middle = TransformPoint(lattice, { 25.0, 25.0, 25.0 });
  FFD_CHECK(middle[0] > 26.0);
  rep->ResetAll();
  rep->SetLockedLayers(1);
  rep->TranslateSelection(3.0, 4.0, 5.0);
  FFD_CHECK(Moved(lattice, 0, 3, 3)[0] == 0.0 && Moved(lattice, 1, 3, 3)[0] == 3.0);
  rep->LockBoundaryOff();
  rep->ResetAll();
  FFD_CHECK(lattice->IsIdentity());
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
void GiveSurfacePoint(vtkObject* caller, unsigned long, void*, void* data)
{
  const double* display = static_cast<double*>(data);
  if (display[0] > 300.0)
  {
    static_cast<Rep*>(caller)->SetSurfacePoint(60.0, 60.0, 60.0);
  }
}

int TestSurface()
{
  WidgetScene scene(8);
  Rep* rep = scene.View;
  vtkNew<vtkSphereSource> sphere;
  sphere->SetCenter(50.0, 50.0, 50.0);
  sphere->SetRadius(30.0);
  sphere->SetThetaResolution(64);
  sphere->SetPhiResolution(64);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(sphere->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  // The prop stands elsewhere in the world than its data.
  actor->SetPosition(5.0, -3.0, 0.0);
  actor->SetScale(1.2);
  actor->RotateZ(20.0);
  scene.Renderer->AddActor(actor);
  rep->SetProp(actor);
  scene.Renderer->ResetCamera();
  scene.Window->Render();

  double world[3];
  const double center[3] = { 50.0, 50.0, 50.0 };
  vtkNew<vtkTransform> toData;
  toData->SetMatrix(actor->GetMatrix());
  toData->Inverse();
  const double x = 190.0;
  const double y = 205.0;
  // From the depth buffer: on the sphere, seen from the front.
  FFD_CHECK(rep->PickSurface(x, y, world) == 1);
  double data[3];
  toData->TransformPoint(world, data);
  FFD_CHECK_NEAR(FFDDistance(data, center), 30.0, 0.2);
  FFD_CHECK(rep->PickSurface(3.0, 3.0, world) == 0);
  FFD_CHECK(rep->GetVisibility() == 1);
  // A picker.
  vtkNew<vtkCellPicker> picker;
  rep->SetSurfacePicker(picker);
  FFD_CHECK(rep->GetSurfacePicker() == picker.Get());
  double picked[3];
  FFD_CHECK(rep->PickSurface(x, y, picked) == 1);
  toData->TransformPoint(picked, data);
  FFD_CHECK_NEAR(FFDDistance(data, center), 30.0, 0.1);
  FFD_CHECK(rep->PickSurface(3.0, 3.0, world) == 0);
  // An observer goes first.
  vtkNew<vtkCallbackCommand> give;
  give->SetCallback(GiveSurfacePoint);
  const unsigned long tag = rep->AddObserver(vtkCommand::StartPickEvent, give);
  FFD_CHECK(rep->PickSurface(310.0, 3.0, world) == 1 && world[0] == 60.0);
  FFD_CHECK(rep->PickSurface(x, y, world) == 1 && FFDDistance(world, picked) < 1e-12);
  rep->RemoveObserver(tag);

  // Drag the sphere itself: the material stays under the mouse.
  scene.Key("d");
  FFD_CHECK(rep->GetManipulationMode() == Rep::VOLUME);
  scene.Events();
  scene.Press(x, y);
  FFD_CHECK(rep->GetInteractionState() == Rep::MovingMaterial);
  scene.Drag(25, 15);
  scene.Release();
  FFD_CHECK(scene.Events() == "SIIIII[Material]E");
  toData->TransformPoint(picked, data);
  Vec3 moved = TransformPoint(scene.Lattice, { data[0], data[1], data[2] });
  vtkNew<vtkTransform> toWorld;
  toWorld->SetMatrix(actor->GetMatrix());
  toWorld->TransformPoint(moved.data(), moved.data());
  const Vec3 seen = scene.Display(moved);
  FFD_CHECK_NEAR(seen[0], x + 25.0, 0.1);
  FFD_CHECK_NEAR(seen[1], y + 15.0, 0.1);
  // Shift and click pins it; a drag elsewhere leaves it where it is. (The mesh is not deformed:
  // the caller says where the surface is.)
  FFD_CHECK(rep->AddPinAtWorld(moved.data()) == 1 && rep->GetNumberOfPins() == 1);
  scene.Press(175, 215);
  scene.Drag(-10, 12);
  scene.Release();
  FFD_CHECK(std::string(rep->GetLastEdit()) == "Material" && rep->GetNumberOfUndos() == 2);
  Vec3 pin;
  rep->GetPin(0, pin.data());
  toWorld->TransformPoint(pin.data(), pin.data());
  FFD_CHECK(FFDDistance(pin.data(), moved.data()) < 1e-5);
  scene.Press(208, 190, WidgetScene::Shift);
  scene.Release();
  FFD_CHECK(rep->GetNumberOfPins() == 2);
  // Beside the sphere the mouse is the camera's.
  const std::vector<double> before = scene.All();
  scene.Press(4, 4);
  FFD_CHECK(!scene.Widget->IsInteracting());
  scene.Drag(20, 0);
  scene.Release();
  FFD_CHECK(scene.All() == before);
  scene.Key("z", WidgetScene::Control);
  scene.Key("z", WidgetScene::Control);
  FFD_CHECK(scene.Lattice->IsIdentity());
  // The bounds are in the world.
  double corner[3] = { -20.0, -20.0, -20.0 }; // control point 0
  toWorld->TransformPoint(corner, corner);
  const double* bounds = rep->GetBounds();
  for (int a = 0; a < 3; ++a)
  {
    FFD_CHECK(bounds[2 * a] <= corner[a] + 1e-3 && bounds[2 * a + 1] >= corner[a] - 1e-3);
  }
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestPickingManager()
{
  // Two widgets, one in front of the other: with the manager only that in front is hovered.
  WidgetScene scene(4);
  vtkNew<vtkFFDLattice> behind;
  behind->SetDimensions(4, 4, 4);
  behind->SetDomain(0.0, 100.0, 0.0, 100.0, 0.0, 100.0);
  vtkNew<vtkFFDLatticeWidget> other;
  other->SetInteractor(scene.Interactor);
  other->GetLatticeRepresentation()->SetLattice(behind);
  other->On();
  // The same place on the screen, farther away.
  const Vec3 p = scene.Point(3, 3, 3);
  const double* eye = scene.Renderer->GetActiveCamera()->GetPosition();
  behind->SetControlPoint(3, 3, 3, eye[0] + 1.3 * (p[0] - eye[0]), eye[1] + 1.3 * (p[1] - eye[1]),
    eye[2] + 1.3 * (p[2] - eye[2]));
  scene.Renderer->ResetCameraClippingRange();
  scene.Window->Render();
  vtkPickingManager* manager = scene.Interactor->GetPickingManager();
  FFD_CHECK(manager->GetNumberOfPickers() >= 2);
  const Vec3 at = scene.Display(p);
  manager->EnabledOff();
  scene.Move(at[0], at[1]);
  FFD_CHECK(scene.View->GetHoveredPoint() == 63);
  FFD_CHECK(other->GetLatticeRepresentation()->GetHoveredPoint() == 63);
  scene.Move(3, 3);
  manager->EnabledOn();
  scene.Window->Render();
  scene.Move(at[0], at[1]);
  FFD_CHECK(scene.View->GetHoveredPoint() == 63);
  FFD_CHECK(other->GetLatticeRepresentation()->GetHoveredPoint() == -1);
  other->Off();
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
std::vector<unsigned char> Pixels(WidgetScene& scene)
{
  scene.Window->Render();
  vtkNew<vtkUnsignedCharArray> pixels;
  scene.Window->GetPixelData(0, 0, WidgetScene::Size - 1, WidgetScene::Size - 1, 0, pixels);
  const unsigned char* p = pixels->GetPointer(0);
  return std::vector<unsigned char>(p, p + pixels->GetNumberOfValues());
}

int TestLook()
{
  // Every option of the look changes the picture, and back.
  WidgetScene scene(5);
  Rep* rep = scene.View;
  vtkNew<vtkSphereSource> sphere;
  sphere->SetCenter(50.0, 50.0, 50.0);
  sphere->SetRadius(60.0);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(sphere->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  scene.Renderer->AddActor(actor);
  rep->SelectPoint(4, 4, 4);
  rep->SelectRows(0);
  rep->SelectPoint(2, 4, 4, Rep::TOGGLE);
  rep->SetControlPoint(4, 4, 0, 200.0, 140.0, -30.0);
  rep->SetControlPoint(2, 2, 1, 70.0, 40.0, 20.0);
  const std::vector<unsigned char> plain = Pixels(scene);
  FFD_CHECK(Pixels(scene) == plain);
  int options = 0;
  const auto differs = [&](const char* name, auto set, auto reset) {
    set();
    const bool changed = Pixels(scene) != plain;
    reset();
    const bool back = Pixels(scene) == plain;
    ++options;
    if (!changed || !back)
    {
      std::cerr << name << (changed ? " does not go back" : " changes nothing") << "\n";
    }
    return changed && back;
  };
  bool ok = differs(
    "lines", [&] { rep->LineVisibilityOff(); }, [&] { rep->LineVisibilityOn(); });
  ok &= differs(
    "curved", [&] { rep->SetLineMode(Rep::CURVED); }, [&] { rep->SetLineMode(Rep::STRAIGHT); });
  ok &= differs(
    "points", [&] { rep->PointVisibilityOff(); }, [&] { rep->PointVisibilityOn(); });
  ok &= differs(
    "interior", [&] { rep->InteriorVisibilityOff(); }, [&] { rep->InteriorVisibilityOn(); });
  ok &= differs(
    "outline", [&] { rep->OutlineVisibilityOff(); }, [&] { rep->OutlineVisibilityOn(); });
  ok &= differs(
    "labels", [&] { rep->LabelVisibilityOn(); }, [&] { rep->LabelVisibilityOff(); });
  ok &= differs(
    "hidden", [&] { rep->SetHiddenOpacity(0.0); }, [&] { rep->SetHiddenOpacity(0.25); });
  ok &= differs(
    "cull hidden", [&] { rep->CullHiddenOff(); }, [&] { rep->CullHiddenOn(); });
  ok &= differs(
    "size", [&] { rep->SetHandleSize(14.0); }, [&] { rep->SetHandleSize(9.0); });
  ok &= differs(
    "handle size", [&] { rep->SetTransformHandleSize(50.0); },
    [&] { rep->SetTransformHandleSize(80.0); });
  ok &= differs(
    "handle", [&] { rep->SetHandleMode(Rep::HANDLE_ROTATE); },
    [&] { rep->SetHandleMode(Rep::HANDLE_TRANSLATE); });
  ok &= differs(
    "constraint", [&] { rep->SetConstraint(Rep::ACROSS_Y); },
    [&] { rep->SetConstraint(Rep::FREE); });
  ok &= differs(
    "proportional", [&] { rep->ProportionalEditingOn(); }, [&] { rep->ProportionalEditingOff(); });
  ok &= differs(
    "lock", [&] { rep->LockBoundaryOn(); }, [&] { rep->LockBoundaryOff(); });
  ok &= differs(
    "warning",
    [&] {
      rep->SetFoldGuard(Rep::GUARD_WARN);
      rep->SetMinimumDeterminant(0.999);
    },
    [&] {
      rep->SetFoldGuard(Rep::GUARD_OFF);
      rep->SetMinimumDeterminant(0.05);
    });
  ok &= differs(
    "pins", [&] { rep->AddPin(50.0, 50.0, 50.0); }, [&] { rep->ClearPins(); });
  const double tight[6] = { 20.0, 80.0, 20.0, 80.0, 20.0, 80.0 };
  const double wide[6] = { 0.0, 100.0, 0.0, 100.0, 0.0, 100.0 };
  ok &= differs(
    "outline bounds", [&] { rep->SetOutlineBounds(tight); }, [&] { rep->SetOutlineBounds(wide); });
  struct
  {
    const char* Name;
    vtkProperty* Property;
  } const looks[] = { { "point color", rep->GetPointProperty() },
    { "selected color", rep->GetSelectedPointProperty() }, { "line color", rep->GetLineProperty() },
    { "outline color", rep->GetOutlineProperty() } };
  for (const auto& look : looks)
  {
    double color[3];
    look.Property->GetColor(color);
    ok &= differs(
      look.Name, [&] { look.Property->SetColor(0.1, 0.9, 0.2); },
      [&] { look.Property->SetColor(color); });
  }
  ok &= differs(
    "handle width", [&] { rep->GetHandleProperty()->SetLineWidth(1.0f); },
    [&] { rep->GetHandleProperty()->SetLineWidth(3.0f); });
  // Translucent lines are drawn in the translucent pass.
  ok &= differs(
    "opacity",
    [&] {
      rep->GetLineProperty()->SetOpacity(0.4);
      ok &= rep->HasTranslucentPolygonalGeometry() == 1;
    },
    [&] { rep->GetLineProperty()->SetOpacity(1.0); });
  FFD_CHECK(ok && options == 23);
  FFD_CHECK(rep->HasTranslucentPolygonalGeometry() == 0);
  // Nothing is built again when nothing changed; graphics resources can be released at any time.
  rep->ReleaseGraphicsResources(scene.Window);
  FFD_CHECK(Pixels(scene) == plain);
  // A point keeps its size on screen.
  const auto count = [&] {
    int lit = 0;
    const std::vector<unsigned char> p = Pixels(scene);
    for (std::size_t n = 0; n + 2 < p.size(); n += 3)
    {
      lit += p[n] > 200 && p[n + 1] > 90 && p[n + 1] < 190 && p[n + 2] < 60 ? 1 : 0;
    }
    return lit;
  };
  scene.Renderer->RemoveActor(actor);
  rep->LineVisibilityOff();
  rep->OutlineVisibilityOff();
  rep->SetHandleMode(Rep::HANDLE_OFF);
  rep->SelectPoint(2, 2, 2);
  rep->InteriorVisibilityOn();
  const int near = count();
  scene.Renderer->GetActiveCamera()->Dolly(0.4);
  scene.Renderer->ResetCameraClippingRange();
  const int far = count();
  std::cerr << "pixels of a point near " << near << ", far " << far << "\n";
  FFD_CHECK(near > 25 && std::abs(near - far) < 0.35 * near);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestPlaceAndCopy()
{
  vtkNew<vtkFFDLatticeRepresentation> rep;
  double bounds[6] = { 10.0, 30.0, -5.0, 5.0, 0.0, 8.0 };
  rep->PlaceWidget(bounds);
  double domain[6];
  rep->GetLattice()->GetDomain(domain);
  FFD_CHECK(std::equal(bounds, bounds + 6, domain));
  rep->SetPlaceFactor(2.0);
  rep->PlaceWidget(bounds);
  rep->GetLattice()->GetDomain(domain);
  FFD_CHECK(domain[0] == 0.0 && domain[1] == 40.0 && domain[2] == -10.0 && domain[5] == 12.0);
  double outline[6];
  rep->GetOutlineBounds(outline);
  FFD_CHECK(std::equal(bounds, bounds + 6, outline));
  // The bounds hold the control points: one spacing beyond the domain.
  FFD_CHECK(rep->GetBounds()[0] == -40.0 && rep->GetBounds()[1] == 80.0);
  rep->SelectPoint(1, 1, 1);
  rep->SetLineMode(Rep::CURVED);
  rep->SetFalloff(Rep::SPHERE);
  rep->SetUndoMemoryLimit(12345);
  vtkNew<vtkFFDLatticeRepresentation> copy;
  copy->ShallowCopy(rep);
  FFD_CHECK(copy->GetUndoMemoryLimit() == 12345);
  FFD_CHECK(copy->GetLattice() == rep->GetLattice() && copy->IsPointSelected(1, 1, 1));
  FFD_CHECK(copy->GetLineMode() == Rep::CURVED && copy->GetFalloff() == Rep::SPHERE);
  std::ostringstream text;
  rep->Print(text);
  FFD_CHECK(text.str().find("Falloff: 2") != std::string::npos);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
bool SameBounds(vtkFFDLatticeRepresentation* rep, const std::array<double, 6>& expected)
{
  const double* b = rep->GetBounds();
  for (std::size_t i = 0; i < 6; ++i)
  {
    if (!(std::abs(b[i] - expected[i]) <= 1e-9))
    {
      std::cerr << "bound " << i << " is " << b[i] << ", not " << expected[i] << "\n";
      return false;
    }
  }
  return true;
}

/// What is drawn is always that of the present state, by whatever way it came about.
int TestNothingIsStale()
{
  vtkNew<vtkFFDLattice> large;
  large->SetDomain(0.0, 100.0, 0.0, 100.0, 0.0, 100.0);
  vtkNew<vtkFFDLatticeRepresentation> rep;
  FFD_CHECK(SameBounds(rep, { -1.0, 2.0, -1.0, 2.0, -1.0, 2.0 }));
  // A lattice that is older than what was built.
  rep->SetLattice(large);
  FFD_CHECK(SameBounds(rep, { -100.0, 200.0, -100.0, 200.0, -100.0, 200.0 }));
  // One of the same time: they share control points that were marked as changed.
  vtkNew<vtkFFDLattice> moved;
  moved->SetDomain(0.0, 100.0, 0.0, 100.0, 0.0, 100.0);
  moved->GetDisplacements()->FillComponent(2, 300.0);
  vtkNew<vtkFFDLattice> still;
  still->ShallowCopy(moved);
  still->SetDisplacementScale(0.0);
  moved->GetDisplacements()->Modified();
  FFD_CHECK(moved->GetMTime() == still->GetMTime());
  vtkNew<vtkFFDLatticeRepresentation> either;
  const double beside[6] = { -500.0, -400.0, 0.0, 1.0, 0.0, 1.0 };
  either->SetOutlineBounds(beside);
  either->SetLattice(moved);
  FFD_CHECK(SameBounds(either, { -500.0, 200.0, -100.0, 200.0, 200.0, 500.0 }));
  either->SetLattice(still);
  FFD_CHECK(SameBounds(either, { -500.0, 200.0, -100.0, 200.0, 0.0, 500.0 }));
  vtkNew<vtkActor> prop;
  prop->SetPosition(1000.0, 0.0, 0.0);
  rep->GetBounds();
  rep->SetProp(prop);
  FFD_CHECK(SameBounds(rep, { 900.0, 1200.0, -100.0, 200.0, -100.0, 200.0 }));
  rep->SetProp(nullptr);
  FFD_CHECK(SameBounds(rep, { -100.0, 200.0, -100.0, 200.0, -100.0, 200.0 }));
  // A copy takes over what was not set by a setter: bounds of the outline.
  const double wide[6] = { -500.0, 0.0, 0.0, 1.0, 0.0, 1.0 };
  vtkNew<vtkFFDLatticeRepresentation> copy;
  copy->SetLattice(large);
  copy->GetBounds();
  rep->SetOutlineBounds(wide);
  copy->ShallowCopy(rep);
  FFD_CHECK(SameBounds(copy, { -500.0, 200.0, -100.0, 200.0, -100.0, 200.0 }));
  // The dimensions changed, and the one that is copied has not noticed yet.
  rep->SelectPoint(3, 3, 3);
  large->SetDimensions(5, 4, 4);
  copy->ShallowCopy(rep);
  FFD_CHECK(copy->GetNumberOfSelectedPoints() == 0 && copy->SelectPoint(4, 3, 3) == 1);

  // Another camera that is older than the picture: the handle is where the new one sees it.
  WidgetScene scene(5);
  vtkNew<vtkCamera> other;
  other->DeepCopy(scene.Renderer->GetActiveCamera());
  other->SetViewUp(1.0, 0.0, 0.0);
  other->Zoom(0.5);
  scene.View->SelectPoint(4, 4, 4);
  scene.Window->Render();
  scene.Renderer->SetActiveCamera(other);
  scene.Window->Render();
  double arm[3];
  scene.Lattice->GetControlPoint(4, 4, 4, arm);
  const std::array<double, 3> base = scene.Display({ arm[0], arm[1], arm[2] });
  const std::array<double, 3> along = scene.Display({ arm[0] + 1.0, arm[1], arm[2] });
  const double dx = along[0] - base[0];
  const double dy = along[1] - base[1];
  const double length = std::hypot(dx, dy);
  FFD_CHECK(scene.View->ComputeInteractionState(static_cast<int>(base[0] + 40.0 * dx / length),
              static_cast<int>(base[1] + 40.0 * dy / length)) == Rep::OnHandle);

  // A lattice that shares the control points follows when they are moved, in every way.
  vtkNew<vtkFFDLattice> shared;
  shared->ShallowCopy(large);
  // One control point alone moves the material at its rest position by 8 / 27 of its way.
  const auto reaches = [&](double z) {
    double bounds[6];
    shared->GetDisplacementBounds(bounds);
    return bounds[5] >= 8.0 / 27.0 * z && bounds[5] <= z;
  };
  rep->SelectPoint(2, 2, 2);
  FFD_CHECK(reaches(0.0) && rep->TranslateSelection(0.0, 0.0, 8.0) == 1 && reaches(8.0));
  FFD_CHECK(rep->Undo() == 1 && reaches(0.0));
  large->GetDisplacements()->SetComponent(30, 2, 4.0);
  large->Modified();
  FFD_CHECK(reaches(4.0));
  const vtkMTimeType before = large->GetMTime();
  shared->ShallowCopy(large);
  FFD_CHECK(large->GetMTime() == before);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
/// Along an axis one arm of the handle points at the viewer: it must not take the press.
int TestAxisViews()
{
  for (const bool parallel : { false, true })
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      for (const double side : { -1.0, 1.0 })
      {
        WidgetScene scene(5);
        vtkCamera* camera = scene.Renderer->GetActiveCamera();
        double position[3] = { 50.0, 50.0, 50.0 };
        position[axis] += 600.0 * side;
        double up[3] = { 0.0, 0.0, 0.0 };
        up[(axis + 1) % 3] = 1.0;
        camera->SetPosition(position);
        camera->SetViewUp(up);
        camera->SetParallelProjection(parallel);
        camera->SetParallelScale(220.0);
        scene.Renderer->ResetCameraClippingRange();
        scene.Window->Render();
        // In the outermost layer that faces the viewer.
        int at[3] = { 1, 1, 1 };
        at[axis] = side > 0.0 ? 4 : 0;
        scene.ClickPoint(at[0], at[1], at[2]);
        FFD_CHECK(scene.View->IsPointSelected(at[0], at[1], at[2]));
        FFD_CHECK(scene.View->GetNumberOfSelectedPoints() == 1);
        for (int again = 0; again < 2; ++again)
        {
          const std::array<double, 3> from = scene.Moved(at[0], at[1], at[2]);
          std::array<double, 3> seen = scene.Display(scene.Point(at[0], at[1], at[2]));
          // Not in the middle of the ball, either.
          scene.Press(seen[0] + 2.0, seen[1] - 2.0);
          FFD_CHECK(scene.View->GetInteractionState() == Rep::MovingPoints);
          scene.Drag(24.0, 12.0);
          scene.Release();
          const std::array<double, 3> to = scene.Moved(at[0], at[1], at[2]);
          FFD_CHECK_NEAR(to[axis], from[axis], 1e-9);
          const std::array<double, 3> now = scene.Display(scene.Point(at[0], at[1], at[2]));
          FFD_CHECK_NEAR(now[0] - seen[0], 24.0, 1.0);
          FFD_CHECK_NEAR(now[1] - seen[1], 12.0, 1.0);
        }
        FFD_CHECK(scene.View->GetNumberOfUndos() == 2);
        // The arms across the line of sight are still there.
        const int across = (axis + 1) % 3;
        const std::array<double, 3> from = scene.Moved(at[0], at[1], at[2]);
        const std::array<double, 3> seen = scene.Display(scene.Point(at[0], at[1], at[2]));
        scene.Press(seen[0], seen[1] + 50.0);
        FFD_CHECK(scene.View->GetInteractionState() == Rep::MovingHandle);
        scene.Drag(10.0, 20.0);
        scene.Release();
        const std::array<double, 3> to = scene.Moved(at[0], at[1], at[2]);
        FFD_CHECK(to[across] > from[across] + 1.0);
        FFD_CHECK_NEAR(to[(axis + 2) % 3], from[(axis + 2) % 3], 1e-9);
      }
    }
  }
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
/// The renderer is taken away while something is drawn or dragged, or was never there.
int TestLostRenderer()
{
  WidgetScene scene(5);
  Rep* rep = scene.View;
  // Control points that are drawn as meshes, whose sizes follow from the view.
  vtkNew<vtkFFDLatticeRepresentation> large;
  large->SetHandleSize(100.0);
  large->GetLattice()->SetDimensions(12, 12, 12);
  large->GetLattice()->SetDomain(0.0, 100.0, 0.0, 100.0, 0.0, 100.0);
  scene.Renderer->AddViewProp(large);
  const std::vector<unsigned char> without = Pixels(scene);
  large->SetRenderer(scene.Renderer);
  FFD_CHECK(Pixels(scene) != without);
  large->SetRenderer(nullptr);
  large->GetLattice()->SetDimensions(13, 13, 13);
  Pixels(scene);
  scene.Renderer->RemoveViewProp(large);

  const auto takeAway = [&](double position[2]) {
    const std::vector<double> before = scene.All();
    rep->SetRenderer(nullptr);
    position[0] += 20.0;
    rep->WidgetInteraction(position);
    rep->SetConstraint(Rep::ALONG_X); // repeats the drag
    scene.Window->Render();
    const bool same = scene.All() == before && rep->IsInteracting();
    rep->SetConstraint(Rep::FREE);
    rep->EndWidgetInteraction(position);
    rep->SetRenderer(scene.Renderer);
    return same && !rep->IsInteracting() && scene.All() == before;
  };
  rep->SelectPoint(4, 4, 4);
  scene.Window->Render();
  const Vec3 point = scene.Display(scene.Point(4, 4, 4));
  // In the middle of the arm along x.
  Vec3 arm = scene.Point(4, 4, 4);
  arm[0] += 1.0;
  arm = scene.Display(arm);
  const double length = std::hypot(arm[0] - point[0], arm[1] - point[1]);
  for (std::size_t a = 0; a < 2; ++a)
  {
    arm[a] = point[a] + 40.0 / length * (arm[a] - point[a]);
  }
  for (const auto& [from, state] :
    { std::pair(point, Rep::MovingPoints), std::pair(arm, Rep::MovingHandle) })
  {
    double position[2] = { from[0], from[1] };
    rep->ComputeInteractionState(static_cast<int>(from[0]), static_cast<int>(from[1]));
    rep->StartWidgetInteraction(position);
    FFD_CHECK(rep->GetInteractionState() == state);
    position[1] += 10.0;
    rep->WidgetInteraction(position);
    FFD_CHECK(takeAway(position) && rep->Undo() == 1);
  }
  rep->SetManipulationMode(Rep::VOLUME);
  vtkNew<vtkCallbackCommand> give;
  give->SetCallback(GiveSurfacePoint);
  rep->AddObserver(vtkCommand::StartPickEvent, give);
  double position[2] = { 310.0, 200.0 };
  rep->StartWidgetInteraction(position);
  FFD_CHECK(rep->GetInteractionState() == Rep::MovingMaterial);
  FFD_CHECK(takeAway(position));
  FFD_CHECK(scene.Errors->Count == 0);
  // By the observer that is asked for the surface.
  vtkNew<vtkCallbackCommand> take;
  take->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
    static_cast<Rep*>(caller)->SetRenderer(nullptr);
  });
  rep->AddObserver(vtkCommand::StartPickEvent, take, 2.0f);
  double world[3];
  FFD_CHECK(rep->PickSurface(3.0, 3.0, world) == 0 && scene.Errors->Had("no renderer"));
  rep->SetRenderer(scene.Renderer);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
/// Null in the place of everything that is given by pointer.
int TestNull()
{
  WidgetScene scene(4);
  Rep* rep = scene.View;
  const std::vector<std::pair<const char*, std::function<void()>>> calls = {
    { "GetOutlineBounds", [rep] { rep->GetOutlineBounds(nullptr); } },
    { "SetOutlineBounds", [rep] { rep->SetOutlineBounds(nullptr); } },
    { "PlaceWidget", [rep] { rep->PlaceWidget(nullptr); } },
    { "GetSelectedPoints", [rep] { rep->GetSelectedPoints(nullptr); } },
    { "GetSelectionCenter", [rep] { rep->GetSelectionCenter(nullptr); } },
    { "MoveMaterial", [rep] { rep->MoveMaterial(nullptr, nullptr); } },
    { "AddPinAtWorld", [rep] { rep->AddPinAtWorld(nullptr); } },
    { "GetPin", [rep] { rep->GetPin(0, nullptr); } },
    { "PickSurface", [rep] { rep->PickSurface(1.0, 1.0, nullptr); } },
    { "GetChangedPoints", [rep] { rep->GetChangedPoints(nullptr); } },
    { "StartWidgetInteraction", [rep] { rep->StartWidgetInteraction(nullptr); } },
    { "StartRegion", [rep] { rep->StartRegion(nullptr, Rep::REPLACE); } },
    { "WidgetInteraction", [rep] { rep->WidgetInteraction(nullptr); } },
    { "EndWidgetInteraction", [rep] { rep->EndWidgetInteraction(nullptr); } },
    { "GetActors", [rep] { rep->GetActors(nullptr); } },
    { "RenderOpaqueGeometry", [rep] { rep->RenderOpaqueGeometry(nullptr); } },
    { "RenderTranslucentPolygonalGeometry",
      [rep] { rep->RenderTranslucentPolygonalGeometry(nullptr); } },
    { "RenderOverlay", [rep] { rep->RenderOverlay(nullptr); } },
    { "BuildPaths", [rep] { rep->BuildPaths(nullptr, nullptr); } },
    { "ShallowCopy", [rep] { rep->ShallowCopy(nullptr); } },
  };
  for (const auto& call : calls)
  {
    call.second();
    FFD_CHECK(scene.Errors->Had(call.first));
  }
  rep->SetProp(nullptr);
  rep->SetSurfacePicker(nullptr);
  rep->ReleaseGraphicsResources(nullptr);
  scene.Window->Render();
  scene.Widget->SetRepresentation(nullptr);
  scene.Window->Render();
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestBadInput()
{
  vtkNew<vtkFFDLatticeRepresentation> rep;
  vtkNew<FFDErrorLog> errors;
  errors->Watch(rep);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  vtkFFDLattice* lattice = rep->GetLattice();
  rep->SetLattice(nullptr);
  FFD_CHECK(errors->Had("SetLattice") && rep->GetLattice() == lattice);
  FFD_CHECK(rep->SelectPoint(0, 0, 4) == 0 && errors->Had("4 x 4 x 4"));
  FFD_CHECK(rep->SelectPoint(-1, 0, 0) == 0 && errors->Had("(-1, 0, 0)"));
  FFD_CHECK(rep->SelectPoint(64) == 0 && errors->Had("64"));
  FFD_CHECK(rep->SelectPoint(0, 0, 0, 7) == 0 && errors->Had("REPLACE"));
  FFD_CHECK(rep->SelectRows(3) == 0 && errors->Had("axis 3"));
  FFD_CHECK(rep->SelectPlanes(-1) == 0 && errors->Had("axis -1"));
  FFD_CHECK(rep->SelectRegion(0, 0, 1, 1) == 0 && errors->Had("renderer"));
  FFD_CHECK(rep->IsPointSelected(99, 0, 0) == 0 && rep->FindPoint(0.0, 0.0) == -1);
  vtkNew<vtkIdTypeArray> points;
  points->InsertNextValue(3);
  points->InsertNextValue(64);
  FFD_CHECK(rep->SetSelectedPoints(points) == 0 && errors->Had("64"));
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 0);
  FFD_CHECK(rep->SetSelectedPoints(nullptr) == 0 && errors->Had("null"));
  points->SetValue(1, 63);
  FFD_CHECK(rep->SetSelectedPoints(points) == 1 && rep->GetActivePoint() == 63);
  FFD_CHECK(rep->TranslateSelection(nan, 0.0, 0.0) == 0 && errors->Had("TranslateSelection"));
  FFD_CHECK(rep->RotateSelection(10.0, 0.0, 0.0, 0.0) == 0 && errors->Had("axis not zero"));
  FFD_CHECK(rep->RotateSelection(infinity, 0.0, 0.0, 1.0) == 0 && errors->Had("RotateSelection"));
  FFD_CHECK(rep->ScaleSelection(1.0, infinity, 1.0) == 0 && errors->Had("ScaleSelection"));
  FFD_CHECK(rep->SetControlPoint(0, 0, 0, nan, 0.0, 0.0) == 0 && errors->Had("SetControlPoint"));
  FFD_CHECK(rep->SetControlPoint(4, 0, 0, 0.0, 0.0, 0.0) == 0 && errors->Had("4 x 4 x 4"));
  FFD_CHECK(rep->NudgeSelection(1.0, 0.0) == 0 && errors->Had("renderer"));
  FFD_CHECK(rep->ResetPoint(0, 9, 0) == 0 && errors->Had("(0, 9, 0)"));
  FFD_CHECK(rep->MoveMaterial(nan, 0.0, 0.0, 1.0, 0.0, 0.0) == 0 && errors->Had("MoveMaterial"));
  FFD_CHECK(rep->AddPin(infinity, 0.0, 0.0) == 0 && errors->Had("AddPin"));
  double p[3];
  rep->GetPin(0, p);
  FFD_CHECK(errors->Had("pin 0") && p[0] == 0.0);
  FFD_CHECK(rep->PickSurface(1.0, 1.0, p) == 0 && errors->Had("renderer"));
  rep->SetSurfacePoint(nan, 0.0, 0.0);
  FFD_CHECK(errors->Had("SetSurfacePoint"));
  double start[2] = { 1.0, 1.0 };
  rep->StartWidgetInteraction(start);
  FFD_CHECK(errors->Had("renderer") && !rep->IsInteracting());
  rep->SetConstraint(7);
  FFD_CHECK(errors->Had("SetConstraint") && rep->GetConstraint() == Rep::FREE);
  rep->SetProportionalRadius(-1.0);
  FFD_CHECK(errors->Had("SetProportionalRadius") && rep->GetProportionalRadius() == 0.0);
  rep->SetFalloff(9);
  FFD_CHECK(errors->Had("SetFalloff") && rep->GetFalloff() == Rep::SMOOTH);
  rep->SetMinimumDeterminant(1.0);
  FFD_CHECK(errors->Had("SetMinimumDeterminant") && rep->GetMinimumDeterminant() == 0.05);
  rep->SetNudgeStep(nan);
  FFD_CHECK(errors->Had("SetNudgeStep") && rep->GetNudgeStep() == 0.0);
  rep->SetPickTolerance(nan);
  FFD_CHECK(errors->Had("SetPickTolerance") && rep->GetPickTolerance() == 8.0);
  rep->SetHiddenOpacity(nan);
  FFD_CHECK(errors->Had("SetHiddenOpacity") && rep->GetHiddenOpacity() == 0.25);
  rep->SetTransformHandleSize(nan);
  FFD_CHECK(errors->Had("SetTransformHandleSize") && rep->GetTransformHandleSize() == 80.0);
  rep->SetHandleSize(nan);
  FFD_CHECK(errors->Had("SetHandleSize") && rep->GetHandleSize() == 9.0);
  rep->SetPlaceFactor(nan);
  FFD_CHECK(errors->Had("SetPlaceFactor") && rep->GetPlaceFactor() == 1.0);
  rep->SetPickTolerance(infinity);
  rep->SetHiddenOpacity(-infinity);
  rep->SetTransformHandleSize(0.0);
  FFD_CHECK(rep->GetPickTolerance() == 100.0 && rep->GetHiddenOpacity() == 0.0);
  FFD_CHECK(rep->GetTransformHandleSize() == 10.0);
  rep->SetUndoMemoryLimit(-5);
  FFD_CHECK(errors->Had("SetUndoMemoryLimit"));
  double flat[6] = { 1.0, 1.0, 2.0, 2.0, 3.0, 3.0 };
  rep->PlaceWidget(flat);
  FFD_CHECK(errors->Had("PlaceWidget"));
  double wrong[6] = { 1.0, 0.0, 2.0, 3.0, 3.0, 4.0 };
  rep->PlaceWidget(wrong);
  FFD_CHECK(errors->Had("PlaceWidget"));
  rep->SetOutlineBounds(wrong);
  FFD_CHECK(errors->Had("SetOutlineBounds"));
  FFD_CHECK(lattice->IsIdentity() && rep->GetNumberOfUndos() == 0);
  // NaN behind the back of the setters: shown without a crash, and can be reset.
  lattice->GetDisplacements()->SetComponent(5, 1, nan);
  lattice->Modified();
  vtkNew<FFDErrorLog> told;
  told->Watch(lattice);
  rep->BuildRepresentation();
  FFD_CHECK(std::isfinite(rep->GetBounds()[0]));
  FFD_CHECK(told->Count > 0);
  lattice->Reset();
  // A script in the middle of a drag is refused.
  WidgetScene scene(5);
  scene.PressPoint(4, 4, 4);
  scene.Drag(10, 10);
  const std::vector<double> before = scene.All();
  FFD_CHECK(scene.View->ResetAll() == 0 && scene.Errors->Had("drag"));
  FFD_CHECK(scene.View->Undo() == 0 && scene.All() == before);
  // The dimensions change in the middle of a drag: it is over.
  scene.Lattice->SetDimensions(4, 4, 4);
  scene.Drag(10, 10);
  scene.Release();
  FFD_CHECK(scene.View->GetNumberOfUndos() == 0);
  scene.DragPoint(2, 2, 3, 10, 10);
  FFD_CHECK(scene.View->GetNumberOfUndos() == 1);
  return EXIT_SUCCESS;
}

} // namespace

int TestLatticeRepresentation(int, char*[])
{
  int failures = 0;
  failures += TestEdits() != EXIT_SUCCESS;
  failures += TestDirectManipulation() != EXIT_SUCCESS;
  failures += TestFoldGuardAndLock() != EXIT_SUCCESS;
  failures += TestSurface() != EXIT_SUCCESS;
  failures += TestPickingManager() != EXIT_SUCCESS;
  failures += TestLook() != EXIT_SUCCESS;
  failures += TestPlaceAndCopy() != EXIT_SUCCESS;
  failures += TestNothingIsStale() != EXIT_SUCCESS;
  failures += TestAxisViews() != EXIT_SUCCESS;
  failures += TestLostRenderer() != EXIT_SUCCESS;
  failures += TestNull() != EXIT_SUCCESS;
  failures += TestBadInput() != EXIT_SUCCESS;
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
