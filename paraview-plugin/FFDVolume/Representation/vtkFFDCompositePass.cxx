// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDCompositePass.h"

#include "vtkFFDServerFrames.h"
#include "vtkFFDVersions.h"

#include "vtkCameraPass.h"
#include "vtkCommunicator.h"
#include "vtkFloatArray.h"
#include "vtkImageProcessingPass.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkOrderedCompositingHelper.h"
#include "vtkRenderer.h"
#include "vtkRenderState.h"
#include "vtkTextureObject.h"
#include VTK_FFD_OPENGL_HEADER

#if __has_include("vtkIceTCompositePass.h")
#include "vtkIceTCompositePass.h"
#define FFD_HAS_ICET
#endif

#include <algorithm>
#include <cstddef>
#include <utility>

vtkStandardNewMacro(vtkFFDCompositePass);

namespace
{

/// Half a step of a byte: less than that does not make a sum of bytes wrap.
constexpr float Brighter = 0.5f / 255.0f;

unsigned char ToByte(float value)
{
  return static_cast<unsigned char>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f);
}

} // namespace

#ifdef FFD_HAS_ICET

//------------------------------------------------------------------------------
/// Pixels from the first to one past the last.
struct vtkFFDCompositePass::Rectangle
{
  int Low[2];
  int High[2];
  int Width() const { return this->High[0] - this->Low[0]; }
  int Height() const { return this->High[1] - this->Low[1]; }
};

//------------------------------------------------------------------------------
struct vtkFFDCompositePass::Place
{
  vtkSmartPointer<vtkIceTCompositePass> IceT;
  vtkSmartPointer<vtkRenderPass> Scene; // the pass that renders it
  bool RenderEmptyImages = false;
  bool Tiled = false;
  bool OnWindow = true; // not on a texture of an image processing pass, which has floats
};

//------------------------------------------------------------------------------
vtkFFDCompositePass::vtkFFDCompositePass() = default;

//------------------------------------------------------------------------------
vtkFFDCompositePass::~vtkFFDCompositePass() { this->End(); }

//------------------------------------------------------------------------------
vtkFFDCompositePass* vtkFFDCompositePass::Begin(vtkRenderer* renderer, bool mayBeBright)
{
  auto* processing = vtkImageProcessingPass::SafeDownCast(renderer->GetPass());
  auto* camera =
    vtkCameraPass::SafeDownCast(processing ? processing->GetDelegatePass() : renderer->GetPass());
  auto* iceT = camera ? vtkIceTCompositePass::SafeDownCast(camera->GetDelegatePass()) : nullptr;
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (!iceT || !iceT->GetController() || !window || renderer->GetSelector())
  {
    return nullptr;
  }
  vtkRenderPass* scene = iceT->GetRenderPass();
  if (auto* other = vtkFFDCompositePass::SafeDownCast(scene))
  {
    other->MayBeBright = other->MayBeBright || mayBeBright;
    return other;
  }
  vtkOrderedCompositingHelper* order = iceT->GetOrderedCompositingHelper();
  const auto processes = static_cast<std::size_t>(iceT->GetController()->GetNumberOfProcesses());
  // The value pass has buffers of its own, which IceT looks for.
  if (!scene || scene->IsA("vtkValuePass") || processes < 2 || !iceT->GetUseOrderedCompositing() ||
    !order || order->GetBoundingBoxes().size() != processes || window->GetMultiSamples() > 1)
  {
    return nullptr;
  }
  this->Taken.reset(new Place);
  this->Taken->IceT = iceT;
  this->Taken->Scene = scene;
  this->Taken->RenderEmptyImages = iceT->GetRenderEmptyImages();
  this->Taken->OnWindow = !processing;
  this->MayBeBright = mayBeBright;
  const int* tiles = iceT->GetTileDimensions();
  this->Taken->Tiled = tiles[0] != 1 || tiles[1] != 1 || iceT->GetDataReplicatedOnAllProcesses();
  // Processes without anything in the picture exchange pixels with the others.
  iceT->SetRenderEmptyImages(true);
  iceT->SetRenderPass(this);
  return this;
}

//------------------------------------------------------------------------------
void vtkFFDCompositePass::End()
{
  if (this->Taken)
  {
    this->Taken->IceT->SetRenderEmptyImages(this->Taken->RenderEmptyImages);
    this->Taken->IceT->SetRenderPass(this->Taken->Scene);
    this->Taken.reset();
  }
}

//------------------------------------------------------------------------------
void vtkFFDCompositePass::SetWait(std::function<void()> wait) { this->Wait = std::move(wait); }

