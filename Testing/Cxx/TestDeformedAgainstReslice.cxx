// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The picture of the deformed volume is that of the volume resampled by vtkImageReslice through
// the pull-back of the mode, at twice the resolution, and rendered by VTK's GPU mapper:
//   EXACT        the inverse of T
//   PULL_BACK    T itself
//   FIRST_ORDER  P -> 2P - T(P): the transform with the opposite displacements
// An affine control net is the same as a matrix of the vtkVolume.
#include "FFDTestScenes.h"

#include "vtkAbstractTransform.h"
#include "vtkGridTransform.h"
#include "vtkImageReslice.h"
#include "vtkMatrix4x4.h"
#include "vtkTransformToGrid.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace
{

/// `image` resampled through `pullBack` at twice its resolution, over `bounds`. VTK's inverse of a
/// B-spline takes far longer than all the rest: it is asked for at the voxels, and interpolated
/// linearly between these with the error that is returned, in voxels.
vtkSmartPointer<vtkImageData> Resample(vtkImageData* image, vtkAbstractTransform* pullBack,
  const double bounds[6], double background, double& error)
{
  double spacing[3];
  double origin[3];
  int extent[6];
  image->GetSpacing(spacing);
  image->GetOrigin(origin);
  for (int a = 0; a < 3; ++a)
  {
    spacing[a] *= 0.5;
    // Onto the voxels of the input: where nothing is deformed nothing is smoothed.
    const double first = std::floor((bounds[2 * a] - origin[a]) / spacing[a]) - 2;
    const double last = std::ceil((bounds[2 * a + 1] - origin[a]) / spacing[a]) + 2;
    extent[2 * a] = 0;
    extent[2 * a + 1] = static_cast<int>(last - first);
    origin[a] += first * spacing[a];
  }
  vtkNew<vtkTransformToGrid> tabulate;
  tabulate->SetInput(pullBack);
  tabulate->SetGridScalarTypeToFloat();
  tabulate->SetGridOrigin(origin);
  tabulate->SetGridSpacing(2.0 * spacing[0], 2.0 * spacing[1], 2.0 * spacing[2]);
  tabulate->SetGridExtent(0, extent[1] / 2 + 1, 0, extent[3] / 2 + 1, 0, extent[5] / 2 + 1);
  vtkNew<vtkGridTransform> grid;
  grid->SetDisplacementGridConnection(tabulate->GetOutputPort());
  grid->SetInterpolationModeToLinear();
  grid->Update();
  error = 0.0;
  for (int i = 0; i < 1000; ++i)
  {
    double at[3];
    double exact[3];
    double tabulated[3];
    for (int a = 0; a < 3; ++a)
    {
      // A sequence that fills the box.
      const double fraction = std::fmod((0.61803398875 + 0.13721 * a) * (i + 1), 1.0);
      at[a] = origin[a] + spacing[a] * fraction * extent[2 * a + 1];
    }
    pullBack->TransformPoint(at, exact);
    grid->TransformPoint(at, tabulated);
    error = std::max(error,
      std::sqrt(vtkMath::Distance2BetweenPoints(exact, tabulated)) /
        (2.0 * *std::min_element(spacing, spacing + 3)));
  }
  vtkNew<vtkImageReslice> reslice;
  reslice->SetInputData(image);
  reslice->SetResliceTransform(grid);
  reslice->SetInterpolationModeToLinear();
  reslice->SetOutputSpacing(spacing);
  reslice->SetOutputOrigin(origin);
  reslice->SetOutputExtent(extent);
  reslice->SetBackgroundLevel(background);
  reslice->BorderOff();
  // Rounded to whole numbers twice the picture would be noisier than what is compared.
  reslice->SetOutputScalarType(VTK_FLOAT);
  reslice->Update();
  return reslice->GetOutput();
}

struct Subject
{
  std::string Name;
  vtkSmartPointer<vtkImageData> Image;
  ffdTest::Transfer Points;
  double Background; // a transparent scalar
  double Unit;
  ffdTest::View Camera;
};

double FindVoxel(vtkImageData* image)
{
  return *std::min_element(image->GetSpacing(), image->GetSpacing() + 3);
}

/// Ours with `deformation` against the GPU mapper's of `reference`; decibels, unshaded and shaded.
void CheckAgainst(ffdTest::Scene& scene, const Subject& s, vtkAbstractTransform* deformation,
  int mode, vtkImageData* reference, const std::string& name, const double undeformed[2],
  ffdTest::Checks& checks)
{
  scene.SetInput(s.Image);
  scene.Ours->SetDeformation(deformation);
  scene.Ours->SetInverseMode(mode);
  scene.Gpu->SetInputData(reference);
  scene.SetCamera(s.Camera, reference->GetBounds());
  for (const bool shaded : { false, true })
  {
    scene.Property->SetShade(shaded ? 1 : 0);
    const ffdTest::Distance d = scene.Compare(scene.Render(scene.Ours), scene.Render(scene.Gpu));
    const double limit = shaded ? undeformed[1] - 3.0 : 30.0;
    std::ostringstream figures;
    figures << d << " (at least " << limit << " dB; undeformed " << undeformed[shaded ? 1 : 0]
            << " dB)";
    checks.Expect(d.Pixels > 1500 && d.Psnr >= limit,
      s.Name + ", " + name + (shaded ? ", shaded" : ", unshaded"), figures.str());
  }
}

void CheckModes(ffdTest::Scene& scene, const Subject& s, ffdTest::Checks& checks)
{
  double bounds[6];
  s.Image->GetBounds(bounds);
  const double voxel = FindVoxel(s.Image);
  ffdTest::SetTransfer(scene.Property, s.Points, s.Unit);
  scene.SetShadingAsGpuMapper(0.1, 0.7, 0.2, 10.0);
  scene.SetSampleDistance(0.5 * voxel);

  const auto resample = [&](vtkAbstractTransform* pullBack, const double box[6],
                          const std::string& name) {
    double error;
    const vtkSmartPointer<vtkImageData> resampled =
      Resample(s.Image, pullBack, box, s.Background, error);
    checks.ExpectAtMost(s.Name + ", " + name + ", error of the tabulated map, voxels", error, 0.05);
    return resampled;
  };

  // What can be reached: both pictures undeformed, the reference resampled all the same.
  const vtkSmartPointer<vtkBSplineTransform> identity =
    ffdTest::MakeTransform(bounds, 4, [](const ffdTest::Vec3&, const ffdTest::Vec3&) {
      return ffdTest::Vec3{ 0.0, 0.0, 0.0 };
    });
  const vtkSmartPointer<vtkImageData> same = resample(identity, bounds, "identity");
  scene.SetInput(s.Image);
  scene.Ours->SetDeformation(nullptr);
  scene.Gpu->SetInputData(same);
  scene.SetCamera(s.Camera, same->GetBounds());
  double undeformed[2];
  for (int shade = 0; shade < 2; ++shade)
  {
    scene.Property->SetShade(shade);
    undeformed[shade] = scene.Compare(scene.Render(scene.Ours), scene.Render(scene.Gpu)).Psnr;
  }

  const vtkSmartPointer<vtkBSplineTransform> transform =
    ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(20.0 * voxel));
  checks.ExpectAtLeast(s.Name + ", smallest determinant of the Jacobian (no folds)",
    ffdTest::FindSmallestDeterminant(transform, bounds), 0.1);

  using Mapper = vtkFFDInverseRayVolumeMapper;
  double deformed[6];
  scene.Ours->SetDeformation(transform);
  scene.Ours->SetInverseMode(Mapper::EXACT);
  scene.Ours->GetBounds(deformed);
  const vtkSmartPointer<vtkImageData> exact = resample(transform->GetInverse(), deformed, "EXACT");
  CheckAgainst(scene, s, transform, Mapper::EXACT, exact, "EXACT", undeformed, checks);

  scene.Ours->SetInverseMode(Mapper::PULL_BACK);
  scene.Ours->GetBounds(deformed);
  const vtkSmartPointer<vtkImageData> pulled = resample(transform, deformed, "PULL_BACK");
  CheckAgainst(scene, s, transform, Mapper::PULL_BACK, pulled, "PULL_BACK", undeformed, checks);
  // The inverse of the inverse: the same map reached through vtkAbstractTransform::GetInverse.
  const ffdTest::Picture pullBack = scene.Render(scene.Ours);
  scene.Ours->SetDeformation(transform->GetInverse());
  scene.Ours->SetInverseMode(Mapper::EXACT);
  const ffdTest::Distance inverted = scene.Compare(pullBack, scene.Render(scene.Ours));
  checks.Expect(inverted.Pixels > 1500 && inverted.Max == 0.0,
    s.Name + ", EXACT of the inverted transform is PULL_BACK of the original",
    ffdTest::ToString(inverted) + " (bit by bit)");

  scene.Ours->SetDeformation(transform);
  scene.Ours->SetInverseMode(Mapper::FIRST_ORDER);
  scene.Ours->GetBounds(deformed);
  const vtkSmartPointer<vtkImageData> first =
    resample(ffdTest::Scaled(transform, -1.0), deformed, "FIRST_ORDER");
  CheckAgainst(scene, s, transform, Mapper::FIRST_ORDER, first, "FIRST_ORDER", undeformed, checks);

  // The three modes are three different pictures, or the above would prove little.
  scene.Gpu->SetInputData(exact);
  scene.SetCamera(s.Camera, exact->GetBounds());
  scene.Property->ShadeOff();
  const ffdTest::Picture reference = scene.Render(scene.Gpu);
  for (const int mode :
    { static_cast<int>(Mapper::PULL_BACK), static_cast<int>(Mapper::FIRST_ORDER) })
  {
    scene.Ours->SetInverseMode(mode);
    checks.ExpectAtMost(s.Name + ", " + scene.Ours->GetInverseModeAsString() + " is not EXACT: dB",
      scene.Compare(scene.Render(scene.Ours), reference).Psnr, 28.0);
  }
  scene.Ours->SetInverseMode(Mapper::EXACT);
}

