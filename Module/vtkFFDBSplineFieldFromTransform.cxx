// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDBSplineFieldFromTransform.h"

#include "vtkFFDLatticeData.h"

#include "FFDBSplineField.h"
#include "FFDLattice.h"

#include "vtkBSplineTransform.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <cmath>
#include <sstream>
#include <vector>

//------------------------------------------------------------------------------
bool vtkFFDBSplineFieldFromTransform(
  vtkBSplineTransform* transform, ffd::BSplineField& field, bool& inverse, std::string& error)
{
  field = ffd::BSplineField();
  inverse = false;
  error.clear();
  if (!transform)
  {
    error = "the transform is null";
    return false;
  }
  transform->Update();
  inverse = transform->GetInverseFlag() != 0;
  vtkImageData* image = transform->GetCoefficientData();
  if (!image)
  {
    return true;
  }
  int extent[6];
  double origin[3];
  double spacing[3];
  image->GetExtent(extent);
  image->GetOrigin(origin);
  image->GetSpacing(spacing);
  glm::ivec3 nodes;
  glm::dvec3 first;
  glm::dvec3 step;
  for (int a = 0; a < 3; ++a)
  {
    nodes[a] = extent[2 * a + 1] - extent[2 * a] + 1;
    step[a] = spacing[a];
    first[a] = origin[a] + extent[2 * a] * spacing[a];
    if (nodes[a] < 1 || !(std::abs(spacing[a]) > 0.0) || !std::isfinite(spacing[a]) ||
      !std::isfinite(first[a]))
    {
      error = "the coefficient image is empty, or its spacing or origin is not usable";
      return false;
    }
  }
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  const vtkIdType count = static_cast<vtkIdType>(nodes.x) * nodes.y * nodes.z;
  if (!scalars || scalars->GetNumberOfComponents() != 3 || scalars->GetNumberOfTuples() != count)
  {
    error = "the coefficient image needs point scalars with 3 components, one per control point";
    return false;
  }
  const double scale = transform->GetDisplacementScale();
  const std::vector<glm::dvec3> displacements = vtkFFDCopyTuples(scalars);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const glm::dvec3 d = displacements[static_cast<std::size_t>(i)] * scale;
    // False for what is not a number, too.
    if (!(std::abs(d.x) <= ffd::Lattice::LargestLength &&
          std::abs(d.y) <= ffd::Lattice::LargestLength &&
          std::abs(d.z) <= ffd::Lattice::LargestLength))
    {
      std::ostringstream message;
      message << "control point (" << i % nodes.x << ", " << i / nodes.x % nodes.y << ", "
              << i / nodes.x / nodes.y
              << ") has a displacement that is not finite or exceeds 1e100";
      error = message.str();
      return false;
    }
  }
  field = ffd::BSplineField(nodes, first, step, displacements.data(), scale,
    static_cast<ffd::BorderMode>(transform->GetBorderMode()));
  return true;
}
