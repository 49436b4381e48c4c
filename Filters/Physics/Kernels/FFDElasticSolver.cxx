// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDElasticSolver.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include <cmath>

namespace ffd
{
namespace
{

using SparseMatrix = Eigen::SparseMatrix<double>;
using Cholesky = Eigen::SimplicialLDLT<SparseMatrix>;
using Triplet = Eigen::Triplet<double>;

} // namespace

//------------------------------------------------------------------------------
struct ElasticSolver::Internals
{
  SparseMatrix Stiffness; // of all points, three rows each
  double StepOfMatrix = -1.0;
  double DampingOfMatrix = -1.0;
  std::vector<char> PinnedOfMatrix;
  std::vector<int> Numbers; // of the components of points
  int Free = 0;
  Cholesky Solver;
  bool Usable = false;

  /// Stiffness of free components, `factor` times the masses added.
  void Factorize(double h, double damping, double factor, const std::vector<double>& masses,
    const std::vector<char>& pinned)
  {
    if (this->StepOfMatrix == h && this->DampingOfMatrix == damping &&
      this->PinnedOfMatrix == pinned)
    {
      return;
    }
    this->StepOfMatrix = h;
    this->DampingOfMatrix = damping;
    this->PinnedOfMatrix = pinned;
    std::vector<char> components;
    for (const char pin : pinned)
    {
      components.insert(components.end(), 3, pin);
    }
    this->Numbers = NumberFreePoints(components, this->Free);
    std::vector<Triplet> entries;
    for (int column = 0; column < this->Stiffness.outerSize(); ++column)
    {
      const int to = this->Numbers[static_cast<std::size_t>(column)];
      for (SparseMatrix::InnerIterator entry(this->Stiffness, column); to >= 0 && entry; ++entry)
      {
        const int from = this->Numbers[static_cast<std::size_t>(entry.row())];
        if (from >= 0)
        {
          entries.emplace_back(from, to, entry.value());
        }
      }
      if (to >= 0)
      {
        entries.emplace_back(to, to, factor * masses[static_cast<std::size_t>(column) / 3]);
      }
    }
    SparseMatrix matrix(this->Free, this->Free);
    matrix.setFromTriplets(entries.begin(), entries.end());
    this->Usable = this->Free == 0;
    if (this->Free > 0)
    {
      this->Solver.compute(matrix);
      const bool done = this->Solver.info() == Eigen::Success;
      const double largest = done ? this->Solver.vectorD().maxCoeff() : 0.0;
      this->Usable = done && this->Solver.vectorD().minCoeff() > 1e-11 * largest && largest > 0.0;
    }
  }

