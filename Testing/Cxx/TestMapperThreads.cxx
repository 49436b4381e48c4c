// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Several threads render at the same time, each with a mapper of its own and another number of
// threads: the number is a property of the mapper, not of the process, and changes no picture. They
// may share a property and a deformation, too, from the first frame on.

#include "FFDTestHelpers.h"

#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkFFDBarrTransform.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDResampleVolume.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkRenderer.h"
#include "vtkSMPTools.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

namespace
{

constexpr int VolumeSide = 24;
constexpr int Side = 48;
constexpr int Edits = 4;
constexpr int Threads = 4;

using Bytes = std::vector<unsigned char>;

void Append(vtkImageData* image, Bytes& bytes)
{
  const auto* first = static_cast<const unsigned char*>(image->GetScalarPointer());
  bytes.insert(
    bytes.end(), first, first + image->GetNumberOfPoints() * image->GetNumberOfScalarComponents());
}

/// The pictures of a lattice that is edited `Edits` times, and the last volume resampled.
Bytes RenderEdits(int threads)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(VolumeSide, VolumeSide, VolumeSide);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* voxel = static_cast<unsigned char*>(image->GetScalarPointer());
  for (int k = 0; k < VolumeSide; ++k)
  {
    for (int j = 0; j < VolumeSide; ++j)
    {
      for (int i = 0; i < VolumeSide; ++i)
      {
        *voxel++ = static_cast<unsigned char>(
          128.0 + 120.0 * std::sin(0.7 * i) * std::sin(0.5 * j) * std::sin(0.4 * k));
      }
    }
  }
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(6, 6, 6);
  lattice->FitToBounds(image->GetBounds(), 0.0);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(130.0, 0.0);
  opacity->AddPoint(255.0, 0.4);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0.0, 1.0, 0.4, 0.2);
  color->AddRGBPoint(255.0, 0.2, 0.9, 1.0);
  vtkNew<vtkVolumeProperty> property;
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  property->SetInterpolationTypeToLinear();
  property->ShadeOn();
  vtkNew<vtkFFDInverseRayVolumeMapper> mapper;
  mapper->SetInputData(image);
  mapper->SetDeformation(lattice);
  mapper->SetNumberOfThreads(threads);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->SetProperty(property);
  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(volume);

  Bytes all;
  for (int edit = 0; edit < Edits; ++edit)
  {
    FFDRandom random(edit);
    random.Shape(lattice, 0.4);
    renderer->ResetCamera();
    vtkNew<vtkImageData> colors;
    if (!mapper->RenderToImage(renderer, volume, Side, Side, colors))
    {
      return Bytes();
    }
    Append(colors, all);
  }
  vtkNew<vtkFFDResampleVolume> resample;
  resample->SetInputData(image);
  resample->SetDeformation(lattice);
  resample->SetNumberOfThreads(threads);
  resample->Update();
  Append(resample->GetOutput(), all);
  return all;
}

/// Several threads begin with a property whose functions are not all there yet.
bool RenderWithNewProperty()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(4, 4, 4);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  image->GetPointData()->GetScalars()->Fill(100.0);
  vtkNew<vtkVolumeProperty> property;
  std::atomic<int> ready{ 0 };
  std::atomic<int> rendered{ 0 };
  std::vector<std::thread> threads;
  for (int i = 0; i < Threads; ++i)
  {
    threads.emplace_back([&] {
      vtkNew<vtkImageData> own;
      own->ShallowCopy(image);
      vtkNew<vtkFFDInverseRayVolumeMapper> mapper;
      mapper->SetInputData(own);
      vtkNew<vtkVolume> volume;
      volume->SetMapper(mapper);
      volume->SetProperty(property);
      vtkNew<vtkRenderer> renderer;
      renderer->AddVolume(volume);
      renderer->ResetCamera();
      vtkNew<vtkImageData> colors;
      ++ready;
      while (ready < Threads)
      {
        std::this_thread::yield();
      }
      rendered += mapper->RenderToImage(renderer, volume, 8, 8, colors) ? 1 : 0;
    });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  return rendered == Threads;
}

/// Several threads begin with a deformation that has just been changed. A null lattice: with the
/// one that is attached to the volume.
bool RenderWithSharedDeformation(vtkAbstractTransform* deformation, vtkImageData* image)
{
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(0.0, 0.5);
  vtkNew<vtkVolumeProperty> property;
  property->SetScalarOpacity(opacity);
  std::atomic<int> ready{ 0 };
  std::vector<Bytes> pictures(Threads);
  std::vector<std::thread> threads;
  for (int i = 0; i < Threads; ++i)
  {
    threads.emplace_back([&, i] {
      vtkNew<vtkImageData> own;
      own->ShallowCopy(image);
      vtkNew<vtkFFDInverseRayVolumeMapper> mapper;
      mapper->SetInputData(own);
      mapper->SetDeformation(deformation);
      vtkNew<vtkVolume> volume;
      volume->SetMapper(mapper);
      volume->SetProperty(property);
      vtkNew<vtkRenderer> renderer;
      renderer->AddVolume(volume);
      ++ready;
      while (ready < Threads)
      {
        std::this_thread::yield();
      }
      renderer->ResetCamera();
      vtkNew<vtkImageData> colors;
      if (mapper->RenderToImage(renderer, volume, Side, Side, colors))
      {
        Append(colors, pictures[i]);
      }
    });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  return !pictures[0].empty() &&
    std::count(pictures.begin(), pictures.end(), pictures[0]) == Threads;
}

bool RenderWithSharedDeformations()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(8, 8, 8);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  image->GetPointData()->GetScalars()->Fill(100.0);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(5, 5, 5);
  lattice->FitToBounds(image->GetBounds(), 0.0);
  vtkNew<vtkFFDBarrTransform> barr;
  barr->SetDeformationTypeToTwist();
  barr->SetCenter(3.5, 3.5, 3.5);
  barr->SetRange(-3.5, 3.5);
  for (int edit = 0; edit < 6; ++edit)
  {
    FFDRandom random(edit);
    random.Shape(lattice, 0.3);
    barr->SetAngle(2.0 * edit);
    vtkNew<vtkImageData> attached;
    attached->ShallowCopy(image);
    lattice->AttachTo(attached);
    if (!RenderWithSharedDeformation(lattice, image) ||
      !RenderWithSharedDeformation(lattice->GetInverse(), image) ||
      !RenderWithSharedDeformation(barr, image) || !RenderWithSharedDeformation(nullptr, attached))
    {
      return false;
    }
  }
  return true;
}

} // namespace

int TestMapperThreads(int, char*[])
{
  const Bytes serial = RenderEdits(1);
  FFD_CHECK(!serial.empty());
  const int before = vtkSMPTools::GetEstimatedNumberOfThreads();
  std::vector<Bytes> results(Threads);
  std::vector<std::thread> threads;
  for (int i = 0; i < Threads; ++i)
  {
    // 1, 2, 3 and as many as there are.
    threads.emplace_back([&results, i] { results[i] = RenderEdits((i + 1) % Threads); });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  for (const Bytes& result : results)
  {
    FFD_CHECK(result == serial);
  }
  FFD_CHECK(vtkSMPTools::GetEstimatedNumberOfThreads() == before);
  for (int i = 0; i < 300; ++i)
  {
    FFD_CHECK(RenderWithNewProperty());
  }
  FFD_CHECK(RenderWithSharedDeformations());
  return EXIT_SUCCESS;
}
