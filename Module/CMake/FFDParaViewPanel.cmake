# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# Whether the ParaView plugin has its Qt panel: for the plugin's build, and for the tests of the main one.
set(FFD_PARAVIEW_GUI AUTO CACHE STRING
  "Build the plugin's Qt panel: ON, OFF, or AUTO (if Qt's development packages are found)")
set_property(CACHE FFD_PARAVIEW_GUI PROPERTY STRINGS AUTO ON OFF)

# ffd_find_paraview_panel(<folder of ParaView's CMake package> <variable>)
function (ffd_find_paraview_panel folder variable)
  set(panel "${FFD_PARAVIEW_GUI}")
  if (panel STREQUAL "AUTO")
    # ParaView 5.12 can be built with Qt 6 and says so in its package; those before it have Qt 5.
    file(STRINGS "${folder}/paraview-config.cmake" line REGEX "^set\\(PARAVIEW_QT_MAJOR_VERSION \"6\"\\)")
    if (line)
      find_package(Qt6 QUIET COMPONENTS Core Core5Compat Gui Help Network OpenGL OpenGLWidgets Svg Widgets)
      set(panel "${Qt6_FOUND}")
    else ()
      find_package(Qt5 QUIET COMPONENTS Core Gui Widgets Svg OpenGL Help)
      set(panel "${Qt5_FOUND}")
    endif ()
  endif ()
  set(${variable} "${panel}" PARENT_SCOPE)
endfunction ()