/// An affine net is the same volume under a user matrix, if opacities are those of lengths at rest:
/// under a matrix VTK's mappers, and ours, measure lengths before it. vtkGPUVolumeRayCastMapper
/// lights shaded pictures rightly only if `linear` keeps angles.
void CheckAffine(ffdTest::Scene& scene, const Subject& s, const std::string& map,
  const double (&linear)[3][3], bool keepsAngles, ffdTest::Checks& checks)
{
  double bounds[6];
  s.Image->GetBounds(bounds);
  const double middle[3] = { 0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]),
    0.5 * (bounds[4] + bounds[5]) };
  const double shift[3] = { 5.0, -8.0, 3.0 };
  vtkNew<vtkMatrix4x4> matrix;
  for (int r = 0; r < 3; ++r)
  {
    double moved = middle[r] + shift[r];
    for (int c = 0; c < 3; ++c)
    {
      matrix->SetElement(r, c, linear[r][c]);
      moved -= linear[r][c] * middle[c];
    }
    matrix->SetElement(r, 3, moved);
  }
  const vtkSmartPointer<vtkBSplineTransform> transform = ffdTest::MakeTransform(
    bounds, 9,
    [&](const ffdTest::Vec3& p, const ffdTest::Vec3&) {
      double out[4];
      const double in[4] = { p[0], p[1], p[2], 1.0 };
      matrix->MultiplyPoint(in, out);
      return ffdTest::Vec3{ out[0] - p[0], out[1] - p[1], out[2] - p[2] };
    },
    0.5);

  ffdTest::SetTransfer(scene.Property, s.Points, s.Unit);
  scene.SetShadingAsGpuMapper(0.1, 0.7, 0.2, 10.0);
  scene.SetInput(s.Image);
  // Short: the net is sampled by length on the viewing ray, the user matrix by that before it, and
  // the samples of each begin where the ray meets another volume at rest.
  scene.Ours->SetOpacityLengthToMaterial();
  scene.SetSampleDistance(0.1 * FindVoxel(s.Image));
  scene.Ours->SetInverseMode(vtkFFDInverseRayVolumeMapper::EXACT);
  scene.Ours->SetDeformation(transform);
  scene.SetCamera(s.Camera, scene.Ours->GetBounds());
  for (const bool shaded : { false, true })
  {
    scene.Property->SetShade(shaded ? 1 : 0);
    const std::string name = s.Name + ", " + map + (shaded ? ", shaded" : ", unshaded");
    scene.Ours->SetDeformation(transform);
    const ffdTest::Picture net = scene.Render(scene.Ours);
    scene.Ours->SetDeformation(nullptr);
    scene.Volume->SetUserMatrix(matrix);
    const ffdTest::Picture user = scene.Render(scene.Ours);
    const ffdTest::Picture gpu = scene.Render(scene.Gpu);
    scene.Volume->SetUserMatrix(nullptr);
    const ffdTest::Distance ours = scene.Compare(net, user);
    // The inverse is exact up to InverseTolerance, a hundredth of a voxel; the rest is sampling.
    checks.Expect(ours.Pixels > 1500 && ours.Mean <= 0.4, name + " is the user matrix",
      ffdTest::ToString(ours) + " (mean at most 0.4)");
    if (shaded && !keepsAngles)
    {
      continue;
    }
    const ffdTest::Distance theirs = scene.Compare(net, gpu);
    checks.Expect(theirs.Psnr >= 44.0, name + " is the GPU mapper's user matrix",
      ffdTest::ToString(theirs) + " (at least 44 dB)");
    // VTK's mappers take other samples, see TestIdentityAgainstVTK.
    std::cout << "      user matrix, ours-gpu " << scene.Compare(user, gpu) << "\n";
  }
  scene.Ours->SetOpacityLengthToWorld();
}

