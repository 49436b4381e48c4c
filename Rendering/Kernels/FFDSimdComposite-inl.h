// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Compositing the samples of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_COMPOSITE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_COMPOSITE_INL_H_
#undef FFD_SIMD_COMPOSITE_INL_H_
#else
#define FFD_SIMD_COMPOSITE_INL_H_
#endif

#include "FFDPacketCaster.h"

#include "FFDSimdBorder-inl.h"
#include "FFDSimdComponents-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdGrid-inl.h"
#include "FFDSimdInterval-inl.h"
#include "FFDSimdMask-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdNormals-inl.h"
#include "FFDSimdOpacityNormals-inl.h"
#include "FFDSimdOptics-inl.h"
#include "FFDSimdPlane-inl.h"
#include "FFDSimdSegmentTrees-inl.h"
#include "FFDSimdTable-inl.h"
#include "FFDSimdWindow-inl.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Length in data units of a step in index coordinates.
HWY_INLINE Vf FindLength(const PacketScene& scene, const Vec3& index)
{
  const Vec3 data = Transform(scene.IndexToLocal, index);
  return FastSqrt(Dot(data, data));
}

/// Classifies, lights and composites the samples of a packet, front to back.
template <class T>
class PacketCompositor
{
public:
  /// Keeps references to all but the numbers; these are those of PacketNormals.
  PacketCompositor(const PacketScene& scene, const SegmentTrees& trees, PacketScratch& scratch,
    const RayPacket& rays, int x, int y, Vf rows, Mf active)
    : State(active)
    , Normals(scene, trees, rays, x, y, rows)
    , Border(scene, scratch)
    , Window(scene)
    , Scene(scene)
    , Rays(rays)
    , Statistics(scratch.Statistics)
    , LastNumber(Splat(-1e30f))
    , LastValue(hn::Zero(Df()))
  {
  }

