// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDTransformReader and vtkFFDTransformWriter: every format there and back, with decimal commas
// too, and hostile files.
#include "FFDTestHelpers.h"

#include "vtkAbstractTransform.h"
#include "vtkCallbackCommand.h"
#include "vtkFFDTransformReader.h"
#include "vtkFFDTransformWriter.h"
#include "vtkFFDVolumeReader.h"
#include "vtkImageData.h"
#include "vtkTesting.h"

#include "vtksys/Directory.hxx"
#include "vtksys/SystemTools.hxx"

#include <algorithm>
#include <fstream>
#include <functional>
#include <future>
#include <iterator>
#include <locale>
#include <string>
#include <utility>

namespace
{

/// Largest difference of two transforms at points of the lattice's domain.
double Difference(vtkFFDLattice* lattice, vtkAbstractTransform* other)
{
  FFDRandom random(8);
  double largest = 0.0;
  for (int i = 0; i < 200; ++i)
  {
    double p[3];
    double a[3];
    double b[3];
    random.Point(lattice, -0.01, p);
    lattice->TransformPoint(p, a);
    other->TransformPoint(p, b);
    largest = std::max(largest, FFDDistance(a, b));
  }
  return largest;
}

int CheckFormats(const std::string& folder)
{
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(6, 5, 7);
  lattice->SetDomain(-3.0, 27.0, 10.0, 30.0, 5.0, 25.0);
  FFDRandom(3).Shape(lattice, 0.3);
  vtkNew<vtkImageData> grid;
  grid->SetDimensions(61, 41, 41);
  grid->SetOrigin(-3.0, 10.0, 5.0);
  grid->SetSpacing(0.5, 0.5, 0.5);
  struct Case
  {
    const char* Name;
    double Tolerance;
    const char* Format;
  };
  // Fields are interpolated linearly between samples.
  for (const Case& test : { Case{ "io.tfm", 1e-12, "ItkText" },
         Case{ "TransformParameters.io.txt", 1e-12, "Elastix" }, Case{ "io.vti", 1e-12, "Lattice" },
         Case{ "io.mha", 0.02, "MetaImage" }, Case{ "io.mhd", 0.02, "MetaImage" },
         Case{ "io.nrrd", 0.02, "NRRD" }, Case{ "io.nii", 0.02, "NIfTI" } })
  {
    for (int coordinates = 0; coordinates < 2; ++coordinates)
    {
      const std::string name = folder + "/" + test.Name;
      vtkNew<vtkFFDTransformWriter> writer;
      writer->SetFileName(name.c_str());
      writer->SetTransform(lattice);
      writer->SetReferenceImage(grid);
      writer->SetCoordinates(coordinates);
      FFD_CHECK(writer->Write() == 1);
      vtkNew<vtkFFDTransformReader> reader;
      reader->SetFileName(name.c_str());
      reader->SetCoordinates(coordinates);
      vtkAbstractTransform* transform = reader->GetTransform();
      FFD_CHECK(transform != nullptr);
      FFD_CHECK(std::string(reader->GetFileFormatAsString()) == test.Format);
      FFD_CHECK(Difference(lattice, transform) <= test.Tolerance);
      // The lattice: the same, or fitted to the field.
      reader->SetFitTolerance(0.05);
      FFD_CHECK(reader->GetLattice() != nullptr && reader->GetLatticeError() <= 0.05);
      FFD_CHECK(Difference(lattice, reader->GetLattice()) <= test.Tolerance + 0.1);
    }
  }
  return EXIT_SUCCESS;
}

int CheckHostileFiles(const std::string& data, const std::string& folder)
{
  int files = 0;
  for (const char* sub : { "Fuzz", "Transforms" })
  {
    vtksys::Directory directory;
    FFD_CHECK(static_cast<bool>(directory.Load(data + "/" + sub)));
    for (unsigned long i = 0; i < directory.GetNumberOfFiles(); ++i)
    {
      const std::string name = data + "/" + sub + "/" + directory.GetFile(i);
      if (vtksys::SystemTools::FileIsDirectory(name))
      {
        continue;
      }
      std::ifstream stream(name, std::ios::binary);
      const std::string bytes{ std::istreambuf_iterator<char>(stream), {} };
      // Whole, and cut off at a few places.
      for (int part = 4; part >= 1; --part)
      {
        const std::string path = folder + "/hostile";
        std::ofstream out(path, std::ios::binary | std::ios::trunc);
        out.write(bytes.data(), static_cast<std::streamsize>(bytes.size() * part / 4));
        out.close();
        vtkNew<vtkFFDTransformReader> reader;
        vtkNew<FFDErrorLog> log;
        log->Watch(reader);
        reader->SetFileName(path.c_str());
        vtkAbstractTransform* transform = reader->GetTransform();
        FFD_CHECK((transform == nullptr) == (log->Count == 1));
        if (transform)
        {
          double p[3] = { 1.0, 2.0, 3.0 };
          transform->TransformPoint(p, p);
          FFD_CHECK(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]));
        }
        ++files;
      }
    }
  }
  FFD_CHECK(files > 400);
  return EXIT_SUCCESS;
}

