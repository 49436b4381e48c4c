// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The mapper under every render pass of VTK, in layers, viewports, stereo, tiles and with several
// samples a pixel: what vtkFixedPointVolumeRayCastMapper draws in its place, and opaque geometry
// hides what is behind it.
#include "FFDTestScenes.h"

#include "vtkActor.h"
#include "vtkCameraPass.h"
#include "vtkClearZPass.h"
#include "vtkDefaultPass.h"
#include "vtkDepthOfFieldPass.h"
#include "vtkDepthPeelingPass.h"
#include "vtkDualDepthPeelingPass.h"
#include "vtkEDLShading.h"
#include "vtkGaussianBlurPass.h"
#include "vtkHiddenLineRemovalPass.h"
#include "vtkLightsPass.h"
#include "vtkObjectFactory.h"
#include "vtkOpaquePass.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLFXAAPass.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkOrderIndependentTranslucentPass.h"
#include "vtkOverlayPass.h"
#include "vtkPanoramicProjectionPass.h"
#include "vtkPointFillPass.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderPassCollection.h"
#include "vtkRenderState.h"
#include "vtkRenderStepsPass.h"
#include "vtkSequencePass.h"
#include "vtkShadowMapBakerPass.h"
#include "vtkShadowMapPass.h"
#include "vtkSimpleMotionBlurPass.h"
#include "vtkSobelGradientMagnitudePass.h"
#include "vtkSphereSource.h"
#include "vtkSSAAPass.h"
#include "vtkSSAOPass.h"
#include "vtkToneMappingPass.h"
#include "vtkTranslucentPass.h"
#include "vtkVolumetricPass.h"

#include <functional>
#include <string>

namespace
{

/// Of vtkSimpleMotionBlurPass: so many frames make a picture.
constexpr int SubFrames = 2;

using Pass = vtkSmartPointer<vtkRenderPass>;

/// The engine with an opaque sphere half inside of it, and a translucent one before it.
class PassScene : public ffdTest::Scene
{
public:
  PassScene(int argc, char* argv[])
    : Scene(200)
  {
    const vtkSmartPointer<vtkImageData> image =
      ffdTest::Padded(ffdTest::ReadVolume(argc, argv, "engine", 4), 0.0);
    this->SetInput(image);
    this->SetSampleDistance(0.3 * image->GetSpacing()[0]);
    ffdTest::SetTransfer(this->Property, ffdTest::SemiTransparentEngine(), 0.5);
    // A wide angle, for panoramas.
    this->SetCamera({ 30.0, 30.0, 1.0, false, false }, image->GetBounds());
    this->Renderer->GetActiveCamera()->Dolly(2.5);
    this->Renderer->GetActiveCamera()->SetViewAngle(70.0);
    double bounds[6];
    image->GetBounds(bounds);
    const double size = bounds[1] - bounds[0];
    this->AddSphere(this->Opaque, { 0.9, 0.9, 0.1 }, 0.3 * size,
      { bounds[0] + 0.1 * size, bounds[2] + 0.2 * size, bounds[4] + 0.6 * size });
    this->AddSphere(
      this->Translucent, { 0.1, 0.8, 0.9 }, 0.25 * size, { bounds[1], bounds[2], bounds[5] });
    this->Translucent->GetProperty()->SetOpacity(0.4);
    this->Renderer->ResetCameraClippingRange();
  }

  vtkNew<vtkActor> Opaque;
  vtkNew<vtkActor> Translucent;
  int Frames = 1; // that make a picture

private:
  void AddSphere(
    vtkActor* actor, const ffdTest::Vec3& color, double radius, const ffdTest::Vec3& center)
  {
    vtkNew<vtkSphereSource> sphere;
    sphere->SetRadius(radius);
    sphere->SetThetaResolution(24);
    sphere->SetPhiResolution(24);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(sphere->GetOutputPort());
    actor->SetMapper(mapper);
    actor->SetPosition(center[0], center[1], center[2]);
    actor->GetProperty()->SetColor(color[0], color[1], color[2]);
    this->Renderer->AddActor(actor);
  }
};

/// The usual steps in a framebuffer with several samples, without depths, or with several buffers
/// of colors, one of which is shown.
class FramebufferPass : public vtkRenderPass
{
public:
  static FramebufferPass* New();
  vtkTypeMacro(FramebufferPass, vtkRenderPass);

