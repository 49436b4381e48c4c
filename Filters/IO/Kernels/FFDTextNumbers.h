// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTextNumbers_h
#define FFDTextNumbers_h

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ffd
{

/// The largest length, angle or matrix entry that is accepted; it keeps products finite.
constexpr double LargestNumber = 1e12;

/// Without the blanks at both ends.
std::string_view Trim(std::string_view text);
/// With small letters for the capital ones of ASCII.
std::string ToLower(std::string_view text);
/// A piece of foreign text for a message: short and printable.
std::string Quote(std::string_view text);
/// Take the next line off the front.
std::string_view TakeLine(std::string_view& text);
/// Take the next blank-separated word off the front; empty at the end.
std::string_view TakeWord(std::string_view& text);

/// Whether the word is a finite number of at most 1e12; independent of the locale.
bool ReadNumber(std::string_view word, double& value);
/// All words; false with a message that calls them `what`.
bool ReadNumbers(
  std::string_view text, const char* what, std::vector<double>& values, std::string& error);
bool HasCount(
  const std::vector<double>& values, std::size_t wanted, const char* what, std::string& error);

/// The shortest digits that give the same double back.
void AppendNumber(std::string& text, double value);

} // namespace ffd

#endif
