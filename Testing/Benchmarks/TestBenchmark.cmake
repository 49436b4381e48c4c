# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
# Run BENCHMARK --quick and check its REPORT: valid JSON, every row measured, none refused. Times
# are not judged.
cmake_minimum_required(VERSION 3.25)

file(REMOVE "${REPORT}")
execute_process(
  COMMAND "${BENCHMARK}" --quick --rounds=1 "--benchmark_out=${REPORT}" --benchmark_out_format=json
  RESULT_VARIABLE status)
if (NOT status EQUAL 0)
  message(FATAL_ERROR "ffd_benchmark --quick ended with ${status}.")
endif ()
file(READ "${REPORT}" report)
# An invalid file stops here with what is wrong.
string(JSON count LENGTH "${report}" benchmarks)
set(rows 0)
math(EXPR last "${count} - 1")
foreach (i RANGE ${last})
  string(JSON row GET "${report}" benchmarks ${i})
  string(JSON name GET "${row}" name)
  string(JSON refused ERROR_VARIABLE none GET "${row}" error_message)
  if (NOT refused MATCHES "NOTFOUND$")
    message(SEND_ERROR "${name} was refused: ${refused}")
    continue ()
  endif ()
  string(JSON time GET "${row}" real_time)
  string(JSON kind GET "${row}" run_type)
  if (kind STREQUAL "iteration")
    if (NOT time GREATER 0)
      message(SEND_ERROR "${name} took ${time} ms.")
    endif ()
    math(EXPR rows "${rows} + 1")
  endif ()
endforeach ()
if (rows LESS 40)
  message(FATAL_ERROR "Only ${rows} times in ${REPORT}.")
endif ()
message(STATUS "${rows} times in ${REPORT}")

# The page of targets: each figure is there, and each target says whether it is met.
execute_process(
  COMMAND "${BENCHMARK}" --targets --quick --rounds=1 "--json=${REPORT}"
    "--only=engine/opaque.*(bare|empty|fixedpoint|undeformed|bend45)|vectors|paper/opaque|Options/.*/(plain|label map|jitter)$|Sizes/|Errors/|Cores/|Folds/|Lattices/"
  OUTPUT_VARIABLE page
  RESULT_VARIABLE status)
if (NOT status EQUAL 0 OR NOT page MATCHES "targets met")
  message(FATAL_ERROR "ffd_benchmark --targets ended with ${status}: ${page}")
endif ()
file(READ "${REPORT}" report)
string(JSON count LENGTH "${report}")
set(met 0)
math(EXPR last "${count} - 1")
foreach (i RANGE ${last})
  string(JSON name GET "${report}" ${i} name)
  string(JSON figure GET "${report}" ${i} figure)
  string(JSON target ERROR_VARIABLE none GET "${report}" ${i} target)
  # Five shapes and most options are left out.
  if (name MATCHES "bend45 EXACT|empty frame beyond|undeformed, ms|paper|bend45 (label map|jitter) /|^Sizes|^Errors|^Cores|^Folds|^Lattices" AND
      NOT figure MATCHES "^-?[0-9]")
    message(SEND_ERROR "${name} has no figure: ${figure}")
  endif ()
  if (NOT target MATCHES "NOTFOUND$")
    string(JSON is_met GET "${report}" ${i} met)
    math(EXPR met "${met} + 1")
  endif ()
endforeach ()
if (met LESS 4)
  message(FATAL_ERROR "Only ${met} targets in ${REPORT}: ${report}")
endif ()
