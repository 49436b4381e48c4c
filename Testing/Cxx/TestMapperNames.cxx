// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Code written for VTK's volume mappers compiles and runs with ours; what has a meaning here works.
#include "FFDTestScenes.h"
#include "FFDTestVolume.h"

#include "vtkCallbackCommand.h"
#include "vtkContourValues.h"
#include "vtkSmartVolumeMapper.h"

#include <algorithm>
#include <type_traits>

namespace
{

using Ours = vtkFFDInverseRayVolumeMapper;

/// What an application calls on a vtkGPUVolumeRayCastMapper.
template <typename Mapper>
void UseAsGpuMapper(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkNew<Mapper> mapper;
  mapper->SetInputData(FFDMakeBall());
  volume->SetMapper(mapper);
  using Base =
    std::conditional_t<std::is_same<Mapper, Ours>::value, Ours, vtkGPUVolumeRayCastMapper>;
  Base* base = mapper;
  if (!base->IsRenderSupported(renderer->GetRenderWindow(), volume->GetProperty()))
  {
    std::cerr << "not supported\n";
  }
  mapper->AutoAdjustSampleDistancesOff();
  mapper->LockSampleDistanceToInputSpacingOff();
  mapper->SetSampleDistance(0.5f);
  mapper->SetImageSampleDistance(1.0f);
  mapper->SetMinimumImageSampleDistance(1.0f);
  mapper->SetMaximumImageSampleDistance(4.0f);
  mapper->UseJitteringOff();
  mapper->SetFinalColorWindow(1.0f);
  mapper->SetFinalColorLevel(0.5f);
  mapper->SetMaxMemoryInBytes(1 << 30);
  mapper->SetMaxMemoryFraction(0.5f);
  mapper->SetReportProgress(false);
  mapper->SetMaskInput(nullptr);
  mapper->SetMaskTypeToBinary();
  mapper->SetMaskBlendFactor(1.0f);
  mapper->SetColorRangeType(Mapper::NATIVE);
  mapper->SetScalarOpacityRangeType(Mapper::NATIVE);
  mapper->SetGradientOpacityRangeType(Mapper::SCALAR);
  mapper->SetTransfer2DYAxisArray(nullptr);
  mapper->SetBlendModeToComposite();
  mapper->SetPartitions(1, 1, 1);
  mapper->SetSharedDepthTexture(nullptr);
  mapper->PreLoadData(renderer, volume);
  double ratio[3];
  base->GetReductionRatio(ratio);
  mapper->UseDepthPassOff();
  mapper->GetDepthPassContourValues()->SetValue(0, 80.0);
  mapper->RenderToImageOn();
  mapper->SetDepthImageScalarTypeToFloat();
  mapper->ClampDepthToBackfaceOff();
  renderer->GetRenderWindow()->Render();
  vtkNew<vtkImageData> colors;
  vtkNew<vtkImageData> depths;
  mapper->GetColorImage(colors);
  mapper->GetDepthImage(depths);
  mapper->GetColorTexture();
  mapper->GetDepthTexture();
  mapper->RenderToImageOff();
  mapper->SetRenderToImage(mapper->GetRenderToImage());
  renderer->GetRenderWindow()->Render();
  mapper->GetCurrentPass();
  mapper->GetInputCount();
  mapper->GetTransformedInput();
  mapper->GetBoundsFromPort(0);
  mapper->ReleaseGraphicsResources(renderer->GetRenderWindow());
  volume->SetMapper(nullptr);
}

/// On a vtkSmartVolumeMapper.
template <typename Mapper>
void UseAsSmartMapper(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkNew<Mapper> mapper;
  mapper->SetInputData(FFDMakeBall());
  volume->SetMapper(mapper);
  mapper->SetRequestedRenderModeToGPU();
  mapper->SetRequestedRenderModeToOSPRay();
  mapper->SetRequestedRenderModeToDefault();
  mapper->SetRequestedRenderMode(Mapper::RayCastRenderMode);
  mapper->SetInterpolationModeToNearestNeighbor();
  mapper->SetInterpolationModeToCubic();
  mapper->SetInterpolationModeToLinear();
  mapper->SetInteractiveUpdateRate(2.0);
  mapper->InteractiveAdjustSampleDistancesOn();
  mapper->SetMaxMemoryInBytes(1 << 30);
  mapper->SetMaxMemoryFraction(0.5f);
  renderer->GetRenderWindow()->Render();
  if (mapper->GetLastUsedRenderMode() != Mapper::RayCastRenderMode ||
    mapper->GetRequestedRenderMode() != Mapper::RayCastRenderMode)
  {
    std::cerr << "another render mode\n";
  }
  vtkNew<vtkImageData> image;
  image->SetDimensions(30, 30, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  double direction[3] = { 0.0, 0.0, -1.0 };
  double up[3] = { 0.0, 1.0, 0.0 };
  mapper->CreateCanonicalView(
    renderer, volume, volume, image, vtkVolumeMapper::COMPOSITE_BLEND, direction, up);
  volume->SetMapper(nullptr);
}

/// On a vtkFixedPointVolumeRayCastMapper; the canonical view.
template <typename Mapper>
vtkSmartPointer<vtkImageData> UseAsFixedPointMapper(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkNew<Mapper> mapper;
  mapper->SetInputData(FFDMakeBall());
  volume->SetMapper(mapper);
  mapper->SetNumberOfThreads(2);
  mapper->IntermixIntersectingGeometryOn();
  mapper->SetSampleDistance(0.2f);
  mapper->SetInteractiveSampleDistance(0.4f);
  renderer->GetRenderWindow()->Render();
  const float distance = mapper->ComputeRequiredImageSampleDistance(1e6f, renderer, volume);
  const float coarse = mapper->ComputeRequiredImageSampleDistance(1e-9f, renderer);
  if (!(distance == 1.0f && coarse == 10.0f &&
        mapper->GetEstimatedRenderTime(renderer, volume) > 0.0f))
  {
    std::cerr << "times: " << distance << " " << coarse << "\n";
    return nullptr;
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(60, 60, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  double direction[3] = { 0.0, 0.0, -1.0 };
  double up[3] = { 0.0, 1.0, 0.0 };
  mapper->CreateCanonicalView(
    volume, image, vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND, direction, up);
  mapper->AbortRender();
  volume->SetMapper(nullptr);
  return image;
}

bool TestNames()
{
  FFDTestScene scene;
  scene.Show();
  UseAsGpuMapper<vtkOpenGLGPUVolumeRayCastMapper>(scene.Renderer, scene.Volume);
  UseAsGpuMapper<Ours>(scene.Renderer, scene.Volume);
  UseAsSmartMapper<vtkSmartVolumeMapper>(scene.Renderer, scene.Volume);
  UseAsSmartMapper<Ours>(scene.Renderer, scene.Volume);
  const auto fixed =
    UseAsFixedPointMapper<vtkFixedPointVolumeRayCastMapper>(scene.Renderer, scene.Volume);
  const auto ours = UseAsFixedPointMapper<Ours>(scene.Renderer, scene.Volume);
  if (!fixed || !ours)
  {
    return false;
  }
  // The same picture but for the ways in which the mappers round.
  double sum = 0.0;
  int most = 0;
  const auto* a = static_cast<const unsigned char*>(fixed->GetScalarPointer());
  const auto* b = static_cast<const unsigned char*>(ours->GetScalarPointer());
  for (int i = 0; i < 3 * 60 * 60; ++i)
  {
    sum += std::abs(a[i] - b[i]);
    most = std::max(most, static_cast<int>(b[i]));
  }
  std::cout << "canonical view: mean difference " << sum / (3 * 60 * 60) << "\n";
  return sum / (3 * 60 * 60) < 2.0 && most > 50;
}

/// Frames as images: those of RenderToImage() and of VTK's GPU mapper; nothing in the window.
int TestImages()
{
  FFDTestScene scene;
  scene.ConeActor->VisibilityOff();
  scene.Mapper->SetDeformation(nullptr);
  scene.Mapper->SetSampleDistance(0.2);
  scene.Mapper->PremultipliedAlphaOn();
  vtkNew<vtkImageData> colors;
  vtkNew<vtkImageData> depths;
  scene.Mapper->GetColorImage(colors);
  FFD_CHECK(scene.Errors->Had("RenderToImageOn()"));
  scene.Mapper->GetDepthImage(depths);
  FFD_CHECK(scene.Errors->Had("RenderToImageOn()"));
  constexpr int Size = 80;
  const std::vector<unsigned char> shown = scene.Show(Size);
  scene.Mapper->RenderToImageOn();
  const std::vector<unsigned char> none = scene.Show(Size);
  FFD_CHECK(*std::max_element(none.begin(), none.end()) == 0);
  scene.Mapper->GetColorImage(colors);
  scene.Mapper->GetDepthImage(depths);
  FFD_CHECK(colors->GetDimensions()[0] == Size && depths->GetScalarType() == VTK_FLOAT);

  vtkNew<vtkImageData> direct;
  vtkNew<vtkImageData> directDepths;
  FFD_CHECK(scene.Mapper->RenderToImage(
              scene.Renderer, scene.Volume, Size, Size, direct, directDepths) == 1);
  vtkNew<vtkOpenGLGPUVolumeRayCastMapper> gpu;
  gpu->SetInputData(scene.Image);
  gpu->AutoAdjustSampleDistancesOff();
  gpu->SetSampleDistance(0.2f);
  gpu->RenderToImageOn();
  scene.Volume->SetMapper(gpu);
  scene.Show(Size);
  vtkNew<vtkImageData> gpuColors;
  vtkNew<vtkImageData> gpuDepths;
  gpu->GetColorImage(gpuColors);
  gpu->GetDepthImage(gpuDepths);
  scene.Volume->SetMapper(scene.Mapper);
  double colorSum = 0.0;
  double depthSum = 0.0;
  int visible = 0;
  for (int i = 0; i < Size * Size; ++i)
  {
    const int x = i % Size;
    const int y = i / Size;
    for (int c = 0; c < 4; ++c)
    {
      const double value = colors->GetScalarComponentAsDouble(x, y, 0, c);
      FFD_CHECK(value == direct->GetScalarComponentAsDouble(x, y, 0, c));
      if (c < 3)
      {
        FFD_CHECK_NEAR(value, shown[static_cast<std::size_t>(3 * i + c)], 1.0);
      }
      if (value > 0.0)
      {
        colorSum += std::abs(value - gpuColors->GetScalarComponentAsDouble(x, y, 0, c));
        ++visible;
      }
    }
    const double depth = depths->GetScalarComponentAsDouble(x, y, 0, 0);
    FFD_CHECK(depth == directDepths->GetScalarComponentAsDouble(x, y, 0, 0));
    if (colors->GetScalarComponentAsDouble(x, y, 0, 3) > 20.0)
    {
      depthSum += std::abs(depth - gpuDepths->GetScalarComponentAsDouble(x, y, 0, 0));
    }
  }
  std::cout << "from the GPU mapper: " << colorSum / visible << ", depths "
            << 4.0 * depthSum / visible << "\n";
  FFD_CHECK(visible > 2000 && colorSum / visible < 2.0 && 4.0 * depthSum / visible < 0.002);

  // Types of depths; where nothing is, those of the back faces.
  scene.Mapper->SetDepthImageScalarTypeToUnsignedShort();
  vtkNew<vtkImageData> shorts;
  scene.Mapper->GetDepthImage(shorts);
  scene.Mapper->SetDepthImageScalarTypeToUnsignedChar();
  vtkNew<vtkImageData> bytes;
  scene.Mapper->GetDepthImage(bytes);
  FFD_CHECK(
    shorts->GetScalarType() == VTK_UNSIGNED_SHORT && bytes->GetScalarType() == VTK_UNSIGNED_CHAR);
  const double middle = depths->GetScalarComponentAsDouble(Size / 2, Size / 2, 0, 0);
  FFD_CHECK(middle > 0.2 && middle < 0.8);
  FFD_CHECK_NEAR(
    shorts->GetScalarComponentAsDouble(Size / 2, Size / 2, 0, 0), 65535.0 * middle, 1.0);
  FFD_CHECK_NEAR(bytes->GetScalarComponentAsDouble(Size / 2, Size / 2, 0, 0), 255.0 * middle, 1.0);

  scene.Mapper->SetDepthImageScalarTypeToFloat();
  scene.Mapper->ClampDepthToBackfaceOn();
  vtkCamera* camera = scene.Renderer->GetActiveCamera();
  camera->SetFocalPoint(11.5, 11.5, 11.5);
  camera->SetPosition(11.5, 11.5, 60.0);
  camera->ParallelProjectionOn();
  camera->SetParallelScale(15.0);
  camera->SetClippingRange(20.0, 120.0);
  scene.Show(Size);
  scene.Mapper->GetDepthImage(depths);
  scene.Mapper->GetColorImage(colors);
  // A corner of the volume, where the ball is not; the back faces are at z = 0, 60 from the camera.
  FFD_CHECK(colors->GetScalarComponentAsDouble(12, 12, 0, 3) == 0.0);
  FFD_CHECK_NEAR(depths->GetScalarComponentAsDouble(12, 12, 0, 0), 0.4, 1e-5);
  FFD_CHECK(depths->GetScalarComponentAsDouble(0, 0, 0, 0) == 1.0);
  scene.Mapper->ClampDepthToBackfaceOff();
  scene.Show(Size);
  scene.Mapper->GetDepthImage(depths);
  FFD_CHECK(depths->GetScalarComponentAsDouble(12, 12, 0, 0) == 1.0);

  scene.Mapper->RenderToImageOff();
  FFD_CHECK(FFDLargestDifference(none, scene.Show(Size)) > 50);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// Functions that end within the range of the scalars, and are not clamped.
int TestNativeRanges()
{
  FFDTestScene scene;
  scene.Color->RemoveAllPoints();
  scene.Color->AddRGBPoint(60.0, 0.2, 0.9, 0.4);
  scene.Color->AddRGBPoint(120.0, 0.9, 0.5, 0.1);
  scene.Opacity->RemoveAllPoints();
  scene.Opacity->AddPoint(50.0, 0.0);
  scene.Opacity->AddPoint(130.0, 0.2);
  vtkNew<vtkPiecewiseFunction> gradient;
  gradient->AddPoint(2.0, 0.2);
  gradient->AddPoint(10.0, 0.8);
  scene.Property->SetGradientOpacity(gradient);
  const std::vector<unsigned char> clamped = scene.Render();
  struct Case
  {
    const char* Name;
    std::function<void(bool)> Clamp;
    std::function<void(int)> SetType;
  };
  const Case cases[] = {
    { "colors", [&](bool on) { scene.Color->SetClamping(on); },
      [&](int type) { scene.Mapper->SetColorRangeType(type); } },
    { "opacities", [&](bool on) { scene.Opacity->SetClamping(on); },
      [&](int type) { scene.Mapper->SetScalarOpacityRangeType(type); } },
    { "gradients", [&](bool on) { gradient->SetClamping(on); },
      [&](int type) { scene.Mapper->SetGradientOpacityRangeType(type); } },
  };
  for (const Case& each : cases)
  {
    std::cout << each.Name << "\n";
    each.SetType(Ours::NATIVE);
    FFD_CHECK(FFDLargestDifference(clamped, scene.Render()) == 0);
    each.Clamp(false);
    FFD_CHECK(FFDLargestDifference(clamped, scene.Render()) == 0);
    each.SetType(Ours::SCALAR);
    FFD_CHECK(FFDLargestDifference(clamped, scene.Render()) > 20);
    each.Clamp(true);
    FFD_CHECK(FFDLargestDifference(clamped, scene.Render()) == 0);
  }
  return EXIT_SUCCESS;
}

void Count(vtkObject*, unsigned long, void* client, void*) { ++*static_cast<int*>(client); }

void Abort(vtkObject* caller, unsigned long, void*, void*)
{
  Ours::SafeDownCast(caller)->AbortRender();
}

int TestFrames()
{
  FFDTestScene scene;
  int events = 0;
  vtkNew<vtkCallbackCommand> count;
  count->SetCallback(Count);
  count->SetClientData(&events);
  const unsigned long tag =
    scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderProgressEvent, count);
  scene.Mapper->AddObserver(vtkCommand::ProgressEvent, count);
  FFD_CHECK(!scene.Render().empty() && events > 0);
  events = 0;
  scene.Mapper->SetReportProgress(false);
  FFD_CHECK(!scene.Render().empty() && events == 0);
  scene.Mapper->SetReportProgress(true);
  scene.Mapper->RemoveObserver(tag);
  vtkNew<vtkCallbackCommand> abort;
  abort->SetCallback(Abort);
  const unsigned long aborting = scene.Mapper->AddObserver(vtkCommand::ProgressEvent, abort);
  FFD_CHECK(scene.Render().empty());
  scene.Mapper->RemoveObserver(aborting);

  // What is loaded is not made again by the frame. The mapper of the scene, which has the same
  // deformation, has found the bounds.
  vtkNew<Ours> mapper;
  mapper->SetInputData(scene.Image);
  mapper->SetDeformation(scene.Lattice);
  scene.Volume->SetMapper(mapper);
  FFD_CHECK(mapper->PreLoadData(scene.Renderer, scene.Volume));
  vtkTypeInt64 builds[Ours::NUMBER_OF_CACHED_PARTS];
  for (int part = 0; part < Ours::NUMBER_OF_CACHED_PARTS; ++part)
  {
    builds[part] = mapper->GetNumberOfBuilds(part);
    FFD_CHECK(builds[part] == (part == Ours::DEFORMATION_BOUNDS ? 0 : 1));
  }
  scene.Show();
  for (int part = 0; part < Ours::NUMBER_OF_CACHED_PARTS; ++part)
  {
    FFD_CHECK(mapper->GetNumberOfBuilds(part) == builds[part]);
  }
  vtkNew<Ours> empty;
  vtkNew<FFDErrorLog> errors;
  errors->Watch(empty);
  FFD_CHECK(!empty->PreLoadData(scene.Renderer, scene.Volume) && errors->Had("No input"));

  // A frame at four a second moves, unless moving begins at ten a second.
  mapper->SetMaximumImageSampleDistance(4.0);
  mapper->SetMinimumImageSampleDistance(1.0);
  mapper->CollectStatisticsOn();
  mapper->SetSpaceLeapingToOff();
  mapper->SetInteractiveSampleDistance(8.0);
  mapper->SetSampleDistance(0.5);
  scene.Window->SetDesiredUpdateRate(4.0);
  scene.Show();
  const double moving = mapper->GetStatistics()->GetSamplesPerRay();
  mapper->SetInteractiveUpdateRate(10.0);
  scene.Show();
  FFD_CHECK(mapper->GetStatistics()->GetSamplesPerRay() > 2.0 * moving);
  vtkNew<FFDErrorLog> refused;
  refused->Watch(mapper);
  mapper->SetInteractiveUpdateRate(std::nan(""));
  FFD_CHECK(refused->Had("InteractiveUpdateRate") && mapper->GetInteractiveUpdateRate() == 10.0);
  return EXIT_SUCCESS;
}

} // namespace

int TestMapperNames(int, char*[])
{
  FFD_CHECK(TestNames());
  FFD_CHECK(TestImages() == EXIT_SUCCESS);
  FFD_CHECK(TestNativeRanges() == EXIT_SUCCESS);
  FFD_CHECK(TestFrames() == EXIT_SUCCESS);
  return EXIT_SUCCESS;
}
