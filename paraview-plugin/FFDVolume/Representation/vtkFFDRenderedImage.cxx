// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDRenderedImage.h"

#include "vtkFFDLattice.h"
#include "vtkFFDShownLattice.h"
#include "vtkFFDVolumeInput.h"

#include "vtkCellData.h"
#include "vtkCellDataToPointData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkSMPTools.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>

namespace
{

template <class T>
ffd::Source<T> FindSource(T* object)
{
  return { object, object ? object->GetMTime() : 0 };
}

/// A component of an array, or the magnitude of its tuples.
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
    [from, components, array = to.Get()](vtkIdType first, vtkIdType last) {
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

/// Two arrays of one component as one of two.
vtkSmartPointer<vtkDataArray> Combine(vtkDataArray* first, vtkDataArray* second)
{
  vtkSmartPointer<vtkDataArray> both;
  if (first->GetDataType() == second->GetDataType())
  {
    both.TakeReference(first->NewInstance());
  }
  else
  {
    both.TakeReference(vtkDataArray::CreateDataArray(VTK_FLOAT));
  }
  both->SetNumberOfComponents(2);
  both->SetNumberOfTuples(first->GetNumberOfTuples());
  both->CopyComponent(0, first, 0);
  both->CopyComponent(1, second, 0);
  return both;
}

/// The flags without those of duplicates: the mapper hides all that have flags, and the part of
/// another process that is rendered here is a duplicate.
void AddWithoutDuplicates(vtkDataSetAttributes* arrays, vtkUnsignedCharArray* ghosts, int duplicate)
{
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
}

} // namespace

//------------------------------------------------------------------------------
ffd::Made MakeRenderedImage(vtkSmartPointer<vtkDataSet>& result, ffd::StageTools&,
  const ffdparts::Grid& grid, const vtkFFDCoordinates& coordinates,
  const vtkFFDShownComponents& shown, const vtkFFDShownSources& sources, const vtkFFDGhosts& ghosts)
{
  const auto makeStructure = [&grid]() {
    auto image = vtkSmartPointer<vtkImageData>::New();
    ffdparts::Extent extent = grid.WholeExtent;
    image->SetExtent(extent.data());
    grid.ApplyTo(image);
    return image;
  };
  const auto find = [&](
                      const vtkFFDShownComponent& which, const ffd::Source<vtkDataArray>& source) {
    vtkSmartPointer<vtkDataArray> array = source.Object;
    if (array && which.Array.OfCells)
    {
      const vtkSmartPointer<vtkImageData> onlyThis = makeStructure();
      onlyThis->GetCellData()->AddArray(array);
      onlyThis->GetPointData()->AddArray(ghosts.OfPoints.Object);
      onlyThis->GetCellData()->AddArray(ghosts.OfCells.Object);
      vtkNew<vtkCellDataToPointData> average;
      average->SetInputData(onlyThis);
      average->Update();
      array = average->GetOutput()->GetPointData()->GetArray(which.Array.Name.c_str());
    }
    if (array && array->GetNumberOfComponents() > 1 && which.Component != vtkFFDShownComponent::All)
    {
      array = ExtractComponent(array, which.Component);
      array->SetName(which.Array.Name.c_str());
    }
    return array;
  };
  vtkSmartPointer<vtkDataArray> array = find(shown.Color, sources.Color);
  const vtkSmartPointer<vtkDataArray> opacity = find(shown.Opacity, sources.Opacity);
  if (array && opacity)
  {
    array = Combine(array, opacity);
    array->SetName(shown.Color.Array.Name.c_str());
  }
  if (coordinates[0].Object)
  {
    vtkNew<vtkRectilinearGrid> rectilinear;
    rectilinear->SetExtent(const_cast<int*>(grid.WholeExtent.data()));
    rectilinear->SetXCoordinates(coordinates[0].Object);
    rectilinear->SetYCoordinates(coordinates[1].Object);
    rectilinear->SetZCoordinates(coordinates[2].Object);
    result = rectilinear;
  }
  else
  {
    result = makeStructure();
  }
  AddWithoutDuplicates(
    result->GetPointData(), ghosts.OfPoints.Object, vtkDataSetAttributes::DUPLICATEPOINT);
  AddWithoutDuplicates(
    result->GetCellData(), ghosts.OfCells.Object, vtkDataSetAttributes::DUPLICATECELL);
  if (array)
  {
    result->GetPointData()->AddArray(array);
  }
  if (const vtkSmartPointer<vtkDataArray> other = find(shown.Second, sources.Second))
  {
    // It may be the same array.
    vtkSmartPointer<vtkDataArray> second;
    second.TakeReference(other->NewInstance());
    second->ShallowCopy(other);
    second->SetName(vtkFFDShownComponents::SecondName);
    result->GetPointData()->AddArray(second);
  }
  return ffd::Made::Anew;
}

//------------------------------------------------------------------------------
ffd::Made MakeAttachedLattice(
  vtkSmartPointer<vtkFFDLattice>& result, ffd::StageTools&, const ffd::Source<vtkFieldData>& fields)
{
  vtkNew<vtkImageData> carrier;
  carrier->SetFieldData(fields.Object);
  if (!vtkFFDLattice::HasLattice(carrier))
  {
    result = nullptr;
    return ffd::Made::Anew;
  }
  if (!result)
  {
    result = vtkSmartPointer<vtkFFDLattice>::New();
  }
  vtkFFDShownLattice::Read(carrier, result);
  return ffd::Made::Anew;
}

//------------------------------------------------------------------------------
void vtkFFDRenderedImage::Update(vtkImageData* given, const vtkFFDShownComponents& shown)
{
  ffdparts::Extent extent;
  given->GetExtent(extent.data());
  vtkFFDGhosts ghosts;
  if (given->HasAnyBlankPoints())
  {
    ghosts.OfPoints = FindSource(given->GetPointGhostArray());
  }
  if (given->HasAnyBlankCells())
  {
    ghosts.OfCells = FindSource(given->GetCellGhostArray());
  }
  const vtkFFDShownSources sources = { FindSource(shown.Color.Array.FindIn(given)),
    FindSource(shown.Opacity.Array.FindIn(given)), FindSource(shown.Second.Array.FindIn(given)) };
  vtkFFDCoordinates coordinates;
  const auto axes = vtkFFDVolumeInput::GetCoordinates(given);
  std::transform(axes.begin(), axes.end(), coordinates.begin(), FindSource<vtkDataArray>);
  ffd::StageTools tools;
  this->Order.Begin();
  this->Image.Update(
    tools, ffdparts::Grid::FromImage(given, extent), coordinates, shown, sources, ghosts);
  this->Lattice.Update(tools, FindSource(given->GetFieldData()));
  // Where one of several processes renders it.
  vtkFieldData* fields = this->GetImage()->GetFieldData();
  if (vtkDataArray* pieces = given->GetFieldData()->GetArray(vtkFFDVolumeInput::PiecesName))
  {
    fields->AddArray(pieces);
  }
  else
  {
    fields->RemoveArray(vtkFFDVolumeInput::PiecesName);
  }
}
