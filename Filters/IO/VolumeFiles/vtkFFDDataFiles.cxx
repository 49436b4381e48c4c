// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDataFiles.h"

#include "vtkFFDFileAccess.h"
#include "vtkFFDTextHeader.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <system_error>

namespace
{

namespace fs = std::filesystem;

constexpr long LargestNumberOfFiles = 65536;

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

} // namespace

namespace vtkFFDDataFiles
{

//------------------------------------------------------------------------------
std::string Resolve(const std::string& header, const std::string& name)
{
  return (fs::path(header).parent_path() / fs::path(name)).string();
}

//------------------------------------------------------------------------------
std::vector<std::string> ExpandPattern(const std::string& value, int slices)
{
  const std::vector<std::string> words = vtkFFDTextHeader::ToWords(value);
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

//------------------------------------------------------------------------------
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

//------------------------------------------------------------------------------
std::string FindProblem(const std::string& header, const std::string& name, double leastBytes,
  std::initializer_list<const char*> endings)
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

//------------------------------------------------------------------------------
std::string FindProblem(
  const std::string& header, const std::vector<std::string>& names, double leastBytes)
{
  for (const std::string& name : names)
  {
    const std::string problem = FindProblem(header, name, leastBytes);
    if (!problem.empty())
    {
      return problem;
    }
  }
  return std::string();
}

} // namespace vtkFFDDataFiles
