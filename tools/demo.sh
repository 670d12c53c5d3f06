#!/usr/bin/env bash
# From a fresh checkout to fragments: install missing packages, build, break the bundled amphora.
#
# usage: demo.sh [OUTPUT_FOLDER]    (default: demo-pieces)
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-demo-pieces}

tools/install_packages.sh build
tools/build.sh release sherd_cli -- -DSHERD_TESTS=OFF -DSHERD_BENCH=OFF -DSHERD_GPL=ON
build/release/sherd fracture data/amphora.ply -o "$out" --pieces 8 --seed 1
echo "Eight pieces:  $out/fragments/*.vdb and $out/meshes/*.ply"
echo "Their voxels:  $out/labels.rle"
echo "The preview:   $out/preview.png"
