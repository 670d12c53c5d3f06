# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads an evaluated mesh of Blender into arrays, and writes its triangles as one .ply for Sherd."""
import bpy
import numpy as np

from .arrays import read
from .attributes import Attribute, attributes_of, groups_of

DENSITY = "sherd_density"  # a property of vertices: pieces per volume, relative


class Source:
    """A mesh as it is broken: in world space, triangle i being face i of the .ply.  Pieces take from here what their
    outside has."""

    def __init__(self, thing, mesh, world):
        world = np.array(world, float)
        self.mirrored = np.linalg.det(world[:3, :3]) < 0
        positions = read(mesh.vertices, "co", np.float32, 3).astype(float) @ world[:3, :3].T + world[:3, 3]
        self.at = positions.astype(np.float32)
        self.read_polygons(mesh)
        self.read_triangles(mesh)
        self.read_edges(mesh)
        self.read_attributes(thing, mesh)
        self.normals = self.read_normals(mesh, world[:3, :3])
        self.nearest = None  # made where a smooth surface needs it

    def read_polygons(self, mesh):
        polygons = mesh.polygons
        self.loop_start = read(polygons, "loop_start", np.int32)
        self.loop_total = read(polygons, "loop_total", np.int32)
        self.smooth = read(polygons, "use_smooth", bool)
        self.material_index = read(polygons, "material_index", np.int32)
        self.loop_vertex = read(mesh.loops, "vertex_index", np.int32)

    def read_triangles(self, mesh):
        mesh.calc_loop_triangles()
        self.loops = read(mesh.loop_triangles, "loops", np.int32, 3)
        self.polygon = read(mesh.loop_triangles, "polygon_index", np.int32)
        if self.mirrored:
            self.loops = self.loops[:, ::-1].copy()  # orientation is reversed
        self.corners = self.loop_vertex[self.loops]

    def read_edges(self, mesh):
        """Edges between two polygons, ordered by `edge_key`, which is made of the polygons' indices."""
        sharp, seam = read(mesh.edges, "use_edge_sharp", bool), read(mesh.edges, "use_seam", bool)
        edge = read(mesh.loops, "edge_index", np.int32)
        loop = np.argsort(edge, kind="stable")
        pair = np.flatnonzero(np.diff(edge[loop]) == 0)
        self.edge_loops = np.column_stack([loop[pair], loop[pair + 1]])
        polygon = np.repeat(np.arange(len(self.loop_total)), self.loop_total)[self.edge_loops]
        key = self.key_of(*polygon.T)
        order = np.argsort(key, kind="stable")
        self.edge_key, self.edge = key[order], edge[self.edge_loops[order, 0]]
        self.sharp, self.seam = sharp, seam

    def key_of(self, one, other):
        return np.minimum(one, other).astype(np.int64) * len(self.loop_total) + np.maximum(one, other)

    def edges_between(self, one, other):
        """Edges between pairs of polygons; -1 where there is none."""
        if not len(self.edge):
            return np.full(len(one), -1)
        key = self.key_of(one, other)
        at = np.minimum(np.searchsorted(self.edge_key, key), len(self.edge) - 1)
        return np.where((self.edge_key[at] == key) & (one >= 0) & (other >= 0) & (one != other), self.edge[at], -1)

    def read_attributes(self, thing, mesh):
        layers = mesh.uv_layers
        self.uv = [Attribute(u.name, "FLOAT2", "CORNER", read(u.data, "uv", np.float32, 2)) for u in layers]
        self.uv_active = layers.active.name if layers.active else ""
        self.uv_render = next((u.name for u in layers if u.active_render), self.uv_active)
        self.attributes = attributes_of(mesh)
        colors = mesh.color_attributes
        self.color_active = colors.active_color.name if colors.active_color else ""
        drawn = getattr(colors, "render_color_index", -1)
        self.color_render = colors[drawn].name if 0 <= drawn < len(colors) else self.color_active
        self.groups = groups_of(thing, mesh)

    def read_normals(self, mesh, world):
        """Normals of corners in the object's space, in which they are interpolated, and the matrix for rows that takes them to
        the world's; None where all faces are flat."""
        if not self.smooth.any() and not mesh.has_custom_normals:
            return None
        if bpy.app.version < (4, 1, 0):
            mesh.calc_normals_split()
            normals = read(mesh.loops, "normal", np.float32, 3)
        else:
            normals = read(mesh.corner_normals, "vector", np.float32, 3)
        try:
            return normals, np.linalg.inv(world)
        except np.linalg.LinAlgError:
            return None  # flattened

    def colors(self):
        """Bytes [vertices, 3] of the active colors, those of corners averaged; None without any."""
        found = next((a for a in self.attributes if a.name == self.color_active), None)
        if found is None or found.domain not in ("POINT", "CORNER"):
            return None
        colors = found.values[:, :3].astype(float)
        if found.domain == "CORNER":
            uses = np.maximum(np.bincount(self.loop_vertex, minlength=len(self.at)), 1)
            colors = np.column_stack([np.bincount(self.loop_vertex, c, len(self.at)) for c in colors.T]) / uses[:, None]
        colors = np.clip(colors, 0, 1)
        colors = np.where(colors <= 0.0031308, 12.92 * colors, 1.055 * colors ** (1 / 2.4) - 0.055)
        return np.rint(255 * colors).astype(np.uint8)

    def write_ply(self, path, density=None):
        """Writes the triangles with what Sherd uses of it: texture coordinates, colors, the index of the material, and numbers
        of its vertices as DENSITY."""
        used, corners = np.unique(self.corners, return_inverse=True)  # loose vertices would enlarge the grid
        count, material = len(self.corners), np.maximum(self.material_index, 0)[self.polygon]
        colors, uv = self.colors(), next((u.values for u in self.uv if u.name == self.uv_render), None)
        head = ["ply", "format binary_little_endian 1.0"]
        head += [f"comment material {i} m{i}" for i in range(material.max() + 1)]
        head += [f"element vertex {len(used)}", *(f"property float {axis}" for axis in "xyz")]
        fields = [("at", "<f4", 3)]
        if colors is not None:
            head += [f"property uchar {channel}" for channel in ("red", "green", "blue")]
            fields.append(("color", "u1", 3))
        if density is not None:
            head.append(f"property float {DENSITY}")
            fields.append((DENSITY, "<f4"))
        vertices = np.empty(len(used), fields)
        vertices["at"] = self.at[used]
        if density is not None:
            vertices[DENSITY] = density[used]
        if colors is not None:
            vertices["color"] = colors[used]
        head += [f"element face {count}", "property list uchar int vertex_indices"]
        fields = [("three", "u1"), ("corners", "<i4", 3)]
        if uv is not None:
            head.append("property list uchar float texcoord")
            fields += [("six", "u1"), ("texcoord", "<f4", 6)]
        head += ["property int material", "end_header"]
        faces = np.empty(count, fields + [("material", "<i4")])
        faces["three"], faces["corners"], faces["material"] = 3, corners.reshape(-1, 3), material
        if uv is not None:
            faces["six"], faces["texcoord"] = 6, uv[self.loops].reshape(-1, 6)
        with open(path, "wb") as file:
            file.write(("\n".join(head) + "\n").encode() + vertices.tobytes() + faces.tobytes())
