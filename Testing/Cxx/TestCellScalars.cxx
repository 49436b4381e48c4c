// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Scalars of cells, up to the outermost faces, and the choice of the array. Undeformed against
// vtkGPUVolumeRayCastMapper, with equal settings.
#include "FFDTestOptics.h"

#include "vtkCellData.h"
#include "vtkContourValues.h"

namespace
{

constexpr int N = 24; // cells

/// Visible up to the faces of the volume.
double Everywhere(int c, const ffdTest::Vec3& p)
{
  return 40.0 + 0.8 * ffdTest::FourFields(3, p) + (c == 1 ? 20.0 * p[0] : 0.0);
}

vtkSmartPointer<vtkImageData> MakeCells(int type, const ffdTest::Field& field, int components = 1)
{
  const auto centers = ffdTest::MakeImage(N, type, components, field);
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(N + 1, N + 1, N + 1);
  image->SetOrigin(-2.0, 3.0, 1.0);
  image->SetSpacing(1.5, 1.0, 0.8);
  image->GetCellData()->SetScalars(centers->GetPointData()->GetScalars());
  return image;
}

void CheckCells(ffdTest::Checks& checks)
{
  for (const int type : { VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_FLOAT, VTK_DOUBLE })
  {
    ffdTest::Scene scene;
    const auto image = MakeCells(type, Everywhere);
    scene.SetInput(image);
    scene.SetCamera({ 35.0, 25.0, 1.0, true, false }, image->GetBounds());
    scene.SetSampleDistance(0.5);
    ffdTest::SetTransfer(scene.Property,
      { { 30, 1.0, 0.3, 0.1, 0.0 }, { 60, 1.0, 0.8, 0.1, 0.05 }, { 240, 0.2, 0.6, 1.0, 0.3 } },
      1.0);
    for (const bool nearest : { false, true })
    {
      scene.Property->SetInterpolationType(
        nearest ? VTK_NEAREST_INTERPOLATION : VTK_LINEAR_INTERPOLATION);
      const std::string name = std::string("cells of ") + vtkImageScalarTypeNameMacro(type) +
        (nearest ? ", nearest" : ", linear");
      const ffdTest::Distance d = scene.Compare(scene.Render(scene.Ours), scene.Render(scene.Gpu));
      checks.Expect(d.Pixels > 4000 && d.Mean <= 3.5 && d.P99 <= 16.0, name,
        ffdTest::ToString(d) + " from the GPU mapper (mean at most 3.5, p99 16)");
      if (type == VTK_UNSIGNED_CHAR || type == VTK_DOUBLE)
      {
        // Something must be empty for leaps.
        ffdTest::SetTransfer(scene.Property,
          { { 50, 1.0, 0.3, 0.1, 0.0 }, { 60, 1.0, 0.8, 0.1, 0.05 }, { 240, 0.2, 0.6, 1.0, 0.3 } },
          1.0);
        scene.Property->SetInterpolationType(
          nearest ? VTK_NEAREST_INTERPOLATION : VTK_LINEAR_INTERPOLATION);
        ffdTest::CheckSamePictures(scene, name, checks);
        scene.SetShadingAsGpuMapper(0.2, 0.7, 0.3, 20.0);
        ffdTest::CheckSamePictures(scene, name + ", shaded", checks);
        scene.Property->ShadeOff();
        ffdTest::SetTransfer(scene.Property,
          { { 30, 1.0, 0.3, 0.1, 0.0 }, { 60, 1.0, 0.8, 0.1, 0.05 }, { 240, 0.2, 0.6, 1.0, 0.3 } },
          1.0);
      }
    }
  }
}

/// Only the outermost layer of cells is visible: it is as thick as a cell, and touches the faces.
void CheckFaces(ffdTest::Checks& checks)
{
  ffdTest::Scene scene;
  const auto image =
    MakeCells(VTK_FLOAT, [](int, const ffdTest::Vec3& p) { return p[1] == 0.0 ? 1.0 : 0.0; });
  scene.SetInput(image);
  // Along y: the layer is one voxel of 1.0 thick.
  scene.SetCamera({ 0.0, 0.0, 1.0, true, false }, image->GetBounds());
  scene.SetSampleDistance(0.01);
  ffdTest::SetTransfer(
    scene.Property, { { 0.0, 1.0, 1.0, 1.0, 0.0 }, { 0.5, 1.0, 1.0, 1.0, 0.5 } }, 1.0);
  scene.Property->SetInterpolationTypeToNearest();
  scene.Ours->SetReferenceKernels(1);
  const std::vector<unsigned char> exact = ffdTest::RenderRgba(scene);
  scene.Ours->SetReferenceKernels(0);
  const std::vector<unsigned char> rgba = ffdTest::RenderRgba(scene);
  const std::size_t middle = 4 * (50 * 100 + 50) + 3;
  checks.Expect(std::abs(rgba[middle] - 127.5) <= 2.0 && std::abs(exact[middle] - 127.5) <= 2.0,
    "a layer of cells is as thick as a cell",
    std::to_string(rgba[middle]) + " and " + std::to_string(exact[middle]) +
      " (alpha; 127.5, at most 2 off)");
}

/// In the outer halves of the outermost cells values are those of the cells, in every blend mode.
void CheckBlendModes(ffdTest::Checks& checks)
{
  using Mapper = vtkFFDInverseRayVolumeMapper;
  // Neighbors differ: extrapolated values would be far off.
  const auto random = [](int, const ffdTest::Vec3& p) {
    const int hash = static_cast<int>(
      1e4 * std::abs(std::sin(12.9898 * N * p[0] + 78.233 * N * p[1] + 37.719 * N * p[2])));
    return hash % 2 == 0 ? 50.0 : 0.0;
  };
  for (const int type : { VTK_UNSIGNED_CHAR, VTK_UNSIGNED_SHORT, VTK_FLOAT })
  {
    const auto image = MakeCells(type, random);
    for (const int mode :
      { vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND, vtkVolumeMapper::MINIMUM_INTENSITY_BLEND,
        vtkVolumeMapper::AVERAGE_INTENSITY_BLEND, vtkVolumeMapper::ADDITIVE_BLEND,
        vtkVolumeMapper::ISOSURFACE_BLEND, vtkVolumeMapper::COMPOSITE_BLEND })
    {
      ffdTest::Scene scene;
      scene.SetInput(image);
      scene.SetCamera({ 35.0, 25.0, 1.0, true, false }, image->GetBounds());
      scene.SetSampleDistance(0.5);
      scene.Ours->SetBlendMode(mode);
      // Composites: intervals, which need values alone, too.
      scene.Ours->SetClassification(Mapper::PRE_INTEGRATED);
      ffdTest::SetTransfer(scene.Property,
        { { 0, 0.0, 0.0, 1.0, 0.0 }, { 50, 1.0, 0.5, 0.0, 0.5 }, { 51, 0.0, 1.0, 0.0, 0.6 },
          { 100, 0.0, 1.0, 0.0, 1.0 } },
        1.0);
      scene.Property->GetIsoSurfaceValues()->SetValue(0, 30.0);
      scene.Ours->SetReferenceKernels(1);
      const ffdTest::Picture exact = scene.Render(scene.Ours);
      scene.Ours->SetReferenceKernels(0);
      const ffdTest::Distance d = scene.Compare(exact, scene.Render(scene.Ours));
      checks.Expect(d.Pixels > 4000 && d.Mean <= 0.1 && d.P99 <= 2.0,
        std::string("faces of cells of ") + vtkImageScalarTypeNameMacro(type) + ", " +
          "blend mode " + std::to_string(mode),
        ffdTest::ToString(d) + " from the reference (mean at most 0.1, p99 2)");
    }
  }
}

/// The array is found by name and by number, of points and of cells.
void CheckSelection(ffdTest::Checks& checks)
{
  ffdTest::Scene scene;
  const auto image = MakeCells(VTK_FLOAT, Everywhere);
  image->GetCellData()->GetScalars()->SetName("first");
  const auto other = ffdTest::MakeImage(
    N, VTK_FLOAT, 1, [](int, const ffdTest::Vec3& p) { return ffdTest::FourFields(1, p); });
  other->GetPointData()->GetScalars()->SetName("second");
  image->GetCellData()->AddArray(other->GetPointData()->GetScalars());
  const auto points = ffdTest::MakeImage(
    N + 1, VTK_SHORT, 1, [](int, const ffdTest::Vec3& p) { return ffdTest::FourFields(0, p); });
  points->GetPointData()->GetScalars()->SetName("third");
  image->GetPointData()->AddArray(points->GetPointData()->GetScalars());
  scene.Ours->SetInputData(image);
  scene.SetCamera({ 35.0, 25.0, 1.0, true, false }, image->GetBounds());
  ffdTest::SetTransfer(
    scene.Property, { { 30, 1.0, 0.3, 0.1, 0.0 }, { 240, 0.2, 0.6, 1.0, 0.3 } }, 1.0);

  const auto alone = [&](vtkDataArray* array, bool cells) {
    vtkNew<vtkImageData> only;
    only->CopyStructure(image);
    if (cells)
    {
      only->GetCellData()->SetScalars(array);
    }
    else
    {
      only->GetPointData()->SetScalars(array);
    }
    scene.Ours->SetInputData(only);
    scene.Ours->SetScalarModeToDefault();
    const ffdTest::Picture picture = scene.Render(scene.Ours);
    scene.Ours->SetInputData(image);
    return picture;
  };
  const ffdTest::Picture first = alone(image->GetCellData()->GetArray("first"), true);
  const ffdTest::Picture second = alone(image->GetCellData()->GetArray("second"), true);
  const ffdTest::Picture third = alone(image->GetPointData()->GetArray("third"), false);
  checks.ExpectAtLeast("arrays differ", scene.Compare(first, second).Mean, 20.0);
  const auto same = [&](const std::string& name, const ffdTest::Picture& expected) {
    const ffdTest::Distance d = scene.Compare(expected, scene.Render(scene.Ours));
    checks.Expect(d.Pixels > 1000 && d.Max == 0.0, name, ffdTest::ToString(d));
  };
  scene.Ours->SetScalarModeToDefault();
  same("default: no point scalars are active, so those of cells", first);
  scene.Ours->SetScalarModeToUseCellData();
  same("cell data", first);
  scene.Ours->SetScalarModeToUseCellFieldData();
  scene.Ours->SelectScalarArray("second");
  same("cell field data by name", second);
  scene.Ours->SelectScalarArray(0);
  same("cell field data by number", first);
  scene.Ours->SetScalarModeToUsePointFieldData();
  scene.Ours->SelectScalarArray("third");
  same("point field data by name", third);
  scene.Ours->SelectScalarArray(0);
  same("point field data by number", third);
}

} // namespace

int TestCellScalars(int, char*[])
{
  ffdTest::Checks checks;
  CheckCells(checks);
  CheckFaces(checks);
  CheckBlendModes(checks);
  CheckSelection(checks);
  return checks.Result();
}
