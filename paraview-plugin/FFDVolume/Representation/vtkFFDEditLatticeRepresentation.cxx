// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDEditLatticeRepresentation.h"

#include "vtkFFDCameraPlace.h"

#include "vtkFFDEditLattice.h"
#include "vtkFFDLattice.h"
#include "vtkFFDOptions.h"

#include "vtkCamera.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkMath.h"
#include "vtkObjectFactory.h"
#include "vtkProcessModule.h"
#include "vtkRenderer.h"

#include <algorithm>
#include <cmath>
#include <utility>

vtkStandardNewMacro(vtkFFDEditLatticeRepresentation);

namespace
{

std::vector<double> GetValues(vtkFFDLattice* lattice)
{
  vtkDoubleArray* array = lattice->GetDisplacements();
  return { array->GetPointer(0), array->GetPointer(0) + array->GetNumberOfValues() };
}

/// World units of a pixel where the box is farthest from the camera.
double FindLargestPixel(vtkRenderer* renderer, const double box[6])
{
  vtkCamera* camera = renderer->GetActiveCamera();
  const int* size = renderer->GetSize();
  if (camera->GetParallelProjection())
  {
    return 2.0 * camera->GetParallelScale() / std::max(1, size[1]);
  }
  const vtkFFDCameraPlace place(camera);
  const double* eye = place.Position;
  double depth = 0.0;
  for (int corner = 0; corner < 8; ++corner)
  {
    const double to[3] = { box[corner & 1] - eye[0], box[2 + ((corner >> 1) & 1)] - eye[1],
      box[4 + (corner >> 2)] - eye[2] };
    depth = std::max(depth, vtkMath::Dot(to, place.Direction));
  }
  return 2.0 * depth * std::tan(0.5 * vtkMath::RadiansFromDegrees(camera->GetViewAngle())) /
    std::max(1, size[camera->GetUseHorizontalViewAngle() ? 0 : 1]);
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDEditLatticeRepresentation::vtkFFDEditLatticeRepresentation()
{
  this->EditArray->SetNumberOfComponents(1);
  this->SelectionArray->SetNumberOfComponents(1);
  // Geometry that hides the lattice may be drawn by other processes.
  this->CullHiddenOff();
}

//------------------------------------------------------------------------------
vtkFFDEditLatticeRepresentation::~vtkFFDEditLatticeRepresentation() = default;

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const auto print = [&os](const int sizes[3]) {
    os << sizes[0] << ", " << sizes[1] << ", " << sizes[2] << "\n";
  };
  os << indent << "Dimensions: ";
  print(this->Dimensions);
  os << indent << "Domain: " << this->Domain[0] << ", " << this->Domain[1] << ", "
     << this->Domain[2] << ", " << this->Domain[3] << ", " << this->Domain[4] << ", "
     << this->Domain[5] << "\n";
  os << indent << "BaseDimensions: ";
  print(this->BaseDimensions);
  os << indent << "NumberOfBaseDisplacements: " << this->Base.size() / 3 << "\n";
  os << indent << "DisplacementScale: " << this->DisplacementScale << "\n";
  os << indent << "EditDimensions: ";
  print(this->EditDimensions);
  os << indent << "NumberOfDisplacements: " << this->Edits.size() / 3 << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::SetSizes(
  const char* name, int member[3], const int sizes[3], bool zeroAllowed)
{
  if (vtkFFDAreEditSizes(this, name, member, sizes, zeroAllowed) &&
    !std::equal(sizes, sizes + 3, member))
  {
    std::copy_n(sizes, 3, member);
    this->LatticeIsStale = true;
  }
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::SetVectors(
  const char* name, std::vector<double>& values, vtkDataArray* vectors)
{
  const vtkIdType count = vectors ? vectors->GetNumberOfTuples() : 0;
  if (count > vtkFFDLargestEditCount || (count > 0 && vectors->GetNumberOfComponents() != 3))
  {
    vtkErrorMacro(<< name << " has " << count << " tuples of " << vectors->GetNumberOfComponents()
                  << " components; give up to " << vtkFFDLargestEditCount << " of 3.");
    return;
  }
  std::vector<double> given(3 * static_cast<std::size_t>(count));
  for (vtkIdType i = 0; i < count; ++i)
  {
    vectors->GetTuple(i, &given[3 * static_cast<std::size_t>(i)]);
  }
  if (!std::all_of(given.begin(), given.end(), [](double v) { return std::isfinite(v); }))
  {
    vtkErrorMacro(<< name << " must be finite.");
    return;
  }
  if (given != values)
  {
    values = std::move(given);
    this->LatticeIsStale = true;
  }
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::SetDimensions(int nx, int ny, int nz)
{
  const int sizes[3] = { nx, ny, nz };
  this->SetSizes("Dimensions", this->Dimensions, sizes, false);
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::SetBaseDimensions(int nx, int ny, int nz)
{
  const int sizes[3] = { nx, ny, nz };
  this->SetSizes("BaseDimensions", this->BaseDimensions, sizes, false);
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::SetEditDimensions(int nx, int ny, int nz)
{
  const int sizes[3] = { nx, ny, nz };
  this->SetSizes("EditDimensions", this->EditDimensions, sizes, true);
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::SetDomain(
  double xmin, double xmax, double ymin, double ymax, double zmin, double zmax)
{
  const double domain[6] = { xmin, xmax, ymin, ymax, zmin, zmax };
  if (!(xmin < xmax && ymin < ymax && zmin < zmax) ||
    !std::all_of(domain, domain + 6, [](double v) { return std::isfinite(v); }))
  {
    vtkErrorMacro(<< "Domain is " << xmin << ", " << xmax << ", " << ymin << ", " << ymax << ", "
                  << zmin << ", " << zmax
                  << "; each minimum must be less than its maximum. It stays as it was.");
    return;
  }
  if (!std::equal(domain, domain + 6, this->Domain))
  {
    std::copy_n(domain, 6, this->Domain);
    this->LatticeIsStale = true;
  }
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::SetBaseDisplacements(vtkDataArray* displacements)
{
  this->SetVectors("BaseDisplacements", this->Base, displacements);
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::SetDisplacementScale(double scale)
{
  if (!std::isfinite(scale))
  {
    vtkErrorMacro(<< "DisplacementScale is " << scale << ", it must be finite.");
    return;
  }
  if (scale != this->DisplacementScale)
  {
    this->DisplacementScale = scale;
    this->LatticeIsStale = true;
  }
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::SetDisplacements(vtkDataArray* displacements)
{
  this->SetVectors("Displacements", this->Edits, displacements);
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::SetSelection(vtkDataArray* points)
{
  const vtkIdType count = points ? points->GetNumberOfTuples() : 0;
  this->Selected.resize(static_cast<std::size_t>(count));
  for (vtkIdType i = 0; i < count; ++i)
  {
    this->Selected[static_cast<std::size_t>(i)] = points->GetComponent(i, 0);
  }
  this->SelectionIsStale = true;
}

//------------------------------------------------------------------------------
vtkDoubleArray* vtkFFDEditLatticeRepresentation::GetSelection()
{
  vtkNew<vtkIdTypeArray> points;
  this->GetSelectedPoints(points);
  this->SelectionArray->SetNumberOfValues(points->GetNumberOfValues());
  for (vtkIdType n = 0; n < points->GetNumberOfValues(); ++n)
  {
    this->SelectionArray->SetValue(n, static_cast<double>(points->GetValue(n)));
  }
  return this->SelectionArray;
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::UpdateLattice()
{
  if (this->LatticeIsStale)
  {
    vtkFFDLattice* lattice = this->GetLattice();
    vtkNew<vtkFFDLattice> made;
    made->SetDomain(this->Domain);
    made->SetDimensions(this->Dimensions);
    made->SetDisplacementScale(this->DisplacementScale);
    vtkFFDEditLattice::AddEdits(this->Base, this->BaseDimensions, made);
    std::vector<double> base = GetValues(made);
    const int* sizes = this->EditDimensions;
    // Reported edits that come back, perhaps in the middle of a drag, are here already; adding them
    // again would only round differently.
    const bool ours = !this->LastReported.empty() && this->Edits == this->LastReported &&
      base == this->BaseHere && std::equal(sizes, sizes + 3, this->Dimensions) &&
      std::equal(sizes, sizes + 3, lattice->GetDimensions());
    if (ours)
    {
      this->LatticeIsStale = false;
      this->Composed = this->ReportedValues;
      if (!std::equal(this->Domain, this->Domain + 6, lattice->GetDomain()))
      {
        lattice->SetDomain(this->Domain);
      }
      lattice->SetDisplacementScale(this->DisplacementScale);
      this->Modified();
    }
    else if (!this->IsInteracting())
    {
      this->LatticeIsStale = false;
      this->BaseHere = std::move(base);
      vtkFFDEditLattice::AddEdits(this->Edits, this->EditDimensions, made);
      std::vector<double> sum = GetValues(made);
      if (GetValues(lattice) != sum)
      {
        // Edits that were made elsewhere (ParaView's undo) are none of the widget's own history.
        this->ClearHistory();
      }
      lattice->DeepCopy(made);
      this->Composed = std::move(sum);
      this->LastReported.clear();
      this->Modified();
    }
  }
  if (this->SelectionIsStale)
  {
    this->SelectionIsStale = false;
    const auto count = static_cast<double>(this->GetLattice()->GetNumberOfControlPoints());
    vtkNew<vtkIdTypeArray> points;
    for (const double point : this->Selected)
    {
      if (point >= 0.0 && point < count)
      {
        points->InsertNextValue(static_cast<vtkIdType>(point));
      }
    }
    vtkNew<vtkIdTypeArray> now;
    this->GetSelectedPoints(now);
    const vtkIdType* first = now->GetPointer(0);
    if (now->GetNumberOfValues() != points->GetNumberOfValues() ||
      !std::equal(first, first + now->GetNumberOfValues(), points->GetPointer(0)))
    {
      this->SetSelectedPoints(points);
    }
  }
}

//------------------------------------------------------------------------------
/// Whether the lattice is another than UpdateLattice() made.
bool vtkFFDEditLatticeRepresentation::IsEdited()
{
  this->UpdateLattice();
  vtkDoubleArray* array = this->GetLattice()->GetDisplacements();
  return !std::equal(this->Composed.begin(), this->Composed.end(), array->GetPointer(0),
    array->GetPointer(0) + array->GetNumberOfValues());
}

//------------------------------------------------------------------------------
vtkDoubleArray* vtkFFDEditLatticeRepresentation::GetEdits()
{
  if (!this->IsEdited())
  {
    this->EditArray->SetNumberOfValues(static_cast<vtkIdType>(this->Edits.size()));
    std::copy(this->Edits.begin(), this->Edits.end(), this->EditArray->GetPointer(0));
    return this->EditArray;
  }
  std::vector<double> edits = GetValues(this->GetLattice());
  bool any = false;
  for (std::size_t n = 0; n < edits.size() && n < this->BaseHere.size(); ++n)
  {
    edits[n] -= this->BaseHere[n];
    any = any || edits[n] != 0.0;
  }
  if (!any)
  {
    edits.clear();
  }
  this->EditArray->SetNumberOfValues(static_cast<vtkIdType>(edits.size()));
  std::copy(edits.begin(), edits.end(), this->EditArray->GetPointer(0));
  this->LastReported = edits;
  this->ReportedValues = GetValues(this->GetLattice());
  return this->EditArray;
}

//------------------------------------------------------------------------------
int* vtkFFDEditLatticeRepresentation::GetEditDimensions()
{
  return this->IsEdited() ? this->GetLattice()->GetDimensions() : this->EditDimensions;
}

//------------------------------------------------------------------------------
int vtkFFDEditLatticeRepresentation::ResetEdits()
{
  this->UpdateLattice();
  vtkFFDLattice* lattice = this->GetLattice();
  const std::vector<double> now = GetValues(lattice);
  if (this->IsInteracting() || now == this->BaseHere || now.size() != this->BaseHere.size())
  {
    return 0;
  }
  this->ClearHistory();
  std::copy(
    this->BaseHere.begin(), this->BaseHere.end(), lattice->GetDisplacements()->GetPointer(0));
  lattice->Modified();
  this->Modified();
  return 1;
}

//------------------------------------------------------------------------------
void vtkFFDEditLatticeRepresentation::BuildRepresentation()
{
  this->UpdateLattice();
  this->Superclass::BuildRepresentation();
}

//------------------------------------------------------------------------------
double* vtkFFDEditLatticeRepresentation::GetBounds()
{
  double* bounds = this->Superclass::GetBounds();
  const int process = vtkProcessModule::GetProcessType();
  if ((process != vtkProcessModule::PROCESS_SERVER &&
        process != vtkProcessModule::PROCESS_RENDER_SERVER) ||
    !this->GetRenderer() || !vtkMath::AreBoundsInitialized(bounds))
  {
    return bounds;
  }
  // An arrow is a little longer than its shaft.
  const double pixels = 1.5 * this->GetTransformHandleSize() + this->GetHandleSize();
  const double room = pixels * FindLargestPixel(this->GetRenderer(), bounds);
  for (int i = 0; i < 6; ++i)
  {
    this->BoundsWithHandles[i] = bounds[i] + (i % 2 == 0 ? -room : room);
  }
  return this->BoundsWithHandles;
}
