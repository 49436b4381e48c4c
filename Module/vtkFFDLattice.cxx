// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLattice.h"

#include "vtkFFDFitNetToTransform.h"
#include "vtkFFDGuard.h"

#include "FFDBSplineField.h"
#include "FFDControlNet.h"
#include "FFDJacobianDeterminant.h"
#include "FFDLatticeFit.h"
#include "FFDPullBack.h"
#include "FFDPullBackBounds.h"

#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkTrivialProducer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkFFDLattice);

namespace
{

constexpr int MinimumDimension = 4;
constexpr int MaximumDimension = 1024;
constexpr int MaximumFactor = 64;
/// Bytes per control point while a lattice is changed: its array, and two copies to work on.
constexpr double BytesPerPoint = 72.0;
/// Largest coordinate and displacement, and smallest spacing its inverse: products of three, as in
/// a determinant, are finite numbers.
constexpr double LargestLength = 1e100;
constexpr int CurrentVersion = 1;
constexpr const char* Prefix = "FFDLattice.";
constexpr const char* DisplacementName = "Displacement";
const char* const ArrayNames[] = { "Version", "Dimensions", "Origin", "Spacing", "BorderMode",
  "Inverse", "DisplacementScale", DisplacementName };

bool AllFinite(const double* values, int count)
{
  return std::all_of(values, values + count, [](double v) { return std::isfinite(v); });
}

/// False for what is not a number, too.
bool AllWithinRange(const double* values, int count)
{
  return std::all_of(values, values + count, [](double v) { return std::abs(v) <= LargestLength; });
}

/// Throws when there is not enough memory for so many control points.
void RequireMemory(const glm::ivec3& nodes, double bytesPerPoint = BytesPerPoint)
{
  vtkFFDRequireMemory(bytesPerPoint * nodes.x * nodes.y * nodes.z,
    std::to_string(nodes.x) + " x " + std::to_string(nodes.y) + " x " + std::to_string(nodes.z) +
      " control points",
    "Give fewer control points.");
}

/// A lattice as plain values: what files and images hold, validated before it is used.
struct LatticeState
{
  ffd::ControlNet Net;
  double Origin[3] = { 0.0, 0.0, 0.0 };
  double Spacing[3] = { 1.0, 1.0, 1.0 };
  int BorderMode = VTK_BSPLINE_EDGE;
  int Inverse = 0;
  double Scale = 1.0;

  /// Empty when all is well, else what is wrong.
  std::string FindProblem() const
  {
    std::size_t count = 1;
    for (int a = 0; a < 3; ++a)
    {
      const int n = this->Net.Nodes[a];
      if (n < MinimumDimension || n > MaximumDimension)
      {
        return "the dimensions must be from 4 to 1024 control points per axis, axis " +
          std::to_string(a) + " has " + std::to_string(n);
      }
      count *= static_cast<std::size_t>(n);
      const double ends[2] = { this->Origin[a], this->Origin[a] + (n - 1) * this->Spacing[a] };
      if (!AllWithinRange(ends, 2) || !(this->Spacing[a] >= 1.0 / LargestLength))
      {
        return "origin and spacing must be finite and the spacing positive on every axis, "
               "coordinates at most 1e100 and the spacing at least 1e-100";
      }
    }
    if (this->Net.Values.size() != count)
    {
      return "there are " + std::to_string(this->Net.Values.size()) + " displacements for " +
        std::to_string(count) + " control points";
    }
    if (!std::isfinite(this->Scale))
    {
      return "the displacement scale is not finite";
    }
    const double factor = std::max(1.0, std::abs(this->Scale));
    for (std::size_t i = 0; i < count; ++i)
    {
      const glm::dvec3 scaled = factor * this->Net.Values[i];
      if (!AllWithinRange(&scaled.x, 3))
      {
        return "the displacement of control point " + std::to_string(i) +
          " is not finite or, with the displacement scale, exceeds 1e100";
      }
    }
    if (this->BorderMode < VTK_BSPLINE_EDGE || this->BorderMode > VTK_BSPLINE_ZERO_AT_BORDER)
    {
      return "the border mode is " + std::to_string(this->BorderMode) + ", not 0, 1 or 2";
    }
    return std::string();
  }
};

vtkDataArray* FindArray(vtkDataObject* object, const char* name)
{
  vtkFieldData* fields = object ? object->GetFieldData() : nullptr;
  return fields ? fields->GetArray((std::string(Prefix) + name).c_str()) : nullptr;
}

/// Read `count` numbers of a field-data array; the reason why not, or an empty string.
std::string ReadNumbers(vtkDataObject* object, const char* name, double* values, int count)
{
  vtkDataArray* array = FindArray(object, name);
  if (!array)
  {
    return std::string("the field-data array ") + Prefix + name + " is missing";
  }
  if (array->GetNumberOfValues() != count)
  {
    return std::string("the field-data array ") + Prefix + name + " has " +
      std::to_string(array->GetNumberOfValues()) + " values, not " + std::to_string(count);
  }
  const int components = array->GetNumberOfComponents();
  for (int i = 0; i < count; ++i)
  {
    values[i] = array->GetComponent(i / components, i % components);
    if (!std::isfinite(values[i]))
    {
      return std::string("the field-data array ") + Prefix + name + " is not finite";
    }
  }
  return std::string();
}

/// As above for integers; refuses fractions and what does not fit.
std::string ReadIntegers(vtkDataObject* object, const char* name, int* values, int count)
{
  std::vector<double> numbers(static_cast<std::size_t>(count));
  const std::string problem = ReadNumbers(object, name, numbers.data(), count);
  for (int i = 0; i < count && problem.empty(); ++i)
  {
    const double number = numbers[static_cast<std::size_t>(i)];
    if (number != std::floor(number) || std::abs(number) > 1e9)
    {
      return std::string("the field-data array ") + Prefix + name + " holds no integer";
    }
    values[i] = static_cast<int>(number);
  }
  return problem;
}

std::vector<glm::dvec3> CopyTuples(vtkDataArray* array)
{
  std::vector<glm::dvec3> values(static_cast<std::size_t>(array->GetNumberOfTuples()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    array->GetTuple(static_cast<vtkIdType>(i), &values[i].x);
  }
  return values;
}

template <typename ArrayT, typename ValueT>
void AddNumbers(vtkFieldData* fields, const char* name, const ValueT* values, int count)
{
  vtkNew<ArrayT> array;
  array->SetName((std::string(Prefix) + name).c_str());
  array->SetNumberOfComponents(count);
  array->SetNumberOfTuples(1);
  for (int i = 0; i < count; ++i)
  {
    array->SetValue(i, values[i]);
  }
  fields->AddArray(array);
}

/// Give axes without extent that of the thinnest other one, centred. False: nothing to go by.
bool WidenFlatAxes(double bounds[6])
{
  double thinnest = VTK_DOUBLE_MAX;
  for (int a = 0; a < 3; ++a)
  {
    const double extent = bounds[2 * a + 1] - bounds[2 * a];
    thinnest = extent > 0.0 ? std::min(thinnest, extent) : thinnest;
  }
  if (thinnest == VTK_DOUBLE_MAX)
  {
    return false;
  }
  for (int a = 0; a < 3; ++a)
  {
    if (bounds[2 * a + 1] == bounds[2 * a])
    {
      bounds[2 * a] -= 0.5 * thinnest;
      bounds[2 * a + 1] += 0.5 * thinnest;
    }
  }
  return true;
}

std::string DescribeBounds(const double b[6])
{
  std::ostringstream text;
  text << "(" << b[0] << ", " << b[1] << ", " << b[2] << ", " << b[3] << ", " << b[4] << ", "
       << b[5] << ")";
  return text.str();
}

} // namespace

//------------------------------------------------------------------------------
class vtkFFDLattice::vtkLatticeInternals
{
public:
  vtkSmartPointer<vtkImageData> Image;
  vtkSmartPointer<vtkDoubleArray> Array; // the scalars of Image

