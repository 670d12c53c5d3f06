#!/usr/bin/python3
"""`sherd evaluate --statistics`: Voronoi cells against scipy's, folders of other programs, and the output formats.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy and python3-scipy.
"""
import csv
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import numpy as np
from scipy.spatial import ConvexHull, Voronoi

from evaluating import SHERD, Evaluating

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "studies"))
import split_polygons  # noqa: E402

FACES = [(0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 2, 3), (0, 3, 1),
         (4, 5, 7), (4, 7, 6)]


def box(low, high):
    return [tuple((low, high)[i >> axis & 1][axis] for axis in range(3)) for i in range(8)]


def obj(vertices, faces):
    return "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in np.asarray(vertices).tolist()) + "".join(
        "f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces)


def voronoi_cells(seeds):
    """The cells of seeds in the unit cube: of each its region's vertices, and {neighbor: area}; walls are -1."""
    mirrored = [seeds]
    for axis in range(3):
        for wall in (0.0, 1.0):
            image = seeds.copy()
            image[:, axis] = 2 * wall - image[:, axis]
            mirrored.append(image)
    diagram = Voronoi(np.concatenate(mirrored))
    areas = [{} for _ in seeds]
    for pair, ridge in zip(diagram.ridge_points, diagram.ridge_vertices):
        if -1 in ridge or min(pair) >= len(seeds):
            continue
        corners = diagram.vertices[ridge]
        edges = corners - corners[0]
        area = np.linalg.norm(np.cross(edges[1:-1], edges[2:]).sum(axis=0)) / 2
        for a, b in (pair, pair[::-1]):
            if a < len(seeds):
                other = int(b) if b < len(seeds) else -1 - int(b)  # walls: a number each
                areas[a][other] = areas[a].get(other, 0.0) + area
    return [diagram.vertices[diagram.regions[diagram.point_region[i]]] for i in range(len(seeds))], areas


def block_mesh(path):
    path.write_text(obj(box((0, 0, 0), (1, 1, 1)), FACES))
    return path


