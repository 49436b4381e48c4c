// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeRepresentation.h"

#include "vtkFFDCompositePass.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDServerFrames.h"
#include "vtkFFDVolumeParts.h"

#include "vtkAbstractArray.h"
#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCellData.h"
#include "vtkCellDataToPointData.h"
#include "vtkColorTransferFunction.h"
#include "vtkCommand.h"
#include "vtkCommunicator.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkInformationDataObjectMetaDataKey.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkOutlineSource.h"
#include "vtkPVLODVolume.h"
#include "vtkPVProgressHandler.h"
#include "vtkPVRenderView.h"
#include "vtkPVSession.h"
#include "vtkPVView.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPointData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProcessModule.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolumeProperty.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkFFDVolumeRepresentation);

namespace
{

using ffdparts::Bounds;
using ffdparts::Extent;
using ffdparts::Grid;

/// Seconds between messages of progress, and looks for an abort, in frames of a server.
constexpr double ServerProgressInterval = 0.1;

/// How much coarser interactive images can be, in each way.
constexpr double LargestCoarsening = 10.0;

/// In the field data of a part: its clip box, then the bounds of the whole at rest.
const char* const PartArray = "FFDVolume.Part";

/// And the ranges of the whole array that is shown, of its magnitude and its components: two numbers
/// each. The name ends with what array it is.
const char* const RangesArray = "FFDVolume.Ranges.";

/// The array that is to be shown.
struct ShownArray
{
  std::string Name;
  bool OfCells = false;

  /// Of an algorithm's input array to process; without a name if there is none.
  static ShownArray FromInformation(vtkInformation* info)
  {
    ShownArray shown;
    if (info && info->Has(vtkDataObject::FIELD_NAME()) && info->Get(vtkDataObject::FIELD_NAME()))
    {
      shown.Name = info->Get(vtkDataObject::FIELD_NAME());
    }
    shown.OfCells = info && info->Has(vtkDataObject::FIELD_ASSOCIATION()) &&
      info->Get(vtkDataObject::FIELD_ASSOCIATION()) == vtkDataObject::FIELD_ASSOCIATION_CELLS;
    return shown;
  }

  vtkDataArray* FindIn(vtkImageData* image) const
  {
    vtkFieldData* arrays = image->GetPointData();
    if (this->OfCells)
    {
      arrays = image->GetCellData();
    }
    return arrays->GetArray(this->Name.c_str());
  }

  std::string GetRangesName() const
  {
    return RangesArray + std::string(this->OfCells ? "cells." : "points.") + this->Name;
  }
};

vtkMultiProcessController* GetController()
{
  return vtkMultiProcessController::GetGlobalController();
}

int GetNumberOfProcesses()
{
  return GetController() ? GetController()->GetNumberOfProcesses() : 1;
}

/// Whether the matrix takes boxes to boxes.
bool KeepsBoxes(vtkMatrix4x4* matrix)
{
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      if (row != column && matrix->GetElement(row, column) != 0.0)
      {
        return false;
      }
    }
  }
  return true;
}

Bounds Transform(const Bounds& bounds, vtkMatrix4x4* matrix)
{
  Bounds result = { VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX,
    VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX };
  for (int corner = 0; corner < 8; ++corner)
  {
    double p[4] = { bounds[corner & 1], bounds[2 + ((corner >> 1) & 1)], bounds[4 + (corner >> 2)],
      1.0 };
    matrix->MultiplyPoint(p, p);
    for (int a = 0; a < 3; ++a)
    {
      result[2 * a] = std::min(result[2 * a], p[a]);
      result[2 * a + 1] = std::max(result[2 * a + 1], p[a]);
    }
  }
  return result;
}

/// A component of an array, or the magnitude of its tuples for component -1.
vtkSmartPointer<vtkDataArray> ExtractComponent(vtkDataArray* from, int component)
{
  vtkSmartPointer<vtkDataArray> to;
  const int components = from->GetNumberOfComponents();
  if (component >= 0)
  {
    to.TakeReference(from->NewInstance());
    to->SetNumberOfTuples(from->GetNumberOfTuples());
    to->CopyComponent(0, from, std::min(component, components - 1));
    return to;
  }
  to.TakeReference(vtkDataArray::CreateDataArray(VTK_FLOAT));
  to->SetNumberOfTuples(from->GetNumberOfTuples());
  vtkSMPTools::For(0, from->GetNumberOfTuples(),
    [from, components, array = to.Get()](vtkIdType first, vtkIdType last)
    {
      for (vtkIdType i = first; i < last; ++i)
      {
        double square = 0.0;
        for (int c = 0; c < components; ++c)
        {
          const double value = from->GetComponent(i, c);
          square += value * value;
        }
        array->SetComponent(i, 0, std::sqrt(square));
      }
    });
  return to;
}

