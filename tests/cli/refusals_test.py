#!/usr/bin/python3
"""Options, sizes, files of options and outputs that cannot be what was meant: each is refused, or warned of, by name.

Environment: SHERD_BIN the program.
"""
import json
import os
import re
import unittest

import numpy as np

import skipping
from cli_test import CommandLine, sphere, tree, write_obj
from dataset_test import Dataset


class Commands(CommandLine):
    def test_an_unknown_one_is_named_with_the_nearest(self):
        self.refused(2, self.run_sherd("frob"), "'frob'", "'fracture'", "'inspect'")
        for wrong, nearest in (("fractur", "'fracture'"), ("datasets", "'dataset'"), ("eval", "'evaluate'"), ("mrege", "'merge'")):
            result = self.run_sherd(wrong, self.ball, "-o", self.out)
            self.refused(2, result, f"'{wrong}'", f"nearest is {nearest} (")

    def test_an_option_without_a_value_does_not_take_the_next(self):
        for option in "--grid=", "--seeds=", "--device=", "--pieces=", "--write=":
            self.refused(2, self.run_sherd("fracture", self.ball, "-o", self.out, option, "--seed", "3"), option)
        self.refused(2, self.run_sherd("dataset", self.data, "-o", self.out, "--match=", "--seed", "3"), "--match=")
        self.nothing_written()


class Sizes(CommandLine):
    def test_good(self):
        for size in ("8G", "1.5G", "0.5 GiB", "700000000", "700000 kB", "1t", "16383P", "18446744073709551615", "900MB", "1000000KIB"):
            self.done("--max-memory", size, "--write", "labels")
        self.refused(2, self.fracture("--max-memory", "1.5M"), "memory")  # a good size, and too little

    def test_bad(self):
        for size in ("-1", "0", "0G", "0.0", "nan", "inf", "1e23", "1e3", "", "G", ".5G", "1.G", "1.5.5G", "1,5G", "8 G B", "8X", "8GG", "8 Gi",
                     "18446744073709551616", "16384P", "99999999999999999999G", "0.5", "+1G", "0x10", "8G\n"):
            with self.subTest(size=size):
                self.refused(2, self.fracture("--max-memory", size), "--max-memory")
        self.nothing_written()


class Outputs(CommandLine):
    def test_a_file_of_a_fracture_is_not_replaced(self):
        self.done("--write", "labels,mesh,preview,vdb", "--voxel-format", "rle,npy")
        os.symlink(self.out, self.path("link"))
        was = tree(self.out)
        mesh = "meshes/ball_001.ply"
        for words, name in ((("evaluate", self.out, "--samples", "20", "--csv"), "manifest.json"),
                            (("evaluate", self.out, "--samples", "20", "--plot"), mesh),
                            (("evaluate", self.out, "--samples", "20", "--csv"), "meshes/../labels.rle"),
                            (("render", self.out, "-o"), "preview.png"),
                            (("render", os.path.join(self.out, mesh), "-o"), "preview.png"),
                            (("convert", os.path.join(self.out, "labels.rle")), "labels.npy"),
                            (("convert", os.path.join(self.out, "labels.npy")), "labels.rle"),
                            (("convert", self.ball), mesh)):
            for folder in self.out, self.path("link"):
                with self.subTest(words=words, name=name):
                    self.refused(2, self.run_sherd(*words, os.path.join(folder, name)), os.path.basename(name), "name another file")
        self.assertEqual(tree(self.out), was)

    def test_what_is_read_is_not_replaced(self):
        for name in "a.obj", "b.obj":
            write_obj(self.path(name), sphere())
        was = tree(self.tmp)
        self.refused(2, self.run_sherd("evaluate", self.tmp, "--samples", "20", "--csv", self.path("b.obj")), "b.obj")
        os.mkdir(self.path("whole"))
        write_obj(self.path("whole/ball.obj"), sphere())
        self.refused(2, self.run_sherd("evaluate", self.tmp, "--mesh", self.path("whole/ball.obj"), "--samples", "20", "--plot",
                                       self.path("whole/ball.obj")), "ball.obj")
        self.assertEqual({n: s for n, s in tree(self.tmp).items() if "whole" not in n}, was)

    def test_other_files_beside_a_fracture_are_written(self):
        self.done("--write", "labels,mesh")
        out = os.path.join(self.out, "meshes", "table.csv")
        result = self.run_sherd("evaluate", self.out, "--samples", "20", "--csv", out)
        self.assertEqual(result.returncode, 0, result.stderr)
        for _ in range(2):
            result = self.run_sherd("convert", os.path.join(self.out, "labels.rle"), os.path.join(self.out, "again.npy"))
            self.assertEqual(result.returncode, 0, result.stderr)


