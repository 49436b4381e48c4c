// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDLatticeEditor.h"

#include "FFDDirectManipulation.h"
#include "FFDFoldGuard.h"
#include "FFDPullBack.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace ffd
{
namespace
{

/// Part of the smallest spacing to which a point of the volume is taken back to rest.
constexpr double MaterialTolerance = 1e-7;

/// Part of the smallest spacing within which material lies in a mid-plane.
constexpr double MidPlaneTolerance = 1e-6;

/// Part of a move by which what was achieved may differ from it.
constexpr double MoveTolerance = 1e-9;

/// False for what is not a number, too.
bool IsWithin(const glm::dvec3& v, double largest)
{
  return std::abs(v.x) <= largest && std::abs(v.y) <= largest && std::abs(v.z) <= largest;
}

} // namespace

//------------------------------------------------------------------------------
void LatticeEditor::Clear()
{
  this->Selected.assign(this->GetNumberOfPoints(), 0);
  this->Active = None;
  this->History.Clear();
  this->Changed.clear();
  this->EditIsOpen = false;
}

//------------------------------------------------------------------------------
bool LatticeEditor::SetLattice(Lattice lattice)
{
  const bool differs = lattice.Net.Nodes != this->Edited.Net.Nodes;
  this->Edited = std::move(lattice);
  if (differs)
  {
    this->Clear();
  }
  for (std::size_t p = 0; this->EditIsOpen && p < this->Moved.size(); ++p)
  {
    if (!this->Moved[p])
    {
      this->StartDisplacements[p] = this->Edited.Net.Values[p];
    }
  }
  return differs;
}

//------------------------------------------------------------------------------
void LatticeEditor::StartWith(Lattice lattice)
{
  this->Edited = std::move(lattice);
  this->Clear();
  this->Pins.clear();
}

//------------------------------------------------------------------------------
std::ptrdiff_t LatticeEditor::FindPoint(const glm::ivec3& at) const
{
  return this->Edited.HasPoint(at) ? static_cast<std::ptrdiff_t>(this->Edited.IndexOf(at)) : None;
}

//------------------------------------------------------------------------------
double LatticeEditor::GetSmallestSpacing() const
{
  const glm::dvec3& spacing = this->Edited.Spacing;
  return std::min({ spacing.x, spacing.y, spacing.z });
}

//------------------------------------------------------------------------------
double LatticeEditor::GetEffectiveRadius() const
{
  const glm::dvec3& spacing = this->Edited.Spacing;
  return this->Options.Radius > 0.0 ? this->Options.Radius
                                    : 2.0 * std::max({ spacing.x, spacing.y, spacing.z });
}

//------------------------------------------------------------------------------
PointSet LatticeEditor::GetLocked() const
{
  return BoundaryPoints(this->Edited.Net.Nodes, this->Options.LockedLayers);
}

//------------------------------------------------------------------------------
bool LatticeEditor::IsSelected(std::ptrdiff_t point) const
{
  return this->IsPoint(point) && this->Selected[static_cast<std::size_t>(point)] != 0;
}

//------------------------------------------------------------------------------
std::size_t LatticeEditor::GetNumberOfSelected() const
{
  return static_cast<std::size_t>(std::count(this->Selected.begin(), this->Selected.end(), 1));
}

//------------------------------------------------------------------------------
void LatticeEditor::Select(std::size_t point, SelectionOperation operation)
{
  PointSet points(this->GetNumberOfPoints(), 0);
  points[point] = 1;
  this->Select(points, operation);
  this->Active = this->Selected[point] ? static_cast<std::ptrdiff_t>(point) : None;
}

//------------------------------------------------------------------------------
void LatticeEditor::Select(const PointSet& points, SelectionOperation operation)
{
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    const bool before = operation != SelectionOperation::Replace && this->Selected[p];
    const bool toggles = operation == SelectionOperation::Toggle && points[p];
    this->Selected[p] = toggles ? !before : before || points[p];
  }
  this->Active = this->IsSelected(this->Active) ? this->Active : None;
}

