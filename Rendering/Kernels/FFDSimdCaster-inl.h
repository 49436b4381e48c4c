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

#include "FFDSimdComponents-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdLeap-inl.h"
#include "FFDSimdMask-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPieces-inl.h"
#include "FFDSimdPullBack-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdShading-inl.h"
#include "FFDSimdTable-inl.h"
#include "FFDSimdWindow-inl.h"

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
  Vf TallyLength;  ///< what has been summed up over, data units
  Vf TallyStep;    ///< number of the sample whose value is known, or a negative one
};

HWY_INLINE Mf IsInside(const PacketScene& scene, const Vec3& q)
{
  const Vf lower = Splat(scene.Lower);
  const auto within = [&](Vf x, int a) {
    return hn::And(hn::Ge(x, lower), hn::Le(x, Splat(scene.Upper[a])));
  };
  return hn::And(within(q.x, 0), hn::And(within(q.y, 1), within(q.z, 2)));
}

/// The curves of a packet over some samples, index coordinates; s runs from 0 to 1.
struct PacketCurve
{
  Quartic Position;
  Vf T0; ///< t = T0 + s * Dt
  Vf Dt;
  Vf PerStep;                 ///< s from sample to sample
  TilePiece* Piece = nullptr; ///< that is cast by curves, or null
  bool Interpolated = false;  ///< whether the curves are those of its interpolant
  int X = 0;                  ///< first pixel of the packet, from that of the square of the piece
  Vf Row;                     ///< rows of pixels in the square

  HWY_INLINE Vf TimeAt(Vf s) const { return hn::MulAdd(s, this->Dt, this->T0); }
};

template <class T>
class Packet
{
public:
  /**
   * (x, y): first pixel of the packet, from that of the tile. `rows`: rows of its pixels from y on.
   * `phase`: part of an interval by which the samples of each ray are moved on.
   */
  Packet(const PacketScene& scene, TilePieces& pieces, PacketScratch& scratch,
    const RayPacket& rays, int x, int y, Vf rows, Vf phase, Mf active)
    : Scene(scene)
    , Pieces(pieces)
    , Scratch(scratch)
    , Rays(rays)
    , Phase(phase)
    , Alive(active)
    , X(x)
    , Y(y)
    , Rows(rows)
    , Window(scene.Volume)
  {
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
    this->FindSamples();
    const int top = this->Scene.SamplesPerTop;
    const int first = std::max(this->Pieces.GetFirst(), FloorDivide(this->FirstSample, top));
    const int last = std::min(this->Pieces.GetLast(), FloorDivide(this->EndSample - 1, top));
    for (int index = first; index <= last && !hn::AllFalse(d, this->Alive); ++index)
    {
      this->CastPiece(this->Pieces.GetTop(index));
    }
  }

  /// The t at which the last ray has ended; infinite where one went on to the end.
  float GetReach() const { return this->Reach; }

private:
  static constexpr float NoExtreme = 3e38f;
  /// Samples from one that is nowhere in the volume to the next one that is looked for.
  static constexpr int SamplesOfNothing = 4;
  /// Kept between a leap and the faces of an empty cube, index units: rounding errors.
  static constexpr float LeapGuard[3] = { 2e-3f, 2e-3f, 2e-3f };

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

  static int FloorDivide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

  /**
   * Which samples each ray takes: whole numbers n, at t = (n + phase) * sample distance, where
   * First <= n < Stop. Of blend modes that use intervals that which holds From is the first.
   */
  HWY_INLINE void FindSamples()
  {
    const Vf inverse = Splat(static_cast<float>(1.0 / this->Scene.Settings.SampleDistance));
    // A sample at the very start of the range belongs to it, rounding errors or not.
    const Vf slack = Splat(1e-3f);
    const Vf early = this->Scene.Intervals ? Splat(1.0f - 1e-3f) : hn::Add(slack, this->Phase);
    this->First = hn::Ceil(hn::Sub(hn::Mul(this->Rays.From, inverse), early));
    this->Stop = hn::Ceil(hn::Sub(hn::Sub(hn::Mul(this->Rays.To, inverse), slack), this->Phase));
    const Vf big = Splat(1e9f);
    const Vf first = hn::IfThenElse(this->Alive, this->First, big);
    const Vf stop = hn::IfThenElse(this->Alive, this->Stop, hn::Neg(big));
    const float low = SmallestLane(hn::IfThenElse(this->Alive, this->Phase, Splat(1.0f)));
    const float high = LargestLane(hn::IfThenElse(this->Alive, this->Phase, hn::Zero(Df())));
    this->MiddlePhase = 0.5f * (low + high);
    this->PhaseRange = 0.5f * (high - low);
    this->FirstSample = static_cast<int>(SmallestLane(first));
    this->EndSample = static_cast<int>(LargestLane(stop));
  }

  /// Takes the samples of the packet that lie in a piece.
  HWY_NOINLINE void CastPiece(TilePiece& piece)
  {
    if (piece.FirstSample >= this->EndSample ||
      piece.FirstSample + piece.Samples <= this->FirstSample || hn::AllFalse(Df(), this->Alive))
    {
      return;
    }
    switch (this->Pieces.Find(piece))
    {
      case TilePiece::State::Empty:
        return;
      case TilePiece::State::Halved:
        this->CastPiece(*piece.Children[0]);
        this->CastPiece(*piece.Children[1]);
        return;
      case TilePiece::State::Quartered:
      {
        const int half = piece.Side / 2;
        const std::size_t right = this->X - piece.X >= half ? 1 : 0;
        const std::size_t high = this->Y - piece.Y >= half ? 2 : 0;
        this->CastPiece(*piece.Children[right + high]);
        return;
      }
      case TilePiece::State::PerSample:
        this->CastPerSample(piece);
        return;
      default:
        this->CastCurves(piece);
        return;
    }
  }

  /// The first part, from `part` on and before `end`, in which something may be seen; `end` or more
  /// where there is none.
  HWY_INLINE int FindNeeded(TilePiece& piece, int block, int part, int end)
  {
    while (part < end)
    {
      this->Pieces.NeedPart(piece, part);
      const std::uint32_t needed = piece.Needed[static_cast<std::size_t>(block)] >> part;
      if (needed != 0)
      {
        return part + static_cast<int>(hwy::Num0BitsBelowLS1Bit_Nonzero32(needed));
      }
      part = piece.KnownParts;
    }
    return part;
  }

  HWY_NOINLINE void BeginCurves(TilePiece& piece, int x, int y, int block, PacketCurve& curve)
  {
    this->FindCurve(piece, x, y, curve);
    this->CountPiece(piece);
    this->HaveSlopes = false;
    if constexpr (HasVoxelWindow<T>())
    {
      this->Window.Follow(piece, block, this->MiddlePhase, this->PhaseRange);
    }
    this->Out.TallyStep = Splat(-1e30f);
    this->SkipTo = Splat(-1e30f);
    this->Expecting = hn::FirstN(Df(), 0);
  }

