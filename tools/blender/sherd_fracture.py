# Sherd Fracture: breaks mesh objects of Blender with the program `sherd`.
#
# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
#
# This program is free software: you can redistribute it and/or modify it under the terms of the GNU General Public
# License as published by the Free Software Foundation, either version 3 of the License, or (at your option) any later
# version.  This program is distributed in the hope that it will be useful, but WITHOUT ANY WARRANTY; without even the
# implied warranty of MERCHANTABILITY or FITNESS FOR A PARTICULAR PURPOSE.  See the GNU General Public License for more
# details: <https://www.gnu.org/licenses/>.
#
# This file runs inside Blender and is under Blender's license.  It starts `sherd` as a separate program; the rest of
# Sherd is under the Apache License 2.0.
"""Breaks the active mesh object into fragments: see docs/blender.md.

Exports the mesh as one .ply with the attributes that Sherd transfers (texture coordinates, colors, material index per
face) and imports one .ply per fragment.  Materials stay in Blender: faces of fragments get the object's materials.
"""
import json
import math
import os
import shutil
import subprocess
import tempfile
import time

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, StringProperty
from bpy_extras import view3d_utils

bl_info = {
    "name": "Sherd Fracture",
    "author": "The Sherd authors",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Sherd",
    "description": "Break meshes into closed fragments with the program sherd",
    "category": "Object",
}

INSIDE_COLOR = (0.745, 0.672, 0.552)  # sRGB 224, 214, 196, as in Sherd's material `inside`
SMOOTH_BELOW = math.radians(40)
CONVERTIBLE = ("CURVE", "SURFACE", "META", "FONT")
PLY_TYPES = {"float": "<f4", "int": "<i4", "uchar": "u1"}
PLY_LISTS = {"vertex_indices": 3, "texcoord": 6}


class Failure(Exception):
    """An error, as one sentence for the user."""


# ---- Export ----


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


def write_ply(path, mesh, world):
    """Write a mesh's triangles in world space.  Returns the names of its texture coordinates and colors, or None."""
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
    vertices = np.empty(len(used), fields)
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


# ---- Import ----


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


def home(context, thing):
    """The collection of the view layer that holds an object."""
    def shown(layer):
        if not layer.exclude:
            yield layer.collection
        for child in layer.children:
            yield from shown(child)
    return next((c for c in shown(context.view_layer.layer_collection) if thing in c.objects[:]),
                context.scene.collection)


def make_rigid(context, fragments, density, asleep):
    """Makes the fragments, which are the selection, active rigid bodies.  Returns False if the scene does not allow any."""
    scene = context.scene
    try:
        if scene.rigidbody_world is None:
            bpy.ops.rigidbody.world_add()
        bpy.ops.rigidbody.objects_add(type="ACTIVE")
    except RuntimeError:
        return False
    for thing in fragments:
        body = thing.rigid_body
        if body is None:
            return False
        body.collision_shape = "CONVEX_HULL"
        body.use_margin, body.collision_margin = True, 0.0
        body.mass = density * thing["sherd_volume"]
        body.use_deactivation = body.use_start_deactivated = asleep
    return True


# ---- The run ----


def preference(context, name, default):
    addon = context.preferences.addons.get(__name__)
    return getattr(addon.preferences, name) if addon and addon.preferences else default


def program(context):
    asked = bpy.path.abspath(preference(context, "binary", "") or "sherd")
    found = shutil.which(asked)
    if found is None:
        raise Failure(f"program '{asked}' not found; set the path of sherd in Edit > Preferences > Add-ons > "
                      "Sherd Fracture")
    return found


def limited(name, room):
    """A name truncated so that `room` more bytes fit into Blender's 63."""
    return name.encode()[:63 - room].decode(errors="ignore")


