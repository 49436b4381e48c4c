// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDeformationSource.h"

#include "vtkFFDBSplineFieldFromTransform.h"

#include "vtkAbstractTransform.h"
#include "vtkBoundingBox.h"
#include "vtkBSplineTransform.h"
#include "vtkFFDLattice.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

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

/// The box over which a lattice stands for a transform.
void FindFitRegion(vtkAbstractTransform* transform, const double bounds[6], double region[6])
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
        p[a] = bounds[2 * a] + (bounds[2 * a + 1] - bounds[2 * a]) * index[a] / (ProbesPerSide - 1);
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

} // namespace

//------------------------------------------------------------------------------
ffd::Made ffd::MakeDeformationField(DeformationField& result, StageTools& tools,
  const Source<vtkAbstractTransform>& source, const Source<vtkDataObject>& attached,
  const std::optional<FitLimits>& fit)
{
  vtkAbstractTransform* transform = source.Object;
  vtkBSplineTransform* spline = vtkBSplineTransform::SafeDownCast(transform);
  if (!result.Lattice)
  {
    result.Lattice = vtkSmartPointer<vtkFFDLattice>::New();
  }
  if (attached.Object)
  {
    if (!result.Lattice->ReadFrom(attached.Object))
    {
      tools.Message = "The lattice attached to the input cannot be read. Attach it again with "
                      "vtkFFDLattice::AttachTo(), or remove it with vtkFFDLattice::DetachFrom().";
      return Made::Not;
    }
    spline = result.Lattice;
  }
  else if (fit)
  {
    double region[6];
    FindFitRegion(transform, fit->data(), region);
    const double tolerance = fit->back();
    const double error = result.Lattice->FitToTransform(transform, region, tolerance);
    if (error < 0.0)
    {
      tools.Message = std::string("The deformation, a ") + transform->GetClassName() +
        ", cannot be approximated by a lattice over the volume. Check that it is finite there.";
      return Made::Not;
    }
    if (error > tolerance)
    {
      std::ostringstream text;
      text << "The deformation, a " << transform->GetClassName()
           << ", is approximated by a lattice with an error of " << error
           << " instead of the PositionTolerance of " << tolerance << " (data units).";
      tools.Warning = text.str();
    }
    spline = result.Lattice;
  }
  BSplineField field;
  bool inverted = false;
  std::string reason;
  if (spline && !vtkFFDBSplineFieldFromTransform(spline, field, inverted, reason))
  {
    tools.Message = "The deformation cannot be used: " + reason;
    return Made::Not;
  }
  // An image with a lattice may be new for other reasons.
  if (inverted == result.Inverted && IsSame(field, result.Field))
  {
    return Made::Same;
  }
  result.Field = std::move(field);
  result.Inverted = inverted;
  return Made::Anew;
}

//------------------------------------------------------------------------------
vtkFFDDeformationSource::vtkFFDDeformationSource(ffd::StageOrder& order)
  : Field(order)
{
}

//------------------------------------------------------------------------------
vtkFFDDeformationSource::~vtkFFDDeformationSource() = default;

//------------------------------------------------------------------------------
bool vtkFFDDeformationSource::Update(vtkAbstractTransform* transform, vtkDataObject* image,
  const double bounds[6], double tolerance, ffd::StageTools& tools)
{
  ffd::Source<vtkAbstractTransform> source;
  ffd::Source<vtkDataObject> attached;
  std::optional<ffd::FitLimits> fit;
  if (transform)
  {
    transform->Update();
    source = { transform, transform->GetMTime() };
    if (!vtkBSplineTransform::SafeDownCast(transform))
    {
      fit.emplace();
      std::copy_n(bounds, 6, fit->begin());
      fit->back() = tolerance;
    }
  }
  else if (vtkFFDLattice::HasLattice(image))
  {
    attached = { image, std::max(image->GetMTime(), image->GetFieldData()->GetMTime()) };
  }
  return this->Field.Update(tools, source, attached, fit);
}

//------------------------------------------------------------------------------
std::size_t vtkFFDDeformationSource::GetMemorySize() const
{
  return this->Field.GetLast().Field.GetCoefficients().capacity() * sizeof(glm::dvec3);
}
