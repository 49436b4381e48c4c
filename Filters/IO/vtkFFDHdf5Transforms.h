// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed.
#ifndef vtkFFDHdf5Transforms_h
#define vtkFFDHdf5Transforms_h

#include "FFDTransformStep.h"

#include <string>
#include <string_view>
#include <vector>

/**
 * Transforms in HDF5 files: those of ITK (.h5), and the displacement fields of MINC 2 (.mnc) that
 * .xfm files name. Only what lies in the file itself is read: links to other files, data in other
 * files, and filters other than deflate and shuffle, for which HDF5 would load plugins, are
 * refused. Functions return false with the reason in `error`. What is allocated is bounded by a
 * multiple of what the file stores.
 */
namespace vtkFFDHdf5Transforms
{

bool LooksLikeHdf5(std::string_view bytes);

/// The steps of a file of ITK, first applied first.
bool ReadItk(const std::string& name, std::vector<ffd::TransformStep>& steps, std::string& error);

/// A volume of displacements, /minc-2.0/image/0/image, as a Field in MINC's world coordinates.
bool ReadMincGrid(const std::string& name, ffd::TransformStep& step, std::string& error);

} // namespace vtkFFDHdf5Transforms

#endif
