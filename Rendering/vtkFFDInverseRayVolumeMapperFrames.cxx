// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The frames of vtkFFDInverseRayVolumeMapper: in windows, for selectors, as images; rays and
// points.
#include "vtkFFDInverseRayVolumeMapperInternals.h"

#include "vtkFFDFramebuffer.h"
#include "vtkFFDFrameOutput.h"
#include "vtkFFDFrameScene.h"
#include "vtkFFDGuard.h"
#include "vtkFFDParallelFor.h"
#include "vtkFFDProbeView.h"
#include "vtkFFDTracedRays.h"
#include "vtkFFDViewFromRenderer.h"

#include "FFDRayCaster.h"
#include "FFDSingularMatrix.h"

#include "vtkCamera.h"
#include "vtkDataArray.h"
#include "vtkHardwareSelector.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseVectorKey.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMatrix4x4.h"
#include "vtkOpenGLRenderPass.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkSmartPointer.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace
{

constexpr int LargestImageSide = 16384;

/// Memory of a pixel while an image is made: colors as bytes and depths as floats, here and there.
constexpr double BytesPerPixel = 16.0;

/// Whether a pass of depth peeling asks for the volume between translucent surfaces: it wants the
/// shader of the volume changed, and what is drawn without that is not a picture.
bool IsPeeled(vtkVolume* volume)
{
  vtkInformation* keys = volume->GetPropertyKeys();
  vtkInformationObjectBaseVectorKey* passes = vtkOpenGLRenderPass::RenderPasses();
  if (!keys || !keys->Has(passes))
  {
    return false;
  }
  for (int i = 0; i < passes->Length(keys); ++i)
  {
    if (passes->Get(keys, i)->IsA("vtkDepthPeelingPass"))
    {
      return true;
    }
  }
  return false;
}

/// Whether anything may have been drawn in the window before a volume, as far as can be told: to
/// read the depth buffer takes time, and waits for all that was asked of OpenGL.
bool MayBeHidden(vtkRenderer* renderer, vtkVolume* volume)
{
  // A renderer of this class clears depths and draws its props, unless it is told otherwise.
  vtkRenderWindow* window = renderer->GetRenderWindow();
  const bool usual = renderer->GetClassName() == std::string("vtkOpenGLRenderer") &&
    renderer->GetErase() && (!window || window->GetErase()) &&
    !renderer->GetPreserveDepthBuffer() && !renderer->GetPass() && !renderer->GetDelegate();
  if (!usual)
  {
    return true;
  }
  vtkPropCollection* props = renderer->GetViewProps();
  vtkCollectionSimpleIterator at;
  props->InitTraversal(at);
  while (vtkProp* prop = props->GetNextProp(at))
  {
    if (prop != volume && prop->GetVisibility())
    {
      return true;
    }
  }
  return false;
}

} // namespace

//------------------------------------------------------------------------------
bool vtkFFDInverseRayVolumeMapper::vtkInternals::Update(
  vtkVolumeProperty* property, std::string& message)
{
  ffd::StageTools tools;
  tools.Parallel = this->MakeParallelFor();
  const bool ok = this->Cache.Update(this->Self, property, tools);
  message = tools.Message;
  return ok;
}

//------------------------------------------------------------------------------
/// Update everything for the frame in progress. False after an error or, without a message, an
/// abort. What observers of the progress change meanwhile is part of the frame, what they change
/// later is not.
bool vtkFFDInverseRayVolumeMapper::vtkInternals::Prepare(vtkVolume* volume, std::string& message)
{
  try
  {
    this->Self->Update();
    this->Quiet = false;
    bool ok = this->Update(volume->GetProperty(), message);
    if (this->Frame->HasReported())
    {
      this->Quiet = true;
      message.clear();
      ok = this->Update(volume->GetProperty(), message);
    }
    this->Prepared = ok;
  }
  catch (const vtkFFDFrame::Aborted&)
  {
    return false;
  }
  if (this->Prepared)
  {
    this->Frame->Hold(this->Cache.GetArrays());
  }
  return this->Prepared;
}

