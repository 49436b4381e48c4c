#!/bin/bash
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Start ParaView with the plugin FFDVolume on Debian 12 or 13: install missing system packages, build the
# plugin into build/, and open a volume with a lattice to shape it by. ParaView's Python works in it:
# Python Shell, Start Trace, pvpython and pvbatch.
#
# usage: Examples/paraview.sh [VOLUME [ARGUMENT...]]
#        Examples/paraview.sh pvpython|pvbatch|pvserver [ARGUMENT...]
#        Examples/paraview.sh -n COUNT pvbatch|pvserver [ARGUMENT...]
#   VOLUME      an image that ParaView reads: .vti, .mha, .nrrd, .nii, ..., or a folder of DICOM slices;
#               default: the engine block
#   ARGUMENT    those of the program; without any pvpython is interactive
#   -n COUNT    that many processes, started by mpiexec
#
# Without a display pvpython, pvbatch and pvserver run under a virtual X server. In the environment,
# FFD_JOBS is the number of parallel compilers (default: processors), and FFD_SKIP_BUILD=1 starts what
# has been built in FFD_BUILD_DIR (default: build/).
set -euo pipefail

say() { printf 'paraview: %s\n' "$*" >&2; }
die() { printf 'paraview: %s\n' "$@" >&2; exit 1; }

processes=1
if [ "${1:-}" = -n ]; then
  [[ "${2:-}" =~ ^[1-9][0-9]*$ ]] || die "-n needs a number of processes; see $0 --help"
  processes="$2"
  shift 2
fi
program=paraview
case "${1:-}" in
  --help | -h) sed -n '/^# Start/,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
  pvpython | pvbatch | pvserver)
    program="$1"
    shift
    ;;
  -*) die "unknown option '$1'; see $0 --help" ;;
esac
if [ "$processes" -gt 1 ] && [ "$program" != pvbatch ] && [ "$program" != pvserver ]; then
  die "several processes are for pvbatch and pvserver; see $0 --help"
fi

source_dir="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
build="${FFD_BUILD_DIR:-$source_dir/build}"
if [ "$program" = paraview ]; then
  volume="$(realpath -m "${1:-$source_dir/Testing/Data/engine.vti}")"
  [ -e "$volume" ] || die "there is no file '$volume'"
  [ $# -eq 0 ] || shift
  [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] ||
    die "ParaView's window needs a display: DISPLAY is not set." \
      "pvpython, pvbatch and pvserver need none; see $0 --help"
fi

if [ "${FFD_SKIP_BUILD:-0}" != 1 ]; then
  (
    cd "$source_dir"
    Module/CMake/setup-debian.sh --paraview
    say "building the plugin into $build"
    cmake --preset release -D FFD_BUILD_PARAVIEW_PLUGIN=ON -B "$build"
    cmake --build "$build" --target ffd_paraview --parallel "${FFD_JOBS:-$(nproc)}"
  ) >&2
fi

plugin="$(find "$build/paraview" -path '*/plugins/FFDVolume/FFDVolume.so' -print -quit 2>/dev/null || true)"
[ -n "$plugin" ] || die "the plugin has not been built in $build; run without FFD_SKIP_BUILD"
modules="$build/paraview-prefix/lib/python3/dist-packages"
python="$(sed -n 's/^Python3_EXECUTABLE:[A-Z]*=//p' "$build/CMakeCache.txt")"
# The folder of the plugin's folder: ParaView takes none of the plugin's other libraries for plugins then.
export PV_PLUGIN_PATH="${plugin%/FFDVolume/FFDVolume.so}${PV_PLUGIN_PATH:+:$PV_PLUGIN_PATH}"
export PYTHONPATH="$modules${PYTHONPATH:+:$PYTHONPATH}"
# More processes than processors (Open MPI 4, and 5).
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_mpi_yield_when_idle=1
export PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
# Open MPI starts nothing as root otherwise, which is who one is in containers.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# Where ParaView needs it to read files of XML, see ExpatWithoutDeferral.cxx.
expat="$build/paraview/lib/libFFDExpatWithoutDeferral.so"
if [ -e "$expat" ]; then
  export LD_PRELOAD="$expat${LD_PRELOAD:+:$LD_PRELOAD}"
fi

case "$program" in
  paraview)
    export FFD_PARAVIEW_VOLUME="$volume"
    exec paraview --script="$source_dir/Examples/Python/paraview_volume.py" "$@"
    ;;
  pvpython)
    # Debian's pvpython takes the modules of python3-vtk9, of another VTK than ParaView's.
    command=("$python" "$@")
    [ $# -gt 0 ] || command+=(-i -c "from paraview.simple import *")
    ;;
  *) command=("$program" "$@") ;;
esac
if [ "$processes" -gt 1 ]; then
  command=(mpiexec -n "$processes" "${command[@]}")
fi
if [ -z "${DISPLAY:-}" ]; then
  command=("$source_dir/Module/CMake/with-xvfb.sh" "${command[@]}")
fi
exec "${command[@]}"
