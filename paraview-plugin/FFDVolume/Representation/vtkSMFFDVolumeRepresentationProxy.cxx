// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSMFFDVolumeRepresentationProxy.h"

#include "vtkFFDVolumeRepresentation.h"

#include "vtkClientServerStream.h"
#include "vtkCommand.h"
#include "vtkCompositeRepresentation.h"
#include "vtkDataObject.h"
#include "vtkObjectFactory.h"
#include "vtkPVSession.h"
#include "vtkSMArrayListDomain.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMPVRepresentationProxy.h"

#include <cstring>

vtkStandardNewMacro(vtkSMFFDVolumeRepresentationProxy);

//------------------------------------------------------------------------------
vtkSMFFDVolumeRepresentationProxy::vtkSMFFDVolumeRepresentationProxy() = default;

//------------------------------------------------------------------------------
vtkSMFFDVolumeRepresentationProxy::~vtkSMFFDVolumeRepresentationProxy() = default;

//------------------------------------------------------------------------------
void vtkSMFFDVolumeRepresentationProxy::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

//------------------------------------------------------------------------------
void vtkSMFFDVolumeRepresentationProxy::CreateVTKObjects()
{
  this->Superclass::CreateVTKObjects();
  vtkSMProxy* parent = this->GetParentProxy();
  vtkSMProperty* type = parent ? parent->GetProperty("Representation") : nullptr;
  if (type && !this->Watching)
  {
    this->Watching = true;
    type->AddObserver(
      vtkCommand::ModifiedEvent, this, &vtkSMFFDVolumeRepresentationProxy::PickArray);
  }
}

//------------------------------------------------------------------------------
bool vtkSMFFDVolumeRepresentationProxy::RenderNextAtRate(double rate)
{
  auto* own = vtkFFDVolumeRepresentation::SafeDownCast(this->GetClientSideObject());
  vtkSMProxy* parent = this->GetParentProxy();
  auto* all =
    parent ? vtkCompositeRepresentation::SafeDownCast(parent->GetClientSideObject()) : nullptr;
  if (!own || !all || all->GetActiveRepresentation() != own || !all->GetVisibility() ||
    !own->GetAdaptInteractiveQuality())
  {
    return false;
  }
  vtkClientServerStream stream;
  stream << vtkClientServerStream::Invoke << VTKOBJECT(this) << "RenderNextAtRate" << rate
         << vtkClientServerStream::End;
  this->ExecuteStream(stream, false, vtkPVSession::RENDER_SERVER);
  return true;
}

//------------------------------------------------------------------------------
void vtkSMFFDVolumeRepresentationProxy::PickArray()
{
  auto* parent = vtkSMPVRepresentationProxy::SafeDownCast(this->GetParentProxy());
  if (!parent || this->Picking || parent->GetUsingScalarColoring())
  {
    return;
  }
  const char* type = vtkSMPropertyHelper(parent, "Representation").GetAsString();
  vtkSMProperty* array = parent->GetProperty("ColorArrayName");
  if (!type || std::strcmp(type, "FFD Volume") != 0 || !array)
  {
    return;
  }
  auto arrays = array->FindDomain<vtkSMArrayListDomain>();
  if (!arrays || arrays->GetNumberOfStrings() == 0)
  {
    return;
  }
  // Not field data: the lattice is there.
  constexpr unsigned int none = VTK_UNSIGNED_INT_MAX;
  unsigned int chosen = none;
  for (unsigned int i = 0; i < arrays->GetNumberOfStrings(); ++i)
  {
    const int association = arrays->GetFieldAssociation(i);
    if (association == vtkDataObject::POINT)
    {
      chosen = i;
      break;
    }
    if (association == vtkDataObject::CELL && chosen == none)
    {
      chosen = i;
    }
  }
  if (chosen == none)
  {
    return;
  }
  this->Picking = true;
  if (parent->SetScalarColoring(arrays->GetString(chosen), arrays->GetFieldAssociation(chosen)))
  {
    parent->RescaleTransferFunctionToDataRange(true);
  }
  this->Picking = false;
}
