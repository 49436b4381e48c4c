// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTransferPlane.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ffd
{

//------------------------------------------------------------------------------
TransferPlane::TransferPlane(int width, int height, const float* rgba, const glm::dvec2& low,
  const glm::dvec2& high, bool nearest)
  : Width(width)
  , Height(height)
  , Low(low)
  , Scale(glm::dvec2(width - 1, height - 1) / (high - low))
  , Nearest(nearest)
  , Texels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
  , VisibleUpTo(static_cast<std::size_t>(width) + 1, 0)
{
  std::vector<int> visible(static_cast<std::size_t>(width), 0);
  for (std::size_t i = 0; i < this->Texels.size(); ++i)
  {
    for (int c = 0; c < 4; ++c)
    {
      const float channel = rgba[4 * i + static_cast<std::size_t>(c)];
      // Written so that what is not a number becomes 0.
      this->Texels[i][c] = channel > 0.0f ? std::min(channel, 1.0f) : 0.0f;
    }
    visible[i % static_cast<std::size_t>(width)] |= this->Texels[i].a > 0.0f ? 1 : 0;
  }
  for (std::size_t x = 0; x < visible.size(); ++x)
  {
    this->VisibleUpTo[x + 1] = this->VisibleUpTo[x] + visible[x];
  }
  this->Intervals.reserve(this->Texels.size());
  for (std::size_t i = 0; i < this->Texels.size(); ++i)
  {
    const bool isLast = (i + 1) % static_cast<std::size_t>(width) == 0;
    const glm::vec4& texel = this->Texels[i];
    const glm::vec4& next = this->Texels[isLast ? i : i + 1];
    this->Intervals.push_back({ { texel.a, next.a },
      { TransferInterval::PackColor(&texel.x), TransferInterval::PackColor(&next.x) } });
  }
}

//------------------------------------------------------------------------------
double TransferPlane::TexelOf(double value, int axis) const
{
  const double last = (axis == 0 ? this->Width : this->Height) - 1;
  const double texel = (value - this->Low[axis]) * this->Scale[axis];
  // Not a number where the range is so small that the scale is infinite.
  return texel > 0.0 ? std::min(texel, last) : 0.0;
}

//------------------------------------------------------------------------------
glm::vec4 TransferPlane::Lookup(double x, double y) const
{
  if (std::isnan(x) || std::isnan(y))
  {
    return glm::vec4(0.0f);
  }
  const auto texel = [this](int i, int j) {
    return this->Texels[static_cast<std::size_t>(std::min(i, this->Width - 1)) +
      static_cast<std::size_t>(this->Width) *
        static_cast<std::size_t>(std::min(j, this->Height - 1))];
  };
  const double u = this->TexelOf(x, 0);
  const double v = this->TexelOf(y, 1);
  if (this->Nearest)
  {
    return texel(static_cast<int>(u + 0.5), static_cast<int>(v + 0.5));
  }
  const int i = static_cast<int>(u);
  const int j = static_cast<int>(v);
  const float fx = static_cast<float>(u - i);
  // Between equal texels exactly these: differences of opacities are zero there, not rounding
  // errors that would give normals.
  const auto between = [](const glm::vec4& a, const glm::vec4& b, float part) {
    return a + part * (b - a);
  };
  return between(between(texel(i, j), texel(i + 1, j), fx),
    between(texel(i, j + 1), texel(i + 1, j + 1), fx), static_cast<float>(v - j));
}

//------------------------------------------------------------------------------
bool TransferPlane::IsTransparent(double lo, double hi) const
{
  if (!(lo <= hi))
  {
    return true;
  }
  // A little more than the interval: a sample may leave it by a rounding error.
  const double guard = lo < hi ? 1e-3 : 0.0;
  const double last = this->Width - 1;
  const double from = std::floor(std::max(this->TexelOf(lo, 0) - guard, 0.0));
  const double to = std::ceil(std::min(this->TexelOf(hi, 0) + guard, last));
  return this->VisibleUpTo[static_cast<std::size_t>(to) + 1] ==
    this->VisibleUpTo[static_cast<std::size_t>(from)];
}

//------------------------------------------------------------------------------
TransferTable TransferPlane::MakeTableOfLastRow() const
{
  // A table has two entries at least.
  const std::size_t size = std::max<std::size_t>(static_cast<std::size_t>(this->Width), 2);
  const std::size_t first = this->Texels.size() - static_cast<std::size_t>(this->Width);
  std::vector<float> colors;
  std::vector<float> opacities;
  for (std::size_t i = 0; i < size; ++i)
  {
    const glm::vec4& texel = this->Texels[std::min(first + i, this->Texels.size() - 1)];
    colors.insert(colors.end(), { texel.r, texel.g, texel.b });
    opacities.push_back(texel.a);
  }
  const double length = this->Width > 1 ? (this->Width - 1) / this->Scale.x : 1.0;
  return TransferTable(
    this->Low.x, this->Low.x + length, size, colors.data(), opacities.data(), 1.0);
}

//------------------------------------------------------------------------------
glm::ivec2 TransferPlane::FindVisibleColumns() const
{
  const std::vector<int>& count = this->VisibleUpTo;
  const auto first = std::upper_bound(count.begin(), count.end(), 0);
  const auto last = std::lower_bound(count.begin(), count.end(), count.back());
  return glm::ivec2(first - count.begin() - 1, last - count.begin() - 1);
}

} // namespace ffd
