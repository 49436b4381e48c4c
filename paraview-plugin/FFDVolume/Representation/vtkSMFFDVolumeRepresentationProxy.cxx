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

#include <array>
#include <cstring>

vtkStandardNewMacro(vtkSMFFDVolumeRepresentationProxy);

namespace
{

/// What FFD Volume and ParaView's own Volume both have, by their names there.
const std::array<std::array<const char*, 2>, 5> SharedOptions{ { { { "FFDShade", "Shade" } },
  { { "FFDBlendMode", "BlendMode" } },
  { { "FFDScalarOpacityUnitDistance", "ScalarOpacityUnitDistance" } },
  { { "FFDIsosurfaceValues", "IsosurfaceValues" } }, { { "FFDUseCropping", "UseCropping" } } } };

bool IsShown(vtkSMProxy* parent)
{
  const char* type = vtkSMPropertyHelper(parent, "Representation", true).GetAsString();
  return type && std::strcmp(type, "FFD Volume") == 0;
}

} // namespace

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
    for (const auto& names : SharedOptions)
    {
      for (const char* name : names)
      {
        if (vtkSMProperty* option = parent->GetProperty(name))
        {
          option->AddObserver(
            vtkCommand::ModifiedEvent, this, &vtkSMFFDVolumeRepresentationProxy::Mirror);
        }
      }
    }
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
  vtkSMProperty* array = parent->GetProperty("ColorArrayName");
  if (!IsShown(parent) || !array)
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

//------------------------------------------------------------------------------
/**
 * Hand an option of the representation that is shown to the other one. Not when the representation
 * is changed: states restore it between these options.
 */
void vtkSMFFDVolumeRepresentationProxy::Mirror(vtkObject* option, unsigned long, void*)
{
  vtkSMProxy* parent = this->GetParentProxy();
  if (!parent || this->Mirroring)
  {
    return;
  }
  const std::size_t shown = IsShown(parent) ? 0 : 1;
  for (const auto& names : SharedOptions)
  {
    vtkSMProperty* from = parent->GetProperty(names[shown]);
    vtkSMProperty* to = parent->GetProperty(names[1 - shown]);
    if (from == option && to)
    {
      this->Mirroring = true;
      to->Copy(from);
      parent->UpdateProperty(names[1 - shown]);
      this->Mirroring = false;
    }
  }
}
