// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketField_h
#define FFDPacketField_h

#include "FFDBSplineField.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
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
  int StrideY = 1;                 ///< control points from row to row
  int StrideZ = 1;                 ///< rows from plane to plane
  std::vector<float> Coefficients; ///< x, y, z of each control point
  /// |D(a + e) - D(a) - D'(a) e| <= SecondDerivative / 2 |e|^2 inside of the lattice.
  float SecondDerivative = 0.0f;
  /// Of a step of Newton's method: one that is longer leaves what is known of the field.
  float LongestStep = 0.0f;
  /// Whether that holds everywhere: there is no kink where the lattice ends.
  bool Smooth = true;

  void Assign(const BSplineField& field, const glm::dvec3& centre)
  {
    this->Smooth = field.GetBorder() != BorderMode::ZeroAtBorder;
    for (int a = 0; a < 3; ++a)
    {
      this->Origin[a] = static_cast<float>(field.GetOrigin()[a] - centre[a]);
      this->InverseSpacing[a] = static_cast<float>(1.0 / field.GetSpacing()[a]);
      this->ClampMin[a] = static_cast<float>(field.GetFirstCell()[a]);
      this->ClampMax[a] = static_cast<float>(field.GetEndCell()[a]);
    }
    this->StrideY = field.GetPaddedNodes().x;
    this->StrideZ = field.GetPaddedNodes().y;
    this->Coefficients.clear();
    this->Coefficients.reserve(3 * field.GetCoefficients().size());
    for (const glm::dvec3& c : field.GetCoefficients())
    {
      this->Coefficients.push_back(static_cast<float>(c.x));
      this->Coefficients.push_back(static_cast<float>(c.y));
      this->Coefficients.push_back(static_cast<float>(c.z));
    }
    this->SecondDerivative = static_cast<float>(FindSecondDerivative(field));
    const glm::dvec3 h = glm::abs(field.GetSpacing());
    this->LongestStep = static_cast<float>(std::max({ h.x, h.y, h.z }));
  }

private:
  /// The second derivatives are convex combinations of second differences of control points.
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
        // c(+a +b) - c(+a) - c(+b) + c, which for a = b is the difference centred on +a.
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
              const glm::dvec3 difference = c[at + strides[a] + strides[b]] -
                c[at + strides[a]] - c[at + strides[b]] + c[at];
              largest = std::max(largest, glm::dot(difference, difference));
            }
          }
        }
        sum += (a == b ? 1.0 : 2.0) * largest / (h[a] * h[a] * h[b] * h[b]);
      }
    }
    return std::sqrt(sum);
  }
};

} // namespace ffd

#endif
