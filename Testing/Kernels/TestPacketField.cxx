// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSimdTargets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "TestPacketField.cxx"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once per instruction set.
#include <hwy/highway.h>

#include "FFDBSplineField.h"

#include "Packets/FFDPacketField.h"
#include "Packets/FFDSimdSpline-inl.h"

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// D and its Jacobian, by columns, at 16 positions: 12 numbers of each.
void EvaluatePositions(const PacketField& field, const float (*positions)[16], float (*values)[16])
{
  const Df d;
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d))
  {
    const Vec3 p{ hn::LoadU(d, positions[0] + i), hn::LoadU(d, positions[1] + i),
      hn::LoadU(d, positions[2] + i) };
    Vec3 parts[4];
    EvaluateField<true>(field, p, parts[0], parts[1], parts[2], parts[3]);
    const Vec3 alone = Displacement(field, p);
    for (std::size_t part = 0; part < 4; ++part)
    {
      hn::StoreU(parts[part].x, d, values[3 * part] + i);
      hn::StoreU(parts[part].y, d, values[3 * part + 1] + i);
      hn::StoreU(parts[part].z, d, values[3 * part + 2] + i);
    }
    hn::StoreU(alone.x, d, values[12] + i);
    hn::StoreU(alone.y, d, values[13] + i);
    hn::StoreU(alone.z, d, values[14] + i);
  }
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include "EveryTarget.h"
#include "RandomLattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace ffd
{

HWY_EXPORT(EvaluatePositions);

/// Lanes in few cells are summed up together, in many cells one by one: both give D, and what a
/// lane gets does not depend on the others, to the last bit.
TEST(PacketField, LanesNearAndFarFromEachOther)
{
  RandomLattice random(61);
  const glm::ivec3 nodes(23, 31, 17);
  std::vector<glm::dvec3> displacements(23 * 31 * 17);
  for (glm::dvec3& d : displacements)
  {
    d = random.Vector(-1.0, 1.0);
  }
  for (const BorderMode border : { BorderMode::Edge, BorderMode::Zero, BorderMode::ZeroAtBorder })
  {
    const BSplineField field(
      nodes, glm::dvec3(1.0), glm::dvec3(0.5, 1.0, -2.0), displacements.data(), 1.0, border);
    PacketField packets(field);
    const glm::dvec3 center(8.0, 10.0, -20.0);
    packets.SetCenter(center);
    for (int run = 0; run < 200; ++run)
    {
      const double spread[5] = { 0.0, 0.3, 3.0, 8.0, 40.0 };
      const glm::dvec3 middle = random.Point(field, 1.0);
      glm::dvec3 points[16];
      float positions[3][16];
      for (int lane = 0; lane < 16; ++lane)
      {
        // Some runs have two groups of lanes.
        const double cells = spread[run % 5] + (run % 3 == 0 && lane % 4 == 3 ? 10.0 : 0.0);
        points[lane] = middle + cells * random.Vector(-0.5, 0.5) * field.GetSpacing();
        for (int a = 0; a < 3; ++a)
        {
          positions[a][lane] = static_cast<float>(points[lane][a] - center[a]);
          points[lane][a] = static_cast<double>(positions[a][lane]) + center[a];
        }
      }
      ForEveryTarget([&] {
        float values[15][16];
        HWY_DYNAMIC_DISPATCH(EvaluatePositions)(packets, positions, values);
        for (int lane = 0; lane < 16; ++lane)
        {
          glm::dmat3 jacobian;
          const glm::dvec3 displacement = field.Displacement(points[lane], jacobian);
          float same[3][16];
          for (int a = 0; a < 3; ++a)
          {
            std::fill_n(same[a], 16, positions[a][lane]);
            ASSERT_NEAR(values[a][lane], displacement[a], 1e-5);
            ASSERT_EQ(values[12 + a][lane], values[a][lane]);
            for (int row = 0; row < 3; ++row)
            {
              ASSERT_NEAR(values[3 + 3 * a + row][lane], jacobian[a][row], 1e-4);
            }
          }
          float alone[15][16];
          HWY_DYNAMIC_DISPATCH(EvaluatePositions)(packets, same, alone);
          for (int i = 0; i < 15; ++i)
          {
            ASSERT_EQ(alone[i][lane], values[i][lane]) << "lane " << lane << ", number " << i;
          }
        }
      });
    }
  }
}

} // namespace ffd

#endif
