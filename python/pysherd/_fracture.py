"""Fractures and fragments.  Meshes, measures, labels and points are made when they are first read."""

from __future__ import annotations

import os
from functools import cached_property
from typing import Any, Iterator, NamedTuple, Sequence, overload

import numpy as np

from . import _core, _jobs, _options
from ._errors import Error, FileError, UsageError, warn
from ._solid import DEVICE, Solid, _unpickled, checked_device, core_solid, fracture_options

Array = np.ndarray[Any, Any]


_FILE_NAMES = frozenset(row.name for row in _options.SAVE.values())


class Points(NamedTuple):
    """Points on the surfaces of all fragments, one fragment after another."""

    positions: Array
    """(n, 3) float64, world units"""
    normals: Array
    """(n, 3) float64, unit, outwards"""
    neighbor: Array
    """(n,) uint16, id of the fragment on the other side, 0 on the original surface"""
    fragment: Array
    """(n,) uint16, id of the point's fragment"""


class Contacts(NamedTuple):
    """Where fragments touch, each pair once."""

    fragments: Array
    """(n, 2) int32, ids, the lower first"""
    area: Array
    """(n,) float64, world units squared"""
    normal: Array
    """(n, 3) float64, mean direction from the lower id to the higher, unit"""
    centroid: Array
    """(n, 3) float64, world units"""


class SparseLabels(NamedTuple):
    """The voxels of the solid with their fragments."""

    voxels: Array
    """(n, 3) int32, positions in `Fracture.labels`"""
    labels: Array
    """(n,) uint16, as in `Fracture.labels`"""


class Fragment:
    """One fragment of a fracture.

    Each array is made when it is first read, owns its memory, and stays when the fracture is gone.

    Attributes
    ----------
    id : int
        1 to the number of fragments.
    """

    def __init__(self, fracture: Fracture, index: int) -> None:
        self._fracture = fracture
        self._index = index
        self.id: int = index + 1

    @cached_property
    def vertices(self) -> Array:
        """(n, 3) float64, world units."""
        return self._fracture._meshed.vertices(self._index)

    @cached_property
    def faces(self) -> Array:
        """(m, 3) uint32, rows of `vertices`, counter-clockwise seen from outside; a closed mesh."""
        return self._fracture._meshed.faces(self._index)

    @cached_property
    def neighbor(self) -> Array:
        """(m,) uint16, per face the id of the fragment on the other side, 0 on the original surface."""
        return self._fracture._meshed.neighbor(self._index)

    @cached_property
    def voxels(self) -> int:
        """Number of voxels."""
        return self._fracture._measured.voxels(self._index)

    @cached_property
    def volume(self) -> float:
        """Volume of the mesh, world units cubed."""
        return self._fracture._measured.volume(self._index)

    @cached_property
    def area(self) -> float:
        """Area of the mesh, world units squared."""
        return self._fracture._measured.area(self._index)

    @cached_property
    def fracture_area(self) -> float:
        """Area of the faces that have a neighbor."""
        return self._fracture._measured.fracture_area(self._index)

    @cached_property
    def centroid(self) -> Array:
        """(3,) float64, center of mass, world units."""
        return self._fracture._measured.centroid(self._index)

    @cached_property
    def inertia(self) -> Array:
        """(3, 3) float64, about the centroid at unit density."""
        return self._fracture._measured.inertia(self._index)

    def to_trimesh(self) -> Any:
        """Returns a ``trimesh.Trimesh`` with the face attribute ``neighbor``.

        Raises
        ------
        ImportError
            trimesh is not installed.
        """
        import trimesh

        return trimesh.Trimesh(self.vertices, self.faces, face_attributes={"neighbor": self.neighbor}, process=False)

    def __repr__(self) -> str:
        return f"<pysherd.Fragment {self.id}>"


