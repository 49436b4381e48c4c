// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFrameOutput.h"

#include "vtkFFDFrameCache.h"
#include "vtkFFDFrameScene.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDParallelFor.h"

#include "FFDClipToBox.h"
#include "FFDSurfaceSearch.h"

#include "vtkDataObject.h"
#include "vtkHardwareSelector.h"
#include "vtkImageData.h"
#include "vtkRectilinearGrid.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace
{

/// Depths, 0 to 1, as numbers of a type: 255 or 65535 times as large as integers.
template <typename T>
void WriteDepths(const std::vector<float>& depths, double scale, T* numbers)
{
  for (std::size_t i = 0; i < depths.size(); ++i)
  {
    const double depth = std::clamp(static_cast<double>(depths[i]), 0.0, 1.0);
    numbers[i] = static_cast<T>(scale == 1.0 ? depth : scale * depth + 0.5);
  }
}

/// Pixels with more alpha than this can be picked, as with VTK's GPU mapper.
constexpr float LeastPickedAlpha = 3.0f / 255.0f;

/// The point or cell of the input whose material is shown at a point of deformed space.
vtkIdType FindIdentifier(
  vtkDataSet* input, const vtkFFDFrameCache& cache, const glm::dvec3& deformed, bool cells)
{
  const ffd::VolumeView& volume = cache.GetVolume();
  const glm::dvec3 index =
    ffd::SurfaceSearch(volume, cache.GetPullBack().Map, deformed, glm::dvec3(0.0))
      .Evaluate(0.0)
      .Index;
  const glm::dvec3 inside = glm::clamp(index, volume.LowerIndex(), volume.UpperIndex());
  const glm::dvec3 at = (volume.Axes ? volume.Axes->ToVoxel(inside) : inside) + volume.Margin;
  int points[3] = { 2, 2, 2 };
  if (auto* image = vtkImageData::SafeDownCast(input))
  {
    image->GetDimensions(points);
  }
  else if (auto* grid = vtkRectilinearGrid::SafeDownCast(input))
  {
    grid->GetDimensions(points);
  }
  vtkIdType id = 0;
  for (int a = 2; a >= 0; --a)
  {
    const vtkIdType count = cells ? points[a] - 1 : points[a];
    const auto which = static_cast<vtkIdType>(std::floor(cells ? at[a] : at[a] + 0.5));
    id = id * count + std::clamp<vtkIdType>(which, 0, count - 1);
  }
  return id;
}

} // namespace

//------------------------------------------------------------------------------
/// `colors`, premultiplied, as a picture of bytes.
void vtkFFDWriteColors(
  const std::vector<float>& colors, int width, int height, bool premultiplied, vtkImageData* image)
{
  image->SetExtent(0, width - 1, 0, height - 1, 0, 0);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
  auto* bytes = static_cast<unsigned char*>(image->GetScalarPointer());
  const auto toByte = [](float value) {
    return static_cast<unsigned char>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f);
  };
  const std::size_t count = 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (std::size_t i = 0; i < count; i += 4)
  {
    const float alpha = colors[i + 3];
    const float scale = premultiplied ? 1.0f : alpha > 0.0f ? 1.0f / alpha : 0.0f;
    for (std::size_t c = 0; c < 3; ++c)
    {
      bytes[i + c] = toByte(colors[i + c] * scale);
    }
    bytes[i + 3] = toByte(alpha);
  }
}

//------------------------------------------------------------------------------
void vtkFFDWriteDepths(const std::vector<float>& depths, int scalarType, vtkImageData* image)
{
  switch (scalarType)
  {
    case VTK_UNSIGNED_CHAR:
      image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
      WriteDepths(depths, 255.0, static_cast<unsigned char*>(image->GetScalarPointer()));
      break;
    case VTK_UNSIGNED_SHORT:
      image->AllocateScalars(VTK_UNSIGNED_SHORT, 1);
      WriteDepths(depths, 65535.0, static_cast<unsigned short*>(image->GetScalarPointer()));
      break;
    default:
      image->AllocateScalars(VTK_FLOAT, 1);
      WriteDepths(depths, 1.0, static_cast<float*>(image->GetScalarPointer()));
      break;
  }
}

