// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDShownLattice.h"

#include "vtkFFDDeformGeometry.h"
#include "vtkFFDLatticeData.h"
#include "vtkFFDVolumeParts.h"

#include "FFDLattice.h"

#include "vtkAbstractArray.h"
#include "vtkAbstractTransform.h"
#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <string>
#include <vector>

namespace
{

/// Whether an array was not asked for before. Blocks take turns.
bool IsNewArray(vtkAbstractArray* array)
{
  static std::vector<vtkWeakPointer<vtkAbstractArray>> known;
  known.erase(std::remove(known.begin(), known.end(), nullptr), known.end());
  if (std::find(known.begin(), known.end(), array) != known.end())
  {
    return false;
  }
  known.emplace_back(array);
  return true;
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDShownLattice::vtkFFDShownLattice(vtkDataObject* data)
{
  if (!data || !vtkFFDLattice::HasLattice(data))
  {
    return;
  }
  this->Mode = vtkFFDEditLattice::GetGeometryModeOf(data);
  vtkNew<vtkFFDLattice> lattice;
  if (this->Mode != vtkFFDEditLattice::AT_REST && Read(data, lattice))
  {
    this->Lattice = lattice;
  }
}

//------------------------------------------------------------------------------
vtkFFDShownLattice vtkFFDShownLattice::FindAnywhere(vtkDataObject* data)
{
  vtkFFDShownLattice shown(data);
  if (auto* parts = vtkCompositeDataSet::SafeDownCast(data))
  {
    vtkSmartPointer<vtkCompositeDataIterator> iterator;
    iterator.TakeReference(parts->NewIterator());
    for (iterator->InitTraversal(); !shown.Lattice && !iterator->IsDoneWithTraversal();
         iterator->GoToNextItem())
    {
      shown = vtkFFDShownLattice(iterator->GetCurrentDataObject());
    }
  }
  return shown;
}

//------------------------------------------------------------------------------
bool vtkFFDShownLattice::Read(vtkDataObject* data, vtkFFDLattice* lattice)
{
  // The lattice itself speaks of classes and functions.
  vtkNew<vtkCallbackCommand> nothing;
  const unsigned long tag = lattice->AddObserver(vtkCommand::ErrorEvent, nothing);
  const bool isRead = lattice->ReadFrom(data) != 0;
  lattice->RemoveObserver(tag);
  vtkAbstractArray* const array =
    isRead ? nullptr : data->GetFieldData()->GetAbstractArray("FFDLattice.Displacement");
  if (array && IsNewArray(array))
  {
    ffd::Lattice value;
    bool isComplete = false;
    const std::string problem = vtkFFDReadLattice(data, value, &isComplete);
    // Files may drop arrays, or tuples of them.
    const std::string text = isComplete
      ? "The lattice of the data cannot be used, and they are shown at rest: " + problem + "."
      : "The lattice of the data is not complete, and they are shown at rest. Formats of VTK keep "
        "a lattice (.vti, .vtu, .vtp, .vtm, .pvd, .vtk, ...), Exodus and Xdmf do not: if the data "
        "are from such a file, save it anew in one of VTK's.";
    vtkErrorWithObjectMacro(data, << text);
  }
  return isRead;
}

//------------------------------------------------------------------------------
vtkDataObject* vtkFFDShownLattice::FindCarrier(vtkDataObject* data)
{
  vtkDataObject* carrier = data && vtkFFDLattice::HasLattice(data) ? data : nullptr;
  if (auto* parts = vtkCompositeDataSet::SafeDownCast(data))
  {
    vtkDataObject* first = nullptr;
    vtkFFDShownLattice shown(nullptr);
    bool any = false;
    bool same = true;
    vtkSmartPointer<vtkCompositeDataIterator> iterator;
    iterator.TakeReference(parts->NewIterator());
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
    {
      vtkDataObject* const leaf = iterator->GetCurrentDataObject();
      const vtkFFDShownLattice own(leaf);
      any = any || vtkFFDLattice::HasLattice(leaf);
      shown = first ? shown : own;
      first = first ? first : leaf;
      same = same && own.Lattice && own.IsLike(shown);
    }
    if (any)
    {
      carrier = same ? first : nullptr;
    }
  }
  return carrier;
}

//------------------------------------------------------------------------------
bool vtkFFDShownLattice::IsLike(const vtkFFDShownLattice& other) const
{
  if (!this->Lattice || !other.Lattice)
  {
    return !this->Lattice && !other.Lattice;
  }
  return this->Mode == other.Mode && ffdparts::AreEqual(this->Lattice, other.Lattice);
}

//------------------------------------------------------------------------------
void vtkFFDShownLattice::Move(vtkPointSet* rest, vtkPointSet* moved) const
{
  vtkNew<vtkFFDDeformGeometry> deform;
  deform->SetInputData(rest);
  deform->SetDeformation(this->Lattice);
  deform->SetInverseMode(this->Mode);
  deform->Update();
  moved->ShallowCopy(deform->GetOutput());
}

//------------------------------------------------------------------------------
void vtkFFDShownLattice::PullBack(const double shown[3], double rest[3]) const
{
  switch (this->Mode)
  {
    case vtkFFDEditLattice::FIRST_ORDER:
    {
      double moved[3];
      this->Lattice->TransformPoint(shown, moved);
      for (int a = 0; a < 3; ++a)
      {
        rest[a] = 2.0 * shown[a] - moved[a];
      }
      return;
    }
    case vtkFFDEditLattice::PULL_BACK:
      this->Lattice->TransformPoint(shown, rest);
      return;
    default:
      this->Lattice->GetInverse()->TransformPoint(shown, rest);
      return;
  }
}
