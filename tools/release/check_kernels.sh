#!/usr/bin/env bash
# Run the kernel tests under oclgrind: data races and bad addresses.  A planted race must be found first.
#
# Not --uninitialized: oclgrind 21.10 does not track writes of clEnqueueFillBuffer and vectorized stores, and
# reports every read of them.
#
# usage: check_kernels.sh BUILD_FOLDER    (built with tests)
set -euo pipefail
build=${1:?usage: check_kernels.sh BUILD_FOLDER}
unset OCL_ICD_VENDORS
export SHERD_TEST_DEVICE=oclgrind SHERD_TEST_SMALL=1 SHERD_REQUIRE_OPENCL=1 SHERD_PROPERTY_CASES=2
logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT
check() {  # log, program and arguments
  timeout 900 oclgrind --data-races --max-errors 20 --log "$logs/$1" "${@:2}" > "$logs/$1.out" 2>&1
}

check planted "$build/tests/sherd_planted_race" || true
if ! grep -q 'data race' "$logs/planted"; then
  echo "check_kernels.sh: oclgrind does not report the planted race" >&2
  cat "$logs/planted" >&2
  exit 1
fi

half() {  # 0 or 1: the simulator has one thread
  GTEST_TOTAL_SHARDS=2 GTEST_SHARD_INDEX=$1 check "$1" "$build/tests/sherd_kernel_tests" --gtest_brief=1 && [ ! -s "$logs/$1" ]
}
half 0 &
first=$!
clean=yes
half 1 || clean=no
wait $first || clean=no
if [ $clean = no ]; then
  head -n 40 "$logs"/[01] "$logs"/[01].out >&2
  echo "check_kernels.sh: the kernel tests are not clean under oclgrind" >&2
  exit 1
fi
echo "oclgrind found the planted race and nothing in the kernels"
