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

  /// Whether a point in the coordinates of the planes is shown.
  bool Shows(const glm::dvec3& p) const
  {
    int region = 0;
    int stride = 1;
    for (int a = 0; a < 3; ++a)
    {
      region += stride * ((p[a] >= this->Low[a] ? 1 : 0) + (p[a] >= this->High[a] ? 1 : 0));
      stride *= 3;
    }
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
