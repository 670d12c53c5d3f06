#!/usr/bin/python3
"""Blender imports scene.usda and scene.usdz: names, positions, materials with their texture, texture coordinates, and `neighbor` of faces.

usage: PYTHONPATH=tests/cli blender_usd.py    (environment: as blender_test.py; Debian's Blender is built without USD, and fails)
"""
import json
import pathlib
import subprocess

import numpy as np

import skipping
from blender_files_test import write_textured_obj
from blender_test import Blender
from cli_test import SHERD, sphere
from manifests import check_below
from ply_file import read_ply

PIECES = 4

IMPORT = '''
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
bpy.ops.wm.usd_import(filepath=sys.argv[-1])
bpy.context.view_layer.update()
found = []
for o in bpy.data.objects:
    if o.type != "MESH":
        continue
    mesh = o.data
    layer = mesh.attributes.get("neighbor")
    found.append({**measures(o), "mesh": mesh.name, "materials": [m.name for m in mesh.materials], "uv": len(mesh.uv_layers),
                  "st": [c.uv[:] for c in mesh.uv_layers[0].data] if mesh.uv_layers else [],
                  "location": o.matrix_world.translation[:], "material_index": [p.material_index for p in mesh.polygons],
                  "neighbor": [v.value for v in layer.data] if layer else None, "domain": layer.domain if layer else None,
                  "kind": layer.data_type if layer else None})
answer(things=sorted(found, key=lambda t: t["mesh"]), images=[i.size[:] for i in bpy.data.images if i.name.startswith("checks")],
       textured=[m.name for m in bpy.data.materials if m.use_nodes and any(n.type == "TEX_IMAGE" for n in m.node_tree.nodes)],
       materials=sorted(m.name for m in bpy.data.materials if m.users))
'''


class UsdScene(Blender):
    def test_scenes_are_imported(self):
        places, faces = sphere(24, 48, center=(2.0, 3.0, 5.0), radius=1.5)
        write_textured_obj(self.tmp / "painted.obj", places, faces, [((x - 0.5) / 3, (y - 1.5) / 3) for x, y, _ in places],
                           "checks.png", np.arange(12, dtype=np.uint8).reshape(2, 2, 3) * 20)
        out = self.tmp / "out"
        subprocess.run([SHERD, "fracture", self.tmp / "painted.obj", "-o", out, "--resolution", "48", "--quiet", "--pieces", str(PIECES),
                        "--write", "usd,mesh", "--usd-format", "usda,usdz", "--up", "z"], check=True, timeout=120)
        check_below(out)
        manifest = json.loads((out / "manifest.json").read_text())
        for name in manifest["usd"]:
            with self.subTest(name):
                self.check(self.blender(IMPORT, out / name), out, manifest)

    def check(self, reported, out, manifest):
        self.assertEqual([t["mesh"] for t in reported["things"]], [f"painted_{i:03d}" for i in range(1, PIECES + 1)])
        self.assertLessEqual({"glaze", "inside"}, set(reported["materials"]))
        self.assertEqual((reported["textured"], reported["images"]), (["glaze"], [[2, 2]]))
        for thing, fragment in zip(reported["things"], manifest["fragments"], strict=True):
            _, vertex, face = read_ply(pathlib.Path(out, fragment["files"]["mesh"]))
            self.assertTrue(thing["name"].startswith(thing["mesh"]))
            self.assertEqual((sorted(thing["materials"]), thing["uv"], thing["closed"]), (["glaze", "inside"], 1, True))
            np.testing.assert_allclose(thing["location"], fragment["centroid"], atol=1e-5)
            np.testing.assert_allclose(thing["center"], fragment["centroid"], atol=1e-4)
            np.testing.assert_allclose(np.reshape(thing["st"], (-1, 6)), face["texcoord"], atol=1e-6)
            inside = [thing["materials"][i] == "inside" for i in thing["material_index"]]
            np.testing.assert_array_equal(inside, face["neighbor"] != 0)
            self.assertEqual((thing["domain"], thing["kind"]), ("FACE", "INT"))
            np.testing.assert_array_equal(thing["neighbor"], face["neighbor"])


if __name__ == "__main__":
    skipping.main()
