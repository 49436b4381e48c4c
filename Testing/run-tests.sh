#!/bin/bash
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Set up, build and test vtkFFD on Debian 12 or 13: install missing system packages, configure and build
# everything, and run all tests under a virtual X server with Mesa's software rasterizer, so that
# the results do not depend on the desktop. Ends with ctest's summary and its exit status.
#
# usage: Testing/run-tests.sh [CTEST ARGUMENT...]     e.g. Testing/run-tests.sh -L kernels
#
# FFD_PRESET in the environment chooses the preset of CMakePresets.json: release (default), debug,
# strict, asan-ubsan or tsan. FFD_JOBS is the number of parallel compilers (default: processors).
# The release preset builds and tests the ParaView plugin as well; FFD_PARAVIEW=0 leaves it out.
set -euo pipefail

case "${1:-}" in
  --help | -h) sed -n '/^# Set up/,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset="${FFD_PRESET:-release}"

setup=()
options=()
if [ "$preset" = release ]; then
  if [ "${FFD_PARAVIEW:-1}" = 0 ]; then
    options=(-D FFD_BUILD_PARAVIEW_PLUGIN=OFF)
  else
    setup=(--paraview)
    options=(-D FFD_BUILD_PARAVIEW_PLUGIN=ON)
  fi
  setup+=(--documentation)
fi
Module/CMake/setup-debian.sh "${setup[@]}"
echo "run-tests: configuring and building (preset $preset)"
cmake --preset "$preset" "${options[@]}"
cmake --build --preset "$preset" --parallel "${FFD_JOBS:-$(nproc)}"
echo "run-tests: testing under Xvfb with Mesa's software rasterizer"
exec Module/CMake/with-xvfb.sh ctest --preset "$preset" --output-on-failure --no-tests=error "$@"
