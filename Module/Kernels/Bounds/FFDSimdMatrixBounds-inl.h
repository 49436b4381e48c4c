// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// FFDMatrixBounds.h in vectors, a matrix a lane. Included once per target of Highway.
#if defined(FFD_SIMD_MATRIX_BOUNDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_MATRIX_BOUNDS_INL_H_
#undef FFD_SIMD_MATRIX_BOUNDS_INL_H_
#else
#define FFD_SIMD_MATRIX_BOUNDS_INL_H_
#endif

#include <hwy/highway.h>

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{
namespace hn = hwy::HWY_NAMESPACE;

using MatrixTag = hn::CappedTag<double, 8>;
using MatrixLanes = hn::Vec<MatrixTag>;

struct VectorMatrix
{
  MatrixLanes Entry[3][3]; ///< [row][column]

  HWY_INLINE const MatrixLanes& At(int row, int column) const
  {
    return this->Entry[row % 3][column % 3];
  }
};

/// The minor without a row and a column, with its sign.
HWY_INLINE MatrixLanes FindCofactor(const VectorMatrix& m, int row, int column)
{
  return hn::Sub(hn::Mul(m.At(row + 1, column + 1), m.At(row + 2, column + 2)),
    hn::Mul(m.At(row + 1, column + 2), m.At(row + 2, column + 1)));
}

HWY_INLINE MatrixLanes FindDeterminant(const VectorMatrix& m)
{
  MatrixLanes sum = hn::Mul(m.Entry[0][0], FindCofactor(m, 0, 0));
  sum = hn::MulAdd(m.Entry[0][1], FindCofactor(m, 0, 1), sum);
  return hn::MulAdd(m.Entry[0][2], FindCofactor(m, 0, 2), sum);
}

HWY_INLINE VectorMatrix Invert(const VectorMatrix& m, MatrixLanes determinant)
{
  const MatrixLanes factor = hn::Div(hn::Set(MatrixTag(), 1.0), determinant);
  VectorMatrix inverse;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      inverse.Entry[row][column] = hn::Mul(FindCofactor(m, column, row), factor);
    }
  }
  return inverse;
}

HWY_INLINE VectorMatrix Multiply(const VectorMatrix& a, const VectorMatrix& b)
{
  VectorMatrix product;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      MatrixLanes sum = hn::Mul(a.Entry[row][0], b.Entry[0][column]);
      sum = hn::MulAdd(a.Entry[row][1], b.Entry[1][column], sum);
      product.Entry[row][column] = hn::MulAdd(a.Entry[row][2], b.Entry[2][column], sum);
    }
  }
  return product;
}

/// The largest sums of the entries of rows and of columns.
struct LargestSums
{
  MatrixLanes OfRows;
  MatrixLanes OfColumns;

  HWY_INLINE explicit LargestSums(const VectorMatrix& m)
  {
    const auto ofRow = [&](int i) {
      return hn::Add(hn::Add(m.Entry[i][0], m.Entry[i][1]), m.Entry[i][2]);
    };
    const auto ofColumn = [&](int i) {
      return hn::Add(hn::Add(m.Entry[0][i], m.Entry[1][i]), m.Entry[2][i]);
    };
    this->OfRows = hn::Max(hn::Max(ofRow(0), ofRow(1)), ofRow(2));
    this->OfColumns = hn::Max(hn::Max(ofColumn(0), ofColumn(1)), ofColumn(2));
  }
};

/// Upper bounds of the norms of the inverses of all matrices of a range, see FindInverse() and
/// BoundNorm(); infinite where there may be none, or one that turns space inside out.
HWY_INLINE MatrixLanes BoundNormOfInverse(const VectorMatrix& center, const VectorMatrix& spread)
{
  const MatrixTag d;
  const MatrixLanes determinant = FindDeterminant(center);
  auto regular =
    hn::And(hn::Gt(determinant, hn::Set(d, 1e-9)), hn::Lt(determinant, hn::Set(d, 1e30)));
  VectorMatrix size = Invert(center, determinant);
  for (auto& row : size.Entry)
  {
    for (MatrixLanes& entry : row)
    {
      entry = hn::Abs(entry);
    }
  }
  const VectorMatrix w = Multiply(size, spread);
  const LargestSums sums(w);
  regular = hn::And(regular, hn::Lt(hn::Min(sums.OfRows, sums.OfColumns), hn::Set(d, 0.999)));
  VectorMatrix rest; // I - w
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      rest.Entry[row][column] =
        hn::Sub(hn::Set(d, row == column ? 1.0 : 0.0), w.Entry[row][column]);
    }
  }
  VectorMatrix largest = Multiply(Multiply(Invert(rest, FindDeterminant(rest)), w), size);
  const MatrixLanes rounding = hn::Set(d, 1e-9);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      MatrixLanes& entry = largest.Entry[row][column];
      entry = hn::Add(hn::MulAdd(rounding, size.Entry[row][column], rounding),
        hn::Add(size.Entry[row][column], entry));
    }
  }
  const LargestSums all(largest);
  return hn::IfThenElse(regular, hn::Sqrt(hn::Mul(all.OfRows, all.OfColumns)),
    hn::Set(d, std::numeric_limits<double>::infinity()));
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
