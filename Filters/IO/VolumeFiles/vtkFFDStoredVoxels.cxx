// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDStoredVoxels.h"

#include "vtkFFDFileAccess.h"

#include "vtkByteSwap.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <fstream>
#include <locale>
#include <new>
#include <string>

namespace
{

/// As VTK's macro for it, which is one for the preprocessor.
bool IsBigEndianMachine()
{
  const unsigned short one = 1;
  return *reinterpret_cast<const unsigned char*>(&one) == 0;
}

/// Whether it is no part of a number; the end of the file is none.
bool IsBetweenNumbers(int character)
{
  return character == ',' || character == ' ' || (character >= '\t' && character <= '\r');
}

std::string ReadBytes(const vtkFFDStoredVoxels& voxels, vtkDataArray* numbers)
{
  const auto count = static_cast<std::size_t>(numbers->GetNumberOfValues());
  const auto size = static_cast<std::size_t>(numbers->GetDataTypeSize());
  std::size_t found = 0;
  std::string problem;
  char* const bytes = static_cast<char*>(numbers->GetVoidPointer(0));
  if (voxels.Form == vtkFFDStoredVoxels::PACKED)
  {
    if (!vtkFFDFileAccess::ReadCompressedInto(
          voxels.Path, voxels.Offset, bytes, count * size, found, problem))
    {
      return problem;
    }
  }
  else
  {
    std::ifstream file(voxels.Path, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(voxels.Offset));
    file.read(bytes, static_cast<std::streamsize>(count * size));
    found = static_cast<std::size_t>(file.gcount());
  }
  if (found < count * size)
  {
    return "its data are " + std::to_string(found) + " bytes, " + std::to_string(count * size) +
      " are needed";
  }
  if (voxels.BigEndian != IsBigEndianMachine())
  {
    vtkByteSwap::SwapVoidRange(numbers->GetVoidPointer(0), count, size);
  }
  return std::string();
}

std::string ReadText(const vtkFFDStoredVoxels& voxels, vtkDataArray* numbers)
{
  const vtkIdType count = numbers->GetNumberOfValues();
  const int components = numbers->GetNumberOfComponents();
  std::size_t size = 0;
  std::string problem;
  if (!vtkFFDFileAccess::FindSize(voxels.Path, size, problem))
  {
    return problem;
  }
  std::ifstream file(voxels.Path);
  file.imbue(std::locale::classic());
  file.seekg(static_cast<std::streamoff>(voxels.Offset));
  const double least = numbers->GetDataTypeMin();
  const double most = numbers->GetDataTypeMax();
  for (vtkIdType i = 0; i < count; ++i)
  {
    while (IsBetweenNumbers(file.peek()))
    {
      file.get();
    }
    double value = 0.0;
    if (!(file >> value))
    {
      return "its text has " + std::to_string(i) + " numbers, " + std::to_string(count) +
        " are needed";
    }
    if (value < least || value > most)
    {
      return "its text has a number that its type (" + std::string(numbers->GetDataTypeAsString()) +
        ") does not hold";
    }
    numbers->SetComponent(i / components, static_cast<int>(i % components), value);
  }
  return std::string();
}

} // namespace

//------------------------------------------------------------------------------
int vtkFFDStoredVoxels::GetType(vtkImageReader2* reader) const
{
  return this->Type >= 0 ? this->Type : reader->GetDataScalarType();
}

//------------------------------------------------------------------------------
int vtkFFDStoredVoxels::GetComponents(vtkImageReader2* reader) const
{
  return this->Components > 0 ? this->Components : reader->GetNumberOfScalarComponents();
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkImageData> vtkFFDStoredVoxels::ReadImage(
  vtkImageReader2* reader, std::string& error) const
{
  vtkInformation* const info = reader->GetOutputInformation(0);
  auto image = vtkSmartPointer<vtkImageData>::New();
  if (this->Components > 0)
  {
    image->SetDimensions(this->Size.data());
  }
  else
  {
    image->SetExtent(info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()));
  }
  image->SetSpacing(info->Get(vtkDataObject::SPACING()));
  image->SetOrigin(info->Get(vtkDataObject::ORIGIN()));
  image->AllocateScalars(this->GetType(reader), this->GetComponents(reader));
  vtkDataArray* const numbers = image->GetPointData()->GetScalars();
  if (!numbers || numbers->GetNumberOfTuples() < image->GetNumberOfPoints())
  {
    throw std::bad_alloc();
  }
  if (!this->Name.empty())
  {
    numbers->SetName(this->Name.c_str());
  }
  error = this->Form == TEXT ? ReadText(*this, numbers) : ReadBytes(*this, numbers);
  return error.empty() ? image : nullptr;
}
