// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Slice blending: the picture is that of vtkImageInterpolator at the points where the viewing rays
// meet the plane, taken back by the inverse of the deformation. That of
// vtkOpenGLGPUVolumeRayCastMapper 9.1 is half a voxel off, so it is compared roughly.
#include "FFDTestBlend.h"

#include "vtkImageInterpolator.h"
#include "vtkMatrix4x4.h"

namespace
{

using Mapper = vtkFFDInverseRayVolumeMapper;

/// What should be seen of a plane through the volume; `pullBack` takes deformed points to rest.
ffdTest::Picture SliceExactly(
  ffdTest::Scene& scene, vtkImageData* image, vtkPlane* plane, vtkAbstractTransform* pullBack)
{
  ffdTest::Picture picture;
  const int* size = scene.Window->GetSize();
  picture.Width = size[0];
  picture.Height = size[1];
  vtkNew<vtkMatrix4x4> toWorld;
  toWorld->DeepCopy(scene.Renderer->GetActiveCamera()->GetCompositeProjectionTransformMatrix(
    static_cast<double>(size[0]) / size[1], -1.0, 1.0));
  toWorld->Invert();
  vtkNew<vtkMatrix4x4> toData;
  scene.Volume->ComputeMatrix();
  vtkMatrix4x4::Invert(scene.Volume->GetMatrix(), toData);
  vtkNew<vtkImageInterpolator> interpolator;
  interpolator->SetInterpolationModeToLinear();
  interpolator->Initialize(image);
  double background[3];
  scene.Renderer->GetBackground(background);
  for (int pixel = 0; pixel < size[0] * size[1]; ++pixel)
  {
    double ends[2][4];
    for (int e = 0; e < 2; ++e)
    {
      const double ndc[4] = { (pixel % size[0] + 0.5) / size[0] * 2.0 - 1.0,
        (pixel / size[0] + 0.5) / size[1] * 2.0 - 1.0, e == 0 ? -1.0 : 1.0, 1.0 };
      toWorld->MultiplyPoint(ndc, ends[e]);
      for (double& x : ends[e])
      {
        x /= ends[e][3];
      }
    }
    double t = 0.0;
    double p[4] = { 0.0, 0.0, 0.0, 1.0 };
    plane->IntersectWithLine(ends[0], ends[1], t, p);
    double rgb[3] = { 0.0, 0.0, 0.0 };
    double opacity = 0.0;
    if (t > 0.0 && t < 1.0)
    {
      double rest[4];
      toData->MultiplyPoint(p, rest);
      if (pullBack)
      {
        const double deformed[3] = { rest[0], rest[1], rest[2] };
        pullBack->TransformPoint(deformed, rest);
      }
      double index[3];
      image->TransformPhysicalPointToContinuousIndex(rest, index);
      const int* dims = image->GetDimensions();
      bool inside = true;
      for (int a = 0; a < 3; ++a)
      {
        inside = inside && index[a] >= 0.0 && index[a] <= dims[a] - 1;
      }
      if (inside)
      {
        const double value = interpolator->Interpolate(rest[0], rest[1], rest[2], 0);
        scene.Property->GetRGBTransferFunction()->GetColor(value, rgb);
        opacity = scene.Property->GetScalarOpacity()->GetValue(value);
      }
    }
    for (int c = 0; c < 3; ++c)
    {
      picture.Rgb.push_back(static_cast<unsigned char>(
        255.0 * (opacity * rgb[c] + (1.0 - opacity) * background[c]) + 0.5));
    }
  }
  return picture;
}

void CheckExactly(ffdTest::Scene& scene, vtkImageData* image, vtkPlane* plane,
  vtkAbstractTransform* pullBack, const std::string& name, ffdTest::Checks& checks)
{
  const ffdTest::Distance d =
    scene.Compare(scene.Render(scene.Ours), SliceExactly(scene, image, plane, pullBack));
  // A pixel on the border of the volume may be in or out.
  checks.Expect(d.Pixels > 1500 && d.Mean <= 0.5 && d.P99 <= 1.0, name,
    ffdTest::ToString(d) + " from the interpolated plane (mean at most 0.5, p99 1)");
}

} // namespace

