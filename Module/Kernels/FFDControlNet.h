// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDControlNet_h
#define FFDControlNet_h

#include "FFDExport.h"
#include "FFDParallelFor.h"

#include <glm/vec3.hpp>

#include <vector>

namespace ffd
{

/// Nodes.x * Nodes.y * Nodes.z vectors, x fastest: coefficients of a field, or samples of one.
struct ControlNet
{
  glm::ivec3 Nodes{ 0 };
  std::vector<glm::dvec3> Values;
};

/**
 * Knot insertion: the control net of the same spline with factors.x/y/z times as many cells.
 * `net` has n >= 4 control points per axis, whose domain are the cells 1 ... n - 3; the result has
 * (n - 3) * factor + 3, with its second control point resting where that of `net` does. Equal
 * within the domain up to rounding: a convolution with the refinement mask
 * ((1 + z + ... + z^(f-1)) / f)^4 f (Lane and Riesenfeld 1980, for factor f).
 */
FFD_CORE_EXPORT ControlNet RefineControlNet(const ControlNet& net, const glm::ivec3& factors);

/**
 * The control net with `nodes` control points per axis, each at least 4, whose spline over the same
 * domain is nearest to that of `net`, axis by axis. Where n - 3 is a multiple of what it was, knots
 * are inserted (RefineControlNet); where the new spline can be the old one, as after such a
 * refinement, it is; else it is that of least squares over the domain. The outermost control
 * points, which hardly count there, are held by the cell beyond it at a tenth of the weight, where
 * the old spline less its linear part goes on as if it had control points half of the last
 * difference beyond the last one. So affine maps are reproduced, and errors are less than those of
 * interpolation at the new control points: a third for bends and twists of 8 control points per
 * axis that get 4 or 5, two thirds for random ones that get 5 to 7, whose outermost control points
 * then move 10 to 3 times as far as they had been, by interpolation up to 50 times.
 */
FFD_CORE_EXPORT ControlNet ResizeControlNet(const ControlNet& net, const glm::ivec3& nodes);

/**
 * The control net whose spline takes the given samples at the inner control points 1 ... n - 2 of
 * each axis; `samples` has n - 2 >= 2 per axis. One tridiagonal system per line. The two free
 * coefficients of each line follow from the not-a-knot condition (the first two cells share one
 * polynomial, de Boor 1978), which reproduces cubics, so the error is O(h^4) up to the border;
 * natural ends would leave O(h^2) there, and the prefilter vtkImageBSplineCoefficients, which
 * mirrors or repeats, not even reproduces a linear map. Fewer than four samples: quadratic (three)
 * or linear (two).
 */
FFD_CORE_EXPORT ControlNet InterpolateControlNet(const ControlNet& samples);

/// Samples of the spline of a net with n >= 4 control points per axis: `perCell` along each axis
/// from each inner control point 1 ... n - 3 on, and one at the last, n - 2.
FFD_CORE_EXPORT ControlNet SampleControlNet(
  const ControlNet& net, const glm::ivec3& perCell, const ParallelFor& parallelFor = ParallelFor());

} // namespace ffd

#endif
