// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The values of the samples of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_SAMPLER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_SAMPLER_INL_H_
#undef FFD_SIMD_SAMPLER_INL_H_
#else
#define FFD_SIMD_SAMPLER_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"

#include "FFDSimdBorder-inl.h"
#include "FFDSimdCells-inl.h"
#include "FFDSimdComponents-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdGrid-inl.h"
#include "FFDSimdLookup-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdRows-inl.h"
#include "FFDSimdWindow-inl.h"
#include "FFDSimdWindowRows-inl.h"

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

/// Fetches the values of the samples of a packet, from windows of voxels where these hold them.
template <class T>
class PacketSampler
{
public:
  /// Keeps references to all but the lanes of rays that are cast.
  PacketSampler(const PacketScene& scene, PacketScratch& scratch, const RayPacket& rays, Mf active)
    : State(active)
    , Border(scene, scratch)
    , Window(scene)
    , Scene(scene)
    , Rays(rays)
    , Statistics(scratch.Statistics)
  {
  }

  /**
   * Calls use(n, s, sampled, value) with the samples from `from` on, before `to`, of a curve of a
   * segment, whose values are those `Ahead` samples behind them; with those in the volume and not
   * cropped unless they are ahead. As PacketCompositor::TakeSamples(), for what needs values alone.
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
   * Calls use(n, s, sampled, value) as ForValues() does, with the values of one of two or four
   * components. HasComponentWindow() must be true.
   */
  template <bool AtFaces, class Use>
  HWY_INLINE int ForComponentValues(const PacketCurve& curve, const SampleNumbers& numbers,
    int from, int to, int component, const Use& use)
  {
    return this->template WithComponentWindow<AtFaces>(
      [&](auto components, auto fit) FFD_INLINE_LAMBDA {
        return this
          ->template ForComponentValues<decltype(components)::value, AtFaces, decltype(fit)::value>(
            curve, numbers, from, to, component, use);
      });
  }

  /// Calls use(n, s, sampled, first, second) with the values of both of two components.
  template <bool AtFaces, class Use>
  HWY_INLINE int ForPairsOfValues(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to, const Use& use)
  {
    return this->template WithWindow<AtFaces>([&](auto fit) FFD_INLINE_LAMBDA {
      static_cast<void>(use);
      if constexpr (decltype(fit)::value != WindowFit::None)
      {
        return this->template ForPairsOfValues<AtFaces, decltype(fit)::value>(
          curve, numbers, from, to, use);
      }
      return 0;
    });
  }

  /// Returns use(components, fit), both as constants, where HasComponentWindow() is true.
  template <bool AtFaces, class Use>
  HWY_INLINE int WithComponentWindow(const Use& use)
  {
    return this->template WithWindow<AtFaces>([&](auto fit) FFD_INLINE_LAMBDA {
      static_cast<void>(use);
      if constexpr (decltype(fit)::value != WindowFit::None)
      {
        if constexpr (HasWindowOfOne<T>(4))
        {
          if (this->Scene.Volume.Components == 4)
          {
            return use(std::integral_constant<int, 4>(), fit);
          }
        }
        return use(std::integral_constant<int, 2>(), fit);
      }
      return 0;
    });
  }

  /// Whether single components are read from windows in a segment.
  template <bool AtFaces>
  HWY_INLINE bool HasComponentWindow() const
  {
    if constexpr (HasVoxelWindow())
    {
      return HasWindowOfOne<T>(this->Scene.Volume.Components) &&
        (!AtFaces || this->CanUseFaces()) && this->Window.GetFit() != WindowFit::None;
    }
    return false;
  }

  /// Finds the values at q, in the volume, of the components `wanted`, a bit each.
  HWY_NOINLINE void FindComponents(const Vec3& q, Mf lanes, unsigned int wanted, Vf* values)
  {
    const Vec3 voxel = FindSampledVoxels(this->Scene, q);
    FetchedComponents<T>(this->Scene.Volume, voxel, lanes, this->Border).FindValues(values, wanted);
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
      [&](auto& voxels, const SamplePosition& at, Mf) FFD_INLINE_LAMBDA {
        SampleRows<T> rows;
        value = Sample<T>(voxels, at, rows);
      },
      [&]() FFD_INLINE_LAMBDA { value = this->FindVoxelValue(q, lanes); });
    return value;
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

  /// Whether windows can be used at faces: no position is beyond the outermost voxels.
  HWY_INLINE bool CanUseFaces() const { return this->Scene.Lower == 0.0f; }

