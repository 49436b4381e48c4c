// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "Bounds/FFDJacobianDeterminant.h"

#include "Bounds/FFDSubCellBounds.h"
#include "FFDBSplineBasis.h"

#include <Eigen/Dense>

#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace ffd
{
namespace
{

/// Coefficients per axis: det J of a tricubic has degree 2 + 3 + 3 along each.
constexpr int N = 9;
constexpr int MaximumDepth = 5;
/// The conversion to Bernstein form amplifies rounding by up to 184 (the largest coefficient of
/// the Chebyshev polynomial of degree 8) times the Lebesgue constant per axis.
constexpr double ConversionSlack = 1e-8;

using Coefficients = std::array<double, N * N * N>;
using Matrix = Eigen::Matrix<double, N, N, Eigen::RowMajor>;

/// Chebyshev-Lobatto points of [0, 1], both ends included.
double SamplePoint(int i)
{
  constexpr double pi = 3.14159265358979323846;
  return 0.5 - 0.5 * std::cos(pi * i / (N - 1));
}

/// Bernstein coefficients from samples: the inverse of the collocation matrix.
Matrix MakeConversion()
{
  Matrix collocation;
  for (int i = 0; i < N; ++i)
  {
    const double u = SamplePoint(i);
    double binomial = 1.0;
    for (int j = 0; j < N; ++j)
    {
      collocation(i, j) = binomial * std::pow(u, j) * std::pow(1.0 - u, N - 1 - j);
      binomial = binomial * (N - 1 - j) / (j + 1);
    }
  }
  return collocation.inverse();
}

Range RangeOf(const Coefficients& values)
{
  const auto ends = std::minmax_element(values.begin(), values.end());
  return { *ends.first, *ends.second };
}

/// det J at the sample points of a cell.
Coefficients SampleDeterminant(const BSplineField& field, const glm::ivec3& cell)
{
  double value[N][4];
  double slope[N][4];
  for (int i = 0; i < N; ++i)
  {
    BSplineWeights(SamplePoint(i), value[i]);
    BSplineDerivativeWeights(SamplePoint(i), slope[i]);
  }
  // [y][x sample], then [z]: contract x, y, z in turn; D is not needed, only its derivatives.
  Coefficients result;
  glm::dvec3 lines[4][4][N][2];
  for (int k = 0; k < 4; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      const glm::dvec3* row = &field.Coefficient(cell.x - 1, cell.y - 1 + j, cell.z - 1 + k);
      for (int x = 0; x < N; ++x)
      {
        const double* v = value[x];
        const double* s = slope[x];
        lines[k][j][x][0] = v[0] * row[0] + v[1] * row[1] + v[2] * row[2] + v[3] * row[3];
        lines[k][j][x][1] = s[0] * row[0] + s[1] * row[1] + s[2] * row[2] + s[3] * row[3];
      }
    }
  }
  const glm::dvec3 inverse = 1.0 / field.GetSpacing();
  for (int y = 0; y < N; ++y)
  {
    for (int x = 0; x < N; ++x)
    {
      glm::dvec3 planes[4][3];
      for (int k = 0; k < 4; ++k)
      {
        planes[k][0] = planes[k][1] = planes[k][2] = glm::dvec3(0.0);
        for (int j = 0; j < 4; ++j)
        {
          planes[k][0] += value[y][j] * lines[k][j][x][0];
          planes[k][1] += value[y][j] * lines[k][j][x][1];
          planes[k][2] += slope[y][j] * lines[k][j][x][0];
        }
      }
      for (int z = 0; z < N; ++z)
      {
        glm::dmat3 jacobian(0.0);
        for (int k = 0; k < 4; ++k)
        {
          jacobian[0] += value[z][k] * planes[k][1];
          jacobian[1] += value[z][k] * planes[k][2];
          jacobian[2] += slope[z][k] * planes[k][0];
        }
        for (int a = 0; a < 3; ++a)
        {
          jacobian[a] *= inverse[a];
          jacobian[a][a] += 1.0;
        }
        result[static_cast<std::size_t>((z * N + y) * N + x)] = glm::determinant(jacobian);
      }
    }
  }
  return result;
}

constexpr int Strides[3] = { 1, N, N* N };

/// First element of each of the 81 lines along an axis.
int LineStart(int axis, int line)
{
  const int b = (axis + 1) % 3;
  const int c = (axis + 2) % 3;
  return (line % N) * Strides[b] + (line / N) * Strides[c];
}

void ConvertToBernstein(const Matrix& conversion, Coefficients& values)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int line = 0; line < N * N; ++line)
    {
      double* v = values.data() + LineStart(axis, line);
      double in[N];
      for (int i = 0; i < N; ++i)
      {
        in[i] = v[i * Strides[axis]];
      }
      for (int i = 0; i < N; ++i)
      {
        double sum = 0.0;
        for (int j = 0; j < N; ++j)
        {
          sum += conversion(i, j) * in[j];
        }
        v[i * Strides[axis]] = sum;
      }
    }
  }
}

