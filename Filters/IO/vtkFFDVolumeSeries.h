// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDVolumeSeries
 * @brief   volumes from files as a series in time, read ahead of the player
 *
 * Reads what vtkFFDVolumeReader reads, with its position and orientation, one file for each step in
 * time: at TimeStart, TimeStart + TimeSpacing and so on. A single file is a volume without time.
 * All steps have the same number of voxels along each axis. They may lie elsewhere than the first
 * one, or have another spacing or direction. The pipeline tells it for each time, but VTK's image
 * filters (vtkImageReslice, vtkImageShiftScale) do not ask again, and put all in the place of the
 * first one.
 *
 * <b>Reading ahead.</b> While the application works on what it got, a thread of this class reads
 * the step that comes next in the direction of play, from the last to the first again; a player
 * then does not wait for files. Volumes are kept as long as they are within CacheSize, those of the
 * longest time ago go first, so that what fits is read once. The thread starts with the second step
 * that is asked for: a series of which only one is looked at reads one.
 *
 * <b>Between two steps</b> the output is the step before, its arrays shared and not copied, or,
 * with Interpolation LINEAR, the values between both: arrays of numbers of the same name, type and
 * size, rounded for whole numbers; others are those of the step before. Both steps must lie at the
 * same place. That is right for what gets
 * brighter and darker in its place; what moves is shown twice, and wants a lattice for each step
 * instead (vtkFFDTransformSeries).
 *
 * Errors of Update() name the file and say what is wrong with it; the output is then empty.
 *
 * @sa vtkFFDVolumeReader vtkFFDTransformSeries vtkFFDDeformVolume
 */
#ifndef vtkFFDVolumeSeries_h
#define vtkFFDVolumeSeries_h

#include "vtkFFDIOModule.h" // For export macro
#include "vtkImageAlgorithm.h"

#include <memory> // for std::unique_ptr

class VTKFFDIO_EXPORT vtkFFDVolumeSeries : public vtkImageAlgorithm
{
public:
  static vtkFFDVolumeSeries* New();
  vtkTypeMacro(vtkFFDVolumeSeries, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The files (or folders of DICOM slices), in the order of time. None by default. GetFileName() is
   * null for an index that is not there. Reload() forgets what was read.
   */
  void AddFileName(const char* name);
  void RemoveAllFileNames();
  int GetNumberOfFileNames() const;
  const char* GetFileName(int index) const;
  void Reload();
  ///@}

  ///@{
  /**
   * Time of the first of several files, finite (default 0), and from one to the next, > 0 (default
   * 1).
   */
  void SetTimeStart(double time);
  vtkGetMacro(TimeStart, double);
  void SetTimeSpacing(double spacing);
  vtkGetMacro(TimeSpacing, double);
  ///@}

  /// Interpolations of the volume between two steps.
  enum Interpolations
  {
    STEP,  ///< that of the step before
    LINEAR ///< values between both
  };

  ///@{
  /**
   * Default: STEP.
   */
  vtkSetClampMacro(Interpolation, int, STEP, LINEAR);
  vtkGetMacro(Interpolation, int);
  void SetInterpolationToStep() { this->SetInterpolation(STEP); }
  void SetInterpolationToLinear() { this->SetInterpolation(LINEAR); }
  ///@}

  ///@{
  /**
   * Whether the next step is read while the application works. Default on.
   */
  vtkSetMacro(Prefetch, vtkTypeBool);
  vtkGetMacro(Prefetch, vtkTypeBool);
  vtkBooleanMacro(Prefetch, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Set/Get the memory that volumes which are not shown may take, MiB, 0 to 1048576. Default 1024.
   * Two steps and the one that is read ahead are kept in any case.
   */
  vtkSetClampMacro(CacheSize, int, 0, 1048576);
  vtkGetMacro(CacheSize, int);
  ///@}

  ///@{
  /**
   * What was done since the files were set: files read, and those of them that were read ahead. For
   * tests and for who chooses CacheSize.
   */
  int GetNumberOfReads();
  int GetNumberOfReadsAhead();
  ///@}

  /// Whether the file is a volume that vtkFFDVolumeReader reads, and no displacement field or other
  /// transform (vtkFFDTransformSeries::CanReadFile()).
  int CanReadFile(const char* fileName);

  /// Wait until the thread has nothing to read.
  void WaitForPrefetch();

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDVolumeSeries();
  ~vtkFFDVolumeSeries() override;

  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDVolumeSeries(const vtkFFDVolumeSeries&) = delete;
  void operator=(const vtkFFDVolumeSeries&) = delete;

  double FindPlace(double time);

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
  double TimeStart = 0.0;
  double TimeSpacing = 1.0;
  int Interpolation = STEP;
  vtkTypeBool Prefetch = 1;
  int CacheSize = 1024;
};

#endif
