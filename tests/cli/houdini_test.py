#!/usr/bin/python3
"""What the recipe of docs/houdini.md relies on, reported by OpenVDB itself.  Houdini is not run here.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy and python3-openvdb.

The claims about Houdini are those of OpenVDB's published sources of its nodes (openvdb_houdini): Convert VDB takes the
first grid's transform and background and leaves out every grid that has others; it makes a level set of the reference
mesh in that transform, and polygons that both surfaces have in common are `surface_polygons`.
"""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

import numpy as np
import pyopenvdb as vdb

import skipping
from cli_test import SHERD, sphere, write_obj, write_spread_seeds
from manifests import check_below

PIECES, RESOLUTION = 5, 48
# Types of metadata that Houdini turns into attributes; it discards all others.
ATTRIBUTE_TYPES = {b"bool", b"float", b"double", b"int32", b"int64", b"string", b"vec2i", b"vec2s", b"vec2d", b"vec3i",
                   b"vec3s", b"vec3d", b"vec4i", b"vec4s", b"vec4d", b"mat4s", b"mat4d"}


def volume_and_center(points, quads):
    """By the divergence theorem; OpenVDB's quads are clockwise seen from outside."""
    six, moment = 0.0, np.zeros(3)
    for a, b, c in ((0, 2, 1), (0, 3, 2)):
        p, q, r = (points[quads[:, k]].astype(float) for k in (a, b, c))
        each = np.einsum("ij,ij->i", p, np.cross(q, r))
        six, moment = six + each.sum(), moment + (each[:, None] * (p + q + r)).sum(axis=0)
    return six / 6, moment / (4 * six)


