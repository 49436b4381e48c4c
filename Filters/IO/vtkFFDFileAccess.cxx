// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFileAccess.h"

#include "vtk_zlib.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <system_error>

namespace
{

namespace fs = std::filesystem;

constexpr std::size_t Chunk = std::size_t(1) << 20;
constexpr std::size_t LargestText = std::size_t(1) << 30;
/// inflate(): zlib or gzip, found out from the stream.
constexpr int AnyWindow = 15 + 32;
constexpr int TemporaryNames = 100;

/// Append up to `limit` bytes of the stream.
void Append(std::ifstream& stream, std::size_t limit, std::string& bytes)
{
  const std::size_t before = bytes.size();
  bytes.resize(before + limit);
  stream.read(&bytes[before], static_cast<std::streamsize>(limit));
  bytes.resize(before + static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
}

bool Open(const std::string& name, std::size_t offset, std::ifstream& stream, std::string& error)
{
  std::size_t size = 0;
  if (!vtkFFDFileAccess::FindSize(name, size, error))
  {
    return false;
  }
  stream.open(name, std::ios::binary);
  if (!stream)
  {
    error = "it cannot be opened";
    return false;
  }
  stream.seekg(static_cast<std::streamoff>(std::min(offset, size)));
  return true;
}

/// Ends inflate() with the scope.
struct InflateStream : z_stream
{
  InflateStream()
    : z_stream{}
    , Usable(inflateInit2(this, AnyWindow) == Z_OK)
  {
  }
  ~InflateStream()
  {
    if (this->Usable)
    {
      inflateEnd(this);
    }
  }
  InflateStream(const InflateStream&) = delete;
  void operator=(const InflateStream&) = delete;
  bool Usable;
};

/// The file that a name stands for, which need not be there, nor what a link leads to.
fs::path FollowLinks(fs::path path, std::error_code& problem)
{
  constexpr int mostLinks = 40;
  for (int i = 0; i < mostLinks && fs::is_symlink(fs::symlink_status(path, problem)); ++i)
  {
    path = path.parent_path() / fs::read_symlink(path, problem);
  }
  return fs::weakly_canonical(path, problem);
}

/// A name in a folder that no file has; the file is made, so that nobody else takes it.
fs::path MakeTemporary(const fs::path& folder)
{
  std::random_device random;
  for (int i = 0; i < TemporaryNames; ++i)
  {
    const fs::path path = folder / (".ffd-" + std::to_string(random()) + ".tmp");
    std::FILE* const file = std::fopen(path.string().c_str(), "wbx");
    if (file)
    {
      std::fclose(file);
      return path;
    }
  }
  return fs::path();
}

/// Whether `path` is `folder` or lies below it; both canonical.
bool IsWithin(const fs::path& path, const fs::path& folder)
{
  return !folder.empty() &&
    std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// `place` gives memory for the next so many bytes, `keep` is told how many of them there were.
bool Inflate(const std::string& name, std::size_t offset, std::size_t limit,
  const std::function<char*(std::size_t)>& place, const std::function<void(std::size_t)>& keep,
  const vtkFFDFileAccess::Proceed& proceed, std::string& error)
{
  std::size_t found = 0;
  std::ifstream file;
  if (!Open(name, offset, file, error))
  {
    return false;
  }
  InflateStream stream;
  if (!stream.Usable)
  {
    error = "zlib cannot be used";
    return false;
  }
  std::string packed;
  bool first = true;   // no member has ended yet
  bool between = true; // nothing of the present member was read
  bool gzip = false;
  while (found < limit)
  {
    if (stream.avail_in == 0)
    {
      packed.clear();
      Append(file, Chunk, packed);
      stream.next_in = reinterpret_cast<Bytef*>(&packed[0]);
      stream.avail_in = static_cast<uInt>(packed.size());
    }
    if (stream.avail_in == 0)
    {
      break; // the end of the file
    }
    if (between)
    {
      if (!first && (!gzip || *stream.next_in != 0x1f))
      {
        break;
      }
      gzip = *stream.next_in == 0x1f;
      between = false;
    }
    const std::size_t out = std::min(Chunk, limit - found);
    stream.next_out = reinterpret_cast<Bytef*>(place(out));
    stream.avail_out = static_cast<uInt>(out);
    const int status = inflate(&stream, Z_NO_FLUSH);
    keep(out - stream.avail_out);
    found += out - stream.avail_out;
    if (status == Z_STREAM_END)
    {
      first = false;
      between = true;
      inflateReset(&stream);
    }
    else if (status != Z_OK && status != Z_BUF_ERROR)
    {
      error = "the compressed data are damaged";
      return false;
    }
    if (!proceed())
    {
      error = "reading was stopped";
      return false;
    }
  }
  return true;
}

} // namespace

namespace vtkFFDFileAccess
{

//------------------------------------------------------------------------------
bool FindSize(const std::string& name, std::size_t& size, std::string& error)
{
  std::error_code problem;
  const fs::file_status status = fs::status(name, problem);
  if (!fs::exists(status))
  {
    error = "it cannot be opened";
    return false;
  }
  if (!fs::is_regular_file(status))
  {
    error = "it is no regular file";
    return false;
  }
  size = static_cast<std::size_t>(fs::file_size(name, problem));
  if (problem)
  {
    error = "it cannot be opened";
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
bool ReadBytes(const std::string& name, std::size_t offset, std::size_t limit, std::string& bytes,
  const Proceed& proceed, std::string& error)
{
  bytes.clear();
  std::ifstream stream;
  if (!Open(name, offset, stream, error))
  {
    return false;
  }
  while (stream && bytes.size() < limit)
  {
    Append(stream, std::min(Chunk, limit - bytes.size()), bytes);
    if (!proceed())
    {
      error = "reading was stopped";
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
std::size_t FindMarkSize(std::string_view text)
{
  constexpr std::string_view mark = "\xef\xbb\xbf";
  return text.substr(0, mark.size()) == mark ? mark.size() : 0;
}

//------------------------------------------------------------------------------
bool ReadText(
  const std::string& name, std::string& text, const Proceed& proceed, std::string& error)
{
  text.clear();
  std::ifstream stream;
  std::size_t size = 0;
  if (!Open(name, 0, stream, error) || !FindSize(name, size, error))
  {
    return false;
  }
  if (size > LargestText)
  {
    error = "it is larger than 1 GiB";
    return false;
  }
  while (stream && text.size() <= LargestText)
  {
    const std::size_t before = text.size();
    Append(stream, Chunk, text);
    text.erase(0, before == 0 ? FindMarkSize(text) : 0);
    if (text.find('\0', before) != std::string::npos)
    {
      error = "it is no text: there is a zero byte in it";
      return false;
    }
    if (!proceed())
    {
      error = "reading was stopped";
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
bool ReadCompressed(const std::string& name, std::size_t offset, std::size_t limit,
  std::string& bytes, const Proceed& proceed, std::string& error)
{
  bytes.clear();
  std::size_t found = 0;
  const auto place = [&bytes, &found](std::size_t count) {
    bytes.resize(found + count);
    return &bytes[found];
  };
  const auto keep = [&bytes, &found](std::size_t count) {
    found += count;
    bytes.resize(found);
  };
  return Inflate(name, offset, limit, place, keep, proceed, error);
}

//------------------------------------------------------------------------------
bool ReadCompressedInto(const std::string& name, std::size_t offset, char* bytes, std::size_t limit,
  std::size_t& found, std::string& error)
{
  found = 0;
  const auto place = [bytes, &found](std::size_t) { return bytes + found; };
  const auto keep = [&found](std::size_t count) { found += count; };
  return Inflate(
    name, offset, limit, place, keep, [] { return true; }, error);
}

//------------------------------------------------------------------------------
bool IsGzip(std::string_view bytes)
{
  return bytes.size() > 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
}

//------------------------------------------------------------------------------
bool FindBeside(
  const std::string& header, const std::string& name, std::string& path, std::string& error)
{
  std::error_code problem;
  const fs::path beside = fs::path(header).parent_path();
  const fs::path folders[] = { fs::canonical(beside.empty() ? fs::path(".") : beside, problem),
    fs::canonical(header, problem).parent_path() };
  const fs::path plain = fs::path(name).filename();
  for (const fs::path& folder : folders)
  {
    const fs::path candidate = folder / plain;
    if (plain.empty() || !fs::exists(candidate, problem))
    {
      continue;
    }
    const fs::path file = fs::canonical(candidate, problem);
    if (problem || !(IsWithin(file, folders[0]) || IsWithin(file, folders[1])))
    {
      error = plain.string() +
        ": it is a link to a file outside of the folder of the file that names it. Copy it there";
      return false;
    }
    path = candidate.string();
    return true;
  }
  error = plain.string() + ": it is not in the folder of the file that names it";
  return false;
}

//------------------------------------------------------------------------------
Replacement::~Replacement()
{
  if (!this->Temporary.empty())
  {
    std::error_code problem;
    fs::remove(this->Temporary, problem);
  }
}

//------------------------------------------------------------------------------
bool Replacement::Write(
  const std::string& name, std::string_view head, std::string_view data, std::string& error)
{
  std::error_code problem;
  const fs::path target = FollowLinks(name, problem);
  if (problem)
  {
    error = "its name cannot be used: " + problem.message();
    return false;
  }
  const fs::file_status status = fs::status(target, problem);
  error = "it could not be written: check that the folder is there, and writable, with space left";
  if (fs::exists(status))
  {
    if (!fs::is_regular_file(status))
    {
      error = "there is something of that name that is no regular file";
      return false;
    }
    if (!std::ofstream(target, std::ios::binary | std::ios::app))
    {
      return false;
    }
  }
  this->Target = target.string();
  this->Temporary = MakeTemporary(target.parent_path()).string();
  if (this->Temporary.empty())
  {
    return false;
  }
  std::ofstream stream(this->Temporary, std::ios::binary | std::ios::trunc);
  stream.write(head.data(), static_cast<std::streamsize>(head.size()));
  stream.write(data.data(), static_cast<std::streamsize>(data.size()));
  stream.close();
  if (stream.fail())
  {
    return false;
  }
  if (fs::exists(status))
  {
    fs::permissions(this->Temporary, status.permissions(), problem);
  }
  error.clear();
  return true;
}

//------------------------------------------------------------------------------
bool Replacement::Commit(std::string& error)
{
  std::error_code problem;
  fs::rename(this->Temporary, this->Target, problem);
  if (problem)
  {
    error = "it could not be replaced: " + problem.message();
    return false;
  }
  this->Temporary.clear();
  return true;
}

} // namespace vtkFFDFileAccess