class Together(CommandLine):
    CONFLICTS = ((("--shell-thickness", "0.1", "--fill", "parity"), "--shell-thickness"),
                 (("--shell-thickness", "0.1", "--fill", "flood"), "--shell-thickness"),
                 (("--bodies", "keep", "--fill", "parity"), "--bodies"), (("--bodies", "keep", "--shell-thickness", "0.1"), "--bodies"),
                 (("--grid", "surface"), "--grid"), (("--isovalue", "0.2"), "--isovalue"),
                 (("--points", "5", "--point-sampler", "poisson", "--point-rule", "per-triangle"), "--point-rule"),
                 (("--guide", "x.obj"), "--guide"), (("--density-attribute", "x", "--sampler", "poisson"), "--density-attribute"),
                 (("--density-attribute", "x", "--balance", "1"), "--density-attribute"),
                 (("--density-attribute", "x", "--sizes", "uniform"), "--density-attribute"))
    IDLE = (("--metric", "manhattan"), ("--metric", "chebyshev", "--growth", "flood"), ("--neighborhood", "26"), ("--merge-metric", "manhattan"),
            ("--merge-metric", "manhattan", "--impact", "0,0,1"), ("--size-spread", "1"),
            ("--erode-shape", "cross"), ("--erode-size", "5"), ("--erode-planes",), ("--erode-threshold", "0.5"), ("--erode-probability", "0.5"),
            ("--erode-on", "all"), ("--erode-islands", "keep"), ("--interface", "independent", "--surface", "labels"),
            ("--smooth-weight", "0.5"), ("--smooth-boundary-weight", "0.5", "--smooth-iterations", "2"), ("--triangles", "500"), ("--mesh-format", "obj"),
            ("--interface", "independent", "--surface", "exact"),
            ("--precision", "double"), ("--precision", "double", "--write", "mesh", "--mesh-format", "glb"),
            ("--plain-meshes",), ("--plain-meshes", "--write", "mesh", "--mesh-format", "stl"), ("--voxel-format", "npy", "--write", "mesh"),
            ("--vdb", "single"), ("--half",), ("--compress", "zip"), ("--density", "2"), ("--proxy-gap", "0.1"),
            ("--usd-format", "usdz"), ("--usd-volumes",), ("--usd-volumes", "--write", "usd"), ("--joint-strength", "2"),
            ("--write", "labels,fog"), ("--write", "labels,solid"), ("--share-points", "--points", "0"), ("--point-sampler", "halton", "--points", "0"),
            ("--sdf-type", "float16", "--sdf-samples", "0"))
    BUSY = (("--shell-thickness", "0.3"), ("--shell-thickness", "0.3", "--fill", "shell"), ("--metric", "manhattan", "--growth", "nearest"),
            ("--neighborhood", "26", "--growth", "flood"), ("--merge-metric", "manhattan", "--extra-seeds", "2n"), ("--size-spread", "1", "--extra-seeds", "2n"),
            ("--merge-metric", "manhattan", "--impact", "0,0,1,2,merge"), ("--erode-size", "5", "--erode-iterations", "1"),
            ("--interface", "independent"), ("--smooth-weight", "0.5", "--smooth-iterations", "0.1k"), ("--triangles", "500", "--write", "mesh"),
            ("--plain-meshes", "--write", "mesh", "--mesh-format", "glb,stl"), ("--plain-meshes", "--write", "scene"), ("--plain-meshes", "--write", "usd"), ("--plain-meshes", "--write", "mesh,houdini", "--mesh-format", "stl"), ("--half", "--write", "vdb"), ("--compress", "zip", "--write", "vdb,fog,solid"),
            ("--precision", "double", "--write", "mesh"),
            ("--density", "2", "--write", "graph"), ("--proxy-gap", "0.1", "--write", "proxy"), ("--up", "z"), ("--unit", "cm"), ("--up", "x", "--write", "usd"),
            ("--usd-volumes", "--joint-strength", "2", "--unit", "2", "--write", "usd,vdb"),
            ("--joint-strength", "2", "--write", "graph"), ("--joint-strength", "2", "--write", "houdini"), ("--joint-strength", "2", "--write", "scene"),
            ("--points", "5", "--point-sampler", "halton"), ("--preset", "paper"), ("--preset", "training"),
            ("--preset", "paper", "--neighborhood", "26"))

    def test_what_contradicts_is_refused(self):
        for options, name in self.CONFLICTS:
            with self.subTest(options):
                self.refused(2, self.fracture(*options), name)
                self.nothing_written()
        self.done("--write", "seeds,labels,vdb")
        seeds = os.path.join(self.out, "seeds.json")
        for options in (("--sampler", "halton"), ("--seeds-on", "surface"), ("--extra-seeds", "2"), ("--impacts", "1"), ("--impact", "0,0,1")):
            result = self.run_sherd("fracture", self.ball, "-o", self.path("more"), "--seeds", seeds, "--resolution", "32", *options)
            self.refused(2, result, options[0], "--seeds")
        volume = os.path.join(self.out, "fragments", "ball_001.vdb")
        result = self.run_sherd("fracture", volume, "-o", self.path("more"), "--pieces", "2", "--split-objects")
        self.refused(2, result, "--split-objects")
        result = self.run_sherd("fracture", volume, "-o", self.path("more"), "--pieces", "2", "--fill", "parity", "--grid", "surface")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("warning: --fill", result.stderr)
        for options, count in ((), 0), (("--isovalue", "0.2"), 1):
            result = self.run_sherd("fracture", volume, "-o", self.path("more"), "--pieces", "2", *options)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(result.stderr.count("warning: --isovalue does nothing"), count, result.stderr)

    def test_convert_warns_of_what_does_nothing(self):
        voxels, points = self.path("a.npz"), self.path("a.xyz", b"0 0 0 0 0 1\n")
        np.savez(voxels, labels=np.ones((2, 3, 4), np.uint16))
        place = ("--voxel-size", "0.5", "--origin", "1,2,3")
        for source, end, options, idle in (
                (self.ball, "ply", ("--pad", "cube"), ["--pad"]), (self.ball, "stl", place, ["--voxel-size"]),
                (self.ball, "obj", ("--ascii",), ["--ascii"]), (self.ball, "stl", ("--ascii",), []),
                (points, "npz", ("--pad", "cube", *place, "--ascii"), ["--pad", "--voxel-size", "--ascii"]),
                (voxels, "npz", ("--pad", "cube", *place), []), (voxels, "rle", ("--ascii",), ["--ascii"])):
            with self.subTest(source=source, end=end, options=options):
                done = self.run_sherd("convert", source, self.path("out." + end), *options)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(re.findall(r"(?m)^sherd: warning: (--\S+).* (?:does|do) nothing", done.stderr), idle)

    def test_what_does_nothing_is_warned_of_by_name(self):
        for options in self.IDLE:
            with self.subTest(options):
                more = () if "--write" in options else ("--write", "labels")
                result = self.done(*options, *more)
                warnings = [line for line in result.stderr.splitlines() if line.startswith("sherd: warning: --")]
                self.assertEqual(len(warnings), 1, result.stderr)
                self.assertRegex(warnings[0], f"warning: {options[0].replace('--compress', '--vdb-compress')} .*(does nothing|do nothing)")

    def test_what_does_something_is_not(self):
        for options in self.BUSY:
            with self.subTest(options):
                more = () if "--write" in options else ("--write", "labels")
                self.assertNotIn("does nothing", self.done(*options, *more).stderr)


