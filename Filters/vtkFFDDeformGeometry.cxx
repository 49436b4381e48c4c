// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDeformGeometry.h"

#include "vtkFFDGuard.h"
#include "vtkFFDLattice.h"
#include "vtkFFDParallelFor.h"
#include "vtkFFDPipeline.h"

#include "vtkAbstractTransform.h"
#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLinearTransform.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPointSet.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTransform.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkFFDDeformGeometry);

namespace
{

/// Between two looks at AbortExecute.
constexpr vtkIdType PointsPerBatch = 1 << 18;

/// Maps points of the volume at rest to where they are drawn, with the Jacobian.
class ForwardMap
{
public:
  /// `reflected`: the map is the inverse of 2P - T(P), found to `tolerance`.
  ForwardMap(vtkAbstractTransform* transform, bool reflected, double tolerance)
    : Transform(transform)
    , Reflected(reflected)
    , Tolerance(tolerance)
  {
  }

  /// False: it did not converge.
  bool Evaluate(const double x[3], double moved[3], double jacobian[3][3]) const
  {
    if (!this->Reflected)
    {
      this->Transform->InternalTransformDerivative(x, moved, jacobian);
      return true;
    }
    return this->Solve(x, moved, jacobian);
  }

private:
  /// Residual of 2P - T(P) = x and its derivative.
  double FindResidual(
    const double x[3], const double p[3], double residual[3], double derivative[3][3]) const
  {
    this->Transform->InternalTransformDerivative(p, residual, derivative);
    for (int a = 0; a < 3; ++a)
    {
      residual[a] = (p[a] - residual[a]) + (p[a] - x[a]);
      for (int b = 0; b < 3; ++b)
      {
        derivative[a][b] = (a == b ? 2.0 : 0.0) - derivative[a][b];
      }
    }
    return vtkMath::Norm(residual);
  }

  /// Damped Newton from T(x), which is the solution to first order.
  bool Solve(const double x[3], double p[3], double jacobian[3][3]) const
  {
    constexpr int largestSteps = 50;
    constexpr int largestHalvings = 10;
    double start[3];
    this->Transform->InternalTransformDerivative(x, start, jacobian);
    std::copy(start, start + 3, p);
    double residual[3];
    double derivative[3][3];
    double length = this->FindResidual(x, p, residual, derivative);
    for (int step = 0; step < largestSteps && length > this->Tolerance; ++step)
    {
      if (vtkMath::Determinant3x3(derivative) == 0.0)
      {
        break;
      }
      double delta[3];
      vtkMath::LinearSolve3x3(derivative, residual, delta);
      double fraction = 1.0;
      bool accepted = false;
      for (int halving = 0; halving < largestHalvings && !accepted; ++halving)
      {
        double next[3];
        double nextResidual[3];
        double nextDerivative[3][3];
        for (int a = 0; a < 3; ++a)
        {
          next[a] = p[a] - fraction * delta[a];
        }
        const double nextLength = this->FindResidual(x, next, nextResidual, nextDerivative);
        // False for what is not a number, too.
        if (nextLength < length)
        {
          std::copy(next, next + 3, p);
          std::copy(nextResidual, nextResidual + 3, residual);
          std::copy(&nextDerivative[0][0], &nextDerivative[0][0] + 9, &derivative[0][0]);
          length = nextLength;
          accepted = true;
        }
        fraction *= 0.5;
      }
      if (!accepted)
      {
        break;
      }
    }
    if (length <= this->Tolerance && vtkMath::Determinant3x3(derivative) != 0.0)
    {
      vtkMath::Invert3x3(derivative, jacobian);
      return true;
    }
    // The Jacobian is still that of T at x.
    std::copy(start, start + 3, p);
    return false;
  }

