// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDeformationSource.h"

#include "vtkFFDBSplineFieldFromTransform.h"
#include "vtkFFDLatticeData.h"
#include "vtkFFDTransformSampler.h"

#include "FFDFunctionFit.h"
#include "FFDLattice.h"

#include "vtkAbstractTransform.h"
#include "vtkBoundingBox.h"
#include "vtkBSplineTransform.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkMath.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

namespace
{

/// Points a side of the grid that probes where a foreign transform moves the volume.
constexpr int ProbesPerSide = 9;
/// Margin around where a transform moves the volume, as a fraction of its size along each axis.
constexpr double RegionMargin = 0.1;
/// Residual of an inverse that counts as found, as a fraction of the diagonal of the volume.
constexpr double LargestResidual = 1e-3;
/// Margin around a volume where what happens in it alone matters, as a fraction of its longest
/// edge: positions that T^-1 is interpolated between lie there.
constexpr double MarginAtRest = 0.15;

/// The box to fit a lattice over.
ffd::Box MakeRegion(const vtkBoundingBox& box)
{
  ffd::Box region;
  for (int a = 0; a < 3; ++a)
  {
    region.Min[a] = box.GetBound(2 * a);
    region.Max[a] = box.GetBound(2 * a + 1);
  }
  ffd::WidenFlatAxes(region);
  return region;
}

vtkBoundingBox Inflate(vtkBoundingBox box)
{
  box.Inflate(RegionMargin * box.GetLength(0), RegionMargin * box.GetLength(1),
    RegionMargin * box.GetLength(2));
  return box;
}

/// Where a transform moves points of a volume to.
struct MovedBox
{
  vtkBoundingBox Box;
  bool IsInverse = true; ///< whether another transform is known to move all of them back
};

/// Moves points of a volume by a transform, and back by another one.
MovedBox FindMovedBox(
  const std::array<double, 6>& bounds, vtkAbstractTransform* transform, vtkAbstractTransform* back)
{
  MovedBox moved;
  const double largest = LargestResidual * vtkBoundingBox(bounds.data()).GetDiagonalLength();
  for (int i = 0; i < ProbesPerSide * ProbesPerSide * ProbesPerSide; ++i)
  {
    const int index[3] = { i % ProbesPerSide, i / ProbesPerSide % ProbesPerSide,
      i / (ProbesPerSide * ProbesPerSide) };
    double p[3];
    for (int a = 0; a < 3; ++a)
    {
      p[a] = bounds[2 * a] + (bounds[2 * a + 1] - bounds[2 * a]) * index[a] / (ProbesPerSide - 1);
    }
    double to[3];
    transform->TransformPoint(p, to);
    const bool isFinite = std::isfinite(to[0]) && std::isfinite(to[1]) && std::isfinite(to[2]);
    if (isFinite)
    {
      moved.Box.AddPoint(to);
    }
    if (isFinite && moved.IsInverse)
    {
      back->TransformPoint(to, to);
    }
    // False for what is not a number, too.
    moved.IsInverse =
      moved.IsInverse && isFinite && vtkMath::Distance2BetweenPoints(to, p) <= largest * largest;
  }
  return moved;
}

/// The fit of a transform over a region.
ffd::FunctionFit MakeFit(const ffd::DisplacementSampler& sampler, const ffd::Box& region)
{
  return ffd::FunctionFit(sampler, region.Min, region.Max - region.Min);
}

/// Fits a net to a transform as asked for; `domain`: see DeformationField.
ffd::FitStatus FitNet(vtkAbstractTransform* transform, const ffd::FitRequest& request,
  const ffd::ParallelFor& parallelFor, ffd::FittedNet& net, std::optional<ffd::Box>& domain)
{
  using ffd::FitStatus;
  const ffd::DisplacementSampler sampler = vtkFFDMakeTransformSampler(transform, parallelFor);
  ffd::FitLimits limits;
  limits.Tolerance = request.Tolerance;
  limits.Parallel = parallelFor;
  const int mostCells = limits.MaximumCells;
  const auto run = [&](ffd::FunctionFit& fit, int cells) {
    limits.MaximumCells = cells;
    const FitStatus status = fit.Run(limits);
    net = fit.GetNet();
    return status;
  };
  if (!request.AtRest)
  {
    // It stands for the transform and its inverse, also where they move the image to.
    vtkAbstractTransform* const inverse = transform->GetInverse();
    const MovedBox forward = FindMovedBox(request.Bounds, transform, inverse);
    const MovedBox backward = FindMovedBox(request.Bounds, inverse, transform);
    vtkBoundingBox all(request.Bounds.data());
    all.AddBox(forward.Box);
    all.AddBox(backward.Box);
    if (backward.IsInverse)
    {
      domain = MakeRegion(Inflate(backward.Box));
    }
    ffd::FunctionFit fit = MakeFit(sampler, MakeRegion(Inflate(all)));
    return run(fit, mostCells);
  }
  const vtkBoundingBox bounds(request.Bounds.data());
  vtkBoundingBox wider(bounds);
  wider.Inflate(MarginAtRest * bounds.GetMaxLength());
  // Frames take least where T goes on smoothly beyond the image. But a transform may end where the
  // image does, as one that is given on its points: then it is best to know nothing beyond.
  ffd::FunctionFit around = MakeFit(sampler, MakeRegion(wider));
  const int tried = mostCells / 4;
  FitStatus status = run(around, tried);
  if (status == FitStatus::Reached)
  {
    return status;
  }
  ffd::FunctionFit within = MakeFit(sampler, MakeRegion(bounds));
  if (run(within, mostCells / 2) == FitStatus::Reached)
  {
    const ffd::FittedNet inside = net;
    const int cells = 2 * std::max({ inside.Cells.x, inside.Cells.y, inside.Cells.z });
    if (cells <= tried || run(around, cells) != FitStatus::Reached)
    {
      net = inside;
    }
    return FitStatus::Reached;
  }
  status = run(around, mostCells);
  return status == FitStatus::NotFinite ? run(within, mostCells) : status;
}

} // namespace

