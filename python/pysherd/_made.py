"""What solids, fractures and fragments share: the objects of the core that they show."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core, _jobs
from ._errors import Error, FileError, UsageError, warn
from ._values import shown, text_of

Array = np.ndarray[Any, Any]
DEVICE = "builtin"  # which any process has, also a forked one


class MadeSolid:
    """A solid of the core, as a fracture keeps it."""

    def __init__(self, core: _core.Solid) -> None:
        self._core = core

    @property
    def _identity(self) -> str:
        """What distinguishes it from other solids: what it was made of, how, and what came out."""
        return repr(self._core.identity)


class MadeFracture:
    """A fracture of the core, and what is made of it when it is first read."""

    def __init__(self, core: _core.Fracture) -> None:
        self._core = core

    @property
    def _is_loaded(self) -> bool:
        return isinstance(self._core, _core.LoadedPieces)

    def _arrays(self, index: int) -> tuple[Array, Array, Array]:
        """Returns vertices, faces and neighbors of a fragment."""
        kept: dict[int, tuple[Array, Array, Array]] = self.__dict__.setdefault("_kept_arrays", {})
        return kept.get(index) or kept.setdefault(index, self._meshed.arrays(index))

    def _source_faces(self, index: int) -> Array | None:
        kept: dict[int, Array | None] = self.__dict__.setdefault("_kept_source_faces", {})
        return kept[index] if index in kept else kept.setdefault(index, self._meshed.source_faces(index))

    @property
    def _measured(self) -> _core.Fragments:
        return self._made(meshes=False)

    @property
    def _sampled(self) -> _core.Fragments:
        """The fragments as the surfaces have them that points lie on."""
        return file_errors(_core.sampled_fragments(self._core), None, self._is_loaded)

    @property
    def _meshed(self) -> _core.Fragments:
        return self._made(meshes=True)

    def _made(self, meshes: bool, progress: _jobs.Progress | None = None) -> _core.Fragments:
        kept = self.__dict__.setdefault("_kept", {})
        if meshes not in kept:
            kept[meshes] = file_errors(_core.fragments(self._core, meshes), progress, self._is_loaded)
            if meshes and self._core.smooth_text:
                warn([self._core.smooth_text])
            if meshes and self._core.united_text:
                warn([self._core.united_text])
        return kept[meshes]


def checked_device(device: Any) -> str:
    """Returns the name of a device."""
    if not isinstance(device, str) or not device:
        raise UsageError(f"device: {shown(device)} is not a name such as 'builtin', 'cpu' or 'gpu'")
    return text_of("device", device)


def file_errors(job: _core.Job, progress: _jobs.Progress | None, is_file: bool) -> Any:
    """Waits for a job whose input errors are about files if `is_file`."""
    try:
        return _jobs.finish(job, progress)
    except Error as e:
        raise of_file(e, is_file) from None


def of_file(error: Error, is_file: bool) -> Error:
    return FileError(str(error), error.options) if is_file and error.code == FileError.code else error