  void Render(const vtkRenderState* s) override
  {
    constexpr unsigned int ReadFramebuffer = 0x8CA8;
    constexpr unsigned int ColorBuffer = 0x4000;
    constexpr unsigned int Nearest = 0x2600;
    auto* window = vtkOpenGLRenderWindow::SafeDownCast(s->GetRenderer()->GetRenderWindow());
    vtkOpenGLState* state = window->GetState();
    int size[2];
    s->GetWindowSize(size);
    state->PushFramebufferBindings();
    this->Framebuffer->SetContext(window);
    this->Framebuffer->PopulateFramebuffer(
      size[0], size[1], true, this->Buffers, VTK_UNSIGNED_CHAR, this->Depth, 24, this->Samples);
    this->Framebuffer->Bind();
    this->Framebuffer->ActivateDrawBuffers(static_cast<unsigned int>(this->Buffers));
    vtkRenderState inside(s->GetRenderer());
    inside.SetPropArrayAndCount(s->GetPropArray(), s->GetPropArrayCount());
    inside.SetFrameBuffer(this->Framebuffer);
    this->Steps->Render(&inside);
    state->PopFramebufferBindings();
    state->PushReadFramebufferBinding();
    this->Framebuffer->Bind(ReadFramebuffer);
    this->Framebuffer->ActivateReadBuffer(static_cast<unsigned int>(this->Buffers - 1));
    state->vtkglBlitFramebuffer(
      0, 0, size[0], size[1], 0, 0, size[0], size[1], ColorBuffer, Nearest);
    state->PopReadFramebufferBinding();
  }

  void ReleaseGraphicsResources(vtkWindow* window) override
  {
    this->Framebuffer->ReleaseGraphicsResources(window);
    this->Steps->ReleaseGraphicsResources(window);
  }

  bool Depth = true;
  int Samples = 0;
  int Buffers = 1; // the last one is shown

private:
  vtkNew<vtkOpenGLFramebufferObject> Framebuffer;
  vtkNew<vtkRenderStepsPass> Steps;
};
vtkStandardNewMacro(FramebufferPass);

Pass Sequence(std::initializer_list<Pass> passes)
{
  vtkNew<vtkRenderPassCollection> collection;
  for (const Pass& pass : passes)
  {
    collection->AddItem(pass);
  }
  vtkNew<vtkSequencePass> sequence;
  sequence->SetPasses(collection);
  return sequence;
}

Pass Camera(const Pass& delegate)
{
  vtkNew<vtkCameraPass> camera;
  camera->SetDelegatePass(delegate);
  return camera;
}

template <typename PassType>
Pass Make()
{
  return vtkSmartPointer<PassType>::New();
}

/// A pass that works on the picture of VTK's usual steps.
template <typename PassType>
vtkSmartPointer<PassType> OfSteps()
{
  auto pass = vtkSmartPointer<PassType>::New();
  pass->SetDelegatePass(Make<vtkRenderStepsPass>());
  return pass;
}

/// The usual steps with another pass for translucent geometry.
Pass WithTranslucent(const Pass& translucent)
{
  return Camera(Sequence({ Make<vtkLightsPass>(), Make<vtkOpaquePass>(), translucent,
    Make<vtkVolumetricPass>(), Make<vtkOverlayPass>() }));
}

template <typename PassType>
Pass Peeling()
{
  auto peeling = vtkSmartPointer<PassType>::New();
  peeling->SetTranslucentPass(Make<vtkTranslucentPass>());
  return WithTranslucent(peeling);
}

Pass Shadows()
{
  const Pass opaque = Sequence({ Make<vtkLightsPass>(), Make<vtkOpaquePass>() });
  vtkNew<vtkShadowMapBakerPass> baker;
  baker->SetOpaqueSequence(Camera(opaque));
  baker->SetResolution(128);
  vtkNew<vtkShadowMapPass> shadows;
  shadows->SetShadowMapBakerPass(baker);
  shadows->SetOpaqueSequence(opaque);
  return Camera(Sequence({ Pass(baker), Pass(shadows), Make<vtkLightsPass>(),
    Make<vtkTranslucentPass>(), Make<vtkVolumetricPass>(), Make<vtkOverlayPass>() }));
}

Pass Blurred()
{
  const auto blur = OfSteps<vtkGaussianBlurPass>();
  vtkNew<vtkSSAAPass> ssaa;
  ssaa->SetDelegatePass(blur);
  return ssaa;
}

Pass Panorama(int type)
{
  const auto pass = OfSteps<vtkPanoramicProjectionPass>();
  pass->SetProjectionType(type);
  pass->SetAngle(90.0);
  pass->SetCubeResolution(300);
  return pass;
}

Pass InFramebuffer(bool depth, int samples)
{
  vtkNew<FramebufferPass> pass;
  pass->Depth = depth;
  pass->Samples = samples;
  return pass;
}

Pass MotionBlur()
{
  const auto pass = OfSteps<vtkSimpleMotionBlurPass>();
  pass->SetSubFrames(SubFrames);
  return pass;
}

Pass Occlusion()
{
  const auto pass = OfSteps<vtkSSAOPass>();
  pass->SetRadius(2.0);
  return pass;
}

ffdTest::Picture Show(PassScene& scene, vtkVolumeMapper* mapper)
{
  scene.Volume->SetMapper(mapper);
  for (int frame = 1; frame < scene.Frames; ++frame)
  {
    scene.Window->Render();
  }
  return scene.Render();
}

/// Ours against vtkFixedPointVolumeRayCastMapper without the opaque sphere, as that reads depths
/// from the wrong framebuffer under some passes; and how much the sphere hides of ours (`hides`).
void Check(PassScene& scene, const std::string& name, bool hides, ffdTest::Checks& checks)
{
  const ffdTest::Picture hidden = Show(scene, scene.Ours);
  scene.Ours->IntermixIntersectingGeometryOff();
  const ffdTest::Picture over = Show(scene, scene.Ours);
  scene.Ours->IntermixIntersectingGeometryOn();
  const double change = scene.Compare(hidden, over).Mean;

  scene.Opaque->VisibilityOff();
  const ffdTest::Picture ours = Show(scene, scene.Ours);
  scene.Fixed->IntermixIntersectingGeometryOff();
  const ffdTest::Picture fixed = Show(scene, scene.Fixed);
  scene.Volume->VisibilityOff();
  const ffdTest::Picture none = Show(scene, scene.Ours);
  scene.Volume->VisibilityOn();
  scene.Opaque->VisibilityOn();
  const ffdTest::Distance toFixed = scene.Compare(ours, fixed);
  const double seen = scene.Compare(ours, none).Mean;
  std::ostringstream figures;
  figures << toFixed << " from the fixed-point mapper (mean at most 2.5); the volume changes it by "
          << seen << ", and the sphere by " << change;
  checks.Expect(toFixed.Mean <= 2.5 && seen >= 2.0 && (hides ? change > 0.05 : change == 0.0), name,
    figures.str());
}

/// The volume draws into the first buffer of colors alone: vtkSSAOPass has positions and normals of
/// surfaces in the others.
void CheckOtherBuffers(PassScene& scene, ffdTest::Checks& checks)
{
  scene.Opaque->VisibilityOff();
  scene.Translucent->VisibilityOff();
  for (const int buffers : { 1, 2, 3 })
  {
    vtkNew<FramebufferPass> pass;
    pass->Buffers = buffers;
    scene.Renderer->SetPass(pass);
    const ffdTest::Picture with = Show(scene, scene.Ours);
    scene.Volume->VisibilityOff();
    const ffdTest::Distance change = scene.Compare(with, Show(scene, scene.Ours));
    scene.Volume->VisibilityOn();
    checks.Expect(buffers == 1 ? change.Mean >= 2.0 : change.Pixels == 0,
      "buffer " + std::to_string(buffers) + " of colors", ffdTest::ToString(change));
    scene.Renderer->SetPass(nullptr);
    pass->ReleaseGraphicsResources(scene.Window);
  }
}

} // namespace

