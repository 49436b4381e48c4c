// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDShownGeometry.h"

#include "vtkFFDLattice.h"
#include "vtkFFDPassedLattice.h"
#include "vtkFFDShownLattice.h"
#include "vtkFFDShownPlaces.h"
#include "vtkFFDVolumeParts.h"

#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkCommunicator.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkFieldData.h"
#include "vtkGeometryRepresentation.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointGaussianRepresentation.h"
#include "vtkPoints.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkPProbeFilter.h"
#include "vtkPVCompositeRepresentation.h"
#include "vtkPVGeometryFilter.h"
#include "vtkPVGridAxes3DRepresentation.h"
#include "vtkPVProbeLineFilter.h"
#include "vtkPVRayCastPickingHelper.h"
#include "vtkResampleToImage.h"
#include "vtkSelectionRepresentation.h"
#include "vtkUnstructuredGridVolumeRepresentation.h"
#include "vtkView.h"
#include "vtkVolumeRepresentationPreprocessor.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <array>

vtkStandardNewMacro(vtkFFDShownGeometry);

namespace
{

using ffdparts::Bounds;
using Shown = vtkFFDShownLattice;

/// Parts that a line of an outline is cut into.
constexpr int OutlineParts = 32;

/// Call `visit` for the leaves of a composite data set, and for another object itself.
template <class Visit>
void VisitLeaves(vtkDataObject* data, const Visit& visit)
{
  auto* parts = vtkCompositeDataSet::SafeDownCast(data);
  if (!parts)
  {
    visit(data);
    return;
  }
  vtkSmartPointer<vtkCompositeDataIterator> iterator;
  iterator.TakeReference(parts->NewIterator());
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    visit(iterator->GetCurrentDataObject());
  }
}

/// The lattice of all of a data object, see vtkFFDShownLattice::FindCarrier().
Shown FindShownOfAll(vtkDataObject* data) { return Shown(Shown::FindCarrier(data)); }

/// A moved copy of a surface.
vtkSmartPointer<vtkPolyData> Move(vtkPolyData* surface, const Shown& shown, bool isOutline)
{
  auto moved = vtkSmartPointer<vtkPolyData>::New();
  moved->ShallowCopy(surface);
  if (isOutline)
  {
    vtkFFDShownGeometry::CutLines(moved);
  }
  // Vectors are what is colored by, and stay what they are in the data.
  for (vtkDataSetAttributes* attributes :
    { static_cast<vtkDataSetAttributes*>(moved->GetPointData()),
      static_cast<vtkDataSetAttributes*>(moved->GetCellData()) })
  {
    attributes->SetActiveVectors(nullptr);
  }
  vtkNew<vtkPolyData> rest;
  rest->ShallowCopy(moved);
  shown.Move(rest, moved);
  const auto restore = [](vtkDataSetAttributes* to, vtkDataSetAttributes* from) {
    if (from->GetVectors() && from->GetVectors()->GetName())
    {
      to->SetActiveVectors(from->GetVectors()->GetName());
    }
  };
  restore(moved->GetPointData(), surface->GetPointData());
  restore(moved->GetCellData(), surface->GetCellData());
  return moved;
}

/// Data whose parts are moved where they or all of them have a lattice; null if nothing is moved.
/// `move(part, shown)`: a moved copy of a part that is a Part, or null to leave it.
template <class Part, class MovePart>
vtkSmartPointer<vtkDataObject> MoveParts(
  vtkDataObject* data, const Shown& ofAll, const MovePart& move)
{
  const auto moveOne = [&move](vtkDataObject* one, const Shown& shown) {
    Part* const part = Part::SafeDownCast(one);
    return part && shown.Lattice ? move(part, shown) : nullptr;
  };
  auto* parts = vtkCompositeDataSet::SafeDownCast(data);
  if (!parts)
  {
    return moveOne(data, ofAll);
  }
  vtkSmartPointer<vtkCompositeDataSet> moved;
  vtkSmartPointer<vtkCompositeDataIterator> iterator;
  iterator.TakeReference(parts->NewIterator());
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    vtkDataObject* const one = iterator->GetCurrentDataObject();
    if (const vtkSmartPointer<Part> part = moveOne(one, ofAll.Lattice ? ofAll : Shown(one)))
    {
      if (!moved)
      {
        moved.TakeReference(parts->NewInstance());
        moved->ShallowCopy(parts);
      }
      moved->SetDataSet(iterator, part);
    }
  }
  return moved;
}

