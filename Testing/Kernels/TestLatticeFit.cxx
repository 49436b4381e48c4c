// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Fits: exact cases, a dense least-squares solution as reference, noise, limits.
#include "FFDBSplineField.h"
#include "FFDLatticeFit.h"

#include <glm/mat3x3.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <thread>

namespace
{

using ffd::FitStatus;

ffd::FittedNet MakeBox()
{
  ffd::FittedNet fit;
  fit.Lower = { -1.0, 2.0, 5.0 };
  fit.Extent = { 4.0, 3.0, 8.0 };
  return fit;
}

ffd::BSplineField FieldOf(const ffd::FittedNet& fit)
{
  return ffd::BSplineField(fit.Net.Nodes, fit.GetOrigin(), fit.GetSpacing(), fit.Net.Values.data());
}

double Length(const glm::dvec3& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

struct Random
{
  std::mt19937 Engine{ 1 };
  double operator()(double low, double high)
  {
    return std::uniform_real_distribution<double>(low, high)(this->Engine);
  }
  glm::dvec3 Point(const ffd::FittedNet& box)
  {
    return box.Lower + box.Extent * glm::dvec3((*this)(0, 1), (*this)(0, 1), (*this)(0, 1));
  }
};

const glm::dmat3 Matrix(0.1, -0.2, 0.05, 0.3, 0.02, -0.1, -0.15, 0.25, 0.08);

glm::dvec3 Affine(const glm::dvec3& p) { return Matrix * p + glm::dvec3(1.0, -2.0, 3.0); }

glm::dvec3 Smooth(const glm::dvec3& p)
{
  return { std::sin(0.7 * p.x) * std::cos(0.3 * p.z), 0.2 * std::sin(p.y + 0.4 * p.z),
    0.3 * std::cos(0.5 * p.x * p.y) };
}

template <typename Function>
void MakeGrid(const ffd::FittedNet& box, const glm::ivec3& count, const Function& function,
  glm::dvec3& step, std::vector<glm::dvec3>& values)
{
  step = box.Extent / glm::dvec3(count - 1);
  values.clear();
  for (int k = 0; k < count.z; ++k)
  {
    for (int j = 0; j < count.y; ++j)
    {
      for (int i = 0; i < count.x; ++i)
      {
        values.push_back(function(box.Lower + glm::dvec3(i, j, k) * step));
      }
    }
  }
}

TEST(LatticeFit, AffineLandmarksGiveTheAffineMapEverywhere)
{
  Random random;
  ffd::FittedNet fit = MakeBox();
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> displacements;
  for (int i = 0; i < 5; ++i)
  {
    points.push_back(random.Point(fit));
    displacements.push_back(Affine(points.back()));
  }
  EXPECT_EQ(ffd::FitNetToPoints(points, displacements, {}, 1e-6, { 1e-9, 64, {}, {} }, fit),
    FitStatus::Reached);
  EXPECT_EQ(fit.Cells, glm::ivec3(1));
  for (int i = 0; i < 100; ++i)
  {
    const glm::dvec3 p = random.Point(fit);
    EXPECT_LT(Length(FieldOf(fit).Displacement(p) - Affine(p)), 1e-10);
  }
}

TEST(LatticeFit, FewLandmarksGiveTheSmallestAffineMap)
{
  ffd::FittedNet fit = MakeBox();
  // One: a translation.
  EXPECT_EQ(ffd::FitNetToPoints(
              { { 0.0, 3.0, 6.0 } }, { { 1.0, 2.0, 3.0 } }, {}, 0.0, { 1e-9, 64, {}, {} }, fit),
    FitStatus::Reached);
  EXPECT_LT(Length(FieldOf(fit).Displacement({ 2.5, 2.5, 12.0 }) - glm::dvec3(1, 2, 3)), 1e-12);
  // Two on a line along x: what lies across the line moves with it.
  EXPECT_EQ(ffd::FitNetToPoints({ { 0.0, 3.0, 6.0 }, { 2.0, 3.0, 6.0 } },
              { { 0.0, 1.0, 0.0 }, { 1.0, 1.0, 0.5 } }, {}, 0.0, { 1e-9, 64, {}, {} }, fit),
    FitStatus::Reached);
  EXPECT_LT(
    Length(FieldOf(fit).Displacement({ 1.0, 4.5, 11.0 }) - glm::dvec3(0.5, 1.0, 0.25)), 1e-12);
}

TEST(LatticeFit, LevelsReachTheToleranceAtLandmarks)
{
  Random random;
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> displacements;
  const ffd::FittedNet box = MakeBox();
  for (int i = 0; i < 200; ++i)
  {
    points.push_back(random.Point(box));
    displacements.push_back(Smooth(points.back()));
  }
  int cells = 0;
  double error = 1e9;
  for (const double tolerance : { 0.1, 1e-2, 1e-3 })
  {
    ffd::FittedNet fit = box;
    ASSERT_EQ(ffd::FitNetToPoints(points, displacements, {}, 1e-8, { tolerance, 32, {}, {} }, fit),
      FitStatus::Reached);
    EXPECT_LE(fit.LargestError, tolerance);
    EXPECT_LE(fit.RootMeanSquareError, fit.LargestError);
    EXPECT_GE(fit.Cells.x, cells);
    cells = fit.Cells.x;
    double largest = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      largest = std::max(largest, Length(FieldOf(fit).Displacement(points[i]) - displacements[i]));
    }
    EXPECT_NEAR(largest, fit.LargestError, 1e-12);
    // Between the landmarks the smooth map is followed, too, and better and better.
    double between = 0.0;
    for (int i = 0; i < 300; ++i)
    {
      const glm::dvec3 p =
        box.Lower + box.Extent * (0.15 + 0.7 * (random.Point(box) - box.Lower) / box.Extent);
      between += Length(FieldOf(fit).Displacement(p) - Smooth(p)) / 300.0;
    }
    EXPECT_LT(between, 0.1);
    EXPECT_LT(between, 1.2 * error);
    error = between;
  }
}

TEST(LatticeFit, SmoothnessAndWeightsCount)
{
  Random random;
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> displacements;
  std::vector<double> weights;
  const ffd::FittedNet box = MakeBox();
  for (int i = 0; i < 60; ++i)
  {
    points.push_back(random.Point(box));
    displacements.push_back(Smooth(points.back()));
    weights.push_back(i == 7 ? 1000.0 : 1.0);
  }
  ffd::FittedNet loose = box;
  ffd::FittedNet stiff = box;
  ffd::FittedNet weighted = box;
  EXPECT_EQ(ffd::FitNetToPoints(points, displacements, {}, 1e-6, { 1e-12, 2, {}, {} }, loose),
    FitStatus::NotReached);
  EXPECT_EQ(ffd::FitNetToPoints(points, displacements, {}, 10.0, { 1e-12, 2, {}, {} }, stiff),
    FitStatus::NotReached);
  EXPECT_EQ(
    ffd::FitNetToPoints(points, displacements, weights, 10.0, { 1e-12, 2, {}, {} }, weighted),
    FitStatus::NotReached);
  EXPECT_GT(stiff.RootMeanSquareError, 2.0 * loose.RootMeanSquareError);
  const auto errorAt7 = [&](const ffd::FittedNet& fit) {
    return Length(FieldOf(fit).Displacement(points[7]) - displacements[7]);
  };
  EXPECT_LT(errorAt7(weighted), 0.1 * errorAt7(stiff));
}

/// The bending energy has no preferred direction: x^2 - y^2 is 2 x y turned by 45 degrees, so a
/// stiff net follows both as little.
TEST(LatticeFit, BendingIsTheSameInAllDirections)
{
  Random random;
  ffd::FittedNet box;
  box.Lower = glm::dvec3(-1.0);
  box.Extent = glm::dvec3(2.0);
  std::vector<glm::dvec3> points;
  while (points.size() < 600)
  {
    const glm::dvec3 p = random.Point(box);
    if (Length(p) < 1.0)
    {
      points.push_back(p);
      points.emplace_back(std::sqrt(0.5) * (p.x - p.y), std::sqrt(0.5) * (p.x + p.y), p.z);
    }
  }
  double followed[2];
  for (const int which : { 0, 1 })
  {
    std::vector<glm::dvec3> displacements;
    for (const glm::dvec3& p : points)
    {
      displacements.emplace_back(which == 0 ? p.x * p.x - p.y * p.y : 2.0 * p.x * p.y, 0.0, 0.0);
    }
    // One so stiff that only what needs no bending is followed, and one that gives way a little.
    double left[2];
    for (const int stiff : { 0, 1 })
    {
      ffd::FittedNet fit = box;
      EXPECT_EQ(ffd::FitNetToPoints(
                  points, displacements, {}, stiff ? 1e4 : 1.0, { 1e-12, 8, {}, {} }, fit),
        FitStatus::NotReached);
      left[stiff] = fit.RootMeanSquareError;
    }
    followed[which] = 1.0 - left[0] / left[1];
  }
  EXPECT_GT(followed[0], 1e-4);
  EXPECT_NEAR(followed[1] / followed[0], 1.0, 0.1);
}

/// Largest and root mean square distance of the result from the displacements, as it is evaluated.
void ExpectTrueErrors(const ffd::FittedNet& fit, const std::vector<glm::dvec3>& points,
  const std::vector<glm::dvec3>& displacements)
{
  double largest = 0.0;
  double squares = 0.0;
  const ffd::BSplineField field = FieldOf(fit);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const double error = Length(field.Displacement(points[i]) - displacements[i]);
    largest = std::max(largest, error);
    squares += error * error / static_cast<double>(points.size());
  }
  EXPECT_NEAR(fit.LargestError, largest, 1e-12 * (1.0 + largest));
  EXPECT_NEAR(fit.RootMeanSquareError, std::sqrt(squares), 1e-12 * (1.0 + largest));
}

