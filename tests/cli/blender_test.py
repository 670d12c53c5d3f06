#!/usr/bin/python3
"""Blender itself with the two files of tools/blender: breaking objects, and opening what `sherd fracture` wrote.

Environment: SHERD_BIN the program; BLENDER_BIN Blender 3.4 or later, if it is not the `blender` in PATH, or a Python that
has the module bpy.  Without Blender all is skipped.  Needs Debian's python3-numpy.

Blender runs without a window here, so this does not see: the panel, the click of a blow under the mouse (what the
click finds is tested with a view of its own), and Esc.
"""
import itertools
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

import skipping
from appearance_test import png
from cli_test import SHERD, sphere, write_obj
from manifests import check_below
from ply_file import read_triangles

BLENDER = shutil.which(os.environ.get("BLENDER_BIN", "blender"))
IS_PYTHON = BLENDER is not None and pathlib.Path(BLENDER).name.startswith("python")
TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools" / "blender"

# What stands for Blender where it is a module of Python: runs the scripts that Blender's words name.
START = '''
import os, runpy, sys, traceback
words, status = sys.argv[1:], 0
sys.argv = ["blender", *words]
import bpy
try:
    while words and words[0] == "--python":
        runpy.run_path(words[1], run_name="__main__")
        words = words[2:]
except SystemExit as end:
    status = end.code if isinstance(end.code, int) else 1
    print(end.code, file=sys.stderr)
except BaseException:
    traceback.print_exc()
    status = 7
sys.stdout.flush()
sys.stderr.flush()
os._exit(status)
'''

# Runs in Blender before every script.
PRELUDE = '''
import json, os, sys
import bpy, numpy as np
SHERD, OUT = sys.argv[sys.argv.index("--") + 1:][:2]

def answer(**facts):
    with open(OUT, "w") as file:
        json.dump(facts, file, default=lambda thing: np.asarray(thing).tolist())

def world(thing):
    """Places [n, 3], triangles [m, 3], of which polygon each is: of the mesh as modifiers leave it."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    at = np.array([evaluated.matrix_world @ v.co for v in mesh.vertices]).reshape(-1, 3)
    triangles = np.array([t.vertices[:] for t in mesh.loop_triangles]).reshape(-1, 3)
    evaluated.to_mesh_clear()
    return at, triangles

def measures(thing):
    """Box, volume, center of mass, and whether each edge is used once in each direction."""
    at, triangles = world(thing)
    a, b, c = (at[triangles[:, k]] for k in range(3))
    six = np.einsum("ij,ij->i", a, np.cross(b, c))
    edges = [(t[i], t[(i + 1) % 3]) for t in triangles.tolist() for i in range(3)]
    return {"name": thing.name, "low": at.min(axis=0), "high": at.max(axis=0), "volume": six.sum() / 6,
            "center": (six[:, None] * (a + b + c)).sum(axis=0) / (4 * six.sum()),
            "closed": len(set(edges)) == len(edges) and {(b, a) for a, b in edges} == set(edges)}

def look(thing):
    mesh, body = thing.data, thing.rigid_body
    neighbor = np.array([f.value for f in mesh.attributes["neighbor"].data])
    return {**measures(thing), "location": thing.location[:], "materials": [m.name for m in mesh.materials],
            "neighbor": neighbor, "material_index": [p.material_index for p in mesh.polygons],
            "area": [p.area for p in mesh.polygons], "middles": [thing.matrix_world @ p.center for p in mesh.polygons],
            "collections": sorted(c.name for c in thing.users_collection), "flawed": mesh.validate(),
            "body": body and [body.type, body.collision_shape, body.mass],
            "properties": {k: v for k, v in thing.items()}}

def refused(**options):
    """What the operator says instead of working."""
    try:
        bpy.ops.object.sherd_fracture(**options)
    except RuntimeError as error:
        return str(error)
    return "not refused"

def only(thing):
    bpy.ops.object.select_all(action="DESELECT")
    thing.select_set(True)
    bpy.context.view_layer.objects.active = thing
'''
ADDON = '''
bpy.ops.preferences.addon_enable(module="sherd_fracture")
preferences = bpy.context.preferences.addons["sherd_fracture"].preferences
preferences.binary = SHERD
cube = bpy.data.objects["Cube"]
'''


