// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPacketTrace.h"

#include "FFDCurveSegment.h"
#include "FFDTileSegment.h"

#include <glm/common.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace ffd
{
namespace
{

constexpr int SubtileSide = TileSide / 2;

/// Interpolates the curve of a pixel of a segment: bicubic in the terms of its nodes.
CurveSegment FindCurve(const TileSegment& segment, int x, int y, const glm::dvec3& shift)
{
  const auto weigh = [&segment](int pixel, int first, double weights[NodesPerSide]) {
    const double at = (pixel - first) * (NodesPerSide - 1.0) / (segment.Side - 1);
    for (int i = 0; i < NodesPerSide; ++i)
    {
      weights[i] = 1.0;
      for (int j = 0; j < NodesPerSide; ++j)
      {
        weights[i] *= i == j ? 1.0 : (at - j) / (i - j);
      }
    }
  };
  double across[NodesPerSide];
  double up[NodesPerSide];
  weigh(x, segment.X, across);
  weigh(y, segment.Y, up);
  CurveSegment curve;
  for (int node = 0; node < TileNodes; ++node)
  {
    const double weight = across[node % NodesPerSide] * up[node / NodesPerSide];
    for (int k = 0; k < TileLayers; ++k)
    {
      for (int c = 0; c < 3; ++c)
      {
        const NodeVectors& terms = segment.Terms[static_cast<std::size_t>(k)];
        curve.Terms[k][c] +=
          weight * terms[static_cast<std::size_t>(c)][static_cast<std::size_t>(node)];
      }
    }
  }
  curve.Terms[0] -= shift;
  return curve;
}

/// Cuts the part of a curve from s = a to b, as a curve from 0 to 1.
CurveSegment Restrict(const CurveSegment& curve, double a, double b)
{
  CurveSegment part = curve;
  // Horner's scheme, once for each derivative at a.
  for (int k = 0; k < CurveSegment::NumberOfTerms; ++k)
  {
    for (int i = CurveSegment::NumberOfTerms - 2; i >= k; --i)
    {
      part.Terms[i] += a * part.Terms[i + 1];
    }
  }
  double power = 1.0;
  for (glm::dvec3& term : part.Terms)
  {
    term *= power;
    power *= b - a;
  }
  return part;
}

/// Collects the segments in which a pixel of the roots was cast, front to back.
void CollectSegments(
  const TileSegment& segment, int x, int y, std::vector<const TileSegment*>& segments)
{
  if (segment.Known == TileSegment::State::Halved)
  {
    CollectSegments(*segment.Children[0], x, y, segments);
    CollectSegments(*segment.Children[1], x, y, segments);
  }
  else if (segment.Known == TileSegment::State::Quartered)
  {
    for (const TileSegment* child : segment.Children)
    {
      if (x >= child->X && x < child->X + child->Side && y >= child->Y &&
        y < child->Y + child->Side)
      {
        CollectSegments(*child, x, y, segments);
      }
    }
  }
  else if (segment.Known != TileSegment::State::Unknown)
  {
    segments.push_back(&segment);
  }
}

} // namespace

//------------------------------------------------------------------------------
void TracePackets(const PacketCaster& packets, const CastScene& scene, const CastSettings& settings,
  const CastRay& ray, const CastImage& image, PacketScratch& scratch, RayPixel& pixel,
  TracedRay& traced)
{
  const int x = ray.X % TileSide;
  const int y = ray.Y % TileSide;
  const std::size_t rows = static_cast<std::size_t>(std::min(ray.Y - y + TileSide, image.Height));
  // Only pixels of the subtile are touched.
  const std::unique_ptr<float[]> colors(
    new float[4 * rows * static_cast<std::size_t>(image.Width)]);
  CastImage picture;
  picture.Width = image.Width;
  picture.Height = image.Height;
  picture.Colors = colors.get();
  std::vector<SampledPosition> positions;
  scratch.Positions = &positions;
  packets.RenderTile(ray.X - x, ray.Y - y, 1u << (x / SubtileSide + 2 * (y / SubtileSide)), picture,
    scratch, 0, NoDeadline);
  scratch.Positions = nullptr;
  positions.erase(std::remove_if(positions.begin(), positions.end(),
                    [&ray](const SampledPosition& at) { return at.X != ray.X || at.Y != ray.Y; }),
    positions.end());

  std::vector<const TileSegment*> segments;
  const int xInRoot = ray.X % packets.GetRootSide();
  const int yInRoot = ray.Y % packets.GetRootSide();
  for (const TileSegment* root : scratch.Roots.GetAll())
  {
    if (root)
    {
      CollectSegments(*root, xInRoot, yInRoot, segments);
    }
  }
  const VolumeView& volume = scene.Volume;
  const glm::dvec3 shift =
    scene.WholeAtRest ? -glm::round(volume.ToIndex(scene.WholeAtRest->Min)) : glm::dvec3(0.0);
  const double origin = scene.Camera.FindMiddleT(ray.Viewing, FindMiddle(scene));
  std::size_t next = 0;
  for (const TileSegment* segment : segments)
  {
    const double begin = segment->T0 + origin;
    const double from = std::max(begin, ray.From);
    const double to = std::min(begin + segment->Dt, ray.To);
    if (!(from < to))
    {
      continue;
    }
    const CurveSegment curve = Restrict(FindCurve(*segment, xInRoot, yInRoot, shift),
      (from - begin) / segment->Dt, (to - begin) / segment->Dt);
    pixel.NoteSegment(curve, from, to, segment->Known == TileSegment::State::Empty);
    const auto jacobianAt = [&](double s) {
      return scene.Map->FindJacobian(
        ray.At(from + s * (to - from)), volume.IndexToData * curve.At(s) + volume.FirstVoxel);
    };
    const JacobianSegment<decltype(jacobianAt)> sampled(volume, curve, from, to - from, jacobianAt);
    for (; next < positions.size() && positions[next].T + origin < to; ++next)
    {
      const SampledPosition& at = positions[next];
      const double t = at.T + origin;
      const double s = std::clamp((t - from) / (to - from), 0.0, 1.0);
      const double distance = settings.SampleDistance;
      const RayIntegrator::Outcome outcome =
        pixel.Integrator.AddSample(sampled, s, distance / (to - from));
      pixel.NoteSample(
        glm::dvec3(at.Index[0], at.Index[1], at.Index[2]), t, distance, false, outcome.Extinction);
    }
  }
  const float* color = colors.get() + 4 * (static_cast<std::size_t>(ray.Y) * image.Width + ray.X);
  traced.Color = glm::vec4(color[0], color[1], color[2], color[3]);
  traced.Terminated = 1.0f - traced.Color.a < settings.TerminationTransmittance;
}

} // namespace ffd
