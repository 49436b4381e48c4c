// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketTable_h
#define FFDPacketTable_h

#include "FFDExport.h"
#include "FFDPiecewiseOptics.h"
#include "FFDTransferTable.h"
#include "Optics/FFDTransferInterval.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace ffd
{

/// Transfer tables in the form that the packet kernels read; extinctions are GetInterpolated().
class PacketTable
{
public:
  /// The position of a table and the range of its values; loaded as 128 bits, too.
  struct Range
  {
    std::int32_t First; ///< interval
    float Intervals;    ///< number of intervals
    float Low;          ///< value of the first entry
    float Scale;        ///< entries a unit of values
  };
  static_assert(sizeof(Range) == 16, "ranges are loaded as 128 bits");

  /// What is interpolated between the ends of an interval for normals of opacity: opacities over
  /// the unit distance, which may be below zero as GetInterpolated() is.
  struct OpacityPair
  {
    float Ends[2];
  };

  /// What one table is made from.
  struct Source
  {
    const TransferTable* Table;
    double Low;    ///< value of the first entry
    double Scale;  ///< entries a unit of values
    double Length; ///< of PiecewiseOptics, data units
    bool InPieces; ///< whether pieces are found: opacities are asked for, not extinctions

    bool operator==(const Source& other) const
    {
      return this->Table == other.Table && this->Low == other.Low && this->Scale == other.Scale &&
        this->Length == other.Length && this->InPieces == other.InPieces;
    }
  };

  /// What takes time to make.
  struct Contents
  {
    std::vector<PiecewiseOptics> Pieces;     ///< of each table
    std::vector<TransferInterval> Intervals; ///< of all tables
    // For normals of opacity.
    std::vector<PiecewiseOptics> UnitPieces; ///< of each table, over its unit distance
    std::vector<OpacityPair> Opacities;      ///< of the intervals

    FFD_RENDERING_EXPORT std::size_t GetMemorySize() const;
  };

  /// Another table behind those that there are; it must outlive Fill().
  FFD_RENDERING_EXPORT void Add(const Source& source);

  /// Adds to the contents what normals of opacity need.
  void AddOpacities() { this->HasOpacities = true; }

  const std::vector<Source>& GetSources() const { return this->Sources; }
  bool GetHasOpacities() const { return this->HasOpacities; }
  FFD_RENDERING_EXPORT std::shared_ptr<const Contents> MakeContents() const;

  /// `contents`: MakeContents() of the same sources. Before it, only ranges are known.
  void Fill(std::shared_ptr<const Contents> contents) { this->Filled = std::move(contents); }

  std::size_t GetSize() const { return this->Ranges.size(); }
  const Range& GetRange(std::size_t table) const { return this->Ranges[table]; }
  const Range* GetRanges() const { return this->Ranges.data(); }
  const PiecewiseOptics& GetPieces(std::size_t table) const { return this->Filled->Pieces[table]; }
  const PiecewiseOptics& GetUnitPieces(std::size_t table) const
  {
    return this->Filled->UnitPieces[table];
  }
  const TransferInterval* GetIntervals() const { return this->Filled->Intervals.data(); }
  const OpacityPair* GetOpacities() const { return this->Filled->Opacities.data(); }

private:
  std::vector<Source> Sources;
  std::vector<Range> Ranges;
  bool HasOpacities = false;
  std::shared_ptr<const Contents> Filled;
};

} // namespace ffd

#endif
