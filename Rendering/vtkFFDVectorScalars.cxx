// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVectorScalars.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"

#include <cmath>

namespace ffd
{
namespace
{

struct Scalarize
{
  template <class From, class To>
  void operator()(From* vectors, To* scalars, int component, const ParallelFor& parallelFor) const
  {
    parallelFor(static_cast<std::size_t>(vectors->GetNumberOfTuples()),
      [vectors, scalars, component](std::size_t first, std::size_t last) {
        const auto from = vtk::DataArrayTupleRange(
          vectors, static_cast<vtkIdType>(first), static_cast<vtkIdType>(last));
        auto to = vtk::DataArrayValueRange<1>(
          scalars, static_cast<vtkIdType>(first), static_cast<vtkIdType>(last));
        auto out = to.begin();
        for (const auto tuple : from)
        {
          if (component >= 0)
          {
            *out++ = static_cast<vtk::GetAPIType<To>>(tuple[component]);
            continue;
          }
          double square = 0.0;
          for (const auto value : tuple)
          {
            square += static_cast<double>(value) * static_cast<double>(value);
          }
          *out++ = static_cast<vtk::GetAPIType<To>>(std::sqrt(square));
        }
      });
  }
};

} // namespace

//------------------------------------------------------------------------------
Made MakeVectorScalars(vtkSmartPointer<vtkDataArray>& scalars, StageTools& tools,
  const Source<vtkDataArray>& source, std::uint64_t, int component)
{
  // An observer of the progress may take the vectors away from their data set.
  const vtkSmartPointer<vtkDataArray> vectors(source.Object);
  const bool exact = vectors->GetDataTypeSize() <= 2 || vectors->GetDataType() == VTK_FLOAT;
  scalars.TakeReference(component >= 0
      ? vtkDataArray::CreateDataArray(vectors->GetDataType())
      : vtkDataArray::CreateDataArray(exact ? VTK_FLOAT : VTK_DOUBLE));
  scalars->SetName(vectors->GetName());
  scalars->SetNumberOfTuples(vectors->GetNumberOfTuples());
  const Scalarize worker;
  if (component >= 0)
  {
    if (!vtkArrayDispatch::Dispatch2SameValueType::Execute(
          vectors.Get(), scalars.Get(), worker, component, tools.Parallel))
    {
      worker(vectors.Get(), scalars.Get(), component, tools.Parallel);
    }
  }
  else if (!vtkArrayDispatch::Dispatch2ByValueType<vtkArrayDispatch::AllTypes,
             vtkArrayDispatch::Reals>::Execute(vectors.Get(), scalars.Get(), worker, component,
             tools.Parallel))
  {
    worker(vectors.Get(), scalars.Get(), component, tools.Parallel);
  }
  return Made::Anew;
}

} // namespace ffd
