// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RandomLattice_h
#define RandomLattice_h

#include "FFDBSplineField.h"

#include <glm/common.hpp>

#include <random>
#include <vector>

/// Random inputs of the property tests; the same on every machine for a seed.
class RandomLattice
{
public:
  explicit RandomLattice(unsigned int seed)
    : Generator(seed)
  {
  }

  /// In [lo, hi); written out because std::uniform_real_distribution differs between libraries.
  double Number(double lo, double hi)
  {
    return lo + (hi - lo) * (static_cast<double>(this->Generator()) / 4294967296.0);
  }
  int Integer(int lo, int hi)
  {
    return lo + static_cast<int>(this->Generator() % static_cast<unsigned int>(hi - lo + 1));
  }
  glm::dvec3 Vector(double lo, double hi)
  {
    const double x = this->Number(lo, hi);
    const double y = this->Number(lo, hi);
    const double z = this->Number(lo, hi);
    return { x, y, z };
  }

  /// A lattice with displacements of up to `amount` spacings per axis.
  ffd::BSplineField Field(double amount, ffd::BorderMode border, int leastNodes = 4)
  {
    glm::ivec3 nodes;
    for (int a = 0; a < 3; ++a)
    {
      nodes[a] = this->Integer(leastNodes, 7);
    }
    const glm::dvec3 spacing = this->Vector(0.5, 3.0);
    const glm::dvec3 origin = this->Vector(-20.0, 20.0);
    std::vector<glm::dvec3> displacements(static_cast<std::size_t>(nodes.x) * nodes.y * nodes.z);
    for (glm::dvec3& d : displacements)
    {
      d = amount * this->Vector(-1.0, 1.0) * spacing;
    }
    return ffd::BSplineField(nodes, origin, spacing, displacements.data(), 1.0, border);
  }

  /// A point in or near the lattice: up to `margin` spacings outside.
  glm::dvec3 Point(const ffd::BSplineField& field, double margin)
  {
    glm::dvec3 p;
    for (int a = 0; a < 3; ++a)
    {
      p[a] = field.GetOrigin()[a] +
        field.GetSpacing()[a] * this->Number(-margin, field.GetNodes()[a] - 1 + margin);
    }
    return p;
  }

  /// A box of 0.01 to `extent` spacings about such a point.
  void Region(
    const ffd::BSplineField& field, double margin, double extent, glm::dvec3& min, glm::dvec3& max)
  {
    min = this->Point(field, margin);
    max = min + glm::abs(field.GetSpacing()) * this->Vector(0.01, extent);
  }

private:
  std::mt19937 Generator;
};

constexpr ffd::BorderMode AllBorders[] = { ffd::BorderMode::Edge, ffd::BorderMode::Zero,
  ffd::BorderMode::ZeroAtBorder };

#endif
