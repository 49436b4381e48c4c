// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDJacobian against closed forms and finite differences.
#include "FFDTestHelpers.h"

#include "vtkFFDJacobian.h"
#include "vtkFFDLatticeSource.h"

#include "vtkCallbackCommand.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImageDataStreamer.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkThinPlateSplineTransform.h"
#include "vtkTransform.h"

#include <algorithm>
#include <limits>

namespace
{

vtkSmartPointer<vtkImageData> MakeGrid(bool turned)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(-4, 20, 3, 20, 1, 40);
  image->SetSpacing(0.5, 0.7, 0.3);
  image->SetOrigin(1.0, 2.0, 3.0);
  if (turned)
  {
    vtkNew<vtkMatrix3x3> direction;
    direction->SetElement(0, 0, 0.6);
    direction->SetElement(0, 1, -0.8);
    direction->SetElement(1, 0, 0.8);
    direction->SetElement(1, 1, 0.6);
    image->SetDirectionMatrix(direction);
  }
  vtkNew<vtkFloatArray> note;
  note->SetName("note");
  note->SetNumberOfValues(image->GetNumberOfPoints());
  note->Fill(2.0);
  image->GetPointData()->AddArray(note);
  return image;
}

/// Determinant by central differences.
double Measure(vtkAbstractTransform* transform, const double p[3])
{
  constexpr double h = 1e-4;
  double j[3][3];
  for (int b = 0; b < 3; ++b)
  {
    double lower[3] = { p[0], p[1], p[2] };
    double upper[3] = { p[0], p[1], p[2] };
    lower[b] -= h;
    upper[b] += h;
    transform->TransformPoint(lower, lower);
    transform->TransformPoint(upper, upper);
    for (int a = 0; a < 3; ++a)
    {
      j[a][b] = (upper[a] - lower[a]) / (2.0 * h);
    }
  }
  return vtkMath::Determinant3x3(j);
}

int TestValues()
{
  for (const bool turned : { false, true })
  {
    vtkSmartPointer<vtkImageData> grid = MakeGrid(turned);
    vtkNew<vtkFFDLattice> lattice;
    lattice->SetDimensions(7, 6, 8);
    lattice->FitToBounds(grid->GetBounds(), 0.1);
    vtkFFDLatticeSource::ApplyShape(lattice, vtkFFDLatticeSource::RANDOM, 4.0, 5);
    lattice->SetInverseTolerance(1e-10);
    vtkNew<vtkThinPlateSplineTransform> thinPlate;
    thinPlate->SetBasisToR();
    vtkNew<vtkPoints> from;
    vtkNew<vtkPoints> to;
    FFDRandom random(3);
    for (int i = 0; i < 8; ++i)
    {
      double p[3];
      random.Point(lattice, 0.0, p);
      from->InsertNextPoint(p);
      to->InsertNextPoint(p[0] + 0.3, p[1] * 1.1, p[2] - 0.2 * i);
    }
    thinPlate->SetSourceLandmarks(from);
    thinPlate->SetTargetLandmarks(to);
    vtkNew<vtkFFDLattice> gentle;
    gentle->DeepCopy(lattice);
    gentle->SetDisplacementScale(0.2);
    gentle->SetInverseTolerance(1e-10);
    vtkAbstractTransform* const transforms[] = { lattice, gentle->GetInverse(), thinPlate };
    for (vtkAbstractTransform* transform : transforms)
    {
      vtkNew<vtkFFDJacobian> filter;
      filter->SetInputData(grid);
      filter->SetDeformation(transform);
      filter->Update();
      vtkDataArray* determinants = filter->GetOutput()->GetPointData()->GetScalars();
      vtkDataArray* mask = filter->GetOutput()->GetPointData()->GetArray("FoldMask");
      FFD_CHECK(std::string(determinants->GetName()) == "JacobianDeterminant" && mask);
      FFD_CHECK(filter->GetOutput()->GetPointData()->GetArray("note") ==
        grid->GetPointData()->GetArray("note"));
      vtkIdType folded = 0;
      double least = 1e9;
      double largest = -1e9;
      for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i)
      {
        const double value = determinants->GetComponent(i, 0);
        folded += mask->GetComponent(i, 0) != 0.0 ? 1 : 0;
        least = std::min(least, value);
        largest = std::max(largest, value);
        FFD_CHECK(mask->GetComponent(i, 0) == (value > 0.0 ? 0.0 : 1.0));
        if (i % 17 == 0)
        {
          FFD_CHECK_NEAR(
            value, Measure(transform, grid->GetPoint(i)), 1e-4 + 1e-4 * std::abs(value));
        }
      }
      FFD_CHECK(folded == filter->GetNumberOfFoldedPoints());
      FFD_CHECK_NEAR(filter->GetDeterminantRange()[0], least, 1e-5);
      FFD_CHECK_NEAR(filter->GetDeterminantRange()[1], largest, 1e-5);
      if (transform == lattice)
      {
        FFD_CHECK(folded > 0 && least < 0.0);
        double bounds[2];
        lattice->GetJacobianDeterminantBounds(bounds);
        FFD_CHECK(bounds[0] <= least + 1e-6 && bounds[1] >= largest - 1e-6);
        filter->SetFoldThreshold(0.5);
        filter->Update();
        FFD_CHECK(filter->GetNumberOfFoldedPoints() > folded);
      }
    }
  }
  // The closed form of a linear map.
  vtkNew<vtkTransform> scale;
  scale->RotateX(20.0);
  scale->Scale(2.0, 3.0, -0.5);
  vtkNew<vtkFFDJacobian> filter;
  filter->SetInputData(MakeGrid(true));
  filter->SetDeformation(scale);
  filter->Update();
  FFD_CHECK_NEAR(filter->GetDeterminantRange()[0], -3.0, 1e-6);
  FFD_CHECK(filter->GetNumberOfFoldedPoints() == filter->GetOutput()->GetNumberOfPoints());
  return EXIT_SUCCESS;
}