TEST(LatticeFit, ContradictionsAreAveraged)
{
  // Each point twice, with displacements +-e around a smooth one: the best that there is leaves e.
  Random random;
  const ffd::FittedNet box = MakeBox();
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> displacements;
  double squares = 0.0;
  for (int i = 0; i < 30; ++i)
  {
    const glm::dvec3 p = random.Point(box);
    const glm::dvec3 e(random(-1, 1), random(-1, 1), random(-1, 1));
    points.insert(points.end(), 2, p);
    displacements.push_back(Smooth(p) + e);
    displacements.push_back(Smooth(p) - e);
    squares += Length(e) * Length(e) / 30.0;
  }
  const double possible = std::sqrt(squares);
  for (const double smoothness : { 0.0, 1e-12, 1e-6 })
  {
    double last = 1e300;
    for (const int cells : { 1, 2, 4, 8, 16 })
    {
      ffd::FittedNet fit = box;
      EXPECT_EQ(
        ffd::FitNetToPoints(points, displacements, {}, smoothness, { 1e-3, cells, {}, {} }, fit),
        FitStatus::NotReached);
      ExpectTrueErrors(fit, points, displacements);
      EXPECT_GE(fit.RootMeanSquareError, possible - 1e-9);
      EXPECT_LE(fit.RootMeanSquareError, last) << "finer is worse, " << cells;
      last = fit.RootMeanSquareError;
    }
    EXPECT_LT(last, 1.01 * possible) << smoothness;
  }
}

