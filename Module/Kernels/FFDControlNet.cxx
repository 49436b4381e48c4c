// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDControlNet.h"

#include "FFDBSplineBasis.h"
#include "FFDGridIndex.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace ffd
{
namespace
{

/// Apply `line` (n values in, m values out) along one axis of a net.
template <typename Line>
ControlNet MapLines(const ControlNet& net, int axis, int size, const Line& line)
{
  ControlNet result;
  result.Nodes = net.Nodes;
  result.Nodes[axis] = size;
  result.Values.resize(GridSize(result.Nodes));
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a)
  {
    stride *= static_cast<std::size_t>(net.Nodes[a]);
  }
  const std::size_t n = static_cast<std::size_t>(net.Nodes[axis]);
  const std::size_t m = static_cast<std::size_t>(size);
  const std::size_t outer = net.Values.size() / (stride * n);
  std::vector<glm::dvec3> in(n);
  std::vector<glm::dvec3> out(m);
  for (std::size_t o = 0; o < outer; ++o)
  {
    for (std::size_t s = 0; s < stride; ++s)
    {
      for (std::size_t i = 0; i < n; ++i)
      {
        in[i] = net.Values[(o * n + i) * stride + s];
      }
      line(in, out);
      for (std::size_t i = 0; i < m; ++i)
      {
        result.Values[(o * m + i) * stride + s] = out[i];
      }
    }
  }
  return result;
}

/// ((1 + z + ... + z^(f-1)) / f)^4 * f.
std::vector<double> RefinementMask(int factor)
{
  std::vector<double> mask(1, static_cast<double>(factor));
  for (int power = 0; power < 4; ++power)
  {
    std::vector<double> next(mask.size() + static_cast<std::size_t>(factor) - 1, 0.0);
    for (std::size_t i = 0; i < mask.size(); ++i)
    {
      for (std::size_t j = 0; j < static_cast<std::size_t>(factor); ++j)
      {
        next[i + j] += mask[i] / factor;
      }
    }
    mask = next;
  }
  return mask;
}

/// Coefficients c[0 ... m + 1] with (c[i-1] + 4 c[i] + c[i+1]) / 6 = f[i-1], i = 1 ... m.
void InterpolateLine(const std::vector<glm::dvec3>& f, std::vector<glm::dvec3>& c)
{
  const std::size_t m = f.size();
  const auto sample = [&f](std::size_t i) { return f[i - 1]; };
  if (m == 2)
  {
    c[1] = sample(1);
    c[2] = sample(2);
  }
  else if (m == 3)
  {
    // The quadratic through three samples: second difference s, c = f - s / 6.
    const glm::dvec3 sixth = (sample(1) - 2.0 * sample(2) + sample(3)) / 6.0;
    for (std::size_t i = 1; i <= 3; ++i)
    {
      c[i] = sample(i) - sixth;
    }
  }
  else
  {
    // Not-a-knot and the first three equations leave one unknown: c[2] is explicit; so is c[m-1].
    c[2] = (8.0 * sample(2) - sample(1) - sample(3)) / 6.0;
    c[m - 1] = (8.0 * sample(m - 1) - sample(m) - sample(m - 2)) / 6.0;
    // Thomas' algorithm for c[3] ... c[m-2]; the matrix is diagonally dominant.
    if (m > 4)
    {
      std::vector<double> upper(m, 0.0);
      for (std::size_t i = 3; i <= m - 2; ++i)
      {
        glm::dvec3 right = 6.0 * sample(i);
        right -= i == m - 2 ? c[m - 1] : glm::dvec3(0.0);
        const double pivot = 4.0 - upper[i - 1];
        upper[i] = 1.0 / pivot;
        // c[2] is known, so the first row carries it to the right-hand side like any other.
        c[i] = (right - c[i - 1]) / pivot;
      }
      for (std::size_t i = m - 3; i >= 3; --i)
      {
        c[i] -= upper[i] * c[i + 1];
      }
    }
    c[1] = 6.0 * sample(2) - 4.0 * c[2] - c[3];
    c[m] = 6.0 * sample(m - 1) - 4.0 * c[m - 1] - c[m - 2];
  }
  c[0] = 6.0 * sample(1) - 4.0 * c[1] - c[2];
  c[m + 1] = 6.0 * sample(m) - 4.0 * c[m] - c[m - 1];
}

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
/// Vectors of a line, one a row.
using LineMatrix = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Weight of what lies beyond the domain, where splines that differ are as near as can be.
constexpr double WeightBeyond = 0.1;
/// Splines whose difference is at most this part of them are the same.
constexpr double RoundingError = 1e-9;

/// Places for integrals over products of two cubic splines with `nodes` and `size` control points,
/// in the domain, which is 0 to 1, and in a cell of the second one beyond each end of it.
struct Quadrature
{
  Quadrature(int nodes, int size)
  {
    const double reach = 1.0 / (size - 3);
    std::vector<double> knots;
    for (const int cells : { nodes - 3, size - 3 })
    {
      const int beyond = (cells + size - 4) / (size - 3);
      for (int k = -beyond; k <= cells + beyond; ++k)
      {
        knots.push_back(std::clamp(static_cast<double>(k) / cells, -reach, 1.0 + reach));
      }
    }
    std::sort(knots.begin(), knots.end());
    // Legendre's four points, exact for polynomials of degree 7.
    const double points[4] = { -0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
      0.8611363115940526 };
    const double weights[4] = { 0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
      0.3478548451374538 };
    for (std::size_t i = 1; i < knots.size(); ++i)
    {
      const double half = 0.5 * (knots[i] - knots[i - 1]);
      for (int p = 0; half > 1e-12 && p < 4; ++p)
      {
        this->Places.push_back(knots[i - 1] + half * (1.0 + points[p]));
        this->Lengths.push_back(half * weights[p]);
      }
    }
  }

  /// Of the places, those beyond the domain times `beyond`.
  Eigen::VectorXd GetWeights(double beyond) const
  {
    Eigen::VectorXd weights(static_cast<Eigen::Index>(this->Places.size()));
    for (std::size_t i = 0; i < this->Places.size(); ++i)
    {
      const bool within = this->Places[i] > 0.0 && this->Places[i] < 1.0;
      weights[static_cast<Eigen::Index>(i)] = this->Lengths[i] * (within ? 1.0 : beyond);
    }
    return weights;
  }

  std::vector<double> Places;
  std::vector<double> Lengths; ///< of what a place stands for
};

/// The weights of `nodes` control points at places, a row each. Beyond the domain there are more
/// control points: all are half of the last difference from the last one.
SparseMatrix MakeSplineRows(int nodes, const std::vector<double>& places)
{
  std::vector<Eigen::Triplet<double>> elements;
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    const double x = places[i] * (nodes - 3);
    const int cell = static_cast<int>(std::floor(x));
    double weights[4];
    BSplineWeights(x - cell, weights);
    const auto add = [&](int node, double weight) {
      elements.emplace_back(static_cast<int>(i), node, weight);
    };
    for (int k = 0; k < 4; ++k)
    {
      const int node = cell + k;
      if (node < 0 || node >= nodes)
      {
        add(node < 0 ? 0 : nodes - 1, 1.5 * weights[k]);
        add(node < 0 ? 1 : nodes - 2, -0.5 * weights[k]);
      }
      else
      {
        add(node, weights[k]);
      }
    }
  }
  SparseMatrix rows(static_cast<int>(places.size()), nodes);
  rows.setFromTriplets(elements.begin(), elements.end());
  return rows;
}

