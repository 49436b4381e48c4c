// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDSplineTransform.h"

#include "vtkFFDWarpKernel.h"

#include "FFDNewtonInverse.h"
#include "FFDUniformSpline.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cmath>

vtkStandardNewMacro(vtkFFDSplineTransform);

namespace
{
/// The kernel, with an inverse.
struct InvertibleSpline : ffd::UniformSpline
{
  double Tolerance = 0.001;
  int Iterations = 500;

  glm::dvec3 Inverse(const glm::dvec3& p) const
  {
    return ffd::FindInverse(
      [this](const glm::dvec3& q, glm::dmat3& jacobian) { return this->Forward(q, jacobian); }, p,
      this->Tolerance, this->Iterations);
  }
};
}

class vtkFFDSplineTransform::Internals : public vtkFFDWarpKernelOf<InvertibleSpline>
{
public:
  /// False when a displacement is not finite.
  bool SetGrid(vtkImageData* grid, vtkDataArray* scalars)
  {
    int extent[6];
    grid->GetExtent(extent);
    for (int a = 0; a < 3; ++a)
    {
      this->Size[a] = extent[2 * a + 1] - extent[2 * a] + 1;
      this->Spacing[a] = grid->GetSpacing()[a];
      this->Origin[a] = grid->GetOrigin()[a] + extent[2 * a] * this->Spacing[a];
    }
    this->Values.resize(static_cast<std::size_t>(scalars->GetNumberOfTuples()));
    for (std::size_t i = 0; i < this->Values.size(); ++i)
    {
      glm::dvec3& value = this->Values[i];
      scalars->GetTuple(static_cast<vtkIdType>(i), &value.x);
      if (!std::isfinite(value.x) || !std::isfinite(value.y) || !std::isfinite(value.z))
      {
        return false;
      }
    }
    return true;
  }
};

//------------------------------------------------------------------------------
vtkFFDSplineTransform::vtkFFDSplineTransform()
  : Map(new Internals)
{
}

//------------------------------------------------------------------------------
vtkFFDSplineTransform::~vtkFFDSplineTransform() = default;

//------------------------------------------------------------------------------
void vtkFFDSplineTransform::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "SplineOrder: " << this->SplineOrder << "\n";
  os << indent << "RepeatBorder: " << this->RepeatBorder << "\n";
  os << indent << "DisplacementGrid: " << (this->DisplacementGrid ? "given" : "(none)") << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDSplineTransform::SetDisplacementGrid(vtkImageData* grid)
{
  if (this->DisplacementGrid != grid)
  {
    this->DisplacementGrid = grid;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkImageData* vtkFFDSplineTransform::GetDisplacementGrid() { return this->DisplacementGrid; }

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDSplineTransform::GetMTime()
{
  vtkMTimeType time = this->Superclass::GetMTime();
  if (this->DisplacementGrid)
  {
    time = std::max(time, this->DisplacementGrid->GetMTime());
  }
  return time;
}

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDSplineTransform::MakeTransform()
{
  return vtkFFDSplineTransform::New();
}

//------------------------------------------------------------------------------
void vtkFFDSplineTransform::InternalUpdate()
{
  Internals& map = *this->Map;
  map.Order = this->SplineOrder;
  map.Repeat = this->RepeatBorder != 0;
  map.Tolerance = this->InverseTolerance;
  map.Iterations = this->InverseIterations;
  map.Values.clear();
  vtkImageData* const grid = this->DisplacementGrid;
  if (!grid)
  {
    return;
  }
  vtkDataArray* const scalars = grid->GetPointData()->GetScalars();
  const double* const spacing = grid->GetSpacing();
  if (!scalars || scalars->GetNumberOfComponents() != 3 || grid->GetNumberOfPoints() < 1 ||
    scalars->GetNumberOfTuples() != grid->GetNumberOfPoints() || spacing[0] == 0.0 ||
    spacing[1] == 0.0 || spacing[2] == 0.0)
  {
    vtkErrorMacro("The displacement grid has no point scalars of 3 components, or a spacing of "
                  "zero. The identity is used.");
    return;
  }
  if (!map.SetGrid(grid, scalars))
  {
    map.Values.clear();
    vtkErrorMacro("A displacement of the grid is not finite. The identity is used.");
  }
}

//------------------------------------------------------------------------------
void vtkFFDSplineTransform::InternalDeepCopy(vtkAbstractTransform* transform)
{
  this->Superclass::InternalDeepCopy(transform);
  vtkFFDSplineTransform* other = static_cast<vtkFFDSplineTransform*>(transform);
  this->SplineOrder = other->SplineOrder;
  this->RepeatBorder = other->RepeatBorder;
  this->DisplacementGrid = other->DisplacementGrid;
}

//------------------------------------------------------------------------------
const vtkFFDWarpKernel& vtkFFDSplineTransform::GetKernel() const { return *this->Map; }
