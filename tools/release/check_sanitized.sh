#!/usr/bin/env bash
# Run the unit and kernel tests that were built with the sanitizers (preset asan).
#
# usage: check_sanitized.sh
set -euo pipefail
cd "$(dirname "$0")/../.."
export OCL_ICD_VENDORS=pocl.icd
# No leak check: LeakSanitizer's tracer crashes now and then beside PoCL's threads.
export ASAN_OPTIONS=detect_leaks=0

# In two processes, not in one for each test as ctest has it: a sanitized program takes a second to start.
half() {  # 0 or 1
  local test
  for test in sherd_tests sherd_kernel_tests; do
    GTEST_TOTAL_SHARDS=2 GTEST_SHARD_INDEX=$1 "build/asan/tests/$test" --gtest_brief=1 || return 1
  done
}
half 0 &
first=$!
clean=yes
half 1 || clean=no
wait $first || clean=no
[ $clean = yes ]
