// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDVolumePicking.h
 * What is seen of deformed volumes along a line. Private to this module.
 */
#ifndef vtkFFDVolumePicking_h
#define vtkFFDVolumePicking_h

#include <array>
#include <vector>

class vtkRenderer;
class vtkVolume;

namespace ffdpicking
{

/// What is seen first along a line.
struct Picked
{
  /// As vtkFFDVolumeRepresentation::GetPicked() tells it.
  std::array<double, 8> Numbers{};

  /// Of the surface there, or against the line.
  std::array<double, 3> Normal{};
};

/// What is seen first of volumes that are rendered by mappers of ours, all in one blend mode, along
/// a line in world coordinates, see vtkFFDVolumeRepresentation::Pick().
Picked PickVolumes(const std::vector<vtkVolume*>& volumes, vtkRenderer* renderer,
  const double from[3], const double to[3]);

} // namespace ffdpicking

#endif
