// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDStage.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

using namespace ffd;

namespace
{

struct Document
{
  int Value = 0;
};

Made MakeSquare(int& result, StageTools&, const Source<Document>& document)
{
  result = document.Object->Value * document.Object->Value;
  return Made::Anew;
}

/// Tens of the square: unchanged by small changes of it.
Made MakeTens(int& result, StageTools& tools, const Product<int>& square, int offset)
{
  const int tens = *square / 10 + offset;
  if (offset < 0)
  {
    result = -1; // half of something else
    tools.Message = "negative";
    return Made::Not;
  }
  if (offset > 1000)
  {
    result = -2;
    throw std::runtime_error("abort");
  }
  const bool same = tens == result;
  result = tens;
  return same ? Made::Same : Made::Anew;
}

Made MakeList(std::vector<int>& result, StageTools&, const Product<int>& tens, int count)
{
  result.assign(static_cast<std::size_t>(count), *tens);
  return Made::Anew;
}

struct Cache
{
  StageOrder Order;
  Stage<&MakeSquare> Square{ Order };
  Stage<&MakeTens> Tens{ Order };
  Stage<&MakeList> List{ Order };
  StageTools Tools;

  bool Update(Document& document, std::uint64_t time, int offset, int count)
  {
    this->Order.Begin();
    return this->Square.Update(this->Tools, { &document, time }) &&
      this->Tens.Update(this->Tools, this->Square.GetProduct(), offset) &&
      this->List.Update(this->Tools, this->Tens.GetProduct(), count);
  }

  std::vector<std::int64_t> CountBuilds() const
  {
    return { this->Square.GetNumberOfBuilds(), this->Tens.GetNumberOfBuilds(),
      this->List.GetNumberOfBuilds() };
  }
};

using Counts = std::vector<std::int64_t>;

} // namespace

TEST(Stage, MakesWhatDependsOnAChangedInputAndNothingElse)
{
  Cache cache;
  Document document{ 7 };
  EXPECT_FALSE(cache.Square.HasResult());
  EXPECT_THROW(cache.Square.Get(), std::logic_error);
  ASSERT_TRUE(cache.Update(document, 1, 0, 2));
  EXPECT_EQ(cache.CountBuilds(), (Counts{ 1, 1, 1 }));
  EXPECT_EQ(cache.List.Get(), (std::vector<int>{ 4, 4 }));
  ASSERT_TRUE(cache.Update(document, 1, 0, 2));
  EXPECT_EQ(cache.CountBuilds(), (Counts{ 1, 1, 1 }));
  // A value, of the last stage and of one in the middle.
  ASSERT_TRUE(cache.Update(document, 1, 0, 3));
  EXPECT_EQ(cache.CountBuilds(), (Counts{ 1, 1, 2 }));
  ASSERT_TRUE(cache.Update(document, 1, 1, 3));
  EXPECT_EQ(cache.CountBuilds(), (Counts{ 1, 2, 3 }));
  EXPECT_EQ(cache.List->size(), 3u);
  EXPECT_EQ(cache.List.Get()[0], 5);
  // The time of an object, and another object of the same time.
  document.Value = 10;
  ASSERT_TRUE(cache.Update(document, 2, 1, 3));
  EXPECT_EQ(cache.List.Get()[0], 11);
  Document other{ 20 };
  ASSERT_TRUE(cache.Update(other, 2, 1, 3));
  EXPECT_EQ(cache.List.Get()[0], 41);
  EXPECT_EQ(cache.CountBuilds(), (Counts{ 3, 4, 5 }));
}

TEST(Stage, AResultThatStaysTheSameMakesNothingAfterIt)
{
  Cache cache;
  Document document{ 7 };
  ASSERT_TRUE(cache.Update(document, 1, 0, 2));
  const std::uint64_t version = cache.Tens.GetProduct().GetVersion();
  document.Value = -7;
  ASSERT_TRUE(cache.Update(document, 2, 0, 2));
  EXPECT_EQ(cache.CountBuilds(), (Counts{ 2, 1, 1 }));
  EXPECT_EQ(cache.Tens.GetProduct().GetVersion(), version);
}

