"""The order of an endless stream of fractures: which mesh is broken when, by which seed, and in which process.

Everything here is a pure function of the seed, so that a stream can be stopped and resumed, and divided among processes.
"""

from __future__ import annotations

import hashlib
import operator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ._errors import UsageError

_SEED_BITS = 63  # so that a tensor of int64 holds a seed


class Slot(NamedTuple):
    """A fracture of the stream."""

    number: int
    """of the item, in all processes"""
    mesh: int
    seed: int
    """of the fracture, and of all random choices for the item"""


@dataclass(frozen=True)
class Share:
    """A part of the stream: that of one worker of one rank."""

    stream: int
    streams: int
    items: int | None
    """of an epoch, None: endless"""


@dataclass(frozen=True)
class Order:
    """The order of items.

    A *visit* is `repeats` fractures of one mesh.  Visits are dealt to the streams in turn, as cards are; a stream goes through `mix`
    of its visits at a time, a fracture of each in turn.  Visits go through all meshes, in an order of its own each time: a random one,
    or theirs from a random mesh on.  So every stream comes to every mesh, also where their numbers have a common divisor.
    """

    meshes: int
    seed: int
    repeats: int
    mix: int
    shuffle: bool

    def slot(self, epoch: int, share: Share, position: int) -> Slot:
        """Returns the fracture at a position, from 0, in the share of a stream."""
        group, within = divmod(position, self.mix * self.repeats)
        repeat, member = divmod(within, self.mix)
        return self.item(epoch, ((group * self.mix + member) * share.streams + share.stream) * self.repeats + repeat)

    def item(self, epoch: int, number: int) -> Slot:
        """Returns the fracture that has a number in an epoch."""
        passed, at = divmod(number // self.repeats, self.meshes)
        mesh = int(self._permutation(epoch, passed)[at]) if self.shuffle else (at + self._first(epoch, passed)) % self.meshes
        return Slot(number, mesh, hashed("item", self.seed, epoch, number))

    def _first(self, epoch: int, passed: int) -> int:
        # Drawn: by `passed` modulo the meshes, each of 4 streams of 2 meshes has one of them only.
        return hashed("first", self.seed, epoch, passed) % self.meshes if passed else 0

    def _permutation(self, epoch: int, passed: int) -> np.ndarray[Any, Any]:
        kept: dict[tuple[int, int], np.ndarray[Any, Any]] = self.__dict__.setdefault("_permutations", {})
        if (epoch, passed) not in kept:
            while len(kept) > 1:  # visits that are mixed may be of two
                del kept[next(iter(kept))]
            kept[epoch, passed] = generator(hashed("order", self.seed, epoch, passed)).permutation(self.meshes)
        return kept[epoch, passed]


def whole(name: str, value: Any, least: int) -> int:
    """Returns a whole number, or raises `UsageError`."""
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if number < least or isinstance(value, bool):
        raise UsageError(f"{name}: {value!r} is not a whole number from {least} on")
    return number


def given_ranks(rank: int | None, world_size: int | None) -> tuple[int, int] | None:
    """Returns a rank and the number of ranks, None where neither is given."""
    if rank is None and world_size is None:
        return None
    if rank is None or world_size is None or not 0 <= whole("rank", rank, 0) < whole("world_size", world_size, 1):
        raise UsageError(f"rank: {rank!r} is not one of 0..world_size - 1, and world_size is {world_size!r}")
    return rank, world_size


def items_of_rank(items: int, ranks: int) -> int:
    """Returns the items that each rank has in an epoch: all as many, so that none waits for another at its end.

    Raises
    ------
    UsageError
        There are fewer items than ranks.
    """
    if items < ranks:
        raise UsageError(f"items: {items} in all processes are fewer than the {ranks} ranks, and none would have an item")
    return items // ranks


def share_of(items: int | None, rank: int, ranks: int, worker: int, workers: int) -> Share:
    """Returns the share of a worker."""
    own = None if items is None else items_of_rank(items, ranks)
    return Share(rank * workers + worker, ranks * workers, None if own is None else own // workers + (worker < own % workers))


def hashed(purpose: str, *numbers: int) -> int:
    """Returns a number that looks random: the same for the same arguments."""
    text = " ".join([purpose, *map(str, numbers)])
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "little") >> (64 - _SEED_BITS)


def generator(seed: int) -> np.random.Generator:
    """Returns NumPy's random numbers for a seed."""
    return np.random.Generator(np.random.PCG64(seed))
