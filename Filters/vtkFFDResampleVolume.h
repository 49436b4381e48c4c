// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDResampleVolume
 * @brief   the deformed volume as image data, for export
 *
 * vtkFFDInverseRayVolumeMapper draws a deformed volume without making it. This filter makes it
 * after all, for files and for programs that take nothing but voxels: each point P of the output
 * gets the value of the input at Phi(P), the same pull-back and the same inverse modes as in the
 * mapper, so a picture of the output is, up to interpolation, the mapper's picture of the input.
 *
 * The output is a grid parallel to that of the input (same direction matrix). By default its points
 * are those of the input's grid, continued over all of the deformed volume, so that without
 * deformation the output equals the input. Spacing, origin and extent can be chosen.
 *
 * The input is a vtkImageData with at least two voxels along each axis, or blocks of them; its
 * active point scalars (or those of SetInputArrayToProcess(); with an empty name the active ones,
 * or the first array), of any numeric type and number of components, are resampled, and the output
 * has scalars of that type and name; whole numbers are rounded and clamped. Other arrays are not
 * passed on. An attached lattice (vtkFFDLattice::AttachTo()) is taken off, as the output is
 * deformed already. Voxels that are not finite reach the points that they have weight in. Points
 * that come from beyond the outermost voxels by no more than positions may be off (twice the
 * tolerances, at most half a voxel) get the values of these, so that faces that stay in place have
 * no holes.
 *
 * The output is streamed: an update of a part of the extent gives the same values as an update of
 * the whole, and with SetDeformation() it asks the input for what that part comes from and the
 * voxels around it only (a lattice attached to the input needs all of that). Where filters before
 * this one do not announce the direction of the image (vtkDataObject::DIRECTION(), which VTK's do
 * not pass on), RequestInformation asks for some voxels of it, or for those it asked for last, as
 * the extent of the output follows from it. All cores are used,
 * the result does not depend on their number. Progress is reported, AbortExecute is obeyed (the
 * output is then empty).
 *
 * Cost: rows of the output that are parallel to an axis of the lattice, as they are unless the
 * image is turned, take their displacements from sums that a row shares. FIRST_ORDER and PULL_BACK
 * are faster than vtkImageReslice with a vtkBSplineTransform; EXACT solves at every
 * fourth point and checks the others (Testing/Benchmarks/NOTES.md has figures). EXACT with a
 * lattice that is not proven free of folds solves at every point and takes several times longer.
 *
 * @sa vtkFFDInverseRayVolumeMapper vtkFFDDeformVolume vtkImageReslice
 */
#ifndef vtkFFDResampleVolume_h
#define vtkFFDResampleVolume_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkImageAlgorithm.h"

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class vtkAbstractTransform;
class vtkDataArray;
class vtkImageData;

