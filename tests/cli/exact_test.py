#!/usr/bin/python3
"""--surface exact: the outside of the pieces is the input's mesh, as another reader finds it.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy.
"""
import collections
import fractions
import json
import math
import os
import pathlib
import unittest

import numpy as np

from agreement_test import labels_of
from cli_test import CommandLine, sphere, tree, write_obj
from ply_file import columns, read_ply

TEETH = 9


def gear():
    """Vertices and triangles of a prism over a star, which has sharp edges, in coordinates that single precision lacks."""
    corners = 2 * TEETH
    ring = [((1.0 if k % 2 else 0.7) * math.cos(2 * math.pi * k / corners), (1.0 if k % 2 else 0.7) * math.sin(2 * math.pi * k / corners))
            for k in range(corners)]
    vertices = [(x, y, z) for z in (-0.2, 0.25) for x, y in ring] + [(0.01, 0.02, -0.2), (0.01, 0.02, 0.25)]
    triangles = []
    for k in range(corners):
        n = (k + 1) % corners
        triangles += [(k, n, corners + n), (k, corners + n, corners + k), (n, k, 2 * corners), (corners + k, corners + n, 2 * corners + 1)]
    return np.array(vertices), np.array(triangles)


def texcoord(p):
    return np.array([0.4 * p[0] + 0.3 * p[2], 0.5 * p[1] - 0.2 * p[2]])


