// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDLattice
 * @brief   uniform cubic B-spline free-form deformation with control points of its own
 *
 * vtkFFDLattice is a vtkBSplineTransform that owns its coefficients and can be shaped: a uniform
 * grid of control points that are moved one by one, as one array, by shapes (vtkFFDLatticeSource)
 * or by fitting another transform (section 4.1 of the paper). Wherever VTK takes a transform it
 * can be used, and it gives the same points as a vtkBSplineTransform with the same coefficients.
 *
 * Control point (i, j, k) of nx * ny * nz (at least 4 per axis) rests at a node of an axis-aligned
 * grid and carries a displacement. The domain is the box from node 1 to node n - 2 of each axis:
 * there the deformation has full support and no border mode takes part. So a domain is divided
 * into n - 3 cells per axis. All coordinates are data coordinates (those of the vtkImageData that
 * is deformed; the matrix of its direction is applied before), displacements are in the same
 * units.
 *
 * T(X) = X + DisplacementScale * D(X), D the spline of the displacements. With the InverseFlag
 * set (Inverse(), GetInverse()) the transform is T^-1 instead, by Newton's method with
 * continuation to InverseTolerance (see ffd::SolveInverse): it converges also for strong
 * deformations. Where T folds, the inverse is one of several points or, in the end, the first-order
 * point 2P - T(P) of equation (3) of the paper; never NaN for finite input. What GetInverse() gives
 * follows this lattice, as any inverse in VTK: what is set in it holds until this lattice is
 * edited.
 *
 * Editing: SetDisplacement() and SetControlPoint() for single points; GetDisplacements() is the
 * array itself, for numpy:
 * @code{.py}
 * d = vtk_to_numpy(lattice.GetDisplacements()).reshape(nz, ny, nx, 3)
 * d[..., 2] += 3.0
 * lattice.Modified()
 * @endcode
 * Setters refuse NaN, infinite values, bad sizes, sizes beyond the memory and bad indices with an
 * error, and leave the state as it was. NaN that were written into the array behind the setters are
 * reported when the transform is updated, and the transform is the identity until they are gone.
 *
 * Copies: DeepCopy() copies everything, ShallowCopy() shares the control points.
 *
 * @sa vtkBSplineTransform vtkFFDLatticeSource vtkFFDDeformVolume vtkFFDInverseRayVolumeMapper
 */
#ifndef vtkFFDLattice_h
#define vtkFFDLattice_h

#include "vtkBSplineTransform.h"
#include "vtkFFDCoreModule.h" // For export macro

#include <memory> // for std::unique_ptr

class vtkDataArray;
class vtkDataObject;
class vtkDoubleArray;
class vtkImageData;

class VTKFFDCORE_EXPORT vtkFFDLattice : public vtkBSplineTransform
{
public:
  /// 4 x 4 x 4 control points over the unit cube, no deformation.
  static vtkFFDLattice* New();
  vtkTypeMacro(vtkFFDLattice, vtkBSplineTransform);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Number of control points per axis, each from 4 to 1024. The domain stays. So does the shape:
   * exactly along axes on which n - 3 becomes a multiple of what it was (as by Refine()), and where
   * the new lattice can have it, as after such a change; else it is the nearest one, of least
   * squares in the domain, and small features can be lost. Default 4, 4, 4.
   */
  void SetDimensions(int nx, int ny, int nz);
  void SetDimensions(const int dimensions[3]);
  void GetDimensions(int dimensions[3]);
  int* GetDimensions() VTK_SIZEHINT(3);
  ///@}

  /// nx * ny * nz.
  vtkIdType GetNumberOfControlPoints();

  ///@{
  /**
   * The domain, (xmin, xmax, ymin, ymax, zmin, zmax), min < max: rest positions of the control
   * points 1 and n - 2 per axis. Displacements keep their values, so the shape moves with the
   * domain. Default the unit cube.
   */
  void SetDomain(const double bounds[6]);
  void SetDomain(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax);
  void GetDomain(double bounds[6]);
  double* GetDomain() VTK_SIZEHINT(6);
  ///@}

  /**
   * SetDomain() to bounds enlarged on each side by `padding` times the extent of the axis
   * (0 <= padding, default 0; 0.1 adds a tenth on either side). An axis without extent (a 2-D
   * image) is given that of the thinnest other axis, centered; at least one axis must have some.
   */
  void FitToBounds(const double bounds[6], double padding = 0.0);