class Flags(CommandLine):
    def test_an_error_ends_with_those_of_its_options(self):
        flat = self.path("flat.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        for options, mesh, status, end in (
                (("--pieces", "60000", "--resolution", "8"), self.ball, 2, "; try a higher resolution (--resolution)"),
                (("--pieces", "60000", "--resolution", "8", "--seeds-on", "surface"), self.ball, 2,
                 "; try a higher resolution or seeds in the volume (--resolution, --seeds-on)"),
                (("--impact", "0,0,1,9", "--pieces", "3"), self.ball, 2, "; try more pieces, or let the impacts merge (--pieces)"),
                (("--smooth-weight", "0.9", "--smooth-iterations", "2"), self.ball, 2, "; more needs Laplacian smoothing (--smoothing)"),
                (("--fill", "winding"), flat, 3, "; try a higher resolution (--resolution)")):
            with self.subTest(options):
                result = self.run_sherd("fracture", mesh, "-o", self.out, *options)
                self.refused(status, result, end + "\n")
                self.assertEqual(result.stderr.count("--"), end.count("--"), result.stderr)
        self.nothing_written()


class OfDatasets(Dataset):
    def run_with(self, text, *arguments, name="options.toml", **more):
        config = self.path(name, text.encode())
        return self.dataset("--match", "ball*", "--config", config, *arguments, **more)

    def test_options_that_do_nothing(self):
        quick = ("--pieces", "2", "--repeats", "1")
        for i, (options, name) in enumerate(((("--metric", "manhattan"), "--metric"), (("--metric", "manhattan|chebyshev"), "--metric"),
                                             (("--metric", "manhattan", "--growth", "nearest|euclid"), None),
                                             (("--erode-size", "3|5", "--erode-iterations", "0..1"), None),
                                             (("--erode-probability", "0..1"), "--erode-probability"), (("--up", "z"), None),
                                             (("--layout", "packed", "--compress", "zstd"), "--compress"), (("--mesh-format", "obj"), "--mesh-format"),
                                             (("--dry-run", "--verify"), "--verify"))):
            with self.subTest(options):
                reported = self.done("--match", "ball*", "--write", "labels", "--points", "0", *quick, *options, out=self.path(f"some{i}")).stderr
                if name:
                    self.assertIn(f"warning: {name} ", reported)
                else:
                    self.assertNotIn("warning", reported)
        self.refused(2, self.dataset("--fill", "parity", "--shell-thickness", "1"), "--shell-thickness")

    def test_files_of_options_are_read_strictly(self):
        bad = (("pieces = \nseed = 3\n", ":1: pieces has no value"), ("seed = 3\n\npieces =", ":3: pieces has no value"),
               ("pieces = # 2..4\n", ":1: pieces has no value"), ('match = ""\n', ":1: match has no value"), ("match = ''\n", ":1: match has no value"),
               ("write = []\n", ":1: write has an empty list"), ('write = ["labels", ""]\n', ":1: write has no value"),
               ("seed = 1\n# again\nseed = 2\n", ":3: seed is set twice"), ("seed = 1\npoints = 2\nseed = 1\n", "options.toml:1"),
               ("peices = 3\n", ":1: peices is not an option"), ("peices = 3\n", "'pieces'"), ("frobnicate = 1\n", "frobnicate"),
               ("pieces = true\n", ":1: pieces takes a value"), ("pieces = false\n", ":1: pieces takes a value"), ("poses = 3\n", ":1: poses is true or false"),
               ('poses = "true"\n', ":1: poses is true or false"), ("verify\n", ":1: is not NAME = VALUE"), ("= 3\n", ":1: is not NAME = VALUE"),
               ("sampler = poisson\n", "quotes"), ("pieces = 2..4\n", "quotes"), ("pieces = \"2..4\n", ":1: has text without"),
               ("pieces = '2..4\"\n", ":1: has text without"), ("seed = 1 2\n", ":1: has more than one value"), ("write = [\"labels\" \"mesh\"]\n", "commas"),
               ("write = [\"labels\",\n\n", "closing ]"), ("match = \"a\\qb\"\n", ":1: has a '\\'"), ('match = """a"""\n', "several lines"),
               ("distinct = nan\n", "neither a number"), ("a = {b = 1}\n", "neither a number"), ("write = [[1]]\n", ":1:"), ("config = \"x.toml\"\n", "config is not an option"),
               ("plan = \"x\"\n", "plan is not an option"), ("help = true\n", "help is not an option"), ("seed = 1979-05-27\n", "neither a number"))
        for text, words in bad:
            with self.subTest(text):
                self.refused(3, self.run_with(text), words, "options.toml")
        for text, words in (("{", "JSON"), ("[]", "object"), ('{"pieces": null}', "pieces"), ('{"pieces": ""}', "empty value for pieces"),
                            ('{"write": []}', "empty value for write"), ('{"pieces": {"a": 1}}', "pieces"), ('{"seed": 1, "seed": 2}', "seed twice"),
                            ('{"peices": 2}', "'pieces'"), ('{"poses": 1}', "poses"), ('{"pieces": true}', "pieces"), ('{"write": [true]}', "write"),
                            ("[" * 5000, "JSON")):
            with self.subTest(text):
                self.refused(3, self.run_with(text, name="options.json"), words, "options.json")
        self.nothing_written()

    def test_good_files_are_what_the_command_line_would_be(self):
        text = ('# what\r\n[shape]\r\n"pieces" = "2..3"   # a range\nrepeats = \'1\'\n  resolution=24\nseed = 1_000\nposes = true\nverify = false\n'
                'write = [ "labels",  # first\n\n "vdb", ]\ngrain = [1, 0, 0, -0.5]\nimpact = ["0,0,1,1,merge", "0,1,0,1,merge"]\nerode-probability = "0.5"\n'
                'erode-iterations = 1\nmatch = "ball#*"\noutput = "elsewhere"\nbalance = +2')
        self.path("library/ball#1.obj") and os.mkdir(self.path("library"))
        write_obj(self.path("library/ball#1.obj"), sphere())
        write_obj(self.path("library/ball.obj"), sphere())
        run = self.run_sherd("dataset", self.path("library"), "-o", self.out, "--config", self.path("options.toml", text.encode()))
        self.assertEqual(run.returncode, 0, run.stderr)
        with open(os.path.join(self.out, "dataset.json")) as file:
            plan = json.load(file)
        self.assertEqual([o["key"] for o in plan["objects"]], ["ball#1.obj"])
        self.assertEqual(plan["options"], "--balance=2 --erode-iterations=1 --erode-probability=0.5 --grain=1,0,0,-0.5 --impact=0,0,1,1,merge "
                         "--impact=0,1,0,1,merge --pieces=2..3 --poses --repeats=1 --resolution=24 --seed=1000 --write=labels,vdb")


if __name__ == "__main__":
    skipping.main()