/// De Casteljau at the middle of an axis: `values` becomes the lower half, `upper` the other.
void Split(int axis, Coefficients& values, Coefficients& upper)
{
  for (int line = 0; line < N * N; ++line)
  {
    double* v = values.data() + LineStart(axis, line);
    double* w = upper.data() + LineStart(axis, line);
    double c[N];
    for (int i = 0; i < N; ++i)
    {
      c[i] = v[i * Strides[axis]];
    }
    for (int level = 0; level < N; ++level)
    {
      v[level * Strides[axis]] = c[0];
      w[(N - 1 - level) * Strides[axis]] = c[N - 1 - level];
      for (int i = 0; i + level + 1 < N; ++i)
      {
        c[i] = 0.5 * (c[i] + c[i + 1]);
      }
    }
  }
}

/// A range that is attained (inner) and one that is proven not to be left (outer).
struct Search
{
  double Tolerance;
  bool OnlySign; // whether the minimum is positive is asked, and no more
  Range Attained;
  Range Proven;

  /// Whether the answer is known: a value was met that is not positive, or so small that no part
  /// with it ever settles.
  bool IsDone() const { return this->OnlySign && !(this->Attained.Min > ConversionSlack); }

  /// What is proven, less `slack`; not positive once that is known.
  Range FindResult(double slack) const
  {
    const double least = this->Proven.Min - slack;
    return { this->IsDone() ? std::min(least, 0.0) : least, this->Proven.Max + slack };
  }

  bool Settles(const Range& enclosure) const
  {
    if (this->OnlySign)
    {
      return enclosure.Min > ConversionSlack * std::max(1.0, enclosure.Max);
    }
    return enclosure.Min >=
      this->Attained.Min - this->Tolerance * std::max(1.0, std::abs(this->Attained.Min)) &&
      enclosure.Max <=
      this->Attained.Max + this->Tolerance * std::max(1.0, std::abs(this->Attained.Max));
  }

  void Visit(Coefficients& values, int depth)
  {
    // The corner coefficients are values of the polynomial.
    for (const int corner : { 0, N - 1, N * (N - 1), N * N - 1 })
    {
      for (const int layer : { 0, N * N * (N - 1) })
      {
        const double value = values[static_cast<std::size_t>(corner + layer)];
        this->Attained.Min = std::min(this->Attained.Min, value);
        this->Attained.Max = std::max(this->Attained.Max, value);
      }
    }
    const Range enclosure = RangeOf(values);
    // Beyond the numbers no part settles anything; a sum tells of values that are not a number.
    if (!std::isfinite(std::accumulate(values.begin(), values.end(), 0.0)))
    {
      constexpr double infinity = std::numeric_limits<double>::infinity();
      this->Attained = this->Proven = { -infinity, infinity };
      return;
    }
    if (depth == 0 || this->IsDone() || this->Settles(enclosure))
    {
      this->Proven.Min = std::min(this->Proven.Min, enclosure.Min);
      this->Proven.Max = std::max(this->Proven.Max, enclosure.Max);
      return;
    }
    this->Halve(values, 0, depth - 1);
  }

  void Halve(Coefficients& values, int axis, int depth)
  {
    if (axis == 3)
    {
      this->Visit(values, depth);
      return;
    }
    Coefficients upper;
    Split(axis, values, upper);
    this->Halve(values, axis + 1, depth);
    this->Halve(upper, axis + 1, depth);
  }
};

Range Product(const Range& a, const Range& b)
{
  const std::array<double, 4> p = { a.Min * b.Min, a.Min * b.Max, a.Max * b.Min, a.Max * b.Max };
  const auto ends = std::minmax_element(p.begin(), p.end());
  return { *ends.first, *ends.second };
}

