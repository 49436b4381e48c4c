// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Casting a packet of rays through a tile. Included once per target of Highway.
#if defined(FFD_SIMD_CASTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_CASTER_INL_H_
#undef FFD_SIMD_CASTER_INL_H_
#else
#define FFD_SIMD_CASTER_INL_H_
#endif

#include "FFDPacketCaster.h"

#include "FFDSimdFetch-inl.h"
#include "FFDSimdLeap-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdShading-inl.h"
#include "FFDSimdTable-inl.h"
#include "FFDSimdTile-inl.h"

#include <limits>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// What has been composited along the rays of a packet.
struct PacketPixels
{
  Vec3 Colour;
  Vf Transmittance;
  Vf FirstVisible; ///< t
  Vf Tally;        ///< the extreme, or the sum; of surfaces, the value at TallyStep
  Vf TallyLength;  ///< what has been summed up over, world units
  Vf TallyStep;    ///< sample of the piece where the value is known, or a negative number
};

/// Which nodes rays are interpolated between.
enum class LateralNodes
{
  Tile,
  Quarter, ///< of the tile
  None     ///< none, every ray is followed for itself
};

HWY_INLINE LateralNodes NodesOf(const TileSpans::Span& span)
{
  return span.Lateral ? LateralNodes::Tile
    : span.LateralInQuarters ? LateralNodes::Quarter
                             : LateralNodes::None;
}

/// A piece of the curves of a packet: Start + s * (Linear + s * Quadratic), index coordinates.
struct PacketPiece
{
  Vec3 Start;
  Vec3 Linear;
  Vec3 Quadratic;
  int Step = 0;       ///< fine step of its start
  int Steps = 0;      ///< fine steps it takes
  float T0 = 0.0f;
  float Dt = 0.0f;
  LateralNodes Nodes = LateralNodes::Tile; ///< that it is interpolated between

  HWY_INLINE Vec3 At(Vf s) const { return MulAdd(s, MulAdd(s, this->Quadratic, this->Linear), this->Start); }
  HWY_INLINE Vec3 Velocity(Vf s) const
  {
    return MulAdd(hn::Add(s, s), this->Quadratic, this->Linear);
  }
};

/// Samples of a piece: at s = n * Ds for whole numbers n, First <= n < Stop.
struct PacketSchedule
{
  Vf Ds;
  Vf First;
  Vf Stop;
};

template <class T>
class Packet
{
public:
  /**
   * `x`, `y`: pixels from the first of the tile. `phase`: part of an interval by which the samples
   * of each ray are moved on.
   */
  Packet(const PacketScene& scene, TileGrid& grid, TileBeam& beam, PacketScratch& scratch,
    const RayPacket& rays, Vf x, Vf y, Vf phase, Mf active)
    : Scene(scene)
    , Grid(grid)
    , Beam(beam)
    , Scratch(scratch)
    , Rays(rays)
    , Phase(phase)
    , Alive(active)
    , X(x)
    , Y(y)
  {
    if (!scene.Identity)
    {
      this->Weights =
        NodeWeights(hn::Mul(x, Splat(NodesPerPixel)), hn::Mul(y, Splat(NodesPerPixel)));
    }
    this->Kept = PacketLook::Nothing();
    this->ToEye =
      Normalize(Scale(Splat(-1.0f), Transform(this->Scene.LocalToLights, rays.Direction)));
    const Vf zero = hn::Zero(Df());
    this->Out = { { zero, zero, zero }, Splat(1.0f), Splat(1e30f), zero, zero, zero };
  }

  const PacketPixels& GetPixels() const { return this->Out; }

  /// Where the samples are not composited: before Cast(), for the packet whose first pixel is
  /// (x0, y0).
  HWY_NOINLINE void BeginRays(int x0, int y0, int width)
  {
    const Df d;
    if (this->Scene.Sampling == PacketSampling::Extreme)
    {
      this->Out.Tally = Splat(-NoExtreme);
      return;
    }
    if (this->Scene.Sampling == PacketSampling::Sum)
    {
      return;
    }
    HWY_ALIGN float from[16], to[16];
    hn::Store(this->Rays.From, d, from);
    hn::Store(this->Rays.To, d, to);
    std::vector<RayIntegrator>& rays = this->Scratch.Integrators;
    rays.resize(hn::MaxLanes(Df()));
    for (int lane = 0; lane < static_cast<int>(hn::Lanes(d)); ++lane)
    {
      rays[static_cast<std::size_t>(lane)].Begin(*this->Scene.Frame,
        this->Scene.Source->Camera.MakeRay(x0 + lane % width + 0.5, y0 + lane / width + 0.5),
        static_cast<double>(from[lane]), static_cast<double>(to[lane]));
    }
  }

  /// Where the samples are not composited: after Cast(), what has become of the rays.
  HWY_NOINLINE void EndRays()
  {
    switch (this->Scene.Sampling)
    {
      case PacketSampling::Extreme:
        return this->EndExtremes();
      case PacketSampling::Sum:
        return this->EndSums();
      default:
        return this->EndIntegrators();
    }
  }

