// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLatticeData.h"

#include "FFDGridIndex.h"
#include "FFDLattice.h"

#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkFFDLattice.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <utility>

static_assert(sizeof(glm::dvec3) == 3 * sizeof(double), "tuples are copied as they lie");

namespace
{

constexpr int CurrentVersion = 1;
constexpr const char* Prefix = "FFDLattice.";
constexpr const char* DisplacementName = "Displacement";
const char* const ArrayNames[] = { "Version", "Dimensions", "Origin", "Spacing", "BorderMode",
  "Inverse", "DisplacementScale", DisplacementName };

vtkDataArray* FindArray(vtkDataObject* object, const char* name)
{
  vtkFieldData* fields = object ? object->GetFieldData() : nullptr;
  return fields ? fields->GetArray((std::string(Prefix) + name).c_str()) : nullptr;
}

/// Reads fields until one has a problem.
class FieldReader
{
public:
  explicit FieldReader(vtkDataObject* object)
    : Object(object)
  {
  }

  const std::string& GetProblem() const { return this->Problem; }
  bool Has(const char* name) const { return FindArray(this->Object, name) != nullptr; }

  void Read(const char* name, double* values, int count)
  {
    if (!this->Problem.empty())
    {
      return;
    }
    vtkDataArray* array = FindArray(this->Object, name);
    if (!array)
    {
      this->Problem = std::string("the field-data array ") + Prefix + name + " is missing";
      return;
    }
    if (array->GetNumberOfValues() != count)
    {
      this->Problem = std::string("the field-data array ") + Prefix + name + " has " +
        std::to_string(array->GetNumberOfValues()) + " values, not " + std::to_string(count);
      return;
    }
    const int components = array->GetNumberOfComponents();
    for (int i = 0; i < count; ++i)
    {
      values[i] = array->GetComponent(i / components, i % components);
      if (!std::isfinite(values[i]))
      {
        this->Problem = std::string("the field-data array ") + Prefix + name + " is not finite";
        return;
      }
    }
  }

  /// As above for up to three integers; refuses fractions and what does not fit.
  void Read(const char* name, int* values, int count)
  {
    double numbers[3] = { 0.0, 0.0, 0.0 };
    this->Read(name, numbers, count);
    for (int i = 0; i < count && this->Problem.empty(); ++i)
    {
      if (numbers[i] != std::floor(numbers[i]) || std::abs(numbers[i]) > 1e9)
      {
        this->Problem = std::string("the field-data array ") + Prefix + name + " holds no integer";
        return;
      }
      values[i] = static_cast<int>(numbers[i]);
    }
  }

  void Read(ffd::BorderMode& border)
  {
    int number = static_cast<int>(border);
    this->Read("BorderMode", &number, 1);
    border = static_cast<ffd::BorderMode>(number); // out of range: Lattice::FindProblem() says so
  }

  void Read(bool& inverse)
  {
    int number = inverse ? 1 : 0;
    this->Read("Inverse", &number, 1);
    inverse = number != 0;
  }

private:
  vtkDataObject* Object;
  std::string Problem;
};

template <typename ArrayT, typename ValueT>
void AddNumbers(vtkFieldData* fields, const char* name, const ValueT* values, int count)
{
  vtkNew<ArrayT> array;
  array->SetName((std::string(Prefix) + name).c_str());
  array->SetNumberOfComponents(count);
  array->SetNumberOfTuples(1);
  std::copy_n(values, count, array->GetPointer(0));
  fields->AddArray(array);
}

void AddOptions(const ffd::Lattice& lattice, vtkFieldData* fields)
{
  const int border = static_cast<int>(lattice.Border);
  const int inverse = lattice.Inverse ? 1 : 0;
  AddNumbers<vtkIntArray>(fields, "BorderMode", &border, 1);
  AddNumbers<vtkIntArray>(fields, "Inverse", &inverse, 1);
  AddNumbers<vtkDoubleArray>(fields, "DisplacementScale", &lattice.Scale, 1);
}

} // namespace

