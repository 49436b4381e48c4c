// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDExportWarning.h"

#include "vtkFFDInverseRayVolumeMapper.h"

#include "vtkExporter.h"
#include "vtkObject.h"
#include "vtkRenderer.h"
#include "vtkRendererCollection.h"
#include "vtkRenderWindow.h"
#include "vtkVolume.h"
#include "vtkVolumeCollection.h"

namespace
{

/// Whether the window shows a volume of FFD Volume.
bool ShowsVolume(vtkRenderWindow* window)
{
  vtkRendererCollection* renderers = window ? window->GetRenderers() : nullptr;
  vtkCollectionSimpleIterator each;
  if (renderers)
  {
    renderers->InitTraversal(each);
  }
  while (vtkRenderer* renderer = renderers ? renderers->GetNextRenderer(each) : nullptr)
  {
    vtkVolumeCollection* volumes = renderer->GetVolumes();
    vtkCollectionSimpleIterator which;
    volumes->InitTraversal(which);
    while (vtkVolume* volume = volumes->GetNextVolume(which))
    {
      if (volume->GetVisibility() &&
        vtkFFDInverseRayVolumeMapper::SafeDownCast(volume->GetMapper()))
      {
        return true;
      }
    }
  }
  return false;
}

void Warn(void* argument)
{
  auto* exporter = static_cast<vtkExporter*>(argument);
  if (ShowsVolume(exporter->GetRenderWindow()))
  {
    vtkWarningWithObjectMacro(
      exporter, << "\"FFD Volume\" is not in the exported scene: such files hold surfaces. Save a "
                   "screenshot, or export contours of the volume, which are deformed as it is.");
  }
}

} // namespace

//------------------------------------------------------------------------------
void ffdexport::Watch(vtkExporter* exporter) { exporter->SetStartWrite(&Warn, exporter); }
