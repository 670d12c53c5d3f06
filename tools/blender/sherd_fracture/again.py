# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces that are broken again in the folder of their fracture, by `sherd fracture FOLDER --only`: the folder stays the
fracture that the scene shows.  A piece has to be as its file is; where it was moved to does not matter."""
import json
import os

import bpy
import numpy as np
from mathutils import Matrix, Vector

from .arrays import read, write
from .import_mesh import read_ply

RIGID = 1e-4  # by which a matrix may scale


def manifest_in(folder):
    """The manifest of a folder, or None."""
    try:
        with open(os.path.join(folder, "manifest.json"), encoding="utf-8") as file:
            found = json.load(file)
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) and isinstance(found.get("fragments"), list) else None


def folder_of(thing):
    """The folder of the fracture that an object is a piece of, or None."""
    if "sherd_folder" not in thing or "sherd_fragment" not in thing:
        return None
    return os.path.realpath(bpy.path.abspath(thing["sherd_folder"]))


def home_of(thing, folder):
    """The folder of the fracture that an object is a piece of, if it is `folder` or in it; None of other objects."""
    home = folder_of(thing) if folder else None
    if home is None:
        return None
    return home if os.path.realpath(bpy.path.abspath(folder)) in (home, os.path.dirname(home)) else None


class Finished:
    """A piece and its file.

    folder, fragment   where it is, and its id
    at [vertices, 3]   its vertices in the fracture's space, of which the object's are rounded
    rest, moved        matrices: of the object as it was made, and from there to where it is
    """

    def __init__(self, folder, fragment, at, rest, world):
        self.folder, self.fragment, self.at, self.rest = folder, fragment, at, rest
        self.moved = world @ rest.inverted()

    def fracture_place(self, position):
        """A place of the world in the fracture's space."""
        return tuple(self.moved.inverted() @ Vector(position))


def origin_of(entry):
    """Where the object of a fragment of a manifest has its origin: its center of mass, rounded as in Blender."""
    return np.array(entry["centroid"], np.float32).astype(float)


def mesh_file(entry, folder):
    """The .ply mesh of a fragment of a manifest, which may have other formats too."""
    files = entry["files"]["mesh"]
    return os.path.join(folder, next(name for name in ([files] if isinstance(files, str) else files) if name.endswith(".ply")))


def read_file(entry, folder):
    """Vertices, faces and the center of mass of a fragment's file, or None if it has none that can be read."""
    try:
        _, vertex, face = read_ply(mesh_file(entry, folder))
        at = np.column_stack([vertex[axis] for axis in "xyz"]).astype(float)
        return at, face["vertex_indices"], origin_of(entry)
    except (OSError, ValueError, KeyError, IndexError, TypeError, StopIteration):
        return None


def is_rigid(world):
    rotation = np.array(world, float)[:3, :3]
    return np.linalg.det(rotation) > 0 and np.abs(rotation @ rotation.T - np.eye(3)).max() <= RIGID


def finished(thing, mesh, world, folder):
    """The piece that an object is, if it is one of the fracture in or below `folder` and is as its file is: neither edited, nor
    scaled, nor broken already.  mesh: as modifiers leave it; world: its matrix."""
    home = home_of(thing, folder)
    entries = (manifest_in(home) or {}).get("fragments", []) if home else []
    entry = next((each for each in entries if each.get("id") == thing["sherd_fragment"]), None)
    if entry is None or entry.get("surface") != "exact" or not is_rigid(world):
        return None
    found = read_file(entry, home)
    if found is None:
        return None
    at, faces, origin = found
    if len(at) != len(mesh.vertices) or not are_equal(mesh, faces):
        return None
    here = read(mesh.vertices, "co", np.float32, 3).astype(float) + origin
    if not np.abs(here - at).max() <= 4 * np.finfo(np.float32).eps * np.abs(at).max():
        return None
    return Finished(home, entry["id"], at, Matrix.Translation(Vector(origin)), world)


def are_equal(mesh, faces):
    """Whether a mesh has as many triangles as a file, and uses its vertices as often: polygons may be cut in another way."""
    total = read(mesh.polygons, "loop_total", np.int32)
    corner = read(mesh.loops, "vertex_index", np.int32)
    return (total - 2).sum() == len(faces) and np.array_equal(np.unique(corner), np.unique(faces))


def renew_neighbors(piece, manifest, pieces):
    """Gives the other pieces of the fracture the neighbors that their files have now.  pieces: the new ones."""
    entries = {each["id"]: each for each in manifest["fragments"]}
    new = {each["sherd_fragment"] for each in pieces}
    for thing in [each for each in bpy.data.objects if each.type == "MESH" and each not in pieces and not each.library]:
        if home_of(thing, piece.folder) != piece.folder or thing["sherd_fragment"] in new:
            continue
        entry = entries.get(thing["sherd_fragment"])
        if entry and new & {contact["id"] for contact in entry["contacts"] + entry.get("thin_contacts", [])}:
            renew(thing.data, mesh_file(entry, piece.folder), piece.fragment)


def renew(mesh, path, broken):
    """Neighbors of a mesh's triangles that face the broken piece; those that the file does not have stay."""
    marks = mesh.attributes.get("neighbor")
    if marks is None or marks.domain != "FACE":
        return
    neighbor = read(marks.data, "value", np.int32)
    total, start = (read(mesh.polygons, name, np.int32) for name in ("loop_total", "loop_start"))
    facing = np.flatnonzero((neighbor == broken) & (total == 3))
    _, _, face = read_ply(path)
    vertex = read(mesh.loops, "vertex_index", np.int32)
    now = {tuple(sorted(corners)): new for corners, new in zip(face["vertex_indices"].tolist(), face["neighbor"].tolist())}
    corners = vertex[start[facing][:, None] + np.arange(3)]
    neighbor[facing] = [now.get(tuple(sorted(each)), broken) for each in corners.tolist()]
    write(marks.data, "value", neighbor, np.int32)
