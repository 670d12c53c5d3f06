"""What is installed: the program, its library, licenses, documentation and types."""
import importlib.metadata
import importlib.util
import inspect
import os
import pathlib
import pickle
import re
import shutil
import subprocess
import sys

import pytest
from conftest import AMPHORA

import pysherd
from pysherd import _core, _options
from pysherd.__main__ import _hdf5_library

HERE = pathlib.Path(pysherd.__file__).parent


def installed():
    try:
        return importlib.metadata.distribution("pysherd")
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("the package is not installed")


@pytest.mark.parametrize("command", [[sys.executable, "-m", "pysherd"], [str(pathlib.Path(sys.executable).with_name("sherd"))]], ids=["-m", "sherd"])
def test_the_program_is_inside(command, tmp_path):
    installed()
    version = subprocess.run([*command, "--version"], capture_output=True, text=True, check=True).stdout
    assert version.startswith(f"sherd {pysherd.__version__} (Apache-2.0)")
    subprocess.run([*command, "fracture", AMPHORA, "-o", tmp_path / "out", "--resolution", "32", "--pieces", "3", "--quiet"], check=True)
    assert len(pysherd.load(tmp_path / "out")) == 3
    assert subprocess.run([*command, "fracture", tmp_path / "absent.obj", "-o", tmp_path / "other"], capture_output=True).returncode == 3


def test_the_hdf5_library_is_that_of_h5py(tmp_path):
    """The machine needs none of its own: the program gets the path of the one inside the wheel, and opens no other."""
    installed()
    import h5py

    library = pathlib.Path(_hdf5_library() or "")
    assert library.is_file() and library.parent.name == "h5py.libs"
    (tmp_path / "library").mkdir()
    shutil.copy(AMPHORA, tmp_path / "library")
    command = [sys.executable, "-m", "pysherd", "dataset", tmp_path / "library", "-o", tmp_path / "out", "--layout", "hdf5", "--pieces", "2..3",
               "--repeats", "1", "--resolution", "32", "--quiet"]
    traced = subprocess.run(command, env={**os.environ, "LD_DEBUG": "files", "LD_DEBUG_OUTPUT": str(tmp_path / "opened")}, capture_output=True)
    assert traced.returncode == 0, traced.stderr
    opened = "".join(file.read_text() for file in tmp_path.glob("opened.*"))
    assert set(re.findall(r"calling init: (\S*/libhdf5\S*)", opened)) == {str(library)}
    with h5py.File(tmp_path / "out" / "fractures.hdf5") as file:
        paths = [path.decode() for path in file["data_split/fractures/train"]]
        assert sorted(len(file[path]) for path in paths) == [2, 3]
    named = subprocess.run([*command[:6], tmp_path / "other", *command[7:]], env={**os.environ, "SHERD_HDF5_LIBRARY": "/absent.so"}, capture_output=True)
    assert named.returncode == 2 and b"/absent.so" in named.stderr


def test_program_and_module_share_one_library():
    installed()
    files = [p for p in HERE.rglob("*") if p.is_file()]
    assert [p.name for p in files if p.name.startswith("libsherd")] == ["libsherd.so"]
    assert (HERE / "bin" / "sherd").stat().st_size < 3 << 20
    needed = subprocess.run(["ldd", HERE / "bin" / "sherd", *HERE.glob("_core*.so")], capture_output=True, text=True).stdout
    libraries = [line.split("=>")[1].split()[0] for line in needed.splitlines() if "libsherd.so" in line]
    assert [pathlib.Path(p).resolve() for p in libraries] == [HERE / "libsherd.so"] * 2
    assert "OpenCL" not in needed and "not found" not in needed


def test_meshes_that_assimp_reads(tmp_path):
    installed()
    (tmp_path / "bad.dae").write_text("<COLLADA/>")
    with pytest.raises(pysherd.FileError) as caught:
        pysherd.voxelize(tmp_path / "bad.dae")
    assert "sherd-assimp" not in str(caught.value)  # which is found


def test_metadata():
    metadata = installed().metadata
    assert metadata["Version"] == pysherd.__version__ == _core.version()
    assert "MPL-2.0" in metadata["License-Expression"] and "LICENSES.md" in metadata.get_all("License-File")
    assert {p.stem for p in (HERE / "licenses").glob("*.txt")} >= {"libopenvdb10.0", "libtbb12", "libembree3-3"}
    assert not any("opencl" in p.name.lower() for p in HERE.parent.joinpath("pysherd.libs").iterdir())


def test_without_pytorch_its_module_says_so():
    if importlib.util.find_spec("torch") is not None:
        pytest.skip("PyTorch is installed")
    with pytest.raises(ImportError, match="^pysherd.torch needs PyTorch, which is not installed: pip install torch$"):
        import pysherd.torch


def test_without_openusd_its_function_says_so():
    if importlib.util.find_spec("pxr") is not None:
        pytest.skip("OpenUSD is installed")
    import pysherd.usd

    with pytest.raises(ImportError, match="^pysherd.usd.write_usdc needs OpenUSD, which is not installed: pip install usd-core$"):
        pysherd.usd.write_usdc("scene.usda")


def public():
    """Every public function, class, method and property."""
    for name in pysherd.__all__:
        value = getattr(pysherd, name)
        yield name, value
        if inspect.isclass(value) and not issubclass(value, (tuple, Exception)):
            for member, own in vars(value).items():
                if not member.startswith("_") and name != "Solid":
                    yield f"{name}.{member}", own


def test_everything_has_a_docstring():
    assert [name for name, value in public() if not inspect.getdoc(value)] == []


def test_keywords_are_the_rows_of_the_table():
    parameters = inspect.signature(pysherd.fracture).parameters
    for row in _core.option_table():
        assert row["keyword"] in parameters
        assert row["help"].split("--")[0] in pysherd.fracture.__doc__ and row["range"] in pysherd.fracture.__doc__
    assert not re.search("--[a-z]", pysherd.fracture.__doc__)
    assert parameters["pieces"].default == 8 and parameters["growth"].default == "euclid"
    assert "{options}" not in pysherd.fracture.__doc__ + pysherd.voxelize.__doc__ + pysherd.Fracture.save.__doc__ + pysherd.Fracture.points.__doc__


def test_defaults_are_accepted():
    for row in _options.ROWS.values():
        value = row.default_value()
        if value is not None and not row.repeats and row.name not in ("seeds", "sdf-type", "voxel-size", "shell-thickness"):
            _options.given({row.keyword: value})


def test_options_are_a_mapping():
    options = pysherd.Options(pieces=3, roughness=None)
    assert dict(options) == {"pieces": 3} and len(options) == 1 and options == pysherd.Options(pieces=3)
    impacts = pysherd.Options(impact=(point for point in [(0, 0, 1), (0, 1, 0)]))
    assert impacts["impact"] == ((0, 0, 1), (0, 1, 0)) and pickle.loads(pickle.dumps(impacts)) == impacts
    assert repr(options) == "Options(pieces=3)" and pickle.loads(pickle.dumps(options)) == options
    with pytest.raises(pysherd.UsageError):
        pysherd.Options(piece=3)