/// Moves surfaces or points, as MoveParts().
vtkSmartPointer<vtkDataObject> MoveAll(vtkDataObject* data, const Shown& ofAll, bool isOutline)
{
  return MoveParts<vtkPolyData>(data, ofAll,
    [isOutline](vtkPolyData* part, const Shown& shown) { return Move(part, shown, isOutline); });
}

/// Enlarge `bounds` by where a part of a data set, or the whole, is shown; `atRest`: images are not
/// moved.
void AddShownBounds(Bounds& bounds, vtkDataObject* data, const Shown& ofAll, bool atRest,
  ffdparts::DeformedBoundsFinder& finder)
{
  vtkDataSet* part = vtkDataSet::SafeDownCast(data);
  if (!part || part->GetNumberOfPoints() == 0)
  {
    return;
  }
  vtkPointSet* points = vtkPointSet::SafeDownCast(part);
  const bool stays = atRest && !points;
  Shown shown = stays ? Shown(nullptr) : ofAll;
  if (!shown.Lattice && !stays)
  {
    shown = Shown(part);
  }
  Bounds own;
  part->GetBounds(own.data());
  if (shown.Lattice && points)
  {
    vtkNew<vtkPolyData> cloud;
    cloud->SetPoints(points->GetPoints());
    Move(cloud, shown, false)->GetBounds(own.data());
  }
  else if (shown.Lattice)
  {
    vtkSmartPointer<vtkImageData> image = vtkImageData::SafeDownCast(part);
    if (!image)
    {
      image = vtkSmartPointer<vtkImageData>::New();
      image->SetDimensions(2, 2, 2);
      image->SetOrigin(own[0], own[2], own[4]);
      image->SetSpacing(own[1] - own[0], own[3] - own[2], own[5] - own[4]);
    }
    ffdparts::Extent extent;
    image->GetExtent(extent.data());
    own = finder.Find(ffdparts::Grid::FromImage(image, extent), shown.Lattice, shown.Mode);
  }
  for (std::size_t a = 0; a < 3; ++a)
  {
    bounds[2 * a] = std::min(bounds[2 * a], own[2 * a]);
    bounds[2 * a + 1] = std::max(bounds[2 * a + 1], own[2 * a + 1]);
  }
}

/// Members of ParaView's representations that are for their subclasses.
struct Geometry : vtkGeometryRepresentation
{
  static void Follow(vtkGeometryRepresentation* representation)
  {
    vtkAlgorithm* maker = representation->*(&Geometry::GeometryFilter);
    vtkNew<vtkFFDShownGeometry> shown;
    shown->SetMaker(maker);
    shown->SetInputConnection(maker->GetOutputPort());
    (representation->*(&Geometry::MultiBlockMaker))->SetInputConnection(shown->GetOutputPort());
  }
};

struct Selection : vtkSelectionRepresentation
{
  static void Follow(vtkSelectionRepresentation* representation)
  {
    Geometry::Follow(representation->*(&Selection::GeometryRepresentation));
  }
};

