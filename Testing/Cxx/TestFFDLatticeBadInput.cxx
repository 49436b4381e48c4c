// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What is wrong is refused with one error that names it, and the lattice stays as it was.
#include "FFDTestHelpers.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkTransform.h"

#include <algorithm>
#include <functional>
#include <limits>

int TestFFDLatticeBadInput(int, char*[])
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  FFDRandom random(5);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(5, 4, 6);
  lattice->SetDomain(0, 4, 0, 4, 0, 4);
  random.Shape(lattice, 0.3);
  vtkNew<FFDErrorLog> log;
  log->Watch(lattice);

  vtkNew<vtkImageData> oneComponent;
  oneComponent->SetDimensions(5, 5, 5);
  oneComponent->AllocateScalars(VTK_DOUBLE, 1);
  vtkNew<vtkImageData> thin;
  thin->SetDimensions(5, 3, 5);
  thin->AllocateScalars(VTK_DOUBLE, 3);
  vtkNew<vtkImageData> notFinite;
  notFinite->SetDimensions(4, 4, 4);
  notFinite->AllocateScalars(VTK_DOUBLE, 3);
  notFinite->GetPointData()->GetScalars()->Fill(0.0);
  notFinite->GetPointData()->GetScalars()->SetComponent(5, 2, inf);
  vtkNew<vtkImageData> noScalars;
  noScalars->SetDimensions(4, 4, 4);
  vtkNew<vtkDoubleArray> wrongShape;
  wrongShape->SetNumberOfComponents(3);
  wrongShape->SetNumberOfTuples(119);
  vtkNew<vtkDoubleArray> nanArray;
  nanArray->SetNumberOfComponents(3);
  nanArray->SetNumberOfTuples(120);
  nanArray->Fill(0.0);
  nanArray->SetValue(100, nan);
  vtkNew<vtkTransform> toNaN;
  toNaN->Scale(1e308, 1.0, 1.0);
  toNaN->Scale(1e308, 1.0, 1.0);
  vtkNew<vtkTransform> fine;
  const double unit[6] = { 0, 1, 0, 1, 0, 1 };
  const double inverted[6] = { 0, 1, 2, 1, 0, 1 };
  const double point[6] = { 1, 1, 1, 1, 1, 1 };
  const double nanBounds[6] = { 0, 1, 0, nan, 0, 1 };
  const double huge[6] = { 1e300, std::nextafter(1e300, 2e300), 0, 1, 0, 1 };
  double out[6];

  struct Case
  {
    const char* Message;
    std::function<void()> Call;
  };
  const Case cases[] = {
    { "SetDimensions: (3, 4, 4)", [&] { lattice->SetDimensions(3, 4, 4); } },
    { "4 to 1024", [&] { lattice->SetDimensions(4, 4, 100000); } },
    { "SetDimensions: (-1", [&] { lattice->SetDimensions(-1, 4, 4); } },
    { "dimensions is null", [&] { lattice->SetDimensions(nullptr); } },
    { "SetDomain: the domain (0, 1, 2, 1, 0, 1) is empty, inverted",
      [&] { lattice->SetDomain(inverted); } },
    { "axis 1", [&] { lattice->SetDomain(nanBounds); } },
    { "SetDomain", [&] { lattice->SetDomain(0, inf, 0, 1, 0, 1); } },
    { "axis 0", [&] { lattice->SetDomain(point); } },
    { "axis 0", [&] { lattice->SetDomain(huge); } },
    { "bounds is null", [&] { lattice->SetDomain(nullptr); } },
    { "FitToBounds: the bounds (0, 1, 2, 1", [&] { lattice->FitToBounds(inverted); } },
    { "single point", [&] { lattice->FitToBounds(point); } },
    { "not finite", [&] { lattice->FitToBounds(nanBounds); } },
    { "the padding is -0.1", [&] { lattice->FitToBounds(unit, -0.1); } },
    { "the padding is", [&] { lattice->FitToBounds(unit, nan); } },
    { "bounds is null", [&] { lattice->FitToBounds(nullptr); } },
    { "no control point (5, 0, 0)", [&] { lattice->SetDisplacement(5, 0, 0, 1, 1, 1); } },
    { "no control point (0, -1, 0)", [&] { lattice->SetControlPoint(0, -1, 0, 1, 1, 1); } },
    { "Give finite", [&] { lattice->SetDisplacement(1, 1, 1, 0, nan, 0); } },
    { "Give finite", [&] { lattice->SetControlPoint(1, 1, 1, inf, 0, 0); } },
    { "displacement is null", [&] { lattice->SetDisplacement(1, 1, 1, nullptr); } },
    { "point is null", [&] { lattice->SetControlPoint(1, 1, 1, nullptr); } },
    { "no control point (0, 0, 6)", [&] { lattice->GetDisplacement(0, 0, 6, out); } },
    { "no control point (0, 0, 6)", [&] { lattice->GetControlPoint(0, 0, 6, out); } },
    { "no control point (0, 9, 6)", [&] { lattice->GetRestPoint(0, 9, 6, out); } },
    { "SetDisplacements: the array is null", [&] { lattice->SetDisplacements(nullptr); } },
    { "has another shape", [&] { lattice->SetDisplacements(wrongShape); } },
    { "tuple 33", [&] { lattice->SetDisplacements(nanArray); } },
    { "Refine: factor 0 on axis 1", [&] { lattice->Refine(1, 0, 1); } },
    { "Refine: factor 65", [&] { lattice->Refine(65); } },
    { "Extend: 0 layers", [&] { lattice->Extend(0); } },
    { "SetDisplacementScale: the scale is", [&] { lattice->SetDisplacementScale(nan); } },
    { "SetInverseTolerance", [&] { lattice->SetInverseTolerance(0.0); } },
    { "SetInverseTolerance", [&] { lattice->SetInverseTolerance(nan); } },
    { "GetDeformedBounds", [&] { lattice->GetDeformedBounds(inverted, out); } },
    { "(null)", [&] { lattice->GetDeformedBounds(nullptr, out); } },
    { "AttachTo: the data object is null", [&] { lattice->AttachTo(nullptr); } },
    { "the data object is null", [&] { lattice->ReadFrom(nullptr); } },
    { "ToImageData: the image is null", [&] { lattice->ToImageData(nullptr); } },
    { "Give an image of its own", [&] { lattice->ToImageData(lattice->GetCoefficientData()); } },
    { "it is null", [&] { lattice->FromImageData(nullptr); } },
    { "no point scalars with 3 components", [&] { lattice->FromImageData(oneComponent); } },
    { "no point scalars", [&] { lattice->FromImageData(noScalars); } },
    { "axis 1 has 3", [&] { lattice->FromImageData(thin); } },
    { "control point 5 is not finite", [&] { lattice->SetCoefficientData(notFinite); } },
    { "it is null", [&] { lattice->SetCoefficientData(nullptr); } },
    { "the connection is null", [&] { lattice->SetCoefficientConnection(nullptr); } },
    { "ShallowCopy: the other lattice is null", [&] { lattice->ShallowCopy(nullptr); } },
    { "the transform is null", [&] { lattice->FitToTransform(nullptr, unit, 0.1); } },
    { "this lattice itself", [&] { lattice->FitToTransform(lattice, unit, 0.1); } },
    { "tolerance 0", [&] { lattice->FitToTransform(fine, unit, 0.0); } },
    { "maximumCells 0", [&] { lattice->FitToTransform(fine, unit, 0.1, 0); } },
    { "inverted", [&] { lattice->FitToTransform(fine, inverted, 0.1); } },
    { "(null)", [&] { lattice->FitToTransform(fine, nullptr, 0.1); } },
    { "gives points that are not finite", [&] { lattice->FitToTransform(toNaN, unit, 0.1); } },
  };
  vtkNew<vtkFFDLattice> before;
  before->DeepCopy(lattice);
  const vtkMTimeType time = lattice->GetMTime();
  for (const Case& c : cases)
  {
    c.Call();
    if (!log->Had(c.Message))
    {
      return EXIT_FAILURE;
    }
  }
  FFD_CHECK(lattice->GetMTime() == time);
  double a[6];
  double b[6];
  lattice->GetDomain(a);
  before->GetDomain(b);
  FFD_CHECK(std::equal(a, a + 6, b));
  for (vtkIdType i = 0; i < 360; ++i)
  {
    FFD_CHECK(lattice->GetDisplacements()->GetValue(i) == before->GetDisplacements()->GetValue(i));
  }

  // ZeroAtBorder cannot be continued.
  lattice->SetBorderModeToZeroAtBorder();
  FFD_CHECK(lattice->Extend(1) == 0 && log->Had("ZeroAtBorder"));
  lattice->SetBorderModeToEdge();

  // Written behind the setters: reported once per update, identity meanwhile, then well again.
  lattice->GetDisplacements()->SetValue(30, nan);
  lattice->Modified();
  const double p[3] = { 1.0, 2.0, 3.0 };
  double q[3];
  lattice->TransformPoint(p, q);
  FFD_CHECK(log->Had("control point 10 is not finite"));
  FFD_CHECK(FFDDistance(p, q) == 0.0);
  lattice->GetInverse()->TransformPoint(p, q);
  lattice->GetDeformedBounds(unit, out);
  FFD_CHECK(out[0] == 0.0 && out[5] == 1.0);
  log->Had("");
  lattice->Reset();
  lattice->SetDisplacement(2, 2, 2, 1.0, 0.0, 0.0);
  log->Count = 0;
  log->Message.clear();
  lattice->TransformPoint(p, q);
  FFD_CHECK(log->Count == 0 && FFDDistance(p, q) > 1e-3);

  // Another array put into the coefficient image: refused, and the setters do not crash.
  lattice->GetCoefficientData()->AllocateScalars(VTK_FLOAT, 1);
  lattice->GetCoefficientData()->Modified();
  lattice->TransformPoint(p, q);
  FFD_CHECK(log->Had("coefficient image was given another array"));
  FFD_CHECK(FFDDistance(p, q) == 0.0);
  lattice->SetDisplacement(1, 1, 1, 0.0, 0.0, 0.5);
  lattice->GetCoefficientData()->SetDimensions(9, 9, 9);
  lattice->SetDisplacement(8, 8, 8, 0.0, 0.0, 0.5);
  FFD_CHECK(log->Had("no control point (8, 8, 8)"));

  // NaN as the point to transform must not crash or hang.
  vtkNew<vtkFFDLattice> good;
  good->SetDisplacement(1, 1, 1, 0.1, 0.2, 0.3);
  const double nanPoint[3] = { nan, 0.0, 0.0 };
  good->TransformPoint(nanPoint, q);
  good->GetInverse()->TransformPoint(nanPoint, q);
  FFD_CHECK(!std::isfinite(q[0]));
  FFD_CHECK(!vtkFFDLattice::HasLattice(nullptr));
  vtkFFDLattice::DetachFrom(nullptr);
  return EXIT_SUCCESS;
}
