#!/usr/bin/python3
"""Scenes and meshes in glTF: by the schemas of glTF and of its extensions, and as Godot 3 imports them.

usage: gltf.py SHERD     (needs Debian's godot3-server and python3-jsonschema)

SHERD_GLTF_SCHEMAS names a folder with checkouts of https://github.com/KhronosGroup/glTF and https://github.com/eoineoineoin/glTF_Physics,
in which the drafts of KHR_physics_rigid_bodies are; without it no file is compared with a schema.
"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import jsonschema
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))
SHERD = os.path.abspath(sys.argv.pop(1))
os.environ.update(SHERD_BIN=SHERD, SHERD_DATA=str(HERE.parents[1] / "data"))
from glb_file import MANIFOLD, PHYSICS, Glb  # noqa: E402
from gltf_test import AMPHORA, GLAZE, Gltf, model  # noqa: E402

SCHEMAS = os.environ.get("SHERD_GLTF_SCHEMAS")
PROJECT = 'config_version=4\n\n[application]\nconfig/name="sherd"\n'
# Every node of the imported scene: its class, place, and what its surfaces have.
DESCRIBE = '''extends SceneTree

func describe(node, out):
	var own = {"name": node.name, "class": node.get_class(), "parent": node.get_parent().name if node.get_parent() else ""}
	if node is Spatial:
		own["at"] = [node.transform.origin.x, node.transform.origin.y, node.transform.origin.z]
	if node is MeshInstance:
		own["surfaces"] = []
		for i in range(node.mesh.get_surface_count()):
			var arrays = node.mesh.surface_get_arrays(i)
			var m = node.mesh.surface_get_material(i)
			var indices = []
			for k in arrays[8]:
				indices.append(k)
			own["surfaces"].append({"material": m.resource_name, "indices": indices, "points": arrays[0].size(), "roughness": m.roughness,
				"metallic": m.metallic, "normal": m.normal_enabled, "emission": m.emission_enabled, "textured": m.albedo_texture != null})
		own["hull"] = node.mesh.create_convex_shape().points.size()
	out.append(own)
	for child in node.get_children():
		describe(child, out)

func _init():
	var out = []
	describe(load("res://scene.glb").instance(), out)
	print("ANSWER " + to_json(out))
	quit()
'''


class Schemas:
    def __init__(self, folder):
        self.known = {path.name: json.loads(path.read_text(encoding="utf-8")) for path in pathlib.Path(folder).rglob("*.schema.json")}

    def faults(self, value, name):
        schema = {key: of for key, of in self.known[name].items() if key != "$id"}  # references are to files beside it
        resolver = jsonschema.RefResolver("", schema, handlers={"": self.load})
        resolver.resolve_remote = self.load
        return [f"{name} {list(e.absolute_path)}: {e.message[:200]}" for e in jsonschema.Draft202012Validator(schema, resolver=resolver).iter_errors(value)]

    def load(self, uri):
        return self.known[uri.rsplit("/", 1)[-1]]


class Long(Gltf):
    def scenes(self):
        """Scenes of many kinds by their folders."""
        painted = model(self.path("painted.glb"), [GLAZE, {"name": "clay", "pbrMetallicRoughness": {"roughnessFactor": 0.2}}])
        kinds = {"amphora": (AMPHORA, 12, []), "painted": (painted, 5, ["--mesh-format", "glb"]),
                 "levels": (AMPHORA, 9, ["--growth", "sequential"]), "single": (AMPHORA, 1, []), "missing": (AMPHORA, 7, ["--missing", "3"])}
        for name, (mesh, pieces, options) in kinds.items():
            self.broken(*options, mesh=mesh, out=self.path(name), pieces=pieces, write="scene,mesh")
            yield name

    @unittest.skipUnless(SCHEMAS, "SHERD_GLTF_SCHEMAS names no folder")
    def test_files_follow_the_schemas(self):
        schemas = Schemas(SCHEMAS)
        counts = {}

        def holds(value, name):
            counts[name] = counts.get(name, 0) + 1
            self.assertEqual(schemas.faults(value, name), [])

        for value, name in (({"asset": {"version": "2.0"}, "nodes": [{"mesh": -1}]}, "glTF.schema.json"),
                            ({"collider": {"geometry": {"convexHull": True}}}, f"node.{PHYSICS}.schema.json")):
            self.assertNotEqual(schemas.faults(value, name), [], "references between schemas are followed")
        for name in self.scenes():
            for path in pathlib.Path(self.path(name)).rglob("*.glb"):
                document = Glb(self, path).json
                holds(document, "glTF.schema.json")
                if "extensions" in document:
                    holds(document["extensions"][PHYSICS], f"glTF.{PHYSICS}.schema.json")
                for kind, objects in (("node", document["nodes"]), ("mesh", document["meshes"]), ("material", document["materials"])):
                    for of in objects:
                        for extension, value in of.get("extensions", {}).items():
                            holds(value, f"{kind}.{extension}.schema.json")
        self.assertLessEqual({f"node.{PHYSICS}.schema.json", f"mesh.{MANIFOLD}.schema.json", f"glTF.{PHYSICS}.schema.json"}, set(counts))
        print(counts, file=sys.stderr)

    def godot(self, scene):
        """The nodes of a scene that Godot imported.  It does not always end by itself after an import."""
        with tempfile.TemporaryDirectory() as folder:
            project = pathlib.Path(folder) / "project"
            project.mkdir()
            (project / "project.godot").write_text(PROJECT)
            (project / "describe.gd").write_text(DESCRIBE)
            (project / "scene.glb").write_bytes(pathlib.Path(scene).read_bytes())
            run = dict(env={**os.environ, "HOME": folder}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            with open(os.devnull, "w") as nowhere:
                importing = subprocess.Popen(["godot3-server", "--path", project, "-e", "--quit"], stdout=nowhere, stderr=nowhere,
                                             env=run["env"], start_new_session=True)
            end = time.monotonic() + 300
            while not list(project.glob(".import/scene.glb-*.md5")) and importing.poll() is None and time.monotonic() < end:
                time.sleep(0.2)
            time.sleep(1)
            if importing.poll() is None:
                os.killpg(importing.pid, signal.SIGKILL)
            importing.wait()
            said = subprocess.run(["godot3-server", "--path", project, "-s", "describe.gd"], timeout=300, **run).stdout
        answer = next((line for line in said.splitlines() if line.startswith("ANSWER ")), None)
        self.assertIsNotNone(answer, said[:2000])
        return json.loads(answer[len("ANSWER "):])

    def test_godot_imports_scenes(self):
        for name in self.scenes():
            file = Glb(self, os.path.join(self.path(name), "scene.glb"))
            nodes = {node["name"]: node for node in self.godot(os.path.join(self.path(name), "scene.glb"))[1:]}
            self.assertEqual(set(nodes), {node["name"] for node in file.json["nodes"]}, name)
            for i, node in enumerate(file.json["nodes"]):
                own, path = nodes[node["name"]], file.path(i)
                np.testing.assert_allclose(own["at"], node.get("translation", [0, 0, 0]), atol=1e-5)
                self.assertEqual(own["parent"], file.json["nodes"][path[1]]["name"] if len(path) > 1 else "scene")
                self.assertEqual(own["class"], "MeshInstance" if "mesh" in node else "Spatial")
                if "mesh" not in node:
                    continue
                self.assertGreater(own["hull"], 3)
                primitives = file.json["meshes"][node["mesh"]]["primitives"]
                self.assertEqual(len(own["surfaces"]), len(primitives))
                for surface, primitive in zip(own["surfaces"], primitives):
                    # Godot's triangles are clockwise.
                    want = file.array(primitive["indices"])[:, 0].reshape(-1, 3)
                    self.assertEqual({frozenset(t) for t in np.reshape(surface["indices"], (-1, 3)).astype(int).tolist()},
                                     {frozenset(t) for t in want.tolist()})
                    material = file.json["materials"][primitive["material"]]
                    self.assertEqual(surface["material"], material["name"])
                    pbr = material["pbrMetallicRoughness"]
                    self.assertAlmostEqual(surface["roughness"], pbr.get("roughnessFactor", 1), delta=1e-6)
                    self.assertAlmostEqual(surface["metallic"], pbr.get("metallicFactor", 1), delta=1e-6)
                    self.assertEqual(surface["normal"], "normalTexture" in material)
                    self.assertEqual(surface["emission"], "emissiveFactor" in material)
                    self.assertEqual(surface["textured"], "baseColorTexture" in pbr)


if __name__ == "__main__":
    # Only what is said here: the rest of Gltf is run by ctest.
    suite = unittest.TestSuite(Long(name) for name in ("test_files_follow_the_schemas", "test_godot_imports_scenes"))
    sys.exit(not unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful())
