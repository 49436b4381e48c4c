// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBenchmarkWidget.h"

#include "FFDBenchmarkScene.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeRepresentation.h"
#include "vtkFFDLatticeWidget.h"

#include "vtkCamera.h"
#include "vtkCommand.h"
#include "vtkGenericRenderWindowInteractor.h"
#include "vtkImageData.h"
#include "vtkInteractorObserver.h"
#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkSmartPointer.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <cmath>
#include <string>

namespace ffdBenchmark
{

namespace
{

constexpr int WindowSize = 512;

/// Frames a second that the interactor asks for during a drag.
constexpr double DesiredRate = 30.0;

/// Pixels to either side that the mouse moves, and pixels of a step.
constexpr int Reach = 24;
constexpr int Step = 3;

/// A window in which a control point is being dragged.
class DragWindow
{
public:
  /// Without image: the lattice alone, `points` per axis.
  DragWindow(vtkImageData* image, Opacity opacity, int points, bool adaptive, bool coherent,
    bool widget, int lines)
  {
    this->Window->SetOffScreenRendering(1);
    this->Window->SetMultiSamples(0);
    this->Window->SetSize(WindowSize, WindowSize);
    this->Window->AddRenderer(this->Renderer);
    this->Interactor->SetRenderWindow(this->Window);
    this->Interactor->SetDesiredUpdateRate(DesiredRate);
    double bounds[6] = { 0.0, 255.0, 0.0, 255.0, 0.0, 112.0 };
    if (image)
    {
      image->GetBounds(bounds);
      Deform(this->Lattice, image, { Shape::Smooth, 45.0 });
      this->Mapper = MakeMapper(image, this->Lattice, Variant::Exact);
      this->Mapper->SetAutoAdjustSampleDistances(adaptive);
      this->Mapper->SetFrameCoherence(coherent);
      this->Volume->SetMapper(this->Mapper);
      this->Property = MakeProperty(opacity);
      this->Volume->SetProperty(this->Property);
      this->Renderer->AddVolume(this->Volume);
    }
    else
    {
      this->Lattice->SetDimensions(points, points, points);
      this->Lattice->FitToBounds(bounds);
    }
    const double center[3] = { 0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]),
      0.5 * (bounds[4] + bounds[5]) };
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->SetFocalPoint(center);
    camera->SetPosition(center[0] - 282.0, center[1] - 198.0, center[2] - 564.0);
    camera->SetViewUp(0.0, 1.0, 0.0);
    // A point near the middle, in front.
    this->Lattice->GetDimensions(this->Point);
    for (int& index : this->Point)
    {
      index /= 2;
    }
    this->Point[2] = 2;
    if (widget)
    {
      vtkFFDLatticeRepresentation* rep = this->Widget->GetLatticeRepresentation();
      rep->SetLattice(this->Lattice);
      rep->SetProp(this->Volume);
      rep->SetLineMode(lines);
      this->Widget->SetInteractor(this->Interactor);
      this->Widget->SetDefaultRenderer(this->Renderer);
      this->Widget->On();
    }
    this->Renderer->ResetCameraClippingRange();
    this->Window->Render();
    double p[3];
    double display[3];
    this->Lattice->GetControlPoint(this->Point[0], this->Point[1], this->Point[2], p);
    vtkInteractorObserver::ComputeWorldToDisplay(this->Renderer, p[0], p[1], p[2], display);
    this->Start[0] = static_cast<int>(std::lround(display[0]));
    this->Start[1] = static_cast<int>(std::lround(display[1]));
    this->Lattice->GetDisplacement(this->Point[0], this->Point[1], this->Point[2], this->Rest);
    if (widget)
    {
      this->Send(vtkCommand::MouseMoveEvent, 0);
      this->Send(vtkCommand::LeftButtonPressEvent, 0);
    }
    else
    {
      // Full quality whatever the time.
      this->Window->SetDesiredUpdateRate(1e-4);
    }
  }

  ~DragWindow() { this->Widget->Off(); }

  bool IsDragging() { return this->Widget->IsInteracting() != 0; }

  /// The next place of the mouse: to and fro.
  int Next()
  {
    this->Place += this->Direction * Step;
    if (std::abs(this->Place) >= Reach)
    {
      this->Direction = -this->Direction;
    }
    return this->Place;
  }

  /// One mouse move, and the picture that follows it.
  void DragByMouse()
  {
    this->Send(vtkCommand::MouseMoveEvent, this->Next());
    this->Window->WaitForCompletion();
  }

