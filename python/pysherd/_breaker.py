"""Makes the items of a stream of fractures: breaks a mesh, samples points, and arranges them as a layout does."""

from __future__ import annotations

import itertools
from functools import partial
from typing import Any, Callable, Iterator

from . import _layouts
from ._break import break_solid
from ._drawn import Drawn
from ._errors import Error, InputError, UsageError, warn
from ._fracture import Fracture
from ._library import Mesh, Solids
from ._options import ROWS, SOLID, VOXELIZE
from ._order import Slot, generator, hashed
from ._solid import Solid
from ._voxel_layouts import VOXEL_LAYOUTS, volume_of

_MOST_FAILURES = 1000  # attempts in a row
_MOST_CYCLES = 50  # without an item, when most meshes are known to fail
_SOLID_NAMES = frozenset(row.name for row in SOLID.values())
_KEPT_NAMES = frozenset(row.name for row in VOXELIZE.values())  # of a solid, where the fracture has no value of its own


class Breaker:
    """Makes items of meshes by the same options.

    Parameters
    ----------
    layout : str
        A key of `LAYOUTS` or `VOXEL_LAYOUTS`.
    points : int, optional
        Points of an item or of a fragment; by default the layout's.
    objects : pair
        The fewest and the most objects of an item.
    cache_bytes : int
        Memory of the solids that are kept.
    skips : bool
        Leaves out meshes that cannot be broken, with a warning; else they are errors.
    cycle : int
        Attempts that count as one visit of every mesh.
    """

    def __init__(self, meshes: list[Mesh], options: Drawn, layout: str, points: int | None, objects: tuple[int, int], cache_bytes: int,
                 device: str, skips: bool, cycle: int) -> None:  # fmt: skip
        self.layout = layout
        self._layout = _layouts.LAYOUTS.get(layout)
        self._voxels = VOXEL_LAYOUTS.get(layout)
        self.points = points or (self._layout.points if self._layout else 0)
        self.skipped: dict[str, int] = {}
        self._options, self._meshes, self._device, self._skips, self._cycle = options, meshes, device, skips, cycle
        self.objects = objects
        self._check()
        self.solids = Solids(meshes, options.of_solids, cache_bytes, device)
        self._failed: set[int] = set()
        self._failures = self._passed = 0  # since the last item
        self._reason = ""  # of the last failure

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "solids": self.solids.emptied()}

    def _check(self) -> None:
        low, high = self._options.pieces
        if self._layout is None:
            if self.objects[1] > 1:
                raise UsageError(f"objects: layout {self.layout} has the voxels of one object")
            if self.points:
                raise UsageError(f"points: layout {self.layout} has voxels and no points")
            if self.layout == "completion" and low < 2:
                raise UsageError("pieces: layout completion takes one of 2 fragments or more away")
            return self._check_solids()
        most, least, objects = self._most, self._layout.least, self.objects[1]
        if most and not 2 <= low <= high * objects <= most:
            of = f" of {objects} objects" if objects > 1 else ""
            raise UsageError(f"pieces: layout {self.layout} holds 2 to {most} fragments, not {low if low < 2 else high}{of}")
        if self._layout.counts is not _layouts.equal_counts and self.points < most * least * objects:
            raise UsageError(f"points: layout {self.layout} needs at least {most * least * objects}, {least} for each of {most} fragments")
        self._check_solids()

    @property
    def _most(self) -> int:
        return self._layout.fragments if self._layout else 0

    def _check_solids(self) -> None:
        given, solids = dict(self._options.of_solids), [mesh.given._core for mesh in self._meshes if isinstance(mesh.given, Solid)]
        for name in given:
            if solids and name in _SOLID_NAMES:
                raise UsageError(f"{name.replace('-', '_')}: the solids are voxelized already; give it to voxelize()")
        if given.get("surface") == "exact" and any(dict(core.given).get("surface") in ("smooth", "labels") for core in solids):
            raise UsageError("surface: a solid keeps no mesh; give surface='exact' to voxelize() too")

    def item(self, slots: Iterator[Slot]) -> dict[str, Any]:
        """Returns the item of the first fracture that can be used.

        Raises
        ------
        Error
            A mesh cannot be broken, and none is left out, or too many were in a row.
        """
        return self._first(slots, self._sampled)  # type: ignore[no-any-return]

    def fracture(self, slots: Iterator[Slot]) -> Fracture:
        """Returns the first fracture that can be used, as `item`."""
        return self._first(slots, lambda slot, f: f)

    def _first(self, slots: Iterator[Slot], made: Callable[[Slot, Fracture], Any]) -> Any:
        for slot in slots:
            result = self._tried(slot, made)
            if result is not None:
                self._failures = self._passed = 0
                return result
            self._passed += 1
            self._check_failures()
        raise AssertionError("attempts have no end")

    def _broken(self, slot: Slot) -> Fracture:
        core = self.solids[slot.mesh]
        own = [option for option in self._options.texts(slot.seed) if option[0] not in _SOLID_NAMES]
        names = {name for name, _ in own}
        texts = [option for option in core.given if option[0] in _KEPT_NAMES - names] + own
        if not {"surface", "preset"} & {name for name, _ in texts}:
            texts.append(("surface", "smooth"))
        pieces = int(dict(texts).get("pieces", ROWS["pieces"].default))
        return next(break_solid(core, texts, [(pieces, slot.seed)], self._device, None))

    def _sampled(self, slot: Slot, f: Fracture) -> dict[str, Any]:
        if self._layout is None:
            assert self._voxels is not None
            return self._voxels.make(volume_of(f, self._options.side, **self._named(slot)))
        low, high = self.objects
        count = low + hashed("objects", slot.seed) % (high - low + 1)
        samples = [self._sample(slot, f, 0, count)]
        for k in range(1, count):
            used = {sample.mesh for sample in samples}
            samples.append(self._first(self._others(slot, k, used), partial(self._sample, which=k, objects=count)))
        return self._layout.make(samples[0] if count == 1 else _layouts.sample_of_several(samples, generator(hashed("object order", slot.seed))))

    def _sample(self, slot: Slot, f: Fracture, which: int, objects: int) -> _layouts.Sample:
        """Samples one of the objects of an item, which has its part of the points."""
        assert self._layout is not None
        points = self.points
        if self._layout.counts is not _layouts.equal_counts:
            points = points // objects + (which < points % objects)
        box = self.solids[slot.mesh].surface_box
        return _layouts.sample_of(f, self._layout, points, self._options.of_points, box, **self._named(slot))

    def _others(self, slot: Slot, which: int, used: set[int]) -> Iterator[Slot]:
        """Yields the fracture that is another object of an item, and others in its place: of a mesh that is not used, where there is one."""
        usable = len(self._failed | used) < len(self._meshes)
        for attempt in itertools.count():
            mesh = hashed("object mesh", slot.seed, which, attempt) % len(self._meshes)
            if usable and mesh in used and attempt < _MOST_FAILURES:
                continue
            yield Slot(slot.number, mesh, hashed("object", slot.seed, which, attempt))

    def _named(self, slot: Slot) -> dict[str, Any]:
        return {"number": slot.number, "mesh": slot.mesh, "seed": slot.seed, "name": f"{self._meshes[slot.mesh].key}/fractured_{slot.number}",
                "random": generator(hashed("pose", slot.seed))}  # fmt: skip

    def _tried(self, slot: Slot, made: Callable[[Slot, Fracture], Any]) -> Any:
        """Returns what is made of a fracture; None if it is left out."""
        mesh = self._meshes[slot.mesh]
        if slot.mesh in self._failed:
            self.skipped[mesh.key] += 1
            return None
        try:
            self._check_solid(slot.mesh)
        except Error as e:
            self._failed.add(slot.mesh)
            self._skip(mesh, e, "")
            return None
        try:
            f = self._broken(slot)
            self._check_count(len(f), "breaks into {} fragments")
            return made(slot, f)
        except Error as e:
            self._skip(mesh, e, f"{mesh.key}, seed {slot.seed}: ")
            return None

    def _check_solid(self, mesh: int) -> None:
        core = self.solids[mesh]
        if self._most and core.components > self._most:
            key = self._meshes[mesh].key.replace("{", "{{").replace("}", "}}")
            self._check_count(core.components, f"{key}: has {{}} connected components")

    def _check_count(self, count: int, sentence: str) -> None:
        most = self._most
        if most and not 2 <= count <= most:
            raise InputError(f"{sentence.format(count)}, and layout {self.layout} holds 2 to {most}")

    def _skip(self, mesh: Mesh, error: Error, prefix: str) -> None:
        """Counts what is left out, and warns of each mesh once; raises the error if nothing is."""
        if error.code != InputError.code or not self._skips:
            raise type(error)(f"{prefix}{error}", error.options) from error
        self._failures += 1
        self._reason = f"{prefix}{error}"
        if mesh.key not in self.skipped:
            warn([f"{self._reason}; skipped, as of {len(self.skipped) + 1} of {len(self._meshes)} meshes until now"])
        self.skipped[mesh.key] = self.skipped.get(mesh.key, 0) + 1

    def _check_failures(self) -> None:
        """Raises an error where no item comes any more."""
        if len(self._failed) == len(self._meshes):
            raise InputError(f"none of {len(self._meshes)} meshes can be broken; the last: {self._reason}")
        if self._failures >= _MOST_FAILURES or self._passed >= _MOST_CYCLES * self._cycle:
            raise InputError(f"{self._passed} fractures in a row cannot be used; the last: {self._reason}")