TEST(LatticeFit, ContradictionsTakeNoLongerOnFineLevels)
{
  // Landmarks each with a second one close by that is to go elsewhere: no level resolves them, and
  // all are tried. The iterations of the finest level must not grow with its control points.
  Random random;
  ffd::FittedNet fit = MakeBox();
  const ffd::FittedNet box = fit;
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> displacements;
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto vector = [&] {
    return glm::dvec3(normal(random.Engine), normal(random.Engine), normal(random.Engine));
  };
  for (int i = 0; i < 60; ++i)
  {
    points.push_back(random.Point(box));
    displacements.push_back(0.1 * vector());
    points.push_back(points.back() + 0.1 * vector());
    displacements.push_back(displacements.back() + vector());
  }
  int iterations = 0;
  ffd::FitLimits limits{ 1e-3, 32, {}, {} };
  limits.Proceed = [&](double) {
    ++iterations;
    return true;
  };
  ffd::FitNetToPoints(points, displacements, {}, 1e-6, limits, fit);
  EXPECT_EQ(fit.Cells.x, 32);
  EXPECT_LT(iterations, 1000);
  // Threads change nothing.
  limits.MaximumCells = 16;
  ffd::FitNetToPoints(points, displacements, {}, 1e-6, limits, fit = box);
  ffd::FittedNet threaded = box;
  limits.Parallel = ffd::ParallelFor([](std::size_t count, const ffd::ParallelFor::Work& work) {
    std::thread second(work, count / 3, count);
    work(0, count / 3);
    second.join();
  });
  ffd::FitNetToPoints(points, displacements, {}, 1e-6, limits, threaded);
  EXPECT_EQ(threaded.Net.Values, fit.Net.Values);
}

