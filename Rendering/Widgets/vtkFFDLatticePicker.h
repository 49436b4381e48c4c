// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this library: not installed.
#ifndef vtkFFDLatticePicker_h
#define vtkFFDLatticePicker_h

#include "vtkAbstractPropPicker.h"

#include <functional> // for std::function

class vtkProp;

/**
 * Lets the representation take part in vtkPickingManager: a picker that asks the representation
 * which of its control points or handle parts is at a position of the window. That is a search in
 * screen space, exact for any number of glyphs, without their polygons.
 */
class vtkFFDLatticePicker : public vtkAbstractPropPicker
{
public:
  static vtkFFDLatticePicker* New();
  vtkTypeMacro(vtkFFDLatticePicker, vtkAbstractPropPicker);

  /// Finds the world position of a target at display coordinates x, y; false if there is none.
  using Search = std::function<bool(double x, double y, double world[3])>;

  /// The prop that a pick reports; not owned, it owns the picker.
  void SetOwner(vtkProp* owner, Search search);

  using vtkAbstractPropPicker::Pick;
  int Pick(double x, double y, double z, vtkRenderer* renderer) override;
  int Pick3DPoint(double point[3], vtkRenderer* renderer) override;

protected:
  vtkFFDLatticePicker() = default;
  ~vtkFFDLatticePicker() override = default;

private:
  vtkFFDLatticePicker(const vtkFFDLatticePicker&) = delete;
  void operator=(const vtkFFDLatticePicker&) = delete;

  vtkProp* Owner = nullptr;
  Search Find;
};

#endif
