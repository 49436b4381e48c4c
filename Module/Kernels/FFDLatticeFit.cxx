// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDLatticeFit.h"

#include "FFDBSplineBasis.h"
#include "FFDBSplineField.h"

#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace ffd
{
namespace
{

constexpr int FirstCells = 4;
/// Weight of second differences on control points that no sample of a grid determines.
constexpr double GridPenalty = 1e-9;
/// Of conjugate gradients.
constexpr int LargestIterations = 200;
constexpr double ResidualReduction = 1e-7;
/// Smoothness below which control points that no landmark determines would be left to rounding.
constexpr double LeastSmoothness = 1e-10;
/// What is left of landmarks is fitted again at most so often, while that leaves less than this
/// part.
constexpr int LargestRounds = 10;
constexpr double RoundGain = 0.7;
/// A level that leaves more than this part of the error of the level before was hardly worth it.
constexpr double LevelGain = 0.98;
/// Singular values of scattered points below this fraction of the largest are directions in which
/// they do not extend.
constexpr double RankTolerance = 1e-9;

double Dot(const glm::dvec3& a, const glm::dvec3& b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

std::size_t CountOf(const glm::ivec3& n)
{
  return static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) *
    static_cast<std::size_t>(n.z);
}

bool Proceeds(const FitLimits& limits, double done)
{
  return !limits.Proceed || limits.Proceed(done);
}

BSplineField FieldOf(const FittedNet& fit)
{
  return BSplineField(fit.Net.Nodes, fit.GetOrigin(), fit.GetSpacing(), fit.Net.Values.data());
}

/// Cell of a coordinate in [0, cells] and the parameter in it.
int CellOf(double t, int cells, double& u)
{
  const int cell = std::min(std::max(static_cast<int>(std::floor(t)), 0), cells - 1);
  u = std::min(std::max(t - cell, 0.0), 1.0);
  return cell;
}

} // namespace

//------------------------------------------------------------------------------
FitStatus FitNetToFunction(
  const DisplacementSampler& sample, const FitLimits& limits, FittedNet& fit)
{
  fit.Cells = glm::ivec3(std::min(FirstCells, limits.MaximumCells));
  for (double done = 0.0;; done = 0.5 * (1.0 + done))
  {
    if (!Proceeds(limits, done))
    {
      return FitStatus::Stopped;
    }
    const glm::dvec3 step = fit.GetSpacing();
    ControlNet samples;
    samples.Nodes = fit.Cells + 1;
    if (!sample(samples.Nodes, fit.Lower, step, samples.Values))
    {
      return FitStatus::NotFinite;
    }
    fit.Net = InterpolateControlNet(samples);
    const BSplineField field = FieldOf(fit);

    // Centres of the edges along each axis, which tell the axis to refine, and of the cells.
    double perAxis[3] = { 0.0, 0.0, 0.0 };
    double squares = 0.0;
    std::size_t tests = 0;
    fit.LargestError = 0.0;
    for (int test = 0; test < 4; ++test)
    {
      glm::dvec3 first = fit.Lower;
      glm::ivec3 count = fit.Cells + 1;
      for (int a = 0; a < 3; ++a)
      {
        if (test == a || test == 3)
        {
          first[a] += 0.5 * step[a];
          --count[a];
        }
      }
      std::vector<glm::dvec3> wanted;
      if (!sample(count, first, step, wanted))
      {
        return FitStatus::NotFinite;
      }
      double largest = 0.0;
      std::size_t id = 0;
      for (int k = 0; k < count.z; ++k)
      {
        for (int j = 0; j < count.y; ++j)
        {
          for (int i = 0; i < count.x; ++i)
          {
            const glm::dvec3 d =
              field.Displacement(first + glm::dvec3(i, j, k) * step) - wanted[id++];
            largest = std::max(largest, Dot(d, d));
            squares += Dot(d, d);
          }
        }
      }
      tests += id;
      fit.LargestError = std::max(fit.LargestError, std::sqrt(largest));
      if (test < 3)
      {
        perAxis[test] = std::sqrt(largest);
      }
    }
    fit.RootMeanSquareError = std::sqrt(squares / static_cast<double>(tests));
    if (fit.LargestError <= limits.Tolerance)
    {
      return FitStatus::Reached;
    }
    // Refine the axes that err by their share; when only the sum is too large, the worst one.
    const double worst = std::max({ perAxis[0], perAxis[1], perAxis[2] });
    bool refined = false;
    for (int a = 0; a < 3; ++a)
    {
      if (perAxis[a] >= std::min(limits.Tolerance / 3.0, worst) &&
        fit.Cells[a] < limits.MaximumCells)
      {
        fit.Cells[a] = std::min(2 * fit.Cells[a], limits.MaximumCells);
        refined = true;
      }
    }
    if (!refined)
    {
      return FitStatus::NotReached;
    }
  }
}

//------------------------------------------------------------------------------
namespace
{

/**
 * Least squares of one axis: coefficients c of `cells` + 3 B-splines from samples at parameters t
 * (in cells), minimizing |B c - f|^2 + penalty |second differences of c|^2. Symmetric, positive
 * definite, seven diagonals: Cholesky within the band.
 */
class AxisFit
{
public:
  AxisFit(const std::vector<double>& t, int cells)
    : Size(static_cast<std::size_t>(cells) + 3)
    , Band(Size * Width, 0.0)
  {
    for (const double parameter : t)
    {
      Row row;
      row.First = static_cast<std::size_t>(CellOf(parameter, cells, row.U));
      BSplineWeights(row.U, row.Weights.data());
      this->Rows.push_back(row);
      for (std::size_t a = 0; a < 4; ++a)
      {
        for (std::size_t b = 0; b <= a; ++b)
        {
          this->Element(row.First + a, row.First + b) += row.Weights[a] * row.Weights[b];
        }
      }
    }
    const double penalty = GridPenalty *
      std::max(1.0, static_cast<double>(t.size()) / static_cast<double>(cells));
    const double difference[3] = { 1.0, -2.0, 1.0 };
    for (std::size_t i = 0; i + 2 < this->Size; ++i)
    {
      for (std::size_t a = 0; a < 3; ++a)
      {
        for (std::size_t b = 0; b <= a; ++b)
        {
          this->Element(i + a, i + b) += penalty * difference[a] * difference[b];
        }
      }
    }
    // Cholesky, in place.
    for (std::size_t i = 0; i < this->Size; ++i)
    {
      const std::size_t first = i >= Width - 1 ? i - (Width - 1) : 0;
      for (std::size_t j = first; j <= i; ++j)
      {
        double sum = this->Element(i, j);
        for (std::size_t k = std::max(first, j >= Width - 1 ? j - (Width - 1) : 0); k < j; ++k)
        {
          sum -= this->Element(i, k) * this->Element(j, k);
        }
        this->Element(i, j) =
          i == j ? std::sqrt(std::max(sum, 1e-300)) : sum / this->Element(j, j);
      }
    }
  }

  std::size_t GetSize() const { return this->Size; }

  /// c from f; `stride` between the elements of either.
  void Solve(const glm::dvec3* f, glm::dvec3* c, std::size_t inStride, std::size_t outStride)
  {
    this->Right.assign(this->Size, glm::dvec3(0.0));
    for (std::size_t r = 0; r < this->Rows.size(); ++r)
    {
      for (std::size_t a = 0; a < 4; ++a)
      {
        this->Right[this->Rows[r].First + a] += this->Rows[r].Weights[a] * f[r * inStride];
      }
    }
    for (std::size_t i = 0; i < this->Size; ++i)
    {
      for (std::size_t k = i >= Width - 1 ? i - (Width - 1) : 0; k < i; ++k)
      {
        this->Right[i] -= this->Element(i, k) * this->Right[k];
      }
      this->Right[i] /= this->Element(i, i);
    }
    for (std::size_t i = this->Size; i-- > 0;)
    {
      for (std::size_t k = i + 1; k < std::min(this->Size, i + Width); ++k)
      {
        this->Right[i] -= this->Element(k, i) * this->Right[k];
      }
      this->Right[i] /= this->Element(i, i);
      c[i * outStride] = this->Right[i];
    }
  }

  /// The fitted values at the samples.
  void Evaluate(
    const glm::dvec3* c, glm::dvec3* f, std::size_t inStride, std::size_t outStride) const
  {
    for (std::size_t r = 0; r < this->Rows.size(); ++r)
    {
      glm::dvec3 sum(0.0);
      for (std::size_t a = 0; a < 4; ++a)
      {
        sum += this->Rows[r].Weights[a] * c[(this->Rows[r].First + a) * inStride];
      }
      f[r * outStride] = sum;
    }
  }

private:
  static constexpr std::size_t Width = 4; // the diagonal and three below it
  struct Row
  {
    std::size_t First = 0;
    double U = 0.0;
    std::array<double, 4> Weights{};
  };
  double& Element(std::size_t i, std::size_t j) { return this->Band[i * Width + (i - j)]; }

  std::size_t Size;
  std::vector<double> Band;
  std::vector<Row> Rows;
  std::vector<glm::dvec3> Right;
};

/// line(in, inStride, out, outStride) for every line of `axis` of an array of `nodes` values.
template <typename Line>
std::vector<glm::dvec3> MapLines(const std::vector<glm::dvec3>& in, glm::ivec3& nodes, int axis,
  std::size_t size, const Line& line)
{
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a)
  {
    stride *= static_cast<std::size_t>(nodes[a]);
  }
  const std::size_t before = static_cast<std::size_t>(nodes[axis]);
  const std::size_t outer = in.size() / (stride * before);
  std::vector<glm::dvec3> out(outer * stride * size);
  for (std::size_t o = 0; o < outer; ++o)
  {
    for (std::size_t s = 0; s < stride; ++s)
    {
      line(&in[o * before * stride + s], stride, &out[o * size * stride + s], stride);
    }
  }
  nodes[axis] = static_cast<int>(size);
  return out;
}

} // namespace

