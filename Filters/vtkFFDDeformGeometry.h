// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDDeformGeometry
 * @brief   move surfaces, points and their vectors with a deformed volume
 *
 * Contours, landmarks and tracts of a volume have to move as the volume does when it is drawn by
 * vtkFFDInverseRayVolumeMapper. This filter moves the points X of any vtkPointSet to where
 * the mapper shows the voxels of X:
 * - InverseMode EXACT: to T(X); vectors by the Jacobian J of T, normals by its inverse transposed,
 *   unit length. The same as vtkTransformFilter does with T.
 * - PULL_BACK: to T^-1(X), as T maps from the deformed to the rest position.
 * - FIRST_ORDER: to the P with 2P - T(P) = X, by Newton's method. Where that does not converge
 *   (folds) to T(X), which is P to first order; such points are counted.
 *
 * Use the same mode and deformation as the mapper. The deformation is that of SetDeformation(), or
 * else the lattice of the second input, which is either a data set with a lattice attached (the
 * volume itself, as vtkFFDDeformVolume puts it out) or an image of control points
 * (vtkFFDLatticeSource), or blocks that all have the same lattice, or else the lattice attached to
 * the input. With none of them the input
 * passes through, with an error. Any vtkAbstractTransform is used as it is, not approximated. The
 * times of both inputs are those of the output.
 *
 * Points, the active normals and the active vectors of points and cells are transformed, those of
 * a cell by the Jacobian at the mean of its points; all other arrays and the cells pass. Vectors
 * and normals of integer types become float. A lattice attached to the input is taken off. Points
 * that are not a number stay so. Points run on all cores, cells on one. Reports progress and obeys
 * AbortExecute (the output is then empty).
 *
 * @sa vtkFFDInverseRayVolumeMapper vtkFFDDeformVolume vtkTransformFilter
 */
#ifndef vtkFFDDeformGeometry_h
#define vtkFFDDeformGeometry_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkPointSetAlgorithm.h"

class vtkAbstractTransform;
class vtkDataObject;
class vtkFFDLattice;

class VTKFFDFILTERS_EXPORT vtkFFDDeformGeometry : public vtkPointSetAlgorithm
{
public:
  static vtkFFDDeformGeometry* New();
  vtkTypeMacro(vtkFFDDeformGeometry, vtkPointSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The deformation T, in the coordinates of the points, which are the data coordinates of the
   * volume. Null (default): see above.
   */
  virtual void SetDeformation(vtkAbstractTransform*);
  virtual vtkAbstractTransform* GetDeformation();
  ///@}

  ///@{
  /**
   * The second input: a data object with a lattice attached, which may be one of blocks, or an
   * image of control points.
   */
  void SetLatticeConnection(vtkAlgorithmOutput* connection);
  void SetLatticeData(vtkDataObject* data);
  ///@}

  /// Set/Get the mapper's method for the pull-back, as in vtkFFDInverseRayVolumeMapper.
  enum InverseModes
  {
    FIRST_ORDER,
    EXACT,
    PULL_BACK
  };

  ///@{
  /**
   * Default: EXACT.
   */
  vtkSetClampMacro(InverseMode, int, FIRST_ORDER, PULL_BACK);
  vtkGetMacro(InverseMode, int);
  void SetInverseModeToFirstOrder() { this->SetInverseMode(FIRST_ORDER); }
  void SetInverseModeToExact() { this->SetInverseMode(EXACT); }
  void SetInverseModeToPullBack() { this->SetInverseMode(PULL_BACK); }
  const char* GetInverseModeAsString() const;
  ///@}

  ///@{
  /**
   * Whether all 3-component point arrays are transformed as vectors, not only the active ones (and
   * the normals, as normals). Default: off.
   */
  vtkSetMacro(TransformAllInputVectors, vtkTypeBool);
  vtkGetMacro(TransformAllInputVectors, vtkTypeBool);
  vtkBooleanMacro(TransformAllInputVectors, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Whether the output has the points of the input as point data "RestPosition". Default: off.
   */
  vtkSetMacro(PassRestPositions, vtkTypeBool);
  vtkGetMacro(PassRestPositions, vtkTypeBool);
  vtkBooleanMacro(PassRestPositions, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Precision of the output points: vtkAlgorithm::DEFAULT_PRECISION (that of the input, the
   * default), SINGLE_PRECISION or DOUBLE_PRECISION.
   */
  vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DEFAULT_PRECISION);
  vtkGetMacro(OutputPointsPrecision, int);
  ///@}

  ///@{
  /**
   * Largest distance that is left between 2P - T(P) and X in FIRST_ORDER mode, data units, as a
   * fraction of the diagonal of the input's bounds (of 1 where that is 0). Default: 1e-6. Must be
   * positive.
   */
  virtual void SetInverseTolerance(double fraction);
  vtkGetMacro(InverseTolerance, double);
  ///@}

  /// Points of the last update that did not converge in FIRST_ORDER mode.
  vtkGetMacro(NumberOfUnconvergedPoints, vtkIdType);

  /// Includes the deformation.
  vtkMTimeType GetMTime() override;

  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDDeformGeometry();
  ~vtkFFDDeformGeometry() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDDeformGeometry(const vtkFFDDeformGeometry&) = delete;
  void operator=(const vtkFFDDeformGeometry&) = delete;

  vtkAbstractTransform* Deformation = nullptr;
  int InverseMode = EXACT;
  vtkTypeBool TransformAllInputVectors = 0;
  vtkTypeBool PassRestPositions = 0;
  int OutputPointsPrecision = DEFAULT_PRECISION;
  double InverseTolerance = 1e-6;
  vtkIdType NumberOfUnconvergedPoints = 0;
};

#endif
