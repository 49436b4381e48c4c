// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDLocalBounds.h"

#include "FFDBSplineBasis.h"
#include "FFDEighthPowers.h"
#include "FFDMatrixBounds.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>

namespace ffd
{
namespace
{

/// Of symmetric tensors: where the entry (b, c) or (b, c, d) is kept.
constexpr int PairIndex[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };
constexpr int TripleIndex[3][6] = { { 0, 1, 2, 3, 4, 5 }, { 1, 3, 4, 6, 7, 8 },
  { 2, 4, 5, 7, 8, 9 } };

glm::dvec3 Row(const double row[3]) { return glm::dvec3(row[0], row[1], row[2]); }

/// Sum over b, c of m_bc u_b v_c.
glm::dvec3 Apply(const double m[6][3], const glm::dvec3& u, const glm::dvec3& v)
{
  return u.x * v.x * Row(m[0]) + (u.x * v.y + u.y * v.x) * Row(m[1]) +
    (u.x * v.z + u.z * v.x) * Row(m[2]) + u.y * v.y * Row(m[3]) +
    (u.y * v.z + u.z * v.y) * Row(m[4]) + u.z * v.z * Row(m[5]);
}

/// Sum over b, c, d of m_bcd u_b u_c u_d.
glm::dvec3 ApplyCube(const double m[10][3], const glm::dvec3& u)
{
  glm::dvec3 sum(0.0);
  for (int b = 0; b < 3; ++b)
  {
    for (int c = 0; c < 3; ++c)
    {
      for (int d = 0; d < 3; ++d)
      {
        sum += (u[b] * u[c] * u[d]) * Row(m[TripleIndex[b][PairIndex[c][d]]]);
      }
    }
  }
  return sum;
}

/// What a tensor of third derivatives makes of a step: one of second derivatives.
void ApplyStep(const double m[10][3], const glm::dvec3& step, double to[6][3])
{
  for (int pair = 0; pair < 6; ++pair)
  {
    for (int a = 0; a < 3; ++a)
    {
      to[pair][a] = m[TripleIndex[0][pair]][a] * step.x + m[TripleIndex[1][pair]][a] * step.y +
        m[TripleIndex[2][pair]][a] * step.z;
    }
  }
}

/// What a tensor of second derivatives makes of a step: a matrix, [column][row].
glm::dmat3 ApplyStep(const double m[6][3], const glm::dvec3& step)
{
  glm::dmat3 to;
  for (int b = 0; b < 3; ++b)
  {
    to[b] = step.x * Row(m[PairIndex[b][0]]) + step.y * Row(m[PairIndex[b][1]]) +
      step.z * Row(m[PairIndex[b][2]]);
  }
  return to;
}

/// False for a matrix so near to singular that its inverse is mostly rounding.
bool Invert(const glm::dmat3& m, glm::dmat3& inverse)
{
  const double determinant = glm::determinant(m);
  if (!(std::abs(determinant) > 1e-9) || !(std::abs(determinant) < 1e30))
  {
    return false;
  }
  inverse = glm::inverse(m);
  return true;
}

/// Of boxes in rest space that are worth a look, in cells of the lattice.
constexpr double LargestRadius = 0.75;

void SecondDerivativeWeights(double u, double w[4])
{
  w[0] = 1.0 - u;
  w[1] = 3.0 * u - 2.0;
  w[2] = 1.0 - 3.0 * u;
  w[3] = u;
}

} // namespace

//------------------------------------------------------------------------------
LocalBounds::LocalBounds(
  const PullBack& pullBack, const PullBackBounds& bounds, const CellRange& cells)
  : Map(&pullBack)
  , Cells(cells)
{
  const std::vector<CellDerivatives>& all = bounds.GetDerivatives();
  const BSplineField& field = *pullBack.GetField();
  // There is a constant one before the first and after the last.
  const glm::ivec3 allSize = field.GetEndCell() - field.GetFirstCell() + 2;
  const glm::ivec3 skipped = cells.First - field.GetFirstCell() + 1;
  const glm::ivec3 size = cells.End - cells.First;
  if (glm::any(glm::lessThan(size, glm::ivec3(1))) ||
    static_cast<double>(size.x) * size.y * size.z > LargestNumberOfCells)
  {
    return;
  }
  // Entry by entry first: independent maxima are found many at a time.
  float most[30] = {};
  for (const CellDerivatives& cell : all)
  {
    const float* third = &cell.Third[0][0];
    for (int e = 0; e < 30; ++e)
    {
      most[e] = std::max(most[e], third[e]);
    }
  }
  const float largest = *std::max_element(most, most + 30);
  if (!std::isfinite(largest))
  {
    return;
  }
  for (int power = 0; power < 255; ++power)
  {
    // A little more than that, for rounding.
    this->Powers[power] = largest * EighthPower(power) * 1.0001f;
  }
  this->Third.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
    static_cast<std::size_t>(size.z));
  CellThird* cell = this->Third.data();
  for (int k = 0; k < size.z; ++k)
  {
    for (int j = 0; j < size.y; ++j)
    {
      const glm::ivec3 at = skipped + glm::ivec3(0, j, k);
      const CellDerivatives* from =
        &all[static_cast<std::size_t>(at.x + allSize.x * (at.y + allSize.y * at.z))];
      for (int i = 0; i < size.x; ++i, ++cell, ++from)
      {
        const float* third = &from->Third[0][0];
        std::uint8_t* powers = &cell->Power[0][0];
        for (int e = 0; e < 30; ++e)
        {
          const int power =
            third[e] > 0.0f ? std::min(FindEighthPower(largest / third[e]), 254) : 255;
          powers[e] = static_cast<std::uint8_t>(power);
        }
      }
    }
  }
}

