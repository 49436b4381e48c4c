// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Over black, premultiplied images are the picture in the window: in every blend mode, with 1 to 4
// components, where bright lights make colors brighter than their alpha.
#include "FFDTestOptics.h"

#include "vtkContourValues.h"
#include "vtkPlane.h"

namespace
{

constexpr int Size = 70;

/// Largest difference of the window over black from the colors of an RGBA image, times alpha
/// where they are straight; 256 without an image or if the window is black.
int CompareWithWindow(ffdTest::Scene& scene, bool premultiplied)
{
  scene.Ours->SetPremultipliedAlpha(premultiplied);
  const std::vector<unsigned char> rgba = ffdTest::RenderRgba(scene, Size);
  const ffdTest::Picture window = scene.Render(scene.Ours);
  if (4 * window.Rgb.size() != 3 * rgba.size() ||
    *std::max_element(window.Rgb.begin(), window.Rgb.end()) < 15)
  {
    return 256;
  }
  int largest = 0;
  for (std::size_t i = 0; i < window.Rgb.size(); ++i)
  {
    const std::size_t pixel = i / 3 * 4;
    const double alpha = premultiplied ? 1.0 : rgba[pixel + 3] / 255.0;
    const int byte = static_cast<int>(std::lround(rgba[pixel + i % 3] * alpha));
    largest = std::max(largest, std::abs(byte - window.Rgb[i]));
  }
  return largest;
}

} // namespace

int TestRenderToImage(int, char*[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene;
  scene.Window->SetSize(Size, Size);
  scene.Renderer->SetBackground(0.0, 0.0, 0.0);
  scene.Headlight->SetIntensity(1.6);
  scene.SetShading(0.2, 0.8, 0.6, 8.0);
  scene.Property->GetIsoSurfaceValues()->SetValue(0, 110.0);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(16.0, 15.0, 14.0);
  plane->SetNormal(1.0, -1.0, 0.5);
  scene.Property->SetSliceFunction(plane);
  const ffdTest::Transfer functions[4] = {
    { { 0, 0.1, 0.2, 0.9, 0.0 }, { 120, 0.9, 0.5, 0.1, 0.1 }, { 255, 1.0, 1.0, 1.0, 0.6 } },
    { { 0, 0.9, 0.2, 0.1, 0.0 }, { 255, 0.5, 1.0, 0.2, 0.3 } },
    { { 0, 0.1, 0.9, 0.9, 0.0 }, { 255, 1.0, 0.2, 0.9, 0.2 } },
    { { 0, 0.9, 0.9, 0.2, 0.0 }, { 255, 0.9, 0.9, 1.0, 0.4 } },
  };
  const auto setFunctions = [&](bool composite) {
    for (int c = 0; c < 4; ++c)
    {
      ffdTest::Transfer points = functions[c];
      for (std::array<double, 5>& point : points)
      {
        // A single sample shows more: surfaces, slices, the least value.
        point[4] += composite ? 0.0 : 0.3;
      }
      ffdTest::SetComponent(scene.Property, c, points, 3.0);
      scene.Property->SetShade(c, 1);
      scene.Property->SetSpecular(c, 0.6);
    }
  };
  int lost = 0;
  for (int components = 1; components <= 4; ++components)
  {
    const vtkSmartPointer<vtkImageData> image =
      ffdTest::MakeImage(32, VTK_UNSIGNED_CHAR, components,
        [](int c, const ffdTest::Vec3& p) { return 60.0 + 0.75 * ffdTest::FourFields(c, p); });
    scene.SetInput(image);
    const vtkSmartPointer<vtkBSplineTransform> bend =
      ffdTest::MakeTransform(image->GetBounds(), 7, ffdTest::BendAndWaves(4.0));
    scene.Ours->SetDeformation(bend);
    scene.SetCamera({ 30.0, 30.0, 1.2, false, false }, scene.Ours->GetBounds());
    for (const bool independent : { true, false })
    {
      if (components == 1 && !independent)
      {
        continue;
      }
      scene.Property->SetIndependentComponents(independent);
      for (int mode = vtkVolumeMapper::COMPOSITE_BLEND; mode <= vtkVolumeMapper::SLICE_BLEND;
           ++mode)
      {
        scene.Ours->SetBlendMode(mode);
        setFunctions(mode == vtkVolumeMapper::COMPOSITE_BLEND);
        std::ostringstream name;
        name << components << (independent ? " independent" : " dependent")
             << " components, blend mode " << mode;
        name << ", premultiplied against the window";
        checks.ExpectAtMost(name.str(), CompareWithWindow(scene, true), 1);
        scene.Ours->SetFinalColorWindow(0.7);
        scene.Ours->SetFinalColorLevel(0.2);
        name << ", window and level";
        checks.ExpectAtMost(name.str(), CompareWithWindow(scene, true), 1);
        scene.Ours->SetFinalColorWindow(1.0);
        scene.Ours->SetFinalColorLevel(0.5);
        if (mode == vtkVolumeMapper::COMPOSITE_BLEND)
        {
          lost = std::max(lost, CompareWithWindow(scene, false));
        }
      }
    }
  }
  checks.ExpectAtLeast("what straight alpha loses", lost, 30);
  return checks.Result();
}
