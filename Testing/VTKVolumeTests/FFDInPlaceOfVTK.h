// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Included before each of VTK's volume tests: puts vtkFFDInverseRayVolumeMapper in the place of
// VTK's mappers.
#ifndef FFDInPlaceOfVTK_h
#define FFDInPlaceOfVTK_h

// The headers that declare or mention VTK's mappers come before the names change their meaning.
#include "vtkFixedPointVolumeRayCastMapper.h"
#include "vtkGPUVolumeRayCastMapper.h"
#include "vtkMultiBlockVolumeMapper.h"
#include "vtkMultiVolume.h"
#include "vtkOpenGLGPUVolumeRayCastMapper.h"
#include "vtkSmartVolumeMapper.h"
#include "vtkVolume.h"

#include "vtkFFDInverseRayVolumeMapper.h"

#define vtkFixedPointVolumeRayCastMapper vtkFFDInverseRayVolumeMapper
#define vtkGPUVolumeRayCastMapper vtkFFDInverseRayVolumeMapper
#define vtkOpenGLGPUVolumeRayCastMapper vtkFFDInverseRayVolumeMapper
#define vtkSmartVolumeMapper vtkFFDInverseRayVolumeMapper

#endif
