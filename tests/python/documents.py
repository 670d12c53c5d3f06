"""Runs blocks of docs/python.md, for the tests of the module and those beside PyTorch."""
import pathlib
import re

from conftest import cube

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "python.md"


def blocks():
    return re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), flags=re.S | re.M)


def block_with(text):
    found = [block for block in blocks() if text in block]
    assert len(found) == 1, text
    return found[0]


def replaced(text, old, new):
    assert text.count(old) == 1, old
    return text.replace(old, new)


def write_cube(path, side=1.0):
    vertices, faces = cube(side)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("".join("v %g %g %g\n" % tuple(v) for v in vertices) + "".join("f %d %d %d\n" % tuple(f + 1) for f in faces))


def run(block, **names):
    exec(compile(block, str(PAGE), "exec"), names)
    return names
