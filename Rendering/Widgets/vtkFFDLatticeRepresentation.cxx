// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLatticeRepresentation.h"

#include "FFDBSplineBasis.h"
#include "FFDBSplineField.h"
#include "FFDDirectManipulation.h"
#include "FFDEditHistory.h"
#include "FFDFoldGuard.h"
#include "FFDLatticeSelection.h"
#include "FFDPullBack.h"

#include "vtkFFDBSplineFieldFromTransform.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticePicker.h"
#include "vtkFFDLatticeScene.h"

#include "vtkAbstractPicker.h"
#include "vtkAssemblyPath.h"
#include "vtkAssemblyPaths.h"
#include "vtkCamera.h"
#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInteractorObserver.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkObjectFactory.h"
#include "vtkPickingManager.h"
#include "vtkProp3D.h"
#include "vtkProperty.h"
#include "vtkProperty2D.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkTextProperty.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkFFDLatticeRepresentation);

namespace
{

/// Below this sine between a line of sight and an axis (or plane) a drag along it does nothing: the
/// axis is seen end on, and a pixel would mean anything.
constexpr double EndOn = 0.05;

/// Cosine of 15 degrees: arms of the handle that are nearer to the line of sight are faded.
constexpr double FadedArm = 0.9659258;
constexpr unsigned char FadedAlpha = 40;

/// Control points whose pictures are nearer to each other than this cover each other, pixels.
constexpr double Covering = 2.0;

/// Part of the smallest spacing to which a point of the volume is taken back to rest.
constexpr double MaterialTolerance = 1e-7;

constexpr int RingSegments = 64;
constexpr int OutlineSegments = 24;

/// Parts of the handle: 0, 1, 2 for the axes, then the middle.
constexpr int MiddlePart = 3;

bool Finite(double a, double b, double c) { return std::isfinite(a + b + c); }

glm::dvec3 Unit(int axis)
{
  glm::dvec3 unit(0.0);
  unit[axis] = 1.0;
  return unit;
}

/// Rodrigues: v turned by an angle (radians) about a unit axis.
glm::dvec3 Turn(const glm::dvec3& v, const glm::dvec3& axis, double angle)
{
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return c * v + s * glm::cross(axis, v) + (1.0 - c) * glm::dot(axis, v) * axis;
}

vtkFFDLatticeScene::Colour ToBytes(const double rgb[3])
{
  vtkFFDLatticeScene::Colour bytes;
  for (std::size_t c = 0; c < 3; ++c)
  {
    bytes[c] = static_cast<unsigned char>(std::lround(255.0 * glm::clamp(rgb[c], 0.0, 1.0)));
  }
  return bytes;
}

/// A line of sight in data coordinates.
struct Ray
{
  glm::dvec3 Origin{ 0.0 };
  glm::dvec3 Direction{ 0.0, 0.0, 1.0 }; // unit
};

/// Where a line is nearest to a ray: Point + t * axis. False: seen end on.
bool NearestOnLine(const Ray& ray, const glm::dvec3& point, const glm::dvec3& axis, double& t)
{
  const glm::dvec3 between = point - ray.Origin;
  const double aa = glm::dot(axis, axis);
  const double ad = glm::dot(axis, ray.Direction);
  const double sine2 = aa - ad * ad;
  if (!(sine2 > EndOn * EndOn * aa))
  {
    return false;
  }
  t = (ad * glm::dot(ray.Direction, between) - glm::dot(axis, between)) / sine2;
  return true;
}

bool OnPlane(const Ray& ray, const glm::dvec3& point, const glm::dvec3& normal, glm::dvec3& hit)
{
  const double cosine = glm::dot(ray.Direction, normal);
  if (!(std::abs(cosine) > EndOn * glm::length(normal)))
  {
    return false;
  }
  hit = ray.Origin + glm::dot(point - ray.Origin, normal) / cosine * ray.Direction;
  return true;
}

double DistanceToSegment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b)
{
  const glm::dvec2 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? glm::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - a - t * along);
}

} // namespace

//------------------------------------------------------------------------------
class vtkFFDLatticeRepresentation::vtkInternals
{
public:
  explicit vtkInternals(vtkFFDLatticeRepresentation* self)
    : Self(self)
  {
  }

  vtkFFDLatticeRepresentation* const Self;
  vtkSmartPointer<vtkFFDLattice> Lattice = vtkSmartPointer<vtkFFDLattice>::New();
  vtkSmartPointer<vtkProp3D> Prop;
  vtkSmartPointer<vtkAbstractPicker> SurfacePicker;
  vtkNew<vtkFFDLatticePicker> Picker;
  bool HasOutlineBounds = false;
  double OutlineBounds[6];

  // Selection; as many as the lattice has control points (Sync).
  glm::ivec3 Nodes{ 0 };
  ffd::PointSet Selected;
  vtkIdType Active = -1;
  vtkIdType Hovered = -1;
  int HoveredPart = -1;

  // Edits.
  ffd::EditHistory History;
  std::string LastEdit;
  std::vector<std::size_t> Changed;
  bool EditIsOpen = false;
  std::string EditName;
  std::vector<glm::dvec3> EditStart; // displacements before the edit

  // Direct manipulation.
  std::vector<glm::dvec3> Pins; // at rest
  bool SurfacePointIsGiven = false;
  glm::dvec3 SurfacePoint{ 0.0 };

  // A drag.
  glm::dvec2 DragFrom{ 0.0 }; // display
  glm::dvec2 DragTo{ 0.0 };
  glm::dvec3 Anchor{ 0.0 }; // what was taken hold of, data coordinates
  glm::dvec3 Material{ 0.0 }; // at rest
  glm::dvec3 Motion{ 0.0 }; // of the anchor, so far
  int Part = -1;
  double Angle = 0.0;
  int RegionOperation = REPLACE;
  bool Ended = true; // no drag

  // The points that an edit moves, with what they need; made when it starts.
  ffd::PointSet Moving;
  std::vector<glm::dvec3> StartPositions;
  std::vector<double> Weights;
  glm::dvec3 Center{ 0.0 };
  std::size_t Leader = 0;

  // Drawing.
  vtkFFDLatticeScene Scene;
  struct HandlePart
  {
    int Id;
    std::vector<glm::dvec3> Path; // world
  };
  std::vector<HandlePart> HandleParts;

  // What the drawing was made from. Each part is made anew when its key differs, so that no setter
  // has to tell, and none can forget to.
  struct ShapeKey ///< of the lines, the outline and the bounds
  {
    const vtkFFDLattice* Lattice = nullptr;
    vtkMTimeType LatticeTime = 0;
    glm::dmat4 Matrix{ 1.0 };
    std::array<double, 6> OutlineBounds{};
    int LineMode = -1;
    vtkTypeBool Interior = 0;
    bool operator==(const ShapeKey& other) const
    {
      return this->Lattice == other.Lattice && this->LatticeTime == other.LatticeTime &&
        this->Matrix == other.Matrix && this->OutlineBounds == other.OutlineBounds &&
        this->LineMode == other.LineMode && this->Interior == other.Interior;
    }
  };
  ShapeKey BuiltShape;
  vtkMTimeType LookTime = 0;    ///< of the glyphs and all that follows options
  bool HasViewGeometry = false; ///< handle and sizes on screen are those of BuiltView and LookTime
  vtkFFDProjection BuiltView;
  vtkNew<vtkProperty> PointLook;
  vtkNew<vtkProperty> SelectedLook;
  vtkNew<vtkProperty> HoveredLook;
  vtkNew<vtkProperty> LockedLook;
  vtkNew<vtkProperty> PinLook;
  vtkNew<vtkProperty> LineLook;
  vtkNew<vtkProperty> OutlineLook;
  vtkNew<vtkProperty> WarningLook;
  vtkNew<vtkProperty> HandleLook;

  //----------------------------------------------------------------------------
  // The lattice

  /// Follow a change of the dimensions.
  void Sync()
  {
    int n[3];
    this->Lattice->GetDimensions(n);
    const glm::ivec3 nodes(n[0], n[1], n[2]);
    if (nodes != this->Nodes)
    {
      this->Nodes = nodes;
      this->Selected.assign(static_cast<std::size_t>(this->Lattice->GetNumberOfControlPoints()), 0);
      this->Active = -1;
      this->Hovered = -1;
      this->HoveredPart = -1;
      this->History.Clear();
      this->Changed.clear();
      this->EditIsOpen = false;
      this->Ended = true;
      this->Self->InteractionState = Outside;
      this->Self->Modified();
    }
  }

  /// Set an option within limits. vtkSetClampMacro would let NaN through.
  void SetClamped(const char* name, double& member, double value, double low, double high)
  {
    if (std::isnan(value))
    {
      vtkErrorWithObjectMacro(this->Self,
        << name << ": the value is not a number. Give one from " << low << " to " << high << ".");
      return;
    }
    value = glm::clamp(value, low, high);
    if (member != value)
    {
      member = value;
      this->Self->Modified();
    }
  }

  /// Whether a pointer that a caller gives points at something; an error, if not.
  bool IsGiven(const void* pointer, const char* name, const char* what)
  {
    if (!pointer)
    {
      vtkErrorWithObjectMacro(this->Self, << name << ": " << what << ".");
    }
    return pointer != nullptr;
  }

  std::size_t Count() const { return this->Selected.size(); }

  glm::ivec3 IndicesOf(std::size_t point) const
  {
    const int n = static_cast<int>(point);
    return { n % this->Nodes.x, n / this->Nodes.x % this->Nodes.y,
      n / (this->Nodes.x * this->Nodes.y) };
  }

  /// Index of (i, j, k), or -1.
  vtkIdType IndexOf(int i, int j, int k) const
  {
    if (i < 0 || j < 0 || k < 0 || i >= this->Nodes.x || j >= this->Nodes.y || k >= this->Nodes.z)
    {
      return -1;
    }
    return i + static_cast<vtkIdType>(this->Nodes.x) * (j + static_cast<vtkIdType>(this->Nodes.y) * k);
  }

  bool IsInside(vtkIdType point) const
  {
    return point >= 0 && point < static_cast<vtkIdType>(this->Count());
  }

  glm::dvec3 GetSpacing() const
  {
    glm::dvec3 spacing;
    this->Lattice->GetSpacing(&spacing.x);
    return spacing;
  }

  double GetSmallestSpacing() const
  {
    const glm::dvec3 spacing = this->GetSpacing();
    return std::min({ spacing.x, spacing.y, spacing.z });
  }

  std::vector<glm::dvec3> GetDisplacements() const
  {
    vtkDoubleArray* array = this->Lattice->GetDisplacements();
    std::vector<glm::dvec3> values(this->Count());
    for (std::size_t p = 0; p < values.size(); ++p)
    {
      array->GetTypedTuple(static_cast<vtkIdType>(p), &values[p].x);
    }
    return values;
  }

  /// Write those that differ; false if none does.
  bool SetDisplacements(const std::vector<glm::dvec3>& values)
  {
    vtkDoubleArray* array = this->Lattice->GetDisplacements();
    bool differs = false;
    for (std::size_t p = 0; p < values.size(); ++p)
    {
      glm::dvec3 now;
      array->GetTypedTuple(static_cast<vtkIdType>(p), &now.x);
      if (now != values[p])
      {
        differs = true;
        array->SetTypedTuple(static_cast<vtkIdType>(p), &values[p].x);
      }
    }
    if (differs)
    {
      this->Lattice->Modified();
      this->Self->Modified();
    }
    return differs;
  }

  std::vector<glm::dvec3> GetPositions(const std::vector<glm::dvec3>& displacements) const
  {
    glm::dvec3 origin;
    this->Lattice->GetRestPoint(0, 0, 0, &origin.x);
    const glm::dvec3 spacing = this->GetSpacing();
    std::vector<glm::dvec3> positions(displacements.size());
    for (std::size_t p = 0; p < positions.size(); ++p)
    {
      positions[p] = origin + glm::dvec3(this->IndicesOf(p)) * spacing + displacements[p];
    }
    return positions;
  }

  std::vector<glm::dvec3> GetPositions() const { return this->GetPositions(this->GetDisplacements()); }

