// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDResampleVolume against vtkImageReslice and closed forms; pipeline behavior, bad input.
#include "FFDTestHelpers.h"

#include "vtkFFDDeformVolume.h"
#include "vtkFFDLatticeSource.h"
#include "vtkFFDResampleVolume.h"

#include "vtkCallbackCommand.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkImageDataStreamer.h"
#include "vtkImageReslice.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkRTAnalyticSource.h"
#include "vtkSmartPointer.h"
#include "vtkThinPlateSplineTransform.h"
#include "vtkTransform.h"

#include <algorithm>
#include <array>
#include <limits>

namespace
{

/// Smooth, with spacing, origin and extent of its own.
vtkSmartPointer<vtkImageData> MakeVolume(int type, int components = 1)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(3, 32, -5, 20, 2, 23);
  image->SetSpacing(0.8, 1.0, 1.3);
  image->SetOrigin(5.0, -3.0, 2.0);
  image->AllocateScalars(type, components);
  for (int k = 2; k <= 23; ++k)
  {
    for (int j = -5; j <= 20; ++j)
    {
      for (int i = 3; i <= 32; ++i)
      {
        for (int c = 0; c < components; ++c)
        {
          image->SetScalarComponentFromDouble(
            i, j, k, c, 60.0 + 20.0 * std::sin(0.4 * i + c) * std::cos(0.3 * j) + k);
        }
      }
    }
  }
  image->GetPointData()->GetScalars()->SetName("density");
  return image;
}

void ShapeLattice(vtkFFDLattice* lattice, vtkImageData* image, double strength)
{
  lattice->SetDimensions(6, 7, 6);
  lattice->FitToBounds(image->GetBounds(), 0.1);
  vtkFFDLatticeSource::ApplyShape(lattice, vtkFFDLatticeSource::RANDOM, strength, 3);
}

/// Largest difference of the scalars of two images of the same size; -1 if they are not.
double Difference(vtkImageData* a, vtkImageData* b)
{
  vtkDataArray* x = a->GetPointData()->GetScalars();
  vtkDataArray* y = b->GetPointData()->GetScalars();
  if (!x || !y || x->GetNumberOfTuples() != y->GetNumberOfTuples() ||
    x->GetNumberOfComponents() != y->GetNumberOfComponents() ||
    x->GetDataType() != y->GetDataType())
  {
    return -1.0;
  }
  double largest = 0.0;
  for (vtkIdType i = 0; i < x->GetNumberOfTuples(); ++i)
  {
    for (int c = 0; c < x->GetNumberOfComponents(); ++c)
    {
      largest = std::max(largest, std::abs(x->GetComponent(i, c) - y->GetComponent(i, c)));
    }
  }
  return largest;
}

