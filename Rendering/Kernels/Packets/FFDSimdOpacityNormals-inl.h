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
#include "FFDSimdLookup-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPlane-inl.h"
#include "FFDSimdRows-inl.h"

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// The opacity over the unit distance of values of one component, or of densities of one of
/// several, as SampleClassifier::ClassifyValue().
HWY_NOINLINE inline Vf OpacityOfValues(
  const PacketScene& scene, Vf values, std::size_t component = 0)
{
  const bool several = scene.Volume.Components > 1;
  const PacketPlane& plane = several ? scene.Components[component].Plane : scene.Plane;
  return plane.Intervals ? FindOpacityOfLastRow(plane, values)
                         : FindOpacity(scene, values, component);
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

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
