// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFrameCache
 * @brief   keeps what a mapper makes from its inputs as long as these stay the same
 *
 * Private to this module: not installed, not wrapped. The stages are declared below in the order in
 * which they are brought up to date; the parameters of their makers say what each depends on. What
 * follows from the options in no time (blending, cropping, masks, planes) is found for each frame.
 */
#ifndef vtkFFDFrameCache_h
#define vtkFFDFrameCache_h

#include "vtkFFDDeformationSource.h"
#include "vtkFFDFrameStages.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDVectorScalars.h"
#include "vtkFFDVoxels.h"

#include "FFDCropping.h"
#include "FFDFunctionCache.h"
#include "FFDStage.h"
#include "Optics/FFDBlending.h"
#include "Optics/FFDSampleClassifier.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSet;
class vtkVolumeProperty;

class vtkFFDFrameCache
{
public:
  using Mapper = vtkFFDInverseRayVolumeMapper;

  vtkFFDFrameCache() = default;
  vtkFFDFrameCache(const vtkFFDFrameCache&) = delete;
  vtkFFDFrameCache& operator=(const vtkFFDFrameCache&) = delete;

  ///@{
  /**
   * Bring up to date what the mapper's bounds follow from (the voxels and the deformation); what
   * looks at single points need, these with the mask and the cropping; all that a picture is made
   * from. Warnings are those of the mapper. False, with a message in `tools`, where that cannot be;
   * the getters below then give what was made before, if anything.
   */
  bool UpdateBounds(Mapper* mapper, ffd::StageTools& tools);
  bool UpdateProbe(Mapper* mapper, ffd::StageTools& tools);
  bool Update(Mapper* mapper, vtkVolumeProperty* property, ffd::StageTools& tools);
  ///@}

  const ffd::VolumeView& GetVolume() const { return this->Voxels->View; }
  const ffd::CellMask* GetHidden() const { return this->Voxels->GetHidden(); }
  /// The unit "voxel", data units: the shortest edge of a voxel.
  double GetVoxelSize() const;
  const ffd::MaskView& GetMask() const { return this->Mask; }
  /// The second axis of two-dimensional transfer functions; Scalars is null without any.
  const ffd::VolumeView& GetSecondAxis() const { return this->SecondAxis; }
  const ffd::BoundedPullBack& GetPullBack() const { return *this->PullBack->Last; }
  const ffd::OpticalFunctions& GetFunctions() const { return this->Functions->Optics; }
  ffd::FunctionCache* GetKeptOfFunctions() const { return this->Functions->KeptOfThem.get(); }
  /// Of the scalars of each component.
  const std::vector<ffd::MinMaxBlocks::Limits>& GetRanges() const
  {
    return this->Functions->Facts.Ranges;
  }
  /// MinMaxBlocks::GetCommonRange() of each component.
  const std::vector<ffd::MinMaxBlocks::Limits>& GetCommonRanges() const
  {
    return this->Functions->Facts.CommonRanges;
  }
  const ffd::Blending& GetBlending() const { return this->Blend; }
  const ffd::Cropping& GetCropping() const { return this->Crop; }
  /// Planes of the world, see ffd::MakeClippingPlanes().
  const std::vector<glm::dvec4>& GetClippingPlanes() const { return this->ClippingPlanes; }
  /// Null where nothing is leaped over.
  const ffd::DistanceMap* GetDistances() const { return this->Distances; }
  ffd::SpaceCache* GetKeptOfSpace() const { return this->Space->KeptOfThem.get(); }
  /// Bounds of values for maxima and minima along rays, one for each channel; null for other blend
  /// modes.
  const std::vector<ffd::ValuePeaks>* GetPeaks() const { return this->Peaks; }
  /// The arrays that views point into, not owned.
  const std::vector<vtkDataArray*>& GetArrays() const { return this->Arrays; }

  ///@{
  /**
   * Numbers that change with the voxels and with the transfer functions.
   */
  std::uint64_t GetVoxelsVersion() const { return this->Voxels.GetProduct().GetVersion(); }
  std::uint64_t GetFunctionsVersion() const { return this->Functions.GetProduct().GetVersion(); }
  ///@}

  /// Bounds of the deformed volume after the last update that succeeded; else uninitialized.
  const double* GetReportedBounds() const { return this->ReportedBounds; }

  /// See vtkFFDInverseRayVolumeMapper::GetNumberOfBuilds(); `part` must be one.
  vtkTypeInt64 GetNumberOfBuilds(int part) const;

  std::size_t GetMemorySize() const;

private:
  bool UpdateVoxels(Mapper* mapper, vtkDataSet* input, ffd::StageTools& tools);
  bool UpdatePullBack(Mapper* mapper, vtkDataSet* input, ffd::StageTools& tools);
  bool FindMask(Mapper* mapper, std::string& message);
  bool FindSecondAxis(const char* name, vtkDataSet* input, std::string& message);
  bool UpdateBlocks(Mapper* mapper, vtkVolumeProperty* property, ffd::StageTools& tools);
  void UpdateMaskBlocks(ffd::StageTools& tools);

  // The stages, in their order.
  ffd::StageOrder Order;
  ffd::Stage<&ffd::MakeVectorScalars> VectorScalars{ Order }; // what VectorMode renders
  ffd::Stage<&ffd::MakeVoxels> Voxels{ Order };
  vtkFFDDeformationSource Field{ Order };
  ffd::Stage<&ffd::MakeBoundedPullBack> PullBack{ Order };
  ffd::Stage<&ffd::MakeComponentBlocks> Blocks{ Order };
  ffd::Stage<&ffd::MakeMaskBlocks> MaskBlocks{ Order };
  ffd::Stage<&ffd::MakeLabelBlocks> Labels{ Order };
  ffd::Stage<&ffd::MakeTransferFunctions> Functions{ Order };
  ffd::Stage<&ffd::MakeEmptySpace> Space{ Order };

  // Inputs of the last update.
  std::vector<vtkDataArray*> Arrays;
  ffd::LookupOptions Lookup;
  ffd::MaskView Mask;
  vtkSmartPointer<vtkDataArray> MaskArray;
  vtkMTimeType MaskTime = 0;
  ffd::VolumeView SecondAxis;
  vtkSmartPointer<vtkDataArray> SecondAxisArray;
  ffd::Blending Blend;
  ffd::Cropping Crop;
  std::vector<glm::dvec4> ClippingPlanes;
  const ffd::DistanceMap* Distances = nullptr;
  const std::vector<ffd::ValuePeaks>* Peaks = nullptr;
  double ReportedBounds[6] = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 };
};

#endif
