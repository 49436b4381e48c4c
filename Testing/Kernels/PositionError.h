// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// How far the positions that the ray caster samples lie from the true ones, in voxels.
#ifndef PositionError_h
#define PositionError_h

#include "FFDRayCaster.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

namespace positionError
{

/// Distances of sampled positions from Phi(P), voxels.
struct Tally
{
  std::vector<double> Errors;
  std::int64_t Lost = 0; ///< samples whose true position was not found
  ffd::CastStatistics Statistics;

  double Largest() const
  {
    return this->Errors.empty() ? 0.0 : *std::max_element(this->Errors.begin(), this->Errors.end());
  }
  double Mean() const
  {
    double sum = 0.0;
    for (const double error : this->Errors)
    {
      sum += error;
    }
    return this->Errors.empty() ? 0.0 : sum / static_cast<double>(this->Errors.size());
  }
  double Share(double above) const
  {
    const auto count = std::count_if(
      this->Errors.begin(), this->Errors.end(), [&](double error) { return error > above; });
    return this->Errors.empty()
      ? 0.0
      : static_cast<double>(count) / static_cast<double>(this->Errors.size());
  }
};

/// Whether the determinant of J_T is above `least` at some points of every cell, so that T is one
/// to one.
inline bool IsOneToOne(const ffd::BSplineField& field, double least)
{
  const glm::ivec3 first = field.GetFirstCell();
  const glm::ivec3 end = field.GetEndCell();
  constexpr int PerCell = 3;
  for (int k = PerCell * first.z; k <= PerCell * end.z; ++k)
  {
    for (int j = PerCell * first.y; j <= PerCell * end.y; ++j)
    {
      for (int i = PerCell * first.x; i <= PerCell * end.x; ++i)
      {
        const glm::dvec3 p = field.GetOrigin() +
          field.GetSpacing() *
            glm::clamp(glm::dvec3(i, j, k) / static_cast<double>(PerCell), glm::dvec3(first) + 1e-6,
              glm::dvec3(end) - 1e-6);
        glm::dmat3 jacobian;
        field.Displacement(p, jacobian);
        if (!(glm::determinant(glm::dmat3(1.0) + jacobian) > least))
        {
          return false;
        }
      }
    }
  }
  return true;
}

/// A volume without empty space in the lattice, cast by a camera.
class Scene
{
public:
  /// `side`: voxels along the longest edge of the volume [0, extent].
  Scene(const ffd::BSplineField& field, ffd::PullBackKind kind, const glm::dvec3& extent, int side)
    : Map(&field, kind, 1e-9)
  {
    const double voxel = std::max({ extent.x, extent.y, extent.z }) / (side - 1);
    ffd::VolumeView& volume = this->Cast.Volume;
    volume.Dimensions = glm::max(glm::ivec3(glm::round(extent / voxel)) + 1, glm::ivec3(4));
    // Every row is the same one.
    this->Row.assign(static_cast<std::size_t>(volume.Dimensions.x) + 8, 100);
    volume.Scalars = this->Row.data();
    volume.Type = ffd::ScalarType::UInt8;
    volume.Increments[0] = 1;
    volume.Increments[1] = 0;
    volume.Increments[2] = 0;
    volume.IndexToData = glm::dmat3(voxel);
    volume.DataToIndex = glm::dmat3(1.0 / voxel);
    const float rgb[6] = { 1, 1, 1, 1, 1, 1 };
    const float opacity[2] = { 1e-6f, 1e-6f };
    this->Table = ffd::TransferTable(0.0, 255.0, 2, rgb, opacity, 1.0);
    this->Cast.Table = &this->Table;
    this->Cast.Map = &this->Map;
    const ffd::PullBackBounds bounds(this->Map);
    this->Cast.Limits = bounds.GetLimits();
    this->Cast.DeformedBounds = bounds.DeformedBounds({ glm::dvec3(0.0), extent });
    this->Cast.VoxelSize = voxel;
    this->Settings.Leaping = ffd::SpaceLeaping::Off;
    this->Settings.SampleDistance = voxel;
    this->Settings.ErrorBound.LongestSegment = 64.0 * voxel;
    this->Settings.ErrorBound.ShortestSegment = 0.5 * voxel;
  }

  void SetCamera(const glm::dmat4& dataToNdc, int pixels)
  {
    ffd::CameraView& camera = this->Cast.Camera;
    camera.DataToNdc = dataToNdc;
    camera.NdcToData = glm::inverse(dataToNdc);
    camera.ImageSize = glm::ivec2(pixels);
    camera.NdcPerPixel = glm::dvec2(2.0 / pixels);
    camera.NdcOrigin = glm::dvec2(-1.0);
  }

  /// Errors of about `count` positions, of tiles taken by chance.
  void Measure(RandomLattice& random, std::size_t count, Tally& tally)
  {
    const ffd::RayCaster caster(this->Cast, this->Settings);
    const int pixels = this->Cast.Camera.ImageSize.x;
    std::vector<float> colors(4 * static_cast<std::size_t>(pixels) * pixels);
    ffd::CastImage image;
    image.Width = pixels;
    image.Height = pixels;
    image.Colors = colors.data();
    auto scratch = std::make_unique<ffd::RayCaster::Scratch>();
    std::vector<ffd::SampledPosition> positions;
    scratch->Packets.Positions = &positions;
    const int tiles = caster.GetNumberOfTiles(image);
    const std::size_t wanted = tally.Errors.size() + count;
    constexpr std::size_t PerTile = 1500;
    for (int turn = 0; turn < 3 * tiles && tally.Errors.size() < wanted; ++turn)
    {
      positions.clear();
      caster.RenderTile(random.Integer(0, tiles - 1), image, *scratch);
      const std::size_t step = std::max<std::size_t>(1, positions.size() / PerTile);
      for (std::size_t i = 0; i < positions.size(); i += step)
      {
        this->Add(positions[i], tally);
      }
    }
    tally.Statistics.Add(ffd::RayCaster::GetStatistics(*scratch));
  }

