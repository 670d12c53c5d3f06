#!/usr/bin/python3
"""--surface exact: pieces have the input's normals, polygons and objects, as parsers of this test's own find them.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy.
"""
import json
import os
import pathlib
import struct
import unittest

import numpy as np

from glb_file import Glb
from cli_test import CommandLine
from exact_test import TEETH, gear

CORNERS = 2 * TEETH


def polygons():
    """The gear's sides as quads and its caps as polygons that are not convex."""
    vertices, _ = gear()
    sides = [(k, (k + 1) % CORNERS, CORNERS + (k + 1) % CORNERS, CORNERS + k) for k in range(CORNERS)]
    return vertices[:2 * CORNERS], sides + [tuple(range(CORNERS))[::-1], tuple(range(CORNERS, 2 * CORNERS))]


def normal_of(vertex, side):
    """A unit vector in single precision that has nothing to do with the surface; it differs between the sides round a vertex."""
    a = 0.9 * vertex + 2.0 * side
    n = np.array([np.cos(a), np.sin(a), 0.4])
    return np.float32(n / np.linalg.norm(n))


def write(path, vertices, faces, normals=False, groups=()):
    """groups: pairs of a name and the index of its first face."""
    with open(path, "w") as out:
        out.writelines("v %r %r %r\n" % tuple(map(float, v)) for v in vertices)
        for i, face in enumerate(faces):
            out.writelines(f"g {name}\n" for name, first in groups if first == i)
            if normals:
                out.writelines("vn %.9g %.9g %.9g\n" % tuple(normal_of(v, i)) for v in face)
            out.write("f " + " ".join(f"{v + 1}//{k - len(face)}" if normals else str(v + 1) for k, v in enumerate(face)) + "\n")


def read_obj(path):
    """Vertices, and faces: corners, normals of the corners, material, group."""
    vertices, normals, faces, material, group = [], [], [], None, None
    for line in pathlib.Path(path).read_text().splitlines():
        word, *rest = line.split() or [""]
        if word in ("v", "vn"):
            (vertices if word == "v" else normals).append([(float if word == "v" else np.float32)(x) for x in rest[:3]])
        elif word == "usemtl":
            material = rest[0]
        elif word == "g":
            group = rest[0]
        elif word == "f":
            corners = [[int(x) - 1 if x else None for x in c.split("/")] for c in rest]
            faces.append(([c[0] for c in corners], [normals[c[2]] for c in corners], material, group))
    return np.array(vertices), faces


def read_ply(path):
    """Vertices as rows of all their numbers, and faces with their neighbor: lists of any length."""
    head, body = pathlib.Path(path).read_bytes().split(b"end_header\n", 1)
    counts = [int(line.split()[2]) for line in head.splitlines() if line.startswith(b"element")]
    kind = "<f8" if b"property double x" in head else "<f4"
    rows = np.frombuffer(body, [("at", kind, 3), ("normal", "<f4", 3), ("neighbor", "<i4")], counts[0])
    at, faces = rows.nbytes, []
    for _ in range(counts[1]):
        n = body[at]
        faces.append((struct.unpack_from(f"<{n}i", body, at + 1), struct.unpack_from("<i", body, at + 1 + 4 * n)[0]))
        at += 5 + 4 * n
    assert at == len(body)
    return rows, faces


def volume(vertices, faces):
    v = np.asarray(vertices, float)
    return sum(v[f[0]] @ np.cross(v[f[k]], v[f[k + 1]]) for f in faces for k in range(1, len(f) - 1)) / 6


