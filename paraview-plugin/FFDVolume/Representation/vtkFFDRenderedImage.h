// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDRenderedImage.h
 * What FFD Volume gives its mapper. Private to this module.
 */
#ifndef vtkFFDRenderedImage_h
#define vtkFFDRenderedImage_h

#include "vtkFFDShownArray.h"
#include "vtkFFDVolumeParts.h"

#include "FFDStage.h"

#include "vtkSmartPointer.h"

class vtkDataArray;
class vtkFFDLattice;
class vtkFieldData;
class vtkImageData;
class vtkUnsignedCharArray;

/// Flags of vtkGhostType; null where nothing is blanked.
struct vtkFFDGhosts
{
  ffd::Source<vtkUnsignedCharArray> OfPoints;
  ffd::Source<vtkUnsignedCharArray> OfCells;

  bool operator==(const vtkFFDGhosts& other) const
  {
    return this->OfPoints == other.OfPoints && this->OfCells == other.OfCells;
  }
};

/// An image with one array of one component on its points: that of the points or the cells of an
/// image over `grid`, of which `component`, or the magnitude for -1, is taken.
ffd::Made MakeRenderedImage(vtkSmartPointer<vtkImageData>& result, ffd::StageTools& tools,
  const ffdparts::Grid& grid, const vtkFFDShownArray& shown, int component,
  const ffd::Source<vtkDataArray>& array, const vtkFFDGhosts& ghosts);

/// The lattice that is attached by the field data; null if there is none.
ffd::Made MakeAttachedLattice(vtkSmartPointer<vtkFFDLattice>& result, ffd::StageTools& tools,
  const ffd::Source<vtkFieldData>& fields);

/**
 * Derives the image and the lattice that the mapper renders from the image that a process was
 * given. The image is left alone while only the lattice changes, so that the mapper keeps what it
 * has found out about the voxels.
 */
class vtkFFDRenderedImage
{
public:
  /// `component` as MakeRenderedImage() takes it.
  void Update(vtkImageData* given, const vtkFFDShownArray& shown, int component);

  ///@{
  /// Of the last update; the lattice may be null.
  vtkImageData* GetImage() const { return this->Image.Get(); }
  vtkFFDLattice* GetLattice() const { return this->Lattice.Get(); }
  ///@}

private:
  ffd::StageOrder Order;
  ffd::Stage<&MakeRenderedImage> Image{ Order };
  ffd::Stage<&MakeAttachedLattice> Lattice{ Order };
};

#endif
