// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed.
#ifndef vtkFFDVolumeViewFromImage_h
#define vtkFFDVolumeViewFromImage_h

#include "vtkFFDVolumesModule.h" // For export macro

#include <string> // for std::string

class vtkDataArray;
class vtkImageData;

namespace ffd
{
struct VolumeView;
}

/**
 * View of the voxels of an image, for kernels. With `anyComponents` the scalars may have several
 * components: the view is that of the first one, the others follow it in memory. Returns false
 * and a message for the user when the image is no volume: empty, flat, scalars missing or of the
 * wrong number or kind, spacing, origin or direction not usable.
 *
 * `ofCells`: the scalars are those of the cells. Then cells are the voxels, each at its center.
 */
VTKFFDVOLUMES_EXPORT bool vtkFFDVolumeViewFromImage(vtkImageData* image, vtkDataArray* scalars,
  bool anyComponents, ffd::VolumeView& view, std::string& message, bool ofCells = false);

#endif
