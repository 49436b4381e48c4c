// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDGuard.h"

#include "vtkInformation.h"
#include "vtkInformationIntegerVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkObject.h"
#include "vtkSetGet.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#if defined(__linux__)
#include <sys/resource.h>
#include <unistd.h>
#else
#include "vtksys/SystemInformation.hxx"
#endif

namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

/// Less than this is not worth a look at what there is.
constexpr double SmallAllocation = 16.0 * 1048576.0;

/// An allocation that was seen to be too large before it was made.
class MemoryError : public std::bad_alloc
{
public:
  explicit MemoryError(std::string message)
    : Message(std::move(message))
  {
  }
  const char* what() const noexcept override { return this->Message.c_str(); }

private:
  std::string Message;
};

std::string DescribeBytes(double bytes)
{
  const char* const units[] = { "bytes", "kB", "MB", "GB", "TB", "PB", "EB" };
  int unit = 0;
  while (bytes >= 999.5 && unit < 6)
  {
    bytes /= 1000.0;
    ++unit;
  }
  char text[64];
  std::snprintf(text, sizeof(text), "%.3g %s", bytes, units[unit]);
  return text;
}

#if defined(__linux__)

/// The number after `key` (empty: at the start) in a small text file; infinity without one, as in
/// a control group's "max".
double ReadNumber(const std::string& path, const std::string& key)
{
  std::ifstream file(path);
  std::string word;
  double number = 0.0;
  while (!key.empty() && file >> word && word != key)
  {
  }
  return file >> number ? number : Infinity;
}

/// The memory that the control groups of a process, from its own up to the root, leave it.
double FindGroupMemory(const std::string& root, std::string group, const char* limitName,
  const char* usageName, const char* cacheKey)
{
  double available = Infinity;
  for (;;)
  {
    const std::string folder = root + group + "/";
    const double limit = ReadNumber(folder + limitName, "");
    const double usage = ReadNumber(folder + usageName, "");
    const double cache = ReadNumber(folder + "memory.stat", cacheKey);
    if (limit < Infinity && usage < Infinity)
    {
      // Files that were read count as used, until somebody needs the memory.
      available =
        std::min(available, std::max(0.0, limit - usage + (cache < Infinity ? cache : 0.0)));
    }
    if (group.empty())
    {
      return available;
    }
    group.resize(group.rfind('/'));
  }
}

double FindSystemMemory()
{
  double available = 1024.0 * ReadNumber("/proc/meminfo", "MemAvailable:");
  const double swap = 1024.0 * ReadNumber("/proc/meminfo", "SwapFree:");
  available += swap < Infinity ? swap : 0.0;
  // Lines "4:memory:/group" (version 1), "0::/group" (version 2).
  std::ifstream groups("/proc/self/cgroup");
  std::string line;
  while (std::getline(groups, line))
  {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (second == std::string::npos)
    {
      continue;
    }
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    std::string group = line.substr(second + 1);
    group = group == "/" ? "" : group;
    if (controllers == ",,")
    {
      available = std::min(available,
        FindGroupMemory("/sys/fs/cgroup", group, "memory.max", "memory.current", "inactive_file"));
    }
    else if (controllers.find(",memory,") != std::string::npos)
    {
      available = std::min(available,
        FindGroupMemory("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes",
          "memory.usage_in_bytes", "total_inactive_file"));
    }
  }
  return available;
}

/// The memory that the limits of the process on its address space and its data leave.
double FindProcessMemory()
{
  double available = Infinity;
  std::ifstream file("/proc/self/statm");
  double pages[7] = {};
  for (double& count : pages)
  {
    file >> count;
  }
  const double pageSize = static_cast<double>(sysconf(_SC_PAGESIZE));
  rlimit limit;
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
  {
    available = std::min(available, static_cast<double>(limit.rlim_cur) - pages[0] * pageSize);
  }
  if (getrlimit(RLIMIT_DATA, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
  {
    available = std::min(available, static_cast<double>(limit.rlim_cur) - pages[5] * pageSize);
  }
  return std::max(0.0, available);
}

#else

double FindSystemMemory()
{
  vtksys::SystemInformation information;
  information.QueryMemory();
  const double megabytes = static_cast<double>(information.GetAvailablePhysicalMemory());
  return megabytes > 0.0 ? megabytes * 1048576.0 : Infinity;
}

double FindProcessMemory() { return Infinity; }

#endif

} // namespace

//------------------------------------------------------------------------------
double vtkFFDAvailableMemory() { return std::min(FindSystemMemory(), FindProcessMemory()); }

//------------------------------------------------------------------------------
void vtkFFDRequireMemory(double bytes, const std::string& what, const std::string& advice)
{
  if (bytes <= SmallAllocation)
  {
    return;
  }
  const double available = vtkFFDAvailableMemory();
  // The negation also catches what is not a number.
  if (!(bytes <= available))
  {
    throw MemoryError(what + " take " + DescribeBytes(bytes) + " of memory, and only " +
      DescribeBytes(available) + " are available. " + advice);
  }
}

//------------------------------------------------------------------------------
bool vtkFFDGuard(vtkObject* self, const char* where, const std::function<void()>& work)
{
  std::string problem;
  try
  {
    work();
    return true;
  }
  catch (const MemoryError& error)
  {
    problem = error.what();
  }
  catch (const std::exception& error)
  {
    // The allocators of VTK and of the standard library do not say how much was asked for.
    const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
      dynamic_cast<const std::length_error*>(&error) != nullptr;
    problem = memory ? "more memory was needed than the " + DescribeBytes(vtkFFDAvailableMemory()) +
        " that are available. Use smaller data."
                     : std::string("an unexpected error ended it: ") + error.what() + ".";
  }
  catch (...)
  {
    problem = "an unexpected error ended it.";
  }
  vtkErrorWithObjectMacro(self, << where << ": " << problem);
  return false;
}

//------------------------------------------------------------------------------
int vtkFFDGuardedRequest(vtkObject* self, const char* where, vtkInformationVector* outputs,
  const std::function<int()>& work)
{
  const int result = vtkFFDGuarded(self, where, 0, work);
  for (int i = 0; result == 0 && i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    // The executive unites extents that were asked for until they are made: one that is too large
    // must not stay among them.
    outputs->GetInformationObject(i)->Remove(
      vtkStreamingDemandDrivenPipeline::COMBINED_UPDATE_EXTENT());
  }
  return result;
}

//------------------------------------------------------------------------------
bool vtkFFDIsInverseTolerance(vtkObject* self, double tolerance)
{
  const bool usable = std::isfinite(tolerance) && tolerance > 0.0;
  if (!usable)
  {
    vtkErrorWithObjectMacro(
      self, "SetInverseTolerance: the tolerance is " << tolerance << ". Give a positive distance.");
  }
  return usable;
}

//------------------------------------------------------------------------------
bool vtkFFDIsInverseIterations(vtkObject* self, int iterations)
{
  if (iterations < 1)
  {
    vtkErrorWithObjectMacro(
      self, "SetInverseIterations: the number is " << iterations << ". Give 1 or more.");
  }
  return iterations >= 1;
}
