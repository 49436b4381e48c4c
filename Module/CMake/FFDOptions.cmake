# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# Build options, output folders and compiler settings of the project.
if (SKBUILD)
  include(FFDWheel)
endif ()
include(GNUInstallDirs)
include(CMakeDependentOption)
include(CTest)

option(BUILD_SHARED_LIBS "Build shared libraries" ON)
option(FFD_WRAP_PYTHON "Build the Python package vtkffd" ON)
option(FFD_BUILD_EXAMPLES "Build the example programs" ON)
option(FFD_BUILD_PARAVIEW_PLUGIN "Build the ParaView plugin FFDVolume, against ParaView's own VTK" OFF)
option(FFD_USE_CCACHE "Compile through ccache where it is installed" ON)
option(FFD_STRICT_WARNINGS "Turn on many warnings and treat them as errors" OFF)
set(FFD_SANITIZERS "" CACHE STRING "Sanitizers to build with, comma separated (address,undefined or thread)")
# Most of the time is spent on the headers of VTK. Not where warnings and sanitizers are to show that each source
# includes what it uses, and in which line.
cmake_dependent_option(FFD_UNITY_BUILD
  "Compile sources that use VTK several at a time, in half the time" ON
  "NOT FFD_STRICT_WARNINGS;NOT FFD_SANITIZERS" OFF)

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_UNITY_BUILD "${FFD_UNITY_BUILD}")

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_BINDIR}")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}")
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}")

# Our libraries find each other wherever the installed tree is moved to.
if (APPLE)
  list(APPEND CMAKE_INSTALL_RPATH "@loader_path")
elseif (UNIX)
  list(APPEND CMAKE_INSTALL_RPATH "$ORIGIN")
endif ()

