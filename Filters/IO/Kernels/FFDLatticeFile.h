// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDLatticeFile_h
#define FFDLatticeFile_h

#include "FFDExport.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace ffd
{

/// Decodes base64 into at most `size` bytes, and returns how many there are: for instance
/// vtkBase64Utilities::DecodeSafely().
using Base64Decoder = std::size_t (*)(
  const unsigned char* text, std::size_t length, unsigned char* bytes, std::size_t size);

/**
 * Whether a .vti file may be given to vtkXMLImageDataReader as an image of control points: empty,
 * or what is wrong with its elements and attributes. VTK 9.1's reader fails hard on types that it
 * does not know, and allocates what the file claims. `bytes` is the whole file.
 */
FFD_IO_EXPORT std::string FindLatticeFileProblem(std::string_view bytes, Base64Decoder decode);

/**
 * Most bytes that a .vti file of control points needs, by the extent in `head`, its first bytes: a
 * larger one is not read to be refused. Without an extent: 1 MiB.
 */
FFD_IO_EXPORT std::size_t FindLargestLatticeFile(std::string_view head);

} // namespace ffd

#endif
