// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDDeformGeometry against vtkTransformFilter, and in the other inverse modes against what
// they mean: the volume's point X is shown at the P with Phi(P) = X.
#include "FFDTestHelpers.h"

#include "vtkFFDDeformGeometry.h"
#include "vtkFFDDeformVolume.h"
#include "vtkFFDLatticeSource.h"

#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkSphereSource.h"
#include "vtkStructuredGrid.h"
#include "vtkThinPlateSplineTransform.h"
#include "vtkTransform.h"
#include "vtkTransformFilter.h"
#include "vtkUnstructuredGrid.h"

#include <limits>

namespace
{

constexpr double Radius = 4.0;

/// A ball with normals, vectors, another vector array, a scalar array, and arrays of the cells.
vtkSmartPointer<vtkPolyData> MakeBall(bool doubles)
{
  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(Radius);
  sphere->SetCenter(1.0, 2.0, 3.0);
  sphere->SetThetaResolution(24);
  sphere->SetPhiResolution(20);
  sphere->SetOutputPointsPrecision(
    doubles ? vtkAlgorithm::DOUBLE_PRECISION : vtkAlgorithm::SINGLE_PRECISION);
  sphere->Update();
  vtkSmartPointer<vtkPolyData> ball = sphere->GetOutput();
  FFDRandom random(4);
  for (const char* name : { "velocity", "other" })
  {
    vtkNew<vtkDoubleArray> vectors;
    vectors->SetName(name);
    vectors->SetNumberOfComponents(3);
    for (vtkIdType i = 0; i < ball->GetNumberOfPoints(); ++i)
    {
      vectors->InsertNextTuple3(random.Number(-1, 1), random.Number(-1, 1), random.Number(-1, 1));
    }
    ball->GetPointData()->AddArray(vectors);
  }
  ball->GetPointData()->SetActiveVectors("velocity");
  vtkNew<vtkIntArray> numbers;
  numbers->SetName("number");
  for (vtkIdType i = 0; i < ball->GetNumberOfPoints(); ++i)
  {
    numbers->InsertNextValue(static_cast<int>(i));
  }
  ball->GetPointData()->SetScalars(numbers);
  vtkNew<vtkFloatArray> cellNormals;
  cellNormals->SetName("facing");
  cellNormals->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < ball->GetNumberOfCells(); ++i)
  {
    cellNormals->InsertNextTuple3(0.0, 0.6, 0.8);
  }
  ball->GetCellData()->SetNormals(cellNormals);
  return ball;
}

void ShapeLattice(vtkFFDLattice* lattice, double strength)
{
  lattice->SetDimensions(7, 6, 6);
  lattice->SetDomain(-5.0, 7.0, -4.0, 8.0, -3.0, 9.0);
  vtkFFDLatticeSource::ApplyShape(lattice, vtkFFDLatticeSource::RANDOM, strength, 8);
}

double LargestDifference(vtkDataArray* a, vtkDataArray* b)
{
  if (!a || !b || a->GetNumberOfValues() != b->GetNumberOfValues())
  {
    return std::numeric_limits<double>::infinity();
  }
  double largest = 0.0;
  for (vtkIdType i = 0; i < a->GetNumberOfTuples(); ++i)
  {
    for (int c = 0; c < a->GetNumberOfComponents(); ++c)
    {
      const double difference = std::abs(a->GetComponent(i, c) - b->GetComponent(i, c));
      largest = difference <= largest ? largest : difference;
    }
  }
  return largest;
}

