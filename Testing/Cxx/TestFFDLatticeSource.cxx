// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Shapes of vtkFFDLatticeSource against their definitions, and vtkFFDDeformVolume.
#include "FFDTestHelpers.h"

#include "vtkFFDDeformVolume.h"
#include "vtkFFDLatticeSource.h"

#include "vtkAlgorithmOutput.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkPointData.h"

#include <limits>

namespace
{

int TestShapes()
{
  vtkNew<vtkFFDLatticeSource> source;
  source->SetDimensions(11, 9, 10);
  source->SetBounds(-10.0, 10.0, -4.0, 4.0, 0.0, 12.0);
  for (int shape = 0; shape <= vtkFFDLatticeSource::RANDOM; ++shape)
  {
    source->SetShape(shape);
    source->SetStrength(1.0);
    vtkFFDLattice* lattice = source->GetLattice();
    double domain[6];
    lattice->GetDomain(domain);
    FFD_CHECK_NEAR(domain[0], -10.0, 1e-12);
    FFD_CHECK_NEAR(domain[5], 12.0, 1e-12);
    FFD_CHECK(lattice->IsIdentity() == (shape == vtkFFDLatticeSource::IDENTITY));
    FFD_CHECK(lattice->IsFoldFree());
    // Strength 0 and next to it: no deformation, and nothing divided by zero.
    for (const double strength : { 0.0, 1e-300, 1e-12 })
    {
      double d[6];
      source->SetStrength(strength);
      source->GetLattice()->GetDisplacementBounds(d);
      for (const double value : d)
      {
        FFD_CHECK(std::abs(value) < 1e-9);
      }
    }
    // The output image is the lattice.
    source->SetStrength(0.7);
    source->Update();
    vtkNew<vtkFFDLattice> read;
    FFD_CHECK(read->FromImageData(source->GetOutput()) == 1);
    for (vtkIdType i = 0; i < read->GetDisplacements()->GetNumberOfValues(); ++i)
    {
      FFD_CHECK(read->GetDisplacements()->GetValue(i) ==
        source->GetLattice()->GetDisplacements()->GetValue(i));
    }
  }

  source->SetStrength(1.0);
  // Bend: the ends of the x axis come to +-45 degrees of an arc of the same length.
  source->SetShapeToBend();
  const double end[3] = { 10.0, 0.0, 6.0 };
  double q[3];
  source->GetLattice()->TransformPoint(end, q);
  const double radius = 20.0 / (0.5 * vtkMath::Pi());
  FFD_CHECK_NEAR(q[0], radius * std::sqrt(0.5), 0.15);
  FFD_CHECK_NEAR(q[1], radius * (1.0 - std::sqrt(0.5)), 0.15);
  FFD_CHECK_NEAR(q[2], 6.0, 1e-12);
  // Twist: 45 degrees at the upper end.
  source->SetShapeToTwist();
  const double top[3] = { 3.0, 0.0, 12.0 };
  source->GetLattice()->TransformPoint(top, q);
  FFD_CHECK_NEAR(q[0], 3.0 * std::sqrt(0.5), 0.05);
  FFD_CHECK_NEAR(q[1], 3.0 * std::sqrt(0.5), 0.05);
  // Taper: linear times linear is bilinear, which the spline keeps.
  source->SetShapeToTaper();
  source->GetLattice()->TransformPoint(top, q);
  FFD_CHECK_NEAR(q[0], 1.5, 1e-12);
  // Bulge: outwards between centre and border, fixed outside the ellipsoid.
  source->SetShapeToBulge();
  const double inner[3] = { 3.0, 0.5, 6.5 };
  source->GetLattice()->TransformPoint(inner, q);
  FFD_CHECK(q[0] > 3.3 && q[1] > 0.55 && q[2] > 6.55);
  const double corner[3] = { 10.0, 4.0, 12.0 };
  source->GetLattice()->TransformPoint(corner, q);
  FFD_CHECK(FFDDistance(corner, q) < 1e-12);
  // Wave: only z moves, by up to a tenth of the height.
  source->SetShapeToWave();
  const double crest[3] = { 2.5, 1.0, 6.0 };
  source->GetLattice()->TransformPoint(crest, q);
  FFD_CHECK(q[2] > 6.5 && q[2] < 7.2 && std::abs(q[0] - 2.5) < 1e-12);

  // Random: the seed tells, the limit holds, and at strength 1 there is no fold.
  source->SetShapeToRandom();
  for (int seed = 1; seed < 6; ++seed)
  {
    source->SetSeed(seed);
    FFD_CHECK(source->GetLattice()->IsFoldFree());
    vtkNew<vtkFFDLattice> same;
    same->DeepCopy(source->GetLattice());
    FFD_CHECK(vtkFFDLatticeSource::ApplyShape(same, vtkFFDLatticeSource::RANDOM, 1.0, seed) == 1);
    double spacing[3];
    double d[3];
    double e[3];
    same->GetSpacing(spacing);
    same->GetDisplacement(3, 4, 5, d);
    source->GetLattice()->GetDisplacement(3, 4, 5, e);
    FFD_CHECK(FFDDistance(d, e) == 0.0 && std::abs(d[0]) <= 0.4 * spacing[0]);
    vtkFFDLatticeSource::ApplyShape(same, vtkFFDLatticeSource::RANDOM, 1.0, seed + 1);
    same->GetDisplacement(3, 4, 5, d);
    FFD_CHECK(FFDDistance(d, e) > 0.0);
  }
  return EXIT_SUCCESS;
}

int TestSourceInput()
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  vtkNew<vtkFFDLatticeSource> source;
  vtkNew<FFDErrorLog> log;
  log->Watch(source);
  vtkMTimeType time = source->GetMTime();
  source->SetBounds(0, 1, 1, 0, 0, 1);
  FFD_CHECK(log->Had("inverted"));
  source->SetBounds(0, 1, 0, nan, 0, 1);
  FFD_CHECK(log->Had("not finite"));
  source->SetBounds(nullptr);
  FFD_CHECK(log->Had("null"));
  source->SetBounds(1, 1, 1, 1, 1, 1);
  FFD_CHECK(log->Had("single point"));
  source->SetDimensions(3, 4, 4);
  FFD_CHECK(log->Had("(3, 4, 4)"));
  source->SetDimensions(nullptr);
  FFD_CHECK(log->Had("null"));
  source->SetPadding(-1.0);
  FFD_CHECK(log->Had("the padding is -1"));
  source->SetPadding(nan);
  FFD_CHECK(log->Had("the padding is"));
  source->SetShape(7);
  FFD_CHECK(log->Had("no shape 7"));
  source->SetStrength(nan);
  FFD_CHECK(log->Had("the strength is"));
  source->SetStrength(1.0);
  source->SetDimensions(8, 8, 8);
  source->SetBounds(0, 1, 0, 1, 0, 1);
  FFD_CHECK(source->GetMTime() == time);
  source->SetPadding(0.5);
  source->SetBorderMode(VTK_BSPLINE_ZERO);
  FFD_CHECK(source->GetMTime() > time);
  double domain[6];
  source->GetLattice()->GetDomain(domain);
  FFD_CHECK_NEAR(domain[0], -0.5, 1e-13);
  FFD_CHECK(source->GetLattice()->GetBorderMode() == VTK_BSPLINE_ZERO);
  source->SetBounds(0, 1, 0, 1, 3, 3);
  FFD_CHECK(source->GetLattice()->GetNumberOfControlPoints() == 512 && log->Count == 0);
  vtkObject::GlobalWarningDisplayOff();
  vtkNew<vtkFFDLattice> lattice;
  FFD_CHECK(vtkFFDLatticeSource::ApplyShape(nullptr, 1, 1.0) == 0);
  FFD_CHECK(vtkFFDLatticeSource::ApplyShape(lattice, 9, 1.0) == 0);
  FFD_CHECK(vtkFFDLatticeSource::ApplyShape(lattice, 1, nan) == 0);
  vtkObject::GlobalWarningDisplayOn();
  FFD_CHECK(lattice->IsIdentity());
  return EXIT_SUCCESS;
}

