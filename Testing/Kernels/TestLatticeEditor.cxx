// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The editor without a window: selection, options of edits, direct manipulation, exact undo.
#include "Bounds/FFDJacobianDeterminant.h"
#include "FFDLatticeEditor.h"
#include "RandomLattice.h"

#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

using namespace ffd;

namespace
{

constexpr double Pi = 3.14159265358979323846;

/// 6^3 control points with spacing 1 (so 0.05 to 3 are 0.05 to 3 spacings), the first at -1.
Lattice MakeLattice(int nodes = 6)
{
  return Lattice(glm::ivec3(nodes), { glm::dvec3(0.0), glm::dvec3(nodes - 3) });
}

LatticeEditor MakeEditor(int nodes = 6)
{
  LatticeEditor editor;
  editor.SetLattice(MakeLattice(nodes));
  return editor;
}

std::size_t Point(const LatticeEditor& editor, int i, int j, int k)
{
  return editor.GetLattice().IndexOf({ i, j, k });
}

const glm::dvec3& Displacement(const LatticeEditor& editor, int i, int j, int k)
{
  return editor.GetLattice().Net.Values[Point(editor, i, j, k)];
}

void Select(LatticeEditor& editor, int i, int j, int k,
  SelectionOperation operation = SelectionOperation::Replace)
{
  editor.Select(Point(editor, i, j, k), operation);
}

glm::dvec3 Deform(const LatticeEditor& editor, const glm::dvec3& rest)
{
  return rest + editor.GetLattice().MakeField().Displacement(rest);
}

double LowestDeterminant(const LatticeEditor& editor)
{
  const BSplineField field = editor.GetLattice().MakeField();
  return BoundJacobianDeterminant(field, glm::ivec3(1), field.GetNodes() - 2).Min;
}

void ExpectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12)
{
  EXPECT_LT(glm::length(a - b), tolerance)
    << a.x << " " << a.y << " " << a.z << " instead of " << b.x << " " << b.y << " " << b.z;
}

} // namespace

TEST(LatticeEditor, SelectionAndItsActivePoint)
{
  LatticeEditor editor = MakeEditor();
  EXPECT_EQ(editor.GetNumberOfSelected(), 0u);
  EXPECT_EQ(editor.GetActive(), LatticeEditor::None);
  Select(editor, 2, 2, 2);
  Select(editor, 3, 2, 2, SelectionOperation::Add);
  EXPECT_EQ(editor.GetNumberOfSelected(), 2u);
  EXPECT_EQ(editor.GetActive(), editor.FindPoint({ 3, 2, 2 }));
  Select(editor, 3, 2, 2, SelectionOperation::Toggle);
  EXPECT_EQ(editor.GetNumberOfSelected(), 1u);
  EXPECT_EQ(editor.GetActive(), LatticeEditor::None);
  Select(editor, 3, 2, 2, SelectionOperation::Toggle);
  EXPECT_TRUE(editor.IsSelected(editor.FindPoint({ 3, 2, 2 })));

  // A set of points: the active one stays as long as it is selected.
  PointSet region(editor.GetNumberOfPoints(), 0);
  region[Point(editor, 3, 2, 2)] = region[Point(editor, 4, 2, 2)] = 1;
  editor.Select(region, SelectionOperation::Replace);
  EXPECT_EQ(editor.GetNumberOfSelected(), 2u);
  EXPECT_EQ(editor.GetActive(), editor.FindPoint({ 3, 2, 2 }));
  editor.Select(region, SelectionOperation::Toggle);
  EXPECT_EQ(editor.GetNumberOfSelected(), 0u);
  EXPECT_EQ(editor.GetActive(), LatticeEditor::None);

  Select(editor, 2, 2, 2);
  editor.GrowSelection();
  EXPECT_EQ(editor.GetNumberOfSelected(), 7u);
  editor.ShrinkSelection();
  EXPECT_EQ(editor.GetNumberOfSelected(), 1u);
  editor.SelectRows(0);
  EXPECT_EQ(editor.GetNumberOfSelected(), 6u);
  editor.SelectPlanes(1);
  EXPECT_EQ(editor.GetNumberOfSelected(), 36u);
  editor.InvertSelection();
  EXPECT_EQ(editor.GetNumberOfSelected(), 180u);
  editor.SelectAll();
  EXPECT_EQ(editor.GetNumberOfSelected(), 216u);
  editor.ClearSelection();
  EXPECT_EQ(editor.GetNumberOfSelected(), 0u);

  EXPECT_EQ(editor.FindPoint({ 6, 0, 0 }), LatticeEditor::None);
  EXPECT_FALSE(editor.IsSelected(LatticeEditor::None));
  EXPECT_FALSE(editor.IsSelected(216));
}

