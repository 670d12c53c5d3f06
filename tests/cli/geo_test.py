#!/usr/bin/python3
"""Houdini's geometry as a reader of this test's own has it: pieces, groups, attributes of surfaces, constraints, levels.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy.
tests/long/geo.py reads the same files with another program.
"""
import os
import pathlib

import numpy as np

import skipping
from appearance_test import PICTURE, drum
from cli_test import CommandLine, all_contacts, joined, sphere, write_obj
from geo_file import Geometry
from ply_file import read_ply, read_triangles

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")
REVERSED = [0, 2, 1]  # corners of a triangle in Houdini's order, clockwise as seen from outside


class Tree:
    """The splits of a manifest, of which the only root is the intact object."""

    def __init__(self, manifest):
        self.parent = [0] + [split["parent"] for split in manifest.get("splits", [])]
        self.of = {f["id"]: f.get("split", 0) for f in manifest["fragments"] + manifest.get("withheld", [])}
        roots = self.parent[1:].count(0) + list(self.of.values()).count(0)
        self.whole = self.parent.index(0, 1) if roots == 1 and 0 in self.parent[1:] else 0

    def path(self, fragment):
        """The splits that a fragment comes from, the last one first."""
        split, found = self.of[fragment], []
        while split not in (0, self.whole):
            found.append(split)
            split = self.parent[split]
        return found

    def level(self, one, other):
        return 1 + len(set(self.path(one)) & set(self.path(other)))


