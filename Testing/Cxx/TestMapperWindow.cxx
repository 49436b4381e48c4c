// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The mapper in windows: interactive quality, geometry, events and abort, several windows, volumes
// and viewports.
#include "FFDTestVolume.h"

#include "vtkFFDVersions.h"

#include "vtkCallbackCommand.h"
#include "vtkCameraPass.h"
#include "vtkDualDepthPeelingPass.h"
#include "vtkLightsPass.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkPixelBufferObject.h"
#include "vtkRendererDelegate.h"
#include "vtkRenderPassCollection.h"
#include "vtkSequencePass.h"
#include "vtkTextureObject.h"
#include "vtkTranslucentPass.h"
#include "vtkVolumetricPass.h"
#include VTK_FFD_OPENGL_HEADER

#include "vtksys/SystemTools.hxx"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <vector>

namespace
{

/// Rays of a frame with a frame time of 1 / rate seconds allotted.
vtkTypeInt64 RaysAt(FFDTestScene& scene, double rate)
{
  scene.Window->SetDesiredUpdateRate(rate);
  scene.Show();
  return scene.Mapper->GetStatistics()->GetNumberOfRays();
}

int TestSampleDistances()
{
  FFDTestScene scene;
  vtkFFDInverseRayVolumeMapper* m = scene.Mapper;
  vtkFFDRayStatistics* counts = m->GetStatistics();
  m->CollectStatisticsOn();
  m->SetSpaceLeapingToOff();
  scene.Show();
  const double still = static_cast<double>(RaysAt(scene, 1e-4));
  const double stillSamples = counts->GetSamplesPerRay();
  // No time at all: the coarsest image that is allowed.
  m->SetMaximumImageSampleDistance(4.0);
  const double quick = static_cast<double>(RaysAt(scene, 1e9));
  FFD_CHECK(still > 500.0 && quick > still / 30.0 && quick < still / 10.0);
  FFD_CHECK(counts->GetSamplesPerRay() < 0.7 * stillSamples); // two voxels between samples
  // Without deformation: its shorter segments are sampled once each, however large the distance.
  m->SetDeformation(nullptr);
  RaysAt(scene, 1e9);
  const double twoVoxels = counts->GetSamplesPerRay();
  m->SetInteractiveSampleDistance(6.0);
  RaysAt(scene, 1e9);
  FFD_CHECK_NEAR(counts->GetSamplesPerRay() / twoVoxels, 2.0 / 6.0, 0.08);
  m->SetDeformation(scene.Lattice);
  m->LockSampleDistanceToInputSpacingOn();
  m->SetMaximumImageSampleDistance(2.0);
  FFD_CHECK(static_cast<double>(RaysAt(scene, 1e9)) > 2.5 * quick);
  m->SetMinimumImageSampleDistance(2.0);
  FFD_CHECK(static_cast<double>(RaysAt(scene, 1e-4)) < still / 3.0);
  m->SetMinimumImageSampleDistance(1.0);
  m->AutoAdjustSampleDistancesOff();
  FFD_CHECK(static_cast<double>(RaysAt(scene, 1e9)) == still);
  m->SetImageSampleDistance(2.0);
  FFD_CHECK(static_cast<double>(RaysAt(scene, 1e9)) < still / 3.0);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

bool TestGeometry()
{
  FFDTestScene scene;
  // A cone in the middle of the ball hides what is behind it.
  scene.Cone->SetCenter(11.0, 11.0, 14.0);
  scene.Opacity->AddPoint(40.0, 0.3);
  const std::vector<unsigned char> with = scene.Show();
  scene.Mapper->IntermixIntersectingGeometryOff();
  const std::vector<unsigned char> without = scene.Show();
  scene.Mapper->IntermixIntersectingGeometryOn();
  return FFDLargestDifference(with, without) > 20 && FFDLargestDifference(with, scene.Show()) == 0;
}

/// Draws a cone that its renderer does not know, and a volume.
class ConeDelegate : public vtkRendererDelegate
{
public:
  static ConeDelegate* New() { VTK_STANDARD_NEW_BODY(ConeDelegate); }
  vtkTypeMacro(ConeDelegate, vtkRendererDelegate);

  void Render(vtkRenderer* renderer) override
  {
    renderer->GetActiveCamera()->Render(renderer);
    this->Cone->RenderOpaqueGeometry(renderer);
    this->Volume->RenderVolumetricGeometry(renderer);
  }

  vtkActor* Cone = nullptr;
  vtkVolume* Volume = nullptr;
};

/// The cone hides the volume, too, where it was drawn by another renderer, or before the picture
/// was last erased.
int TestGeometryOfOthers()
{
  FFDTestScene scene;
  scene.Cone->SetCenter(11.0, 11.0, 14.0);
  scene.Opacity->AddPoint(40.0, 0.3);
  const std::vector<unsigned char> wanted = scene.Show();
  scene.ConeActor->VisibilityOff();
  const std::vector<unsigned char> without = scene.Show();
  FFD_CHECK(FFDLargestDifference(wanted, without) > 20);

  vtkNew<vtkRenderer> other;
  other->SetActiveCamera(scene.Renderer->GetActiveCamera());
  other->SetBackground(scene.Renderer->GetBackground());
  scene.Renderer->RemoveActor(scene.ConeActor);
  scene.ConeActor->VisibilityOn();
  other->AddActor(scene.ConeActor);
  scene.Window->SetNumberOfLayers(2);
  scene.Window->AddRenderer(other);
  other->SetLayer(0);
  scene.Renderer->SetLayer(1);
  const int over = FFDLargestDifference(wanted, scene.Show());
  scene.Renderer->PreserveDepthBufferOn();
  FFD_CHECK(over > 20 && FFDLargestDifference(wanted, scene.Show()) == 0);

  scene.Renderer->PreserveDepthBufferOff();
  scene.Renderer->EraseOff();
  FFD_CHECK(FFDLargestDifference(wanted, scene.Show()) == 0);

  // The window, too, may leave what it shows; and a delegate draws what it likes.
  FFDTestScene last;
  last.Cone->SetCenter(11.0, 11.0, 14.0);
  last.Opacity->AddPoint(40.0, 0.3);
  last.Volume->VisibilityOff();
  last.Show();
  last.ConeActor->VisibilityOff();
  last.Volume->VisibilityOn();
  last.Window->EraseOff();
  FFD_CHECK(FFDLargestDifference(wanted, last.Show()) == 0);
  last.Window->EraseOn();
  vtkNew<ConeDelegate> delegate;
  delegate->Cone = last.ConeActor;
  delegate->Volume = last.Volume;
  delegate->UsedOn();
  last.Renderer->RemoveActor(last.ConeActor);
  last.ConeActor->VisibilityOn();
  last.Renderer->SetDelegate(delegate);
  FFD_CHECK(FFDLargestDifference(wanted, last.Show()) == 0);
  last.Renderer->SetDelegate(nullptr);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// Depth peeling of volumes is for VTK's GPU mapper: an error, and the picture without the volume.
int TestPeeling()
{
  FFDTestScene scene;
  scene.ConeActor->GetProperty()->SetOpacity(0.5);
  scene.Renderer->UseDepthPeelingOn();
  const std::vector<unsigned char> both = scene.Show();
  FFD_CHECK(scene.Errors->Count == 0);
  scene.Renderer->UseDepthPeelingForVolumesOn();
  const std::vector<unsigned char> refused = scene.Show();
  FFD_CHECK(scene.Errors->Had("UseDepthPeelingForVolumesOff()"));
  FFD_CHECK(FFDLargestDifference(both, refused) > 20);
  scene.Volume->VisibilityOff();
  FFD_CHECK(FFDLargestDifference(refused, scene.Show()) == 0);
  scene.Volume->VisibilityOn();
  // Without translucent surfaces nothing is peeled.
  scene.ConeActor->VisibilityOff();
  const std::vector<unsigned char> alone = scene.Show();
  scene.Renderer->UseDepthPeelingForVolumesOff();
  FFD_CHECK(FFDLargestDifference(alone, scene.Show()) == 0);
  scene.ConeActor->VisibilityOn();
  FFD_CHECK(FFDLargestDifference(both, scene.Show()) == 0);
  FFD_CHECK(scene.Errors->Count == 0);
  // A pass of the application's own peels volumes whatever that flag says.
  vtkNew<vtkDualDepthPeelingPass> peeling;
  vtkNew<vtkTranslucentPass> translucent;
  vtkNew<vtkVolumetricPass> volumetric;
  peeling->SetTranslucentPass(translucent);
  peeling->SetVolumetricPass(volumetric);
  vtkNew<vtkRenderPassCollection> passes;
  passes->AddItem(vtkNew<vtkLightsPass>());
  passes->AddItem(peeling);
  vtkNew<vtkSequencePass> sequence;
  sequence->SetPasses(passes);
  vtkNew<vtkCameraPass> camera;
  camera->SetDelegatePass(sequence);
  scene.Renderer->SetPass(camera);
  FFD_CHECK(FFDLargestDifference(refused, scene.Show()) == 0);
  FFD_CHECK(scene.Errors->Had("vtkDualDepthPeelingPass"));
  return EXIT_SUCCESS;
}

struct EventLog
{
  int Start = 0;
  int Progress = 0;
  int End = 0;
  int Checks = 0;
  bool AbortMapper = false;
  bool AbortWindow = false;
};

void CountEvent(vtkObject* caller, unsigned long event, void* client, void*)
{
  auto* log = static_cast<EventLog*>(client);
  log->Start += event == vtkCommand::VolumeMapperRenderStartEvent ? 1 : 0;
  log->End += event == vtkCommand::VolumeMapperRenderEndEvent ? 1 : 0;
  if (event == vtkCommand::VolumeMapperRenderProgressEvent)
  {
    ++log->Progress;
    if (log->AbortMapper)
    {
      vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
    }
  }
  if (event == vtkCommand::AbortCheckEvent)
  {
    ++log->Checks;
    if (log->AbortWindow)
    {
      vtkRenderWindow::SafeDownCast(caller)->SetAbortRender(1);
    }
  }
}

int TestEventsAndAbort()
{
  FFDTestScene scene;
  scene.Mapper->CollectStatisticsOn();
  EventLog log;
  vtkNew<vtkCallbackCommand> command;
  command->SetCallback(CountEvent);
  command->SetClientData(&log);
  scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderStartEvent, command);
  scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderProgressEvent, command);
  scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderEndEvent, command);
  const std::vector<unsigned char> whole = scene.Show();
  // With statistics once for each group of tiles.
  FFD_CHECK(log.Start == 1 && log.End == 1 && log.Progress >= 4);
  const int all = log.Progress;
  const double progress = scene.Mapper->GetProgress();
  FFD_CHECK(progress == 1.0);

