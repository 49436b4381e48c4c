// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDBSplineField_h
#define FFDBSplineField_h

#include "FFDExport.h"
#include "FFDGridIndex.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <vector>

namespace ffd
{

/// Extrapolation of the displacement outside the control points; the values are those of
/// vtkBSplineTransform (VTK_BSPLINE_EDGE, VTK_BSPLINE_ZERO, VTK_BSPLINE_ZERO_AT_BORDER).
enum class BorderMode
{
  Edge = 0,
  Zero = 1,
  ZeroAtBorder = 2
};

/**
 * A uniform cubic B-spline displacement field D, the FFD of section 4.1 of the paper:
 * T(X) = X + D(X).
 *
 * Control point (i, j, k) rests at Origin + (i, j, k) * Spacing (data coordinates, axis aligned)
 * and carries a displacement in the same units. Cell c of an axis is the parameter interval
 * [c, c + 1) in control-point indices; it depends on the control points c - 1 ... c + 2.
 *
 * The border mode is folded into the coefficients: they are stored with `Padding` extra control
 * points on each side (repeated, zero, or reflected), and an evaluation clamps its parameter to
 * [ClampMin, ClampMax], outside of which the field is constant along that axis. So every kernel
 * is the same for all border modes. An axis with a single control point is constant, as in
 * vtkBSplineTransform.
 */
class FFD_CORE_EXPORT BSplineField
{
public:
  static constexpr int Padding = 3;

  /// The zero field: T is the identity.
  BSplineField();

  /**
   * Take a copy of nodes.x * nodes.y * nodes.z displacements, x fastest, each multiplied by
   * `scale`. Every component of `nodes` is >= 1, of `spacing` non-zero.
   */
  BSplineField(const glm::ivec3& nodes, const glm::dvec3& origin, const glm::dvec3& spacing,
    const glm::dvec3* displacements, double scale = 1.0, BorderMode border = BorderMode::Edge);

  const glm::ivec3& GetNodes() const { return this->Nodes; }
  const glm::dvec3& GetOrigin() const { return this->Origin; }
  const glm::dvec3& GetSpacing() const { return this->Spacing; }
  BorderMode GetBorder() const { return this->Border; }

  /// Whether the two are the same map, from the same control points.
  bool operator==(const BSplineField& other) const
  {
    return this->Nodes == other.Nodes && this->Origin == other.Origin &&
      this->Spacing == other.Spacing && this->Border == other.Border &&
      (this->Coefficients == other.Coefficients || *this->Coefficients == *other.Coefficients);
  }

  /// True when every coefficient is exactly zero.
  bool IsZero() const { return this->Zero; }

  /// D(p).
  glm::dvec3 Displacement(const glm::dvec3& p) const;

  /// D(p) and its Jacobian: jacobian[column][row], column b holds dD/dp_b (GLM is column major).
  glm::dvec3 Displacement(const glm::dvec3& p, glm::dmat3& jacobian) const;

  /// Most control points that count at a point.
  static constexpr int MaximumSupport = 64;

  /**
   * Computes the weights of control points at p: D(p) is the sum of weights[n] times the
   * displacement (scale included) of control point nodes[n], an index with x fastest. The border
   * mode is applied, and no control point is named twice. Returns how many there are; control
   * points of weight zero are left out.
   */
  int ControlWeights(
    const glm::dvec3& p, std::size_t nodes[MaximumSupport], double weights[MaximumSupport]) const;

  /// First cell with varying coefficients and one past the last one, per axis, border included.
  /// Outside of [FirstCell, EndCell) the field is constant along the axis.
  const glm::ivec3& GetFirstCell() const { return this->FirstCell; }
  const glm::ivec3& GetEndCell() const { return this->EndCell; }

  /// Coefficient of control point (i, j, k); -Padding <= i < nodes + Padding, border mode applied.
  const glm::dvec3& Coefficient(int i, int j, int k) const
  {
    return (*this->Coefficients)[this->CoefficientIndex(i, j, k)];
  }
  std::size_t CoefficientIndex(int i, int j, int k) const
  {
    return GridIndex(i + Padding, j + Padding, k + Padding, this->PaddedNodes);
  }
  const glm::ivec3& GetPaddedNodes() const { return this->PaddedNodes; }
  const std::vector<glm::dvec3>& GetCoefficients() const { return *this->Coefficients; }

private:
  glm::ivec3 Nodes;
  glm::ivec3 PaddedNodes;
  glm::dvec3 Origin;
  glm::dvec3 Spacing;
  glm::dvec3 InverseSpacing;
  glm::dvec3 ClampMin; // in control-point indices
  glm::dvec3 ClampMax;
  glm::ivec3 FirstCell;
  glm::ivec3 EndCell;
  BorderMode Border;
  bool Zero;
  // Padded, scaled, border applied; never changed, so that copies share them.
  std::shared_ptr<const std::vector<glm::dvec3>> Coefficients;
};

/**
 * The field of which D goes on linearly beyond the control points, for `cells` >= 0 cells along
 * each axis, and is constant from there. `field` has at least 2 control points along each axis; in
 * the cells whose control points are all its own the two are the same.
 */
FFD_CORE_EXPORT BSplineField ExtendLinearly(const BSplineField& field, const glm::ivec3& cells);

} // namespace ffd

#endif
