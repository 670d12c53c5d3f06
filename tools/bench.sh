#!/usr/bin/env bash
# Run the benchmarks: nine interleaved warm runs of each, medians; then whole fractures, small to large.
#
# usage: bench.sh [BENCHMARK_ARGUMENT...]    (such as --benchmark_filter=grow/.*/256)
#
# SHERD_BENCH_MESH names the mesh to break at 64 to 1024 voxels; by default the bundled amphora.
set -euo pipefail
cd "$(dirname "$0")/.."
tools/install_packages.sh test
tools/build.sh release sherd_bench sherd_cli
OCL_ICD_VENDORS=pocl.icd build/release/tests/bench/sherd_bench --benchmark_repetitions=9 \
  --benchmark_enable_random_interleaving=true --benchmark_min_time=0.05 --benchmark_report_aggregates_only=true "$@"
OCL_ICD_VENDORS=pocl.icd /usr/bin/python3 tools/bench_sizes.py build/release/sherd "${SHERD_BENCH_MESH:-data/amphora.ply}"
