// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// ITK's transforms by their names: what their parameters mean.
#include "FFDGridIndex.h"
#include "FFDItkTransform.h"

#include "FFDTransformText.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace ffd
{
namespace
{

/// Rotation by angles about x, y and z: Rz Rx Ry, or Rz Ry Rx, as itk::Euler3DTransform.
glm::dmat3 EulerMatrix(const glm::dvec3& angles, bool zyx)
{
  const glm::dvec3 c(std::cos(angles.x), std::cos(angles.y), std::cos(angles.z));
  const glm::dvec3 s(std::sin(angles.x), std::sin(angles.y), std::sin(angles.z));
  // Columns.
  const glm::dmat3 rx(1.0, 0.0, 0.0, 0.0, c.x, s.x, 0.0, -s.x, c.x);
  const glm::dmat3 ry(c.y, 0.0, -s.y, 0.0, 1.0, 0.0, s.y, 0.0, c.y);
  const glm::dmat3 rz(c.z, s.z, 0.0, -s.z, c.z, 0.0, 0.0, 0.0, 1.0);
  return zyx ? rz * ry * rx : rz * rx * ry;
}

/// Rotation of the unit quaternion with this vector part (a "versor").
bool VersorMatrix(const glm::dvec3& v, glm::dmat3& matrix)
{
  const double square = v.x * v.x + v.y * v.y + v.z * v.z;
  if (square > 1.0 + 1e-9)
  {
    return false;
  }
  const double w = std::sqrt(std::max(0.0, 1.0 - square));
  matrix = glm::dmat3(1.0 - 2.0 * (v.y * v.y + v.z * v.z), 2.0 * (v.x * v.y + v.z * w),
    2.0 * (v.x * v.z - v.y * w), 2.0 * (v.x * v.y - v.z * w), 1.0 - 2.0 * (v.x * v.x + v.z * v.z),
    2.0 * (v.y * v.z + v.x * w), 2.0 * (v.x * v.z + v.y * w), 2.0 * (v.y * v.z - v.x * w),
    1.0 - 2.0 * (v.x * v.x + v.y * v.y));
  return true;
}

glm::dmat3 Diagonal(const glm::dvec3& d)
{
  return glm::dmat3(d.x, 0.0, 0.0, 0.0, d.y, 0.0, 0.0, 0.0, d.z);
}

/// The matrix of the transforms that begin with a versor.
glm::dmat3 VersorBasedMatrix(
  std::string_view name, const glm::dmat3& rotation, const std::vector<double>& p)
{
  if (name == "Similarity3DTransform")
  {
    return rotation * p[6];
  }
  if (name == "ScaleVersor3DTransform")
  {
    return rotation + Diagonal(VectorAt(p, 6)) - glm::dmat3(1.0); // a sum, in ITK
  }
  if (name == "ScaleSkewVersor3DTransform")
  {
    const glm::dmat3 skew(0.0, p[11], p[13], p[9], 0.0, p[14], p[10], p[12], 0.0);
    return rotation + Diagonal(VectorAt(p, 6)) - glm::dmat3(1.0) + skew;
  }
  if (name == "ComposeScaleSkewVersor3DTransform")
  {
    const glm::dmat3 skew(1.0, 0.0, 0.0, p[9], 1.0, 0.0, p[10], p[11], 1.0);
    return rotation * Diagonal(VectorAt(p, 6)) * skew;
  }
  return rotation;
}

/// Three numbers from `first` on, or zeros.
glm::dvec3 VectorOrZero(const std::vector<double>& values, std::size_t first)
{
  return values.size() >= first + 3 ? VectorAt(values, first) : glm::dvec3(0.0);
}

} // namespace

//------------------------------------------------------------------------------
bool SetGridStep(TransformStep& step, TransformStep::Kind kind, const TransformGrid& grid,
  const std::vector<double>& parameters, bool planar, std::string& error)
{
  const bool spline = kind == TransformStep::Kind::Spline;
  error = FindGridProblem(grid, spline ? step.Order + 1 : 1);
  if (!error.empty())
  {
    return false;
  }
  const std::size_t count = GridSize(grid.Size);
  if (!HasCount(parameters, 3 * count, "the list of parameters", error))
  {
    error += " for a grid of " + std::to_string(grid.Size.x) + " x " + std::to_string(grid.Size.y) +
      " x " + std::to_string(grid.Size.z) + " nodes";
    return false;
  }
  step.Type = kind;
  step.Grid = grid;
  step.Values.resize(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    step.Values[i] = planar
      ? glm::dvec3(parameters[i], parameters[count + i], parameters[2 * count + i])
      : VectorAt(parameters, 3 * i);
  }
  return true;
}

//------------------------------------------------------------------------------
bool MakeItkLinearStep(std::string_view name, const std::vector<double>& p,
  const std::vector<double>& fixed, TransformStep& step, bool& known, std::string& error)
{
  struct Type
  {
    std::size_t Count;   // of parameters
    bool HasFixedCenter; // its center is in the fixed parameters
  };
  static const std::map<std::string_view, Type> types = { { "AffineTransform", { 12, true } },
    { "CenteredAffineTransform", { 15, false } }, { "CenteredEuler3DTransform", { 9, false } },
    { "ComposeScaleSkewVersor3DTransform", { 12, true } }, { "Euler3DTransform", { 6, true } },
    { "IdentityTransform", { 0, false } }, { "MatrixOffsetTransformBase", { 12, true } },
    { "QuaternionRigidTransform", { 7, true } }, { "Rigid3DTransform", { 12, true } },
    { "ScalableAffineTransform", { 12, true } }, { "ScaleLogarithmicTransform", { 3, true } },
    { "ScaleSkewVersor3DTransform", { 15, true } }, { "ScaleTransform", { 3, true } },
    { "ScaleVersor3DTransform", { 9, true } }, { "Similarity3DTransform", { 7, true } },
    { "TranslationTransform", { 3, false } }, { "VersorRigid3DTransform", { 6, true } },
    { "VersorTransform", { 3, true } } };
  const auto found = types.find(name);
  known = found != types.end();
  if (!known)
  {
    return true;
  }
  const auto [count, hasFixedCenter] = found->second;
  const std::string what = "the list of parameters of " + std::string(name);
  if (count != 0 && !HasCount(p, count, what.c_str(), error))
  {
    return false;
  }
  if (hasFixedCenter && fixed.size() < 3)
  {
    error = "the list of fixed parameters of " + std::string(name) + " has " +
      std::to_string(fixed.size()) + " numbers, not the 3 of its center";
    return false;
  }
  const glm::dvec3 zero(0.0);
  const glm::dvec3 center = hasFixedCenter ? VectorAt(fixed, 0) : zero;
  const bool zyx = fixed.size() >= 4 && fixed[3] != 0.0;
  if (count == 0)
  {
    SetCentered(step, glm::dmat3(1.0), zero, zero);
  }
  else if (name == "TranslationTransform")
  {
    SetCentered(step, glm::dmat3(1.0), zero, VectorAt(p, 0));
  }
  else if (name == "ScaleTransform")
  {
    SetCentered(step, Diagonal(VectorAt(p, 0)), center, zero);
  }
  else if (name == "ScaleLogarithmicTransform")
  {
    SetCentered(step, Diagonal({ std::exp(p[0]), std::exp(p[1]), std::exp(p[2]) }), center, zero);
  }
  else if (name == "Euler3DTransform")
  {
    SetCentered(step, EulerMatrix(VectorAt(p, 0), zyx), center, VectorAt(p, 3));
  }
  else if (name == "CenteredEuler3DTransform")
  {
    SetCentered(step, EulerMatrix(VectorAt(p, 0), zyx), VectorAt(p, 3), VectorAt(p, 6));
  }
  else if (name == "CenteredAffineTransform")
  {
    SetCentered(step, MatrixAt(p, 0), VectorAt(p, 9), VectorAt(p, 12));
  }
  else if (count == 12 && name != "ComposeScaleSkewVersor3DTransform")
  {
    SetCentered(step, MatrixAt(p, 0), center, VectorAt(p, 9));
  }
  else
  {
    glm::dvec3 versor = VectorAt(p, 0);
    std::size_t translation = 3;
    double scale = 1.0;
    if (name == "QuaternionRigidTransform")
    {
      const double square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3];
      if (!(square > 0.0))
      {
        error = "the quaternion (the first four parameters) is zero";
        return false;
      }
      // In ITK one that is not of length 1 scales by the square of its length.
      scale = square;
      versor /= (p[3] < 0.0 ? -1.0 : 1.0) * std::sqrt(square);
      translation = 4;
    }
    glm::dmat3 rotation(1.0);
    if (!VersorMatrix(versor, rotation))
    {
      error = "the versor (the first three parameters) is longer than 1";
      return false;
    }
    SetCentered(
      step, scale * VersorBasedMatrix(name, rotation, p), center, VectorOrZero(p, translation));
  }
  return true;
}

