// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBenchmarkResample.h"

#include "FFDBenchmarkScene.h"

#include "vtkFFDLattice.h"
#include "vtkFFDResampleVolume.h"

#include "vtkAbstractTransform.h"
#include "vtkBSplineTransform.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkImageReslice.h"
#include "vtkPointData.h"

#include <cmath>
#include <cstdio>
#include <vector>

namespace ffdBenchmark
{

namespace
{

constexpr double LargestPartThatDiffers = 1e-3;

struct ResampleScene
{
  vtkSmartPointer<vtkImageData> Image;
  vtkNew<vtkFFDLattice> Lattice;
  vtkNew<vtkImageData> Coefficients;
  vtkNew<vtkBSplineTransform> Spline;
  std::vector<vtkSmartPointer<vtkImageAlgorithm>> Filters;
};

/// Part of the scalars that differ by more than one.
double CountDifferences(vtkImageData* a, vtkImageData* b)
{
  vtkDataArray* x = a->GetPointData()->GetScalars();
  vtkDataArray* y = b->GetPointData()->GetScalars();
  vtkIdType differ = 0;
  for (vtkIdType i = 0; i < x->GetNumberOfTuples(); ++i)
  {
    differ += std::abs(x->GetComponent(i, 0) - y->GetComponent(i, 0)) > 1.0 ? 1 : 0;
  }
  return static_cast<double>(differ) / static_cast<double>(x->GetNumberOfTuples());
}

} // namespace

//------------------------------------------------------------------------------
std::shared_ptr<void> PrepareResample(Group& group, int side, bool cubic, const std::string& folder)
{
  auto scene = std::make_shared<ResampleScene>();
  scene->Image = ResampleToCube(ReadVolume(folder, "engine"), side);
  Deform(scene->Lattice, scene->Image, { Shape::Smooth, 45.0 * side / 256.0 });
  scene->Coefficients->DeepCopy(scene->Lattice->GetCoefficientData());
  scene->Spline->SetCoefficientData(scene->Coefficients);
  scene->Spline->SetBorderMode(scene->Lattice->GetBorderMode());
  int extent[6];
  scene->Image->GetExtent(extent);

  const auto add = [&scene](Row& row, vtkImageAlgorithm* filter) {
    filter->Update();
    scene->Filters.emplace_back(filter);
    row.Counters["voxels"] = static_cast<double>(filter->GetOutput()->GetNumberOfPoints());
    row.Run = [filter] {
      filter->Modified();
      filter->Update();
    };
  };
  vtkImageData* expected[2] = { nullptr, nullptr };
  for (const bool inverse : { false, true })
  {
    if (Row* row = group.FindRow(inverse ? "reslice_inverse" : "reslice"))
    {
      vtkNew<vtkImageReslice> reslice;
      reslice->SetInputData(scene->Image);
      reslice->SetResliceTransform(
        inverse ? scene->Spline->GetInverse() : static_cast<vtkAbstractTransform*>(scene->Spline));
      cubic ? reslice->SetInterpolationModeToCubic() : reslice->SetInterpolationModeToLinear();
      reslice->SetOutputOrigin(scene->Image->GetOrigin());
      reslice->SetOutputSpacing(scene->Image->GetSpacing());
      reslice->SetOutputExtent(extent);
      reslice->BorderOff();
      add(*row, reslice);
      expected[inverse ? 1 : 0] = reslice->GetOutput();
    }
  }
  const struct
  {
    const char* Name;
    int Mode;
    vtkImageData* Expected;
  } ours[] = { { "pullback", vtkFFDResampleVolume::PULL_BACK, expected[0] },
    { "exact", vtkFFDResampleVolume::EXACT, expected[1] },
    { "firstorder", vtkFFDResampleVolume::FIRST_ORDER, nullptr } };
  for (const auto& each : ours)
  {
    Row* row = group.FindRow(each.Name);
    if (!row)
    {
      continue;
    }
    vtkNew<vtkFFDResampleVolume> filter;
    filter->SetInputData(scene->Image);
    filter->SetDeformation(scene->Lattice);
    filter->SetInverseMode(each.Mode);
    cubic ? filter->SetInterpolationModeToCubic() : filter->SetInterpolationModeToLinear();
    filter->SetOutputExtent(extent);
    add(*row, filter);
    if (each.Expected)
    {
      const double differ = CountDifferences(filter->GetOutput(), each.Expected);
      row->Counters["differing_percent"] = 100.0 * differ;
      if (differ > LargestPartThatDiffers)
      {
        char text[128];
        std::snprintf(text, sizeof(text),
          "%.3f %% of the values differ by more than 1 from vtkImageReslice (allowed %.3f %%)",
          100.0 * differ, 100.0 * LargestPartThatDiffers);
        row->Refusal = text;
      }
    }
  }
  return scene;
}

} // namespace ffdBenchmark