def write_textured(path, vertices, triangles):
    """With texture coordinates that are linear in the position, so that any cut keeps them so, and two materials."""
    path.with_suffix(".mtl").write_text("newmtl sides\nKd 1 0 0\nnewmtl caps\nKd 0 0 1\n")
    with open(path, "w") as out:
        out.write(f"mtllib {path.stem}.mtl\n")
        out.writelines("v %r %r %r\n" % tuple(map(float, v)) for v in vertices)
        out.writelines("vt %.9g %.9g\n" % tuple(texcoord(v)) for v in vertices)
        for first, name in ((0, "sides"), (2, "caps")):
            out.write(f"usemtl {name}\n")
            out.writelines("f " + " ".join(f"{v + 1}/{v + 1}" for v in t) + "\n" for k, t in enumerate(triangles) if k % 4 // 2 * 2 == first)


def areas(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def volume(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def write_boxes(path, boxes):
    """An .obj with an object for each name: a box from a low corner to a high one."""
    faces = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]
    with open(path, "w") as out:
        for i, (name, box) in enumerate(boxes.items()):
            out.write(f"o {name}\n")
            out.writelines("v %r %r %r\n" % tuple(box[c >> (2 - k) & 1][k] for k in range(3)) for c in range(8))
            out.writelines("f %d %d %d %d\n" % tuple(8 * i + v for v in face) for face in faces)


def rotated(corners):
    """A triangle's corners in their order, the least first."""
    corners = [tuple(c) for c in corners]
    k = corners.index(min(corners))
    return tuple(corners[k:] + corners[:k])


class Exact(CommandLine):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.mesh = pathlib.Path(cls.data) / "gear.obj"
        cls.vertices, cls.triangles = gear()
        write_textured(cls.mesh, cls.vertices, cls.triangles)

    def exact(self, *options, **more):
        return self.done("--surface", "exact", "--precision", "double", "--write", "mesh", *options, **{"mesh": str(self.mesh), "pieces": 7, **more})

    def pieces(self, out=None):
        """The files of the pieces: vertices, triangles, neighbors, and all columns of faces."""
        for fragment in self.manifest(out)["fragments"]:
            _, vertex, face = read_ply(os.path.join(out or self.out, fragment["files"]["mesh"]))
            yield fragment["id"], columns(vertex, *"xyz"), face["vertex_indices"], face["neighbor"], face

    def test_the_outside_is_the_inputs(self):
        for options in ("--roughness 0", "--roughness 1.5", "--roughness 1.5 --adaptivity 0.3"):
            self.exact(*options.split())
            manifest = self.manifest()
            self.assertNotIn("exact_failure", manifest)
            self.assertEqual({f["surface"] for f in manifest["fragments"]}, {"exact"})
            self.assertTrue(all(f["rounded_crossings"] >= 0 for f in manifest["fragments"]))
            whole = {rotated(self.vertices[t]) for t in self.triangles}
            input_vertices = {tuple(v) for v in self.vertices}
            outer = total = 0.0
            seen = set()
            for fragment, (_, v, f, neighbor, _) in zip(manifest["fragments"], self.pieces()):
                self.assertEqual(v.dtype, np.float64)
                edges = collections.Counter((int(t[k]), int(t[(k + 1) % 3])) for t in f for k in range(3))
                self.assertTrue(all(n == 1 and edges[b, a] == 1 for (a, b), n in edges.items()), "closed, manifold and oriented")
                outer += areas(v, f[neighbor == 0]).sum()
                total += volume(v, f)
                self.assertAlmostEqual(volume(v, f) / fragment["volume"], 1, delta=1e-9)
                for t in f[neighbor == 0]:
                    if all(tuple(v[k]) in input_vertices for k in t):
                        seen.add(rotated(v[t]))
            self.assertAlmostEqual(outer / areas(self.vertices, self.triangles).sum(), 1, delta=1e-9)
            self.assertAlmostEqual(total / volume(self.vertices, self.triangles), 1, delta=1e-9)
            self.assertLessEqual({t for t in seen if t in whole}, whole)
            self.assertGreater(len(seen & whole), 10, "some triangles are whole")

    def tube(self, offset):
        """A mesh whose rim is thin, so that cracks meet it at acute angles, in numbers that floats have near the origin."""
        profile = [(0.6, 0), (0.8, 0.9), (0.9, 1.5), (0.84, 1.5), (0.74, 0.9), (0.55, 0.08)]
        v = np.array([(r * math.cos(2 * math.pi * k / 40), r * math.sin(2 * math.pi * k / 40), z) for r, z in profile for k in range(40)])
        f = [t for i in range(6) for k in range(40) for a, b, c, d in [(40 * i + k, 40 * i + (k + 1) % 40, 40 * ((i + 1) % 6) + (k + 1) % 40, 40 * ((i + 1) % 6) + k)]
             for t in ((a, b, c), (a, c, d))]
        mesh = self.path("tube.obj")
        write_obj(mesh, ((v.astype(np.float32).astype(float) + offset).tolist(), f))
        return mesh

    def crossings(self):
        return sum(fragment["rounded_crossings"] for fragment in self.manifest()["fragments"])

    def test_files_of_single_precision_are_sound(self):
        mesh = self.tube(0)
        for more in ((), ("--mesh-format", "ply,glb"), ("--precision", "single")):
            run = self.done("--surface", "exact", "--write", "mesh", *more, mesh=mesh, pieces=20)
            self.assertNotIn("triangles", "".join(line for line in run.stderr.splitlines() if "warning" in line))
            self.assertEqual(self.crossings(), 0)
            self.assertEqual(self.manifest()["options"]["mesh_precision"], "single" if "single" in more else "double")
        for _, v, f, *_ in self.pieces():
            self.assertTrue((v == v.astype(np.float32)).all())
            a, b, c = ([[fractions.Fraction(float(x)) for x in v[t[k]]] for t in f] for k in range(3))
            for p, q, r in zip(a, b, c):
                u, w = [x - y for x, y in zip(q, p)], [x - y for x, y in zip(r, p)]
                self.assertTrue(any(u[i] * w[(i + 1) % 3] != u[(i + 1) % 3] * w[i] for i in range(3)), "it has an area")

    def test_default_files_are_double_and_others_are_warned_of(self):
        """Where floats lose more than a hundredth of a voxel, slivers rounded to them cross each other."""
        mesh = self.tube((90000, -70000, 50000))
        options = ("--surface", "exact", "--adaptivity", "0", "--write", "mesh")
        run = self.done(*options, mesh=mesh, pieces=20)
        self.assertNotIn("pairs of triangles", run.stderr)
        self.assertEqual(self.manifest()["options"]["mesh_precision"], "double")
        crossings = self.crossings()
        self.assertGreater(crossings, 0)
        self.assertTrue(all(v.dtype == np.float64 and (v != v.astype(np.float32)).any() for _, v, *_ in self.pieces()))
        for more in (("--mesh-format", "ply,glb"), ("--precision", "single")):
            run = self.done(*options, *more, mesh=mesh, pieces=20)
            self.assertIn(f"warning: {crossings} pairs of triangles cross each other", run.stderr)
        library = self.path("library")
        os.mkdir(library)
        os.rename(mesh, os.path.join(library, "tube.obj"))
        for layout in ("sherd", "packed"):
            for form, warnings in (("ply", 0), ("ply,glb", 1)):
                with self.subTest((layout, form)):
                    run = self.run_sherd("dataset", library, "-o", self.path(layout + form), "--pieces", "18..20", "--repeats", "1", "--surface", "exact", "--adaptivity", "0", "--write", "mesh",
                                         "--layout", layout, "--mesh-format", form)
                    self.assertEqual(run.returncode, 0, run.stderr)
                    self.assertEqual(run.stderr.count("pairs of triangles cross each other"), warnings, "once for each object")

    def test_both_sides_of_a_crack_have_the_same_faces(self):
        for adaptivity in ("auto", "0.3"):
            self.exact("--roughness", "1", "--adaptivity", adaptivity)
            faces = collections.Counter()
            for own, v, f, neighbor, _ in self.pieces():
                for t, other in zip(f, neighbor):
                    if other != 0:
                        faces[own, int(other), rotated(v[t])] += 1
                        faces[int(other), own, rotated(v[t[::-1]])] -= 1
            self.assertGreater(len(faces), 0)
            self.assertEqual({n for n in faces.values()}, {0})

    def test_texture_coordinates_and_materials_stay(self):
        self.exact("--roughness", "1")
        for _, v, f, neighbor, face in self.pieces():
            for t, other, uv, material in zip(f, neighbor, face["texcoord"].reshape(-1, 3, 2), face["material"]):
                if other != 0:
                    self.assertEqual(material, 2)  # inside
                    continue
                normal = np.abs(np.cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]))
                self.assertEqual(material, 1 if normal[2] > normal[:2].max() else 0)
                for k in range(3):
                    self.assertLess(np.abs(uv[k] - texcoord(v[t[k]])).max(), 1e-6)

    def test_the_intact_object_is_the_input(self):
        self.exact("--write", "mesh,solid")
        _, vertex, face = read_ply(os.path.join(self.out, self.manifest()["solid"]["mesh"]))
        np.testing.assert_array_equal(columns(vertex, *"xyz"), self.vertices)
        self.assertEqual({tuple(sorted(t)) for t in face["vertex_indices"].tolist()}, {tuple(sorted(t)) for t in self.triangles.tolist()})
        self.assertEqual(set(face["material"].tolist()), {0, 1})

    def test_normals_split_at_sharp_edges(self):
        self.exact("--mesh-format", "obj")
        for fragment in self.manifest()["fragments"]:
            rows = [line.split() for line in pathlib.Path(self.out, fragment["files"]["mesh"]).read_text().splitlines()]
            v = np.array([list(map(float, r[1:4])) for r in rows if r and r[0] == "v"])
            vn = np.array([list(map(float, r[1:4])) for r in rows if r and r[0] == "vn"])
            material = None
            for r in rows:
                if r and r[0] == "usemtl":
                    material = r[1]
                if not r or r[0] != "f" or material == "inside":
                    continue
                corners = [list(map(int, c.replace("//", "/0/").split("/"))) for c in r[1:]]
                a, b, c = (v[k[0] - 1] for k in corners)
                normal = np.cross(b - a, c - a)
                if np.linalg.norm(normal) < 1e-6:
                    continue
                for corner in corners:  # all faces of the prism are planes
                    self.assertGreater(vn[corner[-1] - 1] @ normal / np.linalg.norm(normal), 0.999)

    def test_the_same_bytes_on_one_thread(self):
        for adaptivity in ("auto", "0.3"):
            self.exact("--roughness", "1", "--adaptivity", adaptivity)
            again = self.path("again")
            self.exact("--roughness", "1", "--adaptivity", adaptivity, "--threads", "1", out=again)
            self.assertEqual(tree(self.out), tree(again))

    def test_what_contradicts_it_is_refused(self):
        for options in (("--smooth-iterations", "2"), ("--erode-iterations", "1", "--erode-on", "all")):
            self.refused(2, self.fracture("--surface", "exact", *options))
            self.nothing_written()

    def united(self, boxes, pieces, expected, *options):
        """Breaks boxes, given by two corners each, and holds the fragments against the volume of their union."""
        corners, faces = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], \
            [(4, 3, 2, 1), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8)]
        mesh = os.path.join(self.data, "boxes.obj")
        with open(mesh, "w") as out:
            for i, box in enumerate(boxes):
                out.writelines("v %r %r %r\n" % tuple(box[c[k]][k] for k in range(3)) for c in corners)
                out.writelines("f %d %d %d %d\n" % tuple(8 * i + v for v in face) for face in faces)
        result = self.exact(*options, mesh=mesh, pieces=pieces)
        self.assertIn(f"{len(boxes)} bodies, of which some overlap or touch, were united to 1\n", result.stderr)
        self.assertNotIn("overlaps", result.stderr)
        manifest = self.manifest()
        self.assertNotIn("exact_failure", manifest)
        self.assertLess(abs(manifest["report"]["mesh_volume"] - expected), 1e-9 * expected)
        self.assertEqual(manifest["bodies"], {"input": len(boxes), "united": 1})
        done = self.run_sherd("evaluate", self.out, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual(len(found["fragments"]), pieces)
        self.assertEqual((found["sound"], found["overlap"]["share"]), (pieces, 0.0))
        for fragment in found["fragments"]:
            quality = fragment["quality"]
            self.assertEqual((quality["components"], quality["closed"], quality["manifold"], quality["outward"]), (1, True, True, True))
        total = sum(fragment["volume"] for fragment in found["fragments"])
        self.assertLess(abs(total - expected), 1e-9 * expected)

    def test_bricks_that_touch_are_one_body(self):
        # Coordinates are binary fractions, so that faces meet exactly, in a running bond.
        wall = [((x, 0, z), (x + 2, 1, z + 1)) for z in range(4) for x in (2 * i + z % 2 for i in range(4))]
        self.united(wall, 12, 32)

    def test_planks_that_overlap_are_one_body(self):
        # Four posts, and four rails of a frame through each end of them.
        posts = [((x, y, 0), (x + 0.25, y + 0.25, 2)) for x in (0, 1.75) for y in (0, 1.75)]
        rails = [box for z in (0.25, 1.5) for at in (0.0625, 1.8125)
                 for box in (((0.125, at, z), (1.875, at + 0.125, z + 0.25)), ((at, 0.125, z), (at + 0.125, 1.875, z + 0.25)))]
        # Two rails meet in each corner, within a post: a rail has a length of 1.5 between the posts.
        self.united(posts + rails, 12, 4 * 0.125 + 8 * 1.5 * 0.125 * 0.25, "--roughness", "1")

    def test_bodies_can_be_kept(self):
        """Two boxes with a face in common, and a third that reaches into both."""
        boxes = {"left": ((0, 0, 0), (2, 1, 1)), "right": ((2, 0, 0), (4, 1, 1)), "pin": ((1.5, 0.25, 0.25), (2.5, 0.75, 1.5))}
        mesh = self.path("kept.obj")
        faces = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]
        with open(mesh, "w") as out:
            for i, (name, box) in enumerate(boxes.items()):
                out.write(f"o {name}\n")
                out.writelines("v %r %r %r\n" % tuple(box[c >> (2 - k) & 1][k] for k in range(3)) for c in range(8))
                out.writelines("f %d %d %d %d\n" % tuple(8 * i + v for v in face) for face in faces)
        volumes = [2.0, 2.0, 0.625]
        for options in ((), ("--roughness", "1")):
            result = self.exact("--bodies", "keep", *options, mesh=mesh, pieces=10)
            self.assertNotIn("united", result.stderr)
            manifest = self.manifest()
            self.assertNotIn("exact_failure", manifest)
            self.assertEqual(manifest["options"]["bodies"], "keep")
            self.assertEqual(manifest["bodies"], {"input": 3, "united": 3, "objects": [["left"], ["right"], ["pin"]]})
            self.assertLess(abs(manifest["report"]["mesh_volume"] - 4.625), 1e-9)
            sums, body_of = [0.0] * 3, {}
            for fragment in manifest["fragments"]:
                (body_of[fragment["id"]],) = fragment["bodies"]
                sums[body_of[fragment["id"]]] += fragment["volume"]
            self.assertEqual(len(body_of), 10)
            self.assertLess(max(abs(a - b) for a, b in zip(sums, volumes)), 1e-9)
            pairs = {tuple(sorted((body_of[f["id"]], body_of[c["id"]]))) for f in manifest["fragments"] for c in f["contacts"]}
            self.assertEqual({pair for pair in pairs if pair[0] != pair[1]}, {(0, 1), (0, 2), (1, 2)})
            worn = self.exact("--bodies", "keep", "--erode-iterations", "1", *options, mesh=mesh, pieces=10, out=self.path("worn"))
            self.assertNotIn("the mesh's own", "".join(line for line in worn.stderr.splitlines() if "warning" in line))
            found = json.loads(self.run_sherd("evaluate", self.out, "--json").stdout)
            self.assertEqual(found["sound"], 10)
            for fragment in found["fragments"]:
                self.assertEqual((fragment["quality"]["components"], fragment["quality"]["closed"]), (1, True))

    def test_bodies_of_open_meshes_are_not_kept(self):
        vertices, triangles = sphere()
        write_obj(self.path("open.obj"), (vertices, triangles[1:]))
        self.assertIn("open.obj: bodies are not kept, since they are known of closed meshes", self.exact("--bodies", "keep", mesh=self.path("open.obj")).stderr)
        self.assertNotIn("bodies", self.exact(mesh=self.path("open.obj")).stderr)
        self.assertNotIn("bodies", self.manifest()["options"])

    def test_the_manifest_gives_the_bodies_of_fragments(self):
        """Of which they have faces: by the positions of these, on the surfaces of boxes."""
        boxes = {"left": ((0, 0, 0), (2, 1, 1)), "right": ((1.75, 0.25, 0.25), (4, 1.25, 1.25)), "apart": ((0, 3, 0), (2, 4, 1))}
        mesh = self.path("three.obj")
        write_boxes(mesh, boxes)
        self.exact("--plain-meshes", mesh=mesh, pieces=9)
        manifest = self.manifest()
        self.assertEqual(manifest["bodies"], {"input": 3, "united": 2, "objects": [["left"], ["right"], ["apart"]]})
        inspected = json.loads(self.run_sherd("inspect", os.path.join(self.out, "manifest.json"), "--json").stdout)
        self.assertEqual(inspected["bodies"], 3)
        for fragment in manifest["fragments"]:
            _, vertex, face = read_ply(os.path.join(self.out, fragment["files"]["mesh"]))
            corners = columns(vertex, *"xyz")[face["vertex_indices"]]
            found = []
            for number, (low, high) in enumerate(np.array(list(boxes.values()), float)):
                for k in range(3):
                    flat = ((corners >= low) & (corners <= high)).all((1, 2))
                    if any((flat & (corners[:, :, k] == side[k]).all(1)).any() for side in (low, high)):
                        found.append(number)
                        break
            self.assertEqual(fragment["bodies"], found)
        self.assertEqual({tuple(f["bodies"]) for f in manifest["fragments"]} & {(2,)}, {(2,)})
        self.done("--surface", "smooth", mesh=mesh, out=self.path("smooth"))
        self.assertNotIn("bodies", self.manifest(self.path("smooth")))
        self.exact(out=self.path("one"))
        self.assertNotIn("bodies", self.manifest(self.path("one")))

    def test_contacts_without_voxel_faces_are_apart(self):
        """Two cubes and a rod between them that is thinner than a voxel: by the labels they do not touch."""
        mesh = self.path("joined.obj")
        boxes = [((-1.3, -0.5, -0.5), (-0.3, 0.5, 0.5)), ((0.3, -0.5, -0.5), (1.3, 0.5, 0.5)), ((-0.5, 0.12, 0.12), (0.5, 0.14, 0.14))]
        write_boxes(mesh, {f"box{k}": box for k, box in enumerate(boxes)})
        self.exact("--write", "labels", mesh=mesh, pieces=2)
        manifest = self.manifest()
        voxels = labels_of(pathlib.Path(self.out), manifest["grid"])
        for axis in range(3):
            a, b = np.moveaxis(voxels, axis, 0)[:-1], np.moveaxis(voxels, axis, 0)[1:]
            self.assertFalse(((a > 1) & (b > 1) & (a != b)).any())
        for fragment, other in zip(manifest["fragments"], (2, 1)):
            self.assertEqual((fragment["contacts"], [c["id"] for c in fragment["thin_contacts"]]), ([], [other]))
            self.assertGreaterEqual(fragment["thin_contacts"][0]["area"], 0.0004 * (1 - 1e-9))
            self.assertGreaterEqual(fragment["thin_contacts"][0]["boundary_length"], 0.08 * (1 - 1e-9))
        reported = json.loads(self.run_sherd("evaluate", self.out, "--json").stdout)
        self.assertEqual(reported["contacts"], 1)

    def test_holes_are_closed_by_faces_of_their_own(self):
        vertices, triangles = sphere()
        open_mesh = self.path("open.obj")
        write_obj(open_mesh, (vertices, triangles[1:]))
        result = self.exact("--source-faces", mesh=open_mesh)
        self.assertIn("warning: open.obj: 1 hole was closed by 1 face\n", result.stderr)
        manifest = self.manifest()
        self.assertNotIn("exact_failure", manifest)
        self.assertEqual({f["surface"] for f in manifest["fragments"]}, {"exact"})
        closed = manifest["report"]["closed_holes"]
        a, b, c = (np.array(vertices[i]) for i in triangles[0])
        self.assertEqual((closed["holes"], closed["faces"]), (1, 1))
        self.assertAlmostEqual(closed["area"], np.linalg.norm(np.cross(b - a, c - a)) / 2, 9)  # the file has nine digits
        area = sum(areas(v, f[(neighbor == 0) & (face["source_face"] == -1)]).sum() for _, v, f, neighbor, face in self.pieces())
        self.assertAlmostEqual(area, closed["area"], 12)

    def test_meshes_that_are_not_filled_by_winding_get_the_smooth_surface_with_a_warning(self):
        for options in (("--surface", "exact"), ()):  # automatic is the default
            result = self.done("--write", "mesh", "--fill", "parity", *options, mesh=str(self.mesh), pieces=7)
            self.assertIn("the mesh is not filled by winding numbers, so the fragments have the smooth surface instead of the exact one", result.stderr)
            manifest = self.manifest()
            self.assertEqual(manifest["exact_failure"], "the mesh is not filled by winding numbers")
            self.assertEqual({f["surface"] for f in manifest["fragments"]}, {"smooth"})

    def surfaces(self, *options, **more):
        result = self.done(*options, **{"mesh": str(self.mesh), "pieces": 3, **more})
        manifest = self.manifest(more.get("out"))
        self.assertNotIn("exact_failure", manifest)
        self.assertNotIn("the smooth surface", result.stderr)
        (surface,) = {f["surface"] for f in manifest["fragments"]}
        return surface

    def test_automatic_surfaces_are_exact_where_these_can_be(self):
        self.assertEqual(self.surfaces("--write", "mesh"), "exact")
        meshes = tree(os.path.join(self.out, "meshes"))
        self.assertEqual(self.surfaces("--write", "mesh", "--surface", "exact", out=self.path("asked")), "exact")
        self.assertEqual(tree(os.path.join(self.path("asked"), "meshes")), meshes)
        self.assertEqual(self.surfaces("--write", "labels", "--points", "9"), "exact")
        for options in (("--write", "labels"), ("--interface", "independent"), ("--preset", "training"), ("--smooth-iterations", "2"),
                        ("--erode-iterations", "1", "--erode-on", "all")):
            self.assertEqual(self.surfaces(*options), "smooth")
        self.assertEqual(self.surfaces("--write", "mesh", mesh=self.ball, pieces=1001), "exact")
        self.assertEqual(self.surfaces("--preset", "paper"), "labels")
        # A volume has no triangles, and fragments are broken again as they are.
        self.assertEqual(self.surfaces(out=self.path("volume")), "exact")
        volume = os.path.join(self.path("volume"), self.manifest(self.path("volume"))["fragments"][0]["files"]["vdb"])
        self.assertEqual(self.surfaces(mesh=volume), "smooth")
        for name, options in (("volume", ()), ("smooth", ("--surface", "smooth"))):
            surface = self.surfaces(*options, out=self.path(name))
            again = self.path(name + "-again")
            run = self.run_sherd("fracture", os.path.join(self.path(name), "manifest.json"), "-o", again, "--only", "2", "--pieces", "2")
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual({f["surface"] for f in self.manifest(again)["fragments"]}, {surface})

    def crack_triangles(self, out):
        return sum(int((read_ply(path)[2]["neighbor"] > 0).sum()) for path in pathlib.Path(out, "meshes").glob("*.ply"))

    def test_adaptivity_is_the_tolerance_of_cracks(self):
        counts = []
        for adaptivity in ("0", "auto", "0.1", "0.5"):
            out = self.path("by_" + adaptivity)
            self.exact("--roughness", "1", "--adaptivity", adaptivity, out=out)
            counts.append(self.crack_triangles(out))
        full, auto, tenth, half = counts
        # A rough crack has two triangles or more in each voxel that it passes; half a voxel is as much as it rises in several.
        self.assertLess(tenth, 0.6 * full)
        self.assertEqual(tenth, auto)
        self.assertLess(half, 0.2 * full)

    def test_a_number_leaves_no_more_triangles_than_auto(self):
        """Planes are merged before anything else."""
        ball = self.path("ball.obj")
        write_obj(ball, sphere())
        for roughness in ("0", "2"):
            for mesh in (ball, str(self.mesh)):
                counts = []
                for adaptivity in ("auto", "0.05", "0.5"):
                    out = self.path("with_" + adaptivity)
                    self.exact("--roughness", roughness, "--adaptivity", adaptivity, mesh=mesh, out=out)
                    counts.append(sum(len(f) for _, _, f, *_ in self.pieces(out)))
                self.assertEqual(max(counts), counts[0], (roughness, mesh))

    def test_where_it_does_not_succeed_adaptivity_is_that_of_the_smooth_surface(self):
        options = ("--precision", "double", "--write", "mesh", "--fill", "parity", "--adaptivity", "0.1")
        for surface in ("exact", "smooth"):
            self.done(*options, "--surface", surface, mesh=str(self.mesh), pieces=7, out=self.path("few" if surface == "exact" else surface))
        few, smooth = ([path.read_bytes() for path in sorted(pathlib.Path(self.path(name), "meshes").iterdir())] for name in ("few", "smooth"))
        self.assertEqual(few, smooth)

    def again(self, *options):
        again = self.path("again")
        result = self.run_sherd("fracture", os.path.join(self.out, "manifest.json"), "-o", again, "--surface", "exact", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return again, result.stderr

    def test_fragments_that_are_broken_again_keep_their_surface(self):
        for rough in ("0", "1"):
            self.exact("--roughness", "1", "--write", "labels,vdb,mesh")
            before = {own: (v, f, neighbor) for own, v, f, neighbor, _ in self.pieces()}
            again, errors = self.again("--only", "2,5", "--pieces", "3", "--write", "mesh", "--precision", "double", "--roughness", rough)
            self.assertEqual(errors, "")
            manifest = self.manifest(again)
            self.assertNotIn("exact_failure", manifest)
            self.assertEqual({f["surface"] for f in manifest["fragments"]}, {"exact"})
            parents = {f["id"]: f["parent"] for f in manifest["fragments"]}
            self.assertEqual(collections.Counter(parents.values()), {1: 1, 2: 3, 3: 1, 4: 1, 5: 3, 6: 1, 7: 1})
            outer, contact, volumes, faces = 0.0, collections.Counter(), collections.Counter(), collections.Counter()
            for own, v, f, neighbor, _ in self.pieces(again):
                parent = parents[own]
                edges = collections.Counter((int(t[k]), int(t[(k + 1) % 3])) for t in f for k in range(3))
                self.assertTrue(all(n == 1 and edges[b, a] == 1 for (a, b), n in edges.items()), "closed, manifold and oriented")
                volumes[parent] += volume(v, f)
                outer += areas(v, f[neighbor == 0]).sum()
                for other in set(neighbor) - {0}:
                    contact[own, int(other)] += areas(v, f[neighbor == other]).sum()
                if parent not in (2, 5):
                    old_v, old_f, old_neighbor = before[parent]
                    np.testing.assert_array_equal(v[f], old_v[old_f], "a fragment that is not broken stays")
                    np.testing.assert_array_equal([parents.get(n, 0) for n in neighbor], old_neighbor)
                for t, other in zip(f, neighbor):
                    if other != 0 and parents[other] == parent:
                        faces[own, int(other), rotated(v[t])] += 1
                        faces[int(other), own, rotated(v[t[::-1]])] -= 1
            self.assertGreater(len(faces), 20)
            self.assertEqual({n for n in faces.values()}, {0}, "new cracks are shared")
            self.assertAlmostEqual(outer / areas(self.vertices, self.triangles).sum(), 1, delta=1e-9)
            for parent, (v, f, _) in before.items():
                self.assertAlmostEqual(volumes[parent] / volume(v, f), 1, delta=1e-9)
            # Where old cracks are cut, the other side is not: its faces go to the nearest part.
            total = sum(contact.values())
            for (own, other), area in contact.items():
                self.assertLess(abs(area - contact[other, own]), 0.02 * total)

    def test_fragments_without_meshes_are_broken_again_with_the_reason(self):
        self.done("--write", "labels,vdb", mesh=str(self.mesh), pieces=7)
        again, errors = self.again("--only", "1", "--pieces", "2", "--write", "mesh")
        self.assertIn("the fracture was written without meshes whose neighbors are known, so the fragments have the smooth surface", errors)
        self.assertEqual({f["surface"] for f in self.manifest(again)["fragments"]}, {"smooth"})

    def test_datasets_have_it_too(self):
        library = pathlib.Path(self.path("library"))
        library.mkdir()
        write_obj(library / "ball.obj", sphere())
        write_obj(library / "sheet.obj", (sphere()[0], sphere()[1][:len(sphere()[1]) // 4]))
        # Three squares at an edge: a shell of them crosses itself.
        turns = [2 * math.pi * k / 3 for k in range(3)]
        corners = [(0, 0, 0), (0, 0, 1)] + [(math.cos(a), math.sin(a), z) for a in turns for z in (0, 1)]
        write_obj(library / "fins.obj", (corners, [t for k in (2, 4, 6) for t in ((0, k, k + 1), (0, k + 1, 1))]))
        result = self.run_sherd("dataset", str(library), "-o", self.out, "--pieces", "2..3", "--repeats", "2", "--resolution", "32",
                                "--surface", "exact", "--write", "mesh")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr.count("instead of the exact one"), 1, "once for each object")
        for name, surface in (("ball", "exact"), ("sheet", "exact"), ("fins", "smooth")):
            manifests = list(pathlib.Path(self.out).glob(f"objects/{name}/*/manifest.json"))
            self.assertEqual(len(manifests), 4)
            for path in manifests:
                self.assertEqual({f["surface"] for f in json.loads(path.read_text())["fragments"]}, {surface})


if __name__ == "__main__":
    unittest.main()
