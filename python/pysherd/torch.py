"""Endless fractures for PyTorch: a data set that breaks meshes as a network trains.

>>> from pysherd.torch import FractureDataset, collate
>>> data = FractureDataset("vessels", layout="garf", pieces="2..10", resolution=64, roughness="0%..1%")
>>> for batch in torch.utils.data.DataLoader(data, batch_size=16, num_workers=4, collate_fn=collate):
...     batch["pointclouds"], batch["fracture_surface_gt"]

PyTorch is not among the requirements of pysherd: install it beside, 1.13 or later.
"""

from __future__ import annotations

import functools
import hashlib
from typing import Any, Callable, Iterator, Mapping, Sequence

import numpy as np

try:
    import torch
    from torch.utils.data import IterableDataset, default_collate, get_worker_info
except ModuleNotFoundError as _missing:
    if _missing.name != "torch":
        raise
    raise ImportError("pysherd.torch needs PyTorch, which is not installed: pip install torch") from None

from . import _core
from ._breaker import Breaker
from ._drawn import ACCEPTED, Drawn
from ._errors import UsageError, warn
from ._fracture import Fracture
from ._layouts import LAYOUTS
from ._library import library_of
from ._options import ROWS, documented_text
from ._order import Order, Share, given_ranks, items_of_rank, share_of
from ._solid import DEVICE, checked_device
from ._splits import SPLITS, meshes_of_split, ratio_of
from ._values import flag, shown, whole, whole_range, word
from ._voxel_layouts import VOXEL_LAYOUTS

__all__ = ["FractureDataset", "collate", "collate_fragments"]

_EPOCH, _IN_WORKERS = 0, 1  # positions in the tensor that workers share
_PLACE = ("epoch", "position", "stream", "streams")  # in a state
_MOST_NUMBER = 2**63 - 1  # of an item or an epoch: tensors of int64 hold them
_MOST_OBJECTS = 1000
_MOST_POINTS = int(ROWS["points"].range.split("..")[1])


