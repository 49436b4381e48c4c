// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFrameStages.h"

#include "vtkFFDBlendingFromMapper.h"

#include "FFDAxisMap.h"
#include "FFDCellMask.h"
#include "FFDGridIndex.h"
#include "FFDSampling.h"

#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkPiecewiseFunction.h"
#include "vtkVolumeProperty.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>
#include <sstream>
#include <utility>

namespace ffd
{
namespace
{

/// Most that a deformation may enlarge the volume: beyond, its inverse is lost in rounding, and
/// takes for ever.
constexpr double LargestGrowth = 1e5;

/// Diagonals of volumes, data units: squares of lengths must be numbers in single precision.
constexpr double SmallestDiagonal = 1e-16;
constexpr double LargestDiagonal = 1e16;

/// The pull-backs of all mappers of the process.
class PullBackRegistry
{
public:
  using Entry = std::shared_ptr<const BoundedPullBack>;

  /// The pull-back of the same field, kind, tolerance and volume; null without any.
  Entry Find(const BSplineField& field, const PullBack& map, const Box& rest)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    for (const std::weak_ptr<const BoundedPullBack>& each : this->All)
    {
      Entry known = each.lock();
      if (known && known->Map.GetKind() == map.GetKind() &&
        known->Map.GetTolerance() == map.GetTolerance() &&
        known->Map.GetDomain() == map.GetDomain() && known->RestBounds == rest &&
        known->Field == field)
      {
        return known;
      }
    }
    return nullptr;
  }

  void Add(const Entry& made)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->All.erase(std::remove_if(this->All.begin(), this->All.end(),
                      [](const auto& each) { return each.expired(); }),
      this->All.end());
    this->All.push_back(made);
  }

private:
  std::mutex Mutex;
  std::vector<std::weak_ptr<const BoundedPullBack>> All;
};

/// Cells from First to Last along an axis.
struct CellRange
{
  int First;
  int Last;
};

/// The cells that positions in each block along an axis are in; those at its faces, too.
std::vector<CellRange> FindCellsOfBlocks(const VolumeView& volume, int cells, int axis, int blocks)
{
  constexpr double size = MinMaxBlocks::BlockSize;
  std::vector<CellRange> ranges;
  for (int block = 0; block < blocks; ++block)
  {
    // The first and the last block have what lies beyond them, too.
    const double from = block == 0 ? volume.LowerIndex()[axis] : size * block;
    const double to = block == blocks - 1 ? volume.UpperIndex()[axis] : size * (block + 1);
    const auto cellAt = [&](double index) {
      const double voxel = volume.Axes ? volume.Axes->ToVoxel(axis, index) : index;
      return std::clamp(static_cast<int>(std::floor(voxel + volume.Margin)), 0, cells - 1);
    };
    ranges.push_back({ cellAt(from), cellAt(to) });
  }
  return ranges;
}

/// ComponentBlocks::Hidden.
std::vector<std::uint8_t> FindHiddenBlocks(
  const Voxels& voxels, const glm::ivec3& blocks, const ParallelFor& parallelFor)
{
  const CellMask& hidden = voxels.Hidden;
  std::vector<CellRange> ranges[3];
  for (int a = 0; a < 3; ++a)
  {
    ranges[a] = FindCellsOfBlocks(voxels.View, hidden.GetCells()[a], a, blocks[a]);
  }
  std::vector<std::uint8_t> result(GridSize(blocks));
  parallelFor(ranges[2].size(), [&](std::size_t first, std::size_t last) {
    std::size_t at = first * ranges[1].size() * ranges[0].size();
    for (std::size_t k = first; k < last; ++k)
    {
      const CellRange& z = ranges[2][k];
      for (const CellRange& y : ranges[1])
      {
        for (const CellRange& x : ranges[0])
        {
          result[at++] =
            hidden.HasAll({ x.First, y.First, z.First }, { x.Last, y.Last, z.Last }) ? 1 : 0;
        }
      }
    }
  });
  return result;
}