  /// Solve for free components, the others given in `u`; `right` of all components.
  void Solve(const Eigen::VectorXd& right, Eigen::VectorXd& u) const
  {
    if (this->Free == 0)
    {
      return;
    }
    Eigen::VectorXd given = u;
    for (int i = 0; i < given.size(); ++i)
    {
      if (this->Numbers[static_cast<std::size_t>(i)] >= 0)
      {
        given[i] = 0.0;
      }
    }
    const Eigen::VectorXd moved = right - this->Stiffness * given;
    Eigen::VectorXd reduced(this->Free);
    for (int i = 0; i < moved.size(); ++i)
    {
      const int n = this->Numbers[static_cast<std::size_t>(i)];
      if (n >= 0)
      {
        reduced[n] = moved[i];
      }
    }
    const Eigen::VectorXd solution = this->Solver.solve(reduced);
    for (int i = 0; i < u.size(); ++i)
    {
      const int n = this->Numbers[static_cast<std::size_t>(i)];
      if (n >= 0)
      {
        u[i] = solution[n];
      }
    }
  }
};

//------------------------------------------------------------------------------
namespace
{

/// Stiffness of a box of isotropic material: eight corners (x fastest), three rows each.
Eigen::Matrix<double, 24, 24> BoxStiffness(const glm::dvec3& size, double young, double poisson)
{
  Eigen::Matrix<double, 6, 6> material = Eigen::Matrix<double, 6, 6>::Zero();
  const double lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
  const double shear = young / (2.0 * (1.0 + poisson));
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      material(a, b) = lambda + (a == b ? 2.0 * shear : 0.0);
    }
    material(a + 3, a + 3) = shear;
  }
  // Eight trilinear functions, and 1 - t^2 along each axis.
  constexpr int functions = 11;
  Eigen::Matrix<double, 3 * functions, 3 * functions> whole =
    Eigen::Matrix<double, 3 * functions, 3 * functions>::Zero();
  const double gauss = 1.0 / std::sqrt(3.0);
  for (int point = 0; point < 8; ++point)
  {
    const double t[3] = { (point & 1) ? gauss : -gauss, (point & 2) ? gauss : -gauss,
      (point & 4) ? gauss : -gauss };
    Eigen::Matrix<double, 6, 3 * functions> strain =
      Eigen::Matrix<double, 6, 3 * functions>::Zero();
    for (int f = 0; f < functions; ++f)
    {
      double gradient[3] = { 0.0, 0.0, 0.0 };
      if (f < 8)
      {
        const double s[3] = { (f & 1) ? 1.0 : -1.0, (f & 2) ? 1.0 : -1.0, (f & 4) ? 1.0 : -1.0 };
        for (int a = 0; a < 3; ++a)
        {
          const int b = (a + 1) % 3;
          const int c = (a + 2) % 3;
          gradient[a] = 0.125 * s[a] * (1.0 + s[b] * t[b]) * (1.0 + s[c] * t[c]) * 2.0 / size[a];
        }
      }
      else
      {
        gradient[f - 8] = -2.0 * t[f - 8] * 2.0 / size[f - 8];
      }
      for (int a = 0; a < 3; ++a)
      {
        const int b = (a + 1) % 3;
        strain(a, 3 * f + a) = gradient[a];
        // Shear strain of axes a and b.
        strain(3 + a, 3 * f + a) = gradient[b];
        strain(3 + a, 3 * f + b) = gradient[a];
      }
    }
    whole += strain.transpose() * material * strain * (size.x * size.y * size.z / 8.0);
  }
  // The incompatible modes belong to one element alone: eliminated.
  const Eigen::Matrix<double, 24, 9> mixed = whole.topRightCorner<24, 9>();
  const Eigen::Matrix<double, 9, 9> modes = whole.bottomRightCorner<9, 9>();
  return whole.topLeftCorner<24, 24>() - mixed * modes.ldlt().solve(mixed.transpose());
}

} // namespace

//------------------------------------------------------------------------------
ElasticSolver::ElasticSolver(const glm::ivec3& nodes, const glm::dvec3& origin,
  const glm::dvec3& spacing, double totalMass, double young, double poisson)
  : BodySolver(nodes, origin, spacing, totalMass)
  , Data(new Internals)
{
  const Eigen::Matrix<double, 24, 24> box = BoxStiffness(spacing, young, poisson);
  // An eighth of each cell to each of its corners.
  const double share = totalMass /
    (8.0 * static_cast<double>(nodes.x - 1) * static_cast<double>(nodes.y - 1) *
      static_cast<double>(nodes.z - 1));
  this->Masses.assign(this->GetSize(), 0.0);
  std::vector<Triplet> entries;
  glm::ivec3 i;
  for (i.z = 0; i.z + 1 < nodes.z; ++i.z)
  {
    for (i.y = 0; i.y + 1 < nodes.y; ++i.y)
    {
      for (i.x = 0; i.x + 1 < nodes.x; ++i.x)
      {
        int ids[24];
        for (int corner = 0; corner < 8; ++corner)
        {
          const std::size_t id =
            this->Index(i.x + (corner & 1), i.y + ((corner >> 1) & 1), i.z + ((corner >> 2) & 1));
          this->Masses[id] += share;
          for (int a = 0; a < 3; ++a)
          {
            ids[3 * corner + a] = static_cast<int>(3 * id) + a;
          }
        }
        for (int r = 0; r < 24; ++r)
        {
          for (int c = 0; c < 24; ++c)
          {
            entries.emplace_back(ids[r], ids[c], box(r, c));
          }
        }
      }
    }
  }
  const int size = static_cast<int>(3 * this->GetSize());
  this->Data->Stiffness.resize(size, size);
  this->Data->Stiffness.setFromTriplets(entries.begin(), entries.end());
}

//------------------------------------------------------------------------------
ElasticSolver::~ElasticSolver() = default;