  // Derived by InternalUpdate; kernels see only these.
  ffd::BSplineField Field;
  ffd::PullBack Exact;

  // Derived from Field when asked for; guarded, as queries may come from several threads.
  std::mutex Mutex;
  ffd::PullBackBounds Bounds[2]; // of Exact, of Forward
  bool BoundsAreCurrent[2] = { false, false };
  std::unique_ptr<ffd::Range> Determinant;

  void SetField(const ffd::BSplineField& field, double tolerance)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->Field = field;
    this->Exact = ffd::PullBack(&this->Field, ffd::PullBackKind::Exact, tolerance);
    this->BoundsAreCurrent[0] = this->BoundsAreCurrent[1] = false;
    this->Determinant.reset();
  }

  /// What `query` finds in the bounds of the map, under the lock: an update replaces them.
  ffd::Box AskBounds(bool inverse, const std::function<ffd::Box(const ffd::PullBackBounds&)>& query)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    ffd::PullBackBounds& bounds = this->Bounds[inverse ? 1 : 0];
    if (!this->BoundsAreCurrent[inverse ? 1 : 0])
    {
      // What the object becomes under T^-1 are the points P with T(P) in it: the forward kind.
      bounds.Update(ffd::PullBack(&this->Field,
        inverse ? ffd::PullBackKind::Forward : ffd::PullBackKind::Exact,
        this->Exact.GetTolerance()));
      this->BoundsAreCurrent[inverse ? 1 : 0] = true;
    }
    return query(bounds);
  }

  vtkDoubleArray* GetArray() const { return this->Array; }

  /// The image is public (GetCoefficientData): is it still what SetImage() made of it?
  std::string FindTampering() const
  {
    int extent[6];
    this->Image->GetExtent(extent);
    if (extent[0] != 0 || extent[2] != 0 || extent[4] != 0)
    {
      return "the extent of the coefficient image no longer starts at 0";
    }
    if (this->Image->GetPointData()->GetScalars() != this->Array ||
      this->Array->GetNumberOfComponents() != 3 ||
      this->Array->GetNumberOfTuples() != this->Image->GetNumberOfPoints())
    {
      return "the coefficient image was given another array or size";
    }
    return std::string();
  }

  /// Index of a control point, or -1.
  vtkIdType GetIndex(int i, int j, int k) const
  {
    int n[3];
    this->Image->GetDimensions(n);
    if (i < 0 || j < 0 || k < 0 || i >= n[0] || j >= n[1] || k >= n[2])
    {
      return -1;
    }
    const vtkIdType index = i + static_cast<vtkIdType>(n[0]) * (j + static_cast<vtkIdType>(n[1]) * k);
    return index < this->Array->GetNumberOfTuples() ? index : -1;
  }

  LatticeState GetState(vtkFFDLattice* self) const
  {
    LatticeState state;
    int n[3];
    this->Image->GetDimensions(n);
    state.Net.Nodes = { n[0], n[1], n[2] };
    state.Net.Values = CopyTuples(this->GetArray());
    this->Image->GetOrigin(state.Origin);
    this->Image->GetSpacing(state.Spacing);
    state.BorderMode = self->GetBorderMode();
    state.Inverse = self->GetInverseFlag();
    state.Scale = self->GetDisplacementScale();
    return state;
  }

  /// A new image, so that shallow copies and readers of the old one keep what they have.
  void SetImage(const LatticeState& state)
  {
    // The old one stays until the new one has its memory.
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(DisplacementName);
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(static_cast<vtkIdType>(state.Net.Values.size()));
    for (std::size_t i = 0; i < state.Net.Values.size(); ++i)
    {
      array->SetTuple(static_cast<vtkIdType>(i), &state.Net.Values[i].x);
    }
    this->Array = array;
    this->Image = vtkSmartPointer<vtkImageData>::New();
    this->Image->SetDimensions(state.Net.Nodes.x, state.Net.Nodes.y, state.Net.Nodes.z);
    this->Image->SetOrigin(state.Origin);
    this->Image->SetSpacing(state.Spacing);
    this->Image->GetPointData()->SetScalars(this->Array);
  }

  /// Hand the image to the superclass, past the virtual methods that adopt a copy.
  void Connect(vtkFFDLattice* self) const
  {
    vtkNew<vtkTrivialProducer> producer;
    producer->SetOutput(this->Image);
    self->vtkBSplineTransform::SetCoefficientConnection(producer->GetOutputPort());
  }

  /// The same shape, or nearly, with other numbers of control points, which are possible.
  void Resize(vtkFFDLattice* self, const glm::ivec3& wanted)
  {
    int n[3];
    this->Image->GetDimensions(n);
    if (wanted == glm::ivec3(n[0], n[1], n[2]))
    {
      return;
    }
    RequireMemory(wanted);
    const LatticeState old = this->GetState(self);
    LatticeState state = old;
    bool multiple = true;
    for (int a = 0; a < 3; ++a)
    {
      multiple = multiple && (wanted[a] - 3) % (n[a] - 3) == 0;
      state.Spacing[a] = old.Spacing[a] * (n[a] - 3) / (wanted[a] - 3);
      state.Origin[a] = old.Origin[a] + old.Spacing[a] - state.Spacing[a];
    }
    if (self->IsIdentity())
    {
      state.Net.Nodes = wanted;
      state.Net.Values.assign(static_cast<std::size_t>(wanted.x) *
          static_cast<std::size_t>(wanted.y) * static_cast<std::size_t>(wanted.z),
        glm::dvec3(0.0));
    }
    else if (multiple)
    {
      state.Net = ffd::RefineControlNet(old.Net, (wanted - 3) / (old.Net.Nodes - 3));
    }
    else
    {
      const ffd::BSplineField field(old.Net.Nodes, { old.Origin[0], old.Origin[1], old.Origin[2] },
        { old.Spacing[0], old.Spacing[1], old.Spacing[2] }, old.Net.Values.data());
      ffd::ControlNet samples;
      samples.Nodes = wanted - 2;
      for (int k = 1; k < wanted.z - 1; ++k)
      {
        for (int j = 1; j < wanted.y - 1; ++j)
        {
          for (int i = 1; i < wanted.x - 1; ++i)
          {
            samples.Values.push_back(field.Displacement({ state.Origin[0] + i * state.Spacing[0],
              state.Origin[1] + j * state.Spacing[1], state.Origin[2] + k * state.Spacing[2] }));
          }
        }
      }
      state.Net = ffd::InterpolateControlNet(samples);
    }
    this->SetState(self, state);
    self->Modified();
  }

  int ReadFrom(vtkFFDLattice* self, vtkDataObject* object);
  int FromImageData(vtkFFDLattice* self, vtkImageData* image);

  /// Take over a validated state. Modified() is up to the caller.
  void SetState(vtkFFDLattice* self, const LatticeState& state)
  {
    this->SetImage(state);
    this->Connect(self);
    self->BorderMode = state.BorderMode;
    self->DisplacementScale = state.Scale;
    self->InverseFlag = state.Inverse;
  }
};

