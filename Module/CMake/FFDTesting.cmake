# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#[==[
Helpers to add tests. One line per test in the CMakeLists.txt of the test's folder is all it takes:

  Testing/Kernels   ffd_add_kernel_test(<Name> <sources>...)     Google Test, no VTK scene
  Testing/Cxx       ffd_add_cxx_test(<Name> [<options>])         <Name>.cxx, VTK classes and images
                    ffd_add_cxx_tests(<Name>...)                 the same for several, no options
                    ffd_add_scene_tests(<Name> <scene>...)       a test for each scene of <Name>.cxx
  Testing/Python    ffd_add_python_test(<file>.py [<options>])   unittest through "import vtkffd"

Options, where they apply:
  RENDERING      opens a render window: gets the label "rendering", Mesa's software rasterizer, and
                 fails with a message when there is no X display
  OWN_DISPLAY    runs under an X server of its own (with-xvfb.sh): a pointer that it moves must not
                 meet the windows of other tests
  LABELS <l>...  further ctest labels (each test has the label of its kind: kernels, cxx, python)
  TIMEOUT <s>    seconds, default FFD_TEST_TIME_LIMIT (an hour)
  ARGS <a>...    extra arguments

The ctest names are Kernels.<Name>, Cxx.<Name> and Python.<file without .py>. A test source that
lies in one of the folders but is not listed there is a configure error, and a test that skips
itself fails: nothing goes missing unnoticed.
]==]

find_package(GTest REQUIRED)

set(FFD_TEST_DATA_DIR "${CMAKE_SOURCE_DIR}/Testing/Data")
set(FFD_TEST_TEMPORARY_DIR "${CMAKE_BINARY_DIR}/Testing/Temporary")
file(MAKE_DIRECTORY "${FFD_TEST_TEMPORARY_DIR}")
# For what never ends, nothing else: the longest tests take minutes alone, and ten times as long on a
# machine with as much other work. What a test may cost is counted in processor time, or in work.
set(FFD_TEST_TIME_LIMIT 3600 CACHE STRING "Time limit of a test in seconds")
mark_as_advanced(FFD_TEST_TIME_LIMIT)

# Environment of every test.
set(ffd_test_environment
  "FFD_TEST_DATA=${FFD_TEST_DATA_DIR}"
  "FFD_TEST_BASELINE=${FFD_TEST_DATA_DIR}/Baseline"
  "FFD_TEST_TEMPORARY=${FFD_TEST_TEMPORARY_DIR}")
if (FFD_SANITIZERS)
  # Libraries that are not ours (Mesa, OpenMPI, VTK's own) are suppressed by name. What no
  # suppression hides is switched off: Xlib and xcb lock in both orders, and Mesa's locks are seen
  # in part only. VTK's SMP tools run on standard threads: TBB synchronizes by atomics that the
  # thread sanitizer does not see.
  set(suppressions "${CMAKE_SOURCE_DIR}/Testing/Sanitizers")
  list(APPEND ffd_test_environment
    "ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1:detect_stack_use_after_return=1"
    "LSAN_OPTIONS=suppressions=${suppressions}/lsan.supp:print_suppressions=0"
    "UBSAN_OPTIONS=suppressions=${suppressions}/ubsan.supp:print_stacktrace=1:halt_on_error=1"
    "TSAN_OPTIONS=suppressions=${suppressions}/tsan.supp:halt_on_error=1:detect_deadlocks=0:report_mutex_bugs=0"
    "VTK_SMP_BACKEND_IN_USE=STDThread")
endif ()

# ffd_set_test_properties(<ctest name> <kind> ...): what the three kinds share. Internal.
function (ffd_set_test_properties name kind)
  cmake_parse_arguments(PARSE_ARGV 2 arg "RENDERING" "TIMEOUT" "LABELS;ENVIRONMENT")
  if (NOT arg_TIMEOUT)
    set(arg_TIMEOUT "${FFD_TEST_TIME_LIMIT}")
  endif ()
  set(labels "${kind}" ${arg_LABELS})
  set(environment ${ffd_test_environment} ${arg_ENVIRONMENT})
  if (arg_RENDERING)
    list(APPEND labels rendering)
    # Mesa's llvmpipe whatever the machine has, so that images compare.
    list(APPEND environment "FFD_TEST_NEEDS_DISPLAY=1" "LIBGL_ALWAYS_SOFTWARE=1")
  endif ()
  set_tests_properties("${name}" PROPERTIES
    LABELS "${labels}"
    TIMEOUT "${arg_TIMEOUT}"
    ENVIRONMENT "${environment}")