TEST(Stage, AFailureLeavesNoResultAndIsToldAgain)
{
  Cache cache;
  Document document{ 7 };
  ASSERT_TRUE(cache.Update(document, 1, 0, 2));
  for (int i = 0; i < 2; ++i)
  {
    cache.Tools.Message.clear();
    EXPECT_FALSE(cache.Update(document, 1, -1, 2));
    EXPECT_EQ(cache.Tools.Message, "negative");
    EXPECT_FALSE(cache.Tens.HasResult());
    EXPECT_THROW(cache.Tens.GetProduct(), std::logic_error);
  }
  ASSERT_TRUE(cache.Update(document, 1, 0, 2));
  EXPECT_EQ(cache.List.Get(), (std::vector<int>{ 4, 4 }));
}

/// Back to the inputs of the last valid result: what the aborted maker wrote is made again.
TEST(Stage, AnAbortLeavesNoResult)
{
  Cache cache;
  Document document{ 7 };
  ASSERT_TRUE(cache.Update(document, 1, 0, 2));
  EXPECT_THROW(cache.Update(document, 1, 2000, 2), std::runtime_error);
  EXPECT_EQ(cache.Tens.GetLast(), -2);
  ASSERT_TRUE(cache.Update(document, 1, 0, 2));
  EXPECT_EQ(cache.Tens.Get(), 4);
  // Also where the maker finds the result that it is to make.
  EXPECT_THROW(cache.Update(document, 1, 2000, 2), std::runtime_error);
  const std::uint64_t before = cache.List.GetProduct().GetVersion();
  document.Value = 0;
  ASSERT_TRUE(cache.Update(document, 2, 0, 2));
  EXPECT_GT(cache.List.GetProduct().GetVersion(), before);
}

TEST(Stage, TakesResultsOfUpdatedEarlierStagesOnly)
{
  Cache cache;
  Cache another;
  Document document{ 7 };
  ASSERT_TRUE(cache.Update(document, 1, 0, 2));
  ASSERT_TRUE(another.Update(document, 1, 0, 2));
  // Of itself, and of another cache.
  EXPECT_THROW(cache.Tens.Update(cache.Tools, cache.Tens.GetProduct(), 0), std::logic_error);
  EXPECT_THROW(cache.Tens.Update(cache.Tools, another.Square.GetProduct(), 0), std::logic_error);
  // Of a stage that this update has not come to.
  cache.Order.Begin();
  EXPECT_THROW(cache.Tens.Update(cache.Tools, cache.Square.GetProduct(), 0), std::logic_error);
  EXPECT_TRUE(cache.Square.Update(cache.Tools, { &document, 1 }));
  EXPECT_TRUE(cache.Tens.Update(cache.Tools, cache.Square.GetProduct(), 0));
  EXPECT_EQ(cache.CountBuilds(), (Counts{ 1, 1, 1 }));
}

TEST(Stage, MayDependOnAPartOfAResult)
{
  Cache cache;
  Document document{ 7 };
  ASSERT_TRUE(cache.Update(document, 1, 0, 2));
  const auto part = [&cache] { return cache.Tens.GetProduct().WithVersion(77); };
  ASSERT_TRUE(cache.List.Update(cache.Tools, part(), 2));
  EXPECT_EQ(cache.List.GetNumberOfBuilds(), 2);
  cache.Order.Begin();
  document.Value = 10;
  ASSERT_TRUE(cache.Square.Update(cache.Tools, { &document, 2 }));
  ASSERT_TRUE(cache.Tens.Update(cache.Tools, cache.Square.GetProduct(), 0));
  EXPECT_EQ(cache.Tens.Get(), 10);
  ASSERT_TRUE(cache.List.Update(cache.Tools, part(), 2));
  EXPECT_EQ(cache.List.GetNumberOfBuilds(), 2);
}

TEST(Stage, GivesItsMemoryBack)
{
  Cache cache;
  Document document{ 7 };
  ASSERT_TRUE(cache.Update(document, 1, 0, 1000));
  cache.List.Clear();
  EXPECT_EQ(cache.List.GetLast().capacity(), 0u);
  EXPECT_FALSE(cache.List.HasResult());
  ASSERT_TRUE(cache.Update(document, 1, 0, 1000));
  EXPECT_EQ(cache.List->size(), 1000u);
}
