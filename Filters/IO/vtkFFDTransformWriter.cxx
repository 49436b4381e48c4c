// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTransformWriter.h"

#include "vtkFFDBSplineFieldFromTransform.h"
#include "vtkFFDClassicLocale.h"
#include "vtkFFDFileAccess.h"
#include "vtkFFDGuard.h"
#include "vtkFFDLattice.h"
#include "vtkFFDSplineTransform.h"
#include "vtkFFDSumTransform.h"

#include "FFDBSplineField.h"
#include "FFDElastixTransform.h"
#include "FFDFieldHeader.h"
#include "FFDGridIndex.h"
#include "FFDItkTransform.h"
#include "FFDTextNumbers.h"

#include "vtkBSplineTransform.h"
#include "vtkDataArray.h"
#include "vtkGeneralTransform.h"
#include "vtkGridTransform.h"
#include "vtkImageData.h"
#include "vtkLinearTransform.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkXMLImageDataWriter.h"

#include "vtksys/SystemTools.hxx"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <vector>

vtkStandardNewMacro(vtkFFDTransformWriter);

namespace
{

/// Memory of a point of a field: three doubles, and the same again as bytes of the file.
constexpr double BytesPerSample = 48.0;

/// Voxels along the longest side of the image that transformix makes when none is given.
constexpr int DefaultVoxels = 256;

ffd::TransformGrid GetGrid(vtkImageData* image)
{
  ffd::TransformGrid grid;
  int extent[6];
  double spacing[3];
  image->GetExtent(extent);
  image->GetSpacing(spacing);
  for (int a = 0; a < 3; ++a)
  {
    grid.Size[a] = extent[2 * a + 1] - extent[2 * a] + 1;
    grid.Spacing[a] = spacing[a];
    for (int b = 0; b < 3; ++b)
    {
      grid.Direction[a][b] = image->GetDirectionMatrix()->GetElement(b, a);
    }
  }
  double first[3];
  image->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], first);
  grid.Origin = { first[0], first[1], first[2] };
  return grid;
}

/// Why a transform has no form in a file: it is the inverse of what a file can say.
std::string DescribeInverse(vtkAbstractTransform* transform)
{
  return "the " + std::string(transform->GetClassName()) +
    " is inverted (InverseFlag), which only a .vti of a spline can say; fit a lattice to it with "
    "vtkFFDFitLattice";
}

/// A B-spline, not of its inverse, as a step; empty when it can be one, else the reason.
std::string MakeSplineStep(vtkBSplineTransform* spline, bool mayBeInverse, ffd::TransformStep& step)
{
  ffd::BSplineField field;
  bool inverse = false;
  std::string error;
  if (!vtkFFDBSplineFieldFromTransform(spline, field, inverse, error))
  {
    return error;
  }
  if (inverse && !mayBeInverse)
  {
    return DescribeInverse(spline);
  }
  const glm::ivec3 n = field.GetNodes();
  step.Type = ffd::TransformStep::Kind::Spline;
  step.Grid.Size = n;
  step.Grid.Origin = field.GetOrigin();
  step.Grid.Spacing = field.GetSpacing();
  step.Values.clear();
  for (int k = 0; k < n.z; ++k)
  {
    for (int j = 0; j < n.y; ++j)
    {
      for (int i = 0; i < n.x; ++i)
      {
        step.Values.push_back(field.Coefficient(i, j, k));
      }
    }
  }
  return ffd::FindGridProblem(step.Grid, 4);
}

/// Displacements at the nodes of an image, whose direction VTK's transforms do not use.
void SetNodes(vtkImageData* image, double scale, double shift, ffd::TransformStep& step)
{
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  step.Grid = GetGrid(image);
  step.Grid.Direction = glm::dmat3(1.0);
  step.Grid.Origin =
    glm::dvec3(image->GetOrigin()[0], image->GetOrigin()[1], image->GetOrigin()[2]) +
    step.Grid.Spacing *
      glm::dvec3(image->GetExtent()[0], image->GetExtent()[2], image->GetExtent()[4]);
  step.Values.resize(static_cast<std::size_t>(scalars->GetNumberOfTuples()));
  for (std::size_t i = 0; i < step.Values.size(); ++i)
  {
    scalars->GetTuple(static_cast<vtkIdType>(i), &step.Values[i].x);
    step.Values[i] = step.Values[i] * scale + shift;
  }
}