class Job:
    """One run of sherd: started by the constructor; fetch() imports the fragments, close() cleans up."""

    def __init__(self, context, thing, choices):
        self.thing, self.process, self.scratch = thing, None, None
        self.density, self.rigid, self.original = choices.density, choices.rigid_body, choices.original
        self.inside, self.asleep = choices.inside_material, choices.asleep
        self.deadline = time.monotonic() + preference(context, "timeout", 600)
        binary = program(context)
        self.scratch = tempfile.mkdtemp(prefix="sherd-")
        try:
            self.kept = bool(choices.folder)
            self.out = bpy.path.abspath(choices.folder) if self.kept else os.path.join(self.scratch, "out")
            self.export(context)
            command = [binary, "fracture", self.mesh, "-o", self.out, "--write", "labels,vdb,mesh" if self.kept else
                       "mesh", "--json", *self.options(choices)]
            with open(self.path("report"), "wb") as report, open(self.path("errors"), "wb") as errors:
                self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=report, stderr=errors)
        except OSError as error:
            self.close()
            raise Failure(f"{binary} does not run ({error.strerror}); set the path of sherd in Edit > Preferences > "
                          "Add-ons > Sherd Fracture") from None
        except BaseException:
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def path(self, name):
        return os.path.join(self.scratch, name)

    def export(self, context):
        evaluated = self.thing.evaluated_get(context.evaluated_depsgraph_get())
        mesh = evaluated.to_mesh()
        try:
            if mesh is None or not mesh.polygons:
                raise Failure(f"{self.thing.name} has no faces to break")
            stem = "".join(c if c.isalnum() or c in "-_." else "_" for c in self.thing.name)
            self.mesh = self.path(stem + ".ply")
            self.materials = [m and m.original for m in mesh.materials]
            for i, slot in enumerate(self.thing.material_slots):
                if slot.link == "OBJECT" and i < len(self.materials):
                    self.materials[i] = slot.material
            self.uv_name, self.color_name = write_ply(self.mesh, mesh, evaluated.matrix_world)
        finally:
            evaluated.to_mesh_clear()

    @staticmethod
    def options(choices):
        words = ["--pieces", choices.pieces, "--resolution", choices.resolution, "--seed", choices.seed,
                 "--growth", choices.growth.lower(), "--erode-iterations", choices.wear]
        if choices.roughness > 0:
            words += ["--roughness", f"{choices.roughness:.6g}"]
        if choices.impact_position is not None:
            parts = [f"{x:.9g}" for x in choices.impact_position] + [str(choices.impact_pieces)]
            if choices.impact_spread > 0:
                parts.append(f"{choices.impact_spread:.6g}")
            words += ["--impact=" + ",".join(parts)]  # one word: it may begin with a minus
        return [str(word) for word in words]

    def running(self):
        if self.process.poll() is not None:
            return False
        if time.monotonic() > self.deadline:
            raise Failure(f"sherd took longer than the time limit for {self.thing.name} and was stopped; try a lower "
                          "resolution, or a longer limit in the add-on's preferences")
        return True

    def wait(self):
        try:
            while self.running():
                time.sleep(0.02)
        except KeyboardInterrupt:
            raise Failure(f"breaking {self.thing.name} was interrupted") from None

    def messages(self):
        """Returns the error and the warnings of sherd, with the object's name in place of the temporary file's."""
        with open(self.path("errors"), errors="replace") as file:
            text = file.read().replace(self.mesh, self.thing.name).replace(os.path.basename(self.mesh), self.thing.name)
        warnings = [line[15:].strip() for line in text.splitlines() if line.startswith("sherd: warning:")]
        errors = [line[6:].strip() for line in text.splitlines()
                  if line.startswith("sherd:") and not line.startswith("sherd: warning:")]
        return " ".join(errors), warnings

    def fetch(self, context):
        """Returns the fragments as objects, the first one active, and warnings."""
        error, warnings = self.messages()
        status = self.process.returncode
        if status in (130, -2, -15):
            raise Failure(f"breaking {self.thing.name} was interrupted")
        if status < 0:
            raise Failure(f"sherd was ended by signal {-status} while breaking {self.thing.name}")
        if status != 0:
            raise Failure(error or f"sherd ended with status {status} and no message")
        try:
            with open(os.path.join(self.out, "manifest.json"), encoding="utf-8") as file:
                manifest = json.load(file)
        except (OSError, ValueError):
            raise Failure("sherd succeeded but wrote no manifest.json; check that the program is sherd") from None
        fragments = self.build(context, manifest)
        if self.rigid and not make_rigid(context, fragments, self.density, self.asleep):
            warnings.append("this scene may not have rigid bodies; the fragments are plain objects")
        if self.original == "HIDE":
            self.hide(context)
        return fragments, warnings

    def build(self, context, manifest):
        thing, materials = self.thing, self.materials
        inside = bpy.data.materials.get(self.inside) if self.inside else None
        inside = inside or material("Sherd inside", INSIDE_COLOR)
        materials = materials or [material("Sherd outside", (0.8, 0.8, 0.8))]
        collection = bpy.data.collections.new(thing.name)
        home(context, thing).children.link(collection)
        digits = max(3, len(str(manifest["fragments"][-1]["id"])))
        fragments = []
        for entry in manifest["fragments"]:
            if "files" not in entry or "mesh" not in entry["files"]:
                continue  # withheld
            name = limited(thing.name, digits + 1) + f"_{entry['id']:0{digits}d}"
            origin = np.array(entry["centroid"], np.float32).astype(float)  # rounded as in Blender
            mesh = read_mesh(os.path.join(self.out, entry["files"]["mesh"]), name, origin, materials, inside,
                             self.uv_name, self.color_name)
            fragment = bpy.data.objects.new(name, mesh)
            fragment.location = origin
            fragment["sherd_fragment"] = entry["id"]
            fragment["sherd_volume"] = entry["volume"]
            fragment["sherd_share"] = entry["share"]
            fragment["sherd_source"] = thing.name
            if self.kept:
                fragment["sherd_folder"] = self.out
            collection.objects.link(fragment)
            fragments.append(fragment)
        for other in context.selected_objects:
            other.select_set(False)
        for fragment in fragments:
            fragment.select_set(True)
        context.view_layer.objects.active = fragments[0]
        return fragments

    def hide(self, context):
        """Hides the object and removes its rigid body, which would still push the fragments."""
        world = context.scene.rigidbody_world
        if self.thing.rigid_body and world and world.collection and self.thing in world.collection.objects[:]:
            world.collection.objects.unlink(self.thing)
        self.thing.hide_set(True)
        self.thing.hide_render = True

    def close(self):
        if self.process and self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(5)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        if self.scratch:
            shutil.rmtree(self.scratch, ignore_errors=True)


