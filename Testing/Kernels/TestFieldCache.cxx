// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFieldCache.h"
#include "FFDGridIndex.h"
#include "RandomLattice.h"

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

using namespace ffd;

namespace
{

/// A lattice of `nodes` control points along each axis.
BSplineField MakeField(int nodes)
{
  RandomLattice random(51);
  std::vector<glm::dvec3> displacements(GridSize(glm::ivec3(nodes)));
  for (glm::dvec3& d : displacements)
  {
    d = random.Vector(-0.3, 0.3);
  }
  return BSplineField(
    glm::ivec3(nodes), glm::dvec3(1.0, -2.0, 3.0), glm::dvec3(1.0, 0.7, 1.3), displacements.data());
}

/// What a cache is to make of a field that goes on linearly.
PacketField Extend(const BSplineField& field, const Box& rest)
{
  return PacketField(field, rest, glm::ivec3(4), PacketField::FindSecondDerivative(field));
}

/// The part of a lattice in which D is known, from the second control point to the last but one.
Box FindDomain(const BSplineField& field)
{
  return { field.GetOrigin() + field.GetSpacing(),
    field.GetOrigin() + field.GetSpacing() * glm::dvec3(field.GetNodes() - 2) };
}

} // namespace

TEST(FieldCache, MakesEachFieldOnce)
{
  const BSplineField field = MakeField(16);
  Box rest = FindDomain(field);
  FieldCache cache;
  EXPECT_EQ(cache.GetMemorySize(), 0u);
  const PacketField plain = cache.FindPacketField(field, rest, glm::ivec3(0));
  EXPECT_EQ(*plain.Coefficients, *PacketField(field).Coefficients);
  EXPECT_EQ(cache.FindPacketField(field, rest, glm::ivec3(0)).Coefficients, plain.Coefficients);
  EXPECT_EQ(cache.GetMemorySize(), plain.GetMemorySize());

  const PacketField extended = cache.FindPacketField(field, rest, glm::ivec3(4));
  EXPECT_EQ(*extended.Coefficients, *Extend(field, rest).Coefficients);
  EXPECT_NE(*extended.Coefficients, *plain.Coefficients);
  EXPECT_EQ(cache.FindPacketField(field, rest, glm::ivec3(4)).Coefficients, extended.Coefficients);
  EXPECT_EQ(cache.GetMemorySize(), extended.GetMemorySize());
  EXPECT_EQ(*cache.FindPacketField(field, rest, glm::ivec3(0)).Coefficients, *plain.Coefficients);

  // Of a volume that reaches beyond the lattice nothing is extended.
  rest.Max += 5.0 * field.GetSpacing();
  EXPECT_EQ(*cache.FindPacketField(field, rest, glm::ivec3(4)).Coefficients, *plain.Coefficients);
}

TEST(FieldCache, FindsHowFarFlatLatticesGoOnLinearly)
{
  // A plate that is turned about its normal, more so from one face to the other, as
  // vtkFFDLatticeSource does, or that is tapered: there T folds beyond it.
  const auto make = [](bool turns, double strength) {
    const glm::ivec3 nodes(8);
    const glm::dvec3 spacing(85.0, 85.0, 3.0);
    std::vector<glm::dvec3> displacements;
    for (int k = 0; k < 8; ++k)
    {
      for (int j = 0; j < 8; ++j)
      {
        for (int i = 0; i < 8; ++i)
        {
          const glm::dvec3 p = spacing * (glm::dvec3(i, j, k) - 3.5);
          const double amount = strength * p.z;
          displacements.push_back(turns
              ? glm::dvec3(std::cos(amount) * p.x - std::sin(amount) * p.y - p.x,
                  std::sin(amount) * p.x + std::cos(amount) * p.y - p.y, 0.0)
              : glm::dvec3(amount * p.x, amount * p.y, 0.0));
        }
      }
    }
    return BSplineField(nodes, -3.5 * spacing, spacing, displacements.data());
  };
  const glm::ivec3 wanted(1, 1, 22);
  const BSplineField twist = make(true, 0.004);
  FieldCache cache;
  EXPECT_EQ(cache.FindProvenCells(twist, wanted), glm::ivec3(1, 1, 8));
  EXPECT_EQ(cache.FindProvenCells(twist, wanted), glm::ivec3(1, 1, 8));
  EXPECT_EQ(cache.FindProvenCells(twist, glm::ivec3(1, 0, 6)), glm::ivec3(1, 0, 6));
  for (const auto& [strength, proven] :
    { std::pair(0.01, 8), { 0.03, 3 }, { 0.07, 0 }, { 0.2, 0 } })
  {
    const BSplineField taper = make(false, strength);
    const glm::ivec3 cells = FieldCache().FindProvenCells(taper, wanted);
    EXPECT_EQ(cells, glm::min(wanted, glm::ivec3(proven))) << strength;
    const BSplineField extended = ExtendLinearly(taper, cells);
    RandomLattice random(5);
    for (int i = 0; i < 5000 && cells.z > 0; ++i)
    {
      glm::dmat3 jacobian;
      extended.Displacement(glm::dvec3(random.Number(-500.0, 500.0), random.Number(-500.0, 500.0),
                              random.Number(-60.0, 60.0)),
        jacobian);
      ASSERT_GT(glm::determinant(glm::dmat3(1.0) + jacobian), 0.0);
    }
  }
}

