"""The module's documentation and types, and its example."""
import inspect
import pathlib
import re
import subprocess
import sys

import documents
import pytest
from conftest import AMPHORA

from pysherd import torch as module

ROOT = pathlib.Path(__file__).resolve().parents[3]


def test_every_public_name_is_in_the_pages(tmp_path):
    pytest.importorskip("pdoc")
    made = subprocess.run([ROOT / "tools" / "python_api.sh", tmp_path, sys.executable], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    page = (tmp_path / "pysherd" / "torch.html").read_text()
    names = [*module.__all__, *(f"FractureDataset.{name}" for name in vars(module.FractureDataset) if not name.startswith("_"))]
    assert [name for name in names if f'id="{name}"' not in page] == [] and "{options}" not in page


def test_every_public_name_has_a_docstring():
    of_class = [value for name, value in vars(module.FractureDataset).items() if not name.startswith("_")]
    assert all(inspect.getdoc(value) for value in [module, *(getattr(module, name) for name in module.__all__), *of_class])
    documented = module.FractureDataset.__doc__
    assert "roughness : " in documented and "pieces : " in documented and not re.search("--[a-z]", documented) and "mesh_format" not in documented
    parameters = inspect.signature(module.FractureDataset).parameters
    assert all(f"{name} : " in documented or name in ("meshes", "options") or f"{name}, " in documented for name in parameters), parameters


def test_stubs_and_the_example_have_types(tmp_path):
    pytest.importorskip("mypy")
    (tmp_path / "allowed").write_text("pysherd\\..*\\._.*\npysherd\\._.*\n")  # names with an underscore are internal
    (tmp_path / "mypy.ini").write_text("[mypy]\nignore_missing_imports = True\n")
    commands = [["mypy.stubtest", "pysherd", "--allowlist", "allowed", "--ignore-unused-allowlist", "--ignore-missing-stub", "--mypy-config-file",
                 "mypy.ini"], ["mypy", "--strict", "--allow-untyped-calls", "--cache-dir=/dev/null", ROOT / "examples" / "python" / "train.py"]]  # fmt: skip
    for command in commands:
        result = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, cwd=tmp_path)
        assert result.returncode == 0, result.stdout + result.stderr


def test_the_example_trains(tmp_path):
    """Four steps, which teach nothing: tests/long/training.py trains."""
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "a.ply").write_bytes(AMPHORA.read_bytes())
    result = subprocess.run([sys.executable, "-B", ROOT / "examples" / "python" / "train.py", tmp_path / "meshes", tmp_path / "meshes", "4"],
                            capture_output=True, text=True)  # fmt: skip
    assert result.returncode == 0 and '"chance": 0.' in result.stdout, result.stderr


def test_the_block_of_the_documents(tmp_path, monkeypatch):
    """As it is written but for its end, on small objects."""
    monkeypatch.chdir(tmp_path)
    for side in 1, 2:
        documents.write_cube(tmp_path / "vessels" / f"cube{side}.obj", side)
    block = documents.block_with("FractureDataset(")
    line = next(line for line in block.splitlines() if "# no end" in line)
    block = documents.replaced(documents.replaced(block, line, line + "\n    break"), "num_workers=4", "num_workers=2")
    names = documents.run(documents.replaced(block, "resolution=64", "resolution=16"))
    assert names["batch"]["fracture_surface_gt"].shape[0] == 16
