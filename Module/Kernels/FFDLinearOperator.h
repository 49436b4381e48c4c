// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDLinearOperator_h
#define FFDLinearOperator_h

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <functional>
#include <utility>

namespace ffd
{
class LinearOperator;
}

namespace Eigen
{
namespace internal
{
template <>
struct traits<ffd::LinearOperator> : traits<SparseMatrix<double>>
{
};
} // namespace internal
} // namespace Eigen

namespace ffd
{

/// A square matrix that is known by its product with a vector alone, for Eigen's iterative solvers.
class LinearOperator : public Eigen::EigenBase<LinearOperator>
{
public:
  // Interface that Eigen requires of a matrix.
  using Scalar = double;
  using RealScalar = double;
  using StorageIndex = int;
  enum
  {
    ColsAtCompileTime = Eigen::Dynamic,
    MaxColsAtCompileTime = Eigen::Dynamic,
    IsRowMajor = false
  };

  using Function = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

  LinearOperator(Eigen::Index size, Function multiply)
    : Size(size)
    , Multiply(std::move(multiply))
  {
  }

  Eigen::Index rows() const { return this->Size; }
  Eigen::Index cols() const { return this->Size; }

  template <class Vector>
  Eigen::Product<LinearOperator, Vector, Eigen::AliasFreeProduct> operator*(
    const Eigen::MatrixBase<Vector>& vector) const
  {
    return Eigen::Product<LinearOperator, Vector, Eigen::AliasFreeProduct>(*this, vector.derived());
  }

  Eigen::VectorXd Apply(const Eigen::VectorXd& vector) const { return this->Multiply(vector); }

private:
  Eigen::Index Size;
  Function Multiply;
};

/// A function in the place of a preconditioner of Eigen's.
class LinearPreconditioner
{
public:
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> Apply;

  // Interface that Eigen requires of a preconditioner.
  template <class Matrix>
  explicit LinearPreconditioner(const Matrix&)
  {
  }
  LinearPreconditioner() = default;
  template <class Matrix>
  LinearPreconditioner& analyzePattern(const Matrix&)
  {
    return *this;
  }
  template <class Matrix>
  LinearPreconditioner& factorize(const Matrix&)
  {
    return *this;
  }
  template <class Matrix>
  LinearPreconditioner& compute(const Matrix&)
  {
    return *this;
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& vector) const { return this->Apply(vector); }
  Eigen::ComputationInfo info() const { return Eigen::Success; }
};

} // namespace ffd

namespace Eigen
{
namespace internal
{
template <class Vector>
struct generic_product_impl<ffd::LinearOperator, Vector, SparseShape, DenseShape, GemvProduct>
  : generic_product_impl_base<ffd::LinearOperator, Vector,
      generic_product_impl<ffd::LinearOperator, Vector>>
{
  template <class Result>
  static void scaleAndAddTo(
    Result& result, const ffd::LinearOperator& matrix, const Vector& vector, const double& factor)
  {
    result += factor * matrix.Apply(vector);
  }
};
} // namespace internal
} // namespace Eigen

#endif
