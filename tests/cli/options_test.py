#!/usr/bin/python3
"""Every group of `sherd fracture`'s options: what it does, what the manifest says of it, and what is refused.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy, python3-openvdb and python3-scipy.
"""
import json
import math
import os
import shutil
import subprocess
import unittest

import numpy as np
import pyopenvdb as vdb
from scipy import ndimage

import skipping
from cli_test import CommandLine, joined, sphere, tree, write_obj
from documents_test import helped

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")


def read_rle(file):
    with open(file, "rb") as opened:
        data = opened.read()
    runs = np.frombuffer(data, np.dtype([("label", "<u2"), ("run", "<u4")]), offset=12)
    return np.repeat(runs["label"], runs["run"]).reshape(np.frombuffer(data, "<u4", 3))


class Options(CommandLine):
    def broken(self, *options, pieces=12, **more):
        """The manifest of the ball in 12 pieces, after a look at labels.rle: the fragments fill the solid."""
        out = more.get("out", self.out)
        self.done("--write", "labels,seeds", *options, pieces=pieces, **more)
        with open(os.path.join(out, "manifest.json")) as file:
            manifest = json.load(file)
        runs = np.fromfile(os.path.join(out, "labels.rle"), np.dtype([("label", "<u2"), ("run", "<u4")]), offset=12)
        fragments, grid = manifest["fragments"], manifest["grid"]
        self.assertEqual(len(fragments) + len(manifest["withheld"]), pieces)
        counts = np.bincount(runs["label"], runs["run"], len(fragments) + 2).astype(int)
        self.assertEqual(list(counts[2:]), [f["voxels"] for f in fragments])
        self.assertEqual(counts[1], grid["eroded_voxels"])
        self.assertEqual(counts[1:].sum(), grid["solid_voxels"])
        self.assertGreater(min(counts[2:]), 0)
        return manifest

    def labels(self, *options, **more):
        self.broken(*options, **more)
        with open(os.path.join(self.out, "labels.rle"), "rb") as file:
            return file.read()

    @staticmethod
    def seeds(manifest):
        return [seed for fragment in manifest["fragments"] for seed in fragment["seeds"]]