TEST(LatticeEditor, CenterOfTheSelection)
{
  LatticeEditor editor = MakeEditor();
  glm::dvec3 center;
  EXPECT_FALSE(editor.GetSelectionCenter(center));
  ExpectNear(center, glm::dvec3(1.5));
  Select(editor, 1, 1, 1);
  Select(editor, 3, 1, 1, SelectionOperation::Add);
  EXPECT_TRUE(editor.TranslateSelection({ 0.0, 0.5, 0.0 }));
  EXPECT_TRUE(editor.GetSelectionCenter(center));
  ExpectNear(center, { 1.0, 0.5, 0.0 });
}

TEST(LatticeEditor, EditsOfTheSelectionAreTheClosedForms)
{
  LatticeEditor editor = MakeEditor();
  EXPECT_FALSE(editor.TranslateSelection({ 1.0, 0.0, 0.0 })); // nothing is selected
  EXPECT_EQ(editor.GetHistory().GetNumberOfUndos(), 0u);
  Select(editor, 1, 2, 2);
  Select(editor, 3, 2, 2, SelectionOperation::Add);
  // A quarter turn about z through (1, 1, 1): (-1, 0) goes to (0, -1).
  EXPECT_TRUE(editor.RotateSelection(0.5 * Pi, { 0.0, 0.0, 1.0 }));
  ExpectNear(Displacement(editor, 1, 2, 2), { 1.0, -1.0, 0.0 });
  ExpectNear(Displacement(editor, 3, 2, 2), { -1.0, 1.0, 0.0 });
  EXPECT_TRUE(editor.ScaleSelection({ 1.0, 3.0, 1.0 }));
  ExpectNear(Displacement(editor, 1, 2, 2), { 1.0, -3.0, 0.0 });
  EXPECT_TRUE(editor.SetControlPoint(Point(editor, 0, 0, 0), { 5.0, 6.0, 7.0 }));
  ExpectNear(Displacement(editor, 0, 0, 0), { 6.0, 7.0, 8.0 });
  EXPECT_EQ(editor.GetLastEdit(), "Set");
  EXPECT_EQ(editor.GetChangedPoints(), std::vector<std::size_t>{ 0 });
  EXPECT_TRUE(editor.Reset(editor.GetSelected()));
  EXPECT_EQ(Displacement(editor, 3, 2, 2), glm::dvec3(0.0));
  EXPECT_FALSE(editor.Reset(editor.GetSelected()));
  EXPECT_TRUE(editor.ResetAll());
  EXPECT_TRUE(editor.GetLattice().IsIdentity());
  // What is not finite does not move.
  EXPECT_FALSE(editor.TranslateSelection({ std::numeric_limits<double>::infinity(), 0.0, 0.0 }));
}

