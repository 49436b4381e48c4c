#!/bin/bash
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Run a command under its own virtual X server with Mesa's software rasterizer, whatever display
# and graphics card the machine has: images then do not depend on the user's desktop. The server
# picks a free display number and ends with the command, whose exit status is passed on.
#
# usage: Module/CMake/with-xvfb.sh COMMAND [ARGUMENT...]
set -euo pipefail

if [ $# -eq 0 ] || [ "$1" = --help ]; then
  sed -n '/^# Run/,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"
  exit 2
fi
if ! command -v Xvfb >/dev/null; then
  echo "with-xvfb: there is no Xvfb; install it (Debian: apt-get install xvfb libgl1-mesa-dri)" >&2
  exit 1
fi

scratch="$(mktemp -d "${TMPDIR:-/tmp}/ffd-xvfb.XXXXXX")"
server=
# shellcheck disable=SC2317 # called by the trap
cleanup() {
  if [ -n "$server" ]; then
    kill "$server" 2>/dev/null || true
    wait "$server" 2>/dev/null || true
  fi
  rm -rf "$scratch" || true
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

Xvfb -displayfd 3 -screen 0 1280x1024x24 -noreset -nolisten tcp \
  3>"$scratch/display" </dev/null >"$scratch/log" 2>&1 &
server=$!
until [ -s "$scratch/display" ] || ! kill -0 "$server" 2>/dev/null; do
  sleep 0.1
done
if ! [ -s "$scratch/display" ]; then
  echo "with-xvfb: Xvfb did not start:" >&2
  cat "$scratch/log" >&2
  exit 1
fi

# Open MPI keeps folders named by a number of 15 bits, and those of processes that were killed remain:
# here they are those of one command, and go with it. Its daemon, which outlives a command of a single
# process by a moment, deletes its own files there too; PMIx reports each that is gone before (openpmix,
# _esh_dir_del), so it keeps its data in memory.
status=0
env -u WAYLAND_DISPLAY -u XAUTHORITY OMPI_MCA_orte_tmpdir_base="$scratch" PMIX_MCA_gds=hash \
  DISPLAY=":$(tr -d '[:space:]' <"$scratch/display")" LIBGL_ALWAYS_SOFTWARE=1 "$@" || status=$?
exit "$status"
