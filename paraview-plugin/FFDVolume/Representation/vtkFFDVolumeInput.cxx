// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeInput.h"

#include "vtkFFDLattice.h"
#include "vtkFFDShownLattice.h"

#include "vtkCellData.h"
#include "vtkCommunicator.h"
#include "vtkCompositeDataIterator.h"
#include "vtkDataArray.h"
#include "vtkDataObjectTree.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMatrix3x3.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkSMPTools.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace
{

using ffdparts::Bounds;
using ffdparts::Extent;
using ffdparts::Grid;

/// In the field data of an image that stands for a rectilinear grid.
const std::array<const char*, 3> CoordinateNames{ { "FFDVolume.X", "FFDVolume.Y", "FFDVolume.Z" } };

/// Blocks of unlike voxels are put on at most as many points as they have, times this ...
constexpr double LargestGrowth = 8.0;

/// ... or this number of points.
constexpr double AlwaysAllowed = 1 << 24;

/// Parts of a voxel that count as none.
constexpr double Slack = 1e-3;

/// Points of the frame so many voxels beyond the faces of a turned block still take the values
/// there: a cell is hidden with any of its points, so the block is as large as it is in the mean.
constexpr double Reach = 0.5;

vtkMultiProcessController* GetController()
{
  return vtkMultiProcessController::GetGlobalController();
}

bool AreSeveral() { return GetController() && GetController()->GetNumberOfProcesses() > 1; }

/// The least value of all processes, which all call it.
double FindLeast(double value)
{
  double least = value;
  if (AreSeveral())
  {
    GetController()->AllReduce(&value, &least, 1, vtkCommunicator::MIN_OP);
  }
  return least;
}

std::array<vtkDataArray*, 3> GetGridCoordinates(vtkRectilinearGrid* grid)
{
  return { { grid->GetXCoordinates(), grid->GetYCoordinates(), grid->GetZCoordinates() } };
}

/// The extent, and where index (0, 0, 0) is and how far the next ones are; for a rectilinear grid
/// steps of the mean length.
Grid Describe(vtkDataSet* block)
{
  Extent extent;
  if (auto* image = vtkImageData::SafeDownCast(block))
  {
    image->GetExtent(extent.data());
    return Grid::FromImage(image, extent);
  }
  auto* grid = vtkRectilinearGrid::SafeDownCast(block);
  Grid described;
  grid->GetExtent(described.WholeExtent.data());
  const double* bounds = grid->GetBounds();
  for (std::size_t a = 0; a < 3; ++a)
  {
    const int first = described.WholeExtent[2 * a];
    described.Spacing[a] =
      (bounds[2 * a + 1] - bounds[2 * a]) / (described.WholeExtent[2 * a + 1] - first);
    described.Origin[a] = bounds[2 * a] - first * described.Spacing[a];
  }
  return described;
}

/// The shortest step between points along an axis.
double FindShortestStep(vtkDataSet* block, std::size_t axis)
{
  if (vtkImageData::SafeDownCast(block))
  {
    return Describe(block).Spacing[axis];
  }
  vtkDataArray* coordinates = GetGridCoordinates(vtkRectilinearGrid::SafeDownCast(block))[axis];
  double shortest = VTK_DOUBLE_MAX;
  for (vtkIdType i = 1; i < coordinates->GetNumberOfTuples(); ++i)
  {
    shortest = std::min(
      shortest, std::abs(coordinates->GetComponent(i, 0) - coordinates->GetComponent(i - 1, 0)));
  }
  return shortest;
}

/// Index coordinates of a place in a block, counted from its first point.
void FindIndex(vtkDataSet* block, const double place[3], double index[3])
{
  if (auto* image = vtkImageData::SafeDownCast(block))
  {
    image->TransformPhysicalPointToContinuousIndex(place, index);
    for (int a = 0; a < 3; ++a)
    {
      index[a] -= image->GetExtent()[2 * a];
    }
    return;
  }
  const auto axes = GetGridCoordinates(vtkRectilinearGrid::SafeDownCast(block));
  for (std::size_t a = 0; a < 3; ++a)
  {
    vtkIdType lower = 0;
    vtkIdType upper = axes[a]->GetNumberOfTuples() - 1;
    while (upper - lower > 1)
    {
      const vtkIdType middle = (lower + upper) / 2;
      (axes[a]->GetComponent(middle, 0) <= place[a] ? lower : upper) = middle;
    }
    const double first = axes[a]->GetComponent(lower, 0);
    index[a] =
      static_cast<double>(lower) + (place[a] - first) / (axes[a]->GetComponent(upper, 0) - first);
  }
}

/// Where a block is in the index space of a frame that it is aligned with.
Extent FindExtent(const Grid& block, const Grid& frame, bool& aligned)
{
  vtkNew<vtkImageData> image;
  frame.ApplyTo(image);
  double offset[3];
  image->TransformPhysicalPointToContinuousIndex(block.Origin.data(), offset);
  Extent extent = block.WholeExtent;
  aligned = block.Direction == frame.Direction;
  for (std::size_t a = 0; a < 3; ++a)
  {
    const double rounded = std::round(offset[a]);
    const double count = block.WholeExtent[2 * a + 1] - block.WholeExtent[2 * a];
    aligned = aligned && std::abs(offset[a] - rounded) <= Slack &&
      std::abs(block.Spacing[a] / frame.Spacing[a] - 1.0) * std::max(1.0, count) <= Slack &&
      std::abs(rounded) < 1e9;
    if (aligned)
    {
      extent[2 * a] += static_cast<int>(rounded);
      extent[2 * a + 1] += static_cast<int>(rounded);
    }
  }
  return extent;
}

/// Points of the frame that lie in the bounds of a block.
Extent FindExtentOf(const double bounds[6], const Grid& frame)
{
  Extent extent;
  for (std::size_t a = 0; a < 3; ++a)
  {
    const double lower = (bounds[2 * a] - frame.Origin[a]) / frame.Spacing[a];
    const double upper = (bounds[2 * a + 1] - frame.Origin[a]) / frame.Spacing[a];
    extent[2 * a] = static_cast<int>(std::ceil(lower - Slack));
    extent[2 * a + 1] = static_cast<int>(std::floor(upper + Slack));
  }
  return extent;
}

Extent Unite(const Extent& a, const Extent& b)
{
  Extent both = a;
  for (std::size_t i = 0; i < 6; i += 2)
  {
    both[i] = std::min(a[i], b[i]);
    both[i + 1] = std::max(a[i + 1], b[i + 1]);
  }
  return ffdparts::IsEmpty(a) ? b : both;
}

/// A block without its flags of ghosts, as an image of an extent.
vtkSmartPointer<vtkImageData> WithoutGhosts(vtkDataSet* block, const Extent& extent)
{
  auto plain = vtkSmartPointer<vtkImageData>::New();
  plain->SetExtent(const_cast<int*>(extent.data()));
  plain->GetPointData()->ShallowCopy(block->GetPointData());
  plain->GetCellData()->ShallowCopy(block->GetCellData());
  plain->GetPointData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
  plain->GetCellData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
  return plain;
}

/// Values of a block at the points of an extent.
struct InterpolatedBlock
{
  vtkSmartPointer<vtkImageData> Image;
  std::vector<char> PointsOutside; ///< of the block, or hidden in it
  std::vector<char> CellsOutside;
};

/// The cell of a block that a place is in, or the nearest one, by its lower corner; where the place
/// is in it, 0 to 1; and the largest distance from the block along an axis, in voxels.
struct Position
{
  std::array<vtkIdType, 3> Lower;
  std::array<double, 3> Part;
  double Beyond = 0.0;

  Position(vtkDataSet* block, const std::array<vtkIdType, 3>& counts, const double place[3])
  {
    double index[3];
    FindIndex(block, place, index);
    for (std::size_t a = 0; a < 3; ++a)
    {
      const double clamped = std::clamp(index[a], 0.0, static_cast<double>(counts[a] - 1));
      this->Lower[a] = std::min(static_cast<vtkIdType>(clamped), counts[a] - 2);
      this->Part[a] = clamped - static_cast<double>(this->Lower[a]);
      this->Beyond = std::max(this->Beyond, std::abs(clamped - index[a]));
    }
  }
};

/// Interpolates arrays of points of a block at those of the image of `interpolated`.
void InterpolatePoints(vtkDataSet* block, const std::array<vtkIdType, 3>& counts,
  vtkPointData* from, InterpolatedBlock& interpolated)
{
  vtkImageData* const result = interpolated.Image;
  const vtkIdType points = result->GetNumberOfPoints();
  vtkPointData* const to = result->GetPointData();
  to->InterpolateAllocate(from, points);
  // Threads write values, and allocate nothing.
  to->SetNumberOfTuples(points);
  std::vector<char>& outside = interpolated.PointsOutside;
  outside.assign(static_cast<std::size_t>(points), 0);
  vtkUnsignedCharArray* const blank = block->GetPointGhostArray();
  vtkSMPTools::For(0, points,
    [block, &counts, from, result, to, &outside, blank](vtkIdType first, vtkIdType last) {
      vtkNew<vtkIdList> corners;
      corners->SetNumberOfIds(8);
      for (vtkIdType point = first; point < last; ++point)
      {
        double place[3];
        result->GetPoint(point, place);
        const Position at(block, counts, place);
        bool hidden = at.Beyond > Reach;
        double weights[8];
        for (int corner = 0; corner < 8; ++corner)
        {
          std::array<vtkIdType, 3> index = at.Lower;
          double& weight = weights[corner];
          weight = 1.0;
          for (std::size_t a = 0; a < 3; ++a)
          {
            const int upper = corner >> a & 1;
            index[a] += upper;
            weight *= upper != 0 ? at.Part[a] : 1.0 - at.Part[a];
          }
          const vtkIdType id = index[0] + counts[0] * (index[1] + counts[1] * index[2]);
          corners->SetId(corner, id);
          hidden = hidden ||
            (blank && weight > Slack &&
              (blank->GetValue(id) & vtkDataSetAttributes::HIDDENPOINT) != 0);
        }
        outside[static_cast<std::size_t>(point)] = hidden ? 1 : 0;
        to->InterpolatePoint(from, point, corners, weights);
      }
    });
}

/// Gives the cells of the image of `interpolated` the values of the cells of a block that their
/// centers are in.
void CopyCells(vtkDataSet* block, const std::array<vtkIdType, 3>& counts, vtkCellData* from,
  InterpolatedBlock& interpolated)
{
  vtkImageData* const result = interpolated.Image;
  const vtkIdType cells = result->GetNumberOfCells();
  std::vector<char>& outside = interpolated.CellsOutside;
  outside.assign(static_cast<std::size_t>(cells), 0);
  vtkNew<vtkIdList> sources;
  sources->SetNumberOfIds(cells);
  vtkIdType* const ids = sources->GetPointer(0);
  Extent extent;
  result->GetExtent(extent.data());
  const vtkIdType nx = std::max(1, extent[1] - extent[0]);
  const vtkIdType ny = std::max(1, extent[3] - extent[2]);
  vtkSMPTools::For(0, cells,
    [block, &counts, result, &outside, ids, &extent, nx, ny](vtkIdType first, vtkIdType last) {
      for (vtkIdType cell = first; cell < last; ++cell)
      {
        const std::array<vtkIdType, 3> index{ { cell % nx, cell / nx % ny, cell / (nx * ny) } };
        std::array<double, 3> middle{};
        for (std::size_t a = 0; a < 3; ++a)
        {
          const double half = extent[2 * a] < extent[2 * a + 1] ? 0.5 : 0.0;
          middle[a] = static_cast<double>(extent[2 * a] + index[a]) + half;
        }
        double place[3];
        result->TransformContinuousIndexToPhysicalPoint(middle.data(), place);
        const Position at(block, counts, place);
        outside[static_cast<std::size_t>(cell)] = at.Beyond > Slack ? 1 : 0;
        ids[cell] = at.Lower[0] + (counts[0] - 1) * (at.Lower[1] + (counts[1] - 1) * at.Lower[2]);
      }
    });
  vtkCellData* const to = result->GetCellData();
  to->CopyAllocate(from, cells);
  to->SetNumberOfTuples(cells);
  for (int a = 0; a < to->GetNumberOfArrays(); ++a)
  {
    vtkAbstractArray* const target = to->GetAbstractArray(a);
    // CopyVoxels() takes none without a name.
    if (target->GetName())
    {
      from->GetAbstractArray(target->GetName())->GetTuples(sources, target);
    }
  }
}

/// Interpolates a block at the points of `extent`; values of cells are those of the cell.
InterpolatedBlock Interpolate(vtkDataSet* block, const Grid& frame, const Extent& extent)
{
  const Extent own = Describe(block).WholeExtent;
  const vtkSmartPointer<vtkImageData> plain = WithoutGhosts(block, own);
  const std::array<vtkIdType, 3> counts{ { own[1] - own[0] + 1, own[3] - own[2] + 1,
    own[5] - own[4] + 1 } };
  InterpolatedBlock interpolated;
  interpolated.Image = vtkSmartPointer<vtkImageData>::New();
  interpolated.Image->SetExtent(const_cast<int*>(extent.data()));
  frame.ApplyTo(interpolated.Image);
  InterpolatePoints(block, counts, plain->GetPointData(), interpolated);
  if (plain->GetCellData()->GetNumberOfArrays() > 0)
  {
    CopyCells(block, counts, plain->GetCellData(), interpolated);
  }
  return interpolated;
}

/// Calls use(id in `inner`, id in `outer`) with each point, or each cell, of an extent in another.
template <class Use>
void ForEachId(const Extent& inner, const Extent& outer, bool cells, const Use& use)
{
  const int less = cells ? 1 : 0;
  const vtkIdType nx = outer[1] - outer[0] + 1 - less;
  const vtkIdType ny = outer[3] - outer[2] + 1 - less;
  vtkIdType id = 0;
  for (int z = inner[4]; z <= inner[5] - less; ++z)
  {
    for (int y = inner[2]; y <= inner[3] - less; ++y)
    {
      for (int x = inner[0]; x <= inner[1] - less; ++x, ++id)
      {
        use(id, x - outer[0] + nx * (y - outer[2] + ny * static_cast<vtkIdType>(z - outer[4])));
      }
    }
  }
}

/// Values of elements, in their order. Arrays that are not of numbers are left out.
vtkSmartPointer<vtkFieldData> GetValues(vtkFieldData* from, vtkIdList* elements)
{
  auto values = vtkSmartPointer<vtkFieldData>::New();
  for (int a = 0; a < from->GetNumberOfArrays(); ++a)
  {
    if (vtkDataArray* const array = from->GetArray(a))
    {
      vtkSmartPointer<vtkDataArray> some;
      some.TakeReference(array->NewInstance());
      some->SetName(array->GetName());
      some->SetNumberOfComponents(array->GetNumberOfComponents());
      some->SetNumberOfTuples(elements->GetNumberOfIds());
      array->GetTuples(elements, some);
      values->AddArray(some);
    }
  }
  return values;
}

/// Gives elements of `to` back the values that they had before; zeros in arrays that there were
/// none of. All arrays are of numbers and named.
void Restore(vtkFieldData* before, vtkIdList* elements, vtkFieldData* to)
{
  for (int a = 0; a < to->GetNumberOfArrays(); ++a)
  {
    vtkDataArray* const array = to->GetArray(a);
    vtkDataArray* const from = before->GetArray(array->GetName());
    const std::vector<double> zero(static_cast<std::size_t>(array->GetNumberOfComponents()), 0.0);
    for (vtkIdType i = 0; i < elements->GetNumberOfIds(); ++i)
    {
      if (from)
      {
        array->SetTuple(elements->GetId(i), i, from);
      }
      else
      {
        array->SetTuple(elements->GetId(i), zero.data());
      }
    }
  }
}

/// Copies a block into the image of all blocks and shows its points; where it is not it leaves what
/// others have put there. Takes time for the block alone, as there may be thousands.
void CopyInterpolated(const InterpolatedBlock& block, const Extent& extent, vtkImageData* merged,
  const Extent& whole, vtkUnsignedCharArray* ghosts)
{
  vtkNew<vtkIdList> points;
  ForEachId(extent, whole, false, [&](vtkIdType id, vtkIdType place) {
    if (block.PointsOutside[static_cast<std::size_t>(id)] != 0)
    {
      points->InsertNextId(place);
    }
    else
    {
      ghosts->SetValue(place, 0);
    }
  });
  vtkNew<vtkIdList> cells;
  ForEachId(extent, whole, true, [&](vtkIdType id, vtkIdType place) {
    if (!block.CellsOutside.empty() && block.CellsOutside[static_cast<std::size_t>(id)] != 0)
    {
      cells->InsertNextId(place);
    }
  });
  const auto pointsBefore = GetValues(merged->GetPointData(), points);
  const auto cellsBefore = GetValues(merged->GetCellData(), cells);
  ffdparts::CopyVoxels(block.Image, extent, merged, whole, extent);
  Restore(pointsBefore, points, merged->GetPointData());
  Restore(cellsBefore, cells, merged->GetCellData());
}

/// What tells the lattices of blocks apart: domain, control points, and what these add up to, as
/// they are and by their place. Zeros for none.
using LatticeKey = std::array<double, 12>;

LatticeKey FindLatticeKey(vtkDataSet* block)
{
  LatticeKey key{};
  vtkNew<vtkFFDLattice> lattice;
  if (vtkFFDLattice::HasLattice(block) && vtkFFDShownLattice::Read(block, lattice))
  {
    vtkDoubleArray* displacements = lattice->GetDisplacements();
    const double* values = displacements->GetPointer(0);
    std::copy_n(lattice->GetDomain(), 6, key.begin());
    std::copy_n(lattice->GetDimensions(), 3, key.begin() + 6);
    key[9] = lattice->GetDisplacementScale();
    for (vtkIdType i = 0; i < displacements->GetNumberOfValues(); ++i)
    {
      key[10] += values[i];
      key[11] += static_cast<double>(i + 1) * values[i];
    }
  }
  return key;
}

/// The blocks of this process by the lattice that they have: as many groups on all processes, which
/// all call it, in the order of the places of their first blocks.
std::vector<std::vector<vtkDataSet*>> GroupByLattice(
  const std::vector<vtkDataSet*>& blocks, const std::vector<unsigned int>& places)
{
  using Entry = std::pair<double, LatticeKey>;
  constexpr std::size_t length = std::tuple_size<LatticeKey>::value + 1;
  std::vector<LatticeKey> keys;
  std::map<LatticeKey, double> firstPlaces;
  const auto note = [&firstPlaces](const LatticeKey& key, double place) {
    const auto noted = firstPlaces.emplace(key, place).first;
    noted->second = std::min(noted->second, place);
  };
  for (std::size_t i = 0; i < blocks.size(); ++i)
  {
    keys.push_back(FindLatticeKey(blocks[i]));
    note(keys.back(), places[i]);
  }
  if (AreSeveral())
  {
    std::vector<double> mine;
    for (const auto& [key, place] : firstPlaces)
    {
      mine.push_back(place);
      mine.insert(mine.end(), key.begin(), key.end());
    }
    const auto ranks = static_cast<std::size_t>(GetController()->GetNumberOfProcesses());
    const auto own = static_cast<vtkIdType>(mine.size());
    std::vector<vtkIdType> lengths(ranks);
    GetController()->AllGather(&own, lengths.data(), 1);
    std::vector<vtkIdType> offsets(ranks, 0);
    std::partial_sum(lengths.begin(), lengths.end() - 1, offsets.begin() + 1);
    std::vector<double> all(static_cast<std::size_t>(offsets.back() + lengths.back()));
    GetController()->AllGatherV(mine.data(), all.data(), own, lengths.data(), offsets.data());
    for (std::size_t i = 0; i + length <= all.size(); i += length)
    {
      LatticeKey key;
      std::copy_n(&all[i + 1], key.size(), key.begin());
      note(key, all[i]);
    }
  }
  std::vector<Entry> order;
  for (const auto& [key, place] : firstPlaces)
  {
    order.emplace_back(place, key);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::vector<vtkDataSet*>> groups(order.size());
  for (std::size_t i = 0; i < blocks.size(); ++i)
  {
    const Entry entry(firstPlaces[keys[i]], keys[i]);
    groups[static_cast<std::size_t>(
             std::lower_bound(order.begin(), order.end(), entry) - order.begin())]
      .push_back(blocks[i]);
  }
  return groups;
}

} // namespace

//------------------------------------------------------------------------------
std::vector<Extent> vtkFFDVolumeInput::GetExtents(vtkImageData* image)
{
  vtkDataArray* array = image->GetFieldData()->GetArray(PiecesName);
  std::vector<Extent> extents(array ? static_cast<std::size_t>(array->GetNumberOfTuples()) : 1);
  image->GetExtent(extents.front().data());
  for (std::size_t i = 0; array && i < extents.size(); ++i)
  {
    for (int c = 0; c < 6; ++c)
    {
      extents[i][static_cast<std::size_t>(c)] =
        static_cast<int>(array->GetComponent(static_cast<vtkIdType>(i), 2 + c));
    }
  }
  return extents;
}

//------------------------------------------------------------------------------
std::vector<int> vtkFFDVolumeInput::GetBlocks(vtkImageData* image)
{
  vtkDataArray* array = image->GetFieldData()->GetArray(PiecesName);
  std::vector<int> blocks(array ? static_cast<std::size_t>(array->GetNumberOfTuples()) : 1, 0);
  for (std::size_t i = 0; array && i < blocks.size(); ++i)
  {
    blocks[i] = static_cast<int>(array->GetComponent(static_cast<vtkIdType>(i), 1));
  }
  return blocks;
}

//------------------------------------------------------------------------------
bool vtkFFDVolumeInput::HasBlocks(vtkImageData* image)
{
  return image->GetFieldData()->HasArray(PiecesName) != 0;
}

//------------------------------------------------------------------------------
std::vector<std::vector<vtkDataSet*>> vtkFFDVolumeInput::GroupByLattice(vtkDataObjectTree* data)
{
  std::vector<vtkDataSet*> blocks;
  std::vector<unsigned int> places;
  vtkSmartPointer<vtkCompositeDataIterator> iterator;
  iterator.TakeReference(data->NewIterator());
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    vtkDataSet* block = vtkDataSet::SafeDownCast(iterator->GetCurrentDataObject());
    if (block && block->GetNumberOfPoints() > 0)
    {
      blocks.push_back(block);
      places.push_back(iterator->GetCurrentFlatIndex());
    }
  }
  return ::GroupByLattice(blocks, places);
}

