// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTransformWriter.h"

#include "vtkFFDBSplineFieldFromTransform.h"
#include "vtkFFDLattice.h"

#include "FFDBSplineField.h"
#include "FFDFieldHeader.h"
#include "FFDTransformFile.h"

#include "vtkBSplineTransform.h"
#include "vtkDataArray.h"
#include "vtkErrorCode.h"
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

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <vector>

vtkStandardNewMacro(vtkFFDTransformWriter);

namespace
{

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

/// A B-spline as a step; empty when it can be one, else the reason.
std::string MakeSplineStep(vtkBSplineTransform* spline, ffd::TransformStep& step)
{
  ffd::BSplineField field;
  bool inverse = false;
  std::string error;
  if (!vtkFFDBSplineFieldFromTransform(spline, field, inverse, error))
  {
    return error;
  }
  if (inverse)
  {
    return "the " + std::string(spline->GetClassName()) +
      " is inverted (InverseFlag), which no file can say; fit a lattice to it with "
      "vtkFFDFitLattice";
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

std::string MakeFieldStep(vtkGridTransform* transform, ffd::TransformStep& step)
{
  if (transform->GetInverseFlag() != 0)
  {
    return "the vtkGridTransform is inverted, which no file can say; fit a lattice to it with "
           "vtkFFDFitLattice";
  }
  transform->Update();
  vtkImageData* image = transform->GetDisplacementGrid();
  vtkDataArray* scalars = image ? image->GetPointData()->GetScalars() : nullptr;
  if (!scalars || scalars->GetNumberOfComponents() != 3)
  {
    return "the vtkGridTransform has no grid of displacements";
  }
  step.Type = ffd::TransformStep::Kind::Field;
  step.Grid = GetGrid(image);
  step.Grid.Direction = glm::dmat3(1.0); // vtkGridTransform knows of none
  step.Grid.Origin = glm::dvec3(image->GetOrigin()[0], image->GetOrigin()[1],
                       image->GetOrigin()[2]) +
    step.Grid.Spacing *
      glm::dvec3(image->GetExtent()[0], image->GetExtent()[2], image->GetExtent()[4]);
  step.Values.resize(static_cast<std::size_t>(scalars->GetNumberOfTuples()));
  for (std::size_t i = 0; i < step.Values.size(); ++i)
  {
    double tuple[3];
    scalars->GetTuple(static_cast<vtkIdType>(i), tuple);
    for (int a = 0; a < 3; ++a)
    {
      step.Values[i][a] =
        tuple[a] * transform->GetDisplacementScale() + transform->GetDisplacementShift();
    }
  }
  return ffd::FindGridProblem(step.Grid, 1);
}

/// The chain of steps of a transform, first applied first; empty, or why there is none.
std::string MakeSteps(vtkAbstractTransform* transform, std::vector<ffd::TransformStep>& steps)
{
  transform->Update();
  if (auto* general = vtkGeneralTransform::SafeDownCast(transform))
  {
    for (int i = 0; i < general->GetNumberOfConcatenatedTransforms(); ++i)
    {
      const std::string problem = MakeSteps(general->GetConcatenatedTransform(i), steps);
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
    problem = MakeSplineStep(spline, step);
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
  steps.push_back(std::move(step));
  return problem;
}

/// Displacements at the nodes of a grid.
bool SampleField(vtkAbstractTransform* transform, ffd::TransformStep& step)
{
  const ffd::TransformGrid& grid = step.Grid;
  step.Type = ffd::TransformStep::Kind::Field;
  step.Values.clear();
  transform->Update();
  glm::ivec3 i;
  for (i.z = 0; i.z < grid.Size.z; ++i.z)
  {
    for (i.y = 0; i.y < grid.Size.y; ++i.y)
    {
      for (i.x = 0; i.x < grid.Size.x; ++i.x)
      {
        const glm::dvec3 p = grid.Origin + grid.Direction * (glm::dvec3(i) * grid.Spacing);
        glm::dvec3 q;
        transform->InternalTransformPoint(&p.x, &q.x);
        step.Values.push_back(q - p);
        const glm::dvec3& d = step.Values.back();
        if (!(std::abs(d.x) <= 1e12 && std::abs(d.y) <= 1e12 && std::abs(d.z) <= 1e12))
        {
          return false;
        }
      }
    }
  }
  return true;
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

bool WriteFile(const std::string& name, const std::string& head, const std::string& data)
{
  std::ofstream stream(name, std::ios::binary | std::ios::trunc);
  stream.write(head.data(), static_cast<std::streamsize>(head.size()));
  stream.write(data.data(), static_cast<std::streamsize>(data.size()));
  stream.close();
  return !stream.fail();
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
  return suffix == ".tfm"                   ? vtkFFDTransformWriter::ITK_TEXT
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
{
}

//------------------------------------------------------------------------------
vtkFFDTransformWriter::~vtkFFDTransformWriter()
{
  this->SetFileName(nullptr);
}

//------------------------------------------------------------------------------
void vtkFFDTransformWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "Coordinates: " << (this->Coordinates == LPS ? "LPS" : "RAS") << "\n";
  os << indent << "FileFormat: " << this->FileFormat << "\n";
  os << indent << "Transform: "
     << (this->Transform ? this->Transform->GetClassName() : "(none)") << "\n";
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
vtkAbstractTransform* vtkFFDTransformWriter::GetTransform()
{
  return this->Transform;
}

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
vtkImageData* vtkFFDTransformWriter::GetReferenceImage()
{
  return this->ReferenceImage;
}

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
int vtkFFDTransformWriter::Write()
{
  if (!this->FileName || !*this->FileName || !this->Transform)
  {
    vtkErrorMacro("Write: there is no "
      << (this->Transform ? "file name. Call SetFileName()." : "transform. Call SetTransform()."));
    return 0;
  }
  const std::string name = this->FileName;
  const int format = this->FileFormat == BY_NAME ? FormatOf(name) : this->FileFormat;
  const bool ras = this->Coordinates == RAS && format != LATTICE;
  std::vector<ffd::TransformStep> steps;
  std::string problem;
  std::string head;
  std::string data;
  std::string dataName;
  const bool field = format == META_IMAGE || format == NRRD || format == NIFTI;
  ffd::TransformStep reference; // its grid
  reference.Type = ffd::TransformStep::Kind::Field;
  if (this->ReferenceImage)
  {
    reference.Grid = GetGrid(this->ReferenceImage);
    problem = ffd::FindGridProblem(reference.Grid, 1);
    problem = problem.empty() ? problem : "the reference image is not usable: " + problem;
  }
  if (format == BY_NAME)
  {
    problem = "its suffix is not .tfm, .txt, .mha, .mhd, .nrrd, .nii or .vti. Call SetFileFormat()";
  }
  else if (field && !this->ReferenceImage)
  {
    problem = "a displacement field needs the points to sample. Call SetReferenceImage()";
  }
  else if (problem.empty() && field)
  {
    problem = SampleField(this->Transform, reference)
      ? std::string()
      : "the transform gives displacements that are not finite, or exceed 1e12, in the "
        "reference image";
    steps.push_back(reference);
  }
  else if (problem.empty())
  {
    problem = MakeSteps(this->Transform, steps);
    if (problem.empty() && format != ITK_TEXT &&
      (steps.size() != 1 || steps[0].Type != ffd::TransformStep::Kind::Spline))
    {
      problem = "this format holds one spline, not a " +
        std::string(this->Transform->GetClassName()) + "; fit a lattice with vtkFFDFitLattice";
    }
  }
  if (!problem.empty())
  {
    vtkErrorMacro("Write: " << name << " cannot be written: " << problem << ".");
    return 0;
  }
  if (format == LATTICE)
  {
    vtkNew<vtkFFDLattice> lattice;
    if (vtkFFDLattice::SafeDownCast(this->Transform))
    {
      lattice->DeepCopy(this->Transform);
    }
    else
    {
      auto* spline = vtkBSplineTransform::SafeDownCast(this->Transform);
      lattice->SetBorderMode(spline->GetBorderMode());
      lattice->SetDisplacementScale(spline->GetDisplacementScale());
      lattice->FromImageData(spline->GetCoefficientData());
    }
    vtkNew<vtkImageData> image;
    vtkNew<vtkXMLImageDataWriter> writer;
    writer->SetInputData(image);
    writer->WriteToOutputStringOn();
    if (!lattice->ToImageData(image) || !writer->Write() ||
      !WriteFile(name, writer->GetOutputString(), std::string()))
    {
      vtkErrorMacro("Write: " << name << " could not be written. Is the folder there, and writable?");
      return 0;
    }
    return 1;
  }
  for (ffd::TransformStep& step : steps)
  {
    if (ras)
    {
      ffd::FlipTransformStep(step);
    }
  }
  const ffd::TransformGrid& grid = steps.empty() ? reference.Grid : steps[0].Grid;
  switch (format)
  {
    case ITK_TEXT:
      head = ffd::FormatItkTransform(steps);
      break;
    case ELASTIX:
    {
      if (!this->ReferenceImage)
      {
        // The domain of the spline.
        double longest = 0.0;
        for (int a = 0; a < 3; ++a)
        {
          longest = std::max(longest, (grid.Size[a] - 3) * grid.Spacing[a]);
        }
        reference.Grid = grid;
        reference.Grid.Origin = grid.Origin + grid.Direction * grid.Spacing;
        reference.Grid.Spacing = glm::dvec3(longest / (DefaultVoxels - 1));
        for (int a = 0; a < 3; ++a)
        {
          reference.Grid.Size[a] = 1 +
            static_cast<int>((grid.Size[a] - 3) * grid.Spacing[a] / reference.Grid.Spacing[a] + 0.5);
        }
      }
      else if (ras)
      {
        ffd::FlipTransformStep(reference);
      }
      head = ffd::FormatElastixTransform(steps[0], reference.Grid);
      break;
    }
    case META_IMAGE:
      if (vtksys::SystemTools::LowerCase(vtksys::SystemTools::GetFilenameLastExtension(name)) ==
        ".mhd")
      {
        dataName = vtksys::SystemTools::GetFilenameWithoutLastExtension(name) + ".raw";
      }
      head = ffd::FormatMetaImageHeader(grid, dataName);
      break;
    case NRRD:
      head = ffd::FormatNrrdHeader(grid);
      break;
    default:
      head = ffd::FormatNiftiHeader(grid);
      break;
  }
  if (field)
  {
    data = EncodeField(steps[0].Values, format == NIFTI);
  }
  bool written = true;
  if (!dataName.empty())
  {
    const std::string folder = vtksys::SystemTools::GetFilenamePath(name);
    written = WriteFile((folder.empty() ? "" : folder + "/") + dataName, std::string(), data);
    data.clear();
  }
  if (!written || !WriteFile(name, head, data))
  {
    vtkErrorMacro("Write: " << name << " could not be written. Is the folder there, and writable?");
    return 0;
  }
  return 1;
}
