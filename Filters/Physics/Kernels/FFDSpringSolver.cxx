// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDSpringSolver.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace ffd
{
namespace
{

using SparseMatrix = Eigen::SparseMatrix<double>;
using Cholesky = Eigen::SimplicialLDLT<SparseMatrix>;
using Columns3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Triplet = Eigen::Triplet<double>;

constexpr int SettleIterations = 2000;
constexpr int ContactSweeps = 200;
constexpr int ContactRounds = 8;

glm::dvec3 Row(const Columns3& columns, int row)
{
  return { columns(row, 0), columns(row, 1), columns(row, 2) };
}

} // namespace

//------------------------------------------------------------------------------
struct SpringSolver::Internals
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
      const double smallest =
        this->Solver.info() == Eigen::Success ? this->Solver.vectorD().minCoeff() : 0.0;
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
      const double stretch = glm::length(positions[spring.A] - positions[spring.B]) - spring.Length;
      energy += 0.5 * spring.Stiffness * stretch * stretch;
    }
    return energy;
  }

  /// Springs in the directions that they have at `positions`, and pinned neighbors, as forces.
  void AddSprings(const std::vector<glm::dvec3>& positions, const std::vector<glm::dvec3>& fixed,
    Columns3& right) const
  {
    for (const Spring& spring : this->Springs)
    {
      const glm::dvec3 d = positions[spring.A] - positions[spring.B];
      const double length = glm::length(d);
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
  void KeepAbove(const BodyLoads& loads, Columns3& solution, std::vector<char>& touching)
  {
    const Eigen::Vector3d normal(loads.FloorNormal.x, loads.FloorNormal.y, loads.FloorNormal.z);
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
      // The lift that the sweeps leave to do.
      lift[contacts[c]] = std::max(lift[contacts[c]], loads.FloorHeight - heights[contacts[c]]);
    }
    solution += lift * normal.transpose();
    for (std::size_t i = 0; i < this->Numbers.size(); ++i)
    {
      touching[i] =
        this->Numbers[i] >= 0 && listed[static_cast<std::size_t>(std::max(0, this->Numbers[i]))];
    }
  }
};

//------------------------------------------------------------------------------
SpringSolver::SpringSolver(const glm::ivec3& nodes, const glm::dvec3& origin,
  const glm::dvec3& spacing, double totalMass, double structural, double shear, double bend)
  : BodySolver(nodes, origin, spacing, totalMass)
  , Data(new Internals)
{
  // Half of the neighbors: one of (i, -i) each.
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
          spring.Length = glm::length(d);
          spring.RestDirection = d / spring.Length;
          spring.Stiffness = stiffness;
          this->Data->Springs.push_back(spring);
        }
      }
    }
  }
}

//------------------------------------------------------------------------------
SpringSolver::~SpringSolver() = default;

//------------------------------------------------------------------------------
double SpringSolver::GetElasticEnergy() const { return this->Data->ElasticEnergy(this->Positions); }

//------------------------------------------------------------------------------
bool SpringSolver::Step(double h, const BodyLoads& loads)
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
      dragged = dragged || glm::length(loads.Targets[i] - start[i]) > 0.0;
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
  const auto iterate = [&](const std::vector<glm::dvec3>& from) {
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
    // Positions that inertia alone would give; springs that rotate are turned along already.
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
  const auto finish = [&](const std::vector<glm::dvec3>& end, const std::vector<char>& touches) {
    this->Positions = end;
    for (std::size_t i = 0; i < size; ++i)
    {
      glm::dvec3 v = decay * (end[i] - start[i]) / h;
      if (touches[i])
      {
        const glm::dvec3 normal = glm::dot(v, loads.FloorNormal) * loads.FloorNormal;
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
bool SpringSolver::Settle(const BodyLoads& loads)
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
        change = std::max(change, glm::length(to - this->Positions[i]));
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

} // namespace ffd
