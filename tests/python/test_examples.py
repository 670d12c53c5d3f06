"""The examples run, and their types are right."""
import importlib.util
import inspect
import pathlib
import subprocess
import sys

import numpy as np
import pytest
from conftest import AMPHORA

import pysherd

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples" / "python"


def example(name, *arguments):
    result = subprocess.run([sys.executable, "-B", EXAMPLES / name, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_walk_through(tmp_path):
    printed = example("walk_through.py", AMPHORA, tmp_path)
    assert "8192 points" in printed and "70 fragments of 20 fractures" in printed
    assert (tmp_path / "exploded.png").stat().st_size > 1000 and (tmp_path / "pieces" / "manifest.json").is_file()


def test_many_objects(tmp_path):
    assert f"{AMPHORA}: 8 fractures" in example("many_objects.py", tmp_path, AMPHORA)
    assert np.load(tmp_path / "amphora.npz")["arr_0"].shape == (1024, 8)


def test_examples_have_types():
    pytest.importorskip("mypy")
    examples = [p for p in EXAMPLES.glob("*.py") if p.name not in ("with_dask.py", "train.py", "graphs.py", "lightning_modules.py")]  # Dask and PyTorch are not installed here
    result = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir=/dev/null", *examples], capture_output=True, text=True)
    assert result.returncode == 0, result.stdout


def test_every_public_name_is_in_the_pages(tmp_path):
    pytest.importorskip("pdoc")
    made = subprocess.run([ROOT / "tools" / "python_api.sh", tmp_path, sys.executable], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    page = (tmp_path / "pysherd.html").read_text()
    names = set(pysherd.__all__)
    for name in pysherd.__all__:
        value = getattr(pysherd, name)
        names |= {f"{name}.{member}" for member in vars(value) if inspect.isclass(value) and not member.startswith("_")}
    names -= {"Error.with_traceback"}
    assert [name for name in sorted(names) if f'id="{name}"' not in page] == []
    assert "{options}" not in page and "numpy.uint16" in page  # types of the stubs


def test_stubs_are_those_of_the_table():
    assert subprocess.run([sys.executable, "-B", ROOT / "tools" / "python_stubs.py", "--check"]).returncode == 0


def test_stubs_agree_with_the_module(tmp_path):
    pytest.importorskip("mypy")
    # Names with an underscore are internal; modules for other packages cannot be imported without these.
    lacking = [name for name, needs in (("torch", "torch"), ("usd", "pxr")) if importlib.util.find_spec(needs) is None]
    (tmp_path / "allowed").write_text("pysherd\\..*\\._.*\npysherd\\._.*\n" + "".join(f"pysherd\\.{name}\n" for name in lacking))
    (tmp_path / "mypy.ini").write_text("[mypy]\nignore_missing_imports = True\n")
    result = subprocess.run([sys.executable, "-m", "mypy.stubtest", "pysherd", "--allowlist", tmp_path / "allowed", "--ignore-unused-allowlist",
                             "--ignore-missing-stub", "--mypy-config-file", "mypy.ini"], capture_output=True, text=True, cwd=tmp_path)  # fmt: skip
    assert result.returncode == 0, result.stdout + result.stderr