TEST(LatticeEditor, RotationKeepsLengthsAboutAnyAxis)
{
  LatticeEditor editor = MakeEditor();
  editor.SelectAll();
  EXPECT_TRUE(editor.RotateSelection(0.7, glm::normalize(glm::dvec3(1.0, -2.0, 0.5))));
  glm::dvec3 center;
  editor.GetSelectionCenter(center);
  ExpectNear(center, glm::dvec3(1.5), 1e-11);
  const std::vector<glm::dvec3> positions = editor.GetLattice().GetControlPoints();
  for (const int n : { 0, 17, 100, 215 })
  {
    const auto at = static_cast<std::size_t>(n);
    const glm::dvec3 rest = editor.GetLattice().GetRestPoint(editor.GetLattice().IndicesOf(at));
    EXPECT_NEAR(glm::length(positions[at] - center), glm::length(rest - center), 1e-11);
  }
  // Along the axis nothing moves.
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1.0, -2.0, 0.5));
  EXPECT_NEAR(glm::dot(Displacement(editor, 5, 0, 2), axis), 0.0, 1e-12);
}

TEST(LatticeEditor, NeighborsFollowByTheFalloff)
{
  LatticeEditor editor = MakeEditor();
  EXPECT_EQ(editor.GetEffectiveRadius(), 2.0);
  editor.Options.Proportional = true;
  editor.Options.RadialFalloff = Falloff::Linear;
  Select(editor, 2, 2, 2);
  EXPECT_TRUE(editor.TranslateSelection({ 0.0, 0.0, 1.0 }));
  EXPECT_EQ(Displacement(editor, 2, 2, 2).z, 1.0);
  EXPECT_NEAR(Displacement(editor, 3, 2, 2).z, 0.5, 1e-15);
  EXPECT_NEAR(Displacement(editor, 3, 3, 2).z, 1.0 - std::sqrt(0.5), 1e-15);
  EXPECT_EQ(Displacement(editor, 4, 2, 2).z, 0.0);
  EXPECT_TRUE(editor.Undo());
  // In the middle of an edit, and by another radius.
  EXPECT_TRUE(editor.Begin("Translate"));
  editor.GrabPoints(editor.GetSelected(), editor.GetActive());
  editor.TranslateGrabbed({ 0.0, 0.0, 1.0 });
  editor.Options.Radius = 4.0;
  editor.UpdateWeights();
  editor.TranslateGrabbed({ 0.0, 0.0, 1.0 });
  EXPECT_NEAR(Displacement(editor, 4, 2, 2).z, 0.5, 1e-15);
  EXPECT_TRUE(editor.Commit());
}

TEST(LatticeEditor, StepsOfAnEditDoNotAddUp)
{
  LatticeEditor editor = MakeEditor();
  Select(editor, 2, 2, 2);
  EXPECT_TRUE(editor.Begin("Translate"));
  EXPECT_TRUE(editor.IsEditing());
  editor.GrabPoints(editor.GetSelected(), editor.GetActive());
  for (int step = 1; step <= 10; ++step)
  {
    editor.TranslateGrabbed({ 0.1 * step, 0.0, 0.0 });
  }
  // Another edit has to wait, and so has undo.
  EXPECT_FALSE(editor.Begin("Rotate"));
  EXPECT_FALSE(editor.TranslateSelection({ 5.0, 0.0, 0.0 }));
  EXPECT_FALSE(editor.Undo());
  EXPECT_TRUE(editor.Commit());
  EXPECT_FALSE(editor.Commit());
  EXPECT_EQ(Displacement(editor, 2, 2, 2).x, 1.0);
  EXPECT_EQ(editor.GetHistory().GetNumberOfUndos(), 1u);

  EXPECT_TRUE(editor.Begin("Translate"));
  editor.GrabPoints(editor.GetSelected(), editor.GetActive());
  editor.TranslateGrabbed({ 7.0, 7.0, 7.0 });
  editor.Rollback();
  EXPECT_EQ(Displacement(editor, 2, 2, 2), glm::dvec3(1.0, 0.0, 0.0));
  EXPECT_EQ(editor.GetHistory().GetNumberOfUndos(), 1u);
}

