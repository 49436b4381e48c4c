// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFrameCoherence
 * @brief   what of the picture of the last frame can be shown again after an edit of the
 * deformation
 *
 * Private to this module: not installed, not wrapped. Knows what the last picture was made from, so
 * that it can tell whether nothing but the control points has changed since, and keeps the history
 * of its tiles.
 */
#ifndef vtkFFDFrameCoherence_h
#define vtkFFDFrameCoherence_h

#include "vtkFFDImageRegion.h"

#include "FFDBSplineField.h"
#include "FFDCastScene.h"
#include "FFDStage.h"
#include "FFDTileHistory.h"

#include "vtkType.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

class vtkVolumeProperty;

class vtkFFDFrameCoherence
{
public:
  vtkFFDFrameCoherence();

  /// All that a picture is made from but the control points, the camera, light and blending of the
  /// scene and the image region: of which times and values only tell whether they are the same.
  struct Sources
  {
    vtkMTimeType Settings = 0; ///< of the mapper
    std::uint64_t Voxels = 0;  ///< version of them
    std::uint64_t Functions = 0;
    ffd::Source<vtkVolumeProperty> Property;
    glm::dmat4 DataToWorld{ 1.0 };
    bool Interactive = false;

    bool operator==(const Sources& other) const
    {
      return this->Settings == other.Settings && this->Voxels == other.Voxels &&
        this->Functions == other.Functions && this->Property == other.Property &&
        this->DataToWorld == other.DataToWorld && this->Interactive == other.Interactive;
    }
  };

  /// A tile of the caster, and which quarters of it.
  struct Part
  {
    int Tile;
    unsigned int Quarters;
    int First = 0; ///< where to go on, see RayCaster::RenderTile()
  };

  /// The next picture has nothing to do with the last.
  void Clear();

  /// Enlarge a region so that tiles of the next picture lie on those of the last.
  void Align(vtkFFDImageRegion& region) const;

  /**
   * Begin a picture. `colours`, 4 floats a ray, are those of the last one, and get the size of this
   * one; so do `firstVisible`, the window depths of the first visible samples, unless they are
   * empty. `restBounds` those of the volume, `tolerance` in pixels. Returns what must be cast.
   */
  std::vector<Part> Begin(const Sources& sources, const ffd::CastScene& scene,
    const vtkFFDImageRegion& region, const ffd::Box& restBounds, double tolerance,
    std::vector<float>& colours, std::vector<float>& firstVisible);

  /// For the caster, see CastImage::Reaches.
  float* GetReaches() { return this->Quarters.GetReaches(); }

  std::size_t GetMemorySize() const;

private:
  bool Continues(const Sources& sources, const ffd::CastScene& scene,
    const vtkFFDImageRegion& region, glm::ivec2& shift) const;

  std::vector<Part> TakePartsToCast(const glm::ivec2& rays);

  ffd::TileHistory Quarters; // of tiles

  // Of the last picture.
  Sources LastSources;
  vtkFFDImageRegion LastRegion;
  ffd::CameraView LastCamera;
  ffd::Shading LastMaterial;
  ffd::Blending LastBlend;
  ffd::Box LastDeformedBounds;
  std::unique_ptr<ffd::BSplineField> LastField;
  ffd::PullBackKind LastKind = ffd::PullBackKind::Exact;
  bool LastWasOneToOne = false;
  std::vector<float> LastDepths; // empty: nothing was drawn
};

#endif
