// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The nodes of interpolants. Included once per target of Highway.
#if defined(FFD_SIMD_NODES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_NODES_INL_H_
#undef FFD_SIMD_NODES_INL_H_
#else
#define FFD_SIMD_NODES_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDTileSegment.h"

#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPullBack-inl.h"
#include "FFDSimdRays-inl.h"

#include <array>
#include <cmath>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Viewing rays through the 4 x 4 nodes of a square of pixels, the outermost pixels included.
struct NodeRays
{
  alignas(64) NodeVectors Origins;    ///< local coordinates
  alignas(64) NodeVectors Directions; ///< local coordinates per unit of t

  /// (x0, y0): first pixel of the square; `at`: columns and rows of the nodes, 0 to 1.
  NodeRays(const PacketRays& image, int x0, int y0, int side, const float at[4])
  {
    const Df d;
    HWY_ALIGN float x[TileNodes];
    HWY_ALIGN float y[TileNodes];
    // Rounded as in the whole image: taking its columns and rows off again is exact.
    const float left = image.Column + static_cast<float>(x0) + 0.5f;
    const float low = image.Row + static_cast<float>(y0) + 0.5f;
    for (int i = 0; i < TileNodes; ++i)
    {
      x[i] = left + at[i % NodesPerSide] * static_cast<float>(side - 1) - image.Column;
      y[i] = low + at[i / NodesPerSide] * static_cast<float>(side - 1) - image.Row;
    }
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      Vf unused;
      const RayPacket rays = MakeRays(image, hn::Load(d, x + i), hn::Load(d, y + i), unused);
      StoreNodes(rays.Origin, this->Origins, i);
      StoreNodes(rays.Direction, this->Directions, i);
    }
  }

  HWY_INLINE Vec3 At(Vf t, std::size_t first) const
  {
    return MulAdd(t, LoadNodes(this->Directions, first), LoadNodes(this->Origins, first));
  }
};

/// Positions of the columns and rows of nodes in the square, 0 to 1.
constexpr float NodeAt[4] = { 0.0f, 1.0f / 3.0f, 2.0f / 3.0f, 1.0f };

/// The viewing rays of a square of tiles, whose first pixel is (X0, Y0).
struct RootRays
{
  const PacketRays& Image;
  int X0;
  int Y0;

  /// Those of a segment; `at`: columns and rows of the nodes, 0 to 1.
  NodeRays Find(const TileSegment& segment, const float at[4]) const
  {
    return NodeRays(this->Image, this->X0 + segment.X, this->Y0 + segment.Y, segment.Side, at);
  }

  /// The width of the square of pixels in the middle of the segment, data units.
  float FindWidth(const TileSegment& segment) const
  {
    const NodeRays rays = this->Find(segment, NodeAt);
    float squared = 0.0f;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const auto at = [&](std::size_t i) {
        return rays.Origins[a][i] + (segment.T0 + 0.5f * segment.Dt) * rays.Directions[a][i];
      };
      const float path = at(15) - at(0);
      squared += path * path;
    }
    return std::sqrt(0.5f * squared);
  }
};

/// The nodes of a segment, by layers.
using NodeLayers = std::array<NodeVectors, TileLayers>;

/// Pulls the nodes of segments back.
class NodeSolver
{
public:
  /// Keeps references.
  NodeSolver(const PacketScene& scene, CastStatistics& statistics)
    : Scene(scene)
    , Statistics(statistics)
  {
  }

  /// Pulls the nodes at t back to index coordinates of the whole; `layer`: on entry estimates of
  /// them.
  HWY_NOINLINE void Solve(const NodeRays& rays, float t, NodeVectors& layer)
  {
    const Df d;
    const Mf all = hn::FirstN(d, hn::Lanes(d));
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const Vec3 q = PullBackFrom(this->Scene, rays.At(Splat(t), i),
        WholeToLocal(this->Scene, LoadNodes(layer, i)), this->Scene.NodeTolerance, all,
        this->Statistics);
      StoreNodes(LocalToWhole(this->Scene, q), layer, i);
    }
  }

  /// Pulls the layers of a segment back without estimates, front to back; each one is estimated
  /// from those before it. Returns false as soon as nodes of a shared root have no pull-back: it
  /// would not be close enough.
  HWY_NOINLINE bool SolveAnew(const NodeRays& rays, const TileSegment& segment, NodeLayers& layers)
  {
    const Df d;
    const Mf all = hn::FirstN(d, hn::Lanes(d));
    const float step = 0.25f * segment.Dt;
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const Vec3 path = Scale(Splat(step), LoadNodes(rays.Directions, i));
      Vec3 q[TileLayers];
      Vec3 move = path;
      for (int k = 0; k < TileLayers; ++k)
      {
        const Vec3 p = rays.At(Splat(segment.T0 + step * static_cast<float>(k)), i);
        // The first layer starts without an estimate, not from the segment before: a segment must
        // not depend on where the rays of a picture, or of a part of one, begin. The next ones
        // start from the polynomial through the layers before, with the derivative of the last one.
        Vec3 start;
        switch (k)
        {
          case 0:
            start = EstimatePullBack(this->Scene, p);
            break;
          case 1:
            start = Add(q[0], move);
            break;
          case 2:
            start = MulAdd(Splat(2.0f), move, q[0]);
            break;
          default:
            start = MulAdd(Splat(3.0f), Add(move, q[k - 2]),
              Scale(Splat(-0.5f), MulAdd(Splat(3.0f), q[k - 1], q[k - 3])));
            break;
        }
        move = path;
        q[k] = PullBackFrom(
          this->Scene, p, start, this->Scene.NodeTolerance, all, this->Statistics, &move);
        if (segment.Side > TileSide && !hn::AllFalse(d, IsNowhere(this->Scene, q[k])))
        {
          return false;
        }
        StoreNodes(LocalToWhole(this->Scene, q[k]), layers[static_cast<std::size_t>(k)], i);
      }
    }
    return true;
  }

private:
  const PacketScene& Scene;
  CastStatistics& Statistics;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
