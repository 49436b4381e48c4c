// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFrameCoherence
 * @brief   what of the picture of the last frame can be shown again: after an edit of the
 * deformation while the scene moves, after a change of what else is drawn in a still one
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

namespace ffd
{

/// The camera and the resolution of a picture.
struct FixedView
{
  glm::dmat4 DataToNdc{ 1.0 };
  glm::dvec3 Eye{ 0.0 };
  bool Parallel = false;
  glm::ivec2 Viewport{ 0 };
  double Step = 1.0; ///< pixels between rays

  bool operator==(const FixedView& other) const;
};

/// The lights of a picture.
struct FixedLight
{
  std::vector<Light> Lights;
  bool TwoSided = false;

  bool operator==(const FixedLight& other) const;
};

/// The part of blending that neither the settings nor the property tell.
struct FixedBlend
{
  BlendMode Mode = BlendMode::Composite;
  std::vector<IsoValue> IsoValues;

  bool operator==(const FixedBlend& other) const;
};

/// Stands for everything that a picture is made from except the control points and the place of its
/// region: pictures of the same scene differ only where an edit shows.
struct FixedScene
{
};

/// The inputs are compared only. The settings of the mapper are given by their time, voxels and
/// functions by their versions.
Made MakeFixedScene(FixedScene& scene, StageTools& tools, std::uint64_t settings,
  std::uint64_t voxels, std::uint64_t functions, const Source<vtkVolumeProperty>& property,
  const glm::dmat4& dataToWorld, bool interactive, bool still, const FixedView& view,
  const FixedLight& light, const FixedBlend& blend);

} // namespace ffd

class vtkFFDFrameCoherence
{
public:
  vtkFFDFrameCoherence();

  /// Inputs of ffd::MakeFixedScene() that the scene to cast does not tell.
  struct Sources
  {
    vtkMTimeType Settings = 0; ///< of the mapper
    std::uint64_t Voxels = 0;  ///< version of them
    std::uint64_t Functions = 0;
    ffd::Source<vtkVolumeProperty> Property;
    glm::dmat4 DataToWorld{ 1.0 };
    bool Interactive = false;
    bool Still = false; ///< to be the same as a picture that is cast anew, bit by bit
  };

  /// A tile of the caster, and which subtiles of it.
  struct Part
  {
    int Tile = 0;
    unsigned int Subtiles = 0;
    int First = 0; ///< where to go on, see RayCaster::RenderTile()
  };

  /// The next picture has nothing to do with the last.
  void Clear();

  /// Enlarge a region so that tiles of the next picture lie on those of the last.
  void Align(vtkFFDImageRegion& region) const;

  /**
   * Begin a picture. `colors`, 4 floats a ray, are those of the last one, and get the size of this
   * one; so do `firstVisible`, the window depths of the first visible samples, unless they are
   * empty. `restBounds` those of the volume, `tolerance` in pixels. Returns what must be cast.
   */
  std::vector<Part> Begin(const Sources& sources, const ffd::CastScene& scene,
    const vtkFFDImageRegion& region, const ffd::Box& restBounds, double tolerance,
    std::vector<float>& colors, std::vector<float>& firstVisible);

  /// For the caster, see CastImage::Reaches.
  float* GetReaches() { return this->Subtiles.GetReaches(); }

  std::size_t GetMemorySize() const;

private:
  bool IsSameScene(
    const Sources& sources, const ffd::CastScene& scene, const vtkFFDImageRegion& region);
  bool FindShift(const vtkFFDImageRegion& region, glm::ivec2& shift) const;
  bool FollowEdit(const ffd::CastScene& scene, const vtkFFDImageRegion& region,
    const ffd::Box& restBounds, double tolerance, std::vector<float>& colors,
    std::vector<float>& firstVisible);
  bool FollowStill(const ffd::CastScene& scene, const vtkFFDImageRegion& region);

  std::vector<Part> CollectPartsToCast(const glm::ivec2& rays);

  ffd::TileHistory Subtiles; // of tiles

  ffd::StageOrder Order;
  ffd::Stage<&ffd::MakeFixedScene> Scene{ Order }; // of the last picture, as the following
  vtkFFDImageRegion LastRegion;
  ffd::Box LastDeformedBounds;
  std::unique_ptr<ffd::BSplineField> LastField;
  ffd::PullBackKind LastKind = ffd::PullBackKind::Exact;
  bool LastWasOneToOne = false;
  std::vector<float> LastDepths; // empty: nothing was drawn
};

#endif
