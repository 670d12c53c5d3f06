#!/usr/bin/python3
"""Pieces that the Blender add-on breaks again in the folder of their fracture.

Environment: as blender_test.py.  The oracles are the cube itself, whose texture coordinates are linear in the place, the
volumes of its parts, and the files of pieces that were not broken.
"""
import hashlib
import json
import subprocess

import numpy as np

import blender_test
import skipping

CUBE = '''
import mathutils

def textured():
    """The cube, of two materials, with texture coordinates that are linear in the place."""
    mesh = cube.data
    mesh.materials.clear()
    for name in ("one", "two"):
        mesh.materials.append(bpy.data.materials.new(name))
    for p in mesh.polygons:
        p.material_index = int(p.center.z > 0.5)
    at = np.array([mesh.vertices[l.vertex_index].co[:] for l in mesh.loops])
    mesh.uv_layers[0].data.foreach_set("uv", (at[:, :2] + 2 * at[:, 2:]).ravel())
    only(cube)

def of_folder(folder):
    """The pieces that are shown of the fracture in a folder."""
    return sorted((o for o in bpy.data.objects if o.get("sherd_folder") == folder and o.visible_get()),
                  key=lambda o: o["sherd_fragment"])

def details(thing):
    mesh = thing.data
    uv = mesh.uv_layers[0].data
    return {**look(thing), "level": [a.value for a in mesh.attributes["level"].data],
            "inside": [a.value for a in mesh.attributes["inside"].data], "sides": [len(p.vertices) for p in mesh.polygons],
            "uv": [uv[p.loop_start].uv[:] for p in mesh.polygons], "matrix": [r[:] for r in thing.matrix_world],
            "corner": [(mesh.vertices[p.vertices[0]].co)[:] for p in mesh.polygons]}

def again(thing, **options):
    only(thing)
    bpy.ops.object.sherd_fracture(**{"resolution": 48, "folder": FOLDER, "rigid_body": False, **options})
    return bpy.context.selected_objects[:]

FOLDER = sys.argv[-1]
'''


def digests(folder):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.rglob("*") if path.is_file()}


