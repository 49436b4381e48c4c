// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDDeformedSpaceBounds.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

namespace ffd
{
namespace
{

constexpr float Infinity = std::numeric_limits<float>::infinity();

/// A cell of the lattice is refined into at most so many per axis.
constexpr int LargestFactor = 4;

/// A float that is not below x.
float RoundUp(double x)
{
  const float single = static_cast<float>(x);
  return static_cast<double>(single) < x ? std::nextafter(single, Infinity) : single;
}

/// One axis of rest space cut into intervals: the constant outside of the lattice, its cells, and
/// the halves of refined cells where the lattice is refined.
struct AxisIntervals
{
  std::vector<double> Ends; ///< lattice parameters, from -infinity to infinity
  int FirstRefined = 0;     ///< interval
  int EndRefined = 0;

  AxisIntervals(int first, int end, int firstRefined, int endRefined, int factor)
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    this->Ends.push_back(-infinity);
    for (int cell = first; cell < end; ++cell)
    {
      const bool refined = cell >= firstRefined && cell < endRefined;
      this->FirstRefined =
        cell == firstRefined ? static_cast<int>(this->Ends.size()) : this->FirstRefined;
      const int parts = refined ? 2 * factor : 2;
      for (int part = 0; part < parts; ++part)
      {
        this->Ends.push_back(cell + static_cast<double>(part) / parts);
      }
      this->EndRefined = refined ? static_cast<int>(this->Ends.size()) : this->EndRefined;
    }
    this->Ends.push_back(end);
    this->Ends.push_back(infinity);
  }

  int Count() const { return static_cast<int>(this->Ends.size()) - 1; }
  bool IsRefined(int i) const { return i >= this->FirstRefined && i < this->EndRefined; }
};

/// The cells of a lattice that a box touches.
CellRange FindCells(const BSplineField& field, const Box& box)
{
  CellRange cells;
  for (int a = 0; a < 3; ++a)
  {
    const double from = (box.Min[a] - field.GetOrigin()[a]) / field.GetSpacing()[a];
    const double to = (box.Max[a] - field.GetOrigin()[a]) / field.GetSpacing()[a];
    const double first = field.GetFirstCell()[a];
    const double end = field.GetEndCell()[a];
    cells.First[a] = static_cast<int>(std::clamp(std::floor(std::min(from, to)), first, end));
    cells.End[a] = static_cast<int>(std::clamp(std::ceil(std::max(from, to)), first, end));
  }
  return cells;
}

} // namespace

//------------------------------------------------------------------------------
void DeformedSpaceBounds::PowerTable::Set(float largest)
{
  this->Value[0] = Infinity;
  for (int power = 1; power < 255; ++power)
  {
    // A little more than that, for rounding.
    this->Value[power] = largest * std::exp2(-0.125f * static_cast<float>(power - 1)) * 1.0001f;
  }
  this->Value[255] = 0.0f;
}

//------------------------------------------------------------------------------
std::uint8_t DeformedSpaceBounds::PowerTable::Encode(float value) const
{
  if (!(value <= this->Value[1]))
  {
    return 0;
  }
  if (!(value > 0.0f))
  {
    return 255;
  }
  const float power = 1.0f + std::floor(8.0f * std::log2(this->Value[1] / (1.0001f * value)));
  return static_cast<std::uint8_t>(std::clamp(power, 1.0f, 254.0f));
}

