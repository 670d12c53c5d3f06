#!/usr/bin/python3
"""`sherd evaluate` against the same figures computed here, by other means.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  SHERD_ORACLE_MESHES, a list of closed meshes
separated by colons, breaks these too.  Needs Debian's python3-numpy and python3-scipy.
"""
import json
import math
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy as np
from scipy.spatial import ConvexHull

import skipping
from evaluating import SHERD, Evaluating
from manifests import check_below
from ply_file import read_triangles

AMPHORA = pathlib.Path(os.environ["SHERD_DATA"]) / "amphora.ply"


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def winding(points, corners):
    """How often triangles wind round points: their solid angles (van Oosterom and Strackee, 1983)."""
    total = np.zeros(len(points))
    for part in np.array_split(corners, max(1, len(corners) // 500)):
        a, b, c = (part[None, :, k] - points[:, None] for k in range(3))
        x, y, z = (np.linalg.norm(v, axis=2) for v in (a, b, c))
        above = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
        below = (x * y * z + np.einsum("ijk,ijk->ij", a, b) * z + np.einsum("ijk,ijk->ij", b, c) * x
                 + np.einsum("ijk,ijk->ij", c, a) * y)
        total += 2 * np.arctan2(above, below).sum(axis=1)
    return total / (4 * math.pi)


def hull_distance(origins, directions, vertices):
    """How far rays go to the last triangle of the hull that they meet (Moeller and Trumbore, 1997)."""
    far = np.full(len(origins), -math.inf)
    for a, b, c in vertices[ConvexHull(vertices).simplices]:
        p = np.cross(directions, c - a)
        det = p @ (b - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            s = origins - a
            u = np.einsum("ij,ij->i", s, p) / det
            q = np.cross(s, b - a)
            v = np.einsum("ij,ij->i", directions, q) / det
            t = q @ (c - a) / det
        hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (t > 0)
        far[hit] = np.maximum(far[hit], t[hit])
    return far


def convexity(vertices, faces, samples=1000, seed=1):
    """Value and standard error, as include/sherd/evaluate.h describes."""
    vertices = vertices - vertices.mean(axis=0)
    vertices = vertices / np.abs(vertices).max()
    corners = vertices[faces]
    normals = np.zeros_like(vertices)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for k in range(3):
        a, b = (unit(corners[:, (k + step) % 3] - corners[:, k]) for step in (1, 2))
        angle = np.arccos(np.clip((a * b).sum(axis=1), -1, 1))
        np.add.at(normals, faces[:, k], angle[:, None] * unit(cross))
    normals = unit(normals)

    random = np.random.default_rng(seed)
    area = np.linalg.norm(cross, axis=1)
    chosen = random.choice(len(faces), samples, p=area / area.sum())
    weights = random.dirichlet((1, 1, 1), samples)[:, :, None]
    points = (corners[chosen] * weights).sum(axis=1)
    outwards = unit((normals[faces[chosen]] * weights).sum(axis=1))
    pushed = points - 1e-4 * np.linalg.norm(np.ptp(points, axis=0)) * outwards
    inside = winding(pushed, corners) > 0.5
    distance = hull_distance(pushed[inside], outwards[inside], vertices)
    return 1 - distance.mean(), distance.std() / math.sqrt(inside.sum()), inside.sum() / samples


class Evaluate(Evaluating, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.tmp = tempfile.mkdtemp(prefix="sherd-evaluate-")
        cls.addClassCleanup(shutil.rmtree, cls.tmp)
        cls.pieces = pathlib.Path(cls.tmp) / "pieces"
        cls.fracture(AMPHORA, cls.pieces)

    @classmethod
    def fracture(cls, mesh, out, pieces=5, write="mesh"):
        subprocess.run([SHERD, "fracture", mesh, "-o", out, "--pieces", str(pieces), "--seed", "3", "--resolution", "64",
                        "--write", write, "--quiet"], check=True)
        check_below(out)

    def copy(self):
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.tmp)) / "copy"
        shutil.copytree(self.pieces, folder)
        return folder

    def damaged(self, change):
        folder = self.copy()
        manifest = json.loads((folder / "manifest.json").read_text())
        change(manifest)
        (folder / "manifest.json").write_text(json.dumps(manifest))
        return folder

    def compare_with_oracle(self, folder):
        manifest = json.loads((folder / "manifest.json").read_text())
        reported = self.evaluate(folder, "--json")
        self.assertEqual(len(reported["fragments"]), len(manifest["fragments"]))
        for listed, fragment in zip(manifest["fragments"], reported["fragments"]):
            with self.subTest(folder=folder.name, fragment=fragment["id"]):
                value, error, kept = convexity(*read_triangles(folder / listed["files"]["mesh"])[:2])
                both = math.hypot(error, fragment["distance_deviation"] / math.sqrt(fragment["samples"]))
                self.assertLess(abs(fragment["convexity"] - value), 5 * both)
                self.assertAlmostEqual(fragment["samples"] / 5000, kept, delta=0.01)

    def test_convexity_is_that_of_an_independent_program(self):
        self.compare_with_oracle(self.pieces)
        for mesh in filter(None, os.environ.get("SHERD_ORACLE_MESHES", "").split(":")):
            out = pathlib.Path(self.tmp) / pathlib.Path(mesh).stem
            self.fracture(mesh, out)
            self.compare_with_oracle(out)

    def test_figures_are_those_of_the_manifest(self):
        fragments = json.loads((self.pieces / "manifest.json").read_text())["fragments"]
        reported = self.evaluate(self.pieces, "--json")
        self.assertEqual((reported["schema"], reported["command"]), ("sherd-report/1", "evaluate"))
        self.assertEqual((reported["source"], reported["seed"], reported["pieces"]), ("amphora.ply", 3, 5))
        shares = [f["share"] for f in fragments]
        self.assertEqual([f["share"] for f in reported["fragments"]], shares)
        self.assertEqual((reported["smallest_share"], reported["largest_share"]), (min(shares), max(shares)))
        self.assertAlmostEqual(reported["effective_pieces"], 1 / sum(s * s for s in shares), places=9)
        self.assertAlmostEqual(reported["volume"], sum(f["volume"] for f in fragments), places=12)
        self.assertAlmostEqual(reported["fracture_area_share"],
                               sum(f["fracture_area"] for f in fragments) / sum(f["area"] for f in fragments), places=9)
        contacts = [len(f["contacts"]) for f in fragments]
        self.assertEqual([f["contacts"] for f in reported["fragments"]], contacts)
        self.assertEqual(2 * reported["contacts"], sum(contacts))
        self.assertAlmostEqual(reported["contacts_per_fragment"], sum(contacts) / 5, places=9)
        values = [f["convexity"] for f in reported["fragments"]]
        self.assertAlmostEqual(reported["convexity"], np.mean(values), places=9)
        self.assertAlmostEqual(reported["convexity_standard_error"], np.std(values, ddof=1) / math.sqrt(5), places=9)

    def test_same_seed_same_bytes(self):
        once = self.evaluate(self.pieces, "--json")
        self.assertEqual(self.evaluate(self.pieces, "--json", "--seed", "0"), once)
        self.assertNotEqual(self.evaluate(self.pieces, "--json", "--seed", "1")["convexity"], once["convexity"])

    def test_text_has_a_line_per_fragment(self):
        reported = self.evaluate(self.pieces, "--json", "--samples", "300")
        text = self.evaluate(self.pieces, "--samples", "300")
        for fragment in reported["fragments"]:
            self.assertRegex(text, rf"(?m)^ +{fragment['id']} .* {fragment['convexity']:.4f}$")
        self.assertIn(f"{reported['convexity']:.4f} +- {reported['convexity_standard_error']:.4f}", text)
        self.assertIn(f"{reported['effective_pieces']:.2f} of 5", text)

    def test_one_fragment_has_no_standard_error(self):
        folder = pathlib.Path(self.tmp) / "one"
        self.fracture(AMPHORA, folder, pieces=1)
        reported = self.evaluate(folder, "--json")
        self.assertEqual((reported["effective_pieces"], reported["contacts"], reported["convexity_standard_error"]), (1, 0, None))
        self.assertEqual(reported["convexity"], reported["fragments"][0]["convexity"])
        self.assertIn("1 fragment of", self.evaluate(folder))

    def test_without_meshes_the_manifest_is_told(self):
        folder = pathlib.Path(self.tmp) / "labels"
        self.fracture(AMPHORA, folder, write="labels")
        reported = self.evaluate(folder, "--json")
        self.assertIsNone(reported["convexity"])
        self.assertEqual([f["convexity"] for f in reported["fragments"]], [None] * 5)
        self.assertIn("--write mesh", self.evaluate(folder))

    def test_bad_folders_are_refused(self):
        self.assertIn("no such folder", self.evaluate(self.pieces / "none", status=3))
        self.assertIn("neither manifest.json nor meshes", self.evaluate(self.tmp, status=3))
        folder = self.copy()
        (folder / "manifest.json").write_text("{}")
        self.assertIn("is no manifest", self.evaluate(folder, status=3))

        def second(manifest):
            return manifest["fragments"][1]

        changes = [lambda m: m.pop("files"), lambda m: m.pop("source"), lambda m: m.update(fragments=[]),
                   lambda m: m.update(fragments=7), lambda m: second(m).pop("share"),
                   lambda m: second(m).update(share="much"), lambda m: second(m).update(files=7),
                   lambda m: second(m)["files"].update(mesh="../../etc/passwd"),
                   lambda m: m["files"].append("../elsewhere.ply")]
        for i, change in enumerate(changes):
            with self.subTest(change=i):
                self.assertIn("is damaged", self.evaluate(self.damaged(change), status=3))

    def test_bad_meshes_are_refused(self):
        folder = self.copy()
        mesh = sorted((folder / "meshes").iterdir())[2]
        data = mesh.read_bytes()
        mesh.write_bytes(data[:-9])
        self.assertIn(mesh.name, self.evaluate(folder, status=3))
        mesh.write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        reported = self.evaluate(folder, "--json")  # can be read, and measured as what it is
        self.assertIsNone(reported["fragments"][2]["convexity"])
        self.assertIn("open", reported["fragments"][2]["no_convexity"])
        self.assertEqual((reported["sound"], reported["open"]), (4, 1))
        mesh.unlink()
        self.assertIn(mesh.name, self.evaluate(folder, status=3))

    def test_fragments_are_sound_and_lie_on_the_mesh(self):
        reported = self.evaluate(self.pieces, "--json", "--mesh", AMPHORA, "--samples", "2000")
        self.assertEqual((reported["sound"], reported["open"], reported["notes"]), (5, 0, []))
        self.assertEqual(reported["quality"]["triangles"], sum(f["quality"]["triangles"] for f in reported["fragments"]))
        self.assertEqual(sum(reported["quality"]["smallest_angles"]), reported["quality"]["triangles"])
        # At 64 voxels the neck's rims and the handles are a few voxels wide: half a voxel off there, little elsewhere.
        error = reported["surface_error"]
        self.assertEqual(set(error["voxels"]), {"mean", "p99", "max"})
        self.assertAlmostEqual(error["voxels"]["mean"], error["mean"] / reported["voxel_size"], places=12)
        self.assertLess(error["voxels"]["mean"], 0.05)
        self.assertLess(error["voxels"]["p99"], 0.5)
        self.assertLess(reported["whole"]["missing"]["voxels"]["mean"], 0.1)
        # Neighbors share their faces, but for single precision in the file.
        self.assertLess(reported["gap"]["max"], 1e-5 * reported["diagonal"])
        self.assertLess(reported["overlap"]["share"], 1e-3)
        # What is void is missing from the sum: 2000 points measure it to 5 times 0.003.
        self.assertLess(abs(reported["whole"]["volume_error"]), 0.03)
        self.assertAlmostEqual(reported["whole"]["void_share"], -reported["whole"]["volume_error"], delta=0.02)
        text = self.evaluate(self.pieces, "--mesh", AMPHORA, "--samples", "200")
        for words in ("5 of 5", "surface error", "missing surface", "gap", "overlap", "void", "volume error"):
            self.assertIn(words, text)

    def test_threads_change_nothing(self):
        outputs = []
        for threads in ("1", "3"):
            files = [pathlib.Path(self.tmp) / f"threads{threads}.{end}" for end in ("csv", "svg")]
            text = self.evaluate(self.pieces, "--mesh", AMPHORA, "--samples", "500", "--threads", threads, "--json",
                                 "--csv", files[0], "--plot", files[1])
            outputs.append((text, [file.read_bytes() for file in files]))
        self.assertEqual(*outputs)

    def test_bad_options_are_usage(self):
        for arguments in ((), (self.pieces, "--samples", "0"), (self.pieces, "--seed", "-1"), (self.pieces, "more"),
                          (self.pieces, "--tolerance", "0"), (self.pieces, "--tolerance", "x"),
                          (self.pieces, "--threads", "0"), (self.pieces, "--mesh")):
            self.evaluate(*arguments, status=2)
        self.evaluate(self.pieces, "--mesh", self.tmp + "/none.ply", status=3)
        for option in ("--csv", "--plot"):
            self.evaluate(self.pieces, option, self.tmp + "/none/a", status=5)


if __name__ == "__main__":
    skipping.main()
