// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What the representation draws: balls of the sizes that were asked for, as points and as meshes,
// in front of what is behind them, how dim they are behind something, and lines where they should
// be.
#include "FFDTestWidget.h"

#include "vtkActor.h"
#include "vtkMath.h"
#include "vtkPlaneSource.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <iostream>

using ffdTest::Rep;
using ffdTest::WidgetScene;

namespace
{

/// What HandleSize becomes for control points that are selected.
constexpr double SelectedSize = 1.15;

/// One green ball, that of the control point nearest to the camera; no lines.
class BallScene : public WidgetScene
{
public:
  explicit BallScene(int points = 4)
    : WidgetScene(points)
    , Last(points - 1)
  {
    this->View->SetHandleMode(Rep::HANDLE_OFF);
    this->View->LineVisibilityOff();
    this->View->OutlineVisibilityOff();
    this->View->GetSelectedPointProperty()->SetColor(0.0, 1.0, 0.0);
    this->View->GetPointProperty()->SetColor(0.0, 0.0, 1.0);
    this->View->GetPointProperty()->SetAmbient(1.0);
    this->View->GetPointProperty()->SetDiffuse(0.0);
    this->View->SelectPoint(this->Last, this->Last, this->Last);
    this->Renderer->SetBackground(0.0, 0.0, 0.0);
  }

  ~BallScene() { this->Widget->Off(); }

  std::array<double, 3> Ball() { return this->Point(this->Last, this->Last, this->Last); }

  /// Pixels of some green.
  int CountGreen()
  {
    const std::vector<unsigned char> rgb = this->Draw();
    int count = 0;
    for (std::size_t p = 0; p < rgb.size(); p += 3)
    {
      count += rgb[p + 1] > 100 && rgb[p] < 100 ? 1 : 0;
    }
    return count;
  }

  /// The middle of the ball.
  std::array<int, 3> Middle()
  {
    const std::vector<unsigned char> rgb = this->Draw();
    const std::array<double, 3> at = this->Display(this->Ball());
    const std::size_t p =
      3 * (static_cast<std::size_t>(at[0]) + static_cast<std::size_t>(at[1]) * Size);
    return { rgb[p], rgb[p + 1], rgb[p + 2] };
  }

  /// World units of a pixel at the ball.
  double PixelAtBall()
  {
    const std::array<double, 3> ball = this->Ball();
    const std::array<double, 3> display = this->Display(ball);
    double next[4];
    vtkInteractorObserver::ComputeDisplayToWorld(
      this->Renderer, display[0] + 1.0, display[1], display[2], next);
    return std::sqrt(vtkMath::Distance2BetweenPoints(ball.data(), next));
  }

  /// A red plane across the line of sight, some pixels nearer than the middle of the ball.
  void SetPlane(double pixels)
  {
    double towards[3];
    this->Renderer->GetActiveCamera()->GetDirectionOfProjection(towards);
    const std::array<double, 3> ball = this->Ball();
    double center[3];
    for (int a = 0; a < 3; ++a)
    {
      towards[a] = -towards[a];
      center[a] = ball[static_cast<std::size_t>(a)] + pixels * this->PixelAtBall() * towards[a];
    }
    vtkNew<vtkPlaneSource> plane;
    plane->SetOrigin(-100.0, -100.0, 0.0);
    plane->SetPoint1(100.0, -100.0, 0.0);
    plane->SetPoint2(-100.0, 100.0, 0.0);
    plane->SetNormal(towards);
    plane->SetCenter(center);
    plane->Update();
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(plane->GetOutput());
    this->Plane->SetMapper(mapper);
    this->Plane->GetProperty()->SetColor(1.0, 0.0, 0.0);
    this->Plane->GetProperty()->LightingOff();
    this->Renderer->AddActor(this->Plane);
    this->Renderer->ResetCameraClippingRange();
  }
  vtkNew<vtkActor> Plane;