  void Cast()
  {
    const Df d;
    TileSpans& spans = this->Scratch.Spans;
    const float spanLength = static_cast<float>(spans.GetLength());
    const Vf big = Splat(1e30f);
    const float from = SmallestLane(hn::IfThenElse(this->Alive, this->Rays.From, big));
    const float to = LargestLane(hn::IfThenElse(this->Alive, this->Rays.To, hn::Neg(big)));
    const int last = static_cast<int>(std::floor(to / spanLength));
    const int stepsPerSpan = this->Grid.GetStepsPerSpan();
    if (this->Scene.Identity)
    {
      // Straight rays are one piece from end to end.
      PacketPiece piece;
      piece.Step =
        (static_cast<int>(std::floor(from / spanLength)) - spans.GetFirst()) * stepsPerSpan;
      piece.T0 = this->Grid.TimeOf(piece.Step);
      piece.Dt = spanLength * static_cast<float>(last + 1) - piece.T0;
      piece.Start = this->PositionAt(piece.Step, TileSpans::Span(), this->Alive);
      piece.Linear = Transform(this->Scene.LocalToIndex, Scale(Splat(piece.Dt), this->Rays.Direction));
      piece.Quadratic = this->Out.Colour;
      this->CountPiece(piece, this->Alive);
      const PacketSchedule schedule = this->Schedule(piece, Splat(piece.Dt));
      this->IntegratePiece(piece, schedule, LeapsOf(piece, schedule), this->Alive);
      return;
    }
    const bool lipschitz = this->Scene.Settings.Leaping == SpaceLeaping::Lipschitz;
    const Mf everyone = hn::FirstN(d, hn::Lanes(d));
    const float nothing[3] = { 0.0f, 0.0f, 0.0f };
    LeapSlack slack;
    int nodeStep = -1;
    LateralNodes nodeNodes = LateralNodes::None;
    Vec3 node = this->Out.Colour;
    for (int index = static_cast<int>(std::floor(from / spanLength)); index <= last; ++index)
    {
      const TileSpans::Span& span = spans.Get(index);
      const float guard = FindLeapGuard(this->Scene, span);
      const float velocityMin[3] = { static_cast<float>(span.VelocityMin.x),
        static_cast<float>(span.VelocityMin.y), static_cast<float>(span.VelocityMin.z) };
      const float velocityMax[3] = { static_cast<float>(span.VelocityMax.x),
        static_cast<float>(span.VelocityMax.y), static_cast<float>(span.VelocityMax.z) };
      if (lipschitz && this->Beam.IsEmpty(index))
      {
        slack.Pass(everyone, velocityMin, velocityMax, spanLength, guard);
        continue;
      }
      const int pieces = 1 << span.Level;
      const int steps = stepsPerSpan / pieces;
      const bool canLeap = lipschitz && span.Bounded;
      if (!canLeap)
      {
        slack.Clear();
      }
      PacketPiece piece;
      piece.Steps = steps;
      piece.Dt = spanLength / static_cast<float>(pieces);
      piece.Nodes = NodesOf(span);
      for (int p = 0; p < pieces; ++p)
      {
        piece.Step = (index - spans.GetFirst()) * stepsPerSpan + p * steps;
        piece.T0 = this->Grid.TimeOf(piece.Step);
        const float t1 = this->Grid.TimeOf(piece.Step + steps);
        // Rays that have not begun yet are followed, too: leaps must be theirs as well.
        const Mf ahead = hn::And(this->Alive, hn::Gt(this->Rays.To, Splat(piece.T0)));
        if (hn::AllFalse(d, ahead))
        {
          return;
        }
        Mf inRange = hn::And(ahead, hn::Lt(this->Rays.From, Splat(t1)));
        if (canLeap)
        {
          const Mf passed =
            slack.Pass(everyone, velocityMin, velocityMax, piece.Dt, guard);
          inRange = hn::AndNot(passed, inRange);
        }
        if (hn::AllFalse(d, inRange))
        {
          continue;
        }
        if (nodeStep != piece.Step || nodeNodes != piece.Nodes)
        {
          node = this->PositionAt(piece.Step, span, ahead);
        }
        PacketLook look;
        if (canLeap)
        {
          // A new look costs less than a piece that it may save, but for interpolated ones.
          const Mf kept = piece.Nodes != LateralNodes::None ? this->Kept.FindKept(node, inRange)
                                                            : hn::FirstN(d, 0);
          look =
            PacketLook(this->Scene, node, hn::AndNot(kept, inRange), this->Scratch.Statistics);
          look.Take(this->Kept, kept);
          this->Kept.Take(look, inRange);
          slack.Find(this->Scene, look, inRange, nothing);
          const Mf passed = slack.Pass(inRange, velocityMin, velocityMax, piece.Dt, guard);
          inRange = hn::AndNot(passed, inRange);
          if (hn::AllFalse(d, inRange))
          {
            nodeStep = -1;
            continue;
          }
        }

        const Vec3 middle = this->PositionAt(piece.Step + steps / 2, span, ahead);
        const Vec3 end = this->PositionAt(piece.Step + steps, span, ahead);
        piece.Start = node;
        // 4 middle - 3 start - end
        piece.Linear = Sub(MulAdd(Splat(4.0f), middle, Scale(Splat(-3.0f), node)), end);
        piece.Quadratic = Sub(Sub(end, node), piece.Linear);
        this->CountPiece(piece, inRange);
        const Vf length = hn::Add(
          this->LengthOf(Sub(middle, node)), this->LengthOf(Sub(end, middle)));
        PacketSchedule schedule = this->Schedule(piece, length);
        const PieceLeap leaps = LeapsOf(piece, schedule);
        if (canLeap)
        {
          schedule.First = hn::Max(
            schedule.First, hn::Sub(look.CountSteps(this->Scene, leaps), this->StepsBack()));
        }
        this->IntegratePiece(piece, schedule, leaps, inRange);
        node = end;
        nodeStep = piece.Step + steps;
        nodeNodes = piece.Nodes;
        if (hn::AllFalse(d, this->Alive))
        {
          this->Reach = t1;
          return;
        }
      }
    }
  }

  /// The t at which the last ray has ended; infinite where one went on to the end.
  float GetReach() const { return this->Reach; }

private:
  static constexpr float NoExtreme = 3e38f;

