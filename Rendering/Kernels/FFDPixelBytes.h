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

} // namespace ffd

#endif