class FractureDataset(IterableDataset[Any]):
    """Breaks meshes as a network trains: a stream of items, each of a fracture that no other item has.

    The stream is a pure function of `seed` and the epoch.  Ranks and workers share it: none breaks what another does.  Items are
    dictionaries of NumPy arrays, numbers and strings, of which `collate` makes tensors.

    Parameters
    ----------
    meshes
        A folder, with all below it, or a ``.txt`` file with a path a line, both as ``sherd dataset`` reads them; or a mesh, or
        several: each whatever `pysherd.voxelize` takes, or a `Solid`, whose `preset` and `surface` hold unless they are given here.
        Arrays are copied once.
    layout : str
        Keys, shapes and dtypes of an item: ``"points"`` and ``"fragments"`` of our own, or those of the loaders of published
        networks: ``"garf"`` (GARF), ``"rpf"`` (Rectified Point Flow), ``"pfpp"`` (PuzzleFusion++), ``"jigsaw"`` (Jigsaw),
        ``"mpa"`` (multi_part_assembly).  Volumes of voxels are ``"voxels"``, with the labels of all fragments, and
        ``"completion"``, an object without one of its fragments, that fragment, and the whole.
    points : int, optional
        Points of an item, by the fragments' areas; of ``"fragments"``, ``"pfpp"`` and ``"mpa"`` points of each fragment.  The
        default is the loader's: 5000 or 1000; of ``"fragments"`` 1024.
    items : int, optional
        Items of an epoch in all processes; each rank has ``items // world_size``, at least 1.  They have the numbers 0 to ``items - 1``, less
        what the ranks do not divide, whatever the processes.  By default the stream is endless.
    objects : int or str
        Objects of an item, such as ``"2..5"``: a collection of fragments of several objects, drawn among the meshes and set up side by side
        along x, 1.5 apart, their fragments in a random order.  `object` says which one each fragment (each point of ``"points"``) is of, in our own layouts; `fracture` has the first.
    split : str, optional
        ``"train"``, ``"val"`` or ``"test"``: only the meshes of this part, the same as ``sherd dataset`` puts there.  With
        `items` given, and `set_epoch` not called, those of ``"val"`` are the same each time.
    splits : str
        The ratio of the three parts.
    transform : callable, optional
        Is given each item, in the worker that made it, and returns what takes its place.
    seed : int
        Of all random choices.
    repeats : int
        Fractures of a mesh before the next one is voxelized.
    mix : int
        Meshes that a process breaks in turn.
    shuffle : bool
        Goes through the meshes in a random order each time; else in theirs, at first from the first on, then from a random one.
    on_error : str
        ``"skip"``: a mesh that cannot be broken is left out with a warning, and a fracture of another takes each one's place; `skipped`
        counts them.  ``"raise"``: it is an error.
    cache_bytes : int
        About how much memory the solids that are kept may take, in each process.
    threads : int, optional
        Threads of each fracture; 0: all cores.  By default 1 in a worker, and what `limit_threads` has set elsewhere.
    device : str
        As of `pysherd.fracture`.
    rank, world_size : int, optional
        Of this process among those that train.  By default those of ``torch.distributed``.
    {options}

    Raises
    ------
    UsageError
        A keyword or a value that is not accepted.
    InputError, FileError
        There are no meshes.

    Notes
    -----
    An option of the groups Seeds, Growth, Erosion and Surface may be a range, ``roughness="0%..1%"``, or a choice,
    ``sampler="uniform|poisson"``; it is drawn for each fracture, as by ``sherd dataset``.  So is ``pieces="2..10"``, or ``range(2, 11)``; a
    tuple is no range, but a value of several numbers, ``roughness=(1, 0.7)``.  Meshes are
    voxelized as by the program, with 128 to 512 voxels along the longest side: give ``resolution``, such as 64, for more items a second.
    """

    def __init__(
        self,
        meshes: Any,
        *,
        layout: str = "points",
        points: int | None = None,
        items: int | None = None,
        objects: int | str = 1,
        split: str | None = None,
        splits: str = "80/10/10",
        transform: Callable[[dict[str, Any]], Any] | None = None,
        seed: int = 0,
        repeats: int = 8,
        mix: int = 16,
        shuffle: bool = True,
        on_error: str = "skip",
        cache_bytes: int = 2**30,
        threads: int | None = None,
        device: str = DEVICE,
        rank: int | None = None,
        world_size: int | None = None,
        **options: Any,
    ) -> None:
        word("layout", layout, [*LAYOUTS, *VOXEL_LAYOUTS])
        word("on_error", on_error, ("skip", "raise"))
        self._items = None if items is None else whole("items", items, 1, _MOST_NUMBER)
        self._threads = None if threads is None else whole("threads", threads, 0, 4096)
        self._given_ranks = given_ranks(rank, world_size)
        self._known_ranks: tuple[int, int] | None = None
        if self._items is not None:
            items_of_rank(self._items, self._ranks()[1])  # is there one?
        if transform is not None and not callable(transform):
            raise UsageError(f"transform: {shown(transform)} is no function")
        self._transform = transform
        self._options, meshes = Drawn(options), library_of(meshes)
        if split is not None:
            meshes = meshes_of_split(meshes, word("split", split, SPLITS), ratio_of(splits))
        self._order = Order(len(meshes), whole("seed", seed, 0, 2**64 - 1), whole("repeats", repeats, 1, 2**32), whole("mix", mix, 1, 2**32),
                            flag("shuffle", shuffle))  # fmt: skip
        self._breaker = Breaker(meshes, self._options, layout, None if points is None else whole("points", points, 1, _MOST_POINTS),
                                whole_range("objects", objects, 1, _MOST_OBJECTS), whole("cache_bytes", cache_bytes, 0, _MOST_NUMBER), checked_device(device), on_error == "skip",
                                self._order.repeats * (self._order.mix + len(meshes)))  # fmt: skip
        self._meshes = meshes
        self._shared = torch.zeros(2, dtype=torch.int64).share_memory_()
        self._resumed: dict[str, Any] | None = None
        self._reached: dict[str, Any] | None = None

    @property
    def skipped(self) -> dict[str, int]:
        """How many fractures of each mesh were left out in this process; those that workers left out are counted there."""
        return dict(self._breaker.skipped)

    # --- the stream

    def set_epoch(self, epoch: int) -> None:
        """Chooses the epoch that the next iteration goes through; each has other fractures.  Reaches workers that persist, too."""
        self._shared[_EPOCH] = epoch = whole("epoch", epoch, 0, _MOST_NUMBER)
        if self._resumed is not None and self._resumed["epoch"] != epoch:
            self._resumed = None
        if self._reached is not None and self._reached["epoch"] != epoch:
            self._reached = None

    def __len__(self) -> int:
        if self._items is None:
            raise TypeError("the stream is endless and has no length; give items=")
        return items_of_rank(self._items, self._ranks()[1])

    def __iter__(self) -> Iterator[dict[str, Any]]:
        worker = get_worker_info()
        share = share_of(self._items, *self._ranks(), *((worker.id, worker.num_workers) if worker else (0, 1)))
        if worker:
            self._shared[_IN_WORKERS] = 1
        if worker or self._threads is not None:
            _core.limit_threads(1 if self._threads is None else self._threads)
        epoch, position = int(self._shared[_EPOCH]), 0
        resumed = self._pending()
        if resumed is not None:
            self._check_share(resumed, share)
            position = resumed["position"]
            resumed["used"].fill_(1)
        self._resumed, self._reached = None, self._state(epoch, share, position)
        return self._stream(epoch, share, position)

    def _stream(self, epoch: int, share: Share, position: int) -> Iterator[dict[str, Any]]:
        for number in self._order.numbers(share, position):
            item = self._breaker.item(self._order.attempts(epoch, number))
            position += 1
            self._reached = self._state(epoch, share, position)
            yield item if self._transform is None else self._transform(item)

    def fracture(self, index: int, epoch: int | None = None) -> Fracture:
        """Breaks a mesh as for an item, of which the layout may not hold all: its meshes, its image.

        Parameters
        ----------
        index : int
            Of the item: its ``index``, or ``data_id``.
        epoch : int, optional
            That of the item; by default the current one.
        """
        number = whole("index", index, 0, _MOST_NUMBER)
        of = int(self._shared[_EPOCH]) if epoch is None else whole("epoch", epoch, 0, _MOST_NUMBER)
        return self._breaker.fracture(self._order.attempts(of, number))

    # --- processes

    def _ranks(self) -> tuple[int, int]:
        return self._given_ranks or _group_ranks() or self._known_ranks or (0, 1)

    def __getstate__(self) -> dict[str, Any]:
        # A worker that is spawned has no process group.
        return {**self.__dict__, "_known_ranks": _group_ranks() or self._known_ranks}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        for tensor in [self._shared] + ([self._resumed["used"]] if self._resumed else []):
            tensor.share_memory_()  # does nothing to one that is

    # --- state

    @functools.cached_property
    def _identity(self) -> str:
        """Of what the stream depends on; of files, this is their paths."""
        parts = [self._order, self._options, self._breaker.layout, self._breaker.points, self._breaker.objects, self._items, *(mesh.identity for mesh in self._meshes)]
        return hashlib.blake2b("\n".join(map(repr, parts)).encode(), digest_size=8).hexdigest()

    def _state(self, epoch: int, share: Share, position: int) -> dict[str, Any]:
        return {"epoch": epoch, "position": position, "stream": share.stream, "streams": share.streams}

    def state_dict(self) -> dict[str, Any]:
        """Returns where the stream is: after the last item that was taken from it, in this process.

        With a DataLoader that has no workers, this is after its last batch.  Workers have states of their own, which torchdata's
        ``StatefulDataLoader`` saves and restores.
        """
        state = self._pending() or self._reached
        if state is None:
            if int(self._shared[_IN_WORKERS]) and get_worker_info() is None:
                warn(["state_dict: the workers of the DataLoader have the state; use torchdata's StatefulDataLoader"])
            state = self._state(int(self._shared[_EPOCH]), share_of(self._items, *self._ranks(), 0, 1), 0)
        return {**{k: state[k] for k in _PLACE}, "identity": self._identity}

    def load_state_dict(self, state_dict: Mapping[str, Any]) -> None:
        """Lets the next iteration go on where `state_dict` was taken.

        Raises
        ------
        UsageError
            The state is that of another stream: of other options, seed or items, other paths of meshes, or other meshes in memory.
            The content of files is not compared.
        """
        if not isinstance(state_dict, Mapping):
            raise UsageError(f"state_dict: a {type(state_dict).__name__} is no state")
        if state_dict.get("identity") != self._identity:
            raise UsageError("state_dict: it is that of another stream: meshes, options, seed or items differ")
        place = {k: whole(f"state_dict: {k}", state_dict.get(k), 0, _MOST_NUMBER) for k in _PLACE}
        # Each epoch's worker is a copy of this process, so the first that uses the state marks it for all copies.
        used = torch.zeros(1, dtype=torch.int64).share_memory_()
        self._resumed = {**place, "used": used}
        self._shared[_EPOCH] = self._resumed["epoch"]

    def _pending(self) -> dict[str, Any] | None:
        """Returns the state that was loaded, unless a worker has used it."""
        return None if self._resumed is None or int(self._resumed["used"]) else self._resumed

    def _check_share(self, state: Mapping[str, Any], share: Share) -> None:
        if (state["stream"], state["streams"]) != (share.stream, share.streams):
            raise UsageError(f"state_dict: it is that of worker {state['stream']} of {state['streams']} in all ranks, and this is "
                             f"{share.stream} of {share.streams}; use as many processes as before")  # fmt: skip


