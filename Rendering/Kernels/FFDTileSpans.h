// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTileSpans_h
#define FFDTileSpans_h

#include "FFDCameraView.h"
#include "FFDDeformedSpaceBounds.h"
#include "FFDExport.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace ffd
{

/// Parameters of ERROR_BOUND.
struct SpanSettings
{
  double Length = 8.0;          ///< longest span, units of t
  int LargestLevel = 4;         ///< a span is halved at most so often
  int UnprovenLevel = 2;          ///< where no error can be proven, because T folds or nearly so
  double PositionTolerance = 0.1; ///< voxels
  /// Bounds of the second and third derivatives of the rays' directions across a tile, data units
  /// per unit of t, by steps of a node; see SetDirectionBends. 0: the rays are parallel.
  double DirectionBend2 = 0.0;
  double DirectionBend3 = 0.0;
};

/**
 * Perspective rays do not spread evenly: their unit directions lie on a sphere. Bounds that for
 * tiles of 16 pixels with 4 nodes a side anywhere on the image. `worldToData`: linear part.
 */
FFD_KERNEL_EXPORT void SetDirectionBends(
  SpanSettings& settings, const CameraView& camera, const glm::dmat3& worldToData);

/**
 * ERROR_BOUND: the parameter grid that all rays of an image tile share.
 *
 * The parameter t is cut into spans of fixed length, and each span into 2^level pieces of equal
 * length, on each of which a deformed ray is replaced by the parabola through its start, middle
 * and end. The level is the smallest for which the interpolation error
 * |d3Q/dt3| (piece / 2)^3 / (9 sqrt 3) is proven to stay under half the position
 * tolerance, over the box of deformed space that the rays of the tile cross in the span. What is
 * left of it is for interpolation across the tile. So the pieces, and with them the
 * samples, depend on the tile and the lattice alone: never on what space leaping skips.
 *
 * For each span the same box yields the range of the velocity dQ/dt: what a ray can move at most,
 * per direction, which is what LIPSCHITZ leaping subtracts from the distance to visible blocks.
 */
class FFD_KERNEL_EXPORT TileSpans
{
public:
  struct Span
  {
    bool Known = false;
    bool Bounded = false; ///< whether error and velocities are proven
    int Level = 0;
    double PositionError = 0.0;    ///< bound of parabola against true curve, voxels
    /// Whether rays may be interpolated between 4 x 4 nodes of the tile, corners included; the
    /// error of that is then in PositionError, too.
    bool Lateral = false;
    /// The same for 4 x 4 nodes in each quarter of the tile, where those of the tile do not do.
    bool LateralInQuarters = false;
    glm::dvec3 VelocityMin{ 0.0 }; ///< index units per unit of t
    glm::dvec3 VelocityMax{ 0.0 };
    /// How far, per direction, the nearest of 4 x 4 nodes can be from a ray at the same t, index
    /// units.
    glm::dvec3 NodeRadius{ 0.0 };
  };

  /**
   * Begin a tile. `origins`, `directions`: the rays through the corners of the tile, data
   * coordinates, unit of t. `dataToIndex`: linear part of the map to index coordinates.
   */
  void Start(const DeformedSpaceBounds& bounds, const SpanSettings& settings,
    const glm::dmat3& dataToIndex, const glm::dvec3 origins[4], const glm::dvec3 directions[4],
    double tMin, double tMax);

  double GetLength() const { return this->Settings.Length; }
  int GetFirst() const { return this->First; }
  int GetNumberOfSpans() const { return static_cast<int>(this->Spans.size()); }

  /// Span `index`: t in [index, index + 1] * GetLength(). Found on first use.
  const Span& Get(int index)
  {
    Span& span = this->Spans[static_cast<std::size_t>(index - this->First)];
    if (!span.Known)
    {
      this->Find(index, span);
    }
    return span;
  }

private:
  /// What there is to know of the rays of the tile within a span.
  struct Course;
  struct LocalCourse;
  void Find(int index, Span& span) const;
  Course FindCourse(const double t[2]) const;
  bool FindLocalCourse(const Course& course, LocalCourse& local) const;
  void SetPieces(double third, const double bends[2], Span& span) const;
  void SetMotion(const Course& course, const glm::dmat3& jacobianMin,
    const glm::dmat3& jacobianMax, Span& span) const;

  const DeformedSpaceBounds* Bounds = nullptr;
  SpanSettings Settings;
  glm::dmat3 DataToIndex{ 1.0 };
  double VoxelsPerDataUnit = 1.0;
  glm::dvec3 Origins[4];
  glm::dvec3 Directions[4];
  glm::dvec3 DirectionMin{ 0.0 };
  glm::dvec3 DirectionMax{ 0.0 };
  double Sagitta = 0.0;
  double LargestSpeed = 0.0;
  int First = 0;
  std::vector<Span> Spans;
};

} // namespace ffd

#endif