//------------------------------------------------------------------------------
DeformedSpaceBounds::DeformedSpaceBounds(const PullBack& pullBack, const PullBackBounds& bounds,
  const Box& region, const Box& rest, double resolution, int mostCells,
  const ParallelFor& parallelFor)
  : Region(region)
  , Resolution(std::max(resolution, 1e-300))
{
  if (pullBack.IsIdentity())
  {
    this->Identity = true;
    return;
  }
  this->OneToOne = !bounds.RegionsAreInRestSpace() || bounds.IsProvenInvertible();
  const BSplineField& field = *pullBack.GetField();
  const glm::dvec3 spacing = glm::abs(field.GetSpacing());
  const glm::dvec3 size = glm::max(region.Max - region.Min, glm::dvec3(1e-300));
  glm::dvec3 cells(1.0);
  for (double cell = this->Resolution;; cell *= 1.1)
  {
    // No smaller than half the smallest sub-cells of the lattice.
    const glm::dvec3 sides = glm::max(glm::dvec3(cell), spacing / (4.0 * LargestFactor));
    cells = glm::max(glm::ceil(size / sides), glm::dvec3(1.0));
    // What has no size is one cell.
    if (!(cells.x * cells.y * cells.z < 1e300))
    {
      cells = glm::dvec3(1.0);
    }
    if (cells.x * cells.y * cells.z <= std::max(1, mostCells))
    {
      break;
    }
  }
  this->Cells = glm::ivec3(cells);
  this->PartSize = size / (static_cast<double>(Parts) * cells);

  const Box needed = bounds.RegionsAreInRestSpace()
    ? Box{ rest.Min - this->Resolution, rest.Max + this->Resolution }
    : region;
  const CellRange neededCells = FindCells(field, needed);
  const CellRange refinedCells = this->FindRefinedCells(bounds, field, neededCells);
  glm::ivec3 factors(1);
  PullBackBounds refined;
  if (glm::all(glm::lessThan(refinedCells.First, refinedCells.End)))
  {
    factors = glm::ivec3(glm::clamp(glm::ceil(0.5 * spacing / this->PartSize), glm::dvec3(1.0),
      glm::dvec3(static_cast<double>(LargestFactor))));
    refined = PullBackBounds(pullBack, refinedCells, factors, parallelFor);
  }
  this->Local = LocalBounds(pullBack, bounds, neededCells);

  Grids grids = this->EmptyGrids();
  if (bounds.RegionsAreInRestSpace())
  {
    this->FindFromRest(bounds, refined, refinedCells, factors, field, parallelFor, grids);
  }
  else
  {
    this->FindOverCells(bounds, refined, refinedCells, field, parallelFor, grids);
  }
  this->Encode(grids);
}

//------------------------------------------------------------------------------
DeformedSpaceBounds::Grids DeformedSpaceBounds::EmptyGrids() const
{
  Grids grids;
  UpperBounds nothing;
  std::fill_n(nothing.Jacobian, 18, -Infinity);
  grids.Jacobians.assign(this->IndexOf(this->Cells), nothing);
  grids.Derivatives.assign(
    this->IndexOfPart(Parts * this->Cells), UpperDerivatives{ 0.0f, 0.0f });
  return grids;
}

//------------------------------------------------------------------------------
void DeformedSpaceBounds::Grids::Include(const Grids& other)
{
  for (std::size_t i = 0; i < this->Jacobians.size(); ++i)
  {
    for (int e = 0; e < 18; ++e)
    {
      this->Jacobians[i].Jacobian[e] =
        std::max(this->Jacobians[i].Jacobian[e], other.Jacobians[i].Jacobian[e]);
    }
  }
  for (std::size_t i = 0; i < this->Derivatives.size(); ++i)
  {
    UpperDerivatives& part = this->Derivatives[i];
    part.Second = std::max(part.Second, other.Derivatives[i].Second);
    part.Third = std::max(part.Third, other.Derivatives[i].Third);
  }
}

//------------------------------------------------------------------------------
std::size_t DeformedSpaceBounds::IndexOf(const glm::ivec3& cell) const
{
  // Of the end: how many there are.
  const std::size_t row = static_cast<std::size_t>(this->Cells.x);
  const std::size_t slice = row * static_cast<std::size_t>(this->Cells.y);
  return cell == this->Cells
    ? slice * static_cast<std::size_t>(this->Cells.z)
    : static_cast<std::size_t>(cell.x) + row * static_cast<std::size_t>(cell.y) +
      slice * static_cast<std::size_t>(cell.z);
}

//------------------------------------------------------------------------------
std::size_t DeformedSpaceBounds::IndexOfPart(const glm::ivec3& part) const
{
  const glm::ivec3 parts = Parts * this->Cells;
  const std::size_t row = static_cast<std::size_t>(parts.x);
  const std::size_t slice = row * static_cast<std::size_t>(parts.y);
  return part == parts
    ? slice * static_cast<std::size_t>(parts.z)
    : static_cast<std::size_t>(part.x) + row * static_cast<std::size_t>(part.y) +
      slice * static_cast<std::size_t>(part.z);
}

//------------------------------------------------------------------------------
glm::ivec3 DeformedSpaceBounds::PartOf(const glm::dvec3& p) const
{
  const glm::dvec3 last(Parts * this->Cells - 1);
  const glm::dvec3 x = glm::floor((p - this->Region.Min) / this->PartSize);
  return glm::ivec3(glm::max(glm::dvec3(0.0), glm::min(last, x)));
}

