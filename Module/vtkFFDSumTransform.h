// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDSumTransform
 * @brief   Adds the displacements of several transforms.
 *
 * T(X) = X + the sum of Weight_i (T_i(X) - X). That is how elastix combines a transform with its
 * initial one when it adds them (HowToCombineTransforms "Add"), and what its
 * WeightedCombinationTransform does. Without terms it is the identity. vtkGeneralTransform is for
 * transforms that are applied one after the other.
 *
 * The inverse is found by Newton's method, within InverseTolerance (data units) of the point, in at
 * most InverseIterations steps. vtkFFDInverseRayVolumeMapper approximates the transform by a
 * lattice, within its PositionTolerance.
 *
 * @sa vtkFFDTransformReader vtkFFDSplineTransform
 */
#ifndef vtkFFDSumTransform_h
#define vtkFFDSumTransform_h

#include "vtkFFDCoreModule.h" // For export macro
#include "vtkFFDWarpTransform.h"

#include <memory> // for std::unique_ptr

class VTKFFDCORE_EXPORT vtkFFDSumTransform : public vtkFFDWarpTransform
{
public:
  static vtkFFDSumTransform* New();
  vtkTypeMacro(vtkFFDSumTransform, vtkFFDWarpTransform);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Add a term. A null transform, this one itself or one that depends on it, and a weight that is
   * not finite are refused with an error. The transform is referenced, not copied.
   */
  void AddTransform(vtkAbstractTransform* transform, double weight = 1.0);
  /// No terms: the identity.
  void RemoveAllTransforms();
  /// Number of terms.
  int GetNumberOfTransforms();
  ///@{
  /**
   * The terms, from 0; null and 0 out of range.
   */
  vtkAbstractTransform* GetTransform(int i);
  double GetWeight(int i);
  ///@}

  int CircuitCheck(vtkAbstractTransform* transform) override;
  vtkMTimeType GetMTime() override;
  vtkAbstractTransform* MakeTransform() override;

protected:
  vtkFFDSumTransform();
  ~vtkFFDSumTransform() override;

  void InternalUpdate() override;
  void InternalDeepCopy(vtkAbstractTransform* transform) override;

private:
  vtkFFDSumTransform(const vtkFFDSumTransform&) = delete;
  void operator=(const vtkFFDSumTransform&) = delete;

  const vtkFFDWarpKernel& GetKernel() const override;

  class Internals;
  std::unique_ptr<Internals> Map;
};

#endif