@skipping.skip_unless(BLENDER, "BLENDER", "no Blender here (BLENDER_BIN)")
class Blender(unittest.TestCase):
    def setUp(self):
        self.tmp = pathlib.Path(tempfile.mkdtemp(prefix="sherd-blender-"))
        self.addCleanup(shutil.rmtree, self.tmp)
        self.scratch = self.tmp / "scratch"
        self.scratch.mkdir()
        self.scripts = self.tmp / "scripts"
        (self.scripts / "addons").mkdir(parents=True)
        shutil.copytree(TOOLS / "sherd_fracture", self.scripts / "addons" / "sherd_fracture",
                        ignore=shutil.ignore_patterns("__pycache__"))

    def start(self, *words):
        environment = {**os.environ, "BLENDER_USER_SCRIPTS": str(self.scripts), "TMPDIR": str(self.scratch),
                       "BLENDER_USER_RESOURCES": str(self.tmp / "profile")}
        begin = [BLENDER, "-b", "--factory-startup", "--python-exit-code", "7"]
        if IS_PYTHON:
            (self.tmp / "start.py").write_text(START)
            begin = [BLENDER, self.tmp / "start.py"]
        return subprocess.run([*begin, *map(str, words)], capture_output=True, text=True, timeout=300, env=environment)

    def fake(self, name, text):
        """A program in place of sherd: lines of a shell."""
        path = self.tmp / name
        path.write_text("#!/bin/sh\n" + text + "\n")
        path.chmod(0o755)
        return path

    def blender(self, script, *more):
        """What a script reports."""
        (self.tmp / "script.py").write_text(PRELUDE + script)
        out = self.tmp / "reported.json"
        out.unlink(missing_ok=True)
        done = self.start("--python", self.tmp / "script.py", "--", os.path.abspath(SHERD), out, *more)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotIn("Traceback", done.stdout + done.stderr)
        left = [path.name for path in self.scratch.iterdir() if path.name.startswith("sherd")]
        self.assertEqual(left, [], "temporary folders must go")
        return json.loads(out.read_text())


