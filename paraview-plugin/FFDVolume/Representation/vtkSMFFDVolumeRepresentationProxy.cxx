// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSMFFDVolumeRepresentationProxy.h"

#include "vtkFFDShownLattice.h"
#include "vtkFFDVolumeRepresentation.h"

#include "vtkClientServerStream.h"
#include "vtkCollection.h"
#include "vtkCommand.h"
#include "vtkCompositeRepresentation.h"
#include "vtkDataObject.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkPVDataSetAttributesInformation.h"
#include "vtkPVPluginsInformation.h"
#include "vtkPVSession.h"
#include "vtkPVXMLElement.h"
#include "vtkRenderer.h"
#include "vtkSMArrayListDomain.h"
#include "vtkSmartPointer.h"
#include "vtkSMInputProperty.h"
#include "vtkSMPluginManager.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMPropertyIterator.h"
#include "vtkSMProxyDefinitionManager.h"
#include "vtkSMProxyIterator.h"
#include "vtkSMProxyManager.h"
#include "vtkSMPVRepresentationProxy.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSMSession.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMSourceProxy.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>

vtkStandardNewMacro(vtkSMFFDVolumeRepresentationProxy);

namespace
{

using Names = std::array<const char*, 2>;

/// Properties that FFD Volume and ParaView's own Volume both have, by their names there.
const std::array<Names, 7> SharedOptions{ { { { "FFDShade", "Shade" } },
  { { "FFDBlendMode", "BlendMode" } },
  { { "FFDScalarOpacityUnitDistance", "ScalarOpacityUnitDistance" } },
  { { "FFDIsosurfaceValues", "IsosurfaceValues" } }, { { "FFDUseCropping", "UseCropping" } },
  { { "FFDCroppingOrigin", "CroppingOrigin" } }, { { "FFDCroppingScale", "CroppingScale" } } } };

/// Those that ParaView's color map editor changes, by the second name, whatever is shown.
const std::array<Names, 8> EditorOptions{
  { { { "FFDMultiComponentsMapping", "MultiComponentsMapping" } },
    { { "FFDUseSeparateOpacityArray", "UseSeparateOpacityArray" } },
    { { "FFDOpacityArrayName", "OpacityArrayName" } },
    { { "FFDOpacityComponent", "OpacityComponent" } }, { { "FFDUseTransfer2D", "UseTransfer2D" } },
    { { "FFDUseGradientForTransfer2D", "UseGradientForTransfer2D" } },
    { { "FFDColorArray2Name", "ColorArray2Name" } },
    { { "FFDColorArray2Component", "ColorArray2Component" } } }
};

std::string GetType(vtkSMProxy* parent)
{
  const char* type = vtkSMPropertyHelper(parent, "Representation", true).GetAsString();
  return type ? type : "";
}

bool WarnsOfRest = true;

bool IsShown(vtkSMProxy* parent) { return GetType(parent) == "FFD Volume"; }

vtkPVDataInformation* GetShownInformation(vtkSMProxy* parent)
{
  vtkSMPropertyHelper input(parent, "Input", true);
  auto* source =
    input.GetNumberOfElements() > 0 ? vtkSMSourceProxy::SafeDownCast(input.GetAsProxy()) : nullptr;
  return source ? source->GetDataInformation(input.GetOutputPort()) : nullptr;
}

bool HasLattice(vtkPVDataInformation* data)
{
  return data && data->GetFieldDataInformation() &&
    data->GetFieldDataInformation()->GetArrayInformation("FFDLattice.Displacement");
}

/// Whether the data that are shown have a lattice.
bool HasLattice(vtkSMProxy* parent) { return HasLattice(GetShownInformation(parent)); }

/// Whether they are images with a lattice: "Volume" moves points of others.
bool HasImageLattice(vtkSMProxy* parent)
{
  return HasLattice(parent) && !GetShownInformation(parent)->DataSetTypeIsA("vtkPointSet");
}

/// Whether the data tell where their points are at rest: those of FFD Deform Geometry.
bool HasRestPositions(vtkSMProxy* parent)
{
  vtkPVDataInformation* data = GetShownInformation(parent);
  vtkPVArrayInformation* rest =
    data ? data->GetPointDataInformation()->GetArrayInformation("RestPosition") : nullptr;
  return rest && rest->GetNumberOfComponents() == 3;
}

/// Whether a representation is visible and shows surfaces, moved by a lattice.
bool ShowsMovedSurface(vtkSMProxy* parent)
{
  vtkSMProperty* visibility = parent ? parent->GetProperty("Visibility") : nullptr;
  return visibility && parent->GetProperty("Representation") &&
    vtkSMPropertyHelper(visibility).GetAsInt() != 0 && !IsShown(parent) &&
    !vtkFFDShownLattice::IsAtRest(GetType(parent)) &&
    (HasLattice(parent) || HasRestPositions(parent));
}

/// What is told of data that lost their lattice, where others have the type of the representation.
constexpr const char* Dropped = "lattice dropped";

/// Whether a source is, or is made of, what the filters for volumes put out with a lattice. These
/// are found by names: information of all sources would be gathered anew for each step in time.
bool IsOfLattice(vtkSMProxy* source)
{
  const std::string name = source && source->GetXMLName() ? source->GetXMLName() : "";
  if (name == "FFDLattice" || name == "FFDApplyTransform")
  {
    // One that has no lattice to attach has said why.
    auto* filter = vtkSMSourceProxy::SafeDownCast(source);
    return filter && HasLattice(filter->GetDataInformation(0));
  }
  // Our other filters make what is in place, and probes are where they are put.
  if (!source || name.compare(0, 3, "FFD") == 0 || name == "ProbePoint" || name == "ProbeLine")
  {
    return false;
  }
  vtkSmartPointer<vtkSMPropertyIterator> each;
  each.TakeReference(source->NewPropertyIterator());
  for (each->Begin(); !each->IsAtEnd(); each->Next())
  {
    auto* input = vtkSMInputProperty::SafeDownCast(each->GetProperty());
    for (unsigned int i = 0; input && i < input->GetNumberOfProxies(); ++i)
    {
      if (IsOfLattice(input->GetProxy(i)))
      {
        return true;
      }
    }
  }
  return false;
}

/// Whether a representation shows data without a lattice that are made of data with one. Empty data
/// have nothing to deform, and no lattice.
bool ShowsDropped(vtkSMProxy* parent)
{
  vtkPVDataInformation* data = GetType(parent).empty() ? nullptr : GetShownInformation(parent);
  return data && data->GetNumberOfPoints() > 0 && !HasLattice(parent) &&
    IsOfLattice(vtkSMPropertyHelper(parent, "Input").GetAsProxy());
}

/// Version of a plugin that is loaded, "" if it is not.
std::string FindVersion(vtkPVPluginsInformation* plugins, const std::string& name)
{
  for (unsigned int i = 0; plugins && i < plugins->GetNumberOfPlugins(); ++i)
  {
    const char* each = plugins->GetPluginName(i);
    const char* version = plugins->GetPluginVersion(i);
    if (each && version && name == each && plugins->GetPluginLoaded(i))
    {
      return version;
    }
  }
  return "";
}

/// Whether a proxy is a representation that FFDAttachments.xml adds to, and was made before that
/// was loaded.
bool LacksAttachment(vtkSMProxy* proxy)
{
  constexpr const char* attachment = "FFDAttachment";
  vtkSMSessionProxyManager* manager = proxy->GetSessionProxyManager();
  if (!manager || !proxy->GetXMLName() || proxy->GetProperty(attachment) ||
    !vtkSMRepresentationProxy::SafeDownCast(proxy))
  {
    return false;
  }
  vtkPVXMLElement* definition = manager->GetProxyDefinitionManager()->GetCollapsedProxyDefinition(
    proxy->GetXMLGroup(), proxy->GetXMLName(), nullptr, false);
  for (unsigned int i = 0; definition && i < definition->GetNumberOfNestedElements(); ++i)
  {
    const char* name = definition->GetNestedElement(i)->GetAttribute("name");
    if (name && std::string(name) == attachment)
    {
      return true;
    }
  }
  return false;
}

/// Members of ParaView's proxies that are for their subclasses.
struct ProxyAccess : vtkSMProxy
{
  /// The proxies of this kind among a proxy and its parts.
  static void AddOlder(vtkSMProxy* proxy, std::set<vtkSMProxy*>& older)
  {
    if (LacksAttachment(proxy))
    {
      older.insert(proxy);
    }
    vtkSMProxy* (vtkSMProxy::*getPart)(unsigned int) = &ProxyAccess::GetSubProxy;
    const unsigned int count = (proxy->*(&ProxyAccess::GetNumberOfSubProxies))();
    for (unsigned int i = 0; i < count; ++i)
    {
      AddOlder((proxy->*getPart)(i), older);
    }
  }
};

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
  CheckServer(this->GetSession());
  this->FollowOlder();
  vtkSMProxy* parent = this->GetParentProxy();
  vtkSMProperty* type = parent ? parent->GetProperty("Representation") : nullptr;
  if (type && !this->Watching)
  {
    this->Watching = true;
    type->AddObserver(
      vtkCommand::ModifiedEvent, this, &vtkSMFFDVolumeRepresentationProxy::PickArray);
    parent->AddObserver(
      vtkCommand::UpdateDataEvent, this, &vtkSMFFDVolumeRepresentationProxy::WarnOfRest);
    const auto watch = [this, parent](const Names& names) {
      for (const char* name : names)
      {
        if (vtkSMProperty* option = parent->GetProperty(name))
        {
          option->AddObserver(
            vtkCommand::ModifiedEvent, this, &vtkSMFFDVolumeRepresentationProxy::Mirror);
        }
      }
    };
    std::for_each(SharedOptions.begin(), SharedOptions.end(), watch);
    std::for_each(EditorOptions.begin(), EditorOptions.end(), watch);
    for (const Names& names : EditorOptions)
    {
      if (vtkSMProperty* option = parent->GetProperty(names[0]))
      {
        option->SetAnimateable(0);
      }
    }
  }
}

