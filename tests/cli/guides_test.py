#!/usr/bin/python3
"""Densities of pieces, and cracks that are given, by the program: what comes of them, what the manifest says, and what is refused.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy and python3-openvdb.
"""
import gzip
import hashlib
import json
import math
import os

import numpy as np
import pyopenvdb as vdb

import skipping
from cli_test import CommandLine, sphere, write_obj
from ply_file import read_triangles


def halved_box():
    """A box -1..1 along x of two halves, open to each other, so that each has vertices of its own."""
    vertices, triangles = [], []
    for side in (-1, 1):
        first = len(vertices)
        for end in (0, side):
            vertices += [(end, y, z) for y, z in ((-.5, -.5), (.5, -.5), (.5, .5), (-.5, .5))]
        faces = [(i, i + 4, (i + 1) % 4) for i in range(4)] + [((i + 1) % 4, i + 4, (i + 1) % 4 + 4) for i in range(4)] + [(4, 6, 5), (4, 7, 6)]
        triangles += [tuple(first + i for i in (t if side > 0 else (t[0], t[2], t[1]))) for t in faces]
    return vertices, triangles


def write_valued_ply(path, mesh, values, name="wear"):
    vertices, triangles = mesh
    with open(path, "w") as out:
        out.write(f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
                  f"property float {name}\nproperty uchar red\nelement face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
        out.writelines(f"{x:.9g} {y:.9g} {z:.9g} {value} {round(255 - 10 * min(value, 20)) if value >= 0 else 0}\n"
                       for (x, y, z), value in zip(vertices, values))
        out.writelines("3 {} {} {}\n".format(*t) for t in triangles)


def write_lines(path, *lines):
    """Polylines as OBJ; one whose last point is its first closes."""
    with open(path, "w") as out:
        first = 1
        for line in lines:
            out.writelines("v {:.9g} {:.9g} {:.9g}\n".format(*p) for p in line)
            out.write("l " + " ".join(str(first + i) for i in range(len(line))) + "\n")
            first += len(line)


def ring(radius, z, points=60):
    line = [(radius * math.cos(2 * math.pi * i / points), radius * math.sin(2 * math.pi * i / points), z) for i in range(points)]
    return line + line[:1]


class Guided(CommandLine):
    def meshes(self):
        folder = os.path.join(self.out, "meshes")
        return [read_triangles(os.path.join(folder, name)) for name in sorted(os.listdir(folder)) if name.endswith(".ply")]


class Densities(Guided):
    def test_pieces_are_as_many_as_the_density_says(self):
        mesh = halved_box()
        box = self.path("box.ply")
        write_valued_ply(box, mesh, [1 if i < 8 else 8 for i in range(16)])
        left = pieces = 0
        for seed in range(5):
            self.done("--write", "seeds", "--density-attribute", "wear", "--seed", str(seed), mesh=box, pieces=180)
            with open(os.path.join(self.out, "seeds.json")) as file:
                seeds = json.load(file)["seeds"]
            left += sum(s["position"][0] < 0 for s in seeds)
            pieces += len(seeds)
        self.assertEqual(pieces, 900)
        self.assertLess(abs(left - 100), 4 * math.sqrt(900 * 8 / 81))  # one in nine: a binomial distribution
        self.assertEqual(self.manifest()["options"]["seeds"]["density"], "wear")

    def test_a_grid_is_a_density(self):
        grid = vdb.FloatGrid(0.0)
        grid.fill((-64, -64, -64), (64, 64, 0), 1.0)
        grid.transform = vdb.createLinearTransform(voxelSize=1 / 32)
        grid.name = "stress"
        other = vdb.FloatGrid(1.0)
        other.name = "other"
        vdb.write(self.path("two.vdb"), [grid, other])
        vdb.write(self.path("one.vdb"), [grid])
        for source, recorded in (("two.vdb:stress", "two.vdb:stress"), ("one.vdb", "one.vdb")):
            self.done("--write", "seeds", "--density-attribute", self.path(source), pieces=40)
            with open(os.path.join(self.out, "seeds.json")) as file:
                self.assertLess(max(s["position"][2] for s in json.load(file)["seeds"]), 1 / 16)
            self.assertEqual(self.manifest()["options"]["seeds"]["density"], recorded)
        self.refused(3, self.fracture("--density-attribute", self.path("two.vdb")), "two.vdb", "'stress', 'other'")
        self.refused(3, self.fracture("--density-attribute", self.path("two.vdb:none")), "two.vdb", "'none'", "'stress', 'other'")

    def test_what_is_no_density_is_refused(self):
        mesh, ball = sphere(), self.path("valued.ply")
        for bad in (-1, "nan", "inf"):
            values = [1.0] * len(mesh[0])
            write_valued_ply(ball, mesh, values)
            with open(ball) as file:
                text = file.read().replace(" 1.0 ", f" {bad} ", 1)
            with open(ball, "w") as file:
                file.write(text)
            self.refused(3, self.fracture("--density-attribute", "wear", mesh=ball), "valued.ply", "vertex 0")
        write_valued_ply(ball, mesh, [0] * len(mesh[0]))
        self.refused(3, self.fracture("--density-attribute", "wear", mesh=ball), "valued.ply", "0 at all")
        self.refused(3, self.fracture("--density-attribute", "none", mesh=ball), "valued.ply", "'none'", "'wear', 'red'")
        self.refused(3, self.fracture("--density-attribute", self.path("absent.vdb")), "absent.vdb")
        self.refused(2, self.fracture("--density-attribute", ""), "--density-attribute")
        self.nothing_written()
        self.done("--write", "vdb")
        self.refused(2, self.fracture("--density-attribute", "wear", mesh=os.path.join(self.out, "fragments", "ball_001.vdb"), out=self.path("b")),
                     "--density-attribute")
        for options, word in ((("--sampler", "poisson"), "--sampler"), (("--balance", "2"), "--balance"), (("--seeds", "x.json"), "--seeds")):
            result = self.run_sherd("fracture", ball, "-o", self.path("b"), "--density-attribute", "red", "--resolution", "32", *options)
            self.refused(2, result, "--density-attribute", word)

    def test_a_component_without_density_has_a_piece(self):
        a, b = sphere(), sphere(center=(3, 0, 0))
        both = a[0] + b[0], a[1] + [tuple(i + len(a[0]) for i in t) for t in b[1]]
        two = self.path("two.ply")
        write_valued_ply(two, both, [0] * len(a[0]) + [1] * len(b[0]))
        self.done("--write", "seeds", "--density-attribute", "wear", mesh=two, pieces=20)
        with open(os.path.join(self.out, "seeds.json")) as file:
            self.assertEqual(sum(s["position"][0] < 1.5 for s in json.load(file)["seeds"]), 1)


class Guides(Guided):
    def broken(self, *options, **more):
        self.done("--growth", "sequential", "--surface", "smooth", *options, **more)
        manifest = self.manifest()
        self.assertEqual(len(manifest["fragments"]), more.get("pieces", 3))
        return manifest

    def crack_vertices(self):
        """The vertices of faces between fragments."""
        for vertices, faces, neighbor in self.meshes():
            yield vertices[np.unique(faces[neighbor != 0])]

    @staticmethod
    def beside_cone(points, z):
        """Signed distances to the cone from the middle of the unit ball through its circle at z."""
        opening = math.acos(z)
        return np.linalg.norm(points, axis=1) * np.sin(np.arccos(points[:, 2] / np.linalg.norm(points, axis=1)) - opening)

    def test_a_ring_on_a_ball_is_a_cone(self):
        write_lines(self.path("ring.obj"), ring(math.sqrt(1 - 0.09), 0.3))
        manifest = self.broken("--guide", self.path("ring.obj"), "--write", "mesh,labels", pieces=2)
        self.assertEqual([guide["file"] for guide in manifest["options"]["guides"]], ["ring.obj"])
        voxel = manifest["grid"]["voxel_size"]
        for vertices in self.crack_vertices():
            away = vertices[np.linalg.norm(vertices, axis=1) > 0.2]  # the cone is left open at its tip
            self.assertLess(np.abs(self.beside_cone(away, 0.3)).max(), 0.1 * voxel)
        volume = min(f["volume"] for f in manifest["fragments"])
        cone = 2 * math.pi / 3 * (1 - 0.3)
        self.assertLess(abs(volume - cone), 0.02 * cone)  # the ball's facets take a hundredth

    def test_a_cutter_mesh_is_a_crack(self):
        cube = self.path("cube.obj")
        corner = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        write_obj(cube, (corner, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]))
        cutter = sphere(radius=0.6)
        write_obj(self.path("cutter.obj"), cutter)
        corners = np.array(cutter[0])[np.array(cutter[1])]
        volume = np.linalg.det(corners).sum() / 6
        manifest = self.broken("--guide", self.path("cutter.obj"), "--write", "mesh", mesh=cube, pieces=2)
        inner = min(f["volume"] for f in manifest["fragments"])
        voxel = manifest["grid"]["voxel_size"]
        self.assertLess(abs(inner - volume), 0.1 * voxel * 4 * math.pi * 0.36)  # a tenth of a voxel off everywhere
        for vertices in self.crack_vertices():
            self.assertLess(np.abs(np.linalg.norm(vertices, axis=1) - 0.6).max(), 0.1 * voxel + 0.6 * (1 - math.cos(math.pi / 24)))

    def test_more_pieces_keep_the_guides(self):
        write_lines(self.path("rings.obj"), ring(0.8, 0.6), ring(0.8, -0.6))
        for pieces in 2, 3, 20:
            manifest = self.broken("--guide", self.path("rings.obj"), "--write", "mesh", pieces=pieces)
            self.assertEqual(len(manifest["fragments"]), pieces)
        voxel = manifest["grid"]["voxel_size"]
        # Voxels of a piece are on one side of a ring, and its vertices in cells with one of them at a corner.
        most = math.sqrt(3) * voxel
        for vertices, _, _ in self.meshes():
            for z in -0.6, 0.6:
                beside = self.beside_cone(vertices[np.linalg.norm(vertices, axis=1) > 0.2], z)
                self.assertFalse(beside.min() < -most and beside.max() > most, (z, beside.min(), beside.max()))

    def test_guides_come_in_their_order_and_repeat(self):
        """Of two pieces the first guide decides both: halves of the ball, or a ball within it."""
        ring_file, ball_file = self.path("a.obj"), self.path("b.obj")
        write_lines(ring_file, ring(1, 0))
        ball = sphere(radius=0.5)
        write_obj(ball_file, ball)
        inner = np.linalg.det(np.array(ball[0])[np.array(ball[1])]).sum() / 6
        for first, second, smaller in ((ring_file, ball_file, 2 / 3 * math.pi), (ball_file, ring_file, inner)):
            result = self.done("--growth", "sequential", "--guide", first, "--guide", second, "--write", "labels", pieces=2)
            self.assertEqual(result.stderr, f"sherd: warning: {second} splits nothing: there are no more pieces to make, or none has "
                                            "voxels on both sides\n")
            manifest = self.manifest()
            self.assertEqual([guide["file"] for guide in manifest["options"]["guides"]],
                             [os.path.basename(file) for file in (first, second)])
            self.assertAlmostEqual(min(f["volume"] for f in manifest["fragments"]), smaller, delta=0.03 * smaller)
        both = ("--growth", "sequential", "--guide", ring_file, "--guide", ball_file, "--write", "labels")
        again = self.path("again")
        for out in self.out, again:
            self.assertEqual(self.done(*both, pieces=4, out=out).stderr, "")
        with open(os.path.join(self.out, "labels.rle"), "rb") as one, open(os.path.join(again, "labels.rle"), "rb") as other:
            self.assertEqual(one.read(), other.read())

    def test_a_guide_that_splits_nothing_is_reported(self):
        beside, ring_file, both = self.path("beside.obj"), self.path("ring.obj"), self.path("both.obj")
        ball = sphere(radius=0.2, center=(2, 0, 0))
        write_obj(beside, ball)
        write_lines(ring_file, ring(0.8, 0.6))
        around = sphere(radius=0.4)
        write_obj(both, (ball[0] + around[0], ball[1] + [tuple(len(ball[0]) + i for i in t) for t in around[1]]))
        sequential = ("--growth", "sequential", "--roughness", "0.5", "--write", "labels,mesh")
        nothing = f"sherd: warning: {beside} splits nothing: no piece has voxels on both sides\n"
        self.assertEqual(self.done(*sequential, "--guide", beside, "--guide", ring_file).stderr, nothing)
        report = json.loads(self.done(*sequential, "--guide", beside, "--guide", ring_file, "--json").stdout)
        self.assertEqual([f"sherd: warning: {sentence}\n" for sentence in report["warnings"]], [nothing])
        self.assertEqual(self.done(*sequential, "--guide", both).stderr,
                         f"sherd: warning: {both}: 1 of its 2 lines and connected components split nothing: no piece has voxels on "
                         "both sides\n")
        # The ring crack of an impact is no guide's.
        self.assertEqual(self.done("--growth", "sequential", "--guide", beside, "--impact", "0,0,1,2,0.1,energy=1", "--write", "labels",
                                   pieces=2).stderr, nothing)
        self.assertIn("sphere", self.manifest()["splits"][0])
        # A fracture that is continued: the ring passes one of the two fragments, and that is enough.
        self.done("--growth", "sequential", "--guide", both, "--write", "labels,vdb", pieces=2)
        manifest = os.path.join(self.out, "manifest.json")
        result = self.run_sherd("fracture", manifest, "-o", self.path("again"), "--only", "1,2", "--pieces", "3", "--growth", "sequential",
                                "--guide", beside, "--guide", ring_file)
        self.assertEqual((result.returncode, result.stderr), (0, nothing))

    def test_files_of_guides_have_hashes(self):
        plain, packed = self.path("ring.obj"), self.path("ring.obj.gz")
        write_lines(plain, ring(0.8, 0.6))
        with open(plain, "rb") as file:
            data = file.read()
        with gzip.open(packed, "wb") as file:
            file.write(data)
        with open(packed, "rb") as file:
            zipped = file.read()
        for path, content in (plain, data), (packed, zipped):
            self.done("--growth", "sequential", "--guide", path, "--write", "labels")
            self.assertEqual(self.manifest()["options"]["guides"],
                             [{"file": os.path.basename(path), "sha256": hashlib.sha256(content).hexdigest()}])

    def test_guides_that_are_very_far_away_or_very_many(self):
        """Squares of such distances exceed single precision, in which boxes of triangles are."""
        line = self.path("line.obj", b"v -1e20 0.5 0\nv 1e20 0.5 0\nl 1 2\n")  # no point of it is near the surface
        self.refused(3, self.fracture("--growth", "sequential", "--guide", line), "line.obj", "far")
        mesh = self.path("mesh.obj", b"v 1e20 0 0\nv 1e20 1 0\nv 1e20 0 1\nf 1 2 3\n")  # all of the ball is on one side
        self.assertEqual(self.done("--growth", "sequential", "--guide", mesh).stderr,
                         f"sherd: warning: {mesh} splits nothing: no piece has voxels on both sides\n")
        lines = "".join(f"v 0 {i} 0\nv 1 {i} 0\nl {2 * i + 1} {2 * i + 2}\n" for i in range(257))
        many = self.path("many.obj", lines.encode())
        self.refused(3, self.fracture("--growth", "sequential", "--guide", many, out=self.path("many")), "many.obj", "257", "256")

    def test_what_is_no_guide_is_refused(self):
        guide = self.path("guide.obj")
        sequential = ("--growth", "sequential", "--guide", guide)
        write_lines(guide, ring(1, 0))
        self.refused(2, self.fracture("--guide", guide), "--guide", "--growth")
        self.refused(2, self.fracture("--growth", "sequential", "--guide", ""), "--guide")
        for text, words in ((b"v 0 0 0\n", ("guide.obj", "neither")), (b"v 0 0 0\nv 1 0 0\nl 1 9\n", ("guide.obj:3", "vertex 9")),
                            (b"v 50 0 0\nv 51 0 0\nl 1 2\n", ("guide.obj", "far")), (b"v 1 0 0\nv 1 nan 0\nl 1 2\n", ("guide.obj", "finite")),
                            (b"v 1 0 0\nv 1 0 0\nl 1 2\n", ("guide.obj", "neither"))):
            self.path("guide.obj", text)
            result = self.fracture(*sequential)
            self.refused(3, result, *words)
            self.assertNotIn("ball.obj", result.stderr)
        os.remove(guide)
        self.refused(3, self.fracture(*sequential), "guide.obj", "no such file")
        self.nothing_written()


if __name__ == "__main__":
    skipping.main()
