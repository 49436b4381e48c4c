// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Turns a finished picture into images of bytes, or into identifiers for a selector. Private to
 * this module: not installed, not wrapped.
 */
#ifndef vtkFFDFrameOutput_h
#define vtkFFDFrameOutput_h

#include "FFDCameraView.h"

#include <vector>

class vtkFFDFrameCache;
class vtkFFDInverseRayVolumeMapper;
class vtkFFDParallelFor;
class vtkHardwareSelector;
class vtkImageData;

/// `colors`, premultiplied, 4 floats a pixel, as a picture of bytes.
void vtkFFDWriteColors(const std::vector<float>& colors, int width, int height,
  const vtkFFDParallelFor& parallelFor, vtkImageData* image);

/// Depths, 0 to 1, as an image of the extent that it has: 255 or 65535 times as large as integers,
/// of VTK_UNSIGNED_CHAR or VTK_UNSIGNED_SHORT, and else as floats.
void vtkFFDWriteDepths(const std::vector<float>& depths, int scalarType, vtkImageData* image);

/// Whether a pass of a selector reads what the volume draws.
bool vtkFFDIsPassRead(vtkHardwareSelector* selector);

/// Draws, in the place of colors, the identifiers that the present pass of a selector reads from
/// visible pixels; `depths`: those of the first visible samples. Where the input is what one of
/// several processes renders, or is put together from blocks, its field data may have an array of
/// integers "FFD.Pieces" with what the processes have of the data: a process, the index of the
/// block (0 without blocks, negative of one with other points) and an extent each. Identifiers are
/// those of the first of them, and so are the process and the block.
void vtkFFDPaintIdentifiers(vtkHardwareSelector* selector, vtkFFDInverseRayVolumeMapper* mapper,
  const vtkFFDFrameCache& cache, const ffd::CameraView& camera, const std::vector<float>& depths,
  std::vector<float>& colors);

/// Sets `depths` of pixels that show nothing to those at which rays leave the visible bounds.
void vtkFFDMoveToBackface(vtkFFDInverseRayVolumeMapper* mapper, const vtkFFDFrameCache& cache,
  const ffd::CameraView& camera, const std::vector<float>& colors, std::vector<float>& depths);

#endif
