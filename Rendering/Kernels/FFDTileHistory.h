// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTileHistory_h
#define FFDTileHistory_h

#include "FFDCameraView.h"
#include "FFDExport.h"
#include "FFDPullBackChange.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <vector>

namespace ffd
{

/**
 * Records which tiles of the last picture still hold after an edit of the deformation:
 * frame-to-frame coherence. A tile holds as long as nothing that its rays reach has moved by more
 * than a tolerance since they were cast, edit by edit added up, and no ray of it ends before
 * anything else that has been drawn than it did.
 *
 * A picture here is tiles of `tileSize` x `tileSize` pixels from its lower left corner on. The
 * pictures of one history are seen by the same camera, and pixels of one are pixels of the next,
 * moved by whole tiles.
 */
class FFD_RENDERING_EXPORT TileHistory
{
public:
  explicit TileHistory(int tileSize)
    : TileSize(tileSize)
  {
  }

  /// Forget all pictures.
  void Clear();

  bool IsEmpty() const { return this->Tiles.empty(); }

  /// Size in pixels of the last picture.
  const glm::ivec2& GetSize() const { return this->Size; }

  /// A first picture, or one that has nothing to do with the last: no tile holds.
  void Start(const glm::ivec2& size);

  /**
   * The next picture, its pixels counted from tile `shift` of the last one. The colors (4 floats a
   * pixel, rows bottom up) and window depths (one a pixel, or empty where nothing was drawn) of the
   * last picture, and its first visible depths, the same, if not null or empty, are rearranged to
   * the new size; what was not in it is undefined, and its tiles do not hold.
   */
  void Continue(const glm::ivec2& size, const glm::ivec2& shift, std::vector<float>& colors,
    std::vector<float>& depths, std::vector<float>* firstVisible = nullptr);

  /// Note an edit. Tiles where something within reach has moved by more than `tolerance` pixels do
  /// not hold any more.
  void RecordChange(const PullBackChange& change, const CameraView& camera, double tolerance);

  /// Note what rays may not go beyond: window depths (one a pixel), now and in the last picture, as
  /// rearranged by Continue(). Either may be null: nothing was drawn.
  void RecordDepths(const float* before, const float* now, const CameraView& camera);

  /// The tiles that do not hold; they count as cast from now on.
  std::vector<int> CollectTilesToCast();

  /// For the caster: how far along their rays the tiles look, see CastImage::Reaches.
  float* GetReaches() { return this->Reaches.data(); }

  std::size_t GetMemorySize() const
  {
    return this->Tiles.capacity() * sizeof(Tile) + this->Reaches.capacity() * sizeof(float);
  }

private:
  struct Tile
  {
    bool Holds = false;
    float Moved = 0.0f;    ///< since it was cast, pixels
    float MovedNow = 0.0f; ///< by the edit that is being noted
  };

  glm::ivec2 FindTiles(const glm::ivec2& size) const
  {
    return (size + this->TileSize - 1) / this->TileSize;
  }
  class Projection;
  void RecordPart(const Projection& parts, std::size_t part, double moved);

  int TileSize;
  glm::ivec2 Size{ 0 };
  glm::ivec2 Count{ 0 };
  std::vector<Tile> Tiles;    // x fastest
  std::vector<float> Reaches; // of each tile
};

} // namespace ffd

#endif