class Fracture(Sequence[Fragment]):
    """A solid that is broken: a sequence of fragments, with ids from 1; `fracture` and `load` make it.

    What is not read is not made: `labels` come from the growth alone; measures, contacts and points need no meshes where surfaces
    are the default ones; reading one mesh makes all.  It can be pickled: the pickle holds the solid and the options, and
    unpickling breaks it again, to the same bits.
    """

    def __init__(self, core: _core.Fracture, solid: Solid | None = None, options: _options.Options | None = None) -> None:
        self._core = core
        self._solid = solid
        self._options = options

    # --- fragments

    def __len__(self) -> int:
        return self._core.count

    @overload
    def __getitem__(self, index: int) -> Fragment: ...
    @overload
    def __getitem__(self, index: slice) -> list[Fragment]: ...
    def __getitem__(self, index: int | slice) -> Fragment | list[Fragment]:
        return self._fragments[index]

    def __iter__(self) -> Iterator[Fragment]:
        return iter(self._fragments)

    @cached_property
    def _fragments(self) -> list[Fragment]:
        return [Fragment(self, i) for i in range(len(self))]

    @property
    def _measured(self) -> _core.Fragments:
        return self._made(meshes=False)

    @property
    def _meshed(self) -> _core.Fragments:
        return self._made(meshes=True)

    def _made(self, meshes: bool, progress: _jobs.Progress | None = None) -> _core.Fragments:
        kept = self.__dict__.setdefault("_kept", {})
        if meshes not in kept:
            kept[meshes] = _files(_core.fragments(self._core, meshes), progress, self._is_loaded)
            if meshes and self._core.exact_failure:
                warn([self._core.exact_failure + ", so fragments have the smooth surface instead of the exact one"])
        return kept[meshes]

    # --- the whole

    @property
    def solid(self) -> Solid | None:
        """The solid that was broken; None of a fracture that was loaded."""
        if self._solid is None and not self._is_loaded:
            self._solid = Solid(self._core.solid)
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

    @cached_property
    def labels(self) -> Array:
        """(nx, ny, nz) uint16, the fragment's id of each voxel of the solid's tight box: 0 outside, 65535 in the solid but in no
        fragment (eroded or withheld).  Voxel (i, j, k) lies at ``origin + voxel_size * (i, j, k)``."""
        return _files(_core.labels(self._core), None, self._is_loaded)

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
        return Points(*_files(_core.points(self._core, texts), progress, self._is_loaded))

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
        warn(_jobs.finish(_core.save(self._core, _folder("folder", folder), texts), progress))

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
        up: str = "y",
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
            Of the camera, degrees around the up axis, and above the horizon.
        up : str
            The mesh's axis that points up: 'x', 'y' or 'z'.
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
        path = "" if file is None else _folder("file", file)
        if path and not path.lower().endswith((".png", ".exr")):
            raise UsageError(f"file: {path} ends neither in .png nor .exr")
        if up not in ("x", "y", "z"):
            raise UsageError(f"up: {up!r} is not one of x, y, z")
        try:
            width, height = (int(side) for side in size)
            numbers = float(explode), float(azimuth), float(elevation)
        except (TypeError, ValueError) as e:
            raise UsageError(f"render: {e}") from None
        return _files(_core.render(self._core, path, *numbers, up, width, height), progress, self._is_loaded)

    @property
    def _is_loaded(self) -> bool:
        return isinstance(self._core, _core.LoadedPieces)

    def __repr__(self) -> str:
        return f"<pysherd.Fracture: {len(self)} fragments, seed {self.seed}>"

    def __reduce__(self) -> tuple[Any, ...]:
        if isinstance(self._core, _core.LoadedPieces):
            return load, (self._core.file,)
        solid = self.solid
        assert solid is not None and isinstance(self._core, _core.GrownPieces)
        return _broken_again, (solid, self._core.given)


def _files(job: _core.Job, progress: _jobs.Progress | None, is_file: bool) -> Any:
    """Waits for a job whose input errors are about files if `is_file`."""
    try:
        return _jobs.finish(job, progress)
    except Error as e:
        if is_file and e.code == FileError.code:
            raise FileError(str(e), e.options) from None
        raise


def _folder(name: str, path: Any) -> str:
    try:
        text = os.fsdecode(os.fspath(path))
    except TypeError:
        raise UsageError(f"{name}: a {type(path).__name__} is no path") from None
    if not text or "\0" in text:
        raise UsageError(f"{name}: {text!r} is no path")
    return text


def break_solid(
    core: _core.Solid, given: list[tuple[str, str]], pairs: list[tuple[int, int]], device: str, progress: _jobs.Progress | None
) -> Iterator[Fracture]:
    """Breaks a solid by pairs of pieces and seeds, which grow together."""
    all = _jobs.finish(_core.fracture(core, given, pairs, checked_device(device)), progress)
    solid = Solid(core)
    while all:  # lets go of each when the next is taken
        yield Fracture(all.pop(0), solid)


def _pieces_and_seed(given: list[tuple[str, str]]) -> tuple[int, int]:
    texts = {"pieces": _options.ROWS["pieces"].default, "seed": _options.ROWS["seed"].default, **dict(given)}
    return int(texts["pieces"]), int(texts["seed"])


def _broken_again(solid: Solid, given: list[tuple[str, str]]) -> Fracture:
    return next(break_solid(solid._core, given, [_pieces_and_seed(given)], DEVICE, None))


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
    core = _files(_core.load(_folder("folder", folder)), None, True)
    return Fracture(core, None, _options.Options._of_texts(_core.recorded_options(core.file)))
