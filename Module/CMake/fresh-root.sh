#!/bin/bash
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Run a command in a clean clone of this repository on a fresh, minimal Debian: what somebody meets who
# has only just installed it. debootstrap makes the system in a folder of its own, from the mirror
# that this machine's apt is configured for; the folder is removed afterwards. Needs root.
#
# usage: Module/CMake/fresh-root.sh SUITE COMMAND [ARGUMENT...]
#   e.g. Module/CMake/fresh-root.sh trixie bash Examples/quickstart.sh
#        Module/CMake/fresh-root.sh bookworm bash Testing/run-tests.sh
#
# The clone is that of the last commit. Variables whose names start with FFD_ are passed on, and CI.
#   TMPDIR               where the folder is made (4 GB for the quick start, 8 for the tests)
#   FFD_ROOT_CACHE=DIR   keep downloaded packages and what the compilers made in DIR, and begin with what
#                        is there: ccache is installed besides then. Default: nothing is kept
#   FFD_ROOT_OUTPUT=DIR  copy the clone's output/ and Testing/Temporary to DIR at the end
set -euo pipefail

say() { printf 'fresh-root: %s\n' "$*"; }
die() { printf 'fresh-root: %s\n' "$@" >&2; exit 1; }

# Everything that mounts runs in a namespace of its own, which takes its mounts and processes with it
# however it ends; what removes the folder never sees a mount in it.
inside() {
  local suite="$1" mirror="$2" source="$3" work="$4" cache="${FFD_ROOT_CACHE:-}" root="$4/root"
  shift 4
  local options=(--variant=minbase)
  if [ -n "$cache" ]; then
    mkdir -p "$cache/$suite/packages" "$cache/$suite/ccache"
    options+=("--cache-dir=$cache/$suite/packages" --include=ccache)
  fi
  say "making a minimal $suite from $mirror"
  debootstrap "${options[@]}" "$suite" "$root" "$mirror" >"$work/log" 2>&1 ||
    { tail -n 25 "$work/log" >&2; die "debootstrap failed; its last lines are above"; }
  git clone --quiet --no-hardlinks "$source" "$root/vtkffd"
  cp /etc/resolv.conf "$root/etc/"
  # Debian's installer writes it, debootstrap does not.
  [ -e "$root/etc/hosts" ] || printf '127.0.0.1\tlocalhost\n::1\tlocalhost\n' >"$root/etc/hosts"
  apt-config dump | { grep -E '^Acquire::[^ ]*Proxy' || true; } >"$root/etc/apt/apt.conf.d/10proxy"

  # The system need not outlive a power cut: packages are unpacked without waiting for the disk.
  echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/fresh-root"

  mount -t proc proc "$root/proc"
  mount -t tmpfs -o mode=755 dev "$root/dev"
  local node
  for node in null zero full random urandom tty; do
    : >"$root/dev/$node"
    mount --bind "/dev/$node" "$root/dev/$node"
  done
  mkdir "$root/dev/shm" "$root/dev/pts"
  mount -t tmpfs shm "$root/dev/shm"
  mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts"
  ln -s pts/ptmx "$root/dev/ptmx"
  ln -s /proc/self/fd "$root/dev/fd"

  local environment=(HOME=/root LANG=C.UTF-8 PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin)
  local variable
  while read -r variable; do
    environment+=("$variable=${!variable}")
  done < <(compgen -e | grep -E '^(FFD_|CI$|(https?|ftp|no)_proxy$)' | grep -v '^FFD_ROOT_')
  if [ -n "$cache" ]; then
    mkdir -p "$root/cache"
    mount --bind "$cache/$suite/ccache" "$root/cache"
    mount --bind "$cache/$suite/packages" "$root/var/cache/apt/archives"
    environment+=(CCACHE_DIR=/cache CCACHE_COMPILERCHECK=content)
  fi

  say "running in $root/vtkffd: $*"
  local status=0 start=$SECONDS
  # shellcheck disable=SC2016 # expanded in the root
  env -i "${environment[@]}" chroot "$root" bash -c 'cd /vtkffd && exec "$@"' bash "$@" || status=$?
  say "'$*' on $suite: status $status after $((SECONDS - start)) s"
  if [ -n "${FFD_ROOT_OUTPUT:-}" ]; then
    mkdir -p "$FFD_ROOT_OUTPUT"
    cp -r "$root"/vtkffd/output "$root"/vtkffd/build/Testing/Temporary "$FFD_ROOT_OUTPUT" 2>/dev/null || true
  fi
  return "$status"
}

case "${1:-}" in
  --inside) shift; inside "$@"; exit ;;
  -* | "") sed -n '/^# Run/,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 2 ;;
esac
[ $# -ge 2 ] || die "there is no command; see $0 --help"
[ "$(id -u)" -eq 0 ] || die "making a system of its own needs root"
for program in debootstrap git unshare; do
  command -v "$program" >/dev/null || die "there is no $program here; as root: apt-get install $program"
done

suite="$1"
shift
source="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
# shellcheck disable=SC2016 # apt expands them
mirror="$(apt-get indextargets --format '$(LABEL) $(REPO_URI)' 'Created-By: Packages' |
  sed -n '/^Debian /{s/^Debian //p;q}')"
[ -n "$mirror" ] || die "apt is not configured for any mirror of Debian"

work="$(mktemp -d "${TMPDIR:-/tmp}/ffd-root.XXXXXX")"
chmod 755 "$work"
child=
# shellcheck disable=SC2317 # called by the trap
cleanup() {
  if [ -n "$child" ]; then
    # unshare heeds nothing less, and all processes of the namespace go with it.
    kill -KILL "$child" 2>/dev/null || true
    wait "$child" 2>/dev/null || true
  fi
  rm -rf --one-file-system "$work"
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP
unshare --mount --propagation private --pid --fork --kill-child --mount-proc \
  "${BASH_SOURCE[0]}" --inside "$suite" "$mirror" "$source" "$work" "$@" &
child=$!
status=0
wait "$child" || status=$?
child=
exit "$status"
