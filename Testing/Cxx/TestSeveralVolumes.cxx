// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Several volumes in one scene, with different blend modes and deformations: each is blended over
// what was drawn before, in the order of the renderer, as VTK's own mappers are; opaque geometry
// hides parts of all of them.
#include "FFDTestBlend.h"

#include "vtkActor.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSphereSource.h"

namespace
{

using Mapper = vtkFFDInverseRayVolumeMapper;

/// `over` (straight RGBA) blended over `picture`.
void Blend(ffdTest::Picture& picture, const std::vector<unsigned char>& over)
{
  for (std::size_t i = 0; i < picture.Rgb.size(); ++i)
  {
    const double alpha = over[i / 3 * 4 + 3] / 255.0;
    picture.Rgb[i] = static_cast<unsigned char>(
      over[i / 3 * 4 + i % 3] * alpha + picture.Rgb[i] * (1.0 - alpha) + 0.5);
  }
}

} // namespace

int TestSeveralVolumes(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene;
  const vtkSmartPointer<vtkImageData> engine =
    ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "engine", 2), 0.0);
  double bounds[6];
  engine->GetBounds(bounds);
  const double voxel = engine->GetSpacing()[0];
  ffdTest::SetTransfer(scene.Property, ffdTest::SolidEngine(), 4.0);
  scene.SetInput(engine);
  scene.SetSampleDistance(0.5 * voxel);

  // A second volume with mappers and looks of its own, overlapping the first.
  vtkNew<vtkVolume> other;
  vtkNew<vtkVolumeProperty> otherProperty;
  ffdTest::SetTransfer(otherProperty,
    { { 70, 0.1, 0.8, 0.3, 0.0 }, { 90, 0.1, 0.8, 0.3, 0.2 }, { 255, 0.3, 1.0, 0.9, 0.6 } }, 3.0);
  other->SetProperty(otherProperty);
  other->SetPosition(0.45 * (bounds[1] - bounds[0]), 0.0, 10.0 * voxel);
  other->SetOrientation(0.0, 0.0, 25.0);
  vtkNew<Mapper> ours;
  ours->SetInputData(engine);
  ours->SetAutoAdjustSampleDistances(0);
  ours->SetSampleDistance(0.5 * voxel);
  other->SetMapper(ours);
  double all[6] = { bounds[0], bounds[1] + 0.5 * (bounds[1] - bounds[0]), bounds[2], bounds[3],
    bounds[4], bounds[5] };
  scene.SetCamera({ 30.0, 20.0, 1.0, false, false }, all);
  const vtkSmartPointer<vtkBSplineTransform> transform =
    ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(15.0 * voxel));

  const auto render = [&](bool otherFirst) {
    scene.Renderer->RemoveVolume(scene.Volume);
    scene.Renderer->RemoveVolume(other);
    scene.Renderer->AddVolume(otherFirst ? static_cast<vtkVolume*>(other) : scene.Volume);
    scene.Renderer->AddVolume(otherFirst ? static_cast<vtkVolume*>(scene.Volume) : other);
    return scene.Render();
  };

  // Both by ours against both by VTK's, in both orders, without deformation.
  vtkNew<vtkFixedPointVolumeRayCastMapper> fixed;
  fixed->SetInputData(engine);
  fixed->SetAutoAdjustSampleDistances(0);
  fixed->SetImageSampleDistance(1.0f);
  fixed->SetSampleDistance(static_cast<float>(0.5 * voxel));
  ffdTest::Picture orders[2];
  for (const bool otherFirst : { false, true })
  {
    scene.Volume->SetMapper(scene.Fixed);
    other->SetMapper(fixed);
    const ffdTest::Picture theirs = render(otherFirst);
    scene.Volume->SetMapper(scene.Ours);
    other->SetMapper(ours);
    orders[otherFirst ? 1 : 0] = render(otherFirst);
    const ffdTest::Distance d = scene.Compare(orders[otherFirst ? 1 : 0], theirs);
    // In a window that mapper stretches its pictures by up to half a pixel.
    checks.Expect(d.Pixels > 1500 && d.Psnr >= 27.0,
      otherFirst ? "second volume first" : "first volume first",
      ffdTest::ToString(d) + " from the fixed-point mapper (at least 27 dB)");
  }
  checks.ExpectAtLeast("the order matters: mean", scene.Compare(orders[0], orders[1]).Mean, 2.0);

  // Deformed, and blended in different ways: the window is the one over the other.
  scene.Ours->SetDeformation(transform);
  ours->SetBlendModeToMaximumIntensity();
  const int* size = scene.Window->GetSize();
  std::vector<unsigned char> alone[2];
  for (const int which : { 0, 1 })
  {
    vtkNew<vtkImageData> colors;
    Mapper* mapper = which == 0 ? scene.Ours : ours;
    vtkVolume* volume = which == 0 ? scene.Volume : other;
    checks.Expect(mapper->RenderToImage(scene.Renderer, volume, size[0], size[1], colors) == 1,
      "RenderToImage", "of one of them");
    const auto* bytes = static_cast<const unsigned char*>(colors->GetScalarPointer());
    alone[which].assign(bytes, bytes + 4 * size[0] * size[1]);
  }
  for (const bool otherFirst : { false, true })
  {
    const ffdTest::Picture window = render(otherFirst);
    ffdTest::Picture expected = window;
    const std::array<unsigned char, 3> background = scene.GetBackground();
    for (std::size_t i = 0; i < expected.Rgb.size(); ++i)
    {
      expected.Rgb[i] = background[i % 3];
    }
    Blend(expected, alone[otherFirst ? 1 : 0]);
    Blend(expected, alone[otherFirst ? 0 : 1]);
    const ffdTest::Distance d = scene.Compare(window, expected);
    // Each was rounded to bytes, not premultiplied; and tiles of other pixels share evaluations.
    checks.Expect(d.Pixels > 1500 && d.Mean <= 1.0 && d.P99 <= 3.0,
      otherFirst ? "deformed, maximum first" : "deformed, composite first",
      ffdTest::ToString(d) + " from one blended over the other (mean at most 1, p99 3)");
  }

  // A ball in the middle hides what is behind it of both.
  vtkNew<vtkSphereSource> ball;
  ball->SetCenter(0.6 * bounds[1], 0.2 * bounds[3], 0.5 * bounds[5]);
  ball->SetRadius(0.2 * bounds[1]);
  ball->SetThetaResolution(40);
  ball->SetPhiResolution(40);
  vtkNew<vtkPolyDataMapper> ballMapper;
  ballMapper->SetInputConnection(ball->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(ballMapper);
  actor->GetProperty()->LightingOff();
  scene.Renderer->AddActor(actor);
  for (const bool otherFirst : { false, true })
  {
    const ffdTest::Picture with = render(otherFirst);
    scene.Ours->IntermixIntersectingGeometryOff();
    ours->IntermixIntersectingGeometryOff();
    const ffdTest::Picture without = render(otherFirst);
    scene.Ours->IntermixIntersectingGeometryOn();
    ours->IntermixIntersectingGeometryOn();
    checks.ExpectAtLeast(std::string("hidden by a ball") + (otherFirst ? ", other order" : ""),
      scene.Compare(with, without).Mean, 1.0);
  }
  return checks.Result();
}
