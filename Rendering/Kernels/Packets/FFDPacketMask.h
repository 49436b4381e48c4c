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
  std::ptrdiff_t RowIncrement = 0; ///< elements from one row of all slices to the next
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

  /// Number of the table of a label, 0 without one.
  template <class T>
  int TableOf(T label) const
  {
    if constexpr (std::is_integral<T>::value)
    {
      const bool known = label > 0 && static_cast<std::uint64_t>(label) < this->Tables.size();
      return known ? this->Tables[static_cast<std::size_t>(label)] : 0;
    }
    else
    {
      const double size = static_cast<double>(this->Tables.size());
      const bool known = label >= 0.5 && static_cast<double>(label) < size - 0.5;
      return known ? this->Tables[static_cast<std::size_t>(label + 0.5)] : 0;
    }
  }
};

} // namespace ffd

#endif
