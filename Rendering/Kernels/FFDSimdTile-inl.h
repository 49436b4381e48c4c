// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Rays of a tile and the pull-back on its nodes. Included once per target of Highway.
#if defined(FFD_SIMD_TILE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_TILE_INL_H_
#undef FFD_SIMD_TILE_INL_H_
#else
#define FFD_SIMD_TILE_INL_H_
#endif

#include "FFDPacketCaster.h"
#include "FFDSamplePhase.h"

#include "FFDSimdMath-inl.h"
#include "FFDSimdSpline-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

constexpr int TileSide = 16;
constexpr int NodesPerSide = 4;
constexpr int TileNodes = NodesPerSide * NodesPerSide;

/// A packet of viewing rays, local coordinates: P(t) = Origin + t * Direction, t in world units.
struct RayPacket
{
  Vec3 Origin;
  Vec3 Direction;
  Vf From;
  Vf To;
};

/// The affine map from image positions to homogeneous local coordinates at one depth.
struct ImageMap
{
  float Base[4];
  float PerX[4];
  float PerY[4];

  ImageMap() = default;
  ImageMap(const glm::dmat4& ndcToLocal, const CameraView& camera, double ndcDepth)
  {
    const glm::dvec4 base =
      ndcToLocal * glm::dvec4(camera.NdcOrigin.x, camera.NdcOrigin.y, ndcDepth, 1.0);
    const glm::dvec4 perX = ndcToLocal[0] * camera.NdcPerPixel.x;
    const glm::dvec4 perY = ndcToLocal[1] * camera.NdcPerPixel.y;
    for (int c = 0; c < 4; ++c)
    {
      this->Base[c] = static_cast<float>(base[c]);
      this->PerX[c] = static_cast<float>(perX[c]);
      this->PerY[c] = static_cast<float>(perY[c]);
    }
  }

  HWY_INLINE Vec3 At(Vf x, Vf y) const
  {
    const auto component = [&](int c)
    {
      return hn::MulAdd(
        Splat(this->PerX[c]), x, hn::MulAdd(Splat(this->PerY[c]), y, Splat(this->Base[c])));
    };
    const Vf inverse = hn::Div(Splat(1.0f), component(3));
    return Scale(inverse, { component(0), component(1), component(2) });
  }
};

/// Rays through image positions, near plane to far plane.
HWY_INLINE RayPacket MakeRays(
  const PacketScene& scene, const ImageMap& near, const ImageMap& far, Vf x, Vf y)
{
  RayPacket rays;
  rays.Origin = near.At(x, y);
  const Vec3 path = Sub(far.At(x, y), rays.Origin);
  rays.From = hn::Zero(Df());
  rays.To = hn::Sqrt(Dot(path, path));
  rays.Direction = Scale(hn::Div(Splat(1.0f), rays.To), path);
  return rays;
}

/// Narrow [From, To] to the deformed bounds and the shown side of the clipping planes.
HWY_INLINE void ClipToBounds(const PacketScene& scene, RayPacket& rays)
{
  for (const std::array<float, 4>& plane : scene.ClippingPlanes)
  {
    const Vec3 normal{ Splat(plane[0]), Splat(plane[1]), Splat(plane[2]) };
    const Vf slope = Dot(normal, rays.Direction);
    const Vf start = hn::Add(Dot(normal, rays.Origin), Splat(plane[3]));
    const Vf zero = hn::Zero(Df());
    const Vf tiny = Splat(1e-30f);
    // A slope of zero becomes a very small one: then the plane cuts all of the ray away or nothing.
    const Mf up = hn::Ge(slope, zero);
    const Vf safe = hn::IfThenElse(up, hn::Max(slope, tiny), hn::Min(slope, hn::Neg(tiny)));
    const Vf t = hn::Neg(hn::Div(start, safe));
    rays.From = hn::IfThenElse(up, hn::Max(rays.From, t), rays.From);
    rays.To = hn::IfThenElse(up, rays.To, hn::Min(rays.To, t));
  }
  const auto clip = [&](Vf o, Vf v, float lo, float hi)
  {
    // A direction of zero becomes a very small one: then the slab bounds all of the line or none.
    const Vf tiny = Splat(1e-30f);
    const Vf safe = hn::IfThenElse(hn::Lt(hn::Abs(v), tiny), tiny, v);
    const Vf inverse = hn::Div(Splat(1.0f), safe);
    const Vf a = hn::Mul(hn::Sub(Splat(lo), o), inverse);
    const Vf b = hn::Mul(hn::Sub(Splat(hi), o), inverse);
    rays.From = hn::Max(rays.From, hn::Min(a, b));
    rays.To = hn::Min(rays.To, hn::Max(a, b));
  };
  clip(rays.Origin.x, rays.Direction.x, scene.BoundsMin[0], scene.BoundsMax[0]);
  clip(rays.Origin.y, rays.Direction.y, scene.BoundsMin[1], scene.BoundsMax[1]);
  clip(rays.Origin.z, rays.Direction.z, scene.BoundsMin[2], scene.BoundsMax[2]);
}

