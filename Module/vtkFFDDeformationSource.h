// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDDeformationSource
 * @brief   turns what a user gave as deformation into a B-spline field for the kernels
 *
 * Private to the libraries of this project: not installed, not wrapped. In this order: the given transform, used as
 * it is when it is a B-spline, else approximated by a lattice; the lattice attached to the image;
 * no deformation.
 */
#ifndef vtkFFDDeformationSource_h
#define vtkFFDDeformationSource_h

#include "FFDBSplineField.h"
#include "FFDExport.h"

#include "vtkNew.h"
#include "vtkTimeStamp.h"
#include "vtkType.h"

#include <cstddef>
#include <string>

class vtkAbstractTransform;
class vtkFFDLattice;
class vtkDataObject;

class vtkFFDDeformationSource
{
public:
  FFD_KERNEL_EXPORT vtkFFDDeformationSource();
  FFD_KERNEL_EXPORT ~vtkFFDDeformationSource();
  vtkFFDDeformationSource(const vtkFFDDeformationSource&) = delete;
  vtkFFDDeformationSource& operator=(const vtkFFDDeformationSource&) = delete;

  /**
   * Bring the field up to date. `bounds`: those of the image; `tolerance`: largest error of an
   * approximation, data units. Returns false and a message when the deformation cannot be used;
   * `warning` is set when it can, with a reservation.
   */
  FFD_KERNEL_EXPORT bool Update(vtkAbstractTransform* transform, vtkDataObject* image,
    const double bounds[6], double tolerance, std::string& message, std::string& warning);

  const ffd::BSplineField& GetField() const { return this->Field; }
  /// Whether the deformation is the inverse of the field's map.
  bool IsInverted() const { return this->Inverted; }
  bool IsZero() const { return this->Field.IsZero(); }
  /// When the field changed last.
  vtkMTimeType GetMTime() const { return this->Changed.GetMTime(); }
  FFD_KERNEL_EXPORT std::size_t GetMemorySize() const;

private:
  void FindFitRegion(
    vtkAbstractTransform* transform, const double bounds[6], double region[6]) const;

  ffd::BSplineField Field;
  bool Inverted = false;
  vtkTimeStamp Changed;
  vtkNew<vtkFFDLattice> Lattice; // attached to the image, or fitted
  // What the field was made from.
  const void* MadeFrom = nullptr; // not owned: only compared
  vtkMTimeType MadeFromTime = 0;
  double MadeForBounds[6] = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 };
  double MadeWithTolerance = 0.0;
};

#endif