bool HasDisplacements(vtkImageData* image)
{
  vtkDataArray* scalars = image ? image->GetPointData()->GetScalars() : nullptr;
  return scalars && scalars->GetNumberOfComponents() == 3 &&
    scalars->GetNumberOfTuples() == image->GetNumberOfPoints();
}

std::string MakeFieldStep(vtkGridTransform* transform, ffd::TransformStep& step)
{
  if (transform->GetInverseFlag() != 0)
  {
    return DescribeInverse(transform);
  }
  if (transform->GetInterpolationMode() != VTK_LINEAR_INTERPOLATION)
  {
    return "the vtkGridTransform interpolates " +
      std::string(transform->GetInterpolationMode() == VTK_CUBIC_INTERPOLATION ? "cubically"
                                                                               : "by the nearest") +
      ", and fields in files are linear: call SetInterpolationModeToLinear(), fit a lattice to it "
      "with vtkFFDFitLattice, or sample it finely to .mha, .nrrd or .nii with SetReferenceImage()";
  }
  transform->Update();
  vtkImageData* image = transform->GetDisplacementGrid();
  if (!HasDisplacements(image))
  {
    return "the vtkGridTransform has no grid of displacements";
  }
  step.Type = ffd::TransformStep::Kind::Field;
  SetNodes(image, transform->GetDisplacementScale(), transform->GetDisplacementShift(), step);
  return ffd::FindGridProblem(step.Grid, 1);
}

/// A spline of low order as a step.
std::string MakeSplineStep(vtkFFDSplineTransform* transform, ffd::TransformStep& step)
{
  if (transform->GetInverseFlag() != 0)
  {
    return DescribeInverse(transform);
  }
  if (!HasDisplacements(transform->GetDisplacementGrid()))
  {
    return "the vtkFFDSplineTransform has no grid of displacements";
  }
  step.Type = ffd::TransformStep::Kind::Spline;
  step.Order = transform->GetSplineOrder();
  SetNodes(transform->GetDisplacementGrid(), 1.0, 0.0, step);
  return ffd::FindGridProblem(step.Grid, step.Order + 1);
}

/// Why readers would refuse a step: numbers that are not finite or exceed 1e12, a singular matrix.
/// Empty if they would not.
std::string FindStepProblem(const ffd::TransformStep& step)
{
  const auto usable = [](const glm::dvec3& v) {
    return std::abs(v.x) <= ffd::LargestNumber && std::abs(v.y) <= ffd::LargestNumber &&
      std::abs(v.z) <= ffd::LargestNumber;
  };
  if (!usable(step.Matrix[0]) || !usable(step.Matrix[1]) || !usable(step.Matrix[2]) ||
    !usable(step.Offset) || !std::all_of(step.Values.begin(), step.Values.end(), usable))
  {
    return "it has numbers that are not finite, or exceed 1e12";
  }
  return ffd::IsSingular(step) ? "its matrix is singular" : "";
}

/// The chain of steps of a transform, first applied first; empty, or why there is none. A spline
/// that may be an inverse is a step as if it were none.
std::string MakeSteps(
  vtkAbstractTransform* transform, bool mayBeInverse, std::vector<ffd::TransformStep>& steps)
{
  transform->Update();
  if (auto* general = vtkGeneralTransform::SafeDownCast(transform))
  {
    for (int i = 0; i < general->GetNumberOfConcatenatedTransforms(); ++i)
    {
      const std::string problem = MakeSteps(general->GetConcatenatedTransform(i), false, steps);
      if (!problem.empty())
      {
        return problem;
      }
    }
    return std::string();
  }
  ffd::TransformStep step;
  std::string problem;
  if (auto* spline = vtkBSplineTransform::SafeDownCast(transform))
  {
    problem = MakeSplineStep(spline, mayBeInverse, step);
  }
  else if (auto* low = vtkFFDSplineTransform::SafeDownCast(transform))
  {
    problem = MakeSplineStep(low, step);
  }
  else if (auto* grid = vtkGridTransform::SafeDownCast(transform))
  {
    problem = MakeFieldStep(grid, step);
  }
  else if (auto* linear = vtkLinearTransform::SafeDownCast(transform))
  {
    for (int column = 0; column < 3; ++column)
    {
      for (int row = 0; row < 3; ++row)
      {
        step.Matrix[column][row] = linear->GetMatrix()->GetElement(row, column);
      }
      step.Offset[column] = linear->GetMatrix()->GetElement(column, 3);
    }
  }
  else
  {
    problem = "a " + std::string(transform->GetClassName()) +
      " has no form in it; fit a lattice to it with vtkFFDFitLattice";
  }
  problem = problem.empty() ? FindStepProblem(step) : problem;
  steps.push_back(std::move(step));
  return steps.size() > ffd::LargestChain ? "it is a chain of more than 64 transforms" : problem;
}

