// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Binary masks and label maps, which move with the deformation. Undeformed against
// vtkGPUVolumeRayCastMapper, with equal settings.
#include "FFDTestOptics.h"

namespace
{

double Labels(int, const ffdTest::Vec3& p)
{
  return p[0] < 0.35 ? 0.0 : p[2] < 0.45 ? 1.0 : p[1] < 0.5 ? 2.0 : 3.0;
}

double Inside(int, const ffdTest::Vec3& p) { return p[0] + 0.4 * p[1] > 0.6 ? 255.0 : 0.0; }

struct Fixture
{
  ffdTest::Scene Scene;
  vtkSmartPointer<vtkImageData> Image = ffdTest::MakeImage(40, VTK_UNSIGNED_CHAR, 1,
    [](int, const ffdTest::Vec3& p) { return ffdTest::FourFields(3, p); });

  Fixture()
  {
    this->Scene.SetInput(this->Image);
    this->Scene.SetCamera({ 30.0, 25.0, 1.0, true, false }, this->Image->GetBounds());
    ffdTest::SetTransfer(this->Scene.Property,
      { { 10, 1.0, 0.8, 0.2, 0.0 }, { 120, 1.0, 0.6, 0.2, 0.1 }, { 255, 1.0, 0.9, 0.8, 0.3 } },
      1.0);
  }
  void SetMask(vtkImageData* mask, int type)
  {
    this->Scene.Ours->SetMaskInput(mask);
    this->Scene.Ours->SetMaskType(type);
    this->Scene.Gpu->SetMaskInput(mask);
    this->Scene.Gpu->SetMaskType(type);
  }
  void SetBlend(float factor)
  {
    this->Scene.Ours->SetMaskBlendFactor(factor);
    this->Scene.Gpu->SetMaskBlendFactor(factor);
  }
  ffdTest::Picture CheckAgainstGpu(const std::string& name, double limit, ffdTest::Checks& checks)
  {
    const ffdTest::Picture ours = this->Scene.Render(this->Scene.Ours);
    // VTK 9.1's GPU mapper keeps its shader when properties change.
    this->Scene.Gpu->Modified();
    this->Scene.Property->Modified();
    const ffdTest::Distance d = this->Scene.Compare(ours, this->Scene.Render(this->Scene.Gpu));
    std::ostringstream figures;
    figures << d << " from the GPU mapper (mean at most " << limit << ")";
    checks.Expect(d.Pixels > 1000 && d.Mean <= limit, name, figures.str());
    return ours;
  }
};

void SetLabel(vtkVolumeProperty* property, int label, double r, double g, double b, double opacity)
{
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0.0, 0.5 * r, 0.5 * g, 0.5 * b);
  color->AddRGBPoint(255.0, r, g, b);
  vtkNew<vtkPiecewiseFunction> function;
  function->AddPoint(10.0, 0.0);
  function->AddPoint(255.0, opacity);
  property->SetLabelColor(label, color);
  property->SetLabelScalarOpacity(label, function);
}

void CheckBinary(ffdTest::Checks& checks)
{
  Fixture f;
  const ffdTest::Picture all = f.Scene.Render(f.Scene.Ours);
  const auto mask = ffdTest::MakeImage(40, VTK_UNSIGNED_CHAR, 1, Inside);
  f.SetMask(mask, vtkGPUVolumeRayCastMapper::BinaryMaskType);
  const ffdTest::Picture part = f.CheckAgainstGpu("binary mask", 3.0, checks);
  checks.ExpectAtLeast("binary mask, matters", f.Scene.Compare(all, part).Mean, 20.0);
  ffdTest::CheckSamePictures(f.Scene, "binary mask", checks);
  f.Scene.SetShadingAsGpuMapper(0.2, 0.7, 0.3, 20.0);
  f.CheckAgainstGpu("binary mask, shaded", 4.0, checks);
  f.Scene.Property->ShadeOff();

  // Another grid at the same place, twice as fine, hides the same but for the steps of its edge.
  const auto fine =
    ffdTest::MakeImage(79, VTK_SHORT, 1, Inside, { 39.0 / 78.0, 39.0 / 78.0, 39.0 / 78.0 });
  f.Scene.Ours->SetMaskInput(fine);
  const ffdTest::Distance apart = f.Scene.Compare(part, f.Scene.Render(f.Scene.Ours));
  checks.Expect(apart.Pixels > 1000 && apart.Mean <= 6.0 && apart.Max > 0.0, "finer mask",
    ffdTest::ToString(apart) + " from the mask voxel by voxel (mean at most 6)");
  // Nothing is seen beyond a mask that covers a corner only.
  const auto small =
    ffdTest::MakeImage(11, VTK_UNSIGNED_CHAR, 1, [](int, const ffdTest::Vec3&) { return 1.0; });
  small->SetOrigin(14.0, 14.0, 14.0);
  f.Scene.Ours->SetMaskInput(small);
  const ffdTest::Picture corner = f.Scene.Render(f.Scene.Ours);
  const auto same = ffdTest::MakeImage(40, VTK_UNSIGNED_CHAR, 1, [](int, const ffdTest::Vec3& p) {
    return std::all_of(
             p.begin(), p.end(), [](double x) { return x * 39.0 > 13.5 && x * 39.0 < 24.5; })
      ? 1.0
      : 0.0;
  });
  f.Scene.Ours->SetMaskInput(same);
  const ffdTest::Distance boxes = f.Scene.Compare(corner, f.Scene.Render(f.Scene.Ours));
  checks.Expect(boxes.Pixels > 250 && boxes.Max <= 1.0, "smaller mask",
    ffdTest::ToString(boxes) + " from zeros around it (max at most 1)");
  // A mask that is changed in place is seen.
  same->GetPointData()->GetScalars()->Fill(0.0);
  same->Modified();
  const ffdTest::Distance none = f.Scene.Compare(corner, f.Scene.Render(f.Scene.Ours));
  checks.ExpectAtLeast("changed mask", none.Mean, 20.0);
  f.Scene.Ours->SetMaskInput(nullptr);
  const ffdTest::Distance back = f.Scene.Compare(all, f.Scene.Render(f.Scene.Ours));
  checks.Expect(back.Max == 0.0, "mask removed", ffdTest::ToString(back));
}

