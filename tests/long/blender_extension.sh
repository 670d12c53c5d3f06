#!/usr/bin/env bash
# Install Blender's extension where there is neither Sherd nor OpenCL: in an empty Debian 12, into a fresh profile, as the user nobody without a home; and
# break the cube.  Blender is its module for Python.
#
# usage: blender_extension.sh EXTENSION.zip VENV...    (VENV: of Python 3.11, with bpy; needs root and debootstrap)
set -euo pipefail
zip=$(realpath "$1")
shift
here=$(cd "$(dirname "$0")" && pwd)
venvs=()
for venv in "$@"; do venvs+=("$(realpath "$venv")"); done
cd "$here/../.."
source tools/release/chroot.sh
new_chroot
trap 'umount "$root/opt/blender" 2> /dev/null || true; leave_chroot "$root"; rm -rf --one-file-system "$work"' EXIT
cp "$zip" "$root/extension.zip"
cp tests/long/break_cube_by_extension.py "$root/break_cube.py"
in_chroot "$root" sh -c 'apt-get update -qq && apt-get install -y -qq --no-install-recommends python3-minimal libpython3.11-stdlib libgl1 libgomp1 libsm6 \
  libxi6 libxfixes3 libxrender1 libxkbcommon0' > "$root.apt" 2>&1 || { tail "$root.apt" >&2; exit 1; }
if in_chroot "$root" sh -c 'ldconfig -p | grep -iE "opencl|openvdb|sherd"; command -v sherd'; then
  echo "blender_extension.sh: there is Sherd or what it needs" >&2
  exit 1
fi
mkdir -p "$root/opt/blender"
for venv in "${venvs[@]}"; do
  mount --bind -o ro "$venv"/lib/python3.11/site-packages "$root/opt/blender"
  tool=$(cd "$root/opt/blender" && ls bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py)
  in_chroot "$root" env PYTHONPATH=/opt/blender python3 -B "/opt/blender/$tool" validate /extension.zip
  rm -rf "$root/profile"
  install -d -o 65534 -g 65534 "$root/profile"
  chroot --userspec=65534:65534 "$root" env -i PATH=/usr/bin:/bin PYTHONPATH=/opt/blender LD_LIBRARY_PATH=/opt/blender/bpy/lib \
    BLENDER_USER_RESOURCES=/profile python3 -B /break_cube.py /extension.zip
  umount "$root/opt/blender"
done
