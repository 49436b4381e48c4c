// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTransferPlane_h
#define FFDTransferPlane_h

#include "FFDExport.h"
#include "FFDTransferInterval.h"
#include "FFDTransferTable.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <vector>

namespace ffd
{

/**
 * A two-dimensional transfer function: color and opacity over a scalar (x) and a second value (y),
 * the magnitude of its gradient or another scalar. The first and the last texel lie at the ends of
 * the ranges, as in VTK; beyond, they hold.
 */
class FFD_RENDERING_EXPORT TransferPlane
{
public:
  TransferPlane() = default;

  /**
   * `rgba`: width * height texels, x fastest, channels in [0, 1] (clamped; what is not a number
   * counts as 0), over [low.x, high.x] and [low.y, high.y] (low < high). `nearest`: texels are not
   * interpolated.
   */
  TransferPlane(int width, int height, const float* rgba, const glm::dvec2& low,
    const glm::dvec2& high, bool nearest);

  bool IsEmpty() const { return this->Texels.empty(); }

  /// Color and opacity; transparent where a value is not a number.
  glm::vec4 Lookup(double x, double y) const;

  /// Whether every x of [lo, hi] is transparent for all y.
  bool IsTransparent(double lo, double hi) const;

  /// Color and opacity of values whose y counts as large, as a table whose opacities are over a
  /// distance of one.
  TransferTable MakeTableOfLastRow() const;

  int GetWidth() const { return this->Width; }
  int GetHeight() const { return this->Height; }
  /// As packet kernels read them: each texel and the next one along x; the last one of a row has
  /// itself.
  const std::vector<TransferInterval>& GetIntervals() const { return this->Intervals; }
  const glm::dvec2& GetLow() const { return this->Low; }
  /// Texels a unit along each axis.
  const glm::dvec2& GetScale() const { return this->Scale; }
  bool IsNearest() const { return this->Nearest; }

  /// Columns from the first to the last one with a visible texel; none where the first comes after
  /// the last.
  glm::ivec2 FindVisibleColumns() const;

  std::size_t GetMemorySize() const
  {
    return this->Texels.capacity() * sizeof(glm::vec4) +
      this->Intervals.capacity() * sizeof(TransferInterval);
  }

private:
  double TexelOf(double value, int axis) const;

  int Width = 0;
  int Height = 0;
  glm::dvec2 Low{ 0.0 };
  glm::dvec2 Scale{ 1.0 }; // texels per unit
  bool Nearest = false;
  std::vector<glm::vec4> Texels;
  std::vector<TransferInterval> Intervals;
  std::vector<int> VisibleUpTo; // columns with a visible texel before each
};

} // namespace ffd

#endif