/// As ComponentBlocks::Hidden, with the blocks of which nothing is left by a cropping of the volume
/// at rest.
std::vector<std::uint8_t> CropBlocks(const Cropping& crop, const glm::ivec3& blocks,
  std::vector<std::uint8_t> hidden, const ParallelFor& parallelFor)
{
  // Kernels round positions and planes.
  constexpr double rounding = 0.01;
  // For each block of an axis a bit for each of the three parts that planes cut the axis into.
  std::vector<int> parts[3];
  for (int a = 0; a < 3; ++a)
  {
    for (int block = 0; block < blocks[a]; ++block)
    {
      const double from = block == 0 ? -VTK_DOUBLE_MAX : block * MinMaxBlocks::BlockSize - rounding;
      const double to =
        block == blocks[a] - 1 ? VTK_DOUBLE_MAX : (block + 1) * MinMaxBlocks::BlockSize + rounding;
      parts[a].push_back((2 << crop.FindPart(to, a)) - (1 << crop.FindPart(from, a)));
    }
  }
  // Whether any region of such parts is shown, by the bits of the three axes.
  std::array<bool, 512> shown{};
  for (int bits = 0; bits < 512; ++bits)
  {
    for (int region = 0; region < 27; ++region)
    {
      const int own = 1 << region % 3 | 8 << region / 3 % 3 | 64 << region / 9;
      shown[bits] = shown[bits] || ((crop.Flags >> region & 1) != 0 && (bits & own) == own);
    }
  }
  hidden.resize(GridSize(blocks));
  parallelFor(static_cast<std::size_t>(blocks.z), [&](std::size_t begin, std::size_t end) {
    std::size_t at = begin * GridSize(glm::ivec3(blocks.x, blocks.y, 1));
    for (std::size_t k = begin; k < end; ++k)
    {
      for (const int y : parts[1])
      {
        const bool* const ofRow = &shown[64 * parts[2][k] + 8 * y];
        for (const int x : parts[0])
        {
          hidden[at] = hidden[at] != 0 || !ofRow[x] ? 1 : 0;
          ++at;
        }
      }
    }
  });
  return hidden;
}

/// Whether a deformation T leaves a region no inside, as when all control points are in one plane:
/// det J_T is zero, to rounding, at points throughout the region.
bool IsFlattened(const BSplineField& field, const Box& rest)
{
  constexpr int count = 5;
  constexpr double rounding = 1e-12;
  for (int i = 0; i < count * count * count; ++i)
  {
    const glm::dvec3 at(i % count, i / count % count, i / (count * count));
    glm::dmat3 jacobian;
    field.Displacement(rest.Min + (at + 0.5) / double(count) * (rest.Max - rest.Min), jacobian);
    jacobian += glm::dmat3(1.0);
    const double largest = std::max(
      { 1.0, glm::length(jacobian[0]), glm::length(jacobian[1]), glm::length(jacobian[2]) });
    if (std::abs(glm::determinant(jacobian)) > rounding * largest * largest * largest)
    {
      return false;
    }
  }
  return true;
}

PullBackRegistry& AllPullBacks()
{
  static PullBackRegistry all;
  return all;
}

bool IsExtreme(BlendMode mode) { return mode == BlendMode::Maximum || mode == BlendMode::Minimum; }

/// The numbers of the blocks whose values decide what a blend mode other than Composite may leap
/// over; none where nothing may.
std::vector<std::size_t> FindDecidingBlocks(
  const ComponentBlocks& blocks, const TransferFunctions& functions, const Blending& blend)
{
  const std::size_t count = blocks.Blocks.size();
  if (functions.Facts.Kind != ComponentKind::Independent)
  {
    // The blocks of dependent components are those of what is looked up for opacity.
    return IsExtreme(blend.Mode) && count == 1 ? std::vector<std::size_t>{ 0 }
                                               : std::vector<std::size_t>();
  }
  if (blend.Mode == BlendMode::Isosurface)
  {
    return { static_cast<std::size_t>(blend.IsoComponent) };
  }
  std::vector<std::size_t> all(IsExtreme(blend.Mode) || count == 1 ? count : 0);
  std::iota(all.begin(), all.end(), std::size_t{ 0 });
  return all;
}

/// The distances to blocks that any of the components can be visible in by its table.
DistanceMap MakeDistances(const std::vector<const MinMaxBlocks*>& components,
  const std::vector<TransferTable>& tables, const ParallelFor& parallelFor,
  const MinMaxBlocks* mask, const std::vector<std::uint8_t>* hidden)
{
  if (components.size() == 1)
  {
    return DistanceMap(*components[0], tables[0], parallelFor, mask, hidden);
  }
  return DistanceMap(
    components,
    [&tables](const MinMaxBlocks::Limits* limits) {
      return std::all_of(tables.begin(), tables.end(), [&](const TransferTable& table) {
        const MinMaxBlocks::Limits& own = limits[&table - tables.data()];
        return table.IsTransparent(own.Min, own.Max);
      });
    },
    parallelFor, mask, hidden);
}

} // namespace

