// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVoxelDistribution.h"

#include "vtkFFDLattice.h"
#include "vtkFFDShownLattice.h"
#include "vtkFFDVolumeInput.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkCommunicator.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <string>

namespace
{

using Bounds = ffdparts::Bounds;
using Extent = ffdparts::Extent;
using Grid = ffdparts::Grid;

/// In the field data of a part: its clip box, then the bounds of the whole at rest.
const char* const PartArray = "FFDVolume.Part";

/// In the field data of a part: the ranges of the whole array that is shown, of its magnitude and
/// its components, two numbers each.
std::string GetRangesName(const vtkFFDShownArray& shown)
{
  return std::string("FFDVolume.Ranges.") + (shown.OfCells ? "cells." : "points.") + shown.Name;
}

/// Whether the matrix takes boxes to boxes.
bool KeepsBoxes(vtkMatrix4x4* matrix)
{
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      if (row != column && matrix->GetElement(row, column) != 0.0)
      {
        return false;
      }
    }
  }
  return true;
}

/// Ranges of the array over all processes, see GetRangesName(); null if it is nowhere, or holds no
/// finite number. To be called on all processes.
vtkSmartPointer<vtkDoubleArray> FindRanges(
  vtkMultiProcessController* controller, vtkImageData* image, const vtkFFDShownArray& shown)
{
  vtkDataArray* array = image ? shown.FindIn(image) : nullptr;
  const int componentsHere = array ? array->GetNumberOfComponents() : 0;
  int components = 0;
  controller->AllReduce(&componentsHere, &components, 1, vtkCommunicator::MAX_OP);
  if (components < 1)
  {
    return nullptr;
  }
  // Least values, and least negated ones.
  std::vector<double> mine(2 * static_cast<std::size_t>(components + 1), VTK_DOUBLE_MAX);
  for (int c = -1; array && c < componentsHere; ++c)
  {
    double range[2];
    array->GetFiniteRange(range, c);
    if (range[0] <= range[1])
    {
      mine[2 * static_cast<std::size_t>(c + 1)] = range[0];
      mine[2 * static_cast<std::size_t>(c + 1) + 1] = -range[1];
    }
  }
  std::vector<double> all(mine.size());
  controller->AllReduce(
    mine.data(), all.data(), static_cast<vtkIdType>(mine.size()), vtkCommunicator::MIN_OP);
  vtkNew<vtkDoubleArray> ranges;
  ranges->SetName(GetRangesName(shown).c_str());
  ranges->SetNumberOfComponents(2);
  for (std::size_t i = 0; i < all.size(); i += 2)
  {
    const bool any = all[i] < VTK_DOUBLE_MAX;
    ranges->InsertNextTuple2(any ? all[i] : 1.0, any ? -all[i + 1] : -1.0);
  }
  return ranges;
}

} // namespace

//------------------------------------------------------------------------------
bool vtkFFDVoxelDistribution::Inputs::operator==(const Inputs& other) const
{
  return this->Image == other.Image && this->Time == other.Time &&
    this->WholeExtent == other.WholeExtent && this->Shown == other.Shown &&
    this->InverseMode == other.InverseMode && this->HasOrder == other.HasOrder &&
    this->Matrix == other.Matrix;
}

//------------------------------------------------------------------------------
vtkFFDVoxelDistribution::Sources vtkFFDVoxelDistribution::GetSources(vtkImageData* image)
{
  Sources sources;
  if (image)
  {
    const std::array<vtkFieldData*, 2> both{ { image->GetPointData(), image->GetCellData() } };
    for (vtkFieldData* arrays : both)
    {
      for (int a = 0; a < arrays->GetNumberOfArrays(); ++a)
      {
        vtkAbstractArray* array = arrays->GetAbstractArray(a);
        sources.emplace_back(array, array->GetMTime());
      }
    }
  }
  return sources;
}

//------------------------------------------------------------------------------
/// Whether what was brought here last has the voxels `wanted`, and the image is as it was then.
bool vtkFFDVoxelDistribution::HoldsVoxelsOf(vtkImageData* image, const Extent& wanted) const
{
  Extent held = ffdparts::NoExtent;
  if (this->Held)
  {
    this->Held->GetExtent(held.data());
  }
  bool alive = true;
  for (const auto& source : this->HeldSources)
  {
    alive = alive && source.first;
  }
  return alive && ffdparts::Contains(held, wanted) && GetSources(image) == this->HeldSources;
}

