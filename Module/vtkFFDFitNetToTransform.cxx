// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFitNetToTransform.h"

#include "FFDLatticeFit.h"

#include "vtkAbstractTransform.h"
#include "vtkNew.h"
#include "vtkPoints.h"

#include <cmath>

//------------------------------------------------------------------------------
ffd::FitStatus vtkFFDFitNetToTransform(
  vtkAbstractTransform* transform, const ffd::FitLimits& limits, ffd::FittedNet& fit)
{
  const auto sample = [transform](const glm::ivec3& count, const glm::dvec3& first,
                        const glm::dvec3& step, std::vector<glm::dvec3>& displacements)
  {
    vtkNew<vtkPoints> in;
    vtkNew<vtkPoints> out;
    in->SetDataTypeToDouble();
    out->SetDataTypeToDouble();
    in->SetNumberOfPoints(static_cast<vtkIdType>(count.x) * count.y * count.z);
    vtkIdType id = 0;
    for (int k = 0; k < count.z; ++k)
    {
      for (int j = 0; j < count.y; ++j)
      {
        for (int i = 0; i < count.x; ++i)
        {
          in->SetPoint(
            id++, first.x + i * step.x, first.y + j * step.y, first.z + k * step.z);
        }
      }
    }
    transform->TransformPoints(in, out);
    displacements.resize(static_cast<std::size_t>(id));
    bool finite = true;
    for (vtkIdType i = 0; i < id; ++i)
    {
      double from[3];
      double to[3];
      in->GetPoint(i, from);
      out->GetPoint(i, to);
      finite = finite && std::isfinite(to[0]) && std::isfinite(to[1]) && std::isfinite(to[2]);
      displacements[static_cast<std::size_t>(i)] = { to[0] - from[0], to[1] - from[1],
        to[2] - from[2] };
    }
    return finite;
  };
  return ffd::FitNetToFunction(sample, limits, fit);
}
