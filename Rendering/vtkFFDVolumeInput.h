// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDVolumeInput
 * @brief   the grid and the scalars that a mapper renders, as the kernels see them
 *
 * Private to this module: not installed, not wrapped. Takes vtkImageData and vtkRectilinearGrid,
 * scalars of points or of cells, and blanked points and cells (any flag of vtkGhostType, as
 * vtkGPUVolumeRayCastMapper).
 */
#ifndef vtkFFDVolumeInput_h
#define vtkFFDVolumeInput_h

#include "FFDAxisMap.h"
#include "FFDCellMask.h"
#include "FFDVolumeView.h"

#include "vtkSmartPointer.h"
#include "vtkTimeStamp.h"
#include "vtkType.h"

#include <cstddef>
#include <string>

class vtkDataArray;
class vtkDataSet;

class vtkFFDVolumeInput
{
public:
  /// Bring the view up to date; `ofCells`: whose scalars. Returns false and a message for the user
  /// when the input cannot be rendered.
  bool Update(vtkDataSet* input, vtkDataArray* scalars, bool ofCells, std::string& message);

  /// The same for further scalars of the same points or cells; only of the view's kind.
  bool MakeView(vtkDataArray* scalars, ffd::VolumeView& view, std::string& message) const;

  const ffd::VolumeView& GetView() const { return this->View; }
  vtkDataArray* GetScalars() const { return this->Scalars; }

  /// Cells where there is nothing; null if there are none.
  const ffd::CellMask* GetHidden() const { return this->HasHidden ? &this->Hidden : nullptr; }

  /// When voxels, or where they are, have changed last.
  vtkMTimeType GetMTime() const { return this->Changed.GetMTime(); }

  std::size_t GetMemorySize() const { return this->Hidden.GetMemorySize(); }

private:
  bool UpdateAxes(vtkDataSet* input, std::string& message);
  void UpdateHidden(vtkDataSet* input);

  const void* Input = nullptr; // not owned: only compared
  vtkSmartPointer<vtkDataArray> Scalars;
  vtkMTimeType InputTime = 0;
  vtkMTimeType ScalarsTime = 0;
  bool OfCells = false;
  vtkTimeStamp Changed;
  ffd::VolumeView View;
  ffd::AxisMap Axes;
  ffd::CellMask Hidden;
  bool HasHidden = false;
};

#endif
