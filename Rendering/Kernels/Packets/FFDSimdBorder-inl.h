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

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/**
 * Interpolates samples near the faces of the volume, where not all voxels that a sample and its
 * gradient need exist, from a copy in which the outermost voxels are repeated.
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

  /// The values at q in the lanes of `border`, at least one, `value` in the others.
  HWY_NOINLINE Vf Value(const Vec3& q, Mf border, Vf value)
  {
    this->Voxels.Fill(this->Scene.Volume, q, border);
    SampleRows<T> rows;
    return hn::IfThenElse(
      border, Sample<T>(this->FindRows(), this->Voxels.GetPosition(), rows), value);
  }

  /// The gradients at q in the lanes of `border`, `gradient` in the others; after Value(), or of a
  /// source that is `repeating` voxels.
  HWY_NOINLINE Vec3 Gradient(const Vec3& q, Mf border, const Vec3& gradient, bool repeating) const
  {
    Vec3 own = gradient;
    if (!repeating)
    {
      const OffsetRows<T> source = this->FindRows();
      const SamplePosition& at = this->Voxels.GetPosition();
      SampleRows<T> rows;
      Sample<T>(source, at, rows);
      own = HWY_NAMESPACE::Gradient<T>(source, at, rows);
    }
    return Select(border, AtFaces(this->Scene.Volume, q, own), gradient);
  }

  /// Replaces the values around the last samples of Value() in the lanes of `border`.
  HWY_NOINLINE void Neighbors(Mf border, NeighborValues& neighbors) const
  {
    const OffsetRows<T> source = this->FindRows();
    SampleRows<T> rows;
    Sample<T>(source, this->Voxels.GetPosition(), rows);
    const NeighborValues own = FindNeighborValues<T>(source, this->Voxels.GetPosition(), rows);
    ReplaceNeighbors(border, own, neighbors);
  }

  /// Replaces the values of all components at q in the lanes of `border`, at least one.
  HWY_NOINLINE void ComponentValues(const Vec3& q, Mf border, Vf* values)
  {
    this->Voxels.Fill(this->Scene.Volume, q, border);
    Vf own[LargestNumberOfComponents];
    ComponentSamples<T>(this->Voxels).FindValues(own);
    for (int c = 0; c < this->Scene.Volume.Components; ++c)
    {
      values[c] = hn::IfThenElse(border, own[c], values[c]);
    }
  }

  /// Replaces the gradients of the components `wanted`, a bit each, in the lanes of `border`; after
  /// ComponentValues() of q.
  HWY_NOINLINE void ComponentGradients(
    const Vec3& q, Mf border, unsigned int wanted, Vec3* gradients) const
  {
    ComponentSamples<T> samples(this->Voxels);
    Vf values[LargestNumberOfComponents];
    samples.FindValues(values);
    Vec3 own[LargestNumberOfComponents];
    samples.FindGradients(wanted, own);
    for (int c = 0; c < this->Scene.Volume.Components; ++c)
    {
      gradients[c] = IsWanted(wanted, c)
        ? Select(border, AtFaces(this->Scene.Volume, q, own[c]), gradients[c])
        : gradients[c];
    }
  }

  /// Replaces the values around the last samples of the components `wanted`, a bit each, in the
  /// lanes of `border`; after ComponentValues().
  HWY_NOINLINE void ComponentNeighbors(
    Mf border, unsigned int wanted, NeighborValues* neighbors) const
  {
    ComponentSamples<T> samples(this->Voxels);
    Vf values[LargestNumberOfComponents];
    samples.FindValues(values);
    NeighborValues own[LargestNumberOfComponents];
    samples.FindNeighbors(wanted, own);
    ForComponents([&](auto c) {
      if (IsWanted(wanted, c))
      {
        ReplaceNeighbors(border, own[c], neighbors[c]);
      }
    });
  }

private:
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
  if (HWY_UNLIKELY(atFaces && !repeats))
  {
    to.Value = border.Value(q, to.AtBorder, to.Value);
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
      this->Border.ComponentNeighbors(this->AtBorder, wanted, neighbors);
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
