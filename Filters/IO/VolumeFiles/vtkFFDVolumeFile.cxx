// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumeFile.h"

#include "FFDSingularMatrix.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <glm/geometric.hpp>

#include <vtksys/SystemTools.hxx>

#include <cmath>
#include <sstream>

namespace
{

template <class From, class To>
void Rescale(const From* from, To* to, vtkIdType count, const vtkFFDVolumeFile::Scaling& scaling)
{
  vtkSMPTools::For(0, count, [from, to, scaling](vtkIdType first, vtkIdType last) {
    for (vtkIdType i = first; i < last; ++i)
    {
      to[i] = static_cast<To>(scaling.Slope * static_cast<double>(from[i]) + scaling.Intercept);
    }
  });
}

} // namespace

//------------------------------------------------------------------------------
bool vtkFFDVolumeFile::Placement::IsValid() const
{
  glm::dmat3 directions = this->Steps;
  for (int a = 0; a < 3; ++a)
  {
    directions[a] /= glm::length(directions[a]);
  }
  return !ffd::IsSingular(directions) && std::isfinite(glm::length(this->Origin));
}

//------------------------------------------------------------------------------
void vtkFFDVolumeFile::Scaling::Apply(vtkPointData* data) const
{
  vtkDataArray* const stored = data->GetScalars();
  const auto meant = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(this->Type));
  meant->SetNumberOfComponents(stored->GetNumberOfComponents());
  meant->SetNumberOfTuples(stored->GetNumberOfTuples());
  const std::string name = stored->GetName() ? stored->GetName() : "";
  const vtkIdType count = stored->GetNumberOfValues();
  void* const to = meant->GetVoidPointer(0);
  switch (stored->GetDataType())
  {
    vtkTemplateMacro(this->Type == VTK_FLOAT
        ? Rescale(static_cast<const VTK_TT*>(stored->GetVoidPointer(0)), static_cast<float*>(to),
            count, *this)
        : Rescale(static_cast<const VTK_TT*>(stored->GetVoidPointer(0)), static_cast<double*>(to),
            count, *this));
    default:
      return;
  }
  meant->SetName(name.c_str());
  data->SetScalars(meant);
}

//------------------------------------------------------------------------------
vtkFFDVolumeFile::vtkFFDVolumeFile(
  const std::string& path, vtkAlgorithm* reader, vtkCommand* errors)
  : Path(path)
  , Reader(reader)
  , Errors(errors)
{
  this->Watch(reader);
}

//------------------------------------------------------------------------------
void vtkFFDVolumeFile::Watch(vtkAlgorithm* reader) const
{
  reader->AddObserver(vtkCommand::ErrorEvent, this->Errors);
  reader->AddObserver(vtkCommand::WarningEvent, this->Errors);
}

//------------------------------------------------------------------------------
std::string vtkFFDVolumeFile::FindEnding(const std::string& path)
{
  using vtksys::SystemTools;
  return SystemTools::LowerCase(SystemTools::GetFilenameLastExtension(path));
}

//------------------------------------------------------------------------------
std::string vtkFFDVolumeFile::ReadHeader(Header& header) const
{
  vtkInformation* const info = this->Reader->GetOutputInformation(0);
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  if (info->Has(vtkDataObject::SPACING()))
  {
    info->Get(vtkDataObject::SPACING(), &header.Spacing.x);
  }
  for (std::size_t a = 0; a < 3; ++a)
  {
    header.Size[a] = extent[2 * a + 1] - extent[2 * a] + 1;
  }
  const std::string problem = this->FindVoxels(header);
  if (!problem.empty())
  {
    return problem;
  }
  const std::array<int, 3>& size = header.Size;
  if (size[0] < 2 || size[1] < 2 || size[2] < 2)
  {
    std::ostringstream text;
    text << "it is " << size[0] << " x " << size[1] << " x " << size[2]
         << " voxels; a volume has at least two along each axis";
    return text.str();
  }
  return this->FindPlacement(header);
}

//------------------------------------------------------------------------------
std::string vtkFFDVolumeFile::Explain(const std::string& error) const
{
  return "it cannot be read: " + error;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> vtkFFDVolumeFile::Read(const Header& header, std::string& error) const
{
  if (header.Stored.Form != vtkFFDStoredVoxels::OF_VTK)
  {
    return header.Stored.ReadImage(vtkImageReader2::SafeDownCast(this->Reader), error);
  }
  this->Reader->Update();
  return vtkImageData::SafeDownCast(this->Reader->GetOutputDataObject(0));
}

//------------------------------------------------------------------------------
double vtkFFDVolumeFile::CountBytes(const Header& header) const
{
  auto* const reader = vtkImageReader2::SafeDownCast(this->Reader);
  const int components = header.Stored.GetComponents(reader);
  const int size = vtkDataArray::GetDataTypeSize(header.Stored.GetType(reader));
  return 1.0 * header.Size[0] * header.Size[1] * header.Size[2] * components * size;
}
