#!/usr/bin/env bash
# Install missing packages, build, and run every test.
#
# usage: test.sh [CTEST_ARGUMENT...]    (such as -R Flood, or -L cli; with any, not the Python module's tests)
set -euo pipefail
cd "$(dirname "$0")/.."

tools/install_packages.sh test
tools/build.sh release -- -DSHERD_TESTS=ON -DSHERD_BENCH=ON -DSHERD_PYTHON=ON -DSHERD_GPL=ON
ctest --test-dir build/release --output-on-failure --no-tests=error -j 2 "$@" | grep -vE "^ +Start |Passed +[0-9.]+ sec$"
[ $# -gt 0 ] || tools/test_python.sh
