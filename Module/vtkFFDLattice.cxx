// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLattice.h"

#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkFFDLattice);

//------------------------------------------------------------------------------
vtkFFDLattice::vtkFFDLattice() = default;

//------------------------------------------------------------------------------
vtkFFDLattice::~vtkFFDLattice() = default;

//------------------------------------------------------------------------------
void vtkFFDLattice::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
