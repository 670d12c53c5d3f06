# Import a finished fracture of Sherd into Blender.
#
# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
#
# This program is free software: you can redistribute it and/or modify it under the terms of the GNU General Public
# License as published by the Free Software Foundation, either version 3 of the License, or (at your option) any later
# version.  This program is distributed in the hope that it will be useful, but WITHOUT ANY WARRANTY; without even the
# implied warranty of MERCHANTABILITY or FITNESS FOR A PARTICULAR PURPOSE.  See the GNU General Public License for more
# details: <https://www.gnu.org/licenses/>.
"""Import the folder of `sherd fracture`: every fragment becomes an object, in a collection named after the mesh.

usage: blender -b --python-exit-code 1 --python import_sherd.py -- DIR [--meshes | --volumes] [--to-mesh] [--up z|y]
               [-o FILE.blend]

  --meshes    the files in DIR/meshes (the default): .ply, else .glb, else .obj
  --volumes   the level sets in DIR/fragments, an object per file
  --to-mesh   give every volume a Volume to Mesh modifier for grid `surface` at threshold 0
  --up        the mesh's axis that points up; y rotates the fragments to Blender's z-up (default z: unchanged)
  -o          save the scene here

Without -b the fragments are added to the open scene.
"""
import argparse
import json
import math
import os
import sys

import bpy
import mathutils
import numpy as np

TYPES = {"float": "<f4", "double": "<f8", "int": "<i4", "uchar": "u1"}
LISTS = {"vertex_indices": 3, "texcoord": 6}
INSIDE_COLOR = (0.745, 0.672, 0.552)  # sRGB 224, 214, 196


def arguments():
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="import_sherd.py", description=__doc__.split("\n")[0])
    parser.add_argument("folder", metavar="DIR")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--meshes", action="store_true")
    kind.add_argument("--volumes", action="store_true")
    parser.add_argument("--to-mesh", action="store_true")
    parser.add_argument("--up", choices=["z", "y"], default="z")
    parser.add_argument("-o", "--output")
    return parser.parse_args(words)


def rows_of(body, properties, count, at):
    """Columns of an element's rows: of a list all values one after another, and the lengths as "n_" and its name."""
    fields = []
    for name, kind, length_kind in properties:
        fields += [("n_" + name, length_kind), (name, kind, LISTS[name])] if length_kind else [(name, kind)]
    lists = {name: LISTS[name] for name, _, length_kind in properties if length_kind}
    if at + count * np.dtype(fields).itemsize <= len(body):
        rows = np.frombuffer(body, fields, count, at)
        if all((rows["n_" + name] == length).all() for name, length in lists.items()):
            return {name: rows[name].ravel() for name in rows.dtype.names}, at + rows.nbytes
    columns = {name: [] for name, *_ in fields}  # polygons: --surface exact
    for _ in range(count):
        for name, kind, length_kind in properties:
            length = 1
            if length_kind:
                length = int(np.frombuffer(body, length_kind, 1, at)[0])
                at += np.dtype(length_kind).itemsize
                columns["n_" + name].append(length)
            columns[name].append(np.frombuffer(body, kind, length, at))
            at += columns[name][-1].nbytes
    return {name: np.array(values) if name.startswith("n_") else np.concatenate(values) for name, values in columns.items()}, at


def read_ply(path):
    """Comments, and the columns of vertices and faces of a binary .ply that Sherd wrote (docs/formats.md)."""
    with open(path, "rb") as file:
        head, body = file.read().split(b"end_header\n", 1)
    comments, elements, columns, at = [], [], [], 0
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "comment":
            comments.append(words[1:])
        elif words[0] == "element":
            elements.append((int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][1].append((words[4], TYPES[words[3]], TYPES[words[2]]))
        elif words[0] == "property":
            elements[-1][1].append((words[2], TYPES[words[1]], None))
    for count, properties in elements:
        rows, at = rows_of(body, properties, count, at)
        columns.append(rows)
    return comments, *columns


def material(made, name, texture):
    """Returns the material of this name; a new one gets the texture, or a plain color."""
    if name not in made:
        made[name] = bpy.data.materials.new(name)
        made[name].use_nodes = True
        nodes, links = made[name].node_tree.nodes, made[name].node_tree.links
        shader = nodes.get("Principled BSDF")
        shader.inputs["Roughness"].default_value = 0.8
        color = INSIDE_COLOR if name.startswith("inside") else (0.8, 0.8, 0.8)
        shader.inputs["Base Color"].default_value = made[name].diffuse_color = (*color, 1)
        if texture:
            image = nodes.new("ShaderNodeTexImage")
            image.image = bpy.data.images.load(texture, check_existing=True)
            links.new(image.outputs["Color"], shader.inputs["Base Color"])
    return made[name]


def from_ply(path, name, made):
    """The object of a .ply: materials by name, texture coordinates, colors, and faces' `neighbor` as an attribute."""
    comments, vertex, face = read_ply(path)
    mesh = bpy.data.meshes.new(name)
    neighbor = face["neighbor"].astype(np.int32)
    corners, lengths = face["vertex_indices"], face["n_vertex_indices"].astype(np.int32)
    mesh.vertices.add(len(vertex["x"]))
    mesh.vertices.foreach_set("co", np.column_stack([vertex[axis] for axis in "xyz"]).astype(np.float32).ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners.astype(np.int32))
    mesh.polygons.add(len(lengths))
    mesh.polygons.foreach_set("loop_start", (np.cumsum(lengths) - lengths).astype(np.int32))
    if bpy.app.version < (3, 6, 0):
        mesh.polygons.foreach_set("loop_total", lengths)

    textures = [os.path.join(os.path.dirname(path), " ".join(c[1:])) for c in comments if c[0] == "TextureFile"]
    named = [c[2:] for c in comments if c[0] == "material"] or [["outside"], ["inside"]]
    for each, *texture in named:
        mesh.materials.append(material(made, each, textures[int(texture[0])] if texture and textures else None))
    index = face["material"] if "material" in face else neighbor > 0
    mesh.polygons.foreach_set("material_index", index.astype(np.int32))
    mesh.update(calc_edges=True)
    if "texcoord" in face:
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", face["texcoord"].astype(np.float32))
    if "red" in vertex:
        layer = mesh.color_attributes.new("Col", "BYTE_COLOR", "POINT")
        colors = np.column_stack([*(vertex[c] / 255 for c in ("red", "green", "blue")), np.ones(len(vertex["x"]))])
        layer.data.foreach_set("color_srgb", colors.astype(np.float32).ravel())
    mesh.attributes.new("neighbor", "INT", "FACE").data.foreach_set("value", neighbor)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def by_importer(path, name, made):
    """The object of a .glb or .obj, by Blender's importers, with the axes of the file."""
    before = set(bpy.data.objects)
    if path.endswith(".glb"):
        if "bool" not in vars(np):
            np.bool = bool  # Blender 3.4's importer uses a name that numpy 1.24 (Debian 12) has removed
        bpy.ops.import_scene.gltf(filepath=path)
    else:
        bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z")
    thing = next(t for t in bpy.data.objects if t not in before and t.type == "MESH")
    if path.endswith(".glb"):  # the importer converted y-up to z-up: undo it in the mesh
        thing.data.transform(mathutils.Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1))))
    thing.matrix_world = mathutils.Matrix()
    thing.name = thing.data.name = name
    for i, each in enumerate(thing.data.materials):  # every file has its `inside`, named inside.001 and so on
        base, _, number = each.name.rpartition(".")
        known = made.setdefault(base if number.isdigit() else each.name, each)
        thing.data.materials[i] = known
        if known != each:
            bpy.data.materials.remove(each)
    return thing