//------------------------------------------------------------------------------
FitStatus FitNetToGrid(const glm::ivec3& count, const glm::dvec3& first, const glm::dvec3& step,
  const std::vector<glm::dvec3>& displacements, const FitLimits& limits, FittedNet& fit)
{
  // The samples in the box, per axis.
  glm::ivec3 begin(0);
  glm::ivec3 inside(0);
  for (int a = 0; a < 3; ++a)
  {
    const double slack = 1e-9 * fit.Extent[a];
    for (int i = 0; i < count[a]; ++i)
    {
      const double x = first[a] + i * step[a] - fit.Lower[a];
      if (x >= -slack && x <= fit.Extent[a] + slack)
      {
        begin[a] = inside[a] == 0 ? i : begin[a];
        ++inside[a];
      }
    }
    if (inside[a] == 0)
    {
      return FitStatus::NotFinite;
    }
  }
  std::vector<glm::dvec3> samples;
  samples.reserve(CountOf(inside));
  for (int k = 0; k < inside.z; ++k)
  {
    for (int j = 0; j < inside.y; ++j)
    {
      for (int i = 0; i < inside.x; ++i)
      {
        const glm::ivec3 at = begin + glm::ivec3(i, j, k);
        const glm::dvec3& d = displacements[static_cast<std::size_t>(at.x) +
          static_cast<std::size_t>(count.x) *
            (static_cast<std::size_t>(at.y) +
              static_cast<std::size_t>(count.y) * static_cast<std::size_t>(at.z))];
        if (!std::isfinite(d.x) || !std::isfinite(d.y) || !std::isfinite(d.z))
        {
          return FitStatus::NotFinite;
        }
        samples.push_back(d);
      }
    }
  }
  // Finer than the samples a net only follows its own smoothness.
  glm::ivec3 most;
  for (int a = 0; a < 3; ++a)
  {
    most[a] = std::min(limits.MaximumCells, std::max(1, inside[a] - 1));
  }
  fit.Cells = glm::min(glm::ivec3(FirstCells), most);
  for (double done = 0.0;; done = 0.5 * (1.0 + done))
  {
    std::vector<glm::dvec3> values = samples;
    glm::ivec3 nodes = inside;
    std::vector<AxisFit> axes;
    for (int a = 0; a < 3; ++a)
    {
      std::vector<double> t;
      for (int i = 0; i < inside[a]; ++i)
      {
        t.push_back(
          (first[a] + (begin[a] + i) * step[a] - fit.Lower[a]) / fit.GetSpacing()[a]);
      }
      axes.emplace_back(t, fit.Cells[a]);
    }
    for (int a = 0; a < 3; ++a)
    {
      if (!Proceeds(limits, done + 0.5 * (1.0 - done) * a / 3.0))
      {
        return FitStatus::Stopped;
      }
      AxisFit& axis = axes[static_cast<std::size_t>(a)];
      values = MapLines(values, nodes, a, axis.GetSize(),
        [&axis](const glm::dvec3* in, std::size_t inStride, glm::dvec3* out, std::size_t outStride)
        { axis.Solve(in, out, inStride, outStride); });
    }
    fit.Net.Nodes = nodes;
    fit.Net.Values = values;
    for (int a = 0; a < 3; ++a)
    {
      const AxisFit& axis = axes[static_cast<std::size_t>(a)];
      values = MapLines(values, nodes, a, static_cast<std::size_t>(inside[a]),
        [&axis](const glm::dvec3* in, std::size_t inStride, glm::dvec3* out, std::size_t outStride)
        { axis.Evaluate(in, out, inStride, outStride); });
    }
    double largest = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i)
    {
      const glm::dvec3 d = values[i] - samples[i];
      largest = std::max(largest, Dot(d, d));
      squares += Dot(d, d);
    }
    fit.LargestError = std::sqrt(largest);
    fit.RootMeanSquareError = std::sqrt(squares / static_cast<double>(samples.size()));
    if (fit.LargestError <= limits.Tolerance)
    {
      return FitStatus::Reached;
    }
    const glm::ivec3 finer = glm::min(2 * fit.Cells, most);
    if (finer == fit.Cells)
    {
      return FitStatus::NotReached;
    }
    fit.Cells = finer;
  }
}

