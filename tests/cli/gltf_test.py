#!/usr/bin/python3
"""glTF for engines: materials that arrive as they were, rigid bodies, joints, levels, closed meshes; hostile textures.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy.
tests/long/gltf.py compares the same files with the schemas, and Godot opens them.
"""
import copy
import hashlib
import math
import os

import numpy as np

import skipping
from appearance_test import png
from cli_test import CommandLine, all_contacts, sphere
from glb_file import PHYSICS, Glb, write_glb
from usd_file import read_usda

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")
IMAGES = [png(np.full((2, 2, 3), 40 * i, np.uint8)) for i in range(1, 7)]
SAMPLERS = [{"magFilter": 9728, "minFilter": 9728, "wrapS": 33071, "wrapT": 33648}, {"wrapS": 33071}]
# Textures 0..6: images 0..5, the last once more with another sampler.
TEXTURES = [{"source": 0, "sampler": 0}, {"source": 1}, {"source": 2, "sampler": 1}, {"source": 3}, {"source": 4}, {"source": 5},
            {"source": 5, "sampler": 1}]
TRANSFORM = {"KHR_texture_transform": {"offset": [0.25, 0.5], "rotation": 0.1, "scale": [2, 3.5]}}
GLAZE = {
    "name": "glaze", "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": True, "emissiveFactor": [1, 0.5, 0.1],
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.9, 0.8, 0.7, 0.6], "baseColorTexture": {"index": 0, "extensions": TRANSFORM},
        "metallicFactor": 0.3, "roughnessFactor": 0.2, "metallicRoughnessTexture": {"index": 1}},
    "normalTexture": {"index": 2, "scale": 0.7}, "occlusionTexture": {"index": 3, "strength": 0.4}, "emissiveTexture": {"index": 4},
    "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatTexture": {"index": 5},
                                               "clearcoatNormalTexture": {"index": 6, "scale": 1.5}},
                   "KHR_materials_ior": {"ior": 1.4}, "KHR_materials_emissive_strength": {"emissiveStrength": 4}},
    "extras": {"kiln": {"Texture": {"index": 99}}, "year": 1650}}


def model(path, materials, textures=TEXTURES, images=None, sets=1):
    """A ball of a material for each half, with its images inside, or beside it by their URIs."""
    points, triangles = sphere(12, 24)
    arrays = [np.array(points, "<f4"), np.array(triangles, "<u4"),
              *(np.array([[0.3 * x + 0.5 + s, 0.3 * y + 0.5] for x, y, _ in points], "<f4") for s in range(sets))]
    buffer, views, of_images = b"", [], []
    for data in [*(a.tobytes() for a in arrays), *(IMAGES if images is None else [])]:
        views.append({"buffer": 0, "byteOffset": len(buffer), "byteLength": len(data)})
        buffer += data + b"\0" * (-len(data) % 4)
    if images is None:
        of_images = [{"bufferView": len(arrays) + i, "mimeType": "image/png"} for i in range(len(IMAGES))]
    else:
        of_images = [{"uri": name} for name in images]
    half = 3 * (len(triangles) // 2)
    accessors = [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": len(points),
                  "min": arrays[0].min(0).tolist(), "max": arrays[0].max(0).tolist()},
                 {"bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": half},
                 {"bufferView": 1, "byteOffset": 4 * half, "componentType": 5125, "type": "SCALAR", "count": 3 * len(triangles) - half}]
    attributes = {"POSITION": 0}
    for s in range(sets):
        attributes[f"TEXCOORD_{s}"] = len(accessors)
        accessors.append({"bufferView": 2 + s, "componentType": 5126, "type": "VEC2", "count": len(points)})
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 1 + i, "material": i % len(materials)} for i in range(2)]}],
        "materials": materials, "accessors": accessors, "bufferViews": views}
    for name, array in (("textures", textures), ("images", of_images), ("samplers", SAMPLERS)):
        if array:
            document[name] = copy.deepcopy(array)
    return write_glb(path, document, buffer)


def resolved(material, document, image_of):
    """A material with (image, sampler) in place of the numbers of textures."""
    def visit(value):
        for key, of in value.items():
            if key == "extras" or not isinstance(of, dict):
                continue
            if key.endswith("Texture"):
                texture = document["textures"][of["index"]]
                sampler = document["samplers"][texture["sampler"]] if "sampler" in texture else None
                of["index"] = [hashlib.sha256(image_of(texture["source"])).hexdigest(), sampler]
            visit(of)
    material = copy.deepcopy(material)
    visit(material)
    return material


