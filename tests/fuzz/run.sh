#!/usr/bin/env bash
# Fuzz every reader, two at a time, each with what our writers write to begin with.  One line for each: files read, files a
# second.  What crashes, hangs for 10 s or takes 2 GiB is left in the folder that is named then.
#
# usage: run.sh SHERD_FUZZ SECONDS|runs=N [TARGET...]
set -euo pipefail

export program=$1 limit=-max_total_time=$2
[[ $2 != runs=* ]] || limit=-$2
export ASAN_OPTIONS=detect_leaks=0  # Assimp leaks on some malformed files, and sherd ends after one
shift 2
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(SHERD_FUZZ=list "$program")

export folder
folder=$(mktemp -d --tmpdir sherd-fuzz-XXXXXX)
SHERD_FUZZ=corpus SHERD_FUZZ_CORPUS=$folder OCL_ICD_VENDORS=pocl.icd "$program"

fuzz() {
  mkdir -p "$folder/$1.found"
  if SHERD_FUZZ=$1 "$program" "$folder/$1" "$limit" -max_len=16384 -timeout=10 -rss_limit_mb=2048 \
      -detect_leaks=0 -verbosity=0 -print_final_stats=1 -artifact_prefix="$folder/$1.found/" > "$folder/$1.log" 2>&1; then
    echo "$1: $(awk '/number_of_executed_units/ {n = $2} /average_exec_per_sec/ {r = $2} END {print n " files read or refused, " r " a second"}' "$folder/$1.log")"
  else
    tail -n 40 "$folder/$1.log"
    echo "$1: failed, see $folder/$1.found"
    return 1
  fi
}
export -f fuzz
printf '%s\n' "${targets[@]}" | xargs -P 2 -I{} bash -c 'fuzz {}'
rm -rf "$folder"
