// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketOptics_h
#define FFDPacketOptics_h

#include "FFDCastScene.h"
#include "FFDPacketScene.h"
#include "Optics/FFDIntervalTable.h"
#include "Optics/FFDOpticalFunctions.h"
#include "Optics/FFDSampleClassifier.h"

// The parts of MakePacketScene() that set how samples look.

namespace ffd
{

/// Functions that span more, in scalar units, reach to a value that stands for no data: the others
/// are small beside it.
constexpr double WidestFunctions = 1e20;

/// The abilities of the vector code that a frame needs.
struct FrameKind
{
  bool Composites = false; ///< vector code composites
  bool Components = false; ///< vector code composites or blends several components
  bool Masked = false;     ///< a mask or a label map is looked up
  bool Plane = false;      ///< one component has a two-dimensional transfer function
  bool Leaps = false;      ///< values that are not visible are left out
};

/// Sets the transfer functions, masks and gradient opacities, and the range of visible values. The
/// volume is set already.
void SetOptics(const CastScene& scene, const SampleClassifier& classifier, const FrameKind& kind,
  PacketScene& p);

/// Sets what intervals are classified by. The volume is set already.
void SetIntegrals(const CastScene& scene, const IntervalTable& table, PacketScene& p);

/// Sets what the blend modes compare values with. The optics are set already.
void SetBlending(
  const CastScene& scene, const OpticalFunctions& functions, const FrameKind& kind, PacketScene& p);

/// Sets what gradients count beside clipping planes. The optics are set already.
void SetClippedValues(const CastScene& scene, const SampleClassifier& classifier, PacketScene& p);

/// Sets lights and materials. The coordinates are set already.
void SetShading(const CastScene& scene, const CastSettings& settings,
  const SampleClassifier& classifier, PacketScene& p);

} // namespace ffd

#endif
