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

//------------------------------------------------------------------------------
bool vtkFFDAreEditSizes(
  vtkObject* self, const char* name, const int member[3], const int sizes[3], bool zeroAllowed)
{
  if (!sizes)
  {
    vtkErrorWithObjectMacro(
      self, "Set" << name << ": the numbers of control points are null. Give three numbers.");
    return false;
  }
  const bool none = zeroAllowed && std::all_of(sizes, sizes + 3, [](int n) { return n == 0; });
  if (!none && !std::all_of(sizes, sizes + 3, [](int n) {
        return n >= vtkFFDSmallestEditSize && n <= vtkFFDLargestEditSize;
      }))
  {
    vtkErrorWithObjectMacro(self, << name << " is " << sizes[0] << ", " << sizes[1] << ", "
                                  << sizes[2] << "; each must be from " << vtkFFDSmallestEditSize
                                  << " to " << vtkFFDLargestEditSize << ". It stays " << member[0]
                                  << ", " << member[1] << ", " << member[2] << ".");
    return false;
  }
  return true;
}