class Seeds(Options):
    def test_samplers_and_places(self):
        seen = set()
        for sampler in ("uniform", "halton", "gaussian", "poisson"):
            for place in ("volume", "surface", "wall"):
                with self.subTest(sampler=sampler, place=place):
                    manifest = self.broken("--sampler", sampler, "--seeds-on", place)
                    self.assertEqual(manifest["options"]["seeds"]["sampler"], sampler)
                    self.assertEqual(manifest["options"]["seeds"]["on"], place)
                    seen.add(json.dumps(self.seeds(manifest)))
                    if place == "surface":  # a voxel is 1/16, and its diagonal 0.11
                        self.assertGreater(min(math.dist(s, (0, 0, 0)) for s in self.seeds(manifest)), 1 - 0.11)
        self.assertEqual(len(seen), 8)  # a ball has no wall

    def test_extra_seeds(self):
        for text, extra, each, seeds in (("30", 30, 0, 42), ("2n", 0, 2, 36), ("0", 0, 0, 12)):
            for metric in ("euclidean", "chebyshev", "manhattan"):
                manifest = self.broken("--extra-seeds", text, "--merge-metric", metric)
                reported = manifest["options"]["seeds"]
                self.assertEqual((reported["extra"], reported["extra_per_piece"], reported["merge_metric"]), (extra, each, metric))
                self.assertEqual(len(self.seeds(manifest)), seeds)

    def test_size_spread(self):
        """The largest share of eight fractures on average: with few seeds of its own a fragment stays small."""
        largest = []
        for spread in "0", "2":
            shares = [max(f["share"] for f in self.broken("--extra-seeds", "8n", "--size-spread", spread, "--seed", str(seed))["fragments"])
                      for seed in range(8)]
            largest.append(np.mean(shares))
        self.assertGreater(largest[1], 1.5 * largest[0])
        self.assertEqual(self.broken("--extra-seeds", "8n", "--size-spread", "1.5")["options"]["seeds"]["size_spread"], 1.5)
        self.assertNotIn("size_spread", self.broken("--extra-seeds", "8n")["options"]["seeds"])

    def test_impacts_scatter_seeds_where_they_strike(self):
        for impact in ("1,0,0,6,0.1", "1.05,0,0,6,0.1", "ray:9,0,0,-2,0,0,6,0.1"):
            manifest = self.broken("--impact", impact)
            near = [s for s in self.seeds(manifest) if math.dist(s, (1, 0, 0)) < 0.45]
            self.assertGreaterEqual(len(near), 6)
            self.assertEqual(len(self.seeds(manifest)), 12)
            reported = manifest["options"]["seeds"]["impacts"]
            self.assertEqual([(i["count"], i["sigma"], i["merge"]) for i in reported], [(6, 0.1, False)])

    def test_a_point_far_from_the_surface_is_refused_with_its_distance(self):
        for point, apart in (("9,0,0", "8"), ("0,0,0", "0.99"), ("0,1.2,0", "0.2")):
            result = self.fracture("--impact", f"{point},6,0.1", pieces=12)
            self.refused(2, result, f"is {apart}", "of the surface")

    def test_an_impact_may_have_all_pieces(self):
        for count in ("11", "12"):
            manifest = self.broken("--impact", f"1,0,0,{count},0.1")
            self.assertEqual(len(self.seeds(manifest)), 12)
        self.refused(2, self.fracture("--impact", "1,0,0,13,0.1", pieces=12), "13 pieces")

    def test_impacts_that_merge_make_no_fragments(self):
        manifest = self.broken("--impact", "1,0,0,6,n=9,merge", "--impact", "0,0,1,3,merge")
        self.assertEqual(len(self.seeds(manifest)), 12 + 9)
        self.assertEqual([i["bias"] for i in manifest["options"]["seeds"]["impacts"]], [9, 5])

    def test_impacts_with_an_energy(self):
        """On a shell the seeds lie in its middle, in rings about the point."""
        shell = self.path("shell.obj")
        inner = sphere(radius=0.85)
        write_obj(shell, joined(sphere(), (inner[0], [f[::-1] for f in inner[1]])))
        manifest = self.broken("--impact", "0,0,1,energy=1", mesh=shell, pieces=40)
        self.assertEqual([(i["count"], i["energy"], i["merge"]) for i in manifest["options"]["seeds"]["impacts"]], [(0, 1, False)])
        middle = [s for s in self.seeds(manifest) if abs(math.dist(s, (0, 0, 0)) - 0.925) < 0.02]
        self.assertGreaterEqual(len(middle), 24)
        self.assertGreater(np.mean([s[2] for s in middle]), 0.5)
        self.assertEqual(len(self.seeds(self.broken("--impact", "0,0,1,5,0.4,energy=2.5,merge"))), 12 + 5)

    def test_random_impacts(self):
        manifest = self.broken("--impacts", "3")
        self.assertEqual(manifest["options"]["seeds"]["random_impacts"], 3)
        self.assertEqual(len(self.seeds(manifest)), 12)

    def grown_again(self, seeds, name, *options, mesh=None):
        """The labels of a file of seeds, and the options of the manifest."""
        again = self.path(name)
        result = self.run_sherd("fracture", mesh or self.ball, "-o", again, "--resolution", "32", "--seeds", seeds, *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(again, "labels.rle"), "rb") as file:
            return file.read(), self.manifest(again)["options"]

    def test_seeds_of_a_file_grow_the_same_again(self):
        first = self.labels("--extra-seeds", "2n", pieces=5)
        labels, options = self.grown_again(os.path.join(self.out, "seeds.json"), "again")
        self.assertEqual(labels, first)
        self.assertEqual((options["pieces"], options["seeds"]), (5, {"file": "seeds.json", "on": "volume"}))

    def test_seeds_of_a_file_grow_the_same_again_in_walls(self):
        """A hollow ball, whose seeds lie in the middle of its wall, and voxels are compared there."""
        shell = self.path("shell.obj")
        outer, inner = sphere(16, 24), sphere(16, 24, radius=0.8)
        write_obj(shell, (outer[0] + inner[0], outer[1] + [tuple(v + len(outer[0]) for v in reversed(f)) for f in inner[1]]))
        self.done("--write", "labels,seeds", mesh=shell, pieces=9)
        with open(os.path.join(self.out, "labels.rle"), "rb") as file:
            first = file.read()
        seeds = os.path.join(self.out, "seeds.json")
        labels, options = self.grown_again(seeds, "again", mesh=shell)
        self.assertEqual(labels, first)
        self.assertEqual(options["seeds"]["on"], "wall")
        self.assertEqual(self.grown_again(seeds, "wall", "--seeds-on", "wall", mesh=shell)[0], first)
        self.assertNotEqual(self.grown_again(seeds, "volume", "--seeds-on", "volume", mesh=shell)[0], first)

    def test_hostile_files_of_seeds(self):
        def listed(*seeds):
            return json.dumps({"schema": "sherd-seeds/1", "seeds": [{"fragment": f, "position": p} for f, p in seeds]})

        two = self.path("two.obj")
        write_obj(two, joined(sphere(), sphere(center=(4, 0, 0))))
        files = {
            "empty": "", "nul": "\0" * 100, "text": "seeds", "number": "7", "list": "[]", "object": "{}",
            "null": "null", "deep": "[" * 100000, "cut": listed((1, [0, 0, 0]))[:-1],
            "more": listed((1, [0, 0, 0])) + "x",
            "other schema": '{"schema": "sherd-seeds/9", "seeds": []}',
            "no object": '{"schema": "sherd-seeds/1", "seeds": [7]}',
            "seeds no list": '{"schema": "sherd-seeds/1", "seeds": 7}',
            "fragment 0": listed((0, [0, 0, 0])), "fragment -1": listed((-1, [0, 0, 0])),
            "fragment 65535": listed((65535, [0, 0, 0])), "fragment 1.5": listed((1.5, [0, 0, 0])),
            "fragment as text": listed(("1", [0, 0, 0])), "a huge fragment": listed((10**30, [0, 0, 0])),
            "a gap": listed((1, [0, 0, 0]), (3, [0.5, 0, 0])), "two numbers": listed((1, [0, 0])),
            "four numbers": listed((1, [0, 0, 0, 0])), "text in it": listed((1, [0, 0, "0"])),
            "nan": listed((1, [0, 0, math.nan])), "infinite": listed((1, [0, 0, 0])).replace("0]", "1e999]"),
            "far": listed((1, [1e300, 0, 0])), "outside": listed((1, [1.5, 0, 0])),
            "one id in two parts": listed((1, [0, 0, 0]), (1, [4, 0, 0])),
        }
        for name, text in files.items():
            with self.subTest(name):
                path = self.path(name + ".json", text.encode())
                result = self.run_sherd("fracture", two, "-o", self.out, "--resolution", "40", "--seeds", path)
                self.refused(3, result, path)
                self.nothing_written()
        for path in (self.path("absent.json"), self.tmp):
            self.refused(3, self.run_sherd("fracture", two, "-o", self.out, "--seeds", path), path)


