// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDPiecewiseOptics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <vector>

namespace ffd
{
namespace
{

/// The channels of PiecewiseOptics.
using Entry = std::array<double, PiecewiseOptics::NumberOfChannels>;

double ToleranceOf(const PieceTolerance& tolerance, const Entry& entry, std::size_t channel)
{
  if (channel > 0)
  {
    return tolerance.Color;
  }
  // Where rays end, they are to end.
  return entry[0] < 1.0 ? tolerance.Relative * entry[0] + tolerance.Least : 0.0;
}

/// Whether opacities change so much within so few entries that the table, whose extinctions are
/// linear between entries, interpolates them otherwise. Those of opaque entries are a number that
/// stands for any: lines are nearer to the function there.
bool IsStep(double from, double to, std::size_t entries)
{
  constexpr double LargestJump = 0.05;
  constexpr std::size_t FewEntries = 4;
  return entries < FewEntries && std::abs(to - from) > LargestJump &&
    (std::max(from, to) < 1.0 || std::min(from, to) < 0.5);
}

std::vector<Entry> FindEntries(const TransferTable& table, double length)
{
  std::vector<Entry> entries(table.GetSize());
  const float* entry = table.GetEntries();
  for (Entry& to : entries)
  {
    to = { OpacityOver(static_cast<double>(entry[3]), length), entry[0], entry[1], entry[2] };
    entry += 4;
  }
  return entries;
}

/// A line from an entry on.
struct Line
{
  std::size_t End; ///< the last entry
  Entry Slope;     ///< the change from one entry to the next
};

/// The longest line from the entry `from` on that is within the tolerances of all entries up to its
/// end. What is transparent, and nothing else, is on lines that are 0; none is above 1.
Line FindLine(const std::vector<Entry>& entries, std::size_t from, const PieceTolerance& nearness)
{
  constexpr double Infinite = std::numeric_limits<double>::infinity();
  const Entry& start = entries[from];
  const bool isTransparent = start[0] <= 0.0 && entries[from + 1][0] <= 0.0;
  // The slopes of lines that are near enough to the entries so far.
  Entry least;
  Entry most;
  least.fill(-Infinite);
  most.fill(Infinite);
  Line line{ from, {} };
  for (std::size_t i = from + 1; i < entries.size(); ++i)
  {
    if (isTransparent && entries[i][0] > 0.0)
    {
      break;
    }
    const double steps = static_cast<double>(i - from);
    bool isNear = true;
    for (std::size_t c = 0; c < start.size(); ++c)
    {
      const double slope = (entries[i][c] - start[c]) / steps;
      const double tolerance = ToleranceOf(nearness, entries[i], c) / steps;
      least[c] = std::max(least[c], slope - tolerance);
      most[c] = std::min(most[c], slope + tolerance);
      isNear = isNear && least[c] <= most[c];
    }
    const double toOpaque = (1.0 - start[0]) / steps;
    if (!isNear || least[0] > toOpaque)
    {
      break;
    }
    line.End = i;
    for (std::size_t c = 0; c < start.size(); ++c)
    {
      line.Slope[c] = 0.5 * (least[c] + most[c]);
    }
    // What is constant is to have no slope, although an entry that is as near as the tolerance
    // comes first.
    const bool isLevel = least[0] <= 0.0 && most[0] >= 0.0 && start[0] > 0.0 && entries[i][0] > 0.0;
    line.Slope[0] = isLevel ? 0.0 : std::min(line.Slope[0], toOpaque);
    if (!isTransparent && entries[i][0] <= 0.0)
    {
      break;
    }
  }
  return line;
}

/// The opacity at the transparent end of a line that is 0 up to `margin` from there. `other`: the
/// opacity at its other end, `steps` entries away.
double FindTransparentEnd(double margin, double other, double steps)
{
  return -margin / (steps - margin) * other;
}

/// As FindPiecewiseOptics(), of the entries of a table with TransferTable::GetMargin().
PiecewiseOptics FindPieces(const std::vector<Entry>& entries, double margin, double low,
  double scale, double length, const PieceTolerance& tolerance)
{
  const auto valueAt = [&](std::size_t i) {
    return static_cast<float>(low + static_cast<double>(i) / scale);
  };
  PiecewiseOptics none;
  none.Length = static_cast<float>(length);
  PiecewiseOptics optics = none;
  std::fill(
    std::begin(optics.Begin), std::end(optics.Begin), std::numeric_limits<float>::infinity());
  optics.End = valueAt(entries.size() - 1);
  if (!std::isfinite(optics.End - valueAt(0)))
  {
    return none;
  }
  for (std::size_t from = 0; from + 1 < entries.size();)
  {
    Line line = FindLine(entries, from, tolerance);
    const double steps = static_cast<double>(line.End - from);
    Entry begin = entries[from];
    const double end = entries[line.End][0];
    if (optics.Pieces == PiecewiseOptics::LargestNumberOfPieces ||
      IsStep(begin[0], end, line.End - from))
    {
      return none;
    }
    if (begin[0] <= 0.0)
    {
      begin[0] = FindTransparentEnd(margin, begin[0] + steps * line.Slope[0], steps);
      line.Slope[0] -= begin[0] / steps;
    }
    else if (end <= 0.0)
    {
      line.Slope[0] = (FindTransparentEnd(margin, begin[0], steps) - begin[0]) / steps;
    }
    const auto piece = static_cast<std::size_t>(optics.Pieces);
    optics.Begin[piece] = valueAt(from);
    for (std::size_t c = 0; c < begin.size(); ++c)
    {
      optics.Channels[c].Begin[piece] = static_cast<float>(begin[c]);
      optics.Channels[c].Slope[piece] = static_cast<float>(line.Slope[c] * scale);
      if (!std::isfinite(optics.Channels[c].Slope[piece]))
      {
        return none;
      }
    }
    ++optics.Pieces;
    from = line.End;
  }
  return optics;
}

} // namespace

//------------------------------------------------------------------------------
PiecewiseOptics FindPiecewiseOptics(const TransferTable& table, double low, double scale,
  double length, const PieceTolerance& tolerance)
{
  return FindPieces(FindEntries(table, length), static_cast<double>(table.GetMargin()), low, scale,
    length, tolerance);
}

//------------------------------------------------------------------------------
PiecewiseOptics FindPiecewiseFactors(const std::vector<float>& factors)
{
  std::vector<Entry> entries;
  for (const float factor : factors)
  {
    entries.push_back({ static_cast<double>(factor), 0.0, 0.0, 0.0 });
  }
  return FindPieces(entries, 0.0, 0.0, 1.0, 1.0, {});
}

} // namespace ffd
