// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "Optics/FFDLabelBlocks.h"
#include "TestVolume.h"

#include <gtest/gtest.h>

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace ffd;

namespace
{

/// Large regions, among them of a label beyond a byte and of one below zero, halves where there
/// are any, and single voxels.
double FindScalar(int i, int j, int k)
{
  if (i == 21 && j == 9 && k == 3)
  {
    return 2.0;
  }
  return i < 8 ? 0.0 : i < 20 ? 1.0 : j < 8 ? 7.0 : k < 8 ? 254.0 : k < 16 ? 255.0 : -3.0;
}

/// The label of a scalar as vtkVolumeProperty's label functions are numbered.
double FindLabel(double scalar, bool isLabelMap)
{
  return !isLabelMap ? (scalar > 0.0 ? 1.0 : 0.0) : std::max(0.0, std::floor(scalar + 0.5));
}

void ExpectLabelsOfAllVoxels(const TestVolume& volume, bool isLabelMap)
{
  const LabelBlocks blocks(volume.View, isLabelMap, ParallelFor());
  const glm::ivec3 size = blocks.GetSize();
  EXPECT_EQ(size, glm::ivec3(4, 3, 3));
  for (int b = 0; b < size.x * size.y * size.z; ++b)
  {
    const glm::ivec3 first = 8 * glm::ivec3(b % size.x, b / size.x % size.y, b / size.x / size.y);
    const glm::ivec3 end = glm::min(first + 8, volume.View.Dimensions);
    const double label = FindLabel(volume.At(first.x, first.y, first.z), isLabelMap);
    bool isCommon = label < LabelBlocks::Mixed;
    volume.ForEach([&](int i, int j, int k) {
      const bool within =
        i >= first.x && j >= first.y && k >= first.z && i < end.x && j < end.y && k < end.z;
      isCommon = isCommon && (!within || FindLabel(volume.At(i, j, k), isLabelMap) == label);
    });
    EXPECT_EQ(blocks.GetLabels()[b], isCommon ? label : LabelBlocks::Mixed) << "block " << b;
  }
}

} // namespace

TEST(LabelBlocks, AreThoseOfAllVoxels)
{
  for (const ScalarType type : AllScalarTypes)
  {
    const TestVolume volume(type, glm::ivec3(30, 19, 18), [&](int i, int j, int k) {
      const double scalar = FindScalar(i, j, k);
      switch (type)
      {
        case ScalarType::Int8:
          return std::min(scalar, 127.0);
        case ScalarType::UInt8:
        case ScalarType::UInt16:
        case ScalarType::UInt32:
        case ScalarType::UInt64:
          return std::max(scalar, 0.0);
        case ScalarType::Float32:
        case ScalarType::Float64:
          return i % 2 == 0 ? scalar + 0.4 : scalar;
        default:
          return scalar;
      }
    });
    for (const bool isLabelMap : { false, true })
    {
      SCOPED_TRACE(::testing::Message() << "type " << static_cast<int>(type) << " " << isLabelMap);
      ExpectLabelsOfAllVoxels(volume, isLabelMap);
    }
  }
}

TEST(LabelBlocks, WhatIsNoNumberHasNoLabel)
{
  const TestVolume volume(ScalarType::Float32, glm::ivec3(8),
    [](int i, int, int) { return i < 4 ? std::numeric_limits<double>::quiet_NaN() : 0.0; });
  for (const bool isLabelMap : { false, true })
  {
    EXPECT_EQ(LabelBlocks(volume.View, isLabelMap, ParallelFor()).GetLabels()[0], 0);
  }
}

TEST(LabelBlocks, NoneWithoutAMask) { EXPECT_EQ(LabelBlocks().GetLabels(), nullptr); }
