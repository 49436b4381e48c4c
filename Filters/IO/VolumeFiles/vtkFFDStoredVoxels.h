// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDStoredVoxels.h
 * @brief   reads voxels that VTK's readers of MetaImage and NRRD do not read, or not safely
 *
 * Private to this module: not installed, not wrapped. Of compressed data that are damaged or short,
 * and of numbers that are written as text, these readers leave the memory of the voxels as it is,
 * and say nothing; they wait for texts that are too short for their header, and read at most 2 GiB
 * of a compressed NRRD.
 */
#ifndef vtkFFDStoredVoxels_h
#define vtkFFDStoredVoxels_h

#include "vtkSmartPointer.h"

#include <array>
#include <cstddef>
#include <string>

class vtkImageData;
class vtkImageReader2;

/// Where the voxels lie in a file, and how.
struct vtkFFDStoredVoxels
{
  enum Forms
  {
    OF_VTK, ///< left to VTK's reader
    RAW,    ///< the numbers as they are
    PACKED, ///< one zlib stream, or the members of a gzip file
    TEXT    ///< decimal numbers with blanks or commas between them
  };
  Forms Form = OF_VTK;
  std::string Path;
  std::size_t Offset = 0;
  bool BigEndian = false;
  /// Voxels along each axis, and numbers of a voxel, where VTK's reader does not know; zeros: it
  /// does.
  std::array<int, 3> Size{ { 0, 0, 0 } };
  int Components = 0;
  /// VTK's type of the numbers where its reader takes another one, else -1: MetaImage's MET_LONG
  /// has 4 bytes on every machine, VTK's reader takes it for a long of 8.
  int Type = -1;
  /// That of x among the axes of the file.
  int FirstAxis = 0;
  /// What VTK's reader calls the array; empty: vtkImageData's name.
  std::string Name;

  /// VTK's type of the numbers, and how many a voxel has: as said above, or as VTK's reader says.
  int GetType(vtkImageReader2* reader) const;
  int GetComponents(vtkImageReader2* reader) const;

  /// The image of voxels that are not left to VTK's reader; null after an error.
  vtkSmartPointer<vtkImageData> ReadImage(vtkImageReader2* reader, std::string& error) const;
};

#endif
