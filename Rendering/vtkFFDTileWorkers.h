// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed, not wrapped.
#ifndef vtkFFDTileWorkers_h
#define vtkFFDTileWorkers_h

#include "vtkFFDParallelFor.h"

#include "FFDCastScene.h"
#include "FFDRayCaster.h"
#include "FFDVisibleRectangle.h"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

/// What a thread keeps between tiles; aligned so that no two share a line of the cache.
struct alignas(128) vtkFFDTileWorker
{
  ffd::RayCaster::Scratch Scratch;
  ffd::VisibleRectangle Visible; ///< of its tiles
  /// Of a tile of a picture of bytes, before they are rounded.
  std::array<float, std::size_t{ 4 } * ffd::RayCaster::TileSize * ffd::RayCaster::TileSize> Colors;
};

/// Those of a frame. Each thread makes its own, all at the same time.
class vtkFFDTileWorkers
{
public:
  explicit vtkFFDTileWorkers(const vtkFFDParallelFor& parallelFor)
    : All(static_cast<std::size_t>(parallelFor.GetNumberOfWorkers()))
  {
  }

  std::size_t GetSize() const { return this->All.size(); }

  vtkFFDTileWorker& Get(int number)
  {
    std::unique_ptr<vtkFFDTileWorker>& worker = this->All[static_cast<std::size_t>(number)];
    if (!worker)
    {
      worker.reset(new vtkFFDTileWorker); // std::make_unique() would fill its 100 kB with zeros
    }
    return *worker;
  }

  /// What is visible of the tiles of all.
  ffd::VisibleRectangle FindVisible() const
  {
    ffd::VisibleRectangle all;
    for (const std::unique_ptr<vtkFFDTileWorker>& worker : this->All)
    {
      if (worker)
      {
        all.Add(worker->Visible);
      }
    }
    return all;
  }

  ffd::CastStatistics GetStatistics() const
  {
    ffd::CastStatistics total;
    for (const std::unique_ptr<vtkFFDTileWorker>& worker : this->All)
    {
      if (worker)
      {
        total.Add(ffd::RayCaster::GetStatistics(worker->Scratch));
      }
    }
    return total;
  }

private:
  std::vector<std::unique_ptr<vtkFFDTileWorker>> All;
};

#endif