/// Index coordinates of the whole that the volume is a part of.
HWY_INLINE Vec3 LocalToWholeIndex(const PacketScene& scene, const Vec3& local)
{
  return Add(Transform(scene.LocalToIndex, local), Broadcast(scene.IndexOffset));
}

/// FindPhase() of the rays of a packet.
HWY_INLINE Vf PhaseOf(const PacketScene& scene, const RayPacket& rays, Vf jitter)
{
  const Vf zero = hn::Zero(Df());
  Vf enter = Splat(-1e30f);
  Vf exit = Splat(1e30f);
  Vf enterSlope = zero;
  Vf exitSlope = zero;
  const auto cross = [&](Vf o, Vf v, int a)
  {
    const Vf slope = hn::Max(hn::Abs(v), Splat(static_cast<float>(LeastSlope)));
    const Vf inverse = hn::CopySign(hn::Div(Splat(1.0f), slope), v);
    const Vf t0 = hn::Mul(hn::Sub(Splat(scene.RestMin[a]), o), inverse);
    const Vf t1 = hn::Mul(hn::Sub(Splat(scene.RestMax[a]), o), inverse);
    const Vf near = hn::Min(t0, t1);
    const Vf far = hn::Max(t0, t1);
    enterSlope = hn::IfThenElse(hn::Gt(near, enter), slope, enterSlope);
    enter = hn::Max(enter, near);
    exitSlope = hn::IfThenElse(hn::Lt(far, exit), slope, exitSlope);
    exit = hn::Min(exit, far);
  };
  const Vec3 origin = LocalToWholeIndex(scene, rays.Origin);
  const Vec3 direction = Transform(scene.LocalToIndex, rays.Direction);
  cross(origin.x, direction.x, 0);
  cross(origin.y, direction.y, 1);
  cross(origin.z, direction.z, 2);
  const Mf past = hn::And(hn::Gt(enter, exit), hn::Gt(exitSlope, enterSlope));
  const Vf t = hn::Max(hn::IfThenElse(past, exit, enter), zero);
  const Vf x = hn::MulAdd(t, Splat(static_cast<float>(1.0 / scene.Settings.SampleDistance)),
    hn::Sub(jitter, Splat(static_cast<float>(PhaseGuard))));
  return hn::Sub(x, hn::Floor(x));
}

/// Rounded as in the whole: the shift takes nothing more off.
HWY_INLINE Vec3 LocalToIndex(const PacketScene& scene, const Vec3& local)
{
  return Sub(LocalToWholeIndex(scene, local), Broadcast(scene.IndexShift));
}

/// The other way round.
HWY_INLINE Vec3 IndexToLocal(const PacketScene& scene, const Vec3& index)
{
  return Transform(scene.IndexToLocal,
    Sub(Add(index, Broadcast(scene.IndexShift)), Broadcast(scene.IndexOffset)));
}

/**
 * T^-1 of every lane in `active` (or what FirstOrderOfInverse makes of it) by Newton's method from
 * `start`, local coordinates. Lanes that it does not solve go through the damped iteration of
 * PullBack, one by one.
 */
HWY_INLINE Vec3 InvertLanes(const PacketScene& scene, const Vec3& p, const Vec3& start, Mf active,
  CastStatistics& statistics)
{
  const Df d;
  Vec3 q = start;
  int evaluations = 0;
  const Mf converged = SolveInverse(scene.Field, p, scene.Tolerance, q, evaluations);
  statistics.Evaluations +=
    static_cast<std::int64_t>(evaluations) * static_cast<std::int64_t>(hn::CountTrue(d, active));
  if (scene.Kind == PullBackKind::FirstOrderOfInverse)
  {
    q = Sub(Add(p, p), q);
  }
  const Mf stuck = hn::AndNot(converged, active);
  if (HWY_UNLIKELY(!hn::AllFalse(d, stuck)))
  {
    q = ReplaceLanes(stuck, p, q,
      [&](const glm::dvec3& point)
      {
        PullBackStatus status;
        const glm::dvec3 rest =
          scene.Source->Map->Evaluate(scene.Centre + point, status) - scene.Centre;
        statistics.Evaluations += status.Evaluations;
        statistics.Unconverged += status.Converged ? 0 : 1;
        return rest;
      });
  }
  return q;
}

