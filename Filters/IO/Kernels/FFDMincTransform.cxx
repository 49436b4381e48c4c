// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDMincTransform.h"

#include "FFDTransformText.h"

#include <glm/matrix.hpp>

#include <utility>

namespace ffd
{
namespace
{

constexpr std::string_view FirstLine = "MNI Transform File";

/// The text without its comments, which go from % to the end of a line.
std::string StripComments(std::string_view text)
{
  std::string stripped;
  while (!text.empty())
  {
    const std::string_view line = TakeLine(text);
    stripped.append(line.substr(0, line.find('%')));
    stripped += '\n';
  }
  return stripped;
}

/// "Name = value ;". False at the end, and with an error where there is something else.
bool TakeAssignment(
  std::string_view& text, std::string_view& name, std::string_view& value, std::string& error)
{
  text = Trim(text);
  if (text.empty())
  {
    return false;
  }
  const std::size_t end = text.find(';');
  const std::size_t equals = text.substr(0, end).find('=');
  if (end == std::string_view::npos || equals == std::string_view::npos)
  {
    error = Quote(text) + " is no 'Name = value;'";
    return false;
  }
  name = Trim(text.substr(0, equals));
  value = Trim(text.substr(equals + 1, end - equals - 1));
  text.remove_prefix(end + 1);
  return true;
}

/// Three rows of a matrix and an offset.
bool SetLinear(std::string_view value, TransformStep& step, std::string& error)
{
  std::vector<double> numbers;
  if (!ReadNumbers(value, "Linear_Transform", numbers, error) ||
    !HasCount(numbers, 12, "Linear_Transform", error))
  {
    return false;
  }
  for (std::size_t row = 0; row < 3; ++row)
  {
    const int r = static_cast<int>(row);
    for (int column = 0; column < 3; ++column)
    {
      step.Matrix[column][r] = numbers[4 * row + static_cast<std::size_t>(column)];
    }
    step.Offset[r] = numbers[4 * row + 3];
  }
  if (IsSingular(step))
  {
    error = "the matrix of a Linear transform is singular";
    return false;
  }
  return true;
}

/// The assignments of one transform are over.
bool Finish(MincTransformEntry& entry, std::string_view type, bool hasMatrix, std::string& error)
{
  if (type == "Linear" ? !hasMatrix : entry.VolumeFile.empty())
  {
    error = "a transform of the type " + Quote(type) + " has no " +
      (type == "Linear" ? "Linear_Transform" : "Displacement_Volume");
    return false;
  }
  if (type == "Linear" && entry.IsInverse)
  {
    entry.Step.Matrix = glm::inverse(entry.Step.Matrix);
    entry.Step.Offset = -(entry.Step.Matrix * entry.Step.Offset);
    entry.IsInverse = false;
  }
  return true;
}

} // namespace

//------------------------------------------------------------------------------
bool LooksLikeMincTransform(std::string_view text) { return Trim(TakeLine(text)) == FirstLine; }

//------------------------------------------------------------------------------
bool ParseMincTransform(
  std::string_view text, std::vector<MincTransformEntry>& entries, std::string& error)
{
  entries.clear();
  error.clear();
  if (!LooksLikeMincTransform(text))
  {
    error = "the first line is not 'MNI Transform File'";
    return false;
  }
  TakeLine(text);
  const std::string stripped = StripComments(text);
  std::string_view rest = stripped;
  std::string_view name;
  std::string_view value;
  std::string_view type;
  bool hasMatrix = false;
  while (TakeAssignment(rest, name, value, error))
  {
    if (name == "Transform_Type")
    {
      if (!entries.empty() && !Finish(entries.back(), type, hasMatrix, error))
      {
        return false;
      }
      type = value;
      hasMatrix = false;
      entries.emplace_back();
      if (type != "Linear" && type != "Grid_Transform")
      {
        error = "transforms of the type " + Quote(type) + " are not supported";
        return false;
      }
      if (entries.size() > LargestChain)
      {
        error = "there are more than 64 transforms";
        return false;
      }
    }
    else if (name == "Invert_Flag" && !entries.empty() && (value == "True" || value == "False"))
    {
      entries.back().IsInverse = value == "True";
    }
    else if (name == "Linear_Transform" && type == "Linear" && !hasMatrix)
    {
      hasMatrix = true;
      if (!SetLinear(value, entries.back().Step, error))
      {
        return false;
      }
    }
    else if (name == "Displacement_Volume" && type == "Grid_Transform" &&
      entries.back().VolumeFile.empty())
    {
      entries.back().VolumeFile = std::string(value);
    }
    else
    {
      error = Quote(std::string(name) + " = " + std::string(value)) + " is not expected there";
      return false;
    }
  }
  if (!error.empty())
  {
    return false;
  }
  if (entries.empty())
  {
    error = "there is no transform in it";
    return false;
  }
  return Finish(entries.back(), type, hasMatrix, error);
}

} // namespace ffd
