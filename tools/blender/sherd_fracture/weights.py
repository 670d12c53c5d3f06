# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The weight that the user paints where pieces are to be small."""
import numpy as np

from .failure import Failure

LEAST = 0.05  # of the pieces per volume where the weight is 1: those where it is 0


def density_of(thing, mesh, name):
    """Pieces per volume, relative, of each vertex of the evaluated mesh by a vertex group; None without a name."""
    if not name:
        return None
    group = thing.vertex_groups.get(name)
    if group is None:
        raise Failure(f"{thing.name} has no vertex group '{name}', by which small pieces were asked for")
    weights = np.zeros(len(mesh.vertices), np.float32)
    for at, vertex in enumerate(mesh.vertices):
        for entry in vertex.groups:
            if entry.group == group.index:
                weights[at] = entry.weight
    if not weights.any():
        raise Failure(f"vertex group '{name}' of {thing.name} has no weight; paint some where pieces are to be small")
    return LEAST + (1 - LEAST) * weights