TEST(LatticeEditor, WhatAnEditDoesNotMoveIsNoPartOfIt)
{
  for (const bool commits : { true, false })
  {
    LatticeEditor editor = MakeEditor();
    Select(editor, 2, 2, 2);
    EXPECT_TRUE(editor.Begin("Translate"));
    editor.GrabPoints(editor.GetSelected(), editor.GetActive());
    const auto set = [&editor](int i, double x) {
      Lattice lattice = editor.GetLattice();
      lattice.Net.Values[Point(editor, i, 2, 2)].x = x;
      EXPECT_FALSE(editor.SetLattice(lattice));
    };
    set(2, 1.0); // not moved yet
    editor.TranslateGrabbed({ 0.0, 1.0, 0.0 });
    set(1, 3.0);
    set(2, 7.0);
    editor.TranslateGrabbed({ 0.0, 2.0, 0.0 });
    EXPECT_EQ(Displacement(editor, 2, 2, 2), glm::dvec3(1.0, 2.0, 0.0));
    EXPECT_EQ(Displacement(editor, 1, 2, 2).x, 3.0);
    if (commits)
    {
      EXPECT_TRUE(editor.Commit());
      EXPECT_EQ(editor.GetChangedPoints(), std::vector<std::size_t>{ Point(editor, 2, 2, 2) });
      EXPECT_TRUE(editor.Undo());
    }
    else
    {
      editor.Rollback();
    }
    EXPECT_EQ(Displacement(editor, 2, 2, 2), glm::dvec3(1.0, 0.0, 0.0));
    EXPECT_EQ(Displacement(editor, 1, 2, 2).x, 3.0);
  }
}

TEST(LatticeEditor, AnotherLatticeEndsTheEdit)
{
  for (int nodes : { 4, 9 })
  {
    LatticeEditor editor = MakeEditor();
    Select(editor, 2, 2, 2);
    EXPECT_TRUE(editor.Begin("Translate"));
    editor.GrabPoints(editor.GetSelected(), editor.GetActive());
    editor.TranslateGrabbed({ 1.0, 0.0, 0.0 });
    EXPECT_TRUE(editor.SetLattice(MakeLattice(nodes)));
    EXPECT_FALSE(editor.IsEditing());
    const std::vector<glm::dvec3> values = editor.GetLattice().Net.Values;
    editor.UpdateWeights();
    editor.TranslateGrabbed({ 1.0, 0.0, 0.0 });
    editor.RotateGrabbed(1.0, { 0.0, 0.0, 1.0 });
    editor.ScaleGrabbed({ 2.0, 2.0, 2.0 });
    editor.ResetPoints(PointSet(editor.GetNumberOfPoints(), 1));
    EXPECT_EQ(editor.MoveMaterial({ 1.0, 1.0, 1.0 }, { 1.2, 1.0, 1.0 }), "no edit is open");
    editor.Rollback();
    EXPECT_FALSE(editor.Commit());
    EXPECT_TRUE(editor.GetLattice().Net.Values == values);
  }
}

TEST(LatticeEditor, MirroredEditsFollowTheActiveSide)
{
  LatticeEditor editor = MakeEditor();
  editor.Options.Mirror[0] = true;
  editor.Options.Mirror[1] = true;
  Select(editor, 4, 1, 2);
  EXPECT_TRUE(editor.TranslateSelection({ 1.0, 2.0, 3.0 }));
  EXPECT_EQ(Displacement(editor, 4, 1, 2), glm::dvec3(1.0, 2.0, 3.0));
  EXPECT_EQ(Displacement(editor, 1, 1, 2), glm::dvec3(-1.0, 2.0, 3.0));
  EXPECT_EQ(Displacement(editor, 4, 4, 2), glm::dvec3(1.0, -2.0, 3.0));
  EXPECT_EQ(Displacement(editor, 1, 4, 2), glm::dvec3(-1.0, -2.0, 3.0));
  EXPECT_TRUE(editor.Reset(editor.GetSelected()));
  EXPECT_TRUE(editor.GetLattice().IsIdentity());

  // The center of a turn is that of the leading side.
  editor.Options.Mirror[1] = false;
  Select(editor, 5, 2, 2);
  Select(editor, 5, 4, 2, SelectionOperation::Add);
  EXPECT_TRUE(editor.RotateSelection(Pi, { 0.0, 0.0, 1.0 }));
  ExpectNear(Displacement(editor, 5, 2, 2), { 0.0, 2.0, 0.0 });
  ExpectNear(Displacement(editor, 0, 2, 2), { 0.0, 2.0, 0.0 });
}