//------------------------------------------------------------------------------
bool LocalBounds::FindThird(
  const glm::dvec3& middle, const glm::dvec3& radius, double third[10][3]) const
{
  const BSplineField& field = *this->Map->GetField();
  glm::ivec3 from;
  glm::ivec3 to;
  for (int a = 0; a < 3; ++a)
  {
    const double h = field.GetSpacing()[a];
    const double x = (middle[a] - field.GetOrigin()[a]) / h;
    const double r = radius[a] / std::abs(h) + 1e-9;
    // Outside of the lattice nothing changes along the axis: the outermost cell bounds that.
    const double least = field.GetFirstCell()[a];
    const double most = field.GetEndCell()[a];
    const bool kinks = field.GetBorder() == BorderMode::ZeroAtBorder && field.GetNodes()[a] > 1;
    if (kinks && !(x - r > least && x + r < most))
    {
      return false;
    }
    // Not finite, or so much that there is no hope.
    if (!(x - r > -1e300) || !(x + r < 1e300) || r > LargestRadius)
    {
      return false;
    }
    from[a] = static_cast<int>(std::floor(std::clamp(x - r, least, most - 1.0)));
    to[a] = static_cast<int>(std::floor(std::clamp(x + r, least, most - 1.0)));
    if (from[a] < this->Cells.First[a] || to[a] >= this->Cells.End[a])
    {
      return false;
    }
  }
  std::uint8_t power[10][3];
  std::fill_n(power[0], 30, static_cast<std::uint8_t>(255));
  const glm::ivec3 first = this->Cells.First;
  const glm::ivec3 size = this->Cells.End - first;
  for (int k = from.z; k <= to.z; ++k)
  {
    for (int j = from.y; j <= to.y; ++j)
    {
      for (int i = from.x; i <= to.x; ++i)
      {
        const glm::ivec3 at = glm::ivec3(i, j, k) - first;
        const CellThird& cell =
          this->Third[static_cast<std::size_t>(at.x + size.x * (at.y + size.y * at.z))];
        for (int t = 0; t < 10; ++t)
        {
          for (int a = 0; a < 3; ++a)
          {
            power[t][a] = std::min(power[t][a], cell.Power[t][a]);
          }
        }
      }
    }
  }
  for (int t = 0; t < 10; ++t)
  {
    for (int a = 0; a < 3; ++a)
    {
      third[t][a] = this->Powers[power[t][a]];
    }
  }
  return true;
}