//------------------------------------------------------------------------------
namespace
{

using ConstMap = Eigen::Map<const Eigen::VectorXd>;

ConstMap AsVector(const std::vector<glm::dvec3>& values)
{
  return ConstMap(&values[0].x, static_cast<Eigen::Index>(3 * values.size()));
}

Eigen::VectorXd ForcesOf(const BodySolver& body, const BodyLoads& loads)
{
  std::vector<glm::dvec3> forces(body.GetSize());
  for (std::size_t i = 0; i < forces.size(); ++i)
  {
    forces[i] = body.Masses[i] * loads.Gravity;
    forces[i] += loads.Forces.empty() ? glm::dvec3(0.0) : loads.Forces[i];
  }
  return AsVector(forces);
}

} // namespace

//------------------------------------------------------------------------------
double ElasticSolver::GetElasticEnergy() const
{
  const Eigen::VectorXd u = AsVector(this->Positions) - AsVector(this->Rest);
  return 0.5 * u.dot(this->Data->Stiffness * u);
}

//------------------------------------------------------------------------------
bool ElasticSolver::Step(double h, const BodyLoads& loads)
{
  Internals& data = *this->Data;
  data.Factorize(
    h, loads.Damping, 4.0 / (h * h) + 2.0 / h * loads.Damping, this->Masses, loads.Pinned);
  if (!data.Usable)
  {
    return false;
  }
  const Eigen::VectorXd forces = ForcesOf(*this, loads);
  const Eigen::VectorXd u = AsVector(this->Positions) - AsVector(this->Rest);
  Eigen::VectorXd v = AsVector(this->Velocities);
  // From the state, so that loads may change from step to step.
  Eigen::VectorXd masses(u.size());
  for (Eigen::Index i = 0; i < masses.size(); ++i)
  {
    masses[i] = this->Masses[static_cast<std::size_t>(i) / 3];
  }
  Eigen::VectorXd a = (forces - data.Stiffness * u).cwiseQuotient(masses) - loads.Damping * v;
  for (std::size_t i = 0; i < this->GetSize(); ++i)
  {
    if (loads.Pinned[i])
    {
      a.segment<3>(static_cast<Eigen::Index>(3 * i)).setZero();
      v.segment<3>(static_cast<Eigen::Index>(3 * i)).setZero();
    }
  }
  Eigen::VectorXd next = u;
  for (std::size_t i = 0; i < this->GetSize(); ++i)
  {
    for (int c = 0; c < 3 && loads.Pinned[i]; ++c)
    {
      next[static_cast<Eigen::Index>(3 * i) + c] = loads.Targets[i][c] - this->Rest[i][c];
    }
  }
  const Eigen::VectorXd right = forces +
    masses.cwiseProduct(4.0 / (h * h) * u + 4.0 / h * v + a + loads.Damping * (2.0 / h * u + v));
  data.Solve(right, next);
  const Eigen::VectorXd velocity = 2.0 / h * (next - u) - v;
  for (std::size_t i = 0; i < this->GetSize(); ++i)
  {
    for (int c = 0; c < 3; ++c)
    {
      const Eigen::Index n = static_cast<Eigen::Index>(3 * i) + c;
      this->Positions[i][c] = this->Rest[i][c] + next[n];
      this->Velocities[i][c] = loads.Pinned[i] ? 0.0 : velocity[n];
    }
  }
  return true;
}

//------------------------------------------------------------------------------
bool ElasticSolver::Settle(const BodyLoads& loads)
{
  Internals& data = *this->Data;
  data.Factorize(0.0, 0.0, 0.0, this->Masses, loads.Pinned);
  if (!data.Usable)
  {
    return false;
  }
  Eigen::VectorXd u = AsVector(this->Positions) - AsVector(this->Rest);
  for (std::size_t i = 0; i < this->GetSize(); ++i)
  {
    for (int c = 0; c < 3 && loads.Pinned[i]; ++c)
    {
      u[static_cast<Eigen::Index>(3 * i) + c] = loads.Targets[i][c] - this->Rest[i][c];
    }
  }
  data.Solve(ForcesOf(*this, loads), u);
  for (std::size_t i = 0; i < this->GetSize(); ++i)
  {
    const Eigen::Index n = static_cast<Eigen::Index>(3 * i);
    this->Positions[i] = this->Rest[i] + glm::dvec3(u[n], u[n + 1], u[n + 2]);
    this->Velocities[i] = glm::dvec3(0.0);
  }
  return true;
}

} // namespace ffd
