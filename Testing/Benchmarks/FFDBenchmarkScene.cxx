// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBenchmarkScene.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"

#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkDoubleArray.h"
#include "vtkFixedPointVolumeRayCastMapper.h"
#include "vtkImageData.h"
#include "vtkImageReslice.h"
#include "vtkLight.h"
#include "vtkMath.h"
#include "vtkPiecewiseFunction.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"
#include "vtkXMLImageDataReader.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>

namespace ffdBenchmark
{

namespace
{

/// Slices of the engine that hold something.
constexpr int EngineSlices = 113;

/// Control points per axis.
constexpr int LatticeSide = 8;

/// A channel that differs by more counts as an outlier.
constexpr int OutlierThreshold = 32;

} // namespace

//------------------------------------------------------------------------------
const char* GetName(Opacity opacity)
{
  static const char* const names[] = { "semi", "opaque", "sparse" };
  return names[static_cast<int>(opacity)];
}

//------------------------------------------------------------------------------
std::string GetName(const Deformation& deformation)
{
  static const char* const names[] = { "identity", "smooth", "random" };
  const std::string name = names[static_cast<int>(deformation.Form)];
  return deformation.Form == Shape::Identity
    ? name
    : name + std::to_string(static_cast<int>(std::lround(deformation.Magnitude)));
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkVolumeProperty> MakeProperty(Opacity opacity)
{
  vtkNew<vtkPiecewiseFunction> alpha;
  if (opacity == Opacity::Semi)
  {
    alpha->AddPoint(70.0, 0.0);
    alpha->AddPoint(255.0, 0.03 * (255.0 - 70.0) / 150.0);
  }
  else
  {
    const double start = opacity == Opacity::Opaque ? 70.0 : 150.0;
    alpha->AddPoint(start, 0.0);
    alpha->AddPoint(start + 20.0, 0.9);
    alpha->AddPoint(255.0, 0.9);
  }
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0.0, 1.0, 0.5, 0.0);
  color->AddRGBPoint(255.0, 1.0, 1.0, 1.0);
  auto property = vtkSmartPointer<vtkVolumeProperty>::New();
  property->SetScalarOpacity(alpha);
  property->SetColor(color);
  property->SetScalarOpacityUnitDistance(1.0);
  property->SetInterpolationTypeToLinear();
  property->ShadeOn();
  property->SetAmbient(0.2);
  property->SetDiffuse(0.7);
  property->SetSpecular(0.2);
  property->SetSpecularPower(8.0);
  return property;
}

//------------------------------------------------------------------------------
void Deform(vtkFFDLattice* lattice, vtkImageData* image, const Deformation& deformation, int side)
{
  double bounds[6];
  image->GetBounds(bounds);
  lattice->SetDimensions(side, side, side);
  lattice->FitToBounds(bounds);
  lattice->Reset();
  const double magnitude = deformation.Magnitude;
  // Not std::uniform_real_distribution: its numbers differ between standard libraries.
  std::mt19937 generator(3);
  const auto uniform = [&generator] {
    return 2.0 * static_cast<double>(generator()) / 4294967295.0 - 1.0;
  };
  const auto halfCosine = [&bounds](const double p[3], int axis) {
    const double length = bounds[2 * axis + 1] - bounds[2 * axis];
    return std::cos(vtkMath::Pi() * ((p[axis] - bounds[2 * axis]) / length - 0.5));
  };
  for (int k = 0; k < side; ++k)
  {
    for (int j = 0; j < side; ++j)
    {
      for (int i = 0; i < side; ++i)
      {
        double p[3];
        lattice->GetRestPoint(i, j, k, p);
        if (deformation.Form == Shape::Smooth)
        {
          lattice->SetDisplacement(
            i, j, k, magnitude * halfCosine(p, 2), 22.0 / 45.0 * magnitude * halfCosine(p, 0), 0.0);
        }
        else if (deformation.Form == Shape::Random)
        {
          const double x = magnitude * uniform();
          const double y = magnitude * uniform();
          const double z = magnitude * uniform();
          lattice->SetDisplacement(i, j, k, x, y, z);
        }
      }
    }
  }
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> ReadVolume(const std::string& folder, const std::string& name)
{
  const std::string path = folder + "/" + name + ".vti";
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkSmartPointer<vtkImageData> image = reader->GetOutput();
  if (reader->GetErrorCode() != 0 || image->GetNumberOfPoints() == 0)
  {
    std::cerr << "ffd_benchmark: cannot read " << path << "; give the folder of the test data "
              << "with --data=FOLDER.\n";
    std::exit(EXIT_FAILURE);
  }
  if (name == "engine")
  {
    int extent[6];
    image->GetExtent(extent);
    extent[5] = extent[4] + EngineSlices - 1;
    image->Crop(extent);
  }
  return image;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> ResampleToCube(vtkImageData* image, int side)
{
  double bounds[6];
  image->GetBounds(bounds);
  double spacing[3];
  for (int a = 0; a < 3; ++a)
  {
    spacing[a] = (bounds[2 * a + 1] - bounds[2 * a]) / (side - 1);
  }
  vtkNew<vtkImageReslice> reslice;
  reslice->SetInputData(image);
  reslice->SetInterpolationModeToLinear();
  reslice->SetOutputOrigin(bounds[0], bounds[2], bounds[4]);
  reslice->SetOutputSpacing(spacing);
  reslice->SetOutputExtent(0, side - 1, 0, side - 1, 0, side - 1);
  reslice->Update();
  vtkSmartPointer<vtkImageData> cube = reslice->GetOutput();
  cube->SetOrigin(0.0, 0.0, 0.0);
  cube->SetSpacing(1.0, 1.0, 1.0);
  return cube;
}

//------------------------------------------------------------------------------
Stage::Stage(int size, vtkImageData* image)
  : Size(size)
{
  this->Window->SetOffScreenRendering(1);
  this->Window->SetMultiSamples(0);
  this->Window->SetSize(size, size);
  // Everybody has all the time they want: no adaptive sample distances anywhere.
  this->Window->SetDesiredUpdateRate(1e-4);
  this->Window->AddRenderer(this->Renderer);
  this->Renderer->SetBackground(0.0, 0.0, 0.0);
  // The ambient color of VTK's lights is black. Ours takes a single headlight to be white, as the
  // GPU mapper does, vtkFixedPointVolumeRayCastMapper does not.
  vtkNew<vtkLight> headlight;
  headlight->SetLightTypeToHeadlight();
  headlight->SetAmbientColor(1.0, 1.0, 1.0);
  this->Renderer->AddLight(headlight);
  double bounds[6];
  image->GetBounds(bounds);
  const double center[3] = { 0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]),
    0.5 * (bounds[4] + bounds[5]) };
  double direction[3] = { -0.5, -0.35, -1.0 };
  vtkMath::Normalize(direction);
  // Widths of 256 fill three quarters of the picture; other sizes as much.
  const double distance = 700.0 / 255.0 * (bounds[1] - bounds[0]);
  vtkCamera* camera = this->Renderer->GetActiveCamera();
  camera->SetFocalPoint(center);
  camera->SetPosition(center[0] - distance * direction[0], center[1] - distance * direction[1],
    center[2] - distance * direction[2]);
  camera->SetViewUp(0.0, 1.0, 0.0);
  camera->SetViewAngle(2.0 * vtkMath::DegreesFromRadians(std::atan(0.25)));
  camera->SetClippingRange(0.1 * distance, 3.0 * distance);
}

//------------------------------------------------------------------------------
Stage::~Stage() = default;

//------------------------------------------------------------------------------
vtkRenderer* Stage::GetRenderer() { return this->Renderer; }

//------------------------------------------------------------------------------
vtkVolume* Stage::AddVolume(vtkVolumeMapper* mapper, vtkVolumeProperty* property)
{
  auto volume = vtkSmartPointer<vtkVolume>::New();
  volume->SetMapper(mapper);
  volume->SetProperty(property);
  volume->VisibilityOff();
  this->Renderer->AddVolume(volume);
  this->Volumes.push_back(volume);
  return volume;
}

//------------------------------------------------------------------------------
void Stage::Draw(vtkVolume* volume)
{
  for (vtkVolume* each : this->Volumes)
  {
    each->SetVisibility(each == volume);
  }
  this->Window->Render();
  this->Window->WaitForCompletion();
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkUnsignedCharArray> Stage::Capture()
{
  auto pixels = vtkSmartPointer<vtkUnsignedCharArray>::New();
  this->Window->GetPixelData(0, 0, this->Size - 1, this->Size - 1, 0, pixels);
  return pixels;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkUnsignedCharArray> Stage::DrawAndCapture(vtkVolume* volume)
{
  this->Draw(volume);
  return this->Capture();
}

//------------------------------------------------------------------------------
Difference Compare(vtkUnsignedCharArray* a, vtkUnsignedCharArray* b, int size, int block)
{
  Difference difference;
  const vtkIdType values = static_cast<vtkIdType>(size) * size * 3;
  if (a->GetNumberOfValues() != values || b->GetNumberOfValues() != values)
  {
    difference.Mean = 255.0;
    difference.Outliers = 1.0;
    return difference;
  }
  const int blocks = size / block;
  int covered = 0;
  int outliers = 0;
  double sum = 0.0;
  for (int v = 0; v < blocks; ++v)
  {
    for (int u = 0; u < blocks; ++u)
    {
      double means[2][3] = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
      for (int y = v * block; y < (v + 1) * block; ++y)
      {
        for (int x = u * block; x < (u + 1) * block; ++x)
        {
          const vtkIdType pixel = 3 * (static_cast<vtkIdType>(y) * size + x);
          for (int c = 0; c < 3; ++c)
          {
            means[0][c] += a->GetValue(pixel + c) / static_cast<double>(block * block);
            means[1][c] += b->GetValue(pixel + c) / static_cast<double>(block * block);
          }
        }
      }
      double largest = 0.0;
      bool something = false;
      for (int c = 0; c < 3; ++c)
      {
        const double d = std::abs(means[0][c] - means[1][c]);
        sum += d;
        largest = std::max(largest, d);
        something = something || means[0][c] > 0.0 || means[1][c] > 0.0;
      }
      covered += something ? 1 : 0;
      outliers += largest > OutlierThreshold ? 1 : 0;
    }
  }
  if (covered > 0)
  {
    difference.Mean = sum / (3.0 * covered);
    difference.Outliers = static_cast<double>(outliers) / covered;
  }
  difference.Covered = static_cast<double>(covered) / (static_cast<double>(blocks) * blocks);
  return difference;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkFFDInverseRayVolumeMapper> MakeMapper(
  vtkImageData* image, vtkFFDLattice* lattice, Variant variant)
{
  auto mapper = vtkSmartPointer<vtkFFDInverseRayVolumeMapper>::New();
  mapper->SetInputData(image);
  mapper->SetDeformation(lattice);
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetSampleDistance(1.0);
  switch (variant)
  {
    case Variant::Exact:
      break;
    case Variant::FirstOrder:
      mapper->SetInverseModeToFirstOrder();
      break;
    case Variant::PullBack:
      mapper->SetInverseModeToPullBack();
      break;
    case Variant::Paper:
      mapper->SetInverseModeToFirstOrder();
      mapper->SetSegmentationToGreedyAngle();
      mapper->SetMaximumSegmentLength(8.0);
      mapper->SetSpaceLeapingToSegment();
      mapper->SetOpacityLengthToMaterial();
      break;
    case Variant::Unoptimized:
      mapper->SetSpaceLeapingToOff();
      mapper->SetEarlyRayTerminationThreshold(0.0);
      break;
  }
  return mapper;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkFFDInverseRayVolumeMapper> MakeOracle(
  vtkImageData* image, vtkFFDLattice* lattice, Variant variant)
{
  auto mapper = MakeMapper(image, lattice, Variant::Exact);
  mapper->ReferenceKernelsOn();
  if (variant == Variant::FirstOrder || variant == Variant::Paper)
  {
    mapper->SetInverseModeToFirstOrder();
  }
  if (variant == Variant::PullBack)
  {
    mapper->SetInverseModeToPullBack();
  }
  if (variant == Variant::Paper)
  {
    mapper->SetOpacityLengthToMaterial();
  }
  return mapper;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkVolumeMapper> MakeFixedPointMapper()
{
  auto mapper = vtkSmartPointer<vtkFixedPointVolumeRayCastMapper>::New();
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetSampleDistance(1.0);
  mapper->SetInteractiveSampleDistance(1.0);
  mapper->SetImageSampleDistance(1.0);
  return mapper;
}

} // namespace ffdBenchmark
