// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeOrder.h"

#include "vtkFFDCameraPlace.h"

#include "vtkCamera.h"
#include "vtkMath.h"
#include "vtkPropCollection.h"
#include "vtkPVLODVolume.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkVolume.h"
#include "vtkVolumeCollection.h"

#include <algorithm>
#include <array>
#include <vector>

namespace ffdorder
{
namespace
{

struct Placed
{
  vtkSmartPointer<vtkVolume> Volume;
  std::array<double, 6> Bounds;
  double Distance; // of the center, from the camera or along its direction
};

struct Eye : vtkFFDCameraPlace
{
  bool Parallel;

  explicit Eye(vtkCamera* camera)
    : vtkFFDCameraPlace(camera)
    , Parallel(camera->GetParallelProjection() != 0)
  {
  }
};

/// Whether a plane across an axis separates the two, and the camera is on the side of `a`, so that
/// `b` is nowhere in front of it.
bool IsBefore(const Placed& a, const Placed& b, const Eye& eye)
{
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const double below = a.Bounds[2 * axis + 1]; // a is below b
    const double above = a.Bounds[2 * axis];
    if (below <= b.Bounds[2 * axis] &&
      (eye.Parallel ? eye.Direction[axis] >= 0.0 : eye.Position[axis] <= b.Bounds[2 * axis]))
    {
      return true;
    }
    if (above >= b.Bounds[2 * axis + 1] &&
      (eye.Parallel ? eye.Direction[axis] <= 0.0 : eye.Position[axis] >= b.Bounds[2 * axis + 1]))
    {
      return true;
    }
  }
  return false;
}

/// Whether a prop is drawn with the volumes or after them, or not at all.
bool IsNotBeforeVolumes(vtkProp* prop)
{
  if (!prop->GetVisibility() || prop->IsA("vtkActor2D"))
  {
    return true;
  }
  if (auto* volume = vtkPVLODVolume::SafeDownCast(prop))
  {
    return volume->GetEnableLOD() == 0; // else it may be an outline
  }
  // ParaView keeps visible actors of representations that have no data.
  const double* bounds = prop->IsA("vtkActor") ? prop->GetBounds() : nullptr;
  return prop->IsA("vtkVolume") || (bounds && !vtkMath::AreBoundsInitialized(bounds));
}

} // namespace

//------------------------------------------------------------------------------
bool IsEmptyBeforeVolumes(vtkRenderer* renderer)
{
  if (renderer->GetGradientBackground() || renderer->GetTexturedBackground() ||
    renderer->GetPreserveColorBuffer() || !renderer->GetErase() || renderer->GetLayer() != 0)
  {
    return false;
  }
  vtkPropCollection* props = renderer->GetViewProps();
  vtkCollectionSimpleIterator place;
  props->InitTraversal(place);
  while (vtkProp* prop = props->GetNextProp(place))
  {
    if (!IsNotBeforeVolumes(prop))
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
void SortVolumes(vtkRenderer* renderer)
{
  const Eye eye(renderer->GetActiveCamera());
  std::vector<Placed> left;
  vtkVolumeCollection* volumes = renderer->GetVolumes();
  for (int i = 0; i < volumes->GetNumberOfItems(); ++i)
  {
    auto* volume = vtkVolume::SafeDownCast(volumes->GetItemAsObject(i));
    const double* bounds = volume && volume->GetVisibility() ? volume->GetBounds() : nullptr;
    if (!bounds || !vtkMath::AreBoundsInitialized(bounds))
    {
      continue;
    }
    Placed placed{ volume, {}, 0.0 };
    std::copy_n(bounds, 6, placed.Bounds.begin());
    double toCenter[3];
    for (int a = 0; a < 3; ++a)
    {
      toCenter[a] = 0.5 * (bounds[2 * a] + bounds[2 * a + 1]) - eye.Position[a];
    }
    placed.Distance =
      eye.Parallel ? vtkMath::Dot(toCenter, eye.Direction) : vtkMath::Norm(toCenter);
    left.push_back(placed);
  }
  if (left.size() < 2)
  {
    return;
  }
  // Those that nothing is behind of come first; of several the one farthest away.
  vtkPropCollection* props = renderer->GetViewProps();
  while (!left.empty())
  {
    auto next = left.end();
    bool nextIsLast = false;
    for (auto each = left.begin(); each != left.end(); ++each)
    {
      const bool isLast = std::none_of(left.begin(), left.end(), [&](const Placed& other) {
        return &other != &*each && IsBefore(*each, other, eye) && !IsBefore(other, *each, eye);
      });
      if (next == left.end() || (isLast && !nextIsLast) ||
        (isLast == nextIsLast && each->Distance > next->Distance))
      {
        next = each;
        nextIsLast = isLast;
      }
    }
    props->RemoveItem(next->Volume.Get());
    props->AddItem(next->Volume.Get());
    left.erase(next);
  }
}

} // namespace ffdorder
