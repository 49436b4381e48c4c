// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTextHeader.h"

#include "FFDFieldHeader.h"
#include "FFDTextNumbers.h"

#include <vtksys/FStream.hxx>
#include <vtksys/SystemTools.hxx>

#include <iterator>
#include <limits>
#include <locale>
#include <sstream>

namespace vtkFFDTextHeader
{

//------------------------------------------------------------------------------
std::string ReadStart(const std::string& path, std::size_t count)
{
  std::string bytes(count, '\0');
  vtksys::ifstream file(path.c_str(), std::ios::in | std::ios::binary);
  file.read(&bytes[0], static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

//------------------------------------------------------------------------------
Fields ReadFields(const std::string& text, char separator)
{
  Fields fields;
  std::istringstream lines(text);
  std::string line;
  const char* const blank = " \t\r";
  while (std::getline(lines, line) && line.find_first_not_of(blank) != std::string::npos)
  {
    const std::size_t at = line.find(separator);
    const bool isNrrd = separator == ':';
    // Comments and key/value pairs of NRRD are no fields.
    if (at != std::string::npos && !(isNrrd && (line[0] == '#' || line.compare(at, 2, ":=") == 0)))
    {
      const std::size_t end = line.find_last_not_of(blank, at == 0 ? 0 : at - 1);
      const std::size_t from = line.find_first_not_of(blank, at + 1);
      std::string key = line.substr(0, end + 1);
      std::string value = from == std::string::npos
        ? std::string()
        : line.substr(from, line.find_last_not_of(blank) + 1 - from);
      if (isNrrd)
      {
        const std::string known = ffd::FindNrrdField(key);
        key = known.empty() ? key : known;
        const bool isOfWords = key == "space" || key == "encoding" || key == "endian" ||
          key == "kinds" || key == "centers";
        value = isOfWords ? ffd::ToLower(value) : value;
      }
      fields[key] = value;
      if (line.compare(0, 15, "ElementDataFile") == 0)
      {
        break; // what follows may be the voxels
      }
    }
  }
  return fields;
}

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

//------------------------------------------------------------------------------
std::vector<double> ReadNumbers(std::string text)
{
  for (char& c : text)
  {
    c = c == '(' || c == ')' || c == ',' || c == '\\' ? ' ' : c;
  }
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  std::vector<double> numbers;
  std::string word;
  while (words >> word)
  {
    std::istringstream number(word);
    number.imbue(std::locale::classic());
    double value;
    if (vtksys::SystemTools::LowerCase(word) == "nan")
    {
      numbers.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    else if (number >> value)
    {
      numbers.push_back(value);
    }
  }
  return numbers;
}

//------------------------------------------------------------------------------
glm::dvec3 ToVector(const std::vector<double>& numbers, std::size_t first)
{
  return { numbers[first], numbers[first + 1], numbers[first + 2] };
}

} // namespace vtkFFDTextHeader