int TestAgainstReslice()
{
  for (const int type : { VTK_FLOAT, VTK_DOUBLE, VTK_UNSIGNED_CHAR, VTK_SHORT })
  {
    const int components = type == VTK_DOUBLE ? 3 : 1;
    vtkSmartPointer<vtkImageData> image = MakeVolume(type, components);
    vtkNew<vtkFFDLattice> lattice;
    ShapeLattice(lattice, image, 0.8);
    vtkNew<vtkImageReslice> reslice;
    reslice->SetInputData(image);
    reslice->SetOutputSpacing(0.7, 0.9, 1.1);
    reslice->SetOutputOrigin(6.0, -4.0, 3.0);
    reslice->SetOutputExtent(0, 30, -4, 22, 1, 24);
    reslice->SetBackgroundLevel(11.0);
    reslice->BorderOff();
    vtkNew<vtkFFDResampleVolume> filter;
    filter->SetInputData(image);
    filter->SetDeformation(lattice);
    filter->SetOutputSpacing(0.7, 0.9, 1.1);
    filter->SetOutputOrigin(6.0, -4.0, 3.0);
    filter->SetOutputExtent(0, 30, -4, 22, 1, 24);
    filter->SetBackgroundLevel(11.0);
    filter->SetInverseModeToPullBack();
    reslice->SetResliceTransform(lattice);
    for (const bool cubic : { false, true })
    {
      cubic ? reslice->SetInterpolationModeToCubic() : reslice->SetInterpolationModeToLinear();
      cubic ? filter->SetInterpolationModeToCubic() : filter->SetInterpolationModeToLinear();
      reslice->Update();
      filter->Update();
      // Whole numbers can be rounded to either side.
      const bool whole = type == VTK_UNSIGNED_CHAR || type == VTK_SHORT;
      const double difference = Difference(filter->GetOutput(), reslice->GetOutput());
      FFD_CHECK(difference >= 0.0 && difference <= (whole ? 1.0 : 1e-4));
      FFD_CHECK(
        std::string(filter->GetOutput()->GetPointData()->GetScalars()->GetName()) == "density");
    }
    // The inverse of the inverse: exactly the same job the other way round.
    vtkNew<vtkFFDLattice> inverse;
    inverse->DeepCopy(lattice);
    inverse->Inverse();
    filter->SetDeformation(inverse);
    filter->SetInverseModeToExact();
    filter->Update();
    FFD_CHECK(Difference(filter->GetOutput(), reslice->GetOutput()) <= 1.0);
  }
  // EXACT is a reslice through the inverse; FIRST_ORDER one through the opposite displacements.
  vtkSmartPointer<vtkImageData> image = MakeVolume(VTK_DOUBLE);
  vtkNew<vtkFFDLattice> lattice;
  ShapeLattice(lattice, image, 0.8);
  vtkNew<vtkFFDLattice> opposite;
  opposite->DeepCopy(lattice);
  opposite->SetDisplacementScale(-1.0);
  lattice->SetInverseTolerance(1e-6);
  vtkNew<vtkFFDResampleVolume> filter;
  filter->SetInputData(image);
  filter->SetDeformation(lattice);
  filter->SetInverseTolerance(1e-5);
  filter->SetOutputExtent(6, 28, -2, 17, 5, 20);
  vtkNew<vtkImageReslice> reslice;
  reslice->SetInputData(image);
  reslice->SetOutputSpacing(image->GetSpacing());
  reslice->SetOutputOrigin(image->GetOrigin());
  reslice->SetOutputExtent(6, 28, -2, 17, 5, 20);
  reslice->SetInterpolationModeToLinear();
  reslice->BorderOff();
  reslice->SetResliceTransform(lattice->GetInverse());
  reslice->Update();
  filter->Update();
  FFD_CHECK(Difference(filter->GetOutput(), reslice->GetOutput()) < 1e-3);
  FFD_CHECK(filter->GetNumberOfUnconvergedPoints() == 0);
  filter->SetInverseModeToFirstOrder();
  filter->Update();
  FFD_CHECK(Difference(filter->GetOutput(), reslice->GetOutput()) > 0.5);
  reslice->SetResliceTransform(opposite);
  reslice->Update();
  // vtkImageReslice takes positions within 1e-5 of a voxel for whole.
  FFD_CHECK_NEAR(Difference(filter->GetOutput(), reslice->GetOutput()), 0.0, 2e-4);
  // A coarser tolerance shows.
  filter->SetInverseModeToExact();
  filter->Update();
  vtkNew<vtkImageData> fine;
  fine->DeepCopy(filter->GetOutput());
  filter->SetInverseTolerance(0.5);
  filter->Update();
  const double coarse = Difference(filter->GetOutput(), fine);
  FFD_CHECK(coarse > 1e-5 && coarse < 10.0);
  // Nearest takes values of voxels only.
  vtkSmartPointer<vtkImageData> steps = MakeVolume(VTK_FLOAT);
  vtkDataArray* values = steps->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
  {
    values->SetComponent(i, 0, i % 2);
  }
  filter->SetInputData(steps);
  filter->SetInterpolationModeToNearest();
  filter->Update();
  double range[2];
  vtkDataArray* result = filter->GetOutput()->GetPointData()->GetScalars();
  result->GetRange(range);
  FFD_CHECK(range[0] == 0.0 && range[1] == 1.0);
  for (vtkIdType i = 0; i < result->GetNumberOfTuples(); ++i)
  {
    FFD_CHECK(result->GetComponent(i, 0) == 0.0 || result->GetComponent(i, 0) == 1.0);
  }
  return EXIT_SUCCESS;
}

