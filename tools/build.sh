#!/usr/bin/env bash
# Configure and build a preset quietly: one line, or the errors.
#
# usage: build.sh PRESET [TARGET...] [-- CMAKE_ARGUMENT...]
set -euo pipefail
cd "$(dirname "$0")/.."

preset=$1
shift
targets=()
while [ $# -gt 0 ] && [ "$1" != -- ]; do targets+=("$1"); shift; done
[ "${1:-}" = -- ] && shift

log=$(mktemp)
trap 'rm -f "$log"' EXIT
started=$SECONDS
if ! { cmake --preset "$preset" "$@" &&
       cmake --build "build/$preset" ${targets[@]+--target "${targets[@]}"}; } > "$log" 2>&1; then
  grep -E 'error|warning|FAILED|CMake Error' -A 5 "$log" | head -n 60 >&2 || tail -n 40 "$log" >&2
  echo "build.sh: the $preset build failed" >&2
  exit 1
fi
echo "Built build/$preset in $((SECONDS - started)) s"
