// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDResampler.h"

#include "FFDScalarDispatch.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>

namespace ffd
{
namespace
{

/// Distance of the points where the inverse is solved for, in points of the grid.
constexpr int NodeStep = 4;

/// Positions outside of the volume by less than this, in voxels, count as inside, whatever the
/// border that is set, which counts up to the other one.
constexpr double LeastBorder = 1e-6;
constexpr double LargestBorder = 0.5;

/// Whole numbers that rounding hid.
double Snap(double value)
{
  const double whole = std::round(value);
  return std::abs(value - whole) <= 1e-9 ? whole : value;
}

int FloorDivide(int a, int b) { return a / b - (a % b != 0 && (a % b < 0) != (b < 0) ? 1 : 0); }

/// Weights of four equidistant nodes for the position t in [0, 1] between the middle two: the cubic
/// through them (Lagrange), error O(step^4).
void CubicThroughNodes(double t, double w[4])
{
  w[0] = -t * (t - 1.0) * (t - 2.0) / 6.0;
  w[1] = (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0;
  w[2] = -(t + 1.0) * t * (t - 2.0) / 2.0;
  w[3] = (t + 1.0) * t * (t - 1.0) / 6.0;
}

/// The type in which values of a scalar type are summed: integers of 8 and 16 bits fit exactly
/// into a float.
template <class T>
using Arithmetic = typename std::conditional<sizeof(T) <= 2, float, double>::type;

/// The convolution kernel of Catmull-Rom: interpolates, continuous first derivative.
template <class A>
void CatmullRom(double position, A w[4])
{
  const A t = static_cast<A>(position);
  const A s = A(1) - t;
  w[0] = A(-0.5) * t * s * s;
  w[1] = A(1) + t * t * (A(1.5) * t - A(2.5));
  w[2] = A(1) + s * s * (A(1.5) * s - A(2.5));
  w[3] = A(-0.5) * s * t * t;
}

template <class T, class A>
A Lerp(A a, A b, A t)
{
  // A voxel without weight does not count, be it not a number.
  if (std::is_floating_point<T>::value && (t == A(0) || t == A(1)))
  {
    return t == A(0) ? a : b;
  }
  return a + t * (b - a);
}

template <class T, class A>
T Convert(A value)
{
  if (std::is_floating_point<T>::value)
  {
    return static_cast<T>(value);
  }
  // The limits of 64 bits are no doubles: compare so that the cast is always defined.
  constexpr A lowest = static_cast<A>(std::numeric_limits<T>::lowest());
  constexpr A largest = static_cast<A>(std::numeric_limits<T>::max());
  const A rounded = value < A(0) ? value - A(0.5) : value + A(0.5);
  return rounded >= largest ? std::numeric_limits<T>::max()
    : rounded > lowest      ? static_cast<T>(rounded)
                            : std::numeric_limits<T>::lowest();
}

/// Positions of a row in the volume, index coordinates.
struct RowPositions
{
  std::vector<double> X;
  std::vector<double> Y;
  std::vector<double> Z;

  void Resize(std::size_t count)
  {
    this->X.resize(count);
    this->Y.resize(count);
    this->Z.resize(count);
  }
};

template <class T>
class RowSampler
{
  using A = Arithmetic<T>;

public:
  RowSampler(const VolumeView& volume, const ResampleSettings& settings)
    : Voxels(static_cast<const T*>(volume.Scalars))
    , Volume(volume)
    , Components(static_cast<int>(volume.Increments[0]))
    , Background(Convert<T, double>(settings.Background))
    , Upper(volume.UpperIndex())
    , Interpolation(settings.Interpolation)
  {
    for (int a = 0; a < 3; ++a)
    {
      const double border = settings.Border * glm::length(glm::row(volume.DataToIndex, a));
      this->Border[a] = std::min(LeastBorder + border, LargestBorder);
    }
  }

  void Sample(const RowPositions& row, int count, T* out) const
  {
    switch (this->Interpolation)
    {
      case ResampleInterpolation::Nearest:
        this->ForEach(row, count, out, [this](const double q[3], T* to) { this->Nearest(q, to); });
        break;
      case ResampleInterpolation::Cubic:
        this->ForEach(row, count, out, [this](const double q[3], T* to) { this->Cubic(q, to); });
        break;
      case ResampleInterpolation::Linear:
      default:
        this->ForEach(row, count, out, [this](const double q[3], T* to) { this->Linear(q, to); });
    }
  }

private:
  template <class Sampler>
  void ForEach(const RowPositions& row, int count, T* out, const Sampler& sampler) const
  {
    for (int i = 0; i < count; ++i, out += this->Components)
    {
      double q[3] = { row.X[i], row.Y[i], row.Z[i] };
      bool inside = true;
      for (int a = 0; a < 3; ++a)
      {
        // False for what is not a number, too.
        inside = inside && q[a] >= -this->Border[a] && q[a] <= this->Upper[a] + this->Border[a];
        q[a] = std::min(std::max(q[a], 0.0), this->Upper[a]);
      }
      if (inside)
      {
        sampler(q, out);
      }
      else
      {
        std::fill_n(out, this->Components, this->Background);
      }
    }
  }

  void Nearest(const double q[3], T* out) const
  {
    std::int64_t offset = 0;
    for (int a = 0; a < 3; ++a)
    {
      offset += static_cast<int>(q[a] + 0.5) * this->Volume.Increments[a];
    }
    std::copy_n(this->Voxels + offset, this->Components, out);
  }

  void Linear(const double q[3], T* out) const
  {
    std::int64_t offset = 0;
    double t[3];
    for (int a = 0; a < 3; ++a)
    {
      const int cell = std::min(static_cast<int>(q[a]), this->Volume.Dimensions[a] - 2);
      offset += cell * this->Volume.Increments[a];
      t[a] = q[a] - cell;
    }
    const std::int64_t x = this->Volume.Increments[0];
    const std::int64_t y = this->Volume.Increments[1];
    const std::int64_t z = this->Volume.Increments[2];
    const A tx = static_cast<A>(t[0]);
    const A ty = static_cast<A>(t[1]);
    const A tz = static_cast<A>(t[2]);
    const auto line = [tx, x](const T* p) {
      return Lerp<T, A>(static_cast<A>(p[0]), static_cast<A>(p[x]), tx);
    };
    for (int c = 0; c < this->Components; ++c)
    {
      const T* const p = this->Voxels + offset + c;
      const A low = Lerp<T, A>(line(p), line(p + y), ty);
      const A high = Lerp<T, A>(line(p + z), line(p + z + y), ty);
      out[c] = Convert<T, A>(Lerp<T, A>(low, high, tz));
    }
  }

  void Cubic(const double q[3], T* out) const
  {
    std::int64_t offsets[3][4];
    A w[3][4];
    bool adjacent = this->Components == 1 && !std::is_floating_point<T>::value;
    for (int a = 0; a < 3; ++a)
    {
      const int last = this->Volume.Dimensions[a] - 1;
      const int cell = std::min(static_cast<int>(q[a]), last - 1);
      CatmullRom(q[a] - cell, w[a]);
      for (int n = 0; n < 4; ++n)
      {
        offsets[a][n] = std::min(std::max(cell - 1 + n, 0), last) * this->Volume.Increments[a];
      }
      adjacent = adjacent && (a > 0 || (cell >= 1 && cell + 2 <= last));
    }
    if (adjacent)
    {
      // The usual case, in a form that becomes four-lane instructions.
      A sum[4] = {};
      for (int k = 0; k < 4; ++k)
      {
        for (int j = 0; j < 4; ++j)
        {
          const T* const p = this->Voxels + offsets[0][0] + offsets[1][j] + offsets[2][k];
          const A weight = w[1][j] * w[2][k];
          for (int i = 0; i < 4; ++i)
          {
            sum[i] += weight * static_cast<A>(p[i]);
          }
        }
      }
      out[0] = Convert<T, A>(
        (w[0][0] * sum[0] + w[0][1] * sum[1]) + (w[0][2] * sum[2] + w[0][3] * sum[3]));
      return;
    }
    for (int c = 0; c < this->Components; ++c)
    {
      A sum = A(0);
      for (int n = 0; n < 64; ++n)
      {
        const int i = n % 4;
        const int j = n / 4 % 4;
        const int k = n / 16;
        const A weight = w[0][i] * w[1][j] * w[2][k];
        // As above: a voxel without weight does not count.
        if (weight != A(0))
        {
          sum += weight *
            static_cast<A>(this->Voxels[offsets[0][i] + offsets[1][j] + offsets[2][k] + c]);
        }
      }
      out[c] = Convert<T, A>(sum);
    }
  }

  const T* Voxels;
  const VolumeView& Volume;
  int Components;
  T Background;
  glm::dvec3 Upper;
  glm::dvec3 Border;
  ResampleInterpolation Interpolation;
};

/// { p + sign * d : p in `box`, d in `range` }.
Box Moved(const Box& box, const Box& range, double sign)
{
  return sign > 0.0 ? Box{ box.Min + range.Min, box.Max + range.Max }
                    : Box{ box.Min - range.Max, box.Max - range.Min };
}

Box Union(const Box& a, const Box& b) { return { glm::min(a.Min, b.Min), glm::max(a.Max, b.Max) }; }

} // namespace

//------------------------------------------------------------------------------
Box FindRestRegion(const PullBack& map, const PullBackBounds& bounds, const Box& deformed)
{
  if (map.IsIdentity() || deformed.IsEmpty())
  {
    return deformed;
  }
  const Box atDeformed = bounds.DisplacementOver(deformed);
  if (map.GetKind() == PullBackKind::FirstOrder)
  {
    return Moved(deformed, atDeformed, -1.0);
  }
  if (map.GetKind() == PullBackKind::Forward)
  {
    return Moved(deformed, atDeformed, 1.0);
  }
  // Q = P - D(Q): a box that holds Q bounds D(Q), which gives a smaller box.
  constexpr int iterations = 4;
  constexpr double large = 1e300;
  Box rest{ glm::dvec3(-large), glm::dvec3(large) };
  for (int i = 0; i < iterations; ++i)
  {
    const Box next = Moved(deformed, bounds.DisplacementOver(rest), -1.0);
    rest = { glm::max(rest.Min, next.Min), glm::min(rest.Max, next.Max) };
  }
  const glm::dvec3 slack(map.GetTolerance());
  rest = { rest.Min - slack, rest.Max + slack };
  // Points that do not converge are those of first order.
  if (map.GetKind() == PullBackKind::Exact)
  {
    return Union(rest, Moved(deformed, atDeformed, -1.0));
  }
  const Box atRest = bounds.DisplacementOver(rest);
  return Union(Moved(deformed, { atRest.Min - slack, atRest.Max + slack }, 1.0),
    Moved(deformed, atDeformed, 1.0));
}

//------------------------------------------------------------------------------
/// Rest positions of the points of one extent.
class Resampler::Extent
{
public:
  Extent(const Resampler& resampler, const glm::ivec3& first, const glm::ivec3& last)
    : Owner(resampler)
    , First(first)
    , Count(last - first + 1)
  {
    if (resampler.Map->IsIdentity())
    {
      return;
    }
    if (!resampler.Inverts())
    {
      this->Rows.reset(new SplineRows(*resampler.Map->GetField(), resampler.Grid, first.x, last.x));
      return;
    }
    if (resampler.Settings.UniqueInverse)
    {
      for (int a = 0; a < 3; ++a)
      {
        this->FirstNode[a] = FloorDivide(first[a], NodeStep) - 1;
        this->NodeCount[a] = FloorDivide(last[a], NodeStep) + 2 - this->FirstNode[a] + 1;
      }
    }
  }

