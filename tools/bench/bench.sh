#!/usr/bin/env bash
# Run the benchmarks: nine interleaved warm runs of each, medians; then whole fractures, small to large.
#
# usage: bench.sh [BENCHMARK_ARGUMENT...]             (such as --benchmark_filter=grow/.*/256)
#        bench.sh --ratios [BENCHMARK_ARGUMENT...]    (only what is compared with other programs, as a table of ratios)
#
# SHERD_BENCH_MESH names the mesh to break at 64 to 1024 voxels, and the dataset's of --ratios; by default the bundled
# amphora, and a torus.
set -euo pipefail
cd "$(dirname "$0")/../.."
tools/install_packages.sh test
tools/build.sh release sherd_bench sherd_cli -- -DSHERD_TESTS=ON -DSHERD_BENCH=ON
bench() {
  OCL_ICD_VENDORS=pocl.icd build/release/tests/bench/sherd_bench --benchmark_repetitions=9 \
    --benchmark_enable_random_interleaving=true --benchmark_min_time=0.05 --benchmark_report_aggregates_only=true "$@"
}
if [ "${1:-}" = --ratios ]; then
  results=$(mktemp)
  trap 'rm -f "$results"' EXIT
  bench --benchmark_out="$results" --benchmark_out_format=json \
    --benchmark_filter='^(grow/(device/(128|256|512)/0|serial_queue|two_stacks)|voxelize|meshToLevelSet|extract/(shared|independent|bare_meshes)|library/(extract|bare_meshes))' \
    "${@:2}" > /dev/null
  /usr/bin/python3 -B tools/bench/bench_ratios.py "$results"
else
  bench "$@"
  OCL_ICD_VENDORS=pocl.icd /usr/bin/python3 tools/bench/bench_sizes.py build/release/sherd "${SHERD_BENCH_MESH:-data/amphora.ply}"
fi
