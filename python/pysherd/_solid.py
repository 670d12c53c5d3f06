"""Solids: objects that are voxelized and broken any number of times."""

from __future__ import annotations

import itertools
from typing import Any, Iterable, Iterator, Sized

import numpy as np

from . import _core, _jobs, _options
from ._errors import Error, UsageError, warn
from ._fracture import Fracture
from ._inputs import object_of
from ._made import DEVICE, MadeSolid, checked_device, of_file
from ._values import is_sequence, plain, whole

_TOGETHER = 16  # fractures that grow at once


class Solid(MadeSolid):
    """An object as voxels, prepared once for any number of fractures; `voxelize` makes it.

    It can be pickled: the pickle holds the options and all that was read of the mesh, textures and materials included, and unpickling
    voxelizes it again, to the same bits.  Damaged content is an `InputError`.

    Attributes
    ----------
    name : str
        File name of the mesh, or what it is.
    shape : tuple of int
        Voxels of the tight box along x, y and z.
    origin : ndarray, shape (3,), float64
        World position of the center of the box's first voxel.
    offset : ndarray, shape (3,), float64
        Added to positions, it gives those of the input; 0 unless `recenter` moved the object.
    unit : float
        Meters in the unit of lengths: what the file says, its format usually has, or the option `unit` gave.
    up : str
        The axis that points up, 'x', 'y' or 'z', known in the same way.
    voxel_size : float
        World units per voxel.
    voxels : int
        Voxels of the solid.
    components : int
        Its connected components; each becomes a fragment of its own at least.
    options : Options
        The options that it was voxelized with.
    """

    name: str = property(lambda self: self._core.name)  # type: ignore[assignment]
    shape: tuple[int, int, int] = property(lambda self: self._core.shape)  # type: ignore[assignment]
    unit: float = property(lambda self: self._core.unit)  # type: ignore[assignment]
    up: str = property(lambda self: self._core.up)  # type: ignore[assignment]
    voxel_size: float = property(lambda self: self._core.voxel_size)  # type: ignore[assignment]
    voxels: int = property(lambda self: self._core.voxels)  # type: ignore[assignment]
    components: int = property(lambda self: self._core.components)  # type: ignore[assignment]

    @property
    def origin(self) -> np.ndarray[Any, Any]:
        """World position of the center of the box's first voxel, shape (3,), float64."""
        return np.array(self._core.origin)

    @property
    def offset(self) -> np.ndarray[Any, Any]:
        """Added to positions, it gives those of the input, shape (3,), float64; 0 unless `recenter` moved the object."""
        return np.array(self._core.offset)

    @property
    def options(self) -> _options.Options:
        """The options that it was voxelized with."""
        return _options.Options._of_texts(self._core.given)

    def __repr__(self) -> str:
        return f"<pysherd.Solid {self.name}: {self.voxels} voxels of {self.voxel_size:g}, {self.components} components>"

    def fractures(
        self,
        pieces: int | Iterable[int] = 8,
        seeds: int | Iterable[int] = (0,),
        *,
        device: str = DEVICE,
        progress: _jobs.Progress | None = None,
        **options: Any,
    ) -> Iterator[Fracture]:
        """Breaks the solid many times: for each number of pieces with each seed.

        What all fractures share is made once, and several grow at a time, so this is faster than `fracture` in a loop, with the
        same results.  Nothing of a fracture is kept here once the next is taken.

        Parameters
        ----------
        pieces : int or iterable of int
            Numbers of fragments, the outer loop.
        seeds : int or iterable of int
            Seeds, the inner loop.  Both are taken as fractures are, at most 16 ahead, and may have no end: ``itertools.count()``.
            An iterator of seeds is gone through once, and its seeds are kept where there is another number of fragments.
        device, progress, **options
            As of `fracture`.

        Yields
        ------
        Fracture

        Raises
        ------
        Error
            As `fracture`, or as `pieces` and `seeds` raise, after the fractures before.
        """
        if "seed" in options:
            raise UsageError("seed: fractures() takes seeds, a number or several")
        given = fracture_options(self._core, options)
        for some in _batches(_pairs(_each("pieces", pieces), _each("seeds", seeds))):
            yield from break_solid(self._core, given, some, device, progress)


