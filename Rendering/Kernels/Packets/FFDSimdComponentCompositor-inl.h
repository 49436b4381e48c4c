// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Compositing the samples of several components of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_COMPONENT_COMPOSITOR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_COMPONENT_COMPOSITOR_INL_H_
#undef FFD_SIMD_COMPONENT_COMPOSITOR_INL_H_
#else
#define FFD_SIMD_COMPONENT_COMPOSITOR_INL_H_
#endif

#include "FFDPacketScene.h"

#include "FFDSimdBorder-inl.h"
#include "FFDSimdCells-inl.h"
#include "FFDSimdComponents-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdGradients-inl.h"
#include "FFDSimdGrid-inl.h"
#include "FFDSimdLookup-inl.h"
#include "FFDSimdMask-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdOptics-inl.h"
#include "FFDSimdPlane-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdRows-inl.h"
#include "FFDSimdSampler-inl.h"
#include "FFDSimdWindow-inl.h"
#include "FFDSimdWindowRows-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Classifies, lights and composites the samples of several components of a packet, front to back.
template <class T>
class ComponentCompositor
{
public:
  /// Keeps a reference to what finds the samples.
  explicit ComponentCompositor(PacketGradients<T>& samples)
    : Samples(samples)
    , Scene(samples.Scene)
  {
  }

  /// Takes a sample as PacketCompositor::TakeSample() does of one component; as SampleClassifier.
  HWY_NOINLINE void Take(const PacketCurve& curve, const Vec3& q, Vf s, Mf sampled)
  {
    const Df d;
    this->Samples.Statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
    const Vec3 voxel = FindSampledVoxels(this->Scene, q);
    FetchedComponents<T> samples(this->Scene.Volume, voxel, sampled, this->Samples.Border);
    Vf values[LargestNumberOfComponents];
    samples.FindValues(values);
    Vf opacities[LargestNumberOfComponents];
    const bool independent = this->Scene.KindOfComponents == ComponentKind::Independent;
    unsigned int wanted = independent ? 0 : FindDensityComponents(this->Scene);
    const Mf visible = this->FindVisible(q, values, sampled, opacities, wanted);
    if (hn::AllFalse(d, visible))
    {
      return;
    }
    Vec3 gradients[LargestNumberOfComponents];
    Vec3 ofOpacity[LargestNumberOfComponents];
    const Vec3* const normals = this->Scene.NormalsOfOpacity ? ofOpacity : gradients;
    if (this->Scene.Shade || this->Scene.OpacityByGradient)
    {
      this->Samples.FindGradients(
        samples, wanted, curve, q, voxel, s, visible, gradients, ofOpacity);
    }
    const Vf t = curve.TimeAt(s);
    Vec3 color;
    Vf opacity;
    if (independent)
    {
      this->Mix(curve, q, s, t, values, opacities, gradients, normals, color, opacity);
    }
    else
    {
      const Vec3 gradient = this->FindDensityGradient(gradients);
      this->ClassifyDependent(curve, q, s, t, values, opacities[0], gradient,
        this->Scene.NormalsOfOpacity ? ofOpacity[0] : gradient, color, opacity);
    }
    this->Add(curve, s, t, color, opacity, visible);
  }

  /// Whether TakeSamples() can take samples of the curve.
  template <bool AtFaces>
  HWY_INLINE bool HasLoop() const
  {
    return this->Scene.InnerComponents && this->Samples.template HasComponentWindow<AtFaces>();
  }

  /// Takes samples as PacketCompositor::TakeSamples(), where HasLoop() is true.
  template <bool AtFaces>
  HWY_INLINE int TakeSamples(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    return this->Samples.template WithComponentWindow<AtFaces>([&](auto components,
                                                                 auto fit) FFD_INLINE_LAMBDA {
      return this->template TakeSamples<decltype(components)::value, AtFaces, decltype(fit)::value>(
        curve, numbers, from, to);
    });
  }

private:
  /// What dependent components look like, unlit.
  struct Classified
  {
    Vec3 Color;
    Vf Opacity; ///< over PacketScene::OpacityLength
  };

  /// The opacities, over PacketScene::OpacityLength, that densities of one of several components
  /// have by its table. Where it does not tell what is transparent, all may be visible.
  HWY_INLINE Vf FindFirstOpacity(
    const PacketComponent& component, Vf density, std::size_t number) const
  {
    return HWY_LIKELY(component.ByTable) ? OpticsLookup(this->Scene, density, number).Opacity()
                                         : Splat(1.0f);
  }