/// Numbers as in German: 1.024,5.
class CommaNumbers : public std::numpunct<char>
{
protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

/// Sets the locale of C++ streams for the time of its life.
class CommaLocale
{
public:
  CommaLocale() { std::locale::global(std::locale(std::locale::classic(), new CommaNumbers)); }
  ~CommaLocale() { std::locale::global(std::locale::classic()); }
};

char GetDecimalPoint()
{
  return std::use_facet<std::numpunct<char>>(std::locale()).decimal_point();
}

int CheckLocale(const std::string& folder)
{
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(12, 11, 10);
  lattice->SetDomain(-3.5, 2701.25, 10.0, 3000.5, 5.0, 2500.0);
  FFDRandom(3).Shape(lattice, 0.3);
  const auto write = [&](const std::string& name) {
    vtkNew<vtkFFDTransformWriter> writer;
    writer->SetFileName(name.c_str());
    writer->SetTransform(lattice);
    return writer->Write() == 1;
  };
  const auto reads = [&](const std::string& name) {
    vtkNew<vtkFFDTransformReader> reader;
    reader->SetFileName(name.c_str());
    vtkAbstractTransform* transform = reader->GetTransform();
    return transform && Difference(lattice, transform) < 1e-9;
  };
  const std::string image = folder + "/locale.mha";
  std::ofstream(image, std::ios::binary)
    << "ObjectType = Image\nNDims = 3\nOffset = 1.5 2500.25 -3.5\nElementSpacing = 0.5 1.25 2.5\n"
       "DimSize = 1200 2 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    << std::string(4800, 'x');
  const std::string ours = folder + "/locale-ours.vti";
  const std::string theirs = folder + "/locale-theirs.vti";
  FFD_CHECK(write(ours));
  {
    const CommaLocale comma;
    FFD_CHECK(reads(ours) && write(theirs) && reads(theirs));
    vtkNew<vtkFFDVolumeReader> reader;
    FFD_CHECK(reader->CanReadFile(image.c_str()) == 1);
    reader->SetFileName(image.c_str());
    reader->Update();
    vtkImageData* read = reader->GetOutput();
    FFD_CHECK(read->GetNumberOfPoints() == 4800);
    FFD_CHECK(read->GetSpacing()[1] == 1.25 && read->GetOrigin()[1] == 2500.25);
    // The program's own locale is there again.
    FFD_CHECK(GetDecimalPoint() == ',');
  }
  FFD_CHECK(reads(theirs));
  return EXIT_SUCCESS;
}

/// One thread reads while another one begins, and is done before that is.
int CheckLocaleOfThreads(const std::string& folder)
{
  const std::string name = folder + "/there-is-none.tfm";
  const CommaLocale comma;
  std::promise<void> begun;
  std::promise<void> done;
  char point = '?';
  // Calls the function once, while it reads: when it tells that it cannot.
  const auto read = [&name](std::function<void()> function) {
    vtkNew<vtkFFDTransformReader> reader;
    reader->SetFileName(name.c_str());
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(&function);
    command->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
      const auto call = std::exchange(*static_cast<std::function<void()>*>(data), nullptr);
      if (call)
      {
        call();
      }
    });
    reader->AddObserver(vtkCommand::ErrorEvent, command);
    return reader->GetTransform() == nullptr;
  };
  std::future<bool> second;
  const bool first = read([&] {
    second = std::async(std::launch::async, read, [&] {
      begun.set_value();
      done.get_future().wait();
      point = GetDecimalPoint();
    });
    begun.get_future().wait();
  });
  done.set_value();
  FFD_CHECK(first && second.valid() && second.get());
  FFD_CHECK(point == '.');
  FFD_CHECK(GetDecimalPoint() == ',');
  return EXIT_SUCCESS;
}

} // namespace

int TestTransformIO(int argc, char* argv[])
{
  vtkNew<vtkTesting> testing;
  testing->AddArguments(argc, argv);
  const std::string folder = testing->GetTempDirectory();
  const std::string data = testing->GetDataRoot();
  if (CheckFormats(folder) != EXIT_SUCCESS || CheckLocale(folder) != EXIT_SUCCESS ||
    CheckLocaleOfThreads(folder) != EXIT_SUCCESS || CheckHostileFiles(data, folder) != EXIT_SUCCESS)
  {
    return EXIT_FAILURE;
  }
  vtkNew<vtkFFDTransformWriter> writer;
  vtkNew<FFDErrorLog> log;
  log->Watch(writer);
  FFD_CHECK(writer->Write() == 0 && log->Had("SetTransform"));
  return EXIT_SUCCESS;
}
