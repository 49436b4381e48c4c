// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVoxels.h"

#include "FFDGridIndex.h"

#include "vtkFFDContentTime.h"
#include "vtkFFDVolumeViewFromImage.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace ffd
{
namespace
{

/// Whether there are flags, whatever they say: as in vtkGPUVolumeRayCastMapper all of them hide.
bool HasAny(vtkUnsignedCharArray* ghosts, vtkIdType count)
{
  if (!ghosts || ghosts->GetNumberOfTuples() < count)
  {
    return false;
  }
  const unsigned char* p = ghosts->GetPointer(0);
  return std::any_of(p, p + count, [](unsigned char g) { return g != 0; });
}

/// A grid of equal steps with the dimensions and bounds of a rectilinear one.
void MakeUniform(vtkRectilinearGrid* grid, vtkImageData* image)
{
  int extent[6];
  double bounds[6];
  grid->GetExtent(extent);
  grid->GetBounds(bounds);
  double spacing[3];
  for (int a = 0; a < 3; ++a)
  {
    const int steps = extent[2 * a + 1] - extent[2 * a];
    spacing[a] = steps > 0 ? (bounds[2 * a + 1] - bounds[2 * a]) / steps : 1.0;
  }
  image->SetDimensions(
    extent[1] - extent[0] + 1, extent[3] - extent[2] + 1, extent[5] - extent[4] + 1);
  image->SetOrigin(bounds[0], bounds[2], bounds[4]);
  image->SetSpacing(spacing);
}

/// Positions of the voxels of a rectilinear grid.
bool MakeAxes(vtkRectilinearGrid* grid, const GridSources& sources, bool ofCells, AxisMap& axes,
  std::string& message)
{
  int dims[3];
  grid->GetDimensions(dims);
  std::vector<double> positions[3];
  for (int a = 0; a < 3; ++a)
  {
    const int n = dims[a];
    std::vector<double> x(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i)
    {
      x[static_cast<std::size_t>(i)] = sources.Coordinates[a].Object->GetComponent(i, 0);
    }
    for (std::size_t i = 1; i < x.size(); ++i)
    {
      if (!(x[i] > x[i - 1]) || !std::isfinite(x[i]) || !std::isfinite(x[i - 1]))
      {
        std::ostringstream why;
        why << "The coordinates of the rectilinear grid do not rise along axis " << a << ": number "
            << i - 1 << " is " << x[i - 1] << ", number " << i << " is " << x[i] << ". Order them.";
        message = why.str();
        return false;
      }
    }
    // To the index coordinates of the grid of equal steps.
    const double first = x.front();
    const double perIndex = (x.back() - first) / (n - 1);
    std::vector<double>& p = positions[a];
    if (!ofCells)
    {
      for (double each : x)
      {
        p.push_back((each - first) / perIndex);
      }
    }
    else
    {
      // Faces and centers of the cells in turn, cells of equal steps counted from their centers.
      for (std::size_t i = 0; i < x.size(); ++i)
      {
        const double face = (x[i] - first) / perIndex - 0.5;
        if (i > 0)
        {
          p.push_back(0.5 * (p.back() + face));
        }
        p.push_back(face);
      }
    }
  }
  axes = ofCells ? AxisMap(positions, -0.5, 0.5) : AxisMap(positions, 0.0, 1.0);
  return true;
}

/// The blanked cells, those of blanked points among them.
void MakeHidden(const GridSources& sources, Voxels& voxels)
{
  const glm::ivec3 cells = voxels.View.Dimensions - (voxels.OfCells ? 0 : 1);
  const glm::ivec3 points = cells + 1;
  const vtkIdType numberOfCells = static_cast<vtkIdType>(cells.x) * cells.y * cells.z;
  const vtkIdType numberOfPoints = static_cast<vtkIdType>(points.x) * points.y * points.z;
  auto* pointGhosts = vtkUnsignedCharArray::SafeDownCast(sources.Ghosts[0].Object);
  auto* cellGhosts = vtkUnsignedCharArray::SafeDownCast(sources.Ghosts[1].Object);
  const bool byCells = HasAny(cellGhosts, numberOfCells);
  const bool byPoints = HasAny(pointGhosts, numberOfPoints);
  voxels.HasHidden = byCells || byPoints;
  voxels.Hidden = voxels.HasHidden ? CellMask(cells) : CellMask();
  if (!voxels.HasHidden)
  {
    return;
  }
  const unsigned char* cellGhost = byCells ? cellGhosts->GetPointer(0) : nullptr;
  const unsigned char* pointGhost = byPoints ? pointGhosts->GetPointer(0) : nullptr;
  vtkIdType cell = 0;
  for (int k = 0; k < cells.z; ++k)
  {
    for (int j = 0; j < cells.y; ++j)
    {
      for (int i = 0; i < cells.x; ++i, ++cell)
      {
        bool hidden = cellGhost && cellGhost[cell] != 0;
        for (int corner = 0; pointGhost && !hidden && corner < 8; ++corner)
        {
          const std::size_t point =
            GridIndex(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2), points);
          hidden = pointGhost[point] != 0;
        }
        if (hidden)
        {
          voxels.Hidden.Add({ i, j, k });
        }
      }
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
bool UniformView::operator==(const UniformView& other) const
{
  const VolumeView& a = this->View;
  const VolumeView& b = other.View;
  return a.Scalars == b.Scalars && a.Type == b.Type && a.Dimensions == b.Dimensions &&
    std::equal(a.Increments, a.Increments + 3, b.Increments) && a.Components == b.Components &&
    a.Margin == b.Margin && a.FirstVoxel == b.FirstVoxel && a.IndexToData == b.IndexToData;
}

//------------------------------------------------------------------------------
GridSources GridSources::FromDataSet(vtkDataSet* input)
{
  GridSources sources;
  sources.Grid = { input, vtkFFDGetContentTime(input) };
  vtkDataSetAttributes* const attributes[2] = { input->GetPointData(), input->GetCellData() };
  for (std::size_t i = 0; i < 2; ++i)
  {
    if (vtkDataArray* const ghosts =
          attributes[i]->GetArray(vtkDataSetAttributes::GhostArrayName()))
    {
      sources.Ghosts[i] = { ghosts, ghosts->GetMTime() };
    }
  }
  if (auto* grid = vtkRectilinearGrid::SafeDownCast(input))
  {
    vtkDataArray* const coordinates[3] = { grid->GetXCoordinates(), grid->GetYCoordinates(),
      grid->GetZCoordinates() };
    for (int a = 0; a < 3; ++a)
    {
      sources.Coordinates[a] = { coordinates[a], coordinates[a]->GetMTime() };
    }
  }
  return sources;
}

//------------------------------------------------------------------------------
bool FindUniformView(
  vtkDataSet* input, vtkDataArray* scalars, bool ofCells, UniformView& view, std::string& message)
{
  vtkImageData* image = vtkImageData::SafeDownCast(input);
  vtkRectilinearGrid* grid = vtkRectilinearGrid::SafeDownCast(input);
  vtkNew<vtkImageData> uniform;
  if (grid)
  {
    vtkDataArray* const coordinates[3] = { grid->GetXCoordinates(), grid->GetYCoordinates(),
      grid->GetZCoordinates() };
    int dims[3];
    grid->GetDimensions(dims);
    for (int a = 0; a < 3; ++a)
    {
      const vtkIdType count = coordinates[a] ? coordinates[a]->GetNumberOfTuples() : 0;
      if (count < dims[a])
      {
        message = "The rectilinear grid has " + std::to_string(count) + " coordinates along axis " +
          std::to_string(a) + " for its " + std::to_string(dims[a]) +
          " points there. Give it as many.";
        return false;
      }
    }
    MakeUniform(grid, uniform);
    image = uniform;
  }
  if (!image)
  {
    message = std::string("The input is a ") + input->GetClassName() +
      "; this mapper renders vtkImageData and vtkRectilinearGrid. Resample it with "
      "vtkResampleToImage.";
    return false;
  }
  return vtkFFDVolumeViewFromImage(image, scalars, true, view.View, message, ofCells);
}

//------------------------------------------------------------------------------
Made MakeVoxels(Voxels& voxels, StageTools& tools, const UniformView& view, const GridSources& grid,
  const Source<vtkDataArray>& scalars, bool ofCells)
{
  voxels.View = view.View;
  voxels.Scalars = scalars.Object;
  voxels.OfCells = ofCells;
  if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(grid.Grid.Object))
  {
    if (!MakeAxes(rectilinear, grid, ofCells, voxels.Axes, tools.Message))
    {
      return Made::Not;
    }
    // One of equal steps, up to rounding, is an image.
    constexpr double rounding = 1e-4; // voxels
    voxels.View.Axes = voxels.Axes.IsEven(rounding) ? nullptr : &voxels.Axes;
  }
  MakeHidden(grid, voxels);
  return Made::Anew;
}

//------------------------------------------------------------------------------
bool MakeFurtherView(
  const Voxels& voxels, vtkDataArray* scalars, VolumeView& view, std::string& message)
{
  vtkNew<vtkImageData> image;
  const glm::ivec3 points = voxels.View.Dimensions + (voxels.OfCells ? 1 : 0);
  image->SetDimensions(points.x, points.y, points.z);
  if (!vtkFFDVolumeViewFromImage(image, scalars, true, view, message, voxels.OfCells))
  {
    return false;
  }
  view.FirstVoxel = voxels.View.FirstVoxel;
  view.IndexToData = voxels.View.IndexToData;
  view.DataToIndex = voxels.View.DataToIndex;
  view.Axes = voxels.View.Axes;
  return true;
}

} // namespace ffd
