#!/usr/bin/python3
"""Blender opens what is written for hosts: .vdb files of every layout and packing, and scene.glb.

Environment: as blender_test.py.  Without Blender all is skipped.
"""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

import skipping
from blender_test import Blender
from appearance_test import png
from cli_test import SHERD, sphere, write_obj, write_spread_seeds
from manifests import check_below

PACKED = {"blosc": ["--vdb", "both", "--write", "vdb,fog,solid"], "zip": ["--compress", "zip", "--write", "vdb"],
          "none": ["--compress", "none", "--write", "vdb"], "half": ["--half", "--write", "vdb"]}
PIECES = 4

# Opens every file alone, and meshes its level sets at 0.
OPEN = '''
def of_grid(volume, name):
    mesh = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    bpy.context.scene.collection.objects.link(mesh)
    modifier = mesh.modifiers.new("Volume to Mesh", "VOLUME_TO_MESH")
    modifier.object, modifier.grid_name, modifier.threshold, modifier.adaptivity = volume, name, 0.0, 0.0
    modifier.resolution_mode = "GRID"
    return mesh

reported = {}
for path in sys.argv[sys.argv.index("--") + 3:]:
    data = bpy.data.volumes.new(os.path.basename(path))
    data.filepath, data.is_sequence = path, False
    volume = bpy.data.objects.new(data.name, data)
    bpy.context.scene.collection.objects.link(volume)
    bpy.context.view_layer.update()
    data.grids.load()
    grids = {g.name: g.data_type for g in data.grids}
    surfaces = sorted((n for n in grids if n.startswith("surface")), key=lambda n: (len(n), n))
    reported[path] = {"grids": grids, "surfaces": [measures(of_grid(volume, n)) for n in surfaces]}
answer(files=reported)
'''


def write_textured_obj(path, points, faces, uvs, image, pixels):
    """Writes an OBJ of the material "glaze", its texture image [h, w, 3] beside it, and a UV per point."""
    path.with_name(image).write_bytes(png(pixels))
    path.with_name("look.mtl").write_text(f"newmtl glaze\nKd 1 1 1\nmap_Kd {image}\n")
    with open(path, "w") as file:
        file.write("mtllib look.mtl\nusemtl glaze\n")
        file.writelines(f"v {x} {y} {z}\n" for x, y, z in points)
        file.writelines(f"vt {u} {v}\n" for u, v in uvs)
        file.writelines(f"f {a + 1}/{a + 1} {b + 1}/{b + 1} {c + 1}/{c + 1}\n" for a, b, c in faces)


