// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPacketTable.h"

namespace ffd
{
namespace
{

void AddIntervals(const TransferTable& table, std::vector<TransferInterval>& intervals)
{
  const float* const entries = table.GetEntries();
  for (std::size_t i = 0; i + 1 < table.GetSize(); ++i)
  {
    TransferInterval interval;
    for (std::size_t end = 0; end < 2; ++end)
    {
      const float* entry = entries + 4 * (i + end);
      const float* neighbor = entries + 4 * (i + 1 - end);
      interval.Ends[end] = table.GetInterpolated(entry[3], neighbor[3]);
      interval.Colors[end] = TransferInterval::PackColor(entry);
    }
    intervals.push_back(interval);
  }
}

} // namespace

//------------------------------------------------------------------------------
std::size_t PacketTable::Contents::GetMemorySize() const
{
  return (this->Pieces.capacity() + this->UnitPieces.capacity()) * sizeof(PiecewiseOptics) +
    this->Intervals.capacity() * sizeof(TransferInterval) +
    this->Opacities.capacity() * sizeof(OpacityPair);
}

//------------------------------------------------------------------------------
void PacketTable::Add(const Source& source)
{
  const Range* const last = this->Ranges.empty() ? nullptr : &this->Ranges.back();
  const std::int32_t first = last ? last->First + static_cast<std::int32_t>(last->Intervals) : 0;
  this->Sources.push_back(source);
  this->Ranges.push_back({ first, static_cast<float>(source.Table->GetSize() - 1),
    static_cast<float>(source.Low), static_cast<float>(source.Scale) });
}

//------------------------------------------------------------------------------
std::shared_ptr<const PacketTable::Contents> PacketTable::MakeContents() const
{
  auto contents = std::make_shared<Contents>();
  const Range& last = this->Ranges.back();
  contents->Intervals.reserve(
    static_cast<std::size_t>(last.First) + static_cast<std::size_t>(last.Intervals));
  for (const Source& source : this->Sources)
  {
    PiecewiseOptics pieces;
    pieces.Length = static_cast<float>(source.Length);
    contents->Pieces.push_back(source.InPieces
        ? FindPiecewiseOptics(*source.Table, source.Low, source.Scale, source.Length)
        : pieces);
    const std::size_t first = contents->Intervals.size();
    AddIntervals(*source.Table, contents->Intervals);
    if (!this->HasOpacities)
    {
      continue;
    }
    const double unit = source.Table->GetUnitDistance();
    contents->UnitPieces.push_back(
      FindPiecewiseOptics(*source.Table, source.Low, source.Scale, unit, StraightOpacities));
    const auto opacityOf = [unit](float extinction) {
      return static_cast<float>(OpacityOver(static_cast<double>(extinction), unit));
    };
    for (std::size_t i = first; i < contents->Intervals.size(); ++i)
    {
      const float* const extinctions = contents->Intervals[i].Ends;
      contents->Opacities.push_back({ { opacityOf(extinctions[0]), opacityOf(extinctions[1]) } });
    }
  }
  return contents;
}

} // namespace ffd
