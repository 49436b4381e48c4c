// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDWarpTransform
 * @brief   What the transforms here that are no lattices share.
 *
 * An abstract class: the methods of vtkWarpTransform in both precisions, by one map in double
 * precision, its Jacobian matrix and its inverse, which a class gives.
 *
 * @sa vtkFFDBarrTransform vtkFFDRayDeflector vtkFFDSplineTransform vtkFFDSumTransform
 */
#ifndef vtkFFDWarpTransform_h
#define vtkFFDWarpTransform_h

#include "vtkFFDCoreModule.h" // For export macro
#include "vtkWarpTransform.h"

class vtkFFDWarpKernel;

class VTKFFDCORE_EXPORT vtkFFDWarpTransform : public vtkWarpTransform
{
public:
  vtkTypeMacro(vtkFFDWarpTransform, vtkWarpTransform);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The largest error of an inverse that has no closed form, data units, and the most steps to find
   * it. A tolerance that is not finite and positive, and less than one step, are refused with an
   * error. Defaults: 0.001 and 500.
   */
  void SetInverseTolerance(double tolerance) override;
  void SetInverseIterations(int iterations) override;
  ///@}

protected:
  vtkFFDWarpTransform();
  ~vtkFFDWarpTransform() override;

  /// Copies whether this is an inverse, and how inverses are found.
  void InternalDeepCopy(vtkAbstractTransform* transform) override;

  void ForwardTransformPoint(const float in[3], float out[3]) override;
  void ForwardTransformPoint(const double in[3], double out[3]) override;
  void ForwardTransformDerivative(const float in[3], float out[3], float derivative[3][3]) override;
  void ForwardTransformDerivative(
    const double in[3], double out[3], double derivative[3][3]) override;
  void InverseTransformPoint(const float in[3], float out[3]) override;
  void InverseTransformPoint(const double in[3], double out[3]) override;
  void InverseTransformDerivative(const float in[3], float out[3], float derivative[3][3]) override;
  void InverseTransformDerivative(
    const double in[3], double out[3], double derivative[3][3]) override;

private:
  vtkFFDWarpTransform(const vtkFFDWarpTransform&) = delete;
  void operator=(const vtkFFDWarpTransform&) = delete;

  virtual const vtkFFDWarpKernel& GetKernel() const = 0;
};

#endif