/// Finds control points for which the values of the rows of `to` are nearest to those of the rows
/// of `from` for others.
class NearestSpline
{
public:
  NearestSpline(const SparseMatrix& from, const SparseMatrix& to, const Eigen::VectorXd& weights)
  {
    const SparseMatrix weighted = weights.asDiagonal() * to;
    this->Right = weighted.transpose() * from;
    this->Solver.compute(Eigen::SparseMatrix<double>(to.transpose() * weighted));
  }
  LineMatrix Find(const LineMatrix& line) const
  {
    return this->Solver.solve((this->Right * line).eval());
  }

private:
  SparseMatrix Right;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> Solver;
};

/// The control points of linear functions that are 1, and that are 0 at one end of the domain and 1
/// at the other one.
Eigen::MatrixX2d MakeLinearNodes(int nodes)
{
  Eigen::MatrixX2d linear(nodes, 2);
  for (int i = 0; i < nodes; ++i)
  {
    linear.row(i) << 1.0, static_cast<double>(i - 1) / (nodes - 3);
  }
  return linear;
}

/// ResizeControlNet() of an axis by least squares.
ControlNet ApproximateControlNet(const ControlNet& net, int axis, int size)
{
  const int nodes = net.Nodes[axis];
  const Quadrature quadrature(nodes, size);
  const SparseMatrix from = MakeSplineRows(nodes, quadrature.Places);
  const SparseMatrix to = MakeSplineRows(size, quadrature.Places);
  const auto mapLines = [&](const auto& find) {
    return MapLines(
      net, axis, size, [&](const std::vector<glm::dvec3>& in, std::vector<glm::dvec3>& out) {
        Eigen::Map<LineMatrix>(&out[0].x, size, 3) =
          find(LineMatrix(Eigen::Map<const LineMatrix>(&in[0].x, nodes, 3)));
      });
  };

  const Eigen::VectorXd within = quadrature.GetWeights(0.0);
  const NearestSpline inDomain(from, to, within);
  double largest = 0.0;
  double error = 0.0;
  ControlNet result = mapLines([&](const LineMatrix& line) -> LineMatrix {
    const LineMatrix found = inDomain.Find(line);
    const LineMatrix values = from * line;
    const LineMatrix errors = within.cwiseSign().asDiagonal() * (to * found - values).eval();
    largest = std::max(largest, values.cwiseAbs().maxCoeff());
    error = std::max(error, errors.cwiseAbs().maxCoeff());
    return found;
  });
  if (error <= RoundingError * largest)
  {
    return result;
  }

  const NearestSpline nearest(from, to, quadrature.GetWeights(WeightBeyond));
  const Eigen::MatrixX2d oldLinear = MakeLinearNodes(nodes);
  const Eigen::MatrixX2d newLinear = MakeLinearNodes(size);
  const Eigen::MatrixX2d linearValues = from * oldLinear;
  const Eigen::Matrix2Xd weighted = linearValues.transpose() * within.asDiagonal();
  const Eigen::Matrix2Xd toLinear =
    (weighted * linearValues).eval().inverse() * (weighted * from).eval();
  return mapLines([&](const LineMatrix& line) -> LineMatrix {
    const Eigen::Matrix<double, 2, 3> linear = toLinear * line;
    return nearest.Find(line - oldLinear * linear) + newLinear * linear;
  });
}

} // namespace

