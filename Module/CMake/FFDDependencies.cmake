# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# The packages the project is built on. Debian: libvtk9-dev libglm-dev libhwy-dev python3-vtk9,
# libeigen3-dev, libhdf5-dev for VTK::hdf5.
set(ffd_vtk_components
  CommonCore CommonDataModel CommonExecutionModel CommonMath CommonMisc CommonSystem
  CommonTransforms
  FiltersCore FiltersGeneral FiltersHybrid FiltersSources hdf5
  ImagingCore ImagingHybrid ImagingSources ImagingStatistics
  InteractionStyle InteractionWidgets IOCore IOImage IOLegacy IOXML
  RenderingCore RenderingFreeType RenderingLabel RenderingOpenGL2 RenderingUI RenderingVolume
  RenderingVolumeOpenGL2
  TestingCore TestingRendering)
# The interpreter VTK's Python modules were built for; another python3 may come first on PATH.
if (NOT Python3_EXECUTABLE AND EXISTS "/usr/bin/python3")
  set(Python3_EXECUTABLE "/usr/bin/python3" CACHE FILEPATH "Python interpreter that has VTK")
endif ()
if (FFD_WRAP_PYTHON)
  set(ffd_python_development Development)
  if (SKBUILD)
    # Wheels are not linked to Python's library, which many interpreters have not got.
    set(ffd_python_development Development.Module)
  endif ()
  find_package(Python3 REQUIRED COMPONENTS Interpreter ${ffd_python_development})
  list(APPEND ffd_vtk_components Python WrappingPythonCore)
endif ()

find_package(VTK 9.1 REQUIRED COMPONENTS ${ffd_vtk_components})
if (SKBUILD)
  ffd_check_wheel_vtk()
endif ()
find_package(glm REQUIRED)
find_package(HWY REQUIRED)
find_package(Eigen3 3.3 REQUIRED NO_MODULE)
