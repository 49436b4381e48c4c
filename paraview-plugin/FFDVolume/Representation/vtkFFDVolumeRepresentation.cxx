// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeRepresentation.h"

#include "vtkFFDCompositePass.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDRenderedImage.h"
#include "vtkFFDServerFrames.h"
#include "vtkFFDShownArray.h"
#include "vtkFFDVolumeInput.h"
#include "vtkFFDVolumeOrder.h"
#include "vtkFFDVolumeParts.h"
#include "vtkFFDVolumePicker.h"
#include "vtkFFDVoxelDistribution.h"

#include "vtkAbstractMapper.h"
#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkCommand.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkImageResize.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkOutlineSource.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProcessModule.h"
#include "vtkPVLODVolume.h"
#include "vtkPVProgressHandler.h"
#include "vtkPVRenderView.h"
#include "vtkPVSession.h"
#include "vtkPVView.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTimeStamp.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

vtkStandardNewMacro(vtkFFDVolumeRepresentation);

namespace
{

using ffdparts::Bounds;
using ffdparts::Extent;
using ffdparts::Grid;

/// Seconds between messages of progress, and looks for an abort, in frames of a server.
constexpr double ServerProgressInterval = 0.1;

/// Largest factor by which interactive images are coarser, in each way.
constexpr double LargestCoarsening = 10.0;

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

/// In the field data of one of several images: bounds of all of them at rest, then deformed.
const char* const AllBoundsName = "FFDVolume.AllBounds";

void NoteAllBounds(vtkImageData* image, const Bounds& rest, const Bounds& deformed)
{
  std::array<double, 12> numbers{};
  std::copy(rest.begin(), rest.end(), numbers.begin());
  std::copy(deformed.begin(), deformed.end(), numbers.begin() + 6);
  auto* noted = vtkDoubleArray::SafeDownCast(image->GetFieldData()->GetArray(AllBoundsName));
  if (noted && std::equal(numbers.begin(), numbers.end(), noted->GetPointer(0)))
  {
    return;
  }
  vtkNew<vtkDoubleArray> array;
  array->SetName(AllBoundsName);
  array->SetNumberOfValues(static_cast<vtkIdType>(numbers.size()));
  std::copy(numbers.begin(), numbers.end(), array->GetPointer(0));
  image->GetFieldData()->AddArray(array);
}

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
class vtkFFDVolumeRepresentation::vtkInternals
{
public:
  vtkFFDVolumeInput Input;

  /// A volume of the scene: of all blocks with the same lattice.
  struct Volume
  {
    vtkFFDVoxelDistribution::Inputs Inputs; // what this process was given
    vtkFFDVoxelDistribution Distribution;   // with several processes
    vtkNew<vtkFFDLattice> Lattice;          // as it was read last
    ffdparts::DeformedBoundsFinder BoundsFinder;
  };
  std::vector<std::unique_ptr<Volume>> Volumes; // one at least; as many on all processes

  /// What this process shows of them.
  struct Shown
  {
    vtkSmartPointer<vtkFFDInverseRayVolumeMapper> Mapper;
    vtkSmartPointer<vtkVolume> Actor;
    vtkFFDRenderedImage Rendered;
  };
  std::vector<std::unique_ptr<Shown>>
    AllShown;                          // one at least, by the superclass's mapper and actor
  vtkSmartPointer<vtkImageData> Table; // the two-dimensional function as ParaView has it
  vtkNew<vtkImageResize> FineTable;    // of it, what the property has
  vtkMTimeType OptionsTime = 0;        // of the first mapper, when the others had its options

  int Threads = 0;       // SetNumberOfThreads(); 0: all that are there
  int SharedThreads = 0; // these, with several processes; 0: not known

