// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The widget by mouse and keys, through a render window interactor: what gets selected, where
// control points go, which events are sent, what can be undone.
#include "FFDTestWidget.h"

#include "vtkEvent.h"
#include "vtkWidgetEventTranslator.h"

#include <algorithm>
#include <cmath>

using ffdTest::Rep;
using ffdTest::WidgetScene;

namespace
{

double Length(const std::array<double, 3>& v)
{
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// Pixels between a point and the mouse.
double PixelsFromMouse(WidgetScene& scene, const std::array<double, 3>& p)
{
  const std::array<double, 3> at = scene.Display(p);
  return std::hypot(at[0] - scene.X, at[1] - scene.Y);
}

/// Distance of a point from the line of sight through the mouse.
double DistanceFromSight(WidgetScene& scene, const std::array<double, 3>& p)
{
  double a[4];
  double b[4];
  vtkInteractorObserver::ComputeDisplayToWorld(scene.Renderer, scene.X, scene.Y, 0.0, a);
  vtkInteractorObserver::ComputeDisplayToWorld(scene.Renderer, scene.X, scene.Y, 1.0, b);
  const double u[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
  const double v[3] = { p[0] - a[0], p[1] - a[1], p[2] - a[2] };
  return Length(
           { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] }) /
    Length({ u[0], u[1], u[2] });
}

//------------------------------------------------------------------------------
int TestHoverAndSelect()
{
  WidgetScene scene;
  Rep* rep = scene.View;
  const std::array<double, 3> at = scene.Display(scene.Point(4, 4, 4));
  scene.Move(at[0] + 3, at[1] - 3);
  FFD_CHECK(rep->GetHoveredPoint() == scene.Index(4, 4, 4));
  FFD_CHECK(rep->GetInteractionState() == Rep::OnPoint);
  scene.Move(at[0] + 12, at[1]);
  FFD_CHECK(rep->GetHoveredPoint() == -1 && rep->GetInteractionState() == Rep::Outside);
  // The uppermost point, from above, where no other is near.
  int top = 0;
  for (int n = 0; n < 125; ++n)
  {
    const auto y = [&](int m) { return scene.Display(scene.Point(m % 5, m / 5 % 5, m / 25))[1]; };
    top = y(n) > y(top) ? n : top;
  }
  const std::array<double, 3> high = scene.Display(scene.Point(top % 5, top / 5 % 5, top / 25));
  scene.Move(high[0], high[1] + 11);
  FFD_CHECK(rep->GetHoveredPoint() == -1);
  rep->SetPickTolerance(14.0);
  scene.Move(high[0], high[1] + 11);
  FFD_CHECK(rep->GetHoveredPoint() == top);
  rep->SetPickTolerance(8.0);
  scene.Mouse(vtkCommand::LeaveEvent, 0, 0);
  FFD_CHECK(rep->GetHoveredPoint() == -1);

  scene.Events();
  scene.ClickPoint(4, 4, 4);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 1 && rep->IsPointSelected(4, 4, 4));
  FFD_CHECK(rep->GetActivePoint() == scene.Index(4, 4, 4));
  // A click is no edit.
  FFD_CHECK(scene.Events() == "sSE" && rep->GetNumberOfUndos() == 0);
  scene.ClickPoint(0, 4, 4, WidgetScene::Shift);
  scene.ClickPoint(4, 0, 4, WidgetScene::Shift);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 3);
  scene.ClickPoint(0, 4, 4, WidgetScene::Control);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 2 && !rep->IsPointSelected(0, 4, 4));
  scene.ClickPoint(0, 4, 4, WidgetScene::Control);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 3 && rep->IsPointSelected(0, 4, 4));
  // On one of several that are selected: that one alone, when the button is released.
  scene.PressPoint(4, 4, 4);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 3);
  scene.Release();
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 1 && rep->IsPointSelected(4, 4, 4));

  // Interior points that are not shown are not hit.
  const std::array<double, 3> inner = scene.Display(scene.Point(2, 2, 2));
  FFD_CHECK(rep->FindPoint(inner[0], inner[1]) >= 0);
  const vtkIdType front = rep->FindPoint(inner[0], inner[1]);
  rep->InteriorVisibilityOff();
  FFD_CHECK(
    front != scene.Index(2, 2, 2) || rep->FindPoint(inner[0], inner[1]) != scene.Index(2, 2, 2));
  rep->PointVisibilityOff();
  FFD_CHECK(rep->FindPoint(at[0], at[1]) == -1);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestRubberBand()
{
  WidgetScene scene;
  Rep* rep = scene.View;
  // From an empty corner over everything.
  scene.Press(2, 2, WidgetScene::Shift);
  FFD_CHECK(rep->GetInteractionState() == Rep::SelectingRegion);
  scene.Drag(395, 395);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 0);
  scene.Release();
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 125);
  FFD_CHECK(scene.Events() == "SIIIIIsE");
  // Toggle those near one corner: they are those of the region, by the projection of each.
  const std::array<double, 3> corner = scene.Display(scene.Point(4, 4, 4));
  rep->SetHandleMode(Rep::HANDLE_OFF);
  double start = 25.0;
  while (rep->FindPoint(corner[0] + start, corner[1] + start) >= 0)
  {
    start += 1.0;
  }
  scene.Press(corner[0] + start, corner[1] + start, WidgetScene::Control);
  scene.Drag(-60, -60);
  scene.Release();
  int within = 0;
  for (int n = 0; n < 125; ++n)
  {
    const std::array<double, 3> p = scene.Display(scene.Point(n % 5, n / 5 % 5, n / 25));
    const bool inside =
      p[0] >= scene.X && p[0] <= scene.X + 60 && p[1] >= scene.Y && p[1] <= scene.Y + 60;
    within += inside ? 1 : 0;
    FFD_CHECK(rep->IsPointSelected(n) == (inside ? 0 : 1));
  }
  FFD_CHECK(within >= 2 && within < 60);
  // Key b: the next drag replaces the selection, even from a point.
  scene.Key("b");
  scene.PressPoint(4, 4, 4);
  FFD_CHECK(rep->GetInteractionState() == Rep::SelectingRegion);
  scene.Drag(2, 2);
  scene.Release();
  FFD_CHECK(rep->GetNumberOfSelectedPoints() <= 1);
  // Escape ends a rubber band, and takes key b back.
  scene.Key("a");
  scene.Press(2, 2, WidgetScene::Control);
  scene.Drag(395, 395);
  scene.Key("Escape");
  FFD_CHECK(!rep->IsInteracting() && rep->GetNumberOfSelectedPoints() == 125);
  scene.Release();
  scene.Key("b");
  scene.Key("Escape");
  const double before = scene.Renderer->GetActiveCamera()->GetPosition()[0];
  scene.Press(2, 2);
  scene.Drag(30, 0);
  scene.Release();
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 125); // the camera took it
  FFD_CHECK(scene.Renderer->GetActiveCamera()->GetPosition()[0] != before);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestDrag()
{
  WidgetScene scene;
  Rep* rep = scene.View;
  const std::array<double, 3> depth = scene.Display(scene.Point(4, 4, 4));
  scene.PressPoint(4, 4, 4);
  FFD_CHECK(scene.Widget->IsInteracting() && rep->GetInteractionState() == Rep::MovingPoints);
  // The interactor's rate during the drag, the still one after it.
  FFD_CHECK(scene.Window->GetDesiredUpdateRate() == scene.Interactor->GetDesiredUpdateRate());
  scene.Drag(-40, 25);
  // The point is under the mouse (it was grabbed at a whole pixel), as far away as before.
  FFD_CHECK_NEAR(PixelsFromMouse(scene, scene.Point(4, 4, 4)), 0.0, 0.75);
  scene.Release();
  FFD_CHECK(scene.Window->GetDesiredUpdateRate() == scene.Interactor->GetStillUpdateRate());
  FFD_CHECK(!scene.Widget->IsInteracting());
  FFD_CHECK(scene.Events() == "sSIIIII[Translate]E");
  FFD_CHECK(std::string(rep->GetLastEdit()) == "Translate");
  vtkNew<vtkIdTypeArray> changed;
  rep->GetChangedPoints(changed);
  FFD_CHECK(changed->GetNumberOfValues() == 1 && changed->GetValue(0) == scene.Index(4, 4, 4));
  const std::array<double, 3> d = scene.Moved(4, 4, 4);
  double view[3];
  scene.Renderer->GetActiveCamera()->GetDirectionOfProjection(view);
  FFD_CHECK(Length(d) > 10.0);
  FFD_CHECK_NEAR(d[0] * view[0] + d[1] * view[1] + d[2] * view[2], 0.0, 1e-3 * Length(d));
  scene.Renderer->ResetCameraClippingRange();
  (void)depth;
  FFD_CHECK(Length(scene.Moved(3, 4, 4)) == 0.0);

  // A selection of several moves as a whole, whichever is grabbed.
  scene.ClickPoint(0, 4, 4);
  scene.ClickPoint(4, 0, 4, WidgetScene::Shift);
  scene.DragPoint(0, 4, 4, 10, 20);
  FFD_CHECK(Length(scene.Moved(0, 4, 4)) > 5.0);
  for (int a = 0; a < 3; ++a)
  {
    FFD_CHECK_NEAR(scene.Moved(0, 4, 4)[static_cast<std::size_t>(a)],
      scene.Moved(4, 0, 4)[static_cast<std::size_t>(a)], 1e-12);
  }

  // Escape cancels: the state before the drag, nothing to undo, the drag is over.
  const std::vector<double> before = scene.All();
  const int undos = rep->GetNumberOfUndos();
  scene.Events();
  scene.PressPoint(4, 0, 4);
  scene.Drag(30, 30);
  FFD_CHECK(scene.All() != before);
  scene.Key("Escape");
  FFD_CHECK(scene.All() == before && rep->GetNumberOfUndos() == undos);
  FFD_CHECK(!scene.Widget->IsInteracting());
  FFD_CHECK(scene.Events() == "SIIIIIE");
  scene.Drag(30, 30);
  scene.Release();
  FFD_CHECK(scene.All() == before);

  // Off: the mouse is the camera's.
  scene.Widget->Off();
  scene.DragPoint(4, 4, 4, 30, 30);
  FFD_CHECK(scene.All() == before);
  scene.Widget->On();
  scene.Widget->ProcessEventsOff();
  scene.DragPoint(4, 4, 4, 30, 30);
  FFD_CHECK(scene.All() == before);
  scene.Widget->ProcessEventsOn();
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestConstraints()
{
  WidgetScene scene;
  Rep* rep = scene.View;
  const char* const keys[] = { "x", "y", "z" };
  for (std::size_t a = 0; a < 3; ++a)
  {
    scene.Key(keys[a]);
    FFD_CHECK(rep->GetConstraint() == Rep::ALONG_X + static_cast<int>(a));
    scene.DragPoint(4, 4, 4, -20, 30);
    const std::array<double, 3> d = scene.Moved(4, 4, 4);
    FFD_CHECK(std::abs(d[a]) > 1.0 && d[(a + 1) % 3] == 0.0 && d[(a + 2) % 3] == 0.0);
    // No other place on the axis is nearer to the line of sight (but for the pixel's rounding).
    const std::array<double, 3> p = scene.Point(4, 4, 4);
    const double here = DistanceFromSight(scene, p);
    for (double step : { -6.0, 6.0 })
    {
      std::array<double, 3> q = p;
      q[a] += step;
      FFD_CHECK(DistanceFromSight(scene, q) > here);
    }
    scene.Key(keys[a]);
    FFD_CHECK(rep->GetConstraint() == Rep::FREE);

    scene.Key("z", WidgetScene::Control);
    const char* const capitals[] = { "X", "Y", "Z" };
    scene.Key(capitals[a], WidgetScene::Shift);
    FFD_CHECK(rep->GetConstraint() == Rep::ACROSS_X + static_cast<int>(a));
    scene.DragPoint(4, 4, 4, -20, 30);
    const std::array<double, 3> e = scene.Moved(4, 4, 4);
    FFD_CHECK(e[a] == 0.0 && e[(a + 1) % 3] != 0.0 && e[(a + 2) % 3] != 0.0 && Length(e) > 2.0);
    FFD_CHECK_NEAR(PixelsFromMouse(scene, scene.Point(4, 4, 4)), 0.0, 1.5);
    scene.Key(capitals[a], WidgetScene::Shift);
    scene.Key("z", WidgetScene::Control);
    FFD_CHECK(Length(scene.Moved(4, 4, 4)) == 0.0);
  }
  // In the middle of a drag, for that drag only; again: free.
  scene.PressPoint(4, 4, 4);
  scene.Drag(-20, 30);
  FFD_CHECK(scene.Moved(4, 4, 4)[1] != 0.0 && scene.Moved(4, 4, 4)[2] != 0.0);
  scene.Key("x");
  FFD_CHECK(scene.Moved(4, 4, 4)[0] != 0.0 && scene.Moved(4, 4, 4)[1] == 0.0 &&
    scene.Moved(4, 4, 4)[2] == 0.0);
  scene.Key("x");
  FFD_CHECK(scene.Moved(4, 4, 4)[1] != 0.0);
  scene.Key("y");
  scene.Release();
  FFD_CHECK(scene.Moved(4, 4, 4)[0] == 0.0 && scene.Moved(4, 4, 4)[1] != 0.0);
  FFD_CHECK(rep->GetConstraint() == Rep::FREE);

  // An axis seen end on: no jump.
  scene.Renderer->GetActiveCamera()->SetPosition(50.0, 50.0, 600.0);
  scene.Renderer->GetActiveCamera()->SetParallelProjection(1);
  scene.Renderer->ResetCameraClippingRange();
  scene.Window->Render();
  rep->ResetAll();
  rep->SetConstraint(Rep::ALONG_Z);
  rep->InteriorVisibilityOff();
  scene.DragPoint(4, 4, 4, -20, 30);
  FFD_CHECK(Length(scene.Moved(4, 4, 4)) == 0.0);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestHandle()
{
  WidgetScene scene;
  Rep* rep = scene.View;
  rep->SelectPoint(4, 4, 4);
  rep->SelectPlanes(2);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 25);
  double c[3];
  FFD_CHECK(rep->GetSelectionCenter(c) == 1);
  scene.Window->Render();
  // The arm along y: a place between its root and its tip.
  const std::array<double, 3> center = { c[0], c[1], c[2] };
  const std::array<double, 3> above = { c[0], c[1] + 10.0, c[2] };
  const std::array<double, 3> p0 = scene.Display(center);
  const std::array<double, 3> p1 = scene.Display(above);
  const double unit = std::hypot(p1[0] - p0[0], p1[1] - p0[1]);
  const double x = p0[0] + 45.0 * (p1[0] - p0[0]) / unit;
  const double y = p0[1] + 45.0 * (p1[1] - p0[1]) / unit;
  scene.Move(x, y);
  FFD_CHECK(rep->GetInteractionState() == Rep::OnHandle && rep->GetHoveredPoint() == -1);
  scene.Press(x, y);
  FFD_CHECK(rep->GetInteractionState() == Rep::MovingHandle);
  scene.Drag(0, 30);
  scene.Release();
  FFD_CHECK(std::string(rep->GetLastEdit()) == "Translate");
  const std::array<double, 3> d = scene.Moved(2, 2, 4);
  FFD_CHECK(d[0] == 0.0 && d[1] > 5.0 && d[2] == 0.0);
  FFD_CHECK_NEAR(scene.Moved(0, 1, 4)[1], d[1], 1e-12);
  scene.Key("z", WidgetScene::Control);

  // Scaling along y: from 45 pixels to 75 by 5 / 3 (perspective aside: the tip is in the plane).
  scene.Key("s");
  FFD_CHECK(rep->GetHandleMode() == Rep::HANDLE_SCALE);
  const double edge = scene.Point(2, 4, 4)[1] - c[1];
  scene.Press(x, y);
  FFD_CHECK(rep->GetInteractionState() == Rep::MovingHandle);
  scene.Drag(x - p0[0] > 0 ? 30.0 * (p1[0] - p0[0]) / unit : 30.0 * (p1[0] - p0[0]) / unit,
    30.0 * (p1[1] - p0[1]) / unit);
  scene.Release();
  FFD_CHECK(std::string(rep->GetLastEdit()) == "Scale");
  FFD_CHECK_NEAR((scene.Point(2, 4, 4)[1] - c[1]) / edge, 75.0 / 45.0, 0.06);
  FFD_CHECK(scene.Moved(2, 4, 4)[0] == 0.0 && scene.Moved(2, 4, 4)[2] == 0.0);
  scene.Key("z", WidgetScene::Control);

  // Turning about z: every point keeps its distance from the center, and turns by one angle.
  scene.Key("r");
  FFD_CHECK(rep->GetHandleMode() == Rep::HANDLE_ROTATE);
  // A place on the ring about z that is far from the other rings.
  const double pi = std::acos(-1.0);
  const double* eye = scene.Renderer->GetActiveCamera()->GetPosition();
  const double* line = scene.Renderer->GetActiveCamera()->GetDirectionOfProjection();
  const double depth =
    (c[0] - eye[0]) * line[0] + (c[1] - eye[1]) * line[1] + (c[2] - eye[2]) * line[2];
  const double radius =
    rep->GetTransformHandleSize() * depth * 2.0 * std::tan(20.0 * pi / 180.0) / WidgetScene::Size;
  const auto onRing = [&](std::size_t axis, double t) {
    std::array<double, 3> p = center;
    p[(axis + 1) % 3] += radius * std::cos(t);
    p[(axis + 2) % 3] += radius * std::sin(t);
    return scene.Display(p);
  };
  double best = 0.0;
  std::array<double, 3> place = p0;
  for (double t = 0.0; t < 2.0 * pi; t += 0.1)
  {
    const std::array<double, 3> here = onRing(2, t);
    double nearest = std::abs(std::hypot(here[0] - p0[0], here[1] - p0[1]) - 96.0);
    for (double u = 0.0; u < 2.0 * pi; u += 0.05)
    {
      for (std::size_t axis = 0; axis < 2; ++axis)
      {
        const std::array<double, 3> other = onRing(axis, u);
        nearest = std::min(nearest, std::hypot(here[0] - other[0], here[1] - other[1]));
      }
    }
    if (nearest > best)
    {
      best = nearest;
      place = here;
    }
  }
  FFD_CHECK(best > 9.0);
  scene.Press(place[0], place[1]);
  FFD_CHECK(rep->GetInteractionState() == Rep::MovingHandle);
  scene.Drag(-40, 10);
  scene.Release();
  FFD_CHECK(std::string(rep->GetLastEdit()) == "Rotate");
  double angle = 0.0;
  for (int i = 0; i < 5; ++i)
  {
    const std::array<double, 3> p = scene.Point(i, 1, 4);
    const std::array<double, 3> m = scene.Moved(i, 1, 4);
    const double before[2] = { p[0] - m[0] - c[0], p[1] - m[1] - c[1] };
    const double after[2] = { p[0] - c[0], p[1] - c[1] };
    FFD_CHECK_NEAR(std::hypot(after[0], after[1]), std::hypot(before[0], before[1]), 1e-9);
    const double turned = std::atan2(
      before[0] * after[1] - before[1] * after[0], before[0] * after[0] + before[1] * after[1]);
    FFD_CHECK(i == 0 || std::abs(turned - angle) < 1e-9);
    angle = turned;
  }
  FFD_CHECK(std::abs(angle) > 0.1);
  scene.Key("z", WidgetScene::Control);

  // The middle: free with translate, all axes alike with scale.
  scene.Key("g");
  scene.Press(p0[0], p0[1]);
  FFD_CHECK(rep->GetInteractionState() == Rep::MovingHandle);
  scene.Drag(20, 20);
  scene.Release();
  FFD_CHECK(scene.Moved(1, 1, 4)[0] != 0.0 && scene.Moved(1, 1, 4)[1] != 0.0);
  scene.Key("z", WidgetScene::Control);
  scene.Key("s");
  scene.Press(p0[0], p0[1]);
  scene.Drag(30, 30);
  scene.Release();
  const std::array<double, 3> s = scene.Point(4, 4, 4);
  const std::array<double, 3> m = scene.Moved(4, 4, 4);
  FFD_CHECK_NEAR((s[0] - c[0]) / (s[0] - m[0] - c[0]), std::exp(60.0 / 120.0), 1e-9);
  FFD_CHECK_NEAR((s[1] - c[1]) / (s[1] - m[1] - c[1]), std::exp(60.0 / 120.0), 1e-9);
  rep->SetHandleMode(Rep::HANDLE_OFF);
  scene.Key("z", WidgetScene::Control);
  scene.Move(x, y);
  FFD_CHECK(rep->GetInteractionState() != Rep::OnHandle);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestProportionalAndSymmetric()
{
  WidgetScene scene;
  Rep* rep = scene.View;
  scene.Key("o");
  FFD_CHECK(rep->GetProportionalEditing());
  FFD_CHECK(rep->GetEffectiveRadius() == 100.0); // two spacings
  rep->SetFalloff(Rep::LINEAR);
  scene.PressPoint(4, 4, 4);
  scene.Drag(-30, 10);
  const double whole = Length(scene.Moved(4, 4, 4));
  FFD_CHECK_NEAR(Length(scene.Moved(3, 4, 4)), 0.5 * whole, 1e-9);
  FFD_CHECK_NEAR(Length(scene.Moved(3, 3, 4)), (1.0 - std::sqrt(0.5)) * whole, 1e-9);
  FFD_CHECK(Length(scene.Moved(2, 4, 4)) == 0.0);
  // The wheel in the drag: a tenth more.
  scene.Mouse(vtkCommand::MouseWheelForwardEvent, scene.X, scene.Y);
  FFD_CHECK_NEAR(rep->GetProportionalRadius(), 110.0, 1e-9);
  FFD_CHECK_NEAR(Length(scene.Moved(3, 4, 4)), (1.0 - 50.0 / 110.0) * whole, 1e-9);
  scene.Mouse(vtkCommand::MouseWheelBackwardEvent, scene.X, scene.Y);
  scene.Mouse(vtkCommand::MouseWheelBackwardEvent, scene.X, scene.Y);
  FFD_CHECK_NEAR(Length(scene.Moved(3, 4, 4)), (1.0 - 50.0 / (100.0 / 1.1)) * whole, 1e-9);
  // And the falloff.
  scene.Key("O", WidgetScene::Shift);
  FFD_CHECK(rep->GetFalloff() == Rep::SPHERE);
  FFD_CHECK_NEAR(Length(scene.Moved(3, 4, 4)), std::sqrt(1.0 - 0.55 * 0.55) * whole, 1e-9);
  scene.Release();
  FFD_CHECK(rep->GetNumberOfUndos() == 1);
  // The wheel over nothing is the camera's.
  const double radius = rep->GetProportionalRadius();
  const double distance = scene.Renderer->GetActiveCamera()->GetDistance();
  scene.Move(3, 3);
  scene.Mouse(vtkCommand::MouseWheelForwardEvent, 3, 3);
  FFD_CHECK(rep->GetProportionalRadius() == radius);
  FFD_CHECK(scene.Renderer->GetActiveCamera()->GetDistance() != distance);
  scene.Key("o");
  FFD_CHECK(!rep->GetProportionalEditing());
  rep->ResetAll();

  scene.Key("m");
  FFD_CHECK(rep->GetSymmetry()[0] && !rep->GetSymmetry()[1] && !rep->GetSymmetry()[2]);
  scene.DragPoint(4, 4, 4, -30, 10);
  const std::array<double, 3> d = scene.Moved(4, 4, 4);
  const std::array<double, 3> e = scene.Moved(0, 4, 4);
  FFD_CHECK(Length(d) > 5.0 && e[0] == -d[0] && e[1] == d[1] && e[2] == d[2]);
  FFD_CHECK(Length(scene.Moved(4, 0, 4)) == 0.0);
  scene.Key("z", WidgetScene::Control);
  // In the mid-plane: the part in the plane.
  rep->SetControlPoint(2, 4, 4, 70.0, 130.0, 120.0);
  const std::array<double, 3> m = scene.Moved(2, 4, 4);
  double rest[3];
  scene.Lattice->GetRestPoint(2, 4, 4, rest);
  FFD_CHECK(m[0] == 0.0 && m[1] == 130.0 - rest[1] && m[2] == 120.0 - rest[2]);
  scene.Key("m");
  FFD_CHECK(rep->GetSymmetry()[1]);
  scene.Key("m");
  FFD_CHECK(rep->GetSymmetry()[2]);
  scene.Key("m");
  FFD_CHECK(!rep->GetSymmetry()[0] && !rep->GetSymmetry()[1] && !rep->GetSymmetry()[2]);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestKeys()
{
  WidgetScene scene(7);
  Rep* rep = scene.View;
  // Nothing is selected: the keys that need a selection are the camera's, such as r.
  vtkCamera* camera = scene.Renderer->GetActiveCamera();
  camera->Azimuth(3.0);
  const double before = camera->GetDistance();
  scene.Key("r");
  FFD_CHECK(camera->GetDistance() != before && rep->GetHandleMode() == Rep::HANDLE_TRANSLATE);
  scene.ClickPoint(6, 6, 6);
  const double reset = camera->GetDistance();
  camera->Dolly(1.3);
  const double dollied = camera->GetDistance();
  scene.Key("r");
  FFD_CHECK(camera->GetDistance() == dollied && reset != dollied);
  camera->Dolly(0.6);
  FFD_CHECK(rep->GetHandleMode() == Rep::HANDLE_ROTATE);

  scene.Key("plus");
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 4);
  scene.Key("plus");
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 10);
  scene.Key("minus");
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 4);
  scene.Key("minus");
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 1);
  scene.Key("x", WidgetScene::Alt);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 7 && rep->GetConstraint() == Rep::FREE);
  scene.Key("Y", WidgetScene::Alt | WidgetScene::Shift);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 49 && rep->IsPointSelected(3, 6, 2));
  scene.Key("I", WidgetScene::Shift);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 343 - 49);
  scene.Key("a");
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 343);
  scene.Key("A", WidgetScene::Shift);
  FFD_CHECK(rep->GetNumberOfSelectedPoints() == 0);

  // Nudges: along the right of the view, by a twentieth of a spacing; ten times; a tenth.
  rep->SelectPoint(3, 3, 3);
  const double step = 0.05 * 25.0;
  scene.Events();
  scene.Key("Right");
  FFD_CHECK(scene.Events() == "[Nudge]SIE");
  const std::array<double, 3> right = scene.Moved(3, 3, 3);
  FFD_CHECK_NEAR(Length(right), step, 1e-9);
  const double* up = camera->GetViewUp();
  const double* forward = camera->GetDirectionOfProjection();
  FFD_CHECK_NEAR(right[0] * forward[0] + right[1] * forward[1] + right[2] * forward[2], 0.0, 1e-9);
  FFD_CHECK_NEAR(right[0] * up[0] + right[1] * up[1] + right[2] * up[2], 0.0, 1e-9);
  const std::array<double, 3> moved = scene.Display(scene.Point(3, 3, 3));
  scene.Key("Left");
  FFD_CHECK(moved[0] > scene.Display(scene.Point(3, 3, 3))[0]);
  FFD_CHECK_NEAR(Length(scene.Moved(3, 3, 3)), 0.0, 1e-12);
  scene.Key("Up", WidgetScene::Shift);
  FFD_CHECK_NEAR(Length(scene.Moved(3, 3, 3)), 10.0 * step, 1e-9);
  scene.Key("Down", WidgetScene::Shift);
  scene.Key("Down", WidgetScene::Control);
  FFD_CHECK_NEAR(Length(scene.Moved(3, 3, 3)), 0.1 * step, 1e-9);
  scene.Key("Up", WidgetScene::Control);
  rep->SetNudgeStep(2.0);
  scene.Key("z");
  scene.Key("Up");
  FFD_CHECK_NEAR(scene.Moved(3, 3, 3)[2], 2.0, 1e-12);
  scene.Key("z");

  // Reset: the selection; the point under the mouse; all.
  rep->SetHandleMode(Rep::HANDLE_OFF);
  rep->SetControlPoint(6, 6, 6, 160.0, 150.0, 140.0);
  rep->SetControlPoint(0, 6, 6, -60.0, 150.0, 140.0);
  scene.Key("Delete");
  FFD_CHECK(Length(scene.Moved(3, 3, 3)) == 0.0 && Length(scene.Moved(6, 6, 6)) > 0.0);
  const std::array<double, 3> at = scene.Display(scene.Point(6, 6, 6));
  scene.Move(at[0], at[1]);
  scene.Key("Delete", WidgetScene::Shift);
  FFD_CHECK(Length(scene.Moved(6, 6, 6)) == 0.0 && Length(scene.Moved(0, 6, 6)) > 0.0);
  scene.Key("Delete", WidgetScene::Control);
  FFD_CHECK(scene.Lattice->IsIdentity());

  // Undo and redo every one of these edits, to the bit.
  const int edits = rep->GetNumberOfUndos();
  FFD_CHECK(edits == 12);
  std::vector<std::vector<double>> states(1, scene.All());
  while (rep->GetNumberOfUndos() > 0)
  {
    scene.Key("z", WidgetScene::Control);
    states.push_back(scene.All());
  }
  FFD_CHECK(static_cast<int>(states.size()) == edits + 1 && rep->GetNumberOfRedos() == edits);
  for (double value : states.back())
  {
    FFD_CHECK(value == 0.0);
  }
  for (int n = edits; n > 0; --n)
  {
    FFD_CHECK(scene.All() == states[static_cast<std::size_t>(n)]);
    scene.Key(
      n % 2 ? "y" : "Z", n % 2 ? WidgetScene::Control : WidgetScene::Control | WidgetScene::Shift);
  }
  FFD_CHECK(scene.All() == states[0] && rep->GetNumberOfRedos() == 0);
  scene.Events();
  scene.Key("y", WidgetScene::Control); // nothing to redo
  FFD_CHECK(scene.Events().empty());

  // Lock, fold guard, manipulation, pins.
  scene.Key("l");
  FFD_CHECK(rep->GetLockBoundary() == 1);
  scene.Key("v");
  FFD_CHECK(rep->GetFoldGuard() == Rep::GUARD_CLAMP);
  scene.Key("d");
  FFD_CHECK(rep->GetManipulationMode() == Rep::VOLUME);
  FFD_CHECK(rep->AddPin(50.0, 50.0, 50.0) == 1);
  scene.Key("P", WidgetScene::Shift);
  FFD_CHECK(rep->GetNumberOfPins() == 0);

  // Other keys by the event translator.
  rep->LockBoundaryOff();
  rep->SetControlPoint(3, 3, 3, 50.0, 50.0, 60.0);
  scene.Widget->GetEventTranslator()->SetTranslation(
    vtkCommand::KeyPressEvent, vtkEvent::NoModifier, 0, 0, "u", vtkFFDLatticeWidget::UndoEdit);
  scene.Key("u");
  FFD_CHECK(scene.Lattice->IsIdentity());
  // And by script.
  FFD_CHECK(scene.Widget->Perform(vtkFFDLatticeWidget::RedoEdit) == 1);
  FFD_CHECK(scene.Moved(3, 3, 3)[2] == 10.0);
  FFD_CHECK(scene.Widget->Perform(vtkFFDLatticeWidget::RedoEdit) == 0);
  FFD_CHECK(scene.Errors->Count == 0);
  FFD_CHECK(scene.Widget->Perform(12) == 0);
  FFD_CHECK(scene.Errors->Had("Perform: 12"));
  return EXIT_SUCCESS;
}

} // namespace

int TestLatticeWidget(int, char*[])
{
  int failures = 0;
  failures += TestHoverAndSelect() != EXIT_SUCCESS;
  failures += TestRubberBand() != EXIT_SUCCESS;
  failures += TestDrag() != EXIT_SUCCESS;
  failures += TestConstraints() != EXIT_SUCCESS;
  failures += TestHandle() != EXIT_SUCCESS;
  failures += TestProportionalAndSymmetric() != EXIT_SUCCESS;
  failures += TestKeys() != EXIT_SUCCESS;
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