# ---- User interface ----


class Choices:
    """The options: stored with the scene for the panel, and with each run for the operator."""

    pieces: IntProperty(name="Pieces", description="Number of fragments", default=8, min=1, max=65534, soft_max=200)
    resolution: IntProperty(name="Resolution", description="Voxels along the longest side of the object's box",
                            default=96, min=8, max=4096, soft_max=256)
    seed: IntProperty(name="Seed", description="Seed of every random choice: the same seed, the same fragments",
                      default=0, min=0)
    growth: EnumProperty(name="Growth", description="Growth of fragments from their seeds", default="EUCLID", items=[
        ("EUCLID", "Euclid", "Nearest seed; disconnected voxels are regrown"),
        ("NEAREST", "Nearest", "Nearest seed, ignoring gaps"),
        ("CHAIN", "Chain", "Over voxel faces in the order of the distance to the seed"),
        ("FLOOD", "Flood", "Layer by layer")])
    roughness: FloatProperty(name="Roughness", description="Rms height of cracks in voxels; 0 is planar",
                             default=0.0, min=0.0, max=100.0, soft_max=3.0)
    wear: IntProperty(name="Wear", description="Iterations of erosion of the outermost layer of cracks", default=0, min=0,
                      max=1000, soft_max=10)
    impact: EnumProperty(name="Impact", description="Position of an impact, with small fragments around it", default="NONE",
                         items=[("NONE", "None", "No impact"), ("CURSOR", "3D Cursor", "At the 3D cursor"),
                                ("MOUSE", "Under the Mouse", "Where you click on the object")])
    impact_pieces: IntProperty(name="Impact Pieces", description="Number of fragments around the impact",
                               default=4, min=1, max=65534, soft_max=100)
    impact_spread: FloatProperty(name="Impact Spread", unit="LENGTH", default=0.0, min=0.0,
                                 description="Standard deviation of its seeds from the impact; 0: Sherd's default")
    inside_material: StringProperty(name="Inside", description="Material of cracks; empty: 'Sherd inside'")
    rigid_body: BoolProperty(name="Rigid Bodies", description="Make the fragments active rigid bodies", default=True)
    asleep: BoolProperty(name="Rest Until Hit", default=False,
                         description="Rigid bodies rest until another body touches them")
    density: FloatProperty(name="Density", description="Mass over volume, for the rigid bodies", default=1000.0,
                           min=0.000001, soft_max=10000.0)
    original: EnumProperty(name="Original", description="The source object after the fracture", default="HIDE", items=[
        ("HIDE", "Hide", "Hide it, and remove it from the rigid body world"), ("KEEP", "Keep", "Leave it unchanged")])
    folder: StringProperty(name="Keep Files", description="Folder for Sherd's files; empty: files are not kept",
                           subtype="DIR_PATH")


