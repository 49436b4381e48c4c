// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Cropping to 27 regions: without deformation the pictures of VTK's own mappers; with one, of the
// material (REST) and of deformed space (DEFORMED), those of the resampled volume.
#include "FFDTestBlend.h"

#include "vtkImageExtractComponents.h"

namespace
{

using Mapper = vtkFFDInverseRayVolumeMapper;

struct Regions
{
  std::string Name;
  int Flags;
};

const std::vector<Regions>& AllRegions()
{
  static const std::vector<Regions> regions = { { "subvolume", VTK_CROP_SUBVOLUME },
    { "fence", VTK_CROP_FENCE }, { "inverted fence", VTK_CROP_INVERTED_FENCE },
    { "cross", VTK_CROP_CROSS }, { "inverted cross", VTK_CROP_INVERTED_CROSS },
    { "odd regions", 0x2aaaaaa } };
  return regions;
}

/// Planes at thirds of the bounds, between voxels.
void SetPlanes(vtkVolumeMapper* mapper, const double bounds[6], int flags)
{
  double planes[6];
  for (int a = 0; a < 3; ++a)
  {
    const double size = bounds[2 * a + 1] - bounds[2 * a];
    planes[2 * a] = bounds[2 * a] + 0.31 * size;
    planes[2 * a + 1] = bounds[2 * a] + 0.64 * size;
  }
  mapper->CroppingOn();
  mapper->SetCroppingRegionPlanes(planes);
  mapper->SetCroppingRegionFlags(flags);
}

/// A component for each of AllRegions(): the voxels in regions that are not shown set to 0. All of
/// them together, because resampling inverts the deformation at each voxel.
vtkSmartPointer<vtkImageData> CropVoxels(vtkImageData* image, vtkVolumeMapper* mapper)
{
  auto out = vtkSmartPointer<vtkImageData>::New();
  out->CopyStructure(image);
  const auto components = static_cast<int>(AllRegions().size());
  out->AllocateScalars(VTK_FLOAT, components);
  double planes[6];
  mapper->GetCroppingRegionPlanes(planes);
  for (vtkIdType i = 0; i < out->GetNumberOfPoints(); ++i)
  {
    const double* p = out->GetPoint(i);
    const double value = image->GetPointData()->GetScalars()->GetComponent(i, 0);
    int region = 0;
    for (int a = 2; a >= 0; --a)
    {
      region = 3 * region + (p[a] >= planes[2 * a] ? 1 : 0) + (p[a] >= planes[2 * a + 1] ? 1 : 0);
    }
    for (int c = 0; c < components; ++c)
    {
      const bool shown = (AllRegions()[static_cast<std::size_t>(c)].Flags >> region & 1) != 0;
      out->GetPointData()->GetScalars()->SetComponent(i, c, shown ? value : 0.0);
    }
  }
  return out;
}

} // namespace