/**
 * Why a transform is not what its numbers say: VTK's transforms, and ours, take what is not finite
 * for the identity, or pass it on at some points only. Empty: no such reason.
 */
std::string FindHiddenProblem(vtkAbstractTransform* transform)
{
  ffd::TransformStep step;
  bool inverse = false;
  std::string problem;
  ffd::BSplineField field;
  if (auto* general = vtkGeneralTransform::SafeDownCast(transform))
  {
    for (int i = 0; i < general->GetNumberOfConcatenatedTransforms() && problem.empty(); ++i)
    {
      problem = FindHiddenProblem(general->GetConcatenatedTransform(i));
    }
  }
  else if (auto* sum = vtkFFDSumTransform::SafeDownCast(transform))
  {
    for (int i = 0; i < sum->GetNumberOfTransforms() && problem.empty(); ++i)
    {
      problem = FindHiddenProblem(sum->GetTransform(i));
    }
  }
  else if (auto* spline = vtkBSplineTransform::SafeDownCast(transform))
  {
    vtkFFDBSplineFieldFromTransform(spline, field, inverse, problem);
  }
  else if (auto* low = vtkFFDSplineTransform::SafeDownCast(transform))
  {
    if (HasDisplacements(low->GetDisplacementGrid()))
    {
      SetNodes(low->GetDisplacementGrid(), 1.0, 0.0, step);
      problem = FindStepProblem(step);
    }
  }
  else if (auto* grid = vtkGridTransform::SafeDownCast(transform))
  {
    grid->Update();
    if (HasDisplacements(grid->GetDisplacementGrid()))
    {
      SetNodes(grid->GetDisplacementGrid(), grid->GetDisplacementScale(),
        grid->GetDisplacementShift(), step);
      problem = FindStepProblem(step);
    }
  }
  return problem;
}

glm::dvec3 Displace(vtkAbstractTransform* transform, const glm::dvec3& p)
{
  glm::dvec3 q;
  transform->InternalTransformPoint(&p.x, &q.x);
  return q - p;
}

/// Displacements at the nodes of a grid; empty, or what is wrong with them.
std::string SampleField(vtkAbstractTransform* transform, ffd::TransformStep& step)
{
  const ffd::TransformGrid& grid = step.Grid;
  const std::size_t count = ffd::GridSize(grid.Size);
  if (count > ffd::LargestField)
  {
    return "the reference image has more than 2^27 points";
  }
  const std::string hidden = FindHiddenProblem(transform);
  if (!hidden.empty())
  {
    return hidden;
  }
  vtkFFDRequireMemory(BytesPerSample * static_cast<double>(count),
    "The displacements at " + std::to_string(count) + " points", "Give a coarser ReferenceImage.");
  step.Type = ffd::TransformStep::Kind::Field;
  step.Values.clear();
  step.Values.reserve(count);
  transform->Update();
  glm::ivec3 i;
  for (i.z = 0; i.z < grid.Size.z; ++i.z)
  {
    for (i.y = 0; i.y < grid.Size.y; ++i.y)
    {
      for (i.x = 0; i.x < grid.Size.x; ++i.x)
      {
        step.Values.push_back(
          Displace(transform, grid.Origin + grid.Direction * (glm::dvec3(i) * grid.Spacing)));
      }
    }
  }
  return FindStepProblem(step).empty()
    ? ""
    : "the transform gives displacements that are not finite, or exceed 1e12, in the reference "
      "image";
}

