// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVectorScalars.h"

#include "vtkFFDParallelFor.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"

#include <cmath>

namespace
{

struct Scalarize
{
  template <class From, class To>
  void operator()(
    From* vectors, To* scalars, int component, const vtkFFDParallelFor& parallelFor) const
  {
    parallelFor(static_cast<std::size_t>(vectors->GetNumberOfTuples()),
      [vectors, scalars, component](std::size_t first, std::size_t last)
      {
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
vtkDataArray* vtkFFDVectorScalars::Update(
  vtkDataArray* vectors, int component, const vtkFFDParallelFor& parallelFor)
{
  if (this->Scalars && this->Vectors == vectors && this->Time == vectors->GetMTime() &&
    this->Component == component)
  {
    return this->Scalars;
  }
  this->Vectors = vectors;
  this->Time = vectors->GetMTime();
  this->Component = component;
  const bool exact = vectors->GetDataTypeSize() <= 2 || vectors->GetDataType() == VTK_FLOAT;
  this->Scalars.TakeReference(component >= 0
      ? vtkDataArray::CreateDataArray(vectors->GetDataType())
      : vtkDataArray::CreateDataArray(exact ? VTK_FLOAT : VTK_DOUBLE));
  this->Scalars->SetName(vectors->GetName());
  this->Scalars->SetNumberOfTuples(vectors->GetNumberOfTuples());
  const Scalarize worker;
  if (component >= 0)
  {
    if (!vtkArrayDispatch::Dispatch2SameValueType::Execute(
          vectors, this->Scalars.Get(), worker, component, parallelFor))
    {
      worker(vectors, this->Scalars.Get(), component, parallelFor);
    }
  }
  else if (!vtkArrayDispatch::Dispatch2ByValueType<vtkArrayDispatch::AllTypes,
             vtkArrayDispatch::Reals>::Execute(
             vectors, this->Scalars.Get(), worker, component, parallelFor))
  {
    worker(vectors, this->Scalars.Get(), component, parallelFor);
  }
  return this->Scalars;
}

//------------------------------------------------------------------------------
void vtkFFDVectorScalars::Clear()
{
  *this = vtkFFDVectorScalars();
}

//------------------------------------------------------------------------------
std::size_t vtkFFDVectorScalars::GetMemorySize() const
{
  return this->Scalars ? static_cast<std::size_t>(this->Scalars->GetActualMemorySize()) * 1024 : 0;
}
