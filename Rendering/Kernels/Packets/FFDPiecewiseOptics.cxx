// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPiecewiseOptics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace ffd
{
namespace
{

/// Largest differences of pieces from the entries of the table: of opacities, a part of each and a
/// little, and of colors.
constexpr double RelativeTolerance = 1e-3;
constexpr double LeastTolerance = 1e-6;
constexpr double ColorTolerance = 1.0 / 2048.0;

/// Opacities that change more than this within fewer entries are interpolated otherwise in the
/// table, whose extinctions are linear between entries.
constexpr double LargestJump = 0.05;
constexpr std::size_t FewEntries = 4;

/// The channels of PiecewiseOptics.
using Entry = std::array<double, PiecewiseOptics::NumberOfChannels>;

double ToleranceOf(const Entry& entry, std::size_t channel)
{
  return channel == 0 ? RelativeTolerance * entry[0] + LeastTolerance : ColorTolerance;
}

std::vector<Entry> FindEntries(const TransferTable& table)
{
  std::vector<Entry> entries(table.GetSize());
  const float* entry = table.GetEntries();
  for (Entry& to : entries)
  {
    to = { OpacityOver(static_cast<double>(entry[3]), table.GetUnitDistance()), entry[0], entry[1],
      entry[2] };
    entry += 4;
  }
  return entries;
}

/// The last entry to which a line from the entry `from` is within the tolerances of all entries
/// between. What is transparent, and nothing else, is on lines that are 0.
std::size_t FindEnd(const std::vector<Entry>& entries, std::size_t from)
{
  constexpr double Infinite = std::numeric_limits<double>::infinity();
  const Entry& start = entries[from];
  const bool isTransparent = start[0] <= 0.0 && entries[from + 1][0] <= 0.0;
  // The slopes of lines that are near enough to the entries so far.
  Entry least;
  Entry most;
  least.fill(-Infinite);
  most.fill(Infinite);
  std::size_t end = from + 1;
  for (std::size_t i = from + 1; i < entries.size(); ++i)
  {
    if (isTransparent && entries[i][0] > 0.0)
    {
      return end;
    }
    const double steps = static_cast<double>(i - from);
    bool isEnd = true;
    for (std::size_t c = 0; c < entries[i].size(); ++c)
    {
      const double slope = (entries[i][c] - start[c]) / steps;
      const double tolerance = ToleranceOf(entries[i], c) / steps;
      isEnd = isEnd && slope >= least[c] && slope <= most[c];
      least[c] = std::max(least[c], slope - tolerance);
      most[c] = std::min(most[c], slope + tolerance);
      if (least[c] > most[c])
      {
        return end;
      }
    }
    end = isEnd ? i : end;
    if (!isTransparent && entries[i][0] <= 0.0)
    {
      return end;
    }
  }
  return end;
}

/// The opacity at the transparent end of a line that is 0 up to TransferTable::GetMargin() from
/// there. `other`: the opacity at its other end, `steps` entries away.
double FindTransparentEnd(const TransferTable& table, double other, double steps)
{
  const double margin = static_cast<double>(table.GetMargin());
  return -margin / (steps - margin) * other;
}

} // namespace

//------------------------------------------------------------------------------
PiecewiseOptics FindPiecewiseOptics(const TransferTable& table, double low, double scale)
{
  const std::vector<Entry> entries = FindEntries(table);
  const auto valueAt = [&](std::size_t i) {
    return static_cast<float>(low + static_cast<double>(i) / scale);
  };
  PiecewiseOptics optics;
  optics.End = valueAt(entries.size() - 1);
  if (!std::isfinite(optics.End - valueAt(0)))
  {
    return {};
  }
  for (std::size_t from = 0; from + 1 < entries.size();)
  {
    const std::size_t to = FindEnd(entries, from);
    const double steps = static_cast<double>(to - from);
    Entry begin = entries[from];
    Entry end = entries[to];
    if (optics.Pieces == PiecewiseOptics::LargestNumberOfPieces ||
      (to - from < FewEntries && std::abs(end[0] - begin[0]) > LargestJump))
    {
      return {};
    }
    if (begin[0] <= 0.0)
    {
      begin[0] = FindTransparentEnd(table, end[0], steps);
    }
    else if (end[0] <= 0.0)
    {
      end[0] = FindTransparentEnd(table, begin[0], steps);
    }
    const auto piece = static_cast<std::size_t>(optics.Pieces);
    optics.Begin[piece] = valueAt(from);
    for (std::size_t c = 0; c < begin.size(); ++c)
    {
      optics.Channels[c].Begin[piece] = static_cast<float>(begin[c]);
      optics.Channels[c].Slope[piece] = static_cast<float>((end[c] - begin[c]) / steps * scale);
      if (!std::isfinite(optics.Channels[c].Slope[piece]))
      {
        return {};
      }
    }
    ++optics.Pieces;
    from = to;
  }
  return optics;
}

} // namespace ffd
