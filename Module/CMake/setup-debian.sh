#!/bin/bash
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Install the packages of Debian 12 or 13 that vtkFFD is built and tested with. Packages that are
# there already are left alone, so a second run only looks and ends in a moment.
#
# usage: Module/CMake/setup-debian.sh [--paraview] [--documentation] [--list | --help]
#   --paraview       those of the ParaView plugin, too
#   --documentation  those that build the documentation and check formats and types, too
#   --list           print the packages and stop
#
# FFD_SKIP_SETUP=1 in the environment skips the check: for systems that have the same
# dependencies by other means.
set -euo pipefail

packages=(
  # to build
  g++ cmake ninja-build
  libvtk9-dev libglm-dev libhwy-dev libeigen3-dev libhdf5-dev libx11-dev
  python3 python3-dev python3-vtk9 python3-numpy
  # to test and measure
  libgtest-dev libbenchmark-dev elastix
  # to draw the curves of Examples/paper_experiments
  python3-matplotlib
  # to render without a display: an X server and Mesa's software rasterizer
  xvfb xauth libgl1-mesa-dri libxtst6
)

say() { printf 'setup: %s\n' "$*"; }
die() { printf 'setup: %s\n' "$@" >&2; exit 1; }

system=unknown
if [ -r /etc/os-release ]; then
  # shellcheck source=/dev/null
  system="$(. /etc/os-release && printf '%s %s' "${ID:-unknown}" "${VERSION_ID:-}")"
fi

if [ "${1:-}" = --paraview ]; then
  shift
  # ParaView, the Qt that it is built with for the plugin's panel (and for the icons of ParaView 5.13), what
  # makes its help pages, and MPI's launcher for parallel servers. What else the plugin needs cannot be
  # installed next to python3-vtk9: setup-paraview.sh.
  packages+=(paraview paraview-dev libxi-dev openmpi-bin)
  case "$system" in
    "debian 12") # ParaView 5.11
      packages+=(qtbase5-dev qttools5-dev libqt5svg5-dev libqt5opengl5-dev) ;;
    "debian 13") packages+=(qt6-base-dev qt6-tools-dev qt6-svg-dev qt6-svg-plugins qt6-5compat-dev) ;; # 5.13
    *) packages+=(qt6-base-dev qt6-tools-dev qt6-svg-dev qt6-5compat-dev) ;;
  esac
fi
if [ "${1:-}" = --documentation ]; then
  shift
  packages+=(doxygen mypy)
  # Debian 13 has later versions only, which format otherwise; there that test counts as skipped.
  if [ "$system" = "debian 12" ]; then
    packages+=(clang-format-14)
  fi
fi
case "${1:-}" in
  --list) printf '%s\n' "${packages[@]}"; exit 0 ;;
  --help | -h) sed -n '/^# Install/,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
  "") ;;
  *) die "unknown option '$1'; see $0 --help" ;;
esac

if [ "${FFD_SKIP_SETUP:-0}" = 1 ]; then
  say "FFD_SKIP_SETUP=1: not checking for packages"
  exit 0
fi

case "$system" in
  "debian 12" | "debian 13") ;;
  *)
    die "this script knows the packages of Debian 12 and 13 only; this system is '$system'." \
      "Install what corresponds to: ${packages[*]}" \
      "then run again with FFD_SKIP_SETUP=1 in the environment."
    ;;
esac

# Status of each package; unknown ones are silent, hence counted as missing.
declare -A installed=()
while read -r package status; do
  if [ "$status" = installed ]; then
    installed[$package]=1
  fi
done < <(dpkg-query -W -f '${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null || true)
missing=()
for package in "${packages[@]}"; do
  [ -n "${installed[$package]:-}" ] || missing+=("$package")
done
if [ "${#missing[@]}" -eq 0 ]; then
  say "all ${#packages[@]} system packages are there"
  exit 0
fi

manual="apt-get update && apt-get install --no-install-recommends ${missing[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    die "these packages are missing: ${missing[*]}" \
      "Installing them needs root, and there is no sudo here. As root, run:" "  $manual"
  fi
  if sudo -n true 2>/dev/null; then
    as_root=(sudo -n)
  elif [ -t 2 ] && [ -r /dev/tty ]; then
    say "sudo may ask for your password to install packages"
    as_root=(sudo)
  else
    die "these packages are missing: ${missing[*]}" \
      "Installing them needs root; sudo wants a password, and there is no terminal to ask on." \
      "As root, run:" "  $manual"
  fi
fi

log="$(mktemp "${TMPDIR:-/tmp}/ffd-setup.XXXXXX")"
# apt_get <what for> <arguments>...: quiet unless it fails.
apt_get() {
  local purpose="$1"
  shift
  # --no-remove: never take another package away (python3-paraview excludes python3-vtk9).
  if ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq --no-remove \
    -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 -o Dpkg::Use-Pty=0 \
    "$@" </dev/null >"$log" 2>&1; then
    tail -n 25 "$log" >&2
    rm -f "$log"
    die "$purpose failed; apt-get's last lines are above." \
      "Missing packages: ${missing[*]}" \
      "Is there a network connection, and do the apt sources hold Debian's 'main'? If apt wants" \
      "to remove packages, they conflict with these (python3-paraview does)." \
      "Once that is settled run this again, or as root:" "  $manual"
  fi
}

say "installing ${#missing[@]} missing Debian packages and what they need (some minutes):"
say "  ${missing[*]}"
start=$SECONDS
# "error-mode=any": without it apt-get reports success when the network is down.
apt_get "updating the package lists" -o APT::Update::Error-Mode=any update
apt_get "installing packages" install -y --no-install-recommends "${missing[@]}"
rm -f "$log"
say "done in $((SECONDS - start)) s"