  const std::vector<unsigned char> image = scene.Render();
  log = EventLog();
  log.AbortMapper = true;
  FFD_CHECK(scene.Render().empty()); // refused without an error
  FFD_CHECK(scene.Errors->Count == 0);
  FFD_CHECK(log.Start == 1 && log.End == 1 && log.Progress < all);
  log.AbortMapper = false;
  FFD_CHECK(FFDLargestDifference(image, scene.Render()) == 0);

  scene.Window->AddObserver(vtkCommand::AbortCheckEvent, command);
  log = EventLog();
  log.AbortWindow = true;
  // VTK asks five times a second at most.
  vtksys::SystemTools::Delay(300);
  scene.Show();
  FFD_CHECK(log.Checks > 0 && log.Progress < all);
  log.AbortWindow = false;
  FFD_CHECK(FFDLargestDifference(whole, scene.Show()) == 0);
  return EXIT_SUCCESS;
}

bool TestWindows()
{
  FFDTestScene scene;
  const std::vector<unsigned char> first = scene.Show();
  // Released and shown again, twice; then in a new window.
  scene.Mapper->ReleaseGraphicsResources(scene.Window);
  scene.Mapper->ReleaseGraphicsResources(scene.Window);
  bool ok = FFDLargestDifference(first, scene.Show()) == 0;
  scene.Window->RemoveRenderer(scene.Renderer);
  scene.Window = nullptr;
  ok &= FFDLargestDifference(first, scene.Show()) == 0;

  // One mapper in two windows, by turns.
  vtkNew<vtkVolume> again;
  again->SetMapper(scene.Mapper);
  again->SetProperty(scene.Property);
  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(again);
  renderer->SetActiveCamera(scene.Renderer->GetActiveCamera());
  vtkNew<vtkRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetOffScreenRendering(1);
  window->SetSize(80, 80);
  window->AddRenderer(renderer);
  const auto second = [&] {
    window->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    window->GetPixelData(0, 0, 79, 79, 0, pixels);
    const unsigned char* p = pixels->GetPointer(0);
    return std::vector<unsigned char>(p, p + pixels->GetNumberOfValues());
  };
  scene.ConeActor->VisibilityOff();
  const std::vector<unsigned char> plain = scene.Show();
  for (int turn = 0; turn < 2; ++turn)
  {
    ok &= FFDLargestDifference(plain, second()) == 0;
    ok &= FFDLargestDifference(plain, scene.Show()) == 0;
  }

  // Two viewports show what each shows alone, at half the width.
  scene.Window->SetSize(160, 80);
  scene.Renderer->SetViewport(0.0, 0.0, 0.5, 1.0);
  vtkNew<vtkRenderer> right;
  right->SetViewport(0.5, 0.0, 1.0, 1.0);
  vtkNew<vtkVolume> copy;
  copy->SetMapper(scene.Mapper);
  copy->SetProperty(scene.Property);
  right->AddVolume(copy);
  right->SetActiveCamera(scene.Renderer->GetActiveCamera());
  scene.Window->AddRenderer(right);
  scene.Window->Render();
  for (int side = 0; side < 2; ++side)
  {
    vtkNew<vtkUnsignedCharArray> pixels;
    scene.Window->GetPixelData(80 * side, 0, 80 * side + 79, 79, 0, pixels);
    const unsigned char* p = pixels->GetPointer(0);
    ok &= FFDLargestDifference(
            plain, std::vector<unsigned char>(p, p + pixels->GetNumberOfValues())) == 0;
  }
  return ok && scene.Errors->Count == 0;
}

