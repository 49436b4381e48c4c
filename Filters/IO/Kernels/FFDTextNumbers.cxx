// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTextNumbers.h"

#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

namespace ffd
{
namespace
{

bool IsSpace(char c)
{
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}

} // namespace

//------------------------------------------------------------------------------
std::string_view Trim(std::string_view text)
{
  while (!text.empty() && IsSpace(text.front()))
  {
    text.remove_prefix(1);
  }
  while (!text.empty() && IsSpace(text.back()))
  {
    text.remove_suffix(1);
  }
  return text;
}

//------------------------------------------------------------------------------
std::string ToLower(std::string_view text)
{
  std::string lower(text);
  for (char& c : lower)
  {
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return lower;
}

//------------------------------------------------------------------------------
std::string Quote(std::string_view text)
{
  std::string quoted = "'";
  for (const char c : text.substr(0, 40))
  {
    quoted += c >= ' ' && c <= '~' ? c : '?';
  }
  return quoted + (text.size() > 40 ? "...'" : "'");
}

//------------------------------------------------------------------------------
std::string_view TakeLine(std::string_view& text)
{
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

//------------------------------------------------------------------------------
std::string_view TakeWord(std::string_view& text)
{
  std::size_t begin = 0;
  while (begin < text.size() && IsSpace(text[begin]))
  {
    ++begin;
  }
  std::size_t end = begin;
  while (end < text.size() && !IsSpace(text[end]))
  {
    ++end;
  }
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

//------------------------------------------------------------------------------
bool ReadNumber(std::string_view word, double& value)
{
  if (!word.empty() && word.front() == '+')
  {
    word.remove_prefix(1);
  }
  const char* const end = word.data() + word.size();
  const std::from_chars_result result = std::from_chars(word.data(), end, value);
  if (result.ec == std::errc::result_out_of_range && result.ptr == end)
  {
    // Underflow is zero; an overflow is refused below.
    const std::size_t exponent = word.find_first_of("eE");
    const bool tiny =
      exponent != std::string_view::npos && exponent + 1 < word.size() && word[exponent + 1] == '-';
    value = tiny ? 0.0 : 2.0 * LargestNumber;
  }
  else if (result.ec != std::errc() || result.ptr != end)
  {
    return false;
  }
  return std::isfinite(value) && std::abs(value) <= LargestNumber;
}

//------------------------------------------------------------------------------
bool ReadNumbers(
  std::string_view text, const char* what, std::vector<double>& values, std::string& error)
{
  values.clear();
  for (std::string_view word = TakeWord(text); !word.empty(); word = TakeWord(text))
  {
    double value = 0.0;
    if (!ReadNumber(word, value))
    {
      error = std::string(what) + " number " + std::to_string(values.size() + 1) + " is " +
        Quote(word) + ", not a finite number of at most 1e12";
      return false;
    }
    values.push_back(value);
  }
  return true;
}

//------------------------------------------------------------------------------
bool HasCount(
  const std::vector<double>& values, std::size_t wanted, const char* what, std::string& error)
{
  if (values.size() != wanted)
  {
    error = std::string(what) + " has " + std::to_string(values.size()) + " numbers instead of " +
      std::to_string(wanted);
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
void AppendNumber(std::string& text, double value)
{
  std::array<char, 32> digits{};
  const std::to_chars_result end =
    std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end.ptr);
}

} // namespace ffd