/// Largest distance of the transform from the field, interpolated linearly, at centers of cells.
double MeasureError(vtkAbstractTransform* transform, const ffd::TransformStep& step)
{
  const ffd::TransformGrid& grid = step.Grid;
  const glm::ivec3 size = grid.Size;
  double largest = 0.0;
  glm::ivec3 i;
  // Along an axis of one node there are no cells between nodes, but the node itself.
  const glm::ivec3 next(size.x > 1, size.y > 1, size.z > 1);
  for (i.z = 0; i.z < std::max(size.z - 1, 1); ++i.z)
  {
    for (i.y = 0; i.y < std::max(size.y - 1, 1); ++i.y)
    {
      for (i.x = 0; i.x < std::max(size.x - 1, 1); ++i.x)
      {
        glm::dvec3 mean(0.0);
        for (int corner = 0; corner < 8; ++corner)
        {
          const glm::ivec3 n =
            i + next * glm::ivec3(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
          mean += 0.125 * step.Values[ffd::GridIndex(n, size)];
        }
        const glm::dvec3 index = glm::dvec3(i) + 0.5 * glm::dvec3(next);
        const glm::dvec3 exact =
          Displace(transform, grid.Origin + grid.Direction * (index * grid.Spacing));
        largest = std::max(largest, glm::length(exact - mean));
      }
    }
  }
  return largest;
}

/// Little endian doubles, interleaved or planar.
std::string EncodeField(const std::vector<glm::dvec3>& values, bool planar)
{
  std::string bytes(24 * values.size(), '\0');
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    for (std::size_t a = 0; a < 3; ++a)
    {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &values[i][static_cast<int>(a)], sizeof(bits));
      const std::size_t at = 8 * (planar ? a * values.size() + i : 3 * i + a);
      for (std::size_t b = 0; b < 8; ++b)
      {
        bytes[at + b] = static_cast<char>((bits >> (8 * b)) & 255u);
      }
    }
  }
  return bytes;
}

/// The .vti text of a spline.
std::string FormatLattice(vtkBSplineTransform* spline, std::string& text)
{
  vtkNew<vtkFFDLattice> lattice;
  if (vtkFFDLattice::SafeDownCast(spline))
  {
    lattice->DeepCopy(spline);
  }
  else
  {
    lattice->SetBorderMode(spline->GetBorderMode());
    lattice->SetDisplacementScale(spline->GetDisplacementScale());
    lattice->FromImageData(spline->GetCoefficientData());
    if (spline->GetInverseFlag() != 0)
    {
      lattice->Inverse();
    }
  }
  vtkNew<vtkImageData> image;
  vtkNew<vtkXMLImageDataWriter> writer;
  writer->SetInputData(image);
  writer->WriteToOutputStringOn();
  writer->SetDataModeToBinary(); // ParaView 5.11 cannot read raw data with newer versions of expat
  if (!lattice->ToImageData(image) || !writer->Write())
  {
    return "the lattice could not be made into an image";
  }
  text = writer->GetOutputString();
  return std::string();
}

/// An image over the region where all control points of a spline exist.
ffd::TransformGrid MakeDomain(const ffd::TransformStep& spline)
{
  const ffd::TransformGrid& grid = spline.Grid;
  const glm::dvec3 length = glm::dvec3(grid.Size - spline.Order) * grid.Spacing;
  const double longest = std::max({ length.x, length.y, length.z });
  ffd::TransformGrid image = grid;
  image.Origin = grid.Origin + grid.Direction * (0.5 * (spline.Order - 1) * grid.Spacing);
  image.Spacing = glm::dvec3(longest / (DefaultVoxels - 1));
  for (int a = 0; a < 3; ++a)
  {
    image.Size[a] = 1 + static_cast<int>(length[a] / image.Spacing[a] + 0.5);
  }
  return image;
}

