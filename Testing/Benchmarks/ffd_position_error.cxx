// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Prints, as CSV, how far the pieces that deformed rays are cut into lie from the true curves: for
// GREEDY_ANGLE by angle, for segments of fixed length, and for ERROR_BOUND by tolerance, with all
// inverse modes, over rays of a 512 x 512 picture of a 256 x 256 x 113 volume.
//
// usage: ffd_position_error [--quick]
#include "PositionError.h"
#include "RandomLattice.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace
{

constexpr int Pixels = 512;
constexpr double Pi = 3.14159265358979323846;

/// Voxels of edge 1: data, world and index coordinates are the same.
const ffd::Box Volume{ glm::dvec3(0.0), glm::dvec3(255.0, 255.0, 112.0) };

struct Deformation
{
  std::string Name;
  ffd::BSplineField Field;
};

/// `side`^3 control points over the volume, with one cell more around it.
template <class Move>
ffd::BSplineField MakeField(int side, const Move& move)
{
  const glm::dvec3 spacing = (Volume.Max - Volume.Min) / static_cast<double>(side - 3);
  const glm::dvec3 origin = Volume.Min - spacing;
  std::vector<glm::dvec3> displacements;
  for (int k = 0; k < side; ++k)
  {
    for (int j = 0; j < side; ++j)
    {
      for (int i = 0; i < side; ++i)
      {
        const glm::dvec3 p = origin + glm::dvec3(i, j, k) * spacing;
        displacements.push_back(move((p - Volume.Min) / (Volume.Max - Volume.Min)));
      }
    }
  }
  return ffd::BSplineField(glm::ivec3(side), origin, spacing, displacements.data());
}

ffd::BSplineField MakeSmooth(double magnitude)
{
  const auto halfCosine = [](double u) { return std::cos(Pi * (u - 0.5)); };
  return MakeField(8,
    [&](const glm::dvec3& u) {
      return magnitude * glm::dvec3(halfCosine(u.z), 22.0 / 45.0 * halfCosine(u.x), 0.0);
    });
}

ffd::BSplineField MakeRandom(double magnitude)
{
  RandomLattice random(3);
  return MakeField(
    8, [&](const glm::dvec3&) { return random.Vector(-magnitude, magnitude); });
}

/// The camera of Examples/paper_experiments: perspective, three sides of the volume in view.
ffd::CameraView MakeCamera()
{
  const glm::dvec3 centre = 0.5 * (Volume.Min + Volume.Max);
  const double distance = 3.0 * (Volume.Max.x - Volume.Min.x);
  const glm::dvec3 eye = centre + distance * glm::normalize(glm::dvec3(0.75, 0.55, 1.0));
  ffd::CameraView camera;
  camera.WorldToNdc =
    glm::perspective(2.0 * std::atan(0.25), 1.0, 0.2 * distance, 2.0 * distance) *
    glm::lookAt(eye, centre, glm::dvec3(0.0, 1.0, 0.0));
  camera.NdcToWorld = glm::inverse(camera.WorldToNdc);
  camera.ImageSize = glm::ivec2(Pixels);
  camera.NdcPerPixel = glm::dvec2(2.0 / Pixels);
  return camera;
}

/// Part of a ray inside of a box, or nothing.
bool Clip(const glm::dvec3& origin, const glm::dvec3& direction, const ffd::Box& box, double& from,
  double& to)
{
  from = 0.0;
  to = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    const double t0 = (box.Min[a] - origin[a]) / direction[a];
    const double t1 = (box.Max[a] - origin[a]) / direction[a];
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  return from < to;
}

struct Mode
{
  const char* Name;
  ffd::PullBackKind Kind;
};
constexpr Mode Modes[] = { { "FIRST_ORDER", ffd::PullBackKind::FirstOrder },
  { "EXACT", ffd::PullBackKind::Exact }, { "PULL_BACK", ffd::PullBackKind::Forward } };

void Print(const std::string& deformation, const char* mode, const char* segmentation,
  double parameter, const positionError::Tally& tally)
{
  std::printf("%s,%s,%s,%g,%lld,%.2f,%.2f,%.2e,%.2e,%.2e,%.4f,%.4f,%.2e\n", deformation.c_str(),
    mode, segmentation, parameter, static_cast<long long>(tally.Pieces),
    100.0 * static_cast<double>(tally.Pieces) / tally.Length,
    tally.Length / static_cast<double>(tally.Pieces), tally.Largest, tally.LargestSideways,
    tally.Mean(), static_cast<double>(tally.Proven) / static_cast<double>(tally.Pieces),
    static_cast<double>(tally.Lateral) / static_cast<double>(tally.Pieces), tally.LargestUnproven);
}

/// All segmentations of one deformation in one mode; `rays` rays, four of each tile.
void Measure(const Deformation& deformation, const Mode& mode, int rays, int points)
{
  constexpr int RaysPerTile = 4;
  const ffd::PullBack map(&deformation.Field, mode.Kind, 1e-9);
  const ffd::PullBackBounds mapBounds(map);
  const ffd::Box deformed = mapBounds.DeformedBounds(Volume);
  const ffd::DeformedSpaceBounds bounds(
    map, mapBounds, { deformed.Min - 16.0, deformed.Max + 16.0 }, Volume, 16.0);
  const ffd::CameraView camera = MakeCamera();

  struct Ray
  {
    positionError::Tile Tile;
    double X;
    double Y;
    double From;
    double To;
  };
  std::vector<Ray> all;
  RandomLattice random(7);
  while (static_cast<int>(all.size()) < rays)
  {
    const positionError::Tile tile(camera, random.Integer(0, Pixels / 16 - 1) * 16,
      random.Integer(0, Pixels / 16 - 1) * 16, glm::dmat4(1.0), map, glm::dmat3(1.0));
    for (int i = 0; i < RaysPerTile; ++i)
    {
      const double x = random.Integer(0, 15);
      const double y = random.Integer(0, 15);
      glm::dvec3 origin;
      glm::dvec3 direction;
      tile.GetRay(x, y, origin, direction);
      double from;
      double to;
      if (Clip(origin, direction, deformed, from, to))
      {
        all.push_back({ tile, x, y, from, to });
      }
    }
  }

  ffd::PolylineSettings polyline;
  for (const double degrees : { 1.0, 2.0, 5.0, 10.0, 20.0 })
  {
    polyline.AngleThreshold = degrees * Pi / 180.0;
    positionError::Tally tally;
    for (const Ray& ray : all)
    {
      ray.Tile.MeasurePolyline(polyline, ray.X, ray.Y, ray.From, ray.To, points, tally);
    }
    Print(deformation.Name, mode.Name, "GREEDY_ANGLE", degrees, tally);
  }
  for (const double length : { 1.0, 2.0, 4.0, 8.0 })
  {
    polyline.MinimumLength = length;
    polyline.MaximumLength = length;
    positionError::Tally tally;
    for (const Ray& ray : all)
    {
      ray.Tile.MeasurePolyline(polyline, ray.X, ray.Y, ray.From, ray.To, points, tally);
    }
    Print(deformation.Name, mode.Name, "FIXED", length, tally);
  }
  for (const double tolerance : { 0.01, 0.05, 0.1, 0.2, 0.5 })
  {
    ffd::SpanSettings settings;
    settings.PositionTolerance = tolerance;
    positionError::Tally tally;
    for (const Ray& ray : all)
    {
      ffd::TileSpans spans;
      ray.Tile.Start(spans, bounds, settings, ray.From, ray.To);
      const int last = static_cast<int>(std::floor(ray.To / settings.Length));
      for (int index = static_cast<int>(std::floor(ray.From / settings.Length)); index <= last;
           ++index)
      {
        const int pieces = 1 << spans.Get(index).Level;
        for (int p = 0; p < pieces; ++p)
        {
          ray.Tile.MeasureSpan(spans, settings, index, p, ray.X, ray.Y, points, tally);
        }
      }
    }
    Print(deformation.Name, mode.Name, "ERROR_BOUND", tolerance, tally);
  }
}

} // namespace

int main(int argc, char* argv[])
{
  const bool quick = argc == 2 && std::strcmp(argv[1], "--quick") == 0;
  if (argc > 1 && !quick)
  {
    std::fprintf(stderr, "usage: ffd_position_error [--quick]\n"
                         "Prints a table of position errors as CSV; lengths in voxels.\n");
    return EXIT_FAILURE;
  }
  std::vector<Deformation> deformations;
  deformations.push_back({ "smooth 45", MakeSmooth(45.0) });
  deformations.push_back({ "random 15", MakeRandom(15.0) });
  if (!quick)
  {
    deformations.push_back({ "random 45", MakeRandom(45.0) });
  }
  std::printf("deformation,inverse,segmentation,parameter,pieces,pieces_per_100_voxels,"
              "mean_length,largest_error,largest_sideways,mean_error,proven,lateral,"
              "largest_unproven\n");
  for (const Deformation& deformation : deformations)
  {
    for (const Mode& mode : Modes)
    {
      Measure(deformation, mode, quick ? 24 : 400, quick ? 8 : 16);
      std::fflush(stdout);
    }
  }
  return EXIT_SUCCESS;
}
