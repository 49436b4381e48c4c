// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDItkTransform.h"

#include "FFDTransformText.h"

#include <iterator>

namespace ffd
{

//------------------------------------------------------------------------------
bool LooksLikeItkTransform(std::string_view text)
{
  return Trim(TakeLine(text)).substr(0, 23) == "#Insight Transform File";
}

//------------------------------------------------------------------------------
bool ParseItkTransform(std::string_view text, ItkTransform& transform, std::string& error)
{
  transform = ItkTransform();
  error.clear();
  if (!LooksLikeItkTransform(text))
  {
    error = "the first line is not '#Insight Transform File V1.0'";
    return false;
  }
  struct Entry
  {
    std::string_view Type;
    std::string_view Parameters;
    std::string_view Fixed;
    bool HasParameters = false;
    bool HasFixed = false;
  };
  std::vector<Entry> entries;
  while (!text.empty())
  {
    const std::string_view line = Trim(TakeLine(text));
    if (line.empty() || line.front() == '#')
    {
      continue;
    }
    const std::size_t colon = line.find(':');
    const std::string_view key = Trim(line.substr(0, colon));
    const std::string_view value =
      colon == std::string_view::npos ? std::string_view() : Trim(line.substr(colon + 1));
    if (key == "Transform")
    {
      if (entries.size() > LargestChain)
      {
        error = "there are more than 64 transforms";
        return false;
      }
      entries.emplace_back();
      entries.back().Type = value;
      continue;
    }
    const bool parameters = key == "Parameters";
    if ((!parameters && key != "FixedParameters") || entries.empty())
    {
      error = "the line " + Quote(line) + " is not expected there";
      return false;
    }
    Entry& entry = entries.back();
    bool& has = parameters ? entry.HasParameters : entry.HasFixed;
    if (has)
    {
      error = "there are two lines of " + std::string(key) + " for one transform";
      return false;
    }
    has = true;
    (parameters ? entry.Parameters : entry.Fixed) = value;
  }
  std::size_t skipped = 0;
  if (!CheckItkList(entries.size(), entries.empty() ? std::string_view() : entries.front().Type,
        skipped, error))
  {
    return false;
  }
  for (std::size_t i = skipped; i < entries.size(); ++i)
  {
    const Entry& entry = entries[i];
    std::vector<double> parameters;
    std::vector<double> fixed;
    TransformStep step;
    if (!ReadNumbers(entry.Parameters, "parameter", parameters, error) ||
      !ReadNumbers(entry.Fixed, "fixed parameter", fixed, error) ||
      !MakeItkStep(entry.Type, parameters, fixed, step, error))
    {
      return false;
    }
    transform.Steps.push_back(std::move(step));
  }
  // The transform that was added last to a CompositeTransform is applied first.
  transform.Steps = std::vector<TransformStep>(std::make_move_iterator(transform.Steps.rbegin()),
    std::make_move_iterator(transform.Steps.rend()));
  return true;
}

//------------------------------------------------------------------------------
std::string FormatItkTransform(const std::vector<TransformStep>& steps)
{
  std::string text = "#Insight Transform File V1.0\n";
  int number = 0;
  if (steps.size() != 1)
  {
    text +=
      "#Transform " + std::to_string(number++) + "\nTransform: CompositeTransform_double_3_3\n";
  }
  for (auto step = steps.rbegin(); step != steps.rend(); ++step)
  {
    text += "#Transform " + std::to_string(number++) + "\nTransform: ";
    if (step->Type == TransformStep::Kind::Linear)
    {
      text += "AffineTransform_double_3_3\nParameters:";
      AppendMatrix(text, step->Matrix);
      AppendVector(text, step->Offset);
      text += "\nFixedParameters: 0 0 0\n";
      continue;
    }
    const bool spline = step->Type == TransformStep::Kind::Spline;
    text += spline ? "BSplineTransform" : "DisplacementFieldTransform";
    text += "_double_3_3";
    text += spline && step->Order != 3 ? "_" + std::to_string(step->Order) : std::string();
    text += "\nParameters:";
    if (spline)
    {
      AppendPlanar(text, step->Values);
    }
    else
    {
      for (const glm::dvec3& value : step->Values)
      {
        AppendVector(text, value);
      }
    }
    text += "\nFixedParameters:";
    AppendSize(text, step->Grid.Size);
    AppendVector(text, step->Grid.Origin);
    AppendVector(text, step->Grid.Spacing);
    AppendMatrix(text, step->Grid.Direction);
    text += "\n";
  }
  return text;
}

} // namespace ffd