class HostFiles(Blender):
    @classmethod
    def setUpClass(cls):
        cls.made = pathlib.Path(tempfile.mkdtemp(prefix="sherd-blender-files-"))
        cls.addClassCleanup(shutil.rmtree, cls.made)
        cls.ball = cls.made / "ball.obj"
        write_obj(cls.ball, sphere(24, 48, center=(2.0, 3.0, 5.0), radius=1.5))
        write_spread_seeds(cls.made / "seeds.json", PIECES, center=(2.0, 3.0, 5.0), radius=1.5)

    def fracture(self, folder, mesh, *options):
        subprocess.run([SHERD, "fracture", mesh, "-o", folder, "--resolution", "48", "--quiet", *options],
                       check=True, timeout=120)
        check_below(folder)
        return json.loads((folder / "manifest.json").read_text())

    def test_every_packing_opens_in_place_and_closed(self):
        seeds = ("--seeds", self.made / "seeds.json")
        manifests = {name: self.fracture(self.tmp / name, self.ball, *seeds, *options) for name, options in PACKED.items()}
        single = self.tmp / "blosc" / "fragments.vdb"
        solid = self.tmp / "blosc" / "fragments" / "ball.vdb"
        alone = {name: [str(self.tmp / name / f["files"]["vdb"]) for f in manifests[name]["fragments"]] for name in PACKED}
        reported = self.blender(OPEN, *sum(alone.values(), []), single, solid)["files"]
        voxel = manifests["blosc"]["grid"]["voxel_size"]

        def holds(mesh, says):
            self.assertTrue(mesh["closed"])
            self.assertAlmostEqual(mesh["volume"] / says["volume"], 1, delta=0.01)
            # Blender 3.4 adds half a voxel to every vertex; the mesher rounds corners.
            self.assertLess(np.abs(np.subtract(mesh["center"], says["centroid"]) - voxel / 2).max(), 0.05 * voxel)
            np.testing.assert_allclose(mesh["low"], np.add(says["bbox"]["min"], voxel / 2), atol=voxel)
            np.testing.assert_allclose(mesh["high"], np.add(says["bbox"]["max"], voxel / 2), atol=voxel)

        for name, files in alone.items():
            for path, says in zip(files, manifests[name]["fragments"], strict=True):
                with self.subTest(name, fragment=says["id"]):
                    fog = {"density": "FLOAT"} if name == "blosc" else {}
                    self.assertEqual(reported[path]["grids"], {"surface": "FLOAT", **fog})
                    holds(reported[path]["surfaces"][0], says)
        numbers = range(1, PIECES + 1)
        self.assertEqual(reported[str(single)]["grids"], {"fragment_id": "INT", **{f"surface_{i}": "FLOAT" for i in numbers},
                                                      **{f"density_{i}": "FLOAT" for i in numbers}})
        for mesh, says in zip(reported[str(single)]["surfaces"], manifests["blosc"]["fragments"], strict=True):
            holds(mesh, says)
        whole = reported[str(solid)]["surfaces"][0]
        self.assertTrue(whole["closed"])
        self.assertAlmostEqual(whole["volume"] / sum(f["volume"] for f in manifests["blosc"]["fragments"]), 1, delta=0.01)

    def test_scene_has_named_nodes_materials_and_the_texture(self):
        places, faces = sphere(24, 48, center=(2.0, 3.0, 5.0), radius=1.5)
        write_textured_obj(self.made / "painted.obj", places, faces, [((x - 0.5) / 3, (y - 1.5) / 3) for x, y, _ in places],
                           "checks.png", np.arange(12, dtype=np.uint8).reshape(2, 2, 3) * 20)
        manifest = self.fracture(self.tmp / "painted", self.made / "painted.obj", "--pieces", str(PIECES), "--write", "scene", "--density", "2")
        reported = self.blender('''
if "bool" not in vars(np):
    np.bool = bool  # Blender 3.4's importer asks for a name that numpy 1.24 (Debian 12) has dropped
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
bpy.ops.import_scene.gltf(filepath=sys.argv[-1])
bpy.context.view_layer.update()
answer(things=[{**measures(o), "location": o.location[:], "materials": [m.name for m in o.data.materials], "uv": len(o.data.uv_layers)}
             for o in bpy.data.objects if o.type == "MESH"],
     images=[i.size[:] for i in bpy.data.images if i.name.startswith("checks")],
     textured=[m.name for m in bpy.data.materials if m.use_nodes and any(n.type == "TEX_IMAGE" for n in m.node_tree.nodes)],
     materials=[m.name for m in bpy.data.materials if m.users])
''', self.tmp / "painted" / "scene.glb")
        self.assertEqual([t["name"] for t in reported["things"]], [f"painted_{i:03d}" for i in range(1, PIECES + 1)])
        own = [name for name in reported["materials"] if name.startswith(("glaze", "inside"))]
        self.assertEqual(sorted(own), ["glaze", "inside"], "each is there once for all")
        self.assertEqual((reported["textured"], reported["images"]), (["glaze"], [[2, 2]]))
        for thing, says in zip(reported["things"], manifest["fragments"], strict=True):
            self.assertEqual((thing["materials"], thing["uv"]), (["glaze", "inside"], 1))
            x, y, z = says["centroid"]
            np.testing.assert_allclose(thing["location"], [x, -z, y], atol=1e-5)  # the importer takes y for up
            np.testing.assert_allclose(thing["center"], [x, -z, y], atol=1e-4)
            self.assertAlmostEqual(thing["volume"] / says["volume"], 1, delta=1e-4)

    def test_glb_pieces_are_closed(self):
        """At once with --plain-meshes, else after vertices at equal positions are merged."""
        places, faces = sphere(24, 48, center=(2.0, 3.0, 5.0), radius=1.5)
        write_obj(self.made / "ball.obj", (places, faces))
        for name, options in (("welded", ["--plain-meshes"]), ("split", [])):
            out = self.tmp / name
            manifest = self.fracture(out, self.made / "ball.obj", "--pieces", str(PIECES), "--write", "scene,mesh", "--mesh-format", "glb", *options)
            reported = self.blender('''
import bmesh
if "bool" not in vars(np):
    np.bool = bool
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
for path in sys.argv[sys.argv.index("--") + 3:]:
    bpy.ops.import_scene.gltf(filepath=path)
bpy.context.view_layer.update()
things = [o for o in bpy.data.objects if o.type == "MESH"]
before = [measures(o)["closed"] for o in things]
for thing in things:
    mesh = bmesh.new()
    mesh.from_mesh(thing.data)
    bmesh.ops.remove_doubles(mesh, verts=mesh.verts, dist=1e-6)
    mesh.to_mesh(thing.data)
answer(before=before, merged=[measures(o) for o in things])
''', out / "scene.glb", *(out / f["files"]["mesh"] for f in manifest["fragments"]))
            self.assertEqual(len(reported["merged"]), 2 * PIECES)
            self.assertEqual(set(reported["before"]), {name == "welded"})
            for thing in reported["merged"]:
                self.assertTrue(thing["closed"], thing["name"])
                says = manifest["fragments"][int(thing["name"].split(".")[0][-3:]) - 1]
                self.assertAlmostEqual(thing["volume"] / says["volume"], 1, delta=1e-4)


