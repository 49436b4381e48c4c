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
 * Finds the tiles of the last picture that still hold after an edit of the deformation:
 * frame-to-frame coherence. A tile holds as long as nothing that its rays reach has moved by more
 * than a tolerance since they were cast, summed over all edits, and as long as each of its rays
 * ends at the same drawn surface as before.
 *
 * A picture consists of tiles of `tileSize` x `tileSize` pixels from its lower left corner on. The
 * pictures of one history have the same camera, and their pixels differ by a shift of whole tiles.
 */
class FFD_RENDERING_EXPORT TileHistory
{
public:
  explicit TileHistory(int tileSize)
    : TileSize(tileSize)
  {
  }

  /// Forgets all pictures.
  void Clear();

  bool IsEmpty() const { return this->Tiles.empty(); }

  /// Size in pixels of the last picture.
  const glm::ivec2& GetSize() const { return this->Size; }

  /// Begins with a picture that has nothing to do with the last one: no tile holds.
  void Start(const glm::ivec2& size);

  /**
   * Goes on with the next picture, whose pixels count from tile `shift` of the last one. Rearranges
   * to the new size the colors (4 floats a pixel, rows bottom up) and the window depths (one a
   * pixel, or empty if nothing was drawn) of the last picture, and its first visible depths if not
   * null or empty. Pixels that the last picture did not have are undefined, and their tiles do not
   * hold.
   */
  void Continue(const glm::ivec2& size, const glm::ivec2& shift, std::vector<float>& colors,
    std::vector<float>& depths, std::vector<float>* firstVisible = nullptr);

  /// Records an edit: tiles in which something within reach has moved by more than `tolerance`
  /// pixels do not hold any more.
  void RecordChange(const PullBackChange& change, const CameraView& camera, double tolerance);

  /// Records the surfaces at which rays end: window depths (one a pixel), now and in the last
  /// picture, as rearranged by Continue(). Null: nothing was drawn.
  void RecordDepths(const float* before, const float* now, const CameraView& camera);

  /// As RecordDepths(), for a picture that is to be the same bit by bit: where a surface has come
  /// or gone, or moved at all, no tile of its group holds, of `groupSize` x `groupSize` tiles.
  void RecordOtherDepths(const float* before, const float* now, int groupSize);

  /// Returns the tiles that do not hold; they count as cast from now on.
  std::vector<int> CollectTilesToCast();

  /// CastImage::Reaches of the tiles, which the caster writes.
  float* GetReaches() { return this->Reaches.data(); }

  std::size_t GetMemorySize() const
  {
    return this->Tiles.capacity() * sizeof(Tile) + this->Reaches.capacity() * sizeof(float);
  }

private:
  struct Tile
  {
    bool Holds = false;
    float Moved = 0.0f;    ///< largest motion since it was cast, pixels
    float MovedNow = 0.0f; ///< largest motion by the edit that is being recorded
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