//------------------------------------------------------------------------------
void vtkFFDCompositePass::BlendInFloats()
{
  if (!this->Window || !this->MayBeBright || this->Bytes || !this->Taken->OnWindow)
  {
    return;
  }
  vtkOpenGLFramebufferObject* frame = this->Window->GetRenderFramebuffer();
  vtkTextureObject* bytes = frame->GetColorAttachmentAsTextureObject(0);
  vtkNew<vtkFloatArray> drawn;
  vtkNew<vtkTextureObject> floats;
  floats->SetContext(this->Window);
  if (!bytes ||
    this->Window->GetRGBAPixelData(0, 0, this->Size[0] - 1, this->Size[1] - 1, 0, drawn) !=
      VTK_OK ||
    !floats->Create2DFromRaw(static_cast<unsigned int>(this->Size[0]),
      static_cast<unsigned int>(this->Size[1]), 4, VTK_FLOAT, drawn->GetPointer(0)))
  {
    return;
  }
  this->Bytes = bytes;
  frame->AddColorAttachment(0, floats);
}

//------------------------------------------------------------------------------
void vtkFFDCompositePass::Render(const vtkRenderState* state)
{
  vtkRenderer* renderer = state->GetRenderer();
  this->Window = static_cast<vtkOpenGLRenderWindow*>(renderer->GetRenderWindow());
  std::copy_n(this->Window->GetActualSize(), 2, this->Size);
  this->Order =
    this->Taken->IceT->GetOrderedCompositingHelper()->ComputeSortOrder(renderer->GetActiveCamera());

  const bool isPart = ffdserver::IsGroup() && !this->Taken->Tiled;
  if (isPart)
  {
    ffdserver::BeginPart();
  }
  this->Taken->Scene->Render(state);
  this->NumberOfRenderedProps = this->Taken->Scene->GetNumberOfRenderedProps();
  if (isPart)
  {
    ffdserver::EndPart(this->Wait);
  }
  if (this->MayBeBright)
  {
    this->CompositeBright();
  }
  this->Window = nullptr;
}

//------------------------------------------------------------------------------
/// See to what was drawn here being composited right where it is brighter than its alpha. Called on
/// all processes.
void vtkFFDCompositePass::CompositeBright()
{
  // As IceT does: of the framebuffer that is bound, which may be that of an image processing pass.
  this->Pixels.resize(
    4 * static_cast<std::size_t>(this->Size[0]) * static_cast<std::size_t>(this->Size[1]));
  glReadPixels(0, 0, this->Size[0], this->Size[1], GL_RGBA, GL_FLOAT, this->Pixels.data());
  bool changed = false;
  if (this->Bytes)
  {
    changed = true;
    this->Window->GetRenderFramebuffer()->AddColorAttachment(0, this->Bytes);
    this->Bytes = nullptr;
  }

  Rectangle bright;
  bool composite = false;
  if (this->Taken->Tiled)
  {
    changed = this->RaiseAlpha() || changed;
  }
  else
  {
    composite = this->FindBright(bright);
  }
  if (changed || composite)
  {
    std::vector<unsigned char> bytes(this->Pixels.size());
    std::transform(this->Pixels.begin(), this->Pixels.end(), bytes.begin(), ToByte);
    if (composite)
    {
      this->Composite(bright, bytes);
    }
    vtkOpenGLState* openGL = this->Window->GetState();
    const vtkOpenGLState::ScopedglEnableDisable blend(openGL, GL_BLEND);
    const vtkOpenGLState::ScopedglEnableDisable depthTest(openGL, GL_DEPTH_TEST);
    const vtkOpenGLState::ScopedglEnableDisable scissor(openGL, GL_SCISSOR_TEST);
    openGL->vtkglDisable(GL_BLEND);
    this->Window->DrawPixels(
      0, 0, this->Size[0] - 1, this->Size[1] - 1, 4, VTK_UNSIGNED_CHAR, bytes.data());
  }
  this->Pixels.clear();
}

//------------------------------------------------------------------------------
/// Finds the rectangle where colors of any process are brighter than their alpha; false if none
/// are. Called on all processes.
bool vtkFFDCompositePass::FindBright(Rectangle& where) const
{
  // First pixels and negated last ones, of which the least count; then the sizes of the windows.
  int mine[8] = { this->Size[0], this->Size[1], 0, 0, this->Size[0], this->Size[1], -this->Size[0],
    -this->Size[1] };
  const float* pixel = this->Pixels.data();
  for (int y = 0; y < this->Size[1]; ++y)
  {
    for (int x = 0; x < this->Size[0]; ++x, pixel += 4)
    {
      if (std::max({ pixel[0], pixel[1], pixel[2] }) > pixel[3] + Brighter)
      {
        mine[0] = std::min(mine[0], x);
        mine[1] = std::min(mine[1], y);
        mine[2] = std::min(mine[2], -x - 1);
        mine[3] = std::min(mine[3], -y - 1);
      }
    }
  }
  int all[8];
  this->Taken->IceT->GetController()->AllReduce(mine, all, 8, vtkCommunicator::MIN_OP);
  where = { { all[0], all[1] }, { -all[2], -all[3] } };
  return where.Width() > 0 && where.Height() > 0 && all[4] == -all[6] && all[5] == -all[7];
}