/// Phi of every lane in `active`, local coordinates.
HWY_INLINE Vec3 PullBackLanes(
  const PacketScene& scene, const Vec3& p, Mf active, CastStatistics& statistics)
{
  const Df d;
  if (scene.Identity)
  {
    return p;
  }
  statistics.Evaluations += static_cast<std::int64_t>(hn::CountTrue(d, active));
  if (scene.Kind == PullBackKind::FirstOrder)
  {
    return Sub(p, Displacement(scene.Field, p));
  }
  if (scene.Kind == PullBackKind::Forward)
  {
    return Add(p, Displacement(scene.Field, p));
  }
  return InvertLanes(
    scene, p, Add(p, Displacement(scene.InverseGuess, p)), active, statistics);
}

/// Fills PacketScene::InverseGuess: T^-1(P) - P at its nodes.
HWY_INLINE void FindInverseGuess(PacketScene& scene)
{
  const Df d;
  PacketField& guess = scene.InverseGuess;
  const std::size_t count = guess.GetNumberOfNodes();
  std::vector<float> values(3 * count);
  for (std::size_t first = 0; first < count; first += hn::Lanes(d))
  {
    HWY_ALIGN float x[16];
    HWY_ALIGN float y[16];
    HWY_ALIGN float z[16];
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      const glm::vec3 node = guess.GetNode(std::min(first + lane, count - 1));
      x[lane] = node.x;
      y[lane] = node.y;
      z[lane] = node.z;
    }
    const Vec3 p{ hn::Load(d, x), hn::Load(d, y), hn::Load(d, z) };
    const Vec3 start = Sub(p, Displacement(scene.Field, p));
    Vec3 q = start;
    int evaluations = 0;
    const Mf solved = SolveInverse(scene.Field, p, scene.Tolerance, q, evaluations);
    const auto moved = [&](Vf solution, Vf firstOrder, Vf from)
    { return hn::Sub(hn::IfThenElse(solved, solution, firstOrder), from); };
    hn::Store(moved(q.x, start.x, p.x), d, x);
    hn::Store(moved(q.y, start.y, p.y), d, y);
    hn::Store(moved(q.z, start.z, p.z), d, z);
    for (std::size_t lane = 0; lane < hn::Lanes(d) && first + lane < count; ++lane)
    {
      values[3 * (first + lane)] = x[lane];
      values[3 * (first + lane) + 1] = y[lane];
      values[3 * (first + lane) + 2] = z[lane];
    }
  }
  guess.SetNodes(std::move(values));
}

/**
 * dPhi/dP of every lane at deformed points p that come from rest points q (local coordinates), by
 * columns.
 */
HWY_INLINE void PullBackJacobian(
  const PacketScene& scene, const Vec3& p, const Vec3& q, Vec3& a, Vec3& b, Vec3& c)
{
  const Vf one = Splat(1.0f);
  const bool inverse = InvertsTheField(scene.Kind);
  Vec3 at = inverse ? q : p;
  if (scene.Kind == PullBackKind::FirstOrderOfInverse)
  {
    // q = 2p - T^-1(p): the field lives at T^-1(p).
    at = Sub(Add(p, p), q);
  }
  Vec3 displacement;
  EvaluateField<true>(scene.Field, at, displacement, a, b, c);
  if (scene.Kind == PullBackKind::FirstOrder)
  {
    const Vf minus = Splat(-1.0f);
    a = Scale(minus, a);
    b = Scale(minus, b);
    c = Scale(minus, c);
  }
  a.x = hn::Add(a.x, one);
  b.y = hn::Add(b.y, one);
  c.z = hn::Add(c.z, one);
  if (inverse)
  {
    // Rows of the inverse are the cross products of the columns over the determinant.
    const Vec3 r0 = Cross(b, c);
    const Vec3 r1 = Cross(c, a);
    const Vec3 r2 = Cross(a, b);
    const Vf determinant = Dot(a, r0);
    const Vf safe = hn::IfThenElse(
      hn::Lt(hn::Abs(determinant), Splat(1e-12f)), Splat(1e-12f), determinant);
    const Vf s = hn::Div(one, safe);
    a = Scale(s, { r0.x, r1.x, r2.x });
    b = Scale(s, { r0.y, r1.y, r2.y });
    c = Scale(s, { r0.z, r1.z, r2.z });
    if (scene.Kind == PullBackKind::FirstOrderOfInverse)
    {
      const Vf two = Splat(2.0f);
      const Vf minus = Splat(-1.0f);
      a = Scale(minus, a);
      b = Scale(minus, b);
      c = Scale(minus, c);
      a.x = hn::Add(a.x, two);
      b.y = hn::Add(b.y, two);
      c.z = hn::Add(c.z, two);
    }
  }
}

