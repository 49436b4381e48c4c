// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What the fuzzer and the test that replays its corpus do with any bytes: hand them to every
// parser of transform files, and check what the parsers promise. Aborts when a promise is broken.
#ifndef FFDFuzzTransformFile_h
#define FFDFuzzTransformFile_h

#include "FFDElastixTransform.h"
#include "FFDFieldHeader.h"
#include "FFDItkTransform.h"
#include "FFDLatticeFile.h"
#include "FFDMincTransform.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

inline void FFDPromise(bool kept, const char* what)
{
  if (!kept)
  {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

inline bool FFDUsable(const glm::dvec3& v, double limit)
{
  return std::abs(v.x) <= limit && std::abs(v.y) <= limit && std::abs(v.z) <= limit;
}

inline void FFDCheckStep(const ffd::TransformStep& step)
{
  // The offset of a linear map is a sum of products of two numbers.
  for (int column = 0; column < 3; ++column)
  {
    FFDPromise(FFDUsable(step.Matrix[column], 1e25), "the matrix is finite");
  }
  FFDPromise(FFDUsable(step.Offset, 1e38), "the offset is finite");
  if (step.Type == ffd::TransformStep::Kind::Spline || step.Type == ffd::TransformStep::Kind::Field)
  {
    FFDPromise(step.Order >= 1 && step.Order <= 3, "the order of a spline is known");
    FFDPromise(ffd::FindGridProblem(step.Grid, 1).empty(), "the grid is usable");
    FFDPromise(step.Values.size() ==
        static_cast<std::size_t>(step.Grid.Size.x) * static_cast<std::size_t>(step.Grid.Size.y) *
          static_cast<std::size_t>(step.Grid.Size.z),
      "there is a value per node");
    for (const glm::dvec3& value : step.Values)
    {
      FFDPromise(FFDUsable(value, 1e12), "values are finite");
    }
  }
  ffd::TransformStep turned = step;
  ffd::FlipTransformStep(turned);
  ffd::AlignTransformStep(turned);
  FFDPromise(turned.Values.size() == step.Values.size(), "turning keeps the nodes");
}

/// As vtkBase64Utilities::DecodeSafely() does it: this is built without VTK.
inline std::size_t FFDDecodeBase64(
  const unsigned char* text, std::size_t length, unsigned char* bytes, std::size_t size)
{
  const std::string_view digits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::size_t count = 0;
  unsigned int bits = 0;
  for (std::size_t i = 0; i < length && count < size; ++i)
  {
    const std::size_t digit = digits.find(static_cast<char>(text[i]));
    if (digit == std::string_view::npos)
    {
      break;
    }
    bits = bits << 6 | static_cast<unsigned int>(digit);
    if (i % 4 != 0)
    {
      bytes[count++] = static_cast<unsigned char>(bits >> (6 - 2 * (i % 4)));
    }
  }
  return count;
}

/// Returns how many parsers took the bytes.
inline int FFDFuzzTransformFile(std::string_view bytes)
{
  int taken = 0;
  std::string error;
  ffd::ItkTransform itk;
  if (ffd::ParseItkTransform(bytes, itk, error))
  {
    ++taken;
    for (const ffd::TransformStep& step : itk.Steps)
    {
      FFDCheckStep(step);
    }
    ffd::ItkTransform again;
    FFDPromise(ffd::ParseItkTransform(ffd::FormatItkTransform(itk.Steps), again, error) ||
        itk.Steps.size() == 64 || error.find("1e12") != std::string::npos ||
        error.find("singular") != std::string::npos,
      "what is written can be read");
  }
  else
  {
    FFDPromise(!error.empty(), "an error says what is wrong");
  }
  ffd::ElastixTransform elastix;
  if (ffd::ParseElastixTransform(bytes, elastix, error))
  {
    ++taken;
    FFDCheckStep(elastix.Step);
    FFDPromise(elastix.Weights.size() == elastix.SubFiles.size(), "there is a weight per file");
    for (const double weight : elastix.Weights)
    {
      FFDPromise(std::abs(weight) <= 1e12, "weights are finite");
    }
  }
  else
  {
    FFDPromise(!error.empty(), "an error says what is wrong");
  }
  ffd::TransformStep matlab;
  if (ffd::ParseMatlabTransform(bytes, matlab, error))
  {
    ++taken;
    FFDCheckStep(matlab);
  }
  else
  {
    FFDPromise(!error.empty(), "an error says what is wrong");
  }
  std::vector<ffd::MincTransformEntry> minc;
  if (ffd::ParseMincTransform(bytes, minc, error))
  {
    ++taken;
    FFDPromise(!minc.empty(), "there is a transform");
    for (const ffd::MincTransformEntry& entry : minc)
    {
      FFDCheckStep(entry.Step);
    }
  }
  else
  {
    FFDPromise(!error.empty(), "an error says what is wrong");
  }
  FFDPromise(ffd::FindLargestLatticeFile(bytes) >= 1048576, "a lattice file may be 1 MiB");
  using Parser = bool (*)(std::string_view, ffd::FieldHeader&, std::string&);
  const Parser parsers[] = { ffd::ParseMetaImageHeader, ffd::ParseNrrdHeader,
    ffd::ParseNiftiHeader };
  for (const Parser parse : parsers)
  {
    ffd::FieldHeader header;
    if (!parse(bytes, header, error))
    {
      FFDPromise(!error.empty(), "an error says what is wrong");
      continue;
    }
    ++taken;
    FFDPromise(ffd::FindGridProblem(header.Grid, 1).empty(), "the grid is usable");
    FFDPromise(header.GetNumberOfNodes() <= ffd::LargestField, "the field is not too large");
    FFDPromise(header.DataFile.find('/') == std::string::npos, "the data are in the same folder");
    if (header.DataFile.empty() && header.Offset <= bytes.size() &&
      header.GetDataSize() <= bytes.size() - header.Offset)
    {
      ffd::TransformStep step;
      if (ffd::DecodeField(header,
            reinterpret_cast<const unsigned char*>(bytes.data()) + header.Offset, step, error))
      {
        FFDCheckStep(step);
      }
    }
  }
  taken += ffd::FindLatticeFileProblem(bytes, FFDDecodeBase64).empty() ? 1 : 0;
  return taken;
}

#endif
