// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSIFFDTuples
 * @brief   hands the values of a property to an object as one array
 *
 * A property of ParaView with as many tuples as it is given makes one remote call for each of them.
 * One of this class makes one call for all: its command takes a vtkDataArray, with
 * number_of_elements_per_command components. In the definition it is a DoubleVectorProperty with
 * si_class="vtkSIFFDTuples" and repeat_command="1".
 */
#ifndef vtkSIFFDTuples_h
#define vtkSIFFDTuples_h

#include "vtkFFDParaViewModule.h" // For export macro
#include "vtkSIDoubleVectorProperty.h"

class VTKFFDPARAVIEW_EXPORT vtkSIFFDTuples : public vtkSIDoubleVectorProperty
{
public:
  static vtkSIFFDTuples* New();
  vtkTypeMacro(vtkSIFFDTuples, vtkSIDoubleVectorProperty);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkSIFFDTuples();
  ~vtkSIFFDTuples() override;

  bool Push(vtkSMMessage* message, int offset) override;

private:
  vtkSIFFDTuples(const vtkSIFFDTuples&) = delete;
  void operator=(const vtkSIFFDTuples&) = delete;
};

#endif
