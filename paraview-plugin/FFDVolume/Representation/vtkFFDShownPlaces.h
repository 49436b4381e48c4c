// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDShownPlaces.h
 * Places in a picture of data with a lattice: those that ParaView takes from what is seen, for a
 * ruler for instance, and those that its filters probe. Private to this module.
 */
#ifndef vtkFFDShownPlaces_h
#define vtkFFDShownPlaces_h

#include <array>
#include <string>

class vtkAlgorithm;
class vtkPVRayCastPickingHelper;

namespace ffdplaces
{

/**
 * Let ParaView's helper that intersects a ray with the cell or point below the pointer find them
 * where they are shown.
 */
void FollowPicking(vtkPVRayCastPickingHelper* helper);

/**
 * Where the ray meets the selected cell of what `input` makes, as it is shown by its lattice, or by
 * points that have been moved and have "RestPosition": as vtkFFDSurfacePicker::GetPicked() tells
 * it. Called on all processes.
 */
std::array<double, 8> PickSurface(vtkAlgorithm* input, vtkAlgorithm* selection,
  const double from[3], const double to[3], const std::string& array, bool ofCells);

/**
 * Let a filter that probes its data at the points of its output (Probe Location, Plot Over Line)
 * take the values of what is shown there. Its output stays where it is and has "RestPosition", the
 * places of that at rest. `dataPort` is the input that is probed.
 */
void FollowProbe(vtkAlgorithm* filter, int dataPort);

} // namespace ffdplaces

#endif
