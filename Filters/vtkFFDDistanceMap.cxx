// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDistanceMap.h"

#include "vtkFFDGuard.h"
#include "vtkFFDParallelFor.h"
#include "vtkFFDPipeline.h"
#include "vtkFFDVolumeViewFromImage.h"

#include "FFDDistanceMap.h"
#include "FFDMinMaxBlocks.h"
#include "FFDTransferTable.h"
#include "FFDVolumeView.h"
#include "FFDVoxelDistance.h"

#include "vtkGarbageCollector.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnsignedShortArray.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkFFDDistanceMap);
vtkFFDGuardedProcessRequestMacro(vtkFFDDistanceMap);

namespace
{

constexpr int Block = ffd::MinMaxBlocks::BlockSize;

/// Blocks along an axis of so many voxels.
int CountBlocks(int voxels) { return (voxels - 1 + Block - 1) / Block; }

/// Make `blocks` the grid of the centers of the blocks of `voxels`.
void SetBlockGeometry(vtkImageData* voxels, vtkImageData* blocks)
{
  double origin[3];
  double spacing[3];
  int extent[6];
  double center[3]; // of the first block, index coordinates
  voxels->GetSpacing(spacing);
  for (int a = 0; a < 3; ++a)
  {
    const int* const range = voxels->GetExtent() + 2 * a;
    center[a] = range[0] + 0.5 * Block;
    extent[2 * a] = 0;
    extent[2 * a + 1] = std::max(0, CountBlocks(range[1] - range[0] + 1) - 1);
    spacing[a] *= Block;
  }
  voxels->TransformContinuousIndexToPhysicalPoint(center, origin);
  blocks->SetExtent(extent);
  blocks->SetOrigin(origin);
  blocks->SetSpacing(spacing);
  blocks->SetDirectionMatrix(voxels->GetDirectionMatrix());
}

/// Opacity as a table over the scalars of the volume, as the mapper has it.
ffd::TransferTable MakeOpacityTable(
  vtkPiecewiseFunction* opacity, const ffd::MinMaxBlocks::Limits& range)
{
  const double* const points = opacity->GetRange();
  const ffd::TableLayout layout = ffd::LayOutTable(
    range.Min, range.Max, points[0], opacity->GetClamping() ? points[1] : points[0] - 1.0,
    [opacity](double low, double high) { return opacity->EstimateMinNumberOfSamples(low, high); },
    [opacity](
      double at, double beyond) { return opacity->GetValue(at) != opacity->GetValue(beyond); });
  const auto size = static_cast<std::size_t>(layout.Size);
  std::vector<float> opacities(size);
  const std::vector<float> colors(3 * size, 1.0f);
  opacity->GetTable(layout.Low, layout.High, layout.Size, opacities.data());
  return ffd::TransferTable(layout.Low, layout.High, size, colors.data(), opacities.data(), 1.0);
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDDistanceMap::vtkFFDDistanceMap() = default;

//------------------------------------------------------------------------------
vtkFFDDistanceMap::~vtkFFDDistanceMap() { this->SetScalarOpacity(nullptr); }

//------------------------------------------------------------------------------
vtkCxxSetObjectMacro(vtkFFDDistanceMap, ScalarOpacity, vtkPiecewiseFunction);

//------------------------------------------------------------------------------
vtkPiecewiseFunction* vtkFFDDistanceMap::GetScalarOpacity() { return this->ScalarOpacity; }

//------------------------------------------------------------------------------
void vtkFFDDistanceMap::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ScalarOpacity: " << this->ScalarOpacity << "\n";
  os << indent << "Resolution: " << this->GetResolutionAsString() << "\n";
}

//------------------------------------------------------------------------------
const char* vtkFFDDistanceMap::GetResolutionAsString() const
{
  return this->Resolution == VOXELS ? "VOXELS" : "BLOCKS";
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDDistanceMap::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->ScalarOpacity ? std::max(own, this->ScalarOpacity->GetMTime()) : own;
}

//------------------------------------------------------------------------------
void vtkFFDDistanceMap::ReportReferences(vtkGarbageCollector* collector)
{
  this->Superclass::ReportReferences(collector);
  vtkGarbageCollectorReport(collector, this->ScalarOpacity, "ScalarOpacity");
}

//------------------------------------------------------------------------------
int vtkFFDDistanceMap::RequestInformation(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkInformation* input = inputs[0]->GetInformationObject(0);
  vtkInformation* output = outputs->GetInformationObject(0);
  vtkDataObject::SetPointDataActiveScalarInfo(
    output, this->Resolution == VOXELS ? VTK_UNSIGNED_SHORT : VTK_UNSIGNED_CHAR, 1);
  output->CopyEntry(input, vtkDataObject::DIRECTION());
  if (this->Resolution == VOXELS || !input->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    return 1;
  }
  vtkNew<vtkImageData> voxels;
  vtkNew<vtkImageData> blocks;
  vtkFFDGetWholeGeometry(input, nullptr, voxels);
  SetBlockGeometry(voxels, blocks);
  output->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), blocks->GetExtent(), 6);
  output->Set(vtkDataObject::ORIGIN(), blocks->GetOrigin(), 3);
  output->Set(vtkDataObject::SPACING(), blocks->GetSpacing(), 3);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDDistanceMap::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  vtkFFDRequestWhole(inputs[0]->GetInformationObject(0));
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDDistanceMap::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkImageData* input = vtkImageData::GetData(inputs[0]);
  vtkImageData* output = vtkImageData::GetData(outputs);
  if (!input || !output)
  {
    vtkErrorMacro("There is no image. Connect a vtkImageData to the input.");
    return 0;
  }
  if (!this->ScalarOpacity || this->ScalarOpacity->GetSize() < 1)
  {
    vtkErrorMacro("There is no opacity function, or one without points. Call SetScalarOpacity() "
                  "with that of the volume property.");
    return 0;
  }
  std::string message;
  int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  vtkDataArray* scalars = this->GetInputArrayToProcess(0, inputs, association);
  if (!vtkFFDIsPointArray(this->GetInputArrayInformation(0), input, scalars, association, message))
  {
    vtkErrorMacro(<< message);
    return 0;
  }
  ffd::VolumeView volume;
  if (!vtkFFDVolumeViewFromImage(input, scalars, false, volume, message))
  {
    vtkErrorMacro(<< message);
    return 0;
  }
  const ffd::MinMaxBlocks blocks(volume, vtkFFDParallelFor());
  if (blocks.GetRange().Min > blocks.GetRange().Max)
  {
    vtkErrorMacro("The scalars of the input hold no finite number: there is nothing to be far "
                  "from.");
    return 0;
  }
  this->UpdateProgress(0.3);
  const ffd::TransferTable table = MakeOpacityTable(this->ScalarOpacity, blocks.GetRange());

  if (this->Resolution == BLOCKS)
  {
    const ffd::DistanceMap map(blocks, table);
    vtkNew<vtkUnsignedCharArray> distances;
    distances->SetName("Distance");
    distances->SetNumberOfValues(static_cast<vtkIdType>(blocks.GetNumberOfBlocks()));
    // The map itself tells fewer distances apart.
    std::vector<std::uint16_t> found(blocks.GetNumberOfBlocks());
    std::transform(map.GetData(), map.GetData() + found.size(), found.begin(),
      [](std::uint8_t code) { return code == 0 ? std::uint16_t(0) : ffd::NothingVisible; });
    ffd::FindChebyshevDistances(map.GetBlocks(), found.data(), [](double) { return true; });
    std::transform(
      found.begin(), found.end(), distances->GetPointer(0), [](std::uint16_t distance) {
        return static_cast<unsigned char>(std::min<std::uint16_t>(distance, 255));
      });
    SetBlockGeometry(input, output);
    output->GetPointData()->SetScalars(distances);
    this->UpdateProgress(1.0);
    return 1;
  }
  vtkFFDRequireMemory(2.0 * static_cast<double>(input->GetNumberOfPoints()),
    "The distances of " + std::to_string(input->GetNumberOfPoints()) + " voxels",
    "Set Resolution to BLOCKS.");
  vtkNew<vtkUnsignedShortArray> distances;
  distances->SetName("Distance");
  distances->SetNumberOfValues(input->GetNumberOfPoints());
  vtkFFDParallelFor()(static_cast<std::size_t>(volume.Dimensions.z),
    [&volume, &table, &distances](std::size_t first, std::size_t last) {
      ffd::MarkVisibleVoxels(
        volume, table, static_cast<int>(first), static_cast<int>(last), distances->GetPointer(0));
    });
  const bool done =
    ffd::FindChebyshevDistances(volume.Dimensions, distances->GetPointer(0), [this](double part) {
      this->UpdateProgress(0.3 + 0.7 * part);
      return this->GetAbortExecute() == 0;
    });
  if (!done)
  {
    output->Initialize();
    return 1;
  }
  output->CopyStructure(input);
  output->GetPointData()->SetScalars(distances);
  this->UpdateProgress(1.0);
  return 1;
}