int TestDefaultGrid()
{
  // Without deformation: the input.
  vtkSmartPointer<vtkImageData> image = MakeVolume(VTK_SHORT);
  vtkNew<vtkMatrix3x3> turn;
  const double angle = vtkMath::RadiansFromDegrees(30.0);
  turn->SetElement(0, 0, std::cos(angle));
  turn->SetElement(0, 1, -std::sin(angle));
  turn->SetElement(1, 0, std::sin(angle));
  turn->SetElement(1, 1, std::cos(angle));
  for (const bool turned : { false, true })
  {
    if (turned)
    {
      image->SetDirectionMatrix(turn);
    }
    vtkNew<vtkFFDResampleVolume> filter;
    filter->SetInputData(image);
    filter->Update();
    FFD_CHECK(Difference(filter->GetOutput(), image) == 0.0);
    FFD_CHECK(
      filter->GetOutput()->GetExtent()[0] == 3 && filter->GetOutput()->GetExtent()[3] == 20);
    FFD_CHECK(turned == (filter->GetOutput()->GetDirectionMatrix()->GetElement(0, 1) < -0.4));

    // A deformed one: nothing of it is cut off. Every voxel's deformed position is in the bounds
    // of the output, and next to there its value is found again.
    vtkNew<vtkFFDLattice> lattice;
    ShapeLattice(lattice, image, 0.9);
    vtkSmartPointer<vtkImageData> ones = MakeVolume(VTK_DOUBLE);
    ones->SetDirectionMatrix(image->GetDirectionMatrix());
    for (int a = 0; a < 3; ++a)
    {
      // Scalars that are a coordinate at rest: the output holds the inverse itself.
      for (vtkIdType i = 0; i < ones->GetNumberOfPoints(); ++i)
      {
        ones->GetPointData()->GetScalars()->SetComponent(i, 0, ones->GetPoint(i)[a]);
      }
      ones->Modified();
      filter->SetInputData(ones);
      filter->SetDeformation(lattice);
      filter->SetBackgroundLevel(1e9);
      filter->Update();
      vtkImageData* output = filter->GetOutput();
      for (vtkIdType i = 0; i < ones->GetNumberOfPoints(); i += 7)
      {
        double p[3];
        lattice->TransformPoint(ones->GetPoint(i), p);
        double index[3];
        output->TransformPhysicalPointToContinuousIndex(p, index);
        for (int b = 0; b < 3; ++b)
        {
          FFD_CHECK(index[b] >= output->GetExtent()[2 * b] - 1e-9 &&
            index[b] <= output->GetExtent()[2 * b + 1] + 1e-9);
        }
      }
      int inside = 0;
      for (vtkIdType i = 0; i < output->GetNumberOfPoints(); i += 3)
      {
        const double value = output->GetPointData()->GetScalars()->GetComponent(i, 0);
        if (value < 1e8)
        {
          double q[3];
          lattice->GetInverse()->TransformPoint(output->GetPoint(i), q);
          FFD_CHECK_NEAR(value, q[a], 0.02);
          ++inside;
        }
      }
      FFD_CHECK(inside > 3000);
    }
    // The extent is conservative, not huge.
    FFD_CHECK(filter->GetOutput()->GetNumberOfPoints() < 3 * image->GetNumberOfPoints());
  }
  return EXIT_SUCCESS;
}

