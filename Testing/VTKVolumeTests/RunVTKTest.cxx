// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The main program of one of VTK's tests, as VTK's test driver is: an interactor that is started
// takes the picture and returns, so that nothing waits for a user.
#include "vtkNew.h"
#include "vtkTestingInteractor.h"
#include "vtkTestingObjectFactory.h"

#include <string>

int RunVTKTest(int argc, char* argv[]);

int main(int argc, char* argv[])
{
  for (int i = 1; i + 1 < argc; ++i)
  {
    const std::string argument = argv[i];
    if (argument == "-D")
    {
      vtkTestingInteractor::DataDirectory = argv[i + 1];
    }
    else if (argument == "-T")
    {
      vtkTestingInteractor::TempDirectory = argv[i + 1];
    }
    else if (argument == "-V")
    {
      vtkTestingInteractor::ValidBaseline = argv[i + 1];
    }
  }
  vtkObjectFactory::SetAllEnableFlags(0, "vtkRenderWindowInteractor");
  vtkObjectFactory::RegisterFactory(vtkNew<vtkTestingObjectFactory>());
  return RunVTKTest(argc, argv);
}