/// Take the flags of duplicates from vtkGhostType, which a copied structure has where something is
/// blanked: the mapper hides all that have flags, and the part of another process that is rendered
/// here is a duplicate.
void ShowDuplicates(vtkImageData* image)
{
  const auto show = [](vtkDataSetAttributes* arrays, int duplicate)
  {
    const char* const name = vtkDataSetAttributes::GhostArrayName();
    auto* ghosts = vtkUnsignedCharArray::SafeDownCast(arrays->GetArray(name));
    if (!ghosts)
    {
      return;
    }
    vtkNew<vtkUnsignedCharArray> shown; // that of the input is shared
    shown->DeepCopy(ghosts);
    for (vtkIdType i = 0; i < shown->GetNumberOfValues(); ++i)
    {
      shown->SetValue(i, static_cast<unsigned char>(shown->GetValue(i) & ~duplicate));
    }
    arrays->AddArray(shown);
  };
  show(image->GetPointData(), vtkDataSetAttributes::DUPLICATEPOINT);
  show(image->GetCellData(), vtkDataSetAttributes::DUPLICATECELL);
}

/// The arrays of an image and when they changed.
using Sources = std::vector<std::pair<vtkWeakPointer<vtkAbstractArray>, vtkMTimeType>>;

Sources GetSources(vtkImageData* image)
{
  Sources sources;
  if (image)
  {
    const std::array<vtkFieldData*, 2> both{ { image->GetPointData(), image->GetCellData() } };
    for (vtkFieldData* arrays : both)
    {
      for (int a = 0; a < arrays->GetNumberOfArrays(); ++a)
      {
        vtkAbstractArray* array = arrays->GetAbstractArray(a);
        sources.emplace_back(array, array->GetMTime());
      }
    }
  }
  return sources;
}

/// Ranges of the array over all processes, see RangesArray; null if it is nowhere, or holds no finite
/// number. To be called on all processes.
vtkSmartPointer<vtkDoubleArray> FindRanges(
  vtkMultiProcessController* controller, vtkImageData* image, const ShownArray& shown)
{
  vtkDataArray* array = image ? shown.FindIn(image) : nullptr;
  const int componentsHere = array ? array->GetNumberOfComponents() : 0;
  int components = 0;
  controller->AllReduce(&componentsHere, &components, 1, vtkCommunicator::MAX_OP);
  if (components < 1)
  {
    return nullptr;
  }
  // Least values, and least negated ones.
  std::vector<double> mine(2 * static_cast<std::size_t>(components + 1), VTK_DOUBLE_MAX);
  for (int c = -1; array && c < componentsHere; ++c)
  {
    double range[2];
    array->GetFiniteRange(range, c);
    if (range[0] <= range[1])
    {
      mine[2 * static_cast<std::size_t>(c + 1)] = range[0];
      mine[2 * static_cast<std::size_t>(c + 1) + 1] = -range[1];
    }
  }
  std::vector<double> all(mine.size());
  controller->AllReduce(
    mine.data(), all.data(), static_cast<vtkIdType>(mine.size()), vtkCommunicator::MIN_OP);
  vtkNew<vtkDoubleArray> ranges;
  ranges->SetName(shown.GetRangesName().c_str());
  ranges->SetNumberOfComponents(2);
  for (std::size_t i = 0; i < all.size(); i += 2)
  {
    const bool any = all[i] < VTK_DOUBLE_MAX;
    ranges->InsertNextTuple2(any ? all[i] : 1.0, any ? -all[i + 1] : -1.0);
  }
  return ranges;
}

bool HaveSameGeometry(vtkImageData* a, vtkImageData* b)
{
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      if (a->GetDirectionMatrix()->GetElement(row, column) !=
        b->GetDirectionMatrix()->GetElement(row, column))
      {
        return false;
      }
    }
  }
  return std::equal(a->GetExtent(), a->GetExtent() + 6, b->GetExtent()) &&
    std::equal(a->GetOrigin(), a->GetOrigin() + 3, b->GetOrigin()) &&
    std::equal(a->GetSpacing(), a->GetSpacing() + 3, b->GetSpacing());
}

} // namespace