struct Gaussians : vtkPointGaussianRepresentation
{
  static void Follow(vtkPointGaussianRepresentation* representation)
  {
    // Comes between the points and their way to the view.
    vtkNew<vtkCallbackCommand> command;
    command->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
      auto* done = vtkPointGaussianRepresentation::SafeDownCast(caller);
      if (!done || done->GetNumberOfInputConnections(0) != 1)
      {
        return;
      }
      vtkSmartPointer<vtkDataObject>& points = done->*(&Gaussians::ProcessedData);
      if (auto moved = MoveAll(points, FindShownOfAll(done->GetInputDataObject(0, 0)), false))
      {
        points = moved;
      }
    });
    representation->AddObserver(vtkCommand::UpdateDataEvent, command);
  }
};

/// A copy of a grid of cells with moved points; null without any.
vtkSmartPointer<vtkPointSet> MoveGrid(vtkPointSet* grid, const Shown& shown)
{
  vtkSmartPointer<vtkPointSet> moved;
  if (grid->GetNumberOfPoints() > 0)
  {
    moved.TakeReference(grid->NewInstance());
    moved->ShallowCopy(grid);
    shown.Move(grid, moved);
  }
  return moved;
}

/// While a filter executes, its input is a moved copy.
class MovedInput : public vtkCommand
{
public:
  static MovedInput* New() { return new MovedInput; }

  void Execute(vtkObject* caller, unsigned long event, void*) override
  {
    auto* filter = vtkAlgorithm::SafeDownCast(caller);
    if (!filter || filter->GetNumberOfInputConnections(0) != 1)
    {
      return;
    }
    vtkInformation* input = filter->GetInputInformation(0, 0);
    if (event == vtkCommand::StartEvent)
    {
      vtkDataObject* rest = vtkDataObject::GetData(input);
      if (const vtkSmartPointer<vtkDataObject> moved =
            MoveParts<vtkPointSet>(rest, FindShownOfAll(rest), &MoveGrid))
      {
        this->Rest = rest;
        input->Set(vtkDataObject::DATA_OBJECT(), moved);
      }
    }
    else if (this->Rest)
    {
      input->Set(vtkDataObject::DATA_OBJECT(), this->Rest);
      this->Rest = nullptr;
    }
  }

private:
  vtkSmartPointer<vtkDataObject> Rest;
};

struct GridVolume : vtkUnstructuredGridVolumeRepresentation
{
  static void Follow(vtkUnstructuredGridVolumeRepresentation* representation)
  {
    // Makes the tetrahedra that are rendered.
    vtkAlgorithm* maker = (representation->*(&GridVolume::Preprocessor)).Get();
    vtkNew<vtkCallbackCommand> command;
    command->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
      auto* done = vtkAlgorithm::SafeDownCast(caller);
      auto* grid = vtkPointSet::SafeDownCast(done->GetOutputDataObject(0));
      vtkDataObject* data =
        done->GetNumberOfInputConnections(0) > 0 ? done->GetInputDataObject(0, 0) : nullptr;
      const Shown shown = FindShownOfAll(data);
      if (grid && grid->GetNumberOfPoints() > 0 && shown.Lattice)
      {
        grid->SetPoints(MoveGrid(grid, shown)->GetPoints());
      }
    });
    maker->AddObserver(vtkCommand::EndEvent, command);
    // Makes the image that its mapper "Resample To Image" renders.
    vtkAlgorithm* resampler = (representation->*(&GridVolume::ResampleToImageFilter)).Get();
    vtkNew<MovedInput> exchange;
    resampler->AddObserver(vtkCommand::StartEvent, exchange);
    resampler->AddObserver(vtkCommand::EndEvent, exchange);
  }
};

struct WithAxes : vtkPVCompositeRepresentation
{
  /// The representation that axes are a part of; null without a view.
  static vtkPVCompositeRepresentation* Find(vtkPVGridAxes3DRepresentation* axes)
  {
    vtkView* view = axes->GetView();
    for (int i = 0; view && i < view->GetNumberOfRepresentations(); ++i)
    {
      auto* each = vtkPVCompositeRepresentation::SafeDownCast(view->GetRepresentation(i));
      if (each && each->*(&WithAxes::GridAxesRepresentation) == axes)
      {
        return each;
      }
    }
    return nullptr;
  }
};

