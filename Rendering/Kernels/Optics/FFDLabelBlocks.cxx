// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDLabelBlocks.h"

#include "FFDGridIndex.h"
#include "FFDScalarDispatch.h"

#include <glm/common.hpp>

#include <type_traits>

namespace ffd
{
namespace
{

static_assert(LabelBlocks::BlockSize == 1 << LabelBlocks::LogBlockSize, "see LogBlockSize");

/// Bytes that may be read beyond the last label, as words of 32 bits are loaded.
constexpr std::size_t Padding = 3;

/// The label that a scalar stands for; LabelBlocks::Mixed for large ones.
template <class T>
std::uint8_t FindLabel(T scalar, bool isLabelMap)
{
  if (!isLabelMap)
  {
    return scalar > 0 ? 1 : 0;
  }
  // Labels are the nearest whole numbers; there is none below 1, nor of what is not a number.
  using Wide =
    std::conditional_t<std::is_floating_point<T>::value, double, decltype(scalar + int{})>;
  const Wide label = static_cast<Wide>(scalar) + (std::is_integral<T>::value ? Wide(0) : Wide(0.5));
  return !(label >= 1)                   ? 0
    : label < Wide{ LabelBlocks::Mixed } ? static_cast<std::uint8_t>(label)
                                         : LabelBlocks::Mixed;
}

/// The label of all voxels of `mask` from `first` on, before `end`, or LabelBlocks::Mixed.
template <class T>
std::uint8_t FindCommonLabel(
  const VolumeView& mask, bool isLabelMap, const glm::ivec3& first, const glm::ivec3& end)
{
  const auto rowAt = [&](int y, int z) {
    return static_cast<const T*>(mask.Scalars) + y * mask.Increments[1] + z * mask.Increments[2];
  };
  const std::uint8_t label = FindLabel(rowAt(first.y, first.z)[first.x], isLabelMap);
  for (int z = first.z; z < end.z; ++z)
  {
    for (int y = first.y; y < end.y; ++y)
    {
      const T* const row = rowAt(y, z);
      bool differs = false;
      for (int x = first.x; x < end.x; ++x)
      {
        differs |= FindLabel(row[x], isLabelMap) != label;
      }
      if (differs)
      {
        return LabelBlocks::Mixed;
      }
    }
  }
  return label;
}

} // namespace

//------------------------------------------------------------------------------
LabelBlocks::LabelBlocks(const VolumeView& mask, bool isLabelMap, const ParallelFor& parallelFor)
  : Size((mask.Dimensions + (BlockSize - 1)) / BlockSize)
  , Labels(GridSize(this->Size) + Padding)
{
  DispatchScalarType(mask.Type, [&](auto zero) {
    parallelFor(static_cast<std::size_t>(this->Size.z), [&](std::size_t from, std::size_t to) {
      for (std::size_t z = from; z < to; ++z)
      {
        for (int y = 0; y < this->Size.y; ++y)
        {
          for (int x = 0; x < this->Size.x; ++x)
          {
            const glm::ivec3 block(x, y, static_cast<int>(z));
            const glm::ivec3 first = BlockSize * block;
            this->Labels[GridIndex(block, this->Size)] = FindCommonLabel<decltype(zero)>(
              mask, isLabelMap, first, glm::min(first + BlockSize, mask.Dimensions));
          }
        }
      }
    });
  });
}

} // namespace ffd