//------------------------------------------------------------------------------
namespace
{

/// Eigenvalues (descending) and unit eigenvectors (columns) of a symmetric matrix: Jacobi's method.
void SymmetricEigen(glm::dmat3 m, glm::dvec3& values, glm::dmat3& vectors)
{
  vectors = glm::dmat3(1.0);
  for (int sweep = 0; sweep < 32; ++sweep)
  {
    for (int p = 0; p < 2; ++p)
    {
      for (int q = p + 1; q < 3; ++q)
      {
        if (m[p][q] == 0.0)
        {
          continue;
        }
        const double theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
        const double t =
          (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0);
        const double s = t * c;
        glm::dmat3 rotation(1.0);
        rotation[p][p] = c;
        rotation[q][q] = c;
        rotation[q][p] = s; // column q, row p
        rotation[p][q] = -s;
        glm::dmat3 transposed(rotation);
        std::swap(transposed[q][p], transposed[p][q]);
        m = transposed * m * rotation;
        m[p][q] = m[q][p] = 0.0;
        vectors = vectors * rotation;
      }
    }
  }
  values = { m[0][0], m[1][1], m[2][2] };
}

/// The affine displacement of least squares, smallest where the points do not determine it.
void AffineFit(const std::vector<glm::dvec3>& points, const std::vector<glm::dvec3>& displacements,
  const std::vector<double>& weights, glm::dmat3& matrix, glm::dvec3& offset)
{
  double sum = 0.0;
  glm::dvec3 center(0.0);
  glm::dvec3 mean(0.0);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    sum += weights[i];
    center += weights[i] * points[i];
    mean += weights[i] * displacements[i];
  }
  center /= sum;
  mean /= sum;
  glm::dmat3 moments(0.0);
  glm::dmat3 products(0.0); // column a: sum of displacement times coordinate a
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const glm::dvec3 x = points[i] - center;
    const glm::dvec3 d = displacements[i] - mean;
    for (int a = 0; a < 3; ++a)
    {
      moments[a] += weights[i] * x[a] * x;
      products[a] += weights[i] * x[a] * d;
    }
  }
  glm::dvec3 values;
  glm::dmat3 vectors;
  SymmetricEigen(moments, values, vectors);
  const double largest = std::max({ values.x, values.y, values.z });
  glm::dmat3 inverse(0.0);
  for (int e = 0; e < 3; ++e)
  {
    // Squared extents, so the tolerance is squared, too.
    if (values[e] > RankTolerance * RankTolerance * largest && values[e] > 0.0)
    {
      for (int a = 0; a < 3; ++a)
      {
        inverse[a] += vectors[e][a] / values[e] * vectors[e];
      }
    }
  }
  matrix = products * inverse;
  offset = mean - matrix * center;
}