TEST(LatticeFit, NoiseIsFollowedNoFurtherThanTheTolerance)
{
  Random random;
  const ffd::FittedNet box = MakeBox();
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> displacements;
  constexpr double noise = 0.2; // per axis: 0.35 a vector
  std::normal_distribution<double> normal(0.0, noise);
  for (int i = 0; i < 100; ++i)
  {
    points.push_back(random.Point(box));
    displacements.push_back(Smooth(points.back()) +
      glm::dvec3(normal(random.Engine), normal(random.Engine), normal(random.Engine)));
  }
  const auto errorBetween = [&](const ffd::FittedNet& fit) {
    Random other;
    double squares = 0.0;
    for (int i = 0; i < 1000; ++i)
    {
      const glm::dvec3 p = other.Point(box);
      const double error = Length(FieldOf(fit).Displacement(p) - Smooth(p));
      squares += error * error / 1000.0;
    }
    return std::sqrt(squares);
  };
  // Asked to follow the noise, it is followed at the landmarks, and hardly amplified between them.
  ffd::FittedNet close = box;
  ffd::FitNetToPoints(points, displacements, {}, 1e-6, { 0.1, 16, {}, {} }, close);
  ExpectTrueErrors(close, points, displacements);
  EXPECT_LT(close.RootMeanSquareError, 0.1);
  EXPECT_LT(errorBetween(close), 1.5 * std::sqrt(3.0) * noise);
  // Asked for its size, it is averaged.
  ffd::FittedNet smooth = box;
  EXPECT_EQ(ffd::FitNetToPoints(points, displacements, {}, 1e-6,
              { 3.0 * std::sqrt(3.0) * noise, 16, {}, {} }, smooth),
    FitStatus::Reached);
  ExpectTrueErrors(smooth, points, displacements);
  EXPECT_LT(errorBetween(smooth), std::sqrt(3.0) * noise);
}

TEST(LatticeFit, PointsOutOfTheBoxAndDegenerateOnes)
{
  Random random;
  ffd::FittedNet box = MakeBox();
  const auto fitTo = [&](const std::vector<glm::dvec3>& points, double tolerance, int cells) {
    std::vector<glm::dvec3> displacements;
    for (const glm::dvec3& p : points)
    {
      displacements.push_back(Smooth(p));
    }
    ffd::FittedNet fit = box;
    const FitStatus status =
      ffd::FitNetToPoints(points, displacements, {}, 1e-6, { tolerance, cells, {}, {} }, fit);
    ExpectTrueErrors(fit, points, displacements);
    for (const glm::dvec3& value : fit.Net.Values)
    {
      EXPECT_LT(Length(value), 20.0);
    }
    return status;
  };
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 60; ++i)
  {
    points.push_back(box.Lower - 0.3 * box.Extent + 1.6 * (random.Point(box) - box.Lower));
  }
  fitTo(points, 0.05, 16);
  points.clear();
  for (int i = 0; i < 15; ++i)
  {
    points.push_back(box.Lower + box.Extent * (i / 14.0)); // collinear
  }
  EXPECT_EQ(fitTo(points, 0.05, 16), FitStatus::Reached);
  points.assign(1, box.Lower);
  EXPECT_EQ(fitTo(points, 1e-9, 16), FitStatus::Reached);
  points.clear();
  for (int i = 0; i < 100; ++i)
  {
    points.push_back(box.Lower + 0.5 * box.Extent + 1e-3 * random.Point(box)); // a cluster
  }
  EXPECT_EQ(fitTo(points, 1e-3, 16), FitStatus::Reached);
  points.clear();
  for (int i = 0; i < 10000; ++i)
  {
    points.push_back(random.Point(box));
  }
  EXPECT_EQ(fitTo(points, 0.5, 4), FitStatus::Reached);
}

