# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the outside of a piece lies on the source: which triangle each face is a part of, and where in it each corner is.

A corner that is a corner of its triangle takes that one's values as they are; another one takes numbers interpolated in
the triangle, integers and booleans of the nearest corner.  Polygons of the source that no crack cuts are polygons
again.
"""
import numpy as np


def shares_in(triangle, point):
    """Barycentric coordinates [n, 3] of the points of triangles [n, 3, 3] next to points [n, 3]."""
    a, b, c = triangle[:, 0], triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]
    p = point - a
    bb, bc, cc = (np.einsum("ij,ij->i", x, y) for x, y in ((b, b), (b, c), (c, c)))
    pb, pc = (np.einsum("ij,ij->i", p, x) for x in (b, c))
    area = bb * cc - bc * bc  # of the parallelogram, squared
    with np.errstate(divide="ignore", invalid="ignore"):
        v, w = (cc * pb - bc * pc) / area, (bb * pc - bc * pb) / area
    shares = np.column_stack([1 - v - w, v, w])
    outside = ~(shares >= 0).all(axis=1)  # or without area
    if outside.any():
        shares[outside] = nearest_on_edges(triangle[outside], point[outside])
    return shares


def nearest_on_edges(triangle, point):
    """Barycentric coordinates of the points of the triangles' edges next to points."""
    best, least = np.zeros((len(point), 3)), np.full(len(point), np.inf)
    for k in range(3):
        start, along = triangle[:, k], triangle[:, (k + 1) % 3] - triangle[:, k]
        length = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
        t = np.clip(np.einsum("ij,ij->i", point - start, along) / length, 0, 1)
        distance = np.linalg.norm(start + t[:, None] * along - point, axis=1)
        nearer = distance < least
        least[nearer] = distance[nearer]
        shares = np.zeros((len(point), 3))
        shares[:, k], shares[:, (k + 1) % 3] = 1 - t, t
        best[nearer] = shares[nearer]
    return best


class Places:
    """A piece's polygons and where their corners lie.

    vertex  [corners]    the piece's vertex
    start, total  [polygons]  corners of each polygon
    polygon [polygons]   of the source; -1 inside
    face    [polygons]   a face of the .ply that it is made of
    near    [corners]    the source's loop that is the corner, or the nearest one; -1 inside
    between, loops, shares  corners that are none of the source's: their indices, the loops of their triangles
                         [n, 3], barycentric coordinates [n, 3]
    """

    def __init__(self, source, at, faces, triangle):
        """at [vertices, 3], faces [n, 3], triangle [n]: of the source, or -1"""
        self.source = source
        outer = np.flatnonzero(triangle >= 0)
        inner = np.flatnonzero(triangle < 0)
        faces_of, lies = faces[outer], triangle[outer]
        here, there = at[faces_of], source.at[source.corners[lies]]  # [n, 3, 3], single precision
        same = (here[:, :, None, :] == there[:, None, :, :]).all(axis=3)  # [n, corner, the triangle's corner]
        which = same.argmax(axis=2)
        is_corner = same.any(axis=2)
        whole = is_corner.all(axis=1) & ((which + [0, 2, 1]) % 3 == which[:, :1]).all(axis=1)
        joined, polygons = self.joined_polygons(faces_of, lies, which, whole)

        rest = outer[~joined]
        loops = source.loops[lies]
        near = np.take_along_axis(loops, which, axis=1)
        cut = np.argwhere(~is_corner[~joined])
        row = np.flatnonzero(~joined)[cut[:, 0]]
        self.loops = loops[row]
        self.shares = shares_in(there[row].astype(float), here[row, cut[:, 1]].astype(float))
        near[row, cut[:, 1]] = np.take_along_axis(self.loops, self.shares.argmax(axis=1)[:, None], axis=1)[:, 0]
        self.between = 3 * cut[:, 0] + cut[:, 1]

        corners, loop_of, totals, first = polygons
        self.vertex = np.concatenate([faces[rest].ravel(), corners, faces[inner].ravel()]).astype(np.int32)
        self.near = np.concatenate([near[~joined].ravel(), loop_of, np.full(3 * len(inner), -1, np.int32)])
        self.total = np.concatenate([np.full(len(rest), 3), totals, np.full(len(inner), 3)]).astype(np.int32)
        self.start = (np.cumsum(self.total) - self.total).astype(np.int32)
        self.face = np.concatenate([rest, outer[first], inner])
        self.polygon = np.where(triangle[self.face] >= 0, source.polygon[triangle[self.face]], -1)

    def joined_polygons(self, faces, triangle, which, whole):
        """Which faces are parts of polygons of which the piece has all triangles; and of these polygons: all corners, their
        loops in the source, numbers of corners, one of their faces."""
        source = self.source
        polygon = source.polygon[triangle]
        parts = np.bincount(polygon[whole], minlength=len(source.loop_total))
        is_joined = (source.loop_total > 3) & (parts == source.loop_total - 2)
        loops = np.take_along_axis(source.loops[triangle], which, axis=1)
        vertex_of = np.full(len(source.loop_vertex), -1, np.int32)
        mine = whole & is_joined[polygon]
        vertex_of[loops[mine]] = faces[mine]
        chosen = np.flatnonzero(is_joined)
        total = source.loop_total[chosen]
        offset = np.arange(total.sum()) - np.repeat(np.cumsum(total) - total, total)
        if source.mirrored:
            offset = np.repeat(total, total) - 1 - offset
        loop = np.repeat(source.loop_start[chosen], total) + offset
        corner = vertex_of[loop]
        # Corners at one position are one vertex in the piece: no polygon may pass it twice.
        owner = np.repeat(np.arange(len(chosen)), total)
        order = np.lexsort((corner, owner))
        twice = (owner[order][1:] == owner[order][:-1]) & (corner[order][1:] == corner[order][:-1])
        bad = np.unique(np.concatenate([owner[order][1:][twice], owner[corner < 0]]))
        is_joined[chosen[bad]] = False
        keep = ~np.isin(owner, bad)
        mine = whole & is_joined[polygon]
        first = np.full(len(source.loop_total), -1)
        first[polygon[mine][::-1]] = np.flatnonzero(mine)[::-1]
        chosen = np.flatnonzero(is_joined)
        return mine, (corner[keep], loop[keep].astype(np.int32), source.loop_total[chosen], first[chosen])

    def corner_values(self, values, per_vertex=False, default=0):
        """Values of the corners, from those of the source's loops or vertices."""
        at = self.source.loop_vertex if per_vertex else None
        near, loops = (self.near, self.loops) if at is None else (at[self.near], at[self.loops])
        found = values[near]
        if values.dtype.kind == "f" and len(self.between):
            share = self.shares.reshape(self.shares.shape + (1,) * (values.ndim - 1))
            found[self.between] = (values[loops] * share).sum(axis=1)
        found[self.near < 0] = default
        return found

    def corner_of_vertices(self, count, edges):
        """For each vertex one of its corners outside, and for those inside that of the outer vertex that is the fewest edges
        away; -1 in a piece without outside.  And which vertices lie outside."""
        corner = np.full(count, -1)
        outer = np.flatnonzero(self.near >= 0)[::-1]
        corner[self.vertex[outer]] = outer
        lies_outside = corner >= 0
        while len(edges):
            known = corner[edges] >= 0
            edges, known = edges[~known.all(axis=1)], known[~known.all(axis=1)]
            meets = known.any(axis=1)
            if not meets.any():
                break
            new, old = edges[meets][~known[meets]], edges[meets][known[meets]]
            corner[new[::-1]] = corner[old[::-1]]
        return corner, lies_outside