  vtkAbstractTransform* Transform;
  bool Reflected;
  double Tolerance;
};

/// n becomes J^-T n of unit length; unchanged where that has no direction.
void MoveNormal(const double j[3][3], double n[3])
{
  // J^-T is the matrix of cofactors over the determinant, of which only the sign counts.
  double moved[3];
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3;
    const int c = (a + 2) % 3;
    double cofactors[3];
    vtkMath::Cross(j[b], j[c], cofactors);
    moved[a] = vtkMath::Dot(cofactors, n);
  }
  if (vtkMath::Determinant3x3(j) < 0.0)
  {
    vtkMath::MultiplyScalar(moved, -1.0);
  }
  const double length = vtkMath::Norm(moved);
  if (length > 0.0 && std::isfinite(length))
  {
    for (int a = 0; a < 3; ++a)
    {
      n[a] = moved[a] / length;
    }
  }
}

/// An array to transform and its copy in the output.
struct VectorArray
{
  vtkDataArray* From;
  vtkSmartPointer<vtkDataArray> To;
  bool Normals;

  void Move(vtkIdType i, const double jacobian[3][3]) const
  {
    double v[3];
    this->From->GetTuple(i, v);
    if (this->Normals)
    {
      MoveNormal(jacobian, v);
    }
    else
    {
      vtkMath::Multiply3x3(jacobian, v, v);
    }
    this->To->SetTuple(i, v);
  }
};

/// Adds `from` if it has three components for each of `count` points or cells.
void AddVectorArray(
  std::vector<VectorArray>& arrays, vtkDataArray* from, bool normals, vtkIdType count)
{
  if (!from || from->GetNumberOfComponents() != 3 || from->GetNumberOfTuples() < count ||
    std::any_of(
      arrays.begin(), arrays.end(), [from](const VectorArray& each) { return each.From == from; }))
  {
    return;
  }
  // Whole numbers have no room for what becomes of them.
  const int type = from->GetDataType() == VTK_DOUBLE ? VTK_DOUBLE : VTK_FLOAT;
  auto to = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
  to->SetName(from->GetName());
  to->SetNumberOfComponents(3);
  to->SetNumberOfTuples(from->GetNumberOfTuples());
  for (int c = 0; c < 3; ++c)
  {
    if (from->GetComponentName(c))
    {
      to->SetComponentName(c, from->GetComponentName(c));
    }
  }
  arrays.push_back({ from, to, normals });
}

/// The arrays of `from`, the attributes of `count` points or cells, that are transformed.
std::vector<VectorArray> FindVectorArrays(vtkDataSetAttributes* from, bool all, vtkIdType count)
{
  std::vector<VectorArray> arrays;
  AddVectorArray(arrays, from->GetNormals(), true, count);
  AddVectorArray(arrays, from->GetVectors(), false, count);
  for (int i = 0; all && i < from->GetNumberOfArrays(); ++i)
  {
    AddVectorArray(arrays, from->GetArray(i), false, count);
  }
  return arrays;
}

/// Put the transformed arrays in the place of those that were passed.
void Replace(vtkDataSetAttributes* to, const std::vector<VectorArray>& arrays)
{
  for (const VectorArray& each : arrays)
  {
    for (int i = 0; i < to->GetNumberOfArrays(); ++i)
    {
      if (to->GetArray(i) == each.From)
      {
        const int attribute = to->IsArrayAnAttribute(i);
        to->RemoveArray(i);
        const int added = to->AddArray(each.To);
        if (attribute >= 0)
        {
          to->SetActiveAttribute(added, attribute);
        }
        break;
      }
    }
  }
}

/// Whether two data objects have the same lattice.
bool HaveSameLattice(vtkDataObject* a, vtkDataObject* b)
{
  vtkFieldData* const fields = a->GetFieldData();
  if (!vtkFFDLattice::HasLattice(a) || !vtkFFDLattice::HasLattice(b))
  {
    return false;
  }
  for (int i = 0; i < fields->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* const x = fields->GetArray(i);
    const std::string name = x && x->GetName() ? x->GetName() : "";
    if (name.compare(0, 11, "FFDLattice.") != 0)
    {
      continue;
    }
    vtkDataArray* const y = b->GetFieldData()->GetArray(name.c_str());
    if (!y || x->GetNumberOfComponents() != y->GetNumberOfComponents() ||
      x->GetNumberOfTuples() != y->GetNumberOfTuples())
    {
      return false;
    }
    for (vtkIdType t = 0; x != y && t < x->GetNumberOfTuples(); ++t)
    {
      for (int c = 0; c < x->GetNumberOfComponents(); ++c)
      {
        if (x->GetComponent(t, c) != y->GetComponent(t, c))
        {
          return false;
        }
      }
    }
  }
  return true;
}