# Renders meshes by their texture alone, one sample in the middle of each pixel, and writes the pixels.
RENDER = '''
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
scene = bpy.context.scene
target, *paths = sys.argv[sys.argv.index("--") + 3:]
for path in paths:
    bpy.ops.import_scene.obj(filepath=path, axis_forward="Y", axis_up="Z")
for material in bpy.data.materials:
    material.use_nodes = True
    tree = material.node_tree
    image = next((n for n in tree.nodes if n.type == "TEX_IMAGE"), None)
    emission, output = tree.nodes.new("ShaderNodeEmission"), next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    if image:
        tree.links.new(image.outputs["Color"], emission.inputs["Color"])
    tree.links.new(emission.outputs["Emission"], output.inputs["Surface"])
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
camera.data.type, camera.data.ortho_scale = "ORTHO", 4.0
camera.location, camera.rotation_euler = (6.0, -5.0, 8.0), (0.70, 0.0, 0.88)
scene.camera = camera
scene.render.engine = "CYCLES"
scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.pixel_filter_type = 1, False, "BOX"
scene.cycles.filter_width, scene.cycles.use_adaptive_sampling = 0.01, False
scene.render.resolution_x = scene.render.resolution_y = 400
scene.view_settings.view_transform = "Standard"
scene.render.filepath, scene.render.image_settings.file_format = target, "PNG"
bpy.ops.render.render(write_still=True)
pixels = bpy.data.images.load(target).pixels
np.save(target + ".npy", np.rint(255 * np.array(pixels[:])).reshape(400, 400, 4)[:, :, :3].astype(int))
answer(objects=len([o for o in bpy.data.objects if o.type == "MESH"]))
'''


class ExactPieces(Blender):
    def test_assembled_pieces_look_like_the_input(self):
        """Rendered by texture, 99.9 % of the pixels are within 1 of 255, and the rest is where cracks show."""
        step = np.arange(64)
        pixels = np.stack([np.add.outer(2 * step, step) % 256, np.add.outer(step, 3 * step) % 256, np.add.outer(step, step) // 32 % 2 * 200], axis=2)
        points, faces = sphere(24, 48, center=(0.0, 0.0, 0.0), radius=1.5)
        write_textured_obj(self.tmp / "painted.obj", points, faces, [((x - 0.5 * y + 2) / 5, (z + 0.3 * y + 2) / 5) for x, y, z in points],
                           "cells.png", pixels.astype(np.uint8))
        subprocess.run([SHERD, "fracture", self.tmp / "painted.obj", "-o", self.tmp / "out", "--resolution", "64", "--pieces", "8", "--roughness", "1",
                        "--surface", "exact", "--write", "mesh", "--mesh-format", "obj", "--quiet"], check=True, timeout=120)
        manifest = json.loads((self.tmp / "out" / "manifest.json").read_text())
        self.assertEqual({f["surface"] for f in manifest["fragments"]}, {"exact"})
        pieces = [self.tmp / "out" / f["files"]["mesh"] for f in manifest["fragments"]]
        self.assertEqual(self.blender(RENDER, self.tmp / "input.png", self.tmp / "painted.obj")["objects"], 1)
        self.assertEqual(self.blender(RENDER, self.tmp / "pieces.png", *pieces)["objects"], len(pieces))
        whole, assembled = (np.load(self.tmp / f"{name}.png.npy") for name in ("input", "pieces"))
        shown = (whole > 0).any(axis=2)
        self.assertGreater(shown.mean(), 0.3, "the mesh is in the image")
        self.assertGreater(np.unique(whole[shown], axis=0).shape[0], 1000, "with its texture")
        off = np.abs(whole - assembled).max(axis=2) > 1
        self.assertLess(off[shown].mean(), 0.001)


if __name__ == "__main__":
    skipping.main()
