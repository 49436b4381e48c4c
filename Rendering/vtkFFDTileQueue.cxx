// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTileQueue.h"

#include "FFDCastScene.h"
#include "FFDRayCaster.h"

#include <algorithm>
#include <numeric>
#include <utility>

//------------------------------------------------------------------------------
vtkFFDTileQueue::vtkFFDTileQueue(std::vector<Tile> tiles, const ffd::RayCaster& caster,
  const ffd::CastImage& image, std::size_t workers, bool wholeGroups)
  : Tiles(std::move(tiles))
  , Caster(caster)
  , Image(image)
  , Shares(2 * workers)
  , WholeGroups(wholeGroups)
{
  this->SortByGroup();
}

//------------------------------------------------------------------------------
int vtkFFDTileQueue::FindGroup(const Tile& tile) const
{
  return this->Caster.GetGroup(tile.Tile, this->Image);
}

//------------------------------------------------------------------------------
/// Groups are few: by counting, in one pass.
void vtkFFDTileQueue::SortByGroup()
{
  std::vector<std::size_t> places; // where the tiles of each group begin
  std::vector<std::size_t> groups;
  groups.reserve(this->Tiles.size());
  for (const Tile& tile : this->Tiles)
  {
    groups.push_back(static_cast<std::size_t>(this->FindGroup(tile)));
    places.resize(std::max(places.size(), groups.back() + 2));
    ++places[groups.back() + 1];
  }
  std::partial_sum(places.begin(), places.end(), places.begin());
  std::vector<Tile> sorted(this->Tiles.size());
  for (std::size_t i = 0; i < this->Tiles.size(); ++i)
  {
    sorted[places[groups[i]]++] = this->Tiles[i];
  }
  this->Tiles.swap(sorted);
}

//------------------------------------------------------------------------------
double vtkFFDTileQueue::GetFinishedPart() const
{
  return this->Tiles.empty()
    ? 1.0
    : static_cast<double>(this->Next) / static_cast<double>(this->Tiles.size());
}

//------------------------------------------------------------------------------
void vtkFFDTileQueue::BeginRound(std::size_t most)
{
  this->End = std::min(this->Tiles.size(), this->Next + most);
}

//------------------------------------------------------------------------------
/// The tiles of a group together; near the end fewer, so that all workers are busy.
vtkFFDTileQueue::Share vtkFFDTileQueue::Take()
{
  const std::size_t size = this->Tiles.size();
  std::size_t first = this->Next;
  std::size_t last = first;
  do
  {
    const std::size_t most =
      this->WholeGroups ? size : std::min(this->End, first + (size - first) / this->Shares);
    last = first < this->End ? first + 1 : first;
    while (last > first && last < most &&
      this->FindGroup(this->Tiles[last]) == this->FindGroup(this->Tiles[first]))
    {
      ++last;
    }
  } while (!this->Next.compare_exchange_weak(first, last));
  return { first, last };
}

//------------------------------------------------------------------------------
void vtkFFDTileQueue::PutBack(const Tile& tile)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Returned.push_back(tile);
}

//------------------------------------------------------------------------------
/// What came back takes the places of the last tiles that were taken.
void vtkFFDTileQueue::EndRound()
{
  std::size_t next = this->Next;
  for (const Tile& tile : this->Returned)
  {
    this->Tiles[--next] = tile;
  }
  this->Returned.clear();
  this->Next = next;
}
