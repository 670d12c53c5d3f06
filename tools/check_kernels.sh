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
log=$(mktemp)
trap 'rm -f "$log"' EXIT
check() { timeout 900 oclgrind --data-races --max-errors 20 --log "$log" "$@"; }

check "$build/tests/sherd_planted_race" > /dev/null
if ! grep -q 'data race' "$log"; then
  echo "check_kernels.sh: oclgrind does not report the planted race" >&2
  cat "$log" >&2
  exit 1
fi

: > "$log"
if ! check "$build/tests/sherd_kernel_tests" --gtest_brief=1 > "$log.out" 2>&1 || [ -s "$log" ]; then
  head -n 40 "$log" "$log.out" >&2
  rm -f "$log.out"
  echo "check_kernels.sh: the kernel tests are not clean under oclgrind" >&2
  exit 1
fi
rm -f "$log.out"
echo "oclgrind found the planted race and nothing in the kernels"
