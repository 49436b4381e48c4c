// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDShownPlaces.h"

#include "vtkFFDShownLattice.h"
#include "vtkFFDVolumeInput.h"
#include "vtkFFDVolumeRepresentation.h"

#include "vtkAlgorithm.h"
#include "vtkCallbackCommand.h"
#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCommand.h"
#include "vtkCommunicator.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTree.h"
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkLine.h"
#include "vtkMath.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPProbeFilter.h"
#include "vtkPVExtractSelection.h"
#include "vtkPVRayCastPickingHelper.h"
#include "vtkSelection.h"
#include "vtkSelectionNode.h"
#include "vtkTrivialProducer.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace ffdplaces
{
namespace
{

/// Of intersections with cells, as ParaView's: without one rounding makes rays miss them.
constexpr double HitTolerance = 1e-10;

/// Call `visit` with the unstructured grids of an extracted selection.
template <class Visit>
void VisitGrids(vtkDataObject* data, const Visit& visit)
{
  if (auto* parts = vtkCompositeDataSet::SafeDownCast(data))
  {
    vtkSmartPointer<vtkCompositeDataIterator> iterator;
    iterator.TakeReference(parts->NewIterator());
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
    {
      visit(vtkUnstructuredGrid::SafeDownCast(iterator->GetCurrentDataObject()));
    }
    return;
  }
  visit(vtkUnstructuredGrid::SafeDownCast(data));
}

/// A moved copy of cells: voxels and pixels, which are boxes, become cells of any shape.
void MoveCells(
  vtkUnstructuredGrid* cells, const vtkFFDShownLattice& shown, vtkUnstructuredGrid* moved)
{
  vtkNew<vtkUnstructuredGrid> general;
  general->SetPoints(cells->GetPoints());
  general->GetPointData()->ShallowCopy(cells->GetPointData());
  vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i)
  {
    cells->GetCellPoints(i, ids);
    int type = cells->GetCellType(i);
    if (type == VTK_VOXEL || type == VTK_PIXEL)
    {
      for (vtkIdType first = 2; first < ids->GetNumberOfIds(); first += 4)
      {
        const vtkIdType id = ids->GetId(first);
        ids->SetId(first, ids->GetId(first + 1));
        ids->SetId(first + 1, id);
      }
      type = type == VTK_VOXEL ? VTK_HEXAHEDRON : VTK_QUAD;
    }
    general->InsertNextCell(type, ids);
  }
  shown.Move(general, moved);
}

/// Let a square through `center` be the only cell. Its diagonals do not pass through the center,
/// where intersections would meet two triangles.
void MakeSquare(
  vtkUnstructuredGrid* cells, const double center[3], const double normal[3], double size)
{
  double across[2][3];
  vtkMath::Perpendiculars(normal, across[0], across[1], 0.0);
  vtkNew<vtkPoints> corners;
  corners->SetDataTypeToDouble();
  for (int corner = 0; corner < 4; ++corner)
  {
    const double u = corner == 1 || corner == 2 ? 3.0 * size : -size;
    const double v = corner >= 2 ? 2.0 * size : -size;
    corners->InsertNextPoint(center[0] + u * across[0][0] + v * across[1][0],
      center[1] + u * across[0][1] + v * across[1][1],
      center[2] + u * across[0][2] + v * across[1][2]);
  }
  cells->Initialize();
  cells->Allocate(1);
  cells->SetPoints(corners);
  const vtkIdType ids[4] = { 0, 1, 2, 3 };
  cells->InsertNextCell(VTK_QUAD, 4, ids);
}

/**
 * Where the ray misses the first cell, let the cell be a square across the ray, where that is
 * nearest to the center of the cell: volumes are seen at places between pixels, and a cell that
 * was found at the border of a pixel may lie beside the ray through its center.
 */
void FaceRay(vtkUnstructuredGrid* cells, const double* from, const double* to)
{
  vtkCell* cell = cells->GetCell(0);
  double start[3];
  double end[3];
  std::copy_n(from, 3, start);
  std::copy_n(to, 3, end);
  double t;
  double x[3];
  double parametric[3];
  int part;
  if (cell->IntersectWithLine(start, end, HitTolerance, t, x, parametric, part))
  {
    return;
  }
  double bounds[6];
  cell->GetBounds(bounds);
  const double center[3] = { 0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]),
    0.5 * (bounds[4] + bounds[5]) };
  double nearest[3];
  vtkLine::DistanceToLine(center, start, end, t, nearest);
  double ray[3];
  vtkMath::Subtract(end, start, ray);
  MakeSquare(cells, nearest, ray, std::sqrt(cell->GetLength2()));
}

