// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Makers of the stages that vtkFFDFrameCache keeps between frames, in the order of their making,
 * after the scalars (MakeVectorScalars(), MakeVoxels()) and the field (MakeDeformationField()). The
 * parameters of a maker are all that its result depends on. Private to this module: not installed,
 * not wrapped.
 */
#ifndef vtkFFDFrameStages_h
#define vtkFFDFrameStages_h

#include "vtkFFDDeformationSource.h"
#include "vtkFFDOpticsFromProperty.h"
#include "vtkFFDVoxels.h"

#include "Bounds/FFDPullBackBounds.h"
#include "FFDBSplineField.h"
#include "FFDCropping.h"
#include "FFDDistanceMap.h"
#include "FFDFieldCache.h"
#include "FFDFunctionCache.h"
#include "FFDMinMaxBlocks.h"
#include "FFDPullBack.h"
#include "FFDStage.h"
#include "FFDValuePeaks.h"
#include "FFDVisibleSpace.h"
#include "Optics/FFDBlending.h"
#include "Optics/FFDLabelBlocks.h"
#include "Optics/FFDOpticalFunctions.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

class vtkDataArray;
class vtkVolumeProperty;

namespace ffd
{

/// The pull-back by a field of its own, and the bounds that follow from it.
struct BoundedPullBack
{
  BSplineField Field;
  PullBack Map;
  Box RestBounds;
  PullBackBounds Bounds;
  PullBackLimits Limits; ///< of Bounds
  Box DeformedBounds;    ///< of RestBounds
  /// Of Field; frames add what they need.
  std::unique_ptr<FieldCache> KeptOfField = std::make_unique<FieldCache>();
};

/// A pull-back that the mappers of the same deformation and volume share, as those of several views
/// and those that are only asked for bounds: what it depends on is compared by value.
struct SharedPullBack
{
  std::shared_ptr<const BoundedPullBack> Last;
  std::int64_t NumberOfBuilds = 0; ///< those that no other mapper had made

  std::size_t GetMemorySize() const;
};

/// `restBounds`: those of the whole volume, data coordinates; `tolerance` of the inverse, data
/// units.
Made MakeBoundedPullBack(SharedPullBack& result, StageTools& tools,
  const Product<DeformationField>& field, const std::array<double, 6>& restBounds, InverseMode mode,
  double tolerance);

/// Limits of the scalars of components, in blocks.
struct ComponentBlocks
{
  std::vector<MinMaxBlocks> Blocks;
  std::vector<int> Components; ///< which these are
  bool OfBytes = false;        ///< whether a scalar is a byte
  /// For each block, x fastest, whether all its cells are hidden; none: no cell is.
  std::vector<std::uint8_t> Hidden;

  std::size_t GetMemorySize() const;
};

/// `components`: those that the opacity depends on.
Made MakeComponentBlocks(ComponentBlocks& result, StageTools& tools, const Product<Voxels>& voxels,
  const std::vector<int>& components);

/// Limits of a binary mask, in blocks.
struct MaskBlocks
{
  std::optional<MinMaxBlocks> Blocks; ///< none without a mask

  std::size_t GetMemorySize() const { return this->Blocks ? this->Blocks->GetMemorySize() : 0; }
};

/// `view`: of a mask on the grid of the volume, else empty; `scalars`: those of the mask.
Made MakeMaskBlocks(MaskBlocks& result, StageTools& tools, const UniformView& view,
  const Source<vtkDataArray>& scalars);

/// `view`: of a mask, or empty; `scalars`: those of the mask.
Made MakeLabelBlocks(LabelBlocks& result, StageTools& tools, const UniformView& view,
  bool isLabelMap, const Source<vtkDataArray>& scalars);

/// Options of the mapper that scalars are looked up by.
struct LookupOptions
{
  ComponentKind Kind = ComponentKind::Independent;
  std::array<double, 2> WholeRange{ { 1.0, -1.0 } }; ///< vtkFFD...Mapper::WholeScalarRange
  std::array<bool, 3> Native{};                      ///< ranges of colors, opacities, gradients
  bool HasLabels = false;

  bool operator==(const LookupOptions& other) const
  {
    return this->Kind == other.Kind && this->WholeRange == other.WholeRange &&
      this->Native == other.Native && this->HasLabels == other.HasLabels;
  }
};

/// Range of the scalars of the whole volume, from that of the part that is rendered here.
MinMaxBlocks::Limits FindRangeOfWhole(
  const MinMaxBlocks::Limits& range, int components, const std::array<double, 2>& wholeRange);

/// Tables of the transfer functions.
struct TransferFunctions
{
  ScalarFacts Facts; ///< that they were made for
  OpticalFunctions Optics;
  std::uint64_t Visibility = 0; ///< another number when other scalars are transparent
  /// Of Optics; frames add what they need.
  std::unique_ptr<FunctionCache> KeptOfThem;

  std::size_t GetMemorySize() const;
};

/// A property with its time; that of the functions of labels counts, too. VTK makes the functions
/// of `components` that are missing, which changes the property, when it is first asked for them.
Source<vtkVolumeProperty> FindSource(vtkVolumeProperty* property, int components = 1);

/// `secondAxis`: of two-dimensional functions, null for the gradient.
Made MakeTransferFunctions(TransferFunctions& result, StageTools& tools,
  const Product<Voxels>& voxels, const Product<ComponentBlocks>& blocks,
  const Source<vtkVolumeProperty>& property, const LookupOptions& options,
  const Source<vtkDataArray>& secondAxis);

/// A blend mode; the same for a distance map if they leap over the same blocks.
struct LeapBlending
{
  Blending Blend;

  bool operator==(const LeapBlending& other) const;
};

/// The blocks in which nothing is visible.
struct EmptySpace
{
  DistanceMap Distances;
  /// Of the channels, where largest or smallest values are looked for; else empty.
  std::vector<ValuePeaks> Peaks;
  bool CanLeap = true; ///< false: every sample counts, and there are no distances
  /// What frames keep beside the distances; null beside those of a small volume.
  std::unique_ptr<SpaceCache> KeptOfThem;

  std::size_t GetMemorySize() const;
};

/// `crop`: of the volume at rest; that of what has been deformed hides no block.
Made MakeEmptySpace(EmptySpace& result, StageTools& tools, const Product<ComponentBlocks>& blocks,
  const Product<MaskBlocks>& mask, const Product<TransferFunctions>& functions,
  const LeapBlending& blending, const Cropping& crop);

} // namespace ffd

#endif