class Houdini(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="sherd-houdini-"))
        cls.addClassCleanup(shutil.rmtree, folder)
        cls.mesh = sphere(48, 96, center=(0.3, -2.0, 7.0), radius=1.25)
        write_obj(folder / "ball.obj", cls.mesh)
        cls.dir = folder / "pieces"
        write_spread_seeds(folder / "seeds.json", PIECES, center=(0.3, -2.0, 7.0), radius=1.25)
        subprocess.run([SHERD, "fracture", folder / "ball.obj", "-o", cls.dir, "--seeds", folder / "seeds.json", "--seed", "4",
                        "--resolution", str(RESOLUTION), "--quiet"], check=True, timeout=120)
        check_below(cls.dir)
        cls.manifest = json.loads((cls.dir / "manifest.json").read_text())
        cls.voxel = cls.manifest["grid"]["voxel_size"]
        cls.paths = [cls.dir / f["files"]["vdb"] for f in cls.manifest["fragments"]]
        cls.files = [vdb.readAll(str(path)) for path in cls.paths]
        cls.grids = [grids[0] for grids, _ in cls.files]
        # Room for all fragments and three voxels more.
        low = np.array(cls.manifest["grid"]["index_min"]) - 5
        cls.low, cls.dims = low, np.array(cls.manifest["grid"]["dims"]) + 10
        # As Convert VDB does with the mesh in its second input.
        cls.reference = vdb.FloatGrid.createLevelSetFromPolygons(
            np.array(cls.mesh[0], np.float32), triangles=np.array(cls.mesh[1], np.uint32),
            transform=cls.grids[0].transform, halfWidth=3.0)

    def dense(self, grid):
        values = np.empty(self.dims, np.float32)
        grid.copyToArray(values, ijk=tuple(int(i) for i in self.low))
        return values

    def test_file_sop_finds_one_level_set_in_a_file(self):
        self.assertEqual(len(self.paths), PIECES)
        for path, (grids, file_metadata) in zip(self.paths, self.files):
            self.assertEqual([g.name for g in grids], ["surface"])
            grid = grids[0]
            self.assertIsInstance(grid, vdb.FloatGrid)
            self.assertEqual(grid.gridClass, vdb.GridClass.LEVEL_SET)  # else it is shown as smoke
            self.assertEqual(grid["class"], "level set")
            self.assertFalse(grid.saveFloatAsHalf)
            self.assertRegex(file_metadata["creator"], r"^sherd \d")  # not Houdini: Blender would turn it
            self.assertEqual(struct.unpack("<I", path.read_bytes()[8:12])[0], 224)  # file version
            for key in ("file_bbox_min", "file_bbox_max", "file_voxel_count"):  # what the file browser shows
                self.assertIn(key, grid.metadata)

    def test_all_grids_have_one_transform_and_one_background(self):
        first = self.grids[0]
        matrix = np.array([[first.transform.indexToWorld(tuple(c))[k] for k in range(3)]
                           for c in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))])
        np.testing.assert_allclose(matrix[1:] - matrix[0], self.voxel * np.eye(3), atol=1e-12)  # no turn, no shear
        self.assertTrue(first.transform.isLinear)
        for grid in self.grids[1:]:
            self.assertEqual(grid.transform, first.transform)
            self.assertEqual(grid.background, first.background)
        self.assertAlmostEqual(first.background / self.voxel, 3, delta=1e-5)
        self.assertGreaterEqual(first.background, np.float32(3 * self.voxel))
        at = first.transform.indexToWorld(tuple(self.manifest["grid"]["index_min"]))
        np.testing.assert_allclose(at, self.manifest["grid"]["origin"], rtol=1e-12)

    def test_metadata_become_attributes(self):
        """`s@name = s@piece;` needs names that differ, and types that Houdini does not discard."""
        pieces = []
        for path, grid, says in zip(self.paths, self.grids, self.manifest["fragments"]):
            self.assertEqual(grid["fragment_id"], says["id"])
            self.assertEqual(list(grid["pivot"]), says["centroid"])
            self.assertEqual(grid["volume"], says["volume"])
            self.assertEqual((grid["source"], grid["seed"]), ("ball.obj", "4"))
            pieces.append(grid["piece"])
            raw = path.read_bytes()
            for key, kind in (("piece", b"string"), ("fragment_id", b"int32"), ("pivot", b"vec3d"),
                              ("volume", b"double"), ("seed", b"string"), ("source", b"string")):
                self.assertIn(kind, ATTRIBUTE_TYPES)
                text = struct.pack("<I", len(key)) + key.encode() + struct.pack("<I", len(kind)) + kind
                self.assertEqual(raw.count(text), 1, (path.name, key))
        self.assertEqual(pieces, [f"piece{i}" for i in range(1, PIECES + 1)])

    def test_level_sets_are_sound(self):
        for grid in self.grids:
            values = self.dense(grid)
            background = np.float32(grid.background)
            active = np.zeros(self.dims, bool)
            for item in grid.iterOnValues():
                self.assertEqual(item.min, item.max)  # no active tiles
                active[tuple(np.array(item.min) - self.low)] = True
            self.assertLess(np.abs(values[active]).max(), background)
            self.assertTrue((np.abs(values[~active]) == background).all())  # and so the inside is filled with the minus
            self.assertLess(values.min(), 0)

    def test_fragments_fill_the_reference_and_do_not_overlap(self):
        """The reference is made by OpenVDB from the mesh, in the fragments' own transform: on the original surface both
        have the same signs, and the same distances away from cracks.  So Convert VDB finds which polygons lie on it.
        """
        reference = self.dense(self.reference)
        fragments = np.array([self.dense(grid) for grid in self.grids])
        sure = np.abs(reference) > 0.02 * self.voxel
        inside = (fragments < 0).sum(axis=0)
        np.testing.assert_array_equal(inside[sure], (reference < 0).astype(int)[sure])
        # The nearest surface is the original one wherever two fragments are well away.
        owner = fragments.min(axis=0)
        others = np.sort(fragments, axis=0)[1]
        alone = (others >= 0.999 * self.grids[0].background) & (np.abs(reference) < 2 * self.voxel)
        self.assertGreater(alone.sum(), 5000)
        self.assertLess(np.quantile(np.abs(owner - reference)[alone], 0.99), 0.05 * self.voxel)

    def test_convert_vdb_at_zero_gives_closed_pieces_in_place(self):
        """OpenVDB's own mesher, as Convert VDB uses it; which quads lie on the reference is as the manifest has it."""
        reference = self.dense(self.reference)
        to_index = self.grids[0].transform.worldToIndex
        for grid, says in zip(self.grids, self.manifest["fragments"]):
            points, quads = grid.convertToQuads(isovalue=0.0)
            edges = [(q[i], q[(i + 1) % 4]) for q in quads.tolist() for i in range(4)]
            self.assertTrue(sorted(edges) == sorted((b, a) for a, b in edges))  # their diff would take hours
            volume, center = volume_and_center(points, quads)
            self.assertAlmostEqual(volume / says["volume"], 1, delta=0.01)
            np.testing.assert_allclose(center, says["centroid"], atol=0.05 * self.voxel)
            self.assertGreater(np.min(points.min(axis=0) - says["bbox"]["min"]), -0.5 * self.voxel)
            self.assertLess(np.max(points.max(axis=0) - says["bbox"]["max"]), 0.5 * self.voxel)
            middles = points[quads].mean(axis=1)
            cells = np.rint([to_index(tuple(map(float, m))) for m in middles]).astype(int) - self.low
            diagonals = points[quads[:, 2]] - points[quads[:, 0]], points[quads[:, 3]] - points[quads[:, 1]]
            area = np.linalg.norm(np.cross(*diagonals), axis=1) / 2
            on_surface = np.abs(reference[tuple(cells.T)]) < self.voxel
            share = area[on_surface].sum() / area.sum()
            self.assertAlmostEqual(share, says["original_area"] / says["area"], delta=0.06)


if __name__ == "__main__":
    skipping.main()
