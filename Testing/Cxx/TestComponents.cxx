// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Several components: independent ones with functions, weights and surfaces of their own;
// dependent ones. Against VTK's mappers, undeformed, with equal settings.
#include "FFDTestOptics.h"

#include "vtkImageCast.h"

namespace
{

using ffdTest::Transfer;

const Transfer Functions[4] = {
  { { 20, 1.0, 0.2, 0.1, 0.0 }, { 120, 1.0, 0.5, 0.1, 0.06 }, { 255, 1.0, 0.9, 0.3, 0.2 } },
  { { 10, 0.1, 0.3, 1.0, 0.0 }, { 100, 0.2, 0.7, 1.0, 0.1 }, { 255, 0.9, 1.0, 1.0, 0.3 } },
  { { 150, 0.1, 0.9, 0.2, 0.0 }, { 255, 0.6, 1.0, 0.3, 0.05 } },
  { { 30, 0.8, 0.8, 0.8, 0.0 }, { 255, 1.0, 1.0, 1.0, 0.08 } },
};

void CheckIndependent(ffdTest::Checks& checks)
{
  for (int components = 2; components <= 4; ++components)
  {
    // vtkFixedPointVolumeRayCastMapper does not survive a change of their number.
    ffdTest::Scene scene;
    const auto image = ffdTest::MakeImage(40, VTK_UNSIGNED_CHAR, components, ffdTest::FourFields);
    scene.SetInput(image);
    scene.SetCamera({ 25.0, 20.0, 1.0, true, false }, image->GetBounds());
    scene.Property->IndependentComponentsOn();
    scene.Property->SetInterpolationTypeToLinear();
    for (int c = 0; c < components; ++c)
    {
      ffdTest::SetComponent(scene.Property, c, Functions[c], 1.0 + 0.5 * c);
      scene.Property->SetComponentWeight(c, 1.0);
      scene.Property->ShadeOff(c);
    }
    const std::string name = std::to_string(components) + " independent components";
    const ffdTest::Picture even = scene.Render(scene.Ours);
    const ffdTest::Distance evenFixed = scene.Compare(even, scene.RenderFixedRays());
    checks.Expect(evenFixed.Pixels > 1500 && evenFixed.Mean <= 2.5, name,
      ffdTest::ToString(evenFixed) + " (mean at most 2.5)");
    scene.Property->SetComponentWeight(0, 0.3);
    scene.Property->SetComponentWeight(components - 1, 0.6);
    const ffdTest::Picture weighted = scene.Render(scene.Ours);
    const ffdTest::Distance weightedFixed = scene.Compare(weighted, scene.RenderFixedRays());
    checks.Expect(weightedFixed.Mean <= 2.5, name + ", weighted",
      ffdTest::ToString(weightedFixed) + " (mean at most 2.5)");
    checks.ExpectAtLeast(name + ", weights matter", scene.Compare(even, weighted).Mean, 8.0);
    ffdTest::CheckSamePictures(scene, name, checks);

    // Surfaces of their own.
    for (int c = 0; c < components; ++c)
    {
      scene.Property->SetComponentWeight(c, 1.0);
      scene.Property->ShadeOn(c);
      scene.Property->SetAmbient(c, 0.1 + 0.2 * c);
      scene.Property->SetDiffuse(c, 0.9 - 0.2 * c);
      scene.Property->SetSpecular(c, 0.1 * c);
      scene.Property->SetSpecularPower(c, 5.0 + 10.0 * c);
    }
    const ffdTest::Picture shaded = scene.Render(scene.Ours);
    const ffdTest::Distance shadedFixed = scene.Compare(shaded, scene.RenderFixedRays());
    checks.Expect(shadedFixed.Mean <= 5.0, name + ", shaded",
      ffdTest::ToString(shadedFixed) + " (mean at most 5)");
    scene.Property->SetDiffuse(1, 0.1);
    checks.ExpectAtLeast(
      name + ", each has its surface", scene.Compare(shaded, scene.Render(scene.Ours)).Mean, 4.0);
    scene.Property->SetDiffuse(1, 0.7);
    scene.Property->SetSpecularPower(1, 90.0);
    checks.ExpectAtLeast(name + ", each has its highlights",
      scene.Compare(shaded, scene.Render(scene.Ours)).Mean, 0.2);
    for (int c = 0; c < components; ++c)
    {
      scene.Property->ShadeOff(c);
    }
  }
}

/// The GPU mapper draws the same (with a unit distance of the last component that is that of the
/// first, see CheckUniform()); vtkFixedPointVolumeRayCastMapper leaps and rounds otherwise here.
/// The GPU mapper takes normals of the first component though, not of the last as documented by
/// vtkVolumeProperty, so shading is compared with that of one component.
void CheckDependent(ffdTest::Checks& checks)
{
  const Transfer functions = { { 5, 1.0, 0.1, 0.1, 0.0 }, { 60, 0.2, 1.0, 0.2, 0.05 },
    { 200, 0.2, 0.4, 1.0, 0.2 } };
  Transfer white = functions;
  for (std::array<double, 5>& point : white)
  {
    point[1] = point[2] = point[3] = 1.0;
  }
  for (const int components : { 2, 4 })
  {
    ffdTest::Scene scene;
    scene.Property->IndependentComponentsOff();
    const auto image = ffdTest::MakeImage(40, VTK_UNSIGNED_CHAR, components, ffdTest::FourFields);
    scene.SetInput(image);
    scene.SetCamera({ 25.0, 20.0, 1.0, true, false }, image->GetBounds());
    ffdTest::SetComponent(scene.Property, 0, functions);
    scene.Property->SetInterpolationTypeToLinear();
    scene.Property->ShadeOff(0);
    const std::string name = std::to_string(components) + " dependent components";
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    const ffdTest::Distance oursGpu = scene.Compare(ours, scene.Render(scene.Gpu));
    checks.Expect(oursGpu.Pixels > 1500 && oursGpu.Mean <= 2.5, name,
      ffdTest::ToString(oursGpu) + " from the GPU mapper (mean at most 2.5)");
    ffdTest::CheckSamePictures(scene, name, checks);
    scene.Ours->SetDeformation(nullptr);
    for (const double weight : { 0.0, 0.3 })
    {
      scene.Property->SetComponentWeight(0, weight);
      const ffdTest::Distance weighed = scene.Compare(ours, scene.Render(scene.Ours));
      checks.Expect(weighed.Max == 0.0, name + ", weights of components are not theirs",
        ffdTest::ToString(weighed));
    }
    scene.Property->SetComponentWeight(0, 1.0);
    scene.SetShadingAsGpuMapper(0.2, 0.7, 0.2, 10.0);
    ffdTest::CheckSamePictures(scene, name + ", shaded", checks);
    const ffdTest::Distance shading = scene.Compare(ours, scene.Render(scene.Ours));
    checks.ExpectAtLeast(name + ", shading matters", shading.Mean, 4.0);
    scene.Property->ShadeOff(0);
    scene.Property->IndependentComponentsOn();
    for (int c = 1; c < components; ++c)
    {
      ffdTest::SetComponent(scene.Property, c, Functions[c]);
    }
    checks.ExpectAtLeast(
      name + ", dependence matters", scene.Compare(ours, scene.Render(scene.Ours)).Mean, 8.0);

    // White, its last component alone: the same shading.
    scene.Property->IndependentComponentsOff();
    ffdTest::SetComponent(scene.Property, 0, components == 4 ? functions : white);
    scene.SetShadingAsGpuMapper(0.2, 0.7, 0.2, 10.0);
    const auto whitened = ffdTest::MakeImage(
      40, VTK_UNSIGNED_CHAR, components, [components](int c, const ffdTest::Vec3& p) {
        return c == components - 1 ? ffdTest::FourFields(c, p) : 255.0;
      });
    const auto last = ffdTest::MakeImage(40, VTK_UNSIGNED_CHAR, 1,
      [components](int, const ffdTest::Vec3& p) { return ffdTest::FourFields(components - 1, p); });
    scene.SetInput(whitened);
    const ffdTest::Picture dependent = scene.Render(scene.Ours);
    scene.SetInput(last);
    ffdTest::SetComponent(scene.Property, 0, white);
    const ffdTest::Distance apart = scene.Compare(dependent, scene.Render(scene.Ours));
    checks.Expect(apart.Pixels > 1500 && apart.Max <= 2.0, name + ", normals",
      ffdTest::ToString(apart) + " from one component (max at most 2)");
  }
}

void CheckColors(ffdTest::Scene& scene, ffdTest::Checks& checks)
{
  scene.Property->IndependentComponentsOff();
  // Gray volumes as colors: their luminance is looked up, so the picture is that of one component
  // whose color is its value.
  const auto gray = [](int, const ffdTest::Vec3& p) { return ffdTest::FourFields(3, p); };
  const Transfer ramp = { { 0, 0.0, 0.0, 0.0, 0.0 }, { 255, 1.0, 1.0, 1.0, 0.2 } };
  ffdTest::SetComponent(scene.Property, 0, ramp);
  const auto rgb = ffdTest::MakeImage(
    40, VTK_FLOAT, 3, [&](int c, const ffdTest::Vec3& p) { return gray(c, p) / 255.0; });
  const auto one = ffdTest::MakeImage(
    40, VTK_FLOAT, 1, [&](int c, const ffdTest::Vec3& p) { return gray(c, p) / 255.0; });
  ffdTest::SetComponent(
    scene.Property, 0, { { 0, 0.0, 0.0, 0.0, 0.0 }, { 1, 1.0, 1.0, 1.0, 0.2 } });
  scene.SetInput(rgb);
  scene.SetCamera({ 25.0, 20.0, 1.0, true, false }, rgb->GetBounds());
  const ffdTest::Picture ofThree = scene.Render(scene.Ours);
  ffdTest::CheckSamePictures(scene, "3 dependent components", checks);
  scene.SetInput(one);
  const ffdTest::Distance apart = scene.Compare(ofThree, scene.Render(scene.Ours));
  checks.Expect(apart.Pixels > 1500 && apart.Max <= 1.0, "3 dependent components",
    ffdTest::ToString(apart) + " from one component (max at most 1)");
  // The types that colors may have.
  const auto asBytes = ffdTest::MakeImage(40, VTK_UNSIGNED_CHAR, 3, gray);
  const auto asShorts = ffdTest::MakeImage(40, VTK_UNSIGNED_SHORT, 3,
    [&](int c, const ffdTest::Vec3& p) { return 257.0 * std::floor(gray(c, p)); });
  ffdTest::SetComponent(scene.Property, 0, ramp);
  scene.SetInput(asBytes);
  const ffdTest::Picture bytes = scene.Render(scene.Ours);
  ffdTest::SetComponent(
    scene.Property, 0, { { 0, 0.0, 0.0, 0.0, 0.0 }, { 65535, 1.0, 1.0, 1.0, 0.2 } });
  scene.SetInput(asShorts);
  const ffdTest::Distance types = scene.Compare(bytes, scene.Render(scene.Ours));
  checks.Expect(types.Pixels > 1500 && types.Max <= 2.0, "unsigned short colors",
    ffdTest::ToString(types) + " from unsigned char (max at most 2)");
  scene.Property->IndependentComponentsOn();
}

/// A uniform volume 32 units thick, whose components have the given values; two voxels in its
/// corners span the range of bytes.
vtkSmartPointer<vtkImageData> MakeUniform(const std::vector<double>& values)
{
  return ffdTest::MakeImage(
    33, VTK_UNSIGNED_CHAR, static_cast<int>(values.size()), [&](int c, const ffdTest::Vec3& p) {
      const double sum = p[0] + p[1] + p[2];
      return sum == 0.0 ? 0.0 : sum == 3.0 ? 255.0 : values[static_cast<std::size_t>(c)];
    });
}

/// The pixel in the middle.
std::array<int, 3> FindMiddle(const ffdTest::Picture& picture)
{
  std::array<int, 3> rgb;
  const int at = picture.Height / 2 * picture.Width + picture.Width / 2;
  for (int c = 0; c < 3; ++c)
  {
    rgb[static_cast<std::size_t>(c)] = picture.Rgb[static_cast<std::size_t>(3 * at + c)];
  }
  return rgb;
}

/// Through a uniform volume: closed forms, which tell where VTK's mappers differ and why.
void CheckUniform(ffdTest::Checks& checks)
{
  constexpr double Thickness = 32.0;
  constexpr double Step = 0.5;
  const auto expect = [&](const std::string& what, const std::array<int, 3>& rgb,
                        const std::array<double, 3>& expected) {
    std::ostringstream figures;
    double worst = 0.0;
    for (std::size_t c = 0; c < 3; ++c)
    {
      figures << rgb[c] << " (" << 255.0 * expected[c] << ") ";
      worst = std::max(worst, std::abs(rgb[c] - 255.0 * expected[c]));
    }
    figures << "at most 2 apart";
    checks.Expect(worst <= 2.0, what, figures.str());
  };
  const auto prepare = [&](ffdTest::Scene& scene, const std::vector<double>& values) {
    const auto image = MakeUniform(values);
    scene.SetInput(image);
    scene.Renderer->SetBackground(0.0, 0.0, 0.0);
    scene.SetSampleDistance(Step);
    scene.SetCamera({ 0.0, 0.0, 1.0, true, false }, image->GetBounds());
    scene.Property->SetInterpolationTypeToLinear();
  };

  // Two independent components: the first red, the second green.
  for (const std::array<double, 4>& each : std::vector<std::array<double, 4>>{
         { 0.04, 0.02, 1.0, 1.0 }, { 0.04, 0.02, 0.5, 0.5 }, { 0.06, 0.01, 0.3, 0.6 } })
  {
    ffdTest::Scene scene(60);
    prepare(scene, { 100.0, 150.0 });
    scene.Property->IndependentComponentsOn();
    double a[2];  // of an interval
    double aw[2]; // weighted
    for (int c = 0; c < 2; ++c)
    {
      const double opacity = each[static_cast<std::size_t>(c)];
      const double weight = each[static_cast<std::size_t>(c) + 2];
      const double red = c == 0 ? 1.0 : 0.0;
      ffdTest::SetComponent(scene.Property, c,
        { { 0, red, 1.0 - red, 0.0, opacity }, { 255, red, 1.0 - red, 0.0, opacity } });
      scene.Property->SetComponentWeight(c, weight);
      a[c] = 1.0 - std::pow(1.0 - opacity, Step);
      aw[c] = weight * a[c];
    }
    // Every interval adds its color to what is left by those before.
    const auto march = [&](double alpha) {
      std::array<double, 3> rgb{ { 0.0, 0.0, 0.0 } };
      double light = 1.0;
      for (double t = 0.0; t < Thickness; t += Step)
      {
        rgb[0] += light * aw[0];
        rgb[1] += light * aw[1];
        light *= 1.0 - alpha;
      }
      rgb[0] = std::min(1.0, rgb[0]);
      rgb[1] = std::min(1.0, rgb[1]);
      return rgb;
    };
    const double sum = aw[0] + aw[1];
    const auto weighted = march((aw[0] * aw[0] + aw[1] * aw[1]) / sum);
    std::ostringstream name;
    name << "uniform, opacities " << each[0] << ", " << each[1] << ", weights " << each[2] << ", "
         << each[3];
    // The GPU mapper leaves out the weights in the numerator. It goes first: what it draws with
    // weights after the fixed-point mapper has drawn in the same window is darker.
    expect(name.str() + ", GPU mapper", FindMiddle(scene.Render(scene.Gpu)),
      march((a[0] * a[0] + a[1] * a[1]) / sum));
    expect(name.str(), FindMiddle(scene.Render(scene.Ours)), weighted);
    expect(name.str() + ", fixed-point mapper", FindMiddle(scene.RenderFixedRays()), weighted);
  }

  // Dependent components: the unit distance is that of component 0, but in the GPU mapper.
  for (const int components : { 2, 4 })
  {
    for (const int longer : { 0, components - 1 })
    {
      ffdTest::Scene scene(60);
      prepare(scene,
        components == 2 ? std::vector<double>{ 100.0, 150.0 }
                        : std::vector<double>{ 100.0, 120.0, 140.0, 150.0 });
      scene.Property->IndependentComponentsOff();
      constexpr double Opacity = 0.05;
      ffdTest::SetComponent(
        scene.Property, 0, { { 0, 1.0, 1.0, 1.0, Opacity }, { 255, 1.0, 1.0, 1.0, Opacity } });
      scene.Property->SetScalarOpacityUnitDistance(longer, 4.0);
      const auto color = [&](double unit) {
        const double alpha = 1.0 - std::pow(1.0 - Opacity, Thickness / unit);
        return components == 2 ? std::array<double, 3>{ { alpha, alpha, alpha } }
                               : std::array<double, 3>{ { alpha * 100.0 / 255.0,
                                   alpha * 120.0 / 255.0, alpha * 140.0 / 255.0 } };
      };
      const std::string name = "uniform, " + std::to_string(components) +
        " dependent components, unit distance of " + std::to_string(longer);
      const double first = longer == 0 ? 4.0 : 1.0;
      expect(name, FindMiddle(scene.Render(scene.Ours)), color(first));
      expect(name + ", fixed-point mapper", FindMiddle(scene.RenderFixedRays()), color(first));
      expect(
        name + ", GPU mapper", FindMiddle(scene.Render(scene.Gpu)), color(longer == 0 ? 1.0 : 4.0));
    }
  }
}

/// All types, with functions over the same part of their range, give the same picture.
void CheckTypes(ffdTest::Scene& scene, ffdTest::Checks& checks)
{
  const int types[] = { VTK_CHAR, VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_UNSIGNED_SHORT,
    VTK_INT, VTK_UNSIGNED_INT, VTK_LONG, VTK_UNSIGNED_LONG, VTK_LONG_LONG, VTK_UNSIGNED_LONG_LONG,
    VTK_FLOAT, VTK_DOUBLE };
  scene.SetCamera({ 25.0, 20.0, 1.0, true, false },
    ffdTest::MakeImage(40, VTK_FLOAT, 1, ffdTest::FourFields)->GetBounds());
  for (int c = 0; c < 2; ++c)
  {
    ffdTest::SetComponent(scene.Property, c,
      { { 5, Functions[c][0][1], Functions[c][0][2], Functions[c][0][3], 0.0 },
        { 120, Functions[c][2][1], Functions[c][2][2], Functions[c][2][3], 0.2 } });
  }
  ffdTest::Picture first;
  for (const int type : types)
  {
    const auto image = ffdTest::MakeImage(40, type, 2,
      [](int c, const ffdTest::Vec3& p) { return std::floor(0.49 * ffdTest::FourFields(c, p)); });
    scene.SetInput(image);
    const ffdTest::Picture picture = scene.Render(scene.Ours);
    if (first.Rgb.empty())
    {
      first = picture;
    }
    const ffdTest::Distance apart = scene.Compare(picture, first);
    checks.Expect(apart.Pixels > 1000 && apart.Max <= 2.0,
      std::string("two components of ") + vtkImageScalarTypeNameMacro(type),
      ffdTest::ToString(apart) + " (max at most 2)");
  }
}

} // namespace

int TestComponents(int, char*[])
{
  ffdTest::Checks checks;
  ffdTest::Scene scene;
  CheckIndependent(checks);
  CheckDependent(checks);
  CheckColors(scene, checks);
  CheckTypes(scene, checks);
  CheckUniform(checks);
  return checks.Result();
}
