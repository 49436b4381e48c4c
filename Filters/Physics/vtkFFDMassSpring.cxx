// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDMassSpring.h"

#include "vtkFFDGuard.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeData.h"

#include "FFDControlNet.h"
#include "FFDElasticSolver.h"
#include "FFDSpringSolver.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>

vtkStandardNewMacro(vtkFFDMassSpring);
vtkFFDGuardedProcessRequestMacro(vtkFFDMassSpring);

namespace
{

constexpr int LargestDimension = 64;
constexpr double LargestNumberOfSteps = 1e7;

/// Of all that is set: energies are products of some of them.
constexpr double LargestNumber = 1e50;

/// Of the masses: a lattice, which interpolates it, can have 1e100.
constexpr double LargestDisplacement = 1e98;

/// False for what is not a number, too.
bool AreWithin(double limit, double x, double y, double z)
{
  return std::abs(x) <= limit && std::abs(y) <= limit && std::abs(z) <= limit;
}

/// Whether a lattice can have the displacements, and numbers the energy of motion and springs.
bool IsUsable(const ffd::BodySolver& body)
{
  for (std::size_t i = 0; i < body.GetSize(); ++i)
  {
    const glm::dvec3 move = body.Positions[i] - body.Rest[i];
    if (!AreWithin(LargestDisplacement, move.x, move.y, move.z))
    {
      return false;
    }
  }
  return std::isfinite(body.GetKineticEnergy() + body.GetElasticEnergy());
}

} // namespace

//------------------------------------------------------------------------------
class vtkFFDMassSpring::vtkInternals
{
public:
  std::unique_ptr<ffd::BodySolver> Solver;
  ffd::BodyLoads Loads;
  bool Valid = false;
  vtkMTimeType LatticeTime = 0;
  vtkIdType Handle = -1;
  long long Steps = 0;
  int Offset = 0; // of the solver's nodes in the lattice's indices
  std::vector<char> KeptPins;
  vtkNew<vtkFFDLattice> Shape; // as the body was made; its dimensions, domain and border count
};