//------------------------------------------------------------------------------
void LocalBounds::FindDerivatives(
  const glm::dvec3& p, glm::dmat3& jacobian, double second[6][3]) const
{
  const BSplineField& field = *this->Map->GetField();
  int first[3];
  double w[3][3][4]; // axis, order, control point
  for (int a = 0; a < 3; ++a)
  {
    const double scale = 1.0 / field.GetSpacing()[a];
    const AxisPosition at = LocateOnAxis(
      (p[a] - field.GetOrigin()[a]) * scale, field.GetFirstCell()[a], field.GetEndCell()[a]);
    first[a] = at.Cell - 1;
    BSplineWeights(at.U, w[a][0]);
    BSplineDerivativeWeights(at.U, w[a][1]);
    SecondDerivativeWeights(at.U, w[a][2]);
    for (int i = 0; i < 4; ++i)
    {
      w[a][1][i] *= at.Constant ? 0.0 : scale;
      w[a][2][i] *= at.Constant ? 0.0 : scale * scale;
    }
  }
  glm::dvec3 columns[3]; // d/dx, d/dy, d/dz
  glm::dvec3 pairs[6];
  std::fill_n(columns, 3, glm::dvec3(0.0));
  std::fill_n(pairs, 6, glm::dvec3(0.0));
  for (int k = 0; k < 4; ++k)
  {
    glm::dvec3 plane[3][3] = {}; // orders of x and y
    for (int j = 0; j < 4; ++j)
    {
      const glm::dvec3* c = &field.Coefficient(first[0], first[1] + j, first[2] + k);
      for (int ox = 0; ox < 3; ++ox)
      {
        const double* wx = w[0][ox];
        const glm::dvec3 row = wx[0] * c[0] + wx[1] * c[1] + wx[2] * c[2] + wx[3] * c[3];
        for (int oy = 0; ox + oy < 3; ++oy)
        {
          plane[ox][oy] += w[1][oy][j] * row;
        }
      }
    }
    const double* wz[3] = { w[2][0] + k, w[2][1] + k, w[2][2] + k };
    columns[0] += *wz[0] * plane[1][0];
    columns[1] += *wz[0] * plane[0][1];
    columns[2] += *wz[1] * plane[0][0];
    pairs[0] += *wz[0] * plane[2][0];
    pairs[1] += *wz[0] * plane[1][1];
    pairs[2] += *wz[1] * plane[1][0];
    pairs[3] += *wz[0] * plane[0][2];
    pairs[4] += *wz[1] * plane[0][1];
    pairs[5] += *wz[2] * plane[0][0];
  }
  for (int b = 0; b < 3; ++b)
  {
    jacobian[b] = columns[b];
  }
  for (int pair = 0; pair < 6; ++pair)
  {
    for (int a = 0; a < 3; ++a)
    {
      second[pair][a] = pairs[pair][a];
    }
  }
}

//------------------------------------------------------------------------------
bool LocalBounds::FindChange(
  const glm::dvec3& point, const glm::dvec3& radius, LocalMap& map, Change& change) const
{
  if (!this->FindThird(point, radius, map.Third))
  {
    return false;
  }
  ApplyStep(map.Third, radius, map.SecondSpread);
  double absolute[6][3];
  for (int pair = 0; pair < 6; ++pair)
  {
    for (int a = 0; a < 3; ++a)
    {
      absolute[pair][a] = std::abs(map.Second[pair][a]);
    }
  }
  const glm::dmat3 bySecond = ApplyStep(absolute, radius);
  const glm::dmat3 byThird = ApplyStep(map.SecondSpread, radius);
  change.Jacobian = bySecond + 0.5 * byThird;
  change.Remainder = (0.5 * bySecond + (1.0 / 6.0) * byThird) * radius;
  return true;
}

//------------------------------------------------------------------------------
bool LocalBounds::FindInverse(const glm::dmat3& change, LocalMap& map) const
{
  // |J^-1 - A| <= (W + W^2 + ...) |A| with W = |A| change: see PullBackBounds.
  const glm::dmat3 size = Absolute(map.Linear);
  const glm::dmat3 w = size * change;
  if (!(LargestRowSum(w) < 0.999))
  {
    return false;
  }
  map.LinearSpread = glm::inverse(glm::dmat3(1.0) - w) * (w * size);
  map.LinearMost = size + map.LinearSpread;
  const glm::dmat3 least = map.Linear - map.LinearSpread;
  const glm::dmat3 most = map.Linear + map.LinearSpread;
  const bool mirrored = this->Map->GetKind() == PullBackKind::FirstOrderOfInverse;
  map.JacobianMin = mirrored ? glm::dmat3(2.0) - most : least;
  map.JacobianMax = mirrored ? glm::dmat3(2.0) - least : most;
  return true;
}

