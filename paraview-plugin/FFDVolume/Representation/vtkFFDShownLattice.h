// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDShownLattice.h
 * The lattice by which ParaView shows data that have one. Private to this module.
 */
#ifndef vtkFFDShownLattice_h
#define vtkFFDShownLattice_h

#include "vtkFFDEditLattice.h"
#include "vtkFFDLattice.h"

#include "vtkSmartPointer.h"

#include <string>

class vtkDataObject;
class vtkPointSet;

/// The lattice by which a data object is to be shown, and how; null: as it is.
struct vtkFFDShownLattice
{
  vtkSmartPointer<vtkFFDLattice> Lattice;
  int Mode = vtkFFDEditLattice::EXACT;

  explicit vtkFFDShownLattice(vtkDataObject* data);

  /// That of the whole, or else that of the first of its leaves that has one.
  static vtkFFDShownLattice FindAnywhere(vtkDataObject* data);

  /// Reads the lattice of data that have one; false after an error, once for each, that says what
  /// to do in ParaView.
  static bool Read(vtkDataObject* data, vtkFFDLattice* lattice);

  /**
   * The data object that has the lattice of all of a data object: itself, or of a composite data
   * set the first of its leaves, if all have the same, or the whole, if no leaf has one; else null.
   * Where leaves have unlike lattices there is none: filters give their output the field data of
   * their first input.
   */
  static vtkDataObject* FindCarrier(vtkDataObject* data);

  /// Whether both show the same places alike.
  bool IsLike(const vtkFFDShownLattice& other) const;

  /// Whether a type of representation, one of ParaView's, shows images at rest: it knows nothing of
  /// lattices, and images cannot be moved.
  static bool IsAtRest(const std::string& type) { return type == "Volume" || type == "Slice"; }

  /// Moves the points to where they are shown; `moved` is a data set of the same type.
  void Move(vtkPointSet* rest, vtkPointSet* moved) const;

  /// The place at rest of what is shown at a place.
  void PullBack(const double shown[3], double rest[3]) const;
};

#endif
