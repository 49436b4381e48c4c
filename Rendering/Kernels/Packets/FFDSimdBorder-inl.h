// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Samples near the faces of the volume. Included once per target of Highway.
#if defined(FFD_SIMD_BORDER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_BORDER_INL_H_
#undef FFD_SIMD_BORDER_INL_H_
#else
#define FFD_SIMD_BORDER_INL_H_
#endif

#include "FFDPacketScene.h"
#include "FFDPacketScratch.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdComponents-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdRepeatedVoxels-inl.h"
#include "FFDSimdRows-inl.h"

#include <glm/vec3.hpp>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/**
 * Interpolates samples near the faces of the volume, where not all voxels that a sample and its
 * gradient need exist. Positions between voxels are interpolated in vector code, from a copy in
 * which the outermost voxels are repeated; positions beyond the outermost voxels one by one, by the
 * reference functions.
 */
template <class T>
class BorderSamples
{
public:
  /// Keeps references to both.
  BorderSamples(const PacketScene& scene, PacketScratch& scratch)
    : Scene(scene)
    , Voxels(scratch.BorderVoxels.data())
  {
  }

  /// The values at q in the lanes of `border`, `value` in the others.
  HWY_NOINLINE Vf Value(const Vec3& q, Mf border, Vf value)
  {
    const Df d;
    const Mf between = this->BetweenVoxels(q, border);
    if (!hn::AllFalse(d, between))
    {
      this->Voxels.Fill(this->Scene.Volume, q, between);
      SampleRows<T> rows;
      value = hn::IfThenElse(
        between, Sample<T>(this->FindRows(), this->Voxels.GetPosition(), rows), value);
    }
    const Mf others = hn::AndNot(between, border);
    return hn::AllFalse(d, others)
      ? value
      : this->ValueByReference(this->Scene.Source->Volume, 0, q, others, value);
  }

  /// Returns `value` but in the lanes of `border` whose positions are beyond the outermost voxels.
  HWY_INLINE Vf ValueBeyond(const Vec3& q, Mf border, Vf value) const
  {
    const Mf beyond = hn::AndNot(this->BetweenVoxels(q, border), border);
    return HWY_LIKELY(hn::AllFalse(Df(), beyond))
      ? value
      : this->ValueByReference(this->Scene.Source->Volume, 0, q, beyond, value);
  }

  /// The gradients at q in the lanes of `border`, `gradient` in the others; after Value(), or of a
  /// source that is `repeating` voxels.
  HWY_NOINLINE Vec3 Gradient(const Vec3& q, Mf border, const Vec3& gradient, bool repeating) const
  {
    const Mf between = this->BetweenVoxels(q, border);
    Vec3 result = gradient;
    if (repeating)
    {
      result = Select(between, AtFaces(this->Scene.Volume, q, gradient), gradient);
    }
    else if (!hn::AllFalse(Df(), between))
    {
      const OffsetRows<T> source = this->FindRows();
      const SamplePosition& at = this->Voxels.GetPosition();
      SampleRows<T> rows;
      Sample<T>(source, at, rows);
      const Vec3 own = HWY_NAMESPACE::Gradient<T>(source, at, rows);
      result = Select(between, AtFaces(this->Scene.Volume, q, own), gradient);
    }
    const Mf others = hn::AndNot(between, border);
    return hn::AllFalse(Df(), others)
      ? result
      : this->GradientByReference(this->Scene.Source->Volume, 0, q, others, result);
  }

  /// Replaces the values around q in the lanes of `border`; after Value(), or of a source that is
  /// `repeating` voxels. The last samples are forgotten.
  HWY_NOINLINE void Neighbors(const Vec3& q, Mf border, bool repeating, NeighborValues& neighbors)
  {
    const Mf between = this->BetweenVoxels(q, border);
    if (!repeating && !hn::AllFalse(Df(), between))
    {
      const OffsetRows<T> source = this->FindRows();
      SampleRows<T> rows;
      Sample<T>(source, this->Voxels.GetPosition(), rows);
      const NeighborValues own = FindNeighborValues<T>(source, this->Voxels.GetPosition(), rows);
      ReplaceNeighbors(between, own, neighbors);
    }
    const Mf others = hn::AndNot(between, border);
    if (!hn::AllFalse(Df(), others))
    {
      this->ForNeighbors(q, [&](const Vec3& at, int a, bool behind) {
        Vf& value = behind ? neighbors.Behind[a] : neighbors.Before[a];
        value = hn::IfThenElse(others, this->Value(at, others, value), value);
      });
    }
  }