//------------------------------------------------------------------------------
/// Let what was there before the plugin was loaded, such as a slice whose input gets a lattice now,
/// follow lattices as what comes after it.
void vtkSMFFDVolumeRepresentationProxy::FollowOlder()
{
  static vtkWeakPointer<vtkSMSession> lastSession;
  if (lastSession == this->GetSession())
  {
    return;
  }
  lastSession = this->GetSession();
  std::set<vtkSMProxy*> older;
  vtkNew<vtkSMProxyIterator> each;
  each->SetSession(this->GetSession());
  for (each->Begin(); !each->IsAtEnd(); each->Next())
  {
    ProxyAccess::AddOlder(each->GetProxy(), older);
  }
  for (vtkSMProxy* proxy : older)
  {
    vtkClientServerStream stream;
    stream << vtkClientServerStream::Invoke << VTKOBJECT(this) << "FollowOlder" << VTKOBJECT(proxy)
           << vtkClientServerStream::End;
    this->ExecuteStream(stream, false, proxy->GetLocation());
  }
}

//------------------------------------------------------------------------------
void vtkSMFFDVolumeRepresentationProxy::CheckServer(vtkSMSession* session)
{
  static vtkWeakPointer<vtkSMSession> lastTold;
  vtkSMProxyManager* manager = vtkSMProxyManager::GetProxyManager();
  vtkSMPluginManager* plugins = manager ? manager->GetPluginManager() : nullptr;
  if (!session || !plugins || lastTold == session)
  {
    return;
  }
  const std::string own = FindVersion(plugins->GetLocalInformation(), "FFDVolume");
  const std::string servers = FindVersion(plugins->GetRemoteInformation(session), "FFDVolume");
  if (own.empty() || own == servers || !session->IsA("vtkSMSessionClient"))
  {
    return;
  }
  lastTold = session;
  // With an object, or ParaView's list of messages leaves out what is before a colon.
  if (servers.empty())
  {
    vtkWarningWithObjectMacro(session, << "The server has no plugin FFDVolume, and so neither "
                                          "\"FFD Volume\" nor the filters of FFD. Start the server "
                                          "with it (Examples/paraview.sh pvserver), or load "
                                          "FFDVolume.so there by Tools > Manage Plugins, below "
                                          "Remote Plugins by Load New.");
  }
  else
  {
    vtkWarningWithObjectMacro(session, << "The plugin FFDVolume is of version " << own
                                       << " here and of version " << servers
                                       << " on the server. Start both with the same version, or "
                                          "options may have no effect, and states may not load.");
  }
}

