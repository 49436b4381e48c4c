// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Window and level of the finished picture: the formula, and the pictures of VTK's own mappers.
#include "FFDTestBlend.h"
#include "FFDTestHelpers.h"

namespace
{

void SetFinalColor(ffdTest::Scene& scene, double window, double level)
{
  scene.Ours->SetFinalColorWindow(window);
  scene.Ours->SetFinalColorLevel(level);
  scene.Fixed->SetFinalColorWindow(static_cast<float>(window));
  scene.Fixed->SetFinalColorLevel(static_cast<float>(level));
  scene.Gpu->SetFinalColorWindow(static_cast<float>(window));
  scene.Gpu->SetFinalColorLevel(static_cast<float>(level));
}

} // namespace

int TestFinalColor(int argc, char* argv[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene;
  const vtkSmartPointer<vtkImageData> image =
    ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "engine", 2), 0.0);
  ffdTest::SetTransfer(scene.Property, ffdTest::SemiTransparentEngine(), 1.0);
  scene.SetInput(image);
  scene.SetSampleDistance(0.4 * image->GetSpacing()[0]);
  scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, image->GetBounds());
  constexpr int Size = 100;
  const ffdTest::Bytes plain = ffdTest::RenderBytes(scene, Size);
  const ffdTest::Picture before = scene.Render(scene.Ours);
  const double settings[][2] = { { 0.6, 0.5 }, { 1.0, 0.3 }, { 2.0, 0.8 }, { -1.0, 0.5 } };
  for (const double* s : settings)
  {
    SetFinalColor(scene, s[0], s[1]);
    std::ostringstream name;
    name << "window " << s[0] << ", level " << s[1];
    // Bytes are rounded before and after.
    const ffdTest::Bytes bytes = ffdTest::RenderBytes(scene, Size);
    double largest = 0.0;
    for (std::size_t i = 0; i < bytes.Colors.size(); ++i)
    {
      const double alpha = plain.Colors[i / 4 * 4 + 3] / 255.0;
      const double value = i % 4 == 3 ? alpha
        : alpha > 0.05 ? std::clamp((plain.Colors[i] / 255.0 - s[1]) / s[0] + 0.5, 0.0, 1.0)
                       : bytes.Colors[i] / 255.0;
      largest = std::max(largest, std::abs(255.0 * value - bytes.Colors[i]));
    }
    checks.ExpectAtMost(
      name.str() + ", largest distance from the formula", largest, 1.0 + 1.0 / std::abs(s[0]));
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    const ffdTest::Distance toGpu = scene.Compare(ours, scene.Render(scene.Gpu));
    const ffdTest::Distance toFixed = scene.Compare(ours, scene.RenderFixedRays());
    std::ostringstream figures;
    figures << toGpu << " from the GPU mapper, " << toFixed
            << " from the fixed-point mapper (mean at most 2.5)";
    checks.Expect(
      toGpu.Pixels > 1500 && toGpu.Mean <= 2.5 && toFixed.Mean <= 2.5, name.str(), figures.str());
    checks.ExpectAtLeast(name.str() + ", mean change", scene.Compare(before, ours).Mean, 5.0);
  }
  SetFinalColor(scene, 1.0, 0.5);
  checks.ExpectAtMost("reset", scene.Compare(before, scene.Render(scene.Ours)).Max, 0.0);

  vtkNew<FFDErrorLog> errors;
  errors->Watch(scene.Ours);
  scene.Ours->SetFinalColorWindow(0.0);
  bool ok = errors->Had("FinalColorWindow");
  scene.Ours->SetFinalColorWindow(std::nan(""));
  ok = errors->Had("FinalColorWindow") && ok;
  scene.Ours->SetFinalColorLevel(std::nan(""));
  ok = errors->Had("FinalColorLevel") && ok;
  checks.Expect(
    ok && scene.Ours->GetFinalColorWindow() == 1.0 && scene.Ours->GetFinalColorLevel() == 0.5,
    "bad values", "are refused");
  return checks.Result();
}
