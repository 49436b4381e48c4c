// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeParts.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"

#include "vtkBSplineTransform.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <vtksys/SystemInformation.hxx>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace ffdparts
{
namespace
{

/// Voxels around those that samples lie between: gradients reach one further, tolerances are
/// fractions of a voxel.
constexpr double Halo = 3.0;

constexpr int ExchangeTag = 7501;

/// Cells per axis that a lattice is refined to for its bounds.
constexpr int FineCells = 16;

/// Cuts that are made where they cost least.
constexpr int CutsWithCost = 16;

/// Ratio of costs below which another axis than the longest is chosen.
constexpr double Advantage = 0.98;

/// Bounds of 2P - S(P) for P in the box.
Bounds FindFirstOrderBounds(vtkFFDLattice* lattice, const Bounds& box)
{
  Bounds moved;
  lattice->GetDeformedBounds(box.data(), moved.data());
  Bounds result;
  for (int a = 0; a < 3; ++a)
  {
    result[2 * a] = 2.0 * box[2 * a] - moved[2 * a + 1];
    result[2 * a + 1] = 2.0 * box[2 * a + 1] - moved[2 * a];
  }
  return result;
}

/// The same, of parts of the box: displacements differ less in them.
Bounds FindFirstOrderBoundsByParts(vtkFFDLattice* lattice, const Bounds& box)
{
  constexpr int parts = 4;
  Bounds result = NoBounds;
  for (int part = 0; part < parts * parts * parts; ++part)
  {
    const int at[3] = { part % parts, part / parts % parts, part / (parts * parts) };
    Bounds piece;
    for (int a = 0; a < 3; ++a)
    {
      const double side = box[2 * a + 1] - box[2 * a];
      piece[2 * a] = box[2 * a] + side * at[a] / parts;
      piece[2 * a + 1] = box[2 * a] + side * (at[a] + 1) / parts;
    }
    const Bounds one = FindFirstOrderBounds(lattice, piece);
    result = Unite(result, one);
  }
  return result;
}

/// The same map with smaller cells, where a lattice can have them.
void MakeFine(vtkFFDLattice* lattice)
{
  const int border = lattice->GetBorderMode();
  if (border == VTK_BSPLINE_ZERO_AT_BORDER)
  {
    return;
  }
  // The domain then has all that varies, outside of which refinement is another map.
  const int layers = border == VTK_BSPLINE_EDGE ? 2 : 3;
  int factors[3];
  for (int a = 0; a < 3; ++a)
  {
    factors[a] = std::max(1, FineCells / (lattice->GetDimensions()[a] - 3 + 2 * layers));
  }
  if (*std::max_element(factors, factors + 3) > 1 && lattice->Extend(layers))
  {
    lattice->Refine(factors[0], factors[1], factors[2]);
  }
}

Extent ToCells(const Extent& e)
{
  return { { e[0], std::max(e[0], e[1] - 1), e[2], std::max(e[2], e[3] - 1), e[4],
    std::max(e[4], e[5] - 1) } };
}

vtkIdType Count(const Extent& e)
{
  return static_cast<vtkIdType>(e[1] - e[0] + 1) * (e[3] - e[2] + 1) * (e[5] - e[4] + 1);
}

std::vector<Bounds> Cut(
  const Bounds& bounds, int count, const std::function<double(const Bounds&)>& cost, int& cutsLeft)
{
  if (count <= 1)
  {
    return { bounds };
  }
  const int lowerCount = count / 2;
  int axes[3] = { 0, 1, 2 };
  std::stable_sort(axes, axes + 3, [&bounds](int a, int b) {
    return bounds[2 * a + 1] - bounds[2 * a] > bounds[2 * b + 1] - bounds[2 * b];
  });
  Bounds first;
  Bounds second;
  const auto halve = [&](int axis) {
    const double lower = bounds[2 * axis];
    const double upper = bounds[2 * axis + 1];
    first = second = bounds;
    first[2 * axis + 1] = second[2 * axis] = lower + (upper - lower) * lowerCount / count;
  };
  int best = axes[0];
  if (cost && cutsLeft > 0)
  {
    --cutsLeft;
    double least = std::numeric_limits<double>::infinity();
    for (const int axis : axes)
    {
      halve(axis);
      const double worse = std::max(cost(first) / lowerCount, cost(second) / (count - lowerCount));
      if (worse < Advantage * least)
      {
        least = worse;
        best = axis;
      }
    }
  }
  halve(best);
  const Bounds other = second;
  std::vector<Bounds> boxes = Cut(first, lowerCount, cost, cutsLeft);
  const std::vector<Bounds> others = Cut(other, count - lowerCount, cost, cutsLeft);
  boxes.insert(boxes.end(), others.begin(), others.end());
  return boxes;
}

vtkIdType At(const Extent& e, int i, int j, int k)
{
  return (i - e[0]) +
    (e[1] - e[0] + 1) * ((j - e[2]) + static_cast<vtkIdType>(e[3] - e[2] + 1) * (k - e[4]));
}

/// Copy the tuples of `region` from arrays over the extent `from` to those over `to`.
void CopyRegion(vtkFieldData* fromArrays, const Extent& from, vtkFieldData* toArrays,
  const Extent& to, const Extent& region)
{
  for (int a = 0; a < fromArrays->GetNumberOfArrays(); ++a)
  {
    vtkDataArray* source = fromArrays->GetArray(a);
    if (!source || !source->GetName() || source->GetNumberOfTuples() != Count(from))
    {
      continue;
    }
    vtkDataArray* target = toArrays->GetArray(source->GetName());
    if (!target)
    {
      vtkSmartPointer<vtkDataArray> made;
      made.TakeReference(source->NewInstance());
      made->SetName(source->GetName());
      made->SetNumberOfComponents(source->GetNumberOfComponents());
      made->SetNumberOfTuples(Count(to));
      made->Fill(0.0);
      toArrays->AddArray(made);
      target = made;
    }
    if (target->GetNumberOfComponents() != source->GetNumberOfComponents())
    {
      continue;
    }
    for (int k = region[4]; k <= region[5]; ++k)
    {
      for (int j = region[2]; j <= region[3]; ++j)
      {
        target->InsertTuples(
          At(to, region[0], j, k), region[1] - region[0] + 1, At(from, region[0], j, k), source);
      }
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
void CopyVoxels(vtkImageData* from, const Extent& fromExtent, vtkImageData* to,
  const Extent& toExtent, const Extent& region)
{
  CopyRegion(from->GetPointData(), fromExtent, to->GetPointData(), toExtent, region);
  CopyRegion(from->GetCellData(), ToCells(fromExtent), to->GetCellData(), ToCells(toExtent),
    ToCells(region));
}

//------------------------------------------------------------------------------
bool Contains(const std::vector<Extent>& outer, const Extent& inner)
{
  return IsEmpty(inner) || std::any_of(outer.begin(), outer.end(), [&inner](const Extent& each) {
    return Contains(each, inner);
  });
}

//------------------------------------------------------------------------------
bool Contains(const Extent& outer, const Extent& inner)
{
  return IsEmpty(inner) ||
    (outer[0] <= inner[0] && inner[1] <= outer[1] && outer[2] <= inner[2] && inner[3] <= outer[3] &&
      outer[4] <= inner[4] && inner[5] <= outer[5]);
}

//------------------------------------------------------------------------------
Extent Intersect(const Extent& a, const Extent& b)
{
  const Extent both = { { std::max(a[0], b[0]), std::min(a[1], b[1]), std::max(a[2], b[2]),
    std::min(a[3], b[3]), std::max(a[4], b[4]), std::min(a[5], b[5]) } };
  return IsEmpty(both) ? NoExtent : both;
}

//------------------------------------------------------------------------------
Bounds Intersect(const Bounds& a, const Bounds& b)
{
  Bounds both;
  for (std::size_t i = 0; i < 6; i += 2)
  {
    both[i] = std::max(a[i], b[i]);
    both[i + 1] = std::min(a[i + 1], b[i + 1]);
    if (!(both[i] < both[i + 1]))
    {
      return NoBounds;
    }
  }
  return both;
}

//------------------------------------------------------------------------------
Bounds Unite(const Bounds& a, const Bounds& b)
{
  if (IsEmpty(a) || IsEmpty(b))
  {
    return IsEmpty(a) ? b : a;
  }
  return { { std::min(a[0], b[0]), std::max(a[1], b[1]), std::min(a[2], b[2]), std::max(a[3], b[3]),
    std::min(a[4], b[4]), std::max(a[5], b[5]) } };
}

//------------------------------------------------------------------------------
Bounds Transform(const Bounds& bounds, vtkMatrix4x4* matrix)
{
  Bounds result = { VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX,
    VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX };
  for (int corner = 0; corner < 8; ++corner)
  {
    double p[4] = { bounds[corner & 1], bounds[2 + ((corner >> 1) & 1)], bounds[4 + (corner >> 2)],
      1.0 };
    matrix->MultiplyPoint(p, p);
    for (int a = 0; a < 3; ++a)
    {
      result[2 * a] = std::min(result[2 * a], p[a]);
      result[2 * a + 1] = std::max(result[2 * a + 1], p[a]);
    }
  }
  return result;
}

//------------------------------------------------------------------------------
Grid Grid::FromImage(vtkImageData* image, const Extent& wholeExtent)
{
  Grid grid;
  grid.WholeExtent = wholeExtent;
  image->GetOrigin(grid.Origin.data());
  image->GetSpacing(grid.Spacing.data());
  std::copy_n(image->GetDirectionMatrix()->GetData(), 9, grid.Direction.begin());
  return grid;
}

//------------------------------------------------------------------------------
bool Grid::operator==(const Grid& other) const
{
  const auto areEqual = [](const auto& mine, const auto& others) {
    return std::equal(mine.begin(), mine.end(), others.begin(),
      [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); });
  };
  return this->WholeExtent == other.WholeExtent && areEqual(this->Origin, other.Origin) &&
    areEqual(this->Spacing, other.Spacing) && areEqual(this->Direction, other.Direction);
}

//------------------------------------------------------------------------------
void Grid::ApplyTo(vtkImageData* image) const
{
  image->SetOrigin(this->Origin.data());
  image->SetSpacing(this->Spacing.data());
  image->SetDirectionMatrix(this->Direction.data());
}

//------------------------------------------------------------------------------
Bounds Grid::GetBounds() const
{
  vtkNew<vtkImageData> image;
  image->SetExtent(const_cast<int*>(this->WholeExtent.data()));
  this->ApplyTo(image);
  Bounds bounds;
  image->GetBounds(bounds.data());
  return bounds;
}

//------------------------------------------------------------------------------
std::vector<Bounds> CutIntoBoxes(
  const Bounds& bounds, int count, const std::function<double(const Bounds&)>& cost)
{
  int cutsLeft = CutsWithCost;
  return Cut(bounds, count, cost, cutsLeft);
}

//------------------------------------------------------------------------------
bool AreEqual(vtkFFDLattice* a, vtkFFDLattice* b)
{
  vtkDoubleArray* x = a->GetDisplacements();
  vtkDoubleArray* y = b->GetDisplacements();
  return std::equal(a->GetDimensions(), a->GetDimensions() + 3, b->GetDimensions()) &&
    std::equal(a->GetDomain(), a->GetDomain() + 6, b->GetDomain()) &&
    a->GetBorderMode() == b->GetBorderMode() && a->GetInverseFlag() == b->GetInverseFlag() &&
    a->GetDisplacementScale() == b->GetDisplacementScale() &&
    std::equal(x->GetPointer(0), x->GetPointer(0) + x->GetNumberOfValues(), y->GetPointer(0));
}

//------------------------------------------------------------------------------
Bounds OpenOutwards(const Bounds& box, const Bounds& whole)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Bounds open = box;
  for (int a = 0; a < 3; ++a)
  {
    if (box[2 * a] <= whole[2 * a])
    {
      open[2 * a] = -infinity;
    }
    if (box[2 * a + 1] >= whole[2 * a + 1])
    {
      open[2 * a + 1] = infinity;
    }
  }
  return open;
}

//------------------------------------------------------------------------------
DeformedBoundsFinder::DeformedBoundsFinder() = default;

//------------------------------------------------------------------------------
DeformedBoundsFinder::~DeformedBoundsFinder() = default;

//------------------------------------------------------------------------------
Bounds DeformedBoundsFinder::Find(const Grid& grid, vtkFFDLattice* lattice, int inverseMode)
{
  const Bounds rest = grid.GetBounds();
  if (!lattice)
  {
    return rest;
  }
  if (!this->Mapper)
  {
    // A mapper knows them from bounds, lattice and size of a voxel alone: let it see eight voxels.
    this->Corners = vtkSmartPointer<vtkImageData>::New();
    this->Corners->SetDimensions(2, 2, 2);
    this->Corners->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    std::fill_n(static_cast<unsigned char*>(this->Corners->GetScalarPointer()), 8, 0);
    this->Mapper = vtkSmartPointer<vtkFFDInverseRayVolumeMapper>::New();
    this->Mapper->SetInputData(this->Corners);
  }
  grid.ApplyTo(this->Corners);
  this->Mapper->SetWholeBounds(rest.data());
  this->Mapper->SetDeformation(lattice);
  this->Mapper->SetInverseMode(inverseMode);
  Bounds deformed;
  this->Mapper->GetBounds(deformed.data());
  this->Mapper->SetDeformation(nullptr);
  return IsEmpty(deformed) ? rest : deformed;
}

//------------------------------------------------------------------------------
PullBackCover::PullBackCover() = default;

//------------------------------------------------------------------------------
PullBackCover::~PullBackCover() = default;

//------------------------------------------------------------------------------
void PullBackCover::SetDeformation(vtkFFDLattice* lattice, int inverseMode)
{
  if (!lattice)
  {
    this->Lattice = nullptr;
    return;
  }
  if (this->Lattice && this->InverseMode == inverseMode && AreEqual(this->Lattice, lattice))
  {
    return;
  }
  this->InverseMode = inverseMode;
  this->Lattice = vtkSmartPointer<vtkFFDLattice>::New();
  this->Lattice->DeepCopy(lattice);
  this->Fine = vtkSmartPointer<vtkFFDLattice>::New();
  this->Fine->DeepCopy(lattice);
  MakeFine(this->Fine);
  this->Inverse = nullptr;
  if (inverseMode == vtkFFDInverseRayVolumeMapper::EXACT)
  {
    this->Inverse = vtkSmartPointer<vtkFFDLattice>::New();
    this->Inverse->DeepCopy(this->Fine);
    this->Inverse->Inverse();
    this->FoldFree = this->Lattice->IsFoldFree();
  }
}

//------------------------------------------------------------------------------
Bounds PullBackCover::FindRestBounds(const Bounds& box) const
{
  if (!this->Lattice)
  {
    return box;
  }
  Bounds rest;
  switch (this->InverseMode)
  {
    case vtkFFDInverseRayVolumeMapper::FIRST_ORDER:
      return FindFirstOrderBoundsByParts(this->Fine, box);
    case vtkFFDInverseRayVolumeMapper::PULL_BACK:
      this->Fine->GetDeformedBounds(box.data(), rest.data());
      return rest;
    default:
      this->Inverse->GetDeformedBounds(box.data(), rest.data());
      // If the map folds, the first-order point may be used.
      return this->FoldFree ? rest : Unite(rest, FindFirstOrderBoundsByParts(this->Fine, box));
  }
}

//------------------------------------------------------------------------------
int FindNumberOfThreads(vtkMultiProcessController* controller)
{
  vtksys::SystemInformation host;
  host.RunCPUCheck();
  const auto processors = static_cast<int>(host.GetNumberOfLogicalCPU());
  const auto available = static_cast<int>(std::thread::hardware_concurrency());
  const char* name = host.GetHostname();
  const auto own = static_cast<vtkTypeUInt64>(std::hash<std::string>()(name ? name : ""));
  std::vector<vtkTypeUInt64> hosts(static_cast<std::size_t>(controller->GetNumberOfProcesses()));
  controller->AllGather(&own, hosts.data(), 1);
  if (available > 0 && available < processors)
  {
    return available;
  }
  const auto processes = static_cast<int>(std::count(hosts.begin(), hosts.end(), own));
  return std::max(1, processors / std::max(1, processes));
}

//------------------------------------------------------------------------------
vtkIdType CountPoints(const Extent& extent) { return IsEmpty(extent) ? 0 : Count(extent); }

//------------------------------------------------------------------------------
Extent FindNeededExtent(const Grid& grid, const PullBackCover& cover, const Bounds& box)
{
  if (IsEmpty(box) || IsEmpty(grid.WholeExtent))
  {
    return NoExtent;
  }
  const Bounds rest = cover.FindRestBounds(box);
  vtkNew<vtkImageData> image;
  grid.ApplyTo(image);
  double lower[3] = { VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, VTK_DOUBLE_MAX };
  double upper[3] = { VTK_DOUBLE_MIN, VTK_DOUBLE_MIN, VTK_DOUBLE_MIN };
  std::fill_n(upper, 3, -VTK_DOUBLE_MAX);
  for (int corner = 0; corner < 8; ++corner)
  {
    const double p[3] = { rest[corner & 1], rest[2 + ((corner >> 1) & 1)],
      rest[4 + (corner >> 2)] };
    double index[3];
    image->TransformPhysicalPointToContinuousIndex(p, index);
    for (int a = 0; a < 3; ++a)
    {
      lower[a] = std::min(lower[a], index[a]);
      upper[a] = std::max(upper[a], index[a]);
    }
  }
  Extent extent;
  for (int a = 0; a < 3; ++a)
  {
    // In this range of integers before the conversion.
    const double first = grid.WholeExtent[2 * a];
    const double last = grid.WholeExtent[2 * a + 1];
    extent[2 * a] = static_cast<int>(std::clamp(std::floor(lower[a] - Halo), first, last + 1.0));
    extent[2 * a + 1] = static_cast<int>(std::clamp(std::ceil(upper[a] + Halo), first - 1.0, last));
  }
  return IsEmpty(extent) ? NoExtent : extent;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> ExchangeVoxels(vtkMultiProcessController* controller,
  const Grid& grid, vtkImageData* image, const std::vector<std::vector<Extent>>& extents,
  const std::vector<Extent>& needed, bool blanks)
{
  const auto ranks = static_cast<std::size_t>(controller->GetNumberOfProcesses());
  const auto own = static_cast<std::size_t>(controller->GetLocalProcessId());
  const Extent& wanted = needed[own];
  Extent here = NoExtent; // of the image, which has all of extents[own]
  if (image)
  {
    image->GetExtent(here.data());
  }
  vtkSmartPointer<vtkImageData> result;
  if (!IsEmpty(wanted))
  {
    result = vtkSmartPointer<vtkImageData>::New();
    result->SetExtent(const_cast<int*>(wanted.data()));
    grid.ApplyTo(result);
    if (blanks)
    {
      vtkNew<vtkUnsignedCharArray> flags;
      flags->SetName(vtkDataSetAttributes::GhostArrayName());
      flags->SetNumberOfValues(result->GetNumberOfPoints());
      flags->FillValue(vtkDataSetAttributes::HIDDENPOINT);
      result->GetPointData()->AddArray(flags);
    }
  }
  for (std::size_t from = 0; from < ranks; ++from)
  {
    for (const Extent& held : extents[from])
    {
      for (std::size_t to = 0; to < ranks; ++to)
      {
        const Extent region = Intersect(held, needed[to]);
        // Who has all that it needs is not sent any of it.
        if (IsEmpty(region) || (from != to && Contains(extents[to], needed[to])))
        {
          continue;
        }
        if (from == own && to == own)
        {
          CopyVoxels(image, here, result, wanted, region);
        }
        else if (from == own)
        {
          vtkNew<vtkImageData> part;
          part->ShallowCopy(image);
          part->GetFieldData()->Initialize();
          part->Crop(region.data());
          controller->Send(part.GetPointer(), static_cast<int>(to), ExchangeTag);
        }
        else if (to == own)
        {
          vtkSmartPointer<vtkDataObject> received;
          received.TakeReference(
            controller->ReceiveDataObject(static_cast<int>(from), ExchangeTag));
          if (vtkImageData* part = vtkImageData::SafeDownCast(received))
          {
            CopyVoxels(part, region, result, wanted, region);
          }
        }
      }
    }
  }
  return result;
}

} // namespace ffdparts
