// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDResampleVolume.h"

#include "vtkFFDDeformationSource.h"
#include "vtkFFDGuard.h"
#include "vtkFFDLattice.h"
#include "vtkFFDOptions.h"
#include "vtkFFDParallelFor.h"
#include "vtkFFDPipeline.h"
#include "vtkFFDVolumeViewFromImage.h"

#include "Bounds/FFDPullBackBounds.h"
#include "FFDPullBack.h"
#include "FFDResampler.h"
#include "FFDVolumeView.h"

#include "vtkAbstractTransform.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkWeakPointer.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

vtkStandardNewMacro(vtkFFDResampleVolume);
vtkFFDProcessRequestInTimeMacro(vtkFFDResampleVolume);

namespace
{

/// Slices of the output between two looks at AbortExecute; a multiple of the step of the nodes
/// that an inverse is solved for at, which neighboring batches both need.
constexpr int SlicesPerBatch = 32;

/// The largest number of points of an output. More fit into no memory; the deformation or the
/// spacing is then a mistake.
constexpr double LargestNumberOfPoints = 68719476736.0; // 2^36

/// Numbers of points along an axis fit into an int.
constexpr int LargestIndex = std::numeric_limits<int>::max() / 2;

/// Rounding must not add a layer to a box that ends at a point.
constexpr double IndexSlack = 1e-6;

ffd::ImageGrid MakeGrid(vtkImageData* geometry)
{
  ffd::ImageGrid grid;
  geometry->GetOrigin(&grid.Origin.x);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      grid.IndexToData[column][row] =
        geometry->GetDirectionMatrix()->GetElement(row, column) * geometry->GetSpacing()[column];
    }
  }
  return grid;
}

bool IsUsable(const ffd::ImageGrid& grid)
{
  const double volume = std::abs(glm::determinant(grid.IndexToData));
  return std::isfinite(glm::dot(grid.Origin, grid.Origin)) && volume > 0.0 && std::isfinite(volume);
}

/// The box around an index range, data coordinates.
ffd::Box FindBox(const ffd::ImageGrid& grid, const int extent[6])
{
  ffd::Box box{ glm::dvec3(std::numeric_limits<double>::infinity()),
    glm::dvec3(-std::numeric_limits<double>::infinity()) };
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec3 p = grid.ToData(
      glm::dvec3(extent[corner & 1], extent[2 + (corner >> 1 & 1)], extent[4 + (corner >> 2 & 1)]));
    box.Min = glm::min(box.Min, p);
    box.Max = glm::max(box.Max, p);
  }
  return box;
}

/// Indices around a region of another grid, moved by a displacement in a box.
ffd::Box FindIndices(const ffd::ImageGrid& grid, const ffd::ImageGrid& other, const int extent[6],
  const ffd::Box& displacement)
{
  const glm::dmat3 toIndex = glm::inverse(grid.IndexToData);
  ffd::Box indices{ glm::dvec3(std::numeric_limits<double>::infinity()),
    glm::dvec3(-std::numeric_limits<double>::infinity()) };
  ffd::Box moved = indices;
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec3 p = other.ToData(
      glm::dvec3(extent[corner & 1], extent[2 + (corner >> 1 & 1)], extent[4 + (corner >> 2 & 1)]));
    const glm::dvec3 d((corner & 1 ? displacement.Max : displacement.Min).x,
      (corner & 2 ? displacement.Max : displacement.Min).y,
      (corner & 4 ? displacement.Max : displacement.Min).z);
    const glm::dvec3 index = toIndex * (p - grid.Origin);
    indices.Min = glm::min(indices.Min, index);
    indices.Max = glm::max(indices.Max, index);
    moved.Min = glm::min(moved.Min, toIndex * d);
    moved.Max = glm::max(moved.Max, toIndex * d);
  }
  return { glm::floor(indices.Min + moved.Min + IndexSlack),
    glm::ceil(indices.Max + moved.Max - IndexSlack) };
}

/// The indices around a box, as numbers: they need not fit into an int.
ffd::Box FindIndices(const ffd::ImageGrid& grid, const ffd::Box& box)
{
  ffd::Box indices{ glm::dvec3(std::numeric_limits<double>::infinity()),
    glm::dvec3(-std::numeric_limits<double>::infinity()) };
  const glm::dmat3 toIndex = glm::inverse(grid.IndexToData);
  for (int corner = 0; corner < 8; ++corner)
  {
    const glm::dvec3 p((corner & 1 ? box.Max : box.Min).x, (corner & 2 ? box.Max : box.Min).y,
      (corner & 4 ? box.Max : box.Min).z);
    const glm::dvec3 index = toIndex * (p - grid.Origin);
    indices.Min = glm::min(indices.Min, index);
    indices.Max = glm::max(indices.Max, index);
  }
  return { glm::floor(indices.Min + IndexSlack), glm::ceil(indices.Max - IndexSlack) };
}