bool TestTwoVolumes()
{
  FFDTestScene scene;
  const std::vector<unsigned char> one = scene.Show();
  vtkNew<vtkFFDInverseRayVolumeMapper> mapper;
  mapper->SetInputData(scene.Image);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->SetProperty(scene.Property);
  volume->SetPosition(12.0, -6.0, 4.0);
  scene.Renderer->AddVolume(volume);
  const std::vector<unsigned char> two = scene.Show();
  int brighter = 0;
  for (std::size_t i = 0; i < one.size(); ++i)
  {
    brighter += two[i] > one[i] + 5 ? 1 : 0;
  }
  scene.Renderer->RemoveVolume(volume);
  return brighter > 300 && FFDLargestDifference(one, scene.Show()) == 0;
}

/// Colors are not rounded to bytes in a target of floats, which an observer of the start may put in
/// the place of that of the window.
bool TestFloats()
{
  FFDTestScene scene;
  scene.Show();
  constexpr unsigned int size = 64;
  scene.Window->SetSize(size, size);
  scene.Show();
  struct Target
  {
    vtkSmartPointer<vtkOpenGLRenderWindow> Window;
    vtkNew<vtkTextureObject> Floats;
    vtkSmartPointer<vtkTextureObject> Bytes;

    static void Set(vtkObject*, unsigned long, void* self, void*)
    {
      auto* const target = static_cast<Target*>(self);
      vtkOpenGLFramebufferObject* const frame = target->Window->GetRenderFramebuffer();
      target->Bytes = frame->GetColorAttachmentAsTextureObject(0);
      target->Floats->SetContext(target->Window);
      std::vector<float> zeros(std::size_t{ 4 } * size * size);
      target->Floats->Create2DFromRaw(size, size, 4, VTK_FLOAT, zeros.data());
      frame->AddColorAttachment(0, target->Floats);
    }
    static void Restore(vtkObject*, unsigned long, void* self, void*)
    {
      auto* const target = static_cast<Target*>(self);
      target->Window->GetRenderFramebuffer()->AddColorAttachment(0, target->Bytes);
    }
  } target;
  target.Window = vtkOpenGLRenderWindow::SafeDownCast(scene.Window);
  vtkNew<vtkCallbackCommand> set;
  set->SetClientData(&target);
  set->SetCallback(&Target::Set);
  scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderStartEvent, set);
  vtkNew<vtkCallbackCommand> restore;
  restore->SetClientData(&target);
  restore->SetCallback(&Target::Restore);
  scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderEndEvent, restore);
  scene.Show();
  std::vector<float> pixels(std::size_t{ 4 } * size * size);
  const vtkSmartPointer<vtkPixelBufferObject> buffer =
    vtkSmartPointer<vtkPixelBufferObject>::Take(target.Floats->Download());
  unsigned int dimensions[2] = { size, size };
  vtkIdType increments[2] = { 0, 0 };
  const bool read = buffer->Download2D(VTK_FLOAT, pixels.data(), dimensions, 4, increments);
  target.Floats->ReleaseGraphicsResources(scene.Window);
  return read && std::any_of(pixels.begin(), pixels.end(), [](float value) {
    const float bytes = 255.0f * value;
    return std::abs(bytes - std::round(bytes)) > 0.2f;
  });
}