TEST(LatticeFit, LandmarksNearAPlaneTellNoGradientAcrossIt)
{
  // Four put on the face of a volume that is seen, and where they shall be: an affine map meets
  // them exactly, and turns the volume inside out behind the face.
  const std::vector<glm::dvec3> points = { { 37.6812, 48.0372, 59.0 }, { 9.63496, 48.314, 54.5274 },
    { 9.62335, 10.4647, 54.3497 }, { 37.6812, 10.7557, 59.0 } };
  const std::vector<glm::dvec3> targets = { { 43.4147, 45.8307, 59.0 },
    { 15.8299, 47.5113, 58.8781 }, { 9.61016, 10.3695, 54.2635 }, { 30.0435, 10.7314, 59.0 } };
  std::vector<glm::dvec3> displacements;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    displacements.push_back(targets[i] - points[i]);
  }
  ffd::FittedNet fit;
  fit.Extent = glm::dvec3(59.0);
  ASSERT_EQ(ffd::FitNetToPoints(points, displacements, {}, 1e-6, { 0.1, 64, {}, {} }, fit),
    FitStatus::Reached);
  ExpectTrueErrors(fit, points, displacements);
  Random random;
  for (int i = 0; i < 1000; ++i)
  {
    const glm::dvec3 p = random.Point(fit);
    const glm::dvec3 d = FieldOf(fit).Displacement(p);
    EXPECT_LT(Length(d), 20.0); // they are up to 8
    // Nothing is turned over.
    for (int a = 0; a < 3; ++a)
    {
      glm::dvec3 q = p;
      q[a] += 1e-3;
      EXPECT_GT(1.0 + (FieldOf(fit).Displacement(q) - d)[a] / 1e-3, 0.2) << a;
    }
  }
  // Many in a thin slab do tell it.
  std::vector<glm::dvec3> slab;
  displacements.clear();
  for (int i = 0; i < 100; ++i)
  {
    slab.push_back(random.Point(fit));
    slab.back().z = 30.0 + 0.03 * slab.back().z;
    displacements.push_back(Affine(slab.back()));
  }
  ASSERT_EQ(ffd::FitNetToPoints(slab, displacements, {}, 1e-6, { 1e-3, 64, {}, {} }, fit),
    FitStatus::Reached);
  const auto at = [&fit](double z) { return FieldOf(fit).Displacement({ 20.0, 30.0, z }); };
  EXPECT_LT(Length(at(31.5) - at(30.2) - Matrix * glm::dvec3(0.0, 0.0, 1.3)), 5e-3);
}

TEST(LatticeFit, GridOfASplineGivesTheSplineBack)
{
  // 8 cells: the samples of a spline on that net are reproduced by it.
  Random random;
  ffd::FittedNet truth = MakeBox();
  truth.Cells = glm::ivec3(8);
  truth.Net.Nodes = truth.Cells + 3;
  for (int i = 0; i < 11 * 11 * 11; ++i)
  {
    truth.Net.Values.emplace_back(random(-1, 1), random(-1, 1), random(-1, 1));
  }
  const ffd::BSplineField field = FieldOf(truth);
  const glm::ivec3 count(33, 30, 41);
  glm::dvec3 step;
  std::vector<glm::dvec3> values;
  MakeGrid(
    truth, count, [&](const glm::dvec3& p) { return field.Displacement(p); }, step, values);
  ffd::FittedNet fit = MakeBox();
  ASSERT_EQ(ffd::FitNetToGrid(count, fit.Lower, step, values, { 1e-4, 64, {}, {} }, fit),
    FitStatus::Reached);
  EXPECT_EQ(fit.Cells, glm::ivec3(8));
  for (std::size_t i = 0; i < fit.Net.Values.size(); ++i)
  {
    EXPECT_LT(Length(fit.Net.Values[i] - truth.Net.Values[i]), 1e-3);
  }
}