/// Cubic Lagrange weights at u in [0, 3] for nodes 0, 1, 2, 3, and their derivatives by u.
HWY_INLINE void LagrangeWeights(Vf u, Vf w[4], Vf slopes[4])
{
  const Vf a = u;
  const Vf b = hn::Sub(u, Splat(1.0f));
  const Vf c = hn::Sub(u, Splat(2.0f));
  const Vf e = hn::Sub(u, Splat(3.0f));
  const auto product3 = [](Vf x, Vf y, Vf z) { return hn::Mul(x, hn::Mul(y, z)); };
  const auto pairs = [](Vf x, Vf y, Vf z)
  { return hn::MulAdd(x, y, hn::MulAdd(x, z, hn::Mul(y, z))); };
  const Vf sixth = Splat(1.0f / 6.0f);
  const Vf half = Splat(0.5f);
  w[0] = hn::Neg(hn::Mul(sixth, product3(b, c, e)));
  w[1] = hn::Mul(half, product3(a, c, e));
  w[2] = hn::Neg(hn::Mul(half, product3(a, b, e)));
  w[3] = hn::Mul(sixth, product3(a, b, c));
  slopes[0] = hn::Neg(hn::Mul(sixth, pairs(b, c, e)));
  slopes[1] = hn::Mul(half, pairs(a, c, e));
  slopes[2] = hn::Neg(hn::Mul(half, pairs(a, b, e)));
  slopes[3] = hn::Mul(sixth, pairs(a, b, c));
}

/// Sum over the nodes of a tile, weights of x and y.
HWY_INLINE Vf InterpolateNodes(const float* node, const Vf wx[4], const Vf wy[4])
{
  Vf sum = hn::Zero(Df());
  for (int j = 0; j < NodesPerSide; ++j)
  {
    const float* row = node + NodesPerSide * j;
    Vf s = hn::Mul(wx[0], Splat(row[0]));
    s = hn::MulAdd(wx[1], Splat(row[1]), s);
    s = hn::MulAdd(wx[2], Splat(row[2]), s);
    s = hn::MulAdd(wx[3], Splat(row[3]), s);
    sum = hn::MulAdd(wy[j], s, sum);
  }
  return sum;
}

HWY_INLINE Vec3 InterpolateLayer(const TileLayer& layer, const Vf wx[4], const Vf wy[4])
{
  return { InterpolateNodes(layer.X, wx, wy), InterpolateNodes(layer.Y, wx, wy),
    InterpolateNodes(layer.Z, wx, wy) };
}

/// Weights of the nodes of a square, and their derivatives, for a packet of rays.
struct NodeWeights
{
  Vf X[4];
  Vf Y[4];
  Vf XSlope[4];
  Vf YSlope[4];

  NodeWeights() = default;
  /// Positions from the first node, spacings of nodes.
  HWY_INLINE NodeWeights(Vf x, Vf y)
  {
    LagrangeWeights(x, this->X, this->XSlope);
    LagrangeWeights(y, this->Y, this->YSlope);
  }

  HWY_INLINE Vec3 Interpolate(const TileLayer& layer) const
  {
    return InterpolateLayer(layer, this->X, this->Y);
  }
  HWY_INLINE Vec3 SlopeX(const TileLayer& layer) const
  {
    return InterpolateLayer(layer, this->XSlope, this->Y);
  }
  HWY_INLINE Vec3 SlopeY(const TileLayer& layer) const
  {
    return InterpolateLayer(layer, this->X, this->YSlope);
  }
};