  /// Takes a sample of the lanes of `sampled` at q, the position at s of a curve, in the volume.
  /// `Plain` is PacketScene::Plain as a constant, so that options that are not used cost nothing.
  template <bool Plain>
  HWY_NOINLINE void TakeSample(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
  {
    const Vec3 voxel = Plain ? q : FindSampledVoxels(this->Scene, q);
    FetchedSample<T> fetched;
    FetchSample(this->Scene.Volume, voxel, sampled, this->Border, fetched);
    this->template Composite<Plain>(fetched.Voxels, fetched.At, fetched.Rows, fetched.Value, curve,
      q, voxel, s, sampled, fetched.AtBorder);
  }

  /**
   * Takes the samples from `from` on, before `to`, of a curve of a segment as TakeSample() does,
   * those that are in the volume and not cropped, if PacketScene::Inner is true. Without `AtFaces`
   * all voxels that they and their gradients need must exist. Returns the number of the sample with
   * which all rays have ended, or `to`.
   */
  template <bool Plain, bool AtFaces>
  HWY_INLINE int TakeSamples(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    return this->template WithWindow<AtFaces>([&](auto fit) FFD_INLINE_LAMBDA {
      return this->template TakeSamples<Plain, AtFaces, decltype(fit)::value>(
        curve, numbers, from, to);
    });
  }

  /**
   * Calls use(n, s, sampled, value) with the samples from `from` on, before `to`, of a curve of a
   * segment, whose values are those `Ahead` samples behind them; with those in the volume and not
   * cropped unless they are ahead. As TakeSamples(), for what needs the values alone.
   */
  template <int Ahead, bool AtFaces, class Use>
  HWY_INLINE int ForValues(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to, const Use& use)
  {
    return this->template WithWindow<AtFaces>([&](auto fit) FFD_INLINE_LAMBDA {
      return this->template ForValues<Ahead, AtFaces, decltype(fit)::value>(
        curve, numbers, from, to, use);
    });
  }

  /**
   * Takes the intervals that end at the samples n, at s of a curve, in the lanes of `sampled`, as
   * RayIntegrator::CompositeInterval(). `inner`: all voxels that they and their gradients need
   * exist.
   */
  HWY_NOINLINE void TakeInterval(const PacketCurve& curve, int n, Vf s, Mf sampled, bool inner)
  {
    const Vec3 end = curve.At(this->Scene, s);
    this->TakeInterval(curve, n, s, sampled,
      inner ? this->FindInnerValue(n, end, sampled) : this->FindValue(end, sampled), inner);
  }

  /// Takes intervals as TakeSamples() takes samples.
  template <bool AtFaces>
  HWY_INLINE int TakeIntervals(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    return this->template ForValues<0, AtFaces>(curve, numbers, from, to,
      [&](int n, Vf s, Mf sampled, Vf value)
        FFD_INLINE_LAMBDA { this->TakeInterval(curve, n, s, sampled, value, !AtFaces); });
  }

  /// Takes a sample of several components as TakeSample() does of one; as SampleClassifier.
  HWY_NOINLINE void TakeComponents(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
  {
    const Df d;
    this->Statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
    const Vec3 voxel = FindSampledVoxels(this->Scene, q);
    FetchedComponents<T> samples(this->Scene.Volume, voxel, sampled, this->Border);
    Vf values[LargestNumberOfComponents];
    samples.FindValues(values);
    Vf extinctions[LargestNumberOfComponents];
    Mf visible = hn::FirstN(d, 0);
    const bool independent = this->Scene.KindOfComponents == ComponentKind::Independent;
    unsigned int wanted = independent ? 0 : FindDensityComponents(this->Scene);
    for (std::size_t c = 0; c < this->Scene.Components.size(); ++c)
    {
      // Comparisons with what is not a number are false.
      const PacketComponent& component = this->Scene.Components[c];
      const Vf density = DensityOf(this->Scene, c, values);
      const Mf counts = hn::And(sampled,
        hn::And(hn::Ge(density, Splat(component.Visible.Low)),
          hn::Le(density, Splat(component.Visible.High))));
      extinctions[c] = hn::Zero(d);
      if (component.Weight > 0.0f && !hn::AllFalse(d, counts))
      {
        extinctions[c] =
          hn::IfThenElseZero(counts, this->FindFirstExtinction(component, density, c));
        const Mf own = hn::Gt(extinctions[c], hn::Zero(d));
        visible = hn::Or(visible, own);
        wanted |= independent && !hn::AllFalse(d, own) ? 1u << c : 0u;
      }
    }
    visible = hn::And(visible, sampled);
    if (this->Scene.HidesSamples && !hn::AllFalse(d, visible))
    {
      visible = LeaveOutHidden(this->Scene, q, visible);
    }
    if (hn::AllFalse(d, visible))
    {
      return;
    }
    Vec3 gradients[LargestNumberOfComponents];
    Vec3 ofOpacity[LargestNumberOfComponents];
    const Vec3* const normals = this->Scene.NormalsOfOpacity ? ofOpacity : gradients;
    if (this->Scene.Shade || this->Scene.OpacityByGradient)
    {
      this->FindGradients(samples, wanted, curve, q, voxel, s, visible, gradients, ofOpacity);
    }
    const Vf t = curve.TimeAt(s);
    Vec3 color;
    Vf extinction;
    if (independent)
    {
      this->MixComponents(
        curve, q, s, t, values, extinctions, gradients, normals, color, extinction);
    }
    else
    {
      const Vec3 gradient = this->FindDensityGradient(gradients);
      this->ClassifyDependent(curve, q, s, t, values, extinctions[0], gradient,
        this->Scene.NormalsOfOpacity ? ofOpacity[0] : gradient, color, extinction);
    }
    this->AddComponents(curve, s, t, color, extinction, visible);
  }

  /// Finds the values of all components at q, in the volume.
  HWY_NOINLINE void FindComponents(const Vec3& q, Mf lanes, Vf* values)
  {
    const Vec3 voxel = FindSampledVoxels(this->Scene, q);
    FetchedComponents<T>(this->Scene.Volume, voxel, lanes, this->Border).FindValues(values);
  }

  /// Finds the gradients that give normals at q, the position at s of a curve: of what
  /// IntensityOf() gives of a channel, or of the opacity.
  HWY_NOINLINE Vec3 FindIntensityGradient(
    const PacketCurve& curve, const Vec3& q, Vf s, Mf lanes, std::size_t channel)
  {
    const Vec3 voxel = FindSampledVoxels(this->Scene, q);
    FetchedComponents<T> samples(this->Scene.Volume, voxel, lanes, this->Border);
    Vf values[LargestNumberOfComponents];
    samples.FindValues(values);
    Vec3 gradients[LargestNumberOfComponents];
    Vec3 ofOpacity[LargestNumberOfComponents];
    const unsigned int all = (1u << this->Scene.Volume.Components) - 1u;
    this->FindGradients(samples, all, curve, q, voxel, s, lanes, gradients, ofOpacity);
    if (this->Scene.NormalsOfOpacity)
    {
      return ofOpacity[channel];
    }
    return this->MixGradients(
      gradients, [&](const Vf* of) { return IntensityOf(this->Scene, channel, of); });
  }

  /// Finds the gradients that give normals of one component at q, the position at s of a curve.
  HWY_NOINLINE Vec3 FindNormalGradient(const PacketCurve& curve, const Vec3& q, Vf s, Mf lanes)
  {
    const Vec3 voxel = FindSampledVoxels(this->Scene, q);
    FetchedSample<T> fetched;
    FetchSample(this->Scene.Volume, voxel, lanes, this->Border, fetched);
    return this->FindGradient(fetched.Voxels, fetched.At, fetched.Rows, curve, q, voxel, s, lanes,
      fetched.AtBorder, this->Scene.NormalsOfOpacity);
  }

  /// Whether TakeDependentComponents() can take samples of the curve.
  template <bool AtFaces>
  HWY_INLINE bool HasDependentComponents() const
  {
    if constexpr (HasVoxelWindow<T>())
    {
      return this->Scene.InnerComponents && (!AtFaces || this->CanUseFaces()) &&
        this->Window.GetFit() != WindowFit::None;
    }
    return false;
  }

  /// Does what TakeSamples() does where PacketScene::InnerComponents is true.
  template <bool AtFaces>
  HWY_INLINE int TakeDependentComponents(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    return this->template WithWindow<AtFaces>([&](auto fit) FFD_INLINE_LAMBDA {
      constexpr WindowFit Fit = decltype(fit)::value;
      static_cast<void>(curve);
      static_cast<void>(numbers);
      static_cast<void>(from);
      if constexpr (Fit != WindowFit::None)
      {
        return this->Scene.Volume.Components == 2
          ? this->template TakeComponentsOf<2, AtFaces, Fit>(curve, numbers, from, to)
          : this->template TakeComponentsOf<4, AtFaces, Fit>(curve, numbers, from, to);
      }
      return to;
    });
  }

  /// Interpolates values at q, in the volume. Beyond the outermost voxels, where the volume is one
  /// of cells, values are theirs.
  HWY_INLINE Vf FindValue(const Vec3& q, Mf lanes)
  {
    return HWY_LIKELY(!this->Scene.Grid.MovesSamples()) ? this->FindVoxelValue(q, lanes)
                                                        : this->FindMovedValue(q, lanes);
  }

  /// Does what FindValue() does where all voxels of the values exist.
  HWY_INLINE Vf FindInnerValue(const Vec3& q, Mf lanes)
  {
    return HWY_LIKELY(!this->Scene.Grid.MovesSamples()) ? this->FindInnerVoxelValue(q, lanes)
                                                        : this->FindMovedInnerValue(q, lanes);
  }

  /// Does what FindInnerValue() does where q are the samples n of a curve, or in the intervals that
  /// end there.
  HWY_INLINE Vf FindInnerValue(int n, const Vec3& q, Mf lanes)
  {
    return HWY_LIKELY(!this->Scene.Grid.MovesSamples()) ? this->FindInnerVoxelValue(n, q, lanes)
                                                        : this->FindMovedInnerValue(n, q, lanes);
  }

  /// Interpolates values at voxel coordinates q.
  HWY_NOINLINE Vf FindVoxelValue(Vec3 q, Mf lanes)
  {
    if (HWY_UNLIKELY(this->Scene.Lower < 0.0f))
    {
      const int* const n = this->Scene.Volume.Dimensions;
      const auto toVoxels = [n](Vf x, int a) {
        return Clamp(x, hn::Zero(Df()), Splat(static_cast<float>(n[a] - 1)));
      };
      q = { toVoxels(q.x, 0), toVoxels(q.y, 1), toVoxels(q.z, 2) };
    }
    SampleCells cells;
    const SamplePosition at = FindCells(this->Scene.Volume, q, false, cells);
    if (HWY_LIKELY(HasRowsOfCells(this->Scene.Volume, cells, lanes)))
    {
      OffsetRows<T> voxels;
      voxels.Fit(this->Scene.Volume, cells, lanes);
      SampleRows<T> rows;
      return Sample<T>(voxels, at, rows);
    }
    FetchedSample<T> fetched;
    FetchSample(this->Scene.Volume, q, lanes, this->Border, fetched);
    return fetched.Value;
  }

  /// The same where all voxels of the values exist.
  HWY_NOINLINE Vf FindInnerVoxelValue(const Vec3& q, Mf lanes)
  {
    if (HWY_UNLIKELY(this->Scene.Volume.SlicesInReach > 0))
    {
      return this->FindVoxelValue(q, lanes);
    }
    SampleCells cells;
    const SamplePosition at = FindCells(this->Scene.Volume, q, true, cells);
    OffsetRows<T> voxels;
    voxels.Fit(this->Scene.Volume, cells, lanes);
    SampleRows<T> rows;
    return Sample<T>(voxels, at, rows);
  }

  /// The same of the samples n of a curve, or in the intervals that end there.
  HWY_NOINLINE Vf FindInnerVoxelValue(int n, const Vec3& q, Mf lanes)
  {
    Vf value = hn::Zero(Df());
    this->template UseRows<false>(
      n, q, lanes,
      [&](auto& voxels, const SamplePosition& at, Mf) {
        SampleRows<T> rows;
        value = Sample<T>(voxels, at, rows);
      },
      [&] { value = this->FindVoxelValue(q, lanes); });
    return value;
  }

  HWY_NOINLINE Vf FindMovedValue(const Vec3& q, Mf lanes)
  {
    return this->FindVoxelValue(FindMovedVoxels(this->Scene, q), lanes);
  }
  HWY_NOINLINE Vf FindMovedInnerValue(const Vec3& q, Mf lanes)
  {
    return this->FindInnerVoxelValue(FindMovedVoxels(this->Scene, q), lanes);
  }
  HWY_NOINLINE Vf FindMovedInnerValue(int n, const Vec3& q, Mf lanes)
  {
    return this->FindInnerVoxelValue(n, FindMovedVoxels(this->Scene, q), lanes);
  }

  /// Gradients of samples at q, of which those of `border` lie at faces.
  template <class Source>
  HWY_INLINE Vec3 GradientOf(const Source& voxels, const SamplePosition& at,
    const SampleRows<T>& rows, const Vec3& q, Mf border)
  {
    const Vec3 gradient = Gradient<T>(voxels, at, rows);
    return HWY_LIKELY(hn::AllFalse(Df(), border))
      ? gradient
      : this->Border.Gradient(q, border, gradient, voxels.IsRepeating());
  }

  /// The gradient at index coordinates q of one component, or of its opacity, as fetched, from
  /// differences by voxel coordinates at `voxel`, FindSampledVoxels(); as FindDifferences().
  HWY_NOINLINE Vec3 FindGridGradient(const Vec3& q, const Vec3& voxel, Mf lanes,
    const Vec3& differences, int component = 0, bool ofOpacity = false)
  {
    const PacketGrid& grid = this->Scene.Grid;
    const Vec3 place = grid.Snaps ? FindVoxels(this->Scene, q) : voxel;
    const Vec3 gradient =
      grid.Uneven ? ToIndexGradient(this->Scene, place, differences) : differences;
    return grid.Hidden ? FindShownGradient<T>(
                           this->Scene, this->Border, place, lanes, gradient, component, ofOpacity)
                       : gradient;
  }

  /// Interpolates values at positions that move little: their voxels are fetched again only where
  /// they leave the cells that they are in.
  class CellValues
  {
  public:
    /// `volume`: SlicesInReach is 0; must outlive this.
    explicit CellValues(const PacketVolume& volume)
      : Volume(volume)
    {
    }

    /// Values at q, of `lanes`; all voxels of these must exist.
    HWY_INLINE Vf Find(const Vec3& q, Mf lanes)
    {
      const Di di;
      SampleCells cells;
      const SamplePosition at = FindCells(this->Volume, q, true, cells);
      const auto same = [](Vi a, Vi b) { return hn::Eq(a, b); };
      const auto stays = hn::And(same(cells.X, this->Cells.X),
        hn::And(same(cells.Y, this->Cells.Y), same(cells.Z, this->Cells.Z)));
      if (!this->Known || !hn::AllFalse(di, hn::AndNot(stays, hn::RebindMask(di, lanes))))
      {
        this->Known = true;
        this->Cells = cells;
        OffsetRows<T> voxels;
        voxels.Fit(this->Volume, cells, lanes);
        return Sample<T>(voxels, at, this->Rows);
      }
      using F = Fetch<T>;
      const SampleRows<T>& rows = this->Rows;
      return F::Value(Across<T>(at, F::Middle(rows.R00, at), F::Middle(rows.R10, at),
                        F::Middle(rows.R01, at), F::Middle(rows.R11, at)),
        at);
    }

  private:
    const PacketVolume& Volume;
    SampleCells Cells{ hn::Zero(Di()), hn::Zero(Di()), hn::Zero(Di()) };
    SampleRows<T> Rows;
    bool Known = false;
  };

  PacketState State;
  PacketNormals Normals;
  BorderSamples<T> Border;
  VoxelWindow<T> Window; ///< voxels around the last inner sample

private:
  /// The extinctions that densities of one of several components have by its table. Where it does
  /// not tell what is transparent, all may be visible.
  HWY_INLINE Vf FindFirstExtinction(
    const PacketComponent& component, Vf density, std::size_t number) const
  {
    return HWY_LIKELY(component.ByTable) ? TableLookup(this->Scene, density, number).Extinction()
                                         : Splat(1.0f);
  }

  /// The positions around samples at q, the position at s of a curve, that are clipped.
  HWY_NOINLINE ClippedNeighbors FindClipped(const PacketCurve& curve, const Vec3& q, Vf s)
  {
    const Vf t = curve.TimeAt(s);
    Vec3 steps[3];
    this->Normals.FindSteps(curve, q, s, t, steps);
    return FindClippedNeighbors(
      this->Scene, q, MulAdd(t, this->Rays.Direction, this->Rays.Origin), steps);
  }

  /// Does what FindGradient() does beside clipping planes, or of the opacity; of plain images.
  template <class Source>
  HWY_NOINLINE Vec3 FindSpecialGradient(const Source& voxels, const SamplePosition& at,
    const SampleRows<T>& rows, const PacketCurve& curve, const Vec3& q, const Vec3& voxel, Vf s,
    Mf border, bool ofOpacity)
  {
    NeighborValues of = FindNeighbors<T>(voxels, at, rows, this->Border, voxel, border);
    if (this->Scene.ClipsGradients)
    {
      // Of several components the density is the last one.
      this->FindClipped(curve, q, s)
        .Replace(this->Scene.ClippedValues[this->Scene.Volume.Components - 1], of);
    }
    if (ofOpacity)
    {
      of = OpacitiesOf(of, [&](Vf values) { return OpacityOfValues(this->Scene, values); });
    }
    return GradientOfNeighbors(this->Scene.Volume, voxel, border, of);
  }

  /// Gradients of samples at q, the position at s of a curve, in the lanes of `lanes`, or those of
  /// their opacities. `voxel`: FindSampledVoxels(). Those of `border` lie at faces.
  template <class Source>
  HWY_INLINE Vec3 FindGradient(const Source& voxels, const SamplePosition& at,
    const SampleRows<T>& rows, const PacketCurve& curve, const Vec3& q, const Vec3& voxel, Vf s,
    Mf lanes, Mf border, bool ofOpacity = false)
  {
    const Vec3 gradient = HWY_UNLIKELY(ofOpacity || this->Scene.ClipsGradients)
      ? this->FindSpecialGradient(voxels, at, rows, curve, q, voxel, s, border, ofOpacity)
      : this->GradientOf(voxels, at, rows, voxel, border);
    // Of several components the density is the last one.
    return HWY_UNLIKELY(this->Scene.Grid.ChangesGradients())
      ? this->FindGridGradient(
          q, voxel, lanes, gradient, this->Scene.Volume.Components - 1, ofOpacity)
      : gradient;
  }

  /// Finds the gradients of the components `wanted`, a bit each, of samples at q that were fetched,
  /// as FindGradient() does, and, if they are needed, those of the opacities.
  HWY_INLINE void FindGradients(FetchedComponents<T>& samples, unsigned int wanted,
    const PacketCurve& curve, const Vec3& q, const Vec3& voxel, Vf s, Mf lanes, Vec3* gradients,
    Vec3* ofOpacity)
  {
    if (HWY_UNLIKELY(this->Scene.NormalsOfOpacity || this->Scene.ClipsGradients))
    {
      this->FindSpecialGradients(samples, wanted, curve, q, voxel, s, gradients, ofOpacity);
    }
    else
    {
      samples.FindGradients(wanted, gradients);
    }
    if (HWY_LIKELY(!this->Scene.Grid.ChangesGradients()))
    {
      return;
    }
    for (int c = 0; c < this->Scene.Volume.Components; ++c)
    {
      if (IsWanted(wanted, c))
      {
        gradients[c] = this->FindGridGradient(q, voxel, lanes, gradients[c], c);
      }
    }
    const int opacities =
      this->Scene.NormalsOfOpacity ? static_cast<int>(this->Scene.Components.size()) : 0;
    for (int c = 0; c < opacities; ++c)
    {
      ofOpacity[c] = this->FindGridGradient(q, voxel, lanes, ofOpacity[c], c, true);
    }
  }

  /// Does what FindGradients() does beside clipping planes, and of the opacities; of plain images.
  HWY_NOINLINE void FindSpecialGradients(FetchedComponents<T>& samples, unsigned int wanted,
    const PacketCurve& curve, const Vec3& q, const Vec3& voxel, Vf s, Vec3* gradients,
    Vec3* ofOpacity)
  {
    NeighborValues of[LargestNumberOfComponents];
    samples.FindNeighbors(wanted, of);
    const auto toGradient = [&](const NeighborValues& neighbors) {
      return GradientOfNeighbors(this->Scene.Volume, voxel, samples.GetAtBorder(), neighbors);
    };
    if (this->Scene.ClipsGradients)
    {
      const ClippedNeighbors clipped = this->FindClipped(curve, q, s);
      for (int c = 0; c < LargestNumberOfComponents; ++c)
      {
        if (IsWanted(wanted, c))
        {
          clipped.Replace(this->Scene.ClippedValues[c], of[c]);
        }
      }
    }
    for (int c = 0; c < LargestNumberOfComponents; ++c)
    {
      if (IsWanted(wanted, c))
      {
        gradients[c] = toGradient(of[c]);
      }
    }
    const bool independent = this->Scene.KindOfComponents == ComponentKind::Independent;
    for (std::size_t i = 0; i < this->Scene.Components.size() && this->Scene.NormalsOfOpacity; ++i)
    {
      if (independent && !IsWanted(wanted, static_cast<int>(i)))
      {
        continue;
      }
      NeighborValues densities;
      for (int a = 0; a < 3; ++a)
      {
        Vf behind[LargestNumberOfComponents];
        Vf before[LargestNumberOfComponents];
        for (int c = 0; c < this->Scene.Volume.Components; ++c)
        {
          behind[c] = of[c].Behind[a];
          before[c] = of[c].Before[a];
        }
        densities.Behind[a] = DensityOf(this->Scene, i, behind);
        densities.Before[a] = DensityOf(this->Scene, i, before);
      }
      ofOpacity[i] = toGradient(
        OpacitiesOf(densities, [&](Vf values) { return OpacityOfValues(this->Scene, values, i); }));
    }
  }

  /// Whether windows can be used at faces: no position is beyond the outermost voxels.
  HWY_INLINE bool CanUseFaces() const
  {
    return this->Scene.Lower == 0.0f && !this->Scene.Volume.Nearest;
  }

  /// Returns use(fit), the WindowFit of the segment as a constant.
  template <bool AtFaces, class Use>
  HWY_INLINE int WithWindow(const Use& use)
  {
    if constexpr (HasVoxelWindow<T>())
    {
      switch (!AtFaces || this->CanUseFaces() ? this->Window.GetFit() : WindowFit::None)
      {
        case WindowFit::Two:
          return use(std::integral_constant<WindowFit, WindowFit::Two>());
        case WindowFit::Three:
          return use(std::integral_constant<WindowFit, WindowFit::Three>());
        case WindowFit::Four:
          return use(std::integral_constant<WindowFit, WindowFit::Four>());
        default:
          break;
      }
    }
    return use(std::integral_constant<WindowFit, WindowFit::None>());
  }

  /// The lanes of `sampled` whose samples, at q and s of a curve, are in the volume and not
  /// cropped.
  template <bool AtFaces>
  HWY_INLINE Mf FindShown(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled) const
  {
    if (HWY_UNLIKELY(this->Scene.CropSpace != Cropping::Spaces::None))
    {
      return hn::And(sampled, IsShown(this->Scene, this->Rays, curve, q, s));
    }
    return AtFaces ? hn::And(sampled, IsInside(this->Scene, q)) : sampled;
  }

  /// TakeSamples() with windows of one kind, or without.
  template <bool Plain, bool AtFaces, WindowFit Fit>
  HWY_NOINLINE int TakeSamples(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    const Df d;
    for (int n = from; n < to; ++n)
    {
      Mf sampled = numbers.FindActive(this->State.Alive, n);
      const Vf s = numbers.FindPlaces(curve, n);
      const Vec3 q = curve.At(this->Scene, s);
      if (AtFaces || (!Plain && HWY_UNLIKELY(this->Scene.CropSpace != Cropping::Spaces::None)))
      {
        sampled = this->template FindShown<AtFaces>(curve, q, s, sampled);
        if (hn::AllFalse(d, sampled))
        {
          continue;
        }
      }
      if (Fit == WindowFit::None && (AtFaces || HWY_UNLIKELY(this->Scene.Volume.SlicesInReach > 0)))
      {
        this->template TakeSample<Plain>(curve, q, s, sampled);
      }
      else
      {
        SampleCells cells;
        const Vec3 voxel = Plain ? q : FindSampledVoxels(this->Scene, q);
        const SamplePosition at = FindCells(this->Scene.Volume, voxel, !AtFaces, cells);
        const Mf border = AtFaces
          ? hn::AndNot(FindInterior(this->Scene.Volume, cells, sampled), sampled)
          : hn::FirstN(d, 0);
        auto voxels = this->template FindRows<AtFaces, Fit, !Plain>(n, cells, sampled);
        SampleRows<T> rows;
        const Vf value = Sample<T>(voxels, at, rows);
        this->template Composite<Plain>(
          voxels, at, rows, value, curve, q, voxel, s, sampled, border);
      }
      if (HWY_UNLIKELY(hn::AllFalse(d, this->State.Alive)))
      {
        return n;
      }
    }
    return to;
  }

  /// TakeDependentComponents() with windows of one kind. The density is the last component; voxels
  /// of the others are loaded where it is visible.
  template <int Components, bool AtFaces, WindowFit Fit>
  HWY_NOINLINE int TakeComponentsOf(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    const Df d;
    const PacketComponent& component = this->Scene.Components[0];
    for (int n = from; n < to; ++n)
    {
      Mf sampled = numbers.FindActive(this->State.Alive, n);
      const Vf s = numbers.FindPlaces(curve, n);
      const Vec3 q = curve.At(this->Scene, s);
      sampled = this->template FindShown<AtFaces>(curve, q, s, sampled);
      if (hn::AllFalse(d, sampled))
      {
        continue;
      }
      this->Statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
      SampleCells cells;
      const Vec3 voxel = FindSampledVoxels(this->Scene, q);
      const SamplePosition at = FindCells(this->Scene.Volume, voxel, !AtFaces, cells);
      this->Window.template MoveTo<AtFaces>(n);
      WindowRows<T, Fit, AtFaces, Components> voxels(this->Window, cells);
      SampleRows<T> rows;
      const Vf density = Sample<T>(voxels, at, rows);
      // Comparisons with what is not a number are false.
      sampled = hn::And(sampled,
        hn::And(hn::Ge(density, Splat(component.Visible.Low)),
          hn::Le(density, Splat(component.Visible.High))));
      if (hn::AllFalse(d, sampled))
      {
        continue;
      }
      const Vf ofTable = this->FindFirstExtinction(component, density, 0);
      Mf visible = hn::And(sampled, hn::Gt(ofTable, hn::Zero(d)));
      if (this->Scene.HidesSamples && !hn::AllFalse(d, visible))
      {
        visible = LeaveOutHidden(this->Scene, q, visible);
      }
      if (hn::AllFalse(d, visible))
      {
        continue;
      }
      const Mf border = AtFaces
        ? hn::AndNot(FindInterior(this->Scene.Volume, cells, visible), visible)
        : hn::FirstN(d, 0);
      Vec3 gradient{ hn::Zero(d), hn::Zero(d), hn::Zero(d) };
      const bool shadesByValue = this->Scene.Shade && !this->Scene.NormalsOfOpacity;
      if (this->Scene.Shade || this->Scene.OpacityByGradient)
      {
        voxels.Widen();
      }
      if (shadesByValue || this->Scene.OpacityByGradient)
      {
        gradient = this->FindGradient(voxels, at, rows, curve, q, voxel, s, visible, border);
      }
      const Vec3 normal = HWY_UNLIKELY(this->Scene.NormalsOfOpacity)
        ? this->FindGradient(voxels, at, rows, curve, q, voxel, s, visible, border, true)
        : gradient;
      Vf values[LargestNumberOfComponents];
      ComponentSamples<T>(this->Scene.Volume, cells, at, hn::AndNot(border, visible))
        .FindValues(values);
      if (AtFaces && !hn::AllFalse(d, border))
      {
        this->Border.ComponentValues(voxel, border, values);
      }
      const Vf t = curve.TimeAt(s);
      Vec3 color;
      Vf extinction;
      this->ClassifyDependent(curve, q, s, t, values, ofTable, gradient, normal, color, extinction);
      this->AddComponents(curve, s, t, color, extinction, visible);
      if (HWY_UNLIKELY(hn::AllFalse(d, this->State.Alive)))
      {
        return n;
      }
    }
    return to;
  }

  /// Composites colors of several components over the intervals of the samples at s.
  HWY_INLINE void AddComponents(
    const PacketCurve& curve, Vf s, Vf t, const Vec3& color, Vf extinction, Mf visible)
  {
    const Df d;
    visible = hn::And(visible, hn::Gt(extinction, hn::Zero(d)));
    if (hn::AllFalse(d, visible))
    {
      return;
    }
    this->Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, visible));
    this->State.Expecting = visible;
    this->AddColor(color, extinction, visible, curve, s, t);
  }