TEST(LatticeFit, GridFitIsTheLeastSquaresOne)
{
  // At the minimum every small change of a coefficient makes the sum of squares larger.
  Random random;
  ffd::FittedNet fit = MakeBox();
  const glm::ivec3 count(12, 11, 13);
  glm::dvec3 step;
  std::vector<glm::dvec3> values;
  MakeGrid(
    fit, count,
    [&](const glm::dvec3& p) {
      return Smooth(p) + glm::dvec3(random(-1, 1), random(-1, 1), random(-1, 1));
    },
    step, values);
  ASSERT_EQ(ffd::FitNetToGrid(count, fit.Lower, step, values, { 1e-9, 4, {}, {} }, fit),
    FitStatus::NotReached);
  const auto squares = [&](const ffd::FittedNet& net) {
    const ffd::BSplineField field = FieldOf(net);
    double sum = 0.0;
    std::size_t id = 0;
    for (int k = 0; k < count.z; ++k)
    {
      for (int j = 0; j < count.y; ++j)
      {
        for (int i = 0; i < count.x; ++i)
        {
          const glm::dvec3 d =
            field.Displacement(net.Lower + glm::dvec3(i, j, k) * step) - values[id++];
          sum += d.x * d.x + d.y * d.y + d.z * d.z;
        }
      }
    }
    return sum;
  };
  const double best = squares(fit);
  EXPECT_NEAR(std::sqrt(best / static_cast<double>(values.size())), fit.RootMeanSquareError, 1e-12);
  for (int trial = 0; trial < 40; ++trial)
  {
    ffd::FittedNet other = fit;
    const std::size_t id = static_cast<std::size_t>(random(0, 342.99));
    other.Net.Values[id][trial % 3] += trial % 2 == 0 ? 1e-2 : -1e-2;
    EXPECT_GT(squares(other), best - 1e-9);
  }
}

TEST(LatticeFit, CoarseGridsAndPartsOfGrids)
{
  // Three samples an axis, more control points than samples: still the affine map.
  ffd::FittedNet fit = MakeBox();
  glm::dvec3 step;
  std::vector<glm::dvec3> values;
  MakeGrid(fit, glm::ivec3(3), Affine, step, values);
  EXPECT_EQ(ffd::FitNetToGrid(glm::ivec3(3), fit.Lower, step, values, { 1e-6, 64, {}, {} }, fit),
    FitStatus::Reached);
  EXPECT_LT(Length(FieldOf(fit).Displacement({ 1.3, 3.3, 9.9 }) - Affine({ 1.3, 3.3, 9.9 })), 1e-5);
  // A grid that is larger than the box.
  const glm::ivec3 count(40, 40, 40);
  const glm::dvec3 first = fit.Lower - 0.3 * fit.Extent;
  step = 1.6 * fit.Extent / 39.0;
  values.clear();
  for (int i = 0; i < 64000; ++i)
  {
    values.push_back(Smooth(first + step * glm::dvec3(i % 40, i / 40 % 40, i / 1600)));
  }
  fit = MakeBox();
  EXPECT_EQ(
    ffd::FitNetToGrid(count, first, step, values, { 1e-3, 64, {}, {} }, fit), FitStatus::Reached);
  EXPECT_LT(Length(FieldOf(fit).Displacement({ 1.3, 3.3, 9.9 }) - Smooth({ 1.3, 3.3, 9.9 })), 1e-2);
  // One that does not touch it.
  EXPECT_EQ(ffd::FitNetToGrid(count, first + 1000.0, step, values, { 1e-3, 64, {}, {} }, fit),
    FitStatus::NotFinite);
}

TEST(LatticeFit, NotFiniteAndStopped)
{
  ffd::FittedNet fit = MakeBox();
  const std::vector<glm::dvec3> points = { fit.Lower, fit.Lower + 1.0, fit.Lower + 2.0 };
  std::vector<glm::dvec3> displacements(3, glm::dvec3(0.0));
  displacements[1].y = std::nan("");
  EXPECT_EQ(ffd::FitNetToPoints(points, displacements, {}, 1e-6, { 1e-3, 8, {}, {} }, fit),
    FitStatus::NotFinite);
  displacements[1].y = 5.0;
  EXPECT_EQ(ffd::FitNetToPoints(
              points, displacements, {}, 1e-6, { 1e-3, 8, [](double) { return false; } }, fit),
    FitStatus::Stopped);
  std::vector<glm::dvec3> values(27, glm::dvec3(std::nan("")));
  EXPECT_EQ(
    ffd::FitNetToGrid(glm::ivec3(3), fit.Lower, glm::dvec3(1.0), values, { 1e-3, 8, {}, {} }, fit),
    FitStatus::NotFinite);
}

} // namespace
