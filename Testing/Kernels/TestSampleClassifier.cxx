// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "Optics/FFDSampleClassifier.h"

#include "FFDAxisMap.h"
#include "FFDDistanceMap.h"
#include "RandomLattice.h"
#include "TestVolume.h"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

using namespace ffd;

namespace
{

constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

/// Several components of floats, side by side.
class Components
{
public:
  using Function = std::function<double(int component, const glm::dvec3& index)>;

  Components(const glm::ivec3& dimensions, int count, const Function& function)
    : Data(static_cast<std::size_t>(count) * dimensions.x * dimensions.y * dimensions.z)
  {
    this->View.Scalars = this->Data.data();
    this->View.Type = ScalarType::Float32;
    this->View.Dimensions = dimensions;
    this->View.Components = count;
    this->View.Increments[0] = count;
    this->View.Increments[1] = count * dimensions.x;
    this->View.Increments[2] = this->View.Increments[1] * dimensions.y;
    std::size_t at = 0;
    for (int k = 0; k < dimensions.z; ++k)
    {
      for (int j = 0; j < dimensions.y; ++j)
      {
        for (int i = 0; i < dimensions.x; ++i)
        {
          for (int c = 0; c < count; ++c)
          {
            this->Data[at++] = static_cast<float>(function(c, glm::dvec3(i, j, k)));
          }
        }
      }
    }
  }
  VolumeView View;

private:
  std::vector<float> Data;
};

TransferTable Constant(const glm::vec3& color, float opacity, double unit = 1.0)
{
  const float rgb[6] = { color.r, color.g, color.b, color.r, color.g, color.b };
  const float opacities[2] = { opacity, opacity };
  return TransferTable(0.0, 1.0, 2, rgb, opacities, unit);
}

/// Opacity rises from 0 at 0 to `top` at 1, color from black to `color`.
TransferTable Ramp(const glm::vec3& color, double top, double unit = 1.0)
{
  constexpr std::size_t N = 4001;
  std::vector<float> rgb(3 * N);
  std::vector<float> opacities(N);
  for (std::size_t i = 0; i < N; ++i)
  {
    const double x = static_cast<double>(i) / (N - 1);
    for (int c = 0; c < 3; ++c)
    {
      rgb[3 * i + static_cast<std::size_t>(c)] = static_cast<float>(x * color[c]);
    }
    opacities[i] = static_cast<float>(x * top);
  }
  return TransferTable(0.0, 1.0, N, rgb.data(), opacities.data(), unit);
}

/// Light along z at (0, 0, 1) as seen from +z; the volume is not deformed.
class StraightNormals : public NormalSource
{
public:
  StraightNormals()
    : NormalSource(Ray, Camera, 0.0)
  {
    this->Camera.Parallel = false;
    this->Ray.Origin = glm::dvec3(0.0, 0.0, 100.0);
    this->Ray.Direction = glm::dvec3(0.0, 0.0, -1.0);
  }
  glm::dvec3 ToDeformed(const glm::dvec3& byIndex) const override
  {
    ++this->Asked;
    return byIndex;
  }
  mutable int Asked = 0;

private:
  ViewRay Ray{};
  CameraView Camera;
};

double OpacityOf(const SampleClassifier::Appearance& sample, double length)
{
  return 1.0 - std::exp2(-static_cast<double>(sample.Extinction) * length);
}

struct Fixture
{
  OpticalFunctions Functions;
  Shading Lights;
  ClassifierInputs Inputs;
  StraightNormals Normals;

  explicit Fixture(const VolumeView& volume)
  {
    this->Inputs.Volume = volume;
    this->Inputs.Functions = &this->Functions;
    this->Inputs.Material = &this->Lights;
    Light headlight;
    headlight.Headlight = true;
    headlight.Ambient = glm::vec3(1.0f);
    this->Lights.Lights.push_back(headlight);
  }
  SampleClassifier::Appearance Classify(const glm::dvec3& q)
  {
    const SampleClassifier classifier(this->Inputs);
    double values[SampleClassifier::LargestNumberOfComponents];
    classifier.Values(q, values);
    return classifier.Classify(q, values, this->Normals);
  }
};

void ExpectColor(const glm::vec3& a, const glm::dvec3& b, double tolerance = 1e-5)
{
  EXPECT_LE(glm::length(glm::dvec3(a) - b), tolerance)
    << a.x << " " << a.y << " " << a.z << " against " << b.x << " " << b.y << " " << b.z;
}

} // namespace

