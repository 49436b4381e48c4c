// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDVisibleRectangle_h
#define FFDVisibleRectangle_h

#include "FFDExport.h"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <limits>

namespace ffd
{

/// The smallest rectangle that holds the visible pixels of an image, or of what was looked at of
/// it.
class FFD_RENDERING_EXPORT VisibleRectangle
{
public:
  bool IsEmpty() const { return this->Low.x >= this->High.x; }
  /// The first column and row; more than any if it is empty.
  const glm::ivec2& GetLow() const { return this->Low; }
  /// One past the last column and row.
  const glm::ivec2& GetHigh() const { return this->High; }

  void Add(const VisibleRectangle& other)
  {
    this->Low = glm::min(this->Low, other.Low);
    this->High = glm::max(this->High, other.High);
  }

  /**
   * Adds the visible pixels of [first, end). `colors`: RGBA, premultiplied, from the first of these
   * on, `width` pixels from row to row; those that are not zero are visible. Pixels within the
   * rectangle are not looked at.
   */
  void AddPixels(const float* colors, int width, const glm::ivec2& first, const glm::ivec2& end);

private:
  glm::ivec2 Low{ std::numeric_limits<int>::max() };
  glm::ivec2 High{ 0 };
};

} // namespace ffd

#endif
