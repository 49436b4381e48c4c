// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDLatticeFit.h"

#include "FFDBSplineBasis.h"
#include "FFDBSplineField.h"
#include "FFDGridIndex.h"
#include "FFDLinearOperator.h"
#include "FFDParallelFor.h"

#include <Eigen/Dense>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <unsupported/Eigen/KroneckerProduct>

#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

namespace ffd
{
namespace
{

constexpr int FirstCells = 4;
/// Weight of second differences on control points that no sample of a grid determines.
constexpr double GridPenalty = 1e-9;
/// Samples of a grid that are all nearer to each other along an axis lie in one place, cells.
constexpr double LeastExtent = 1e-6;
/// The largest number of iterations of conjugate gradients.
constexpr int LargestIterations = 200;
/// Landmark systems of at most so many cells are factorized.
constexpr int DirectCells = 8;
constexpr double ResidualReduction = 1e-7;
/// Smoothness below which control points that no landmark determines would be left to rounding.
constexpr double LeastSmoothness = 1e-10;
/// The residuals of landmarks are fitted again at most so often, while each round leaves less than
/// this part of them.
constexpr int LargestRounds = 10;
constexpr double RoundGain = 0.7;
/// A level that leaves more than this part of the error of the level before was hardly worth it.
constexpr double LevelGain = 0.98;
/// Singular values of scattered points below this fraction of the largest are directions in which
/// they extend too little to tell a gradient.
constexpr double RankTolerance = 0.1;
/// Weight of gradients beside that of second derivatives: small enough for a field within the box
/// to be one of least bending.
constexpr double GradientWeight = 0.1;

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

double Dot(const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

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
namespace
{

/**
 * Least squares of one axis: coefficients c of `cells` + 3 B-splines from samples at parameters t
 * (in cells), minimizing |B c - f|^2 + penalty |second differences of c|^2; where all samples lie
 * in one place, which says nothing about slopes, first differences, too. The matrix is symmetric
 * and positive definite and has seven diagonals, so that Cholesky's method stays within the band.
 * Eigen has no solver for bands; its sparse one takes two to three times as long, because it looks
 * up the row of each element.
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
    const double penalty =
      GridPenalty * std::max(1.0, static_cast<double>(t.size()) / static_cast<double>(cells));
    this->Penalize({ 1.0, -2.0, 1.0 }, penalty);
    const auto [least, largest] = std::minmax_element(t.begin(), t.end());
    if (t.empty() || *largest - *least < LeastExtent)
    {
      this->Penalize({ -1.0, 1.0 }, penalty);
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
        this->Element(i, j) = i == j ? std::sqrt(std::max(sum, 1e-300)) : sum / this->Element(j, j);
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

  /// Adds `penalty` times the squares of differences of neighboring coefficients.
  void Penalize(const std::vector<double>& difference, double penalty)
  {
    for (std::size_t i = 0; i + difference.size() <= this->Size; ++i)
    {
      for (std::size_t a = 0; a < difference.size(); ++a)
      {
        for (std::size_t b = 0; b <= a; ++b)
        {
          this->Element(i + a, i + b) += penalty * difference[a] * difference[b];
        }
      }
    }
  }

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
  samples.reserve(GridSize(inside));
  for (int k = 0; k < inside.z; ++k)
  {
    for (int j = 0; j < inside.y; ++j)
    {
      for (int i = 0; i < inside.x; ++i)
      {
        const glm::ivec3 at = begin + glm::ivec3(i, j, k);
        const glm::dvec3& d = displacements[GridIndex(at, count)];
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
        t.push_back((first[a] + (begin[a] + i) * step[a] - fit.Lower[a]) / fit.GetSpacing()[a]);
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
        [&axis](const glm::dvec3* in, std::size_t inStride, glm::dvec3* out,
          std::size_t outStride) { axis.Solve(in, out, inStride, outStride); });
    }
    fit.Net.Nodes = nodes;
    fit.Net.Values = values;
    for (int a = 0; a < 3; ++a)
    {
      const AxisFit& axis = axes[static_cast<std::size_t>(a)];
      values = MapLines(values, nodes, a, static_cast<std::size_t>(inside[a]),
        [&axis](const glm::dvec3* in, std::size_t inStride, glm::dvec3* out,
          std::size_t outStride) { axis.Evaluate(in, out, inStride, outStride); });
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

/// Vectors as rows: as a std::vector<glm::dvec3> holds them.
using Vectors = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

Eigen::Map<const Vectors> AsRows(const std::vector<glm::dvec3>& values)
{
  return { &values[0].x, static_cast<Eigen::Index>(values.size()), 3 };
}

/// RefineControlNet from `nodes` control points of one axis to twice the cells, as a matrix.
SparseMatrix AxisRefinement(int nodes)
{
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < 2 * nodes - 3; ++i)
  {
    // Those with odd numbers rest at a coarse control point, the others between two.
    const int first = i / 2;
    const bool between = i % 2 == 0;
    entries.emplace_back(i, first, between ? 0.5 : 0.125);
    entries.emplace_back(i, first + 1, between ? 0.5 : 0.75);
    if (!between)
    {
      entries.emplace_back(i, first + 2, 0.125);
    }
  }
  SparseMatrix matrix(2 * nodes - 3, nodes);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// The affine displacement of least squares, smallest where the points hardly determine it.
void AffineFit(const std::vector<glm::dvec3>& points, const std::vector<glm::dvec3>& displacements,
  const std::vector<double>& weights, glm::dmat3& matrix, glm::dvec3& offset)
{
  const Eigen::Map<const Eigen::VectorXd> w(
    weights.data(), static_cast<Eigen::Index>(weights.size()));
  const Eigen::RowVector3d center = w.transpose() * AsRows(points) / w.sum();
  const Eigen::RowVector3d mean = w.transpose() * AsRows(displacements) / w.sum();
  const auto root = w.cwiseSqrt().asDiagonal();
  Eigen::JacobiSVD<Eigen::MatrixXd> solver(
    root * (AsRows(points).rowwise() - center), Eigen::ComputeThinU | Eigen::ComputeThinV);
  solver.setThreshold(RankTolerance);
  // Row a: displacement for each coordinate a.
  const Eigen::Matrix3d linear = solver.solve(root * (AsRows(displacements).rowwise() - mean));
  const Eigen::RowVector3d constant = mean - center * linear;
  for (int a = 0; a < 3; ++a)
  {
    matrix[a] = { linear(a, 0), linear(a, 1), linear(a, 2) };
    offset[a] = constant[a];
  }
}

/// The net of an affine displacement (B-splines have linear precision).
std::vector<glm::dvec3> AffineNet(
  const FittedNet& fit, const glm::dmat3& matrix, const glm::dvec3& offset)
{
  std::vector<glm::dvec3> values;
  for (int k = 0; k < fit.Cells.z + 3; ++k)
  {
    for (int j = 0; j < fit.Cells.y + 3; ++j)
    {
      for (int i = 0; i < fit.Cells.x + 3; ++i)
      {
        values.push_back(
          matrix * (fit.GetOrigin() + glm::dvec3(i, j, k) * fit.GetSpacing()) + offset);
      }
    }
  }
  return values;
}

/**
 * The least-squares problem of FitNetToPoints at one level: rows of the B-splines at the points,
 * and of the differences that stand for the first and second derivatives, each times the root of
 * its weight. With it come the systems of half as many cells each, which precondition it.
 */
class PointSystem
{
public:
  PointSystem(const std::vector<glm::dvec3>& points, const std::vector<double>& weights,
    const FittedNet& fit, double smoothness, const ParallelFor& parallel)
    : Nodes(fit.Cells + 3)
    , Parallel(parallel)
    , Roots(Eigen::Map<const Eigen::VectorXd>(
        weights.data(), static_cast<Eigen::Index>(weights.size())))
  {
    this->Roots = (this->Roots / this->Roots.sum()).cwiseSqrt().eval();
    const glm::dvec3 h = fit.GetSpacing();
    // Derivatives as differences of control points, integrated by the cells' volume.
    const double longest = std::max({ fit.Extent.x, fit.Extent.y, fit.Extent.z });
    const double volume = fit.Extent.x * fit.Extent.y * fit.Extent.z;
    const double scale =
      smoothness * longest * longest * longest * longest / volume * h.x * h.y * h.z;
    // As the lattice will be evaluated, outside of its domain, too.
    const BSplineField field = FieldOf(fit);
    const auto count = static_cast<Eigen::Index>(points.size());
    const auto size = static_cast<Eigen::Index>(GridSize(this->Nodes));
    std::vector<Eigen::Triplet<double>> entries;
    int row = 0;
    for (const glm::dvec3& point : points)
    {
      std::array<std::size_t, BSplineField::MaximumSupport> nodes;
      std::array<double, BSplineField::MaximumSupport> basis;
      const int support = field.ControlWeights(point, nodes.data(), basis.data());
      for (std::size_t n = 0; n < static_cast<std::size_t>(support); ++n)
      {
        entries.emplace_back(row, static_cast<int>(nodes[n]), this->Roots[row] * basis[n]);
      }
      ++row;
    }
    this->Basis.resize(count, size);
    this->Basis.setFromTriplets(entries.begin(), entries.end());
    entries.clear();
    row = 0;
    for (int a = 0; a < 3; ++a)
    {
      const int b = (a + 1) % 3;
      glm::ivec3 alongA(0);
      glm::ivec3 alongB(0);
      alongA[a] = 1;
      alongB[b] = 1;
      const double first = std::sqrt(GradientWeight * scale) / (longest * h[a]);
      row = this->AddDifferences({ { 0 * alongA, -first }, { alongA, first } }, row, entries);
      const double second = std::sqrt(scale) / (h[a] * h[a]);
      const double mixed = std::sqrt(2.0 * scale) / (h[a] * h[b]);
      row = this->AddDifferences(
        { { 0 * alongA, second }, { alongA, -2.0 * second }, { 2 * alongA, second } }, row,
        entries);
      row = this->AddDifferences({ { 0 * alongA, mixed }, { alongA, -mixed }, { alongB, -mixed },
                                   { alongA + alongB, mixed } },
        row, entries);
    }
    SparseMatrix differences(row, size);
    differences.setFromTriplets(entries.begin(), entries.end());
    this->Energy = differences.transpose() * differences;
    this->Diagonal = this->Energy.diagonal();
    this->Diagonal += this->Basis.cwiseAbs2().transpose() * Eigen::VectorXd::Ones(count);
    if (fit.Cells.x <= DirectCells)
    {
      SparseMatrix normal = this->Basis.transpose() * this->Basis;
      normal += this->Energy;
      this->Direct.compute(normal);
    }
    else
    {
      FittedNet coarser = fit;
      coarser.Cells /= 2;
      coarser.Net.Nodes = coarser.Cells + 3;
      const SparseMatrix plane = Eigen::kroneckerProduct(
        AxisRefinement(coarser.Net.Nodes.y), AxisRefinement(coarser.Net.Nodes.x));
      this->Refinement = Eigen::kroneckerProduct(AxisRefinement(coarser.Net.Nodes.z), plane);
      this->Restriction = this->Refinement.transpose();
      this->Coarser = std::make_unique<PointSystem>(points, weights, coarser, smoothness, parallel);
    }
  }

  Eigen::Index GetSize() const { return this->Diagonal.size(); }

  /// The right-hand side of the normal equations for these values at the points and the energy of
  /// what departs from that net.
  Vectors Project(const std::vector<glm::dvec3>& values, const std::vector<glm::dvec3>& net) const
  {
    Vectors result = this->Multiply(this->Energy, AsRows(net));
    result += this->Basis.transpose() * (this->Roots.asDiagonal() * AsRows(values));
    return result;
  }

  /// The matrix of the normal equations times three columns.
  Vectors Apply(const Eigen::Ref<const Vectors>& columns) const
  {
    Vectors result = this->Multiply(this->Energy, columns);
    const Vectors values = this->Basis * columns;
    result += this->Basis.transpose() * values;
    return result;
  }

  /**
   * An approximate inverse of the normal equations times three columns: the inverse of the diagonal
   * at each level, and of the whole matrix at the coarsest, added up over the levels (multilevel
   * diagonal scaling: Bramble, Pasciak and Xu 1990; Zhang 1992). With the diagonal of the finest
   * level alone the number of iterations would grow as the square of the number of cells.
   */
  Vectors Precondition(const Eigen::Ref<const Vectors>& columns) const
  {
    if (!this->Coarser)
    {
      return this->Direct.solve(columns);
    }
    const Vectors coarse = this->Multiply(this->Restriction, columns);
    Vectors result = this->Multiply(this->Refinement, this->Coarser->Precondition(coarse));
    result += this->Diagonal.cwiseInverse().asDiagonal() * columns;
    return result;
  }

private:
  /// A matrix times three columns, its rows split over threads.
  Vectors Multiply(const SparseMatrix& matrix, const Eigen::Ref<const Vectors>& columns) const
  {
    Vectors result(matrix.rows(), 3);
    const auto size = static_cast<std::size_t>(matrix.rows());
    this->Parallel(size, [&](std::size_t first, std::size_t last) {
      const auto begin = static_cast<Eigen::Index>(first);
      const auto end = static_cast<Eigen::Index>(last);
      for (Eigen::Index row = begin; row < end; ++row)
      {
        Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
        for (SparseMatrix::InnerIterator element(matrix, row); element; ++element)
        {
          sum += element.value() * columns.row(element.col());
        }
        result.row(row) = sum;
      }
    });
    return result;
  }

  /// One row for each place of a difference: factors of control points beside that place.
  int AddDifferences(const std::vector<std::pair<glm::ivec3, double>>& terms, int row,
    std::vector<Eigen::Triplet<double>>& entries) const
  {
    const glm::ivec3 end = this->Nodes - terms.back().first;
    for (int k = 0; k < end.z; ++k)
    {
      for (int j = 0; j < end.y; ++j)
      {
        for (int i = 0; i < end.x; ++i, ++row)
        {
          for (const auto& term : terms)
          {
            const std::size_t node = GridIndex(glm::ivec3(i, j, k) + term.first, this->Nodes);
            entries.emplace_back(row, static_cast<int>(node), term.second);
          }
        }
      }
    }
    return row;
  }

  glm::ivec3 Nodes;
  ParallelFor Parallel;
  Eigen::VectorXd Roots;    // of the weights of the points
  SparseMatrix Basis;       // a row for each point, times its root
  SparseMatrix Energy;      // that of derivatives is net^T Energy net
  Eigen::VectorXd Diagonal; // of the normal equations
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> Direct; // at most DirectCells
  // More cells:
  std::unique_ptr<PointSystem> Coarser; // half as many
  SparseMatrix Refinement;              // from the control points of Coarser to these
  SparseMatrix Restriction;             // its transpose
};

/// Thrown out of a solution that the caller of the fit stops.
struct SolutionStopped
{
};

/**
 * Conjugate gradients from `net`: it becomes the net of least squares of `values` and of the energy
 * of what departs from the net `affine`, or one nearer to that. False: stopped.
 */
bool SolvePoints(const PointSystem& system, const std::vector<glm::dvec3>& values,
  const std::vector<glm::dvec3>& affine, const FitLimits& limits, double done,
  std::vector<glm::dvec3>& net)
{
  // All three components at once, as one long vector.
  using Vector = Eigen::VectorXd;
  const Eigen::Index rows = system.GetSize();
  const auto asRows = [rows](auto& vector) { return Eigen::Map<Vectors>(vector.data(), rows, 3); };
  const LinearOperator normalEquations(3 * rows, [&](const Vector& x) -> Vector {
    if (!Proceeds(limits, done))
    {
      throw SolutionStopped();
    }
    Vector result(x.size());
    asRows(result) = system.Apply(Eigen::Map<const Vectors>(x.data(), rows, 3));
    return result;
  });
  Vector right(3 * rows);
  asRows(right) = system.Project(values, affine);
  Eigen::ConjugateGradient<LinearOperator, Eigen::Lower | Eigen::Upper, LinearPreconditioner>
    solver(normalEquations);
  solver.preconditioner().Apply = [&](const Vector& x) -> Vector {
    Vector result(x.size());
    asRows(result) = system.Precondition(Eigen::Map<const Vectors>(x.data(), rows, 3));
    return result;
  };
  solver.setMaxIterations(LargestIterations);
  solver.setTolerance(ResidualReduction);
  Eigen::Map<Vector> solution(&net[0].x, 3 * rows);
  try
  {
    solution = solver.solveWithGuess(right, solution).eval();
  }
  catch (const SolutionStopped&)
  {
    return false;
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

  // Level 0: the affine map, as a net of one cell.
  glm::dmat3 matrix(0.0);
  glm::dvec3 offset(0.0);
  AffineFit(points, displacements, used, matrix, offset);
  fit.Cells = glm::ivec3(1);
  fit.Net.Nodes = glm::ivec3(4);
  fit.Net.Values = AffineNet(fit, matrix, offset);
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
    const PointSystem system(points, used, level, weight, limits.Parallel);
    const std::vector<glm::dvec3> affine = AffineNet(level, matrix, offset);
    // The residuals are added to the aims (iterated Tikhonov regularization): that restores what
    // the bending energy takes off consistent landmarks, and soon ends where they contradict each
    // other.
    std::vector<glm::dvec3> aims = displacements;
    for (int round = 0; round < LargestRounds; ++round)
    {
      if (!SolvePoints(system, aims, affine, limits, done, level.Net.Values))
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
          const PointSystem stiff(points, used, level, stiffer, limits.Parallel);
          if (!SolvePoints(stiff, displacements, affine, limits, done, level.Net.Values))
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
    futile = gained || system.GetSize() < static_cast<Eigen::Index>(points.size()) ? 0 : futile + 1;
    if (2 * level.Cells.x > limits.MaximumCells || futile == 2)
    {
      return FitStatus::NotReached;
    }
    level.Net = RefineControlNet(level.Net, glm::ivec3(2));
    level.Cells *= 2;
  }
}

} // namespace ffd
