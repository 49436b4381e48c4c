// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDItkTransform_h
#define FFDItkTransform_h

#include "FFDExport.h"
#include "FFDTransformStep.h"

#include <string>
#include <string_view>
#include <vector>

namespace ffd
{

/// ITK's text format: the steps in the order in which they are applied.
struct ItkTransform
{
  std::vector<TransformStep> Steps;
};

/**
 * Make a step of ITK's name of a transform ("AffineTransform_double_3_3"), its parameters and its
 * fixed parameters, which are the same in all of ITK's formats. Three dimensions, double or float:
 * - splines: BSplineTransform and BSplineDeformableTransform of order 1 to 3;
 * - DisplacementFieldTransform and those that smooth its updates (BSplineSmoothingOnUpdate...,
 *   GaussianSmoothingOnUpdate...);
 * - linear: see MakeItkLinearStep().
 * Returns false and what is wrong.
 */
FFD_IO_EXPORT bool MakeItkStep(std::string_view type, const std::vector<double>& parameters,
  const std::vector<double>& fixedParameters, TransformStep& step, std::string& error);

/**
 * The linear ones, by their name alone: Identity, Translation, Scale, ScaleLogarithmic, Affine,
 * MatrixOffsetTransformBase, ScalableAffine, CenteredAffine, FixedCenterOfRotationAffine, Euler3D,
 * CenteredEuler3D, Versor, VersorRigid3D, Rigid3D, QuaternionRigid, Similarity3D, ScaleVersor3D,
 * ScaleSkewVersor3D and ComposeScaleSkewVersor3D, each followed by "Transform". `known` is false
 * for another name.
 */
FFD_IO_EXPORT bool MakeItkLinearStep(std::string_view name, const std::vector<double>& parameters,
  const std::vector<double>& fixedParameters, TransformStep& step, bool& known, std::string& error);

/**
 * Values of a grid step; `planar`: all x, then all y, then all z, as ITK keeps coefficients. A
 * spline is of step.Order.
 */
FFD_IO_EXPORT bool SetGridStep(TransformStep& step, TransformStep::Kind kind,
  const TransformGrid& grid, const std::vector<double>& parameters, bool planar,
  std::string& error);

/// Whether ITK's name is that of a CompositeTransform, which only says how those behind it chain.
FFD_IO_EXPORT bool IsItkComposite(std::string_view type);

/**
 * The list of `count` transforms of a file of ITK, the first of them of the type `first`: how many
 * are no steps (1 for a CompositeTransform, else 0). False for an empty list, for several without
 * a CompositeTransform, and for more than LargestChain.
 */
FFD_IO_EXPORT bool CheckItkList(
  std::size_t count, std::string_view first, std::size_t& skipped, std::string& error);

/**
 * Read a text transform of ITK (3D Slicer, ANTs; "#Insight Transform File V1.0") with the types
 * above, or a CompositeTransform of them. Returns false and what is wrong. What is allocated is
 * bounded by a small multiple of the text's length, whatever the text says. Every number of the
 * result is finite and at most 1e12, spacings are positive, directions orthonormal.
 */
FFD_IO_EXPORT bool ParseItkTransform(
  std::string_view text, ItkTransform& transform, std::string& error);

/// Whether a text starts as this format does.
FFD_IO_EXPORT bool LooksLikeItkTransform(std::string_view text);

/// The text of a chain of steps, none of them a Sum or inverse; numbers have the digits that give
/// the same double back.
FFD_IO_EXPORT std::string FormatItkTransform(const std::vector<TransformStep>& steps);

/**
 * Read a MATLAB level 4 file (.mat) as ITK writes it (ANTs): a column of parameters that bears the
 * name of the transform, then a column of fixed parameters. One transform: what a
 * CompositeTransform holds is not in such a file. As above.
 */
FFD_IO_EXPORT bool ParseMatlabTransform(
  std::string_view bytes, TransformStep& step, std::string& error);
FFD_IO_EXPORT bool LooksLikeMatlabTransform(std::string_view bytes);

} // namespace ffd

#endif