  ///@{
  /**
   * Get the position of control point (i, j, k) without deformation.
   */
  void GetRestPoint(int i, int j, int k, double point[3]);
  void GetSpacing(double spacing[3]);
  ///@}

  ///@{
  /**
   * Deformed position of a control point, rest point + displacement. Like in any B-spline FFD the
   * object follows its control points without passing through them. DisplacementScale is a factor
   * on the deformation as a whole and not in these numbers.
   */
  void SetControlPoint(int i, int j, int k, const double point[3]);
  void SetControlPoint(int i, int j, int k, double x, double y, double z);
  void GetControlPoint(int i, int j, int k, double point[3]);
  ///@}

  ///@{
  /**
   * Displacement of a control point (before DisplacementScale). A bad index is an error; the
   * getters then give zeros.
   */
  void SetDisplacement(int i, int j, int k, const double displacement[3]);
  void SetDisplacement(int i, int j, int k, double dx, double dy, double dz);
  void GetDisplacement(int i, int j, int k, double displacement[3]);
  ///@}

  ///@{
  /**
   * All displacements: 3 components, nx * ny * nz tuples, x fastest. GetDisplacements() is the
   * lattice's own array: call Modified() on the lattice or on the array after editing it in
   * place; either tells all lattices that share the array. SetDisplacements() copies any array of
   * that shape, and returns 1, or 0 after an error (null, another shape, not finite).
   */
  vtkDoubleArray* GetDisplacements();
  int SetDisplacements(vtkDataArray* displacements);
  ///@}

  ///@{
  /**
   * All displacements zero; dimensions, domain and border mode stay. IsIdentity is true when the
   * deformation is exactly none.
   */
  void Reset();
  bool IsIdentity();
  ///@}

  ///@{
  /**
   * Knot insertion: `factor` times as many cells per axis (1 to 64), the same map within the
   * domain to about 1e-15 of the displacements, and control points for finer edits. Outside the
   * domain the border is as many cells wide as before, hence narrower, and the map differs. To
   * keep it everywhere, call Extend(2) (border mode Edge) or Extend(3) (Zero) first: the domain
   * then covers all that varies. Returns 1, or 0 after an error.
   */
  int Refine(int factorX, int factorY, int factorZ);
  int Refine(int factor = 2) { return this->Refine(factor, factor, factor); }
  ///@}

  /**
   * Add `layers` (1 to 64) of control points on every side, with the displacements that the border
   * mode stands for (Edge: repeated, Zero: zeros), so that the domain grows by as many cells and
   * the map is the same everywhere. ZeroAtBorder has no such continuation: the first layer
   * reproduces the map up to one spacing outside only where it is smooth, so it is refused.
   * Returns 1, or 0 after an error.
   */
  int Extend(int layers);

  /**
   * Shape the lattice like `transform` over bounds[6]: its displacements are sampled at the control
   * points of the domain (set to `bounds`, flat axes as in FitToBounds) and interpolated
   * (ffd::InterpolateControlNet), and the axes on which the error is too large get twice the cells,
   * until the largest error found between them is at most `tolerance` (> 0, data units) or every
   * such axis has `maximumCells` (1 to 256). Returns the largest error
   * found, which can exceed the tolerance, or -1 after an error (null, this lattice itself, bad
   * bounds, a tolerance or a number of cells out of range, a transform that gives points that are
   * not finite), the lattice unchanged. Sets BorderMode to Edge, DisplacementScale to 1 and
   * InverseFlag to 0. Start: four cells per axis, or maximumCells if that is less. The error is
   * measured, not proven: on a regular grid of 16 cells per axis, or as fine as the grids that the
   * transform is given on, up to 64; between the control points of finer lattices where coarser
   * ones err; and at the landmarks of a thin-plate spline. What is finer can hide.
   */
  double FitToTransform(vtkAbstractTransform* transform, const double bounds[6], double tolerance,
    int maximumCells = 64);

  ///@{
  /**
   * Bounds of what an object within restBounds becomes, conservative (from the control net) and
   * tight to a fraction of a cell: the image under the transform, so of T, or of T^-1 when
   * InverseFlag is set.
   */
  void GetDeformedBounds(const double restBounds[6], double bounds[6]);
  ///@}

  /// Range of DisplacementScale * D over all space, (xmin, xmax, ...), conservative.
  void GetDisplacementBounds(double bounds[6]);

