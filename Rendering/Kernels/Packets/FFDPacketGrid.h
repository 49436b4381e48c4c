// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketGrid_h
#define FFDPacketGrid_h

#include "FFDCellMask.h"
#include "FFDExport.h"
#include "FFDVolumeView.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ffd
{

/// An axis of an AxisMap in the form that packet kernels read: a load of 128 bits gives all of an
/// entry.
struct PacketAxis
{
  /// Two lines that meet at a position: voxel coordinates by index coordinates.
  struct Bend
  {
    float Index;
    float Voxel;
    float SlopeBefore;
    float SlopeBehind;
  };
  static_assert(sizeof(Bend) == 16, "bends are loaded as 128 bits");

  /// A part of the axis, and its parts of equal lengths, each with a bend.
  struct Bin
  {
    float Low;          ///< index coordinate
    float PerIndex;     ///< bends an index unit
    std::int32_t First; ///< its first bend
    float Last;         ///< number of the last one from that on
  };
  static_assert(sizeof(Bin) == 16, "bins are loaded as 128 bits");

  Bin Whole{};           ///< of equal parts: each has a bend, or a bin if there are bins
  std::vector<Bin> Bins; ///< none: no part needs several bends
  std::vector<Bend> Bends;

  /// The numbers of the bends, each kind by itself; as in the tables below, Ahead more can be
  /// loaded from any one on.
  std::vector<float> Columns[4];
  static constexpr std::size_t Ahead = 16;

  /// Index coordinates of the voxel coordinates 0, 1 / PlacesPerVoxel .., and the widths, index
  /// units, of differences over a voxel to each side, not beyond the volume, there.
  std::vector<float> Places;
  std::vector<float> Widths;
  float PlacesPerVoxel = 1.0f;
  float LastPlace = 0.0f; ///< number of the last one

  static constexpr int Slopes = 64;
  float Steepest[Slopes] = {}; ///< the largest slopes in as many equal parts
  float SlopesPerIndex = 0.0f;

  float ToVoxel(float x) const
  {
    const auto find = [x](const Bin& bin) {
      return static_cast<std::size_t>(bin.First) +
        static_cast<std::size_t>(std::min(std::max((x - bin.Low) * bin.PerIndex, 0.0f), bin.Last));
    };
    std::size_t entry = find(this->Whole);
    entry = this->Bins.empty() ? entry : find(this->Bins[entry]);
    const Bend& bend = this->Bends[entry];
    const float way = x - bend.Index;
    return bend.Voxel + way * (way < 0.0f ? bend.SlopeBefore : bend.SlopeBehind);
  }

  /// The largest slope between two index coordinates.
  float FindSteepest(float from, float to) const
  {
    const auto part = [this](float x) {
      return static_cast<int>(
        std::min(std::max((x - this->Whole.Low) * this->SlopesPerIndex, 0.0f), Slopes - 1.0f));
    };
    return *std::max_element(this->Steepest + part(from), this->Steepest + part(to) + 1);
  }
};

/// Where the voxels of a volume lie that is not a plain image, and which cells are hidden, in the
/// form that packet kernels read.
struct PacketGrid
{
  bool Uneven = false; ///< voxels are where Axes say
  PacketAxis Axes[3];

  const std::uint8_t* Hidden = nullptr; ///< CellMask::GetBytes(); null: all cells are shown
  int HiddenRow = 0;                    ///< bytes
  int HiddenSlice = 0;
  const std::uint8_t* NearHidden = nullptr; ///< CellMask::GetNearBlocks()
  int NearRow = 0;                          ///< blocks
  int NearSlice = 0;
  float LastCell[3] = {};
  float Margin = 0.0f; ///< VolumeView::Margin
  /// Whether values beside hidden cells are those of the nearest cells, which voxels are.
  bool Snaps = false;

  /// Whether values are interpolated elsewhere than at index coordinates.
  bool MovesSamples() const { return this->Uneven || this->Snaps; }

  /// The middle of the box of index coordinates in which all voxels of differences exist, and how
  /// far it reaches from there.
  float InnerMiddle[3] = {};
  float InnerReach[3] = {};

  /// Whether gradients are not just differences of voxels.
  bool ChangesGradients() const { return this->Uneven || this->Hidden; }
};

/// `hidden`: may be null; must outlive the grid.
FFD_RENDERING_EXPORT PacketGrid MakePacketGrid(const VolumeView& volume, const CellMask* hidden);

} // namespace ffd

#endif
