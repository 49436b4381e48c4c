// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFrameCache.h"

#include "vtkFFDBlendingFromMapper.h"
#include "vtkFFDContentTime.h"
#include "vtkFFDCroppingFromMapper.h"
#include "vtkFFDVolumeViewFromImage.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkVolumeProperty.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

namespace
{

/// The largest tolerance of the inverse, voxels: more would be as good as no inverse.
constexpr double LargestTolerance = 1.0;

/// The largest tolerance of the inverse by that of positions, of which it takes a part.
constexpr double LargestPartOfPositions = 0.1;

/// The tolerance of points that are pulled back by themselves, voxels.
double FindInverseTolerance(vtkFFDInverseRayVolumeMapper* mapper)
{
  const double tolerance = std::min(mapper->GetInverseTolerance(), LargestTolerance);
  // The paper's segments have no tolerance of positions.
  return mapper->GetSegmentation() == vtkFFDInverseRayVolumeMapper::ERROR_BOUND
    ? std::min(tolerance, LargestPartOfPositions * mapper->GetPositionTolerance())
    : tolerance;
}

/// What is wrong with the array that SelectScalarArray() has chosen of the input, which has no such
/// numbers.
std::string DescribeMissingScalars(vtkFFDInverseRayVolumeMapper* mapper, vtkDataSet* input)
{
  const bool ofCells = mapper->GetScalarMode() == VTK_SCALAR_MODE_USE_CELL_FIELD_DATA;
  vtkFieldData* arrays = ofCells ? static_cast<vtkFieldData*>(input->GetCellData())
                                 : static_cast<vtkFieldData*>(input->GetPointData());
  const std::string kind = ofCells ? "cell" : "point";
  const bool byName = mapper->GetArrayAccessMode() == VTK_GET_ARRAY_BY_NAME;
  const std::string wanted = byName
    ? std::string("\"") + (mapper->GetArrayName() ? mapper->GetArrayName() : "") + '"'
    : "number " + std::to_string(mapper->GetArrayId());
  vtkAbstractArray* found = byName ? arrays->GetAbstractArray(mapper->GetArrayName())
                                   : arrays->GetAbstractArray(mapper->GetArrayId());
  std::string names;
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* const array = arrays->GetArray(i);
    if (array)
    {
      names += names.empty() ? "" : ", ";
      names += std::string("\"") + (array->GetName() ? array->GetName() : "") + "\" (number " +
        std::to_string(i) + ")";
    }
  }
  return (found ? "The " + kind + " array " + wanted + " of the input holds no numbers"
                : "The input has no " + kind + " array " + wanted) +
    (names.empty() ? ", and no other to render." : ". It has " + names + ".") +
    " Choose one with SetScalarMode() and SelectScalarArray().";
}

} // namespace

//------------------------------------------------------------------------------
double vtkFFDFrameCache::GetVoxelSize() const
{
  const glm::dmat3& fromIndex = this->GetVolume().IndexToData;
  return std::min(
    glm::length(fromIndex[0]), std::min(glm::length(fromIndex[1]), glm::length(fromIndex[2])));
}

//------------------------------------------------------------------------------
bool vtkFFDFrameCache::UpdateBounds(Mapper* mapper, ffd::StageTools& tools)
{
  this->Order.Begin();
  // Observers of the progress may take it away from the mapper.
  const vtkSmartPointer<vtkDataSet> input(mapper->GetInput());
  if (!input)
  {
    vtkDataObject* const other = mapper->GetInputDataObject(0, 0);
    if (!other)
    {
      tools.Message = "No input: call SetInputData() or SetInputConnection().";
      return false;
    }
    tools.Message = std::string("The input is a ") + other->GetClassName() +
      ", which has no voxels of its own: give " +
      (vtkCompositeDataSet::SafeDownCast(other) ? "one of its blocks."
                                                : "an image or a rectilinear grid.");
    return false;
  }
  return this->UpdateVoxels(mapper, input, tools) && this->UpdatePullBack(mapper, input, tools);
}

//------------------------------------------------------------------------------
bool vtkFFDFrameCache::UpdateProbe(Mapper* mapper, ffd::StageTools& tools)
{
  return this->UpdateBounds(mapper, tools) && this->FindMask(mapper, tools.Message) &&
    ffd::MakeCropping(mapper, mapper->GetInput(), this->GetVolume(),
      mapper->GetCroppingSpace() == Mapper::DEFORMED, this->Crop, tools.Message);
}