if (NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif ()

if (FFD_USE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(FFD_CCACHE ccache)
  mark_as_advanced(FFD_CCACHE)
  if (FFD_CCACHE)
    set(CMAKE_C_COMPILER_LAUNCHER "${FFD_CCACHE}")
    set(CMAKE_CXX_COMPILER_LAUNCHER "${FFD_CCACHE}")
  endif ()
endif ()

add_library(ffd_build_flags INTERFACE)
if (FFD_STRICT_WARNINGS)
  # No -Wpedantic: GCC 12 then objects to the semicolon after vtkTypeMacro(), which VTK's style has.
  set(ffd_warnings
    -Wall -Wextra -Werror
    -Wcast-align -Wcast-qual -Wformat=2 -Wnon-virtual-dtor
    -Woverloaded-virtual -Wpointer-arith -Wshadow -Wundef -Wunused -Wvla)
  if (CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 takes vectors of GLM and small arrays that a loop fills for uninitialized at -O3.
    list(APPEND ffd_warnings
      -Wduplicated-branches -Wduplicated-cond -Wlogical-op -Wno-maybe-uninitialized)
  endif ()
  target_compile_options(ffd_build_flags INTERFACE
    "$<$<COMPILE_LANGUAGE:CXX>:${ffd_warnings}>")
endif ()
if (CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Of classes with members of types from the anonymous namespace, in what GCC takes for headers.
  target_compile_options(ffd_build_flags INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>")
endif ()
if (FFD_SANITIZERS)
  target_compile_options(ffd_build_flags INTERFACE -fsanitize=${FFD_SANITIZERS} -fno-omit-frame-pointer -g)
  if (FFD_SANITIZERS MATCHES "undefined")
    # Vector kernels and Eigen take minutes a file otherwise.
    target_compile_options(ffd_build_flags INTERFACE -O1 -g1)
  endif ()
  target_link_options(ffd_build_flags INTERFACE -fsanitize=${FFD_SANITIZERS})
endif ()

# ffd_link_private(<module> <target>...): libraries that a module's sources use and its headers do not.
# Shared libraries bring them along; with static ones those who link them must find them, too, which
# FFDConfig.cmake does.
function (ffd_link_private module)
  set(targets ${ARGN})
  if (BUILD_SHARED_LIBS)
    list(TRANSFORM targets REPLACE "(.+)" "$<BUILD_INTERFACE:\\1>")
  endif ()
  vtk_module_link("${module}" PRIVATE ${targets})
endfunction ()

# ffd_use_headers(<module> <target>...): libraries of headers alone, which nobody who links the module needs.
function (ffd_use_headers module)
  foreach (target IN LISTS ARGN)
    vtk_module_link("${module}" PRIVATE "$<BUILD_INTERFACE:${target}>")
  endforeach ()
endfunction ()

# ffd_compile_quickly(<target>)
# Less optimization in release builds, in little more than half the time: for tests, which spend their
# time in our libraries, and for code that VTK writes to wrap them.
function (ffd_compile_quickly target)
  if (CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options("${target}" PRIVATE "$<$<CONFIG:Release>:-O1>")
  endif ()
endfunction ()

# ffd_configure_module(<module> <folder>...): settings that every module library shares. The sources may
# include the kernels of the module and of the folders. All of it stays private, so nothing of it
# reaches an installed header.
function (ffd_configure_module module)
  string(REPLACE "FFD::" "" name "${module}")
  string(TOUPPER "${name}" name)
  vtk_module_definitions("${module}" PRIVATE "FFD_BUILDING_${name}")
  set(folders ${ARGN})
  list(TRANSFORM folders PREPEND "${FFD_SOURCE_DIR}/")
  list(TRANSFORM folders APPEND "/Kernels")
  vtk_module_include("${module}" PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}/Kernels" ${folders})
  # Not linked: static libraries would have to export it.
  vtk_module_compile_options("${module}" PRIVATE
    $<TARGET_PROPERTY:ffd_build_flags,INTERFACE_COMPILE_OPTIONS>)
  vtk_module_link_options("${module}" PRIVATE
    $<TARGET_PROPERTY:ffd_build_flags,INTERFACE_LINK_OPTIONS>)
endfunction ()

# ffd_take_compiled_kernels(<module's target> <variable>)
#
# Replaces the kernels' sources that the variable lists by object files, where FFD_KERNEL_OBJECTS names
# the file in which another build of this tree lists its own, by ffd_list_compiled_kernels(<file>
# <targets>): the ParaView plugin's, and the static one of Testing/Install. Kernels know
# nothing of VTK, so those of one build fit every VTK, and they are what takes longest to compile.
set(FFD_KERNEL_OBJECTS "" CACHE FILEPATH "Compiled kernels of another build to use; empty: none")
mark_as_advanced(FFD_KERNEL_OBJECTS)
function (ffd_list_compiled_kernels file targets)
  set(content)
  foreach (target IN LISTS targets)
    string(APPEND content "set(ffd_objects_${target} \"$<TARGET_OBJECTS:${target}>\")\n")
  endforeach ()
  file(GENERATE OUTPUT "${file}" CONTENT "${content}")
endfunction ()
function (ffd_take_compiled_kernels target variable)
  if (NOT FFD_KERNEL_OBJECTS)
    set_source_files_properties(${${variable}} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    return ()
  endif ()
  include("${FFD_KERNEL_OBJECTS}")
  set(objects)
  foreach (source IN LISTS ${variable})
    set(object ${ffd_objects_${target}})
    list(FILTER object INCLUDE REGEX "/${source}\\.[a-z]+$")
    list(LENGTH object found)
    if (NOT found EQUAL 1)
      message(FATAL_ERROR
        "${FFD_KERNEL_OBJECTS} names no object file of ${source}. Build the tree that it belongs to "
        "again, or unset FFD_KERNEL_OBJECTS.")
    endif ()
    list(APPEND objects "${object}")
  endforeach ()
  set_source_files_properties(${objects} PROPERTIES EXTERNAL_OBJECT TRUE)
  set(${variable} ${objects} PARENT_SCOPE)
endfunction ()
