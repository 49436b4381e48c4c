// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Rectilinear grids: with equal steps they look as images do; with others as the images of the same
// fields.
#include "FFDTestOptics.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFFDLattice.h"
#include "vtkRectilinearGrid.h"

namespace
{

vtkSmartPointer<vtkRectilinearGrid> MakeGrid(const std::vector<double> coordinates[3])
{
  auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
  grid->SetDimensions(static_cast<int>(coordinates[0].size()),
    static_cast<int>(coordinates[1].size()), static_cast<int>(coordinates[2].size()));
  vtkNew<vtkDoubleArray> arrays[3];
  for (int a = 0; a < 3; ++a)
  {
    for (double x : coordinates[a])
    {
      arrays[a]->InsertNextValue(x);
    }
  }
  grid->SetXCoordinates(arrays[0]);
  grid->SetYCoordinates(arrays[1]);
  grid->SetZCoordinates(arrays[2]);
  return grid;
}

/// Point scalars: a field of the position relative to a cube of side 39.
void SetField(vtkRectilinearGrid* grid, int type, const ffdTest::Field& field)
{
  vtkSmartPointer<vtkDataArray> values;
  values.TakeReference(vtkDataArray::CreateDataArray(type));
  values->SetName("values");
  values->SetNumberOfTuples(grid->GetNumberOfPoints());
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i)
  {
    const double* p = grid->GetPoint(i);
    values->SetComponent(i, 0, field(0, { p[0] / 39.0, p[1] / 39.0, p[2] / 39.0 }));
  }
  grid->GetPointData()->SetScalars(values);
}

double Smooth(int, const ffdTest::Vec3& p)
{
  const double r =
    (p[0] - 0.5) * (p[0] - 0.5) + (p[1] - 0.45) * (p[1] - 0.45) + 1.4 * (p[2] - 0.5) * (p[2] - 0.5);
  return 255.0 * std::exp(-14.0 * r);
}

double Linear(int, const ffdTest::Vec3& p)
{
  return 200.0 * (0.5 * p[0] + 0.2 * p[1] + 0.3 * p[2]);
}

struct Fixture
{
  ffdTest::Scene Scene;
  explicit Fixture(vtkImageData* image)
  {
    this->Scene.SetInput(image);
    this->Scene.SetCamera({ 30.0, 25.0, 1.0, true, false }, image->GetBounds());
    this->Scene.SetSampleDistance(0.5);
    ffdTest::SetTransfer(this->Scene.Property,
      { { 60, 1.0, 0.3, 0.1, 0.0 }, { 100, 1.0, 0.8, 0.1, 0.1 }, { 240, 0.2, 0.6, 1.0, 0.4 } },
      1.0);
  }
  void CheckSame(const std::string& name, const ffdTest::Picture& expected, double mean,
    double largest, ffdTest::Checks& checks)
  {
    const ffdTest::Distance d = this->Scene.Compare(expected, this->Scene.Render(this->Scene.Ours));
    std::ostringstream figures;
    figures << d << " (mean at most " << mean << ", max " << largest << ")";
    checks.Expect(d.Pixels > 1500 && d.Mean <= mean && d.Max <= largest, name, figures.str());
  }
};

std::vector<double> Steps(int n, double power)
{
  std::vector<double> x;
  for (int i = 0; i < n; ++i)
  {
    x.push_back(39.0 * std::pow(i / (n - 1.0), power));
  }
  return x;
}

void CheckUniform(ffdTest::Checks& checks)
{
  for (const int type : { VTK_UNSIGNED_CHAR, VTK_FLOAT })
  {
    const auto image = ffdTest::MakeImage(40, type, 1, Smooth);
    Fixture f(image);
    const std::vector<double> even[3] = { Steps(40, 1.0), Steps(40, 1.0), Steps(40, 1.0) };
    const auto grid = MakeGrid(even);
    grid->GetPointData()->SetScalars(image->GetPointData()->GetScalars());
    const std::string name = std::string("equal steps, ") + vtkImageScalarTypeNameMacro(type);
    for (const bool nearest : { false, true })
    {
      f.Scene.Property->SetInterpolationType(
        nearest ? VTK_NEAREST_INTERPOLATION : VTK_LINEAR_INTERPOLATION);
      f.Scene.Ours->SetInputData(image);
      const ffdTest::Picture expected = f.Scene.Render(f.Scene.Ours);
      f.Scene.Ours->SetInputData(grid);
      // Rounding decides which of two voxels is nearer.
      f.CheckSame(name + (nearest ? ", nearest" : ""), expected, 0.3, nearest ? 60.0 : 2.0, checks);
    }
    f.Scene.Property->SetInterpolationTypeToLinear();
    f.Scene.SetShading(0.2, 0.7, 0.3, 20.0);
    f.Scene.Ours->SetInputData(image);
    const ffdTest::Picture shaded = f.Scene.Render(f.Scene.Ours);
    f.Scene.Ours->SetInputData(grid);
    f.CheckSame(name + ", shaded", shaded, 0.3, 8.0, checks);
  }
}