  /// The lanes of `sampled` in which some density is visible, and the opacities of all of them.
  /// Independent components that are visible are added to `wanted`, a bit each.
  HWY_INLINE Mf FindVisible(
    const Vec3& q, const Vf* values, Mf sampled, Vf* opacities, unsigned int& wanted) const
  {
    const Df d;
    const bool independent = this->Scene.KindOfComponents == ComponentKind::Independent;
    Mf visible = hn::FirstN(d, 0);
    for (std::size_t c = 0; c < this->Scene.Components.size(); ++c)
    {
      // Comparisons with what is not a number are false.
      const PacketComponent& component = this->Scene.Components[c];
      const Vf density = DensityOf(this->Scene, c, values);
      const Mf counts = hn::And(sampled,
        hn::And(hn::Ge(density, Splat(component.Visible.Low)),
          hn::Le(density, Splat(component.Visible.High))));
      opacities[c] = hn::Zero(d);
      if (component.Weight > 0.0f && !hn::AllFalse(d, counts))
      {
        opacities[c] = hn::IfThenElseZero(counts, this->FindFirstOpacity(component, density, c));
        const Mf own = hn::Gt(opacities[c], hn::Zero(d));
        visible = hn::Or(visible, own);
        wanted |= independent && !hn::AllFalse(d, own) ? 1u << c : 0u;
      }
    }
    visible = hn::And(visible, sampled);
    return this->Scene.HidesSamples && !hn::AllFalse(d, visible)
      ? LeaveOutHidden(this->Scene, Copy(q), visible)
      : visible;
  }

  /// The lanes of `visible` that lie at faces of the volume.
  template <bool AtFaces>
  HWY_INLINE Mf FindBorder(const SampleCells& cells, Mf visible) const
  {
    return AtFaces ? hn::AndNot(FindInterior(this->Scene.Volume, cells, visible), visible)
                   : hn::FirstN(Df(), 0);
  }

  /// Finds the gradient of a density, and that which gives normals, where they are needed, as
  /// PacketGradients::FindGradient(); `number`: which of PacketScene::Components.
  template <class Source>
  HWY_INLINE void FindGradients(Source& voxels, const SamplePosition& at, const SampleRows<T>& rows,
    const PacketCurve& curve, const Vec3& q, const Vec3& voxel, Vf s, Mf lanes, Mf border,
    int number, Vec3& gradient, Vec3& normal)
  {
    const Vf zero = hn::Zero(Df());
    gradient = { zero, zero, zero };
    normal = gradient;
    if (!this->Scene.Shade && !this->Scene.OpacityByGradient)
    {
      return;
    }
    voxels.Widen();
    const auto find = [&](bool ofOpacity) FFD_INLINE_LAMBDA {
      return this->Samples.FindGradient(
        voxels, at, rows, curve, q, voxel, s, lanes, border, ofOpacity, number);
    };
    if (!this->Scene.NormalsOfOpacity || this->Scene.OpacityByGradient)
    {
      gradient = find(false);
    }
    normal = HWY_UNLIKELY(this->Scene.NormalsOfOpacity) ? find(true) : gradient;
  }

  /// Takes a sample, at q and s of a curve, of two independent components from windows.
  template <bool AtFaces, WindowFit Fit>
  HWY_INLINE void TakePair(const PacketCurve& curve, const Vec3& q, Vf s, const SampleCells& cells,
    const SamplePosition& at, const Vec3& voxel, Mf sampled)
  {
    const Df d;
    using Source = WindowRows<T, Fit, AtFaces, 2>;
    Source sources[2] = { Source(this->Samples.Window, cells, 0),
      Source(this->Samples.Window, cells, 1) };
    SampleRows<T> rows[2];
    Vf values[2];
    for (int c = 0; c < 2; ++c)
    {
      values[c] = Sample<T>(sources[c], at, rows[c]);
    }
    Vf opacities[2];
    unsigned int wanted = 0;
    const Mf visible = this->FindVisible(q, values, sampled, opacities, wanted);
    if (hn::AllFalse(d, visible))
    {
      return;
    }
    const Mf border = this->template FindBorder<AtFaces>(cells, visible);
    Vec3 gradients[2];
    Vec3 normals[2];
    for (int c = 0; c < 2; ++c)
    {
      if (IsWanted(wanted, c))
      {
        this->FindGradients(sources[c], at, rows[c], curve, q, voxel, s, visible, border, c,
          gradients[c], normals[c]);
      }
    }
    const Vf t = curve.TimeAt(s);
    Vec3 color;
    Vf opacity;
    this->Mix(curve, q, s, t, values, opacities, gradients, normals, color, opacity);
    this->Add(curve, s, t, color, opacity, visible);
  }