TEST(LatticeEditor, LockedLayersStay)
{
  LatticeEditor editor = MakeEditor();
  editor.Options.LockedLayers = 2;
  editor.SelectAll();
  EXPECT_TRUE(editor.TranslateSelection({ 1.0, 0.0, 0.0 }));
  int moved = 0;
  for (const glm::dvec3& d : editor.GetLattice().Net.Values)
  {
    moved += d.x == 1.0 ? 1 : 0;
  }
  EXPECT_EQ(moved, 8);
  EXPECT_EQ(editor.GetChangedPoints().size(), 8u);
  editor.Options.LockedLayers = 3;
  EXPECT_FALSE(editor.TranslateSelection({ 1.0, 0.0, 0.0 }));
}

TEST(LatticeEditor, FoldGuardStopsOnTheWay)
{
  LatticeEditor editor = MakeEditor(8);
  Select(editor, 3, 3, 3);
  const glm::dvec3 far(12.0, 3.0, 0.0);
  EXPECT_TRUE(editor.TranslateSelection(far));
  EXPECT_LT(LowestDeterminant(editor), 0.0);
  EXPECT_TRUE(editor.Undo());
  for (const double scale : { 1.0, 0.5 })
  {
    // The scale makes the displacements count for less.
    Lattice lattice = MakeLattice(8);
    lattice.Scale = scale;
    editor.SetLattice(lattice);
    editor.Options.StopsAtFolds = true;
    editor.Options.MinimumDeterminant = 0.1;
    EXPECT_TRUE(editor.TranslateSelection(far));
    const glm::dvec3 d = Displacement(editor, 3, 3, 3);
    EXPECT_GT(d.x, 0.1);
    EXPECT_LT(d.x, 12.0);
    EXPECT_NEAR(d.y / d.x, 0.25, 1e-12);
    EXPECT_GE(LowestDeterminant(editor), 0.09);
    EXPECT_LE(LowestDeterminant(editor), 0.2);
    EXPECT_TRUE(editor.Undo());
    // Edits that fold nothing are those without the guard, bit by bit.
    EXPECT_TRUE(editor.TranslateSelection({ 0.1, 0.2, 0.3 }));
    const glm::dvec3 guarded = Displacement(editor, 3, 3, 3);
    EXPECT_TRUE(editor.Undo());
    editor.Options.StopsAtFolds = false;
    EXPECT_TRUE(editor.TranslateSelection({ 0.1, 0.2, 0.3 }));
    EXPECT_EQ(guarded, Displacement(editor, 3, 3, 3));
    EXPECT_TRUE(editor.Undo());
  }
}