int TestAgainstTransformFilter()
{
  vtkNew<vtkFFDLattice> lattice;
  ShapeLattice(lattice, 0.9);
  vtkNew<vtkThinPlateSplineTransform> thinPlate;
  thinPlate->SetBasisToR();
  vtkNew<vtkPoints> from;
  vtkNew<vtkPoints> to;
  FFDRandom random(2);
  for (int i = 0; i < 8; ++i)
  {
    double p[3];
    random.Point(lattice, 0.0, p);
    from->InsertNextPoint(p);
    to->InsertNextPoint(p[0] + random.Number(-0.5, 0.5), p[1], p[2] + random.Number(-0.5, 0.5));
  }
  thinPlate->SetSourceLandmarks(from);
  thinPlate->SetTargetLandmarks(to);
  vtkNew<vtkTransform> linear;
  linear->RotateX(30.0);
  linear->Scale(1.0, 2.0, 0.5);
  vtkAbstractTransform* const transforms[] = { lattice, lattice->GetInverse(), thinPlate, linear };
  for (vtkAbstractTransform* transform : transforms)
  {
    for (const bool doubles : { false, true })
    {
      vtkSmartPointer<vtkPolyData> ball = MakeBall(doubles);
      vtkNew<vtkTransformFilter> expected;
      expected->SetInputData(ball);
      expected->SetTransform(transform);
      expected->Update();
      vtkNew<vtkFFDDeformGeometry> filter;
      filter->SetInputData(ball);
      filter->SetDeformation(transform);
      filter->Update();
      vtkPointSet* output = filter->GetOutput();
      FFD_CHECK(vtkPolyData::SafeDownCast(output) != nullptr);
      FFD_CHECK(output->GetPoints()->GetDataType() == (doubles ? VTK_DOUBLE : VTK_FLOAT));
      // vtkTransformFilter calculates with what it stores.
      const double tolerance = 1e-5;
      FFD_CHECK(LargestDifference(output->GetPoints()->GetData(),
                  expected->GetOutput()->GetPoints()->GetData()) < tolerance);
      FFD_CHECK(LargestDifference(output->GetPointData()->GetNormals(),
                  expected->GetOutput()->GetPointData()->GetNormals()) < tolerance);
      FFD_CHECK(LargestDifference(output->GetPointData()->GetVectors(),
                  expected->GetOutput()->GetPointData()->GetVectors()) < tolerance);
      FFD_CHECK(std::string(output->GetPointData()->GetVectors()->GetName()) == "velocity");
      // The rest passes, shared; the input is as it was.
      FFD_CHECK(output->GetPointData()->GetScalars() == ball->GetPointData()->GetScalars());
      FFD_CHECK(
        output->GetPointData()->GetArray("other") == ball->GetPointData()->GetArray("other"));
      FFD_CHECK(
        LargestDifference(output->GetPoints()->GetData(), ball->GetPoints()->GetData()) > 0.1);
      double p[3];
      ball->GetPoint(0, p);
      FFD_CHECK_NEAR(p[2], 3.0 + Radius, 1e-5);
      if (transform == linear)
      {
        FFD_CHECK(LargestDifference(output->GetCellData()->GetNormals(),
                    expected->GetOutput()->GetCellData()->GetNormals()) < tolerance);
      }
      // Where the points were.
      FFD_CHECK(!output->GetPointData()->HasArray("RestPosition"));
      filter->PassRestPositionsOn();
      filter->Update();
      FFD_CHECK(LargestDifference(output->GetPointData()->GetArray("RestPosition"),
                  ball->GetPoints()->GetData()) == 0.0);
      FFD_CHECK(!ball->GetPointData()->HasArray("RestPosition"));
      filter->PassRestPositionsOff();
      // All vectors.
      filter->TransformAllInputVectorsOn();
      expected->TransformAllInputVectorsOn();
      filter->Update();
      expected->Update();
      FFD_CHECK(LargestDifference(output->GetPointData()->GetArray("other"),
                  expected->GetOutput()->GetPointData()->GetArray("other")) < tolerance);
      FFD_CHECK(LargestDifference(output->GetPointData()->GetArray("other"),
                  ball->GetPointData()->GetArray("other")) > 0.01);
    }
  }
  return EXIT_SUCCESS;
}