int FormatOf(const std::string& fileName)
{
  const std::string name = vtksys::SystemTools::GetFilenameName(fileName);
  const std::string suffix =
    vtksys::SystemTools::LowerCase(vtksys::SystemTools::GetFilenameLastExtension(name));
  if (suffix == ".txt")
  {
    return name.rfind("TransformParameters", 0) == 0 ? vtkFFDTransformWriter::ELASTIX
                                                     : vtkFFDTransformWriter::ITK_TEXT;
  }
  return suffix == ".tfm"                  ? vtkFFDTransformWriter::ITK_TEXT
    : suffix == ".mha" || suffix == ".mhd" ? vtkFFDTransformWriter::META_IMAGE
    : suffix == ".nrrd"                    ? vtkFFDTransformWriter::NRRD
    : suffix == ".nii"                     ? vtkFFDTransformWriter::NIFTI
    : suffix == ".vti"                     ? vtkFFDTransformWriter::LATTICE
                                           : vtkFFDTransformWriter::BY_NAME;
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDTransformWriter::vtkFFDTransformWriter()
  : FileName(nullptr)
  , Coordinates(LPS)
  , FileFormat(BY_NAME)
  , FieldTolerance(0.1)
  , FieldError(0.0)
{
}

//------------------------------------------------------------------------------
vtkFFDTransformWriter::~vtkFFDTransformWriter() { this->SetFileName(nullptr); }

//------------------------------------------------------------------------------
void vtkFFDTransformWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "Coordinates: " << (this->Coordinates == LPS ? "LPS" : "RAS") << "\n";
  os << indent << "FileFormat: " << this->FileFormat << "\n";
  os << indent << "FieldTolerance: " << this->FieldTolerance << "\n";
  os << indent << "FieldError: " << this->FieldError << "\n";
  os << indent << "Transform: " << (this->Transform ? this->Transform->GetClassName() : "(none)")
     << "\n";
  os << indent << "ReferenceImage: " << (this->ReferenceImage ? "given" : "(none)") << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDTransformWriter::SetTransform(vtkAbstractTransform* transform)
{
  if (this->Transform != transform)
  {
    this->Transform = transform;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDTransformWriter::GetTransform() { return this->Transform; }

//------------------------------------------------------------------------------
void vtkFFDTransformWriter::SetReferenceImage(vtkImageData* image)
{
  if (this->ReferenceImage != image)
  {
    this->ReferenceImage = image;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkImageData* vtkFFDTransformWriter::GetReferenceImage() { return this->ReferenceImage; }

//------------------------------------------------------------------------------
void vtkFFDTransformWriter::SetCoordinates(int coordinates)
{
  if (coordinates != LPS && coordinates != RAS)
  {
    vtkErrorMacro("SetCoordinates: " << coordinates << " is no system. Give LPS or RAS.");
    return;
  }
  if (this->Coordinates != coordinates)
  {
    this->Coordinates = coordinates;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformWriter::SetFileFormat(int format)
{
  if (format < BY_NAME || format > LATTICE)
  {
    vtkErrorMacro("SetFileFormat: " << format << " is no format. Give one of FileFormatType.");
    return;
  }
  if (this->FileFormat != format)
  {
    this->FileFormat = format;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDTransformWriter::SetFieldTolerance(double tolerance)
{
  if (!(tolerance >= 0.0) || !std::isfinite(tolerance))
  {
    vtkErrorMacro(
      "SetFieldTolerance: the tolerance is " << tolerance << ". Give a distance, 0 or more.");
    return;
  }
  if (this->FieldTolerance != tolerance)
  {
    this->FieldTolerance = tolerance;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDTransformWriter::Write()
{
  this->FieldError = 0.0;
  if (!this->FileName || !*this->FileName || !this->Transform)
  {
    vtkErrorMacro("Write: there is no "
      << (this->Transform ? "file name. Call SetFileName()." : "transform. Call SetTransform()."));
    return 0;
  }
  const vtkFFDClassicLocale numbers;
  std::string problem;
  if (!vtkFFDGuard(this, "Write", [&] { problem = this->WriteTransform(); }))
  {
    return 0;
  }
  if (!problem.empty())
  {
    vtkErrorMacro("Write: " << this->FileName << " cannot be written: " << problem << ".");
    return 0;
  }
  if (this->FieldError > this->FieldTolerance)
  {
    vtkWarningMacro("The field in "
      << this->FileName << ", which programs interpolate linearly, is up to " << this->FieldError
      << " away from the " << this->Transform->GetClassName()
      << " between its points, more than the FieldTolerance of " << this->FieldTolerance
      << ". Give a finer ReferenceImage.");
  }
  return 1;
}

//------------------------------------------------------------------------------
std::string vtkFFDTransformWriter::WriteTransform()
{
  const std::string name = this->FileName;
  const int format = this->FileFormat == BY_NAME ? FormatOf(name) : this->FileFormat;
  if (format == BY_NAME)
  {
    return "its suffix is not .tfm, .txt, .mha, .mhd, .nrrd, .nii or .vti. Call SetFileFormat()";
  }
  ffd::TransformGrid reference;
  if (this->ReferenceImage)
  {
    reference = GetGrid(this->ReferenceImage);
    const std::string problem = ffd::FindGridProblem(reference, 1);
    if (!problem.empty())
    {
      return "the reference image is not usable: " + problem;
    }
  }
  std::string head;
  std::string data;
  std::string dataName;
  const std::string problem = format == META_IMAGE || format == NRRD || format == NIFTI
    ? this->FormatField(format, reference, head, data, dataName)
    : this->FormatSteps(format, reference, head);
  if (!problem.empty())
  {
    return problem;
  }
  // The data first: a header that is there names data that are there.
  std::string error;
  vtkFFDFileAccess::Replacement dataFile;
  if (!dataName.empty())
  {
    if (!dataFile.Write(dataName, std::string(), data, error))
    {
      return error;
    }
    data.clear();
  }
  vtkFFDFileAccess::Replacement file;
  if (!file.Write(name, head, data, error) || (!dataName.empty() && !dataFile.Commit(error)) ||
    !file.Commit(error))
  {
    return error;
  }
  return std::string();
}

//------------------------------------------------------------------------------
std::string vtkFFDTransformWriter::FormatField(int format, const ffd::TransformGrid& reference,
  std::string& head, std::string& data, std::string& dataName)
{
  if (!this->ReferenceImage)
  {
    return "a displacement field needs the points to sample. Call SetReferenceImage()";
  }
  ffd::TransformStep field;
  field.Grid = reference;
  const std::string problem = SampleField(this->Transform, field);
  if (!problem.empty())
  {
    return problem;
  }
  this->FieldError = MeasureError(this->Transform, field);
  if (this->Coordinates == RAS)
  {
    ffd::FlipTransformStep(field);
  }
  const std::string name = this->FileName;
  if (format == NRRD)
  {
    head = ffd::FormatNrrdHeader(field.Grid);
  }
  else if (format == NIFTI)
  {
    head = ffd::FormatNiftiHeader(field.Grid);
  }
  else
  {
    const bool detached =
      vtksys::SystemTools::LowerCase(vtksys::SystemTools::GetFilenameLastExtension(name)) == ".mhd";
    const std::filesystem::path path(name); // vtksys takes a backslash for a slash
    std::string plain = path.stem().string() + ".raw";
    if (detached && ffd::CanNameDataFile(plain))
    {
      dataName = (path.parent_path() / plain).string();
    }
    else
    {
      plain.clear();
    }
    head = ffd::FormatMetaImageHeader(field.Grid, plain);
  }
  data = EncodeField(field.Values, format == NIFTI);
  return std::string();
}

//------------------------------------------------------------------------------
std::string vtkFFDTransformWriter::FormatSteps(
  int format, const ffd::TransformGrid& reference, std::string& head)
{
  std::vector<ffd::TransformStep> steps;
  const std::string problem = MakeSteps(this->Transform, format == LATTICE, steps);
  if (!problem.empty())
  {
    return problem;
  }
  auto* const spline = vtkBSplineTransform::SafeDownCast(this->Transform);
  if (format == LATTICE ? !spline
                        : format == ELASTIX &&
        (steps.size() != 1 || steps[0].Type != ffd::TransformStep::Kind::Spline))
  {
    return "this format holds one spline, not a " + std::string(this->Transform->GetClassName()) +
      "; fit a lattice with vtkFFDFitLattice";
  }
  if (format == LATTICE)
  {
    return FormatLattice(spline, head);
  }
  if (this->Coordinates == RAS)
  {
    for (ffd::TransformStep& step : steps)
    {
      ffd::FlipTransformStep(step);
    }
  }
  if (format == ITK_TEXT)
  {
    head = ffd::FormatItkTransform(steps);
    return std::string();
  }
  ffd::TransformStep image; // what transformix is to make
  image.Type = ffd::TransformStep::Kind::Field;
  image.Grid = this->ReferenceImage ? reference : MakeDomain(steps[0]);
  if (this->ReferenceImage && this->Coordinates == RAS)
  {
    ffd::FlipTransformStep(image);
  }
  head = ffd::FormatElastixTransform(steps[0], image.Grid);
  return std::string();
}
