"""Breaks objects, and loads what was broken."""

from __future__ import annotations

import os
from typing import Any

from . import _core, _jobs, _options
from ._fracture import Fracture
from ._made import DEVICE, file_errors
from ._solid import Solid, break_solid, core_solid, fracture_options, pieces_and_seed
from ._values import path_text


@_options.documented(_options.ROWS)
def fracture(mesh: Any, *, device: str = DEVICE, progress: _jobs.Progress | None = None, **options: Any) -> Fracture:
    """Breaks an object into fragments.

    Parameters
    ----------
    mesh
        A `Solid`, or what `voxelize` takes.
    device : str
        'builtin', or as ``sherd devices`` lists them.  Results are the same on all.
    progress : callable, optional
        Called from this thread as ``progress(stage, fraction)``, some twenty times a second; returning False cancels.
    {options}

    Returns
    -------
    Fracture
        The same for the same object, options and seed, and that of ``sherd fracture``.

    Raises
    ------
    UsageError
        A keyword or a value that the table refuses, or a keyword of the solid beside a `Solid`.
    InputError, FileError
        As `voxelize`.
    DeviceError
        There is no such device, or the process was forked while a fracture was under way.
    Cancelled
        `progress` returned False.
    """
    if isinstance(mesh, Solid):
        core = mesh._core
        given = fracture_options(core, options)
    else:
        given = _options.given(options)
        core = core_solid(mesh, given, device, progress)
    return next(break_solid(core, given, [pieces_and_seed(given)], device, progress))


def load(folder: str | os.PathLike[str]) -> Fracture:
    """Reads a fracture that `Fracture.save` or ``sherd fracture`` wrote.

    Parameters
    ----------
    folder : path
        The folder, or its manifest.json.

    Returns
    -------
    Fracture
        Its meshes and labels are read from their files when they are first read.  `solid` is None.

    Raises
    ------
    FileError
        There is no fracture, or a file of it is absent or damaged.
    """
    core = file_errors(_core.load(path_text("folder", folder)), None, True)
    return Fracture(core, None, _options.Options._of_texts(_core.recorded_options(core.file)))
