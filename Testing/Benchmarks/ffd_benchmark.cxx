// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Measures vtkFFDInverseRayVolumeMapper against what it replaces. See Usage below and NOTES.md.
#include "FFDBenchmarkResample.h"
#include "FFDBenchmarkSuites.h"
#include "FFDBenchmarkTargets.h"
#include "FFDGatherLoop.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <limits>
#include <map>
#include <string>

using ffdBenchmark::Group;
using ffdBenchmark::Row;

namespace
{

const char* const Usage =
  "usage: ffd_benchmark [--targets] [--quick] [--only=REGEX] [--rounds=N] [--data=FOLDER]\n"
  "                     [--json=FILE] [Google Benchmark's options]\n"
  "  --targets      measure what the ray caster is to reach, and report on one page what is met\n"
  "  --quick        a small selection, about a minute: shows that everything works\n"
  "  --only=REGEX   measure the rows whose names (<group>/<row>) match, and no others\n"
  "  --rounds=N     how often each row is timed\n"
  "  --data=FOLDER  where engine.vti and cthead.vti are\n"
  "  --json=FILE    write the targets, their figures and whether they are met\n"
  "  --benchmark_out=FILE --benchmark_out_format=json writes all times and counters\n"
  "The rows of a group are timed in turns, so that their ratios mean something on a busy machine.\n"
  "A row whose picture is not what it should be is refused: it gets a message and no time.\n";

//------------------------------------------------------------------------------
/// One repetition of a row: the time was taken with all of its group, see Group.
void Report(benchmark::State& state, Group* group, const std::string& name, std::size_t& repetition)
{
  group->Measure();
  const Row* row = group->FindRow(name);
  if (!row->Refusal.empty())
  {
    state.SkipWithError(row->Refusal.c_str());
    return;
  }
  const std::size_t round = repetition++ % row->Seconds.size();
  for (auto _ : state)
  {
    state.SetIterationTime(row->Seconds[round]);
  }
  state.counters["cpu_ms"] = 1e3 * row->CpuSeconds[round];
  for (const auto& counter : row->Counters)
  {
    // Counters of zero are left out: Google Benchmark divides by them for its coefficient of
    // variation, and writes a NaN that no JSON parser has to take.
    if (std::isfinite(counter.second) && counter.second != 0.0)
    {
      state.counters[counter.first] = counter.second;
    }
  }
}

//------------------------------------------------------------------------------
void Register(const std::vector<std::unique_ptr<Group>>& groups)
{
  for (const auto& each : groups)
  {
    Group* group = each.get();
    for (const Row& row : group->GetRows())
    {
      const std::string rowName = row.Name;
      benchmark::RegisterBenchmark((group->GetName() + "/" + rowName).c_str(),
        [group, rowName, repetition = std::size_t{ 0 }](
          benchmark::State& state) mutable { Report(state, group, rowName, repetition); })
        ->Iterations(1)
        ->Repetitions(static_cast<int>(row.Rounds))
        ->DisplayAggregatesOnly(true)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
    }
  }
}

//------------------------------------------------------------------------------
std::string Cell(double value, int decimals)
{
  if (std::isnan(value))
  {
    return "-";
  }
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

//------------------------------------------------------------------------------
double GetCounter(const Row& row, const char* name)
{
  const auto found = row.Counters.find(name);
  return found == row.Counters.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
}

//------------------------------------------------------------------------------
double GetCpuRatio(const Group& group, const Row& row, const char* by)
{
  const Row* other = group.FindRow(by);
  return other ? row.GetCpuMedian() / other->GetCpuMedian()
               : std::numeric_limits<double>::quiet_NaN();
}

//------------------------------------------------------------------------------
/// What the rows of a group are compared with.
std::pair<const char*, const char*> GetReferences(const Group& group)
{
  const std::string& name = group.GetName();
  if (name.rfind("Frame", 0) == 0)
  {
    return { "fixedpoint", "identity" };
  }
  if (name.rfind("Blend", 0) == 0 || name.rfind("Composite", 0) == 0)
  {
    return { group.FindRow("fixedpoint") ? "fixedpoint" : "gpu", "identity" };
  }
  if (name.rfind("Drag", 0) == 0)
  {
    return { "grid", "bspline" };
  }
  if (name.rfind("Resample", 0) == 0)
  {
    return { "reslice", "reslice_inverse" };
  }
  return { name.rfind("Edit", 0) == 0 ? "tiny_frame" : "gather", "" };
}

//------------------------------------------------------------------------------
/// Returns the number of refused rows.
int PrintTable(const std::vector<std::unique_ptr<Group>>& groups)
{
  int refused = 0;
  std::printf("\nMedians; ratios of medians within the group, in brackets those of processor time "
              "(all threads)\n");
  for (const auto& group : groups)
  {
    if (!group->IsMeasured())
    {
      continue;
    }
    const auto references = GetReferences(*group);
    std::printf("\n%s\n  %-18s %10s %10s  %-16s %-16s %8s %8s %8s %8s %7s\n",
      group->GetName().c_str(), "", "ms", "cpu ms", (std::string("x ") + references.first).c_str(),
      *references.second ? (std::string("x ") + references.second).c_str() : "", "samples",
      "lookups", "evals", "segment", "image");
    for (const Row& row : group->GetRows())
    {
      if (!row.Refusal.empty())
      {
        std::printf("  %-18s refused: %s\n", row.Name.c_str(), row.Refusal.c_str());
        ++refused;
        continue;
      }
      const auto ratio = [&group, &row](const char* by) {
        const double wall = group->GetRatio(row.Name, by);
        return std::isnan(wall)
          ? std::string()
          : Cell(wall, 3) + " (" + Cell(GetCpuRatio(*group, row, by), 3) + ")";
      };
      std::printf("  %-18s %10.3f %10.3f  %-16s %-16s %8s %8s %8s %8s %7s\n", row.Name.c_str(),
        1e3 * row.GetMedian(), 1e3 * row.GetCpuMedian(), ratio(references.first).c_str(),
        ratio(references.second).c_str(), Cell(GetCounter(row, "samples_per_ray"), 2).c_str(),
        Cell(GetCounter(row, "lookups_per_ray"), 2).c_str(),
        Cell(GetCounter(row, "evaluations_per_ray"), 2).c_str(),
        Cell(GetCounter(row, "segment_length"), 2).c_str(),
        Cell(GetCounter(row, "image_mean_difference"), 3).c_str());
    }
  }
  return refused;
}

std::vector<ffdBenchmark::Target> PrintedTargets;

//------------------------------------------------------------------------------
void PrintTarget(const std::string& what, double figure, double target, bool atMost = true)
{
  if (!std::isnan(figure))
  {
    PrintedTargets.push_back({ what, figure, target, atMost });
    std::printf("  %-70s %8.3f  %s %-6g %s\n", what.c_str(), figure, atMost ? "<=" : ">=", target,
      (atMost ? figure <= target : figure >= target) ? "met" : "MISSED");
  }
}

//------------------------------------------------------------------------------
void PrintTargets(const std::vector<std::unique_ptr<Group>>& groups)
{
  std::printf("\nTargets (rows that were measured)\n");
  std::map<std::string, const Group*> byName;
  for (const auto& group : groups)
  {
    if (!group->IsMeasured())
    {
      continue;
    }
    const std::string& name = group->GetName();
    byName[name] = group.get();
    if (name.rfind("Frame", 0) == 0)
    {
      PrintTarget(name + " identity / fixedpoint", group->GetRatio("identity", "fixedpoint"), 0.30);
      if (name.find("/smooth45") != std::string::npos)
      {
        for (const char* row : { "exact", "firstorder" })
        {
          PrintTarget(name + " " + row + " / fixedpoint", group->GetRatio(row, "fixedpoint"), 0.45);
          PrintTarget(name + " " + row + " / identity", group->GetRatio(row, "identity"), 1.6);
        }
      }
    }
    else if (name.rfind("WidgetDrag", 0) == 0)
    {
      // 30 frames a second at full quality, 20 while quality may drop.
      const char* const row = name == "WidgetDrag/opaque" ? "full" : "interactive";
      const Row* drag = group->FindRow(row);
      if (drag)
      {
        PrintTarget(name + " " + row + ", ms from mouse move to picture", 1e3 * drag->GetMedian(),
          name == "WidgetDrag/opaque" ? 1e3 / 30.0 : 1e3 / 20.0);
      }
    }
    else if (name.rfind("Drag", 0) == 0)
    {
      const double gain = group->GetRatio("grid", "exact");
      if (name == "Drag/256")
      {
        PrintTarget(name + " grid / exact", gain, 60.0, false);
      }
      else if (!std::isnan(gain))
      {
        std::printf("  %-70s %8.3f\n", (name + " grid / exact").c_str(), gain);
      }
    }
    else if (name.rfind("Edit", 0) == 0)
    {
      const Row* still = group->FindRow("tiny_frame");
      const Row* edited = group->FindRow("transfer_edit");
      if (still && edited && name == "Edit/256")
      {
        PrintTarget(name + " a transfer function edit adds, ms",
          1e3 * (edited->GetMedian() - still->GetMedian()), 20.0);
      }
    }
    else if (name.rfind("Resample", 0) == 0)
    {
      PrintTarget(name + " reslice / pullback", group->GetRatio("reslice", "pullback"),
        ffdBenchmark::ResampleGain, false);
      PrintTarget(name + " reslice_inverse / exact", group->GetRatio("reslice_inverse", "exact"),
        ffdBenchmark::ResampleGain, false);
    }
    else if (const Row* gather = group->FindRow("gather"))
    {
      const double limit = GetCounter(*gather, "samples") / gather->GetMedian();
      std::printf("  bare trilinear gather loop (%s): %.0f million samples a second\n",
        ffdBenchmark::GetGatherTarget(), 1e-6 * limit);
      for (const Row& row : group->GetRows())
      {
        if (&row != gather)
        {
          PrintTarget("Limit " + row.Name + ", part of the bare loop's samples a second",
            GetCounter(row, "samples") / row.GetMedian() / limit, 0.5, false);
        }
      }
    }
    for (const Row& row : group->GetRows())
    {
      if (row.Name == "exact" || row.Name == "tiny_frame")
      {
        PrintTarget(name + " " + row.Name + " memory besides the volume, %",
          GetCounter(row, "auxiliary_percent"), 5.0);
      }
    }
  }
  for (const auto& step : { std::make_pair("Drag/128", "Drag/256"), { "Drag/256", "Drag/512" } })
  {
    if (byName.count(step.first) && byName.count(step.second))
    {
      for (const char* name : { "exact", "firstorder", "grid", "bspline" })
      {
        const Row* small = byName[step.first]->FindRow(name);
        const Row* large = byName[step.second]->FindRow(name);
        if (small && large)
        {
          const double growth = large->GetMedian() / small->GetMedian();
          const std::string what = std::string(step.second) + " / " + step.first + " " + name;
          if (name[0] == 'e' || name[0] == 'f')
          {
            PrintTarget(what, growth, 2.0);
          }
          else
          {
            std::printf("  %-70s %8.3f\n", what.c_str(), growth);
          }
        }
      }
    }
  }
}

//------------------------------------------------------------------------------
/// The value of an option --name=value; null: the argument is another one.
const char* GetValue(const char* argument, const char* name)
{
  const std::size_t length = std::strlen(name);
  return std::strncmp(argument, name, length) == 0 ? argument + length : nullptr;
}

} // namespace

//------------------------------------------------------------------------------
int main(int argc, char* argv[])
{
  ffdBenchmark::Options options;
  const char* folder = std::getenv("FFD_TEST_DATA");
  options.DataFolder = folder ? folder : FFD_BENCHMARK_DATA;
  bool onlyTargets = false;
  std::string json;
  int kept = 1;
  for (int i = 1; i < argc; ++i)
  {
    if (std::strcmp(argv[i], "--help") == 0)
    {
      std::cout << Usage;
      return EXIT_SUCCESS;
    }
    if (std::strcmp(argv[i], "--quick") == 0)
    {
      options.Quick = true;
    }
    else if (std::strcmp(argv[i], "--targets") == 0)
    {
      onlyTargets = true;
    }
    else if (const char* file = GetValue(argv[i], "--json="))
    {
      json = file;
    }
    else if (const char* only = GetValue(argv[i], "--only="))
    {
      ffdBenchmark::SetSelection(only);
    }
    else if (const char* rounds = GetValue(argv[i], "--rounds="))
    {
      options.Rounds = std::max(1, std::atoi(rounds));
    }
    else if (const char* data = GetValue(argv[i], "--data="))
    {
      options.DataFolder = data;
    }
    else
    {
      argv[kept++] = argv[i];
    }
  }
#if defined(__unix__) && !defined(__APPLE__)
  const char* display = std::getenv("DISPLAY");
  if (!display || !*display)
  {
    std::cerr << "ffd_benchmark draws into windows and needs an X display, but DISPLAY is not set. "
                 "Run it under Module/CMake/with-xvfb.sh.\n";
    return EXIT_FAILURE;
  }
#endif
  benchmark::Initialize(&kept, argv);
  if (benchmark::ReportUnrecognizedArguments(kept, argv))
  {
    std::cerr << Usage;
    return EXIT_FAILURE;
  }
  const auto groups =
    onlyTargets ? ffdBenchmark::MakeTargetGroups(options) : ffdBenchmark::MakeGroups(options);
  if (groups.empty())
  {
    std::cerr << "ffd_benchmark: no row matches --only.\n";
    return EXIT_FAILURE;
  }
  if (onlyTargets)
  {
    for (const auto& group : groups)
    {
      std::cerr << group->GetName() << "\n";
      group->Measure();
      for (const Row& row : group->GetRows())
      {
        std::fprintf(stderr, "  %-34s %9.2f ms, %9.2f ms of processor time\n", row.Name.c_str(),
          1e3 * row.GetMedian(), 1e3 * row.GetCpuMedian());
      }
    }
    PrintedTargets = ffdBenchmark::FindTargets(groups);
    ffdBenchmark::PrintTargetPage(groups, PrintedTargets);
  }
  else
  {
    Register(groups);
    benchmark::RunSpecifiedBenchmarks();
    const int refused = PrintTable(groups);
    PrintTargets(groups);
    if (refused > 0)
    {
      std::printf("\n%d rows were refused.\n", refused);
    }
  }
  benchmark::Shutdown();
  if (!json.empty() && !ffdBenchmark::WriteTargets(json, PrintedTargets))
  {
    std::cerr << "ffd_benchmark: cannot write " << json << ".\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
