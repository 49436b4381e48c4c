# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# compare_with_vtk.py on the sample tree: both mappers draw the same picture, from C++ and from Python.
# Called with PYTHON, FFD_BUILD and WORK.
file(REMOVE_RECURSE "${WORK}")
execute_process(
  COMMAND "${PYTHON}" "${CMAKE_CURRENT_LIST_DIR}/compare_with_vtk.py"
    "${CMAKE_CURRENT_LIST_DIR}/Sample" --build "${FFD_BUILD}" --work "${WORK}"
  OUTPUT_VARIABLE table
  COMMAND_ERROR_IS_FATAL ANY)
message("${table}")
foreach (test IN ITEMS TestSampleVolume.cxx SampleVolume.py)
  # Mean and largest difference; both runs ended without an error.
  if (NOT table MATCHES "\n${test} +([0-9.]+) +([0-9]+) +[0-9.]+ % +ended, ended\n")
    message(FATAL_ERROR "${test} was not compared.")
  endif ()
  if (CMAKE_MATCH_1 GREATER 2 OR CMAKE_MATCH_2 GREATER 40)
    message(FATAL_ERROR "The pictures of ${test} differ.")
  endif ()
endforeach ()