TEST(SampleClassifier, OnePlainComponentIsItsTable)
{
  const Components volume(glm::ivec3(4), 1, [](int, const glm::dvec3& p) { return p.x / 3.0; });
  Fixture f(volume.View);
  f.Functions.Components.resize(1);
  f.Functions.Components[0].Table = Ramp({ 1.0f, 0.5f, 0.25f }, 0.8);
  const SampleClassifier classifier(f.Inputs);
  for (double x = 0.0; x <= 3.0; x += 0.3)
  {
    const SampleClassifier::Appearance sample = f.Classify({ x, 1.5, 1.5 });
    EXPECT_NEAR(OpacityOf(sample, 1.0), 0.8 * x / 3.0, 1e-5);
    ExpectColor(sample.Color, glm::dvec3(1.0, 0.5, 0.25) * (x / 3.0));
    const glm::vec4 value = classifier.ClassifyValue(0, x / 3.0);
    EXPECT_NEAR(value.a, 0.8 * x / 3.0, 1e-5);
  }
  EXPECT_EQ(f.Normals.Asked, 0);
}

TEST(SampleClassifier, IndependentComponentsAddUpAsInVtk)
{
  // Opacities over the reference length: 0.6 and, weighted by one half, 0.15.
  const double length = 0.5;
  const Components volume(glm::ivec3(4), 2, [](int, const glm::dvec3&) { return 0.0; });
  Fixture f(volume.View);
  f.Inputs.ReferenceLength = length;
  f.Functions.Components.resize(2);
  // Units differ: 1 - (1 - 0.84)^(0.5 / 1) = 0.6, 1 - (1 - 0.51)^(0.5 / 1) = 0.3.
  f.Functions.Components[0].Table = Constant({ 1.0f, 0.0f, 0.2f }, 0.84f);
  f.Functions.Components[1].Table = Constant({ 0.0f, 1.0f, 0.4f }, 0.51f);
  f.Functions.Components[1].Weight = 0.5f;
  const SampleClassifier::Appearance sample = f.Classify(glm::dvec3(1.5));
  const double opacity = (0.6 * 0.6 + 0.15 * 0.15) / 0.75;
  EXPECT_NEAR(OpacityOf(sample, length), opacity, 1e-5);
  ExpectColor(sample.Color * static_cast<float>(opacity),
    glm::dvec3(0.6, 0.15, 0.2 * 0.6 + 0.4 * 0.15), 1e-5);

  f.Functions.Components[0].Weight = 0.0f;
  EXPECT_NEAR(OpacityOf(f.Classify(glm::dvec3(1.5)), length), 0.15, 1e-5);
  f.Functions.Components[1].Weight = 0.0f;
  EXPECT_EQ(f.Classify(glm::dvec3(1.5)).Extinction, 0.0f);
}

TEST(SampleClassifier, EachComponentHasItsOwnSurfaceAndNormal)
{
  // The first rises along z, towards the eye; the second along x: headlights do not reach it.
  const Components volume(
    glm::ivec3(6), 2, [](int c, const glm::dvec3& p) { return (c == 0 ? p.z : p.x) / 5.0; });
  Fixture f(volume.View);
  f.Functions.Components.resize(2);
  for (ComponentOptics& component : f.Functions.Components)
  {
    component.Table = Constant(glm::vec3(1.0f), 0.5f);
    component.Surface.Ambient = 0.25f;
    component.Surface.Diffuse = 0.5f;
    component.Surface.Specular = 0.0f;
  }
  const glm::dvec3 q(2.5);
  f.Functions.Components[0].Shade = true;
  f.Functions.Components[1].Weight = 0.0f;
  ExpectColor(f.Classify(q).Color, glm::dvec3(0.75));
  f.Functions.Components[0].Surface.Diffuse = 0.125f;
  ExpectColor(f.Classify(q).Color, glm::dvec3(0.375));
  f.Functions.Components[0].Weight = 0.0f;
  f.Functions.Components[1].Weight = 1.0f;
  ExpectColor(f.Classify(q).Color, glm::dvec3(1.0));
  f.Functions.Components[1].Shade = true;
  ExpectColor(f.Classify(q).Color, glm::dvec3(0.25));
}

