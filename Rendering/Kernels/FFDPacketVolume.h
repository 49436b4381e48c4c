// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketVolume_h
#define FFDPacketVolume_h

#include "FFDVolumeView.h"

namespace ffd
{

/**
 * The voxels in the form that the packet kernels read. Offsets of the lanes of a packet are 32-bit
 * numbers: in volumes of 2 GiB and more they count from a slice near the packet.
 */
struct PacketVolume
{
  const void* Scalars = nullptr;
  ScalarType Type = ScalarType::UInt8;
  int Dimensions[3] = {};
  int Components = 1; ///< side by side in memory
  int IncrementY = 0; ///< elements
  int IncrementZ = 0;
  int ElementSize = 1; ///< bytes
  /// Slices that offsets from one of them may lead over; 0: over all.
  int SlicesInReach = 0;
  bool Nearest = false;
  /// Types wider than 24 bits are fetched as (scalar - Shift) * Scale, so that single precision
  /// suffices from there on; for the others Shift and Scale are not applied.
  double Shift = 0.0;
  double Scale = 1.0;
};

} // namespace ffd

#endif
