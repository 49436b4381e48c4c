// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTransformSampler.h"

#include "FFDGridIndex.h"

#include "vtkAbstractTransform.h"
#include "vtkGeneralTransform.h"
#include "vtkHomogeneousTransform.h"
#include "vtkSmartPointer.h"
#include "vtkWarpTransform.h"

#include <atomic>
#include <cmath>
#include <cstddef>

namespace
{

/// Whether threads may transform points at the same time: VTK's filters do so with any transform,
/// but messages, and what observes them, belong to the thread that runs the program.
bool IsWithoutMessages(vtkAbstractTransform* transform)
{
  if (vtkGeneralTransform* const general = vtkGeneralTransform::SafeDownCast(transform))
  {
    for (int i = 0; i < general->GetNumberOfConcatenatedTransforms(); ++i)
    {
      if (!IsWithoutMessages(general->GetConcatenatedTransform(i)))
      {
        return false;
      }
    }
    return true;
  }
  vtkWarpTransform* const warp = vtkWarpTransform::SafeDownCast(transform);
  return warp ? warp->GetInverseFlag() == 0
              : vtkHomogeneousTransform::SafeDownCast(transform) != nullptr;
}

} // namespace

//------------------------------------------------------------------------------
ffd::DisplacementSampler vtkFFDMakeTransformSampler(
  vtkAbstractTransform* transform, const ffd::ParallelFor& parallelFor)
{
  // Observers of the progress of a fit may let go of the transform.
  const vtkSmartPointer<vtkAbstractTransform> keep(transform);
  return [keep, parallelFor](const glm::ivec3& count, const glm::dvec3& first,
           const glm::dvec3& step, std::vector<glm::dvec3>& displacements) {
    keep->Update();
    displacements.resize(ffd::GridSize(count));
    std::atomic<bool> finite{ true };
    const auto sampleRows = [&](std::size_t from, std::size_t to) {
      for (std::size_t row = from; row < to; ++row)
      {
        const int j = static_cast<int>(row) % count.y;
        const int k = static_cast<int>(row) / count.y;
        for (int i = 0; i < count.x; ++i)
        {
          const glm::dvec3 position = first + glm::dvec3(i, j, k) * step;
          glm::dvec3 moved;
          keep->InternalTransformPoint(&position.x, &moved.x);
          if (!(std::isfinite(moved.x) && std::isfinite(moved.y) && std::isfinite(moved.z)))
          {
            finite = false;
          }
          displacements[ffd::GridIndex(i, j, k, count)] = moved - position;
        }
      }
    };
    const std::size_t rows = displacements.size() / static_cast<std::size_t>(count.x);
    (IsWithoutMessages(keep) ? parallelFor : ffd::ParallelFor())(rows, sampleRows);
    return finite.load();
  };
}
