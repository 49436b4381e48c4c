// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What must not change the picture does not: space leaping, the number of threads, a window or
// none, the scalar type. In all inverse modes and segmentations, on smooth, strong and random
// deformations, with folds too.
#include "FFDTestScenes.h"

#include "vtkFFDRayStatistics.h"
#include "vtkImageCast.h"
#include "vtkMinimalStandardRandomSequence.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

namespace
{

using Mapper = vtkFFDInverseRayVolumeMapper;

/// Our RGBA bytes and depths without a window.
struct Bytes
{
  std::vector<unsigned char> Colors;
  std::vector<float> Depths;
};

Bytes RenderBytes(ffdTest::Scene& scene, int size, vtkImageData* inputDepths = nullptr)
{
  vtkNew<vtkImageData> colors;
  vtkNew<vtkImageData> depths;
  Bytes bytes;
  if (scene.Ours->RenderToImage(
        scene.Renderer, scene.Volume, size, size, colors, depths, inputDepths))
  {
    const auto* c = static_cast<const unsigned char*>(colors->GetScalarPointer());
    const auto* d = static_cast<const float*>(depths->GetScalarPointer());
    bytes.Colors.assign(c, c + 4 * size * size);
    bytes.Depths.assign(d, d + size * size);
  }
  return bytes;
}

/// Largest difference of what is seen: colors over black, and alpha.
int FindLargestDifference(const Bytes& a, const Bytes& b)
{
  if (a.Colors.empty() || a.Colors.size() != b.Colors.size())
  {
    return 255;
  }
  double largest = 0.0;
  for (std::size_t i = 0; i < a.Colors.size(); i += 4)
  {
    largest = std::max(largest, std::abs(a.Colors[i + 3] - b.Colors[i + 3]) * 1.0);
    for (std::size_t c = 0; c < 3; ++c)
    {
      largest = std::max(largest,
        std::abs(a.Colors[i + c] * a.Colors[i + 3] - b.Colors[i + c] * b.Colors[i + 3]) / 255.0);
    }
  }
  // Colors are rounded before they are multiplied by alpha.
  return static_cast<int>(std::floor(largest + 0.499));
}

int CountVisible(const Bytes& b)
{
  int visible = 0;
  for (std::size_t i = 3; i < b.Colors.size(); i += 4)
  {
    visible += b.Colors[i] > 0 ? 1 : 0;
  }
  return visible;
}

ffdTest::DisplacementAt Random(double amplitude, int seed)
{
  auto random = vtkSmartPointer<vtkMinimalStandardRandomSequence>::New();
  random->SetSeed(seed);
  return [random, amplitude](const ffdTest::Vec3&, const ffdTest::Vec3&) {
    ffdTest::Vec3 d;
    for (double& each : d)
    {
      each = amplitude * (2.0 * random->GetNextValue() - 1.0);
    }
    return d;
  };
}

void CheckLeaping(ffdTest::Scene& scene, const std::string& name, ffdTest::Checks& checks)
{
  constexpr int Size = 90;
  for (const int mode : { Mapper::FIRST_ORDER, Mapper::EXACT, Mapper::PULL_BACK })
  {
    scene.Ours->SetInverseMode(mode);
    for (const int segmentation : { Mapper::ERROR_BOUND, Mapper::GREEDY_ANGLE })
    {
      scene.Ours->SetSegmentation(segmentation);
      Bytes images[3];
      double samples[3];
      for (const int leaping : { Mapper::OFF, Mapper::SEGMENT, Mapper::LIPSCHITZ })
      {
        scene.Ours->SetSpaceLeaping(leaping);
        images[leaping] = RenderBytes(scene, Size);
        samples[leaping] = scene.Ours->GetStatistics()->GetSamplesPerRay();
      }
      const int differences[2] = { FindLargestDifference(images[0], images[1]),
        FindLargestDifference(images[0], images[2]) };
      // Depths are defined: within the view, or 1 where nothing is seen.
      bool finite = true;
      for (float depth : images[2].Depths)
      {
        finite = finite && depth >= 0.0f && depth <= 1.0f;
      }
      const int visible = CountVisible(images[0]);
      std::ostringstream figures;
      figures << "SEGMENT " << differences[0] << ", LIPSCHITZ " << differences[1]
              << " (at most 1); samples per ray " << samples[0] << ", " << samples[1] << ", "
              << samples[2] << "; " << visible << " px";
      // Leaping must leave samples out, or nothing is tested.
      checks.Expect(differences[0] <= 1 && differences[1] <= 1 && finite && visible > 560 &&
          samples[1] < samples[0] && samples[2] < samples[0],
        name + ", " + scene.Ours->GetInverseModeAsString() + ", " +
          scene.Ours->GetSegmentationAsString() + ", leaping",
        figures.str());
    }
  }
  scene.Ours->SetInverseModeToExact();
  scene.Ours->SetSegmentationToErrorBound();
}

void CheckThreads(ffdTest::Scene& scene, const std::string& name, ffdTest::Checks& checks)
{
  constexpr int Size = 90;
  for (const int segmentation : { Mapper::ERROR_BOUND, Mapper::GREEDY_ANGLE })
  {
    scene.Ours->SetSegmentation(segmentation);
    scene.Ours->SetNumberOfThreads(1);
    const Bytes one = RenderBytes(scene, Size);
    for (const int threads : { 2, 3, 8 })
    {
      scene.Ours->SetNumberOfThreads(threads);
      const Bytes many = RenderBytes(scene, Size);
      checks.Expect(
        CountVisible(one) > 560 && one.Colors == many.Colors && one.Depths == many.Depths,
        name + ", " + scene.Ours->GetSegmentationAsString() + ", " + std::to_string(threads) +
          " threads",
        "largest difference from one thread " + std::to_string(FindLargestDifference(one, many)) +
          " (bit by bit)");
    }
    scene.Ours->SetNumberOfThreads(0);
  }
  scene.Ours->SetSegmentationToErrorBound();
}

/// The same values as bytes, 16-bit integers and floats look the same, with a steep function, too.
void CheckScalarTypes(
  ffdTest::Scene& scene, vtkImageData* image, const std::string& name, ffdTest::Checks& checks)
{
  const ffdTest::Transfer steep = { { 0, 0.2, 0.3, 0.9, 0.0 }, { 40, 0.3, 0.4, 0.7, 0.0 },
    { 60, 0.9, 0.6, 0.2, 0.9 }, { 255, 1.0, 1.0, 1.0, 0.9 } };
  ffdTest::SetTransfer(scene.Property, steep, 1.0);
  const int types[] = { VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_UNSIGNED_SHORT, VTK_FLOAT, VTK_DOUBLE };
  for (const bool shaded : { true, false })
  {
    scene.Property->SetShade(shaded);
    for (const int leaping : { Mapper::OFF, Mapper::LIPSCHITZ })
    {
      scene.Ours->SetSpaceLeaping(leaping);
      ffdTest::Picture bytes;
      for (const int type : types)
      {
        vtkNew<vtkImageCast> cast;
        cast->SetInputData(image);
        cast->SetOutputScalarType(type);
        cast->Update();
        scene.Ours->SetInputData(cast->GetOutput());
        const ffdTest::Picture picture = scene.RenderToImage();
        bytes = bytes.Rgb.empty() ? picture : bytes;
        const ffdTest::Distance d = scene.Compare(picture, bytes);
        checks.Expect(d.Pixels > 1500 && d.Mean <= 0.1 && d.Max <= 2.0,
          name + (shaded ? ", shaded, " : ", unshaded, ") + scene.Ours->GetSpaceLeapingAsString() +
            ", " + vtkImageScalarTypeNameMacro(type),
          ffdTest::ToString(d) + " from bytes (mean at most 0.1, max 2)");
      }
    }
  }
  scene.SetInput(image);
  ffdTest::SetTransfer(scene.Property, ffdTest::SolidEngine(), 1.0);
  scene.Property->ShadeOn();
}

/// Undeformed, samples are a sample distance apart even where segments of rays are shorter.
void CheckLongSteps(ffdTest::Scene& scene, double voxel, ffdTest::Checks& checks)
{
  scene.SetSampleDistance(3.0 * voxel);
  const double usual = scene.Ours->GetMaximumSegmentLength();
  ffdTest::Picture longest;
  for (const double segments : { usual, 2.0, 0.7 })
  {
    scene.Ours->SetMaximumSegmentLength(segments);
    for (const bool reference : { false, true })
    {
      scene.Ours->SetReferenceKernels(reference);
      const ffdTest::Picture picture = scene.RenderToImage();
      longest = longest.Rgb.empty() ? picture : longest;
      const ffdTest::Distance d = scene.Compare(picture, longest);
      checks.Expect(d.Pixels > 1500 && d.Mean <= 0.1,
        "long steps, segments of " + std::to_string(segments) + (reference ? ", reference" : ""),
        ffdTest::ToString(d) + " from long segments (mean at most 0.1)");
    }
  }
  scene.Ours->ReferenceKernelsOff();
  scene.Ours->SetMaximumSegmentLength(usual);
  scene.SetSampleDistance(voxel);
}

/// Without a window the picture is the same.
void CheckWindow(ffdTest::Scene& scene, const std::string& name, ffdTest::Checks& checks)
{
  const ffdTest::Distance window = scene.Compare(scene.Render(scene.Ours), scene.RenderToImage());
  checks.Expect(window.Pixels > 1500 && window.Max <= 2.0, name + ", RenderToImage",
    ffdTest::ToString(window) + " from the window (max at most 2)");
}

/// Pictures that show nothing pass no limit, whether it is an upper or a lower one.
void CheckNothingToCompare(ffdTest::Checks& checks)
{
  const std::array<unsigned char, 3> black = { 0, 0, 0 };
  const ffdTest::Picture empty{ 2, 2, std::vector<unsigned char>(12, 0) };
  const ffdTest::Distance d = ffdTest::Compare(empty, empty, black);
  checks.Expect(d.Pixels == 0 && !(d.Mean <= 255.0) && !(d.Mean >= 0.0) && !(d.Max <= 255.0) &&
      !(d.Max >= 0.0) && !(d.P99 <= 255.0) && !(d.Psnr >= 0.0),
    "two empty pictures", ffdTest::ToString(d));
  const ffdTest::Picture other{ 1, 1, std::vector<unsigned char>(3, 9) };
  checks.Expect(
    !(ffdTest::Compare(empty, other, black).Max >= 0.0), "pictures of unlike sizes", "");
}

} // namespace