TEST(LatticeEditor, MaterialMovesExactlyAndPinsHold)
{
  LatticeEditor editor = MakeEditor(7);
  RandomLattice random(3);
  Lattice lattice = editor.GetLattice();
  for (glm::dvec3& d : lattice.Net.Values)
  {
    d = random.Vector(-0.15, 0.15);
  }
  lattice.Scale = 1.5;
  editor.SetLattice(lattice);
  const glm::dvec3 rest(1.7, 2.1, 1.9);
  const glm::dvec3 pinned(2.9, 1.2, 2.4);
  const glm::dvec3 from = Deform(editor, rest);
  const glm::dvec3 pinnedAt = Deform(editor, pinned);
  editor.SetPins({ pinned });
  glm::dvec3 found;
  EXPECT_EQ(editor.FindMaterial(from, found), "");
  ExpectNear(found, rest, 1e-6);

  std::string problem;
  const glm::dvec3 to = from + glm::dvec3(0.3, -0.1, 0.2);
  EXPECT_TRUE(editor.MoveMaterialAt(from, to, problem)) << problem;
  ExpectNear(Deform(editor, rest), to, 1e-6);
  ExpectNear(Deform(editor, pinned), pinnedAt);
  EXPECT_EQ(editor.GetLastEdit(), "Material");

  // A pin cannot be moved, and no trace of the attempt is left.
  const std::vector<glm::dvec3> before = editor.GetLattice().Net.Values;
  EXPECT_FALSE(editor.MoveMaterialAt(pinnedAt, to, problem));
  EXPECT_NE(problem.find("pins"), std::string::npos);
  EXPECT_EQ(editor.GetLattice().Net.Values, before);
  EXPECT_FALSE(editor.IsEditing());
  EXPECT_EQ(editor.GetHistory().GetNumberOfUndos(), 1u);
}

TEST(LatticeEditor, MaterialMovesSymmetrically)
{
  LatticeEditor editor = MakeEditor(7); // the domain is 0 to 4
  editor.Options.Mirror[0] = true;
  std::string problem;
  editor.SetPins({ { 1.0, 3.0, 2.0 } }); // its mirror image holds, too
  EXPECT_TRUE(editor.MoveMaterialAt({ 1.0, 1.0, 1.0 }, { 1.2, 1.3, 1.4 }, problem)) << problem;
  ExpectNear(Deform(editor, { 1.0, 1.0, 1.0 }), { 1.2, 1.3, 1.4 }, 1e-6);
  ExpectNear(Deform(editor, { 3.0, 1.0, 1.0 }), { 2.8, 1.3, 1.4 }, 1e-6);
  ExpectNear(Deform(editor, { 1.0, 3.0, 2.0 }), { 1.0, 3.0, 2.0 }, 1e-6);
  ExpectNear(Deform(editor, { 3.0, 3.0, 2.0 }), { 3.0, 3.0, 2.0 }, 1e-6);
  // In the mid-plane it stays in it.
  const glm::dvec3 middle = Deform(editor, { 2.0, 2.0, 2.0 });
  EXPECT_NEAR(middle.x, 2.0, 1e-12);
  EXPECT_TRUE(editor.MoveMaterialAt(middle, middle + glm::dvec3(0.5, 0.2, 0.0), problem));
  ExpectNear(Deform(editor, { 2.0, 2.0, 2.0 }), middle + glm::dvec3(0.0, 0.2, 0.0), 1e-6);
}

TEST(LatticeEditor, MaterialThatCannotMoveIsNamed)
{
  LatticeEditor editor = MakeEditor();
  const glm::dvec3 at(1.5);
  std::string problem;
  const auto fails = [&](const char* words) {
    const bool changed = editor.MoveMaterialAt(at, at + 0.1, problem);
    EXPECT_NE(problem.find(words), std::string::npos) << problem;
    return !changed;
  };
  Lattice lattice = MakeLattice();
  lattice.Inverse = true;
  editor.SetLattice(lattice);
  EXPECT_TRUE(fails("InverseFlag"));
  lattice.Inverse = false;
  lattice.Scale = 0.0;
  editor.SetLattice(lattice);
  EXPECT_TRUE(fails("DisplacementScale"));
  lattice.Scale = 1.0;
  lattice.Net.Values[5].x = std::nan("");
  editor.SetLattice(lattice);
  EXPECT_TRUE(fails("control point 5"));
  editor.SetLattice(MakeLattice());
  editor.Options.LockedLayers = 3;
  EXPECT_TRUE(fails("locked"));
}

