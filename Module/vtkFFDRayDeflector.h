// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDRayDeflector
 * @brief   a ray deflector after Kurzion and Yagel
 *
 * Y. Kurzion and R. Yagel, "Space Deformation Using Ray Deflectors", Eurographics Workshop on
 * Rendering 1995 (reference [10] of the paper), deform what a picture shows by bending the rays in
 * a sphere: a deflector. This is one as a VTK transform, so that vtkFFDInverseRayVolumeMapper (and
 * any filter that takes a transform) draws with it; vtkGeneralTransform concatenates several.
 *
 * The transform moves space within Radius of Center, most at the center, by the weight
 * a = (1 - (distance / Radius)^2)^3, and nothing outside:
 * - TRANSLATE: X + a * Vector.
 * - ROTATE: turned by a * Angle about the axis Vector through Center.
 * - SCALE: away from Center by the factor 1 + a * (Factor - 1).
 *
 * In the mapper's FIRST_ORDER mode a ray at P is followed at 2P - T(P), moved the opposite way by
 * the same field: this is how a deflector bends rays. EXACT uses the inverse of the map, which is
 * in closed form or found by a bracketed search, so that what is moved arrives where it should.
 *
 * IsFoldFree() tells whether the map is one-to-one: TRANSLATE by less than 0.582 Radius, SCALE by
 * a factor above 0 and below 2.531, ROTATE always. The weight is of this project, with two
 * continuous derivatives, so that the mapper's lattice follows it closely.
 *
 * Setters refuse what is not finite or out of range, with an error; SetDeflectorType() clamps.
 *
 * @sa vtkFFDBarrTransform vtkFFDInverseRayVolumeMapper vtkGeneralTransform
 */
#ifndef vtkFFDRayDeflector_h
#define vtkFFDRayDeflector_h

#include "vtkFFDCoreModule.h" // For export macro
#include "vtkFFDWarpTransform.h"

#include <memory> // for std::unique_ptr

class VTKFFDCORE_EXPORT vtkFFDRayDeflector : public vtkFFDWarpTransform
{
public:
  static vtkFFDRayDeflector* New();
  vtkTypeMacro(vtkFFDRayDeflector, vtkFFDWarpTransform);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Kinds of deflectors, by their effect on the space around the center.
  enum DeflectorTypes
  {
    TRANSLATE, ///< moves it
    ROTATE,    ///< turns it about an axis
    SCALE      ///< makes it larger or smaller
  };

  ///@{
  /**
   * Default: TRANSLATE.
   */
  vtkSetClampMacro(DeflectorType, int, TRANSLATE, SCALE);
  vtkGetMacro(DeflectorType, int);
  void SetDeflectorTypeToTranslate() { this->SetDeflectorType(TRANSLATE); }
  void SetDeflectorTypeToRotate() { this->SetDeflectorType(ROTATE); }
  void SetDeflectorTypeToScale() { this->SetDeflectorType(SCALE); }
  const char* GetDeflectorTypeAsString();
  ///@}

  ///@{
  /**
   * Data coordinates. Default: the origin.
   */
  void SetCenter(double x, double y, double z);
  void SetCenter(const double center[3]);
  vtkGetVector3Macro(Center, double);
  ///@}

  ///@{
  /**
   * Data units, positive. Default: 1.
   */
  void SetRadius(double radius);
  vtkGetMacro(Radius, double);
  ///@}

  ///@{
  /**
   * Displacement of the center (TRANSLATE) or axis of rotation (ROTATE; zero is no rotation), data
   * units. Default: 0, 0, 0.
   */
  void SetVector(double x, double y, double z);
  void SetVector(const double vector[3]);
  vtkGetVector3Macro(Vector, double);
  ///@}

  ///@{
  /**
   * Degrees, of ROTATE, finite. Default: 0.
   */
  void SetAngle(double degrees);
  vtkGetMacro(Angle, double);
  ///@}

  ///@{
  /**
   * Factor of SCALE, positive. Default: 1.
   */
  void SetFactor(double factor);
  vtkGetMacro(Factor, double);
  ///@}

  /// Whether the map is one-to-one, see above.
  bool IsFoldFree();

  vtkAbstractTransform* MakeTransform() override;

protected:
  vtkFFDRayDeflector();
  ~vtkFFDRayDeflector() override;

  void InternalUpdate() override;
  void InternalDeepCopy(vtkAbstractTransform* transform) override;

private:
  vtkFFDRayDeflector(const vtkFFDRayDeflector&) = delete;
  void operator=(const vtkFFDRayDeflector&) = delete;

  const vtkFFDWarpKernel& GetKernel() const override;

  bool SetTriple(const char* name, double member[3], const double values[3]);

  int DeflectorType = TRANSLATE;
  double Center[3] = { 0.0, 0.0, 0.0 };
  double Radius = 1.0;
  double Vector[3] = { 0.0, 0.0, 0.0 };
  double Angle = 0.0;
  double Factor = 1.0;

  class Internals;
  std::unique_ptr<Internals> Map;
};

#endif