TEST(SampleClassifier, GradientOpacityOfALinearField)
{
  // The gradient by scalar units per mean edge: edges 1, 2, 3, mean 2.
  const glm::dvec3 slope(0.02, 0.03, 0.06);
  const Components volume(
    glm::ivec3(8), 1, [&](int, const glm::dvec3& p) { return glm::dot(slope, p); });
  Fixture f(volume.View);
  f.Inputs.Volume.IndexToData =
    glm::dmat3(glm::dvec3(1, 0, 0), glm::dvec3(0, 2, 0), glm::dvec3(0, 0, 3));
  const double magnitude = glm::length(slope * glm::dvec3(2.0, 1.0, 2.0 / 3.0));
  f.Functions.Components.resize(1);
  f.Functions.Components[0].Table = Constant(glm::vec3(1.0f), 0.75f, 2.0);
  f.Functions.Components[0].Gradients = GradientOpacity({ 0.0f, 1.0f }, 0.2);
  f.Inputs.ReferenceLength = 1.0;
  // 1 - (1 - 0.75)^(1 / 2) = 0.5 is what the factor is multiplied to.
  EXPECT_NEAR(OpacityOf(f.Classify(glm::dvec3(3.3)), 1.0), 0.5 * magnitude / 0.2, 1e-6);
  // Beyond the largest magnitude the last factor holds; none leaves the opacity as it is.
  f.Functions.Components[0].Gradients = GradientOpacity({ 0.0f, 0.5f }, 0.5 * magnitude);
  EXPECT_NEAR(OpacityOf(f.Classify(glm::dvec3(3.3)), 1.0), 0.25, 1e-6);
  f.Functions.Components[0].Gradients = GradientOpacity({ 0.0f, 0.0f }, 1.0);
  EXPECT_EQ(f.Classify(glm::dvec3(3.3)).Extinction, 0.0f);
  f.Functions.Components[0].Gradients = GradientOpacity();
  EXPECT_NEAR(OpacityOf(f.Classify(glm::dvec3(3.3)), 2.0), 0.75, 1e-6);
}

TEST(SampleClassifier, DependentComponents)
{
  const Components volume(glm::ivec3(4), 4,
    [](int c, const glm::dvec3& p) { return c == 3 ? p.z / 3.0 : 50.0 * (c + 1); });
  Fixture f(volume.View);
  f.Functions.Components.resize(1);
  f.Functions.Components[0].Table = Ramp(glm::vec3(0.0f), 0.9);
  f.Functions.Kind = ComponentKind::Rgba;
  f.Functions.ColorScale = 1.0 / 255.0;
  SampleClassifier::Appearance sample = f.Classify({ 1.0, 1.0, 1.5 });
  ExpectColor(sample.Color, glm::dvec3(50.0, 100.0, 150.0) / 255.0);
  EXPECT_NEAR(OpacityOf(sample, 1.0), 0.45, 1e-5);

  // The luminance of three.
  f.Inputs.Volume.Components = 3;
  f.Functions.Kind = ComponentKind::Rgb;
  f.Functions.Components[0].Table = TransferTable(0.0, 200.0, 2, std::vector<float>(6, 0.0f).data(),
    std::vector<float>({ 0.3f, 0.3f }).data(), 1.0);
  sample = f.Classify({ 1.0, 1.0, 1.5 });
  EXPECT_NEAR(OpacityOf(sample, 1.0), 0.3, 1e-5);
  MinMaxBlocks::Limits limits[3] = { { 50.0, 50.0 }, { 100.0, 100.0 }, { 150.0, 150.0 } };
  EXPECT_FALSE(f.Functions.IsTransparent(limits));

  // Color by the first, opacity by the second.
  const Components two(
    glm::ivec3(4), 2, [](int c, const glm::dvec3& p) { return c == 0 ? p.x / 3.0 : p.y / 3.0; });
  f.Inputs.Volume = two.View;
  f.Functions.Kind = ComponentKind::ColorOpacity;
  f.Functions.Colors = Ramp({ 1.0f, 0.5f, 0.0f }, 1.0);
  f.Functions.Components[0].Table = Ramp(glm::vec3(0.0f), 0.6);
  sample = f.Classify({ 2.0, 1.0, 1.0 });
  ExpectColor(sample.Color, glm::dvec3(2.0, 1.0, 0.0) / 3.0);
  EXPECT_NEAR(OpacityOf(sample, 1.0), 0.2, 1e-5);
}

