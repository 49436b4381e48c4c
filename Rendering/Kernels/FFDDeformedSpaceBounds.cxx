// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDDeformedSpaceBounds.h"

#include "FFDEighthPowers.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <atomic>
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

/// Threads that scatter bounds over deformed space, each into grids of its own.
constexpr int LargestNumberOfShares = 16;

/// A float that is not below x.
float RoundUp(double x)
{
  const float single = static_cast<float>(x);
  return static_cast<double>(single) < x ? std::nextafter(single, Infinity) : single;
}

/// Where the sub-cells of one axis lie, in data coordinates.
struct AxisIntervals
{
  std::vector<double> Min;
  std::vector<double> Max;

  /// `first`, `end`: cells of the field, each cut into `parts`. The constant outside of them is
  /// there in either case; its ends are far away.
  AxisIntervals(const BSplineField& field, int axis, int first, int end, int parts)
  {
    constexpr double far = 1e300;
    const double origin = field.GetOrigin()[axis];
    const double h = field.GetSpacing()[axis];
    const int count = parts * (end - first);
    for (int i = 0; i < count + 2; ++i)
    {
      const auto endOf = [&](int interval) {
        return origin + (first + static_cast<double>(interval) / parts) * h;
      };
      const double from = i == 0 ? (h > 0.0 ? -far : far) : endOf(i - 1);
      const double to = i == count + 1 ? (h > 0.0 ? far : -far) : endOf(i);
      this->Min.push_back(std::min(from, to));
      this->Max.push_back(std::max(from, to));
    }
  }
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
    this->Value[power] = largest * EighthPower(power - 1) * 1.0001f;
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
  const int power = 1 + FindEighthPower(this->Value[1] / (1.0001f * value));
  return static_cast<std::uint8_t>(std::clamp(power, 1, 254));
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
  this->PartsPerUnit = 1.0 / this->PartSize;
  this->LastPart = static_cast<double>(Parts) * cells - 1.0;

  const Box needed = bounds.RegionsAreInRestSpace()
    ? Box{ rest.Min - this->Resolution, rest.Max + this->Resolution }
    : region;
  const CellRange neededCells = FindCells(field, needed);
  const glm::ivec3 factors(glm::clamp(glm::ceil(0.5 * spacing / this->PartSize), glm::dvec3(1.0),
    glm::dvec3(static_cast<double>(LargestFactor))));
  CellRange refinedCells;
  PullBackBounds refined;
  if (factors != glm::ivec3(1))
  {
    refinedCells = this->FindRefinedCells(bounds, field, neededCells);
  }
  if (glm::all(glm::lessThan(refinedCells.First, refinedCells.End)))
  {
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
  grids.Derivatives.assign(this->IndexOfPart(Parts * this->Cells), UpperDerivatives{ 0.0f, 0.0f });
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
  return cell == this->Cells ? slice * static_cast<std::size_t>(this->Cells.z)
                             : static_cast<std::size_t>(cell.x) +
      row * static_cast<std::size_t>(cell.y) + slice * static_cast<std::size_t>(cell.z);
}

//------------------------------------------------------------------------------
std::size_t DeformedSpaceBounds::IndexOfPart(const glm::ivec3& part) const
{
  const glm::ivec3 parts = Parts * this->Cells;
  const std::size_t row = static_cast<std::size_t>(parts.x);
  const std::size_t slice = row * static_cast<std::size_t>(parts.y);
  return part == parts ? slice * static_cast<std::size_t>(parts.z)
                       : static_cast<std::size_t>(part.x) + row * static_cast<std::size_t>(part.y) +
      slice * static_cast<std::size_t>(part.z);
}

//------------------------------------------------------------------------------
glm::ivec3 DeformedSpaceBounds::PartOf(const glm::dvec3& p) const
{
  return { this->PartOf(0, p.x), this->PartOf(1, p.y), this->PartOf(2, p.z) };
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
  const glm::ivec3 firstCell = field.GetFirstCell();
  for (int k = all.First.z; k < all.End.z; ++k)
  {
    for (int j = all.First.y; j < all.End.y; ++j)
    {
      for (int i = all.First.x; i < all.End.x; ++i)
      {
        // Its eight sub-cells.
        const glm::ivec3 cell(i, j, k);
        const glm::ivec3 at = 2 * (cell - firstCell) + 1;
        double third = 0.0;
        for (int row = 0; row < 4; ++row)
        {
          const SubCellBounds* two = &bounds.GetSubCell({ at.x, at.y + row % 2, at.z + row / 2 });
          third = std::max<double>(
            { third, two[0].Value[SubCellBounds::Third], two[1].Value[SubCellBounds::Third] });
        }
        if (!(third <= enough))
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
void DeformedSpaceBounds::FindOverCells(const PullBackBounds& bounds, const PullBackBounds& refined,
  const CellRange& refinedCells, const BSplineField& field, const ParallelFor& parallelFor,
  Grids& grids) const
{
  const glm::dvec3 one = field.GetOrigin() + glm::dvec3(refinedCells.First) * field.GetSpacing();
  const glm::dvec3 other = field.GetOrigin() + glm::dvec3(refinedCells.End) * field.GetSpacing();
  const bool anyRefined = glm::all(glm::lessThan(refinedCells.First, refinedCells.End));
  const Box closely{ glm::min(one, other), glm::max(one, other) };
  const glm::ivec3 parts = Parts * this->Cells;
  // A slice of cells is written to by one thread only.
  RunFor(
    parallelFor, static_cast<std::size_t>(this->Cells.z), [&](std::size_t first, std::size_t last) {
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
              float& lower = cell.Jacobian[SubCellBounds::NegatedJacobianMin + e];
              float& upper = cell.Jacobian[SubCellBounds::JacobianMax + e];
              lower = std::max(lower, RoundUp(-here.JacobianMin[e / 3][e % 3]));
              upper = std::max(upper, RoundUp(here.JacobianMax[e / 3][e % 3]));
            }
          }
        }
      }
    });
}

//------------------------------------------------------------------------------
/// Adds bounds over sub-cells of rest space to the grids of deformed space.
class DeformedSpaceBounds::Scatter
{
public:
  Scatter(const DeformedSpaceBounds& bounds, Grids& grids)
    : Bounds(bounds)
    , Cells(bounds.Cells)
    , To(grids)
  {
  }

