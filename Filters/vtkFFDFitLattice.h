// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFitLattice
 * @brief   the lattice that follows landmarks, a displacement field, or any transform
 *
 * Coarse to fine: cells are halved until the largest error is at most Tolerance, or MaximumCells
 * per axis are reached. What is followed is one of
 * - <b>Landmarks</b>, SourceLandmarks and TargetLandmarks, with LandmarkWeights: points x_i that
 *   shall move to y_i. First the affine map of least squares, then splines of 1, 2, 4, ... cells
 *   per axis, each the (weighted) fit of least squares and of bending energy, which decides what
 *   happens between the landmarks. Landmarks that contradict each other (in one place, or too near
 *   to each other) are averaged; consistent ones are met within Tolerance, as smoothly as that
 *   allows: give the accuracy of the landmarks as Tolerance, and their noise is not followed. The
 *   result is the best of all levels. At least one pair; with fewer than four, or nearly in a
 *   plane, the affine map is the smallest one that there is. Error: that of the result, at all
 *   landmarks.
 * - <b>A displacement field</b>, the image at the input: point scalars of three components, the
 *   displacement at each point. The exact least-squares spline of all samples within the bounds
 *   (the normal equations of a tensor product are solved axis by axis), so noise is averaged.
 *   Images with a direction matrix other than the identity are refused: go through a
 *   vtkGridTransform and Transform. Error: at the samples.
 * - <b>Transform</b>, any vtkAbstractTransform: interpolated at the nodes, axes refined one by one
 *   (vtkFFDLattice::FitToTransform(), which the mapper uses for transforms that are no B-spline).
 *   Error: at the centers of cells and of their edges.
 *
 * A field that changes with time is fitted at the time that is asked for. One that has a single
 * layer of samples within the bounds is continued beyond it as it is. After an error, and after an
 * abort (AbortExecute), the output is empty until something changes.
 *
 * The output is the image of the control points, as that of vtkFFDLatticeSource: for
 * vtkFFDDeformVolume, files and vtkFFDLattice::FromImageData(). GetLattice() is the same as an
 * object. The domain is Bounds; by default that of the image, or the box of both kinds of landmarks
 * enlarged on each side by a tenth of its longest edge; a transform has none and needs Bounds.
 *
 * Cost: landmarks O(64 n + cells^3) for each of up to 2000 iterations of a level; a field
 * O(samples) a level.
 *
 * @sa vtkFFDLattice vtkFFDTransformReader vtkThinPlateSplineTransform
 */
#ifndef vtkFFDFitLattice_h
#define vtkFFDFitLattice_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkImageAlgorithm.h"
#include "vtkNew.h"          // for vtkNew
#include "vtkSmartPointer.h" // for vtkSmartPointer
#include "vtkTimeStamp.h"    // for vtkTimeStamp

class vtkAbstractTransform;
class vtkDataArray;
class vtkFFDLattice;
class vtkPoints;

class VTKFFDFILTERS_EXPORT vtkFFDFitLattice : public vtkImageAlgorithm
{
public:
  static vtkFFDFitLattice* New();
  vtkTypeMacro(vtkFFDFitLattice, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Landmarks, as many of either. Default: none.
   */
  void SetSourceLandmarks(vtkPoints* points);
  vtkPoints* GetSourceLandmarks();
  void SetTargetLandmarks(vtkPoints* points);
  vtkPoints* GetTargetLandmarks();
  ///@}

  ///@{
  /**
   * One positive weight per pair. Default: none, which means all 1.
   */
  void SetLandmarkWeights(vtkDataArray* weights);
  vtkDataArray* GetLandmarkWeights();
  ///@}

  ///@{
  /**
   * Least weight of the bending energy for landmarks, 0 or more, without unit; default 1e-6. Less
   * than 1e-10 counts as that. The larger, the smoother between landmarks, the more contradictions
   * are averaged, and the finer the levels that a tolerance takes.
   */
  void SetSmoothness(double smoothness);
  vtkGetMacro(Smoothness, double);
  ///@}

  ///@{
  /**
   * The transform to follow. An inverted one is followed as such. Default: none.
   */
  void SetTransform(vtkAbstractTransform* transform);
  vtkAbstractTransform* GetTransform();
  ///@}

  ///@{
  /**
   * Domain of the lattice, (xmin, xmax, ...). xmin > xmax: see above. Default: 1, -1, 1, -1, 1, -1.
   */
  void SetBounds(const double bounds[6]);
  void SetBounds(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax);
  vtkGetVector6Macro(Bounds, double);
  ///@}

  ///@{
  /**
   * Largest error to aim at, data units, > 0. Default 0.1.
   */
  void SetTolerance(double tolerance);
  vtkGetMacro(Tolerance, double);
  ///@}

  ///@{
  /**
   * Most cells per axis, 1 to 256. Default 64. Landmarks take powers of two only.
   */
  vtkSetClampMacro(MaximumCells, int, 1, 256);
  vtkGetMacro(MaximumCells, int);
  ///@}

  ///@{
  /**
   * Errors of the last fit, data units: the largest, and the root of the (weighted) mean square. -1
   * before a fit and after an error. A largest error above Tolerance is also told by a warning.
   */
  vtkGetMacro(MaximumError, double);
  vtkGetMacro(RootMeanSquareError, double);
  ///@}

  /**
   * The output as a lattice, updated; null after an error. It belongs to the filter: the next
   * update overwrites edits.
   */
  vtkFFDLattice* GetLattice();

  /// Includes landmarks and transform.
  vtkMTimeType GetMTime() override;

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDFitLattice();
  ~vtkFFDFitLattice() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDFitLattice(const vtkFFDFitLattice&) = delete;
  void operator=(const vtkFFDFitLattice&) = delete;

  void Fit(vtkImageData* field);

  vtkSmartPointer<vtkPoints> SourceLandmarks;
  vtkSmartPointer<vtkPoints> TargetLandmarks;
  vtkSmartPointer<vtkDataArray> LandmarkWeights;
  vtkSmartPointer<vtkAbstractTransform> Transform;
  double Smoothness;
  double Bounds[6];
  double Tolerance;
  int MaximumCells;
  double MaximumError;
  double RootMeanSquareError;
  vtkNew<vtkFFDLattice> Lattice;
  vtkTimeStamp FitTime;
  bool Aborted = false; ///< the last fit
};

#endif