class AddOn(Blender):
    def run_addon(self, script, *more):
        return self.blender(ADDON + script, *more)

    def assert_fragments(self, reported, density=None):
        """What holds for all fragments of one object, whatever the object."""
        pieces = reported["pieces"]
        numbers = {f["properties"]["sherd_fragment"]: f for f in pieces}
        faced = {}
        for f in pieces:
            self.assertTrue(f["closed"], f["name"])
            self.assertFalse(f["flawed"], f["name"])
            size = max(np.subtract(f["high"], f["low"]))
            np.testing.assert_allclose(f["location"], f["center"], atol=1e-4 * size)
            self.assertAlmostEqual(f["volume"] / f["properties"]["sherd_volume"], 1, delta=1e-4)
            neighbor, area = np.array(f["neighbor"]), np.array(f["area"])
            for other in np.unique(neighbor[neighbor > 0]):
                faced[f["properties"]["sherd_fragment"], int(other)] = area[neighbor == other].sum()
            if density is not None:
                kind, shape, mass = f["body"]
                self.assertEqual((kind, shape), ("ACTIVE", "CONVEX_HULL"))
                self.assertAlmostEqual(mass / (density * f["volume"]), 1, delta=1e-4)
        self.assertAlmostEqual(sum(f["properties"]["sherd_share"] for f in pieces), 1, places=6)
        for (one, other), area in faced.items():  # what they share they share on both sides
            self.assertIn(other, numbers)
            self.assertAlmostEqual(faced[other, one] / area, 1, delta=1e-4)
        return pieces

    def test_installs_from_an_archive(self):
        archive = shutil.make_archive(str(self.tmp / "sherd_fracture"), "zip", TOOLS, "sherd_fracture")
        shutil.rmtree(self.scripts / "addons" / "sherd_fracture")
        reported = self.blender(f'''
bpy.ops.preferences.addon_install(filepath={archive!r}, overwrite=True)
bpy.ops.preferences.addon_enable(module="sherd_fracture")
here = hasattr(bpy.types.Scene, "sherd") and "VIEW3D_PT_sherd" in dir(bpy.types)
settings = set(bpy.context.scene.sherd.__class__.__annotations__) | set(dir(bpy.context.scene.sherd))
bpy.ops.preferences.addon_disable(module="sherd_fracture")
answer(here=here, settings=sorted(settings), gone=not hasattr(bpy.types.Scene, "sherd"))
''')
        self.assertTrue(reported["here"] and reported["gone"])
        self.assertLessEqual({"pieces", "resolution", "seed", "roughness", "wear", "growth", "impact", "density"},
                             set(reported["settings"]))

    def test_default_cube(self):
        kept = self.tmp / "kept"
        reported = self.run_addon('''
result = bpy.ops.object.sherd_fracture(pieces=6, resolution=48, seed=3, density=2500, folder=sys.argv[-1])
pieces = bpy.context.selected_objects
answer(result=list(result), pieces=[look(p) for p in pieces], hidden=cube.hide_get() and cube.hide_render,
     co=[world(p)[0] for p in pieces], faces=[world(p)[1] for p in pieces],
     inside_of=[c.name for c in bpy.data.collections["Collection"].children])
''', kept)
        self.assertEqual(reported["result"], ["FINISHED"])
        pieces = self.assert_fragments(reported, density=2500)
        self.assertEqual([f["name"] for f in pieces], [f"Cube_00{i}" for i in range(1, 7)])
        self.assertTrue(reported["hidden"])
        self.assertIn("Cube", reported["inside_of"])
        self.assertLess(abs(sum(f["volume"] for f in pieces) - 8), 0.04)
        np.testing.assert_allclose(np.min([f["low"] for f in pieces], axis=0), -1, atol=1e-3)
        np.testing.assert_allclose(np.max([f["high"] for f in pieces], axis=0), 1, atol=1e-3)
        manifest = json.loads((kept / "manifest.json").read_text())
        for f, says, co, faces in zip(pieces, manifest["fragments"], reported["co"], reported["faces"]):
            self.assertEqual(f["collections"], ["Cube", "RigidBodyWorld"])
            self.assertEqual(f["materials"], ["Material", "Sherd inside"])
            self.assertEqual([f["properties"][k] for k in ("sherd_fragment", "sherd_volume", "sherd_share")],
                             [says["id"], says["volume"], says["share"]])
            self.assertEqual(f["properties"]["sherd_folder"], str(kept))
            at, triangles, neighbor = read_triangles(kept / says["files"]["mesh"])
            np.testing.assert_allclose(co, at, atol=3e-7)  # in place, but for single precision
            self.assertEqual(set(map(tuple, np.array(triangles)[neighbor > 0].tolist())) - set(map(tuple, faces)), set())
            self.assertEqual(len(faces), len(triangles))  # those outside may be parts of quadrilaterals
            neighbor = np.array(f["neighbor"])
            np.testing.assert_array_equal(f["material_index"], neighbor > 0)
            skin = np.abs(np.abs(f["middles"]).max(axis=1) - 1)
            self.assertLess(skin[neighbor == 0].max(), 1e-6)  # of the cube's surface

    def test_suzanne_breaks_as_she_is_and_remeshed(self):
        """Turned, scaled, mirrored, and through a modifier."""
        reported = self.run_addon('''
bpy.ops.mesh.primitive_monkey_add(location=(3, -2, 1), rotation=(0.4, 0.3, 2.0), scale=(0.5, -0.7, 1.2))
monkey = bpy.context.active_object
bpy.context.view_layer.update()
bpy.ops.object.sherd_fracture(pieces=5, resolution=48, seed=1, original="KEEP", rigid_body=False)
plain = [look(p) for p in bpy.context.selected_objects]
bpy.ops.object.select_all(action="DESELECT")
monkey.select_set(True)
bpy.context.view_layer.objects.active = monkey
remesh = monkey.modifiers.new("Remesh", "REMESH")
remesh.mode, remesh.voxel_size = "VOXEL", 0.06
bpy.context.view_layer.update()
whole = measures(monkey)
bpy.ops.object.sherd_fracture(pieces=5, resolution=48, seed=1, roughness=0.5, original="KEEP", rigid_body=False)
answer(plain=plain, whole=whole, pieces=[look(p) for p in bpy.context.selected_objects],
     hidden=monkey.hide_get() or monkey.hide_render, world=bpy.context.scene.rigidbody_world is not None)
''')
        self.assertEqual(len(reported["plain"]), 5)  # open by 42 edges at the eyes
        self.assertTrue(all(f["closed"] for f in reported["plain"]))
        whole, pieces = reported["whole"], self.assert_fragments(reported)
        self.assertTrue(whole["closed"])
        self.assertEqual(len(pieces), 5)
        self.assertEqual((reported["hidden"], reported["world"]), (False, False))
        self.assertIsNone(pieces[0]["body"])
        voxel = max(np.subtract(whole["high"], whole["low"])) / 48
        np.testing.assert_allclose(np.min([f["low"] for f in pieces], axis=0), whole["low"], atol=voxel / 2)
        np.testing.assert_allclose(np.max([f["high"] for f in pieces], axis=0), whole["high"], atol=voxel / 2)
        self.assertAlmostEqual(sum(f["volume"] for f in pieces) / abs(whole["volume"]), 1, delta=0.03)

    def test_texture_colors_and_materials_stay(self):
        """A textured ball, mirrored, whose texture coordinates and colors are known from the place."""
        vertices, triangles = sphere(24, 48)
        (self.tmp / "checker.png").write_bytes(png(np.uint8(255 * np.indices((64, 64, 3))[:2].sum(axis=0) // 8 % 2)))
        lines = ["mtllib ball.mtl", "o Ball", *(f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices),
                 *(f"vt {(x + 1) / 2:.9g} {(y + 1) / 2:.9g}" for x, y, z in vertices)]
        for name, part in (("checkered", [t for t in triangles if vertices[t[0]][2] >= 0]),
                           ("plain one", [t for t in triangles if vertices[t[0]][2] < 0])):
            lines += [f"usemtl {name}", *("f " + " ".join(f"{i + 1}/{i + 1}" for i in t) for t in part)]
        (self.tmp / "ball.obj").write_text("\n".join(lines) + "\n")
        (self.tmp / "ball.mtl").write_text("newmtl checkered\nKd 1 1 1\nmap_Kd checker.png\n"
                                           "newmtl plain one\nKd 0.2 0.4 0.6\n")
        reported = self.run_addon('''
bpy.ops.wm.obj_import(filepath=sys.argv[-1], forward_axis="Y", up_axis="Z")
ball = bpy.context.active_object
paint = ball.data.color_attributes.new("paint", "FLOAT_COLOR", "CORNER")
for corner, loop in zip(paint.data, ball.data.loops):
    at = ball.data.vertices[loop.vertex_index].co
    corner.color_srgb = (*(0.5 + 0.4 * x for x in at), 1)
ball.data.color_attributes.active_color = paint
ball.scale.x = -1
bpy.context.view_layer.update()
only(ball)
materials, images = len(bpy.data.materials), len(bpy.data.images)
bpy.ops.object.sherd_fracture(pieces=4, resolution=48)
pieces = bpy.context.selected_objects
more = []
for p in pieces:
    mesh, corner = p.data, np.array([loop.vertex_index for loop in p.data.loops])
    at = world(p)[0]
    more.append({"same": [m == ball.data.materials[i] for i, m in enumerate(mesh.materials[:2])],
                 "texture": [n.image.size[:] for n in mesh.materials[0].node_tree.nodes if n.type == "TEX_IMAGE"],
                 "uv": [d.uv[:] for d in mesh.uv_layers.active.data], "layers": [u.name for u in mesh.uv_layers],
                 "corner": at[corner], "corners": [p.loop_total for p in mesh.polygons],
                 "paint": [c.color_srgb[:3] for c in mesh.color_attributes["paint"].data]})
answer(pieces=[look(p) for p in pieces], more=more, materials=len(bpy.data.materials) - materials,
     images=len(bpy.data.images) - images, layer=ball.data.uv_layers.active.name)
''', self.tmp / "ball.obj")
        self.assertEqual((reported["materials"], reported["images"]), (1, 0))  # but for the inside, nothing is copied
        for f, more in zip(self.assert_fragments(reported), reported["more"]):
            self.assertEqual(f["materials"], ["checkered", "plain one", "Sherd inside"])
            self.assertEqual((more["same"], more["texture"]), ([True, True], [[64, 64]]))
            self.assertEqual(more["layers"], [reported["layer"]])
            neighbor, index = np.array(f["neighbor"]), np.array(f["material_index"])
            self.assertTrue((index[neighbor > 0] == 2).all())
            height = np.array(f["middles"])[:, 2]
            self.assertTrue((index[(neighbor == 0) & (height > 0.15)] == 0).all())
            self.assertTrue((index[(neighbor == 0) & (height < -0.15)] == 1).all())
            outer = np.repeat(neighbor == 0, more["corners"])
            corner = np.array(more["corner"]) * [-1, 1, 1]
            np.testing.assert_allclose(np.array(more["uv"])[outer], (corner[outer, :2] + 1) / 2, atol=1e-5)
            # Linear light is interpolated, within a triangle of 0.14: that much sRGB is not linear in the place.
            np.testing.assert_allclose(np.array(more["paint"])[outer], 0.5 + 0.4 * corner[outer], atol=0.02)

    def test_impact_at_the_cursor(self):
        reported = self.run_addon('''
def centers(**options):
    only(cube)
    bpy.ops.object.sherd_fracture(pieces=12, resolution=48, seed=2, original="KEEP", rigid_body=False, **options)
    return [p.location[:] for p in bpy.context.selected_objects]

bpy.context.scene.cursor.location = (1, 1, 1)
plain = centers()
cursor = centers(impact="CURSOR", impact_pieces=9, impact_spread=0.15)
clicked = centers(impact="MOUSE", impact_pieces=9, impact_spread=0.15, impact_point=(1, 1, 1))
only(cube)
answer(plain=plain, cursor=cursor, clicked=clicked, without=refused(impact="MOUSE"),
     many=refused(pieces=4, impact="CURSOR", impact_pieces=9))
''')
        near = {name: sum(np.linalg.norm(np.subtract(reported[name], 1), axis=1) < 1) for name in ("plain", "cursor")}
        self.assertEqual([len(reported[name]) for name in ("plain", "cursor", "clicked")], [12, 12, 12])
        self.assertGreaterEqual(near["cursor"], near["plain"] + 4, near)
        self.assertEqual(reported["clicked"], reported["cursor"])
        self.assertRegex(reported["without"], "^Error: an impact under the mouse needs a click in a 3D view")
        self.assertRegex(reported["many"], "^Error: .*9")

    def test_the_ray_under_the_mouse(self):
        """A view from above, 200 by 100 pixels for 8 by 4 units about (1, 0), of a turned and scaled cube."""
        reported = self.run_addon('''
import types, math, mathutils, sherd_fracture
region = types.SimpleNamespace(width=200, height=100)
view = mathutils.Matrix.Translation((-1, 0, -10))
lens = mathutils.Matrix(((1 / 4, 0, 0, 0), (0, 1 / 2, 0, 0), (0, 0, -1 / 50, 0), (0, 0, 0, 1)))
seen = types.SimpleNamespace(is_perspective=False, view_matrix=view, window_matrix=lens, view_perspective="ORTHO",
                             perspective_matrix=lens @ view)
cube.location, cube.scale, cube.rotation_euler = (1, 1, 0.5), (0.5, 0.25, 2), (0, 0, math.pi / 2)
bpy.context.view_layer.update()
spot = lambda x, y: sherd_fracture.targets.point_under(bpy.context, region, seen, (x, y), cube)
answer(hit=spot(100, 75)[:], beside=spot(150, 75))
''')
        np.testing.assert_allclose(reported["hit"], [1, 1, 2.5], atol=1e-5)
        self.assertIsNone(reported["beside"])

    def test_fragments_break_again(self):
        reported = self.run_addon('''
bpy.ops.object.sherd_fracture(pieces=3, resolution=32)
first = bpy.context.active_object
before = measures(first)
only(first)
bpy.ops.object.sherd_fracture(pieces=4, resolution=32, seed=5)
answer(pieces=[look(p) for p in bpy.context.selected_objects], before=before,
     collections={c.name: sorted(k.name for k in c.children) for c in bpy.data.collections},
     moving=sorted(o.name for o in bpy.context.scene.rigidbody_world.collection.objects), hidden=first.hide_get())
''')
        pieces = self.assert_fragments(reported)
        names = [f"Cube_001_00{i}" for i in range(1, 5)]
        self.assertEqual([f["name"] for f in pieces], names)
        self.assertEqual(reported["collections"]["Cube"], ["Cube glue", "Cube_001"])
        self.assertEqual(reported["moving"], ["Cube_001_001", "Cube_001_002", "Cube_001_003", "Cube_001_004",
                                          "Cube_002", "Cube_003"])  # not the hidden one in their midst
        self.assertTrue(reported["hidden"])
        self.assertAlmostEqual(sum(f["volume"] for f in pieces) / reported["before"]["volume"], 1, delta=0.02)
        for f in pieces:
            self.assertEqual(f["materials"], ["Material", "Sherd inside"])
            self.assertEqual(f["properties"]["sherd_source"], "Cube_001")

    def test_one_undo_takes_it_back(self):
        """Scripts push no undo steps unless asked to: the second argument of the operator does what a window does."""
        reported = self.run_addon('''
def scene():
    return {"objects": sorted(bpy.data.objects.keys()), "meshes": sorted(bpy.data.meshes.keys()),
            "collections": sorted(bpy.data.collections.keys()), "hidden": bpy.data.objects["Cube"].hide_get(),
            "world": bpy.context.scene.rigidbody_world is not None}

bpy.ops.ed.undo_push(message="before")
before = scene()
bpy.ops.object.sherd_fracture("EXEC_DEFAULT", True, pieces=3, resolution=32)
broken = scene()
bpy.ops.ed.undo()
undone = scene()
bpy.ops.ed.redo()
answer(before=before, broken=broken, undone=undone, redone=scene())
''')
        self.assertIn("Cube_003", reported["broken"]["objects"])
        self.assertTrue(reported["broken"]["world"])
        self.assertEqual(reported["undone"], reported["before"])
        self.assertEqual(reported["redone"], reported["broken"])

    def test_fragments_fall_and_do_not_burst(self):
        """Without glue: neighbors touch, and hulls overlap a little, so without gravity a broken cube parts by less than its
        side in a second, and not at all where the fragments rest until hit.  With gravity they fall.
        """
        reported = self.run_addon('''
bpy.ops.object.sherd_fracture(pieces=6, resolution=48, glue=False)
pieces, scene = bpy.context.selected_objects, bpy.context.scene
def places(frames):
    for f in range(1, frames + 1):
        scene.frame_set(f)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return np.array([p.evaluated_get(depsgraph).matrix_world.translation for p in pieces])
scene.use_gravity = False
parted = places(1), places(24)
scene.use_gravity = True
fallen = places(1), places(13)
for p in pieces:
    bpy.data.objects.remove(p)
scene.use_gravity = False
cube.hide_set(False)
only(cube)
bpy.ops.object.sherd_fracture(pieces=6, resolution=48, asleep=True, glue=False)
pieces = bpy.context.selected_objects
answer(parted=parted, fallen=fallen, asleep=(places(1), places(24)))
''')
        before, after = map(np.array, reported["parted"])
        self.assertLess(np.linalg.norm(after - before, axis=1).max(), 1)
        before, after = map(np.array, reported["fallen"])  # half a second at 24 frames a second
        np.testing.assert_allclose((after - before)[:, 2].mean(), -9.81 / 2 * 0.5 ** 2, atol=0.1)
        np.testing.assert_allclose(*reported["asleep"], atol=1e-5)

    def test_refusals_are_sentences(self):
        self.fake("interrupted", "kill -INT $$")
        self.fake("slow", "exec sleep 60")
        self.fake("crash", "kill -SEGV $$")
        self.fake("empty", "exit 0")
        self.fake("dumb", "exit 9")
        (self.tmp / "plain.txt").write_text("no program")
        (self.tmp / "taken").mkdir()
        (self.tmp / "taken" / "mine.txt").write_text("x")
        reported = self.run_addon('''
import pathlib, time
folder = pathlib.Path(sys.argv[-1])
before = sorted(bpy.data.objects.keys()), sorted(bpy.data.meshes.keys()), sorted(bpy.data.collections.keys())
reported = {}
def program(name):
    preferences.binary = str(folder / name)
    return refused(resolution=32)
for name in ("absent", "plain.txt", "interrupted", "crash", "empty", "dumb"):
    reported[name] = program(name)
preferences.timeout = 1
started = time.monotonic()
reported["slow"] = program("slow")
reported["waited"] = time.monotonic() - started
preferences.timeout = 600
preferences.binary, path = "", os.environ["PATH"]
os.environ["PATH"] = str(folder)
reported["not in PATH"] = refused()
os.environ["PATH"] = path
preferences.binary = SHERD
reported["folder"] = refused(resolution=32, folder=str(folder / "taken"))
bpy.ops.object.select_all(action="DESELECT")
reported["nothing"] = refused()
only(bpy.data.objects["Light"])
reported["light"] = refused()
only(cube)
bpy.ops.object.mode_set(mode="EDIT")
reported["edit"] = refused()
bpy.ops.object.mode_set(mode="OBJECT")
after = sorted(bpy.data.objects.keys()), sorted(bpy.data.meshes.keys()), sorted(bpy.data.collections.keys())
empty = bpy.data.objects.new("Void", bpy.data.meshes.new("Void"))
bpy.context.collection.objects.link(empty)
only(empty)
reported["faceless"] = refused()
answer(same=before == after, **reported)
''', self.tmp)
        self.assertTrue(reported.pop("same"))
        self.assertLess(reported.pop("waited"), 10)
        path = "Edit > Preferences > Add-ons > Sherd Fracture"
        for case, says in {
                "absent": path, "plain.txt": path, "not in PATH": "program 'sherd' not found.*" + path,
                "interrupted": "breaking Cube was interrupted", "crash": "signal 11",
                "empty": "no manifest.json", "dumb": "status 9", "slow": "time limit",
                "folder": "taken", "nothing": "nothing is selected", "light": "Light is of type light, not a mesh",
                "edit": "Cube is in edit mode", "faceless": "Void has no faces"}.items():
            with self.subTest(case):
                self.assertRegex(reported[case], "^Error: .*" + says)
                self.assertEqual(len(reported[case].strip().splitlines()), 1, reported[case])
                self.assertNotIn(str(self.scratch), reported[case])


class Import(Blender):
    """import_sherd.py and Blender's own readers on a ball in three pieces, at 48 voxels."""

    @classmethod
    def setUpClass(cls):
        cls.made = pathlib.Path(tempfile.mkdtemp(prefix="sherd-blender-import-"))
        cls.addClassCleanup(shutil.rmtree, cls.made)
        write_obj(cls.made / "ball.obj", sphere(24, 48, center=(2.0, 3.0, 5.0), radius=1.5))
        cls.dir = cls.made / "pieces"
        subprocess.run([SHERD, "fracture", cls.made / "ball.obj", "-o", cls.dir, "--pieces", "3", "--resolution", "48",
                        "--write", "vdb,mesh", "--mesh-format", "ply,glb,obj", "--quiet"], check=True, timeout=120)
        check_below(cls.dir)
        cls.manifest = json.loads((cls.dir / "manifest.json").read_text())
        cls.voxel = cls.manifest["grid"]["voxel_size"]

    def bring(self, script, *options, folder=None):
        """Runs import_sherd.py, which reads the words behind `--`, and then a script."""
        (self.tmp / "script.py").write_text(PRELUDE.replace('sys.argv[sys.argv.index("--") + 1:][:2]',
                                                            f'"", {str(self.tmp / "reported.json")!r}') + script)
        done = self.start("--python", TOOLS / "import_sherd.py", "--python", self.tmp / "script.py", "--",
                          folder or self.dir, *options)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads((self.tmp / "reported.json").read_text())

    def test_exact_pieces_keep_polygons_and_normals(self):
        """A cube of 6 x 16 quads, whose normals lean by a quarter to (1, 1, 1) on all sides."""
        numbers, faces = {}, []
        for axis in range(3):
            for side in (0, 4):
                for u, v in itertools.product(range(4), repeat=2):
                    quad = [(u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)]
                    at = [tuple(np.roll((side, *corner), axis)) for corner in (quad if side else quad[::-1])]
                    faces.append((2 * axis + side // 4, [numbers.setdefault(p, len(numbers) + 1) for p in at]))
        normals = [np.roll((side, 0, 0), axis) + 0.25 for axis in range(3) for side in (-1, 1)]
        normals = [n / np.linalg.norm(n) for n in normals]
        with open(self.tmp / "cube.obj", "w") as file:
            file.writelines("v %d %d %d\n" % p for p in numbers)
            file.writelines("vn %.9g %.9g %.9g\n" % tuple(n) for n in normals)
            file.writelines("f " + " ".join(f"{v}//{side + 1}" for v in quad) + "\n" for side, quad in faces)
        subprocess.run([SHERD, "fracture", self.tmp / "cube.obj", "-o", self.tmp / "cube", "--pieces", "2", "--resolution", "48", "--surface", "exact",
                        "--write", "mesh", "--mesh-format", "ply,obj", "--quiet"], check=True, timeout=120)
        reported = self.bring('''
pieces = [o for o in bpy.data.objects if o.type == "MESH"]
answer(ply=[{**measures(o), "corners": [p.loop_total for p in o.data.polygons]} for o in pieces])
''', folder=self.tmp / "cube")
        wholes = [t["corners"].count(4) for t in reported["ply"]]
        self.assertTrue(all(t["closed"] for t in reported["ply"]))
        self.assertAlmostEqual(sum(t["volume"] for t in reported["ply"]), 64, delta=1e-3)
        self.assertGreater(sum(wholes), 40)
        loops = self.blender('''
found = []
for path in sys.argv[-2:]:
    bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z")
    mesh = bpy.context.selected_objects[0].data
    if bpy.app.version < (4, 1, 0):
        mesh.calc_normals_split()
    normals = [n.normal[:] for n in mesh.loops] if bpy.app.version < (4, 1, 0) else [n.vector[:] for n in mesh.corner_normals]
    found.append([(len(p.loop_indices), p.normal[:], normals[l]) for p in mesh.polygons for l in p.loop_indices
                  if max(map(abs, p.normal)) > 0.9999])
answer(loops=found)
''', *sorted((self.tmp / "cube" / "meshes").glob("*.obj")))["loops"]
        self.assertEqual([sum(corners == 4 for corners, *_ in piece) / 4 for piece in loops], wholes)
        for _, flat, normal in itertools.chain(*loops):
            expected = np.round(flat) + 0.25
            self.assertLess(np.abs(normal - expected / np.linalg.norm(expected)).max(), 2e-3)  # Blender stores 16 bits

    def test_meshes_lie_where_they_were(self):
        reported = self.bring('''
things = [o for o in bpy.data.objects if o.type == "MESH"]
answer(things=[{**measures(o), "at": world(o)[0], "materials": [m.name for m in o.data.materials],
              "neighbor": [f.value for f in o.data.attributes["neighbor"].data], "id": o["sherd_fragment"],
              "material_index": [p.material_index for p in o.data.polygons],
              "in": [c.name for c in o.users_collection]} for o in things])
''', "-o", self.tmp / "out.blend")
        self.assertEqual([t["name"] for t in reported["things"]], ["ball_001", "ball_002", "ball_003"])
        for t, says in zip(reported["things"], self.manifest["fragments"]):
            at, _, neighbor = read_triangles(self.dir / says["files"]["mesh"][0])
            np.testing.assert_array_equal(np.float32(t["at"]), np.float32(at))
            np.testing.assert_array_equal(t["neighbor"], neighbor)
            np.testing.assert_array_equal(t["material_index"], neighbor > 0)
            self.assertEqual((t["materials"], t["in"], t["id"]), (["outside", "inside"], ["ball"], says["id"]))
            self.assertTrue(t["closed"])
        self.assertGreater((self.tmp / "out.blend").stat().st_size, 10000)

    def test_other_mesh_formats_lie_there_too(self):
        for kind in (".glb", ".obj"):
            with self.subTest(kind):
                folder = self.tmp / kind
                shutil.copytree(self.dir, folder)
                manifest = json.loads(json.dumps(self.manifest))
                for f in manifest["fragments"]:
                    f["files"]["mesh"] = next(m for m in f["files"]["mesh"] if m.endswith(kind))
                (folder / "manifest.json").write_text(json.dumps(manifest))
                reported = self.bring('''
answer(things=[{**measures(o), "materials": [m.name for m in o.data.materials]} for o in bpy.data.objects
             if o.type == "MESH"], materials=sorted(m.name for m in bpy.data.materials if m.users))
''', folder=folder)
                for t, says in zip(reported["things"], manifest["fragments"]):
                    np.testing.assert_allclose(t["low"], says["bbox"]["min"], atol=1e-5)
                    np.testing.assert_allclose(t["high"], says["bbox"]["max"], atol=1e-5)
                    self.assertEqual(t["materials"], ["outside", "inside"])
                self.assertEqual(len([m for m in reported["materials"] if m.startswith("inside")]), 1)

    def test_up_y_stands_it_up(self):
        reported = self.bring('answer(things=[measures(o) for o in bpy.data.objects if o.type == "MESH"])', "--up", "y")
        for t, says in zip(reported["things"], self.manifest["fragments"]):
            (x, y, z), (high_x, high_y, high_z) = says["bbox"]["min"], says["bbox"]["max"]
            np.testing.assert_allclose(t["low"], [x, -high_z, y], atol=1e-5)
            np.testing.assert_allclose(t["high"], [high_x, -z, high_y], atol=1e-5)

    def test_every_volume_is_an_object_and_meshes_at_zero(self):
        reported = self.bring('''
volumes = [o for o in bpy.data.objects if o.type == "VOLUME"]
grids = []
for o in volumes:
    o.data.grids.load()
    grids.append([(g.name, g.data_type) for g in o.data.grids])
answer(volumes=[o.name for o in volumes], grids=grids, files=[os.path.basename(o.data.filepath) for o in volumes],
     sequences=[o.data.is_sequence for o in volumes], same=[list(map(list, o.matrix_world)) for o in volumes],
     meshes=[{**measures(o), "of": o.parent.name} for o in bpy.data.objects if o.type == "MESH"], version=bpy.app.version[:])
''', "--volumes", "--to-mesh")
        names = ["ball_001", "ball_002", "ball_003"]
        self.assertEqual((reported["volumes"], reported["files"]), (names, [n + ".vdb" for n in names]))
        self.assertEqual(reported["grids"], [[["surface", "FLOAT"]]] * 3)
        self.assertEqual(reported["sequences"], [False] * 3)
        for matrix in reported["same"]:
            np.testing.assert_array_equal(matrix, np.eye(4))
        self.assertEqual([m["of"] for m in reported["meshes"]], names)
        for mesh, says in zip(reported["meshes"], self.manifest["fragments"]):
            self.assertTrue(mesh["closed"])
            self.assertAlmostEqual(mesh["volume"] / says["volume"], 1, delta=0.01)
            # Blender before 5.0 adds half a voxel to every vertex.  What is left over is the mesher's: it rounds corners.
            shift = self.voxel / 2 if reported["version"] < [5, 0, 0] else 0
            self.assertLess(np.abs(np.subtract(mesh["center"], says["centroid"]) - shift).max(), 0.05 * self.voxel)
        low = np.min([m["low"] for m in reported["meshes"]], axis=0)
        high = np.max([m["high"] for m in reported["meshes"]], axis=0)
        np.testing.assert_allclose(low, np.array([0.5, 1.5, 3.5]) + shift, atol=0.25 * self.voxel)
        np.testing.assert_allclose(high, np.array([3.5, 4.5, 6.5]) + shift, atol=0.25 * self.voxel)

    def test_numbered_files_are_an_animation_unless_told_otherwise(self):
        reported = self.blender('''
folder = sys.argv[-1]
files = [{"name": n} for n in sorted(os.listdir(folder))]
def opened(**options):
    before = set(bpy.data.objects)
    bpy.ops.object.volume_import(directory=folder, files=files, **options)
    return [o.data.is_sequence for o in bpy.data.objects if o not in before]
answer(default=opened(), each=opened(use_sequence_detection=False))
''', self.dir / "fragments")
        self.assertEqual(reported, {"default": [True], "each": [False] * 3})

    def test_glb_opens_by_name_with_its_materials(self):
        reported = self.blender('''
if "bool" not in vars(np):
    np.bool = bool  # Blender 3.4's importer asks for a name that numpy 1.24 (Debian 12) has dropped
things = []
for file in sorted(f for f in os.listdir(sys.argv[-1]) if f.endswith(".glb")):
    before = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=os.path.join(sys.argv[-1], file))
    bpy.context.view_layer.update()
    for o in set(bpy.data.objects) - before:
        things.append({**measures(o), "materials": [m.name.split(".")[0] for m in o.data.materials],
                       "attributes": [a.name for a in o.data.attributes]})
answer(things=things)
''', self.dir / "meshes")
        self.assertEqual([t["name"] for t in reported["things"]], ["ball_001", "ball_002", "ball_003"])
        for t, says in zip(reported["things"], self.manifest["fragments"]):
            self.assertEqual(t["materials"], ["outside", "inside"])
            self.assertAlmostEqual(t["volume"] / says["volume"], 1, delta=1e-4)
            (x, y, z), (high_x, high_y, high_z) = says["bbox"]["min"], says["bbox"]["max"]
            np.testing.assert_allclose(t["low"], [x, -high_z, y], atol=1e-5)  # the importer takes y for up
            np.testing.assert_allclose(t["high"], [high_x, -z, high_y], atol=1e-5)

    def test_what_is_no_fracture_is_refused_in_a_sentence(self):
        half = self.tmp / "half"
        shutil.copytree(self.dir, half)
        (half / "fragments" / "ball_002.vdb").unlink()
        for words, says in (([self.tmp], "no manifest.json"), ([half, "--volumes"], "ball_002.vdb: no such file")):
            done = self.start("--python", TOOLS / "import_sherd.py", "--", *words)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(says, done.stderr)
            self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    skipping.main()