class Geo(CommandLine):
    def broken(self, *options, mesh=AMPHORA, out=None, pieces=6, write="houdini,mesh"):
        return self.written(write, *options, mesh=mesh, out=out, pieces=pieces)

    def geometry(self, name, out=None):
        return Geometry(os.path.join(out or self.out, name))

    def check_pieces(self, manifest, out=None):
        out = out or self.out
        geo = self.geometry("pieces.geo", out)
        names = geo.primitive("name")
        self.assertTrue(geo.closed)
        self.assertEqual(list(dict.fromkeys(names)), [f"piece{f['id']}" for f in manifest["fragments"]])
        self.assertEqual(list(geo.groups), ["inside", "outside"])
        self.assertEqual([geo.meanings["point", "P"], geo.meanings["primitive", "name"]], ["point", None])
        first = 0
        for fragment in manifest["fragments"]:
            vertices, triangles, neighbor = read_triangles(os.path.join(out, fragment["files"]["mesh"]))
            own = names == f"piece{fragment['id']}"
            np.testing.assert_array_equal(geo.points[own], first + triangles[:, REVERSED])
            at = geo.point("P")[first:first + len(vertices)]
            np.testing.assert_array_equal(at, vertices.astype(np.float32))
            np.testing.assert_array_equal(geo.primitive("neighbor")[own], neighbor)
            np.testing.assert_array_equal(geo.groups["inside"][own], neighbor > 0)
            np.testing.assert_array_equal(geo.groups["outside"][own], neighbor == 0)
            a, b, c = np.moveaxis(geo.point("P").astype(float)[geo.points[own]], 1, 0)
            self.assertAlmostEqual(-np.einsum("ij,ij", a, np.cross(b, c)) / 6 / fragment["volume"], 1, delta=1e-4)
            first += len(vertices)
        self.assertEqual(first, geo.point_count)
        return geo

    def check_clusters(self, manifest, geo):
        tree, of_depth, last = Tree(manifest), {}, {}
        for fragment in manifest["fragments"]:
            own = geo.primitive("name") == f"piece{fragment['id']}"
            level, = set(geo.primitive("unreal_gc_piece")[own])
            cluster, = set(geo.primitive("unreal_gc_cluster")[own])
            path = tree.path(fragment["id"])
            self.assertEqual(cluster, path[0] if path else -1)
            self.assertEqual(of_depth.setdefault(len(path), level), level)
            last[level] = len(path)
        levels = sorted(last)
        self.assertEqual(levels, list(range(levels[0], levels[0] + len(levels))))
        self.assertEqual(levels[0], 1 if 0 in of_depth else 2)
        self.assertEqual([last[level] for level in levels], sorted(of_depth))
        return levels

    def check_constraints(self, manifest, strength=1e5, out=None):
        geo = self.geometry("graph.geo", out)
        fragments = manifest["fragments"]
        self.assertEqual(list(geo.point("name")), [f"piece{f['id']}" for f in fragments])
        np.testing.assert_array_equal(geo.point("P"), np.array([f["centroid"] for f in fragments], np.float32))
        contacts = {(f["id"], c["id"]): (f, fragments[c["id"] - 1], c["area"]) for f in fragments for c in all_contacts(f)
                    if f["id"] < c["id"] <= len(fragments)}
        pairs = [tuple(pair) for pair in (geo.points + 1).tolist()]
        self.assertEqual(sorted(pairs), sorted(contacts))
        self.assertIs(geo.closed, False if contacts else None)
        self.assertEqual(set(geo.primitive("constraint_name")), {"Glue"} if contacts else set())
        self.assertEqual(set(geo.primitive("constraint_type")), {"all"} if contacts else set())
        areas = [contacts[pair][2] for pair in pairs]
        np.testing.assert_array_equal(geo.primitive("area"), np.array(areas, np.float32))
        np.testing.assert_array_equal(geo.primitive("strength"), (strength * np.array(areas, float)).astype(np.float32))
        for pair, length in zip(pairs, geo.primitive("restlength"), strict=True):
            one, other, _ = contacts[pair]
            self.assertAlmostEqual(length / np.linalg.norm(np.subtract(one["centroid"], other["centroid"])), 1, delta=1e-6)
        tree = Tree(manifest)
        for name, members in geo.groups.items():
            self.assertEqual(list(members), [f"level{tree.level(*pair)}" == name for pair in pairs])
        self.assertEqual(sum(sum(members) for members in geo.groups.values()), len(pairs) if manifest.get("splits") else 0)
        return geo

    def test_pieces_are_those_of_manifest_and_meshes(self):
        manifest = self.broken()
        self.assertEqual(manifest["houdini"], "pieces.geo")
        self.assertLessEqual({"pieces.geo", "graph.geo"}, set(manifest["files"]))
        self.assertNotIn("graph", manifest)
        geo = self.check_pieces(manifest)
        self.assertEqual(self.check_clusters(manifest, geo), [1])
        self.assertEqual(set(geo.primitive("unreal_gc_cluster")), {-1})
        self.check_constraints(manifest)

    def test_decimated_meshes_have_files_of_their_own(self):
        manifest = self.broken("--triangles", "200")
        self.assertEqual(manifest["houdini"], ["pieces.geo", "pieces_t200.geo"])
        geo = Geometry(os.path.join(self.out, "pieces_t200.geo"))
        triangles = [d["triangles"] for f in manifest["fragments"] for d in f["decimated"]]
        self.assertLessEqual(max(triangles), 200)
        self.assertEqual(len(geo.primitive("name")), sum(triangles))
        self.broken(write="mesh")
        self.assertEqual([name for name in os.listdir(self.out) if name.endswith(".geo")], [])

    def test_levels_are_those_of_splits(self):
        manifest = self.broken("--growth", "sequential", "--joint-strength", "3", pieces=9)
        self.assertEqual(manifest["options"]["joint_strength"], 3)
        self.assertGreater(len(self.check_clusters(manifest, self.check_pieces(manifest))), 1)
        self.assertIn("level1", self.check_constraints(manifest, 3).groups)

    def test_surface_attributes_are_those_of_meshes(self):
        self.path("drum.obj", drum())
        self.path("drum.mtl", b"newmtl side of it\nKd 0.5 1 1\nmap_Kd wood.png\nnewmtl cap\nKd 0.25 0.5 1\n")
        self.path("wood.png", PICTURE)
        manifest = self.broken("--surface", "smooth", mesh=self.path("drum.obj"), pieces=4)
        geo = self.check_pieces(manifest)
        self.assertEqual([geo.meanings["vertex", name] for name in ("uv", "Cd")], ["texturecoord", "color"])
        self.assertNotIn(("vertex", "N"), geo.attributes)
        names = ["/mat/side_of_it", "/mat/cap", "/mat/inside"]
        for fragment in manifest["fragments"]:
            own = geo.primitive("name") == f"piece{fragment['id']}"
            _, _, face = read_ply(os.path.join(self.out, fragment["files"]["mesh"]))
            uv = face["texcoord"].reshape(-1, 3, 2)[:, REVERSED]
            np.testing.assert_array_equal(geo.vertex("uv")[own][:, :, :2], uv)
            self.assertFalse(geo.vertex("uv")[own][:, :, 2].any())
            self.assertEqual(list(geo.primitive("shop_materialpath")[own]), [names[m] for m in face["material"]])
            # Colors are linear: a byte of sRGB returns.
            color = geo.vertex("Cd")[own].astype(float)
            back = np.where(color <= 0.0031308, 12.92 * color, 1.055 * color ** (1 / 2.4) - 0.055) * 255
            self.assertLess(abs(back - back.round()).max(), 1e-3)

    def test_normals_are_those_of_the_input(self):
        vertices, triangles = sphere()
        lines = ["v %r %r %r" % tuple(map(float, v)) for v in vertices]
        lines += ["vn %r %r %r" % tuple(map(float, v / np.linalg.norm(v))) for v in np.asarray(vertices)]
        lines += ["f " + " ".join(f"{i + 1}//{i + 1}" for i in t) for t in triangles]
        ball = self.path("normals.obj", ("\n".join(lines) + "\n").encode())
        geo = self.check_pieces(self.broken("--surface", "exact", mesh=ball))
        normals = geo.vertex("N").astype(float)
        self.assertLess(abs(np.linalg.norm(normals, axis=2) - 1).max(), 2e-4)
        at = geo.point("P").astype(float)[geo.points]
        outward = at / np.linalg.norm(at, axis=2)[:, :, None]
        cosine = np.einsum("ijk,ijk->ij", normals, outward)[geo.groups["outside"]]
        self.assertGreater(np.quantile(cosine, 0.01), 0.98)
        a, b, c = np.moveaxis(at, 1, 0)
        faces = np.cross(c - a, b - a)
        self.assertGreater((np.einsum("ik,ijk->ij", faces, normals) > 0).mean(), 0.99)

    def test_an_input_without_attributes_has_none(self):
        self.broken(mesh=self.ball, write="houdini")
        geo = self.geometry("pieces.geo")
        self.assertEqual(set(geo.attributes), {("point", "P")} | {
            ("primitive", name) for name in ("name", "neighbor", "unreal_gc_piece", "unreal_gc_cluster")})

    def test_plain_meshes_have_points_and_triangles_only(self):
        self.path("paint.png", PICTURE)
        self.path("drum.mtl", b"newmtl side of it\nmap_Kd paint.png\nnewmtl cap\nKd 0.25 0.5 0.75\n")
        mesh, full = self.path("drum.obj", drum()), self.path("full")
        self.broken("--triangles", "300", mesh=mesh, out=full, pieces=4, write="houdini")
        manifest = self.broken("--triangles", "300", "--plain-meshes", mesh=mesh, pieces=4, write="houdini")
        self.assertIs(manifest["options"]["plain_meshes"], True)
        for name in "pieces.geo", "pieces_t300.geo":
            plain, whole = self.geometry(name), self.geometry(name, full)
            kept = [("point", "P"), *(("primitive", n) for n in ("name", "unreal_gc_piece", "unreal_gc_cluster"))]
            self.assertEqual(list(plain.attributes), kept)
            self.assertEqual(plain.groups, {})
            for attribute in kept:
                np.testing.assert_array_equal(plain.attributes[attribute], whole.attributes[attribute])
            np.testing.assert_array_equal(plain.points, whole.points)

    def test_withheld_pieces_are_in_neither_file(self):
        manifest = self.broken("--growth", "sequential", "--missing", "0.4", pieces=8)
        self.assertGreater(len(manifest["withheld"]), 1)
        self.check_clusters(manifest, self.check_pieces(manifest))
        self.check_constraints(manifest)

    def test_one_piece_and_two_components(self):
        manifest = self.broken(pieces=1)
        self.check_pieces(manifest)
        geo = self.check_constraints(manifest)
        self.assertEqual((geo.point_count, geo.primitive_count), (1, 0))
        two = self.path("two.obj")
        write_obj(two, joined(sphere(), sphere(center=(5, 0, 0), radius=0.8)))
        manifest = self.broken("--growth", "sequential", mesh=two, pieces=5, out=self.path("two"))
        self.check_clusters(manifest, self.check_pieces(manifest, self.path("two")))
        self.check_constraints(manifest, out=self.path("two"))

    def test_names_are_no_syntax(self):
        text = drum(colors=False).replace(b"usemtl side of it", b'usemtl a"}{</x>').replace(b"usemtl cap", b'usemtl a_}_<_x>')
        mesh = self.path('7 "q" \\ <x>.obj', text)
        self.path("drum.mtl", b'newmtl a"}{</x>\nKd 1 0 0\nnewmtl a_}_<_x>\nKd 0 1 0\n')
        self.broken(mesh=mesh, pieces=2)
        paths = set(self.geometry("pieces.geo").primitive("shop_materialpath"))
        self.assertEqual(paths, {"/mat/a_____x_", "/mat/a_____x__2", "/mat/inside"})

    def test_equal_fractures_give_equal_bytes(self):
        files = []
        for out in (self.out, self.path("again")):
            self.broken(out=out)
            files.append([pathlib.Path(out, name).read_bytes() for name in ("pieces.geo", "graph.geo")])
        self.assertEqual(files[0], files[1])

    def test_a_later_fracture_replaces_it(self):
        self.broken()
        self.broken(write="mesh")
        self.assertFalse([name for name in os.listdir(self.out) if name.endswith(".geo")])


if __name__ == "__main__":
    skipping.main()
