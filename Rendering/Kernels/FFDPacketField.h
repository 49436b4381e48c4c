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
  int StrideY = 1;                 ///< control points from row to row
  int StrideZ = 1;                 ///< rows from plane to plane
  std::vector<float> Coefficients; ///< x, y, z of each control point
  /// |D(a + e) - D(a) - D'(a) e| <= SecondDerivative / 2 |e|^2 inside of the lattice.
  float SecondDerivative = 0.0f;
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
  }

  /**
   * A field over [min, max] with `spacing` that approximates what it is given at its nodes:
   * SetNodes() with values at GetNode(), the difference being of the fourth order of the spacing.
   */
  void CoverBox(const glm::dvec3& min, const glm::dvec3& max, const glm::dvec3& spacing)
  {
    for (int a = 0; a < 3; ++a)
    {
      const double cells = std::max(1.0, std::ceil((max[a] - min[a]) / spacing[a]));
      this->Nodes[a] = static_cast<int>(cells) + FirstOffset + 3;
      this->Origin[a] = static_cast<float>(min[a]);
      this->InverseSpacing[a] = static_cast<float>(1.0 / spacing[a]);
      this->ClampMin[a] = 0.0f;
      this->ClampMax[a] = static_cast<float>(cells);
    }
    this->StrideY = this->Nodes[0];
    this->StrideZ = this->Nodes[1];
    this->Coefficients.assign(3 * this->GetNumberOfNodes(), 0.0f);
  }

  std::size_t GetNumberOfNodes() const
  {
    return static_cast<std::size_t>(this->Nodes[0]) * static_cast<std::size_t>(this->Nodes[1]) *
      static_cast<std::size_t>(this->Nodes[2]);
  }

  /// Position of node i, x fastest, after CoverBox().
  glm::vec3 GetNode(std::size_t i) const
  {
    const std::size_t nx = static_cast<std::size_t>(this->Nodes[0]);
    const std::size_t ny = static_cast<std::size_t>(this->Nodes[1]);
    const std::size_t at[3] = { i % nx, i / nx % ny, i / (nx * ny) };
    glm::vec3 p;
    for (int a = 0; a < 3; ++a)
    {
      const float node = static_cast<float>(at[a]) - static_cast<float>(FirstOffset + 1);
      p[a] = this->Origin[a] + node / this->InverseSpacing[a];
    }
    return p;
  }

  /// Quasi-interpolation: c = f - (second difference of f) / 6 along each axis.
  void SetNodes(std::vector<float>&& values)
  {
    this->Coefficients = std::move(values);
    const std::size_t strides[3] = { 3, 3 * static_cast<std::size_t>(this->Nodes[0]),
      3 * static_cast<std::size_t>(this->Nodes[0]) * static_cast<std::size_t>(this->Nodes[1]) };
    std::vector<float> source;
    for (int a = 0; a < 3; ++a)
    {
      source = this->Coefficients;
      const std::size_t n = static_cast<std::size_t>(this->Nodes[a]);
      for (std::size_t i = 0; i < source.size(); ++i)
      {
        const std::size_t at = i / strides[a] % n;
        if (at > 0 && at + 1 < n)
        {
          this->Coefficients[i] =
            (8.0f * source[i] - source[i - strides[a]] - source[i + strides[a]]) / 6.0f;
        }
      }
    }
  }

  int Nodes[3] = {}; ///< after CoverBox()

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
