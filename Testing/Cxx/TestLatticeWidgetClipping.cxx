// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The clipping range during drags: the same to the bit while it holds what is seen, since the
// mapper makes the whole picture after a change; never one that cuts the volume or the lattice.
#include "FFDTestVolume.h"
#include "FFDTestWidget.h"

#include <algorithm>
#include <array>
#include <cmath>

using ffdTest::WidgetScene;

namespace
{

using Range = std::array<double, 2>;

/// The lattice and a volume that it deforms.
class ClippingScene : public WidgetScene
{
public:
  ClippingScene()
  {
    vtkSmartPointer<vtkImageData> image = FFDMakeBall();
    image->SetSpacing(100.0 / 23.0, 100.0 / 23.0, 100.0 / 23.0);
    this->Mapper->SetInputData(image);
    this->Mapper->SetDeformation(this->Lattice);
    this->Volume->SetMapper(this->Mapper);
    this->Renderer->AddVolume(this->Volume);
    this->View->SetProp(this->Volume);
    this->Renderer->ResetCameraClippingRange();
    this->Window->Render();
  }

  ~ClippingScene() { this->Widget->Off(); }

  Range GetRange()
  {
    Range range;
    this->Renderer->GetActiveCamera()->GetClippingRange(range.data());
    return range;
  }

  /// What VTK makes of the scene as it is; the camera keeps what it has.
  Range GetResetRange()
  {
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    const Range before = this->GetRange();
    this->Renderer->ResetCameraClippingRange();
    const Range range = this->GetRange();
    camera->SetClippingRange(before[0], before[1]);
    return range;
  }

  /// Distances from the camera, along its direction, of the box around volume and lattice.
  Range GetDepths()
  {
    double at[3];
    double direction[3];
    this->Renderer->GetActiveCamera()->GetPosition(at);
    this->Renderer->GetActiveCamera()->GetDirectionOfProjection(direction);
    Range depths = { VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX };
    for (const double* bounds : { this->Volume->GetBounds(), this->View->GetBounds() })
    {
      for (int corner = 0; corner < 8; ++corner)
      {
        double depth = 0.0;
        for (int a = 0; a < 3; ++a)
        {
          depth += (bounds[2 * a + (corner >> a & 1)] - at[a]) * direction[a];
        }
        depths = { std::min(depths[0], depth), std::max(depths[1], depth) };
      }
    }
    return depths;
  }

  bool HoldsAll()
  {
    const Range depths = this->GetDepths();
    const Range range = this->GetRange();
    const double least = this->Renderer->GetNearClippingPlaneTolerance() * range[1];
    return range[0] <= std::max(depths[0], least * 1.000001) && range[1] >= depths[1] &&
      range[0] >= 0.999999 * least;
  }

