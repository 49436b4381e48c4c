// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDDistanceMap against the search for the nearest visible voxel or block.
#include "FFDTestHelpers.h"

#include "vtkFFDDistanceMap.h"

#include "vtkCallbackCommand.h"
#include "vtkDataArray.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace
{

/// Zero but for a few voxels; extent, spacing, origin and direction of its own.
vtkSmartPointer<vtkImageData> MakeVolume(int type)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(2, 24, -3, 15, 5, 22);
  image->SetSpacing(0.5, 2.0, 1.0);
  image->SetOrigin(7.0, 8.0, 9.0);
  vtkNew<vtkMatrix3x3> direction;
  direction->SetElement(0, 0, 0.6);
  direction->SetElement(0, 1, -0.8);
  direction->SetElement(1, 0, 0.8);
  direction->SetElement(1, 1, 0.6);
  image->SetDirectionMatrix(direction);
  image->AllocateScalars(type, 1);
  image->GetPointData()->GetScalars()->Fill(0.0);
  image->SetScalarComponentFromDouble(6, 1, 9, 0, 100.0);
  image->SetScalarComponentFromDouble(23, 14, 20, 0, 60.0);
  image->SetScalarComponentFromDouble(15, -2, 20, 0, 40.0);
  return image;
}

int TestDistances()
{
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(50.0, 0.0);
  opacity->AddPoint(100.0, 0.5);
  for (const int type : { VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_FLOAT })
  {
    vtkSmartPointer<vtkImageData> image = MakeVolume(type);
    vtkNew<vtkFFDDistanceMap> filter;
    filter->SetInputData(image);
    filter->SetScalarOpacity(opacity);
    filter->SetResolutionToVoxels();
    filter->Update();
    vtkImageData* output = filter->GetOutput();
    FFD_CHECK(output->GetScalarType() == VTK_UNSIGNED_SHORT);
    FFD_CHECK(std::string(output->GetPointData()->GetScalars()->GetName()) == "Distance");
    FFD_CHECK(FFDDistance(output->GetPoint(77), image->GetPoint(77)) == 0.0);
    for (int k = 5; k <= 22; ++k)
    {
      for (int j = -3; j <= 15; ++j)
      {
        for (int i = 2; i <= 24; ++i)
        {
          const int one = std::max({ std::abs(i - 6), std::abs(j - 1), std::abs(k - 9) });
          const int two = std::max({ std::abs(i - 23), std::abs(j - 14), std::abs(k - 20) });
          FFD_CHECK(output->GetScalarComponentAsDouble(i, j, k, 0) == std::min(one, two));
        }
      }
    }

    filter->SetResolutionToBlocks();
    filter->Update();
    FFD_CHECK(output->GetScalarType() == VTK_UNSIGNED_CHAR);
    int dims[3];
    output->GetDimensions(dims);
    // 22 x 18 x 17 cells.
    FFD_CHECK(dims[0] == 6 && dims[1] == 5 && dims[2] == 5);
    // A block is visible if a visible voxel touches it: the two ends of its range belong to it.
    const auto isVisible = [](int bi, int bj, int bk) {
      const int voxels[2][3] = { { 4, 4, 4 }, { 21, 17, 15 } }; // from the first voxel
      for (const int* v : voxels)
      {
        if (v[0] >= 4 * bi && v[0] <= 4 * bi + 4 && v[1] >= 4 * bj && v[1] <= 4 * bj + 4 &&
          v[2] >= 4 * bk && v[2] <= 4 * bk + 4)
        {
          return true;
        }
      }
      return false;
    };
    for (int n = 0; n < 150; ++n)
    {
      const int at[3] = { n % 6, n / 6 % 5, n / 30 };
      int expected = 255;
      for (int m = 0; m < 150; ++m)
      {
        const int b[3] = { m % 6, m / 6 % 5, m / 30 };
        if (isVisible(b[0], b[1], b[2]))
        {
          expected = std::min(expected,
            std::max({ std::abs(at[0] - b[0]), std::abs(at[1] - b[1]), std::abs(at[2] - b[2]) }));
        }
      }
      FFD_CHECK(output->GetPointData()->GetScalars()->GetComponent(n, 0) == expected);
      // Its point is the center of the block.
      double center[3] = { 2 + 4 * at[0] + 2.0, -3 + 4 * at[1] + 2.0, 5 + 4 * at[2] + 2.0 };
      double p[3];
      image->TransformContinuousIndexToPhysicalPoint(center, p);
      FFD_CHECK(FFDDistance(p, output->GetPoint(n)) < 1e-12);
    }
  }
  // Edits of the opacity arrive. Nothing visible at all.
  vtkNew<vtkFFDDistanceMap> filter;
  filter->SetInputData(MakeVolume(VTK_SHORT));
  filter->SetScalarOpacity(opacity);
  filter->Update();
  const vtkMTimeType time = filter->GetMTime();
  opacity->RemoveAllPoints();
  opacity->AddPoint(0.0, 0.0);
  FFD_CHECK(filter->GetMTime() > time);
  double range[2];
  filter->Update();
  filter->GetOutput()->GetScalarRange(range);
  FFD_CHECK(range[0] == 255.0);
  filter->SetResolutionToVoxels();
  filter->Update();
  filter->GetOutput()->GetScalarRange(range);
  FFD_CHECK(range[0] == 65535.0);
  opacity->AddPoint(0.0, 0.1);
  filter->Update();
  filter->GetOutput()->GetScalarRange(range);
  FFD_CHECK(range[1] == 0.0);
  return EXIT_SUCCESS;
}

