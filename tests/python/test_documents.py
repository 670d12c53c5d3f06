"""The blocks of Python in docs/python.md, as they are written, on small objects of the names that they have."""
import importlib.util
import sys

import documents
import pytest


def test_each_block_is_run_here_or_beside_torch():
    assert len(documents.blocks()) == 4  # one more needs a test of its own; the one of PyTorch is in with_torch/test_module.py


def test_the_first_example(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    documents.write_cube(tmp_path / "bowl.obj")
    block = documents.replaced(documents.block_with("pysherd.voxelize("), "resolution=128", "resolution=32")
    names = documents.run(documents.replaced(block, "pieces=range(2, 11), seeds=range(1000)", "pieces=range(2, 4), seeds=range(2)"))
    assert (tmp_path / "pieces" / "manifest.json").is_file() and (tmp_path / "x.png").stat().st_size > 100
    assert len(names["f"]) == 8 and len(names["g"]) == 3


def test_the_example_of_usd(tmp_path, monkeypatch):
    """Where OpenUSD is not installed, the block gets as far as that, and says so."""
    monkeypatch.chdir(tmp_path)
    documents.write_cube(tmp_path / "bowl.obj")
    if importlib.util.find_spec("pxr") is None:
        with pytest.raises(ImportError, match="usd-core"):
            documents.run(documents.block_with("write_usdc"))
        assert (tmp_path / "scene" / "scene.usda").is_file()
        return
    documents.run(documents.block_with("write_usdc"))
    assert (tmp_path / "scene" / "scene.usdc").is_file()


def test_the_example_of_parquet(tmp_path, monkeypatch):
    """Where pyarrow is not installed, the block gets as far as that, and says so."""
    monkeypatch.chdir(tmp_path)
    documents.write_cube(tmp_path / "vessels" / "cube.obj")
    block = documents.replaced(documents.block_with("write_parquet"), '"sherd dataset', f'"{sys.executable} -m pysherd dataset')
    block = documents.replaced(block, "--write labels", "--write labels --resolution 12 --pieces 2..2 --repeats 1..1")
    if importlib.util.find_spec("pyarrow") is None:
        with pytest.raises(ImportError, match="pip install pyarrow"):
            documents.run(block)
        return
    documents.run(block)
    assert len(list((tmp_path / "pieces_parquet").iterdir())) == 1
