// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFinalColors.h"

#include "FFDCastScene.h"
#include "FFDRayCaster.h"

#include <algorithm>

//------------------------------------------------------------------------------
void vtkFFDFinalColors::Apply(
  const ffd::CastImage& image, const vtkFFDFrameCoherence::Part& tile) const
{
  if (this->Window == 1.0 && this->Level == 0.5)
  {
    return;
  }
  const float scale = static_cast<float>(1.0 / this->Window);
  const float bias = static_cast<float>(0.5 - this->Level / this->Window);
  const ffd::RayCaster::TileRange range(tile.Tile, { image.Width, image.Height });
  for (int y = range.First.y; y < range.End.y; ++y)
  {
    for (int x = range.First.x; x < range.End.x; ++x)
    {
      const glm::ivec2 subtile = (glm::ivec2(x, y) - range.First) / ffd::RayCaster::SubtileSize;
      if ((tile.Subtiles >> (subtile.x + 2 * subtile.y) & 1u) == 0)
      {
        continue;
      }
      float* const pixel = image.GetColor(x, y);
      for (int c = 0; c < 3; ++c)
      {
        pixel[c] = std::clamp(pixel[c] * scale + bias * pixel[3], 0.0f, 1.0f);
      }
    }
  }
}