  void SetParallel()
  {
    this->Renderer->GetActiveCamera()->ParallelProjectionOn();
    this->Renderer->GetActiveCamera()->SetParallelScale(150.0);
    this->Renderer->ResetCameraClippingRange();
  }

  std::vector<unsigned char> Draw()
  {
    this->Window->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    this->Window->GetPixelData(0, 0, Size - 1, Size - 1, 0, pixels);
    std::vector<unsigned char> rgb(static_cast<std::size_t>(pixels->GetNumberOfValues()));
    std::copy_n(pixels->GetPointer(0), rgb.size(), rgb.begin());
    return rgb;
  }

private:
  const int Last;
};

//------------------------------------------------------------------------------
/// HandleSize is the diameter in pixels, as a point and as a mesh, which large balls are.
int TestSizes()
{
  for (bool parallel : { false, true })
  {
    BallScene scene;
    if (parallel)
    {
      scene.SetParallel();
    }
    for (double size : { 9.0, 20.0, 35.0, 52.0, 53.0, 60.0 })
    {
      scene.View->SetHandleSize(size);
      const double radius = 0.5 * SelectedSize * size;
      const double found = std::sqrt(scene.CountGreen() / vtkMath::Pi());
      std::cout << "HandleSize " << size << ": radius " << found << " of " << radius << "\n";
      FFD_CHECK_NEAR(found, radius, 0.05 * radius + 0.2);
    }
    FFD_CHECK(scene.Errors->Count == 0);
  }
  // Smaller, where there are many.
  const struct
  {
    int Points;
    double Part;
  } parts[] = { { 5, 1.0 }, { 6, 0.9 }, { 7, 0.9 }, { 8, 0.75 } };
  for (const auto& part : parts)
  {
    BallScene scene(part.Points);
    scene.Renderer->ResetCamera();
    scene.View->SetHandleSize(30.0);
    const double radius = 0.5 * SelectedSize * 30.0 * part.Part;
    FFD_CHECK_NEAR(std::sqrt(scene.CountGreen() / vtkMath::Pi()), radius, 0.03 * radius);
  }
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
/// Shaded as a ball by the light of the camera: the full color in the middle, less at the rim.
int TestShading()
{
  BallScene scene;
  scene.View->SetHandleSize(40.0);
  scene.View->SetHiddenOpacity(0.0);
  scene.View->GetPointProperty()->SetAmbient(0.0);
  scene.View->GetPointProperty()->SetDiffuse(1.0);
  FFD_CHECK(scene.Middle()[1] > 250);
  // Cosine above 101 of 255: those nearer to the middle than sqrt(1 - cosine^2) of the radius.
  const double radius = 0.5 * SelectedSize * 40.0;
  const double bright = std::sqrt(scene.CountGreen() / vtkMath::Pi()) / radius;
  FFD_CHECK_NEAR(bright, std::sqrt(1.0 - 101.0 / 255.0 * 101.0 / 255.0), 0.02);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
/// A ball is seen if its front is in front, and dimmed behind something.
int TestDepth()
{
  for (bool parallel : { false, true })
  {
    for (double size : { 20.0, 30.0, 60.0 })
    {
      BallScene scene;
      if (parallel)
      {
        scene.SetParallel();
      }
      scene.View->SetHandleSize(size);
      const double radius = 0.5 * SelectedSize * size;
      scene.View->SetHiddenOpacity(0.0);
      for (double part : { -0.5, 0.5, 0.9 })
      {
        scene.SetPlane(part * radius);
        const std::array<int, 3> front = scene.Middle();
        FFD_CHECK(front[0] < 3 && front[1] > 250);
      }
      for (double part : { 1.1, 2.0 })
      {
        scene.SetPlane(part * radius);
        const std::array<int, 3> behind = scene.Middle();
        FFD_CHECK(behind[0] > 250 && behind[1] < 3);
      }
      scene.View->SetHiddenOpacity(0.5);
      const double dimmed = 1.0 - 0.75 * 0.75;
      const std::array<int, 3> through = scene.Middle();
      // Behind large balls are others.
      const double allowed = size > 20.0 ? 70.0 : 3.0;
      FFD_CHECK_NEAR(through[0], 255.0 * (1.0 - dimmed), allowed);
      FFD_CHECK_NEAR(through[1], 255.0 * dimmed, allowed);
      FFD_CHECK(scene.Errors->Count == 0);
    }
  }
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
int TestTranslucent()
{
  for (bool peeling : { false, true })
  {
    BallScene scene;
    scene.View->SetHandleSize(30.0);
    scene.View->SetHiddenOpacity(0.0);
    scene.SetPlane(-100.0);
    scene.Renderer->SetUseDepthPeeling(peeling);
    const int opaque = scene.CountGreen();
    scene.View->GetPointProperty()->SetOpacity(0.5);
    const std::array<int, 3> mixed = scene.Middle();
    std::cout << (peeling ? "peeled: " : "blended: ") << mixed[0] << " " << mixed[1] << "\n";
    FFD_CHECK(mixed[0] > 40 && mixed[0] < 200 && mixed[1] > 100 && mixed[1] < 200);
    // And opaque again.
    scene.View->GetPointProperty()->SetOpacity(1.0);
    FFD_CHECK(scene.Middle()[1] > 250 && scene.CountGreen() == opaque);
    FFD_CHECK(scene.Errors->Count == 0);
  }
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
/// What is dimmed is drawn wherever something hides the lattice, and nowhere else.
int TestCulling()
{
  for (bool parallel : { false, true })
  {
    BallScene scene(6);
    if (parallel)
    {
      scene.SetParallel();
    }
    scene.View->LineVisibilityOn();
    const auto compare = [&scene](int& different) {
      scene.View->SetHiddenOpacity(0.0);
      const std::vector<unsigned char> none = scene.Draw();
      scene.View->SetHiddenOpacity(0.25);
      const std::vector<unsigned char> culled = scene.Draw();
      scene.View->CullHiddenOff();
      const std::vector<unsigned char> all = scene.Draw();
      scene.View->CullHiddenOn();
      different = 0;
      bool right = all != none;
      for (std::size_t p = 0; p < all.size(); p += 3)
      {
        // Red is the plane, which is all that hides; through it all is seen.
        const bool hides = none[p] == 255 && none[p + 1] == 0;
        right = right && (!hides || std::equal(&all[p], &all[p] + 3, &culled[p]));
        different += std::equal(&none[p], &none[p] + 3, &culled[p]) ? 0 : 1;
      }
      return right;
    };
    int different = 0;
    // Nothing hides, or nothing that is seen.
    FFD_CHECK(compare(different) && different == 0);
    scene.SetPlane(30.0);
    scene.Plane->VisibilityOff();
    FFD_CHECK(compare(different) && different == 0);
    scene.Plane->VisibilityOn();
    FFD_CHECK(compare(different) && different > 1000);
    // A small one in a corner of the picture.
    scene.Plane->SetOrigin(scene.Plane->GetCenter());
    scene.Plane->SetScale(0.1);
    FFD_CHECK(compare(different) && different > 20 && different < 4000);
    // One around the camera: everywhere.
    scene.Plane->SetScale(100.0);
    scene.Plane->SetPosition(0.0, 0.0, -500.0);
    FFD_CHECK(compare(different) && different > 1000);
    // In a part of the window.
    scene.Plane->SetPosition(0.0, 0.0, 0.0);
    scene.Plane->SetScale(1.0);
    scene.Renderer->SetViewport(0.25, 0.5, 1.0, 1.0);
    FFD_CHECK(compare(different) && different > 300);
    FFD_CHECK(scene.Errors->Count == 0);
  }
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
/// Lines are seen where the lattice says, however many of their points are drawn.
int TestLines()
{
  WidgetScene scene(7);
  Rep* rep = scene.View;
  rep->PointVisibilityOff();
  rep->OutlineVisibilityOff();
  rep->SetHandleMode(Rep::HANDLE_OFF);
  rep->SetLineMode(Rep::CURVED);
  rep->GetLineProperty()->SetColor(1.0, 1.0, 1.0);
  scene.Renderer->SetBackground(0.0, 0.0, 0.0);
  const auto draw = [&scene] {
    scene.Window->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    scene.Window->GetPixelData(0, 0, WidgetScene::Size - 1, WidgetScene::Size - 1, 0, pixels);
    std::vector<unsigned char> rgb(static_cast<std::size_t>(pixels->GetNumberOfValues()));
    std::copy_n(pixels->GetPointer(0), rgb.size(), rgb.begin());
    return rgb;
  };
  // Along the knots of each axis, finely; how many are seen and how many are missed.
  const auto missed = [&](int& seen) {
    const std::vector<unsigned char> rgb = draw();
    seen = 0;
    int misses = 0;
    double domain[6];
    scene.Lattice->GetDomain(domain);
    for (int axis = 0; axis < 3; ++axis)
    {
      for (int line = 0; line < 25; ++line)
      {
        for (int s = 0; s <= 400; ++s)
        {
          // Four cells in the domain.
          double rest[3];
          const double place[3] = { s / 400.0, line % 5 / 4.0, line / 5 / 4.0 };
          for (int a = 0; a < 3; ++a)
          {
            const int b = (axis + a) % 3;
            rest[b] = domain[2 * b] + place[a] * (domain[2 * b + 1] - domain[2 * b]);
          }
          std::array<double, 3> moved;
          scene.Lattice->TransformPoint(rest, moved.data());
          const std::array<double, 3> at = scene.Display(moved);
          const int x = static_cast<int>(std::floor(at[0]));
          const int y = static_cast<int>(std::floor(at[1]));
          if (at[2] <= 0.0 || at[2] >= 1.0 || x < 1 || y < 1 || x >= WidgetScene::Size - 1 ||
            y >= WidgetScene::Size - 1)
          {
            continue;
          }
          bool found = false;
          for (int n = 0; n < 9 && !found; ++n)
          {
            found = rgb[static_cast<std::size_t>(
                      3 * (x + n % 3 - 1 + WidgetScene::Size * (y + n / 3 - 1)))] > 128;
          }
          ++seen;
          misses += found ? 0 : 1;
        }
      }
    }
    return misses;
  };
  int seen = 0;
  FFD_CHECK(missed(seen) == 0 && seen > 20000);
  rep->SetControlPoint(3, 3, 5, 50.0, 70.0, 200.0);
  rep->SetControlPoint(2, 4, 3, 20.0, 130.0, 50.0);
  FFD_CHECK(missed(seen) == 0 && seen > 20000);
  // From afar fewer points do, and from nearby that is seen.
  vtkCamera* camera = scene.Renderer->GetActiveCamera();
  for (double zoom : { 0.1, 1.0, 4.0, 0.05, 8.0 })
  {
    const double distance = camera->GetDistance();
    camera->Dolly(zoom);
    scene.Renderer->ResetCameraClippingRange();
    FFD_CHECK(missed(seen) == 0);
    FFD_CHECK(seen > 100);
    camera->Dolly(distance > 0.0 ? 1.0 / zoom : 1.0);
    scene.Renderer->ResetCameraClippingRange();
    FFD_CHECK(missed(seen) == 0 && seen > 20000);
  }
  camera->ParallelProjectionOn();
  for (double scale : { 2000.0, 90.0, 20.0 })
  {
    camera->SetParallelScale(scale);
    scene.Renderer->ResetCameraClippingRange();
    FFD_CHECK(missed(seen) == 0);
    FFD_CHECK(seen > 100);
  }
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

} // namespace

int TestLatticeLook(int, char*[])
{
  int failures = 0;
  failures += TestSizes() != EXIT_SUCCESS;
  failures += TestShading() != EXIT_SUCCESS;
  failures += TestDepth() != EXIT_SUCCESS;
  failures += TestTranslucent() != EXIT_SUCCESS;
  failures += TestCulling() != EXIT_SUCCESS;
  failures += TestLines() != EXIT_SUCCESS;
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
