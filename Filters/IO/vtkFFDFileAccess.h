// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed.
#ifndef vtkFFDFileAccess_h
#define vtkFFDFileAccess_h

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

/**
 * Bytes of foreign files, and files that are replaced as a whole. Only regular files are opened: a
 * FIFO or a device has no size and may never end. Functions return false with the reason in
 * `error`.
 */
namespace vtkFFDFileAccess
{

/// Called now and then while a file is read; false stops it with an error.
using Proceed = std::function<bool()>;

/// Whether the name (links followed) is a regular file; its size in bytes.
bool FindSize(const std::string& name, std::size_t& size, std::string& error);

/// Up to `limit` bytes from `offset` on, fewer at the end of the file.
bool ReadBytes(const std::string& name, std::size_t offset, std::size_t limit, std::string& bytes,
  const Proceed& proceed, std::string& error);

/// Bytes of the byte order mark of UTF-8 that a text begins with: 3, or 0 without one.
std::size_t FindMarkSize(std::string_view text);

/// The whole of a text file of at most 1 GiB, without a byte order mark of UTF-8; a zero byte ends
/// reading with an error.
bool ReadText(
  const std::string& name, std::string& text, const Proceed& proceed, std::string& error);

/**
 * Up to `limit` decompressed bytes of the zlib stream, or of the members of the gzip file, that
 * begin at `offset`. No more of the file is read than these need, and what is allocated follows
 * what was decompressed. Zeros and other bytes behind the last member are ignored, as gzip does.
 */
bool ReadCompressed(const std::string& name, std::size_t offset, std::size_t limit,
  std::string& bytes, const Proceed& proceed, std::string& error);

/// The same into memory of `limit` bytes; `found` is how many of these were there.
bool ReadCompressedInto(const std::string& name, std::size_t offset, char* bytes, std::size_t limit,
  std::size_t& found, std::string& error);

bool IsGzip(std::string_view bytes);

/**
 * Path of the file `name` (without folders) in the folder of `header`. Links are followed, and the
 * file must then lie in that folder or below it: a header from elsewhere opens nothing else. Where
 * the header is a link itself, the folder of the file that it points to counts, too.
 */
bool FindBeside(
  const std::string& header, const std::string& name, std::string& path, std::string& error);

/**
 * A file that appears under its name when it is complete: it is written beside it under another
 * name, which Commit() changes and the destructor removes. Links are followed to the file that is
 * replaced, whose permissions are kept.
 */
class Replacement
{
public:
  Replacement() = default;
  ~Replacement();
  Replacement(const Replacement&) = delete;
  void operator=(const Replacement&) = delete;

  /// Write `head` and then `data`. False for a folder that is missing or full, and for a present
  /// file that is no regular one or may not be written.
  bool Write(
    const std::string& name, std::string_view head, std::string_view data, std::string& error);
  bool Commit(std::string& error);

private:
  std::string Target;
  std::string Temporary;
};

} // namespace vtkFFDFileAccess

#endif
