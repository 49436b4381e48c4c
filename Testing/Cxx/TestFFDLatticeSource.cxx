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
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

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
  // Bulge: outwards between center and border, fixed outside the ellipsoid.
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

int TestFoldFree()
{
  vtkNew<vtkFFDLatticeSource> source;
  source->SetDimensions(9, 8, 7);
  source->SetBounds(-10.0, 10.0, -4.0, 4.0, 0.0, 12.0);
  FFD_CHECK(source->GetFoldFree() == 0 && source->GetFoldFreeFactor() == 1.0);
  for (const int shape :
    { vtkFFDLatticeSource::RANDOM, vtkFFDLatticeSource::BEND, vtkFFDLatticeSource::TAPER })
  {
    source->SetShape(shape);
    source->SetStrength(8.0);
    source->FoldFreeOff();
    FFD_CHECK(!source->GetLattice()->IsFoldFree());
    vtkNew<vtkFFDLattice> folded;
    folded->DeepCopy(source->GetLattice());
    source->FoldFreeOn();
    double factors[2];
    for (const double least : { 0.05, 0.4 })
    {
      source->SetMinimumJacobian(least);
      FFD_CHECK(source->GetLattice()->GetMinimumJacobianBound() >= least);
      const double factor = source->GetFoldFreeFactor();
      FFD_CHECK(factor > 0.0 && factor < 1.0);
      factors[least > 0.1 ? 1 : 0] = factor;
      // All displacements by one factor, and not much smaller than needed.
      double d[3];
      double e[3];
      folded->GetDisplacement(2, 5, 4, d);
      source->GetLattice()->GetDisplacement(2, 5, 4, e);
      for (int a = 0; a < 3; ++a)
      {
        FFD_CHECK_NEAR(e[a], factor * d[a], 1e-12);
      }
      vtkNew<vtkFFDLattice> more;
      more->DeepCopy(folded);
      more->SetDisplacementScale(1.01 * factor);
      FFD_CHECK(more->GetMinimumJacobianBound() < least);
    }
    FFD_CHECK(factors[1] < factors[0]);
    // Where nothing folds nothing changes.
    source->SetStrength(0.2);
    source->SetMinimumJacobian(0.05);
    FFD_CHECK(!source->GetLattice()->IsIdentity() && source->GetFoldFreeFactor() == 1.0);
  }
  vtkNew<FFDErrorLog> log;
  log->Watch(source);
  source->SetMinimumJacobian(1.0);
  FFD_CHECK(log->Had("the determinant is 1"));
  source->SetMinimumJacobian(std::numeric_limits<double>::quiet_NaN());
  FFD_CHECK(log->Had("the determinant is") && source->GetMinimumJacobian() == 0.05);
  vtkObject::GlobalWarningDisplayOff();
  FFD_CHECK(vtkFFDLatticeSource::LimitToFoldFree(nullptr) == 0.0);
  FFD_CHECK(vtkFFDLatticeSource::LimitToFoldFree(source->GetLattice(), 2.0) == 0.0);
  vtkObject::GlobalWarningDisplayOn();
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

/// The displacement of a control point in what the filter puts out at a time.
double DisplacementAt(vtkFFDDeformVolume* filter, double time)
{
  filter->UpdateTimeStep(time);
  vtkNew<vtkFFDLattice> read;
  double d[3] = { -1e9, 0.0, 0.0 };
  if (read->ReadFrom(filter->GetOutput()))
  {
    read->GetDisplacement(1, 2, 1, d);
  }
  return d[0];
}

int TestKeyframes()
{
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(10, 10, 10);
  volume->AllocateScalars(VTK_SHORT, 1);
  vtkNew<vtkFFDDeformVolume> filter;
  filter->SetInputData(volume);
  vtkNew<FFDErrorLog> log;
  log->Watch(filter);
  const double times[4] = { 1.0, 2.0, 4.0, 5.0 };
  const double values[4] = { 0.0, 3.0, -1.0, 2.0 };
  vtkSmartPointer<vtkFFDLattice> lattices[4];
  for (const int i : { 2, 0, 3, 1 })
  {
    lattices[i] = vtkSmartPointer<vtkFFDLattice>::New();
    lattices[i]->FitToBounds(volume->GetBounds());
    lattices[i]->SetDisplacement(1, 2, 1, 2.0 * values[i], 0.0, 0.0);
    lattices[i]->SetDisplacementScale(0.5);
    filter->AddKeyframe(times[i], lattices[i]);
  }
  FFD_CHECK(filter->GetNumberOfKeyframes() == 4 && filter->GetKeyframeTime(2) == 4.0);
  FFD_CHECK(filter->GetKeyframeLattice(1) == lattices[1]);

  // The time steps and the range are published.
  filter->UpdateInformation();
  vtkInformation* info = filter->GetOutputInformation(0);
  FFD_CHECK(info->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()) == 4);
  FFD_CHECK(info->Get(vtkStreamingDemandDrivenPipeline::TIME_STEPS())[1] == 2.0);
  FFD_CHECK(info->Get(vtkStreamingDemandDrivenPipeline::TIME_RANGE())[1] == 5.0);
  // Nobody asked for a time: the first keyframe.
  filter->Update();
  FFD_CHECK(filter->GetOutput()->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()) == 1.0);
  FFD_CHECK(
    filter->GetOutput()->GetPointData()->GetScalars() == volume->GetPointData()->GetScalars());

  for (int i = 0; i < 4; ++i)
  {
    for (const int interpolation :
      { vtkFFDDeformVolume::STEP, vtkFFDDeformVolume::LINEAR, vtkFFDDeformVolume::SPLINE })
    {
      filter->SetKeyframeInterpolation(interpolation);
      FFD_CHECK_NEAR(DisplacementAt(filter, times[i]), values[i], 1e-12);
    }
  }
  // Linear and steps between, clamped outside.
  filter->SetKeyframeInterpolationToLinear();
  FFD_CHECK_NEAR(DisplacementAt(filter, 1.25), 0.75, 1e-12);
  FFD_CHECK_NEAR(DisplacementAt(filter, 3.5), 0.0, 1e-12);
  FFD_CHECK(filter->GetOutput()->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()) == 3.5);
  FFD_CHECK_NEAR(DisplacementAt(filter, -7.0), 0.0, 1e-12);
  FFD_CHECK_NEAR(DisplacementAt(filter, 99.0), 2.0, 1e-12);
  filter->SetKeyframeInterpolationToStep();
  FFD_CHECK_NEAR(DisplacementAt(filter, 3.9), 3.0, 1e-12);
  // The spline has no corner at a keyframe; the polygon has.
  const auto corner = [&filter] {
    const double h = 1e-4;
    const double before = (DisplacementAt(filter, 2.0) - DisplacementAt(filter, 2.0 - h)) / h;
    const double after = (DisplacementAt(filter, 2.0 + h) - DisplacementAt(filter, 2.0)) / h;
    return std::abs(after - before);
  };
  filter->SetKeyframeInterpolationToLinear();
  FFD_CHECK(corner() > 4.0);
  filter->SetKeyframeInterpolationToSpline();
  FFD_CHECK(corner() < 0.05);

  // Edits and removals arrive.
  filter->SetKeyframeInterpolationToLinear();
  lattices[3]->SetDisplacement(1, 2, 1, 8.0, 0.0, 0.0);
  FFD_CHECK_NEAR(DisplacementAt(filter, 5.0), 4.0, 1e-12);
  filter->RemoveKeyframe(2.0);
  filter->RemoveKeyframe(4.0);
  FFD_CHECK_NEAR(DisplacementAt(filter, 3.0), 2.0, 1e-12);
  // Two keyframes: the spline is the line.
  filter->SetKeyframeInterpolationToSpline();
  FFD_CHECK_NEAR(DisplacementAt(filter, 2.0), 1.0, 1e-12);
  filter->AddKeyframe(5.0, lattices[1]);
  FFD_CHECK(filter->GetNumberOfKeyframes() == 2);
  FFD_CHECK_NEAR(DisplacementAt(filter, 5.0), 3.0, 1e-12);

  // What cannot be.
  const vtkMTimeType time = filter->GetMTime();
  filter->AddKeyframe(6.0, nullptr);
  FFD_CHECK(log->Had("the lattice is null"));
  filter->AddKeyframe(std::numeric_limits<double>::infinity(), lattices[0]);
  FFD_CHECK(log->Had("not finite"));
  filter->RemoveKeyframe(17.0);
  FFD_CHECK(log->Had("none at time 17"));
  FFD_CHECK(filter->GetKeyframeLattice(9) == nullptr);
  FFD_CHECK(log->Had("no keyframe 9"));
  FFD_CHECK(std::isnan(filter->GetKeyframeTime(-1)));
  FFD_CHECK(log->Had("no keyframe -1"));
  FFD_CHECK(filter->InterpolateKeyframes(1.0, nullptr) == 0);
  FFD_CHECK(log->Had("null"));
  FFD_CHECK(filter->GetMTime() == time);
  vtkNew<vtkFFDLattice> other;
  other->DeepCopy(lattices[0]);
  const auto refused = [&](const char* text) {
    filter->AddKeyframe(3.0, other);
    filter->UpdateTimeStep(3.0);
    const bool had = log->Had(text);
    return had && filter->GetOutput()->GetNumberOfPoints() == volume->GetNumberOfPoints();
  };
  other->SetDimensions(5, 4, 4);
  FFD_CHECK(refused("dimensions differ"));
  other->DeepCopy(lattices[0]);
  other->SetDomain(0, 9, 0, 9, 0, 8);
  FFD_CHECK(refused("domains differ"));
  other->DeepCopy(lattices[0]);
  other->SetBorderMode(VTK_BSPLINE_ZERO);
  FFD_CHECK(refused("border modes differ"));
  other->DeepCopy(lattices[0]);
  other->Inverse();
  FFD_CHECK(refused("inverted"));
  filter->RemoveAllKeyframes();
  FFD_CHECK(filter->GetNumberOfKeyframes() == 0);
  vtkNew<vtkFFDLattice> result;
  FFD_CHECK(filter->InterpolateKeyframes(1.0, result) == 0 && log->Had("no keyframes"));
  return EXIT_SUCCESS;
}

} // namespace

int TestFFDLatticeSource(int, char*[])
{
  return TestShapes() || TestFoldFree() || TestSourceInput() || TestKeyframes() ||
      TestDeformVolume()
    ? EXIT_FAILURE
    : EXIT_SUCCESS;
}