/// Nodes from pixel to pixel of a tile, and of its quarters.
constexpr float NodesPerPixel = (NodesPerSide - 1) / static_cast<float>(TileSide - 1);
constexpr float QuarterNodesPerPixel = (NodesPerSide - 1) / static_cast<float>(TileSide / 2 - 1);

/// Where the nodes of a quarter lie between those of the tile.
class QuarterNodes
{
public:
  HWY_INLINE explicit QuarterNodes(int quarter)
  {
    constexpr float Side = TileSide / 2;
    constexpr float Step = (Side - 1.0f) / static_cast<float>(NodesPerSide - 1);
    const float column = static_cast<float>(quarter % 2) * Side;
    const float row = static_cast<float>(quarter / 2) * Side;
    for (int i = 0; i < TileNodes; ++i)
    {
      this->X[i] = NodesPerPixel * (column + Step * static_cast<float>(i % NodesPerSide));
      this->Y[i] = NodesPerPixel * (row + Step * static_cast<float>(i / NodesPerSide));
    }
  }

  /// Of the nodes of the tile, for those of the quarter from number i on.
  HWY_INLINE NodeWeights GetWeights(std::size_t i) const
  {
    const Df d;
    return NodeWeights(hn::Load(d, this->X + i), hn::Load(d, this->Y + i));
  }

private:
  HWY_ALIGN float X[TileNodes];
  HWY_ALIGN float Y[TileNodes];
};

/// Viewing rays through the 4 x 4 nodes of a square of pixels, the outermost pixels included.
struct NodeRays
{
  HWY_ALIGN TileLayer Origins;    ///< local coordinates
  HWY_ALIGN TileLayer Directions; ///< local coordinates per world unit

  void Set(const PacketScene& scene, const ImageMap& near, const ImageMap& far, float x0, float y0,
    int side)
  {
    const Df d;
    const float step = static_cast<float>(side - 1) / static_cast<float>(NodesPerSide - 1);
    HWY_ALIGN float x[TileNodes];
    HWY_ALIGN float y[TileNodes];
    for (int i = 0; i < TileNodes; ++i)
    {
      x[i] = x0 + 0.5f + step * static_cast<float>(i % NodesPerSide);
      y[i] = y0 + 0.5f + step * static_cast<float>(i / NodesPerSide);
    }
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const RayPacket rays = MakeRays(scene, near, far, hn::Load(d, x + i), hn::Load(d, y + i));
      hn::Store(rays.Origin.x, d, this->Origins.X + i);
      hn::Store(rays.Origin.y, d, this->Origins.Y + i);
      hn::Store(rays.Origin.z, d, this->Origins.Z + i);
      hn::Store(rays.Direction.x, d, this->Directions.X + i);
      hn::Store(rays.Direction.y, d, this->Directions.Y + i);
      hn::Store(rays.Direction.z, d, this->Directions.Z + i);
    }
  }
};

/**
 * The coarse grids of one tile, one for all of it and one for each quarter: viewing rays through
 * their 4 x 4 nodes and, by layer of equal t, where the nodes come from. All are found on first use
 * and kept, so what a layer holds does not depend on which rays asked for it.
 */
class TileGrid
{
public:
  TileGrid(const PacketScene& scene, PacketScratch& scratch)
    : Scene(scene)
    , Scratch(scratch)
  {
  }

  /// `near` and `far` are kept by pointer; (x0, y0): first pixel of the tile.
  void SetRays(const ImageMap& near, const ImageMap& far, int x0, int y0)
  {
    this->Near = &near;
    this->Far = &far;
    this->X0 = x0;
    this->Y0 = y0;
    this->Rays.Set(
      this->Scene, near, far, static_cast<float>(x0), static_cast<float>(y0), TileSide);
    for (bool& known : this->HaveQuarter)
    {
      known = false;
    }
  }

  /// Rays through the nodes of the tile.
  const NodeRays& GetRays() const { return this->Rays; }

  /// Number of fine steps a span: layers lie at ends and middles of the smallest pieces.
  void Start(int spans, int largestLevel, int firstSpan, float spanLength)
  {
    this->StepsPerSpan = 1 << (largestLevel + 1);
    this->FirstSpan = firstSpan;
    this->StepLength = spanLength / static_cast<float>(this->StepsPerSpan);
    this->NumberOfSlots =
      static_cast<std::size_t>(spans) * static_cast<std::size_t>(this->StepsPerSpan) + 1;
    this->Scratch.LayerSlots.assign(this->NumberOfSlots, -1);
    this->Scratch.Layers.clear();
  }

