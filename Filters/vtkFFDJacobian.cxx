// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDJacobian.h"

#include "vtkFFDBSplineFieldFromTransform.h"
#include "vtkFFDGuard.h"
#include "vtkFFDLattice.h"
#include "vtkFFDParallelFor.h"

#include "FFDBSplineField.h"
#include "FFDSplineRows.h"

#include "vtkAbstractTransform.h"
#include "vtkBSplineTransform.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkSMPThreadLocal.h"
#include "vtkUnsignedCharArray.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkFFDJacobian);
vtkFFDGuardedProcessRequestMacro(vtkFFDJacobian);

namespace
{

/// Between two looks at AbortExecute.
constexpr int SlicesPerLook = 32;

/// Counts of one thread.
struct Summary
{
  double Least = std::numeric_limits<double>::infinity();
  double Largest = -std::numeric_limits<double>::infinity();
  vtkIdType Folded = 0;
};

/// Jacobians of a transform at the points of image rows.
class JacobianRows
{
public:
  JacobianRows(vtkAbstractTransform* transform, const ffd::BSplineField* field,
    const ffd::ImageGrid& grid, int first, int last)
    : Transform(transform)
    , Grid(grid)
    , First(first)
  {
    if (field)
    {
      this->Rows.reset(new ffd::SplineRows(*field, grid, first, last));
    }
  }

