// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDeformVolume.h"

#include "vtkFFDLattice.h"

#include "vtkAlgorithmOutput.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>

vtkStandardNewMacro(vtkFFDDeformVolume);

//------------------------------------------------------------------------------
vtkFFDDeformVolume::vtkFFDDeformVolume()
{
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
vtkFFDDeformVolume::~vtkFFDDeformVolume() = default;

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Lattice: ";
  if (this->Lattice)
  {
    os << "\n";
    this->Lattice->PrintSelf(os, indent.GetNextIndent());
  }
  else
  {
    os << "(none)\n";
  }
}

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::SetLattice(vtkFFDLattice* lattice)
{
  if (this->Lattice != lattice)
  {
    this->Lattice = lattice;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDDeformVolume::GetLattice()
{
  return this->Lattice;
}

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::SetLatticeConnection(vtkAlgorithmOutput* connection)
{
  this->SetInputConnection(1, connection);
}

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::SetLatticeData(vtkImageData* image)
{
  this->SetInputDataInternal(1, image);
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDDeformVolume::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->Lattice ? std::max(own, this->Lattice->GetMTime()) : own;
}

//------------------------------------------------------------------------------
int vtkFFDDeformVolume::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return this->Superclass::FillInputPortInformation(port, info);
}

//------------------------------------------------------------------------------
int vtkFFDDeformVolume::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  // The volume's extent, which the default asks of every input, means nothing to the lattice.
  vtkInformation* info = inputs[1]->GetInformationObject(0);
  if (info && info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(),
      info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()), 6);
  }
  return this->Superclass::RequestUpdateExtent(request, inputs, outputs);
}

//------------------------------------------------------------------------------
int vtkFFDDeformVolume::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkImageData* input = vtkImageData::GetData(inputs[0]);
  vtkImageData* output = vtkImageData::GetData(outputs);
  if (!input || !output)
  {
    vtkErrorMacro("There is no image to deform. Connect a vtkImageData to the first input.");
    return 0;
  }
  output->ShallowCopy(input);
  // Field data of our own, so that the lattice is not attached to the input, too.
  vtkNew<vtkFieldData> fields;
  if (input->GetFieldData())
  {
    fields->PassData(input->GetFieldData());
  }
  output->SetFieldData(fields);

  vtkImageData* points = vtkImageData::GetData(inputs[1]);
  if (this->Lattice)
  {
    return this->Lattice->AttachTo(output);
  }
  if (points)
  {
    // An unusable image is reported by the lattice; what was attached stays.
    vtkNew<vtkFFDLattice> lattice;
    return lattice->FromImageData(points) ? lattice->AttachTo(output) : 1;
  }
  if (!vtkFFDLattice::HasLattice(output))
  {
    vtkErrorMacro("There is no lattice to attach, the image passes through undeformed. Call "
                  "SetLattice() or connect an image of control points to the second input.");
  }
  return 1;
}
