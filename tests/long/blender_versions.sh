#!/usr/bin/env bash
# The tests of the Blender add-on and script with later Blenders, as modules of Python 3.11 (of 3.13 from 5.1 on), and the extension in an
# empty Debian, which has Python 3.11.
#
# usage: blender_versions.sh PROGRAM [VERSION...]    (default: 4.2.23 4.5.15 5.0.1, and 5.2.3 with python3.13; needs root and debootstrap)
#
# SHERD_BPY_WHEELS names a folder of wheels of bpy, which are else downloaded.
set -euo pipefail
cd "$(dirname "$0")/../.."
export SHERD_BIN
SHERD_BIN=$(realpath "$1")
shift
if [ $# -eq 0 ]; then
  set -- 4.2.23 4.5.15 5.0.1
  ! python3.13 -c '' 2> /dev/null || set -- "$@" 5.2.3
fi
venvs=()
for version in "$@"; do
  venv=build/bpy/$version
  python=python3.11
  case $version in 5.[1-9]*) python=python3.13 ;; esac
  if [ ! -e "$venv/done" ]; then
    rm -rf "$venv"
    "$python" -m venv "$venv"
    "$venv/bin/pip" install -q --disable-pip-version-check ${SHERD_BPY_WHEELS:+--find-links "$SHERD_BPY_WHEELS"} "bpy==$version"
    touch "$venv/done"
  fi
  for tests in blender blender_pieces blender_physics blender_objects blender_again blender_manners; do
    echo "Blender $version: $tests"
    BLENDER_BIN=$PWD/$venv/bin/python OCL_ICD_VENDORS=pocl.icd /usr/bin/python3 -B "tests/cli/${tests}_test.py"
  done
  echo "Blender $version: scenes in USD"
  BLENDER_BIN=$PWD/$venv/bin/python OCL_ICD_VENDORS=pocl.icd PYTHONPATH=tests/cli /usr/bin/python3 -B tests/long/blender_usd.py
  [ "$python" != python3.11 ] || venvs+=("$venv")
done
tools/build_extension.sh build/extension/out
tests/long/blender_extension.sh build/extension/out/sherd_fracture-*.zip "${venvs[@]}"