/// Let a piece of the surface that the ray meets at `place` be the only cell.
void FaceSurface(vtkUnstructuredGrid* cells, const double place[3], const double normal[3],
  const double from[3], const double to[3])
{
  double ray[3];
  vtkMath::Subtract(to, from, ray);
  vtkMath::Normalize(ray);
  // A surface that is seen from its edge has no place of its own on the ray.
  const double size = vtkMath::Norm(normal);
  const bool isEdgeOn = !(std::abs(vtkMath::Dot(ray, normal)) > 0.01 * size);
  MakeSquare(cells, place, isEdgeOn ? ray : normal,
    1e-3 * std::sqrt(vtkMath::Distance2BetweenPoints(from, to)));
}

/// Members of ParaView's helper that are for its subclasses.
struct Picking : vtkPVRayCastPickingHelper
{
  /// Once input and selection are there: extract the cell that is selected, move it, and let it be
  /// the input, of which the first cell is selected.
  static void Prepare(vtkPVRayCastPickingHelper* helper)
  {
    vtkAlgorithm* input = helper->*(&Picking::Input);
    vtkAlgorithm* selection = helper->*(&Picking::Selection);
    if (!input || !selection || vtkTrivialProducer::SafeDownCast(selection))
    {
      return;
    }
    vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
    const bool isRoot = !controller || controller->GetLocalProcessId() == 0;
    const double* from = helper->*(&Picking::PointA);
    const double* to = helper->*(&Picking::PointB);
    vtkNew<vtkUnstructuredGrid> moved;
    // Where a volume is picked, and the pointer rests on it, is told by its representation.
    vtkFFDVolumeRepresentation* volume = helper->*(&Picking::SnapOnMeshPoint)
      ? nullptr
      : vtkFFDVolumeRepresentation::FindShownBy(input, from, to);
    if (volume)
    {
      volume->Pick(from[0], from[1], from[2], to[0], to[1], to[2]);
      const double* picked = volume->GetPicked();
      if (picked[0] > 0.0)
      {
        if (isRoot)
        {
          FaceSurface(moved, picked + 1, volume->GetPickedNormal(), from, to);
        }
        Replace(helper, moved);
        return;
      }
    }
    vtkNew<vtkPVExtractSelection> extract;
    extract->SetInputConnection(0, input->GetOutputPort(0));
    extract->SetInputConnection(1, selection->GetOutputPort(0));
    extract->UpdatePiece(controller ? controller->GetLocalProcessId() : 0,
      controller ? controller->GetNumberOfProcesses() : 1, 0);
    const vtkFFDShownLattice ofAll =
      vtkFFDShownLattice::FindAnywhere(input->GetOutputDataObject(0));
    const int hasHere = ofAll.Lattice ? 1 : 0;
    int has = hasHere;
    if (controller && controller->GetNumberOfProcesses() > 1)
    {
      controller->AllReduce(&hasHere, &has, 1, vtkCommunicator::MAX_OP);
    }
    if (!has)
    {
      return;
    }
    VisitGrids(extract->GetOutputDataObject(0), [&](vtkUnstructuredGrid* cells) {
      if (cells && cells->GetNumberOfCells() > 0 && moved->GetNumberOfCells() == 0)
      {
        const vtkFFDShownLattice own(cells);
        MoveCells(cells, own.Lattice ? own : ofAll, moved);
        if (moved->GetCell(0)->GetCellDimension() == 3)
        {
          FaceRay(moved, from, to);
        }
      }
    });
    Replace(helper, moved);
  }

private:
  /// Let cells be the input, and the first of them be selected.
  static void Replace(vtkPVRayCastPickingHelper* helper, vtkUnstructuredGrid* moved)
  {
    vtkNew<vtkIdTypeArray> first;
    first->InsertNextValue(0);
    vtkNew<vtkSelectionNode> node;
    node->SetContentType(vtkSelectionNode::INDICES);
    node->SetFieldType(vtkSelectionNode::CELL); // points are selected as vertices
    node->SetSelectionList(first);
    vtkNew<vtkSelection> firstOnly;
    firstOnly->AddNode(node);
    vtkNew<vtkTrivialProducer> newInput;
    vtkNew<vtkTrivialProducer> newSelection;
    newInput->SetOutput(moved);
    newSelection->SetOutput(firstOnly);
    // The selection first: it tells that this is done.
    helper->SetSelection(newSelection);
    helper->SetInput(newInput);
  }
};

