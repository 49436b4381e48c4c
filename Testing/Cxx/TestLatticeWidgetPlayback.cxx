// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Recorded events: a session that is recorded and played back ends in the same lattice, and so does
// a stored recording.
#include "FFDTestWidget.h"

#include "vtkInteractorEventRecorder.h"

#include <cmath>

using ffdTest::Rep;
using ffdTest::WidgetScene;

namespace
{

/// Selects control point (4, 4, 4), drags it along x (key x), nudges it twice, takes the second
/// nudge back.
const char* const Recording = R"(# StreamVersion 1.1
MouseMoveEvent 293 242 0 0 0 0
LeftButtonPressEvent 293 242 0 0 0 0
KeyPressEvent 293 242 0 120 0 x
CharEvent 293 242 0 120 0 x
KeyReleaseEvent 293 242 0 120 0 x
MouseMoveEvent 306 242 0 0 0 x
MouseMoveEvent 322 238 0 0 0 x
LeftButtonReleaseEvent 322 238 0 0 0 x
KeyPressEvent 322 238 0 0 1 Up
CharEvent 322 238 0 0 1 Up
KeyReleaseEvent 322 238 0 0 1 Up
KeyPressEvent 322 238 0 0 1 Up
CharEvent 322 238 0 0 1 Up
KeyReleaseEvent 322 238 0 0 1 Up
KeyPressEvent 322 238 2 122 0 z
CharEvent 322 238 2 122 0 z
KeyReleaseEvent 322 238 2 122 0 z
)";

/// What the user of the recorded session does.
void Act(WidgetScene& scene)
{
  scene.ClickPoint(4, 4, 4);
  scene.Key("plus");
  scene.DragPoint(4, 4, 4, -25, 15);
  scene.Key("Up", WidgetScene::Shift);
  scene.Key("z", WidgetScene::Control);
  scene.Press(2, 2, WidgetScene::Shift);
  scene.Drag(150, 200);
  scene.Release();
  scene.Key("o");
  scene.PressPoint(0, 4, 4);
  scene.Drag(10, 20);
  scene.Mouse(vtkCommand::MouseWheelForwardEvent, scene.X, scene.Y);
  scene.Key("y");
  scene.Drag(5, 10);
  scene.Release();
  scene.PressPoint(4, 0, 4);
  scene.Drag(30, 0);
  scene.Key("Escape");
  scene.Release();
}

} // namespace

int TestLatticeWidgetPlayback(int argc, char* argv[])
{
  std::string file = "LatticeWidget.log";
  for (int i = 1; i + 1 < argc; ++i)
  {
    if (std::string(argv[i]) == "-T")
    {
      file = std::string(argv[i + 1]) + "/" + file;
    }
  }
  std::vector<double> acted;
  int undos = 0;
  vtkIdType selected = 0;
  {
    WidgetScene scene;
    vtkNew<vtkInteractorEventRecorder> recorder;
    recorder->SetInteractor(scene.Interactor);
    recorder->SetFileName(file.c_str());
    // Ahead of the widget, which keeps events for itself.
    recorder->SetPriority(1.0f);
    recorder->On();
    recorder->Record();
    Act(scene);
    recorder->Stop();
    recorder->Off();
    acted = scene.All();
    undos = scene.View->GetNumberOfUndos();
    selected = scene.View->GetNumberOfSelectedPoints();
    FFD_CHECK(undos == 2 && selected == 1 && !scene.Lattice->IsIdentity());
  }
  {
    WidgetScene scene;
    vtkNew<vtkInteractorEventRecorder> player;
    player->SetInteractor(scene.Interactor);
    player->SetFileName(file.c_str());
    player->On();
    player->Play();
    player->Off();
    FFD_CHECK(scene.All() == acted);
    FFD_CHECK(scene.View->GetNumberOfUndos() == undos);
    FFD_CHECK(scene.View->GetNumberOfSelectedPoints() == selected);
    FFD_CHECK(scene.Errors->Count == 0);
  }
  WidgetScene scene;
  const std::array<double, 3> at = scene.Display(scene.Point(4, 4, 4));
  // Where the recording takes hold of it.
  FFD_CHECK_NEAR(at[0], 293.0, 2.0);
  FFD_CHECK_NEAR(at[1], 242.0, 2.0);
  vtkNew<vtkInteractorEventRecorder> player;
  player->SetInteractor(scene.Interactor);
  player->ReadFromInputStringOn();
  player->SetInputString(Recording);
  player->On();
  player->Play();
  player->Off();
  // Along x by the drag, and by one nudge in the plane of the view.
  FFD_CHECK(scene.View->IsPointSelected(4, 4, 4));
  FFD_CHECK(scene.View->GetNumberOfUndos() == 2 && scene.View->GetNumberOfRedos() == 1);
  const std::array<double, 3> nudged = scene.Moved(4, 4, 4);
  scene.View->Undo();
  const std::array<double, 3> dragged = scene.Moved(4, 4, 4);
  FFD_CHECK(dragged[0] > 5.0 && dragged[1] == 0.0 && dragged[2] == 0.0);
  const double step = std::sqrt((nudged[0] - dragged[0]) * (nudged[0] - dragged[0]) +
    nudged[1] * nudged[1] + nudged[2] * nudged[2]);
  FFD_CHECK_NEAR(step, 0.05 * 50.0, 1e-9);
  scene.View->Undo();
  FFD_CHECK(scene.Lattice->IsIdentity());
  return EXIT_SUCCESS;
}