TEST(SampleClassifier, ChannelsOfDependentComponents)
{
  const double values[4] = { 51.0, 102.0, 204.0, 0.5 };
  const Components volume(glm::ivec3(5), 4, [](int c, const glm::dvec3& p) {
    return c == 0 ? 9.0 * p.x : c == 3 ? 0.2 * p.z : 0.0;
  });
  Fixture f(volume.View);
  f.Functions.Components.resize(1);
  f.Functions.Components[0].Table = Ramp(glm::vec3(0.0f), 0.8);
  f.Functions.Kind = ComponentKind::Rgba;
  f.Functions.ColorScale = 1.0 / 255.0;
  {
    const SampleClassifier classifier(f.Inputs);
    EXPECT_EQ(classifier.GetNumberOfChannels(), 1);
    EXPECT_EQ(classifier.FindIntensity(0, values), 51.0);
    EXPECT_EQ(classifier.FindDensity(0, values), 0.5);
    const glm::vec4 sample = classifier.ClassifyValues(0, values);
    ExpectColor(glm::vec3(sample), glm::dvec3(0.2, 0.4, 0.8));
    EXPECT_NEAR(sample.a, 0.4, 1e-5);
    // A color that is not a number is black.
    const double hole[4] = { NaN, 102.0, 900.0, 0.5 };
    ExpectColor(glm::vec3(classifier.ClassifyValues(0, hole)), glm::dvec3(0.0, 0.4, 1.0));
  }
  {
    // Surfaces have the normal of the intensity, which rises along x, samples that of the opacity,
    // along z, towards the light. Ambient light is 0.1.
    f.Functions.Components[0].Shade = true;
    const SampleClassifier classifier(f.Inputs);
    const glm::dvec3 q(2.0);
    ExpectColor(classifier.Light(0, q, glm::vec3(1.0f), f.Normals), glm::dvec3(0.1), 1e-6);
    double at[4];
    classifier.Values(q, at);
    const glm::vec3 lit = classifier.Classify(q, at, f.Normals).Color;
    EXPECT_GT(lit.r, 0.5f * 18.0f / 255.0f);
    f.Functions.Components[0].Shade = false;
  }
  f.Inputs.Volume.Components = 3;
  f.Functions.Kind = ComponentKind::Rgb;
  {
    const SampleClassifier classifier(f.Inputs);
    const double luminance = 0.299 * 51.0 + 0.587 * 102.0 + 0.114 * 204.0;
    EXPECT_NEAR(classifier.FindIntensity(0, values), luminance, 1e-12);
    EXPECT_NEAR(classifier.FindDensity(0, values), luminance, 1e-12);
  }
  f.Inputs.Volume.Components = 2;
  f.Functions.Kind = ComponentKind::ColorOpacity;
  f.Functions.Colors = Ramp({ 1.0f, 0.5f, 0.0f }, 1.0);
  {
    const SampleClassifier classifier(f.Inputs);
    const double two[2] = { 0.5, 0.25 };
    EXPECT_EQ(classifier.GetNumberOfChannels(), 1);
    EXPECT_EQ(classifier.FindIntensity(0, two), 0.5);
    EXPECT_EQ(classifier.FindDensity(0, two), 0.25);
    const glm::vec4 sample = classifier.ClassifyValues(0, two);
    ExpectColor(glm::vec3(sample), glm::dvec3(0.5, 0.25, 0.0));
    EXPECT_NEAR(sample.a, 0.2, 1e-5);
  }
  f.Functions.Kind = ComponentKind::Independent;
  f.Functions.Components.resize(2);
  f.Functions.Components[1].Table = Constant({ 0.0f, 1.0f, 0.0f }, 0.6f);
  {
    const SampleClassifier classifier(f.Inputs);
    EXPECT_EQ(classifier.GetNumberOfChannels(), 2);
    EXPECT_EQ(classifier.FindIntensity(1, values), 102.0);
    EXPECT_EQ(classifier.FindDensity(1, values), 102.0);
    const glm::vec4 sample = classifier.ClassifyValues(1, values);
    ExpectColor(glm::vec3(sample), glm::dvec3(0.0, 1.0, 0.0));
    EXPECT_NEAR(sample.a, 0.6, 1e-5);
  }
}

TEST(SampleClassifier, TransferPlaneOverTheGradientOrAnotherArray)
{
  const Components volume(glm::ivec3(6), 1, [](int, const glm::dvec3& p) { return 0.1 * p.x; });
  const Components other(glm::ivec3(6), 1, [](int, const glm::dvec3& p) { return p.y; });
  Fixture f(volume.View);
  f.Functions.Components.resize(1);
  f.Functions.Components[0].Table = Constant(glm::vec3(0.0f), 0.0f);
  // Two columns, two rows.
  const float texels[16] = { 1, 0, 0, 0.2f, 0, 1, 0, 0.4f, 0, 0, 1, 0.6f, 1, 1, 1, 0.8f };
  f.Functions.Components[0].Plane = TransferPlane(2, 2, texels, { 0.1, 0.0 }, { 0.3, 0.2 }, false);
  // x: scalar 0.2, half way; y: magnitude 0.1, half way.
  SampleClassifier::Appearance sample = f.Classify({ 2.0, 2.0, 2.0 });
  EXPECT_NEAR(OpacityOf(sample, 1.0), 0.5, 1e-5);
  ExpectColor(sample.Color, { 0.5, 0.5, 0.5 });
  // First column.
  sample = f.Classify({ 1.0, 2.0, 2.0 });
  EXPECT_NEAR(OpacityOf(sample, 1.0), 0.4, 1e-5);

  f.Inputs.SecondAxis = other.View;
  f.Functions.Components[0].Plane = TransferPlane(2, 2, texels, { 0.1, 1.0 }, { 0.3, 3.0 }, false);
  sample = f.Classify({ 1.0, 0.5, 2.0 });
  EXPECT_NEAR(OpacityOf(sample, 1.0), 0.2, 1e-5);
  sample = f.Classify({ 1.0, 3.0, 2.0 });
  EXPECT_NEAR(OpacityOf(sample, 1.0), 0.6, 1e-5);
  f.Functions.Components[0].Plane = TransferPlane(2, 2, texels, { 0.1, 1.0 }, { 0.3, 3.0 }, true);
  sample = f.Classify({ 1.9, 1.9, 2.0 });
  EXPECT_NEAR(OpacityOf(sample, 1.0), 0.2, 1e-5);
}

