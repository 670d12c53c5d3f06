"""What can be broken: a path, arrays, an object with vertices and faces, a volume.  Each is checked here, by name."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from . import _core
from ._errors import FileError, InputError
from ._values import path_text

_LONGEST = 1e37  # world units, as for files
_MOST_ROWS = 2**32 - 1  # indices have 32 bits
_MOST_SIDE = 4096  # voxels


def object_of(mesh: Any) -> tuple[_core.Object, bool]:
    """Returns an object to voxelize, and whether it is a file.

    Raises
    ------
    InputError
        Naming the argument at fault: mesh, vertices, faces or volume.
    """
    if isinstance(mesh, (str, bytes, os.PathLike)):
        return _core.file_object(path_text("mesh", mesh, FileError)), True
    arrays = arrays_of(mesh)
    if isinstance(arrays, tuple):
        return _core.mesh_object(*arrays), False
    return _core.volume_object(arrays.view(np.uint8)), False


def arrays_of(mesh: Any) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]] | np.ndarray[Any, Any]:
    """Returns vertices and faces, or a volume of bool, of an object in memory; given those, the same without a copy.

    Raises
    ------
    InputError
        As `object_of`.
    """
    if hasattr(mesh, "vertices") and (hasattr(mesh, "faces") or hasattr(mesh, "triangles")):
        faces = mesh.faces if hasattr(mesh, "faces") else mesh.triangles  # Open3D's name
        return _mesh(mesh.vertices, faces)
    if isinstance(mesh, (tuple, list)):
        if len(mesh) != 2:
            raise InputError(f"mesh: a {type(mesh).__name__} of {len(mesh)} is no pair (vertices, faces)")
        return _mesh(*mesh)
    if hasattr(mesh, "__array__") or hasattr(mesh, "__dlpack__"):
        return _volume(mesh)
    raise InputError(
        f"mesh: a {type(mesh).__name__} cannot be broken; a path, a pair (vertices, faces), an object with both, or a volume can"
    )


def numbers_of(name: str, values: Any) -> np.ndarray[Any, Any]:
    """Returns an array of numbers without copying where that can be; never of objects."""
    try:
        has_array = hasattr(values, "__array__") or not hasattr(values, "__dlpack__")
        array = np.asarray(values) if has_array else np.from_dlpack(values)
    except Exception as e:  # whatever the object's own conversion raises
        reason = " ".join(str(e).split()).rstrip(".")
        raise InputError(f"{name}: cannot be converted to an array: {reason}") from e
    if array.dtype.kind not in "biuf":
        raise InputError(f"{name}: numbers are needed, not dtype {array.dtype}")
    return array


def _rows(name: str, values: Any) -> np.ndarray[Any, Any]:
    array = numbers_of(name, values)
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"{name}: shape (n, 3) is needed, not {array.shape}")
    if array.dtype.kind == "b":
        raise InputError(f"{name}: numbers are needed, not dtype {array.dtype}")
    if len(array) == 0:
        raise InputError(f"{name}: has no rows")
    if len(array) > _MOST_ROWS:
        raise InputError(f"{name}: has {len(array)} rows, at most {_MOST_ROWS} can be held")
    needed = 8 * array.size * array.dtype.itemsize
    if needed > _core.free_memory():
        raise InputError(f"{name}: {len(array)} rows take up to {needed / 2**30:.1f} GiB of memory, which is not free")
    return array


def _vertices(values: Any) -> np.ndarray[Any, Any]:
    vertices = np.ascontiguousarray(_rows("vertices", values), dtype=np.float64)
    good = np.isfinite(vertices).all(axis=1)
    if not good.all():
        raise InputError(f"vertices: row {int(np.argmin(good))} is not finite")
    sides = np.ptp(vertices, axis=0)
    if sides.max() > _LONGEST:
        raise InputError(f"vertices: the mesh is {sides.max():.3g} long, at most {_LONGEST:g} is supported (scale it)")
    return vertices


def _faces(values: Any, vertices: int) -> np.ndarray[Any, Any]:
    faces = _rows("faces", values)
    if faces.dtype.kind == "f":
        raise InputError(f"faces: whole numbers are needed, not dtype {faces.dtype}")
    bad = (faces < 0) | (faces >= vertices)
    if bad.any():
        row, corner = np.argwhere(bad)[0]
        raise InputError(f"faces: row {row} uses vertex {faces[row, corner]}, vertices has {vertices} rows")
    return np.ascontiguousarray(faces, dtype=np.uint32)


def _mesh(vertices: Any, faces: Any) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    vertices = _vertices(vertices)
    return vertices, _faces(faces, len(vertices))


def _volume(values: Any) -> np.ndarray[Any, Any]:
    volume = numbers_of("volume", values)
    if volume.ndim != 3:
        raise InputError(f"volume: shape (nx, ny, nz) is needed, not {volume.shape}")
    if volume.dtype.kind == "f":
        raise InputError(f"volume: bool or whole numbers are needed, not dtype {volume.dtype}; give volume > 0.5, or what is solid in it")
    if volume.size == 0 or max(volume.shape) > _MOST_SIDE:
        raise InputError(f"volume: 1 to {_MOST_SIDE} voxels along each side are needed, not {volume.shape}")
    if 3 * volume.size > _core.free_memory():
        raise InputError(f"volume: {volume.size} voxels take more memory than is free")
    mask = np.ascontiguousarray(volume != 0)
    if not mask.any():
        raise InputError("volume: nothing in it is solid")
    return mask
