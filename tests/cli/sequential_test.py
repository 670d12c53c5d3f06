#!/usr/bin/python3
"""`--growth sequential`: pieces that are split one after another, as NumPy and the manifest show them, and what is refused.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy and python3-scipy.
"""
import json
import math
import os
import pathlib

import numpy as np
import scipy.ndimage

import skipping
from cli_test import CommandLine, tree

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")


def box(path, low, high):
    """Appends a closed box to an OBJ file."""
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    with open(path, "a") as file:
        for corner in corners:
            file.write("v %g %g %g\n" % corner)
        for quad in quads:
            file.write("f %d %d %d %d\n" % tuple(i - 8 for i in quad))


class Sequential(CommandLine):
    def broken(self, *options, mesh=AMPHORA, pieces=9, resolution=48, out=None):
        """The manifest, and the labels as an array: fragment ids, 0 outside."""
        out = out or self.out
        result = self.run_sherd("fracture", mesh, "-o", out, "--growth", "sequential", "--pieces", str(pieces),
                                "--resolution", str(resolution), "--write", "labels,vdb", "--voxel-format", "npz", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(out, "manifest.json")) as file:
            manifest = json.load(file)
        [name] = [name for name in manifest["files"] if name.endswith(".npz")]
        with np.load(os.path.join(out, name)) as archive:
            labels = archive["labels"].astype(int)
        return manifest, np.maximum(labels - 1, 0)

    def test_any_number_of_connected_pieces(self):
        for pieces in (1, 2, 9, 100):
            out = self.path(str(pieces))
            manifest, labels = self.broken(pieces=pieces, out=out)
            self.assertEqual(len(manifest["fragments"]), pieces)
            self.assertEqual(len(manifest["splits"]), pieces - manifest["components"])
            for fragment in range(1, pieces + 1):
                self.assertEqual(scipy.ndimage.label(labels == fragment)[1], 1)

    def test_the_tree_of_splits(self):
        """Each split divides what its parent left: voxels of fragments add up to those of every split."""
        manifest, labels = self.broken("--min-share", "0.01", pieces=20)
        splits = manifest["splits"]
        voxels = [0] * (len(splits) + 1)
        for fragment in manifest["fragments"]:
            self.assertGreaterEqual(fragment["share"], 0.01)
            at = fragment["split"]
            while at > 0:
                voxels[at] += fragment["voxels"]
                self.assertLess(splits[at - 1]["parent"], at)  # a piece before those that come of it
                at = splits[at - 1]["parent"]
        self.assertEqual([split["voxels"] for split in splits], voxels[1:])
        for split in splits:
            parent = splits[split["parent"] - 1]["level"] if split["parent"] else 0
            self.assertEqual(split["level"], parent + 1)

    def test_planes_divide_the_pieces(self):
        """Of a convex solid every voxel lies on its side of every plane; positions are those of the grid."""
        block = self.path("block.obj")
        box(block, (3, 1, -2), (4, 1.5, -1.5))
        manifest, labels = self.broken(mesh=block, pieces=12)
        index = np.argwhere(labels > 0)
        at = np.array(manifest["grid"]["origin"]) + manifest["grid"]["voxel_size"] * index
        fragments = {fragment["id"]: fragment for fragment in manifest["fragments"]}
        side = {}  # of the voxels below each split, by child: whether they are on the positive side
        for split in manifest["splits"]:
            below = np.array([self.comes_from(fragments[i], split["id"], manifest["splits"]) if i else 0
                              for i in range(len(fragments) + 1)])
            child = below[labels[tuple(index.T)]]
            beyond = at @ np.array(split["plane"]["normal"]) > split["plane"]["distance"]
            for which in np.unique(child[child != 0]):
                side[split["id"], which] = beyond[child == which]
        for split in manifest["splits"]:
            own = [beyond for (number, child), beyond in side.items() if number == split["id"]]
            self.assertEqual(len(own), 2)
            self.assertNotEqual(own[0].mean() > 0.5, own[1].mean() > 0.5)
            # A plane may cut off a voxel at an edge of a piece besides, which stays with what it touches.
            for beyond in own:
                self.assertLessEqual(min(beyond.sum(), (~beyond).sum()), 2)

    @staticmethod
    def comes_from(fragment, split, splits):
        """The part of a split that a fragment comes from: the next split below it, or minus the fragment; 0 if none."""
        at, child = fragment["split"], -fragment["id"]
        while at > 0:
            if at == split:
                return child
            at, child = splits[at - 1]["parent"], at
        return 0

    def test_cracks_of_a_plate_cross_it_at_right_angles(self):
        plate = self.path("plate.obj")
        box(plate, (0, 0, 0), (1, 1, 0.05))
        manifest, labels = self.broken(mesh=plate, pieces=30, resolution=80)
        tilts = [abs(split["plane"]["normal"][2]) for split in manifest["splits"]]
        self.assertLess(np.median(tilts), 0.02)

    def test_where_cracks_regard_walls_is_recorded(self):
        """The amphora has thin walls, a block has none; what is recorded gives the same fracture again."""
        block = self.path("block.obj")
        box(block, (0, 0, 0), (1, 0.7, 0.6))
        for mesh, on in ((AMPHORA, "wall"), (block, "auto")):
            manifest, labels = self.broken(mesh=mesh, resolution=64, out=self.path(on))
            self.assertEqual(manifest["options"]["seeds"]["on"], on)
            again, same = self.broken("--seeds-on", on, mesh=mesh, resolution=64, out=self.path(on + " given"))
            self.assertTrue((labels == same).all())
            volume, other = self.broken("--seeds-on", "volume", mesh=mesh, resolution=64, out=self.path(on + " volume"))
            self.assertEqual(volume["options"]["seeds"]["on"], "volume")
            if on == "wall":
                self.assertLess((labels == other)[labels > 0].mean(), 0.99)

    def test_cracks_of_an_impact(self):
        """Radial cracks through its point, as many as its energy makes, and rings that do not meet."""
        plate = self.path("plate.obj")
        box(plate, (0, 0, 0), (1, 1, 0.05))
        for energy, radials in (("1", 8), ("16", 16)):
            out = self.path("energy " + energy)
            manifest, labels = self.broken("--impact", f"0.5,0.5,0.05,energy={energy}", mesh=plate, pieces=150, resolution=100, out=out)
            center, splits = np.array([0.5, 0.5, 0.025]), manifest["splits"]
            h = manifest["grid"]["voxel_size"]
            through = [split for split in splits if "plane" in split
                       and abs(center @ np.array(split["plane"]["normal"]) - split["plane"]["distance"]) < 0.1 * h]
            # The first crack leads in both directions.
            self.assertEqual(len([split for split in through if split["level"] <= np.log2(radials)]), radials - 1)
            for split in through:
                self.assertLess(abs(split["plane"]["normal"][2]), 0.02)
            rings = [split["sphere"] for split in splits if "sphere" in split]
            self.assertGreaterEqual(len(rings), 3 * radials)
            self.assertTrue(np.allclose([ring["center"] for ring in rings], center, atol=0.2 * h))
            self.assertEqual(len({ring["radius"] for ring in rings}), len(rings))

    def test_a_small_impact_breaks_only_around_it(self):
        """A ring bounds the pattern: the count of pieces comes of the solid within, to a voxel."""
        block = self.path("block.obj")
        box(block, (0, 0, 0), (1, 1, 1))
        manifest, labels = self.broken("--impact", "0.5,0.5,1,20,0.1,energy=1", mesh=block, pieces=25, resolution=64)
        spheres = [split for split in manifest["splits"] if "sphere" in split]
        outer = max(spheres, key=lambda split: split["sphere"]["radius"])
        self.assertEqual(outer["level"], 1)
        index = np.argwhere(labels > 0)
        at = np.array(manifest["grid"]["origin"]) + manifest["grid"]["voxel_size"] * index
        near = np.linalg.norm(at - outer["sphere"]["center"], axis=1) < outer["sphere"]["radius"]
        own = labels[tuple(index.T)]
        self.assertEqual(len(np.unique(own[near])), 20)
        self.assertEqual(len(np.unique(own[~near])), 5)

    def test_what_impacts_do_not_do_is_said(self):
        for impact, warns in (("0,0,0,4", False), ("0,0,0,energy=1,merge", True), ("0,0,0,energy=1", False), ("0,0,0", False)):
            result = self.run_sherd("fracture", AMPHORA, "-o", self.path(impact), "--growth", "sequential", "--pieces", "9", "--resolution", "32",
                                    "--impact", impact)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual("merge does nothing there" in result.stderr, warns, result.stderr)

    def test_a_count_is_met_by_the_cracks_of_an_impact(self):
        plate = self.path("plate.obj")
        box(plate, (0, 0, 0), (1, 1, 0.05))
        _, given = self.broken("--impact", "0.5,0.5,0.05,20", mesh=plate, pieces=25, resolution=80)
        _, energetic = self.broken("--impact", "0.5,0.5,0.05,20,energy=1", mesh=plate, pieces=25, resolution=80, out=self.path("energetic"))
        np.testing.assert_array_equal(given, energetic)

    def test_impacts_come_before_the_sizes_of_a_material(self):
        """Pieces of glass are drawn from a distribution, but where it is hit; sizes that are given stay."""
        plate = self.path("plate.obj")
        box(plate, (0, 0, 0), (1, 1, 0.05))
        for material in ("glass", "tempered"):
            hit = ("--material", material, "--impact", "0.5,0.5,0.05,energy=1")
            result = self.run_sherd("fracture", plate, "-o", self.path(material), "--pieces", "80", "--resolution", "96", *hit)
            self.assertEqual((result.returncode, result.stderr.count("does nothing")), (0, 0), result.stderr)
            manifest = self.manifest(self.path(material))
            self.assertNotIn("sizes", manifest["options"])
            far = [math.dist(f["centroid"][:2], (0.5, 0.5)) for f in manifest["fragments"]]
            small = np.array(far)[np.argsort([f["voxels"] for f in manifest["fragments"]])[:40]]
            self.assertLess(np.median(small), 0.25, material)  # 0.38 of points anywhere
            unhit = self.run_sherd("fracture", plate, "-o", self.path("unhit " + material), "--pieces", "80", "--resolution", "96", *hit[:2])
            self.assertEqual(unhit.returncode, 0)
            self.assertIn("sizes", self.manifest(self.path("unhit " + material))["options"])
        self.assertIn("sizes", self.broken("--material", "glass", "--sizes", "exponential", "--impact", "0.5,0.5,0.05,energy=1", mesh=plate,
                                           pieces=20, out=self.path("given"))[0]["options"])

    def test_cracks_are_the_same_at_twice_the_resolution(self):
        block = self.path("block.obj")
        box(block, (0, 0, 0), (1, 0.7, 0.6))
        for mesh, resolution in ((block, 48), (AMPHORA, 128)):  # the amphora has walls of five voxels
            coarse, few = self.broken(mesh=mesh, resolution=resolution, out=self.path(f"{resolution}"))
            fine, many = self.broken(mesh=mesh, resolution=2 * resolution, out=self.path(f"{resolution} twice"))
            index = np.argwhere(many > 0)
            at = np.array(fine["grid"]["origin"]) + fine["grid"]["voxel_size"] * index
            near = np.rint((at - np.array(coarse["grid"]["origin"])) / coarse["grid"]["voxel_size"]).astype(int)
            within = np.all((near >= 0) & (near < few.shape), axis=1)
            own, other = many[tuple(index[within].T)], few[tuple(near[within].T)]
            self.assertGreater((own == other)[other > 0].mean(), 0.9)

    def test_components_are_pieces(self):
        boxes = self.path("boxes.obj")
        box(boxes, (0, 0, 0), (1, 1, 1))
        box(boxes, (2, 0, 0), (2.4, 0.4, 0.4))
        for pieces, components in ((2, 2), (1, 2), (12, 2)):
            manifest, labels = self.broken(mesh=boxes, pieces=pieces, out=self.path(f"p{pieces}"))
            self.assertEqual(manifest["components"], components)
            self.assertEqual(len(manifest["fragments"]), max(pieces, components))
            self.assertEqual(len(manifest["splits"]), max(pieces, components) - components)

    def test_the_same_bytes_with_one_thread_and_two(self):
        self.broken("--threads", "1", "--roughness", "1", out=self.path("one"))
        self.broken("--threads", "2", "--roughness", "1", out=self.path("two"))
        self.assertEqual(tree(self.path("one")), tree(self.path("two")))

    def test_rough_and_eroded_pieces(self):
        manifest, labels = self.broken("--roughness", "1", "--erode-iterations", "1", "--grain", "0,0,1,2")
        self.assertEqual(len(manifest["fragments"]), 9)
        self.assertNotIn("plane", manifest["splits"][0])
        self.assertEqual(manifest["options"]["grow"]["split"], {"power": 1.0, "offset": 0.1, "tilt": 10.0})

    def test_a_fragment_is_split_again(self):
        self.broken()
        again = self.path("again")
        result = self.run_sherd("fracture", os.path.join(self.out, "manifest.json"), "-o", again, "--only", "3", "--pieces", "4", "--growth", "sequential")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(again, "manifest.json")) as file:
            manifest = json.load(file)
        self.assertEqual(len(manifest["fragments"]), 12)
        self.assertEqual(sum(fragment["parent"] == 3 for fragment in manifest["fragments"]), 4)

    def chunks(self, mesh, pieces):
        """The chunks of graph.json, whose volumes add up to those of their parents."""
        out = self.path(f"graph {os.path.basename(mesh)}")
        result = self.run_sherd("fracture", mesh, "-o", out, "--growth", "sequential", "--pieces", str(pieces), "--resolution", "48",
                                "--write", "graph")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(out, "graph.json")) as file:
            chunks = json.load(file)["chunks"]
        volume = [0.0] * len(chunks)
        for chunk in chunks[1:]:
            volume[chunk["parentChunkIndex"]] += chunk["volume"]
        for index, chunk in enumerate(chunks):
            if not chunk["flags"]:
                self.assertAlmostEqual(volume[index] / chunk["volume"], 1.0, places=9)
        return chunks

    def test_the_graph_has_pieces_as_chunks(self):
        chunks = self.chunks(AMPHORA, 7)
        self.assertEqual([chunk["flags"] for chunk in chunks], [0] + [1] * 7 + [0] * 5)  # the first split divides the whole

    def test_the_graph_keeps_a_component_that_is_split(self):
        boxes = self.path("boxes.obj")
        box(boxes, (0, 0, 0), (1, 1, 1))
        box(boxes, (2, 0, 0), (2.2, 0.2, 0.2))
        chunks = self.chunks(boxes, 3)
        self.assertEqual([chunk["flags"] for chunk in chunks], [0, 1, 1, 1, 0])
        self.assertEqual(sorted(chunk["parentChunkIndex"] for chunk in chunks[1:]), [0, 0, 4, 4])

    def test_what_is_refused_and_what_has_no_effect(self):
        seeds = self.path("seeds.json", b"{}")
        self.refused(2, self.run_sherd("fracture", self.ball, "-o", self.out, "--growth", "sequential", "--seeds", seeds),
                     "--seeds", "sequential")
        self.refused(2, self.fracture("--growth", "sequential", "--split-offset", "0.6"), "--split-offset")
        self.refused(2, self.fracture("--growth", "sequential", "--min-share", "0.4"), "3 fragments")
        self.nothing_written()
        for options, word in ((("--sampler", "halton"), "--sampler"), (("--balance", "2"), "--balance")):
            result = self.done("--growth", "sequential", *options, out=self.path(word))
            self.assertIn(f"{word} does nothing", result.stderr)
        for rough in "0", "3":  # which tears pieces apart
            said = set()
            for kept in "keep", "regrow":
                out = self.path(f"{kept}-{rough}")
                result = self.done("--growth", "sequential", "--roughness", rough, "--isolated", kept, "--write", "labels", "--json", pieces=40, out=out)
                self.assertEqual("--isolated does nothing" in result.stderr, rough == "0", result.stderr)
                said.add(pathlib.Path(out, "labels.rle").read_bytes())
            self.assertEqual(len(said), 1 if rough == "0" else 2)
        result = self.done("--split-tilt", "3", out=self.path("tilt"))
        self.assertIn("--split-tilt does nothing", result.stderr)


if __name__ == "__main__":
    skipping.main()
