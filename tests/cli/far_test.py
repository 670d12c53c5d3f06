#!/usr/bin/python3
"""Objects far from the origin: files in double precision, warnings about those that have none, and --recenter.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy.
"""
import json
import os
import pathlib
import struct
import unittest

import numpy as np

from cli_test import CommandLine
from ply_file import columns, read_ply
from scales_test import cube

UTM = np.array([500000.0, 4500000.0, 100.0])  # some place in meters


def write_obj(path, vertices, triangles):
    with open(path, "w") as file:
        file.writelines("v %r %r %r\n" % tuple(map(float, v)) for v in vertices)
        file.writelines("f %d %d %d\n" % tuple(i + 1 for i in t) for t in triangles)


def write_glb(path, vertices, triangles, translation):
    """A mesh in a node that is far away."""
    points, indices = np.array(vertices, "<f4").tobytes(), np.array(triangles, "<u4").tobytes()
    low, high = (np.array(vertices, "<f4").astype(float) for _ in range(2))
    document = {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "translation": list(translation)}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "buffers": [{"byteLength": len(points) + len(indices)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(points)}, {"buffer": 0, "byteOffset": len(points), "byteLength": len(indices)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3", "min": low.min(0).tolist(), "max": high.max(0).tolist()},
                      {"bufferView": 1, "componentType": 5125, "count": 3 * len(triangles), "type": "SCALAR"}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = points + indices
    pathlib.Path(path).write_bytes(struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(body)) + struct.pack("<II", len(text), 0x4E4F534A) + text +
                                   struct.pack("<II", len(body), 0x004E4942) + body)


def read_obj(path):
    lines = [line.split() for line in pathlib.Path(path).read_text().splitlines()]
    return (np.array([list(map(float, words[1:4])) for words in lines if words and words[0] == "v"]),
            [[int(w.split("/")[0]) - 1 for w in words[1:]] for words in lines if words and words[0] == "f"])


def read_text_stl(path):
    return np.array([list(map(float, line.split()[1:])) for line in pathlib.Path(path).read_text().splitlines() if line.strip().startswith("vertex")]).reshape(-1, 3, 3)


def volume(v, faces):
    at = v - v.mean(0)
    return sum(np.dot(at[f[0]], np.cross(at[f[k]], at[f[k + 1]])) for f in faces for k in range(1, len(f) - 1)) / 6


class FarFromTheOrigin(CommandLine):
    def setUp(self):
        super().setUp()
        v, self.triangles = cube()
        self.corners = 10 * np.array(v) - 5  # 10 m, about the origin
        self.near, self.far = (os.path.join(self.tmp, place, "cube.obj") for place in ("near", "far"))
        for path, at in ((self.near, 0), (self.far, UTM)):
            os.makedirs(os.path.dirname(path), exist_ok=True)
            write_obj(path, self.corners + at, self.triangles)

    def path_of(self, name):
        return os.path.join(self.tmp, name)

    def meshes(self, out=None, index=None):
        for fragment in self.manifest(out)["fragments"]:
            files = fragment["files"]["mesh"]
            yield os.path.join(out or self.out, files if index is None else files[index])

    def assert_sound(self, v, faces):
        """Closed, with distinct vertices, and no triangle without area."""
        self.assertEqual(len({tuple(p) for p in v}), len(v))
        edges = {}
        for f in faces:
            self.assertGreater(np.linalg.norm(np.cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]])), 0)
            for a, b in zip(f, [*f[1:], f[0]]):
                edges[a, b] = edges.get((a, b), 0) + 1
        self.assertTrue(all(n == 1 and edges.get((b, a)) == 1 for (a, b), n in edges.items()))

    def test_meshes_are_double_where_the_format_can(self):
        run = self.done("--write", "mesh,proxy,boundaries", "--mesh-format", "ply,obj,stl-ascii", mesh=self.far)
        self.assertNotIn("warning", run.stderr)
        self.assertEqual(self.manifest()["options"]["mesh_precision"], "double")
        self.assertNotIn("rounding", self.manifest())
        total = 0
        for ply, obj, stl in zip(self.meshes(index=0), self.meshes(index=1), self.meshes(index=2)):
            _, vertex, face = read_ply(ply)
            self.assertEqual(vertex.dtype["x"], np.float64)
            v, faces = columns(vertex, *"xyz"), face["vertex_indices"]
            self.assert_sound(v, faces)
            total += volume(v, faces)
            other, polygons = read_obj(obj)
            self.assertEqual({tuple(p) for p in other}, {tuple(p) for p in v})
            self.assertAlmostEqual(volume(other, polygons), volume(v, faces), delta=1e-6)
            self.assertEqual({tuple(p) for p in read_text_stl(stl).reshape(-1, 3)}, {tuple(p) for p in v})
        self.assertAlmostEqual(total, 1000, delta=1000 * 0.0025)
        for fragment in self.manifest()["fragments"]:
            hull, polygons = read_obj(os.path.join(self.out, fragment["files"]["proxy"]))
            self.assertAlmostEqual(volume(hull, polygons), fragment["volume"], delta=0.02 * fragment["volume"])  # planar pieces are convex

    def test_a_translated_node_of_glb_is_sound(self):
        mesh = self.path_of("node.glb")
        write_glb(mesh, self.corners, self.triangles, UTM)
        self.done("--write", "mesh", mesh=mesh)
        for ply in self.meshes():
            _, vertex, face = read_ply(ply)
            self.assert_sound(columns(vertex, *"xyz"), face["vertex_indices"])
        evaluation = self.run_sherd("evaluate", self.out)
        self.assertRegex(evaluation.stdout, r"sound meshes +3 of 3")

    def test_formats_of_floats_are_warned_of(self):
        run = self.done("--write", "mesh,graph", "--mesh-format", "glb,ply,stl", "--points", "5", "--surface", "smooth", mesh=self.far)
        warnings = [line for line in run.stderr.splitlines() if "warning" in line]
        self.assertEqual(len(warnings), 1, run.stderr)
        for word in (".glb, .stl, graph.geo, points", "0.25 units", "recenter", ".ply and .obj"):  # half of the floats' step at 4.5e6
            self.assertIn(word, warnings[0])
        self.assertEqual(self.manifest()["rounding"], {"files": [".glb", ".stl", "graph.geo", "points"], "length": 0.25})

    def test_given_precision_rules(self):
        run = self.done("--write", "mesh", "--precision", "single", mesh=self.far)
        self.assertIn("precision", run.stderr)
        self.assertEqual(self.manifest()["options"]["mesh_precision"], "single")
        self.assertEqual(self.manifest()["rounding"]["files"], [".ply"])
        self.assertEqual(read_ply(next(self.meshes()))[1].dtype["x"], np.float32)
        self.done("--write", "mesh", "--precision", "double", "--mesh-format", "ply,obj", mesh=self.near)
        self.assertEqual(read_ply(next(self.meshes(index=0)))[1].dtype["x"], np.float64)
        v = columns(read_ply(next(self.meshes(index=0)))[1], *"xyz")
        self.assertEqual({tuple(p) for p in read_obj(next(self.meshes(index=1)))[0]}, {tuple(p) for p in v})

    def test_precision_is_of_proxies_and_boundaries_too(self):
        for write in ("proxy", "boundaries"):
            with self.subTest(write):
                for precision, single in (("double", False), ("single", True)):
                    run = self.done("--write", write, "--precision", precision, mesh=self.far)
                    self.assertNotIn("does nothing", run.stderr)
                    self.assertEqual(self.manifest()["options"]["mesh_precision"], precision)
                    self.assertEqual("the option precision may be auto or double" in run.stderr, single)
        run = self.done("--write", "labels", "--precision", "double", mesh=self.far)
        self.assertIn("--precision does nothing without proxy or boundaries in --write, or mesh in --write and ply, obj or stl-ascii in --mesh-format", run.stderr)
        run = self.done("--write", "mesh,solid", "--mesh-format", "glb", "--precision", "double", mesh=self.near)
        self.assertIn("--precision does nothing", run.stderr)

    def test_convert_keeps_or_warns(self):
        for place, mesh, far in (("near", self.near, False), ("far", self.far, True)):
            for name, doubles in (("a.ply", True), ("a.obj", True), ("a.glb", False), ("a.stl", False), ("a.binm", False)):
                with self.subTest((place, name)):
                    out = self.path_of(name)
                    run = self.run_sherd("convert", mesh, out)
                    self.assertEqual(run.returncode, 0, run.stderr)
                    self.assertEqual(run.stderr.count("single precision moves points by up to 0.25 units"), int(far and not doubles), run.stderr)
                    self.assertEqual(len(run.stderr.splitlines()), int(far and not doubles))
                    if name == "a.ply":
                        self.assertEqual(read_ply(out)[1].dtype["x"], np.float64 if far else np.float32)
        v, _ = read_obj(self.path_of("a.obj"))
        self.assertEqual({tuple(p) for p in v}, {tuple(p) for p in self.corners + UTM})
        run = self.run_sherd("convert", self.far, self.path_of("a.stl"), "--ascii")
        self.assertEqual(run.stderr, "")
        self.assertEqual({tuple(p) for p in read_text_stl(self.path_of("a.stl")).reshape(-1, 3)}, {tuple(p) for p in self.corners + UTM})

    def test_near_the_origin_files_are_as_with_single(self):
        self.done("--write", "mesh", "--mesh-format", "ply,obj", "--surface", "smooth", mesh=self.near)
        automatic = [pathlib.Path(p).read_bytes() for i in (0, 1) for p in self.meshes(index=i)]
        self.assertNotIn("mesh_precision", self.manifest()["options"])
        self.done("--write", "mesh", "--mesh-format", "ply,obj", "--precision", "single", "--surface", "smooth", mesh=self.near)
        self.assertEqual(automatic, [pathlib.Path(p).read_bytes() for i in (0, 1) for p in self.meshes(index=i)])

    # ---- --recenter

    ALL = "labels,vdb,mesh,preview,boundaries,cost,solid,scene,usd,graph,houdini,viewer,proxy"

    def assert_same_but_manifest(self, one, other):
        files = self.manifest(one)["files"]
        self.assertEqual(files, self.manifest(other)["files"])
        for name in files:
            with self.subTest(name):
                bytes_of = [pathlib.Path(folder, name).read_bytes() for folder in (one, other)]
                self.assertTrue(bytes_of[0] == bytes_of[1])

    def test_a_recentered_object_is_the_one_at_the_origin(self):
        one, other = self.path_of("one"), self.path_of("other")
        options = ("--growth", "flood", "--surface", "smooth", "--write", self.ALL, "--mesh-format", "ply,obj,glb,stl", "--points", "9", "--sdf-samples", "9", "--correspondences", "9")
        self.done(*options, mesh=self.near, out=one)
        run = self.done(*options, "--recenter", mesh=self.far, out=other)
        self.assertNotIn("warning", run.stderr)
        self.assert_same_but_manifest(one, other)
        manifests = [self.manifest(folder) for folder in (one, other)]
        self.assertEqual(manifests[1].pop("offset"), UTM.tolist())
        self.assertIs(manifests[1]["options"].pop("recenter"), True)
        for manifest in manifests:
            del manifest["source"]["sha256"]
        self.assertEqual(*manifests)

    def test_positions_of_options_are_the_inputs(self):
        x, y, z = UTM
        seeds = [self.path_of(f"seeds_{i}.json") for i in (0, 1, 2)]
        for path, at in zip(seeds, (np.zeros(3), UTM, np.zeros(3))):
            content = {"schema": "sherd-seeds/1", "seeds": [{"fragment": k + 1, "position": list(at + p)} for k, p in enumerate(((-2.5, 0.5, 1), (3, 1, -2)))]}
            pathlib.Path(path).write_text(json.dumps(content))
        content["offset"] = UTM.tolist()
        pathlib.Path(seeds[2]).write_text(json.dumps(content))
        lines = [self.path_of(f"line_{i}.obj") for i in (0, 1)]
        for path, at in zip(lines, (np.zeros(3), UTM)):
            write_obj(path, np.array([(1, -9, -9), (1, 9, -9), (1, 0, 9.5)]) + at, [(0, 1, 2)])
        for here, there in (((("--impact", "5,1,2,2"),), ("--impact", f"{x + 5},{y + 1},{z + 2},2")),
                            ((("--impact", "ray:20,1,2,-1,0,0,2"),), ("--impact", f"ray:{x + 20},{y + 1},{z + 2},-1,0,0,2")),
                            ((("--guide", lines[0], "--growth", "sequential"),), ("--guide", lines[1], "--growth", "sequential"))):
            with self.subTest(there):
                self.done("--write", "labels,mesh", *here[0], mesh=self.near, out=self.path_of("one"))
                self.done("--write", "labels,mesh", *there, "--recenter", mesh=self.far, out=self.path_of("other"))
                self.assert_same_but_manifest(self.path_of("one"), self.path_of("other"))
        recorded = self.manifest(self.path_of("other"))["options"]
        self.run_sherd("fracture", self.near, "-o", self.path_of("one"), "--resolution", "32", "--seeds", seeds[0], "--write", "mesh")
        for path in seeds[1:]:
            with self.subTest(path):
                run = self.run_sherd("fracture", self.far, "-o", self.path_of("other"), "--resolution", "32", "--seeds", path, "--write", "mesh,seeds", "--recenter")
                self.assertEqual(run.returncode, 0, run.stderr)
                for fragment in self.manifest(self.path_of("one"))["fragments"]:
                    mesh = fragment["files"]["mesh"]
                    self.assertEqual(*(pathlib.Path(self.path_of(o), mesh).read_bytes() for o in ("one", "other")))
                written = json.loads(pathlib.Path(self.path_of("other"), "seeds.json").read_text())
                self.assertEqual(written["offset"], UTM.tolist())

    def test_impacts_are_recorded_as_given(self):
        """Bit for bit: moved to the origin and back, most of these numbers would lose their last bits."""
        far = [500005.1, 4500000.3, 102.7]
        near = [0.1, 1 / 3, -7.3e-9]
        self.done("--write", "labels", "--impact", ",".join(map(repr, [*far, 1])), "--recenter", mesh=self.far)
        self.assertEqual(self.manifest()["options"]["seeds"]["impacts"][0]["point"], far)
        for point in (far, near):
            toward = list(UTM - point)
            ray = ",".join(map(repr, [*point, *map(float, toward)]))
            self.done("--write", "labels", "--impact", f"ray:{ray},1", "--recenter", mesh=self.far)
            self.assertEqual(self.manifest()["options"]["seeds"]["impacts"][0]["ray"], {"origin": point, "direction": toward})

    def test_a_recentered_fracture_is_broken_again_and_measured(self):
        one, other = self.path_of("one"), self.path_of("other")
        for mesh, out, more in ((self.near, one, ()), (self.far, other, ("--recenter",))):
            self.done("--write", "labels,vdb,mesh", *more, mesh=mesh, out=out)
        reports = [json.loads(self.run_sherd("evaluate", out, "--mesh", mesh, "--json").stdout) for out, mesh in ((one, self.near), (other, self.far))]
        self.assertEqual(reports[0]["whole"], reports[1]["whole"])
        inspected = json.loads(self.run_sherd("inspect", other, "--json").stdout)
        self.assertEqual(inspected["offset"], UTM.tolist())
        x, y, z = UTM
        for mesh, out, impact in ((one, "a", "5,1,2,1"), (other, "b", f"{x + 5},{y + 1},{z + 2},1")):
            run = self.run_sherd("fracture", os.path.join(mesh, "manifest.json"), "-o", self.path_of(out), "--only", "1", "--pieces", "3", "--write", "labels,mesh")
            self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(self.manifest(self.path_of("b"))["offset"], UTM.tolist())
        self.assert_same_but_manifest(self.path_of("a"), self.path_of("b"))

    def test_a_level_set_is_recentered(self):
        self.done("--write", "vdb,solid", mesh=self.far)
        vdb = os.path.join(self.out, self.manifest()["solid"]["vdb"])
        one = self.path_of("one")
        run = self.run_sherd("fracture", vdb, "-o", one, "--pieces", "3", "--write", "labels,vdb,mesh", "--recenter")
        self.assertEqual(run.returncode, 0, run.stderr)
        manifest = self.manifest(one)
        np.testing.assert_allclose(manifest["offset"], UTM, atol=1e-6)
        low, high = (np.array([f["bbox"][end] for f in manifest["fragments"]]) for end in ("min", "max"))
        np.testing.assert_allclose(low.min(0), [-5] * 3, atol=0.1)
        np.testing.assert_allclose(high.max(0), [5] * 3, atol=0.1)
        again = self.run_sherd("fracture", os.path.join(one, "manifest.json"), "-o", self.path_of("again"), "--only", "2", "--pieces", "2")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(self.manifest(self.path_of("again"))["offset"], manifest["offset"])

    def test_objects_of_a_file_are_recentered_each(self):
        mesh = self.path_of("two.obj")
        with open(mesh, "w") as file:
            for i, name in enumerate(("here", "there")):
                file.write(f"o {name}\n")
                file.writelines("v %r %r %r\n" % tuple(map(float, v + (1 + i) * UTM)) for v in self.corners)
                file.writelines("f %d %d %d\n" % tuple(k + 1 + 8 * i for k in t) for t in self.triangles)
        self.done("--split-objects", "--recenter", "--write", "mesh", mesh=mesh)
        for i, name in enumerate(("here", "there")):
            self.assertEqual(self.manifest(os.path.join(self.out, name))["offset"], ((1 + i) * UTM).tolist())

    def test_libraries(self):
        out = self.path_of("set")
        run = self.run_sherd("dataset", os.path.dirname(self.far), "-o", out, "--pieces", "2..3", "--repeats", "1..1", "--resolution", "24", "--write", "mesh", "--mesh-format", "ply,glb")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(run.stderr.count("single precision"), 1, run.stderr)
        run = self.run_sherd("dataset", os.path.dirname(self.far), "-o", self.path_of("bb"), "--pieces", "2..3", "--repeats", "1..1", "--resolution", "24", "--layout", "bb")
        self.assertNotIn("precision", run.stderr)
        run = self.run_sherd("dataset", os.path.dirname(self.far), "-o", self.path_of("centered"), "--pieces", "2..3", "--repeats", "1..1", "--resolution", "24", "--write", "mesh",
                             "--mesh-format", "ply,glb", "--recenter")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertNotIn("precision", run.stderr)
        manifests = list(pathlib.Path(self.path_of("centered")).rglob("manifest.json"))
        self.assertEqual(len(manifests), 2)
        for manifest in manifests:
            self.assertEqual(json.loads(manifest.read_text())["offset"], UTM.tolist())
        rows = [json.loads(line) for line in pathlib.Path(self.path_of("centered"), "index.jsonl").read_text().splitlines()]
        self.assertTrue(rows and all(row["offset"] == UTM.tolist() for row in rows))


if __name__ == "__main__":
    unittest.main()
