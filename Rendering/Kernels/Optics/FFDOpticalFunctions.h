// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDOpticalFunctions_h
#define FFDOpticalFunctions_h

#include "FFDExport.h"
#include "FFDGradientOpacity.h"
#include "FFDMinMaxBlocks.h"
#include "FFDShading.h"
#include "FFDTransferPlane.h"
#include "FFDTransferTable.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace ffd
{

/// Meaning of the components of the scalars.
enum class ComponentKind
{
  Independent,  ///< each has functions of its own
  ColorOpacity, ///< two: the first is looked up for color, the second for opacity
  Rgb,          ///< three: color; its luminance is looked up for opacity
  Rgba          ///< four: color, and what is looked up for opacity
};

/// Weights of red, green and blue in the luminance (ITU-R BT.601).
constexpr double LuminanceWeights[3] = { 0.299, 0.587, 0.114 };

/// Functions and surface of one independent component, or of all dependent ones together.
struct ComponentOptics
{
  TransferTable Table;
  GradientOpacity Gradients; ///< may be empty
  TransferPlane Plane;       ///< in the place of Table and Gradients, unless empty
  float Weight = 1.0f;       ///< of its opacity among several independent components
  bool Shade = false;
  Reflectance Surface;
};

/// Functions in the place of the first component's where a label map has a label.
struct LabelOptics
{
  TransferTable Table;
  GradientOpacity Gradients; ///< may be empty
};

/// Components, of `count`, that the opacity depends on, in the order of
/// OpticalFunctions::IsTransparent().
FFD_RENDERING_EXPORT std::vector<int> FindOpacityComponents(ComponentKind kind, int count);

/// The factor that scales values that are colors to [0, 1].
FFD_RENDERING_EXPORT double FindColorScale(ScalarType type);

/**
 * Everything that says what scalars look like, for whole images: made when the property or the
 * scalars change.
 */
struct FFD_RENDERING_EXPORT OpticalFunctions
{
  ComponentKind Kind = ComponentKind::Independent;
  std::vector<ComponentOptics> Components; ///< one, or one for each independent component
  TransferTable Colors;                    ///< ColorOpacity: colors over the first component
  double ColorScale = 1.0;                 ///< Rgb, Rgba: what takes their values to [0, 1]
  std::vector<LabelOptics> Labels;
  std::vector<int> LabelIndices; ///< by label: entry of Labels, or -1

  /// Entry of Labels for a label, or null.
  const LabelOptics* FindLabel(double label) const
  {
    if (!(label >= 0.5) || !(label < static_cast<double>(this->LabelIndices.size()) - 0.5))
    {
      return nullptr;
    }
    const int index = this->LabelIndices[static_cast<std::size_t>(label + 0.5)];
    return index < 0 ? nullptr : &this->Labels[static_cast<std::size_t>(index)];
  }

  /// Whether nothing can be seen where the components of FindOpacityComponents() are within
  /// `limits`.
  bool IsTransparent(const MinMaxBlocks::Limits* limits) const;

  std::size_t GetMemorySize() const;

private:
  bool IsTransparent(const ComponentOptics& component, const MinMaxBlocks::Limits& limits) const;
};

/// Whether IsTransparent() certainly says the same of both for all limits. False where that would
/// take long to find out: with planes or labels.
FFD_RENDERING_EXPORT bool HaveSameVisibility(const OpticalFunctions& a, const OpticalFunctions& b);

} // namespace ffd

#endif
