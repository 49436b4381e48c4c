// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDShownLattice.h"

#include "vtkFFDDeformGeometry.h"
#include "vtkFFDVolumeParts.h"

#include "vtkAbstractTransform.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObject.h"
#include "vtkNew.h"
#include "vtkPointSet.h"

//------------------------------------------------------------------------------
vtkFFDShownLattice::vtkFFDShownLattice(vtkDataObject* data)
{
  if (!data || !vtkFFDLattice::HasLattice(data))
  {
    return;
  }
  this->Mode = vtkFFDEditLattice::GetGeometryModeOf(data);
  vtkNew<vtkFFDLattice> lattice;
  if (this->Mode != vtkFFDEditLattice::AT_REST && lattice->ReadFrom(data))
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