//------------------------------------------------------------------------------
std::array<vtkDataArray*, 3> vtkFFDVolumeInput::GetCoordinates(vtkImageData* image)
{
  std::array<vtkDataArray*, 3> coordinates{};
  std::transform(CoordinateNames.begin(), CoordinateNames.end(), coordinates.begin(),
    [image](const char* name) { return image->GetFieldData()->GetArray(name); });
  return coordinates;
}

//------------------------------------------------------------------------------
/// Called on all processes.
vtkFFDVolumeInput::Frame vtkFFDVolumeInput::FindFrame(const std::vector<vtkDataSet*>& blocks)
{
  // The first block of all counts.
  const int own = AreSeveral() ? GetController()->GetLocalProcessId() : 0;
  const double here = blocks.empty() ? VTK_DOUBLE_MAX : own;
  const double first = FindLeast(here);
  Frame frame;
  std::array<double, 15> numbers{};
  if (here == first && !blocks.empty())
  {
    const Grid reference = Describe(blocks.front());
    std::copy(reference.Origin.begin(), reference.Origin.end(), numbers.begin());
    std::copy(reference.Spacing.begin(), reference.Spacing.end(), numbers.begin() + 3);
    std::copy(reference.Direction.begin(), reference.Direction.end(), numbers.begin() + 6);
  }
  if (AreSeveral() && first < VTK_DOUBLE_MAX)
  {
    GetController()->Broadcast(
      numbers.data(), static_cast<vtkIdType>(numbers.size()), static_cast<int>(first));
  }
  Grid& grid = frame.Grid;
  std::copy_n(numbers.begin(), 3, grid.Origin.begin());
  std::copy_n(numbers.begin() + 3, 3, grid.Spacing.begin());
  std::copy_n(numbers.begin() + 6, 9, grid.Direction.begin());
  const bool aligned = std::all_of(blocks.begin(), blocks.end(), [&grid](vtkDataSet* block) {
    bool each = vtkImageData::SafeDownCast(block) != nullptr;
    if (each)
    {
      FindExtent(Describe(block), grid, each);
    }
    return each;
  });
  frame.Aligned = FindLeast(aligned ? 1.0 : 0.0) > 0.0;
  if (frame.Aligned)
  {
    return frame;
  }

  Bounds bounds = ffdparts::NoBounds;
  std::array<double, 3> step{ { VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, VTK_DOUBLE_MAX } };
  double points = 0.0;
  for (vtkDataSet* block : blocks)
  {
    Bounds each;
    block->GetBounds(each.data());
    bounds = ffdparts::Unite(bounds, each);
    points += static_cast<double>(block->GetNumberOfPoints());
    for (std::size_t a = 0; a < 3; ++a)
    {
      step[a] = std::min(step[a], FindShortestStep(block, a));
    }
  }
  if (AreSeveral())
  {
    const double mine = points;
    GetController()->AllReduce(&mine, &points, 1, vtkCommunicator::SUM_OP);
  }
  std::array<double, 3> length{};
  double wanted = 1.0;
  grid = Grid();
  for (std::size_t a = 0; a < 3; ++a)
  {
    const bool none = ffdparts::IsEmpty(bounds);
    grid.Origin[a] = FindLeast(none ? VTK_DOUBLE_MAX : bounds[2 * a]);
    length[a] = -FindLeast(none ? VTK_DOUBLE_MAX : -bounds[2 * a + 1]) - grid.Origin[a];
    grid.Spacing[a] = FindLeast(step[a]);
    wanted *= length[a] / grid.Spacing[a] + 1.0;
  }
  const double coarser =
    std::max(1.0, std::cbrt(wanted / std::max(AlwaysAllowed, LargestGrowth * points)));
  for (std::size_t a = 0; a < 3; ++a)
  {
    const double cells = std::max(1.0, std::round(length[a] / (coarser * grid.Spacing[a])));
    grid.Spacing[a] = length[a] / cells;
  }
  return frame;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> vtkFFDVolumeInput::Merge(
  const std::vector<vtkDataSet*>& blocks, const Places& places, const Frame& frame)
{
  std::vector<Extent> extents;
  Extent whole = ffdparts::NoExtent;
  for (vtkDataSet* block : blocks)
  {
    bool aligned = true;
    extents.push_back(frame.Aligned ? FindExtent(Describe(block), frame.Grid, aligned)
                                    : FindExtentOf(block->GetBounds(), frame.Grid));
    whole = Unite(whole, extents.back());
  }
  auto merged = vtkSmartPointer<vtkImageData>::New();
  merged->SetExtent(whole.data());
  frame.Grid.ApplyTo(merged);
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  ghosts->SetNumberOfValues(merged->GetNumberOfPoints());
  ghosts->FillValue(vtkDataSetAttributes::HIDDENPOINT);
  vtkNew<vtkIntArray> list;
  list->SetName(PiecesName);
  list->SetNumberOfComponents(8);
  for (std::size_t i = 0; i < blocks.size(); ++i)
  {
    const Extent& extent = extents[i];
    if (ffdparts::IsEmpty(extent))
    {
      continue; // between two points of the frame
    }
    if (frame.Aligned)
    {
      vtkUnsignedCharArray* const blank = blocks[i]->GetPointGhostArray();
      ffdparts::CopyVoxels(WithoutGhosts(blocks[i], extent), extent, merged, whole, extent);
      ForEachId(extent, whole, false, [&](vtkIdType id, vtkIdType place) {
        if (!blank || (blank->GetValue(id) & vtkDataSetAttributes::HIDDENPOINT) == 0)
        {
          ghosts->SetValue(place, 0);
        }
      });
    }
    else
    {
      CopyInterpolated(Interpolate(blocks[i], frame.Grid, extent), extent, merged, whole, ghosts);
    }
    const int place = static_cast<int>(places.at(blocks[i]));
    const std::array<int, 8> piece{ { 0, frame.Aligned ? place : -1, extent[0], extent[1],
      extent[2], extent[3], extent[4], extent[5] } };
    list->InsertNextTypedTuple(piece.data());
  }
  const unsigned char* flags = ghosts->GetPointer(0);
  if (AreSeveral() ||
    std::any_of(flags, flags + ghosts->GetNumberOfValues(), [](unsigned char f) { return f != 0; }))
  {
    merged->GetPointData()->AddArray(ghosts);
  }
  merged->GetFieldData()->AddArray(list);
  return merged;
}

//------------------------------------------------------------------------------
vtkFFDVolumeInput::Content vtkFFDVolumeInput::FindContent(
  const std::vector<vtkDataSet*>& blocks, const Places& blockPlaces)
{
  Content content;
  const auto add = [&content](vtkAbstractArray* array) {
    content.Values.emplace_back(array, array->GetMTime());
  };
  for (vtkDataSet* block : blocks)
  {
    const Grid grid = Describe(block);
    std::vector<double>& places = content.Places;
    places.push_back(blockPlaces.at(block));
    places.insert(places.end(), grid.WholeExtent.begin(), grid.WholeExtent.end());
    places.insert(places.end(), grid.Origin.begin(), grid.Origin.end());
    places.insert(places.end(), grid.Spacing.begin(), grid.Spacing.end());
    places.insert(places.end(), grid.Direction.begin(), grid.Direction.end());
    for (vtkFieldData* arrays : { static_cast<vtkFieldData*>(block->GetPointData()),
           static_cast<vtkFieldData*>(block->GetCellData()) })
    {
      for (int a = 0; a < arrays->GetNumberOfArrays(); ++a)
      {
        add(arrays->GetAbstractArray(a));
      }
    }
    if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(block))
    {
      const auto coordinates = GetGridCoordinates(rectilinear);
      std::for_each(coordinates.begin(), coordinates.end(), add);
    }
  }
  return content;
}