class Gltf(CommandLine):
    def broken(self, *options, mesh=AMPHORA, out=None, pieces=6, write="scene"):
        return self.written(write, *options, mesh=mesh, out=out, pieces=pieces)

    def scene(self, out=None):
        return Glb(self, os.path.join(out or self.out, "scene.glb"))

    def test_materials_arrive_as_they_were(self):
        plain = {"name": "clay", "pbrMetallicRoughness": {"roughnessFactor": 0.2, "metallicFactor": 0}}
        mesh = model(self.path("model.glb"), [GLAZE, plain])
        document = {"textures": TEXTURES, "samplers": SAMPLERS}
        want = [resolved(m, document, lambda i: IMAGES[i]) for m in (GLAZE, plain)]
        manifest = self.broken("--mesh-format", "glb", "--surface", "exact", mesh=mesh, pieces=3, write="mesh,scene")
        converted = self.path("converted.glb")
        self.assertEqual(self.run_sherd("convert", mesh, converted).returncode, 0)
        again = self.path("again.glb")  # of what Sherd wrote
        self.assertEqual(self.run_sherd("convert", converted, again).returncode, 0)
        pieces = [os.path.join(self.out, f["files"]["mesh"]) for f in manifest["fragments"]]
        found = set()
        for path in [os.path.join(self.out, "scene.glb"), converted, again, *pieces]:
            file = Glb(self, path)
            for material in file.json["materials"]:
                if material["name"] == "inside":
                    continue
                own = resolved(material, file.json, lambda i: file.view(file.json["images"][i]["bufferView"]))
                self.assertIn(own, want, path)
                found.add(own["name"])
            self.assertEqual(len(file.json["images"]), 6, "each once")
            self.assertEqual(len(file.json["textures"]), 7)
        self.assertEqual(found, {"glaze", "clay"})

    def test_other_formats_have_what_they_can(self):
        mesh = model(self.path("model.glb"), [GLAZE])
        self.broken("--mesh-format", "obj,ply", mesh=mesh, pieces=3, write="mesh,usd,viewer")
        with open(os.path.join(self.out, "meshes", "model.mtl")) as file:
            library = file.read()
        part = library[library.index("newmtl glaze"):library.index("newmtl inside")].split("\n")
        names = [f"texture_{i}.png" for i in range(6)]
        for line in ("Kd 0.9 0.8 0.7", "Pr 0.2", "Pm 0.3", "Ke 4 2 0.4", "d 0.6", f"map_Kd {names[0]}", f"map_d {names[0]}",
                     f"map_Pr -imfchan g {names[1]}", f"map_Pm -imfchan b {names[1]}", f"norm {names[2]}", f"map_Ke {names[4]}"):
            self.assertIn(line, part)
        inside = library[library.index("newmtl inside"):].split("\n")[1].split()
        linear = [((c / 255 + 0.055) / 1.055) ** 2.4 for c in (224, 214, 196)]
        np.testing.assert_allclose([float(c) for c in inside[1:]], linear, atol=1e-6)
        for name, image in zip(names, IMAGES):
            with open(os.path.join(self.out, "meshes", name), "rb") as file:
                self.assertEqual(file.read(), image)
        with open(os.path.join(self.out, "meshes", "model_001.ply"), "rb") as file:
            header = file.read(2000).split(b"end_header")[0]
        self.assertEqual(header.count(b"TextureFile"), 1, "its formats have base colors only")
        with open(os.path.join(self.out, "scene.usda"), encoding="utf-8") as file:
            _, root = read_usda(file.read())
        glaze = next(m for m in root.child("materials").children if m.name == "glaze")
        shader = glaze.child("surface").values
        self.assertEqual({name[7:-8]: value.rsplit("/", 1)[1] for name, value in shader.items() if name.endswith(".connect")},
                         {"diffuseColor": "texture.outputs:rgb", "emissiveColor": "emission.outputs:rgb", "metallic": "roughness.outputs:b",
                          "normal": "normal.outputs:rgb", "occlusion": "occlusion.outputs:r", "opacity": "texture.outputs:a",
                          "roughness": "roughness.outputs:g"})
        self.assertEqual(shader["inputs:opacityThreshold"], 0.25)
        self.assertEqual(glaze.child("roughness").values["inputs:scale"], (1, 0.2, 0.3, 1))
        self.assertEqual(glaze.child("normal").values["inputs:bias"], (-0.7, -0.7, -1, 0))
        self.assertEqual(glaze.child("normal").values["inputs:sourceColorSpace"], "raw")
        for prim in glaze.children:
            for name, value in prim.values.items():
                if name.endswith(".connect"):
                    self.assertIn(value.rsplit(".", 1)[1], glaze.child(value.rsplit("/", 1)[1].split(".")[0]).types)

    def test_a_transform_of_all_textures_is_in_the_coordinates(self):
        glaze = {"name": "glaze", "normalTexture": {"index": 2, "extensions": TRANSFORM},
                 "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": {**TRANSFORM, "EXT_other": {}}}}}
        plain = {"name": "plain", "pbrMetallicRoughness": {"baseColorTexture": {"index": 1}}}
        out = self.path("moved.glb")
        done = self.run_sherd("convert", model(self.path("model.glb"), [glaze, plain]), out)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        file = Glb(self, out)
        u, v = TRANSFORM["KHR_texture_transform"]["offset"]
        a, b = TRANSFORM["KHR_texture_transform"]["scale"]
        turn = TRANSFORM["KHR_texture_transform"]["rotation"]
        seen = set()
        for material, _, vertices in file.primitives():
            x, y, _ = vertices["POSITION"].T
            at = np.array([0.3 * x + 0.5, 0.3 * y + 0.5])
            if material["name"] == "glaze":
                at = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]]) @ (at * [[a], [b]]) + [[u], [v]]
                self.assertEqual(material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"], {"EXT_other": {}})
                self.assertEqual(set(material["normalTexture"]), {"index"})
            np.testing.assert_allclose(vertices["TEXCOORD_0"].T, at, atol=1e-5)
            seen.add(material["name"])
        self.assertEqual(seen, {"glaze", "plain"})
        for transform in ({"scale": [3e38, 3e38], "offset": [3e38, 0]}, {"scale": "x", "rotation": []}, 5):  # nothing is refused
            odd = {"name": "odd", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": transform}}}}
            done = self.run_sherd("convert", model(self.path("model.glb"), [odd]), out)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue(all(np.isfinite(v["TEXCOORD_0"]).all() for _, _, v in Glb(self, out).primitives()))
        self.assertIn("transformed in several ways", self.run_sherd("convert", model(self.path("model.glb"), [GLAZE]), out).stderr)

    def test_a_library_of_obj_becomes_glTF(self):
        points, triangles = sphere(12, 24)
        text = "mtllib ball.mtl\n" + "".join(f"v {x} {y} {z}\nvt {x} {y}\n" for x, y, z in points) + "usemtl glaze\n"
        mesh = self.path("ball.obj", (text + "".join("f " + " ".join(f"{i + 1}/{i + 1}" for i in t) + "\n" for t in triangles)).encode())
        for i, name in enumerate(("base", "both", "normal", "glow")):
            self.path(name + ".png", IMAGES[i])
        self.path("ball.mtl", b"newmtl glaze\nKd 0.5 0.25 1\nKe 2 1 0\nPr 0.3\nPm 0.6\nd 0.5\nmap_Kd base.png\nmap_Ke glow.png\n"
                              b"map_Pr -imfchan g both.png\nmap_Pm -imfchan b both.png\nmap_Bump -bm 1 normal.png\n")
        out = self.path("ball.glb")
        self.assertEqual(self.run_sherd("convert", mesh, out).stderr, "")
        file = Glb(self, out)
        material = resolved(file.json["materials"][0], file.json, lambda i: file.view(file.json["images"][i]["bufferView"]))
        image = [[hashlib.sha256(data).hexdigest(), None] for data in IMAGES]
        self.assertEqual(material, {
            "name": "glaze", "alphaMode": "BLEND", "emissiveFactor": [1, 0.5, 0], "emissiveTexture": {"index": image[3]},
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}, "normalTexture": {"index": image[2]},
            "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 0.5], "baseColorTexture": {"index": image[0]}, "metallicFactor": 0.6,
                                     "roughnessFactor": 0.3, "metallicRoughnessTexture": {"index": image[1]}}})
        back = self.path("back/ball.obj")
        os.mkdir(os.path.dirname(back))
        self.assertEqual(self.run_sherd("convert", out, back).returncode, 0)
        third = self.path("third.glb")
        self.assertEqual(self.run_sherd("convert", back, third).returncode, 0)
        file = Glb(self, third)
        again = resolved(file.json["materials"][0], file.json, lambda i: file.view(file.json["images"][i]["bufferView"]))
        self.assertEqual(again, material)

    def test_maps_that_glTF_cannot_have_are_left_out_with_a_warning(self):
        points, triangles = sphere(6, 12)
        text = "mtllib ball.mtl\n" + "".join(f"v {x} {y} {z}\nvt {x} {y}\n" for x, y, z in points) + "usemtl glaze\n"
        mesh = self.path("ball.obj", (text + "".join("f " + " ".join(f"{i + 1}/{i + 1}" for i in t) + "\n" for t in triangles)).encode())
        self.path("a.png", IMAGES[0])
        self.path("gray.png", IMAGES[1][:25] + b"\0" + IMAGES[1][26:])
        for line in ("map_Pm a.png", "map_d a.png", "bump gray.png"):
            self.path("ball.mtl", f"newmtl glaze\nKd 1 0 0\n{line}\n".encode())
            done = self.run_sherd("convert", mesh, self.path(line.split()[0] + ".glb"))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(f"its texture '{line.split()[1]}' is for one property alone, or of heights", done.stderr)

    def test_textures_are_refused_as_those_of_base_colors(self):
        self.path("secret.png", IMAGES[0])
        os.mkdir(self.path("in"))
        os.symlink(self.path("secret.png"), self.path("in/link.png"))
        for name, why in (("../secret.png", "does not lie in or below the file's folder"), ("none.png", "is not there"),
                          ("link.png", "leaves the file's folder by a symbolic link")):
            material = {"name": "glaze", "normalTexture": {"index": 0}, "pbrMetallicRoughness": {"roughnessFactor": 0.2}}
            mesh = model(self.path("in/model.glb"), [material], textures=[{"source": 0}], images=[name])
            done = self.done("--write", "scene", mesh=mesh)
            self.assertIn(f"its texture '{name}' {why}, so it is left out", done.stderr)
            found = next(m for m in self.scene().json["materials"] if m["name"] == "glaze")
            self.assertEqual(found, {"name": "glaze", "pbrMetallicRoughness": {"roughnessFactor": 0.2}})

    def test_one_set_of_coordinates_stays(self):
        other = {"index": 1, "texCoord": 1}
        material = {"name": "glaze", "normalTexture": other, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
        mesh = model(self.path("model.glb"), [material], sets=2)
        done = self.done("--write", "scene", mesh=mesh)
        self.assertIn("has other coordinates than the base color", done.stderr)
        self.assertEqual(set(self.scene().json["materials"][0]), {"name", "pbrMetallicRoughness"})
        material = {"name": "glaze", "normalTexture": other, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1}}}
        done = self.done("--write", "scene", mesh=model(self.path("model.glb"), [material], sets=2))
        self.assertEqual(done.stderr.count("warning"), 0)
        glaze = next(m for m in self.scene().json["materials"] if m["name"] == "glaze")
        self.assertEqual(set(glaze["normalTexture"]), {"index"})

    def test_hostile_materials_are_refused_or_read(self):
        deep = {"name": "deep"}
        at = deep
        for _ in range(80):
            at["extras"] = {}
            at = at["extras"]
        cases = [(deep, 3), ({"name": "a", "normalTexture": {"index": 99}}, 3), ({"name": "a", "normalTexture": {"index": -1}}, 0),
                 ({"name": "a", "normalTexture": {"index": 0, "extensions": 7}}, 0), ({"name": "a", "extensions": []}, 0),
                 ({"name": "a", "pbrMetallicRoughness": {"roughnessFactor": "x", "metallicFactor": -4}}, 0),
                 ({"name": "a", "emissiveFactor": "red", "alphaMode": 3, "normalTexture": []}, 0)]
        for material, status in cases:
            mesh = model(self.path("model.glb"), [material])
            result = self.fracture("--write", "scene,usd,mesh", "--mesh-format", "obj,glb", mesh=mesh)
            self.assertIn(result.returncode, (status, 3), (material, result.stderr))

    def test_a_scene_has_one_collider_a_piece_and_a_joint_a_contact(self):
        manifest = self.broken("--joint-strength", "7")
        file = self.scene()
        nodes = file.json["nodes"]
        bodies = {i for i in range(len(nodes)) if "motion" in file.physics(i)}
        self.assertEqual(bodies, {i for i, node in enumerate(nodes) if "mesh" in node})
        for i in range(len(nodes)):
            physics = file.physics(i)
            if i in bodies:
                self.assertEqual(physics["collider"], {"geometry": {"node": i, "convexHull": True}})
                self.assertFalse(bodies & set(file.path(i)[1:]), "a body in another")
            else:
                self.assertNotIn("collider", physics)
        joints = file.json["extensions"][PHYSICS]["physicsJoints"]
        self.assertEqual(joints, [{"name": "fixed", "limits": [{"linearAxes": [0, 1, 2], "min": 0, "max": 0},
                                                               {"angularAxes": [0, 1, 2], "min": 0, "max": 0}]}])
        contacts = {(f["id"], c["id"]): c for f in manifest["fragments"] for c in all_contacts(f) if f["id"] < c["id"]}
        found = set()
        for i, node in enumerate(nodes):
            if "joint" not in file.physics(i):
                continue
            joint = file.physics(i)["joint"]
            self.assertEqual(joint["joint"], 0)
            other = joint["connectedNode"]
            np.testing.assert_allclose(file.world(i), file.world(other), atol=1e-12)
            one, two = (manifest["fragments"][next(k for k in file.path(n) if k in bodies)]["id"] for n in (i, other))
            self.assertEqual([node["name"], nodes[other]["name"]], [f"joint_{one}_{two}", f"joint_{two}_{one}"])
            contact = contacts[one, two]
            np.testing.assert_allclose(file.world(i), contact["centroid"], atol=1e-12)
            self.assertEqual(node["extras"], {"area": contact["area"], "breakForce": 7 * contact["area"]})
            found.add((one, two))
        self.assertEqual(found, set(contacts))
        self.assertEqual(len(nodes), len(bodies) + 2 * len(found))

    def test_levels_are_nodes_around_their_pieces(self):
        manifest = self.broken("--growth", "sequential", pieces=9)
        file = self.scene()
        names = [node["name"] for node in file.json["nodes"]]
        self.assertEqual(sum(name.startswith("split") for name in names), 8)
        for i, fragment in enumerate(manifest["fragments"]):
            levels, split = [], fragment["split"]
            while split:
                levels.append(f"split{split}")
                split = manifest["splits"][split - 1]["parent"]
            self.assertEqual([names[k] for k in file.path(i)[1:]], levels)
            np.testing.assert_allclose(file.world(i), fragment["centroid"], atol=1e-12)

    def test_one_piece_has_no_joints(self):
        self.broken(pieces=1)
        document = self.scene().json
        self.assertEqual((len(document["nodes"]), "extensions" in document), (1, False))

    def test_neighbors_are_whole_numbers(self):
        manifest = self.broken("--mesh-format", "glb,ply", write="mesh")
        ids = {f["id"] for f in manifest["fragments"]}
        for fragment in manifest["fragments"]:
            file = Glb(self, os.path.join(self.out, fragment["files"]["mesh"][0]))
            number = file.json["meshes"][0]["primitives"][0]["attributes"]["_NEIGHBOR"]
            self.assertEqual(file.json["accessors"][number]["componentType"], 5123)
            self.assertEqual(set(file.array(number)[:, 0]) - {0}, {c["id"] for c in fragment["contacts"]} & ids)

    def test_plain_meshes_are_closed_without_merging(self):
        manifest = self.broken("--plain-meshes", "--mesh-format", "glb", mesh=model(self.path("model.glb"), [GLAZE]), write="mesh,scene")
        scene = self.scene()
        self.assertFalse({"materials", "images"} & set(scene.json))
        meshes = [(Glb(self, os.path.join(self.out, f["files"]["mesh"])), 0) for f in manifest["fragments"]]
        for file, mesh in [*meshes, *((scene, i) for i in range(len(manifest["fragments"])))]:
            self.assertEqual(set(file.json["meshes"][mesh]["primitives"][0]["attributes"]), {"POSITION"})
            _, triangles, merged = file.whole(mesh)
            np.testing.assert_array_equal(triangles, merged)

    def test_two_runs_write_the_same_bytes(self):
        mesh = model(self.path("model.glb"), [GLAZE])
        files = []
        for out in ("one", "two"):
            self.broken(mesh=mesh, out=self.path(out), pieces=4)
            with open(self.path(out + "/scene.glb"), "rb") as file:
                files.append(file.read())
        self.assertEqual(*files)


if __name__ == "__main__":
    skipping.main()
