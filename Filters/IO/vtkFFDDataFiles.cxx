// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDataFiles.h"

#include "vtkFFDFileAccess.h"

#include "vtkType.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <system_error>

namespace vtkFFDDataFiles
{

//------------------------------------------------------------------------------
std::string Find(const Fields& fields, std::initializer_list<const char*> names)
{
  for (const char* name : names)
  {
    const auto found = fields.find(name);
    if (found != fields.end())
    {
      return found->second;
    }
  }
  return std::string();
}

//------------------------------------------------------------------------------
std::vector<std::string> ToWords(const std::string& text)
{
  std::istringstream stream(text);
  return { std::istream_iterator<std::string>(stream), std::istream_iterator<std::string>{} };
}

} // namespace vtkFFDDataFiles

namespace
{

using vtkFFDDataFiles::Find;
using vtkFFDDataFiles::ToWords;
namespace fs = std::filesystem;

constexpr long LargestNumberOfFiles = 65536;

bool IsTrue(const std::string& value)
{
  return !value.empty() && (value[0] == 'T' || value[0] == 't' || value[0] == '1');
}

/// Whether it is a pattern with a single whole number in it, as "slice%03d.raw".
bool IsPattern(const std::string& word)
{
  const std::size_t percent = word.find('%');
  if (percent == std::string::npos || word.find('%', percent + 1) != std::string::npos)
  {
    return false;
  }
  const std::size_t digits = word.find_first_not_of("0123456789", percent + 1);
  return digits != std::string::npos && digits - percent <= 3 &&
    (word[digits] == 'd' || word[digits] == 'i' || word[digits] == 'u');
}

/// The files that "pattern first last step" names; with fewer numbers as MetaImage has it. Empty
/// after an error.
std::vector<std::string> ExpandPattern(const std::string& value, int slices)
{
  const std::vector<std::string> words = ToWords(value);
  std::vector<std::string> names;
  if (words.empty() || !IsPattern(words[0]))
  {
    return names;
  }
  const auto number = [&](std::size_t n) { return std::strtol(words[n].c_str(), nullptr, 10); };
  const long first = words.size() > 1 ? number(1) : 1;
  const long last = words.size() > 2 ? number(2) : first + slices - 1;
  const long step = words.size() > 3 ? number(3) : words.size() > 2 ? (last - first) / slices : 1;
  if (step < 1 || first < 0 || last > LargestNumberOfFiles || first > last)
  {
    return names;
  }
  for (long n = first; n <= last && static_cast<long>(names.size()) < slices; n += step)
  {
    std::vector<char> name(words[0].size() + 32);
    // Checked above: one whole number.
    const std::size_t percent = words[0].find('%');
    const std::size_t end = words[0].find_first_not_of("0123456789", percent + 1);
    const std::string digits = words[0].substr(percent + 1, end - percent - 1);
    const int width = std::atoi(digits.c_str());
    const bool zeros = !digits.empty() && digits[0] == '0';
    std::snprintf(name.data(), name.size(), zeros ? "%0*ld" : "%*ld", width, n);
    names.push_back(words[0].substr(0, percent) + name.data() + words[0].substr(end + 1));
  }
  return names;
}

/// The lines that follow the one that begins with a key.
std::vector<std::string> LinesAfter(const std::string& text, const std::string& key, int most)
{
  std::istringstream stream(text);
  std::vector<std::string> lines;
  std::string line;
  bool found = false;
  while (std::getline(stream, line) && static_cast<int>(lines.size()) < most)
  {
    const std::size_t end = line.find_last_not_of(" \t\r");
    if (found && end != std::string::npos)
    {
      lines.push_back(line.substr(0, end + 1));
    }
    found = found || line.compare(0, key.size(), key) == 0;
  }
  return lines;
}

/// A path in the header; an absolute one stays as it is.
std::string Resolve(const std::string& header, const std::string& name)
{
  return (fs::path(header).parent_path() / fs::path(name)).string();
}

/// The numbers of dimensions and sizes of a NRRD, as they stand there.
std::string FindNrrdSizesProblem(const vtkFFDDataFiles::Fields& fields)
{
  const std::string sizes = Find(fields, { "sizes" });
  const std::vector<std::string> words = ToWords(sizes);
  bool plain = !words.empty();
  for (const std::string& word : words)
  {
    plain = plain && word.find_first_not_of("0123456789") == std::string::npos &&
      word.size() < 10 && std::atol(word.c_str()) > 0;
  }
  const std::string dimension = Find(fields, { "dimension" });
  return plain && std::to_string(words.size()) == dimension ? std::string()
                                                            : "its sizes are '" + sizes +
      "', its dimension '" + dimension + "': as many whole numbers from 1 to 999999999 are needed";
}

/// Whether numbers of a NRRD are written as text.
bool IsText(const std::string& encoding)
{
  return encoding == "ascii" || encoding == "text" || encoding == "txt";
}

/// Whether the last of the four axes of a NRRD is none of space, as that of times.
bool IsLastNotOfSpace(const vtkFFDDataFiles::Fields& fields)
{
  const std::string directions = Find(fields, { "space directions" });
  if (!directions.empty())
  {
    return ToWords(directions)[0] != "none";
  }
  const std::vector<std::string> kinds = ToWords(Find(fields, { "kinds" }));
  return kinds.size() == 4 && (kinds[0] == "domain" || kinds[0] == "space");
}

/// Behind the empty line that ends the header of a NRRD; none: 0.
std::size_t FindNrrdData(const std::string& text)
{
  const std::size_t plain = text.find("\n\n");
  const std::size_t returns = text.find("\n\r\n");
  return std::min(plain, returns) == std::string::npos ? 0
    : plain < returns                                  ? plain + 2
                                                       : returns + 3;
}

std::string CheckFile(const std::string& header, const std::string& name, double leastBytes,
  std::initializer_list<const char*> endings = { "" })
{
  const std::string path = Resolve(header, name);
  std::string found = path;
  for (const char* ending : endings)
  {
    std::error_code problem;
    if (fs::exists(path + ending, problem))
    {
      found = path + ending;
      break;
    }
  }
  std::size_t size = 0;
  std::string error;
  if (vtkFFDFileAccess::FindSize(found, size, error) && static_cast<double>(size) < leastBytes)
  {
    error = "it holds fewer bytes than the header says";
  }
  return error.empty() ? error : "the data file '" + name + "' that it names: " + error;
}

} // namespace

