// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDCropping_h
#define FFDCropping_h

#include <glm/vec3.hpp>

namespace ffd
{

/**
 * Two planes across each axis cut space into 27 regions, of which some are shown: as
 * vtkVolumeMapper's. A region begins on its lower plane and ends before its upper one.
 */
struct Cropping
{
  enum class Spaces
  {
    None,    ///< nothing is cropped
    Rest,    ///< the volume before it is deformed: planes are index coordinates
    Deformed ///< what has been deformed: planes are data coordinates
  };

  Spaces Space = Spaces::None;
  glm::dvec3 Low{ 0.0 };
  glm::dvec3 High{ 0.0 };
  int Flags = 0; ///< bit x + 3 y + 9 z is set where region (x, y, z) is shown

  /// Which part of an axis a coordinate of it is in: 0 before both planes, 1 between them, 2.
  int FindPart(double x, int axis) const
  {
    return (x >= this->Low[axis] ? 1 : 0) + (x >= this->High[axis] ? 1 : 0);
  }

  /// Whether a point in the coordinates of the planes is shown.
  bool Shows(const glm::dvec3& p) const
  {
    const int region =
      this->FindPart(p.x, 0) + 3 * this->FindPart(p.y, 1) + 9 * this->FindPart(p.z, 2);
    return (this->Flags >> region & 1) != 0;
  }

  bool operator==(const Cropping& other) const
  {
    return this->Space == other.Space && this->Low == other.Low && this->High == other.High &&
      this->Flags == other.Flags;
  }
};

} // namespace ffd

#endif
