// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDArrayRanges.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationInformationVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace
{

/// Least and largest value; empty if the first is the larger one.
template <class T>
struct Range
{
  using Limits = std::numeric_limits<T>;
  T Min = Limits::has_infinity ? Limits::infinity() : Limits::max();
  T Max = Limits::has_infinity ? -Limits::infinity() : Limits::lowest();

  /// Leaves out what is not a number.
  void Add(T value)
  {
    this->Min = value < this->Min ? value : this->Min;
    this->Max = value > this->Max ? value : this->Max;
  }

  bool IsFinite() const
  {
    return std::isfinite(static_cast<double>(this->Min)) &&
      std::isfinite(static_cast<double>(this->Max));
  }
};

template <class T>
Range<T> FindRange(const T* values, std::size_t count, std::size_t stride)
{
  Range<T> range;
  std::size_t i = 0;
  if (stride == 1)
  {
    // Several ranges at once: the compiler keeps them in vectors.
    constexpr std::size_t lanes = 64 / sizeof(T);
    std::array<T, lanes> least;
    std::array<T, lanes> largest;
    least.fill(range.Min);
    largest.fill(range.Max);
    for (; i + lanes <= count; i += lanes)
    {
      for (std::size_t lane = 0; lane < lanes; ++lane)
      {
        const T value = values[i + lane];
        least[lane] = value < least[lane] ? value : least[lane];
        largest[lane] = value > largest[lane] ? value : largest[lane];
      }
    }
    for (std::size_t lane = 0; lane < lanes; ++lane)
    {
      range.Add(least[lane]);
      range.Add(largest[lane]);
    }
  }
  for (; i < count; ++i)
  {
    range.Add(values[i * stride]);
  }
  return range;
}

/// Without infinities, and what is not a number.
template <class T>
Range<T> FindFiniteRange(const T* values, std::size_t count, std::size_t stride)
{
  Range<T> range;
  for (std::size_t i = 0; i < count; ++i)
  {
    if (std::isfinite(static_cast<double>(values[i * stride])))
    {
      range.Add(values[i * stride]);
    }
  }
  return range;
}

/// Where arrays keep the ranges of their components until they are modified.
template <class T>
void Keep(
  vtkDataArray* array, vtkInformationInformationVectorKey* key, const std::vector<Range<T>>& ranges)
{
  vtkNew<vtkInformationVector> all;
  all->SetNumberOfInformationObjects(static_cast<int>(ranges.size()));
  for (std::size_t c = 0; c < ranges.size(); ++c)
  {
    const double range[2] = { static_cast<double>(ranges[c].Min),
      static_cast<double>(ranges[c].Max) };
    all->GetInformationObject(static_cast<int>(c))->Set(vtkDataArray::COMPONENT_RANGE(), range, 2);
  }
  array->GetInformation()->Set(key, all);
}

struct FindRanges
{
  template <class T>
  void operator()(vtkAOSDataArrayTemplate<T>* array) const
  {
    const auto count = static_cast<std::size_t>(array->GetNumberOfTuples());
    const auto components = static_cast<std::size_t>(array->GetNumberOfComponents());
    std::vector<Range<T>> ranges;
    std::vector<Range<T>> finite;
    for (std::size_t c = 0; c < components; ++c)
    {
      const T* values = array->GetPointer(0) + c;
      ranges.push_back(FindRange(values, count, components));
      finite.push_back(
        ranges.back().IsFinite() ? ranges.back() : FindFiniteRange(values, count, components));
      if (!(finite.back().Min <= finite.back().Max))
      {
        return; // there is none: what VTK says of that is its own
      }
    }
    Keep(array, vtkAbstractArray::PER_COMPONENT(), ranges);
    Keep(array, vtkAbstractArray::PER_FINITE_COMPONENT(), finite);
  }

  /// Of other layouts.
  void operator()(vtkDataArray*) const {}
};

} // namespace

//------------------------------------------------------------------------------
void vtkFFDFindArrayRanges(vtkDataSetAttributes* attributes)
{
  for (int i = 0; i < attributes->GetNumberOfArrays(); ++i)
  {
    if (vtkDataArray* array = attributes->GetArray(i))
    {
      vtkArrayDispatch::Dispatch::Execute(array, FindRanges());
    }
  }
}
