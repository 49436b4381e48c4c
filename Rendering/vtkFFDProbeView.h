// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this library: not installed, not wrapped.
#ifndef vtkFFDProbeView_h
#define vtkFFDProbeView_h

#include "Bounds/FFDPullBackBounds.h"
#include "FFDCropping.h"
#include "FFDPullBack.h"
#include "FFDVolumeView.h"
#include "Optics/FFDSampleClassifier.h"

/// The parts of a mapper that are needed to look at its volume point by point. Valid until the
/// mapper, its input or its deformation changes.
struct vtkFFDProbeView
{
  ffd::VolumeView Volume;
  const ffd::CellMask* Hidden = nullptr;
  ffd::MaskView Mask;
  ffd::Cropping Crop;
  ffd::PullBack Map;
  bool OneToOne = false; // proven: every deformed point comes from one rest point alone
  ffd::Box Deformed;     // the part of deformed space that is rendered, data coordinates
};

#endif
