// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDTransformFiles.h"

#include "FFDFieldHeader.h"

#include "vtk_zlib.h"
#include "vtksys/SystemTools.hxx"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <string_view>

namespace
{

constexpr std::size_t LargestText = std::size_t(1) << 30;
constexpr std::size_t Chunk = std::size_t(1) << 20;
constexpr std::size_t HeadSize = ffd::LargestFieldHeader;
constexpr int LongestChain = 64;
/// inflate(): zlib or gzip, found out from the stream.
constexpr int AnyWindow = 15 + 32;

using Proceed = std::function<bool(double)>;

/// Up to `limit` bytes of a file from `offset` on. What is allocated follows what is there.
bool ReadBytes(const std::string& name, std::size_t offset, std::size_t limit, std::string& bytes,
  const Proceed& proceed, std::string& error)
{
  bytes.clear();
  std::ifstream stream(name, std::ios::binary);
  if (!stream || vtksys::SystemTools::FileIsDirectory(name))
  {
    error = "it cannot be opened";
    return false;
  }
  stream.seekg(static_cast<std::streamoff>(offset));
  while (stream && bytes.size() < limit)
  {
    const std::size_t size = std::min(Chunk, limit - bytes.size());
    const std::size_t before = bytes.size();
    bytes.resize(before + size);
    stream.read(&bytes[before], static_cast<std::streamsize>(size));
    bytes.resize(before + static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    if (!proceed(0.5))
    {
      error = "reading was stopped";
      return false;
    }
  }
  return true;
}

/// The first `limit` bytes that a zlib or gzip stream in `packed` holds; fewer when it ends early.
bool Inflate(std::string_view packed, std::size_t limit, std::string& bytes,
  const Proceed& proceed, std::string& error)
{
  bytes.clear();
  z_stream stream = {};
  if (inflateInit2(&stream, AnyWindow) != Z_OK)
  {
    error = "zlib cannot be used";
    return false;
  }
  int status = Z_OK;
  while (status == Z_OK && bytes.size() < limit)
  {
    const std::size_t in = std::min(Chunk, packed.size());
    const std::size_t out = std::min(Chunk, limit - bytes.size());
    const std::size_t before = bytes.size();
    bytes.resize(before + out);
    // zlib does not write to its input.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(in);
    stream.next_out = reinterpret_cast<Bytef*>(&bytes[before]);
    stream.avail_out = static_cast<uInt>(out);
    status = inflate(&stream, Z_NO_FLUSH);
    packed.remove_prefix(in - stream.avail_in);
    bytes.resize(before + out - stream.avail_out);
    if (!proceed(0.5))
    {
      error = "reading was stopped";
      status = Z_ERRNO;
    }
    else if (in == 0 && stream.avail_out == out)
    {
      break; // truncated
    }
  }
  inflateEnd(&stream);
  if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
  {
    error = error.empty() ? "the compressed data are damaged" : error;
    return false;
  }
  return true;
}

bool IsGzip(std::string_view bytes)
{
  return bytes.size() > 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
}

/// The first bytes of a file, decompressed when it is a gzip file (.nii.gz).
bool ReadHead(const std::string& name, std::string& head, bool& packed, std::string& error)
{
  const Proceed always = [](double) { return true; };
  if (!ReadBytes(name, 0, HeadSize, head, always, error))
  {
    return false;
  }
  packed = IsGzip(head);
  if (packed)
  {
    const std::string bytes = head;
    return Inflate(bytes, HeadSize, head, always, error);
  }
  return true;
}

int DetectFormat(std::string_view head, bool packed)
{
  if (ffd::LooksLikeNifti(head))
  {
    return vtkFFDTransformFile::NIFTI;
  }
  if (packed)
  {
    return vtkFFDTransformFile::NONE;
  }
  if (ffd::LooksLikeItkTransform(head))
  {
    return vtkFFDTransformFile::ITK_TEXT;
  }
  if (ffd::LooksLikeNrrd(head))
  {
    return vtkFFDTransformFile::NRRD;
  }
  if (ffd::LooksLikeMetaImage(head))
  {
    return vtkFFDTransformFile::META_IMAGE;
  }
  if (head.find("<VTKFile") != std::string_view::npos &&
    head.find("ImageData") != std::string_view::npos)
  {
    return vtkFFDTransformFile::LATTICE;
  }
  if (ffd::LooksLikeElastixTransform(head))
  {
    return vtkFFDTransformFile::ELASTIX;
  }
  return vtkFFDTransformFile::NONE;
}

bool ReadField(const std::string& name, vtkFFDTransformFile& file, const std::string& head,
  bool packed, const Proceed& proceed, std::string& error)
{
  ffd::FieldHeader header;
  const bool parsed = file.Format == vtkFFDTransformFile::NIFTI
    ? ffd::ParseNiftiHeader(head, header, error)
    : file.Format == vtkFFDTransformFile::NRRD ? ffd::ParseNrrdHeader(head, header, error)
                                               : ffd::ParseMetaImageHeader(head, header, error);
  if (!parsed)
  {
    return false;
  }
  const std::string dataName = header.DataFile.empty()
    ? name
    : vtksys::SystemTools::GetFilenamePath(name) +
      (vtksys::SystemTools::GetFilenamePath(name).empty() ? "" : "/") + header.DataFile;
  const std::size_t wanted = header.GetDataSize();
  std::string data;
  if (packed || header.Compressed)
  {
    // A compressed NIfTI file has its header in the stream, too.
    const std::size_t skip = packed ? header.Offset : 0;
    std::string stream;
    if (!ReadBytes(dataName, packed ? 0 : header.Offset, std::string::npos, stream, proceed, error) ||
      !Inflate(stream, wanted + skip, data, proceed, error))
    {
      error = header.DataFile.empty() ? error : header.DataFile + ": " + error;
      return false;
    }
    data.erase(0, std::min(skip, data.size()));
  }
  else if (!ReadBytes(dataName, header.Offset, wanted, data, proceed, error))
  {
    error = header.DataFile.empty() ? error : header.DataFile + ": " + error;
    return false;
  }
  if (data.size() < wanted)
  {
    error = "the data end after " + std::to_string(data.size()) + " of " + std::to_string(wanted) +
      " bytes";
    return false;
  }
  file.Steps.resize(1);
  return ffd::DecodeField(
    header, reinterpret_cast<const unsigned char*>(data.data()), file.Steps[0], error);
}

/// The initial transform of an elastix file: next to it, or else where the file says.
std::string FindInitialFile(const std::string& name, const std::string& initial)
{
  const std::string folder = vtksys::SystemTools::GetFilenamePath(name);
  const std::string beside =
    (folder.empty() ? "" : folder + "/") + vtksys::SystemTools::GetFilenameName(initial);
  return vtksys::SystemTools::FileExists(beside, true) ? beside : initial;
}

bool ReadElastix(const std::string& name, vtkFFDTransformFile& file, int depth,
  const Proceed& proceed, std::string& error)
{
  std::string text;
  if (!ReadBytes(name, 0, LargestText + 1, text, proceed, error))
  {
    return false;
  }
  if (text.size() > LargestText)
  {
    error = "it is larger than 1 GiB";
    return false;
  }
  ffd::ElastixTransform transform;
  if (!ffd::ParseElastixTransform(text, transform, error))
  {
    return false;
  }
  if (!transform.InitialFile.empty())
  {
    const std::string initial = FindInitialFile(name, transform.InitialFile);
    if (depth >= LongestChain)
    {
      error = "its chain of initial transforms does not end";
      return false;
    }
    if (!ReadElastix(initial, file, depth + 1, proceed, error))
    {
      if (depth + 1 < LongestChain && error.find("initial transform") == std::string::npos)
      {
        error = "the initial transform '" + transform.InitialFile + "' cannot be used: " + error;
      }
      return false;
    }
  }
  if (file.FixedImage.Size.x == 0 || transform.FixedImage.Size.x > 0)
  {
    file.FixedImage = transform.FixedImage;
  }
  if (!transform.Add || transform.InitialFile.empty())
  {
    file.Steps.push_back(std::move(transform.Step));
    return true;
  }
  // The steps so far as one, to which this one can be added.
  for (std::size_t i = 1; i < file.Steps.size(); ++i)
  {
    ffd::TransformStep& first = file.Steps[0];
    const ffd::TransformStep& next = file.Steps[i];
    if (first.Type != ffd::TransformStep::Kind::Linear ||
      next.Type != ffd::TransformStep::Kind::Linear)
    {
      error = "a transform is added (HowToCombineTransforms \"Add\") to a chain that is not linear";
      return false;
    }
    first.Offset = next.Matrix * first.Offset + next.Offset;
    first.Matrix = next.Matrix * first.Matrix;
  }
  file.Steps.resize(1);
  if (!ffd::AddTransformStep(file.Steps[0], transform.Step))
  {
    error = "two splines are added (HowToCombineTransforms \"Add\"); only a spline and linear "
            "transforms can be";
    return false;
  }
  return true;
}

} // namespace

//------------------------------------------------------------------------------
int vtkFFDDetectTransformFormat(const std::string& fileName, std::string& error)
{
  std::string head;
  bool packed = false;
  if (!ReadHead(fileName, head, packed, error))
  {
    return vtkFFDTransformFile::NONE;
  }
  const int format = DetectFormat(head, packed);
  if (format == vtkFFDTransformFile::NONE)
  {
    error = "it is no ITK text transform, elastix parameter file, MetaImage, NRRD, NIfTI or .vti "
            "file";
  }
  return format;
}

//------------------------------------------------------------------------------
std::string vtkFFDFindLatticeFileProblem(const std::string& fileName)
{
  std::string bytes;
  std::string error;
  if (!ReadBytes(
        fileName, 0, std::string::npos, bytes, [](double) { return true; }, error))
  {
    return error;
  }
  return ffd::FindLatticeFileProblem(bytes);
}

//------------------------------------------------------------------------------
bool vtkFFDReadTransformFile(const std::string& fileName, vtkFFDTransformFile& file,
  const std::function<bool(double)>& proceed, std::string& error)
{
  file = vtkFFDTransformFile();
  error.clear();
  std::string head;
  bool packed = false;
  if (!ReadHead(fileName, head, packed, error))
  {
    return false;
  }
  file.Format = DetectFormat(head, packed);
  switch (file.Format)
  {
    case vtkFFDTransformFile::ITK_TEXT:
    {
      std::string text;
      if (!ReadBytes(fileName, 0, LargestText + 1, text, proceed, error))
      {
        return false;
      }
      if (text.size() > LargestText)
      {
        error = "it is larger than 1 GiB";
        return false;
      }
      ffd::ItkTransform transform;
      if (!ffd::ParseItkTransform(text, transform, error))
      {
        return false;
      }
      file.Steps = std::move(transform.Steps);
      return true;
    }
    case vtkFFDTransformFile::ELASTIX:
      return ReadElastix(fileName, file, 0, proceed, error);
    case vtkFFDTransformFile::META_IMAGE:
    case vtkFFDTransformFile::NRRD:
    case vtkFFDTransformFile::NIFTI:
      return ReadField(fileName, file, head, packed, proceed, error);
    default:
      error = "it is no ITK text transform, elastix parameter file, MetaImage, NRRD or NIfTI file";
      return false;
  }
}