/**
 * Where a ray meets a moved cell; where that is at rest, and the value of an array of points or
 * cells there, of the first cell of `rest`. A ray beside the cell, which was found at the middle of
 * a pixel, meets its plane, as in ParaView's helper, or of a solid cell the place nearest to its
 * center.
 */
void FindOnCell(vtkUnstructuredGrid* rest, vtkCell* cell, const double from[3], const double to[3],
  const std::string& array, bool ofCells, std::array<double, 8>& picked)
{
  double start[3];
  double end[3];
  std::copy_n(from, 3, start);
  std::copy_n(to, 3, end);
  double t = VTK_DOUBLE_MAX;
  double x[3];
  double parametric[3];
  int part = 0;
  std::vector<double> weights(static_cast<std::size_t>(cell->GetNumberOfPoints()));
  const bool isHit = cell->IntersectWithLine(start, end, HitTolerance, t, x, parametric, part) != 0;
  const bool isBeside = !isHit && !(cell->GetCellDimension() == 2 && t < VTK_DOUBLE_MAX);
  if (isBeside)
  {
    double bounds[6];
    cell->GetBounds(bounds);
    const double center[3] = { 0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]),
      0.5 * (bounds[4] + bounds[5]) };
    vtkLine::DistanceToLine(center, start, end, t, x);
  }
  double distance = 0.0;
  double nearest[3];
  if (cell->EvaluatePosition(x, nearest, part, parametric, distance, weights.data()) < 0)
  {
    return;
  }
  std::copy_n(isBeside ? nearest : x, 3, x);
  vtkDataSetAttributes* attributes = ofCells
    ? static_cast<vtkDataSetAttributes*>(rest->GetCellData())
    : static_cast<vtkDataSetAttributes*>(rest->GetPointData());
  vtkDataArray* values = attributes->GetArray(array.c_str());
  std::vector<double> value(
    static_cast<std::size_t>(values ? values->GetNumberOfComponents() : 1), 0.0);
  std::copy_n(x, 3, picked.begin() + 1);
  for (std::size_t i = 0; i < weights.size(); ++i)
  {
    const vtkIdType id = cell->GetPointId(static_cast<int>(i));
    const double* point = rest->GetPoint(id);
    for (std::size_t a = 0; a < 3; ++a)
    {
      picked[4 + a] += weights[i] * point[a];
    }
    for (std::size_t c = 0; values && !ofCells && c < value.size(); ++c)
    {
      value[c] += weights[i] * values->GetComponent(id, static_cast<int>(c));
    }
  }
  for (std::size_t c = 0; values && ofCells && c < value.size(); ++c)
  {
    value[c] = values->GetComponent(0, static_cast<int>(c));
  }
  picked[7] = value.size() == 1
    ? value[0]
    : std::sqrt(std::inner_product(value.begin(), value.end(), value.begin(), 0.0));
  picked[0] = 1.0;
}