/// The quadratic form of FitNetToPoints at one level, for conjugate gradients.
class PointSystem
{
public:
  PointSystem(const std::vector<glm::dvec3>& points, const std::vector<double>& weights,
    const FittedNet& fit, double smoothness)
    : Nodes(fit.Cells + 3)
    , Weights(weights)
  {
    double sum = 0.0;
    for (const double weight : weights)
    {
      sum += weight;
    }
    this->WeightScale = 1.0 / sum;
    const glm::dvec3 h = fit.GetSpacing();
    // As the lattice will be evaluated, outside of its domain, too.
    const BSplineField field = FieldOf(fit);
    for (const glm::dvec3& point : points)
    {
      Row row;
      row.Count =
        static_cast<std::size_t>(field.ControlWeights(point, row.Nodes.data(), row.Basis.data()));
      this->Rows.push_back(row);
    }
    // Second derivatives as differences of control points, integrated by the cells' volume.
    const double longest = std::max({ fit.Extent.x, fit.Extent.y, fit.Extent.z });
    const double volume = fit.Extent.x * fit.Extent.y * fit.Extent.z;
    const double scale =
      smoothness * longest * longest * longest * longest / volume * h.x * h.y * h.z;
    for (int a = 0; a < 3; ++a)
    {
      this->Second[a] = scale / (h[a] * h[a] * h[a] * h[a]);
      const int b = (a + 1) % 3;
      this->Mixed[a] = 2.0 * scale / (h[a] * h[a] * h[b] * h[b]);
    }
    this->Diagonal.assign(CountOf(this->Nodes), 0.0);
    this->ForRows(
      [this](std::size_t r, std::size_t id, double weight)
      { this->Diagonal[id] += this->Weights[r] * this->WeightScale * weight * weight; });
    this->ForDifferences(
      [this](double factor, std::size_t id, const auto& offsets, const auto& coefficients) {
        for (std::size_t n = 0; n < offsets.size(); ++n)
        {
          this->Diagonal[id + offsets[n]] += factor * coefficients[n] * coefficients[n];
        }
      });
  }