//------------------------------------------------------------------------------
ffd::Made ffd::MakeDeformationField(DeformationField& result, StageTools& tools,
  const Source<vtkAbstractTransform>& source, const Source<vtkDataObject>& attached,
  const std::optional<FitRequest>& fit)
{
  BSplineField field;
  bool inverted = false;
  double error = 0.0;
  std::optional<Box> domain;
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
    FittedNet net;
    const bool finite =
      FitNet(source.Object, *fit, tools.Parallel, net, domain) != FitStatus::NotFinite;
    error = net.LargestError;
    Lattice lattice;
    lattice.Take(net);
    reason = finite ? lattice.FindProblem() : "it gives points that are not finite";
    if (!reason.empty())
    {
      tools.Message = "The deformation, a " + name +
        ", cannot be approximated by a lattice over the volume: " + reason +
        ". Check that it is finite there.";
      return Made::Not;
    }
    if (error > fit->Tolerance)
    {
      std::ostringstream text;
      text << "The deformation, a " << name << ", is approximated by a lattice with an error of "
           << error << " instead of the PositionTolerance of " << fit->Tolerance
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
  if (inverted == result.Inverted && error == result.Error && domain == result.Domain &&
    field == result.Field)
  {
    return Made::Same;
  }
  result.Field = std::move(field);
  result.Inverted = inverted;
  result.Error = error;
  result.Domain = domain;
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
  const ffd::FitRequest& fit, ffd::StageTools& tools)
{
  ffd::Source<vtkAbstractTransform> source;
  ffd::Source<vtkDataObject> attached;
  const bool isFitted = transform && !vtkBSplineTransform::SafeDownCast(transform);
  if (transform)
  {
    transform->Update();
    source = { transform, transform->GetMTime() };
  }
  else if (vtkFFDHasLattice(image))
  {
    attached = { image, std::max(image->GetMTime(), image->GetFieldData()->GetMTime()) };
  }
  return this->Field.Update(
    tools, source, attached, isFitted ? std::make_optional(fit) : std::nullopt);
}

//------------------------------------------------------------------------------
std::size_t vtkFFDDeformationSource::GetMemorySize() const
{
  return this->Field.GetLast().Field.GetCoefficients().capacity() * sizeof(glm::dvec3);
}
