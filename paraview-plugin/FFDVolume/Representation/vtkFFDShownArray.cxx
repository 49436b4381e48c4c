// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDShownArray.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"

//------------------------------------------------------------------------------
vtkFFDShownArray vtkFFDShownArray::FromInformation(vtkInformation* information)
{
  vtkFFDShownArray shown;
  if (information && information->Has(vtkDataObject::FIELD_NAME()) &&
    information->Get(vtkDataObject::FIELD_NAME()))
  {
    shown.Name = information->Get(vtkDataObject::FIELD_NAME());
  }
  shown.OfCells = information && information->Has(vtkDataObject::FIELD_ASSOCIATION()) &&
    information->Get(vtkDataObject::FIELD_ASSOCIATION()) == vtkDataObject::FIELD_ASSOCIATION_CELLS;
  return shown;
}

//------------------------------------------------------------------------------
vtkDataArray* vtkFFDShownArray::FindIn(vtkImageData* image) const
{
  vtkFieldData* arrays = image->GetPointData();
  if (this->OfCells)
  {
    arrays = image->GetCellData();
  }
  return arrays->GetArray(this->Name.c_str());
}