//------------------------------------------------------------------------------
/// Whether a frame is in progress, with an error that tells so.
bool vtkFFDInverseRayVolumeMapper::vtkInternals::Refuse(const char* what) const
{
  if (this->Frame)
  {
    vtkErrorWithObjectMacro(
      this->Self, << what
                  << " was called while the mapper renders, by an observer of its events: that is "
                     "not possible. "
                     "Call it after the frame, as in an observer of the render window's EndEvent.");
  }
  return this->Frame != nullptr;
}

//------------------------------------------------------------------------------
vtkFFDParallelFor vtkFFDInverseRayVolumeMapper::vtkInternals::MakeParallelFor() const
{
  vtkFFDParallelFor::Listener listener;
  if (vtkFFDFrame* frame = this->Quiet || this->Prepared ? nullptr : this->Frame)
  {
    listener = { [frame] { return frame->GetNextReport(); },
      [frame](double part) { frame->ReportPreparation(part); } };
  }
  return vtkFFDParallelFor(this->Self->NumberOfThreads, std::move(listener));
}

//------------------------------------------------------------------------------
/// False, with an error, for an image of no such size, and where an observer of a frame calls.
bool vtkFFDInverseRayVolumeMapper::vtkInternals::CanMakeImage(
  const char* method, int width, int height) const
{
  if (width < 1 || height < 1 || width > LargestImageSide || height > LargestImageSide)
  {
    vtkErrorWithObjectMacro(this->Self, << method << ": an image of " << width << " x " << height
                                        << " pixels was asked for; each side must be from 1 to "
                                        << LargestImageSide << ".");
    return false;
  }
  return !this->Refuse((std::string(method) + "()").c_str());
}

