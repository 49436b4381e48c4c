// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * The grid and the scalars that a mapper renders, as the kernels see them. Private to this module:
 * not installed, not wrapped. Takes vtkImageData and vtkRectilinearGrid, scalars of points or of
 * cells, and blanked points and cells (any flag of vtkGhostType, as vtkGPUVolumeRayCastMapper).
 */
#ifndef vtkFFDVoxels_h
#define vtkFFDVoxels_h

#include "FFDAxisMap.h"
#include "FFDCellMask.h"
#include "FFDStage.h"
#include "FFDVolumeView.h"

#include "vtkSmartPointer.h"

#include <array>
#include <cstddef>
#include <string>

class vtkDataArray;
class vtkDataSet;

namespace ffd
{

/// The voxels with equal steps between them: what MakeVoxels() completes.
struct UniformView
{
  VolumeView View;

  bool operator==(const UniformView& other) const;
};

/// The grid, its ghost arrays, and where they matter the coordinates of its axes, with their times.
struct GridSources
{
  Source<vtkDataSet> Grid; ///< the time is that of vtkFFDGetContentTime()
  /// Of points and of cells. Grids that share their scalars may have other ones at the same time.
  std::array<Source<vtkDataArray>, 2> Ghosts;
  std::array<Source<vtkDataArray>, 3> Coordinates;

  static GridSources FromDataSet(vtkDataSet* input);
  bool operator==(const GridSources& other) const
  {
    return this->Grid == other.Grid && this->Ghosts == other.Ghosts &&
      this->Coordinates == other.Coordinates;
  }
};

/// The result of MakeVoxels(), which View points into.
struct Voxels
{
  VolumeView View;
  vtkSmartPointer<vtkDataArray> Scalars;
  bool OfCells = false;
  AxisMap Axes;
  CellMask Hidden;
  bool HasHidden = false;

  /// Cells where there is nothing; null if there are none.
  const CellMask* GetHidden() const { return this->HasHidden ? &this->Hidden : nullptr; }
};

/// Check the input and look at its voxels; `ofCells`: whose scalars. False and a message for the
/// user if they cannot be rendered.
bool FindUniformView(
  vtkDataSet* input, vtkDataArray* scalars, bool ofCells, UniformView& view, std::string& message);

/// Makes the geometry of the voxels and the mask of hidden ones.
Made MakeVoxels(Voxels& voxels, StageTools& tools, const UniformView& view, const GridSources& grid,
  const Source<vtkDataArray>& scalars, bool ofCells);

/// A view of further scalars of the same points or cells. False and a message if that cannot be.
bool MakeFurtherView(
  const Voxels& voxels, vtkDataArray* scalars, VolumeView& view, std::string& message);

} // namespace ffd

#endif
