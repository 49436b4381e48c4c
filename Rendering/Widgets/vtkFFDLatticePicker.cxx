// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLatticePicker.h"

#include "vtkAssemblyPath.h"
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkProp.h"
#include "vtkRenderer.h"

#include <utility>

vtkStandardNewMacro(vtkFFDLatticePicker);

//------------------------------------------------------------------------------
void vtkFFDLatticePicker::SetOwner(vtkProp* owner, Search search)
{
  this->Owner = owner;
  this->Find = std::move(search);
}

//------------------------------------------------------------------------------
int vtkFFDLatticePicker::Pick(double x, double y, double z, vtkRenderer* renderer)
{
  this->Initialize();
  this->Renderer = renderer;
  this->SelectionPoint[0] = x;
  this->SelectionPoint[1] = y;
  this->SelectionPoint[2] = z;
  this->InvokeEvent(vtkCommand::StartPickEvent, nullptr);
  double world[3];
  const bool found = this->Owner && this->Owner->GetVisibility() && this->Owner->GetPickable() &&
    this->Find && this->Find(x, y, world);
  if (found)
  {
    for (int a = 0; a < 3; ++a)
    {
      this->PickPosition[a] = world[a];
    }
    vtkNew<vtkAssemblyPath> path;
    path->AddNode(this->Owner, this->Owner->GetMatrix());
    this->SetPath(path);
    this->InvokeEvent(vtkCommand::PickEvent, nullptr);
  }
  this->InvokeEvent(vtkCommand::EndPickEvent, nullptr);
  return found ? 1 : 0;
}

//------------------------------------------------------------------------------
int vtkFFDLatticePicker::Pick3DPoint(double point[3], vtkRenderer* renderer)
{
  if (!renderer)
  {
    return 0;
  }
  renderer->SetWorldPoint(point[0], point[1], point[2], 1.0);
  renderer->WorldToDisplay();
  const double* display = renderer->GetDisplayPoint();
  return this->Pick(display[0], display[1], 0.0, renderer);
}
