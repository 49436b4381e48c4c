// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDeformationSource.h"

#include "vtkBSplineTransform.h"
#include "vtkFFDLattice.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkDataArray.h"
#include <vector>

vtkFFDDeformationSource::vtkFFDDeformationSource() = default;
vtkFFDDeformationSource::~vtkFFDDeformationSource() = default;

bool vtkFFDDeformationSource::Update(vtkAbstractTransform* transform, vtkImageData*, const double[6],
    double, std::string& message, std::string&)
{
  auto* spline = vtkBSplineTransform::SafeDownCast(transform);
  if (transform && !spline) { message = "not a spline"; return false; }
  if (!spline) { if (!this->MadeFromTime) {this->Changed.Modified(); this->MadeFromTime=1;} return true; }
  spline->Update();
  if (MadeFrom==spline && MadeFromTime==spline->GetMTime()) return true;
  MadeFrom=spline; MadeFromTime=spline->GetMTime();
  vtkImageData* c = spline->GetCoefficientData();
  int d[3]; c->GetDimensions(d); double* o=c->GetOrigin(); double* s=c->GetSpacing();
  std::vector<glm::dvec3> v(d[0]*d[1]*d[2]);
  for (size_t i=0;i<v.size();++i) { double t[3]; c->GetPointData()->GetScalars()->GetTuple(i,t); v[i]=glm::dvec3(t[0],t[1],t[2]); }
  Field = ffd::BSplineField(glm::ivec3(d[0],d[1],d[2]), glm::dvec3(o[0],o[1],o[2]), glm::dvec3(s[0],s[1],s[2]), v.data(), spline->GetDisplacementScale(), (ffd::BorderMode)spline->GetBorderMode());
  Inverted = spline->GetInverseFlag();
  this->Changed.Modified();
  return true;
}
std::size_t vtkFFDDeformationSource::GetMemorySize() const { return 0; }