//------------------------------------------------------------------------------
/// Whether a pass of a selector reads what the volume draws.
bool vtkFFDIsPassRead(vtkHardwareSelector* selector)
{
  const int field = selector->GetFieldAssociation();
  switch (selector->GetCurrentPass())
  {
    case vtkHardwareSelector::POINT_ID_LOW24:
    case vtkHardwareSelector::POINT_ID_HIGH24:
      return field == vtkDataObject::FIELD_ASSOCIATION_POINTS;
    case vtkHardwareSelector::CELL_ID_LOW24:
    case vtkHardwareSelector::CELL_ID_HIGH24:
      return field == vtkDataObject::FIELD_ASSOCIATION_CELLS;
    default:
      return true;
  }
}

//------------------------------------------------------------------------------
void vtkFFDPaintIdentifiers(vtkHardwareSelector* selector, vtkFFDInverseRayVolumeMapper* mapper,
  const vtkFFDFrameCache& cache, const ffd::CameraView& camera, const std::vector<float>& depths,
  std::vector<float>& colors)
{
  const int pass = selector->GetCurrentPass();
  const bool cells =
    pass == vtkHardwareSelector::CELL_ID_LOW24 || pass == vtkHardwareSelector::CELL_ID_HIGH24;
  const bool high =
    pass == vtkHardwareSelector::POINT_ID_HIGH24 || pass == vtkHardwareSelector::CELL_ID_HIGH24;
  const bool identifiers = cells || high || pass == vtkHardwareSelector::POINT_ID_LOW24;
  selector->BeginRenderProp();
  if (pass == vtkHardwareSelector::COMPOSITE_INDEX_PASS)
  {
    selector->RenderCompositeIndex(1); // as surfaces that are not of composite data
  }
  selector->UpdateMaximumPointId(mapper->GetInput()->GetNumberOfPoints());
  selector->UpdateMaximumCellId(mapper->GetInput()->GetNumberOfCells());
  float same[3] = { 0.0f, 0.0f, 0.0f };
  selector->GetPropColorValue(same);
  selector->EndRenderProp();
  const auto paint = [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
    {
      float* pixel = &colors[4 * i];
      const bool visible = pixel[3] > LeastPickedAlpha;
      std::copy_n(same, 3, pixel);
      if (visible && identifiers)
      {
        const glm::dvec2 ndc = camera.ToNdc(static_cast<double>(i % camera.ImageSize.x) + 0.5,
          static_cast<double>(i / camera.ImageSize.x) + 0.5);
        const vtkIdType id = FindIdentifier(
          mapper->GetInput(), cache, camera.ToData(glm::dvec3(ndc, 2.0 * depths[i] - 1.0)), cells);
        vtkHardwareSelector::Convert(high ? id >> 24 : id, pixel);
      }
      pixel[3] = visible ? 1.0f : 0.0f;
      for (int c = 0; c < 3 && !visible; ++c)
      {
        pixel[c] = 0.0f;
      }
    }
  };
  vtkFFDParallelFor(mapper->GetNumberOfThreads())(depths.size(), paint);
}

//------------------------------------------------------------------------------
void vtkFFDMoveToBackface(vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache,
  const ffd::CameraView& camera, const std::vector<float>& colors, std::vector<float>& depths)
{
  const ffd::Box bounds = vtkFFDFrameScene::FindVisibleBounds(mapper, cache);
  for (std::size_t i = 0; i < depths.size(); ++i)
  {
    if (colors[4 * i + 3] > 0.0f)
    {
      continue;
    }
    const ffd::ViewRay ray = camera.MakeRay(static_cast<double>(i % camera.ImageSize.x) + 0.5,
      static_cast<double>(i / camera.ImageSize.x) + 0.5);
    double enter = 0.0;
    double leave = ray.Far;
    if (ffd::ClipToBox(ray.Origin, ray.Direction, bounds, enter, leave))
    {
      const glm::dvec4 clip =
        camera.DataToNdc * glm::dvec4(ray.Origin + leave * ray.Direction, 1.0);
      depths[i] = static_cast<float>(0.5 * (clip.z / clip.w + 1.0));
    }
  }
}
