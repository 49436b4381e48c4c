// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTransformSampler.h"

#include "vtkFFDSplineTransform.h"
#include "vtkFFDSumTransform.h"

#include "vtkAbstractTransform.h"
#include "vtkBSplineTransform.h"
#include "vtkGeneralTransform.h"
#include "vtkGridTransform.h"
#include "vtkHomogeneousTransform.h"
#include "vtkImageData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkThinPlateSplineTransform.h"
#include "vtkWarpTransform.h"

#include <glm/common.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <vector>

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

/// The absolute spacing of a grid; 0 without one.
glm::dvec3 GetSpacing(vtkImageData* grid)
{
  glm::dvec3 spacing(0.0);
  if (grid)
  {
    grid->GetSpacing(&spacing.x);
  }
  return glm::abs(spacing);
}

/// The sizes of the details of a transform along the axes; 0 where they are not known.
class Details
{
public:
  /// Includes those of a transform, as ffd::DisplacementSampler has them.
  void Include(vtkAbstractTransform* transform)
  {
    if (auto* const general = vtkGeneralTransform::SafeDownCast(transform))
    {
      for (int i = 0; i < general->GetNumberOfConcatenatedTransforms(); ++i)
      {
        this->IncludePart(general->GetConcatenatedTransform(i));
      }
    }
    else if (auto* const sum = vtkFFDSumTransform::SafeDownCast(transform))
    {
      for (int i = 0; i < sum->GetNumberOfTransforms(); ++i)
      {
        this->Include(sum->GetTransform(i));
      }
    }
    else if (auto* const displacements = vtkGridTransform::SafeDownCast(transform))
    {
      displacements->Update();
      this->IncludeSpacing(GetSpacing(displacements->GetDisplacementGrid()));
    }
    else if (auto* const spline = vtkFFDSplineTransform::SafeDownCast(transform))
    {
      this->IncludeSpacing(GetSpacing(spline->GetDisplacementGrid()));
    }
    else if (auto* const bspline = vtkBSplineTransform::SafeDownCast(transform))
    {
      bspline->Update();
      this->IncludeSpacing(GetSpacing(bspline->GetCoefficientData()));
    }
  }

  const glm::dvec3& GetSmallest() const { return this->Smallest; }

private:
  /// What turns or scales the others' may do so to this one's.
  void IncludePart(vtkAbstractTransform* part)
  {
    Details details;
    details.Include(part);
    double least = 0.0;
    for (int a = 0; a < 3; ++a)
    {
      const double size = details.Smallest[a];
      least = size > 0.0 && (least == 0.0 || size < least) ? size : least;
    }
    this->IncludeSpacing(glm::dvec3(least));
  }

  void IncludeSpacing(const glm::dvec3& spacing)
  {
    for (int a = 0; a < 3; ++a)
    {
      double& smallest = this->Smallest[a];
      if (spacing[a] > 0.0 && std::isfinite(spacing[a]))
      {
        smallest = smallest > 0.0 ? std::min(smallest, spacing[a]) : spacing[a];
      }
    }
  }

  glm::dvec3 Smallest{ 0.0 };
};

/// The landmarks that a thin-plate spline moves; none of other transforms.
std::vector<glm::dvec3> FindLandmarks(vtkAbstractTransform* transform)
{
  std::vector<glm::dvec3> places;
  auto* const spline = vtkThinPlateSplineTransform::SafeDownCast(transform);
  vtkPoints* const points = !spline ? nullptr
    : spline->GetInverseFlag() != 0 ? spline->GetTargetLandmarks()
                                    : spline->GetSourceLandmarks();
  for (vtkIdType i = 0; points && i < points->GetNumberOfPoints(); ++i)
  {
    glm::dvec3 place;
    points->GetPoint(i, &place.x);
    places.push_back(place);
  }
  return places;
}

} // namespace

//------------------------------------------------------------------------------
ffd::DisplacementSampler vtkFFDMakeTransformSampler(
  vtkAbstractTransform* transform, const ffd::ParallelFor& parallelFor)
{
  transform->Update();
  Details details;
  details.Include(transform);
  ffd::DisplacementSampler sampler;
  sampler.Detail = details.GetSmallest();
  sampler.Places = FindLandmarks(transform);
  // Observers of the progress of a fit may let go of the transform.
  const vtkSmartPointer<vtkAbstractTransform> keep(transform);
  sampler.Sample = [keep, parallelFor](const std::vector<glm::dvec3>& points,
                     std::vector<glm::dvec3>& displacements) {
    keep->Update();
    displacements.resize(points.size());
    std::atomic<bool> finite{ true };
    const auto sample = [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i)
      {
        glm::dvec3 moved;
        keep->InternalTransformPoint(&points[i].x, &moved.x);
        if (!(std::isfinite(moved.x) && std::isfinite(moved.y) && std::isfinite(moved.z)))
        {
          finite = false;
        }
        displacements[i] = moved - points[i];
      }
    };
    (IsWithoutMessages(keep) ? parallelFor : ffd::ParallelFor())(points.size(), sample);
    return finite.load();
  };
  return sampler;
}
