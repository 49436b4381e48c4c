// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDBarrTransform
 * @brief   Barr's global deformations: taper, twist and bend
 *
 * The deformations of A. Barr, "Global and Local Deformations of Solid Primitives", SIGGRAPH 1984
 * (reference [1] of the paper), as a VTK transform: with derivative and inverse in closed form, so
 * vtkFFDInverseRayVolumeMapper::SetDeformation(), vtkTransformFilter and vtkImageReslice take it,
 * and vtkGeneralTransform concatenates it with others.
 *
 * Along Axis the deformation runs from Range[0] to Range[1] (data coordinates); beyond, it goes on
 * as at the end.
 * - TAPER: the two other axes are scaled about Center, by Scale[0] at the lower to Scale[1] at the
 *   upper end.
 * - TWIST: they are turned about Center, right-handed about Axis, by 0 at the lower to Angle at the
 *   upper end. Keeps volume.
 * - BEND: Axis is bent towards BendAxis into an arc of Angle degrees; the line through Center keeps
 *   its length, and Center its place and direction. Beyond the ends it goes straight on. One-to-one
 *   on this side of the center of curvature, which is (Range[1] - Range[0]) / Angle (in radians)
 *   from Center along BendAxis.
 *
 * Defaults: BEND by 0 degrees, that is none; Axis z towards x, Range -0.5 to 0.5 and Center the
 * origin. Setters refuse what is not finite or out of range, with an error;
 * SetDeformationType() clamps.
 *
 * The mapper approximates it by a lattice, within its PositionTolerance. A taper or twist whose
 * ends lie within the volume has a crease there with the linear profile of the original;
 * SmoothProfile avoids that.
 *
 * @sa vtkFFDRayDeflector vtkFFDLatticeSource vtkFFDInverseRayVolumeMapper
 */
#ifndef vtkFFDBarrTransform_h
#define vtkFFDBarrTransform_h

#include "vtkFFDCoreModule.h" // For export macro
#include "vtkFFDWarpTransform.h"

#include <memory> // for std::unique_ptr

class VTKFFDCORE_EXPORT vtkFFDBarrTransform : public vtkFFDWarpTransform
{
public:
  static vtkFFDBarrTransform* New();
  vtkTypeMacro(vtkFFDBarrTransform, vtkFFDWarpTransform);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Barr's deformations.
  enum DeformationTypes
  {
    TAPER, ///< scales across the axis
    TWIST, ///< turns about the axis
    BEND   ///< bends the axis to an arc
  };

  ///@{
  /**
   * Default: BEND.
   */
  vtkSetClampMacro(DeformationType, int, TAPER, BEND);
  vtkGetMacro(DeformationType, int);
  void SetDeformationTypeToTaper() { this->SetDeformationType(TAPER); }
  void SetDeformationTypeToTwist() { this->SetDeformationType(TWIST); }
  void SetDeformationTypeToBend() { this->SetDeformationType(BEND); }
  const char* GetDeformationTypeAsString();
  ///@}

  ///@{
  /**
   * The axis that the deformation runs along, 0 to 2. Default: 2. An axis that BendAxis was makes
   * BendAxis the next one.
   */
  void SetAxis(int axis);
  vtkGetMacro(Axis, int);
  ///@}

  ///@{
  /**
   * The axis that BEND bends towards (for a positive angle), 0 to 2 and not Axis. Default: 0.
   */
  void SetBendAxis(int axis);
  vtkGetMacro(BendAxis, int);
  ///@}

  ///@{
  /**
   * Data coordinates.
   */
  void SetCenter(double x, double y, double z);
  void SetCenter(const double center[3]);
  vtkGetVector3Macro(Center, double);
  ///@}

  ///@{
  /**
   * Set/Get the begin and end of the deformation along Axis, data coordinates, first < last.
   */
  void SetRange(double first, double last);
  void SetRange(const double range[2]);
  vtkGetVector2Macro(Range, double);
  ///@}

  ///@{
  /**
   * Degrees, of TWIST and BEND, finite. Default: 0. BEND by more than 360 either way bends by 360,
   * with a warning when the transform is updated.
   */
  void SetAngle(double degrees);
  vtkGetMacro(Angle, double);
  ///@}

  ///@{
  /**
   * Scales of TAPER at the two ends, positive. Default: 1, 1.
   */
  void SetScale(double first, double last);
  void SetScale(const double scale[2]);
  vtkGetVector2Macro(Scale, double);
  ///@}

  ///@{
  /**
   * Whether TAPER and TWIST change along the range as a quintic that sets out and ends flat,
   * instead of a line. Default: off.
   */
  vtkSetMacro(SmoothProfile, vtkTypeBool);
  vtkGetMacro(SmoothProfile, vtkTypeBool);
  vtkBooleanMacro(SmoothProfile, vtkTypeBool);
  ///@}

  /// Center and Range from the bounds of what is deformed, which must have an extent along Axis:
  /// call it after SetAxis().
  void FitToBounds(const double bounds[6]);

  vtkAbstractTransform* MakeTransform() override;

protected:
  vtkFFDBarrTransform();
  ~vtkFFDBarrTransform() override;

  void InternalUpdate() override;
  void InternalDeepCopy(vtkAbstractTransform* transform) override;

private:
  vtkFFDBarrTransform(const vtkFFDBarrTransform&) = delete;
  void operator=(const vtkFFDBarrTransform&) = delete;

  const vtkFFDWarpKernel& GetKernel() const override;

  int DeformationType = BEND;
  int Axis = 2;
  int BendAxis = 0;
  double Center[3] = { 0.0, 0.0, 0.0 };
  double Range[2] = { -0.5, 0.5 };
  double Angle = 0.0;
  double Scale[2] = { 1.0, 1.0 };
  vtkTypeBool SmoothProfile = 0;

  class Internals;
  std::unique_ptr<Internals> Map;
};

#endif
