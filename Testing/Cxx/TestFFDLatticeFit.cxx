// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// FitToTransform: linear, thin plate, grid, general and B-spline transforms within a tolerance.
#include "FFDTestHelpers.h"

#include "vtkBSplineTransform.h"
#include "vtkDataArray.h"
#include "vtkGeneralTransform.h"
#include "vtkGridTransform.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkThinPlateSplineTransform.h"
#include "vtkTransform.h"

namespace
{

const double Bounds[6] = { 0.0, 20.0, -5.0, 10.0, 3.0, 11.0 };

/// Fit, and measure the error at random points of the bounds.
double Error(vtkFFDLattice* lattice, vtkAbstractTransform* transform)
{
  FFDRandom random(6);
  double worst = 0.0;
  for (int i = 0; i < 4000; ++i)
  {
    double p[3];
    double q[3];
    double r[3];
    for (int a = 0; a < 3; ++a)
    {
      p[a] = random.Number(Bounds[2 * a], Bounds[2 * a + 1]);
    }
    lattice->TransformPoint(p, q);
    transform->TransformPoint(p, r);
    worst = std::max(worst, FFDDistance(q, r));
  }
  return worst;
}

} // namespace

int TestFFDLatticeFit(int, char*[])
{
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetBorderModeToZero();
  lattice->SetDisplacementScale(0.3);
  lattice->Inverse();

  // Linear maps are exact at the coarsest level.
  vtkNew<vtkTransform> linear;
  linear->RotateWXYZ(30.0, 1.0, 2.0, 3.0);
  linear->Scale(1.2, 0.9, 1.1);
  linear->Translate(3.0, -4.0, 5.0);
  double reached = lattice->FitToTransform(linear, Bounds, 1e-3);
  FFD_CHECK(reached >= 0.0 && reached < 1e-11);
  FFD_CHECK(Error(lattice, linear) < 1e-11);
  FFD_CHECK(lattice->GetNumberOfControlPoints() == 7 * 7 * 7);
  FFD_CHECK(lattice->GetBorderMode() == VTK_BSPLINE_EDGE &&
    lattice->GetDisplacementScale() == 1.0 && lattice->GetInverseFlag() == 0);
  double domain[6];
  lattice->GetDomain(domain);
  for (int i = 0; i < 6; ++i)
  {
    FFD_CHECK_NEAR(domain[i], Bounds[i], 1e-12);
  }

  // Thin plates: smooth away from the landmarks.
  vtkNew<vtkPoints> source;
  vtkNew<vtkPoints> target;
  FFDRandom random(7);
  for (int i = 0; i < 10; ++i)
  {
    const double x = random.Number(Bounds[0], Bounds[1]);
    const double y = random.Number(Bounds[2], Bounds[3]);
    const double z = random.Number(Bounds[4], Bounds[5]);
    source->InsertNextPoint(x, y, z);
    target->InsertNextPoint(x + random.Number(-1.0, 1.0), y + random.Number(-1.0, 1.0), z);
  }
  vtkNew<vtkThinPlateSplineTransform> plate;
  plate->SetSourceLandmarks(source);
  plate->SetTargetLandmarks(target);
  plate->SetBasisToR();
  reached = lattice->FitToTransform(plate, Bounds, 0.05);
  FFD_CHECK(reached >= 0.0 && reached <= 0.05);
  FFD_CHECK(Error(lattice, plate) < 0.1);
  const vtkIdType coarse = lattice->GetNumberOfControlPoints();
  reached = lattice->FitToTransform(plate, Bounds, 0.02);
  FFD_CHECK(lattice->GetNumberOfControlPoints() >= coarse);
  FFD_CHECK(reached <= 0.02 || lattice->GetNumberOfControlPoints() == 67 * 67 * 67);
  // It has a kink at each landmark, where the error is largest: it is told.
  for (int i = 0; i < 10; ++i)
  {
    double wanted[3];
    double found[3];
    plate->TransformPoint(source->GetPoint(i), wanted);
    lattice->TransformPoint(source->GetPoint(i), found);
    FFD_CHECK(std::sqrt(vtkMath::Distance2BetweenPoints(wanted, found)) <= 1.0001 * reached);
  }
  // The cap is kept, and the error it costs is told.
  reached = lattice->FitToTransform(plate, Bounds, 1e-9, 8);
  FFD_CHECK(reached > 1e-9 && lattice->GetNumberOfControlPoints() == 11 * 11 * 11);

  // A displacement grid, interpolated cubically, twice as fine as the first fit.
  vtkNew<vtkImageData> grid;
  grid->SetDimensions(13, 10, 7);
  grid->SetOrigin(-2.0, -7.0, 1.0);
  grid->SetSpacing(2.0, 2.0, 2.0);
  grid->AllocateScalars(VTK_FLOAT, 3);
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i)
  {
    double p[3];
    grid->GetPoint(i, p);
    vtkDataArray* scalars = grid->GetPointData()->GetScalars();
    scalars->SetComponent(i, 0, std::sin(0.4 * p[1]));
    scalars->SetComponent(i, 1, std::cos(0.3 * p[0]));
    scalars->SetComponent(i, 2, 0.1 * p[2]);
  }
  vtkNew<vtkGridTransform> warp;
  warp->SetDisplacementGridData(grid);
  warp->SetInterpolationModeToCubic();
  reached = lattice->FitToTransform(warp, Bounds, 0.02);
  FFD_CHECK(reached >= 0.0 && reached <= 0.02);
  FFD_CHECK(Error(lattice, warp) < 0.04);

  // What is given on a fine grid is seen wherever it lies, also behind a turn.
  vtkNew<vtkImageData> fine;
  fine->SetDimensions(64, 64, 64);
  fine->SetOrigin(Bounds[0], Bounds[2], Bounds[4]);
  fine->SetSpacing(
    (Bounds[1] - Bounds[0]) / 63.0, (Bounds[3] - Bounds[2]) / 63.0, (Bounds[5] - Bounds[4]) / 63.0);
  fine->AllocateScalars(VTK_DOUBLE, 3);
  vtkDataArray* const moves = fine->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < fine->GetNumberOfPoints(); ++i)
  {
    const double x = static_cast<double>(i % 64) - 12.0;
    const double y = static_cast<double>(i / 64 % 64) - 28.0;
    const double z = static_cast<double>(i / 4096) - 44.0;
    moves->SetTuple3(i, std::exp(-(x * x + y * y + z * z) / 8.0), 0.0, 0.0);
  }
  vtkNew<vtkGridTransform> bump;
  bump->SetDisplacementGridData(fine);
  bump->SetInterpolationModeToCubic();
  vtkNew<vtkTransform> turn;
  turn->RotateZ(90.0);
  vtkNew<vtkGeneralTransform> turned;
  turned->Concatenate(turn);
  turned->Concatenate(bump);
  const vtkIdType middle[3] = { 12, 28, 44 };
  double top[3];
  fine->GetPoint(middle[0] + 64 * (middle[1] + 64 * middle[2]), top);
  for (vtkAbstractTransform* transform :
    { static_cast<vtkAbstractTransform*>(bump), static_cast<vtkAbstractTransform*>(turned) })
  {
    reached = lattice->FitToTransform(transform, Bounds, 0.1);
    double wanted[3];
    double found[3];
    transform->TransformPoint(top, wanted);
    lattice->TransformPoint(top, found);
    FFD_CHECK(reached >= 0.0 && reached <= 0.1);
    FFD_CHECK(std::sqrt(vtkMath::Distance2BetweenPoints(wanted, found)) <= 0.1);
  }

  // Another B-spline, and a chain with an inverse in it.
  vtkNew<vtkFFDLattice> other;
  other->SetDimensions(6, 6, 6);
  other->FitToBounds(Bounds, 0.2);
  random.Shape(other, 0.3);
  vtkNew<vtkGeneralTransform> general;
  general->Concatenate(linear);
  general->Concatenate(other);
  general->Inverse();
  reached = lattice->FitToTransform(other, Bounds, 0.01);
  FFD_CHECK(reached <= 0.01 && Error(lattice, other) < 0.02);
  vtkNew<vtkTransform> back;
  back->SetMatrix(linear->GetMatrix());
  back->Inverse();
  vtkNew<vtkGeneralTransform> chain;
  chain->Concatenate(other->GetInverse());
  chain->Concatenate(back);
  reached = lattice->FitToTransform(chain, Bounds, 0.05);
  FFD_CHECK(reached >= 0.0 && reached <= 0.05);
  FFD_CHECK(Error(lattice, chain) < 0.1);

  // A map that varies along z only is refined along z only.
  vtkNew<vtkFFDLattice> layers;
  layers->SetDimensions(4, 4, 35);
  layers->SetDomain(Bounds);
  for (int k = 0; k < 35; ++k)
  {
    for (int i = 0; i < 16; ++i)
    {
      layers->SetDisplacement(i % 4, i / 4, k, std::sin(0.5 * k), 0.0, 0.0);
    }
  }
  reached = lattice->FitToTransform(layers, Bounds, 1e-3);
  int n[3];
  lattice->GetDimensions(n);
  FFD_CHECK(reached <= 1e-3 && n[0] == 7 && n[1] == 7 && n[2] > 14);

  // A flat region gets a slab.
  const double flat[6] = { 0.0, 10.0, 0.0, 8.0, 5.0, 5.0 };
  FFD_CHECK(lattice->FitToTransform(linear, flat, 1e-3) < 1e-10);
  return EXIT_SUCCESS;
}
