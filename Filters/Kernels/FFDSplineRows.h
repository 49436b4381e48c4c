// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSplineRows_h
#define FFDSplineRows_h

#include "FFDBSplineField.h"
#include "FFDExport.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace ffd
{

/// Geometry of an image grid: data = Origin + IndexToData * index.
struct ImageGrid
{
  glm::dvec3 Origin{ 0.0 }; ///< of index (0, 0, 0), inside the extent or not
  glm::dmat3 IndexToData{ 1.0 };

  glm::dvec3 ToData(const glm::dvec3& index) const
  {
    return this->Origin + this->IndexToData * index;
  }
};

/**
 * A displacement field at the points of an image grid, row by row. Where the rows run along an
 * axis of the field, which they do unless the image is turned, the 64 control points of a cell are
 * first summed over the two other axes, once per row; a point then takes a sum of four, whose
 * weights are the same in all rows. That is much faster than BSplineField::Displacement(),
 * and equal to it up to rounding. Other rows are evaluated point by point.
 *
 * The results depend on the index of a point alone, not on the range of indices: an image can be
 * made piece by piece.
 */
class FFD_FILTERS_EXPORT SplineRows
{
public:
  /// Rows of the points first ... last of `grid`. `field` is kept by pointer.
  SplineRows(const BSplineField& field, const ImageGrid& grid, int first, int last);

  int GetCount() const { return this->Count; }
  bool IsAligned() const { return this->Axis >= 0; }

  /// Working memory that the rows of one thread share.
  struct Scratch
  {
    std::vector<glm::dvec3> Lines[3];
  };

  /// `factor` * D of the points of row (j, k), as three arrays of GetCount() numbers.
  void Displacements(int j, int k, const glm::dmat3& factor, Scratch& scratch, double* x, double* y,
    double* z) const;

  /// Jacobians of D of the points of row (j, k), [column][row].
  void Jacobians(int j, int k, Scratch& scratch, glm::dmat3* jacobians) const;

private:
  /// Points of the row in one cell of the field.
  struct Run
  {
    int From; ///< in the row, and one past the last
    int To;
    std::size_t Node; ///< first of the four control points, padded
  };

  glm::dvec3 GetPoint(int i, int j, int k) const;
  void Collapse(const double weightsB[4], const double weightsC[4], int cellB, int cellC,
    std::vector<glm::dvec3>& line) const;

  const BSplineField* Field;
  ImageGrid Grid;
  int First;
  int Count;
  int Axis = -1; ///< of the field, that the rows run along; -1: none
  std::vector<Run> Runs;
  std::vector<double> Weights[4];
  std::vector<double> DerivativeWeights[4];
};

} // namespace ffd

#endif