//------------------------------------------------------------------------------
bool vtkSMFFDVolumeRepresentationProxy::RenderNextAtRate(double rate)
{
  auto* own = vtkFFDVolumeRepresentation::SafeDownCast(this->GetClientSideObject());
  if (!this->IsVisible() || !own->GetAdaptInteractiveQuality())
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
/// Whether the representation that this is a part of is visible, and shows this.
bool vtkSMFFDVolumeRepresentationProxy::IsVisible()
{
  auto* own = vtkFFDVolumeRepresentation::SafeDownCast(this->GetClientSideObject());
  vtkSMProxy* parent = this->GetParentProxy();
  auto* all =
    parent ? vtkCompositeRepresentation::SafeDownCast(parent->GetClientSideObject()) : nullptr;
  return own && all && all->GetActiveRepresentation() == own && all->GetVisibility();
}

//------------------------------------------------------------------------------
bool vtkSMFFDVolumeRepresentationProxy::Pick(
  const double from[3], const double to[3], double shown[3], double rest[3], double& value)
{
  if (!this->IsVisible())
  {
    return false;
  }
  vtkClientServerStream stream;
  stream << vtkClientServerStream::Invoke << VTKOBJECT(this) << "Pick" << from[0] << from[1]
         << from[2] << to[0] << to[1] << to[2] << vtkClientServerStream::End;
  this->ExecuteStream(stream, false, vtkPVSession::RENDER_SERVER);
  stream.Reset();
  stream << vtkClientServerStream::Invoke << VTKOBJECT(this) << "GetPicked"
         << vtkClientServerStream::End;
  this->ExecuteStream(stream, false, vtkPVSession::RENDER_SERVER_ROOT);
  std::array<double, 8> picked{};
  this->GetSession()
    ->GetLastResult(vtkPVSession::RENDER_SERVER_ROOT)
    .GetArgument(0, 0, picked.data(), 8);
  // The property is that of the client's object.
  vtkFFDVolumeRepresentation::SafeDownCast(this->GetClientSideObject())->SetPicked(picked.data());
  this->UpdatePropertyInformation(this->GetProperty("FFDPicked"));
  if (picked[0] == 0.0)
  {
    return false;
  }
  std::copy_n(&picked[1], 3, shown);
  std::copy_n(&picked[4], 3, rest);
  value = picked[7];
  return true;
}

//------------------------------------------------------------------------------
bool vtkSMFFDVolumeRepresentationProxy::PickSurface(vtkSMRenderViewProxy* view, const int pixel[2],
  double shown[3], double rest[3], std::string& array, double& value)
{
  const vtkSMPropertyHelper all(view, "Representations");
  bool any = false;
  for (unsigned int i = 0; i < all.GetNumberOfElements(); ++i)
  {
    any = any || ShowsMovedSurface(all.GetAsProxy(i));
  }
  if (!any || !view->IsSelectionAvailable())
  {
    return false;
  }
  // As for ParaView's own picks, vtkSMRenderViewProxy::ConvertDisplayToPointOnSurface().
  const int region[4] = { pixel[0], pixel[1], pixel[0], pixel[1] };
  vtkNew<vtkCollection> representations;
  vtkNew<vtkCollection> sources;
  view->SelectSurfaceCells(region, representations, sources, false);
  auto* parent = vtkSMProxy::SafeDownCast(representations->GetItemAsObject(0));
  auto* selection = vtkSMProxy::SafeDownCast(sources->GetItemAsObject(0));
  if (!selection || !ShowsMovedSurface(parent))
  {
    return false;
  }
  double ends[2][3];
  for (int end = 0; end < 2; ++end)
  {
    view->GetRenderer()->SetDisplayPoint(pixel[0], pixel[1], end);
    view->GetRenderer()->DisplayToWorld();
    const double* world = view->GetRenderer()->GetWorldPoint();
    for (int a = 0; a < 3; ++a)
    {
      ends[end][a] = world[a] / world[3];
    }
  }
  vtkSmartPointer<vtkSMProxy> picker;
  picker.TakeReference(view->GetSessionProxyManager()->NewProxy("misc", "FFDSurfacePicker"));
  if (!picker)
  {
    return false;
  }
  vtkSMPropertyHelper(picker, "Input").Set(vtkSMPropertyHelper(parent, "Input").GetAsProxy());
  vtkSMPropertyHelper(picker, "Selection").Set(selection);
  vtkSMPropertyHelper(picker, "PointA").Set(ends[0], 3);
  vtkSMPropertyHelper(picker, "PointB").Set(ends[1], 3);
  array.clear();
  if (auto* colored = vtkSMPVRepresentationProxy::SafeDownCast(parent);
      colored && colored->GetUsingScalarColoring())
  {
    const vtkSMPropertyHelper name(parent, "ColorArrayName");
    array = name.GetInputArrayNameToProcess();
    vtkSMPropertyHelper(picker, "ArrayName").Set(array.c_str());
    vtkSMPropertyHelper(picker, "OfCells")
      .Set(name.GetInputArrayAssociation() == vtkDataObject::CELL ? 1 : 0);
  }
  picker->UpdateVTKObjects();
  picker->InvokeCommand("Pick");
  double picked[8] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
  vtkSMPropertyHelper result(picker, "Picked");
  result.UpdateValueFromServer();
  result.Get(picked, 8);
  std::copy_n(&picked[1], 3, shown);
  std::copy_n(&picked[4], 3, rest);
  value = picked[7];
  return picked[0] != 0.0;
}

//------------------------------------------------------------------------------
std::string vtkSMFFDVolumeRepresentationProxy::GetShownArray()
{
  vtkSMProxy* parent = this->GetParentProxy();
  vtkSMProperty* array = parent ? parent->GetProperty("ColorArrayName") : nullptr;
  const char* name = array ? vtkSMPropertyHelper(array).GetInputArrayNameToProcess() : nullptr;
  return name ? name : "";
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
/// Once for each switch to such a representation.
void vtkSMFFDVolumeRepresentationProxy::WarnOfRest()
{
  vtkSMProxy* parent = this->GetParentProxy();
  const std::string type = parent ? FindTypeAtRest(parent) : "";
  if (WarnsOfRest && !type.empty() && this->WarnedOf != type)
  {
    vtkWarningMacro(<< ExplainRest(type));
  }
  this->WarnedOf = type;
}

//------------------------------------------------------------------------------
std::string vtkSMFFDVolumeRepresentationProxy::FindTypeAtRest(vtkSMProxy* representation)
{
  const std::string type = GetType(representation);
  if (vtkFFDShownLattice::IsAtRest(type) && HasImageLattice(representation))
  {
    return type;
  }
  return ShowsDropped(representation) ? Dropped : "";
}

//------------------------------------------------------------------------------
std::string vtkSMFFDVolumeRepresentationProxy::ExplainRest(const std::string& type)
{
  if (type == Dropped)
  {
    return "A filter has dropped the lattice of the volume, and the data are shown at rest. \"FFD "
           "Apply Transform\" of an image, or \"FFD Deform Geometry\" of other data, shows them "
           "deformed, with the volume as the second input.";
  }
  return "The representation \"" + type +
    "\" shows the data at rest, without their lattice. \"FFD Volume\" and surfaces show them "
    "deformed; the filter \"FFD Resample To Image\" makes a deformed image for other "
    "representations.";
}

//------------------------------------------------------------------------------
void vtkSMFFDVolumeRepresentationProxy::SetWarnsOfRest(bool warns) { WarnsOfRest = warns; }

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
  const auto hand = [this, parent, option](const Names& names, std::size_t shown) {
    vtkSMProperty* from = parent->GetProperty(names[shown]);
    vtkSMProperty* to = parent->GetProperty(names[1 - shown]);
    if (from == option && to)
    {
      this->Mirroring = true;
      to->Copy(from);
      parent->UpdateProperty(names[1 - shown]);
      this->Mirroring = false;
    }
  };
  for (const Names& names : SharedOptions)
  {
    hand(names, IsShown(parent) ? 0 : 1);
  }
  for (const Names& names : EditorOptions)
  {
    hand(names, 0);
    hand(names, 1);
  }
}
