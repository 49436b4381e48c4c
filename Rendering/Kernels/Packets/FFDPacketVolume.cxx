// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPacketVolume.h"

#include "FFDScalarDispatch.h"

#include <algorithm>

namespace ffd
{
namespace
{

/// Voxels of the largest slice, in elements: a 32-bit offset leads over it and to two others.
constexpr double LargestSlice = LargestReach / 3.0;

} // namespace

//------------------------------------------------------------------------------
int SizeOf(ScalarType type)
{
  return DispatchScalarType(type, [](auto zero) { return static_cast<int>(sizeof(zero)); });
}

//------------------------------------------------------------------------------
bool IsThin(const VolumeView& v)
{
  return std::min({ v.Dimensions.x, v.Dimensions.y, v.Dimensions.z }) < 4;
}

//------------------------------------------------------------------------------
FetchedScalars FindFetchedScalars(const PacketVolume& v)
{
  if (HasShortScalars(v))
  {
    return v.ElementSize == 1 ? FetchedScalars::Bytes : FetchedScalars::Shorts;
  }
  if (v.Type == ScalarType::Float32)
  {
    return FetchedScalars::Floats;
  }
  return v.HasWords ? FetchedScalars::Words : FetchedScalars::Doubles;
}

//------------------------------------------------------------------------------
bool CanFetchPackets(const VolumeView& v)
{
  const double slice = static_cast<double>(v.Increments[2]);
  return v.Increments[0] == v.Components &&
    (IsThin(v) ? slice * v.Dimensions.z <= LargestReach : slice <= LargestSlice);
}

//------------------------------------------------------------------------------
PacketVolume MakePacketVolume(const VolumeView& v, bool nearest)
{
  PacketVolume packet;
  packet.Scalars = v.Scalars;
  packet.Type = v.Type;
  for (int a = 0; a < 3; ++a)
  {
    packet.Dimensions[a] = v.Dimensions[a];
  }
  packet.IncrementY = static_cast<int>(v.Increments[1]);
  packet.IncrementZ = static_cast<int>(v.Increments[2]);
  packet.ElementSize = SizeOf(v.Type);
  packet.Nearest = nearest;
  packet.AtVoxels = nearest || v.Margin > 0.0;
  if (HasShortScalars(packet))
  {
    packet.Integers = MakePacketIntegers(
      packet.ElementSize, v.Type == ScalarType::Int8 || v.Type == ScalarType::Int16);
  }
  return packet;
}

} // namespace ffd
