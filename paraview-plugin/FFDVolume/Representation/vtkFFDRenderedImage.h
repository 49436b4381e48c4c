// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDRenderedImage.h
 * The image that FFD Volume gives its mapper. Private to this module.
 */
#ifndef vtkFFDRenderedImage_h
#define vtkFFDRenderedImage_h

#include "vtkFFDShownArray.h"
#include "vtkFFDVolumeParts.h"

#include "FFDStage.h"

#include "vtkSmartPointer.h"

#include <array>

class vtkDataArray;
class vtkDataSet;
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

/// A component of an array of an image.
struct vtkFFDShownComponent
{
  static constexpr int Magnitude = -1;
  static constexpr int All = -2;

  vtkFFDShownArray Array; ///< without a name: none
  int Component = Magnitude;

  bool operator==(const vtkFFDShownComponent& other) const
  {
    return this->Array == other.Array && this->Component == other.Component;
  }
};

/// Components that are rendered.
struct vtkFFDShownComponents
{
  /// The name of Second in the rendered image.
  static constexpr const char* SecondName = "FFDSecondArray";

  vtkFFDShownComponent Color;
  vtkFFDShownComponent Opacity; ///< a second component of what is rendered, if there is one
  vtkFFDShownComponent Second;  ///< the other axis of a two-dimensional function, if it is an array

  bool operator==(const vtkFFDShownComponents& other) const
  {
    return this->Color == other.Color && this->Opacity == other.Opacity &&
      this->Second == other.Second;
  }
};

/// Of the points of a rectilinear grid along x, y and z; null for an image.
using vtkFFDCoordinates = std::array<ffd::Source<vtkDataArray>, 3>;

/// The arrays of vtkFFDShownComponents in an image; null where it lacks them.
struct vtkFFDShownSources
{
  ffd::Source<vtkDataArray> Color;
  ffd::Source<vtkDataArray> Opacity;
  ffd::Source<vtkDataArray> Second;

  bool operator==(const vtkFFDShownSources& other) const
  {
    return this->Color == other.Color && this->Opacity == other.Opacity &&
      this->Second == other.Second;
  }
};

/// An image with what is shown on its points, which may be of the points or the cells of an image
/// over `grid`: an array of the name of the array for color, and one named SecondName.
/// With coordinates of a rectilinear grid it is one.
ffd::Made MakeRenderedImage(vtkSmartPointer<vtkDataSet>& result, ffd::StageTools& tools,
  const ffdparts::Grid& grid, const vtkFFDCoordinates& coordinates,
  const vtkFFDShownComponents& shown, const vtkFFDShownSources& sources,
  const vtkFFDGhosts& ghosts);

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
  void Update(vtkImageData* given, const vtkFFDShownComponents& shown);

  ///@{
  /// Of the last update; the lattice may be null.
  vtkDataSet* GetImage() const { return this->Image.Get(); }
  vtkFFDLattice* GetLattice() const { return this->Lattice.Get(); }
  ///@}

private:
  ffd::StageOrder Order;
  ffd::Stage<&MakeRenderedImage> Image{ Order };
  ffd::Stage<&MakeAttachedLattice> Lattice{ Order };
};

#endif
