// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Fewer or more rays than pixels, chosen or found from the update rate, as interaction drives it.
#include "FFDTestBlend.h"

#include "vtkInteractorStyleTrackballCamera.h"
#include "vtkRenderWindowInteractor.h"

namespace
{

using Mapper = vtkFFDInverseRayVolumeMapper;

double Rays(ffdTest::Scene& scene)
{
  return static_cast<double>(scene.Ours->GetStatistics()->GetNumberOfRays());
}

} // namespace

int TestImageSampleDistance(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene;
  const vtkSmartPointer<vtkImageData> image =
    ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "engine", 2), 0.0);
  double bounds[6];
  image->GetBounds(bounds);
  const double voxel = image->GetSpacing()[0];
  ffdTest::SetTransfer(scene.Property, ffdTest::SemiTransparentEngine(), 1.0);
  scene.SetInput(image);
  scene.SetSampleDistance(0.5 * voxel);
  const vtkSmartPointer<vtkBSplineTransform> transform =
    ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(20.0 * voxel));
  scene.Ours->SetDeformation(transform);
  scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, scene.Ours->GetBounds());
  scene.Ours->CollectStatisticsOn();
  for (const int blend :
    { Mapper::COMPOSITE_BLEND, Mapper::MAXIMUM_INTENSITY_BLEND, Mapper::ISOSURFACE_BLEND })
  {
    scene.Ours->SetBlendMode(blend);
    scene.Property->GetIsoSurfaceValues()->SetValue(0, 150.0);
    scene.Ours->SetImageSampleDistance(1.0);
    const ffdTest::Picture one = scene.Render(scene.Ours);
    const double rays = Rays(scene);
    for (const double distance : { 0.5, 1.5, 2.0, 4.0 })
    {
      scene.Ours->SetImageSampleDistance(distance);
      const ffdTest::Distance d = scene.Compare(one, scene.Render(scene.Ours));
      const double wanted = rays / (distance * distance);
      // The farther apart the rays, the more of the fine detail is interpolated away.
      const double limit = distance < 1.0 ? 27.0 : 32.0 - 4.0 * distance;
      std::ostringstream name;
      name << "blend mode " << blend << ", distance " << distance;
      std::ostringstream figures;
      figures << d << " from one ray a pixel (at least " << limit << " dB, but not the same); "
              << Rays(scene) << " rays (about " << wanted << ")";
      checks.Expect(d.Pixels > 1500 && d.Psnr >= limit && d.Mean > 0.02 &&
          std::abs(Rays(scene) / wanted - 1.0) < 0.1,
        name.str(), figures.str());
    }
  }
  scene.Ours->SetBlendModeToComposite();
  // The lower limit of the automatic distance is that of still frames.
  for (const double distance : { 0.5, 1.0, 2.0 })
  {
    scene.Ours->SetImageSampleDistance(distance);
    const ffdTest::Picture chosen = scene.Render(scene.Ours);
    const double rays = Rays(scene);
    scene.Ours->AutoAdjustSampleDistancesOn();
    scene.Ours->SetImageSampleDistance(1.0);
    scene.Ours->SetMinimumImageSampleDistance(distance);
    const ffdTest::Distance d = scene.Compare(chosen, scene.Render(scene.Ours));
    checks.Expect(d.Max == 0.0 && Rays(scene) == rays,
      "still frames of minimum " + std::to_string(distance),
      ffdTest::ToString(d) + " from the picture of that distance; " + std::to_string(Rays(scene)) +
        " rays of " + std::to_string(rays));
    scene.Ours->SetMinimumImageSampleDistance(1.0);
    scene.Ours->AutoAdjustSampleDistancesOff();
  }
  const ffdTest::Picture still = scene.Render(scene.Ours);
  const double stillRays = Rays(scene);
  const double stillSamples = scene.Ours->GetStatistics()->GetSamplesPerRay();

  // An interactor style asks for its update rates when interaction starts and ends.
  scene.Ours->AutoAdjustSampleDistancesOn();
  // Far apart rays bend in shorter segments, which are sampled once at least.
  scene.Ours->SetMaximumImageSampleDistance(3.0);
  scene.Ours->SetInteractiveSampleDistance(2.0 * voxel);
  vtkNew<vtkRenderWindowInteractor> interactor;
  interactor->SetRenderWindow(scene.Window);
  interactor->SetDesiredUpdateRate(1e6);
  interactor->SetStillUpdateRate(1e-3);
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  interactor->SetInteractorStyle(style);
  style->SetDefaultRenderer(scene.Renderer);
  style->FindPokedRenderer(70, 70);
  interactor->SetEventPosition(70, 70);
  style->StartRotate();
  scene.Window->Render();
  scene.Window->Render(); // the time of a ray is known now
  checks.Expect(Rays(scene) < 0.13 * stillRays &&
      scene.Ours->GetStatistics()->GetSamplesPerRay() < 0.7 * stillSamples,
    "while interacting",
    std::to_string(Rays(scene)) + " rays of " + std::to_string(stillRays) + ", " +
      std::to_string(scene.Ours->GetStatistics()->GetSamplesPerRay()) + " samples each of " +
      std::to_string(stillSamples));
  // Rays that are three pixels apart may be three times as far from where they belong.
  const double moving = scene.Ours->GetStatistics()->GetEvaluationsPerRay();
  scene.Ours->AutoAdjustSampleDistancesOff();
  scene.Ours->SetImageSampleDistance(3.0);
  const double sampleDistance = scene.Ours->GetSampleDistance();
  scene.Ours->SetSampleDistance(2.0 * voxel);
  scene.Window->Render();
  const double close = scene.Ours->GetStatistics()->GetEvaluationsPerRay();
  scene.Ours->SetPositionTolerance(3.0 * scene.Ours->GetPositionTolerance());
  scene.Window->Render();
  const double loose = scene.Ours->GetStatistics()->GetEvaluationsPerRay();
  checks.Expect(loose < 0.95 * close && std::abs(moving - loose) < 0.3 * (close - loose),
    "tolerance while interacting",
    std::to_string(moving) + " evaluations a ray, " + std::to_string(close) + " and " +
      std::to_string(loose) + " with one and three tolerances");
  scene.Ours->SetPositionTolerance(scene.Ours->GetPositionTolerance() / 3.0);
  scene.Ours->SetSampleDistance(sampleDistance);
  scene.Ours->SetImageSampleDistance(1.0);
  scene.Ours->AutoAdjustSampleDistancesOn();
  style->EndRotate();
  const ffdTest::Distance again = scene.Compare(still, scene.Render());
  checks.Expect(again.Max == 0.0 && Rays(scene) == stillRays, "after that",
    ffdTest::ToString(again) + " from the still picture");
  return checks.Result();
}