//------------------------------------------------------------------------------
bool LocalBounds::Find(const Box& box, LocalMap& map) const
{
  if (this->Third.empty())
  {
    return false;
  }
  const glm::dvec3 middle = 0.5 * (box.Min + box.Max);
  const glm::dvec3 half = 0.5 * (box.Max - box.Min);
  const PullBackKind kind = this->Map->GetKind();
  map.Inverse = InvertsTheField(kind);
  glm::dmat3 jacobian;
  Change change;
  if (!map.Inverse)
  {
    const double sign = kind == PullBackKind::FirstOrder ? -1.0 : 1.0;
    this->FindDerivatives(middle, jacobian, map.Second);
    if (!this->FindChange(middle, half, map, change))
    {
      return false;
    }
    const glm::dmat3 linear = glm::dmat3(1.0) + sign * jacobian;
    map.JacobianMin = linear - change.Jacobian;
    map.JacobianMax = linear + change.Jacobian;
    return true;
  }

  PullBackStatus status;
  const PullBack exact(this->Map->GetField(), PullBackKind::Exact, this->Map->GetTolerance());
  const glm::dvec3 point = exact.Evaluate(middle, status);
  if (!status.Converged)
  {
    return false;
  }
  this->FindDerivatives(point, jacobian, map.Second);
  if (!Invert(glm::dmat3(1.0) + jacobian, map.Linear))
  {
    return false;
  }
  // Q -> point + A (P - T(point) - remainder(Q)) takes the region into itself, so every P of the
  // box has a solution there (Brouwer); it has but one if the Jacobians are regular (below).
  const glm::dmat3 size = Absolute(map.Linear);
  const glm::dvec3 target = half + this->Map->GetTolerance();
  glm::dvec3 radius = 1.1 * (size * target);
  bool enclosed = false;
  for (int attempt = 0; attempt < 5 && !enclosed; ++attempt)
  {
    if (!this->FindChange(point, radius, map, change))
    {
      return false;
    }
    const glm::dvec3 image = size * (target + change.Remainder);
    enclosed = glm::all(glm::lessThan(image, radius));
    radius = enclosed ? image : 1.1 * image;
  }
  return enclosed && this->FindChange(point, radius, map, change) &&
    this->FindInverse(change.Jacobian, map);
}

//------------------------------------------------------------------------------
LocalMap::Along LocalMap::FindAlong(const VectorRange& v) const
{
  // Q' = J^-1 v and J Q'' = -T2[Q', Q'], and without an inverse Q'' = -+ T2[v, v].
  Along along;
  along.First = v.Middle;
  along.FirstMost = glm::abs(v.Middle) + v.Spread;
  if (this->Inverse)
  {
    along.First = this->Linear * v.Middle;
    along.FirstMost =
      glm::abs(along.First) + this->LinearSpread * glm::abs(v.Middle) + this->LinearMost * v.Spread;
  }
  double absolute[6][3];
  for (int pair = 0; pair < 6; ++pair)
  {
    for (int a = 0; a < 3; ++a)
    {
      absolute[pair][a] = std::abs(this->Second[pair][a]);
    }
  }
  const glm::dvec3 size = glm::abs(along.First);
  along.Second = Apply(this->Second, along.First, along.First);
  const glm::dvec3 change = Apply(absolute, along.FirstMost, along.FirstMost) -
    Apply(absolute, size, size) + Apply(this->SecondSpread, along.FirstMost, along.FirstMost);
  if (!this->Inverse)
  {
    along.SecondMost = glm::abs(along.Second) + change;
    return along;
  }
  const glm::dvec3 middle = glm::abs(along.Second);
  along.Second = -(this->Linear * along.Second);
  along.SecondMost =
    glm::abs(along.Second) + this->LinearMost * change + this->LinearSpread * middle;
  return along;
}

//------------------------------------------------------------------------------
double LocalMap::SecondAlong(const VectorRange& v) const
{
  return glm::length(this->FindAlong(v).SecondMost);
}

//------------------------------------------------------------------------------
double LocalMap::ThirdAlong(const VectorRange& v) const
{
  const Along along = this->FindAlong(v);
  const glm::dvec3 cube = ApplyCube(this->Third, along.FirstMost);
  if (!this->Inverse)
  {
    return glm::length(cube);
  }
  // J Q''' = -T3[Q', Q', Q'] - 3 T2[Q', Q''].
  double absolute[6][3];
  for (int pair = 0; pair < 6; ++pair)
  {
    for (int a = 0; a < 3; ++a)
    {
      absolute[pair][a] = std::abs(this->Second[pair][a]);
    }
  }
  const glm::dvec3 bend = glm::abs(Apply(this->Second, along.First, along.Second)) +
    Apply(absolute, along.FirstMost, along.SecondMost) -
    Apply(absolute, glm::abs(along.First), glm::abs(along.Second)) +
    Apply(this->SecondSpread, along.FirstMost, along.SecondMost);
  return glm::length(this->LinearMost * (cube + 3.0 * bend));
}

} // namespace ffd