/// The data object with the lattice of the second input: that itself, or the first block, if any
/// has one. Null where not all blocks have that of the first.
vtkDataObject* FindCarrier(vtkDataObject* data)
{
  auto* blocks = vtkCompositeDataSet::SafeDownCast(data);
  if (!blocks)
  {
    return data;
  }
  vtkDataObject* first = nullptr;
  bool any = false;
  bool same = true;
  vtkSmartPointer<vtkCompositeDataIterator> iterator;
  iterator.TakeReference(blocks->NewIterator());
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    vtkDataObject* const block = iterator->GetCurrentDataObject();
    first = first ? first : block;
    any = any || vtkFFDLattice::HasLattice(block);
    same = same && HaveSameLattice(first, block);
  }
  if (!any)
  {
    return data;
  }
  return same ? first : nullptr;
}

/// The inverse of a transform, which is up to date. That of a vtkLandmarkTransform would be another
/// fit, from the targets to the sources, which is not the inverse where it is affine.
vtkSmartPointer<vtkAbstractTransform> Invert(vtkAbstractTransform* transform)
{
  auto* const linear = vtkLinearTransform::SafeDownCast(transform);
  if (!linear || linear->GetMatrix()->Determinant() == 0.0)
  {
    return transform->GetInverse();
  }
  vtkNew<vtkTransform> inverse;
  inverse->SetMatrix(linear->GetMatrix());
  inverse->Inverse();
  return inverse.Get();
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDDeformGeometry::vtkFFDDeformGeometry() { this->SetNumberOfInputPorts(2); }

//------------------------------------------------------------------------------
vtkFFDDeformGeometry::~vtkFFDDeformGeometry() { this->SetDeformation(nullptr); }

//------------------------------------------------------------------------------
vtkCxxSetObjectMacro(vtkFFDDeformGeometry, Deformation, vtkAbstractTransform);

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDDeformGeometry::GetDeformation() { return this->Deformation; }

//------------------------------------------------------------------------------
void vtkFFDDeformGeometry::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Deformation: " << this->Deformation << "\n";
  os << indent << "InverseMode: " << this->GetInverseModeAsString() << "\n";
  os << indent << "TransformAllInputVectors: " << this->TransformAllInputVectors << "\n";
  os << indent << "PassRestPositions: " << this->PassRestPositions << "\n";
  os << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n";
  os << indent << "InverseTolerance: " << this->InverseTolerance << "\n";
  os << indent << "NumberOfUnconvergedPoints: " << this->NumberOfUnconvergedPoints << "\n";
}

//------------------------------------------------------------------------------
const char* vtkFFDDeformGeometry::GetInverseModeAsString() const
{
  static const char* const names[] = { "FIRST_ORDER", "EXACT", "PULL_BACK" };
  return names[this->InverseMode];
}

//------------------------------------------------------------------------------
void vtkFFDDeformGeometry::SetInverseTolerance(double fraction)
{
  if (!(fraction > 0.0) || !std::isfinite(fraction))
  {
    vtkErrorMacro("InverseTolerance must be a positive number, not "
      << fraction << "; it stays " << this->InverseTolerance << ".");
    return;
  }
  if (this->InverseTolerance != fraction)
  {
    this->InverseTolerance = fraction;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDDeformGeometry::SetLatticeConnection(vtkAlgorithmOutput* connection)
{
  this->SetInputConnection(1, connection);
}

//------------------------------------------------------------------------------
void vtkFFDDeformGeometry::SetLatticeData(vtkDataObject* data)
{
  this->SetInputDataInternal(1, data);
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDDeformGeometry::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->Deformation ? std::max(own, this->Deformation->GetMTime()) : own;
}

//------------------------------------------------------------------------------
int vtkFFDDeformGeometry::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObject");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
    return 1;
  }
  return this->Superclass::FillInputPortInformation(port, info);
}

