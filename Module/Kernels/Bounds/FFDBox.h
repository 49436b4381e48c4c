// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDBox_h
#define FFDBox_h

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <limits>

namespace ffd
{

/// An axis-aligned box of data coordinates; empty when Min > Max on an axis.
struct Box
{
  glm::dvec3 Min{ 0.0 };
  glm::dvec3 Max{ 0.0 };

  bool operator==(const Box& other) const
  {
    return this->Min == other.Min && this->Max == other.Max;
  }

  bool IsEmpty() const
  {
    return !(
      this->Min.x <= this->Max.x && this->Min.y <= this->Max.y && this->Min.z <= this->Max.z);
  }

  bool Contains(const glm::dvec3& p) const
  {
    return p.x >= this->Min.x && p.y >= this->Min.y && p.z >= this->Min.z && p.x <= this->Max.x &&
      p.y <= this->Max.y && p.z <= this->Max.z;
  }

  /// Becomes the smallest box that contains both. One that is empty must be Empty().
  void Include(const Box& other)
  {
    this->Min = glm::min(this->Min, other.Min);
    this->Max = glm::max(this->Max, other.Max);
  }

  static Box Empty()
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return { glm::dvec3(infinity), glm::dvec3(-infinity) };
  }
};

inline Box Intersect(const Box& a, const Box& b)
{
  return { glm::max(a.Min, b.Min), glm::min(a.Max, b.Max) };
}

} // namespace ffd

#endif
