// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDFunctionCache_h
#define FFDFunctionCache_h

#include "FFDExport.h"
#include "Packets/FFDPacketTable.h"

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace ffd
{

/**
 * What frames need of transfer functions that do not change, found on first use: large tables take
 * as long as a small picture. Nothing is kept of small ones, which take little time, and memory
 * that counts beside a small volume. The functions are always the same ones. Threads may share a
 * cache.
 */
class FFD_RENDERING_EXPORT FunctionCache
{
public:
  /// Intervals of all tables together, of which nothing is kept.
  static constexpr std::size_t FewIntervals = 4000;

  /// PacketTable::MakeContents(), kept for the last kind of tables.
  std::shared_ptr<const PacketTable::Contents> FindContents(const PacketTable& table);

  std::size_t GetMemorySize() const;

private:
  mutable std::mutex Mutex;
  std::vector<PacketTable::Source> Sources; // of what is kept
  bool HasOpacities = false;
  std::shared_ptr<const PacketTable::Contents> Contents;
};

} // namespace ffd

#endif
