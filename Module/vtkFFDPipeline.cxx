// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDPipeline.h"

#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <limits>

using Pipeline = vtkStreamingDemandDrivenPipeline;

namespace
{

/// Make `extent`, the whole one, that of a part: of the image if there is one, else of the first
/// voxels.
void TakePart(vtkImageData* image, int extent[6])
{
  int part[6];
  const bool isThere = image && image->GetNumberOfPoints() > 0;
  for (int a = 0; a < 3; ++a)
  {
    part[2 * a] = isThere ? image->GetExtent()[2 * a] : extent[2 * a];
    part[2 * a + 1] =
      isThere ? image->GetExtent()[2 * a + 1] : std::min(extent[2 * a] + 1, extent[2 * a + 1]);
    if (part[2 * a] < extent[2 * a] || part[2 * a + 1] > extent[2 * a + 1])
    {
      TakePart(nullptr, extent); // the image has another extent now
      return;
    }
  }
  std::copy_n(part, 6, extent);
}

void Update(vtkAlgorithmOutput* connection, vtkInformation* output, bool whole)
{
  vtkAlgorithm* const producer = connection->GetProducer();
  const int port = connection->GetIndex();
  producer->UpdateInformation();
  vtkInformation* const input = producer->GetOutputInformation(port);
  vtkFFDRequestWhole(input);
  if (!whole && input->Has(Pipeline::WHOLE_EXTENT()))
  {
    TakePart(vtkImageData::GetData(input), input->Get(Pipeline::UPDATE_EXTENT()));
  }
  if (output && output->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    input->Set(Pipeline::UPDATE_TIME_STEP(), output->Get(Pipeline::UPDATE_TIME_STEP()));
  }
  producer->Update(port);
}

} // namespace

//------------------------------------------------------------------------------
void vtkFFDRequestWhole(vtkInformation* input)
{
  if (!input)
  {
    return;
  }
  if (input->Has(Pipeline::WHOLE_EXTENT()))
  {
    input->Set(Pipeline::UPDATE_EXTENT(), input->Get(Pipeline::WHOLE_EXTENT()), 6);
  }
  input->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
  input->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  input->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
}

//------------------------------------------------------------------------------
void vtkFFDUpdateWhole(vtkAlgorithmOutput* connection, vtkInformation* output)
{
  Update(connection, output, true);
}

//------------------------------------------------------------------------------
void vtkFFDUpdatePart(vtkAlgorithmOutput* connection, vtkInformation* output)
{
  Update(connection, output, false);
}

//------------------------------------------------------------------------------
void vtkFFDGetWholeGeometry(vtkInformation* input, vtkImageData* image, vtkImageData* geometry)
{
  const bool isThere = image && image->GetNumberOfPoints() > 0;
  if (isThere)
  {
    geometry->CopyStructure(image);
  }
  if (input->Has(Pipeline::WHOLE_EXTENT()))
  {
    geometry->SetExtent(input->Get(Pipeline::WHOLE_EXTENT()));
  }
  if (!isThere)
  {
    // It takes what is there of origin, spacing and direction.
    geometry->CopyInformationFromPipeline(input);
  }
}

//------------------------------------------------------------------------------
bool vtkFFDIsBlock(vtkCompositeDataSet* blocks, vtkDataObject* data)
{
  if (!blocks || !data)
  {
    return false;
  }
  const auto iterator = vtk::TakeSmartPointer(blocks->NewIterator());
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    if (iterator->GetCurrentDataObject() == data)
    {
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
bool vtkFFDIsPointArray(vtkInformation* chosen, vtkDataSet* data, vtkDataArray* found,
  int association, std::string& message)
{
  if (found)
  {
    message = std::string("The array to process, \"") +
      (found->GetName() ? found->GetName() : "(unnamed)") +
      "\", is no point data. Convert it with vtkCellDataToPointData.";
    return association == vtkDataObject::FIELD_ASSOCIATION_POINTS;
  }
  const char* const name = chosen ? chosen->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  if (!name || !*name || data->GetPointData()->HasArray(name))
  {
    return true;
  }
  message = std::string("The input has no point array \"") + name +
    "\", which SetInputArrayToProcess() names" +
    (data->GetCellData()->HasArray(name)
        ? "; its cells have: convert it with vtkCellDataToPointData."
        : ". Choose one of its arrays.");
  return false;
}

//------------------------------------------------------------------------------
void vtkFFDFollowTime(vtkInformation* input, vtkInformation* output)
{
  if (input && (input->Has(Pipeline::TIME_STEPS()) || input->Has(Pipeline::TIME_RANGE())))
  {
    output->Set(Pipeline::TIME_DEPENDENT_INFORMATION(), 1);
  }
}

//------------------------------------------------------------------------------
int vtkFFDRequestInformationAgain(
  vtkInformationVector* outputs, const std::function<int()>& requestInformation)
{
  vtkInformation* const output = outputs->GetInformationObject(0);
  const bool all = output->Has(Pipeline::WHOLE_EXTENT()) &&
    output->Has(Pipeline::UPDATE_EXTENT()) &&
    std::equal(output->Get(Pipeline::WHOLE_EXTENT()), output->Get(Pipeline::WHOLE_EXTENT()) + 6,
      output->Get(Pipeline::UPDATE_EXTENT()));
  const int result = requestInformation();
  if (all && output->Has(Pipeline::WHOLE_EXTENT()))
  {
    output->Set(Pipeline::UPDATE_EXTENT(), output->Get(Pipeline::WHOLE_EXTENT()), 6);
  }
  return result;
}

//------------------------------------------------------------------------------
void vtkFFDMergeTimes(
  std::vector<double> steps, std::initializer_list<vtkInformation*> inputs, vtkInformation* output)
{
  double range[2] = { std::numeric_limits<double>::infinity(),
    -std::numeric_limits<double>::infinity() };
  const auto include = [&range](double time) {
    range[0] = std::min(range[0], time);
    range[1] = std::max(range[1], time);
  };
  for (vtkInformation* input : inputs)
  {
    if (input && input->Has(Pipeline::TIME_STEPS()))
    {
      const double* const own = input->Get(Pipeline::TIME_STEPS());
      steps.insert(steps.end(), own, own + input->Length(Pipeline::TIME_STEPS()));
    }
    if (input && input->Has(Pipeline::TIME_RANGE()))
    {
      const double* const own = input->Get(Pipeline::TIME_RANGE());
      include(own[0]);
      include(own[1]);
    }
  }
  if (!steps.empty())
  {
    std::sort(steps.begin(), steps.end());
    steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
    include(steps.front());
    include(steps.back());
    output->Set(Pipeline::TIME_STEPS(), steps.data(), static_cast<int>(steps.size()));
  }
  if (range[0] <= range[1])
  {
    output->Set(Pipeline::TIME_RANGE(), range, 2);
  }
}
