// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDRayTracer: its vertices are what the inverse mode says, its segments follow the rules of
// the segmentation, and its counts and colors are those of the mapper's picture.
#include "FFDTestVolume.h"

#include "vtkFFDRayTracer.h"

#include "vtkAlgorithmOutput.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkExecutive.h"
#include "vtkIdList.h"
#include "vtkMath.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <limits>

namespace
{

constexpr int Side = 36;

double Value(vtkDataSetAttributes* data, const char* name, vtkIdType i, int component = 0)
{
  vtkDataArray* array = data->GetArray(name);
  return array ? array->GetComponent(i, component) : std::numeric_limits<double>::quiet_NaN();
}

int TestVertices()
{
  FFDTestScene scene;
  scene.Mapper->SetSegmentationToGreedyAngle();
  scene.Mapper->SetMinimumSegmentLength(0.5);
  scene.Mapper->SetMaximumSegmentLength(6.0);
  scene.Mapper->SetSpaceLeapingToOff();
  scene.Mapper->SetEarlyRayTerminationThreshold(0.0);
  vtkNew<vtkFFDRayTracer> tracer;
  tracer->SetRenderer(scene.Renderer);
  tracer->SetVolume(scene.Volume);
  tracer->SetImageSize(Side, Side);
  tracer->AddPixelGrid(6, 6);
  FFD_CHECK(tracer->GetNumberOfPixels() == 36);
  for (const int mode : { vtkFFDInverseRayVolumeMapper::FIRST_ORDER,
         vtkFFDInverseRayVolumeMapper::EXACT, vtkFFDInverseRayVolumeMapper::PULL_BACK })
  {
    scene.Mapper->SetInverseMode(mode);
    scene.Mapper->SetInverseTolerance(1e-7);
    tracer->Update();
    vtkPolyData* rest = tracer->GetOutput(0);
    vtkPolyData* viewing = tracer->GetOutput(1);
    vtkPolyData* samples = tracer->GetOutput(2);
    const vtkIdType rays = rest->GetNumberOfLines();
    FFD_CHECK(rays > 9 && rays < 36 && viewing->GetNumberOfLines() == rays);
    FFD_CHECK(
      rest->GetNumberOfPoints() > 100 && viewing->GetNumberOfPoints() == rest->GetNumberOfPoints());
    int curved = 0;
    int shortest = 0;
    for (vtkIdType i = 0; i < rest->GetNumberOfPoints(); ++i)
    {
      double p[3];
      double q[3];
      double t[3];
      viewing->GetPoint(i, p);
      rest->GetPoint(i, q);
      scene.Lattice->TransformPoint(mode == vtkFFDInverseRayVolumeMapper::EXACT ? q : p, t);
      for (int a = 0; a < 3; ++a)
      {
        FFD_CHECK_NEAR(mode == vtkFFDInverseRayVolumeMapper::FIRST_ORDER ? 2.0 * p[a] - t[a] : t[a],
          mode == vtkFFDInverseRayVolumeMapper::EXACT ? p[a] : q[a], 1e-6);
      }
      curved += FFDDistance(p, q) > 0.5 ? 1 : 0;
    }
    FFD_CHECK(curved > 50);
    vtkNew<vtkIdList> ids;
    double intervals = 0.0;
    double lengths = 0.0;
    double lastPixel = -1.0;
    for (vtkIdType cell = 0; cell < rays; ++cell)
    {
      // In the order of the grid.
      const double x = Value(rest->GetCellData(), "Pixel", cell, 0);
      const double y = Value(rest->GetCellData(), "Pixel", cell, 1);
      FFD_CHECK(std::fmod(x, 6.0) == 3.0 && std::fmod(y, 6.0) == 3.0 && x + Side * y > lastPixel);
      lastPixel = x + Side * y;
      rest->GetCellPoints(cell, ids);
      const vtkIdType count = ids->GetNumberOfIds();
      FFD_CHECK(count >= 2 && Value(rest->GetCellData(), "Segments", cell) == count - 1);
      double previous[3] = { 0.0, 0.0, 0.0 };
      double samplesOfRay = 0.0;
      for (vtkIdType n = 0; n + 1 < count; ++n)
      {
        const vtkIdType at = ids->GetId(n);
        double a[3];
        double b[3];
        double c[3];
        double d[3];
        rest->GetPoint(at, a);
        rest->GetPoint(at + 1, b);
        viewing->GetPoint(at, c);
        viewing->GetPoint(at + 1, d);
        const double length = Value(rest->GetPointData(), "SegmentLength", at);
        FFD_CHECK_NEAR(length, FFDDistance(c, d), 1e-9);
        FFD_CHECK_NEAR(Value(rest->GetPointData(), "RestLength", at), FFDDistance(a, b), 1e-9);
        FFD_CHECK_NEAR(
          Value(rest->GetPointData(), "T", at + 1) - Value(rest->GetPointData(), "T", at), length,
          1e-9);
        FFD_CHECK(Value(rest->GetPointData(), "Segment", at) == n);
        FFD_CHECK(length <= 6.0 + 1e-9);
        // Section 4.5: a turn of more than 5 degrees only between the shortest segments.
        double direction[3];
        vtkMath::Subtract(b, a, direction);
        if (n > 0 && length > 0.5 + 1e-9)
        {
          FFD_CHECK(vtkMath::DegreesFromRadians(
                      vtkMath::AngleBetweenVectors(previous, direction)) <= 5.0 + 1e-6);
        }
        shortest += length < 3.0 ? 1 : 0;
        std::copy(direction, direction + 3, previous);
        samplesOfRay += Value(rest->GetPointData(), "Samples", at);
        lengths += length;
        FFD_CHECK(Value(rest->GetPointData(), "Leaps", at) == 0.0);
        FFD_CHECK(Value(rest->GetPointData(), "Passed", at) == 0.0);
      }
      FFD_CHECK(samplesOfRay == Value(rest->GetCellData(), "Samples", cell));
      FFD_CHECK(Value(rest->GetPointData(), "Segment", ids->GetId(count - 1)) == -1.0);
    }
    FFD_CHECK(shortest > 3);
    for (vtkIdType i = 0; i < samples->GetNumberOfPoints(); ++i)
    {
      intervals += Value(samples->GetPointData(), "Interval", i);
      FFD_CHECK(Value(samples->GetPointData(), "Leap", i) == 0.0);
      double q[3];
      samples->GetPoint(i, q);
      FFD_CHECK(q[0] >= -1e-9 && q[0] <= 23.0 + 1e-9);
    }
    // What lies outside of the volume is not sampled.
    FFD_CHECK(samples->GetNumberOfPoints() > 300 && intervals < lengths);
  }
  return EXIT_SUCCESS;
}

int TestAgainstPicture()
{
  FFDTestScene scene;
  scene.Mapper->ReferenceKernelsOn();
  scene.Mapper->CollectStatisticsOn();
  vtkNew<vtkFFDRayTracer> tracer;
  tracer->SetRenderer(scene.Renderer);
  tracer->SetVolume(scene.Volume);
  tracer->SetImageSize(Side, Side);
  tracer->AddPixelGrid(Side, Side);
  for (const int segmentation :
    { vtkFFDInverseRayVolumeMapper::ERROR_BOUND, vtkFFDInverseRayVolumeMapper::GREEDY_ANGLE })
  {
    for (int leaping = vtkFFDInverseRayVolumeMapper::OFF;
         leaping <= vtkFFDInverseRayVolumeMapper::LIPSCHITZ; ++leaping)
    {
      scene.Mapper->SetSegmentation(segmentation);
      scene.Mapper->SetSpaceLeaping(leaping);
      const std::vector<unsigned char> picture = scene.Render(Side);
      vtkFFDRayStatistics* statistics = scene.Mapper->GetStatistics();
      tracer->Update();
      vtkPolyData* rest = tracer->GetOutput(0);
      double rays = 0.0;
      double samples = 0.0;
      double visible = 0.0;
      double leaps = 0.0;
      double sampled = 0.0;
      double passed = 0.0;
      vtkNew<vtkIdList> ids;
      std::vector<unsigned char> colors(picture.size(), 0);
      for (vtkIdType cell = 0; cell < rest->GetNumberOfLines(); ++cell)
      {
        rest->GetCellPoints(cell, ids);
        rays += 1.0;
        samples += Value(rest->GetCellData(), "Samples", cell);
        visible += Value(rest->GetCellData(), "VisibleSamples", cell);
        leaps += Value(rest->GetCellData(), "Leaps", cell);
        double last = -1.0;
        for (vtkIdType n = 0; n < ids->GetNumberOfIds(); ++n)
        {
          const double segment = Value(rest->GetPointData(), "Segment", ids->GetId(n));
          if (segment >= 0.0 && segment != last)
          {
            (Value(rest->GetPointData(), "Passed", ids->GetId(n)) != 0.0 ? passed : sampled) += 1.0;
            last = segment;
          }
        }
        const double pixel = Value(rest->GetCellData(), "Pixel", cell, 0) +
          Side * Value(rest->GetCellData(), "Pixel", cell, 1);
        for (int c = 0; c < 4; ++c)
        {
          colors[static_cast<std::size_t>(4 * pixel + c)] =
            static_cast<unsigned char>(Value(rest->GetCellData(), "Color", cell, c));
        }
      }
      FFD_CHECK(colors == picture);
      FFD_CHECK(rays == statistics->GetNumberOfRays() && rays > 100);
      FFD_CHECK_NEAR(samples, statistics->GetSamplesPerRay() * rays, 1e-6 * samples);
      FFD_CHECK_NEAR(visible, statistics->GetVisibleSamplesPerRay() * rays, 1e-6 * samples);
      FFD_CHECK_NEAR(leaps, statistics->GetDistanceLookupsPerRay() * rays, 1e-6 * samples);
      const bool greedy = segmentation == vtkFFDInverseRayVolumeMapper::GREEDY_ANGLE;
      FFD_CHECK_NEAR(greedy ? sampled + passed : sampled, statistics->GetSegmentsPerRay() * rays,
        1e-6 * samples);
      FFD_CHECK((leaping == vtkFFDInverseRayVolumeMapper::OFF) == (leaps == 0.0));
      FFD_CHECK((greedy && leaping == vtkFFDInverseRayVolumeMapper::LIPSCHITZ) == (passed > 0.0));
      double inOutput = 0.0;
      double started = 0.0;
      vtkPolyData* positions = tracer->GetOutput(2);
      for (vtkIdType i = 0; i < positions->GetNumberOfPoints(); ++i)
      {
        (Value(positions->GetPointData(), "Leap", i) != 0.0 ? started : inOutput) += 1.0;
        const double opacity = Value(positions->GetPointData(), "Opacity", i);
        FFD_CHECK(opacity >= 0.0 && opacity <= 1.0);
      }
      FFD_CHECK(inOutput == samples && started == leaps);
    }
  }
  // Early termination shows.
  scene.Opacity->AddPoint(200.0, 1.0);
  tracer->Update();
  double terminated = 0.0;
  for (vtkIdType cell = 0; cell < tracer->GetOutput(0)->GetNumberOfLines(); ++cell)
  {
    terminated += Value(tracer->GetOutput(0)->GetCellData(), "Terminated", cell);
  }
  FFD_CHECK(terminated > 20.0);
  return EXIT_SUCCESS;
}

// What the packets used: segments of many samples, where they are, and their picture.
int TestSegments()
{
  FFDTestScene scene;
  scene.Mapper->CollectStatisticsOn();
  vtkNew<vtkFFDRayTracer> tracer;
  tracer->SetRenderer(scene.Renderer);
  tracer->SetVolume(scene.Volume);
  tracer->SetImageSize(Side, Side);
  tracer->AddPixelGrid(Side, Side);
  double passedBefore = 0.0;
  for (const int leaping :
    { vtkFFDInverseRayVolumeMapper::OFF, vtkFFDInverseRayVolumeMapper::LIPSCHITZ })
  {
    scene.Mapper->SetSpaceLeaping(leaping);
    const std::vector<unsigned char> picture = scene.Render(Side);
    vtkFFDRayStatistics* statistics = scene.Mapper->GetStatistics();
    tracer->Update();
    vtkPolyData* rest = tracer->GetOutput(0);
    vtkPolyData* viewing = tracer->GetOutput(1);
    double samples = 0.0;
    double segments = 0.0;
    double passed = 0.0;
    std::vector<unsigned char> colors(picture.size(), 0);
    for (vtkIdType cell = 0; cell < rest->GetNumberOfLines(); ++cell)
    {
      samples += Value(rest->GetCellData(), "Samples", cell);
      segments += Value(rest->GetCellData(), "Segments", cell);
      const double pixel = Value(rest->GetCellData(), "Pixel", cell, 0) +
        Side * Value(rest->GetCellData(), "Pixel", cell, 1);
      for (int c = 0; c < 4; ++c)
      {
        colors[static_cast<std::size_t>(4 * pixel + c)] =
          static_cast<unsigned char>(Value(rest->GetCellData(), "Color", cell, c));
      }
    }
    for (std::size_t i = 0; i < picture.size(); ++i)
    {
      FFD_CHECK_NEAR(colors[i], picture[i], 1.0);
    }
    FFD_CHECK(samples > 1000.0);
    FFD_CHECK(
      static_cast<vtkTypeInt64>(rest->GetNumberOfLines()) > statistics->GetNumberOfRays() / 2);
    FFD_CHECK_NEAR(samples,
      statistics->GetSamplesPerRay() * static_cast<double>(statistics->GetNumberOfRays()),
      0.02 * samples);
    FFD_CHECK(segments >= static_cast<double>(rest->GetNumberOfLines()));
    FFD_CHECK(segments < 8.0 * static_cast<double>(rest->GetNumberOfLines()));
    for (vtkIdType i = 0; i < rest->GetNumberOfPoints(); ++i)
    {
      passed += Value(rest->GetPointData(), "Passed", i);
      double p[3];
      double q[3];
      double t[3];
      viewing->GetPoint(i, p);
      rest->GetPoint(i, q);
      scene.Lattice->TransformPoint(q, t);
      // Outside of the volume the deformation is not that of the lattice, and does not matter.
      bool inside = true;
      for (const double at : q)
      {
        inside = inside && at >= 0.0 && at <= 23.0;
      }
      FFD_CHECK(
        !inside || Value(rest->GetPointData(), "Passed", i) != 0.0 || FFDDistance(p, t) < 0.2);
    }
    // Without leaping what is outside of the volume alone.
    FFD_CHECK(leaping == vtkFFDInverseRayVolumeMapper::OFF || passed > passedBefore);
    passedBefore = passed;
  }
  return EXIT_SUCCESS;
}

int TestChangesAndBadInput()
{
  FFDTestScene scene;
  vtkNew<vtkFFDRayTracer> tracer;
  vtkNew<FFDErrorLog> log;
  vtkNew<FFDErrorLog> pipeline;
  log->Watch(tracer);
  pipeline->Watch(tracer->GetExecutive());
  tracer->Update();
  FFD_CHECK(log->Had("no renderer"));
  tracer->SetRenderer(scene.Renderer);
  tracer->Update();
  FFD_CHECK(log->Had("no volume"));
  tracer->SetVolume(scene.Volume);
  tracer->SetImageSize(0, 10);
  FFD_CHECK(log->Had("0 x 10 is not possible"));
  tracer->SetImageSize(nullptr);
  FFD_CHECK(log->Had("null"));
  tracer->SetImageSize(Side, Side);
  tracer->AddPixelGrid(Side + 1, 1);
  FFD_CHECK(log->Had("do not fit"));
  tracer->AddPixel(Side, 0);
  tracer->AddPixel(Side / 2, Side / 2);
  tracer->Update();
  FFD_CHECK(scene.Errors->Had("no pixel (36, 0)"));
  FFD_CHECK(tracer->GetOutput(0)->GetNumberOfLines() == 1);
  tracer->RemoveAllPixels();
  FFD_CHECK(tracer->GetNumberOfPixels() == 0);
  tracer->AddPixel(Side / 2, Side / 2);
  // Camera, lattice and settings of the mapper are followed.
  const auto changes = [&](auto&& change) {
    const vtkMTimeType time = tracer->GetMTime();
    change();
    return tracer->GetMTime() > time;
  };
  FFD_CHECK(changes([&] { scene.Renderer->GetActiveCamera()->Azimuth(5.0); }));
  FFD_CHECK(changes([&] { scene.Lattice->SetDisplacement(2, 2, 2, 1.0, 1.0, 1.0); }));
  FFD_CHECK(changes([&] { scene.Mapper->SetAngleThreshold(2.0); }));
  FFD_CHECK(changes([&] { scene.Opacity->AddPoint(100.0, 0.5); }));
  FFD_CHECK(changes([&] { scene.Volume->SetPosition(1.0, 0.0, 0.0); }));
  tracer->Update();
  FFD_CHECK(log->Count == 0 && scene.Errors->Count == 0);
  // A mapper that cannot render says so.
  scene.Mapper->SetBlendMode(99);
  tracer->Update();
  FFD_CHECK(scene.Errors->Had("SetBlendModeToComposite"));
  return EXIT_SUCCESS;
}

} // namespace

int TestFFDRayTracer(int, char*[])
{
  return TestVertices() || TestAgainstPicture() || TestSegments() || TestChangesAndBadInput()
    ? EXIT_FAILURE
    : EXIT_SUCCESS;
}
