// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDVolumeView_h
#define FFDVolumeView_h

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstdint>

namespace ffd
{

class AxisMap;

/// The scalar types of an image, in C++ terms.
enum class ScalarType
{
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64
};

/**
 * Plain view of the voxels of an image and of where they lie.
 *
 * Index coordinates count voxels from the first one: voxel (i, j, k) of Dimensions lies at (i, j,
 * k), whatever the extent of the image. Data coordinates are those of the image (origin, spacing,
 * direction): data = FirstVoxel + IndexToData * index.
 */
struct VolumeView
{
  const void* Scalars = nullptr; ///< component to render of voxel (0, 0, 0)
  ScalarType Type = ScalarType::UInt8;
  glm::ivec3 Dimensions{ 0 };      ///< voxels per axis, each >= 2
  std::int64_t Increments[3] = {}; ///< elements between neighboring voxels per axis
  int Components = 1; ///< of each voxel, side by side in memory; Scalars is the first of them
  /// Extent of scalars beyond the outermost voxels, index units: half a voxel if they are of cells.
  /// The nearest voxels hold there.
  double Margin = 0.0;
  const AxisMap* Axes = nullptr; ///< where voxels lie, unless at equal steps

  glm::dvec3 FirstVoxel{ 0.0 };
  glm::dmat3 IndexToData{ 1.0 };
  glm::dmat3 DataToIndex{ 1.0 };

  glm::dvec3 ToIndex(const glm::dvec3& data) const
  {
    return this->DataToIndex * (data - this->FirstVoxel);
  }
  /// Samples are taken in [LowerIndex(), UpperIndex()]: from the first voxel to the last one, and
  /// Margin beyond.
  glm::dvec3 LowerIndex() const { return glm::dvec3(-this->Margin); }
  glm::dvec3 UpperIndex() const { return glm::dvec3(this->Dimensions - 1) + this->Margin; }
};

} // namespace ffd

#endif