class Statistics(Evaluating, unittest.TestCase):
    def setUp(self):
        self.tmp = pathlib.Path(tempfile.mkdtemp(prefix="sherd-statistics-"))
        self.addCleanup(shutil.rmtree, self.tmp)

    def fracture(self, mesh, *options):
        folder = self.tmp / "pieces"
        subprocess.run([SHERD, "fracture", mesh, "-o", folder, "--quiet", *options], check=True, timeout=300)
        return folder

    def folder(self, meshes):
        folder = self.tmp / "cells"
        folder.mkdir()
        for i, text in enumerate(meshes):
            (folder / f"piece_{i}.obj").write_text(text)
        return folder

    def test_cells_of_another_program(self):
        """Exact Voronoi cells as meshes without neighbors: scipy's faces, and 2 F - 4 vertices."""
        cells, areas = voronoi_cells(np.random.default_rng(3).random((40, 3)))
        meshes = []
        for corners in cells:
            hull = ConvexHull(corners)
            center = corners.mean(axis=0)
            out = np.einsum("ij,ij->i", np.cross(corners[hull.simplices[:, 1]] - corners[hull.simplices[:, 0]],
                                                 corners[hull.simplices[:, 2]] - corners[hull.simplices[:, 0]]),
                            corners[hull.simplices[:, 0]] - center) > 0
            meshes.append(obj(corners, [s if o else s[::-1] for s, o in zip(hull.simplices, out)]))
        reported = self.evaluate(self.folder(meshes), "--statistics", "--json", "--unit", "0.0001", "--tolerance", "0.0001")
        statistics = reported["statistics"]
        self.assertEqual((reported["manifest"], statistics["neighbors_known"], statistics["faces_by"]), (False, False, "planes"))
        self.assertIn("by distance", statistics["notes"][0])
        least = statistics["least_area"]
        self.assertAlmostEqual(least, 0.5e-8, places=12)
        for corners, area, fragment in zip(cells, areas, reported["fragments"]):
            cracks = sum(size >= least for other, size in area.items() if other >= 0)
            self.assertEqual(fragment["faces"], cracks, fragment)
            self.assertEqual(fragment["flat_faces"], sum(size >= least for size in area.values()), fragment)
            self.assertEqual(fragment["flat_vertices"], 2 * fragment["flat_faces"] - 4, fragment)
            self.assertAlmostEqual(fragment["share"], ConvexHull(corners).volume, places=6)
            crack_area = sum(size for other, size in area.items() if other >= 0)
            self.assertAlmostEqual(fragment["break_share"], crack_area / sum(area.values()), places=5)
        inner = [sum(size >= least for size in a.values()) for a in areas if min(a) >= 0]
        self.assertEqual(statistics["interior_faces"]["count"], len(inner))
        self.assertAlmostEqual(statistics["interior_faces"]["mean"], np.mean(inner), places=9)

    def test_cells_of_a_fracture(self):
        """Faces of interior pieces within 5 % of the exact cells of the same seeds, at the same cutoff."""
        folder = self.fracture(block_mesh(self.tmp / "block.obj"), "--pieces", "120", "--resolution", "96", "--seed", "4",
                               "--write", "mesh,seeds")
        seeds = json.loads((folder / "seeds.json").read_text())["seeds"]
        areas = voronoi_cells(np.array([seed["position"] for seed in seeds]))[1]
        reported = self.evaluate(folder, "--statistics", "--json")
        statistics, pieces = reported["statistics"], {f["id"]: f for f in reported["fragments"]}
        self.assertTrue(statistics["neighbors_known"])
        self.assertAlmostEqual(statistics["least_area"], 0.5 / 96 ** 2, places=9)
        exact, found = [], []
        for seed, area in zip(seeds, areas):
            if min(area) >= 0:
                exact.append(sum(size >= statistics["least_area"] for size in area.values()))
                found.append(pieces[seed["fragment"]]["faces"])
                self.assertTrue(pieces[seed["fragment"]]["interior"])
        self.assertGreater(len(exact), 20)
        self.assertAlmostEqual(np.mean(found) / np.mean(exact), 1.0, delta=0.05)
        self.assertLess(np.mean(np.abs(np.subtract(found, exact))), 1.0)

    def test_cells_of_drawn_sizes_follow_from_the_seed_file(self):
        """Weights in seeds.json are those of a power diagram: it gives all labels but those of voxels that were regrown."""
        folder = self.fracture(block_mesh(self.tmp / "block.obj"), "--pieces", "25", "--resolution", "40", "--sizes", "exponential",
                               "--seed", "3", "--write", "seeds,labels", "--voxel-format", "npz")
        manifest = json.loads((folder / "manifest.json").read_text())
        seeds = json.loads((folder / "seeds.json").read_text())["seeds"]
        self.assertGreater(sum("weight" in seed for seed in seeds), 20)
        [file] = [folder / name for name in manifest["files"] if name.endswith(".npz")]
        with np.load(file) as archive:
            labels = np.maximum(archive["labels"].astype(int) - 1, 0)
        grid = manifest["grid"]
        self.assertEqual(list(labels.shape), grid["dims"])
        voxels = np.argwhere(labels > 0)
        centers = np.array(grid["origin"]) + (np.array(grid["index_min"]) + voxels) * grid["voxel_size"]
        squared = ((centers[:, None, :] - np.array([seed["position"] for seed in seeds])) ** 2).sum(axis=2)
        powers = squared - np.array([seed.get("weight", 0.0) for seed in seeds])
        nearest = np.array([seed["fragment"] for seed in seeds])[powers.argmin(axis=1)]
        least_two = np.partition(powers, 1, axis=1)[:, :2]
        is_tie = least_two[:, 1] - least_two[:, 0] < 1e-9
        found = labels[tuple(voxels.T)]
        self.assertLessEqual(((nearest != found) & ~is_tie).sum(), 0.001 * len(voxels))
        unweighted = np.array([seed["fragment"] for seed in seeds])[squared.argmin(axis=1)]
        self.assertGreater((unweighted != found).mean(), 0.1)

    def test_a_plate_has_corners(self):
        folder = self.folder([obj(box((2 * (i % 4), 2 * (i // 4), 0), (2 * (i % 4) + 2, 2 * (i // 4) + 2, 0.5)), FACES)
                              for i in range(16)])
        reported = self.evaluate(folder, "--statistics", "--json")
        statistics = reported["statistics"]
        self.assertEqual(statistics["thin_axis"], "z")
        self.assertEqual((statistics["corners"]["count"], statistics["corners"]["mean"]), (4, 4.0))
        self.assertEqual([f["corners"] for f in reported["fragments"]],
                         [4 if i % 4 in (1, 2) and i // 4 in (1, 2) else None for i in range(16)])
        self.assertIsNone(statistics["interior_faces"])

    def test_corners_of_splits_in_a_plate(self):
        """Corners beside the polygons that the recorded splits cut out of the plate."""
        plate, voxel = self.tmp / "plate.obj", 1 / 128
        plate.write_text(obj(box((0, 0, 0), (1, 1, 1 / 32)), FACES))
        folder = self.fracture(plate, "--pieces", "80", "--resolution", "128", "--seed", "3", "--growth", "sequential",
                               "--write", "mesh")
        polygons = split_polygons.polygons_of(json.loads((folder / "manifest.json").read_text()), (1, 1, 1 / 32))
        self.assertEqual(sum(len(polygon) for polygon in polygons.values()), 4 * 80)
        measured = {f["id"]: f["corners"] for f in self.evaluate(folder, "--statistics", "--json")["fragments"]}
        same, long_edges = 0, []
        for fragment, polygon in polygons.items():
            edges = split_polygons.edge_lengths(polygon)
            rim = sum(length for length, (_, split) in zip(edges, polygon) if split == split_polygons.RIM)
            if rim == 0 or rim > voxel:  # a part of less than a voxel may have no voxel
                self.assertEqual(measured[fragment] is None, rim > 0, f"fragment {fragment}")
            if rim == 0 and edges.min() > 2 * voxel:
                long_edges.append(fragment)
                same += measured[fragment] == len(polygon)
        self.assertGreater(len(long_edges), 30)
        # Voxels at a sharp corner may belong to a neighbor, whose crack is then one more edge.
        self.assertGreaterEqual(same, len(long_edges) - 1)

    def test_formats(self):
        folder = self.fracture(block_mesh(self.tmp / "block.obj"), "--pieces", "30", "--resolution", "48", "--write", "mesh")
        plot, rows = self.tmp / "plot.svg", self.tmp / "rows.csv"
        reported = self.evaluate(folder, "--statistics", "--json", "--csv", rows, "--plot", plot)
        text = self.evaluate(folder, "--statistics")
        for figure in reported["published"]:
            if figure["quantity"] in ("contacts", "break_share", "tau", "exponential_p"):
                self.assertIn(figure["source"], text)
        self.assertIn(f"contacts per fragment      {reported['statistics']['contacts']['mean']:.2f} +- ", text)
        with rows.open(newline="") as file:
            for row, fragment in zip(csv.DictReader(file), reported["fragments"], strict=True):
                for key, value in row.items():
                    expected = fragment[key]
                    if expected is None:
                        self.assertEqual(value, "")
                    elif isinstance(expected, bool):
                        self.assertEqual(value, str(int(expected)))
                    else:
                        self.assertEqual(type(expected)(value), expected, key)
        self.assertEqual(xml.etree.ElementTree.parse(plot).getroot().tag, "{http://www.w3.org/2000/svg}svg")
        before = plot.read_bytes(), rows.read_bytes(), text
        self.evaluate(folder, "--statistics", "--csv", rows, "--plot", plot, "--threads", "1")
        self.assertEqual((plot.read_bytes(), rows.read_bytes(), self.evaluate(folder, "--statistics")), before)

    def test_labels_alone(self):
        folder = self.fracture(block_mesh(self.tmp / "block.obj"), "--pieces", "12", "--resolution", "32", "--write", "labels")
        reported = self.evaluate(folder, "--statistics", "--json")
        self.assertIsNone(reported["statistics"]["faces"])
        self.assertGreater(reported["statistics"]["contacts"]["mean"], 2)
        self.assertGreater(reported["statistics"]["break_share"], 0.1)  # of the manifest's areas
        self.assertIn("no meshes", reported["statistics"]["notes"][0])
        self.assertEqual(reported["statistics"]["sizes"]["count"], 12)

    def test_refusals(self):
        folder = self.folder([obj(box((0, 0, 0), (1, 1, 1)), FACES)])
        for options in (["--faces", "planes"], ["--statistics", "--cgal"], ["--statistics", "--samples", "9"],
                        ["--statistics", "--least-face", "-1"], ["--statistics", "--plane-tolerance", "nan"],
                        ["--statistics", "--propagation", "0,0,0"], ["--statistics", "--propagation", "1,2"],
                        ["--statistics", "--faces", "round"], ["--statistics", "--unit", "0"],
                        ["--statistics", "--unit", "1e300"], ["--statistics", "--unit", "1e-300"],
                        ["--statistics", "--plane-tolerance", "1e300"]):
            self.evaluate(folder, *options, status=2)
        for unit in ("1e-100", "1e100"):
            text = self.evaluate(folder, "--statistics", "--unit", unit)
            self.assertNotRegex(text, r"\b(inf|nan)\b")
        reported = self.evaluate(folder, "--statistics", "--json")  # one piece without cracks
        self.assertEqual(reported["statistics"]["faces"]["mean"], 0)
        self.assertIsNone(reported["statistics"]["orientation"])
        self.assertEqual(reported["statistics"]["break_share"], 0)
        self.assertIsNone(reported["statistics"]["sizes"]["exponential"])

    def test_the_page_has_the_published_figures(self):
        page = re.sub(r"\s+", " ", (ROOT / "docs" / "realism.md").read_text())
        folder = self.folder([obj(box((0, 0, 0), (1, 1, 1)), FACES)])
        for figure in self.evaluate(folder, "--statistics", "--json")["published"]:
            self.assertIn(figure["of"], page)
            self.assertIn(figure["source"], page)


if __name__ == "__main__":
    unittest.main()
