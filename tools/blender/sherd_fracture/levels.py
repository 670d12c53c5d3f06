# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of cracks of sequential growth: levels of pieces and faces, and nested collections."""
import bpy
import numpy as np

from .arrays import read
from .attributes import mark_faces
from .scene import limited


class Splits:
    """The tree of splits of a manifest; of other growths a single level."""

    def __init__(self, manifest):
        self.splits = {split["id"]: split for split in manifest.get("splits", [])}
        self.of_fragment = {entry["id"]: entry.get("split", 0) for entry in manifest["fragments"]}

    def chain(self, fragment):
        """The splits that made a fragment, the last one first."""
        at, found = self.of_fragment.get(fragment, 0), []
        while at in self.splits:
            found.append(at)
            at = self.splits[at]["parent"]
        return found

    def level(self, fragment):
        """How many splits made a fragment; 1 where there are no splits."""
        return len(self.chain(fragment)) if self.splits else 1

    def crack(self, one, other):
        """The level of the split between two fragments; 1 where there are no splits."""
        earlier = set(self.chain(other))
        common = next((split for split in self.chain(one) if split in earlier), None)
        return self.splits[common]["level"] if common else 1


def mark(piece, splits, above, siblings=None):
    """Properties of a piece, and the face attributes piece and level, which old cracks keep.  `above`: the level of what was
    broken.  `siblings`: ids of the pieces that cracks are new between, where there are others."""
    fragment, mesh = piece["sherd_fragment"], piece.data
    piece["sherd_level"] = above + splits.level(fragment)
    piece["sherd_parent"] = splits.of_fragment.get(fragment, 0)
    neighbor, old = (read(mesh.attributes[name].data, "value", np.int32) for name in ("neighbor", "level"))
    others, which = np.unique(neighbor, return_inverse=True)
    levels = np.array([above + splits.crack(fragment, int(other)) if other else 0 for other in others], np.int32)
    is_new = neighbor > 0 if siblings is None else np.isin(neighbor, siblings)
    mark_faces(mesh, piece=fragment, level=np.where(is_new, levels[which.ravel()], old))


def nest(collection, pieces, splits, shown):
    """Moves pieces into a collection for each piece of an earlier level that was split further, nested `shown` deep."""
    roots = [split for split in splits.splits.values() if not split["parent"]]
    made = {}
    for piece in pieces:
        chain = splits.chain(piece["sherd_fragment"])[::-1]
        if len(roots) < 2:
            chain = chain[1:]  # the first split is that of the whole object
        home = collection
        for split in chain[:shown]:
            if split not in made:
                made[split] = bpy.data.collections.new(limited(collection.name, 12) + f" split {split}")
                made[split]["sherd_level"] = splits.splits[split]["level"]
                home.children.link(made[split])
            home = made[split]
        if home is not collection:
            collection.objects.unlink(piece)
            home.objects.link(piece)
