// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What the driver of the C++ tests does before each test.
#ifndef FFDTestDriver_h
#define FFDTestDriver_h

#include "vtksys/SystemInformation.hxx"

#include <cstdlib>
#include <iostream>

namespace ffdTestDriver
{

/// Print a stack trace on a crash, and stop a test that needs a window where none can open (VTK
/// would abort the program). False: the test cannot run, a message says why.
inline bool Prepare()
{
  vtksys::SystemInformation::SetStackTraceOnError(1);
#if defined(__unix__) && !defined(__APPLE__)
  const char* display = std::getenv("DISPLAY");
  if (std::getenv("FFD_TEST_NEEDS_DISPLAY") && (!display || !*display))
  {
    std::cerr << "This test renders and needs an X display, but DISPLAY is not set. Run the tests "
                 "with Testing/run-tests.sh, or ctest under 'xvfb-run -a'.\n";
    return false;
  }
#endif
  return true;
}

} // namespace ffdTestDriver

#endif