int TestInverseModes()
{
  vtkNew<vtkFFDLattice> lattice;
  ShapeLattice(lattice, 0.9);
  lattice->SetInverseTolerance(1e-9);
  vtkSmartPointer<vtkPolyData> ball = MakeBall(true);
  vtkNew<vtkFFDDeformGeometry> filter;
  filter->SetInputData(ball);
  filter->SetDeformation(lattice);
  FFD_CHECK(std::string(filter->GetInverseModeAsString()) == "EXACT");
  filter->SetInverseTolerance(1e-10);
  for (const int mode : { vtkFFDDeformGeometry::FIRST_ORDER, vtkFFDDeformGeometry::PULL_BACK })
  {
    filter->SetInverseMode(mode);
    filter->Update();
    FFD_CHECK(filter->GetNumberOfUnconvergedPoints() == 0);
    for (vtkIdType i = 0; i < ball->GetNumberOfPoints(); ++i)
    {
      double x[3];
      double p[3];
      double t[3];
      double jacobian[3][3];
      ball->GetPoint(i, x);
      filter->GetOutput()->GetPoint(i, p);
      lattice->InternalTransformDerivative(p, t, jacobian);
      double v[3];
      filter->GetOutput()->GetPointData()->GetVectors()->GetTuple(i, v);
      // Phi(P) = X, and vectors go back by the Jacobian of Phi.
      double back[3];
      vtkMath::Multiply3x3(jacobian, v, back);
      double original[3];
      ball->GetPointData()->GetVectors()->GetTuple(i, original);
      for (int a = 0; a < 3; ++a)
      {
        const bool first = mode == vtkFFDDeformGeometry::FIRST_ORDER;
        FFD_CHECK_NEAR(first ? 2.0 * p[a] - t[a] : t[a], x[a], 1e-7);
        FFD_CHECK_NEAR(first ? 2.0 * v[a] - back[a] : back[a], original[a], 1e-6);
      }
    }
  }
  // A loose tolerance stops earlier.
  filter->SetInverseModeToFirstOrder();
  filter->Update();
  vtkNew<vtkPoints> precise;
  precise->DeepCopy(filter->GetOutput()->GetPoints());
  filter->SetInverseTolerance(0.05);
  filter->Update();
  FFD_CHECK(
    LargestDifference(precise->GetData(), filter->GetOutput()->GetPoints()->GetData()) > 1e-6);
  // Folds: first-order points, counted.
  ShapeLattice(lattice, 9.0);
  filter->SetInverseTolerance(1e-9);
  filter->Update();
  const vtkIdType missed = filter->GetNumberOfUnconvergedPoints();
  FFD_CHECK(missed > 0);
  vtkIdType first = 0;
  for (vtkIdType i = 0; i < ball->GetNumberOfPoints(); ++i)
  {
    double x[3];
    double p[3];
    ball->GetPoint(i, x);
    lattice->TransformPoint(x, x);
    filter->GetOutput()->GetPoint(i, p);
    FFD_CHECK(std::isfinite(p[0] + p[1] + p[2]));
    first += FFDDistance(x, p) < 1e-12 ? 1 : 0;
  }
  FFD_CHECK(first >= missed);
  return EXIT_SUCCESS;
}

