// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Parsers and writers of transform files: round trips, turns of axes, sums, and the fuzz corpus.
#include "../Fuzz/FFDFuzzTransformFile.h"
#include "FFDBSplineField.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <sstream>
#include <vector>

namespace
{

using ffd::TransformStep;

TransformStep MakeSpline(unsigned seed, const glm::dmat3& direction)
{
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> number(-2.0, 2.0);
  TransformStep step;
  step.Type = TransformStep::Kind::Spline;
  step.Grid.Size = { 5, 4, 6 };
  step.Grid.Origin = { -3.25, 7.0, 11.0 };
  step.Grid.Spacing = { 2.0, 3.0, 0.1 };
  step.Grid.Direction = direction;
  step.Values.resize(5 * 4 * 6);
  for (glm::dvec3& value : step.Values)
  {
    value = { number(engine), number(engine), number(engine) };
  }
  return step;
}

/// x -> -z, y -> x, z -> -y, as columns.
const glm::dmat3 Permuted(0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0);

/// The step at a point, by the field of the lattice and the frame of the grid.
glm::dvec3 Apply(const TransformStep& step, const glm::dvec3& p)
{
  if (step.Type == TransformStep::Kind::Linear)
  {
    return step.Matrix * p + step.Offset;
  }
  const ffd::BSplineField field(
    step.Grid.Size, glm::dvec3(0.0), step.Grid.Spacing, step.Values.data());
  return p + field.Displacement(glm::transpose(step.Grid.Direction) * (p - step.Grid.Origin));
}

glm::dvec3 PointOf(const TransformStep& step, double u, double v, double w)
{
  const glm::dvec3 local(2.0 * u + 2.0, 3.0 * v + 3.0, 0.1 + 0.3 * w);
  return step.Grid.Origin + step.Grid.Direction * local;
}

double Difference(const glm::dvec3& a, const glm::dvec3& b)
{
  return std::max({ std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z) });
}

void ExpectSame(const TransformStep& a, const TransformStep& b)
{
  ASSERT_EQ(a.Type, b.Type);
  EXPECT_EQ(a.Matrix, b.Matrix);
  EXPECT_EQ(a.Offset, b.Offset);
  EXPECT_EQ(a.Grid.Size, b.Grid.Size);
  EXPECT_EQ(a.Grid.Origin, b.Grid.Origin);
  EXPECT_EQ(a.Grid.Spacing, b.Grid.Spacing);
  EXPECT_EQ(a.Grid.Direction, b.Grid.Direction);
  EXPECT_EQ(a.Values, b.Values);
}

