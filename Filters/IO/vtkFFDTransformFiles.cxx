// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTransformFiles.h"

#include "vtkFFDFileAccess.h"
#include "vtkFFDHdf5Transforms.h"

#include "FFDElastixTransform.h"
#include "FFDFieldHeader.h"
#include "FFDItkTransform.h"
#include "FFDLatticeFile.h"
#include "FFDMincTransform.h"

#include "vtkBase64Utilities.h"

#include "vtksys/SystemTools.hxx"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string_view>
#include <utility>

namespace
{

using vtkFFDFileAccess::Proceed;
using Steps = std::vector<ffd::TransformStep>;

constexpr std::size_t HeadSize = ffd::LargestFieldHeader;

/// State that is passed down through files that name others.
struct Reading
{
  Proceed Continue;
  std::size_t Files = 0;                // of elastix, read so far
  vtkFFDTransformFile* Stack = nullptr; // which step of stacks, and what they are
};

/// The first bytes of a file, decompressed when it is a gzip file (.nii.gz), without the byte order
/// mark of UTF-8.
bool ReadHead(const std::string& name, std::string& head, bool& packed, std::string& error)
{
  const Proceed always = [] { return true; };
  if (!vtkFFDFileAccess::ReadBytes(name, 0, HeadSize, head, always, error))
  {
    return false;
  }
  if (head.compare(0, 2, "\xff\xfe") == 0 || head.compare(0, 2, "\xfe\xff") == 0)
  {
    error = "it is a text in UTF-16 (Unicode); save it as UTF-8 or ASCII";
    return false;
  }
  head.erase(0, vtkFFDFileAccess::FindMarkSize(head));
  packed = vtkFFDFileAccess::IsGzip(head);
  return !packed || vtkFFDFileAccess::ReadCompressed(name, 0, HeadSize, head, always, error);
}

int DetectFormat(std::string_view head, bool packed)
{
  if (ffd::LooksLikeNifti(head))
  {
    return vtkFFDTransformReader::NIFTI;
  }
  if (packed)
  {
    return vtkFFDTransformReader::UNKNOWN;
  }
  if (ffd::LooksLikeItkTransform(head))
  {
    return vtkFFDTransformReader::ITK_TEXT;
  }
  if (vtkFFDHdf5Transforms::LooksLikeHdf5(head))
  {
    return vtkFFDTransformReader::ITK_HDF5;
  }
  if (ffd::LooksLikeMatlabTransform(head))
  {
    return vtkFFDTransformReader::MATLAB;
  }
  if (ffd::LooksLikeMincTransform(head))
  {
    return vtkFFDTransformReader::MINC;
  }
  if (ffd::LooksLikeNrrd(head))
  {
    return vtkFFDTransformReader::NRRD;
  }
  if (ffd::LooksLikeMetaImage(head))
  {
    return vtkFFDTransformReader::META_IMAGE;
  }
  if (head.find("<VTKFile") != std::string_view::npos &&
    head.find("ImageData") != std::string_view::npos)
  {
    return vtkFFDTransformReader::LATTICE;
  }
  if (ffd::LooksLikeElastixTransform(head))
  {
    return vtkFFDTransformReader::ELASTIX;
  }
  return vtkFFDTransformReader::UNKNOWN;
}

/// The data that a header describes, in the file `name` from header.Offset on.
bool ReadFieldData(const std::string& name, const ffd::FieldHeader& header, bool packed,
  const Proceed& proceed, std::string& data, std::string& error)
{
  const std::size_t wanted = header.GetDataSize();
  std::size_t size = 0;
  if (packed || header.Compressed)
  {
    // A compressed NIfTI file has its header in the stream, too.
    const std::size_t skip = packed ? header.Offset : 0;
    if (!vtkFFDFileAccess::ReadCompressed(
          name, packed ? 0 : header.Offset, wanted + skip, data, proceed, error))
    {
      return false;
    }
    data.erase(0, std::min(skip, data.size()));
    size = data.size();
  }
  else
  {
    // A file that is too short is not read to find that out.
    if (!vtkFFDFileAccess::FindSize(name, size, error))
    {
      return false;
    }
    size -= std::min(size, header.Offset);
    if (size >= wanted &&
      !vtkFFDFileAccess::ReadBytes(name, header.Offset, wanted, data, proceed, error))
    {
      return false;
    }
    size = size >= wanted ? data.size() : size;
  }
  if (size < wanted)
  {
    error =
      "the data end after " + std::to_string(size) + " of " + std::to_string(wanted) + " bytes";
    return false;
  }
  return true;
}

bool ParseFieldHeader(
  int format, const std::string& head, ffd::FieldHeader& header, std::string& error)
{
  switch (format)
  {
    case vtkFFDTransformReader::NIFTI:
      return ffd::ParseNiftiHeader(head, header, error);
    case vtkFFDTransformReader::NRRD:
      return ffd::ParseNrrdHeader(head, header, error);
    default:
      return ffd::ParseMetaImageHeader(head, header, error);
  }
}

bool ReadField(const std::string& name, int format, const std::string& head, bool packed,
  const Proceed& proceed, Steps& steps, std::string& error)
{
  ffd::FieldHeader header;
  if (!ParseFieldHeader(format, head, header, error))
  {
    return false;
  }
  if (header.DataFile.empty() && !packed)
  {
    std::string mark;
    if (!vtkFFDFileAccess::ReadBytes(name, 0, 3, mark, proceed, error))
    {
      return false;
    }
    header.Offset += vtkFFDFileAccess::FindMarkSize(mark); // left out of the head
  }
  std::string dataName = name;
  if (!header.DataFile.empty() &&
    !vtkFFDFileAccess::FindBeside(name, header.DataFile, dataName, error))
  {
    return false;
  }
  std::string data;
  if (!ReadFieldData(dataName, header, packed, proceed, data, error))
  {
    error = header.DataFile.empty() ? error : header.DataFile + ": " + error;
    return false;
  }
  steps.resize(1);
  return ffd::DecodeField(
    header, reinterpret_cast<const unsigned char*>(data.data()), steps[0], error);
}

bool ReadItkText(const std::string& name, const Proceed& proceed, Steps& steps, std::string& error)
{
  std::string text;
  ffd::ItkTransform transform;
  if (!vtkFFDFileAccess::ReadText(name, text, proceed, error) ||
    !ffd::ParseItkTransform(text, transform, error))
  {
    return false;
  }
  steps = std::move(transform.Steps);
  return true;
}

bool ReadMatlab(const std::string& name, const Proceed& proceed, Steps& steps, std::string& error)
{
  // The largest field as ITK's parameters, and what goes with them.
  constexpr std::size_t largest = 24 * ffd::LargestField + HeadSize;
  std::size_t size = 0;
  std::string bytes;
  if (!vtkFFDFileAccess::FindSize(name, size, error))
  {
    return false;
  }
  if (size > largest)
  {
    error = "it is larger than any transform that can be read";
    return false;
  }
  steps.resize(1);
  return vtkFFDFileAccess::ReadBytes(name, 0, largest, bytes, proceed, error) &&
    ffd::ParseMatlabTransform(bytes, steps[0], error);
}

bool ReadMinc(const std::string& name, const Proceed& proceed, Steps& steps, std::string& error)
{
  std::string text;
  std::vector<ffd::MincTransformEntry> entries;
  if (!vtkFFDFileAccess::ReadText(name, text, proceed, error) ||
    !ffd::ParseMincTransform(text, entries, error))
  {
    return false;
  }
  for (ffd::MincTransformEntry& entry : entries)
  {
    std::string volume;
    if (!entry.VolumeFile.empty())
    {
      if (!vtkFFDFileAccess::FindBeside(name, entry.VolumeFile, volume, error))
      {
        return false;
      }
      if (!vtkFFDHdf5Transforms::ReadMincGrid(volume, entry.Step, error))
      {
        error = entry.VolumeFile + ": " + error;
        return false;
      }
      entry.Step.IsInverse = entry.IsInverse;
    }
    steps.push_back(std::move(entry.Step));
  }
  return true;
}

bool ReadAny(const std::string& name, Steps& steps, ffd::TransformGrid& fixedImage,
  Reading& reading, std::string& error);

/// A file that an elastix file names: next to it, or else where the file says.
std::string FindNamedFile(const std::string& name, const std::string& named)
{
  const std::string folder = vtksys::SystemTools::GetFilenamePath(name);
  const std::string beside =
    (folder.empty() ? "" : folder + "/") + vtksys::SystemTools::GetFilenameName(named);
  return vtksys::SystemTools::FileExists(beside, true) ? beside : named;
}

/// The steps of a file that the elastix file `name` names as `what`.
bool ReadNamed(const std::string& name, const std::string& named, const char* what, Steps& steps,
  ffd::TransformGrid& fixedImage, Reading& reading, std::string& error)
{
  static constexpr const char* cause = " cannot be used: ";
  static constexpr const char* endless = "its chain of transforms does not end";
  if (reading.Files >= ffd::LargestChain)
  {
    error = endless;
    return false;
  }
  if (ReadAny(FindNamedFile(name, named), steps, fixedImage, reading, error))
  {
    return true;
  }
  // Once is enough, and not for each file of a circle.
  if (error != endless && error.find(cause) == std::string::npos)
  {
    error = std::string("the ") + what + " '" + named + "'" + cause + error;
  }
  return false;
}

/// Number of steps, those of sums counted.
std::size_t CountSteps(const Steps& steps)
{
  std::size_t count = steps.size();
  for (const ffd::TransformStep& step : steps)
  {
    for (const ffd::TransformTerm& term : step.Terms)
    {
      count += CountSteps(term.Steps);
    }
  }
  return count;
}

/// first(x) + second(x) - x: as one step where there is one, else as a sum.
void AddSteps(Steps& first, Steps&& second)
{
  using Kind = ffd::TransformStep::Kind;
  for (Steps* chain : { &first, &second })
  {
    while (
      chain->size() > 1 && (*chain)[0].Type == Kind::Linear && (*chain)[1].Type == Kind::Linear)
    {
      const ffd::TransformStep a = (*chain)[0];
      ffd::TransformStep& b = (*chain)[1];
      b.Offset = b.Matrix * a.Offset + b.Offset;
      b.Matrix = b.Matrix * a.Matrix;
      chain->erase(chain->begin());
    }
  }
  if (first.size() == 1 && second.size() == 1 && ffd::AddTransformStep(first[0], second[0]))
  {
    return;
  }
  ffd::TransformStep sum;
  sum.Type = Kind::Sum;
  sum.Terms.resize(2);
  sum.Terms[0].Steps = std::move(first);
  sum.Terms[1].Steps = std::move(second);
  first.clear();
  first.push_back(std::move(sum));
}

/// The steps of an elastix file, without those of its initial transform.
bool ReadOwnSteps(const std::string& name, ffd::ElastixTransform& transform, Steps& steps,
  Reading& reading, std::string& error)
{
  ffd::TransformGrid ignored;
  if (!transform.TransformFile.empty())
  {
    return ReadNamed(name, transform.TransformFile, "transform", steps, ignored, reading, error);
  }
  steps.push_back(std::move(transform.Step));
  if (transform.SubFiles.empty())
  {
    return true;
  }
  ffd::TransformStep& sum = steps.back();
  sum.Type = ffd::TransformStep::Kind::Sum;
  for (std::size_t i = 0; i < transform.SubFiles.size(); ++i)
  {
    ffd::TransformTerm term;
    term.Weight = transform.Weights[i];
    if (!ReadNamed(name, transform.SubFiles[i], "transform", term.Steps, ignored, reading, error))
    {
      return false;
    }
    sum.Terms.push_back(std::move(term));
  }
  return true;
}

bool ReadElastix(const std::string& name, Steps& steps, ffd::TransformGrid& fixedImage,
  Reading& reading, std::string& error)
{
  ++reading.Files;
  std::string text;
  ffd::ElastixTransform transform;
  if (!vtkFFDFileAccess::ReadText(name, text, reading.Continue, error) ||
    !ffd::ParseElastixTransform(text, transform, error, reading.Stack->StackIndex))
  {
    return false;
  }
  text = std::string();
  if (transform.StackSize > 0)
  {
    vtkFFDTransformFile& stack = *reading.Stack;
    if (stack.StackSize > 0 && stack.StackSize != transform.StackSize)
    {
      error = "it is a stack of " + std::to_string(transform.StackSize) +
        " transforms in a chain with one of " + std::to_string(stack.StackSize);
      return false;
    }
    stack.StackSize = transform.StackSize;
    stack.StackOrigin = transform.StackOrigin;
    stack.StackSpacing = transform.StackSpacing;
  }
  if (!transform.InitialFile.empty() &&
    !ReadNamed(name, transform.InitialFile, "initial transform", steps, fixedImage, reading, error))
  {
    return false;
  }
  if (fixedImage.Size.x == 0 || transform.FixedImage.Size.x > 0)
  {
    fixedImage = transform.FixedImage;
  }
  Steps own;
  if (!ReadOwnSteps(name, transform, own, reading, error))
  {
    return false;
  }
  if (transform.Add && !transform.InitialFile.empty())
  {
    AddSteps(steps, std::move(own));
  }
  else
  {
    std::move(own.begin(), own.end(), std::back_inserter(steps));
  }
  if (CountSteps(steps) > ffd::LargestChain)
  {
    error = "there are more than 64 transforms";
    return false;
  }
  return true;
}

/// The steps of a file of a format; `head` and `packed` as ReadHead() gives them.
bool ReadAs(int format, const std::string& name, const std::string& head, bool packed, Steps& steps,
  ffd::TransformGrid& fixedImage, Reading& reading, std::string& error)
{
  switch (format)
  {
    case vtkFFDTransformReader::ITK_TEXT:
      return ReadItkText(name, reading.Continue, steps, error);
    case vtkFFDTransformReader::ITK_HDF5:
      return vtkFFDHdf5Transforms::ReadItk(name, steps, error);
    case vtkFFDTransformReader::MATLAB:
      return ReadMatlab(name, reading.Continue, steps, error);
    case vtkFFDTransformReader::MINC:
      return ReadMinc(name, reading.Continue, steps, error);
    case vtkFFDTransformReader::ELASTIX:
      return ReadElastix(name, steps, fixedImage, reading, error);
    case vtkFFDTransformReader::META_IMAGE:
    case vtkFFDTransformReader::NRRD:
    case vtkFFDTransformReader::NIFTI:
      return ReadField(name, format, head, packed, reading.Continue, steps, error);
    default:
      error = "it is no transform of ITK (text, .h5, .mat), elastix parameter file, .xfm file of "
              "MINC, MetaImage, NRRD or NIfTI file";
      return false;
  }
}

bool ReadAny(const std::string& name, Steps& steps, ffd::TransformGrid& fixedImage,
  Reading& reading, std::string& error)
{
  std::string head;
  bool packed = false;
  return ReadHead(name, head, packed, error) &&
    ReadAs(DetectFormat(head, packed), name, head, packed, steps, fixedImage, reading, error);
}

} // namespace

