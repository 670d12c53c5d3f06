"""Meshes of a stream of fractures, and their solids, which are kept within a limit of memory."""

from __future__ import annotations

import hashlib
import itertools
import os
from collections import OrderedDict
from typing import Any, Mapping, NamedTuple

from . import _core, _inputs, _jobs, _options
from ._errors import Error, FileError, InputError, UsageError, warn
from ._solid import Solid
from ._values import is_number, is_sequence, path_text

_MOST_OF_ITERATOR = 2**20


class Mesh(NamedTuple):
    """A mesh of a library, as it was given."""

    key: str
    """path in the library, or its position in a list"""
    given: Any
    """a path, a `Solid`, a pair of arrays, or a volume"""

    @property
    def identity(self) -> str:
        """The key of a file; of a mesh in memory, what it is made of, too."""
        if isinstance(self.given, str):
            return self.key
        if isinstance(self.given, Solid):
            return repr((self.key, self.given._identity, self.given.shape))
        arrays = self.given if isinstance(self.given, tuple) else (self.given,)
        return repr((self.key, *((a.shape, hashlib.blake2b(a, digest_size=8).hexdigest()) for a in arrays)))


def library_of(meshes: Any) -> list[Mesh]:
    """Returns the meshes of a folder, of a list of paths, or those given.

    Raises
    ------
    InputError, FileError, UsageError
        There are none, or one of them cannot be broken.
    """
    if isinstance(meshes, (str, bytes, os.PathLike)):
        return _files(path_text("meshes", meshes, FileError))
    if isinstance(meshes, Solid) or hasattr(meshes, "vertices") or _is_array(meshes) or _is_pair(meshes):
        meshes = [meshes]
    if not is_sequence(meshes):
        raise UsageError(f"meshes: a {type(meshes).__name__} is neither a folder nor several meshes")
    most = None if hasattr(meshes, "__len__") else _MOST_OF_ITERATOR + 1
    found = [_mesh(number, mesh) for number, mesh in enumerate(itertools.islice(meshes, most))]
    if len(found) == most:
        raise UsageError(f"meshes: an iterator of more than {_MOST_OF_ITERATOR} meshes may have no end; give a list, or a folder")
    if not found:
        raise InputError("meshes: there are none")
    return found


def _files(path: str) -> list[Mesh]:
    if not os.path.isdir(path) and not path.lower().endswith(".txt"):
        if not os.path.exists(path):
            raise FileError(f"{path}: does not exist")
        return [Mesh(os.path.basename(path), path)]
    try:
        found, skipped = _core.find_objects(path)
    except Error as e:
        raise FileError(str(e), e.options) from None
    warn(skipped)
    return [Mesh(key, file) for key, file in found]


def _is_pair(meshes: Any) -> bool:
    return isinstance(meshes, (tuple, list)) and len(meshes) == 2 and _has_rows(meshes[0])  # of numbers, and no mesh alone has those


def _is_array(values: Any) -> bool:
    of_paths = getattr(getattr(values, "dtype", None), "kind", "") in ("O", "S", "T", "U")
    return (hasattr(values, "__array__") or hasattr(values, "__dlpack__")) and not of_paths


def _has_rows(values: Any) -> bool:
    if _is_array(values):
        try:
            return _inputs.numbers_of("vertices", values).ndim == 2
        except InputError:
            return False
    row: Any = values[0] if _is_list(values) and len(values) else None
    return _is_list(row) and len(row) == 3 and all(map(is_number, row))


def _is_list(values: Any) -> bool:
    return hasattr(values, "__len__") and hasattr(values, "__getitem__") and not isinstance(values, (str, bytes, Mapping))


def _mesh(number: int, mesh: Any) -> Mesh:
    if isinstance(mesh, (str, bytes, os.PathLike)):
        path = path_text(f"mesh {number}", mesh, FileError)
        return Mesh(path, path)
    if isinstance(mesh, Solid):
        return Mesh(str(number), mesh)
    try:
        arrays = _inputs.arrays_of(mesh)
        return Mesh(str(number), tuple(a.copy() for a in arrays) if isinstance(arrays, tuple) else arrays.copy())
    except InputError as e:
        raise InputError(f"mesh {number}: {e}", e.options) from None


class Solids:
    """Solids of meshes, made when they are first used; those used longest ago go when there are too many bytes of them.

    Parameters
    ----------
    texts : list
        Options of all solids.
    most_bytes : int
        The last solid is kept even if it alone takes more.
    """

    def __init__(self, meshes: list[Mesh], texts: _options.Texts, most_bytes: int, device: str) -> None:
        self._meshes = meshes
        self._texts = texts
        self._most_bytes = most_bytes
        self._device = device
        self._kept: OrderedDict[int, tuple[_core.Solid, int]] = OrderedDict()
        self.bytes = 0

    def __getitem__(self, mesh: int) -> _core.Solid:
        """Returns a solid.

        Raises
        ------
        Error
            The mesh cannot be voxelized.
        """
        if mesh in self._kept:
            self._kept.move_to_end(mesh)
            return self._kept[mesh][0]
        core = self._made(self._meshes[mesh])
        self._kept[mesh] = core, _jobs.finish(_core.keep_surface(core))
        self.bytes += self._kept[mesh][1]
        while self.bytes > self._most_bytes and len(self._kept) > 1:
            self.bytes -= self._kept.popitem(last=False)[1][1]
        return core

    def __len__(self) -> int:
        return len(self._kept)

    def emptied(self) -> Solids:
        """Returns the same without solids."""
        return Solids(self._meshes, self._texts, self._most_bytes, self._device)

    def _made(self, mesh: Mesh) -> _core.Solid:
        if isinstance(mesh.given, Solid):
            return mesh.given._core
        obj, is_file = _inputs.object_of(mesh.given)
        try:
            return _jobs.finish(_core.voxelize(obj, self._texts, self._device))
        except Error as e:
            if e.code != InputError.code:
                raise
            raise (FileError(str(e), e.options) if is_file else InputError(f"mesh {mesh.key}: {e}", e.options)) from None