TEST(FieldCache, KeepsNothingOfFewControlPoints)
{
  const BSplineField field = MakeField(8);
  FieldCache cache;
  const Box rest = FindDomain(field);
  const BoxGrid boxes(rest, 50.0, 1e-3);
  // But for a number.
  for (int repeat = 0; repeat < 2; ++repeat)
  {
    const PacketField extended = cache.FindPacketField(field, rest, glm::ivec3(4));
    EXPECT_EQ(*extended.Coefficients, *Extend(field, rest).Coefficients);
    EXPECT_GT(extended.SecondDerivative, 0.0f);
    EXPECT_EQ(extended.SecondDerivative, PacketField(field).SecondDerivative);
  }
  EXPECT_EQ(cache.FindBoxImages(boxes, field, -1.0)->Find(glm::ivec3(0)),
    BoxImages(boxes, &field, -1.0).Find(glm::ivec3(0)));
  EXPECT_EQ(cache.FindThirdDerivatives(field).Largest[0][1][2],
    BoundThirdDerivatives(field).Largest[0][1][2]);
  EXPECT_EQ(cache.GetMemorySize(), 0u);
}

TEST(FieldCache, SetsTheCenterOfACopy)
{
  const BSplineField field = MakeField(16);
  const Box rest = FindDomain(field);
  FieldCache cache;
  PacketField moved = cache.FindPacketField(field, rest, glm::ivec3(0));
  moved.SetCenter(field.GetOrigin());
  for (int a = 0; a < 3; ++a)
  {
    EXPECT_EQ(moved.Origin[a], 0.0f);
    EXPECT_EQ(cache.FindPacketField(field, rest, glm::ivec3(0)).Origin[a],
      static_cast<float>(field.GetOrigin()[a]));
  }
}

TEST(FieldCache, KeepsTheImagesOfAFewGrids)
{
  const BSplineField field = MakeField(16);
  FieldCache cache;
  const BoxGrid coarse(FindDomain(field), 50.0, 1e-3);
  const BoxGrid fine(FindDomain(field), 500.0, 1e-3);
  const auto images = cache.FindBoxImages(coarse, field, 1.0);
  EXPECT_EQ(images->GetBoxes(), coarse);
  EXPECT_EQ(cache.FindBoxImages(coarse, field, 1.0), images);
  EXPECT_NE(cache.FindBoxImages(fine, field, 1.0), images);
  EXPECT_EQ(cache.FindBoxImages(fine, field, 1.0)->GetBoxes(), fine);
  const auto mirrored = cache.FindBoxImages(coarse, field, -1.0);
  EXPECT_FALSE(mirrored->Find(glm::ivec3(0)) == images->Find(glm::ivec3(0)));
  const std::size_t size = cache.GetMemorySize();
  for (int number = 60; number < 100; number += 10)
  {
    cache.FindBoxImages(BoxGrid(FindDomain(field), number, 1e-3), field, 1.0);
  }
  EXPECT_LE(cache.GetMemorySize(), size);
  // Made anew, and the same.
  EXPECT_EQ(
    cache.FindBoxImages(coarse, field, 1.0)->Find(glm::ivec3(0)), images->Find(glm::ivec3(0)));
}
