// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketPlane_h
#define FFDPacketPlane_h

#include "FFDPacketVolume.h"

namespace ffd
{

/// A two-dimensional transfer function in the form that the packet kernels read: TransferPlane.
struct PacketPlane
{
  const float* Texels = nullptr; ///< red, green, blue, opacity, x fastest; null: there is none
  int Size[2] = {};
  float Low[2] = {};   ///< of the first texels, values as fetched
  float Scale[2] = {}; ///< texels a unit
  bool Nearest = false;
  float UnitDistance = 1.0f; ///< data units that the opacities are over

  /// Scalars of the second axis on the grid of the volume; null: it is the length of
  /// MagnitudeScale times the gradient as fetched.
  PacketVolume SecondAxis;
  float MagnitudeScale[3] = {};
};

} // namespace ffd

#endif