class ExactInput(CommandLine):
    def broken(self, mesh, *options):
        self.done("--surface", "exact", "--write", "mesh", *options, mesh=mesh, pieces=7)
        with open(os.path.join(self.out, "manifest.json")) as file:
            manifest = json.load(file)
        self.assertNotIn("exact_failure", manifest)
        return manifest["fragments"]

    def expect_normal(self, p, found, vertices, faces, geometric):
        """That of a face of the input at the same corner, to the bit, or that between the corners of one of its triangles."""
        for i, face in enumerate(faces):
            c = [vertices[v].astype(float) for v in face]
            flat = np.cross(c[1] - c[0], c[2] - c[0])
            flat /= np.linalg.norm(flat)
            if geometric @ flat < 0.999 or abs((p - c[0]) @ flat) > 1e-6:
                continue
            weights = np.linalg.solve(np.array([c[1] - c[0], c[2] - c[0], flat]).T, p - c[0])[:2]
            weights = np.array([1 - weights.sum(), *weights])
            if weights.min() < -1e-5:
                continue
            if weights.max() > 1 - 1e-6:
                if (normal_of(face[weights.argmax()], i) == found).all():
                    self.same += 1
                    return
            mean = weights @ [normal_of(v, i).astype(float) for v in face]
            if np.linalg.norm(mean / np.linalg.norm(mean) - found) < 2e-4:  # positions are rounded to single precision
                return
        self.fail(f"no triangle has the normal {found} at {p}")

    def corners(self, piece, kind):
        """Positions and normals of the corners of a piece's outer faces."""
        path = os.path.join(self.out, piece["files"]["mesh"])
        if kind == "obj":
            vertices, faces = read_obj(path)
            yield from ((vertices[f].astype(float), normals) for f, normals, material, _ in faces if material != "inside")
            return
        for material, triangles, attributes in Glb(self, path).primitives():
            if material["name"] != "inside":
                yield from ((attributes["POSITION"][t].astype(float), attributes["NORMAL"][t]) for t in triangles)

    def test_normals_stay(self):
        vertices, triangles = gear()
        mesh = self.path("gear.obj")
        write(mesh, vertices, triangles.tolist(), normals=True)
        for kind in ("obj", "glb"):
            self.same = 0
            for piece in self.broken(mesh, "--mesh-format", kind):
                for at, normals in self.corners(piece, kind):
                    cross = np.cross(at[1] - at[0], at[2] - at[0])
                    if np.linalg.norm(cross) < 1e-5:
                        continue  # its plane is lost in single precision
                    for p, normal in zip(at, normals):
                        self.expect_normal(p, normal, vertices, triangles.tolist(), cross / np.linalg.norm(cross))
            self.assertGreater(self.same, 100)

    def test_vertices_of_one_normal_keep_it_in_ply(self):
        vertices, triangles = gear()
        mesh = self.path("gear.obj")
        with open(mesh, "w") as out:
            out.writelines("v %r %r %r\n" % tuple(map(float, v)) for v in vertices)
            out.writelines("vn %.9g %.9g %.9g\n" % tuple(normal_of(i, 0)) for i in range(len(vertices)))
            out.writelines("f " + " ".join(f"{v + 1}//{v + 1}" for v in t) + "\n" for t in triangles)
        known = {tuple(v): normal_of(i, 0) for i, v in enumerate(vertices)}
        same = 0
        for piece in self.broken(mesh, "--precision", "double"):
            rows, faces = read_ply(os.path.join(self.out, piece["files"]["mesh"]))
            rim = {v for f, neighbor in faces if neighbor for v in f}
            for i, row in enumerate(rows):
                if i not in rim and tuple(row["at"]) in known:
                    np.testing.assert_array_equal(row["normal"], known[tuple(row["at"])])
                    same += 1
                self.assertAlmostEqual(float(np.linalg.norm(row["normal"].astype(float))), 1, delta=1e-6)
        self.assertGreater(same, 20)

    def test_whole_polygons_stay(self):
        vertices, faces = polygons()
        mesh = self.path("gear.obj")
        write(mesh, vertices, faces)
        whole = {tuple(map(tuple, np.asarray(vertices)[list(f)].tolist())) for f in faces}
        pieces = self.broken(mesh, "--mesh-format", "ply,obj")
        counts = dict.fromkeys(("ply", "obj"), 0)
        for piece in pieces:
            for path in piece["files"]["mesh"]:
                kind = path[-3:]
                if kind == "ply":
                    rows, found = read_ply(os.path.join(self.out, path))
                    v, found = rows["at"], [f for f, _ in found]
                else:
                    v, found = read_obj(os.path.join(self.out, path))
                    found = [f for f, *_ in found]
                triangles = sum(len(f) - 2 for f in found)
                self.assertAlmostEqual(volume(v, found) / piece["volume"], 1, delta=1e-5)
                for f in found:
                    if len(f) > 3:
                        self.assertIn(tuple(map(tuple, v[list(f)].tolist())), whole)
                        counts[kind] += 1
                again = self.run_sherd("inspect", os.path.join(self.out, path), "--json")
                self.assertEqual(json.loads(again.stdout)["triangles"], triangles)
        self.assertGreater(counts["ply"], 3)
        self.assertEqual(counts["ply"], counts["obj"])

    def test_the_intact_object_has_all_polygons(self):
        vertices, faces = polygons()
        mesh = self.path("gear.obj")
        write(mesh, vertices, faces)
        self.done("--surface", "exact", "--write", "mesh,solid", "--mesh-format", "obj", mesh=mesh, pieces=3)
        with open(os.path.join(self.out, "manifest.json")) as file:
            v, found = read_obj(os.path.join(self.out, json.load(file)["solid"]["mesh"]))
        self.assertEqual({tuple(map(tuple, v[f].tolist())) for f, *_ in found},
                         {tuple(map(tuple, np.asarray(vertices)[list(f)].tolist())) for f in faces})

    def test_objects_are_groups(self):
        vertices, faces = polygons()
        mesh = self.path("gear.obj")
        write(mesh, vertices, faces, groups=(("the sides", 0), ("caps", CORNERS)))
        names = set()
        for piece in self.broken(mesh, "--mesh-format", "obj"):
            v, found = read_obj(os.path.join(self.out, piece["files"]["mesh"]))
            for f, _, material, group in found:
                flat = np.cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]]).astype(float)
                if material == "inside" or np.linalg.norm(flat) < 1e-6:
                    self.assertTrue(material != "inside" or group == "inside")
                    continue
                self.assertEqual(group, "caps" if abs(flat[2]) > 0.9 * np.linalg.norm(flat) else "the_sides")
                names.add(group)
        self.assertEqual(names, {"caps", "the_sides"})
        write(mesh, vertices, faces)
        piece = self.broken(mesh, "--mesh-format", "obj")[0]
        self.assertNotIn("\ng ", pathlib.Path(self.out, piece["files"]["mesh"]).read_text())


if __name__ == "__main__":
    unittest.main()
