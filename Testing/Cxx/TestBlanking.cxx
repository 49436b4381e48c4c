// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Blanked points and cells are empty. Points against scalars that are not a number, cells against
// a binary mask.
#include "FFDTestOptics.h"

#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkFloatArray.h"

namespace
{

constexpr int N = 28;

double Field(int, const ffdTest::Vec3& p) { return ffdTest::FourFields(3, p); }

bool IsBlank(vtkIdType i, vtkIdType j, vtkIdType k)
{
  return (i - 14) * (i - 14) + (j - 9) * (j - 9) + (k - 15) * (k - 15) < 36 || (i == 20 && j == 14);
}

struct Fixture
{
  ffdTest::Scene Scene;
  vtkSmartPointer<vtkImageData> Image = ffdTest::MakeImage(N, VTK_FLOAT, 1, Field);

  Fixture()
  {
    this->Scene.SetInput(this->Image);
    this->Scene.SetCamera({ 10.0, 25.0, 1.0, true, false }, this->Image->GetBounds());
    ffdTest::SetTransfer(this->Scene.Property,
      { { 10, 1.0, 0.8, 0.2, 0.0 }, { 120, 1.0, 0.6, 0.2, 0.2 }, { 255, 0.3, 0.6, 0.8, 0.5 } },
      1.0);
  }
  void CheckSame(const std::string& name, const ffdTest::Picture& expected, ffdTest::Checks& checks)
  {
    const ffdTest::Distance d = this->Scene.Compare(expected, this->Scene.Render(this->Scene.Ours));
    checks.Expect(d.Pixels > 1000 && d.Max <= 1.0, name, ffdTest::ToString(d) + " (max at most 1)");
  }
};

void CheckPoints(ffdTest::Checks& checks)
{
  Fixture f;
  const ffdTest::Picture all = f.Scene.Render(f.Scene.Ours);
  const auto holes = ffdTest::MakeImage(N, VTK_FLOAT, 1, Field);
  for (int k = 0; k < N; ++k)
  {
    for (int j = 0; j < N; ++j)
    {
      for (int i = 0; i < N; ++i)
      {
        if (IsBlank(i, j, k))
        {
          holes->SetScalarComponentFromDouble(i, j, k, 0, std::numeric_limits<double>::quiet_NaN());
        }
      }
    }
  }
  f.Scene.Ours->SetInputData(holes);
  const ffdTest::Picture expected = f.Scene.Render(f.Scene.Ours);
  checks.ExpectAtLeast("holes are seen", f.Scene.Compare(all, expected).Mean, 5.0);
  f.Scene.Ours->SetInputData(f.Image);
  vtkUnsignedCharArray* ghosts = f.Image->AllocatePointGhostArray();
  for (int k = 0; k < N; ++k)
  {
    for (int j = 0; j < N; ++j)
    {
      for (int i = 0; i < N; ++i)
      {
        if (IsBlank(i, j, k))
        {
          ghosts->SetValue(i + N * (j + N * k),
            k % 2 == 0 ? vtkDataSetAttributes::HIDDENPOINT : vtkDataSetAttributes::DUPLICATEPOINT);
        }
      }
    }
  }
  f.Image->Modified();
  f.CheckSame("blanked points", expected, checks);
  ffdTest::CheckSamePictures(f.Scene, "blanked points", checks);
  f.Scene.SetShading(0.2, 0.7, 0.3, 20.0);
  ffdTest::CheckSamePictures(f.Scene, "blanked points, shaded", checks);
  f.Scene.Property->ShadeOff();
  f.Image->GetPointData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
  f.Image->Modified();
  f.CheckSame("points no longer blanked", all, checks);
}

/// Cells of an image with scalars of points or of cells.
void CheckCells(bool ofCells, ffdTest::Checks& checks)
{
  const std::string name = ofCells ? ", scalars of cells" : ", scalars of points";
  Fixture f;
  vtkSmartPointer<vtkImageData> image = f.Image;
  if (ofCells)
  {
    image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(N, N, N);
    image->GetCellData()->SetScalars(
      ffdTest::MakeImage(N - 1, VTK_FLOAT, 1, Field)->GetPointData()->GetScalars());
    f.Scene.Ours->SetInputData(image);
    f.Scene.Property->SetInterpolationTypeToNearest();
  }
  const ffdTest::Picture all = f.Scene.Render(f.Scene.Ours);
  vtkNew<vtkImageData> mask;
  mask->SetDimensions(N - 1, N - 1, N - 1);
  mask->SetOrigin(0.5, 0.5, 0.5);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  vtkIdType cell = 0;
  auto* inside = static_cast<unsigned char*>(mask->GetScalarPointer());
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  for (int k = 0; k < N - 1; ++k)
  {
    for (int j = 0; j < N - 1; ++j)
    {
      for (int i = 0; i < N - 1; ++i, ++cell)
      {
        const bool blank = IsBlank(i, j, k);
        inside[cell] = blank ? 0 : 255;
        // Any flag hides: duplicates are shown by the process that they belong to.
        ghosts->InsertNextValue(blank ? static_cast<unsigned char>(1 << k % 6) : 0);
      }
    }
  }
  f.Scene.Ours->SetMaskInput(mask);
  f.Scene.Ours->SetMaskTypeToBinary();
  const ffdTest::Picture expected = f.Scene.Render(f.Scene.Ours);
  f.Scene.Ours->SetMaskInput(nullptr);
  checks.ExpectAtLeast("hidden cells are seen" + name, f.Scene.Compare(all, expected).Mean, 3.0);
  image->GetCellData()->AddArray(ghosts);
  f.CheckSame("cells with any flag" + name, expected, checks);
  ffdTest::CheckSamePictures(f.Scene, "hidden cells" + name, checks);
  ghosts->FillValue(0);
  ghosts->Modified();
  image->Modified();
  f.CheckSame("cells without flags" + name, all, checks);
}

/// What is blanked does not bleed into the cells beside it, whatever its scalars.
void CheckInterpolatedCells(ffdTest::Checks& checks)
{
  ffdTest::Scene scene;
  vtkNew<vtkImageData> image;
  image->SetDimensions(N, N, N);
  vtkNew<vtkFloatArray> values;
  vtkNew<vtkUnsignedCharArray> ghosts;
  values->SetName("values");
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  for (int k = 0; k < N - 1; ++k)
  {
    for (int j = 0; j < N - 1; ++j)
    {
      for (int i = 0; i < N - 1; ++i)
      {
        const bool blank = IsBlank(i, j, k);
        values->InsertNextValue(blank ? 1e6f : 1.0f);
        ghosts->InsertNextValue(blank ? vtkDataSetAttributes::HIDDENCELL : 0);
      }
    }
  }
  image->GetCellData()->SetScalars(values);
  image->GetCellData()->AddArray(ghosts);
  scene.SetInput(image);
  scene.SetCamera({ 10.0, 25.0, 1.0, true, false }, image->GetBounds());
  ffdTest::SetTransfer(scene.Property,
    { { 0.0, 0.0, 1.0, 0.0, 0.05 }, { 1.0, 0.0, 1.0, 0.0, 0.05 }, { 1.5, 1.0, 0.0, 0.0, 1.0 } },
    1.0);
  const ffdTest::Picture picture = scene.Render(scene.Ours);
  int red = 0;
  int green = 0;
  for (std::size_t i = 0; i < picture.Rgb.size(); i += 3)
  {
    // The background has red of 26.
    red += picture.Rgb[i] > 26 ? 1 : 0;
    green += picture.Rgb[i + 1] > 60 ? 1 : 0;
  }
  checks.Expect(red == 0 && green > 1000, "hidden cells do not bleed",
    std::to_string(red) + " pixels with their color, " + std::to_string(green) + " with others'");
}

} // namespace

int TestBlanking(int, char*[])
{
  ffdTest::Checks checks;
  CheckPoints(checks);
  CheckCells(false, checks);
  CheckCells(true, checks);
  CheckInterpolatedCells(checks);
  return checks.Result();
}
