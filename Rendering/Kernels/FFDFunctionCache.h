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
 * as long as a small picture. The functions are always the same ones. Threads may share a cache.
 */
class FFD_RENDERING_EXPORT FunctionCache
{
public:
  /// PacketTable::MakeContents(), for the last two kinds of tables: those of still pictures and of
  /// pictures while something moves.
  std::shared_ptr<const PacketTable::Contents> FindContents(const PacketTable& table);

  std::size_t GetMemorySize() const;

private:
  struct Kept
  {
    std::vector<PacketTable::Source> Sources;
    bool HasOpacities;
    std::shared_ptr<const PacketTable::Contents> Contents;
  };

  mutable std::mutex Mutex;
  std::vector<Kept> Last; // the last one was asked for last
};

} // namespace ffd

#endif
