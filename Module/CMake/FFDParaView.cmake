# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# The ParaView plugin, a build of its own inside this one: ParaView has its own VTK, and what knows of
# VTK in the modules is compiled for it a second time.
#
# Without ParaView_DIR Debian's ParaView is used, through the prefix that setup-paraview.sh makes.
include(ExternalProject)
include(FFDParaViewPanel)

set(FFD_PARAVIEW_JOBS "" CACHE STRING "Parallel compilers of the plugin's build; empty: as many as processors")
mark_as_advanced(FFD_PARAVIEW_JOBS)

set(ffd_paraview_build "${CMAKE_BINARY_DIR}/paraview")
set(ffd_paraview_prefix "${CMAKE_BINARY_DIR}/paraview-prefix")
if (NOT ParaView_DIR)
  execute_process(
    COMMAND "${CMAKE_CURRENT_LIST_DIR}/setup-paraview.sh" "${ffd_paraview_prefix}"
    RESULT_VARIABLE failed)
  if (failed)
    message(FATAL_ERROR
      "FFD_BUILD_PARAVIEW_PLUGIN: Debian's ParaView cannot be used, see above. Set "
      "ParaView_DIR to use another ParaView 5.11 or later.")
  endif ()
  file(GLOB ffd_paraview_dir "${ffd_paraview_prefix}/lib/*/cmake/paraview-5.*")
else ()
  set(ffd_paraview_dir "${ParaView_DIR}")
endif ()

if (NOT FFD_PARAVIEW_JOBS)
  include(ProcessorCount)
  ProcessorCount(FFD_PARAVIEW_JOBS)
  if (FFD_PARAVIEW_JOBS LESS 1)
    set(FFD_PARAVIEW_JOBS 1)
  endif ()
endif ()

ExternalProject_Add(ffd_paraview
  SOURCE_DIR "${CMAKE_SOURCE_DIR}/paraview-plugin"
  BINARY_DIR "${ffd_paraview_build}"
  PREFIX "${CMAKE_BINARY_DIR}/CMakeFiles/paraview"
  CMAKE_ARGS
    "-DParaView_DIR=${ffd_paraview_dir}"
    "-DPython3_EXECUTABLE=${Python3_EXECUTABLE}"
    "-DFFD_PARAVIEW_GUI=${FFD_PARAVIEW_GUI}"
    "-DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}"
    "-DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}"
    "-DCMAKE_C_COMPILER=${CMAKE_C_COMPILER}"
    "-DCMAKE_CXX_FLAGS=${CMAKE_CXX_FLAGS}"
    "-DFFD_UNITY_BUILD=${FFD_UNITY_BUILD}"
    "-DFFD_USE_CCACHE=${FFD_USE_CCACHE}"
    "-DFFD_KERNEL_OBJECTS=${ffd_kernel_objects}"
    "-DFFD_STRICT_WARNINGS=${FFD_STRICT_WARNINGS}"
    "-DCMAKE_INSTALL_LIBDIR=${CMAKE_INSTALL_LIBDIR}"
  BUILD_COMMAND "${CMAKE_COMMAND}" --build <BINARY_DIR> --parallel "${FFD_PARAVIEW_JOBS}"
  INSTALL_COMMAND ""
  DEPENDS ${ffd_kernel_targets}
  BUILD_ALWAYS ON
  USES_TERMINAL_CONFIGURE ON
  USES_TERMINAL_BUILD ON)

# Found by ParaView when PV_PLUGIN_PATH names the folder; lib/paraview-5.13/..., after ParaView's own.
get_filename_component(ffd_paraview_release "${ffd_paraview_dir}" NAME)
set(FFD_PARAVIEW_PLUGIN_DIR
  "${ffd_paraview_build}/${CMAKE_INSTALL_LIBDIR}/${ffd_paraview_release}/plugins/FFDVolume")
# DESTDIR, where it is set, is set there, too.
install(CODE "
  execute_process(
    COMMAND \"${CMAKE_COMMAND}\" --install \"${ffd_paraview_build}\" --prefix \"\${CMAKE_INSTALL_PREFIX}\"
    COMMAND_ERROR_IS_FATAL ANY)")