endfunction ()

# Stop when `extension` files of the calling folder are missing from its CMakeLists.txt. Internal;
# runs at the end of each test folder.
function (ffd_check_tests_listed extension)
  file(GLOB present CONFIGURE_DEPENDS RELATIVE "${CMAKE_CURRENT_SOURCE_DIR}"
    "${CMAKE_CURRENT_SOURCE_DIR}/Test*.${extension}")
  get_property(listed DIRECTORY PROPERTY ffd_listed_test_sources)
  list(REMOVE_ITEM present ${listed})
  if (present)
    list(JOIN present ", " present)
    message(FATAL_ERROR
      "Test sources without a line in ${CMAKE_CURRENT_SOURCE_DIR}/CMakeLists.txt: ${present}. "
      "Add them there (see Module/CMake/FFDTesting.cmake), or remove the files.")
  endif ()
endfunction ()

# Remember test sources of the calling folder, and check them all once it has been read. Internal.
macro (ffd_list_test_sources extension)
  get_property(ffd_listed_before DIRECTORY PROPERTY ffd_listed_test_sources)
  if (NOT ffd_listed_before)
    cmake_language(EVAL CODE "cmake_language(DEFER CALL ffd_check_tests_listed [[${extension}]])")
  endif ()
  set_property(DIRECTORY APPEND PROPERTY ffd_listed_test_sources ${ARGN})
endmacro ()

# ffd_precompile_headers(<property> <target> <header>...)
# Parse the headers once for all targets with the same property, whose first one compiles them. Not with
# a compiler cache, which would not cache what uses them, and not with strict warnings, where
# sources must do with what they include themselves.
function (ffd_precompile_headers property target)
  if (CMAKE_CXX_COMPILER_LAUNCHER OR FFD_STRICT_WARNINGS OR FFD_SANITIZERS)
    return ()
  endif ()
  get_property(first GLOBAL PROPERTY "${property}")
  if (first)
    target_precompile_headers("${target}" REUSE_FROM "${first}")
  else ()
    target_precompile_headers("${target}" PRIVATE ${ARGN})
    set_property(GLOBAL PROPERTY "${property}" "${target}")
  endif ()
endfunction ()