int TestAttachedAndForeign()
{
  vtkSmartPointer<vtkImageData> image = MakeVolume(VTK_FLOAT);
  vtkNew<vtkFFDLattice> lattice;
  ShapeLattice(lattice, image, 0.7);
  vtkNew<vtkFFDResampleVolume> direct;
  direct->SetInputData(image);
  direct->SetDeformation(lattice);
  FFD_CHECK(direct->GetDeformation() == lattice);
  direct->Update();
  // Through the pipeline, attached; the result carries none, or it would be deformed twice.
  vtkNew<vtkFFDDeformVolume> deform;
  deform->SetInputData(image);
  deform->SetLattice(lattice);
  vtkNew<vtkFFDResampleVolume> attached;
  attached->SetInputConnection(deform->GetOutputPort());
  attached->Update();
  FFD_CHECK(Difference(attached->GetOutput(), direct->GetOutput()) == 0.0);
  FFD_CHECK(!vtkFFDLattice::HasLattice(attached->GetOutput()));
  FFD_CHECK(vtkFFDLattice::HasLattice(deform->GetOutput()));
  // Edits arrive, and the extent follows.
  const vtkMTimeType time = direct->GetMTime();
  lattice->SetDisplacement(2, 2, 2, 20.0, 0.0, 0.0);
  lattice->SetDisplacement(4, 3, 3, 30.0, 0.0, 0.0);
  FFD_CHECK(direct->GetMTime() > time);
  const int before = attached->GetOutput()->GetExtent()[1];
  attached->Update();
  direct->Update();
  FFD_CHECK(attached->GetOutput()->GetExtent()[1] > before);
  FFD_CHECK(Difference(attached->GetOutput(), direct->GetOutput()) == 0.0);

  // A transform of another class within the tolerance: a linear one is met exactly.
  vtkNew<vtkTransform> shift;
  shift->Translate(0.8, -2.0, 2.6);
  direct->SetDeformation(shift);
  direct->SetOutputExtent(4, 33, -7, 18, 4, 25);
  direct->Update();
  FFD_CHECK(Difference(direct->GetOutput(), image) < 1e-3);
  // And one that is not: PositionTolerance tells how well.
  vtkNew<vtkThinPlateSplineTransform> warp;
  warp->SetBasisToR();
  vtkNew<vtkPoints> from;
  vtkNew<vtkPoints> to;
  double bounds[6];
  image->GetBounds(bounds);
  for (int corner = 0; corner < 8; ++corner)
  {
    const double p[3] = { bounds[corner & 1], bounds[2 + (corner >> 1 & 1)],
      bounds[4 + (corner >> 2)] };
    from->InsertNextPoint(p);
    to->InsertNextPoint(p);
  }
  from->InsertNextPoint(17.0, 4.0, 17.0);
  to->InsertNextPoint(19.0, 5.0, 16.0);
  warp->SetSourceLandmarks(from);
  warp->SetTargetLandmarks(to);
  direct->SetDeformation(warp);
  direct->SetInverseModeToPullBack();
  direct->SetOutputExtent(3, 32, -5, 20, 2, 23);
  vtkNew<vtkImageReslice> reslice;
  reslice->SetInputData(image);
  reslice->SetResliceTransform(warp);
  reslice->SetInterpolationModeToLinear();
  reslice->BorderOff();
  reslice->Update();
  direct->SetPositionTolerance(0.05);
  direct->Update();
  const auto count = [&](double limit) {
    int n = 0;
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    {
      n += std::abs(direct->GetOutput()->GetPointData()->GetScalars()->GetComponent(i, 0) -
             reslice->GetOutput()->GetPointData()->GetScalars()->GetComponent(i, 0)) > limit
        ? 1
        : 0;
    }
    return n;
  };
  // Slopes are below 10 a voxel; at the border the two may disagree on what is inside.
  FFD_CHECK(count(1.0) < image->GetNumberOfPoints() / 50);
  const int fine = count(0.2);
  direct->SetPositionTolerance(2.0);
  direct->Update();
  FFD_CHECK(count(0.2) > fine + 100);
  return EXIT_SUCCESS;
}

