// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPacketGrid.h"

#include "FFDAxisMap.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ffd
{
namespace
{

/// Parts of equal lengths of an axis, and then again of one of these, at most: more would be
/// shorter than what single precision tells apart.
constexpr double MostBins = 16384.0;
constexpr double MostBends = 1024.0;

/// Of voxel coordinates in single precision.
constexpr double RoundingGuard = 1e-2;

/// The bend number i of the piecewise linear map of an axis.
PacketAxis::Bend MakeBend(const AxisMap& map, int axis, std::size_t i)
{
  const std::vector<double>& p = map.GetPositions(axis);
  const auto slope = [&](std::size_t from) {
    return static_cast<float>(map.GetStep() / (p[from + 1] - p[from]));
  };
  return { static_cast<float>(p[i]),
    static_cast<float>(map.GetFirst() + map.GetStep() * static_cast<double>(i)),
    i > 0 ? slope(i - 1) : 0.0f, i + 1 < p.size() ? slope(i) : 0.0f };
}

/// Parts of equal lengths from `low` on, over `length`, so that no two of the positions from
/// `first` on, before `end`, are in one, unless there would have to be more than `most`.
PacketAxis::Bin DivideEvenly(const std::vector<double>& positions, std::size_t first,
  std::size_t end, double low, double length, double most)
{
  double least = length;
  for (std::size_t i = first + 1; i < end; ++i)
  {
    least = std::min(least, positions[i] - positions[i - 1]);
  }
  // A little more: rounding may move positions from part to part.
  const double parts = std::min(1.001 * length / least, most);
  return { static_cast<float>(low), static_cast<float>(parts / length), 0,
    static_cast<float>(std::floor(parts)) };
}

/// Calls take(first, end) with the range of positions in each part of a bin, of those from `begin`
/// on, before `stop`.
template <class Take>
void ForParts(const std::vector<double>& positions, std::size_t begin, std::size_t stop,
  const PacketAxis::Bin& bin, const Take& take)
{
  const int last = static_cast<int>(bin.Last);
  std::size_t first = begin;
  for (int part = 0; part <= last; ++part)
  {
    std::size_t end = first;
    while (end < stop &&
      (part == last ||
        (positions[end] - static_cast<double>(bin.Low)) * static_cast<double>(bin.PerIndex) <
          part + 1.0))
    {
      ++end;
    }
    take(first, end);
    first = end;
  }
}

PacketAxis MakePacketAxis(const AxisMap& map, int axis, double lastVoxel)
{
  const std::vector<double>& p = map.GetPositions(axis);
  const std::size_t count = p.size();
  PacketAxis result;
  result.Whole = DivideEvenly(p, 0, count, p.front(), p.back() - p.front(), MostBins);
  // Of a part without positions the line behind the last position before it is used.
  const auto addBend = [&](std::size_t, std::size_t end) {
    result.Bends.push_back(MakeBend(map, axis, std::max<std::size_t>(end, 1) - 1));
  };
  bool several = false;
  ForParts(p, 0, count, result.Whole,
    [&](std::size_t first, std::size_t end) { several = several || end - first > 1; });
  if (!several)
  {
    ForParts(p, 0, count, result.Whole, addBend);
  }
  else
  {
    double part = 0.0;
    const double length = 1.0 / static_cast<double>(result.Whole.PerIndex);
    ForParts(p, 0, count, result.Whole, [&](std::size_t first, std::size_t end) {
      const double low = static_cast<double>(result.Whole.Low) + part * length;
      part += 1.0;
      PacketAxis::Bin bin{};
      if (end - first > 1)
      {
        bin = DivideEvenly(p, first, end, low, length, MostBends);
      }
      bin.First = static_cast<std::int32_t>(result.Bends.size());
      ForParts(p, first, end, bin, addBend);
      result.Bins.push_back(bin);
    });
  }
  for (const PacketAxis::Bend& bend : result.Bends)
  {
    result.Columns[0].push_back(bend.Index);
    result.Columns[1].push_back(bend.Voxel);
    result.Columns[2].push_back(bend.SlopeBefore);
    result.Columns[3].push_back(bend.SlopeBehind);
  }
  const int places = static_cast<int>(std::lround(lastVoxel / map.GetStep()));
  for (int i = 0; i <= places; ++i)
  {
    const double at = i * map.GetStep();
    result.Places.push_back(static_cast<float>(map.ToIndex(axis, at)));
    result.Widths.push_back(static_cast<float>(map.ToIndex(axis, std::min(at + 1.0, lastVoxel)) -
      map.ToIndex(axis, std::max(at - 1.0, 0.0))));
  }
  result.LastPlace = static_cast<float>(places);
  for (std::vector<float>* table : { &result.Columns[0], &result.Columns[1], &result.Columns[2],
         &result.Columns[3], &result.Places, &result.Widths })
  {
    table->resize(table->size() + PacketAxis::Ahead);
  }
  result.PlacesPerVoxel = static_cast<float>(1.0 / map.GetStep());
  result.SlopesPerIndex = static_cast<float>(PacketAxis::Slopes / (p.back() - p.front()));
  for (std::size_t i = 0; i + 1 < count; ++i)
  {
    const auto part = [&](double x) {
      return std::clamp(
        static_cast<int>((x - p.front()) * static_cast<double>(result.SlopesPerIndex)), 0,
        PacketAxis::Slopes - 1);
    };
    const float slope = static_cast<float>(map.GetStep() / (p[i + 1] - p[i]));
    // A part more on both sides against rounding errors.
    const int last = std::min(part(p[i + 1]) + 1, PacketAxis::Slopes - 1);
    for (int k = std::max(part(p[i]) - 1, 0); k <= last; ++k)
    {
      result.Steepest[k] = std::max(result.Steepest[k], slope);
    }
  }
  return result;
}

} // namespace

//------------------------------------------------------------------------------
PacketGrid MakePacketGrid(const VolumeView& volume, const CellMask* hidden)
{
  PacketGrid grid;
  grid.Margin = static_cast<float>(volume.Margin);
  for (int a = 0; a < 3; ++a)
  {
    const double voxels[2] = { 1.0, volume.Dimensions[a] - 2.0 };
    const auto toIndex = [&](double voxel) {
      return volume.Axes ? volume.Axes->ToIndex(a, voxel) : voxel;
    };
    // Voxel coordinates are rounded.
    const double guard = volume.Axes ? RoundingGuard : 0.0;
    const double low = toIndex(voxels[0] + guard);
    const double high = toIndex(voxels[1] - guard);
    grid.InnerMiddle[a] = static_cast<float>(0.5 * (low + high));
    grid.InnerReach[a] = static_cast<float>(0.5 * (high - low));
  }
  if (volume.Axes)
  {
    grid.Uneven = true;
    for (int a = 0; a < 3; ++a)
    {
      grid.Axes[a] = MakePacketAxis(*volume.Axes, a, volume.Dimensions[a] - 1.0);
    }
  }
  if (hidden)
  {
    grid.Hidden = hidden->GetBytes();
    grid.HiddenRow = static_cast<int>(hidden->GetRowBytes());
    grid.HiddenSlice = static_cast<int>(hidden->GetSliceBytes());
    grid.NearHidden = hidden->GetNearBlocks();
    grid.NearRow = hidden->GetBlocks().x;
    grid.NearSlice = hidden->GetBlocks().x * hidden->GetBlocks().y;
    for (int a = 0; a < 3; ++a)
    {
      grid.LastCell[a] = static_cast<float>(hidden->GetCells()[a] - 1);
    }
    grid.Snaps = volume.Margin > 0.0;
  }
  return grid;
}

} // namespace ffd
