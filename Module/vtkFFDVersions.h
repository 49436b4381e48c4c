// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDVersions.h
 * @brief names what differs between the versions of VTK that vtkFFD is built with
 *
 * VTK 9.1 (Debian 12), 9.2 (ParaView 5.11), 9.3 (Debian 13, ParaView 5.13) and 9.5 (the Python
 * wheel) are built and tested. Each name says which change of VTK makes it necessary; no other file
 * asks for a version of VTK.
 */
#ifndef vtkFFDVersions_h
#define vtkFFDVersions_h

#include "vtkVersionMacros.h" // For VTK_VERSION_NUMBER

// VTK 9.2 gave vtkVolumeMapper the option ComputeNormalFromOpacity; with VTK 9.1
// vtkFFDInverseRayVolumeMapper has one of its own.
#if VTK_VERSION_NUMBER < VTK_VERSION_CHECK(9, 2, 0)
#define VTK_FFD_OWN_COMPUTE_NORMAL_FROM_OPACITY
#endif

// VTK 9.2 computes the highlights of vtkGPUVolumeRayCastMapper from the reflected ray (Phong)
// instead of the half vector (Blinn), which vtkFixedPointVolumeRayCastMapper and we keep to: for
// tests that compare with it.
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 0)
#define VTK_FFD_GPU_MAPPER_REFLECTS_HIGHLIGHTS
#endif

// VTK 9.4 loads OpenGL's functions with glad instead of glew, whose header is gone.
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 4, 0)
#define VTK_FFD_OPENGL_HEADER "vtk_glad.h"
#else
#define VTK_FFD_OPENGL_HEADER "vtk_glew.h"
#endif

#endif
