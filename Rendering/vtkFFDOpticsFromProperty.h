// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * The transfer functions and materials of a volume property for the kernels. Private to this
 * module: not installed, not wrapped.
 */
#ifndef vtkFFDOpticsFromProperty_h
#define vtkFFDOpticsFromProperty_h

#include "FFDMinMaxBlocks.h"
#include "FFDVolumeView.h"
#include "Optics/FFDOpticalFunctions.h"

#include <string>
#include <vector>

class vtkVolumeProperty;

namespace ffd
{

/// Facts about the scalars that MakeOpticalFunctions() needs.
struct ScalarFacts
{
  ComponentKind Kind = ComponentKind::Independent;
  ScalarType Type = ScalarType::UInt8;
  std::vector<MinMaxBlocks::Limits> Ranges;       ///< of the finite values of each component
  std::vector<MinMaxBlocks::Limits> CommonRanges; ///< MinMaxBlocks::GetCommonRange()
  bool Nearest = false;                           ///< scalars are not interpolated
  bool HasSecondAxis = false; ///< of two-dimensional transfer functions; else it is the gradient
  MinMaxBlocks::Limits SecondAxis{ 0.0, 1.0 };
  bool HasLabels = false;
  bool NativeColors = false; ///< color functions are asked for scalars of their ranges only
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

/// Finds the meaning that a property gives to the components of scalars; false and a message when
/// there are too many, or when they cannot have that meaning.
bool FindComponentKind(vtkVolumeProperty* property, int components, ScalarType type,
  ComponentKind& kind, std::string& message);

} // namespace ffd

#endif