  HWY_INLINE void CastCurves(TilePiece& piece)
  {
    const int x = this->X - piece.X;
    const int y = this->Y - piece.Y;
    const int block = y / BlockSide * (piece.Side / BlockSide) + x / BlockSide;
    PacketCurve curve;
    bool begun = false;
    const int first = std::max(0, this->FirstSample - piece.FirstSample) / piece.SamplesPerPart;
    const int samples = std::min(piece.Samples, this->EndSample - piece.FirstSample);
    const int end = (samples + piece.SamplesPerPart - 1) / piece.SamplesPerPart;
    for (int part = this->FindNeeded(piece, block, first, end); part < end;
         part = this->FindNeeded(piece, block, part + 1, end))
    {
      const int from = piece.FirstSample + part * piece.SamplesPerPart;
      if (!begun)
      {
        this->BeginCurves(piece, x, y, block, curve);
        begun = true;
      }
      const int to = std::min(
        { from + piece.SamplesPerPart, piece.FirstSample + piece.Samples, this->EndSample });
      const bool within = (piece.Inside[static_cast<std::size_t>(block)] >> part & 1u) != 0;
      const bool inner =
        within && this->Scene.Inner && !piece.LeapsRays && !this->Scratch.Positions;
      for (int n = std::max(from, this->FirstSample); n < to; ++n)
      {
        const Vf s = hn::Mul(
          hn::Add(this->Phase, Splat(static_cast<float>(n - piece.FirstSample))), curve.PerStep);
        if (inner)
        {
          if (HWY_LIKELY(this->Scene.Plain))
          {
            this->template TakeInnerSample<true>(curve, n, s);
          }
          else
          {
            this->template TakeInnerSample<false>(curve, n, s);
          }
        }
        else
        {
          this->TakeSamples(curve, n, s, within);
        }
        if (HWY_UNLIKELY(hn::AllFalse(Df(), this->Alive)))
        {
          this->EndAt(n);
          return;
        }
      }
    }
  }

  /// Each sample is pulled back by itself, from the last one on.
  HWY_NOINLINE void CastPerSample(TilePiece& piece)
  {
    const Df d;
    this->CountPiece(piece);
    const int x = this->X - piece.X;
    const int y = this->Y - piece.Y;
    PacketCurve about;
    this->FindCurve(piece, x, y, about);
    // From the start of the piece on, wherever the rays begin: which of several branches of T^-1 is
    // followed must not depend on that.
    const int from = piece.FirstSample;
    const int to = std::min(piece.FirstSample + piece.Samples, this->EndSample);
    const float distance = static_cast<float>(this->Scene.Settings.SampleDistance);
    const auto timeOf = [&](int n) {
      return hn::Mul(hn::Add(this->Phase, Splat(static_cast<float>(n))), Splat(distance));
    };
    const auto positionAt = [&](int n, const Vec3& start) {
      // Where there was nothing there is likely to be nothing again.
      const Vec3 local = IndexToLocal(this->Scene, start);
      Mf active = this->Alive;
      if (n % SamplesOfNothing != 0)
      {
        active = hn::AndNot(IsNowhere(this->Scene, local), active);
      }
      if (hn::AllFalse(d, active))
      {
        return start;
      }
      const Vec3 p = MulAdd(timeOf(n), this->Rays.Direction, this->Rays.Origin);
      const Vec3 q = LocalToIndex(this->Scene,
        PullBackFrom(
          this->Scene, p, local, this->Scene.Tolerance, active, this->Scratch.Statistics));
      return Select(active, q, start);
    };
    PacketCurve curve;
    const Vf zero = hn::Zero(d);
    for (Vec3& term : curve.Position.Terms)
    {
      term = { zero, zero, zero };
    }
    curve.Dt = Splat(distance);
    curve.PerStep = Splat(1.0f);
    const Vf s = hn::Mul(this->Phase, about.PerStep);
    Vec3 next = positionAt(from, about.Position.At(s));
    Vec3 move = Scale(about.PerStep, about.Position.Slope(s));
    this->Out.TallyStep = Splat(-1e30f);
    for (int n = from; n < to; ++n)
    {
      curve.Position.Terms[0] = next;
      next = positionAt(n + 1, Add(next, move));
      move = Sub(next, curve.Position.Terms[0]);
      curve.Position.Terms[1] = move;
      curve.T0 = timeOf(n);
      this->TakeSamples(curve, n, zero, false);
      if (HWY_UNLIKELY(hn::AllFalse(d, this->Alive)))
      {
        this->EndAt(n);
        return;
      }
    }
  }

  HWY_INLINE void FindCurve(TilePiece& piece, int x, int y, PacketCurve& curve)
  {
    const Df d;
    curve.Piece = &piece;
    curve.T0 = Splat(piece.T0);
    curve.Dt = Splat(piece.Dt);
    curve.PerStep = Splat(1.0f / static_cast<float>(piece.Samples));
    if (this->Scene.Identity)
    {
      // Straight rays need no interpolation.
      const Vf zero = hn::Zero(d);
      const Vec3 nothing{ zero, zero, zero };
      curve.Position.Terms[0] =
        LocalToIndex(this->Scene, MulAdd(curve.T0, this->Rays.Direction, this->Rays.Origin));
      curve.Position.Terms[1] =
        Transform(this->Scene.LocalToIndex, Scale(curve.Dt, this->Rays.Direction));
      curve.Position.Terms[2] = nothing;
      curve.Position.Terms[3] = nothing;
      curve.Position.Terms[4] = nothing;
      return;
    }
    this->Pieces.NeedColumns(piece);
    curve.Interpolated = true;
    curve.X = x;
    curve.Row = hn::Mul(hn::Add(this->Rows, Splat(static_cast<float>(y))),
      Splat(3.0f / static_cast<float>(piece.Side - 1)));
    Vf rows[4];
    LagrangeWeights(curve.Row, rows);
    curve.Position = FindPacketCurve(piece.Columns, x, rows);
  }

  /// All rays have ended with the sample n.
  HWY_INLINE void EndAt(int n)
  {
    this->Reach = static_cast<float>((n + 2) * this->Scene.Settings.SampleDistance);
  }

  /// The sample n of every ray, at s of a curve.
  HWY_INLINE void TakeSamples(const PacketCurve& curve, int n, Vf s, bool within)
  {
    const Df d;
    const Vf number = Splat(static_cast<float>(n));
    Mf active =
      hn::And(this->Alive, hn::And(hn::Ge(number, this->First), hn::Lt(number, this->Stop)));
    if (HWY_UNLIKELY(hn::AllFalse(d, active)))
    {
      return;
    }
    const Vec3 q = curve.Position.At(s);
    if (!curve.Piece && this->Scene.Distances && !this->Scene.Intervals)
    {
      active = hn::AndNot(EmptySpaceQuery(this->Scene, q).IsEmpty(), active);
      if (hn::AllFalse(d, active))
      {
        return;
      }
    }
    if (curve.Piece && curve.Piece->LeapsRays)
    {
      active = this->LeapFrom(curve, q, number, active);
      if (hn::AllFalse(d, active))
      {
        return;
      }
    }
    if (HWY_UNLIKELY(this->Scratch.Positions))
    {
      this->NotePositions(q, curve.TimeAt(s), hn::And(active, IsInside(this->Scene, q)));
    }
    if (HWY_LIKELY(this->Scene.Plain))
    {
      if (!within)
      {
        active = hn::And(active, IsInside(this->Scene, q));
        if (hn::AllFalse(d, active))
        {
          return;
        }
      }
      this->template TakeSample<true>(curve, q, s, active);
    }
    else
    {
      if (!this->Scene.Intervals)
      {
        active = hn::And(active, this->IsShown(q, curve, s));
        if (hn::AllFalse(d, active))
        {
          return;
        }
      }
      if (this->Scene.Sampling == PacketSampling::Composite)
      {
        if (this->Scene.Volume.Components > 1)
        {
          this->TakeComponents(curve, q, s, active);
        }
        else
        {
          this->template TakeSample<false>(curve, q, s, active);
        }
      }
      else
      {
        this->TakeOtherSample(curve, q, s, number, active);
      }
    }
  }

