#!/usr/bin/env bash
# Count the instructions of four fixed runs by callgrind, as a table in Markdown: figures that do not depend on what else the
# machine does.  About two minutes on an idle core for a program.
#
# usage: bench_counts.sh [--quick] [--repeats N] [SHERD [BEFORE]]    (tools/bench/bench_counts.py --help describes runs and columns)
#
# SHERD is built where it is not given; BEFORE is the program without a change, whose counts are printed beside.
set -euo pipefail
options=() programs=()
while [ $# -gt 0 ]; do
  case $1 in
    --repeats) options+=("$1" "${2:?bench_counts.sh: --repeats needs a number}"); shift 2 ;;
    --*) options+=("$1"); shift ;;
    *) break ;;
  esac
done
for program in "$@"; do programs+=("$(realpath "$program")"); done
cd "$(dirname "$0")/../.."
command -v valgrind > /dev/null || tools/install_packages.sh bench >&2
if [ ${#programs[@]} -eq 0 ]; then
  tools/install_packages.sh build >&2
  tools/build.sh release sherd_cli >&2
  programs=(build/release/sherd)
fi
/usr/bin/python3 -B tools/bench/bench_counts.py ${options[@]+"${options[@]}"} "${programs[@]}"