FractureDataset.__doc__ = documented_text(FractureDataset.__doc__, ACCEPTED)


# --- batches


def collate(items: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Makes a batch of items: arrays become tensors with an axis more, strings lists; arrays of different shapes lists of tensors."""
    _check_items(items)
    return {key: _stacked([item[key] for item in items]) for key in items[0]}


def collate_fragments(items: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Makes a batch of items of the layout ``"fragments"``: all their fragments along the first axis.

    Returns
    -------
    dict
        ``positions`` and ``normals`` (fragments, points, 3), ``neighbor`` (fragments, points), and ``item`` (fragments,): whose
        fragment each is.  The others as `collate` has them.
    """
    _check_items(items)
    joined = {key: torch.from_numpy(np.concatenate([item[key] for item in items])) for key in ("positions", "normals", "neighbor")}
    counts = torch.tensor([item["fragments"] for item in items])
    others = [{key: value for key, value in item.items() if key not in joined} for item in items]
    return {**joined, "item": torch.repeat_interleave(torch.arange(len(items)), counts), **collate(others)}


def _check_items(items: Any) -> None:
    if not isinstance(items, Sequence) or not items or not all(isinstance(item, Mapping) for item in items):
        raise UsageError(f"items: {shown(items)} is no list of items, one or more")


def _stacked(values: list[Any]) -> Any:
    if isinstance(values[0], np.ndarray) and len({value.shape for value in values}) > 1:
        return [torch.from_numpy(value) for value in values]
    return list(values) if isinstance(values[0], str) else default_collate(values)


def _group_ranks() -> tuple[int, int] | None:
    if not (torch.distributed.is_available() and torch.distributed.is_initialized()):
        return None
    return torch.distributed.get_rank(), torch.distributed.get_world_size()