def from_vdb(path, name, to_mesh):
    """The object of one level set.  One file at a time, so that Blender detects no sequence."""
    volume = bpy.data.volumes.new(name)
    volume.filepath, volume.is_sequence = path, False
    thing = bpy.data.objects.new(name, volume)
    bpy.context.scene.collection.objects.link(thing)
    if not to_mesh:
        return thing
    # The modifier belongs to a mesh object and names the volume's.
    mesh = bpy.data.objects.new(name + "_mesh", bpy.data.meshes.new(name + "_mesh"))
    bpy.context.scene.collection.objects.link(mesh)
    mesh.parent = thing
    modifier = mesh.modifiers.new("Volume to Mesh", "VOLUME_TO_MESH")
    modifier.object, modifier.grid_name, modifier.threshold, modifier.adaptivity = thing, "surface", 0.0, 0.0
    modifier.resolution_mode = "GRID"
    thing.hide_render = thing.hide_viewport = True
    return thing


def chosen(files, kinds):
    """Returns the first path of the kinds, in order of preference."""
    files = [files] if isinstance(files, str) else files or []
    return next((f for kind in kinds for f in files if f.endswith(kind)), None)


def gather(things, collection, up):
    for thing in things:
        for each in [thing, *thing.children]:
            for old in each.users_collection[:]:
                old.objects.unlink(each)
            collection.objects.link(each)
        if up == "y":
            thing.matrix_world = mathutils.Matrix.Rotation(math.radians(90), 4, "X") @ thing.matrix_world


def bring(options):
    """Returns the fragments' objects, ordered by id."""
    folder = os.path.abspath(options.folder)
    if folder.endswith("manifest.json"):
        folder = os.path.dirname(folder)
    try:
        with open(os.path.join(folder, "manifest.json"), encoding="utf-8") as file:
            manifest = json.load(file)
    except OSError:
        sys.exit(f"{options.folder}: no manifest.json; a finished fracture's folder is needed")
    except ValueError:
        sys.exit(f"{options.folder}: manifest.json is not JSON")
    if manifest.get("schema") != "sherd/2":
        sys.exit(f"{options.folder}: manifest.json is not of schema sherd/2")
    kind = "vdb" if options.volumes else "mesh"
    things, made = [], {}
    for fragment in manifest["fragments"]:
        file = chosen(fragment.get("files", {}).get(kind), (".vdb",) if options.volumes else (".ply", ".glb", ".obj"))
        if file is None:
            sys.exit(f"{options.folder}: fragment {fragment['id']} has no {kind} file (sherd fracture --write {kind})")
        path, name = os.path.join(folder, file), os.path.splitext(os.path.basename(file))[0]
        if not os.path.isfile(path):
            sys.exit(f"{path}: no such file, though manifest.json lists it")
        if options.volumes:
            thing = from_vdb(path, name, options.to_mesh)
        else:
            thing = from_ply(path, name, made) if path.endswith(".ply") else by_importer(path, name, made)
        thing["sherd_fragment"], thing["sherd_volume"] = fragment["id"], fragment["volume"]
        thing["sherd_share"], thing["sherd_folder"] = fragment["share"], folder
        things.append(thing)
    collection = bpy.data.collections.new(things[0].name.rsplit("_", 1)[0])
    bpy.context.scene.collection.children.link(collection)
    gather(things, collection, options.up)
    return things


def main():
    options = arguments()
    if bpy.app.background:  # remove the default cube
        for thing in bpy.data.objects[:]:
            if thing.type == "MESH" and thing.name == "Cube":
                bpy.data.objects.remove(thing)
    things = bring(options)
    print(f"{options.folder}: {len(things)} fragments")
    if options.output:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(options.output))


main()