//------------------------------------------------------------------------------
std::vector<glm::dvec3> vtkFFDCopyTuples(vtkDataArray* array)
{
  if (array->GetNumberOfComponents() != 3)
  {
    return {};
  }
  std::vector<glm::dvec3> values(static_cast<std::size_t>(array->GetNumberOfTuples()));
  vtkDoubleArray* doubles = vtkDoubleArray::SafeDownCast(array);
  if (doubles && !values.empty())
  {
    std::copy_n(doubles->GetPointer(0), 3 * values.size(), &values[0].x);
    return values;
  }
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    array->GetTuple(static_cast<vtkIdType>(i), &values[i].x);
  }
  return values;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkDoubleArray> vtkFFDMakeDisplacementArray(
  const std::vector<glm::dvec3>& displacements)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(DisplacementName);
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(displacements.size()));
  if (!displacements.empty())
  {
    std::copy_n(&displacements[0].x, 3 * displacements.size(), array->GetPointer(0));
  }
  return array;
}

//------------------------------------------------------------------------------
bool vtkFFDWriteTuples(const std::vector<glm::dvec3>& values, vtkDoubleArray* array)
{
  if (array->GetNumberOfComponents() != 3 ||
    array->GetNumberOfTuples() != static_cast<vtkIdType>(values.size()))
  {
    return false;
  }
  bool differs = false;
  double* to = array->GetPointer(0);
  for (std::size_t i = 0; i < values.size(); ++i, to += 3)
  {
    if (!std::equal(to, to + 3, &values[i].x))
    {
      differs = true;
      std::copy_n(&values[i].x, 3, to);
    }
  }
  return differs;
}

//------------------------------------------------------------------------------
ffd::Lattice vtkFFDGetLatticeValue(vtkFFDLattice* lattice)
{
  return vtkFFDGetLatticeValue(lattice, lattice->GetDisplacements());
}

//------------------------------------------------------------------------------
ffd::Lattice vtkFFDGetLatticeValue(vtkFFDLattice* lattice, vtkDoubleArray* displacements)
{
  ffd::Lattice value;
  value.Net.Values = vtkFFDCopyTuples(displacements);
  vtkImageData* image = lattice->GetCoefficientData();
  image->GetDimensions(&value.Net.Nodes.x);
  image->GetOrigin(&value.Origin.x);
  image->GetSpacing(&value.Spacing.x);
  value.Border = static_cast<ffd::BorderMode>(lattice->GetBorderMode());
  value.Scale = lattice->GetDisplacementScale();
  value.Inverse = lattice->GetInverseFlag() != 0;
  return value;
}

//------------------------------------------------------------------------------
bool vtkFFDHasLattice(vtkDataObject* object)
{
  // One without the other is a lattice that is not whole: reading it says so.
  return FindArray(object, "Version") != nullptr || FindArray(object, DisplacementName) != nullptr;
}