int TestStreaming()
{
  // A source that says which part of it was made.
  vtkNew<vtkRTAnalyticSource> wavelet;
  wavelet->SetWholeExtent(-20, 20, -20, 20, -20, 20);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(6, 6, 6);
  lattice->FitToBounds(std::array<double, 6>{ -20, 20, -20, 20, -20, 20 }.data());
  vtkFFDLatticeSource::ApplyShape(lattice, vtkFFDLatticeSource::RANDOM, 0.5, 2);
  for (const int mode : { vtkFFDResampleVolume::FIRST_ORDER, vtkFFDResampleVolume::EXACT,
         vtkFFDResampleVolume::PULL_BACK })
  {
    vtkNew<vtkFFDResampleVolume> filter;
    filter->SetInputConnection(wavelet->GetOutputPort());
    filter->SetDeformation(lattice);
    filter->SetInverseMode(mode);
    filter->SetInterpolationModeToCubic();
    filter->Update();
    vtkNew<vtkImageData> whole;
    whole->DeepCopy(filter->GetOutput());
    // In pieces: the same values.
    vtkNew<vtkImageDataStreamer> streamer;
    streamer->SetInputConnection(filter->GetOutputPort());
    streamer->SetNumberOfStreamDivisions(7);
    streamer->Update();
    FFD_CHECK(Difference(streamer->GetOutput(), whole) == 0.0);
    // One piece: only a part of the input is asked for.
    const int extent[6] = { -5, 3, 0, 4, 2, 6 };
    wavelet->GetOutput()->Initialize();
    filter->Modified();
    filter->UpdateExtent(extent);
    int made[6];
    wavelet->GetOutput()->GetExtent(made);
    FFD_CHECK(made[1] - made[0] < 30 && made[3] - made[2] < 26 && made[5] - made[4] < 26);
    for (int k = 2; k <= 6; ++k)
    {
      for (int j = 0; j <= 4; ++j)
      {
        for (int i = -5; i <= 3; ++i)
        {
          FFD_CHECK(filter->GetOutput()->GetScalarComponentAsDouble(i, j, k, 0) ==
            whole->GetScalarComponentAsDouble(i, j, k, 0));
        }
      }
    }
    // Far away from the volume: background, and still a valid request.
    filter->SetOutputExtent(500, 510, 0, 10, 0, 10);
    filter->SetBackgroundLevel(4.0);
    filter->Update();
    double range[2];
    filter->GetOutput()->GetScalarRange(range);
    FFD_CHECK(range[0] == 4.0 && range[1] == 4.0);
  }
  return EXIT_SUCCESS;
}

int TestThreadsProgressAbort()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(30, 30, 100);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    image->GetPointData()->GetScalars()->SetComponent(i, 0, i % 251);
  }
  vtkNew<vtkFFDLattice> lattice;
  ShapeLattice(lattice, image, 0.9);
  vtkNew<vtkFFDResampleVolume> filter;
  filter->SetInputData(image);
  filter->SetDeformation(lattice);
  filter->SetNumberOfThreads(1);
  filter->Update();
  vtkNew<vtkImageData> one;
  one->DeepCopy(filter->GetOutput());
  filter->SetNumberOfThreads(5);
  filter->Update();
  FFD_CHECK(Difference(filter->GetOutput(), one) == 0.0);

  struct Calls
  {
    int Count = 0;
    double Last = 0.0;
    bool Abort = false;
  } calls;
  vtkNew<vtkCallbackCommand> callback;
  callback->SetClientData(&calls);
  callback->SetCallback([](vtkObject* caller, unsigned long, void* data, void* progress) {
    Calls* mine = static_cast<Calls*>(data);
    ++mine->Count;
    mine->Last = *static_cast<double*>(progress);
    if (mine->Abort)
    {
      vtkAlgorithm::SafeDownCast(caller)->AbortExecuteOn();
    }
  });
  filter->AddObserver(vtkCommand::ProgressEvent, callback);
  filter->Modified();
  filter->Update();
  FFD_CHECK(calls.Count >= 3 && calls.Last == 1.0);
  calls.Count = 0;
  calls.Abort = true;
  filter->Modified();
  filter->Update();
  FFD_CHECK(calls.Last < 1.0 || calls.Count < 3);
  FFD_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
  calls.Abort = false;
  filter->AbortExecuteOff();
  filter->Modified();
  filter->Update();
  FFD_CHECK(Difference(filter->GetOutput(), one) == 0.0);
  return EXIT_SUCCESS;
}