TEST(SampleClassifier, TransparentPlanesAreTransparentOverTheirSecondAxis)
{
  // Visible in the third of five columns only, in the last row.
  std::vector<float> texels(4 * 5 * 3, 0.0f);
  texels[4 * (2 * 5 + 2) + 3] = 0.5f;
  const TransferPlane plane(5, 3, texels.data(), { 0.0, 0.0 }, { 5.0, 1.0 }, false);
  RandomLattice random(5);
  for (int i = 0; i < 20000; ++i)
  {
    const double lo = random.Number(-1.0, 6.0);
    const double hi = lo + random.Number(0.0, 1.0);
    const double x = lo + (hi - lo) * random.Number(0.0, 1.0);
    if (plane.Lookup(x, random.Number(0.0, 1.0)).a > 0.0f)
    {
      ASSERT_FALSE(plane.IsTransparent(lo, hi));
    }
  }
  // Columns lie at 0, 1.25, 2.5, 3.75 and 5.
  EXPECT_TRUE(plane.IsTransparent(0.0, 1.2));
  EXPECT_TRUE(plane.IsTransparent(3.8, 5.0));
  EXPECT_FALSE(plane.IsTransparent(1.2, 1.3));
  EXPECT_EQ(plane.Lookup(NaN, 0.9).a, 0.0f);
}

TEST(SampleClassifier, EqualTexelsOfAPlaneAreThoseBetweenThem)
{
  // Rounding errors would be differences of the opacity, and so directions of normals.
  const std::vector<float> texels(4 * 5 * 3, 0.8f);
  const TransferPlane plane(5, 3, texels.data(), { 0.0, 0.0 }, { 5.0, 1.0 }, false);
  RandomLattice random(6);
  for (int i = 0; i < 1000; ++i)
  {
    const glm::vec4 texel = plane.Lookup(random.Number(0.0, 5.0), random.Number(0.0, 1.0));
    ASSERT_EQ(texel, glm::vec4(0.8f));
  }
}

TEST(SampleClassifier, LabelsReplaceOrBlend)
{
  const Components volume(glm::ivec3(4), 1, [](int, const glm::dvec3&) { return 0.5; });
  const Components labels(glm::ivec3(4), 1, [](int, const glm::dvec3& p) {
    return p.x < 1.5 ? 0 : p.x < 2.5 ? 3 : 7;
  });
  Fixture f(volume.View);
  f.Functions.Components.resize(1);
  f.Functions.Components[0].Table = Constant({ 1.0f, 0.0f, 0.0f }, 0.2f);
  f.Functions.Labels.resize(1);
  f.Functions.Labels[0].Table = Constant({ 0.0f, 1.0f, 0.0f }, 0.6f);
  f.Functions.LabelIndices = { -1, -1, -1, 0 };
  f.Inputs.Mask.Volume = labels.View;
  f.Inputs.Mask.Labels = true;
  const auto check = [&](double x, const glm::dvec3& color, double opacity) {
    const SampleClassifier::Appearance sample = f.Classify({ x, 1.0, 1.0 });
    ExpectColor(sample.Color, color);
    EXPECT_NEAR(OpacityOf(sample, 1.0), opacity, 1e-5);
  };
  check(1.4, { 1.0, 0.0, 0.0 }, 0.2);
  check(1.6, { 0.0, 1.0, 0.0 }, 0.6);
  // A label without functions is none.
  check(2.6, { 1.0, 0.0, 0.0 }, 0.2);
  f.Inputs.Mask.BlendFactor = 0.25f;
  check(1.6, { 0.75, 0.25, 0.0 }, 0.3);
  f.Inputs.Mask.BlendFactor = 0.0f;
  check(1.6, { 1.0, 0.0, 0.0 }, 0.2);
  f.Inputs.Mask.BlendFactor = 1.0f;
  f.Functions.Labels[0].Gradients = GradientOpacity({ 0.5f, 1.0f }, 1.0);
  check(1.6, { 0.0, 1.0, 0.0 }, 0.3);
  // What labels show is not transparent.
  f.Functions.Components[0].Table = Constant(glm::vec3(0.0f), 0.0f);
  const MinMaxBlocks::Limits limits{ 0.5, 0.5 };
  EXPECT_FALSE(f.Functions.IsTransparent(&limits));
}

