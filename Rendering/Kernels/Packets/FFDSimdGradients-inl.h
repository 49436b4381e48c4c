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
    const Vec3 gradient = Gradient<T>(voxels, at, rows);
    return HWY_LIKELY(hn::AllFalse(Df(), border))
      ? gradient
      : this->Border.Gradient(q, border, gradient, voxels.IsRepeating());
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
      ? this->FindSpecialGradient(voxels, at, rows, curve, q, voxel, s, border, ofOpacity, number)
      : this->GradientOf(voxels, at, rows, voxel, border);
    return HWY_UNLIKELY(this->Scene.Grid.ChangesGradients())
      ? this->FindGridGradient(
          q, voxel, lanes, gradient, this->FindDensityComponent(number), ofOpacity)
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

  /// Which component of the volume is the density of one of PacketScene::Components.
  HWY_INLINE int FindDensityComponent(int number) const
  {
    return this->Scene.KindOfComponents == ComponentKind::Independent
      ? number
      : this->Scene.Volume.Components - 1;
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
    Mf border, bool ofOpacity, int number)
  {
    NeighborValues of = FindNeighbors<T>(voxels, at, rows, this->Border, voxel, border);
    if (this->Scene.ClipsGradients)
    {
      this->FindClipped(curve, q, s)
        .Replace(this->Scene.ClippedValues[this->FindDensityComponent(number)], of);
    }
    if (ofOpacity)
    {
      of = OpacitiesOf(of, [&](Vf values) {
        return OpacityOfValues(this->Scene, values, static_cast<std::size_t>(number));
      });
    }
    return GradientOfNeighbors(this->Scene.Volume, voxel, border, of);
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
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
