# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a mesh of Blender as one .ply with the attributes that Sherd transfers: texture coordinates, colors, and the
index of the material per face."""
import numpy as np

DENSITY = "sherd_density"  # a property of vertices: pieces per volume, relative

def colors_of(mesh):
    """Name and bytes [vertices, 3] of the active colors, those of corners averaged; None, None without any."""
    layer = mesh.color_attributes.active_color
    if layer is None or layer.domain not in ("POINT", "CORNER"):
        return None, None
    colors = np.empty((len(layer.data), 4), np.float32)
    layer.data.foreach_get("color_srgb", colors.ravel())
    colors = colors[:, :3].astype(float)
    if layer.domain == "CORNER":
        at = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", at)
        uses = np.maximum(np.bincount(at, minlength=len(mesh.vertices)), 1)
        sums = [np.bincount(at, colors[:, k], len(mesh.vertices)) for k in range(3)]
        colors = np.column_stack(sums) / uses[:, None]
    return layer.name, np.rint(255 * np.clip(colors, 0, 1)).astype(np.uint8)


def write_ply(path, mesh, world, density=None):
    """Write a mesh's triangles in world space, and numbers of its vertices as DENSITY.  Returns the names of its texture coordinates and colors, or None."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    corners, loops = np.empty((count, 3), np.int32), np.empty((count, 3), np.int32)
    material = np.empty(count, np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners.ravel())
    mesh.loop_triangles.foreach_get("loops", loops.ravel())
    mesh.loop_triangles.foreach_get("material_index", material)
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", positions.ravel())
    world = np.array(world, float)
    positions = positions.astype(float) @ world[:3, :3].T + world[:3, 3]
    if np.linalg.det(world[:3, :3]) < 0:  # mirrored: orientation is reversed
        corners, loops = corners[:, ::-1], loops[:, ::-1]
    used, corners = np.unique(corners, return_inverse=True)  # loose vertices would enlarge the grid
    corners = corners.reshape(-1, 3)

    layer = next((u for u in mesh.uv_layers if u.active_render), mesh.uv_layers.active)
    color_name, colors = colors_of(mesh)
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
    if density is not None:
        vertices[DENSITY] = density[used]
    vertices["at"] = positions[used]
    if colors is not None:
        vertices["color"] = colors[used]
    head += [f"element face {count}", "property list uchar int vertex_indices"]
    fields = [("three", "u1"), ("corners", "<i4", 3)]
    if layer:
        head.append("property list uchar float texcoord")
        fields += [("six", "u1"), ("texcoord", "<f4", 6)]
    head += ["property int material", "end_header"]
    faces = np.empty(count, fields + [("material", "<i4")])
    faces["three"], faces["corners"], faces["material"] = 3, corners, material
    if layer:
        uv = np.empty((len(mesh.loops), 2), np.float32)
        layer.data.foreach_get("uv", uv.ravel())
        faces["six"], faces["texcoord"] = 6, uv[loops].reshape(-1, 6)
    with open(path, "wb") as file:
        file.write(("\n".join(head) + "\n").encode() + vertices.tobytes() + faces.tobytes())
    return layer.name if layer else None, color_name