  void EndIntegrators()
  {
    const Df d;
    HWY_ALIGN float r[16], g[16], b[16], transmittance[16], t[16];
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      const RayIntegrator::Result result = this->Scratch.Integrators[lane].End();
      r[lane] = result.Colour.r;
      g[lane] = result.Colour.g;
      b[lane] = result.Colour.b;
      transmittance[lane] = result.Transmittance;
      t[lane] = static_cast<float>(std::min(result.FirstVisible, 1e30));
    }
    this->Out.Colour = { hn::Load(d, r), hn::Load(d, g), hn::Load(d, b) };
    this->Out.Transmittance = hn::Load(d, transmittance);
    this->Out.FirstVisible = hn::Load(d, t);
  }

  void EndExtremes()
  {
    const Df d;
    HWY_ALIGN float extreme[16], r[16], g[16], b[16], transmittance[16], t[16];
    const bool maximum = this->Scene.Source->Blend.Mode == BlendMode::Maximum;
    hn::Store(this->Out.Tally, d, extreme);
    hn::Store(this->Out.FirstVisible, d, t);
    const PacketVolume& v = this->Scene.Volume;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      glm::vec4 look(0.0f);
      if (extreme[lane] > -NoExtreme)
      {
        const double value = static_cast<double>(maximum ? extreme[lane] : -extreme[lane]);
        look = this->Scene.Frame->Classifier->ClassifyValue(0, value / v.Scale + v.Shift);
        look.a = std::min(1.0f, look.a * static_cast<float>(this->Scene.Source->Blend.Weight[0]));
      }
      r[lane] = look.a * look.r;
      g[lane] = look.a * look.g;
      b[lane] = look.a * look.b;
      transmittance[lane] = 1.0f - look.a;
      t[lane] = look.a > 0.0f ? t[lane] : 1e30f;
    }
    this->Out.Colour = { hn::Load(d, r), hn::Load(d, g), hn::Load(d, b) };
    this->Out.Transmittance = hn::Load(d, transmittance);
    this->Out.FirstVisible = hn::Load(d, t);
  }

  void EndSums()
  {
    const Blending& blend = this->Scene.Source->Blend;
    const Vf zero = hn::Zero(Df());
    const Vf one = Splat(1.0f);
    const Mf any = hn::Gt(this->Out.TallyLength, zero);
    const Vf over = blend.Mode == BlendMode::Average
      ? hn::IfThenElse(any, this->Out.TallyLength, one)
      : Splat(static_cast<float>(blend.UnitDistance[0]));
    const Vf gray = hn::IfThenElseZero(any,
      Clamp(hn::Mul(Splat(static_cast<float>(blend.Weight[0])), hn::Div(this->Out.Tally, over)),
        zero, one));
    this->Out.Colour = { gray, gray, gray };
    this->Out.Transmittance = hn::IfThenElse(any, zero, one);
  }

  /// Index coordinates of every ray at a fine step.
  HWY_INLINE Vec3 PositionAt(int step, const TileSpans::Span& span, Mf lanes)
  {
    const Vf t = Splat(this->Grid.TimeOf(step));
    const Vec3 p = MulAdd(t, this->Rays.Direction, this->Rays.Origin);
    if (this->Scene.Identity)
    {
      return LocalToIndex(this->Scene, p);
    }
    // What interpolation is not close enough for is at least where Newton's method starts from.
    const bool solves = this->Scene.Kind == PullBackKind::Exact;
    const LateralNodes nodes = NodesOf(span);
    if (nodes == LateralNodes::Quarter)
    {
      return this->InQuarter().Interpolate(this->LayerOf(nodes, step));
    }
    if (nodes == LateralNodes::None && !(span.Bounded && solves))
    {
      return LocalToIndex(
        this->Scene, PullBackLanes(this->Scene, p, lanes, this->Scratch.Statistics));
    }
    const Vec3 interpolated = this->Weights.Interpolate(this->Grid.GetLayer(step));
    if (nodes == LateralNodes::Tile)
    {
      return interpolated;
    }
    return LocalToIndex(this->Scene,
      InvertLanes(this->Scene, p, IndexToLocal(this->Scene, interpolated), lanes,
        this->Scratch.Statistics));
  }

  /// Weights of the nodes of the quarter of the tile.
  HWY_INLINE const NodeWeights& InQuarter()
  {
    if (HWY_UNLIKELY(this->Quarter < 0))
    {
      this->FindQuarter();
    }
    return this->QuarterWeights;
  }

  HWY_NOINLINE void FindQuarter()
  {
    constexpr float Half = TileSide / 2;
    const bool right = hn::GetLane(this->X) >= Half;
    const bool high = hn::GetLane(this->Y) >= Half;
    this->Quarter = (right ? 1 : 0) + (high ? 2 : 0);
    const auto nodes = [](Vf pixel, bool second)
    { return hn::Mul(hn::Sub(pixel, Splat(second ? Half : 0.0f)), Splat(QuarterNodesPerPixel)); };
    this->QuarterWeights = NodeWeights(nodes(this->X, right), nodes(this->Y, high));
  }

  HWY_INLINE const TileLayer& LayerOf(LateralNodes nodes, int step)
  {
    return nodes == LateralNodes::Quarter ? this->Grid.GetQuarterLayer(this->Quarter, step)
                                          : this->Grid.GetLayer(step);
  }

  HWY_INLINE Vf LengthOf(const Vec3& index) const
  {
    const Vec3 data = Transform(this->Scene.IndexToLocal, index);
    return hn::Sqrt(Dot(data, data));
  }

  HWY_INLINE void CountPiece(const PacketPiece& piece, Mf lanes)
  {
    CastStatistics& statistics = this->Scratch.Statistics;
    const int rays = static_cast<int>(hn::CountTrue(Df(), lanes));
    statistics.Segments += rays;
    statistics.SegmentLength += rays * (piece.Dt / this->Scene.Source->VoxelSize);
  }

  /// As ScheduleEvenly, a schedule a lane. `length`: of the piece in rest space, world units.
  HWY_INLINE PacketSchedule Schedule(const PacketPiece& piece, Vf length) const
  {
    const Vf zero = hn::Zero(Df());
    const Vf one = Splat(1.0f);
    const float inverseDistance = static_cast<float>(1.0 / this->Scene.Settings.SampleDistance);
    const Vf count = hn::Max(one, hn::Round(hn::Mul(length, Splat(inverseDistance))));
    const Vf t0 = Splat(piece.T0);
    const Vf inverseDt = Splat(1.0f / piece.Dt);
    const Vf sFrom = hn::Max(hn::Mul(hn::Sub(this->Rays.From, t0), inverseDt), zero);
    const Vf sTo = hn::Min(hn::Mul(hn::Sub(this->Rays.To, t0), inverseDt), one);
    const Vf slack = Splat(1e-3f);
    PacketSchedule schedule;
    schedule.Ds = hn::Div(one, count);
    const Vf early = this->Scene.Intervals ? Splat(1.0f - 1e-3f) : hn::Add(slack, this->Phase);
    schedule.First = hn::Add(hn::Ceil(hn::Sub(hn::Mul(sFrom, count), early)), this->Phase);
    schedule.Stop = hn::Min(count,
      hn::Add(hn::Ceil(hn::Sub(hn::Sub(hn::Mul(sTo, count), slack), this->Phase)), this->Phase));
    return schedule;
  }

  /**
   * What has to be taken off the number of steps to the first position that may not be empty, for
   * the first sample of a piece: where samples do not lie on whole steps, or stand for what comes
   * after them.
   */
  HWY_INLINE Vf StepsBack() const
  {
    const Vf one = Splat(1.0f);
    return this->Scene.Intervals ? one : hn::Sub(one, this->Phase);
  }

  static HWY_INLINE PieceLeap LeapsOf(const PacketPiece& piece, const PacketSchedule& schedule)
  {
    return PieceLeap(
      piece.Velocity(hn::Zero(Df())), piece.Velocity(Splat(1.0f)), schedule.Ds);
  }

  HWY_INLINE void IntegratePiece(const PacketPiece& piece, const PacketSchedule& schedule,
    const PieceLeap& leaps, Mf lanes)
  {
    if (HWY_LIKELY(this->Scene.Plain))
    {
      this->template Integrate<true>(piece, schedule, leaps, lanes);
    }
    else
    {
      this->template Integrate<false>(piece, schedule, leaps, lanes);
    }
  }

  /**
   * Samples one piece. Each ray steps through it on its own: it leaps until it stands before
   * something that may be visible, and when all rays do, all of them take a sample. So they take
   * their first visible samples together, wherever on the piece these lie. `Plain`: PacketScene::Plain,
   * so that the innermost loop carries nothing for options that are not used.
   */
  template <bool Plain>
  HWY_NOINLINE void Integrate(const PacketPiece& piece, const PacketSchedule& schedule, const PieceLeap& leaps,
    Mf lanes)
  {
    const Df d;
    const bool leap = this->Scene.Settings.Leaping != SpaceLeaping::Off;
    const bool intervals = !Plain && this->Scene.Intervals;
    const bool composite = Plain || this->Scene.Sampling == PacketSampling::Composite;
    this->HaveFrames = false;
    this->Out.TallyStep = Splat(-1.0f);
    Vf n = schedule.First;
    // Rays whose last sample was visible expect the next one to be.
    Mf expecting = hn::FirstN(d, 0);
    for (;;)
    {
      Mf active = hn::And(hn::And(lanes, this->Alive), hn::Lt(n, schedule.Stop));
      Mf looking = hn::AndNot(expecting, active);
      while (leap && !hn::AllFalse(d, looking))
      {
        const Mf empty = this->template LookAhead<Plain>(piece, schedule, leaps, looking, n);
        active = hn::And(active, hn::Lt(n, schedule.Stop));
        looking = hn::And(active, empty);
      }
      if (hn::AllFalse(d, active))
      {
        return;
      }
      const Vf s = hn::Mul(n, schedule.Ds);
      const Vec3 q = piece.At(s);
      const Mf sampled =
        intervals ? active : hn::And(active, this->template IsShown<Plain>(q, piece, s));
      expecting = hn::AllFalse(d, sampled) ? sampled
        : composite
        ? this->template TakeSample<Plain>(piece, q, s, schedule.Ds, sampled)
        : this->TakeOtherSample(piece, q, n, schedule.Ds, sampled);
      n = hn::Add(n, hn::IfThenElseZero(active, Splat(1.0f)));
    }
  }

  /// Moves the rays of `looking` that stand in empty space on, and says which these are.
  template <bool Plain>
  HWY_INLINE Mf LookAhead(const PacketPiece& piece, const PacketSchedule& schedule,
    const PieceLeap& leaps, Mf looking, Vf& n)
  {
    const PacketLook look(
      this->Scene, piece.At(hn::Mul(n, schedule.Ds)), looking, this->Scratch.Statistics);
    const Vf steps = look.CountSteps(this->Scene, leaps);
    if (!Plain && this->Scene.Intervals)
    {
      // The interval up to the first position that may not be empty is none of them.
      const Vf empty = hn::Sub(steps, Splat(1.0f));
      const Mf some = hn::And(looking, hn::Gt(empty, hn::Zero(Df())));
      n = hn::Add(n, hn::IfThenElseZero(some, empty));
      return some;
    }
    n = hn::Add(n, steps);
    return look.GetFree();
  }

  /// Which positions are inside of the volume and not cropped.
  template <bool Plain>
  HWY_INLINE Mf IsShown(const Vec3& q, const PacketPiece& piece, Vf s) const
  {
    const Mf inside = IsInside(this->Scene, q);
    if (Plain || this->Scene.CropSpace == Cropping::Spaces::None)
    {
      return inside;
    }
    if (this->Scene.CropSpace == Cropping::Spaces::Rest)
    {
      return hn::And(inside, this->IsUncropped(q));
    }
    const Vf t = hn::MulAdd(s, Splat(piece.Dt), Splat(piece.T0));
    return hn::And(inside, this->IsUncropped(MulAdd(t, this->Rays.Direction, this->Rays.Origin)));
  }

  HWY_NOINLINE Mf IsUncropped(const Vec3& p) const
  {
    const Df d;
    const Di di;
    const Vf one = Splat(1.0f);
    const auto slab = [&](Vf x, int a)
    {
      return hn::Add(hn::IfThenElseZero(hn::Ge(x, Splat(this->Scene.CropLow[a])), one),
        hn::IfThenElseZero(hn::Ge(x, Splat(this->Scene.CropHigh[a])), one));
    };
    const Vf region = hn::MulAdd(Splat(9.0f), slab(p.z, 2),
      hn::MulAdd(Splat(3.0f), slab(p.y, 1), slab(p.x, 0)));
    HWY_ALIGN int regions[16];
    HWY_ALIGN float shown[16];
    hn::Store(hn::ConvertTo(di, region), di, regions);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      shown[lane] = (this->Scene.CropFlags >> regions[lane] & 1) != 0 ? 1.0f : 0.0f;
    }
    return hn::Gt(hn::Load(d, shown), hn::Zero(d));
  }

  /// Samples, shades and composites; returns which of the rays met something visible.
  template <bool Plain>
  HWY_INLINE Mf TakeSample(const PacketPiece& piece, const Vec3& q, Vf s, Vf ds, Mf sampled)
  {
    const Df d;
    CastStatistics& statistics = this->Scratch.Statistics;
    statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));

    const SamplePosition at = FindCells(this->Scene.Volume, q, sampled);
    const Mf border = hn::AndNot(at.Interior, sampled);
    const bool anyBorder = !hn::AllFalse(d, border);
    SampleRows<T> rows;
    Vf value = Sample<T>(this->Scene.Volume, at, rows);
    if (HWY_UNLIKELY(anyBorder))
    {
      value = this->SampleBorder(q, border, value);
    }

    const TableLookup look(this->Scene, value);
    Vf extinction = look.Extinction();
    Mf visible = hn::And(hn::And(sampled, look.IsNumber()), hn::Gt(extinction, hn::Zero(d)));
    if (hn::AllFalse(d, visible))
    {
      return visible;
    }
    Vec3 gradient{ hn::Zero(d), hn::Zero(d), hn::Zero(d) };
    const bool byGradient = !Plain && this->Scene.GradientFactors != nullptr;
    if (byGradient || this->Scene.Shade)
    {
      gradient = Gradient<T>(this->Scene.Volume, at, rows);
      if (HWY_UNLIKELY(anyBorder))
      {
        gradient = this->GradientAtBorder(q, border, gradient);
      }
    }
    if (byGradient)
    {
      extinction = this->WeighByGradient(extinction, gradient);
      visible = hn::And(visible, hn::Gt(extinction, hn::Zero(d)));
      if (hn::AllFalse(d, visible))
      {
        return visible;
      }
    }
    statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, visible));

    Vec3 colour = look.Colour();
    const Vf t = hn::MulAdd(s, Splat(piece.Dt), Splat(piece.T0));
    if (this->Scene.Shade)
    {
      colour = this->ShadeSample(piece, q, colour, gradient, s, t);
    }
    const Vf interval = this->Scene.Settings.Opacity == OpacityLength::World
      ? hn::Mul(ds, Splat(piece.Dt))
      : hn::Mul(ds, this->LengthOf(piece.Velocity(s)));
    const Vf transmittance = Exp2(hn::Neg(hn::Mul(extinction, interval)));
    const Vf weight = hn::IfThenElseZero(
      visible, hn::Mul(this->Out.Transmittance, hn::Sub(Splat(1.0f), transmittance)));
    this->Out.Colour = MulAdd(weight, colour, this->Out.Colour);
    this->Out.Transmittance = hn::IfThenElse(
      visible, hn::Mul(this->Out.Transmittance, transmittance), this->Out.Transmittance);
    this->Out.FirstVisible = hn::IfThenElse(
      visible, hn::Min(this->Out.FirstVisible, t), this->Out.FirstVisible);
    const Mf ended =
      hn::Lt(this->Out.Transmittance, Splat(this->Scene.Settings.TerminationTransmittance));
    this->Alive = hn::AndNot(ended, this->Alive);
    return visible;
  }

  /// The extinction whose opacity over the reference length is that of `extinction` times the factor
  /// of a gradient; as SampleClassifier.
  HWY_NOINLINE Vf WeighByGradient(Vf extinction, const Vec3& gradient) const
  {
    const Df d;
    const Di di;
    const Vec3 scaled{ hn::Mul(gradient.x, Splat(this->Scene.GradientScale[0])),
      hn::Mul(gradient.y, Splat(this->Scene.GradientScale[1])),
      hn::Mul(gradient.z, Splat(this->Scene.GradientScale[2])) };
    const Vf last = Splat(static_cast<float>(this->Scene.NumberOfGradientFactors - 1));
    const Vf magnitude = hn::Sqrt(Dot(scaled, scaled));
    const Vf x = hn::IfThenElseZero(hn::Eq(magnitude, magnitude), hn::Min(magnitude, last));
    const Vf whole = hn::Min(hn::Floor(x), hn::Sub(last, Splat(1.0f)));
    HWY_ALIGN int offsets[16];
    hn::Store(hn::ConvertTo(di, whole), di, offsets);
    const Vf factor = Lerp(LoadLanes<float, 4>(this->Scene.GradientFactors, 0, offsets),
      LoadLanes<float, 4>(this->Scene.GradientFactors, 4, offsets), hn::Sub(x, whole));
    const Vf one = Splat(1.0f);
    const Vf length = Splat(this->Scene.ReferenceLength);
    const Vf opacity =
      hn::Mul(factor, hn::Sub(one, Exp2(hn::Neg(hn::Mul(extinction, length)))));
    // What is nearly transparent has no digits left in 1 - opacity, but its logarithm is linear.
    const Vf passed = hn::Sub(one, opacity);
    const Vf logarithm = hn::IfThenElse(hn::Lt(opacity, Splat(1e-3f)),
      hn::Mul(hn::Mul(opacity, Splat(1.4426950409f)),
        hn::MulAdd(opacity, Splat(0.5f), one)),
      hn::Neg(Log2(hn::Max(passed, Splat(1e-30f)))));
    const Vf weighed = hn::Div(hn::Max(logarithm, hn::Zero(d)), length);
    return hn::IfThenElse(hn::Ge(factor, one), extinction, weighed);
  }

  /// What TakeSample does, for all that is not plain compositing; at s = n * ds.
  HWY_NOINLINE Mf TakeOtherSample(
    const PacketPiece& piece, const Vec3& q, Vf n, Vf ds, Mf sampled)
  {
    const Df d;
    const Vf s = hn::Mul(n, ds);
    CastStatistics& statistics = this->Scratch.Statistics;
    statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
    switch (this->Scene.Sampling)
    {
      case PacketSampling::Extreme:
        return this->TakeExtreme(piece, q, s, sampled);
      case PacketSampling::Sum:
        return this->AddUp(piece, q, s, ds, sampled);
      case PacketSampling::Surface:
        return this->CrossSurfaces(piece, q, n, ds, sampled);
      default:
        return this->TakeSamplePerRay(piece, s, ds, sampled);
    }
  }

  /// Values at positions inside of the volume.
  HWY_INLINE Vf ValuesAt(const Vec3& q, Mf lanes)
  {
    const SamplePosition at = FindCells(this->Scene.Volume, q, lanes);
    const Mf border = hn::AndNot(at.Interior, lanes);
    SampleRows<T> rows;
    Vf value = Sample<T>(this->Scene.Volume, at, rows);
    if (HWY_UNLIKELY(!hn::AllFalse(Df(), border)))
    {
      value = this->SampleBorder(q, border, value);
    }
    return value;
  }

  HWY_INLINE Vf TimeAt(const PacketPiece& piece, Vf s) const
  {
    return hn::MulAdd(s, Splat(piece.Dt), Splat(piece.T0));
  }

  /// Minima are maxima of what is below zero.
  HWY_INLINE Mf TakeExtreme(const PacketPiece& piece, const Vec3& q, Vf s, Mf sampled)
  {
    const Df d;
    const bool maximum = this->Scene.Source->Blend.Mode == BlendMode::Maximum;
    Vf value = this->ValuesAt(q, sampled);
    value = maximum ? value : hn::Neg(value);
    // Comparisons with what is not a number are false.
    const Mf better = hn::And(sampled, hn::Gt(value, this->Out.Tally));
    this->Scratch.Statistics.VisibleSamples +=
      static_cast<std::int64_t>(hn::CountTrue(d, better));
    this->Out.Tally = hn::IfThenElse(better, value, this->Out.Tally);
    this->Out.FirstVisible =
      hn::IfThenElse(better, this->TimeAt(piece, s), this->Out.FirstVisible);
    // Nothing is beyond the end of the range.
    const Vf end = Splat(maximum ? this->Scene.ValueHigh : -this->Scene.ValueLow);
    this->Alive = hn::AndNot(hn::Ge(this->Out.Tally, end), this->Alive);
    return hn::FirstN(d, 0);
  }

  HWY_INLINE Mf AddUp(const PacketPiece& piece, const Vec3& q, Vf s, Vf ds, Mf sampled)
  {
    const Df d;
    const Vf one = Splat(1.0f);
    const Vf value = this->ValuesAt(q, sampled);
    Mf counts = hn::And(sampled, hn::Eq(value, value));
    if (this->Scene.Source->Blend.Mode == BlendMode::Average)
    {
      counts = hn::And(counts,
        hn::And(hn::Ge(value, Splat(this->Scene.AverageMin)),
          hn::Le(value, Splat(this->Scene.AverageMax))));
    }
    this->Scratch.Statistics.VisibleSamples +=
      static_cast<std::int64_t>(hn::CountTrue(d, counts));
    const Vf extinction = TableLookup(this->Scene, value).Extinction();
    const Vf opacity =
      hn::Sub(one, Exp2(hn::Neg(hn::Mul(extinction, Splat(this->Scene.UnitDistance)))));
    const Vf relative = hn::Mul(hn::Sub(value, Splat(this->Scene.ValueLow)),
      Splat(1.0f / (this->Scene.ValueHigh - this->Scene.ValueLow)));
    const Vf length = this->Scene.Settings.Opacity == OpacityLength::World
      ? hn::Mul(ds, Splat(piece.Dt))
      : hn::Mul(ds, this->LengthOf(piece.Velocity(s)));
    this->Out.Tally = hn::Add(this->Out.Tally,
      hn::IfThenElseZero(counts, hn::Mul(hn::Mul(opacity, relative), length)));
    this->Out.TallyLength =
      hn::Add(this->Out.TallyLength, hn::IfThenElseZero(counts, length));
    this->Out.FirstVisible = hn::IfThenElse(
      counts, hn::Min(this->Out.FirstVisible, this->TimeAt(piece, s)), this->Out.FirstVisible);
    return hn::FirstN(d, 0);
  }

  /// Hands the intervals from n to n + 1 that a surface may cross to the integrators.
  HWY_INLINE Mf CrossSurfaces(const PacketPiece& piece, const Vec3& q, Vf n, Vf ds, Mf lanes)
  {
    const Df d;
    const Vf next = hn::Add(n, Splat(1.0f));
    const Vec3 end = piece.At(hn::Mul(next, ds));
    const Mf insideA = hn::And(lanes, IsInside(this->Scene, q));
    const Mf insideB = hn::And(lanes, IsInside(this->Scene, end));
    Vf a = this->Out.Tally;
    const Mf unknown = hn::AndNot(hn::Eq(this->Out.TallyStep, n), insideA);
    if (!hn::AllFalse(d, unknown))
    {
      a = hn::IfThenElse(unknown, this->ValuesAt(q, unknown), a);
    }
    const Vf b = hn::AllFalse(d, insideB) ? a : this->ValuesAt(end, insideB);
    this->Out.Tally = hn::IfThenElse(insideB, b, this->Out.Tally);
    this->Out.TallyStep = hn::IfThenElse(insideB, next, this->Out.TallyStep);
    // A value that is not clearly on one side counts as crossing: the integrator knows exactly.
    const Vf margin = Splat(1e-5f * (this->Scene.ValueHigh - this->Scene.ValueLow));
    const Vf low = hn::Sub(hn::Min(a, b), margin);
    const Vf high = hn::Add(hn::Max(a, b), margin);
    Mf crossed = hn::FirstN(d, 0);
    for (const float iso : this->Scene.IsoValues)
    {
      crossed = hn::Or(crossed, hn::And(hn::Le(low, Splat(iso)), hn::Ge(high, Splat(iso))));
    }
    // The volume begins or ends in the interval.
    const Mf faces = hn::Xor(insideA, insideB);
    crossed = hn::Or(hn::And(crossed, hn::And(insideA, insideB)), faces);
    return hn::AllFalse(d, crossed)
      ? crossed
      : this->TakeSamplePerRay(piece, hn::Mul(n, ds), ds, crossed);
  }

  /// What TakeSample does, by the integrators of the rays.
  HWY_NOINLINE Mf TakeSamplePerRay(const PacketPiece& piece, Vf s, Vf ds, Mf sampled)
  {
    const Df d;
    HWY_ALIGN float at[16], interval[16], flag[16];
    HWY_ALIGN float curve[9][16];
    hn::Store(s, d, at);
    hn::Store(ds, d, interval);
    hn::Store(hn::IfThenElseZero(sampled, Splat(1.0f)), d, flag);
    const Vf terms[9] = { piece.Start.x, piece.Start.y, piece.Start.z, piece.Linear.x,
      piece.Linear.y, piece.Linear.z, piece.Quadratic.x, piece.Quadratic.y, piece.Quadratic.z };
    for (int i = 0; i < 9; ++i)
    {
      hn::Store(terms[i], d, curve[i]);
    }
    HWY_ALIGN float visible[16] = {};
    HWY_ALIGN float done[16] = {};
    CastStatistics& statistics = this->Scratch.Statistics;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      if (flag[lane] == 0.0f)
      {
        continue;
      }
      const auto term = [&](int i)
      { return glm::dvec3(curve[i][lane], curve[i + 1][lane], curve[i + 2][lane]); };
      const RayPiece one(*this, piece, lane, { term(0), term(3), term(6) });
      const RayIntegrator::Outcome outcome = this->Scratch.Integrators[lane].AddSample(
        one, static_cast<double>(at[lane]), static_cast<double>(interval[lane]));
      statistics.VisibleSamples += outcome.Visible ? 1 : 0;
      visible[lane] = outcome.Visible ? 1.0f : 0.0f;
      done[lane] = outcome.Done ? 1.0f : 0.0f;
    }
    const Vf zero = hn::Zero(d);
    this->Alive = hn::AndNot(hn::Gt(hn::Load(d, done), zero), this->Alive);
    return hn::Gt(hn::Load(d, visible), zero);
  }

  /// The piece of one ray.
  class RayPiece : public SampledPiece
  {
  public:
    RayPiece(Packet& packet, const PacketPiece& piece, std::size_t lane, const CurvePiece& curve)
      : SampledPiece(curve, static_cast<double>(piece.T0), static_cast<double>(piece.Dt))
      , Whole(packet)
      , OfAll(piece)
      , Lane(lane)
    {
    }

    glm::dvec3 GradientToWorld(double s, const glm::dvec3& byIndex) const override
    {
      return this->Whole.GradientOfRay(this->OfAll, this->Lane, static_cast<float>(s), byIndex);
    }

  private:
    Packet& Whole;
    const PacketPiece& OfAll;
    std::size_t Lane;
  };

  /// The gradient by world coordinates at s on one of the rays, from that by index coordinates.
  HWY_NOINLINE glm::dvec3 GradientOfRay(
    const PacketPiece& piece, std::size_t lane, float s, const glm::dvec3& byIndex)
  {
    // Scaled: squares of huge or tiny scalars are no floats.
    const double size =
      std::max({ std::abs(byIndex.x), std::abs(byIndex.y), std::abs(byIndex.z) });
    if (!(size > 0.0) || !std::isfinite(size))
    {
      return glm::dvec3(0.0);
    }
    const Df d;
    const Vec3 g{ Splat(static_cast<float>(byIndex.x / size)),
      Splat(static_cast<float>(byIndex.y / size)), Splat(static_cast<float>(byIndex.z / size)) };
    const Vf at = Splat(s);
    const Vf t = Splat(piece.T0 + s * piece.Dt);
    Vec3 local;
    if (this->Scene.Identity)
    {
      local = Transform(this->Scene.GradientToRest, g);
    }
    else if (piece.Nodes != LateralNodes::None)
    {
      Vf determinant;
      local = this->GradientFromFrames(piece, g, at, t, determinant);
      const Vf magnitude = hn::Max(hn::Abs(determinant), Splat(1e-30f));
      local = Scale(hn::Div(hn::CopySign(Splat(1.0f), determinant), magnitude), local);
    }
    else
    {
      local = this->GradientFromField(piece.At(at), g, t);
    }
    HWY_ALIGN float x[16], y[16], z[16];
    hn::Store(local.x, d, x);
    hn::Store(local.y, d, y);
    hn::Store(local.z, d, z);
    return size * glm::dvec3(x[lane], y[lane], z[lane]);
  }

  /// Lanes whose fetches would leave the volume, but which have voxels around them.
  HWY_INLINE Mf BetweenVoxels(const Vec3& q, Mf border) const
  {
    const PacketVolume& v = this->Scene.Volume;
    if (std::is_same<T, WideScalar>::value || v.Nearest)
    {
      return hn::FirstN(Df(), 0);
    }
    const Vf zero = hn::Zero(Df());
    const auto within = [&](Vf x, int a) {
      return hn::And(
        hn::Ge(x, zero), hn::Le(x, Splat(static_cast<float>(v.Dimensions[a] - 1))));
    };
    return hn::And(border, hn::And(within(q.x, 0), hn::And(within(q.y, 1), within(q.z, 2))));
  }

  /// Samples whose fetches would leave the volume.
  HWY_NOINLINE Vf SampleBorder(const Vec3& q, Mf border, Vf value)
  {
    const Df d;
    const Mf between = this->BetweenVoxels(q, border);
    if constexpr (!std::is_same<T, WideScalar>::value)
    {
      if (!hn::AllFalse(d, between))
      {
        this->Border.Fill(this->Scene.Volume, q, between);
        SampleRows<T> rows;
        value = hn::IfThenElse(between, this->Border.Sample(rows), value);
      }
    }
    const Mf others = hn::AndNot(between, border);
    return hn::AllFalse(d, others) ? value : this->SampleByReference(q, others, value);
  }

  /// Their gradients, after SampleBorder().
  HWY_NOINLINE Vec3 GradientAtBorder(const Vec3& q, Mf border, const Vec3& gradient) const
  {
    const Df d;
    const Mf between = this->BetweenVoxels(q, border);
    Vec3 result = gradient;
    if constexpr (!std::is_same<T, WideScalar>::value)
    {
      if (!hn::AllFalse(d, between))
      {
        SampleRows<T> rows;
        this->Border.Sample(rows);
        const Vec3 g = AtFaces(this->Scene.Volume, q, this->Border.Gradient(rows));
        result = { hn::IfThenElse(between, g.x, gradient.x),
          hn::IfThenElse(between, g.y, gradient.y), hn::IfThenElse(between, g.z, gradient.z) };
      }
    }
    const Mf others = hn::AndNot(between, border);
    return hn::AllFalse(d, others) ? result : this->GradientByReference(q, others, result);
  }

  /// The same by the reference functions.
  HWY_NOINLINE Vf SampleByReference(const Vec3& q, Mf border, Vf value) const
  {
    const Df d;
    HWY_ALIGN float x[16], y[16], z[16], values[16], flag[16];
    hn::Store(q.x, d, x);
    hn::Store(q.y, d, y);
    hn::Store(q.z, d, z);
    hn::Store(value, d, values);
    hn::Store(hn::IfThenElseZero(border, Splat(1.0f)), d, flag);
    const PacketVolume& v = this->Scene.Volume;
    for (std::size_t i = 0; i < hn::Lanes(d); ++i)
    {
      if (flag[i] != 0.0f)
      {
        const double scalar =
          this->Scene.Reference.Value(this->Scene.Source->Volume, glm::dvec3(x[i], y[i], z[i]));
        values[i] = static_cast<float>((scalar - v.Shift) * v.Scale);
      }
    }
    return hn::Load(d, values);
  }

  HWY_NOINLINE Vec3 GradientByReference(const Vec3& q, Mf border, const Vec3& gradient) const
  {
    // Over two voxels and scaled, as fetched: squares of huge or tiny scalars are no floats.
    return ReplaceLanes(border, q, gradient,
      [&](const glm::dvec3& at) {
        return this->Scene.Reference.Gradient(this->Scene.Source->Volume, at) *
          (2.0 * this->Scene.Volume.Scale);
      });
  }

  /// Colour of a lit sample: the normal is J_Phi^T grad f, with J_Phi from the tile's own grid.
  HWY_INLINE Vec3 ShadeSample(const PacketPiece& piece, const Vec3& q, const Vec3& colour,
    const Vec3& byIndex, Vf s, Vf t)
  {
    Vec3 gradient; // by coordinates of the lights' space
    if (this->Scene.Identity)
    {
      gradient = Transform(this->Scene.IndexGradientToLights, byIndex);
    }
    else if (piece.Nodes != LateralNodes::None)
    {
      // Only the direction of the gradient is used, but it must not be turned around.
      Vf determinant;
      const Vec3 local = this->GradientFromFrames(piece, byIndex, s, t, determinant);
      gradient = Transform(
        this->Scene.GradientToLights, Scale(hn::CopySign(Splat(1.0f), determinant), local));
    }
    else
    {
      gradient = Transform(this->Scene.GradientToLights, this->GradientFromField(q, byIndex, t));
    }
    const auto position = [&] {
      return Transform(
        this->Scene.LocalToLights, MulAdd(t, this->Rays.Direction, this->Rays.Origin));
    };
    const Vec3 toEye =
      this->Scene.Parallel ? Normalize(Sub(Broadcast(this->Scene.Eye), position())) : this->ToEye;
    return Shade(this->Scene, colour, gradient, toEye, position);
  }

  /**
   * Along the image axes u, v and the ray parameter t both the deformed points P and the rest
   * points Q are known, so the gradient G by P solves G . P_u = g . Q_u, and so on for v and t.
   * Derivatives across the tile are those of its node interpolation, at the start and the end of
   * the piece and linear in between. Returns G times `determinant`.
   */
  HWY_INLINE Vec3 GradientFromFrames(
    const PacketPiece& piece, const Vec3& byIndex, Vf s, Vf t, Vf& determinant)
  {
    if (!this->HaveFrames)
    {
      this->HaveFrames = true;
      // By steps of a node of the tile.
      const bool quarter = piece.Nodes == LateralNodes::Quarter;
      const NodeWeights& weights = quarter ? this->InQuarter() : this->Weights;
      const Vf scale = Splat(quarter ? QuarterNodesPerPixel / NodesPerPixel : 1.0f);
      for (int end = 0; end < 2; ++end)
      {
        const TileLayer& layer = this->LayerOf(piece.Nodes, piece.Step + end * piece.Steps);
        this->QuU[end] = Scale(scale, weights.SlopeX(layer));
        this->QuV[end] = Scale(scale, weights.SlopeY(layer));
      }
      if (!this->HaveAcross)
      {
        this->HaveAcross = true;
        const NodeRays& rays = this->Grid.GetRays();
        this->OriginU = this->Weights.SlopeX(rays.Origins);
        this->OriginV = this->Weights.SlopeY(rays.Origins);
        this->DirectionU = this->Weights.SlopeX(rays.Directions);
        this->DirectionV = this->Weights.SlopeY(rays.Directions);
      }
    }
    const auto between = [&](const Vec3 ends[2])
    { return MulAdd(s, Sub(ends[1], ends[0]), ends[0]); };
    const Vf gu = Dot(byIndex, between(this->QuU));
    const Vf gv = Dot(byIndex, between(this->QuV));
    const Vf gt = hn::Mul(Dot(byIndex, piece.Velocity(s)), Splat(1.0f / piece.Dt));
    const Vec3 pu = MulAdd(t, this->DirectionU, this->OriginU);
    const Vec3 pv = MulAdd(t, this->DirectionV, this->OriginV);
    const Vec3& pt = this->Rays.Direction;
    const Vec3 vt = Cross(pv, pt);
    determinant = Dot(pu, vt);
    return MulAdd(gu, vt, MulAdd(gv, Cross(pt, pu), Scale(gt, Cross(pu, pv))));
  }

  /// The same with J_Phi at the sample itself, where nodes of the tile are too far apart.
  HWY_NOINLINE Vec3 GradientFromField(const Vec3& index, const Vec3& byIndex, Vf t) const
  {
    const Vec3 p = MulAdd(t, this->Rays.Direction, this->Rays.Origin);
    const Vec3 q = IndexToLocal(this->Scene, index);
    Vec3 columns[3];
    PullBackJacobian(this->Scene, p, q, columns[0], columns[1], columns[2]);
    const Vec3 rest = Transform(this->Scene.GradientToRest, byIndex);
    return { Dot(columns[0], rest), Dot(columns[1], rest), Dot(columns[2], rest) };
  }

  const PacketScene& Scene;
  TileGrid& Grid;
  TileBeam& Beam;
  PacketScratch& Scratch;
  RayPacket Rays;
  Vec3 ToEye; ///< back along them, in the space of the lights
  Vf Phase;
  Mf Alive;
  Vf X;
  Vf Y;
  NodeWeights Weights; ///< of the nodes of the tile
  int Quarter = -1;    ///< of the tile, and the weights of its nodes: found on first use
  NodeWeights QuarterWeights;
  PacketPixels Out;
  float Reach = std::numeric_limits<float>::infinity();
  PacketLook Kept; ///< the empty cube that was found last where a piece began, for each ray

  /// Voxels of the last samples at faces of the volume.
  RepeatedVoxels<std::conditional_t<std::is_same<T, WideScalar>::value, float, T>> Border;

  // Derivatives of the current piece, found when its first visible sample is shaded.
  bool HaveFrames = false;
  Vec3 QuU[2];
  Vec3 QuV[2];

  // Derivatives of the viewing rays across the tile, found with them.
  bool HaveAcross = false;
  Vec3 OriginU;
  Vec3 OriginV;
  Vec3 DirectionU;
  Vec3 DirectionV;
};