//------------------------------------------------------------------------------
Made MakeBoundedPullBack(SharedPullBack& result, StageTools& tools,
  const Product<DeformationField>& field, const std::array<double, 6>& bounds, InverseMode mode,
  double tolerance)
{
  const Box rest = { glm::dvec3(bounds[0], bounds[2], bounds[4]),
    glm::dvec3(bounds[1], bounds[3], bounds[5]) };
  const double diagonal = glm::length(rest.Max - rest.Min);
  if (diagonal > LargestDiagonal || diagonal < SmallestDiagonal)
  {
    std::ostringstream text;
    text << "The diagonal of the volume is " << diagonal
         << " long, which cannot be rendered: at least " << SmallestDiagonal << " and at most "
         << LargestDiagonal << " can. Choose another unit of length for its spacing and origin.";
    tools.Message = text.str();
    return Made::Not;
  }
  const PullBack map(
    &field->Field, FindPullBackKind(mode, field->Inverted), tolerance, field->Domain);
  if (auto known = AllPullBacks().Find(field->Field, map, rest))
  {
    result.Last = std::move(known);
    return Made::Anew;
  }
  const auto made = std::make_shared<BoundedPullBack>();
  made->Field = field->Field;
  made->Map = PullBack(&made->Field, map.GetKind(), tolerance, map.GetDomain());
  made->RestBounds = rest;
  if (result.Last)
  {
    // Of these only what has changed is found anew.
    made->Bounds = result.Last->Bounds;
  }
  made->Bounds.Update(made->Map, tools.Parallel);
  made->Limits = made->Bounds.GetLimits();
  Box& deformed = made->DeformedBounds;
  deformed = made->Bounds.DeformedBounds(rest, tools.Parallel);
  const double growth = glm::length(deformed.Max - deformed.Min) / diagonal;
  if (!deformed.IsEmpty() && growth > LargestGrowth)
  {
    std::ostringstream text;
    text << "The deformation makes the volume " << growth
         << " times as large, which cannot be rendered. Check its displacements and their scale.";
    tools.Message = text.str();
    return Made::Not;
  }
  if (!map.IsIdentity() && InvertsTheField(map.GetKind()) && !made->Bounds.IsProvenInvertible() &&
    IsFlattened(field->Field, rest))
  {
    tools.Warning = "The deformation is singular everywhere: it presses the volume flat, into a "
                    "plane, a line or a point, of which nothing can be seen. Check the control "
                    "points, or the scale of the transform.";
  }
  result.Last = made;
  ++result.NumberOfBuilds;
  AllPullBacks().Add(made);
  return Made::Anew;
}

//------------------------------------------------------------------------------
std::size_t SharedPullBack::GetMemorySize() const
{
  return this->Last ? this->Last->Bounds.GetMemorySize() + this->Last->KeptOfField->GetMemorySize()
                    : 0;
}

//------------------------------------------------------------------------------
std::size_t ComponentBlocks::GetMemorySize() const
{
  std::size_t size = this->Hidden.capacity();
  for (const MinMaxBlocks& each : this->Blocks)
  {
    size += each.GetMemorySize();
  }
  return size;
}

//------------------------------------------------------------------------------
Made MakeComponentBlocks(ComponentBlocks& result, StageTools& tools, const Product<Voxels>& voxels,
  const std::vector<int>& components)
{
  result.Blocks.clear();
  result.Components = components;
  result.OfBytes = voxels->View.Type == ScalarType::UInt8 || voxels->View.Type == ScalarType::Int8;
  for (int c : components)
  {
    result.Blocks.emplace_back(GetComponent(voxels->View, c), tools.Parallel);
  }
  result.Hidden.clear();
  if (voxels->HasHidden)
  {
    result.Hidden = FindHiddenBlocks(*voxels, result.Blocks[0].GetBlocks(), tools.Parallel);
  }
  return Made::Anew;
}

