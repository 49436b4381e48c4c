// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Isosurface blending: without deformation the picture of vtkOpenGLGPUVolumeRayCastMapper, with one
// that of the resampled volume, and of the polygons of the same surface moved by the deformation.
// (Closed forms of single rays: Kernels.TestRayCaster.)
#include "FFDTestBlend.h"

#include "vtkActor.h"
#include "vtkFFDDeformGeometry.h"
#include "vtkFFDLattice.h"
#include "vtkFlyingEdges3D.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"

namespace
{

using Mapper = vtkFFDInverseRayVolumeMapper;

void SetValues(vtkVolumeProperty* property, const std::vector<double>& values)
{
  property->GetIsoSurfaceValues()->SetNumberOfContours(static_cast<int>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    property->GetIsoSurfaceValues()->SetValue(static_cast<int>(i), values[i]);
  }
}

void CheckAgainstGpu(
  ffdTest::Scene& scene, const std::string& name, double decibels, ffdTest::Checks& checks)
{
  for (const bool shade : { false, true })
  {
    scene.Property->SetShade(shade ? 1 : 0);
    const ffdTest::Distance d = scene.Compare(scene.Render(scene.Ours), scene.Render(scene.Gpu));
    std::ostringstream figures;
    figures << d << " from the GPU mapper (at least " << decibels << " dB)";
    checks.Expect(d.Pixels > 1500 && d.Psnr >= decibels, name + (shade ? ", shaded" : ", unshaded"),
      figures.str());
  }
}

/// Window depths of the deformed polygons of the surface, which VTK draws, against ours.
void CheckDepths(ffdTest::Scene& scene, vtkImageData* image, vtkFFDLattice* lattice, double value,
  ffdTest::Checks& checks)
{
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(image);
  contour->SetValue(0, value);
  vtkNew<vtkFFDDeformGeometry> deform;
  deform->SetInputConnection(contour->GetOutputPort());
  deform->SetDeformation(lattice);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(deform->GetOutputPort());
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  scene.Renderer->AddActor(actor);
  scene.Volume->VisibilityOff();
  scene.Window->Render();
  const int* size = scene.Window->GetSize();
  std::vector<float> drawn(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]));
  scene.Window->GetZbufferData(0, 0, size[0] - 1, size[1] - 1, drawn.data());
  scene.Renderer->RemoveActor(actor);
  scene.Volume->VisibilityOn();

  vtkNew<vtkImageData> colors;
  vtkNew<vtkImageData> depths;
  scene.Ours->RenderToImage(scene.Renderer, scene.Volume, size[0], size[1], colors, depths);
  const auto* ours = static_cast<const float*>(depths->GetScalarPointer());
  double range[2];
  scene.Renderer->GetActiveCamera()->GetClippingRange(range);
  const double voxel = image->GetSpacing()[0];
  std::vector<double> apart; // world units along the view
  int edges = 0;
  const auto linear = [&](double z) {
    return range[0] * range[1] / (range[1] - z * (range[1] - range[0]));
  };
  for (std::size_t i = 0; i < drawn.size(); ++i)
  {
    const bool both = drawn[i] < 1.0f && ours[i] < 1.0f;
    edges += (drawn[i] < 1.0f) != (ours[i] < 1.0f) ? 1 : 0;
    if (both)
    {
      apart.push_back(std::abs(linear(drawn[i]) - linear(ours[i])) / voxel);
    }
  }
  std::sort(apart.begin(), apart.end());
  const double median = apart.empty() ? 1e9 : apart[apart.size() / 2];
  const double p90 = apart.empty() ? 1e9 : apart[apart.size() * 9 / 10];
  std::ostringstream figures;
  figures << "median " << median << " voxels (at most 0.05), 90th percentile " << p90
          << " (at most 0.3), " << apart.size() << " px, on one only " << edges;
  checks.Expect(apart.size() > 5000 && median <= 0.05 && p90 <= 0.3 &&
      edges < static_cast<int>(apart.size() / 20),
    "depths of the deformed polygons", figures.str());
}

} // namespace

