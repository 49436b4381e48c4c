// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The image tests rest on this: the window shows what is rendered, a baseline image that does not
// exist is a failure (not a pass, not a skip), and the image rendered is left as the candidate.
#include "vtkActor.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"
#include "vtkPolyDataMapper.h"
#include "vtkRegressionTestImage.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkSphereSource.h"
#include "vtkTesting.h"

#include "vtksys/SystemTools.hxx"

#include <iostream>
#include <string>
#include <vector>

int TestMissingBaseline(int argc, char* argv[])
{
  vtkNew<vtkSphereSource> sphere;
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(sphere->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkNew<vtkRenderer> renderer;
  renderer->AddActor(actor);
  vtkNew<vtkRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetSize(64, 64);
  window->AddRenderer(renderer);
  window->Render();

  // The driver is given Testing/Data/Baseline/TestMissingBaseline.png, which is never added.
  std::string temporary;
  for (int i = 1; i + 1 < argc; ++i)
  {
    if (std::string(argv[i]) == "-T")
    {
      temporary = argv[i + 1];
    }
  }
  const std::string candidate = temporary + "/TestMissingBaseline.png";
  vtksys::SystemTools::RemoveFile(candidate);
  const int result = vtkRegressionTestImage(window);
  if (result != vtkTesting::FAILED)
  {
    std::cerr << "A missing baseline must fail the image test; the result is " << result << ".\n";
    return EXIT_FAILURE;
  }
  if (!vtksys::SystemTools::FileExists(candidate, true))
  {
    std::cerr << "The image test left no candidate image " << candidate << ".\n";
    return EXIT_FAILURE;
  }
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(candidate.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  const double center = image->GetScalarComponentAsDouble(32, 32, 0, 0);
  const double corner = image->GetScalarComponentAsDouble(0, 0, 0, 0);
  if (!(center > 128.0) || corner != 0.0)
  {
    std::cerr << "The candidate image does not show the white sphere on black: center " << center
              << ", corner " << corner << ".\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