int TestInputs()
{
  vtkNew<vtkFFDLattice> lattice;
  ShapeLattice(lattice, 0.6);
  vtkSmartPointer<vtkPolyData> ball = MakeBall(true);
  vtkNew<vtkFFDDeformGeometry> direct;
  direct->SetInputData(ball);
  direct->SetDeformation(lattice);
  direct->Update();
  vtkDataArray* expected = direct->GetOutput()->GetPoints()->GetData();

  // From a volume with a lattice attached, from control points, from the input itself.
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(4, 4, 4);
  volume->AllocateScalars(VTK_SHORT, 1);
  vtkNew<vtkFFDDeformVolume> deform;
  deform->SetInputData(volume);
  deform->SetLattice(lattice);
  vtkNew<vtkFFDDeformGeometry> filter;
  vtkNew<FFDErrorLog> log;
  log->Watch(filter);
  filter->SetInputData(ball);
  filter->SetLatticeConnection(deform->GetOutputPort());
  filter->Update();
  FFD_CHECK(LargestDifference(filter->GetOutput()->GetPoints()->GetData(), expected) == 0.0);
  vtkNew<vtkImageData> points;
  lattice->ToImageData(points);
  filter->SetLatticeData(points);
  filter->Update();
  FFD_CHECK(LargestDifference(filter->GetOutput()->GetPoints()->GetData(), expected) == 0.0);
  filter->SetLatticeConnection(nullptr);
  filter->Update();
  FFD_CHECK(log->Had("There is no deformation"));
  FFD_CHECK(LargestDifference(
              filter->GetOutput()->GetPoints()->GetData(), ball->GetPoints()->GetData()) == 0.0);
  lattice->AttachTo(ball);
  ball->Modified();
  filter->Update();
  FFD_CHECK(LargestDifference(filter->GetOutput()->GetPoints()->GetData(), expected) == 0.0);
  FFD_CHECK(!vtkFFDLattice::HasLattice(filter->GetOutput()) && vtkFFDLattice::HasLattice(ball));

  // Keyframes: surface and volume at the same time.
  vtkNew<vtkFFDLattice> rest;
  rest->DeepCopy(lattice);
  rest->Reset();
  deform->AddKeyframe(0.0, rest);
  deform->AddKeyframe(2.0, lattice);
  filter->SetLatticeConnection(deform->GetOutputPort());
  filter->UpdateTimeStep(1.0);
  lattice->SetDisplacementScale(0.5);
  direct->Update();
  FFD_CHECK(LargestDifference(filter->GetOutput()->GetPoints()->GetData(),
              direct->GetOutput()->GetPoints()->GetData()) < 1e-12);
  lattice->SetDisplacementScale(1.0);

  // Edits arrive; the output's precision can be chosen.
  const vtkMTimeType time = direct->GetMTime();
  lattice->SetDisplacement(3, 3, 3, 2.0, 0.0, 0.0);
  FFD_CHECK(direct->GetMTime() > time);
  direct->SetOutputPointsPrecision(vtkAlgorithm::SINGLE_PRECISION);
  direct->Update();
  FFD_CHECK(direct->GetOutput()->GetPoints()->GetDataType() == VTK_FLOAT);

  // Other kinds of point sets; whole-numbered vectors become floats.
  vtkNew<vtkStructuredGrid> grid;
  grid->SetDimensions(3, 2, 1);
  vtkNew<vtkPoints> gridPoints;
  gridPoints->SetDataTypeToDouble();
  vtkNew<vtkIntArray> whole;
  whole->SetNumberOfComponents(3);
  whole->SetName("whole");
  for (int i = 0; i < 6; ++i)
  {
    gridPoints->InsertNextPoint(i % 3, i / 3, 1.0);
    whole->InsertNextTuple3(1, 0, 0);
  }
  grid->SetPoints(gridPoints);
  grid->GetPointData()->SetVectors(whole);
  direct->SetInputData(grid);
  direct->Update();
  FFD_CHECK(vtkStructuredGrid::SafeDownCast(direct->GetOutput()) != nullptr);
  FFD_CHECK(direct->GetOutput()->GetPointData()->GetVectors()->GetDataType() == VTK_FLOAT);
  vtkNew<vtkUnstructuredGrid> empty;
  direct->SetInputData(empty);
  direct->Update();
  FFD_CHECK(direct->GetOutput()->GetNumberOfPoints() == 0);

  // A point that is not a number stays one, and harms no other.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  gridPoints->SetPoint(2, nan, nan, nan);
  gridPoints->Modified();
  grid->Modified();
  for (const int mode : { vtkFFDDeformGeometry::FIRST_ORDER, vtkFFDDeformGeometry::EXACT,
         vtkFFDDeformGeometry::PULL_BACK })
  {
    direct->SetInputData(grid);
    direct->SetInverseMode(mode);
    direct->Update();
    double p[3];
    direct->GetOutput()->GetPoint(2, p);
    FFD_CHECK(!std::isfinite(p[0]));
    direct->GetOutput()->GetPoint(3, p);
    FFD_CHECK(std::isfinite(p[0] + p[1] + p[2]));
  }

  filter->SetInverseTolerance(0.0);
  FFD_CHECK(log->Had("InverseTolerance must be a positive number"));
  return EXIT_SUCCESS;
}

int TestProgressAndAbort()
{
  vtkNew<vtkFFDLattice> lattice;
  ShapeLattice(lattice, 0.3);
  vtkNew<vtkPolyData> cloud;
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(600000);
  for (vtkIdType i = 0; i < 600000; ++i)
  {
    points->SetPoint(i, 1e-5 * i, 0.0, 0.0);
  }
  cloud->SetPoints(points);
  vtkNew<vtkFFDDeformGeometry> filter;
  filter->SetInputData(cloud);
  filter->SetDeformation(lattice);
  int calls = 0;
  vtkNew<vtkCallbackCommand> callback;
  callback->SetClientData(&calls);
  callback->SetCallback([](vtkObject* caller, unsigned long, void* data, void*) {
    int* count = static_cast<int*>(data);
    if (++*count < 0)
    {
      vtkAlgorithm::SafeDownCast(caller)->AbortExecuteOn();
    }
  });
  filter->AddObserver(vtkCommand::ProgressEvent, callback);
  filter->Update();
  FFD_CHECK(calls >= 3 && filter->GetOutput()->GetNumberOfPoints() == 600000);
  calls = -100;
  filter->Modified();
  filter->Update();
  FFD_CHECK(calls < -97 && filter->GetOutput()->GetNumberOfPoints() == 0);
  return EXIT_SUCCESS;
}

} // namespace

int TestFFDDeformGeometry(int, char*[])
{
  return TestAgainstTransformFilter() || TestInverseModes() || TestInputs() ||
      TestProgressAndAbort()
    ? EXIT_FAILURE
    : EXIT_SUCCESS;
}
