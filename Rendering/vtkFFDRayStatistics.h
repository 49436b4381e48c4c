// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDRayStatistics
 * @brief   what the rays of one image cost
 *
 * The measures of section 5 of "Fast Volume Deformation Using Inverse-Ray-Deformation and FFD",
 * counted by vtkFFDInverseRayVolumeMapper while CollectStatistics is on. They do not depend on the
 * number of threads. With the reference kernels (ReferenceKernels) they do not depend on the
 * machine, either; the fast ones follow packets of as many rays as the vector instructions of the
 * machine are wide, on which look-ups and evaluations depend. "Per ray" means per ray that meets
 * the bounds of the deformed volume; all averages are 0 when there is no such ray.
 *
 * @sa
 * vtkFFDInverseRayVolumeMapper
 */
#ifndef vtkFFDRayStatistics_h
#define vtkFFDRayStatistics_h

#include "vtkFFDRenderingModule.h" // For export macro
#include "vtkObject.h"

class VTKFFDRENDERING_EXPORT vtkFFDRayStatistics : public vtkObject
{
public:
  static vtkFFDRayStatistics* New();
  vtkTypeMacro(vtkFFDRayStatistics, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Number of rays that meet the bounds of the deformed volume.
   */
  vtkGetMacro(NumberOfRays, vtkTypeInt64);
  ///@}

  ///@{
  /**
   * Number of segments that the deformed rays were cut into and sampled on. Segments that are
   * passed over because nothing can be seen in them are not counted.
   */
  vtkGetMacro(NumberOfSegments, vtkTypeInt64);
  double GetSegmentsPerRay() const;
  ///@}

  /**
   * Average length of those segments on the undeformed viewing ray, in voxels (figures 6a and 7a of
   * the paper).
   */
  double GetAverageSegmentLength() const;

  ///@{
  /**
   * Number of positions where the scalars were interpolated (figures 6b and 7b).
   */
  vtkGetMacro(NumberOfSamples, vtkTypeInt64);
  double GetSamplesPerRay() const;
  ///@}

  ///@{
  /**
   * Number of those samples that were not fully transparent.
   */
  vtkGetMacro(NumberOfVisibleSamples, vtkTypeInt64);
  double GetVisibleSamplesPerRay() const;
  ///@}

  ///@{
  /**
   * Number of look-ups of distances to what is visible (figure 6c). With ERROR_BOUND one look-up is
   * for a part of a segment, or for up to eight that follow each other, and all rays of 4 x 4
   * pixels.
   */
  vtkGetMacro(NumberOfDistanceLookups, vtkTypeInt64);
  double GetDistanceLookupsPerRay() const;
  ///@}

  ///@{
  /**
   * Number of evaluations of the deformation, each Newton step counted.
   */
  vtkGetMacro(NumberOfEvaluations, vtkTypeInt64);
  double GetEvaluationsPerRay() const;
  ///@}

  ///@{
  /**
   * Number of points that no rest point was found of (folds): they show nothing, or with
   * GREEDY_ANGLE the first-order point of the paper's equation (3).
   */
  vtkGetMacro(NumberOfUnconvergedPoints, vtkTypeInt64);
  ///@}

  /**
   * Set all counts to zero.
   */
  void Reset();

  /**
   * Set all counts. For the mapper.
   */
  void SetCounts(vtkTypeInt64 rays, vtkTypeInt64 segments, double segmentLength,
    vtkTypeInt64 samples, vtkTypeInt64 visibleSamples, vtkTypeInt64 distanceLookups,
    vtkTypeInt64 evaluations, vtkTypeInt64 unconverged);

protected:
  vtkFFDRayStatistics();
  ~vtkFFDRayStatistics() override;

private:
  vtkFFDRayStatistics(const vtkFFDRayStatistics&) = delete;
  void operator=(const vtkFFDRayStatistics&) = delete;

  double PerRay(vtkTypeInt64 count) const;

  vtkTypeInt64 NumberOfRays = 0;
  vtkTypeInt64 NumberOfSegments = 0;
  double TotalSegmentLength = 0.0;
  vtkTypeInt64 NumberOfSamples = 0;
  vtkTypeInt64 NumberOfVisibleSamples = 0;
  vtkTypeInt64 NumberOfDistanceLookups = 0;
  vtkTypeInt64 NumberOfEvaluations = 0;
  vtkTypeInt64 NumberOfUnconvergedPoints = 0;
};

#endif
