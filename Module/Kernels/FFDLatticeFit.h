// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDLatticeFit_h
#define FFDLatticeFit_h

#include "FFDControlNet.h"
#include "FFDExport.h"
#include "FFDParallelFor.h"

#include <glm/vec3.hpp>

#include <functional>
#include <vector>

namespace ffd
{

/// A box divided into cells, and the control net of a spline over it: Cells + 3 control points per
/// axis, control point 1 at Lower.
struct FittedNet
{
  glm::dvec3 Lower{ 0.0 };
  glm::dvec3 Extent{ 1.0 };
  glm::ivec3 Cells{ 0 };
  ControlNet Net;
  double LargestError = 0.0;
  double RootMeanSquareError = 0.0;

  glm::dvec3 GetSpacing() const { return this->Extent / glm::dvec3(this->Cells); }
  glm::dvec3 GetOrigin() const { return this->Lower - this->GetSpacing(); }
};

enum class FitStatus
{
  Reached,    // the tolerance is kept
  NotReached, // by the number of cells that was allowed
  NotFinite,  // the samples are not finite; the net is not usable
  Stopped     // `proceed` said so; the net is not usable
};

/**
 * Limits of a fit: it refines until the largest error is at most Tolerance (> 0), with at most
 * MaximumCells (>= 1) per axis. Proceed, if there is one, is called now and then with a fraction
 * done; false stops the fit. Parallel splits the work of landmarks over threads.
 */
struct FitLimits
{
  double Tolerance = 0.0;
  int MaximumCells = 64;
  std::function<bool(double)> Proceed;
  ParallelFor Parallel{};
};

/**
 * The least-squares net of displacements on a regular grid of samples that covers the box: sample
 * (i, j, k) lies at first + (i, j, k) * step, x fastest; only those in the box count. The normal
 * equations of a tensor product are solved axis by axis (banded, exact), with a penalty of 1e-9 on
 * second differences (P-splines, Eilers and Marx 1996) for control points that no sample
 * determines. The cells double on all axes, until the error at the samples is small enough or a
 * cell is smaller than the step.
 */
FFD_CORE_EXPORT FitStatus FitNetToGrid(const glm::ivec3& count, const glm::dvec3& first,
  const glm::dvec3& step, const std::vector<glm::dvec3>& displacements, const FitLimits& limits,
  FittedNet& fit);

/**
 * The net of displacements at scattered points (landmarks), coarse to fine: first the affine map A
 * of least squares, of the smallest norm in directions in which the points extend less than a tenth
 * of how far they do in others; then splines of 1, 2, 4, ... cells that minimize
 *   sum_i w_i |d_i - D(x_i)|^2 / sum_i w_i + smoothness * (L^4 / V * integral of |second
 * derivatives|^2 + 0.1 L^2 / V * integral of |gradient of D - A|^2)
 * (thin-plate bending energy of the whole of D, by second differences of control points; L the
 * longest extent, V the volume; so smoothness has no unit, and an affine map costs nothing; points
 * that are nearly in a plane, as those put on what is seen in a picture, would be met by any
 * gradient across it without the second term), by conjugate gradients from the net of the level
 * before, preconditioned by all coarser levels. What is left is asked for again (iterated Tikhonov
 * regularization) while that makes the error much smaller: consistent displacements are met exactly
 * in the end, those that contradict each other are averaged. Once the tolerance is kept, smoothness
 * grows for as long as it still is (discrepancy principle).
 *
 * The result is the net with the least weighted mean square error of all levels, never worse than a
 * coarser one. Levels end early where two in a row with more control points than points gain less
 * than 2 %. Errors are those of the result at the points, those out of the box included, where the
 * field goes on as BSplineField does (BorderMode::Edge). `weights` are positive, or empty: 1.
 * Smoothness below 1e-10 counts as that.
 */
FFD_CORE_EXPORT FitStatus FitNetToPoints(const std::vector<glm::dvec3>& points,
  const std::vector<glm::dvec3>& displacements, const std::vector<double>& weights,
  double smoothness, const FitLimits& limits, FittedNet& fit);

} // namespace ffd

#endif
