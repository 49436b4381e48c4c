// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDJacobian
 * @brief   local change of volume of a deformation, and where it folds, on an image grid
 *
 * At each point of the input's grid the determinant of the Jacobian of the deformation T: 1 where
 * volume is kept, below 1 where it shrinks, 0 or less where T folds. The output is the input, its
 * arrays shared, with two more point arrays: "JacobianDeterminant" (float, the active scalars) and
 * "FoldMask" (unsigned char, 1 where the determinant is not above FoldThreshold, else 0). The input
 * needs no scalars of its own. Its grid may be turned; points are in data coordinates.
 *
 * The deformation is that of SetDeformation(), or else the lattice attached to the input (which
 * stays attached). With neither the determinant is 1, with an error.
 *
 * The mask samples the grid: a fold between points can be missed. vtkFFDLattice::IsFoldFree()
 * proves that there is none. Streams by extent, runs on all cores, reports progress and obeys
 * AbortExecute (the output is then empty).
 *
 * @sa vtkFFDLattice vtkFFDResampleVolume
 */
#ifndef vtkFFDJacobian_h
#define vtkFFDJacobian_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkImageAlgorithm.h"

class vtkAbstractTransform;

class VTKFFDFILTERS_EXPORT vtkFFDJacobian : public vtkImageAlgorithm
{
public:
  static vtkFFDJacobian* New();
  vtkTypeMacro(vtkFFDJacobian, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The deformation T; any transform, used as it is. Null (default): see above.
   */
  virtual void SetDeformation(vtkAbstractTransform*);
  virtual vtkAbstractTransform* GetDeformation();
  ///@}

  ///@{
  /**
   * Largest determinant that FoldMask marks, finite. Default: 0, proper folds.
   */
  virtual void SetFoldThreshold(double determinant);
  vtkGetMacro(FoldThreshold, double);
  ///@}

  ///@{
  /**
   * Results of the last update: the smallest and the largest finite determinant (1, -1 without
   * any), and the number of points that are marked.
   */
  vtkGetVector2Macro(DeterminantRange, double);
  vtkGetMacro(NumberOfFoldedPoints, vtkIdType);
  ///@}

  /// Includes the deformation.
  vtkMTimeType GetMTime() override;

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDJacobian();
  ~vtkFFDJacobian() override;

  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDJacobian(const vtkFFDJacobian&) = delete;
  void operator=(const vtkFFDJacobian&) = delete;

  vtkAbstractTransform* Deformation = nullptr;
  double FoldThreshold = 0.0;
  double DeterminantRange[2] = { 1.0, -1.0 };
  vtkIdType NumberOfFoldedPoints = 0;
};

#endif