int TestSamePicture(int argc, char* argv[])
{
  ffdTest::Checks checks;
  CheckNothingToCompare(checks);
  ffdTest::Scene scene(140);
  const vtkSmartPointer<vtkImageData> image = ffdTest::ReadVolume(argc, argv, "engine", 2);
  double bounds[6];
  image->GetBounds(bounds);
  const double voxel = image->GetSpacing()[0];
  scene.SetInput(image);
  scene.SetSampleDistance(voxel);
  ffdTest::SetTransfer(scene.Property, ffdTest::SolidEngine(), 1.0);
  scene.SetShading(0.1, 0.7, 0.2, 10.0);
  scene.Ours->CollectStatisticsOn();

  struct Shape
  {
    std::string Name;
    vtkSmartPointer<vtkBSplineTransform> Transform;
    bool Folds;
  };
  const std::vector<Shape> shapes = {
    { "smooth", ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(20.0 * voxel)), false },
    { "strong", ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(45.0 * voxel)), false },
    { "random", ffdTest::MakeTransform(bounds, 7, Random(6.0 * voxel, 7)), false },
    { "folded", ffdTest::MakeTransform(bounds, 8, Random(30.0 * voxel, 11)), true },
  };
  for (const Shape& shape : shapes)
  {
    const double smallest = ffdTest::FindSmallestDeterminant(shape.Transform, bounds);
    checks.Expect(shape.Folds == (smallest < 0.0),
      shape.Name + (shape.Folds ? ", has folds" : ", has no folds"),
      "smallest determinant of the Jacobian " + std::to_string(smallest));
    scene.Ours->SetDeformation(shape.Transform);
    scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, scene.Ours->GetBounds());
    CheckLeaping(scene, shape.Name, checks);
    CheckThreads(scene, shape.Name, checks);
    CheckWindow(scene, shape.Name, checks);
    if (shape.Name != "folded")
    {
      CheckScalarTypes(scene, image, shape.Name, checks);
    }

    if (!shape.Folds)
    {
      // The default bound on the error of positions is small enough to see nothing of it: samples
      // lie where they lie, whatever the segments are.
      const double tolerance = scene.Ours->GetPositionTolerance();
      scene.Ours->SetPositionTolerance(0.1);
      const ffdTest::Picture coarse = scene.RenderToImage();
      scene.Ours->SetPositionTolerance(0.005);
      const ffdTest::Distance e = scene.Compare(coarse, scene.RenderToImage());
      scene.Ours->SetPositionTolerance(tolerance);
      checks.Expect(e.Pixels > 1500 && e.Mean < 0.8 && e.P99 <= 5.0,
        shape.Name + ", position tolerance 0.1 against 0.005",
        ffdTest::ToString(e) + " (mean below 0.8, p99 at most 5)");
    }
  }

  scene.Ours->SetDeformation(nullptr);
  scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, bounds);
  CheckScalarTypes(scene, image, "undeformed", checks);
  CheckLongSteps(scene, voxel, checks);

  // Depths that cut the picture: nothing is seen of what lies behind.
  scene.Ours->SetDeformation(shapes[0].Transform);
  scene.SetCamera({ 30.0, 30.0, 1.0, false, false }, scene.Ours->GetBounds());
  constexpr int Size = 120;
  const Bytes whole = RenderBytes(scene, Size);
  vtkNew<vtkImageData> in;
  in->SetDimensions(Size, Size, 1);
  in->AllocateScalars(VTK_FLOAT, 1);
  auto* depths = static_cast<float*>(in->GetScalarPointer());
  int cut = 0;
  for (int i = 0; i < Size * Size; ++i)
  {
    // Left: just in front of the first visible sample. Middle: far behind. Right: nothing there.
    const float first = whole.Depths[static_cast<std::size_t>(i)];
    depths[i] = i % Size < Size / 3 ? first - 1e-4f : i % Size < 2 * Size / 3 ? 0.99999f : 1.0f;
    cut += i % Size < Size / 3 && first < 1.0f ? 1 : 0;
  }
  const Bytes part = RenderBytes(scene, Size, in);
  int wrong = 0;
  for (int i = 0; i < Size * Size; ++i)
  {
    const std::size_t p = 4 * static_cast<std::size_t>(i);
    wrong += i % Size < Size / 3 ? part.Colors[p + 3] != 0
                                 : std::memcmp(&part.Colors[p], &whole.Colors[p], 4) != 0;
  }
  checks.Expect(wrong == 0 && cut > 500, "input depths",
    std::to_string(wrong) + " wrong pixels, " + std::to_string(cut) + " cut");
  return checks.Result();
}
