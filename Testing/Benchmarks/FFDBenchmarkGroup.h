// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Configurations that compete with each other, measured in turns (A B C A B C ...), so that a load
// on the machine meets all of them.
#ifndef FFDBenchmarkGroup_h
#define FFDBenchmarkGroup_h

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace ffdBenchmark
{

/// One configuration of a group.
struct Row
{
  std::string Name;
  std::size_t Rounds = 0;
  std::function<void()> Before; ///< not timed, may be empty
  std::function<void()> Run;
  std::vector<double> Seconds;    ///< wall time of each turn: the median of its runs
  std::vector<double> CpuSeconds; ///< of all threads of the process
  std::map<std::string, double> Counters;
  std::string Refusal; ///< why no time is reported; empty: it is

  double GetMedian() const;
  double GetCpuMedian() const;

  /// Times Run, more than once where it is short.
  void TakeTurn();
};

class Group
{
public:
  /// Builds what the rows need and sets their Run, counters and refusals. What it returns lives
  /// until the group is measured.
  using Preparation = std::function<std::shared_ptr<void>(Group&)>;

  Group(std::string name, Preparation prepare)
    : Name(std::move(name))
    , Prepare(std::move(prepare))
  {
  }

  const std::string& GetName() const { return this->Name; }

  /// Declare a row, before anything is measured. False: the selection leaves it out.
  bool AddRow(const std::string& name, std::size_t rounds);

  std::vector<Row>& GetRows() { return this->Rows; }
  const std::vector<Row>& GetRows() const { return this->Rows; }

  /// Null: there is no such row, or it was left out.
  Row* FindRow(const std::string& name);
  const Row* FindRow(const std::string& name) const;

  /// Prepare, and time all rows in turns; does nothing from the second call on.
  void Measure();
  bool IsMeasured() const { return this->Measured; }

  /// Median of one row by that of another; NaN when one is refused or missing.
  double GetRatio(const std::string& row, const std::string& by) const;

private:
  std::string Name;
  Preparation Prepare;
  std::vector<Row> Rows;
  bool Measured = false;
};

/// Rows whose "group/row" does not match are left out; empty: all are taken.
void SetSelection(const std::string& regularExpression);

double Median(std::vector<double> values);

} // namespace ffdBenchmark

#endif
