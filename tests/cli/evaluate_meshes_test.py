#!/usr/bin/python3
"""`sherd evaluate` on folders of meshes that another program made, with bodies whose figures are known.

Environment: SHERD_BIN the program.
"""
import csv
import json
import pathlib
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

import skipping
from evaluating import SHERD, Evaluating

# The corners of a box, x fastest, and its faces seen from outside.
FACES = [(0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 2, 3), (0, 3, 1),
         (4, 5, 7), (4, 7, 6)]


def box(low, high):
    return [tuple((low, high)[i >> axis & 1][axis] for axis in range(3)) for i in range(8)]


def obj(vertices, faces):
    return "".join(f"v {x} {y} {z}\n" for x, y, z in vertices) + "".join(
        "f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces)


class EvaluateMeshes(Evaluating, unittest.TestCase):
    def setUp(self):
        self.tmp = pathlib.Path(tempfile.mkdtemp(prefix="sherd-meshes-"))
        self.addCleanup(shutil.rmtree, self.tmp)

    def folder(self, meshes, name="fractured_0"):
        """As Breaking Bad has it: piece_0.obj, piece_1.obj, ..."""
        folder = self.tmp / name
        folder.mkdir()
        for i, text in enumerate(meshes):
            (folder / f"piece_{i}.obj").write_text(text)
        return folder

    def test_slices_of_a_bar(self):
        """Slices 1, 2, ... 12 thick, in a bar 78 long: shares and contacts are known, and the order of piece_10."""
        ends = [0]
        for width in range(1, 13):
            ends.append(ends[-1] + width)
        folder = self.folder([obj(box((a, 0, 0), (b, 10, 10)), FACES) for a, b in zip(ends, ends[1:])])
        whole = self.tmp / "bar.obj"
        whole.write_text(obj(box((0, 0, 0), (78, 10, 10)), FACES))
        reported = self.evaluate(folder, "--json", "--mesh", whole, "--samples", "2000")
        self.assertEqual((reported["manifest"], reported["source"], reported["seed"], reported["pieces"]), (False, None, None, 12))
        self.assertEqual([f["mesh"] for f in reported["fragments"]], [f"piece_{i}.obj" for i in range(12)])
        for width, fragment in zip(range(1, 13), reported["fragments"]):
            self.assertAlmostEqual(fragment["volume"], 100 * width, places=6)
            self.assertAlmostEqual(fragment["share"], width / 78, places=9)
            self.assertEqual(fragment["contacts"], 1 if width in (1, 12) else 2)
            self.assertAlmostEqual(fragment["convexity"], 0.9997, delta=2e-4)
        self.assertEqual((reported["sound"], reported["open"], reported["contacts"], reported["notes"]), (12, 0, 11, []))
        self.assertAlmostEqual(reported["effective_pieces"], 78 ** 2 / sum(w * w for w in range(1, 13)), places=9)
        self.assertAlmostEqual(reported["whole"]["volume"], 7800, places=6)
        self.assertAlmostEqual(reported["whole"]["volume_error"], 0, places=9)
        self.assertEqual(reported["whole"]["void_share"], 0)
        self.assertEqual((reported["overlap"]["share"], reported["overlap"]["depth"]), (0, 0))
        self.assertLess(reported["gap"]["max"], 1e-9)
        self.assertLess(reported["surface_error"]["max"], 1e-9)
        self.assertNotIn("voxels", reported["surface_error"])

    def test_a_gap_and_an_overlap(self):
        """Three boxes in a row: 0.1 between the first two, the last is 0.5 in the second."""
        folder = self.folder([obj(box((0, 0, 0), (2, 2, 2)), FACES), obj(box((2.1, 0, 0), (4, 2, 2)), FACES),
                              obj(box((3.5, 0, 0), (6, 2, 2)), FACES)])
        whole = self.tmp / "bar.obj"
        whole.write_text(obj(box((0, 0, 0), (6, 2, 2)), FACES))
        reported = self.evaluate(folder, "--json", "--mesh", whole, "--samples", "20000", "--tolerance", "5")
        first, second, third = reported["fragments"]
        self.assertAlmostEqual(first["gap"]["mean"], 0.1, places=6)
        self.assertEqual(first["overlap"]["share"], 0)
        self.assertAlmostEqual(second["overlap"]["share"], 0.5 / 1.9, delta=0.02)
        self.assertAlmostEqual(third["overlap"]["share"], 0.5 / 2.5, delta=0.02)
        self.assertAlmostEqual(reported["overlap"]["depth"], 0.5, places=4)
        self.assertAlmostEqual(reported["overlap"]["share"], 2 * 0.5 / 6.4, delta=0.02)
        self.assertAlmostEqual(reported["whole"]["void_share"], 0.1 / 6, delta=0.005)
        self.assertAlmostEqual(reported["whole"]["volume_error"], 6.4 / 6 - 1, places=6)  # files are read in single precision

    def test_bad_pieces_are_told_of(self):
        """Open, inside out, two bodies that share a vertex, flat: none ends the run."""
        cube = box((0, 0, 0), (1, 1, 1))
        corner = cube + box((1, 1, 1), (2, 2, 2))
        folder = self.folder([
            obj(cube, FACES[:-1]),
            obj([(x + 3, y, z) for x, y, z in cube], [(a, c, b) for a, b, c in FACES]),
            obj([(x + 6, y, z) for x, y, z in corner], FACES + [tuple(i + 8 for i in face) for face in FACES]),
            obj([(0, 0, 9), (1, 0, 9), (0, 1, 9)], [(0, 1, 2)])])
        reported = self.evaluate(folder, "--json", "--samples", "500")
        opened, inverted, joined, flat = reported["fragments"]
        self.assertEqual((reported["sound"], reported["open"]), (0, 2))
        self.assertTrue(any("2 fragments are open" in note for note in reported["notes"]), reported["notes"])
        self.assertEqual((opened["quality"]["boundary_edges"], opened["quality"]["closed"]), (3, False))
        self.assertIsNone(opened["convexity"])
        self.assertIn("open", opened["no_convexity"])
        self.assertIsNone(opened["overlap"]["share"])
        self.assertEqual((inverted["quality"]["outward"], inverted["quality"]["closed"]), (False, True))
        self.assertAlmostEqual(inverted["volume"], 1)
        self.assertGreater(inverted["convexity"], 0.99)
        self.assertEqual(joined["quality"]["non_manifold_vertices"], 1)
        self.assertAlmostEqual(joined["volume"], 2)
        self.assertIsNone(flat["convexity"])
        text = self.evaluate(folder, "--samples", "500")
        self.assertIn("note: 2 fragments are open", text)
        self.assertIn("meshes without a manifest", text)

    def test_csv_and_plot(self):
        folder = self.folder([obj(box((i, 0, 0), (i + 1, 1, 1)), FACES[:12 - (i == 2)]) for i in range(3)],
                             name="a & <b>")
        table, plot = self.tmp / "out.csv", self.tmp / "out.svg"
        reported = self.evaluate(folder, "--json", "--samples", "300", "--csv", table, "--plot", plot)
        with table.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["mesh"] for row in rows], [f["mesh"] for f in reported["fragments"]])
        for row, fragment in zip(rows, reported["fragments"]):
            self.assertEqual(float(row["share"]), fragment["share"])
            self.assertEqual(row["convexity"], "" if fragment["convexity"] is None else repr(fragment["convexity"]))
            self.assertEqual(int(row["boundary_edges"]), fragment["quality"]["boundary_edges"])
            self.assertEqual(row["closed"], "1" if fragment["quality"]["closed"] else "0")
            self.assertNotIn(None, row)
        self.assertEqual(len(set(map(len, rows))), 1)
        drawing = xml.etree.ElementTree.fromstring(plot.read_text())
        words = ["".join(text.itertext()) for text in drawing.iter("{http://www.w3.org/2000/svg}text")]
        self.assertEqual(words[0], "a & <b>")
        self.assertIn("Convexity", words)
        self.assertNotIn(str(self.tmp), plot.read_text())

    def test_cgal_agrees(self):
        folder = self.folder([obj(box((0, 0, 0), (1, 1, 1)), FACES), obj(box((1, 0, 0), (2, 1, 1)), FACES[1:])])
        result = subprocess.run([SHERD, "evaluate", folder, "--json", "--cgal"], capture_output=True, text=True)
        if result.returncode == 2 and "SHERD_GPL=ON" in result.stderr:
            skipping.skip(self, "CGAL", "a build without CGAL's checks")
        whole, opened = (f["cgal"] for f in json.loads(result.stdout)["fragments"])
        self.assertEqual(whole.pop("convexity") > 0.999, True)
        self.assertEqual(whole, {"polygon_mesh": True, "valid": True, "closed": True, "bounds_volume": True,
                                 "self_intersections": 0})
        self.assertEqual(opened, {"polygon_mesh": True, "valid": True, "closed": False, "bounds_volume": False,
                                  "self_intersections": 0, "convexity": None})
        self.assertIn("CGAL", self.evaluate(folder, "--cgal"))

    def test_what_is_no_folder_of_fragments(self):
        self.assertIn("neither manifest.json nor meshes", self.evaluate(self.tmp, status=3))
        folder = self.folder([obj(box((0, 0, 0), (1, 1, 1)), FACES)])
        self.assertIn("try a folder in it", self.evaluate(self.tmp, status=3))
        self.assertIn("is a file", self.evaluate(folder / "piece_0.obj", status=3))
        (folder / "piece_1.obj").write_text("v 0 0\nf 1 2 3\n")
        self.assertIn("piece_1.obj", self.evaluate(folder, status=3))
        (folder / "piece_1.obj").write_text("")
        self.assertIn("piece_1.obj", self.evaluate(folder, status=3))


if __name__ == "__main__":
    skipping.main()