//------------------------------------------------------------------------------
bool MakeItkStep(std::string_view type, const std::vector<double>& parameters,
  const std::vector<double>& fixed, TransformStep& step, std::string& error)
{
  step = TransformStep();
  // Name_precision_dimension_dimension, and behind it the order of a spline that is not cubic.
  const std::size_t bar = type.find('_');
  const std::string_view name = type.substr(0, bar);
  std::string_view rest = bar == std::string_view::npos ? std::string_view() : type.substr(bar);
  const bool spline = name == "BSplineTransform" || name == "BSplineDeformableTransform";
  const std::size_t end = rest.rfind('_');
  const std::string_view order = rest.substr(std::min(end, rest.size()));
  if (spline && (order == "_1" || order == "_2"))
  {
    step.Order = order[1] - '0';
    rest.remove_suffix(2);
  }
  if (rest != "_double_3_3" && rest != "_float_3_3")
  {
    error = "the transform is a " + Quote(type) +
      ", not one of three dimensions (a name that ends in _double_3_3 or _float_3_3)";
    return false;
  }
  for (const std::vector<double>* numbers : { &parameters, &fixed })
  {
    for (const double number : *numbers)
    {
      if (!(std::abs(number) <= LargestNumber))
      {
        error = "a parameter of a " + Quote(type) + " is not a finite number of at most 1e12";
        return false;
      }
    }
  }
  if (spline || name == "DisplacementFieldTransform" ||
    name == "BSplineSmoothingOnUpdateDisplacementFieldTransform" ||
    name == "GaussianSmoothingOnUpdateDisplacementFieldTransform")
  {
    TransformGrid grid;
    if (!HasCount(fixed, 18, "the list of fixed parameters", error))
    {
      return false;
    }
    if (!SizeAt(fixed, 0, grid.Size))
    {
      error = "the size of the grid (the first three fixed parameters) is no positive integer";
      return false;
    }
    grid.Origin = VectorAt(fixed, 3);
    grid.Spacing = VectorAt(fixed, 6);
    grid.Direction = MatrixAt(fixed, 9);
    return SetGridStep(step, spline ? TransformStep::Kind::Spline : TransformStep::Kind::Field,
      grid, parameters, spline, error);
  }
  bool known = false;
  if (!MakeItkLinearStep(name, parameters, fixed, step, known, error))
  {
    return false;
  }
  if (!known)
  {
    error = IsItkComposite(type)
      ? "a CompositeTransform holds another one, which ITK does not write"
      : "transforms of the type " + Quote(type) + " are not supported";
    return false;
  }
  if (IsSingular(step))
  {
    error = "the matrix of a " + Quote(type) + " is singular";
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
bool IsItkComposite(std::string_view type) { return type.substr(0, 18) == "CompositeTransform"; }

//------------------------------------------------------------------------------
bool CheckItkList(
  std::size_t count, std::string_view first, std::size_t& skipped, std::string& error)
{
  skipped = IsItkComposite(first) ? 1 : 0;
  if (count == 0)
  {
    error = "there is no transform in it";
  }
  else if (skipped == 0 && count > 1)
  {
    error = "there are " + std::to_string(count) +
      " transforms and no CompositeTransform that says how they go together";
  }
  else if (count - skipped > LargestChain)
  {
    error = "there are more than 64 transforms";
  }
  else
  {
    return true;
  }
  return false;
}

} // namespace ffd