//------------------------------------------------------------------------------
vtkTypeBool vtkFFDDeformGeometry::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA_OBJECT()))
  {
    vtkDataObject* const input = vtkDataObject::GetData(inputs[0]);
    if (input && !vtkPointSet::SafeDownCast(input))
    {
      vtkErrorMacro("The input is a "
        << input->GetClassName()
        << ", which has no points that could be moved. Make points of it, by "
           "vtkImageDataToPointSet or vtkRectilinearGridToPointSet, or deform its voxels by "
           "vtkFFDDeformVolume.");
      return 0;
    }
  }
  // The extent or piece of the geometry means nothing to the lattice.
  if (request->Has(vtkStreamingDemandDrivenPipeline::REQUEST_UPDATE_EXTENT()))
  {
    vtkFFDRequestWhole(inputs[1]->GetInformationObject(0));
  }
  return vtkFFDGuardedRequest(this, "vtkFFDDeformGeometry", outputs, [&] {
    const int result = this->Superclass::ProcessRequest(request, inputs, outputs);
    if (request->Has(vtkDemandDrivenPipeline::REQUEST_INFORMATION()))
    {
      // The lattice of the second input may move where the geometry does not.
      vtkFFDMergeTimes({},
        { inputs[0]->GetInformationObject(0),
          this->Deformation ? nullptr : inputs[1]->GetInformationObject(0) },
        outputs->GetInformationObject(0));
    }
    return result;
  });
}

