// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPolyline_h
#define FFDPolyline_h

#include "FFDExport.h"
#include "FFDPullBack.h"

#include <glm/vec3.hpp>

#include <cstdint>

namespace ffd
{

/// Parameters of the greedy subdivision, section 4.5 of the paper.
struct PolylineSettings
{
  double AngleThreshold = 0.08726646259971647; ///< radians; the paper's 5 degrees
  double MinimumLength = 0.5;                  ///< of a segment on the viewing ray, units of t
  double MaximumLength = 8.0;
};

/// One vertex of the polyline: a point of the viewing ray and where it comes from.
struct PolylineVertex
{
  double T = 0.0;
  glm::dvec3 Rest{ 0.0 };     ///< Phi(P(T)), data coordinates
  glm::dmat3 Jacobian{ 1.0 }; ///< dPhi/dP there, when asked for
};

/**
 * GREEDY_ANGLE: walks a viewing ray P(t) = origin + t * direction (data coordinates) and yields
 * the vertices of its inversely deformed polyline one after the other, as section 4.5 of the paper
 * does: try twice the length of the last segment; halve while the new segment turns by more than
 * the threshold against the last one (at first against the viewing ray); never below the minimum
 * length nor above the maximum. The paper's pseudo-code clamps the length after it has placed the
 * point; here the point is placed at the clamped length.
 */
class FFD_RENDERING_EXPORT PolylineWalker
{
public:
  PolylineWalker(const PullBack& pullBack, const PolylineSettings& settings,
    const glm::dvec3& origin, const glm::dvec3& direction, double from, double to,
    bool withJacobian);

  const PolylineVertex& GetVertex() const { return this->Vertex; }

  /// Advance to the next vertex; false at the end of the ray.
  bool Next();

  std::int64_t GetEvaluations() const { return this->Evaluations; }
  std::int64_t GetUnconverged() const { return this->Unconverged; }

private:
  PolylineVertex Evaluate(double t);
  bool TurnsTooMuch(const glm::dvec3& segment) const;

  const PullBack& Map;
  PolylineSettings Settings;
  glm::dvec3 Origin;
  glm::dvec3 Direction;
  double End;
  bool WithJacobian;
  PolylineVertex Vertex;
  glm::dvec3 LastDirection;
  double LastLength;
  std::int64_t Evaluations = 0;
  std::int64_t Unconverged = 0;
};

} // namespace ffd

#endif
