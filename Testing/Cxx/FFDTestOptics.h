// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What the tests of components, transfer functions and masks share.
#ifndef FFDTestOptics_h
#define FFDTestOptics_h

#include "FFDTestScenes.h"

#include "vtkFFDRayStatistics.h"

#include <functional>
#include <string>
#include <vector>

namespace ffdTest
{

/// An image of a function of the component and of the position relative to the bounds (0 to 1).
using Field = std::function<double(int component, const Vec3& relative)>;

inline vtkSmartPointer<vtkImageData> MakeImage(
  int n, int type, int components, const Field& field, const Vec3& spacing = { 1.0, 1.0, 1.0 })
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(n, n, n);
  image->SetSpacing(spacing.data());
  image->AllocateScalars(type, components);
  image->GetPointData()->GetScalars()->SetName("field");
  for (int k = 0; k < n; ++k)
  {
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        const Vec3 p = { i / (n - 1.0), j / (n - 1.0), k / (n - 1.0) };
        for (int c = 0; c < components; ++c)
        {
          image->SetScalarComponentFromDouble(i, j, k, c, field(c, p));
        }
      }
    }
  }
  return image;
}

/// A ball that fades outwards, from 255 in its center to 0.
inline double Ball(const Vec3& p, const Vec3& center, double radius)
{
  double squares = 0.0;
  for (std::size_t a = 0; a < 3; ++a)
  {
    squares += (p[a] - center[a]) * (p[a] - center[a]);
  }
  return 255.0 * std::max(0.0, 1.0 - std::sqrt(squares) / radius);
}

/// Two balls that overlap, a waving third component, a flat ramp inside of a ball.
inline double FourFields(int component, const Vec3& p)
{
  switch (component)
  {
    case 0:
      return Ball(p, { 0.38, 0.45, 0.5 }, 0.3);
    case 1:
      return Ball(p, { 0.62, 0.55, 0.5 }, 0.3);
    case 2:
      return 127.5 * (1.0 + std::sin(9.0 * p[0]) * std::cos(7.0 * p[2])) *
        (Ball(p, { 0.5, 0.5, 0.5 }, 0.45) > 0.0 ? 1.0 : 0.0);
    default:
      return Ball(p, { 0.5, 0.5, 0.45 }, 0.42);
  }
}

inline void SetComponent(
  vtkVolumeProperty* property, int component, const Transfer& points, double unit = 1.0)
{
  vtkNew<vtkColorTransferFunction> color;
  vtkNew<vtkPiecewiseFunction> opacity;
  for (const std::array<double, 5>& p : points)
  {
    color->AddRGBPoint(p[0], p[1], p[2], p[3]);
    opacity->AddPoint(p[0], p[4]);
  }
  property->SetColor(component, color);
  property->SetScalarOpacity(component, opacity);
  property->SetScalarOpacityUnitDistance(component, unit);
}

/// RGBA bytes of RenderToImage; empty after an error.
inline std::vector<unsigned char> RenderRgba(Scene& scene, int size = 100)
{
  vtkNew<vtkImageData> colors;
  std::vector<unsigned char> bytes;
  scene.Volume->SetMapper(scene.Ours);
  if (scene.Ours->RenderToImage(scene.Renderer, scene.Volume, size, size, colors))
  {
    const auto* p = static_cast<const unsigned char*>(colors->GetScalarPointer());
    bytes.assign(p, p + 4 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  }
  return bytes;
}

/// Bytes that differ, over the pixels of two pictures; all of them if one is missing.
inline int CountDifferent(const std::vector<unsigned char>& a, const std::vector<unsigned char>& b)
{
  if (a.size() != b.size() || a.empty())
  {
    return static_cast<int>(std::max(a.size(), b.size())) + 1;
  }
  int different = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    different += a[i] != b[i] ? 1 : 0;
  }
  return different;
}

/**
 * What must hold for every option, on a deformed volume: leaping changes no byte of the picture
 * and leaves samples out, and the fast kernels draw what the reference kernels draw.
 */
inline void CheckSamePictures(Scene& scene, const std::string& name, Checks& checks)
{
  double bounds[6];
  scene.Ours->GetInput()->GetBounds(bounds);
  const double side =
    std::min({ bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] });
  scene.Volume->SetMapper(scene.Ours);
  const vtkSmartPointer<vtkBSplineTransform> bend =
    MakeTransform(bounds, 7, BendAndWaves(0.12 * side));
  scene.Ours->SetDeformation(bend);
  scene.Ours->CollectStatisticsOn();
  constexpr int Size = 80;
  const auto render = [&](int leaping, bool reference, double& samples) {
    scene.Ours->SetSpaceLeaping(leaping);
    scene.Ours->SetReferenceKernels(reference);
    const std::vector<unsigned char> bytes = RenderRgba(scene, Size);
    samples = static_cast<double>(scene.Ours->GetStatistics()->GetSamplesPerRay());
    return bytes;
  };
  double all = 0.0;
  double left = 0.0;
  std::vector<unsigned char> fast;
  std::vector<unsigned char> exact;
  for (const bool reference : { false, true })
  {
    const auto off = render(vtkFFDInverseRayVolumeMapper::OFF, reference, all);
    std::vector<unsigned char>& leapt = reference ? exact : fast;
    leapt = render(vtkFFDInverseRayVolumeMapper::LIPSCHITZ, reference, left);
    const int different = CountDifferent(off, leapt);
    int visible = 0;
    for (std::size_t i = 3; i < leapt.size(); i += 4)
    {
      visible += leapt[i] > 0 ? 1 : 0;
    }
    std::ostringstream figures;
    figures << different << " bytes differ (none), " << visible << " px, samples a ray " << all
            << " and " << left;
    checks.Expect(different == 0 && visible > 320 && left < all,
      name + (reference ? ", leaping, reference" : ", leaping"), figures.str());
  }
  double sum = 0.0;
  int pixels = 0;
  for (std::size_t i = 0; i + 3 < std::min(fast.size(), exact.size()); i += 4)
  {
    if (fast[i + 3] > 0 || exact[i + 3] > 0)
    {
      int most = std::abs(fast[i + 3] - exact[i + 3]);
      for (std::size_t c = 0; c < 3; ++c)
      {
        most =
          std::max(most, std::abs(fast[i + c] * fast[i + 3] - exact[i + c] * exact[i + 3]) / 255);
      }
      sum += most;
      ++pixels;
    }
  }
  std::ostringstream figures;
  figures << "mean difference " << (pixels ? sum / pixels : 0.0) << " (at most 0.5), " << pixels
          << " px";
  checks.Expect(pixels > 320 && sum / pixels <= 0.5, name + ", fast and reference", figures.str());
  scene.Ours->SetDeformation(nullptr);
  scene.Ours->ReferenceKernelsOff();
}

} // namespace ffdTest

#endif
