"""The parts of a library for training, validation and tests, as ``sherd dataset`` divides one."""

from __future__ import annotations

import hashlib
import os
import re
from typing import Any

from ._errors import InputError, UsageError
from ._library import Mesh
from ._values import shown

SPLITS = ("train", "val", "test")


def ratio_of(splits: Any) -> tuple[int, int, int]:
    """Returns the ratio that a text such as ``"80/10/10"`` is.

    Raises
    ------
    UsageError
        It is none.
    """
    if isinstance(splits, str) and re.fullmatch(r"\d{1,6}/\d{1,6}/\d{1,6}", splits, re.ASCII):
        train, val, test = map(int, splits.split("/"))
        if train + val + test:
            return train, val, test
    raise UsageError(f"splits: {shown(splits)} is not a ratio of three parts, such as '80/10/10'")


def split_of(key: str, ratio: tuple[int, int, int]) -> str:
    """Returns the part that an object of a library falls into, by a hash of its path there (``src/dataset/layouts/split_of.cpp``)."""
    bucket = int(hashlib.sha256(os.fsencode(key)).hexdigest()[:7], 16) % sum(ratio)
    return "train" if bucket < ratio[0] else "val" if bucket < ratio[0] + ratio[1] else "test"


def meshes_of_split(meshes: list[Mesh], split: str, ratio: tuple[int, int, int]) -> list[Mesh]:
    """Returns the meshes of a part.

    Raises
    ------
    InputError
        It has none.
    """
    found = [mesh for mesh in meshes if split_of(mesh.key, ratio) == split]
    if not found:
        raise InputError(f"split: none of {len(meshes)} meshes falls into {split}; give more meshes, or another ratio")
    return found
