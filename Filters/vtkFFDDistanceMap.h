// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDDistanceMap
 * @brief   distance to the nearest visible part of a volume, as image data
 *
 * Space leaping (section 4.6 of the paper) needs to know of every place how far it is at least to
 * something visible under the current opacity function. This filter puts out that map, for a look
 * at it or for programs of one's own. Distances are Chebyshev distances, the largest of the
 * distances along the axes: a place of distance d is the center of an empty cube.
 *
 * Resolution:
 * - BLOCKS (default): as vtkFFDInverseRayVolumeMapper leaps by them. One unsigned char for each
 *   block of 4^3 cells, in blocks: 0 where the block may hold something visible, 1 next to such a
 *   block, at most 255. The points of the output are the centers of the blocks.
 * - VOXELS: as in the paper. One unsigned short for each voxel, in voxels, on the grid of the
 *   input: 0 where the voxel is visible, 65535 everywhere if nothing is.
 *
 * The scalars of the output are called "Distance". The input is a vtkImageData with at least two
 * voxels along each axis; its active point scalars, or those of SetInputArrayToProcess(), need one
 * component, and a finite number among them. Voxels that are not a number are invisible. The whole
 * input is needed; visible blocks and voxels are found on all cores. Reports progress; VOXELS obeys
 * AbortExecute (the output is then empty).
 *
 * @sa vtkFFDInverseRayVolumeMapper
 */
#ifndef vtkFFDDistanceMap_h
#define vtkFFDDistanceMap_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkImageAlgorithm.h"

class vtkPiecewiseFunction;

class VTKFFDFILTERS_EXPORT vtkFFDDistanceMap : public vtkImageAlgorithm
{
public:
  static vtkFFDDistanceMap* New();
  vtkTypeMacro(vtkFFDDistanceMap, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The opacity function, as of vtkVolumeProperty::GetScalarOpacity(): a scalar is visible where
   * it is above 0. Required, with at least one point.
   */
  virtual void SetScalarOpacity(vtkPiecewiseFunction*);
  virtual vtkPiecewiseFunction* GetScalarOpacity();
  ///@}

  /// Resolution of the output.
  enum Resolutions
  {
    BLOCKS, ///< blocks of 4^3 cells, as the mapper's
    VOXELS  ///< single voxels
  };

  ///@{
  /**
   * Default: BLOCKS.
   */
  vtkSetClampMacro(Resolution, int, BLOCKS, VOXELS);
  vtkGetMacro(Resolution, int);
  void SetResolutionToBlocks() { this->SetResolution(BLOCKS); }
  void SetResolutionToVoxels() { this->SetResolution(VOXELS); }
  const char* GetResolutionAsString() const;
  ///@}

  /// Includes the opacity function.
  vtkMTimeType GetMTime() override;

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDDistanceMap();
  ~vtkFFDDistanceMap() override;

  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  void ReportReferences(vtkGarbageCollector* collector) override;

private:
  vtkFFDDistanceMap(const vtkFFDDistanceMap&) = delete;
  void operator=(const vtkFFDDistanceMap&) = delete;

  vtkPiecewiseFunction* ScalarOpacity = nullptr;
  int Resolution = BLOCKS;
};

#endif
