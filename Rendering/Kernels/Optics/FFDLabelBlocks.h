// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDLabelBlocks_h
#define FFDLabelBlocks_h

#include "FFDExport.h"
#include "FFDParallelFor.h"
#include "FFDVolumeView.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ffd
{

/**
 * The labels of a mask in blocks of 8^3 voxels, a byte a block, x fastest: those of large regions
 * are found without a look at the voxels. The labels of a binary mask are 1 inside and 0 outside.
 */
class FFD_RENDERING_EXPORT LabelBlocks
{
public:
  /// A power of two: voxels along each side of a block.
  static constexpr int BlockSize = 8;
  static constexpr int LogBlockSize = 3;
  /// Of blocks that hold several labels, or larger ones.
  static constexpr std::uint8_t Mixed = 255;

  LabelBlocks() = default;
  /// `isLabelMap`: a label map, else a binary mask.
  LabelBlocks(const VolumeView& mask, bool isLabelMap, const ParallelFor& parallelFor);

  const glm::ivec3& GetSize() const { return this->Size; }
  /// The label of each block, or Mixed; three more bytes may be read behind the last one. Null if
  /// there is no mask.
  const std::uint8_t* GetLabels() const
  {
    return this->Labels.empty() ? nullptr : this->Labels.data();
  }
  std::size_t GetMemorySize() const { return this->Labels.capacity(); }

private:
  glm::ivec3 Size{ 0 };
  std::vector<std::uint8_t> Labels;
};

} // namespace ffd

#endif
