// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDLattice as a user handles it: defaults, editing, refinement, copies, times, bounds.
#include "FFDTestHelpers.h"

#include "vtkAbstractTransform.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkGeneralTransform.h"
#include "vtkImageData.h"
#include "vtkMath.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <sstream>
#include <thread>

namespace
{

int TestDefaultsAndEditing()
{
  vtkNew<vtkFFDLattice> lattice;
  int n[3];
  double domain[6];
  lattice->GetDimensions(n);
  lattice->GetDomain(domain);
  FFD_CHECK(n[0] == 4 && n[1] == 4 && n[2] == 4);
  FFD_CHECK(lattice->GetNumberOfControlPoints() == 64);
  for (int a = 0; a < 3; ++a)
  {
    FFD_CHECK(domain[2 * a] == 0.0 && domain[2 * a + 1] == 1.0);
  }
  FFD_CHECK(lattice->IsIdentity() && lattice->IsFoldFree());
  FFD_CHECK(lattice->GetMinimumJacobianBound() == 1.0);

  lattice->SetDimensions(6, 5, 7);
  lattice->SetDomain(-10.0, 20.0, 0.0, 4.0, 5.0, 9.0);
  lattice->GetDomain(domain);
  FFD_CHECK_NEAR(domain[0], -10.0, 1e-14);
  FFD_CHECK_NEAR(domain[1], 20.0, 1e-13);
  double rest[3];
  lattice->GetRestPoint(1, 1, 1, rest);
  FFD_CHECK_NEAR(rest[0], -10.0, 1e-14);
  FFD_CHECK_NEAR(rest[2], 5.0, 1e-14);
  lattice->GetRestPoint(4, 3, 5, rest);
  FFD_CHECK_NEAR(rest[0], 20.0, 1e-13);
  FFD_CHECK_NEAR(rest[1], 4.0, 1e-13);
  FFD_CHECK_NEAR(rest[2], 9.0, 1e-13);

  lattice->SetControlPoint(2, 3, 4, 1.0, 2.0, 3.0);
  double point[3];
  double displacement[3];
  lattice->GetControlPoint(2, 3, 4, point);
  lattice->GetRestPoint(2, 3, 4, rest);
  lattice->GetDisplacement(2, 3, 4, displacement);
  const double wanted[3] = { 1.0, 2.0, 3.0 };
  for (int a = 0; a < 3; ++a)
  {
    FFD_CHECK_NEAR(point[a], wanted[a], 1e-14);
    FFD_CHECK_NEAR(displacement[a], wanted[a] - rest[a], 1e-14);
  }
  // x fastest.
  double tuple[3];
  lattice->GetDisplacements()->GetTuple(2 + 6 * (3 + 5 * 4), tuple);
  FFD_CHECK(FFDDistance(tuple, displacement) == 0.0);
  FFD_CHECK(!lattice->IsIdentity());
  // Strength zero is no deformation, whatever the control points.
  lattice->SetDisplacementScale(0.0);
  FFD_CHECK(lattice->IsIdentity());
  double q[3];
  lattice->TransformPoint(wanted, q);
  FFD_CHECK(FFDDistance(q, wanted) == 0.0);
  lattice->SetDisplacementScale(1.0);
  lattice->Reset();
  FFD_CHECK(lattice->IsIdentity());
  FFD_CHECK(lattice->GetNumberOfControlPoints() == 210);

  vtkNew<vtkFloatArray> all;
  all->SetNumberOfComponents(3);
  all->SetNumberOfTuples(210);
  all->Fill(0.25);
  FFD_CHECK(lattice->SetDisplacements(all) == 1);
  const double inside[3] = { 3.0, 2.0, 7.0 };
  lattice->TransformPoint(inside, q);
  for (int a = 0; a < 3; ++a)
  {
    FFD_CHECK_NEAR(q[a], inside[a] + 0.25, 1e-13);
  }
  std::ostringstream text;
  lattice->Print(text);
  for (const char* name : { "Dimensions: (6, 5, 7)", "Domain: (-10", "IsIdentity: false",
         "CoefficientData:", "BorderMode: Edge", "DisplacementScale: 1", "InverseTolerance" })
  {
    FFD_CHECK(text.str().find(name) != std::string::npos);
  }
  return EXIT_SUCCESS;
}

int TestTimes()
{
  vtkNew<vtkFFDLattice> lattice;
  const auto changed = [&lattice](auto&& edit) {
    const vtkMTimeType before = lattice->GetMTime();
    edit();
    return lattice->GetMTime() > before;
  };
  FFD_CHECK(changed([&] { lattice->SetDimensions(5, 5, 5); }));
  FFD_CHECK(!changed([&] { lattice->SetDimensions(5, 5, 5); }));
  FFD_CHECK(changed([&] { lattice->SetDomain(0, 3, 0, 3, 0, 7); }));
  FFD_CHECK(!changed([&] { lattice->SetDomain(0, 3, 0, 3, 0, 7); }));
  const double bounds[6] = { 0, 3, 0, 3, 0, 7 };
  FFD_CHECK(!changed([&] { lattice->FitToBounds(bounds); }));
  FFD_CHECK(changed([&] { lattice->FitToBounds(bounds, 0.1); }));
  FFD_CHECK(changed([&] { lattice->SetDisplacement(1, 1, 1, 1, 0, 0); }));
  FFD_CHECK(!changed([&] { lattice->SetDisplacement(1, 1, 1, 1, 0, 0); }));
  vtkNew<vtkDoubleArray> copy;
  copy->DeepCopy(lattice->GetDisplacements());
  FFD_CHECK(!changed([&] { lattice->SetDisplacements(copy); }));
  copy->SetValue(3, 0.5);
  FFD_CHECK(changed([&] { lattice->SetDisplacements(copy); }));
  FFD_CHECK(changed([&] { lattice->SetBorderModeToZero(); }));
  FFD_CHECK(!changed([&] { lattice->SetBorderModeToZero(); }));
  FFD_CHECK(changed([&] { lattice->SetDisplacementScale(2.0); }));
  FFD_CHECK(!changed([&] { lattice->SetDisplacementScale(2.0); }));
  FFD_CHECK(changed([&] { lattice->Refine(2); }));
  FFD_CHECK(!changed([&] { lattice->Refine(1); }));
  FFD_CHECK(changed([&] { lattice->Extend(1); }));
  FFD_CHECK(changed([&] { lattice->GetDisplacements()->Modified(); }));
  FFD_CHECK(changed([&] { lattice->Reset(); }));
  FFD_CHECK(!changed([&] { lattice->Reset(); }));
  // Queries are no edits.
  FFD_CHECK(!changed([&] {
    double b[6];
    lattice->GetDeformedBounds(bounds, b);
    lattice->GetDisplacementBounds(b);
    lattice->IsFoldFree();
    lattice->TransformPoint(b, b);
  }));

  // An edit in place counts after Modified(), and takes effect.
  double p[3] = { 1.0, 1.0, 1.0 };
  double q[3];
  lattice->SetDisplacementScale(1.0);
  lattice->TransformPoint(p, q);
  FFD_CHECK(FFDDistance(p, q) == 0.0);
  lattice->GetDisplacements()->Fill(3.0);
  lattice->Modified();
  lattice->TransformPoint(p, q);
  FFD_CHECK_NEAR(q[1], 4.0, 1e-12);
  // A consumer sees it: the general transform re-evaluates.
  vtkNew<vtkGeneralTransform> general;
  general->SetInput(lattice);
  const vtkMTimeType before = general->GetMTime();
  lattice->SetDisplacement(2, 2, 2, 9, 9, 9);
  FFD_CHECK(general->GetMTime() > before);
  return EXIT_SUCCESS;
}

int TestRefine()
{
  FFDRandom random(1);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(6, 5, 7);
  lattice->SetDomain(-3.0, 10.0, 2.0, 9.0, 0.0, 5.0);
  random.Shape(lattice, 1.0);
  vtkNew<vtkFFDLattice> fine;
  fine->DeepCopy(lattice);
  FFD_CHECK(fine->Refine(2, 3, 1) == 1);
  int n[3];
  fine->GetDimensions(n);
  FFD_CHECK(n[0] == 9 && n[1] == 9 && n[2] == 7);
  vtkNew<vtkFFDLattice> resized;
  resized->DeepCopy(lattice);
  resized->SetDimensions(9, 9, 7);
  vtkNew<vtkFFDLattice> approximate;
  approximate->DeepCopy(lattice);
  approximate->SetDimensions(11, 12, 13);
  for (int i = 0; i < 500; ++i)
  {
    double p[3];
    double a[3];
    double b[3];
    random.Point(lattice, 0.0, p);
    lattice->TransformPoint(p, a);
    fine->TransformPoint(p, b);
    FFD_CHECK(FFDDistance(a, b) < 1e-12);
    resized->TransformPoint(p, b);
    FFD_CHECK(FFDDistance(a, b) < 1e-12);
    approximate->TransformPoint(p, b);
    FFD_CHECK(FFDDistance(a, b) < 0.5);
  }

  // With layers added first the map is the same everywhere.
  for (const int border : { VTK_BSPLINE_EDGE, VTK_BSPLINE_ZERO })
  {
    lattice->SetBorderMode(border);
    vtkNew<vtkFFDLattice> wide;
    wide->DeepCopy(lattice);
    FFD_CHECK(wide->Extend(border == VTK_BSPLINE_EDGE ? 2 : 3) == 1);
    vtkNew<vtkFFDLattice> both;
    both->DeepCopy(wide);
    FFD_CHECK(both->Refine() == 1);
    for (int i = 0; i < 1000; ++i)
    {
      double p[3];
      double a[3];
      double b[3];
      random.Point(lattice, 5.0, p);
      lattice->TransformPoint(p, a);
      wide->TransformPoint(p, b);
      FFD_CHECK(FFDDistance(a, b) < 1e-12);
      both->TransformPoint(p, b);
      FFD_CHECK(FFDDistance(a, b) < 1e-12);
    }
  }
  return EXIT_SUCCESS;
}

/// Bounds that are asked for while another thread updates the lattice.
int TestThreads()
{
  FFDRandom random(5);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(6, 6, 6);
  random.Shape(lattice, 0.2);
  double expected[6];
  lattice->GetDisplacementBounds(expected);
  std::atomic<bool> done(false);
  std::thread updates([&] {
    while (!done)
    {
      lattice->Modified();
      lattice->Update();
    }
  });
  bool same = true;
  for (int n = 0; n < 300; ++n)
  {
    double bounds[6];
    lattice->GetDisplacementBounds(bounds);
    same = same && std::equal(bounds, bounds + 6, expected);
  }
  done = true;
  updates.join();
  FFD_CHECK(same);
  return EXIT_SUCCESS;
}

int TestCopies()
{
  FFDRandom random(2);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(5, 6, 4);
  lattice->SetDomain(0, 8, 0, 8, 0, 8);
  lattice->SetBorderModeToZeroAtBorder();
  lattice->SetDisplacementScale(0.5);
  lattice->SetInverseTolerance(1e-9);
  random.Shape(lattice, 0.3);
  vtkNew<vtkFFDLattice> deep;
  deep->DeepCopy(lattice);
  vtkNew<vtkFFDLattice> shallow;
  shallow->ShallowCopy(lattice);
  FFD_CHECK(shallow->GetDisplacements() == lattice->GetDisplacements());
  FFD_CHECK(deep->GetDisplacements() != lattice->GetDisplacements());
  for (vtkFFDLattice* copy : { deep.Get(), shallow.Get() })
  {
    FFD_CHECK(copy->GetBorderMode() == VTK_BSPLINE_ZERO_AT_BORDER);
    FFD_CHECK(copy->GetDisplacementScale() == 0.5 && copy->GetInverseTolerance() == 1e-9);
    for (int i = 0; i < 50; ++i)
    {
      double p[3];
      double a[3];
      double b[3];
      random.Point(lattice, 2.0, p);
      lattice->TransformPoint(p, a);
      copy->TransformPoint(p, b);
      FFD_CHECK(FFDDistance(a, b) == 0.0);
    }
  }
  const vtkMTimeType deepTime = deep->GetMTime();
  const vtkMTimeType shallowTime = shallow->GetMTime();
  lattice->SetDisplacement(2, 2, 2, 1.0, 1.0, 1.0);
  FFD_CHECK(deep->GetMTime() == deepTime && shallow->GetMTime() > shallowTime);
  double d[3];
  shallow->GetDisplacement(2, 2, 2, d);
  FFD_CHECK(d[0] == 1.0);
  deep->GetDisplacement(2, 2, 2, d);
  FFD_CHECK(d[0] != 1.0);
  // Written in place: either Modified() tells both.
  double bounds[6];
  lattice->GetDisplacements()->SetComponent(72, 0, 1e3);
  lattice->GetDisplacements()->Modified();
  shallow->GetDisplacementBounds(bounds);
  FFD_CHECK(bounds[1] > 1e2);
  lattice->GetDisplacements()->SetComponent(72, 1, 1e3);
  lattice->Modified();
  shallow->GetDisplacementBounds(bounds);
  FFD_CHECK(bounds[3] > 1e2);
  // A new size is its own affair.
  lattice->SetDimensions(7, 7, 7);
  FFD_CHECK(shallow->GetNumberOfControlPoints() == 120);

  // The generic ways of VTK.
  vtkAbstractTransform* made = lattice->MakeTransform();
  FFD_CHECK(made->IsA("vtkFFDLattice"));
  made->DeepCopy(lattice);
  double p[3] = { 4.0, 4.1, 4.2 };
  double a[3];
  double b[3];
  lattice->TransformPoint(p, a);
  made->TransformPoint(p, b);
  FFD_CHECK(FFDDistance(a, b) == 0.0);
  made->Delete();
  vtkNew<vtkBSplineTransform> plain;
  plain->DeepCopy(lattice);
  plain->TransformPoint(p, b);
  FFD_CHECK(FFDDistance(a, b) < 1e-12);
  return EXIT_SUCCESS;
}

int TestInverse()
{
  FFDRandom random(3);
  for (const int border : { VTK_BSPLINE_EDGE, VTK_BSPLINE_ZERO, VTK_BSPLINE_ZERO_AT_BORDER })
  {
    vtkNew<vtkFFDLattice> lattice;
    lattice->SetDimensions(7, 6, 5);
    lattice->SetDomain(0, 9, 0, 7, 0, 5);
    lattice->SetBorderMode(border);
    lattice->SetInverseTolerance(1e-8);
    random.Shape(lattice, 0.4);
    FFD_CHECK(lattice->IsFoldFree());
    vtkAbstractTransform* inverse = lattice->GetInverse();
    for (int i = 0; i < 500; ++i)
    {
      double p[3];
      double q[3];
      double back[3];
      random.Point(lattice, 3.0, p);
      inverse->TransformPoint(p, q);
      lattice->TransformPoint(q, back);
      FFD_CHECK(FFDDistance(p, back) <= 1.001e-8);
      // The derivative of the inverse is the inverse of the derivative (VTK stores it inverted).
      double slope[3][3];
      double forward[3][3];
      double product[3][3];
      inverse->InternalTransformDerivative(p, back, slope);
      lattice->InternalTransformDerivative(q, back, forward);
      vtkMath::Multiply3x3(slope, forward, product);
      for (int r = 0; r < 3; ++r)
      {
        for (int c = 0; c < 3; ++c)
        {
          FFD_CHECK_NEAR(product[r][c], r == c ? 1.0 : 0.0, 1e-6);
        }
      }
      const float single[3] = { static_cast<float>(p[0]), static_cast<float>(p[1]),
        static_cast<float>(p[2]) };
      float singleQ[3];
      inverse->TransformPoint(single, singleQ);
      FFD_CHECK_NEAR(singleQ[0], q[0], 1e-4);
    }
    // The inverse follows an edit.
    double p[3] = { 4.0, 3.0, 2.0 };
    double q[3];
    lattice->Reset();
    inverse->TransformPoint(p, q);
    FFD_CHECK(FFDDistance(p, q) < 1e-12);
    // In place, and twice is none.
    lattice->SetDisplacement(3, 3, 3, 0.5, 0.5, 0.5);
    lattice->Inverse();
    FFD_CHECK(lattice->GetInverseFlag() == 1);
    lattice->TransformPoint(p, q);
    lattice->Inverse();
    double back[3];
    lattice->TransformPoint(q, back);
    FFD_CHECK(FFDDistance(p, back) <= 1.001e-8 && FFDDistance(p, q) > 1e-3);
  }
  return EXIT_SUCCESS;
}

int TestBounds()
{
  FFDRandom random(4);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(6, 6, 6);
  lattice->SetDomain(0, 10, 0, 10, 0, 10);
  random.Shape(lattice, 0.38);
  const double rest[6] = { 1.0, 9.0, 2.0, 8.0, 0.0, 10.0 };
  for (int inverse = 0; inverse < 2; ++inverse)
  {
    double bounds[6];
    lattice->GetDeformedBounds(rest, bounds);
    double sampled[6] = { 1e9, -1e9, 1e9, -1e9, 1e9, -1e9 };
    for (int i = 0; i < 20000; ++i)
    {
      double p[3];
      double q[3];
      for (int a = 0; a < 3; ++a)
      {
        p[a] = random.Number(rest[2 * a], rest[2 * a + 1]);
      }
      lattice->TransformPoint(p, q);
      for (int a = 0; a < 3; ++a)
      {
        FFD_CHECK(q[a] >= bounds[2 * a] && q[a] <= bounds[2 * a + 1]);
        sampled[2 * a] = std::min(sampled[2 * a], q[a]);
        sampled[2 * a + 1] = std::max(sampled[2 * a + 1], q[a]);
      }
    }
    for (int a = 0; a < 3; ++a)
    {
      // A spacing is 3.3.
      FFD_CHECK(sampled[2 * a] - bounds[2 * a] < (inverse ? 2.0 : 0.7));
      FFD_CHECK(bounds[2 * a + 1] - sampled[2 * a + 1] < (inverse ? 2.0 : 0.7));
    }
    lattice->Inverse();
  }
  double d[6];
  lattice->GetDisplacementBounds(d);
  FFD_CHECK(d[1] > 0.0 && d[1] <= 0.38 * 10.0 / 3.0 * 1.001 && d[0] < 0.0);

  FFD_CHECK(lattice->IsFoldFree());
  double range[2];
  lattice->GetJacobianDeterminantBounds(range);
  FFD_CHECK(range[0] > 0.0 && range[0] < 1.0 && range[1] > 1.0);
  FFD_CHECK(lattice->GetMinimumJacobianBound() == range[0]);
  lattice->SetDisplacement(2, 2, 2, 9.0, 0.0, 0.0);
  lattice->SetDisplacement(3, 2, 2, -9.0, 0.0, 0.0);
  FFD_CHECK(!lattice->IsFoldFree());
  // Half the strength halves the displacements.
  lattice->Reset();
  lattice->SetDisplacement(2, 2, 2, 4.0, 0.0, 0.0);
  lattice->SetDisplacementScale(-0.5);
  lattice->GetDisplacementBounds(d);
  FFD_CHECK(d[0] >= -2.0001 && d[0] < -0.3 && d[1] < 1e-4);
  return EXIT_SUCCESS;
}

int TestFitToBounds()
{
  vtkNew<vtkFFDLattice> lattice;
  double domain[6];
  const double bounds[6] = { 0, 10, -5, 5, 1, 3 };
  lattice->FitToBounds(bounds, 0.1);
  lattice->GetDomain(domain);
  FFD_CHECK_NEAR(domain[0], -1.0, 1e-13);
  FFD_CHECK_NEAR(domain[3], 6.0, 1e-13);
  FFD_CHECK_NEAR(domain[5], 3.2, 1e-13);
  // A 2-D image gets a slab.
  const double flat[6] = { 0, 10, -2, 2, 7, 7 };
  lattice->FitToBounds(flat);
  lattice->GetDomain(domain);
  FFD_CHECK_NEAR(domain[4], 5.0, 1e-13);
  FFD_CHECK_NEAR(domain[5], 9.0, 1e-13);
  return EXIT_SUCCESS;
}

} // namespace

int TestFFDLattice(int, char*[])
{
  return TestDefaultsAndEditing() || TestTimes() || TestRefine() || TestCopies() || TestThreads() ||
      TestInverse() || TestBounds() || TestFitToBounds()
    ? EXIT_FAILURE
    : EXIT_SUCCESS;
}