int TestDeformVolume()
{
  vtkNew<vtkImageData> volume;
  volume->SetExtent(2, 21, -3, 16, 5, 34);
  volume->SetSpacing(0.5, 0.6, 0.7);
  volume->AllocateScalars(VTK_SHORT, 1);
  volume->GetPointData()->GetScalars()->Fill(3.0);
  vtkNew<vtkIntArray> note;
  note->SetName("Note");
  note->InsertNextValue(1);
  volume->GetFieldData()->AddArray(note);

  vtkNew<vtkFFDDeformVolume> filter;
  vtkNew<FFDErrorLog> log;
  log->Watch(filter);
  filter->SetInputData(volume);
  filter->Update();
  FFD_CHECK(log->Had("There is no lattice to attach"));
  FFD_CHECK(filter->GetOutput()->GetNumberOfPoints() == volume->GetNumberOfPoints());

  // From a pipeline, whose extent has nothing to do with the volume's.
  vtkNew<vtkFFDLatticeSource> source;
  source->SetBounds(volume->GetBounds());
  source->SetShapeToBend();
  filter->SetLatticeConnection(source->GetOutputPort());
  filter->Update();
  FFD_CHECK(log->Count == 0);
  vtkImageData* output = filter->GetOutput();
  FFD_CHECK(vtkFFDLattice::HasLattice(output) && !vtkFFDLattice::HasLattice(volume));
  FFD_CHECK(output->GetPointData()->GetScalars() == volume->GetPointData()->GetScalars());
  FFD_CHECK(output->GetFieldData()->GetArray("Note") == note);
  int extent[6];
  output->GetExtent(extent);
  FFD_CHECK(extent[0] == 2 && extent[3] == 16 && extent[5] == 34);
  vtkNew<vtkFFDLattice> read;
  FFD_CHECK(read->ReadFrom(output) == 1);
  double d[3];
  double e[3];
  read->GetDisplacement(6, 3, 3, d);
  source->GetLattice()->GetDisplacement(6, 3, 3, e);
  FFD_CHECK(FFDDistance(d, e) == 0.0 && vtkMath::Norm(d) > 0.1);
  // A change upstream arrives.
  source->SetStrength(0.0);
  filter->Update();
  FFD_CHECK(read->ReadFrom(filter->GetOutput()) == 1 && read->IsIdentity());

  // An object goes before the connection, and its edits arrive.
  vtkNew<vtkFFDLattice> lattice;
  lattice->FitToBounds(volume->GetBounds());
  filter->SetLattice(lattice);
  FFD_CHECK(filter->GetLattice() == lattice);
  filter->Update();
  lattice->SetDisplacement(1, 1, 1, 0.5, 0.0, 0.0);
  filter->Update();
  FFD_CHECK(read->ReadFrom(filter->GetOutput()) == 1 && !read->IsIdentity());
  FFD_CHECK(read->GetNumberOfControlPoints() == 64);
  const vtkMTimeType time = filter->GetMTime();
  filter->SetLattice(lattice);
  FFD_CHECK(filter->GetMTime() == time);

  // What is no lattice: reported, the image passes through.
  filter->SetLattice(nullptr);
  vtkNew<vtkImageData> bad;
  bad->SetDimensions(3, 3, 3);
  bad->AllocateScalars(VTK_DOUBLE, 3);
  filter->SetLatticeData(bad);
  vtkObject::GlobalWarningDisplayOff();
  filter->Update();
  vtkObject::GlobalWarningDisplayOn();
  FFD_CHECK(!vtkFFDLattice::HasLattice(filter->GetOutput()));
  FFD_CHECK(filter->GetOutput()->GetNumberOfPoints() == volume->GetNumberOfPoints());

  // One that is attached already is kept, chained filters included.
  filter->SetLatticeConnection(nullptr);
  lattice->AttachTo(volume);
  volume->Modified();
  filter->Update();
  FFD_CHECK(log->Count == 0 && vtkFFDLattice::HasLattice(filter->GetOutput()));
  return EXIT_SUCCESS;
}

} // namespace

int TestFFDLatticeSource(int, char*[])
{
  return TestShapes() || TestSourceInput() || TestDeformVolume() ? EXIT_FAILURE : EXIT_SUCCESS;
}
