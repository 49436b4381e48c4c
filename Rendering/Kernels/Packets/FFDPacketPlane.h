// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketPlane_h
#define FFDPacketPlane_h

#include "FFDPacketVolume.h"
#include "Optics/FFDTransferInterval.h"

#include <cstddef>

namespace ffd
{

/// A two-dimensional transfer function in the form that the packet kernels read: TransferPlane.
struct PacketPlane
{
  const TransferInterval* Intervals = nullptr; ///< of each texel and the next one along x, which
                                               ///< is fastest; null: there is no function
  int Size[2] = {};
  float Low[2] = {};   ///< of the first texels, values as fetched
  float Scale[2] = {}; ///< texels a unit
  bool Nearest = false;
  float UnitDistance = 1.0f; ///< data units that the opacities are over

  /// Scalars of the second axis on the grid of the volume; null: it is the length of
  /// MagnitudeScale times the gradient as fetched.
  PacketVolume SecondAxis;
  /// Elements from one scalar of the second axis to the next along x, y and z.
  std::ptrdiff_t AxisIncrements[3] = {};
  /// Whether these are not side by side, or a 32-bit offset does not lead over all: each lane is
  /// looked up by itself.
  bool AxisByLane = false;
  float MagnitudeScale[3] = {};
};

} // namespace ffd

#endif
