#!/usr/bin/env bash
# Build wheels of the Python module: one for each interpreter on PATH from 3.10 to 3.11, one of the stable ABI for all from 3.12.
#
# usage: build_wheel.sh OUT [PYTHON...]    (default: every interpreter that is found and has venv and headers)
#
# The library is that of build/release, where it is compiled if it is not there.  Build tools are pinned in python/requirements.txt
# and installed below build/python.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo "usage: build_wheel.sh OUT [PYTHON...]" >&2; exit 2; }
out=$(realpath -m "$1")
shift
work=$PWD/build/python
mkdir -p "$out" "$work"

# Prints the interpreters to build for, one a line: of each version the first.
interpreters() {
  local version python
  for version in 10 11 12 13 14 15; do
    for python in "/usr/bin/python3.$version" $(type -ap "python3.$version"); do
      "$python" -c 'import ensurepip, os, sysconfig; os.stat(sysconfig.get_path("include") + "/Python.h")' 2> /dev/null || continue
      echo "$python"
      break
    done
    [ "$version" -lt 12 ] || [ -z "${python:-}" ] || ! "$python" --version > /dev/null 2>&1 || break  # one for all from here on
  done
}

# Collects the copyright files of the packages whose libraries the wheel will hold.
collect_licenses() {
  rm -rf "$work/licenses"
  mkdir -p "$work/licenses"
  local library package
  for library in $(ldd build/release/shared/libsherd.so build/release/sherd-assimp | awk '$3 ~ /^\// {print $3}' | sort -u); do
    library=$(realpath "$library")
    package=$( (dpkg -S "$library" 2> /dev/null || dpkg -S "${library#/usr}") | head -n 1)
    package=${package%%:*}
    [[ $package == libc6 || $package == libstdc++6 || $package == libgcc-s1 ]] ||
      cp -L "/usr/share/doc/$package/copyright" "$work/licenses/$package.txt"
  done
}

quietly() {  # runs a command; its output only if it fails
  local log=$work/log
  "$@" > "$log" 2>&1 || { tail -n 40 "$log" >&2; return 1; }
}

wheel_for() {  # interpreter
  local tag tools
  tag=$("$1" -c 'import sys; print(f"cp{sys.version_info[0]}{sys.version_info[1]}")')
  tools=$work/tools-$tag
  rm -rf "$work/raw-$tag"
  if ! cmp -s python/requirements.txt "$tools/requirements.txt"; then
    rm -rf "$tools"
    "$1" -m venv "$tools"
    quietly "$tools/bin/pip" install --disable-pip-version-check --no-deps -r <(sed '/^# test/,$d' python/requirements.txt)
    cp python/requirements.txt "$tools/requirements.txt"
  fi
  quietly env PATH="$tools/bin:$PATH" "$tools/bin/pip" wheel --disable-pip-version-check --no-deps --no-build-isolation -w "$work/raw-$tag" ./python \
    --config-settings build-dir="$work/$tag" --config-settings cmake.define.SHERD_BUILD="$PWD/build/release" --config-settings cmake.define.SHERD_WERROR=ON \
    --config-settings cmake.define.SHERD_LICENSES="$work/licenses"
  quietly env PATH="$tools/bin:$PATH" "$tools/bin/auditwheel" repair -w "$out" "$work/raw-$tag"/*.whl
  rm -rf "$work/raw-$tag"
}

tools/build.sh release sherd_wheel_parts -- -DSHERD_PYTHON=ON
collect_licenses
[ $# -gt 0 ] || mapfile -t found < <(interpreters)
for python in ${@+"$@"} ${found[@]+"${found[@]}"}; do
  wheel_for "$python"
  echo "built for $("$python" --version) ($python)"
done
ls -sh1 "$out"/*.whl
