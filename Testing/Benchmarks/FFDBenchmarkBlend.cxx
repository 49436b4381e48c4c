// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBenchmarkBlend.h"

#include "FFDBenchmarkScene.h"
#include "FFDBenchmarkSuites.h"

#include "vtkColorTransferFunction.h"
#include "vtkContourValues.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDRayStatistics.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkOpenGLGPUVolumeRayCastMapper.h"
#include "vtkPiecewiseFunction.h"
#include "vtkSmartPointer.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <cstdio>

namespace ffdBenchmark
{

namespace
{

/// Where the engine's surface is.
constexpr double IsoLevel = 100.0;

/// The volume and, as a second component, its mirror image.
vtkSmartPointer<vtkImageData> MakeTwoComponents(vtkImageData* image)
{
  auto two = vtkSmartPointer<vtkImageData>::New();
  two->CopyStructure(image);
  two->AllocateScalars(VTK_UNSIGNED_CHAR, 2);
  int dims[3];
  image->GetDimensions(dims);
  const auto* in = static_cast<const unsigned char*>(image->GetScalarPointer());
  auto* out = static_cast<unsigned char*>(two->GetScalarPointer());
  const vtkIdType rows = static_cast<vtkIdType>(dims[1]) * dims[2];
  for (vtkIdType row = 0; row < rows; ++row, in += dims[0])
  {
    for (int i = 0; i < dims[0]; ++i)
    {
      *out++ = in[i];
      *out++ = in[dims[0] - 1 - i];
    }
  }
  return two;
}

/// Functions of the second component as those of the first, and a gradient opacity.
void SetUpProperty(vtkVolumeProperty* property, BlendRows rows)
{
  if (rows == BlendRows::TwoComponents)
  {
    vtkNew<vtkColorTransferFunction> blue;
    blue->AddRGBPoint(70.0, 0.2, 0.3, 0.9);
    blue->AddRGBPoint(255.0, 0.7, 0.9, 1.0);
    property->SetColor(1, blue);
    property->SetScalarOpacity(1, property->GetScalarOpacity(0));
    property->SetShade(1, property->GetShade(0));
  }
  else if (rows == BlendRows::GradientOpacity)
  {
    vtkNew<vtkPiecewiseFunction> gradients;
    gradients->AddPoint(5.0, 0.0);
    gradients->AddPoint(40.0, 1.0);
    property->SetGradientOpacity(gradients);
  }
}

struct BlendScene
{
  BlendScene(vtkSmartPointer<vtkImageData> image, int size, BlendRows rows)
    : Image(image)
    , View(size, image)
    , Property(MakeProperty(Opacity::Opaque))
  {
    SetUpProperty(this->Property, rows);
    Deform(this->Still, image, { Shape::Identity, 0.0 });
    Deform(this->Deformed, image, { Shape::Smooth, 45.0 });
    this->Property->GetIsoSurfaceValues()->SetValue(0, IsoLevel);
  }