/// Data with one lattice, which all processes have.
struct Part
{
  vtkFFDShownLattice Shown;
  vtkSmartPointer<vtkDataObject> Data;
};

bool AreSeveral(vtkMultiProcessController* controller)
{
  return controller && controller->GetNumberOfProcesses() > 1;
}

/// A point of no place that has the arrays of a block: probes take the arrays of the data that
/// their process has, and another process may have the values.
vtkSmartPointer<vtkImageData> MakeStandIn(vtkDataSet* block)
{
  auto nowhere = vtkSmartPointer<vtkImageData>::New();
  nowhere->SetOrigin(VTK_FLOAT_MAX, VTK_FLOAT_MAX, VTK_FLOAT_MAX);
  nowhere->SetDimensions(1, 1, 1);
  nowhere->GetPointData()->CopyAllOn();
  nowhere->GetPointData()->CopyAllocate(block->GetPointData(), 1);
  nowhere->GetPointData()->CopyData(block->GetPointData(), vtkIdType(0), vtkIdType(0));
  return nowhere;
}

/// Give all processes, which all call it, the lattice of the first that has one.
void Share(vtkMultiProcessController* controller, vtkFFDShownLattice& shown)
{
  if (!AreSeveral(controller))
  {
    return;
  }
  const int own = controller->GetLocalProcessId();
  const int here = shown.Lattice ? own : controller->GetNumberOfProcesses();
  int root = here;
  controller->AllReduce(&here, &root, 1, vtkCommunicator::MIN_OP);
  if (root == controller->GetNumberOfProcesses())
  {
    return;
  }
  // Of an image only the point data are sent bit by bit; the rest comes as decimals.
  vtkNew<vtkImageData> points;
  std::array<double, 8> numbers{};
  if (own == root)
  {
    shown.Lattice->ToImageData(points);
    points->GetOrigin(numbers.data());
    points->GetSpacing(numbers.data() + 3);
    numbers[6] = shown.Lattice->GetDisplacementScale();
    numbers[7] = shown.Mode;
  }
  controller->Broadcast(points.GetPointer(), root);
  controller->Broadcast(numbers.data(), static_cast<vtkIdType>(numbers.size()), root);
  points->SetOrigin(numbers.data());
  points->SetSpacing(numbers.data() + 3);
  vtkNew<vtkFFDLattice> lattice;
  if (!shown.Lattice && lattice->FromImageData(points))
  {
    lattice->SetDisplacementScale(numbers[6]);
    shown.Lattice = lattice;
    shown.Mode = static_cast<int>(numbers[7]);
  }
}

/// The data, or its blocks by their lattices; nothing if there is no lattice. Called on all
/// processes.
std::vector<Part> FindParts(vtkMultiProcessController* controller, vtkDataObject* data)
{
  std::vector<Part> parts;
  const auto add = [&](vtkFFDShownLattice shown, vtkDataObject* object) {
    Share(controller, shown);
    parts.push_back({ shown, object });
  };
  if (auto* tree = vtkDataObjectTree::SafeDownCast(data))
  {
    const auto groups = vtkFFDVolumeInput::GroupByLattice(tree);
    const auto withBlocks =
      std::find_if(groups.begin(), groups.end(), [](const auto& group) { return !group.empty(); });
    for (const std::vector<vtkDataSet*>& group : groups)
    {
      vtkNew<vtkMultiBlockDataSet> blocks;
      for (vtkDataSet* block : group)
      {
        blocks->SetBlock(blocks->GetNumberOfBlocks(), block);
      }
      if (group.empty() && withBlocks != groups.end())
      {
        blocks->SetBlock(0, MakeStandIn(withBlocks->front()));
      }
      add(vtkFFDShownLattice(group.empty() ? nullptr : group.front()), blocks);
    }
  }
  else
  {
    add(vtkFFDShownLattice(data), data);
  }
  const bool any = std::any_of(
    parts.begin(), parts.end(), [](const Part& part) { return part.Shown.Lattice != nullptr; });
  return any ? parts : std::vector<Part>();
}

