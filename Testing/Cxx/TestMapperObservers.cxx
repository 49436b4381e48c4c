// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Observers of the events of a frame change, remove, release and delete what is being rendered, and
// call the mapper again: the frame shows what it began with, the next one what it is then.

#include "FFDTestHelpers.h"

#include "vtkCallbackCommand.h"
#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDVolumePicker.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{

constexpr int Side = 64;
using Bytes = std::vector<unsigned char>;

vtkSmartPointer<vtkImageData> MakeImage(int n, double phase)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(n, n, n);
  image->SetSpacing(20.0 / (n - 1), 20.0 / (n - 1), 20.0 / (n - 1));
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* voxel = static_cast<unsigned char*>(image->GetScalarPointer());
  for (int k = 0; k < n; ++k)
  {
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        *voxel++ = static_cast<unsigned char>(128.0 +
          120.0 * std::sin(phase + 0.7 * i) * std::sin(0.5 * j) * std::sin(phase + 0.4 * k));
      }
    }
  }
  return image;
}

/// A window with a deformed volume. What observers may delete is held by it only.
struct Scene
{
  Scene()
  {
    this->Image = MakeImage(21, 0.3);
    this->Lattice = vtkSmartPointer<vtkFFDLattice>::New();
    this->Lattice->SetDimensions(5, 5, 5);
    this->Lattice->FitToBounds(this->Image->GetBounds(), 0.0);
    FFDRandom(1).Shape(this->Lattice, 0.3);
    vtkNew<vtkPiecewiseFunction> opacity;
    opacity->AddPoint(130.0, 0.0);
    opacity->AddPoint(255.0, 0.5);
    vtkNew<vtkColorTransferFunction> color;
    color->AddRGBPoint(0.0, 1.0, 0.4, 0.2);
    color->AddRGBPoint(255.0, 0.2, 0.9, 1.0);
    vtkNew<vtkVolumeProperty> property;
    property->SetScalarOpacity(opacity);
    property->SetColor(color);
    property->SetInterpolationTypeToLinear();
    this->Mapper = vtkSmartPointer<vtkFFDInverseRayVolumeMapper>::New();
    this->Mapper->SetInputData(this->Image);
    this->Mapper->SetDeformation(this->Lattice);
    this->Volume = vtkSmartPointer<vtkVolume>::New();
    this->Volume->SetMapper(this->Mapper);
    this->Volume->SetProperty(property);
    this->Renderer->AddVolume(this->Volume);
    this->Renderer->SetBackground(0.1, 0.2, 0.3);
    this->Window->SetSize(Side, Side);
    this->Window->SetMultiSamples(0);
    this->Window->SetOffScreenRendering(1);
    this->Window->AddRenderer(this->Renderer);
    this->Renderer->GetActiveCamera()->SetPosition(1.0, 2.0, 5.0);
    this->Renderer->GetActiveCamera()->SetFocalPoint(0.0, 0.0, 0.0);
    this->Renderer->ResetCamera(0.0, 20.0, 0.0, 20.0, 0.0, 20.0);
    this->Log->Watch(this->Mapper);
  }

  Bytes Render()
  {
    // Not as the bounds are: what is compared is the picture of the volume.
    this->Renderer->GetActiveCamera()->SetClippingRange(5.0, 500.0);
    this->Window->Render();
    return this->Read();
  }

  Bytes Read()
  {
    vtkNew<vtkUnsignedCharArray> pixels;
    this->Window->GetPixelData(0, 0, Side - 1, Side - 1, 0, pixels);
    return Bytes(pixels->GetPointer(0), pixels->GetPointer(0) + pixels->GetNumberOfValues());
  }

  vtkSmartPointer<vtkImageData> Image;
  vtkSmartPointer<vtkFFDLattice> Lattice;
  vtkSmartPointer<vtkFFDInverseRayVolumeMapper> Mapper;
  vtkSmartPointer<vtkVolume> Volume;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<FFDErrorLog> Log;
};

/// What an observer does, and what comes of it.
struct Action
{
  std::string Name;
  std::function<void(Scene&)> Do;
  std::string Error;      ///< that the mapper reports, or none
  bool NoPicture = false; ///< of this frame
  bool Empty = false;     ///< nothing is in the next picture
};

