// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumePicking.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDVolumePicker.h"

#include "vtkAbstractMapper.h"
#include "vtkCamera.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkVolume.h"

#include <cmath>

namespace
{

using ffdpicking::Picked;

/// Opacities of the surfaces that are picked: the second where the first is nowhere reached.
constexpr double PickedOpacities[2] = { 0.05, 0.005 };

/// Moves what was picked by a little along the ray: on a face of the volume rounding would decide
/// whether what is there can be probed.
void StepInside(vtkFFDVolumePicker* picker, const double from[3], const double to[3],
  std::array<double, 8>& picked)
{
  auto* mapper = vtkFFDInverseRayVolumeMapper::SafeDownCast(picker->GetMapper());
  vtkProp3D* volume = picker->GetProp3D();
  if (!mapper || !volume)
  {
    return;
  }
  double ray[3];
  vtkMath::Subtract(to, from, ray);
  vtkMath::Normalize(ray);
  double shown[4] = { 0.0, 0.0, 0.0, 1.0 };
  for (int a = 0; a < 3; ++a)
  {
    double& place = picked[static_cast<std::size_t>(1 + a)];
    place += 1e-6 * volume->GetLength() * ray[a];
    shown[a] = place;
  }
  vtkNew<vtkMatrix4x4> toData;
  vtkMatrix4x4::Invert(volume->GetMatrix(), toData);
  toData->MultiplyPoint(shown, shown);
  mapper->GetRestPosition(shown, &picked[4]);
}

/// The value of the first component of the scalars at a place in the data; 0 outside.
double Interpolate(vtkDataSet* data, vtkDataArray* scalars, double place[3])
{
  double parametric[3];
  double weights[8];
  int subId = 0;
  // On a face of the volume, too.
  const double tolerance = 1e-6 * data->GetLength();
  const vtkIdType cell =
    data->FindCell(place, nullptr, -1, tolerance * tolerance, subId, parametric, weights);
  double value = 0.0;
  if (cell >= 0 && scalars)
  {
    vtkNew<vtkIdList> points;
    data->GetCellPoints(cell, points);
    for (vtkIdType i = 0; i < points->GetNumberOfIds(); ++i)
    {
      value += weights[i] * scalars->GetComponent(points->GetId(i), 0);
    }
  }
  return value;
}

/**
 * What is seen of a volume along a ray, in whatever way it is blended: the depth of a picture of
 * one pixel. Sets `picked` as vtkFFDVolumeRepresentation::GetPicked() tells it; returns whether
 * there is anything.
 */
bool PickInPicture(vtkFFDInverseRayVolumeMapper* mapper, vtkVolume* volume, const double from[3],
  const double to[3], std::array<double, 8>& picked)
{
  auto* data = vtkDataSet::SafeDownCast(mapper->GetInputDataObject(0, 0));
  const double length = std::sqrt(vtkMath::Distance2BetweenPoints(from, to));
  if (!data || !(length > 0.0))
  {
    return false;
  }
  vtkNew<vtkRenderer> renderer;
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetPosition(from);
  camera->SetFocalPoint(to);
  const double along[3] = { to[0] - from[0], to[1] - from[1], to[2] - from[2] };
  double up[3];
  double right[3];
  vtkMath::Perpendiculars(along, up, right, 0.0);
  camera->SetViewUp(up);
  camera->SetParallelScale(1e-6 * length);
  camera->SetClippingRange(1e-6 * length, length);
  vtkNew<vtkImageData> colors;
  vtkNew<vtkImageData> depths;
  if (!mapper->RenderToImage(renderer, volume, 1, 1, colors, depths) ||
    colors->GetScalarComponentAsDouble(0, 0, 0, 3) == 0.0)
  {
    return false;
  }
  const double* range = camera->GetClippingRange();
  const double depth =
    range[0] + depths->GetScalarComponentAsDouble(0, 0, 0, 0) * (range[1] - range[0]);
  double shown[4] = { 0.0, 0.0, 0.0, 1.0 };
  for (int a = 0; a < 3; ++a)
  {
    shown[a] = from[a] + depth / length * along[a];
    picked[static_cast<std::size_t>(1 + a)] = shown[a];
  }
  vtkNew<vtkMatrix4x4> toData;
  vtkMatrix4x4::Invert(volume->GetMatrix(), toData);
  toData->MultiplyPoint(shown, shown);
  mapper->GetRestPosition(shown, &picked[4]);
  int association = 0;
  vtkDataArray* scalars = vtkAbstractMapper::GetScalars(data, mapper->GetScalarMode(),
    mapper->GetArrayAccessMode(), mapper->GetArrayId(), mapper->GetArrayName(), association);
  picked[7] = Interpolate(data, scalars, &picked[4]);
  picked[0] = 1.0;
  return true;
}

/// Where the opacity of composites exceeds that of a surface.
Picked PickSurface(const std::vector<vtkVolume*>& volumes, vtkRenderer* renderer,
  const double from[3], const double to[3])
{
  Picked picked;
  // Pickers take the rotation that turns -z into the direction of the ray: half a turn about the
  // vector between the two.
  double orientation[4] = { 180.0, to[0] - from[0], to[1] - from[1], to[2] - from[2] };
  if (!(vtkMath::Normalize(&orientation[1]) > 0.0))
  {
    return picked;
  }
  orientation[3] -= 1.0;
  if (vtkMath::Norm(&orientation[1]) < 1e-6)
  {
    orientation[1] = 1.0; // the direction is +z
  }
  vtkNew<vtkFFDVolumePicker> picker;
  for (vtkVolume* volume : volumes)
  {
    picker->AddPickList(volume);
  }
  picker->PickFromListOn();
  double start[3] = { from[0], from[1], from[2] };
  for (const double opacity : PickedOpacities)
  {
    picker->SetVolumeOpacityIsovalue(opacity);
    if (picker->Pick3DRay(start, orientation, renderer))
    {
      std::array<double, 8>& numbers = picked.Numbers;
      numbers[0] = 1.0;
      picker->GetPickPosition(&numbers[1]);
      picker->GetRestPosition(&numbers[4]);
      numbers[7] = picker->GetScalarValue();
      StepInside(picker, from, to, numbers);
      picker->GetPickNormal(picked.Normal.data());
      break;
    }
  }
  return picked;
}

/// The nearest of what pictures of the volumes show.
Picked PickInPictures(
  const std::vector<vtkVolume*>& volumes, const double from[3], const double to[3])
{
  Picked picked;
  picked.Normal = { { from[0] - to[0], from[1] - to[1], from[2] - to[2] } };
  double nearest = VTK_DOUBLE_MAX;
  for (vtkVolume* volume : volumes)
  {
    auto* mapper = vtkFFDInverseRayVolumeMapper::SafeDownCast(volume->GetMapper());
    std::array<double, 8> one{};
    if (PickInPicture(mapper, volume, from, to, one) &&
      vtkMath::Distance2BetweenPoints(from, &one[1]) < nearest)
    {
      nearest = vtkMath::Distance2BetweenPoints(from, &one[1]);
      picked.Numbers = one;
    }
  }
  return picked;
}

} // namespace

//------------------------------------------------------------------------------
ffdpicking::Picked ffdpicking::PickVolumes(const std::vector<vtkVolume*>& volumes,
  vtkRenderer* renderer, const double from[3], const double to[3])
{
  auto* mapper =
    volumes.empty() ? nullptr : vtkVolumeMapper::SafeDownCast(volumes.front()->GetMapper());
  if (!mapper)
  {
    return {};
  }
  return mapper->GetBlendMode() == vtkVolumeMapper::COMPOSITE_BLEND
    ? PickSurface(volumes, renderer, from, to)
    : PickInPictures(volumes, from, to);
}