//------------------------------------------------------------------------------
vtkFFDVoxelDistribution::Holdings vtkFFDVoxelDistribution::GatherHoldings(
  vtkMultiProcessController* controller, const Inputs& inputs)
{
  const int ranks = controller->GetNumberOfProcesses();
  vtkImageData* image = inputs.Image;
  Holdings holdings;
  Grid& grid = holdings.Grid;
  Extent held = ffdparts::NoExtent;
  if (image)
  {
    image->GetExtent(held.data());
    grid = Grid::FromImage(image, held);
    if (!ffdparts::IsEmpty(inputs.WholeExtent))
    {
      grid.WholeExtent = inputs.WholeExtent;
    }
  }
  const std::vector<Extent> extents =
    image ? vtkFFDVolumeInput::GetExtents(image) : std::vector<Extent>();
  const std::vector<int> indices = image ? vtkFFDVolumeInput::GetBlocks(image) : std::vector<int>();
  const auto count = static_cast<int>(extents.size());
  std::vector<int> counts(static_cast<std::size_t>(ranks));
  controller->AllGather(&count, counts.data(), 1);
  const std::size_t most =
    static_cast<std::size_t>(*std::max_element(counts.begin(), counts.end()));
  std::vector<int> numbers(7 * most);
  for (std::size_t i = 0; i < extents.size(); ++i)
  {
    numbers[7 * i] = indices[i];
    std::copy(extents[i].begin(), extents[i].end(), &numbers[7 * i + 1]);
  }
  std::vector<int> allNumbers(numbers.size() * static_cast<std::size_t>(ranks));
  controller->AllGather(numbers.data(), allNumbers.data(), static_cast<vtkIdType>(numbers.size()));
  const int blocksHere = image && vtkFFDVolumeInput::HasBlocks(image) ? 1 : 0;
  int blocks = 0;
  controller->AllReduce(&blocksHere, &blocks, 1, vtkCommunicator::MAX_OP);
  holdings.HasBlocks = blocks > 0;

  constexpr int values = 2 + 6 + 6 + 3 + 3 + 9;
  std::array<double, values> mine{};
  mine[0] = image ? 1.0 : 0.0;
  mine[1] = image && vtkFFDLattice::HasLattice(image) ? 1.0 : 0.0;
  std::copy(held.begin(), held.end(), mine.begin() + 2);
  std::copy(grid.WholeExtent.begin(), grid.WholeExtent.end(), mine.begin() + 8);
  std::copy(grid.Origin.begin(), grid.Origin.end(), mine.begin() + 14);
  std::copy(grid.Spacing.begin(), grid.Spacing.end(), mine.begin() + 17);
  std::copy(grid.Direction.begin(), grid.Direction.end(), mine.begin() + 20);
  std::vector<double> all(static_cast<std::size_t>(ranks * values));
  controller->AllGather(mine.data(), all.data(), values);

  int withImage = -1;
  holdings.Extents.resize(static_cast<std::size_t>(ranks));
  holdings.Blocks.resize(static_cast<std::size_t>(ranks));
  Extent whole = ffdparts::NoExtent;
  for (int r = ranks - 1; r >= 0; --r)
  {
    const double* theirs = &all[static_cast<std::size_t>(r * values)];
    std::vector<Extent>& list = holdings.Extents[static_cast<std::size_t>(r)];
    list.resize(static_cast<std::size_t>(counts[static_cast<std::size_t>(r)]));
    for (std::size_t i = 0; i < list.size(); ++i)
    {
      const int* theirNumbers = &allNumbers[7 * (most * static_cast<std::size_t>(r) + i)];
      holdings.Blocks[static_cast<std::size_t>(r)].push_back(theirNumbers[0]);
      std::copy_n(theirNumbers + 1, 6, list[i].begin());
    }
    Extent e;
    std::transform(theirs + 2, theirs + 8, e.begin(), [](double v) { return static_cast<int>(v); });
    withImage = theirs[0] != 0.0 ? r : withImage;
    holdings.WithLattice = theirs[1] != 0.0 ? r : holdings.WithLattice;
    Extent announced;
    std::transform(
      theirs + 8, theirs + 14, announced.begin(), [](double v) { return static_cast<int>(v); });
    for (const Extent& each : { e, announced })
    {
      if (ffdparts::IsEmpty(whole))
      {
        whole = each;
      }
      else if (!ffdparts::IsEmpty(each))
      {
        for (int a = 0; a < 3; ++a)
        {
          whole[2 * a] = std::min(whole[2 * a], each[2 * a]);
          whole[2 * a + 1] = std::max(whole[2 * a + 1], each[2 * a + 1]);
        }
      }
    }
  }
  holdings.HasImage = withImage >= 0;
  if (!holdings.HasImage)
  {
    return holdings;
  }
  const double* reference = &all[static_cast<std::size_t>(withImage * values)];
  grid.WholeExtent = whole;
  std::copy_n(reference + 14, 3, grid.Origin.begin());
  std::copy_n(reference + 17, 3, grid.Spacing.begin());
  std::copy_n(reference + 20, 9, grid.Direction.begin());
  return holdings;
}