  void Evaluate(
    int j, int k, ffd::SplineRows::Scratch& scratch, std::vector<glm::dmat3>& jacobians) const
  {
    if (this->Rows)
    {
      this->Rows->Jacobians(j, k, scratch, jacobians.data());
      for (glm::dmat3& jacobian : jacobians)
      {
        jacobian += glm::dmat3(1.0);
      }
      return;
    }
    for (std::size_t i = 0; i < jacobians.size(); ++i)
    {
      const glm::dvec3 p = this->Grid.ToData(glm::dvec3(this->First + static_cast<int>(i), j, k));
      double moved[3];
      double derivative[3][3];
      this->Transform->InternalTransformDerivative(&p.x, moved, derivative);
      for (int a = 0; a < 9; ++a)
      {
        jacobians[i][a % 3][a / 3] = derivative[a / 3][a % 3];
      }
    }
  }

private:
  vtkAbstractTransform* Transform;
  ffd::ImageGrid Grid;
  int First;
  std::unique_ptr<ffd::SplineRows> Rows;
};

/// The determinants of a row of points, and which of these are folds.
void WriteRow(const std::vector<glm::dmat3>& jacobians, double threshold, float* determinants,
  unsigned char* mask, Summary& summary)
{
  for (std::size_t i = 0; i < jacobians.size(); ++i)
  {
    const double determinant = glm::determinant(jacobians[i]);
    // A determinant that is not a number counts as a fold.
    const bool folded = !(determinant > threshold);
    determinants[i] = static_cast<float>(determinant);
    mask[i] = folded ? 1 : 0;
    summary.Folded += folded ? 1 : 0;
    if (std::isfinite(determinant))
    {
      summary.Least = std::min(summary.Least, determinant);
      summary.Largest = std::max(summary.Largest, determinant);
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDJacobian::vtkFFDJacobian() = default;

//------------------------------------------------------------------------------
vtkFFDJacobian::~vtkFFDJacobian() { this->SetDeformation(nullptr); }

//------------------------------------------------------------------------------
vtkCxxSetObjectMacro(vtkFFDJacobian, Deformation, vtkAbstractTransform);

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDJacobian::GetDeformation() { return this->Deformation; }

//------------------------------------------------------------------------------
void vtkFFDJacobian::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Deformation: " << this->Deformation << "\n";
  os << indent << "FoldThreshold: " << this->FoldThreshold << "\n";
  os << indent << "DeterminantRange: (" << this->DeterminantRange[0] << ", "
     << this->DeterminantRange[1] << ")\n";
  os << indent << "NumberOfFoldedPoints: " << this->NumberOfFoldedPoints << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDJacobian::SetFoldThreshold(double determinant)
{
  if (!std::isfinite(determinant))
  {
    vtkErrorMacro(
      "SetFoldThreshold: the determinant is " << determinant << ". Give a finite number.");
    return;
  }
  if (this->FoldThreshold != determinant)
  {
    this->FoldThreshold = determinant;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDJacobian::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->Deformation ? std::max(own, this->Deformation->GetMTime()) : own;
}

//------------------------------------------------------------------------------
int vtkFFDJacobian::RequestInformation(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkInformation* output = outputs->GetInformationObject(0);
  vtkDataObject::SetPointDataActiveScalarInfo(output, VTK_FLOAT, 1);
  output->CopyEntry(inputs[0]->GetInformationObject(0), vtkDataObject::DIRECTION());
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDJacobian::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkImageData* input = vtkImageData::GetData(inputs[0]);
  vtkImageData* output = vtkImageData::GetData(outputs);
  this->DeterminantRange[0] = 1.0;
  this->DeterminantRange[1] = -1.0;
  this->NumberOfFoldedPoints = 0;
  if (!input || !output)
  {
    vtkErrorMacro("There is no image grid. Connect a vtkImageData to the input.");
    return 0;
  }
  output->ShallowCopy(input);
  vtkSmartPointer<vtkAbstractTransform> transform = this->Deformation;
  if (!transform)
  {
    vtkNew<vtkFFDLattice> lattice;
    if (!vtkFFDLattice::HasLattice(input))
    {
      vtkErrorMacro(
        "There is no deformation, the determinant is 1. Call SetDeformation(), or attach "
        "a lattice to the input.");
    }
    else
    {
      lattice->ReadFrom(input);
    }
    transform = lattice;
  }
  transform->Update();
  ffd::BSplineField field;
  bool inverse = false;
  std::string problem;
  vtkBSplineTransform* spline = vtkBSplineTransform::SafeDownCast(transform);
  const bool rows =
    spline && vtkFFDBSplineFieldFromTransform(spline, field, inverse, problem) && !inverse;

  ffd::ImageGrid grid;
  vtkMatrix3x3* direction = output->GetDirectionMatrix();
  for (int row = 0; row < 3; ++row)
  {
    grid.Origin[row] = output->GetOrigin()[row];
    for (int column = 0; column < 3; ++column)
    {
      grid.IndexToData[column][row] =
        direction->GetElement(row, column) * output->GetSpacing()[column];
    }
  }
  int extent[6];
  output->GetExtent(extent);
  const vtkIdType points = output->GetNumberOfPoints();
  vtkFFDRequireMemory(5.0 * static_cast<double>(points),
    "The determinants of " + std::to_string(points) + " points", "Use a coarser image.");
  vtkNew<vtkFloatArray> determinants;
  determinants->SetName("JacobianDeterminant");
  determinants->SetNumberOfValues(points);
  vtkNew<vtkUnsignedCharArray> mask;
  mask->SetName("FoldMask");
  mask->SetNumberOfValues(points);

  vtkSMPThreadLocal<Summary> summaries;
  if (points > 0)
  {
    const JacobianRows evaluator(transform, rows ? &field : nullptr, grid, extent[0], extent[1]);
    const vtkIdType rowLength = extent[1] - extent[0] + 1;
    const vtkIdType rowsPerSlice = extent[3] - extent[2] + 1;
    const double threshold = this->FoldThreshold;
    const vtkIdType slices = extent[5] - extent[4] + 1;
    for (vtkIdType slice = 0; slice < slices && !this->GetAbortExecute(); slice += SlicesPerLook)
    {
      const vtkIdType last = std::min<vtkIdType>(slices, slice + SlicesPerLook);
      const vtkIdType firstRow = slice * rowsPerSlice;
      vtkFFDParallelFor()(static_cast<std::size_t>(last * rowsPerSlice - firstRow),
        [&](std::size_t begin, std::size_t end) {
          ffd::SplineRows::Scratch scratch;
          std::vector<glm::dmat3> jacobians(static_cast<std::size_t>(rowLength));
          Summary& summary = summaries.Local();
          for (std::size_t r = begin; r < end; ++r)
          {
            const vtkIdType row = firstRow + static_cast<vtkIdType>(r);
            evaluator.Evaluate(extent[2] + static_cast<int>(row % rowsPerSlice),
              extent[4] + static_cast<int>(row / rowsPerSlice), scratch, jacobians);
            WriteRow(jacobians, threshold, determinants->GetPointer(row * rowLength),
              mask->GetPointer(row * rowLength), summary);
          }
        });
      this->UpdateProgress(static_cast<double>(last) / slices);
    }
  }
  if (this->GetAbortExecute())
  {
    output->Initialize();
    return 1;
  }
  Summary all;
  for (const Summary& each : summaries)
  {
    all.Least = std::min(all.Least, each.Least);
    all.Largest = std::max(all.Largest, each.Largest);
    all.Folded += each.Folded;
  }
  if (all.Least <= all.Largest)
  {
    this->DeterminantRange[0] = all.Least;
    this->DeterminantRange[1] = all.Largest;
  }
  this->NumberOfFoldedPoints = all.Folded;
  output->GetPointData()->AddArray(mask);
  // Not SetScalars(), which takes the place of the scalars of the input.
  output->GetPointData()->AddArray(determinants);
  output->GetPointData()->SetActiveScalars(determinants->GetName());
  return 1;
}
