// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDGatherLoop_h
#define FFDGatherLoop_h

#include <cstddef>
#include <cstdint>

namespace ffdBenchmark
{

/// An 8-bit volume and where to read 3 bytes behind its last voxel is allowed.
struct GatherVolume
{
  const std::uint8_t* Voxels = nullptr;
  int Dimensions[3] = { 0, 0, 0 };
};

/**
 * The limit of a ray caster: trilinear samples along parallel rays, one voxel apart, in packets of
 * 4 rows of neighboring rays, in the widest vectors of the machine, and nothing else: no
 * deformation, transfer function, shading or compositing. Row `row` of the rays crosses the volume
 * from its front to its back; `checksum` keeps the compiler from dropping the work. Returns the
 * number of samples.
 */
std::size_t GatherRow(const GatherVolume& volume, int row, float& checksum);

/// Rows of rays that fit the volume.
int GetNumberOfGatherRows(const GatherVolume& volume);

/// Name of the vector instructions that GatherRow uses, for example "AVX3".
const char* GetGatherTarget();

} // namespace ffdBenchmark

#endif