//------------------------------------------------------------------------------
vtkFFDMassSpring::vtkFFDMassSpring()
  : Model(SPRINGS)
  , Mass(1.0)
  , StructuralStiffness(100.0)
  , ShearStiffness(50.0)
  , BendStiffness(25.0)
  , YoungModulus(1000.0)
  , PoissonRatio(0.3)
  , Damping(0.5)
  , Gravity{ 0.0, 0.0, 0.0 }
  , InitialVelocity{ 0.0, 0.0, 0.0 }
  , InitialSpin{ 0.0, 0.0, 0.0 }
  , Floor(0)
  , FloorOrigin{ 0.0, 0.0, 0.0 }
  , FloorNormal{ 0.0, 0.0, 1.0 }
  , FloorFriction(20.0)
  , TimeStep(0.01)
  , Iterations(10)
  , Duration(10.0)
  , Body(new vtkInternals)
{
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkFFDMassSpring::~vtkFFDMassSpring() = default;

//------------------------------------------------------------------------------
void vtkFFDMassSpring::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const auto vector = [&](const char* name, const double v[3]) {
    os << indent << name << ": (" << v[0] << ", " << v[1] << ", " << v[2] << ")\n";
  };
  os << indent << "InputLattice: " << (this->InputLattice ? "given" : "(none)") << "\n";
  os << indent << "Model: " << (this->Model == SPRINGS ? "Springs" : "LinearElastic") << "\n";
  os << indent << "Mass: " << this->Mass << "\n";
  os << indent << "StructuralStiffness: " << this->StructuralStiffness << "\n";
  os << indent << "ShearStiffness: " << this->ShearStiffness << "\n";
  os << indent << "BendStiffness: " << this->BendStiffness << "\n";
  os << indent << "YoungModulus: " << this->YoungModulus << "\n";
  os << indent << "PoissonRatio: " << this->PoissonRatio << "\n";
  os << indent << "Damping: " << this->Damping << "\n";
  vector("Gravity", this->Gravity);
  vector("InitialVelocity", this->InitialVelocity);
  vector("InitialSpin", this->InitialSpin);
  os << indent << "Floor: " << (this->Floor ? "on" : "off") << "\n";
  vector("FloorOrigin", this->FloorOrigin);
  vector("FloorNormal", this->FloorNormal);
  os << indent << "FloorFriction: " << this->FloorFriction << "\n";
  os << indent << "TimeStep: " << this->TimeStep << "\n";
  os << indent << "Iterations: " << this->Iterations << "\n";
  os << indent << "Duration: " << this->Duration << "\n";
  os << indent << "Steps: " << this->Body->Steps << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::BodyChanged()
{
  this->Body->Valid = false;
  this->Modified();
}

//------------------------------------------------------------------------------
bool vtkFFDMassSpring::SetNumber(double& member, double value, bool usable, const char* name)
{
  if (!AreWithin(LargestNumber, value, 0.0, 0.0) || !usable)
  {
    vtkErrorMacro("Set" << name << ": " << value << " is out of range; " << member
                        << " stays. See the documentation of " << name << ".");
    return false;
  }
  if (member == value)
  {
    return false;
  }
  member = value;
  this->Modified();
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDMassSpring::SetVector(double member[3], double x, double y, double z, const char* name)
{
  if (!AreWithin(LargestNumber, x, y, z))
  {
    vtkErrorMacro("Set" << name << ": (" << x << ", " << y << ", " << z
                        << ") is not finite or exceeds 1e50. Give other numbers.");
    return false;
  }
  if (member[0] == x && member[1] == y && member[2] == z)
  {
    return false;
  }
  member[0] = x;
  member[1] = y;
  member[2] = z;
  this->Modified();
  return true;
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetLattice(vtkFFDLattice* lattice)
{
  if (this->InputLattice != lattice)
  {
    this->InputLattice = lattice;
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDMassSpring::GetInputLattice() { return this->InputLattice; }

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetModel(int model)
{
  if (model != SPRINGS && model != LINEAR_ELASTIC)
  {
    vtkErrorMacro("SetModel: " << model << " is no model. Give SPRINGS or LINEAR_ELASTIC.");
    return;
  }
  if (this->Model != model)
  {
    this->Model = model;
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetMass(double mass)
{
  if (this->SetNumber(this->Mass, mass, mass > 0.0, "Mass"))
  {
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetStructuralStiffness(double stiffness)
{
  if (this->SetNumber(
        this->StructuralStiffness, stiffness, stiffness >= 0.0, "StructuralStiffness"))
  {
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetShearStiffness(double stiffness)
{
  if (this->SetNumber(this->ShearStiffness, stiffness, stiffness >= 0.0, "ShearStiffness"))
  {
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetBendStiffness(double stiffness)
{
  if (this->SetNumber(this->BendStiffness, stiffness, stiffness >= 0.0, "BendStiffness"))
  {
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetYoungModulus(double modulus)
{
  if (this->SetNumber(this->YoungModulus, modulus, modulus > 0.0, "YoungModulus"))
  {
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetPoissonRatio(double ratio)
{
  if (this->SetNumber(this->PoissonRatio, ratio, ratio > -1.0 && ratio < 0.5, "PoissonRatio"))
  {
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetDamping(double damping)
{
  this->SetNumber(this->Damping, damping, damping >= 0.0, "Damping");
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetGravity(double x, double y, double z)
{
  this->SetVector(this->Gravity, x, y, z, "Gravity");
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetGravity(const double gravity[3])
{
  if (!gravity)
  {
    vtkErrorMacro("SetGravity: gravity is null. Give three numbers.");
    return;
  }
  this->SetGravity(gravity[0], gravity[1], gravity[2]);
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetInitialVelocity(double x, double y, double z)
{
  if (this->SetVector(this->InitialVelocity, x, y, z, "InitialVelocity"))
  {
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetInitialSpin(double x, double y, double z)
{
  if (this->SetVector(this->InitialSpin, x, y, z, "InitialSpin"))
  {
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetFloorOrigin(double x, double y, double z)
{
  this->SetVector(this->FloorOrigin, x, y, z, "FloorOrigin");
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetFloorNormal(double x, double y, double z)
{
  const double length = std::hypot(x, y, z);
  if (!(length > 0.0) || !std::isfinite(length))
  {
    vtkErrorMacro("SetFloorNormal: (" << x << ", " << y << ", " << z
                                      << ") has no direction. Give a vector that is not 0.");
    return;
  }
  this->SetVector(this->FloorNormal, x / length, y / length, z / length, "FloorNormal");
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetFloorFriction(double friction)
{
  this->SetNumber(this->FloorFriction, friction, friction >= 0.0, "FloorFriction");
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetTimeStep(double step)
{
  if (this->SetNumber(this->TimeStep, step, step > 0.0, "TimeStep"))
  {
    this->BodyChanged();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetDuration(double duration)
{
  this->SetNumber(this->Duration, duration, duration >= 0.0, "Duration");
}

//------------------------------------------------------------------------------
bool vtkFFDMassSpring::Prepare()
{
  return vtkFFDGuarded(this, "The body", false, [&] {
    vtkInternals& body = *this->Body;
    vtkNew<vtkFFDLattice> unit;
    vtkFFDLattice* lattice =
      this->InputLattice ? this->InputLattice.GetPointer() : unit.GetPointer();
    if (body.Valid && (!this->InputLattice || body.LatticeTime == lattice->GetMTime()))
    {
      return true;
    }
    int n[3];
    double first[3];
    double spacing[3];
    lattice->GetDimensions(n);
    lattice->GetRestPoint(0, 0, 0, first);
    lattice->GetSpacing(spacing);
    vtkDoubleArray* displacements = lattice->GetDisplacements();
    bool finite = true;
    for (vtkIdType i = 0; i < displacements->GetNumberOfValues(); ++i)
    {
      finite =
        finite && std::isfinite(displacements->GetValue(i) * lattice->GetDisplacementScale());
    }
    if (!finite || lattice->GetInverseFlag() != 0 ||
      std::max({ n[0], n[1], n[2] }) > LargestDimension ||
      displacements->GetNumberOfTuples() != lattice->GetNumberOfControlPoints())
    {
      vtkErrorMacro("The lattice cannot be a body: it is inverted, has more than "
        << LargestDimension
        << " control points along an axis, or displacements that are not finite.");
      body.Valid = false;
      return false;
    }
    body.Valid = false;
    body.Offset = this->Model == LINEAR_ELASTIC ? 1 : 0;
    glm::ivec3 nodes;
    glm::dvec3 origin;
    const glm::dvec3 step(spacing[0], spacing[1], spacing[2]);
    for (int a = 0; a < 3; ++a)
    {
      nodes[a] = n[a] - 2 * body.Offset;
      origin[a] = first[a] + body.Offset * spacing[a];
    }
    if (this->Model == LINEAR_ELASTIC)
    {
      body.Solver.reset(new ffd::ElasticSolver(
        nodes, origin, step, this->Mass, this->YoungModulus, this->PoissonRatio));
    }
    else
    {
      body.Solver.reset(new ffd::SpringSolver(nodes, origin, step, this->Mass,
        this->StructuralStiffness, this->ShearStiffness, this->BendStiffness));
    }
    ffd::BodySolver& solver = *body.Solver;
    const std::size_t size = solver.GetSize();
    body.Loads = ffd::BodyLoads();
    body.Loads.Touches.assign(size, 0);
    // Elastic nodes start where the spline takes them, masses where the control points are.
    vtkNew<vtkFFDLattice> start;
    start->DeepCopy(lattice);
    start->Update();
    for (int k = 0; k < nodes.z; ++k)
    {
      for (int j = 0; j < nodes.y; ++j)
      {
        for (int i = 0; i < nodes.x; ++i)
        {
          const std::size_t id = solver.Index(i, j, k);
          glm::dvec3& position = solver.Positions[id];
          if (this->Model == LINEAR_ELASTIC)
          {
            start->InternalTransformPoint(&solver.Rest[id].x, &position.x);
          }
          else
          {
            double d[3];
            lattice->GetDisplacement(i, j, k, d);
            position += lattice->GetDisplacementScale() * glm::dvec3(d[0], d[1], d[2]);
            body.Loads.Touches[id] =
              i >= 1 && j >= 1 && k >= 1 && i < nodes.x - 1 && j < nodes.y - 1 && k < nodes.z - 1;
          }
        }
      }
    }
    glm::dvec3 center(0.0);
    for (const glm::dvec3& position : solver.Positions)
    {
      center += position / static_cast<double>(size);
    }
    const glm::dvec3 velocity(
      this->InitialVelocity[0], this->InitialVelocity[1], this->InitialVelocity[2]);
    const glm::dvec3 w(this->InitialSpin[0], this->InitialSpin[1], this->InitialSpin[2]);
    for (std::size_t i = 0; i < size; ++i)
    {
      const glm::dvec3 r = solver.Positions[i] - center;
      solver.Velocities[i] =
        velocity + glm::dvec3(w.y * r.z - w.z * r.y, w.z * r.x - w.x * r.z, w.x * r.y - w.y * r.x);
    }
    if (!IsUsable(solver))
    {
      vtkErrorMacro("The body cannot start: with its Mass and stiffness, the displacements of the "
                    "lattice, InitialVelocity or InitialSpin are too large.");
      return false;
    }
    body.Loads.Pinned.assign(size, 0);
    if (body.KeptPins.size() == size)
    {
      body.Loads.Pinned = body.KeptPins;
    }
    body.KeptPins = body.Loads.Pinned;
    body.Loads.Targets = solver.Positions;
    body.Handle = -1;
    body.Steps = 0;
    body.LatticeTime = lattice->GetMTime();
    body.Valid = true;
    // The domain and the border of the body's lattice, for our own.
    body.Shape->DeepCopy(lattice);
    body.Shape->SetDisplacementScale(1.0);
    this->Lattice->DeepCopy(body.Shape);
    this->UpdateLattice();
    return true;
  });
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::UpdateLattice()
{
  const ffd::BodySolver& solver = *this->Body->Solver;
  ffd::ControlNet net;
  net.Nodes = solver.Nodes;
  for (std::size_t i = 0; i < solver.GetSize(); ++i)
  {
    net.Values.push_back(solver.Positions[i] - solver.Rest[i]);
  }
  if (this->Model == LINEAR_ELASTIC)
  {
    net = ffd::InterpolateControlNet(net);
  }
  const auto isBody = [&] {
    return std::equal(this->Lattice->GetDimensions(), this->Lattice->GetDimensions() + 3,
             this->Body->Shape->GetDimensions()) &&
      this->Lattice->GetDisplacements()->GetNumberOfTuples() ==
      static_cast<vtkIdType>(net.Values.size());
  };
  if (!isBody())
  {
    // Somebody has given it other dimensions.
    this->Lattice->DeepCopy(this->Body->Shape);
  }
  if (!isBody())
  {
    vtkErrorMacro("Observers of the lattice of GetLattice() give it other dimensions than those of "
                  "the body. It is left as it is.");
    return;
  }
  vtkDoubleArray* displacements = this->Lattice->GetDisplacements();
  for (std::size_t i = 0; i < net.Values.size(); ++i)
  {
    displacements->SetTypedTuple(static_cast<vtkIdType>(i), &net.Values[i].x);
  }
  this->Lattice->Modified();
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDMassSpring::FindPoint(int i, int j, int k, const char* caller)
{
  if (!this->Prepare())
  {
    return -1;
  }
  const glm::ivec3 at = glm::ivec3(i, j, k) - this->Body->Offset;
  const glm::ivec3& n = this->Body->Solver->Nodes;
  if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= n.x || at.y >= n.y || at.z >= n.z)
  {
    vtkErrorMacro(<< caller << ": there is no mass at control point (" << i << ", " << j << ", "
                  << k << "). Indices go from " << this->Body->Offset << " to ("
                  << n.x - 1 + this->Body->Offset << ", " << n.y - 1 + this->Body->Offset << ", "
                  << n.z - 1 + this->Body->Offset << ").");
    return -1;
  }
  return static_cast<vtkIdType>(this->Body->Solver->Index(at.x, at.y, at.z));
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::Pin(int i, int j, int k)
{
  const vtkIdType id = this->FindPoint(i, j, k, "Pin");
  if (id >= 0)
  {
    vtkInternals& body = *this->Body;
    const std::size_t at = static_cast<std::size_t>(id);
    body.Loads.Pinned[at] = 1;
    body.Loads.Targets[at] = body.Solver->Positions[at];
    body.KeptPins[at] = 1;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::Unpin(int i, int j, int k)
{
  const vtkIdType id = this->FindPoint(i, j, k, "Unpin");
  if (id >= 0)
  {
    this->Body->Loads.Pinned[static_cast<std::size_t>(id)] = 0;
    this->Body->KeptPins[static_cast<std::size_t>(id)] = 0;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::PinLayer(int axis, int index)
{
  if (axis < 0 || axis > 2)
  {
    vtkErrorMacro("PinLayer: there is no axis " << axis << ". Give 0, 1 or 2.");
    return;
  }
  if (!this->Prepare())
  {
    return;
  }
  const int offset = this->Body->Offset;
  glm::ivec3 low(offset);
  glm::ivec3 high = this->Body->Solver->Nodes - 1 + offset;
  if (index < low[axis] || index > high[axis])
  {
    vtkErrorMacro("PinLayer: there is no layer " << index << " along axis " << axis
                                                 << ". Indices go from " << low[axis] << " to "
                                                 << high[axis] << ".");
    return;
  }
  low[axis] = high[axis] = index;
  for (int k = low.z; k <= high.z; ++k)
  {
    for (int j = low.y; j <= high.y; ++j)
    {
      for (int i = low.x; i <= high.x; ++i)
      {
        this->Pin(i, j, k);
      }
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::UnpinAll()
{
  if (this->Prepare())
  {
    std::fill(this->Body->Loads.Pinned.begin(), this->Body->Loads.Pinned.end(), char(0));
    std::fill(this->Body->KeptPins.begin(), this->Body->KeptPins.end(), char(0));
    this->Body->Handle = -1;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
bool vtkFFDMassSpring::IsPinned(int i, int j, int k)
{
  const vtkIdType id = this->FindPoint(i, j, k, "IsPinned");
  return id >= 0 && this->Body->KeptPins[static_cast<std::size_t>(id)] != 0;
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetHandle(int i, int j, int k, double x, double y, double z)
{
  if (!AreWithin(LargestNumber, x, y, z))
  {
    vtkErrorMacro("SetHandle: (" << x << ", " << y << ", " << z
                                 << ") is not finite or exceeds 1e50. Give a position.");
    return;
  }
  const vtkIdType id = this->FindPoint(i, j, k, "SetHandle");
  if (id < 0)
  {
    return;
  }
  if (id != this->Body->Handle)
  {
    this->ReleaseHandle();
    this->Body->Handle = id;
  }
  this->Body->Loads.Pinned[static_cast<std::size_t>(id)] = 1;
  this->Body->Loads.Targets[static_cast<std::size_t>(id)] = { x, y, z };
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::ReleaseHandle()
{
  vtkInternals& body = *this->Body;
  if (body.Valid && body.Handle >= 0)
  {
    // A pinned point stays where it was dragged to.
    const std::size_t at = static_cast<std::size_t>(body.Handle);
    body.Loads.Pinned[at] = body.KeptPins[at];
    body.Loads.Targets[at] = body.Solver->Positions[at];
    body.Handle = -1;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::SetForce(int i, int j, int k, double fx, double fy, double fz)
{
  if (!AreWithin(LargestNumber, fx, fy, fz))
  {
    vtkErrorMacro("SetForce: (" << fx << ", " << fy << ", " << fz
                                << ") is not finite or exceeds 1e50. Give a force.");
    return;
  }
  const vtkIdType id = this->FindPoint(i, j, k, "SetForce");
  if (id >= 0)
  {
    this->Body->Loads.Forces.resize(this->Body->Solver->GetSize(), glm::dvec3(0.0));
    this->Body->Loads.Forces[static_cast<std::size_t>(id)] = { fx, fy, fz };
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::ClearForces()
{
  if (!this->Body->Loads.Forces.empty())
  {
    this->Body->Loads.Forces.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDMassSpring::Reset()
{
  this->BodyChanged();
  this->Prepare();
}

//------------------------------------------------------------------------------
int vtkFFDMassSpring::Step(int count)
{
  const int ok = this->Advance(count) ? 1 : 0;
  // The output without a time is the state.
  this->Modified();
  return ok;
}

//------------------------------------------------------------------------------
bool vtkFFDMassSpring::Advance(int count)
{
  return vtkFFDGuarded(this, "Step", false, [&] {
    if (!this->Prepare())
    {
      return false;
    }
    vtkInternals& body = *this->Body;
    ffd::BodyLoads& loads = body.Loads;
    loads.Gravity = { this->Gravity[0], this->Gravity[1], this->Gravity[2] };
    loads.Damping = this->Damping;
    loads.FloorNormal = { this->FloorNormal[0], this->FloorNormal[1], this->FloorNormal[2] };
    loads.FloorHeight = 0.0;
    for (int a = 0; a < 3; ++a)
    {
      loads.FloorHeight += this->FloorOrigin[a] * this->FloorNormal[a];
    }
    loads.FloorFriction = this->FloorFriction;
    loads.Floor = this->Floor != 0;
    if (this->Floor && this->Model == LINEAR_ELASTIC)
    {
      vtkErrorMacro("A linear elastic body knows no floor. Turn Floor off, or use SPRINGS.");
      return false;
    }
    if (auto* springs = dynamic_cast<ffd::SpringSolver*>(body.Solver.get()))
    {
      springs->Iterations = this->Iterations;
    }
    bool ok = true;
    for (int i = 0; i < count && ok; ++i)
    {
      ok = body.Solver->Step(this->TimeStep, loads) && IsUsable(*body.Solver);
      body.Steps += ok ? 1 : 0;
    }
    if (!ok)
    {
      vtkErrorMacro(
        "The motion cannot be computed: the numbers of stiffness, mass and TimeStep are "
        "too far apart, or forces are too large. The body is reset.");
      body.Valid = false;
      this->Prepare();
      return false;
    }
    this->UpdateLattice();
    return true;
  });
}

//------------------------------------------------------------------------------
int vtkFFDMassSpring::SolveEquilibrium()
{
  return vtkFFDGuarded(this, "SolveEquilibrium", 0, [&] {
    // Takes over the loads.
    if (!this->Advance(0))
    {
      return 0;
    }
    const std::vector<glm::dvec3> before = this->Body->Solver->Positions;
    const std::vector<glm::dvec3> velocities = this->Body->Solver->Velocities;
    if (!this->Body->Solver->Settle(this->Body->Loads) || !IsUsable(*this->Body->Solver))
    {
      this->Body->Solver->Positions = before;
      this->Body->Solver->Velocities = velocities;
      vtkErrorMacro(
        "SolveEquilibrium: nothing holds the body, or part of it. Pin three points or more "
        "that are not on a line. Or forces are too large for the stiffness.");
      return 0;
    }
    this->UpdateLattice();
    this->Modified();
    return 1;
  });
}

//------------------------------------------------------------------------------
double vtkFFDMassSpring::GetTime()
{
  return this->Prepare() ? static_cast<double>(this->Body->Steps) * this->TimeStep : 0.0;
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDMassSpring::GetLattice()
{
  this->Prepare();
  return this->Lattice;
}

//------------------------------------------------------------------------------
double vtkFFDMassSpring::GetKineticEnergy()
{
  return this->Prepare() ? this->Body->Solver->GetKineticEnergy() : 0.0;
}

//------------------------------------------------------------------------------
double vtkFFDMassSpring::GetElasticEnergy()
{
  return this->Prepare() ? this->Body->Solver->GetElasticEnergy() : 0.0;
}

//------------------------------------------------------------------------------
double vtkFFDMassSpring::GetLoadEnergy()
{
  if (!this->Prepare())
  {
    return 0.0;
  }
  this->Body->Loads.Gravity = { this->Gravity[0], this->Gravity[1], this->Gravity[2] };
  return this->Body->Solver->GetLoadEnergy(this->Body->Loads);
}

//------------------------------------------------------------------------------
double vtkFFDMassSpring::GetTotalEnergy()
{
  return this->GetKineticEnergy() + this->GetElasticEnergy() + this->GetLoadEnergy();
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDMassSpring::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->InputLattice ? std::max(own, this->InputLattice->GetMTime()) : own;
}

//------------------------------------------------------------------------------
int vtkFFDMassSpring::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  if (!this->Prepare())
  {
    return 0;
  }
  const double range[2] = { 0.0, this->Duration };
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkFFDDescribeLatticeImage(this->Lattice, info);
  info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), range, 2);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDMassSpring::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkImageData* output = vtkImageData::GetData(outputs);
  if (!output || !this->Prepare())
  {
    return 0;
  }
  // Without a time the state is given out as it is, for Step() by hand.
  if (info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()))
  {
    double time = info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
    if (std::isnan(time))
    {
      vtkErrorMacro("The time is not a number. Ask for one from 0 to " << this->Duration << ".");
      return 0;
    }
    time = std::clamp(time, 0.0, this->Duration);
    const double steps = std::floor(time / this->TimeStep + 0.5);
    if (!(steps <= LargestNumberOfSteps))
    {
      vtkErrorMacro("The time " << time << " takes more than 10^7 steps of " << this->TimeStep
                                << ". Set a longer TimeStep.");
      return 0;
    }
    const long long target = static_cast<long long>(steps);
    if (target < this->Body->Steps)
    {
      this->Body->Valid = false;
      if (!this->Prepare())
      {
        return 0;
      }
    }
    const long long from = this->Body->Steps;
    while (this->Body->Steps < target && !this->GetAbortExecute())
    {
      if (!this->Advance(1))
      {
        return 0;
      }
      this->UpdateProgress(
        static_cast<double>(this->Body->Steps - from) / static_cast<double>(target - from));
    }
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), this->GetTime());
  }
  return this->Lattice->ToImageData(output);
}