int TestRenderPasses(int argc, char* argv[])
{
  ffdTest::Checks checks;
  {
    PassScene scene(argc, argv);
    CheckOtherBuffers(scene, checks);
  }
  {
    PassScene scene(argc, argv);
    Check(scene, "no pass", true, checks);
    const std::vector<std::pair<std::string, std::function<Pass()>>> passes = {
      { "vtkRenderStepsPass", Make<vtkRenderStepsPass> },
      { "vtkDefaultPass",
        [] {
          return Camera(Sequence({ Make<vtkLightsPass>(), Make<vtkDefaultPass>() }));
        } },
      { "sequence", [] { return WithTranslucent(Make<vtkTranslucentPass>()); } },
      { "vtkDepthPeelingPass", Peeling<vtkDepthPeelingPass> },
      { "vtkDualDepthPeelingPass", Peeling<vtkDualDepthPeelingPass> },
      { "vtkOrderIndependentTranslucentPass", Peeling<vtkOrderIndependentTranslucentPass> },
      { "vtkShadowMapPass", Shadows },
      { "vtkClearZPass",
        [] {
          return Camera(Sequence({ Make<vtkLightsPass>(), Make<vtkOpaquePass>(),
            Make<vtkTranslucentPass>(), Make<vtkClearZPass>(), Make<vtkVolumetricPass>() }));
        } },
      { "vtkHiddenLineRemovalPass",
        [] {
          return Camera(Sequence({ Make<vtkLightsPass>(), Make<vtkHiddenLineRemovalPass>(),
            Make<vtkTranslucentPass>(), Make<vtkVolumetricPass>() }));
        } },
      { "vtkSSAAPass", OfSteps<vtkSSAAPass> },
      { "vtkGaussianBlurPass", OfSteps<vtkGaussianBlurPass> },
      { "vtkSSAAPass of vtkGaussianBlurPass", Blurred },
      { "vtkDepthOfFieldPass", OfSteps<vtkDepthOfFieldPass> },
      { "vtkSobelGradientMagnitudePass", OfSteps<vtkSobelGradientMagnitudePass> },
      { "vtkSSAOPass", Occlusion },
      { "vtkEDLShading", OfSteps<vtkEDLShading> },
      { "vtkPointFillPass", OfSteps<vtkPointFillPass> },
      { "vtkToneMappingPass", OfSteps<vtkToneMappingPass> },
      { "vtkOpenGLFXAAPass", OfSteps<vtkOpenGLFXAAPass> },
      { "a framebuffer", [] { return InFramebuffer(true, 0); } },
      { "a framebuffer with four samples a pixel", [] { return InFramebuffer(true, 4); } },
      { "a framebuffer without depths", [] { return InFramebuffer(false, 0); } },
      { "vtkSimpleMotionBlurPass", MotionBlur },
      { "vtkPanoramicProjectionPass, equirectangular",
        [] { return Panorama(vtkPanoramicProjectionPass::Equirectangular); } },
      { "vtkPanoramicProjectionPass, azimuthal",
        [] { return Panorama(vtkPanoramicProjectionPass::Azimuthal); } },
    };
    for (const auto& each : passes)
    {
      const Pass pass = each.second();
      scene.Renderer->SetPass(pass);
      scene.Frames = each.first == "vtkSimpleMotionBlurPass" ? SubFrames : 1;
      Check(scene, each.first,
        each.first != "vtkClearZPass" && each.first != "a framebuffer without depths", checks);
      scene.Renderer->SetPass(nullptr);
      pass->ReleaseGraphicsResources(scene.Window);
    }
  }

  using Change = std::function<void(PassScene&)>;
  const auto stereo = [](int type) {
    return [type](PassScene& s) {
      s.Window->StereoRenderOn();
      s.Window->SetStereoType(type);
    };
  };
  const std::vector<std::pair<std::string, Change>> settings = {
    { "multisamples", [](PassScene& s) { s.Window->SetMultiSamples(8); } },
    { "multisamples, SSAA",
      [](PassScene& s) {
        s.Window->SetMultiSamples(8);
        s.Renderer->SetPass(OfSteps<vtkSSAAPass>());
      } },
    { "on screen", [](PassScene& s) { s.Window->SetOffScreenRendering(0); } },
    { "layers",
      [](PassScene& s) {
        vtkNew<vtkRenderer> below;
        below->SetBackground(s.Renderer->GetBackground());
        s.Window->SetNumberOfLayers(2);
        s.Window->AddRenderer(below);
        s.Renderer->SetLayer(1);
      } },
    { "FXAA", [](PassScene& s) { s.Renderer->UseFXAAOn(); } },
    { "SSAO",
      [](PassScene& s) {
        s.Renderer->UseSSAOOn();
        s.Renderer->SetSSAORadius(2.0);
      } },
    { "depth peeling", [](PassScene& s) { s.Renderer->UseDepthPeelingOn(); } },
    { "wide", [](PassScene& s) { s.Window->SetSize(300, 150); } },
    { "wide, SSAA",
      [](PassScene& s) {
        s.Window->SetSize(300, 150);
        s.Renderer->SetPass(OfSteps<vtkSSAAPass>());
      } },
    { "viewport", [](PassScene& s) { s.Renderer->SetViewport(0.5, 0.25, 1.0, 0.75); } },
    { "viewport, blur",
      [](PassScene& s) {
        s.Renderer->SetViewport(0.5, 0.25, 1.0, 0.75);
        s.Renderer->SetPass(OfSteps<vtkGaussianBlurPass>());
      } },
    { "resized",
      [](PassScene& s) {
        s.Render(s.Ours);
        s.Window->SetSize(120, 170);
      } },
    { "tile",
      [](PassScene& s) {
        s.Window->SetTileScale(2, 2);
        s.Window->SetTileViewport(0.5, 0.0, 1.0, 0.5);
      } },
    { "red blue stereo", stereo(VTK_STEREO_RED_BLUE) },
    { "anaglyph stereo", stereo(VTK_STEREO_ANAGLYPH) },
    { "interlaced stereo", stereo(VTK_STEREO_INTERLACED) },
    { "left eye", stereo(VTK_STEREO_LEFT) },
    { "right eye", stereo(VTK_STEREO_RIGHT) },
    { "Dresden stereo", stereo(VTK_STEREO_DRESDEN) },
    { "checkerboard stereo", stereo(VTK_STEREO_CHECKERBOARD) },
    { "split stereo", stereo(VTK_STEREO_SPLITVIEWPORT_HORIZONTAL) },
  };
  for (const auto& each : settings)
  {
    PassScene scene(argc, argv);
    each.second(scene);
    Check(scene, each.first, true, checks);
  }
  return checks.Result();
}