class Growth(Options):
    def test_growths(self):
        seen = set()
        for growth, more, reported in (("flood", (), {"neighborhood": 6}),
                                   ("flood", ("--neighborhood", "26"), {"neighborhood": 26}),
                                   ("nearest", ("--metric", "manhattan"), {"metric": "manhattan"}),
                                   ("chain", ("--metric", "chebyshev"), {"metric": "chebyshev"}), ("euclid", (), {})):
            options = self.broken("--growth", growth, *more)["options"]["grow"]
            self.assertEqual(options, {"growth": growth, "roughness": 0, "hurst": 0.8, "roughness_window": 0, "outer_steps": 6,
                                       "isolated": "regrow", **reported})
            seen.add(tree(self.out)["labels.rle"])
        self.assertEqual(len(seen), 5)

    def test_grain_makes_splinters_along_it_and_plates_across_it(self):
        def longer(*options):  # mean extent along z, of that along x
            boxes = [f["bbox"] for f in self.broken("--write", "mesh", *options, pieces=40)["fragments"]]
            return np.divide(*(sum(b["max"][i] - b["min"][i] for b in boxes) for i in (2, 0)))

        plain, splinters, plates = longer(), longer("--grain", "0,0,2,4"), longer("--grain", "0,0,1,-0.7")
        self.assertLess(abs(math.log(plain)), 0.2)
        self.assertGreater(splinters, 1.5)
        self.assertLess(plates, 1 / 1.5)

    def test_a_depth_below_half_a_voxel_gives_a_warning(self):
        """The ball has 32 voxels."""
        for depth, warnings, eroded in (("1%", 1, False), ("2%", 0, True)):
            result = self.done("--erode-iterations", depth)
            self.assertEqual(result.stderr.count("nothing was eroded"), warnings, result.stderr)
            with open(os.path.join(self.out, "manifest.json")) as file:
                self.assertEqual(json.load(file)["grid"]["eroded_voxels"] > 0, eroded)

    def test_roughness_makes_cracks_larger(self):
        def cracks(*options):
            return sum(f["fracture_area"] for f in self.broken(*options, pieces=3)["fragments"])

        self.assertLess(1.1 * cracks(), cracks("--roughness", "1"))
        self.assertLess(1.1 * cracks(), cracks("--roughness", "1,0.3"))

    def test_isolated_voxels_are_regrown_or_kept(self):
        many = ("--growth", "nearest", "--extra-seeds", "20n")
        freed = [json.loads(self.done("--json", "--isolated", what, *many).stdout)["disconnected_voxels"]
                 for what in ("regrow", "keep")]
        self.assertGreater(sum(freed[0]), 0)
        self.assertEqual(freed[1], [])
        self.assertNotEqual(self.labels(*many), self.labels("--isolated", "keep", *many))

    def test_sizes(self):
        for text in "uniform", "lognormal:0.5", "power:1.5", "exponential":
            manifest = self.broken("--sizes", text)
            self.assertEqual(manifest["options"]["sizes"], text)
            shares = sorted(f["share"] for f in manifest["fragments"])
            if text == "uniform":
                self.assertLess(shares[-1] - shares[0], 2 * 0.0201 / 12)
            self.assertLess(manifest["size_error"], 0.0201 + 8 / manifest["grid"]["solid_voxels"] / shares[0])
        self.assertNotIn("sizes", self.broken("--sizes", "grown")["options"])
        for growth in ("flood",), ("chain",), ("nearest", "--metric", "manhattan"):
            self.refused(2, self.fracture("--sizes", "uniform", "--growth", *growth), "--sizes", "--growth euclid")

    def test_least_share_and_balance(self):
        plain, fair = self.broken(), self.broken("--balance", "10")
        self.assertGreater(fair["effective_number"], plain["effective_number"])
        self.assertLess(min(f["share"] for f in plain["fragments"]), 0.05)
        large = self.broken("--min-share", "0.05")
        self.assertGreaterEqual(min(f["share"] for f in large["fragments"]), 0.05)
        self.assertEqual((large["options"]["min_share"], fair["options"]["balance"]), (0.05, 10))

    def test_small_fragments_are_dropped_and_told(self):
        plain = self.broken("--erode-iterations", "1")
        least = sorted(f["share"] for f in plain["fragments"])[5] + 1e-6
        dropped = self.broken("--erode-iterations", "1", "--drop-share", str(least), "--missing", "2")
        self.assertEqual(len(dropped["withheld"]), 8)
        self.assertEqual([f["id"] for f in dropped["fragments"] + dropped["withheld"]], list(range(1, 13)))
        small = [f for f in plain["fragments"] if f["share"] < least]
        kept = [f for f in plain["fragments"] if f["share"] >= least]
        for before, after in zip(kept + small, dropped["fragments"] + dropped["withheld"]):
            for name in "voxels", "eroded_voxels", "seeds":
                self.assertEqual(before[name], after[name])
        self.refused(2, self.fracture("--drop-share", "0.9"), "too small")

    def test_missing_fragments_are_told_and_not_written(self):
        for text in ("3", "0.25"):
            manifest = self.broken("--missing", text, "--write", "labels,mesh,vdb")
            self.assertEqual([f["id"] for f in manifest["fragments"]], list(range(1, 10)))
            self.assertEqual([f["id"] for f in manifest["withheld"]], [10, 11, 12])
            self.assertEqual({f: len([n for n in tree(self.out) if n.startswith(f) and not n.endswith("/")])
                              for f in ("meshes", "fragments")}, {"meshes": 9, "fragments": 9})
        self.assertEqual(len(self.broken("--missing", "0.01")["withheld"]), 0)

    def test_a_warning_says_where_a_kept_fragment_has_no_neighbor(self):
        for rule, alone in (("neighbors", False), ("any", True)):
            said = 0
            for seed in range(12):
                shutil.rmtree(self.out, ignore_errors=True)
                result = self.fracture("--missing", "10", "--missing-rule", rule, "--seed", str(seed), "--write", "labels", pieces=12)
                self.assertEqual(result.returncode, 0, result.stderr)
                with open(os.path.join(self.out, "manifest.json")) as file:
                    manifest = json.load(file)
                kept = {f["id"] for f in manifest["fragments"]}
                lonely = sum(not kept & {c["id"] for c in f["contacts"]} for f in manifest["fragments"])
                self.assertEqual("only missing ones" in result.stderr, lonely > 0, result.stderr)
                said += lonely > 0
            self.assertEqual(said > 0, alone)
        shutil.rmtree(self.out)
        self.assertIn("--missing-rule does nothing", self.fracture("--missing-rule", "any").stderr)