void CheckAffine(ffdTest::Scene& scene, const Subject& s, ffdTest::Checks& checks)
{
  // A turn, a stretch and a shear about the middle, and a shift.
  const double sheared[3][3] = { { 1.1, 0.25, -0.1 }, { -0.2, 0.9, 0.15 }, { 0.1, 0.05, 1.2 } };
  CheckAffine(scene, s, "sheared net", sheared, false, checks);
  // A turn about z, and everything a quarter larger.
  const double c = 1.25 * std::cos(0.4);
  const double d = 1.25 * std::sin(0.4);
  const double turned[3][3] = { { c, -d, 0.0 }, { d, c, 0.0 }, { 0.0, 0.0, 1.25 } };
  CheckAffine(scene, s, "turned and grown net", turned, true, checks);
}

} // namespace

int TestDeformedAgainstReslice(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene(140);
  const Subject engine = { "engine",
    ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "engine", 2), 0.0),
    ffdTest::SemiTransparentEngine(), 0.0, 1.0, { 30.0, 30.0, 1.0, false, false } };
  const Subject head = { "headsq", ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "headsq"), 0.0),
    ffdTest::HeadsqSoft(), 0.0, 2.0, { -40.0, 15.0, 1.0, true, false } };
  CheckModes(scene, engine, checks);
  CheckModes(scene, head, checks);
  CheckAffine(scene, engine, checks);
  CheckAffine(scene, head, checks);
  return checks.Result();
}
