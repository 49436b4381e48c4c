// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDMincTransform_h
#define FFDMincTransform_h

#include "FFDExport.h"
#include "FFDTransformStep.h"

#include <string>
#include <string_view>
#include <vector>

namespace ffd
{

/// One transform of an .xfm file.
struct MincTransformEntry
{
  /// A linear one, already inverted where the file says so.
  TransformStep Step;
  /// Grid_Transform: the .mnc file of its displacements; empty: Step.
  std::string VolumeFile;
  bool IsInverse = false; // of a Grid_Transform
};

/**
 * Read an "MNI Transform File" (.xfm) of MINC's tools or of ITK: Linear and Grid_Transform, those
 * of a file applied one after the other, as they stand, and Invert_Flag. Returns false and what is
 * wrong. Numbers are finite and at most 1e12, linear transforms not singular.
 */
FFD_IO_EXPORT bool ParseMincTransform(
  std::string_view text, std::vector<MincTransformEntry>& entries, std::string& error);

/// Whether a text starts as this format does.
FFD_IO_EXPORT bool LooksLikeMincTransform(std::string_view text);

} // namespace ffd

#endif
