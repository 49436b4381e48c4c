# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# Wrap every module and assemble the package vtkffd (build tree: PYTHONPATH=<build>/python).
set(ffd_python_site "${CMAKE_INSTALL_LIBDIR}/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages")
vtk_module_wrap_python(
  MODULES ${ffd_modules}
  TARGET FFD::Python
  PYTHON_PACKAGE "vtkffd"
  MODULE_DESTINATION "${ffd_python_site}"
  CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/FFD"
  INSTALL_HEADERS OFF
  BUILD_STATIC OFF)
