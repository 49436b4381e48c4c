// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDBarrTransform.h"

#include "vtkFFDWarpKernel.h"

#include "FFDBarrDeformation.h"

#include "vtkMath.h"
#include "vtkObjectFactory.h"

#include <algorithm>
#include <cmath>

vtkStandardNewMacro(vtkFFDBarrTransform);

class vtkFFDBarrTransform::Internals : public vtkFFDWarpKernelOf<ffd::BarrDeformation>
{
};

//------------------------------------------------------------------------------
vtkFFDBarrTransform::vtkFFDBarrTransform()
  : Map(new Internals)
{
}

//------------------------------------------------------------------------------
vtkFFDBarrTransform::~vtkFFDBarrTransform() = default;

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "DeformationType: " << this->GetDeformationTypeAsString() << "\n";
  os << indent << "Axis: " << this->Axis << "\n";
  os << indent << "BendAxis: " << this->BendAxis << "\n";
  os << indent << "Center: (" << this->Center[0] << ", " << this->Center[1] << ", "
     << this->Center[2] << ")\n";
  os << indent << "Range: (" << this->Range[0] << ", " << this->Range[1] << ")\n";
  os << indent << "Angle: " << this->Angle << "\n";
  os << indent << "Scale: (" << this->Scale[0] << ", " << this->Scale[1] << ")\n";
  os << indent << "SmoothProfile: " << this->SmoothProfile << "\n";
}

//------------------------------------------------------------------------------
const char* vtkFFDBarrTransform::GetDeformationTypeAsString()
{
  static const char* const names[] = { "TAPER", "TWIST", "BEND" };
  return names[this->DeformationType];
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::SetAxis(int axis)
{
  if (axis < 0 || axis > 2)
  {
    vtkErrorMacro("SetAxis: there is no axis " << axis << ". Give 0, 1 or 2.");
    return;
  }
  if (this->Axis != axis)
  {
    this->Axis = axis;
    this->BendAxis = this->BendAxis == axis ? (axis + 1) % 3 : this->BendAxis;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::SetBendAxis(int axis)
{
  if (axis < 0 || axis > 2 || axis == this->Axis)
  {
    vtkErrorMacro("SetBendAxis: axis " << axis << " is not possible. Give 0, 1 or 2, and not Axis, "
                                       << this->Axis << ".");
    return;
  }
  if (this->BendAxis != axis)
  {
    this->BendAxis = axis;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::SetCenter(const double center[3])
{
  if (!center)
  {
    vtkErrorMacro("SetCenter: the center is null. Give three numbers.");
    return;
  }
  this->SetCenter(center[0], center[1], center[2]);
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::SetCenter(double x, double y, double z)
{
  const double center[3] = { x, y, z };
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
  {
    vtkErrorMacro("SetCenter: (" << x << ", " << y << ", " << z
                                 << ") is no position. Give three finite numbers.");
    return;
  }
  if (!std::equal(center, center + 3, this->Center))
  {
    std::copy(center, center + 3, this->Center);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::SetRange(const double range[2])
{
  if (!range)
  {
    vtkErrorMacro("SetRange: the range is null. Give two numbers.");
    return;
  }
  this->SetRange(range[0], range[1]);
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::SetRange(double first, double last)
{
  if (!std::isfinite(first) || !std::isfinite(last) || !(first < last))
  {
    vtkErrorMacro("SetRange: from " << first << " to " << last
                                    << " is no range. Give two finite numbers, first < last.");
    return;
  }
  if (this->Range[0] != first || this->Range[1] != last)
  {
    this->Range[0] = first;
    this->Range[1] = last;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::SetAngle(double degrees)
{
  if (!std::isfinite(degrees))
  {
    vtkErrorMacro("SetAngle: the angle is " << degrees << ". Give a finite number of degrees.");
    return;
  }
  if (this->Angle != degrees)
  {
    this->Angle = degrees;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::SetScale(const double scale[2])
{
  if (!scale)
  {
    vtkErrorMacro("SetScale: the scale is null. Give two numbers.");
    return;
  }
  this->SetScale(scale[0], scale[1]);
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::SetScale(double first, double last)
{
  if (!(first > 0.0) || !(last > 0.0) || !std::isfinite(first) || !std::isfinite(last))
  {
    vtkErrorMacro(
      "SetScale: " << first << " and " << last << " are no scales. Give two positive numbers.");
    return;
  }
  if (this->Scale[0] != first || this->Scale[1] != last)
  {
    this->Scale[0] = first;
    this->Scale[1] = last;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::FitToBounds(const double bounds[6])
{
  if (!bounds || !(bounds[0] <= bounds[1]) || !(bounds[2] <= bounds[3]) ||
    !(bounds[4] <= bounds[5]) || !(bounds[2 * this->Axis] < bounds[2 * this->Axis + 1]))
  {
    vtkErrorMacro("FitToBounds: the bounds are null, inverted or flat along axis "
      << this->Axis << ". Give those of what is deformed.");
    return;
  }
  this->SetCenter(
    0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]), 0.5 * (bounds[4] + bounds[5]));
  this->SetRange(bounds[2 * this->Axis], bounds[2 * this->Axis + 1]);
}

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDBarrTransform::MakeTransform() { return vtkFFDBarrTransform::New(); }

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::InternalUpdate()
{
  Internals& map = *this->Map;
  map.Kind = static_cast<ffd::BarrDeformation::Shape>(this->DeformationType);
  map.U = this->Axis;
  map.V = this->BendAxis;
  map.Center = glm::dvec3(this->Center[0], this->Center[1], this->Center[2]);
  map.Low = this->Range[0];
  map.High = this->Range[1];
  double degrees = this->Angle;
  if (this->DeformationType == BEND && std::abs(degrees) > 360.0)
  {
    vtkWarningMacro("BEND by " << degrees << " degrees would wind up; 360 are used.");
    degrees = std::copysign(360.0, degrees);
  }
  map.Angle = vtkMath::RadiansFromDegrees(degrees);
  std::copy(this->Scale, this->Scale + 2, map.Scale);
  map.Smooth = this->SmoothProfile != 0;
}

//------------------------------------------------------------------------------
void vtkFFDBarrTransform::InternalDeepCopy(vtkAbstractTransform* transform)
{
  this->Superclass::InternalDeepCopy(transform);
  vtkFFDBarrTransform* other = static_cast<vtkFFDBarrTransform*>(transform);
  this->DeformationType = other->DeformationType;
  this->Axis = other->Axis;
  this->BendAxis = other->BendAxis;
  std::copy(other->Center, other->Center + 3, this->Center);
  std::copy(other->Range, other->Range + 2, this->Range);
  this->Angle = other->Angle;
  std::copy(other->Scale, other->Scale + 2, this->Scale);
  this->SmoothProfile = other->SmoothProfile;
}

//------------------------------------------------------------------------------
const vtkFFDWarpKernel& vtkFFDBarrTransform::GetKernel() const { return *this->Map; }
