"""Items of a stream of fractures as volumes of voxels: the labels of all fragments, and objects with a fragment missing."""

from __future__ import annotations

from typing import Any, Callable, NamedTuple

import numpy as np

from ._errors import InputError
from ._fracture import Fracture

Array = np.ndarray[Any, Any]
Item = dict[str, Any]

_ERODED = 65535


class Volume(NamedTuple):
    """The voxels of a fracture in a cube, the object in its middle."""

    labels: Array
    """(n, n, n) int32, the fragment's id of each voxel, 0 where there is none"""
    fragments: int
    origin: Array
    """(3,) float64, world position of the center of voxel (0, 0, 0)"""
    voxel_size: float
    name: str
    number: int
    mesh: int
    seed: int
    random: np.random.Generator


class VoxelLayout(NamedTuple):
    """What is made of a volume."""

    make: Callable[[Volume], Item]
    fragments: int = 0
    """most fragments; 0: any number"""


def volume_of(f: Fracture, side: int, **named: Any) -> Volume:
    """Returns the voxels of a fracture in a cube.

    Parameters
    ----------
    side : int
        Of the cube, in voxels; the next multiple of 8 that holds the object, if that is more.
    **named
        The other members of the volume.
    """
    labels = f.labels
    side = -8 * (-max(side, *labels.shape) // 8)
    cube = np.zeros((side, side, side), np.int32)
    low = (side - np.array(labels.shape)) // 2
    cube[tuple(slice(a, a + n) for a, n in zip(low, labels.shape))] = np.where(labels == _ERODED, 0, labels)
    return Volume(cube, len(f), np.asarray(f.origin) - low * f.voxel_size, f.voxel_size, **named)


def _own(volume: Volume) -> Item:
    return {"name": volume.name, "index": volume.number, "mesh": volume.mesh, "seed": volume.seed, "origin": volume.origin,
            "voxel_size": volume.voxel_size}  # fmt: skip


def voxels_item(volume: Volume) -> Item:
    return {"labels": volume.labels, "fragments": volume.fragments, **_own(volume)}


def completion_item(volume: Volume) -> Item:
    """Takes one fragment away: any but the largest, each as likely."""
    sizes = np.bincount(volume.labels.ravel(), minlength=volume.fragments + 1)
    sizes[0] = 0
    present = np.flatnonzero(sizes)
    if len(present) < 2:
        raise InputError("completion: a fracture in one fragment has none that could be missing")
    missing = int(volume.random.choice(present[present != np.argmax(sizes)]))
    whole, away = volume.labels != 0, volume.labels == missing
    return {"kept": (whole & ~away).astype(np.uint8), "missing": away.astype(np.uint8), "whole": whole.astype(np.uint8), "fragment": missing,
            "fragments": volume.fragments, **_own(volume)}  # fmt: skip


VOXEL_LAYOUTS = {"voxels": VoxelLayout(voxels_item), "completion": VoxelLayout(completion_item)}
