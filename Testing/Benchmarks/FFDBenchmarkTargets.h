// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What the ray caster is to reach, measured in one run and reported on one page.
#ifndef FFDBenchmarkTargets_h
#define FFDBenchmarkTargets_h

#include "FFDBenchmarkSuites.h"

#include <memory>
#include <string>
#include <vector>

namespace ffdBenchmark
{

/// A figure, and what it should be.
struct Target
{
  std::string Name;
  double Figure; ///< NaN: not measured
  double Limit;  ///< NaN: there is none, the figure is for other tables
  bool AtMost = true;

  bool HasLimit() const;
  bool IsMet() const;
};

/**
 * The groups of --targets: Targets/<volume>/<opacity>/<size> (frames of six shapes, EXACT and
 * FIRST_ORDER, and what they are compared with, all in turns), Targets/vectors/<opacity> (AVX2 by
 * AVX-512, if the machine has both), Options/<volume>/<deformation> (what users switch on),
 * Sizes/<side>/<type> (first frames and frames), Errors/<volume> (by distances of samples),
 * Cores/<opacity>/<size>/<scene> (by numbers of threads),
 * Folds/<volume> (shapes that fold by weaker ones),
 * Lattices/<volume> (many control points by few),
 * Targets/paper (counts), Drag and WidgetDrag.
 */
std::vector<std::unique_ptr<Group>> MakeTargetGroups(const Options& options);

/// The figures of groups that were measured.
std::vector<Target> FindTargets(const std::vector<std::unique_ptr<Group>>& groups);

/// One page: a table of the frames, the other figures, and how many targets are met.
void PrintTargetPage(
  const std::vector<std::unique_ptr<Group>>& groups, const std::vector<Target>& targets);

/// An array of objects "name", "figure" (null: not measured), and, where there is a target,
/// "target", "at_most" and "met". False: the file could not be written.
bool WriteTargets(const std::string& path, const std::vector<Target>& targets);

} // namespace ffdBenchmark

#endif
