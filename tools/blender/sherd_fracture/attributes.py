# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of meshes and vertex groups: read as arrays, and written."""
import dataclasses

import numpy as np

from .arrays import read, write

KINDS = {"FLOAT": ("value", 1, np.float32), "INT": ("value", 1, np.int32), "BOOLEAN": ("value", 1, bool),
         "FLOAT_VECTOR": ("vector", 3, np.float32), "FLOAT2": ("vector", 2, np.float32),
         "FLOAT_COLOR": ("color", 4, np.float32), "BYTE_COLOR": ("color", 4, np.float32), "INT8": ("value", 1, np.int32),
         "INT16_2D": ("value", 2, np.int32), "INT32_2D": ("value", 2, np.int32), "QUATERNION": ("value", 4, np.float32),
         "FLOAT4X4": ("value", 16, np.float32)}
# What Blender makes of the mesh, or what is written by other means.
BUILT_IN = {"position", "material_index", "sharp_face", "sharp_edge", "uv_seam", "custom_normal"}
OWN = ("neighbor", "inside", "piece", "level")  # of the add-on


@dataclasses.dataclass
class Attribute:
    name: str
    type: str
    domain: str
    values: np.ndarray


def attributes_of(mesh):
    """All but texture coordinates, in the mesh's order."""
    skipped = BUILT_IN | {u.name for u in mesh.uv_layers}
    found = []
    for each in mesh.attributes:
        if each.name in skipped or each.name.startswith(".") or each.data_type not in KINDS:
            continue
        name, columns, dtype = KINDS[each.data_type]
        found.append(Attribute(each.name, each.data_type, each.domain, read(each.data, name, dtype, columns)))
    return found


def add_attribute(mesh, attribute, values):
    """Writes an attribute like another one; one of this name is replaced."""
    old = mesh.attributes.get(attribute.name)
    if old is not None:
        mesh.attributes.remove(old)
    made = mesh.attributes.new(attribute.name, attribute.type, attribute.domain)
    name, _, dtype = KINDS[attribute.type]
    write(made.data, name, values, dtype)


def mark_faces(mesh, **marks):
    """Face attributes for Geometry Nodes: `neighbor` (int), `inside` (bool), `piece` (int), `level` (int); each an array or
    one value for all faces."""
    for name, values in marks.items():
        kind = "BOOLEAN" if name == "inside" else "INT"
        values = np.broadcast_to(np.asarray(values), len(mesh.polygons))
        add_attribute(mesh, Attribute(name, kind, "FACE", values), values)


def groups_of(thing, mesh):
    """Names of vertex groups, and weights [vertices, groups]; -1 where a vertex is not in the group."""
    names = [group.name for group in thing.vertex_groups]
    weights = np.full((len(mesh.vertices), len(names)), -1, np.float32)
    if names:
        members = [(vertex.index, member.group, member.weight) for vertex in mesh.vertices for member in vertex.groups]
        if members:
            vertex, group, weight = (np.array(column) for column in zip(*members))
            known = group < len(names)
            weights[vertex[known], group[known]] = weight[known]
    return names, weights


def add_groups(thing, names, weights):
    """Gives an object vertex groups; `weights` as of groups_of()."""
    for name, column in zip(names, weights.T):
        group = thing.vertex_groups.new(name=name)
        vertices = np.flatnonzero(column >= 0)
        different, which = np.unique(column[vertices], return_inverse=True)
        ordered = vertices[np.argsort(which, kind="stable")]
        for weight, part in zip(different.tolist(), np.split(ordered, np.cumsum(np.bincount(which))[:-1])):
            group.add(part.tolist(), weight, "REPLACE")