  ///@{
  /**
   * Proven bounds of det J_T over the domain (ffd::BoundJacobianDeterminant), within 1e-3 of what
   * is attained: the local change of volume. Positive minimum: T does not fold in the domain.
   * Computed when asked for and kept until the next edit; the time is proportional to the number
   * of control points.
   */
  double GetMinimumJacobianBound();
  void GetJacobianDeterminantBounds(double range[2]);
  bool IsFoldFree() { return this->GetMinimumJacobianBound() > 0.0; }
  ///@}

  ///@{
  /**
   * The lattice as field data of a data object, so that it passes through pipelines, files and
   * ParaView with the data set that it deforms. Arrays (version 1): "FFDLattice.Version" (int),
   * ".Dimensions" (int, 3), ".Origin" and ".Spacing" (double, 3; control point 0 and the step),
   * ".BorderMode", ".Inverse" (int), ".DisplacementScale" (double) and ".Displacement" (double, 3
   * components, x fastest). AttachTo() stores a copy and replaces one attached before;
   * DetachFrom() removes it. ReadFrom() returns 1, or 0 with an error that names what is missing
   * or malformed, the lattice unchanged. HasLattice() looks only for the names of ".Version" and
   * ".Displacement": one of them is a lattice that ReadFrom() refuses.
   */
  int AttachTo(vtkDataObject* object);
  int ReadFrom(vtkDataObject* object);
  static bool HasLattice(vtkDataObject* object);
  static void DetachFrom(vtkDataObject* object);
  ///@}

  ///@{
  /**
   * The lattice as an image of its control points, for files (.vti) and filters: displacements as
   * point scalars, the rest as field data "FFDLattice.BorderMode", ".Inverse" and
   * ".DisplacementScale". FromImageData() takes any image with 3-component point scalars, at least
   * 4 points per axis and finite values, whatever its scalar type and extent; without the field
   * data, border mode, flag and scale stay. Return 1, or 0 after an error.
   */
  int ToImageData(vtkImageData* image);
  int FromImageData(vtkImageData* image);
  ///@}

  ///@{
  /**
   * For code written for vtkBSplineTransform: the lattice adopts a copy of the coefficients (of
   * the up-to-date output of the connection), as FromImageData() does; later changes of the
   * original do not follow. GetCoefficientData() is the lattice's own image; that of an inverse is
   * as of its last Update().
   */
  void SetCoefficientData(vtkImageData* coefficients) override;
  void SetCoefficientConnection(vtkAlgorithmOutput* connection) override;
  vtkImageData* GetCoefficientData() override;
  ///@}

  ///@{
  /**
   * As in the superclasses: the factor on the deformation as a whole, and the largest error of the
   * inverse in data units. Not finite values are refused; the tolerance must be positive. Defaults:
   * 1 and 1e-6. SetInverseIterations() has no effect: the search for the inverse ends by itself.
   */
  void SetDisplacementScale(double scale) override;
  void SetInverseTolerance(double tolerance) override;
  ///@}

  /**
   * How the displacements go on beyond the lattice, see vtkBSplineTransform. Default:
   * VTK_BSPLINE_EDGE.
   */
  void SetBorderMode(int mode) override;

  /// Share the control points of another lattice: an edit of one is seen by both, until one gets
  /// another number of control points, or those of a third lattice or a transform. Then each has
  /// its own.
  void ShallowCopy(vtkFFDLattice* other);

  /// Includes the control points.
  vtkMTimeType GetMTime() override;

  /// Marks the control points as changed, too, for the lattices that share them (ShallowCopy()).
  void Modified() override;

  vtkAbstractTransform* MakeTransform() override;

protected:
  vtkFFDLattice();
  ~vtkFFDLattice() override;

  void InternalUpdate() override;
  void InternalDeepCopy(vtkAbstractTransform* transform) override;

  void InverseTransformPoint(const float in[3], float out[3]) override;
  void InverseTransformPoint(const double in[3], double out[3]) override;
  ///@{
  /// The derivative is that of T at the inverse point, as the superclass defines it.
  void InverseTransformDerivative(const float in[3], float out[3], float derivative[3][3]) override;
  void InverseTransformDerivative(
    const double in[3], double out[3], double derivative[3][3]) override;
  ///@}

private:
  /// An inverse, as of GetInverse(), takes over what has become of the lattice that it belongs to.
  void FollowInverse();

  vtkFFDLattice(const vtkFFDLattice&) = delete;
  void operator=(const vtkFFDLattice&) = delete;

  class vtkLatticeInternals;
  std::unique_ptr<vtkLatticeInternals> Lattice;
  bool MayBeInverse = false;
  int Dimensions[3];
  double Domain[6];
};

#endif