//------------------------------------------------------------------------------
int vtkFFDDetectTransformFormat(const std::string& fileName)
{
  std::string head;
  std::string error;
  bool packed = false;
  return ReadHead(fileName, head, packed, error) ? DetectFormat(head, packed)
                                                 : vtkFFDTransformReader::UNKNOWN;
}

//------------------------------------------------------------------------------
bool vtkFFDIsTransformFile(const std::string& fileName)
{
  std::string head;
  std::string error;
  bool packed = false;
  if (!ReadHead(fileName, head, packed, error))
  {
    return false;
  }
  const int format = DetectFormat(head, packed);
  switch (format)
  {
    case vtkFFDTransformReader::META_IMAGE:
    case vtkFFDTransformReader::NRRD:
    case vtkFFDTransformReader::NIFTI:
    {
      ffd::FieldHeader header;
      return ParseFieldHeader(format, head, header, error);
    }
    case vtkFFDTransformReader::UNKNOWN:
    case vtkFFDTransformReader::LATTICE:
      return false;
    default:
      return true;
  }
}

//------------------------------------------------------------------------------
std::string vtkFFDFindLatticeFileProblem(const std::string& fileName)
{
  std::string bytes;
  std::string error;
  std::size_t size = 0;
  bool packed = false;
  if (!ReadHead(fileName, bytes, packed, error) ||
    !vtkFFDFileAccess::FindSize(fileName, size, error))
  {
    return error;
  }
  if (size > ffd::FindLargestLatticeFile(bytes))
  {
    return "it is larger than its control points need";
  }
  if (!vtkFFDFileAccess::ReadBytes(
        fileName, 0, size, bytes, [] { return true; }, error))
  {
    return error;
  }
  return ffd::FindLatticeFileProblem(bytes, &vtkBase64Utilities::DecodeSafely);
}

//------------------------------------------------------------------------------
bool vtkFFDReadTransformFile(const std::string& fileName, vtkFFDTransformFile& file,
  const std::function<bool(double)>& proceed, std::string& error)
{
  std::string head;
  bool packed = false;
  if (!ReadHead(fileName, head, packed, error))
  {
    return false;
  }
  file.Format = DetectFormat(head, packed);
  if (file.Format == vtkFFDTransformReader::LATTICE)
  {
    return true;
  }
  if (file.Format == vtkFFDTransformReader::UNKNOWN)
  {
    error = "it is no ITK text transform, .h5 or .mat file of ITK, elastix parameter file, .xfm "
            "file of MINC, MetaImage, NRRD, NIfTI or .vti file";
    return false;
  }
  Reading reading;
  reading.Continue = [&proceed] { return proceed(0.5); };
  reading.Stack = &file;
  return ReadAs(file.Format, fileName, head, packed, file.Steps, file.FixedImage, reading, error);
}
