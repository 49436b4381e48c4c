// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDSurfacePicker.h"

#include "vtkFFDShownPlaces.h"

#include "vtkAlgorithm.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkFFDSurfacePicker);

//------------------------------------------------------------------------------
vtkFFDSurfacePicker::vtkFFDSurfacePicker() = default;

//------------------------------------------------------------------------------
vtkFFDSurfacePicker::~vtkFFDSurfacePicker() = default;

//------------------------------------------------------------------------------
void vtkFFDSurfacePicker::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "PointA: " << this->PointA[0] << ", " << this->PointA[1] << ", "
     << this->PointA[2] << "\n";
  os << indent << "PointB: " << this->PointB[0] << ", " << this->PointB[1] << ", "
     << this->PointB[2] << "\n";
  os << indent << "ArrayName: " << this->ArrayName << "\n";
  os << indent << "OfCells: " << this->OfCells << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDSurfacePicker::SetInput(vtkAlgorithm* input) { this->Input = input; }

//------------------------------------------------------------------------------
void vtkFFDSurfacePicker::SetSelection(vtkAlgorithm* selection) { this->Selection = selection; }

//------------------------------------------------------------------------------
void vtkFFDSurfacePicker::SetArrayName(const char* name) { this->ArrayName = name ? name : ""; }

//------------------------------------------------------------------------------
void vtkFFDSurfacePicker::Pick()
{
  this->Picked = ffdplaces::PickSurface(
    this->Input, this->Selection, this->PointA, this->PointB, this->ArrayName, this->OfCells);
}

//------------------------------------------------------------------------------
double* vtkFFDSurfacePicker::GetPicked() { return this->Picked.data(); }
