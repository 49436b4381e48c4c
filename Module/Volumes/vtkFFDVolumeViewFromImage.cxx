// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeViewFromImage.h"

#include "FFDSingularMatrix.h"
#include "FFDVolumeView.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"

#include <glm/matrix.hpp>

#include <cmath>
#include <sstream>

namespace
{

bool FindScalarType(int vtkType, std::size_t size, ffd::ScalarType& type)
{
  switch (vtkType)
  {
    case VTK_FLOAT:
      type = ffd::ScalarType::Float32;
      return true;
    case VTK_DOUBLE:
      type = ffd::ScalarType::Float64;
      return true;
    case VTK_UNSIGNED_CHAR:
    case VTK_UNSIGNED_SHORT:
    case VTK_UNSIGNED_INT:
    case VTK_UNSIGNED_LONG:
    case VTK_UNSIGNED_LONG_LONG:
      type = size == 1 ? ffd::ScalarType::UInt8
        : size == 2    ? ffd::ScalarType::UInt16
        : size == 4    ? ffd::ScalarType::UInt32
                       : ffd::ScalarType::UInt64;
      return true;
    case VTK_CHAR:
    case VTK_SIGNED_CHAR:
    case VTK_SHORT:
    case VTK_INT:
    case VTK_LONG:
    case VTK_LONG_LONG:
    case VTK_ID_TYPE:
      type = size == 1 ? ffd::ScalarType::Int8
        : size == 2    ? ffd::ScalarType::Int16
        : size == 4    ? ffd::ScalarType::Int32
                       : ffd::ScalarType::Int64;
      return true;
    default:
      return false;
  }
}

} // namespace

//------------------------------------------------------------------------------
bool vtkFFDVolumeViewFromImage(vtkImageData* image, vtkDataArray* scalars, bool anyComponents,
  ffd::VolumeView& view, std::string& message, bool ofCells)
{
  std::ostringstream why;
  int extent[6];
  image->GetExtent(extent);
  int dims[3];
  image->GetDimensions(dims);
  if (dims[0] < 1 || dims[1] < 1 || dims[2] < 1)
  {
    message = "The input image is empty: its extent holds no voxel.";
    return false;
  }
  if (dims[0] < 2 || dims[1] < 2 || dims[2] < 2)
  {
    why << "The input image has " << dims[0] << " x " << dims[1] << " x " << dims[2]
        << " voxels; a volume needs at least 2 along each axis. Show a flat image with "
           "vtkImageActor.";
    message = why.str();
    return false;
  }
  if (ofCells)
  {
    if (dims[0] < 3 || dims[1] < 3 || dims[2] < 3)
    {
      why << "The input image has " << dims[0] - 1 << " x " << dims[1] - 1 << " x " << dims[2] - 1
          << " cells; to render cell scalars at least 2 are needed along each axis. Convert them "
             "with vtkCellDataToPointData.";
      message = why.str();
      return false;
    }
    for (int& n : dims)
    {
      --n;
    }
  }
  if (!scalars)
  {
    message = "The input image has no point scalars. Set active scalars or choose an array: "
              "SelectScalarArray() of mappers, SetInputArrayToProcess() of filters.";
    return false;
  }
  const std::string name = scalars->GetName() ? scalars->GetName() : "(unnamed)";
  const int components = scalars->GetNumberOfComponents();
  if (components < 1 || (components > 1 && !anyComponents))
  {
    why << "The scalars \"" << name << "\" have " << components
        << " components; one is needed. Extract one with vtkImageExtractComponents.";
    message = why.str();
    return false;
  }
  const vtkIdType voxels = static_cast<vtkIdType>(dims[0]) * dims[1] * dims[2];
  if (scalars->GetNumberOfTuples() < voxels)
  {
    why << "The scalars \"" << name << "\" have " << scalars->GetNumberOfTuples()
        << " values, the input image has " << voxels << (ofCells ? " cells." : " voxels.");
    message = why.str();
    return false;
  }
  ffd::ScalarType type;
  if (!FindScalarType(
        scalars->GetDataType(), static_cast<std::size_t>(scalars->GetDataTypeSize()), type))
  {
    // vtkImageCast, too, takes numbers only.
    why << "The scalars \"" << name << "\" are of type " << scalars->GetDataTypeAsString()
        << ", which cannot be used. Copy them into an array of numbers, with DeepCopy() of "
           "vtkUnsignedCharArray.";
    message = why.str();
    return false;
  }
  double spacing[3];
  double origin[3];
  image->GetSpacing(spacing);
  image->GetOrigin(origin);
  glm::dmat3 direction(1.0);
  vtkMatrix3x3* matrix = image->GetDirectionMatrix();
  for (int a = 0; a < 3; ++a)
  {
    if (!std::isfinite(origin[a]) || !std::isfinite(spacing[a]) || spacing[a] == 0.0)
    {
      why << "The input image has spacing (" << spacing[0] << ", " << spacing[1] << ", "
          << spacing[2] << ") and origin (" << origin[0] << ", " << origin[1] << ", " << origin[2]
          << "); all must be finite and the spacing not zero.";
      message = why.str();
      return false;
    }
    for (int b = 0; b < 3; ++b)
    {
      direction[b][a] = matrix->GetElement(a, b);
    }
  }
  if (ffd::IsSingular(direction))
  {
    message = "The direction matrix of the input image is singular: voxels have no size.";
    return false;
  }

  view.Scalars = scalars->GetVoidPointer(0);
  view.Type = type;
  view.Dimensions = glm::ivec3(dims[0], dims[1], dims[2]);
  view.Components = components;
  view.Increments[0] = components;
  view.Increments[1] = view.Increments[0] * dims[0];
  view.Increments[2] = view.Increments[1] * dims[1];
  view.IndexToData =
    glm::dmat3(direction[0] * spacing[0], direction[1] * spacing[1], direction[2] * spacing[2]);
  view.DataToIndex = glm::inverse(view.IndexToData);
  view.FirstVoxel = glm::dvec3(origin[0], origin[1], origin[2]) +
    view.IndexToData * glm::dvec3(extent[0], extent[2], extent[4]);
  view.Margin = 0.0;
  view.Axes = nullptr;
  if (ofCells)
  {
    view.Margin = 0.5;
    view.FirstVoxel += view.IndexToData * glm::dvec3(0.5);
  }
  return true;
}
