// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDExportWarning.h"

#include "vtkFFDInverseRayVolumeMapper.h"

#include "vtkClientServerInterpreter.h"
#include "vtkClientServerInterpreterInitializer.h"
#include "vtkClientServerStream.h"
#include "vtkExporter.h"
#include "vtkObject.h"
#include "vtkRenderer.h"
#include "vtkRendererCollection.h"
#include "vtkRenderWindow.h"
#include "vtkVolume.h"
#include "vtkVolumeCollection.h"

#include <fstream>
#include <iterator>
#include <string>

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
  if (!ShowsVolume(exporter->GetRenderWindow()))
  {
    return;
  }
  if (exporter->IsA("vtkPVWebExporter"))
  {
    vtkWarningWithObjectMacro(exporter,
      << "\"FFD Volume\" is at rest in the exported scene: such files hold images, and no "
         "lattice. Export the output of \"FFD Resample To Image\" as \"Volume\".");
    return;
  }
  vtkWarningWithObjectMacro(
    exporter, << "\"FFD Volume\" is not in the exported scene: such files hold surfaces. Save a "
                 "screenshot, or export contours of the volume, which are deformed as it is.");
}

/// The file of an exporter whose class is of a module that this one does not need.
std::string GetFileName(vtkExporter* exporter)
{
  vtkClientServerInterpreter* interpreter =
    vtkClientServerInterpreterInitializer::GetGlobalInterpreter();
  vtkClientServerStream stream;
  stream << vtkClientServerStream::Invoke << exporter << "GetFileName"
         << vtkClientServerStream::End;
  const char* name = nullptr;
  if (!interpreter || !interpreter->ProcessStream(stream) ||
    !interpreter->GetLastResult().GetArgument(0, 0, &name))
  {
    return "";
  }
  return name ? name : "";
}

/// Drawings hold a picture of the volume, but those of SVG only if GL2PS was built with PNG.
void WarnOfDrawing(void* argument)
{
  auto* exporter = static_cast<vtkExporter*>(argument);
  std::ifstream file(GetFileName(exporter), std::ios::binary);
  if (!file || !ShowsVolume(exporter->GetRenderWindow()))
  {
    return;
  }
  const std::string text{ std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>() };
  if (text.find("<svg") != std::string::npos && text.find("<image") == std::string::npos)
  {
    vtkWarningWithObjectMacro(exporter,
      << "\"FFD Volume\" is not in the exported scene: the GL2PS of this ParaView puts no "
         "pictures into SVG files. Export as PDF, PS or EPS, or save a screenshot.");
  }
}

} // namespace

//------------------------------------------------------------------------------
void ffdexport::Watch(vtkExporter* exporter)
{
  if (exporter->IsA("vtkGL2PSExporter"))
  {
    exporter->SetEndWrite(&WarnOfDrawing, exporter);
    return;
  }
  exporter->SetStartWrite(&Warn, exporter);
}
