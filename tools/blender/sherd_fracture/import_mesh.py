# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes meshes of Blender from the .ply files of fragments.  Materials stay in Blender: faces get the object's."""
import math

import bpy
import numpy as np

INSIDE_COLOR = (0.745, 0.672, 0.552)  # sRGB 224, 214, 196, as in Sherd's material `inside`
SMOOTH_BELOW = math.radians(40)
PLY_TYPES = {"float": "<f4", "int": "<i4", "uchar": "u1"}
PLY_LISTS = {"vertex_indices": 3, "texcoord": 6}


def read_ply(path):
    """Names of materials by number, and the vertices and faces of a binary .ply that Sherd wrote (docs/formats.md)."""
    with open(path, "rb") as file:
        head, body = file.read().split(b"end_header\n", 1)
    names, elements, at = {}, [], 0
    for line in head.decode().splitlines():
        words = line.split()
        if words[:2] == ["comment", "material"]:
            names[int(words[2])] = words[3]
        elif words[0] == "element":
            elements.append((int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][1].extend([("n_" + words[4], PLY_TYPES[words[2]]),
                                    (words[4], PLY_TYPES[words[3]], PLY_LISTS[words[4]])])
        elif words[0] == "property":
            elements[-1][1].append((words[2], PLY_TYPES[words[1]]))
    arrays = []
    for count, fields in elements:
        arrays.append(np.frombuffer(body, fields, count, at))
        at += arrays[-1].nbytes
    return names, arrays[0], arrays[1]


def material(name, color):
    """Returns the material of this name; creates it if absent."""
    found = bpy.data.materials.get(name)
    if found is None:
        found = bpy.data.materials.new(name)
        found.diffuse_color = (*color, 1)
        found.use_nodes = True
        shader = found.node_tree.nodes.get("Principled BSDF")
        if shader:
            shader.inputs["Base Color"].default_value = (*color, 1)
            shader.inputs["Roughness"].default_value = 0.8
    return found


def shade_smooth(mesh, neighbor):
    """Smooth shading with sharp contact boundaries."""
    mesh.polygons.foreach_set("use_smooth", np.ones(len(neighbor), bool))
    if bpy.app.version < (4, 1, 0):
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = SMOOTH_BELOW
    else:
        mesh.set_sharp_from_angle(angle=SMOOTH_BELOW)
    edge = np.empty(3 * len(neighbor), np.int32)
    mesh.loops.foreach_get("edge_index", edge)
    low, high = np.full(len(mesh.edges), 2**31 - 1), np.full(len(mesh.edges), -1)
    np.minimum.at(low, edge, np.repeat(neighbor, 3))
    np.maximum.at(high, edge, np.repeat(neighbor, 3))
    sharp = np.empty(len(mesh.edges), bool)
    mesh.edges.foreach_get("use_edge_sharp", sharp)
    mesh.edges.foreach_set("use_edge_sharp", sharp | (low != high))


def read_mesh(path, name, origin, materials, inside, uv_name, color_name):
    """A fragment's mesh relative to `origin`.  A face has material m<i> or the inner one; `neighbor` is a face attribute."""
    names, vertex, face = read_ply(path)
    mesh = bpy.data.meshes.new(name)
    count = len(face)
    at = np.column_stack([vertex[axis] for axis in "xyz"]).astype(float) - origin
    mesh.vertices.add(len(vertex))
    mesh.vertices.foreach_set("co", at.astype(np.float32).ravel())
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", face["vertex_indices"].astype(np.int32).ravel())
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    if bpy.app.version < (3, 6, 0):
        mesh.polygons.foreach_set("loop_total", np.full(count, 3, np.int32))
    slots = [*materials]
    if inside not in slots:
        slots.append(inside)
    for each in slots:
        mesh.materials.append(each)
    neighbor = face["neighbor"].astype(np.int32)
    slot_of = {n: int(text[1:]) for n, text in names.items() if text[:1] == "m" and text[1:].isdigit()}
    slot = np.full(max(names, default=0) + 1, slots.index(inside), np.int32)
    for number, index in slot_of.items():
        slot[number] = min(index, len(materials) - 1)
    index = slot[face["material"]] if "material" in face.dtype.names else np.where(neighbor, slots.index(inside), 0)
    mesh.polygons.foreach_set("material_index", index.astype(np.int32))
    mesh.update(calc_edges=True)
    if uv_name is not None and "texcoord" in face.dtype.names:
        layer = mesh.uv_layers.new(name=uv_name)
        layer.data.foreach_set("uv", face["texcoord"].astype(np.float32).ravel())
    if color_name is not None and "red" in vertex.dtype.names:
        layer = mesh.color_attributes.new(color_name, "BYTE_COLOR", "POINT")
        colors = np.column_stack([*(vertex[c] / 255 for c in ("red", "green", "blue")), np.ones(len(vertex))])
        layer.data.foreach_set("color_srgb", colors.astype(np.float32).ravel())
        mesh.color_attributes.active_color = layer
    mesh.attributes.new("neighbor", "INT", "FACE").data.foreach_set("value", neighbor)
    shade_smooth(mesh, neighbor)
    return mesh
