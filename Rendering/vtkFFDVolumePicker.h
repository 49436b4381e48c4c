// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDVolumePicker
 * @brief   pick the visible surface of deformed volumes, and the voxel that has moved there
 *
 * A vtkVolumePicker that sees volumes as vtkFFDInverseRayVolumeMapper renders them. Everything else
 * in the scene (surfaces, images, volumes of other mappers) it picks as its superclasses do, and
 * the first hit along the ray wins. Put it in the place of a vtkVolumePicker or vtkCellPicker:
 *
 * @code
 * vtkNew<vtkFFDVolumePicker> picker;
 * if (picker->Pick(x, y, 0.0, renderer))
 * {
 *   picker->GetPickPosition(world);   // of the deformed surface
 *   picker->GetRestPosition(rest);    // of the same material in the volume at rest
 *   picker->GetPointId();             // the voxel
 * }
 * @endcode
 *
 * The surface is where the scalar opacity function first exceeds VolumeOpacityIsovalue, as with
 * vtkVolumePicker: with 0, where the volume begins to be visible at all. Scalars are interpolated
 * and classified as in the picture. The pull-back of the mapper's InverseMode is evaluated at every
 * step and the crossing is bisected, so the position is not that of a sample but exact: to a
 * billionth of a voxel. Steps are at most half a voxel long in the volume at rest.
 *
 * Clipping planes, cropping regions (in the mapper's CroppingSpace), the mapper's ClipBox, blanked
 * points and cells and a binary mask hide what they hide in the picture, a label map gives its
 * labels their scalar opacity (and, with UseVolumeGradientOpacity, gradient opacity), and a
 * component of weight 0 is not there; other weights, two-dimensional transfer functions and blend
 * modes are not looked at. Pick from a list, PickClippingPlanes, PickCroppingPlanes and
 * UseVolumeGradientOpacity work as in the superclasses.
 *
 * After a pick of a deformed volume
 * - PickPosition (world) and MapperPosition (data coordinates) are in deformed space, PickNormal
 *   and MapperNormal those of the deformed surface: the gradient at rest, taken through the
 *   Jacobian of the pull-back; at a face of the volume, at a cropping or a clipping plane, that of
 *   the face;
 * - RestPosition (data coordinates) is where that material lies in the volume at rest, ScalarValue
 *   the interpolated scalar there;
 * - PointId, PointIJK, CellId, CellIJK and PCoords are those of RestPosition: they index the input
 *   of the mapper, which is DataSet, a vtkImageData or a vtkRectilinearGrid;
 * - Component is the component whose opacity was met, where components are independent; else the
 *   one that gives the opacity, the last. Of three dependent components the luminance gives it:
 *   there Component is 0, and ScalarValue is the luminance (0.299, 0.587, 0.114).
 *
 * After a pick of something else RestPosition is MapperPosition, ScalarValue is 0 and Component -1.
 *
 * A pick evaluates the pull-back at least twice for each voxel that the ray passes up to the hit.
 *
 * @sa
 * vtkFFDInverseRayVolumeMapper vtkFFDRayTracer vtkFFDLatticeWidget vtkVolumePicker vtkCellPicker
 */
#ifndef vtkFFDVolumePicker_h
#define vtkFFDVolumePicker_h

#include "vtkFFDRenderingModule.h" // For export macro
#include "vtkVolumePicker.h"

class vtkFFDInverseRayVolumeMapper;
class vtkVolumeProperty;

class VTKFFDRENDERING_EXPORT vtkFFDVolumePicker : public vtkVolumePicker
{
public:
  static vtkFFDVolumePicker* New();
  vtkTypeMacro(vtkFFDVolumePicker, vtkVolumePicker);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Get the rest position of the picked material, data coordinates.
   */
  vtkGetVector3Macro(RestPosition, double);
  ///@}

  ///@{
  /**
   * The interpolated scalar of Component at RestPosition; 0 if no deformed volume was picked.
   */
  vtkGetMacro(ScalarValue, double);
  ///@}

  ///@{
  /**
   * The component whose opacity reached the isovalue first; -1 if no deformed volume was picked.
   */
  vtkGetMacro(Component, int);
  ///@}

protected:
  vtkFFDVolumePicker() = default;
  ~vtkFFDVolumePicker() override = default;

  void ResetPickInfo() override;
  double IntersectWithLine(const double p1[3], const double p2[3], double tol,
    vtkAssemblyPath* path, vtkProp3D* prop, vtkAbstractMapper3D* mapper) override;
  double IntersectVolumeWithLine(const double p1[3], const double p2[3], double t1, double t2,
    vtkProp3D* prop, vtkAbstractVolumeMapper* mapper) override;

private:
  vtkFFDVolumePicker(const vtkFFDVolumePicker&) = delete;
  void operator=(const vtkFFDVolumePicker&) = delete;

  double IntersectDeformed(const double p1[3], const double p2[3], double t1, double t2,
    vtkVolumeProperty* property, vtkFFDInverseRayVolumeMapper* mapper);

  double RestPosition[3] = { 0.0, 0.0, 0.0 };
  double ScalarValue = 0.0;
  int Component = -1;
};

#endif
