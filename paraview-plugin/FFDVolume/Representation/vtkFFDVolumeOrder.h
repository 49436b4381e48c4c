// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDVolumeOrder.h
 * The order in which the volumes of a renderer are drawn, and what is drawn before them. Private to
 * this module.
 */
#ifndef vtkFFDVolumeOrder_h
#define vtkFFDVolumeOrder_h

class vtkRenderer;

namespace ffdorder
{

/**
 * Let the renderer draw its volumes from the farthest to the nearest, for its camera: VTK draws
 * them in the order in which they were added. Exact where a plane between their bounds separates
 * each two of them, unless three or more are in front of each other in a circle; else by the
 * distances of their centers.
 */
void SortVolumes(vtkRenderer* renderer);

/**
 * Whether the renderer draws nothing but a background of one color before its volumes: then FXAA,
 * which VTK applies before these, changes no pixel.
 */
bool IsEmptyBeforeVolumes(vtkRenderer* renderer);

} // namespace ffdorder

#endif