  /// The same without a widget: some world units to a pixel.
  void DragByHand()
  {
    this->Lattice->SetDisplacement(this->Point[0], this->Point[1], this->Point[2],
      this->Rest[0] - 0.7 * this->Next(), this->Rest[1], this->Rest[2]);
    this->Renderer->ResetCameraClippingRange();
    this->Window->Render();
    this->Window->WaitForCompletion();
  }

  /// From now on the lattice deforms nothing.
  void RemoveDeformation()
  {
    this->Mapper->SetDeformation(nullptr);
    this->Renderer->ResetCameraClippingRange();
  }

  /// The volume at rest, drawn again: what is left if neither the deformation nor the widget costs
  /// anything.
  void DrawUndeformed()
  {
    this->Window->Render();
    this->Window->WaitForCompletion();
  }

private:
  void Send(unsigned long event, int offset)
  {
    this->Interactor->SetEventInformation(this->Start[0] + offset, this->Start[1], 0, 0);
    this->Interactor->InvokeEvent(event, nullptr);
  }

  vtkNew<vtkFFDLattice> Lattice;
  vtkSmartPointer<vtkFFDInverseRayVolumeMapper> Mapper;
  vtkSmartPointer<vtkVolumeProperty> Property;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkGenericRenderWindowInteractor> Interactor;
  vtkNew<vtkFFDLatticeWidget> Widget;
  int Point[3];
  int Start[2] = { 0, 0 };
  double Rest[3];
  int Place = 0;
  int Direction = 1;
};

//------------------------------------------------------------------------------
std::shared_ptr<void> PrepareWidget(
  Group& group, vtkSmartPointer<vtkImageData> image, Opacity opacity)
{
  auto windows = std::make_shared<std::vector<std::unique_ptr<DragWindow>>>();
  for (Row& row : group.GetRows())
  {
    const bool undeformed = row.Name == "undeformed";
    const bool undeformedDrag = row.Name == "undeformed_drag";
    const bool widget = row.Name != "without_widget" && !undeformed;
    const int lines = row.Name == "curved" ? vtkFFDLatticeRepresentation::CURVED
                                           : vtkFFDLatticeRepresentation::STRAIGHT;
    windows->push_back(std::make_unique<DragWindow>(image, opacity, image ? 8 : 20,
      row.Name == "interactive", row.Name != "whole" && !undeformedDrag, widget, lines));
    DragWindow* window = windows->back().get();
    if (undeformed || undeformedDrag)
    {
      window->RemoveDeformation();
    }
    if (widget && !window->IsDragging())
    {
      row.Refusal = "the mouse did not take hold of the control point";
      continue;
    }
    if (undeformed)
    {
      row.Run = [window] { window->DrawUndeformed(); };
    }
    else if (widget)
    {
      row.Run = [window] { window->DragByMouse(); };
    }
    else
    {
      row.Run = [window] { window->DragByHand(); };
    }
    // The first frames of a window set things up, and the mapper finds its sample distance.
    for (int warm = 0; warm < 4; ++warm)
    {
      row.Run();
    }
  }
  return windows;
}

} // namespace

//------------------------------------------------------------------------------
void AddWidgetGroups(const Options& options, std::vector<std::unique_ptr<Group>>& groups)
{
  const std::size_t rounds =
    options.Rounds > 0 ? static_cast<std::size_t>(options.Rounds) : (options.Quick ? 9 : 41);
  const std::string folder = options.DataFolder;
  const auto add = [&](std::unique_ptr<Group> group, const std::vector<std::string>& rows) {
    for (const std::string& row : rows)
    {
      group->AddRow(row, rounds);
    }
    if (!group->GetRows().empty())
    {
      groups.push_back(std::move(group));
    }
  };
  for (Opacity opacity : { Opacity::Opaque, Opacity::Semi })
  {
    add(std::make_unique<Group>(std::string("WidgetDrag/") + GetName(opacity),
          [folder, opacity](
            Group& group) { return PrepareWidget(group, ReadVolume(folder, "engine"), opacity); }),
      { "full", "whole", "interactive", "undeformed_drag", "without_widget", "undeformed" });
  }
  add(std::make_unique<Group>("WidgetDrag/lattice20",
        [](Group& group) { return PrepareWidget(group, nullptr, Opacity::Opaque); }),
    { "straight", "curved" });
}

} // namespace ffdBenchmark