int TestCropping(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene(140);
  const vtkSmartPointer<vtkImageData> image =
    ffdTest::AsFloats(ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "engine", 2), 0.0));
  double bounds[6];
  image->GetBounds(bounds);
  const double voxel = image->GetSpacing()[0];
  ffdTest::SetTransfer(scene.Property, ffdTest::SemiTransparentEngine(), 1.0);
  scene.SetInput(image);
  scene.SetSampleDistance(0.4 * voxel);
  scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, bounds);
  const ffdTest::Picture whole = scene.Render(scene.Ours);
  for (const Regions& regions : AllRegions())
  {
    ffdTest::ForAllMappers(scene, [&](vtkVolumeMapper* m) { SetPlanes(m, bounds, regions.Flags); });
    scene.Ours->SetCroppingSpaceToRest();
    const ffdTest::Picture rest = scene.Render(scene.Ours);
    const ffdTest::Picture fixed = scene.RenderFixedRays();
    const ffdTest::Picture gpu = scene.Render(scene.Gpu);
    const ffdTest::Distance toFixed = scene.Compare(rest, fixed);
    const ffdTest::Distance toGpu = scene.Compare(rest, gpu);
    const ffdTest::Distance apart = scene.Compare(gpu, fixed);
    std::ostringstream figures;
    figures << "\n      ours-fixed " << toFixed << "\n      ours-gpu   " << toGpu
            << "\n      gpu-fixed  " << apart;
    // VTK's two mappers are each other's yardstick, as in TestIdentityAgainstVTK.
    checks.Expect(
      toFixed.Pixels > 750 && toFixed.Mean <= apart.Mean && toGpu.Mean <= apart.Mean + 0.3,
      regions.Name + ", no farther from them than they are from each other", figures.str());
    scene.Ours->SetCroppingSpaceToDeformed();
    const ffdTest::Distance spaces = scene.Compare(rest, scene.Render(scene.Ours));
    // Samples on a plane may fall to either side of it.
    checks.Expect(spaces.Mean <= 0.2, regions.Name + ", REST and DEFORMED without deformation",
      ffdTest::ToString(spaces) + " (mean at most 0.2)");
    checks.ExpectAtLeast(regions.Name + ", mean change", scene.Compare(rest, whole).Mean, 2.0);
  }

  const vtkSmartPointer<vtkBSplineTransform> transform =
    ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(20.0 * voxel));
  scene.Ours->SetDeformation(transform);
  const vtkSmartPointer<vtkImageData> voxels = ffdTest::Resample(image, transform, 0.5, 0.0);
  scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, voxels->GetBounds());
  double deformed[6];
  scene.Ours->GetBounds(deformed);
  SetPlanes(scene.Ours, bounds, 0);
  vtkNew<vtkImageExtractComponents> cropped;
  cropped->SetInputData(ffdTest::Resample(CropVoxels(image, scene.Ours), transform, 0.5, 0.0));
  for (std::size_t r = 0; r < AllRegions().size(); ++r)
  {
    const Regions& regions = AllRegions()[r];
    scene.Ours->SetCroppingSpaceToRest();
    SetPlanes(scene.Ours, bounds, regions.Flags);
    scene.Gpu->CroppingOff();
    // Voxels smear the faces of the regions, most where these are seen through many of them.
    cropped->SetComponents(static_cast<int>(r));
    cropped->Update();
    scene.Gpu->SetInputData(cropped->GetOutput());
    const ffdTest::Picture rest = scene.Render(scene.Ours);
    const ffdTest::Distance material = scene.Compare(rest, scene.Render(scene.Gpu));
    checks.Expect(material.Pixels > 750 && material.Psnr >= 24.0, regions.Name + ", deformed, REST",
      ffdTest::ToString(material) + " from the resampled cropped volume (at least 24 dB)");
    ffdTest::CheckLeaping(scene, regions.Name + ", REST", true, checks);

    scene.Ours->SetCroppingSpaceToDeformed();
    scene.Gpu->SetInputData(voxels);
    SetPlanes(scene.Ours, deformed, regions.Flags);
    SetPlanes(scene.Gpu, deformed, regions.Flags);
    const ffdTest::Picture space = scene.Render(scene.Ours);
    const ffdTest::Distance cut = scene.Compare(space, scene.Render(scene.Gpu));
    checks.Expect(cut.Pixels > 750 && cut.Psnr >= 30.0, regions.Name + ", deformed, DEFORMED",
      ffdTest::ToString(cut) + " from the resampled volume, cropped (at least 30 dB)");
    ffdTest::CheckLeaping(scene, regions.Name + ", DEFORMED", true, checks);
    checks.ExpectAtLeast(
      regions.Name + ", REST is not DEFORMED: mean", scene.Compare(rest, space).Mean, 1.0);
    scene.Ours->ReferenceKernelsOn();
    const ffdTest::Distance kernels = scene.Compare(space, scene.Render(scene.Ours));
    scene.Ours->ReferenceKernelsOff();
    checks.Expect(kernels.Mean <= 0.2, regions.Name + ", reference kernels",
      ffdTest::ToString(kernels) + " (mean at most 0.2)");
  }
  // No region, nothing to see.
  scene.Ours->SetCroppingRegionFlags(0);
  const ffdTest::Bytes none = ffdTest::RenderBytes(scene, 60);
  checks.ExpectAtMost("no region: largest byte",
    none.Colors.empty() ? 256 : *std::max_element(none.Colors.begin(), none.Colors.end()), 0);
  return checks.Result();
}
