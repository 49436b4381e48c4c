#!/bin/bash
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#
# From a fresh checkout to pictures on Debian 12 or 13: install missing system packages, build vtkFFD
# into build/, and render a deformed volume (Examples/Python/render_deformed.py). Prints where the
# pictures are and what was measured.
#
# usage: Examples/quickstart.sh [--interactive | --no-interactive] [--output DIR] [--help]
#   --interactive     open a window to turn the volume in; an error when there is no display
#   --no-interactive  never open a window: pictures only, rendered under a virtual X server
#                     default: a window if there is a display and this runs in a terminal
#   --output DIR      where the pictures go; default: output/ in the checkout
#
# FFD_JOBS in the environment is the number of parallel compilers (default: processors).
set -euo pipefail

say() { printf 'quickstart: %s\n' "$*"; }
die() { printf 'quickstart: %s\n' "$@" >&2; exit 1; }

interactive=auto
output=
while [ $# -gt 0 ]; do
  case "$1" in
    --interactive) interactive=yes ;;
    --no-interactive) interactive=no ;;
    --output)
      [ $# -ge 2 ] || die "--output needs a folder"
      output="$2"
      shift
      ;;
    --output=*) output="${1#--output=}" ;;
    --help | -h) sed -n '/^# From/,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) die "unknown option '$1'; see $0 --help" ;;
  esac
  shift
done

source_dir="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
if [ -z "$output" ]; then
  output="$source_dir/output"
fi
mkdir -p "$output"
output="$(cd "$output" && pwd)"
cd "$source_dir"

Module/CMake/setup-debian.sh

say "building the libraries and the Python package into $source_dir/build"
cmake --preset release
cmake --build --preset release --target ffd_python_package --parallel "${FFD_JOBS:-$(nproc)}"
python="$(sed -n 's/^Python3_EXECUTABLE:[A-Z]*=//p' build/CMakeCache.txt)"

# Whether the X display that DISPLAY names can be opened.
display_works() {
  [ -n "${DISPLAY:-}" ] || return 1
  timeout 10 "$python" -c '
import ctypes, sys
x11 = ctypes.CDLL("libX11.so.6")
x11.XOpenDisplay.restype = ctypes.c_void_p
sys.exit(0 if x11.XOpenDisplay(None) else 1)' 2>/dev/null
}

case "$interactive" in
  yes) display_works || die "--interactive: the X display '${DISPLAY:-}' cannot be opened" ;;
  auto)
    interactive=no
    if [ -z "${CI:-}" ] && [ -t 0 ] && [ -t 1 ] && display_works; then
      interactive=yes
    fi
    ;;
esac

demo=("$python" Examples/Python/render_deformed.py --output "$output")
export PYTHONPATH="$source_dir/build/python${PYTHONPATH:+:$PYTHONPATH}"
started="$(mktemp "${TMPDIR:-/tmp}/ffd-quickstart.XXXXXX")"
trap 'rm -f "$started"' EXIT
if [ "$interactive" = yes ]; then
  say "rendering; a window opens on display $DISPLAY, close it to end"
  "${demo[@]}" --interactive
else
  say "rendering without a window"
  Module/CMake/with-xvfb.sh "${demo[@]}"
fi

pictures="$(find "$output" -type f -newer "$started" | sort)"
if [ -z "$pictures" ]; then
  die "the demo ended without an error but wrote nothing into $output"
fi
say "what was measured is above; the pictures are:"
while IFS= read -r picture; do
  printf '  %s\n' "$picture"
done <<<"$pictures"
