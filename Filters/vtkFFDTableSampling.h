// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed.
#ifndef vtkFFDTableSampling_h
#define vtkFFDTableSampling_h

#include "FFDMinMaxBlocks.h"

#include "vtkFFDFiltersModule.h" // For export macro

#include <functional>

/// Where functions of the scalars are sampled for a ffd::TransferTable.
struct vtkFFDTableSampling
{
  double Low;
  double High; ///< > Low
  int Size;
};

/**
 * The sampling for scalars in `range`. Whole numbers are met exactly where the range allows. If the
 * functions are constant beyond nodes[0] ... nodes[1] (not null), no entries are spent there.
 * `estimate(low, high)`: how many samples the functions need (EstimateMinNumberOfSamples()).
 */
VTKFFDFILTERS_EXPORT vtkFFDTableSampling vtkFFDFindTableSampling(
  const ffd::MinMaxBlocks::Limits& range, bool integers, const double* nodes,
  const std::function<int(double low, double high)>& estimate);

#endif