  std::size_t GetNumberOfNodeRows() const
  {
    return static_cast<std::size_t>(this->NodeCount.y) *
      static_cast<std::size_t>(this->NodeCount.z);
  }

  /// Solve for the inverse at the nodes: displacements T^-1(P) - P.
  void SolveNodes(const ParallelFor& parallelFor)
  {
    this->Nodes.resize(static_cast<std::size_t>(this->NodeCount.x) * this->GetNumberOfNodeRows());
    // Also of the kind that reflects the inverse: the inverse itself is what is smooth and checked.
    const PullBack inverse(
      this->Owner.Map->GetField(), PullBackKind::Exact, this->Owner.Map->GetTolerance());
    parallelFor(this->GetNumberOfNodeRows(), [this, &inverse](std::size_t from, std::size_t to) {
      for (std::size_t row = from; row < to; ++row)
      {
        const int j = static_cast<int>(row % static_cast<std::size_t>(this->NodeCount.y));
        const int k = static_cast<int>(row / static_cast<std::size_t>(this->NodeCount.y));
        glm::dvec3* const nodes = &this->Nodes[row * static_cast<std::size_t>(this->NodeCount.x)];
        for (int i = 0; i < this->NodeCount.x; ++i)
        {
          const glm::dvec3 p =
            this->Owner.Grid.ToData(glm::dvec3((this->FirstNode + glm::ivec3(i, j, k)) * NodeStep));
          PullBackStatus status;
          nodes[i] = inverse.Evaluate(p, status) - p;
        }
      }
    });
  }

