// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDEditHistory.h"

#include <gtest/gtest.h>

using namespace ffd;

namespace
{

LatticeEdit MakeEdit(int number, std::size_t points = 1)
{
  LatticeEdit edit;
  edit.Name = "Edit";
  edit.Nodes.assign(points, static_cast<std::size_t>(number));
  edit.Before.assign(points, glm::dvec3(number));
  edit.After.assign(points, glm::dvec3(number + 1));
  return edit;
}

} // namespace

TEST(EditHistory, UndoAndRedoWalkThroughTheEdits)
{
  EditHistory history;
  EXPECT_EQ(history.Undo(), nullptr);
  EXPECT_EQ(history.Redo(), nullptr);
  for (int i = 0; i < 5; ++i)
  {
    history.Add(MakeEdit(i));
  }
  EXPECT_EQ(history.GetNumberOfUndos(), 5u);
  for (int i = 4; i >= 2; --i)
  {
    EXPECT_EQ(history.Undo()->Nodes[0], static_cast<std::size_t>(i));
  }
  EXPECT_EQ(history.GetNumberOfUndos(), 2u);
  EXPECT_EQ(history.GetNumberOfRedos(), 3u);
  EXPECT_EQ(history.Redo()->Nodes[0], 2u);
  // A new edit takes the place of those that were undone.
  history.Add(MakeEdit(9));
  EXPECT_EQ(history.GetNumberOfRedos(), 0u);
  EXPECT_EQ(history.GetNumberOfUndos(), 4u);
  EXPECT_EQ(history.Undo()->Nodes[0], 9u);
  EXPECT_EQ(history.Undo()->Nodes[0], 2u);
  history.Clear();
  EXPECT_EQ(history.Undo(), nullptr);
  EXPECT_EQ(history.Redo(), nullptr);
  EXPECT_EQ(history.GetMemorySize(), 0u);
}

TEST(EditHistory, OnlyMemoryLimitsTheNumber)
{
  EditHistory history;
  for (int i = 0; i < 10000; ++i)
  {
    history.Add(MakeEdit(i));
  }
  EXPECT_EQ(history.GetNumberOfUndos(), 10000u);
  const std::size_t one = MakeEdit(0).GetMemorySize();
  history.SetMemoryLimit(100 * one);
  EXPECT_LE(history.GetMemorySize(), 100 * one);
  EXPECT_GE(history.GetNumberOfUndos(), 99u);
  EXPECT_LE(history.GetNumberOfUndos(), 100u);
  // The oldest are gone, the newest are there.
  EXPECT_EQ(history.Undo()->Nodes[0], 9999u);
  history.Redo();
  history.Add(MakeEdit(10000));
  EXPECT_LE(history.GetMemorySize(), 100 * one);
  EXPECT_EQ(history.Undo()->Nodes[0], 10000u);
}

TEST(EditHistory, WhatIsLargerThanTheLimitCannotBeUndone)
{
  EditHistory history;
  history.SetMemoryLimit(5000);
  history.Add(MakeEdit(1));
  history.Add(MakeEdit(2, 1000));
  EXPECT_EQ(history.GetNumberOfUndos(), 0u);
  EXPECT_EQ(history.GetMemorySize(), 0u);
  history.Add(MakeEdit(3));
  EXPECT_EQ(history.GetNumberOfUndos(), 1u);
  // A tighter limit while edits are undone: nothing to redo is left without its predecessors.
  history.Undo();
  history.SetMemoryLimit(10);
  EXPECT_EQ(history.GetNumberOfRedos(), 0u);
  EXPECT_EQ(history.GetMemorySize(), 0u);
}