TEST(SampleClassifier, BinaryMasksAndHiddenCells)
{
  const Components volume(glm::ivec3(5), 1, [](int, const glm::dvec3&) { return 0.5; });
  Fixture f(volume.View);
  f.Functions.Components.resize(1);
  f.Functions.Components[0].Table = Constant(glm::vec3(1.0f), 0.5f);
  CellMask hidden(glm::ivec3(4));
  hidden.Add({ 1, 2, 3 });
  f.Inputs.Hidden = &hidden;
  {
    const SampleClassifier classifier(f.Inputs);
    EXPECT_TRUE(classifier.IsHidden({ 1.01, 2.99, 3.5 }));
    EXPECT_TRUE(classifier.IsHidden({ 1.5, 2.5, 4.0 }));
    EXPECT_FALSE(classifier.IsHidden({ 0.99, 2.5, 3.5 }));
    EXPECT_FALSE(classifier.IsHidden({ 1.5, 3.01, 3.5 }));
  }
  // Cells around voxels that are cells themselves.
  f.Inputs.Volume.Margin = 0.5;
  CellMask around(glm::ivec3(5));
  around.Add({ 0, 2, 4 });
  f.Inputs.Hidden = &around;
  {
    const SampleClassifier classifier(f.Inputs);
    EXPECT_TRUE(classifier.IsHidden({ -0.49, 1.51, 4.49 }));
    EXPECT_TRUE(classifier.IsHidden({ 0.49, 2.49, 3.51 }));
    EXPECT_FALSE(classifier.IsHidden({ 0.51, 2.0, 4.0 }));
  }
  f.Inputs.Volume.Margin = 0.0;
  f.Inputs.Hidden = nullptr;
  const Components mask(
    glm::ivec3(5), 1, [](int, const glm::dvec3& p) { return p.y == 2.0 ? 255.0 : 0.0; });
  f.Inputs.Mask.Volume = mask.View;
  {
    const SampleClassifier classifier(f.Inputs);
    EXPECT_FALSE(classifier.IsHidden({ 0.0, 1.6, 4.0 }));
    EXPECT_TRUE(classifier.IsHidden({ 0.0, 1.4, 4.0 }));
  }
  // A mask of its own place: half the size, shifted.
  f.Inputs.Mask.SameGrid = false;
  f.Inputs.Mask.Volume.FirstVoxel = glm::dvec3(1.0, 1.0, 1.0);
  f.Inputs.Mask.Volume.IndexToData = glm::dmat3(0.5);
  f.Inputs.Mask.Volume.DataToIndex = glm::dmat3(2.0);
  {
    const SampleClassifier classifier(f.Inputs);
    EXPECT_FALSE(classifier.IsHidden({ 2.0, 2.0, 2.0 }));
    EXPECT_FALSE(classifier.IsHidden({ 2.0, 1.8, 2.0 }));
    EXPECT_TRUE(classifier.IsHidden({ 2.0, 1.7, 2.0 }));
    EXPECT_TRUE(classifier.IsHidden({ 0.5, 2.0, 2.0 }));
    EXPECT_TRUE(classifier.IsHidden({ 2.0, 2.0, 3.3 }));
  }
}

// A linear field has its gradient beside hidden cells, too: nothing of what they hide is looked at.
TEST(SampleClassifier, GradientsBesideHiddenCells)
{
  const glm::dvec3 slope(0.02, 0.03, 0.06);
  const glm::ivec3 n(7);
  RandomLattice random(8);
  // Points: hidden are the cells around those that are blanked. Cells: these themselves.
  const std::vector<glm::ivec3> blanked = { { 2, 2, 4 }, { 4, 4, 4 }, { 6, 3, 0 }, { 3, 0, 2 } };
  const Components volume(n, 1, [&](int, const glm::dvec3& p) {
    const bool out = std::find(blanked.begin(), blanked.end(), glm::ivec3(p)) != blanked.end();
    return out ? 1e3 : 0.1 + glm::dot(slope, p);
  });
  for (const bool cells : { false, true })
  {
    CellMask hidden(cells ? n : n - 1);
    for (const glm::ivec3& at : blanked)
    {
      for (int corner = 0; corner < (cells ? 1 : 8); ++corner)
      {
        const glm::ivec3 cell = at - glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
        if (glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) &&
          glm::all(glm::lessThan(cell, hidden.GetCells())))
        {
          hidden.Add(cell);
        }
      }
    }
    for (const Interpolation interpolation : { Interpolation::Linear, Interpolation::Nearest })
    {
      SCOPED_TRACE(std::string(cells ? "cells" : "points") +
        (interpolation == Interpolation::Linear ? ", linear" : ", nearest"));
      Fixture f(volume.View);
      f.Inputs.Volume.Margin = cells ? 0.5 : 0.0;
      f.Inputs.VolumeInterpolation = interpolation;
      f.Inputs.Hidden = &hidden;
      f.Functions.Components.resize(1);
      f.Functions.Components[0].Table = Constant(glm::vec3(1.0f), 0.5f);
      f.Functions.Components[0].Gradients = GradientOpacity({ 0.0f, 1.0f }, 1.0);
      const SampleClassifier classifier(f.Inputs);
      const glm::dvec3 lower = f.Inputs.Volume.LowerIndex();
      const glm::dvec3 size = f.Inputs.Volume.UpperIndex() - lower;
      int shown = 0;
      for (int s = 0; s < 5000; ++s)
      {
        const glm::dvec3 q = lower + size * random.Vector(0.0, 1.0);
        if (!classifier.IsHidden(q))
        {
          ++shown;
          ASSERT_NEAR(OpacityOf(f.Classify(q), 1.0), 0.5 * glm::length(slope), 1e-4)
            << q.x << " " << q.y << " " << q.z;
        }
      }
      EXPECT_GT(shown, 3000);
      EXPECT_LT(shown, 5000);
    }
  }
}

