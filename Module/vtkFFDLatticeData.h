// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed, not wrapped.
#ifndef vtkFFDLatticeData_h
#define vtkFFDLatticeData_h

#include "vtkFFDCoreModule.h" // For export macro
#include "vtkSmartPointer.h"

#include <glm/vec3.hpp>

#include <string>
#include <vector>

class vtkDataArray;
class vtkDataObject;
class vtkDoubleArray;
class vtkFFDLattice;
class vtkImageData;
class vtkInformation;

namespace ffd
{
struct Lattice;
}

/// The tuples of an array of 3 components; none for another number. The values of a vtkDoubleArray
/// are copied as they lie.
VTKFFDCORE_EXPORT std::vector<glm::dvec3> vtkFFDCopyTuples(vtkDataArray* array);

/// The displacements of a lattice as an array.
VTKFFDCORE_EXPORT vtkSmartPointer<vtkDoubleArray> vtkFFDMakeDisplacementArray(
  const std::vector<glm::dvec3>& displacements);

/// Writes the values that differ into an array of as many tuples of 3 components; nothing into one
/// of another shape. Returns whether any differs; the array is not marked as modified.
VTKFFDCORE_EXPORT bool vtkFFDWriteTuples(
  const std::vector<glm::dvec3>& values, vtkDoubleArray* array);

///@{
/**
 * The value of a lattice, as its control points and options are now. It may have a problem, which
 * FindProblem() tells. With `displacements`, those of the lattice, an inverse is not brought up to
 * date.
 */
VTKFFDCORE_EXPORT ffd::Lattice vtkFFDGetLatticeValue(vtkFFDLattice* lattice);
ffd::Lattice vtkFFDGetLatticeValue(vtkFFDLattice* lattice, vtkDoubleArray* displacements);
///@}

///@{
/**
 * A lattice in the field data of a data object: see vtkFFDLattice::AttachTo() for the arrays.
 * vtkFFDReadLattice() returns what is missing or malformed, and leaves the lattice, or an empty
 * string. `isComplete`, if not null: whether all of the arrays are there, with a displacement for
 * each control point; what is wrong then are values.
 */
VTKFFDCORE_EXPORT bool vtkFFDHasLattice(vtkDataObject* object);
void vtkFFDRemoveLattice(vtkDataObject* object);
void vtkFFDWriteLattice(const ffd::Lattice& lattice, vtkDataObject* object);
VTKFFDCORE_EXPORT std::string vtkFFDReadLattice(
  vtkDataObject* object, ffd::Lattice& lattice, bool* isComplete = nullptr);
///@}

///@{
/**
 * A lattice as an image of its control points: see vtkFFDLattice::ToImageData(). What an image does
 * not say (border mode, flag, scale) stays as it is in `lattice`.
 */
void vtkFFDWriteLatticeOptions(const ffd::Lattice& lattice, vtkImageData* image);
std::string vtkFFDReadLatticeImage(vtkImageData* image, ffd::Lattice& lattice);
///@}

/// Tells a pipeline of the image of the control points of a lattice, before it is made.
VTKFFDCORE_EXPORT void vtkFFDDescribeLatticeImage(vtkFFDLattice* lattice, vtkInformation* info);

#endif
