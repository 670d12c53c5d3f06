# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the corners of a smooth surface, which is only near the source, lie on the source.

A face's triangle is the one nearest to its middle, and a face may be larger than triangles.  So each corner takes the point
nearest to it that is of the same chart: of the polygons that are connected without a seam of texture coordinates.
"""
import numpy as np
from mathutils.bvhtree import BVHTree

from .places import shares_in


class Nearest:
    """Search in a source.  chart [polygons]"""

    def __init__(self, source):
        self.source = source
        self.tree = BVHTree.FromPolygons(source.at.tolist(), source.corners.tolist(), all_triangles=True)
        self.chart = charts(source)
        a, b, c = (source.at[source.corners[:, k]] for k in range(3))
        self.normal = np.cross(b - a, c - a)

    def settle(self, places, at, triangle):
        """Moves the corners outside to their nearest points.  triangle [corners]: of their faces, or -1."""
        source = self.source
        corner = np.flatnonzero(triangle >= 0)
        vertex, own = places.vertex[corner], triangle[corner]
        found = np.full(len(at), -1)
        for each in np.unique(vertex).tolist():
            found[each] = self.tree.find_nearest(at[each])[2]
        nearest = found[vertex]
        for each in np.flatnonzero(~self.fits(nearest, own)).tolist():
            nearest[each] = self.other(at[vertex[each]], own[each])
        places.between, places.loops = corner, source.loops[nearest]
        places.shares = shares_in(source.at[source.corners[nearest]].astype(float), at[vertex].astype(float))
        places.near[corner] = np.take_along_axis(places.loops, places.shares.argmax(axis=1)[:, None], axis=1)[:, 0]

    def fits(self, triangle, own):
        """Whether triangles are of the chart, and of the side of a wall, of others."""
        polygon = self.source.polygon
        same_side = np.einsum("ij,ij->i", self.normal[triangle], self.normal[own]) >= 0
        return (self.chart[polygon[triangle]] == self.chart[polygon[own]]) & same_side

    def other(self, point, own):
        """The nearest triangle that fits; the face's own, at the latest."""
        corners = self.source.at[self.source.corners[own]].astype(float)
        reach = np.linalg.norm(shares_in(corners[None], point[None].astype(float))[0] @ corners - point)
        near = self.tree.find_nearest_range(point, reach * (1 + 1e-6))
        if not near:
            return own
        triangle, distance = np.array([n[2] for n in near]), np.array([n[3] for n in near])
        fits = self.fits(triangle, np.full(len(triangle), own))
        return triangle[fits][distance[fits].argmin()] if fits.any() else own


def charts(source):
    """A number for each polygon, equal where they are connected over edges at which all texture coordinates agree."""
    count = len(source.loop_total)
    one, other = source.edge_loops.T
    after = next_loops(source)
    forth = source.loop_vertex[one] == source.loop_vertex[other]  # both polygons run along the edge in one direction
    ends = (np.where(forth, other, after[other]), np.where(forth, after[other], other))
    agree = np.ones(len(one), bool)
    for layer in source.uv:
        for mine, theirs in zip((one, after[one]), ends):
            agree &= np.abs(layer.values[mine] - layer.values[theirs]).max(axis=1, initial=0) <= 1e-6
    polygon = np.repeat(np.arange(count), source.loop_total)
    return components(count, polygon[one[agree]], polygon[other[agree]])


def next_loops(source):
    after = np.arange(1, len(source.loop_vertex) + 1)
    after[source.loop_start + source.loop_total - 1] = source.loop_start
    return after


def components(count, one, other):
    """The least index that each of `count` things is connected with, by pairs."""
    label = np.arange(count)
    while True:
        least = np.minimum(label[one], label[other])
        before = label.copy()
        np.minimum.at(label, label[one], least)
        np.minimum.at(label, label[other], least)
        label = label[label]
        if (label == before).all():
            return label
