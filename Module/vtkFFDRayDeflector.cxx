// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDRayDeflector.h"

#include "vtkFFDWarpKernel.h"

#include "FFDRayDeflector.h"

#include "vtkMath.h"
#include "vtkObjectFactory.h"

#include <algorithm>
#include <cmath>

vtkStandardNewMacro(vtkFFDRayDeflector);

class vtkFFDRayDeflector::Internals : public vtkFFDWarpKernelOf<ffd::RayDeflector>
{
};

//------------------------------------------------------------------------------
vtkFFDRayDeflector::vtkFFDRayDeflector()
  : Map(new Internals)
{
}

//------------------------------------------------------------------------------
vtkFFDRayDeflector::~vtkFFDRayDeflector() = default;

//------------------------------------------------------------------------------
void vtkFFDRayDeflector::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "DeflectorType: " << this->GetDeflectorTypeAsString() << "\n";
  os << indent << "Center: (" << this->Center[0] << ", " << this->Center[1] << ", "
     << this->Center[2] << ")\n";
  os << indent << "Radius: " << this->Radius << "\n";
  os << indent << "Vector: (" << this->Vector[0] << ", " << this->Vector[1] << ", "
     << this->Vector[2] << ")\n";
  os << indent << "Angle: " << this->Angle << "\n";
  os << indent << "Factor: " << this->Factor << "\n";
}

//------------------------------------------------------------------------------
const char* vtkFFDRayDeflector::GetDeflectorTypeAsString()
{
  static const char* const names[] = { "TRANSLATE", "ROTATE", "SCALE" };
  return names[this->DeflectorType];
}

//------------------------------------------------------------------------------
bool vtkFFDRayDeflector::SetTriple(const char* name, double member[3], const double values[3])
{
  if (!values || !std::isfinite(values[0]) || !std::isfinite(values[1]) ||
    !std::isfinite(values[2]))
  {
    vtkErrorMacro(<< "Set" << name << ": null, or not finite. Give three finite numbers.");
    return false;
  }
  if (!std::equal(values, values + 3, member))
  {
    std::copy(values, values + 3, member);
    this->Modified();
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkFFDRayDeflector::SetCenter(double x, double y, double z)
{
  const double center[3] = { x, y, z };
  this->SetTriple("Center", this->Center, center);
}

//------------------------------------------------------------------------------
void vtkFFDRayDeflector::SetCenter(const double center[3])
{
  this->SetTriple("Center", this->Center, center);
}

//------------------------------------------------------------------------------
void vtkFFDRayDeflector::SetVector(double x, double y, double z)
{
  const double vector[3] = { x, y, z };
  this->SetTriple("Vector", this->Vector, vector);
}

//------------------------------------------------------------------------------
void vtkFFDRayDeflector::SetVector(const double vector[3])
{
  this->SetTriple("Vector", this->Vector, vector);
}

//------------------------------------------------------------------------------
void vtkFFDRayDeflector::SetRadius(double radius)
{
  if (!(radius > 0.0) || !std::isfinite(radius))
  {
    vtkErrorMacro("SetRadius: the radius is " << radius << ". Give a positive number.");
    return;
  }
  if (this->Radius != radius)
  {
    this->Radius = radius;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDRayDeflector::SetAngle(double degrees)
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
void vtkFFDRayDeflector::SetFactor(double factor)
{
  if (!(factor > 0.0) || !std::isfinite(factor))
  {
    vtkErrorMacro("SetFactor: the factor is " << factor << ". Give a positive number.");
    return;
  }
  if (this->Factor != factor)
  {
    this->Factor = factor;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
bool vtkFFDRayDeflector::IsFoldFree()
{
  this->Update();
  return this->Map->IsFoldFree();
}

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDRayDeflector::MakeTransform() { return vtkFFDRayDeflector::New(); }

//------------------------------------------------------------------------------
void vtkFFDRayDeflector::InternalUpdate()
{
  Internals& map = *this->Map;
  map.Kind = static_cast<ffd::RayDeflector::Shape>(this->DeflectorType);
  map.Center = glm::dvec3(this->Center[0], this->Center[1], this->Center[2]);
  map.Radius = this->Radius;
  map.Vector = glm::dvec3(this->Vector[0], this->Vector[1], this->Vector[2]);
  map.Angle = vtkMath::RadiansFromDegrees(this->Angle);
  map.Factor = this->Factor;
  if (this->DeflectorType == ROTATE && vtkMath::Norm(this->Vector) == 0.0)
  {
    // No axis: no rotation, about any.
    map.Vector = glm::dvec3(0.0, 0.0, 1.0);
    map.Angle = 0.0;
  }
}

//------------------------------------------------------------------------------
void vtkFFDRayDeflector::InternalDeepCopy(vtkAbstractTransform* transform)
{
  this->Superclass::InternalDeepCopy(transform);
  vtkFFDRayDeflector* other = static_cast<vtkFFDRayDeflector*>(transform);
  this->DeflectorType = other->DeflectorType;
  std::copy(other->Center, other->Center + 3, this->Center);
  this->Radius = other->Radius;
  std::copy(other->Vector, other->Vector + 3, this->Vector);
  this->Angle = other->Angle;
  this->Factor = other->Factor;
}

//------------------------------------------------------------------------------
const vtkFFDWarpKernel& vtkFFDRayDeflector::GetKernel() const { return *this->Map; }
