// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFunctionCache.h"
#include "Packets/FFDPacketTable.h"
#include "TestVolume.h"

#include <gtest/gtest.h>

#include <cstddef>

using namespace ffd;

namespace
{

TransferTable MakeRamp(double largest, std::size_t size = 257)
{
  return MakeTable(0.0, 256.0, size, [=](double x) { return largest * x / 256.0; });
}

PacketTable MakePacketTable(const TransferTable& first, const TransferTable& second, double length)
{
  PacketTable table;
  table.Add({ &first, first.GetLow(), first.GetScale(), length, true });
  table.Add({ &second, second.GetLow(), second.GetScale(), length, true });
  return table;
}

} // namespace

TEST(FunctionCache, TablesLieBehindEachOther)
{
  const TransferTable first = MakeRamp(0.4);
  const TransferTable second = MakeRamp(0.8, 129);
  PacketTable table = MakePacketTable(first, second, 1.0);
  ASSERT_EQ(table.GetSize(), 2u);
  EXPECT_EQ(table.GetRange(1).First, 256);
  EXPECT_EQ(table.GetRange(1).Intervals, 128.0f);
  table.Fill(table.MakeContents());
  for (std::size_t i = 0; i < 2; ++i)
  {
    const TransferTable& of = i == 0 ? first : second;
    const PacketTable::Range& range = table.GetRange(i);
    const TransferInterval& last =
      table.GetIntervals()[range.First + static_cast<int>(range.Intervals) - 1];
    EXPECT_EQ(last.Ends[1], of.GetEntries()[4 * of.GetSize() - 1]);
    EXPECT_EQ(table.GetPieces(i).Pieces, 1);
  }
}

TEST(FunctionCache, MakesWhatStaysTheSameOnce)
{
  const TransferTable first = MakeRamp(0.4, 4001);
  const TransferTable second = MakeRamp(0.8, 4001);
  FunctionCache cache;
  EXPECT_EQ(cache.GetMemorySize(), 0u);
  const PacketTable table = MakePacketTable(first, second, 1.0);
  const auto contents = cache.FindContents(table);
  ASSERT_EQ(contents->Pieces.size(), 2u);
  EXPECT_EQ(contents->Pieces[0].Length, 1.0f);
  EXPECT_EQ(contents->Intervals.size(), 8000u);
  EXPECT_TRUE(contents->Opacities.empty());
  EXPECT_EQ(cache.FindContents(MakePacketTable(first, second, 1.0)), contents);
  EXPECT_EQ(cache.GetMemorySize(), contents->GetMemorySize());
  EXPECT_GE(cache.GetMemorySize(), 8000 * sizeof(TransferInterval));

  // Each of what a table is made from counts.
  const auto longer = cache.FindContents(MakePacketTable(first, second, 2.0));
  EXPECT_NE(longer, contents);
  EXPECT_EQ(longer->Pieces[1].Length, 2.0f);
  const auto other = cache.FindContents(MakePacketTable(second, first, 2.0));
  EXPECT_NE(other, longer);
  EXPECT_NE(other->Intervals[3999].Ends[1], longer->Intervals[3999].Ends[1]);

  PacketTable withOpacities = MakePacketTable(second, first, 2.0);
  withOpacities.AddOpacities();
  const auto opacities = cache.FindContents(withOpacities);
  EXPECT_NE(opacities, other);
  ASSERT_EQ(opacities->UnitPieces.size(), 2u);
  ASSERT_EQ(opacities->Opacities.size(), opacities->Intervals.size());
  EXPECT_NEAR(opacities->Opacities[3999].Ends[1], 0.8f, 1e-6f);
  EXPECT_EQ(cache.FindContents(withOpacities), opacities);
}

TEST(FunctionCache, KeepsNothingOfSmallTables)
{
  const TransferTable ramp = MakeRamp(0.4);
  FunctionCache cache;
  const PacketTable table = MakePacketTable(ramp, ramp, 1.0);
  EXPECT_EQ(cache.FindContents(table)->Intervals.size(), 512u);
  EXPECT_EQ(cache.GetMemorySize(), 0u);
}

TEST(FunctionCache, WhereExtinctionsAreAskedForThereAreNoPieces)
{
  const TransferTable ramp = MakeRamp(0.4);
  PacketTable table;
  table.Add({ &ramp, ramp.GetLow(), ramp.GetScale(), 3.0, false });
  const auto contents = table.MakeContents();
  EXPECT_EQ(contents->Pieces[0].Pieces, 0);
  EXPECT_EQ(contents->Pieces[0].Length, 3.0f);
}