//------------------------------------------------------------------------------
bool vtkFFDFrameCache::Update(
  Mapper* mapper, vtkVolumeProperty* replaceable, ffd::StageTools& tools)
{
  const vtkSmartPointer<vtkVolumeProperty> property(replaceable);
  const vtkSmartPointer<vtkDataSet> input(mapper->GetInput());
  const bool planes = property->GetTransferFunctionMode() == vtkVolumeProperty::TF_2D;
  if (!this->UpdateBounds(mapper, tools) || !this->FindMask(mapper, tools.Message) ||
    !this->FindSecondAxis(
      planes ? mapper->GetTransfer2DYAxisArray() : nullptr, input, tools.Message) ||
    !this->UpdateBlocks(mapper, property, tools))
  {
    return false;
  }
  std::copy_n(mapper->GetWholeScalarRange(), 2, this->Lookup.WholeRange.begin());
  this->Lookup.Native = { { mapper->GetColorRangeType() == Mapper::NATIVE,
    mapper->GetScalarOpacityRangeType() == Mapper::NATIVE,
    mapper->GetGradientOpacityRangeType() == Mapper::NATIVE } };
  this->Lookup.HasLabels = this->Mask.Volume.Scalars && this->Mask.Labels;
  ffd::Source<vtkDataArray> secondAxis;
  if (this->SecondAxisArray)
  {
    secondAxis = { this->SecondAxisArray, this->SecondAxisArray->GetMTime() };
  }
  if (!this->Functions.Update(tools, this->Voxels.GetProduct(), this->Blocks.GetProduct(),
        ffd::FindSource(property, this->GetVolume().Components), this->Lookup, secondAxis) ||
    !ffd::MakeBlending(mapper, property, this->Functions->Facts, this->Blend, tools.Message) ||
    !ffd::MakeCropping(mapper, input, this->GetVolume(),
      mapper->GetCroppingSpace() == Mapper::DEFORMED, this->Crop, tools.Message) ||
    !ffd::MakeClippingPlanes(mapper, this->ClippingPlanes, tools.Message))
  {
    return false;
  }
  this->Labels.Update(tools, ffd::UniformView{ this->Mask.Volume }, this->Mask.Labels,
    { this->MaskArray.Get(), this->MaskTime });
  this->Mask.Blocks = &this->Labels.Get();
  this->Distances = nullptr;
  this->Peaks = nullptr;
  if (mapper->GetSpaceLeaping() == Mapper::OFF)
  {
    return true;
  }
  // Compositing leaps over what is transparent; the other modes look at the opacities, too.
  ffd::Product<ffd::TransferFunctions> functions = this->Functions.GetProduct();
  if (this->Blend.Mode == ffd::BlendMode::Composite)
  {
    functions = functions.WithVersion(functions->Visibility);
  }
  this->UpdateMaskBlocks(tools);
  const bool cropsAtRest = this->Crop.Space == ffd::Cropping::Spaces::Rest;
  this->Space.Update(tools, this->Blocks.GetProduct(), this->MaskBlocks.GetProduct(), functions,
    { this->Blend }, cropsAtRest ? this->Crop : ffd::Cropping());
  this->Distances = this->Space->CanLeap ? &this->Space->Distances : nullptr;
  this->Peaks = this->Space->CanLeap && !this->Space->Peaks.empty() ? &this->Space->Peaks : nullptr;
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDFrameCache::UpdateVoxels(Mapper* mapper, vtkDataSet* input, ffd::StageTools& tools)
{
  int cellFlag = 0;
  vtkSmartPointer<vtkDataArray> scalars(
    vtkAbstractMapper::GetScalars(input, mapper->GetScalarMode(), mapper->GetArrayAccessMode(),
      mapper->GetArrayId(), mapper->GetArrayName(), cellFlag));
  if (scalars && cellFlag == 2)
  {
    tools.Message = "The scalars to render are field data; they must belong to points or cells. "
                    "Choose another array with SetScalarMode() and SelectScalarArray().";
    return false;
  }
  const bool ofCells = cellFlag == 1;
  const int mode = mapper->GetVectorMode();
  const int component = mapper->GetVectorComponent();
  if (mode == Mapper::DISABLED || !scalars || scalars->GetNumberOfComponents() < 2)
  {
    this->VectorScalars.Clear();
  }
  else
  {
    if (mode == Mapper::COMPONENT && component >= scalars->GetNumberOfComponents())
    {
      tools.Message = "VectorComponent is " + std::to_string(component) +
        ", but the scalars have only " + std::to_string(scalars->GetNumberOfComponents()) +
        " components, counted from 0. Choose one of them with SetVectorComponent().";
      return false;
    }
    this->VectorScalars.Update(tools, { scalars, scalars->GetMTime() }, vtkFFDGetContentTime(input),
      mode == Mapper::COMPONENT ? component : ffd::Magnitude);
    scalars = this->VectorScalars.Get();
  }
  const bool chosen = mapper->GetScalarMode() == VTK_SCALAR_MODE_USE_POINT_FIELD_DATA ||
    mapper->GetScalarMode() == VTK_SCALAR_MODE_USE_CELL_FIELD_DATA;
  if (!scalars && chosen && input->GetNumberOfPoints() > 0)
  {
    tools.Message = DescribeMissingScalars(mapper, input);
    return false;
  }
  this->Arrays = { scalars };
  ffd::UniformView view;
  return ffd::FindUniformView(input, scalars, ofCells, view, tools.Message) &&
    this->Voxels.Update(
      tools, view, ffd::GridSources::FromDataSet(input), { scalars, scalars->GetMTime() }, ofCells);
}

//------------------------------------------------------------------------------
bool vtkFFDFrameCache::UpdatePullBack(Mapper* mapper, vtkDataSet* input, ffd::StageTools& tools)
{
  std::array<double, 6> bounds;
  input->GetBounds(bounds.data());
  if (vtkMath::AreBoundsInitialized(mapper->GetWholeBounds()))
  {
    std::copy_n(mapper->GetWholeBounds(), 6, bounds.begin());
  }
  const double voxel = this->GetVoxelSize();
  const ffd::FitRequest fit{ bounds, mapper->GetPositionTolerance() * voxel,
    mapper->GetInverseMode() == Mapper::EXACT };
  const bool made = this->Field.Update(mapper->GetDeformation(), input, fit, tools);
  const auto warn = [&] {
    if (!tools.Warning.empty())
    {
      vtkWarningWithObjectMacro(mapper, << tools.Warning);
      tools.Warning.clear();
    }
  };
  warn();
  const bool mapped = made &&
    this->PullBack.Update(tools, this->Field.GetProduct(), bounds,
      static_cast<ffd::InverseMode>(mapper->GetInverseMode()),
      FindInverseTolerance(mapper) * voxel);
  warn();
  if (!mapped)
  {
    return false;
  }
  const ffd::Box& deformed = this->GetPullBack().DeformedBounds;
  for (int a = 0; a < 3; ++a)
  {
    this->ReportedBounds[2 * a] = deformed.Min[a];
    this->ReportedBounds[2 * a + 1] = deformed.Max[a];
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDFrameCache::FindMask(Mapper* mapper, std::string& message)
{
  const ffd::VolumeView& volume = this->GetVolume();
  this->Mask = ffd::MaskView();
  this->MaskArray = nullptr;
  this->MaskTime = 0;
  if (vtkImageData* image = mapper->GetMaskInput())
  {
    this->Mask.Labels = mapper->GetMaskType() == Mapper::LabelMapMaskType;
    this->Mask.BlendFactor = mapper->GetMaskBlendFactor();
    vtkDataArray* const ofPoints = image->GetPointData()->GetScalars();
    vtkDataArray* const ofCells = image->GetCellData()->GetScalars();
    // If there are both, those of what the scalars belong to.
    const bool cells = ofCells && (this->Voxels->OfCells || !ofPoints);
    this->MaskArray = cells ? ofCells : ofPoints;
    if (!vtkFFDVolumeViewFromImage(
          image, this->MaskArray, false, this->Mask.Volume, message, cells))
    {
      message = "MaskInput: " + message;
      return false;
    }
    this->MaskTime = std::max(image->GetMTime(), this->MaskArray->GetMTime());
    this->Mask.Volume.Margin = 0.0;
    this->Arrays.push_back(this->MaskArray);
    this->Mask.SameGrid = this->Mask.Volume.Dimensions == volume.Dimensions;
  }
  return true;
}

//------------------------------------------------------------------------------
/// That of two-dimensional transfer functions; `name` is null where it is the gradient, or the
/// functions have one dimension.
bool vtkFFDFrameCache::FindSecondAxis(const char* name, vtkDataSet* input, std::string& message)
{
  this->SecondAxis = ffd::VolumeView();
  this->SecondAxisArray = nullptr;
  if (name)
  {
    const bool ofCells = this->Voxels->OfCells;
    vtkDataArray* array =
      ofCells ? input->GetCellData()->GetArray(name) : input->GetPointData()->GetArray(name);
    if (!array)
    {
      message = "Transfer2DYAxisArray: the input has no " +
        std::string(ofCells ? "cell" : "point") + " array \"" + name +
        "\". Name one, or nullptr for the magnitude of the gradient.";
      return false;
    }
    if (!ffd::MakeFurtherView(this->Voxels.Get(), array, this->SecondAxis, message))
    {
      message = "Transfer2DYAxisArray: " + message;
      return false;
    }
    this->Arrays.push_back(array);
    this->SecondAxisArray = array;
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDFrameCache::UpdateBlocks(
  Mapper* mapper, vtkVolumeProperty* property, ffd::StageTools& tools)
{
  const ffd::VolumeView& volume = this->GetVolume();
  if (!ffd::FindComponentKind(
        property, volume.Components, volume.Type, this->Lookup.Kind, tools.Message))
  {
    return false;
  }
  this->Blocks.Update(tools, this->Voxels.GetProduct(),
    ffd::FindOpacityComponents(this->Lookup.Kind, volume.Components));
  std::array<double, 2> whole;
  std::copy_n(mapper->GetWholeScalarRange(), 2, whole.begin());
  const std::vector<ffd::MinMaxBlocks>& blocks = this->Blocks->Blocks;
  if (std::all_of(blocks.begin(), blocks.end(), [&](const ffd::MinMaxBlocks& each) {
        const ffd::MinMaxBlocks::Limits range =
          ffd::FindRangeOfWhole(each.GetRange(), volume.Components, whole);
        return range.Min > range.Max;
      }))
  {
    tools.Message = "The scalars of the input hold no finite number: nothing can be rendered.";
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
/// Limits of a binary mask in blocks, where they are those of the volume.
void vtkFFDFrameCache::UpdateMaskBlocks(ffd::StageTools& tools)
{
  const bool hides = this->Mask.Volume.Scalars && !this->Mask.Labels && this->Mask.SameGrid &&
    !this->GetVolume().Axes;
  this->MaskBlocks.Update(tools, ffd::UniformView{ hides ? this->Mask.Volume : ffd::VolumeView() },
    { hides ? this->MaskArray.Get() : nullptr, hides ? this->MaskTime : 0 });
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkFFDFrameCache::GetNumberOfBuilds(int part) const
{
  switch (part)
  {
    case Mapper::MIN_MAX_BLOCKS:
      return this->Blocks.GetNumberOfBuilds();
    case Mapper::DEFORMATION_FIELD:
      return this->Field.GetNumberOfBuilds();
    case Mapper::DEFORMATION_BOUNDS:
      return this->PullBack.GetLast().NumberOfBuilds;
    case Mapper::TRANSFER_TABLE:
      return this->Functions.GetNumberOfBuilds();
    case Mapper::DISTANCE_MAP:
      return this->Space.GetNumberOfBuilds();
    default:
      return -1;
  }
}

//------------------------------------------------------------------------------
std::size_t vtkFFDFrameCache::GetMemorySize() const
{
  const vtkDataArray* scalars = this->VectorScalars.GetLast();
  return this->Space.GetLast().GetMemorySize() + this->Functions.GetLast().GetMemorySize() +
    this->Field.GetMemorySize() + this->PullBack.GetLast().GetMemorySize() +
    this->Voxels.GetLast().Hidden.GetMemorySize() +
    (scalars ? static_cast<std::size_t>(scalars->GetActualMemorySize()) * 1024 : 0) +
    this->Blocks.GetLast().GetMemorySize() + this->MaskBlocks.GetLast().GetMemorySize() +
    this->Labels.GetLast().GetMemorySize();
}
