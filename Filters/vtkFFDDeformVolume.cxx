// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDeformVolume.h"

#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkFFDDeformVolume);

//------------------------------------------------------------------------------
vtkFFDDeformVolume::vtkFFDDeformVolume() = default;

//------------------------------------------------------------------------------
vtkFFDDeformVolume::~vtkFFDDeformVolume() = default;

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
