// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDMassSpring
 * @brief   a lattice that moves by physics: springs, or a linear elastic solid, in time
 *
 * The lattice of SetLattice() becomes a body: its rest positions are where no forces act, its
 * displacements (times DisplacementScale) where it starts. Gravity, damping, pins, a dragged
 * handle, forces and a floor act on it. Two models:
 * - SPRINGS (default): the control points are masses, joined along the axes (structural), along
 *   diagonals (shear) and to their second neighbors (bend). Large motions and rotations. Implicit
 *   Euler by alternating minimization (Liu et al. 2013), stable at any time step; it damps fast
 *   vibrations by itself, the more the longer the step. Without input (a moving handle, a floor
 *   that cuts into the body, changed forces) the energy never grows.
 * - LINEAR_ELASTIC: finite elements on the cells of the lattice's domain (hexahedra with
 *   incompatible modes), YoungModulus and PoissonRatio. Small deformations; large rotations blow a
 *   linear solid up. Newmark's method, which conserves the energy exactly without Damping. The
 *   masses are the nodes of the domain, control points 1 to n - 2; the lattice interpolates them,
 *   and the outer control points follow. No floor.
 *
 * Units are those of the user, consistent: with data in mm and seconds, gravity is 9810. Mass is
 * that of the whole body: in equal shares for springs, an eighth of each cell's to its corners for
 * a solid. Stiffness of springs is force per length, per spring. Setters refuse numbers that are
 * out of range, not finite or beyond 1e50; a step whose positions or energies are no numbers any
 * more is an error, and starts the body again.
 *
 * Two ways to use it. Interactive: Step() in a timer, then render with GetLattice() as the mapper's
 * deformation; drag with SetHandle(). As a source: the output is the image of the control points
 * (as that of vtkFFDLatticeSource) at the time that the pipeline asks for, in [0, Duration]; going
 * back in time starts again. What shapes the body (lattice, model, mass, stiffness, material,
 * InitialVelocity, InitialSpin, TimeStep) starts it again, too, as Reset() does; loads, pins and
 * handle act from the next step on.
 *
 * Cost: a sparse matrix is factorized when pins, the dragged point or the time step change, for
 * LINEAR_ELASTIC also when the damping does; then a step of SPRINGS solves with it once for each of
 * its Iterations, one of LINEAR_ELASTIC once. Runs on one core.
 *
 * @sa vtkFFDLattice vtkFFDDeformVolume
 */
#ifndef vtkFFDMassSpring_h
#define vtkFFDMassSpring_h

#include "vtkFFDPhysicsModule.h" // For export macro
#include "vtkImageAlgorithm.h"
#include "vtkNew.h"          // for vtkNew
#include "vtkSmartPointer.h" // for vtkSmartPointer

#include <memory> // for std::unique_ptr

class vtkFFDLattice;