//------------------------------------------------------------------------------
/// Give all processes the lattice of process `root`; -1: there is none.
void vtkFFDVoxelDistribution::ShareLattice(
  vtkMultiProcessController* controller, vtkImageData* image, int root)
{
  this->Lattice = nullptr;
  if (root < 0)
  {
    return;
  }
  vtkNew<vtkFFDLattice> lattice;
  vtkNew<vtkImageData> points;
  std::array<double, 7> numbers{};
  if (controller->GetLocalProcessId() == root && vtkFFDShownLattice::Read(image, lattice))
  {
    lattice->ToImageData(points);
    points->GetOrigin(numbers.data());
    points->GetSpacing(numbers.data() + 3);
    numbers[6] = lattice->GetDisplacementScale();
  }
  // Of an image only the point data are sent bit by bit; the rest comes as decimals.
  controller->Broadcast(points.GetPointer(), root);
  controller->Broadcast(numbers.data(), static_cast<vtkIdType>(numbers.size()), root);
  points->SetOrigin(numbers.data());
  points->SetSpacing(numbers.data() + 3);
  if (points->GetNumberOfPoints() > 0 && lattice->FromImageData(points))
  {
    lattice->SetDisplacementScale(numbers[6]);
    this->Lattice = lattice;
  }
}

//------------------------------------------------------------------------------
/**
 * Decide OwnBox, which is the same of all volumes, and of each volume DeformedBounds and Box. The
 * first process decides: on processors of different kinds bounds may round differently.
 */
void vtkFFDVoxelDistribution::DecideBoxes(
  vtkMultiProcessController* controller, const std::vector<vtkFFDVoxelDistribution*>& volumes)
{
  const auto ranks = static_cast<std::size_t>(controller->GetNumberOfProcesses());
  const auto own = static_cast<std::size_t>(controller->GetLocalProcessId());
  Bounds scene = ffdparts::NoBounds;
  bool inOrder = true;
  std::vector<vtkSmartPointer<vtkMatrix4x4>> toData;
  for (vtkFFDVoxelDistribution* each : volumes)
  {
    const Inputs& inputs = each->Last;
    vtkNew<vtkMatrix4x4> toScene;
    toScene->DeepCopy(inputs.Matrix.data());
    vtkNew<vtkMatrix4x4> inverse;
    vtkMatrix4x4::Invert(toScene, inverse);
    toData.emplace_back(inverse);
    each->DeformedBounds =
      each->BoundsFinder.Find(each->Given.Grid, each->Lattice, inputs.InverseMode);
    each->Cover.SetDeformation(each->Lattice, inputs.InverseMode);
    scene = ffdparts::Unite(scene, ffdparts::Transform(each->DeformedBounds, toScene));
    inOrder = inOrder && inputs.HasOrder && KeepsBoxes(toScene);
  }

  // Boxes of the scene, then of the volumes in it.
  std::vector<double> decided;
  const auto add = [&decided](
                     const Bounds& box) { decided.insert(decided.end(), box.begin(), box.end()); };
  if (controller->GetLocalProcessId() == 0)
  {
    std::vector<Bounds> boxes(ranks, scene);
    if (inOrder)
    {
      boxes = ffdparts::CutIntoBoxes(
        scene, static_cast<int>(ranks), [&volumes, &toData](const Bounds& box) {
          double points = 0.0;
          for (std::size_t v = 0; v < volumes.size(); ++v)
          {
            points += static_cast<double>(ffdparts::CountPoints(ffdparts::FindNeededExtent(
              volumes[v]->Given.Grid, volumes[v]->Cover, ffdparts::Transform(box, toData[v]))));
          }
          return points;
        });
    }
    for (std::size_t r = 1; r < ranks && !inOrder; ++r)
    {
      // No part of the volumes, but a place in the order: a box without thickness beside them.
      boxes[r][0] = boxes[r][1];
    }
    std::for_each(boxes.begin(), boxes.end(), add);
    for (std::size_t v = 0; v < volumes.size(); ++v)
    {
      const Bounds& deformed = volumes[v]->DeformedBounds;
      for (std::size_t r = 0; r < ranks; ++r)
      {
        const Bounds alone = r == 0 ? deformed : ffdparts::NoBounds;
        add(inOrder ? ffdparts::Intersect(ffdparts::Transform(boxes[r], toData[v]), deformed)
                    : alone);
      }
      add(deformed);
    }
  }
  decided.resize(6 * (ranks + (ranks + 1) * volumes.size()));
  controller->Broadcast(decided.data(), static_cast<vtkIdType>(decided.size()), 0);
  const auto read = [&decided](std::size_t at, Bounds& box) {
    std::copy_n(&decided[6 * at], 6, box.begin());
  };
  for (std::size_t v = 0; v < volumes.size(); ++v)
  {
    const std::size_t first = ranks + (ranks + 1) * v;
    read(own, volumes[v]->OwnBox);
    read(first + own, volumes[v]->Box);
    read(first + ranks, volumes[v]->DeformedBounds);
  }
}