//------------------------------------------------------------------------------
ControlNet RefineControlNet(const ControlNet& net, const glm::ivec3& factors)
{
  ControlNet result = net;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int factor = factors[axis];
    if (factor <= 1)
    {
      continue;
    }
    const std::vector<double> mask = RefinementMask(factor);
    const int nodes = result.Nodes[axis];
    const int size = (nodes - 3) * factor + 3;
    result = MapLines(
      result, axis, size, [&](const std::vector<glm::dvec3>& in, std::vector<glm::dvec3>& out) {
        for (int i = 0; i < size; ++i)
        {
          // Fine control point i rests at 1 + (i - 1) / factor of the coarse ones.
          const int fine = factor + i - 1;
          glm::dvec3 sum(0.0);
          for (int j = 0; j < nodes; ++j)
          {
            const int k = fine - factor * j + 2 * (factor - 1);
            if (k >= 0 && k < static_cast<int>(mask.size()))
            {
              sum += mask[static_cast<std::size_t>(k)] * in[static_cast<std::size_t>(j)];
            }
          }
          out[static_cast<std::size_t>(i)] = sum;
        }
      });
  }
  return result;
}

//------------------------------------------------------------------------------
ControlNet ResizeControlNet(const ControlNet& net, const glm::ivec3& nodes)
{
  ControlNet result = net;
  for (int axis = 0; axis < 3; ++axis)
  {
    glm::ivec3 factors(1);
    factors[axis] = (nodes[axis] - 3) / (net.Nodes[axis] - 3);
    const bool isMultiple = (nodes[axis] - 3) % (net.Nodes[axis] - 3) == 0;
    result = isMultiple ? RefineControlNet(result, factors)
                        : ApproximateControlNet(result, axis, nodes[axis]);
  }
  return result;
}

//------------------------------------------------------------------------------
ControlNet InterpolateControlNet(const ControlNet& samples)
{
  ControlNet result = samples;
  for (int axis = 0; axis < 3; ++axis)
  {
    result = MapLines(result, axis, result.Nodes[axis] + 2, InterpolateLine);
  }
  return result;
}

//------------------------------------------------------------------------------
ControlNet SampleControlNet(
  const ControlNet& net, const glm::ivec3& perCell, const ParallelFor& parallelFor)
{
  ControlNet result = net;
  for (int axis = 0; axis < 3; ++axis)
  {
    const ControlNet from = std::move(result);
    const int cells = from.Nodes[axis] - 3;
    const int each = perCell[axis];
    std::vector<std::array<double, 4>> weights(static_cast<std::size_t>(each) + 1);
    for (int m = 0; m <= each; ++m)
    {
      BSplineWeights(static_cast<double>(m) / each, weights[static_cast<std::size_t>(m)].data());
    }
    result = ControlNet();
    result.Nodes = from.Nodes;
    result.Nodes[axis] = cells * each + 1;
    result.Values.resize(GridSize(result.Nodes));
    // Rows of what lies along the axes before this one.
    std::size_t length = 1;
    for (int a = 0; a < axis; ++a)
    {
      length *= static_cast<std::size_t>(from.Nodes[a]);
    }
    const auto count = static_cast<std::size_t>(result.Nodes[axis]);
    parallelFor(result.Values.size() / length, [&](std::size_t first, std::size_t end) {
      for (std::size_t row = first; row < end; ++row)
      {
        const int sample = static_cast<int>(row % count);
        const int cell = std::min(sample / each, cells - 1);
        const std::array<double, 4>& w = weights[static_cast<std::size_t>(sample - cell * each)];
        const std::size_t node =
          row / count * static_cast<std::size_t>(from.Nodes[axis]) + static_cast<std::size_t>(cell);
        const glm::dvec3* const in = from.Values.data() + node * length;
        glm::dvec3* const out = result.Values.data() + row * length;
        for (std::size_t i = 0; i < length; ++i)
        {
          out[i] = w[0] * in[i] + w[1] * in[i + length] + w[2] * in[i + 2 * length] +
            w[3] * in[i + 3 * length];
        }
      }
    });
  }
  return result;
}

} // namespace ffd
