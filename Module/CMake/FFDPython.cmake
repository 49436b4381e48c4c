# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# Wrap every module and assemble the package vtkffd (build tree: PYTHONPATH=<build>/python).
set(FFD_INSTALL_PYTHONDIR
  "${CMAKE_INSTALL_LIBDIR}/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages"
  CACHE STRING "Where the Python package vtkffd is installed, relative to the install prefix")
mark_as_advanced(FFD_INSTALL_PYTHONDIR)
set(ffd_python_build_root "${CMAKE_BINARY_DIR}/python")
set(ffd_python_build_package "${ffd_python_build_root}/vtkffd")

vtk_module_wrap_python(
  MODULES ${ffd_modules}
  WRAPPED_MODULES ffd_wrapped_modules
  TARGET FFD::Python
  PYTHON_PACKAGE "vtkffd"
  MODULE_DESTINATION "${FFD_INSTALL_PYTHONDIR}"
  LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/FFD"
  INSTALL_HEADERS OFF
  BUILD_STATIC OFF)

# VTK lays the extension modules out as they are installed; in the build tree they go next to the
# package's Python files instead, so that one short path makes "import vtkffd" work.
set(ffd_python_module_names)
set(ffd_python_targets)
foreach (module IN LISTS ffd_wrapped_modules)
  get_property(library TARGET "${module}" PROPERTY INTERFACE_vtk_module_library_name)
  list(APPEND ffd_python_module_names "${library}")
  list(APPEND ffd_python_targets "${library}Python")
  set_target_properties("${library}Python" PROPERTIES
    LIBRARY_OUTPUT_DIRECTORY "${ffd_python_build_package}")
  ffd_compile_quickly("${library}Python")
endforeach ()
add_custom_target(ffd_python_package)
foreach (name IN LISTS ffd_python_module_names)
  add_dependencies(ffd_python_package "${name}Python")
endforeach ()
list(SORT ffd_python_module_names)
list(JOIN ffd_python_module_names "\", \"" FFD_PYTHON_MODULES)
configure_file("${CMAKE_CURRENT_SOURCE_DIR}/Module/Python/__init__.py.in"
  "${ffd_python_build_package}/__init__.py" @ONLY)
# Optional: imported by who has PyVista, and trame-vtk.
foreach (name IN ITEMS pyvista trame)
  configure_file("${CMAKE_CURRENT_SOURCE_DIR}/Module/Python/${name}.py"
    "${ffd_python_build_package}/${name}.py" COPYONLY)
endforeach ()
install(FILES "${ffd_python_build_package}/__init__.py" "${ffd_python_build_package}/pyvista.py"
  "${ffd_python_build_package}/trame.py"
  DESTINATION "${FFD_INSTALL_PYTHONDIR}/vtkffd")

# The type stub, from the docstrings of the wrapped classes. An interpreter without sanitizers cannot load
# libraries that have them.
if (NOT FFD_SANITIZERS)
  set(ffd_python_stub "${ffd_python_build_package}/__init__.pyi")
  add_custom_command(OUTPUT "${ffd_python_stub}"
    COMMAND "${CMAKE_COMMAND}" -E env "PYTHONPATH=${ffd_python_build_root}"
      "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/Module/Python/generate_stubs.py"
      "${ffd_python_stub}"
    DEPENDS ${ffd_python_targets} "${CMAKE_CURRENT_SOURCE_DIR}/Module/Python/generate_stubs.py"
      "${ffd_python_build_package}/__init__.py"
    COMMENT "Writing the type stub of the Python package" VERBATIM)
  add_custom_target(ffd_python_stubs ALL DEPENDS "${ffd_python_stub}")
  # PEP 561: type checkers look for stubs in packages with this file.
  file(TOUCH "${ffd_python_build_package}/py.typed")
  install(FILES "${ffd_python_stub}" "${ffd_python_build_package}/py.typed"
    DESTINATION "${FFD_INSTALL_PYTHONDIR}/vtkffd")
endif ()
