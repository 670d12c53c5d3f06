#!/usr/bin/python3
"""`sherd render`: what its pictures and layers hold, from which files it draws, and what it refuses.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy; with
python3-openimageio the layers are read by that too.
"""
import json
import math
import os
import struct
import unittest

import numpy as np

try:
    import OpenImageIO
except ImportError:
    OpenImageIO = None

import skipping
from cli_test import CommandLine, tree
from exr_file import read_exr
from png_file import read_png

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")
BOX = b"".join(b"v %d %d %d\n" % (4 * (i >> 2 & 1) - 1, 2 * (i >> 1 & 1) + 5, 6 * (i & 1) + 2) for i in range(8)) + (
    b"f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n")  # x -1..3, y 5..7, z 2..8


class Render(CommandLine):
    def drawn(self, *arguments):
        result = self.run_sherd("render", *map(str, arguments))
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def layers(self, *arguments):
        picture = self.path("layers.exr")
        self.drawn(*arguments, "-o", picture)
        return read_exr(picture)

    def broken(self, *arguments, pieces=5):
        done = self.run_sherd("fracture", AMPHORA, "-o", self.out, "--resolution", "48", "--pieces", str(pieces), *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.out, "manifest.json")) as file:
            return json.load(file)

    def size_of(self, picture):
        with open(picture, "rb") as file:
            data = file.read(24)
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        return struct.unpack(">2I", data[16:24])

    def test_layers_of_a_box_are_where_geometry_has_them(self):
        box = self.path("box.obj", BOX)
        layers = self.layers(box, "--view", "front", "--size", "80x60")
        self.assertEqual(sorted(layers), sorted("R G B A Z N.X N.Y N.Z P.X P.Y P.Z id neighbor".split()))
        seen = layers["id"] == 1
        self.assertGreater(seen.sum(), 500)
        self.assertTrue((layers["id"][~seen] == 0).all() and np.isinf(layers["Z"][~seen]).all())
        self.assertTrue((layers["neighbor"] == 0).all())
        # From the front only the face z = 8 is seen, at one depth; and pixels are tan(17.5 degrees) / 30 of it apart.
        depth = layers["Z"][seen]
        self.assertLess(np.ptp(depth), 1e-4 * depth.mean())
        np.testing.assert_allclose(layers["P.Z"][seen], 8, atol=1e-5)
        for name, value in (("N.X", 0), ("N.Y", 0), ("N.Z", 1)):
            np.testing.assert_allclose(layers[name][seen], value, atol=1e-6)
        y, x = np.nonzero(seen)
        step = depth.mean() * math.tan(math.radians(17.5)) / 30
        np.testing.assert_allclose(layers["P.X"][seen] - step * x, (layers["P.X"][seen] - step * x).mean(), atol=1e-3)
        np.testing.assert_allclose(layers["P.Y"][seen] + step * y, (layers["P.Y"][seen] + step * y).mean(), atol=1e-3)
        self.assertAlmostEqual(layers["P.X"][seen].min(), -1, delta=step)
        self.assertAlmostEqual(layers["P.X"][seen].max(), 3, delta=step)
        self.assertTrue((layers["A"][seen] > 0).all() and (layers["A"] <= 1).all())
        self.assertTrue((layers["R"][layers["A"] == 0] == 0).all())

    @skipping.skip_unless(OpenImageIO, "OPENIMAGEIO", "python3-openimageio is not installed")
    def test_another_reader_finds_the_same_layers(self):
        layers = self.layers(self.path("box.obj", BOX), "--size", "80x60")
        image = OpenImageIO.ImageBuf(self.path("layers.exr"))
        names = list(image.spec().channelnames)
        self.assertEqual(sorted(names), sorted(layers))
        pixels = image.get_pixels(OpenImageIO.FLOAT)
        for k, name in enumerate(names):
            values = pixels[..., k]
            if layers[name].dtype == np.uint32:  # it takes whole numbers for shares of the largest
                values = np.rint(values * (2.0**32 - 1))
            np.testing.assert_array_equal(values, layers[name].astype(np.float32), name)

    def test_up_turns_the_view_and_not_the_layers(self):
        box = self.path("box.obj", BOX)
        layers = self.layers(box, "--view", "top", "--up", "z", "--size", "80x60")
        seen = layers["id"] == 1
        np.testing.assert_allclose(layers["P.Z"][seen], 8, atol=1e-5)
        np.testing.assert_allclose(layers["N.Z"][seen], 1, atol=1e-6)

    def test_layers_of_a_fracture_tell_fragments_and_what_they_face(self):
        manifest = self.broken()
        layers = self.layers(self.out, "--explode", "0", "--size", "320x240")
        points = np.stack([layers[f"P.{axis}"] for axis in "XYZ"], -1)
        shown = set(np.unique(layers["id"])) - {0}
        self.assertGreaterEqual(len(shown), 3)
        for fragment in manifest["fragments"]:
            own = layers["id"] == fragment["id"]
            if own.any():
                low, high = np.array(fragment["bbox"]["min"]), np.array(fragment["bbox"]["max"])
                slack = 1e-5 * (high - low).max()
                self.assertTrue((points[own] >= low - slack).all() and (points[own] <= high + slack).all())
        apart = self.layers(self.out, "--explode", "1", "--size", "320x240")
        inner = apart["neighbor"][apart["id"] > 0]
        self.assertGreater((inner > 0).sum(), 100)
        contacts = {(f["id"], c["id"]) for f in manifest["fragments"] for c in f["contacts"]}
        pairs = set(zip(apart["id"][apart["neighbor"] > 0].tolist(), apart["neighbor"][apart["neighbor"] > 0].tolist()))
        self.assertLessEqual(pairs, contacts)

    def test_draws_the_picture_that_a_fracture_has(self):
        self.broken()
        picture = self.path("again.png")
        self.drawn(self.out, "-o", picture)
        self.assertEqual(self.size_of(picture), (1280, 720))
        # Files hold single precision, so a pixel at an edge may differ; another picture would all over.
        again, preview = read_png(picture), read_png(os.path.join(self.out, "preview.png"))
        self.assertLess((np.abs(again - preview).max(-1) > 8).mean(), 0.001)
        self.drawn(self.out, "-o", picture, "--view", "front")
        self.assertGreater((np.abs(read_png(picture) - preview).max(-1) > 8).mean(), 0.02)

    def test_turntable_numbers_its_pictures(self):
        box = self.path("box.obj", BOX)
        self.drawn(box, "-o", self.path("t.png"), "--turntable", "4", "--size", "64x48", "--view", "10,5")
        self.drawn(box, "-o", self.path("one.png"), "--size", "64x48", "--view", "190,5")
        found = tree(self.tmp)
        self.assertEqual(sorted(n for n in found if n.startswith("t")), [f"t_00{i}.png" for i in (1, 2, 3, 4)])
        self.assertEqual(found["t_003.png"], found["one.png"])
        self.assertNotEqual(found["t_001.png"], found["t_003.png"])

    def test_several_meshes_are_shown_together(self):
        other = b"".join(b"v %d %d %d\n" % (x + 6, y, z) for x, y, z in (map(int, line.split()[1:]) for line in BOX.split(b"\n")[:8]))
        one, two = self.path("one.obj", BOX), self.path("two.obj", other + BOX[BOX.index(b"f"):])
        view = (one, two, "--view", "front", "--size", "160x120", "--explode", "0")
        self.assertEqual(set(np.unique(self.layers(*view)["id"])), {0, 1, 2})
        ids = self.layers(*view, "--focus", "2")["id"]
        self.assertEqual(ids[60, 80], 2)
        self.assertGreater((ids == 2).sum(), 3 * (self.layers(*view)["id"] == 2).sum())
        self.assertGreater((ids == 2).sum(), (self.layers(*view, "--focus", "2", "--zoom", "0.5")["id"] == 2).sum())
        self.refused(2, self.run_sherd("render", one, two, "-o", self.path("x.png"), "--focus", "3"), "--focus", "fragment 3")
        self.refused(2, self.run_sherd("render", one, "-o", self.path("x.png"), "--zoom", "0"), "--zoom")

    def test_draws_level_sets(self):
        self.broken("--write", "vdb", "--vdb", "both")
        for source in (self.out, os.path.join(self.out, "fragments.vdb"), os.path.join(self.out, "manifest.json")):
            layers = self.layers(source, "--size", "160x120")
            self.assertGreaterEqual(len(set(np.unique(layers["id"])) - {0}), 3, source)
        for layout in ("files", "single"):
            self.broken("--write", "vdb", "--vdb", layout)
            self.assertGreaterEqual(len(set(np.unique(self.layers(self.out, "--size", "160x120")["id"])) - {0}), 3)
        self.broken("--write", "vdb")
        one = self.layers(os.path.join(self.out, "fragments", "amphora_002.vdb"), "--size", "64x48")
        self.assertEqual(set(np.unique(one["id"])), {0, 1})

    def test_refuses_with_a_sentence(self):
        box, picture = self.path("box.obj", BOX), self.path("x.png")
        for arguments in (["--view", "sideways"], ["--view", "0,91"], ["--size", "8x8"], ["--size", "64"], ["--explode", "-1"],
                          ["--turntable", "-1"], ["--up", "w"]):
            self.refused(2, self.run_sherd("render", box, "-o", picture, *arguments), arguments[0])
        self.refused(2, self.run_sherd("render", box, "-o", self.path("x.jpg")), "x.jpg")
        self.refused(2, self.run_sherd("render", box), "--output")
        os.mkdir(self.path("folder.png"))
        self.refused(5, self.run_sherd("render", box, "-o", self.path("folder.png")), "folder.png")
        self.refused(5, self.run_sherd("render", box, "-o", self.path("none/x.exr")), "none")
        self.refused(3, self.run_sherd("render", self.path("absent.ply"), "-o", picture), "absent.ply")
        os.mkdir(self.path("empty"))
        self.refused(3, self.run_sherd("render", self.path("empty"), "-o", picture), "empty")
        self.assertFalse(os.path.exists(picture))

    def test_refuses_cut_and_foreign_files(self):
        self.broken("--write", "vdb")
        with open(os.path.join(self.out, "fragments", "amphora_001.vdb"), "rb") as file:
            whole = file.read()
        picture = self.path("x.png")
        for data in (whole[:0], whole[:30], whole[:len(whole) // 2], whole[:-1], b"no grid at all\n" * 99, BOX):
            self.refused(3, self.run_sherd("render", self.path("cut.vdb", data), "-o", picture), "cut.vdb")
            self.refused(3, self.run_sherd("inspect", self.path("cut.vdb", data)), "cut.vdb")
        for name, data in (("a.json", b"{}"), ("a.json", b"\xff\xfe"), ("a.ply", b"ply\n"), ("a.png", b"\x89PNG")):
            self.refused(3, self.run_sherd("render", self.path(name, data), "-o", picture), name)


if __name__ == "__main__":
    skipping.main()
