#!/usr/bin/python3
"""`sherd evaluate --statistics` on folders without a manifest: plain PLY files, several objects, damaged files, coordinates far away.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy.
"""
import pathlib
import shutil
import sys
import tempfile
import unittest

import numpy as np

from evaluating import Evaluating

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools" / "studies"))
import grid_study  # noqa: E402

CELLS = 24  # along a block's side


def waves(random):
    """A self-affine relief of [0, 1]^2, exponent 0.8, with an rms of 1: a function of two arrays."""
    terms = [(i, k, random.normal() * np.hypot(i, k) ** -1.8, random.uniform(0, 2 * np.pi))
             for i in range(-8, 9) for k in range(9) if (i, k) > (0, 0) or k > 0]
    scale = np.sqrt(sum(0.5 * a * a for _, _, a, _ in terms))
    return lambda u, v: sum(a * np.cos(np.pi * (i * u + k * v) + phase) for i, k, a, phase in terms) / scale


def block(low, high, bends=()):
    """A box of grids, [vertices], [faces]; `bends` are (axis, side, heights of a grid [CELLS + 1, CELLS + 1])."""
    index, vertices, faces = {}, [], []
    low, high = np.asarray(low, float), np.asarray(high, float)

    def vertex(p):
        if p not in index:
            index[p] = len(vertices)
            at = low + (high - low) * np.array(p) / CELLS
            for axis, side, heights in bends:
                if p[axis] == side * CELLS:
                    at[axis] += heights[p[(axis + 1) % 3], p[(axis + 2) % 3]]
            vertices.append(at)
        return index[p]

    for axis in range(3):
        for side in (0, 1):
            for a in range(CELLS):
                for b in range(CELLS):
                    corners = []
                    for i, k in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        p = [0, 0, 0]
                        p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side * CELLS, a + i, b + k
                        corners.append(vertex(tuple(p)))
                    faces += [corners[:3], [corners[0], corners[2], corners[3]]] if side else [
                        corners[2::-1], [corners[3], corners[2], corners[0]]]
    return np.array(vertices), np.array(faces)


def row(gap=0.0, seed=1, rms=0.03, count=3):
    """A row of unit cubes whose shared sides are rough, `gap` apart."""
    random, grid = np.random.default_rng(seed), np.arange(CELLS + 1) / CELLS
    reliefs = [None] + [rms * waves(random)(grid[:, None], grid[None, :]) for _ in range(count - 1)] + [None]
    meshes = []
    for i in range(count):
        bends = [(0, side, relief) for side, relief in ((0, reliefs[i]), (1, reliefs[i + 1])) if relief is not None]
        meshes.append(block((i * (1 + gap), 0, 0), (i * (1 + gap) + 1, 1, 1), bends))
    return meshes


def write_ply(path, vertices, faces, neighbor=None):
    """Double precision, so that distant positions are exact."""
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}", *(f"property double {c}" for c in "xyz"),
              f"element face {len(faces)}", "property list uchar int vertex_indices"]
    rows = np.zeros(len(faces), [("n", "u1"), ("at", "<i4", 3)] + ([("neighbor", "<i4")] if neighbor is not None else []))
    rows["n"], rows["at"] = 3, faces
    if neighbor is not None:
        header.append("property int neighbor")
        rows["neighbor"] = neighbor
    path.write_bytes(("\n".join(header) + "\nend_header\n").encode() + np.asarray(vertices, "<f8").tobytes() + rows.tobytes())