  /// The displacement field of the lattice as it is now; false when it is not usable.
  bool GetField(ffd::BSplineField& field, std::string& error) const
  {
    bool inverse = false;
    if (!vtkFFDBSplineFieldFromTransform(this->Lattice, field, inverse, error))
    {
      return false;
    }
    if (inverse)
    {
      error = "the lattice has its InverseFlag set";
      return false;
    }
    return true;
  }

  ffd::PointSet GetLocked() const
  {
    return ffd::BoundaryPoints(this->Nodes, this->Self->LockBoundary ? this->Self->LockedLayers : 0);
  }

  bool IsShown(std::size_t point) const
  {
    if (this->Self->InteriorVisibility)
    {
      return true;
    }
    const glm::ivec3 at = this->IndicesOf(point);
    for (int a = 0; a < 3; ++a)
    {
      if (at[a] == 0 || at[a] == this->Nodes[a] - 1)
      {
        return true;
      }
    }
    return false;
  }

  void GetMirror(bool mirror[3]) const
  {
    for (int a = 0; a < 3; ++a)
    {
      mirror[a] = this->Self->Symmetry[a] != 0;
    }
  }

  //----------------------------------------------------------------------------
  // World

  glm::dmat4 GetMatrix() const
  {
    glm::dmat4 matrix(1.0);
    if (this->Prop)
    {
      const vtkMatrix4x4* from = this->Prop->GetMatrix();
      for (int r = 0; r < 4; ++r)
      {
        for (int c = 0; c < 4; ++c)
        {
          matrix[c][r] = from->GetElement(r, c);
        }
      }
    }
    return matrix;
  }

  static glm::dvec3 Transform(const glm::dmat4& matrix, const glm::dvec3& p)
  {
    const glm::dvec4 q = matrix * glm::dvec4(p, 1.0);
    return glm::dvec3(q) / q.w;
  }

  glm::dvec3 ToWorld(const glm::dvec3& p) const { return Transform(this->GetMatrix(), p); }
  glm::dvec3 ToData(const glm::dvec3& p) const { return Transform(glm::inverse(this->GetMatrix()), p); }

  vtkRenderer* GetRenderer() const { return this->Self->Renderer; }

  glm::dvec3 DisplayToData(const glm::dvec2& display, double depth) const
  {
    double world[4];
    vtkInteractorObserver::ComputeDisplayToWorld(
      this->GetRenderer(), display.x, display.y, depth, world);
    return this->ToData({ world[0], world[1], world[2] });
  }

  glm::dvec3 DataToDisplay(const glm::dvec3& p) const
  {
    const glm::dvec3 world = this->ToWorld(p);
    glm::dvec3 display;
    vtkInteractorObserver::ComputeWorldToDisplay(
      this->GetRenderer(), world.x, world.y, world.z, &display.x);
    return display;
  }

  Ray GetRay(const glm::dvec2& display) const
  {
    const glm::dvec3 first = this->DisplayToData(display, 0.0);
    const glm::dvec3 last = this->DisplayToData(display, 1.0);
    return { first, glm::normalize(last - first) };
  }

  /// How the anchor moves with the mouse, data coordinates; what it was when seen end on.
  glm::dvec3 GetMotion(int constraint) const
  {
    if (constraint == FREE)
    {
      const double depth = this->DataToDisplay(this->Anchor).z;
      return this->DisplayToData(this->DragTo, depth) - this->DisplayToData(this->DragFrom, depth);
    }
    const Ray from = this->GetRay(this->DragFrom);
    const Ray to = this->GetRay(this->DragTo);
    if (constraint <= ALONG_Z)
    {
      const glm::dvec3 axis = Unit(constraint - ALONG_X);
      double t0;
      double t1;
      return NearestOnLine(from, this->Anchor, axis, t0) && NearestOnLine(to, this->Anchor, axis, t1)
        ? (t1 - t0) * axis
        : this->Motion;
    }
    const glm::dvec3 normal = Unit(constraint - ACROSS_X);
    glm::dvec3 p0;
    glm::dvec3 p1;
    if (!OnPlane(from, this->Anchor, normal, p0) || !OnPlane(to, this->Anchor, normal, p1))
    {
      return this->Motion;
    }
    glm::dvec3 motion = p1 - p0;
    motion[constraint - ACROSS_X] = 0.0;
    return motion;
  }

  //----------------------------------------------------------------------------
  // Edits

  bool Begin(const char* name)
  {
    this->Sync();
    if (this->EditIsOpen)
    {
      vtkErrorWithObjectMacro(this->Self, << name << ": a drag is going on. End or cancel it first.");
      return false;
    }
    this->EditIsOpen = true;
    this->EditName = name;
    this->EditStart = this->GetDisplacements();
    return true;
  }

  /// Prepare to move `set`; the side of `leader` leads a symmetric edit.
  void Take(const ffd::PointSet& set, vtkIdType leader)
  {
    bool mirror[3];
    this->GetMirror(mirror);
    this->Moving = ffd::MirrorSelection(this->Nodes, set, mirror);
    this->Leader = 0;
    if (leader >= 0)
    {
      this->Leader = static_cast<std::size_t>(leader);
    }
    else
    {
      const auto first = std::find(set.begin(), set.end(), 1);
      this->Leader = first == set.end() ? 0 : static_cast<std::size_t>(first - set.begin());
    }
    this->StartPositions = this->GetPositions(this->EditStart);
    // The centre is that of the leading side: the other only mirrors it.
    const glm::ivec3 lead = this->IndicesOf(this->Leader);
    glm::dvec3 sum(0.0);
    int count = 0;
    for (std::size_t p = 0; p < this->Count(); ++p)
    {
      bool leads = this->Moving[p] != 0;
      const glm::ivec3 at = this->IndicesOf(p);
      for (int a = 0; a < 3 && leads; ++a)
      {
        const int middle = this->Nodes[a] - 1;
        const int side = 2 * at[a] - middle;
        leads = !mirror[a] || side == 0 || (side > 0) == (2 * lead[a] > middle);
      }
      if (leads)
      {
        sum += this->StartPositions[p];
        ++count;
      }
    }
    this->Center = count > 0 ? sum / static_cast<double>(count) : glm::dvec3(0.0);
    this->Weigh();
  }

  void Weigh()
  {
    this->Weights = ffd::SoftWeights(this->StartPositions, this->Moving,
      this->Self->ProportionalEditing ? this->Self->GetEffectiveRadius() : 0.0,
      static_cast<ffd::Falloff>(this->Self->Falloff));
  }

  /// Move what was taken: each point to what `move` makes of its position, as far as its weight.
  void MoveTaken(const std::function<glm::dvec3(const glm::dvec3&)>& move)
  {
    std::vector<glm::dvec3> changes(this->Count(), glm::dvec3(0.0));
    for (std::size_t p = 0; p < changes.size(); ++p)
    {
      if (this->Weights[p] > 0.0)
      {
        const glm::dvec3& at = this->StartPositions[p];
        changes[p] = this->Weights[p] * (move(at) - at);
      }
    }
    bool mirror[3];
    this->GetMirror(mirror);
    ffd::MirrorChanges(this->Nodes, changes, mirror, this->Leader);
    this->Apply(changes);
  }

  /// Displacements: those of the start of the edit plus changes, as far as the rules allow.
  void Apply(std::vector<glm::dvec3>& changes)
  {
    const ffd::PointSet locked = this->GetLocked();
    ffd::ControlNet before{ this->Nodes, this->EditStart };
    ffd::ControlNet after = before;
    for (std::size_t p = 0; p < changes.size(); ++p)
    {
      if (locked[p] || !Finite(changes[p].x, changes[p].y, changes[p].z))
      {
        changes[p] = glm::dvec3(0.0);
      }
      after.Values[p] += changes[p];
    }
    if (this->Self->FoldGuard == GUARD_CLAMP)
    {
      const std::vector<glm::dvec3> wanted = after.Values;
      const double scale = this->Lattice->GetDisplacementScale();
      for (std::size_t p = 0; p < wanted.size(); ++p)
      {
        before.Values[p] *= scale;
        after.Values[p] *= scale;
      }
      const double fraction =
        ffd::LimitFold(before, after, this->GetSpacing(), this->Self->MinimumDeterminant).Fraction;
      for (std::size_t p = 0; p < wanted.size(); ++p)
      {
        after.Values[p] = fraction < 1.0 ? this->EditStart[p] + fraction * changes[p] : wanted[p];
      }
    }
    this->SetDisplacements(after.Values);
  }

  int Commit()
  {
    if (!this->EditIsOpen)
    {
      return 0;
    }
    this->EditIsOpen = false;
    const std::vector<glm::dvec3> now = this->GetDisplacements();
    ffd::LatticeEdit edit;
    edit.Name = this->EditName;
    for (std::size_t p = 0; p < now.size(); ++p)
    {
      if (now[p] != this->EditStart[p])
      {
        edit.Nodes.push_back(p);
        edit.Before.push_back(this->EditStart[p]);
        edit.After.push_back(now[p]);
      }
    }
    if (edit.Nodes.empty())
    {
      return 0;
    }
    const std::vector<std::size_t> changed = edit.Nodes;
    this->History.Add(std::move(edit));
    this->Tell(this->EditName, changed);
    return 1;
  }

  void Rollback()
  {
    if (this->EditIsOpen)
    {
      this->EditIsOpen = false;
      this->SetDisplacements(this->EditStart);
    }
  }

  void Tell(const std::string& name, const std::vector<std::size_t>& changed)
  {
    this->LastEdit = name;
    this->Changed = changed;
    std::string copy = name; // the call data is not const
    this->Self->InvokeEvent(vtkCommand::WidgetValueChangedEvent, &copy[0]);
  }

  int Restore(const ffd::LatticeEdit* edit, bool before, const char* name)
  {
    if (!edit)
    {
      return 0;
    }
    const std::vector<std::size_t> nodes = edit->Nodes;
    std::vector<glm::dvec3> values = this->GetDisplacements();
    for (std::size_t n = 0; n < nodes.size(); ++n)
    {
      values[nodes[n]] = before ? edit->Before[n] : edit->After[n];
    }
    this->SetDisplacements(values);
    this->Tell(name, nodes);
    return 1;
  }

  //----------------------------------------------------------------------------
  // Direct manipulation

  /// The rest point of the material that is at a deformed one. False: there is none.
  bool FindMaterial(const glm::dvec3& deformed, glm::dvec3& rest, std::string& error) const
  {
    ffd::BSplineField field;
    if (!this->GetField(field, error))
    {
      return false;
    }
    int evaluations = 0;
    if (!ffd::SolveInverse(field, deformed, deformed,
          MaterialTolerance * this->GetSmallestSpacing(), rest, evaluations))
    {
      error = "no material is found there (the lattice is folded)";
      return false;
    }
    return true;
  }

  /// Move the material `rest` to `to`, from the state at the start of the edit.
  bool MoveMaterial(const glm::dvec3& rest, const glm::dvec3& to, std::string& error)
  {
    const double scale = this->Lattice->GetDisplacementScale();
    if (!(std::abs(scale) > 0.0))
    {
      error = "the DisplacementScale of the lattice is 0";
      return false;
    }
    glm::dvec3 origin;
    this->Lattice->GetRestPoint(0, 0, 0, &origin.x);
    const ffd::BSplineField field(this->Nodes, origin, this->GetSpacing(), this->EditStart.data(),
      scale, static_cast<ffd::BorderMode>(this->Lattice->GetBorderMode()));
    double domain[6];
    this->Lattice->GetDomain(domain);

    const glm::dvec3 move = to - (rest + field.Displacement(rest));
    std::vector<ffd::MaterialMove> wishes;
    for (const glm::dvec3& pin : this->Pins)
    {
      wishes.push_back({ pin, glm::dvec3(0.0) });
    }
    std::size_t grabbed = wishes.size();
    wishes.push_back({ rest, move });
    for (int a = 0; a < 3; ++a)
    {
      if (!this->Self->Symmetry[a])
      {
        continue;
      }
      // Mirrored wishes; material in the mid-plane stays in it.
      const double ends = domain[2 * a] + domain[2 * a + 1];
      const std::size_t count = wishes.size();
      std::vector<ffd::MaterialMove> images;
      for (std::size_t w = 0; w < count; ++w)
      {
        ffd::MaterialMove image = wishes[w];
        image.RestPoint[a] = ends - image.RestPoint[a];
        if (std::abs(image.RestPoint[a] - wishes[w].RestPoint[a]) < 1e-6 * this->GetSmallestSpacing())
        {
          wishes[w].Move[a] = 0.0;
        }
        else
        {
          image.Move[a] = -image.Move[a];
          images.push_back(image);
        }
      }
      // Pins go first.
      for (const ffd::MaterialMove& image : images)
      {
        if (image.Move == glm::dvec3(0.0))
        {
          wishes.insert(wishes.begin(), image);
          ++grabbed;
        }
        else
        {
          wishes.push_back(image);
        }
      }
    }
    const ffd::DirectManipulation solution = ffd::MoveMaterial(field, this->GetLocked(), wishes);
    const double missed = glm::length(solution.Achieved[grabbed] - wishes[grabbed].Move);
    if (!(missed <= 1e-9 * glm::length(wishes[grabbed].Move)))
    {
      error = "pins, locked control points or the end of the lattice hold the material there";
      return false;
    }
    std::vector<glm::dvec3> changes(this->Count(), glm::dvec3(0.0));
    for (std::size_t n = 0; n < solution.Nodes.size(); ++n)
    {
      changes[solution.Nodes[n]] = solution.Changes[n] / scale;
    }
    this->Apply(changes);
    return true;
  }