/// Rays of a tile, packet by packet, as they lie in PacketScratch::Rays.
struct StoredRays
{
  float* Data;
  explicit StoredRays(PacketScratch& scratch)
    : Data(scratch.Rays.data())
  {
  }
  HWY_INLINE void Set(std::size_t first, const RayPacket& rays) const
  {
    const Df d;
    const Vf all[8] = { rays.Origin.x, rays.Origin.y, rays.Origin.z, rays.Direction.x,
      rays.Direction.y, rays.Direction.z, rays.From, rays.To };
    for (int i = 0; i < 8; ++i)
    {
      hn::StoreU(all[i], d, this->Data + 256 * i + first);
    }
  }
  HWY_INLINE RayPacket Get(std::size_t first) const
  {
    const Df d;
    const auto load = [&](int i) { return hn::LoadU(d, this->Data + 256 * i + first); };
    return { { load(0), load(1), load(2) }, { load(3), load(4), load(5) }, load(6), load(7) };
  }
};

/// Shape of a packet: up to four rays wide.
struct PacketShape
{
  int Lanes;
  int Width;
  int Height;
};

HWY_INLINE PacketShape GetPacketShape()
{
  const int lanes = static_cast<int>(hn::Lanes(Df()));
  const int width = lanes < 4 ? lanes : 4;
  return { lanes, width, lanes / width };
}

