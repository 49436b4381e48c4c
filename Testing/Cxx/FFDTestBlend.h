// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What the tests of blend modes, cropping and clipping planes share: equal settings for the three
// mappers, and the deformed volume as voxels for those of VTK.
#ifndef FFDTestBlend_h
#define FFDTestBlend_h

#include "FFDTestScenes.h"

#include "vtkBSplineTransform.h"
#include "vtkContourValues.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDRayStatistics.h"
#include "vtkFFDResampleVolume.h"
#include "vtkImageData.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"

#include <cstring>
#include <functional>
#include <sstream>
#include <string>

namespace ffdTest
{

/// Calls `set` with each of the three mappers.
inline void ForAllMappers(Scene& scene, const std::function<void(vtkVolumeMapper*)>& set)
{
  set(scene.Ours);
  set(scene.Fixed);
  set(scene.Gpu);
}

inline void SetBlendMode(Scene& scene, int mode)
{
  ForAllMappers(scene, [mode](vtkVolumeMapper* m) { m->SetBlendMode(mode); });
}

/// The deformed volume as floats on a grid of `spacing` voxels, transparent around it.
inline vtkSmartPointer<vtkImageData> Resample(
  vtkImageData* image, vtkAbstractTransform* deformation, double spacing, double background)
{
  double size[3];
  image->GetSpacing(size);
  vtkNew<vtkFFDResampleVolume> resample;
  resample->SetInputData(image);
  resample->SetDeformation(deformation);
  resample->SetOutputSpacing(spacing * size[0], spacing * size[1], spacing * size[2]);
  resample->SetBackgroundLevel(background);
  resample->Update();
  return resample->GetOutput();
}

/// Our RGBA bytes and depths, without a window.
struct Bytes
{
  std::vector<unsigned char> Colors;
  std::vector<float> Depths;
};

inline Bytes RenderBytes(Scene& scene, int size)
{
  vtkNew<vtkImageData> colors;
  vtkNew<vtkImageData> depths;
  Bytes bytes;
  if (scene.Ours->RenderToImage(scene.Renderer, scene.Volume, size, size, colors, depths))
  {
    const auto* c = static_cast<const unsigned char*>(colors->GetScalarPointer());
    const auto* d = static_cast<const float*>(depths->GetScalarPointer());
    bytes.Colors.assign(c, c + 4 * size * size);
    bytes.Depths.assign(d, d + size * size);
  }
  return bytes;
}

/// Leaping changes neither colors nor depths, by more than rounding; `leaps`: whether it has to
/// leave samples out.
inline void CheckLeaping(Scene& scene, const std::string& name, bool leaps, Checks& checks)
{
  constexpr int Size = 90;
  const int before = scene.Ours->GetSpaceLeaping();
  scene.Ours->CollectStatisticsOn();
  scene.Ours->SetSpaceLeapingToOff();
  const Bytes off = RenderBytes(scene, Size);
  const double samplesOff = scene.Ours->GetStatistics()->GetSamplesPerRay();
  for (const int leaping :
    { vtkFFDInverseRayVolumeMapper::SEGMENT, vtkFFDInverseRayVolumeMapper::LIPSCHITZ })
  {
    scene.Ours->SetSpaceLeaping(leaping);
    const Bytes on = RenderBytes(scene, Size);
    const double samples = scene.Ours->GetStatistics()->GetSamplesPerRay();
    int largest = off.Colors.empty() || on.Colors.empty() ? 255 : 0;
    double depth = 0.0;
    int visible = 0;
    for (std::size_t i = 0; i < std::min(on.Colors.size(), off.Colors.size()); ++i)
    {
      largest = std::max(largest, std::abs(on.Colors[i] - off.Colors[i]));
      visible += i % 4 == 3 && off.Colors[i] > 0 ? 1 : 0;
    }
    for (std::size_t i = 0; i < std::min(on.Depths.size(), off.Depths.size()); ++i)
    {
      depth = std::max(depth, std::abs(static_cast<double>(on.Depths[i]) - off.Depths[i]));
    }
    std::ostringstream figures;
    figures << "largest difference " << largest << " (at most 1), of depths " << depth
            << " (at most 1e-5), samples per ray " << samplesOff << ", " << samples << "; "
            << visible << " px";
    checks.Expect(largest <= 1 && depth <= 1e-5 && visible > 280 &&
        (leaps ? samples < samplesOff : samples == samplesOff),
      name + ", " + scene.Ours->GetSpaceLeapingAsString() + " against OFF", figures.str());
  }
  scene.Ours->SetSpaceLeaping(before);
}

} // namespace ffdTest

#endif