int RenderImage(vtkFFDInverseRayVolumeMapper* mapper, Scene& s)
{
  vtkNew<vtkImageData> colors;
  return mapper->RenderToImage(s.Renderer, s.Volume, 16, 16, colors);
}

std::vector<Action> MakeActions()
{
  const std::string refused = "while the mapper renders";
  return {
    { "ReleaseGraphicsResources", [](Scene& s) { s.Mapper->ReleaseGraphicsResources(s.Window); },
      "" },
    { "RemoveVolume", [](Scene& s) { s.Renderer->RemoveVolume(s.Volume); }, "", false, true },
    { "delete the volume",
      [](Scene& s) {
        s.Renderer->RemoveVolume(s.Volume);
        s.Volume = nullptr;
      },
      "", false, true },
    { "delete volume and mapper",
      [](Scene& s) {
        s.Renderer->RemoveVolume(s.Volume);
        s.Volume = nullptr;
        s.Mapper = nullptr;
      },
      "", false, true },
    { "SetMapper(nullptr)",
      [](Scene& s) {
        s.Volume->SetMapper(nullptr);
        s.Mapper = nullptr;
      },
      "", false, true },
    { "new input",
      [](Scene& s) {
        s.Image = MakeImage(15, 1.0);
        s.Mapper->SetInputData(s.Image);
      },
      "" },
    { "no input",
      [](Scene& s) {
        s.Image = nullptr;
        s.Mapper->SetInputData(static_cast<vtkImageData*>(nullptr));
      },
      "", false, true },
    { "new scalars",
      [](Scene& s) {
        auto other = MakeImage(21, 2.0);
        s.Image->GetPointData()->SetScalars(other->GetPointData()->GetScalars());
      },
      "" },
    { "AllocateScalars",
      [](Scene& s) {
        s.Image->AllocateScalars(VTK_SHORT, 1);
        s.Image->GetPointData()->GetScalars()->Fill(200.0);
      },
      "" },
    { "fewer scalars in the same array",
      [](Scene& s) {
        vtkDataArray* scalars = s.Image->GetPointData()->GetScalars();
        scalars->Initialize();
        scalars->SetNumberOfTuples(1);
        s.Mapper->SetInputData(MakeImage(21, 0.3));
      },
      "memory of an array", true },
    { "new deformation",
      [](Scene& s) {
        vtkNew<vtkFFDLattice> other;
        s.Mapper->SetDeformation(other);
        s.Lattice = nullptr;
      },
      "" },
    { "edit of the lattice",
      [](Scene& s) {
        FFDRandom(2).Shape(s.Lattice, 0.4);
        s.Mapper->GetBounds();
        s.Volume->GetBounds();
      },
      "" },
    { "Refine", [](Scene& s) { s.Lattice->Refine(2); }, "" },
    { "reset of the lattice", [](Scene& s) { s.Lattice->Reset(); }, "" },
    { "new property",
      [](Scene& s) {
        vtkNew<vtkVolumeProperty> property;
        property->SetScalarOpacity(s.Volume->GetProperty()->GetScalarOpacity());
        s.Volume->SetProperty(property);
      },
      "" },
    { "edit of the property",
      [](Scene& s) {
        s.Volume->GetProperty()->ShadeOn();
        s.Volume->GetProperty()->GetScalarOpacity()->RemoveAllPoints();
        s.Volume->GetProperty()->GetScalarOpacity()->AddPoint(0.0, 0.01);
      },
      "" },
    { "mask",
      [](Scene& s) {
        vtkNew<vtkImageData> mask;
        mask->SetDimensions(21, 21, 21);
        mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
        mask->GetPointData()->GetScalars()->Fill(1.0);
        s.Mapper->SetMaskInput(mask);
      },
      "" },
    { "setters",
      [](Scene& s) {
        s.Mapper->SetFinalColorWindow(0.5);
        s.Mapper->SetInverseModeToFirstOrder();
        s.Mapper->SetSegmentationToGreedyAngle();
        s.Mapper->SetSpaceLeapingToOff();
        s.Mapper->SetSampleDistance(3.0);
        s.Mapper->SetImageSampleDistance(2.0);
        s.Mapper->SetNumberOfThreads(3);
        s.Mapper->SetReferenceKernels(1);
        s.Mapper->SetBlendModeToMaximumIntensity();
        s.Mapper->SetClipBox(5.0, 10.0, 5.0, 10.0, 5.0, 10.0);
        s.Mapper->SetCropping(1);
        s.Mapper->SetIntermixIntersectingGeometry(0);
      },
      "" },
    { "CollectStatistics", [](Scene& s) { s.Mapper->SetCollectStatistics(1); }, "" },
    { "ShallowCopy",
      [](Scene& s) {
        vtkNew<vtkFFDInverseRayVolumeMapper> other;
        other->SetInputData(MakeImage(12, 0.0));
        other->SetUseJittering(1);
        s.Mapper->ShallowCopy(other);
      },
      "" },
    { "Render of the window", [](Scene& s) { s.Window->Render(); }, "" },
    { "Render of the mapper", [](Scene& s) { s.Mapper->Render(s.Renderer, s.Volume); }, refused },
    { "RenderToImage", [](Scene& s) { RenderImage(s.Mapper, s); }, refused },
    { "RenderToImage of another mapper",
      [](Scene& s) {
        vtkNew<vtkFFDInverseRayVolumeMapper> other;
        other->ShallowCopy(s.Mapper);
        RenderImage(other, s);
      },
      "" },
    { "TraceRays",
      [](Scene& s) {
        vtkNew<vtkIdTypeArray> pixels;
        pixels->SetNumberOfComponents(2);
        vtkNew<vtkPolyData> rays;
        s.Mapper->TraceRays(s.Renderer, s.Volume, 8, 8, pixels, rays, nullptr, nullptr);
      },
      refused },
    { "GetRestPosition and a pick",
      [](Scene& s) {
        double p[3] = { 10.0, 10.0, 10.0 };
        s.Mapper->GetRestPosition(p, p);
        vtkNew<vtkFFDVolumePicker> picker;
        picker->Pick(0.5 * Side, 0.5 * Side, 0.0, s.Renderer);
      },
      "" },
    { "Abort", [](Scene& s) { s.Mapper->SetAbortExecute(1); }, "", true },
  };
}

