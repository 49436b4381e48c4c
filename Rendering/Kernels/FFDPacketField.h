// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDPacketField_h
#define FFDPacketField_h

#include "FFDBSplineField.h"

#include <glm/vec3.hpp>

#include <vector>

namespace ffd
{

/**
 * Single precision copy of a BSplineField for the packet kernels. Coordinates are relative to a
 * point near the volume, so that a volume far from the origin loses no precision.
 */
struct PacketField
{
  /// From a cell number to the first of its four control points on an axis.
  static constexpr int FirstOffset = BSplineField::Padding - 1;

  float Origin[3] = {};
  float InverseSpacing[3] = {};
  float ClampMin[3] = {};
  float ClampMax[3] = {};
  int StrideY = 1;                 ///< control points from row to row
  int StrideZ = 1;                 ///< rows from plane to plane
  std::vector<float> Coefficients; ///< x, y, z of each control point

  void Assign(const BSplineField& field, const glm::dvec3& centre)
  {
    for (int a = 0; a < 3; ++a)
    {
      this->Origin[a] = static_cast<float>(field.GetOrigin()[a] - centre[a]);
      this->InverseSpacing[a] = static_cast<float>(1.0 / field.GetSpacing()[a]);
      this->ClampMin[a] = static_cast<float>(field.GetFirstCell()[a]);
      this->ClampMax[a] = static_cast<float>(field.GetEndCell()[a]);
    }
    this->StrideY = field.GetPaddedNodes().x;
    this->StrideZ = field.GetPaddedNodes().y;
    this->Coefficients.clear();
    this->Coefficients.reserve(3 * field.GetCoefficients().size());
    for (const glm::dvec3& c : field.GetCoefficients())
    {
      this->Coefficients.push_back(static_cast<float>(c.x));
      this->Coefficients.push_back(static_cast<float>(c.y));
      this->Coefficients.push_back(static_cast<float>(c.z));
    }
  }
};

} // namespace ffd

#endif