//------------------------------------------------------------------------------
class vtkFFDVolumeRepresentation::vtkInternals
{
public:
  // What the mapper renders: the geometry of the delivered image and one array of one component on
  // its points. It is left alone when only the lattice changes, so that the mapper keeps what it
  // has found out about the voxels.
  vtkNew<vtkImageData> Rendered;
  vtkNew<vtkFFDLattice> Lattice;
  vtkMTimeType LatticeTime = 0;
  vtkWeakPointer<vtkDataArray> SourceArray;
  vtkMTimeType SourceTime = 0;
  int SourceComponent = -2;

  // Of the parts, when there are several processes.
  bool Changed = true;            // since they were shared out
  std::string RangesName;         // of the array that the ranges were last found of
  vtkSmartPointer<vtkImageData> Given; // what this process has of the data
  vtkSmartPointer<vtkFFDLattice> KnownLattice; // of the data last seen
  Bounds OwnBox = ffdparts::NoBounds; // world coordinates

  ffdparts::PullBackCover Cover;
  vtkSmartPointer<vtkImageData> Held; // voxels that were brought here last
  Sources HeldSources;                // of what image

  // Of the renderer of the view.
  std::array<unsigned long, 2> RenderObservers{ { 0, 0 } };
  bool TookPeelingOff = false;
  vtkWeakPointer<vtkPVSession> Session;   // whose progress is told
  vtkWeakPointer<vtkRenderWindow> Window; // of the frame in progress
  double ProgressInterval = 0.0;          // of the session before the frame; 0: not changed
  double NextRate = 0.0;                  // RenderNextAtRate(); 0: as asked
  vtkNew<vtkFFDCompositePass> OwnPass;
  vtkSmartPointer<vtkFFDCompositePass> Pass; // that of the frame: its own or another volume's

  /// Whether what was brought here last has the voxels `wanted`, and the image is as it was then.
  bool HoldsVoxelsOf(vtkImageData* image, const Extent& wanted)
  {
    Extent held = ffdparts::NoExtent;
    if (this->Held)
    {
      this->Held->GetExtent(held.data());
    }
    bool alive = true;
    for (const auto& source : this->HeldSources)
    {
      alive = alive && source.first;
    }
    return alive && ffdparts::Contains(held, wanted) && GetSources(image) == this->HeldSources;
  }


  /**
   * The box of each process in data coordinates, for an image deformed to `deformed`, as Cover has
   * it.
   */
  std::vector<Bounds> CutIntoBoxes(
    const Grid& grid, const Bounds& deformed, vtkMatrix4x4* matrix, int blendMode) const
  {
    const int ranks = GetNumberOfProcesses();
    if (KeepsBoxes(matrix) && blendMode == vtkVolumeMapper::COMPOSITE_BLEND)
    {
      return ffdparts::CutIntoBoxes(deformed, ranks,
        [this, &grid](const Bounds& box) {
          return static_cast<double>(
            ffdparts::CountPoints(ffdparts::FindNeededExtent(grid, this->Cover, box)));
        });
    }
    std::vector<Bounds> boxes(static_cast<std::size_t>(ranks), ffdparts::NoBounds);
    boxes[0] = deformed;
    return boxes;
  }
};

//------------------------------------------------------------------------------
vtkFFDVolumeRepresentation::vtkFFDVolumeRepresentation()
  : Mapper(vtkFFDInverseRayVolumeMapper::New())
  , Internals(new vtkInternals)
{
  this->VolumeMapper.TakeReference(this->Mapper);
  this->Mapper->SetProgressText("FFD Volume");
  this->Mapper->AddObserver(
    vtkCommand::VolumeMapperRenderStartEvent, this, &vtkFFDVolumeRepresentation::BeginVolume);
  this->Mapper->AddObserver(
    vtkCommand::ProgressEvent, this, &vtkFFDVolumeRepresentation::ContinueVolume);
  // Messages of progress are what a client may answer with a request for an abort.
  this->Internals->OwnPass->SetWait(
    [this]() { this->Mapper->UpdateProgress(this->Mapper->GetProgress()); });
}