  /// ForValues() with windows of one kind, or without.
  template <int Ahead, bool AtFaces, WindowFit Fit, class Use>
  HWY_NOINLINE int ForValues(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to, const Use& use)
  {
    const Df d;
    const bool moved = this->Scene.Grid.MovesSamples();
    for (int n = from; n < to; ++n)
    {
      Mf sampled = numbers.FindActive(this->State.Alive, n);
      const Vf s = numbers.FindPlaces(curve, n);
      const Vec3 q =
        curve.At(this->Scene, Ahead == 0 ? s : hn::MulAdd(Splat(Ahead), curve.PerStep, s));
      if constexpr (Ahead == 0)
      {
        sampled = this->template FindShown<AtFaces>(curve, q, s, sampled);
        if (hn::AllFalse(d, sampled))
        {
          continue;
        }
      }
      Vf value;
      if (HWY_UNLIKELY(moved) && !AtFaces)
      {
        value = this->FindMovedInnerValue(n + Ahead, q, sampled);
      }
      else if ((Fit == WindowFit::None &&
                 (AtFaces || HWY_UNLIKELY(this->Scene.Volume.SlicesInReach > 0))) ||
        HWY_UNLIKELY(moved))
      {
        const Mf inside = Ahead == 0 ? sampled : hn::And(sampled, IsInside(this->Scene, q));
        value = this->FindValue(q, inside);
      }
      else
      {
        SampleCells cells;
        const SamplePosition at = FindCells(this->Scene.Volume, q, !AtFaces, cells);
        auto voxels = this->template FindRows<AtFaces, Fit, false>(n + Ahead, cells, sampled);
        SampleRows<T> rows;
        value = Sample<T>(voxels, at, rows);
      }
      use(n, s, sampled, value);
      if (HWY_UNLIKELY(hn::AllFalse(d, this->State.Alive)))
      {
        return n;
      }
    }
    return to;
  }