//------------------------------------------------------------------------------
void LatticeEditor::SetSelected(const PointSet& points, std::ptrdiff_t active)
{
  this->Selected = points;
  this->Active = active;
}

//------------------------------------------------------------------------------
void LatticeEditor::SelectAll() { std::fill(this->Selected.begin(), this->Selected.end(), 1); }

//------------------------------------------------------------------------------
void LatticeEditor::ClearSelection()
{
  std::fill(this->Selected.begin(), this->Selected.end(), 0);
  this->Active = None;
}

//------------------------------------------------------------------------------
void LatticeEditor::InvertSelection()
{
  for (unsigned char& selected : this->Selected)
  {
    selected = selected ? 0 : 1;
  }
  this->Active = None;
}

//------------------------------------------------------------------------------
void LatticeEditor::GrowSelection()
{
  this->Selected = ffd::GrowSelection(this->Edited.Net.Nodes, this->Selected);
}

//------------------------------------------------------------------------------
void LatticeEditor::ShrinkSelection()
{
  this->Selected = ffd::ShrinkSelection(this->Edited.Net.Nodes, this->Selected);
  this->Active = this->IsSelected(this->Active) ? this->Active : None;
}

//------------------------------------------------------------------------------
void LatticeEditor::SelectRows(int axis)
{
  this->Selected = ffd::SelectRows(this->Edited.Net.Nodes, this->Selected, axis);
}

//------------------------------------------------------------------------------
void LatticeEditor::SelectPlanes(int axis)
{
  this->Selected = ffd::SelectPlanes(this->Edited.Net.Nodes, this->Selected, axis);
}

//------------------------------------------------------------------------------
bool LatticeEditor::GetSelectionCenter(glm::dvec3& center) const
{
  glm::dvec3 sum(0.0);
  int count = 0;
  for (std::size_t p = 0; p < this->Selected.size(); ++p)
  {
    if (this->Selected[p])
    {
      sum += this->Edited.GetControlPoint(p);
      ++count;
    }
  }
  const Box domain = this->Edited.GetDomain();
  center = count > 0 ? sum / static_cast<double>(count) : 0.5 * (domain.Min + domain.Max);
  return count > 0;
}

//------------------------------------------------------------------------------
bool LatticeEditor::Begin(const std::string& name)
{
  if (this->EditIsOpen)
  {
    return false;
  }
  this->EditIsOpen = true;
  this->EditName = name;
  this->StartDisplacements = this->Edited.Net.Values;
  this->Moved.assign(this->GetNumberOfPoints(), 0);
  return true;
}

