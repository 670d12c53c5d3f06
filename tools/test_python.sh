#!/usr/bin/env bash
# Build the wheel for Debian's Python, install it in a fresh virtual environment below build/python, and test what is installed; and once more
# beside Debian's PyTorch, which needs Debian's NumPy.
#
# usage: test_python.sh [PYTEST_ARGUMENT...]
set -euo pipefail
cd "$(dirname "$0")/.."
python=/usr/bin/python3
work=$PWD/build/python

rm -rf "$work/wheel" "$work/venv" "$work/venv-torch"
tools/build_wheel.sh "$work/wheel" "$python"
[ -f "$(echo "$work"/wheel/*-manylinux_2_35_x86_64.whl)" ] || { echo "test_python.sh: the wheel is not for manylinux_2_35" >&2; exit 1; }
[ "$(stat -c %s "$work"/wheel/*.whl)" -lt 50000000 ] || { echo "test_python.sh: the wheel has 50 MB or more" >&2; exit 1; }
"$work"/tools-cp3*/bin/auditwheel show "$work"/wheel/*.whl > "$work/show"
grep -q 'manylinux_2_35' "$work/show" || { cat "$work/show" >&2; exit 1; }

# What the tests need is downloaded once.
if ! cmp -s python/requirements.txt "$work/downloads/requirements.txt"; then
  rm -rf "$work/downloads"
  mkdir -p "$work/downloads"
  "$work"/tools-cp3*/bin/pip download -q --disable-pip-version-check --no-deps -d "$work/downloads" -r python/requirements.txt
  cp python/requirements.txt "$work/downloads/"
fi
# Makes a virtual environment with what the tests need, except packages of a name, and with the wheel.
environment() {  # its folder, the name, arguments of venv
  "$python" -m venv "${@:3}" "$1"
  local pip=("$1/bin/pip" install -q --disable-pip-version-check --no-deps --no-index)
  "${pip[@]}" --find-links "$work/downloads" -r <(grep -v "^$2==" python/requirements.txt)
  "${pip[@]}" "$work"/wheel/*.whl
}
environment "$work/venv" nothing
environment "$work/venv-torch" numpy --system-site-packages

export SHERD_BIN=$PWD/build/release/sherd SHERD_DATA=$PWD/data OCL_ICD_VENDORS=pocl.icd
tools/python_api.sh > /dev/null
cd "$work"  # so that what is imported is what is installed
tests() {  # the environment, arguments of pytest
  PATH=$work/$1/bin:$PATH env --default-signal=INT python -B -m pytest -q -c ../../python/pyproject.toml --rootdir ../.. "${@:2}"
}
# Side by side, since pytest has one process.  In the background a shell ignores SIGINT, which tests send.
tests venv-torch ../../tests/python/with_torch "$@" > "$work/with_torch.log" 2>&1 &
second=$!
status=0
tests venv ../../tests/python --ignore ../../tests/python/with_torch "$@" || status=$?
torch=0
wait $second || torch=$?
cat "$work/with_torch.log"
# 5: the arguments select none
[ $status -eq 5 ] && [ $torch -eq 5 ] && exit 5
[[ $status =~ ^[05]$ && $torch =~ ^[05]$ ]]