//------------------------------------------------------------------------------
CellRange DeformedSpaceBounds::FindRefinedCells(
  const PullBackBounds& bounds, const BSplineField& field, const CellRange& cells) const
{
  // Where the field has a kink in a face it is not refined, so that the derivatives show that.
  const int kink = field.GetBorder() == BorderMode::ZeroAtBorder ? 1 : 0;
  CellRange all;
  all.First = glm::max(cells.First, field.GetFirstCell() + kink);
  all.End = glm::min(cells.End, field.GetEndCell() - kink);
  // Of these, the box around the cells whose bounds are not close.
  CellRange range{ all.End, all.First };
  const double enough = CloseEnough / (this->Resolution * this->Resolution);
  for (int k = all.First.z; k < all.End.z; ++k)
  {
    for (int j = all.First.y; j < all.End.y; ++j)
    {
      for (int i = all.First.x; i < all.End.x; ++i)
      {
        const glm::ivec3 cell(i, j, k);
        const glm::dvec3 one =
          field.GetOrigin() + (glm::dvec3(cell) + 1e-7) * field.GetSpacing();
        const glm::dvec3 other =
          field.GetOrigin() + (glm::dvec3(cell) + 1.0 - 1e-7) * field.GetSpacing();
        const MapBounds here = bounds.Over({ glm::min(one, other), glm::max(one, other) });
        if (!(here.ThirdDerivative <= enough))
        {
          range.First = glm::min(range.First, cell);
          range.End = glm::max(range.End, cell + 1);
        }
      }
    }
  }
  return range;
}

//------------------------------------------------------------------------------
void DeformedSpaceBounds::FindOverCells(const PullBackBounds& bounds,
  const PullBackBounds& refined, const CellRange& refinedCells, const BSplineField& field,
  const ParallelFor& parallelFor, Grids& grids) const
{
  const glm::dvec3 one = field.GetOrigin() + glm::dvec3(refinedCells.First) * field.GetSpacing();
  const glm::dvec3 other = field.GetOrigin() + glm::dvec3(refinedCells.End) * field.GetSpacing();
  const bool anyRefined = glm::all(glm::lessThan(refinedCells.First, refinedCells.End));
  const Box closely{ glm::min(one, other), glm::max(one, other) };
  const glm::ivec3 parts = Parts * this->Cells;
  // A slice of cells is written to by one thread only.
  RunFor(parallelFor, static_cast<std::size_t>(this->Cells.z),
    [&](std::size_t first, std::size_t last)
    {
      for (int k = Parts * static_cast<int>(first); k < Parts * static_cast<int>(last); ++k)
      {
        for (int j = 0; j < parts.y; ++j)
        {
          for (int i = 0; i < parts.x; ++i)
          {
            const glm::ivec3 at(i, j, k);
            Box box;
            box.Min = this->Region.Min + glm::dvec3(at) * this->PartSize;
            box.Max = box.Min + this->PartSize;
            for (int a = 0; a < 3; ++a)
            {
              // The outermost ones have no end.
              box.Min[a] = at[a] == 0 ? -1e300 : box.Min[a];
              box.Max[a] = at[a] == parts[a] - 1 ? 1e300 : box.Max[a];
            }
            const bool inside = anyRefined && glm::all(glm::greaterThan(box.Min, closely.Min)) &&
              glm::all(glm::lessThan(box.Max, closely.Max));
            const MapBounds here = inside ? refined.Over(box) : bounds.Over(box);
            grids.Derivatives[this->IndexOfPart(at)] = { RoundUp(here.SecondDerivative),
              RoundUp(here.ThirdDerivative) };
            UpperBounds& cell = grids.Jacobians[this->IndexOf(at / Parts)];
            for (int e = 0; e < 9; ++e)
            {
              cell.Jacobian[e] =
                std::max(cell.Jacobian[e], RoundUp(here.JacobianMax[e / 3][e % 3]));
              cell.Jacobian[NegativeJacobian + e] = std::max(
                cell.Jacobian[NegativeJacobian + e], RoundUp(-here.JacobianMin[e / 3][e % 3]));
            }
          }
        }
      }
    });
}