/// FindJitter() of the pixels of a packet.
HWY_NOINLINE Vf JitterOf(const PacketScene& scene, int x0, int y0)
{
  const Df d;
  const PacketShape shape = GetPacketShape();
  const glm::ivec2 origin = scene.Source->Camera.PixelOrigin;
  HWY_ALIGN float jitter[16];
  for (int lane = 0; lane < shape.Lanes; ++lane)
  {
    jitter[lane] = static_cast<float>(FindJitter(
      x0 + lane % shape.Width + origin.x, y0 + lane / shape.Width + origin.y));
  }
  return hn::Load(d, jitter);
}

/// Rays end where something opaque was drawn.
HWY_INLINE void ClipToDepths(
  const PacketScene& scene, const CastImage& image, int x0, int y0, RayPacket& rays)
{
  const Df d;
  const PacketShape shape = GetPacketShape();
  const CameraView& camera = scene.Source->Camera;
  HWY_ALIGN float to[16];
  hn::Store(rays.To, d, to);
  for (int lane = 0; lane < shape.Lanes; ++lane)
  {
    const int x = x0 + lane % shape.Width;
    const int y = y0 + lane / shape.Width;
    if (x >= image.Width || y >= image.Height)
    {
      continue;
    }
    const double depth = scene.Source->Depths[static_cast<std::size_t>(y) * image.Width + x];
    if (depth < 1.0)
    {
      const ViewRay ray = camera.MakeRay(x + 0.5, y + 0.5);
      to[lane] = std::min(
        to[lane], static_cast<float>(camera.DepthToT(ray, x + 0.5, y + 0.5, depth)));
    }
  }
  rays.To = hn::Load(d, to);
}