  template <bool AtFaces, WindowFit Fit>
  using RowsOf =
    std::conditional_t<Fit == WindowFit::None, OffsetRows<T>, WindowRows<T, Fit, AtFaces>>;

  /// The source of the rows of the samples n of a curve, which lie in `cells`. Without a window all
  /// voxels that they and their gradients need must exist, and be in reach.
  template <bool AtFaces, WindowFit Fit, bool AnyGrid>
  HWY_INLINE RowsOf<AtFaces, Fit> FindRows(int n, const SampleCells& cells, Mf sampled)
  {
    if constexpr (Fit == WindowFit::None)
    {
      static_cast<void>(n);
      OffsetRows<T> voxels;
      voxels.Fit(this->Scene.Volume, cells, sampled);
      return voxels;
    }
    else
    {
      static_cast<void>(sampled);
      this->Window.template MoveTo<AtFaces, AnyGrid>(n);
      return WindowRows<T, Fit, AtFaces>(this->Window, cells);
    }
  }

  /**
   * Calls use(voxels, at, border) with a source of the rows of the samples n of a curve, or of
   * places in the intervals that end there, at the voxel coordinates `voxel`; `border`: those of
   * `sampled` without all voxels that they and their gradients need. Calls otherwise() where there
   * is no such source.
   */
  template <bool AtFaces, class Use, class Otherwise>
  HWY_INLINE void UseRows(
    int n, const Vec3& voxel, Mf sampled, const Use& use, const Otherwise& otherwise)
  {
    this->template WithWindow<AtFaces>([&](auto fit) {
      constexpr WindowFit Fit = decltype(fit)::value;
      if (Fit == WindowFit::None && (AtFaces || HWY_UNLIKELY(this->Scene.Volume.SlicesInReach > 0)))
      {
        otherwise();
        return 0;
      }
      SampleCells cells;
      const SamplePosition at = FindCells(this->Scene.Volume, voxel, !AtFaces, cells);
      const Mf border = AtFaces
        ? hn::AndNot(FindInterior(this->Scene.Volume, cells, sampled), sampled)
        : hn::FirstN(Df(), 0);
      auto voxels = this->template FindRows<AtFaces, Fit, true>(n, cells, sampled);
      use(voxels, at, border);
      return 0;
    });
  }