class Foreign(Evaluating, unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="sherd-foreign-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def write(self, meshes, first=1, offset=(0, 0, 0), name="piece_{}.ply"):
        for i, (vertices, faces) in enumerate(meshes):
            write_ply(self.folder / name.format(i + first), vertices + np.array(offset), faces)

    def measure(self, *options):
        reported = self.evaluate(self.folder, "--statistics", "--json", *options)
        return reported["statistics"], reported["fragments"]

    def test_rough_cracks_are_found_by_distance(self):
        """Heights, facets as drawn by hand, and joints of plain PLY files; all figures are in the table too."""
        self.write(row())
        found, fragments = self.measure()
        self.assertEqual((found["neighbors_known"], found["faces_by"]), (False, "facets"))
        self.assertLess(found["plane_share"], 0.5)
        self.assertEqual([f["faces"] for f in fragments], [1, 2, 1])
        self.assertAlmostEqual(found["roughness"], 0.03, delta=0.012)  # of so few waves
        self.assertNotIn("not rough", " ".join(found["notes"]))
        self.assertEqual({h["direction"] for h in found["hurst"]}, {"y", "z"})
        for along in found["hurst"]:
            self.assertEqual(along["cracks"], 2)
        self.assertLess(found["joints"]["gap"][1], 1e-15)
        self.assertIsNone(found["joints"]["removed"])  # not known by distance
        shared, used = 2 * 2 * (CELLS + 1) ** 2, 3 * (6 * CELLS ** 2 + 2)
        self.assertAlmostEqual(found["coincident"], shared / used, places=9)
        self.assertEqual((found["objects"], found["unmatched"]), (1, 0.0))
        self.assertAlmostEqual(found["first_share"], fragments[0]["share"], places=12)
        self.assertAlmostEqual(found["consecutive_excess"], 1 - 2 / 3, places=9)
        text = self.evaluate(self.folder, "--statistics")
        for line in (r"faces are facets of rough cracks", r"rms height of cracks +\d", r"Hurst exponent, y +\d", r"gap, % of the diagonal +0\.0000;",
                     r"difference of both sides +0\.0000 %", rf"coincident vertices +{100 * shared / used:.1f} %",
                     r"order of fragments +share of the first 0\.3[23]\d, mean 0\.333; consecutive ones touch \+0\.333 ", r"objects +1\n",
                     r"inside other fragments +0\.00 %", r"grid of voxels +power [\d.]+ \+- [\d.]+, found in \d+ % of 3 fragments; pitch [\d.]+, a guess"):
            self.assertRegex(text, line)
        self.assertNotIn("removed from cracks", text)

    def test_gaps(self):
        self.write(row(gap=0.005))
        found, _ = self.measure()
        diagonal = np.linalg.norm((3.01, 1, 1))
        # Points of a relief with slopes are nearer to the other side than along the axis.
        self.assertAlmostEqual(found["joints"]["gap"][3], 0.005 / diagonal, delta=0.0002 / diagonal)
        self.assertLess(found["joints"]["gap"][1], 0.005 / diagonal + 1e-9)
        self.assertLess(found["joints"]["difference"], 0.02 * 0.005 / diagonal)  # the plane is tilted a little, so it is moved along it too
        self.assertEqual(found["coincident"], 0.0)

    def test_coordinates_far_from_the_origin(self):
        self.write(row())
        near, _ = self.measure()
        self.write(row(), offset=(2e6, -3e6, 1e6))
        far, fragments = self.measure()
        self.assertEqual([f["faces"] for f in fragments], [1, 2, 1])
        for key in ("roughness", "plane_share", "break_share", "coincident"):
            self.assertAlmostEqual(far[key] / near[key], 1.0, delta=1e-4, msg=key)
        self.assertLess(far["joints"]["gap"][3], 1e-8)
        self.assertEqual(far["objects"], 1)

    def test_recorded_neighbors(self):
        """They are used where both sides agree, whatever the distance; otherwise distance decides."""
        meshes = row(gap=0.2)
        for i, (vertices, faces) in enumerate(meshes):
            corners = np.isclose(vertices[faces][:, :, 0].mean(axis=1, keepdims=True), vertices[faces][:, :, 0], atol=0.12)
            middle = vertices[faces][:, :, 0].mean(axis=1)
            right = corners.all(axis=1) & (middle > i * 1.2 + 0.85) & (i < 2)
            left = corners.all(axis=1) & (middle < i * 1.2 + 0.15) & (i > 0)
            normal = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
            across = np.abs(normal[:, 0]) > 0.6 * np.linalg.norm(normal, axis=1)
            neighbor = np.where(right & across, i + 2, np.where(left & across, i, 0))
            write_ply(self.folder / f"piece_{i + 1}.ply", vertices, faces, neighbor)
        found, fragments = self.measure()
        self.assertTrue(found["neighbors_known"])
        self.assertEqual([f["contacts"] for f in fragments], [1, 2, 1])
        self.assertEqual(found["joints"]["removed"], 1.0)  # 0.2 apart is more than the tolerance
        self.assertRegex(self.evaluate(self.folder, "--statistics"), r"removed from cracks +100\.00 %")
        (self.folder / "piece_2.ply").rename(self.folder / "piece_7.ply")
        found, fragments = self.measure()
        self.assertFalse(found["neighbors_known"])
        self.assertEqual(found["objects"], 3)  # too far apart
        self.assertIsNone(found["joints"])

    def test_several_objects(self):
        self.write(row())
        self.write(row(seed=2), first=4, offset=(0, 3, 0))
        found, fragments = self.measure()
        self.assertEqual(found["objects"], 2)
        self.assertEqual([f["object"] for f in fragments], [1, 1, 1, 2, 2, 2])
        self.assertIn("no contact joins 2 sets of fragments", " ".join(found["notes"]))
        # In the same place they are inside each other.
        self.write(row(seed=2), first=4, offset=(0.3, 0.4, 0.2))
        found, _ = self.measure()
        self.assertGreater(found["joints"]["deep_share"], 0.05)
        self.assertIn("deep inside other fragments", " ".join(found["notes"]))

    def test_the_grid(self):
        """Vertices on a lattice, and the power of grid_study.py's formula for one of the cracks."""
        meshes = []
        for i, (vertices, faces) in enumerate(row(rms=0.08)):
            meshes.append((np.round(vertices * CELLS) / CELLS if i == 1 else vertices, faces))
        vertices = meshes[1][0]
        inner = vertices[(vertices[:, 0] > 1.5) & (np.abs(vertices[:, 1:] - 0.5).max(axis=1) < 0.49)]
        self.assertAlmostEqual(grid_study.powers(inner * CELLS, np.eye(3)).min(), len(inner), delta=0.01 * len(inner))
        self.write(meshes)
        found, _ = self.measure("--unit", str(1 / CELLS), "--tolerance", "3")
        self.assertTrue(found["grid"]["pitch_known"])
        self.assertAlmostEqual(found["grid"]["pitch"], 1 / CELLS, places=9)
        self.assertGreater(found["grid"]["power"], 10.0)

    def test_empty_folders_and_damaged_files(self):
        self.assertIn("neither manifest.json nor meshes", self.evaluate(self.folder, "--statistics", status=3))
        self.write(row())
        self.assertEqual(self.measure()[0]["objects"], 1)
        whole = (self.folder / "piece_2.ply").read_bytes()
        (self.folder / "piece_2.ply").write_bytes(whole[:len(whole) // 2])
        self.assertIn("piece_2.ply", self.evaluate(self.folder, "--statistics", status=3))
        (self.folder / "piece_2.ply").write_bytes(b"")
        self.assertIn("piece_2.ply", self.evaluate(self.folder, "--statistics", status=3))
        # A piece without its crack's triangles is measured, with a note.
        vertices, faces = row()[1]
        write_ply(self.folder / "piece_2.ply", vertices, faces[:len(faces) // 2])
        self.assertIn("open", " ".join(self.measure()[0]["notes"]))


if __name__ == "__main__":
    unittest.main()
