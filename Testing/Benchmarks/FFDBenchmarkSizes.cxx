// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBenchmarkSizes.h"

#include "FFDBenchmarkScene.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace ffdBenchmark
{

namespace
{

/// Air of 0 to 15, a ball of 120 to 135.
template <class T>
void Fill(T* scalars, int side)
{
  std::uint32_t random = 1;
  const double radius = 0.3 * side;
  for (int k = 0; k < side; ++k)
  {
    for (int j = 0; j < side; ++j)
    {
      const double y = j - 0.5 * side;
      const double z = k - 0.5 * side;
      const double half = std::sqrt(std::max(0.0, radius * radius - y * y - z * z));
      for (int i = 0; i < side; ++i)
      {
        random = random * 1664525u + 1013904223u;
        const bool ball = half > 0.0 && std::abs(i - 0.5 * side) < half;
        *scalars++ = static_cast<T>((random >> 28) + (ball ? 120u : 0u));
      }
    }
  }
}

vtkSmartPointer<vtkImageData> MakeVolume(const SizedVolume& volume)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(volume.Side, volume.Side, volume.Side);
  image->AllocateScalars(volume.ScalarType, 1);
  switch (volume.ScalarType)
  {
    vtkTemplateMacro(Fill(static_cast<VTK_TT*>(image->GetScalarPointer()), volume.Side));
  }
  return image;
}

struct KeptSizes
{
  explicit KeptSizes(vtkImageData* image)
    : View(512, image)
    , Image(image)
  {
  }
  Stage View;
  vtkNew<vtkImageData> Tiny;
  vtkSmartPointer<vtkImageData> Image;
  vtkNew<vtkFFDLattice> Lattice;
  std::vector<char> Copy;
};

struct KeptErrors
{
  explicit KeptErrors(vtkImageData* image)
    : View(256, image)
  {
  }
  Stage View;
  vtkNew<vtkFFDLattice> Lattice;
};

/// From 0 to opaque over two steps of the scalars.
vtkSmartPointer<vtkVolumeProperty> MakeStep(double value)
{
  auto property = MakeProperty(Opacity::Opaque);
  property->GetScalarOpacity()->RemoveAllPoints();
  property->GetScalarOpacity()->AddPoint(value - 1.0, 0.0);
  property->GetScalarOpacity()->AddPoint(value + 1.0, 0.9);
  return property;
}

double BendOf(vtkImageData* image)
{
  double bounds[6];
  image->GetBounds(bounds);
  return 45.0 / 255.0 * (bounds[1] - bounds[0]);
}

} // namespace

//------------------------------------------------------------------------------
const std::vector<SizedVolume>& GetSizedVolumes()
{
  static const std::vector<SizedVolume> volumes = { { "128/8 bit", 128, VTK_UNSIGNED_CHAR },
    { "512/8 bit", 512, VTK_UNSIGNED_CHAR }, { "512/16 bit", 512, VTK_UNSIGNED_SHORT },
    { "512/float", 512, VTK_FLOAT }, { "1290/8 bit", 1290, VTK_UNSIGNED_CHAR } };
  return volumes;
}

//------------------------------------------------------------------------------
std::shared_ptr<void> PrepareSizes(Group& group, const SizedVolume& volume)
{
  const auto image = MakeVolume(volume);
  auto kept = std::make_shared<KeptSizes>(image);
  KeptSizes* const k = kept.get();
  Deform(k->Lattice, image, { Shape::Smooth, BendOf(image) });
  const auto property = MakeProperty(Opacity::Opaque);
  const auto mapper = MakeMapper(image, nullptr, Variant::Exact);
  vtkVolume* const tiny = k->View.AddVolume(mapper, property);
  for (Row& row : group.GetRows())
  {
    if (row.Name == "copy")
    {
      const vtkDataArray* const scalars = image->GetPointData()->GetScalars();
      const std::size_t size = static_cast<std::size_t>(scalars->GetDataSize()) *
        static_cast<std::size_t>(scalars->GetDataTypeSize());
      k->Copy.resize(size);
      row.Run = [k, size] { std::memcpy(k->Copy.data(), k->Image->GetScalarPointer(), size); };
      continue;
    }
    if (row.Name == "first" || row.Name == "second")
    {
      if (row.Name == "first")
      {
        row.Before = [k] {
          k->Image->GetPointData()->GetScalars()->Modified();
          k->Image->Modified();
        };
      }
      row.Run = [k, mapper, tiny] {
        mapper->RenderToImage(k->View.GetRenderer(), tiny, 16, 16, k->Tiny);
      };
    }
    else
    {
      vtkFFDLattice* const lattice = row.Name == "bend45" ? k->Lattice.Get() : nullptr;
      vtkVolume* const shown =
        k->View.AddVolume(MakeMapper(image, lattice, Variant::Exact), property);
      row.Run = [k, shown] { k->View.Draw(shown); };
      // The scalars may be new since the last round.
      row.Before = row.Run;
    }
    row.Run();
  }
  return kept;
}

//------------------------------------------------------------------------------
std::shared_ptr<void> PrepareErrors(
  Group& group, const std::string& folder, const std::string& volumeName)
{
  const auto image = ReadVolume(folder, volumeName);
  auto kept = std::make_shared<KeptErrors>(image);
  KeptErrors* const k = kept.get();
  Deform(k->Lattice, image, { Shape::Smooth, BendOf(image) });
  const auto property = MakeStep(volumeName == "engine" ? 80.0 : 50.0);
  const auto add = [&](double distance, bool intervals) {
    const auto mapper = MakeMapper(image, k->Lattice, Variant::Exact);
    mapper->SetSampleDistance(distance);
    intervals ? mapper->SetClassificationToPreIntegrated()
              : mapper->SetClassificationToPostInterpolated();
    return k->View.AddVolume(mapper, property);
  };
  const auto best = k->View.DrawAndCapture(add(0.05, false));
  for (Row& row : group.GetRows())
  {
    const bool fine = row.Name == "samples 0.25";
    vtkVolume* const shown = add(fine ? 0.25 : 1.0, row.Name == "intervals 1");
    const Difference difference =
      Compare(k->View.DrawAndCapture(shown), best, k->View.GetSize(), 1);
    row.Counters["mean_error"] = difference.Mean;
    row.Run = [k, shown] { k->View.Draw(shown); };
  }
  return kept;
}

} // namespace ffdBenchmark
