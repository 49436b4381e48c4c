// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDSplineTransform
 * @brief   Evaluates uniform B-splines of order 1, 2 or 3 over a grid of displacements.
 *
 * ITK and elastix write splines of order 1 and 2 besides cubic ones; no lattice is equal to them.
 * This transform is: T(X) = X + D(X), where D is the sum of the grid's displacements, each weighted
 * by the product over the axes of the centered B-spline of that order at the distance from its
 * point in spacings. With order 3 it is what vtkFFDLattice and vtkBSplineTransform are, slower;
 * with order 1 it interpolates linearly, without vtkGridTransform's steps of 2^-16 cells.
 *
 * Beyond the grid displacements are zero (the deformation fades out within (SplineOrder + 1) / 2
 * spacings), or with RepeatBorder those at the border. ITK and elastix do not deform where not all
 * (SplineOrder + 1)^3 control points exist.
 *
 * The inverse is found by Newton's method, within InverseTolerance (data units) of the point, in at
 * most InverseIterations steps. vtkFFDInverseRayVolumeMapper approximates the transform by a
 * lattice, within its PositionTolerance.
 *
 * @sa vtkFFDTransformReader vtkFFDLattice vtkFFDSumTransform
 */
#ifndef vtkFFDSplineTransform_h
#define vtkFFDSplineTransform_h

#include "vtkFFDCoreModule.h" // For export macro
#include "vtkFFDWarpTransform.h"
#include "vtkSmartPointer.h" // for vtkSmartPointer

#include <memory> // for std::unique_ptr

class vtkImageData;

class VTKFFDCORE_EXPORT vtkFFDSplineTransform : public vtkFFDWarpTransform
{
public:
  static vtkFFDSplineTransform* New();
  vtkTypeMacro(vtkFFDSplineTransform, vtkFFDWarpTransform);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Degree of the polynomials, 1 to 3. Default: 2.
   */
  vtkSetClampMacro(SplineOrder, int, 1, 3);
  vtkGetMacro(SplineOrder, int);
  ///@}

  ///@{
  /**
   * The displacements, data units, as point scalars of 3 components; origin, spacing and extent of
   * the image say where the control points rest, its direction is not used. Null, or an image
   * without them, of a spacing of zero, or with a number that is not finite (these with an error):
   * the identity. Referenced, also by deep copies of the transform. Default: none.
   */
  void SetDisplacementGrid(vtkImageData* grid);
  vtkImageData* GetDisplacementGrid();
  ///@}

  ///@{
  /**
   * Whether the displacements at the border go on beyond it. Default: off.
   */
  vtkSetMacro(RepeatBorder, vtkTypeBool);
  vtkGetMacro(RepeatBorder, vtkTypeBool);
  vtkBooleanMacro(RepeatBorder, vtkTypeBool);
  ///@}

  vtkMTimeType GetMTime() override;
  vtkAbstractTransform* MakeTransform() override;

protected:
  vtkFFDSplineTransform();
  ~vtkFFDSplineTransform() override;

  void InternalUpdate() override;
  void InternalDeepCopy(vtkAbstractTransform* transform) override;

private:
  vtkFFDSplineTransform(const vtkFFDSplineTransform&) = delete;
  void operator=(const vtkFFDSplineTransform&) = delete;

  const vtkFFDWarpKernel& GetKernel() const override;

  class Internals;
  int SplineOrder = 2;
  vtkTypeBool RepeatBorder = 0;
  vtkSmartPointer<vtkImageData> DisplacementGrid;
  std::unique_ptr<Internals> Map;
};

#endif
