// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDDeformationSource
 * @brief   turns what a user gave as deformation into a B-spline field for the kernels
 *
 * Private to the libraries of this project: not installed, not wrapped. In this order: the given
 * transform, used as it is when it is a B-spline, else approximated by a lattice; the lattice
 * attached to the image; no deformation.
 */
#ifndef vtkFFDDeformationSource_h
#define vtkFFDDeformationSource_h

#include "vtkFFDCoreModule.h" // For export macro

#include "Bounds/FFDBox.h"

#include "FFDBSplineField.h"
#include "FFDStage.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

class vtkAbstractTransform;
class vtkDataObject;

namespace ffd
{

/// A deformation for the kernels.
struct DeformationField
{
  BSplineField Field;
  bool Inverted = false; ///< the deformation is the inverse of the field's map
  double Error = 0.0;    ///< largest distance of a transform from its approximation, data units
  /// Of a transform that is approximated, a box that holds all that it moves into the image, see
  /// PullBack; none where that is not known.
  std::optional<Box> Domain;
};

/// Where and how closely a transform is approximated.
struct FitRequest
{
  std::array<double, 6> Bounds{}; ///< of the image, data coordinates
  double Tolerance = 0.0;         ///< largest error, data units
  bool AtRest = false;            ///< what happens in the image alone matters, nothing beyond it

  bool operator==(const FitRequest& other) const
  {
    return this->Bounds == other.Bounds && this->Tolerance == other.Tolerance &&
      this->AtRest == other.AtRest;
  }
};

/// The field of a transform or, without one, of the lattice that `attached` holds; `fit` for the
/// transforms that are approximated.
Made MakeDeformationField(DeformationField& result, StageTools& tools,
  const Source<vtkAbstractTransform>& transform, const Source<vtkDataObject>& attached,
  const std::optional<FitRequest>& fit);

} // namespace ffd

class vtkFFDDeformationSource
{
public:
  VTKFFDCORE_EXPORT explicit vtkFFDDeformationSource(ffd::StageOrder& order);
  VTKFFDCORE_EXPORT ~vtkFFDDeformationSource();
  vtkFFDDeformationSource(const vtkFFDDeformationSource&) = delete;
  vtkFFDDeformationSource& operator=(const vtkFFDDeformationSource&) = delete;

  /**
   * Bring the field up to date. `fit`: for a transform that is approximated. Returns false and a
   * message when the deformation cannot be used; the warning of `tools` is set when it can, with a
   * reservation.
   */
  VTKFFDCORE_EXPORT bool Update(vtkAbstractTransform* transform, vtkDataObject* image,
    const ffd::FitRequest& fit, ffd::StageTools& tools);

  /// The field, which is another one when its control points, or where they lie, have changed.
  ffd::Product<ffd::DeformationField> GetProduct() const { return this->Field.GetProduct(); }
  std::int64_t GetNumberOfBuilds() const { return this->Field.GetNumberOfBuilds(); }
  VTKFFDCORE_EXPORT std::size_t GetMemorySize() const;

private:
  ffd::Stage<&ffd::MakeDeformationField> Field;
};

#endif
