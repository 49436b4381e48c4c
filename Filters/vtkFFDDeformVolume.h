// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDDeformVolume
 * @brief   attach a lattice to image data, so that it renders deformed
 *
 * The output is the input image, its arrays shared and not copied, with a lattice in its field
 * data (vtkFFDLattice::AttachTo()). vtkFFDInverseRayVolumeMapper draws it deformed; writers save
 * it. Nothing is resampled.
 *
 * The lattice is that of SetLattice(), or else the image of control points at the second input
 * (vtkFFDLatticeSource, a .vti file), or else the one already attached to the input. With none of
 * them the input passes through, with an error.
 *
 * @sa vtkFFDLattice vtkFFDLatticeSource vtkFFDInverseRayVolumeMapper
 */
#ifndef vtkFFDDeformVolume_h
#define vtkFFDDeformVolume_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkImageAlgorithm.h"
#include "vtkSmartPointer.h" // for vtkSmartPointer

class vtkFFDLattice;

class VTKFFDFILTERS_EXPORT vtkFFDDeformVolume : public vtkImageAlgorithm
{
public:
  static vtkFFDDeformVolume* New();
  vtkTypeMacro(vtkFFDDeformVolume, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The lattice to attach; its edits re-execute the filter. Null (default): see above.
   */
  void SetLattice(vtkFFDLattice* lattice);
  vtkFFDLattice* GetLattice();
  ///@}

  ///@{
  /**
   * The second input: an image of control points, as vtkFFDLattice::FromImageData() takes.
   */
  void SetLatticeConnection(vtkAlgorithmOutput* connection);
  void SetLatticeData(vtkImageData* image);
  ///@}

  /// Includes the lattice.
  vtkMTimeType GetMTime() override;

protected:
  vtkFFDDeformVolume();
  ~vtkFFDDeformVolume() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDDeformVolume(const vtkFFDDeformVolume&) = delete;
  void operator=(const vtkFFDDeformVolume&) = delete;

  vtkSmartPointer<vtkFFDLattice> Lattice;
};

#endif
