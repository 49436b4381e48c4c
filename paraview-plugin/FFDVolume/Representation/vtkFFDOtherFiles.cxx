// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The plugin in another file, where one is loaded already: an installed one that ParaView loads
// when it starts, and one of a build by a script. ParaView appends what the descriptions of both
// add to its own proxies, and ends at the next one of these, for properties are there twice.
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkPVPlugin.h"
#include "vtkPVPluginTracker.h"
#include "vtkWeakPointer.h"

#include <cstring>
#include <string>

namespace
{

/// Keeps a second file of the plugin from those to whom ParaView hands plugins.
class OtherFiles : public vtkCommand
{
public:
  static OtherFiles* New() { return new OtherFiles; }

  void Execute(vtkObject* tracker, unsigned long, void* data) override
  {
    auto* plugin = static_cast<vtkPVPlugin*>(data);
    if (!plugin || std::strcmp(plugin->GetPluginName(), "FFDVolume") != 0)
    {
      return;
    }
    if (!this->IsLoaded)
    {
      this->IsLoaded = true;
      return;
    }
    this->AbortFlagOn();
    const std::string file = plugin->GetFileName() ? plugin->GetFileName() : "";
    vtkWarningWithObjectMacro(tracker,
      << "The plugin FFDVolume is loaded already, and nothing is taken from \"" << file
      << "\". To use that file, start ParaView without the other one: see PV_PLUGIN_PATH, and Auto "
         "Load in Tools > Manage Plugins.");
  }

private:
  bool IsLoaded = false;
};

/// Watches from before the first file of the plugin is handed on until this library is unloaded.
class Watch
{
public:
  Watch()
    : Tracker(vtkPVPluginTracker::GetInstance())
  {
    constexpr float first = 1000.0F;
    this->Tracker->AddObserver(vtkCommand::RegisterEvent, this->Command, first);
  }
  ~Watch()
  {
    if (this->Tracker)
    {
      this->Tracker->RemoveObserver(this->Command);
    }
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

private:
  vtkNew<OtherFiles> Command;
  vtkWeakPointer<vtkPVPluginTracker> Tracker;
};

const Watch watch;

} // namespace
