#!/usr/bin/python3
"""`sherd fracture` of volumes, and of a file's objects one by one.

SHERD_BIN names the program.  Level sets are written by OpenVDB's own Python module.  Needs python3-numpy, python3-openvdb.
"""
import json
import os
import struct
import subprocess
import tempfile
import unittest

import numpy as np
import pyopenvdb as vdb

import skipping
from manifests import check_run
import voxel_formats as vf

SHERD = os.environ["SHERD_BIN"]


def box(low, high):
    """OBJ lines of a box, by vertices counted from the end."""
    corners = [(low[0] if i < 4 else high[0], low[1] if i % 4 < 2 else high[1], low[2] if i % 2 == 0 else high[2])
               for i in range(8)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(
        "f " + " ".join(str(i - 8) for i in q) + "\n" for q in quads)


class VolumesTest(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)

    def path(self, *names):
        return os.path.join(self._folder.name, *names)

    def sherd(self, *arguments, code=0):
        run = subprocess.run([SHERD, *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(run.returncode, code, run.stderr)
        check_run(arguments, run.returncode)
        return run

    def manifest(self, *names):
        with open(self.path(*names, "manifest.json")) as file:
            return json.load(file)

    def test_fragments_of_a_level_set_lie_on_its_voxels(self):
        ball = vdb.createLevelSetSphere(radius=10.0, center=(3.0, 4.0, 5.0), voxelSize=0.5, halfWidth=3.0)
        vdb.write(self.path("ball.vdb"), grids=[ball])
        reported = json.loads(self.sherd("fracture", self.path("ball.vdb"), "-o", self.path("out"), "--pieces", 6, "--json").stdout)
        self.assertEqual(reported["voxel_size"], 0.5)
        self.assertIsNone(reported["report"])
        dense = np.zeros((64, 64, 64), np.float32)
        low = (-26, -24, -22)
        ball.copyToArray(dense, ijk=low)
        inside = dense < 0
        self.assertEqual(reported["voxels"], int(inside.sum()))
        union = np.zeros_like(inside)
        for fragment in self.manifest("out")["fragments"]:
            grid = vdb.read(self.path("out", fragment["files"]["vdb"]), "surface")
            self.assertEqual(tuple(grid.transform.indexToWorld((1, 2, 3))), tuple(ball.transform.indexToWorld((1, 2, 3))))
            values = np.zeros_like(dense)
            grid.copyToArray(values, ijk=low)
            union |= values < 0
        self.assertTrue((union <= inside).all())
        self.assertGreater(union.sum() / inside.sum(), 0.999)

    def test_another_resolution_measures_anew(self):
        ball = vdb.createLevelSetSphere(radius=10.0, center=(0.0, 0.0, 0.0), voxelSize=0.5, halfWidth=3.0)
        vdb.write(self.path("ball.vdb"), grids=[ball])
        reported = json.loads(self.sherd("fracture", self.path("ball.vdb"), "-o", self.path("out"), "--resolution", 80, "--json").stdout)
        self.assertAlmostEqual(reported["voxel_size"], 0.25, delta=0.005)
        self.assertAlmostEqual(reported["volume_out"], 4 / 3 * np.pi * 1000, delta=0.01 * 4189)

    def test_voxels_break_as_they_are(self):
        labels = np.zeros((20, 12, 30), np.uint16)
        labels[3:18, 2:11, 4:28] = 7
        labels[8:12, 4:8, 10:20] = 0
        np.save(self.path("block.npy"), labels)
        self.sherd("fracture", self.path("block.npy"), "-o", self.path("out"), "--pieces", 4, "--voxel-format", "npz")
        with np.load(self.path("out", "labels.npz")) as found:
            tight = labels[3:18, 2:11, 4:28]
            self.assertTrue(((found["labels"] != 0) == (tight != 0)).all())
            self.assertEqual(float(found["voxel_size"]), 1.0)
            self.assertTrue((found["origin"] == (3, 2, 4)).all())

    def test_refusals(self):
        with open(self.path("not.vdb"), "wb") as file:
            file.write(b"nothing of the kind")
        self.sherd("fracture", self.path("not.vdb"), "-o", self.path("out"), code=3)
        with open(self.path("empty.rle"), "wb") as file:
            file.write(vf.write_rle(np.zeros((3, 3, 3), np.uint16)))
        run = self.sherd("fracture", self.path("empty.rle"), "-o", self.path("out"), code=3)
        self.assertIn("nothing in it is solid", run.stderr)
        self.assertFalse(os.path.exists(self.path("out")))

    def ball(self):
        """A file of a level set, and where the masks of its first node are: the root's numbers stand behind the background."""
        ball = vdb.createLevelSetSphere(radius=6.0, center=(8.0, 8.0, 8.0), voxelSize=0.5, halfWidth=3.0)
        ball.name = "surface"
        vdb.write(self.path("ball.vdb"), grids=[ball])
        with open(self.path("ball.vdb"), "rb") as file:
            content = file.read()
        root = struct.pack("<ifII", 1, ball.background, 0, 1)
        self.assertEqual(content.count(root), 1)
        return content, content.index(root) + len(root) + 12

    def test_damaged_level_sets_are_refused_everywhere(self):
        content, node = self.ball()
        masks = bytearray(content)
        masks[node + 4096:node + 8192] = masks[node:node + 4096]  # children that are active tiles too
        length = bytearray(content)
        length[content.index(b"Tree_float") - 1] = 0xff  # a string of 4 GB
        self.sherd("fracture", self.path("ball.vdb"), "-o", self.path("good"), "--pieces", 2, "--write", "labels,vdb")
        for damaged, says in (masks, "is damaged near byte .* a child and an active tile"), (length, "ends too early"):
            for path in self.path("damaged.vdb"), self.path("good", "fragments", "ball_001.vdb"):
                with open(path, "wb") as file:
                    file.write(damaged)
            for command in (("inspect", self.path("damaged.vdb")), ("fracture", self.path("damaged.vdb"), "-o", self.path("out")),
                            ("render", self.path("damaged.vdb"), "-o", self.path("image.png")),
                            ("fracture", self.path("good", "manifest.json"), "-o", self.path("out"), "--only", 1),
                            ("fracture", os.path.join(os.environ["SHERD_DATA"], "amphora.ply"), "-o", self.path("out"),
                             "--density-attribute", self.path("damaged.vdb"))):
                self.assertRegex(self.sherd(*command, code=3).stderr, says)

    def test_a_damaged_level_set_does_not_end_a_library(self):
        content, node = self.ball()
        os.mkdir(self.path("library"))
        with open(self.path("library", "b.vdb"), "wb") as file:
            file.write(content[:node])
        for name, side in ("a", 1), ("c", 2):
            with open(self.path("library", name + ".obj"), "w") as file:
                file.write(box((0, 0, 0), (side, 1, 1)))
        for options in (), ("--resume",):
            self.sherd("dataset", self.path("library"), "-o", self.path("out"), "--pieces", "2..2", "--repeats", "1..1", "--resolution", 16, *options)
            with open(self.path("out", "failures.jsonl")) as file:
                self.assertRegex(file.read(), r"^\{.*b\.vdb.*is damaged.*\}\n$")

    def test_objects_break_by_themselves(self):
        with open(self.path("scene.obj"), "w") as file:
            file.write("o Small/Box\n" + box((0, 0, 0), (1, 1, 1)) + "o big\n" + box((5, 0, 0), (9, 4, 4)) +
                       "o Big\n" + box((20, 0, 0), (22, 4, 4)) + "o flat\n" + "v 0 0 0\nv 1 0 0\nv 2 0 0\nf -3 -2 -1\n")
        run = self.sherd("fracture", self.path("scene.obj"), "-o", self.path("out"), "--split-objects", "--pieces", 3,
                         "--resolution", 32, "--fill", "winding", "--json", code=3)
        reported = json.loads(run.stdout)
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["Big_2", "Small_Box", "big"])
        self.assertEqual([t["fragments"] for t in reported], [3, 3, 3])
        self.assertRegex(run.stderr, r"(?m)'flat': .*; try a higher resolution \(--resolution\)$")
        for name, volume in (("Small_Box", 1), ("big", 64), ("Big_2", 32)):
            manifest = self.manifest("out", name)
            self.assertAlmostEqual(sum(f["volume"] for f in manifest["fragments"]), volume, delta=0.02 * volume)
        self.assertEqual(self.manifest("out", "Small_Box")["source"]["object"], "Small/Box")
        self.assertEqual(self.manifest("out", "big")["grid"]["voxel_size"], 4 / 32)
        # Nothing leaves the folder, whatever objects are called.
        with open(self.path("names.obj"), "w") as file:
            for i, name in enumerate(("..", ".", "../../up", ".sherd-partial", "a\tb")):
                file.write(f"o {name}\n" + box((3 * i, 0, 0), (3 * i + 1, 1, 1)))
        before = sorted(os.listdir(self.path()))
        self.sherd("fracture", self.path("names.obj"), "-o", self.path("deep", "down"), "--split-objects", "--pieces", 2,
                   "--resolution", 16, "--write", "labels")
        self.assertEqual(sorted(os.listdir(self.path())), sorted(before + ["deep"]))
        self.assertEqual(os.listdir(self.path("deep")), ["down"])
        folders = os.listdir(self.path("deep", "down"))
        self.assertEqual(len(folders), 5, folders)
        self.assertFalse([f for f in folders if f.startswith(".")])
        # Without the flag they are one thing.
        self.sherd("fracture", self.path("scene.obj"), "-o", self.path("one"), "--pieces", 3, "--resolution", 32)
        self.assertEqual(len(self.manifest("one")["fragments"]), 3)


if __name__ == "__main__":
    skipping.main()
