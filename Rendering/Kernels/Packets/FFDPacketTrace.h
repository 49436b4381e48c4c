// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketTrace_h
#define FFDPacketTrace_h

#include "FFDCastRay.h"
#include "FFDCastScene.h"
#include "FFDPacketCaster.h"
#include "FFDTracedRay.h"
#include "Reference/FFDSegmentSampler.h"

namespace ffd
{

/// Records in `pixel` and `traced` how packets cast a ray: renders the subtile that holds its
/// pixel, and reads the segments and the sample positions that this leaves in `scratch`.
void TracePackets(const PacketCaster& packets, const CastScene& scene, const CastSettings& settings,
  const CastRay& ray, const CastImage& image, PacketScratch& scratch, RayPixel& pixel,
  TracedRay& traced);

} // namespace ffd

#endif
