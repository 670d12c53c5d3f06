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
from mathutils import Matrix

from .again import finished, folder_of, origin_of, renew_neighbors
from .diagnosis import counted, sentences
from .export_mesh import Source
from .failure import Failure
from .glue import glue, move
from .import_mesh import INSIDE_COLOR, Piece, material
from .levels import Splits, mark, nest
from .options import options, options_again
from .physics import leave_world, make_body, remove_world, world_of
from .program import arguments_of, environment, preference, program
from .progress import Progress
from .scene import discard, discard_previews, file_name, homes, limited
from .weights import density_of


class Job:
    """One run of sherd for one object: started by the constructor; fetch() makes the fragments, close() cleans up.  Objects
    are known by name and library, since an undo step would leave pointers to nothing.
    """

    def __init__(self, context, key, choices, position=None, folder=""):
        """key: as of scene.key_of()"""
        self.key, self.name, self.choices, self.position = key, key[0], choices, position
        self.process = self.scratch = self.collection = self.again = self.siblings = None
        self.fragments, self.complete, self.notes, self.lonely = [], False, [], False
        self.progress, self.expected = Progress(), 0
        self.deadline = time.monotonic() + preference(context, "timeout", 600)
        binary = program(context)
        self.kept, self.shown, self.inside = bool(folder), False, choices.inside_material
        try:
            self.scratch = tempfile.mkdtemp(prefix="sherd-")
            self.out = bpy.path.abspath(folder) if self.kept else self.path("out")
            self.shown = self.show(context)
            self.export(context)
        except OSError as error:
            self.close()
            raise Failure(f"the mesh of {self.name} cannot be written to {self.scratch or tempfile.gettempdir()} "
                          f"({error.strerror})") from None
        except BaseException:
            self.close()
            raise
        self.start(binary)

    def start(self, binary):
        """Starts the program."""
        choices = self.choices
        try:
            words = options_again(choices, self.again, self.position) if self.again else [
                self.mesh, "--write", "labels,vdb,mesh" if self.kept else "mesh", "--source-faces",
                *options(choices, self.position, self.weighted)]
            command = [binary, "fracture", *words, "-o", self.out, "--json", "--progress", *arguments_of(binary)]
            with open(self.path("report"), "wb") as report, open(self.path("errors"), "wb") as errors:
                self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=report, stderr=errors,
                                                env=environment(binary))
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

    @property
    def thing(self):
        found = bpy.data.objects.get(self.key)
        if found is None:
            raise Failure(f"{self.name} is gone; it was removed or renamed while sherd was breaking it")
        return found

    def show(self, context):
        """Shows the object, if a preview hides it: modifiers of hidden objects are not evaluated.  Returns whether it was
        hidden."""
        hidden = self.thing.hide_get()
        if hidden:
            self.thing.hide_set(False)
            context.view_layer.update()
        return hidden

    def path(self, name):
        return os.path.join(self.scratch, name)

    def export(self, context):
        thing = self.thing
        evaluated = thing.evaluated_get(context.evaluated_depsgraph_get())
        mesh = evaluated.to_mesh()
        try:
            if mesh is None or not mesh.polygons:
                raise Failure(f"{thing.name} has no faces to break")
            self.mesh = self.path(file_name(thing.name) + ".ply")
            self.materials = [m and m.original for m in mesh.materials]
            for i, slot in enumerate(thing.material_slots):
                if slot.link == "OBJECT" and i < len(self.materials):
                    self.materials[i] = slot.material
            self.source = Source(thing, mesh, evaluated.matrix_world)
            density = density_of(thing, mesh, self.choices.weight_group)
            of_whole = density is not None or self.choices.wear
            self.again = None if of_whole else finished(thing, mesh, evaluated.matrix_world, self.choices.folder)
            if self.again:
                self.source = Source(thing, mesh, self.again.rest)
                self.source.at = self.again.at
        finally:
            evaluated.to_mesh_clear()
        self.weighted = density is not None
        if self.again:
            self.out = self.again.folder if self.kept else self.out
            return
        self.keep_home(thing)
        self.source.write_ply(self.mesh, density)
        applied = [name for name, are in (("modifiers", any(m.show_viewport for m in thing.modifiers)),
                                          ("shape keys", getattr(thing.data, "shape_keys", None))) if are]
        if applied:
            self.notes.append(f"the {' and '.join(applied)} of {thing.name} are applied to its pieces")

    def keep_home(self, thing):
        """Leaves the folder of the fracture that an object is a piece of as it is, and those that this one is in."""
        home = folder_of(thing) if self.kept else None
        out = os.path.realpath(self.out)
        if home and os.path.commonpath([home, out]) == out:
            self.out = os.path.join(home, file_name(thing.name))
            self.notes.append(f"{thing.name} is not as its file is, or needs options of a whole: it was broken as a mesh, and "
                              f"its files are in {self.out}")

    def running(self):
        self.progress.read(self.path("errors"))
        if self.process.poll() is not None:
            return False
        if time.monotonic() > self.deadline:
            raise Failure(f"sherd took longer than the time limit for {self.thing.name} and was stopped; try a lower "
                          "resolution, or a longer limit in the add-on's preferences")
        return True

    def doing(self):
        """The stage, for the status bar."""
        if self.process and self.process.returncode is None:
            return self.progress.stage or "start"
        return f"{len(self.fragments)} of {self.expected} fragments in Blender" if self.expected else "read"

    def share(self):
        """How much is done, 0 to 1: four fifths are sherd's."""
        made = len(self.fragments) / self.expected if self.expected else 0
        return 0.8 * (1 if self.expected else self.progress.overall) + 0.2 * made

    def messages(self):
        """Returns the error and the warnings of sherd, with the object's name in place of the temporary file's."""
        with open(self.path("errors"), encoding="utf-8", errors="replace") as file:
            text = file.read()
        if not self.again:
            text = text.replace(self.mesh, self.thing.name).replace(os.path.basename(self.mesh), self.thing.name)
        warnings = [line[15:].strip() for line in text.splitlines() if line.startswith("sherd: warning:")]
        errors = [line[6:].strip() for line in text.splitlines()
                  if line.startswith("sherd:") and not line.startswith("sherd: warning:")]
        return " ".join(errors), warnings

    def manifest(self):
        error, warnings = self.messages()
        status = self.process.returncode
        if status in (130, -2, -15):
            raise Failure(f"breaking {self.name} was interrupted")
        if status < 0:
            raise Failure(f"sherd was ended by signal {-status} while breaking {self.name}")
        if status != 0:
            raise Failure(error or f"sherd ended with status {status} and no message")
        self.notes += warnings
        try:
            with open(os.path.join(self.out, "manifest.json"), encoding="utf-8") as file:
                return json.load(file)
        except (OSError, ValueError):
            raise Failure("sherd succeeded but wrote no manifest.json; check that the program is sherd") from None

    def fetch(self, context):
        """Makes the fragments and what belongs to them; a generator with a stop after each fragment."""
        manifest = self.manifest()
        self.notes += sentences(self.name, manifest)
        made = [each for each in manifest["fragments"] if not self.again or each.get("parent") == self.again.fragment]
        self.expected = len(made)
        yield from self.build(made)
        if not self.fragments:
            raise Failure(f"sherd withheld all fragments of {self.name}")
        splits, above = Splits(manifest), self.thing.get("sherd_level", 0)
        for fragment in self.fragments:
            mark(fragment, splits, above, self.siblings)
            yield
        discard_previews(self.name)
        for each in homes(context, self.thing):
            each.children.link(self.collection)
        nest(self.collection, self.fragments, splits, self.choices.levels)
        if self.choices.preview:
            self.name_preview()
        elif self.choices.rigid_body:
            yield from self.simulate(context, manifest)
        if self.choices.original == "HIDE":
            if not self.choices.preview:
                self.move_glue(context, manifest)
            self.hide(context)
        self.complete = True
        if self.again and self.kept:
            self.renew(manifest)

    def renew(self, manifest):
        """Gives the other pieces the neighbors that they have now.  The new ones stay whatever comes of it."""
        try:
            renew_neighbors(self.again, manifest, self.fragments)
        except (OSError, ValueError, KeyError, TypeError, IndexError, StopIteration) as error:
            self.notes.append(f"the neighbors of {self.name} keep the numbers that they faced before: {error}")

    def name_preview(self):
        """Marks a preview, and leaves the fragments' names to the final."""
        self.collection["sherd_preview"] = self.name
        self.collection.name = limited(self.name, 8) + " preview"
        for fragment in self.fragments:
            fragment.name = limited(fragment.name, 8) + " preview"

    def simulate(self, context, manifest):
        """Makes the fragments bodies, and glues them."""
        self.lonely = context.scene.rigidbody_world is None
        if world_of(context) is None:
            self.notes.append("this scene may not have rigid bodies; the fragments are plain objects")
            return
        for fragment in self.fragments:
            make_body(world_of(context), fragment, self.choices)  # anew: undo between steps may replace the world
            yield
        if self.choices.glue:
            yield from glue(context, self.collection, self.fragments, manifest, self.choices.strength, self.moved)

    def move_glue(self, context, manifest):
        """Gives the glue of an object that is a piece itself to its fragments."""
        bodies = [each for each in self.fragments if each.rigid_body]
        moved, lost = move(context, self.thing, bodies, manifest["grid"]["voxel_size"] / 2)
        if moved:
            self.notes.append(f"glue of {self.name} to {counted(moved, 'neighbor')} was moved to its pieces")
        if lost:
            why = "no piece touches" if bodies else "its pieces are no rigid bodies"
            self.notes.append(f"glue of {self.name} to {counted(lost, 'neighbor')} was removed: {why}")

    def build(self, entries):
        """Makes the fragments, in a collection of their own; a generator with a stop after each."""
        thing = self.thing
        inside = bpy.data.materials.get(self.inside) if self.inside else None
        inside = inside or material("Sherd inside", INSIDE_COLOR)
        materials = self.materials or [material("Sherd outside", (0.8, 0.8, 0.8))]
        self.collection = bpy.data.collections.new(thing.name)
        self.siblings = [entry["id"] for entry in entries] if self.again else None
        digits = max(3, len(str(entries[-1]["id"])))
        for entry in entries:
            if "files" not in entry or "mesh" not in entry["files"]:
                continue  # withheld
            name = limited(thing.name, digits + 1) + f"_{entry['id']:0{digits}d}"
            origin = origin_of(entry)
            piece = Piece(self.source, os.path.join(self.out, entry["files"]["mesh"]), origin, entry["surface"] == "exact",
                          self.siblings)
            mesh = piece.mesh(name, materials, inside)
            fragment = bpy.data.objects.new(name, mesh)
            piece.add_groups(fragment)
            fragment.matrix_basis = self.place(origin)
            self.take_place(fragment)
            fragment["sherd_fragment"] = entry["id"]
            fragment["sherd_volume"] = entry["volume"]
            fragment["sherd_share"] = entry["share"]
            fragment["sherd_source"] = thing.name
            if self.kept:
                fragment["sherd_folder"] = self.out
            self.collection.objects.link(fragment)
            self.fragments.append(fragment)
            yield

    def place(self, origin):
        """The matrix of a fragment in world space."""
        return self.moved @ Matrix.Translation(origin)

    @property
    def moved(self):
        """The matrix from the fracture's space to where the object is."""
        return self.again.moved if self.again else Matrix.Identity(4)

    def take_place(self, fragment):
        """Gives a fragment, in world space, the object's parent and what it is displayed by."""
        thing = self.thing
        fragment.color, fragment.pass_index = thing.color, thing.pass_index
        if thing.parent is None:
            return
        deforms = thing.parent_type in ("ARMATURE", "LATTICE")  # which is applied: pieces follow as rigid things
        fragment.parent, fragment.parent_type = thing.parent, "OBJECT" if deforms else thing.parent_type
        fragment.parent_bone = thing.parent_bone
        if thing.parent_type in ("VERTEX", "VERTEX_3"):
            fragment.parent_vertices = thing.parent_vertices
        moved = (thing.parent.matrix_world if fragment.parent_type == "OBJECT" else
                 thing.matrix_world @ (thing.matrix_parent_inverse @ thing.matrix_basis).inverted_safe())
        fragment.matrix_parent_inverse = moved.inverted_safe()

    def hide(self, context):
        """Hides the object and removes its rigid body."""
        if not self.choices.preview:
            leave_world(context, self.thing)
        self.thing.hide_set(True)
        if self.thing.library:
            self.notes.append(f"{self.name} is of a library: it is hidden in the view, but not in renders")
        else:
            self.thing.hide_render = True

    def close(self):
        """Ends the program, and removes files and what is not complete."""
        if self.process and self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(5)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        if self.scratch:
            shutil.rmtree(self.scratch, ignore_errors=True)
        if not self.complete:
            self.take_back()

    def take_back(self):
        """Removes what was made of an object that is not complete."""
        try:
            discard(self.collection)
            thing = bpy.data.objects.get(self.key)
            if self.shown and thing:
                thing.hide_set(True)
            if self.lonely:
                remove_world(bpy.context)
        except (ReferenceError, RuntimeError):
            pass  # an undo step has already removed it