class VTKFFDFILTERS_EXPORT vtkFFDResampleVolume : public vtkImageAlgorithm
{
public:
  static vtkFFDResampleVolume* New();
  vtkTypeMacro(vtkFFDResampleVolume, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The deformation T, in data coordinates of the input. A vtkFFDLattice or any vtkBSplineTransform
   * is used as it is; any other transform is approximated by a lattice within PositionTolerance (a
   * warning tells when that could not be reached). Default: none, which means the lattice attached
   * to the input if there is one, else no deformation. As the extent of the output follows from an
   * attached lattice, the input is then updated whole before the output's information is known; it
   * follows the time that is asked for. Filters behind this one that make images do not learn of
   * that, as VTK's pipeline is: for them call SetOutputExtent() with what holds the volume at all
   * times.
   */
  virtual void SetDeformation(vtkAbstractTransform*);
  virtual vtkAbstractTransform* GetDeformation();
  ///@}

  /// Set/Get the method for the pull-back, as in vtkFFDInverseRayVolumeMapper.
  enum InverseModes
  {
    FIRST_ORDER, ///< 2P - T(P), equation (3) of the paper
    EXACT,       ///< T^-1
    PULL_BACK    ///< T itself: what vtkImageReslice::SetResliceTransform() does
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
   * Largest distance between T(Phi(P)) and P in EXACT mode, in voxels of the input (the shortest
   * edge). Default: 0.01. Must be positive.
   */
  virtual void SetInverseTolerance(double voxels);
  vtkGetMacro(InverseTolerance, double);
  ///@}

  ///@{
  /**
   * Largest error of the lattice that stands for a transform of another class, in voxels of the
   * input. Default: 0.1. Must be positive.
   */
  virtual void SetPositionTolerance(double voxels);
  vtkGetMacro(PositionTolerance, double);
  ///@}

  /// Interpolation of values between voxels.
  enum InterpolationModes
  {
    NEAREST,
    LINEAR,
    CUBIC ///< Catmull-Rom, as vtkImageReslice; voxels at the border are repeated outwards
  };

  ///@{
  /**
   * Default: LINEAR.
   */
  vtkSetClampMacro(InterpolationMode, int, NEAREST, CUBIC);
  vtkGetMacro(InterpolationMode, int);
  void SetInterpolationModeToNearest() { this->SetInterpolationMode(NEAREST); }
  void SetInterpolationModeToLinear() { this->SetInterpolationMode(LINEAR); }
  void SetInterpolationModeToCubic() { this->SetInterpolationMode(CUBIC); }
  const char* GetInterpolationModeAsString() const;
  ///@}

  ///@{
  /**
   * Value of the points that no point of the input moved to, every component; clamped to the range
   * of the scalar type. Must be finite. Default: 0.
   */
  virtual void SetBackgroundLevel(double value);
  vtkGetMacro(BackgroundLevel, double);
  ///@}

  ///@{
  /**
   * Distance between output points per axis, data units, positive. Default: that of the input; the
   * getter then returns what was set last, 1, 1, 1 at first.
   */
  virtual void SetOutputSpacing(double x, double y, double z);
  virtual void SetOutputSpacing(const double spacing[3]);
  vtkGetVector3Macro(OutputSpacing, double);
  void SetOutputSpacingToDefault();
  ///@}

  ///@{
  /**
   * Position of the output point of index (0, 0, 0), data coordinates. Default: the origin of the
   * input; the getter then returns what was set last, 0, 0, 0 at first.
   */
  virtual void SetOutputOrigin(double x, double y, double z);
  virtual void SetOutputOrigin(const double origin[3]);
  vtkGetVector3Macro(OutputOrigin, double);
  void SetOutputOriginToDefault();
  ///@}

  ///@{
  /**
   * Whole extent of the output, indices first to last of each axis, first <= last. Default: the
   * smallest that holds the bounds of the deformed volume, which are never too small; the getter
   * then returns what was set last, an empty extent at first.
   */
  virtual void SetOutputExtent(int x0, int x1, int y0, int y1, int z0, int z1);
  virtual void SetOutputExtent(const int extent[6]);
  vtkGetVector6Macro(OutputExtent, int);
  void SetOutputExtentToDefault();
  ///@}

  ///@{
  /**
   * Largest number of threads, up to 1024; 0, the default, means as many as vtkSMPTools uses, and
   * there are never more than that.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

  /**
   * Points of the last update for which no point at rest was found (EXACT, folds): they have the
   * background.
   */
  vtkGetMacro(NumberOfUnconvergedPoints, vtkIdType);

  /// Includes the deformation.
  vtkMTimeType GetMTime() override;

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDResampleVolume();
  ~vtkFFDResampleVolume() override;

  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDResampleVolume(const vtkFFDResampleVolume&) = delete;
  void operator=(const vtkFFDResampleVolume&) = delete;

  class vtkInternals;

  bool UpdateInternals(vtkInformation* input, vtkImageData* image, std::string& message);

  vtkAbstractTransform* Deformation = nullptr;
  int InverseMode = EXACT;
  double InverseTolerance = 0.01;
  double PositionTolerance = 0.1;
  int InterpolationMode = LINEAR;
  double BackgroundLevel = 0.0;
  double OutputSpacing[3] = { 1.0, 1.0, 1.0 };
  double OutputOrigin[3] = { 0.0, 0.0, 0.0 };
  int OutputExtent[6] = { 0, -1, 0, -1, 0, -1 };
  bool DefaultSpacing = true;
  bool DefaultOrigin = true;
  bool DefaultExtent = true;
  int NumberOfThreads = 0;
  vtkIdType NumberOfUnconvergedPoints = 0;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
