// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDVolumeReader
 * @brief   reads a volume from any file that VTK can read, placed and oriented as the file says
 *
 * VTK has a reader for each format, and most of them leave out which way the voxels lie in the
 * patient. This one chooses VTK's reader by the content and the name of the file, and puts what the
 * file says of directions into origin, spacing and direction matrix of the image:
 * - a folder of DICOM slices, or any of the slices (one series of slices of one size, not
 *   compressed, whose rescale slopes and intercepts are whole numbers in all or in none): position
 *   and orientation of the patient; slices at unequal distances are placed at equal ones, with a
 *   warning;
 * - NIfTI (.nii, .nii.gz, .hdr and .img): the sform, else (also where that is of zeros) the qform,
 *   else the axes as they are, and the unit of length;
 * - NRRD (.nrrd, .nhdr): space, space directions and space origin; without these spacings and axis
 *   mins, which are the border of the first cell unless "centers" says "node", as in ITK;
 * - MetaImage (.mhd, .mha): TransformMatrix and Offset;
 * - image data (.vti), which have a direction matrix, and legacy image data (.vtk);
 * - what vtkImageReader2Factory knows else, as it comes.
 *
 * Coordinates of the first three and of MetaImage are those of DICOM and ITK: LPS (x to the left, y
 * to the back, z up), in millimeters where the file tells its unit. These are the coordinates of
 * the transforms that vtkFFDTransformReader reads by default, so that a registration fits.
 *
 * Values are those that the file means: where scl_slope and scl_inter of a NIfTI file say that they
 * are not what is stored, they are computed, as float (of 8 and 16 bits, and of float) or double.
 * vtkNIFTIImageReader leaves that out; vtkDICOMImageReader does it for DICOM.
 *
 * Update() reports an error that says why a volume cannot be read: there is no such file, no
 * reader, nothing in the file, a single slice (a volume has at least two voxels along each axis),
 * compressed DICOM, a pipe or device, also as one of the data files that a header names, and data
 * that are missing, short or damaged. The output is then empty, and GetProblem() tells the reason
 * without the file's name. Directions, spacings and origins that are singular, zero or not finite
 * are left out, with a warning.
 *
 * NRRD may have a fourth axis, which "space directions" or "kinds" tell from those of space: the
 * first one is that of the components, of a last one (times) the first element is read. The data
 * are raw, gzip or text, without line and byte skips. Data in several files are left to VTK's
 * reader, which takes a first axis of up to 9 elements for components.
 *
 * @sa vtkFFDTransformReader vtkImageReader2Factory
 */
#ifndef vtkFFDVolumeReader_h
#define vtkFFDVolumeReader_h

#include "vtkFFDIOModule.h" // For export macro
#include "vtkImageAlgorithm.h"

#include <memory> // for std::unique_ptr

class VTKFFDIO_EXPORT vtkFFDVolumeReader : public vtkImageAlgorithm
{
public:
  static vtkFFDVolumeReader* New();
  vtkTypeMacro(vtkFFDVolumeReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The file, or the folder of DICOM slices; one of the slices is its folder. Default: none.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /**
   * Why the last update gave no volume, a sentence without its full stop; empty, if it did. Never
   * null.
   */
  const char* GetProblem();

  /// Whether the file, or folder, is a volume that this class reads, by its header.
  int CanReadFile(const char* fileName);

protected:
  vtkFFDVolumeReader();
  ~vtkFFDVolumeReader() override;

  int RequestInformation(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;

private:
  vtkFFDVolumeReader(const vtkFFDVolumeReader&) = delete;
  void operator=(const vtkFFDVolumeReader&) = delete;

  int Fail();

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
  char* FileName = nullptr;
};

#endif