struct Axes : vtkPVGridAxes3DRepresentation
{
  /// Called on all processes alike.
  static void SetShownBounds(vtkPVGridAxes3DRepresentation* representation, bool atRest,
    ffdparts::DeformedBoundsFinder& finder)
  {
    if (representation->GetNumberOfInputConnections(0) != 1)
    {
      return;
    }
    vtkDataObject* data = representation->GetInputDataObject(0, 0);
    const Shown shown = FindShownOfAll(data);
    Bounds bounds = { VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX,
      VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX };
    VisitLeaves(
      data, [&](vtkDataObject* leaf) { AddShownBounds(bounds, leaf, shown, atRest, finder); });
    vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
    if (controller && controller->GetNumberOfProcesses() > 1)
    {
      Bounds given = bounds;
      for (std::size_t a = 0; a < 3; ++a)
      {
        given[2 * a] = -given[2 * a];
      }
      controller->AllReduce(given.data(), bounds.data(), 6, vtkCommunicator::MAX_OP);
      for (std::size_t a = 0; a < 3; ++a)
      {
        bounds[2 * a] = -bounds[2 * a];
      }
    }
    if (ffdparts::IsEmpty(bounds))
    {
      return;
    }
    const double* position = representation->*(&Axes::Position);
    const double* scale = representation->*(&Axes::Scale);
    double corners[2][3];
    for (int i = 0; i < 6; ++i)
    {
      corners[i % 2][i / 2] = bounds[static_cast<std::size_t>(i)] * scale[i / 2] + position[i / 2];
    }
    vtkNew<vtkPoints> points;
    points->InsertNextPoint(corners[0]);
    points->InsertNextPoint(corners[1]);
    (representation->*(&Axes::DummyPolyData))->SetPoints(points);
  }
};

/// Puts axes around what is shown, also after another type of representation shows it.
class AxesFollower : public vtkCommand
{
public:
  static AxesFollower* New() { return new AxesFollower; }

  void Follow(vtkPVGridAxes3DRepresentation* axes)
  {
    this->Followed = axes;
    // Comes between ParaView's own bounds and their way to the view.
    axes->AddObserver(vtkCommand::UpdateDataEvent, this);
  }

  void Execute(vtkObject* caller, unsigned long, void*) override
  {
    if (caller == this->Followed && !this->Whole)
    {
      this->Whole = WithAxes::Find(this->Followed);
      if (this->Whole)
      {
        this->Whole->AddObserver(vtkCommand::ModifiedEvent, this);
      }
    }
    const char* type = this->Whole ? this->Whole->GetActiveRepresentationKey() : nullptr;
    const bool atRest = type && Shown::IsAtRest(type);
    if (caller == this->Followed)
    {
      this->WasAtRest = atRest;
      Axes::SetShownBounds(this->Followed, atRest, this->BoundsFinder);
    }
    else if (this->Followed && atRest != this->WasAtRest)
    {
      this->Followed->MarkModified();
    }
  }

private:
  vtkWeakPointer<vtkPVGridAxes3DRepresentation> Followed;
  vtkWeakPointer<vtkPVCompositeRepresentation> Whole;
  ffdparts::DeformedBoundsFinder BoundsFinder;
  bool WasAtRest = false;
};

} // namespace