  ffd::CastScene Cast;
  ffd::CastSettings Settings;

private:
  void Add(const ffd::SampledPosition& sample, Tally& tally) const
  {
    const ffd::VolumeView& volume = this->Cast.Volume;
    const ffd::ViewRay ray = this->Cast.Camera.MakeRay(sample.X + 0.5, sample.Y + 0.5);
    const double t = sample.T + this->Cast.Camera.FindMiddleT(ray, FindMiddle(this->Cast));
    const glm::dvec3 p = ray.At(t);
    const glm::dvec3 index(sample.Index[0], sample.Index[1], sample.Index[2]);
    glm::dvec3 q;
    if (InvertsTheField(this->Map.GetKind()))
    {
      int evaluations = 0;
      if (!SolveInverse(*this->Map.GetField(), p, volume.IndexToData * index, 1e-9, q, evaluations))
      {
        ++tally.Lost;
        return;
      }
    }
    else
    {
      ffd::PullBackStatus status;
      q = this->Map.Evaluate(p, status);
    }
    tally.Errors.push_back(glm::length(volume.ToIndex(q) - index));
  }

  ffd::PullBack Map;
  ffd::TransferTable Table;
  std::vector<std::uint8_t> Row;
};

/// Cameras from near and far, perspective, parallel and inside of a volume [0, extent], which a
/// matrix presses flat in some scenes.
inline glm::dmat4 MakeCamera(RandomLattice& random, const glm::dvec3& extent)
{
  const double radius = 0.5 * glm::length(extent);
  const glm::dvec3 direction = glm::normalize(random.Vector(-1.0, 1.0) + 1e-3);
  const glm::dvec3 up = glm::normalize(random.Vector(-1.0, 1.0) + 2e-3);
  const int kind = random.Integer(0, 3);
  const double distance = kind == 0 ? 0.3 * radius : radius * random.Number(1.5, 6.0);
  const glm::dvec3 target = 0.5 * extent + 0.3 * random.Vector(-1.0, 1.0) * extent;
  const glm::dmat4 view = glm::lookAt(target + distance * direction, target, up);
  const double near = std::max(0.02 * radius, distance - 2.5 * radius);
  const double far = distance + 3.0 * radius;
  const glm::dmat4 projection = kind == 1
    ? glm::ortho(-radius, radius, -radius, radius, near, far)
    : glm::perspective(
        kind == 0 ? 1.5 : 2.0 * std::atan(radius * random.Number(0.3, 1.1) / distance), 1.0, near,
        far);
  glm::dvec3 scale(1.0);
  scale[random.Integer(0, 2)] =
    random.Integer(0, 3) == 0 ? std::exp(-random.Number(0.0, 12.0)) : 1.0;
  const glm::dmat4 flat = glm::scale(glm::translate(glm::dmat4(1.0), target), scale);
  return projection * view * glm::translate(flat, -target);
}

/// A lattice over [0, extent] that is one to one: random displacements, or a smooth twist, bend or
/// wave.
inline ffd::BSplineField MakeField(
  RandomLattice& random, const glm::dvec3& extent, std::string& name)
{
  for (double part = 1.0;; part *= 0.7)
  {
    const int side = random.Integer(4, 20);
    const int shape = random.Integer(0, 3);
    const double amount = part * random.Number(0.1, 1.0);
    const glm::dvec3 spacing = extent / static_cast<double>(side - 3);
    const glm::dvec3 origin = -spacing;
    std::vector<glm::dvec3> displacements;
    for (int i = 0; i < side * side * side; ++i)
    {
      const glm::dvec3 p =
        origin + spacing * glm::dvec3(i % side, i / side % side, i / side / side);
      const glm::dvec3 u = p / extent - 0.5;
      glm::dvec3 d(0.0);
      if (shape == 0)
      {
        d = 0.8 * amount * random.Vector(-1.0, 1.0) * spacing;
      }
      else if (shape == 1)
      {
        const double angle = 3.1 * amount * u.z;
        d = glm::dvec3(std::cos(angle) * u.x - std::sin(angle) * u.y - u.x,
              std::sin(angle) * u.x + std::cos(angle) * u.y - u.y, 0.0) *
          extent;
      }
      else if (shape == 2)
      {
        d =
          glm::dvec3(0.5 * amount * std::cos(3.1 * u.z), 0.25 * amount * std::cos(3.1 * u.x), 0.0) *
          extent;
      }
      else
      {
        d = -0.7 * amount * u * std::exp(-4.0 * glm::dot(u, u)) * extent;
      }
      displacements.push_back(d);
    }
    const ffd::BSplineField field(glm::ivec3(side), origin, spacing, displacements.data());
    if (IsOneToOne(field, 0.05))
    {
      constexpr const char* Shapes[] = { "random", "twist", "wave", "bulge" };
      name = std::string(Shapes[shape]) + " " + std::to_string(side) + "^3";
      return field;
    }
  }
}

} // namespace positionError

#endif