//------------------------------------------------------------------------------
int vtkFFDDeformGeometry::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkPointSet* input = vtkPointSet::GetData(inputs[0]);
  vtkPointSet* output = vtkPointSet::GetData(outputs);
  this->NumberOfUnconvergedPoints = 0;
  if (!input || !output)
  {
    vtkErrorMacro("There is no geometry to deform. Connect a vtkPointSet to the first input.");
    return 0;
  }
  output->ShallowCopy(input);
  // Field data of our own, so that a lattice is not taken off the input, too.
  vtkNew<vtkFieldData> fields;
  if (input->GetFieldData())
  {
    fields->PassData(input->GetFieldData());
  }
  output->SetFieldData(fields);
  vtkFFDLattice::DetachFrom(output);
  if (!input->GetPoints() || input->GetNumberOfPoints() == 0)
  {
    return 1;
  }

  vtkSmartPointer<vtkAbstractTransform> transform = this->Deformation;
  if (!transform)
  {
    vtkInformation* info = inputs[1]->GetInformationObject(0);
    vtkDataObject* const second = info ? vtkDataObject::GetData(info) : nullptr;
    vtkDataObject* const other = FindCarrier(second);
    if (second && !other)
    {
      vtkErrorMacro(
        "The blocks of the second input have a lattice each, or some have none, and the "
        "geometry passes through. Connect one of the blocks, or blocks that all have the "
        "same lattice.");
      return 1;
    }
    vtkNew<vtkFFDLattice> lattice;
    // An unusable lattice is reported by the lattice itself.
    if (other && !vtkFFDLattice::HasLattice(other) && vtkImageData::SafeDownCast(other))
    {
      if (!lattice->FromImageData(vtkImageData::SafeDownCast(other)))
      {
        return 1;
      }
    }
    else if (other || vtkFFDLattice::HasLattice(input))
    {
      if (!lattice->ReadFrom(other ? other : input))
      {
        return 1;
      }
    }
    else
    {
      vtkErrorMacro("There is no deformation, the geometry passes through. Call SetDeformation(), "
                    "or connect a volume with a lattice attached to the second input.");
      return 1;
    }
    transform = lattice;
  }
  transform->Update();
  const vtkSmartPointer<vtkAbstractTransform> applied =
    this->InverseMode == PULL_BACK ? Invert(transform) : transform;
  applied->Update();
  double bounds[6];
  input->GetPoints()->GetBounds(bounds);
  const double diagonal = std::sqrt((bounds[1] - bounds[0]) * (bounds[1] - bounds[0]) +
    (bounds[3] - bounds[2]) * (bounds[3] - bounds[2]) +
    (bounds[5] - bounds[4]) * (bounds[5] - bounds[4]));
  const ForwardMap map(applied, this->InverseMode == FIRST_ORDER,
    this->InverseTolerance * (diagonal > 0.0 ? diagonal : 1.0));

  vtkPoints* const from = input->GetPoints();
  vtkNew<vtkPoints> to;
  to->SetDataType(this->OutputPointsPrecision == SINGLE_PRECISION ? VTK_FLOAT
      : this->OutputPointsPrecision == DOUBLE_PRECISION           ? VTK_DOUBLE
                                                                  : from->GetDataType());
  const vtkIdType points = input->GetNumberOfPoints();
  to->SetNumberOfPoints(points);
  const std::vector<VectorArray> pointArrays =
    FindVectorArrays(input->GetPointData(), this->TransformAllInputVectors != 0, points);
  const std::vector<VectorArray> cellArrays =
    FindVectorArrays(input->GetCellData(), false, input->GetNumberOfCells());
  const vtkIdType cells = cellArrays.empty() ? 0 : input->GetNumberOfCells();

  std::atomic<vtkIdType> unconverged{ 0 };
  for (vtkIdType first = 0; first < points && !this->GetAbortExecute(); first += PointsPerBatch)
  {
    const vtkIdType last = std::min(points, first + PointsPerBatch);
    vtkFFDParallelFor()(static_cast<std::size_t>(last - first),
      [&map, from, first, &to, &pointArrays, &unconverged](std::size_t begin, std::size_t end) {
        vtkIdType missed = 0;
        const vtkIdType stop = first + static_cast<vtkIdType>(end);
        for (vtkIdType i = first + static_cast<vtkIdType>(begin); i < stop; ++i)
        {
          double x[3];
          double moved[3];
          double jacobian[3][3];
          from->GetPoint(i, x);
          missed += map.Evaluate(x, moved, jacobian) ? 0 : 1;
          to->SetPoint(i, moved);
          for (const VectorArray& array : pointArrays)
          {
            array.Move(i, jacobian);
          }
        }
        unconverged += missed;
      });
    this->UpdateProgress(static_cast<double>(last) / (points + cells));
  }
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < cells && !this->GetAbortExecute(); ++cell)
  {
    input->GetCellPoints(cell, ids);
    double center[3] = { 0.0, 0.0, 0.0 };
    for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i)
    {
      double x[3];
      from->GetPoint(ids->GetId(i), x);
      for (int a = 0; a < 3; ++a)
      {
        center[a] += x[a] / ids->GetNumberOfIds();
      }
    }
    double moved[3];
    double jacobian[3][3];
    map.Evaluate(center, moved, jacobian);
    for (const VectorArray& array : cellArrays)
    {
      array.Move(cell, jacobian);
    }
    if (cell % PointsPerBatch == PointsPerBatch - 1)
    {
      this->UpdateProgress(static_cast<double>(points + cell) / (points + cells));
    }
  }
  if (this->GetAbortExecute())
  {
    output->Initialize();
    return 1;
  }
  this->NumberOfUnconvergedPoints = unconverged;
  output->SetPoints(to);
  Replace(output->GetPointData(), pointArrays);
  if (this->PassRestPositions)
  {
    vtkSmartPointer<vtkDataArray> rest;
    rest.TakeReference(from->GetData()->NewInstance());
    rest->ShallowCopy(from->GetData());
    rest->SetName("RestPosition");
    output->GetPointData()->AddArray(rest);
  }
  Replace(output->GetCellData(), cellArrays);
  this->UpdateProgress(1.0);
  return 1;
}