NAMES = list(Choices.__annotations__)


class SherdSettings(bpy.types.PropertyGroup, Choices):
    """The options of the panel."""


class SherdPreferences(bpy.types.AddonPreferences):
    bl_idname = __name__

    binary: StringProperty(name="Program", description="Path of sherd; empty: as found in PATH", subtype="FILE_PATH")
    timeout: IntProperty(name="Time Limit", description="Seconds after which a run is stopped", default=600, min=1)

    def draw(self, _context):
        self.layout.prop(self, "binary")
        self.layout.prop(self, "timeout")


class OBJECT_OT_sherd_fracture(bpy.types.Operator, Choices):
    """Break the active mesh object into closed fragments with sherd"""

    bl_idname = "object.sherd_fracture"
    bl_label = "Sherd Fracture"
    bl_options = {"REGISTER", "UNDO"}

    impact_point: FloatVectorProperty(name="Impact Point", subtype="XYZ", options={"HIDDEN", "SKIP_SAVE"})

    job = timer = None

    def thing(self, context):
        thing = context.active_object
        if thing is None or not thing.select_get():
            raise Failure("nothing is selected; select the mesh object to break")
        if thing.type != "MESH":
            hint = "convert it first (Object > Convert)" if thing.type in CONVERTIBLE else "select a mesh object"
            raise Failure(f"{thing.name} is of type {thing.type.lower()}, not a mesh; {hint}")
        if thing.mode != "OBJECT":
            raise Failure(f"{thing.name} is in {thing.mode.lower()} mode; leave it first (Tab)")
        return thing

    def begin(self, context):
        self.impact_position = None
        if self.impact == "CURSOR":
            self.impact_position = tuple(context.scene.cursor.location)
        elif self.impact == "MOUSE":
            if not self.properties.is_property_set("impact_point"):
                raise Failure("an impact under the mouse needs a click in a 3D view; use the 3D cursor without one")
            self.impact_position = tuple(self.impact_point)
        return Job(context, self.thing(context), self)

    def end(self, context, job):
        fragments, warnings = job.fetch(context)
        for warning in warnings:
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, f"{len(fragments)} fragments of {job.thing.name}")
        return {"FINISHED"}

    def fail(self, context, failure):
        self.leave(context)
        self.report({"ERROR"}, str(failure))
        return {"CANCELLED"}

    def execute(self, context):
        """Blocking run: scripts, and the panel of the last operation."""
        try:
            with self.begin(context) as job:
                job.wait()
                return self.end(context, job)
        except Failure as failure:
            return self.fail(context, failure)

    def invoke(self, context, _event):
        """From the panel: first a click if needed, then a run that Esc stops."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            self.thing(context)
            program(context)
            if self.impact == "MOUSE" and not self.properties.is_property_set("impact_point"):
                if context.area is None or context.area.type != "VIEW_3D":
                    raise Failure("an impact under the mouse needs a click in a 3D view; start it from the sidebar there")
                context.workspace.status_text_set("Click the impact point; right click or Esc: no fracture")
                context.window.cursor_modal_set("CROSSHAIR")
            else:
                self.start(context)
        except Failure as failure:
            return self.fail(context, failure)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def start(self, context):
        self.job = self.begin(context)
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.workspace.status_text_set(f"Sherd is breaking {self.job.thing.name}; Esc stops it")
        context.window.cursor_modal_set("WAIT")

    def pick(self, context, event):
        """The point of the object under the mouse; None beside the object."""
        for region in context.area.regions:
            x, y = event.mouse_x - region.x, event.mouse_y - region.y
            if region.type == "WINDOW" and 0 <= x < region.width and 0 <= y < region.height:
                return point_under(context, region, region.data, (x, y), self.thing(context))
        return None

    def modal(self, context, event):
        try:
            if event.type == "ESC" or (event.type == "RIGHTMOUSE" and self.job is None):
                self.leave(context)
                self.report({"INFO"}, "no fracture")
                return {"CANCELLED"}
            if self.job is None:
                if event.type != "LEFTMOUSE" or event.value != "PRESS":
                    return {"PASS_THROUGH"}  # the view may be rotated
                position = self.pick(context, event)
                if position is None:
                    self.report({"WARNING"}, "the click missed the object")
                    return {"RUNNING_MODAL"}
                self.impact_point = position
                self.start(context)
            elif event.type == "TIMER" and not self.job.running():
                job, self.job = self.job, None
                self.leave(context)
                with job:
                    return self.end(context, job)
        except Failure as failure:
            return self.fail(context, failure)
        return {"RUNNING_MODAL"}

    def leave(self, context):
        if self.job:
            self.job.close()
            self.job = None
        if self.timer:
            context.window_manager.event_timer_remove(self.timer)
            self.timer = None
        if not bpy.app.background and context.window:
            context.window.cursor_modal_restore()
            context.workspace.status_text_set(None)

    def cancel(self, context):
        self.leave(context)


def point_under(context, region, view, at, thing):
    """First intersection of the ray through a pixel with an object, in world space, or None."""
    start = view3d_utils.region_2d_to_origin_3d(region, view, at)
    along = view3d_utils.region_2d_to_vector_3d(region, view, at)
    evaluated = thing.evaluated_get(context.evaluated_depsgraph_get())
    local = evaluated.matrix_world.inverted_safe()
    hit, position, _, _ = evaluated.ray_cast(local @ start, local.to_3x3() @ along)
    return evaluated.matrix_world @ position if hit else None


class VIEW3D_PT_sherd(bpy.types.Panel):
    bl_label = "Sherd Fracture"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Sherd"

    def draw(self, context):
        layout, chosen = self.layout, context.scene.sherd
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        for name in ("pieces", "resolution", "seed", "growth", "roughness", "wear"):
            column.prop(chosen, name)
        column = layout.column()
        column.prop(chosen, "impact")
        if chosen.impact != "NONE":
            column.prop(chosen, "impact_pieces")
            column.prop(chosen, "impact_spread")
        column = layout.column()
        column.prop_search(chosen, "inside_material", bpy.data, "materials")
        column.prop(chosen, "rigid_body")
        if chosen.rigid_body:
            column.prop(chosen, "density")
            column.prop(chosen, "asleep")
        column.prop(chosen, "original")
        column.prop(chosen, "folder")
        run = layout.operator("object.sherd_fracture", text="Break", icon="MOD_EXPLODE")
        for name in NAMES:
            setattr(run, name, getattr(chosen, name))


CLASSES = (SherdSettings, SherdPreferences, OBJECT_OT_sherd_fracture, VIEW3D_PT_sherd)


def menu(self, _context):
    self.layout.operator_context = "INVOKE_DEFAULT"
    self.layout.operator("object.sherd_fracture")


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.sherd = bpy.props.PointerProperty(type=SherdSettings)
    bpy.types.VIEW3D_MT_object.append(menu)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(menu)
    del bpy.types.Scene.sherd
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)


if __name__ == "__main__":
    register()
