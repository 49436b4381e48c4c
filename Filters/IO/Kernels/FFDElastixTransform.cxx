// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDElastixTransform.h"

#include "FFDItkTransform.h"
#include "FFDTextNumbers.h"
#include "FFDTransformText.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace ffd
{
namespace
{

/// Where a comment begins in a line, or its length: at "//" that is not in quotes.
std::size_t FindComment(std::string_view line)
{
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i)
  {
    quoted = quoted != (line[i] == '"');
    if (!quoted && line.substr(i, 2) == "//")
    {
      return i;
    }
  }
  return line.size();
}

/// The entries "(Name value ...)" of an elastix parameter file.
class ElastixEntries
{
public:
  bool Read(std::string_view text, std::string& error)
  {
    while (!text.empty())
    {
      std::string_view line = Trim(TakeLine(text));
      if (line.empty() || line.substr(0, 2) == "//")
      {
        continue;
      }
      // The entry ends before a comment, which may hold parentheses.
      const std::size_t end = line.substr(0, FindComment(line)).rfind(')');
      if (line.front() != '(' || end == std::string_view::npos)
      {
        error = "the line " + Quote(line) + " is no entry in parentheses";
        return false;
      }
      const std::string_view behind = Trim(line.substr(end + 1));
      if (!behind.empty() && behind.substr(0, 2) != "//")
      {
        error = "the line " + Quote(line) + " goes on after its entry";
        return false;
      }
      line = Trim(line.substr(1, end - 1));
      const std::string_view name = TakeWord(line);
      if (!this->Entries.emplace(name, Trim(line)).second)
      {
        error = "there are two entries " + Quote(name);
        return false;
      }
    }
    return true;
  }

  bool Has(std::string_view name) const { return this->Entries.count(name) != 0; }

  /// The value without its quotes, or `otherwise`.
  std::string_view GetText(std::string_view name, std::string_view otherwise) const
  {
    const auto found = this->Entries.find(name);
    std::string_view value = found == this->Entries.end() ? otherwise : found->second;
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
    {
      value = value.substr(1, value.size() - 2);
    }
    return value;
  }

  /// The values in quotes.
  std::vector<std::string> GetTexts(std::string_view name) const
  {
    std::vector<std::string> texts;
    const auto found = this->Entries.find(name);
    std::string_view rest = found == this->Entries.end() ? std::string_view() : found->second;
    for (std::size_t begin = rest.find('"'); begin != std::string_view::npos;
         begin = rest.find('"'))
    {
      rest.remove_prefix(begin + 1);
      const std::size_t end = std::min(rest.find('"'), rest.size());
      texts.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return texts;
  }

  /// Exactly `count` numbers (0: any).
  bool GetNumbers(
    const char* name, std::size_t count, std::vector<double>& values, std::string& error) const
  {
    const auto found = this->Entries.find(name);
    if (found == this->Entries.end())
    {
      error = std::string("there is no entry (") + name + " ...)";
      return false;
    }
    return ReadNumbers(found->second, name, values, error) &&
      (count == 0 || HasCount(values, count, name, error));
  }

  /**
   * The grid of entries with this prefix ("Grid", or "" for the fixed image). Of an image of four
   * dimensions it is that of the first three.
   */
  bool GetGrid(const std::string& prefix, std::size_t dimensions, TransformGrid& grid,
    std::string& error) const
  {
    std::vector<double> size;
    std::vector<double> index;
    std::vector<double> spacing;
    std::vector<double> origin;
    std::vector<double> all;
    const bool turned = this->Has(prefix + "Direction");
    if (!this->GetNumbers((prefix + "Size").c_str(), dimensions, size, error) ||
      !this->GetNumbers((prefix + "Index").c_str(), dimensions, index, error) ||
      !this->GetNumbers((prefix + "Spacing").c_str(), dimensions, spacing, error) ||
      !this->GetNumbers((prefix + "Origin").c_str(), dimensions, origin, error) ||
      (turned &&
        !this->GetNumbers((prefix + "Direction").c_str(), dimensions * dimensions, all, error)))
    {
      return false;
    }
    std::vector<double> direction{ 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 };
    for (std::size_t i = 0; turned && i < direction.size(); ++i)
    {
      direction[i] = all[i / 3 * dimensions + i % 3];
    }
    if (!SizeAt(size, 0, grid.Size))
    {
      error = "the entry (" + prefix + "Size ...) holds no positive integers";
      return false;
    }
    grid.Spacing = VectorAt(spacing, 0);
    // elastix writes the columns one after the other.
    grid.Direction = glm::transpose(MatrixAt(direction, 0));
    grid.Origin = VectorAt(origin, 0) + grid.Direction * (VectorAt(index, 0) * grid.Spacing);
    return true;
  }

private:
  std::map<std::string_view, std::string_view> Entries;
};

/// e^A, by scaling and squaring of the series.
glm::dmat3 Exponential(glm::dmat3 matrix)
{
  double norm = 0.0;
  for (int column = 0; column < 3; ++column)
  {
    norm = std::max(norm, glm::length(matrix[column]));
  }
  int squarings = 0;
  for (; norm > 0.25 && squarings < 64; norm *= 0.5, ++squarings)
  {
    matrix *= 0.5;
  }
  glm::dmat3 sum(1.0);
  glm::dmat3 power(1.0);
  for (int n = 1; n <= 12; ++n) // 0.25^13 / 13! is far below rounding
  {
    power = power * matrix / static_cast<double>(n);
    sum += power;
  }
  for (; squarings > 0; --squarings)
  {
    sum = sum * sum;
  }
  return sum;
}

bool SetSpline(const ElastixEntries& entries, const std::vector<double>& parameters,
  TransformStep& step, std::string& error)
{
  const std::string_view order = entries.GetText("BSplineTransformSplineOrder", "3");
  if (order != "1" && order != "2" && order != "3")
  {
    error = "the entry (BSplineTransformSplineOrder ...) is " + Quote(order) + ", not 1, 2 or 3";
    return false;
  }
  if (entries.GetText("UseCyclicTransform", "false") != "false")
  {
    error = "cyclic splines (UseCyclicTransform) are not supported";
    return false;
  }
  step.Order = order[0] - '0';
  TransformGrid grid;
  return entries.GetGrid("Grid", 3, grid, error) &&
    SetGridStep(step, TransformStep::Kind::Spline, grid, parameters, true, error);
}

bool SetLinear(const ElastixEntries& entries, std::string_view type,
  const std::vector<double>& parameters, TransformStep& step, std::string& error)
{
  // ITK's names; none for the one that only elastix has.
  static const std::map<std::string_view, std::string_view> itkNames = {
    { "AffineTransform", "AffineTransform" }, { "AffineLogTransform", "" },
    { "EulerTransform", "Euler3DTransform" }, { "SimilarityTransform", "Similarity3DTransform" },
    { "TranslationTransform", "TranslationTransform" }
  };
  const auto itkName = itkNames.find(type);
  if (itkName == itkNames.end())
  {
    error = "transforms of the type " + Quote(type) + " are not supported";
    return false;
  }
  std::vector<double> fixed;
  if (entries.Has("CenterOfRotationPoint") &&
    !entries.GetNumbers("CenterOfRotationPoint", 3, fixed, error))
  {
    return false;
  }
  if (type != "TranslationTransform" && fixed.empty())
  {
    error = "there is no entry (CenterOfRotationPoint ...)";
    return false;
  }
  if (entries.GetText("ComputeZYX", "false") == "true")
  {
    fixed.push_back(1.0);
  }
  bool known = true;
  if (itkName->second.empty())
  {
    if (!HasCount(parameters, 12, "TransformParameters", error))
    {
      return false;
    }
    SetCentered(
      step, Exponential(MatrixAt(parameters, 0)), VectorAt(fixed, 0), VectorAt(parameters, 9));
  }
  else if (!MakeItkLinearStep(itkName->second, parameters, fixed, step, known, error))
  {
    return false;
  }
  const double largest = std::max(
    { glm::length(step.Matrix[0]), glm::length(step.Matrix[1]), glm::length(step.Matrix[2]) });
  if (IsSingular(step) || !(largest <= LargestNumber))
  {
    error = "the matrix of the " + Quote(type) + " is singular";
    return false;
  }
  return true;
}

/// The words of step `index` of a stack: as many for each.
bool TakeStackStep(std::string_view text, std::size_t steps, std::size_t index,
  std::vector<double>& values, std::string& error)
{
  static constexpr const char* name = "TransformParameters";
  std::size_t words = 0;
  for (std::string_view rest = text; !TakeWord(rest).empty();)
  {
    ++words;
  }
  if (words == 0 || words % steps != 0)
  {
    error = "the entry (TransformParameters ...) has " + std::to_string(words) +
      " numbers, which are not as many for each of " + std::to_string(steps) + " steps";
    return false;
  }
  const std::size_t each = words / steps;
  std::string_view end = text;
  for (std::size_t i = 0; i < (index + 1) * each; ++i)
  {
    if (i == index * each)
    {
      text = end;
    }
    TakeWord(end);
  }
  return ReadNumbers(text.substr(0, text.size() - end.size()), name, values, error);
}

/// Size and times of a stack; its entries are those of the type for one step besides.
bool SetStack(const ElastixEntries& entries, ElastixTransform& transform, std::string& error)
{
  std::vector<double> count;
  std::vector<double> origin;
  std::vector<double> spacing;
  if (!entries.GetNumbers("NumberOfSubTransforms", 1, count, error) ||
    !entries.GetNumbers("StackOrigin", 1, origin, error) ||
    !entries.GetNumbers("StackSpacing", 1, spacing, error))
  {
    return false;
  }
  if (!(count[0] >= 1.0 && count[0] <= LargestStack) || count[0] != std::floor(count[0]))
  {
    error = "the entry (NumberOfSubTransforms ...) is not an integer from 1 to 65536";
    return false;
  }
  if (!(spacing[0] > 0.0))
  {
    error = "the entry (StackSpacing ...) is not positive";
    return false;
  }
  transform.StackSize = static_cast<std::size_t>(count[0]);
  transform.StackOrigin = origin[0];
  transform.StackSpacing = spacing[0];
  return true;
}

/// The files and weights of a sum of transforms.
bool SetCombination(const ElastixEntries& entries, std::vector<double> weights,
  ElastixTransform& transform, std::string& error)
{
  transform.SubFiles = entries.GetTexts("SubTransforms");
  if (transform.SubFiles.empty() || transform.SubFiles.size() > LargestChain)
  {
    error = "the entry (SubTransforms ...) does not name 1 to 64 files";
    return false;
  }
  if (!HasCount(weights, transform.SubFiles.size(), "TransformParameters", error))
  {
    return false;
  }
  if (entries.GetText("NormalizeCombinationWeights", "false") == "true")
  {
    double sum = 0.0;
    for (const double weight : weights)
    {
      sum += weight;
    }
    for (double& weight : weights)
    {
      weight /= sum;
      if (!(std::abs(weight) <= LargestNumber))
      {
        error = "the weights (TransformParameters) have no sum to be divided by";
        return false;
      }
    }
  }
  transform.Weights = std::move(weights);
  return true;
}

} // namespace

//------------------------------------------------------------------------------
bool LooksLikeElastixTransform(std::string_view text)
{
  bool isFirst = true;
  while (!text.empty())
  {
    std::string_view line = Trim(TakeLine(text));
    if (line.empty() || line.substr(0, 2) == "//")
    {
      continue;
    }
    if (line.front() == '(')
    {
      line.remove_prefix(1);
      if (TakeWord(line) == "Transform")
      {
        return true;
      }
    }
    else if (isFirst)
    {
      return false;
    }
    isFirst = false;
  }
  return false;
}

//------------------------------------------------------------------------------
bool ParseElastixTransform(
  std::string_view text, ElastixTransform& transform, std::string& error, std::size_t stackIndex)
{
  transform = ElastixTransform();
  error.clear();
  ElastixEntries entries;
  if (!entries.Read(text, error))
  {
    return false;
  }
  // Of a stack the last dimension is which of its transforms it is.
  std::string_view type = entries.GetText("Transform", "");
  const std::size_t stack = type.find("StackTransform");
  const bool isStack = stack != std::string_view::npos;
  const std::string itsType = std::string(type.substr(0, stack)) + "Transform";
  type = isStack ? std::string_view(itsType) : type;
  const std::string_view dimensions = isStack ? "4" : "3";
  for (const char* dimension : { "FixedImageDimension", "MovingImageDimension" })
  {
    if (entries.GetText(dimension, dimensions) != dimensions)
    {
      error = std::string("the entry (") + dimension + " ...) is not " + std::string(dimensions);
      return false;
    }
  }
  if (isStack && !SetStack(entries, transform, error))
  {
    return false;
  }
  if (entries.GetText("UseBinaryFormatForTransformationParameters", "false") != "false")
  {
    error = "the parameters are in a binary file of their own; run elastix with "
            "(UseBinaryFormatForTransformationParameters \"false\")";
    return false;
  }
  const std::string_view combine = entries.GetText("HowToCombineTransforms", "Compose");
  if (combine != "Compose" && combine != "Add")
  {
    error = "the entry (HowToCombineTransforms ...) is " + Quote(combine) +
      ", not \"Compose\" or \"Add\"";
    return false;
  }
  transform.Add = combine == "Add";
  // Renamed in elastix 5.1.
  const std::string_view initial = entries.GetText("InitialTransformParameterFileName",
    entries.GetText("InitialTransformParametersFileName", "NoInitialTransform"));
  if (initial != "NoInitialTransform")
  {
    transform.InitialFile = std::string(initial);
  }

  std::string domainError;
  if (!entries.GetGrid("", isStack ? 4 : 3, transform.FixedImage, domainError) ||
    !FindGridProblem(transform.FixedImage, 1).empty())
  {
    transform.FixedImage = TransformGrid(); // only linear transforms do without
  }
  if (type == "File")
  {
    transform.TransformFile = std::string(entries.GetText("TransformFileName", ""));
    error = transform.TransformFile.empty() ? "there is no entry (TransformFileName ...)" : "";
    return error.empty();
  }
  std::vector<double> parameters;
  if (isStack && stackIndex >= transform.StackSize)
  {
    error = "it has " + std::to_string(transform.StackSize) + " steps, and none of index " +
      std::to_string(stackIndex);
    return false;
  }
  if (isStack && entries.Has("TransformParameters")
      ? !TakeStackStep(entries.GetText("TransformParameters", ""), transform.StackSize, stackIndex,
          parameters, error)
      : !entries.GetNumbers("TransformParameters", 0, parameters, error))
  {
    return false;
  }
  if (type == "WeightedCombinationTransform")
  {
    return SetCombination(entries, std::move(parameters), transform, error);
  }
  return type == "BSplineTransform" || type == "RecursiveBSplineTransform"
    ? SetSpline(entries, parameters, transform.Step, error)
    : SetLinear(entries, type, parameters, transform.Step, error);
}

//------------------------------------------------------------------------------
std::string FormatElastixTransform(const TransformStep& spline, const TransformGrid& fixedImage)
{
  std::string text = "(Transform \"BSplineTransform\")\n(NumberOfParameters " +
    std::to_string(3 * spline.Values.size()) + ")\n(TransformParameters";
  AppendPlanar(text, spline.Values);
  text += ")\n(InitialTransformParametersFileName \"NoInitialTransform\")\n"
          "(UseBinaryFormatForTransformationParameters \"false\")\n"
          "(HowToCombineTransforms \"Compose\")\n\n"
          "// Image specific\n(FixedImageDimension 3)\n(MovingImageDimension 3)\n"
          "(FixedInternalImagePixelType \"float\")\n(MovingInternalImagePixelType \"float\")\n";
  const auto grid = [&text](const char* prefix, const TransformGrid& g) {
    text += std::string("(") + prefix + "Size";
    AppendSize(text, g.Size);
    text += std::string(")\n(") + prefix + "Index 0 0 0)\n(" + prefix + "Spacing";
    AppendVector(text, g.Spacing);
    text += std::string(")\n(") + prefix + "Origin";
    AppendVector(text, g.Origin);
    text += std::string(")\n(") + prefix + "Direction";
    AppendMatrix(text, glm::transpose(g.Direction));
    text += ")\n";
  };
  grid("", fixedImage);
  text += "(UseDirectionCosines \"true\")\n\n// BSplineTransform specific\n";
  grid("Grid", spline.Grid);
  text += "(BSplineTransformSplineOrder " + std::to_string(spline.Order) +
    ")\n(UseCyclicTransform \"false\")\n\n"
    "// ResampleInterpolator specific\n"
    "(ResampleInterpolator \"FinalBSplineInterpolator\")\n"
    "(FinalBSplineInterpolationOrder 1)\n\n"
    "// Resampler specific\n(Resampler \"DefaultResampler\")\n(DefaultPixelValue 0)\n"
    "(ResultImageFormat \"mhd\")\n(ResultImagePixelType \"float\")\n"
    "(CompressResultImage \"false\")\n";
  return text;
}

} // namespace ffd