/// Values of the data at places at rest, one for each point of the result. Called on all processes.
vtkSmartPointer<vtkPointData> Probe(
  vtkMultiProcessController* controller, vtkDataObject* data, vtkPoints* places)
{
  vtkNew<vtkPolyData> points;
  points->SetPoints(places);
  vtkNew<vtkPProbeFilter> probe;
  probe->SetController(controller);
  probe->SetInputData(0, points);
  probe->SetInputData(1, data);
  probe->SetPassPointArrays(false);
  probe->Update();
  return vtkDataSet::SafeDownCast(probe->GetOutputDataObject(0))->GetPointData();
}

/// Called on all processes.
void ProbeAgain(vtkAlgorithm* filter, int dataPort)
{
  vtkPolyData* output = vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0));
  if (!output || filter->GetNumberOfInputConnections(dataPort) != 1)
  {
    return;
  }
  vtkDataObject* data = filter->GetInputDataObject(dataPort, 0);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  vtkNew<vtkDoubleArray> places; // of the output of the first process, which alone has one
  places->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
  {
    places->InsertNextTuple(output->GetPoint(i));
  }
  if (AreSeveral(controller))
  {
    controller->Broadcast(places.GetPointer(), 0);
  }
  const vtkIdType count = places->GetNumberOfTuples();
  const std::vector<Part> parts = FindParts(controller, data);
  if (parts.empty() || count == 0)
  {
    return;
  }
  const bool hasOutput = output->GetNumberOfPoints() == count;
  vtkPointData* arrays = output->GetPointData();
  vtkNew<vtkDoubleArray> restPositions;
  restPositions->SetName("RestPosition");
  restPositions->SetNumberOfComponents(3);
  std::vector<bool> isFound(static_cast<std::size_t>(count), false);
  for (const Part& part : parts)
  {
    const bool isFirst = &part == &parts.front();
    vtkNew<vtkPoints> rest;
    rest->SetDataTypeToDouble();
    for (vtkIdType i = 0; i < count; ++i)
    {
      double place[3];
      places->GetTuple(i, place);
      double atRest[3];
      std::copy_n(place, 3, atRest);
      if (part.Shown.Lattice)
      {
        part.Shown.PullBack(place, atRest);
      }
      rest->InsertNextPoint(atRest);
    }
    const vtkSmartPointer<vtkPointData> found = Probe(controller, part.Data, rest);
    vtkDataArray* valid = found->GetArray("vtkValidPointMask");
    for (int a = 0; hasOutput && isFirst && a < found->GetNumberOfArrays(); ++a)
    {
      if (found->GetAbstractArray(a)->GetNumberOfTuples() == count)
      {
        arrays->AddArray(found->GetAbstractArray(a));
      }
    }
    for (vtkIdType i = 0; i < count; ++i)
    {
      const bool isHere = valid && valid->GetNumberOfTuples() == count && valid->GetTuple1(i) > 0.0;
      const bool isTaken = isHere && !isFound[static_cast<std::size_t>(i)];
      if (isFirst)
      {
        restPositions->InsertNextTuple(rest->GetPoint(i));
      }
      if (!isTaken)
      {
        continue;
      }
      isFound[static_cast<std::size_t>(i)] = true;
      restPositions->SetTuple(i, rest->GetPoint(i));
      for (int a = 0; hasOutput && !isFirst && a < found->GetNumberOfArrays(); ++a)
      {
        vtkAbstractArray* from = found->GetAbstractArray(a);
        vtkAbstractArray* to =
          from->GetName() ? arrays->GetAbstractArray(from->GetName()) : nullptr;
        if (to && to->GetNumberOfTuples() == count && from->GetNumberOfTuples() == count &&
          to->GetNumberOfComponents() == from->GetNumberOfComponents())
        {
          to->SetTuple(i, i, from);
        }
      }
    }
  }
  if (hasOutput)
  {
    arrays->AddArray(restPositions);
  }
  // What is shown here stays here.
  vtkFFDLattice::DetachFrom(output);
}

} // namespace