  /// A row of sub-cells along x: `subCell` that of interval `first`. A kink in one of its faces
  /// takes all bounds from the higher derivatives.
  template <class HasKink>
  void AddRow(const SubCellBounds* subCell, const std::vector<AxisIntervals>& axes,
    const glm::ivec3& first, int end, const HasKink& hasKink)
  {
    const std::size_t y = static_cast<std::size_t>(first.y);
    const std::size_t z = static_cast<std::size_t>(first.z);
    for (int i = first.x; i < end; ++i, ++subCell)
    {
      const std::size_t x = static_cast<std::size_t>(i);
      const float* least = subCell->Value + SubCellBounds::NegatedMin;
      const float* most = subCell->Value + SubCellBounds::Max;
      glm::ivec3 from;
      glm::ivec3 to;
      from.x = this->Bounds.PartOf(0, axes[0].Min[x] - static_cast<double>(least[0]));
      from.y = this->Bounds.PartOf(1, axes[1].Min[y] - static_cast<double>(least[1]));
      from.z = this->Bounds.PartOf(2, axes[2].Min[z] - static_cast<double>(least[2]));
      to.x = this->Bounds.PartOf(0, axes[0].Max[x] + static_cast<double>(most[0]));
      to.y = this->Bounds.PartOf(1, axes[1].Max[y] + static_cast<double>(most[1]));
      to.z = this->Bounds.PartOf(2, axes[2].Max[z] + static_cast<double>(most[2]));
      const bool kink = hasKink(i);
      this->AddDerivatives(kink ? Infinity : subCell->Value[SubCellBounds::Second],
        kink ? Infinity : subCell->Value[SubCellBounds::Third], from, to);
      this->AddJacobian(subCell->Value, from, to);
    }
  }

private:
  void AddDerivatives(float second, float third, const glm::ivec3& from, const glm::ivec3& to)
  {
    const glm::ivec3 parts = Parts * this->Cells;
    for (int k = from.z; k <= to.z; ++k)
    {
      for (int j = from.y; j <= to.y; ++j)
      {
        UpperDerivatives* row = this->To.Derivatives.data() +
          static_cast<std::ptrdiff_t>(parts.x) * (j + static_cast<std::ptrdiff_t>(parts.y) * k);
        for (int i = from.x; i <= to.x; ++i)
        {
          row[i].Second = std::max(row[i].Second, second);
          row[i].Third = std::max(row[i].Third, third);
        }
      }
    }
  }

  void AddJacobian(const float* jacobian, const glm::ivec3& from, const glm::ivec3& to)
  {
    for (int k = from.z / Parts; k <= to.z / Parts; ++k)
    {
      for (int j = from.y / Parts; j <= to.y / Parts; ++j)
      {
        UpperBounds* row = this->To.Jacobians.data() +
          static_cast<std::ptrdiff_t>(this->Cells.x) *
            (j + static_cast<std::ptrdiff_t>(this->Cells.y) * k);
        for (int i = from.x / Parts; i <= to.x / Parts; ++i)
        {
          float* cell = row[i].Jacobian;
          for (int e = 0; e < 18; ++e)
          {
            cell[e] = std::max(cell[e], jacobian[e]);
          }
        }
      }
    }
  }