  /// The same of dependent components. The density is the last one; voxels of the others are loaded
  /// where it is visible.
  template <int Components, bool AtFaces, WindowFit Fit>
  HWY_INLINE void TakeDependent(const PacketCurve& curve, const Vec3& q, Vf s,
    const SampleCells& cells, const SamplePosition& at, const Vec3& voxel, Mf sampled)
  {
    const Df d;
    const PacketComponent& component = this->Scene.Components[0];
    WindowRows<T, Fit, AtFaces, Components> voxels(this->Samples.Window, cells);
    SampleRows<T> rows;
    const Vf density = Sample<T>(voxels, at, rows);
    // Comparisons with what is not a number are false.
    sampled = hn::And(sampled,
      hn::And(hn::Ge(density, Splat(component.Visible.Low)),
        hn::Le(density, Splat(component.Visible.High))));
    if (hn::AllFalse(d, sampled))
    {
      return;
    }
    const Vf ofTable = this->FindFirstOpacity(component, density, 0);
    Mf visible = hn::And(sampled, hn::Gt(ofTable, hn::Zero(d)));
    if (this->Scene.HidesSamples && !hn::AllFalse(d, visible))
    {
      visible = LeaveOutHidden(this->Scene, Copy(q), visible);
    }
    if (hn::AllFalse(d, visible))
    {
      return;
    }
    const Mf border = this->template FindBorder<AtFaces>(cells, visible);
    Vec3 gradient;
    Vec3 normal;
    this->FindGradients(voxels, at, rows, curve, q, voxel, s, visible, border, 0, gradient, normal);
    Vf values[LargestNumberOfComponents];
    if constexpr (Components == 2)
    {
      const WindowRows<T, Fit, AtFaces, 2> intensities(this->Samples.Window, cells, 0);
      SampleRows<T> rowsOfIntensity;
      values[0] = Sample<T>(intensities, at, rowsOfIntensity);
    }
    else
    {
      constexpr unsigned int Colors = AllComponents & ~(1u << (Components - 1));
      ComponentSamples<T>(this->Scene.Volume, cells, at, hn::AndNot(border, visible))
        .FindValues(values, Colors);
      if (AtFaces && !hn::AllFalse(d, border))
      {
        this->Samples.Border.ComponentValues(voxel, border, values);
      }
    }
    values[Components - 1] = density;
    const Vf t = curve.TimeAt(s);
    Vec3 color;
    Vf opacity;
    this->ClassifyDependent(curve, q, s, t, values, ofTable, gradient, normal, color, opacity);
    this->Add(curve, s, t, color, opacity, visible);
  }

  /// TakeSamples() with windows of one kind.
  template <int Components, bool AtFaces, WindowFit Fit>
  HWY_NOINLINE int TakeSamples(
    const PacketCurve& curve, const SampleNumbers& numbers, int from, int to)
  {
    const Df d;
    const bool independent = this->Scene.KindOfComponents == ComponentKind::Independent;
    for (int n = from; n < to; ++n)
    {
      const Vf s = numbers.FindPlaces(curve, n);
      const Vec3 q = curve.At(this->Scene, s);
      const Mf sampled = this->Samples.template FindShown<AtFaces>(
        curve, q, s, numbers.FindActive(this->Samples.State.Alive, n));
      if (hn::AllFalse(d, sampled))
      {
        continue;
      }
      this->Samples.Statistics.Samples += static_cast<std::int64_t>(hn::CountTrue(d, sampled));
      SampleCells cells;
      const Vec3 voxel = FindSampledVoxels(this->Scene, q);
      const SamplePosition at = FindCells(this->Scene.Volume, voxel, !AtFaces, cells);
      this->Samples.Window.template MoveTo<AtFaces>(n);
      if (Components == 2 && independent)
      {
        this->template TakePair<AtFaces, Fit>(curve, q, s, cells, at, voxel, sampled);
      }
      else
      {
        this->template TakeDependent<Components, AtFaces, Fit>(
          curve, q, s, cells, at, voxel, sampled);
      }
      if (HWY_UNLIKELY(hn::AllFalse(d, this->Samples.State.Alive)))
      {
        return n;
      }
    }
    return to;
  }

  /// Composites colors of several components, and opacities over PacketScene::OpacityLength, over
  /// the intervals of the samples at s.
  HWY_INLINE void Add(
    const PacketCurve& curve, Vf s, Vf t, const Vec3& color, Vf opacity, Mf visible)
  {
    const Df d;
    visible = hn::And(visible, hn::Gt(opacity, hn::Zero(d)));
    if (hn::AllFalse(d, visible))
    {
      return;
    }
    this->Samples.Statistics.VisibleSamples += static_cast<std::int64_t>(hn::CountTrue(d, visible));
    this->Samples.State.Expecting = visible;
    this->Samples.AddOpacity(color, opacity, visible, curve, s, t);
  }