  std::size_t GetSize() const { return this->Diagonal.size(); }
  const std::vector<double>& GetDiagonal() const { return this->Diagonal; }

  /// Values of the net at the points.
  void Evaluate(const std::vector<glm::dvec3>& net, std::vector<glm::dvec3>& values) const
  {
    values.assign(this->Rows.size(), glm::dvec3(0.0));
    this->ForRows([&](std::size_t r, std::size_t id, double weight)
      { values[r] += weight * net[id]; });
  }

  /// B^T W values.
  void Gather(const std::vector<glm::dvec3>& values, std::vector<glm::dvec3>& net) const
  {
    net.assign(this->GetSize(), glm::dvec3(0.0));
    this->ForRows([&](std::size_t r, std::size_t id, double weight)
      { net[id] += this->Weights[r] * this->WeightScale * weight * values[r]; });
  }

  /// The whole matrix.
  void Apply(const std::vector<glm::dvec3>& net, std::vector<glm::dvec3>& result) const
  {
    std::vector<glm::dvec3> values;
    this->Evaluate(net, values);
    this->Gather(values, result);
    this->ForDifferences(
      [&](double factor, std::size_t id, const auto& offsets, const auto& coefficients) {
        glm::dvec3 difference(0.0);
        for (std::size_t n = 0; n < offsets.size(); ++n)
        {
          difference += coefficients[n] * net[id + offsets[n]];
        }
        difference *= factor;
        for (std::size_t n = 0; n < offsets.size(); ++n)
        {
          result[id + offsets[n]] += coefficients[n] * difference;
        }
      });
  }

private:
  struct Row
  {
    std::size_t Count = 0;
    std::array<std::size_t, BSplineField::MaximumSupport> Nodes;
    std::array<double, BSplineField::MaximumSupport> Basis;
  };

  std::size_t Index(int i, int j, int k) const
  {
    return static_cast<std::size_t>(i) +
      static_cast<std::size_t>(this->Nodes.x) *
      (static_cast<std::size_t>(j) +
        static_cast<std::size_t>(this->Nodes.y) * static_cast<std::size_t>(k));
  }

  template <typename Visit>
  void ForRows(const Visit& visit) const
  {
    for (std::size_t r = 0; r < this->Rows.size(); ++r)
    {
      const Row& row = this->Rows[r];
      for (std::size_t n = 0; n < row.Count; ++n)
      {
        visit(r, row.Nodes[n], row.Basis[n]);
      }
    }
  }