  HWY_INLINE Vf LengthOf(const Vec3& index) const
  {
    const Vec3 data = Transform(this->Scene.IndexToLocal, index);
    return hn::Sqrt(Dot(data, data));
  }

  /**
   * The lanes of `active` that may see something. Those whose last sample was visible expect the
   * next one to be; the others look up how many samples of the piece are empty for certain.
   */
  HWY_NOINLINE Mf LeapFrom(const PacketCurve& curve, const Vec3& q, Vf number, Mf active)
  {
    const Df d;
    active = hn::And(active, hn::Ge(number, this->SkipTo));
    const Mf looking = hn::AndNot(this->Expecting, active);
    this->Expecting = hn::FirstN(d, 0);
    if (hn::AllFalse(d, looking))
    {
      return active;
    }
    const Vf steps =
      EmptySpaceQuery(this->Scene, q).CountSteps(LeapGuard, curve.Piece->Up, curve.Piece->Down);
    // An interval is empty if its end is in the cube, too.
    const Mf empty =
      hn::And(looking, hn::Ge(steps, this->Scene.Intervals ? Splat(1.0f) : hn::Zero(d)));
    const Vf more = this->Scene.Intervals ? steps : hn::Add(steps, Splat(1.0f));
    this->SkipTo = hn::IfThenElse(empty, hn::Add(number, more), this->SkipTo);
    this->Scratch.Statistics.DistanceLookups +=
      static_cast<std::int64_t>(hn::CountTrue(d, hn::And(empty, IsInside(this->Scene, q))));
    return hn::AndNot(empty, active);
  }

  HWY_NOINLINE void NotePositions(const Vec3& q, Vf t, Mf lanes)
  {
    const Df d;
    HWY_ALIGN float x[16], y[16], z[16], times[16], flag[16];
    hn::Store(q.x, d, x);
    hn::Store(q.y, d, y);
    hn::Store(q.z, d, z);
    hn::Store(t, d, times);
    hn::Store(hn::IfThenElseZero(lanes, Splat(1.0f)), d, flag);
    const int width = std::min(static_cast<int>(hn::Lanes(d)), 4);
    for (int lane = 0; lane < static_cast<int>(hn::Lanes(d)); ++lane)
    {
      if (flag[lane] != 0.0f)
      {
        this->Scratch.Positions->push_back({ this->Pieces.GetX() + this->X + lane % width,
          this->Pieces.GetY() + this->Y + lane / width, times[lane],
          { x[lane], y[lane], z[lane] } });
      }
    }
  }

  HWY_INLINE void CountPiece(const TilePiece& piece)
  {
    CastStatistics& statistics = this->Scratch.Statistics;
    const int rays = static_cast<int>(hn::CountTrue(Df(), this->Alive));
    statistics.Segments += rays;
    statistics.SegmentLength +=
      rays * (static_cast<double>(piece.Dt) / this->Scene.Source->VoxelSize);
  }

  /// Which positions are inside of the volume and not cropped.
  HWY_INLINE Mf IsShown(const Vec3& q, const PacketCurve& curve, Vf s) const
  {
    const Mf inside = IsInside(this->Scene, q);
    if (this->Scene.CropSpace == Cropping::Spaces::None)
    {
      return inside;
    }
    if (this->Scene.CropSpace == Cropping::Spaces::Rest)
    {
      return hn::And(inside, this->IsUncropped(q));
    }
    return hn::And(
      inside, this->IsUncropped(MulAdd(curve.TimeAt(s), this->Rays.Direction, this->Rays.Origin)));
  }