  vtkSmartPointer<vtkImageData> Image;
  vtkNew<vtkFFDLattice> Still;
  vtkNew<vtkFFDLattice> Deformed;
  Stage View;
  vtkSmartPointer<vtkVolumeProperty> Property;
};

void Judge(Row& row, const Stage& stage, vtkUnsignedCharArray* picture,
  vtkUnsignedCharArray* expected, const Tolerance& tolerance, const char* oracle)
{
  const Difference d = Compare(picture, expected, stage.GetSize(), tolerance.Block);
  row.Counters["image_mean_difference"] = d.Mean;
  row.Counters["covered_percent"] = 100.0 * d.Covered;
  if (d.Covered < 0.05 || d.Mean > tolerance.Mean || d.Outliers > tolerance.Outliers)
  {
    char text[200];
    std::snprintf(text, sizeof(text),
      "the picture differs from %s: mean %.2f of 255, outliers %.2f %%, covered %.1f %%", oracle,
      d.Mean, 100.0 * d.Outliers, 100.0 * d.Covered);
    row.Refusal = text;
  }
}

} // namespace

//------------------------------------------------------------------------------
std::shared_ptr<void> PrepareBlend(
  Group& group, BlendRows rows, int size, const std::string& folder)
{
  vtkSmartPointer<vtkImageData> image = ReadVolume(folder, "engine");
  if (rows == BlendRows::TwoComponents)
  {
    image = MakeTwoComponents(image);
  }
  auto scene = std::make_shared<BlendScene>(image, size, rows);
  BlendScene* s = scene.get();
  const int mode = rows == BlendRows::Mip ? vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND
    : rows == BlendRows::Isosurface       ? vtkVolumeMapper::ISOSURFACE_BLEND
                                          : vtkVolumeMapper::COMPOSITE_BLEND;
  vtkSmartPointer<vtkUnsignedCharArray> theirs;
  const auto addVtk = [&](const char* name, vtkVolumeMapper* mapper) {
    mapper->SetInputDataObject(s->Image);
    mapper->SetBlendMode(mode);
    vtkVolume* volume = s->View.AddVolume(mapper, s->Property);
    theirs = s->View.DrawAndCapture(volume);
    if (Row* row = group.FindRow(name))
    {
      row->Run = [s, volume] { s->View.Draw(volume); };
    }
  };
  // The last one is what our picture is compared with.
  vtkNew<vtkOpenGLGPUVolumeRayCastMapper> gpu;
  gpu->AutoAdjustSampleDistancesOff();
  gpu->SetSampleDistance(1.0f);
  if (mode == vtkVolumeMapper::COMPOSITE_BLEND)
  {
    addVtk("fixedpoint", MakeFixedPointMapper());
    addVtk("gpu", gpu);
  }
  else
  {
    if (rows == BlendRows::Mip)
    {
      addVtk("fixedpoint", MakeFixedPointMapper());
    }
    addVtk("gpu", gpu);
  }

  for (const bool deformed : { false, true })
  {
    vtkFFDLattice* lattice = deformed ? s->Deformed : s->Still;
    auto oracle = MakeOracle(s->Image, lattice, Variant::Exact);
    oracle->SetBlendMode(mode);
    vtkVolume* oracleVolume = s->View.AddVolume(oracle, s->Property);
    const auto expected = s->View.DrawAndCapture(oracleVolume);
    Row* row = group.FindRow(deformed ? "exact" : "identity");
    if (!row)
    {
      continue;
    }
    auto mapper = MakeMapper(s->Image, lattice, Variant::Exact);
    mapper->SetBlendMode(mode);
    vtkVolume* volume = s->View.AddVolume(mapper, s->Property);
    mapper->CollectStatisticsOn();
    const auto picture = s->View.DrawAndCapture(volume);
    vtkFFDRayStatistics* statistics = mapper->GetStatistics();
    row->Counters["samples_per_ray"] = statistics->GetSamplesPerRay();
    row->Counters["lookups_per_ray"] = statistics->GetDistanceLookupsPerRay();
    row->Counters["evaluations_per_ray"] = statistics->GetEvaluationsPerRay();
    row->Counters["segment_length"] = statistics->GetAverageSegmentLength();
    mapper->CollectStatisticsOff();
    s->View.Draw(volume);
    Judge(*row, s->View, picture, expected, OracleTolerance, "the reference kernels");
    if (!deformed && row->Refusal.empty())
    {
      Judge(*row, s->View, picture, theirs, BlendTolerance, "VTK's mapper");
    }
    row->Run = [s, volume] { s->View.Draw(volume); };
    Row* reference = group.FindRow("reference");
    if (deformed && reference)
    {
      reference->Run = [s, oracleVolume] { s->View.Draw(oracleVolume); };
    }
  }
  return scene;
}

} // namespace ffdBenchmark