/// Run an action in the first event of a frame; "": what went wrong.
std::string Run(const Action& action, unsigned long event, bool ofWindow)
{
  Scene scene;
  const Bytes before = scene.Render();
  // Something to do for the frame.
  scene.Mapper->Modified();
  int calls = 0;
  std::function<void()> once = [&] {
    if (calls++ == 0)
    {
      action.Do(scene);
    }
  };
  vtkNew<vtkCallbackCommand> command;
  command->SetClientData(&once);
  command->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
    (*static_cast<std::function<void()>*>(data))();
  });
  vtkObject* sender =
    ofWindow ? static_cast<vtkObject*>(scene.Renderer) : static_cast<vtkObject*>(scene.Mapper);
  sender->AddObserver(event, command);
  const Bytes during = scene.Render();
  if (calls == 0)
  {
    return "the event did not come";
  }
  if (scene.Renderer->HasObserver(event, command))
  {
    scene.Renderer->RemoveObserver(command);
  }
  const bool end = event == vtkCommand::EndEvent;
  if (!ofWindow)
  {
    const int errors = scene.Log->Count;
    const std::string& text = scene.Log->Message;
    const bool intact = end && action.NoPicture; // the picture was there already
    if (!intact && (errors > 0) != !action.Error.empty())
    {
      return std::to_string(errors) + " errors: " + text;
    }
    if (errors > 0 && text.find(action.Error) == std::string::npos)
    {
      return "another error: " + text;
    }
    if (!action.NoPicture && during != before)
    {
      return "the frame does not show what it began with";
    }
  }
  scene.Log->Count = 0;
  scene.Log->Message.clear();
  // What is there now, in a window that has seen nothing of all that.
  const Bytes after = scene.Render();
  if (!action.Empty)
  {
    if (scene.Log->Count > 0)
    {
      return "the next frame reports " + scene.Log->Message;
    }
    vtkNew<vtkFFDInverseRayVolumeMapper> fresh;
    fresh->ShallowCopy(scene.Mapper);
    scene.Volume->SetMapper(fresh);
    if (scene.Render() != after)
    {
      return "the next frame is not that of a new mapper";
    }
  }
  else
  {
    for (std::size_t i = 3; i < after.size(); i += 3)
    {
      if (!std::equal(&after[i], &after[i] + 3, &after[0]))
      {
        return "the next frame is not empty";
      }
    }
  }
  return std::string();
}