//------------------------------------------------------------------------------
void LatticeEditor::GrabPoints(const PointSet& points, std::ptrdiff_t leader)
{
  const glm::ivec3& nodes = this->Edited.Net.Nodes;
  const bool* mirror = this->Options.Mirror;
  this->Grabbed = MirrorSelection(nodes, points, mirror);
  this->Leader = 0;
  if (leader >= 0)
  {
    this->Leader = static_cast<std::size_t>(leader);
  }
  else
  {
    const auto first = std::find(points.begin(), points.end(), 1);
    this->Leader = first == points.end() ? 0 : static_cast<std::size_t>(first - points.begin());
  }
  // Positions at the beginning of the edit, which may have moved some points already.
  Lattice start = this->Edited;
  start.Net.Values = this->StartDisplacements;
  this->StartPositions = start.GetControlPoints();
  // The center is that of the leading side: the other only mirrors it.
  const glm::ivec3 lead = this->Edited.IndicesOf(this->Leader);
  glm::dvec3 sum(0.0);
  int count = 0;
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    bool leads = this->Grabbed[p] != 0;
    const glm::ivec3 at = this->Edited.IndicesOf(p);
    for (int a = 0; a < 3 && leads; ++a)
    {
      const int middle = nodes[a] - 1;
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
  this->UpdateWeights();
}

//------------------------------------------------------------------------------
void LatticeEditor::UpdateWeights()
{
  this->Weights = SoftWeights(this->StartPositions, this->Grabbed,
    this->Options.Proportional ? this->GetEffectiveRadius() : 0.0, this->Options.RadialFalloff);
}

//------------------------------------------------------------------------------
void LatticeEditor::TranslateGrabbed(const glm::dvec3& move)
{
  this->MoveGrabbed([&move](const glm::dvec3& p) { return p + move; });
}

//------------------------------------------------------------------------------
void LatticeEditor::RotateGrabbed(double angle, const glm::dvec3& axis)
{
  const glm::dmat3 rotation(glm::rotate(glm::dmat4(1.0), angle, axis));
  this->MoveGrabbed([this, &rotation](const glm::dvec3& p) {
    return this->Center + rotation * (p - this->Center);
  });
}

//------------------------------------------------------------------------------
void LatticeEditor::ScaleGrabbed(const glm::dvec3& factor)
{
  this->MoveGrabbed(
    [this, &factor](const glm::dvec3& p) { return this->Center + factor * (p - this->Center); });
}

//------------------------------------------------------------------------------
void LatticeEditor::MoveGrabbed(const std::function<glm::dvec3(const glm::dvec3&)>& move)
{
  if (!this->EditIsOpen)
  {
    return;
  }
  std::vector<glm::dvec3> changes(this->GetNumberOfPoints(), glm::dvec3(0.0));
  for (std::size_t p = 0; p < changes.size(); ++p)
  {
    if (this->Weights[p] > 0.0)
    {
      const glm::dvec3& at = this->StartPositions[p];
      changes[p] = this->Weights[p] * (move(at) - at);
    }
  }
  MirrorChanges(this->Edited.Net.Nodes, changes, this->Options.Mirror, this->Leader);
  this->ApplyChanges(changes);
}

//------------------------------------------------------------------------------
void LatticeEditor::ResetPoints(const PointSet& points)
{
  if (!this->EditIsOpen)
  {
    return;
  }
  const PointSet all = MirrorSelection(this->Edited.Net.Nodes, points, this->Options.Mirror);
  std::vector<glm::dvec3> changes(this->GetNumberOfPoints(), glm::dvec3(0.0));
  for (std::size_t p = 0; p < changes.size(); ++p)
  {
    changes[p] = all[p] ? -this->StartDisplacements[p] : glm::dvec3(0.0);
  }
  this->ApplyChanges(changes);
}

//------------------------------------------------------------------------------
void LatticeEditor::ApplyChanges(std::vector<glm::dvec3>& changes)
{
  const PointSet locked = this->GetLocked();
  std::vector<glm::dvec3>& values = this->Edited.Net.Values;
  values = this->StartDisplacements;
  const double largest = Lattice::LargestLength / std::max(1.0, std::abs(this->Edited.Scale));
  for (std::size_t p = 0; p < changes.size(); ++p)
  {
    if (locked[p])
    {
      changes[p] = glm::dvec3(0.0);
    }
    if (changes[p] != glm::dvec3(0.0) && !IsWithin(values[p] + changes[p], largest))
    {
      values = this->StartDisplacements;
      this->Refuses = true;
      return;
    }
    values[p] += changes[p];
    this->Moved[p] = this->Moved[p] || changes[p] != glm::dvec3(0.0);
  }
  if (!this->Options.StopsAtFolds)
  {
    return;
  }
  ControlNet before{ this->Edited.Net.Nodes, this->StartDisplacements };
  ControlNet after = this->Edited.Net;
  for (std::size_t p = 0; p < changes.size(); ++p)
  {
    before.Values[p] *= this->Edited.Scale;
    after.Values[p] *= this->Edited.Scale;
  }
  const double fraction =
    LimitFold(before, after, this->Edited.Spacing, this->Options.MinimumDeterminant).Fraction;
  if (fraction < 1.0)
  {
    for (std::size_t p = 0; p < changes.size(); ++p)
    {
      values[p] = this->StartDisplacements[p] + fraction * changes[p];
    }
  }
}

//------------------------------------------------------------------------------
std::string LatticeEditor::FindMaterial(const glm::dvec3& deformed, glm::dvec3& rest) const
{
  const std::string problem = this->Edited.FindProblem();
  if (!problem.empty())
  {
    return problem;
  }
  if (this->Edited.Inverse)
  {
    return "the lattice has its InverseFlag set";
  }
  int evaluations = 0;
  if (!SolveInverse(this->Edited.MakeField(), deformed, deformed,
        MaterialTolerance * this->GetSmallestSpacing(), rest, evaluations))
  {
    return "no material is found there (the lattice is folded)";
  }
  return std::string();
}

//------------------------------------------------------------------------------
std::string LatticeEditor::MoveMaterial(const glm::dvec3& rest, const glm::dvec3& to)
{
  if (!this->EditIsOpen)
  {
    return "no edit is open";
  }
  const double scale = this->Edited.Scale;
  if (!(std::abs(scale) > 0.0))
  {
    return "the DisplacementScale of the lattice is 0";
  }
  const BSplineField field(this->Edited.Net.Nodes, this->Edited.Origin, this->Edited.Spacing,
    this->StartDisplacements.data(), scale, this->Edited.Border);

  // Pins go first: they leave no room for a move that would take them along.
  std::vector<MaterialMove> moves;
  for (const glm::dvec3& pin : this->Pins)
  {
    moves.push_back({ pin, glm::dvec3(0.0) });
  }
  std::size_t moved = moves.size();
  moves.push_back({ rest, to - (rest + field.Displacement(rest)) });
  const Box domain = this->Edited.GetDomain();
  for (int a = 0; a < 3; ++a)
  {
    if (!this->Options.Mirror[a])
    {
      continue;
    }
    // Mirror images; material in the mid-plane stays in it.
    const double ends = domain.Min[a] + domain.Max[a];
    std::vector<MaterialMove> images;
    for (MaterialMove& move : moves)
    {
      MaterialMove image = move;
      image.RestPoint[a] = ends - image.RestPoint[a];
      if (std::abs(image.RestPoint[a] - move.RestPoint[a]) <
        MidPlaneTolerance * this->GetSmallestSpacing())
      {
        move.Move[a] = 0.0;
      }
      else
      {
        image.Move[a] = -image.Move[a];
        images.push_back(image);
      }
    }
    for (const MaterialMove& image : images)
    {
      if (image.Move == glm::dvec3(0.0))
      {
        moves.insert(moves.begin(), image);
        ++moved;
      }
      else
      {
        moves.push_back(image);
      }
    }
  }
  const DirectManipulation solution = ffd::MoveMaterial(field, this->GetLocked(), moves);
  const double missed = glm::length(solution.Achieved[moved] - moves[moved].Move);
  if (!(missed <= MoveTolerance * glm::length(moves[moved].Move)))
  {
    return "pins, locked control points or the end of the lattice hold the material there";
  }
  std::vector<glm::dvec3> changes(this->GetNumberOfPoints(), glm::dvec3(0.0));
  for (std::size_t n = 0; n < solution.Nodes.size(); ++n)
  {
    changes[solution.Nodes[n]] = solution.Changes[n] / scale;
  }
  this->ApplyChanges(changes);
  return std::string();
}

//------------------------------------------------------------------------------
bool LatticeEditor::Commit()
{
  if (!this->EditIsOpen)
  {
    return false;
  }
  this->EditIsOpen = false;
  const std::vector<glm::dvec3>& now = this->Edited.Net.Values;
  LatticeEdit edit;
  edit.Name = this->EditName;
  for (std::size_t p = 0; p < now.size(); ++p)
  {
    if (now[p] != this->StartDisplacements[p])
    {
      edit.Nodes.push_back(p);
      edit.Before.push_back(this->StartDisplacements[p]);
      edit.After.push_back(now[p]);
    }
  }
  if (edit.Nodes.empty())
  {
    return false;
  }
  this->LastEdit = this->EditName;
  this->Changed = edit.Nodes;
  this->History.Add(std::move(edit));
  return true;
}

//------------------------------------------------------------------------------
void LatticeEditor::Rollback()
{
  if (this->EditIsOpen)
  {
    this->EditIsOpen = false;
    this->Edited.Net.Values = this->StartDisplacements;
  }
}

//------------------------------------------------------------------------------
bool LatticeEditor::TranslateSelection(const glm::dvec3& move, const std::string& name)
{
  if (!this->Begin(name))
  {
    return false;
  }
  this->GrabPoints(this->Selected, this->Active);
  this->TranslateGrabbed(move);
  return this->Commit();
}

//------------------------------------------------------------------------------
bool LatticeEditor::RotateSelection(double angle, const glm::dvec3& axis)
{
  if (!this->Begin("Rotate"))
  {
    return false;
  }
  this->GrabPoints(this->Selected, this->Active);
  this->RotateGrabbed(angle, axis);
  return this->Commit();
}

//------------------------------------------------------------------------------
bool LatticeEditor::ScaleSelection(const glm::dvec3& factor)
{
  if (!this->Begin("Scale"))
  {
    return false;
  }
  this->GrabPoints(this->Selected, this->Active);
  this->ScaleGrabbed(factor);
  return this->Commit();
}

//------------------------------------------------------------------------------
bool LatticeEditor::SetControlPoint(std::size_t point, const glm::dvec3& position)
{
  if (!this->Begin("Set"))
  {
    return false;
  }
  PointSet points(this->GetNumberOfPoints(), 0);
  points[point] = 1;
  this->GrabPoints(points, static_cast<std::ptrdiff_t>(point));
  this->TranslateGrabbed(position - this->StartPositions[point]);
  return this->Commit();
}

//------------------------------------------------------------------------------
bool LatticeEditor::Reset(const PointSet& points)
{
  if (!this->Begin("Reset"))
  {
    return false;
  }
  this->ResetPoints(points);
  return this->Commit();
}

//------------------------------------------------------------------------------
bool LatticeEditor::ResetAll() { return this->Reset(PointSet(this->GetNumberOfPoints(), 1)); }

//------------------------------------------------------------------------------
bool LatticeEditor::MoveMaterialAt(
  const glm::dvec3& from, const glm::dvec3& to, std::string& problem)
{
  glm::dvec3 rest;
  problem = this->FindMaterial(from, rest);
  if (!problem.empty() || !this->Begin("Material"))
  {
    return false;
  }
  problem = this->MoveMaterial(rest, to);
  return this->Commit();
}

//------------------------------------------------------------------------------
bool LatticeEditor::Undo()
{
  return !this->EditIsOpen && this->Restore(this->History.Undo(), true, "Undo");
}

//------------------------------------------------------------------------------
bool LatticeEditor::Redo()
{
  return !this->EditIsOpen && this->Restore(this->History.Redo(), false, "Redo");
}

//------------------------------------------------------------------------------
bool LatticeEditor::Restore(const LatticeEdit* edit, bool before, const char* name)
{
  if (!edit)
  {
    return false;
  }
  for (std::size_t n = 0; n < edit->Nodes.size(); ++n)
  {
    this->Edited.Net.Values[edit->Nodes[n]] = before ? edit->Before[n] : edit->After[n];
  }
  this->LastEdit = name;
  this->Changed = edit->Nodes;
  return true;
}

} // namespace ffd
