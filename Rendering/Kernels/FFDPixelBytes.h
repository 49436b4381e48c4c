// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPixelBytes_h
#define FFDPixelBytes_h

#include "FFDExport.h"

#include <cstddef>
#include <cstdint>

namespace ffd
{

/**
 * Rounds colors to bytes: 255 is 1, what is beyond 0 and 1 is clamped, and what is not a number is
 * 0. `colors`: RGBA of so many pixels, premultiplied. Where bytes are not to be `premultiplied`,
 * colors are divided by alpha, and pixels without alpha are black.
 */
FFD_RENDERING_EXPORT void WritePixelBytes(
  const float* colors, std::size_t pixels, bool premultiplied, std::uint8_t* bytes);

/**
 * Puts colors over those in `below`: over + (1 - alpha of over) * below, rounded, for all of RGBA;
 * what is above 1 becomes 1. Both are bytes of so many pixels, premultiplied. So does OpenGL blend
 * them (GL_ONE, GL_ONE_MINUS_SRC_ALPHA) in a buffer of bytes.
 */
FFD_RENDERING_EXPORT void BlendPixelBytes(
  const std::uint8_t* over, std::size_t pixels, std::uint8_t* below);

} // namespace ffd

#endif
