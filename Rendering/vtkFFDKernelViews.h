// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Plain views of VTK objects for the kernels. Private to this module: not installed, not wrapped.
 */
#ifndef vtkFFDKernelViews_h
#define vtkFFDKernelViews_h

#include "FFDCameraView.h"
#include "FFDMinMaxBlocks.h"
#include "FFDOpticalFunctions.h"
#include "FFDShading.h"
#include "FFDVolumeView.h"

#include "vtkFFDImageRegion.h"

#include <glm/mat4x4.hpp>

#include <string>
#include <vector>

class vtkMatrix4x4;
class vtkRenderer;
class vtkVolumeProperty;

namespace ffd
{

/// GLM copy of a VTK matrix (GLM is column major, VTK row major).
glm::dmat4 ToMatrix(vtkMatrix4x4* matrix);

/// What MakeOpticalFunctions() needs to know of the scalars.
struct ScalarFacts
{
  ComponentKind Kind = ComponentKind::Independent;
  ScalarType Type = ScalarType::UInt8;
  std::vector<MinMaxBlocks::Limits> Ranges; ///< of the finite values of each component
  bool Nearest = false;                     ///< scalars are not interpolated
  bool HasSecondAxis = false; ///< of two-dimensional transfer functions; else it is the gradient
  MinMaxBlocks::Limits SecondAxis{ 0.0, 1.0 };
  bool HasLabels = false;
  bool NativeColours = false; ///< colour functions are asked for scalars of their ranges only
  bool NativeOpacities = false;
  bool NativeGradients = false; ///< opacities of gradients
};

/// Ranges of SampleClassifier::FindDensity() and FindIntensity(): as far as is known without
/// looking at all voxels.
MinMaxBlocks::Limits FindDensityRange(const ScalarFacts& facts, int channel);
MinMaxBlocks::Limits FindIntensityRange(const ScalarFacts& facts, int channel);

/**
 * Functions and surfaces of a property: tables of what it says, whatever the scalar type. Returns
 * false and a message for the user when something is missing or wrong.
 */
bool MakeOpticalFunctions(vtkVolumeProperty* property, const ScalarFacts& facts,
  OpticalFunctions& functions, std::string& message);

/// What the components of scalars are to a property; false and a message when there are too many,
/// or when they cannot be what the property says.
bool FindComponentKind(vtkVolumeProperty* property, int components, ScalarType type,
  ComponentKind& kind, std::string& message);

/// Camera of a renderer for the rays of a part of its viewport, in the data coordinates that
/// `dataToWorld`, the matrix of the volume, takes to the world.
CameraView MakeCameraView(
  vtkRenderer* renderer, const vtkFFDImageRegion& region, const glm::dmat4& dataToWorld);

/// Material of a property's first component under the lights of a renderer, these in the world; a
/// headlight if it has none at all.
Shading MakeShading(
  vtkRenderer* renderer, vtkVolumeProperty* property, const glm::dmat4& dataToWorld);

} // namespace ffd

#endif
