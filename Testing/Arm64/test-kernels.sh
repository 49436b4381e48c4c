#!/bin/bash
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Compile all kernels for arm64 with Debian's cross compiler, and run the kernel tests under QEMU: vector
# instructions of another processor, char without a sign, other rules of alignment. What is
# built goes to build-arm64.
#
# usage: Testing/Arm64/test-kernels.sh [--install] [CTEST ARGUMENT...]
#   --install   add the architecture arm64 to this system and install the packages; meant for
#               Module/CMake/fresh-root.sh bookworm bash Testing/Arm64/test-kernels.sh --install
#
# Without the packages it says "skipped: ..." and ends with status 77.
set -euo pipefail

skip() { printf 'skipped: %s\n' "$*"; exit 77; }

case "${1:-}" in
  --help | -h) sed -n '/^# Compile/,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
  --install)
    shift
    dpkg --add-architecture arm64
    apt-get -qq update
    DEBIAN_FRONTEND=noninteractive apt-get -qq install --no-remove --no-install-recommends -y \
      cmake ninja-build g++-aarch64-linux-gnu qemu-user-static libglm-dev libeigen3-dev \
      libhwy-dev:arm64 libgtest-dev:arm64 >/dev/null
    ;;
esac
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

command -v aarch64-linux-gnu-g++ >/dev/null || skip "no cross compiler (g++-aarch64-linux-gnu)"
emulator="$(command -v qemu-aarch64-static || command -v qemu-aarch64)" || skip "no emulator (qemu-user-static)"
for library in libhwy libgtest; do
  compgen -G "/usr/lib/aarch64-linux-gnu/$library.*" >/dev/null ||
    skip "no $library for arm64 (dpkg --add-architecture arm64; libhwy-dev:arm64 libgtest-dev:arm64)"
done

launcher=()
if command -v ccache >/dev/null; then
  launcher=(-D CMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
# A processor that has SVE, too, which is not to be chosen.
cmake -G Ninja -S Testing/Arm64 -B build-arm64 -D CMAKE_BUILD_TYPE=Release \
  -D CMAKE_SYSTEM_NAME=Linux -D CMAKE_SYSTEM_PROCESSOR=aarch64 \
  -D CMAKE_CXX_COMPILER=aarch64-linux-gnu-g++ -D CMAKE_LIBRARY_ARCHITECTURE=aarch64-linux-gnu \
  -D "CMAKE_CROSSCOMPILING_EMULATOR=$emulator;-cpu;max,pauth-impdef=on" "${launcher[@]}"
cmake --build build-arm64 --parallel "${FFD_JOBS:-$(nproc)}"
exec ctest --test-dir build-arm64 --parallel "${FFD_JOBS:-$(nproc)}" --output-on-failure --no-tests=error "$@"