class Erosion(Options):
    def worn(self, *options, iterations="2"):
        manifest = self.broken("--erode-iterations", iterations, *options)
        self.assertEqual(manifest["grid"]["eroded_voxels"], sum(f["eroded_voxels"] for f in manifest["fragments"]))
        return manifest["grid"]["eroded_voxels"], manifest["options"]["erode"]

    def test_none_unless_asked(self):
        worn, reported = self.worn("--erode-size", "5", iterations="0")
        self.assertEqual((worn, reported), (0, {"iterations": 0}))

    def test_shapes(self):
        plain = {"iterations": 2, "shape": "ellipse", "size": 3, "planes": False, "threshold": 1, "probability": 1,
                 "on": "fracture", "islands": "erode"}
        worn, reported = self.worn()
        self.assertEqual(reported, plain)
        self.assertGreater(worn, 0)
        for option, name, value, sign in (("--erode-shape", "shape", "square", 1),
                                          ("--erode-shape", "shape", "cross", 0),
                                          ("--erode-size", "size", 5, None), ("--erode-planes", "planes", True, None),
                                          ("--erode-threshold", "threshold", 0.7, -1),
                                          ("--erode-probability", "probability", 0.5, -1),
                                          ("--erode-on", "on", "all", 1), ("--erode-islands", "islands", "keep", None)):
            with self.subTest(option):
                other, reported = self.worn(option, *([] if value is True else [str(value)]))
                self.assertEqual(reported, {**plain, name: value})
                if sign is not None:
                    self.assertEqual(np.sign(other - worn), sign)

    def test_the_most_there_is_leaves_every_fragment_a_voxel(self):
        worn, _ = self.worn("--erode-size", "13", "--erode-shape", "square", "--erode-on", "all", iterations="1000")
        self.assertGreater(worn, 0)

    def test_with_missing_fragments(self):
        """Worn and withheld voxels are both of no fragment in labels.rle."""
        self.broken("--erode-iterations", "1", "--missing", "4")