//------------------------------------------------------------------------------
vtkFFDVolumeRepresentation::~vtkFFDVolumeRepresentation() = default;

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
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
  this->Internals->Changed = true;
  this->Internals->Given = nullptr;
  std::copy(ffdparts::NoExtent.begin(), ffdparts::NoExtent.end(), this->WholeExtent);
  vtkSmartPointer<vtkImageData> image;
  if (inputs[0]->GetNumberOfInformationObjects() == 1)
  {
    vtkInformation* info = inputs[0]->GetInformationObject(0);
    vtkDataObject* input = vtkDataObject::GetData(info);
    vtkImageData* inputImage = vtkImageData::SafeDownCast(input);
    if (input && !inputImage)
    {
      vtkErrorMacro(<< "The representation \"FFD Volume\" renders image data, and this is a "
                    << input->GetClassName()
                    << ". Apply the filter \"Resample To Image\" first, or choose another "
                       "representation.");
    }
    else if (inputImage)
    {
      vtkStreamingDemandDrivenPipeline::GetWholeExtent(info, this->WholeExtent);
      Extent whole;
      std::copy_n(this->WholeExtent, 6, whole.begin());
      if (ffdparts::IsEmpty(whole))
      {
        inputImage->GetExtent(whole.data());
      }
      const int* sizes = inputImage->GetDimensions();
      if (inputImage->GetNumberOfPoints() > 0 &&
        (whole[0] == whole[1] || whole[2] == whole[3] || whole[4] == whole[5]))
      {
        vtkErrorMacro(<< "The representation \"FFD Volume\" renders volumes, and this image has "
                      << sizes[0] << " x " << sizes[1] << " x " << sizes[2]
                      << " points: it needs two along each axis. Choose \"Slice\" or \"Surface\".");
      }
      else
      {
        image = vtkSmartPointer<vtkImageData>::New();
        image->ShallowCopy(inputImage);
      }
    }
  }
  if (image && image->GetNumberOfPoints() > 0)
  {
    Extent extent;
    image->GetExtent(extent.data());
    vtkNew<vtkFFDLattice> lattice;
    const bool hasLattice = vtkFFDLattice::HasLattice(image) && lattice->ReadFrom(image);
    const Bounds deformed = ffdparts::FindDeformedBounds(Grid::FromImage(image, extent),
      hasLattice ? lattice.GetPointer() : nullptr, this->Mapper->GetInverseMode());
    std::copy(deformed.begin(), deformed.end(), this->DataBounds);
    this->DataSize = image->GetActualMemorySize();
    this->Cache = image;
    this->Internals->Given = image;
    this->Actor->SetEnableLOD(0);
    this->OutlineSource->SetBounds(this->DataBounds);
    this->OutlineSource->Update();
  }
  else
  {
    // A client, or a rank without data: an empty data object for the delivery, and the outline.
    this->Cache = vtkSmartPointer<vtkPartitionedDataSet>::New();
    this->VolumeMapper->RemoveAllInputs();
    this->Actor->SetEnableLOD(1);
  }
  return this->vtkVolumeRepresentation::RequestData(request, inputs, outputs);
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
    vtkAlgorithmOutput* producer = vtkPVRenderView::GetPieceProducer(inInfo, this, 0);
    vtkImageData* image = producer
      ? vtkImageData::SafeDownCast(
          producer->GetProducer()->GetOutputDataObject(producer->GetIndex()))
      : nullptr;
    this->UpdateMapperParameters();
    this->UpdateRenderedImage(image);
    auto* view = vtkPVRenderView::SafeDownCast(inInfo->Get(vtkPVView::VIEW()));
    vtkRenderWindow* window = view ? view->GetRenderWindow() : nullptr;
    if (window && this->Internals->NextRate > window->GetDesiredUpdateRate())
    {
      window->SetDesiredUpdateRate(this->Internals->NextRate);
    }
    this->Internals->NextRate = 0.0;
    if (image)
    {
      this->UpdateSampleDistances(image, view ? view->GetLODResolution() : 1.0,
        inInfo->Has(vtkPVRenderView::USE_LOD()) != 0);
      this->UpdateCropping(image);
    }
    this->OutlineMapper->SetInputConnection(vtkPVRenderView::GetPieceProducer(inInfo, this, 1));
    return 1;
  }
  if (request == vtkPVView::REQUEST_UPDATE())
  {
    // Not the superclass's: it hands over the data before they are shared out.
    if (!this->vtkVolumeRepresentation::ProcessViewRequest(request, inInfo, outInfo))
    {
      return 0;
    }
    const bool several = GetNumberOfProcesses() > 1;
    if (several)
    {
      this->ShareOut();
    }
    vtkPVRenderView::SetPiece(inInfo, this, this->Cache, this->DataSize, 0);
    // The volume is never brought to the client, which shows the outline while it has no picture.
    vtkPVRenderView::SetDeliverToClientAndRenderingProcesses(inInfo, this, false, false, 0);
    vtkPVRenderView::SetPiece(inInfo, this, this->OutlineSource->GetOutputDataObject(0), 0, 1);
    vtkPVRenderView::SetGeometryBounds(
      inInfo, this, several ? this->Internals->OwnBox.data() : this->DataBounds);
    vtkPVRenderView::SetRequiresDistributedRendering(inInfo, this, true);
    vtkPVRenderView::SetOrderedCompositingConfiguration(
      inInfo, this, vtkPVRenderView::USE_BOUNDS_FOR_REDISTRIBUTION);
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
  auto* session = vtkPVSession::SafeDownCast(
    processes && processes->GetActiveSession() ? processes->GetActiveSession()
                                               : (processes ? processes->GetSession() : nullptr));
  const auto type = vtkProcessModule::GetProcessType();
  const bool ownWindow =
    type == vtkProcessModule::PROCESS_CLIENT || type == vtkProcessModule::PROCESS_BATCH;
  const bool toClient = session && session->GetController(vtkPVSession::CLIENT);
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
        vtkCommand::ProgressEvent, this, &vtkFFDVolumeRepresentation::TakeContextBack, -1.0f);
    }
  }
  vtkRenderer* renderer = vtkPVRenderView::SafeDownCast(view)->GetRenderer();
  this->Internals->RenderObservers = {
    { renderer->AddObserver(
        vtkCommand::StartEvent, this, &vtkFFDVolumeRepresentation::BeginRender),
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
  // Without shading no colour is brighter than its alpha.
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
void vtkFFDVolumeRepresentation::ContinueVolume()
{
  if (ffdserver::IsAbortAsked(this->Internals->Session))
  {
    this->Mapper->SetAbortExecute(1);
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::TakeContextBack()
{
  if (this->Internals->Window)
  {
    this->Internals->Window->MakeCurrent();
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
/// Give each process its box and the voxels for it. Called on all processes.
void vtkFFDVolumeRepresentation::ShareOut()
{
  vtkInternals& in = *this->Internals;
  vtkMultiProcessController* controller = GetController();
  const int ranks = controller->GetNumberOfProcesses();
  const auto own = static_cast<std::size_t>(controller->GetLocalProcessId());
  const ShownArray shown = ShownArray::FromInformation(this->GetInputArrayInformation(0));
  const int changedHere = in.Changed || in.RangesName != shown.GetRangesName() ? 1 : 0;
  int changed = 0;
  controller->AllReduce(&changedHere, &changed, 1, vtkCommunicator::MAX_OP);
  if (!changed)
  {
    return;
  }
  in.Changed = false;
  in.RangesName = shown.GetRangesName();

  // What each process has: whether an image, whether a lattice, and the geometry of the image.
  vtkImageData* image = in.Given;
  Extent held = ffdparts::NoExtent;
  Grid grid;
  if (image)
  {
    image->GetExtent(held.data());
    grid = Grid::FromImage(image, held);
    Extent whole;
    std::copy_n(this->WholeExtent, 6, whole.begin());
    if (!ffdparts::IsEmpty(whole))
    {
      grid.WholeExtent = whole;
    }
  }
  constexpr int values = 2 + 6 + 6 + 3 + 3 + 9;
  std::array<double, values> mine{};
  mine[0] = image ? 1.0 : 0.0;
  mine[1] = image && vtkFFDLattice::HasLattice(image) ? 1.0 : 0.0;
  std::copy(held.begin(), held.end(), mine.begin() + 2);
  std::copy(grid.WholeExtent.begin(), grid.WholeExtent.end(), mine.begin() + 8);
  std::copy(grid.Origin.begin(), grid.Origin.end(), mine.begin() + 14);
  std::copy(grid.Spacing.begin(), grid.Spacing.end(), mine.begin() + 17);
  std::copy(grid.Direction.begin(), grid.Direction.end(), mine.begin() + 20);
  std::vector<double> all(static_cast<std::size_t>(ranks * values));
  controller->AllGather(mine.data(), all.data(), values);

  int withImage = -1;
  int withLattice = -1;
  std::vector<Extent> extents(static_cast<std::size_t>(ranks));
  Extent whole = ffdparts::NoExtent;
  for (int r = ranks - 1; r >= 0; --r)
  {
    const double* theirs = &all[static_cast<std::size_t>(r * values)];
    Extent& e = extents[static_cast<std::size_t>(r)];
    std::transform(theirs + 2, theirs + 8, e.begin(), [](double v) { return static_cast<int>(v); });
    withImage = theirs[0] != 0.0 ? r : withImage;
    withLattice = theirs[1] != 0.0 ? r : withLattice;
    Extent announced;
    std::transform(
      theirs + 8, theirs + 14, announced.begin(), [](double v) { return static_cast<int>(v); });
    for (const Extent& each : { e, announced })
    {
      if (ffdparts::IsEmpty(whole))
      {
        whole = each;
      }
      else if (!ffdparts::IsEmpty(each))
      {
        for (int a = 0; a < 3; ++a)
        {
          whole[2 * a] = std::min(whole[2 * a], each[2 * a]);
          whole[2 * a + 1] = std::max(whole[2 * a + 1], each[2 * a + 1]);
        }
      }
    }
  }
  if (withImage < 0)
  {
    in.OwnBox = ffdparts::NoBounds;
    return;
  }
  const double* reference = &all[static_cast<std::size_t>(withImage * values)];
  grid.WholeExtent = whole;
  std::copy_n(reference + 14, 3, grid.Origin.begin());
  std::copy_n(reference + 17, 3, grid.Spacing.begin());
  std::copy_n(reference + 20, 9, grid.Direction.begin());

  in.KnownLattice = nullptr;
  if (withLattice >= 0)
  {
    vtkNew<vtkFFDLattice> lattice;
    vtkNew<vtkImageData> points;
    std::array<double, 7> numbers{};
    if (static_cast<int>(own) == withLattice && lattice->ReadFrom(image))
    {
      lattice->ToImageData(points);
      points->GetOrigin(numbers.data());
      points->GetSpacing(numbers.data() + 3);
      numbers[6] = lattice->GetDisplacementScale();
    }
    // Of an image only the point data are sent bit by bit; the rest comes as decimals.
    controller->Broadcast(points.GetPointer(), withLattice);
    controller->Broadcast(numbers.data(), static_cast<vtkIdType>(numbers.size()), withLattice);
    points->SetOrigin(numbers.data());
    points->SetSpacing(numbers.data() + 3);
    if (points->GetNumberOfPoints() > 0 && lattice->FromImageData(points))
    {
      lattice->SetDisplacementScale(numbers[6]);
      in.KnownLattice = lattice;
    }
  }

  // The same on all processes: the box of each, and what each needs for it. The first one decides:
  // on processors of different kinds bounds may round differently.
  const int mode = this->Mapper->GetInverseMode();
  Bounds deformed = ffdparts::FindDeformedBounds(grid, in.KnownLattice, mode);
  in.Cover.SetDeformation(in.KnownLattice, mode);
  this->Actor->ComputeMatrix();
  vtkMatrix4x4* matrix = this->Actor->GetMatrix();
  std::vector<Bounds> boxes(static_cast<std::size_t>(ranks));
  if (own == 0)
  {
    boxes = in.CutIntoBoxes(grid, deformed, matrix, this->Mapper->GetBlendMode());
  }
  std::vector<double> decided;
  for (const Bounds& each : boxes)
  {
    decided.insert(decided.end(), each.begin(), each.end());
  }
  decided.insert(decided.end(), deformed.begin(), deformed.end());
  controller->Broadcast(decided.data(), static_cast<vtkIdType>(decided.size()), 0);
  for (std::size_t r = 0; r < boxes.size(); ++r)
  {
    std::copy_n(&decided[6 * r], 6, boxes[r].begin());
  }
  std::copy_n(&decided[6 * boxes.size()], 6, deformed.begin());
  const Bounds& box = boxes[own];
  const Extent wanted = ffdparts::FindNeededExtent(grid, in.Cover, box);
  std::vector<int> allWanted(static_cast<std::size_t>(6 * ranks));
  controller->AllGather(wanted.data(), allWanted.data(), 6);
  std::vector<Extent> needed(static_cast<std::size_t>(ranks));
  bool complete = true;
  for (std::size_t r = 0; r < needed.size(); ++r)
  {
    std::copy_n(&allWanted[6 * r], 6, needed[r].begin());
    complete = complete && ffdparts::Contains(extents[r], needed[r]);
  }
  const vtkSmartPointer<vtkDoubleArray> ranges = FindRanges(controller, image, shown);
  vtkSmartPointer<vtkImageData> part = image;
  if (!complete)
  {
    // Most often only the lattice has changed, and what was brought for it last time does.
    const int keepHere = in.HoldsVoxelsOf(image, wanted) ? 1 : 0;
    int keep = 0;
    controller->AllReduce(&keepHere, &keep, 1, vtkCommunicator::MIN_OP);
    if (!keep)
    {
      in.Held = ffdparts::ExchangeVoxels(controller, grid, image, extents, needed);
      in.HeldSources = GetSources(image);
    }
    part = nullptr;
    if (in.Held && !ffdparts::IsEmpty(wanted))
    {
      part = vtkSmartPointer<vtkImageData>::New();
      part->ShallowCopy(in.Held);
      // Field data of its own.
      vtkNew<vtkFieldData> none;
      part->SetFieldData(none);
      if (in.KnownLattice)
      {
        in.KnownLattice->AttachTo(part);
      }
    }
  }
  else if (ffdparts::IsEmpty(wanted))
  {
    part = nullptr;
  }

  if (part)
  {
    const Bounds clip = ffdparts::OpenOutwards(box, deformed);
    const Bounds rest = grid.GetBounds();
    vtkNew<vtkDoubleArray> array;
    array->SetName(PartArray);
    array->SetNumberOfValues(12);
    std::copy(clip.begin(), clip.end(), array->GetPointer(0));
    std::copy(rest.begin(), rest.end(), array->GetPointer(6));
    // Field data of our own: that of the input is shared.
    vtkNew<vtkFieldData> fields;
    fields->PassData(part->GetFieldData());
    fields->AddArray(array);
    if (ranges)
    {
      fields->AddArray(ranges);
    }
    if (part == image)
    {
      // What is given stays as it is: it is looked at again when another array is shown.
      part = vtkSmartPointer<vtkImageData>::New();
      part->ShallowCopy(image);
    }
    part->SetFieldData(fields);
    this->Cache = part;
    this->DataSize = part->GetActualMemorySize();
    this->Actor->SetEnableLOD(0);
  }
  else
  {
    this->Cache = vtkSmartPointer<vtkPartitionedDataSet>::New();
    this->DataSize = 0;
    this->VolumeMapper->RemoveAllInputs();
  }
  if (!ffdparts::IsEmpty(box))
  {
    in.OwnBox = Transform(box, matrix);
  }
  else
  {
    // No part of the volume, but a place in the order: a box without thickness beside it.
    in.OwnBox = Transform(deformed, matrix);
    in.OwnBox[0] = in.OwnBox[1];
  }
  std::copy(deformed.begin(), deformed.end(), this->DataBounds);
  this->OutlineSource->SetBounds(this->DataBounds);
  this->OutlineSource->Update();
}

//------------------------------------------------------------------------------
/// Give the mapper the image, with the array to render as point data of one component.
void vtkFFDVolumeRepresentation::UpdateRenderedImage(vtkImageData* image)
{
  vtkInternals& in = *this->Internals;
  if (!image)
  {
    this->VolumeMapper->RemoveAllInputs();
    return;
  }
  const ShownArray shown = ShownArray::FromInformation(this->GetInputArrayInformation(0));
  const char* name = shown.Name.c_str();
  int component = -1;
  vtkColorTransferFunction* colours =
    this->Property ? this->Property->GetRGBTransferFunction(0) : nullptr;
  if (colours && colours->GetVectorMode() == vtkScalarsToColors::COMPONENT)
  {
    component = colours->GetVectorComponent();
  }
  vtkDataArray* source = shown.FindIn(image);
  const vtkMTimeType time = source ? source->GetMTime() : 0;
  if (in.SourceArray != source || in.SourceTime != time || in.SourceComponent != component ||
    !HaveSameGeometry(in.Rendered, image))
  {
    in.SourceArray = source;
    in.SourceTime = time;
    in.SourceComponent = component;
    vtkSmartPointer<vtkDataArray> array = source;
    if (array && shown.OfCells)
    {
      vtkNew<vtkImageData> onlyThis;
      onlyThis->CopyStructure(image);
      onlyThis->GetCellData()->AddArray(array);
      vtkNew<vtkCellDataToPointData> average;
      average->SetInputData(onlyThis);
      average->Update();
      array = average->GetOutput()->GetPointData()->GetArray(name);
    }
    if (array && array->GetNumberOfComponents() > 1)
    {
      array = ExtractComponent(array, component);
      array->SetName(name);
    }
    in.Rendered->Initialize();
    in.Rendered->CopyStructure(image);
    ShowDuplicates(in.Rendered);
    if (array)
    {
      in.Rendered->GetPointData()->AddArray(array);
    }
  }
  if (this->VolumeMapper->GetInputDataObject(0, 0) != in.Rendered)
  {
    this->VolumeMapper->SetInputData(in.Rendered);
  }
  this->VolumeMapper->SelectScalarArray(name);
  this->VolumeMapper->SetScalarMode(VTK_SCALAR_MODE_USE_POINT_FIELD_DATA);

  if (vtkDataArray* part = image->GetFieldData()->GetArray(PartArray))
  {
    Bounds clip;
    Bounds whole;
    for (int i = 0; i < 6; ++i)
    {
      clip[i] = part->GetComponent(i, 0);
      whole[i] = part->GetComponent(6 + i, 0);
    }
    this->Mapper->SetClipBox(clip.data());
    this->Mapper->SetWholeBounds(whole.data());
  }
  else
  {
    // All of space, and yet a box: the tiles of the picture are then as with several processes.
    this->Mapper->SetClipBox(
      ffdparts::OpenOutwards(Bounds{ { 0, 0, 0, 0, 0, 0 } }, Bounds{ { 0, 0, 0, 0, 0, 0 } }).data());
    this->Mapper->SetWholeBounds(ffdparts::NoBounds.data());
  }

  std::array<double, 2> range{ { 1.0, -1.0 } };
  if (vtkDataArray* ranges = image->GetFieldData()->GetArray(shown.GetRangesName().c_str()))
  {
    const int which = ranges->GetNumberOfTuples() == 2 ? 1 : component + 1;
    if (which < ranges->GetNumberOfTuples())
    {
      ranges->GetTuple(which, range.data());
    }
  }
  this->Mapper->SetWholeScalarRange(range.data());

  if (!vtkFFDLattice::HasLattice(image))
  {
    this->Mapper->SetDeformation(nullptr);
  }
  else
  {
    const vtkMTimeType fields = image->GetFieldData()->GetMTime();
    if (fields != in.LatticeTime)
    {
      in.Lattice->ReadFrom(image);
      in.LatticeTime = fields;
    }
    this->Mapper->SetDeformation(in.Lattice);
  }
}

//------------------------------------------------------------------------------
/// The mapper takes distances in units of the data, before the matrix of the actor.
void vtkFFDVolumeRepresentation::UpdateSampleDistances(
  vtkImageData* image, double lodResolution, bool useLOD)
{
  const double coarser =
    std::min(1.0 / std::max(lodResolution, 1.0 / LargestCoarsening), LargestCoarsening);
  this->Mapper->SetMaximumImageSampleDistance(
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
    this->Mapper->SetSampleDistance(distance);
    this->Mapper->SetInteractiveSampleDistance(useLOD ? coarser * distance : distance);
  }
}

//------------------------------------------------------------------------------
void vtkFFDVolumeRepresentation::UpdateCropping(vtkImageData* image)
{
  if (!this->Mapper->GetCropping())
  {
    return;
  }
  // Those of the whole, of which this may be a part.
  double bounds[6];
  this->Mapper->GetWholeBounds(bounds);
  if (this->Mapper->GetCroppingSpace() == vtkFFDInverseRayVolumeMapper::DEFORMED)
  {
    this->Mapper->GetBounds(bounds);
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
  this->Mapper->SetCroppingRegionPlanes(planes);
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
    !ShownArray::FromInformation(this->GetInputArrayInformation(0)).Name.empty());
  if (this->Property)
  {
    this->Property->SetIndependentComponents(true);
    this->Property->SetTransferFunctionMode(vtkVolumeProperty::TF_1D);
  }
}

//------------------------------------------------------------------------------
vtkTypeInt64 vtkFFDVolumeRepresentation::GetNumberOfLocalVoxels()
{
  vtkImageData* image = vtkImageData::SafeDownCast(this->Cache);
  return image ? image->GetNumberOfPoints() : 0;
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
  this->Mapper->SetNumberOfThreads(threads);
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
/// The boxes of a partition are boxes of the scene.
void vtkFFDVolumeRepresentation::MarkMoved()
{
  if (GetNumberOfProcesses() > 1)
  {
    this->MarkModified();
  }
}

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
