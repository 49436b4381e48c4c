// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDSumTransform.h"

#include "vtkFFDWarpKernel.h"

#include "FFDNewtonInverse.h"

#include "vtkObjectFactory.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <vector>

vtkStandardNewMacro(vtkFFDSumTransform);

/// The terms, and the map that they make.
class vtkFFDSumTransform::Internals : public vtkFFDWarpKernel
{
public:
  struct Term
  {
    vtkSmartPointer<vtkAbstractTransform> Transform;
    double Weight = 1.0;
  };
  std::vector<Term> Terms;
  double Tolerance = 0.001;
  int Iterations = 500;

  glm::dvec3 Map(const glm::dvec3& p) const override
  {
    glm::dvec3 sum = p;
    for (const Term& term : this->Terms)
    {
      glm::dvec3 q;
      term.Transform->InternalTransformPoint(&p.x, &q.x);
      sum += term.Weight * (q - p);
    }
    return sum;
  }

  glm::dvec3 Map(const glm::dvec3& p, glm::dmat3& jacobian) const override
  {
    glm::dvec3 sum = p;
    jacobian = glm::dmat3(1.0);
    for (const Term& term : this->Terms)
    {
      glm::dvec3 q;
      double derivative[3][3];
      term.Transform->InternalTransformDerivative(&p.x, &q.x, derivative);
      sum += term.Weight * (q - p);
      for (int row = 0; row < 3; ++row)
      {
        for (int column = 0; column < 3; ++column)
        {
          jacobian[column][row] +=
            term.Weight * (derivative[row][column] - (row == column ? 1.0 : 0.0));
        }
      }
    }
    return sum;
  }

  glm::dvec3 Invert(const glm::dvec3& p) const override
  {
    return ffd::FindInverse(
      [this](const glm::dvec3& q, glm::dmat3& jacobian) { return this->Map(q, jacobian); }, p,
      this->Tolerance, this->Iterations);
  }
};

//------------------------------------------------------------------------------
vtkFFDSumTransform::vtkFFDSumTransform()
  : Map(new Internals)
{
}

//------------------------------------------------------------------------------
vtkFFDSumTransform::~vtkFFDSumTransform() = default;

//------------------------------------------------------------------------------
void vtkFFDSumTransform::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Transforms: " << this->Map->Terms.size() << "\n";
  for (const Internals::Term& term : this->Map->Terms)
  {
    os << indent.GetNextIndent() << term.Weight << " " << term.Transform->GetClassName() << "\n";
  }
}

//------------------------------------------------------------------------------
void vtkFFDSumTransform::AddTransform(vtkAbstractTransform* transform, double weight)
{
  if (!transform || !std::isfinite(weight))
  {
    vtkErrorMacro(
      "AddTransform: the transform is null, or the weight " << weight << " is not finite.");
    return;
  }
  if (transform->CircuitCheck(this))
  {
    vtkErrorMacro("AddTransform: the transform depends on this one. Add another one.");
    return;
  }
  this->Map->Terms.push_back({ transform, weight });
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDSumTransform::RemoveAllTransforms()
{
  if (!this->Map->Terms.empty())
  {
    this->Map->Terms.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDSumTransform::GetNumberOfTransforms()
{
  return static_cast<int>(this->Map->Terms.size());
}

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDSumTransform::GetTransform(int i)
{
  return i >= 0 && i < this->GetNumberOfTransforms()
    ? this->Map->Terms[static_cast<std::size_t>(i)].Transform.GetPointer()
    : nullptr;
}

//------------------------------------------------------------------------------
double vtkFFDSumTransform::GetWeight(int i)
{
  return i >= 0 && i < this->GetNumberOfTransforms()
    ? this->Map->Terms[static_cast<std::size_t>(i)].Weight
    : 0.0;
}

//------------------------------------------------------------------------------
int vtkFFDSumTransform::CircuitCheck(vtkAbstractTransform* transform)
{
  if (this->Superclass::CircuitCheck(transform))
  {
    return 1;
  }
  return std::any_of(this->Map->Terms.begin(), this->Map->Terms.end(),
           [transform](
             const Internals::Term& term) { return term.Transform->CircuitCheck(transform) != 0; })
    ? 1
    : 0;
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDSumTransform::GetMTime()
{
  vtkMTimeType time = this->Superclass::GetMTime();
  for (const Internals::Term& term : this->Map->Terms)
  {
    time = std::max(time, term.Transform->GetMTime());
  }
  return time;
}

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDSumTransform::MakeTransform() { return vtkFFDSumTransform::New(); }

//------------------------------------------------------------------------------
void vtkFFDSumTransform::InternalUpdate()
{
  this->Map->Tolerance = this->InverseTolerance;
  this->Map->Iterations = this->InverseIterations;
  for (const Internals::Term& term : this->Map->Terms)
  {
    term.Transform->Update();
  }
}

//------------------------------------------------------------------------------
void vtkFFDSumTransform::InternalDeepCopy(vtkAbstractTransform* transform)
{
  this->Superclass::InternalDeepCopy(transform);
  vtkFFDSumTransform* other = static_cast<vtkFFDSumTransform*>(transform);
  this->Map->Terms.clear();
  for (const Internals::Term& term : other->Map->Terms)
  {
    // What becomes of an inverse is known once it has been updated.
    term.Transform->Update();
    auto copy = vtkSmartPointer<vtkAbstractTransform>::Take(term.Transform->MakeTransform());
    copy->DeepCopy(term.Transform);
    this->Map->Terms.push_back({ copy, term.Weight });
  }
}

//------------------------------------------------------------------------------
const vtkFFDWarpKernel& vtkFFDSumTransform::GetKernel() const { return *this->Map; }
