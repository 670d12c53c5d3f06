#!/usr/bin/python3
"""`--mismatch` and `--scan-noise`: distances between posed neighbors as NumPy and SciPy find them.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy and python3-scipy.
"""
import json
import os
import unittest

import numpy as np
from scipy.spatial import cKDTree

from cli_test import CommandLine, tree, write_obj

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")
CUBE = ([(x, y, z) for x in (0, 2) for y in (0, 2) for z in (0, 2)],
        [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])
DIAGONAL = 2 * 3 ** 0.5


def read_ply(path):
    """Vertices, faces and the neighbors of faces."""
    with open(path, "rb") as file:
        header, body = file.read().split(b"end_header\n", 1)
    counts, fields, element = {}, {}, None
    kinds = {"float": "<f4", "double": "<f8", "int": "<i4", "uint": "<u4", "uchar": "u1"}
    for line in header.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            element = words[1]
            counts[element], fields[element] = int(words[2]), []
        elif words[0] == "property" and words[1] == "list":
            fields[element] += [("n", "u1"), ("v", "<i4", 3)]
        elif words[0] == "property":
            fields[element].append((words[2], kinds[words[1]]))
    vertices = np.frombuffer(body, fields["vertex"], counts["vertex"])
    faces = np.frombuffer(body, fields["face"], counts["face"], vertices.nbytes)
    return np.stack([vertices[axis] for axis in "xyz"], 1).astype(float), faces["v"], faces["neighbor"]


def structure(at, height, distances):
    """The rms difference of heights of pairs about as far apart as each distance."""
    pairs = cKDTree(at).query_pairs(1.1 * max(distances), output_type="ndarray")
    apart = np.linalg.norm(at[pairs[:, 0]] - at[pairs[:, 1]], axis=1)
    squares = (height[pairs[:, 0]] - height[pairs[:, 1]]) ** 2
    return [np.sqrt(squares[(apart > 0.9 * d) & (apart < 1.1 * d)].mean()) for d in distances]


class Mismatch(CommandLine):
    def broken(self, mesh, *options, pieces="3", resolution="128"):
        """The folder, and of each fragment its vertices, faces and neighbors."""
        out = self.path(f"out{len(os.listdir(self.tmp))}")
        result = self.run_sherd("fracture", mesh, "-o", out, "--pieces", pieces, "--resolution", resolution, "--seed", "2",
                                "--write", "mesh", "--mesh-format", "ply", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(out, "manifest.json")) as file:
            fragments = json.load(file)["fragments"]
        return out, {f["id"]: read_ply(os.path.join(out, f["files"]["mesh"])) for f in fragments}

    def cube(self):
        path = self.path("cube.obj")
        write_obj(path, CUBE)
        return path

    def gaps(self, meshes, margin):
        """Positions on one side, and signed distances to the other, away from what borders the contact."""
        found = []
        for one, (at, faces, neighbor) in meshes.items():
            for other in sorted(set(neighbor.tolist()) - {0}):
                if other < one:
                    continue
                border = np.unique(faces[neighbor != other])
                inside = np.setdiff1d(np.unique(faces[neighbor == other]), border)
                inside = inside[cKDTree(at[border]).query(at[inside])[0] > margin]
                there, far, behind = meshes[other]
                far = far[behind == one]
                middle = there[far].mean(axis=1)
                normal = np.cross(there[far[:, 1]] - there[far[:, 0]], there[far[:, 2]] - there[far[:, 0]])
                normal /= np.linalg.norm(normal, axis=1, keepdims=True)
                nearest = cKDTree(middle).query(at[inside])[1]
                found.append((at[inside], ((at[inside] - middle[nearest]) * normal[nearest]).sum(axis=1)))
        return found

    def test_neighbors_are_as_far_apart_as_asked(self):
        for surface in "smooth", "exact":
            for rms in 0.1, 0.15:
                _, meshes = self.broken(self.cube(), "--surface", surface, "--mismatch", f"{rms}%", pieces="4")
                gaps = np.concatenate([gap for _, gap in self.gaps(meshes, 3 * 2 / 128)])
                self.assertGreater(len(gaps), 10_000)
                # Each side has the rms that is asked for.
                self.assertAlmostEqual(np.sqrt((gaps ** 2).mean()) / (rms / 100 * DIAGONAL), 2 ** 0.5, delta=0.05 * 2 ** 0.5)

    def test_the_gap_has_the_exponent(self):
        for hurst in 0.5, 0.8:
            _, meshes = self.broken(self.cube(), "--mismatch", f"0.15%,{hurst},20%", pieces="2", resolution="192")
            (at, gap), = self.gaps(meshes, 3 * 2 / 192)
            low, high = structure(at, gap, (0.05, 0.15))
            self.assertAlmostEqual(np.log(high / low) / np.log(3), hurst, delta=0.1)

    def test_pieces_stay_closed_and_the_outside_as_it_is(self):
        for mesh, surface in ((self.cube(), "exact"), (AMPHORA, "smooth"), (AMPHORA, "exact")):
            options = ("--surface", surface, "--adaptivity", "0")
            _, plain = self.broken(mesh, *options, pieces="6", resolution="64")
            out, moved = self.broken(mesh, *options, "--mismatch", "0.2%", pieces="6", resolution="64")
            for fragment, (at, faces, neighbor) in plain.items():
                to, same, _ = moved[fragment]
                np.testing.assert_array_equal(faces, same)
                stays = np.unique(faces[neighbor == 0])
                np.testing.assert_array_equal(at[stays], to[stays])
                self.assertTrue((at != to).any())
            with open(os.path.join(out, "manifest.json")) as file:
                manifest = json.load(file)
            self.assertEqual(manifest["options"]["surface"]["mismatch"], "0.2%")
            result = self.run_sherd("evaluate", out)
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_threads_and_repetitions_give_the_same_bytes(self):
        options = ("--mismatch", "0.2%,0.7,5%", "--mismatch-common", "0.3", "--scan-noise", "0.05%")
        one = tree(self.broken(AMPHORA, *options, "--threads", "1", resolution="48")[0])
        self.assertEqual(one, tree(self.broken(AMPHORA, *options, "--threads", "2", resolution="48")[0]))

    def test_what_cannot_be_is_refused(self):
        for options, words in ((("--mismatch", "0.15"), "% of the diagonal"), (("--mismatch", "6%"), "0..5 %"), (("--mismatch", "-1%"), "0..5 %"),
                               (("--mismatch", "nan%"), "0..5 %"), (("--mismatch", "1%,2"), "0.1..1"), (("--mismatch", "1%,0.8,0%"), "0.01..100"),
                               (("--mismatch", "0.1%", "--correspondences", "9"), "without noise"),
                               (("--mismatch", "0.1%", "--adaptivity", "0.5"), "omit the adaptivity"),
                               (("--scan-noise", "0.1%", "--surface", "exact"), "choose the smooth surface")):
            result = self.run_sherd("fracture", AMPHORA, "-o", self.out, "--pieces", "3", "--resolution", "32", *options)
            self.assertEqual(result.returncode, 2, options)
            self.assertIn(words, result.stderr)
            self.assertFalse(os.path.exists(self.out))

    def test_where_it_does_nothing_is_said(self):
        result = self.run_sherd("fracture", AMPHORA, "-o", self.out, "--pieces", "3", "--resolution", "32", "--write", "labels", "--mismatch", "0.1%")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("does nothing to labels", result.stderr)


if __name__ == "__main__":
    unittest.main()
