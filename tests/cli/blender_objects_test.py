#!/usr/bin/python3
"""The Blender add-on with objects as artists have them: in libraries, on armatures, with long names; and where nothing can be written.

Environment: as blender_test.py.
"""
import math
import unittest

import numpy as np

import blender_test
import skipping

PRELUDE = blender_test.ADDON + '''
def run(**options):
    bpy.ops.object.sherd_fracture(**{"pieces": 3, "resolution": 24, **options})
    return sorted(bpy.context.selected_objects, key=lambda p: p.name)
'''


@skipping.skip_unless(blender_test.BLENDER, "BLENDER", "no Blender here (BLENDER_BIN)")
class Objects(blender_test.Blender):
    def run_addon(self, script, *more):
        return self.blender(PRELUDE + script, *more)

    def test_an_object_of_a_library_beside_a_local_one_of_its_name(self):
        """The selected one is broken, 5 to the right and half as large."""
        reported = self.run_addon('''
path = sys.argv[-1]
cube.location, cube.scale = (5, 0, 0), (0.5, 0.5, 0.5)
bpy.data.libraries.write(path, {cube})
cube.location, cube.scale = (0, 0, 0), (1, 1, 1)
with bpy.data.libraries.load(path, link=True) as (there, here):
    here.objects = ["Cube"]
linked = here.objects[0]
bpy.context.scene.collection.objects.link(linked)
bpy.context.view_layer.update()
only(linked)
pieces = run()
answer(pieces=[measures(p) for p in pieces], hidden=[linked.hide_get(), cube.hide_get()], names=[linked.name, cube.name])
''', self.tmp / "library.blend")
        self.assertEqual(reported["names"], ["Cube", "Cube"])
        self.assertEqual(reported["hidden"], [True, False])
        np.testing.assert_allclose(np.min([p["low"] for p in reported["pieces"]], axis=0), [4.5, -0.5, -0.5], atol=1e-5)
        np.testing.assert_allclose(np.max([p["high"] for p in reported["pieces"]], axis=0), [5.5, 0.5, 0.5], atol=1e-5)

    def test_a_bent_arm(self):
        """Bent by an armature, as a modifier and as a parent that deforms: the pieces are as bent as it, and not more."""
        reported = self.run_addon('''
from mathutils import Matrix
def bent(kind):
    bpy.ops.object.select_all(action="DESELECT")
    bpy.ops.object.armature_add(location=(0, 0, 0))
    rig = bpy.context.active_object
    bpy.ops.mesh.primitive_cube_add(location=(0, 0, 1))
    arm = bpy.context.active_object
    arm.vertex_groups.new(name="Bone").add(range(4), 1.0, "REPLACE")
    if kind == "modifier":
        arm.modifiers.new("Armature", "ARMATURE").object = rig
        arm.parent = rig
    else:
        arm.parent, arm.parent_type = rig, "ARMATURE"
    rig.location.x = 3
    rig.pose.bones["Bone"].location = (0.5, 0.25, 0)
    bpy.context.view_layer.update()
    at, _ = world(arm)
    only(arm)
    pieces = run(rigid_body=False)
    bpy.context.view_layer.update()
    parts = [measures(p) for p in pieces]
    rig.location.x = 4  # they follow it
    bpy.context.view_layer.update()
    later = [measures(p) for p in pieces]
    return {"at": at, "pieces": parts, "later": later, "groups": [[g.name for g in p.vertex_groups] for p in pieces]}
answer(modifier=bent("modifier"), parent=bent("parent"))
''')
        for kind, found in reported.items():
            with self.subTest(kind):
                for each, moved in (("pieces", 0), ("later", 1)):
                    low, high = (np.array([p[end] for p in found[each]]) - [moved, 0, 0] for end in ("low", "high"))
                    np.testing.assert_allclose(low.min(axis=0), np.min(found["at"], axis=0), atol=1e-4)
                    np.testing.assert_allclose(high.max(axis=0), np.max(found["at"], axis=0), atol=1e-4)
                self.assertTrue(all("Bone" in names for names in found["groups"]))

    def test_names_that_are_long_or_not_of_ascii(self):
        """As long as this Blender allows, of letters of three bytes."""
        reported = self.run_addon('''
found = []
for name in ("\\u58fa" * 80, "Vase / \\u00e4\\u00f6\\u00fc .ply", "..", "-o"):
    bpy.ops.mesh.primitive_cube_add()
    thing = bpy.context.active_object
    thing.name = name
    pieces = run(glue=True)
    found.append({"name": thing.name, "pieces": [p.name for p in pieces], "glue": [c.name for c in bpy.data.collections if c.get("sherd_glue")]})
answer(found=found)
''')
        for each in reported["found"]:
            self.assertEqual(len(set(each["pieces"])), 3)
            for i, piece in enumerate(each["pieces"]):
                self.assertTrue(piece.endswith(f"_{i + 1:03d}") and each["name"].startswith(piece[:-4]), each)
        self.assertTrue(all(" glue" in name for name in each["glue"]), each["glue"])

    def test_where_nothing_can_be_written(self):
        full = self.tmp / "full"
        full.mkdir()
        reported = self.run_addon('''
import tempfile
tempfile.tempdir = sys.argv[-1] + "/gone"
gone = refused()
tempfile.tempdir = None
unsaved = refused(folder="//kept")
import sherd_fracture
def fail(*_):
    raise OSError(28, "No space left on device")
sherd_fracture.export_mesh.Source.write_ply = fail
answer(gone=gone, unsaved=unsaved, full=refused(), left=sorted(bpy.data.objects.keys()))
''', full)
        self.assertRegex(reported["gone"], "the mesh of Cube cannot be written to .*/gone .No such file")
        self.assertRegex(reported["unsaved"], "relative to the .blend file; save that first")
        self.assertRegex(reported["full"], "the mesh of Cube cannot be written to .* .No space left on device")
        self.assertEqual(reported["left"], ["Camera", "Cube", "Light"])

    def test_a_preview_takes_nothing_of_the_user(self):
        """It keeps no files, and what the user put beside its pieces stays when the next one replaces it."""
        reported = self.run_addon('''
only(cube)
pieces = run(preview=True, folder=sys.argv[-1])
light = bpy.data.objects["Light"]
home = pieces[0].users_collection[0]
home.objects.link(light)
for c in list(light.users_collection):
    if c != home:
        c.objects.unlink(light)
only(pieces[0])
run(preview=True, pieces=4)
answer(files=os.path.exists(sys.argv[-1]), light="Light" in bpy.context.scene.objects,
       pieces=len([o for o in bpy.data.objects if "sherd_fragment" in o]))
''', self.tmp / "kept")
        self.assertEqual(reported, {"files": False, "light": True, "pieces": 4})

    def check_sound(self, pieces):
        for piece in pieces:
            self.assertTrue(piece["closed"], piece["name"])
            self.assertEqual(piece["loose"], 1, piece["name"])

    SOUND = '''
import bmesh
def sound(piece):
    """Measures, and the number of its parts once vertices within 1e-5 are merged."""
    b = bmesh.new()
    b.from_mesh(piece.data)
    bmesh.ops.remove_doubles(b, verts=b.verts, dist=1e-5)
    flawed = [e for e in b.edges if len(e.link_faces) != 2]
    left, parts = set(b.verts), 0
    while left:
        parts, reached = parts + 1, [left.pop()]
        for v in reached:
            for e in v.link_edges:
                other = e.other_vert(v)
                if other in left:
                    left.remove(other)
                    reached.append(other)
    report = {**measures(piece), "loose": parts + len(flawed), "triangles": len(piece.data.loop_triangles), "merged": [len(flawed), parts]}
    b.free()
    return report
'''

    def test_nine_cubes_that_touch(self):
        """One object of them: cracks go through all, and no piece falls apart where cubes were stacked."""
        reported = self.run_addon(self.SOUND + '''
cubes = []
for x in range(3):
    for z in range(3):
        bpy.ops.mesh.primitive_cube_add(size=1, location=(x, 0, z))
        cubes.append(bpy.context.active_object)
bpy.ops.object.select_all(action="DESELECT")
for thing in cubes:
    thing.select_set(True)
bpy.ops.object.join()
answer(pieces=[sound(p) for p in run(pieces=12, resolution=48, material="STONE", rigid_body=False)])
''')
        self.assertEqual(len(reported["pieces"]), 12)
        self.check_sound(reported["pieces"])
        self.assertAlmostEqual(sum(p["volume"] for p in reported["pieces"]), 9, delta=1e-4)

    def test_an_open_truck(self):
        """Parts that overlap, some of them open, as games have them: a body, a cab without its back, and tubes for wheels."""
        reported = self.run_addon(self.SOUND + '''
def box(low, high, isOpen):
    b = bmesh.new()
    bmesh.ops.create_cube(b, size=1)
    for v in b.verts:
        v.co = [low[k] if v.co[k] < 0 else high[k] for k in range(3)]
    b.normal_update()
    if isOpen:
        bmesh.ops.delete(b, geom=[f for f in b.faces if f.normal.x < -0.5], context="FACES_ONLY")
    mesh = bpy.data.meshes.new("box")
    b.to_mesh(mesh)
    b.free()
    thing = bpy.data.objects.new("box", mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing
parts = [box((0, 0, 0.5), (4, 2, 2.5), False), box((3.5, 0.1, 0.5), (5.5, 1.9, 1.75), True)]
for x in (1, 4.5):
    for y in (0, 2):
        bpy.ops.mesh.primitive_cylinder_add(vertices=24, radius=0.5, depth=0.4, end_fill_type="NOTHING", location=(x, y, 0.5), rotation=(1.5707963, 0, 0))
        parts.append(bpy.context.active_object)
bpy.ops.object.select_all(action="DESELECT")
for thing in parts:
    thing.select_set(True)
bpy.context.view_layer.objects.active = parts[0]
bpy.ops.object.join()
answer(pieces=[sound(p) for p in run(pieces=8, resolution=96, rigid_body=False)])
''')
        self.assertEqual(len(reported["pieces"]), 8)
        self.check_sound(reported["pieces"])
        box = 4 * 2 * 2 + 2 * 1.8 * 1.25 - 0.5 * 1.8 * 1.25
        wheel = 24 / 2 * math.sin(2 * math.pi / 24) * 0.25 * 0.4  # half of its width lies within the body, above its floor
        self.assertGreater(sum(p["volume"] for p in reported["pieces"]), box)
        self.assertLess(sum(p["volume"] for p in reported["pieces"]), box + 4 * wheel)
        self.assertLess(sum(p["triangles"] for p in reported["pieces"]), 3000)


if __name__ == "__main__":
    skipping.main()