//------------------------------------------------------------------------------
void DeformedSpaceBounds::Include(const MapBounds& here, const glm::ivec3& from,
  const glm::ivec3& to, Grids& grids) const
{
  const float second = RoundUp(here.SecondDerivative);
  const float third = RoundUp(here.ThirdDerivative);
  for (int k = from.z; k <= to.z; ++k)
  {
    for (int j = from.y; j <= to.y; ++j)
    {
      UpperDerivatives* row = &grids.Derivatives[this->IndexOfPart(glm::ivec3(0, j, k))];
      for (int i = from.x; i <= to.x; ++i)
      {
        row[i].Second = std::max(row[i].Second, second);
        row[i].Third = std::max(row[i].Third, third);
      }
    }
  }
  UpperBounds jacobian;
  for (int e = 0; e < 9; ++e)
  {
    jacobian.Jacobian[e] = RoundUp(here.JacobianMax[e / 3][e % 3]);
    jacobian.Jacobian[NegativeJacobian + e] = RoundUp(-here.JacobianMin[e / 3][e % 3]);
  }
  for (int k = from.z / Parts; k <= to.z / Parts; ++k)
  {
    for (int j = from.y / Parts; j <= to.y / Parts; ++j)
    {
      for (int i = from.x / Parts; i <= to.x / Parts; ++i)
      {
        UpperBounds& cell = grids.Jacobians[this->IndexOf(glm::ivec3(i, j, k))];
        for (int e = 0; e < 18; ++e)
        {
          cell.Jacobian[e] = std::max(cell.Jacobian[e], jacobian.Jacobian[e]);
        }
      }
    }
  }
}

//------------------------------------------------------------------------------
void DeformedSpaceBounds::FindFromRest(const PullBackBounds& bounds,
  const PullBackBounds& refined, const CellRange& refinedCells, const glm::ivec3& factors,
  const BSplineField& field, const ParallelFor& parallelFor, Grids& grids) const
{
  std::vector<AxisIntervals> axes;
  for (int a = 0; a < 3; ++a)
  {
    axes.emplace_back(field.GetFirstCell()[a], field.GetEndCell()[a], refinedCells.First[a],
      refinedCells.End[a], factors[a]);
  }
  // The neighbours share a sub-cell's faces: stay off them. But where the field has a kink in such
  // a face, what it does to the derivatives must be seen.
  const double inset = field.GetBorder() == BorderMode::ZeroAtBorder ? 0.0 : 1e-7;
  // Intervals of rest space map to any cells: each thread has grids of its own. A few parts only, as
  // these have to be put together.
  const std::size_t slices = static_cast<std::size_t>(axes[2].Count());
  const std::size_t shares = std::min<std::size_t>(slices, 8);
  std::mutex mutex;
  RunFor(parallelFor, shares,
    [&](std::size_t firstShare, std::size_t lastShare)
    {
      const std::size_t first = slices * firstShare / shares;
      const std::size_t last = slices * lastShare / shares;
      Grids mine = this->EmptyGrids();
      for (int k = static_cast<int>(first); k < static_cast<int>(last); ++k)
      {
        for (int j = 0; j < axes[1].Count(); ++j)
        {
          for (int i = 0; i < axes[0].Count(); ++i)
          {
            const glm::ivec3 at(i, j, k);
            Box rest;
            for (int a = 0; a < 3; ++a)
            {
              const double h = field.GetSpacing()[a];
              const double from = field.GetOrigin()[a] + (axes[a].Ends[at[a]] + inset) * h;
              const double to = field.GetOrigin()[a] + (axes[a].Ends[at[a] + 1] - inset) * h;
              rest.Min[a] = std::max(-1e300, std::min(from, to));
              rest.Max[a] = std::min(1e300, std::max(from, to));
            }
            const bool inside = axes[0].IsRefined(i) && axes[1].IsRefined(j) && axes[2].IsRefined(k);
            const PullBackBounds& source = inside ? refined : bounds;
            const MapBounds here = source.Over(rest);
            const Box moves = source.DisplacementOver(rest);
            const glm::ivec3 from = this->PartOf(rest.Min + moves.Min);
            const glm::ivec3 to = this->PartOf(rest.Max + moves.Max);
            this->Include(here, from, to, mine);
          }
        }
      }
      const std::lock_guard<std::mutex> lock(mutex);
      grids.Include(mine);
    });
}