  HWY_INLINE Vec3 ClampToVolume(const Vec3& q) const
  {
    const Vf lower = Splat(this->Scene.Lower);
    return { Clamp(q.x, lower, Splat(this->Scene.Upper[0])),
      Clamp(q.y, lower, Splat(this->Scene.Upper[1])),
      Clamp(q.z, lower, Splat(this->Scene.Upper[2])) };
  }

  /// TakeInterval() of intervals at whose ends the values are `back`.
  HWY_INLINE void TakeInterval(
    const PacketCurve& curve, int n, Vf s, Mf sampled, Vf back, bool inner)
  {
    const Df d;
    const PacketIntegrals& integrals = this->Scene.Integrals;
    this->Statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
    const Vf number = Splat(static_cast<float>(n));
    const Mf unknown = hn::AndNot(hn::Eq(this->LastNumber, hn::Sub(number, Splat(1.0f))), sampled);
    Vf front = this->LastValue;
    const bool known = hn::AllFalse(d, unknown);
    if (HWY_UNLIKELY(!known))
    {
      front = hn::IfThenElse(unknown, this->FindFront(curve, n, s, unknown, back, inner), front);
    }
    this->LastValue = hn::IfThenElse(sampled, back, this->LastValue);
    this->LastNumber = hn::IfThenElse(sampled, number, this->LastNumber);
    // As IntervalTable::MayShow(). Comparisons with what is not a number are false.
    const Vf difference = hn::Abs(hn::Sub(back, front));
    sampled = hn::And(sampled,
      hn::And(hn::Ge(hn::Add(hn::Max(front, back), difference), Splat(integrals.VisibleLow)),
        hn::Le(hn::Sub(hn::Min(front, back), difference), Splat(integrals.VisibleHigh))));
    if (!hn::AllFalse(d, sampled))
    {
      this->ShowInterval(curve, n, s, sampled, front, back, known, inner);
    }
  }