void CheckLabels(ffdTest::Checks& checks)
{
  Fixture f;
  const ffdTest::Picture without = f.Scene.Render(f.Scene.Ours);
  const auto labels = ffdTest::MakeImage(40, VTK_UNSIGNED_CHAR, 1, Labels);
  SetLabel(f.Scene.Property, 1, 0.2, 0.9, 0.2, 0.2);
  SetLabel(f.Scene.Property, 2, 0.2, 0.3, 1.0, 0.5);
  SetLabel(f.Scene.Property, 3, 1.0, 0.2, 0.8, 0.05);
  f.SetMask(labels, vtkGPUVolumeRayCastMapper::LabelMapMaskType);
  const ffdTest::Picture colored = f.CheckAgainstGpu("labels", 4.0, checks);
  checks.ExpectAtLeast("labels, matter", f.Scene.Compare(without, colored).Mean, 20.0);
  ffdTest::CheckSamePictures(f.Scene, "labels", checks);
  f.SetBlend(0.4f);
  const ffdTest::Picture blended = f.CheckAgainstGpu("labels, blended", 4.0, checks);
  checks.ExpectAtLeast("labels, blending matters", f.Scene.Compare(blended, colored).Mean, 5.0);
  ffdTest::CheckSamePictures(f.Scene, "labels, blended", checks);
  f.SetBlend(0.0f);
  const ffdTest::Distance off = f.Scene.Compare(without, f.Scene.Render(f.Scene.Ours));
  checks.Expect(
    off.Max <= 1.0, "labels, blended by 0", ffdTest::ToString(off) + " (max at most 1)");
  f.SetBlend(1.0f);
  f.Scene.SetShadingAsGpuMapper(0.2, 0.7, 0.3, 20.0);
  f.CheckAgainstGpu("labels, shaded", 5.0, checks);
  f.Scene.Property->ShadeOff();

  // Where the property shows nothing labels do: leaping knows.
  ffdTest::SetTransfer(
    f.Scene.Property, { { 0, 1.0, 1.0, 1.0, 0.0 }, { 255, 1.0, 1.0, 1.0, 0.0 } }, 1.0);
  f.CheckAgainstGpu("labels only", 4.0, checks);
  ffdTest::CheckSamePictures(f.Scene, "labels only", checks);

  // A label's own gradient opacity; that of the property is for what has no label.
  vtkNew<vtkPiecewiseFunction> gradients;
  gradients->AddPoint(0.0, 0.0);
  gradients->AddPoint(20.0, 1.0);
  const ffdTest::Picture plain = f.Scene.Render(f.Scene.Ours);
  f.Scene.Property->SetLabelGradientOpacity(2, gradients);
  const ffdTest::Picture byGradient = f.Scene.Render(f.Scene.Ours);
  checks.ExpectAtLeast(
    "gradient opacity of a label, matters", f.Scene.Compare(plain, byGradient).Mean, 2.0);
  ffdTest::CheckSamePictures(f.Scene, "gradient opacity of a label", checks);
  f.Scene.Property->SetGradientOpacity(gradients);
  const ffdTest::Distance unlabeled = f.Scene.Compare(byGradient, f.Scene.Render(f.Scene.Ours));
  checks.Expect(unlabeled.Max == 0.0, "gradient opacity of the property, labels only",
    ffdTest::ToString(unlabeled));
}

} // namespace

int TestMasks(int, char*[])
{
  ffdTest::Checks checks;
  CheckBinary(checks);
  CheckLabels(checks);
  return checks.Result();
}
