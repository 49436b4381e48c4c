#!/bin/bash
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Make a private prefix that Debian's ParaView can be built against and run from Python.
# ParaView's Python modules and the wrapping hierarchies that its CMake package asks for are in the
# package python3-paraview, which cannot be installed next to python3-vtk9. So it is downloaded and
# unpacked, not installed, and the prefix joins it with links to what paraview-dev installed.
# Needs no root. A second run with the same folder ends at once.
#
# usage: Module/CMake/setup-paraview.sh DEST
#   DEST/lib/<triplet>/cmake/paraview-<version>  for ParaView_DIR
#   DEST/lib/python3/dist-packages               for PYTHONPATH, with /usr/bin/python3
set -euo pipefail

say() { printf 'setup-paraview: %s\n' "$*"; }
die() { printf 'setup-paraview: %s\n' "$@" >&2; exit 1; }

if [ $# -ne 1 ] || [ "$1" = --help ]; then
  sed -n '/^# Make/,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"
  exit 2
fi
prefix="$1"
triplet="$(gcc -print-multiarch)"

version="$(dpkg-query -W -f '${Version}' paraview-dev 2>/dev/null || true)"
if [ -z "$version" ]; then
  die "the package paraview-dev is not installed; run Module/CMake/setup-debian.sh --paraview"
fi
if [ "$(cat "$prefix/version" 2>/dev/null || true)" = "$version" ]; then
  exit 0
fi
minor="$(cut -d. -f1,2 <<<"$version")"
release="paraview-$minor"
if ! [ -d "/usr/lib/$triplet/cmake/$release" ]; then
  die "paraview-dev $version is not laid out as Debian's: /usr/lib/$triplet/cmake/$release is missing." \
    "Point ParaView_DIR at your ParaView instead."
fi

rm -rf "$prefix"
mkdir -p "$prefix/package" "$prefix/lib/$triplet/cmake" "$prefix/lib/python3" "$prefix/include" \
  "$prefix/bin"
prefix="$(cd "$prefix" && pwd)"
say "downloading and unpacking python3-paraview $version"
(
  cd "$prefix/package"
  # Without a working folder that apt's own user can write to, apt-get only warns.
  if ! apt-get -qq download "python3-paraview=$version" 2>"$prefix/package/log"; then
    cat "$prefix/package/log" >&2
    exit 1
  fi
  dpkg -x python3-paraview_*.deb .
  rm -f python3-paraview_*.deb log
) || die "python3-paraview $version could not be downloaded; is there a network connection?" \
  "If the package lists are old, run 'apt-get update' as root first."

package="$prefix/package/usr"
# The package files find their prefix from where they are, so these are copied, the rest is linked.
cp -r "/usr/lib/$triplet/cmake/$release" "$prefix/lib/$triplet/cmake/"
mapfile -t files < <(dpkg-query -L paraview paraview-dev |
  grep -x "/usr/lib/$triplet/[^/]*" | grep -v '/cmake$')
ln -sfn "${files[@]}" "$package/lib/$triplet"/* "$prefix/lib/$triplet/"
ln -sfn "/usr/include/$release" "$prefix/include/"
ln -sfn "$package/lib/python3/dist-packages" "$prefix/lib/python3/dist-packages"
# Debian 13 names extension modules with Python's tag, of which ParaView's CMake package knows nothing.
find "$package/lib/python3/dist-packages" -name '*.cpython-*.so' | while IFS= read -r module; do
  ln -sfn "$(basename "$module")" "${module%.cpython-*}.so"
done
for program in /usr/bin/*"pv$minor"* /usr/bin/paraview /usr/bin/pvbatch* /usr/bin/pvserver /usr/bin/pvdataserver \
  /usr/bin/pvrenderserver "$package"/bin/*; do
  if [ -e "$program" ]; then
    ln -sfn "$program" "$prefix/bin/"
  fi
done
printf '%s\n' "$version" >"$prefix/version"
say "ready: $prefix"