HWY_INLINE void StorePixels(const PacketScene& scene, const CastImage& image, int x0, int y0,
  Mf active, const PacketPixels& pixels)
{
  const Df d;
  const PacketShape shape = GetPacketShape();
  HWY_ALIGN float r[16], g[16], b[16], a[16], t[16];
  const Vf zero = hn::Zero(d);
  hn::Store(hn::IfThenElse(active, pixels.Colour.x, zero), d, r);
  hn::Store(hn::IfThenElse(active, pixels.Colour.y, zero), d, g);
  hn::Store(hn::IfThenElse(active, pixels.Colour.z, zero), d, b);
  hn::Store(
    hn::IfThenElse(active, hn::Sub(Splat(1.0f), pixels.Transmittance), zero), d, a);
  hn::Store(hn::IfThenElse(active, pixels.FirstVisible, Splat(1e30f)), d, t);
  for (int lane = 0; lane < shape.Lanes; ++lane)
  {
    const int x = x0 + lane % shape.Width;
    const int y = y0 + lane / shape.Width;
    if (x >= image.Width || y >= image.Height)
    {
      continue;
    }
    const std::size_t at = static_cast<std::size_t>(y) * image.Width + x;
    float* colour = image.Colours + 4 * at;
    colour[0] = r[lane];
    colour[1] = g[lane];
    colour[2] = b[lane];
    colour[3] = a[lane];
    if (image.Depths)
    {
      image.Depths[at] = 1.0f;
      if (t[lane] < 1e29f)
      {
        const ViewRay ray = scene.Source->Camera.MakeRay(x + 0.5, y + 0.5);
        image.Depths[at] = static_cast<float>(scene.Source->Camera.ToDepth(
          ray.Origin + static_cast<double>(t[lane]) * ray.Direction));
      }
    }
  }
}