//------------------------------------------------------------------------------
/// Called on all processes.
vtkSmartPointer<vtkImageData> vtkFFDVolumeInput::Update(
  Group& group, const std::vector<vtkDataSet*>& blocks, const Places& places)
{
  const Content content = FindContent(blocks, places);
  const bool isKept = (blocks.empty() || group.Merged) && content.Values == group.Made.Values &&
    content.Places == group.Made.Places;
  if (FindLeast(isKept ? 1.0 : 0.0) == 0.0)
  {
    const Frame frame = FindFrame(blocks);
    group.Merged = blocks.empty() ? nullptr : Merge(blocks, places, frame);
    group.Made = content;
  }
  if (blocks.empty())
  {
    return nullptr;
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->ShallowCopy(group.Merged);
  const auto withLattice = std::find_if(blocks.begin(), blocks.end(), vtkFFDLattice::HasLattice);
  vtkNew<vtkFieldData> fields;
  fields->PassData((withLattice != blocks.end() ? *withLattice : blocks.front())->GetFieldData());
  fields->PassData(group.Merged->GetFieldData());
  image->SetFieldData(fields);
  return image;
}

//------------------------------------------------------------------------------
std::vector<vtkSmartPointer<vtkImageData>> vtkFFDVolumeInput::Update(
  vtkDataObject* data, std::string& problem)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  if (auto* input = vtkImageData::SafeDownCast(data))
  {
    image->ShallowCopy(input);
    return { image };
  }
  std::vector<vtkDataSet*> blocks;
  std::vector<unsigned int> places;
  int others = 0;
  const auto add = [&](vtkDataObject* object, unsigned int place) {
    vtkDataSet* block = vtkDataSet::SafeDownCast(object);
    if (!block || block->GetNumberOfPoints() == 0)
    {
      return;
    }
    int sizes[3] = { 0, 0, 0 };
    if (auto* asImage = vtkImageData::SafeDownCast(block))
    {
      asImage->GetDimensions(sizes);
    }
    else if (auto* asGrid = vtkRectilinearGrid::SafeDownCast(block))
    {
      asGrid->GetDimensions(sizes);
    }
    if (*std::min_element(sizes, sizes + 3) < 2)
    {
      ++others;
      return;
    }
    blocks.push_back(block);
    places.push_back(place);
  };
  if (auto* grid = vtkRectilinearGrid::SafeDownCast(data))
  {
    add(grid, 0);
    if (!AreSeveral() && !blocks.empty())
    {
      const Grid described = Describe(grid);
      image->SetExtent(grid->GetExtent());
      described.ApplyTo(image);
      image->GetPointData()->ShallowCopy(grid->GetPointData());
      image->GetCellData()->ShallowCopy(grid->GetCellData());
      image->GetFieldData()->PassData(grid->GetFieldData());
      const auto coordinates = GetGridCoordinates(grid);
      for (std::size_t a = 0; a < 3; ++a)
      {
        vtkSmartPointer<vtkDataArray> named;
        named.TakeReference(coordinates[a]->NewInstance());
        named->ShallowCopy(coordinates[a]);
        named->SetName(CoordinateNames[a]);
        image->GetFieldData()->AddArray(named);
      }
      return { image };
    }
  }
  else if (auto* tree = vtkDataObjectTree::SafeDownCast(data))
  {
    vtkSmartPointer<vtkCompositeDataIterator> iterator;
    iterator.TakeReference(tree->NewIterator());
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
    {
      add(iterator->GetCurrentDataObject(), iterator->GetCurrentFlatIndex());
    }
  }
  else
  {
    problem = std::string("renders image data and rectilinear grids, and blocks of them, and this "
                          "is a ") +
      (data ? data->GetClassName() : "null") +
      ". Apply the filter \"Resample To Image\" first, or choose another representation.";
    return {};
  }
  Places byBlock;
  for (std::size_t i = 0; i < blocks.size(); ++i)
  {
    byBlock.emplace(blocks[i], places[i]);
  }
  const std::vector<std::vector<vtkDataSet*>> groups = ::GroupByLattice(blocks, places);
  this->Groups.resize(groups.size());
  std::vector<vtkSmartPointer<vtkImageData>> images;
  for (std::size_t i = 0; i < groups.size(); ++i)
  {
    images.push_back(Update(this->Groups[i], groups[i], byBlock));
  }
  if (blocks.empty() && others > 0)
  {
    problem = "renders volumes, and no block of this is an image or a rectilinear grid with two "
              "points along each axis. Choose \"Surface\".";
  }
  return images;
}