/// Another user of the context may leave its pixel transfers as it likes, and a part of the depths
/// for what is drawn.
bool TestStateOfOthers()
{
  struct OpenGLScene : FFDTestScene
  {
    vtkOpenGLState* GetState() const
    {
      return vtkOpenGLRenderWindow::SafeDownCast(this->Window)->GetState();
    }
  } scene;
  scene.Cone->SetCenter(11.0, 11.0, 14.0);
  scene.Opacity->AddPoint(40.0, 0.3);
  scene.Show();
  struct Case
  {
    const char* Name;
    std::function<void()> Begin;
    std::function<void()> End;
  };
  std::vector<Case> cases = { { "nothing", [] {}, [] {} },
    { "a part of the depths", [] { glDepthRangef(0.2f, 0.7f); },
      [] { glDepthRangef(0.0f, 1.0f); } } };
  for (GLenum parameter :
    { GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS, GL_PACK_SWAP_BYTES,
      GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SWAP_BYTES })
  {
    cases.push_back({ "pixels in memory",
      [&scene, parameter] { scene.GetState()->vtkglPixelStorei(parameter, 1); },
      [&scene, parameter] { scene.GetState()->vtkglPixelStorei(parameter, 0); } });
  }
  GLuint buffer = 0;
  for (GLenum target : { GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER })
  {
    cases.push_back({ "a buffer of pixels",
      [target, &buffer] {
        glGenBuffers(1, &buffer);
        glBindBuffer(target, buffer);
        glBufferData(target, 1 << 20, nullptr, GL_STREAM_DRAW);
      },
      [target, &buffer] {
        glBindBuffer(target, 0);
        glDeleteBuffers(1, &buffer);
      } });
  }
  vtkCamera* const camera = scene.Renderer->GetActiveCamera();
  std::vector<unsigned char> expected;
  bool ok = true;
  for (const Case& each : cases)
  {
    camera->Azimuth(60.0);
    scene.Show();
    camera->Azimuth(-60.0);
    each.Begin();
    scene.Window->Render();
    each.End();
    vtkNew<vtkUnsignedCharArray> pixels;
    scene.Window->GetPixelData(0, 0, 79, 79, 0, pixels);
    const unsigned char* p = pixels->GetPointer(0);
    const std::vector<unsigned char> picture(p, p + pixels->GetNumberOfValues());
    expected = expected.empty() ? picture : expected;
    const int difference = FFDLargestDifference(picture, expected);
    // Of a part of the depths fewer bits are left.
    if (difference > (&each == &cases[1] ? 2 : 0))
    {
      std::cerr << each.Name << " (" << &each - cases.data() << "): difference " << difference
                << "\n";
      ok = false;
    }
  }
  return ok;
}

} // namespace

int TestMapperWindow(int, char*[])
{
  FFD_CHECK(TestSampleDistances() == EXIT_SUCCESS);
  FFD_CHECK(TestGeometry());
  FFD_CHECK(TestGeometryOfOthers() == EXIT_SUCCESS);
  FFD_CHECK(TestPeeling() == EXIT_SUCCESS);
  FFD_CHECK(TestEventsAndAbort() == EXIT_SUCCESS);
  FFD_CHECK(TestWindows());
  FFD_CHECK(TestTwoVolumes());
  FFD_CHECK(TestFloats());
  FFD_CHECK(TestStateOfOthers());
  return EXIT_SUCCESS;
}
