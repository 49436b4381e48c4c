// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDTransformSeries
 * @brief   transform files as a lattice in a pipeline, one or a series in time
 *
 * Reads any file that vtkFFDTransformReader reads, and gives out the control points of a lattice
 * for the second input of vtkFFDDeformVolume, with nothing else to be said: which is what
 * applications need that open files and connect filters, as ParaView does.
 * @code{.py}
 * series = vtkffd.vtkFFDTransformSeries()
 * for phase in phases:
 *     series.AddFileName(phase)
 * deform.SetLatticeConnection(series.GetOutputPort())
 * deform.UpdateTimeStep(2.5)
 * @endcode
 *
 * <b>Time.</b> Several files are steps of a series, at TimeStart, TimeStart + TimeSpacing and so
 * on. One file that is a stack of elastix (BSplineStackTransform and the like, see
 * vtkFFDTransformReader) is a series by itself, whose times the file tells. The output has time
 * steps then. Between them control points are on straight lines, or as at the step before
 * (Interpolation); before the first and after the last step the lattice is theirs, and without a
 * requested time that of the first. A single other file has no time.
 *
 * All steps are read when the first is asked for, and kept as lattices: a player then waits for no
 * file. The lattices of the files where all are ones along the axes with the same control points;
 * else all are fitted (vtkFFDLattice::FitToTransform()) over one region: FitBounds, or that of the
 * first file that tells one (see vtkFFDTransformReader::GetDomain()), or, where all are linear and
 * tell none, 10000 data units (millimeters) along each axis around the origin, where linear
 * transforms are exact. Memory: 24 bytes a control point and step; of displacement fields one at a
 * time is held besides.
 *
 * <b>Direction.</b> The files of registrations map points of the fixed image to points of the
 * moving one: they are pull-backs of the moving image. With PullBack (the default) the lattice has
 * its inverse flag set, so that the deformation is the inverse of what the files say: volumes,
 * surfaces and points of the moving image are shown in the place of the fixed image, exactly, by
 * all that shows lattices. A lattice in a .vti file says itself what it is, and is left as it is:
 * between it and a file of the other kind nothing is interpolated, which an error tells.
 *
 * Errors of Update() name the file and say what is wrong with it; the output is then empty.
 *
 * @sa vtkFFDTransformReader vtkFFDDeformVolume vtkFFDVolumeSeries
 */
#ifndef vtkFFDTransformSeries_h
#define vtkFFDTransformSeries_h

#include "vtkFFDIOModule.h" // For export macro
#include "vtkImageAlgorithm.h"
#include "vtkSmartPointer.h" // for vtkSmartPointer

#include <string> // for std::string
#include <vector> // for std::vector

class vtkAbstractTransform;
class vtkFFDLattice;
class vtkFFDTransformReader;

class VTKFFDIO_EXPORT vtkFFDTransformSeries : public vtkImageAlgorithm
{
public:
  static vtkFFDTransformSeries* New();
  vtkTypeMacro(vtkFFDTransformSeries, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The files, in the order of time. None by default. GetFileName() is null for an index that is
   * not there. They are read at the next update; call Reload() when one has changed.
   */
  void AddFileName(const char* name);
  void RemoveAllFileNames();
  int GetNumberOfFileNames() const;
  const char* GetFileName(int index) const;
  void Reload();
  ///@}

  ///@{
  /**
   * As in vtkFFDTransformReader: system of coordinates (0: LPS, the default, 1: RAS), region of
   * lattices that are fitted (xmin > xmax, the default: see above), largest error to aim at, data
   * units, > 0 (default 0.1), and the most cells per axis, 1 to 256 (default 64).
   */
  void SetCoordinates(int coordinates);
  vtkGetMacro(Coordinates, int);
  void SetFitBounds(const double bounds[6]);
  void SetFitBounds(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax);
  vtkGetVector6Macro(FitBounds, double);
  void SetFitTolerance(double tolerance);
  vtkGetMacro(FitTolerance, double);
  void SetMaximumCells(int cells);
  vtkGetMacro(MaximumCells, int);
  ///@}

  ///@{
  /**
   * Whether the files map deformed points to points at rest, as registrations do: see above.
   * Default on.
   */
  vtkSetMacro(PullBack, vtkTypeBool);
  vtkGetMacro(PullBack, vtkTypeBool);
  vtkBooleanMacro(PullBack, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Time of the first of several files, finite (default 0), and from one to the next, > 0 (default
   * 1). Stacks have their own.
   */
  void SetTimeStart(double time);
  vtkGetMacro(TimeStart, double);
  void SetTimeSpacing(double spacing);
  vtkGetMacro(TimeSpacing, double);
  ///@}

  /// Interpolations of the lattice between two steps.
  enum Interpolations
  {
    STEP,  ///< that of the step before
    LINEAR ///< between both
  };

  ///@{
  /**
   * Default: LINEAR.
   */
  vtkSetClampMacro(Interpolation, int, STEP, LINEAR);
  vtkGetMacro(Interpolation, int);
  void SetInterpolationToStep() { this->SetInterpolation(STEP); }
  void SetInterpolationToLinear() { this->SetInterpolation(LINEAR); }
  ///@}

  ///@{
  /**
   * Of the last update: how many steps there are, the time of one of them, and the largest error of
   * a lattice, data units, 0 where they are those of the files.
   */
  int GetNumberOfSteps() const;
  double GetStepTime(int index) const;
  vtkGetMacro(LatticeError, double);
  ///@}

  /// The lattice at a time, into `lattice`. Reads the files if need be. Returns 1, or 0 after an
  /// error.
  int GetLatticeAt(double time, vtkFFDLattice* lattice);

  /**
   * Whether the file is a transform, by its first bytes: MetaImage, NRRD and NIfTI files of three
   * components a voxel are (they may be other vectors, too), other images are not, nor are .vti
   * files.
   */
  int CanReadFile(const char* fileName);

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDTransformSeries();
  ~vtkFFDTransformSeries() override;

  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDTransformSeries(const vtkFFDTransformSeries&) = delete;
  void operator=(const vtkFFDTransformSeries&) = delete;

  struct Step
  {
    vtkSmartPointer<vtkFFDLattice> Lattice;
    double Time = 0.0;
    bool IsExact = false;   // that of the file
    bool IsPullBack = true; // what the file maps
  };

  bool ReadFiles();
  bool ReadAllFiles();
  bool ReadFile(vtkFFDTransformReader* reader, std::size_t index, std::string& problem);
  bool AddStep(vtkFFDTransformReader* reader, double time, std::string& problem);
  bool MakeAlike();
  bool CanInterpolate();
  bool Fit(Step& step, vtkAbstractTransform* transform);
  void ChangeFiles();

  std::vector<std::string> FileNames;
  int Coordinates = 0;
  double FitBounds[6] = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 };
  double FitTolerance = 0.1;
  int MaximumCells = 64;
  vtkTypeBool PullBack = 1;
  double TimeStart = 0.0;
  double TimeSpacing = 1.0;
  int Interpolation = LINEAR;

  std::vector<Step> Steps;
  bool HasOwnTimes = false; // those of a stack
  double Region[6];         // of what is fitted
  double LatticeError = 0.0;
  bool IsRead = false;
};

#endif
