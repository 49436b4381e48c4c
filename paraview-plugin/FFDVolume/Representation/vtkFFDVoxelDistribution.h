// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDVoxelDistribution.h
 * The part of a volume that each of several processes renders. Private to this module.
 */
#ifndef vtkFFDVoxelDistribution_h
#define vtkFFDVoxelDistribution_h

#include "vtkFFDShownArray.h"
#include "vtkFFDVolumeParts.h"

#include "vtkSmartPointer.h"
#include "vtkWeakPointer.h"

#include <array>
#include <utility>
#include <vector>

class vtkAbstractArray;
class vtkDoubleArray;
class vtkFFDLattice;
class vtkImageData;
class vtkIntArray;
class vtkMultiProcessController;

/**
 * Cuts deformed space into boxes, one a process, and brings each process the voxels that its box is
 * pulled back to. All volumes of a view share one set of boxes, so that one order of the processes
 * is right for all of them.
 *
 * The voxels are exchanged when the data change, or when a box needs others than its process has;
 * an edit of the lattice most often needs none.
 */
class vtkFFDVoxelDistribution
{
public:
  using Bounds = ffdparts::Bounds;
  using Extent = ffdparts::Extent;

  /// All that the distribution depends on; it is made again when one of them is another.
  struct Inputs
  {
    vtkSmartPointer<vtkImageData> Image;     ///< what this process has of the data; may be null
    vtkMTimeType Time = 0;                   ///< of the data and the lattice in Image
    Extent WholeExtent = ffdparts::NoExtent; ///< as the pipeline announces it; may be empty
    vtkFFDShownArray Shown;
    int InverseMode = 0;             ///< as the mapper's
    bool HasOrder = true;            ///< whether parts can be blended in the order of the boxes
    std::array<double, 16> Matrix{}; ///< of the volume in the scene, row by row

    bool operator==(const Inputs& other) const;
  };

  /// What UpdateAll() takes. The image is null where this process has none.
  void SetInputs(const Inputs& inputs) { this->Next = inputs; }

  /**
   * Bring the parts of this process, of all volumes of a view, up to date with the inputs of all
   * processes. To be called on all processes of `controller`, with the volumes in the same order.
   */
  static void UpdateAll(
    vtkMultiProcessController* controller, const std::vector<vtkFFDVoxelDistribution*>& volumes);

  /**
   * The image that this process renders: its voxels with lattice, clip box, bounds of the whole,
   * and ranges of the shown array in the field data. Null when it renders none.
   */
  vtkImageData* GetPart() const { return this->Part; }

  /// The part of the scene that is this process's, world coordinates, the same for all volumes;
  /// empty while there are no data.
  const Bounds& GetOwnBox() const { return this->OwnBox; }

  /// Bounds of the whole deformed volume, data coordinates; empty while there are no data.
  const Bounds& GetDeformedBounds() const { return this->DeformedBounds; }

  /// Bounds of the whole volume at rest, data coordinates.
  Bounds GetRestBounds() const { return this->Given.Grid.GetBounds(); }

  ///@{
  /**
   * Reads the field data of a part; false if the image is no part. `clip` is the box of the
   * process, open towards the outside, and `whole` the bounds of the whole volume at rest.
   */
  static bool ReadBounds(vtkImageData* part, Bounds& clip, Bounds& whole);
  /// Of a component of the whole array, or of its magnitude for -1.
  static bool ReadRange(
    vtkImageData* part, const vtkFFDShownArray& shown, int component, std::array<double, 2>& range);
  ///@}

private:
  /// The arrays of an image and when they changed.
  using Sources = std::vector<std::pair<vtkWeakPointer<vtkAbstractArray>, vtkMTimeType>>;

  /// Parts of the data that each process has; the same on all of them.
  struct Holdings
  {
    ffdparts::Grid Grid;
    std::vector<std::vector<Extent>> Extents;
    std::vector<std::vector<int>> Blocks; ///< see vtkFFDVolumeInput::GetBlocks()
    bool HasBlocks = false;               ///< points outside of the extents are blanked
    int WithLattice = -1;                 ///< the first process that has a lattice; -1: none
    bool HasImage = false;
  };

  static Sources GetSources(vtkImageData* image);
  static Holdings GatherHoldings(vtkMultiProcessController* controller, const Inputs& inputs);
  void ShareLattice(vtkMultiProcessController* controller, vtkImageData* image, int root);
  static void DecideBoxes(
    vtkMultiProcessController* controller, const std::vector<vtkFFDVoxelDistribution*>& volumes);
  bool HoldsVoxelsOf(vtkImageData* image, const Extent& wanted) const;
  vtkSmartPointer<vtkImageData> GatherPart(
    vtkMultiProcessController* controller, vtkImageData* image, const Extent& wanted);
  void Describe(vtkDoubleArray* ranges);
  vtkIntArray* ListPieces();

  Inputs Next;
  Inputs Last;
  bool Made = false;                                // for Last
  std::vector<vtkFFDVoxelDistribution*> Companions; // volumes that it was made with
  Holdings Given;
  Bounds Box = ffdparts::NoBounds; // of this process, data coordinates
  vtkSmartPointer<vtkImageData> Part;
  vtkSmartPointer<vtkIntArray> Pieces;
  Bounds OwnBox = ffdparts::NoBounds;
  Bounds DeformedBounds = ffdparts::NoBounds;
  ffdparts::DeformedBoundsFinder BoundsFinder;

  vtkSmartPointer<vtkFFDLattice> Lattice; // that of all processes; null: none
  ffdparts::PullBackCover Cover;
  vtkSmartPointer<vtkImageData> Held; // voxels that were brought here last
  Sources HeldSources;                // of what image
};

#endif
