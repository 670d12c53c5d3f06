#!/usr/bin/env bash
# Install the Debian packages that are missing.
#
# usage: install_packages.sh build|test|ci|hosts|window|pictures|bench
#   build  dependencies of the library and the program
#   test   also dependencies of the tests
#   ci     also sanitizers, oclgrind, valgrind and the formatter
#   hosts  programs that read Sherd's files: Blender, OpenImageIO
#   window  Blender on a virtual screen
#   pictures  dependencies of the images of the documents
#   bench  what Sherd is measured by, and programs that it is compared with
set -euo pipefail

build=(cmake ninja-build g++ libopenvdb-dev libtbb-dev libboost-iostreams-dev libimath-dev libopenexr-dev libglm-dev
  clang opencl-c-headers opencl-clhpp-headers libassimp-dev libdraco-dev libembree-dev libqhull-dev libhdf5-dev
  libcgal-dev libpng-dev zlib1g-dev libzstd-dev libssl-dev libcli11-dev nlohmann-json3-dev)
test=(libgtest-dev libbenchmark-dev python3 python3-dev python3-venv python3-numpy python3-scipy python3-openvdb python3-jsonschema python3-h5py python3-torch
  ocl-icd-libopencl1 pocl-opencl-icd mesa-opencl-icd)
hosts=(blender python3-openimageio)
window=(blender xvfb xdotool imagemagick libgl1-mesa-dri)
pictures=(python3-numpy python3-pil python3-matplotlib blender)
bench=(valgrind blender python3-openvdb python3-skimage)
ci=(clang-format doxygen universal-ctags libclang-rt-14-dev oclgrind valgrind ccache)

case "${1:-}" in
  build) wanted=("${build[@]}") ;;
  test) wanted=("${build[@]}" "${test[@]}") ;;
  ci) wanted=("${build[@]}" "${test[@]}" "${ci[@]}") ;;
  hosts) wanted=("${hosts[@]}") ;;
  window) wanted=("${window[@]}") ;;
  pictures) wanted=("${build[@]}" "${pictures[@]}") ;;
  bench) wanted=("${bench[@]}") ;;
  *) echo "usage: install_packages.sh build|test|ci|hosts|window|pictures|bench" >&2; exit 2 ;;
esac

missing=()
for package in "${wanted[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq &&
       "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
     } > "$log" 2>&1; then
  tail -n 20 "$log" >&2
  echo "install_packages.sh: apt-get could not install ${missing[*]}" >&2
  exit 1
fi