  /// Finds the rest positions of the points of row (j, k), in the volume. Adds the unconverged
  /// ones.
  void FindPositions(
    int j, int k, SplineRows::Scratch& scratch, RowPositions& row, std::int64_t& unconverged) const
  {
    const PullBack& map = *this->Owner.Map;
    const int count = this->Count.x;
    row.Resize(static_cast<std::size_t>(count));
    const double sign = map.GetKind() == PullBackKind::FirstOrder ? -1.0 : 1.0;
    if (map.IsIdentity())
    {
      std::fill(row.X.begin(), row.X.end(), 0.0);
      std::fill(row.Y.begin(), row.Y.end(), 0.0);
      std::fill(row.Z.begin(), row.Z.end(), 0.0);
    }
    else if (this->Rows)
    {
      this->Rows->Displacements(j, k, sign * this->Owner.Volume->DataToIndex, scratch, row.X.data(),
        row.Y.data(), row.Z.data());
    }
    else
    {
      this->FindInverses(j, k, scratch, row, unconverged);
    }
    const glm::dmat3& m = this->Owner.ToVolume;
    const glm::dvec3 start =
      this->Owner.ToVolumeOffset + m[1] * static_cast<double>(j) + m[2] * static_cast<double>(k);
    for (int i = 0; i < count; ++i)
    {
      const double at = this->First.x + i;
      row.X[i] += start.x + m[0].x * at;
      row.Y[i] += start.y + m[0].y * at;
      row.Z[i] += start.z + m[0].z * at;
      if (map.GetDomain() &&
        !map.GetDomain()->Contains(this->Owner.Grid.ToData(glm::dvec3(at, j, k))))
      {
        row.X[i] = std::numeric_limits<double>::infinity();
      }
    }
  }

private:
  /// As above for the kinds that invert T: Phi(P) - P in index coordinates.
  void FindInverses(
    int j, int k, SplineRows::Scratch& scratch, RowPositions& row, std::int64_t& unconverged) const
  {
    const PullBack& map = *this->Owner.Map;
    const bool reflected = map.GetKind() == PullBackKind::FirstOrderOfInverse;
    std::vector<glm::dvec3>& line = scratch.Lines[0];
    if (!this->Nodes.empty())
    {
      this->CollapseNodes(j, k, line);
    }
    for (int i = 0; i < this->Count.x; ++i)
    {
      const glm::dvec3 p = this->Owner.Grid.ToData(glm::dvec3(this->First.x + i, j, k));
      glm::dvec3 u(0.0);
      bool found = false;
      if (!this->Nodes.empty())
      {
        const int index = this->First.x + i;
        const int cell = FloorDivide(index, NodeStep);
        double w[4];
        CubicThroughNodes(static_cast<double>(index - cell * NodeStep) / NodeStep, w);
        const glm::dvec3* const nodes =
          &line[static_cast<std::size_t>(cell - 1 - this->FirstNode.x)];
        u = w[0] * nodes[0] + w[1] * nodes[1] + w[2] * nodes[2] + w[3] * nodes[3];
        // T(P + u) - P; false for what is not a number, too.
        found = glm::length(u + map.GetField()->Displacement(p + u)) <= map.GetTolerance();
        u = reflected ? -u : u;
      }
      if (!found && this->Owner.Inverse)
      {
        glm::dvec3 q;
        int evaluations = 0;
        unconverged += this->Owner.Inverse->Solve(p, p, q, evaluations) ? 0 : 1;
        u = reflected ? p - q : q - p;
      }
      else if (!found)
      {
        PullBackStatus status;
        u = map.Evaluate(p, status) - p;
        unconverged += status.Converged ? 0 : 1;
      }
      const glm::dvec3 d = this->Owner.Volume->DataToIndex * u;
      row.X[i] = d.x;
      row.Y[i] = d.y;
      row.Z[i] = d.z;
    }
  }

