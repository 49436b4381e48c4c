#!/bin/bash
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Set up, build and test vtkFFD on Debian 12: install missing system packages, configure and build
# everything, and run all tests under a virtual X server with Mesa's software rasteriser, so that
# the results do not depend on the desktop. Ends with ctest's summary and its exit status.
#
# usage: Testing/run-tests.sh [CTEST ARGUMENT...]     e.g. Testing/run-tests.sh -L kernels
#
# FFD_PRESET in the environment chooses the preset of CMakePresets.json: release (default), debug,
# strict, asan-ubsan or tsan. FFD_JOBS is the number of parallel compilers (default: processors).
set -euo pipefail

case "${1:-}" in
  --help | -h) sed -n '/^# Set up/,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset="${FFD_PRESET:-release}"

Module/CMake/setup-debian.sh
echo "run-tests: configuring and building (preset $preset)"
cmake --preset "$preset"
cmake --build --preset "$preset" --parallel "${FFD_JOBS:-$(nproc)}"
echo "run-tests: testing under Xvfb with Mesa's software rasteriser"
exec Module/CMake/with-xvfb.sh ctest --preset "$preset" --output-on-failure --no-tests=error "$@"
