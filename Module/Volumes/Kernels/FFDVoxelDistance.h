// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDVoxelDistance_h
#define FFDVoxelDistance_h

#include "FFDExport.h"
#include "FFDTransferTable.h"
#include "FFDVolumeView.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>

namespace ffd
{

/// Distance of voxels when nothing is visible at all.
constexpr std::uint16_t NothingVisible = 65535;

/// Mark voxels: 0 where the scalar is visible, else NothingVisible; the slices [first, last).
/// Scalars that are not a number are invisible. `marks`: all voxels, x fastest.
FFD_VOLUMES_EXPORT void MarkVisibleVoxels(
  const VolumeView& volume, const TransferTable& table, int first, int last, std::uint16_t* marks);

/**
 * Chebyshev distance of every voxel to the nearest one marked 0, in voxels: the distance coding of
 * section 4.6 of the paper at full resolution. In place, by two sweeps over the 26 neighbors,
 * which are exact for this metric (Borgefors 1986). `progress` is called with a part of the work
 * that is done, 0 to 1; returning false stops, the distances are then not valid.
 */
FFD_VOLUMES_EXPORT bool FindChebyshevDistances(const glm::ivec3& dimensions,
  std::uint16_t* distances, const std::function<bool(double)>& progress);

} // namespace ffd

#endif
