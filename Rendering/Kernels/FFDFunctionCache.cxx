// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFunctionCache.h"

#include <algorithm>

namespace ffd
{
namespace
{

constexpr std::size_t LargestNumberOfContents = 2;

} // namespace

//------------------------------------------------------------------------------
std::shared_ptr<const PacketTable::Contents> FunctionCache::FindContents(const PacketTable& table)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  const auto known = std::find_if(this->Last.begin(), this->Last.end(), [&](const Kept& kept) {
    return kept.Sources == table.GetSources() && kept.HasOpacities == table.GetHasOpacities();
  });
  if (known != this->Last.end())
  {
    std::rotate(known, known + 1, this->Last.end());
    return this->Last.back().Contents;
  }
  if (this->Last.size() == LargestNumberOfContents)
  {
    this->Last.erase(this->Last.begin());
  }
  this->Last.push_back({ table.GetSources(), table.GetHasOpacities(), table.MakeContents() });
  return this->Last.back().Contents;
}

//------------------------------------------------------------------------------
std::size_t FunctionCache::GetMemorySize() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  std::size_t size = 0;
  for (const Kept& kept : this->Last)
  {
    size += (kept.Contents->Pieces.capacity() + kept.Contents->UnitPieces.capacity()) *
        sizeof(PiecewiseOptics) +
      kept.Contents->Intervals.capacity() * sizeof(TransferInterval) +
      kept.Contents->Opacities.capacity() * sizeof(PacketTable::OpacityPair);
  }
  return size;
}

} // namespace ffd
