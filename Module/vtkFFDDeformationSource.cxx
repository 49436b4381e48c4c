// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDeformationSource.h"

#include "vtkFFDBSplineFieldFromTransform.h"

#include "vtkAbstractTransform.h"
#include "vtkBSplineTransform.h"
#include "vtkBoundingBox.h"
#include "vtkFFDLattice.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace
{

/// Points a side of the grid that probes where a foreign transform moves the volume.
constexpr int ProbesPerSide = 9;
/// What is added on each side to the region so found, by its size.
constexpr double RegionMargin = 0.1;

bool IsSame(const ffd::BSplineField& a, const ffd::BSplineField& b)
{
  return a.GetNodes() == b.GetNodes() && a.GetOrigin() == b.GetOrigin() &&
    a.GetSpacing() == b.GetSpacing() && a.GetBorder() == b.GetBorder() &&
    a.GetCoefficients() == b.GetCoefficients();
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDDeformationSource::vtkFFDDeformationSource() = default;

//------------------------------------------------------------------------------
vtkFFDDeformationSource::~vtkFFDDeformationSource() = default;

//------------------------------------------------------------------------------
bool vtkFFDDeformationSource::Update(vtkAbstractTransform* transform, vtkDataObject* image,
  const double bounds[6], double tolerance, std::string& message, std::string& warning)
{
  const bool attached = !transform && vtkFFDLattice::HasLattice(image);
  const bool foreign = transform && !vtkBSplineTransform::SafeDownCast(transform);
  const void* from = transform;
  vtkMTimeType time = 0;
  if (transform)
  {
    transform->Update();
    time = transform->GetMTime();
  }
  else if (attached)
  {
    from = image;
    time = std::max(image->GetMTime(), image->GetFieldData()->GetMTime());
  }
  // Only an approximation depends on where it is made and how well.
  const bool same = this->Changed.GetMTime() > 0 && this->MadeFrom == from &&
    this->MadeFromTime == time &&
    (!foreign ||
      (this->MadeWithTolerance == tolerance &&
        std::equal(bounds, bounds + 6, this->MadeForBounds)));
  if (same)
  {
    return true;
  }

  ffd::BSplineField field;
  bool inverted = false;
  vtkBSplineTransform* spline = vtkBSplineTransform::SafeDownCast(transform);
  if (attached)
  {
    if (!this->Lattice->ReadFrom(image))
    {
      message = "The lattice attached to the input cannot be read. Attach it again with "
                "vtkFFDLattice::AttachTo(), or remove it with vtkFFDLattice::DetachFrom().";
      return false;
    }
    spline = this->Lattice;
  }
  else if (foreign)
  {
    double region[6];
    this->FindFitRegion(transform, bounds, region);
    const double error = this->Lattice->FitToTransform(transform, region, tolerance);
    if (error < 0.0)
    {
      message = std::string("The deformation, a ") + transform->GetClassName() +
        ", cannot be approximated by a lattice over the volume. Check that it is finite there.";
      return false;
    }
    if (error > tolerance)
    {
      std::ostringstream text;
      text << "The deformation, a " << transform->GetClassName()
           << ", is approximated by a lattice with an error of " << error
           << " instead of the PositionTolerance of " << tolerance << " (data units).";
      warning = text.str();
    }
    spline = this->Lattice;
  }
  std::string reason;
  if (spline && !vtkFFDBSplineFieldFromTransform(spline, field, inverted, reason))
  {
    message = "The deformation cannot be used: " + reason;
    return false;
  }
  // Read again is not changed: an image with a lattice may be new for other reasons.
  const bool changed = this->Changed.GetMTime() == 0 || inverted != this->Inverted ||
    !IsSame(field, this->Field);
  this->MadeFrom = from;
  this->MadeFromTime = time;
  std::copy_n(bounds, 6, this->MadeForBounds);
  this->MadeWithTolerance = tolerance;
  if (changed)
  {
    this->Field = field;
    this->Inverted = inverted;
    this->Changed.Modified();
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkFFDDeformationSource::FindFitRegion(
  vtkAbstractTransform* transform, const double bounds[6], double region[6]) const
{
  // The renderer evaluates the deformation in the volume at rest and, in the other inverse modes,
  // where the volume is moved to or comes from: all of that has to be covered.
  vtkBoundingBox box(bounds);
  vtkAbstractTransform* const directions[2] = { transform, transform->GetInverse() };
  for (vtkAbstractTransform* direction : directions)
  {
    for (int i = 0; i < ProbesPerSide * ProbesPerSide * ProbesPerSide; ++i)
    {
      const int index[3] = { i % ProbesPerSide, i / ProbesPerSide % ProbesPerSide,
        i / (ProbesPerSide * ProbesPerSide) };
      double p[3];
      for (int a = 0; a < 3; ++a)
      {
        p[a] = bounds[2 * a] +
          (bounds[2 * a + 1] - bounds[2 * a]) * index[a] / (ProbesPerSide - 1);
      }
      direction->TransformPoint(p, p);
      if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))
      {
        box.AddPoint(p);
      }
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    const double margin = RegionMargin * box.GetLength(a);
    region[2 * a] = box.GetBound(2 * a) - margin;
    region[2 * a + 1] = box.GetBound(2 * a + 1) + margin;
  }
}

//------------------------------------------------------------------------------
std::size_t vtkFFDDeformationSource::GetMemorySize() const
{
  return this->Field.GetCoefficients().capacity() * sizeof(glm::dvec3);
}
