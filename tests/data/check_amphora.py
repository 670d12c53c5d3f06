#!/usr/bin/python3
"""The sample amphora is what data/README.md says, and a sound mesh.  Needs numpy."""
import hashlib
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEIGHT = 0.45  # meters
VOXEL = HEIGHT / 128.0


def read_ply(data):
    """Vertices [n, 3] and triangles [m, 3] of a binary PLY as the generator writes it."""
    header, body = data.split(b"end_header\n", 1)
    counts = [int(n) for n in re.findall(rb"element \w+ (\d+)", header)]
    vertices = np.frombuffer(body, "<f4", 3 * counts[0]).reshape(-1, 3)
    faces = np.frombuffer(body, [("count", "u1"), ("corner", "<i4", 3)], counts[1], vertices.nbytes)
    assert len(body) == vertices.nbytes + faces.nbytes and (faces["count"] == 3).all()
    return vertices.astype(float), faces["corner"].astype(np.int64)


def generate(*options):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "amphora.ply"
        subprocess.run([sys.executable, ROOT / "tools" / "studies" / "make_amphora.py", file, *options], check=True,
                       stdout=subprocess.DEVNULL)
        return file.read_bytes()


def parts_of(vertices, triangles):
    """Triangles of each connected part, in order of their first vertex."""
    part = np.arange(len(vertices))
    while True:
        lowest = part.copy()
        for k in range(3):
            np.minimum.at(lowest, triangles[:, k], part[triangles].min(axis=1))
        lowest = lowest[lowest]
        if (lowest == part).all():
            return [triangles[part[triangles[:, 0]] == p] for p in np.unique(part)]
        part = lowest


