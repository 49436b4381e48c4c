// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDBodySolver.h"

#include "vtk_eigen.h"
#include VTK_EIGEN(Dense)
#include VTK_EIGEN(Sparse)

#include <algorithm>
#include <cmath>
#include <map>

namespace
{

using SparseMatrix = Eigen::SparseMatrix<double>;
using Cholesky = Eigen::SimplicialLDLT<SparseMatrix>;
using Columns3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Triplet = Eigen::Triplet<double>;

constexpr int SettleIterations = 2000;
constexpr int ContactSweeps = 200;
constexpr int ContactRounds = 8;

double Dot(const glm::dvec3& a, const glm::dvec3& b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

double Length(const glm::dvec3& v)
{
  return std::sqrt(Dot(v, v));
}

/// Points that move as unknowns, the others not: -1.
std::vector<int> NumberFreePoints(const std::vector<char>& pinned, int& count)
{
  std::vector<int> numbers(pinned.size(), -1);
  count = 0;
  for (std::size_t i = 0; i < pinned.size(); ++i)
  {
    if (!pinned[i])
    {
      numbers[i] = count++;
    }
  }
  return numbers;
}

glm::dvec3 Row(const Columns3& columns, int row)
{
  return { columns(row, 0), columns(row, 1), columns(row, 2) };
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDBodySolver::vtkFFDBodySolver(const glm::ivec3& nodes, const glm::dvec3& origin,
  const glm::dvec3& spacing, double totalMass)
  : Nodes(nodes)
  , Spacing(spacing)
{
  for (int k = 0; k < nodes.z; ++k)
  {
    for (int j = 0; j < nodes.y; ++j)
    {
      for (int i = 0; i < nodes.x; ++i)
      {
        this->Rest.push_back(origin + glm::dvec3(i, j, k) * spacing);
      }
    }
  }
  this->Masses.assign(this->Rest.size(), totalMass / static_cast<double>(this->Rest.size()));
  this->Positions = this->Rest;
  this->Velocities.assign(this->Rest.size(), glm::dvec3(0.0));
}

//------------------------------------------------------------------------------
vtkFFDBodySolver::~vtkFFDBodySolver() = default;

//------------------------------------------------------------------------------
double vtkFFDBodySolver::GetKineticEnergy() const
{
  double energy = 0.0;
  for (std::size_t i = 0; i < this->Velocities.size(); ++i)
  {
    energy += 0.5 * this->Masses[i] * Dot(this->Velocities[i], this->Velocities[i]);
  }
  return energy;
}

//------------------------------------------------------------------------------
double vtkFFDBodySolver::GetLoadEnergy(const vtkFFDBodyLoads& loads) const
{
  double energy = 0.0;
  for (std::size_t i = 0; i < this->Rest.size(); ++i)
  {
    glm::dvec3 force = this->Masses[i] * loads.Gravity;
    force += loads.Forces.empty() ? glm::dvec3(0.0) : loads.Forces[i];
    energy -= Dot(force, this->Positions[i] - this->Rest[i]);
  }
  return energy;
}

//------------------------------------------------------------------------------
struct vtkFFDSpringSolver::Internals
{
  struct Spring
  {
    std::size_t A = 0;
    std::size_t B = 0;
    double Length = 0.0;
    double Stiffness = 0.0;
    glm::dvec3 RestDirection{ 0.0 };
  };
  std::vector<Spring> Springs;

  // The matrix M / h^2 + stiffness of the free points; h = 0 stands for no mass.
  double StepOfMatrix = -1.0;
  std::vector<char> PinnedOfMatrix;
  std::vector<int> Numbers;
  int Free = 0;
  Cholesky Solver;
  bool Usable = false;
  std::map<int, Eigen::VectorXd> Responses; // to a unit force on a free point

  void Factorize(const std::vector<double>& masses, double h, const std::vector<char>& pinned)
  {
    if (this->StepOfMatrix == h && this->PinnedOfMatrix == pinned)
    {
      return;
    }
    this->StepOfMatrix = h;
    this->PinnedOfMatrix = pinned;
    this->Responses.clear();
    this->Numbers = NumberFreePoints(pinned, this->Free);
    std::vector<Triplet> entries;
    for (std::size_t i = 0; i < masses.size() && h > 0.0; ++i)
    {
      if (this->Numbers[i] >= 0)
      {
        entries.emplace_back(this->Numbers[i], this->Numbers[i], masses[i] / (h * h));
      }
    }
    for (const Spring& spring : this->Springs)
    {
      const int a = this->Numbers[spring.A];
      const int b = this->Numbers[spring.B];
      if (a >= 0)
      {
        entries.emplace_back(a, a, spring.Stiffness);
      }
      if (b >= 0)
      {
        entries.emplace_back(b, b, spring.Stiffness);
      }
      if (a >= 0 && b >= 0)
      {
        entries.emplace_back(a, b, -spring.Stiffness);
        entries.emplace_back(b, a, -spring.Stiffness);
      }
    }
    SparseMatrix matrix(this->Free, this->Free);
    matrix.setFromTriplets(entries.begin(), entries.end());
    this->Usable = this->Free == 0;
    if (this->Free > 0)
    {
      this->Solver.compute(matrix);
      const double smallest = this->Solver.info() == Eigen::Success
        ? this->Solver.vectorD().minCoeff()
        : 0.0;
      const double largest =
        this->Solver.info() == Eigen::Success ? this->Solver.vectorD().maxCoeff() : 0.0;
      this->Usable = smallest > 1e-13 * largest && largest > 0.0;
    }
  }

  double ElasticEnergy(const std::vector<glm::dvec3>& positions) const
  {
    double energy = 0.0;
    for (const Spring& spring : this->Springs)
    {
      const double stretch = Length(positions[spring.A] - positions[spring.B]) - spring.Length;
      energy += 0.5 * spring.Stiffness * stretch * stretch;
    }
    return energy;
  }

  /// Springs in the directions that they have at `positions`, and pinned neighbours, as forces.
  void AddSprings(const std::vector<glm::dvec3>& positions,
    const std::vector<glm::dvec3>& fixed, Columns3& right) const
  {
    for (const Spring& spring : this->Springs)
    {
      const glm::dvec3 d = positions[spring.A] - positions[spring.B];
      const double length = Length(d);
      const glm::dvec3 pull = spring.Stiffness * spring.Length *
        (length > 1e-12 * spring.Length ? d / length : spring.RestDirection);
      const int a = this->Numbers[spring.A];
      const int b = this->Numbers[spring.B];
      for (int c = 0; c < 3; ++c)
      {
        if (a >= 0)
        {
          right(a, c) += pull[c] + (b < 0 ? spring.Stiffness * fixed[spring.B][c] : 0.0);
        }
        if (b >= 0)
        {
          right(b, c) -= pull[c] - (a < 0 ? spring.Stiffness * fixed[spring.A][c] : 0.0);
        }
      }
    }
  }

  const Eigen::VectorXd& GetResponse(int number)
  {
    auto found = this->Responses.find(number);
    if (found == this->Responses.end())
    {
      Eigen::VectorXd unit = Eigen::VectorXd::Zero(this->Free);
      unit[number] = 1.0;
      found = this->Responses.emplace(number, this->Solver.solve(unit)).first;
    }
    return found->second;
  }

  /// Lift free points to the floor by forces along its normal that only push.
  void KeepAbove(const vtkFFDBodyLoads& loads, Columns3& solution, std::vector<char>& touching)
  {
    const Eigen::Vector3d normal(
      loads.FloorNormal.x, loads.FloorNormal.y, loads.FloorNormal.z);
    const Eigen::VectorXd heights = solution * normal;
    std::vector<int> contacts;
    std::vector<char> listed(static_cast<std::size_t>(this->Free), 0);
    Eigen::VectorXd lift = Eigen::VectorXd::Zero(this->Free);
    std::vector<double> forces;
    for (int round = 0; round < ContactRounds; ++round)
    {
      bool more = false;
      for (std::size_t i = 0; i < this->Numbers.size(); ++i)
      {
        const int n = this->Numbers[i];
        if (n >= 0 && loads.Touches[i] && !listed[static_cast<std::size_t>(n)] &&
          heights[n] + lift[n] < loads.FloorHeight)
        {
          contacts.push_back(n);
          forces.push_back(0.0);
          listed[static_cast<std::size_t>(n)] = 1;
          more = true;
        }
      }
      if (!more)
      {
        break;
      }
      for (int sweep = 0; sweep < ContactSweeps; ++sweep)
      {
        double change = 0.0;
        double largest = 0.0;
        for (std::size_t c = 0; c < contacts.size(); ++c)
        {
          const Eigen::VectorXd& response = this->GetResponse(contacts[c]);
          double height = heights[contacts[c]] - loads.FloorHeight;
          for (std::size_t d = 0; d < contacts.size(); ++d)
          {
            height += forces[d] * response[contacts[d]];
          }
          const double force = std::max(0.0, forces[c] - height / response[contacts[c]]);
          change = std::max(change, std::abs(force - forces[c]));
          largest = std::max(largest, force);
          forces[c] = force;
        }
        if (change <= 1e-12 * largest)
        {
          break;
        }
      }
      lift.setZero();
      for (std::size_t c = 0; c < contacts.size(); ++c)
      {
        if (forces[c] > 0.0)
        {
          lift += forces[c] * this->GetResponse(contacts[c]);
        }
      }
    }
    for (std::size_t c = 0; c < contacts.size(); ++c)
    {
      // What the sweeps leave.
      lift[contacts[c]] =
        std::max(lift[contacts[c]], loads.FloorHeight - heights[contacts[c]]);
    }
    solution += lift * normal.transpose();
    for (std::size_t i = 0; i < this->Numbers.size(); ++i)
    {
      touching[i] = this->Numbers[i] >= 0 &&
        listed[static_cast<std::size_t>(std::max(0, this->Numbers[i]))];
    }
  }
};

//------------------------------------------------------------------------------
vtkFFDSpringSolver::vtkFFDSpringSolver(const glm::ivec3& nodes, const glm::dvec3& origin,
  const glm::dvec3& spacing, double totalMass, double structural, double shear, double bend)
  : vtkFFDBodySolver(nodes, origin, spacing, totalMass)
  , Data(new Internals)
{
  // Half of the neighbours: one of (i, -i) each.
  std::vector<glm::ivec3> offsets;
  for (int k = -1; k <= 1; ++k)
  {
    for (int j = -1; j <= 1; ++j)
    {
      for (int i = -1; i <= 1; ++i)
      {
        if (i + 3 * j + 9 * k > 0)
        {
          offsets.emplace_back(i, j, k);
        }
      }
    }
  }
  offsets.emplace_back(2, 0, 0);
  offsets.emplace_back(0, 2, 0);
  offsets.emplace_back(0, 0, 2);
  for (const glm::ivec3& offset : offsets)
  {
    const int reach = std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z);
    const bool far = std::max({ offset.x, offset.y, offset.z }) == 2;
    const double stiffness = far ? bend : reach == 1 ? structural : shear;
    if (!(stiffness > 0.0))
    {
      continue;
    }
    glm::ivec3 i;
    for (i.z = 0; i.z < nodes.z; ++i.z)
    {
      for (i.y = 0; i.y < nodes.y; ++i.y)
      {
        for (i.x = 0; i.x < nodes.x; ++i.x)
        {
          const glm::ivec3 j = i + offset;
          if (j.x < 0 || j.y < 0 || j.z < 0 || j.x >= nodes.x || j.y >= nodes.y || j.z >= nodes.z)
          {
            continue;
          }
          Internals::Spring spring;
          spring.A = this->Index(i.x, i.y, i.z);
          spring.B = this->Index(j.x, j.y, j.z);
          const glm::dvec3 d = this->Rest[spring.A] - this->Rest[spring.B];
          spring.Length = Length(d);
          spring.RestDirection = d / spring.Length;
          spring.Stiffness = stiffness;
          this->Data->Springs.push_back(spring);
        }
      }
    }
  }
}

//------------------------------------------------------------------------------
vtkFFDSpringSolver::~vtkFFDSpringSolver() = default;

//------------------------------------------------------------------------------
double vtkFFDSpringSolver::GetElasticEnergy() const
{
  return this->Data->ElasticEnergy(this->Positions);
}

//------------------------------------------------------------------------------
bool vtkFFDSpringSolver::Step(double h, const vtkFFDBodyLoads& loads)
{
  Internals& data = *this->Data;
  const std::size_t size = this->GetSize();
  data.Factorize(this->Masses, h, loads.Pinned);
  if (!data.Usable)
  {
    return false;
  }
  const std::vector<glm::dvec3> start = this->Positions;
  std::vector<glm::dvec3> fixed = start;
  bool dragged = false;
  for (std::size_t i = 0; i < size; ++i)
  {
    if (loads.Pinned[i])
    {
      dragged = dragged || Length(loads.Targets[i] - start[i]) > 0.0;
      fixed[i] = loads.Targets[i];
    }
  }
  const double before = data.ElasticEnergy(start) + this->GetLoadEnergy(loads);
  const double kineticBefore = this->GetKineticEnergy();

  Columns3 inertia(data.Free, 3);
  for (std::size_t i = 0; i < size; ++i)
  {
    const int n = data.Numbers[i];
    if (n >= 0)
    {
      glm::dvec3 force =
        this->Masses[i] / (h * h) * (start[i] + h * this->Velocities[i] + h * h * loads.Gravity);
      force += loads.Forces.empty() ? glm::dvec3(0.0) : loads.Forces[i];
      for (int c = 0; c < 3; ++c)
      {
        inertia(n, c) = force[c];
      }
    }
  }
  std::vector<char> touching(size, 0);
  const auto iterate = [&](const std::vector<glm::dvec3>& from)
  {
    std::vector<glm::dvec3> to = fixed;
    if (data.Free > 0)
    {
      Columns3 right = inertia;
      data.AddSprings(from, fixed, right);
      Columns3 solution = data.Solver.solve(right);
      if (loads.Floor)
      {
        data.KeepAbove(loads, solution, touching);
      }
      for (std::size_t i = 0; i < size; ++i)
      {
        if (data.Numbers[i] >= 0)
        {
          to[i] = Row(solution, data.Numbers[i]);
        }
      }
    }
    return to;
  };
  // With directions from the start of the step: cannot add energy.
  const std::vector<glm::dvec3> safe = iterate(start);
  const std::vector<char> safeTouching = touching;
  std::vector<glm::dvec3> accurate = safe;
  if (this->Iterations > 1)
  {
    // Where inertia alone would take the points: springs that rotate are turned along already.
    for (std::size_t i = 0; i < size; ++i)
    {
      accurate[i] =
        loads.Pinned[i] ? fixed[i] : start[i] + h * this->Velocities[i] + h * h * loads.Gravity;
    }
  }
  for (int iteration = 1; iteration < this->Iterations; ++iteration)
  {
    accurate = iterate(accurate);
  }
  const double decay = std::exp(-loads.Damping * h);
  const double slide = std::exp(-loads.FloorFriction * h);
  const auto finish = [&](const std::vector<glm::dvec3>& end, const std::vector<char>& touches)
  {
    this->Positions = end;
    for (std::size_t i = 0; i < size; ++i)
    {
      glm::dvec3 v = decay * (end[i] - start[i]) / h;
      if (touches[i])
      {
        const glm::dvec3 normal = Dot(v, loads.FloorNormal) * loads.FloorNormal;
        v = normal + slide * (v - normal);
      }
      this->Velocities[i] = loads.Pinned[i] ? glm::dvec3(0.0) : v;
    }
  };
  finish(accurate, touching);
  if (!dragged)
  {
    const double left =
      before + kineticBefore - data.ElasticEnergy(this->Positions) - this->GetLoadEnergy(loads);
    const double kinetic = this->GetKineticEnergy();
    if (left < 0.0)
    {
      finish(safe, safeTouching);
    }
    else if (kinetic > left)
    {
      const double factor = std::sqrt(left / kinetic);
      for (glm::dvec3& v : this->Velocities)
      {
        v *= factor;
      }
    }
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDSpringSolver::Settle(const vtkFFDBodyLoads& loads)
{
  Internals& data = *this->Data;
  const std::size_t size = this->GetSize();
  data.Factorize(this->Masses, 0.0, loads.Pinned);
  if (!data.Usable)
  {
    return false;
  }
  for (std::size_t i = 0; i < size; ++i)
  {
    this->Positions[i] = loads.Pinned[i] ? loads.Targets[i] : this->Positions[i];
    this->Velocities[i] = glm::dvec3(0.0);
  }
  std::vector<char> touching(size, 0);
  for (int iteration = 0; iteration < SettleIterations && data.Free > 0; ++iteration)
  {
    Columns3 right = Columns3::Zero(data.Free, 3);
    for (std::size_t i = 0; i < size; ++i)
    {
      if (data.Numbers[i] >= 0)
      {
        glm::dvec3 force = this->Masses[i] * loads.Gravity;
        force += loads.Forces.empty() ? glm::dvec3(0.0) : loads.Forces[i];
        for (int c = 0; c < 3; ++c)
        {
          right(data.Numbers[i], c) = force[c];
        }
      }
    }
    data.AddSprings(this->Positions, this->Positions, right);
    Columns3 solution = data.Solver.solve(right);
    if (loads.Floor)
    {
      data.KeepAbove(loads, solution, touching);
    }
    double change = 0.0;
    for (std::size_t i = 0; i < size; ++i)
    {
      if (data.Numbers[i] >= 0)
      {
        const glm::dvec3 to = Row(solution, data.Numbers[i]);
        change = std::max(change, Length(to - this->Positions[i]));
        this->Positions[i] = to;
      }
    }
    if (!(change > 1e-10 * std::min({ this->Spacing.x, this->Spacing.y, this->Spacing.z })))
    {
      break;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
struct vtkFFDElasticSolver::Internals
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
          gradient[a] =
            0.125 * s[a] * (1.0 + s[b] * t[b]) * (1.0 + s[c] * t[c]) * 2.0 / size[a];
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
vtkFFDElasticSolver::vtkFFDElasticSolver(const glm::ivec3& nodes, const glm::dvec3& origin,
  const glm::dvec3& spacing, double totalMass, double young, double poisson)
  : vtkFFDBodySolver(nodes, origin, spacing, totalMass)
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
vtkFFDElasticSolver::~vtkFFDElasticSolver() = default;

//------------------------------------------------------------------------------
namespace
{

using ConstMap = Eigen::Map<const Eigen::VectorXd>;

ConstMap Flat(const std::vector<glm::dvec3>& values)
{
  return ConstMap(&values[0].x, static_cast<Eigen::Index>(3 * values.size()));
}

Eigen::VectorXd ForcesOf(const vtkFFDBodySolver& body, const vtkFFDBodyLoads& loads)
{
  std::vector<glm::dvec3> forces(body.GetSize());
  for (std::size_t i = 0; i < forces.size(); ++i)
  {
    forces[i] = body.Masses[i] * loads.Gravity;
    forces[i] += loads.Forces.empty() ? glm::dvec3(0.0) : loads.Forces[i];
  }
  return Flat(forces);
}

} // namespace

//------------------------------------------------------------------------------
double vtkFFDElasticSolver::GetElasticEnergy() const
{
  const Eigen::VectorXd u = Flat(this->Positions) - Flat(this->Rest);
  return 0.5 * u.dot(this->Data->Stiffness * u);
}

//------------------------------------------------------------------------------
bool vtkFFDElasticSolver::Step(double h, const vtkFFDBodyLoads& loads)
{
  Internals& data = *this->Data;
  data.Factorize(h, loads.Damping, 4.0 / (h * h) + 2.0 / h * loads.Damping, this->Masses,
    loads.Pinned);
  if (!data.Usable)
  {
    return false;
  }
  const Eigen::VectorXd forces = ForcesOf(*this, loads);
  const Eigen::VectorXd u = Flat(this->Positions) - Flat(this->Rest);
  Eigen::VectorXd v = Flat(this->Velocities);
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
    masses.cwiseProduct(
      4.0 / (h * h) * u + 4.0 / h * v + a + loads.Damping * (2.0 / h * u + v));
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
bool vtkFFDElasticSolver::Settle(const vtkFFDBodyLoads& loads)
{
  Internals& data = *this->Data;
  data.Factorize(0.0, 0.0, 0.0, this->Masses, loads.Pinned);
  if (!data.Usable)
  {
    return false;
  }
  Eigen::VectorXd u = Flat(this->Positions) - Flat(this->Rest);
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