//------------------------------------------------------------------------------
/// The voxels that this process wants, with the lattice in the field data; null where it wants
/// none.
vtkSmartPointer<vtkImageData> vtkFFDVoxelDistribution::GatherPart(
  vtkMultiProcessController* controller, vtkImageData* image, const Extent& wanted)
{
  const Holdings& holdings = this->Given;
  const int ranks = controller->GetNumberOfProcesses();
  std::vector<int> allWanted(static_cast<std::size_t>(6 * ranks));
  controller->AllGather(wanted.data(), allWanted.data(), 6);
  std::vector<Extent> needed(static_cast<std::size_t>(ranks));
  bool complete = true;
  for (std::size_t r = 0; r < needed.size(); ++r)
  {
    std::copy_n(&allWanted[6 * r], 6, needed[r].begin());
    complete = complete && ffdparts::Contains(holdings.Extents[r], needed[r]);
  }
  vtkSmartPointer<vtkImageData> part;
  if (complete)
  {
    if (!ffdparts::IsEmpty(wanted))
    {
      part = vtkSmartPointer<vtkImageData>::New();
      part->ShallowCopy(image);
    }
    return part;
  }
  // Most often only the lattice has changed, and what was brought for it last time does.
  const int keepHere = this->HoldsVoxelsOf(image, wanted) ? 1 : 0;
  int keep = 0;
  controller->AllReduce(&keepHere, &keep, 1, vtkCommunicator::MIN_OP);
  if (!keep)
  {
    this->Held = ffdparts::ExchangeVoxels(
      controller, holdings.Grid, image, holdings.Extents, needed, holdings.HasBlocks);
    this->HeldSources = GetSources(image);
  }
  if (this->Held && !ffdparts::IsEmpty(wanted))
  {
    part = vtkSmartPointer<vtkImageData>::New();
    part->ShallowCopy(this->Held);
    // Field data of its own.
    vtkNew<vtkFieldData> none;
    part->SetFieldData(none);
    if (this->Lattice)
    {
      this->Lattice->AttachTo(part);
    }
  }
  return part;
}

//------------------------------------------------------------------------------
/// Write what ReadBounds() and ReadRange() read into the field data of the part.
void vtkFFDVoxelDistribution::Describe(vtkDoubleArray* ranges)
{
  const Bounds clip = ffdparts::OpenOutwards(this->Box, this->DeformedBounds);
  const Bounds rest = this->Given.Grid.GetBounds();
  vtkNew<vtkDoubleArray> array;
  array->SetName(PartArray);
  array->SetNumberOfValues(12);
  std::copy(clip.begin(), clip.end(), array->GetPointer(0));
  std::copy(rest.begin(), rest.end(), array->GetPointer(6));
  // Field data of our own: that of the input is shared.
  vtkNew<vtkFieldData> fields;
  fields->PassData(this->Part->GetFieldData());
  fields->AddArray(array);
  if (ranges)
  {
    fields->AddArray(ranges);
  }
  // Selections are of what the processes have of the data, not of what they render.
  fields->AddArray(this->ListPieces());
  this->Part->SetFieldData(fields);
}

