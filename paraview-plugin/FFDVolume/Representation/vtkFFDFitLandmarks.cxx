// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFitLandmarks.h"

#include "vtkFFDFitLattice.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeData.h"
#include "vtkFFDPipeline.h"

#include "vtkAlgorithmOutput.h"
#include "vtkBoundingBox.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkExtentTranslator.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>

vtkStandardNewMacro(vtkFFDFitLandmarks);

namespace
{

using Pipeline = vtkStreamingDemandDrivenPipeline;

enum Inputs
{
  Source,
  Target,
  Region
};

} // namespace

//------------------------------------------------------------------------------
vtkFFDFitLandmarks::vtkFFDFitLandmarks()
{
  this->SetNumberOfInputPorts(3);
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
vtkFFDFitLandmarks::~vtkFFDFitLandmarks() = default;

//------------------------------------------------------------------------------
void vtkFFDFitLandmarks::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Fit:\n";
  this->Fit->PrintSelf(os, indent.GetNextIndent());
}

//------------------------------------------------------------------------------
void vtkFFDFitLandmarks::SetTolerance(double tolerance)
{
  if (tolerance != this->Fit->GetTolerance())
  {
    this->Fit->SetTolerance(tolerance);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
double vtkFFDFitLandmarks::GetTolerance() { return this->Fit->GetTolerance(); }

//------------------------------------------------------------------------------
void vtkFFDFitLandmarks::SetMaximumCells(int cells)
{
  if (cells != this->Fit->GetMaximumCells())
  {
    this->Fit->SetMaximumCells(cells);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDFitLandmarks::GetMaximumCells() { return this->Fit->GetMaximumCells(); }

//------------------------------------------------------------------------------
void vtkFFDFitLandmarks::SetSmoothness(double smoothness)
{
  if (smoothness != this->Fit->GetSmoothness())
  {
    this->Fit->SetSmoothness(smoothness);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
double vtkFFDFitLandmarks::GetSmoothness() { return this->Fit->GetSmoothness(); }

//------------------------------------------------------------------------------
double vtkFFDFitLandmarks::GetMaximumError() { return this->Fit->GetMaximumError(); }

//------------------------------------------------------------------------------
double vtkFFDFitLandmarks::GetRootMeanSquareError() { return this->Fit->GetRootMeanSquareError(); }

//------------------------------------------------------------------------------
int vtkFFDFitLandmarks::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(
    vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == Region ? "vtkImageData" : "vtkPointSet");
  if (port == Region)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDFitLandmarks::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkImageData" : "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
/// Fit anew where the landmarks or the region have changed. False where there is no lattice, which
/// is told of with `report`.
bool vtkFFDFitLandmarks::UpdateFit(bool report)
{
  vtkSmartPointer<vtkPoints> points[2];
  vtkMTimeType time = this->GetMTime();
  for (int port : { Source, Target })
  {
    vtkAlgorithmOutput* connection =
      this->GetNumberOfInputConnections(port) > 0 ? this->GetInputConnection(port, 0) : nullptr;
    if (connection)
    {
      vtkFFDUpdateWhole(connection, this->GetOutputInformation(0));
    }
    vtkPointSet* set =
      connection ? vtkPointSet::SafeDownCast(this->GetInputDataObject(port, 0)) : nullptr;
    if (!set || set->GetNumberOfPoints() == 0)
    {
      if (!report)
      {
        return false;
      }
      vtkErrorMacro("There are no " << (port == Source ? "source" : "target")
                                    << " landmarks. Connect a source of points, as \"Poly Line "
                                       "Source\", to both inputs.");
      return false;
    }
    time = std::max(time, set->GetMTime());
    points[port] = vtkSmartPointer<vtkPoints>::New();
    points[port]->DeepCopy(set->GetPoints());
  }
  if (points[0]->GetNumberOfPoints() != points[1]->GetNumberOfPoints())
  {
    if (!report)
    {
      return false;
    }
    vtkErrorMacro("There are " << points[0]->GetNumberOfPoints() << " source landmarks and "
                               << points[1]->GetNumberOfPoints()
                               << " target landmarks. Place as many of either, in the same order.");
    return false;
  }
  double bounds[6] = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 };
  if (this->GetNumberOfInputConnections(Region) > 0)
  {
    vtkBoundingBox box;
    box.AddBounds(this->RegionBounds);
    box.AddBounds(points[0]->GetBounds());
    box.AddBounds(points[1]->GetBounds());
    box.GetBounds(bounds);
  }
  const double* last = this->Fit->GetBounds();
  if (this->FitTime < time || !std::equal(bounds, bounds + 6, last))
  {
    this->Fit->SetBounds(bounds);
    this->Fit->SetSourceLandmarks(points[0]);
    this->Fit->SetTargetLandmarks(points[1]);
    this->FitTime.Modified();
  }
  return this->Fit->GetLattice() != nullptr;
}

//------------------------------------------------------------------------------
int vtkFFDFitLandmarks::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  // A process may have no voxel of the region when there are data: the bounds are found here.
  vtkMath::UninitializeBounds(this->RegionBounds);
  vtkInformation* region =
    this->GetNumberOfInputConnections(Region) > 0 ? this->GetInputInformation(Region, 0) : nullptr;
  if (region && region->Has(Pipeline::WHOLE_EXTENT()))
  {
    const bool isKnown = region->Has(vtkDataObject::DIRECTION()) != 0;
    if (!isKnown)
    {
      vtkFFDUpdatePart(this->GetInputConnection(Region, 0), this->GetOutputInformation(0));
    }
    vtkNew<vtkImageData> geometry;
    vtkFFDGetWholeGeometry(region, isKnown ? nullptr : vtkImageData::GetData(region), geometry);
    geometry->GetBounds(this->RegionBounds);
  }
  // How many control points there are is a result of the fit.
  vtkInformation* info = outputs->GetInformationObject(0);
  if (!this->UpdateFit(true))
  {
    // Nothing, without more messages.
    static constexpr int nothing[6] = { 0, -1, 0, -1, 0, -1 };
    info->Set(Pipeline::WHOLE_EXTENT(), nothing, 6);
    return 1;
  }
  vtkFFDLattice* lattice = this->Fit->GetLattice();
  vtkFFDDescribeLatticeImage(lattice, info);
  outputs->GetInformationObject(1)->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDFitLandmarks::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  for (int port : { Source, Target })
  {
    vtkFFDRequestWhole(inputs[port]->GetInformationObject(0));
  }
  // Only its bounds matter, which are known; but what it is asked for last is what it gives to
  // others, too: this process' part, as what shows the volume asks for.
  vtkInformation* info = inputs[Region]->GetInformationObject(0);
  if (info && info->Has(Pipeline::WHOLE_EXTENT()))
  {
    vtkMultiProcessController* processes = vtkMultiProcessController::GetGlobalController();
    const int piece = processes ? processes->GetLocalProcessId() : 0;
    const int pieces = processes ? processes->GetNumberOfProcesses() : 1;
    int extent[6];
    vtkNew<vtkExtentTranslator> translator;
    translator->PieceToExtentThreadSafe(piece, pieces, 0, info->Get(Pipeline::WHOLE_EXTENT()),
      extent, vtkExtentTranslator::BLOCK_MODE, 0);
    info->Set(Pipeline::UPDATE_PIECE_NUMBER(), piece);
    info->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), pieces);
    info->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
    info->Set(Pipeline::UPDATE_EXTENT(), extent, 6);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDFitLandmarks::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkImageData* image = vtkImageData::GetData(outputs, 0);
  vtkPolyData* moved = vtkPolyData::GetData(outputs, 1);
  if (!image || !moved)
  {
    return 0;
  }
  if (!this->UpdateFit(false))
  {
    image->Initialize();
    moved->Initialize();
    return 1;
  }
  vtkFFDLattice* lattice = this->Fit->GetLattice();
  vtkInformation* info = outputs->GetInformationObject(1);
  if (info->Has(Pipeline::UPDATE_PIECE_NUMBER()) && info->Get(Pipeline::UPDATE_PIECE_NUMBER()) > 0)
  {
    return lattice->ToImageData(image);
  }
  vtkPoints* from = this->Fit->GetSourceLandmarks();
  vtkPoints* to = this->Fit->GetTargetLandmarks();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices;
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkDoubleArray> residuals;
  residuals->SetName("Residual");
  vtkNew<vtkDoubleArray> vectors;
  vectors->SetName("ResidualVector");
  vectors->SetNumberOfComponents(3);
  const vtkIdType count = from->GetNumberOfPoints();
  // The landmarks, then their targets, where there is none left.
  for (vtkIdType i = 0; i < 2 * count; ++i)
  {
    double target[3];
    double p[3];
    to->GetPoint(i % count, target);
    if (i < count)
    {
      lattice->TransformPoint(from->GetPoint(i), p);
      const vtkIdType line[2] = { i, i + count };
      lines->InsertNextCell(2, line);
      vertices->InsertNextCell(1, &i);
    }
    else
    {
      std::copy_n(target, 3, p);
    }
    points->InsertNextPoint(p);
    const double rest[3] = { target[0] - p[0], target[1] - p[1], target[2] - p[2] };
    residuals->InsertNextValue(vtkMath::Norm(rest));
    vectors->InsertNextTuple(rest);
  }
  moved->SetPoints(points);
  moved->SetVerts(vertices);
  moved->SetLines(lines);
  moved->GetPointData()->SetScalars(residuals);
  moved->GetPointData()->AddArray(vectors);
  return lattice->ToImageData(image);
}
