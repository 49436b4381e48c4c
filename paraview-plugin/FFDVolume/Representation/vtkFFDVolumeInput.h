// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDVolumeInput.h
 * What FFD Volume is given, as images. Private to this module.
 */
#ifndef vtkFFDVolumeInput_h
#define vtkFFDVolumeInput_h

#include "vtkFFDVolumeParts.h"

#include "vtkSmartPointer.h"
#include "vtkWeakPointer.h"

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

class vtkAbstractArray;
class vtkDataArray;
class vtkDataObject;
class vtkDataObjectTree;
class vtkDataSet;
class vtkFieldData;
class vtkImageData;

/**
 * Makes one image of a rectilinear grid, or of the blocks of a multi-block or partitioned data set,
 * so that all that is for images is for them, too: on one ray and in one partition among processes.
 * Blocks with other lattices make other images: a lattice per block gives an image per block.
 *
 * Blocks whose voxels lie on one grid, as those of a volume that was cut into pieces, are put
 * together as they are. Others are interpolated, to voxels as small as the smallest: rectilinear
 * grids with several processes, and blocks of unlike voxels. Points that no block has are blanked.
 * The voxels are made again only when arrays or blocks are other ones, not for a lattice.
 *
 * A rectilinear grid of one process is not interpolated: the image has its coordinates in its
 * field data, and is rendered as a rectilinear grid.
 */
class vtkFFDVolumeInput
{
public:
  /**
   * The images, each with the field data of the first of its blocks that has a lattice: as many, in
   * the same order, on all processes; null where there is nothing to render, here. `problem` then
   * says why, unless there are no data. To be called on all processes.
   */
  std::vector<vtkSmartPointer<vtkImageData>> Update(vtkDataObject* data, std::string& problem);

  ///@{
  /// The extents of an image that has data, all of it or those of its blocks.
  static std::vector<ffdparts::Extent> GetExtents(vtkImageData* image);
  /// The index of each of these in the composite data; 0 without blocks, -1 of one with voxels of
  /// its own.
  static std::vector<int> GetBlocks(vtkImageData* image);
  /// An array of integers in the field data of images: see vtkFFDPaintIdentifiers().
  static constexpr const char* PiecesName = "FFD.Pieces";
  /// Whether all points that are not in GetExtents() of any process are blanked.
  static bool HasBlocks(vtkImageData* image);
  ///@}

  /**
   * The blocks that this process has of composite data, images and others, by the lattice that they
   * have: as many groups, in the same order, on all processes, which all call it.
   */
  static std::vector<std::vector<vtkDataSet*>> GroupByLattice(vtkDataObjectTree* data);

  /// The coordinates along each axis of a rectilinear grid as an image; null for an image.
  static std::array<vtkDataArray*, 3> GetCoordinates(vtkImageData* image);

private:
  using Arrays = std::vector<std::pair<vtkWeakPointer<vtkAbstractArray>, vtkMTimeType>>;

  /// The grid that all voxels are put on.
  struct Frame
  {
    ffdparts::Grid Grid;  // the whole extent is not used
    bool Aligned = false; // all blocks have its spacing, and voxels at its points
  };

  static Frame FindFrame(const std::vector<vtkDataSet*>& blocks);
  /// Indices of blocks in the composite data.
  using Places = std::map<vtkDataSet*, unsigned int>;

  static vtkSmartPointer<vtkImageData> Merge(
    const std::vector<vtkDataSet*>& blocks, const Places& places, const Frame& frame);

  /// All that a merged image is made of.
  struct Content
  {
    Arrays Values;
    std::vector<double> Places;
  };
  static Content FindContent(const std::vector<vtkDataSet*>& blocks, const Places& blockPlaces);

  /// Blocks with the same lattice.
  struct Group
  {
    vtkSmartPointer<vtkImageData> Merged;
    Content Made; // what Merged was made of
  };
  static vtkSmartPointer<vtkImageData> Update(
    Group& group, const std::vector<vtkDataSet*>& blocks, const Places& places);

  std::vector<Group> Groups;
};

#endif
