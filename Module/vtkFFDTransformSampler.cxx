// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTransformSampler.h"

#include "FFDGridIndex.h"

#include "vtkFFDLatticeData.h"

#include "vtkAbstractTransform.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"

#include <cmath>

//------------------------------------------------------------------------------
ffd::DisplacementSampler vtkFFDMakeTransformSampler(vtkAbstractTransform* transform)
{
  // Observers of the progress of a fit may let go of the transform.
  const vtkSmartPointer<vtkAbstractTransform> keep(transform);
  return [keep](const glm::ivec3& count, const glm::dvec3& first, const glm::dvec3& step,
           std::vector<glm::dvec3>& displacements) {
    std::vector<glm::dvec3> positions;
    positions.reserve(ffd::GridSize(count));
    for (int k = 0; k < count.z; ++k)
    {
      for (int j = 0; j < count.y; ++j)
      {
        for (int i = 0; i < count.x; ++i)
        {
          positions.push_back(first + glm::dvec3(i, j, k) * step);
        }
      }
    }
    // VTK reads the positions where they lie.
    vtkNew<vtkDoubleArray> array;
    array->SetNumberOfComponents(3);
    array->SetArray(&positions[0].x, 3 * static_cast<vtkIdType>(positions.size()), 1);
    vtkNew<vtkPoints> in;
    vtkNew<vtkPoints> out;
    in->SetData(array);
    out->SetDataTypeToDouble();
    keep->TransformPoints(in, out);
    displacements = vtkFFDCopyTuples(out->GetData());
    bool finite = true;
    for (std::size_t i = 0; i < positions.size(); ++i)
    {
      const glm::dvec3& to = displacements[i];
      finite = finite && std::isfinite(to.x) && std::isfinite(to.y) && std::isfinite(to.z);
      displacements[i] -= positions[i];
    }
    return finite;
  };
}
