"""Fractures.  Meshes, measures, labels and points are made when they are first read."""

from __future__ import annotations

import os
from functools import cached_property
from typing import Any, Iterator, Sequence, overload

import numpy as np

from . import _core, _jobs, _options
from ._errors import Error, UsageError, warn
from ._fragment import Contacts, Fragment, Points, SparseLabels
from ._made import DEVICE, Array, MadeFracture, MadeSolid, checked_device, file_errors, of_file
from ._values import items_of, is_sequence, number_in, path_text, shown, whole, word

_FILE_NAMES = frozenset(row.name for row in _options.SAVE.values())


class Fracture(MadeFracture, Sequence[Fragment]):
    """A solid that is broken: a sequence of fragments, with ids from 1; `fracture` and `load` make it.

    What is not read is not made: with smooth surfaces `labels` come from the growth alone, with exact ones they agree with the
    meshes, which are cut for them; measures, contacts and points of smooth surfaces need no meshes; reading one mesh makes all.  It can be pickled: the pickle holds the solid and the options, and
    unpickling breaks it again, to the same bits; of a fracture that was loaded it holds the path.  Damaged content is an `InputError`.
    """

    def __init__(
        self,
        core: _core.Fracture,
        solid: MadeSolid | None = None,
        options: _options.Options | None = None,
        before: tuple[Fracture, list[int]] | None = None,
    ) -> None:
        super().__init__(core)
        self._solid = solid
        self._options = options
        self._before = before  # what was broken again, and its fragments' ids

    # --- fragments

    def __len__(self) -> int:
        return self._core.count

    @overload
    def __getitem__(self, index: int) -> Fragment: ...
    @overload
    def __getitem__(self, index: slice) -> list[Fragment]: ...
    def __getitem__(self, index: int | slice) -> Fragment | list[Fragment]:
        if isinstance(index, slice):
            return [Fragment(self, i) for i in range(len(self))[index]]
        try:
            return Fragment(self, range(len(self))[index])
        except IndexError:
            raise IndexError(f"there is no fragment at {index}, the fracture has {len(self)}") from None

    def __iter__(self) -> Iterator[Fragment]:
        # Fragments refer to their fracture, and it keeps none of them: it is freed without the garbage collector.
        return (Fragment(self, i) for i in range(len(self)))

    # --- the whole

    @property
    def solid(self) -> MadeSolid | None:
        """The solid that was broken, before any fragment was broken again; None of a fracture that was loaded."""
        if self._before is not None:
            return self._before[0].solid
        return self._solid

    @property
    def options(self) -> _options.Options:
        """The options that were given, those of the solid, pieces and seed included; of a loaded one those of its manifest."""
        if self._options is None:
            self._options = _options.Options._of_texts(self._core.given)
        return self._options

    @property
    def seed(self) -> int:
        """The seed of every random choice."""
        return self._core.seed

    @property
    def voxel_size(self) -> float:
        """World units per voxel."""
        return self._core.voxel_size

    @property
    def origin(self) -> Array:
        """(3,) float64, world position of the center of ``labels[0, 0, 0]``."""
        return np.array(self._core.origin)

    @property
    def offset(self) -> Array:
        """(3,) float64: added to positions, it gives those of the input; 0 unless `recenter` moved the object."""
        return np.array(self._core.offset)

    @property
    def unit(self) -> float:
        """Meters in the unit of lengths: what the mesh's file says, its format usually has, or `unit` gave."""
        return self._core.unit

    @property
    def up(self) -> str:
        """The axis that points up, 'x', 'y' or 'z': what the mesh's file says, its format usually has, or `up` gave."""
        return self._core.up

    @property
    def parents(self) -> list[int]:
        """Of fragments that were broken again: for each fragment the id of the one that it is or was a part of; else empty."""
        return self._core.parents

    @cached_property
    def labels(self) -> Array:
        """(nx, ny, nz) uint16, the fragment's id of each voxel of the solid's tight box: 0 outside, 65535 in the solid but in no
        fragment (eroded or withheld).  Voxel (i, j, k) lies at ``origin + voxel_size * (i, j, k)``."""
        return file_errors(_core.labels(self._core), None, self._is_loaded)

    @property
    def sparse_labels(self) -> SparseLabels:
        """The voxels of the solid and their fragments, in the order of ``labels``."""
        voxels = np.argwhere(self.labels)
        return SparseLabels(voxels.astype(np.int32), self.labels[tuple(voxels.T)])

    @cached_property
    def contacts(self) -> Contacts:
        """Where fragments touch: pairs of ids, areas, normals and centroids."""
        return Contacts(*self._measured.contacts())

    @_options.documented(_options.POINTS)
    def points(self, n: int, *, progress: _jobs.Progress | None = None, **options: Any) -> Points:
        """Samples points on the fragments, without making meshes where surfaces are the default ones.

        Parameters
        ----------
        n : int
            Points on each fragment, 0 to 10,000,000; with `share_points` on all together, in proportion to their areas.
        progress : callable, optional
            As of `fracture`.
        {options}

        Returns
        -------
        Points
            The same points for the same fracture; those of ``sherd fracture --points`` before they are rounded.

        Raises
        ------
        UsageError
            A number or a keyword that the table refuses.
        """
        own = _options.given(options, _options.POINTS, "points")
        texts = _options.given({"points": n}) + own
        _options.check_together(texts, own)
        return Points(*file_errors(_core.points(self._core, texts), progress, self._is_loaded))

    # --- breaking again

    @_options.documented(_options.BROKEN)
    def broken(
        self, ids: int | Sequence[int], *, device: str = DEVICE, progress: _jobs.Progress | None = None, **options: Any
    ) -> Fracture:
        """Breaks some fragments again; the others stay, with their ids and meshes.

        The first part of a broken fragment has its id, the other parts follow the last id.  Of a fracture that was loaded, its labels
        and level sets are read.

        Parameters
        ----------
        ids : int or sequence of int
            The fragments to break, each into `pieces`; ids begin at 1.
        device : str
            As of `fracture`.
        progress : callable, optional
            As of `fracture`.
        {options}
            Those that are not given are as in this fracture, but for what holds for the whole (impacts, a density, guides), and the
            number of pieces; the seed is the next one.

        Returns
        -------
        Fracture
            What ``sherd fracture DIR --only IDS`` gives of this fracture's folder; `parents` says which fragment each comes from.

        Raises
        ------
        UsageError
            There is no such fragment, or a keyword or a value that the table refuses.
        FileError
            A file of a fracture that was loaded is absent or damaged.
        """
        given = _options.given(options, _options.BROKEN, "broken")
        try:
            everything = _core.options_again(self._core, given)
        except Error as e:
            raise of_file(e, self._is_loaded) from None
        _options.check_together(everything, given)
        last = len(self)
        several: list[Any] = [ids] if isinstance(ids, int) or not is_sequence(ids) else items_of("ids", ids)
        numbers = [whole("ids", id, 1, last) for id in several]
        if not numbers:
            raise UsageError("ids: no fragment is named")
        return self._broken(numbers, everything, device, progress)

    def _broken(self, ids: list[int], given: _options.Texts, device: str, progress: _jobs.Progress | None) -> Fracture:
        job = _core.broken_again(self._core, ids, given, checked_device(device))
        core = file_errors(job, progress, self._is_loaded)
        warn(core.guide_warnings)
        return Fracture(core, None, None, (self, ids))

    # --- files and other libraries

    @_options.documented(_options.SAVE)
    def save(self, folder: str | os.PathLike[str], *, progress: _jobs.Progress | None = None, **options: Any) -> None:
        """Writes a folder as ``sherd fracture`` does: meshes, level sets, labels, a manifest and a preview.

        Parameters
        ----------
        folder : path
            Absent, empty or an earlier fracture's, which is replaced.
        progress : callable, optional
            As of `fracture`.
        {options}

        Raises
        ------
        OutputError
            The folder holds something else, cannot be written, or the disk is full; it is as before then.
        UsageError
            Keywords that contradict each other, or the fracture was loaded.
        """
        if not isinstance(self._core, _core.GrownPieces):
            raise UsageError("save: the fracture was loaded from a folder; copy that")
        texts = list(self._core.given)
        new = _options.given(options, _options.SAVE, "save")
        names = {name for name, _ in new}
        texts = [option for option in texts if option[0] not in names] + new
        _options.check_together(texts, [option for option in texts if option[0] in _FILE_NAMES], before=self._core.given)
        warn(_jobs.finish(_core.save(self._core, path_text("folder", folder), texts), progress))

    def to_trimesh(self) -> list[Any]:
        """Returns a ``trimesh.Trimesh`` of each fragment, with the face attribute ``neighbor``.

        Raises
        ------
        ImportError
            trimesh is not installed.
        """
        return [fragment.to_trimesh() for fragment in self]

    def render(
        self,
        file: str | os.PathLike[str] | None = None,
        *,
        explode: float = 0.25,
        azimuth: float = 35.0,
        elevation: float = 20.0,
        up: str = "auto",
        size: tuple[int, int] = (1280, 720),
        progress: _jobs.Progress | None = None,
    ) -> Array:
        """Renders an exploded view.

        Parameters
        ----------
        file : path, optional
            An image to write: ``.png``, or ``.exr`` with AOVs for compositing.
        explode : float
            How far fragments move apart, as a share of their distance to the center, 0..100.
        azimuth, elevation : float
            Of the camera, degrees around the up axis, and above the horizon, -90..90.
        up : str
            The mesh's axis that points up: 'x', 'y', 'z', or 'auto' for that of the fracture.
        size : tuple of int
            Width and height in pixels, 16..16384.

        Returns
        -------
        ndarray, shape (height, width, 3), uint8, sRGB

        Raises
        ------
        UsageError
            A value out of its range, or another ending of the file.
        OutputError
            The file cannot be written.
        """
        path = "" if file is None else path_text("file", file)
        if path and not path.lower().endswith((".png", ".exr")):
            raise UsageError(f"file: {shown(path)} ends neither in .png nor .exr")
        numbers = number_in("explode", explode, 0, 100), number_in("azimuth", azimuth, -1e9, 1e9), number_in("elevation", elevation, -90, 90)
        sides = items_of("size", size) if is_sequence(size) else []
        if len(sides) != 2:
            raise UsageError(f"size: {shown(size)} is no pair of a width and a height")
        width, height = (whole("size", side, 16, 16384) for side in sides)
        axis = word("up", up, ("auto", "x", "y", "z"))
        axis = self.up if axis == "auto" else axis
        return file_errors(_core.render(self._core, path, *numbers, axis, width, height), progress, self._is_loaded)

    def __repr__(self) -> str:
        return f"<pysherd.Fracture: {len(self)} fragments, seed {self.seed}>"
