// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// A lattice and a vtkBSplineTransform with the same coefficients are the same map, in all border
// modes, inside, across and outside the border; so is the kernels' field of either.
#include "FFDTestHelpers.h"

// By path: private, so not on the include path of the tests.
#include "../../Module/Kernels/FFDBSplineField.h"
#include "vtkFFDBSplineFieldFromTransform.h"

#include "vtkBSplineTransform.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <algorithm>

namespace
{

/// The field gives the point and derivative that the transform does.
int CompareField(vtkBSplineTransform* transform, const ffd::BSplineField& field, FFDRandom& random,
  double tolerance)
{
  int extent[6];
  double origin[3];
  double spacing[3];
  transform->GetCoefficientData()->GetExtent(extent);
  transform->GetCoefficientData()->GetOrigin(origin);
  transform->GetCoefficientData()->GetSpacing(spacing);
  transform->Update();
  for (int i = 0; i < 400; ++i)
  {
    double p[3];
    for (int a = 0; a < 3; ++a)
    {
      p[a] = origin[a] + spacing[a] * random.Number(extent[2 * a] - 3.0, extent[2 * a + 1] + 3.0);
    }
    double q[3];
    double slope[3][3];
    transform->InternalTransformDerivative(p, q, slope);
    glm::dmat3 jacobian;
    const glm::dvec3 d = field.Displacement({ p[0], p[1], p[2] }, jacobian);
    for (int a = 0; a < 3; ++a)
    {
      FFD_CHECK_NEAR(q[a], p[a] + d[a], tolerance * std::max(1.0, std::abs(q[a])));
      for (int b = 0; b < 3; ++b)
      {
        FFD_CHECK_NEAR(slope[a][b], jacobian[b][a] + (a == b ? 1.0 : 0.0), tolerance);
      }
    }
  }
  return EXIT_SUCCESS;
}

int CompareLattices(int border)
{
  FFDRandom random(10 + border);
  for (int i = 0; i < 10; ++i)
  {
    vtkNew<vtkFFDLattice> lattice;
    lattice->SetDimensions(4 + i % 3, 4 + i / 3, 7);
    lattice->SetDomain(-3.0, 8.0, 100.0, 103.0, 0.0, 5.0);
    lattice->SetBorderMode(border);
    lattice->SetDisplacementScale(0.7);
    random.Shape(lattice, 1.5);
    vtkNew<vtkImageData> coefficients;
    coefficients->DeepCopy(lattice->GetCoefficientData());
    vtkNew<vtkBSplineTransform> reference;
    reference->SetCoefficientData(coefficients);
    reference->SetBorderMode(border);
    reference->SetDisplacementScale(0.7);
    lattice->Update();
    reference->Update();
    for (int j = 0; j < 400; ++j)
    {
      double p[3];
      double q[3];
      double r[3];
      double slope[3][3];
      double wanted[3][3];
      random.Point(lattice, 4.0, p);
      lattice->TransformPoint(p, q);
      reference->TransformPoint(p, r);
      FFD_CHECK(FFDDistance(q, r) <= 1e-9 * std::max(1.0, std::abs(r[1])));
      lattice->InternalTransformDerivative(p, q, slope);
      reference->InternalTransformDerivative(p, r, wanted);
      for (int a = 0; a < 9; ++a)
      {
        FFD_CHECK_NEAR(slope[a / 3][a % 3], wanted[a / 3][a % 3], 1e-9);
      }
    }
    for (vtkBSplineTransform* transform :
      { static_cast<vtkBSplineTransform*>(lattice), reference.Get() })
    {
      ffd::BSplineField field;
      bool inverse = true;
      std::string error;
      FFD_CHECK(vtkFFDBSplineFieldFromTransform(transform, field, inverse, error));
      FFD_CHECK(!inverse && error.empty());
      FFD_CHECK(CompareField(transform, field, random, 1e-9) == EXIT_SUCCESS);
    }
  }
  return EXIT_SUCCESS;
}

/// Extents that do not start at 0, flat images, scalar types, adopted by the lattice, too.
int CompareImages(int border)
{
  const int extents[][6] = { { 3, 9, -4, 1, 10, 15 }, { 0, 0, 0, 5, 2, 7 }, { 5, 6, 0, 2, 3, 3 } };
  FFDRandom random(20 + border);
  for (const int* extent : extents)
  {
    for (const int type : { VTK_FLOAT, VTK_DOUBLE })
    {
      vtkNew<vtkImageData> image;
      image->SetExtent(const_cast<int*>(extent));
      image->SetOrigin(1.0, -2.0, 3.0);
      image->SetSpacing(0.5, 2.0, 1.5);
      image->AllocateScalars(type, 3);
      vtkDataArray* scalars = image->GetPointData()->GetScalars();
      for (vtkIdType i = 0; i < scalars->GetNumberOfTuples(); ++i)
      {
        for (int a = 0; a < 3; ++a)
        {
          scalars->SetComponent(i, a, random.Number(-1.0, 1.0));
        }
      }
      vtkNew<vtkBSplineTransform> transform;
      transform->SetCoefficientData(image);
      transform->SetBorderMode(border);
      transform->SetDisplacementScale(-1.3);
      transform->Inverse();
      ffd::BSplineField field;
      bool inverse = false;
      std::string error;
      FFD_CHECK(vtkFFDBSplineFieldFromTransform(transform, field, inverse, error));
      FFD_CHECK(inverse);
      transform->Inverse();
      FFD_CHECK(CompareField(transform, field, random, 1e-9) == EXIT_SUCCESS);
      if (extent[0] == 3)
      {
        vtkNew<vtkFFDLattice> lattice;
        lattice->SetBorderMode(border);
        lattice->SetDisplacementScale(-1.3);
        lattice->SetCoefficientData(image);
        FFD_CHECK(lattice->GetNumberOfControlPoints() == 7 * 6 * 6);
        FFD_CHECK(CompareField(lattice, field, random, 1e-9) == EXIT_SUCCESS);
      }
    }
  }
  return EXIT_SUCCESS;
}

int TestFieldErrors()
{
  ffd::BSplineField field;
  bool inverse = true;
  std::string error;
  FFD_CHECK(!vtkFFDBSplineFieldFromTransform(nullptr, field, inverse, error));
  FFD_CHECK(error.find("null") != std::string::npos && !inverse);
  // VTK's identity: no coefficients at all.
  vtkNew<vtkBSplineTransform> none;
  FFD_CHECK(vtkFFDBSplineFieldFromTransform(none, field, inverse, error));
  FFD_CHECK(field.IsZero());
  // Integers are no problem for us; VTK itself only takes float and double, with an error.
  vtkNew<vtkImageData> image;
  image->SetDimensions(4, 4, 4);
  image->AllocateScalars(VTK_SHORT, 3);
  image->GetPointData()->GetScalars()->Fill(2.0);
  vtkNew<vtkBSplineTransform> integers;
  vtkNew<FFDErrorLog> log;
  log->Watch(integers);
  integers->SetCoefficientData(image);
  FFD_CHECK(vtkFFDBSplineFieldFromTransform(integers, field, inverse, error));
  FFD_CHECK(log->Had("float or double"));
  FFD_CHECK_NEAR(field.Displacement(glm::dvec3(1.5)).y, 2.0, 1e-14);
  vtkNew<vtkImageData> broken;
  broken->SetDimensions(4, 4, 4);
  broken->AllocateScalars(VTK_DOUBLE, 3);
  broken->GetPointData()->GetScalars()->Fill(0.0);
  broken->GetPointData()->GetScalars()->SetComponent(6, 1, std::nan(""));
  vtkNew<vtkBSplineTransform> notFinite;
  notFinite->SetCoefficientData(broken);
  FFD_CHECK(!vtkFFDBSplineFieldFromTransform(notFinite, field, inverse, error));
  FFD_CHECK(error.find("(2, 1, 0)") != std::string::npos && field.IsZero());
  vtkNew<vtkImageData> scalar;
  scalar->SetDimensions(4, 4, 4);
  scalar->AllocateScalars(VTK_DOUBLE, 1);
  vtkNew<vtkBSplineTransform> oneComponent;
  vtkNew<FFDErrorLog> componentLog;
  componentLog->Watch(oneComponent);
  oneComponent->SetCoefficientData(scalar);
  FFD_CHECK(!vtkFFDBSplineFieldFromTransform(oneComponent, field, inverse, error));
  FFD_CHECK(error.find("3 components") != std::string::npos);
  FFD_CHECK(componentLog->Had("3 components"));
  return EXIT_SUCCESS;
}

} // namespace

int TestFFDLatticeAgainstVTK(int, char*[])
{
  for (const int border : { VTK_BSPLINE_EDGE, VTK_BSPLINE_ZERO, VTK_BSPLINE_ZERO_AT_BORDER })
  {
    if (CompareLattices(border) || CompareImages(border))
    {
      std::cerr << "border mode " << border << "\n";
      return EXIT_FAILURE;
    }
  }
  return TestFieldErrors();
}
