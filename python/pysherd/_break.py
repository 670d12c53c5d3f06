"""Breaking solids, and loading what was broken."""

from __future__ import annotations

import json
import os
from typing import Any, Iterator

from . import _core, _jobs, _options, _state
from ._errors import InputError, warn
from ._fracture import Fracture, file_errors
from ._solid import DEVICE, Solid, checked_device, core_solid, fracture_options
from ._values import path_text


def break_solid(
    core: _core.Solid, given: list[tuple[str, str]], pairs: list[tuple[int, int]], device: str, progress: _jobs.Progress | None
) -> Iterator[Fracture]:
    """Breaks a solid by pairs of pieces and seeds, which grow together."""
    all = _jobs.finish(_core.fracture(core, given, pairs, checked_device(device)), progress)
    solid = Solid(core)
    while all:  # lets go of each when the next is taken
        broken = all.pop(0)
        warn(broken.guide_warnings)
        yield Fracture(broken, solid)


def _pieces_and_seed(given: list[tuple[str, str]]) -> tuple[int, int]:
    texts = {"pieces": _options.ROWS["pieces"].default, "seed": _options.ROWS["seed"].default, **dict(given)}
    return int(texts["pieces"]), int(texts["seed"])


def broken_again(*state: Any) -> Fracture:
    """Returns a fracture that was pickled."""
    solid, sealed = _state.only("fracture", state, Solid, bytes)
    content = _core.content_of("fracture", sealed)
    with _state.restoring("fracture"):
        options, identity = json.loads(content)
        if identity != solid._identity:
            raise InputError("this pickle of a fracture is damaged: it has the solid of another fracture")
        given = [(name, text) for name, text in options]
        _core.check_options(given)
        return next(break_solid(solid._core, given, [_pieces_and_seed(given)], DEVICE, None))


def parts_again(*state: Any) -> Fracture:
    """Returns a fracture that was pickled, of fragments that were broken again."""
    before, sealed = _state.only("fracture", state, Fracture, bytes)
    content = _core.content_of("fracture", sealed)
    with _state.restoring("fracture"):
        ids, options = json.loads(content)
        given = [(name, text) for name, text in options]
        _core.check_options(given)
        if not ids:
            raise InputError("this pickle of a fracture is damaged: it names no fragment that was broken again")
        return before._broken(list(ids), given, DEVICE, None)


def loaded_again(*state: Any) -> Fracture:
    """Returns a loaded fracture that was pickled: reads its folder."""
    (sealed,) = _state.only("fracture", state, bytes)
    content = _core.content_of("fracture", sealed)
    with _state.restoring("fracture"):
        return load(json.loads(content))


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
    return next(break_solid(core, given, [_pieces_and_seed(given)], device, progress))


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