namespace vtkFFDDataFiles
{

//------------------------------------------------------------------------------
std::string FindMetaImageProblem(
  const std::string& path, const std::string& text, const Fields& fields, double bytes, int slices)
{
  const std::string value = Find(fields, { "ElementDataFile" });
  if (value.empty())
  {
    return "its header has no ElementDataFile";
  }
  const std::string binary = Find(fields, { "BinaryData" });
  const bool plain = (binary.empty() || IsTrue(binary)) &&
    !IsTrue(Find(fields, { "CompressedData" })); // what is stored are the voxels
  if (!(bytes > 0.0))
  {
    return "its header gives voxels without a size (ElementNumberOfChannels)";
  }
  if (value == "LOCAL" || value == "Local" || value == "local")
  {
    const std::size_t line = text.find('\n', text.find("ElementDataFile"));
    const double start = line == std::string::npos ? 0.0 : static_cast<double>(line + 1);
    const std::string name = fs::path(path).filename().string();
    return CheckFile(path, name, plain ? start + bytes : 1.0);
  }
  std::vector<std::string> names;
  // -1: in front of the voxels is what is left.
  const double head = std::max(0.0, std::atof(Find(fields, { "HeaderSize" }).c_str()));
  const double least = plain ? head + bytes / slices : 1.0;
  if (value.compare(0, 4, "LIST") == 0)
  {
    // A number says how many dimensions a file has.
    if (value.size() > 4 && value != "LIST 2" && value != "LIST 2D")
    {
      return "MetaImage takes the data file '" + value +
        "' for a list of files, of which only LIST and LIST 2 (a slice a file) are read here";
    }
    names = LinesAfter(text, "ElementDataFile", slices);
  }
  else if (value.find('%') != std::string::npos)
  {
    names = ExpandPattern(value, slices);
  }
  else
  {
    return CheckFile(path, value, plain ? head + bytes : 1.0, { "", ".gz", ".Z" });
  }
  if (static_cast<int>(names.size()) < slices)
  {
    return "ElementDataFile is '" + value + "', which names no file for each of its " +
      std::to_string(slices) + " slices (LIST and a file a line, or as 'slice%03d.raw 1 9 1')";
  }
  for (const std::string& name : names)
  {
    const std::string problem = CheckFile(path, name, least);
    if (!problem.empty())
    {
      return problem;
    }
  }
  return std::string();
}

//------------------------------------------------------------------------------
std::string FindNrrdProblem(
  const std::string& path, const std::string& text, const Fields& fields, double bytes, int slices)
{
  const std::string sizes = FindNrrdSizesProblem(fields);
  if (!sizes.empty())
  {
    return sizes;
  }
  const std::string encoding = Find(fields, { "encoding" });
  const double least = encoding == "raw" ? bytes : 0.0;
  const std::string value = Find(fields, { "data file", "datafile" });
  if (value.empty())
  {
    const std::size_t start = FindNrrdData(text);
    return start == 0
      ? "its header ends with the file, and names no data file"
      : CheckFile(path, fs::path(path).filename().string(), static_cast<double>(start) + least);
  }
  std::vector<std::string> names = { value };
  const bool isList = value.compare(0, 4, "LIST") == 0;
  const bool isPattern = value.find('%') != std::string::npos;
  if (isList)
  {
    names = LinesAfter(text, "data", slices);
  }
  else if (isPattern)
  {
    names = ExpandPattern(value, slices);
    if (names.empty())
    {
      return "its data file is '" + value + "', which is no pattern as 'slice%03d.raw 1 9 1'";
    }
  }
  if ((isList || isPattern) && IsText(encoding))
  {
    return "its numbers are text in several files, which cannot be read here: write raw ones";
  }
  for (const std::string& name : names)
  {
    const std::string problem =
      CheckFile(path, name, std::max(1.0, isList || isPattern ? least / slices : least));
    if (!problem.empty())
    {
      return problem;
    }
  }
  return std::string();
}

//------------------------------------------------------------------------------
vtkFFDStoredVoxels FindMetaImageVoxels(
  const std::string& path, const std::string& text, const Fields& fields)
{
  vtkFFDStoredVoxels voxels;
  const std::string type = Find(fields, { "ElementType" });
  voxels.Type = type == "MET_LONG" ? VTK_INT : type == "MET_ULONG" ? VTK_UNSIGNED_INT : -1;
  const std::string value = Find(fields, { "ElementDataFile" });
  const std::string binary = Find(fields, { "BinaryData" });
  const bool isText = !binary.empty() && !IsTrue(binary);
  const bool isPacked = !isText && IsTrue(Find(fields, { "CompressedData" }));
  const bool isList = value.compare(0, 4, "LIST") == 0 || value.find('%') != std::string::npos;
  const bool local = value == "LOCAL" || value == "Local" || value == "local";
  const std::string head = Find(fields, { "HeaderSize" });
  // -1: the voxels are at the end of the file.
  const bool isOfVtk =
    !isText && !isPacked && (voxels.Type < 0 || isList || std::atof(head.c_str()) < 0.0);
  voxels.Path = local ? path : Resolve(path, value);
  std::error_code ignored;
  if (isOfVtk || (local && !head.empty()) || !fs::exists(voxels.Path, ignored))
  {
    return voxels;
  }
  voxels.Form = isText ? vtkFFDStoredVoxels::TEXT
    : isPacked         ? vtkFFDStoredVoxels::PACKED
                       : vtkFFDStoredVoxels::RAW;
  voxels.Offset = local ? std::min(text.find('\n', text.find("ElementDataFile")), text.size()) + 1
                        : static_cast<std::size_t>(std::max(0.0, std::atof(head.c_str())));
  voxels.BigEndian = IsTrue(Find(fields, { "BinaryDataByteOrderMSB", "ElementByteOrderMSB" }));
  return voxels;
}

//------------------------------------------------------------------------------
vtkFFDStoredVoxels FindNrrdVoxels(
  const std::string& path, const std::string& text, const Fields& fields)
{
  vtkFFDStoredVoxels voxels;
  const std::string value = Find(fields, { "data file", "datafile" });
  const std::string encoding = Find(fields, { "encoding" });
  const std::vector<std::string> sizes = ToWords(Find(fields, { "sizes" }));
  if (value.compare(0, 4, "LIST") == 0 || value.find('%') != std::string::npos ||
    sizes.size() < 3 || sizes.size() > 4)
  {
    return voxels;
  }
  voxels.Form = IsText(encoding)             ? vtkFFDStoredVoxels::TEXT
    : encoding == "gzip" || encoding == "gz" ? vtkFFDStoredVoxels::PACKED
                                             : vtkFFDStoredVoxels::RAW;
  // One of four axes has no direction: the components, or the times, of which the first is read.
  const std::size_t first = sizes.size() == 4 && !IsLastNotOfSpace(fields) ? 1 : 0;
  for (std::size_t a = 0; a < 3; ++a)
  {
    voxels.Size[a] = std::atoi(sizes[first + a].c_str());
  }
  voxels.FirstAxis = static_cast<int>(first);
  voxels.Components = first == 1 ? std::atoi(sizes[0].c_str()) : 1;
  voxels.Path = value.empty() ? path : Resolve(path, value);
  voxels.Offset = value.empty() ? FindNrrdData(text) : 0;
  voxels.BigEndian = Find(fields, { "endian" }) == "big";
  return voxels;
}

//------------------------------------------------------------------------------
std::string FindXmlProblem(const std::string& path)
{
  constexpr std::size_t tail = 1024; // blanks and comments may follow
  std::size_t size = 0;
  std::string end;
  std::string problem;
  if (!vtkFFDFileAccess::FindSize(path, size, problem) ||
    !vtkFFDFileAccess::ReadBytes(
      path, size - std::min(size, tail), tail, end, [] { return true; }, problem))
  {
    return problem;
  }
  return end.find("</VTKFile") == std::string::npos
    ? "it is not whole: the end of a VTKFile is missing"
    : std::string();
}

//------------------------------------------------------------------------------
std::string FindPairProblem(const std::string& path)
{
  fs::path stem = fs::path(path);
  stem.replace_extension(stem.extension() == ".gz" ? "" : stem.extension());
  for (const char* ending : { ".hdr", ".img", ".hdr.gz", ".img.gz" })
  {
    fs::path other = stem;
    other.replace_extension(ending);
    std::error_code ignored;
    std::size_t size = 0;
    std::string error;
    if (fs::exists(other, ignored) && !vtkFFDFileAccess::FindSize(other.string(), size, error))
    {
      return other.filename().string() + ", which belongs to it: " + error;
    }
  }
  return std::string();
}

//------------------------------------------------------------------------------
std::string FindFolderProblem(const std::string& path)
{
  std::error_code problem;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, problem))
  {
    const fs::file_status status = entry.status(problem); // of what links lead to
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
    {
      return entry.path().filename().string() + ", which is in it, is no regular file";
    }
  }
  return std::string();
}

} // namespace vtkFFDDataFiles