int TestSlice(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene;
  ffdTest::SetBlendMode(scene, Mapper::SLICE_BLEND);
  const vtkSmartPointer<vtkImageData> image =
    ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "headsq"), 0.0);
  double bounds[6];
  image->GetBounds(bounds);
  const double voxel = image->GetSpacing()[0];
  const ffdTest::Transfer transfer = { { 0, 0.1, 0.1, 0.3, 0.3 }, { 600, 0.9, 0.4, 0.3, 0.9 },
    { 1200, 0.9, 0.9, 0.6, 1.0 }, { 2500, 1.0, 1.0, 1.0, 1.0 } };
  ffdTest::SetTransfer(scene.Property, transfer, 1.0);
  scene.SetInput(image);
  scene.SetCamera({ 40.0, 20.0, 1.0, false, false }, bounds);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(
    0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]), 0.45 * (bounds[4] + bounds[5]));
  plane->SetNormal(0.5, -1.0, 0.7); // any length
  scene.Property->SetSliceFunction(plane);

  ffdTest::Picture pictures[2];
  for (const int shade : { 0, 1 })
  {
    scene.Property->SetShade(shade);
    pictures[shade] = scene.Render(scene.Ours);
  }
  checks.ExpectAtMost("slices are not shaded", scene.Compare(pictures[0], pictures[1]).Max, 0.0);
  scene.Property->ShadeOff();
  CheckExactly(scene, image, plane, nullptr, "slice", checks);
  const ffdTest::Distance d = scene.Compare(pictures[0], scene.Render(scene.Gpu));
  checks.Expect(d.Pixels > 1500 && d.Psnr >= 24.0, "slice, GPU mapper",
    ffdTest::ToString(d) + " (at least 24 dB)");

  // The plane is one of the world: the volume may be turned below it.
  scene.Volume->SetOrientation(10.0, 20.0, 30.0);
  CheckExactly(scene, image, plane, nullptr, "volume turned", checks);
  scene.Volume->SetOrientation(0.0, 0.0, 0.0);

  const vtkSmartPointer<vtkBSplineTransform> transform =
    ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(20.0 * voxel));
  scene.Ours->SetDeformation(transform);
  scene.SetCamera({ 40.0, 20.0, 1.0, false, false }, scene.Ours->GetBounds());
  // Positions are exact up to the tolerance of the inverse.
  scene.Ours->SetInverseTolerance(1e-4);
  CheckExactly(scene, image, plane, transform->GetInverse(), "deformed, EXACT", checks);
  scene.Ours->SetInverseModeToPullBack();
  CheckExactly(scene, image, plane, transform, "deformed, PULL_BACK", checks);
  scene.Ours->SetInverseModeToExact();
  const ffdTest::Picture deformed = scene.Render(scene.Ours);
  ffdTest::CheckLeaping(scene, "deformed", false, checks);

  // The plane is looked at anew.
  plane->SetNormal(1.0, 0.0, 0.0);
  checks.ExpectAtLeast(
    "another plane: mean", scene.Compare(deformed, scene.Render(scene.Ours)).Mean, 10.0);
  // Edge on there is nothing to see.
  double middle[3];
  scene.Renderer->GetActiveCamera()->GetDirectionOfProjection(middle);
  scene.Renderer->GetActiveCamera()->ParallelProjectionOn();
  const double* up = scene.Renderer->GetActiveCamera()->GetViewUp();
  plane->SetNormal(up[1] * middle[2] - up[2] * middle[1], up[2] * middle[0] - up[0] * middle[2],
    up[0] * middle[1] - up[1] * middle[0]);
  const ffdTest::Bytes edge = ffdTest::RenderBytes(scene, 101);
  int visible = 0;
  for (std::size_t i = 3; i < edge.Colors.size(); i += 4)
  {
    visible += edge.Colors[i] > 0 ? 1 : 0;
  }
  checks.ExpectAtMost("plane seen edge on: pixels", visible, 101);
  return checks.Result();
}
