// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDVolumeParts.h
 * Distribution of the rendering of one deformed volume over processes. Private to this module.
 *
 * Boxes of *deformed* space are shared out, one a process, and each renders the parts of the rays
 * in its box: boxes can be put in order for any camera, which deformed pieces of the volume
 * cannot. For its box a process needs the voxels that the box is pulled back to, which the control
 * points bound.
 */
#ifndef vtkFFDVolumeParts_h
#define vtkFFDVolumeParts_h

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <array>
#include <functional>
#include <vector>

class vtkFFDInverseRayVolumeMapper;
class vtkFFDLattice;
class vtkImageData;
class vtkMatrix4x4;
class vtkMultiProcessController;

namespace ffdparts
{

using Bounds = std::array<double, 6>;
using Extent = std::array<int, 6>;

/// No voxel, no place.
constexpr Extent NoExtent = { 0, -1, 0, -1, 0, -1 };
constexpr Bounds NoBounds = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 };

inline bool IsEmpty(const Extent& e) { return e[0] > e[1] || e[2] > e[3] || e[4] > e[5]; }
inline bool IsEmpty(const Bounds& b) { return !(b[0] <= b[1] && b[2] <= b[3] && b[4] <= b[5]); }
bool Contains(const Extent& outer, const Extent& inner);
Extent Intersect(const Extent& a, const Extent& b);
Bounds Intersect(const Bounds& a, const Bounds& b); ///< NoBounds where they touch at most
Bounds Unite(const Bounds& a, const Bounds& b);
Bounds Transform(const Bounds& bounds, vtkMatrix4x4* matrix); ///< around the eight corners

/// The whole image, of which a process may hold a part: extent, origin, spacing, direction.
struct Grid
{
  Extent WholeExtent = NoExtent;
  std::array<double, 3> Origin{ { 0.0, 0.0, 0.0 } };
  std::array<double, 3> Spacing{ { 1.0, 1.0, 1.0 } };
  std::array<double, 9> Direction{ { 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 } };

  static Grid FromImage(vtkImageData* image, const Extent& wholeExtent);
  void ApplyTo(vtkImageData* image) const; ///< origin, spacing, direction
  Bounds GetBounds() const;                ///< of the whole, data coordinates

  /// What is not a number equals itself here, or else such an image would change all the time.
  bool operator==(const Grid& other) const;
};

/**
 * Cut `bounds` into `count` boxes that fill it, by halving again and again; with a number that is
 * no power of two the sides are cut in proportion. `cost` says what a box is to its process (voxels
 * that it needs): the first sixteen cuts are across the axis on which the more expensive half is
 * cheapest, and the longest one unless another is better by more than two percent. A twist, for
 * instance, is cut along its axis: each half of what is cut beside it comes from everywhere.
 * Without a cost the longest side is cut.
 */
std::vector<Bounds> CutIntoBoxes(
  const Bounds& bounds, int count, const std::function<double(const Bounds&)>& cost = nullptr);

/// Whether two lattices are the same map.
bool AreEqual(vtkFFDLattice* a, vtkFFDLattice* b);

/// The box with the faces that it shares with `whole` moved to infinity.
Bounds OpenOutwards(const Bounds& box, const Bounds& whole);

/**
 * Finds bounds of deformed images, as the mapper that shows them does: mappers share what they
 * know, so a finder that is kept until the image is rendered saves its mapper the work. It looks
 * at what an edit has changed only.
 */
class DeformedBoundsFinder
{
public:
  DeformedBoundsFinder();
  ~DeformedBoundsFinder();

  /// Bounds of the image `grid` deformed by `lattice` (may be null): InverseMode as the mapper's.
  Bounds Find(const Grid& grid, vtkFFDLattice* lattice, int inverseMode);

private:
  vtkSmartPointer<vtkFFDInverseRayVolumeMapper> Mapper;
  vtkSmartPointer<vtkImageData> Corners; // a volume of eight voxels
};

/**
 * Bounds of the pull-back of boxes of deformed space, from the control points. The control
 * points of small lattices are made more for it: the cells of the bounds are then smaller than
 * those of the lattice, and the bounds tighter.
 */
class PullBackCover
{
public:
  PullBackCover();
  ~PullBackCover();

  /// `lattice` may be null; inverseMode as the mapper's. Cheap when nothing has changed.
  void SetDeformation(vtkFFDLattice* lattice, int inverseMode);

  /// Rest positions of what is seen in `box`, conservative.
  Bounds FindRestBounds(const Bounds& box) const;

private:
  vtkSmartPointer<vtkFFDLattice> Lattice; // as it was set
  vtkSmartPointer<vtkFFDLattice> Fine;    // the same map with smaller cells
  vtkSmartPointer<vtkFFDLattice> Inverse; // of Fine
  int InverseMode = 0;
  bool FoldFree = true;
};

/**
 * The voxels that are sampled, with their neighbors, where rays are in `box`. Empty when the box
 * is pulled back to none.
 */
Extent FindNeededExtent(const Grid& grid, const PullBackCover& cover, const Bounds& box);

/**
 * Threads of this process, at least one, so that the processes of a host share its processors. A
 * process that was bound to some of them has these. To be called on all processes.
 */
int FindNumberOfThreads(vtkMultiProcessController* controller);

/// Points of an extent.
vtkIdType CountPoints(const Extent& extent);

/// Copy the points of `region`, and the cells between them, with all arrays; those that `to` lacks
/// are made, with zeros elsewhere.
void CopyVoxels(vtkImageData* from, const Extent& fromExtent, vtkImageData* to,
  const Extent& toExtent, const Extent& region);

/// Whether one of the extents has the other.
bool Contains(const std::vector<Extent>& outer, const Extent& inner);

/**
 * Bring each process the voxels that it needs. `image` is what this process has (may be null),
 * `extents` what each has of it, one or several, `needed` what each needs, both for all processes
 * and the same on all of them. Returns an image of needed[own process] with all arrays, zero where
 * no process has a voxel, and blanked there if `blanks`; null when nothing is needed. To be called
 * on all processes.
 */
vtkSmartPointer<vtkImageData> ExchangeVoxels(vtkMultiProcessController* controller,
  const Grid& grid, vtkImageData* image, const std::vector<std::vector<Extent>>& extents,
  const std::vector<Extent>& needed, bool blanks);

} // namespace ffdparts

#endif