  /// Returns use(fit), the WindowFit of the segment as a constant.
  template <bool AtFaces, class Use>
  HWY_INLINE int WithWindow(const Use& use)
  {
    if constexpr (HasVoxelWindow())
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

  /// The source of the rows of samples.
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
    this->template WithWindow<AtFaces>([&](auto fit) FFD_INLINE_LAMBDA {
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

  /// The positions in the volume that are nearest to q.
  HWY_INLINE Vec3 ClampToVolume(const Vec3& q) const
  {
    const Vf lower = Splat(this->Scene.Lower);
    return { Clamp(q.x, lower, Splat(this->Scene.Upper[0])),
      Clamp(q.y, lower, Splat(this->Scene.Upper[1])),
      Clamp(q.z, lower, Splat(this->Scene.Upper[2])) };
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

  /// Composites lit colors, and opacities over PacketScene::OpacityLength, over the interval of the
  /// sample at s.
  HWY_INLINE void AddOpacity(
    const Vec3& color, Vf opacity, Mf visible, const PacketCurve& curve, Vf s, Vf t)
  {
    if (HWY_LIKELY(this->Scene.OpacityIsInterval))
    {
      return this->State.Add(visible, color, hn::Sub(Splat(1.0f), opacity), t,
        this->Scene.Settings.TerminationTransmittance);
    }
    this->AddColor(color, ExtinctionOver(opacity, this->Scene.OpacityLength), visible, curve, s, t);
  }

  PacketState State;
  BorderSamples<T> Border;
  VoxelWindow<T> Window; ///< voxels around the last inner sample
  const PacketScene& Scene;
  const RayPacket& Rays;
  CastStatistics& Statistics;

private:
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

  /// ForComponentValues() with windows of one kind.
  template <int Components, bool AtFaces, WindowFit Fit, class Use>
  HWY_NOINLINE int ForComponentValues(const PacketCurve& curve, const SampleNumbers& numbers,
    int from, int to, int component, const Use& use)
  {
    return this->template ForCells<AtFaces>(curve, numbers, from, to,
      [&](int n, Vf s, Mf sampled, const SampleCells& cells, const SamplePosition& at)
        FFD_INLINE_LAMBDA {
          const WindowRows<T, Fit, AtFaces, Components> voxels(this->Window, cells, component);
          SampleRows<T> rows;
          use(n, s, sampled, Sample<T>(voxels, at, rows));
        });
  }

  /// ForPairsOfValues() with windows of one kind.
  template <bool AtFaces, WindowFit Fit, class Use>
  HWY_NOINLINE int ForPairsOfValues(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to, const Use& use)
  {
    return this->template ForCells<AtFaces>(curve, numbers, from, to,
      [&](int n, Vf s, Mf sampled, const SampleCells& cells, const SamplePosition& at)
        FFD_INLINE_LAMBDA {
          const WindowPair<T, Fit, AtFaces> voxels(this->Window, cells);
          SampleRows<T> rows;
          const Vf first = Sample<T>(voxels.First, at, rows);
          use(n, s, sampled, first, Sample<T>(voxels.Second, at, rows));
        });
  }

  /// Moves the window to the samples from `from` on, before `to`, and calls use(n, s, sampled,
  /// cells, at) for those that are in the volume and not cropped, as
  /// PacketCompositor::TakeSamples().
  template <bool AtFaces, class Use>
  HWY_INLINE int ForCells(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to, const Use& use)
  {
    for (int n = from; n < to; ++n)
    {
      const Vf s = numbers.FindPlaces(curve, n);
      const Vec3 q = curve.At(this->Scene, s);
      const Mf sampled =
        this->template FindShown<AtFaces>(curve, q, s, numbers.FindActive(this->State.Alive, n));
      if (hn::AllFalse(Df(), sampled))
      {
        continue;
      }
      SampleCells cells;
      const SamplePosition at =
        FindCells(this->Scene.Volume, FindSampledVoxels(this->Scene, q), !AtFaces, cells);
      this->Window.template MoveTo<AtFaces>(n);
      use(n, s, sampled, cells, at);
      if (HWY_UNLIKELY(hn::AllFalse(Df(), this->State.Alive)))
      {
        return n;
      }
    }
    return to;
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
        value = this->FindMovedInnerValue(n + Ahead, Copy(q), sampled);
      }
      else if ((Fit == WindowFit::None &&
                 (AtFaces || HWY_UNLIKELY(this->Scene.Volume.SlicesInReach > 0))) ||
        HWY_UNLIKELY(moved))
      {
        const Mf inside = Ahead == 0 ? sampled : hn::And(sampled, IsInside(this->Scene, q));
        value = this->FindValue(Copy(q), inside);
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
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