  // Of the renderer of the view.
  std::array<unsigned long, 2> RenderObservers{ { 0, 0 } };
  bool TookPeelingOff = false;
  bool TookSmoothingOff = false;
  bool HasOwnRenderer = false;              // no other process renders the scene or shows it
  vtkWeakPointer<vtkPVSession> Session;     // whose progress is told
  vtkWeakPointer<vtkRenderWindow> Window;   // of the frame in progress
  vtkWeakPointer<vtkOpenGLState> KeptState; // of the window, while progress is shown
  double ProgressInterval = 0.0;            // of the session before the frame; 0: not changed
  double NextRate = 0.0;                    // RenderNextAtRate(); 0: as asked
  vtkTimeStamp RenderTime;                  // of the last frame of the view
  std::array<double, 8> Picked{};           // GetPicked()
  std::array<double, 3> PickedNormal{};     // of the surface that was picked
  vtkNew<vtkFFDCompositePass> OwnPass;
  vtkSmartPointer<vtkFFDCompositePass> Pass; // that of the frame: its own or another volume's
};

//------------------------------------------------------------------------------
vtkFFDVolumeRepresentation::vtkFFDVolumeRepresentation()
  : Mapper(vtkFFDInverseRayVolumeMapper::New())
  , Internals(new vtkInternals)
{
  AllRepresentations().push_back(this);
  this->VolumeMapper.TakeReference(this->Mapper);
  this->ObserveMapper(this->Mapper);
  this->SetNumberOfVolumes(1);
  this->Internals->AllShown.emplace_back(new vtkInternals::Shown);
  this->Internals->AllShown.front()->Mapper = this->Mapper;
  this->Internals->AllShown.front()->Actor = this->Actor;
  // Messages of progress are what a client may answer with a request for an abort.
  this->Internals->OwnPass->SetWait(
    [this]() { this->Mapper->UpdateProgress(this->Mapper->GetProgress()); });
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
    const bool hasLattice = vtkFFDLattice::HasLattice(image) && lattice->ReadFrom(image);
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
        NoteAllBounds(image, allRest, allDeformed);
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
      view->UnRegisterPropForHardwareSelection(this, in.AllShown.back()->Actor);
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
    this->ObserveMapper(shown->Mapper);
    if (in.Session && in.Session->GetProgressHandler())
    {
      in.Session->GetProgressHandler()->RegisterProgressEvent(shown->Mapper, 0);
    }
    if (view)
    {
      view->GetRenderer()->AddVolume(shown->Actor);
      view->RegisterPropForHardwareSelection(this, shown->Actor);
    }
    in.AllShown.push_back(std::move(shown));
    in.OptionsTime = 0;
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::ObserveMapper(vtkFFDInverseRayVolumeMapper* mapper)
{
  mapper->SetProgressText("FFD Volume");
  mapper->AddObserver(
    vtkCommand::VolumeMapperRenderStartEvent, this, &vtkFFDVolumeRepresentation::BeginVolume);
  mapper->AddObserver(vtkCommand::ProgressEvent, this, &vtkFFDVolumeRepresentation::ContinueVolume);
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
    if (window && this->Internals->NextRate > window->GetDesiredUpdateRate())
    {
      window->SetDesiredUpdateRate(this->Internals->NextRate);
    }
    this->Internals->NextRate = 0.0;
    const auto color = vtkFFDShownArray::FromInformation(this->GetInputArrayInformation(0));
    for (std::size_t i = 0; i < this->Internals->AllShown.size(); ++i)
    {
      vtkImageData* image = i < images.size() ? images[i] : nullptr;
      vtkFFDInverseRayVolumeMapper* mapper = this->Internals->AllShown[i]->Mapper;
      this->UpdateRenderedImage(i, image);
      if (image)
      {
        this->UpdateSampleDistances(mapper, image, view ? view->GetLODResolution() : 1.0, useLOD);
        this->UpdateCropping(mapper, image);
      }
      // As the superclass's actor of the first: blocks may lack the array.
      if (i > 0 && !(image && color.FindIn(image)))
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
      this->HandOver(inInfo, this->DataBounds,
        vtkMath::AreBoundsInitialized(this->DataBounds) ? this->Actor->GetMatrix() : nullptr);
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
          each->HandOver(
            inInfo, each->Internals->Volumes.front()->Distribution.GetOwnBox().data(), nullptr);
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
  // Frames show how far they are where pipelines do. A client's window is not to draw the picture
  // of its server in the OpenGL context of what shows the progress.
  vtkInternals& in = *this->Internals;
  vtkProcessModule* processes = vtkProcessModule::GetProcessModule();
  auto* session = vtkPVSession::SafeDownCast(processes && processes->GetActiveSession()
      ? processes->GetActiveSession()
      : (processes ? processes->GetSession() : nullptr));
  const auto type = vtkProcessModule::GetProcessType();
  const bool ownWindow =
    type == vtkProcessModule::PROCESS_CLIENT || type == vtkProcessModule::PROCESS_BATCH;
  const bool toClient = session && session->GetController(vtkPVSession::CLIENT);
  in.HasOwnRenderer = GetNumberOfProcesses() == 1 && session &&
    session->GetProcessRoles() == vtkPVSession::CLIENT_AND_SERVERS;
  if ((ownWindow || toClient) && session && session->GetProgressHandler() && !in.Session)
  {
    in.Session = session;
    session->GetProgressHandler()->RegisterProgressEvent(this->Mapper, 0);
    if (toClient)
    {
      ffdserver::Listen(session);
    }
    else
    {
      session->GetProgressHandler()->AddObserver(
        vtkCommand::ProgressEvent, this, &vtkFFDVolumeRepresentation::KeepContext, 1.0f);
      session->GetProgressHandler()->AddObserver(
        vtkCommand::ProgressEvent, this, &vtkFFDVolumeRepresentation::TakeContextBack, -1.0f);
    }
  }
  vtkRenderer* renderer = vtkPVRenderView::SafeDownCast(view)->GetRenderer();
  for (std::size_t i = 1; i < in.AllShown.size(); ++i)
  {
    renderer->AddVolume(in.AllShown[i]->Actor);
    vtkPVRenderView::SafeDownCast(view)->RegisterPropForHardwareSelection(
      this, in.AllShown[i]->Actor);
  }
  this->Internals->RenderObservers = {
    { renderer->AddObserver(vtkCommand::StartEvent, this, &vtkFFDVolumeRepresentation::BeginRender),
      renderer->AddObserver(vtkCommand::EndEvent, this, &vtkFFDVolumeRepresentation::EndRender) }
  };
  return true;
}

//------------------------------------------------------------------------------
bool vtkFFDVolumeRepresentation::RemoveFromView(vtkView* view)
{
  if (auto* renderView = vtkPVRenderView::SafeDownCast(view))
  {
    for (const unsigned long observer : this->Internals->RenderObservers)
    {
      renderView->GetRenderer()->RemoveObserver(observer);
    }
    for (std::size_t i = 1; i < this->Internals->AllShown.size(); ++i)
    {
      vtkVolume* actor = this->Internals->AllShown[i]->Actor;
      renderView->UnRegisterPropForHardwareSelection(this, actor);
      renderView->GetRenderer()->RemoveVolume(actor);
    }
  }
  return this->Superclass::RemoveFromView(view);
}

//------------------------------------------------------------------------------
/// Called on all rendering processes alike.
void vtkFFDVolumeRepresentation::BeginRender(vtkObject* object, unsigned long, void*)
{
  vtkRenderer* renderer = vtkRenderer::SafeDownCast(object);
  if (!this->GetVisibility() || !this->Actor->GetVisibility() ||
    this->Actor->GetMapper() != this->VolumeMapper)
  {
    return;
  }
  vtkInternals& in = *this->Internals;
  in.Window = renderer->GetRenderWindow();
  ffdorder::SortVolumes(renderer);
  vtkPVProgressHandler* progress = in.Session ? in.Session->GetProgressHandler() : nullptr;
  if (progress && progress->GetProgressInterval() > ServerProgressInterval)
  {
    in.ProgressInterval = progress->GetProgressInterval();
    progress->SetProgressInterval(ServerProgressInterval);
  }
  // The passes of depth peeling ask a volume for more than a picture: what they get from mappers
  // that do not know them is garbage all over the view.
  if (renderer->GetUseDepthPeelingForVolumes())
  {
    this->Internals->TookPeelingOff = true;
    renderer->SetUseDepthPeelingForVolumes(false);
  }
  // Synchronizers of renderers, of which a session without a server has none, smooth the finished
  // picture instead.
  if (renderer->GetUseFXAA() && in.HasOwnRenderer && ffdorder::IsEmptyBeforeVolumes(renderer))
  {
    in.TookSmoothingOff = true;
    renderer->SetUseFXAA(false);
  }
  // Without shading no color is brighter than its alpha.
  const bool mayBeBright = this->Property && this->Property->GetShade();
  if (mayBeBright || ffdserver::IsGroup())
  {
    this->Internals->Pass = this->Internals->OwnPass->Begin(renderer, mayBeBright);
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::BeginVolume()
{
  if (this->Internals->Pass)
  {
    this->Internals->Pass->BlendInFloats();
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::ContinueVolume(vtkObject* mapper, unsigned long, void*)
{
  if (ffdserver::IsAbortAsked(this->Internals->Session))
  {
    vtkAlgorithm::SafeDownCast(mapper)->SetAbortExecute(1);
  }
}

//------------------------------------------------------------------------------
/// What shows the progress paints widgets, in OpenGL contexts of theirs. The one with the window
/// may be among them, as after its size has changed: then it binds another framebuffer, which VTK
/// does not know of, and nothing of the rest of the frame would be seen.
void vtkFFDVolumeRepresentation::KeepContext()
{
  vtkInternals& in = *this->Internals;
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(in.Window);
  if (window && !in.KeptState)
  {
    in.KeptState = window->GetState();
    in.KeptState->Push();
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::TakeContextBack()
{
  vtkInternals& in = *this->Internals;
  if (in.Window)
  {
    in.Window->MakeCurrent();
  }
  if (in.KeptState)
  {
    in.KeptState->Pop();
    in.KeptState = nullptr;
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::EndRender(vtkObject* object, unsigned long, void*)
{
  if (this->Internals->TookPeelingOff)
  {
    this->Internals->TookPeelingOff = false;
    vtkRenderer::SafeDownCast(object)->SetUseDepthPeelingForVolumes(true);
  }
  vtkInternals& in = *this->Internals;
  if (in.TookSmoothingOff)
  {
    in.TookSmoothingOff = false;
    vtkRenderer::SafeDownCast(object)->SetUseFXAA(true);
  }
  if (in.ProgressInterval > 0.0 && in.Session && in.Session->GetProgressHandler())
  {
    in.Session->GetProgressHandler()->SetProgressInterval(in.ProgressInterval);
    in.ProgressInterval = 0.0;
  }
  in.Window = nullptr;
  in.Pass = nullptr;
  in.OwnPass->End();
}

//------------------------------------------------------------------------------
/// Give the view what this process renders; `place` is its part of the scene, after the matrix if
/// that is not null.
void vtkFFDVolumeRepresentation::HandOver(
  vtkInformation* view, const double place[6], vtkMatrix4x4* toScene)
{
  vtkPVRenderView::SetPiece(view, this, this->Cache, this->DataSize, 0);
  // The volume is never brought to the client, which shows the outline while it has no picture.
  vtkPVRenderView::SetDeliverToClientAndRenderingProcesses(view, this, false, false, 0);
  vtkPVRenderView::SetPiece(view, this, this->OutlineSource->GetOutputDataObject(0), 0, 1);
  vtkPVRenderView::SetGeometryBounds(view, this, place, toScene);
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
  if (in.SharedThreads == 0)
  {
    in.SharedThreads = ffdparts::FindNumberOfThreads(GetController());
    this->SetNumberOfThreads(in.Threads);
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
      NoteAllBounds(part, allRest, allDeformed);
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
/// Finds the components of the image that are rendered, as ParaView's own Volume does.
vtkFFDShownComponents vtkFFDVolumeRepresentation::FindShown(vtkImageData* image)
{
  vtkFFDShownComponents shown;
  shown.Color.Array = vtkFFDShownArray::FromInformation(this->GetInputArrayInformation(0));
  vtkColorTransferFunction* colors =
    this->Property ? this->Property->GetRGBTransferFunction(0) : nullptr;
  if (colors && colors->GetVectorMode() == vtkScalarsToColors::COMPONENT)
  {
    shown.Color.Component = colors->GetVectorComponent();
  }
  const auto choose = [image](const std::string& name, int association, int component) {
    vtkFFDShownComponent chosen;
    chosen.Array.Name = name;
    chosen.Array.OfCells = association == vtkDataObject::FIELD_ASSOCIATION_CELLS;
    vtkDataArray* array = chosen.Array.FindIn(image);
    // After the last component ParaView lists the magnitude.
    chosen.Component = array && component < array->GetNumberOfComponents()
      ? component
      : vtkFFDShownComponent::Magnitude;
    return array ? chosen : vtkFFDShownComponent();
  };
  if (this->UsesPlane())
  {
    if (!this->UseGradientForTransfer2D)
    {
      shown.Second = choose(
        this->ColorArray2Name, this->ColorArray2FieldAssociation, this->ColorArray2Component);
    }
    return shown;
  }
  if (this->UseSeparateOpacityArray)
  {
    shown.Opacity = choose(
      this->OpacityArrayName, this->OpacityArrayFieldAssociation, this->OpacityArrayComponent);
    return shown;
  }
  vtkDataArray* array = shown.Color.Array.FindIn(image);
  const int components = array ? array->GetNumberOfComponents() : 0;
  if ((this->MultiComponentsMapping || !this->MapScalars) && (components == 2 || components == 4))
  {
    shown.Color.Component = vtkFFDShownComponent::All;
  }
  return shown;
}

//------------------------------------------------------------------------------
/// Whether a two-dimensional transfer function is to be used, and there is one.
bool vtkFFDVolumeRepresentation::UsesPlane()
{
  return this->UseTransfer2D && this->Property && this->Property->GetTransferFunction2D(0);
}

//------------------------------------------------------------------------------
/// Give the property a larger table of a two-dimensional function, made as VTK's mappers make
/// theirs: ParaView's has 10 x 10 texels, and linear interpolation between these would be another
/// function.
void vtkFFDVolumeRepresentation::UpdateTable()
{
  constexpr int Least = 256;
  vtkInternals& in = *this->Internals;
  vtkImageData* table = this->Property->GetTransferFunction2D(0);
  if (table != in.FineTable->GetOutput())
  {
    in.Table = table;
  }
  const int* size = in.Table->GetDimensions();
  if (!in.Table->GetPointData()->GetScalars() || (size[0] >= Least && size[1] >= Least))
  {
    return;
  }
  in.FineTable->SetInputData(in.Table);
  in.FineTable->SetOutputDimensions(std::max(size[0], Least), std::max(size[1], Least), 1);
  in.FineTable->Update();
  this->Property->SetTransferFunction2D(in.FineTable->GetOutput());
}

//------------------------------------------------------------------------------
/// Set what opacities are over. The GPU mapper of ParaView's own Volume takes those of
/// two-dimensional functions for each sample, at vtkVolumeMapper::SpacingAdjustedSampleDistance()
/// of the whole volume. `whole`: bounds of it at rest, uninitialized if the image is all of it.
void vtkFFDVolumeRepresentation::UpdateUnitDistance(vtkImageData* image, const double whole[6])
{
  double length = this->UnitDistance;
  if (this->UsesPlane())
  {
    double spacing[3];
    image->GetSpacing(spacing);
    Extent extent;
    std::copy_n(this->WholeExtent, 6, extent.begin());
    const bool part = ffdparts::IsEmpty(extent) && vtkMath::AreBoundsInitialized(whole);
    if (ffdparts::IsEmpty(extent))
    {
      image->GetExtent(extent.data());
    }
    double cells = 1.0;
    for (int a = 0; a < 3; ++a)
    {
      cells *=
        part ? (whole[2 * a + 1] - whole[2 * a]) / spacing[a] : extent[2 * a + 1] - extent[2 * a];
    }
    length = (spacing[0] + spacing[1] + spacing[2]) / 6.0 *
      std::min(1.0, 0.01 + 0.99 * std::cbrt(std::max(cells, 0.0)) / 100.0);
  }
  if (length > 0.0)
  {
    this->Property->SetScalarOpacityUnitDistance(length);
  }
}

//------------------------------------------------------------------------------
/// Give the volumes after the first the options, the place and the look of that.
void vtkFFDVolumeRepresentation::UpdateOtherVolumes()
{
  vtkInternals& in = *this->Internals;
  const bool changed = in.OptionsTime != this->Mapper->GetMTime();
  for (std::size_t i = 1; i < in.AllShown.size(); ++i)
  {
    if (changed)
    {
      in.AllShown[i]->Mapper->ShallowCopy(this->Mapper);
    }
    vtkVolume* actor = in.AllShown[i]->Actor;
    actor->SetOrigin(this->Actor->GetOrigin());
    actor->SetPosition(this->Actor->GetPosition());
    actor->SetScale(this->Actor->GetScale());
    actor->SetOrientation(this->Actor->GetOrientation());
    actor->SetUserMatrix(this->Actor->GetUserMatrix());
    actor->SetPickable(this->Actor->GetPickable());
    actor->SetVisibility(this->Actor->GetVisibility());
    actor->SetProperty(this->Property);
  }
}

//------------------------------------------------------------------------------
/// Give a mapper the image, with what to render as point data.
void vtkFFDVolumeRepresentation::UpdateRenderedImage(std::size_t which, vtkImageData* image)
{
  vtkInternals::Shown& volume = *this->Internals->AllShown[which];
  vtkFFDInverseRayVolumeMapper* mapper = volume.Mapper;
  if (!image)
  {
    mapper->RemoveAllInputs();
    return;
  }
  const vtkFFDShownComponents shown = this->FindShown(image);
  volume.Rendered.Update(image, shown);
  if (mapper->GetInputDataObject(0, 0) != volume.Rendered.GetImage())
  {
    mapper->SetInputDataObject(volume.Rendered.GetImage());
  }
  mapper->SelectScalarArray(shown.Color.Array.Name.c_str());
  mapper->SetScalarMode(VTK_SCALAR_MODE_USE_POINT_FIELD_DATA);
  const bool dependent =
    !shown.Opacity.Array.Name.empty() || shown.Color.Component == vtkFFDShownComponent::All;
  if (this->Property && which == 0)
  {
    this->Property->SetIndependentComponents(!dependent);
    this->Property->SetTransferFunctionMode(
      this->UsesPlane() ? vtkVolumeProperty::TF_2D : vtkVolumeProperty::TF_1D);
    if (this->UsesPlane())
    {
      this->UpdateTable();
    }
  }
  mapper->SetTransfer2DYAxisArray(
    shown.Second.Array.Name.empty() ? nullptr : vtkFFDShownComponents::SecondName);

  Bounds clip;
  Bounds whole = ffdparts::NoBounds;
  if (!vtkFFDVoxelDistribution::ReadBounds(image, clip, whole))
  {
    // All of space, and yet a box: the tiles of the picture are then as with several processes.
    const Bounds nothing{};
    clip = ffdparts::OpenOutwards(nothing, nothing);
  }
  mapper->SetClipBox(clip.data());
  mapper->SetWholeBounds(whole.data());
  if (this->Property && which == 0)
  {
    this->UpdateUnitDistance(image, whole.data());
  }
  std::array<double, 2> range{ { 1.0, -1.0 } };
  if (!dependent)
  {
    vtkFFDVoxelDistribution::ReadRange(image, shown.Color.Array, shown.Color.Component, range);
  }
  mapper->SetWholeScalarRange(range.data());
  mapper->SetDeformation(volume.Rendered.GetLattice());
}

//------------------------------------------------------------------------------
/// The mapper takes distances in units of the data, before the matrix of the actor.
void vtkFFDVolumeRepresentation::UpdateSampleDistances(
  vtkFFDInverseRayVolumeMapper* mapper, vtkImageData* image, double lodResolution, bool useLOD)
{
  const double coarser =
    std::min(1.0 / std::max(lodResolution, 1.0 / LargestCoarsening), LargestCoarsening);
  mapper->SetMaximumImageSampleDistance(
    this->ImageSampleDistance * std::min(coarser * coarser, LargestCoarsening));
  double spacing[3];
  image->GetSpacing(spacing);
  vtkMatrix3x3* direction = image->GetDirectionMatrix();
  double voxel = VTK_DOUBLE_MAX;
  for (int a = 0; a < 3; ++a)
  {
    const double edge[3] = { direction->GetElement(0, a) * spacing[a],
      direction->GetElement(1, a) * spacing[a], direction->GetElement(2, a) * spacing[a] };
    voxel = std::min(voxel, vtkMath::Norm(edge));
  }
  if (voxel > 0.0)
  {
    const double distance = this->SampleDistance * voxel;
    mapper->SetSampleDistance(distance);
    mapper->SetInteractiveSampleDistance(useLOD ? coarser * distance : distance);
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::UpdateCropping(
  vtkFFDInverseRayVolumeMapper* mapper, vtkImageData* image)
{
  if (!mapper->GetCropping())
  {
    return;
  }
  // Those of the whole, of which this may be a part.
  const bool deformed = mapper->GetCroppingSpace() == vtkFFDInverseRayVolumeMapper::DEFORMED;
  double bounds[6];
  mapper->GetWholeBounds(bounds);
  if (vtkDataArray* all = image->GetFieldData()->GetArray(AllBoundsName))
  {
    for (int i = 0; i < 6; ++i)
    {
      bounds[i] = all->GetComponent(deformed ? 6 + i : i, 0);
    }
  }
  else if (deformed)
  {
    mapper->GetBounds(bounds);
  }
  else if (!vtkMath::AreBoundsInitialized(bounds))
  {
    image->GetBounds(bounds);
  }
  double planes[6];
  for (int i = 0; i < 6; ++i)
  {
    planes[i] = this->CroppingOrigin[i / 2] + this->CroppingScale[i / 2] * bounds[i];
  }
  for (int a = 0; a < 3; ++a)
  {
    if (planes[2 * a] > planes[2 * a + 1])
    {
      std::swap(planes[2 * a], planes[2 * a + 1]);
    }
  }
  mapper->SetCroppingRegionPlanes(planes);
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
  std::array<double, 8>& picked = this->Internals->Picked;
  picked = {};
  double from[3] = { x0, y0, z0 };
  const double to[3] = { x1, y1, z1 };
  double direction[3] = { x1 - x0, y1 - y0, z1 - z0 };
  auto* view = vtkPVRenderView::SafeDownCast(this->GetView());
  // Pickers take the rotation that turns -z into the direction of the ray: half a turn about the
  // vector between the two.
  double orientation[4] = { 180.0, direction[0], direction[1], direction[2] };
  if (view && this->GetVisibility() && this->VolumeMapper->GetInputDataObject(0, 0) &&
    vtkMath::Normalize(&orientation[1]) > 0.0)
  {
    orientation[3] -= 1.0;
    if (vtkMath::Norm(&orientation[1]) < 1e-6)
    {
      orientation[1] = 1.0; // the direction is +z
    }
    if (this->Mapper->GetBlendMode() == vtkVolumeMapper::COMPOSITE_BLEND)
    {
      vtkNew<vtkFFDVolumePicker> picker;
      for (const auto& shown : this->Internals->AllShown)
      {
        picker->AddPickList(shown->Actor);
      }
      picker->PickFromListOn();
      for (const double opacity : PickedOpacities)
      {
        picker->SetVolumeOpacityIsovalue(opacity);
        if (picked[0] == 0.0 && picker->Pick3DRay(from, orientation, view->GetRenderer()))
        {
          picked[0] = 1.0;
          picker->GetPickPosition(&picked[1]);
          picker->GetRestPosition(&picked[4]);
          picked[7] = picker->GetScalarValue();
          StepInside(picker, from, to, picked);
          picker->GetPickNormal(this->Internals->PickedNormal.data());
        }
      }
    }
    else
    {
      double nearest = VTK_DOUBLE_MAX;
      for (const auto& shown : this->Internals->AllShown)
      {
        std::array<double, 8> one{};
        if (PickInPicture(shown->Mapper, shown->Actor, from, to, one) &&
          vtkMath::Distance2BetweenPoints(from, &one[1]) < nearest)
        {
          nearest = vtkMath::Distance2BetweenPoints(from, &one[1]);
          picked = one;
        }
      }
      this->Internals->PickedNormal = { { x0 - x1, y0 - y1, z0 - z1 } };
    }
  }
  vtkMultiProcessController* controller = GetController();
  if (GetNumberOfProcesses() > 1)
  {
    // The nearest one counts.
    const double here =
      picked[0] > 0.0 ? vtkMath::Distance2BetweenPoints(from, &picked[1]) : VTK_DOUBLE_MAX;
    std::vector<double> distances(static_cast<std::size_t>(GetNumberOfProcesses()));
    controller->AllGather(&here, distances.data(), 1);
    const auto nearest = std::min_element(distances.begin(), distances.end());
    const auto root = static_cast<int>(nearest - distances.begin());
    controller->Broadcast(picked.data(), static_cast<vtkIdType>(picked.size()), root);
    controller->Broadcast(this->Internals->PickedNormal.data(), 3, root);
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
    vtkCamera* camera = view->GetActiveCamera();
    double direction[3];
    camera->GetDirectionOfProjection(direction);
    if (!camera->GetParallelProjection())
    {
      vtkMath::Subtract(to, camera->GetPosition(), direction);
      vtkMath::Normalize(direction);
    }
    // Linked cameras are the same. The view that is picked in was the last to be rendered.
    constexpr double cosine = 1.0 - 1e-6; // of a tenth of a degree
    if (vtkMath::Dot(ray, direction) > cosine &&
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
  return this->Internals->PickedNormal.data();
}

//------------------------------------------------------------------------------
double* vtkFFDVolumeRepresentation::GetPicked() { return this->Internals->Picked.data(); }

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetPicked(const double picked[8])
{
  std::copy_n(picked, 8, this->Internals->Picked.begin());
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkFFDVolumeRepresentation::GetNumberOfLocalVoxels()
{
  const std::vector<vtkImageData*> images = GetImages(this->Cache);
  return std::accumulate(images.begin(), images.end(), vtkTypeInt64(0),
    [](vtkTypeInt64 sum, vtkImageData* image) { return sum + image->GetNumberOfPoints(); });
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetInverseMode(int mode)
{
  if (mode != this->Mapper->GetInverseMode())
  {
    this->Mapper->SetInverseMode(mode);
    // The bounds change.
    this->MarkModified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetBlendMode(int mode)
{
  if (mode != this->Mapper->GetBlendMode())
  {
    this->Mapper->SetBlendMode(mode);
    // Another partition among processes.
    this->MarkMoved();
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetCropping(int cropping)
{
  this->Mapper->SetCropping(cropping != 0);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetCroppingSpace(int space)
{
  this->Mapper->SetCroppingSpace(space);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetOpacityLength(int length)
{
  this->Mapper->SetOpacityLength(length);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetSpaceLeaping(int leaping)
{
  this->Mapper->SetSpaceLeaping(leaping);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetSegmentation(int segmentation)
{
  this->Mapper->SetSegmentation(segmentation);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetInverseTolerance(double voxels)
{
  this->Mapper->SetInverseTolerance(voxels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetPositionTolerance(double voxels)
{
  this->Mapper->SetPositionTolerance(voxels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetAngleThreshold(double degrees)
{
  this->Mapper->SetAngleThreshold(degrees);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetMinimumSegmentLength(double voxels)
{
  this->Mapper->SetMinimumSegmentLength(voxels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetMaximumSegmentLength(double voxels)
{
  this->Mapper->SetMaximumSegmentLength(voxels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetEarlyRayTerminationThreshold(double transmittance)
{
  this->Mapper->SetEarlyRayTerminationThreshold(transmittance);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetNumberOfThreads(int threads)
{
  this->Internals->Threads = threads;
  this->Mapper->SetNumberOfThreads(threads > 0 ? threads : this->Internals->SharedThreads);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetSampleDistance(double voxels)
{
  if (!(voxels >= 0.05 && voxels <= 10.0))
  {
    vtkErrorMacro(<< "SampleDistance must be from 0.05 to 10 voxels, not " << voxels
                  << "; it stays " << this->SampleDistance << ".");
    return;
  }
  this->SampleDistance = voxels;
}

//------------------------------------------------------------------------------
/// Not the superclass's: the property has it only where functions are one-dimensional.
void vtkFFDVolumeRepresentation::SetScalarOpacityUnitDistance(double length)
{
  this->UnitDistance = length;
  if (this->Property && !this->UsesPlane())
  {
    this->Property->SetScalarOpacityUnitDistance(length);
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetImageSampleDistance(double pixels)
{
  if (!(pixels >= 0.25 && pixels <= 8.0))
  {
    vtkErrorMacro(<< "ImageSampleDistance must be from 0.25 to 8 pixels, not " << pixels << ".");
    return;
  }
  this->ImageSampleDistance = pixels;
  this->Mapper->SetImageSampleDistance(pixels);
  this->Mapper->SetMinimumImageSampleDistance(pixels);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetAdaptInteractiveQuality(bool adapt)
{
  this->Mapper->SetAutoAdjustSampleDistances(adapt);
}

//------------------------------------------------------------------------------
bool vtkFFDVolumeRepresentation::GetAdaptInteractiveQuality()
{
  return this->Mapper->GetAutoAdjustSampleDistances() != 0;
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::RenderNextAtRate(double rate) { this->Internals->NextRate = rate; }

//------------------------------------------------------------------------------
/// Bounds that the view is given are those in the scene, as are the boxes of a partition.
void vtkFFDVolumeRepresentation::MarkMoved() { this->MarkModified(); }

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetPosition(double x, double y, double z)
{
  this->Superclass::SetPosition(x, y, z);
  this->MarkMoved();
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetScale(double x, double y, double z)
{
  this->Superclass::SetScale(x, y, z);
  this->MarkMoved();
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetOrientation(double x, double y, double z)
{
  this->Superclass::SetOrientation(x, y, z);
  this->MarkMoved();
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::SetOrigin(double x, double y, double z)
{
  this->Superclass::SetOrigin(x, y, z);
  this->MarkMoved();
}