/// What StorePixels() stores of a packet none of whose rays meets anything.
HWY_INLINE void ClearPixels(const CastImage& image, int x0, int y0)
{
  const PacketShape shape = GetPacketShape();
  const int width = std::min(shape.Width, image.Width - x0);
  for (int y = y0; width > 0 && y < std::min(y0 + shape.Height, image.Height); ++y)
  {
    const std::size_t at = static_cast<std::size_t>(y) * image.Width + x0;
    std::fill_n(image.Colours + 4 * at, 4 * width, 0.0f);
    if (image.Depths)
    {
      std::fill_n(image.Depths + at, width, 1.0f);
    }
  }
}

/// The reaches of the quarters of a tile, see CastImage.
class TileReaches
{
public:
  TileReaches(int x0, int y0, unsigned int quarters, const CastImage& image)
    : X(x0)
    , Y(y0)
    , Quarters(quarters)
    , Image(image)
  {
  }

  /// Whether the packet at a pixel is in a quarter that is asked for.
  HWY_INLINE bool IsWanted(int x, int y) const { return (this->Quarters >> this->At(x, y) & 1) != 0; }

  HWY_INLINE void Include(int x, int y, float reach)
  {
    float& here = this->Reaches[this->At(x, y)];
    here = std::max(here, reach);
  }

