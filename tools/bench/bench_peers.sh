#!/usr/bin/env bash
# Break one mesh by Sherd, Blender's Cell Fracture, a Python stack and OpenVDB's LevelSetFracture, and print a table:
# fragments, seconds, fragments per CPU second, peak memory and closed meshes.  Under five minutes on two cores.
#
# usage: bench_peers.sh [--quick] [OPTION...] [MESH.ply]    (options of tools/bench/bench_peers.py)
#
# --quick: 32 voxels, 3 pieces, two fractures, without Blender.  A program that is missing is a row that says so.
set -euo pipefail
cd "$(dirname "$0")/../.."
quick=()
[ "${1:-}" != --quick ] || { shift; quick=(--pieces 3 --resolution 32 --fractures 2 --blender none); }
tools/install_packages.sh test
[ ${#quick[@]} -gt 0 ] || tools/install_packages.sh bench || echo "bench_peers.sh: continues without what is missing" >&2
tools/build.sh release sherd_cli level_set_fracture -- -DSHERD_TESTS=ON -DSHERD_BENCH=ON >&2
/usr/bin/python3 -B tools/bench/bench_peers.py build/release/sherd build/release/tests/bench/level_set_fracture ${quick[@]+"${quick[@]}"} "$@"