  int GetStepsPerSpan() const { return this->StepsPerSpan; }

  /// Layer at a fine step from the start of the first span.
  const TileLayer& GetLayer(int step)
  {
    return this->GetLayer(
      this->Rays, this->Scratch.LayerSlots[static_cast<std::size_t>(step)], step);
  }

  /// The same with the nodes of a quarter of the tile: 0 to 3, x first.
  HWY_NOINLINE const TileLayer& GetQuarterLayer(int quarter, int step)
  {
    std::vector<int>& slots = this->Scratch.QuarterSlots[quarter];
    if (!this->HaveQuarter[quarter])
    {
      this->HaveQuarter[quarter] = true;
      slots.assign(this->NumberOfSlots, -1);
      constexpr int Side = TileSide / 2;
      this->Quarters[quarter].Set(this->Scene, *this->Near, *this->Far,
        static_cast<float>(this->X0 + quarter % 2 * Side),
        static_cast<float>(this->Y0 + quarter / 2 * Side), Side);
    }
    int& slot = slots[static_cast<std::size_t>(step)];
    if (slot < 0 && this->Scene.Kind == PullBackKind::Exact)
    {
      // Nodes of the tile tell where to start from better than InverseGuess does.
      const TileLayer tile = this->GetLayer(step);
      const QuarterNodes nodes(quarter);
      return this->GetLayer(this->Quarters[quarter], slot, step,
        [&](std::size_t i, const Vec3& p, Mf lanes)
        {
          const Vec3 start = IndexToLocal(this->Scene, nodes.GetWeights(i).Interpolate(tile));
          return InvertLanes(this->Scene, p, start, lanes, this->Scratch.Statistics);
        });
    }
    return this->GetLayer(this->Quarters[quarter], slot, step);
  }

  float TimeOf(int step) const
  {
    return static_cast<float>(this->FirstSpan * this->StepsPerSpan + step) * this->StepLength;
  }

private:
  HWY_INLINE const TileLayer& GetLayer(const NodeRays& rays, int& slot, int step)
  {
    return this->GetLayer(rays, slot, step,
      [&](std::size_t, const Vec3& p, Mf lanes)
      { return PullBackLanes(this->Scene, p, lanes, this->Scratch.Statistics); });
  }

  /// `pullBack`: rest points of the nodes from number i on, from their deformed points.
  template <class PullBackNodes>
  HWY_INLINE const TileLayer& GetLayer(
    const NodeRays& rays, int& slot, int step, const PullBackNodes& pullBack)
  {
    if (slot < 0)
    {
      slot = static_cast<int>(this->Scratch.Layers.size());
      this->Scratch.Layers.emplace_back();
      this->Find(rays, step, pullBack, this->Scratch.Layers.back());
    }
    return this->Scratch.Layers[static_cast<std::size_t>(slot)];
  }

  template <class PullBackNodes>
  HWY_NOINLINE void Find(
    const NodeRays& rays, int step, const PullBackNodes& pullBack, TileLayer& layer)
  {
    const Df d;
    const Vf t = Splat(this->TimeOf(step));
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const Vec3 o{ hn::Load(d, rays.Origins.X + i), hn::Load(d, rays.Origins.Y + i),
        hn::Load(d, rays.Origins.Z + i) };
      const Vec3 v{ hn::Load(d, rays.Directions.X + i), hn::Load(d, rays.Directions.Y + i),
        hn::Load(d, rays.Directions.Z + i) };
      const Vec3 rest = pullBack(i, MulAdd(t, v, o), hn::FirstN(d, hn::Lanes(d)));
      const Vec3 index = LocalToIndex(this->Scene, rest);
      hn::StoreU(index.x, d, layer.X + i);
      hn::StoreU(index.y, d, layer.Y + i);
      hn::StoreU(index.z, d, layer.Z + i);
    }
  }

  const PacketScene& Scene;
  PacketScratch& Scratch;
  NodeRays Rays;
  NodeRays Quarters[4];
  bool HaveQuarter[4] = { false, false, false, false };
  const ImageMap* Near = nullptr;
  const ImageMap* Far = nullptr;
  int X0 = 0;
  int Y0 = 0;
  std::size_t NumberOfSlots = 0;
  int StepsPerSpan = 2;
  int FirstSpan = 0;
  float StepLength = 1.0f;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