//------------------------------------------------------------------------------
/// Raises alpha to the brightest color of its pixel, so that sums do not wrap; what is behind
/// counts less then. Returns whether there is such a pixel.
bool vtkFFDCompositePass::RaiseAlpha()
{
  bool any = false;
  for (std::size_t i = 0; i < this->Pixels.size(); i += 4)
  {
    float* pixel = &this->Pixels[i];
    const float brightest = std::min(std::max({ pixel[0], pixel[1], pixel[2] }), 1.0f);
    if (brightest > pixel[3] + Brighter)
    {
      pixel[3] = brightest;
      any = true;
    }
  }
  return any;
}

//------------------------------------------------------------------------------
/// Give the foremost process at each pixel of `where` what all of them show there, and the others
/// nothing. Called on all processes.
void vtkFFDCompositePass::Composite(const Rectangle& where, std::vector<unsigned char>& bytes) const
{
  vtkMultiProcessController* controller = this->Taken->IceT->GetController();
  const int processes = controller->GetNumberOfProcesses();
  const int own = controller->GetLocalProcessId();
  const std::size_t rowLength = 4 * static_cast<std::size_t>(where.Width());
  const auto place = [&](int row) {
    return 4 *
      (static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Size[0]) +
        static_cast<std::size_t>(where.Low[0]));
  };
  const auto count = static_cast<std::size_t>(processes);
  for (int root = 0; root < processes; ++root)
  {
    // Rows in 64 bits: their number times that of the processes.
    const auto first =
      where.Low[1] + static_cast<int>(static_cast<vtkTypeInt64>(where.Height()) * root / processes);
    const auto end = where.Low[1] +
      static_cast<int>(static_cast<vtkTypeInt64>(where.Height()) * (root + 1) / processes);
    const std::size_t length = rowLength * static_cast<std::size_t>(end - first);
    if (length == 0)
    {
      continue;
    }
    std::vector<float> mine;
    for (int row = first; row < end; ++row)
    {
      const float* pixels = &this->Pixels[place(row)];
      mine.insert(mine.end(), pixels, pixels + rowLength);
    }
    std::vector<float> all(own == root ? count * length : 0);
    controller->Gather(mine.data(), all.data(), static_cast<vtkIdType>(length), root);
    std::vector<unsigned char> blended(all.size(), 0);
    for (std::size_t pixel = 0; own == root && pixel < length; pixel += 4)
    {
      float sum[3] = { 0.0f, 0.0f, 0.0f };
      float transmittance = 1.0f;
      std::size_t foremost = pixel;
      for (auto process = this->Order.rbegin(); process != this->Order.rend(); ++process)
      {
        const std::size_t at = static_cast<std::size_t>(*process) * length + pixel;
        const float* front = &all[at];
        if (std::all_of(front, front + 4, [](float value) { return value == 0.0f; }))
        {
          continue;
        }
        foremost = at;
        const float passes = 1.0f - front[3];
        for (int c = 0; c < 3; ++c)
        {
          sum[c] = front[c] + passes * sum[c];
        }
        transmittance *= passes;
      }
      std::transform(sum, sum + 3, &blended[foremost], ToByte);
      blended[foremost + 3] = ToByte(1.0f - transmittance);
    }
    std::vector<unsigned char> shown(length);
    controller->Scatter(blended.data(), shown.data(), static_cast<vtkIdType>(length), root);
    for (int row = first; row < end; ++row)
    {
      std::copy_n(
        &shown[static_cast<std::size_t>(row - first) * rowLength], rowLength, &bytes[place(row)]);
    }
  }
}

#else

struct vtkFFDCompositePass::Place
{
};

// Several processes are composited by IceT only.
vtkFFDCompositePass::vtkFFDCompositePass() = default;
vtkFFDCompositePass::~vtkFFDCompositePass() = default;
vtkFFDCompositePass* vtkFFDCompositePass::Begin(vtkRenderer*, bool) { return nullptr; }
void vtkFFDCompositePass::End() {}
void vtkFFDCompositePass::SetWait(std::function<void()>) {}
void vtkFFDCompositePass::BlendInFloats() {}
void vtkFFDCompositePass::Render(const vtkRenderState*) {}

#endif
