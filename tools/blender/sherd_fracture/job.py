# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One run of sherd for one object."""
import json
import os
import shutil
import subprocess
import tempfile
import time

import bpy
import numpy as np

from .export_mesh import write_ply
from .failure import Failure
from .import_mesh import INSIDE_COLOR, material, read_mesh
from .program import preference, program
from .scene import home, limited, make_rigid


class Job:
    """One run of sherd: started by the constructor; fetch() imports the fragments, close() cleans up."""

    def __init__(self, context, thing, choices):
        self.thing, self.process, self.scratch = thing, None, None
        self.collection, self.fragments = None, []
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
        for _ in self.build(context, manifest):
            pass
        fragments = self.fragments
        for other in context.selected_objects:
            other.select_set(False)
        for fragment in fragments:
            fragment.select_set(True)
        context.view_layer.objects.active = fragments[0]
        if self.rigid and not make_rigid(context, fragments, self.density, self.asleep):
            warnings.append("this scene may not have rigid bodies; the fragments are plain objects")
        if self.original == "HIDE":
            self.hide(context)
        return fragments, warnings

    def build(self, context, manifest):
        """Makes the fragments, in a collection of their own; a generator with a stop after each."""
        thing, materials = self.thing, self.materials
        inside = bpy.data.materials.get(self.inside) if self.inside else None
        inside = inside or material("Sherd inside", INSIDE_COLOR)
        materials = materials or [material("Sherd outside", (0.8, 0.8, 0.8))]
        self.collection = bpy.data.collections.new(thing.name)
        digits = max(3, len(str(manifest["fragments"][-1]["id"])))
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
            self.collection.objects.link(fragment)
            self.fragments.append(fragment)
            yield
        home(context, thing).children.link(self.collection)

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