  HWY_NOINLINE Mf IsUncropped(const Vec3& p) const
  {
    const Df d;
    const Di di;
    const Vf one = Splat(1.0f);
    const auto slab = [&](Vf x, int a) {
      return hn::Add(hn::IfThenElseZero(hn::Ge(x, Splat(this->Scene.CropLow[a])), one),
        hn::IfThenElseZero(hn::Ge(x, Splat(this->Scene.CropHigh[a])), one));
    };
    const Vf region =
      hn::MulAdd(Splat(9.0f), slab(p.z, 2), hn::MulAdd(Splat(3.0f), slab(p.y, 1), slab(p.x, 0)));
    HWY_ALIGN int regions[16];
    HWY_ALIGN float shown[16];
    hn::Store(hn::ConvertTo(di, region), di, regions);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      shown[lane] = (this->Scene.CropFlags >> regions[lane] & 1) != 0 ? 1.0f : 0.0f;
    }
    return hn::Gt(hn::Load(d, shown), hn::Zero(d));
  }

  /// Samples, shades and composites. `Plain`: PacketScene::Plain, so that nothing is carried for
  /// options that are not used.
  template <bool Plain>
  HWY_NOINLINE void TakeSample(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
  {
    SampleCells cells;
    const SamplePosition at = FindCells(this->Scene.Volume, q, false, cells);
    const Mf interior = IsInterior(this->Scene.Volume, cells);
    const Mf border = hn::AndNot(interior, sampled);
    OffsetRows<T> voxels;
    voxels.Fit(this->Scene.Volume, cells, hn::And(interior, sampled));
    SampleRows<T> rows;
    Vf value = Sample<T>(voxels, at, rows);
    if (HWY_UNLIKELY(!hn::AllFalse(Df(), border)))
    {
      value = this->SampleBorder(q, border, value);
    }
    this->template Composite<Plain>(voxels, at, rows, value, curve, q, s, sampled, border);
  }

  /// The same for PacketScene::Inner, where all that samples and gradients need lies between
  /// voxels.
  template <bool Plain>
  HWY_NOINLINE void TakeInnerSample(const PacketCurve& curve, int n, Vf s)
  {
    const Vf number = Splat(static_cast<float>(n));
    const Mf sampled =
      hn::And(this->Alive, hn::And(hn::Ge(number, this->First), hn::Lt(number, this->Stop)));
    const Vec3 q = curve.Position.At(s);
    SampleCells cells;
    const SamplePosition at = FindCells(this->Scene.Volume, q, true, cells);
    const auto composite = [&](auto&& voxels) {
      SampleRows<T> rows;
      const Vf value = Sample<T>(voxels, at, rows);
      this->template Composite<Plain>(
        voxels, at, rows, value, curve, q, s, sampled, hn::FirstN(Df(), 0));
    };
    if constexpr (HasVoxelWindow<T>())
    {
      switch (this->Window.MoveTo(n))
      {
        case WindowFit::Two:
          return composite(WindowRows<T, WindowFit::Two>(this->Window, cells));
        case WindowFit::Three:
          return composite(WindowRows<T, WindowFit::Three>(this->Window, cells));
        case WindowFit::Four:
          return composite(WindowRows<T, WindowFit::Four>(this->Window, cells));
        default:
          break;
      }
    }
    OffsetRows<T> voxels;
    voxels.Fit(this->Scene.Volume, cells, sampled);
    composite(voxels);
  }

  /// Shades and composites samples of the lanes of `sampled`, those of `border` fetched by
  /// SampleBorder().
  template <bool Plain, class Source>
  HWY_INLINE void Composite(Source& voxels, const SamplePosition& at, const SampleRows<T>& rows,
    Vf value, const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled, Mf border)
  {
    const Df d;
    CastStatistics& statistics = this->Scratch.Statistics;
    statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
    // Comparisons with what is not a number are false.
    sampled = hn::And(sampled,
      hn::And(hn::Ge(value, Splat(this->Scene.VisibleLow)),
        hn::Le(value, Splat(this->Scene.VisibleHigh))));
    if (hn::AllFalse(d, sampled))
    {
      return;
    }
    const PacketMask& mask = this->Scene.Mask;
    const bool labeled = !Plain && !mask.Tables.empty();
    const Vi tables = labeled ? FindLabelTables(mask, q) : hn::Zero(Di());
    const TableLookup look =
      labeled ? TableLookup(this->Scene, value, tables) : TableLookup(this->Scene, value);
    Vf extinction = look.Extinction();
    Vec3 colour;
    const bool mixed = labeled && mask.BlendFactor < 1.0f;
    if (HWY_UNLIKELY(mixed))
    {
      this->MixWithLabels(value, look, tables, extinction, colour);
    }
    Mf visible = hn::And(sampled, hn::Gt(extinction, hn::Zero(d)));
    if (!Plain && mask.Scalars && !mask.Labels && !hn::AllFalse(d, visible))
    {
      visible = hn::And(visible, IsInMask(mask, q));
    }
    if (hn::AllFalse(d, visible))
    {
      return;
    }
    Vec3 gradient{ hn::Zero(d), hn::Zero(d), hn::Zero(d) };
    const bool byGradient = !Plain && this->Scene.Gradients.Factors != nullptr;
    if (byGradient || this->Scene.Shade)
    {
      voxels.Widen();
      gradient = Gradient<T>(voxels, at, rows);
      if (HWY_UNLIKELY(!hn::AllFalse(d, border)))
      {
        gradient = this->GradientAtBorder(q, border, gradient);
      }
    }
    if (byGradient)
    {
      extinction = this->WeighByGradient(this->Scene.Gradients, extinction, gradient);
      visible = hn::And(visible, hn::Gt(extinction, hn::Zero(d)));
      if (hn::AllFalse(d, visible))
      {
        return;
      }
    }
    statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, visible));
    this->Expecting = visible;

    if (HWY_LIKELY(!mixed))
    {
      colour = look.Colour();
    }
    const Vf t = curve.TimeAt(s);
    if (this->Scene.Shade)
    {
      colour = this->ShadeSample(this->Scene.Surface, curve, q, colour, gradient, s, t);
    }
    this->AddLook(colour, extinction, visible, curve, s, t);
  }

  /// Composites colours that are lit.
  HWY_INLINE void AddLook(
    const Vec3& colour, Vf extinction, Mf visible, const PacketCurve& curve, Vf s, Vf t)
  {
    const Vf interval = this->Scene.Settings.Opacity == OpacityLength::Deformed
      ? Splat(static_cast<float>(this->Scene.Settings.SampleDistance))
      : hn::Mul(curve.PerStep, this->LengthOf(curve.Position.Slope(s)));
    const Vf transmittance = Exp2(hn::Neg(hn::Mul(extinction, interval)));
    const Vf weight = hn::IfThenElseZero(
      visible, hn::Mul(this->Out.Transmittance, hn::Sub(Splat(1.0f), transmittance)));
    this->Out.Colour = MulAdd(weight, colour, this->Out.Colour);
    this->Out.Transmittance = hn::IfThenElse(
      visible, hn::Mul(this->Out.Transmittance, transmittance), this->Out.Transmittance);
    this->Out.FirstVisible =
      hn::IfThenElse(visible, hn::Min(this->Out.FirstVisible, t), this->Out.FirstVisible);
    const Mf ended =
      hn::Lt(this->Out.Transmittance, Splat(this->Scene.Settings.TerminationTransmittance));
    this->Alive = hn::AndNot(ended, this->Alive);
  }

  /// The extinction whose opacity over the reference length is that of `extinction` times the
  /// factor of a gradient; as SampleClassifier.
  HWY_NOINLINE Vf WeighByGradient(
    const PacketGradientOpacity& gradients, Vf extinction, const Vec3& gradient) const
  {
    const Vf factor = this->FactorOf(gradients, gradient);
    const Vf weighed = this->ExtinctionOf(hn::Mul(factor, this->OpacityOf(extinction)));
    return hn::IfThenElse(hn::Ge(factor, Splat(1.0f)), extinction, weighed);
  }

  /// Of opacities over the reference length.
  HWY_INLINE Vf FactorOf(const PacketGradientOpacity& gradients, const Vec3& gradient) const
  {
    const Di di;
    const Vec3 scaled{ hn::Mul(gradient.x, Splat(gradients.Scale[0])),
      hn::Mul(gradient.y, Splat(gradients.Scale[1])),
      hn::Mul(gradient.z, Splat(gradients.Scale[2])) };
    const Vf last = Splat(static_cast<float>(gradients.Size - 1));
    const Vf magnitude = hn::Sqrt(Dot(scaled, scaled));
    const Vf x = hn::IfThenElseZero(hn::Eq(magnitude, magnitude), hn::Min(magnitude, last));
    const Vf whole = hn::Min(hn::Floor(x), hn::Sub(last, Splat(1.0f)));
    HWY_ALIGN int offsets[16];
    hn::Store(hn::ConvertTo(di, whole), di, offsets);
    return Lerp(LoadLanes<float, 4>(gradients.Factors, 0, offsets),
      LoadLanes<float, 4>(gradients.Factors, 4, offsets), hn::Sub(x, whole));
  }

  /// Opacity over the reference length.
  HWY_INLINE Vf OpacityOf(Vf extinction) const
  {
    const Vf length = Splat(this->Scene.ReferenceLength);
    return hn::Sub(Splat(1.0f), Exp2(hn::Neg(hn::Mul(extinction, length))));
  }

  /// The extinction that gives the reference length an opacity.
  HWY_INLINE Vf ExtinctionOf(Vf opacity) const
  {
    const Vf one = Splat(1.0f);
    // What is nearly transparent has no digits left in 1 - opacity, but its logarithm is linear.
    const Vf passed = hn::Sub(one, opacity);
    const Vf logarithm = hn::IfThenElse(hn::Lt(opacity, Splat(1e-3f)),
      hn::Mul(hn::Mul(opacity, Splat(1.4426950409f)), hn::MulAdd(opacity, Splat(0.5f), one)),
      hn::Neg(Log2(hn::Max(passed, Splat(1e-30f)))));
    return hn::Div(hn::Max(logarithm, hn::Zero(Df())), Splat(this->Scene.ReferenceLength));
  }

  /// Where there is a label, its look is mixed with that of the scalars alone; as SampleClassifier.
  /// `extinction`: that of the label.
  HWY_NOINLINE void MixWithLabels(
    Vf value, const TableLookup& ofLabel, Vi tables, Vf& extinction, Vec3& colour) const
  {
    const Df d;
    const TableLookup base(this->Scene, value);
    const Vf factor = hn::IfThenElse(hn::RebindMask(d, hn::Gt(tables, hn::Zero(Di()))),
      Splat(this->Scene.Mask.BlendFactor), hn::Zero(d));
    const Vec3 a = base.Colour();
    const Vec3 b = ofLabel.Colour();
    colour = { Lerp(a.x, b.x, factor), Lerp(a.y, b.y, factor), Lerp(a.z, b.z, factor) };
    const Vf without = base.Extinction();
    const Vf opacity = Lerp(this->OpacityOf(without), this->OpacityOf(extinction), factor);
    const Mf some = hn::Gt(hn::Add(without, extinction), hn::Zero(d));
    extinction = hn::IfThenElse(hn::Gt(factor, hn::Zero(d)),
      hn::IfThenElseZero(some, this->ExtinctionOf(opacity)), extinction);
  }

  /// What TakeSample does, for several components; as SampleClassifier.
  HWY_NOINLINE void TakeComponents(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
  {
    if constexpr (!std::is_same<T, WideScalar>::value)
    {
      const Df d;
      CastStatistics& statistics = this->Scratch.Statistics;
      statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
      SampleCells cells;
      const SamplePosition at = FindCells(this->Scene.Volume, q, false, cells);
      const Mf interior = IsInterior(this->Scene.Volume, cells);
      const Mf border = hn::AndNot(interior, sampled);
      ComponentSamples<T> samples(this->Scene.Volume, cells, at, hn::And(interior, sampled));
      Vf values[LargestNumberOfComponents];
      samples.FindValues(values);
      if (HWY_UNLIKELY(!hn::AllFalse(d, border)))
      {
        this->ComponentsAtBorder(q, border, values);
      }
      Vf extinctions[LargestNumberOfComponents];
      Mf visible = hn::FirstN(d, 0);
      for (std::size_t c = 0; c < this->Scene.Components.size(); ++c)
      {
        // Comparisons with what is not a number are false.
        const Vf density = this->DensityOf(c, values);
        const Vf weight = Splat(this->Scene.Components[c].Weight);
        const Mf counts = hn::And(hn::Eq(density, density), hn::Gt(weight, hn::Zero(d)));
        extinctions[c] =
          hn::IfThenElseZero(counts, TableLookup(this->Scene, density, c).Extinction());
        visible = hn::Or(visible, hn::Gt(extinctions[c], hn::Zero(d)));
      }
      visible = hn::And(visible, sampled);
      if (this->Scene.Mask.Scalars && !hn::AllFalse(d, visible))
      {
        visible = hn::And(visible, IsInMask(this->Scene.Mask, q));
      }
      if (hn::AllFalse(d, visible))
      {
        return;
      }
      Vec3 gradients[LargestNumberOfComponents];
      if (this->Scene.Shade || this->HasGradientOpacities())
      {
        samples.FindGradients(gradients);
        if (HWY_UNLIKELY(!hn::AllFalse(d, border)))
        {
          this->ComponentGradientsAtBorder(q, border, gradients);
        }
      }
      const Vf t = curve.TimeAt(s);
      Vec3 colour;
      Vf extinction;
      if (this->Scene.KindOfComponents == ComponentKind::Independent)
      {
        this->MixComponents(curve, q, s, t, values, extinctions, gradients, colour, extinction);
      }
      else
      {
        this->LookAtDependent(
          curve, q, s, t, values, extinctions[0], gradients, colour, extinction);
      }
      visible = hn::And(visible, hn::Gt(extinction, hn::Zero(d)));
      if (hn::AllFalse(d, visible))
      {
        return;
      }
      statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, visible));
      this->Expecting = visible;
      this->AddLook(colour, extinction, visible, curve, s, t);
    }
  }

  HWY_INLINE bool HasGradientOpacities() const
  {
    return std::any_of(this->Scene.Components.begin(), this->Scene.Components.end(),
      [](const PacketComponent& component) { return component.Gradients.Factors != nullptr; });
  }

  /// Of all components at a sample, what is looked up for the opacity of one of the looks, and what
  /// its normals are of.
  HWY_INLINE Vf DensityOf(std::size_t look, const Vf* values) const
  {
    const auto weight = [](int c) { return Splat(static_cast<float>(LuminanceWeights[c])); };
    switch (this->Scene.KindOfComponents)
    {
      case ComponentKind::ColourOpacity:
        return values[1];
      case ComponentKind::Rgb:
        return hn::MulAdd(
          weight(0), values[0], hn::MulAdd(weight(1), values[1], hn::Mul(weight(2), values[2])));
      case ComponentKind::Rgba:
        return values[3];
      default:
        return values[look];
    }
  }

  /// Independent components: the opacity is sum(a^2) / sum(a), the premultiplied colour sum(a c).
  HWY_NOINLINE void MixComponents(const PacketCurve& curve, const Vec3& q, Vf s, Vf t,
    const Vf* values, const Vf* extinctions, const Vec3* gradients, Vec3& colour, Vf& extinction)
  {
    const Df d;
    const Vf zero = hn::Zero(d);
    Vec3 colours{ zero, zero, zero };
    Vf sum = zero;
    Vf squares = zero;
    for (std::size_t c = 0; c < this->Scene.Components.size(); ++c)
    {
      const PacketComponent& component = this->Scene.Components[c];
      const Mf visible = hn::Gt(extinctions[c], zero);
      if (hn::AllFalse(d, visible))
      {
        continue;
      }
      Vf opacity = hn::Mul(Splat(component.Weight), this->OpacityOf(extinctions[c]));
      if (component.Gradients.Factors)
      {
        opacity = hn::Mul(opacity, this->FactorOf(component.Gradients, gradients[c]));
      }
      opacity = hn::IfThenElseZero(visible, opacity);
      Vec3 own = TableLookup(this->Scene, values[c], c).Colour();
      if (this->Scene.Shade)
      {
        own = this->ShadeSample(component.Surface, curve, q, own, gradients[c], s, t);
      }
      colours = MulAdd(opacity, own, colours);
      sum = hn::Add(sum, opacity);
      squares = hn::MulAdd(opacity, opacity, squares);
    }
    const Vf one = Splat(1.0f);
    const Mf some = hn::Gt(squares, zero);
    const Vf opacity = hn::Div(squares, hn::IfThenElse(some, sum, one));
    colour = Scale(hn::Div(one, hn::IfThenElse(some, opacity, one)), colours);
    extinction = hn::IfThenElseZero(some, this->ExtinctionOf(opacity));
  }

  /// Dependent components. `ofTable`: extinction of the density.
  HWY_NOINLINE void LookAtDependent(const PacketCurve& curve, const Vec3& q, Vf s, Vf t,
    const Vf* values, Vf ofTable, const Vec3* gradients, Vec3& colour, Vf& extinction)
  {
    const Df d;
    const Vf zero = hn::Zero(d);
    const PacketComponent& component = this->Scene.Components[0];
    Vec3 gradient{ zero, zero, zero };
    if (this->Scene.Shade || component.Gradients.Factors)
    {
      const auto along = [&](Vf Vec3::*axis) {
        Vf of[LargestNumberOfComponents];
        for (int c = 0; c < this->Scene.Volume.Components; ++c)
        {
          of[c] = gradients[c].*axis;
        }
        return this->DensityOf(0, of);
      };
      gradient = { along(&Vec3::x), along(&Vec3::y), along(&Vec3::z) };
    }
    extinction = ofTable;
    if (component.Gradients.Factors)
    {
      extinction = hn::IfThenElseZero(
        hn::Gt(ofTable, zero), this->WeighByGradient(component.Gradients, ofTable, gradient));
    }
    if (this->Scene.KindOfComponents == ComponentKind::ColourOpacity)
    {
      colour = TableLookup(this->Scene, values[0], 1).Colour();
    }
    else
    {
      // What is not a number is black: comparisons with it are false.
      const auto channel = [&](int c) {
        const Vf value = hn::Mul(values[c], Splat(this->Scene.ColourScale));
        return hn::IfThenElseZero(hn::Gt(value, zero), hn::Min(value, Splat(1.0f)));
      };
      colour = { channel(0), channel(1), channel(2) };
    }
    if (this->Scene.Shade)
    {
      colour = this->ShadeSample(component.Surface, curve, q, colour, gradient, s, t);
    }
  }

  /// Values at the faces of the volume, by the reference functions.
  HWY_NOINLINE void ComponentsAtBorder(const Vec3& q, Mf border, Vf* values) const
  {
    const VolumeView& volume = this->Scene.Source->Volume;
    for (int c = 0; c < volume.Components; ++c)
    {
      const VolumeView component = GetComponent(volume, c);
      const Vf zero = hn::Zero(Df());
      values[c] = ReplaceLanes(border, q, { values[c], zero, zero }, [&](const glm::dvec3& at) {
        return glm::dvec3(this->Scene.Reference.Value(component, at), 0.0, 0.0);
      }).x;
    }
  }

  HWY_NOINLINE void ComponentGradientsAtBorder(const Vec3& q, Mf border, Vec3* gradients) const
  {
    const VolumeView& volume = this->Scene.Source->Volume;
    for (int c = 0; c < volume.Components; ++c)
    {
      const VolumeView component = GetComponent(volume, c);
      gradients[c] = ReplaceLanes(border, q, gradients[c],
        [&](const glm::dvec3& at) { return 2.0 * this->Scene.Reference.Gradient(component, at); });
    }
  }

  /// What TakeSample does, for all that is not plain compositing. `number`: of the sample.
  HWY_NOINLINE void TakeOtherSample(
    const PacketCurve& curve, const Vec3& q, Vf s, Vf number, Mf sampled)
  {
    const Df d;
    CastStatistics& statistics = this->Scratch.Statistics;
    statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
    switch (this->Scene.Sampling)
    {
      case PacketSampling::Extreme:
        return this->TakeExtreme(curve, q, s, sampled);
      case PacketSampling::Sum:
        return this->AddUp(curve, q, s, sampled);
      case PacketSampling::Surface:
        return this->CrossSurfaces(curve, q, s, number, sampled);
      default:
        return this->TakeSamplePerRay(curve, s, sampled);
    }
  }

  /// Values at positions inside of the volume.
  HWY_INLINE Vf ValuesAt(const Vec3& q, Mf lanes)
  {
    SampleCells cells;
    const SamplePosition at = FindCells(this->Scene.Volume, q, false, cells);
    const Mf interior = IsInterior(this->Scene.Volume, cells);
    const Mf border = hn::AndNot(interior, lanes);
    OffsetRows<T> voxels;
    voxels.Fit(this->Scene.Volume, cells, hn::And(interior, lanes));
    SampleRows<T> rows;
    Vf value = Sample<T>(voxels, at, rows);
    if (HWY_UNLIKELY(!hn::AllFalse(Df(), border)))
    {
      value = this->SampleBorder(q, border, value);
    }
    return value;
  }

  /// Minima are maxima of what is below zero.
  HWY_INLINE void TakeExtreme(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
  {
    const Df d;
    const bool maximum = this->Scene.Source->Blend.Mode == BlendMode::Maximum;
    Vf value = this->ValuesAt(q, sampled);
    value = maximum ? value : hn::Neg(value);
    // Comparisons with what is not a number are false.
    const Mf better = hn::And(sampled, hn::Gt(value, this->Out.Tally));
    this->Scratch.Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, better));
    this->Out.Tally = hn::IfThenElse(better, value, this->Out.Tally);
    this->Out.FirstVisible = hn::IfThenElse(better, curve.TimeAt(s), this->Out.FirstVisible);
    // Nothing is beyond the end of the range.
    const Vf end = Splat(maximum ? this->Scene.ValueHigh : -this->Scene.ValueLow);
    this->Alive = hn::AndNot(hn::Ge(this->Out.Tally, end), this->Alive);
  }

  HWY_INLINE void AddUp(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
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
    this->Scratch.Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, counts));
    const Vf extinction = TableLookup(this->Scene, value).Extinction();
    const Vf opacity =
      hn::Sub(one, Exp2(hn::Neg(hn::Mul(extinction, Splat(this->Scene.UnitDistance)))));
    const Vf relative = hn::Mul(hn::Sub(value, Splat(this->Scene.ValueLow)),
      Splat(1.0f / (this->Scene.ValueHigh - this->Scene.ValueLow)));
    const Vf length = this->Scene.Settings.Opacity == OpacityLength::Deformed
      ? Splat(static_cast<float>(this->Scene.Settings.SampleDistance))
      : hn::Mul(curve.PerStep, this->LengthOf(curve.Position.Slope(s)));
    this->Out.Tally = hn::Add(
      this->Out.Tally, hn::IfThenElseZero(counts, hn::Mul(hn::Mul(opacity, relative), length)));
    this->Out.TallyLength = hn::Add(this->Out.TallyLength, hn::IfThenElseZero(counts, length));
    this->Out.FirstVisible = hn::IfThenElse(
      counts, hn::Min(this->Out.FirstVisible, curve.TimeAt(s)), this->Out.FirstVisible);
  }

  /// By what fetched values may be wrong: single precision has few digits left of small differences
  /// of large values, and 16 bits without a sign are fetched with an offset.
  float FindRounding() const
  {
    const float low = this->Scene.ValueLow;
    const float high = this->Scene.ValueHigh;
    const float offset = std::is_same<T, std::uint16_t>::value ? 32768.0f : 0.0f;
    return 1e-5f * (high - low) + 1e-6f * std::max({ std::abs(low), std::abs(high), offset });
  }

  /// Hands the intervals to the next sample that a surface may cross to the integrators.
  HWY_INLINE void CrossSurfaces(const PacketCurve& curve, const Vec3& q, Vf s, Vf number, Mf lanes)
  {
    const Df d;
    const Vf next = hn::Add(number, Splat(1.0f));
    const Vec3 end = curve.Position.At(hn::Add(s, curve.PerStep));
    const Mf insideA = hn::And(lanes, IsInside(this->Scene, q));
    const Mf insideB = hn::And(lanes, IsInside(this->Scene, end));
    Vf a = this->Out.Tally;
    const Mf unknown = hn::AndNot(hn::Eq(this->Out.TallyStep, number), insideA);
    if (!hn::AllFalse(d, unknown))
    {
      a = hn::IfThenElse(unknown, this->ValuesAt(q, unknown), a);
    }
    const Vf b = hn::AllFalse(d, insideB) ? a : this->ValuesAt(end, insideB);
    this->Out.Tally = hn::IfThenElse(insideB, b, this->Out.Tally);
    this->Out.TallyStep = hn::IfThenElse(insideB, next, this->Out.TallyStep);
    // A value that is not clearly on one side counts as crossing: the integrator knows exactly.
    const Vf margin = Splat(this->FindRounding());
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
    if (!hn::AllFalse(d, crossed))
    {
      this->TakeSamplePerRay(curve, s, crossed);
    }
  }

  /// What TakeSample does, by the integrators of the rays.
  HWY_NOINLINE void TakeSamplePerRay(const PacketCurve& curve, Vf s, Mf sampled)
  {
    const Df d;
    HWY_ALIGN float at[16], interval[16], t0[16], dt[16], flag[16];
    HWY_ALIGN float terms[3 * TileLayers][16];
    hn::Store(s, d, at);
    hn::Store(curve.PerStep, d, interval);
    hn::Store(curve.T0, d, t0);
    hn::Store(curve.Dt, d, dt);
    hn::Store(hn::IfThenElseZero(sampled, Splat(1.0f)), d, flag);
    for (int k = 0; k < TileLayers; ++k)
    {
      hn::Store(curve.Position.Terms[k].x, d, terms[3 * k]);
      hn::Store(curve.Position.Terms[k].y, d, terms[3 * k + 1]);
      hn::Store(curve.Position.Terms[k].z, d, terms[3 * k + 2]);
    }
    HWY_ALIGN float done[16] = {};
    CastStatistics& statistics = this->Scratch.Statistics;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      if (flag[lane] == 0.0f)
      {
        continue;
      }
      CurvePiece piece;
      for (int k = 0; k < TileLayers; ++k)
      {
        piece.Terms[k] =
          glm::dvec3(terms[3 * k][lane], terms[3 * k + 1][lane], terms[3 * k + 2][lane]);
      }
      const RayPiece one(
        *this, curve, lane, piece, static_cast<double>(t0[lane]), static_cast<double>(dt[lane]));
      const RayIntegrator::Outcome outcome = this->Scratch.Integrators[lane].AddSample(
        one, static_cast<double>(at[lane]), static_cast<double>(interval[lane]));
      statistics.VisibleSamples += outcome.Visible ? 1 : 0;
      done[lane] = outcome.Done ? 1.0f : 0.0f;
    }
    this->Alive = hn::AndNot(hn::Gt(hn::Load(d, done), hn::Zero(d)), this->Alive);
  }

  /// The piece of one ray.
  class RayPiece : public SampledPiece
  {
  public:
    RayPiece(Packet& packet, const PacketCurve& curve, std::size_t lane, const CurvePiece& piece,
      double t0, double dt)
      : SampledPiece(piece, t0, dt)
      , Whole(packet)
      , OfAll(curve)
      , Lane(lane)
    {
    }

    glm::dvec3 GradientToDeformed(double s, const glm::dvec3& byIndex) const override
    {
      return this->Whole.GradientOfRay(this->OfAll, this->Lane, static_cast<float>(s), byIndex);
    }

  private:
    Packet& Whole;
    const PacketCurve& OfAll;
    std::size_t Lane;
  };

  /// The gradient by data coordinates at s on one of the rays, from that by index coordinates.
  HWY_NOINLINE glm::dvec3 GradientOfRay(
    const PacketCurve& curve, std::size_t lane, float s, const glm::dvec3& byIndex)
  {
    // Scaled: squares of huge or tiny scalars are no floats.
    const double size = std::max({ std::abs(byIndex.x), std::abs(byIndex.y), std::abs(byIndex.z) });
    if (!(size > 0.0) || !std::isfinite(size))
    {
      return glm::dvec3(0.0);
    }
    const Df d;
    const Vec3 g{ Splat(static_cast<float>(byIndex.x / size)),
      Splat(static_cast<float>(byIndex.y / size)), Splat(static_cast<float>(byIndex.z / size)) };
    const Vf at = Splat(s);
    Vf determinant;
    Vec3 local = this->GradientAt(curve, curve.Position.At(at), g, at, determinant);
    const Vf magnitude = hn::Max(hn::Abs(determinant), Splat(1e-30f));
    local = Scale(hn::Div(hn::CopySign(Splat(1.0f), determinant), magnitude), local);
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
      return hn::And(hn::Ge(x, zero), hn::Le(x, Splat(static_cast<float>(v.Dimensions[a] - 1))));
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
    return ReplaceLanes(border, q, gradient, [&](const glm::dvec3& at) {
      return this->Scene.Reference.Gradient(this->Scene.Source->Volume, at) *
        (2.0 * this->Scene.Volume.Scale);
    });
  }

  /// Colour of a lit sample: the normal is J_Phi^T grad f.
  HWY_INLINE Vec3 ShadeSample(const PacketSurface& surface, const PacketCurve& curve, const Vec3& q,
    const Vec3& colour, const Vec3& byIndex, Vf s, Vf t)
  {
    Vec3 gradient; // by coordinates of the lights' space
    if (this->Scene.Identity)
    {
      gradient = Transform(this->Scene.IndexGradientToLights, byIndex);
    }
    else
    {
      // Only the direction of the gradient is used, but it must not be turned around.
      Vf determinant;
      const Vec3 local = this->GradientAt(curve, q, byIndex, s, determinant);
      gradient = Transform(
        this->Scene.GradientToLights, Scale(hn::CopySign(Splat(1.0f), determinant), local));
    }
    const auto position = [&] {
      return Transform(
        this->Scene.LocalToLights, MulAdd(t, this->Rays.Direction, this->Rays.Origin));
    };
    const Vec3 toEye =
      this->Scene.Parallel ? Normalize(Sub(Broadcast(this->Scene.Eye), position())) : this->ToEye;
    return Shade(this->Scene, surface, colour, gradient, toEye, position);
  }

  /// `determinant` times the gradient by local coordinates of deformed space, from that by index
  /// coordinates at q.
  HWY_INLINE Vec3 GradientAt(
    const PacketCurve& curve, const Vec3& q, const Vec3& byIndex, Vf s, Vf& determinant)
  {
    if (curve.Interpolated)
    {
      return this->GradientFromFrames(curve, byIndex, s, determinant);
    }
    determinant = Splat(1.0f);
    return this->Scene.Identity ? Transform(this->Scene.GradientToRest, byIndex)
                                : this->GradientFromField(q, byIndex, curve.TimeAt(s));
  }

  /**
   * Along the image axes u, v and the ray parameter t both the deformed points P and the rest
   * points Q are known, so the gradient G by P solves G . P_u = g . Q_u, and so on for v and t.
   * Returns G times `determinant`. The derivatives of Q are those of the interpolant.
   */
  HWY_INLINE Vec3 GradientFromFrames(
    const PacketCurve& curve, const Vec3& byIndex, Vf s, Vf& determinant)
  {
    if (HWY_UNLIKELY(!this->HaveSlopes))
    {
      this->FindSlopes(curve);
    }
    const Vf t = curve.TimeAt(s);
    const Vf gu = Dot(byIndex, this->SlopeU.At(s));
    const Vf gv = Dot(byIndex, this->SlopeV.At(s));
    const Vf gt = hn::Div(Dot(byIndex, curve.Position.Slope(s)), curve.Dt);
    const Vec3 pu = MulAdd(t, this->DirectionU, this->OriginU);
    const Vec3 pv = MulAdd(t, this->DirectionV, this->OriginV);
    const Vec3& pt = this->Rays.Direction;
    const Vec3 vt = Cross(pv, pt);
    determinant = Dot(pu, vt);
    return MulAdd(gu, vt, MulAdd(gv, Cross(pt, pu), Scale(gt, Cross(pu, pv))));
  }

  HWY_NOINLINE void FindSlopes(const PacketCurve& curve)
  {
    this->HaveSlopes = true;
    Vf rows[4];
    LagrangeWeights(curve.Row, rows);
    this->SlopeU = FindPacketCurve(curve.Piece->ColumnSlopes, curve.X, rows);
    LagrangeSlopes(curve.Row, rows);
    for (Vf& row : rows)
    {
      row = hn::Mul(row, Splat(3.0f / static_cast<float>(curve.Piece->Side - 1)));
    }
    this->SlopeV = FindPacketCurve(curve.Piece->Columns, curve.X, rows);
    if (!this->HaveRaySlopes)
    {
      this->HaveRaySlopes = true;
      this->Pieces.FindRaySlopes(this->X, this->Y, this->Rows, this->OriginU, this->DirectionU,
        this->OriginV, this->DirectionV);
    }
  }

  /// The same with J_Phi at the sample itself.
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
  TilePieces& Pieces;
  PacketScratch& Scratch;
  RayPacket Rays;
  Vec3 ToEye; ///< back along them, in the space of the lights
  Vf Phase;
  Mf Alive;
  int X; ///< first pixel, from that of the tile
  int Y;
  Vf Rows;  ///< of the pixels, from Y on
  Vf First; ///< samples, see FindSamples()
  Vf Stop;
  int FirstSample = 0; ///< of all rays
  int EndSample = 0;
  PacketPixels Out;
  float Reach = std::numeric_limits<float>::infinity();
  Vf SkipTo;    ///< samples of the piece before this one are empty for certain
  Mf Expecting; ///< rays whose last sample was visible

  float MiddlePhase; ///< of the rays
  float PhaseRange;  ///< most that a phase is from it

  /// Voxels around the last inner sample.
  VoxelWindow<T> Window;
  /// Voxels of the last samples at faces of the volume.
  RepeatedVoxels<std::conditional_t<std::is_same<T, WideScalar>::value, float, T>> Border;

  // Derivatives of the current curve by pixels, found when its first visible sample is shaded.
  bool HaveSlopes = false;
  Quartic SlopeU;
  Quartic SlopeV;

  // Derivatives of the viewing rays by pixels, found with them.
  bool HaveRaySlopes = false;
  Vec3 OriginU;
  Vec3 OriginV;
  Vec3 DirectionU;
  Vec3 DirectionV;
};