//------------------------------------------------------------------------------
void vtkFFDRemoveLattice(vtkDataObject* object)
{
  vtkFieldData* fields = object ? object->GetFieldData() : nullptr;
  if (fields)
  {
    for (const char* name : ArrayNames)
    {
      fields->RemoveArray((std::string(Prefix) + name).c_str());
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDWriteLattice(const ffd::Lattice& lattice, vtkDataObject* object)
{
  // First what may fail for want of memory.
  auto displacements = vtkFFDMakeDisplacementArray(lattice.Net.Values);
  displacements->SetName((std::string(Prefix) + DisplacementName).c_str());
  vtkFieldData* fields = object->GetFieldData();
  if (!fields)
  {
    vtkNew<vtkFieldData> made;
    object->SetFieldData(made);
    fields = object->GetFieldData();
  }
  AddNumbers<vtkIntArray>(fields, "Version", &CurrentVersion, 1);
  AddNumbers<vtkIntArray>(fields, "Dimensions", &lattice.Net.Nodes.x, 3);
  AddNumbers<vtkDoubleArray>(fields, "Origin", &lattice.Origin.x, 3);
  AddNumbers<vtkDoubleArray>(fields, "Spacing", &lattice.Spacing.x, 3);
  AddOptions(lattice, fields);
  fields->AddArray(displacements);
}

//------------------------------------------------------------------------------
std::string vtkFFDReadLattice(vtkDataObject* object, ffd::Lattice& lattice, bool* isComplete)
{
  bool ignored;
  bool& complete = isComplete ? *isComplete : ignored;
  complete = false;
  if (!object)
  {
    return "the data object is null";
  }
  ffd::Lattice read;
  int version = 0;
  FieldReader reader(object);
  reader.Read("Version", &version, 1);
  if (reader.GetProblem().empty() && version != CurrentVersion)
  {
    complete = true;
    return "its version is " + std::to_string(version) + ", this library reads version 1";
  }
  reader.Read("Dimensions", &read.Net.Nodes.x, 3);
  reader.Read("Origin", &read.Origin.x, 3);
  reader.Read("Spacing", &read.Spacing.x, 3);
  reader.Read(read.Border);
  reader.Read(read.Inverse);
  reader.Read("DisplacementScale", &read.Scale, 1);
  if (!reader.GetProblem().empty())
  {
    return reader.GetProblem();
  }
  vtkDataArray* displacements = FindArray(object, DisplacementName);
  if (!displacements || displacements->GetNumberOfComponents() != 3)
  {
    return "the field-data array FFDLattice.Displacement is missing or has not 3 components";
  }
  read.Net.Values = vtkFFDCopyTuples(displacements);
  const glm::ivec3& nodes = read.Net.Nodes;
  complete =
    std::min({ nodes.x, nodes.y, nodes.z }) > 0 && read.Net.Values.size() == ffd::GridSize(nodes);
  const std::string problem = read.FindProblem();
  if (problem.empty())
  {
    lattice = std::move(read);
  }
  return problem;
}

//------------------------------------------------------------------------------
void vtkFFDWriteLatticeOptions(const ffd::Lattice& lattice, vtkImageData* image)
{
  AddOptions(lattice, image->GetFieldData());
}

//------------------------------------------------------------------------------
std::string vtkFFDReadLatticeImage(vtkImageData* image, ffd::Lattice& lattice)
{
  if (!image)
  {
    return "it is null";
  }
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfComponents() != 3)
  {
    return "it has no point scalars with 3 components";
  }
  ffd::Lattice read;
  read.Border = lattice.Border;
  read.Scale = lattice.Scale;
  read.Inverse = lattice.Inverse;
  int extent[6];
  image->GetExtent(extent);
  image->GetSpacing(&read.Spacing.x);
  image->GetOrigin(&read.Origin.x);
  for (int a = 0; a < 3; ++a)
  {
    // Our indices start at 0, those of the extent need not.
    read.Origin[a] += extent[2 * a] * read.Spacing[a];
    read.Net.Nodes[a] = extent[2 * a + 1] - extent[2 * a] + 1;
  }
  FieldReader reader(image);
  if (reader.Has("BorderMode"))
  {
    reader.Read(read.Border);
  }
  if (reader.Has("Inverse"))
  {
    reader.Read(read.Inverse);
  }
  if (reader.Has("DisplacementScale"))
  {
    reader.Read("DisplacementScale", &read.Scale, 1);
  }
  if (!reader.GetProblem().empty())
  {
    return reader.GetProblem();
  }
  read.Net.Values = vtkFFDCopyTuples(scalars);
  const std::string problem = read.FindProblem();
  if (problem.empty())
  {
    lattice = std::move(read);
  }
  return problem;
}

//------------------------------------------------------------------------------
void vtkFFDDescribeLatticeImage(vtkFFDLattice* lattice, vtkInformation* info)
{
  int n[3];
  double first[3];
  double spacing[3];
  lattice->GetDimensions(n);
  lattice->GetRestPoint(0, 0, 0, first);
  lattice->GetSpacing(spacing);
  const int extent[6] = { 0, n[0] - 1, 0, n[1] - 1, 0, n[2] - 1 };
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::ORIGIN(), first, 3);
  info->Set(vtkDataObject::SPACING(), spacing, 3);
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_DOUBLE, 3);
}
