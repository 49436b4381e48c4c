// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDInverseRayVolumeMapper.h"

#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkFFDInverseRayVolumeMapper);

//------------------------------------------------------------------------------
vtkFFDInverseRayVolumeMapper::vtkFFDInverseRayVolumeMapper() = default;

//------------------------------------------------------------------------------
vtkFFDInverseRayVolumeMapper::~vtkFFDInverseRayVolumeMapper() = default;

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::Render(vtkRenderer*, vtkVolume*) {}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
