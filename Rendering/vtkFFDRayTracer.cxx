// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDRayTracer.h"

#include "vtkFFDFrameStages.h"
#include "vtkFFDGuard.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDSceneState.h"

#include "vtkDemandDrivenPipeline.h"
#include "vtkGarbageCollector.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkRenderer.h"
#include "vtkTimeStamp.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <utility>

vtkStandardNewMacro(vtkFFDRayTracer);
vtkFFDGuardedProcessRequestMacro(vtkFFDRayTracer);

namespace
{

constexpr int LargestImageSide = 16384;

} // namespace

//------------------------------------------------------------------------------
class vtkFFDRayTracer::vtkInternals
{
public:
  vtkFFDSceneState View; // that of the renderer when GetMTime() was called last
  vtkTimeStamp ViewTime; // when that was another one than before
};

//------------------------------------------------------------------------------
vtkFFDRayTracer::vtkFFDRayTracer()
  : Internals(new vtkInternals)
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(3);
  this->Pixels->SetNumberOfComponents(2);
}

//------------------------------------------------------------------------------
vtkFFDRayTracer::~vtkFFDRayTracer()
{
  this->SetRenderer(nullptr);
  this->SetVolume(nullptr);
}

//------------------------------------------------------------------------------
vtkCxxSetObjectMacro(vtkFFDRayTracer, Renderer, vtkRenderer);
vtkCxxSetObjectMacro(vtkFFDRayTracer, Volume, vtkVolume);

//------------------------------------------------------------------------------
vtkRenderer* vtkFFDRayTracer::GetRenderer() { return this->Renderer; }

//------------------------------------------------------------------------------
vtkVolume* vtkFFDRayTracer::GetVolume() { return this->Volume; }

//------------------------------------------------------------------------------
void vtkFFDRayTracer::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Renderer: " << this->Renderer << "\n";
  os << indent << "Volume: " << this->Volume << "\n";
  os << indent << "ImageSize: (" << this->ImageSize[0] << ", " << this->ImageSize[1] << ")\n";
  os << indent << "NumberOfPixels: " << this->GetNumberOfPixels() << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDRayTracer::SetImageSize(const int size[2])
{
  if (!size)
  {
    vtkErrorMacro("SetImageSize: the size is null. Give width and height.");
    return;
  }
  this->SetImageSize(size[0], size[1]);
}

//------------------------------------------------------------------------------
void vtkFFDRayTracer::SetImageSize(int width, int height)
{
  if (width < 1 || height < 1 || width > LargestImageSide || height > LargestImageSide)
  {
    vtkErrorMacro("SetImageSize: " << width << " x " << height
                                   << " is not possible. Each side must "
                                   << "be from 1 to " << LargestImageSide << ".");
    return;
  }
  if (this->ImageSize[0] != width || this->ImageSize[1] != height)
  {
    this->ImageSize[0] = width;
    this->ImageSize[1] = height;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDRayTracer::AddPixel(int x, int y)
{
  this->Pixels->InsertNextValue(x);
  this->Pixels->InsertNextValue(y);
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDRayTracer::AddPixelGrid(int columns, int rows)
{
  if (columns < 1 || rows < 1 || columns > this->ImageSize[0] || rows > this->ImageSize[1])
  {
    vtkErrorMacro("AddPixelGrid: " << columns << " x " << rows << " rays do not fit an image of "
                                   << this->ImageSize[0] << " x " << this->ImageSize[1]
                                   << " pixels.");
    return;
  }
  for (int j = 0; j < rows; ++j)
  {
    for (int i = 0; i < columns; ++i)
    {
      this->AddPixel((2 * i + 1) * this->ImageSize[0] / (2 * columns),
        (2 * j + 1) * this->ImageSize[1] / (2 * rows));
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDRayTracer::RemoveAllPixels()
{
  if (this->Pixels->GetNumberOfValues() > 0)
  {
    this->Pixels->Reset();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkIdType vtkFFDRayTracer::GetNumberOfPixels() { return this->Pixels->GetNumberOfTuples(); }

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDRayTracer::GetMTime()
{
  vtkMTimeType time = this->Superclass::GetMTime();
  vtkFFDSceneState view;
  if (this->Renderer)
  {
    vtkFFDAddView(this->Renderer, view);
  }
  if (view != this->Internals->View)
  {
    this->Internals->View = std::move(view);
    this->Internals->ViewTime.Modified();
  }
  time = std::max(time, this->Internals->ViewTime.GetMTime());
  if (this->Volume)
  {
    time = std::max<vtkMTimeType>(
      { time, this->Volume->GetMTime(), ffd::FindSource(this->Volume->GetProperty()).Time });
    if (vtkAbstractVolumeMapper* const mapper = this->Volume->GetMapper())
    {
      time = std::max(time, mapper->GetMTime());
      if (mapper->GetNumberOfInputConnections(0) > 0)
      {
        // What leads to the volume, whether or not it has been updated.
        vtkDemandDrivenPipeline* const pipeline =
          vtkDemandDrivenPipeline::SafeDownCast(mapper->GetInputExecutive(0, 0));
        if (pipeline)
        {
          pipeline->UpdatePipelineMTime();
          time = std::max(time, pipeline->GetPipelineMTime());
        }
      }
    }
  }
  return time;
}

//------------------------------------------------------------------------------
void vtkFFDRayTracer::ReportReferences(vtkGarbageCollector* collector)
{
  this->Superclass::ReportReferences(collector);
  vtkGarbageCollectorReport(collector, this->Renderer, "Renderer");
  vtkGarbageCollectorReport(collector, this->Volume, "Volume");
}

//------------------------------------------------------------------------------
int vtkFFDRayTracer::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkFFDInverseRayVolumeMapper* mapper =
    this->Volume ? vtkFFDInverseRayVolumeMapper::SafeDownCast(this->Volume->GetMapper()) : nullptr;
  if (!this->Renderer || !mapper)
  {
    vtkErrorMacro(<< (this->Renderer
                      ? "There is no volume with a vtkFFDInverseRayVolumeMapper. Call SetVolume()."
                      : "There is no renderer to look from. Call SetRenderer()."));
    return 0;
  }
  return mapper->TraceRays(this->Renderer, this->Volume, this->ImageSize[0], this->ImageSize[1],
    this->Pixels, vtkPolyData::GetData(outputs, 0), vtkPolyData::GetData(outputs, 1),
    vtkPolyData::GetData(outputs, 2));
}