int TestBadInput()
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  vtkNew<vtkFFDResampleVolume> filter;
  vtkNew<FFDErrorLog> log;
  log->Watch(filter);
  const vtkMTimeType time = filter->GetMTime();
  filter->SetInverseTolerance(0.0);
  FFD_CHECK(log->Had("InverseTolerance must be a positive number"));
  filter->SetPositionTolerance(nan);
  FFD_CHECK(log->Had("PositionTolerance must be a positive number"));
  filter->SetOutputSpacing(1.0, 0.0, 1.0);
  FFD_CHECK(log->Had("(1, 0, 1) is no spacing"));
  filter->SetOutputSpacing(nullptr);
  FFD_CHECK(log->Had("null"));
  filter->SetOutputOrigin(1.0, nan, 1.0);
  FFD_CHECK(log->Had("is no position"));
  filter->SetOutputOrigin(nullptr);
  FFD_CHECK(log->Had("null"));
  filter->SetOutputExtent(0, 5, 3, 2, 0, 1);
  FFD_CHECK(log->Had("empty"));
  FFD_CHECK(filter->GetMTime() == time);

  vtkNew<FFDErrorLog> pipeline;
  pipeline->Watch(filter->GetExecutive());
  filter->Update();
  FFD_CHECK(pipeline->Count > 0);

  vtkNew<vtkImageData> flat;
  flat->SetDimensions(5, 5, 1);
  flat->AllocateScalars(VTK_FLOAT, 1);
  filter->SetInputData(flat);
  filter->Update();
  FFD_CHECK(log->Had("at least 2 voxels along each axis"));
  vtkNew<vtkImageData> bare;
  bare->SetDimensions(5, 5, 5);
  filter->SetInputData(bare);
  filter->Update();
  FFD_CHECK(log->Had("no point scalars"));
  vtkSmartPointer<vtkImageData> image = MakeVolume(VTK_FLOAT);
  image->SetSpacing(1.0, nan, 1.0);
  filter->SetInputData(image);
  filter->Update();
  FFD_CHECK(log->Had("spacing, origin or direction"));
  image->SetSpacing(1.0, 1.0, 1.0);

  // Deformed bounds that no memory holds.
  vtkNew<vtkFFDLattice> lattice;
  ShapeLattice(lattice, image, 0.0);
  lattice->SetDisplacement(3, 3, 3, 1e12, 0.0, 0.0);
  filter->SetDeformation(lattice);
  filter->Update();
  FFD_CHECK(log->Had("too many"));
  // A chosen extent is fine.
  filter->SetOutputExtent(0, 20, 0, 10, 0, 10);
  filter->Update();
  FFD_CHECK(log->Count == 0 && filter->GetOutput()->GetNumberOfPoints() == 21 * 11 * 11);
  filter->SetOutputExtentToDefault();
  lattice->Reset();
  filter->Update();
  FFD_CHECK(log->Count == 0 && Difference(filter->GetOutput(), image) == 0.0);
  // Control points that are not a number: the lattice says so, and does not deform.
  vtkNew<FFDErrorLog> latticeLog;
  latticeLog->Watch(lattice);
  lattice->GetDisplacements()->SetValue(5, nan);
  lattice->Modified();
  filter->Update();
  FFD_CHECK(latticeLog->Count > 0 || log->Count > 0);
  vtkDataArray* scalars = filter->GetOutput()->GetPointData()->GetScalars();
  for (vtkIdType i = 0; scalars && i < scalars->GetNumberOfTuples(); ++i)
  {
    FFD_CHECK(std::isfinite(scalars->GetComponent(i, 0)));
  }
  return EXIT_SUCCESS;
}

} // namespace

int TestFFDResampleVolume(int, char*[])
{
  return TestAgainstReslice() || TestDefaultGrid() || TestAttachedAndForeign() || TestStreaming() ||
      TestThreadsProgressAbort() || TestBadInput()
    ? EXIT_FAILURE
    : EXIT_SUCCESS;
}
