#!/usr/bin/env bash
# Run the kernel tests under oclgrind: data races, uninitialised reads, bad addresses.  First a planted race, which it
# must find.
#
# usage: check_kernels.sh BUILD_FOLDER    (built with tests)
set -euo pipefail
build=${1:?usage: check_kernels.sh BUILD_FOLDER}
unset OCL_ICD_VENDORS
export SHERD_TEST_DEVICE=oclgrind SHERD_TEST_SMALL=1 SHERD_REQUIRE_OPENCL=1
log=$(mktemp)
trap 'rm -f "$log"' EXIT
check() { timeout 900 oclgrind --data-races --uninitialized --max-errors 20 --log "$log" "$@"; }

check "$build/tests/sherd_planted_race" > /dev/null
if ! grep -q 'data race' "$log"; then
  echo "check_kernels.sh: oclgrind does not report the planted race" >&2
  cat "$log" >&2
  exit 1
fi

: > "$log"
if ! check "$build/tests/sherd_kernel_tests" --gtest_brief=1; then
  cat "$log" >&2
  echo "check_kernels.sh: kernel tests fail under oclgrind" >&2
  exit 1
fi
if [ -s "$log" ]; then
  head -n 40 "$log" >&2
  echo "check_kernels.sh: oclgrind reports errors in the kernels" >&2
  exit 1
fi
echo "oclgrind found the planted race and nothing in the kernels"