  /// Replaces the values of all components of a volume in the lanes of `border`.
  HWY_NOINLINE void ComponentValues(const Vec3& q, Mf border, Vf* values)
  {
    const VolumeView& volume = this->Scene.Source->Volume;
    const Mf between = this->BetweenVoxels(q, border);
    if (!hn::AllFalse(Df(), between))
    {
      this->Voxels.Fill(this->Scene.Volume, q, between);
      Vf own[LargestNumberOfComponents];
      ComponentSamples<T>(this->Voxels).FindValues(own);
      for (int c = 0; c < volume.Components; ++c)
      {
        values[c] = hn::IfThenElse(between, own[c], values[c]);
      }
    }
    const Mf others = hn::AndNot(between, border);
    for (int c = 0; c < volume.Components && !hn::AllFalse(Df(), others); ++c)
    {
      values[c] = this->ValueByReference(GetComponent(volume, c), c, q, others, values[c]);
    }
  }

  /// Replaces the gradients of the components `wanted`, a bit each, in the lanes of `border`; after
  /// ComponentValues().
  HWY_NOINLINE void ComponentGradients(
    const Vec3& q, Mf border, unsigned int wanted, Vec3* gradients) const
  {
    const VolumeView& volume = this->Scene.Source->Volume;
    const Mf between = this->BetweenVoxels(q, border);
    if (!hn::AllFalse(Df(), between))
    {
      ComponentSamples<T> samples(this->Voxels);
      Vf values[LargestNumberOfComponents];
      samples.FindValues(values);
      Vec3 own[LargestNumberOfComponents];
      samples.FindGradients(wanted, own);
      for (int c = 0; c < volume.Components; ++c)
      {
        gradients[c] = IsWanted(wanted, c)
          ? Select(between, AtFaces(this->Scene.Volume, q, own[c]), gradients[c])
          : gradients[c];
      }
    }
    const Mf others = hn::AndNot(between, border);
    for (int c = 0; c < volume.Components && !hn::AllFalse(Df(), others); ++c)
    {
      gradients[c] = IsWanted(wanted, c)
        ? this->GradientByReference(GetComponent(volume, c), c, q, others, gradients[c])
        : gradients[c];
    }
  }

  /// Replaces the values around q of the components `wanted`, a bit each, in the lanes of `border`;
  /// after ComponentValues(). The last samples are forgotten.
  HWY_NOINLINE void ComponentNeighbors(
    const Vec3& q, Mf border, unsigned int wanted, NeighborValues* neighbors)
  {
    const Mf between = this->BetweenVoxels(q, border);
    if (!hn::AllFalse(Df(), between))
    {
      ComponentSamples<T> samples(this->Voxels);
      Vf values[LargestNumberOfComponents];
      samples.FindValues(values);
      NeighborValues own[LargestNumberOfComponents];
      samples.FindNeighbors(wanted, own);
      ForComponents([&](auto c) {
        if (IsWanted(wanted, c))
        {
          ReplaceNeighbors(between, own[c], neighbors[c]);
        }
      });
    }
    const Mf others = hn::AndNot(between, border);
    if (!hn::AllFalse(Df(), others))
    {
      this->ForNeighbors(q, [&](const Vec3& at, int a, bool behind) {
        const Vf zero = hn::Zero(Df());
        Vf values[LargestNumberOfComponents] = { zero, zero, zero, zero };
        this->ComponentValues(at, others, values);
        ForComponents([&](auto c) {
          if (IsWanted(wanted, c))
          {
            Vf& value = behind ? neighbors[c].Behind[a] : neighbors[c].Before[a];
            value = hn::IfThenElse(others, values[c], value);
          }
        });
      });
    }
  }

private:
  /// Calls take(position, axis, whether it is behind) with the positions that FindDifferences()
  /// takes differences between.
  template <class Take>
  HWY_INLINE void ForNeighbors(const Vec3& q, const Take& take) const
  {
    const DifferenceEnds ends = FindEnds(this->Scene.Volume, q);
    for (int a = 0; a < 3; ++a)
    {
      take(ends.Behind[a], a, true);
      take(ends.Before[a], a, false);
    }
  }

  static HWY_INLINE void ReplaceNeighbors(
    Mf lanes, const NeighborValues& by, NeighborValues& neighbors)
  {
    for (int a = 0; a < 3; ++a)
    {
      neighbors.Behind[a] = hn::IfThenElse(lanes, by.Behind[a], neighbors.Behind[a]);
      neighbors.Before[a] = hn::IfThenElse(lanes, by.Before[a], neighbors.Before[a]);
    }
  }

  HWY_INLINE OffsetRows<T> FindRows() const
  {
    OffsetRows<T> rows;
    rows.Set(this->Voxels.GetView(), this->Voxels.GetOffsets());
    return rows;
  }

  /// The lanes of `border` whose positions have voxels on both sides along each axis.
  HWY_INLINE Mf BetweenVoxels(const Vec3& q, Mf border) const
  {
    const PacketVolume& v = this->Scene.Volume;
    if (v.Nearest)
    {
      return hn::FirstN(Df(), 0);
    }
    const Vf zero = hn::Zero(Df());
    const auto within = [&](Vf x, int a) {
      return hn::And(hn::Ge(x, zero), hn::Le(x, Splat(static_cast<float>(v.Dimensions[a] - 1))));
    };
    return hn::And(border, hn::And(within(q.x, 0), hn::And(within(q.y, 1), within(q.z, 2))));
  }