  vtkNew<vtkFFDInverseRayVolumeMapper> Mapper;
  vtkNew<vtkVolume> Volume;
};

//------------------------------------------------------------------------------
int TestStaysInside()
{
  ClippingScene scene;
  const Range before = scene.GetRange();
  const vtkMTimeType time = scene.Renderer->GetActiveCamera()->GetMTime();
  const Range depths = scene.GetDepths();
  double farthest = depths[1];
  scene.PressPoint(0, 0, 0);
  FFD_CHECK(scene.Widget->IsInteracting());
  scene.Key("z");
  for (int step = 0; step < 12; ++step)
  {
    scene.Drag(step < 6 ? 4.0 : -4.0, step < 6 ? 5.0 : -6.0, 1);
    FFD_CHECK(scene.GetRange() == before);
    FFD_CHECK(scene.HoldsAll());
    farthest = std::max(farthest, scene.GetDepths()[1]);
  }
  scene.Release();
  FFD_CHECK(scene.GetRange() == before);
  // Nothing that looks at the time stamp of the camera is made anew.
  FFD_CHECK(scene.Renderer->GetActiveCamera()->GetMTime() == time);
  // The drag did change the depth of the scene, so that a reset would have moved the planes.
  FFD_CHECK(farthest > depths[1] + 2.0);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
/// Far toward the camera, far away from it, and back.
int TestFarOut(double expansion, bool parallel)
{
  ClippingScene scene;
  scene.Renderer->SetClippingRangeExpansion(expansion);
  vtkCamera* camera = scene.Renderer->GetActiveCamera();
  camera->SetParallelProjection(parallel);
  camera->SetParallelScale(150.0);
  scene.Renderer->ResetCameraClippingRange();
  scene.Window->Render();
  const Range start = scene.GetDepths();
  Range extremes = start;
  int changes = 0;
  constexpr int steps = 100;
  scene.PressPoint(4, 4, 4);
  FFD_CHECK(scene.Widget->IsInteracting());
  scene.Key("z");
  for (int step = 0; step < steps; ++step)
  {
    const double direction = step < steps / 5 || step >= 7 * steps / 10 ? -12.0 : 14.0;
    const Range before = scene.GetRange();
    scene.Drag(0.0, direction, 1);
    changes += scene.GetRange() != before ? 1 : 0;
    FFD_CHECK(scene.HoldsAll());
    const Range range = scene.GetRange();
    const Range reset = scene.GetResetRange();
    FFD_CHECK(range[1] - range[0] <= 2.0001 * (reset[1] - reset[0]));
    extremes[0] = std::min(extremes[0], scene.GetDepths()[0]);
    extremes[1] = std::max(extremes[1], scene.GetDepths()[1]);
  }
  scene.Release();
  FFD_CHECK(scene.HoldsAll());
  std::cout << "expansion " << expansion << ", " << (parallel ? "parallel" : "perspective")
            << ": depths " << start[0] << " to " << start[1] << ", at most " << extremes[0]
            << " to " << extremes[1] << "; " << changes << " new ranges in " << steps << " steps\n";
  // Far beyond the room of the first range, which was the reset's.
  FFD_CHECK(extremes[0] < start[0] - 0.52 * (start[1] - start[0]));
  FFD_CHECK(extremes[1] > start[1] + 0.52 * (start[1] - start[0]));
  // Each new range has room for several steps.
  FFD_CHECK(changes >= 1 && changes <= steps / 10);
  // Undo by key is an edit, too.
  scene.Key("z", WidgetScene::Control);
  FFD_CHECK(scene.HoldsAll());
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
/// Nudges by key do not leave the range either.
int TestKeys()
{
  ClippingScene scene;
  scene.View->SetNudgeStep(15.0);
  scene.View->SetConstraint(ffdTest::Rep::ALONG_Z);
  scene.View->SelectPoint(0, 0, 0);
  const Range start = scene.GetRange();
  for (int nudge = 0; nudge < 4; ++nudge)
  {
    scene.Key("Left", WidgetScene::Shift);
    FFD_CHECK(scene.HoldsAll());
  }
  FFD_CHECK(scene.GetDepths()[1] > start[1]);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

//------------------------------------------------------------------------------
/// Ranges of the application that cut, are far too wide, or waste the depth buffer are replaced.
int TestUnfitRanges()
{
  ClippingScene scene;
  vtkCamera* camera = scene.Renderer->GetActiveCamera();
  scene.PressPoint(4, 4, 4);
  scene.Drag(2.0, 0.0, 1);
  const Range fit = scene.GetRange();
  for (const Range unfit : { Range{ fit[0], 3.0 * fit[1] }, Range{ 1e-6 * fit[1], fit[1] },
         Range{ 0.5 * (fit[0] + fit[1]), fit[1] }, Range{ fit[0], 0.5 * (fit[0] + fit[1]) } })
  {
    camera->SetClippingRange(unfit[0], unfit[1]);
    scene.Drag(1.0, 0.0, 1);
    FFD_CHECK(scene.HoldsAll());
    FFD_CHECK(scene.GetRange() == scene.GetResetRange());
  }
  // One that fits is left alone.
  const Range depths = scene.GetDepths();
  const Range own = { 0.9 * depths[0], 1.1 * depths[1] };
  camera->SetClippingRange(own[0], own[1]);
  scene.Drag(1.0, 0.0, 1);
  FFD_CHECK(scene.GetRange() == own);
  // The renderer's own way with what is not looked at from the middle.
  camera->SetUseOffAxisProjection(1);
  scene.Drag(1.0, 0.0, 1);
  FFD_CHECK(scene.GetRange() == scene.GetResetRange());
  camera->SetUseOffAxisProjection(0);
  scene.Release();
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

} // namespace

int TestLatticeWidgetClipping(int, char*[])
{
  int failures = 0;
  failures += TestStaysInside() != EXIT_SUCCESS;
  for (bool parallel : { false, true })
  {
    failures += TestFarOut(0.5, parallel) != EXIT_SUCCESS;
    failures += TestFarOut(0.0, parallel) != EXIT_SUCCESS;
  }
  failures += TestKeys() != EXIT_SUCCESS;
  failures += TestUnfitRanges() != EXIT_SUCCESS;
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
