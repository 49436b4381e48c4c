// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Numbers of either byte order in the bytes of a file.
#ifndef FFDBinaryNumbers_h
#define FFDBinaryNumbers_h

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace ffd
{

inline const unsigned char* BytesAt(std::string_view bytes, std::size_t offset)
{
  return reinterpret_cast<const unsigned char*>(bytes.data()) + offset;
}

/// Unsigned integer of `size` bytes.
inline std::uint64_t LoadBits(const unsigned char* bytes, std::size_t size, bool bigEndian)
{
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i)
  {
    bits |= static_cast<std::uint64_t>(bytes[bigEndian ? size - 1 - i : i]) << (8 * i);
  }
  return bits;
}

inline double LoadFloat(const unsigned char* bytes, bool bigEndian)
{
  const std::uint32_t bits = static_cast<std::uint32_t>(LoadBits(bytes, 4, bigEndian));
  float value = 0.0f;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

inline double LoadDouble(const unsigned char* bytes, bool bigEndian)
{
  const std::uint64_t bits = LoadBits(bytes, 8, bigEndian);
  double value = 0.0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

} // namespace ffd

#endif