TEST(LatticeEditor, UndoAndRedoAreExact)
{
  RandomLattice random(9);
  LatticeEditor editor = MakeEditor();
  std::vector<std::vector<glm::dvec3>> states{ editor.GetLattice().Net.Values };
  for (int n = 0; n < 200; ++n)
  {
    editor.Options.Proportional = random.Integer(0, 1) == 1;
    editor.Options.Mirror[0] = random.Integer(0, 3) == 0;
    editor.Options.LockedLayers = random.Integer(0, 1);
    editor.Options.StopsAtFolds = random.Integer(0, 9) == 0;
    editor.Select(static_cast<std::size_t>(random.Integer(0, 215)),
      n % 3 == 0 ? SelectionOperation::Replace : SelectionOperation::Add);
    bool changed = false;
    std::string problem;
    switch (random.Integer(0, 4))
    {
      case 0:
        changed = editor.TranslateSelection(random.Vector(-0.3, 0.3));
        break;
      case 1:
        changed = editor.RotateSelection(random.Number(-1.0, 1.0), { 0.6, 0.0, 0.8 });
        break;
      case 2:
        changed = editor.ScaleSelection(random.Vector(0.8, 1.2));
        break;
      case 3:
        changed = editor.Reset(editor.GetSelected());
        break;
      default:
        changed = editor.MoveMaterialAt(random.Vector(0.5, 2.5), random.Vector(0.5, 2.5), problem);
    }
    if (changed)
    {
      states.push_back(editor.GetLattice().Net.Values);
    }
  }
  ASSERT_GT(states.size(), 100u);
  ASSERT_EQ(editor.GetHistory().GetNumberOfUndos() + 1, states.size());
  for (std::size_t n = states.size() - 1; n-- > 0;)
  {
    ASSERT_TRUE(editor.Undo());
    ASSERT_EQ(editor.GetLattice().Net.Values, states[n]);
  }
  EXPECT_EQ(editor.GetLastEdit(), "Undo");
  EXPECT_FALSE(editor.Undo());
  for (std::size_t n = 1; n < states.size(); ++n)
  {
    ASSERT_TRUE(editor.Redo());
    ASSERT_EQ(editor.GetLattice().Net.Values, states[n]);
  }
  EXPECT_FALSE(editor.Redo());
}

TEST(LatticeEditor, ChangesFromElsewhereAreTakenOver)
{
  LatticeEditor editor = MakeEditor();
  Select(editor, 2, 2, 2);
  EXPECT_TRUE(editor.TranslateSelection({ 1.0, 0.0, 0.0 }));
  Lattice other = editor.GetLattice();
  other.Net.Values[0] = { 0.0, 4.0, 0.0 };
  EXPECT_FALSE(editor.SetLattice(other));
  EXPECT_EQ(editor.GetNumberOfSelected(), 1u);
  // Undo takes back what the edit changed, and nothing else.
  EXPECT_TRUE(editor.Undo());
  EXPECT_EQ(Displacement(editor, 2, 2, 2), glm::dvec3(0.0));
  EXPECT_EQ(Displacement(editor, 0, 0, 0), glm::dvec3(0.0, 4.0, 0.0));

  // Other dimensions: nothing holds any more but the pins, which are material.
  editor.SetPins({ glm::dvec3(1.0) });
  EXPECT_TRUE(editor.Begin("Translate"));
  EXPECT_TRUE(editor.SetLattice(MakeLattice(7)));
  EXPECT_FALSE(editor.IsEditing());
  EXPECT_EQ(editor.GetNumberOfSelected(), 0u);
  EXPECT_EQ(editor.GetHistory().GetNumberOfRedos(), 0u);
  EXPECT_EQ(editor.GetPins().size(), 1u);
  Select(editor, 6, 6, 6);
  EXPECT_TRUE(editor.TranslateSelection({ 1.0, 0.0, 0.0 }));

  // Another lattice, even of the same size.
  editor.StartWith(MakeLattice(7));
  EXPECT_EQ(editor.GetNumberOfSelected(), 0u);
  EXPECT_EQ(editor.GetHistory().GetNumberOfUndos(), 0u);
  EXPECT_TRUE(editor.GetPins().empty());
}
