// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketVolume_h
#define FFDPacketVolume_h

#include "FFDVolumeView.h"

#include <cstdint>

namespace ffd
{

/// Weights of whole numbers add up to this.
constexpr int FixedOne = 1 << 14;

/// How the packet kernels, which are the same with and without a sign, read whole numbers of one or
/// two bytes: two neighboring voxels become signed 16-bit numbers, which are multiplied by weights
/// and added.
struct PacketIntegers
{
  /// Of bytes: where, in four rows of four of them, those of the two voxels from the first, second
  /// and third one of each row on are. Those with a sign become the upper bytes of the numbers,
  /// which extends their sign; 0x80 stands for a byte of zero.
  alignas(16) std::uint32_t Pairs[3][4] = {};
  bool Signed = false;
  std::uint32_t Flip = 0; ///< of numbers of two bytes: XORed with two of them
  float Unit = 1.0f;      ///< the sum times this and plus the next one is the value
  float Zero = 0.0f;
};

/// `bytes`: of a number, 1 or 2.
inline PacketIntegers MakePacketIntegers(int bytes, bool hasSign)
{
  PacketIntegers integers;
  integers.Signed = hasSign;
  integers.Unit = 1.0f / FixedOne;
  if (bytes == 1)
  {
    integers.Unit /= hasSign ? 256.0f : 1.0f;
    const auto half = [hasSign](
                        unsigned int from) { return hasSign ? 0x80u | from << 8 : from | 0x8000u; };
    for (unsigned int first = 0; first < 3; ++first)
    {
      for (unsigned int row = 0; row < 4; ++row)
      {
        const unsigned int from = 4 * row + first;
        integers.Pairs[first][row] = half(from) | half(from + 1) << 16;
      }
    }
  }
  else if (!hasSign)
  {
    integers.Flip = 0x80008000u;
    integers.Zero = 32768.0f;
  }
  return integers;
}

/// How the packet kernels read whole numbers of 32 bits, with or without a sign, none of which is
/// 2^31 or more away from Origin: (scalar - Origin) * Unit + Zero, the difference by whole numbers.
struct PacketWords
{
  std::int32_t Origin = 0; ///< the bits of it
  float Unit = 1.0f;
  float Zero = 0.0f;
};

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
  /// Slices that offsets from one of them may lead over; 0: over all. -1: the volume is thin, no
  /// cell has neighbors on all sides.
  int SlicesInReach = 0;
  bool Nearest = false;
  /// Positions may be those of voxels, of which these count alone: the nearest ones, or, where
  /// voxels are cells, those beside hidden cells and the outermost ones.
  bool AtVoxels = false;
  PacketIntegers Integers; ///< of types of one or two bytes
  /// Types wider than 24 bits are fetched as (scalar - Shift) * Scale, so that single precision
  /// suffices from there on; for the others Shift and Scale are not applied. By the component, and
  /// then again; with one component all are equal.
  alignas(64) double Shift[8] = {};
  alignas(64) double Scale[8] = { 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0 };
  bool MayOverflow = true; ///< single precision may not hold what Shift and Scale make of numbers
  bool HasWords = false;   ///< types of 32-bit integers are read by Words, as floats are loaded
  PacketWords Words[4];    ///< to the same numbers as by Shift and Scale; by the component
};

/// Whether scalars are integers of one or two bytes, which are interpolated by PacketIntegers.
inline bool HasShortScalars(const PacketVolume& v) { return v.ElementSize <= 2; }

/// What the packet kernels read scalars as.
enum class FetchedScalars
{
  Bytes,  ///< integers of 8 bits
  Shorts, ///< integers of 16 bits
  Words,  ///< integers of 32 bits, by PacketWords
  Floats,
  Doubles ///< all others
};

FetchedScalars FindFetchedScalars(const PacketVolume& v);

/// The largest number of bytes that a 32-bit offset leads over.
constexpr double LargestReach = 2147483647.0;

/// Bytes of a scalar.
int SizeOf(ScalarType type);

/// Whether no cell has neighbors on all sides.
bool IsThin(const VolumeView& v);

/// Whether the vector code can fetch these voxels.
bool CanFetchPackets(const VolumeView& v);

/// The voxels of an image with one component.
PacketVolume MakePacketVolume(const VolumeView& v, bool nearest);

} // namespace ffd

#endif
