// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLatticeSource.h"

#include "vtkFFDGuard.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeData.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMinimalStandardRandomSequence.h"
#include "vtkObjectFactory.h"

#include <algorithm>
#include <cmath>
#include <string>

vtkStandardNewMacro(vtkFFDLatticeSource);
vtkFFDGuardedProcessRequestMacro(vtkFFDLatticeSource);

namespace
{

/// The lattice, two copies while its shape is computed, and the output.
constexpr double BytesPerPoint = 96.0;

constexpr const char* ShapeNames[] = { "Identity", "Bend", "Twist", "Taper", "Bulge", "Wave",
  "Random" };

/// Moves a point, given relative to the domain's center, by a shape.
void MovePoint(int shape, double strength, const double half[3], const double p[3], double moved[3])
{
  std::copy(p, p + 3, moved);
  switch (shape)
  {
    case vtkFFDLatticeSource::BEND:
    {
      const double curvature = strength * 0.5 * vtkMath::Pi() / (2.0 * half[0]);
      // The limit of no curvature is the identity; dividing by it would be 0 / 0.
      if (std::abs(curvature) * half[0] > 1e-9)
      {
        const double angle = curvature * p[0];
        const double radius = 1.0 / curvature - p[1];
        moved[0] = radius * std::sin(angle);
        moved[1] = 1.0 / curvature - radius * std::cos(angle);
      }
      break;
    }
    case vtkFFDLatticeSource::TWIST:
    {
      const double angle = strength * 0.25 * vtkMath::Pi() * p[2] / half[2];
      moved[0] = std::cos(angle) * p[0] - std::sin(angle) * p[1];
      moved[1] = std::sin(angle) * p[0] + std::cos(angle) * p[1];
      break;
    }
    case vtkFFDLatticeSource::TAPER:
    {
      const double factor = 1.0 - 0.5 * strength * p[2] / half[2];
      moved[0] = factor * p[0];
      moved[1] = factor * p[1];
      break;
    }
    case vtkFFDLatticeSource::BULGE:
    {
      double square = 0.0;
      for (int a = 0; a < 3; ++a)
      {
        square += (p[a] / half[a]) * (p[a] / half[a]);
      }
      const double fade = std::max(0.0, 1.0 - square);
      for (int a = 0; a < 3; ++a)
      {
        moved[a] = p[a] * (1.0 + 0.5 * strength * fade * fade);
      }
      break;
    }
    case vtkFFDLatticeSource::WAVE:
      moved[2] += strength * 0.2 * half[2] * std::sin(2.0 * vtkMath::Pi() * p[0] / half[0]);
      break;
    default:
      break;
  }
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDLatticeSource::vtkFFDLatticeSource()
  : Bounds{ 0.0, 1.0, 0.0, 1.0, 0.0, 1.0 }
  , Dimensions{ 8, 8, 8 }
  , Padding(0.0)
  , Shape(IDENTITY)
  , Strength(1.0)
  , Seed(1)
  , BorderMode(VTK_BSPLINE_EDGE)
  , FoldFree(0)
  , MinimumJacobian(0.05)
  , FoldFreeFactor(1.0)
{
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkFFDLatticeSource::~vtkFFDLatticeSource() = default;

//------------------------------------------------------------------------------
void vtkFFDLatticeSource::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Bounds: (" << this->Bounds[0] << ", " << this->Bounds[1] << ", "
     << this->Bounds[2] << ", " << this->Bounds[3] << ", " << this->Bounds[4] << ", "
     << this->Bounds[5] << ")\n";
  os << indent << "Dimensions: (" << this->Dimensions[0] << ", " << this->Dimensions[1] << ", "
     << this->Dimensions[2] << ")\n";
  os << indent << "Padding: " << this->Padding << "\n";
  os << indent << "Shape: " << this->GetShapeAsString() << "\n";
  os << indent << "Strength: " << this->Strength << "\n";
  os << indent << "Seed: " << this->Seed << "\n";
  os << indent << "BorderMode: " << this->BorderMode << "\n";
  os << indent << "FoldFree: " << this->FoldFree << "\n";
  os << indent << "MinimumJacobian: " << this->MinimumJacobian << "\n";
  os << indent << "FoldFreeFactor: " << this->FoldFreeFactor << "\n";
  os << indent << "Lattice:\n";
  this->Lattice->PrintSelf(os, indent.GetNextIndent());
}

//------------------------------------------------------------------------------
void vtkFFDLatticeSource::SetBounds(
  double xmin, double xmax, double ymin, double ymax, double zmin, double zmax)
{
  const double bounds[6] = { xmin, xmax, ymin, ymax, zmin, zmax };
  this->SetBounds(bounds);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeSource::SetBounds(const double bounds[6])
{
  bool usable = bounds != nullptr;
  bool extended = false;
  for (int a = 0; a < 3 && usable; ++a)
  {
    usable = std::isfinite(bounds[2 * a]) && std::isfinite(bounds[2 * a + 1]) &&
      bounds[2 * a] <= bounds[2 * a + 1];
    extended = extended || bounds[2 * a] < bounds[2 * a + 1];
  }
  if (!usable || !extended)
  {
    vtkErrorMacro(
      "SetBounds: the bounds are null, inverted, not finite or a single point. Give the "
      "bounds of the data, (xmin, xmax, ymin, ymax, zmin, zmax).");
    return;
  }
  if (!std::equal(bounds, bounds + 6, this->Bounds))
  {
    std::copy(bounds, bounds + 6, this->Bounds);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeSource::SetDimensions(const int dimensions[3])
{
  if (!dimensions)
  {
    vtkErrorMacro("SetDimensions: dimensions is null. Give three numbers.");
    return;
  }
  this->SetDimensions(dimensions[0], dimensions[1], dimensions[2]);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeSource::SetDimensions(int nx, int ny, int nz)
{
  const int wanted[3] = { nx, ny, nz };
  for (const int n : wanted)
  {
    if (n < 4 || n > 1024)
    {
      vtkErrorMacro("SetDimensions: (" << nx << ", " << ny << ", " << nz
                                       << ") control points are not possible. Give 4 to 1024 per "
                                          "axis.");
      return;
    }
  }
  if (!std::equal(wanted, wanted + 3, this->Dimensions))
  {
    std::copy(wanted, wanted + 3, this->Dimensions);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeSource::SetPadding(double padding)
{
  if (!std::isfinite(padding) || padding < 0.0)
  {
    vtkErrorMacro(
      "SetPadding: the padding is " << padding << ". Give a fraction of the extent, 0 or more.");
    return;
  }
  if (this->Padding != padding)
  {
    this->Padding = padding;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeSource::SetShape(int shape)
{
  if (shape < IDENTITY || shape > RANDOM)
  {
    vtkErrorMacro("SetShape: there is no shape " << shape << ". Give IDENTITY (0) to RANDOM (6).");
    return;
  }
  if (this->Shape != shape)
  {
    this->Shape = shape;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
const char* vtkFFDLatticeSource::GetShapeAsString() { return ShapeNames[this->Shape]; }

//------------------------------------------------------------------------------
void vtkFFDLatticeSource::SetStrength(double strength)
{
  if (!std::isfinite(strength))
  {
    vtkErrorMacro("SetStrength: the strength is " << strength << ". Give a finite number.");
    return;
  }
  if (this->Strength != strength)
  {
    this->Strength = strength;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeSource::SetMinimumJacobian(double determinant)
{
  if (!(determinant > 0.0 && determinant < 1.0))
  {
    vtkErrorMacro("SetMinimumJacobian: the determinant is "
      << determinant << ". Give a number above 0 and below 1; without deformation it is 1.");
    return;
  }
  if (this->MinimumJacobian != determinant)
  {
    this->MinimumJacobian = determinant;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
double vtkFFDLatticeSource::LimitToFoldFree(vtkFFDLattice* lattice, double minimumJacobian)
{
  if (!lattice || !(minimumJacobian > 0.0 && minimumJacobian < 1.0))
  {
    vtkGenericWarningMacro("vtkFFDLatticeSource::LimitToFoldFree: "
      << (lattice ? "the determinant is out of range" : "the lattice is null")
      << ". Give a lattice, and a determinant above 0 and below 1.");
    return 0.0;
  }
  if (lattice->GetMinimumJacobianBound() >= minimumJacobian)
  {
    return 1.0;
  }
  // The determinant need not fall steadily with the factor, but it is 1 at 0: the search ends at
  // a factor that is proven, if not at the largest one.
  constexpr double precision = 1e-3;
  const double scale = lattice->GetDisplacementScale();
  double proven = 0.0;
  double failed = 1.0;
  while (failed - proven > precision * failed)
  {
    const double factor = 0.5 * (proven + failed);
    lattice->SetDisplacementScale(factor * scale);
    (lattice->GetMinimumJacobianBound() >= minimumJacobian ? proven : failed) = factor;
    if (failed < 1e-12)
    {
      break;
    }
  }
  lattice->SetDisplacementScale(scale);
  vtkNew<vtkDoubleArray> displacements;
  displacements->DeepCopy(lattice->GetDisplacements());
  for (vtkIdType i = 0; i < displacements->GetNumberOfValues(); ++i)
  {
    displacements->SetValue(i, proven * displacements->GetValue(i));
  }
  lattice->SetDisplacements(displacements);
  return proven;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeSource::ApplyShape(vtkFFDLattice* lattice, int shape, double strength, int seed)
{
  if (!lattice || shape < IDENTITY || shape > RANDOM || !std::isfinite(strength))
  {
    vtkGenericWarningMacro("vtkFFDLatticeSource::ApplyShape: "
      << (lattice ? "the shape or its strength is out of range" : "the lattice is null")
      << ". Give a lattice, IDENTITY (0) to RANDOM (6) and a finite strength.");
    return 0;
  }
  int n[3];
  double domain[6];
  double spacing[3];
  double center[3];
  double half[3];
  lattice->GetDimensions(n);
  lattice->GetDomain(domain);
  lattice->GetSpacing(spacing);
  for (int a = 0; a < 3; ++a)
  {
    center[a] = 0.5 * (domain[2 * a] + domain[2 * a + 1]);
    half[a] = 0.5 * (domain[2 * a + 1] - domain[2 * a]);
  }
  constexpr double foldFree = 0.4;
  vtkNew<vtkMinimalStandardRandomSequence> random;
  random->Initialize(static_cast<vtkTypeUInt32>(std::max(seed, 1)));
  vtkNew<vtkDoubleArray> displacements;
  displacements->SetNumberOfComponents(3);
  if (!vtkFFDGuard(lattice, "ApplyShape",
        [&] { displacements->SetNumberOfTuples(lattice->GetNumberOfControlPoints()); }))
  {
    return 0;
  }
  vtkIdType id = 0;
  for (int k = 0; k < n[2]; ++k)
  {
    for (int j = 0; j < n[1]; ++j)
    {
      for (int i = 0; i < n[0]; ++i)
      {
        double rest[3];
        double moved[3];
        double displacement[3];
        lattice->GetRestPoint(i, j, k, rest);
        vtkMath::Subtract(rest, center, rest);
        MovePoint(shape, strength, half, rest, moved);
        vtkMath::Subtract(moved, rest, displacement);
        if (shape == RANDOM)
        {
          for (int a = 0; a < 3; ++a)
          {
            displacement[a] = strength * foldFree * spacing[a] * random->GetRangeValue(-1.0, 1.0);
            random->Next();
          }
        }
        displacements->SetTypedTuple(id++, displacement);
      }
    }
  }
  return lattice->SetDisplacements(displacements);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeSource::UpdateLattice()
{
  const double points = 1.0 * this->Dimensions[0] * this->Dimensions[1] * this->Dimensions[2];
  vtkFFDRequireMemory(BytesPerPoint * points,
    std::to_string(this->Dimensions[0]) + " x " + std::to_string(this->Dimensions[1]) + " x " +
      std::to_string(this->Dimensions[2]) + " control points",
    "Give smaller Dimensions.");
  // Reset first: resizing would carry the old shape over, to be overwritten.
  this->Lattice->Reset();
  this->Lattice->SetDimensions(this->Dimensions);
  this->Lattice->FitToBounds(this->Bounds, this->Padding);
  this->Lattice->SetBorderMode(this->BorderMode);
  vtkFFDLatticeSource::ApplyShape(this->Lattice, this->Shape, this->Strength, this->Seed);
  this->FoldFreeFactor = this->FoldFree
    ? vtkFFDLatticeSource::LimitToFoldFree(this->Lattice, this->MinimumJacobian)
    : 1.0;
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDLatticeSource::GetLattice()
{
  this->Update();
  return this->Lattice;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeSource::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  this->UpdateLattice();
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkFFDDescribeLatticeImage(this->Lattice, info);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeSource::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  // Again, as GetLattice() lets the user edit it. The whole image, whatever extent is asked for.
  this->UpdateLattice();
  return this->Lattice->ToImageData(vtkImageData::GetData(outputs));
}