int TestIsoSurface(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene(140);
  ffdTest::SetBlendMode(scene, Mapper::ISOSURFACE_BLEND);
  const vtkSmartPointer<vtkImageData> image =
    ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "headsq"), 0.0);
  double bounds[6];
  image->GetBounds(bounds);
  const double voxel = image->GetSpacing()[0];
  const ffdTest::Transfer transfer = { { 400, 0.9, 0.6, 0.5, 0.4 }, { 1100, 0.9, 0.7, 0.6, 0.4 },
    { 1150, 1.0, 1.0, 0.9, 1.0 }, { 2500, 1.0, 1.0, 0.9, 1.0 } };
  ffdTest::SetTransfer(scene.Property, transfer, 1.0);
  scene.SetShadingAsGpuMapper(0.2, 0.7, 0.2, 10.0);
  scene.SetInput(image);
  scene.SetSampleDistance(0.25 * voxel);
  scene.SetCamera({ 40.0, 20.0, 1.0, false, false }, bounds);

  SetValues(scene.Property, { 1150.0 });
  CheckAgainstGpu(scene, "bone, opaque", 24.0, checks);
  SetValues(scene.Property, { 1150.0, 500.5 });
  CheckAgainstGpu(scene, "skin and bone", 24.0, checks);
  const ffdTest::Picture both = scene.Render(scene.Ours);

  // Sample intervals are cut exactly: fewer samples, the same surface.
  scene.SetSampleDistance(0.05 * voxel);
  const ffdTest::Picture fine = scene.Render(scene.Ours);
  scene.SetSampleDistance(0.5 * voxel);
  const ffdTest::Distance steps = scene.Compare(fine, scene.Render(scene.Ours));
  checks.Expect(steps.Psnr >= 30.0, "long sample intervals",
    ffdTest::ToString(steps) + " from ten times as many samples (at least 30 dB)");
  scene.SetSampleDistance(0.25 * voxel);

  // Order and repetition of the values do not matter; the range of the data does not bound them.
  SetValues(scene.Property, { 500.5, 1150.0, 500.5, 1e6, -1e6 });
  checks.ExpectAtMost(
    "values in another order", scene.Compare(both, scene.Render(scene.Ours)).Max, 0.0);
  SetValues(scene.Property, { 500.5 });
  checks.ExpectAtLeast(
    "one value less: mean", scene.Compare(both, scene.Render(scene.Ours)).Mean, 1.0);
  SetValues(scene.Property, { 1e6 });
  checks.Expect(
    scene.Compare(both, scene.Render(scene.Ours)).Pixels > 0 &&
      [&] {
        const ffdTest::Bytes none = ffdTest::RenderBytes(scene, 100);
        return !none.Colors.empty() &&
          *std::max_element(none.Colors.begin(), none.Colors.end()) == 0;
      }(),
    "a value that nothing has", "nothing is drawn");

  // Deformed.
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(8, 8, 8);
  lattice->FitToBounds(bounds, 0.0);
  for (int k = 0; k < 8; ++k)
  {
    for (int j = 0; j < 8; ++j)
    {
      for (int i = 0; i < 8; ++i)
      {
        const ffdTest::Vec3 d =
          ffdTest::BendAndWaves(15.0 * voxel)({}, { (i - 1) / 5.0, (j - 1) / 5.0, (k - 1) / 5.0 });
        lattice->SetDisplacement(i, j, k, d[0], d[1], d[2]);
      }
    }
  }
  scene.Ours->SetDeformation(lattice);
  scene.SetCamera({ 40.0, 20.0, 1.0, false, false }, scene.Ours->GetBounds());
  SetValues(scene.Property, { 1150.0, 500.5 });
  const vtkSmartPointer<vtkImageData> voxels = ffdTest::Resample(image, lattice, 0.5, 0.0);
  scene.Gpu->SetInputData(voxels);
  CheckAgainstGpu(scene, "deformed, skin and bone", 22.0, checks);
  for (const int segmentation : { Mapper::ERROR_BOUND, Mapper::GREEDY_ANGLE })
  {
    scene.Ours->SetSegmentation(segmentation);
    ffdTest::CheckLeaping(
      scene, std::string("deformed, ") + scene.Ours->GetSegmentationAsString(), true, checks);
  }
  scene.Ours->SetSegmentationToErrorBound();
  scene.Ours->ReferenceKernelsOn();
  const ffdTest::Picture reference = scene.Render(scene.Ours);
  scene.Ours->ReferenceKernelsOff();
  const ffdTest::Distance kernels = scene.Compare(reference, scene.Render(scene.Ours));
  checks.Expect(kernels.Mean <= 0.3, "deformed, reference kernels",
    ffdTest::ToString(kernels) + " (mean at most 0.3)");
  ffdTest::SetTransfer(scene.Property, { { 0, 1, 1, 1, 1.0 }, { 2500, 1, 1, 1, 1.0 } }, 1.0);
  SetValues(scene.Property, { 500.5 });
  CheckDepths(scene, image, lattice, 500.5, checks);
  return checks.Result();
}
