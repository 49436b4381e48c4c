// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDOptions.h"

#include "vtkObject.h"

#include <algorithm>
#include <cmath>

namespace
{

void ChangeNumbers(vtkObject* self, double* member, const double* values, int count)
{
  if (!std::equal(values, values + count, member))
  {
    std::copy_n(values, count, member);
    self->Modified();
  }
}

} // namespace

//------------------------------------------------------------------------------
bool vtkFFDSetPositive(vtkObject* self, const char* name, double& member, double value)
{
  if (!(value > 0.0) || !std::isfinite(value))
  {
    vtkErrorWithObjectMacro(self, << name << " must be a positive number, not " << value
                                  << "; it stays " << member << ".");
    return false;
  }
  ChangeNumbers(self, &member, &value, 1);
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDSetTolerance(vtkObject* self, const char* name, double& member, double tolerance)
{
  if (!(tolerance > 0.0) || !std::isfinite(tolerance))
  {
    vtkErrorWithObjectMacro(
      self, << name << ": the tolerance is " << tolerance << ". Give a positive distance.");
    return false;
  }
  ChangeNumbers(self, &member, &tolerance, 1);
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDSetBounds(vtkObject* self, const char* name, double member[6], const double bounds[6])
{
  if (!bounds)
  {
    vtkErrorWithObjectMacro(self, << name << ": the bounds are null. Give six numbers.");
    return false;
  }
  const double* const bad =
    std::find_if(bounds, bounds + 6, [](double b) { return !std::isfinite(b); });
  if (bad != bounds + 6)
  {
    vtkErrorWithObjectMacro(self, << name << ": a bound is " << *bad << ". Give finite numbers.");
    return false;
  }
  ChangeNumbers(self, member, bounds, 6);
  return true;
}