//------------------------------------------------------------------------------
bool vtkFFDInverseRayVolumeMapper::vtkInternals::CheckView(
  vtkRenderer* renderer, vtkVolume* volume, std::string& message)
{
  volume->ComputeMatrix();
  if (ffd::IsSingular(glm::dmat3(ffd::ToMatrix(volume->GetMatrix()))))
  {
    message = "The matrix of the volume is singular or not a number: it has no inside to render. "
              "Check its scale.";
    return false;
  }
  const ffd::CameraView camera =
    ffd::MakeCameraView(renderer, vtkFFDImageRegion(glm::ivec2(1)), glm::dmat4(1.0));
  const ffd::ViewRay ray = camera.MakeRay(0.5, 0.5);
  if (!std::isfinite(glm::dot(ray.Origin, ray.Origin)) || !(ray.Far > 0.0) ||
    !std::isfinite(ray.Far))
  {
    message = "The camera of the renderer has no viewing ray: its position, focal point, scale or "
              "clipping range is not a number or makes the projection singular. Check them, or "
              "call ResetCamera().";
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
/// Sees to it that the picture of the window can be drawn again if the next frame in a window,
/// which is to be begun, is aborted: the caster makes that of its last one of the kind.
void vtkFFDInverseRayVolumeMapper::vtkInternals::KeepPicture(bool reuses, bool moving)
{
  if (this->Shown.Complete && !(reuses && moving))
  {
    this->Last = this->Shown;
  }
  this->Shown.Complete = false;
  vtkFFDFrameCaster::Picture& next = this->Caster.GetPicture();
  if (this->Last.Picture != &next)
  {
    return;
  }
  if (reuses)
  {
    this->LastPicture = next;
  }
  else
  {
    std::swap(this->LastPicture, next);
  }
  this->Last.Picture = &this->LastPicture;
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::vtkInternals::ReleaseImages()
{
  this->Caster.ReleaseImages();
  this->LastPicture = vtkFFDFrameCaster::Picture();
  std::vector<float>().swap(this->VisibleDepths);
  this->Shown = View();
  this->Last = View();
}

//------------------------------------------------------------------------------
/// Changes with what a frame is made from.
vtkMTimeType vtkFFDInverseRayVolumeMapper::vtkInternals::FindSceneTime(vtkVolume* volume) const
{
  return std::max(this->Self->GetMTime(), volume->GetMTime());
}

//------------------------------------------------------------------------------
bool vtkFFDInverseRayVolumeMapper::PreLoadData(vtkRenderer*, vtkVolume* volume)
{
  if (!volume)
  {
    vtkErrorMacro(<< "PreLoadData: the volume is null.");
    return false;
  }
  if (this->Internals->Refuse("PreLoadData()"))
  {
    return false;
  }
  this->Update();
  std::string message;
  if (!this->Internals->Update(volume->GetProperty(), message))
  {
    vtkErrorMacro(<< message);
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDInverseRayVolumeMapper::MakeProbeView(vtkFFDProbeView& view)
{
  vtkInternals& in = *this->Internals;
  if (in.Frame && !in.Prepared && in.Refuse("A look at the volume"))
  {
    return false;
  }
  // During a frame it is that of the frame.
  if (!in.Frame)
  {
    this->Update();
    ffd::StageTools tools;
    tools.Parallel = in.MakeParallelFor();
    bool known = false;
    if (!vtkFFDGuard(this, "The volume", [&] { known = in.Cache.UpdateProbe(this, tools); }))
    {
      return false;
    }
    if (!known)
    {
      vtkErrorMacro(<< tools.Message);
      return false;
    }
  }
  const vtkFFDFrameCache& cache = in.Cache;
  view.Crop = cache.GetCropping();
  view.Volume = cache.GetVolume();
  view.Hidden = cache.GetHidden();
  view.Mask = cache.GetMask();
  view.Map = cache.GetPullBack().Map;
  view.OneToOne = cache.GetPullBack().Bounds.IsProvenInvertible();
  // A little more than the bounds: a ray is to be seen coming in through a face that lies on them.
  const double margin = 0.01 * cache.GetVoxelSize();
  const double* clip = this->ClipBox;
  const ffd::Box& deformed = cache.GetPullBack().DeformedBounds;
  view.Deformed = { glm::max(deformed.Min - margin, glm::dvec3(clip[0], clip[2], clip[4])),
    glm::min(deformed.Max + margin, glm::dvec3(clip[1], clip[3], clip[5])) };
  return true;
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::Render(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkFFDGuard(this, "Render", [&] { this->RenderInWindow(renderer, volume); });
}

//------------------------------------------------------------------------------
/// Whether there is something to render now; with an error where that is not possible.
bool vtkFFDInverseRayVolumeMapper::vtkInternals::CanRender(vtkRenderer* renderer, vtkVolume* volume)
{
  if (!renderer || !volume)
  {
    vtkErrorWithObjectMacro(this->Self, << "Render needs a renderer and a volume; the "
                                        << (renderer ? "volume" : "renderer") << " is null.");
    return false;
  }
  vtkHardwareSelector* selector = renderer->GetSelector();
  // Render passes do not look at whether a prop can be picked.
  if (selector && (!volume->GetPickable() || !vtkFFDIsPassRead(selector)))
  {
    return false;
  }
  if (IsPeeled(volume))
  {
    // A frame has several passes.
    if (!this->ToldOfPeeling)
    {
      vtkErrorWithObjectMacro(this->Self,
        "UseDepthPeelingForVolumes of the renderer is on, or its pass has a "
        "vtkDualDepthPeelingPass "
        "with a volumetric pass, but only VTK's GPU mapper can be peeled together with translucent "
        "surfaces: the volume is left out. Call UseDepthPeelingForVolumesOff() of the renderer, or "
        "give the vtkVolumetricPass to a sequence, after the peeling.");
    }
    this->ToldOfPeeling = true;
    return false;
  }
  this->ToldOfPeeling = false;
  return !this->Refuse("Render()");
}

//------------------------------------------------------------------------------
/// The part of the viewport for which a picture is made, of one ray a pixel. `viewport`: its place
/// in the framebuffer.
vtkFFDImageRegion vtkFFDInverseRayVolumeMapper::vtkInternals::FindRegion(
  vtkRenderer* renderer, vtkVolume* volume, const vtkFFDImageRegion& whole, const int viewport[4])
{
  vtkHardwareSelector* selector = renderer->GetSelector();
  if (!selector && this->Self->RendersToImage)
  {
    return whole;
  }
  vtkFFDImageRegion region = vtkFFDFramePlan::FindRegion(
    vtkFFDFrameScene::FindVisibleBounds(this->Self, this->Cache), renderer, volume, whole);
  if (selector)
  {
    unsigned int area[4];
    selector->GetArea(area);
    const glm::ivec2 corner(viewport[0], viewport[1]);
    const glm::ivec2 first = glm::max(glm::ivec2(area[0], area[1]) - corner, region.Origin);
    const glm::ivec2 last =
      glm::min(glm::ivec2(area[2], area[3]) - corner, region.Origin + region.Rays - 1);
    region.Origin = first;
    region.Rays = last - first + 1;
  }
  return region;
}

//------------------------------------------------------------------------------
/// The depths of what is drawn already, one a ray; null where nothing is that hides the volume.
const float* vtkFFDInverseRayVolumeMapper::vtkInternals::FindDepths(vtkRenderer* renderer,
  vtkVolume* volume, const vtkFFDImageRegion& region, const glm::ivec2& pixels,
  const int viewport[4])
{
  if (!this->Self->IntermixIntersectingGeometry || !MayBeHidden(renderer, volume))
  {
    return nullptr;
  }
  const int rectangle[4] = { viewport[0] + region.Origin.x, viewport[1] + region.Origin.y, pixels.x,
    pixels.y };
  std::vector<float>& all = this->Caster.GetWindowDepths();
  all.resize(static_cast<std::size_t>(pixels.x) * static_cast<std::size_t>(pixels.y));
  const bool read = vtkFFDFramebuffer::ReadDepths(renderer, rectangle, all.data());
  // A depth buffer without opaque geometry stops no ray.
  if (!read || std::none_of(all.begin(), all.end(), [](float depth) { return depth < 1.0f; }))
  {
    return nullptr;
  }
  return region.Step != 1.0 ? this->Caster.FindRayDepths(region, pixels) : all.data();
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::RenderInWindow(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkInternals& in = *this->Internals;
  if (!in.CanRender(renderer, volume))
  {
    return;
  }
  vtkFFDFrame frame(in.Frame, this, renderer, volume, renderer->GetRenderWindow());
  frame.SetReportsProgress(this->ReportProgress);
  in.Prepared = false;
  std::string message;
  if (!in.Prepare(volume, message) || !in.CheckView(renderer, volume, message))
  {
    if (!message.empty())
    {
      vtkErrorMacro(<< message);
    }
    return;
  }

  // A render pass may draw into a framebuffer of its own, but surfaces keep the aspect ratio.
  int viewport[4];
  vtkFFDFramebuffer::FindViewport(renderer, viewport);
  if (viewport[2] < 1 || viewport[3] < 1)
  {
    return;
  }
  const double prepared = frame.GetSeconds();
  vtkFFDImageRegion whole(glm::ivec2(viewport[2], viewport[3]));
  whole.Aspect = renderer->GetTiledAspectRatio();
  whole.Stereo = true;
  vtkFFDImageRegion region = in.FindRegion(renderer, volume, whole, viewport);
  glm::ivec2 pixels = region.Rays;
  if (pixels.x < 1 || pixels.y < 1)
  {
    return;
  }
  // Else it is for a selector or an image.
  const bool shown = !renderer->GetSelector() && !this->RendersToImage;
  const bool interactive = in.Plan.PlaceRays(this, volume, shown, region);
  const bool reuses = shown && in.Caster.CanReuse(volume);
  const bool moving = vtkFFDFramePlan::IsMoving(this, volume);
  using Purpose = vtkFFDFrameCaster::Purpose;
  in.Caster.Begin(!shown ? Purpose::Other : reuses && !moving ? Purpose::Still : Purpose::Moving);
  if (reuses && moving)
  {
    in.Caster.GetCoherence().Align(region);
    pixels = glm::min(glm::ivec2(glm::ceil(glm::dvec2(region.Rays) * region.Step)),
      region.Viewport - region.Origin);
  }
  const float* depths = in.FindDepths(renderer, volume, region, pixels, viewport);
  float* visibleDepths = nullptr;
  if (!shown)
  {
    in.VisibleDepths.resize(
      static_cast<std::size_t>(region.Rays.x) * static_cast<std::size_t>(region.Rays.y));
    visibleDepths = in.VisibleDepths.data();
  }
  vtkInternals::View view;
  view.Renderer = renderer;
  view.Volume = volume;
  view.Region = region;
  view.DataToNdc =
    ffd::MakeCameraView(renderer, whole, ffd::ToMatrix(volume->GetMatrix())).DataToNdc;
  if (shown)
  {
    in.KeepPicture(reuses, moving);
  }

  const vtkMTimeType sceneTime = in.FindSceneTime(volume);
  vtkFFDFrameCaster::View cast;
  cast.Renderer = renderer;
  cast.Volume = volume;
  cast.Region = region;
  cast.Interactive = interactive;
  cast.InWindow = shown;
  cast.IsDrawn = shown || renderer->GetSelector();
  cast.HasTimeEstimate = in.Plan.HasTimeEstimate();
  cast.SettingsTime = this->GetSettingsTime();
  // Layers are interpolated as floats.
  const bool layered = shown && depths && region.Step > 1.0;
  if (shown && !layered)
  {
    cast.AsBytes = [renderer] { return vtkFFDFramebuffer::DrawsBytes(renderer); };
  }
  if (shown)
  {
    vtkFFDFramebuffer::Flush(renderer);
  }
  const bool done = in.Caster.Cast(frame, cast, depths, visibleDepths);
  vtkFFDImageDisplay::Layers layers;
  if (done && layered && in.FindSceneTime(volume) == sceneTime)
  {
    layers = in.Caster.CastLayers(cast, pixels);
  }
  view.Complete = done;
  view.Visible = in.Caster.GetVisible();
  view.Picture = &in.Caster.GetPicture();
  if (!shown)
  {
    if (done)
    {
      in.PassOnPicture(view);
    }
    return;
  }
  const double total = frame.GetSeconds();
  const double seconds = total - prepared;
  // Levels of detail are chosen by the time that the volume takes: a still picture that is shown
  // again was cast in that of the last frame.
  const bool again = done && !moving && in.Caster.GetReusedFraction() > 0.0;
  this->TimeToDraw = again ? std::max(this->TimeToDraw, seconds) : seconds;
  if (done)
  {
    in.Shown = view;
  }
  const double preparation = prepared + in.Caster.GetPreparationTime();
  in.Plan.RecordFrame(this, in.Cache,
    { preparation, total - preparation, done ? 1.0 : frame.GetCastPart(), region.Step, interactive,
      in.Caster.GetReusedFraction() });
  // After an abort the last picture: the window may be read before the next frame is there.
  if (done || in.Last.IsSameAs(view))
  {
    in.Draw(done ? view : in.Last, layers);
  }
}

//------------------------------------------------------------------------------
/// Takes up a picture that is not shown: draws what a selector asks for, or keeps an image.
void vtkFFDInverseRayVolumeMapper::vtkInternals::PassOnPicture(const View& view)
{
  const vtkFFDImageRegion& region = view.Region;
  const ffd::CameraView camera =
    ffd::MakeCameraView(view.Renderer, region, ffd::ToMatrix(view.Volume->GetMatrix()));
  std::vector<float>& colors = this->Caster.GetPicture().Floats;
  if (vtkHardwareSelector* selector = view.Renderer->GetSelector())
  {
    // An observer may have taken the input away.
    if (this->Self->GetInput())
    {
      vtkFFDPaintIdentifiers(
        selector, this->Self, this->Cache, camera, this->VisibleDepths, colors);
      this->Draw(view, vtkFFDImageDisplay::Layers());
    }
    return;
  }
  if (this->Self->ClampDepthToBackface)
  {
    vtkFFDMoveToBackface(this->Self, this->Cache, camera, colors, this->VisibleDepths);
  }
  vtkFFDWriteColors(colors, region.Rays.x, region.Rays.y,
    vtkFFDParallelFor(this->Self->NumberOfThreads), this->ColorImage);
  this->ImageDepths = this->VisibleDepths;
}

//------------------------------------------------------------------------------
/// Draws a picture in the window.
void vtkFFDInverseRayVolumeMapper::vtkInternals::Draw(
  const View& view, const vtkFFDImageDisplay::Layers& layers)
{
  const vtkFFDFrameCaster::Picture& picture = *view.Picture;
  const vtkFFDImageRegion& region = view.Region;
  vtkFFDImageDisplay::Image image;
  image.Width = region.Rays.x;
  image.Height = region.Rays.y;
  image.Floats = picture.Floats.empty() ? nullptr : picture.Floats.data();
  image.Bytes = picture.Bytes.empty() ? nullptr : picture.Bytes.data();
  image.Visible = view.Visible;
  const glm::dvec2 perPixel = 2.0 / glm::dvec2(region.Viewport);
  const glm::dvec2 lower = glm::dvec2(region.Origin) * perPixel - 1.0;
  const glm::dvec2 upper = lower + glm::dvec2(region.Rays) * region.Step * perPixel;
  const double rectangle[4] = { lower.x, lower.y, upper.x, upper.y };
  if (!this->Display.Draw(view.Renderer, image, layers, rectangle, region.Step == 1.0))
  {
    vtkErrorWithObjectMacro(this->Self,
      << "The image could not be drawn: the render window is not an OpenGL window or refused a "
         "texture of "
      << region.Rays.x << " x " << region.Rays.y << ". Use RenderToImage() there.");
  }
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::RenderToImage(vtkRenderer* renderer, vtkVolume* volume, int width,
  int height, vtkImageData* colors, vtkImageData* depths, vtkImageData* inputDepths)
{
  return vtkFFDGuarded(this, "RenderToImage", 0,
    [&] { return this->MakeImages(renderer, volume, width, height, colors, depths, inputDepths); });
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::MakeImages(vtkRenderer* renderer, vtkVolume* volume, int width,
  int height, vtkImageData* colors, vtkImageData* depths, vtkImageData* inputDepths)
{
  if (!renderer || !volume || !colors)
  {
    vtkErrorMacro(<< "RenderToImage needs a renderer, a volume and an image for the colors; the "
                  << (!renderer ? "renderer" : (!volume ? "volume" : "image")) << " is null.");
    return 0;
  }
  if (colors == depths)
  {
    vtkErrorMacro(<< "RenderToImage: colors and depths are the same image. Give two images.");
    return 0;
  }
  vtkDataObject* const inputs[] = { this->GetInputDataObject(0, 0), this->GetMaskInput() };
  for (const vtkDataObject* kept : inputs)
  {
    if (kept && (colors == kept || depths == kept))
    {
      vtkErrorMacro(
        << "RenderToImage: the image for the " << (colors == kept ? "colors" : "depths")
        << " is the volume or its mask, which would be lost. Give an image of its own.");
      return 0;
    }
  }
  vtkInternals& in = *this->Internals;
  if (!in.CanMakeImage("RenderToImage", width, height))
  {
    return 0;
  }
  std::string message;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const float* scene = nullptr;
  if (inputDepths)
  {
    int dims[3];
    inputDepths->GetDimensions(dims);
    if (dims[0] != width || dims[1] != height || dims[2] != 1 ||
      inputDepths->GetScalarType() != VTK_FLOAT ||
      inputDepths->GetNumberOfScalarComponents() != 1 ||
      !inputDepths->GetPointData()->GetScalars() ||
      inputDepths->GetPointData()->GetScalars()->GetNumberOfTuples() <
        static_cast<vtkIdType>(pixels))
    {
      vtkErrorMacro(<< "RenderToImage: the input depths must be one float a pixel, " << width
                    << " x " << height << " x 1; they are " << dims[0] << " x " << dims[1] << " x "
                    << dims[2] << ".");
      return 0;
    }
    scene = static_cast<const float*>(inputDepths->GetScalarPointer());
  }
  vtkFFDFrame frame(in.Frame, this, renderer, volume, nullptr);
  frame.SetReportsProgress(this->ReportProgress);
  in.Prepared = false;
  if (inputDepths)
  {
    frame.Hold({ inputDepths->GetPointData()->GetScalars() });
  }
  const vtkSmartPointer<vtkImageData> keptColors(colors);
  const vtkSmartPointer<vtkImageData> keptDepths(depths);
  if (!in.Prepare(volume, message) || !in.CheckView(renderer, volume, message))
  {
    if (!message.empty())
    {
      vtkErrorMacro(<< message);
    }
    return 0;
  }
  const vtkFFDImageRegion region(glm::ivec2(width, height));
  in.Caster.Begin(vtkFFDFrameCaster::Purpose::Other);
  // To ask the system takes a tenth of a millisecond and more.
  if (!in.Caster.HoldsBytes(pixels))
  {
    vtkFFDRequireMemory(BytesPerPixel * static_cast<double>(pixels),
      std::to_string(width) + " x " + std::to_string(height) + " pixels",
      "Give a smaller width and height.");
  }
  std::vector<float> firstVisible(depths ? pixels : 0);
  vtkFFDFrameCaster::View cast;
  cast.Renderer = renderer;
  cast.Volume = volume;
  cast.Region = region;
  cast.HasTimeEstimate = in.Plan.HasTimeEstimate();
  cast.AsBytes = [] { return true; };
  cast.Premultiplied = this->PremultipliedAlpha != 0;
  if (!in.Caster.Cast(frame, cast, scene, depths ? firstVisible.data() : nullptr))
  {
    return 0;
  }

  const std::vector<unsigned char>& bytes = in.Caster.GetPicture().Bytes;
  colors->SetExtent(0, width - 1, 0, height - 1, 0, 0);
  colors->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
  auto* const copy = static_cast<unsigned char*>(colors->GetScalarPointer());
  vtkFFDParallelFor(this->NumberOfThreads)(
    static_cast<std::size_t>(height), [&](std::size_t first, std::size_t last) {
      const std::size_t row = std::size_t{ 4 } * static_cast<std::size_t>(width);
      std::copy(bytes.data() + first * row, bytes.data() + last * row, copy + first * row);
    });
  if (depths)
  {
    depths->SetExtent(0, width - 1, 0, height - 1, 0, 0);
    depths->AllocateScalars(VTK_FLOAT, 1);
    std::copy(
      firstVisible.begin(), firstVisible.end(), static_cast<float*>(depths->GetScalarPointer()));
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::TraceRays(vtkRenderer* renderer, vtkVolume* volume, int width,
  int height, vtkIdTypeArray* pixels, vtkPolyData* rays, vtkPolyData* viewingRays,
  vtkPolyData* samples)
{
  return vtkFFDGuarded(this, "TraceRays", 0, [&] {
    return this->MakeRays(renderer, volume, width, height, pixels, rays, viewingRays, samples);
  });
}

//------------------------------------------------------------------------------
int vtkFFDInverseRayVolumeMapper::MakeRays(vtkRenderer* renderer, vtkVolume* volume, int width,
  int height, vtkIdTypeArray* pixels, vtkPolyData* rays, vtkPolyData* viewingRays,
  vtkPolyData* samples)
{
  if (!renderer || !volume || !pixels || !rays || pixels->GetNumberOfComponents() != 2)
  {
    vtkErrorMacro(<< "TraceRays needs a renderer, a volume, two numbers for each pixel and a "
                     "vtkPolyData for the rays; one of them is null.");
    return 0;
  }
  if (rays == viewingRays || rays == samples || (samples && samples == viewingRays))
  {
    vtkErrorMacro(<< "TraceRays: two of the outputs are the same vtkPolyData. Give one for each.");
    return 0;
  }
  vtkInternals& in = *this->Internals;
  if (!in.CanMakeImage("TraceRays", width, height))
  {
    return 0;
  }
  std::string message;
  this->Update();
  if (in.Update(volume->GetProperty(), message))
  {
    in.CheckView(renderer, volume, message);
  }
  if (!message.empty())
  {
    vtkErrorMacro(<< message);
    return 0;
  }
  const vtkFFDImageRegion region(glm::ivec2(width, height));
  const vtkFFDFrameScene views(this, in.Cache, renderer, volume, region, nullptr);
  const ffd::CastScene& scene = views.Get();
  const ffd::RayCaster caster(
    scene, vtkFFDFramePlan::MakeSettings(this, in.Cache, volume, false, 1.0));
  ffd::CastImage image;
  image.Width = width;
  image.Height = height;
  ffd::RayCaster::Scratch scratch;
  vtkFFDTracedRays result(scene, rays, viewingRays, samples);
  ffd::TracedRay traced;
  for (vtkIdType i = 0; i < pixels->GetNumberOfTuples(); ++i)
  {
    const vtkIdType x = pixels->GetTypedComponent(i, 0);
    const vtkIdType y = pixels->GetTypedComponent(i, 1);
    if (x < 0 || y < 0 || x >= width || y >= height)
    {
      vtkErrorMacro(<< "TraceRays: the image of " << width << " x " << height
                    << " pixels has no pixel (" << x << ", " << y << "); it is left out.");
      continue;
    }
    caster.TraceRay(static_cast<int>(x), static_cast<int>(y), image, scratch, traced);
    result.Add(traced, static_cast<int>(x), static_cast<int>(y));
  }
  result.Finish();
  return 1;
}

//------------------------------------------------------------------------------
void vtkFFDInverseRayVolumeMapper::CreateCanonicalView(vtkRenderer* renderer, vtkVolume* volume,
  vtkImageData* image, int blendMode, double viewDirection[3], double viewUp[3])
{
  if (!volume || !image || !viewDirection || !viewUp)
  {
    vtkErrorMacro(<< "CreateCanonicalView needs a volume, an image and two directions; the "
                  << (!volume     ? "volume"
                         : !image ? "image"
                                  : "direction or the upward direction")
                  << " is null.");
    return;
  }
  vtkNew<vtkRenderer> canonical;
  vtkNew<vtkLight> headlight;
  vtkLightCollection* lights = renderer ? renderer->GetLights() : nullptr;
  if (lights && lights->GetNumberOfItems() > 0)
  {
    canonical->SetLightCollection(lights);
  }
  else
  {
    headlight->SetLightTypeToHeadlight();
    canonical->AddLight(headlight);
  }
  double bounds[6];
  volume->GetBounds(bounds);
  const double distance = bounds[1] - bounds[0];
  const glm::dvec3 center(
    0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]), 0.5 * (bounds[4] + bounds[5]));
  const glm::dvec3 position =
    center - distance * glm::dvec3(viewDirection[0], viewDirection[1], viewDirection[2]);
  vtkCamera* camera = canonical->GetActiveCamera();
  camera->SetFocalPoint(center.x, center.y, center.z);
  camera->SetPosition(position.x, position.y, position.z);
  camera->SetViewUp(viewUp);
  camera->ParallelProjectionOn();
  camera->SetParallelScale(0.5 * distance);
  canonical->ResetCameraClippingRange(bounds);

  int size[3];
  image->GetDimensions(size);
  vtkNew<vtkImageData> colors;
  const int keptBlendMode = this->BlendMode;
  const vtkTypeBool keptCropping = this->Cropping;
  const vtkTypeBool keptAlpha = this->PremultipliedAlpha;
  this->BlendMode = blendMode;
  this->Cropping = 0;
  this->PremultipliedAlpha = 1;
  const bool made =
    this->RenderToImage(canonical, volume, size[0], size[1], colors, nullptr, nullptr) == 1;
  // Options that an observer has set meanwhile stay.
  const auto restore = [](int& option, int was, int meanwhile) {
    option = option == meanwhile ? was : option;
  };
  restore(this->BlendMode, keptBlendMode, blendMode);
  restore(this->Cropping, keptCropping, 0);
  restore(this->PremultipliedAlpha, keptAlpha, 1);
  if (!made)
  {
    return;
  }
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  const auto* rgba = static_cast<const unsigned char*>(colors->GetScalarPointer());
  auto* rgb = static_cast<unsigned char*>(image->GetScalarPointer());
  for (vtkIdType i = 0; i < colors->GetNumberOfPoints(); ++i)
  {
    std::copy_n(rgba + 4 * i, 3, rgb + 3 * i);
  }
}