void CheckUneven(ffdTest::Checks& checks)
{
  const std::vector<double> uneven[3] = { Steps(44, 1.7), Steps(38, 0.8), Steps(50, 1.3) };
  const auto grid = MakeGrid(uneven);
  {
    // A linear field is interpolated exactly on any grid.
    const auto image = ffdTest::MakeImage(40, VTK_FLOAT, 1, Linear);
    Fixture f(image);
    const ffdTest::Picture expected = f.Scene.Render(f.Scene.Ours);
    SetField(grid, VTK_FLOAT, Linear);
    f.Scene.Ours->SetInputData(grid);
    f.CheckSame("uneven steps, linear field", expected, 0.3, 3.0, checks);
    ffdTest::CheckSamePictures(f.Scene, "uneven steps, linear field", checks);
    // Its direction of the normal is the same everywhere, too; at the border gradients are
    // one-sided.
    f.Scene.SetShading(0.2, 0.7, 0.3, 20.0);
    f.Scene.Ours->SetInputData(image);
    const ffdTest::Picture shaded = f.Scene.Render(f.Scene.Ours);
    f.Scene.Ours->SetInputData(grid);
    f.CheckSame("uneven steps, linear field, shaded", shaded, 3.0, 60.0, checks);
  }
  {
    const auto image = ffdTest::MakeImage(40, VTK_FLOAT, 1, Smooth);
    Fixture f(image);
    const ffdTest::Picture expected = f.Scene.Render(f.Scene.Ours);
    SetField(grid, VTK_FLOAT, Smooth);
    f.Scene.Ours->SetInputData(grid);
    f.CheckSame("uneven steps, smooth field", expected, 2.0, 12.0, checks);
    ffdTest::CheckSamePictures(f.Scene, "uneven steps, smooth field", checks);
    f.Scene.SetShading(0.2, 0.7, 0.3, 20.0);
    f.Scene.Ours->SetInputData(image);
    const ffdTest::Picture shaded = f.Scene.Render(f.Scene.Ours);
    f.Scene.Ours->SetInputData(grid);
    f.CheckSame("uneven steps, smooth field, shaded", shaded, 3.0, 30.0, checks);
    ffdTest::CheckSamePictures(f.Scene, "uneven steps, smooth field, shaded", checks);
    // Deformed as the image is, by a lattice that travels with the grid.
    f.Scene.Property->ShadeOff();
    vtkNew<vtkFFDLattice> lattice;
    lattice->SetDimensions(6, 6, 6);
    lattice->FitToBounds(image->GetBounds(), 0.0);
    lattice->SetDisplacement(3, 3, 3, 9.0, 4.0, -5.0);
    f.Scene.Ours->SetDeformation(lattice);
    f.Scene.Ours->SetInputData(image);
    const ffdTest::Picture deformed = f.Scene.Render(f.Scene.Ours);
    f.Scene.Ours->SetDeformation(nullptr);
    lattice->AttachTo(grid);
    f.Scene.Ours->SetInputData(grid);
    f.CheckSame("uneven steps, deformed", deformed, 2.0, 14.0, checks);
    checks.ExpectAtLeast("the deformation matters", f.Scene.Compare(expected, deformed).Mean, 10.0);
    grid->GetFieldData()->Initialize();
  }
}

/// Cells of different widths, each of one value: those of an image whose cells are parts of them.
void CheckCells(ffdTest::Checks& checks)
{
  const std::vector<double> faces = { 0, 2, 3, 7, 8, 12, 13, 14, 20, 22, 27, 28, 33, 36, 39 };
  const std::vector<double> coordinates[3] = { faces, faces, faces };
  const auto grid = MakeGrid(coordinates);
  const auto cellOf = [&](int i) {
    int cell = 0;
    while (faces[static_cast<std::size_t>(cell) + 1] <= i)
    {
      ++cell;
    }
    return cell;
  };
  const int n = static_cast<int>(faces.size()) - 1;
  const auto valueOf = [&](int i, int j, int k) {
    return Smooth(0, { (i + 0.5) / n, (j + 0.5) / n, (k + 0.5) / n });
  };
  vtkNew<vtkDoubleArray> values;
  values->SetName("cells");
  for (int k = 0; k < n; ++k)
  {
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        values->InsertNextValue(valueOf(i, j, k));
      }
    }
  }
  grid->GetCellData()->SetScalars(values);
  vtkNew<vtkImageData> image;
  image->SetDimensions(40, 40, 40);
  vtkNew<vtkDoubleArray> fine;
  for (int k = 0; k < 39; ++k)
  {
    for (int j = 0; j < 39; ++j)
    {
      for (int i = 0; i < 39; ++i)
      {
        fine->InsertNextValue(valueOf(cellOf(i), cellOf(j), cellOf(k)));
      }
    }
  }
  image->GetCellData()->SetScalars(fine);
  Fixture f(image);
  f.Scene.Property->SetInterpolationTypeToNearest();
  f.Scene.SetSampleDistance(0.25);
  const ffdTest::Picture expected = f.Scene.Render(f.Scene.Ours);
  f.Scene.Ours->SetInputData(grid);
  // Distances to the faces of cells round otherwise.
  f.CheckSame("cells, nearest", expected, 0.5, 60.0, checks);
  ffdTest::CheckSamePictures(f.Scene, "cells, nearest", checks);
  f.Scene.Property->SetInterpolationTypeToLinear();
  ffdTest::CheckSamePictures(f.Scene, "cells, linear", checks);
}

} // namespace

int TestRectilinearGrid(int, char*[])
{
  ffdTest::Checks checks;
  CheckUniform(checks);
  CheckUneven(checks);
  CheckCells(checks);
  return checks.Result();
}
