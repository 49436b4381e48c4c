// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// A lattice survives files, as field data of a volume and as an image of its own; malformed field
// data is refused with its reason.
#include "FFDTestHelpers.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkTestUtilities.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLImageDataWriter.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace
{

bool Same(vtkFFDLattice* a, vtkFFDLattice* b, double tolerance)
{
  int na[3];
  int nb[3];
  a->GetDimensions(na);
  b->GetDimensions(nb);
  if (!std::equal(na, na + 3, nb) || a->GetBorderMode() != b->GetBorderMode() ||
    a->GetInverseFlag() != b->GetInverseFlag() ||
    std::abs(a->GetDisplacementScale() - b->GetDisplacementScale()) > tolerance)
  {
    return false;
  }
  for (vtkIdType i = 0; i < a->GetDisplacements()->GetNumberOfValues(); ++i)
  {
    if (!(std::abs(a->GetDisplacements()->GetValue(i) - b->GetDisplacements()->GetValue(i)) <=
          tolerance))
    {
      return false;
    }
  }
  FFDRandom random(8);
  for (int i = 0; i < 50; ++i)
  {
    double p[3];
    double qa[3];
    double qb[3];
    random.Point(a, 2.0, p);
    a->TransformPoint(p, qa);
    b->TransformPoint(p, qb);
    // The inverse is solved to its tolerance only.
    if (!(FFDDistance(qa, qb) <= 100.0 * tolerance + (a->GetInverseFlag() ? 1e-5 : 0.0)))
    {
      return false;
    }
  }
  return true;
}

int TestFiles(const std::string& folder)
{
  FFDRandom random(9);
  for (int mode = 0; mode < 3; ++mode)
  {
    vtkNew<vtkFFDLattice> lattice;
    lattice->SetDimensions(5, 4, 6);
    lattice->SetDomain(-1.0, 6.0, 3.0, 8.0, 0.1, 7.3);
    lattice->SetBorderMode(mode);
    lattice->SetDisplacementScale(0.75 + mode);
    random.Shape(lattice, 0.1);
    if (mode == 1)
    {
      lattice->Inverse();
    }
    vtkNew<vtkImageData> volume;
    volume->SetDimensions(7, 6, 5);
    volume->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    volume->GetPointData()->GetScalars()->Fill(9.0);
    FFD_CHECK(!vtkFFDLattice::HasLattice(volume));
    FFD_CHECK(lattice->AttachTo(volume) == 1);
    FFD_CHECK(vtkFFDLattice::HasLattice(volume));
    FFD_CHECK(volume->GetFieldData()->GetNumberOfArrays() == 8);
    // Again: replaced, not added.
    FFD_CHECK(lattice->AttachTo(volume) == 1);
    FFD_CHECK(volume->GetFieldData()->GetNumberOfArrays() == 8);
    vtkNew<vtkImageData> own;
    FFD_CHECK(lattice->ToImageData(own) == 1);

    for (const int format : { vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended })
    {
      // ASCII files of VTK carry 11 or more digits.
      const double tolerance = format == vtkXMLWriter::Ascii ? 1e-9 : 0.0;
      for (vtkImageData* image : { volume.Get(), own.Get() })
      {
        const std::string name = folder + "/TestFFDLatticeIO.vti";
        vtkNew<vtkXMLImageDataWriter> writer;
        writer->SetFileName(name.c_str());
        writer->SetInputData(image);
        writer->SetDataMode(format);
        FFD_CHECK(writer->Write() == 1);
        vtkNew<vtkXMLImageDataReader> reader;
        reader->SetFileName(name.c_str());
        reader->Update();
        vtkNew<vtkFFDLattice> read;
        if (image == volume)
        {
          FFD_CHECK(vtkFFDLattice::HasLattice(reader->GetOutput()));
          FFD_CHECK(read->ReadFrom(reader->GetOutput()) == 1);
        }
        else
        {
          FFD_CHECK(read->FromImageData(reader->GetOutput()) == 1);
        }
        FFD_CHECK(Same(lattice, read, tolerance));
        vtkNew<vtkFFDLattice> connected;
        if (image == own)
        {
          connected->SetCoefficientConnection(reader->GetOutputPort());
          FFD_CHECK(Same(lattice, connected, tolerance));
        }
      }
    }
    // What is attached is a copy: an edit after it does not reach it.
    lattice->SetDisplacement(2, 2, 2, 1.0, 1.0, 1.0);
    vtkNew<vtkFFDLattice> attached;
    FFD_CHECK(attached->ReadFrom(volume) == 1);
    FFD_CHECK(!Same(lattice, attached, 0.0));
    vtkFFDLattice::DetachFrom(volume);
    FFD_CHECK(!vtkFFDLattice::HasLattice(volume));
    FFD_CHECK(volume->GetFieldData()->GetNumberOfArrays() == 0);
  }
  // Any data object will do.
  vtkNew<vtkPolyData> mesh;
  vtkNew<vtkFFDLattice> lattice;
  vtkNew<vtkFFDLattice> read;
  FFD_CHECK(lattice->AttachTo(mesh) == 1 && read->ReadFrom(mesh) == 1);
  return EXIT_SUCCESS;
}

int TestMalformed()
{
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(5, 4, 6);
  lattice->SetDisplacement(1, 1, 1, 0.1, 0.2, 0.3);
  const auto number = [](vtkImageData* image, const char* name, int index, double value) {
    vtkDataArray* array = image->GetFieldData()->GetArray(name);
    array->SetComponent(
      index / array->GetNumberOfComponents(), index % array->GetNumberOfComponents(), value);
  };
  const auto remove = [](vtkImageData* image, const char* name) {
    image->GetFieldData()->RemoveArray(name);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case
  {
    const char* Message;
    std::function<void(vtkImageData*)> Break;
  };
  const Case cases[] = {
    { "FFDLattice.Version is missing", [&](vtkImageData* i) { remove(i, "FFDLattice.Version"); } },
    { "its version is 2", [&](vtkImageData* i) { number(i, "FFDLattice.Version", 0, 2); } },
    { "FFDLattice.Dimensions is missing",
      [&](vtkImageData* i) { remove(i, "FFDLattice.Dimensions"); } },
    { "axis 1 has 3", [&](vtkImageData* i) { number(i, "FFDLattice.Dimensions", 1, 3); } },
    { "axis 0 has 2000000", [&](vtkImageData* i) { number(i, "FFDLattice.Dimensions", 0, 2e6); } },
    { "120 displacements for 150",
      [&](vtkImageData* i) { number(i, "FFDLattice.Dimensions", 1, 5); } },
    { "FFDLattice.Origin is missing", [&](vtkImageData* i) { remove(i, "FFDLattice.Origin"); } },
    { "FFDLattice.Origin is not finite",
      [&](vtkImageData* i) { number(i, "FFDLattice.Origin", 2, nan); } },
    { "spacing positive", [&](vtkImageData* i) { number(i, "FFDLattice.Spacing", 0, 0.0); } },
    { "spacing positive", [&](vtkImageData* i) { number(i, "FFDLattice.Spacing", 1, -1.0); } },
    { "the border mode is 3", [&](vtkImageData* i) { number(i, "FFDLattice.BorderMode", 0, 3); } },
    { "FFDLattice.Inverse is missing", [&](vtkImageData* i) { remove(i, "FFDLattice.Inverse"); } },
    { "FFDLattice.DisplacementScale is not finite",
      [&](vtkImageData* i) { number(i, "FFDLattice.DisplacementScale", 0, nan); } },
    { "FFDLattice.Displacement is missing",
      [&](vtkImageData* i) { remove(i, "FFDLattice.Displacement"); } },
    { "control point 7 is not finite",
      [&](vtkImageData* i) { number(i, "FFDLattice.Displacement", 22, nan); } },
    { "has 2 values, not 3",
      [&](vtkImageData* i) {
        vtkNew<vtkDoubleArray> two;
        two->SetName("FFDLattice.Origin");
        two->SetNumberOfTuples(2);
        two->Fill(0.0);
        i->GetFieldData()->AddArray(two);
      } },
    { "holds no integer",
      [&](vtkImageData* i) {
        vtkNew<vtkFloatArray> half;
        half->SetName("FFDLattice.BorderMode");
        half->InsertNextValue(0.5f);
        i->GetFieldData()->AddArray(half);
      } },
    { "has not 3 components",
      [&](vtkImageData* i) {
        i->GetFieldData()->GetArray("FFDLattice.Displacement")->SetNumberOfComponents(1);
      } },
  };
  for (const Case& c : cases)
  {
    vtkNew<vtkImageData> image;
    FFD_CHECK(lattice->AttachTo(image) == 1);
    c.Break(image);
    vtkNew<vtkFFDLattice> read;
    read->SetDisplacement(2, 2, 2, 5.0, 5.0, 5.0);
    vtkNew<FFDErrorLog> log;
    log->Watch(read);
    const vtkMTimeType time = read->GetMTime();
    FFD_CHECK(read->ReadFrom(image) == 0);
    FFD_CHECK(log->Had(c.Message));
    FFD_CHECK(read->GetMTime() == time && read->GetNumberOfControlPoints() == 64);
  }
  // No lattice at all is said plainly.
  vtkNew<vtkImageData> none;
  vtkNew<FFDErrorLog> log;
  log->Watch(lattice);
  FFD_CHECK(lattice->ReadFrom(none) == 0);
  FFD_CHECK(log->Had("vtkImageData"));
  return EXIT_SUCCESS;
}

} // namespace

int TestFFDLatticeIO(int argc, char* argv[])
{
  char* folder = vtkTestUtilities::GetArgOrEnvOrDefault(
    "-T", argc, argv, "FFD_TEST_TEMPORARY", "Testing/Temporary");
  const std::string path = folder;
  delete[] folder;
  return TestFiles(path) || TestMalformed() ? EXIT_FAILURE : EXIT_SUCCESS;
}