  /// visit(factor, id, offsets, coefficients) for each place of a difference that spans `reach`.
  template <std::size_t Count, typename Visit>
  void ForDifference(double factor, const glm::ivec3& reach,
    const std::array<std::size_t, Count>& offsets, const std::array<double, Count>& coefficients,
    const Visit& visit) const
  {
    const glm::ivec3 end = this->Nodes - reach;
    for (int k = 0; k < end.z; ++k)
    {
      for (int j = 0; j < end.y; ++j)
      {
        const std::size_t first = this->Index(0, j, k);
        for (std::size_t i = 0; i < static_cast<std::size_t>(end.x); ++i)
        {
          visit(factor, first + i, offsets, coefficients);
        }
      }
    }
  }

  /// The differences that stand for the second derivatives.
  template <typename Visit>
  void ForDifferences(const Visit& visit) const
  {
    const std::size_t strides[3] = { 1, static_cast<std::size_t>(this->Nodes.x),
      static_cast<std::size_t>(this->Nodes.x) * static_cast<std::size_t>(this->Nodes.y) };
    for (int a = 0; a < 3; ++a)
    {
      const int b = (a + 1) % 3;
      glm::ivec3 reach(0);
      reach[a] = 2;
      this->ForDifference<3>(this->Second[a], reach, { { 0, strides[a], 2 * strides[a] } },
        { { 1.0, -2.0, 1.0 } }, visit);
      reach[a] = reach[b] = 1;
      this->ForDifference<4>(this->Mixed[a], reach,
        { { 0, strides[a], strides[b], strides[a] + strides[b] } }, { { 1.0, -1.0, -1.0, 1.0 } },
        visit);
    }
  }

  glm::ivec3 Nodes;
  const std::vector<double>& Weights;
  double WeightScale = 1.0;
  std::vector<Row> Rows;
  glm::dvec3 Second{ 0.0 };
  glm::dvec3 Mixed{ 0.0 };
  std::vector<double> Diagonal;
};

/**
 * Preconditioned conjugate gradients for the three components at once, from `net`: it becomes the
 * net of least squares of `values` and bending energy, or one nearer to that. False: stopped.
 */
bool SolvePoints(const PointSystem& system, const std::vector<glm::dvec3>& values,
  const FitLimits& limits, double done, std::vector<glm::dvec3>& net)
{
  const std::size_t n = system.GetSize();
  const std::vector<double>& diagonal = system.GetDiagonal();
  std::vector<glm::dvec3> residual;
  system.Gather(values, residual);
  std::vector<glm::dvec3> z(n);
  std::vector<glm::dvec3> direction(n);
  std::vector<glm::dvec3> image;
  glm::dvec3 rho(0.0);
  const auto precondition = [&]
  {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < n; ++i)
    {
      z[i] = diagonal[i] > 0.0 ? residual[i] / diagonal[i] : glm::dvec3(0.0);
      sum += z[i] * residual[i];
    }
    return sum;
  };
  // As small as rounding lets the residual of the whole right-hand side become.
  const glm::dvec3 target = ResidualReduction * ResidualReduction * precondition();
  system.Apply(net, image);
  for (std::size_t i = 0; i < n; ++i)
  {
    residual[i] -= image[i];
  }
  rho = precondition();
  direction = z;
  for (int iteration = 0; iteration < LargestIterations; ++iteration)
  {
    if (!(rho.x > target.x || rho.y > target.y || rho.z > target.z))
    {
      break;
    }
    if (!Proceeds(limits, done))
    {
      return false;
    }
    system.Apply(direction, image);
    glm::dvec3 curvature(0.0);
    for (std::size_t i = 0; i < n; ++i)
    {
      curvature += direction[i] * image[i];
    }
    glm::dvec3 length(0.0);
    for (int a = 0; a < 3; ++a)
    {
      length[a] = rho[a] > target[a] && curvature[a] > 0.0 ? rho[a] / curvature[a] : 0.0;
    }
    for (std::size_t i = 0; i < n; ++i)
    {
      net[i] += length * direction[i];
      residual[i] -= length * image[i];
    }
    const glm::dvec3 next = precondition();
    glm::dvec3 beta(0.0);
    for (int a = 0; a < 3; ++a)
    {
      beta[a] = rho[a] > 0.0 ? next[a] / rho[a] : 0.0;
    }
    for (std::size_t i = 0; i < n; ++i)
    {
      direction[i] = z[i] + beta * direction[i];
    }
    rho = next;
  }
  return true;
}

} // namespace

