#!/usr/bin/env bash
# Measure growth on every OpenCL device of this machine beside the built-in device, in less than ten minutes: kernel tests,
# growth at 64 to 1024 voxels, batches of 1 to 256 fractures, transfers, launches, points, and the tuning of launches.
# Prints one table in Markdown with the chip's name and its driver's version.  Sizes that would take too long, or more
# memory than there is, are left out of it.
#
# usage: bench_gpu.sh [--seconds N] [DEVICE...]    (N: default 480; DEVICE: parts of names, default every OpenCL device)
#        bench_gpu.sh --pack FILE.tar.gz           (an archive for a machine without packages, compiler and network)
#
# With PoCL alone: OCL_ICD_VENDORS=pocl.icd.  Mesa's rusticl on a CPU: OCL_ICD_VENDORS=rusticl.icd RUSTICL_ENABLE=llvmpipe.
# On the other machine (x86-64, glibc 2.36 or later): tar xzf FILE.tar.gz && bench_gpu/bench_gpu.sh
#
# Exit status: 0 it has measured; 1 kernel tests failed, or labels differ; 2 wrong arguments; 4 no OpenCL device can be used,
# among them an NVIDIA driver without its OpenCL library (libnvidia-opencl.so.1), with a sentence.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

seconds=480 pack=""
while [ $# -gt 0 ]; do
  case $1 in
    --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit 0 ;;
    --seconds) seconds=${2:?bench_gpu.sh: --seconds needs a number}; shift 2 ;;
    --pack) pack=${2:?bench_gpu.sh: --pack needs a file}; pack=$(realpath -m "$pack"); shift 2 ;;
    --*) echo "bench_gpu.sh: unknown option $1 (see --help)" >&2; exit 2 ;;
    *) break ;;
  esac
done

# Where the programs are: in an unpacked archive, or built here.
if [ -d "$here/programs" ]; then
  bench=$here/programs/device_bench tests=$here/programs/sherd_kernel_tests
  export LD_LIBRARY_PATH=$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
else
  cd "$here/../.."
  tools/install_packages.sh test >&2
  tools/build.sh release device_bench sherd_kernel_tests -- -DSHERD_TESTS=ON -DSHERD_BENCH=ON >&2
  bench=$PWD/build/release/tests/bench/device_bench tests=$PWD/build/release/tests/sherd_kernel_tests
fi
work=$(mktemp -d) processes=()
trap 'kill "${processes[@]}" 2> /dev/null || true; rm -rf "$work"' EXIT

if [ -n "$pack" ]; then
  mkdir -p "$work/bench_gpu/programs" "$work/bench_gpu/lib"
  cp "$here/bench_gpu.sh" "$work/bench_gpu/"
  for program in "$bench" "$tests"; do strip -o "$work/bench_gpu/programs/$(basename "$program")" "$program"; done
  # All but glibc, whose version has to be the one of the machine's drivers; with OpenCL's loader, which is opened at run time.
  { ldd "$bench" "$tests" | awk '$2 == "=>" { print $3 }'; ldconfig -p | awk '/libOpenCL.so.1 .*x86-64/ && !found++ { print $NF }'; } |
    sort -u | grep -vE '/(libc|libm|libdl|librt|libpthread|ld-linux[^/]*)\.so' | xargs -I{} cp -L {} "$work/bench_gpu/lib/"
  tar -C "$work" -czf "$pack" bench_gpu
  echo "$pack: $(($(stat -c %s "$pack") >> 20)) MiB"
  exit 0
fi

# The folder or folders where NVIDIA's driver has its libraries; some machines have no file that names them to OpenCL's loader.
nvidia_library() {
  local folder
  ldconfig -p 2> /dev/null | awk '/libnvidia-opencl.so.1 .*x86-64/ && !found++ { print $NF } END { exit !found }' && return
  for folder in ${LD_LIBRARY_PATH:+${LD_LIBRARY_PATH//:/ }} /usr/local/nvidia/lib64 /usr/lib64 /usr/lib/x86_64-linux-gnu; do
    [ ! -e "$folder/libnvidia-opencl.so.1" ] || { echo "$folder/libnvidia-opencl.so.1"; return; }
  done
  return 1
}
if [ -e /proc/driver/nvidia/version ] || [ -e /dev/nvidiactl ]; then
  if ! library=$(nvidia_library); then
    echo "bench_gpu.sh: this machine has an NVIDIA driver without its OpenCL library libnvidia-opencl.so.1 (Debian's nvidia-opencl-icd," \
      "or NVIDIA_DRIVER_CAPABILITIES=compute in a container), so that no kernel can run on its GPU" >&2
    exit 4
  fi
  if [ -z "${OCL_ICD_VENDORS:-}" ] && ! grep -qs nvidia-opencl /etc/OpenCL/vendors/*.icd; then
    mkdir "$work/vendors"
    cp /etc/OpenCL/vendors/*.icd "$work/vendors/" 2> /dev/null || true
    echo "$library" > "$work/vendors/nvidia.icd"
    export OCL_ICD_VENDORS=$work/vendors LD_LIBRARY_PATH=${LD_LIBRARY_PATH:+$LD_LIBRARY_PATH:}$(dirname "$library")
  fi
fi

status=0
"$bench" --list > "$work/devices" || status=$?
if [ ! -s "$work/devices" ] || [ $status -ne 0 ]; then exit 4; fi  # it has printed why
if [ $# -gt 0 ]; then devices=("$@"); else mapfile -t devices < "$work/devices"; fi

# Kernel tests: a third of the time at most for all devices, shared by a process for each core.
shards=$(($(nproc) < 8 ? $(nproc) : 8))
row="| kernel tests | |"
for device in "${devices[@]}"; do
  filter="*"  # what takes longer loops than llvmpipe has is left out
  case $device in *llvmpipe*)
    filter="-Growths.EuclidEqualsItsStagesOneByOne:Properties.*:Rough.TheSameSeedGivesTheSameCrackInFinerVoxels" ;;
  esac
  code=0 processes=()
  for ((shard = 0; shard < shards; ++shard)); do
    GTEST_TOTAL_SHARDS=$shards GTEST_SHARD_INDEX=$shard SHERD_REQUIRE_OPENCL=1 SHERD_TEST_DEVICE=$device SHERD_PROPERTY_CASES=60 \
      timeout $((seconds / 3 / ${#devices[@]} + 1)) "$tests" --gtest_brief=1 --gtest_filter="$filter" > "$work/tests.$shard" 2>&1 &
    processes+=($!)
  done
  for shard in "${!processes[@]}"; do
    ended=0
    wait "${processes[shard]}" || ended=$?
    case $ended in
      0) ;;
      124) [ $code -ne 0 ] || code=124 ;;
      *) code=$ended; tail -n 20 "$work/tests.$shard" >&2 ;;
    esac
  done
  processes=()
  cat "$work"/tests.* > "$work/tests"
  passed=$(awk '/^\[  PASSED  \] [0-9]+ tests?\.$/ { sum += $4 } END { print sum + 0, "passed" }' "$work/tests")
  case $code in
    0) row+=" $passed |" ;;
    124) row+=" no time for all, none of those run failed |"; ! grep -q '^\[  FAILED' "$work/tests" || { row="${row% no time*} FAILED |"; status=1; } ;;
    *) row+=" FAILED |"; status=1 ;;
  esac
done
"$bench" $((seconds - SECONDS)) "${devices[@]}" builtin > "$work/table"
cat "$work/table"
echo "$row |"
! grep -q '| NO |' "$work/table" || status=1
exit $status