  /// Mixes independent components: the opacity is sum(a^2) / sum(a), the premultiplied color
  /// sum(a c).
  HWY_NOINLINE void Mix(const PacketCurve& curve, const Vec3& q, Vf s, Vf t, const Vf* values,
    const Vf* opacities, const Vec3* gradients, const Vec3* normals, Vec3& color, Vf& mixed)
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
      const Mf visible = hn::Gt(opacities[c], zero);
      if (hn::AllFalse(d, visible))
      {
        continue;
      }
      Vf opacity;
      Vec3 own;
      if (HWY_UNLIKELY(component.Plane.Intervals != nullptr))
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
        opacity = opacities[c];
        own = OpticsLookup(this->Scene, values[c], c).Color();
      }
      opacity = hn::Mul(Splat(component.Weight), opacity);
      if (component.Gradients.Factors)
      {
        opacity = hn::Mul(opacity, FactorOf(component.Gradients, gradients[c]));
      }
      opacity = hn::IfThenElseZero(visible, opacity);
      if (this->Scene.Shade)
      {
        own = this->Samples.Normals.Light(component.Surface, curve, q, own, normals[c], s, t);
      }
      colors = MulAdd(opacity, own, colors);
      sum = hn::Add(sum, opacity);
      squares = hn::MulAdd(opacity, opacity, squares);
    }
    const Vf one = Splat(1.0f);
    const Mf some = hn::Gt(squares, zero);
    const Vf opacity = hn::Div(squares, hn::IfThenElse(some, sum, one));
    color = Scale(hn::Div(one, hn::IfThenElse(some, opacity, one)), colors);
    mixed = hn::IfThenElseZero(some, opacity);
  }

  /// The gradient of the density of dependent components, where it is needed.
  HWY_INLINE Vec3 FindDensityGradient(const Vec3* gradients) const
  {
    const Vf zero = hn::Zero(Df());
    if (!this->Scene.Shade && !this->Scene.OpacityByGradient)
    {
      return { zero, zero, zero };
    }
    return this->Samples.MixGradients(
      gradients, [&](const Vf* of) { return DensityOf(this->Scene, 0, of); });
  }

  /// Classifies and lights dependent components. `ofTable`: the opacity of the density,
  /// FindFirstOpacity(), `gradient`: its gradient, `normal`: that which gives normals.
  HWY_INLINE void ClassifyDependent(const PacketCurve& curve, const Vec3& q, Vf s, Vf t,
    const Vf* values, Vf ofTable, const Vec3& gradient, const Vec3& normal, Vec3& color,
    Vf& opacity)
  {
    const PacketComponent& component = this->Scene.Components[0];
    if (HWY_UNLIKELY(!component.ByTable))
    {
      Vf copies[LargestNumberOfComponents];
      std::copy_n(values, this->Scene.Volume.Components, copies);
      const Classified classified = this->ClassifyFurther(Copy(q), copies, Copy(gradient));
      color = Copy(classified.Color);
      opacity = classified.Opacity;
    }
    else
    {
      opacity = ofTable;
      if (component.Gradients.Factors)
      {
        opacity = hn::Mul(opacity, FactorOf(component.Gradients, gradient));
      }
      color = DependentColor(this->Scene, values);
    }
    if (this->Scene.Shade)
    {
      color = this->Samples.Normals.Light(component.Surface, curve, q, color, normal, s, t);
    }
  }

  /// Does what ClassifyDependent() does by a two-dimensional transfer function or with labels.
  HWY_NOINLINE Classified ClassifyFurther(const Vec3& q, const Vf* values, const Vec3& gradient)
  {
    const PacketScene& scene = this->Scene;
    const PacketComponent& component = scene.Components[0];
    const Vf density = DensityOf(scene, 0, values);
    const bool labeled = !scene.Mask.Tables.empty();
    Vf opacity;
    Vec3 color = DependentColor(scene, values);
    if (component.Plane.Intervals)
    {
      const PacketPlane& plane = component.Plane;
      const Vf second = plane.SecondAxis.Scalars ? FindSecondAxis(plane, FindVoxels(this->Scene, q))
                                                 : FindMagnitude(plane.MagnitudeScale, gradient);
      const PlaneTexel texel = LookUpPlane(plane, density, second);
      if (scene.ColorPlane.Intervals)
      {
        color = LookUpPlane(scene.ColorPlane, values[0], second).Color;
      }
      opacity = OpacityOf(scene, plane, texel);
      if (!labeled)
      {
        return { color, opacity };
      }
    }
    else
    {
      opacity = OpticsLookup(scene, density).Opacity();
      if (component.Gradients.Factors)
      {
        opacity = hn::Mul(opacity, FactorOf(component.Gradients, gradient));
      }
    }
    const Vi tables = FindLabelTables(scene.Mask, FindMaskPosition(scene, q));
    MixInLabels(scene, OpticsLookup(scene, density, tables), tables, gradient, opacity, color);
    return { color, opacity };
  }

  PacketGradients<T>& Samples;
  const PacketScene& Scene;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