  HWY_INLINE void Store() const
  {
    if (!this->Image.Reaches)
    {
      return;
    }
    const int perRow = (this->Image.Width + QuarterSide - 1) / QuarterSide;
    for (int quarter = 0; quarter < 4; ++quarter)
    {
      const int x = this->X + quarter % 2 * QuarterSide;
      const int y = this->Y + quarter / 2 * QuarterSide;
      if (x < this->Image.Width && y < this->Image.Height && this->IsWanted(x, y))
      {
        this->Image.Reaches[y / QuarterSide * perRow + x / QuarterSide] = this->Reaches[quarter];
      }
    }
  }

private:
  static constexpr int QuarterSide = TileSide / 2;

  HWY_INLINE int At(int x, int y) const
  {
    return (x - this->X >= QuarterSide ? 1 : 0) + (y - this->Y >= QuarterSide ? 2 : 0);
  }

  int X;
  int Y;
  unsigned int Quarters;
  const CastImage& Image;
  float Reaches[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
};

template <class T>
HWY_NOINLINE int CastTile(const PacketScene& scene, int x0, int y0, unsigned int quarters,
  const CastImage& image, PacketScratch& scratch, int first, Deadline deadline)
{
  const Df d;
  const PacketShape shape = GetPacketShape();
  const StoredRays stored(scratch);
  const CameraView& camera = scene.Source->Camera;
  const ImageMap near(scene.NdcToLocal, camera, -1.0);
  const ImageMap far(scene.NdcToLocal, camera, 1.0);

  HWY_ALIGN float laneX[16];
  HWY_ALIGN float laneY[16];
  for (int lane = 0; lane < shape.Lanes; ++lane)
  {
    laneX[lane] = static_cast<float>(lane % shape.Width);
    laneY[lane] = static_cast<float>(lane / shape.Width);
  }
  const Vf dx = hn::Load(d, laneX);
  const Vf dy = hn::Load(d, laneY);

  float tMin = 1e30f;
  float tMax = -1e30f;
  TileReaches reaches(x0, y0, quarters, image);
  const std::size_t firstPacket = static_cast<std::size_t>(first);
  std::size_t packet = 0;
  for (int y = y0; y < y0 + TileSide; y += shape.Height)
  {
    for (int x = x0; x < x0 + TileSide; x += shape.Width, ++packet)
    {
      if (!reaches.IsWanted(x, y))
      {
        continue;
      }
      const Vf px = hn::Add(Splat(static_cast<float>(x) + 0.5f), dx);
      const Vf py = hn::Add(Splat(static_cast<float>(y) + 0.5f), dy);
      RayPacket rays = MakeRays(scene, near, far, px, py);
      if (scene.Source->Depths)
      {
        ClipToDepths(scene, image, x, y, rays);
      }
      ClipToBounds(scene, rays);
      const Mf inImage = hn::And(hn::Lt(px, Splat(static_cast<float>(image.Width))),
        hn::Lt(py, Splat(static_cast<float>(image.Height))));
      const Mf active = hn::And(inImage, hn::Lt(rays.From, rays.To));
      // Rays that miss what there is now may meet what there will be; of those that were cast before
      // the last stop nothing is known any more.
      if (packet < firstPacket || !hn::AllFalse(d, hn::AndNot(active, inImage)))
      {
        reaches.Include(x, y, std::numeric_limits<float>::infinity());
      }
      rays.To = hn::IfThenElse(active, rays.To, Splat(-1.0f));
      stored.Set(packet * static_cast<std::size_t>(shape.Lanes), rays);
      tMin = std::min(tMin, SmallestLane(hn::IfThenElse(active, rays.From, Splat(1e30f))));
      tMax = std::max(tMax, LargestLane(hn::IfThenElse(active, rays.To, Splat(-1e30f))));
      scratch.Statistics.Rays +=
        firstPacket > 0 ? 0 : static_cast<std::int64_t>(hn::CountTrue(d, active));
    }
  }

  const bool any = tMin < tMax;
  TileGrid grid(scene, scratch);
  if (any)
  {
    grid.SetRays(near, far, x0, y0);
    const TileLayer& from = grid.GetRays().Origins;
    const TileLayer& along = grid.GetRays().Directions;
    glm::dvec3 origins[4];
    glm::dvec3 directions[4];
    const int corners[4] = { 0, 3, 12, 15 };
    for (int c = 0; c < 4; ++c)
    {
      const int i = corners[c];
      origins[c] = scene.Centre + glm::dvec3(from.X[i], from.Y[i], from.Z[i]);
      directions[c] = glm::dvec3(along.X[i], along.Y[i], along.Z[i]);
    }
    TileSpans& spans = scratch.Spans;
    spans.Start(*scene.Source->Bounds, scene.Settings.Spans, scene.Source->Volume.DataToIndex,
      origins, directions, tMin, tMax);
    grid.Start(spans.GetNumberOfSpans(), scene.Settings.Spans.LargestLevel, spans.GetFirst(),
      static_cast<float>(scene.Settings.Spans.Length));
  }
  TileBeam beam(scene, grid, scratch);

  packet = 0;
  for (int y = y0; y < y0 + TileSide; y += shape.Height)
  {
    for (int x = x0; x < x0 + TileSide; x += shape.Width, ++packet)
    {
      if (packet < firstPacket || !reaches.IsWanted(x, y))
      {
        continue;
      }
      const RayPacket rays = stored.Get(packet * static_cast<std::size_t>(shape.Lanes));
      const Mf active = hn::Lt(rays.From, rays.To);
      if (hn::AllFalse(d, active))
      {
        ClearPixels(image, x, y);
        continue;
      }
      const Vf tileX = hn::Add(Splat(static_cast<float>(x - x0)), dx);
      const Vf tileY = hn::Add(Splat(static_cast<float>(y - y0)), dy);
      const Vf phase = scene.Intervals
        ? hn::Zero(d)
        : PhaseOf(scene, rays, scene.Settings.Jitter ? JitterOf(scene, x, y) : hn::Zero(d));
      Packet<T> cast(scene, grid, beam, scratch, rays, tileX, tileY, phase, active);
      if (HWY_UNLIKELY(scene.Sampling != PacketSampling::Composite))
      {
        cast.BeginRays(x, y, shape.Width);
        cast.Cast();
        cast.EndRays();
      }
      else
      {
        cast.Cast();
      }
      StorePixels(scene, image, x, y, active, cast.GetPixels());
      reaches.Include(x, y, cast.GetReach());
      if (deadline != NoDeadline && std::chrono::steady_clock::now() >= deadline)
      {
        return static_cast<int>(packet) + 1;
      }
    }
  }
  reaches.Store();
  return 0;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
