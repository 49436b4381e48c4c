// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDLatticeEditor_h
#define FFDLatticeEditor_h

#include "FFDEditHistory.h"
#include "FFDExport.h"
#include "FFDLattice.h"
#include "FFDLatticeSelection.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace ffd
{

/// Operations on a selection; the values are those of vtkFFDLatticeRepresentation.
enum class SelectionOperation
{
  Replace = 0,
  Add = 1,
  Toggle = 2
};

/// Options that every edit obeys.
struct EditOptions
{
  bool Proportional = false;                ///< control points near the edited ones follow
  double Radius = 0.0;                      ///< how far, data units; 0: two of the widest spacings
  Falloff RadialFalloff = Falloff::Smooth;  ///< how much, by the distance
  bool Mirror[3] = { false, false, false }; ///< edits are mirrored across these mid-planes
  int LockedLayers = 0;                     ///< outermost layers that do not move, 0 to 3
  bool StopsAtFolds = false; ///< edits end where the bound of det J_T reaches MinimumDeterminant
  double MinimumDeterminant = 0.05;
};

/**
 * Edits a lattice: holds the selection, makes edits that obey the options, and undoes them,
 * exactly. Control points are named by their index, i fastest; positions are data coordinates.
 *
 * The lattice is a value. A caller whose lattice can change elsewhere hands it over before it asks
 * for something (SetLattice()) and takes the displacements back after an edit (GetLattice()).
 *
 * An edit goes from Begin() to Commit() or Rollback(). In between GrabPoints() names what moves,
 * and each of TranslateGrabbed(), ..., MoveMaterial() replaces what the one before did: they start
 * from the displacements at Begin(), so that the steps of a drag do not add up. The edits of the
 * selection do all of that at once.
 */
class FFD_WIDGETS_EXPORT LatticeEditor
{
public:
  static constexpr std::ptrdiff_t None = -1; ///< instead of a control point

  EditOptions Options;

  //----------------------------------------------------------------------------
  // The lattice

  /**
   * Takes over the lattice as it is now. Other dimensions than before empty the selection and the
   * history and end an open edit. Returns whether they did. What an open edit has not moved begins
   * where it is now, and is no part of the edit.
   */
  bool SetLattice(Lattice lattice);

  /// Takes over another lattice, for which nothing of the old one holds: pins go, too.
  void StartWith(Lattice lattice);

  const Lattice& GetLattice() const { return this->Edited; }
  std::size_t GetNumberOfPoints() const { return this->Edited.Net.Values.size(); }
  bool IsPoint(std::ptrdiff_t point) const
  {
    return point >= 0 && point < static_cast<std::ptrdiff_t>(this->GetNumberOfPoints());
  }
  /// Index of control point (i, j, k), or None.
  std::ptrdiff_t FindPoint(const glm::ivec3& at) const;

  double GetSmallestSpacing() const;
  /// The radius of proportional editing that is in use.
  double GetEffectiveRadius() const;
  /// The control points that do not move.
  PointSet GetLocked() const;

  //----------------------------------------------------------------------------
  // The selection

  const PointSet& GetSelected() const { return this->Selected; }
  bool IsSelected(std::ptrdiff_t point) const;
  std::size_t GetNumberOfSelected() const;
  /// The point selected last, whose side leads symmetric edits; None when it is not selected.
  std::ptrdiff_t GetActive() const { return this->Active; }

  void Select(std::size_t point, SelectionOperation operation);
  /// Changes the selection by a set of points; none of them becomes active.
  void Select(const PointSet& points, SelectionOperation operation);
  void SetSelected(const PointSet& points, std::ptrdiff_t active);
  void SelectAll();
  void ClearSelection();
  void InvertSelection();
  void GrowSelection();
  void ShrinkSelection();
  void SelectRows(int axis);
  void SelectPlanes(int axis);

  /// Mean position of the selected points. Returns false, and the center of the domain, for none.
  bool GetSelectionCenter(glm::dvec3& center) const;

  //----------------------------------------------------------------------------
  // An edit, step by step: what moves points does nothing after the edit has ended, as it does when
  // a lattice of other dimensions is set

  bool IsEditing() const { return this->EditIsOpen; }
  /// Whether, since it was asked before, all points have stayed as some would have been displaced
  /// by what is not a number or exceeds Lattice::LargestLength.
  bool TakeRefusal() { return std::exchange(this->Refuses, false); }
  /// Returns false, and does nothing, while another edit is open.
  bool Begin(const std::string& name);
  /// Prepares to move a set of points and, by the options, others with them. `leader`: the point
  /// whose side leads a symmetric edit; None: the first of the set.
  void GrabPoints(const PointSet& points, std::ptrdiff_t leader);
  /// Follows changed options of proportional editing.
  void UpdateWeights();

  void TranslateGrabbed(const glm::dvec3& move);
  /// Radians about a unit axis through the center of what was grabbed.
  void RotateGrabbed(double angle, const glm::dvec3& axis);
  /// Factors per axis, from the center of what was grabbed.
  void ScaleGrabbed(const glm::dvec3& factor);
  /// Displacement zero for a set of points and their mirror images; neighbors do not follow.
  void ResetPoints(const PointSet& points);
  /**
   * Moves the material that rests at `rest` to `to` by the smallest changes of control points,
   * while the pins hold. Returns the reason if it cannot; nothing is changed then.
   */
  std::string MoveMaterial(const glm::dvec3& rest, const glm::dvec3& to);

  /// Ends the edit. Returns whether it changed anything: then it can be undone.
  bool Commit();
  /// Ends the edit and puts everything back.
  void Rollback();

  //----------------------------------------------------------------------------
  // Whole edits; they return whether they changed anything, and do nothing while one is open

  bool TranslateSelection(const glm::dvec3& move, const std::string& name = "Translate");
  bool RotateSelection(double angle, const glm::dvec3& axis);
  bool ScaleSelection(const glm::dvec3& factor);
  /// Moves one control point; the selection plays no part.
  bool SetControlPoint(std::size_t point, const glm::dvec3& position);
  bool Reset(const PointSet& points);
  bool ResetAll();
  /// Moves the material that is at a deformed position; `problem` says why not.
  bool MoveMaterialAt(const glm::dvec3& from, const glm::dvec3& to, std::string& problem);

  //----------------------------------------------------------------------------
  // Material

  /// Finds the rest point of the material that is at a deformed position. Returns the reason if
  /// there is none.
  std::string FindMaterial(const glm::dvec3& deformed, glm::dvec3& rest) const;

  /// Rest points of the material that holds still in MoveMaterial().
  const std::vector<glm::dvec3>& GetPins() const { return this->Pins; }
  void SetPins(const std::vector<glm::dvec3>& pins) { this->Pins = pins; }

  //----------------------------------------------------------------------------
  // Undo

  bool Undo();
  bool Redo();
  EditHistory& GetHistory() { return this->History; }
  const EditHistory& GetHistory() const { return this->History; }

  /// The name of the last edit, "Undo" and "Redo" among them, and which control points it changed.
  const std::string& GetLastEdit() const { return this->LastEdit; }
  const std::vector<std::size_t>& GetChangedPoints() const { return this->Changed; }

private:
  void Clear();
  void MoveGrabbed(const std::function<glm::dvec3(const glm::dvec3&)>& move);
  void ApplyChanges(std::vector<glm::dvec3>& changes);
  bool Restore(const LatticeEdit* edit, bool before, const char* name);

  Lattice Edited;
  PointSet Selected = PointSet(Lattice().Net.Values.size(), 0);
  std::ptrdiff_t Active = None;
  std::vector<glm::dvec3> Pins;

  EditHistory History;
  std::string LastEdit;
  std::vector<std::size_t> Changed;

  bool EditIsOpen = false;
  bool Refuses = false;
  std::string EditName;
  std::vector<glm::dvec3> StartDisplacements;
  PointSet Moved; // by the open edit, at some time

  // The control points that an edit moves.
  PointSet Grabbed;
  std::vector<glm::dvec3> StartPositions;
  std::vector<double> Weights;
  glm::dvec3 Center{ 0.0 };
  std::size_t Leader = 0;
};

} // namespace ffd

#endif
