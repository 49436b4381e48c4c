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
 * - ITK_TEXT (.tfm, .txt): a vtkFFDLattice, vtkBSplineTransform or vtkFFDSplineTransform as
 *   BSplineTransform, a linear transform as AffineTransform, a vtkGridTransform that interpolates
 *   linearly as DisplacementFieldTransform, and a vtkGeneralTransform of up to 64 of these as
 *   CompositeTransform.
 * - ELASTIX (TransformParameters*.txt): one vtkFFDLattice, vtkBSplineTransform or
 *   vtkFFDSplineTransform, with the grid of ReferenceImage as the image that transformix makes
 *   (without one: the domain of the spline, 256 points along its longest side).
 * - META_IMAGE (.mha, .mhd), NRRD (.nrrd), NIFTI (.nii): any transform, as its displacements at the
 *   points of ReferenceImage, which is required and has at most 2^27 points; raw doubles. What is
 *   between the points is interpolated linearly by those who read it, see FieldTolerance. The data
 *   of an .mhd are in a .raw file of the same name, or in the .mhd itself where MetaImage cannot
 *   name that file (a name with %, one that begins with LIST or a blank).
 * - LATTICE (.vti): a vtkFFDLattice or vtkBSplineTransform, or the inverse of one, as the image of
 *   its control points, in VTK's data coordinates, never turned.
 *
 * Nothing is written of a transform with numbers that are not finite, in texts and lattices also
 * none with numbers that exceed 1e12, spacings below 1e-12 or a singular matrix. Transforms that
 * are inverted, and grids that are interpolated cubically or by the nearest, have no form in texts:
 * invert by fitting a lattice first (vtkFFDFitLattice). A spline that is not zero outside of its
 * grid (VTK_BSPLINE_EDGE) is so for ITK, which does not deform there.
 *
 * @sa vtkFFDTransformReader vtkFFDLattice vtkFFDFitLattice
 */
#ifndef vtkFFDTransformWriter_h
#define vtkFFDTransformWriter_h

#include "vtkFFDIOModule.h" // For export macro
#include "vtkObject.h"
#include "vtkSmartPointer.h" // for vtkSmartPointer

#include <string> // for std::string

namespace ffd
{
struct TransformGrid;
}
class vtkAbstractTransform;
class vtkImageData;

class VTKFFDIO_EXPORT vtkFFDTransformWriter : public vtkObject
{
public:
  static vtkFFDTransformWriter* New();
  vtkTypeMacro(vtkFFDTransformWriter, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Formats of files.
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

  /// Systems of coordinates of patients.
  enum CoordinatesType
  {
    LPS = 0, ///< x to the left, y to the back, z up: that of ITK and of files
    RAS      ///< x to the right, y to the front, z up
  };

  ///@{
  /**
   * The file. It appears under its name when it is complete: after an error (a full disk, too) an
   * existing one is as it was. A link is followed, also to where no file is yet; what is no regular
   * file is not replaced. Default: none.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * The transform that is written. Default: none.
   */
  void SetTransform(vtkAbstractTransform* transform);
  vtkAbstractTransform* GetTransform();
  ///@}

  ///@{
  /**
   * Image whose points displacement fields are sampled at: dimensions (at most 1024 an axis),
   * origin, spacing and direction (orthonormal); scalars are not needed. In the given Coordinates.
   * Default none.
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

  ///@{
  /**
   * Fields in files are interpolated linearly between their points. FieldError is the largest
   * distance, data units, of the field written last from the transform at the centers of its cells
   * (0 after other formats); one that exceeds FieldTolerance (0 or more, default 0.1) is said in a
   * warning.
   */
  void SetFieldTolerance(double tolerance);
  vtkGetMacro(FieldTolerance, double);
  vtkGetMacro(FieldError, double);
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

  std::string WriteTransform();
  std::string FormatField(int format, const ffd::TransformGrid& reference, std::string& head,
    std::string& data, std::string& dataName);
  std::string FormatSteps(int format, const ffd::TransformGrid& reference, std::string& head);

  char* FileName;
  int Coordinates;
  int FileFormat;
  double FieldTolerance;
  double FieldError;
  vtkSmartPointer<vtkAbstractTransform> Transform;
  vtkSmartPointer<vtkImageData> ReferenceImage;
};

#endif