//------------------------------------------------------------------------------
/// The same array as long as it has the same values: what has it has not changed then.
vtkIntArray* vtkFFDVoxelDistribution::ListPieces()
{
  vtkNew<vtkIntArray> pieces;
  pieces->SetName(vtkFFDVolumeInput::PiecesName);
  pieces->SetNumberOfComponents(8);
  for (std::size_t r = 0; r < this->Given.Extents.size(); ++r)
  {
    for (std::size_t i = 0; i < this->Given.Extents[r].size(); ++i)
    {
      pieces->InsertNextValue(static_cast<int>(r));
      pieces->InsertNextValue(this->Given.Blocks[r][i]);
      for (const int limit : this->Given.Extents[r][i])
      {
        pieces->InsertNextValue(limit);
      }
    }
  }
  const vtkIdType count = pieces->GetNumberOfValues();
  if (!this->Pieces || this->Pieces->GetNumberOfValues() != count ||
    !std::equal(pieces->GetPointer(0), pieces->GetPointer(count), this->Pieces->GetPointer(0)))
  {
    this->Pieces = pieces;
  }
  return this->Pieces;
}

//------------------------------------------------------------------------------
void vtkFFDVoxelDistribution::UpdateAll(
  vtkMultiProcessController* controller, const std::vector<vtkFFDVoxelDistribution*>& volumes)
{
  const int changedHere =
    std::all_of(volumes.begin(), volumes.end(),
      [&volumes](const vtkFFDVoxelDistribution* each) {
        return each->Made && each->Next == each->Last && each->Companions == volumes;
      })
    ? 0
    : 1;
  int changed = 0;
  controller->AllReduce(&changedHere, &changed, 1, vtkCommunicator::MAX_OP);
  if (!changed)
  {
    return;
  }
  std::vector<vtkFFDVoxelDistribution*> withImage;
  for (vtkFFDVoxelDistribution* each : volumes)
  {
    each->Last = each->Next;
    each->Made = true;
    each->Companions = volumes;
    each->Part = nullptr;
    each->OwnBox = ffdparts::NoBounds;
    each->DeformedBounds = ffdparts::NoBounds;
    each->Given = GatherHoldings(controller, each->Last);
    if (each->Given.HasImage)
    {
      each->ShareLattice(controller, each->Last.Image, each->Given.WithLattice);
      withImage.push_back(each);
    }
  }
  DecideBoxes(controller, withImage);
  for (vtkFFDVoxelDistribution* each : withImage)
  {
    const Inputs& inputs = each->Last;
    const Extent wanted = ffdparts::FindNeededExtent(each->Given.Grid, each->Cover, each->Box);
    const vtkSmartPointer<vtkDoubleArray> ranges =
      FindRanges(controller, inputs.Image, inputs.Shown);
    each->Part = each->GatherPart(controller, inputs.Image, wanted);
    if (each->Part)
    {
      each->Describe(ranges);
    }
  }
}

//------------------------------------------------------------------------------
bool vtkFFDVoxelDistribution::ReadBounds(vtkImageData* part, Bounds& clip, Bounds& whole)
{
  vtkDataArray* array = part->GetFieldData()->GetArray(PartArray);
  if (!array)
  {
    return false;
  }
  for (int i = 0; i < 6; ++i)
  {
    clip[static_cast<std::size_t>(i)] = array->GetComponent(i, 0);
    whole[static_cast<std::size_t>(i)] = array->GetComponent(6 + i, 0);
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDVoxelDistribution::ReadRange(
  vtkImageData* part, const vtkFFDShownArray& shown, int component, std::array<double, 2>& range)
{
  vtkDataArray* ranges = part->GetFieldData()->GetArray(GetRangesName(shown).c_str());
  const vtkIdType which = ranges && ranges->GetNumberOfTuples() == 2 ? 1 : component + 1;
  if (!ranges || which >= ranges->GetNumberOfTuples())
  {
    return false;
  }
  ranges->GetTuple(which, range.data());
  return true;
}
