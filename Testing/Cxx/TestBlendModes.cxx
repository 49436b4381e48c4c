// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Maximum, minimum, average and additive blending: without deformation the pictures are those of
// VTK's own mappers, with one those that vtkOpenGLGPUVolumeRayCastMapper makes of the resampled
// volume. (Closed forms of single rays: Kernels.TestRayCaster.)
#include "FFDTestBlend.h"

#include "vtkImageResize.h"

namespace
{

using Mapper = vtkFFDInverseRayVolumeMapper;

struct Mode
{
  std::string Name;
  int Blend;
  bool FixedHasIt; ///< vtkFixedPointVolumeRayCastMapper
  bool Leaps;
  double AverageRange[2];
};

const std::vector<Mode>& Modes()
{
  static const std::vector<Mode> modes = {
    { "maximum", Mapper::MAXIMUM_INTENSITY_BLEND, true, true, { -1e9, 1e9 } },
    { "minimum", Mapper::MINIMUM_INTENSITY_BLEND, true, true, { -1e9, 1e9 } },
    { "average", Mapper::AVERAGE_INTENSITY_BLEND, false, false, { -1e9, 1e9 } },
    { "average of a range", Mapper::AVERAGE_INTENSITY_BLEND, false, true, { 70.5, 180.5 } },
    { "additive", Mapper::ADDITIVE_BLEND, false, false, { -1e9, 1e9 } },
  };
  return modes;
}

/// Minima are of what is inside of the volume: the background must not be all there is.
vtkSmartPointer<vtkImageData> Lifted(vtkImageData* image)
{
  auto out = vtkSmartPointer<vtkImageData>::New();
  out->DeepCopy(image);
  vtkDataArray* scalars = out->GetPointData()->GetScalars();
  const int* dims = out->GetDimensions();
  for (vtkIdType i = 0; i < scalars->GetNumberOfTuples(); ++i)
  {
    // A wave over all of the volume.
    const double x = static_cast<double>(i % dims[0]) / dims[0];
    const double z = static_cast<double>(i / (dims[0] * dims[1])) / dims[2];
    scalars->SetComponent(i, 0,
      std::floor(
        40.0 + 30.0 * std::sin(9.0 * x) * std::cos(7.0 * z) + 0.7 * scalars->GetComponent(i, 0)));
  }
  return out;
}

void SetMode(ffdTest::Scene& scene, const Mode& mode)
{
  ffdTest::SetBlendMode(scene, mode.Blend);
  ffdTest::ForAllMappers(scene, [&](vtkVolumeMapper* m) {
    m->SetAverageIPScalarRange(mode.AverageRange[0], mode.AverageRange[1]);
  });
  // Sums are the larger the longer the unit is not.
  scene.Property->SetScalarOpacityUnitDistance(mode.Blend == Mapper::ADDITIVE_BLEND ? 40.0 : 1.0);
}

void CheckIdentity(ffdTest::Scene& scene, const std::string& name, ffdTest::Checks& checks)
{
  for (const Mode& mode : Modes())
  {
    SetMode(scene, mode);
    for (const bool shade : { false, true })
    {
      // What is not composited is not lit, whatever the property says.
      scene.Property->SetShade(shade ? 1 : 0);
      const ffdTest::Picture ours = scene.Render(scene.Ours);
      const ffdTest::Picture gpu = scene.Render(scene.Gpu);
      const ffdTest::Distance toGpu = scene.Compare(ours, gpu);
      std::ostringstream figures;
      figures << toGpu << " from the GPU mapper";
      bool ok = toGpu.Pixels > 1500 && toGpu.Mean <= 1.5 && toGpu.P99 <= 12.0;
      if (mode.FixedHasIt)
      {
        const ffdTest::Picture fixed = scene.RenderFixedRays();
        const ffdTest::Distance toFixed = scene.Compare(ours, fixed);
        figures << ", " << toFixed << " from the fixed-point mapper, these apart "
                << scene.Compare(gpu, fixed);
        ok = ok && toFixed.Mean <= 1.5 && toFixed.P99 <= 12.0;
      }
      checks.Expect(ok, name + ", " + mode.Name + (shade ? ", shade on" : ""), figures.str());
      if (!shade)
      {
        scene.Ours->ReferenceKernelsOn();
        const ffdTest::Distance d = scene.Compare(ours, scene.Render(scene.Ours));
        scene.Ours->ReferenceKernelsOff();
        checks.Expect(d.Mean <= 0.1, name + ", " + mode.Name + ", reference kernels",
          ffdTest::ToString(d) + " (mean at most 0.1)");
      }
    }
    scene.Property->ShadeOff();
    scene.Ours->SetBlendModeToComposite();
    const ffdTest::Picture composite = scene.Render(scene.Ours);
    SetMode(scene, mode);
    checks.ExpectAtLeast(name + ", " + mode.Name + ", mean difference from composite",
      scene.Compare(composite, scene.Render(scene.Ours)).Mean, 5.0);
  }
}

void CheckDeformed(ffdTest::Scene& scene, vtkImageData* image, const std::string& name,
  const ffdTest::Transfer& ramp, ffdTest::Checks& checks)
{
  ffdTest::SetTransfer(scene.Property, ramp, 1.0);
  double bounds[6];
  image->GetBounds(bounds);
  const double voxel = image->GetSpacing()[0];
  const vtkSmartPointer<vtkBSplineTransform> transform =
    ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(20.0 * voxel));
  scene.Ours->SetDeformation(transform);
  for (const Mode& mode : Modes())
  {
    SetMode(scene, mode);
    if (mode.Blend != Mapper::MINIMUM_INTENSITY_BLEND && mode.Blend != Mapper::ADDITIVE_BLEND &&
      (mode.Blend != Mapper::AVERAGE_INTENSITY_BLEND || mode.Leaps))
    {
      // In the others what is around the volume counts, which voxels cannot leave open.
      const vtkSmartPointer<vtkImageData> voxels = ffdTest::Resample(image, transform, 0.5, 0.0);
      scene.Gpu->SetInputData(voxels);
      scene.SetCamera({ 40.0, 25.0, 1.0, false, false }, voxels->GetBounds());
      const ffdTest::Distance d = scene.Compare(scene.Render(scene.Ours), scene.Render(scene.Gpu));
      checks.Expect(d.Pixels > 1500 && d.Psnr >= 30.0, name + ", deformed, " + mode.Name,
        ffdTest::ToString(d) + " from the resampled volume (at least 30 dB)");
    }
    scene.SetCamera({ 40.0, 25.0, 1.0, false, false }, scene.Ours->GetBounds());
    if (mode.Blend == Mapper::MINIMUM_INTENSITY_BLEND)
    {
      // What is dense shows nowhere then.
      ffdTest::SetTransfer(scene.Property,
        { { 0, 0.3, 0.3, 0.7, 1.0 }, { 40, 0.3, 0.7, 0.6, 0.4 }, { 80, 0.9, 0.7, 0.3, 0.0 } }, 1.0);
    }
    for (const int segmentation : { Mapper::ERROR_BOUND, Mapper::GREEDY_ANGLE })
    {
      scene.Ours->SetSegmentation(segmentation);
      ffdTest::CheckLeaping(scene,
        name + ", deformed, " + mode.Name + ", " + scene.Ours->GetSegmentationAsString(),
        mode.Leaps, checks);
    }
    ffdTest::SetTransfer(scene.Property, ramp, 1.0);
    scene.Ours->SetSegmentationToErrorBound();
  }
}

} // namespace

