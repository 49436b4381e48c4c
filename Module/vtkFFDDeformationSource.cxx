// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDeformationSource.h"

#include "vtkFFDBSplineFieldFromTransform.h"
#include "vtkFFDLatticeData.h"
#include "vtkFFDTransformSampler.h"

#include "FFDLattice.h"

#include "vtkAbstractTransform.h"
#include "vtkBoundingBox.h"
#include "vtkBSplineTransform.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

namespace
{

/// Points a side of the grid that probes where a foreign transform moves the volume.
constexpr int ProbesPerSide = 9;
/// Margin that is added to the region on each side, as a fraction of its size.
constexpr double RegionMargin = 0.1;

/// The box over which a lattice stands for a transform.
ffd::Box FindFitRegion(vtkAbstractTransform* transform, const double bounds[6])
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
  ffd::Box region;
  for (int a = 0; a < 3; ++a)
  {
    const double margin = RegionMargin * box.GetLength(a);
    region.Min[a] = box.GetBound(2 * a) - margin;
    region.Max[a] = box.GetBound(2 * a + 1) + margin;
  }
  ffd::WidenFlatAxes(region);
  return region;
}

} // namespace

//------------------------------------------------------------------------------
ffd::Made ffd::MakeDeformationField(DeformationField& result, StageTools& tools,
  const Source<vtkAbstractTransform>& source, const Source<vtkDataObject>& attached,
  const std::optional<FitRegion>& fit)
{
  BSplineField field;
  bool inverted = false;
  double error = 0.0;
  std::string reason;
  if (attached.Object)
  {
    Lattice lattice;
    reason = vtkFFDReadLattice(attached.Object, lattice);
    if (!reason.empty())
    {
      tools.Message = "The lattice attached to the input cannot be read: " + reason +
        ". Attach it again with vtkFFDLattice::AttachTo(), or remove it with "
        "vtkFFDLattice::DetachFrom().";
      return Made::Not;
    }
    field = lattice.MakeField();
    inverted = lattice.Inverse;
  }
  else if (fit)
  {
    const std::string name = source.Object->GetClassName();
    Lattice lattice;
    FitLimits limits;
    limits.Tolerance = fit->back();
    const bool finite =
      lattice.Fit(FindFitRegion(source.Object, fit->data()),
        vtkFFDMakeTransformSampler(source.Object), limits, error) != FitStatus::NotFinite;
    reason = finite ? lattice.FindProblem() : "it gives points that are not finite";
    if (!reason.empty())
    {
      tools.Message = "The deformation, a " + name +
        ", cannot be approximated by a lattice over the volume: " + reason +
        ". Check that it is finite there.";
      return Made::Not;
    }
    if (error > limits.Tolerance)
    {
      std::ostringstream text;
      text << "The deformation, a " << name << ", is approximated by a lattice with an error of "
           << error << " instead of the PositionTolerance of " << limits.Tolerance
           << " (data units).";
      tools.Warning = text.str();
    }
    field = lattice.MakeField();
  }
  else if (source.Object &&
    !vtkFFDBSplineFieldFromTransform(
      vtkBSplineTransform::SafeDownCast(source.Object), field, inverted, reason))
  {
    tools.Message = "The deformation cannot be used: " + reason;
    return Made::Not;
  }
  // An image with a lattice may be new for other reasons.
  if (inverted == result.Inverted && error == result.Error && field == result.Field)
  {
    return Made::Same;
  }
  result.Field = std::move(field);
  result.Inverted = inverted;
  result.Error = error;
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
  std::optional<ffd::FitRegion> fit;
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
  else if (vtkFFDHasLattice(image))
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