def _each(name: str, values: Any) -> Iterable[Any]:
    if is_sequence(values):
        return values  # type: ignore[no-any-return]
    whole(name, plain(values), 0)
    return (values,)


def _checked(name: str, keyword: str, value: Any) -> int:
    number = whole(name, plain(value), 0)
    try:
        _options.given({keyword: number})
    except UsageError as e:
        raise UsageError(f"{name}{str(e).removeprefix(keyword)}", e.options) from None
    return number


def _pairs(pieces: Iterable[Any], seeds: Iterable[Any]) -> Iterator[tuple[int, int]]:
    """Yields each number of pieces with each seed, checked when it is taken; an iterator of seeds is gone through once."""
    keeps = iter(seeds) is seeds and not (isinstance(pieces, Sized) and len(pieces) == 1)
    kept: list[int] = []
    for position, p in enumerate(pieces):
        number = _checked("pieces", "pieces", p)
        for s in kept if keeps and position else seeds:
            seed = _checked("seeds", "seed", s)
            if keeps and not position:
                kept.append(seed)
            yield number, seed


def _batches(pairs: Iterator[tuple[int, int]]) -> Iterator[list[tuple[int, int]]]:
    """Yields several at a time; what ends them early is raised after those before it."""
    ended: Exception | None = None
    while ended is None:
        some: list[tuple[int, int]] = []
        try:
            for pair in itertools.islice(pairs, _TOGETHER):
                some.append(pair)
        except Exception as e:
            ended = e
        if some:
            yield some
        if len(some) < _TOGETHER and ended is None:
            return
    raise ended


def fracture_options(core: _core.Solid, options: dict[str, Any]) -> list[tuple[str, str]]:
    """Returns the options of a fracture of a solid: its own and those given."""
    for keyword in options:
        if keyword in _options.SOLID and options[keyword] is not None:
            raise UsageError(f"{keyword}: the solid is voxelized already; give it to voxelize()")
    own = _options.given(options)
    solid_names = {row.name for row in _options.SOLID.values()}
    texts = [option for option in core.given if option[0] in solid_names] + own
    _options.check_together(texts, own)
    return texts


def core_solid(mesh: Any, texts: list[tuple[str, str]], device: str, progress: _jobs.Progress | None) -> _core.Solid:
    """Voxelizes what `voxelize` takes."""
    obj, is_file = object_of(mesh)
    _options.check_together(texts, texts, obj.file)
    try:
        core = _jobs.finish(_core.voxelize(obj, texts, checked_device(device)), progress)
    except Error as e:
        raise of_file(e, is_file) from None
    warn(core.warnings)
    return core


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


def pieces_and_seed(given: list[tuple[str, str]]) -> tuple[int, int]:
    texts = {"pieces": _options.ROWS["pieces"].default, "seed": _options.ROWS["seed"].default, **dict(given)}
    return int(texts["pieces"]), int(texts["seed"])


@_options.documented(_options.VOXELIZE)
def voxelize(mesh: Any, *, device: str = DEVICE, progress: _jobs.Progress | None = None, **options: Any) -> Solid:
    """Voxelizes an object, so that it can be broken any number of times.

    Parameters
    ----------
    mesh
        A path to a mesh or a volume; a pair (vertices, faces) of arrays of shapes (n, 3) and (m, 3), of any dtype and order; an
        object with both, such as a ``trimesh.Trimesh`` or a mesh of Open3D; or a volume, an array of shape (nx, ny, nz) of bool or
        whole numbers that is solid where it is not 0, with voxels of size 1 about whole positions.  Arrays are copied once.
    device : str
        'builtin', or as ``sherd devices`` lists them.
    progress : callable, optional
        Called from this thread as ``progress(stage, fraction)``; returning False cancels.
    {options}

    Returns
    -------
    Solid

    Raises
    ------
    InputError
        Arrays that are no mesh, naming the argument at fault, or an object in which nothing is solid.
    FileError
        A file that is absent, damaged, or of another kind.
    UsageError
        A keyword or a value that the table refuses.
    """
    return Solid(core_solid(mesh, _options.given(options, _options.VOXELIZE, "voxelize"), device, progress))
