// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFunctionFit.h"

#include "FFDBSplineField.h"
#include "FFDGridIndex.h"
#include "FFDParallelFor.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace ffd
{
namespace
{

constexpr int FirstCells = 4;
/// Cells of the grid of the first samples per axis: at least, and at most for the sake of details.
constexpr int FirstSteps = 16;
constexpr int MostFirstSteps = 64;
/// Errors up to this part of the tolerance leave nothing to look for.
constexpr double QuietPart = 0.25;
/// Samples that are taken at once, at most, but for a plane of a grid.
constexpr std::size_t SamplesAtOnce = 1 << 16;

constexpr float NotSampled = -1.0f;

/// A regular grid of samples over the box of a fit.
struct SampleGrid
{
  glm::ivec3 Steps{ 0 }; ///< per axis, one less than samples
  std::vector<glm::dvec3> Values;
  /// Of the net of before at the samples; NotSampled where the values are those of that net.
  std::vector<float> Errors;

  glm::ivec3 GetSize() const { return this->Steps + 1; }
};

/// Along how many axes a point lies between nodes. `beyond`: its number beyond the last node.
int CountBetween(const glm::ivec3& beyond)
{
  return (beyond.x != 0) + (beyond.y != 0) + (beyond.z != 0);
}

/// Calls work(at, index) for the points of a grid from `first` on, before `end`.
template <class Work>
void ForPoints(
  const glm::ivec3& first, const glm::ivec3& end, const glm::ivec3& size, const Work& work)
{
  for (int k = first.z; k < end.z; ++k)
  {
    for (int j = first.y; j < end.y; ++j)
    {
      for (int i = first.x; i < end.x; ++i)
      {
        work(glm::ivec3(i, j, k), GridIndex(i, j, k, size));
      }
    }
  }
}

} // namespace

class FunctionFit::Internals
{
public:
  FittedNet Fit;

  Internals(DisplacementSampler sampler, const glm::dvec3& lower, const glm::dvec3& extent)
    : Sampler(std::move(sampler))
  {
    this->Fit.Lower = lower;
    this->Fit.Extent = extent;
  }

  FitStatus Run(const FitLimits& limits)
  {
    this->Limits = limits;
    if (this->Status == FitStatus::NotReached)
    {
      if (!this->Refine())
      {
        return this->Status;
      }
    }
    else
    {
      this->Fit.Cells = glm::ivec3(std::min(FirstCells, limits.MaximumCells));
      if (!this->SamplePlaces() || !this->SampleAll(this->FindFirstSteps()))
      {
        return this->Status = FitStatus::NotFinite;
      }
    }
    for (double done = 0.0;; done = 0.5 * (1.0 + done))
    {
      if (limits.Proceed && !limits.Proceed(done))
      {
        return this->Status = FitStatus::Stopped;
      }
      this->Interpolate();
      if (!this->Test())
      {
        return this->Status = FitStatus::NotFinite;
      }
      this->Status =
        this->Fit.LargestError <= limits.Tolerance ? FitStatus::Reached : FitStatus::NotReached;
      if (this->Status == FitStatus::Reached || !this->Refine())
      {
        return this->Status;
      }
    }
  }

private:
  BSplineField GetField() const
  {
    return BSplineField(this->Fit.Net.Nodes, this->Fit.GetOrigin(), this->Fit.GetSpacing(),
      this->Fit.Net.Values.data());
  }

  glm::dvec3 PositionOf(const glm::ivec3& at, const glm::ivec3& steps) const
  {
    return this->Fit.Lower + glm::dvec3(at) * (this->Fit.Extent / glm::dvec3(steps));
  }

  glm::ivec3 FindFirstSteps() const
  {
    glm::ivec3 steps = 2 * this->Fit.Cells;
    for (int a = 0; a < 3; ++a)
    {
      const double detail = this->Sampler.Detail[a];
      const double wanted = detail > 0.0 ? this->Fit.Extent[a] / detail : 0.0;
      while (steps[a] < std::clamp<double>(wanted, FirstSteps, MostFirstSteps))
      {
        steps[a] *= 2;
      }
    }
    return steps;
  }

  /// Samples the places that lie in the box.
  bool SamplePlaces()
  {
    this->Places.clear();
    for (const glm::dvec3& place : this->Sampler.Places)
    {
      if (glm::all(glm::greaterThanEqual(place, this->Fit.Lower)) &&
        glm::all(glm::lessThanEqual(place, this->Fit.Lower + this->Fit.Extent)))
      {
        this->Places.push_back(place);
      }
    }
    this->PlaceErrors.assign(this->Places.size(), 0.0);
    return this->Places.empty() || this->Sampler.Sample(this->Places, this->PlaceValues);
  }

  /// Samples all points of a grid.
  bool SampleAll(const glm::ivec3& steps)
  {
    SampleGrid& grid = this->Grid;
    grid.Steps = steps;
    const glm::ivec3 size = grid.GetSize();
    std::vector<glm::dvec3> points;
    points.reserve(GridSize(size));
    ForPoints(glm::ivec3(0), size, size,
      [&](const glm::ivec3& at, std::size_t) { points.push_back(this->PositionOf(at, steps)); });
    grid.Errors.assign(points.size(), 0.0f);
    this->Open.assign(GridSize(this->Fit.Cells), 1);
    return this->Sampler.Sample(points, grid.Values);
  }

  /// Makes the net that meets the samples at the nodes.
  void Interpolate()
  {
    const glm::ivec3 stride = this->Grid.Steps / this->Fit.Cells;
    const glm::ivec3 size = this->Grid.GetSize();
    ControlNet nodes;
    nodes.Nodes = this->Fit.Cells + 1;
    nodes.Values.resize(GridSize(nodes.Nodes));
    ForPoints(
      glm::ivec3(0), nodes.Nodes, nodes.Nodes, [&](const glm::ivec3& at, std::size_t index) {
        nodes.Values[index] = this->Grid.Values[GridIndex(at * stride, size)];
      });
    this->Fit.Net = InterpolateControlNet(nodes);
  }

  /// Finds the errors of the net; false: the samples that it takes are not finite.
  bool Test()
  {
    this->ForgetErrors();
    const glm::ivec3 finer = glm::max(this->Grid.Steps, 2 * this->Fit.Cells);
    const glm::ivec3 apart = finer / (2 * this->Fit.Cells);
    // A net that errs halfway between its nodes need not be looked at everywhere.
    if (glm::all(glm::greaterThan(apart, glm::ivec3(1))))
    {
      this->TestGrid(apart);
    }
    if (this->Fit.LargestError <= this->Limits.Tolerance)
    {
      this->ForgetErrors();
      this->TestGrid(glm::ivec3(1));
      if (finer != this->Grid.Steps && !this->TestBetween(finer))
      {
        return false;
      }
    }
    this->TestPlaces();
    this->Fit.RootMeanSquareError =
      std::sqrt(this->Squares / static_cast<double>(std::max<std::size_t>(this->Tests, 1)));
    return true;
  }

  void ForgetErrors()
  {
    this->PerAxis = glm::dvec3(0.0);
    this->Squares = 0.0;
    this->Tests = 0;
    this->Fit.LargestError = 0.0;
  }

  void TestPlaces()
  {
    const BSplineField field = this->GetField();
    for (std::size_t p = 0; p < this->Places.size(); ++p)
    {
      this->PlaceErrors[p] =
        glm::distance(field.Displacement(this->Places[p]), this->PlaceValues[p]);
      this->Fit.LargestError = std::max(this->Fit.LargestError, this->PlaceErrors[p]);
      this->PerAxis = glm::max(this->PerAxis, this->PlaceErrors[p]);
    }
  }

  /// Finds the errors at the samples that there are, so many steps apart.
  void TestGrid(const glm::ivec3& apart)
  {
    SampleGrid& grid = this->Grid;
    const glm::ivec3 size = grid.GetSize();
    const glm::ivec3 stride = grid.Steps / this->Fit.Cells;
    if (stride == glm::ivec3(1))
    {
      std::fill(grid.Errors.begin(), grid.Errors.end(), 0.0f); // nodes
      return;
    }
    const ControlNet found = SampleControlNet(this->Fit.Net, stride / apart, this->Limits.Parallel);
    ForPoints(
      glm::ivec3(0), found.Nodes, found.Nodes, [&](const glm::ivec3& at, std::size_t index) {
        const std::size_t sample = GridIndex(at * apart, size);
        float& error = grid.Errors[sample];
        if (error != NotSampled)
        {
          error = static_cast<float>(glm::distance(found.Values[index], grid.Values[sample]));
        }
        this->Count(at * apart % stride, std::max(error, 0.0f));
      });
  }

  /// Counts the error at a point. `beyond`: its number beyond the last node along each axis.
  void Count(const glm::ivec3& beyond, double error)
  {
    const int between = CountBetween(beyond);
    if (between == 0)
    {
      return; // a node
    }
    this->Fit.LargestError = std::max(this->Fit.LargestError, error);
    this->Squares += error * error;
    ++this->Tests;
    for (int a = 0; a < 3 && between == 1; ++a)
    {
      if (beyond[a] != 0)
      {
        this->PerAxis[a] = std::max(this->PerAxis[a], error);
      }
    }
  }

  /**
   * Samples the points of a finer grid that beside the samples that there are touch open cells,
   * and finds the errors there. They are kept, with what the net has at the other points, if there
   * can be a finer net.
   */
  bool TestBetween(const glm::ivec3& steps)
  {
    const bool keeps =
      glm::any(glm::lessThan(this->Fit.Cells, glm::ivec3(this->Limits.MaximumCells)));
    SampleGrid finer;
    finer.Steps = steps;
    const glm::ivec3 size = finer.GetSize();
    const glm::ivec3 ratio = steps / this->Grid.Steps;
    if (keeps)
    {
      finer.Values.resize(GridSize(size));
      finer.Errors.assign(GridSize(size), NotSampled);
      const glm::ivec3 known = this->Grid.GetSize();
      ForPoints(glm::ivec3(0), known, known, [&](const glm::ivec3& at, std::size_t index) {
        const std::size_t sample = GridIndex(at * ratio, size);
        finer.Values[sample] = this->Grid.Values[index];
        finer.Errors[sample] = this->Grid.Errors[index];
      });
    }
    const std::size_t plane = GridSize({ size.x, size.y, 1 });
    const int planes = 1 + static_cast<int>(SamplesAtOnce / plane);
    for (int first = 0; first < size.z; first += planes)
    {
      const int count = std::min(planes, size.z - first);
      std::vector<std::vector<glm::ivec3>> places(static_cast<std::size_t>(count));
      this->Limits.Parallel(places.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
        {
          places[k] = this->FindOpenPoints(first + static_cast<int>(k), steps, ratio, keeps);
        }
      });
      if (!this->TestPoints(places, keeps, finer))
      {
        return false;
      }
    }
    // The other ones.
    this->Tests = GridSize(size) - GridSize(this->Fit.Cells + 1);
    if (keeps)
    {
      this->Predict(finer);
      this->Grid = std::move(finer);
    }
    return true;
  }

  /// The points of a plane of a grid that touch open cells, without those `ratio` steps apart;
  /// `all`: also those in the middle of faces of cells.
  std::vector<glm::ivec3> FindOpenPoints(
    int k, const glm::ivec3& steps, const glm::ivec3& ratio, bool all) const
  {
    const glm::ivec3 cells = this->Fit.Cells;
    const glm::ivec3 stride = steps / cells;
    const auto firstOf = [&](int at, int a) { return std::max(at - 1, 0) / stride[a]; };
    const auto lastOf = [&](int at, int a) { return std::min(at / stride[a], cells[a] - 1); };
    std::vector<glm::ivec3> points;
    std::vector<std::uint8_t> open(static_cast<std::size_t>(cells.x)); // of rows that touch one
    for (int j = 0; j <= steps.y; ++j)
    {
      std::fill(open.begin(), open.end(), std::uint8_t{ 0 });
      ForPoints({ 0, firstOf(j, 1), firstOf(k, 2) },
        { cells.x, lastOf(j, 1) + 1, lastOf(k, 2) + 1 }, cells,
        [&](const glm::ivec3& at, std::size_t index) {
          open[static_cast<std::size_t>(at.x)] |= this->Open[index];
        });
      for (int i = 0; i <= steps.x; ++i)
      {
        const glm::ivec3 at(i, j, k);
        if ((open[static_cast<std::size_t>(firstOf(i, 0))] != 0 ||
              open[static_cast<std::size_t>(lastOf(i, 0))] != 0) &&
          at % ratio != glm::ivec3(0) && (all || CountBetween(at % stride) != 2))
        {
          points.push_back(at);
        }
      }
    }
    return points;
  }

  /// Samples points of planes of a grid, and finds the errors there.
  bool TestPoints(const std::vector<std::vector<glm::ivec3>>& planes, bool keeps, SampleGrid& grid)
  {
    std::vector<glm::ivec3> places;
    for (const std::vector<glm::ivec3>& plane : planes)
    {
      places.insert(places.end(), plane.begin(), plane.end());
    }
    if (places.empty())
    {
      return true;
    }
    std::vector<glm::dvec3> points;
    points.reserve(places.size());
    for (const glm::ivec3& at : places)
    {
      points.push_back(this->PositionOf(at, grid.Steps));
    }
    std::vector<glm::dvec3> values;
    if (!this->Sampler.Sample(points, values))
    {
      return false;
    }
    const BSplineField field = this->GetField();
    std::vector<float> errors(points.size());
    this->Limits.Parallel(points.size(), [&](std::size_t first, std::size_t end) {
      for (std::size_t p = first; p < end; ++p)
      {
        errors[p] = static_cast<float>(glm::distance(field.Displacement(points[p]), values[p]));
      }
    });
    const glm::ivec3 stride = grid.Steps / this->Fit.Cells;
    for (std::size_t p = 0; p < places.size(); ++p)
    {
      this->Count(places[p] % stride, errors[p]);
      if (keeps)
      {
        const std::size_t index = GridIndex(places[p], grid.GetSize());
        grid.Values[index] = values[p];
        grid.Errors[index] = errors[p];
      }
    }
    return true;
  }

  /// What the net has where nothing was sampled.
  void Predict(SampleGrid& grid) const
  {
    const ControlNet found =
      SampleControlNet(this->Fit.Net, grid.Steps / this->Fit.Cells, this->Limits.Parallel);
    for (std::size_t n = 0; n < grid.Values.size(); ++n)
    {
      grid.Values[n] = grid.Errors[n] == NotSampled ? found.Values[n] : grid.Values[n];
    }
  }

  /// Gives the axes that err by their share twice the cells; when only the sum is too large, the
  /// worst one. False where that is not allowed, or where samples are not finite.
  bool Refine()
  {
    const int most = this->Limits.MaximumCells;
    const double worst = std::max({ this->PerAxis.x, this->PerAxis.y, this->PerAxis.z });
    const glm::ivec3 before = this->Fit.Cells;
    for (int a = 0; a < 3; ++a)
    {
      if (this->PerAxis[a] >= std::min(this->Limits.Tolerance / 3.0, worst))
      {
        this->Fit.Cells[a] = std::min(2 * this->Fit.Cells[a], most);
      }
    }
    if (this->Fit.Cells == before)
    {
      return false;
    }
    if (this->Grid.Steps % this->Fit.Cells != glm::ivec3(0))
    {
      // The finer samples were not kept, or MaximumCells is no power of two.
      if (!this->SampleAll(this->Fit.Cells))
      {
        this->Status = FitStatus::NotFinite;
        return false;
      }
      return true;
    }
    this->FindOpen();
    return true;
  }

  /// Finds the cells where the net of before erred.
  void FindOpen()
  {
    const double quiet = QuietPart * this->Limits.Tolerance;
    const glm::ivec3 cells = this->Fit.Cells;
    const glm::ivec3 stride = this->Grid.Steps / cells;
    const glm::ivec3 size = this->Grid.GetSize();
    this->Open.assign(GridSize(cells), 0);
    ForPoints(glm::ivec3(0), cells, cells, [&](const glm::ivec3& cell, std::size_t index) {
      const glm::ivec3 first = cell * stride;
      ForPoints(first, first + stride + 1, size, [&](const glm::ivec3&, std::size_t sample) {
        this->Open[index] |= this->Grid.Errors[sample] > quiet ? 1 : 0;
      });
    });
    for (std::size_t p = 0; p < this->Places.size(); ++p)
    {
      if (this->PlaceErrors[p] > quiet)
      {
        const glm::dvec3 at = (this->Places[p] - this->Fit.Lower) / this->Fit.GetSpacing();
        this->Open[GridIndex(glm::clamp(glm::ivec3(at), glm::ivec3(0), cells - 1), cells)] = 1;
      }
    }
  }

  const DisplacementSampler Sampler;
  FitLimits Limits;
  FitStatus Status = FitStatus::Stopped; ///< as of the last Run()
  SampleGrid Grid;
  std::vector<std::uint8_t> Open; ///< the cells of the net between whose nodes samples are taken
  std::vector<glm::dvec3> Places;
  std::vector<glm::dvec3> PlaceValues;
  std::vector<double> PlaceErrors;

  // Of the net that was tested last.
  glm::dvec3 PerAxis{ 0.0 }; ///< the largest errors between nodes along one axis, and at places
  double Squares = 0.0;
  std::size_t Tests = 0;
};

//------------------------------------------------------------------------------
FunctionFit::FunctionFit(
  DisplacementSampler sampler, const glm::dvec3& lower, const glm::dvec3& extent)
  : State(std::make_unique<Internals>(std::move(sampler), lower, extent))
{
}

//------------------------------------------------------------------------------
FunctionFit::~FunctionFit() = default;

//------------------------------------------------------------------------------
FitStatus FunctionFit::Run(const FitLimits& limits) { return this->State->Run(limits); }

//------------------------------------------------------------------------------
const FittedNet& FunctionFit::GetNet() const { return this->State->Fit; }

} // namespace ffd