TEST(SampleClassifier, NormalsOfTheOpacity)
{
  // The scalars rise along x, and a little towards the eye.
  const Components volume(
    glm::ivec3(6), 1, [](int, const glm::dvec3& p) { return 0.03 * p.x * p.x + 0.02 * p.z; });
  Fixture f(volume.View);
  f.Functions.Components.resize(1);
  f.Functions.Components[0].Table = Ramp(glm::vec3(1.0f), 0.5);
  f.Functions.Components[0].Shade = true;
  const glm::dvec3 q(2.5, 2.5, 2.5);
  const SampleClassifier plain(f.Inputs);
  const glm::vec3 byScalars = plain.Light(0, q, glm::vec3(1.0f), f.Normals);
  f.Inputs.NormalFromOpacity = true;
  const SampleClassifier classifier(f.Inputs);
  // Opacity is proportional to the scalars here, so are its gradients ...
  ExpectColor(classifier.Light(0, q, glm::vec3(1.0f), f.Normals), byScalars, 1e-4);
  // ... and here it does not change at all: no normal, ambient light only.
  f.Functions.Components[0].Table = Constant(glm::vec3(1.0f), 0.5f);
  ExpectColor(classifier.Light(0, q, glm::vec3(1.0f), f.Normals), glm::dvec3(0.1));
}

TEST(SampleClassifier, RectilinearAxes)
{
  // Positions of points: squares along x. A field that is linear in space is found exactly.
  std::vector<double> positions[3];
  const int n = 7;
  for (int i = 0; i < n; ++i)
  {
    positions[0].push_back(i * i / 6.0);
    positions[1].push_back(i);
    positions[2].push_back(6.0 * std::sqrt(i / 6.0));
  }
  const std::vector<double> kept[3] = { positions[0], positions[1], positions[2] };
  const AxisMap axes(positions, 0.0, 1.0);
  const glm::dvec3 slope(0.03, -0.02, 0.05);
  const Components volume(glm::ivec3(n), 1, [&](int, const glm::dvec3& p) {
    return 0.3 +
      glm::dot(slope,
        glm::dvec3(kept[0][static_cast<std::size_t>(p.x)], kept[1][static_cast<std::size_t>(p.y)],
          kept[2][static_cast<std::size_t>(p.z)]));
  });
  Fixture f(volume.View);
  f.Inputs.Volume.Axes = &axes;
  f.Functions.Components.resize(1);
  f.Functions.Components[0].Table = Constant(glm::vec3(1.0f), 0.5f);
  f.Functions.Components[0].Gradients = GradientOpacity({ 0.0f, 1.0f }, 1.0);
  const SampleClassifier classifier(f.Inputs);
  RandomLattice random(6);
  const MinMaxBlocks blocks(f.Inputs.Volume, ParallelFor());
  for (int s = 0; s < 2000; ++s)
  {
    const glm::dvec3 q = 6.0 * random.Vector(0.0, 1.0);
    double value;
    classifier.Values(q, &value);
    ASSERT_NEAR(value, 0.3 + glm::dot(slope, q), 1e-6);
    const glm::ivec3 block = glm::min(glm::ivec3(q) / 4, blocks.GetBlocks() - 1);
    ASSERT_LE(blocks.GetLimits(block).Min, value + 1e-6);
    ASSERT_GE(blocks.GetLimits(block).Max, value - 1e-6);
    for (int a = 0; a < 3; ++a)
    {
      ASSERT_NEAR(axes.ToIndex(a, axes.ToVoxel(a, q[a])), q[a], 1e-12);
    }
  }
  // Its gradient, too, up to the faces.
  for (const double at : { 0.0, 0.1, 1.3, 2.0, 5.8, 6.0 })
  {
    const SampleClassifier::Appearance sample = f.Classify({ at, 3.0, at });
    EXPECT_NEAR(OpacityOf(sample, 1.0), 0.5 * glm::length(slope), 1e-5) << at;
  }

  // Cells: their faces and centers. Each holds its own value at its center, and is nearest within.
  std::vector<double> nodes[3];
  for (int a = 0; a < 3; ++a)
  {
    nodes[a] = { -0.5, 0.25, 1.0, 1.25, 1.5 };
  }
  const AxisMap cells(nodes, -0.5, 0.5);
  EXPECT_EQ(cells.ToVoxel(0, 0.25), 0.0);
  EXPECT_EQ(cells.ToVoxel(0, 1.25), 1.0);
  EXPECT_EQ(cells.ToVoxel(0, 1.0), 0.5);
  EXPECT_EQ(cells.ToVoxel(0, -3.0), -0.5);
  EXPECT_EQ(cells.ToVoxel(0, 3.0), 1.5);
}