//------------------------------------------------------------------------------
void vtkFFDShownGeometry::Follow(vtkObjectBase* object)
{
  if (auto* geometry = vtkGeometryRepresentation::SafeDownCast(object))
  {
    Geometry::Follow(geometry);
  }
  else if (auto* selection = vtkSelectionRepresentation::SafeDownCast(object))
  {
    Selection::Follow(selection);
  }
  else if (auto* gaussians = vtkPointGaussianRepresentation::SafeDownCast(object))
  {
    Gaussians::Follow(gaussians);
  }
  else if (auto* volume = vtkUnstructuredGridVolumeRepresentation::SafeDownCast(object))
  {
    GridVolume::Follow(volume);
  }
  else if (auto* axes = vtkPVGridAxes3DRepresentation::SafeDownCast(object))
  {
    vtkNew<AxesFollower> follower;
    follower->Follow(axes);
  }
  else if (auto* helper = vtkPVRayCastPickingHelper::SafeDownCast(object))
  {
    ffdplaces::FollowPicking(helper);
  }
  else if (auto* line = vtkPVProbeLineFilter::SafeDownCast(object))
  {
    ffdplaces::FollowProbe(line, 0);
  }
  else if (auto* probe = vtkPProbeFilter::SafeDownCast(object))
  {
    ffdplaces::FollowProbe(probe, 1);
  }
  else if (auto* filter = vtkAlgorithm::SafeDownCast(object))
  {
    ffdpassing::Follow(filter);
  }
}

//------------------------------------------------------------------------------
void vtkFFDShownGeometry::CutLines(vtkPolyData* outline)
{
  vtkPoints* from = outline->GetPoints();
  if (!from || outline->GetNumberOfLines() == 0 ||
    outline->GetNumberOfCells() != outline->GetNumberOfLines())
  {
    return;
  }
  vtkPointData* fromData = outline->GetPointData();
  vtkNew<vtkPoints> points;
  vtkNew<vtkPointData> pointData;
  vtkNew<vtkCellArray> lines;
  points->SetDataType(from->GetDataType());
  pointData->CopyAllOn();
  pointData->CopyAllocate(fromData);
  const auto addPoint = [&](vtkIdType source, const double x[3]) {
    const vtkIdType added = points->InsertNextPoint(x);
    pointData->CopyData(fromData, source, added);
    lines->InsertCellPoint(added);
  };
  vtkCellArray* old = outline->GetLines();
  vtkIdType count = 0;
  const vtkIdType* ids = nullptr;
  for (old->InitTraversal(); old->GetNextCell(count, ids);)
  {
    lines->InsertNextCell(static_cast<int>(count > 1 ? (count - 1) * OutlineParts + 1 : count));
    double a[3];
    for (vtkIdType i = 0; i + 1 < count; ++i)
    {
      double b[3];
      from->GetPoint(ids[i], a);
      from->GetPoint(ids[i + 1], b);
      for (int part = 0; part < OutlineParts; ++part)
      {
        const double t = static_cast<double>(part) / OutlineParts;
        const double x[3] = { a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]),
          a[2] + t * (b[2] - a[2]) };
        addPoint(ids[i], x);
      }
    }
    if (count > 0)
    {
      from->GetPoint(ids[count - 1], a);
      addPoint(ids[count - 1], a);
    }
  }
  outline->SetPoints(points);
  outline->SetLines(lines);
  outline->GetPointData()->ShallowCopy(pointData);
}

//------------------------------------------------------------------------------
int vtkFFDShownGeometry::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObject");
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDShownGeometry::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkDataObject* input = vtkDataObject::GetData(inputs[0]);
  vtkDataObject* output = vtkDataObject::GetData(outputs);
  output->ShallowCopy(input);
  vtkDataObject* data = nullptr;
  if (this->Maker && this->Maker->GetNumberOfInputConnections(0) > 0)
  {
    data = this->Maker->GetInputDataObject(0, 0);
  }
  // Selections of nothing come here, too, whenever the data have changed.
  const bool isEmpty = output->GetNumberOfElements(vtkDataObject::POINT) == 0;
  const Shown shown = isEmpty ? Shown(nullptr) : FindShownOfAll(data);
  auto* maker = vtkPVGeometryFilter::SafeDownCast(this->Maker);
  const bool isOutline = maker && maker->GetUseOutline();
  const vtkSmartPointer<vtkDataObject> moved =
    isEmpty ? nullptr : MoveAll(output, shown, isOutline);
  if (moved)
  {
    output->ShallowCopy(moved);
  }
  return 1;
}
