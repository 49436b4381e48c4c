# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# A Python wheel: the folder vtkffd, with the extension modules and the libraries side by side, next to
# the folder vtkmodules of VTK's wheel. Included for scikit-build-core (pyproject.toml) alone.
#
# VTK comes from the wheel vtk-sdk, which scikit-build-core puts on CMAKE_PREFIX_PATH. VTK's
# vtk-sdk-python-wheel-helper is not used: it wants VTK 9.6 and CMake 3.27, and looks for modules
# in the whole tree, the ParaView plugin's among them. What it does besides is done here.
set(CMAKE_INSTALL_LIBDIR "vtkffd")
set(FFD_INSTALL_PYTHONDIR ".")

# The libraries of VTK are those that vtkmodules has loaded; the path is for tools that look.
list(APPEND CMAKE_INSTALL_RPATH "$ORIGIN" "$ORIGIN/../vtkmodules")

# VTK's wheels for x86_64 are built with the ABI of GCC 4, https://gitlab.kitware.com/vtk/vtk/-/issues/19919
if (CMAKE_SYSTEM_NAME STREQUAL "Linux" AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  add_compile_definitions(_GLIBCXX_USE_CXX11_ABI=0)
endif ()

# ffd_check_wheel_vtk(): the wheel names the minor version of VTK that it is for (pyproject.toml).
function (ffd_check_wheel_vtk)
  if (NOT "${VTK_MAJOR_VERSION}.${VTK_MINOR_VERSION}" STREQUAL "${FFD_WHEEL_VTK}")
    message(FATAL_ERROR
      "The wheel is for VTK ${FFD_WHEEL_VTK}, as pyproject.toml says, and VTK ${VTK_VERSION} was found in "
      "${VTK_DIR}. Install the vtk-sdk that pyproject.toml names, or change both there.")
  endif ()
endfunction ()