/// The pull-back of a deformation and its bounds. Those over all of a lattice of a million control
/// points take longer to find than the volume to resample.
struct BoundedMap
{
  ffd::PullBack Map;
  ffd::PullBackBounds Bounds;
  ffd::Box Displacements; ///< all that there are
};

ffd::Made MakeBoundedMap(BoundedMap& result, ffd::StageTools&,
  const ffd::Product<ffd::DeformationField>& field, ffd::InverseMode mode, double tolerance)
{
  result.Map = ffd::PullBack(
    &field->Field, ffd::FindPullBackKind(mode, field->Inverted), tolerance, field->Domain);
  result.Bounds.Update(result.Map);
  constexpr double large = 1e300;
  result.Displacements = result.Bounds.DisplacementOver({ glm::dvec3(-large), glm::dvec3(large) });
  return ffd::Made::Anew;
}

} // namespace

//------------------------------------------------------------------------------
/// The deformation, ready for kernels, and the grids.
class vtkFFDResampleVolume::vtkInternals
{
public:
  ffd::StageOrder Order;
  vtkFFDDeformationSource Source{ Order };
  ffd::Stage<&MakeBoundedMap> Pulled{ Order };
  ffd::ImageGrid Input;
  ffd::ImageGrid Output;
  vtkNew<vtkImageData> OutputGeometry; ///< origin, spacing and direction of the output
  ffd::Box RestBounds;
  vtkWeakPointer<vtkCompositeDataSet> Blocks; ///< the last input that was not an image

  /// How far rest positions may be off, data units: by the approximation of the deformation, whose
  /// error is measured at some points, and by its inverse, more where the volume is pressed
  /// together.
  double FindPositionError() const
  {
    constexpr double safety = 2.0;
    const ffd::PullBack& map = this->Pulled->Map;
    const double error = this->Source.GetProduct()->Error;
    return safety * (ffd::InvertsTheField(map.GetKind()) ? error + map.GetTolerance() : error);
  }

  /// Indices of the output that hold the whole deformed volume.
  ffd::Box FindDeformedIndices(vtkInformation* input) const
  {
    int whole[6];
    input->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
    const ffd::PullBack& map = this->Pulled->Map;
    const ffd::PullBackBounds& bounds = this->Pulled->Bounds;
    if (map.IsIdentity())
    {
      return FindIndices(
        this->Output, this->Input, whole, ffd::Box{ glm::dvec3(0.0), glm::dvec3(0.0) });
    }
    // Two bounds: the first is tight, but a box of data coordinates, so loose for turned images.
    const ffd::Box first = FindIndices(this->Output, bounds.DeformedBounds(this->RestBounds));
    const ffd::Box& d = this->Pulled->Displacements;
    // P - Phi(P) is D of some point, or -D for the kinds that read T from output to input.
    const bool opposite = map.GetKind() == ffd::PullBackKind::Forward ||
      map.GetKind() == ffd::PullBackKind::FirstOrderOfInverse;
    const glm::dvec3 slack(map.GetTolerance());
    const ffd::Box second = FindIndices(this->Output, this->Input, whole,
      opposite ? ffd::Box{ -d.Max - slack, -d.Min + slack }
               : ffd::Box{ d.Min - slack, d.Max + slack });
    return first.IsEmpty()
      ? second
      : ffd::Box{ glm::max(first.Min, second.Min), glm::min(first.Max, second.Max) };
  }
};

//------------------------------------------------------------------------------
vtkFFDResampleVolume::vtkFFDResampleVolume()
  : Internals(new vtkInternals)
{
}

//------------------------------------------------------------------------------
vtkFFDResampleVolume::~vtkFFDResampleVolume() { this->SetDeformation(nullptr); }

