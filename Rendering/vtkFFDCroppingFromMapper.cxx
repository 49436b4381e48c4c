// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDCroppingFromMapper.h"

#include "vtkImageData.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkVolumeMapper.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <sstream>

namespace ffd
{

//------------------------------------------------------------------------------
bool MakeCropping(vtkVolumeMapper* mapper, vtkDataSet* input, const VolumeView& volume,
  bool deformed, Cropping& crop, std::string& message)
{
  crop = Cropping();
  if (!mapper->GetCropping())
  {
    return true;
  }
  double planes[6];
  mapper->GetCroppingRegionPlanes(planes);
  for (int a = 0; a < 3; ++a)
  {
    if (!(planes[2 * a] <= planes[2 * a + 1]))
    {
      std::ostringstream why;
      why << "The cropping planes " << planes[2 * a] << ", " << planes[2 * a + 1] << " of axis "
          << a << " are inverted or not a number. Give SetCroppingRegionPlanes() (xmin, xmax, "
          << "ymin, ymax, zmin, zmax). Nothing is drawn.";
      message = why.str();
      return false;
    }
  }
  double origin[3] = { 0.0, 0.0, 0.0 };
  double spacing[3] = { 1.0, 1.0, 1.0 };
  int extent[6] = { 0, 0, 0, 0, 0, 0 };
  vtkImageData* image = vtkImageData::SafeDownCast(input);
  if (!deformed && !image)
  {
    // A rectilinear grid has no direction: index coordinates are those of equal steps.
    for (int a = 0; a < 3; ++a)
    {
      spacing[a] = volume.IndexToData[a][a];
      origin[a] = volume.FirstVoxel[a] - volume.Margin * spacing[a];
    }
  }
  else if (!deformed)
  {
    image->GetOrigin(origin);
    image->GetSpacing(spacing);
    image->GetExtent(extent);
  }
  crop.Space = deformed ? Cropping::Spaces::Deformed : Cropping::Spaces::Rest;
  crop.Flags = mapper->GetCroppingRegionFlags();
  for (int a = 0; a < 3; ++a)
  {
    // Cells are counted from their centers.
    const double margin = deformed ? 0.0 : volume.Margin;
    const auto toPlane = [&](double x) {
      return (x - origin[a]) / spacing[a] - extent[2 * a] - margin;
    };
    crop.Low[a] = toPlane(planes[2 * a]);
    crop.High[a] = toPlane(planes[2 * a + 1]);
  }
  return true;
}

//------------------------------------------------------------------------------
bool MakeClippingPlanes(
  vtkVolumeMapper* mapper, std::vector<glm::dvec4>& planes, std::string& message)
{
  planes.clear();
  vtkPlaneCollection* collection = mapper->GetClippingPlanes();
  for (int i = 0; collection && i < collection->GetNumberOfItems(); ++i)
  {
    vtkPlane* plane = collection->GetItem(i);
    const double* o = plane->GetOrigin();
    const double* n = plane->GetNormal();
    const glm::dvec3 normal(n[0], n[1], n[2]);
    const double length = glm::length(normal);
    const double offset = -glm::dot(normal, glm::dvec3(o[0], o[1], o[2]));
    if (!(length > 0.0) || !std::isfinite(length) || !std::isfinite(offset))
    {
      message = "The origin or the normal of clipping plane " + std::to_string(i) +
        " is not a number, or the normal has no length. Correct it, or call "
        "RemoveAllClippingPlanes(). Nothing is drawn.";
      return false;
    }
    planes.push_back(glm::dvec4(normal, offset) / length);
  }
  return true;
}

} // namespace ffd