  /// Where the intervals that end at s begin, on the curve.
  HWY_INLINE Vf FindBegin(const PacketCurve& curve, Vf s) const
  {
    return hn::Max(
      hn::Sub(s, curve.PerStep), hn::Div(hn::Sub(this->Rays.From, curve.T0), curve.Dt));
  }

  /// Classifies, lights and composites the intervals of the lanes of `sampled`, between two values.
  /// `known`: whether they begin with the ends of those before.
  HWY_NOINLINE void ShowInterval(
    const PacketCurve& curve, int n, Vf s, Mf sampled, Vf front, Vf back, bool known, bool inner)
  {
    const Df d;
    const PacketScene& scene = this->Scene;
    const Vf begin = this->FindBegin(curve, s);
    const Vf extent = hn::Sub(s, begin);
    const Vf length = hn::Mul(extent,
      scene.Settings.Opacity == OpacityLength::Deformed
        ? curve.Dt
        : FindLength(scene, curve.Position.Slope(s)));
    // Where the interval before was looked up, this one begins with its end.
    const IntervalPoint first =
      known && this->LastPointNumber == n - 1 ? this->LastPoint : FindIntervalPoint(scene, front);
    const IntervalPoint last = FindIntervalPoint(scene, back);
    this->LastPoint = last;
    this->LastPointNumber = n;
    const Vf guess = hn::Mul(FindMeanExtinction(scene, first, last), length);
    const Vf place =
      FindPlaceOfLight(hn::Mul(first.Extinction, length), hn::Mul(last.Extinction, length), guess);
    const Vf at = hn::IfThenElse(hn::Gt(guess, hn::Zero(d)), place, Splat(0.5f));
    const Vf middle = hn::MulAdd(at, extent, begin);
    const Vec3 q = this->ClampToVolume(curve.At(this->Scene, middle));
    const Vec3 voxel = FindSampledVoxels(scene, q);
    const auto composite = [&](auto& voxels, const SamplePosition& in, const SampleRows<T>& rows,
                             Vf value, Mf border) {
      const ClassifiedIntervals interval =
        ClassifyIntervals(scene, first, FindIntervalPoint(scene, value), last, at, length);
      const Mf visible =
        hn::And(sampled, hn::And(hn::Gt(interval.OpticalDepth, hn::Zero(d)), hn::Eq(value, value)));
      if (hn::AllFalse(d, visible))
      {
        return;
      }
      this->Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, visible));
      this->State.Expecting = visible;
      Vec3 color = TableLookup::OfEntries(scene, interval.Entry).Color();
      if (scene.Shade)
      {
        voxels.Widen();
        const Vec3 gradient = this->FindGradient(
          voxels, in, rows, curve, q, voxel, middle, visible, border, scene.NormalsOfOpacity);
        color = this->Normals.Light(
          scene.Surface, curve, q, color, gradient, middle, curve.TimeAt(middle));
      }
      this->State.Add(visible, color, Exp2(hn::Neg(interval.OpticalDepth)),
        curve.TimeAt(hn::MulAdd(interval.Place, extent, begin)),
        scene.Settings.TerminationTransmittance);
    };
    const auto compositeAny = [&] {
      FetchedSample<T> fetched;
      FetchSample(scene.Volume, voxel, sampled, this->Border, fetched);
      composite(fetched.Voxels, fetched.At, fetched.Rows, fetched.Value, fetched.AtBorder);
    };
    const auto compositeRows = [&](auto& voxels, const SamplePosition& in, Mf border) {
      SampleRows<T> rows;
      const Vf value = Sample<T>(voxels, in, rows);
      composite(voxels, in, rows, value, border);
    };
    if (inner)
    {
      this->template UseRows<false>(n, voxel, sampled, compositeRows, compositeAny);
    }
    else if (curve.Segment)
    {
      this->template UseRows<true>(n, voxel, sampled, compositeRows, compositeAny);
    }
    else
    {
      compositeAny();
    }
  }

  /// Values where the intervals that end at the samples n begin, if the samples before were not
  /// taken: those of `lanes`. What is cropped there looks as the ends of the intervals.
  HWY_NOINLINE Vf FindFront(const PacketCurve& curve, int n, Vf s, Mf lanes, Vf back, bool inner)
  {
    const Vf begin = this->FindBegin(curve, s);
    const Vec3 q = curve.At(this->Scene, begin);
    const Vf value =
      inner ? this->FindInnerValue(n, q, lanes) : this->FindValue(this->ClampToVolume(q), lanes);
    if (this->Scene.CropSpace == Cropping::Spaces::None)
    {
      return value;
    }
    const bool rest = this->Scene.CropSpace == Cropping::Spaces::Rest;
    const Vec3 p = rest ? q : MulAdd(curve.TimeAt(begin), this->Rays.Direction, this->Rays.Origin);
    return hn::IfThenElse(IsUncropped(this->Scene, p), value, back);
  }

  /// Gradients whose factors are not known to be zero.
  static HWY_INLINE Mf IsAboveZero(const PacketGradientOpacity& gradients, const Vec3& gradient)
  {
    return hn::Gt(FindSquaredMagnitude(gradients.Scale, gradient), Splat(gradients.ZeroUpTo));
  }

  /// Classifies, shades and composites the samples of the lanes of `sampled` at q, fetched at the
  /// voxel coordinates `voxel`; BorderSamples fetched those of `border`.
  template <bool Plain, class Source>
  HWY_INLINE void Composite(Source& voxels, const SamplePosition& at, const SampleRows<T>& rows,
    Vf value, const PacketCurve& curve, const Vec3& q, const Vec3& voxel, Vf s, Mf sampled,
    Mf border)
  {
    const Df d;
    this->Statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
    // Comparisons with what is not a number are false.
    sampled = hn::And(sampled,
      hn::And(hn::Ge(value, Splat(this->Scene.Visible.Low)),
        hn::Le(value, Splat(this->Scene.Visible.High))));
    if (hn::AllFalse(d, sampled))
    {
      return;
    }
    const PacketMask& mask = this->Scene.Mask;
    const PacketPlane& plane = this->Scene.Plane;
    const bool byGradient = !Plain && this->Scene.OpacityByGradient;
    const bool byOpacity = !Plain && this->Scene.NormalsOfOpacity;
    const PacketGradientOpacity& gradients = this->Scene.Gradients;
    const auto findGradient = [&](Mf lanes) FFD_INLINE_LAMBDA {
      return Plain ? this->GradientOf(voxels, at, rows, q, border)
                   : this->FindGradient(voxels, at, rows, curve, q, voxel, s, lanes, border);
    };
    Vec3 gradient{ hn::Zero(d), hn::Zero(d), hn::Zero(d) };
    // Most gradients of what is visible by its value may be small: no table is looked up for them.
    const bool gradientFirst =
      byGradient && gradients.ZeroUpTo > 0.0f && !mask.Scalars && !this->Scene.HidesSamples;
    if (gradientFirst)
    {
      voxels.Widen();
      gradient = findGradient(sampled);
      sampled = hn::And(sampled, IsAboveZero(gradients, gradient));
      if (hn::AllFalse(d, sampled))
      {
        return;
      }
    }
    const bool byPlane = !Plain && plane.Texels != nullptr;
    const bool labeled = !Plain && !mask.Tables.empty();
    const bool mixed = labeled && (byPlane || mask.BlendFactor < 1.0f);
    const Vi tables =
      labeled ? FindLabelTables(mask, FindMaskPosition(this->Scene, q)) : hn::Zero(Di());
    TableLookup lookup;
    TableLookup base;
    Vf extinction = Splat(1.0f);
    Mf visible = sampled;
    if (!byPlane)
    {
      lookup = labeled ? TableLookup(this->Scene, value, tables) : TableLookup(this->Scene, value);
      extinction = lookup.Extinction();
      Mf some = hn::Gt(extinction, hn::Zero(d));
      if (HWY_UNLIKELY(mixed))
      {
        base = TableLookup(this->Scene, value);
        some = hn::Or(some, hn::Gt(base.Extinction(), hn::Zero(d)));
      }
      visible = hn::And(sampled, some);
    }
    else if (labeled)
    {
      lookup = TableLookup(this->Scene, value, tables);
    }
    if (!Plain && this->Scene.HidesSamples && !hn::AllFalse(d, visible))
    {
      visible = LeaveOutHidden(this->Scene, q, visible);
    }
    if (hn::AllFalse(d, visible))
    {
      return;
    }
    if (!gradientFirst && (byGradient || this->Scene.Shade))
    {
      voxels.Widen();
    }
    if (!gradientFirst && (byGradient || (this->Scene.Shade && !byOpacity)))
    {
      gradient = findGradient(visible);
    }
    if (!gradientFirst && byGradient && gradients.ZeroUpTo > 0.0f)
    {
      visible = hn::And(visible, IsAboveZero(gradients, gradient));
      if (hn::AllFalse(d, visible))
      {
        return;
      }
    }
    Vec3 color;
    // Opacities that are not of the table are over a length, which mostly is the interval.
    const bool weighed = mixed || byGradient || byPlane;
    Vf factor = Splat(1.0f);
    Vf opacity = hn::Zero(d);
    if (HWY_UNLIKELY(mixed && byPlane))
    {
      MixPlaneWithLabels(
        this->Scene, value, lookup, tables, gradient, FindVoxels(this->Scene, q), opacity, color);
    }
    else if (HWY_UNLIKELY(mixed))
    {
      MixWithLabels(this->Scene, base, lookup, tables, gradient, opacity, color);
    }
    else if (byPlane)
    {
      const PlaneTexel texel = LookUpPlane(plane, value, gradient, FindVoxels(this->Scene, q));
      opacity = texel.Opacity;
      color = texel.Color;
    }
    else if (byGradient)
    {
      factor = labeled ? FactorOf(mask, tables, gradient) : FactorOf(gradients, gradient);
      opacity = hn::Mul(OpacityOf(this->Scene, extinction), factor);
    }
    if (weighed)
    {
      visible = hn::And(visible, hn::Gt(opacity, hn::Zero(d)));
      if (hn::AllFalse(d, visible))
      {
        return;
      }
    }
    this->Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, visible));
    this->State.Expecting = visible;

    if (HWY_LIKELY(!mixed && !byPlane))
    {
      color = lookup.Color();
    }
    const Vf t = curve.TimeAt(s);
    if (HWY_UNLIKELY(byOpacity))
    {
      gradient = this->FindGradient(
        voxels, at, rows, curve, q, voxel, s, visible, hn::And(border, visible), true);
    }
    if (this->Scene.Shade)
    {
      color = this->Normals.Light(this->Scene.Surface, curve, q, color, gradient, s, t);
    }
    if (HWY_UNLIKELY(weighed))
    {
      const bool ofTexel = byPlane && !mixed;
      const bool isInterval = ofTexel ? this->Scene.Settings.Opacity == OpacityLength::Deformed &&
          static_cast<float>(this->Scene.Settings.SampleDistance) == plane.UnitDistance
                                      : this->Scene.ReferenceIsInterval;
      if (HWY_LIKELY(isInterval))
      {
        return this->State.Add(visible, color, hn::Sub(Splat(1.0f), opacity), t,
          this->Scene.Settings.TerminationTransmittance);
      }
      const Mf exact = mixed || byPlane ? hn::FirstN(d, 0) : hn::Ge(factor, Splat(1.0f));
      extinction = hn::IfThenElse(exact, extinction,
        OpaqueExtinctionOver(opacity, ofTexel ? plane.UnitDistance : this->Scene.ReferenceLength));
    }
    this->AddColor(color, extinction, visible, curve, s, t);
  }

  /// Composites lit colors over the interval of the sample at s.
  HWY_INLINE void AddColor(
    const Vec3& color, Vf extinction, Mf visible, const PacketCurve& curve, Vf s, Vf t)
  {
    const Vf interval = this->Scene.Settings.Opacity == OpacityLength::Deformed
      ? Splat(static_cast<float>(this->Scene.Settings.SampleDistance))
      : hn::Mul(curve.PerStep, FindLength(this->Scene, curve.Position.Slope(s)));
    this->State.Add(visible, color, Exp2(hn::Neg(hn::Mul(extinction, interval))), t,
      this->Scene.Settings.TerminationTransmittance);
  }

  /// Mixes independent components: the opacity is sum(a^2) / sum(a), the premultiplied color
  /// sum(a c).
  HWY_NOINLINE void MixComponents(const PacketCurve& curve, const Vec3& q, Vf s, Vf t,
    const Vf* values, const Vf* extinctions, const Vec3* gradients, const Vec3* normals,
    Vec3& color, Vf& extinction)
  {
    const Df d;
    const Vf zero = hn::Zero(d);
    Vec3 colors{ zero, zero, zero };
    Vf sum = zero;
    Vf squares = zero;
    const PacketPlane& first = this->Scene.Components[0].Plane;
    const Vf second =
      first.SecondAxis.Scalars ? FindSecondAxis(first, FindVoxels(this->Scene, q)) : zero;
    for (std::size_t c = 0; c < this->Scene.Components.size(); ++c)
    {
      const PacketComponent& component = this->Scene.Components[c];
      const Mf visible = hn::Gt(extinctions[c], zero);
      if (hn::AllFalse(d, visible))
      {
        continue;
      }
      Vf opacity;
      Vec3 own;
      if (HWY_UNLIKELY(component.Plane.Texels != nullptr))
      {
        const PlaneTexel texel = component.Plane.SecondAxis.Scalars
          ? LookUpPlane(component.Plane, values[c], second)
          : LookUpPlane(component.Plane, values[c],
              FindMagnitude(component.Plane.MagnitudeScale, gradients[c]));
        opacity = OpacityOf(this->Scene, component.Plane, texel);
        own = texel.Color;
      }
      else
      {
        opacity = OpacityOf(this->Scene, extinctions[c]);
        own = TableLookup(this->Scene, values[c], c).Color();
      }
      opacity = hn::Mul(Splat(component.Weight), opacity);
      if (component.Gradients.Factors)
      {
        opacity = hn::Mul(opacity, FactorOf(component.Gradients, gradients[c]));
      }
      opacity = hn::IfThenElseZero(visible, opacity);
      if (this->Scene.Shade)
      {
        own = this->Normals.Light(component.Surface, curve, q, own, normals[c], s, t);
      }
      colors = MulAdd(opacity, own, colors);
      sum = hn::Add(sum, opacity);
      squares = hn::MulAdd(opacity, opacity, squares);
    }
    const Vf one = Splat(1.0f);
    const Mf some = hn::Gt(squares, zero);
    const Vf opacity = hn::Div(squares, hn::IfThenElse(some, sum, one));
    color = Scale(hn::Div(one, hn::IfThenElse(some, opacity, one)), colors);
    extinction = hn::IfThenElseZero(some, ExtinctionOf(this->Scene, opacity));
  }

  /// The gradient of the density of dependent components, where it is needed.
  HWY_INLINE Vec3 FindDensityGradient(const Vec3* gradients) const
  {
    const Vf zero = hn::Zero(Df());
    if (!this->Scene.Shade && !this->Scene.OpacityByGradient)
    {
      return { zero, zero, zero };
    }
    return this->MixGradients(
      gradients, [&](const Vf* of) { return DensityOf(this->Scene, 0, of); });
  }

  /// The gradient of what mix(values) makes of the values of all components.
  template <class Mix>
  HWY_INLINE Vec3 MixGradients(const Vec3* gradients, const Mix& mix) const
  {
    const auto along = [&](Vf Vec3::*axis) {
      Vf of[LargestNumberOfComponents];
      for (int c = 0; c < this->Scene.Volume.Components; ++c)
      {
        of[c] = gradients[c].*axis;
      }
      return mix(of);
    };
    return { along(&Vec3::x), along(&Vec3::y), along(&Vec3::z) };
  }

  /// Classifies and lights dependent components. `ofTable`: the extinction of the density,
  /// FindFirstExtinction(), `gradient`: its gradient, `normal`: that which gives normals.
  HWY_NOINLINE void ClassifyDependent(const PacketCurve& curve, const Vec3& q, Vf s, Vf t,
    const Vf* values, Vf ofTable, const Vec3& gradient, const Vec3& normal, Vec3& color,
    Vf& extinction)
  {
    const Df d;
    const Vf zero = hn::Zero(d);
    const PacketComponent& component = this->Scene.Components[0];
    if (HWY_UNLIKELY(!component.ByTable))
    {
      this->ClassifyFurther(q, values, gradient, color, extinction);
    }
    else
    {
      extinction = ofTable;
      if (component.Gradients.Factors)
      {
        extinction = hn::IfThenElseZero(hn::Gt(ofTable, zero),
          WeighExtinction(this->Scene, ofTable, FactorOf(component.Gradients, gradient)));
      }
      color = DependentColor(this->Scene, values);
    }
    if (this->Scene.Shade)
    {
      color = this->Normals.Light(component.Surface, curve, q, color, normal, s, t);
    }
  }

  /// Does what ClassifyDependent() does by a two-dimensional transfer function or with labels.
  HWY_NOINLINE void ClassifyFurther(
    const Vec3& q, const Vf* values, const Vec3& gradient, Vec3& color, Vf& extinction)
  {
    const PacketScene& scene = this->Scene;
    const PacketComponent& component = scene.Components[0];
    const Vf density = DensityOf(scene, 0, values);
    const bool labeled = !scene.Mask.Tables.empty();
    Vf opacity;
    color = DependentColor(scene, values);
    if (component.Plane.Texels)
    {
      const PacketPlane& plane = component.Plane;
      const Vf second = plane.SecondAxis.Scalars ? FindSecondAxis(plane, FindVoxels(this->Scene, q))
                                                 : FindMagnitude(plane.MagnitudeScale, gradient);
      const PlaneTexel texel = LookUpPlane(plane, density, second);
      if (scene.ColorPlane.Texels)
      {
        color = LookUpPlane(scene.ColorPlane, values[0], second).Color;
      }
      if (!labeled)
      {
        extinction = OpaqueExtinctionOver(texel.Opacity, plane.UnitDistance);
        return;
      }
      opacity = OpacityOf(scene, plane, texel);
    }
    else
    {
      opacity = OpacityOf(scene, TableLookup(scene, density).Extinction());
      if (component.Gradients.Factors)
      {
        opacity = hn::Mul(opacity, FactorOf(component.Gradients, gradient));
      }
    }
    const Vi tables = FindLabelTables(scene.Mask, FindMaskPosition(scene, q));
    MixInLabels(scene, TableLookup(scene, density, tables), tables, gradient, opacity, color);
    extinction = OpaqueExtinctionOver(opacity, scene.ReferenceLength);
  }

  const PacketScene& Scene;
  const RayPacket& Rays;
  CastStatistics& Statistics;

  // With PacketScene::ClassifiesIntervals: the last samples, their numbers and values.
  Vf LastNumber;
  Vf LastValue;

  // The point at the end of the last intervals that were classified, and their number.
  IntervalPoint LastPoint;
  int LastPointNumber = std::numeric_limits<int>::min();
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