//------------------------------------------------------------------------------
std::array<double, 8> PickSurface(vtkAlgorithm* input, vtkAlgorithm* selection,
  const double from[3], const double to[3], const std::string& array, bool ofCells)
{
  std::array<double, 8> picked{};
  if (!input || !selection)
  {
    return picked;
  }
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  vtkNew<vtkPVExtractSelection> extract;
  extract->SetInputConnection(0, input->GetOutputPort(0));
  extract->SetInputConnection(1, selection->GetOutputPort(0));
  extract->UpdatePiece(controller ? controller->GetLocalProcessId() : 0,
    controller ? controller->GetNumberOfProcesses() : 1, 0);
  const vtkFFDShownLattice ofAll = vtkFFDShownLattice::FindAnywhere(input->GetOutputDataObject(0));
  VisitGrids(extract->GetOutputDataObject(0), [&](vtkUnstructuredGrid* cells) {
    const vtkFFDShownLattice own(cells);
    const vtkFFDShownLattice& shown = own.Lattice ? own : ofAll;
    if (!cells || cells->GetNumberOfCells() == 0 || picked[0] != 0.0)
    {
      return;
    }
    vtkDataArray* restPositions = cells->GetPointData()->GetArray("RestPosition");
    if (!shown.Lattice && restPositions && restPositions->GetNumberOfComponents() == 3)
    {
      vtkNew<vtkPoints> points;
      points->SetData(restPositions);
      vtkNew<vtkUnstructuredGrid> rest;
      rest->ShallowCopy(cells);
      rest->SetPoints(points);
      FindOnCell(rest, cells->GetCell(0), from, to, array, ofCells, picked);
    }
    else if (shown.Lattice)
    {
      vtkNew<vtkUnstructuredGrid> moved;
      MoveCells(cells, shown, moved);
      FindOnCell(cells, moved->GetCell(0), from, to, array, ofCells, picked);
    }
  });
  if (AreSeveral(controller))
  {
    const int own = controller->GetLocalProcessId();
    const int here = picked[0] > 0.0 ? own : controller->GetNumberOfProcesses();
    int root = here;
    controller->AllReduce(&here, &root, 1, vtkCommunicator::MIN_OP);
    if (root < controller->GetNumberOfProcesses())
    {
      controller->Broadcast(picked.data(), static_cast<vtkIdType>(picked.size()), root);
    }
  }
  return picked;
}

//------------------------------------------------------------------------------
void FollowPicking(vtkPVRayCastPickingHelper* helper)
{
  vtkNew<vtkCallbackCommand> command;
  command->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
    Picking::Prepare(vtkPVRayCastPickingHelper::SafeDownCast(caller));
  });
  helper->AddObserver(vtkCommand::ModifiedEvent, command);
}

//------------------------------------------------------------------------------
void FollowProbe(vtkAlgorithm* filter, int dataPort)
{
  vtkNew<vtkCallbackCommand> command;
  command->SetClientData(reinterpret_cast<void*>(static_cast<std::intptr_t>(dataPort)));
  command->SetCallback([](vtkObject* caller, unsigned long, void* port, void*) {
    ProbeAgain(
      vtkAlgorithm::SafeDownCast(caller), static_cast<int>(reinterpret_cast<std::intptr_t>(port)));
  });
  filter->AddObserver(vtkCommand::EndEvent, command);
}

} // namespace ffdplaces
