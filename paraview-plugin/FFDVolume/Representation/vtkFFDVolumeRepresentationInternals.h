// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What vtkFFDVolumeRepresentation keeps for itself. Private to this module.
#ifndef vtkFFDVolumeRepresentationInternals_h
#define vtkFFDVolumeRepresentationInternals_h

#include "vtkFFDVolumeRepresentation.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDRenderedImage.h"
#include "vtkFFDViewFrames.h"
#include "vtkFFDVolumeInput.h"
#include "vtkFFDVolumeParts.h"
#include "vtkFFDVolumePicking.h"
#include "vtkFFDVoxelDistribution.h"

#include "vtkImageData.h"
#include "vtkImageResize.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkTimeStamp.h"
#include "vtkVolume.h"

#include <memory>
#include <vector>

class vtkFFDVolumeRepresentation::vtkInternals
{
public:
  /// In the field data of one of several images: bounds of all of them at rest, then deformed.
  static constexpr const char* AllBoundsName = "FFDVolume.AllBounds";

  vtkFFDVolumeInput Input;

  /// A volume of the scene: of all blocks with the same lattice.
  struct Volume
  {
    vtkFFDVoxelDistribution::Inputs Inputs; // what this process was given
    vtkFFDVoxelDistribution Distribution;   // with several processes
    vtkNew<vtkFFDLattice> Lattice;          // as it was read last
    ffdparts::DeformedBoundsFinder BoundsFinder;
  };
  std::vector<std::unique_ptr<Volume>> Volumes; // one at least; as many on all processes

  /// What this process shows of them.
  struct Shown
  {
    vtkSmartPointer<vtkFFDInverseRayVolumeMapper> Mapper;
    vtkSmartPointer<vtkVolume> Actor;
    vtkFFDRenderedImage Rendered;
    vtkMTimeType ReportTime = 0; // of what was looked at for problems last
  };
  std::vector<std::unique_ptr<Shown>>
    AllShown;                          // one at least, by the superclass's mapper and actor
  vtkSmartPointer<vtkImageData> Table; // the two-dimensional function as ParaView has it
  vtkNew<vtkImageResize> FineTable;    // of it, what the property has
  vtkMTimeType OptionsTime = 0;        // of the first mapper, when the others had its options

  vtkNew<vtkFFDViewFrames> Frames;
  vtkTimeStamp RenderTime;   // of the last frame of the view
  ffdpicking::Picked Picked; // what was picked last
};

#endif