@skipping.skip_unless(blender_test.BLENDER, "BLENDER", "no Blender here (BLENDER_BIN)")
class Again(blender_test.Blender):
    def run_again(self, script):
        self.kept = self.tmp / "kept"
        return self.blender(blender_test.ADDON + CUBE + script, self.kept)

    def manifest(self):
        return json.loads((self.kept / "manifest.json").read_text())

    def test_the_folder_stays_what_the_scene_shows(self):
        """Ids go on, other pieces' files stay, and what faces the new pieces names them."""
        reported = self.run_again('''
import shutil
textured()
pieces = again(cube, pieces=5)
shutil.copytree(FOLDER, FOLDER + " before")
chosen = of_folder(FOLDER)[1]
before = details(chosen)
again(chosen, pieces=3, seed=4)
third = of_folder(FOLDER)
again(third[-1], pieces=2, seed=9)
answer(before=before, third=[details(o) for o in third if o.name in bpy.data.objects], shown=[details(o) for o in of_folder(FOLDER)])
''')
        manifest = self.manifest()
        self.assertEqual([f["id"] for f in manifest["fragments"]], [*range(1, 9)])
        self.assertEqual([f["properties"]["sherd_fragment"] for f in reported["shown"]], [*range(1, 9)])
        self.assertEqual([entry["fragments"] for entry in manifest["history"]], [5, 7])
        self.assertAlmostEqual(sum(f["volume"] for f in reported["shown"]), 8, delta=1e-5)
        new = [f for f in reported["third"] if f["properties"]["sherd_fragment"] in (2, 6, 7)]
        self.assertAlmostEqual(sum(f["volume"] for f in new) / reported["before"]["volume"], 1, delta=1e-6)
        self.assert_neighbors(reported["shown"], manifest)
        self.assert_is_the_cube_s(reported["third"])
        for f in new:
            neighbor, level = np.array(f["neighbor"]), np.array(f["level"])
            self.assertEqual(set(level[np.isin(neighbor, [2, 6, 7])]), {2})
            self.assertLessEqual(set(level[np.isin(neighbor, [1, 3, 4, 5])]), {1})
            self.assertTrue((level[neighbor == 0] == 0).all())
            self.assertEqual(f["inside"], (neighbor > 0).tolist())
        was, now = digests(self.tmp / "kept before"), digests(self.kept)
        same = {name for name in was if was[name] == now.get(name)}
        vdbs = {f"Cube_00{k}.vdb" for k in (1, 3, 4, 5)}
        self.assertLessEqual(vdbs, same)
        done = subprocess.run([blender_test.SHERD, "evaluate", self.kept, "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def assert_neighbors(self, pieces, manifest):
        """Contacts of the last pieces, 7 and 8, are equal on both sides.  Triangles of others stay whole, so each faces one of
        two: together they share with these what these share with them."""
        faced = np.zeros((9, 9))
        for f in pieces:
            self.assertTrue(f["closed"], f["name"])
            self.assertFalse(f["flawed"], f["name"])
            np.add.at(faced[f["properties"]["sherd_fragment"]], f["neighbor"], f["area"])
        contacts = {(entry["id"], c["id"]) for entry in manifest["fragments"] for c in entry["contacts"] + entry.get("thin_contacts", [])}
        self.assertLessEqual(set(map(tuple, np.argwhere(faced[:, 1:] > 1e-3) + [0, 1])), contacts)
        self.assertAlmostEqual(faced[7, 8], faced[8, 7], delta=1e-5)
        for one in (2, 6):
            self.assertAlmostEqual(faced[one, [7, 8]].sum(), faced[[7, 8], one].sum(), delta=1e-5)
        for one in (1, 3, 4, 5):
            self.assertAlmostEqual(faced[one, [2, 6, 7, 8]].sum(), faced[[2, 6, 7, 8], one].sum(), delta=1e-5)

    def assert_is_the_cube_s(self, pieces):
        """Texture coordinates, materials and whole polygons outside, of pieces that are where they were made."""
        whole = 0
        for f in pieces:
            outside = ~np.array(f["inside"])
            corner = np.array(f["corner"])[outside] + f["location"]
            np.testing.assert_allclose(np.array(f["uv"])[outside], corner[:, :2] + 2 * corner[:, 2:], atol=1e-5)
            names = np.array(f["materials"])[np.array(f["material_index"])]
            top = np.array(f["middles"])[:, 2] > 1 - 1e-5
            self.assertEqual(set(names[outside & top]), {"two"} if (outside & top).any() else set())
            self.assertEqual(set(names[~outside]), {"Sherd inside"})
            whole += sum(n > 3 for n in f["sides"])
        return whole

    def test_a_piece_that_was_moved_breaks_where_it_is(self):
        reported = self.run_again('''
textured()
again(cube, pieces=4)
chosen = of_folder(FOLDER)[2]
chosen.matrix_world = mathutils.Matrix.Translation((5, -3, 1)) @ mathutils.Euler((1, 2, 3)).to_matrix().to_4x4()
bpy.context.view_layer.update()
before = details(chosen)
bpy.context.scene.cursor.location = chosen.matrix_world.translation
parts = again(chosen, pieces=6, impact="CURSOR", impact_pieces=4)
answer(before=before, parts=[details(p) for p in parts])
''')
        before, parts = reported["before"], reported["parts"]
        volume = np.array([p["volume"] for p in parts])
        self.assertAlmostEqual(volume.sum() / before["volume"], 1, delta=1e-5)
        center = volume @ np.array([p["center"] for p in parts]) / volume.sum()
        np.testing.assert_allclose(center, before["center"], atol=1e-5)
        np.testing.assert_allclose(np.min([p["low"] for p in parts], axis=0), before["low"], atol=1e-5)
        np.testing.assert_allclose(np.max([p["high"] for p in parts], axis=0), before["high"], atol=1e-5)
        for p in parts:
            np.testing.assert_allclose(np.array(p["matrix"])[:3, :3], np.array(before["matrix"])[:3, :3], atol=1e-5)
        used = self.manifest()["options"]["seeds"]["impacts"]
        self.assertEqual(len(used), 1)

    def test_what_is_not_as_its_file_is_leaves_the_folder_alone(self):
        """An edited piece, one that is scaled, wear, and a preview: broken as meshes, or elsewhere."""
        reported = self.run_again('''
textured()
again(cube, pieces=4)
state = lambda: open(FOLDER + "/manifest.json").read()
first = state()
one, two, three, four = of_folder(FOLDER)
one.data.vertices[0].co.x += 0.01
two.scale = (2, 1, 1)
kept = {}
for thing, options in ((one, {}), (two, {}), (three, {"wear": 1}), (four, {"preview": True})):
    parts = again(thing, pieces=2, **options)
    kept[thing.name] = [len(parts), [p.get("sherd_folder", "") for p in parts], state() == first]
answer(kept=kept)
''')
        for name in ("Cube_001", "Cube_002", "Cube_003"):
            self.assertEqual(reported["kept"][name], [2, 2 * [str(self.kept / name)], True])
        self.assertEqual(reported["kept"]["Cube_004"], [2, ["", ""], True])

    def test_glue_of_a_moved_piece_is_between_its_pieces(self):
        reported = self.run_again('''
textured()
again(cube, pieces=2)
chosen = of_folder(FOLDER)[0]
chosen.matrix_world = mathutils.Matrix.Translation((5, -3, 1)) @ mathutils.Euler((1, 2, 3)).to_matrix().to_4x4()
bpy.context.view_layer.update()
parts = again(chosen, pieces=6, rigid_body=True)
joints = [o for o in bpy.context.scene.rigidbody_world.constraints.objects if "sherd_area" in o and "sherd_apart" not in o]
answer(parts=[details(p) for p in parts],
       joints=[(o.location[:], o.rigid_body_constraint.object1.name, o.rigid_body_constraint.object2.name) for o in joints])
''')
        boxes = {p["name"]: (np.array(p["low"]), np.array(p["high"])) for p in reported["parts"]}
        self.assertGreaterEqual(len(reported["joints"]), 5)
        for place, *ends in reported["joints"]:
            for end in ends:
                low, high = boxes[end]
                self.assertTrue((low - 1e-4 <= place).all() and (place <= high + 1e-4).all(), (place, end))

    def test_folders_above_stay_as_they_are(self):
        """Pieces of a piece that has a folder of its own, which is in the fracture's."""
        reported = self.run_again('''
import os
textured()
again(cube, pieces=3)
state = lambda folder: open(folder + "/manifest.json").read()
first = state(FOLDER)
homes = []
for _ in range(3):
    parts = again(of_folder(homes[-1] if homes else FOLDER)[0], pieces=2, wear=1)
    homes.append(parts[0]["sherd_folder"])
answer(homes=homes, same=state(FOLDER) == first, there=[os.path.exists(h + "/manifest.json") for h in homes])
''')
        self.assertTrue(reported["same"])
        self.assertEqual(reported["there"], [True] * 3)
        self.assertEqual(len(set(reported["homes"])), 3)

    def test_two_pieces_at_once(self):
        reported = self.run_again('''
textured()
again(cube, pieces=4)
for each in of_folder(FOLDER)[:2]:
    each.select_set(True)
bpy.data.objects["Cube_003"].select_set(False)
bpy.data.objects["Cube_004"].select_set(False)
bpy.ops.object.sherd_fracture(pieces=3, resolution=48, folder=FOLDER)
answer(shown=[details(o) for o in of_folder(FOLDER)])
''')
        self.assertEqual([f["properties"]["sherd_fragment"] for f in reported["shown"]], [*range(1, 9)])
        self.assertEqual([f["id"] for f in self.manifest()["fragments"]], [*range(1, 9)])
        self.assertAlmostEqual(sum(f["volume"] for f in reported["shown"]), 8, delta=1e-5)

    def test_a_refusal_changes_nothing(self):
        reported = self.run_again('''
textured()
again(cube, pieces=4)
one = of_folder(FOLDER)[0]
state = lambda: open(FOLDER + "/manifest.json").read()
first = state()
only(one)
said = refused(pieces=60000, folder=FOLDER)
same = state() == first and one.visible_get()
open(FOLDER + "/labels.rle", "wb").write(b"damaged")
damaged = refused(pieces=2, folder=FOLDER)
answer(said=said, same=same, damaged=damaged, shown=one.visible_get(), kept=state() == first)
''')
        self.assertTrue(reported["same"] and reported["shown"] and reported["kept"], reported)
        self.assertIn("60000", reported["said"])
        self.assertIn("labels.rle", reported["damaged"])


if __name__ == "__main__":
    skipping.main()
