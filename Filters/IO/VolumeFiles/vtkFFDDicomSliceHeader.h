// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDDicomSliceHeader.h
 * @brief   reads of a DICOM slice what tells whether it belongs to a volume
 *
 * Private to this module: not installed, not wrapped. vtkDICOMImageReader copies as many voxels of
 * each slice as the first one has, whether or not they are there.
 */
#ifndef vtkFFDDicomSliceHeader_h
#define vtkFFDDicomSliceHeader_h

#include <cstddef>
#include <string_view>

/// What was not found is 0.
struct vtkFFDDicomSliceHeader
{
  int Rows = 0;
  int Columns = 0;
  int Bits = 0;    ///< of a number
  int Samples = 0; ///< numbers of a pixel
  /// Whether a number that pixels are multiplied by, or that is added to them, is not whole: VTK's
  /// reader makes real numbers of the pixels then.
  bool IsFraction = false;
  bool HasPosition = false;
  double Position[3] = { 0.0, 0.0, 0.0 };
  /// Bytes from the start of the file to the end of the pixels, as many as the size says, or of the
  /// element that the bytes end in.
  std::size_t End = 0;
  enum PixelsType
  {
    UNKNOWN, ///< the bytes end before, or could not be understood
    FOUND,
    NONE ///< the bytes end behind an element that is whole
  };
  PixelsType Pixels = UNKNOWN;
  /// An element without a value, of which VTK's reader crashes; null: there is none.
  const char* Empty = nullptr;

  /// From the first bytes of a file; of what lies behind them nothing is known.
  static vtkFFDDicomSliceHeader Parse(std::string_view bytes);

  bool HasSize() const { return this->Rows > 0 && this->Columns > 0 && this->Bits > 0; }
  bool HasSizeOf(const vtkFFDDicomSliceHeader& other) const
  {
    return this->Rows == other.Rows && this->Columns == other.Columns && this->Bits == other.Bits &&
      this->Samples == other.Samples;
  }
};

#endif