//------------------------------------------------------------------------------
void DeformedSpaceBounds::Encode(const Grids& grids)
{
  constexpr float LargestCode = 254.0f;
  this->Jacobians.resize(grids.Jacobians.size());
  for (int e = 0; e < 18; ++e)
  {
    float least = Infinity;
    float most = -Infinity;
    for (const UpperBounds& cell : grids.Jacobians)
    {
      const float value = cell.Jacobian[e];
      least = std::isfinite(value) ? std::min(least, value) : least;
      most = std::isfinite(value) ? std::max(most, value) : most;
    }
    this->Least[e] = std::isfinite(least) ? least : 0.0f;
    // A step more than needed, for rounding.
    this->Step[e] = most > least ? (most - least) / (LargestCode - 1.0f) : 0.0f;
    for (std::size_t i = 0; i < grids.Jacobians.size(); ++i)
    {
      const float value = grids.Jacobians[i].Jacobian[e];
      float code = value > this->Least[e] && this->Step[e] > 0.0f
        ? std::ceil((value - this->Least[e]) / this->Step[e])
        : 0.0f;
      code += this->Least[e] + code * this->Step[e] < value ? 1.0f : 0.0f;
      // Cells that nothing maps into have no bounds, and what is not a number has none either.
      const bool bounded = value == -Infinity || (value <= most && code <= LargestCode);
      this->Jacobians[i].Entry[e] = static_cast<std::uint8_t>(bounded ? code : LargestCode + 1.0f);
    }
  }
  UpperDerivatives largest{ 0.0f, 0.0f };
  for (const UpperDerivatives& part : grids.Derivatives)
  {
    largest.Second =
      std::isfinite(part.Second) ? std::max(largest.Second, part.Second) : largest.Second;
    largest.Third =
      std::isfinite(part.Third) ? std::max(largest.Third, part.Third) : largest.Third;
  }
  this->SecondPowers.Set(largest.Second);
  this->ThirdPowers.Set(largest.Third);
  this->Derivatives.reserve(grids.Derivatives.size());
  for (const UpperDerivatives& part : grids.Derivatives)
  {
    this->Derivatives.push_back(
      { this->SecondPowers.Encode(part.Second), this->ThirdPowers.Encode(part.Third) });
  }
}

//------------------------------------------------------------------------------
MapBounds DeformedSpaceBounds::Over(const Box& box) const
{
  MapBounds bounds;
  if (this->Identity)
  {
    return bounds;
  }
  const glm::ivec3 from = this->PartOf(box.Min);
  const glm::ivec3 to = this->PartOf(box.Max);
  DerivativeCode derivatives{ 255, 255 };
  for (int k = from.z; k <= to.z; ++k)
  {
    for (int j = from.y; j <= to.y; ++j)
    {
      const DerivativeCode* row = &this->Derivatives[this->IndexOfPart(glm::ivec3(0, j, k))];
      for (int i = from.x; i <= to.x; ++i)
      {
        derivatives.Second = std::min(derivatives.Second, row[i].Second);
        derivatives.Third = std::min(derivatives.Third, row[i].Third);
      }
    }
  }
  JacobianCode all = this->Jacobians[this->IndexOf(from / Parts)];
  for (int k = from.z / Parts; k <= to.z / Parts; ++k)
  {
    for (int j = from.y / Parts; j <= to.y / Parts; ++j)
    {
      for (int i = from.x / Parts; i <= to.x / Parts; ++i)
      {
        const JacobianCode& cell = this->Jacobians[this->IndexOf(glm::ivec3(i, j, k))];
        for (int e = 0; e < 18; ++e)
        {
          all.Entry[e] = std::max(all.Entry[e], cell.Entry[e]);
        }
      }
    }
  }
  const auto decode = [&](int e) -> double
  {
    const float code = all.Entry[e];
    return code > 254.0f ? Infinity : this->Least[e] + code * this->Step[e];
  };
  for (int e = 0; e < 9; ++e)
  {
    bounds.JacobianMin[e / 3][e % 3] = -decode(NegativeJacobian + e);
    bounds.JacobianMax[e / 3][e % 3] = decode(e);
  }
  bounds.SecondDerivative = this->SecondPowers.Value[derivatives.Second];
  bounds.ThirdDerivative = this->ThirdPowers.Value[derivatives.Third];
  return bounds;
}

} // namespace ffd
