// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDUniformSpline.h"

#include "FFDBSplineBasis.h"
#include "FFDGridIndex.h"

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

constexpr int MaximumSupport = 4;

/// Control points that count on one axis: weights, and their derivatives by the index.
struct AxisWeights
{
  int First = 0;
  double Weights[MaximumSupport];
  double Slopes[MaximumSupport];
};

/// At the index x; one that is not finite, or far outside, is taken to where nothing varies.
AxisWeights FindWeights(int order, double x, int size)
{
  AxisWeights axis;
  const double reach = order + 1.0;
  const double inside = x > -reach ? std::min(x, size + reach) : -reach;
  const double first = std::floor(inside - 0.5 * (order - 1));
  const double u = inside - 0.5 * (order - 1) - first;
  axis.First = static_cast<int>(first);
  double* const w = axis.Weights;
  double* const d = axis.Slopes;
  switch (order)
  {
    case 1:
      w[0] = 1.0 - u;
      w[1] = u;
      d[0] = -1.0;
      d[1] = 1.0;
      break;
    case 2:
      w[0] = 0.5 * (1.0 - u) * (1.0 - u);
      w[1] = 0.75 - (u - 0.5) * (u - 0.5);
      w[2] = 0.5 * u * u;
      d[0] = u - 1.0;
      d[1] = 1.0 - 2.0 * u;
      d[2] = u;
      break;
    default:
      BSplineWeights(u, w);
      BSplineDerivativeWeights(u, d);
      break;
  }
  return axis;
}

} // namespace

//------------------------------------------------------------------------------
glm::dvec3 UniformSpline::Forward(const glm::dvec3& p) const
{
  glm::dmat3 jacobian;
  return this->Forward(p, jacobian);
}

//------------------------------------------------------------------------------
glm::dvec3 UniformSpline::Forward(const glm::dvec3& p, glm::dmat3& jacobian) const
{
  jacobian = glm::dmat3(1.0);
  if (this->Values.empty())
  {
    return p;
  }
  AxisWeights axes[3];
  for (int a = 0; a < 3; ++a)
  {
    axes[a] = FindWeights(this->Order, (p[a] - this->Origin[a]) / this->Spacing[a], this->Size[a]);
  }
  glm::dvec3 displacement(0.0);
  glm::ivec3 n;
  for (n.z = 0; n.z <= this->Order; ++n.z)
  {
    for (n.y = 0; n.y <= this->Order; ++n.y)
    {
      for (n.x = 0; n.x <= this->Order; ++n.x)
      {
        const glm::ivec3 node = n + glm::ivec3(axes[0].First, axes[1].First, axes[2].First);
        const glm::ivec3 kept(std::clamp(node.x, 0, this->Size.x - 1),
          std::clamp(node.y, 0, this->Size.y - 1), std::clamp(node.z, 0, this->Size.z - 1));
        if (!this->Repeat && kept != node)
        {
          continue;
        }
        const glm::dvec3& value = this->Values[GridIndex(kept, this->Size)];
        const glm::dvec3 w(axes[0].Weights[n.x], axes[1].Weights[n.y], axes[2].Weights[n.z]);
        displacement += w.x * w.y * w.z * value;
        jacobian[0] += axes[0].Slopes[n.x] * w.y * w.z / this->Spacing.x * value;
        jacobian[1] += w.x * axes[1].Slopes[n.y] * w.z / this->Spacing.y * value;
        jacobian[2] += w.x * w.y * axes[2].Slopes[n.z] / this->Spacing.z * value;
      }
    }
  }
  return p + displacement;
}

} // namespace ffd