//------------------------------------------------------------------------------
vtkFFDLattice::vtkFFDLattice()
  : Lattice(new vtkLatticeInternals)
  , Dimensions{ MinimumDimension, MinimumDimension, MinimumDimension }
  , Domain{ 0.0, 1.0, 0.0, 1.0, 0.0, 1.0 }
{
  LatticeState state;
  state.Net.Nodes = glm::ivec3(MinimumDimension);
  state.Net.Values.resize(MinimumDimension * MinimumDimension * MinimumDimension);
  // One cell: nodes 1 and 2 are the corners of the unit cube.
  std::fill_n(state.Origin, 3, -1.0);
  this->Lattice->SetState(this, state);
}

//------------------------------------------------------------------------------
vtkFFDLattice::~vtkFFDLattice() = default;

//------------------------------------------------------------------------------
void vtkFFDLattice::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  int n[3];
  double domain[6];
  this->GetDimensions(n);
  this->GetDomain(domain);
  os << indent << "Dimensions: (" << n[0] << ", " << n[1] << ", " << n[2] << ")\n";
  os << indent << "Domain: " << DescribeBounds(domain) << "\n";
  os << indent << "IsIdentity: " << (this->IsIdentity() ? "true" : "false") << "\n";
  os << indent << "CoefficientData:\n";
  this->Lattice->Image->PrintSelf(os, indent.GetNextIndent());
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetDimensions(const int dimensions[3])
{
  if (!dimensions)
  {
    vtkErrorMacro("SetDimensions: dimensions is null. Give three numbers.");
    return;
  }
  this->SetDimensions(dimensions[0], dimensions[1], dimensions[2]);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetDimensions(int nx, int ny, int nz)
{
  const glm::ivec3 wanted(nx, ny, nz);
  for (int a = 0; a < 3; ++a)
  {
    if (wanted[a] < MinimumDimension || wanted[a] > MaximumDimension)
    {
      vtkErrorMacro("SetDimensions: (" << nx << ", " << ny << ", " << nz
                                       << ") control points are not possible. Give 4 to 1024 per "
                                          "axis: a cubic B-spline cell has 4.");
      return;
    }
  }
  vtkFFDGuard(this, "SetDimensions", [&] { this->Lattice->Resize(this, wanted); });
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetDimensions(int dimensions[3])
{
  this->Lattice->Image->GetDimensions(dimensions);
}

//------------------------------------------------------------------------------
int* vtkFFDLattice::GetDimensions()
{
  this->GetDimensions(this->Dimensions);
  return this->Dimensions;
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLattice::GetNumberOfControlPoints()
{
  return this->Lattice->Image->GetNumberOfPoints();
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetDomain(
  double xmin, double xmax, double ymin, double ymax, double zmin, double zmax)
{
  const double bounds[6] = { xmin, xmax, ymin, ymax, zmin, zmax };
  this->SetDomain(bounds);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetDomain(const double bounds[6])
{
  if (!bounds)
  {
    vtkErrorMacro("SetDomain: bounds is null. Give (xmin, xmax, ymin, ymax, zmin, zmax).");
    return;
  }
  int n[3];
  double origin[3];
  double spacing[3];
  this->GetDimensions(n);
  for (int a = 0; a < 3; ++a)
  {
    const double lo = bounds[2 * a];
    const double hi = bounds[2 * a + 1];
    spacing[a] = (hi - lo) / (n[a] - 3);
    origin[a] = lo - spacing[a];
    const double ends[2] = { origin[a], hi + spacing[a] };
    if (!AllWithinRange(ends, 2) || !(spacing[a] >= 1.0 / LargestLength) || !(lo + spacing[a] > lo))
    {
      vtkErrorMacro("SetDomain: the domain " << DescribeBounds(bounds)
                                             << " is empty, inverted or not finite on axis " << a
                                             << ". Give bounds of at most 1e99, with min < max per "
                                                "axis.");
      return;
    }
  }
  if (std::equal(origin, origin + 3, this->Lattice->Image->GetOrigin()) &&
    std::equal(spacing, spacing + 3, this->Lattice->Image->GetSpacing()))
  {
    return;
  }
  this->Lattice->Image->SetOrigin(origin);
  this->Lattice->Image->SetSpacing(spacing);
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetDomain(double bounds[6])
{
  int n[3];
  this->GetDimensions(n);
  const double* origin = this->Lattice->Image->GetOrigin();
  const double* spacing = this->Lattice->Image->GetSpacing();
  for (int a = 0; a < 3; ++a)
  {
    bounds[2 * a] = origin[a] + spacing[a];
    bounds[2 * a + 1] = origin[a] + (n[a] - 2) * spacing[a];
  }
}

//------------------------------------------------------------------------------
double* vtkFFDLattice::GetDomain()
{
  this->GetDomain(this->Domain);
  return this->Domain;
}

//------------------------------------------------------------------------------
void vtkFFDLattice::FitToBounds(const double bounds[6], double padding)
{
  if (!bounds)
  {
    vtkErrorMacro("FitToBounds: bounds is null. Give (xmin, xmax, ymin, ymax, zmin, zmax).");
    return;
  }
  if (!std::isfinite(padding) || padding < 0.0)
  {
    vtkErrorMacro("FitToBounds: the padding is " << padding
                                                 << ". Give a fraction of the extent, 0 or more.");
    return;
  }
  double fitted[6];
  std::copy(bounds, bounds + 6, fitted);
  if (!AllFinite(bounds, 6) || bounds[0] > bounds[1] || bounds[2] > bounds[3] ||
    bounds[4] > bounds[5] || !WidenFlatAxes(fitted))
  {
    vtkErrorMacro("FitToBounds: the bounds "
      << DescribeBounds(bounds)
      << " are inverted, not finite or a single point. Give the bounds of the data, at least one "
         "axis with an extent.");
    return;
  }
  for (int a = 0; a < 3; ++a)
  {
    const double pad = padding * (fitted[2 * a + 1] - fitted[2 * a]);
    fitted[2 * a] -= pad;
    fitted[2 * a + 1] += pad;
  }
  this->SetDomain(fitted);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetRestPoint(int i, int j, int k, double point[3])
{
  const int index[3] = { i, j, k };
  const double* origin = this->Lattice->Image->GetOrigin();
  const double* spacing = this->Lattice->Image->GetSpacing();
  for (int a = 0; a < 3; ++a)
  {
    point[a] = origin[a] + index[a] * spacing[a];
  }
  if (this->Lattice->GetIndex(i, j, k) < 0)
  {
    vtkErrorMacro("GetRestPoint: there is no control point (" << i << ", " << j << ", " << k
                                                              << "). See GetDimensions().");
    std::fill_n(point, 3, 0.0);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetSpacing(double spacing[3])
{
  this->Lattice->Image->GetSpacing(spacing);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetControlPoint(int i, int j, int k, const double point[3])
{
  if (!point)
  {
    vtkErrorMacro("SetControlPoint: point is null. Give three coordinates.");
    return;
  }
  this->SetControlPoint(i, j, k, point[0], point[1], point[2]);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetControlPoint(int i, int j, int k, double x, double y, double z)
{
  const double* origin = this->Lattice->Image->GetOrigin();
  const double* spacing = this->Lattice->Image->GetSpacing();
  this->SetDisplacement(i, j, k, x - (origin[0] + i * spacing[0]), y - (origin[1] + j * spacing[1]),
    z - (origin[2] + k * spacing[2]));
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetControlPoint(int i, int j, int k, double point[3])
{
  const vtkIdType index = this->Lattice->GetIndex(i, j, k);
  if (index < 0)
  {
    vtkErrorMacro("GetControlPoint: there is no control point (" << i << ", " << j << ", " << k
                                                                 << "). See GetDimensions().");
    std::fill_n(point, 3, 0.0);
    return;
  }
  double displacement[3];
  this->GetRestPoint(i, j, k, point);
  this->GetDisplacement(i, j, k, displacement);
  vtkMath::Add(point, displacement, point);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetDisplacement(int i, int j, int k, const double displacement[3])
{
  if (!displacement)
  {
    vtkErrorMacro("SetDisplacement: displacement is null. Give three components.");
    return;
  }
  this->SetDisplacement(i, j, k, displacement[0], displacement[1], displacement[2]);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetDisplacement(int i, int j, int k, double dx, double dy, double dz)
{
  const vtkIdType index = this->Lattice->GetIndex(i, j, k);
  if (index < 0)
  {
    vtkErrorMacro("SetDisplacement: there is no control point ("
      << i << ", " << j << ", " << k << "). Indices start at 0; see GetDimensions().");
    return;
  }
  const double wanted[3] = { dx, dy, dz };
  if (!AllWithinRange(wanted, 3))
  {
    vtkErrorMacro("SetDisplacement: control point ("
      << i << ", " << j << ", " << k << ") would be displaced by (" << dx << ", " << dy << ", "
      << dz << "). Give finite numbers of at most 1e100.");
    return;
  }
  double current[3];
  vtkDoubleArray* array = this->Lattice->GetArray();
  array->GetTypedTuple(index, current);
  if (std::equal(wanted, wanted + 3, current))
  {
    return;
  }
  array->SetTypedTuple(index, wanted);
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetDisplacement(int i, int j, int k, double displacement[3])
{
  const vtkIdType index = this->Lattice->GetIndex(i, j, k);
  if (index < 0)
  {
    vtkErrorMacro("GetDisplacement: there is no control point (" << i << ", " << j << ", " << k
                                                                 << "). See GetDimensions().");
    std::fill_n(displacement, 3, 0.0);
    return;
  }
  this->Lattice->GetArray()->GetTypedTuple(index, displacement);
}

//------------------------------------------------------------------------------
vtkDoubleArray* vtkFFDLattice::GetDisplacements()
{
  return this->Lattice->GetArray();
}

//------------------------------------------------------------------------------
int vtkFFDLattice::SetDisplacements(vtkDataArray* displacements)
{
  const vtkIdType count = this->GetNumberOfControlPoints();
  if (!displacements || displacements->GetNumberOfComponents() != 3 ||
    displacements->GetNumberOfTuples() != count)
  {
    vtkErrorMacro("SetDisplacements: the array "
      << (displacements ? "has another shape" : "is null") << ". Give " << count
      << " tuples of 3 components, x fastest.");
    return 0;
  }
  std::vector<glm::dvec3> values;
  if (!vtkFFDGuard(this, "SetDisplacements", [&] { values = CopyTuples(displacements); }))
  {
    return 0;
  }
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    if (!AllWithinRange(&values[i].x, 3))
    {
      vtkErrorMacro("SetDisplacements: tuple "
        << i << " of the array is not finite or exceeds 1e100. Give finite numbers.");
      return 0;
    }
  }
  vtkDoubleArray* array = this->Lattice->GetArray();
  bool same = true;
  for (vtkIdType i = 0; i < count; ++i)
  {
    const glm::dvec3& value = values[static_cast<std::size_t>(i)];
    double current[3];
    array->GetTypedTuple(i, current);
    same = same && std::equal(current, current + 3, &value.x);
    array->SetTypedTuple(i, &value.x);
  }
  if (!same)
  {
    this->Modified();
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkFFDLattice::Reset()
{
  vtkDoubleArray* array = this->Lattice->GetArray();
  bool changed = false;
  for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i)
  {
    // NaN that were written behind the setters count as changed, too.
    changed = changed || !(array->GetValue(i) == 0.0);
  }
  if (changed)
  {
    array->FillValue(0.0);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
bool vtkFFDLattice::IsIdentity()
{
  if (this->DisplacementScale == 0.0)
  {
    return true;
  }
  vtkDoubleArray* array = this->Lattice->GetArray();
  for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i)
  {
    if (!(array->GetValue(i) == 0.0))
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
int vtkFFDLattice::Refine(int factorX, int factorY, int factorZ)
{
  const glm::ivec3 factors(factorX, factorY, factorZ);
  glm::ivec3 nodes;
  this->GetDimensions(&nodes.x);
  for (int a = 0; a < 3; ++a)
  {
    if (factors[a] < 1 || factors[a] > MaximumFactor ||
      (nodes[a] - 3) * factors[a] + 3 > MaximumDimension)
    {
      vtkErrorMacro("Refine: factor " << factors[a] << " on axis " << a
                                      << " is not possible. Give 1 to 64, and at most 1024 control "
                                         "points per axis as the result.");
      return 0;
    }
  }
  if (factors == glm::ivec3(1))
  {
    return 1;
  }
  return vtkFFDGuard(this, "Refine", [&] {
    RequireMemory((nodes - 3) * factors + 3);
    LatticeState state = this->Lattice->GetState(this);
    state.Net = ffd::RefineControlNet(state.Net, factors);
    for (int a = 0; a < 3; ++a)
    {
      const double spacing = state.Spacing[a] / factors[a];
      state.Origin[a] += state.Spacing[a] - spacing;
      state.Spacing[a] = spacing;
    }
    this->Lattice->SetState(this, state);
    this->Modified();
  });
}

//------------------------------------------------------------------------------
int vtkFFDLattice::Extend(int layers)
{
  glm::ivec3 old;
  this->GetDimensions(&old.x);
  const int largest = std::max({ old.x, old.y, old.z });
  if (layers < 1 || layers > MaximumFactor || largest + 2 * layers > MaximumDimension)
  {
    vtkErrorMacro("Extend: " << layers
                             << " layers are not possible. Give 1 to 64, and at most 1024 control "
                                "points per axis as the result.");
    return 0;
  }
  if (this->BorderMode == VTK_BSPLINE_ZERO_AT_BORDER)
  {
    vtkErrorMacro("Extend: a lattice with border mode ZeroAtBorder cannot be continued without a "
                  "change of the map. Set border mode Edge or Zero.");
    return 0;
  }
  return vtkFFDGuard(this, "Extend", [&] {
    RequireMemory(old + 2 * layers);
    LatticeState state = this->Lattice->GetState(this);
    ffd::ControlNet net;
    net.Nodes = old + 2 * layers;
    for (int k = -layers; k < old.z + layers; ++k)
    {
      for (int j = -layers; j < old.y + layers; ++j)
      {
        for (int i = -layers; i < old.x + layers; ++i)
        {
          const glm::ivec3 source = glm::clamp(glm::ivec3(i, j, k), glm::ivec3(0), old - 1);
          const bool inside = source == glm::ivec3(i, j, k);
          const std::size_t index = static_cast<std::size_t>(source.x) +
            static_cast<std::size_t>(old.x) *
              (static_cast<std::size_t>(source.y) +
                static_cast<std::size_t>(old.y) * static_cast<std::size_t>(source.z));
          net.Values.push_back(inside || this->BorderMode == VTK_BSPLINE_EDGE
              ? state.Net.Values[index]
              : glm::dvec3(0.0));
        }
      }
    }
    state.Net = net;
    for (int a = 0; a < 3; ++a)
    {
      state.Origin[a] -= layers * state.Spacing[a];
    }
    this->Lattice->SetState(this, state);
    this->Modified();
  });
}

//------------------------------------------------------------------------------
double vtkFFDLattice::FitToTransform(
  vtkAbstractTransform* transform, const double bounds[6], double tolerance, int maximumCells)
{
  if (!transform || transform == this)
  {
    vtkErrorMacro("FitToTransform: the transform is "
      << (transform ? "this lattice itself" : "null") << ". Give another transform.");
    return -1.0;
  }
  if (!(tolerance > 0.0) || !std::isfinite(tolerance) || maximumCells < 1 || maximumCells > 256)
  {
    vtkErrorMacro("FitToTransform: tolerance " << tolerance << " or maximumCells " << maximumCells
                                               << " is out of range. Give a positive tolerance in "
                                                  "data units and 1 to 256 cells.");
    return -1.0;
  }
  double domain[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
  if (bounds)
  {
    std::copy(bounds, bounds + 6, domain);
  }
  if (!AllFinite(domain, 6) || domain[0] > domain[1] || domain[2] > domain[3] ||
    domain[4] > domain[5] || !WidenFlatAxes(domain))
  {
    vtkErrorMacro("FitToTransform: the bounds "
      << (bounds ? DescribeBounds(bounds) : std::string("(null)"))
      << " are inverted, not finite or a single point. Give the bounds of the data.");
    return -1.0;
  }

  ffd::FitLimits limits;
  limits.Tolerance = tolerance;
  limits.MaximumCells = maximumCells;
  ffd::FittedNet fit;
  fit.Lower = { domain[0], domain[2], domain[4] };
  fit.Extent = { domain[1] - domain[0], domain[3] - domain[2], domain[5] - domain[4] };
  return vtkFFDGuarded(this, "FitToTransform", -1.0, [&] {
    LatticeState state;
    const ffd::FitStatus status = vtkFFDFitNetToTransform(transform, limits, fit);
    if (status != ffd::FitStatus::NotFinite)
    {
      state.Net = std::move(fit.Net);
      for (int a = 0; a < 3; ++a)
      {
        state.Spacing[a] = fit.GetSpacing()[a];
        state.Origin[a] = fit.GetOrigin()[a];
      }
    }
    const std::string problem = status == ffd::FitStatus::NotFinite
      ? "the transform gives points that are not finite"
      : state.FindProblem();
    if (!problem.empty())
    {
      vtkErrorMacro("FitToTransform: the "
        << transform->GetClassName() << " cannot be followed within " << DescribeBounds(domain)
        << ": " << problem << ". The lattice is left as it was.");
      return -1.0;
    }
    this->Lattice->SetState(this, state);
    this->Modified();
    return fit.LargestError;
  });
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetDeformedBounds(const double restBounds[6], double bounds[6])
{
  vtkMath::UninitializeBounds(bounds);
  if (!restBounds || !AllFinite(restBounds, 6) || restBounds[0] > restBounds[1] ||
    restBounds[2] > restBounds[3] || restBounds[4] > restBounds[5])
  {
    vtkErrorMacro("GetDeformedBounds: the bounds "
      << (restBounds ? DescribeBounds(restBounds) : std::string("(null)"))
      << " are inverted or not finite. Give those of the undeformed object.");
    return;
  }
  this->Update();
  const ffd::Box rest{ { restBounds[0], restBounds[2], restBounds[4] },
    { restBounds[1], restBounds[3], restBounds[5] } };
  const ffd::Box none{ glm::dvec3(1.0), glm::dvec3(-1.0) };
  const ffd::Box box = vtkFFDGuarded(this, "GetDeformedBounds", none, [&] {
    return this->Lattice->AskBounds(this->InverseFlag != 0,
      [&rest](const ffd::PullBackBounds& map) { return map.DeformedBounds(rest); });
  });
  if (!box.IsEmpty())
  {
    for (int a = 0; a < 3; ++a)
    {
      bounds[2 * a] = box.Min[a];
      bounds[2 * a + 1] = box.Max[a];
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetDisplacementBounds(double bounds[6])
{
  this->Update();
  const ffd::Box everywhere{ glm::dvec3(-VTK_DOUBLE_MAX), glm::dvec3(VTK_DOUBLE_MAX) };
  const ffd::Box box = vtkFFDGuarded(this, "GetDisplacementBounds", ffd::Box(), [&] {
    return this->Lattice->AskBounds(this->InverseFlag != 0,
      [&everywhere](const ffd::PullBackBounds& map) { return map.DisplacementOver(everywhere); });
  });
  for (int a = 0; a < 3; ++a)
  {
    bounds[2 * a] = box.Min[a];
    bounds[2 * a + 1] = box.Max[a];
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetJacobianDeterminantBounds(double range[2])
{
  this->Update();
  vtkLatticeInternals& lattice = *this->Lattice;
  // What cannot be computed is not proven.
  range[0] = -VTK_DOUBLE_MAX;
  range[1] = VTK_DOUBLE_MAX;
  vtkFFDGuard(this, "GetJacobianDeterminantBounds", [&] {
    const std::lock_guard<std::mutex> lock(lattice.Mutex);
    if (!lattice.Determinant)
    {
      // The domain's cells.
      lattice.Determinant.reset(new ffd::Range(
        ffd::BoundJacobianDeterminant(lattice.Field, glm::ivec3(1), lattice.Field.GetNodes() - 2)));
    }
    range[0] = lattice.Determinant->Min;
    range[1] = lattice.Determinant->Max;
  });
}

//------------------------------------------------------------------------------
double vtkFFDLattice::GetMinimumJacobianBound()
{
  double range[2];
  this->GetJacobianDeterminantBounds(range);
  return range[0];
}

//------------------------------------------------------------------------------
bool vtkFFDLattice::HasLattice(vtkDataObject* object)
{
  return FindArray(object, "Version") != nullptr && FindArray(object, DisplacementName) != nullptr;
}

//------------------------------------------------------------------------------
void vtkFFDLattice::DetachFrom(vtkDataObject* object)
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
int vtkFFDLattice::AttachTo(vtkDataObject* object)
{
  if (!object)
  {
    vtkErrorMacro("AttachTo: the data object is null. Give the data set to deform.");
    return 0;
  }
  return vtkFFDGuard(this, "AttachTo", [&] {
    // First what may fail for want of memory.
    const LatticeState state = this->Lattice->GetState(this);
    vtkNew<vtkDoubleArray> displacements;
    displacements->DeepCopy(this->Lattice->GetArray());
    displacements->SetName((std::string(Prefix) + DisplacementName).c_str());
    vtkFieldData* fields = object->GetFieldData();
    if (!fields)
    {
      vtkNew<vtkFieldData> made;
      object->SetFieldData(made);
      fields = object->GetFieldData();
    }
    AddNumbers<vtkIntArray>(fields, "Version", &CurrentVersion, 1);
    AddNumbers<vtkIntArray>(fields, "Dimensions", &state.Net.Nodes.x, 3);
    AddNumbers<vtkDoubleArray>(fields, "Origin", state.Origin, 3);
    AddNumbers<vtkDoubleArray>(fields, "Spacing", state.Spacing, 3);
    AddNumbers<vtkIntArray>(fields, "BorderMode", &state.BorderMode, 1);
    AddNumbers<vtkIntArray>(fields, "Inverse", &state.Inverse, 1);
    AddNumbers<vtkDoubleArray>(fields, "DisplacementScale", &state.Scale, 1);
    fields->AddArray(displacements);
  });
}

//------------------------------------------------------------------------------
int vtkFFDLattice::ReadFrom(vtkDataObject* object)
{
  return vtkFFDGuarded(this, "ReadFrom", 0, [&] { return this->Lattice->ReadFrom(this, object); });
}

//------------------------------------------------------------------------------
int vtkFFDLattice::vtkLatticeInternals::ReadFrom(vtkFFDLattice* self, vtkDataObject* object)
{
  LatticeState state;
  int version = 0;
  std::string problem = object ? std::string() : std::string("the data object is null");
  if (problem.empty())
  {
    problem = ReadIntegers(object, "Version", &version, 1);
  }
  if (problem.empty() && version != CurrentVersion)
  {
    problem = "its version is " + std::to_string(version) + ", this library reads version 1";
  }
  if (problem.empty())
  {
    problem = ReadIntegers(object, "Dimensions", &state.Net.Nodes.x, 3);
  }
  if (problem.empty())
  {
    problem = ReadNumbers(object, "Origin", state.Origin, 3);
  }
  if (problem.empty())
  {
    problem = ReadNumbers(object, "Spacing", state.Spacing, 3);
  }
  if (problem.empty())
  {
    problem = ReadIntegers(object, "BorderMode", &state.BorderMode, 1);
  }
  if (problem.empty())
  {
    problem = ReadIntegers(object, "Inverse", &state.Inverse, 1);
  }
  if (problem.empty())
  {
    problem = ReadNumbers(object, "DisplacementScale", &state.Scale, 1);
  }
  if (problem.empty())
  {
    vtkDataArray* displacements = FindArray(object, DisplacementName);
    if (!displacements || displacements->GetNumberOfComponents() != 3)
    {
      problem = "the field-data array FFDLattice.Displacement is missing or has not 3 components";
    }
    else
    {
      state.Net.Values = CopyTuples(displacements);
      problem = state.FindProblem();
    }
  }
  if (!problem.empty())
  {
    vtkErrorWithObjectMacro(self,
      "ReadFrom: no lattice can be read from the "
        << (object ? object->GetClassName() : "data object") << ": " << problem
        << ". Attach one with AttachTo() or vtkFFDDeformVolume.");
    return 0;
  }
  state.Inverse = state.Inverse != 0 ? 1 : 0;
  this->SetState(self, state);
  self->Modified();
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLattice::ToImageData(vtkImageData* image)
{
  if (!image)
  {
    vtkErrorMacro("ToImageData: the image is null. Give a vtkImageData to fill.");
    return 0;
  }
  return vtkFFDGuard(this, "ToImageData", [&] {
    const LatticeState state = this->Lattice->GetState(this);
    image->DeepCopy(this->Lattice->Image);
    AddNumbers<vtkIntArray>(image->GetFieldData(), "BorderMode", &state.BorderMode, 1);
    AddNumbers<vtkIntArray>(image->GetFieldData(), "Inverse", &state.Inverse, 1);
    AddNumbers<vtkDoubleArray>(image->GetFieldData(), "DisplacementScale", &state.Scale, 1);
  });
}

//------------------------------------------------------------------------------
int vtkFFDLattice::FromImageData(vtkImageData* image)
{
  return vtkFFDGuarded(
    this, "FromImageData", 0, [&] { return this->Lattice->FromImageData(this, image); });
}

//------------------------------------------------------------------------------
int vtkFFDLattice::vtkLatticeInternals::FromImageData(vtkFFDLattice* self, vtkImageData* image)
{
  LatticeState state = this->GetState(self);
  std::string problem;
  vtkDataArray* scalars = image ? image->GetPointData()->GetScalars() : nullptr;
  if (!image)
  {
    problem = "it is null";
  }
  else if (!scalars || scalars->GetNumberOfComponents() != 3)
  {
    problem = "it has no point scalars with 3 components";
  }
  else
  {
    int extent[6];
    image->GetExtent(extent);
    image->GetSpacing(state.Spacing);
    image->GetOrigin(state.Origin);
    for (int a = 0; a < 3; ++a)
    {
      // Our indices start at 0, those of the extent need not.
      state.Origin[a] += extent[2 * a] * state.Spacing[a];
      state.Net.Nodes[a] = extent[2 * a + 1] - extent[2 * a] + 1;
    }
    state.Net.Values = CopyTuples(scalars);
    if (FindArray(image, "BorderMode"))
    {
      problem = ReadIntegers(image, "BorderMode", &state.BorderMode, 1);
    }
    if (problem.empty() && FindArray(image, "Inverse"))
    {
      problem = ReadIntegers(image, "Inverse", &state.Inverse, 1);
    }
    if (problem.empty() && FindArray(image, "DisplacementScale"))
    {
      problem = ReadNumbers(image, "DisplacementScale", &state.Scale, 1);
    }
    state.Inverse = state.Inverse != 0 ? 1 : 0;
    problem = problem.empty() ? state.FindProblem() : problem;
  }
  if (!problem.empty())
  {
    vtkErrorWithObjectMacro(self,
      "The image cannot be the control points of a lattice: "
        << problem << ". Give an image of displacements, 4 or more points per axis.");
    return 0;
  }
  this->SetState(self, state);
  self->Modified();
  return 1;
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetCoefficientData(vtkImageData* coefficients)
{
  if (coefficients != this->Lattice->Image)
  {
    this->FromImageData(coefficients);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetCoefficientConnection(vtkAlgorithmOutput* connection)
{
  vtkAlgorithm* producer = connection ? connection->GetProducer() : nullptr;
  if (!producer)
  {
    vtkErrorMacro("SetCoefficientConnection: the connection is null. Give an output port.");
    return;
  }
  producer->Update(connection->GetIndex());
  this->FromImageData(
    vtkImageData::SafeDownCast(producer->GetOutputDataObject(connection->GetIndex())));
}

//------------------------------------------------------------------------------
vtkImageData* vtkFFDLattice::GetCoefficientData()
{
  return this->Lattice->Image;
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetDisplacementScale(double scale)
{
  if (!std::isfinite(scale))
  {
    vtkErrorMacro("SetDisplacementScale: the scale is " << scale << ". Give a finite factor.");
    return;
  }
  this->Superclass::SetDisplacementScale(scale);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetInverseTolerance(double tolerance)
{
  if (!std::isfinite(tolerance) || !(tolerance > 0.0))
  {
    vtkErrorMacro(
      "SetInverseTolerance: the tolerance is " << tolerance << ". Give a positive distance.");
    return;
  }
  this->Superclass::SetInverseTolerance(tolerance);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::ShallowCopy(vtkFFDLattice* other)
{
  if (!other)
  {
    vtkErrorMacro("ShallowCopy: the other lattice is null. Give a vtkFFDLattice.");
    return;
  }
  if (other == this)
  {
    return;
  }
  this->Lattice->Image = other->Lattice->Image;
  this->Lattice->Array = other->Lattice->Array;
  this->Lattice->Connect(this);
  this->BorderMode = other->BorderMode;
  this->DisplacementScale = other->DisplacementScale;
  this->InverseFlag = other->InverseFlag;
  this->InverseTolerance = other->InverseTolerance;
  this->InverseIterations = other->InverseIterations;
  // The control points are as they were.
  this->vtkBSplineTransform::Modified();
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDLattice::GetMTime()
{
  // Not that of vtkBSplineTransform, which asks a pipeline that we do not have.
  return std::max(this->vtkWarpTransform::GetMTime(), this->Lattice->Image->GetMTime());
}

//------------------------------------------------------------------------------
void vtkFFDLattice::Modified()
{
  // Shallow copies and filters look at the array's time, and it may have been written in place.
  this->Lattice->Array->Modified();
  this->vtkBSplineTransform::Modified();
}

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDLattice::MakeTransform()
{
  return vtkFFDLattice::New();
}

//------------------------------------------------------------------------------
void vtkFFDLattice::InternalDeepCopy(vtkAbstractTransform* transform)
{
  // vtkAbstractTransform::DeepCopy lets nothing but lattices through.
  vtkFFDLattice* other = vtkFFDLattice::SafeDownCast(transform);
  vtkFFDGuard(this, "DeepCopy", [&] {
    RequireMemory(
      glm::ivec3(other->GetDimensions()[0], other->GetDimensions()[1], other->GetDimensions()[2]));
    this->Lattice->SetState(this, other->Lattice->GetState(other));
  });
  this->InverseTolerance = other->InverseTolerance;
  this->InverseIterations = other->InverseIterations;
}

//------------------------------------------------------------------------------
void vtkFFDLattice::InternalUpdate()
{
  std::string problem = this->Lattice->FindTampering();
  const bool computed = vtkFFDGuard(this, "Update", [&] {
    LatticeState state;
    if (problem.empty())
    {
      glm::ivec3 nodes;
      this->GetDimensions(&nodes.x);
      RequireMemory(nodes, 2.0 / 3.0 * BytesPerPoint); // it has its array
      state = this->Lattice->GetState(this);
      problem = state.FindProblem();
    }
    if (!problem.empty())
    {
      return;
    }
    this->Superclass::InternalUpdate();
    this->Lattice->SetField(
      ffd::BSplineField(state.Net.Nodes, { state.Origin[0], state.Origin[1], state.Origin[2] },
        { state.Spacing[0], state.Spacing[1], state.Spacing[2] }, state.Net.Values.data(),
        state.Scale, static_cast<ffd::BorderMode>(state.BorderMode)),
      this->InverseTolerance);
  });
  if (!problem.empty())
  {
    vtkErrorMacro("The control points are not usable: "
      << problem << ". The lattice does not deform until this is put right, e.g. with Reset().");
  }
  if (!computed || !problem.empty())
  {
    this->GridPointer = nullptr;
    this->Lattice->SetField(ffd::BSplineField(), this->InverseTolerance);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::InverseTransformDerivative(
  const double in[3], double out[3], double derivative[3][3])
{
  ffd::PullBackStatus status;
  const glm::dvec3 q = this->Lattice->Exact.Evaluate({ in[0], in[1], in[2] }, status);
  glm::dmat3 jacobian;
  this->Lattice->Field.Displacement(q, jacobian);
  for (int a = 0; a < 3; ++a)
  {
    out[a] = q[a];
    for (int b = 0; b < 3; ++b)
    {
      derivative[a][b] = jacobian[b][a] + (a == b ? 1.0 : 0.0);
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::InverseTransformDerivative(
  const float in[3], float out[3], float derivative[3][3])
{
  const double point[3] = { in[0], in[1], in[2] };
  double inverse[3];
  double slope[3][3];
  this->InverseTransformDerivative(point, inverse, slope);
  for (int a = 0; a < 3; ++a)
  {
    out[a] = static_cast<float>(inverse[a]);
    for (int b = 0; b < 3; ++b)
    {
      derivative[a][b] = static_cast<float>(slope[a][b]);
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::InverseTransformPoint(const double in[3], double out[3])
{
  ffd::PullBackStatus status;
  const glm::dvec3 q = this->Lattice->Exact.Evaluate({ in[0], in[1], in[2] }, status);
  std::copy(&q.x, &q.x + 3, out);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::InverseTransformPoint(const float in[3], float out[3])
{
  const double point[3] = { in[0], in[1], in[2] };
  double inverse[3];
  this->InverseTransformPoint(point, inverse);
  for (int a = 0; a < 3; ++a)
  {
    out[a] = static_cast<float>(inverse[a]);
  }
}
