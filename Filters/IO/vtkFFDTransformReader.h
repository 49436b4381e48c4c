// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDTransformReader
 * @brief   read the deformations that registration tools write
 *
 * GetTransform() returns a transform that maps points of the fixed image to points of the moving
 * one, as the file does. vtkImageReslice::SetResliceTransform() takes it, and
 * vtkFFDInverseRayVolumeMapper shows the moving image with it:
 * @code{.py}
 * reader = vtkffd.vtkFFDTransformReader()
 * reader.SetFileName("TransformParameters.1.txt")
 * mapper.SetInputData(moving)
 * mapper.SetDeformation(reader.GetTransform())
 * mapper.SetInverseModeToPullBack()
 * @endcode
 *
 * The format is found from the content of the file, not from its name. Texts are ASCII or UTF-8,
 * with or without a byte order mark:
 * - ITK text transforms (.tfm, .txt; ITK, 3D Slicer, ANTs), HDF5 (.h5) and MATLAB level 4 (.mat)
 *   files, 3-D, double or float: BSplineTransform and BSplineDeformableTransform of order 1 to 3,
 *   DisplacementFieldTransform (and those that smooth its updates), the linear transforms (Affine,
 *   MatrixOffsetTransformBase, ScalableAffine, CenteredAffine, Translation, Scale,
 *   ScaleLogarithmic, Euler3D, CenteredEuler3D, Versor, VersorRigid3D, Rigid3D, QuaternionRigid,
 *   Similarity3D, ScaleVersor3D, ScaleSkewVersor3D, ComposeScaleSkewVersor3D, Identity), and a
 *   CompositeTransform of them (the one that was added last is applied first, as in ITK), of which
 *   .mat files keep only a part: refused. HDF5 files of other shapes are refused: links, data in
 *   other files, filters other than deflate.
 * - elastix TransformParameters.*.txt: BSplineTransform, RecursiveBSplineTransform of order 1 to 3,
 *   AffineTransform, AffineLogTransform, EulerTransform, SimilarityTransform,
 *   TranslationTransform, WeightedCombinationTransform, and File, which names a file of ITK; with
 *   their chain of initial transforms, composed or added; and one step of a stack of these
 *   (BSplineStackTransform, EulerStackTransform, AffineLogStackTransform,
 *   TranslationStackTransform), see StackIndex. A file that one names is looked for in
 *   the folder of the file that names it, then by its path as it stands.
 * - MINC .xfm: Linear and Grid_Transform (displacements in a MINC 2 volume in the same folder),
 *   inverted or not, one after the other.
 * - Displacement fields, images of three components: MetaImage (.mhd, .mha), NRRD (.nrrd, .nhdr)
 *   and NIfTI-1 (.nii, .nii.gz), raw or zlib/gzip compressed, gzip of several members too. Data in
 *   a file of their own are named without a folder and lie in the same one; a link there may lead
 *   to a folder below it. The folder of the file that the header is a link to counts, too. Vectors
 *   are in LPS and in millimeters, in NIfTI too (ITK's convention, that of ANTs and elastix; with
 *   intent 1006 NIfTI's are RAS), where xyzt_units (meters, millimeters, microns) holds for the
 *   grid. Deformations of SPM (y_*.nii) and NiftyReg are told by their intent name: vectors in RAS,
 *   displacements or positions; control points and velocities of NiftyReg are refused. They are
 *   interpolated linearly.
 * - A lattice as image data (.vti), as vtkFFDLattice::ToImageData() and vtkXMLImageDataWriter
 *   write.
 *
 * Only regular files are read: pipes and devices are refused.
 *
 * <b>Coordinates.</b> ITK and elastix compute in LPS (x to the left, y to the back, z up), and so
 * do their files, whatever the images' format. With Coordinates LPS (the default) the transform is
 * that of the file; it fits the images of vtkFFDVolumeReader, which reads every format with its
 * position and direction cosines in LPS. (VTK's readers ignore direction cosines: what they read
 * fits only where these are the identity, or after vtkImageData::SetDirectionMatrix().) With RAS, x
 * and y point the other way, T' = F T F with F = diag(-1, -1, 1); that is the system of 3D Slicer's
 * scene and of the matrices of vtkNIFTIImageReader. A .vti lattice is in the data coordinates of
 * its image and is never turned. An .xfm file does not say what it is in: MINC's tools mean RAS,
 * ITK up to 5.4 writes its LPS as it stands. It is read as it stands; RAS turns it.
 *
 * <b>What is exact.</b> A cubic spline whose grid runs along the axes is read as a vtkFFDLattice,
 * one of order 1 or 2 as a vtkFFDSplineTransform, a sum that is no spline as a vtkFFDSumTransform;
 * grids in other directions between two rotations. Splines are equal to ITK's to rounding in the
 * region where all control points exist. Outside of it ITK does not deform; here the deformation
 * fades out over the cells outside, or continues as at the border for a spline that a linear
 * transform was added to, and for fields. The inverse of a Grid_Transform is that of
 * vtkGridTransform, within its InverseTolerance.
 *
 * The output port has the control points of a lattice, for vtkFFDDeformVolume and others: that of
 * the file where it is one along the axes, else an approximation (vtkFFDLattice::FitToTransform())
 * over FitBounds, or over the region that the file tells (the fixed image of elastix, the grid of
 * the deformation). GetLatticeError() tells its error. A linear transform has no region of its own:
 * set FitBounds, or use GetTransform().
 *
 * <b>Errors.</b> Malformed, truncated and hostile files are reported with what is wrong, and give
 * no transform. What is allocated is bounded by a small multiple of what the file really holds.
 * Every number must be finite and at most 1e12; grids and fields have up to 1024 nodes an axis,
 * fields 2^27 voxels, texts 1 GiB, chains 64 transforms. Of .h5 and .mnc files the shape is
 * checked, but damaged ones are in the hands of the HDF5 library.
 *
 * @sa vtkFFDVolumeReader vtkFFDTransformWriter vtkFFDLattice vtkFFDFitLattice
 * vtkFFDInverseRayVolumeMapper
 */
#ifndef vtkFFDTransformReader_h
#define vtkFFDTransformReader_h

#include "vtkFFDIOModule.h" // For export macro
#include "vtkImageAlgorithm.h"
#include "vtkNew.h"          // for vtkNew
#include "vtkSmartPointer.h" // for vtkSmartPointer
#include "vtkTimeStamp.h"    // for vtkTimeStamp

class vtkAbstractTransform;
class vtkFFDLattice;
struct vtkFFDTransformFile;

class VTKFFDIO_EXPORT vtkFFDTransformReader : public vtkImageAlgorithm
{
public:
  static vtkFFDTransformReader* New();
  vtkTypeMacro(vtkFFDTransformReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Formats of files.
  enum FileFormatType
  {
    UNKNOWN = 0,
    ITK_TEXT,
    ELASTIX,
    META_IMAGE,
    NRRD,
    NIFTI,
    LATTICE,
    ITK_HDF5,
    MATLAB,
    MINC
  };

  /// Systems of coordinates of patients.
  enum CoordinatesType
  {
    LPS = 0, ///< x to the left, y to the back, z up: that of ITK and of files
    RAS      ///< x to the right, y to the front, z up
  };

  ///@{
  /**
   * The file. Reading happens at the next update; call Modified() when the file has changed.
   * Default: none.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * Coordinate system of the transform that is given out, see above. Default LPS, as the files.
   */
  void SetCoordinates(int coordinates);
  vtkGetMacro(Coordinates, int);
  void SetCoordinatesToLPS() { this->SetCoordinates(LPS); }
  void SetCoordinatesToRAS() { this->SetCoordinates(RAS); }
  ///@}

  ///@{
  /**
   * Region of the lattice where the file is no lattice itself, (xmin, xmax, ...) in the chosen
   * coordinates. xmin > xmax: the region that the file tells. Default: 1, -1, 1, -1, 1, -1.
   */
  void SetFitBounds(const double bounds[6]);
  void SetFitBounds(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax);
  vtkGetVector6Macro(FitBounds, double);
  ///@}

  ///@{
  /**
   * Largest error of that lattice to aim at, data units, > 0 (default 0.1), and the most cells per
   * axis that may be spent on it, 1 to 256 (default 64). A warning tells when these do not suffice.
   */
  void SetFitTolerance(double tolerance);
  vtkGetMacro(FitTolerance, double);
  vtkSetClampMacro(MaximumCells, int, 1, 256);
  vtkGetMacro(MaximumCells, int);
  ///@}

  ///@{
  /**
   * Which transform of a stack of elastix is read, counted from 0; one that is not there is an
   * error of the next update. Negative values count as 0. Without meaning for other files. Default:
   * 0.
   */
  vtkSetClampMacro(StackIndex, int, 0, VTK_INT_MAX);
  vtkGetMacro(StackIndex, int);
  ///@}

  ///@{
  /**
   * Get the number of transforms in the stack that was read last, 0 if the file is none, and the
   * time of one of them, counted from 0, in the units of the file.
   */
  vtkGetMacro(StackSize, int);
  double GetStackTime(int index) const;
  ///@}

  /**
   * The transform, fixed to moving points, reading the file if need be: a vtkFFDLattice, a
   * vtkTransform, a vtkGridTransform, a vtkFFDSplineTransform, a vtkFFDSumTransform or a
   * vtkGeneralTransform of these. Null after an error. It belongs to
   * the reader; the next file gives another one.
   */
  vtkAbstractTransform* GetTransform();

  /**
   * The control points of the output port as an object; null after an error. It belongs to the
   * reader, and the next update overwrites edits.
   */
  vtkFFDLattice* GetLattice();

  /// Error of GetLattice(): 0 where it is that of the file, else the largest found, data units.
  vtkGetMacro(LatticeError, double);

  ///@{
  /**
   * One of the formats; UNKNOWN before a file was read. GetTransform() reads it.
   */
  vtkGetMacro(FileFormat, int);
  const char* GetFileFormatAsString();
  ///@}

  /**
   * The region that the file tells, bounds in the chosen coordinates; xmin > xmax where there is
   * none (linear transforms of ITK). Reads the file if need be.
   */
  void GetDomain(double bounds[6]);

  /// Whether the file can be opened and begins as one of the formats.
  int CanReadFile(const char* fileName);

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDTransformReader();
  ~vtkFFDTransformReader() override;

  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDTransformReader(const vtkFFDTransformReader&) = delete;
  void operator=(const vtkFFDTransformReader&) = delete;

  bool ReadFile();
  void ReadAnyFile();
  void UseFile(vtkFFDTransformFile& file);
  void ReadLatticeFile();
  bool MakeLattice();

  char* FileName;
  int Coordinates;
  double FitBounds[6];
  double FitTolerance;
  int MaximumCells;
  int StackIndex;
  int StackSize;
  double StackOrigin;
  double StackSpacing;
  double LatticeError;
  int FileFormat;
  double Domain[6];
  vtkSmartPointer<vtkAbstractTransform> Transform;
  vtkNew<vtkFFDLattice> Lattice;
  bool LatticeIsExact;
  bool LatticeIsMade;
  bool FitFailed;
  vtkTimeStamp ReadTime;
};

#endif