  /// As fetched: relative to the table of a component, see PacketVolume.
  HWY_NOINLINE Vf ValueByReference(
    const VolumeView& volume, int component, const Vec3& q, Mf border, Vf value) const
  {
    const Vf zero = hn::Zero(Df());
    const PacketVolume& v = this->Scene.Volume;
    return ReplaceLanes(border, q, { value, zero, zero }, [&](const glm::dvec3& at) {
      const double scalar = this->Scene.Reference.Value(volume, at);
      return glm::dvec3((scalar - v.Shift[component]) * v.Scale[component], 0.0, 0.0);
    }).x;
  }

  HWY_NOINLINE Vec3 GradientByReference(
    VolumeView volume, int component, const Vec3& q, Mf border, const Vec3& gradient) const
  {
    // By voxel coordinates; over two voxels and scaled, as fetched: squares of huge or tiny scalars
    // are no floats.
    volume.Axes = nullptr;
    return ReplaceLanes(border, q, gradient, [&](const glm::dvec3& at) {
      return this->Scene.Reference.Gradient(volume, at) *
        (2.0 * this->Scene.Volume.Scale[component]);
    });
  }

  const PacketScene& Scene;
  RepeatedVoxels<T> Voxels; ///< around the last samples at faces of the volume
};

/// An interpolated value of each lane, and what Gradient() takes to differentiate it.
template <class T>
struct FetchedSample
{
  SamplePosition At;
  FaceRows<T> Voxels;
  SampleRows<T> Rows;
  Mf AtBorder; ///< lanes at faces: BorderSamples gives their gradients
  Vf Value;
};

/// Fetches the voxels around positions q in the volume and interpolates the values of `lanes`.
template <class T>
HWY_INLINE void FetchSample(
  const PacketVolume& v, const Vec3& q, Mf lanes, BorderSamples<T>& border, FetchedSample<T>& to)
{
  SampleCells cells;
  to.At = FindCells(v, q, false, cells);
  const Mf interior = FindInterior(v, cells, lanes);
  to.AtBorder = hn::AndNot(interior, lanes);
  const bool atFaces = !hn::AllFalse(Df(), to.AtBorder);
  const bool repeats = atFaces && FaceRows<T>::CanRepeat(v);
  if (repeats)
  {
    to.Voxels.Repeat(v, cells);
  }
  else
  {
    to.Voxels.Fit(v, cells, interior);
  }
  to.Value = Sample<T>(to.Voxels, to.At, to.Rows);
  if (HWY_UNLIKELY(atFaces))
  {
    to.Value = repeats ? border.ValueBeyond(q, to.AtBorder, to.Value)
                       : border.Value(q, to.AtBorder, to.Value);
  }
}

/// The components at positions q in the volume, as ComponentSamples, at its faces, too.
template <class T>
class FetchedComponents
{
public:
  /// Keeps references to `q` and `border`.
  HWY_INLINE FetchedComponents(
    const PacketVolume& v, const Vec3& q, Mf lanes, BorderSamples<T>& border)
    : Q(q)
    , Border(border)
    , At(FindCells(v, q, false, this->Cells))
    , Interior(FindInterior(v, this->Cells, lanes))
    , AtBorder(hn::AndNot(this->Interior, lanes))
    , Samples(v, this->Cells, this->At, this->Interior)
  {
  }

  /// Those of the components `wanted`, a bit each, at least.
  HWY_INLINE void FindValues(Vf* values, unsigned int wanted = AllComponents)
  {
    this->Samples.FindValues(values, wanted);
    if (HWY_UNLIKELY(!hn::AllFalse(Df(), this->AtBorder)))
    {
      this->Border.ComponentValues(this->Q, this->AtBorder, values);
    }
  }

  /// The values around the samples of the components `wanted`, a bit each; after FindValues().
  HWY_INLINE void FindNeighbors(unsigned int wanted, NeighborValues* neighbors)
  {
    this->Samples.FindNeighbors(wanted, neighbors);
    if (HWY_UNLIKELY(!hn::AllFalse(Df(), this->AtBorder)))
    {
      this->Border.ComponentNeighbors(this->Q, this->AtBorder, wanted, neighbors);
    }
  }

  HWY_INLINE Mf GetAtBorder() const { return this->AtBorder; }

  /// Those of the components `wanted`, a bit each; after FindValues().
  HWY_INLINE void FindGradients(unsigned int wanted, Vec3* gradients) const
  {
    this->Samples.FindGradients(wanted, gradients);
    if (HWY_UNLIKELY(!hn::AllFalse(Df(), this->AtBorder)))
    {
      this->Border.ComponentGradients(this->Q, this->AtBorder, wanted, gradients);
    }
  }

private:
  const Vec3& Q;
  BorderSamples<T>& Border;
  SampleCells Cells;
  SamplePosition At;
  Mf Interior;
  Mf AtBorder;
  ComponentSamples<T> Samples;
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