class VTKFFDPHYSICS_EXPORT vtkFFDMassSpring : public vtkImageAlgorithm
{
public:
  static vtkFFDMassSpring* New();
  vtkTypeMacro(vtkFFDMassSpring, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Models of the material.
  enum ModelType
  {
    SPRINGS = 0,   ///< masses and springs
    LINEAR_ELASTIC ///< finite elements of a linear elastic solid
  };

  ///@{
  /**
   * The body. It is copied at the start. An inverted lattice is refused. At most 64 control points
   * per axis. Default: none, which means a unit cube of 4^3 control points.
   */
  void SetLattice(vtkFFDLattice* lattice);
  vtkFFDLattice* GetInputLattice();
  ///@}

  ///@{
  /**
   * One of the models. Default SPRINGS.
   */
  void SetModel(int model);
  vtkGetMacro(Model, int);
  void SetModelToSprings() { this->SetModel(SPRINGS); }
  void SetModelToLinearElastic() { this->SetModel(LINEAR_ELASTIC); }
  ///@}

  ///@{
  /**
   * Mass of the whole body, > 0. Default 1.
   */
  void SetMass(double mass);
  vtkGetMacro(Mass, double);
  ///@}

  ///@{
  /**
   * Stiffness of the springs, force per length, >= 0 (0: none of the kind). Defaults 100, 50, 25.
   */
  void SetStructuralStiffness(double stiffness);
  vtkGetMacro(StructuralStiffness, double);
  void SetShearStiffness(double stiffness);
  vtkGetMacro(ShearStiffness, double);
  void SetBendStiffness(double stiffness);
  vtkGetMacro(BendStiffness, double);
  ///@}

  ///@{
  /**
   * Material of LINEAR_ELASTIC: Young's modulus, force per area, > 0, and Poisson's ratio, -1 < nu
   * < 0.5. Defaults: 1000 and 0.3.
   */
  void SetYoungModulus(double modulus);
  vtkGetMacro(YoungModulus, double);
  void SetPoissonRatio(double ratio);
  vtkGetMacro(PoissonRatio, double);
  ///@}

  ///@{
  /**
   * Rate at which velocities decay, 1 / time, >= 0. Default 0.5.
   */
  void SetDamping(double damping);
  vtkGetMacro(Damping, double);
  ///@}

  ///@{
  /**
   * Acceleration of gravity, finite. Default: 0, 0, 0.
   */
  void SetGravity(double x, double y, double z);
  void SetGravity(const double gravity[3]);
  vtkGetVector3Macro(Gravity, double);
  ///@}

  ///@{
  /**
   * Velocity of all points at the start, and rotation about their center (vector along the axis,
   * radians per time). Default 0.
   */
  void SetInitialVelocity(double x, double y, double z);
  vtkGetVector3Macro(InitialVelocity, double);
  void SetInitialSpin(double x, double y, double z);
  vtkGetVector3Macro(InitialSpin, double);
  ///@}

  ///@{
  /**
   * A plane that stops the control points 1 to n - 2, those of the domain (the outer ones shape the
   * border only): points p with (p - FloorOrigin) . FloorNormal >= 0 are above. SPRINGS only: a
   * step of LINEAR_ELASTIC with a floor is an error. Default: off.
   */
  vtkSetMacro(Floor, vtkTypeBool);
  vtkGetMacro(Floor, vtkTypeBool);
  vtkBooleanMacro(Floor, vtkTypeBool);
  ///@}

  ///@{
  /**
   * A point of the floor, finite. Default: 0, 0, 0.
   */
  void SetFloorOrigin(double x, double y, double z);
  vtkGetVector3Macro(FloorOrigin, double);
  ///@}

  ///@{
  /**
   * The direction away from the floor, not 0; made a unit vector. Default: 0, 0, 1.
   */
  void SetFloorNormal(double x, double y, double z);
  vtkGetVector3Macro(FloorNormal, double);
  ///@}

  ///@{
  /**
   * Rate at which points that touch the floor lose their sliding velocity, 1 / time, >= 0. Default:
   * 20.
   */
  void SetFloorFriction(double friction);
  vtkGetMacro(FloorFriction, double);
  ///@}

  ///@{
  /**
   * Length of a step, > 0, and iterations of the minimization in each, 1 to 100 (SPRINGS; fewer
   * damp rotations more). Defaults: 0.01 and 10.
   */
  void SetTimeStep(double step);
  vtkGetMacro(TimeStep, double);
  vtkSetClampMacro(Iterations, int, 1, 100);
  vtkGetMacro(Iterations, int);
  ///@}

  ///@{
  /**
   * Last time that the pipeline can ask for, >= 0, at most 10^7 steps. Default 10.
   */
  void SetDuration(double duration);
  vtkGetMacro(Duration, double);
  ///@}

  ///@{
  /**
   * Hold control point (i, j, k) where it is, or let it go. PinLayer: all points with this index
   * along an axis (0, 1, 2). UnpinAll() also releases the handle. With LINEAR_ELASTIC indices are
   * from 1 to n - 2.
   */
  void Pin(int i, int j, int k);
  void Unpin(int i, int j, int k);
  void PinLayer(int axis, int index);
  void UnpinAll();
  bool IsPinned(int i, int j, int k);
  ///@}

  ///@{
  /**
   * Drag control point (i, j, k) to a position, which it takes at the next step. A second call for
   * the same point moves it on; ReleaseHandle() lets it go. There is one handle.
   */
  void SetHandle(int i, int j, int k, double x, double y, double z);
  void ReleaseHandle();
  ///@}

  ///@{
  /**
   * A force on control point (i, j, k), replacing an earlier one; ClearForces() removes all.
   */
  void SetForce(int i, int j, int k, double fx, double fy, double fz);
  void ClearForces();
  ///@}

  /// Back to time 0. Pins stay (at the places of the start), handle and forces do not.
  void Reset();

  /**
   * Go on by `count` steps. Returns 1, or 0 after an error.
   */
  int Step(int count = 1);

  /**
   * Go to where nothing moves any more, at once: by the linear system (LINEAR_ELASTIC), or by
   * iteration (SPRINGS, up to 2000). The time stays. Returns 1, or 0 with an error when nothing
   * holds the body.
   */
  int SolveEquilibrium();

  /// Time of the state, a multiple of TimeStep.
  double GetTime();

  /**
   * The deformed lattice, at GetTime(). It belongs to this object, and stays the same one: the next
   * step overwrites edits and brings back its dimensions.
   */
  vtkFFDLattice* GetLattice();

  ///@{
  /**
   * Energies of the state: of motion, of springs or the solid, of gravity and forces (0 at rest
   * positions), and their sum.
   */
  double GetKineticEnergy();
  double GetElasticEnergy();
  double GetLoadEnergy();
  double GetTotalEnergy();
  ///@}

  /// Includes the lattice.
  vtkMTimeType GetMTime() override;

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDMassSpring();
  ~vtkFFDMassSpring() override;

  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDMassSpring(const vtkFFDMassSpring&) = delete;
  void operator=(const vtkFFDMassSpring&) = delete;

  bool SetNumber(double& member, double value, bool usable, const char* name);
  bool SetVector(double member[3], double x, double y, double z, const char* name);
  /// Make the body when there is none, or when it has changed. False after an error.
  bool Prepare();
  bool Advance(int count);
  /// Index of the solver's point, or -1 with an error.
  vtkIdType FindPoint(int i, int j, int k, const char* caller);
  void BodyChanged();
  void UpdateLattice();

  vtkSmartPointer<vtkFFDLattice> InputLattice;
  int Model;
  double Mass;
  double StructuralStiffness;
  double ShearStiffness;
  double BendStiffness;
  double YoungModulus;
  double PoissonRatio;
  double Damping;
  double Gravity[3];
  double InitialVelocity[3];
  double InitialSpin[3];
  vtkTypeBool Floor;
  double FloorOrigin[3];
  double FloorNormal[3];
  double FloorFriction;
  double TimeStep;
  int Iterations;
  double Duration;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Body;
  vtkNew<vtkFFDLattice> Lattice;
};

#endif
