#!/usr/bin/env python3
"""Writes python/pysherd/__init__.pyi: the types of the Python module, keywords from the option table of the installed module.

usage: python_stubs.py [--check]    (with the Python that pysherd is installed for)

--check writes nothing and ends with status 1 where the file is not as this would write it.
"""
import argparse
import pathlib
import sys

from pysherd import _options

FILE = pathlib.Path(__file__).resolve().parents[1] / "python" / "pysherd" / "__init__.pyi"

TEMPLATE = '''\
# Made by tools/python_stubs.py from the option table.  What is defined below is in quotes: pdoc runs this file.
import os
from typing import Any, Callable, Iterable, Iterator, Literal, Mapping, NamedTuple, Sequence, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

__version__: str
__all__ = {names}

_Path: TypeAlias = str | bytes | os.PathLike[str] | os.PathLike[bytes]
_Progress: TypeAlias = Callable[[str, float], bool | None]

class Error(Exception):
    code: int
    options: tuple[str, ...]
    def __init__(self, sentence: str = "", options: Sequence[str] = ()) -> None: ...

class UsageError(Error, ValueError): ...
class InputError(Error, ValueError): ...
class FileError(Error, OSError): ...
class DeviceError(Error, RuntimeError): ...
class OutputError(Error, OSError): ...
class Cancelled(Error): ...
class SherdWarning(UserWarning): ...

class Options(Mapping[str, Any]):
    def __init__(self, **options: Any) -> None: ...
    def __getitem__(self, keyword: str) -> Any: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...

class Points(NamedTuple):
    positions: NDArray[np.float64]
    normals: NDArray[np.float64]
    neighbor: NDArray[np.uint16]
    fragment: NDArray[np.uint16]

class Contacts(NamedTuple):
    fragments: NDArray[np.int32]
    area: NDArray[np.float64]
    normal: NDArray[np.float64]
    centroid: NDArray[np.float64]

class SparseLabels(NamedTuple):
    voxels: NDArray[np.int32]
    labels: NDArray[np.uint16]

class Fragment:
    id: int
    def __init__(self, fracture: "Fracture", index: int) -> None: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def neighbor(self) -> NDArray[np.uint16]: ...
    @property
    def source_faces(self) -> NDArray[np.int32] | None: ...
    @property
    def voxels(self) -> int: ...
    @property
    def volume(self) -> float: ...
    @property
    def area(self) -> float: ...
    @property
    def fracture_area(self) -> float: ...
    @property
    def centroid(self) -> NDArray[np.float64]: ...
    @property
    def inertia(self) -> NDArray[np.float64]: ...
    def to_trimesh(self) -> Any: ...

class Fracture(Sequence[Fragment]):
    def __init__(self, core: Any, solid: "Solid | None" = None, options: Options | None = None) -> None: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, index: int) -> Fragment: ...
    @overload
    def __getitem__(self, index: slice) -> list[Fragment]: ...
    def __iter__(self) -> Iterator[Fragment]: ...
    @property
    def solid(self) -> "Solid | None": ...
    @property
    def options(self) -> Options: ...
    @property
    def seed(self) -> int: ...
    @property
    def voxel_size(self) -> float: ...
    @property
    def origin(self) -> NDArray[np.float64]: ...
    @property
    def offset(self) -> NDArray[np.float64]: ...
    @property
    def unit(self) -> float: ...
    @property
    def up(self) -> str: ...
    @property
    def labels(self) -> NDArray[np.uint16]: ...
    @property
    def sparse_labels(self) -> SparseLabels: ...
    @property
    def contacts(self) -> Contacts: ...
    def points(
        self,
        n: int,
        *,
        progress: _Progress | None = None,
{points}
    ) -> Points: ...
    def save(
        self,
        folder: _Path,
        *,
        progress: _Progress | None = None,
{save}
    ) -> None: ...
    def to_trimesh(self) -> list[Any]: ...
    def render(
        self,
        file: _Path | None = None,
        *,
        explode: float = 0.25,
        azimuth: float = 35.0,
        elevation: float = 20.0,
        up: str = "auto",
        size: tuple[int, int] = (1280, 720),
        progress: _Progress | None = None,
    ) -> NDArray[np.uint8]: ...

class Solid:
    def __init__(self, core: Any) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def shape(self) -> tuple[int, int, int]: ...
    @property
    def voxel_size(self) -> float: ...
    @property
    def voxels(self) -> int: ...
    @property
    def components(self) -> int: ...
    @property
    def origin(self) -> NDArray[np.float64]: ...
    @property
    def offset(self) -> NDArray[np.float64]: ...
    @property
    def unit(self) -> float: ...
    @property
    def up(self) -> str: ...
    @property
    def options(self) -> Options: ...
    def fractures(
        self,
        pieces: int | Iterable[int] = 8,
        seeds: int | Iterable[int] = (0,),
        *,
        device: str = "builtin",
        progress: _Progress | None = None,
        **options: Any,
    ) -> Iterator[Fracture]: ...

def voxelize(
    mesh: Any,
    *,
    device: str = "builtin",
    progress: _Progress | None = None,
{voxelize}
) -> Solid: ...
def fracture(
    mesh: Any,
    *,
    device: str = "builtin",
    progress: _Progress | None = None,
{fracture}
) -> Fracture: ...
def load(folder: _Path) -> Fracture: ...
def limit_threads(most: int) -> None: ...
'''

TYPES = {"flag": "bool", "whole": "int", "number": "float", "length": "float | str", "wholes": "int | str | Sequence[int]",
         "numbers": "str | Sequence[float]"}


def type_of(row):
    choices = "Literal[" + ", ".join(f'"{c}"' for c in row.choices) + "]"
    if row.type == "choice":
        return choices
    if row.type == "choices":
        return f"str | Sequence[{choices}]"
    if row.range.startswith("auto|"):
        return f'{TYPES[row.type]} | Literal["auto"]'
    if row.type == "number" and row.choices:
        return f"{TYPES[row.type]} | {choices}"
    if row.type == "text":
        return "float | str | os.PathLike[str] | Sequence[Any]"
    return TYPES[row.type]


def keywords(rows, indent):
    """The rows as parameters: each may also be None, which is as if it were not given."""
    return "\n".join(f"{indent}{keyword}: {type_of(row)} | None = {row.default_value()!r}," for keyword, row in rows.items()).replace("'", '"')


def stubs():
    import pysherd

    names = "[\n" + "".join(f'    "{name}",\n' for name in pysherd.__all__) + "]"
    return (TEMPLATE.replace("{names}", names).replace("{points}", keywords(_options.POINTS, " " * 8))
            .replace("{save}", keywords(_options.SAVE, " " * 8)).replace("{voxelize}", keywords(_options.VOXELIZE, " " * 4))
            .replace("{fracture}", keywords(_options.ROWS, " " * 4)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--check", action="store_true", help="write nothing")
    arguments = parser.parse_args()
    text = stubs()
    if arguments.check:
        stale = not FILE.is_file() or FILE.read_text() != text
        if stale:
            print(f"{FILE} is not as tools/python_stubs.py writes it", file=sys.stderr)
        return int(stale)
    FILE.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
