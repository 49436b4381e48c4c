// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDShownArray.h
 * Which array of an image FFD Volume shows. Private to this module.
 */
#ifndef vtkFFDShownArray_h
#define vtkFFDShownArray_h

#include <string>

class vtkDataArray;
class vtkImageData;
class vtkInformation;

/// Names an array of the points or the cells of an image.
struct vtkFFDShownArray
{
  std::string Name; ///< empty: nothing is shown
  bool OfCells = false;

  /// `information`: of an algorithm's input array to process; null names no array.
  static vtkFFDShownArray FromInformation(vtkInformation* information);

  /// The array, not owned; null where the image lacks it.
  vtkDataArray* FindIn(vtkImageData* image) const;

  bool operator==(const vtkFFDShownArray& other) const
  {
    return this->Name == other.Name && this->OfCells == other.OfCells;
  }
};

#endif
