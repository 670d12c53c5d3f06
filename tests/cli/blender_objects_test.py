#!/usr/bin/python3
"""The Blender add-on with objects as artists have them: in libraries, on armatures, with long names; and where nothing can be written.

Environment: as blender_test.py.
"""
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


if __name__ == "__main__":
    skipping.main()
