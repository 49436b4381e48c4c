// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketMask_h
#define FFDPacketMask_h

#include "FFDVolumeView.h"

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace ffd
{

/// A mask or a label map in the form that the packet kernels read.
struct PacketMask
{
  const void* Scalars = nullptr; ///< null: there is none
  ScalarType Type = ScalarType::UInt8;
  int Dimensions[3] = {};
  std::ptrdiff_t RowIncrement = 0;      ///< elements from one row of all slices to the next
  bool InReach = false;                 ///< whether 32-bit offsets lead to all of them
  const std::uint8_t* Blocks = nullptr; ///< LabelBlocks::GetLabels(), or null
  int BlocksPerRow = 0;
  int BlocksPerSlice = 0;
  /// Voxel for voxel the grid of the volume; else `FromIndex` and `Offset` take its index
  /// coordinates to those of the mask.
  bool SameGrid = true;
  float FromIndex[9] = {};
  float Offset[3] = {};

  bool Labels = false; ///< a label map, else a binary mask
  float BlendFactor =
    1.0f; ///< weight of a label's color and opacity; the rest is that of the scalars
  std::vector<int> Tables; ///< by label: its table in PacketScene::Table, 0 without one

  /// Factors of the opacity of a table, by the length of MagnitudeScale times the gradient as
  /// fetched; loaded as 128 bits.
  struct GradientRange
  {
    std::int32_t First; ///< in GradientFactors
    float Last;         ///< how many factors there are, less one
    float Scale;        ///< entries a unit of the length
    std::int32_t Unused;
  };
  static_assert(sizeof(GradientRange) == 16, "ranges are loaded as 128 bits");
  std::vector<GradientRange> GradientRanges; ///< by table; none: no factors
  std::vector<float> GradientFactors;
  float MagnitudeScale[3] = {};

  /// The label that a scalar stands for, or a number that has no table.
  template <class T>
  int LabelOf(T scalar) const
  {
    if constexpr (std::is_integral<T>::value && sizeof(T) <= sizeof(int))
    {
      return static_cast<int>(scalar);
    }
    else
    {
      const double label = static_cast<double>(scalar) + (std::is_integral<T>::value ? 0.0 : 0.5);
      return label >= 1.0 && label < static_cast<double>(this->Tables.size())
        ? static_cast<int>(label)
        : 0;
    }
  }

  /// Number of the table of a label, 0 without one.
  int TableOf(int label) const
  {
    const bool known = label > 0 && static_cast<std::size_t>(label) < this->Tables.size();
    return known ? this->Tables[static_cast<std::size_t>(label)] : 0;
  }
};

} // namespace ffd

#endif