/// Rays of a tile, packet by packet, as they lie in PacketScratch::Rays.
struct StoredRays
{
  static constexpr std::size_t RaysPerTile = TileSide * TileSide;
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
      hn::StoreU(all[i], d, this->Data + RaysPerTile * i + first);
    }
  }
  HWY_INLINE RayPacket Get(std::size_t first) const
  {
    const Df d;
    const auto load = [&](int i) { return hn::LoadU(d, this->Data + RaysPerTile * i + first); };
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
    jitter[lane] = static_cast<float>(
      FindJitter(x0 + lane % shape.Width + origin.x, y0 + lane / shape.Width + origin.y));
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
      to[lane] =
        std::min(to[lane], static_cast<float>(camera.DepthToT(ray, x + 0.5, y + 0.5, depth)));
    }
  }
  rays.To = hn::Load(d, to);
}

HWY_INLINE void StorePixels(const PacketScene& scene, const CastImage& image, int x0, int y0,
  Mf active, const PacketPixels& pixels)
{
  const Df d;
  const PacketShape shape = GetPacketShape();
  const auto shown = [&](Vf v) { return hn::IfThenElseZero(active, v); };
  HWY_ALIGN float colours[4 * 16];
  hn::StoreInterleaved4(shown(pixels.Colour.x), shown(pixels.Colour.y), shown(pixels.Colour.z),
    shown(hn::Sub(Splat(1.0f), pixels.Transmittance)), d, colours);
  HWY_ALIGN float t[16];
  hn::Store(hn::IfThenElse(active, pixels.FirstVisible, Splat(1e30f)), d, t);
  const int width = std::min(shape.Width, image.Width - x0);
  const int height = std::min(shape.Height, image.Height - y0);
  for (int row = 0; row < height && width > 0; ++row)
  {
    const int y = y0 + row;
    const std::size_t first = static_cast<std::size_t>(y) * image.Width + x0;
    std::copy_n(colours + 4 * row * shape.Width, 4 * width, image.Colours + 4 * first);
    for (int column = 0; image.Depths && column < width; ++column)
    {
      const float nearest = t[row * shape.Width + column];
      float& depth = image.Depths[first + static_cast<std::size_t>(column)];
      depth = 1.0f;
      if (nearest < 1e29f)
      {
        const ViewRay ray = scene.Source->Camera.MakeRay(x0 + column + 0.5, y + 0.5);
        depth = static_cast<float>(
          scene.Source->Camera.ToDepth(ray.Origin + static_cast<double>(nearest) * ray.Direction));
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
  HWY_INLINE bool IsWanted(int x, int y) const
  {
    return (this->Quarters >> this->At(x, y) & 1) != 0;
  }

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
      RayPacket rays = MakeRays(near, far, px, py);
      if (scene.Source->Depths)
      {
        ClipToDepths(scene, image, x, y, rays);
      }
      ClipToBounds(scene, rays);
      const Mf inImage = hn::And(hn::Lt(px, Splat(static_cast<float>(image.Width))),
        hn::Lt(py, Splat(static_cast<float>(image.Height))));
      const Mf active = hn::And(inImage, hn::Lt(rays.From, rays.To));
      // Rays that miss what there is now may meet what there will be; of those that were cast
      // before the last stop nothing is known any more.
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

  TilePieces pieces(scene, scratch, near, far, x0, y0);
  if (tMin < tMax)
  {
    pieces.Start(tMin, tMax);
  }

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
      const Vf phase = scene.Intervals
        ? hn::Zero(d)
        : PhaseOf(scene, rays, scene.Settings.Jitter ? JitterOf(scene, x, y) : hn::Zero(d));
      Packet<T> cast(scene, pieces, scratch, rays, x - x0, y - y0, dy, phase, active);
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