# ffd_add_kernel_test(<Name> <sources>... [LABELS ...] [TIMEOUT s])
# A Google Test executable that sees the private headers of the kernels and links all our modules.
# GTEST_SKIP() counts as failure: loop over what the machine has instead.
function (ffd_add_kernel_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TIMEOUT" "LABELS")
  ffd_list_test_sources(cxx ${arg_UNPARSED_ARGUMENTS})
  add_executable("${name}" ${arg_UNPARSED_ARGUMENTS})
  target_include_directories("${name}" PRIVATE ${ffd_kernel_folders})
  target_link_libraries("${name}" PRIVATE
    ffd_build_flags
    ${ffd_modules}
    glm::glm hwy::hwy
    GTest::gtest_main)
  ffd_compile_quickly("${name}")
  ffd_precompile_headers(ffd_kernel_test_headers "${name}"
    <gtest/gtest.h> <glm/glm.hpp> <algorithm> <cmath> <functional> <random> <string> <vector>)
  add_test(NAME "Kernels.${name}" COMMAND "${name}")
  set_tests_properties("Kernels.${name}" PROPERTIES
    FAIL_REGULAR_EXPRESSION "\\[  SKIPPED \\];0 tests from 0 test suites")
  ffd_set_test_properties("Kernels.${name}" kernels TIMEOUT "${arg_TIMEOUT}" LABELS ${arg_LABELS})
endfunction ()

# ffd_add_cxx_test(<Name> [RENDERING] [LABELS ...] [TIMEOUT s] [ARGS ...])
# <Name>.cxx defines int <Name>(int argc, char* argv[]) and returns EXIT_SUCCESS or EXIT_FAILURE.
# Arguments passed on: -D <data folder> -T <folder for output> -V <baseline image <Name>.png>, as
# vtkRegressionTestImage and vtkTesting expect. With these a missing baseline is a failure, and
# what was rendered is left in the output folder under the baseline's name, next to the
# difference image when there is one. All tests of the folder share one executable, FFDCxxTests.
function (ffd_add_cxx_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "RENDERING" "TIMEOUT" "LABELS;ARGS")
  if (arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "ffd_add_cxx_test(${name}): unknown arguments ${arg_UNPARSED_ARGUMENTS}.")
  endif ()
  get_property(first DIRECTORY PROPERTY ffd_listed_test_sources)
  if (NOT first)
    cmake_language(DEFER CALL ffd_build_cxx_tests)
  endif ()
  ffd_list_test_sources(cxx "${name}.cxx")
  add_test(NAME "Cxx.${name}"
    COMMAND FFDCxxTests "${name}" ${arg_ARGS}
      -D "${FFD_TEST_DATA_DIR}"
      -T "${FFD_TEST_TEMPORARY_DIR}"
      -V "${FFD_TEST_DATA_DIR}/Baseline/${name}.png")
  set(rendering)
  if (arg_RENDERING)
    set(rendering RENDERING)
  endif ()
  ffd_set_test_properties("Cxx.${name}" cxx ${rendering}
    TIMEOUT "${arg_TIMEOUT}" LABELS ${arg_LABELS})
endfunction ()

# ffd_add_cxx_tests(<Name>...)
function (ffd_add_cxx_tests)
  foreach (name IN LISTS ARGN)
    ffd_add_cxx_test("${name}")
  endforeach ()
endfunction ()

# ffd_add_scene_tests(<Name> <scene>...)
# Scenes of <Name>.cxx, a test of its own each, Cxx.<Name>.<scene>, run with --scene <scene>; and
# Cxx.<Name>, which is given all of them after --registered and fails if it knows others.
function (ffd_add_scene_tests name)
  ffd_add_cxx_test("${name}" RENDERING ARGS --registered ${ARGN})
  foreach (scene IN LISTS ARGN)
    add_test(NAME "Cxx.${name}.${scene}"
      COMMAND FFDCxxTests "${name}" --scene "${scene}"
        -D "${FFD_TEST_DATA_DIR}"
        -T "${FFD_TEST_TEMPORARY_DIR}")
    ffd_set_test_properties("Cxx.${name}.${scene}" cxx RENDERING LABELS scenes)
  endforeach ()
endfunction ()

# The driver of all tests of Testing/Cxx. Internal; runs once the folder has been read.
function (ffd_build_cxx_tests)
  get_property(sources DIRECTORY PROPERTY ffd_listed_test_sources)
  set(CMAKE_TESTDRIVER_BEFORE_TESTMAIN
    "  if (!ffdTestDriver::Prepare()) { return EXIT_FAILURE; }\n")
  set(CMAKE_TESTDRIVER_AFTER_TESTMAIN "")
  create_test_sourcelist(driver FFDCxxTests.cxx ${sources} EXTRA_INCLUDE "FFDTestDriver.h")
  add_executable(FFDCxxTests ${driver} FFDTestDriver.h)
  if (FFD_SANITIZERS)
    target_sources(FFDCxxTests PRIVATE "${CMAKE_SOURCE_DIR}/Testing/Sanitizers/FFDKeepLibraries.cxx")
    set_target_properties(FFDCxxTests PROPERTIES ENABLE_EXPORTS ON)
  endif ()
  target_include_directories(FFDCxxTests PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}")
  ffd_compile_quickly(FFDCxxTests)
  ffd_precompile_headers(ffd_cxx_test_headers FFDCxxTests
    <vtkCamera.h> <vtkColorTransferFunction.h> <vtkDoubleArray.h> <vtkImageData.h> <vtkNew.h>
    <vtkPiecewiseFunction.h> <vtkPointData.h> <vtkRegressionTestImage.h> <vtkRenderWindow.h>
    <vtkRenderer.h> <vtkSmartPointer.h> <vtkVolume.h> <vtkVolumeProperty.h>
    <algorithm> <array> <cmath> <functional> <iostream> <sstream> <string> <vector>)
  target_link_libraries(FFDCxxTests PRIVATE
    ffd_build_flags
    ${ffd_modules}
    VTK::CommonSystem
    VTK::FiltersGeneral
    VTK::FiltersSources
    VTK::ImagingCore
    VTK::ImagingSources
    VTK::InteractionStyle
    VTK::InteractionWidgets
    VTK::IOImage
    VTK::IOXML
    VTK::RenderingCore
    VTK::RenderingFreeType
    VTK::RenderingOpenGL2
    VTK::RenderingUI
    VTK::RenderingVolume
    VTK::RenderingVolumeOpenGL2
    VTK::TestingCore
    VTK::TestingRendering)
  # Without this no OpenGL class is registered, and rendering silently shows nothing.
  vtk_module_autoinit(
    TARGETS FFDCxxTests
    MODULES
      VTK::InteractionStyle
      VTK::RenderingFreeType
      VTK::RenderingOpenGL2
      VTK::RenderingUI
      VTK::RenderingVolumeOpenGL2)
endfunction ()

# ffd_add_python_test(<file>.py [RENDERING] [OWN_DISPLAY] [LABELS ...] [TIMEOUT s] [ARGS ...])
# The file runs as a script that ends in unittest.main(). "import vtkffd" is the build tree's
# package; FFD_TEST_DATA, FFD_TEST_BASELINE and FFD_TEST_TEMPORARY in the environment are the
# folders of inputs, baseline images and output.
function (ffd_add_python_test file)
  cmake_parse_arguments(PARSE_ARGV 1 arg "RENDERING;OWN_DISPLAY" "TIMEOUT" "LABELS;ARGS")
  if (arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "ffd_add_python_test(${file}): unknown arguments ${arg_UNPARSED_ARGUMENTS}.")
  endif ()
  ffd_list_test_sources(py "${file}")
  get_filename_component(name "${file}" NAME_WE)
  set(server)
  if (arg_OWN_DISPLAY)
    set(server "${CMAKE_SOURCE_DIR}/Module/CMake/with-xvfb.sh")
  endif ()
  add_test(NAME "Python.${name}"
    COMMAND ${server} "${Python3_EXECUTABLE}" "${CMAKE_CURRENT_SOURCE_DIR}/${file}" ${arg_ARGS})
  set_tests_properties("Python.${name}" PROPERTIES
    FAIL_REGULAR_EXPRESSION "skipped=[0-9];Ran 0 tests")
  set(rendering)
  if (arg_RENDERING)
    set(rendering RENDERING)
  endif ()
  # The interpreter is not built with sanitizers: their library is loaded before it, together with
  # that of the exceptions, which it must find. What Python itself keeps is no leak of ours.
  set(preload)
  if (FFD_SANITIZERS MATCHES "address")
    foreach (library IN ITEMS libasan.so libstdc++.so)
      execute_process(COMMAND "${CMAKE_CXX_COMPILER}" "-print-file-name=${library}"
        OUTPUT_VARIABLE path OUTPUT_STRIP_TRAILING_WHITESPACE)
      list(APPEND preload "${path}")
    endforeach ()
    list(JOIN preload " " preload)
    set(preload "LD_PRELOAD=${preload}" "ASAN_OPTIONS=detect_leaks=0:strict_string_checks=1")
  endif ()
  ffd_set_test_properties("Python.${name}" python ${rendering}
    TIMEOUT "${arg_TIMEOUT}" LABELS ${arg_LABELS}
    ENVIRONMENT
      "PYTHONPATH=${CMAKE_BINARY_DIR}/python"
      "PYTHONDONTWRITEBYTECODE=1"
      ${preload})
endfunction ()
