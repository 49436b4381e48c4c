// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDLatticeSource
 * @brief   a lattice over given bounds, in one of several shapes
 *
 * The output is the image of the control points that vtkFFDLattice::ToImageData() makes:
 * Dimensions points, displacements as 3-component double scalars. vtkFFDLattice::FromImageData(),
 * vtkFFDLattice::SetCoefficientConnection() and the second input of vtkFFDDeformVolume take it;
 * GetLattice() is the same as an object, and ApplyShape() shapes a lattice of one's own.
 *
 * Every control point is displaced as the shape displaces its rest point, so the deformation is
 * the shape smoothed by the spline. With s the strength and the domain's center and extents:
 * - IDENTITY: none.
 * - BEND: the x axis is bent towards +y into an arc of s * 90 degrees (Barr 1984), length kept.
 * - TWIST: about z, from -s * 45 degrees at the lower to s * 45 at the upper end.
 * - TAPER: x and y are scaled by 1 + s / 2 at the lower to 1 - s / 2 at the upper end of z; to a
 *   point at s = 2.
 * - BULGE: outwards from the center, fading to nothing at the ellipsoid within the domain; the
 *   displacement is s / 2 of the position at the center. Inwards for s < 0.
 * - WAVE: along z, s * 10 % of the extent of z, two periods over x.
 * - RANDOM: every component uniform in s * [-0.4, 0.4] spacings, reproducible by Seed. At most
 *   |s| = 1 the map cannot fold (Choi and Lee 2000: displacements below 0.403 spacings); beyond
 *   it may, and FoldFree finds out how far one can go.
 *
 * @sa vtkFFDLattice vtkFFDDeformVolume
 */
#ifndef vtkFFDLatticeSource_h
#define vtkFFDLatticeSource_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkImageAlgorithm.h"
#include "vtkNew.h" // for vtkNew

class vtkFFDLattice;

class VTKFFDFILTERS_EXPORT vtkFFDLatticeSource : public vtkImageAlgorithm
{
public:
  static vtkFFDLatticeSource* New();
  vtkTypeMacro(vtkFFDLatticeSource, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Ready shapes.
  enum ShapeType
  {
    IDENTITY = 0,
    BEND,
    TWIST,
    TAPER,
    BULGE,
    WAVE,
    RANDOM
  };

  ///@{
  /**
   * Bounds to deform, (xmin, xmax, ...), min <= max, finite, not a single point; an axis without
   * extent is widened as by vtkFFDLattice::FitToBounds(). Default the unit cube.
   */
  void SetBounds(const double bounds[6]);
  void SetBounds(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax);
  vtkGetVector6Macro(Bounds, double);
  ///@}

  ///@{
  /**
   * Control points per axis, 4 to 1024. Default 8, 8, 8.
   */
  void SetDimensions(const int dimensions[3]);
  void SetDimensions(int nx, int ny, int nz);
  vtkGetVector3Macro(Dimensions, int);
  ///@}

  ///@{
  /**
   * Margin that is added to the bounds on each side, as a fraction of the extent, 0 or more.
   * Default 0.
   */
  void SetPadding(double padding);
  vtkGetMacro(Padding, double);
  ///@}

  ///@{
  /**
   * One of the shapes above. Default IDENTITY.
   */
  void SetShape(int shape);
  vtkGetMacro(Shape, int);
  void SetShapeToIdentity() { this->SetShape(IDENTITY); }
  void SetShapeToBend() { this->SetShape(BEND); }
  void SetShapeToTwist() { this->SetShape(TWIST); }
  void SetShapeToTaper() { this->SetShape(TAPER); }
  void SetShapeToBulge() { this->SetShape(BULGE); }
  void SetShapeToWave() { this->SetShape(WAVE); }
  void SetShapeToRandom() { this->SetShape(RANDOM); }
  const char* GetShapeAsString();
  ///@}

  ///@{
  /**
   * Strength of the shape, finite; 0 is no deformation, negative the opposite one. Default 1.
   */
  void SetStrength(double strength);
  vtkGetMacro(Strength, double);
  ///@}

  ///@{
  /**
   * Whether displacements that make the map fold are scaled down, all by the same factor, until
   * vtkFFDLattice::GetMinimumJacobianBound() proves that it does not, with a determinant of at
   * least MinimumJacobian. The factor is found to a thousandth of itself, and is 1 where nothing
   * folds; finding one of f takes about 10 + log2(1 / f) proofs. Default off.
   */
  vtkSetMacro(FoldFree, vtkTypeBool);
  vtkGetMacro(FoldFree, vtkTypeBool);
  vtkBooleanMacro(FoldFree, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Least local change of volume that FoldFree leaves, above 0 and below 1. Default 0.05.
   */
  void SetMinimumJacobian(double determinant);
  vtkGetMacro(MinimumJacobian, double);
  ///@}

  /**
   * The factor that FoldFree applied to the displacements of the last update; 1 when it is off.
   */
  vtkGetMacro(FoldFreeFactor, double);

  ///@{
  /**
   * Seed of RANDOM, 1 to 2147483646. Default 1.
   */
  vtkSetClampMacro(Seed, int, 1, 2147483646);
  vtkGetMacro(Seed, int);
  ///@}

  ///@{
  /**
   * Border mode of the lattice: VTK_BSPLINE_EDGE, _ZERO, _ZERO_AT_BORDER. Default:
   * VTK_BSPLINE_EDGE.
   */
  vtkSetClampMacro(BorderMode, int, 0, 2);
  vtkGetMacro(BorderMode, int);
  ///@}

  /**
   * The output as a lattice, updated. It belongs to the source: the next update overwrites edits.
   */
  vtkFFDLattice* GetLattice();

  /**
   * Scale the displacements of `lattice` down until it is proven not to fold, see FoldFree. Returns
   * the factor, or 0 with a warning (null, a determinant out of range), the lattice unchanged.
   */
  static double LimitToFoldFree(vtkFFDLattice* lattice, double minimumJacobian = 0.05);

  /**
   * Replace the displacements of `lattice` by a shape over its domain. Returns 1, or 0 with a
   * warning (null, unknown shape, strength not finite), the lattice unchanged. A seed below 1
   * counts as 1.
   */
  static int ApplyShape(vtkFFDLattice* lattice, int shape, double strength, int seed = 1);

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDLatticeSource();
  ~vtkFFDLatticeSource() override;

  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDLatticeSource(const vtkFFDLatticeSource&) = delete;
  void operator=(const vtkFFDLatticeSource&) = delete;

  void UpdateLattice();

  vtkNew<vtkFFDLattice> Lattice;
  double Bounds[6];
  int Dimensions[3];
  double Padding;
  int Shape;
  double Strength;
  int Seed;
  int BorderMode;
  vtkTypeBool FoldFree;
  double MinimumJacobian;
  double FoldFreeFactor;
};

#endif
