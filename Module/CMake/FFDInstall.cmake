# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# The CMake package FFD. VTK's module system installs the libraries, the public headers, the export
# set (FFD-targets.cmake) and the module properties; the package files it leaves to us.
include(CMakePackageConfigHelpers)

set(ffd_cmake_destination "${CMAKE_INSTALL_LIBDIR}/cmake/FFD")

# The VTK modules that a user of ours needs: whatever our modules name, public or private (private
# ones too, since the linker looks them up, and a program that renders registers them).
set(FFD_VTK_COMPONENTS)
set(FFD_COMPONENTS)
foreach (module IN LISTS ffd_modules)
  string(REPLACE "FFD::" "" component "${module}")
  list(APPEND FFD_COMPONENTS "${component}")
  foreach (kind IN ITEMS depends private_depends)
    get_property(depends TARGET "${module}" PROPERTY "INTERFACE_vtk_module_${kind}")
    list(APPEND FFD_VTK_COMPONENTS ${depends})
  endforeach ()
endforeach ()
list(FILTER FFD_VTK_COMPONENTS INCLUDE REGEX "^VTK::")
list(TRANSFORM FFD_VTK_COMPONENTS REPLACE "^VTK::" "")
list(REMOVE_DUPLICATES FFD_VTK_COMPONENTS)
list(SORT FFD_VTK_COMPONENTS)
list(SORT FFD_COMPONENTS)

set(FFD_PACKAGE_PYTHONPATH)
if (FFD_WRAP_PYTHON)
  set(FFD_PACKAGE_PYTHONPATH "${FFD_INSTALL_PYTHONDIR}")
endif ()

configure_package_config_file(
  "${CMAKE_CURRENT_SOURCE_DIR}/Module/CMake/FFDConfig.cmake.in"
  "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/FFDConfig.cmake"
  INSTALL_DESTINATION "${ffd_cmake_destination}"
  NO_SET_AND_CHECK_MACRO
  NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# Before 1.0 a minor version may change the API.
write_basic_package_version_file(
  "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/FFDConfigVersion.cmake"
  VERSION "${PROJECT_VERSION}"
  COMPATIBILITY SameMinorVersion)
install(FILES
    "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/FFDConfig.cmake"
    "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/FFDConfigVersion.cmake"
  DESTINATION "${ffd_cmake_destination}")
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