  /// The first opaque geometry of the scene but ours, from the depth buffer.
  bool PickDepth(const glm::dvec2& display, glm::dvec3& world) const
  {
    vtkRenderer* renderer = this->GetRenderer();
    vtkRenderWindow* window = renderer->GetRenderWindow();
    if (!window)
    {
      return false;
    }
    // Drawn again without us, and not shown: nothing flickers.
    const vtkTypeBool visible = this->Self->GetVisibility();
    const vtkTypeBool swap = window->GetSwapBuffers();
    this->Self->SetVisibility(0);
    window->SetSwapBuffers(0);
    window->Render();
    const double depth = renderer->GetZ(static_cast<int>(display.x), static_cast<int>(display.y));
    window->SetSwapBuffers(swap);
    this->Self->SetVisibility(visible);
    if (!(depth > 0.0 && depth < 1.0))
    {
      return false;
    }
    double point[4];
    vtkInteractorObserver::ComputeDisplayToWorld(renderer, display.x, display.y, depth, point);
    world = { point[0], point[1], point[2] };
    return true;
  }

  //----------------------------------------------------------------------------
  // What is at a position of the window

  bool HasView() const
  {
    return this->GetRenderer() && this->GetRenderer()->GetRenderWindow();
  }

  vtkIdType FindPoint(const glm::dvec2& display, double* pixels = nullptr) const
  {
    if (!this->HasView() || !this->Self->PointVisibility)
    {
      return -1;
    }
    const vtkFFDProjection projection(this->GetRenderer());
    const glm::dmat4 matrix = this->GetMatrix();
    const std::vector<glm::dvec3> positions = this->GetPositions();
    struct Candidate
    {
      double Distance;
      double Depth;
      vtkIdType Point;
    };
    std::vector<Candidate> candidates;
    double nearest = this->Self->PickTolerance;
    for (std::size_t p = 0; p < positions.size(); ++p)
    {
      glm::dvec3 at;
      if (this->IsShown(p) && projection.ToDisplay(Transform(matrix, positions[p]), at))
      {
        const double distance = glm::length(glm::dvec2(at) - display);
        if (distance <= this->Self->PickTolerance)
        {
          candidates.push_back({ distance, at.z, static_cast<vtkIdType>(p) });
          nearest = std::min(nearest, distance);
        }
      }
    }
    const Candidate* best = nullptr;
    for (const Candidate& candidate : candidates)
    {
      if (candidate.Distance <= nearest + Covering && (!best || candidate.Depth < best->Depth))
      {
        best = &candidate;
      }
    }
    if (best && pixels)
    {
      *pixels = best->Distance;
    }
    return best ? best->Point : -1;
  }

  /// What is nearer to a position: a control point or a part of the handle; -1 both: nothing.
  void FindNearest(const glm::dvec2& display, vtkIdType& point, int& part) const
  {
    double toPoint = std::numeric_limits<double>::infinity();
    double toPart = std::numeric_limits<double>::infinity();
    point = this->FindPoint(display, &toPoint);
    part = this->FindPart(display, &toPart);
    // The handle is on top, but it must not keep a selected point from being moved again.
    const bool onBall = point >= 0 && this->Selected[static_cast<std::size_t>(point)] != 0 &&
      part != MiddlePart && toPoint <= 0.5 * this->Self->HandleSize;
    if (onBall || toPoint + 1.0 < toPart)
    {
      part = -1;
    }
    else
    {
      point = -1;
    }
  }

  ShapeKey FindShapeKey() const
  {
    ShapeKey key;
    key.Lattice = this->Lattice;
    key.LatticeTime = this->Lattice->GetMTime();
    key.Matrix = this->GetMatrix();
    this->Self->GetOutlineBounds(key.OutlineBounds.data());
    key.LineMode = this->Self->LineMode;
    key.Interior = this->Self->InteriorVisibility;
    return key;
  }

  int FindPart(const glm::dvec2& display, double* pixels) const
  {
    if (!this->HasView())
    {
      return -1;
    }
    const vtkFFDProjection projection(this->GetRenderer());
    int found = -1;
    double nearest = this->Self->PickTolerance;
    for (const HandlePart& part : this->HandleParts)
    {
      glm::dvec3 before(0.0);
      for (std::size_t n = 0; n < part.Path.size(); ++n)
      {
        glm::dvec3 at;
        if (!projection.ToDisplay(part.Path[n], at))
        {
          break;
        }
        const double distance = n == 0
          ? glm::length(glm::dvec2(at) - display)
          : DistanceToSegment(display, glm::dvec2(before), glm::dvec2(at));
        if (distance < nearest)
        {
          nearest = distance;
          found = part.Id;
        }
        before = at;
      }
    }
    *pixels = found >= 0 ? nearest : *pixels;
    return found;
  }

  //----------------------------------------------------------------------------
  // Drawing

  bool HandleIsShown() const
  {
    const int mode = this->Self->HandleMode;
    if (mode == HANDLE_OFF || this->Self->ManipulationMode != CONTROL_POINTS ||
      !this->Self->PointVisibility || this->Self->InteractionState == SelectingRegion)
    {
      return false;
    }
    const vtkIdType count = this->Self->GetNumberOfSelectedPoints();
    return count > 1 ||
      (count == 1 && (mode == HANDLE_TRANSLATE || this->Self->ProportionalEditing));
  }

