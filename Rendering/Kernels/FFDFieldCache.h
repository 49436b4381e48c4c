// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDFieldCache_h
#define FFDFieldCache_h

#include "Bounds/FFDBox.h"
#include "FFDBoxImages.h"
#include "FFDBoxOrientation.h"
#include "FFDBSplineField.h"
#include "FFDExport.h"
#include "Packets/FFDPacketField.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace ffd
{

/**
 * What frames need of a field that does not change, found on first use: with a lattice of many
 * control points that takes longer than a frame. Nothing but numbers are kept of one of few, which
 * takes little time, and memory that counts beside a small volume. The field is always the same
 * one. Threads may share a cache.
 */
class FFD_RENDERING_EXPORT FieldCache
{
public:
  /// Control points of a field, with those of its border, of which nothing is kept.
  static constexpr std::size_t FewControlPoints = 8000;

  /// PacketField(field, rest, cells), relative to the origin of the data.
  PacketField FindPacketField(const BSplineField& field, const Box& rest, const glm::ivec3& cells);

  /// A number that no other cache has, and so no other field; never 0.
  std::uint64_t GetNumber() const { return this->Number; }

  /**
   * For how many cells beyond the lattice of a field, at most `wanted` and 8, D may go on linearly
   * so that T, which is one to one, stays so, by the bounds of the field that does. None where that
   * is not proven. Takes as long as to bound a lattice of so many control points.
   */
  glm::ivec3 FindProvenCells(const BSplineField& field, const glm::ivec3& wanted);

  /// BoxImages(boxes, &field, sign), for a few last grids of boxes.
  std::shared_ptr<const BoxImages> FindBoxImages(
    const BoxGrid& boxes, const BSplineField& field, double sign);

  ThirdDerivatives FindThirdDerivatives(const BSplineField& field);

  std::size_t GetMemorySize() const;

private:
  static std::uint64_t MakeNumber();

  std::uint64_t Number = MakeNumber();
  mutable std::mutex Mutex;
  PacketField Packets;
  Box Rest;
  glm::ivec3 Cells{ 0 };
  glm::ivec3 Wanted{ 0 };
  glm::ivec3 Proven{ 0 };                               ///< FindProvenCells() of Wanted
  std::vector<std::shared_ptr<const BoxImages>> Images; ///< the last one was asked for last
  std::optional<ThirdDerivatives> Third;
  std::optional<double> SecondDerivative;
};

} // namespace ffd

#endif
