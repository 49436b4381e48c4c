// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// How far the pieces that deformed rays are cut into lie from the true curves, in voxels.
#ifndef PositionError_h
#define PositionError_h

#include "FFDCameraView.h"
#include "FFDCurvePiece.h"
#include "FFDDeformedSpaceBounds.h"
#include "FFDPolyline.h"
#include "FFDPullBack.h"
#include "FFDTileSpans.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace positionError
{

constexpr int TileSide = 16;
constexpr int NodesPerSide = 4;

/// Distances between pieces and the true curve Phi(P(t)) at the same t, voxels.
struct Tally
{
  double Largest = 0.0;
  double LargestSideways = 0.0; ///< the part across the piece: how far its line is from the curve
  double Sum = 0.0;
  std::int64_t Points = 0;
  std::int64_t Pieces = 0;
  double Length = 0.0; ///< of the pieces on their viewing rays, units of t
  // ERROR_BOUND only.
  std::int64_t Proven = 0;  ///< pieces whose bound is within the tolerance
  std::int64_t Lateral = 0;    ///< pieces that are interpolated between the nodes of the tile
  std::int64_t InQuarters = 0; ///< the same, between nodes of its quarters
  double LargestUnproven = 0.0;

  double Mean() const { return this->Points > 0 ? this->Sum / this->Points : 0.0; }

  void Add(const glm::dvec3& error, const glm::dvec3& along, bool proven = true)
  {
    const double distance = glm::length(error);
    if (!proven)
    {
      this->LargestUnproven = std::max(this->LargestUnproven, distance);
      return;
    }
    const double speed = glm::length(along);
    const double forward = speed > 0.0 ? glm::dot(error, along) / speed : 0.0;
    this->Largest = std::max(this->Largest, distance);
    this->LargestSideways = std::max(this->LargestSideways,
      std::sqrt(std::max(0.0, distance * distance - forward * forward)));
    this->Sum += distance;
    ++this->Points;
  }
};

/// A tile of 16 x 16 pixels, and the pull-back along its rays in index coordinates.
class Tile
{
public:
  Tile(const ffd::CameraView& camera, int x, int y, const glm::dmat4& worldToData,
    const ffd::PullBack& map, const glm::dmat3& dataToIndex)
    : Camera(camera)
    , X(x)
    , Y(y)
    , WorldToData(worldToData)
    , Map(map)
    , DataToIndex(dataToIndex)
  {
  }

  /// The ray through pixel (x, y) of the tile; between pixels for the nodes.
  void GetRay(double x, double y, glm::dvec3& origin, glm::dvec3& direction) const
  {
    const ffd::ViewRay ray = this->Camera.MakeRay(this->X + x + 0.5, this->Y + y + 0.5);
    origin = glm::dvec3(this->WorldToData * glm::dvec4(ray.Origin, 1.0));
    direction = glm::dvec3(this->WorldToData * glm::dvec4(ray.Direction, 0.0));
  }

  /// Where the point at t of the ray through (x, y) comes from.
  glm::dvec3 PullBack(double x, double y, double t) const
  {
    glm::dvec3 origin;
    glm::dvec3 direction;
    this->GetRay(x, y, origin, direction);
    ffd::PullBackStatus status;
    return this->DataToIndex * this->Map.Evaluate(origin + t * direction, status);
  }

  /// The same, interpolated between the 4 x 4 nodes of the tile, or of the quarter that pixel lies
  /// in, as the packet kernels do.
  glm::dvec3 InterpolatedPullBack(double x, double y, double t, bool inQuarter) const
  {
    const int side = inQuarter ? TileSide / 2 : TileSide;
    const double left = inQuarter && x >= side ? side : 0.0;
    const double low = inQuarter && y >= side ? side : 0.0;
    const double step = (side - 1) / static_cast<double>(NodesPerSide - 1);
    const std::array<double, NodesPerSide> wx = Weights((x - left) / step);
    const std::array<double, NodesPerSide> wy = Weights((y - low) / step);
    glm::dvec3 sum(0.0);
    for (int j = 0; j < NodesPerSide; ++j)
    {
      for (int i = 0; i < NodesPerSide; ++i)
      {
        sum += wx[i] * wy[j] * this->PullBack(left + i * step, low + j * step, t);
      }
    }
    return sum;
  }

  /// Begin the tile as RayCaster does.
  void Start(ffd::TileSpans& spans, const ffd::DeformedSpaceBounds& bounds,
    ffd::SpanSettings settings, double tMin, double tMax) const
  {
    ffd::SetDirectionBends(settings, this->Camera, glm::dmat3(this->WorldToData));
    glm::dvec3 origins[4];
    glm::dvec3 directions[4];
    for (int c = 0; c < 4; ++c)
    {
      this->GetRay(
        c & 1 ? TileSide - 1 : 0, c & 2 ? TileSide - 1 : 0, origins[c], directions[c]);
    }
    spans.Start(bounds, settings, this->DataToIndex, origins, directions, tMin, tMax);
  }

  /**
   * Measure piece `p` of span `index` on the ray through pixel (x, y), at `points` places. The
   * span's claim is whether its bound is within the tolerance.
   */
  void MeasureSpan(ffd::TileSpans& spans, const ffd::SpanSettings& settings, int index, int p,
    double x, double y, int points, Tally& tally) const
  {
    const ffd::TileSpans::Span& span = spans.Get(index);
    const double dt = settings.Length / (1 << span.Level);
    const double t0 = index * settings.Length + p * dt;
    const auto at = [&](double t)
    {
      return span.Lateral || span.LateralInQuarters
        ? this->InterpolatedPullBack(x, y, t, span.LateralInQuarters)
        : this->PullBack(x, y, t);
    };
    const ffd::CurvePiece piece =
      ffd::CurvePiece::Parabola(at(t0), at(t0 + 0.5 * dt), at(t0 + dt));
    const bool proven = span.Bounded && span.PositionError <= settings.PositionTolerance;
    ++tally.Pieces;
    tally.Proven += proven ? 1 : 0;
    tally.Lateral += span.Lateral ? 1 : 0;
    tally.InQuarters += span.LateralInQuarters ? 1 : 0;
    tally.Length += dt;
    for (int i = 0; i <= points; ++i)
    {
      const double s = static_cast<double>(i) / points;
      tally.Add(piece.At(s) - this->PullBack(x, y, t0 + s * dt), piece.Velocity(s), proven);
    }
  }

  /// Measure the whole polyline of the ray through pixel (x, y).
  void MeasurePolyline(const ffd::PolylineSettings& settings, double x, double y, double from,
    double to, int points, Tally& tally) const
  {
    glm::dvec3 origin;
    glm::dvec3 direction;
    this->GetRay(x, y, origin, direction);
    ffd::PolylineWalker walker(this->Map, settings, origin, direction, from, to, false);
    ffd::PolylineVertex start = walker.GetVertex();
    while (walker.Next())
    {
      const ffd::PolylineVertex end = walker.GetVertex();
      const ffd::CurvePiece piece =
        ffd::CurvePiece::Line(this->DataToIndex * start.Rest, this->DataToIndex * end.Rest);
      const double dt = end.T - start.T;
      ++tally.Pieces;
      tally.Length += dt;
      for (int i = 0; i <= points; ++i)
      {
        const double s = static_cast<double>(i) / points;
        tally.Add(piece.At(s) - this->PullBack(x, y, start.T + s * dt), piece.Linear);
      }
      start = end;
    }
  }

private:
  /// Cubic Lagrange weights of the nodes at x, in spacings of nodes.
  static std::array<double, NodesPerSide> Weights(double x)
  {
    std::array<double, NodesPerSide> weights;
    for (int i = 0; i < NodesPerSide; ++i)
    {
      weights[i] = 1.0;
      for (int j = 0; j < NodesPerSide; ++j)
      {
        weights[i] *= i == j ? 1.0 : (x - j) / (i - j);
      }
    }
    return weights;
  }

  ffd::CameraView Camera;
  int X;
  int Y;
  glm::dmat4 WorldToData;
  const ffd::PullBack& Map;
  glm::dmat3 DataToIndex;
};

} // namespace positionError

#endif
