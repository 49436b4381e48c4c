# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# Test of the installed package, run by ctest as Install.Consumer:
#   0. with STATIC_SOURCE, build static libraries of that source tree, to be installed;
#   1. install for WORK/prefix with DESTDIR, as packages are made, and move that to WORK/moved (nothing may
#      point to the first place, or be outside of it);
#   2. nothing private is installed: no kernel, GLM or Highway header, and no installed header
#      includes one;
#   3. the project in CONSUMER finds the package, compiles every installed header on its own (with
#      static libraries: all in one file), links and runs;
#   4. with shared libraries, the same with a component that does not exist, a version that this is not
#      compatible with, and without the C language, gives the messages that name the cure; an optional
#      component may be missing;
#   5. the installed Python package can be imported from the moved tree.
cmake_minimum_required(VERSION 3.25)

# run(<what> <command>...): stop with the command's output unless it succeeds.
function (run what)
  message(STATUS "${what}")
  execute_process(COMMAND ${ARGN}
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if (NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${output}")
  endif ()
  set(run_output "${output}" PARENT_SCOPE)
endfunction ()

# refuse(<what> <expected text> <command>...): the command must fail and say so.
function (refuse what expected)
  message(STATUS "${what}")
  execute_process(COMMAND ${ARGN}
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " flat "${output}")
  string(FIND "${flat}" "${expected}" position)
  if (result EQUAL 0 OR position EQUAL -1)
    message(FATAL_ERROR "${what}: expected a failure that says '${expected}', got (${result}):\n${output}")
  endif ()
endfunction ()

set(prefix "${WORK}/prefix")
set(moved "${WORK}/moved")
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")
set(configuration)
if (CONFIGURATION)
  set(configuration --config "${CONFIGURATION}")
endif ()

if (STATIC_SOURCE)
  # What is compiled as in the build with shared libraries, but for the macros of their symbols, is taken
  # from there; the rest is not optimized. The folder is kept, so that it is brought up to date the next time.
  set(ENV{CMAKE_CXX_COMPILER_LAUNCHER}
    "${REUSE_PYTHON};-I;-S;${STATIC_SOURCE}/Testing/reuse_objects.py;${WORK}-build;${BUILD_TREE}")
  set(BUILD_TREE "${WORK}-build")
  run("Configuring static libraries" "${CMAKE_COMMAND}" -S "${STATIC_SOURCE}" -B "${BUILD_TREE}"
    -G "${GENERATOR}"
    "-DCMAKE_BUILD_TYPE=${CONFIGURATION}"
    "-DCMAKE_C_COMPILER=${C_COMPILER}"
    "-DCMAKE_CXX_COMPILER=${CXX_COMPILER}"
    "-DCMAKE_CXX_FLAGS=-O0"
    "-DCMAKE_CXX_FLAGS_RELEASE=-DNDEBUG"
    "-DCMAKE_INSTALL_LIBDIR=${LIBRARY_DESTINATION}"
    "-DVTK_DIR=${VTK_PACKAGE}"
    -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF -DFFD_WRAP_PYTHON=OFF -DFFD_BUILD_EXAMPLES=OFF
    "-DFFD_KERNEL_OBJECTS=${KERNEL_OBJECTS}")
  unset(ENV{CMAKE_CXX_COMPILER_LAUNCHER})
  run("Building static libraries" "${CMAKE_COMMAND}" --build "${BUILD_TREE}" ${configuration})
endif ()

run("Installing the build tree" "${CMAKE_COMMAND}" -E env "DESTDIR=${WORK}/stage"
  "${CMAKE_COMMAND}" --install "${BUILD_TREE}" --prefix "${prefix}" ${configuration})
file(RENAME "${WORK}/stage${prefix}" "${moved}")
file(GLOB_RECURSE astray "${WORK}/stage/*")
if (astray)
  message(FATAL_ERROR "Installed outside of the prefix: ${astray}")
endif ()

message(STATUS "Checking the installed headers")
file(GLOB_RECURSE headers RELATIVE "${moved}/include" "${moved}/include/*")
if (NOT headers)
  message(FATAL_ERROR "No header was installed under ${moved}/include.")
endif ()
foreach (header IN LISTS headers)
  if (NOT header MATCHES "^vtkffd/vtkFFD[A-Za-z0-9]+\\.h$")
    message(FATAL_ERROR "'${header}' must not be installed: only public headers vtkFFD*.h are.")
  endif ()
  file(STRINGS "${moved}/include/${header}" includes REGEX "^[ \t]*#[ \t]*include")
  foreach (line IN LISTS includes)
    if (line MATCHES "glm/|hwy/|Kernels/|[\"</]FFD")
      message(FATAL_ERROR "The installed header '${header}' includes a private one: ${line}")
    endif ()
  endforeach ()
endforeach ()

message(STATUS "Checking that nothing installed names the build tree")
file(GLOB_RECURSE texts "${moved}/*.cmake" "${moved}/*.py" "${moved}/*.h")
foreach (text IN LISTS texts)
  file(READ "${text}" content)
  foreach (place IN ITEMS "${BUILD_TREE}/lib" "${BUILD_TREE}/Module" "${prefix}")
    string(FIND "${content}" "${place}" position)
    if (NOT position EQUAL -1)
      message(FATAL_ERROR "The installed file ${text} names ${place}.")
    endif ()
  endforeach ()
endforeach ()

# What headers and messages are is the same of static libraries.
set(headers_apart ON)
if (STATIC_SOURCE)
  set(headers_apart OFF)
endif ()
set(configure "${CMAKE_COMMAND}" -S "${CONSUMER}" -G "${GENERATOR}"
  "-DCMAKE_BUILD_TYPE=${CONFIGURATION}"
  "-DCMAKE_C_COMPILER=${C_COMPILER}"
  "-DCMAKE_CXX_COMPILER=${CXX_COMPILER}"
  "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
  "-DCONSUMER_HEADERS_APART=${headers_apart}"
  "-DFFD_DIR=${moved}/${CMAKE_DESTINATION}"
  "-DVTK_DIR=${VTK_PACKAGE}")
run("Configuring the consumer" ${configure} -B "${WORK}/build")
run("Building the consumer" "${CMAKE_COMMAND}" --build "${WORK}/build" ${configuration})
file(GLOB_RECURSE program "${WORK}/build/consumer" "${WORK}/build/*/consumer"
  "${WORK}/build/consumer.exe")
list(GET program 0 program)
run("Running the consumer" "${program}")
message("${run_output}")

if (NOT STATIC_SOURCE)
  refuse("Asking for a component that does not exist" "FFD has no component 'Levitation'"
    ${configure} -B "${WORK}/build-component" -DCONSUMER_COMPONENT=Levitation)
  foreach (version IN ITEMS 0.2 0.0.9 1)
    refuse("Asking for version ${version}" "compatible with requested version \"${version}\""
      ${configure} -B "${WORK}/build-version" "-DCONSUMER_VERSION=${version}")
  endforeach ()
  refuse("Configuring without the C language" "LANGUAGES C CXX"
    ${configure} -B "${WORK}/build-language" -DCONSUMER_LANGUAGES=CXX)
endif ()

if (PYTHON)
  run("Importing the installed Python package"
    "${CMAKE_COMMAND}" -E env "PYTHONPATH=${moved}/${PYTHON_DESTINATION}" PYTHONDONTWRITEBYTECODE=1
    "${PYTHON}" -c "
import os
import vtkffd
assert vtkffd.__file__.startswith('${moved}'), vtkffd.__file__
for name in ('__init__.pyi', 'py.typed'):
    assert os.path.exists(os.path.join(os.path.dirname(vtkffd.__file__), name)), name
for name in vtkffd.__all__:
    if name != 'vtkFFDWarpTransform':  # abstract
        print(getattr(vtkffd, name)().GetClassName())
if os.path.exists('/proc/self/maps'):
    with open('/proc/self/maps') as maps:
        libraries = {line.split()[-1] for line in maps if 'libvtkFFD' in line}
    assert libraries and all(path.startswith('${moved}') for path in libraries), libraries
")
  message("${run_output}")
endif ()
