// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// How far from the true deformed rays samples are taken, in voxels: the paper's polylines by their
// angle and by fixed lengths, and ERROR_BOUND by its tolerance.
#include "FFDPolyline.h"
#include "PositionError.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <string>

namespace
{

constexpr double Pi = 3.14159265358979323846;
const glm::dvec3 Extent(255.0);
constexpr int Voxels = 256;
constexpr int Pixels = 512;

struct Deformation
{
  std::string Name;
  ffd::BSplineField Field;
};

/// 8^3 control points over the volume, one cell beyond it on each side.
ffd::BSplineField MakeField(const std::function<glm::dvec3(const glm::dvec3&)>& move)
{
  constexpr int Side = 8;
  const glm::dvec3 spacing = Extent / static_cast<double>(Side - 3);
  std::vector<glm::dvec3> displacements;
  for (int i = 0; i < Side * Side * Side; ++i)
  {
    const glm::dvec3 at(i % Side, i / Side % Side, i / Side / Side);
    displacements.push_back(move((at - 1.0) / static_cast<double>(Side - 3)));
  }
  return ffd::BSplineField(glm::ivec3(Side), -spacing, spacing, displacements.data());
}

ffd::BSplineField MakeSmooth(double magnitude)
{
  const auto halfCosine = [](double u) { return std::cos(Pi * (u - 0.5)); };
  return MakeField([&](const glm::dvec3& u) {
    return magnitude * glm::dvec3(halfCosine(u.z), 22.0 / 45.0 * halfCosine(u.x), 0.0);
  });
}

ffd::BSplineField MakeRandom(double magnitude)
{
  RandomLattice random(3);
  return MakeField([&](const glm::dvec3&) { return random.Vector(-magnitude, magnitude); });
}

/// The camera of Examples/paper_experiments: perspective, three sides of the volume in view.
glm::dmat4 MakePaperCamera()
{
  const glm::dvec3 center = 0.5 * Extent;
  const double distance = 3.0 * Extent.x;
  const glm::dvec3 eye = center + distance * glm::normalize(glm::dvec3(0.75, 0.55, 1.0));
  return glm::perspective(2.0 * std::atan(0.25), 1.0, 0.2 * distance, 2.0 * distance) *
    glm::lookAt(eye, center, glm::dvec3(0.0, 1.0, 0.0));
}

struct Mode
{
  const char* Name;
  ffd::PullBackKind Kind;
};
constexpr Mode Modes[] = { { "FIRST_ORDER", ffd::PullBackKind::FirstOrder },
  { "EXACT", ffd::PullBackKind::Exact }, { "PULL_BACK", ffd::PullBackKind::Forward } };

/// Part of a ray inside of a box, or nothing.
bool Clip(const ffd::ViewRay& ray, const ffd::Box& box, double& from, double& to)
{
  from = 0.0;
  to = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    const double t0 = (box.Min[a] - ray.Origin[a]) / ray.Direction[a];
    const double t1 = (box.Max[a] - ray.Origin[a]) / ray.Direction[a];
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  return from < to;
}

void Print(const std::string& deformation, const char* mode, const char* segmentation,
  double parameter, double segmentsPer100, double evaluationsPerRay,
  const positionError::Tally& tally)
{
  std::printf("%s,%s,%s,%g,%.2f,%.2f,%.2e,%.2e\n", deformation.c_str(), mode, segmentation,
    parameter, segmentsPer100, evaluationsPerRay, tally.Largest(), tally.Mean());
}

/// The polylines of some rays, at `points` places of each segment.
void MeasurePolylines(const Deformation& deformation, const Mode& mode, const char* name,
  double parameter, const ffd::PolylineSettings& settings, const positionError::Scene& scene,
  int rays, int points)
{
  const ffd::PullBack map(&deformation.Field, mode.Kind, 1e-9);
  RandomLattice random(7);
  positionError::Tally tally;
  double segments = 0.0;
  double length = 0.0;
  double evaluations = 0.0;
  for (int measured = 0; measured < rays;)
  {
    const ffd::ViewRay ray = scene.Cast.Camera.MakeRay(
      random.Integer(0, Pixels - 1) + 0.5, random.Integer(0, Pixels - 1) + 0.5);
    double from;
    double to;
    if (!Clip(ray, scene.Cast.DeformedBounds, from, to))
    {
      continue;
    }
    ++measured;
    ffd::PolylineWalker walker(map, settings, ray.Origin, ray.Direction, from, to, false);
    ffd::PolylineVertex start = walker.GetVertex();
    while (walker.Next())
    {
      const ffd::PolylineVertex end = walker.GetVertex();
      const ffd::CurveSegment segment = ffd::CurveSegment::Line(start.Rest, end.Rest);
      ++segments;
      length += end.T - start.T;
      for (int i = 0; i <= points; ++i)
      {
        const double s = static_cast<double>(i) / points;
        ffd::PullBackStatus status;
        const double t = start.T + s * (end.T - start.T);
        const glm::dvec3 truth = map.Evaluate(ray.Origin + t * ray.Direction, status);
        tally.Errors.push_back(glm::length(segment.At(s) - truth));
      }
      start = end;
    }
    evaluations += walker.GetEvaluations();
  }
  Print(deformation.Name, mode.Name, name, parameter, 100.0 * segments / length, evaluations / rays,
    tally);
}

/// All segmentations of one deformation in one mode.
void Measure(const Deformation& deformation, const Mode& mode, int rays, int points)
{
  positionError::Scene scene(deformation.Field, mode.Kind, Extent, Voxels);
  scene.SetCamera(MakePaperCamera(), Pixels);
  for (const double degrees : { 1.0, 2.0, 5.0, 10.0, 20.0 })
  {
    ffd::PolylineSettings settings;
    settings.AngleThreshold = degrees * Pi / 180.0;
    MeasurePolylines(deformation, mode, "GREEDY_ANGLE", degrees, settings, scene, rays, points);
  }
  for (const double length : { 1.0, 2.0, 4.0, 8.0 })
  {
    ffd::PolylineSettings settings;
    settings.MinimumLength = length;
    settings.MaximumLength = length;
    MeasurePolylines(deformation, mode, "FIXED", length, settings, scene, rays, points);
  }
  for (const double tolerance : { 0.01, 0.05, 0.1, 0.2, 0.5 })
  {
    scene.Settings.ErrorBound.PositionTolerance = tolerance;
    RandomLattice random(7);
    positionError::Tally tally;
    scene.Measure(random, static_cast<std::size_t>(rays) * points * 25, tally);
    const ffd::CastStatistics& s = tally.Statistics;
    Print(deformation.Name, mode.Name, "ERROR_BOUND", tolerance,
      100.0 * static_cast<double>(s.Segments) / s.SegmentLength,
      static_cast<double>(s.Evaluations) / static_cast<double>(s.Rays), tally);
  }
}

} // namespace

int main(int argc, char* argv[])
{
  const bool quick = argc == 2 && std::strcmp(argv[1], "--quick") == 0;
  if (argc > 1 && !quick)
  {
    std::fprintf(stderr,
      "usage: ffd_position_error [--quick]\n"
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
  std::printf("deformation,inverse,segmentation,parameter,segments_per_100_voxels,"
              "evaluations_per_ray,largest_error,mean_error\n");
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
