// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeRepresentation.h"

#include "vtkFFDCameraPlace.h"
#include "vtkFFDShownArray.h"
#include "vtkFFDShownLattice.h"
#include "vtkFFDVolumeRepresentationInternals.h"

#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCamera.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkOutlineSource.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProcessModule.h"
#include "vtkPVHardwareSelector.h"
#include "vtkPVLODVolume.h"
#include "vtkPVRenderView.h"
#include "vtkPVView.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

vtkStandardNewMacro(vtkFFDVolumeRepresentation);

namespace
{

using ffdparts::Bounds;
using ffdparts::Extent;
using ffdparts::Grid;

vtkMultiProcessController* GetController()
{
  return vtkMultiProcessController::GetGlobalController();
}

int GetNumberOfProcesses() { return GetController() ? GetController()->GetNumberOfProcesses() : 1; }

/// Those of this process.
std::vector<vtkFFDVolumeRepresentation*>& AllRepresentations()
{
  static std::vector<vtkFFDVolumeRepresentation*> all;
  return all;
}

/// Whether an algorithm is another one, or takes what ParaView makes of its output.
bool IsFrom(vtkAlgorithm* algorithm, vtkAlgorithm* source)
{
  constexpr int between = 2; // such as vtkPVPostFilter
  for (int i = 0; i <= between && algorithm; ++i)
  {
    if (algorithm == source)
    {
      return true;
    }
    algorithm = algorithm->GetNumberOfInputPorts() > 0 &&
        algorithm->GetNumberOfInputConnections(0) == 1 && algorithm->IsA("vtkPVPostFilter")
      ? algorithm->GetInputAlgorithm(0, 0)
      : nullptr;
  }
  return false;
}

/// Members of ParaView's selectors that are for their subclasses.
struct SelectorAccess : vtkPVHardwareSelector
{
  static void Share(vtkPVHardwareSelector* selector, vtkProp* from, vtkProp* to)
  {
    int& next = selector->*(&SelectorAccess::UniqueId);
    const int kept = next;
    next = (selector->*(&SelectorAccess::GetPropID))(0, from);
    selector->AssignUniqueId(to);
    next = kept;
  }
};

/**
 * Gives a prop the identifier that another one has in selections. Views count the identifiers in
 * each process, and one process, or the client, tells from them what was selected: props that only
 * some processes have may not be counted.
 */
struct ViewAccess : vtkPVRenderView
{
  static void ShareIdentifier(vtkPVRenderView* view, vtkProp* from, vtkProp* to)
  {
    SelectorAccess::Share(view->*(&ViewAccess::Selector), from, to);
  }
};

/// Writes bounds of all of several images, of which this is one, to its field data.
void NoteAllBounds(
  vtkImageData* image, const char* name, const Bounds& rest, const Bounds& deformed)
{
  std::array<double, 12> numbers{};
  std::copy(rest.begin(), rest.end(), numbers.begin());
  std::copy(deformed.begin(), deformed.end(), numbers.begin() + 6);
  auto* noted = vtkDoubleArray::SafeDownCast(image->GetFieldData()->GetArray(name));
  if (noted && std::equal(numbers.begin(), numbers.end(), noted->GetPointer(0)))
  {
    return;
  }
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfValues(static_cast<vtkIdType>(numbers.size()));
  std::copy(numbers.begin(), numbers.end(), array->GetPointer(0));
  image->GetFieldData()->AddArray(array);
}

/// The images of what the view was given: one, or the blocks of several.
std::vector<vtkImageData*> GetImages(vtkDataObject* data)
{
  std::vector<vtkImageData*> images;
  if (auto* image = vtkImageData::SafeDownCast(data))
  {
    images.push_back(image);
  }
  auto* blocks = vtkMultiBlockDataSet::SafeDownCast(data);
  for (unsigned int i = 0; blocks && i < blocks->GetNumberOfBlocks(); ++i)
  {
    images.push_back(vtkImageData::SafeDownCast(blocks->GetBlock(i)));
  }
  return images;
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDVolumeRepresentation::vtkFFDVolumeRepresentation()
  : Mapper(vtkFFDInverseRayVolumeMapper::New())
  , Internals(new vtkInternals)
{
  AllRepresentations().push_back(this);
  this->VolumeMapper.TakeReference(this->Mapper);
  // ParaView renders again for widgets below the pointer and for whatever else is shown.
  this->Mapper->StillFrameCoherenceOn();
  this->Internals->Frames->SetQuestion([this]() {
    return this->GetVisibility() && this->Actor->GetVisibility() &&
      this->Actor->GetMapper() == this->VolumeMapper;
  });
  this->Internals->Frames->AddMapper(this->Mapper);
  this->SetNumberOfVolumes(1);
  this->Internals->AllShown.emplace_back(new vtkInternals::Shown);
  this->Internals->AllShown.front()->Mapper = this->Mapper;
  this->Internals->AllShown.front()->Actor = this->Actor;
}

//------------------------------------------------------------------------------
vtkFFDVolumeRepresentation::~vtkFFDVolumeRepresentation()
{
  auto& all = AllRepresentations();
  all.erase(std::remove(all.begin(), all.end(), this), all.end());
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "UnitDistance: " << this->UnitDistance << "\n";
  os << indent << "SampleDistance: " << this->SampleDistance << "\n";
  os << indent << "ImageSampleDistance: " << this->ImageSampleDistance << "\n";
  os << indent << "Mapper:\n";
  this->Mapper->PrintSelf(os, indent.GetNextIndent());
}

//------------------------------------------------------------------------------
int vtkFFDVolumeRepresentation::FillInputPortInformation(int, vtkInformation* info)
{
  // Wider than what can be rendered: RequestData says what is wrong.
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObject");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDVolumeRepresentation::RequestData(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkMath::UninitializeBounds(this->DataBounds);
  this->DataSize = 0;
  vtkInternals& in = *this->Internals;
  std::copy(ffdparts::NoExtent.begin(), ffdparts::NoExtent.end(), this->WholeExtent);
  std::vector<vtkSmartPointer<vtkImageData>> images;
  if (inputs[0]->GetNumberOfInformationObjects() == 1)
  {
    vtkInformation* info = inputs[0]->GetInformationObject(0);
    vtkDataObject* input = vtkDataObject::GetData(info);
    std::string problem;
    images = in.Input.Update(input, problem);
    if (!problem.empty())
    {
      vtkErrorMacro(<< "The representation \"FFD Volume\" " << problem);
    }
    else if (images.size() == 1 && images.front())
    {
      vtkImageData* image = images.front();
      if (vtkImageData::SafeDownCast(input))
      {
        vtkStreamingDemandDrivenPipeline::GetWholeExtent(info, this->WholeExtent);
      }
      Extent whole;
      std::copy_n(this->WholeExtent, 6, whole.begin());
      if (ffdparts::IsEmpty(whole))
      {
        image->GetExtent(whole.data());
      }
      const int* sizes = image->GetDimensions();
      if (image->GetNumberOfPoints() > 0 &&
        (whole[0] == whole[1] || whole[2] == whole[3] || whole[4] == whole[5]))
      {
        vtkErrorMacro(<< "The representation \"FFD Volume\" renders volumes, and this image has "
                      << sizes[0] << " x " << sizes[1] << " x " << sizes[2]
                      << " points: it needs two along each axis. Choose \"Slice\" or \"Surface\".");
        images.clear();
      }
    }
  }
  this->SetNumberOfVolumes(std::max<std::size_t>(1, images.size()));
  Bounds allRest = ffdparts::NoBounds;
  Bounds allDeformed = ffdparts::NoBounds;
  std::vector<vtkImageData*> here;
  for (std::size_t i = 0; i < in.Volumes.size(); ++i)
  {
    vtkImageData* image = i < images.size() ? images[i].Get() : nullptr;
    image = image && image->GetNumberOfPoints() > 0 ? image : nullptr;
    in.Volumes[i]->Inputs.Image = image;
    if (!image)
    {
      continue;
    }
    here.push_back(image);
    if (GetNumberOfProcesses() > 1)
    {
      continue; // bounds are those of the parts of all
    }
    Extent extent;
    image->GetExtent(extent.data());
    vtkFFDLattice* lattice = in.Volumes[i]->Lattice;
    const bool hasLattice =
      vtkFFDLattice::HasLattice(image) && vtkFFDShownLattice::Read(image, lattice);
    const Grid grid = Grid::FromImage(image, extent);
    allRest = ffdparts::Unite(allRest, grid.GetBounds());
    allDeformed = ffdparts::Unite(allDeformed,
      in.Volumes[i]->BoundsFinder.Find(
        grid, hasLattice ? lattice : nullptr, this->Mapper->GetInverseMode()));
  }
  if (!ffdparts::IsEmpty(allDeformed))
  {
    std::copy(allDeformed.begin(), allDeformed.end(), this->DataBounds);
    for (vtkImageData* image : here)
    {
      if (images.size() > 1)
      {
        NoteAllBounds(image, vtkInternals::AllBoundsName, allRest, allDeformed);
      }
    }
  }
  this->UpdateOutline();
  this->HoldImages(here);
  // A client, or a rank without data, shows the outline.
  this->Actor->SetEnableLOD(here.empty() ? 1 : 0);
  return this->vtkVolumeRepresentation::RequestData(request, inputs, outputs);
}

//------------------------------------------------------------------------------
/// The images that this process hands over to the view.
void vtkFFDVolumeRepresentation::HoldImages(const std::vector<vtkImageData*>& images)
{
  this->DataSize = 0;
  for (vtkImageData* image : images)
  {
    this->DataSize += image->GetActualMemorySize();
  }
  if (images.empty())
  {
    // An empty data object for the delivery.
    this->Cache = vtkSmartPointer<vtkPartitionedDataSet>::New();
    this->VolumeMapper->RemoveAllInputs();
    return;
  }
  if (images.size() == 1)
  {
    this->Cache = images.front();
    return;
  }
  auto blocks = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  for (unsigned int i = 0; i < images.size(); ++i)
  {
    blocks->SetBlock(i, images[i]);
  }
  this->Cache = blocks;
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetNumberOfVolumes(std::size_t count)
{
  auto& volumes = this->Internals->Volumes;
  volumes.resize(std::min(count, volumes.size()));
  while (volumes.size() < count)
  {
    volumes.emplace_back(new vtkInternals::Volume);
  }
}

//------------------------------------------------------------------------------
/// What shows the images after the first: mappers and actors in the scene, options not yet set.
void vtkFFDVolumeRepresentation::SetNumberOfShown(std::size_t count)
{
  vtkInternals& in = *this->Internals;
  auto* view = vtkPVRenderView::SafeDownCast(this->GetView());
  while (in.AllShown.size() > std::max<std::size_t>(1, count))
  {
    if (view)
    {
      view->GetRenderer()->RemoveVolume(in.AllShown.back()->Actor);
    }
    in.AllShown.pop_back();
  }
  while (in.AllShown.size() < count)
  {
    std::unique_ptr<vtkInternals::Shown> shown(new vtkInternals::Shown);
    shown->Mapper = vtkSmartPointer<vtkFFDInverseRayVolumeMapper>::New();
    shown->Actor = vtkSmartPointer<vtkVolume>::New();
    shown->Actor->SetMapper(shown->Mapper);
    in.Frames->AddMapper(shown->Mapper);
    if (view)
    {
      view->GetRenderer()->AddVolume(shown->Actor);
      ViewAccess::ShareIdentifier(view, this->Actor, shown->Actor);
    }
    in.AllShown.push_back(std::move(shown));
    in.OptionsTime = 0;
  }
}

//------------------------------------------------------------------------------
int vtkFFDVolumeRepresentation::ProcessViewRequest(
  vtkInformationRequestKey* request, vtkInformation* inInfo, vtkInformation* outInfo)
{
  if (request == vtkPVView::REQUEST_RENDER())
  {
    // Not the superclass's: it connects the mapper to what was delivered.
    if (!this->vtkVolumeRepresentation::ProcessViewRequest(request, inInfo, outInfo))
    {
      return 0;
    }
    this->Internals->RenderTime.Modified();
    const bool useLOD = inInfo->Has(vtkPVRenderView::USE_LOD()) != 0;
    const auto getProducer = [this, inInfo, useLOD](int port) {
      return useLOD ? vtkPVRenderView::GetPieceProducerLOD(inInfo, this, port)
                    : vtkPVRenderView::GetPieceProducer(inInfo, this, port);
    };
    vtkAlgorithmOutput* producer = getProducer(0);
    const std::vector<vtkImageData*> images = GetImages(
      producer ? producer->GetProducer()->GetOutputDataObject(producer->GetIndex()) : nullptr);
    this->UpdateMapperParameters();
    this->SetNumberOfShown(images.size());
    this->UpdateOtherVolumes();
    auto* view = vtkPVRenderView::SafeDownCast(inInfo->Get(vtkPVView::VIEW()));
    vtkRenderWindow* window = view ? view->GetRenderWindow() : nullptr;
    if (window && this->NextRate > window->GetDesiredUpdateRate())
    {
      window->SetDesiredUpdateRate(this->NextRate);
    }
    this->NextRate = 0.0;
    const auto color = vtkFFDShownArray::FromInformation(this->GetInputArrayInformation(0));
    const bool anyHasArray = std::any_of(images.begin(), images.end(),
      [&color](vtkImageData* image) { return image && color.FindIn(image); });
    // Other processes may have the blocks that have it.
    Extent whole;
    std::copy_n(this->WholeExtent, 6, whole.begin());
    const bool lacksArray =
      !anyHasArray && (GetNumberOfProcesses() == 1 || !ffdparts::IsEmpty(whole));
    for (std::size_t i = 0; i < this->Internals->AllShown.size(); ++i)
    {
      vtkImageData* image = i < images.size() ? images[i] : nullptr;
      vtkFFDInverseRayVolumeMapper* mapper = this->Internals->AllShown[i]->Mapper;
      this->UpdateRenderedImage(i, image);
      if (image)
      {
        this->UpdateSampleDistances(mapper, image, view, useLOD);
        this->UpdateCropping(mapper, image);
      }
      const bool hasArray = image && color.FindIn(image);
      if (hasArray || (image && i == 0 && lacksArray))
      {
        this->ReportProblem(i, hasArray);
      }
      // As the superclass's actor of the first: blocks may lack the array.
      if (i > 0 && !hasArray)
      {
        this->Internals->AllShown[i]->Actor->SetVisibility(0);
      }
    }
    this->Internals->OptionsTime = this->Mapper->GetMTime();
    this->OutlineMapper->SetInputConnection(getProducer(1));
    return 1;
  }
  if (request == vtkPVView::REQUEST_UPDATE_LOD())
  {
    if (!this->Superclass::ProcessViewRequest(request, inInfo, outInfo))
    {
      return 0;
    }
    // Before frames of moving scenes the view delivers no other pieces than these.
    vtkPVRenderView::SetPieceLOD(inInfo, this, this->Cache, this->DataSize, 0);
    vtkPVRenderView::SetPieceLOD(inInfo, this, this->OutlineSource->GetOutputDataObject(0), 0, 1);
    return 1;
  }
  if (request == vtkPVView::REQUEST_UPDATE())
  {
    // Not the superclass's: it hands over the data before they are shared out.
    if (!this->vtkVolumeRepresentation::ProcessViewRequest(request, inInfo, outInfo))
    {
      return 0;
    }
    if (GetNumberOfProcesses() == 1)
    {
      this->Actor->ComputeMatrix();
      ffdparts::Bounds place;
      std::copy_n(this->DataBounds, place.size(), place.begin());
      this->HandOver(inInfo,
        vtkMath::AreBoundsInitialized(this->DataBounds)
          ? ffdparts::Transform(place, this->Actor->GetMatrix())
          : place);
    }
    else
    {
      // All volumes of the view share one partition: the last one that is updated makes it.
      const std::vector<vtkFFDVolumeRepresentation*> shown = this->FindShownVolumes();
      if (shown.empty() || shown.back() == this)
      {
        ShareOut(shown);
        for (vtkFFDVolumeRepresentation* each : shown)
        {
          each->HandOver(inInfo, each->Internals->Volumes.front()->Distribution.GetOwnBox());
        }
      }
    }
    outInfo->Set(vtkPVRenderView::NEED_ORDERED_COMPOSITING(), 1);
    return 1;
  }
  return this->Superclass::ProcessViewRequest(request, inInfo, outInfo);
}

//------------------------------------------------------------------------------
bool vtkFFDVolumeRepresentation::AddToView(vtkView* view)
{
  if (!this->Superclass::AddToView(view))
  {
    return false;
  }
  vtkInternals& in = *this->Internals;
  auto* renderView = vtkPVRenderView::SafeDownCast(view);
  vtkRenderer* renderer = renderView->GetRenderer();
  for (std::size_t i = 1; i < in.AllShown.size(); ++i)
  {
    renderer->AddVolume(in.AllShown[i]->Actor);
    ViewAccess::ShareIdentifier(renderView, this->Actor, in.AllShown[i]->Actor);
  }
  in.Frames->Connect(renderer);
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDVolumeRepresentation::RemoveFromView(vtkView* view)
{
  if (auto* renderView = vtkPVRenderView::SafeDownCast(view))
  {
    this->Internals->Frames->Disconnect(renderView->GetRenderer());
    for (std::size_t i = 1; i < this->Internals->AllShown.size(); ++i)
    {
      renderView->GetRenderer()->RemoveVolume(this->Internals->AllShown[i]->Actor);
    }
  }
  return this->Superclass::RemoveFromView(view);
}

//------------------------------------------------------------------------------
/// Give the view what this process renders; `place` is its part of the scene. (With a matrix
/// vtkPVRenderView would transform the first and the last corner of a box alone.)
void vtkFFDVolumeRepresentation::HandOver(vtkInformation* view, const std::array<double, 6>& place)
{
  vtkPVRenderView::SetPiece(view, this, this->Cache, this->DataSize, 0);
  // The volume is never brought to the client, which shows the outline while it has no picture.
  vtkPVRenderView::SetDeliverToClientAndRenderingProcesses(view, this, false, false, 0);
  vtkPVRenderView::SetPiece(view, this, this->OutlineSource->GetOutputDataObject(0), 0, 1);
  vtkPVRenderView::SetGeometryBounds(view, this, place.data());
  vtkPVRenderView::SetRequiresDistributedRendering(view, this, true);
  vtkPVRenderView::SetOrderedCompositingConfiguration(
    view, this, vtkPVRenderView::USE_BOUNDS_FOR_REDISTRIBUTION);
}

//------------------------------------------------------------------------------
/// Those of the view that are visible, in the order in which it updates them.
std::vector<vtkFFDVolumeRepresentation*> vtkFFDVolumeRepresentation::FindShownVolumes()
{
  std::vector<vtkFFDVolumeRepresentation*> shown;
  vtkView* view = this->GetView();
  for (int i = 0; view && i < view->GetNumberOfRepresentations(); ++i)
  {
    auto* each = vtkFFDVolumeRepresentation::SafeDownCast(view->GetRepresentation(i));
    if (each && each->GetVisibility())
    {
      shown.push_back(each);
    }
  }
  return shown;
}

//------------------------------------------------------------------------------
/// The other volumes of the view get other parts, and the view takes those only from what is
/// modified.
void vtkFFDVolumeRepresentation::MarkOthersModified()
{
  if (GetNumberOfProcesses() == 1 &&
    vtkProcessModule::GetProcessType() != vtkProcessModule::PROCESS_CLIENT)
  {
    return;
  }
  for (vtkFFDVolumeRepresentation* each : this->FindShownVolumes())
  {
    if (each != this)
    {
      each->Superclass::MarkModified();
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::MarkModified()
{
  this->Superclass::MarkModified();
  if (this->GetVisibility())
  {
    this->MarkOthersModified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetVisibility(bool visible)
{
  const bool changes = visible != this->GetVisibility();
  this->Superclass::SetVisibility(visible);
  for (std::size_t i = 1; i < this->Internals->AllShown.size(); ++i)
  {
    this->Internals->AllShown[i]->Actor->SetVisibility(visible);
  }
  if (changes)
  {
    this->MarkOthersModified();
  }
}

//------------------------------------------------------------------------------
/// Take the parts of the volumes that this process is to render. Called on all processes.
void vtkFFDVolumeRepresentation::ShareOut(const std::vector<vtkFFDVolumeRepresentation*>& volumes)
{
  std::vector<vtkFFDVoxelDistribution*> distributions;
  for (vtkFFDVolumeRepresentation* each : volumes)
  {
    each->DescribeInputs();
    for (const auto& volume : each->Internals->Volumes)
    {
      distributions.push_back(&volume->Distribution);
    }
  }
  vtkFFDVoxelDistribution::UpdateAll(GetController(), distributions);
  for (vtkFFDVolumeRepresentation* each : volumes)
  {
    each->TakeParts();
  }
}

//------------------------------------------------------------------------------
/// What the distribution depends on. Called on all processes.
void vtkFFDVolumeRepresentation::DescribeInputs()
{
  vtkInternals& in = *this->Internals;
  if (this->SharedThreads == 0)
  {
    this->SharedThreads = ffdparts::FindNumberOfThreads(GetController());
    this->SetNumberOfThreads(this->Threads);
  }
  this->Actor->ComputeMatrix();
  for (const auto& volume : in.Volumes)
  {
    vtkFFDVoxelDistribution::Inputs& inputs = volume->Inputs;
    inputs.Time = inputs.Image ? inputs.Image->GetMTime() : 0;
    std::copy_n(this->WholeExtent, 6, inputs.WholeExtent.begin());
    inputs.Shown = vtkFFDShownArray::FromInformation(this->GetInputArrayInformation(0));
    inputs.InverseMode = this->Mapper->GetInverseMode();
    inputs.HasOrder = this->Mapper->GetBlendMode() == vtkVolumeMapper::COMPOSITE_BLEND;
    std::copy_n(this->Actor->GetMatrix()->GetData(), 16, inputs.Matrix.begin());
    volume->Distribution.SetInputs(inputs);
  }
}

//------------------------------------------------------------------------------
/// Show what the distribution gave this process.
void vtkFFDVolumeRepresentation::TakeParts()
{
  vtkInternals& in = *this->Internals;
  Bounds allRest = ffdparts::NoBounds;
  Bounds allDeformed = ffdparts::NoBounds;
  std::vector<vtkImageData*> parts;
  for (const auto& volume : in.Volumes)
  {
    const vtkFFDVoxelDistribution& distribution = volume->Distribution;
    if (!ffdparts::IsEmpty(distribution.GetDeformedBounds()))
    {
      allRest = ffdparts::Unite(allRest, distribution.GetRestBounds());
      allDeformed = ffdparts::Unite(allDeformed, distribution.GetDeformedBounds());
    }
    if (distribution.GetPart())
    {
      parts.push_back(distribution.GetPart());
    }
  }
  for (vtkImageData* part : parts)
  {
    if (in.Volumes.size() > 1)
    {
      NoteAllBounds(part, vtkInternals::AllBoundsName, allRest, allDeformed);
    }
  }
  this->HoldImages(parts);
  this->Actor->SetEnableLOD(0); // outlines are for a client
  std::copy(allDeformed.begin(), allDeformed.end(), this->DataBounds);
  this->UpdateOutline();
}

//------------------------------------------------------------------------------
/// Makes the outline of the bounds of the data; without data there is none.
void vtkFFDVolumeRepresentation::UpdateOutline()
{
  if (vtkMath::AreBoundsInitialized(this->DataBounds))
  {
    this->OutlineSource->SetBounds(this->DataBounds);
    this->OutlineSource->Update();
  }
  else
  {
    this->OutlineSource->GetOutput()->Initialize();
    this->OutlineSource->Modified(); // so that it is made again for the same bounds
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::UpdateMapperParameters()
{
  // Not the superclass's: it selects the array that UpdateRenderedImage() may have to derive from.
  if (this->Actor->GetMapper() != this->VolumeMapper)
  {
    this->Actor->SetMapper(this->VolumeMapper);
  }
  this->Actor->SetVisibility(
    !vtkFFDShownArray::FromInformation(this->GetInputArrayInformation(0)).Name.empty());
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::Pick(
  double x0, double y0, double z0, double x1, double y1, double z1)
{
  const double from[3] = { x0, y0, z0 };
  const double to[3] = { x1, y1, z1 };
  ffdpicking::Picked& picked = this->Internals->Picked;
  picked = {};
  auto* view = vtkPVRenderView::SafeDownCast(this->GetView());
  if (view && this->GetVisibility() && this->VolumeMapper->GetInputDataObject(0, 0))
  {
    std::vector<vtkVolume*> volumes;
    for (const auto& shown : this->Internals->AllShown)
    {
      volumes.push_back(shown->Actor);
    }
    picked = ffdpicking::PickVolumes(volumes, view->GetRenderer(), from, to);
  }
  vtkMultiProcessController* controller = GetController();
  if (GetNumberOfProcesses() > 1)
  {
    // The nearest one counts.
    const double here = picked.Numbers[0] > 0.0
      ? vtkMath::Distance2BetweenPoints(from, &picked.Numbers[1])
      : VTK_DOUBLE_MAX;
    std::vector<double> distances(static_cast<std::size_t>(GetNumberOfProcesses()));
    controller->AllGather(&here, distances.data(), 1);
    const auto nearest = std::min_element(distances.begin(), distances.end());
    const auto root = static_cast<int>(nearest - distances.begin());
    controller->Broadcast(
      picked.Numbers.data(), static_cast<vtkIdType>(picked.Numbers.size()), root);
    controller->Broadcast(picked.Normal.data(), 3, root);
  }
}

//------------------------------------------------------------------------------
vtkFFDVolumeRepresentation* vtkFFDVolumeRepresentation::FindShownBy(
  vtkAlgorithm* input, const double from[3], const double to[3])
{
  vtkFFDVolumeRepresentation* found = nullptr;
  double ray[3];
  vtkMath::Subtract(to, from, ray);
  vtkMath::Normalize(ray);
  for (vtkFFDVolumeRepresentation* each : AllRepresentations())
  {
    auto* view = vtkPVRenderView::SafeDownCast(each->GetView());
    if (!view || !each->GetVisibility() || !IsFrom(each->GetInputAlgorithm(0, 0), input))
    {
      continue;
    }
    vtkFFDCameraPlace place(view->GetActiveCamera());
    if (!view->GetActiveCamera()->GetParallelProjection())
    {
      vtkMath::Subtract(to, place.Position, place.Direction);
      vtkMath::Normalize(place.Direction);
    }
    // Linked cameras are the same. The view that is picked in was the last to be rendered.
    constexpr double cosine = 1.0 - 1e-6; // of a tenth of a degree
    if (vtkMath::Dot(ray, place.Direction) > cosine &&
      !(found && found->Internals->RenderTime > each->Internals->RenderTime))
    {
      found = each;
    }
  }
  return found;
}

//------------------------------------------------------------------------------
const double* vtkFFDVolumeRepresentation::GetPickedNormal()
{
  return this->Internals->Picked.Normal.data();
}

//------------------------------------------------------------------------------
double* vtkFFDVolumeRepresentation::GetPicked() { return this->Internals->Picked.Numbers.data(); }

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetPicked(const double picked[8])
{
  std::copy_n(picked, 8, this->Internals->Picked.Numbers.begin());
}
