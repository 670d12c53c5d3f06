#!/usr/bin/env bash
# Makes the pages of the Python module by pdoc, from its docstrings and stubs; what pdoc warns of is an error.
#
# usage: python_api.sh [OUT [PYTHON]]    (default: build/python/api, with the Python of tools/test_python.sh, where pysherd, pdoc and PyTorch are installed)
#
# Without PyTorch there is no page of pysherd.torch, without OpenUSD none of pysherd.usd.
set -euo pipefail
root=$(realpath "$(dirname "$0")/..")
out=$(realpath -m "${1:-$root/build/python/api}")
python=${2:-$root/build/python/venv-torch/bin/python}
modules=(pysherd)
! "$python" -c 'import torch' 2> /dev/null || modules+=(pysherd.torch)
modules+=(pysherd.parquet)
! "$python" -c 'import pxr' 2> /dev/null || modules+=(pysherd.usd)
cd "$(mktemp -d)"  # so that what is imported is what is installed
"$python" -B -W error -m pdoc --docformat numpy --no-show-source -o "$out" "${modules[@]}" 2> warnings || { cat warnings >&2; exit 1; }
[ ! -s warnings ] || { cat warnings >&2; exit 1; }
rm warnings
rmdir "$PWD"
echo "$out/pysherd.html"