int TestPipeline()
{
  vtkSmartPointer<vtkImageData> grid = MakeGrid(false);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(6, 6, 6);
  lattice->FitToBounds(grid->GetBounds());
  vtkFFDLatticeSource::ApplyShape(lattice, vtkFFDLatticeSource::RANDOM, 0.5, 5);
  vtkNew<vtkFFDJacobian> filter;
  vtkNew<FFDErrorLog> log;
  log->Watch(filter);
  filter->SetInputData(grid);
  filter->Update();
  FFD_CHECK(log->Had("There is no deformation"));
  FFD_CHECK(filter->GetDeterminantRange()[0] == 1.0 && filter->GetDeterminantRange()[1] == 1.0);
  lattice->AttachTo(grid);
  grid->Modified();
  filter->Update();
  FFD_CHECK(log->Count == 0 && filter->GetDeterminantRange()[1] > 1.01);
  FFD_CHECK(vtkFFDLattice::HasLattice(filter->GetOutput()));
  const double largest = filter->GetDeterminantRange()[1];
  vtkFFDLattice::DetachFrom(grid);
  grid->Modified();
  filter->SetDeformation(lattice);
  vtkNew<vtkImageDataStreamer> streamer;
  streamer->SetInputConnection(filter->GetOutputPort());
  streamer->SetNumberOfStreamDivisions(5);
  streamer->Update();
  double range[2];
  streamer->GetOutput()->GetScalarRange(range);
  FFD_CHECK_NEAR(range[1], largest, 1e-6);
  const vtkMTimeType time = filter->GetMTime();
  lattice->SetDisplacement(2, 2, 2, 5.0, 0.0, 0.0);
  FFD_CHECK(filter->GetMTime() > time);
  filter->SetFoldThreshold(std::numeric_limits<double>::quiet_NaN());
  FFD_CHECK(log->Had("Give a finite number"));

  int calls = 0;
  vtkNew<vtkCallbackCommand> callback;
  callback->SetClientData(&calls);
  callback->SetCallback([](vtkObject* caller, unsigned long, void* data, void*) {
    if (++*static_cast<int*>(data) < 0)
    {
      vtkAlgorithm::SafeDownCast(caller)->AbortExecuteOn();
    }
  });
  filter->AddObserver(vtkCommand::ProgressEvent, callback);
  filter->Update();
  FFD_CHECK(calls >= 2);
  calls = -10;
  filter->Modified();
  filter->Update();
  // VTK 9.3 reports the end of an aborted update, too.
  FFD_CHECK(calls <= -8 && filter->GetOutput()->GetNumberOfPoints() == 0);
  return EXIT_SUCCESS;
}

} // namespace

int TestFFDJacobian(int, char*[])
{
  return TestValues() || TestPipeline() ? EXIT_FAILURE : EXIT_SUCCESS;
}
