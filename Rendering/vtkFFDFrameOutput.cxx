// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFrameOutput.h"

#include "vtkFFDFrameCache.h"
#include "vtkFFDFrameScene.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDParallelFor.h"

#include "FFDClipToBox.h"
#include "FFDPixelBytes.h"
#include "Reference/FFDSurfaceSearch.h"

#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkHardwareSelector.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkRectilinearGrid.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
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

using Index = std::array<int, 3>;

/// Position of a point or cell in a grid of so many, in the order of identifiers.
vtkIdType FindPosition(const Index& index, const Index& counts)
{
  vtkIdType id = 0;
  for (std::size_t a = 3; a-- > 0;)
  {
    id = id * counts[a] + index[a];
  }
  return id;
}

/// The parts of an image that processes have; see vtkFFDPaintIdentifiers().
class Pieces
{
public:
  explicit Pieces(vtkDataSet* input)
    : Image(vtkImageData::SafeDownCast(input))
    , Array(this->Image
          ? vtkIntArray::SafeDownCast(this->Image->GetFieldData()->GetArray("FFD.Pieces"))
          : nullptr)
  {
    if (this->Array && this->Array->GetNumberOfComponents() != Width)
    {
      this->Array = nullptr;
    }
  }

  bool Exist() const { return this->Array != nullptr; }

  /// The most points that one of them has.
  vtkIdType GetMaximumNumberOfPoints() const
  {
    vtkIdType most = 0;
    for (vtkIdType n = 0; n < this->Array->GetNumberOfTuples(); ++n)
    {
      const Index counts = this->GetCounts(n, false);
      most = std::max(most, static_cast<vtkIdType>(counts[0]) * counts[1] * counts[2]);
    }
    return most;
  }

  /// The first piece that has a point, or cell, of the image, and its identifier there.
  bool Find(const Index& index, bool cells, int& process, int& block, vtkIdType& id) const
  {
    const int* start = this->Image->GetExtent();
    for (vtkIdType n = 0; n < this->Array->GetNumberOfTuples(); ++n)
    {
      const int* piece = this->Array->GetPointer(Width * n);
      const Index counts = this->GetCounts(n, cells);
      Index inside;
      bool has = piece[1] >= 0;
      for (std::size_t a = 0; a < 3; ++a)
      {
        inside[a] = index[a] + start[2 * a] - piece[2 + 2 * a];
        has = has && inside[a] >= 0 && inside[a] < counts[a];
      }
      if (has)
      {
        process = piece[0];
        block = piece[1];
        id = FindPosition(inside, counts);
        return true;
      }
    }
    return false;
  }

private:
  static constexpr int Width = 8; // of a piece in the array

  Index GetCounts(vtkIdType n, bool cells) const
  {
    const int* piece = this->Array->GetPointer(Width * n);
    Index counts;
    for (std::size_t a = 0; a < 3; ++a)
    {
      counts[a] = piece[3 + 2 * a] - piece[2 + 2 * a] + (cells ? 0 : 1);
    }
    return counts;
  }

  vtkImageData* Image;
  vtkIntArray* Array;
};

/// The point or cell of the input whose material is shown at a point of deformed space, and how
/// many there are along each axis.
Index FindIndex(vtkDataSet* input, const vtkFFDFrameCache& cache, const glm::dvec3& deformed,
  bool cells, Index& counts)
{
  const ffd::VolumeView& volume = cache.GetVolume();
  const ffd::BoundedPullBack& pullBack = cache.GetPullBack();
  const glm::dvec3 index = ffd::SurfaceSearch(
    volume, pullBack.Map, deformed, glm::dvec3(0.0), pullBack.Bounds.IsProvenInvertible())
                             .Evaluate(0.0)
                             .Index;
  const glm::dvec3 inside = glm::clamp(index, volume.LowerIndex(), volume.UpperIndex());
  const glm::dvec3 at = (volume.Axes ? volume.Axes->ToVoxel(inside) : inside) + volume.Margin;
  counts = { { 2, 2, 2 } };
  if (auto* image = vtkImageData::SafeDownCast(input))
  {
    image->GetDimensions(counts.data());
  }
  else if (auto* grid = vtkRectilinearGrid::SafeDownCast(input))
  {
    grid->GetDimensions(counts.data());
  }
  Index found;
  for (std::size_t a = 0; a < 3; ++a)
  {
    counts[a] = cells ? counts[a] - 1 : counts[a];
    const double along = at[static_cast<int>(a)];
    const auto which = static_cast<int>(std::floor(cells ? along : along + 0.5));
    found[a] = std::clamp(which, 0, counts[a] - 1);
  }
  return found;
}

} // namespace

//------------------------------------------------------------------------------
/// `colors`, premultiplied, as a picture of bytes.
void vtkFFDWriteColors(const std::vector<float>& colors, int width, int height,
  const vtkFFDParallelFor& parallelFor, vtkImageData* image)
{
  image->SetExtent(0, width - 1, 0, height - 1, 0, 0);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
  auto* const bytes = static_cast<unsigned char*>(image->GetScalarPointer());
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  parallelFor(pixels, [&](std::size_t first, std::size_t last) {
    ffd::WritePixelBytes(colors.data() + 4 * first, last - first, true, bytes + 4 * first);
  });
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
  const Pieces pieces(mapper->GetInput());
  // No piece has more cells than points.
  selector->UpdateMaximumPointId(
    pieces.Exist() ? pieces.GetMaximumNumberOfPoints() : mapper->GetInput()->GetNumberOfPoints());
  selector->UpdateMaximumCellId(
    pieces.Exist() ? pieces.GetMaximumNumberOfPoints() : mapper->GetInput()->GetNumberOfCells());
  const bool processes = pass == vtkHardwareSelector::PROCESS_PASS && pieces.Exist();
  const bool blocks = pass == vtkHardwareSelector::COMPOSITE_INDEX_PASS && pieces.Exist();
  const bool ofCells = cells ||
    ((processes || blocks) &&
      selector->GetFieldAssociation() == vtkDataObject::FIELD_ASSOCIATION_CELLS);
  float same[3] = { 0.0f, 0.0f, 0.0f };
  selector->GetPropColorValue(same);
  selector->EndRenderProp();
  const auto paint = [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
    {
      float* pixel = &colors[4 * i];
      const bool visible = pixel[3] > LeastPickedAlpha;
      std::copy_n(same, 3, pixel);
      if (visible && (identifiers || processes || blocks))
      {
        const glm::dvec2 ndc = camera.ToNdc(static_cast<double>(i % camera.ImageSize.x) + 0.5,
          static_cast<double>(i / camera.ImageSize.x) + 0.5);
        Index counts;
        const Index index = FindIndex(mapper->GetInput(), cache,
          camera.ToData(glm::dvec3(ndc, 2.0 * depths[i] - 1.0)), ofCells, counts);
        vtkIdType id = FindPosition(index, counts);
        int process = 0;
        int block = 0;
        const bool found = pieces.Exist() && pieces.Find(index, ofCells, process, block, id);
        if (identifiers)
        {
          vtkHardwareSelector::Convert(high ? id >> 24 : id, pixel);
        }
        else if (found && processes)
        {
          vtkHardwareSelector::Convert(process + 1, pixel); // 0 is that of no process
        }
        else if (found && block > 0)
        {
          vtkHardwareSelector::Convert(block, pixel);
        }
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
      depths[i] = static_cast<float>(camera.ToDepth(ray.At(leave)));
    }
  }
}
