// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLattice.h"

#include "vtkFFDGuard.h"
#include "vtkFFDLatticeData.h"
#include "vtkFFDParallelFor.h"
#include "vtkFFDPipeline.h"
#include "vtkFFDTransformSampler.h"

#include "FFDFunctionFit.h"
#include "FFDGridIndex.h"
#include "FFDLattice.h"
#include "FFDLatticeMap.h"

#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkTrivialProducer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkFFDLattice);

namespace
{

/// Bytes per control point while a lattice is changed: its array, and two copies to work on.
constexpr double BytesPerPoint = 72.0;

/// False for what is not a number, too.
bool AllWithinRange(const double* values, int count)
{
  return std::all_of(
    values, values + count, [](double v) { return std::abs(v) <= ffd::Lattice::LargestLength; });
}

/// Throws when there is not enough memory for so many control points.
void RequireMemory(const glm::ivec3& nodes, double bytesPerPoint = BytesPerPoint)
{
  vtkFFDRequireMemory(bytesPerPoint * nodes.x * nodes.y * nodes.z,
    std::to_string(nodes.x) + " x " + std::to_string(nodes.y) + " x " + std::to_string(nodes.z) +
      " control points",
    "Give fewer control points.");
}

/// Whether bounds are finite, none inverted, and not null.
bool AreBounds(const double bounds[6])
{
  return bounds && std::all_of(bounds, bounds + 6, [](double v) { return std::isfinite(v); }) &&
    bounds[0] <= bounds[1] && bounds[2] <= bounds[3] && bounds[4] <= bounds[5];
}

ffd::Box ToBox(const double bounds[6])
{
  return { { bounds[0], bounds[2], bounds[4] }, { bounds[1], bounds[3], bounds[5] } };
}

void FromBox(const ffd::Box& box, double bounds[6])
{
  for (int a = 0; a < 3; ++a)
  {
    bounds[2 * a] = box.Min[a];
    bounds[2 * a + 1] = box.Max[a];
  }
}

std::string DescribeBounds(const double b[6])
{
  if (!b)
  {
    return "(null)";
  }
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
  vtkNew<vtkTrivialProducer> Producer;   // of Image, for the superclass

  /// Evaluates the map; InternalUpdate() makes it of the image.
  ffd::LatticeMap Map;

  /// The image is public (GetCoefficientData): is it still what SetValue() made of it?
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

  /// NaN that were written behind the setters are not zero.
  bool HasOnlyZeros() const
  {
    const double* values = this->Array->GetPointer(0);
    return std::all_of(
      values, values + this->Array->GetNumberOfValues(), [](double v) { return v == 0.0; });
  }

  glm::ivec3 GetNodes() const
  {
    glm::ivec3 nodes;
    this->Image->GetDimensions(&nodes.x);
    return nodes;
  }

  /// The value without its displacements.
  ffd::Lattice GetGrid() const
  {
    const double* o = this->Image->GetOrigin();
    const double* s = this->Image->GetSpacing();
    return ffd::Lattice({ this->GetNodes(), {} }, { o[0], o[1], o[2] }, { s[0], s[1], s[2] });
  }

  /// Index of a control point; -1, and an error of `self`, where there is none.
  vtkIdType FindIndex(vtkFFDLattice* self, const char* name, int i, int j, int k) const
  {
    const ffd::Lattice grid = this->GetGrid();
    if (grid.HasPoint({ i, j, k }))
    {
      const auto index = static_cast<vtkIdType>(grid.IndexOf({ i, j, k }));
      if (index < this->Array->GetNumberOfTuples())
      {
        return index;
      }
    }
    vtkErrorWithObjectMacro(self, << name << ": there is no control point (" << i << ", " << j
                                  << ", " << k << "). Indices start at 0; see GetDimensions().");
    return -1;
  }

  /// Takes over a lattice without a problem.
  void SetValue(vtkFFDLattice* self, const ffd::Lattice& value)
  {
    // A new image, so that shallow copies and readers of the old one keep what they have. The old
    // one stays until the new one has its memory.
    this->Array = vtkFFDMakeDisplacementArray(value.Net.Values);
    this->Image = vtkSmartPointer<vtkImageData>::New();
    this->Image->SetDimensions(&value.Net.Nodes.x);
    this->Image->SetOrigin(&value.Origin.x);
    this->Image->SetSpacing(&value.Spacing.x);
    this->Image->GetPointData()->SetScalars(this->Array);
    this->Connect(self);
    self->BorderMode = static_cast<int>(value.Border);
    self->DisplacementScale = value.Scale;
    self->InverseFlag = value.Inverse ? 1 : 0;
  }

  /// Hand the image to the superclass, past the virtual methods that adopt a copy.
  void Connect(vtkFFDLattice* self) const
  {
    this->Producer->SetOutput(this->Image);
    self->vtkBSplineTransform::SetCoefficientConnection(this->Producer->GetOutputPort());
  }

  /// Replaces the value by what `change` makes of it, with so many control points.
  int Change(vtkFFDLattice* self, const char* name, const glm::ivec3& nodes,
    const std::function<ffd::Lattice(const ffd::Lattice&)>& change)
  {
    const std::string problem = this->FindTampering();
    if (!problem.empty())
    {
      vtkErrorWithObjectMacro(self, << name << ": the control points are not usable: " << problem
                                    << ". Put this right first, e.g. with Reset().");
      return 0;
    }
    return vtkFFDGuard(self, name, [&] {
      RequireMemory(nodes);
      this->SetValue(self, change(vtkFFDGetLatticeValue(self, this->Array)));
      self->Modified();
    });
  }
};

//------------------------------------------------------------------------------
vtkFFDLattice::vtkFFDLattice()
  : Lattice(new vtkLatticeInternals)
  , Dimensions{ ffd::Lattice::MinimumNodes, ffd::Lattice::MinimumNodes, ffd::Lattice::MinimumNodes }
  , Domain{ 0.0, 1.0, 0.0, 1.0, 0.0, 1.0 }
{
  this->Lattice->SetValue(this, ffd::Lattice());
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
  this->FollowInverse();
  const glm::ivec3 wanted(nx, ny, nz);
  for (int a = 0; a < 3; ++a)
  {
    if (wanted[a] < ffd::Lattice::MinimumNodes || wanted[a] > ffd::Lattice::MaximumNodes)
    {
      vtkErrorMacro("SetDimensions: (" << nx << ", " << ny << ", " << nz
                                       << ") control points are not possible. Give 4 to 1024 per "
                                          "axis: a cubic B-spline cell has 4.");
      return;
    }
  }
  if (wanted != this->Lattice->GetNodes())
  {
    this->Lattice->Change(this, "SetDimensions", wanted,
      [&](const ffd::Lattice& value) { return value.Resize(wanted); });
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetDimensions(int dimensions[3])
{
  this->FollowInverse();
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
  this->FollowInverse();
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
  this->FollowInverse();
  if (!bounds)
  {
    vtkErrorMacro("SetDomain: bounds is null. Give (xmin, xmax, ymin, ymax, zmin, zmax).");
    return;
  }
  ffd::Lattice value = this->Lattice->GetGrid();
  const int axis = value.SetDomain(ToBox(bounds));
  if (axis >= 0)
  {
    vtkErrorMacro("SetDomain: the domain "
      << DescribeBounds(bounds) << " is empty, inverted or not finite on axis " << axis
      << ". Give bounds of at most 1e99, with min < max per axis.");
    return;
  }
  vtkImageData* image = this->Lattice->Image;
  if (std::equal(&value.Origin.x, &value.Origin.x + 3, image->GetOrigin()) &&
    std::equal(&value.Spacing.x, &value.Spacing.x + 3, image->GetSpacing()))
  {
    return;
  }
  image->SetOrigin(&value.Origin.x);
  image->SetSpacing(&value.Spacing.x);
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetDomain(double bounds[6])
{
  this->FollowInverse();
  FromBox(this->Lattice->GetGrid().GetDomain(), bounds);
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
    vtkErrorMacro(
      "FitToBounds: the padding is " << padding << ". Give a fraction of the extent, 0 or more.");
    return;
  }
  ffd::Box fitted = ToBox(bounds);
  if (!AreBounds(bounds) || !ffd::WidenFlatAxes(fitted))
  {
    vtkErrorMacro("FitToBounds: the bounds "
      << DescribeBounds(bounds)
      << " are inverted, not finite or a single point. Give the bounds of the data, at least one "
         "axis with an extent.");
    return;
  }
  const glm::dvec3 pad = padding * (fitted.Max - fitted.Min);
  double domain[6];
  FromBox({ fitted.Min - pad, fitted.Max + pad }, domain);
  this->SetDomain(domain);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetRestPoint(int i, int j, int k, double point[3])
{
  this->FollowInverse();
  const bool found = this->Lattice->FindIndex(this, "GetRestPoint", i, j, k) >= 0;
  const glm::dvec3 at =
    found ? this->Lattice->GetGrid().GetRestPoint({ i, j, k }) : glm::dvec3(0.0);
  std::copy_n(&at.x, 3, point);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetSpacing(double spacing[3])
{
  this->FollowInverse();
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
  this->FollowInverse();
  const glm::dvec3 move = glm::dvec3(x, y, z) - this->Lattice->GetGrid().GetRestPoint({ i, j, k });
  this->SetDisplacement(i, j, k, move.x, move.y, move.z);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetControlPoint(int i, int j, int k, double point[3])
{
  if (this->Lattice->FindIndex(this, "GetControlPoint", i, j, k) < 0)
  {
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
  this->FollowInverse();
  const vtkIdType index = this->Lattice->FindIndex(this, "SetDisplacement", i, j, k);
  if (index < 0)
  {
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
  vtkDoubleArray* array = this->Lattice->Array;
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
  this->FollowInverse();
  const vtkIdType index = this->Lattice->FindIndex(this, "GetDisplacement", i, j, k);
  if (index < 0)
  {
    std::fill_n(displacement, 3, 0.0);
    return;
  }
  this->Lattice->Array->GetTypedTuple(index, displacement);
}

//------------------------------------------------------------------------------
vtkDoubleArray* vtkFFDLattice::GetDisplacements()
{
  this->FollowInverse();
  return this->Lattice->Array;
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
  if (!vtkFFDGuard(this, "SetDisplacements", [&] { values = vtkFFDCopyTuples(displacements); }))
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
  if (vtkFFDWriteTuples(values, this->Lattice->Array))
  {
    this->Modified();
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkFFDLattice::Reset()
{
  this->FollowInverse();
  if (!this->Lattice->FindTampering().empty())
  {
    // The image, or its array, was given another size.
    vtkFFDGuard(this, "Reset", [this] {
      ffd::Lattice value = vtkFFDGetLatticeValue(this, this->Lattice->Array);
      if (value.HasPossibleDimensions())
      {
        RequireMemory(value.Net.Nodes);
        value.Net.Values.assign(ffd::GridSize(value.Net.Nodes), glm::dvec3(0.0));
      }
      this->Lattice->SetValue(this, value.FindProblem().empty() ? value : ffd::Lattice());
      this->Modified();
    });
  }
  else if (!this->Lattice->HasOnlyZeros())
  {
    this->Lattice->Array->FillValue(0.0);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
bool vtkFFDLattice::IsIdentity()
{
  this->FollowInverse();
  return this->DisplacementScale == 0.0 || this->Lattice->HasOnlyZeros();
}

//------------------------------------------------------------------------------
int vtkFFDLattice::Refine(int factorX, int factorY, int factorZ)
{
  this->FollowInverse();
  const glm::ivec3 factors(factorX, factorY, factorZ);
  const glm::ivec3 nodes = this->Lattice->GetNodes();
  for (int a = 0; a < 3; ++a)
  {
    if (factors[a] < 1 || factors[a] > ffd::Lattice::MaximumFactor ||
      (nodes[a] - 3) * factors[a] + 3 > ffd::Lattice::MaximumNodes)
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
  return this->Lattice->Change(this, "Refine", (nodes - 3) * factors + 3,
    [&](const ffd::Lattice& value) { return value.Refine(factors); });
}

//------------------------------------------------------------------------------
int vtkFFDLattice::Extend(int layers)
{
  this->FollowInverse();
  const glm::ivec3 nodes = this->Lattice->GetNodes();
  const int largest = std::max({ nodes.x, nodes.y, nodes.z });
  if (layers < 1 || layers > ffd::Lattice::MaximumFactor ||
    largest + 2 * layers > ffd::Lattice::MaximumNodes)
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
  return this->Lattice->Change(this, "Extend", nodes + 2 * layers,
    [layers](const ffd::Lattice& value) { return value.Extend(layers); });
}

//------------------------------------------------------------------------------
double vtkFFDLattice::FitToTransform(
  vtkAbstractTransform* transform, const double bounds[6], double tolerance, int maximumCells)
{
  this->FollowInverse();
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
  ffd::Box domain = bounds ? ToBox(bounds) : ffd::Box();
  if (!AreBounds(bounds) || !ffd::WidenFlatAxes(domain))
  {
    vtkErrorMacro("FitToTransform: the bounds "
      << DescribeBounds(bounds)
      << " are inverted, not finite or a single point. Give the bounds of the data.");
    return -1.0;
  }
  ffd::FitLimits limits;
  limits.Tolerance = tolerance;
  limits.MaximumCells = maximumCells;
  limits.Parallel = vtkFFDParallelFor();
  return vtkFFDGuarded(this, "FitToTransform", -1.0, [&] {
    ffd::FunctionFit fit(
      vtkFFDMakeTransformSampler(transform, limits.Parallel), domain.Min, domain.Max - domain.Min);
    const ffd::FitStatus status = fit.Run(limits);
    ffd::Lattice value;
    value.Take(fit.GetNet());
    const std::string problem = status == ffd::FitStatus::NotFinite
      ? "the transform gives points that are not finite"
      : value.FindProblem();
    if (!problem.empty())
    {
      vtkErrorMacro("FitToTransform: the "
        << transform->GetClassName() << " cannot be followed within " << DescribeBounds(bounds)
        << ": " << problem << ". The lattice is left as it was.");
      return -1.0;
    }
    this->Lattice->SetValue(this, value);
    this->Modified();
    return fit.GetNet().LargestError;
  });
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetDeformedBounds(const double restBounds[6], double bounds[6])
{
  vtkMath::UninitializeBounds(bounds);
  if (!AreBounds(restBounds))
  {
    vtkErrorMacro("GetDeformedBounds: the bounds "
      << DescribeBounds(restBounds)
      << " are inverted or not finite. Give those of the undeformed object.");
    return;
  }
  this->Update();
  const ffd::Box none{ glm::dvec3(1.0), glm::dvec3(-1.0) };
  const ffd::Box box = vtkFFDGuarded(this, "GetDeformedBounds", none,
    [&] { return this->Lattice->Map.GetDeformedBounds(ToBox(restBounds)); });
  if (!box.IsEmpty())
  {
    FromBox(box, bounds);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetDisplacementBounds(double bounds[6])
{
  this->Update();
  FromBox(vtkFFDGuarded(this, "GetDisplacementBounds", ffd::Box(),
            [this] { return this->Lattice->Map.GetDisplacementBounds(); }),
    bounds);
}

//------------------------------------------------------------------------------
void vtkFFDLattice::GetJacobianDeterminantBounds(double range[2])
{
  this->Update();
  // Nothing is proven where nothing can be computed.
  const ffd::Range unknown{ -VTK_DOUBLE_MAX, VTK_DOUBLE_MAX };
  const ffd::Range found = vtkFFDGuarded(this, "GetJacobianDeterminantBounds", unknown,
    [this] { return this->Lattice->Map.GetDeterminantBounds(); });
  range[0] = found.Min;
  range[1] = found.Max;
}

//------------------------------------------------------------------------------
double vtkFFDLattice::GetMinimumJacobianBound()
{
  double range[2];
  this->GetJacobianDeterminantBounds(range);
  return range[0];
}

//------------------------------------------------------------------------------
bool vtkFFDLattice::HasLattice(vtkDataObject* object) { return vtkFFDHasLattice(object); }

//------------------------------------------------------------------------------
void vtkFFDLattice::DetachFrom(vtkDataObject* object) { vtkFFDRemoveLattice(object); }

//------------------------------------------------------------------------------
int vtkFFDLattice::AttachTo(vtkDataObject* object)
{
  if (!object)
  {
    vtkErrorMacro("AttachTo: the data object is null. Give the data set to deform.");
    return 0;
  }
  return vtkFFDGuard(
    this, "AttachTo", [&] { vtkFFDWriteLattice(vtkFFDGetLatticeValue(this), object); });
}

//------------------------------------------------------------------------------
int vtkFFDLattice::ReadFrom(vtkDataObject* object)
{
  this->FollowInverse();
  return vtkFFDGuarded(this, "ReadFrom", 0, [&] {
    ffd::Lattice value;
    const std::string problem = vtkFFDReadLattice(object, value);
    if (!problem.empty())
    {
      vtkErrorMacro("ReadFrom: no lattice can be read from the "
        << (object ? object->GetClassName() : "data object") << ": " << problem
        << ". Attach one with AttachTo() or vtkFFDDeformVolume.");
      return 0;
    }
    this->Lattice->SetValue(this, value);
    this->Modified();
    return 1;
  });
}

//------------------------------------------------------------------------------
int vtkFFDLattice::ToImageData(vtkImageData* image)
{
  if (!image)
  {
    vtkErrorMacro("ToImageData: the image is null. Give a vtkImageData to fill.");
    return 0;
  }
  if (image == this->Lattice->Image)
  {
    vtkErrorMacro("ToImageData: the image is that of GetCoefficientData(), which holds the control "
                  "points themselves. Give an image of its own.");
    return 0;
  }
  this->FollowInverse();
  return vtkFFDGuard(this, "ToImageData", [&] {
    image->DeepCopy(this->Lattice->Image);
    vtkFFDWriteLatticeOptions(vtkFFDGetLatticeValue(this, this->Lattice->Array), image);
  });
}

//------------------------------------------------------------------------------
int vtkFFDLattice::FromImageData(vtkImageData* image)
{
  this->FollowInverse();
  return vtkFFDGuarded(this, "FromImageData", 0, [&] {
    ffd::Lattice value = vtkFFDGetLatticeValue(this, this->Lattice->Array);
    const std::string problem = vtkFFDReadLatticeImage(image, value);
    if (!problem.empty())
    {
      vtkErrorMacro("The image cannot be the control points of a lattice: "
        << problem << ". Give an image of displacements, 4 or more points per axis.");
      return 0;
    }
    this->Lattice->SetValue(this, value);
    this->Modified();
    return 1;
  });
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
  vtkFFDUpdateWhole(connection, nullptr);
  this->FromImageData(
    vtkImageData::SafeDownCast(producer->GetOutputDataObject(connection->GetIndex())));
}

//------------------------------------------------------------------------------
vtkImageData* vtkFFDLattice::GetCoefficientData() { return this->Lattice->Image; }

//------------------------------------------------------------------------------
void vtkFFDLattice::SetDisplacementScale(double scale)
{
  this->FollowInverse();
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
  if (vtkFFDIsInverseTolerance(this, tolerance))
  {
    this->FollowInverse();
    this->Superclass::SetInverseTolerance(tolerance);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::SetBorderMode(int mode)
{
  this->FollowInverse();
  this->Superclass::SetBorderMode(mode);
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
  other->FollowInverse();
  this->FollowInverse();
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
void vtkFFDLattice::FollowInverse()
{
  if (this->MayBeInverse)
  {
    this->Update();
  }
}

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDLattice::MakeTransform()
{
  // GetInverse() calls this; what depends on what is private to the superclass.
  vtkFFDLattice* const made = vtkFFDLattice::New();
  made->MayBeInverse = true;
  return made;
}

//------------------------------------------------------------------------------
void vtkFFDLattice::InternalDeepCopy(vtkAbstractTransform* transform)
{
  // vtkAbstractTransform::DeepCopy lets nothing but lattices through.
  vtkFFDLattice* other = vtkFFDLattice::SafeDownCast(transform);
  other->FollowInverse();
  if (this->MayBeInverse && other != this->GetInverse()) // with which Update() calls this
  {
    this->FollowInverse();
  }
  vtkFFDGuard(this, "DeepCopy", [&] {
    RequireMemory(other->Lattice->GetNodes());
    this->Lattice->SetValue(this, vtkFFDGetLatticeValue(other));
  });
  this->InverseTolerance = other->InverseTolerance;
  this->InverseIterations = other->InverseIterations;
}

//------------------------------------------------------------------------------
void vtkFFDLattice::InternalUpdate()
{
  std::string problem = this->Lattice->FindTampering();
  const bool computed = vtkFFDGuard(this, "Update", [&] {
    if (problem.empty())
    {
      RequireMemory(this->Lattice->GetNodes(), 2.0 / 3.0 * BytesPerPoint); // it has its array
      const ffd::Lattice value = vtkFFDGetLatticeValue(this, this->Lattice->Array);
      problem = value.FindProblem();
      if (problem.empty())
      {
        this->Superclass::InternalUpdate();
        this->Lattice->Map.Update(value, this->InverseTolerance);
      }
    }
  });
  if (!problem.empty())
  {
    vtkErrorMacro("The control points are not usable: "
      << problem << ". The lattice does not deform until this is put right, e.g. with Reset().");
  }
  if (!computed || !problem.empty())
  {
    this->GridPointer = nullptr;
    this->Lattice->Map.Reset(this->InverseTolerance);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLattice::InverseTransformDerivative(
  const double in[3], double out[3], double derivative[3][3])
{
  glm::dmat3 jacobian;
  const glm::dvec3 q = this->Lattice->Map.Invert({ in[0], in[1], in[2] }, jacobian);
  for (int a = 0; a < 3; ++a)
  {
    out[a] = q[a];
    for (int b = 0; b < 3; ++b)
    {
      derivative[a][b] = jacobian[b][a];
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
  const glm::dvec3 q = this->Lattice->Map.Invert({ in[0], in[1], in[2] });
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