//------------------------------------------------------------------------------
Made MakeMaskBlocks(MaskBlocks& result, StageTools& tools, const UniformView& view,
  const Source<vtkDataArray>& vtkNotUsed(scalars))
{
  result.Blocks.reset();
  if (view.View.Scalars)
  {
    result.Blocks.emplace(view.View, tools.Parallel);
  }
  return Made::Anew;
}

//------------------------------------------------------------------------------
Made MakeLabelBlocks(LabelBlocks& result, StageTools& tools, const UniformView& view,
  bool isLabelMap, const Source<vtkDataArray>& vtkNotUsed(scalars))
{
  result = view.View.Scalars ? LabelBlocks(view.View, isLabelMap, tools.Parallel) : LabelBlocks();
  return Made::Anew;
}

//------------------------------------------------------------------------------
MinMaxBlocks::Limits FindRangeOfWhole(
  const MinMaxBlocks::Limits& range, int components, const std::array<double, 2>& whole)
{
  if (components > 1 || whole[0] > whole[1])
  {
    return range;
  }
  return range.Min > range.Max
    ? MinMaxBlocks::Limits{ whole[0], whole[1] }
    : MinMaxBlocks::Limits{ std::min(whole[0], range.Min), std::max(whole[1], range.Max) };
}

//------------------------------------------------------------------------------
Source<vtkVolumeProperty> FindSource(vtkVolumeProperty* property, int components)
{
  // VTK makes functions that are missing when they are asked for, and several mappers, each in a
  // thread of its own, may have one property.
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  for (int c = 0; c < components; ++c)
  {
    property->GetScalarOpacity(c);
    property->GetGradientOpacity(c);
    property->GetColorChannels(c) == 1
      ? static_cast<vtkObject*>(property->GetGrayTransferFunction(c))
      : property->GetRGBTransferFunction(c);
  }
  vtkMTimeType time = property->GetMTime();
  for (const int label : property->GetLabelMapLabels())
  {
    vtkObject* const functions[3] = { property->GetLabelColor(label),
      property->GetLabelScalarOpacity(label), property->GetLabelGradientOpacity(label) };
    for (vtkObject* function : functions)
    {
      time = function ? std::max(time, function->GetMTime()) : time;
    }
  }
  return { property, time };
}

//------------------------------------------------------------------------------
Made MakeTransferFunctions(TransferFunctions& result, StageTools& tools,
  const Product<Voxels>& voxels, const Product<ComponentBlocks>& blocks,
  const Source<vtkVolumeProperty>& property, const LookupOptions& options,
  const Source<vtkDataArray>& secondAxis)
{
  const VolumeView& volume = voxels->View;
  ScalarFacts facts;
  facts.Kind = options.Kind;
  facts.Type = volume.Type;
  facts.Nearest = property.Object->GetInterpolationType() != VTK_LINEAR_INTERPOLATION;
  facts.HasLabels = options.HasLabels;
  facts.NativeColors = options.Native[0];
  facts.NativeOpacities = options.Native[1];
  facts.NativeGradients = options.Native[2];
  const std::vector<int>& known = blocks->Components;
  for (int c = 0; c < volume.Components; ++c)
  {
    const auto at = std::find(known.begin(), known.end(), c);
    MinMaxBlocks::Limits range;
    MinMaxBlocks::Limits common;
    if (at != known.end())
    {
      const MinMaxBlocks& own = blocks->Blocks[static_cast<std::size_t>(at - known.begin())];
      range = FindRangeOfWhole(own.GetRange(), volume.Components, options.WholeRange);
      common = own.GetCommonRange();
    }
    else
    {
      double finite[2];
      voxels->Scalars->GetFiniteRange(finite, c);
      range = { finite[0], finite[1] };
      common = range;
    }
    // Not a number anywhere: nothing is looked up.
    facts.Ranges.push_back(range.Min <= range.Max ? range : MinMaxBlocks::Limits{ 0.0, 1.0 });
    facts.CommonRanges.push_back(common.Min <= common.Max ? common : facts.Ranges.back());
  }
  if (secondAxis.Object)
  {
    double range[2];
    secondAxis.Object->GetFiniteRange(range, 0);
    facts.HasSecondAxis = true;
    facts.SecondAxis = { range[0], range[1] };
  }
  OpticalFunctions optics;
  if (!MakeOpticalFunctions(property.Object, facts, optics, tools.Message))
  {
    return Made::Not;
  }
  if (result.Visibility == 0 || !HaveSameVisibility(optics, result.Optics))
  {
    ++result.Visibility;
  }
  result.Facts = std::move(facts);
  result.Optics = std::move(optics);
  result.KeptOfThem = std::make_unique<FunctionCache>();
  return Made::Anew;
}

