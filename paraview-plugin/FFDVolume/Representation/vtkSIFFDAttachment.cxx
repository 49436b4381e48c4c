// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSIFFDAttachment.h"

#include "vtkFFDExportWarning.h"
#include "vtkFFDShownGeometry.h"

#include "vtkExporter.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkSIFFDAttachment);

//------------------------------------------------------------------------------
vtkSIFFDAttachment::vtkSIFFDAttachment() = default;

//------------------------------------------------------------------------------
vtkSIFFDAttachment::~vtkSIFFDAttachment() = default;

//------------------------------------------------------------------------------
void vtkSIFFDAttachment::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

//------------------------------------------------------------------------------
bool vtkSIFFDAttachment::ReadXMLAttributes(vtkSIProxy* proxy, vtkPVXMLElement* element)
{
  if (!this->Superclass::ReadXMLAttributes(proxy, element))
  {
    return false;
  }
  vtkObjectBase* object = this->GetVTKObject();
  if (auto* exporter = vtkExporter::SafeDownCast(object))
  {
    ffdexport::Watch(exporter);
  }
  else
  {
    vtkFFDShownGeometry::Follow(object);
  }
  return true;
}