  void BuildLines();
  void BuildGlyphs();
  void BuildHandle(const vtkFFDProjection& projection);
  void BuildLook();
};

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::BuildLines()
{
  const glm::dmat4 matrix = this->GetMatrix();
  vtkFFDLatticeScene::Lines lines;
  const std::vector<glm::dvec3> positions = this->GetPositions();
  const bool curved = this->Self->LineMode == CURVED;
  const int longest = std::max({ this->Nodes.x, this->Nodes.y, this->Nodes.z });
  const int parts = longest > 12 ? 4 : 8;
  ffd::BSplineField field;
  std::string error;
  bool inverse = false;
  // An unusable lattice (NaN) has reported itself; it is the identity then.
  vtkFFDBSplineFieldFromTransform(this->Lattice, field, inverse, error);
  const bool usable = field.GetNodes() == this->Nodes;
  glm::dvec3 origin;
  this->Lattice->GetRestPoint(0, 0, 0, &origin.x);
  const glm::dvec3 spacing = this->GetSpacing();
  std::vector<glm::dvec3> row;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    glm::ivec3 at;
    for (at[c] = 0; at[c] < this->Nodes[c]; ++at[c])
    {
      for (at[b] = 0; at[b] < this->Nodes[b]; ++at[b])
      {
        const bool outer = at[b] == 0 || at[c] == 0 || at[b] == this->Nodes[b] - 1 ||
          at[c] == this->Nodes[c] - 1;
        if (!outer && !this->Self->InteriorVisibility)
        {
          continue;
        }
        if (!curved || !usable)
        {
          for (at[axis] = 0; at[axis] < this->Nodes[axis]; ++at[axis])
          {
            const auto point = static_cast<std::size_t>(this->IndexOf(at.x, at.y, at.z));
            lines.Points.push_back(Transform(matrix, positions[point]));
          }
        }
        else
        {
          // The weights across the row are those of a knot, so they are taken together first.
          constexpr double knot[3] = { 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0 };
          row.assign(static_cast<std::size_t>(this->Nodes[axis]) + 2, glm::dvec3(0.0));
          for (int i = -1; i <= this->Nodes[axis]; ++i)
          {
            glm::ivec3 from;
            from[axis] = i;
            for (int v = 0; v < 3; ++v)
            {
              from[c] = at[c] + v - 1;
              for (int u = 0; u < 3; ++u)
              {
                from[b] = at[b] + u - 1;
                row[static_cast<std::size_t>(i + 1)] +=
                  knot[u] * knot[v] * field.Coefficient(from.x, from.y, from.z);
              }
            }
          }
          for (int s = 0; s <= parts * (this->Nodes[axis] - 1); ++s)
          {
            const int cell = std::min(s / parts, this->Nodes[axis] - 2);
            const double u = static_cast<double>(s - parts * cell) / parts;
            double w[4];
            ffd::BSplineWeights(u, w);
            at[axis] = 0;
            glm::dvec3 p = origin + glm::dvec3(at) * spacing;
            p[axis] += (cell + u) * spacing[axis];
            for (int i = 0; i < 4; ++i)
            {
              p += w[i] * row[static_cast<std::size_t>(cell + i)];
            }
            lines.Points.push_back(Transform(matrix, p));
          }
        }
        lines.Ends.push_back(lines.Points.size());
      }
    }
  }
  this->Scene.SetLines(lines);

  vtkFFDLatticeScene::Lines outline;
  double bounds[6];
  this->Self->GetOutlineBounds(bounds);
  this->Lattice->Update();
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int corner = 0; corner < 4; ++corner)
    {
      for (int s = 0; s <= OutlineSegments; ++s)
      {
        const double t = static_cast<double>(s) / OutlineSegments;
        glm::dvec3 p;
        p[axis] = glm::mix(bounds[2 * axis], bounds[2 * axis + 1], t);
        const int b = (axis + 1) % 3;
        const int c = (axis + 2) % 3;
        p[b] = bounds[2 * b + (corner & 1)];
        p[c] = bounds[2 * c + (corner >> 1)];
        glm::dvec3 q;
        this->Lattice->InternalTransformPoint(&p.x, &q.x);
        outline.Points.push_back(Transform(matrix, q));
      }
      outline.Ends.push_back(outline.Points.size());
    }
  }
  this->Scene.SetOutline(outline);

  double* box = this->Self->Bounds;
  vtkMath::UninitializeBounds(box);
  const auto include = [box](const glm::dvec3& p) {
    for (int a = 0; a < 3; ++a)
    {
      box[2 * a] = box[2 * a] > box[2 * a + 1] ? p[a] : std::min(box[2 * a], p[a]);
      box[2 * a + 1] = std::max(box[2 * a + 1], p[a]);
    }
  };
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  const auto widen = [&](const glm::dvec3& p) {
    if (Finite(p.x, p.y, p.z))
    {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  };
  for (const glm::dvec3& p : positions)
  {
    widen(Transform(matrix, p));
  }
  for (const glm::dvec3& p : outline.Points)
  {
    widen(p);
  }
  for (const glm::dvec3& p : lines.Points)
  {
    widen(p);
  }
  if (low.x <= high.x)
  {
    include(low);
    include(high);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::BuildGlyphs()
{
  const glm::dmat4 matrix = this->GetMatrix();
  const std::vector<glm::dvec3> positions = this->GetPositions();
  const ffd::PointSet locked = this->GetLocked();
  const double size = this->Self->HandleSize;
  const vtkFFDLatticeScene::Colour plain = ToBytes(this->PointLook->GetColor());
  const vtkFFDLatticeScene::Colour selected = ToBytes(this->SelectedLook->GetColor());
  const vtkFFDLatticeScene::Colour hovered = ToBytes(this->HoveredLook->GetColor());
  const vtkFFDLatticeScene::Colour fixed = ToBytes(this->LockedLook->GetColor());
  std::vector<vtkFFDLatticeScene::Glyph> glyphs;
  std::vector<vtkFFDLatticeScene::Label> labels;
  glyphs.reserve(positions.size());
  for (std::size_t p = 0; p < positions.size(); ++p)
  {
    if (!this->IsShown(p) || !Finite(positions[p].x, positions[p].y, positions[p].z))
    {
      continue;
    }
    const bool isHovered = static_cast<vtkIdType>(p) == this->Hovered;
    const bool isSelected = this->Selected[p] != 0;
    const glm::dvec3 world = Transform(matrix, positions[p]);
    glyphs.push_back({ world, isHovered ? 1.4 * size : isSelected ? 1.15 * size : size,
      isHovered        ? hovered
        : isSelected   ? selected
        : locked[p]    ? fixed
                       : plain });
    if (this->Self->LabelVisibility && (isSelected || isHovered))
    {
      const glm::ivec3 at = this->IndicesOf(p);
      std::ostringstream text;
      text << at.x << ", " << at.y << ", " << at.z;
      labels.push_back({ world, text.str() });
    }
  }
  for (int pin = 0; pin < this->Self->GetNumberOfPins(); ++pin)
  {
    glm::dvec3 p;
    this->Self->GetPin(pin, &p.x);
    glyphs.push_back(
      { Transform(matrix, p), 1.2 * size, ToBytes(this->PinLook->GetColor()) });
  }
  this->Scene.SetGlyphs(glyphs);
  this->Scene.SetLabels(labels);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::BuildHandle(const vtkFFDProjection& projection)
{
  using Shape = vtkFFDLatticeScene::Shape;
  static const vtkFFDLatticeScene::Colour axisColours[3] = { { 235, 70, 70 }, { 90, 205, 80 },
    { 80, 130, 255 } };
  static const vtkFFDLatticeScene::Colour middleColour = { 235, 235, 235 };
  const vtkFFDLatticeScene::Colour hot = ToBytes(this->HoveredLook->GetColor());
  const int lit = this->Self->InteractionState == MovingHandle ? this->Part : this->HoveredPart;
  const auto colourOf = [&](int part) {
    return part == lit ? hot : part == MiddlePart ? middleColour : axisColours[part];
  };
  std::vector<Shape> shapes;
  this->HandleParts.clear();
  const glm::dmat4 matrix = this->GetMatrix();
  const glm::dmat3 linear(matrix);
  glm::dvec3 right;
  glm::dvec3 up;
  glm::dvec3 toward;
  vtkCamera* camera = this->GetRenderer()->GetActiveCamera();
  camera->GetViewUp(&up.x);
  camera->GetDirectionOfProjection(&toward.x);
  toward = -toward;
  right = glm::normalize(glm::cross(up, toward));
  up = glm::cross(toward, right);

  glm::dvec3 center;
  const bool any = this->Self->GetSelectionCenter(&center.x) != 0;
  const glm::dvec3 middle = Transform(matrix, center);
  glm::dvec3 eye;
  camera->GetPosition(&eye.x);
  const glm::dvec3 sight = camera->GetParallelProjection() ? toward : glm::normalize(eye - middle);
  const double pixel = projection.GetPixelSize(middle);
  const double length = this->Self->TransformHandleSize * pixel;
  const int mode = this->Self->HandleMode;
  if (this->HandleIsShown() && length > 0.0)
  {
    const bool single = this->Self->GetNumberOfSelectedPoints() == 1;
    for (int a = 0; a < 3; ++a)
    {
      const glm::dvec3 axis = glm::normalize(linear * Unit(a));
      const bool faded = mode != HANDLE_ROTATE && std::abs(glm::dot(axis, sight)) > FadedArm &&
        !(this->Self->InteractionState == MovingHandle && this->Part == a);
      const glm::dvec3 u = glm::normalize(glm::cross(axis, Unit(std::abs(axis.x) < 0.6 ? 0 : 1)));
      const glm::dvec3 v = glm::cross(axis, u);
      Shape shape;
      shape.Rgb = colourOf(a);
      shape.Alpha = faded ? FadedAlpha : 255;
      if (mode == HANDLE_ROTATE)
      {
        for (int s = 0; s <= RingSegments; ++s)
        {
          const double angle = 2.0 * vtkMath::Pi() * s / RingSegments;
          shape.Line.push_back(middle + length * (std::cos(angle) * u + std::sin(angle) * v));
        }
      }
      else
      {
        // An arm, and a tip: a cone to move, a cube to scale.
        shape.Line = { middle + 0.18 * length * axis, middle + length * axis };
        const glm::dvec3 tip = middle + length * axis;
        const double half = (mode == HANDLE_SCALE ? 0.05 : 0.06) * length;
        if (mode == HANDLE_SCALE)
        {
          const glm::dvec3 e[3] = { half * axis, half * u, half * v };
          for (int f = 0; f < 6; ++f)
          {
            const double sign = f % 2 == 0 ? 1.0 : -1.0;
            const glm::dvec3 n = sign * e[f / 2];
            const glm::dvec3 p = e[(f / 2 + 1) % 3];
            const glm::dvec3 q = e[(f / 2 + 2) % 3];
            for (const glm::dvec3& corner :
              { n + p + q, n - p + q, n - p - q, n + p + q, n - p - q, n + p - q })
            {
              shape.Triangles.push_back(tip + corner);
            }
          }
        }
        else
        {
          constexpr int sides = 12;
          for (int s = 0; s < sides; ++s)
          {
            const double a0 = 2.0 * vtkMath::Pi() * s / sides;
            const double a1 = 2.0 * vtkMath::Pi() * (s + 1) / sides;
            const glm::dvec3 p0 = tip + half * (std::cos(a0) * u + std::sin(a0) * v);
            const glm::dvec3 p1 = tip + half * (std::cos(a1) * u + std::sin(a1) * v);
            for (const glm::dvec3& p : { p0, p1, tip + 3.5 * half * axis, p1, p0, tip })
            {
              shape.Triangles.push_back(p);
            }
          }
        }
      }
      if (!faded)
      {
        this->HandleParts.push_back({ a, shape.Line });
      }
      shapes.push_back(shape);
    }
    if (!single || mode != HANDLE_TRANSLATE)
    {
      Shape shape;
      shape.Rgb = colourOf(MiddlePart);
      const double radius = (mode == HANDLE_ROTATE ? 1.2 : 0.12) * length;
      const int sides = mode == HANDLE_ROTATE ? RingSegments : 4;
      for (int s = 0; s <= sides; ++s)
      {
        const double angle = 2.0 * vtkMath::Pi() * (s + 0.5) / sides;
        shape.Line.push_back(middle + radius * (std::cos(angle) * right + std::sin(angle) * up));
      }
      std::vector<glm::dvec3> path = shape.Line;
      if (mode != HANDLE_ROTATE)
      {
        path.push_back(middle);
      }
      this->HandleParts.push_back({ MiddlePart, path });
      shapes.push_back(shape);
    }
  }

  // Guides: the axes of the constraint, and how far proportional editing reaches.
  const bool moving = this->Self->InteractionState == MovingPoints ||
    this->Self->InteractionState == MovingMaterial ||
    (this->Self->InteractionState == MovingHandle && mode == HANDLE_TRANSLATE);
  const glm::dvec3 hold = moving ? this->Anchor : center;
  int constraint = this->Self->Constraint;
  if (this->Self->InteractionState == MovingHandle && this->Part != MiddlePart)
  {
    constraint = ALONG_X + this->Part;
  }
  if (constraint != FREE && (any || moving))
  {
    double domain[6];
    this->Lattice->GetDomain(domain);
    const double reach = glm::length(glm::dvec3(
      domain[1] - domain[0], domain[3] - domain[2], domain[5] - domain[4]));
    for (int a = 0; a < 3; ++a)
    {
      const bool drawn = constraint <= ALONG_Z ? a == constraint - ALONG_X
                                               : a != constraint - ACROSS_X;
      if (drawn)
      {
        Shape shape;
        shape.Rgb = axisColours[a];
        shape.Line = { Transform(matrix, hold - reach * Unit(a)),
          Transform(matrix, hold + reach * Unit(a)) };
        shapes.push_back(shape);
      }
    }
  }
  if (this->Self->ProportionalEditing && any && this->Self->ManipulationMode == CONTROL_POINTS)
  {
    const double radius =
      this->Self->GetEffectiveRadius() * std::cbrt(std::abs(glm::determinant(linear)));
    Shape shape;
    shape.Rgb = middleColour;
    for (int s = 0; s <= RingSegments; ++s)
    {
      const double angle = 2.0 * vtkMath::Pi() * s / RingSegments;
      shape.Line.push_back(middle + radius * (std::cos(angle) * right + std::sin(angle) * up));
    }
    shapes.push_back(shape);
  }
  this->Scene.SetHandle(shapes);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::vtkInternals::BuildLook()
{
  const vtkFFDLatticeRepresentation* self = this->Self;
  vtkFFDLatticeScene::Look look;
  look.Points = this->PointLook;
  look.Lines = this->LineLook;
  look.Outline = this->OutlineLook;
  look.Handle = this->HandleLook;
  look.Warning =
    self->FoldGuard == GUARD_WARN && this->Self->IsFolded() ? this->WarningLook.Get() : nullptr;
  look.HiddenOpacity = self->HiddenOpacity;
  look.ShowPoints = self->PointVisibility != 0;
  look.ShowLines = self->LineVisibility != 0;
  look.ShowOutline = self->OutlineVisibility != 0;
  look.ShowHandle = true;
  look.ShowRubberBand = self->InteractionState == SelectingRegion;
  look.ShowLabels = self->LabelVisibility != 0;
  this->Scene.SetLook(look);
}

//------------------------------------------------------------------------------
vtkFFDLatticeRepresentation::vtkFFDLatticeRepresentation()
  : Internals(new vtkInternals(this))
{
  this->InteractionState = Outside;
  this->HandleSize = 9.0;
  this->PlaceFactor = 1.0;
  vtkMath::UninitializeBounds(this->Bounds);
  vtkInternals& in = *this->Internals;
  in.PointLook->SetColor(0.85, 0.87, 0.9);
  in.PointLook->SetAmbient(0.35);
  in.PointLook->SetDiffuse(0.65);
  in.SelectedLook->SetColor(1.0, 0.6, 0.1);
  in.HoveredLook->SetColor(1.0, 0.95, 0.3);
  in.LockedLook->SetColor(0.45, 0.47, 0.5);
  in.PinLook->SetColor(0.95, 0.25, 0.6);
  in.LineLook->SetColor(0.55, 0.65, 0.75);
  in.LineLook->LightingOff();
  in.OutlineLook->SetColor(0.95, 0.95, 0.95);
  in.OutlineLook->SetLineWidth(2.0f);
  in.OutlineLook->LightingOff();
  in.WarningLook->SetColor(1.0, 0.15, 0.1);
  in.HandleLook->SetLineWidth(3.0f);
  in.HandleLook->LightingOff();
  in.Picker->SetOwner(this, [this](double x, double y, double world[3]) {
    vtkInternals& internals = *this->Internals;
    this->BuildRepresentation();
    glm::dvec3 at;
    vtkIdType point;
    int part;
    internals.FindNearest({ x, y }, point, part);
    if (part >= 0)
    {
      this->GetSelectionCenter(&at.x);
    }
    else if (point >= 0)
    {
      at = internals.GetPositions()[static_cast<std::size_t>(point)];
    }
    else
    {
      return false;
    }
    at = internals.ToWorld(at);
    std::copy_n(&at.x, 3, world);
    return true;
  });
  in.Sync();
}

//------------------------------------------------------------------------------
vtkFFDLatticeRepresentation::~vtkFFDLatticeRepresentation() = default;

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const vtkInternals& in = *this->Internals;
  const auto line = [&os, &indent](const char* name) -> ostream& { return os << indent << name << ": "; };
  line("Lattice") << in.Lattice.Get() << "\n";
  line("Prop") << in.Prop.Get() << "\n";
  line("SurfacePicker") << in.SurfacePicker.Get() << "\n";
  double b[6];
  this->GetOutlineBounds(b);
  line("OutlineBounds") << b[0] << ", " << b[1] << ", " << b[2] << ", " << b[3] << ", " << b[4]
                        << ", " << b[5] << "\n";
  line("NumberOfSelectedPoints") << this->GetNumberOfSelectedPoints() << "\n";
  line("ActivePoint") << in.Active << "\n";
  line("HoveredPoint") << in.Hovered << "\n";
  line("NumberOfPins") << in.Pins.size() << "\n";
  line("NumberOfUndos") << in.History.GetNumberOfUndos() << "\n";
  line("NumberOfRedos") << in.History.GetNumberOfRedos() << "\n";
  line("UndoMemoryLimit") << in.History.GetMemoryLimit() << "\n";
  line("UndoMemorySize") << in.History.GetMemorySize() << "\n";
  line("LastEdit") << in.LastEdit << "\n";
  line("Constraint") << this->Constraint << "\n";
  line("ProportionalEditing") << this->ProportionalEditing << "\n";
  line("ProportionalRadius") << this->ProportionalRadius << "\n";
  line("Falloff") << this->Falloff << "\n";
  line("Symmetry") << this->Symmetry[0] << ", " << this->Symmetry[1] << ", " << this->Symmetry[2]
                   << "\n";
  line("LockBoundary") << this->LockBoundary << "\n";
  line("LockedLayers") << this->LockedLayers << "\n";
  line("FoldGuard") << this->FoldGuard << "\n";
  line("MinimumDeterminant") << this->MinimumDeterminant << "\n";
  line("NudgeStep") << this->NudgeStep << "\n";
  line("ManipulationMode") << this->ManipulationMode << "\n";
  line("HandleMode") << this->HandleMode << "\n";
  line("LineMode") << this->LineMode << "\n";
  line("PointVisibility") << this->PointVisibility << "\n";
  line("InteriorVisibility") << this->InteriorVisibility << "\n";
  line("LineVisibility") << this->LineVisibility << "\n";
  line("OutlineVisibility") << this->OutlineVisibility << "\n";
  line("LabelVisibility") << this->LabelVisibility << "\n";
  line("HiddenOpacity") << this->HiddenOpacity << "\n";
  line("CullHidden") << this->CullHidden << "\n";
  line("TransformHandleSize") << this->TransformHandleSize << "\n";
  line("PickTolerance") << this->PickTolerance << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetLattice(vtkFFDLattice* lattice)
{
  if (!lattice)
  {
    vtkErrorMacro("SetLattice: the lattice is null. Give a vtkFFDLattice.");
    return;
  }
  vtkInternals& in = *this->Internals;
  if (in.Lattice != lattice)
  {
    this->CancelInteraction();
    in.Lattice = lattice;
    in.Nodes = glm::ivec3(0); // nothing of the old one holds for the new one
    in.Pins.clear();
    in.Sync();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDLatticeRepresentation::GetLattice()
{
  return this->Internals->Lattice;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetProp(vtkProp3D* prop)
{
  if (this->Internals->Prop != prop)
  {
    this->Internals->Prop = prop;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkProp3D* vtkFFDLatticeRepresentation::GetProp()
{
  return this->Internals->Prop;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetOutlineBounds(const double bounds[6])
{
  if (!bounds)
  {
    vtkErrorMacro("SetOutlineBounds: the bounds are null. Give (xmin, xmax, ymin, ...).");
    return;
  }
  for (int a = 0; a < 3; ++a)
  {
    if (!(bounds[2 * a] <= bounds[2 * a + 1]) ||
      !Finite(bounds[2 * a], bounds[2 * a + 1], 0.0))
    {
      vtkErrorMacro("SetOutlineBounds: bounds of axis "
        << a << " are " << bounds[2 * a] << " to " << bounds[2 * a + 1]
        << "; they must be finite, the lower one first.");
      return;
    }
  }
  vtkInternals& in = *this->Internals;
  if (!in.HasOutlineBounds || !std::equal(bounds, bounds + 6, in.OutlineBounds))
  {
    std::copy_n(bounds, 6, in.OutlineBounds);
    in.HasOutlineBounds = true;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GetOutlineBounds(double bounds[6])
{
  if (!this->Internals->IsGiven(
        bounds, "GetOutlineBounds", "there is no place for the six bounds. Give one"))
  {
    return;
  }
  const vtkInternals& in = *this->Internals;
  if (in.HasOutlineBounds)
  {
    std::copy_n(in.OutlineBounds, 6, bounds);
  }
  else
  {
    in.Lattice->GetDomain(bounds);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::PlaceWidget(double bounds[6])
{
  bool usable = bounds != nullptr;
  bool extent = false;
  for (int a = 0; a < 3 && usable; ++a)
  {
    usable = bounds[2 * a] <= bounds[2 * a + 1] && Finite(bounds[2 * a], bounds[2 * a + 1], 0.0);
    extent = extent || bounds[2 * a] < bounds[2 * a + 1];
  }
  if (!usable || !extent)
  {
    vtkErrorMacro("PlaceWidget: the bounds must be finite, each lower one first, and not all flat. "
                  "Give those of the image, for instance vtkImageData::GetBounds().");
    return;
  }
  double placed[6];
  double center[3];
  this->AdjustBounds(bounds, placed, center);
  this->Internals->Lattice->FitToBounds(placed);
  this->SetOutlineBounds(bounds);
  std::copy_n(placed, 6, this->InitialBounds);
  this->InitialLength = std::sqrt((placed[1] - placed[0]) * (placed[1] - placed[0]) +
    (placed[3] - placed[2]) * (placed[3] - placed[2]) +
    (placed[5] - placed[4]) * (placed[5] - placed[4]));
  this->Placed = 1;
  this->ValidPick = 1;
  this->BuildRepresentation();
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDLatticeRepresentation::GetMTime()
{
  const vtkInternals& in = *this->Internals;
  vtkMTimeType time = std::max(this->Superclass::GetMTime(), in.Lattice->GetMTime());
  if (in.Prop)
  {
    time = std::max(time, in.Prop->GetMTime());
  }
  for (vtkProperty* property :
    { in.PointLook.Get(), in.SelectedLook.Get(), in.HoveredLook.Get(), in.LockedLook.Get(),
      in.PinLook.Get(), in.LineLook.Get(), in.OutlineLook.Get(), in.WarningLook.Get(),
      in.HandleLook.Get() })
  {
    time = std::max(time, property->GetMTime());
  }
  return time;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::BuildRepresentation()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  const vtkInternals::ShapeKey shape = in.FindShapeKey();
  const vtkMTimeType lookTime = this->GetMTime();
  const bool lines = !(in.BuiltShape == shape);
  if (lines)
  {
    in.BuildLines();
    in.BuiltShape = shape;
  }
  if (lines || in.LookTime != lookTime)
  {
    in.BuildGlyphs();
    in.BuildLook();
    in.LookTime = lookTime;
    in.HasViewGeometry = false;
    this->BuildTime.Modified();
  }
  if (!in.HasView())
  {
    // Sizes follow as soon as there is a view.
    in.HasViewGeometry = false;
    return;
  }
  const vtkFFDProjection projection(this->Renderer);
  if (!in.HasViewGeometry || !(in.BuiltView == projection))
  {
    in.Scene.ScaleGlyphs(projection);
    in.Scene.SimplifyLines(projection);
    in.BuildHandle(projection);
    if (this->InteractionState == SelectingRegion)
    {
      in.Scene.SetRubberBand(in.DragFrom - projection.Origin, in.DragTo - projection.Origin);
    }
    in.BuiltView = projection;
    in.HasViewGeometry = true;
  }
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SelectPoint(int i, int j, int k, int operation)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  const vtkIdType point = in.IndexOf(i, j, k);
  if (point < 0)
  {
    vtkErrorMacro("SelectPoint: there is no control point ("
      << i << ", " << j << ", " << k << "); the lattice has " << in.Nodes.x << " x " << in.Nodes.y
      << " x " << in.Nodes.z << ".");
    return 0;
  }
  return this->SelectPoint(point, operation);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SelectPoint(vtkIdType point, int operation)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!in.IsInside(point))
  {
    vtkErrorMacro("SelectPoint: there is no control point " << point << "; the lattice has "
                                                            << in.Count() << ".");
    return 0;
  }
  if (operation < REPLACE || operation > TOGGLE)
  {
    vtkErrorMacro("SelectPoint: " << operation << " is none of REPLACE, ADD and TOGGLE.");
    return 0;
  }
  const auto at = static_cast<std::size_t>(point);
  if (operation == REPLACE)
  {
    std::fill(in.Selected.begin(), in.Selected.end(), 0);
  }
  in.Selected[at] = operation == TOGGLE && in.Selected[at] ? 0 : 1;
  in.Active = in.Selected[at] ? point : -1;
  this->Modified();
  this->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::IsPointSelected(int i, int j, int k)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  return this->IsPointSelected(in.IndexOf(i, j, k));
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::IsPointSelected(vtkIdType point)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  return in.IsInside(point) ? in.Selected[static_cast<std::size_t>(point)] : 0;
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLatticeRepresentation::GetActivePoint()
{
  this->Internals->Sync();
  return this->Internals->Active;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SetSelectedPoints(vtkIdTypeArray* points)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!points)
  {
    vtkErrorMacro("SetSelectedPoints: the array is null.");
    return 0;
  }
  ffd::PointSet selected(in.Count(), 0);
  for (vtkIdType p = 0; p < points->GetNumberOfValues(); ++p)
  {
    if (!in.IsInside(points->GetValue(p)))
    {
      vtkErrorMacro("SetSelectedPoints: there is no control point "
        << points->GetValue(p) << "; the lattice has " << in.Count() << ".");
      return 0;
    }
    selected[static_cast<std::size_t>(points->GetValue(p))] = 1;
  }
  in.Selected = selected;
  in.Active = points->GetNumberOfValues() > 0
    ? points->GetValue(points->GetNumberOfValues() - 1)
    : -1;
  this->Modified();
  this->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
  return 1;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GetSelectedPoints(vtkIdTypeArray* points)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!points)
  {
    vtkErrorMacro("GetSelectedPoints: the array is null.");
    return;
  }
  points->SetNumberOfComponents(1);
  points->SetNumberOfTuples(0);
  for (std::size_t p = 0; p < in.Count(); ++p)
  {
    if (in.Selected[p])
    {
      points->InsertNextValue(static_cast<vtkIdType>(p));
    }
  }
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLatticeRepresentation::GetNumberOfSelectedPoints()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  return std::count(in.Selected.begin(), in.Selected.end(), 1);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SelectAll()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  std::fill(in.Selected.begin(), in.Selected.end(), 1);
  this->Modified();
  this->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ClearSelection()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  std::fill(in.Selected.begin(), in.Selected.end(), 0);
  in.Active = -1;
  this->Modified();
  this->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::InvertSelection()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  for (unsigned char& selected : in.Selected)
  {
    selected = selected ? 0 : 1;
  }
  in.Active = -1;
  this->Modified();
  this->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GrowSelection()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  in.Selected = ffd::GrowSelection(in.Nodes, in.Selected);
  this->Modified();
  this->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ShrinkSelection()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  in.Selected = ffd::ShrinkSelection(in.Nodes, in.Selected);
  if (in.IsInside(in.Active) && !in.Selected[static_cast<std::size_t>(in.Active)])
  {
    in.Active = -1;
  }
  this->Modified();
  this->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SelectRows(int axis)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (axis < 0 || axis > 2)
  {
    vtkErrorMacro("SelectRows: axis " << axis << " is none of 0, 1 and 2.");
    return 0;
  }
  in.Selected = ffd::SelectRows(in.Nodes, in.Selected, axis);
  this->Modified();
  this->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SelectPlanes(int axis)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (axis < 0 || axis > 2)
  {
    vtkErrorMacro("SelectPlanes: axis " << axis << " is none of 0, 1 and 2.");
    return 0;
  }
  in.Selected = ffd::SelectPlanes(in.Nodes, in.Selected, axis);
  this->Modified();
  this->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SelectRegion(
  double x0, double y0, double x1, double y1, int operation)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!in.HasView())
  {
    vtkErrorMacro("SelectRegion: there is no renderer in a window. Enable the widget, or call "
                  "SetRenderer().");
    return 0;
  }
  if (operation < REPLACE || operation > TOGGLE)
  {
    vtkErrorMacro("SelectRegion: " << operation << " is none of REPLACE, ADD and TOGGLE.");
    return 0;
  }
  const vtkFFDProjection projection(this->Renderer);
  const glm::dmat4 matrix = in.GetMatrix();
  const std::vector<glm::dvec3> positions = in.GetPositions();
  if (operation == REPLACE)
  {
    std::fill(in.Selected.begin(), in.Selected.end(), 0);
  }
  int found = 0;
  for (std::size_t p = 0; p < positions.size(); ++p)
  {
    glm::dvec3 at;
    if (in.IsShown(p) && projection.ToDisplay(vtkInternals::Transform(matrix, positions[p]), at) &&
      at.x >= std::min(x0, x1) && at.x <= std::max(x0, x1) && at.y >= std::min(y0, y1) &&
      at.y <= std::max(y0, y1))
    {
      in.Selected[p] = operation == TOGGLE && in.Selected[p] ? 0 : 1;
      ++found;
    }
  }
  if (!in.IsInside(in.Active) || !in.Selected[static_cast<std::size_t>(in.Active)])
  {
    in.Active = -1;
  }
  this->Modified();
  this->InvokeEvent(vtkCommand::SelectionChangedEvent, nullptr);
  return found;
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLatticeRepresentation::FindPoint(double x, double y)
{
  this->Internals->Sync();
  return this->Internals->FindPoint({ x, y });
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDLatticeRepresentation::GetHoveredPoint()
{
  this->Internals->Sync();
  return this->Internals->Hovered;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::GetSelectionCenter(double center[3])
{
  if (!this->Internals->IsGiven(center, "GetSelectionCenter",
        "there is no place for the center. Give one for three coordinates"))
  {
    return 0;
  }
  vtkInternals& in = *this->Internals;
  in.Sync();
  const std::vector<glm::dvec3> positions = in.GetPositions();
  glm::dvec3 sum(0.0);
  int count = 0;
  for (std::size_t p = 0; p < positions.size(); ++p)
  {
    if (in.Selected[p])
    {
      sum += positions[p];
      ++count;
    }
  }
  if (count == 0)
  {
    double domain[6];
    in.Lattice->GetDomain(domain);
    for (int a = 0; a < 3; ++a)
    {
      center[a] = 0.5 * (domain[2 * a] + domain[2 * a + 1]);
    }
    return 0;
  }
  sum /= static_cast<double>(count);
  std::copy_n(&sum.x, 3, center);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::TranslateSelection(double dx, double dy, double dz)
{
  vtkInternals& in = *this->Internals;
  if (!Finite(dx, dy, dz))
  {
    vtkErrorMacro("TranslateSelection: (" << dx << ", " << dy << ", " << dz << ") is not finite.");
    return 0;
  }
  if (!in.Begin("Translate"))
  {
    return 0;
  }
  in.Take(in.Selected, in.Active);
  const glm::dvec3 move(dx, dy, dz);
  in.MoveTaken([&move](const glm::dvec3& p) { return p + move; });
  return in.Commit();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::RotateSelection(
  double degrees, double axisX, double axisY, double axisZ)
{
  vtkInternals& in = *this->Internals;
  const glm::dvec3 axis(axisX, axisY, axisZ);
  if (!Finite(axisX, axisY, axisZ) || !std::isfinite(degrees) || !(glm::length(axis) > 0.0))
  {
    vtkErrorMacro("RotateSelection: " << degrees << " degrees about (" << axisX << ", " << axisY
                                      << ", " << axisZ
                                      << ") is no rotation: all must be finite, the axis not zero.");
    return 0;
  }
  if (!in.Begin("Rotate"))
  {
    return 0;
  }
  in.Take(in.Selected, in.Active);
  const double angle = vtkMath::RadiansFromDegrees(degrees);
  const glm::dvec3 unit = glm::normalize(axis);
  in.MoveTaken([&](const glm::dvec3& p) { return in.Center + Turn(p - in.Center, unit, angle); });
  return in.Commit();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::ScaleSelection(double sx, double sy, double sz)
{
  vtkInternals& in = *this->Internals;
  if (!Finite(sx, sy, sz))
  {
    vtkErrorMacro("ScaleSelection: (" << sx << ", " << sy << ", " << sz << ") is not finite.");
    return 0;
  }
  if (!in.Begin("Scale"))
  {
    return 0;
  }
  in.Take(in.Selected, in.Active);
  const glm::dvec3 factor(sx, sy, sz);
  in.MoveTaken([&](const glm::dvec3& p) { return in.Center + factor * (p - in.Center); });
  return in.Commit();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::SetControlPoint(int i, int j, int k, double x, double y, double z)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  const vtkIdType point = in.IndexOf(i, j, k);
  if (point < 0 || !Finite(x, y, z))
  {
    vtkErrorMacro("SetControlPoint: control point (" << i << ", " << j << ", " << k << ") of "
                                                     << in.Nodes.x << " x " << in.Nodes.y << " x "
                                                     << in.Nodes.z << " to (" << x << ", " << y
                                                     << ", " << z
                                                     << "): the indices must be in the lattice and "
                                                        "the position finite.");
    return 0;
  }
  if (!in.Begin("Set"))
  {
    return 0;
  }
  ffd::PointSet set(in.Count(), 0);
  set[static_cast<std::size_t>(point)] = 1;
  in.Take(set, point);
  const glm::dvec3 move =
    glm::dvec3(x, y, z) - in.StartPositions[static_cast<std::size_t>(point)];
  in.MoveTaken([&move](const glm::dvec3& p) { return p + move; });
  return in.Commit();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::NudgeSelection(double right, double up)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!Finite(right, up, 0.0))
  {
    vtkErrorMacro("NudgeSelection: (" << right << ", " << up << ") is not finite.");
    return 0;
  }
  if (!in.HasView())
  {
    vtkErrorMacro("NudgeSelection: there is no renderer in a window. Enable the widget, or call "
                  "SetRenderer(); TranslateSelection() needs none.");
    return 0;
  }
  const double step = this->NudgeStep > 0.0 ? this->NudgeStep : 0.05 * in.GetSmallestSpacing();
  glm::dvec3 move;
  if (this->Constraint >= ALONG_X && this->Constraint <= ALONG_Z)
  {
    move = (right + up) * step * Unit(this->Constraint - ALONG_X);
  }
  else
  {
    glm::dvec3 viewUp;
    glm::dvec3 forward;
    this->Renderer->GetActiveCamera()->GetViewUp(&viewUp.x);
    this->Renderer->GetActiveCamera()->GetDirectionOfProjection(&forward.x);
    const glm::dvec3 viewRight = glm::normalize(glm::cross(forward, viewUp));
    viewUp = glm::cross(viewRight, forward);
    const glm::dmat3 toData = glm::inverse(glm::dmat3(in.GetMatrix()));
    const auto along = [&](const glm::dvec3& world) {
      glm::dvec3 data = toData * world;
      if (this->Constraint >= ACROSS_X)
      {
        data[this->Constraint - ACROSS_X] = 0.0;
      }
      const double length = glm::length(data);
      return length > 0.0 ? data / length : data;
    };
    move = step * (right * along(viewRight) + up * along(viewUp));
  }
  if (!in.Begin("Nudge"))
  {
    return 0;
  }
  in.Take(in.Selected, in.Active);
  in.MoveTaken([&move](const glm::dvec3& p) { return p + move; });
  return in.Commit();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::ResetPoint(int i, int j, int k)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  const vtkIdType point = in.IndexOf(i, j, k);
  if (point < 0)
  {
    vtkErrorMacro("ResetPoint: there is no control point ("
      << i << ", " << j << ", " << k << "); the lattice has " << in.Nodes.x << " x " << in.Nodes.y
      << " x " << in.Nodes.z << ".");
    return 0;
  }
  if (!in.Begin("Reset"))
  {
    return 0;
  }
  ffd::PointSet set(in.Count(), 0);
  set[static_cast<std::size_t>(point)] = 1;
  bool mirror[3];
  in.GetMirror(mirror);
  set = ffd::MirrorSelection(in.Nodes, set, mirror);
  std::vector<glm::dvec3> changes(in.Count(), glm::dvec3(0.0));
  for (std::size_t p = 0; p < in.Count(); ++p)
  {
    changes[p] = set[p] ? -in.EditStart[p] : glm::dvec3(0.0);
  }
  in.Apply(changes);
  return in.Commit();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::ResetSelection()
{
  vtkInternals& in = *this->Internals;
  if (!in.Begin("Reset"))
  {
    return 0;
  }
  bool mirror[3];
  in.GetMirror(mirror);
  const ffd::PointSet set = ffd::MirrorSelection(in.Nodes, in.Selected, mirror);
  std::vector<glm::dvec3> changes(in.Count(), glm::dvec3(0.0));
  for (std::size_t p = 0; p < in.Count(); ++p)
  {
    changes[p] = set[p] ? -in.EditStart[p] : glm::dvec3(0.0);
  }
  in.Apply(changes);
  return in.Commit();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::ResetAll()
{
  vtkInternals& in = *this->Internals;
  if (!in.Begin("Reset"))
  {
    return 0;
  }
  std::vector<glm::dvec3> changes(in.Count());
  for (std::size_t p = 0; p < in.Count(); ++p)
  {
    changes[p] = -in.EditStart[p];
  }
  in.Apply(changes);
  return in.Commit();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::MoveMaterial(const double from[3], const double to[3])
{
  vtkInternals& in = *this->Internals;
  if (!from || !to || !Finite(from[0], from[1], from[2]) || !Finite(to[0], to[1], to[2]))
  {
    vtkErrorMacro("MoveMaterial: both positions must be finite.");
    return 0;
  }
  in.Sync();
  glm::dvec3 rest;
  std::string error;
  if (!in.FindMaterial({ from[0], from[1], from[2] }, rest, error))
  {
    vtkErrorMacro("MoveMaterial: the material at (" << from[0] << ", " << from[1] << ", " << from[2]
                                                    << ") cannot be moved: " << error << ".");
    return 0;
  }
  if (!in.Begin("Material"))
  {
    return 0;
  }
  if (!in.MoveMaterial(rest, { to[0], to[1], to[2] }, error))
  {
    in.Rollback();
    vtkErrorMacro("MoveMaterial: the material at (" << from[0] << ", " << from[1] << ", " << from[2]
                                                    << ") cannot be moved: " << error << ".");
    return 0;
  }
  return in.Commit();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::MoveMaterial(
  double x0, double y0, double z0, double x1, double y1, double z1)
{
  const double from[3] = { x0, y0, z0 };
  const double to[3] = { x1, y1, z1 };
  return this->MoveMaterial(from, to);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::AddPin(double x, double y, double z)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  glm::dvec3 rest;
  std::string error = "the position is not finite";
  if (!Finite(x, y, z) || !in.FindMaterial({ x, y, z }, rest, error))
  {
    vtkErrorMacro("AddPin: no pin at (" << x << ", " << y << ", " << z << "): " << error << ".");
    return 0;
  }
  in.Pins.push_back(rest);
  this->Modified();
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::AddPinAtWorld(const double world[3])
{
  if (!this->Internals->IsGiven(
        world, "AddPinAtWorld", "the position is null. Give three world coordinates"))
  {
    return 0;
  }
  const glm::dvec3 p = this->Internals->ToData({ world[0], world[1], world[2] });
  return this->AddPin(p.x, p.y, p.z);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::GetNumberOfPins()
{
  return static_cast<int>(this->Internals->Pins.size());
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GetPin(int pin, double position[3])
{
  if (!this->Internals->IsGiven(
        position, "GetPin", "there is no place for the position. Give one for three coordinates"))
  {
    return;
  }
  vtkInternals& in = *this->Internals;
  if (pin < 0 || pin >= this->GetNumberOfPins())
  {
    vtkErrorMacro("GetPin: there is no pin " << pin << " of " << this->GetNumberOfPins() << ".");
    std::fill_n(position, 3, 0.0);
    return;
  }
  in.Lattice->Update();
  in.Lattice->InternalTransformPoint(&in.Pins[static_cast<std::size_t>(pin)].x, position);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ClearPins()
{
  if (!this->Internals->Pins.empty())
  {
    this->Internals->Pins.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetSurfacePicker(vtkAbstractPicker* picker)
{
  if (this->Internals->SurfacePicker != picker)
  {
    this->Internals->SurfacePicker = picker;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkAbstractPicker* vtkFFDLatticeRepresentation::GetSurfacePicker()
{
  return this->Internals->SurfacePicker;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetSurfacePoint(double x, double y, double z)
{
  if (!Finite(x, y, z))
  {
    vtkErrorMacro("SetSurfacePoint: (" << x << ", " << y << ", " << z << ") is not finite.");
    return;
  }
  this->Internals->SurfacePoint = { x, y, z };
  this->Internals->SurfacePointIsGiven = true;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::PickSurface(double x, double y, double world[3])
{
  if (!this->Internals->IsGiven(world, "PickSurface",
        "there is no place for the position. Give one for three world coordinates"))
  {
    return 0;
  }
  vtkInternals& in = *this->Internals;
  if (!in.HasView())
  {
    vtkErrorMacro("PickSurface: there is no renderer in a window. Enable the widget, or call "
                  "SetRenderer().");
    return 0;
  }
  in.SurfacePointIsGiven = false;
  double display[2] = { x, y };
  this->InvokeEvent(vtkCommand::StartPickEvent, display);
  if (in.SurfacePointIsGiven)
  {
    std::copy_n(&in.SurfacePoint.x, 3, world);
    return 1;
  }
  if (in.SurfacePicker)
  {
    if (!in.SurfacePicker->Pick(x, y, 0.0, this->Renderer))
    {
      return 0;
    }
    in.SurfacePicker->GetPickPosition(world);
    return Finite(world[0], world[1], world[2]) ? 1 : 0;
  }
  glm::dvec3 point;
  if (!in.PickDepth({ x, y }, point))
  {
    return 0;
  }
  std::copy_n(&point.x, 3, world);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::Undo()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  return in.EditIsOpen ? 0 : in.Restore(in.History.Undo(), true, "Undo");
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::Redo()
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  return in.EditIsOpen ? 0 : in.Restore(in.History.Redo(), false, "Redo");
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::GetNumberOfUndos()
{
  this->Internals->Sync();
  return static_cast<int>(this->Internals->History.GetNumberOfUndos());
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::GetNumberOfRedos()
{
  this->Internals->Sync();
  return static_cast<int>(this->Internals->History.GetNumberOfRedos());
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ClearHistory()
{
  this->Internals->History.Clear();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetUndoMemoryLimit(vtkTypeInt64 bytes)
{
  if (bytes < 0)
  {
    vtkErrorMacro("SetUndoMemoryLimit: " << bytes << " bytes; it must not be negative.");
    return;
  }
  this->Internals->History.SetMemoryLimit(static_cast<std::size_t>(bytes));
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkFFDLatticeRepresentation::GetUndoMemoryLimit()
{
  return static_cast<vtkTypeInt64>(this->Internals->History.GetMemoryLimit());
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkFFDLatticeRepresentation::GetUndoMemorySize()
{
  return static_cast<vtkTypeInt64>(this->Internals->History.GetMemorySize());
}

//------------------------------------------------------------------------------
const char* vtkFFDLatticeRepresentation::GetLastEdit()
{
  return this->Internals->LastEdit.c_str();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GetChangedPoints(vtkIdTypeArray* points)
{
  if (!points)
  {
    vtkErrorMacro("GetChangedPoints: the array is null.");
    return;
  }
  points->SetNumberOfComponents(1);
  points->SetNumberOfTuples(0);
  for (std::size_t point : this->Internals->Changed)
  {
    points->InsertNextValue(static_cast<vtkIdType>(point));
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetConstraint(int constraint)
{
  if (constraint < FREE || constraint > ACROSS_Z)
  {
    vtkErrorMacro("SetConstraint: " << constraint << " is none of FREE (0) to ACROSS_Z (6).");
    return;
  }
  if (this->Constraint != constraint)
  {
    this->Constraint = constraint;
    this->Modified();
    if (this->IsInteracting())
    {
      double at[2] = { this->Internals->DragTo.x, this->Internals->DragTo.y };
      this->WidgetInteraction(at);
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetProportionalEditing(vtkTypeBool on)
{
  if (this->ProportionalEditing != on)
  {
    this->ProportionalEditing = on;
    this->Modified();
    if (this->IsInteracting())
    {
      this->Internals->Weigh();
      double at[2] = { this->Internals->DragTo.x, this->Internals->DragTo.y };
      this->WidgetInteraction(at);
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetProportionalRadius(double radius)
{
  if (!std::isfinite(radius) || radius < 0.0)
  {
    vtkErrorMacro("SetProportionalRadius: " << radius << " is no radius; it must be finite and not "
                                               "negative (0: two spacings).");
    return;
  }
  if (this->ProportionalRadius != radius)
  {
    this->ProportionalRadius = radius;
    this->Modified();
    if (this->IsInteracting())
    {
      this->Internals->Weigh();
      double at[2] = { this->Internals->DragTo.x, this->Internals->DragTo.y };
      this->WidgetInteraction(at);
    }
  }
}

//------------------------------------------------------------------------------
double vtkFFDLatticeRepresentation::GetEffectiveRadius()
{
  if (this->ProportionalRadius > 0.0)
  {
    return this->ProportionalRadius;
  }
  const glm::dvec3 spacing = this->Internals->GetSpacing();
  return 2.0 * std::max({ spacing.x, spacing.y, spacing.z });
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetSymmetry(vtkTypeBool x, vtkTypeBool y, vtkTypeBool z)
{
  const vtkTypeBool symmetry[3] = { x, y, z };
  this->SetSymmetry(symmetry);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetSymmetry(const vtkTypeBool symmetry[3])
{
  if (this->Internals->IsGiven(symmetry, "SetSymmetry", "the flags are null. Give one per axis") &&
    !std::equal(symmetry, symmetry + 3, this->Symmetry))
  {
    std::copy_n(symmetry, 3, this->Symmetry);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetFalloff(int falloff)
{
  if (falloff < SMOOTH || falloff > CONSTANT)
  {
    vtkErrorMacro("SetFalloff: " << falloff << " is none of SMOOTH (0) to CONSTANT (4).");
    return;
  }
  if (this->Falloff != falloff)
  {
    this->Falloff = falloff;
    this->Modified();
    if (this->IsInteracting())
    {
      this->Internals->Weigh();
      double at[2] = { this->Internals->DragTo.x, this->Internals->DragTo.y };
      this->WidgetInteraction(at);
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetMinimumDeterminant(double determinant)
{
  if (!(determinant >= 0.0 && determinant < 1.0))
  {
    vtkErrorMacro("SetMinimumDeterminant: " << determinant << " is not from 0 to below 1.");
    return;
  }
  if (this->MinimumDeterminant != determinant)
  {
    this->MinimumDeterminant = determinant;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::IsFolded()
{
  return this->Internals->Lattice->GetMinimumJacobianBound() < this->MinimumDeterminant ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetNudgeStep(double step)
{
  if (!std::isfinite(step) || step < 0.0)
  {
    vtkErrorMacro("SetNudgeStep: " << step
                                   << " is no step; it must be finite and not negative (0: a "
                                      "twentieth of the smallest spacing).");
    return;
  }
  if (this->NudgeStep != step)
  {
    this->NudgeStep = step;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetHiddenOpacity(double opacity)
{
  this->Internals->SetClamped("SetHiddenOpacity", this->HiddenOpacity, opacity, 0.0, 1.0);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetHandleSize(double size)
{
  this->Internals->SetClamped("SetHandleSize", this->HandleSize, size, 0.001, 1000.0);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetPlaceFactor(double factor)
{
  this->Internals->SetClamped("SetPlaceFactor", this->PlaceFactor, factor, 0.01, VTK_DOUBLE_MAX);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetTransformHandleSize(double size)
{
  this->Internals->SetClamped(
    "SetTransformHandleSize", this->TransformHandleSize, size, 10.0, 1000.0);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::SetPickTolerance(double tolerance)
{
  this->Internals->SetClamped("SetPickTolerance", this->PickTolerance, tolerance, 1.0, 100.0);
}

//------------------------------------------------------------------------------
vtkProperty* vtkFFDLatticeRepresentation::GetPointProperty() { return this->Internals->PointLook; }
vtkProperty* vtkFFDLatticeRepresentation::GetSelectedPointProperty()
{
  return this->Internals->SelectedLook;
}
vtkProperty* vtkFFDLatticeRepresentation::GetHoveredPointProperty()
{
  return this->Internals->HoveredLook;
}
vtkProperty* vtkFFDLatticeRepresentation::GetLockedPointProperty()
{
  return this->Internals->LockedLook;
}
vtkProperty* vtkFFDLatticeRepresentation::GetPinProperty() { return this->Internals->PinLook; }
vtkProperty* vtkFFDLatticeRepresentation::GetLineProperty() { return this->Internals->LineLook; }
vtkProperty* vtkFFDLatticeRepresentation::GetOutlineProperty()
{
  return this->Internals->OutlineLook;
}
vtkProperty* vtkFFDLatticeRepresentation::GetWarningProperty()
{
  return this->Internals->WarningLook;
}
vtkProperty* vtkFFDLatticeRepresentation::GetHandleProperty()
{
  return this->Internals->HandleLook;
}
vtkProperty2D* vtkFFDLatticeRepresentation::GetRubberBandProperty()
{
  return this->Internals->Scene.GetRubberBandProperty();
}
vtkTextProperty* vtkFFDLatticeRepresentation::GetLabelTextProperty()
{
  return this->Internals->Scene.GetLabelTextProperty();
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::ComputeInteractionState(int x, int y, int)
{
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (this->IsInteracting())
  {
    return this->InteractionState;
  }
  vtkIdType point = -1;
  int part = -1;
  if (this->ManipulationMode == CONTROL_POINTS && in.HasView())
  {
    this->BuildRepresentation();
    // Through the picking manager, which may say that another widget is in front.
    if (this->GetAssemblyPath(x, y, 0.0, in.Picker))
    {
      in.FindNearest(glm::dvec2(x, y), point, part);
    }
  }
  if (point != in.Hovered || part != in.HoveredPart)
  {
    in.Hovered = point;
    in.HoveredPart = part;
    this->Modified();
  }
  this->InteractionState = part >= 0 ? OnHandle : point >= 0 ? OnPoint : Outside;
  return this->InteractionState;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::StartWidgetInteraction(double position[2])
{
  if (!this->Internals->IsGiven(
        position, "StartWidgetInteraction", "the position is null. Give two display coordinates"))
  {
    return;
  }
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (this->IsInteracting())
  {
    this->CancelInteraction();
  }
  if (!in.HasView())
  {
    vtkErrorMacro("StartWidgetInteraction: there is no renderer in a window. Enable the widget, or "
                  "call SetRenderer().");
    return;
  }
  this->StartEventPosition[0] = position[0];
  this->StartEventPosition[1] = position[1];
  this->StartEventPosition[2] = 0.0;
  in.DragFrom = { position[0], position[1] };
  in.DragTo = in.DragFrom;
  in.Motion = glm::dvec3(0.0);
  in.Angle = 0.0;
  if (this->ManipulationMode == VOLUME)
  {
    this->InteractionState = Outside;
    glm::dvec3 world;
    std::string error;
    if (!this->PickSurface(position[0], position[1], &world.x))
    {
      return;
    }
    in.Anchor = in.ToData(world);
    if (!in.FindMaterial(in.Anchor, in.Material, error))
    {
      vtkWarningMacro("The volume cannot be taken hold of: " << error << ".");
      return;
    }
    if (in.Begin("Material"))
    {
      in.Take(ffd::PointSet(in.Count(), 0), -1);
      this->InteractionState = MovingMaterial;
      in.Ended = false;
    }
  }
  else if (in.HoveredPart >= 0)
  {
    static const char* const names[] = { "", "Translate", "Rotate", "Scale" };
    if (in.Begin(names[this->HandleMode]))
    {
      in.Take(in.Selected, in.Active);
      this->GetSelectionCenter(&in.Anchor.x);
      in.Part = in.HoveredPart;
      this->InteractionState = MovingHandle;
      in.Ended = false;
    }
  }
  else if (in.IsInside(in.Hovered))
  {
    if (in.Begin("Translate"))
    {
      ffd::PointSet set = in.Selected;
      set[static_cast<std::size_t>(in.Hovered)] = 1;
      in.Take(set, in.Hovered);
      in.Anchor = in.StartPositions[static_cast<std::size_t>(in.Hovered)];
      this->InteractionState = MovingPoints;
      in.Ended = false;
    }
  }
  else
  {
    this->InteractionState = Outside;
  }
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::StartRegion(const double position[2], int operation)
{
  if (!this->Internals->IsGiven(
        position, "StartRegion", "the position is null. Give two display coordinates"))
  {
    return;
  }
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (operation < REPLACE || operation > TOGGLE)
  {
    vtkErrorMacro("StartRegion: " << operation << " is none of REPLACE, ADD and TOGGLE.");
    return;
  }
  this->CancelInteraction();
  in.DragFrom = { position[0], position[1] };
  in.DragTo = in.DragFrom;
  in.RegionOperation = operation;
  in.Ended = false;
  this->InteractionState = SelectingRegion;
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::WidgetInteraction(double position[2])
{
  if (!this->Internals->IsGiven(
        position, "WidgetInteraction", "the position is null. Give two display coordinates"))
  {
    return;
  }
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!this->IsInteracting() || !Finite(position[0], position[1], 0.0))
  {
    return;
  }
  const glm::dvec2 before = in.DragTo;
  in.DragTo = { position[0], position[1] };
  this->Modified();
  if (this->InteractionState == SelectingRegion)
  {
    return;
  }
  if (this->InteractionState == MovingPoints)
  {
    in.Motion = in.GetMotion(this->Constraint);
    in.MoveTaken([&in](const glm::dvec3& p) { return p + in.Motion; });
  }
  else if (this->InteractionState == MovingMaterial)
  {
    in.Motion = in.GetMotion(this->Constraint);
    std::string error;
    // What holds the material shows by itself: it does not move.
    in.MoveMaterial(in.Material, in.Anchor + in.Motion, error);
  }
  else if (this->HandleMode == HANDLE_TRANSLATE)
  {
    in.Motion = in.GetMotion(in.Part == MiddlePart ? this->Constraint : ALONG_X + in.Part);
    in.MoveTaken([&in](const glm::dvec3& p) { return p + in.Motion; });
  }
  else if (this->HandleMode == HANDLE_ROTATE)
  {
    const glm::dvec3 forward = in.GetRay(glm::dvec2(in.DataToDisplay(in.Anchor))).Direction;
    const glm::dvec3 axis = in.Part == MiddlePart ? -forward : Unit(in.Part);
    glm::dvec3 p0;
    glm::dvec3 p1;
    if (std::abs(glm::dot(axis, forward)) > 0.2 &&
      OnPlane(in.GetRay(before), in.Anchor, axis, p0) &&
      OnPlane(in.GetRay(in.DragTo), in.Anchor, axis, p1))
    {
      // Turn by turn, so that more than half a turn counts.
      p0 -= in.Anchor;
      p1 -= in.Anchor;
      in.Angle += std::atan2(glm::dot(glm::cross(p0, p1), axis), glm::dot(p0, p1));
    }
    else
    {
      // The ring is seen edge on: its front moves across the line of sight.
      const glm::dvec3 front = glm::normalize(glm::cross(axis, -forward));
      const double length = in.GetSmallestSpacing();
      const glm::dvec2 tangent(in.DataToDisplay(in.Anchor + length * front) -
        in.DataToDisplay(in.Anchor));
      const double size = glm::length(tangent);
      if (size > 0.0)
      {
        in.Angle += glm::dot(in.DragTo - before, tangent) / size / this->TransformHandleSize;
      }
    }
    in.MoveTaken(
      [&](const glm::dvec3& p) { return in.Center + Turn(p - in.Center, axis, in.Angle); });
  }
  else
  {
    glm::dvec3 factor(1.0);
    if (in.Part == MiddlePart)
    {
      const glm::dvec2 drag = in.DragTo - in.DragFrom;
      factor = glm::dvec3(std::exp((drag.x + drag.y) / (1.5 * this->TransformHandleSize)));
    }
    else
    {
      double t0;
      double t1;
      const glm::dvec3 axis = Unit(in.Part);
      if (NearestOnLine(in.GetRay(in.DragFrom), in.Anchor, axis, t0) &&
        NearestOnLine(in.GetRay(in.DragTo), in.Anchor, axis, t1) && std::abs(t0) > 0.0)
      {
        // Never to nothing, which could not be scaled up again.
        factor[in.Part] = std::max(0.01, t1 / t0);
      }
    }
    in.MoveTaken([&](const glm::dvec3& p) { return in.Center + factor * (p - in.Center); });
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::EndWidgetInteraction(double position[2])
{
  if (!this->Internals->IsGiven(
        position, "EndWidgetInteraction", "the position is null. Give two display coordinates"))
  {
    return;
  }
  vtkInternals& in = *this->Internals;
  in.Sync();
  if (!this->IsInteracting())
  {
    return;
  }
  this->WidgetInteraction(position);
  const int state = this->InteractionState;
  in.Ended = true;
  this->InteractionState = Outside;
  this->Modified();
  if (state == SelectingRegion)
  {
    this->SelectRegion(in.DragFrom.x, in.DragFrom.y, in.DragTo.x, in.DragTo.y, in.RegionOperation);
  }
  else
  {
    in.Commit();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::CancelInteraction()
{
  vtkInternals& in = *this->Internals;
  if (this->IsInteracting())
  {
    in.Ended = true;
    this->InteractionState = Outside;
    in.Rollback();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::IsInteracting()
{
  return this->Internals->Ended ? 0 : 1;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::Highlight(int on)
{
  vtkInternals& in = *this->Internals;
  if (!on && (in.Hovered >= 0 || in.HoveredPart >= 0))
  {
    in.Hovered = -1;
    in.HoveredPart = -1;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
double* vtkFFDLatticeRepresentation::GetBounds()
{
  this->BuildRepresentation();
  return this->Bounds;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::GetActors(vtkPropCollection* actors)
{
  if (!this->Internals->IsGiven(
        actors, "GetActors", "the collection is null. Give a vtkPropCollection"))
  {
    return;
  }
  this->Internals->Scene.GetActors(actors);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Internals->Scene.ReleaseGraphicsResources(window);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::RenderOpaqueGeometry(vtkViewport* viewport)
{
  if (!this->Internals->IsGiven(
        viewport, "RenderOpaqueGeometry", "the viewport is null. Give the renderer that draws"))
  {
    return 0;
  }
  this->BuildRepresentation();
  return this->Internals->Scene.RenderOpaqueGeometry(viewport);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::RenderTranslucentPolygonalGeometry(vtkViewport* viewport)
{
  if (!this->Internals->IsGiven(viewport, "RenderTranslucentPolygonalGeometry",
        "the viewport is null. Give the renderer that draws"))
  {
    return 0;
  }
  return this->Internals->Scene.RenderTranslucentPolygonalGeometry(
    viewport, this->GetPropertyKeys());
}

//------------------------------------------------------------------------------
int vtkFFDLatticeRepresentation::RenderOverlay(vtkViewport* viewport)
{
  if (!this->Internals->IsGiven(
        viewport, "RenderOverlay", "the viewport is null. Give the renderer that draws"))
  {
    return 0;
  }
  vtkRenderer* renderer = vtkRenderer::SafeDownCast(viewport);
  vtkFFDPixelBox part;
  if (renderer && this->CullHidden)
  {
    part = vtkFFDFindHiding(renderer, this);
  }
  else
  {
    int size[2];
    viewport->GetTiledSizeAndOrigin(&size[0], &size[1], &part.Low.x, &part.Low.y);
    part.High = part.Low + glm::ivec2(size[0], size[1]);
  }
  return this->Internals->Scene.RenderOverlay(viewport, part);
}

//------------------------------------------------------------------------------
vtkTypeBool vtkFFDLatticeRepresentation::HasTranslucentPolygonalGeometry()
{
  this->BuildRepresentation();
  return this->Internals->Scene.HasTranslucentPolygonalGeometry() ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::RegisterPickers()
{
  vtkPickingManager* manager = this->GetPickingManager();
  if (manager)
  {
    manager->AddPicker(this->Internals->Picker, this);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::BuildPaths(vtkAssemblyPaths* paths, vtkAssemblyPath* path)
{
  if (this->Internals->IsGiven(paths, "BuildPaths", "the paths are null. Give vtkAssemblyPaths") &&
    this->Internals->IsGiven(path, "BuildPaths", "the path is null. Give a vtkAssemblyPath"))
  {
    this->Superclass::BuildPaths(paths, path);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeRepresentation::ShallowCopy(vtkProp* prop)
{
  if (!this->Internals->IsGiven(
        prop, "ShallowCopy", "the prop to copy is null. Give a vtkFFDLatticeRepresentation"))
  {
    return;
  }
  auto* other = vtkFFDLatticeRepresentation::SafeDownCast(prop);
  if (other && other != this)
  {
    other->Internals->Sync();
    const vtkInternals& from = *other->Internals;
    vtkInternals& in = *this->Internals;
    this->CancelInteraction();
    this->SetLattice(from.Lattice);
    in.Sync();
    this->SetProp(from.Prop);
    this->SetSurfacePicker(from.SurfacePicker);
    in.HasOutlineBounds = from.HasOutlineBounds;
    std::copy_n(from.OutlineBounds, from.HasOutlineBounds ? 6 : 0, in.OutlineBounds);
    in.Selected = from.Selected;
    in.Active = from.Active;
    in.Pins = from.Pins;
    this->Constraint = other->Constraint;
    this->ProportionalEditing = other->ProportionalEditing;
    this->ProportionalRadius = other->ProportionalRadius;
    this->Falloff = other->Falloff;
    std::copy_n(other->Symmetry, 3, this->Symmetry);
    this->LockBoundary = other->LockBoundary;
    this->LockedLayers = other->LockedLayers;
    this->FoldGuard = other->FoldGuard;
    this->MinimumDeterminant = other->MinimumDeterminant;
    this->NudgeStep = other->NudgeStep;
    this->ManipulationMode = other->ManipulationMode;
    this->HandleMode = other->HandleMode;
    this->LineMode = other->LineMode;
    this->PointVisibility = other->PointVisibility;
    this->InteriorVisibility = other->InteriorVisibility;
    this->LineVisibility = other->LineVisibility;
    this->OutlineVisibility = other->OutlineVisibility;
    this->LabelVisibility = other->LabelVisibility;
    this->HiddenOpacity = other->HiddenOpacity;
    this->CullHidden = other->CullHidden;
    this->TransformHandleSize = other->TransformHandleSize;
    this->PickTolerance = other->PickTolerance;
    this->HandleSize = other->HandleSize;
    this->PlaceFactor = other->PlaceFactor;
    in.PointLook->DeepCopy(from.PointLook);
    in.SelectedLook->DeepCopy(from.SelectedLook);
    in.HoveredLook->DeepCopy(from.HoveredLook);
    in.LockedLook->DeepCopy(from.LockedLook);
    in.PinLook->DeepCopy(from.PinLook);
    in.LineLook->DeepCopy(from.LineLook);
    in.OutlineLook->DeepCopy(from.OutlineLook);
    in.WarningLook->DeepCopy(from.WarningLook);
    in.HandleLook->DeepCopy(from.HandleLook);
    this->GetRubberBandProperty()->DeepCopy(other->GetRubberBandProperty());
    this->GetLabelTextProperty()->ShallowCopy(other->GetLabelTextProperty());
    this->Modified();
  }
  this->Superclass::ShallowCopy(prop);
}