class Again(Options):
    def test_fragments_are_broken_again_and_the_others_stay(self):
        first = os.path.join(self.data, "first")
        self.done("--write", "labels,vdb", pieces=5, out=first)
        manifest = os.path.join(first, "manifest.json")
        result = self.run_sherd("fracture", "--only", "2,4", manifest, "-o", self.out, "--pieces", "3",
                                "--write", "labels,vdb")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(manifest) as file:
            before = {f["id"]: f for f in json.load(file)["fragments"]}
        with open(os.path.join(self.out, "manifest.json")) as file:
            after = json.load(file)["fragments"]
        self.assertEqual([f["id"] for f in after], list(range(1, 10)))
        self.assertEqual(sorted(f["parent"] for f in after), [1, 2, 2, 2, 3, 4, 4, 4, 5])
        for parent, old in before.items():
            pieces = [f for f in after if f["parent"] == parent]
            self.assertEqual(sum(f["voxels"] for f in pieces), old["voxels"])
            volume = sum(f["volume"] for f in pieces)
            # A tenth of a voxel more or less along a rim, and for new cuts all over them, of pieces 10 voxels wide.
            self.assertLess(abs(volume / old["volume"] - 1), 0.01 if len(pieces) == 1 else 0.03)

    def test_in_a_box_of_more_than_2_31_voxels(self):
        """Two cubes at its ends: labels are read from their runs, in the memory that the cubes take."""
        two, first = os.path.join(self.data, "two.obj"), os.path.join(self.data, "first")
        with open(two, "w") as file:
            for at in 0, 69:
                file.writelines(f"v {at + x} {at + y} {at + z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
            file.writelines(f"f {' '.join(str(int(i) + first) for i in face)}\n" for first in (0, 8)
                            for face in ("1342", "5687", "1265", "3784", "1573", "2486"))
        result = self.run_sherd("fracture", two, "-o", first, "--pieces", "2", "--resolution", "1400", "--write", "labels,vdb")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(os.path.join(first, "labels.rle"), "rb") as file:
            sides = np.frombuffer(file.read(12), "<u4").astype(int)
        self.assertGreater(sides.prod(), 2**31)
        words = [os.environ["SHERD_BIN"], "fracture", os.path.join(first, "manifest.json"), "--only", "2", "-o", self.out, "--pieces", "3", "--write", "labels"]
        run = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        said = run.stderr.read()
        run.stderr.close()
        _, status, used = os.wait4(run.pid, 0)
        run.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(run.returncode, 0, said)
        self.assertLess(used.ru_maxrss, 500_000)  # kB; the box alone has 5 GB of labels
        with open(os.path.join(self.out, "manifest.json")) as file:
            self.assertEqual(sorted(f["parent"] for f in json.load(file)["fragments"]), [1, 2, 2, 2])

    def test_islands_of_an_erosion_are_no_fragments(self):
        """Components under 27 voxels are dropped, as of a solid that is broken the first time."""
        first = os.path.join(self.data, "first")
        for surface in ("smooth", "exact"):
            with self.subTest(surface):
                self.done("--write", "labels,vdb,mesh", "--erode-iterations", "2", "--erode-islands", "keep", "--growth", "sequential",
                          "--surface", surface, pieces=8, out=first)
                with open(os.path.join(first, "manifest.json")) as file:
                    before = json.load(file)
                all_ids = ",".join(str(f["id"]) for f in before["fragments"])
                result = self.run_sherd("fracture", "--only", all_ids, os.path.join(first, "manifest.json"), "-o", self.out, "--pieces", "1",
                                        "--write", "labels,mesh", "--surface", surface)
                self.assertEqual(result.returncode, 0, result.stderr)
                with open(os.path.join(self.out, "manifest.json")) as file:
                    after = json.load(file)
                parts = {}  # voxels of the connected components of each fragment
                labels = read_rle(os.path.join(first, "labels.rle"))
                for fragment in before["fragments"]:
                    found, count = ndimage.label(labels == fragment["id"] + 1)
                    parts[fragment["id"]] = sorted(np.bincount(found.ravel())[1:].tolist(), reverse=True)
                small = [n for own in parts.values() for n in own[1:] if n < 27]
                self.assertGreater(len(small), 0)
                self.assertEqual(after["small_components"], {"count": len(small), "voxels": sum(small)})
                expected = sorted((id, n) for id, own in parts.items() for k, n in enumerate(own) if k == 0 or n >= 27)
                self.assertEqual(sorted((f["parent"], f["voxels"]) for f in after["fragments"]), expected)
                h = after["grid"]["voxel_size"]
                for fragment in after["fragments"]:
                    # A surface may sit half a voxel off.
                    self.assertLess(abs(fragment["volume"] - fragment["voxels"] * h**3), 0.5 * h * fragment["area"])
                    self.assertEqual(fragment["contacts"], [])  # an erosion parts all

    def test_edges_and_planes_are_those_of_the_meshes(self):
        """A rotated cube: eight corners times a matrix of orthogonal columns."""
        cube, first = os.path.join(self.data, "cube.obj"), os.path.join(self.data, "first")
        turned = np.array([[2, -2, 1], [1, 2, 2], [2, 1, -2]]) / 3.0
        corners = [turned @ [x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        with open(cube, "w") as file:
            file.writelines("v {} {} {}\n".format(*corner) for corner in corners)
            file.writelines(f"f {face}\n" for face in ("1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"))
        result = self.run_sherd("fracture", cube, "-o", first, "--pieces", "4", "--resolution", "32", "--write", "labels,vdb,mesh")
        self.assertEqual(result.returncode, 0, result.stderr)
        again = lambda: self.run_sherd("fracture", os.path.join(first, "manifest.json"), "--only", "2", "-o", self.out, "--pieces", "3", "--write", "mesh")

        def measured():
            result = self.run_sherd("evaluate", self.out, "--mesh", cube, "--json")
            self.assertEqual(result.returncode, 0, result.stderr)
            found = json.loads(result.stdout)
            return found["surface_error"]["voxels"]["mean"], found["quality"]["triangles"]

        result = again()
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        sharp, few = measured()
        os.remove(os.path.join(first, "meshes", "cube_003.ply"))
        result = again()
        self.assertEqual(result.returncode, 0)
        self.assertIn("cube_003.ply", result.stderr)
        self.assertIn("edges are rounded", result.stderr)
        rounded, many = measured()
        self.assertLess(sharp, 0.25 * rounded)
        self.assertLess(few, 0.3 * many)

    def test_voxel_faces_are_not_taken_for_edges(self):
        """A ball has none: broken again its surface is as smooth after voxel faces as after a smooth surface."""
        errors = []
        for surface in "smooth", "labels":
            first = os.path.join(self.data, surface)
            self.done("--write", "labels,vdb,mesh", "--surface", surface, pieces=4, out=first)
            result = self.run_sherd("fracture", os.path.join(first, "manifest.json"), "--only", "2", "-o", self.out, "--pieces", "2", "--write", "mesh",
                                    "--surface", "smooth")
            self.assertEqual(result.returncode, 0, result.stderr)
            result = self.run_sherd("evaluate", self.out, "--mesh", self.ball, "--json")
            errors.append(json.loads(result.stdout)["surface_error"]["voxels"]["mean"])
        self.assertLess(errors[1], 2 * errors[0])

    def test_what_is_no_finished_fracture_is_refused(self):
        self.done("--write", "vdb", pieces=2)
        manifest = os.path.join(self.out, "manifest.json")
        again = os.path.join(self.data, "again")
        run = lambda *arguments: self.run_sherd("fracture", *arguments, "-o", again)
        self.refused(3, run(manifest, "--only", "1"), "neither meshes nor .vdb files")
        self.refused(3, run(self.ball, "--only", "1"), "manifest")
        self.done("--write", "labels,vdb", pieces=2)
        self.refused(2, run(manifest, "--only", "3"), "fragment 3")
        self.refused(2, run(manifest, "--only", "1", "--resolution", "64"), "--resolution")
        self.refused(2, run(manifest, "--only", "1", "--write", "labels,cost"), "arrival costs", "--write")
        self.assertFalse(os.path.exists(again))


class WrongValues(Options):
    def test_one_sentence_and_status_2(self):
        wrong = {
            "--sampler": ("Uniform", "", "0"), "--seeds-on": ("edge",), "--merge-metric": ("cosine",),
            "--extra-seeds": ("", "-1", "n", "2m", "1.5n", "+2", "1001n", "99999999999n", "10000001"),
            "--impact": ("", "1,2", "1,2,x", "1,2,nan", "0,0,0,0", "0,0,0,1.5", "0,0,0,2,-1", "0,0,0,2,n=0",
                         "0,0,0,2,n=1001", "0,0,0,2,0.1,merge,merge", "0,0,0,merge,2", "ray:0,0,0", "ray:", "0,0,0,",
                         "0,0,0,energy=", "0,0,0,energy=0", "0,0,0,energy=101", "0,0,0,energy=-1", "0,0,0,energy=nan", "energy=1",
                         "0,0,0,4,n=9,energy=1", "0,0,0,energy=1,4", "0,0,0,energy=1,energy=1", "0,0,0,Energy=1"),
            "--sizes": ("", "even", "Uniform", "uniform:1", "uniform:", "lognormal", "lognormal:", "lognormal:0", "lognormal:4", "lognormal:nan",
                        "lognormal:0.8,1", "power", "power:0.9", "power:5", "power:-1", "exponential:1"),
            "--impacts": ("-1", "10001", "1.5"),
            "--growth": ("voronoi", "3"), "--neighborhood": ("18", "x"), "--metric": ("l2",),
            "--grain": ("", "1,0,0", "0,0,0,1", "1,0,0,10", "1,0,0,-0.8", "1,0,nan,1"),
            "--roughness": ("", "-1", "101", "1,2", "1,0", "1,0.8,-3", "1,0.8,3,4", "1,,3", "x", "%", "-1%", "101%", "1%%", "1,0.8%"),
            "--propagation": ("", "1,0,0", "0,0,0,0.6", "1,0,0,0", "1,0,0,1.1", "1,0,0,0.05", "1,0,nan,0.6", "1,0,0,0.6,1", "None"),
            "--material": ("", "Stone", "granite", "ceramic,stone"),
            "--isolated": ("maybe",), "--min-share": ("-0.1", "1.1", "x", "nan"), "--balance": ("-1", "101", "2.5"),
            "--missing": ("", "-1", "1.5", "all", "1e9"),
            "--erode-iterations": ("-1", "1001", "1.5"), "--erode-shape": ("circle",),
            "--erode-size": ("1", "4", "15", "x"), "--erode-threshold": ("-1", "0", "1.1", "nan"),
            "--erode-probability": ("-1", "1.1", "x"),
            "--erode-on": ("edges",), "--erode-islands": ("kept",),
        }
        for option, texts in wrong.items():
            for text in texts:
                with self.subTest(option=option, text=text):
                    self.refused(2, self.fracture(option + "=" + text), option)
                    self.nothing_written()

    def test_what_cannot_be_done_on_this_solid(self):
        for options, word in ((("--impacts", "13"), "--pieces"), (("--impact", "1,0,0,13"), "--pieces"),
                              (("--impact", "ray:9,9,9,1,0,0"), "misses"),
                              (("--impact", "ray:9,0,0,0,0,0"), "direction"),
                              (("--impact", "1,0,0,60000,merge"), "further seeds"),
                              (("--extra-seeds", "100000"), "voxels"),
                              (("--extra-seeds", "17000", "--seeds-on", "surface"), "surface voxels"),
                              (("--min-share", "0.09"), "9 %"), (("--min-share", "0.0833"), "--balance"),
                              (("--missing", "12"), "11"), (("--missing", "0.99"), "11")):
            with self.subTest(options):
                self.refused(2, self.fracture(*options, pieces=12), word)
                self.nothing_written()

    def test_a_list_does_not_swallow_the_mesh(self):
        result = self.run_sherd("fracture", "--write", "labels", self.ball, "-o", self.out, "--resolution", "32")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_seeds_of_a_file_and_pieces_exclude_each_other(self):
        self.refused(2, self.fracture("--seeds", "x.json"), "--pieces", "--seeds")


# Of each option of `sherd fracture`: arguments beside which it matters, and two values that make two fractures.
MATTERS = {
    "--preset": ((), None, "paper"), "--pieces": ((), "3", "4"), "--seed": ((), "0", "1"), "--resolution": ((), "24", "25"),
    "--voxel-size": ((), "0.1", "0.11"), "--only": ((), "1", "2"), "--split-objects": ((), None, ()),
    "--write": ((), "labels", "labels,seeds"), "--voxel-format": ((), "rle", "npz"), "--mesh-format": (("--write", "mesh"), "ply", "obj"),
    "--plain-meshes": (("--write", "mesh"), None, ()), "--precision": (("--write", "mesh"), "single", "double"),
    "--source-faces": (("--write", "mesh"), None, ()), "--up": (("--write", "preview"), "y", "z"),
    "--fill": ((), "winding", "parity"), "--shell-thickness": (("--fill", "shell"), "0.3", "0.4"), "--bodies": ((), "unite", "keep"), "--recenter": ((), None, ()),
    "--grid": ((), "surface_1", "surface_2"), "--isovalue": ((), "0.4", "0.6"),
    "--sampler": ((), "uniform", "halton"), "--seeds-on": ((), "volume", "surface"), "--extra-seeds": ((), "0", "1n"),
    "--merge-metric": (("--extra-seeds", "5"), "euclidean", "manhattan"), "--size-spread": (("--extra-seeds", "5"), "0", "2"),
    "--impact": ((), "1,0,0,1", "0,1,0,1"), "--impacts": ((), "0", "1"),
    "--density-attribute": ((), "wear", "red"), "--guide": (("--growth", "sequential"), "one.obj", "other.obj"),
    "--seeds": ((), None, "seeds.json"), "--growth": ((), "euclid", "flood"), "--neighborhood": (("--growth", "flood"), "6", "26"),
    "--metric": (("--growth", "nearest"), "euclidean", "manhattan"), "--grain": ((), "0,0,1,2", "0,0,1,3"), "--roughness": ((), "1", "3%,0.5"),
    "--split-power": (("--growth", "sequential"), "1", "3"), "--split-offset": (("--growth", "sequential"), "0.1", "0.2"),
    "--split-tilt": (("--growth", "sequential"), "10", "30"),
    "--material": ((), "stone", "wood"), "--propagation": (("--roughness", "2"), "0,0,1,0.4", "1,0,0,0.4"),
    "--sizes": ((), "uniform", "power:1.6"), "--isolated": ((), "regrow", "keep"), "--min-share": ((), "0", "0.01"), "--balance": ((), "0", "1"), "--drop-share": ((), "0", "0.01"),
    "--missing": ((), "0", "1"), "--missing-rule": (("--missing", "1"), "neighbors", "any"), "--erode-iterations": ((), "0", "1"),
    "--surface": ((), "smooth", "labels"), "--interface": ((), "shared", "independent"), "--adaptivity": ((), "0", "0.5"),
    "--mismatch": (("--write", "mesh"), "0.1%", "0.2%,0.5,10%"), "--scan-noise": (("--write", "mesh"), "0.1%", "0.2%"),
    "--mismatch-common": (("--mismatch", "0.1%", "--write", "mesh"), "0", "0.5"),
    "--smoothing": (("--smooth-iterations", "2"), "taubin", "laplacian"), "--smooth-iterations": ((), "1", "2"),
    "--smooth-weight": (("--smooth-iterations", "2"), "0.3", "0.4"), "--smooth-boundary-iterations": ((), "1", "2"),
    "--smooth-boundary-weight": (("--smooth-boundary-iterations", "2"), "0.3", "0.4"), "--triangles": (("--write", "mesh"), "200", "300"),
    "--points": ((), "5", "6"), "--share-points": (("--points", "9"), None, ()), "--point-sampler": (("--points", "5"), "uniform", "halton"),
    "--point-rule": (("--points", "5"), "area", "per-triangle"), "--point-format": (("--points", "5"), "ply", "xyz"),
    "--correspondences": ((), "5", "6"), "--sdf-samples": ((), "5", "6"), "--sdf-type": (("--sdf-samples", "5"), "float32", "float16"),
    "--vdb": (("--write", "vdb"), "files", "single"), "--half": (("--write", "vdb"), None, ()), "--compress": (("--write", "vdb"), "blosc", "zip"),
    "--vdb-compress": (("--write", "vdb"), "blosc", "none"), "--density": (("--write", "graph"), "1", "2"),
    "--proxy-gap": (("--write", "proxy"), "0", "0.1"), "--usd-format": (("--write", "usd"), "usda", "usdz"),
    "--usd-volumes": (("--write", "usd,vdb"), None, ()), "--joint-strength": (("--write", "usd"), "1", "2"),
    "--unit": (("--write", "usd"), "m", "0.01"),
    **{f"--erode-{name}": (("--erode-iterations", "1"), one, other) for name, one, other in (
        ("shape", "cross", "square"), ("size", "3", "5"), ("planes", None, ()), ("threshold", "1", "0.9"), ("probability", "1", "0.9"),
        ("on", "fracture", "all"), ("islands", "erode", "keep"))},
}

# Where the fracture goes, how it is made, and what is printed: nothing that is written follows from these.
DOES_NOT_MATTER = {"--output": None, "--config": None, "--device": "cpu", "--threads": "1", "--max-memory": "9G", "--json": (), "--quiet": (),
                   "--progress": ()}


class EveryOption(CommandLine):
    """Whatever shapes a fracture is in its manifest.  An option that is added to the program has to be added above."""

    def files(self, name, *arguments, mesh=None):
        """What `sherd fracture` writes with these arguments."""
        out = self.path(name)
        sizes = () if {"--resolution", "--voxel-size", "--only"} & set(arguments) else ("--resolution", "24")
        pieces = () if {"--pieces", "--seeds"} & set(arguments) else ("--pieces", "3")
        write = () if "--write" in arguments else ("--write", "labels")
        result = self.run_sherd("fracture", mesh or self.ball, "-o", out, *sizes, *pieces, *write, *arguments)
        self.assertEqual(result.returncode, 0, (arguments, result.stderr))
        self.addCleanup(shutil.rmtree, out)
        return tree(out)

    def inputs(self):
        """Arguments and the file to break, of options that need another than the ball."""
        two = self.path("two.obj")
        with open(two, "w") as out:
            for i, name in enumerate("ab"):
                vertices, triangles = sphere(12, 24, center=(3.0 * i, 0, 0))
                out.write(f"o {name}\n" + "".join(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in vertices))
                out.writelines("f " + " ".join(str(v + 1 + i * len(vertices)) for v in t) + "\n" for t in triangles)
        self.done("--write", "labels,vdb,seeds,fog", out=self.path("first"))
        self.done("--vdb", "single", "--write", "vdb", out=self.path("single"))
        grid = [g for g in vdb.readAll(self.path("first/fragments/ball_001.vdb"))[0] if g.name == "density"]
        vdb.write(self.path("fog.vdb"), grid)
        shutil.copy(self.path("first/seeds.json"), self.path("seeds.json"))
        for name, z in ("one", 0.1), ("other", 0.3):
            self.path(name + ".obj", f"v 1 0 {z}\nv 0 1 {z}\nl 1 2\n".encode())
        vertices, triangles = sphere(12, 24)
        with open(self.path("valued.ply"), "w") as out:
            out.write(f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
                      f"property float wear\nproperty uchar red\nelement face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
            out.writelines(f"{x:.9g} {y:.9g} {z:.9g} {2 + x:.9g} {round(100 + 99 * y)}\n" for x, y, z in vertices)
            out.writelines("3 {} {} {}\n".format(*t) for t in triangles)
        return {"--only": self.path("first/manifest.json"), "--density-attribute": self.path("valued.ply"),
                "--split-objects": two, "--grid": self.path("single/fragments.vdb"),
                "--isovalue": self.path("fog.vdb")}

    @staticmethod
    def manifests_of(files):
        return {name: checksum for name, checksum in files.items() if name.endswith("manifest.json")}

    def test_what_matters_is_in_the_manifest(self):
        names = set(helped("fracture"))
        self.assertEqual(names, set(MATTERS) | set(DOES_NOT_MATTER))
        inputs = self.inputs()
        for name, (beside, one, other) in MATTERS.items():
            def with_value(value):
                value = self.path(value) if name in ("--seeds", "--guide") and value else value
                return () if value is None else (name,) if value == () else (name, value)
            with self.subTest(option=name):
                first = self.files("one" + name, *beside, *with_value(one), mesh=inputs.get(name))
                second = self.files("other" + name, *beside, *with_value(other), mesh=inputs.get(name))
                self.assertNotEqual(first, second)
                self.assertNotEqual(self.manifests_of(first), self.manifests_of(second))

    def test_what_does_not_matter_changes_nothing(self):
        plain = self.files("plain", "--write", "labels,vdb,mesh,preview")
        for name, value in DOES_NOT_MATTER.items():
            if value is not None:
                with self.subTest(option=name):
                    arguments = (name,) if value == () else (name, value)
                    self.assertEqual(self.files("with" + name, "--write", "labels,vdb,mesh,preview", *arguments), plain)


class SameBytes(Options):
    def test_whatever_runs_them(self):
        """A few sets of options that use everything, on a real vessel, with 1, 2 and 5 threads of PoCL and of the host."""
        sets = (("--sampler", "poisson", "--extra-seeds", "3n", "--impacts", "2", "--roughness", "1",
                 "--grain", "1,2,0.5,3", "--erode-iterations", "2", "--erode-probability", "0.5", "--missing", "2"),
                ("--growth", "chain", "--sampler", "halton", "--seeds-on", "surface", "--balance", "2",
                 "--min-share", "0.001"),
                ("--growth", "flood", "--neighborhood", "26", "--sampler", "gaussian", "--grain", "0,0,1,-0.5",
                 "--erode-iterations", "1", "--erode-on", "all", "--erode-shape", "square", "--erode-islands", "keep"),
                ("--growth", "nearest", "--metric", "chebyshev", "--impact", "ray:9,0.3,0,-1,0,0,4,n=20,merge",
                 "--isolated", "keep"))
        for options in sets:
            trees = []
            for i, threads in enumerate(("1", "2", "5")):
                out = self.path(f"out{i}")
                result = self.run_sherd("fracture", AMPHORA, "-o", out, "--resolution", "64", "--pieces", "20",
                                        "--write", "labels,vdb,mesh,seeds,cost", "--threads", threads, *options,
                                        env={**os.environ, "POCL_MAX_PTHREAD_COUNT": threads})
                self.assertEqual(result.returncode, 0, result.stderr)
                trees.append(tree(out))
            with self.subTest(options):
                self.assertGreater(len(trees[0]), 20)
                self.assertEqual(trees[0], trees[1])
                self.assertEqual(trees[1], trees[2])


if __name__ == "__main__":
    skipping.main()