/// det of [I + interval matrix] by interval arithmetic.
Range IntervalDeterminant(const SubCellBounds& bounds)
{
  Range m[3][3];
  for (int i = 0; i < 9; ++i)
  {
    const double unit = i % 4 == 0 ? 1.0 : 0.0;
    m[i / 3][i % 3] = { unit -
        static_cast<double>(bounds.Value[SubCellBounds::NegatedJacobianMin + i]),
      unit + static_cast<double>(bounds.Value[SubCellBounds::JacobianMax + i]) };
  }
  Range sum;
  for (int c = 0; c < 3; ++c)
  {
    const int d = (c + 1) % 3;
    const int e = (c + 2) % 3;
    const Range plus = Product(m[1][d], m[2][e]);
    const Range minus = Product(m[1][e], m[2][d]);
    const Range term = Product(m[0][c], { plus.Min - minus.Max, plus.Max - minus.Min });
    sum.Min += term.Min;
    sum.Max += term.Max;
  }
  return sum;
}

/// See BoundJacobianDeterminant(), and Search for the options.
Range BoundDeterminant(const BSplineField& field, const glm::ivec3& firstCell,
  const glm::ivec3& endCell, double tolerance, bool onlySign)
{
  const glm::ivec3 first = glm::max(firstCell, field.GetFirstCell());
  const glm::ivec3 end = glm::min(endCell, field.GetEndCell());
  if (field.IsZero() || glm::any(glm::lessThanEqual(end, first)))
  {
    return { 1.0, 1.0 };
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& c : field.GetCoefficients())
  {
    if (!std::isfinite(c.x + c.y + c.z))
    {
      return { -infinity, infinity };
    }
  }
  static const Matrix conversion = MakeConversion();
  const SubCellGrid grid(CellRange{ first, end });
  SubCellBoundsVector subCells;
  ComputeSubCellBounds(field, grid, subCells);

  Search search{ tolerance, onlySign, { infinity, -infinity }, { infinity, -infinity } };
  double largest = 0.0;
  glm::ivec3 cell;
  // Values at the centers first: the better the attained range, the more cells are skipped.
  for (cell.z = first.z; cell.z < end.z; ++cell.z)
  {
    for (cell.y = first.y; cell.y < end.y; ++cell.y)
    {
      for (cell.x = first.x; cell.x < end.x; ++cell.x)
      {
        glm::dmat3 jacobian;
        field.Displacement(
          field.GetOrigin() + (glm::dvec3(cell) + 0.5) * field.GetSpacing(), jacobian);
        const double value = glm::determinant(glm::dmat3(1.0) + jacobian);
        search.Attained.Min = std::min(search.Attained.Min, value);
        search.Attained.Max = std::max(search.Attained.Max, value);
      }
    }
  }
  search.Proven = search.Attained;
  if (search.IsDone())
  {
    return search.FindResult(0.0);
  }
  for (cell.z = first.z; cell.z < end.z; ++cell.z)
  {
    for (cell.y = first.y; cell.y < end.y; ++cell.y)
    {
      for (cell.x = first.x; cell.x < end.x; ++cell.x)
      {
        Range coarse{ infinity, -infinity };
        const glm::ivec3 s = 2 * (cell - grid.FirstCell) + 1;
        for (int i = 0; i < 8; ++i)
        {
          const Range part = IntervalDeterminant(
            subCells[grid.Index(s.x + (i & 1), s.y + (i >> 1 & 1), s.z + (i >> 2))]);
          coarse.Min = std::min(coarse.Min, part.Min);
          coarse.Max = std::max(coarse.Max, part.Max);
        }
        if (search.Settles(coarse))
        {
          search.Proven.Min = std::min(search.Proven.Min, coarse.Min);
          search.Proven.Max = std::max(search.Proven.Max, coarse.Max);
          continue;
        }
        Coefficients values = SampleDeterminant(field, cell);
        const Range sampled = RangeOf(values);
        search.Attained.Min = std::min(search.Attained.Min, sampled.Min);
        search.Attained.Max = std::max(search.Attained.Max, sampled.Max);
        largest = std::max({ largest, std::abs(sampled.Min), std::abs(sampled.Max) });
        ConvertToBernstein(conversion, values);
        search.Visit(values, MaximumDepth);
      }
    }
  }
  const double slack = ConversionSlack * largest;
  if (!std::isfinite(slack))
  {
    return { -infinity, infinity };
  }
  return search.FindResult(slack);
}

} // namespace

//------------------------------------------------------------------------------
Range BoundJacobianDeterminant(const BSplineField& field, const glm::ivec3& firstCell,
  const glm::ivec3& endCell, double tolerance)
{
  return BoundDeterminant(field, firstCell, endCell, tolerance, false);
}

//------------------------------------------------------------------------------
bool HasPositiveJacobian(
  const BSplineField& field, const glm::ivec3& firstCell, const glm::ivec3& endCell)
{
  return BoundDeterminant(field, firstCell, endCell, 0.0, true).Min > 0.0;
}

} // namespace ffd
