// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkFFDLattice_h
#define vtkFFDLattice_h

#include "vtkBSplineTransform.h"
#include "vtkFFDCoreModule.h" // For export macro

class VTKFFDCORE_EXPORT vtkFFDLattice : public vtkBSplineTransform
{
public:
  static vtkFFDLattice* New();
  vtkTypeMacro(vtkFFDLattice, vtkBSplineTransform);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkFFDLattice();
  ~vtkFFDLattice() override;

private:
  vtkFFDLattice(const vtkFFDLattice&) = delete;
  void operator=(const vtkFFDLattice&) = delete;
};

#endif
