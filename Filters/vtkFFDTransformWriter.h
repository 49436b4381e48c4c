// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDTransformWriter
 * @brief   write a deformation for registration tools
 *
 * The reverse of vtkFFDTransformReader; what it says about coordinates and conventions holds here.
 * The transform is taken as a map from fixed to moving points, in the given Coordinates.
 *
 * By FileFormat, or by the name:
 * - ITK_TEXT (.tfm, .txt): a vtkFFDLattice or vtkBSplineTransform as BSplineTransform, a linear
 *   transform as AffineTransform, a vtkGridTransform as DisplacementFieldTransform, and a
 *   vtkGeneralTransform of these as CompositeTransform.
 * - ELASTIX (TransformParameters*.txt): one vtkFFDLattice or vtkBSplineTransform, with the grid of
 *   ReferenceImage as the image that transformix makes (without one: the domain of the spline in
 *   256 steps of its longest side).
 * - META_IMAGE (.mha, .mhd), NRRD (.nrrd), NIFTI (.nii): any transform, as its displacements at the
 *   points of ReferenceImage, which is required; raw doubles.
 * - LATTICE (.vti): a vtkFFDLattice or vtkBSplineTransform as the image of its control points, in
 *   VTK's data coordinates, never turned.
 *
 * Transforms that are inverted have no such form: invert by fitting a lattice first
 * (vtkFFDFitLattice). A spline that is not zero outside of its grid (VTK_BSPLINE_EDGE) is so for
 * ITK, which does not deform there.
 *
 * @sa vtkFFDTransformReader vtkFFDLattice vtkFFDFitLattice
 */
#ifndef vtkFFDTransformWriter_h
#define vtkFFDTransformWriter_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkObject.h"
#include "vtkSmartPointer.h" // for vtkSmartPointer

class vtkAbstractTransform;
class vtkImageData;

class VTKFFDFILTERS_EXPORT vtkFFDTransformWriter : public vtkObject
{
public:
  static vtkFFDTransformWriter* New();
  vtkTypeMacro(vtkFFDTransformWriter, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum FileFormatType
  {
    BY_NAME = 0,
    ITK_TEXT,
    ELASTIX,
    META_IMAGE,
    NRRD,
    NIFTI,
    LATTICE
  };

  enum CoordinatesType
  {
    LPS = 0,
    RAS
  };

  ///@{
  /**
   * The file. An existing one is replaced, once all of the new one is known to be valid.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * What is written; null by default.
   */
  void SetTransform(vtkAbstractTransform* transform);
  vtkAbstractTransform* GetTransform();
  ///@}

  ///@{
  /**
   * Image whose points displacement fields are sampled at: dimensions, origin, spacing and
   * direction; scalars are not needed. In the given Coordinates. Default none.
   */
  void SetReferenceImage(vtkImageData* image);
  vtkImageData* GetReferenceImage();
  ///@}

  ///@{
  /**
   * Coordinate system of the transform, see vtkFFDTransformReader. Default LPS.
   */
  void SetCoordinates(int coordinates);
  vtkGetMacro(Coordinates, int);
  void SetCoordinatesToLPS() { this->SetCoordinates(LPS); }
  void SetCoordinatesToRAS() { this->SetCoordinates(RAS); }
  ///@}

  ///@{
  /**
   * Format, default BY_NAME: by the suffix, and .txt is elastix's where the name begins with
   * "TransformParameters".
   */
  void SetFileFormat(int format);
  vtkGetMacro(FileFormat, int);
  ///@}

  /**
   * Write the file. Returns 1, or 0 after an error that says what is missing or not possible.
   */
  int Write();

protected:
  vtkFFDTransformWriter();
  ~vtkFFDTransformWriter() override;

private:
  vtkFFDTransformWriter(const vtkFFDTransformWriter&) = delete;
  void operator=(const vtkFFDTransformWriter&) = delete;

  char* FileName;
  int Coordinates;
  int FileFormat;
  vtkSmartPointer<vtkAbstractTransform> Transform;
  vtkSmartPointer<vtkImageData> ReferenceImage;
};

#endif