//------------------------------------------------------------------------------
FitStatus FitNetToPoints(const std::vector<glm::dvec3>& points,
  const std::vector<glm::dvec3>& displacements, const std::vector<double>& weights,
  double smoothness, const FitLimits& limits, FittedNet& fit)
{
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      if (!std::isfinite(points[i][a]) || !std::isfinite(displacements[i][a]))
      {
        return FitStatus::NotFinite;
      }
    }
  }
  const std::vector<double> used =
    weights.empty() ? std::vector<double>(points.size(), 1.0) : weights;
  std::vector<glm::dvec3> residual(points.size());
  // The errors of a net as the lattice will be evaluated; whether they are small enough.
  const auto measure = [&](FittedNet& net) {
    const BSplineField field = FieldOf(net);
    double largest = 0.0;
    double squares = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      residual[i] = displacements[i] - field.Displacement(points[i]);
      largest = std::max(largest, Dot(residual[i], residual[i]));
      squares += used[i] * Dot(residual[i], residual[i]);
      sum += used[i];
    }
    net.LargestError = std::sqrt(largest);
    net.RootMeanSquareError = std::sqrt(squares / sum);
    return net.LargestError <= limits.Tolerance;
  };

  // Level 0: the affine map, as a net of one cell (B-splines have linear precision).
  glm::dmat3 matrix(0.0);
  glm::dvec3 offset(0.0);
  AffineFit(points, displacements, used, matrix, offset);
  fit.Cells = glm::ivec3(1);
  fit.Net.Nodes = glm::ivec3(4);
  fit.Net.Values.clear();
  for (int k = 0; k < 4; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      for (int i = 0; i < 4; ++i)
      {
        fit.Net.Values.push_back(
          matrix * (fit.GetOrigin() + glm::dvec3(i, j, k) * fit.GetSpacing()) + offset);
      }
    }
  }
  if (measure(fit))
  {
    return FitStatus::Reached;
  }
  const double weight = std::max(smoothness, LeastSmoothness);
  FittedNet level = fit;
  int futile = 0; // levels in a row that were hardly better
  for (double done = 0.0;; done = 0.5 * (1.0 + done))
  {
    const double before = fit.RootMeanSquareError;
    const PointSystem system(points, used, level, weight);
    // What is left is asked for again (iterated Tikhonov regularization): that undoes what the
    // bending energy takes off consistent landmarks, and soon ends where they contradict each
    // other.
    std::vector<glm::dvec3> aims = displacements;
    for (int round = 0; round < LargestRounds; ++round)
    {
      if (!SolvePoints(system, aims, limits, done, level.Net.Values))
      {
        return FitStatus::Stopped;
      }
      const double last = round == 0 ? HUGE_VAL : level.RootMeanSquareError;
      const bool reached = measure(level);
      if (level.RootMeanSquareError < fit.RootMeanSquareError)
      {
        fit = level;
      }
      if (reached)
      {
        // The smoothest net within the tolerance (discrepancy principle).
        for (double stiffer = 10.0 * weight; round == 0 && stiffer <= 1.0; stiffer *= 10.0)
        {
          const PointSystem stiff(points, used, level, stiffer);
          if (!SolvePoints(stiff, displacements, limits, done, level.Net.Values))
          {
            return FitStatus::Stopped;
          }
          if (!measure(level))
          {
            break;
          }
          fit = level;
        }
        return FitStatus::Reached;
      }
      if (!(level.RootMeanSquareError < RoundGain * last))
      {
        break;
      }
      for (std::size_t i = 0; i < aims.size(); ++i)
      {
        aims[i] += residual[i];
      }
    }
    const bool gained = fit.RootMeanSquareError < LevelGain * before;
    futile = gained || system.GetSize() < points.size() ? 0 : futile + 1;
    if (2 * level.Cells.x > limits.MaximumCells || futile == 2)
    {
      return FitStatus::NotReached;
    }
    level.Net = RefineControlNet(level.Net, glm::ivec3(2));
    level.Cells *= 2;
  }
}

} // namespace ffd
