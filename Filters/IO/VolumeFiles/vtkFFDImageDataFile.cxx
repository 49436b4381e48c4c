// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDImageDataFile.h"

#include "vtkFFDFileAccess.h"
#include "vtkFFDTextHeader.h"

#include "vtkCallbackCommand.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkOutputWindow.h"
#include "vtkStructuredPointsReader.h"
#include "vtkXMLImageDataReader.h"

#include <algorithm>

namespace
{

/// Listens to what vtkDataReader says of numbers that are missing, which is no event of its own: it
/// is only printed, and the memory of these numbers stays as it is.
class ShortLegacyFile
{
public:
  explicit ShortLegacyFile(std::string& error)
    : Error(error)
  {
    this->Command->SetClientData(this);
    this->Command->SetCallback([](vtkObject*, unsigned long, void* self, void* data) {
      const std::string text = data ? static_cast<const char*>(data) : "";
      if (text.find("Error reading ") != std::string::npos)
      {
        static_cast<ShortLegacyFile*>(self)->Error =
          "its numbers are fewer than its header says, or damaged";
      }
    });
    this->Tag = this->Window->AddObserver(vtkCommand::WarningEvent, this->Command);
  }
  ~ShortLegacyFile() { this->Window->RemoveObserver(this->Tag); }
  ShortLegacyFile(const ShortLegacyFile&) = delete;
  void operator=(const ShortLegacyFile&) = delete;

private:
  std::string& Error;
  unsigned long Tag = 0;
  vtkNew<vtkCallbackCommand> Command;
  vtkSmartPointer<vtkOutputWindow> Window{ vtkOutputWindow::GetInstance() };
};

class XmlFile : public vtkFFDVolumeFile
{
public:
  using vtkFFDVolumeFile::vtkFFDVolumeFile;

protected:
  std::string FindVoxels(Header&) const override
  {
    const std::string problem = vtkFFDImageDataFile::FindXmlProblem(this->Path);
    return problem.empty() ? problem : this->Explain(problem);
  }
};

class LegacyFile : public vtkFFDVolumeFile
{
public:
  using vtkFFDVolumeFile::vtkFFDVolumeFile;
  vtkSmartPointer<vtkImageData> Read(const Header& header, std::string& error) const override
  {
    const ShortLegacyFile listens(error);
    return this->vtkFFDVolumeFile::Read(header, error);
  }
};

} // namespace

//------------------------------------------------------------------------------
std::string vtkFFDImageDataFile::FindXmlProblem(const std::string& path)
{
  constexpr std::size_t tail = 1024; // blanks and comments may follow
  std::size_t size = 0;
  std::string end;
  std::string problem;
  if (!vtkFFDFileAccess::FindSize(path, size, problem) ||
    !vtkFFDFileAccess::ReadBytes(
      path, size - std::min(size, tail), tail, end, [] { return true; }, problem))
  {
    return problem;
  }
  return end.find("</VTKFile") == std::string::npos
    ? "it is not whole: the end of a VTKFile is missing"
    : std::string();
}

//------------------------------------------------------------------------------
std::unique_ptr<vtkFFDVolumeFile> vtkFFDImageDataFile::Open(
  const std::string& path, vtkCommand* errors)
{
  const std::string ending = vtkFFDVolumeFile::FindEnding(path);
  if (ending == ".vti")
  {
    vtkNew<vtkXMLImageDataReader> reader;
    reader->SetFileName(path.c_str());
    reader->SetReaderErrorObserver(errors);
    reader->SetParserErrorObserver(errors);
    return std::make_unique<XmlFile>(path, reader, errors);
  }
  // VTK's reader quotes the first line of any other file.
  if (ending == ".vtk" && vtkFFDTextHeader::ReadStart(path).compare(0, 14, "# vtk DataFile") == 0)
  {
    vtkNew<vtkStructuredPointsReader> reader;
    reader->SetFileName(path.c_str());
    return std::make_unique<LegacyFile>(path, reader, errors);
  }
  return nullptr;
}
