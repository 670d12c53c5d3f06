"""The order of an endless stream of fractures: which mesh is broken when, by which seed, and in which process.

Everything here is a pure function of the seed, so that a stream can be stopped and resumed, and divided among processes.
"""

from __future__ import annotations

import hashlib
import itertools
from dataclasses import dataclass
from typing import Any, Iterator, NamedTuple

import numpy as np

from ._errors import UsageError
from ._values import shown, whole

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
    first: int = 0
    """of them, in the order of visits"""
    all: int = 0
    """items of an epoch in all streams"""


@dataclass(frozen=True)
class Order:
    """The order of items.

    A *visit* is `repeats` fractures of one mesh.  Numbers are given in the order of a single stream, which goes through `mix` visits at a
    time, a fracture of each in turn.  Several streams do so with visits of their own: of an endless stream they are dealt in turn, as
    cards are; an epoch with an end has the items from 0 on, whatever the number of streams, and each has a range of its visits.  Visits
    go through all meshes, in an order of its own each time: a random one, or theirs from a random mesh on.  So every endless stream
    comes to every mesh, also where their numbers have a common divisor.
    """

    meshes: int
    seed: int
    repeats: int
    mix: int
    shuffle: bool

    def numbers(self, share: Share, position: int = 0) -> Iterator[int]:
        """Yields the numbers of a stream's items from a position on, counted from 0."""
        if share.items is None:
            return (self._dealt(share, at) for at in itertools.count(position))
        return itertools.islice(self._ranged(share.all, share.first, share.first + share.items), position, None)

    def _number(self, visit: int, repeat: int) -> int:
        group, member = divmod(visit, self.mix)
        return (group * self.repeats + repeat) * self.mix + member

    def _visit(self, number: int) -> int:
        row, member = divmod(number, self.mix)
        return row // self.repeats * self.mix + member

    def _dealt(self, share: Share, position: int) -> int:
        group, within = divmod(position, self.mix * self.repeats)
        repeat, member = divmod(within, self.mix)
        return self._number((group * self.mix + member) * share.streams + share.stream, repeat)

    def _ranged(self, all: int, first: int, end: int) -> Iterator[int]:
        """Yields the numbers from `first` to `end` of those below `all`, counted visit by visit."""
        parts = self._parts(all, first, end)
        while group := list(itertools.islice(parts, self.mix)):
            for turn in range(max(len(repeats) for _, repeats in group)):
                yield from (self._number(visit, repeats[turn]) for visit, repeats in group if turn < len(repeats))

    def _parts(self, all: int, first: int, end: int) -> Iterator[tuple[int, range]]:
        """Yields visits, each with the repeats that are in the range."""
        whole = all // (self.mix * self.repeats) * self.mix  # visits, before those that the end cuts off
        each, more = divmod(all - whole * self.repeats, self.mix)

        def begin(visit: int) -> int:
            cut = max(visit - whole, 0)
            return min(visit, whole) * self.repeats + cut * each + min(cut, more)

        for visit in itertools.count(min(first // self.repeats, whole)):
            if begin(visit) >= end:
                return
            repeats = range(max(first - begin(visit), 0), min(end, begin(visit + 1)) - begin(visit))
            if repeats:
                yield visit, repeats

    def item(self, epoch: int, number: int, attempt: int = 0) -> Slot:
        """Returns the fracture that has a number in an epoch.

        Parameters
        ----------
        attempt : int
            How many before could not be used: then another mesh is broken, the same for all fractures of a visit.
        """
        visit = self._visit(number)
        if attempt:
            mesh = hashed("again", self.seed, epoch, visit, attempt) % self.meshes
            return Slot(number, mesh, hashed("item", self.seed, epoch, number, attempt))
        passed, at = divmod(visit, self.meshes)
        mesh = int(self._permutation(epoch, passed)[at]) if self.shuffle else (at + self._first(epoch, passed)) % self.meshes
        return Slot(number, mesh, hashed("item", self.seed, epoch, number))

    def attempts(self, epoch: int, number: int) -> Iterator[Slot]:
        """Yields the fracture that has a number, and others in its place."""
        return (self.item(epoch, number, attempt) for attempt in itertools.count())

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


def given_ranks(rank: int | None, world_size: int | None) -> tuple[int, int] | None:
    """Returns a rank and the number of ranks, None where neither is given."""
    if rank is None and world_size is None:
        return None
    if rank is not None and world_size is not None:
        own, ranks = whole("rank", rank, 0), whole("world_size", world_size, 1)
        if own < ranks:
            return own, ranks
    raise UsageError(f"rank: {shown(rank)} is not one of 0..world_size - 1, and world_size is {shown(world_size)}")


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
    stream, streams = rank * workers + worker, ranks * workers
    if items is None:
        return Share(stream, streams, None)
    own = items_of_rank(items, ranks)
    each, more = divmod(own, workers)
    return Share(stream, streams, each + (worker < more), rank * own + worker * each + min(worker, more), own * ranks)


def hashed(purpose: str, *numbers: int) -> int:
    """Returns a number that looks random: the same for the same arguments."""
    text = " ".join([purpose, *map(str, numbers)])
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "little") >> (64 - _SEED_BITS)


def generator(seed: int) -> np.random.Generator:
    """Returns NumPy's random numbers for a seed."""
    return np.random.Generator(np.random.PCG64(seed))