//------------------------------------------------------------------------------
std::size_t TransferFunctions::GetMemorySize() const
{
  return this->Optics.GetMemorySize() + (this->KeptOfThem ? this->KeptOfThem->GetMemorySize() : 0);
}

//------------------------------------------------------------------------------
bool LeapBlending::operator==(const LeapBlending& other) const
{
  return HaveSameLeaps(this->Blend, other.Blend);
}

//------------------------------------------------------------------------------
std::size_t EmptySpace::GetMemorySize() const
{
  std::size_t size =
    this->Distances.GetMemorySize() + (this->KeptOfThem ? this->KeptOfThem->GetMemorySize() : 0);
  for (const ValuePeaks& each : this->Peaks)
  {
    size += each.GetMemorySize();
  }
  return size;
}

//------------------------------------------------------------------------------
Made MakeEmptySpace(EmptySpace& result, StageTools& tools, const Product<ComponentBlocks>& blocks,
  const Product<MaskBlocks>& mask, const Product<TransferFunctions>& functions,
  const LeapBlending& blending, const Cropping& crop)
{
  const OpticalFunctions& optics = functions->Optics;
  const ComponentOptics& first = optics.Components[0];
  const BlendMode mode = blending.Blend.Mode;
  const MinMaxBlocks* const shown = mask->Blocks ? &*mask->Blocks : nullptr;
  const std::vector<std::uint8_t>* hidden = &blocks->Hidden;
  std::vector<std::uint8_t> cropped;
  if (crop.Space == Cropping::Spaces::Rest)
  {
    cropped = CropBlocks(crop, blocks->Blocks[0].GetBlocks(), *hidden, tools.Parallel);
    hidden = &cropped;
  }
  result.CanLeap = true;
  result.Peaks.clear();
  result.KeptOfThem.reset(
    blocks->Blocks[0].GetNumberOfBlocks() > SpaceCache::FewBlocks ? new SpaceCache : nullptr);
  if (mode != BlendMode::Composite)
  {
    const std::vector<std::size_t> deciding =
      FindDecidingBlocks(*blocks, *functions, blending.Blend);
    std::vector<const MinMaxBlocks*> values;
    std::vector<TransferTable> leaps(deciding.size());
    result.CanLeap = !deciding.empty();
    for (std::size_t i = 0; i < deciding.size() && result.CanLeap; ++i)
    {
      values.push_back(&blocks->Blocks[deciding[i]]);
      // Labels do not count, nor do gradients.
      const ComponentOptics& component = optics.Components[deciding[i]];
      result.CanLeap = MakeLeapTable(blending.Blend,
        component.Plane.IsEmpty() ? component.Table : component.Plane.MakeTableOfLastRow(),
        leaps[i]);
    }
    if (result.CanLeap)
    {
      result.Distances = MakeDistances(values, leaps, tools.Parallel, shown, hidden);
    }
    if (result.CanLeap && IsExtreme(mode))
    {
      for (const MinMaxBlocks* each : values)
      {
        // Beside bytes, all that is kept may take a twentieth at most.
        result.Peaks.emplace_back(
          *each, mode == BlendMode::Maximum ? 1 : -1, blocks->OfBytes, tools.Parallel);
      }
    }
  }
  else if (blocks->Blocks.size() == 1 && first.Plane.IsEmpty() && optics.Labels.empty())
  {
    result.Distances = DistanceMap(blocks->Blocks[0], first.Table, tools.Parallel, shown, hidden);
  }
  else
  {
    std::vector<const MinMaxBlocks*> components;
    for (const MinMaxBlocks& each : blocks->Blocks)
    {
      components.push_back(&each);
    }
    result.Distances = DistanceMap(
      components,
      [&optics](const MinMaxBlocks::Limits* limits) { return optics.IsTransparent(limits); },
      tools.Parallel, shown, hidden);
  }
  return Made::Anew;
}

} // namespace ffd
