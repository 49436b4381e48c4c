// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDTransformFile.h"

#include "FFDSingularMatrix.h"
#include "FFDTextNumbers.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace ffd
{
namespace
{

constexpr int SmallestNet = 4; // control points of one cubic cell
constexpr int LargestGrid = 1024;
constexpr double DirectionTolerance = 1e-3;
constexpr std::size_t MaximumSteps = 64;

glm::dvec3 VectorAt(const std::vector<double>& values, std::size_t first)
{
  return { values[first], values[first + 1], values[first + 2] };
}

/// Nine numbers, row by row.
glm::dmat3 MatrixAt(const std::vector<double>& values, std::size_t first)
{
  glm::dmat3 matrix(1.0);
  for (std::size_t row = 0; row < 3; ++row)
  {
    for (std::size_t column = 0; column < 3; ++column)
    {
      matrix[static_cast<int>(column)][static_cast<int>(row)] = values[first + 3 * row + column];
    }
  }
  return matrix;
}

bool SizeAt(const std::vector<double>& values, std::size_t first, glm::ivec3& size)
{
  for (int a = 0; a < 3; ++a)
  {
    const double n = values[first + static_cast<std::size_t>(a)];
    if (!(n >= 1.0 && n <= 1e9) || n != std::floor(n))
    {
      return false;
    }
    size[a] = static_cast<int>(n);
  }
  return true;
}

std::size_t CountNodes(const glm::ivec3& size)
{
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
    static_cast<std::size_t>(size.z);
}

/// x -> matrix (x - center) + center + translation.
void SetCentered(TransformStep& step, const glm::dmat3& matrix, const glm::dvec3& center,
  const glm::dvec3& translation)
{
  step.Type = TransformStep::Kind::Linear;
  step.Matrix = matrix;
  step.Offset = center + translation - matrix * center;
}

/// Rotation by angles about x, y and z: Rz Rx Ry, or Rz Ry Rx, as itk::Euler3DTransform.
glm::dmat3 EulerMatrix(const glm::dvec3& angles, bool zyx)
{
  const glm::dvec3 c(std::cos(angles.x), std::cos(angles.y), std::cos(angles.z));
  const glm::dvec3 s(std::sin(angles.x), std::sin(angles.y), std::sin(angles.z));
  // Columns.
  const glm::dmat3 rx(1.0, 0.0, 0.0, 0.0, c.x, s.x, 0.0, -s.x, c.x);
  const glm::dmat3 ry(c.y, 0.0, -s.y, 0.0, 1.0, 0.0, s.y, 0.0, c.y);
  const glm::dmat3 rz(c.z, s.z, 0.0, -s.z, c.z, 0.0, 0.0, 0.0, 1.0);
  return zyx ? rz * ry * rx : rz * rx * ry;
}

/// Rotation of the unit quaternion with this vector part (a "versor").
bool VersorMatrix(const glm::dvec3& v, glm::dmat3& matrix)
{
  const double square = v.x * v.x + v.y * v.y + v.z * v.z;
  if (square > 1.0 + 1e-9)
  {
    return false;
  }
  const double w = std::sqrt(std::max(0.0, 1.0 - square));
  matrix = glm::dmat3(1.0 - 2.0 * (v.y * v.y + v.z * v.z), 2.0 * (v.x * v.y + v.z * w),
    2.0 * (v.x * v.z - v.y * w), 2.0 * (v.x * v.y - v.z * w),
    1.0 - 2.0 * (v.x * v.x + v.z * v.z), 2.0 * (v.y * v.z + v.x * w),
    2.0 * (v.x * v.z + v.y * w), 2.0 * (v.y * v.z - v.x * w),
    1.0 - 2.0 * (v.x * v.x + v.y * v.y));
  return true;
}

/// Values of a grid step; `planar`: all x, then all y, then all z, as ITK keeps coefficients.
bool SetGridStep(TransformStep& step, TransformStep::Kind kind, const TransformGrid& grid,
  const std::vector<double>& parameters, bool planar, std::string& error)
{
  const bool spline = kind == TransformStep::Kind::Spline;
  error = FindGridProblem(grid, spline ? SmallestNet : 1);
  if (!error.empty())
  {
    return false;
  }
  const std::size_t count = CountNodes(grid.Size);
  if (!HasCount(parameters, 3 * count, "the list of parameters", error))
  {
    error += " for a grid of " + std::to_string(grid.Size.x) + " x " + std::to_string(grid.Size.y) +
      " x " + std::to_string(grid.Size.z) + " nodes";
    return false;
  }
  step.Type = kind;
  step.Grid = grid;
  step.Values.resize(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    step.Values[i] = planar
      ? glm::dvec3(parameters[i], parameters[count + i], parameters[2 * count + i])
      : VectorAt(parameters, 3 * i);
  }
  return true;
}

/// A linear step by ITK's name for it; `known` is false for another name.
bool SetLinearStep(TransformStep& step, std::string_view name, const std::vector<double>& p,
  const std::vector<double>& fixed, bool& known, std::string& error)
{
  known = true;
  const auto center = [&fixed]
  { return fixed.size() >= 3 ? VectorAt(fixed, 0) : glm::dvec3(0.0); };
  if (name == "IdentityTransform")
  {
    SetCentered(step, glm::dmat3(1.0), glm::dvec3(0.0), glm::dvec3(0.0));
    return true;
  }
  if (name == "TranslationTransform")
  {
    if (!HasCount(p, 3, "the list of parameters of a translation", error))
    {
      return false;
    }
    SetCentered(step, glm::dmat3(1.0), glm::dvec3(0.0), VectorAt(p, 0));
    return true;
  }
  if (name == "AffineTransform" || name == "MatrixOffsetTransformBase")
  {
    if (!HasCount(p, 12, "the list of parameters of an affine transform", error))
    {
      return false;
    }
    SetCentered(step, MatrixAt(p, 0), center(), VectorAt(p, 9));
    return true;
  }
  if (name == "Euler3DTransform")
  {
    if (!HasCount(p, 6, "the list of parameters of an Euler transform", error))
    {
      return false;
    }
    const bool zyx = fixed.size() >= 4 && fixed[3] != 0.0;
    SetCentered(step, EulerMatrix(VectorAt(p, 0), zyx), center(), VectorAt(p, 3));
    return true;
  }
  if (name == "VersorRigid3DTransform" || name == "Similarity3DTransform")
  {
    const bool similarity = name == "Similarity3DTransform";
    if (!HasCount(p, similarity ? 7 : 6, "the list of parameters of a versor transform", error))
    {
      return false;
    }
    glm::dmat3 rotation(1.0);
    if (!VersorMatrix(VectorAt(p, 0), rotation))
    {
      error = "the versor (the first three parameters) is longer than 1";
      return false;
    }
    SetCentered(step, rotation * (similarity ? p[6] : 1.0), center(), VectorAt(p, 3));
    return true;
  }
  known = false;
  return true;
}

/// A collapsed map has no inverse, and nothing can be shown through it.
bool IsSingular(const TransformStep& step)
{
  return step.Type == TransformStep::Kind::Linear && ffd::IsSingular(step.Matrix);
}

void AppendVector(std::string& text, const glm::dvec3& v)
{
  for (int a = 0; a < 3; ++a)
  {
    text += ' ';
    AppendNumber(text, v[a]);
  }
}

/// Row by row.
void AppendMatrix(std::string& text, const glm::dmat3& matrix)
{
  for (int row = 0; row < 3; ++row)
  {
    AppendVector(text, { matrix[0][row], matrix[1][row], matrix[2][row] });
  }
}

void AppendSize(std::string& text, const glm::ivec3& size)
{
  for (int a = 0; a < 3; ++a)
  {
    text += ' ' + std::to_string(size[a]);
  }
}

/// Coefficients, all x, then all y, then all z.
void AppendPlanar(std::string& text, const std::vector<glm::dvec3>& values)
{
  for (int a = 0; a < 3; ++a)
  {
    for (const glm::dvec3& value : values)
    {
      text += ' ';
      AppendNumber(text, value[a]);
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
std::string FindGridProblem(const TransformGrid& grid, int smallest)
{
  for (int a = 0; a < 3; ++a)
  {
    if (grid.Size[a] < smallest || grid.Size[a] > LargestGrid)
    {
      return "the grid has " + std::to_string(grid.Size[a]) + " nodes along axis " +
        std::to_string(a) + ", not from " + std::to_string(smallest) + " to 1024";
    }
    if (!(grid.Spacing[a] >= 1.0 / LargestNumber && grid.Spacing[a] <= LargestNumber))
    {
      return "the spacing of the grid along axis " + std::to_string(a) + " is not positive";
    }
    if (!(std::abs(grid.Origin[a]) <= LargestNumber))
    {
      return "the origin of the grid is not a finite number of at most 1e12";
    }
    for (int b = 0; b < 3; ++b)
    {
      const glm::dvec3& u = grid.Direction[a];
      const glm::dvec3& v = grid.Direction[b];
      const double product = u.x * v.x + u.y * v.y + u.z * v.z;
      if (!(std::abs(product - (a == b ? 1.0 : 0.0)) <= DirectionTolerance))
      {
        return "the directions of the grid are not orthonormal";
      }
    }
  }
  return std::string();
}

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
      if (entries.size() > MaximumSteps)
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
  if (entries.empty())
  {
    error = "there is no transform in it";
    return false;
  }
  const bool composite = entries.front().Type.substr(0, 18) == "CompositeTransform";
  if (!composite && entries.size() > 1)
  {
    error = "there are " + std::to_string(entries.size()) +
      " transforms and no CompositeTransform that says how they go together";
    return false;
  }
  for (std::size_t i = composite ? 1 : 0; i < entries.size(); ++i)
  {
    const Entry& entry = entries[i];
    // Name_precision_dimension_dimension
    const std::size_t bar = entry.Type.find('_');
    const std::string_view name = entry.Type.substr(0, bar);
    const std::string_view rest =
      bar == std::string_view::npos ? std::string_view() : entry.Type.substr(bar);
    if (rest != "_double_3_3" && rest != "_float_3_3")
    {
      error = "the transform is a " + Quote(entry.Type) +
        ", not one of three dimensions (a name that ends in _double_3_3 or _float_3_3)";
      return false;
    }
    std::vector<double> parameters;
    std::vector<double> fixed;
    if (!ReadNumbers(entry.Parameters, "parameter", parameters, error) ||
      !ReadNumbers(entry.Fixed, "fixed parameter", fixed, error))
    {
      return false;
    }
    TransformStep step;
    const bool spline = name == "BSplineTransform" || name == "BSplineDeformableTransform";
    if (spline || name == "DisplacementFieldTransform")
    {
      TransformGrid grid;
      if (!HasCount(fixed, 18, "the list of fixed parameters", error))
      {
        return false;
      }
      if (!SizeAt(fixed, 0, grid.Size))
      {
        error = "the size of the grid (the first three fixed parameters) is no positive integer";
        return false;
      }
      grid.Origin = VectorAt(fixed, 3);
      grid.Spacing = VectorAt(fixed, 6);
      grid.Direction = MatrixAt(fixed, 9);
      if (!SetGridStep(step, spline ? TransformStep::Kind::Spline : TransformStep::Kind::Field,
            grid, parameters, spline, error))
      {
        return false;
      }
    }
    else
    {
      bool known = false;
      if (!SetLinearStep(step, name, parameters, fixed, known, error))
      {
        return false;
      }
      if (!known)
      {
        error = "transforms of the type " + Quote(entry.Type) + " are not supported";
        return false;
      }
    }
    if (IsSingular(step))
    {
      error = "the matrix of a " + Quote(entry.Type) + " is singular";
      return false;
    }
    transform.Steps.push_back(std::move(step));
  }
  // The transform that was added last to a CompositeTransform is applied first.
  transform.Steps = std::vector<TransformStep>(
    std::make_move_iterator(transform.Steps.rbegin()),
    std::make_move_iterator(transform.Steps.rend()));
  return true;
}

//------------------------------------------------------------------------------
bool LooksLikeElastixTransform(std::string_view text)
{
  while (!text.empty())
  {
    const std::string_view line = Trim(TakeLine(text));
    if (line.empty() || line.substr(0, 2) == "//")
    {
      continue;
    }
    return line.front() == '(' && text.find("TransformParameters") != std::string_view::npos;
  }
  return false;
}

//------------------------------------------------------------------------------
namespace
{

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
      const std::size_t end = line.rfind(')');
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

  /// Exactly `count` numbers (0: any).
  bool GetNumbers(const char* name, std::size_t count, std::vector<double>& values,
    std::string& error) const
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

  /// The grid of entries with this prefix ("Grid", or "" for the fixed image).
  bool GetGrid(const std::string& prefix, TransformGrid& grid, std::string& error) const
  {
    std::vector<double> size;
    std::vector<double> index;
    std::vector<double> spacing;
    std::vector<double> origin;
    std::vector<double> direction{ 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 };
    if (!this->GetNumbers((prefix + "Size").c_str(), 3, size, error) ||
      !this->GetNumbers((prefix + "Index").c_str(), 3, index, error) ||
      !this->GetNumbers((prefix + "Spacing").c_str(), 3, spacing, error) ||
      !this->GetNumbers((prefix + "Origin").c_str(), 3, origin, error) ||
      (this->Has(prefix + "Direction") &&
        !this->GetNumbers((prefix + "Direction").c_str(), 9, direction, error)))
    {
      return false;
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

} // namespace

//------------------------------------------------------------------------------
bool ParseElastixTransform(std::string_view text, ElastixTransform& transform, std::string& error)
{
  transform = ElastixTransform();
  error.clear();
  ElastixEntries entries;
  if (!entries.Read(text, error))
  {
    return false;
  }
  for (const char* dimension : { "FixedImageDimension", "MovingImageDimension" })
  {
    if (entries.GetText(dimension, "3") != "3")
    {
      error = std::string("the entry (") + dimension + " ...) is not 3";
      return false;
    }
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

  const std::string_view type = entries.GetText("Transform", "");
  std::vector<double> parameters;
  if (!entries.GetNumbers("TransformParameters", 0, parameters, error))
  {
    return false;
  }
  std::string domainError;
  if (!entries.GetGrid("", transform.FixedImage, domainError) ||
    !FindGridProblem(transform.FixedImage, 1).empty())
  {
    transform.FixedImage = TransformGrid(); // only linear transforms do without
  }

  if (type == "BSplineTransform" || type == "RecursiveBSplineTransform")
  {
    if (entries.GetText("BSplineTransformSplineOrder", "3") != "3")
    {
      error = "the spline is not cubic: the entry (BSplineTransformSplineOrder ...) must be 3";
      return false;
    }
    if (entries.GetText("UseCyclicTransform", "false") != "false")
    {
      error = "cyclic splines (UseCyclicTransform) are not supported";
      return false;
    }
    TransformGrid grid;
    return entries.GetGrid("Grid", grid, error) &&
      SetGridStep(
        transform.Step, TransformStep::Kind::Spline, grid, parameters, true, error);
  }
  std::vector<double> fixed;
  if (entries.Has("CenterOfRotationPoint") &&
    !entries.GetNumbers("CenterOfRotationPoint", 3, fixed, error))
  {
    return false;
  }
  const std::map<std::string_view, std::string_view> itkNames = {
    { "AffineTransform", "AffineTransform" }, { "EulerTransform", "Euler3DTransform" },
    { "SimilarityTransform", "Similarity3DTransform" },
    { "TranslationTransform", "TranslationTransform" }
  };
  const auto itkName = itkNames.find(type);
  if (itkName == itkNames.end())
  {
    error = "transforms of the type " + Quote(type) + " are not supported";
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
  bool known = false;
  if (!SetLinearStep(transform.Step, itkName->second, parameters, fixed, known, error))
  {
    return false;
  }
  if (IsSingular(transform.Step))
  {
    error = "the matrix of the " + Quote(type) + " is singular";
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
std::string FormatItkTransform(const std::vector<TransformStep>& steps)
{
  std::string text = "#Insight Transform File V1.0\n";
  int number = 0;
  if (steps.size() != 1)
  {
    text += "#Transform " + std::to_string(number++) + "\nTransform: CompositeTransform_double_3_3\n";
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
    text += "_double_3_3\nParameters:";
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
  const auto grid = [&text](const char* prefix, const TransformGrid& g)
  {
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
  text += "(BSplineTransformSplineOrder 3)\n(UseCyclicTransform \"false\")\n\n"
          "// ResampleInterpolator specific\n"
          "(ResampleInterpolator \"FinalBSplineInterpolator\")\n"
          "(FinalBSplineInterpolationOrder 1)\n\n"
          "// Resampler specific\n(Resampler \"DefaultResampler\")\n(DefaultPixelValue 0)\n"
          "(ResultImageFormat \"mhd\")\n(ResultImagePixelType \"float\")\n"
          "(CompressResultImage \"false\")\n";
  return text;
}

//------------------------------------------------------------------------------
void FlipTransformStep(TransformStep& step)
{
  const glm::dvec3 flip(-1.0, -1.0, 1.0);
  if (step.Type == TransformStep::Kind::Linear)
  {
    for (int column = 0; column < 3; ++column)
    {
      step.Matrix[column] *= flip * flip[column];
    }
    step.Offset *= flip;
    return;
  }
  step.Grid.Origin *= flip;
  for (int column = 0; column < 3; ++column)
  {
    step.Grid.Direction[column] *= flip;
  }
  for (glm::dvec3& value : step.Values)
  {
    value *= flip;
  }
}

//------------------------------------------------------------------------------
bool AlignTransformStep(TransformStep& step)
{
  // Axis a of the grid runs along axis target[a] of space.
  constexpr double tolerance = 1e-12;
  const TransformGrid& old = step.Grid;
  glm::ivec3 target(-1);
  glm::ivec3 used(0);
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      const double entry = std::abs(old.Direction[a][b]);
      if (std::abs(entry - 1.0) <= tolerance)
      {
        target[a] = b;
        ++used[b];
      }
      else if (entry > tolerance)
      {
        return false;
      }
    }
    if (target[a] < 0)
    {
      return false;
    }
  }
  if (used != glm::ivec3(1))
  {
    return false;
  }
  TransformGrid grid;
  grid.Origin = old.Origin;
  glm::ivec3 reversed(0);
  for (int a = 0; a < 3; ++a)
  {
    const int b = target[a];
    grid.Size[b] = old.Size[a];
    grid.Spacing[b] = old.Spacing[a];
    if (old.Direction[a][b] < 0.0)
    {
      reversed[a] = 1;
      grid.Origin[b] -= (old.Size[a] - 1) * old.Spacing[a];
    }
  }
  std::vector<glm::dvec3> values(step.Values.size());
  std::size_t from = 0;
  glm::ivec3 i;
  for (i.z = 0; i.z < old.Size.z; ++i.z)
  {
    for (i.y = 0; i.y < old.Size.y; ++i.y)
    {
      for (i.x = 0; i.x < old.Size.x; ++i.x)
      {
        glm::ivec3 to;
        for (int a = 0; a < 3; ++a)
        {
          to[target[a]] = reversed[a] ? old.Size[a] - 1 - i[a] : i[a];
        }
        values[static_cast<std::size_t>(to.x) +
          static_cast<std::size_t>(grid.Size.x) *
            (static_cast<std::size_t>(to.y) +
              static_cast<std::size_t>(grid.Size.y) * static_cast<std::size_t>(to.z))] =
          step.Values[from++];
      }
    }
  }
  step.Grid = grid;
  step.Values = std::move(values);
  return true;
}

//------------------------------------------------------------------------------
bool AddTransformStep(TransformStep& a, const TransformStep& b)
{
  using Kind = TransformStep::Kind;
  if (a.Type == Kind::Linear && b.Type == Kind::Linear)
  {
    a.Matrix += b.Matrix - glm::dmat3(1.0);
    a.Offset += b.Offset;
    return true;
  }
  if (a.Type == Kind::Field || b.Type == Kind::Field || a.Type == b.Type)
  {
    return false;
  }
  TransformStep spline = a.Type == Kind::Spline ? a : b;
  const TransformStep& linear = a.Type == Kind::Spline ? b : a;
  // B-splines have linear precision: a linear displacement of the control points is one of space.
  const glm::dmat3 matrix = linear.Matrix - glm::dmat3(1.0);
  std::size_t id = 0;
  glm::ivec3 i;
  for (i.z = 0; i.z < spline.Grid.Size.z; ++i.z)
  {
    for (i.y = 0; i.y < spline.Grid.Size.y; ++i.y)
    {
      for (i.x = 0; i.x < spline.Grid.Size.x; ++i.x)
      {
        const glm::dvec3 node =
          spline.Grid.Origin + spline.Grid.Direction * (glm::dvec3(i) * spline.Grid.Spacing);
        spline.Values[id++] += matrix * node + linear.Offset;
      }
    }
  }
  spline.IsSum = true;
  a = std::move(spline);
  return true;
}

} // namespace ffd
