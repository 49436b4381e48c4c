// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketField_h
#define FFDPacketField_h

#include "Bounds/FFDPullBackBounds.h"
#include "FFDBSplineField.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace ffd
{

/**
 * Single precision copy of a BSplineField for the packet kernels. Coordinates are relative to a
 * point near the volume, so that a volume far from the origin loses no precision.
 */
class PacketField
{
public:
  /// From a cell number to the first of its four control points on an axis.
  static constexpr int FirstOffset = BSplineField::Padding - 1;
  float Origin[3] = {};
  float InverseSpacing[3] = {};
  float ClampMin[3] = {};
  float ClampMax[3] = {};
  int StrideY = 1; ///< control points from row to row
  int StrideZ = 1; ///< rows from plane to plane
  /// x, y, z of each control point; copies of the field share them.
  std::shared_ptr<const std::vector<float>> Coefficients;
  /// |D(a + e) - D(a) - D'(a) e| <= SecondDerivative / 2 |e|^2 inside of the lattice.
  float SecondDerivative = 0.0f;
  /// Whether that holds everywhere: there is no kink where the lattice ends.
  bool Smooth = true;
  /// Length that steps of Newton's method are limited to: the longest edge of a cell of the
  /// lattice, or more, see AllowLongSteps().
  float LongestStep = 0.0f;
  /// Rounding errors of T, of which the inverse makes up to LargestRounding of a rest position.
  float Rounding = 0.0f;
  float LargestRounding = 0.0f;

  PacketField() = default;

  /// Takes a copy, relative to the origin of the data.
  explicit PacketField(const BSplineField& field)
    : PacketField(field, field, FindSecondDerivative(field))
  {
  }

  /**
   * Takes a copy of a field that is a lattice around `rest`, the volume at rest, outside of which
   * nobody needs D as it is: D goes on linearly there for `cells`, see ExtendLinearly(). So
   * T^-1 stays smooth along rays that leave the volume, and T one to one if the lattice turns the
   * volume by large angles; it would not with a D that is constant at once. T^-1 is the same
   * wherever it leads into the volume. Of another field it takes a copy as it is.
   * `secondDerivative`: FindSecondDerivative() of the field, which takes longer than the copy.
   */
  PacketField(
    const BSplineField& field, const Box& rest, const glm::ivec3& cells, double secondDerivative)
    : PacketField(field,
        cells != glm::ivec3(0) && CanExtend(field, rest) ? ExtendLinearly(field, cells) : field,
        secondDerivative)
  {
  }

  /// Makes coordinates relative to a point.
  void SetCenter(const glm::dvec3& center)
  {
    for (int a = 0; a < 3; ++a)
    {
      this->Origin[a] = static_cast<float>(this->Corner[a] - center[a]);
    }
  }

  /// The largest of |x|, |y| and |z| of all control points.
  float GetLargestCoefficient() const { return this->LargestCoefficient; }

  std::size_t GetMemorySize() const
  {
    return this->Coefficients ? this->Coefficients->capacity() * sizeof(float) : 0;
  }

  /// Lets steps of Newton's method be as long as those of a lattice of few control points, where T
  /// does not fold: they may be far shorter than what the cells of many control points are for.
  void AllowLongSteps() { this->LongestStep = this->LongStep; }

  /// A bound of the second derivatives of D, which are convex combinations of second differences of
  /// control points.
  static double FindSecondDerivative(const BSplineField& field)
  {
    const std::vector<glm::dvec3>& c = field.GetCoefficients();
    const glm::ivec3 n = field.GetPaddedNodes();
    const std::ptrdiff_t strides[3] = { 1, n.x, static_cast<std::ptrdiff_t>(n.x) * n.y };
    const glm::dvec3 h = glm::abs(field.GetSpacing());
    double sum = 0.0;
    for (int a = 0; a < 3; ++a)
    {
      for (int b = a; b < 3; ++b)
      {
        // c(+a +b) - c(+a) - c(+b) + c, which for a = b is the difference centered on +a.
        const glm::ivec3 end = n - (a == b ? 2 : 1);
        glm::ivec3 last = n;
        last[a] = end[a];
        last[b] = end[b];
        double largest = 0.0;
        for (int k = 0; k < last.z; ++k)
        {
          for (int j = 0; j < last.y; ++j)
          {
            for (int i = 0; i < last.x; ++i)
            {
              const std::ptrdiff_t at = i + strides[1] * j + strides[2] * k;
              const glm::dvec3 difference =
                c[at + strides[a] + strides[b]] - c[at + strides[a]] - c[at + strides[b]] + c[at];
              largest = std::max(largest, glm::dot(difference, difference));
            }
          }
        }
        sum += (a == b ? 1.0 : 2.0) * largest / (h[a] * h[a] * h[b] * h[b]);
      }
    }
    return std::sqrt(sum);
  }

private:
  /// Of the longest steps in the lattice.
  static constexpr double LongStepsAcross = 8.0;

  /// Takes the control points of `extended`, which is `field` or that with more around it.
  PacketField(const BSplineField& field, const BSplineField& extended, double secondDerivative)
    : StrideY(extended.GetPaddedNodes().x)
    , StrideZ(extended.GetPaddedNodes().y)
    , SecondDerivative(static_cast<float>(secondDerivative))
    , Smooth(extended.GetBorder() != BorderMode::ZeroAtBorder)
    , Corner(extended.GetOrigin())
  {
    this->SetCenter(glm::dvec3(0.0));
    const glm::dvec3 h = glm::abs(field.GetSpacing());
    const glm::dvec3 part = h * glm::dvec3(field.GetNodes() - 1) / LongStepsAcross;
    this->LongestStep = static_cast<float>(std::max({ h.x, h.y, h.z }));
    this->LongStep =
      std::max(this->LongestStep, static_cast<float>(std::max({ part.x, part.y, part.z })));
    for (int a = 0; a < 3; ++a)
    {
      this->InverseSpacing[a] = static_cast<float>(1.0 / field.GetSpacing()[a]);
      this->ClampMin[a] = static_cast<float>(extended.GetFirstCell()[a]);
      this->ClampMax[a] = static_cast<float>(extended.GetEndCell()[a]);
    }
    this->Copy(extended.GetCoefficients());
  }

  void Copy(const std::vector<glm::dvec3>& coefficients)
  {
    auto copy = std::make_shared<std::vector<float>>();
    copy->reserve(3 * coefficients.size() + 1);
    for (const glm::dvec3& c : coefficients)
    {
      for (int a = 0; a < 3; ++a)
      {
        copy->push_back(static_cast<float>(c[a]));
        this->LargestCoefficient = std::max(this->LargestCoefficient, std::abs(copy->back()));
      }
    }
    // Control points are loaded with the number behind them.
    copy->push_back(0.0f);
    this->Coefficients = std::move(copy);
  }

  static bool CanExtend(const BSplineField& field, const Box& rest)
  {
    constexpr double Rounding = 1e-6; // cells
    for (int a = 0; a < 3; ++a)
    {
      const double from = (rest.Min[a] - field.GetOrigin()[a]) / field.GetSpacing()[a];
      const double to = (rest.Max[a] - field.GetOrigin()[a]) / field.GetSpacing()[a];
      if (!(field.GetNodes()[a] >= 4 && std::min(from, to) >= 1.0 - Rounding &&
            std::max(from, to) <= field.GetNodes()[a] - 2 + Rounding))
      {
        return false;
      }
    }
    return true;
  }

  float LongStep = 0.0f;
  glm::dvec3 Corner{ 0.0 }; ///< the first control point, data coordinates
  float LargestCoefficient = 0.0f;
};

} // namespace ffd

#endif
