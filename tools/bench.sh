#!/usr/bin/env bash
# Run the benchmarks: nine interleaved warm runs of each, medians.
#
# usage: bench.sh [BENCHMARK_ARGUMENT...]    (such as --benchmark_filter=grow/.*/256)
set -euo pipefail
cd "$(dirname "$0")/.."
tools/install_packages.sh test
tools/build.sh release sherd_bench
OCL_ICD_VENDORS=pocl.icd build/release/tests/bench/sherd_bench --benchmark_repetitions=9 \
  --benchmark_enable_random_interleaving=true --benchmark_min_time=0.05 --benchmark_report_aggregates_only=true "$@"