  const DeformedSpaceBounds& Bounds;
  const glm::ivec3 Cells;
  Grids& To;
};

//------------------------------------------------------------------------------
void DeformedSpaceBounds::FindFromRest(const PullBackBounds& bounds, const PullBackBounds& refined,
  const CellRange& refinedCells, const glm::ivec3& factors, const BSplineField& field,
  const ParallelFor& parallelFor, Grids& grids) const
{
  const bool anyRefined = glm::all(glm::lessThan(refinedCells.First, refinedCells.End));
  std::vector<AxisIntervals> axes;
  std::vector<AxisIntervals> refinedAxes;
  // Sub-cells that the refined ones stand for, and those whose faces have a kink.
  glm::ivec3 firstReplaced(0);
  glm::ivec3 endReplaced(0);
  glm::ivec3 firstSmooth(0);
  const glm::ivec3 size = bounds.GetSize();
  glm::ivec3 endSmooth = size;
  for (int a = 0; a < 3; ++a)
  {
    const int first = field.GetFirstCell()[a];
    axes.emplace_back(field, a, first, field.GetEndCell()[a], 2);
    if (anyRefined)
    {
      refinedAxes.emplace_back(
        field, a, refinedCells.First[a], refinedCells.End[a], 2 * factors[a]);
      firstReplaced[a] = 2 * (refinedCells.First[a] - first) + 1;
      endReplaced[a] = 2 * (refinedCells.End[a] - first) + 1;
    }
    if (field.GetBorder() == BorderMode::ZeroAtBorder && field.GetNodes()[a] > 1)
    {
      firstSmooth[a] = 2;
      endSmooth[a] = size[a] - 2;
    }
  }
  const auto includeSlice = [&](int k, Scatter& scatter) {
    const bool replacedSlice = k >= firstReplaced.z && k < endReplaced.z;
    const bool kinkInSlice = k < firstSmooth.z || k >= endSmooth.z;
    for (int j = 0; j < size.y; ++j)
    {
      const SubCellBounds* row = &bounds.GetSubCell({ 0, j, k });
      const bool kinkInRow = kinkInSlice || j < firstSmooth.y || j >= endSmooth.y;
      const auto hasKink = [&](
                             int i) { return kinkInRow || i < firstSmooth.x || i >= endSmooth.x; };
      const bool replaced = replacedSlice && j >= firstReplaced.y && j < endReplaced.y;
      const int first = replaced ? firstReplaced.x : size.x;
      const int end = replaced ? endReplaced.x : size.x;
      scatter.AddRow(row, axes, { 0, j, k }, first, hasKink);
      scatter.AddRow(row + end, axes, { end, j, k }, size.x, hasKink);
    }
  };
  // Without those on either side, which mean nothing.
  const auto includeRefinedSlice = [&](int k, Scatter& scatter) {
    const glm::ivec3 end = refined.GetSize() - 1;
    for (int j = 1; j < end.y; ++j)
    {
      scatter.AddRow(&refined.GetSubCell({ 1, j, k }), refinedAxes, { 1, j, k }, end.x,
        [](int) { return false; });
    }
  };
  // Sub-cells map to any cells: each thread has grids of its own. A few only, as these have to be
  // put together; they take slices as long as there are any.
  const int refinedSlices = anyRefined ? refined.GetSize().z - 2 : 0;
  const int slices = size.z + refinedSlices;
  std::atomic<int> next{ 0 };
  std::mutex mutex;
  RunFor(parallelFor, static_cast<std::size_t>(std::min(slices, LargestNumberOfShares)),
    [&](std::size_t, std::size_t) {
      int slice = next++;
      if (slice >= slices)
      {
        return;
      }
      Grids mine = this->EmptyGrids();
      Scatter scatter(*this, mine);
      for (; slice < slices; slice = next++)
      {
        if (slice < refinedSlices)
        {
          includeRefinedSlice(slice + 1, scatter);
        }
        else
        {
          includeSlice(slice - refinedSlices, scatter);
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
    largest.Third = std::isfinite(part.Third) ? std::max(largest.Third, part.Third) : largest.Third;
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
  const auto decode = [&](int e) -> double {
    const float code = all.Entry[e];
    return code > 254.0f ? Infinity : this->Least[e] + code * this->Step[e];
  };
  for (int e = 0; e < 9; ++e)
  {
    bounds.JacobianMin[e / 3][e % 3] = -decode(SubCellBounds::NegatedJacobianMin + e);
    bounds.JacobianMax[e / 3][e % 3] = decode(SubCellBounds::JacobianMax + e);
  }
  bounds.SecondDerivative = this->SecondPowers.Value[derivatives.Second];
  bounds.ThirdDerivative = this->ThirdPowers.Value[derivatives.Third];
  return bounds;
}

} // namespace ffd
