// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The basis against closed forms: partition of unity, linear precision, derivatives.
#include "FFDBSplineBasis.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
constexpr int Steps = 64;
}

TEST(BSplineBasis, WeightsArePositiveAndSumToOne)
{
  for (int s = 0; s <= Steps; ++s)
  {
    double w[4];
    ffd::BSplineWeights(static_cast<double>(s) / Steps, w);
    double sum = 0.0;
    for (double weight : w)
    {
      EXPECT_GE(weight, 0.0);
      sum += weight;
    }
    EXPECT_NEAR(sum, 1.0, 1e-15);
  }
}

TEST(BSplineBasis, ReproducesLinearFunctions)
{
  // Control points -1, 0, 1, 2 carry their own index: the spline is u itself.
  for (int s = 0; s <= Steps; ++s)
  {
    const double u = static_cast<double>(s) / Steps;
    double w[4];
    double d[4];
    ffd::BSplineWeights(u, w);
    ffd::BSplineDerivativeWeights(u, d);
    EXPECT_NEAR(-w[0] + w[2] + 2.0 * w[3], u, 1e-15);
    EXPECT_NEAR(-d[0] + d[2] + 2.0 * d[3], 1.0, 1e-15);
    EXPECT_NEAR(d[0] + d[1] + d[2] + d[3], 0.0, 1e-15);
  }
}

TEST(BSplineBasis, KnotValues)
{
  double w[4];
  ffd::BSplineWeights(0.0, w);
  EXPECT_DOUBLE_EQ(w[0], 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(w[1], 4.0 / 6.0);
  EXPECT_DOUBLE_EQ(w[2], 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(w[3], 0.0);
}

TEST(BSplineBasis, DerivativesMatchCentralDifferences)
{
  const double h = 1e-5;
  for (int s = 1; s < Steps; ++s)
  {
    const double u = static_cast<double>(s) / Steps;
    double below[4];
    double above[4];
    double d[4];
    ffd::BSplineWeights(u - h, below);
    ffd::BSplineWeights(u + h, above);
    ffd::BSplineDerivativeWeights(u, d);
    for (int i = 0; i < 4; ++i)
    {
      EXPECT_NEAR((above[i] - below[i]) / (2.0 * h), d[i], 1e-9);
    }
  }
}
