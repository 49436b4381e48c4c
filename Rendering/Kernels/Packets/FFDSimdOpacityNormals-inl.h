// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Gradients of the opacity at the samples of a packet. Included once per target of Highway.
#if defined(FFD_SIMD_OPACITY_NORMALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_OPACITY_NORMALS_INL_H_
#undef FFD_SIMD_OPACITY_NORMALS_INL_H_
#else
#define FFD_SIMD_OPACITY_NORMALS_INL_H_
#endif

#include "FFDPacketScene.h"

#include "FFDSimdBorder-inl.h"
#include "FFDSimdCells-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPlane-inl.h"
#include "FFDSimdRows-inl.h"
#include "FFDSimdTable-inl.h"

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// The opacity over the unit distance of what has an extinction times that distance.
HWY_INLINE Vf OpacityOfDepth(Vf depth)
{
  // The opacity is a difference from one, of which little is left where it is small; gradients are
  // differences of that.
  const Vf one = Splat(1.0f);
  const Vf y = hn::Mul(depth, Splat(0.69314718f));
  const Vf series = hn::Mul(y,
    hn::NegMulAdd(y,
      hn::NegMulAdd(y, hn::NegMulAdd(y, Splat(1.0f / 24.0f), Splat(1.0f / 6.0f)), Splat(0.5f)),
      one));
  return hn::IfThenElse(hn::Lt(depth, Splat(0.0625f)), series, hn::Sub(one, Exp2(hn::Neg(depth))));
}

/// The opacity over the unit distance of values of one component, or of densities of one of
/// several, as SampleClassifier::ClassifyValue().
HWY_NOINLINE inline Vf OpacityOfValues(
  const PacketScene& scene, Vf values, std::size_t component = 0)
{
  const bool several = scene.Volume.Components > 1;
  const PacketPlane& plane = several ? scene.Components[component].Plane : scene.Plane;
  if (plane.Texels)
  {
    return FindOpacityOfLastRow(plane, values);
  }
  const float unit = several ? scene.Components[component].UnitDistance : scene.UnitDistance;
  return OpacityOfDepth(hn::Mul(FindExtinction(scene, values, component), Splat(unit)));
}

/// Returns opacity(values) of values around samples.
template <class Opacity>
HWY_INLINE NeighborValues OpacitiesOf(const NeighborValues& of, const Opacity& opacity)
{
  NeighborValues result;
  for (int a = 0; a < 3; ++a)
  {
    result.Behind[a] = opacity(of.Behind[a]);
    result.Before[a] = opacity(of.Before[a]);
  }
  return result;
}

/// The values around the samples q of one component. `atBorder`: lanes at faces, of which `border`
/// knows; its last samples are forgotten.
template <class T, class Source>
HWY_INLINE NeighborValues FindNeighbors(const Source& source, const SamplePosition& at,
  const SampleRows<T>& rows, BorderSamples<T>& border, const Vec3& q, Mf atBorder)
{
  NeighborValues of = FindNeighborValues<T>(source, at, rows);
  if (HWY_UNLIKELY(!hn::AllFalse(Df(), atBorder)))
  {
    border.Neighbors(q, atBorder, source.IsRepeating(), of);
  }
  return of;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