def volume(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def segment_distance(points, start, end):
    """Distance of each point [n, 2] to the nearest of the segments [m, 2] to [m, 2]."""
    along = end - start
    offset = points[:, None] - start
    t = np.clip((offset * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
    return np.sqrt(((offset - t[..., None] * along) ** 2).sum(axis=2)).min(axis=1)


class Amphora(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.data = (ROOT / "data" / "amphora.ply").read_bytes()
        cls.vertices, cls.triangles = read_ply(cls.data)
        cls.parts = parts_of(cls.vertices, cls.triangles)
        # The body is turned: each ring's radius and height, from foot to floor, are its profile.
        body = np.unique(cls.parts[0])
        radius = np.hypot(cls.vertices[body, 0], cls.vertices[body, 2])
        around = np.isclose(np.arctan2(cls.vertices[body, 2], cls.vertices[body, 0]), 0.0, atol=1e-9)
        rings = body[around & (radius > 0.0)]
        poles = body[radius == 0.0]
        order = [poles[0], *rings, poles[1]]
        cls.profile = np.stack([np.hypot(cls.vertices[order, 0], cls.vertices[order, 2]),
                                cls.vertices[order, 1]], axis=1)

    def test_generator_makes_the_same_bytes(self):
        self.assertEqual(hashlib.sha256(generate()).hexdigest(), hashlib.sha256(self.data).hexdigest())

    def test_readme_tells_the_truth(self):
        readme = (ROOT / "data" / "README.md").read_text()
        size = self.vertices.max(axis=0) - self.vertices.min(axis=0)
        for fact in [hashlib.sha256(self.data).hexdigest(), f"{len(self.data):,} bytes",
                     f"{len(self.vertices):,} vertices", f"{len(self.triangles):,} triangles",
                     "{:.4f} x {:.4f} x {:.4f}".format(*size),
                     *(f"{1e6 * volume(self.vertices, part):.2f}" for part in self.parts)]:
            self.assertIn(fact, readme)

    def test_every_edge_is_used_once_in_each_direction(self):
        t = self.triangles
        edges = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
        key = edges[:, 0] * len(self.vertices) + edges[:, 1]
        back = edges[:, 1] * len(self.vertices) + edges[:, 0]
        self.assertEqual(len(np.unique(key)), len(key))
        self.assertTrue(np.isin(back, key).all())
        self.assertEqual(len(np.unique(self.vertices, axis=0)), len(self.vertices))

    def test_three_parts_each_oriented_outwards(self):
        self.assertEqual(len(self.parts), 3)
        for part in self.parts:
            self.assertGreater(volume(self.vertices, part), 0.0)
        # The handles are congruent; coordinates are floats of at most 0.45.
        self.assertAlmostEqual(volume(self.vertices, self.parts[1]), volume(self.vertices, self.parts[2]),
                               delta=1e-10)

    def test_no_triangle_is_degenerate(self):
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        doubled = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        longest = np.max([np.linalg.norm(p - q, axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
        self.assertGreater((doubled / longest).min(), 1e-5)  # no height under a hundredth of a millimeter

    def test_size(self):
        self.assertLess(len(self.data), 2_000_000)
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        self.assertEqual(low[1], 0.0)
        self.assertAlmostEqual(high[1], HEIGHT, delta=0.001)

    def test_wall_is_two_and_a_half_voxels_thick_at_128(self):
        top = int(np.argmax(self.profile[:, 1]))
        outer, inner = self.profile[: top + 1], self.profile[top:]
        inner = inner[inner[:, 1] < HEIGHT - 0.03]  # below the lip, whose two sides meet at its crest
        distance = segment_distance(inner, outer[:-1], outer[1:])
        self.assertGreater(distance.min(), 0.009)
        self.assertGreater(distance.min(), 2.5 * VOXEL)

    def test_mouth_is_open_and_wide(self):
        top = int(np.argmax(self.profile[:, 1]))
        neck = self.profile[top:][self.profile[top:, 1] > 0.30]
        self.assertGreater(neck[:, 0].min(), 0.035)  # twenty voxels across at 128

    def within_wall(self, points):
        """Whether points lie in the body: the profile's polygon winds round (radius, height)."""
        p = np.stack([np.hypot(points[:, 0], points[:, 2]), points[:, 1]], axis=1)[:, None]
        a, b = self.profile, np.roll(self.profile, -1, axis=0)
        crosses = (a[:, 1] > p[..., 1]) != (b[:, 1] > p[..., 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            x = a[:, 0] + (p[..., 1] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
        return (np.sum(crosses & (p[..., 0] < x), axis=1) % 2) == 1

    def test_handles_end_within_the_wall_and_leave_the_inside_empty(self):
        inner = self.profile[int(np.argmax(self.profile[:, 1])):]
        for part in self.parts[1:]:
            points = self.vertices[np.unique(part)]
            corners, uses = np.unique(part, return_counts=True)
            poles = corners[uses > 6]  # the middle of each end
            self.assertEqual(len(poles), 2)
            ends = np.unique(part[np.isin(part, poles).any(axis=1)])
            self.assertTrue(self.within_wall(self.vertices[ends]).all())
            self.assertFalse(self.within_wall(points).all())
            hollow = np.interp(points[:, 1], inner[::-1, 1], inner[::-1, 0])
            self.assertTrue((np.hypot(points[:, 0], points[:, 2]) > hollow).all())

    def test_detail_multiplies_the_triangles(self):
        vertices, triangles = read_ply(generate("--detail", "3"))
        self.assertAlmostEqual(len(triangles) / len(self.triangles), 3.0, delta=0.15)
        fine = sum(volume(vertices, part) for part in parts_of(vertices, triangles))
        coarse = sum(volume(self.vertices, part) for part in self.parts)
        # A polygon of n sides lacks 1 - sin(2 pi / n) / (2 pi / n) of its circle.
        angle = 2.0 * math.pi / 144
        self.assertAlmostEqual(fine / coarse, 1.0, delta=4.0 * (1.0 - math.sin(angle) / angle))


if __name__ == "__main__":
    unittest.main()