int TestBlendModes(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene(140);
  const vtkSmartPointer<vtkImageData> engine = Lifted(ffdTest::ReadVolume(argc, argv, "engine", 2));
  const ffdTest::Transfer transfer = { { 0, 0.2, 0.3, 0.8, 0.0 }, { 60, 0.3, 0.3, 0.7, 0.2 },
    { 100, 0.3, 0.7, 0.6, 0.4 }, { 150, 0.9, 0.7, 0.3, 0.6 }, { 255, 1.0, 1.0, 1.0, 1.0 } };
  ffdTest::SetTransfer(scene.Property, transfer, 1.0);
  scene.SetInput(engine);
  scene.SetSampleDistance(0.3 * engine->GetSpacing()[0]);
  scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, engine->GetBounds());
  CheckIdentity(scene, "engine", checks);
  scene.SetCamera({ -60.0, 10.0, 1.0, true, false }, engine->GetBounds());
  CheckIdentity(scene, "engine, parallel", checks);

  // Smooth, so that voxels of the deformed volume lose none of its peaks.
  vtkNew<vtkImageResize> smooth;
  smooth->SetInputData(Lifted(ffdTest::ReadVolume(argc, argv, "engine", 4)));
  smooth->SetResizeMethodToMagnificationFactors();
  smooth->SetMagnificationFactors(2.0, 2.0, 2.0);
  smooth->Update();
  const ffdTest::Transfer ramp = { { 60, 0.3, 0.3, 0.7, 0.0 }, { 100, 0.3, 0.7, 0.6, 0.4 },
    { 150, 0.9, 0.7, 0.3, 0.6 }, { 255, 1.0, 1.0, 1.0, 1.0 } };
  scene.SetInput(smooth->GetOutput());
  CheckDeformed(scene, smooth->GetOutput(), "engine", ramp, checks);
  return checks.Result();
}
