// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBenchmarkGroup.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <limits>
#include <regex>

namespace ffdBenchmark
{

namespace
{

std::string Selection;

/// A row runs in its turn until so much time has passed, but at most so often: one short frame
/// tells more of what the machine did before than of itself.
constexpr double TurnSeconds = 0.03;
constexpr std::size_t LargestNumberOfRuns = 16;

} // namespace

//------------------------------------------------------------------------------
void SetSelection(const std::string& regularExpression) { Selection = regularExpression; }

//------------------------------------------------------------------------------
double Median(std::vector<double> values)
{
  if (values.empty())
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

//------------------------------------------------------------------------------
double Row::GetMedian() const { return Median(this->Seconds); }

//------------------------------------------------------------------------------
double Row::GetCpuMedian() const { return Median(this->CpuSeconds); }

//------------------------------------------------------------------------------
void Row::TakeTurn()
{
  std::vector<double> seconds;
  std::vector<double> cpuSeconds;
  double passed = 0.0;
  do
  {
    if (this->Before)
    {
      this->Before();
    }
    const std::clock_t cpu = std::clock();
    const auto start = std::chrono::steady_clock::now();
    this->Run();
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    cpuSeconds.push_back(static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC);
    seconds.push_back(wall.count());
    passed += wall.count();
  } while (passed < TurnSeconds && seconds.size() < LargestNumberOfRuns);
  this->Seconds.push_back(Median(std::move(seconds)));
  this->CpuSeconds.push_back(Median(std::move(cpuSeconds)));
}

//------------------------------------------------------------------------------
bool Group::AddRow(const std::string& name, std::size_t rounds)
{
  if (!Selection.empty() &&
    !std::regex_search(this->Name + "/" + name, std::regex(Selection, std::regex::extended)))
  {
    return false;
  }
  Row row;
  row.Name = name;
  row.Rounds = rounds;
  this->Rows.push_back(row);
  return true;
}

//------------------------------------------------------------------------------
Row* Group::FindRow(const std::string& name)
{
  const auto found = std::find_if(
    this->Rows.begin(), this->Rows.end(), [&name](const Row& row) { return row.Name == name; });
  return found == this->Rows.end() ? nullptr : &*found;
}

//------------------------------------------------------------------------------
const Row* Group::FindRow(const std::string& name) const
{
  return const_cast<Group*>(this)->FindRow(name);
}

//------------------------------------------------------------------------------
void Group::Measure()
{
  if (this->Measured)
  {
    return;
  }
  this->Measured = true;
  const std::shared_ptr<void> scene = this->Prepare(*this);
  std::size_t rounds = 0;
  for (const Row& row : this->Rows)
  {
    rounds = std::max(rounds, row.Rounds);
  }
  for (std::size_t round = 0; round < rounds; ++round)
  {
    for (Row& row : this->Rows)
    {
      if (round >= row.Rounds || !row.Run || !row.Refusal.empty())
      {
        continue;
      }
      row.TakeTurn();
    }
  }
  for (Row& row : this->Rows)
  {
    // They hold on to the scene.
    row.Before = nullptr;
    row.Run = nullptr;
    if (row.Seconds.empty() && row.Refusal.empty())
    {
      row.Refusal = "was not measured";
    }
  }
}

//------------------------------------------------------------------------------
double Group::GetRatio(const std::string& row, const std::string& by) const
{
  const Row* a = this->FindRow(row);
  const Row* b = this->FindRow(by);
  return a && b ? a->GetMedian() / b->GetMedian() : std::numeric_limits<double>::quiet_NaN();
}

} // namespace ffdBenchmark
