// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// A lattice widget in a window, and what moves mouse and keys in it.
#ifndef FFDTestWidget_h
#define FFDTestWidget_h

#include "FFDTestHelpers.h"

#include "vtkCallbackCommand.h"
#include "vtkCamera.h"
#include "vtkDoubleArray.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeRepresentation.h"
#include "vtkFFDLatticeWidget.h"
#include "vtkIdTypeArray.h"
#include "vtkInteractorObserver.h"
#include "vtkInteractorStyleTrackballCamera.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"

#include <array>
#include <string>
#include <vector>

namespace ffdTest
{

using Rep = vtkFFDLatticeRepresentation;

class WidgetScene
{
public:
  static constexpr int Size = 400;

  explicit WidgetScene(int points = 5)
  {
    this->Lattice->SetDimensions(points, points, points);
    this->Lattice->SetDomain(0.0, 100.0, 0.0, 100.0, 0.0, 100.0);
    this->Window->SetMultiSamples(0);
    this->Window->SetSize(Size, Size);
    this->Window->AddRenderer(this->Renderer);
    this->Renderer->SetBackground(0.1, 0.11, 0.13);
    this->Interactor->SetRenderWindow(this->Window);
    vtkNew<vtkInteractorStyleTrackballCamera> style;
    this->Interactor->SetInteractorStyle(style);
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->SetFocalPoint(50.0, 50.0, 50.0);
    camera->SetPosition(190.0, 310.0, 520.0);
    camera->SetViewUp(0.0, 1.0, 0.0);
    camera->SetViewAngle(40.0);
    this->Widget->SetInteractor(this->Interactor);
    this->View = this->Widget->GetLatticeRepresentation();
    this->View->SetLattice(this->Lattice);
    this->Log->SetCallback(WidgetScene::Record);
    this->Log->SetClientData(this);
    for (unsigned long event : { vtkCommand::StartInteractionEvent, vtkCommand::InteractionEvent,
           vtkCommand::EndInteractionEvent, vtkCommand::WidgetValueChangedEvent,
           vtkCommand::SelectionChangedEvent })
    {
      this->Widget->AddObserver(event, this->Log);
    }
    this->Errors->Watch(this->Widget);
    this->Errors->Watch(this->View);
    this->Interactor->Initialize();
    this->Widget->On();
    this->Renderer->ResetCameraClippingRange();
    this->Window->Render();
  }

  ~WidgetScene() { this->Widget->Off(); }

  //----------------------------------------------------------------------------
  /// Where a point of data coordinates is seen.
  std::array<double, 3> Display(const std::array<double, 3>& p)
  {
    std::array<double, 3> display;
    vtkInteractorObserver::ComputeWorldToDisplay(this->Renderer, p[0], p[1], p[2], display.data());
    return display;
  }

  std::array<double, 3> Point(int i, int j, int k)
  {
    std::array<double, 3> p;
    this->Lattice->GetControlPoint(i, j, k, p.data());
    return p;
  }

  std::array<double, 3> Moved(int i, int j, int k)
  {
    std::array<double, 3> p;
    this->Lattice->GetDisplacement(i, j, k, p.data());
    return p;
  }

  vtkIdType Index(int i, int j, int k)
  {
    int n[3];
    this->Lattice->GetDimensions(n);
    return i + n[0] * (j + static_cast<vtkIdType>(n[1]) * k);
  }

  std::vector<double> All()
  {
    const double* values = this->Lattice->GetDisplacements()->GetPointer(0);
    return std::vector<double>(
      values, values + this->Lattice->GetDisplacements()->GetNumberOfValues());
  }

  //----------------------------------------------------------------------------
  enum Modifiers
  {
    None = 0,
    Shift = 1,
    Control = 2,
    Alt = 4
  };

  void Mouse(unsigned long event, double x, double y, int modifiers = None)
  {
    this->X = static_cast<int>(std::lround(x));
    this->Y = static_cast<int>(std::lround(y));
    this->Interactor->SetEventInformation(
      this->X, this->Y, (modifiers & Control) ? 1 : 0, (modifiers & Shift) ? 1 : 0);
    this->Interactor->SetAltKey((modifiers & Alt) ? 1 : 0);
    this->Interactor->InvokeEvent(event, nullptr);
  }
  void Move(double x, double y) { this->Mouse(vtkCommand::MouseMoveEvent, x, y); }
  void Press(double x, double y, int modifiers = None)
  {
    this->Move(x, y);
    this->Mouse(vtkCommand::LeftButtonPressEvent, x, y, modifiers);
  }
  void Release() { this->Mouse(vtkCommand::LeftButtonReleaseEvent, this->X, this->Y); }
  void Click(double x, double y, int modifiers = None)
  {
    this->Press(x, y, modifiers);
    this->Release();
  }
  void ClickPoint(int i, int j, int k, int modifiers = None)
  {
    const std::array<double, 3> at = this->Display(this->Point(i, j, k));
    this->Click(at[0], at[1], modifiers);
  }
  void PressPoint(int i, int j, int k, int modifiers = None)
  {
    const std::array<double, 3> at = this->Display(this->Point(i, j, k));
    this->Press(at[0], at[1], modifiers);
  }
  /// Move the pressed mouse in steps.
  void Drag(double dx, double dy, int steps = 5)
  {
    const int x = this->X;
    const int y = this->Y;
    for (int s = 1; s <= steps; ++s)
    {
      this->Move(x + dx * s / steps, y + dy * s / steps);
    }
  }
  void DragPoint(int i, int j, int k, double dx, double dy)
  {
    this->PressPoint(i, j, k);
    this->Drag(dx, dy);
    this->Release();
  }
  /// Press and release a key, with the events that a window system sends.
  void Key(const char* symbol, int modifiers = None)
  {
    const char code = symbol[1] == '\0' ? symbol[0] : '\0';
    this->Interactor->SetEventInformation(this->X, this->Y, (modifiers & Control) ? 1 : 0,
      (modifiers & Shift) ? 1 : 0, code, 0, symbol);
    this->Interactor->SetAltKey((modifiers & Alt) ? 1 : 0);
    this->Interactor->InvokeEvent(vtkCommand::KeyPressEvent, nullptr);
    this->Interactor->InvokeEvent(vtkCommand::CharEvent, nullptr);
    this->Interactor->InvokeEvent(vtkCommand::KeyReleaseEvent, nullptr);
    this->Interactor->SetAltKey(0);
  }

  /// The events since the last call: S, I, E for the interaction, [name] for a change, s for the
  /// selection.
  std::string Events()
  {
    std::string events;
    events.swap(this->Recorded);
    return events;
  }

  vtkNew<vtkFFDLattice> Lattice;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindowInteractor> Interactor;
  vtkNew<vtkFFDLatticeWidget> Widget;
  Rep* View = nullptr;
  vtkNew<FFDErrorLog> Errors;
  int X = 0;
  int Y = 0;

private:
  static void Record(vtkObject*, unsigned long event, void* client, void* data)
  {
    std::string& log = static_cast<WidgetScene*>(client)->Recorded;
    switch (event)
    {
      case vtkCommand::StartInteractionEvent:
        log += "S";
        break;
      case vtkCommand::InteractionEvent:
        log += "I";
        break;
      case vtkCommand::EndInteractionEvent:
        log += "E";
        break;
      case vtkCommand::SelectionChangedEvent:
        log += "s";
        break;
      default:
        log += std::string("[") + static_cast<const char*>(data) + "]";
        break;
    }
  }

  vtkNew<vtkCallbackCommand> Log;
  std::string Recorded;
};

} // namespace ffdTest

#endif
