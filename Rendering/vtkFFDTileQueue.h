// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDTileQueue
 * @brief   hands out the tiles of a picture to workers
 *
 * Private to this module: not installed, not wrapped. Tiles are cast in rounds: between two of them
 * no worker is at work, and the progress can be told. The caster and the image must outlive it.
 */
#ifndef vtkFFDTileQueue_h
#define vtkFFDTileQueue_h

#include "vtkFFDFrameCoherence.h"

#include <atomic>
#include <cstddef>
#include <mutex>
#include <vector>

namespace ffd
{
class RayCaster;
struct CastImage;
}

class vtkFFDTileQueue
{
public:
  using Tile = vtkFFDFrameCoherence::Part;

  /// Some of the tiles, from the first to one past the last.
  struct Share
  {
    std::size_t First;
    std::size_t End;
    bool IsEmpty() const { return this->First == this->End; }
  };

  /// `workers`: how many take tiles at the same time. `wholeGroups`: the tiles of a group are never
  /// divided between workers, so that what is counted does not depend on these.
  vtkFFDTileQueue(std::vector<Tile> tiles, const ffd::RayCaster& caster,
    const ffd::CastImage& image, std::size_t workers, bool wholeGroups);

  std::size_t GetSize() const { return this->Tiles.size(); }
  bool IsEmpty() const { return this->Next >= this->Tiles.size(); }
  /// Part of the tiles, 0 to 1, that are finished; between rounds.
  double GetFinishedPart() const;

  /// Begin a round that hands out `most` tiles.
  void BeginRound(std::size_t most);

  /// The next tiles of the round, of one group; none at its end. For each worker at any time.
  Share Take();
  const Tile& Get(std::size_t at) const { return this->Tiles[at]; }

  /// A tile that was taken is to be handed out again in the next round. For each worker at any
  /// time.
  void PutBack(const Tile& tile);

  /// After all workers have ended.
  void EndRound();

private:
  int FindGroup(const Tile& tile) const;
  void SortByGroup();

  std::vector<Tile> Tiles; // tiles of a group together
  const ffd::RayCaster& Caster;
  const ffd::CastImage& Image;
  std::size_t Shares; // in which the last tiles are handed out
  bool WholeGroups;
  std::size_t End = 0; // of the round
  std::atomic<std::size_t> Next{ 0 };
  std::mutex Mutex;
  std::vector<Tile> Returned;
};

#endif
