#!/bin/bash
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The experiments of the paper, from a fresh checkout on Debian 12 or 13: install missing system packages,
# build vtkFFD into build/, and write the report to output/paper (Examples/paper_experiments).
#
# usage: Examples/paper_experiments.sh [ARGUMENT...]
#   --quick, --size N, --output DIR, ...: see Examples/paper_experiments --help
#
# FFD_JOBS in the environment is the number of parallel compilers (default: processors).
set -euo pipefail

case "${1:-}" in
  --help | -h) sed -n '/^# The experiments/,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")/.."
Module/CMake/setup-debian.sh
echo "paper_experiments: building into $PWD/build"
cmake --preset release
cmake --build --preset release --target ffd_python_package ffd_position_error \
  --parallel "${FFD_JOBS:-$(nproc)}"
python="$(sed -n 's/^Python3_EXECUTABLE:[A-Z]*=//p' build/CMakeCache.txt)"
PYTHONPATH="$PWD/build/python${PYTHONPATH:+:$PYTHONPATH}" \
  exec "$python" Examples/paper_experiments "$@"
