# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shading of pieces: the outside as it was, cracks smooth, sharp edges where they begin and bend."""
import math

import bpy
import numpy as np

from .arrays import read, unit, write

SMOOTH_BELOW = math.radians(40)


def sides_of_edges(mesh):
    """Edges that are used by exactly two corners, and the polygons of these."""
    edge = read(mesh.loops, "edge_index", np.int32)
    polygon = np.repeat(np.arange(len(mesh.polygons)), read(mesh.polygons, "loop_total", np.int32))
    order = np.argsort(edge, kind="stable")
    edge, polygon = edge[order], polygon[order]
    first = np.flatnonzero(np.diff(edge, prepend=-1))
    first = first[np.diff(first, append=len(edge)) == 2]
    return edge[first], polygon[first], polygon[first + 1]


def shade(mesh, places, neighbor):
    """Sharp edges, seams, flat faces and normals of a piece.  neighbor [polygons].  Returns the source's edge of each edge
    of the piece, or -1."""
    source, outside = places.source, places.polygon >= 0
    write(mesh.polygons, "use_smooth", np.where(outside, source.smooth[places.polygon], True), bool)
    edge, one, other = sides_of_edges(mesh)
    source_edge = np.full(len(mesh.edges), -1)
    source_edge[edge] = source.edges_between(places.polygon[one], places.polygon[other])
    kept = source_edge[edge]
    normal = read(mesh.polygons, "normal", np.float32, 3)
    bent = np.einsum("ij,ij->i", normal[one], normal[other]) < math.cos(SMOOTH_BELOW)
    sharp, seam = np.zeros(len(mesh.edges), bool), np.zeros(len(mesh.edges), bool)
    within = ~outside[one] & ~outside[other]
    sharp[edge] = (outside[one] != outside[other]) | (within & ((neighbor[one] != neighbor[other]) | bent))
    if len(source.sharp):
        sharp[edge] |= (kept >= 0) & source.sharp[kept]
        seam[edge] = (kept >= 0) & source.seam[kept]
    write(mesh.edges, "use_edge_sharp", sharp, bool)
    if seam.any():
        write(mesh.edges, "use_seam", seam, bool)
    if bpy.app.version < (4, 1, 0):
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, math.pi  # by sharp edges alone
    if source.normals is not None:
        normals, to_world = source.normals
        normals = unit(places.corner_values(normals).astype(float) @ to_world) * (places.near >= 0)[:, None]  # zero: as Blender computes it
        mesh.normals_split_custom_set(normals.astype(np.float32))
    return source_edge
