# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes meshes of Blender from the .ply files of fragments.  The outside gets what the source has, see places.py."""
import bpy
import numpy as np

from .arrays import read, write
from .attributes import OWN, Attribute, add_attribute, add_groups, mark_faces
from .nearest import Nearest
from .places import Places
from .shading import shade

INSIDE_COLOR = (0.745, 0.672, 0.552)  # linear; sRGB 224, 214, 196, as in Sherd's material `inside`
SOURCE_FACE = "source_face"  # the property of faces that --source-faces writes
PLY_TYPES = {"float": "<f4", "double": "<f8", "int": "<i4", "uchar": "u1"}
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


class Piece:
    """A fragment's file; mesh() makes a mesh relative to `origin` of it."""

    def __init__(self, source, path, origin, exact, siblings=None):
        """exact: whether its outside consists of parts of the source's triangles, else it is near them
        siblings: of a piece that was broken again in its fracture, the ids of what became of it"""
        self.source, self.origin = source, origin
        self.names, self.vertex, self.face = read_ply(path)
        self.at = np.column_stack([self.vertex[axis] for axis in "xyz"])
        if not exact or siblings is not None:
            source.nearest = source.nearest or Nearest(source)
        lies = self.face[SOURCE_FACE] if siblings is None else self.lies_on(source, siblings)
        self.places = Places(source, self.at, self.face["vertex_indices"], lies)
        if not exact:
            source.nearest.settle(self.places, self.at, np.repeat(lies[self.places.face], self.places.total))
        self.neighbor = self.face["neighbor"].astype(np.int32)[self.places.face]

    def lies_on(self, source, siblings):
        """The source's triangle of each face, -1 on cracks between siblings: that at the face's middle, all others are of it."""
        middles = self.at[self.face["vertex_indices"]].mean(axis=1)
        lies = np.full(len(middles), -1)
        for face in np.flatnonzero(~np.isin(self.face["neighbor"], siblings)).tolist():
            lies[face] = source.nearest.tree.find_nearest(middles[face])[2]
        return lies

    def mesh(self, name, materials, inside):
        """materials: of the source's slots; inside: of cracks"""
        mesh = bpy.data.meshes.new(name)
        self.build(mesh)
        self.set_materials(mesh, materials, inside)
        edge = shade(mesh, self.places, self.neighbor)
        self.add_uv(mesh)
        self.add_attributes(mesh, edge)
        self.mark(mesh)
        return mesh

    def build(self, mesh):
        places = self.places
        mesh.vertices.add(len(self.at))
        write(mesh.vertices, "co", self.at.astype(float) - self.origin, np.float32)
        mesh.loops.add(len(places.vertex))
        write(mesh.loops, "vertex_index", places.vertex, np.int32)
        mesh.polygons.add(len(places.start))
        write(mesh.polygons, "loop_start", places.start, np.int32)
        if bpy.app.version < (3, 6, 0):
            write(mesh.polygons, "loop_total", places.total, np.int32)
        mesh.update(calc_edges=True)

    def set_materials(self, mesh, materials, inside):
        slots = [*materials]
        if inside not in slots:
            slots.append(inside)
        for each in slots:
            mesh.materials.append(each)
        cracked = slots.index(inside)
        index = np.minimum(self.source.material_index[self.places.polygon], len(materials) - 1)
        index = np.where(self.places.polygon >= 0, index, cracked)
        lid = (self.places.polygon < 0) & (self.neighbor == 0)  # closes a hole: as Sherd says
        if lid.any() and "material" in self.face.dtype.names:
            slot = np.full(max(self.names, default=0) + 1, cracked)
            for number, text in self.names.items():
                if text[:1] == "m" and text[1:].isdigit():
                    slot[number] = min(int(text[1:]), len(materials) - 1)
            index[lid] = slot[self.face["material"][self.places.face[lid]]]
        write(mesh.polygons, "material_index", index, np.int32)

    def box_projected(self, mesh):
        """Texture coordinates of corners: two coordinates in world units, along the axis that a polygon's normal is next
        to."""
        normal = read(mesh.polygons, "normal", np.float32, 3)
        axis = np.repeat(np.abs(normal).argmax(axis=1), self.places.total)
        backwards = np.repeat(np.take_along_axis(normal, np.abs(normal).argmax(axis=1)[:, None], axis=1)[:, 0] < 0,
                              self.places.total)
        at = self.at[self.places.vertex]
        uv = np.choose(axis[:, None], [at[:, [1, 2]], at[:, [2, 0]], at[:, [0, 1]]])
        uv[:, 0] *= np.where(backwards, -1, 1)  # seen from outside no texture is mirrored
        return uv

    def add_uv(self, mesh):
        inside = self.places.near < 0
        projected = self.box_projected(mesh)
        layers = self.source.uv or [Attribute("UVMap", "FLOAT2", "CORNER", np.zeros((len(self.source.loop_vertex), 2),
                                                                                      np.float32))]
        for layer in layers:
            made = mesh.uv_layers.new(name=layer.name, do_init=False)
            values = self.places.corner_values(layer.values)
            values[inside] = projected[inside]
            write(made.data, "uv", values, np.float32)
        for name, choose in ((self.source.uv_active, "active"), (self.source.uv_render, "active_render")):
            if name in mesh.uv_layers:
                setattr(mesh.uv_layers[name], choose, True)

    def add_attributes(self, mesh, source_edge):
        places, source = self.places, self.source
        corner, lies_outside = places.corner_of_vertices(len(self.at), read(mesh.edges, "vertices", np.int32, 2))
        for each in source.attributes:
            if each.name in OWN and each.domain == "FACE":
                continue
            is_color = each.type in ("BYTE_COLOR", "FLOAT_COLOR")
            if each.domain == "CORNER":
                values = places.corner_values(each.values, default=(*INSIDE_COLOR, 1) if is_color else 0)
            elif each.domain == "POINT":
                values = places.corner_values(each.values, per_vertex=True)[corner]
                values[~lies_outside if is_color else corner < 0] = (*INSIDE_COLOR, 1) if is_color else 0
            else:
                of = source_edge if each.domain == "EDGE" else places.polygon
                values = each.values[of]
                values[of < 0] = 0
            add_attribute(mesh, each, values)
        colors = mesh.color_attributes
        if source.color_active in colors:
            colors.active_color = colors[source.color_active]
        if source.color_render in colors and hasattr(colors, "render_color_index"):
            colors.render_color_index = colors.find(source.color_render)
        self.corner_of_vertex = corner

    def mark(self, mesh):
        """Face attributes.  Cracks of a piece that is broken again stay inside, and of their level; see also levels.mark()."""
        old = {a.name: a.values for a in self.source.attributes if a.domain == "FACE" and a.name in OWN}
        of, outside = self.places.polygon, self.places.polygon >= 0
        inside, level = self.neighbor > 0, np.zeros(len(of), np.int32)
        if "inside" in old:
            inside = inside | (outside & old["inside"][of].astype(bool))
        if "level" in old:
            level = np.where(outside, old["level"][of], 0)
        mark_faces(mesh, neighbor=self.neighbor, inside=inside, level=level)

    def add_groups(self, thing):
        names, weights = self.source.groups
        if not names:
            return
        absent = weights < 0
        values = self.places.corner_values(np.where(absent, 0, weights), per_vertex=True)[self.corner_of_vertex]
        member = self.places.corner_values((~absent).astype(np.float32), per_vertex=True)[self.corner_of_vertex] > 0
        values[~member | (self.corner_of_vertex < 0)[:, None]] = -1
        add_groups(thing, names, values)