//------------------------------------------------------------------------------
vtkCxxSetObjectMacro(vtkFFDResampleVolume, Deformation, vtkAbstractTransform);

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDResampleVolume::GetDeformation() { return this->Deformation; }

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Deformation: " << this->Deformation << "\n";
  os << indent << "InverseMode: " << this->GetInverseModeAsString() << "\n";
  os << indent << "InverseTolerance: " << this->InverseTolerance << "\n";
  os << indent << "PositionTolerance: " << this->PositionTolerance << "\n";
  os << indent << "InterpolationMode: " << this->GetInterpolationModeAsString() << "\n";
  os << indent << "BackgroundLevel: " << this->BackgroundLevel << "\n";
  os << indent << "OutputSpacing: ";
  if (this->DefaultSpacing)
  {
    os << "default\n";
  }
  else
  {
    os << "(" << this->OutputSpacing[0] << ", " << this->OutputSpacing[1] << ", "
       << this->OutputSpacing[2] << ")\n";
  }
  os << indent << "OutputOrigin: ";
  if (this->DefaultOrigin)
  {
    os << "default\n";
  }
  else
  {
    os << "(" << this->OutputOrigin[0] << ", " << this->OutputOrigin[1] << ", "
       << this->OutputOrigin[2] << ")\n";
  }
  os << indent << "OutputExtent: ";
  if (this->DefaultExtent)
  {
    os << "default\n";
  }
  else
  {
    const int* e = this->OutputExtent;
    os << "(" << e[0] << ", " << e[1] << ", " << e[2] << ", " << e[3] << ", " << e[4] << ", "
       << e[5] << ")\n";
  }
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "NumberOfUnconvergedPoints: " << this->NumberOfUnconvergedPoints << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetInverseTolerance(double voxels)
{
  vtkFFDSetPositive(this, "InverseTolerance", this->InverseTolerance, voxels);
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetPositionTolerance(double voxels)
{
  vtkFFDSetPositive(this, "PositionTolerance", this->PositionTolerance, voxels);
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetBackgroundLevel(double value)
{
  if (!std::isfinite(value))
  {
    vtkErrorMacro("SetBackgroundLevel: the value is " << value << ". Give a finite number.");
    return;
  }
  if (this->BackgroundLevel != value)
  {
    this->BackgroundLevel = value;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
const char* vtkFFDResampleVolume::GetInverseModeAsString() const
{
  static const char* const names[] = { "FIRST_ORDER", "EXACT", "PULL_BACK" };
  return names[this->InverseMode];
}

//------------------------------------------------------------------------------
const char* vtkFFDResampleVolume::GetInterpolationModeAsString() const
{
  static const char* const names[] = { "NEAREST", "LINEAR", "CUBIC" };
  return names[this->InterpolationMode];
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetOutputSpacing(const double spacing[3])
{
  if (!spacing)
  {
    vtkErrorMacro("SetOutputSpacing: the spacing is null. Give three numbers.");
    return;
  }
  this->SetOutputSpacing(spacing[0], spacing[1], spacing[2]);
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetOutputSpacing(double x, double y, double z)
{
  const double spacing[3] = { x, y, z };
  for (const double s : spacing)
  {
    if (!(s > 0.0) || !std::isfinite(s))
    {
      vtkErrorMacro("SetOutputSpacing: (" << x << ", " << y << ", " << z
                                          << ") is no spacing. Give three positive numbers.");
      return;
    }
  }
  if (this->DefaultSpacing || !std::equal(spacing, spacing + 3, this->OutputSpacing))
  {
    std::copy(spacing, spacing + 3, this->OutputSpacing);
    this->DefaultSpacing = false;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetOutputSpacingToDefault()
{
  if (!this->DefaultSpacing)
  {
    this->DefaultSpacing = true;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetOutputOrigin(const double origin[3])
{
  if (!origin)
  {
    vtkErrorMacro("SetOutputOrigin: the origin is null. Give three numbers.");
    return;
  }
  this->SetOutputOrigin(origin[0], origin[1], origin[2]);
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetOutputOrigin(double x, double y, double z)
{
  const double origin[3] = { x, y, z };
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
  {
    vtkErrorMacro("SetOutputOrigin: (" << x << ", " << y << ", " << z
                                       << ") is no position. Give three finite numbers.");
    return;
  }
  if (this->DefaultOrigin || !std::equal(origin, origin + 3, this->OutputOrigin))
  {
    std::copy(origin, origin + 3, this->OutputOrigin);
    this->DefaultOrigin = false;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetOutputOriginToDefault()
{
  if (!this->DefaultOrigin)
  {
    this->DefaultOrigin = true;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetOutputExtent(int x0, int x1, int y0, int y1, int z0, int z1)
{
  const int extent[6] = { x0, x1, y0, y1, z0, z1 };
  this->SetOutputExtent(extent);
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetOutputExtent(const int extent[6])
{
  if (!extent || extent[0] > extent[1] || extent[2] > extent[3] || extent[4] > extent[5] ||
    std::any_of(extent, extent + 6, [](int i) { return i < -LargestIndex || i > LargestIndex; }))
  {
    vtkErrorMacro(
      "SetOutputExtent: the extent is null, empty or reaches too far. Give the first and "
      "the last index of each axis, first <= last, from -"
      << LargestIndex << " to " << LargestIndex << ".");
    return;
  }
  if (this->DefaultExtent || !std::equal(extent, extent + 6, this->OutputExtent))
  {
    std::copy(extent, extent + 6, this->OutputExtent);
    this->DefaultExtent = false;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDResampleVolume::SetOutputExtentToDefault()
{
  if (!this->DefaultExtent)
  {
    this->DefaultExtent = true;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDResampleVolume::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->Deformation ? std::max(own, this->Deformation->GetMTime()) : own;
}

//------------------------------------------------------------------------------
/// `image`: the input, if it is up to date, else null.
bool vtkFFDResampleVolume::UpdateInternals(
  vtkInformation* input, vtkImageData* image, std::string& message)
{
  vtkInternals& in = *this->Internals;
  if (!input->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    message = "The input has no extent. Connect a vtkImageData.";
    return false;
  }
  int whole[6];
  input->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  for (int a = 0; a < 3; ++a)
  {
    if (whole[2 * a + 1] <= whole[2 * a])
    {
      message = "The input image is empty or flat; a volume needs at least 2 voxels along each "
                "axis.";
      return false;
    }
  }
  vtkNew<vtkImageData> geometry;
  vtkFFDGetWholeGeometry(input, image, geometry);
  in.Input = MakeGrid(geometry);
  if (!IsUsable(in.Input))
  {
    message = "The spacing, origin or direction of the input image is zero, singular or not "
              "finite.";
    return false;
  }
  in.RestBounds = FindBox(in.Input, whole);
  const ffd::Box& rest = in.RestBounds;
  const double voxel = std::min({ glm::length(in.Input.IndexToData[0]),
    glm::length(in.Input.IndexToData[1]), glm::length(in.Input.IndexToData[2]) });
  ffd::StageTools tools;
  in.Order.Begin();
  const ffd::FitRequest fit{ { rest.Min.x, rest.Max.x, rest.Min.y, rest.Max.y, rest.Min.z,
                               rest.Max.z },
    this->PositionTolerance * voxel, this->InverseMode == EXACT };
  if (!in.Source.Update(this->Deformation, vtkImageData::GetData(input), fit, tools))
  {
    message = tools.Message;
    return false;
  }
  if (!tools.Warning.empty())
  {
    vtkWarningMacro(<< tools.Warning);
  }
  in.Pulled.Update(tools, in.Source.GetProduct(), static_cast<ffd::InverseMode>(this->InverseMode),
    this->InverseTolerance * voxel);

  double spacing[3];
  for (int a = 0; a < 3; ++a)
  {
    // A negative spacing keeps its sign.
    spacing[a] = this->DefaultSpacing
      ? geometry->GetSpacing()[a]
      : std::copysign(this->OutputSpacing[a], geometry->GetSpacing()[a]);
  }
  in.OutputGeometry->SetSpacing(spacing);
  in.OutputGeometry->SetOrigin(this->DefaultOrigin ? geometry->GetOrigin() : this->OutputOrigin);
  in.OutputGeometry->SetDirectionMatrix(geometry->GetDirectionMatrix());
  in.Output = MakeGrid(in.OutputGeometry);
  return true;
}

//------------------------------------------------------------------------------
int vtkFFDResampleVolume::RequestInformation(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkInformation* input = inputs[0]->GetInformationObject(0);
  vtkInformation* output = outputs->GetInformationObject(0);
  vtkDataObject* data = vtkDataObject::GetData(input);
  if (auto* blocks = vtkCompositeDataSet::SafeDownCast(data))
  {
    // The executive asks again for each of the blocks.
    this->Internals->Blocks = blocks;
    return 1;
  }
  vtkAlgorithmOutput* connection = this->GetInputConnection(0, 0);
  const bool moves =
    input->Has(vtkStreamingDemandDrivenPipeline::TIME_DEPENDENT_INFORMATION()) != 0;
  vtkFFDFollowTime(this->Deformation && !moves ? nullptr : input, output);
  bool isUpToDate = vtkFFDIsBlock(this->Internals->Blocks, data);
  if (connection && !isUpToDate && input->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    isUpToDate = true;
    if (!this->Deformation)
    {
      // A lattice may be attached to the data: the extent of the output follows from it. Filters
      // behind this one do not learn of an extent that changes with time, and go on to ask for the
      // first one.
      vtkFFDUpdateWhole(connection, output);
      output->Set(vtkStreamingDemandDrivenPipeline::UNRESTRICTED_UPDATE_EXTENT(), 1);
    }
    else if (!input->Has(vtkDataObject::DIRECTION()))
    {
      // The extent of the output follows from the direction of the image, too.
      vtkFFDUpdatePart(connection, output);
    }
    else
    {
      isUpToDate = false;
    }
  }
  std::string message;
  if (!this->UpdateInternals(input, isUpToDate ? vtkImageData::GetData(input) : nullptr, message))
  {
    vtkErrorMacro(<< message);
    return 0;
  }
  const vtkInternals& in = *this->Internals;
  int extent[6];
  std::copy_n(this->OutputExtent, 6, extent);
  if (this->DefaultExtent)
  {
    const ffd::Box indices = in.FindDeformedIndices(input);
    const glm::dvec3 count = indices.Max - indices.Min + 1.0;
    constexpr double largest = std::numeric_limits<int>::max() / 2;
    // The negation also catches what is not a number.
    if (!(count.x * count.y * count.z <= LargestNumberOfPoints) ||
      !(std::max({ std::abs(indices.Min.x), std::abs(indices.Min.y), std::abs(indices.Min.z),
          std::abs(indices.Max.x), std::abs(indices.Max.y), std::abs(indices.Max.z) }) <= largest))
    {
      vtkErrorMacro("The deformed volume takes "
        << count.x << " x " << count.y << " x " << count.z
        << " points, which is too many. Check the deformation, or call SetOutputSpacing() or "
           "SetOutputExtent().");
      return 0;
    }
    for (int a = 0; a < 3; ++a)
    {
      extent[2 * a] = static_cast<int>(indices.Min[a]);
      extent[2 * a + 1] = static_cast<int>(indices.Max[a]);
    }
  }
  output->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  output->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  output->Set(vtkDataObject::SPACING(), in.OutputGeometry->GetSpacing(), 3);
  output->Set(vtkDataObject::ORIGIN(), in.OutputGeometry->GetOrigin(), 3);
  output->Set(vtkDataObject::DIRECTION(), in.OutputGeometry->GetDirectionMatrix()->GetData(), 9);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDResampleVolume::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkInformation* input = inputs[0]->GetInformationObject(0);
  vtkInformation* output = outputs->GetInformationObject(0);
  // Of several processes each makes a piece of the output, for which it may need any of the input.
  vtkFFDRequestWhole(input);
  if (!this->Deformation || !input->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    // It was updated for the attached lattice already; or it has blocks.
    return 1;
  }
  int whole[6];
  input->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  int wanted[6];
  output->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), wanted);
  int all[6];
  output->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), all);
  if (this->DefaultExtent && std::equal(all, all + 6, wanted))
  {
    // All of the deformed volume comes from all of the volume.
    return 1;
  }
  const vtkInternals& in = *this->Internals;
  const ffd::Box rest =
    ffd::FindRestRegion(in.Pulled->Map, in.Pulled->Bounds, FindBox(in.Output, wanted));
  const ffd::Box indices = FindIndices(in.Input, rest);
  // One layer more than what is needed: for rounding, and so that the part is never flat.
  const double reach = this->InterpolationMode == CUBIC ? 2.0 : 1.0;
  int extent[6];
  for (int a = 0; a < 3; ++a)
  {
    const double first = whole[2 * a];
    const double last = whole[2 * a + 1];
    // In this order what is not a number becomes the whole range.
    const double from = std::min(last - 1.0, std::max(first, indices.Min[a] - reach));
    const double to = std::max(from + 1.0, std::min(last, indices.Max[a] + reach));
    extent[2 * a] = static_cast<int>(from);
    extent[2 * a + 1] = static_cast<int>(to);
  }
  input->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent, 6);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDResampleVolume::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkImageData* input = vtkImageData::GetData(inputs[0]);
  vtkImageData* output = vtkImageData::GetData(info);
  this->NumberOfUnconvergedPoints = 0;
  std::string message;
  if (!input || !output ||
    !this->UpdateInternals(inputs[0]->GetInformationObject(0), input, message))
  {
    vtkErrorMacro(<< (message.empty() ? "There is no image to resample." : message.c_str()));
    return 0;
  }
  int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  vtkDataArray* scalars = this->GetInputArrayToProcess(0, inputs, association);
  const char* name = this->GetInputArrayInformation(0)->Get(vtkDataObject::FIELD_NAME());
  if (!scalars && name && !*name)
  {
    // As ParaView leaves it when the filter is made before its input has been read.
    vtkPointData* data = input->GetPointData();
    scalars = data->GetScalars() ? data->GetScalars() : data->GetArray(0);
  }
  if (!vtkFFDIsPointArray(this->GetInputArrayInformation(0), input, scalars, association, message))
  {
    vtkErrorMacro(<< message);
    return 0;
  }
  ffd::VolumeView volume;
  if (!vtkFFDVolumeViewFromImage(input, scalars, true, volume, message))
  {
    vtkErrorMacro(<< message);
    return 0;
  }
  int extent[6];
  info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent);
  auto result =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(scalars->GetDataType()));
  result->SetName(scalars->GetName());
  result->SetNumberOfComponents(scalars->GetNumberOfComponents());
  const double sides[3] = { extent[1] - extent[0] + 1.0, extent[3] - extent[2] + 1.0,
    extent[5] - extent[4] + 1.0 };
  std::ostringstream what;
  what << sides[0] << " x " << sides[1] << " x " << sides[2] << " points";
  vtkFFDRequireMemory(
    sides[0] * sides[1] * sides[2] * result->GetNumberOfComponents() * result->GetDataTypeSize(),
    what.str(), "Update the output in pieces, or call SetOutputSpacing() or SetOutputExtent().");
  const vtkInternals& in = *this->Internals;
  output->SetExtent(extent);
  output->SetOrigin(in.OutputGeometry->GetOrigin());
  output->SetSpacing(in.OutputGeometry->GetSpacing());
  output->SetDirectionMatrix(in.OutputGeometry->GetDirectionMatrix());
  result->SetNumberOfTuples(output->GetNumberOfPoints());
  output->GetPointData()->SetScalars(result);
  // The executive passed it on.
  vtkFFDLattice::DetachFrom(output);

  ffd::ResampleSettings settings;
  settings.Interpolation = static_cast<ffd::ResampleInterpolation>(this->InterpolationMode);
  settings.Background =
    std::clamp(this->BackgroundLevel, result->GetDataTypeMin(), result->GetDataTypeMax());
  settings.Border = in.FindPositionError();
  settings.UniqueInverse = in.Pulled->Bounds.IsProvenInvertible();
  int whole[6];
  inputs[0]->GetInformationObject(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  const int* const part = input->GetExtent();
  for (int a = 0; a < 3; ++a)
  {
    settings.Rest.Min[a] = whole[2 * a] - part[2 * a];
    settings.Rest.Max[a] = whole[2 * a + 1] - part[2 * a];
  }
  const ffd::Resampler resampler(volume, in.Pulled->Map, in.Output, settings);
  const std::size_t sliceSize = static_cast<std::size_t>(extent[1] - extent[0] + 1) *
    static_cast<std::size_t>(extent[3] - extent[2] + 1) *
    static_cast<std::size_t>(result->GetNumberOfComponents()) *
    static_cast<std::size_t>(result->GetDataTypeSize());
  char* const values = static_cast<char*>(result->GetVoidPointer(0));
  const vtkFFDParallelFor parallelFor(this->NumberOfThreads);
  for (int k = extent[4]; k <= extent[5] && !this->GetAbortExecute(); k += SlicesPerBatch)
  {
    const int last = std::min(k + SlicesPerBatch - 1, extent[5]);
    this->NumberOfUnconvergedPoints +=
      resampler.Resample({ extent[0], extent[2], k }, { extent[1], extent[3], last },
        values + sliceSize * static_cast<std::size_t>(k - extent[4]), parallelFor);
    this->UpdateProgress(static_cast<double>(last - extent[4] + 1) / (extent[5] - extent[4] + 1));
  }
  if (this->GetAbortExecute())
  {
    output->Initialize();
  }
  return 1;
}
