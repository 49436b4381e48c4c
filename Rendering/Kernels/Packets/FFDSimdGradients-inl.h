// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The gradients of the samples of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_GRADIENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_GRADIENTS_INL_H_
#undef FFD_SIMD_GRADIENTS_INL_H_
#else
#define FFD_SIMD_GRADIENTS_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"

#include "FFDSimdBorder-inl.h"
#include "FFDSimdCells-inl.h"
#include "FFDSimdComponents-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdGrid-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdNormals-inl.h"
#include "FFDSimdOpacityNormals-inl.h"
#include "FFDSimdOptics-inl.h"
#include "FFDSimdRays-inl.h"
#include "FFDSimdRows-inl.h"
#include "FFDSimdSampler-inl.h"
#include "FFDSimdSegmentTrees-inl.h"

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Finds the gradients of the samples of a packet: of the values, or of the opacity.
template <class T>
class PacketGradients : public PacketSampler<T>
{
public:
  /// Keeps references to all but the numbers; these are those of PacketNormals.
  PacketGradients(const PacketScene& scene, const SegmentTrees& trees, PacketScratch& scratch,
    const RayPacket& rays, int x, int y, Vf rows, Mf active)
    : PacketSampler<T>(scene, scratch, rays, active)
    , Normals(scene, trees, rays, x, y, rows)
  {
  }

  /// Gradients of samples at q, of which those of `border` lie at faces.
  template <class Source>
  HWY_INLINE Vec3 GradientOf(const Source& voxels, const SamplePosition& at,
    const SampleRows<T>& rows, const Vec3& q, Mf border)
  {
    Vec3 gradient = Gradient<T>(voxels, at, rows);
    if (HWY_UNLIKELY(!hn::AllFalse(Df(), border)))
    {
      gradient = Copy(this->Border.Gradient(Copy(q), border, Copy(gradient), voxels.IsRepeating()));
    }
    return gradient;
  }

