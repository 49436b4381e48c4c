// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFunctionCache.h"

namespace ffd
{

//------------------------------------------------------------------------------
std::shared_ptr<const PacketTable::Contents> FunctionCache::FindContents(const PacketTable& table)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  const bool known = this->Contents && this->Sources == table.GetSources() &&
    this->HasOpacities == table.GetHasOpacities();
  if (known)
  {
    return this->Contents;
  }
  auto made = table.MakeContents();
  if (made->Intervals.size() > FewIntervals)
  {
    this->Sources = table.GetSources();
    this->HasOpacities = table.GetHasOpacities();
    this->Contents = made;
  }
  return made;
}

//------------------------------------------------------------------------------
std::size_t FunctionCache::GetMemorySize() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->Contents ? this->Contents->GetMemorySize() : 0;
}

} // namespace ffd
