#!/usr/bin/python3
"""Inputs of which some bodies can be cut exactly and others cannot: these alone get smooth surfaces, in every file, with the reason.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy.
"""
import collections
import json
import os
import pathlib
import unittest

import numpy as np

from cli_test import CommandLine
from exact_test import areas, volume
from glb_file import Glb
from ply_file import columns, read_ply
from usd_file import read_usda

CENTER = 4.0  # of the body that can't be cut, along x


RESOLUTION = 32  # of fracture()
H = (CENTER + 2) / (RESOLUTION - 13 / 3)  # the voxel size that this gives


def bad():
    """An open box with a small one beside it that no crack meets, a third of a voxel away: their voxels are joined, and a fragment would be both."""
    large, faces = box((CENTER - 1, -1, -1), (CENTER + 1, 1, 1))
    low = np.array((CENTER + 1 + H / 3, 0.1, 0.1))
    small, _ = box(low, low + 4 * H)
    return np.vstack((large, small)), faces[1:] + [tuple(8 + v for v in f) for f in faces[1:]]


def box(low, high):
    vertices = np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)], float)
    return vertices, [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def write_objects(path, objects):
    first = 1
    with open(path, "w") as out:
        for name, (vertices, faces) in objects:
            out.write(f"o {name}\n")
            out.writelines("v %r %r %r\n" % tuple(map(float, v)) for v in vertices)
            out.writelines("vt %r %r\n" % (float(v[0]) / 8, float(v[1]) / 8) for v in vertices)
            out.writelines("f " + " ".join(f"{first + v}/{first + v}" for v in f) + "\n" for f in fans(faces))
            first += len(vertices)


def is_closed(triangles):
    edges = collections.Counter((int(t[k]), int(t[(k + 1) % 3])) for t in triangles for k in range(3))
    return all(n == 1 and edges[b, a] == 1 for (a, b), n in edges.items())


def fans(faces):
    return np.array([(f[0], f[k], f[k + 1]) for f in faces for k in range(1, len(f) - 1)])


class Bodies(CommandLine):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.mesh = pathlib.Path(cls.data) / "bodies.obj"
        cls.good = box((-1, -1, -1), (1, 1, 1)), box((-1, 2, -1), (2, 3, 1))
        write_objects(cls.mesh, (("crate", cls.good[0]), ("lamp", bad()), ("shelf", cls.good[1])))

    def broken(self, *options, **more):
        return self.done(*options, **{"mesh": str(self.mesh), "pieces": 9, **more})

    def kinds(self, manifest):
        """By the fragments' places: the lamp's are smooth, all others exact."""
        found = {f["id"]: f["surface"] for f in manifest["fragments"]}
        self.assertEqual(found, {f["id"]: "smooth" if f["centroid"][0] > 2.5 else "exact" for f in manifest["fragments"]})
        return found

    def test_the_manifest_and_one_line_say_which_are_smooth_and_why(self):
        for options in (("--surface", "exact"), ()):
            result = self.broken("--write", "mesh", *options)
            manifest = self.manifest()
            kinds = self.kinds(manifest)
            smooth = [k for k, kind in kinds.items() if kind == "smooth"]
            self.assertTrue(0 < len(smooth) < len(kinds))
            self.assertNotIn("exact_failure", manifest)
            (entry,) = manifest["smooth_bodies"]
            self.assertEqual((entry["fragments"], entry["objects"]), (smooth, ["lamp"]))
            (line,) = [s for s in result.stderr.splitlines() if "smooth surface" in s]
            self.assertIn(f"{len(smooth)} of {len(kinds)} fragments have the smooth surface instead of the exact one: {smooth[0]}", line)
            self.assertIn(f"('lamp'), since {entry['reason']}", line)
            report = json.loads(self.broken("--write", "mesh", "--json", *options).stdout)
            self.assertEqual([s for s in report["warnings"] if "smooth surface" in s], [line.removeprefix("sherd: warning: ")])
            for fragment in manifest["fragments"]:
                self.assertTrue(all(kinds[c["id"]] == fragment["surface"] for c in fragment["contacts"]))

    def test_every_mesh_format_holds_both_kinds(self):
        self.broken("--write", "mesh", "--mesh-format", "ply,obj,glb,stl", "--source-faces")
        manifest = self.manifest()
        sums = collections.Counter()
        for fragment in manifest["fragments"]:
            files = {os.path.splitext(name)[1]: os.path.join(self.out, name) for name in fragment["files"]["mesh"]}
            _, vertex, face = read_ply(files[".ply"])
            vertices = columns(vertex, *"xyz")
            triangles = fans(face["vertex_indices"])
            self.assertTrue(is_closed(triangles))
            self.assertAlmostEqual(volume(vertices, triangles), fragment["volume"], 9)
            sums[fragment["surface"]] += volume(vertices, triangles)
            self.assertTrue(all(n == 0 or manifest["fragments"][n - 1]["surface"] == fragment["surface"] for n in face["neighbor"]))
            obj = pathlib.Path(files[".obj"]).read_text().splitlines()
            of_obj = np.array([list(map(float, s.split()[1:4])) for s in obj if s.startswith("v ")])
            of_faces = fans([[int(c.split("/")[0]) - 1 for c in s.split()[1:]] for s in obj if s.startswith("f ")])
            self.assertAlmostEqual(volume(of_obj, of_faces), fragment["volume"], 7)
            self.assertAlmostEqual(areas(of_obj, of_faces).sum(), fragment["area"], 7)
            self.assertTrue(any(s.startswith("vt ") for s in obj))
            glb = Glb(self, files[".glb"]).whole()
            self.assertAlmostEqual(abs(volume(*glb[:2])), fragment["volume"], 4)
            data = pathlib.Path(files[".stl"]).read_bytes()
            self.assertEqual(int.from_bytes(data[80:84], "little"), len(triangles))
        self.assertAlmostEqual(sums["exact"], 8 + 6, 9)
        self.assertAlmostEqual(sums["smooth"], 8 + (4 * H) ** 3, delta=26 * H / 2)  # half a voxel of the surface

    def test_scenes_and_points_hold_both_kinds(self):
        self.broken("--write", "mesh,scene,usd,preview", "--points", "200", "--triangles", "60")
        manifest = self.manifest()
        self.kinds(manifest)
        Glb(self, os.path.join(self.out, manifest["scene"]))
        _, root = read_usda(pathlib.Path(self.out, "scene.usda").read_text())
        bodies = [prim for _, prim in root.walk() if "PhysicsRigidBodyAPI" in prim.metadata.get("apiSchemas", [])]
        meshes = [body.variants["lod"]["LOD0"].child(body.name) for body in bodies]
        self.assertEqual(len(meshes), len(manifest["fragments"]))
        for fragment, prim in zip(manifest["fragments"], meshes):
            triangles = np.array(prim.values["faceVertexIndices"]).reshape(-1, 3)
            self.assertAlmostEqual(volume(np.array(prim.values["points"]), triangles) / fragment["volume"], 1, delta=1e-4)
        for fragment in manifest["fragments"]:
            data = pathlib.Path(self.out, fragment["files"]["points"]).read_bytes().split(b"end_header\n", 1)[1]
            points = np.frombuffer(data, np.uint8).reshape(200, -1)[:, :12].copy().view("<f4")
            low, high = np.array(fragment["bbox"]["min"]), np.array(fragment["bbox"]["max"])
            self.assertTrue(np.all(points > low - 1e-5) and np.all(points < high + 1e-5))
            (coarse,) = fragment["decimated"]
            _, vertex, face = read_ply(os.path.join(self.out, coarse["file"]))
            self.assertTrue(is_closed(fans(face["vertex_indices"])))
            self.assertAlmostEqual(volume(columns(vertex, *"xyz"), fans(face["vertex_indices"])) / fragment["volume"], 1, delta=0.25)

    def test_pieces_are_broken_again(self):
        self.broken("--write", "mesh,labels,vdb")
        before = self.manifest()
        kinds = self.kinds(before)
        for kind in ("exact", "smooth"):
            one = next(k for k, own in kinds.items() if own == kind)
            again = self.path("again_" + kind)
            result = self.run_sherd("fracture", os.path.join(self.out, "manifest.json"), "--only", str(one), "--pieces", "3", "--write", "mesh", "-o", again)
            self.assertEqual(result.returncode, 0, result.stderr)
            after = self.manifest(again)
            self.assertNotIn("exact_failure", after)
            sum_of = sum(f["volume"] for f in after["fragments"] if f["parent"] == one)
            self.assertAlmostEqual(sum_of / before["fragments"][one - 1]["volume"], 1, delta=1e-6)


if __name__ == "__main__":
    unittest.main()
