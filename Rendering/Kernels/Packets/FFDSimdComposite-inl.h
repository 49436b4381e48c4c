// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Compositing the samples of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_COMPOSITE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_COMPOSITE_INL_H_
#undef FFD_SIMD_COMPOSITE_INL_H_
#else
#define FFD_SIMD_COMPOSITE_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdComponentCompositor-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdGradients-inl.h"
#include "FFDSimdGrid-inl.h"
#include "FFDSimdIntervals-inl.h"
#include "FFDSimdLookup-inl.h"
#include "FFDSimdMask-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdOptics-inl.h"
#include "FFDSimdPlane-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdRows-inl.h"
#include "FFDSimdSampler-inl.h"
#include "FFDSimdSegmentTrees-inl.h"

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Classifies, lights and composites the samples of a packet, front to back.
template <class T>
class PacketCompositor : public PacketGradients<T>
{
public:
  /// Keeps references to all but the numbers; these are those of PacketNormals.
  PacketCompositor(const PacketScene& scene, const SegmentTrees& trees, PacketScratch& scratch,
    const RayPacket& rays, int x, int y, Vf rows, Mf active)
    : PacketGradients<T>(scene, trees, scratch, rays, x, y, rows, active)
    , Intervals(*this)
    , Components(*this)
  {
  }

