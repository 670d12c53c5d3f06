#!/usr/bin/python3
"""Points and distance samples of `sherd fracture`: what the files hold, as NumPy reads them, and what is refused.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy.
"""
import json
import math
import os
import unittest
import zipfile

import numpy as np

import skipping
from cli_test import CommandLine, tree
from octree_stream import read_binp

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")
PIECES = 5
POINT = np.dtype([(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")] + [("neighbor", "<i4")])


def read_points_ply(path):
    """Positions, normals and neighbor of a file whose header is the one that is promised, and no other."""
    with open(path, "rb") as file:
        header, body = file.read().split(b"end_header\n", 1)
    lines = header.decode().splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"], lines
    assert lines[3:] == [f"property float {n}" for n in POINT.names[:6]] + ["property int neighbor"], lines
    points = np.frombuffer(body, POINT)
    assert lines[2] == f"element vertex {len(points)}", lines
    vectors = np.stack([points[name] for name in POINT.names[:6]], 1)
    return vectors[:, :3], vectors[:, 3:], points["neighbor"]


def read_mesh_ply(path):
    with open(path, "rb") as file:
        header, body = file.read().split(b"end_header\n", 1)
    counts = [int(line.split()[2]) for line in header.decode().splitlines() if line.startswith("element")]
    vertices = np.frombuffer(body, [("at", "<f4", 3), ("normal", "<f4", 3), ("neighbor", "<i4")], counts[0])
    faces = np.frombuffer(body, [("n", "u1"), ("v", "<i4", 3), ("neighbor", "<i4")], offset=vertices.nbytes)
    return vertices["at"].astype(float), faces["v"], faces["neighbor"]


class Points(CommandLine):
    def broken(self, *options, out=None, write="mesh"):
        """The manifest of the amphora in five pieces."""
        out = out or self.out
        result = self.run_sherd("fracture", AMPHORA, "-o", out, "--resolution", "48", "--pieces", str(PIECES),
                                "--write", write, "--surface", "smooth", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(out, "manifest.json")) as file:
            return json.load(file)

    def at(self, name):
        return os.path.join(self.out, name)

    def test_every_format_holds_the_same_points(self):
        manifest = self.broken("--points", "500", "--point-format", "npz,ply,xyz")
        for fragment in manifest["fragments"]:
            number = f"amphora_{fragment['id']:03}"
            files = fragment["files"]["points"]
            self.assertEqual(files, [f"points/{number}.{end}" for end in ("npz", "ply", "xyz")])
            self.assertLessEqual(set(files), set(manifest["files"]))
            arrays = np.load(self.at(files[0]))
            self.assertEqual({name: (a.shape, a.dtype.str) for name, a in arrays.items()},
                             {"positions": ((500, 3), "<f4"), "normals": ((500, 3), "<f4"), "neighbor": ((500,), "<i4")})
            positions, normals, neighbor = read_points_ply(self.at(files[1]))
            text = np.loadtxt(self.at(files[2]), dtype=np.float32)
            np.testing.assert_array_equal(arrays["positions"], positions)
            np.testing.assert_array_equal(arrays["normals"], normals)
            np.testing.assert_array_equal(arrays["neighbor"], neighbor)
            np.testing.assert_array_equal(text, np.hstack([positions, normals]))
            # Three roundings of numbers below 1.
            self.assertLess(np.abs(np.linalg.norm(normals, axis=1) - 1).max(), 3 * 2**-24)
            neighbors = {0} | {contact["id"] for contact in fragment["contacts"]}
            self.assertLessEqual(set(neighbor), neighbors)
            box = fragment["bbox"]
            self.assertTrue((positions >= np.float32(box["min"])).all())
            self.assertTrue((positions <= np.float32(box["max"])).all())

    def test_octrees_hold_the_points_of_the_others(self):
        self.broken("--points", "300", "--point-format", "npz,binp")
        for path in self.at("points/amphora_001"), self.at("points/amphora_002"):
            positions = np.load(path + ".npz")["positions"].astype(float)
            with open(path + ".binp", "rb") as file:
                header, points = read_binp(file.read())
            cells = np.unique(np.floor((positions - header["low"]) / header["voxel"]), axis=0)
            self.assertEqual(len(points), len(cells))
            near = np.abs(points[:, None] - positions[None]).max(axis=2).min(axis=1)
            self.assertLess(near.max(), 0.51 * header["voxel"] + 1e-6)

    def test_points_lie_on_the_mesh_and_face_what_it_faces(self):
        manifest = self.broken("--points", "300")
        fragment = manifest["fragments"][0]
        self.assertEqual(fragment["files"]["points"], "points/amphora_001.ply")
        positions, normals, neighbor = read_points_ply(self.at(fragment["files"]["points"]))
        vertices, faces, of_face = read_mesh_ply(self.at(fragment["files"]["mesh"]))
        a, b, c = (vertices[faces[:, k]] for k in range(3))
        across = np.cross(b - a, c - a)
        across /= np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
        for p, n, f in zip(positions.astype(float), normals, neighbor):
            # Triangles with this normal, in whose plane and between whose edges the point lies: to 1e-6 of an amphora
            # that is 0.45 high, as files have 24 bits and a triangle's normal is only as good as its corners.
            inside = [(np.cross(v - u, p - u) * across).sum(1) > -1e-8 for u, v in ((a, b), (b, c), (c, a))]
            near = (np.abs(((p - a) * across).sum(1)) < 1e-6) & (across @ n > 0.999) & np.all(inside, axis=0)
            self.assertIn(f, of_face[near])

    def assert_near(self, a, b, at=""):
        """Equal but for sums of floating-point numbers in another order."""
        self.assertEqual(type(a), type(b), at)
        if isinstance(a, dict):
            self.assertEqual(a.keys(), b.keys(), at)
            for key in a:
                self.assert_near(a[key], b[key], f"{at}.{key}")
        elif isinstance(a, list):
            self.assertEqual(len(a), len(b), at)
            for i, (x, y) in enumerate(zip(a, b)):
                self.assert_near(x, y, f"{at}[{i}]")
        elif isinstance(a, float):
            # Inertia is relative to the box of the whole, of side 0.45 and mass 0.003, the others to themselves.
            self.assertAlmostEqual(a, b, delta=1e-10 * max(abs(b), 1e-4 if ".inertia" in at else 0.45), msg=at)
        else:
            self.assertEqual(a, b, at)

    def test_points_do_not_need_meshes(self):
        """Files of points, and what the manifest says of fragments, are the same with and without meshes."""
        for options in ((), ("--roughness", "1"), ("--growth", "flood", "--erode-iterations", "2", "--erode-probability", "0.6"),
                        ("--missing", "2", "--share-points", "--point-sampler", "poisson"),
                        ("--interface", "independent"), ("--mismatch", "0.3%", "--scan-noise", "0.1%"), ("--preset", "training")):
            with self.subTest(options):
                with_meshes = self.broken("--points", "400", *options)
                files = tree(os.path.join(self.out, "points"))
                without = self.broken("--points", "400", *options, out=self.path("bare"), write="labels")
                self.assertFalse(os.path.exists(self.path("bare/meshes")))
                self.assertEqual(tree(self.path("bare/points")), files)
                for kind in ("fragments", "withheld"):
                    for a, b in zip(without[kind], with_meshes[kind], strict=True):
                        a.pop("files"), b.pop("files")
                        self.assert_near(a, b)
                del with_meshes["options"]["plain_meshes"]
                self.assertEqual(without["options"], with_meshes["options"])

    def test_points_do_not_depend_on_merged_triangles(self):
        cube = self.path("cube.obj")
        corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        faces = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
        with open(cube, "w") as file:
            file.writelines("v {} {} {}\n".format(*corner) for corner in corners)
            file.writelines("f {} {} {} {}\n".format(*face) for face in faces)
        trees = {}
        for write, *options in (("points",), ("points,mesh",), ("points,mesh", "--adaptivity", "0")):
            out = self.path(f"{write}{len(options)}")
            result = self.run_sherd("fracture", cube, "-o", out, "--resolution", "48", "--pieces", "4", "--points", "200", "--write", write,
                                    "--surface", "smooth", *options)
            self.assertEqual(result.returncode, 0, result.stderr)
            trees[out] = tree(os.path.join(out, "points"))
            if not options and "mesh" in write:
                self.assertLess(sum(len(read_mesh_ply(os.path.join(out, "meshes", name))[1]) for name in os.listdir(os.path.join(out, "meshes"))), 2000)
        first, *others = trees.values()
        self.assertEqual(len(first), 4)
        for other in others:
            self.assertEqual(other, first)

    def test_the_list_of_files_may_ask_for_points(self):
        manifest = self.broken("--point-format", "npz", write="points")
        self.assertEqual(sorted(os.listdir(self.out)), ["manifest.json", "points"])
        for fragment in manifest["fragments"]:
            self.assertEqual(fragment["files"], {"points": f"points/amphora_{fragment['id']:03}.npz"})
            self.assertEqual(len(np.load(self.at(fragment["files"]["points"]))["positions"]), 1000)
        self.assertEqual(manifest["options"]["points"]["count"], 1000)
        self.broken("--points", "7", "--point-format", "npz", write="points")
        self.assertEqual(len(np.load(self.at("points/amphora_001.npz"))["positions"]), 7)
        result = self.fracture("--point-format", "npz")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr.count("--point-format"), 1, result.stderr)
        self.assertIn("does nothing without --points", result.stderr)

    def test_shares_add_up_to_the_whole(self):
        manifest = self.broken("--points", "1001", "--share-points", "--point-format", "npz")
        self.assertEqual(manifest["options"]["points"], {"count": 1001, "shared": True, "sampler": "uniform",
                                                         "rule": "area", "formats": ["npz"]})
        counts = [len(np.load(self.at(f["files"]["points"]))["neighbor"]) for f in manifest["fragments"]]
        areas = np.array([f["area"] for f in manifest["fragments"]])
        self.assertEqual(sum(counts), 1001)
        self.assertLess(np.abs(counts - 1001 * areas / areas.sum()).max(), 1)

    def test_samplers_and_rules(self):
        seen = set()
        for sampler, rule in (("uniform", "area"), ("halton", "area"), ("poisson", "area"),
                              ("uniform", "per-triangle"), ("halton", "per-triangle")):
            manifest = self.broken("--points", "100", "--point-sampler", sampler, "--point-rule", rule)
            reported = manifest["options"]["points"]
            self.assertEqual((reported["sampler"], reported["rule"], reported["formats"]), (sampler, rule, ["ply"]))
            first = [read_points_ply(self.at(f["files"]["points"]))[0] for f in manifest["fragments"]]
            self.assertEqual([len(p) for p in first], [100] * PIECES)
            seen.add(first[0].tobytes())
        self.assertEqual(len(seen), 5)

    def test_halton_and_poisson_fill_fragments_more_evenly_than_chance(self):
        """Chi-square of counts in boxes, all fragments together.  That of independent points is below
        k - 2 sqrt(k x) at most once in e^x, k its degrees (Laurent and Massart 2000)."""
        def points(count, *options):
            manifest = self.broken("--points", str(count), "--point-format", "npz", *options)
            return [np.load(self.at(f["files"]["points"]))["positions"] for f in manifest["fragments"]]

        many, few = points(400_000), {}
        for sampler in ("uniform", "halton", "poisson"):
            sums, boxes = 0.0, 0
            for reference, drawn in zip(many, points(2000, "--point-sampler", sampler)):
                edges = [np.linspace(low, high + 1e-6, 7) for low, high in zip(reference.min(0), reference.max(0))]
                counts, expected = (np.histogramdd(p, edges)[0] for p in (drawn, reference))
                expected *= len(drawn) / len(reference)
                full = expected > 5
                sums += ((counts - expected)[full]**2 / expected[full]).sum()
                boxes += full.sum()
            few[sampler] = sums
        lowest = boxes - 2 * (boxes * math.log(1e6))**0.5
        self.assertGreater(few["uniform"], lowest)
        self.assertLess(few["halton"], lowest)
        self.assertLess(few["poisson"], lowest)

    def test_withheld_fragments_have_none(self):
        manifest = self.broken("--points", "60", "--share-points", "--sdf-samples", "20", "--missing", "2")
        self.assertEqual((len(manifest["fragments"]), len(manifest["withheld"])), (3, 2))
        self.assertEqual([f["files"] for f in manifest["withheld"]], [{}, {}])
        self.assertEqual(len(os.listdir(self.at("points"))), 3)
        self.assertEqual(len(os.listdir(self.at("sdf"))), 4)
        self.assertEqual(sum(len(read_points_ply(self.at(f["files"]["points"]))[0]) for f in manifest["fragments"]), 60)

    def test_distances(self):
        for kind, bits in (("float32", 24), ("float16", 11)):
            manifest = self.broken("--sdf-samples", "4000", "--sdf-type", kind)
            self.assertEqual(manifest["sdf"], "sdf/amphora.npz")
            self.assertEqual(manifest["options"]["sdf"], {"count": 4000, "type": kind,
                                                          "sigma": manifest["grid"]["voxel_size"]})
            self.assertNotIn("points", manifest["options"])
            self.assertIn(manifest["sdf"], manifest["files"])
            for fragment in manifest["fragments"]:
                name = fragment["files"]["sdf"]
                self.assertEqual(name, f"sdf/amphora_{fragment['id']:03}.npz")
                self.assertIn(name, manifest["files"])
                arrays = np.load(self.at(name))
                positions, sdf = arrays["positions"], arrays["sdf"]
                self.assertEqual((positions.dtype, positions.shape), (np.dtype(kind), (4000, 3)))
                self.assertEqual((sdf.dtype, sdf.shape), (np.dtype(kind), (4000,)))
                # The uniform half measures the volume: the share inside of a box that is known.
                low, high = (np.array(fragment["bbox"][end]) for end in ("min", "max"))
                wider = max(0.05 * max(high - low), 3 * manifest["grid"]["voxel_size"])
                box = np.prod(high - low + 2 * wider)
                share = fragment["volume"] / box
                self.assertLess(abs((sdf[::2] < 0).mean() - share), 5 * (share * (1 - share) / 2000)**0.5)
                # A vertex is never nearer than the surface, and the nearest one at most an edge (under 2 voxels) farther.
                vertices = read_mesh_ply(self.at(fragment["files"]["mesh"]))[0]
                for p, d in list(zip(positions.astype(float), sdf.astype(float)))[:200]:
                    nearest = np.linalg.norm(vertices - p, axis=1).min()
                    rounding = 2.0**-bits
                    self.assertGreaterEqual(nearest, abs(d) - rounding)
                    self.assertLess(nearest, abs(d) + 2 * manifest["grid"]["voxel_size"] + rounding)

    def test_correspondences_lie_on_faces_of_both_fragments(self):
        manifest = self.broken("--correspondences", "40")
        self.assertEqual(manifest["correspondences"], "correspondences.npz")
        self.assertEqual(manifest["options"]["correspondences"], 40)
        found = np.load(self.at("correspondences.npz"))
        pairs, positions, normals = found["fragments"], found["positions"].astype(float), found["normals"]
        touching = [(f["id"], c["id"]) for f in manifest["fragments"] for c in f["contacts"] if f["id"] < c["id"]]
        self.assertGreater(len(touching), 3)
        self.assertEqual([tuple(pair) for pair in pairs], [pair for pair in touching for _ in range(40)])
        meshes = [read_mesh_ply(self.at(f["files"]["mesh"])) for f in manifest["fragments"]]
        for pair in touching:
            own = (pairs == pair).all(axis=1)
            for one, other, sign in ((*pair, 1), (*pair[::-1], -1)):
                vertices, faces, neighbor = meshes[one - 1]
                a, b, c = (vertices[faces[neighbor == other, k]] for k in range(3))
                across = np.cross(b - a, c - a)
                across /= np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
                for p, n in zip(positions[own], sign * normals[own]):  # as in the test above
                    inside = [(np.cross(v - u, p - u) * across).sum(1) > -1e-8 for u, v in ((a, b), (b, c), (c, a))]
                    near = (np.abs(((p - a) * across).sum(1)) < 1e-6) & (across @ n > 0.999) & np.all(inside, axis=0)
                    self.assertTrue(near.any())

    def test_correspondences_need_a_shared_surface(self):
        for options in (("--interface", "independent"), ("--erode-iterations", "1"),
                        ("--surface", "labels", "--smooth-boundary-iterations", "2"),
                        ("--surface", "labels", "--adaptivity", "0.1")):
            with self.subTest(options):
                self.refused(2, self.fracture("--correspondences", "5", *options), "share")
                self.assertFalse(os.path.exists(self.out))

    def test_npz_is_stored_and_holds_no_times(self):
        self.broken("--points", "10", "--point-format", "npz")
        with zipfile.ZipFile(self.at("points/amphora_001.npz")) as file:
            self.assertIsNone(file.testzip())
            self.assertEqual(file.namelist(), ["positions.npy", "normals.npy", "neighbor.npy"])
            for entry in file.infolist():
                self.assertEqual((entry.date_time, entry.compress_type), ((1980, 1, 1, 0, 0, 0), zipfile.ZIP_STORED))
                data = file.read(entry)
                self.assertEqual(data[:8], b"\x93NUMPY\x01\x00")
                self.assertEqual((10 + int.from_bytes(data[8:10], "little")) % 64, 0)

    def test_the_same_again_on_other_threads(self):
        options = ("--points", "200", "--point-sampler", "poisson", "--point-format", "ply,xyz,npz",
                   "--sdf-samples", "500")
        self.broken(*options)
        for threads in ("1", "2"):
            other = self.path("other" + threads)
            self.broken(*options, "--threads", threads, out=other)
            self.assertEqual(tree(self.out), tree(other))
        self.broken(*options, out=self.out)  # over the old ones
        self.assertEqual(tree(self.out), tree(other))
        self.broken("--seed", "1", *options, out=other)
        mine, others = tree(self.out), tree(other)
        for name in ("points/amphora_001.ply", "sdf/amphora.npz"):
            self.assertNotEqual(mine[name], others[name])

    def test_a_later_fracture_without_points_takes_them_away(self):
        self.broken("--points", "10", "--sdf-samples", "10")
        manifest = self.broken()
        self.assertEqual(sorted(os.listdir(self.out)), ["manifest.json", "meshes"])
        self.assertNotIn("sdf", manifest)
        self.assertNotIn("points", manifest["fragments"][0]["files"])

    def test_what_cannot_be_is_refused(self):
        some = ("--points", "10")
        for options in (("--points", "-1"), ("--points", "1e3"), ("--points", "10000001"), ("--points",),
                        ("--points", "x"), (*some, "--point-sampler", "gaussian"), (*some, "--point-rule", "none"),
                        (*some, "--point-format", "obj"), (*some, "--point-format", "ply,"),
                        (*some, "--point-format", "ply,ply"), (*some, "--point-format", ""),
                        (*some, "--point-sampler", "poisson", "--point-rule", "per-triangle"),
                        ("--sdf-samples", "-5"), ("--sdf-samples", "0.5"), ("--sdf-type", "float16"),
                        ("--sdf-samples", "10", "--sdf-type", "float64")):
            with self.subTest(options):
                self.refused(2, self.fracture(*options))
                self.assertFalse(os.path.exists(self.out))

    def test_numbers_too_large_for_16_bits_are_refused(self):
        far = self.path("far.obj")
        with open(self.ball) as ball, open(far, "w") as file:
            for line in ball:
                word, *numbers = line.split()
                file.write(line if word != "v" else "v {} {} {}\n".format(70000 + float(numbers[0]), *numbers[1:]))
        self.refused(2, self.fracture("--sdf-samples", "10", "--sdf-type", "float16", mesh=far), "float32")
        self.assertFalse(os.path.exists(self.out))


if __name__ == "__main__":
    skipping.main()