  /// The nodes summed over the two slower axes, for one row.
  void CollapseNodes(int j, int k, std::vector<glm::dvec3>& line) const
  {
    const int cellY = FloorDivide(j, NodeStep);
    const int cellZ = FloorDivide(k, NodeStep);
    double wy[4];
    double wz[4];
    CubicThroughNodes(static_cast<double>(j - cellY * NodeStep) / NodeStep, wy);
    CubicThroughNodes(static_cast<double>(k - cellZ * NodeStep) / NodeStep, wz);
    line.assign(static_cast<std::size_t>(this->NodeCount.x), glm::dvec3(0.0));
    for (int n = 0; n < 4; ++n)
    {
      for (int m = 0; m < 4; ++m)
      {
        const double weight = wy[m] * wz[n];
        const std::size_t from = static_cast<std::size_t>(cellY - 1 + m - this->FirstNode.y) +
          static_cast<std::size_t>(this->NodeCount.y) *
            static_cast<std::size_t>(cellZ - 1 + n - this->FirstNode.z);
        const glm::dvec3* const nodes = &this->Nodes[from * line.size()];
        for (std::size_t i = 0; i < line.size(); ++i)
        {
          line[i] += weight * nodes[i];
        }
      }
    }
  }

  const Resampler& Owner;
  glm::ivec3 First;
  glm::ivec3 Count;
  std::unique_ptr<SplineRows> Rows;
  glm::ivec3 FirstNode{ 0 }; // node n lies at index n * NodeStep
  glm::ivec3 NodeCount{ 0 };
  std::vector<glm::dvec3> Nodes; // x fastest
};

//------------------------------------------------------------------------------
Resampler::Resampler(const VolumeView& volume, const PullBack& map, const ImageGrid& grid,
  const ResampleSettings& settings)
  : Volume(&volume)
  , Map(&map)
  , Grid(grid)
  , Settings(settings)
  , ToVolume(volume.DataToIndex * grid.IndexToData)
  , ToVolumeOffset(volume.ToIndex(grid.Origin))
{
  for (int a = 0; a < 3; ++a)
  {
    this->ToVolumeOffset[a] = Snap(this->ToVolumeOffset[a]);
    for (int b = 0; b < 3; ++b)
    {
      this->ToVolume[a][b] = Snap(this->ToVolume[a][b]);
    }
  }
  if (!map.IsIdentity() && this->Inverts() && !settings.UniqueInverse)
  {
    const Box rest =
      settings.Rest.IsEmpty() ? Box{ volume.LowerIndex(), volume.UpperIndex() } : settings.Rest;
    this->Inverse.reset(new OrientedInverse(*map.GetField(), map.GetTolerance(), volume, rest));
  }
}

//------------------------------------------------------------------------------
bool Resampler::Inverts() const { return InvertsTheField(this->Map->GetKind()); }

//------------------------------------------------------------------------------
std::int64_t Resampler::Resample(
  const glm::ivec3& first, const glm::ivec3& last, void* out, const ParallelFor& parallelFor) const
{
  const glm::ivec3 count = last - first + 1;
  if (count.x < 1 || count.y < 1 || count.z < 1)
  {
    return 0;
  }
  Extent extent(*this, first, last);
  extent.SolveNodes(parallelFor);
  std::atomic<std::int64_t> unconverged{ 0 };
  const std::size_t rows = static_cast<std::size_t>(count.y) * static_cast<std::size_t>(count.z);
  const std::size_t rowLength =
    static_cast<std::size_t>(count.x) * static_cast<std::size_t>(this->Volume->Increments[0]);
  DispatchScalarType(this->Volume->Type, [&](auto zero) {
    using T = decltype(zero);
    const RowSampler<T> sampler(*this->Volume, this->Settings);
    parallelFor(rows, [&](std::size_t from, std::size_t to) {
      SplineRows::Scratch scratch;
      RowPositions positions;
      std::int64_t missed = 0;
      for (std::size_t row = from; row < to; ++row)
      {
        const int j = first.y + static_cast<int>(row % static_cast<std::size_t>(count.y));
        const int k = first.z + static_cast<int>(row / static_cast<std::size_t>(count.y));
        extent.FindPositions(j, k, scratch, positions, missed);
        sampler.Sample(positions, count.x, static_cast<T*>(out) + row * rowLength);
      }
      unconverged += missed;
    });
  });
  return unconverged;
}

} // namespace ffd