  /// Takes a sample of the lanes of `sampled` at q, the position at s of a curve, in the volume.
  /// `Options` is PacketScene::Options as a constant.
  template <CompositeOptions Options>
  HWY_NOINLINE void TakeSample(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
  {
    const Vec3 voxel = IsAny<Options> ? FindSampledVoxels(this->Scene, q) : q;
    FetchedSample<T> fetched;
    FetchSample(this->Scene.Volume, voxel, sampled, this->Border, fetched);
    this->template Composite<Options>(fetched.Voxels, fetched.At, fetched.Rows, fetched.Value,
      curve, q, voxel, s, sampled, fetched.AtBorder);
  }

  /**
   * Takes the samples from `from` on, before `to`, of a curve of a segment as TakeSample() does,
   * those that are in the volume and not cropped, if PacketScene::Inner is true. Without `AtFaces`
   * all voxels that they and their gradients need must exist. Returns the number of the sample with
   * which all rays have ended, or `to`.
   */
  template <CompositeOptions Options, bool AtFaces>
  HWY_INLINE int TakeSamples(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    return this->template WithWindow<AtFaces>([&](auto fit) FFD_INLINE_LAMBDA {
      return this->template TakeSamples<Options, AtFaces, decltype(fit)::value>(
        curve, numbers, from, to);
    });
  }

  IntervalCompositor<T> Intervals;
  ComponentCompositor<T> Components;

private:
  template <CompositeOptions Options>
  static constexpr bool IsAny = Options == CompositeOptions::Any;

  /// TakeSamples() with windows of one kind, or without.
  template <CompositeOptions Options, bool AtFaces, WindowFit Fit>
  HWY_NOINLINE int TakeSamples(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    const Df d;
    for (int n = from; n < to; ++n)
    {
      Mf sampled = numbers.FindActive(this->State.Alive, n);
      const Vf s = numbers.FindPlaces(curve, n);
      const Vec3 q = curve.At(this->Scene, s);
      if (AtFaces ||
        (IsAny<Options> && HWY_UNLIKELY(this->Scene.CropSpace != Cropping::Spaces::None)))
      {
        sampled = this->template FindShown<AtFaces>(curve, q, s, sampled);
        if (hn::AllFalse(d, sampled))
        {
          continue;
        }
      }
      if (Fit == WindowFit::None && (AtFaces || HWY_UNLIKELY(this->Scene.Volume.SlicesInReach > 0)))
      {
        this->template TakeSample<Options>(curve, q, s, sampled);
      }
      else
      {
        SampleCells cells;
        const Vec3 voxel = IsAny<Options> ? FindSampledVoxels(this->Scene, q) : q;
        const SamplePosition at = FindCells(this->Scene.Volume, voxel, !AtFaces, cells);
        const Mf border = AtFaces
          ? hn::AndNot(FindInterior(this->Scene.Volume, cells, sampled), sampled)
          : hn::FirstN(d, 0);
        auto voxels = this->template FindRows<AtFaces, Fit, IsAny<Options>>(n, cells, sampled);
        SampleRows<T> rows;
        const Vf value = Sample<T>(voxels, at, rows);
        this->template Composite<Options>(
          voxels, at, rows, value, curve, q, voxel, s, sampled, border);
      }
      if (HWY_UNLIKELY(hn::AllFalse(d, this->State.Alive)))
      {
        return n;
      }
    }
    return to;
  }

  /// Gradients whose factors are not known to be zero.
  static HWY_INLINE Mf IsAboveZero(const PacketGradientOpacity& gradients, const Vec3& gradient)
  {
    return hn::Gt(FindSquaredMagnitude(gradients.Scale, gradient), Splat(gradients.ZeroUpTo));
  }

  /// Classifies, shades and composites the samples of the lanes of `sampled` at q, fetched at the
  /// voxel coordinates `voxel`; BorderSamples fetched those of `border`.
  template <CompositeOptions Options, class Source>
  HWY_INLINE void Composite(Source& voxels, const SamplePosition& at, const SampleRows<T>& rows,
    Vf value, const PacketCurve& curve, const Vec3& q, const Vec3& voxel, Vf s, Mf sampled,
    Mf border)
  {
    const Df d;
    constexpr bool Any = IsAny<Options>;
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
    constexpr bool OfPlane = Options == CompositeOptions::Plane;
    const bool byPlane = OfPlane || (Any && plane.Intervals != nullptr);
    const bool byGradient = Options == CompositeOptions::GradientOpacity ||
      ((Any || OfPlane) && this->Scene.OpacityByGradient);
    const bool byOpacity = Any && this->Scene.NormalsOfOpacity;
    const PacketGradientOpacity& gradients = this->Scene.Gradients;
    const auto findGradient = [&](Mf lanes) FFD_INLINE_LAMBDA {
      return Any ? this->FindGradient(voxels, at, rows, curve, q, voxel, s, lanes, border)
                 : this->GradientOf(voxels, at, rows, q, border);
    };
    Vec3 gradient{ hn::Zero(d), hn::Zero(d), hn::Zero(d) };
    // Most gradients of what is visible by its value may be small: no table is looked up for them.
    const bool gradientFirst = byGradient && !OfPlane && gradients.ZeroUpTo > 0.0f &&
      !(Any && (mask.Scalars || this->Scene.HidesSamples));
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
    const bool labeled = Any && !mask.Tables.empty();
    const bool mixed = labeled && (byPlane || mask.BlendFactor < 1.0f);
    const Vi tables =
      labeled ? FindLabelTables(mask, FindMaskPosition(this->Scene, q)) : hn::Zero(Di());
    OpticsLookup lookup;
    OpticsLookup base;
    Mf visible = sampled;
    if (!byPlane || labeled)
    {
      lookup =
        labeled ? OpticsLookup(this->Scene, value, tables) : OpticsLookup(this->Scene, value);
    }
    if (!byPlane)
    {
      Mf some = lookup.IsVisible();
      if (HWY_UNLIKELY(mixed))
      {
        base = OpticsLookup(this->Scene, value);
        some = hn::Or(some, base.IsVisible());
      }
      visible = hn::And(sampled, some);
    }
    if (Any && this->Scene.HidesSamples && !hn::AllFalse(d, visible))
    {
      visible = LeaveOutHidden(this->Scene, Copy(q), visible);
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
    if (!gradientFirst && byGradient && !OfPlane && gradients.ZeroUpTo > 0.0f)
    {
      visible = hn::And(visible, IsAboveZero(gradients, gradient));
      if (hn::AllFalse(d, visible))
      {
        return;
      }
    }
    Vec3 color;
    Vf opacity;
    // Whether opacities are not those of the lookup alone.
    const bool weighed = mixed || byGradient || byPlane;
    if (HWY_UNLIKELY(mixed && byPlane))
    {
      const PlaneTexel mix = MixPlaneWithLabels(
        this->Scene, value, lookup, tables, gradient, FindVoxels(this->Scene, q));
      opacity = mix.Opacity;
      color = mix.Color;
    }
    else if (HWY_UNLIKELY(mixed))
    {
      MixWithLabels(this->Scene, base, lookup, tables, gradient, opacity, color);
    }
    else if (byPlane)
    {
      const PlaneTexel texel = LookUpPlane(plane, value, gradient, FindVoxels(this->Scene, q));
      opacity = OpacityOf(this->Scene, plane, texel);
      color = texel.Color;
    }
    else if (byGradient)
    {
      opacity = hn::Mul(lookup.Opacity(),
        labeled ? FactorOf(mask, tables, gradient) : FactorOf(gradients, gradient));
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
    if (HWY_UNLIKELY(this->Scene.ByExtinctions))
    {
      return this->AddColor(color, lookup.Extinction(), visible, curve, s, t);
    }
    this->AddOpacity(color, weighed ? opacity : lookup.Opacity(), visible, curve, s, t);
  }
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
