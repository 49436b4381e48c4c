// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBlending.h"

#include <algorithm>
#include <cstddef>

namespace ffd
{
namespace
{

/// Entries of the tables that are made over a range of values.
constexpr int Entries = 4097;

/// Flags of what counts, one an entry.
class Flags
{
public:
  Flags(double low, double high, std::size_t size)
    : Low(low)
    , High(high > low ? high : low + 1.0)
    , Counts(size, 0.0f)
  {
  }

  /// Values of [from, to] count; entries on either side of an end are its neighborhood.
  void Set(double from, double to)
  {
    const double last = static_cast<double>(this->Counts.size() - 1);
    const double scale = last / (this->High - this->Low);
    if (!(from <= to) || to < this->Low || from > this->High)
    {
      return;
    }
    const double first = std::floor(std::max(0.0, (from - this->Low) * scale));
    const double end = std::ceil(std::min(last, (to - this->Low) * scale));
    std::fill(this->Counts.begin() + static_cast<std::ptrdiff_t>(first),
      this->Counts.begin() + static_cast<std::ptrdiff_t>(end) + 1, 1.0f);
  }

  TransferTable MakeTable() const
  {
    const std::vector<float> black(3 * this->Counts.size(), 0.0f);
    return TransferTable(
      this->Low, this->High, this->Counts.size(), black.data(), this->Counts.data(), 1.0);
  }

  std::vector<float>& GetCounts() { return this->Counts; }

private:
  double Low;
  double High;
  std::vector<float> Counts;
};

} // namespace

//------------------------------------------------------------------------------
bool MakeLeapTable(const Blending& blend, const TransferTable& table, TransferTable& leaps)
{
  switch (blend.Mode)
  {
    case BlendMode::Composite:
      leaps = table;
      return true;
    case BlendMode::Maximum:
    case BlendMode::Minimum:
    {
      // A value shows, or may keep another one from being the extreme, from the first one on that
      // shows.
      const std::size_t size = table.GetSize();
      Flags flags(
        table.GetLow(), table.GetLow() + static_cast<double>(size - 1) / table.GetScale(), size);
      const bool maximum = blend.Mode == BlendMode::Maximum;
      bool shows = false;
      for (std::size_t i = 0; i < size; ++i)
      {
        const std::size_t at = maximum ? i : size - 1 - i;
        shows = shows || table.GetEntries()[4 * at + 3] > 0.0f;
        flags.GetCounts()[at] = shows ? 1.0f : 0.0f;
      }
      leaps = flags.MakeTable();
      return true;
    }
    case BlendMode::Average:
    {
      if (!(blend.AverageMin > blend.Low[0]) && !(blend.AverageMax < blend.High[0]))
      {
        return false;
      }
      Flags flags(blend.Low[0], blend.High[0], Entries);
      flags.Set(blend.AverageMin, blend.AverageMax);
      leaps = flags.MakeTable();
      return true;
    }
    case BlendMode::Isosurface:
    {
      const int c = blend.IsoComponent;
      Flags flags(blend.Low[c], blend.High[c], Entries);
      for (const IsoValue& iso : blend.IsoValues)
      {
        if (iso.Opacity > 0.0f)
        {
          flags.Set(iso.Value, iso.Value);
        }
      }
      leaps = flags.MakeTable();
      return true;
    }
    default:
      // Additive: where a ray meets the volume it is black at least. Slice: one sample a ray.
      return false;
  }
}

} // namespace ffd