/// Releases, removes and throws: the frame ends with an error, the events of its end are invoked,
/// and the next frame is as ever.
bool TestException(unsigned long event, bool toImage)
{
  Scene scene;
  const Bytes expected = scene.Render();
  int ends = 0;
  const auto count = [](vtkObject*, unsigned long, void* data, void*) {
    ++*static_cast<int*>(data);
  };
  vtkNew<vtkCallbackCommand> counter;
  counter->SetClientData(&ends);
  counter->SetCallback(count);
  scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderEndEvent, counter, 1.0f);
  scene.Mapper->AddObserver(vtkCommand::EndEvent, counter, 1.0f);
  vtkNew<vtkCallbackCommand> thrower;
  thrower->SetClientData(&scene);
  thrower->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
    Scene& s = *static_cast<Scene*>(data);
    s.Mapper->ReleaseGraphicsResources(s.Window);
    s.Volume->SetMapper(nullptr);
    throw std::runtime_error("of an observer");
  });
  const unsigned long tag = scene.Mapper->AddObserver(event, thrower);
  if (toImage)
  {
    vtkNew<vtkImageData> colors;
    scene.Mapper->RenderToImage(scene.Renderer, scene.Volume, Side, Side, colors);
  }
  else
  {
    scene.Render();
  }
  const bool told = scene.Log->Had("of an observer");
  scene.Mapper->RemoveObserver(tag);
  scene.Volume->SetMapper(scene.Mapper);
  scene.Log->Count = 0;
  const bool ok = told && ends == 2 && scene.Render() == expected && scene.Log->Count == 0;
  std::cout << (ok ? "ok    " : "WRONG ") << vtkCommand::GetStringFromEventId(event)
            << (toImage ? " of an image" : "") << " that throws: " << ends << " ends\n";
  return ok;
}

} // namespace

int TestMapperObservers(int argc, char* argv[])
{
  const std::string only = argc > 1 && argv[1][0] != '-' ? argv[1] : "";
  struct
  {
    const char* Name;
    unsigned long Event;
    bool OfRenderer;
  } const events[] = {
    { "StartEvent of the renderer", vtkCommand::StartEvent, true },
    { "VolumeMapperRenderProgressEvent", vtkCommand::VolumeMapperRenderProgressEvent, false },
    { "StartEvent", vtkCommand::StartEvent, false },
    { "ProgressEvent", vtkCommand::ProgressEvent, false },
    { "EndEvent", vtkCommand::EndEvent, false },
  };
  int wrong = 0;
  for (const auto& event : events)
  {
    for (const Action& action : MakeActions())
    {
      if (!only.empty() && action.Name != only)
      {
        continue;
      }
      const std::string what = Run(action, event.Event, event.OfRenderer);
      std::cout << (what.empty() ? "ok    " : "WRONG ") << event.Name << ", " << action.Name << ": "
                << what << std::endl;
      wrong += what.empty() ? 0 : 1;
    }
  }
  for (const unsigned long event :
    { vtkCommand::StartEvent, vtkCommand::VolumeMapperRenderStartEvent, vtkCommand::ProgressEvent,
      vtkCommand::VolumeMapperRenderEndEvent, vtkCommand::EndEvent })
  {
    for (const bool toImage : { false, true })
    {
      wrong += TestException(event, toImage) ? 0 : 1;
    }
  }
  FFD_CHECK(wrong == 0);
  return EXIT_SUCCESS;
}
