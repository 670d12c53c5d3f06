#!/usr/bin/python3
"""`sherd convert` and `sherd inspect` of meshes and points, against readers made from docs/formats.md.

SHERD_BIN names the program, SHERD_TEST_DATA, where set, a folder of meshes beside which `samples` has the authors' files.
"""
import os
import struct
import unittest

import numpy as np

import skipping
from convert_test import SAMPLES, ConvertTest
from octree_stream import read_binp
from ply_file import columns, read_ply

CORNERS = np.array([(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3.5)], np.float32)
FACES = np.array([(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
                  (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)], np.uint32)


def binm(parts, count="I", leading=False):
    out = struct.pack("<Q", len(parts)) if leading else b""
    for corners, faces in parts:
        vertices = np.zeros((len(corners), 16), "<f4")
        vertices[:, :3] = corners
        rows = np.zeros((len(faces), 4), "<u4")
        rows[:, :3] = faces
        out += (struct.pack("<" + count, len(corners)) + vertices.tobytes() +
                struct.pack("<" + count, len(faces)) + rows.tobytes())
    return out


def write_obj(corners, faces):
    return ("".join("v %.9g %.9g %.9g\n" % tuple(v) for v in corners) +
            "".join("f %d %d %d\n" % tuple(f + 1) for f in faces)).encode()


class Meshes(ConvertTest):
    def setUp(self):
        super().setUp()
        self.put("box.obj", write_obj(CORNERS, FACES))

    def triangles(self, name):
        """The sum over corners identifies a mesh, whatever the order of its vertices."""
        reported = self.reported(name)
        return reported["kind"], reported["triangles"], round(reported["volume"], 6), reported["closed"], reported["box_max"]

    def test_a_mesh_goes_through_every_format(self):
        for ending in ("ply", "obj", "stl", "glb", "binm"):
            _, losses = self.converted("box.obj", "a." + ending)
            self.assertEqual(losses, [])
            self.assertEqual(self.triangles("a." + ending), ("mesh", 12, 7, True, [1, 2, 3.5]))
            self.converted("a." + ending, "back.obj")
            self.assertEqual(self.triangles("back.obj"), ("mesh", 12, 7, True, [1, 2, 3.5]))
        self.assertNotIn(b"mtllib", self.got("back.obj"))
        self.assertEqual([name for name in os.listdir(self._folder.name) if name.endswith("mtl")], ["back.mtl"])  # the .glb's

    def test_stl_has_the_normals_of_its_corners(self):
        record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
        binary, _ = self.converted("box.obj", "a.stl")
        self.sherd("convert", self.path("box.obj"), self.path("text.stl"), "--ascii")
        text = np.array([[float(x) for x in line.split()[-3:]] for line in self.got("text.stl").decode().splitlines()
                         if line.split()[0] in ("facet", "vertex")]).reshape(-1, 4, 3)
        rows = np.frombuffer(binary, record, offset=84)
        for normals, corners in ((rows["normal"], rows["corners"].astype(float)), (text[:, 0], text[:, 1:])):
            self.assertEqual(len(normals), 12)
            cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            np.testing.assert_allclose(normals, cross / np.linalg.norm(cross, axis=1, keepdims=True), atol=1e-6)
            outwards = corners.mean(axis=1) - (0.5, 1, 1.75)
            self.assertTrue((np.einsum("ij,ij->i", normals, outwards) > 0).all())

    def test_binm_is_written_as_described(self):
        data, _ = self.converted("box.obj", "a.binm")
        self.put("want.binm", binm([(CORNERS, FACES)]))
        vertices = np.frombuffer(data, "<f4", 8 * 16, 4).reshape(8, 16)
        faces = np.frombuffer(data, "<u4", 12 * 4, 8 + vertices.nbytes).reshape(12, 4)
        self.assertEqual((data[:4], data[4 + vertices.nbytes:8 + vertices.nbytes], len(data)),
                         (struct.pack("<I", 8), struct.pack("<I", 12), len(self.got("want.binm"))))
        self.assertFalse(vertices[:, 3:].any() or faces[:, 3].any())
        np.testing.assert_array_equal(vertices[faces[:, :3], :3], CORNERS[FACES])

    def test_binm_of_every_age_is_read(self):
        far = CORNERS + np.float32(10)
        for name, data in (("a", binm([(CORNERS, FACES)])), ("b", binm([(CORNERS, FACES)], "Q")),
                           ("c", binm([(CORNERS, FACES)], "Q", True)), ("d", binm([(CORNERS, FACES), (far, FACES)], "Q", True))):
            self.put(name + ".binm", data)
            reported = self.reported(name + ".binm")
            self.assertEqual((reported["triangles"], reported["closed"], reported["volume"]), (24, True, 14) if name == "d" else (12, True, 7))
            for n in range(0, len(data), 7):
                self.put("cut.binm", data[:n])
                if n % 49 == 0:
                    self.refused("inspect", self.path("cut.binm"))
            wrong = FACES.copy()
            wrong[5, 1] = 8
            self.put("wrong.binm", binm([(CORNERS, wrong)]))
            self.assertIn("face 6", self.refused("inspect", self.path("wrong.binm")))
        for head in (b"\xff" * 4, b"\xff" * 8, b"\xff" * 200, struct.pack("<QQ", 2**60, 0)):
            self.put("lie.binm", head + bytes(64))
            self.refused("inspect", self.path("lie.binm"))

    def test_stl_as_text_has_the_same_triangles(self):
        binary, _ = self.converted("box.obj", "a.stl")
        text, _ = self.converted("box.obj", "b.stl", "--ascii")
        self.assertTrue(text.startswith(b"solid b\n") and text.endswith(b"endsolid b\n"))
        faces = np.frombuffer(binary, [("numbers", "<f4", 12), ("zero", "<u2")], offset=84)["numbers"]
        words = text.split()
        numbers = [float(w) for w in words if w[:1].isdigit() or w[:1] == b"-"]
        np.testing.assert_array_equal(np.array(numbers, np.float32).reshape(-1, 12), faces)
        self.assertEqual(self.triangles("b.stl"), ("mesh", 12, 7, True, [1, 2, 3.5]))

    def test_attributes_and_neighbors_go_along_or_are_told(self):
        head = ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                "element face 1\nproperty list uchar int vertex_indices\nend_header\n")
        self.put("c.ply", (head + "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n").encode())
        _, losses = self.converted("c.ply", "d.ply")
        self.assertEqual(losses, [])
        _, vertex, _ = read_ply(self.path("d.ply"))
        np.testing.assert_array_equal(columns(vertex, "red", "green", "blue"), 255 * np.eye(3))
        for ending in ("stl", "binm"):
            self.assertIn("colors", self.converted("c.ply", "d." + ending)[1][0])
        neighbor = (struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<B3ii", 3, 0, 1, 2, 7))
        self.put("f.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 b"property float z\nelement face 1\nproperty list uchar int vertex_indices\nproperty int neighbor\n"
                 b"end_header\n" + neighbor)
        self.assertEqual(self.converted("f.ply", "g.ply")[1], [])
        self.assertEqual(list(read_ply(self.path("g.ply"))[2]["neighbor"]), [7])
        self.assertIn("face", self.converted("f.ply", "g.obj")[1][0])

    def test_files_in_the_way_stay(self):
        self.put("m.mtl", b"newmtl red\nKd 1 0 0\n")
        self.put("m.obj", b"mtllib m.mtl\nusemtl red\n" + write_obj(CORNERS, FACES))
        self.put("n.mtl", b"anybody's")
        self.refused("convert", self.path("m.obj"), self.path("n.obj"), code=5)
        self.assertEqual(self.got("n.mtl"), b"anybody's")
        self.assertFalse(os.path.exists(self.path("n.obj")))
        data, losses = self.converted("m.obj", "o.obj")
        self.assertIn(b"mtllib o.mtl", data)
        self.assertIn(b"newmtl red", self.got("o.mtl"))
        self.assertEqual(losses, [])

    def test_triangles_are_no_voxels_and_no_points(self):
        for ending in ("rle", "npz", "xyz", "binp"):
            self.refused("convert", self.path("box.obj"), self.path("a." + ending), code=2)


class Points(ConvertTest):
    def setUp(self):
        super().setUp()
        random = np.random.default_rng(2)
        self.positions = (random.random((500, 3)) * [1, 0.5, 0.25] - 0.5).astype(np.float32)
        normals = random.normal(size=(500, 3)).astype(np.float32)
        self.normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        self.neighbor = random.integers(0, 9, 500).astype(np.int32)
        np.savez(self.path("all.npz"), positions=self.positions, normals=self.normals, neighbor=self.neighbor)

    def read(self, name):
        self.converted(name, "read.npz")
        with np.load(self.path("read.npz")) as arrays:
            return dict(arrays)

    def test_points_go_through_every_format(self):
        self.assertEqual(self.converted("all.npz", "a.ply")[1], [])
        for name in ("all.npz", "a.ply"):
            back = self.read(name)
            for key, want in (("positions", self.positions), ("normals", self.normals), ("neighbor", self.neighbor)):
                np.testing.assert_array_equal(back[key], want)
        data, losses = self.converted("a.ply", "a.xyz")
        self.assertEqual(len(losses), 1)
        rows = np.array([line.split() for line in data.decode().splitlines()], np.float32)
        np.testing.assert_array_equal(rows, np.c_[self.positions, self.normals])
        self.assertEqual(set(self.read("a.xyz")), {"positions", "normals"})

    def test_binp_is_written_as_described(self):
        for scale, voxel in ((1, 1e-4), (100, 1e-4), (1000, 1e-3), (0.05, 1e-5), (0.001, 1e-6)):
            positions = self.positions * np.float32(scale) + np.float32(0.3)
            np.savez(self.path("a.npz"), positions=positions)
            data, losses = self.converted("a.npz", "a.binp")
            header, points = read_binp(data)
            self.assertAlmostEqual(header["voxel"] / voxel, 1, places=12)
            self.assertEqual(header["step"], float(np.float32(header["voxel"])))
            low = positions.astype(float).min(axis=0)
            np.testing.assert_array_equal(header["low"], low)
            cells = np.unique(np.floor((positions - low) / header["voxel"]), axis=0)
            np.testing.assert_allclose(points[np.lexsort(points.T[::-1])], (cells + 0.5) * header["voxel"] + low, rtol=1e-12)
            self.assertEqual(len(losses), 1 + (len(cells) < 500))
            self.assertLess(max(np.abs(points[:, None] - positions[None]).max(axis=2).min(axis=0)), 0.51 * header["voxel"])
            np.testing.assert_allclose(self.read("a.binp")["positions"], points.astype(np.float32))
            self.assertEqual(self.reported("a.binp")["points"], len(points))

    def test_one_point_is_a_cloud(self):
        self.put("a.xyz", b"1 2 3\n")
        self.converted("a.xyz", "a.binp")
        np.testing.assert_allclose(read_binp(self.got("a.binp"))[1], [[1.0000005, 2.0000005, 3.0000005]], rtol=1e-12)
        np.testing.assert_allclose(self.read("a.binp")["positions"], [[1.0000005, 2.0000005, 3.0000005]])

    def test_many_points_have_their_frequencies_halved(self):
        side = 24
        grid = np.stack(np.meshgrid(*[np.arange(side)] * 3), axis=-1).reshape(-1, 3) * 0.01
        np.savez(self.path("a.npz"), positions=grid)
        data, _ = self.converted("a.npz", "a.binp")
        self.assertGreater(struct.unpack_from("<Q", data, 100)[0], 65536)  # bytes of the tree, which are what is counted
        self.assertLess(struct.unpack_from("<257I", data, 108)[256], 65536)
        self.assertEqual(len(read_binp(data)[1]), side ** 3)
        self.assertEqual(len(self.read("a.binp")["positions"]), side ** 3)

    def test_cut_and_damaged_points_are_refused(self):
        self.converted("all.npz", "a.binp")
        data = self.got("a.binp")
        for n in (0, 19, 50, 99, 104, 110, 1135, 1136, 1139, 1140, len(data) - 1):
            self.put("b.binp", data[:n])
            self.refused("inspect", self.path("b.binp"))
        for at, new in ((27, b"\xff" * 8), (27, struct.pack("<Q", 499)), (24, b"\0"), (26, b"\1"), (35, bytes(8)),
                        (35, struct.pack("<d", 1e-300)), (35, struct.pack("<d", float("nan"))), (100, b"\xff" * 8),
                        (108, b"\1\0\0\0"), (1132, b"\0\0\1\1"), (1136, b"\xff" * 4), (52, struct.pack("<d", float("inf")))):
            self.put("b.binp", data[:at] + new + data[at + len(new):])
            self.refused("inspect", self.path("b.binp"))
        self.put("b.binp", data + b"\0")
        self.refused("inspect", self.path("b.binp"))
        # Next to nothing stands for the fullest of trees: it ends.
        lie = data[:27] + b"\xff" * 8 + data[35:100] + b"\xff" * 8 + struct.pack(
            "<257I", *range(256), 65535) + b"\xff" * 3000
        self.put("b.binp", lie)
        self.refused("inspect", self.path("b.binp"))
        for text in (b"", b"1 2\n", b"1 2 3 4\n", b"1 2 x\n", b"1 2 3\n1 2 3 4 5 6\n", b"1 2 nan\n", b"# nothing\n"):
            self.put("b.xyz", text)
            self.refused("inspect", self.path("b.xyz"))
        for arrays in ({"positions": np.zeros((3, 2))}, {"positions": np.zeros((3, 3)), "normals": np.zeros((2, 3))},
                       {"positions": np.zeros((3, 3)), "neighbor": np.array([1, 2, -3])}, {"positions": np.full((1, 3), np.nan)}):
            np.savez(self.path("b.npz"), **arrays)
            self.refused("inspect", self.path("b.npz"))
        self.put("b.ply", b"ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
                 b"property float z\nend_header\n0 0 0\n")
        self.refused("inspect", self.path("b.ply"))

    def test_points_are_no_mesh(self):
        for ending in ("obj", "stl", "rle"):
            self.refused("convert", self.path("all.npz"), self.path("a." + ending), code=2)

    def test_other_arrays_are_told(self):
        np.savez(self.path("sdf.npz"), positions=np.zeros((3, 3)), sdf=np.zeros(3))
        self.assertEqual(self.reported("sdf.npz")["kind"], "arrays")
        self.refused("convert", self.path("sdf.npz"), self.path("a.ply"))


@skipping.skip_unless(os.path.isdir(SAMPLES), "SAMPLES", "no samples of the authors'")
class Samples(ConvertTest):
    def test_the_authors_stream_is_the_authors_cloud(self):
        stream, cloud = (os.path.join(SAMPLES, "AL_12B_1024p." + ending) for ending in ("binp", "ply"))
        for file, to in ((stream, "a.npz"), (cloud, "b.npz")):
            self.sherd("convert", file, self.path(to))
        with np.load(self.path("a.npz")) as a, np.load(self.path("b.npz")) as b:
            self.assertEqual(a["positions"].shape, (1024, 3))
            np.testing.assert_allclose(a["positions"], b["positions"], atol=2e-8)

    def test_what_is_written_again_is_the_authors_tree(self):
        """The same points in the same box make the same tree, but for where the box begins."""
        with open(os.path.join(SAMPLES, "AL_12B_1024p.binp"), "rb") as file:
            theirs = read_binp(file.read())
        self.sherd("convert", os.path.join(SAMPLES, "AL_12B_1024p.binp"), self.path("a.binp"))
        ours = read_binp(self.got("a.binp"))
        self.assertEqual(ours[0]["voxel"], theirs[0]["voxel"])
        self.assertEqual(ours[0]["step"], theirs[0]["step"])
        order = [p[1][np.lexsort(p[1].round(5).T)] for p in (ours, theirs)]
        self.assertLess(np.abs(order[0] - order[1]).max(), 1e-4)


if __name__ == "__main__":
    skipping.main()
