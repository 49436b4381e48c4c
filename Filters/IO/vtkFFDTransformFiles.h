// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed.
#ifndef vtkFFDTransformFiles_h
#define vtkFFDTransformFiles_h

#include "FFDTransformStep.h"

#include "vtkFFDTransformReader.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// A file of a registration tool, read and followed to the files that it names.
struct vtkFFDTransformFile
{
  /// One of vtkFFDTransformReader::FileFormatType, known even where reading fails.
  int Format = vtkFFDTransformReader::UNKNOWN;
  /// In the order in which they are applied, LPS.
  std::vector<ffd::TransformStep> Steps;
  /// Of a stack of elastix: which of its steps is to be read, set by the caller; their number (0:
  /// no stack), the time of the first one, and from one to the next.
  std::size_t StackIndex = 0;
  std::size_t StackSize = 0;
  double StackOrigin = 0.0;
  double StackSpacing = 1.0;
  /// Grid of the fixed image, where the file tells it; else Size 0.
  ffd::TransformGrid FixedImage;
};

/// The format of a file by its first bytes; UNKNOWN where it cannot be read, either.
int vtkFFDDetectTransformFormat(const std::string& fileName);

/// Whether a file is a transform by its first bytes: of one of the formats, images being of three
/// components, and no .vti.
bool vtkFFDIsTransformFile(const std::string& fileName);

/// Empty when a .vti may be given to VTK's reader, else what is wrong; see the kernel of that name.
std::string vtkFFDFindLatticeFileProblem(const std::string& fileName);

/**
 * Read any format, but of LATTICE nothing else than that it is one. False with what is wrong,
 * naming the file. `proceed` is called now and then with the fraction that is done; when it returns
 * false reading stops with an error. Memory stays within a small multiple of the files' true size,
 * decompressed.
 */
bool vtkFFDReadTransformFile(const std::string& fileName, vtkFFDTransformFile& file,
  const std::function<bool(double)>& proceed, std::string& error);

#endif