TEST(SampleClassifier, WhatIsNotANumberShowsNothing)
{
  const Components volume(
    glm::ivec3(4), 2, [](int c, const glm::dvec3& p) { return c == 1 && p.x > 1.0 ? NaN : 0.5; });
  Fixture f(volume.View);
  f.Functions.Components.resize(2);
  f.Functions.Components[0].Table = Constant(glm::vec3(1.0f), 0.25f);
  f.Functions.Components[1].Table = Constant(glm::vec3(1.0f), 0.75f);
  f.Functions.Components[0].Shade = true;
  f.Functions.Components[1].Shade = true;
  // The other component is seen.
  const SampleClassifier::Appearance sample = f.Classify({ 1.5, 1.5, 1.5 });
  EXPECT_NEAR(OpacityOf(sample, 1.0), 0.25, 1e-5);
  EXPECT_TRUE(std::isfinite(sample.Color.r));
  f.Functions.Components[0].Weight = 0.0f;
  EXPECT_EQ(f.Classify({ 1.5, 1.5, 1.5 }).Extinction, 0.0f);
}

TEST(Shading, LocalLightsFadeWithTheDistance)
{
  Shading material;
  material.Ambient = material.Specular = 0.0f;
  material.Diffuse = 1.0f;
  Light light;
  light.Positional = true;
  light.Position = glm::dvec3(0.0, 0.0, 3.0);
  light.Attenuation = glm::dvec3(1.0, 0.5, 0.25);
  material.Lights.push_back(light);
  const glm::dvec3 up(0.0, 0.0, 1.0);
  for (const double distance : { 1.0, 2.0, 4.0 })
  {
    const double expected = 1.0 / (1.0 + 0.5 * distance + 0.25 * distance * distance);
    const glm::vec3 color = material.Shade(glm::vec3(1.0f), light.Position - distance * up, up, up);
    EXPECT_NEAR(color.x, expected, 1e-6);
  }
}

TEST(DistanceMap, OfSeveralComponents)
{
  // Each is visible in one corner.
  const Components volume(glm::ivec3(17), 2, [](int c, const glm::dvec3& p) {
    return (c == 0 ? p.x + p.y + p.z < 2.0 : p.x + p.y + p.z > 46.0) ? 1.0 : 0.0;
  });
  OpticalFunctions functions;
  functions.Components.resize(2);
  functions.Components[0].Table = Ramp(glm::vec3(1.0f), 0.5);
  functions.Components[1].Table = Ramp(glm::vec3(1.0f), 0.5);
  VolumeView second = volume.View;
  second.Scalars = static_cast<const float*>(second.Scalars) + 1;
  const MinMaxBlocks blocks[2] = { MinMaxBlocks(volume.View, ParallelFor()),
    MinMaxBlocks(second, ParallelFor()) };
  const auto isEmpty = [&](const MinMaxBlocks::Limits* limits) {
    return functions.IsTransparent(limits);
  };
  const DistanceMap both({ &blocks[0], &blocks[1] }, isEmpty);
  EXPECT_EQ(both.GetDistance({ 0, 0, 0 }), 0);
  EXPECT_EQ(both.GetDistance({ 3, 3, 3 }), 0);
  EXPECT_EQ(both.GetDistance({ 1, 1, 1 }), 1);
  EXPECT_EQ(both.GetDistance({ 2, 2, 2 }), 1);
  functions.Components[1].Weight = 0.0f;
  const DistanceMap first({ &blocks[0], &blocks[1] }, isEmpty);
  EXPECT_EQ(first.GetDistance({ 0, 0, 0 }), 0);
  EXPECT_EQ(first.GetDistance({ 3, 3, 3 }), 3);
}