TEST(TransformFile, ItkTextIsReadAsWritten)
{
  TransformStep linear;
  linear.Matrix = glm::dmat3(1.1, 0.2, -0.3, 0.4, 0.9, 1.0 / 3.0, 0.0, 0.1, 1.2);
  linear.Offset = { 1e-17, -2.5, 3e5 };
  TransformStep field = MakeSpline(2, glm::dmat3(1.0));
  field.Type = TransformStep::Kind::Field;
  const std::vector<TransformStep> steps = { MakeSpline(1, Permuted), linear, field };
  ffd::ItkTransform read;
  std::string error;
  ASSERT_TRUE(ffd::ParseItkTransform(ffd::FormatItkTransform(steps), read, error)) << error;
  ASSERT_EQ(read.Steps.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
  {
    ExpectSame(read.Steps[i], steps[i]);
  }
  ASSERT_TRUE(ffd::ParseItkTransform(ffd::FormatItkTransform({ linear }), read, error)) << error;
  ASSERT_EQ(read.Steps.size(), 1u);
  ExpectSame(read.Steps[0], linear);
}

TEST(TransformFile, SmallScaleIsNoCollapse)
{
  TransformStep small;
  small.Matrix = glm::dmat3(1e-5);
  ffd::ItkTransform read;
  std::string error;
  ASSERT_TRUE(ffd::ParseItkTransform(ffd::FormatItkTransform({ small }), read, error)) << error;
  ExpectSame(read.Steps[0], small);
  small.Matrix[2] = small.Matrix[1];
  EXPECT_FALSE(ffd::ParseItkTransform(ffd::FormatItkTransform({ small }), read, error));
}

TEST(TransformFile, ElastixTextIsReadAsWritten)
{
  const TransformStep spline = MakeSpline(3, Permuted);
  ffd::TransformGrid image;
  image.Size = { 64, 32, 16 };
  image.Spacing = { 1.5, 1.0, 0.3 };
  image.Origin = { 0.1, 0.2, 0.3 };
  image.Direction = Permuted;
  ffd::ElastixTransform read;
  std::string error;
  ASSERT_TRUE(ffd::ParseElastixTransform(ffd::FormatElastixTransform(spline, image), read, error))
    << error;
  ExpectSame(read.Step, spline);
  EXPECT_TRUE(read.InitialFile.empty());
  EXPECT_FALSE(read.Add);
  EXPECT_EQ(read.FixedImage.Size, image.Size);
  EXPECT_EQ(read.FixedImage.Origin, image.Origin);
  EXPECT_EQ(read.FixedImage.Direction, image.Direction);
}

TEST(TransformFile, FieldHeadersAreReadAsWritten)
{
  ffd::TransformGrid grid;
  grid.Size = { 7, 8, 9 };
  grid.Origin = { -1.5, 2.25, 64.0 };
  grid.Spacing = { 0.5, 2.0, 0.25 };
  grid.Direction = Permuted;
  const std::string texts[] = { ffd::FormatMetaImageHeader(grid, ""),
    ffd::FormatMetaImageHeader(grid, "data.raw"), ffd::FormatNrrdHeader(grid),
    ffd::FormatNiftiHeader(grid) };
  using Parser = bool (*)(std::string_view, ffd::FieldHeader&, std::string&);
  const Parser parsers[] = { ffd::ParseMetaImageHeader, ffd::ParseMetaImageHeader,
    ffd::ParseNrrdHeader, ffd::ParseNiftiHeader };
  for (std::size_t i = 0; i < 4; ++i)
  {
    ffd::FieldHeader header;
    std::string error;
    ASSERT_TRUE(parsers[i](texts[i], header, error)) << i << ": " << error;
    EXPECT_EQ(header.Grid.Size, grid.Size);
    EXPECT_EQ(header.Grid.Origin, grid.Origin) << i;
    EXPECT_EQ(header.Grid.Spacing, grid.Spacing) << i;
    EXPECT_EQ(header.Grid.Direction, grid.Direction) << i;
    EXPECT_EQ(header.DataFile, i == 1 ? "data.raw" : "");
    EXPECT_EQ(header.Offset, i == 1 ? 0 : texts[i].size());
    EXPECT_EQ(header.GetDataSize(), 7u * 8u * 9u * 24u);
    EXPECT_EQ(header.Planar, i == 3);
  }
}

TEST(TransformFile, AxesOfNrrdTellWhereTheyBegin)
{
  const glm::dvec3 spacing(2.0, 3.0, 4.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto find = [&spacing](
                      const std::vector<double>& mins, const char* centers, std::size_t first) {
    return ffd::FindNrrdOrigin(mins, centers, first, spacing);
  };
  EXPECT_EQ(find({ 10.0, 20.0, 30.0 }, "", 0), glm::dvec3(11.0, 21.5, 32.0));
  EXPECT_EQ(find({ 10.0, 20.0, 30.0 }, "node Cell NODE", 0), glm::dvec3(10.0, 21.5, 30.0));
  EXPECT_EQ(find({ nan, 10.0, nan, 30.0 }, "none node", 1), glm::dvec3(10.0, 0.0, 32.0));
  EXPECT_EQ(find({ 10.0, 20.0, 30.0, 40.0 }, "", 0), glm::dvec3(11.0, 21.5, 32.0));
  EXPECT_EQ(find({ 10.0, 20.0, 30.0 }, "", 1), glm::dvec3(0.0));
  EXPECT_EQ(find({}, "node", 0), glm::dvec3(0.0));

  for (const char* name : { "axis mins", "AxisMins", "AXIS MINS" })
  {
    EXPECT_EQ(ffd::FindNrrdField(name), "axis mins");
  }
  EXPECT_EQ(ffd::FindNrrdField("Centerings"), "centers");
  for (const char* name : { "", " ", "axis  mins", "axismin", "space orgin", "center" })
  {
    EXPECT_EQ(ffd::FindNrrdField(name), "") << name;
  }
}

TEST(TransformFile, NumbersOfEveryTypeAndByteOrder)
{
  using Number = ffd::FieldHeader::Number;
  ffd::FieldHeader header;
  header.Grid.Size = glm::ivec3(1);
  const auto decode = [&header](Number type, bool big, std::initializer_list<int> bytes) {
    header.Type = type;
    header.BigEndian = big;
    std::vector<unsigned char> data;
    for (int i = 0; i < 3; ++i)
    {
      for (const int byte : bytes)
      {
        data.push_back(static_cast<unsigned char>(byte));
      }
    }
    EXPECT_EQ(data.size(), header.GetDataSize());
    TransformStep step;
    std::string error;
    EXPECT_TRUE(ffd::DecodeField(header, data.data(), step, error)) << error;
    return step.Values.at(0).z;
  };
  EXPECT_EQ(decode(Number::Int8, false, { 0xfe }), -2.0);
  EXPECT_EQ(decode(Number::UInt8, false, { 0xfe }), 254.0);
  EXPECT_EQ(decode(Number::Int16, false, { 0xfe, 0xff }), -2.0);
  EXPECT_EQ(decode(Number::Int16, true, { 0x01, 0x02 }), 258.0);
  EXPECT_EQ(decode(Number::UInt16, false, { 0x01, 0xff }), 65281.0);
  EXPECT_EQ(decode(Number::Int32, true, { 0xff, 0xff, 0xff, 0xfd }), -3.0);
  EXPECT_EQ(decode(Number::UInt32, false, { 0, 0, 0, 0x80 }), 2147483648.0);
  EXPECT_EQ(decode(Number::Float32, false, { 0, 0, 0xc0, 0xbf }), -1.5);
  EXPECT_EQ(decode(Number::Float64, true, { 0xbf, 0xf8, 0, 0, 0, 0, 0, 0 }), -1.5);
  header.Slope = 2.0;
  header.Intercept = 1.0;
  EXPECT_EQ(decode(Number::UInt8, false, { 7 }), 15.0);
}

TEST(TransformFile, TurningToRasIsConjugation)
{
  for (const glm::dmat3& direction : { glm::dmat3(1.0), Permuted })
  {
    const TransformStep step = MakeSpline(4, direction);
    TransformStep turned = step;
    ffd::FlipTransformStep(turned);
    const glm::dvec3 flip(-1.0, -1.0, 1.0);
    for (double t = 0.05; t < 1.0; t += 0.3)
    {
      const glm::dvec3 p = PointOf(step, t, 1.0 - t, 0.5);
      EXPECT_LT(Difference(Apply(turned, flip * p), flip * Apply(step, p)), 1e-13);
    }
    TransformStep back = turned;
    ffd::FlipTransformStep(back);
    ExpectSame(back, step);
  }
}

TEST(TransformFile, AligningKeepsTheMap)
{
  TransformStep step = MakeSpline(5, Permuted);
  TransformStep aligned = step;
  ASSERT_TRUE(ffd::AlignTransformStep(aligned));
  EXPECT_EQ(aligned.Grid.Direction, glm::dmat3(1.0));
  EXPECT_EQ(aligned.Grid.Size, glm::ivec3(4, 6, 5));
  for (double t = 0.05; t < 1.0; t += 0.3)
  {
    const glm::dvec3 p = PointOf(step, t, 0.5, 1.0 - t);
    EXPECT_LT(Difference(Apply(aligned, p), Apply(step, p)), 1e-12);
  }
  step.Grid.Direction = glm::dmat3(0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0);
  EXPECT_FALSE(ffd::AlignTransformStep(step));
}

TEST(TransformFile, SumsAreSumsOfDisplacements)
{
  TransformStep linear;
  linear.Matrix = glm::dmat3(1.1, 0.2, -0.3, 0.4, 0.9, 0.3, 0.0, 0.1, 1.2);
  linear.Offset = { 1.0, -2.0, 3.0 };
  const TransformStep spline = MakeSpline(6, Permuted);
  for (const bool splineFirst : { false, true })
  {
    TransformStep sum = splineFirst ? spline : linear;
    ASSERT_TRUE(ffd::AddTransformStep(sum, splineFirst ? linear : spline));
    EXPECT_TRUE(sum.IsSum);
    for (double t = 0.05; t < 1.0; t += 0.3)
    {
      const glm::dvec3 p = PointOf(spline, 0.5, t, 1.0 - t);
      EXPECT_LT(Difference(Apply(sum, p), Apply(spline, p) + Apply(linear, p) - p), 1e-12);
    }
  }
  TransformStep two = linear;
  ASSERT_TRUE(ffd::AddTransformStep(two, linear));
  const glm::dvec3 p(1.0, 2.0, 3.0);
  EXPECT_LT(Difference(Apply(two, p), 2.0 * Apply(linear, p) - p), 1e-13);
  TransformStep splines = spline;
  ASSERT_TRUE(ffd::AddTransformStep(splines, spline));
  EXPECT_EQ(splines.Values[7], 2.0 * spline.Values[7]);
  TransformStep elsewhere = MakeSpline(6, glm::dmat3(1.0));
  EXPECT_FALSE(ffd::AddTransformStep(elsewhere, spline));
}

TEST(TransformFile, CorpusOfTheFuzzerKeepsEveryPromise)
{
  const char* data = std::getenv("FFD_TEST_DATA");
  ASSERT_NE(data, nullptr);
  int files = 0;
  int taken = 0;
  for (const char* folder : { "Fuzz", "Transforms" })
  {
    for (const auto& entry :
      std::filesystem::directory_iterator(std::filesystem::path(data) / folder))
    {
      if (!entry.is_regular_file())
      {
        continue; // __pycache__
      }
      std::ifstream stream(entry.path(), std::ios::binary);
      const std::string bytes{ std::istreambuf_iterator<char>(stream), {} };
      SCOPED_TRACE(entry.path().string());
      taken += FFDFuzzTransformFile(bytes);
      // Truncated anywhere, it is as well behaved.
      for (std::size_t cut = 1; cut < bytes.size(); cut += 1 + bytes.size() / 16)
      {
        FFDFuzzTransformFile(std::string_view(bytes).substr(0, cut));
      }
      ++files;
    }
  }
  EXPECT_GT(files, 50);
  EXPECT_GT(taken, 30);
}

} // namespace