  /// Gradients of samples at q, the position at s of a curve, in the lanes of `lanes`, or those of
  /// their opacities. `voxel`: FindSampledVoxels(). Those of `border` lie at faces. `number`: of
  /// several components, which of PacketScene::Components.
  template <class Source>
  HWY_INLINE Vec3 FindGradient(const Source& voxels, const SamplePosition& at,
    const SampleRows<T>& rows, const PacketCurve& curve, const Vec3& q, const Vec3& voxel, Vf s,
    Mf lanes, Mf border, bool ofOpacity = false, int number = 0)
  {
    const Vec3 gradient = HWY_UNLIKELY(ofOpacity || this->Scene.ClipsGradients)
      ? this->FindSpecialGradient(FindNeighborValues<T>(voxels, at, rows), voxels.IsRepeating(),
          curve, Copy(q), Copy(voxel), s, border, ofOpacity, number)
      : this->GradientOf(voxels, at, rows, voxel, border);
    return HWY_UNLIKELY(this->Scene.Grid.ChangesGradients())
      ? this->FindGridGradient(
          curve, Copy(q), Copy(voxel), s, lanes, Copy(gradient), ofOpacity, number)
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
    if (HWY_UNLIKELY(this->Scene.Grid.ChangesGradients()))
    {
      this->ChangeToGrid(wanted, curve, q, voxel, s, lanes, gradients, ofOpacity);
    }
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

  PacketNormals Normals;

private:
  /// Where gradients are found by voxel coordinates; `voxel`: FindSampledVoxels().
  HWY_INLINE Vec3 FindPlace(const Vec3& q, const Vec3& voxel) const
  {
    return this->Scene.Grid.Snaps ? FindVoxels(this->Scene, q) : voxel;
  }

  /// The gradient at q, the position at s of a curve, of one component, or of its opacity, from
  /// that by voxel coordinates without hidden cells; as FindDifferences().
  HWY_NOINLINE Vec3 FindGridGradient(const PacketCurve& curve, const Vec3& q, const Vec3& voxel,
    Vf s, Mf lanes, const Vec3& byVoxel, bool ofOpacity, int number)
  {
    const Vec3 place = this->FindPlace(q, voxel);
    Vec3 gradient =
      this->Scene.Grid.Uneven ? ToIndexGradient(this->Scene, place, byVoxel) : byVoxel;
    ShownEnds ends;
    if (this->Scene.Grid.Hidden && FindShownEnds(this->Scene, place, lanes, ends))
    {
      const int component = this->FindDensityComponent(number);
      NeighborValues of[LargestNumberOfComponents];
      this->FindValues(ends, 1u << component, of);
      const auto findEnds = [&]() -> const DifferenceEnds& { return ends; };
      this->FindCounted(curve, q, s, findEnds, ofOpacity, number, of[component]);
      ReplaceShown(this->Scene, ends, of[component], gradient);
    }
    return gradient;
  }

  /// Does what FindGridGradient() does, of the components `wanted` and the opacities.
  HWY_NOINLINE void ChangeToGrid(unsigned int wanted, const PacketCurve& curve, const Vec3& q,
    const Vec3& voxel, Vf s, Mf lanes, Vec3* gradients, Vec3* ofOpacity)
  {
    const Vec3 place = this->FindPlace(q, voxel);
    if (this->Scene.Grid.Uneven)
    {
      const auto change = [&](Vec3& gradient) FFD_INLINE_LAMBDA {
        gradient = ToIndexGradient(this->Scene, place, gradient);
      };
      this->ForGradients(
        wanted, [&](int c) { change(gradients[c]); }, [&](std::size_t i) { change(ofOpacity[i]); });
    }
    ShownEnds ends;
    if (this->Scene.Grid.Hidden && FindShownEnds(this->Scene, place, lanes, ends))
    {
      NeighborValues of[LargestNumberOfComponents];
      this->FindValues(ends, wanted, of);
      const auto findEnds = [&]() -> const DifferenceEnds& { return ends; };
      const auto set = [&](Vec3& gradient, const NeighborValues& neighbors) {
        ReplaceShown(this->Scene, ends, neighbors, gradient);
      };
      this->SetGradients(of, wanted, curve, q, s, findEnds, set, gradients, ofOpacity);
    }
  }

  /// Interpolates the components `wanted`, a bit each, at the ends of the differences of some
  /// lanes; zero where there are none along an axis.
  HWY_NOINLINE void FindValues(const ShownEnds& ends, unsigned int wanted, NeighborValues* of)
  {
    for (int a = 0; a < 3; ++a)
    {
      const bool some = !hn::AllFalse(Df(), ends.Lanes[a]);
      for (const bool isBehind : { true, false })
      {
        const Vf zero = hn::Zero(Df());
        Vf values[LargestNumberOfComponents] = { zero, zero, zero, zero };
        if (some)
        {
          this->FindValuesAt(
            isBehind ? ends.Behind[a] : ends.Before[a], ends.Lanes[a], wanted, values);
        }
        for (int c = 0; c < this->Scene.Volume.Components; ++c)
        {
          (isBehind ? of[c].Behind[a] : of[c].Before[a]) = values[c];
        }
      }
    }
  }

  /// Interpolates the components `wanted`, a bit each, at voxel coordinates.
  HWY_NOINLINE void FindValuesAt(const Vec3& voxel, Mf lanes, unsigned int wanted, Vf* values)
  {
    const PacketVolume& v = this->Scene.Volume;
    if (v.Components > 1)
    {
      FetchedComponents<T>(v, voxel, lanes, this->Border).FindValues(values, wanted);
      return;
    }
    FetchedSample<T> fetched;
    FetchSample(v, voxel, lanes, this->Border, fetched);
    values[0] = fetched.Value;
  }

  /// Which component of the volume is the density of one of PacketScene::Components.
  HWY_INLINE int FindDensityComponent(int number) const
  {
    return this->Scene.KindOfComponents == ComponentKind::Independent
      ? number
      : this->Scene.Volume.Components - 1;
  }

  /// The ends of differences at samples q, the position at s of a curve, that are clipped.
  HWY_NOINLINE ClippedNeighbors FindClipped(
    const PacketCurve& curve, const Vec3& q, Vf s, const DifferenceEnds& ends)
  {
    const Vf t = curve.TimeAt(s);
    Vec3 steps[3];
    this->Normals.FindSteps(curve, q, s, t, steps);
    return FindClippedNeighbors(
      this->Scene, q, MulAdd(t, this->Rays.Direction, this->Rays.Origin), steps, ends);
  }

  /// Makes the values around samples those whose differences count: the clipped ones are replaced,
  /// and then, for gradients of the opacity, all by their opacities. `findEnds()`: where they are.
  template <class Find>
  HWY_INLINE void FindCounted(const PacketCurve& curve, const Vec3& q, Vf s, const Find& findEnds,
    bool ofOpacity, int number, NeighborValues& of)
  {
    if (this->Scene.ClipsGradients)
    {
      this->FindClipped(curve, q, s, findEnds())
        .Replace(this->Scene.ClippedValues[this->FindDensityComponent(number)], of);
    }
    if (ofOpacity)
    {
      of = OpacitiesOf(of, [&](Vf values) {
        return OpacityOfValues(this->Scene, values, static_cast<std::size_t>(number));
      });
    }
  }

  /// Does what FindGradient() does beside clipping planes, or of the opacity; of plain images.
  /// `of`: the values around the samples, from rows that are `repeating` at faces.
  HWY_NOINLINE Vec3 FindSpecialGradient(NeighborValues of, bool repeating, const PacketCurve& curve,
    const Vec3& q, const Vec3& voxel, Vf s, Mf border, bool ofOpacity, int number)
  {
    if (HWY_UNLIKELY(!repeating && !hn::AllFalse(Df(), border)))
    {
      this->Border.Neighbors(border, of);
    }
    const auto findEnds = [&] { return FindEnds(this->Scene.Volume, voxel); };
    this->FindCounted(curve, q, s, findEnds, ofOpacity, number, of);
    return GradientOfNeighbors(this->Scene.Volume, voxel, border, of);
  }

  /// Does what FindGradients() does beside clipping planes, and of the opacities; of plain images.
  HWY_NOINLINE void FindSpecialGradients(FetchedComponents<T>& samples, unsigned int wanted,
    const PacketCurve& curve, const Vec3& q, const Vec3& voxel, Vf s, Vec3* gradients,
    Vec3* ofOpacity)
  {
    NeighborValues of[LargestNumberOfComponents];
    samples.FindNeighbors(wanted, of);
    const auto findEnds = [&] { return FindEnds(this->Scene.Volume, voxel); };
    const auto set = [&](Vec3& gradient, const NeighborValues& neighbors) {
      gradient = GradientOfNeighbors(this->Scene.Volume, voxel, samples.GetAtBorder(), neighbors);
    };
    this->SetGradients(of, wanted, curve, q, s, findEnds, set, gradients, ofOpacity);
  }

  /// Calls ofValues(c) for the components `wanted`, and ofOpacities(i) for those of
  /// PacketScene::Components that gradients of the opacity are needed of.
  template <class OfValues, class OfOpacities>
  HWY_INLINE void ForGradients(
    unsigned int wanted, const OfValues& ofValues, const OfOpacities& ofOpacities) const
  {
    for (int c = 0; c < LargestNumberOfComponents; ++c)
    {
      if (IsWanted(wanted, c))
      {
        ofValues(c);
      }
    }
    const bool independent = this->Scene.KindOfComponents == ComponentKind::Independent;
    for (std::size_t i = 0; i < this->Scene.Components.size() && this->Scene.NormalsOfOpacity; ++i)
    {
      if (!independent || IsWanted(wanted, static_cast<int>(i)))
      {
        ofOpacities(i);
      }
    }
  }

  /// Calls set(gradient, values) with the gradients of the components `wanted`, and those of the
  /// opacities, and with the values around the samples that count; `of`: the values as they are,
  /// `findEnds()`: where they are.
  template <class Find, class Set>
  HWY_INLINE void SetGradients(NeighborValues* of, unsigned int wanted, const PacketCurve& curve,
    const Vec3& q, Vf s, const Find& findEnds, const Set& set, Vec3* gradients, Vec3* ofOpacity)
  {
    if (this->Scene.ClipsGradients)
    {
      const ClippedNeighbors clipped = this->FindClipped(curve, q, s, findEnds());
      for (int c = 0; c < LargestNumberOfComponents; ++c)
      {
        if (IsWanted(wanted, c))
        {
          clipped.Replace(this->Scene.ClippedValues[c], of[c]);
        }
      }
    }
    this->ForGradients(
      wanted, [&](int c) { set(gradients[c], of[c]); },
      [&](std::size_t i) {
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
        set(ofOpacity[i], OpacitiesOf(densities, [&](Vf values) {
          return OpacityOfValues(this->Scene, values, i);
        }));
      });
  }
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
