// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file pqFFDPropertyValues.h
 * Values of properties of integers and reals alike, as doubles. Checked values are those that the
 * proxy has; unchecked ones are what the panel shows, and Apply accepts.
 */
#ifndef pqFFDPropertyValues_h
#define pqFFDPropertyValues_h

#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMUncheckedPropertyHelper.h"

#include <vector>

namespace ffdpanel
{

/// Values of a property of integers or reals.
template <class Helper>
std::vector<double> GetValues(vtkSMProperty* property)
{
  Helper helper(property);
  if (property->IsA("vtkSMIntVectorProperty"))
  {
    const std::vector<int> integers = helper.GetIntArray();
    return { integers.begin(), integers.end() };
  }
  return helper.GetDoubleArray();
}

template <class Helper>
void SetValues(vtkSMProperty* property, const std::vector<double>& values)
{
  Helper helper(property);
  const auto count = static_cast<unsigned int>(values.size());
  if (count == 0)
  {
    helper.SetNumberOfElements(0);
    return;
  }
  if (property->IsA("vtkSMIntVectorProperty"))
  {
    std::vector<int> integers;
    for (const double value : values)
    {
      integers.push_back(static_cast<int>(value));
    }
    helper.Set(integers.data(), count);
    return;
  }
  helper.Set(values.data(), count);
}

inline std::vector<double> GetUnchecked(vtkSMProperty* property)
{
  return GetValues<vtkSMUncheckedPropertyHelper>(property);
}

inline std::vector<double> GetChecked(vtkSMProperty* property)
{
  return GetValues<vtkSMPropertyHelper>(property);
}

inline void SetUnchecked(vtkSMProperty* property, const std::vector<double>& values)
{
  SetValues<vtkSMUncheckedPropertyHelper>(property, values);
}

inline void SetChecked(vtkSMProperty* property, const std::vector<double>& values)
{
  SetValues<vtkSMPropertyHelper>(property, values);
}

} // namespace ffdpanel

#endif