int TestBadInput()
{
  vtkNew<vtkFFDDistanceMap> filter;
  vtkNew<FFDErrorLog> log;
  vtkNew<FFDErrorLog> pipeline;
  log->Watch(filter);
  pipeline->Watch(filter->GetExecutive());
  filter->SetInputData(MakeVolume(VTK_FLOAT));
  filter->Update();
  FFD_CHECK(log->Had("no opacity function"));
  vtkNew<vtkPiecewiseFunction> opacity;
  filter->SetScalarOpacity(opacity);
  filter->Update();
  FFD_CHECK(log->Had("without points"));
  opacity->AddPoint(0.0, 0.0);
  opacity->AddPoint(1.0, 1.0);
  vtkNew<vtkImageData> bare;
  bare->SetDimensions(4, 4, 4);
  filter->SetInputData(bare);
  filter->Update();
  FFD_CHECK(log->Had("no point scalars"));
  vtkNew<vtkImageData> vectors;
  vectors->SetDimensions(4, 4, 4);
  vectors->AllocateScalars(VTK_FLOAT, 3);
  filter->SetInputData(vectors);
  filter->Update();
  FFD_CHECK(log->Had("3 components"));
  vtkSmartPointer<vtkImageData> image = MakeVolume(VTK_FLOAT);
  image->GetPointData()->GetScalars()->Fill(std::numeric_limits<double>::quiet_NaN());
  filter->SetInputData(image);
  filter->Update();
  FFD_CHECK(log->Had("no finite number"));
  image->SetScalarComponentFromDouble(6, 1, 9, 0, 1.0);
  image->Modified();
  filter->SetResolutionToVoxels();
  filter->Update();
  FFD_CHECK(log->Count == 0);
  FFD_CHECK(filter->GetOutput()->GetScalarComponentAsDouble(9, 1, 9, 0) == 3.0);

  vtkNew<vtkImageData> tall;
  tall->SetDimensions(4, 4, 200);
  tall->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  tall->GetPointData()->GetScalars()->Fill(1.0);
  filter->SetInputData(tall);
  int calls = 0;
  vtkNew<vtkCallbackCommand> callback;
  callback->SetClientData(&calls);
  callback->SetCallback([](vtkObject* caller, unsigned long, void* data, void*) {
    if (++*static_cast<int*>(data) < 0)
    {
      vtkAlgorithm::SafeDownCast(caller)->AbortExecuteOn();
    }
  });
  filter->AddObserver(vtkCommand::ProgressEvent, callback);
  filter->Update();
  FFD_CHECK(calls > 5 && filter->GetOutput()->GetNumberOfPoints() == 3200);
  calls = -100;
  filter->Modified();
  filter->Update();
  FFD_CHECK(calls < -90 && filter->GetOutput()->GetNumberOfPoints() == 0);
  return EXIT_SUCCESS;
}

} // namespace

int TestFFDDistanceMap(int, char*[])
{
  return TestDistances() || TestBadInput() ? EXIT_FAILURE : EXIT_SUCCESS;
}
