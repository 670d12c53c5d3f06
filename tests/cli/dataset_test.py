#!/usr/bin/python3
"""Dataset runs end to end: what is written, by readers of this test's own, and what a run that was killed leaves.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy.
"""
import base64
import csv
import fcntl
import hashlib
import html.parser
import io
import json
import os
import random
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
import xml.etree.ElementTree
import zipfile

import numpy as np

import skipping
from cli_test import SHERD, CommandLine, joined, sphere, tree, write_obj, write_stl
from png_file import pixels_of

# What a run leaves that describes the run, and not the dataset.
OF_THE_RUN = ("journal/", "run", "report.html")
SMALL = {"--resolution": "24", "--pieces": "2..4", "--repeats": "3..1", "--points": "32"}


def dataset(folder):
    return {name: sum for name, sum in tree(folder).items() if not name.startswith(OF_THE_RUN)}


def small(arguments):
    """Arguments for a small run, unless they say otherwise."""
    return [a for pair in SMALL.items() if pair[0] not in arguments for a in pair] + list(arguments)


def read_rle(data):
    """The authors' own way: counts, then runs, into an array of x, y, z."""
    nx, ny, nz = np.frombuffer(data, "<u4", 3)
    runs = np.frombuffer(data, np.dtype([("label", "<u2"), ("length", "<u4")]), offset=12)
    return np.repeat(runs["label"], runs["length"]).reshape(nx, ny, nz)


class Page(html.parser.HTMLParser):
    """Tables, pictures and links of a page; which elements are still open."""
    EMPTY = {"meta", "img"}

    def __init__(self):
        super().__init__()
        self.open, self.tables, self.pictures, self.links = [], [], [], []

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag not in self.EMPTY:
            self.open.append(tag)
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][-1].append("")
        elif tag == "img":
            kind, data = attributes.pop("src").split(",", 1)
            assert kind == "data:image/png;base64", kind
            self.pictures.append((attributes["alt"], base64.b64decode(data, validate=True)))
        self.links += [v for k, v in attributes.items() if k in ("src", "href", "srcset", "data")]

    def handle_startendtag(self, tag, attributes):
        self.links += [v for k, v in attributes if k in ("src", "href", "xlink:href")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        if self.open and self.open[-1] in ("td", "th"):
            self.tables[-1][-1][-1] += data


class Dataset(CommandLine):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.library = os.path.join(cls.data, "library")
        os.makedirs(os.path.join(cls.library, "vases", "small"))
        write_obj(os.path.join(cls.library, "ball.obj"), sphere())
        write_stl(os.path.join(cls.library, "vases", "egg.stl"), sphere(center=(5, 0, 0), radius=2))
        write_obj(os.path.join(cls.library, "vases", "small", "two.obj"),
                  joined(sphere(), sphere(center=(1.5, 0, 0), radius=0.8)))

    def dataset(self, *arguments, out=None, library=None, **more):
        return self.run_sherd("dataset", library or self.library, "-o", out or self.out, *small(arguments), **more)

    def done(self, *arguments, **more):
        run = self.dataset(*arguments, **more)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run

    def rows(self, out=None):
        with open(os.path.join(out or self.out, "index.jsonl")) as lines:
            rows = [json.loads(line) for line in lines]
        with open(os.path.join(out or self.out, "index.csv"), newline="") as file:
            table = list(csv.DictReader(file))
        self.assertEqual([(r["object"], r["fracture"], str(r["id"])) for r in rows],
                         [(r["object"], r["fracture"], r["id"]) for r in table])
        self.assertEqual([";".join(r["files"]) for r in rows], [r["files"] for r in table])
        return rows

    def file(self, name):
        with open(os.path.join(self.out, name), "rb") as file:
            return file.read()


class Run(Dataset):
    def test_every_object_is_broken_by_the_schedule(self):
        self.done()
        rows = self.rows()
        names = [f"{n}f_{i}" for n, count in ((2, 3), (3, 2), (4, 1)) for i in range(count)]
        for key in ("ball.obj", "vases/egg.stl", "vases/small/two.obj"):
            own = [r for r in rows if r["object"] == key]
            self.assertEqual(list(dict.fromkeys(r["fracture"] for r in own)), ["whole"] + names)
            for name in names:
                pieces = [r for r in own if r["fracture"] == name]
                self.assertEqual([r["id"] for r in pieces], list(range(1, int(name[0]) + 1)))
                self.assertAlmostEqual(sum(r["share"] for r in pieces), 1)
                labels = read_rle(self.file(pieces[0]["labels"][0]))
                counts = np.bincount(labels.ravel())
                self.assertEqual(list(counts[2:]), [r["voxels"] for r in pieces])
        self.assertEqual(len({r["seed"] for r in rows if r["fracture"] != "whole"}), 18)
        for row in rows:
            self.assertEqual([hashlib.sha256(self.file(f)).hexdigest() for f in row["files"]], row["sha256"])
        listed = {f for r in rows for f in r["files"] + r["labels"]}
        folders = {os.path.dirname(r["labels"][0]) + "/manifest.json" for r in rows if r["fracture"] != "whole"}
        self.assertEqual(listed | folders, {n for n in dataset(self.out) if n.startswith("objects/") and n[-1] != "/"})

    def test_the_papers_schedule(self):
        run = self.dataset("--json", "--resolution", "8", "--pieces", "2..10", "--repeats", "25..15", "--points", "0",
                           "--write", "labels", "--match", "ball*")
        last = json.loads(run.stdout.splitlines()[-1])
        self.assertEqual((last["fractures"], last["fragments"], last["objects"]), (177, 988, 1))
        counts = {}
        for row in self.rows():
            counts.setdefault(row["pieces"], set()).add(row["fracture"])
        self.assertEqual([len(counts[n]) for n in range(2, 11)], [25, 23, 22, 21, 20, 18, 17, 16, 15])

    def test_points_do_not_need_meshes(self):
        """Points, statistics and pictures are the same with and without meshes."""
        bare = os.path.join(self.tmp, "bare")
        for layout in ("sherd", "paper"):
            with self.subTest(layout):
                options = ("--layout", layout, "--match", "ball*", "--points", "100", "--point-format", "npz", "--poses")
                self.done(*options, "--write", "labels,mesh")
                self.done(*options, "--write", "labels", out=bare)
                files, alone = dataset(self.out), dataset(bare)
                meshes = {n for n in files if n.endswith((".ply", ".binm"))}
                self.assertTrue(meshes and not meshes & alone.keys())
                points = {n for n in files if n.endswith(".npz")}
                self.assertEqual({n: files[n] for n in points}, {n: alone[n] for n in alone if n.endswith(".npz")})
                for a, b in zip(self.rows(), self.rows(bare), strict=True):
                    of_sums = ("volume", "contacts", "files", "sha256", "center", "truth_translation")
                    self.assertEqual(*({k: v for k, v in row.items() if k not in of_sums} for row in (a, b)))
                    self.assertAlmostEqual(a["volume"], b["volume"], places=12)
                    np.testing.assert_allclose(a["contacts"], b["contacts"], rtol=1e-9)
                    for place in ("center", "truth_translation"):
                        np.testing.assert_allclose(a[place], b[place], rtol=0, atol=1e-12)
                pictures = [re.findall(r"data:image/png;base64,[^\"]*", open(os.path.join(f, "report.html")).read()) for f in (self.out, bare)]
                self.assertEqual(*pictures)
                self.assertTrue(pictures[0])
                shutil.rmtree(self.out)
                shutil.rmtree(bare)

    def test_a_fracture_of_points_can_be_made_again_alone(self):
        self.done("--match", "ball*", "--write", "labels", "--points", "50")
        row = next(r for r in self.rows() if r["fracture"] == "3f_0")
        alone = os.path.join(self.tmp, "alone")
        again = self.run_sherd("fracture", os.path.join(self.library, "ball.obj"), "-o", alone, "--resolution", "24",
                               "--pieces", "3", "--seed", str(row["seed"]), "--write", "labels", "--points", "50", "--surface", "smooth")
        self.assertEqual(again.returncode, 0, again.stderr)
        folder = os.path.dirname(row["labels"][0])
        self.assertEqual(tree(alone), tree(os.path.join(self.out, folder)))

    def test_a_fracture_can_be_made_again_alone(self):
        self.done("--erode-iterations", "0..2", "--sampler", "uniform|poisson", "--extra-seeds", "2n", "--roughness", "0..1.5")
        drawn = set()
        for row in self.rows():
            if row["id"] != 1 or row["fracture"] == "whole":
                continue
            drawn.add(json.dumps(row["options"]))
            alone = os.path.join(self.tmp, "alone")
            options = [f"--{name}={value}" for name, value in row["options"].items()]
            run = self.run_sherd("fracture", os.path.join(self.library, row["object"]), "-o", alone, "--resolution", "24", "--surface", "smooth",
                                 "--pieces", str(row["pieces"]), "--seed", str(row["seed"]), "--extra-seeds", "2n",
                                 "--points", "32", "--write", "labels,mesh", *options)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(tree(alone), tree(os.path.join(self.out, os.path.dirname(row["labels"][0]))))
            shutil.rmtree(alone)
        self.assertGreater(len(drawn), 6)

    def test_distinct_fractures_and_dropped_fragments(self):
        self.done("--distinct", "0.15", "--drop-share", "0.1", "--match", "ball*", "--pieces", "2", "--repeats", "12",
                  "--write", "labels")
        rows = [r for r in self.rows() if r["fracture"] != "whole"]
        self.assertGreater(max(r["attempt"] for r in rows), 0)
        self.assertTrue(all(r["withheld"] == (r["share"] < 0.1) for r in rows))
        labels = [read_rle(self.file(r["labels"][0])).ravel() for r in rows if r["id"] == 1]
        for i, a in enumerate(labels):
            for b in labels[:i]:
                inside = a > 0
                same = max(np.mean(a[inside] == b[inside]), np.mean(a[inside] == 5 - b[inside]))
                self.assertLessEqual(same, 0.85 + 1e-9)

    def test_poses_lead_back(self):
        self.done("--poses", "--match", "ball*")
        for row in self.rows():
            w, x, y, z = row["rotation"]
            self.assertAlmostEqual(w * w + x * x + y * y + z * z, 1)
            self.assertEqual(row["truth_rotation"], [w, -x, -y, -z])
            self.assertEqual(row["truth_translation"], row["center"])

    def test_options_out_of_files(self):
        self.done("--erode-iterations", "1", "--match", "ball*")
        plain = dataset(self.out)
        toml = self.path("options.toml", b'resolution = 24\npieces = "2..4"\nrepeats = "3..1"\npoints = 32\nerode-iterations = 1\n')
        asked = json.dumps({"resolution": 24, "pieces": "2..4", "repeats": "9..9", "points": 32, "erode-iterations": 1})
        for config, more in ((toml, ()), (self.path("options.json", asked.encode()), ("--repeats", "3..1"))):
            out = self.path("configured")
            run = self.run_sherd("dataset", self.library, "-o", out, "--match", "ball*", "--config", config, *more)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(dataset(out), plain)
            shutil.rmtree(out)

    def test_a_list_of_meshes(self):
        text = "# a comment\nlibrary/vases/egg.stl\n\nlibrary/ball.obj\n"
        listed = os.path.join(self.data, "list.txt")
        with open(listed, "w") as file:
            file.write(text)
        self.done(library=listed)
        self.assertEqual(list(dict.fromkeys(r["object"] for r in self.rows())), ["library/ball.obj", "library/vases/egg.stl"])

    def test_one_mesh(self):
        """It is a library of one, whatever its first lines look like, and not a list of paths."""
        off = self.path("ball.off")
        vertices, triangles = sphere()
        with open(off, "w") as file:
            file.write(f"OFF\n{len(vertices)} {len(triangles)} 0\n")
            file.writelines("%r %r %r\n" % tuple(map(float, v)) for v in vertices)
            file.writelines("3 %d %d %d\n" % tuple(t) for t in triangles)
        self.done(library=off)
        self.assertEqual({r["object"] for r in self.rows()}, {"ball.off"})
        blob = self.path("library.bin", b"\0\1\2\n\0")
        self.refused(3, self.dataset(library=blob, out=self.path("none")), "text file of paths")

    def test_one_number_of_pieces_is_one_fracture(self):
        run = self.run_sherd("dataset", self.library, "-o", self.out, "--resolution", "32", "--pieces", "3", "--write", "labels")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(len({(r["object"], r["fracture"]) for r in self.rows()}), 2 * 3)  # each also whole
        run = self.run_sherd("dataset", self.library, "-o", self.path("two"), "--resolution", "32", "--pieces", "3",
                             "--repeats", "2", "--write", "labels")
        self.assertEqual(len({(r["object"], r["fracture"]) for r in self.rows(self.path("two"))}), 3 * 3)

    def test_strict_is_for_each_object(self):
        library = self.path("some")
        os.makedirs(library)
        shutil.copy(os.path.join(self.library, "ball.obj"), library)
        self.path("some/bad.obj", b"v 0 0 0\n")
        self.done(library=library)
        run = self.dataset("--strict", library=library, out=self.path("strict"))
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("1 object could not be broken", run.stderr.splitlines()[-1])
        self.assertIn("1 object failed: bad.obj", run.stdout)
        self.assertTrue(os.path.exists(os.path.join(self.path("strict"), "index.csv")))

    def test_refusals(self):
        self.refused(3, self.dataset(library=self.path("absent")), "absent")
        self.refused(2, self.dataset("--pieces", "10..2"), "--pieces")
        self.refused(2, self.dataset("--shard", "3/2"), "--shard")
        self.refused(2, self.dataset("--erode-probability", "0..7"), "--erode-probability")
        # What would fail for the objects for which it is drawn; one by one, and together.
        self.refused(2, self.dataset("--sizes", "exponential", "--growth", "euclid|flood"), "--sizes", "--growth flood")
        self.refused(2, self.dataset("--sizes", "exponential", "--growth", "euclid|nearest", "--metric", "euclidean|manhattan"),
                     "--sizes", "--metric")
        self.refused(2, self.dataset("--split", "0/0/0"), "--split")
        self.done("--match", "ball*")
        before = tree(self.out)
        self.refused(2, self.dataset("--match", "ball*"), "; resume it, or replace it (--resume, --replace)\n")
        self.refused(2, self.dataset("--match", "ball*", "--resume", "--balance", "2"), "other options")
        self.assertEqual(tree(self.out), before)
        os.makedirs(self.path("full"))
        self.path("full/file", b"")
        self.refused(5, self.dataset(out=self.path("full")), "not empty")
        # With no option at all.
        self.refused(5, self.run_sherd("dataset", self.library, "-o", self.path("full/file")), "not a directory")


class Layouts(Dataset):
    def test_packed(self):
        self.done("--match", "ball*")
        for compress in ("none", "zip"):
            out = self.path(compress)
            self.done("--match", "ball*", "--layout", "packed", "--compress", compress, out=out)
            with zipfile.ZipFile(os.path.join(out, "objects", "ball.zip")) as archive:
                self.assertIsNone(archive.testzip())
                files = {n: hashlib.sha256(archive.read(n)).hexdigest() for n in archive.namelist()}
                self.assertEqual({i.date_time for i in archive.infolist()}, {(1980, 1, 1, 0, 0, 0)})
            loose = tree(os.path.join(self.out, "objects", "ball"))
            self.assertEqual(files, {n: s for n, s in loose.items() if n[-1] != "/"})
            for row in self.rows(out):
                self.assertEqual([files[f] for f in row["files"]], row["sha256"])

    def test_the_papers(self):
        self.done("--layout", "paper", "--compress", "zip", "--mesh-format", "binm", "--point-format", "binp",
                  "--match", "ball*")
        names = {n for n in dataset(self.out) if n.startswith("ball/") and n[-1] != "/"}
        wanted = {"ball/ball_grid_24r.rle", "ball/ball.binm", "ball/ball_32p.binp"}
        for n, count in ((2, 3), (3, 2), (4, 1)):
            for i in range(count):
                base = f"ball/ball_{n}f_24r_{i}it"
                wanted |= {base + ".rle"} | {f"{base}_{k}{end}" for k in range(n) for end in (".binm", "_32p.binp")}
        self.assertEqual(names, {n + ".zip" for n in wanted})
        for name in names:
            with zipfile.ZipFile(os.path.join(self.out, name)) as archive:
                self.assertEqual(archive.namelist(), [os.path.basename(name)[:-4]])
        whole, broken = (read_rle(self.unzipped(n)) for n in ("ball/ball_grid_24r.rle", "ball/ball_3f_24r_1it.rle"))
        self.assertEqual(whole.shape, (24, 24, 24))
        self.assertEqual(set(np.unique(whole)), {0, 1})
        self.assertEqual(set(np.unique(broken)), {0, 2, 3, 4})
        self.assertTrue(np.array_equal(whole > 0, broken > 0))
        mesh = self.unzipped("ball/ball_3f_24r_1it_2.binm")
        vertices = int(np.frombuffer(mesh, "<u4", 1)[0])
        faces = int(np.frombuffer(mesh, "<u4", 1, 4 + 64 * vertices)[0])
        self.assertEqual(len(mesh), 8 + 64 * vertices + 16 * faces)

    def unzipped(self, name):
        with zipfile.ZipFile(os.path.join(self.out, name + ".zip")) as archive:
            return archive.read(archive.namelist()[0])

    def test_zstd(self):
        self.done("--compress", "zstd", "--match", "ball*", "--write", "labels")
        plain = self.path("plain")
        self.done("--match", "ball*", "--write", "labels", out=plain)
        for row in self.rows():
            name = row["labels"][0]
            self.assertTrue(name.endswith(".rle.zst"))
            unpacked = subprocess.run(["zstd", "-dc", os.path.join(self.out, name)], stdout=subprocess.PIPE, check=True)
            with open(os.path.join(plain, name[:-4]), "rb") as file:
                self.assertEqual(unpacked.stdout, file.read())

    def test_breaking_bad(self):
        """By the rules that its loaders go by."""
        self.done("--layout", "bb", "--split", "1/1/0")
        lines = {}
        for split in "train", "val", "test":
            for subset in "library", "vases":
                text = self.file(f"{subset}.{split}.txt").decode()
                self.assertEqual(text, self.file(f"data_split/{subset}.{split}.txt").decode())
                lines.setdefault(split, []).extend(text.splitlines())
        self.assertEqual(sorted(lines["train"] + lines["val"]), ["library/ball", "vases/egg", "vases/small/two"])
        self.assertEqual(lines["test"], [])
        counted = {}
        for subset in "library", "vases":
            for split in "train", "val":
                for line in self.file(f"data_list/{subset}_{split}.txt").decode().splitlines():
                    counted[line[4:]] = int(line[:3])
        for line in lines["train"] + lines["val"]:
            self.assertGreaterEqual(len(line.split("/")), 2)
            own = os.path.join(self.out, line)
            fractures = [f for f in os.listdir(own) if "fractured" in f or "mode" in f]
            self.assertEqual(sorted(fractures), [f"fractured_{i}" for i in range(6)])
            whole = self.vertices(os.path.join(own, "complete.obj"))
            self.assertAlmostEqual(np.ptp(whole, axis=0).max(), 1, delta=0.01)
            self.assertLess(np.abs(whole.max(0) + whole.min(0)).max(), 0.02)
            for fracture in fractures:
                pieces = os.listdir(os.path.join(own, fracture))
                self.assertEqual(len(pieces), counted[f"{line}/{fracture}"])
                self.assertEqual(sorted(pieces), [f"piece_{i}.obj" for i in range(len(pieces))])
                at = np.concatenate([self.vertices(os.path.join(own, fracture, p)) for p in pieces])
                self.assertLess(np.abs(at.max(0) - whole.max(0)).max(), 0.01)
                for piece in pieces:
                    neighbor = np.load(os.path.join(own, "neighbor", fracture, piece[:-3] + "npy"))
                    self.assertEqual(len(neighbor), self.faces(os.path.join(own, fracture, piece)))
                    self.assertEqual(set(neighbor) - set(range(len(pieces) + 1)), set())

    def test_points_of_breaking_bad_are_in_its_frame(self):
        """On the pieces as their meshes are written, scaled; on flat solids too, whose triangles are merged."""
        library = self.path("frames")
        os.makedirs(os.path.join(library, "all"))
        write_obj(os.path.join(library, "all", "ball.obj"), sphere())
        corners = 7 + 4 * np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 2)], float)
        faces = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
        write_obj(os.path.join(library, "all", "block.obj"), (corners, faces))
        for files in "mesh,points", "points":
            self.out = self.path(f"frames-{files}")
            self.done("--layout", "bb", "--write", files, "--points", "300", "--point-format", "xyz", library=library)
            for name in "ball", "block":
                found = []
                for folder, _, names in os.walk(os.path.join(self.out, "all", name, "points")):
                    found += [np.loadtxt(os.path.join(folder, file)) for file in names if file.startswith("piece_")]
                    for file in names:
                        mesh = os.path.join(folder.replace(os.sep + "points" + os.sep, os.sep), file[:-3] + "obj")
                        if not file.startswith("piece_") or not os.path.exists(mesh):
                            continue
                        at, own = self.vertices(mesh), np.loadtxt(os.path.join(folder, file))[:, :3]
                        self.assertTrue((own >= at.min(0) - 1e-4).all() and (own <= at.max(0) + 1e-4).all(), file)
                self.assertGreater(len(found), 10)
                at = np.concatenate(found)[:, :3]
                self.assertAlmostEqual(np.ptp(at, axis=0).max(), 1, delta=0.1)
                self.assertLess(np.abs(at.max(0) + at.min(0)).max(), 0.1)

    def listed(self, name):
        return self.file(name).decode().splitlines()

    def test_lists_of_fractures_as_rectified_point_flow_reads_them(self):
        """data_split/SPLIT.txt has a line per fracture, a folder whose *.ply are the parts."""
        self.done("--layout", "bb", "--split", "1/1/0", "--mesh-format", "ply")
        objects = {s: sum((self.listed(f"{subset}.{s}.txt") for subset in ("library", "vases")), []) for s in ("train", "val", "test")}
        for split, folders in objects.items():
            fractures = self.listed(f"data_split/{split}.txt")
            self.assertEqual(sorted(fractures), sorted(f"{o}/fractured_{i}" for o in folders for i in range(6)))
            for fracture in fractures:
                names = os.listdir(os.path.join(self.out, fracture))
                self.assertGreaterEqual(len([n for n in names if n.endswith(".ply")]), 2)
        self.assertEqual(sum(map(len, objects.values())), 3)

    def test_lists_that_garf_opens_are_there(self):
        """Its converter opens the lists of two subsets, whatever the dataset holds."""
        self.done("--layout", "bb", "--write", "labels")
        for subset in "everyday", "artifact":
            for split in "train", "val":
                self.assertEqual(self.listed(f"data_split/{subset}.{split}.txt"), [])

    def test_subsets_of_those_names_are_in_their_lists(self):
        library = self.path("named")
        os.makedirs(os.path.join(library, "artifact", "pot"))
        write_obj(os.path.join(library, "artifact", "pot", "a.obj"), sphere())
        self.done("--layout", "bb", "--write", "labels", "--split", "1/0/0", library=library)
        self.assertEqual(self.listed("data_split/artifact.train.txt"), ["artifact/pot/a"])
        self.assertEqual(self.listed("data_split/everyday.train.txt"), [])

    def test_neighbors_of_decimated_meshes(self):
        self.done("--layout", "bb", "--triangles", "60,200", "--match", "ball*")
        own = os.path.join(self.out, "library", "ball")
        for fracture in (f for f in os.listdir(own) if "fractured" in f):
            pieces = os.listdir(os.path.join(own, fracture))
            for most in "60", "200":
                for piece in pieces:
                    faces = self.faces(os.path.join(own, "decimated_" + most, fracture, piece))
                    neighbor = np.load(os.path.join(own, "neighbor", "decimated_" + most, fracture, piece[:-3] + "npy"))
                    self.assertEqual((len(neighbor), neighbor.dtype.str), (faces, "<u2"))
                    self.assertIn(0, neighbor)
                    others = set(range(1, len(pieces) + 1)) - {int(piece[6:-4]) + 1}
                    self.assertTrue(set(neighbor) - {0} and set(neighbor) - {0} <= others)

    def test_shells_have_boxes_of_side_1(self):
        """A shell reaches half of its thickness, some 5 voxels of 24, beyond the mesh."""
        self.done("--layout", "bb", "--fill", "shell", "--shell-thickness", "0.4", "--match", "ball*")
        own = os.path.join(self.out, "library", "ball")
        whole = self.vertices(os.path.join(own, "complete.obj"))
        self.assertAlmostEqual(np.ptp(whole, axis=0).max(), 1, delta=0.01)
        self.assertLess(np.abs(whole.max(0) + whole.min(0)).max(), 0.02)
        pieces = [self.vertices(os.path.join(own, "fractured_0", p)) for p in os.listdir(os.path.join(own, "fractured_0"))]
        self.assertAlmostEqual(np.ptp(np.concatenate(pieces), axis=0).max(), 1, delta=0.01)

    def test_a_split_of_few_objects_is_reported(self):
        words = "of 3 objects split 80/10/10, "
        labels = ("--write", "labels", "--layout")
        cases = ((*labels, "bb"), True), (("--layout", "hdf5"), True), (("--layout", "pfpp"), True), ((*labels, "bb", "--split", "1/0/0"), False), \
            ((*labels, "sherd"), False)
        for arguments, given in cases:
            with self.subTest(arguments):
                shutil.rmtree(self.out, ignore_errors=True)
                run = self.done(*arguments)
                self.assertEqual(words in run.stderr, given, run.stderr)
        shutil.rmtree(self.out)
        for i in "12":
            self.done("--layout", "bb", "--write", "labels", "--shard", i + "/2", "--resume")
        merged = self.run_sherd("merge", self.out)
        self.assertEqual(merged.returncode, 0, merged.stderr)
        self.assertIn(words, merged.stderr)

    def test_lists_that_a_loader_made_before_are_reported(self):
        """Jigsaw keeps the fractures that it found once, and reads no others."""
        made = "all_piece_matching_metadata_2_20_vases.train.txt"
        arguments = ("--layout", "bb", "--write", "labels", "--split", "1/0/0")
        first = self.done(*arguments, "--match", "vases/e*")
        with open(os.path.join(self.out, made), "wb") as file:
            file.write(b"pickled")
        same = self.done(*arguments, "--match", "vases/e*", "--resume")
        more = self.done(*arguments, "--resume")
        self.assertEqual([made in run.stderr for run in (first, same, more)], [False, False, True], more.stderr)
        self.assertEqual(self.file(made), b"pickled")

    def lines(self, path):
        with open(path) as file:
            kinds = [line.split() for line in file]
        self.assertEqual({k[0] for k in kinds}, {"v", "f"})  # one object, no groups, no materials
        return kinds

    def vertices(self, path):
        return np.array([[float(x) for x in k[1:]] for k in self.lines(path) if k[0] == "v"])

    def faces(self, path):
        return sum(k[0] == "f" for k in self.lines(path))


class Trust(Dataset):
    def test_bad_meshes_are_not_the_end(self):
        library = self.path("bad")
        shutil.copytree(self.library, library)
        self.path("bad/empty.obj", b"")
        self.path("bad/text.stl", b"no mesh")
        run = self.done("--write", "labels", library=library)
        with open(os.path.join(self.out, "failures.jsonl")) as lines:
            failed = {line["object"]: line["reason"] for line in map(json.loads, lines)}
        self.assertEqual(set(failed), {"empty.obj", "text.stl"})
        self.assertIn("empty.obj", run.stderr)
        self.assertEqual(len({r["object"] for r in self.rows()}), 3)
        self.assertFalse([n for n in tree(self.out) if "empty" in n and not n.startswith("journal/")])

    def test_an_object_that_takes_too_long_is_given_up(self):
        run = self.dataset("--object-timeout", "0.001")
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("no object", run.stderr)
        with open(os.path.join(self.out, "failures.jsonl")) as lines:
            self.assertEqual(["longer than" in line for line in lines], [True] * 3)
        self.assertEqual(self.rows(), [])

    def resumed(self, *arguments, out, rounds, most):
        """Killed again and again, at random moments."""
        kills = 0
        for _ in range(rounds):
            process = subprocess.Popen([SHERD, "dataset", self.library, "-o", out, *small(arguments), "--resume"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(random.uniform(0.1, most))
            process.send_signal(signal.SIGKILL)
            kills += process.wait() == -signal.SIGKILL
        self.done(*arguments, "--resume", out=out)
        return kills

    def test_what_was_killed_goes_on(self):
        for layout in (), ("--layout", "packed"), ("--layout", "paper", "--compress", "zip"), ("--layout", "bb"), \
                ("--layout", "hdf5"), ("--layout", "pfpp"):
            with self.subTest(layout=layout):
                self.tmp = tempfile.mkdtemp(prefix="sherd-cli-")
                self.addCleanup(shutil.rmtree, self.tmp)
                whole, killed = self.path("whole"), self.path("killed")
                arguments = (*layout, "--distinct", "0.05", "--write", "labels,mesh,vdb")
                begin = time.monotonic()
                self.done(*arguments, out=whole)
                seconds = time.monotonic() - begin
                kills = self.resumed(*arguments, out=killed, rounds=6, most=seconds / 2)
                self.assertGreater(kills, 0)
                self.assertEqual(dataset(killed), dataset(whole))

    def test_temporary_files_of_killed_runs_go(self):
        self.done("--write", "labels", "--layout", "bb")
        before = dataset(self.out)
        left = [".sherd-1-0.tmp", ".sherd-4411-65.tmp", "journal/vases/.sherd-1-3.tmp", "data_split/.sherd-2-2.tmp"]
        others = [".sherd-mine.tmp", "journal/.sherd-1-2-3.tmp"]

        def now():
            """All but what describes the run."""
            found = tree(self.out)
            return [name for name in left if name in found], [name for name in others if name in found]

        for name in left + others:
            with open(os.path.join(self.out, name), "w") as file:
                file.write("half")
        elsewhere = self.path("elsewhere", b"mine")
        link = os.path.join(self.out, ".sherd-1-9.tmp")
        os.symlink(elsewhere, link)
        folder = os.open(self.out, os.O_RDONLY)
        fcntl.flock(folder, fcntl.LOCK_SH)  # another run, to which they may belong
        self.done("--write", "labels", "--layout", "bb", "--resume")
        self.assertEqual(now(), (left, others))
        os.close(folder)
        self.done("--write", "labels", "--layout", "bb", "--resume")
        self.assertEqual(now(), ([], others))
        self.assertTrue(os.path.islink(link))
        os.remove(link)
        os.remove(os.path.join(self.out, ".sherd-mine.tmp"))
        self.assertEqual(dataset(self.out), before)
        # A folder that is no dataset is left alone.
        os.mkdir(self.path("strange"))
        strange = self.path("strange/.sherd-1-1.tmp", b"half")
        self.path("strange/mine", b"mine")
        self.refused(5, self.dataset(out=os.path.dirname(strange)), "no dataset")
        self.assertTrue(os.path.exists(strange))

    def test_a_full_disk_stops_cleanly_and_resumes(self):
        disk = self.path("disk")
        os.makedirs(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", disk], stderr=subprocess.DEVNULL).returncode:
            skipping.skip(self, "MOUNT", "this process may not mount")
        try:
            for layout in "sherd", "packed":
                with self.subTest(layout=layout):
                    self.assertEqual(subprocess.run(["mount", "-o", "remount,size=1m", disk]).returncode, 0)
                    out, whole = os.path.join(disk, "out"), self.path(layout)
                    run = self.dataset("--layout", layout, out=out)
                    self.assertEqual(run.returncode, 5, run.stderr)
                    self.assertIn("no space left", run.stderr)
                    self.assertEqual(subprocess.run(["mount", "-o", "remount,size=100m", disk]).returncode, 0)
                    self.done("--layout", layout, "--resume", out=out)
                    self.done("--layout", layout, out=whole)
                    self.assertEqual(dataset(out), dataset(whole))
                    shutil.rmtree(out)
        finally:
            subprocess.run(["umount", disk])

    def test_verifying_finds_what_was_changed(self):
        for layout in (), ("--layout", "packed"), ("--layout", "paper", "--compress", "zip", "--mesh-format", "binm"), \
                ("--layout", "bb", "--compress", "zstd"):
            with self.subTest(layout=layout):
                out = tempfile.mkdtemp(prefix="sherd-cli-")
                self.addCleanup(shutil.rmtree, out)
                arguments = (*layout, "--match", "ball*", "--verify")
                reported = self.done(*arguments, out=out).stdout
                self.assertRegex(reported, r"all \d+ files are whole\n\Z")
                names = sorted(n for n, _ in tree(out).items() if "ball" in n and "journal" not in n and n[-1] != "/")
                for name in names[0], names[-1]:
                    path = os.path.join(out, name)
                    with open(path, "r+b") as file:
                        data = file.read()
                        file.seek(len(data) // 2)
                        file.write(bytes([data[len(data) // 2] ^ 1]))
                    run = self.dataset(*arguments, "--resume", out=out)
                    self.assertEqual(run.returncode, 3, name)
                    self.assertIn("1 file is not as it was written", run.stderr)
                    with open(path, "wb") as file:
                        file.write(data)
                os.remove(os.path.join(out, names[0]))
                self.assertEqual(self.dataset(*arguments, "--resume", out=out).returncode, 3)

    def test_a_run_tells_what_it_took(self):
        self.done("--match", "ball*")
        self.done("--resume")
        with open(os.path.join(self.out, "run.json")) as file:
            first, second = json.load(file)["runs"]
        self.assertEqual((first["objects"], first["fractures"], second["fractures"]), (1, 6, 12))
        for run in first, second:
            self.assertEqual(set(run["stages"]), {"read", "voxelize", "grow", "extract", "picture", "write", "store"})
            samples = run["samples"]
            self.assertEqual({len(column) for column in samples.values()}, {len(samples["seconds"])})
            self.assertGreater(min(samples["memory"]), 1 << 20)
            self.assertGreaterEqual(run["peak_memory"], max(samples["memory"]))
        size = sum(os.path.getsize(os.path.join(self.out, n)) for n in tree(self.out) if n.startswith("objects/") and n[-1] != "/")
        self.assertEqual(sum(second["bytes"].values()), size)
        self.assertEqual(set(second["bytes"]), {"rle", "ply", "json"})

    def report(self, out=None):
        """The page's tables by id or number, its SVGs and pictures; all that it needs lies in it."""
        with open(os.path.join(out or self.out, "report.html"), encoding="utf-8") as file:
            text = file.read()
        page = Page()
        page.feed(text)
        page.close()
        self.assertEqual(page.open, [])
        self.assertFalse(page.links, "the page is to need nothing else")
        self.assertNotIn("<script", text)
        for svg in re.findall(r"<svg.*?</svg>", text, re.S):
            xml.etree.ElementTree.fromstring(svg)
        return page

    def test_the_report_tells_what_the_index_has(self):
        library = self.path("some")
        shutil.copytree(self.library, library)
        self.path("some/<b>&.obj", b"")
        self.done("--plain-meshes", library=library)
        page = self.report()
        rows = [r for r in self.rows() if r["fracture"] != "whole"]
        size = lambda names: sum(os.path.getsize(os.path.join(self.out, n)) for n in names)
        reported = {row[0]: row[1] for row in page.tables[0]}
        fractures = {(r["object"], r["fracture"]) for r in rows}
        self.assertEqual(reported["Fragments"], str(len(rows)))
        self.assertEqual(reported["Fractures"], str(len(fractures)))
        self.assertEqual(reported["Models"], "3")
        for kind, column, counts in (("Average faces", "faces", rows), ("Average vertices", "vertices", rows)):
            self.assertEqual(reported[kind], f"{np.mean([int(r[column]) for r in counts]):.0f}")
        all_files = {name for r in self.rows() for name in r["files"]}
        points = {name for name in all_files if "points" in name}
        self.assertTrue(reported["Triangle mesh files"].startswith(f"{len(all_files - points)} ("))
        self.assertTrue(reported["Point cloud files"].startswith(f"{len(points)} ("))
        labels = {name for r in self.rows() for name in r["labels"]}
        self.assertTrue(reported["Voxel files"].startswith(f"{len(labels)} ("))

        by_pieces = {row[0]: row[1:] for row in page.tables[1][1:]}
        self.assertEqual(set(by_pieces), {"2", "3", "4"})
        for pieces, (made, fragments, _, below) in by_pieces.items():
            shares = [float(r["share"]) for r in rows if str(r["pieces"]) == pieces]
            self.assertEqual((int(made), int(fragments)),
                             (len({f for f in fractures if f[1].startswith(pieces + "f")}), len(shares)))
            self.assertAlmostEqual(float(below.split()[0]), 100 * np.mean(np.array(shares) < 0.1), delta=0.01)
        formats = {row[0]: (int(row[1]), int(row[2])) for row in page.tables[2][1:]}
        ply = [n for n in tree(self.out) if n.endswith(".ply")]
        self.assertEqual(formats["ply"], (len(ply), size(ply)))
        self.assertEqual([row[0] for row in page.tables[3][1:]], ["<b>&.obj"])

        self.assertEqual(len(page.pictures), 3 * (1 + 3))  # each object, and one fracture of 2, 3 and 4 pieces
        whole = None
        for caption, png in page.pictures:
            pixels = pixels_of(png)
            solid = np.abs(pixels - pixels[0, 0]).max(-1) > 8
            self.assertTrue(0.05 < solid.mean() < 0.9, caption)
            if caption.endswith(", whole"):
                whole = pixels
            else:  # the same thing in several colors
                self.assertGreater((np.abs(pixels - whole).max(-1) > 30)[solid].mean(), 0.05, caption)

    def test_a_forecast_without_a_folder_for_temporary_files(self):
        self.refused(5, self.dataset("--dry-run", env={**os.environ, "TMPDIR": self.path("absent")}), "TMPDIR")

    def test_a_forecast_is_about_right(self):
        reported = json.loads(self.done("--dry-run", "--json").stdout)
        self.assertFalse(os.path.exists(self.out))
        last = json.loads(self.done("--json").stdout.splitlines()[-1])
        self.assertEqual([reported[k] for k in ("objects", "fractures", "fragments")],
                         [last[k] for k in ("objects", "fractures", "fragments")])
        self.assertAlmostEqual(reported["bytes"] / last["bytes"], 1, delta=0.1)  # other fractures of these objects
        self.assertGreater(reported["seconds"], 0)

    def test_shards_give_what_one_run_gives(self):
        self.done()
        for shards in 2, 7:
            out = self.path(f"shards{shards}")
            for i in range(1, shards + 1):
                if i == shards == 2:
                    self.refused(3, self.run_sherd("merge", out), "not done")
                run = self.dataset("--shard", f"{i}/{shards}", *(["--resume"] if i > 1 else []), out=out)
                self.assertEqual(run.returncode, 0, run.stderr)
            merged = self.run_sherd("merge", out)
            self.assertEqual(merged.returncode, 0, merged.stderr)
            self.assertEqual(dataset(out), dataset(self.out))
            self.assertEqual(self.report(out).pictures, self.report().pictures)

    def test_shards_may_begin_together(self):
        arguments = small(("--write", "labels", "--resume"))
        for _ in range(5):
            out = tempfile.mkdtemp(prefix="sherd-cli-")
            self.addCleanup(shutil.rmtree, out)
            shards = [subprocess.Popen([SHERD, "dataset", self.library, "-o", os.path.join(out, "all"), *arguments, "--shard", f"{i}/3"],
                                       stderr=subprocess.PIPE, text=True) for i in (1, 2, 3)]
            for shard in shards:
                _, reported = shard.communicate()
                self.assertEqual(shard.returncode, 0, reported)
            self.assertEqual(self.run_sherd("merge", os.path.join(out, "all")).returncode, 0)

    def test_objects_do_not_share_folders(self):
        library = self.path("nested")
        os.makedirs(os.path.join(library, "ball"))
        for name in "ball.obj", "ball/2f_0.obj", "twin.obj":
            write_obj(os.path.join(library, name), sphere())
        write_stl(os.path.join(library, "twin.stl"), sphere(radius=2))
        self.done("--write", "labels", library=library)
        before = dataset(self.out)
        os.remove(os.path.join(self.out, "journal", "ball.obj.jsonl"))  # and all of it is made again
        self.done("--write", "labels", "--resume", library=library)
        self.assertEqual(dataset(self.out), before)
        self.assertEqual(sorted(os.listdir(os.path.join(self.out, "objects"))), ["ball", "ball.obj", "twin.obj", "twin.stl"])

    def test_more_objects_leave_all_else_as_it_was(self):
        library = self.path("grows")
        shutil.copytree(self.library, library)
        self.done(library=library)
        before = dataset(self.out)
        splits = {r["object"]: r["split"] for r in self.rows()}
        write_obj(os.path.join(library, "more.obj"), sphere(radius=3))
        self.done("--resume", library=library)
        after = dataset(self.out)
        self.assertEqual({n: s for n, s in before.items() if n.startswith("objects/")},
                         {n: s for n, s in after.items() if n.startswith("objects/") and "/more" not in n})
        self.assertEqual(splits, {r["object"]: r["split"] for r in self.rows() if r["object"] != "more.obj"})


class Replacing(Dataset):
    """`--replace`: the old dataset stays until the new one is complete, and others' files stay always."""
    SMALL = "--resolution", "16", "--repeats", "1..1", "--points", "0", "--write", "labels", "--limit", "2"
    NEW = "--pieces", "3..3", "--seed", "5", *SMALL
    TRAINING = "--pieces", "3..3", "--seed", "5", "--resolution", "16", "--repeats", "1..1", "--limit", "2"

    def setUp(self):
        super().setUp()
        self.old = "--pieces", "2..2", *self.SMALL

    def expected(self, *arguments, **more):
        """The dataset that another folder gets by these options."""
        out = self.path("expected")
        self.done(*arguments, out=out, **more)
        found = dataset(out)
        shutil.rmtree(out)
        return found

    def mine(self, names):
        for name in names:
            path = os.path.join(self.out, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w") as file:
                file.write("of " + name)

    def others_are_there(self, names):
        for name in names:
            with open(os.path.join(self.out, name)) as file:
                self.assertEqual(file.read(), "of " + name)

    def test_every_layout_takes_the_place_of_every_other(self):
        layouts = "sherd", "packed", "paper", "bb", "hdf5", "pfpp", "sherd"
        self.done(*self.old)
        for layout in layouts[1:]:
            with self.subTest(layout=layout):
                options = (*self.TRAINING, "--layout", layout)
                run = self.done(*options, "--replace", "--verify")
                self.assertNotIn("is no file of the dataset", run.stderr)
                self.assertEqual(dataset(self.out), self.expected(*options))
                self.assertEqual([n for n in os.listdir(self.out) if n.startswith(".")], [])

    def test_files_of_others_stay(self):
        self.done(*self.old[:-4], "--limit", "2", "--write", "mesh", "--layout", "bb")
        theirs = ["notes.txt", "library/ball/notes.md", "library/ball/fractured_0/mine.obj",
                  "journal/mine.txt", "journal/mine.jsonl", "mine.train.txt", "data_split/mine.txt", "run_mine.json"]
        self.mine(theirs)
        os.symlink("nowhere", os.path.join(self.out, "library", "link"))
        self.done(*self.NEW, "--replace")
        self.others_are_there(theirs)
        os.remove(os.path.join(self.out, "library", "link"))
        found = {n: s for n, s in dataset(self.out).items() if n not in theirs and not n.startswith(("library/", "data_split/"))}
        self.assertEqual(found, self.expected(*self.NEW))
        self.assertEqual(sorted(n for n in tree(self.out) if n.startswith("library/") and not n.endswith("/")),
                         ["library/ball/fractured_0/mine.obj", "library/ball/notes.md"])

    def test_a_file_of_another_at_a_path_of_the_new_dataset_is_kept_beside(self):
        self.done(*self.old)
        self.mine(["objects/ball/3f_0/labels.rle"])
        run = self.done(*self.NEW, "--replace")
        self.assertIn("objects/ball/3f_0/labels.rle: is no file of the dataset, and lies in", run.stderr)
        with open(os.path.join(self.out, "kept/objects/ball/3f_0/labels.rle")) as file:
            self.assertEqual(file.read(), "of objects/ball/3f_0/labels.rle")

    def test_what_is_in_the_way_is_refused_before_any_work(self):
        self.done(*self.old)
        self.mine(["library/mine.txt"])
        before = tree(self.out)
        self.refused(5, self.dataset(*self.NEW, "--layout", "bb", "--replace"), "library", "move it away")
        self.assertEqual(tree(self.out), before)

    def test_what_is_no_dataset_is_refused(self):
        self.mine(["notes.txt"])
        self.refused(5, self.dataset("--replace"), "is not empty and no dataset")
        self.others_are_there(["notes.txt"])
        self.assertEqual(os.listdir(self.out), ["notes.txt"])

    def test_empty_folders_are_filled(self):
        self.done(*self.NEW, "--replace")
        self.assertEqual(dataset(self.out), self.expected(*self.NEW))

    def test_contradicting_and_idle_options(self):
        self.done(*self.old)
        self.refused(2, self.dataset("--replace", "--resume"), "--resume", "--replace")
        self.refused(2, self.dataset(*self.NEW), "--replace")
        run = self.done("--replace", "--dry-run")
        self.assertIn("--replace does nothing with --dry-run", run.stderr)

    def test_a_dataset_stays_where_no_object_can_be_broken(self):
        self.done(*self.old)
        before = dataset(self.out)
        library = self.path("bad")
        os.makedirs(library)
        self.path("bad/a.obj", b"v 0 0 0\n")
        run = self.dataset(*self.NEW, "--replace", library=library)
        self.assertEqual(run.returncode, 3)
        self.assertIn("keeps its dataset", run.stderr)
        self.assertIn("the first, a.obj: ", run.stderr)
        self.assertEqual(dataset(self.out), before)
        self.assertEqual(self.run_sherd("merge", self.out).returncode, 0)  # of the old one
        for i in 1, 2:
            self.done(*self.NEW, "--replace", "--shard", f"{i}/2", library=library)
        self.refused(3, self.run_sherd("merge", self.out), "keeps its dataset")
        self.assertEqual(dataset(self.out), before)
        self.assertEqual(self.run_sherd("merge", self.out).returncode, 0)

    def library_of(self, *names):
        library = self.path("numbered")
        shutil.rmtree(library, ignore_errors=True)
        os.makedirs(library)
        for i, name in enumerate(names):
            os.makedirs(os.path.dirname(os.path.join(library, name)), exist_ok=True)
            write_obj(os.path.join(library, name), sphere(radius=1 + i))
        return library

    def test_strict_keeps_the_old_one_if_any_object_fails(self):
        self.done(*self.old)
        before = dataset(self.out)
        library = self.library_of("o0.obj")
        self.path("numbered/bad.obj", b"v 0 0 0\n")
        new = (*self.NEW, "--replace")
        run = self.dataset(*new, "--strict", library=library)
        self.assertEqual(run.returncode, 3, run.stderr)
        for words in "1 object could not be broken", "keeps its dataset", "--strict":
            self.assertIn(words, run.stderr.splitlines()[-1])
        self.assertEqual({n: s for n, s in dataset(self.out).items() if not n.startswith(".sherd-replacing")}, before)
        with open(os.path.join(self.out, ".sherd-replacing/new/failures.jsonl")) as lines:
            self.assertEqual([json.loads(line)["object"] for line in lines], ["bad.obj"])
        self.done(*new, library=library)
        self.assertEqual(dataset(self.out), self.expected(*self.NEW, library=library))

    def test_a_shard_verifies_the_new_one(self):
        for layout in "sherd", "hdf5":
            with self.subTest(layout=layout):
                self.done(*self.old, out=self.path(layout))
                out = self.path(layout)
                damaged = os.path.join(out, "objects/ball/2f_0/labels.rle")  # of the old one
                with open(damaged, "ab") as file:
                    file.write(b"more")
                new = (*self.TRAINING, "--layout", layout, "--replace", "--verify", "--shard")
                files = 0
                for i in 1, 2:
                    run = self.done(*new, f"{i}/2", out=out)
                    self.assertIn(os.path.join(out, ".sherd-replacing/new") + ": all ", run.stdout)
                    files += int(re.search(r": all (\d+) files are whole", run.stdout)[1])
                run = self.done(*self.TRAINING, "--layout", layout, "--verify", out=self.path(layout + "1"))
                self.assertEqual(files, int(re.search(r": all (\d+) files are whole", run.stdout)[1]))
                inner = os.path.join(out, ".sherd-replacing/new")
                mine = [n for n in tree(inner) if n.endswith((".ply", ".hdf5"))]
                for name in mine:
                    with open(os.path.join(inner, name), "r+b") as file:
                        file.seek(-1, os.SEEK_END)
                        last = file.read(1)
                        file.seek(-1, os.SEEK_END)
                        file.write(bytes([last[0] ^ 1]))
                run = self.dataset(*new, "2/2", out=out)
                self.assertEqual(run.returncode, 3, run.stderr)
                self.assertIn("written", run.stderr.splitlines()[-1])

    def test_what_left_the_library_is_not_in_the_new_one(self):
        """A continued replacement holds what its own plan says, whatever the runs before it made."""
        for layout in "sherd", "packed", "paper", "bb", "hdf5", "pfpp":
            with self.subTest(layout=layout):
                library = self.library_of("o0.obj", "far/o1.obj", "o2.obj", "far/deep/o3.obj")
                options = [a for a in self.TRAINING if a not in ("--limit", "2")] + ["--limit", "9", "--layout", layout]
                out = self.path("of-" + layout)
                self.done(*self.old, out=out)
                for i in 1, 2:
                    self.done(*options, "--replace", "--shard", f"{i}/2", out=out, library=library)
                os.remove(os.path.join(library, "o0.obj"))
                shutil.rmtree(os.path.join(library, "far", "deep"))
                self.done(*options, "--replace", "--verify", out=out, library=library)
                self.assertEqual(dataset(out), self.expected(*options, library=library))
                self.assertEqual(sorted(n for n in tree(out) if n.startswith("journal/") and n.endswith(".jsonl")),
                                 ["journal/far/o1.jsonl", "journal/o2.jsonl"])
                self.assertEqual([n for n in tree(out) if "o0" in n or "o3" in n], [])
                self.assertEqual([n for n in os.listdir(out) if n.startswith("run")], ["run.json"])

    def test_links_beside_lead_where_they_led(self):
        self.done(*self.old)
        new = sorted(n for n in self.expected(*self.TRAINING) if n.startswith("objects/ball/3f_0/") and n.endswith((".ply", ".rle", ".npz")))
        self.mine(["notes.txt", "objects/ball/mine.txt", new[0]])
        outside = self.path("outside.txt", b"of outside")
        targets = [(os.path.join(self.out, n), "of " + n) for n in ("notes.txt", "objects/ball/mine.txt", new[0])]
        targets += [(outside, "of outside")] * 2
        links = [os.path.join(self.out, name) for name in new[1:1 + len(targets)]]
        for i, (link, (target, _)) in enumerate(zip(links, targets, strict=True)):
            os.makedirs(os.path.dirname(link), exist_ok=True)
            relative = ("./" if i == 1 else "") + os.path.relpath(target, os.path.dirname(link))
            os.symlink(target if i == 4 else relative, link)
        self.done(*self.TRAINING, "--replace")
        for link, (target, content) in zip(links, targets, strict=True):
            with self.subTest(target=target), open(os.path.join(self.out, "kept", os.path.relpath(link, self.out))) as file:
                self.assertTrue(os.path.islink(file.name))
                self.assertEqual(file.read(), content)

    def test_shards_replace_when_they_are_merged(self):
        self.done(*self.old)
        before = dataset(self.out)
        for i in 1, 2:
            self.done(*self.NEW, "--replace", "--shard", f"{i}/2")
            now = {n: s for n, s in dataset(self.out).items() if not n.startswith(".sherd-replacing")}
            self.assertEqual(now, before)
        merged = self.run_sherd("merge", self.out)
        self.assertEqual(merged.returncode, 0, merged.stderr)
        self.assertEqual(dataset(self.out), self.expected(*self.NEW))

    def test_two_at_once(self):
        self.done(*self.old)
        os.makedirs(os.path.join(self.out, ".sherd-replacing"))
        held = os.open(os.path.join(self.out, ".sherd-replacing"), os.O_RDONLY)
        fcntl.flock(held, fcntl.LOCK_EX)
        before = tree(self.out)
        self.refused(5, self.dataset(*self.NEW, "--replace"), "another sherd process replaces the dataset")
        self.assertEqual(tree(self.out), before)
        os.close(held)
        self.done(*self.NEW, "--replace")
        self.assertEqual(dataset(self.out), self.expected(*self.NEW))

    def test_the_old_one_is_whole_until_the_new_one_is(self):
        """Killed in the midst of its work: the old one is there, and the same command continues."""
        self.done(*self.old)
        before, whole = dataset(self.out), self.expected(*self.NEW)
        for kill in signal.SIGINT, signal.SIGKILL:
            run = subprocess.Popen([SHERD, "dataset", self.library, "-o", self.out, *small((*self.NEW, "--replace"))],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            journal = os.path.join(self.out, ".sherd-replacing", "new", "journal")
            while run.poll() is None and not os.path.exists(journal):
                time.sleep(0.001)
            run.send_signal(kill)
            _, said = run.communicate()
            now = {n: s for n, s in dataset(self.out).items() if not n.startswith(".sherd-replacing")}
            if run.returncode == 130:
                self.assertIn("keeps its dataset until the new one is complete", said)
            self.assertEqual(now, whole if run.returncode == 0 else before)
        self.done(*self.NEW[:2], "--seed", "6", *self.SMALL, "--replace")  # drops what was begun
        self.assertNotEqual(dataset(self.out), whole)
        self.done(*self.NEW, "--replace")
        self.assertEqual(dataset(self.out), whole)

    def test_a_killed_exchange_is_completed_by_any_run(self):
        """Each state between the renames, made by hand: the next run ends in the new dataset."""
        self.done(*self.NEW)
        whole = dataset(self.out)
        new = self.path("complete")
        shutil.copytree(self.out, new)
        shutil.rmtree(self.out)
        self.done(*self.old, "--layout", "paper")
        self.mine(["ball/notes.txt"])
        old = self.path("before")
        shutil.copytree(self.out, old)
        ours = sorted(set(os.listdir(old)) - {"journal", "dataset.json"}) + ["journal", "dataset.json"]
        theirs = sorted(set(os.listdir(new)) - {"journal", "dataset.json"}) + ["journal", "dataset.json"]
        steps = [("ready", n) for n in range(len(ours) + 1)] + [("placing", n) for n in range(len(theirs) + 1)]
        for stage, moved in steps[::3] + steps[-1:]:
            with self.subTest(stage=stage, moved=moved):
                shutil.rmtree(self.out)
                shutil.copytree(old, self.out)
                aside = os.path.join(self.out, ".sherd-replacing")
                os.makedirs(os.path.join(aside, "old"))
                shutil.copytree(new, os.path.join(aside, stage))
                for name in ours if stage == "placing" else ours[:moved]:
                    os.rename(os.path.join(self.out, name), os.path.join(aside, "old", name))
                for name in theirs[:moved] if stage == "placing" else ():
                    os.rename(os.path.join(aside, stage, name), os.path.join(self.out, name))
                self.done(*self.NEW, "--replace" if moved % 2 else "--resume")
                self.others_are_there(["ball/notes.txt"])
                found = dataset(self.out)
                self.assertEqual({n: s for n, s in found.items() if n not in ("ball/", "ball/notes.txt")}, whole)

    def test_a_kill_while_the_old_one_is_removed_leaves_nothing_of_it(self):
        library = self.path("many")
        os.makedirs(library)
        for i in range(12):
            write_obj(os.path.join(library, f"ball{i}.obj"), sphere(radius=1 + i))
        options = ("--pieces", "2..2", *self.SMALL[:-2])
        self.done(*options, library=library)
        whole = self.expected(*options, "--seed", "7", library=library)
        for seed in ("7", "8", "7"):
            run = subprocess.Popen([SHERD, "dataset", library, "-o", self.out, *small((*options, "--seed", seed, "--replace"))],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            while run.poll() is None and not os.path.exists(os.path.join(self.out, ".sherd-replacing", "old", "journal")):
                pass
            run.kill()
            run.wait()
            self.done(*options, "--seed", seed, "--replace", library=library)
        self.assertEqual(dataset(self.out), whole)

    def test_changed_meshes_are_broken_again(self):
        """A replacement that is continued takes meshes as they are now."""
        library = self.path("changing")
        shutil.copytree(self.library, library)
        self.done(*self.old, library=library)
        self.done(*self.NEW, "--replace", "--shard", "1/1", library=library)
        self.done(*self.NEW, "--replace", "--shard", "1/2", library=library)
        self.done(*self.NEW, "--replace", "--shard", "2/2", library=library)  # complete, not merged
        write_obj(os.path.join(library, "ball.obj"), sphere(radius=3))
        self.done(*self.NEW, "--replace", library=library)
        out = self.path("fresh")
        self.done(*self.NEW, out=out, library=library)
        self.assertEqual(dataset(self.out), dataset(out))

    def test_a_full_disk_keeps_the_old_one(self):
        disk = self.path("disk")
        large = "--resolution", "64", "--repeats", "1..1", "--pieces", "3..3"
        os.makedirs(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", disk], stderr=subprocess.DEVNULL).returncode:
            skipping.skip(self, "MOUNT", "this process may not mount")
        try:
            out = os.path.join(disk, "out")
            self.done(*self.old, out=out)
            before = dataset(out)
            run = self.dataset(*large, "--replace", out=out)
            self.assertEqual(run.returncode, 5, run.stderr)
            self.assertIn("no space left", run.stderr)
            self.assertEqual({n: s for n, s in dataset(out).items() if not n.startswith(".sherd-replacing")}, before)
            self.assertEqual(subprocess.run(["mount", "-o", "remount,size=100m", disk]).returncode, 0)
            self.done(*large, "--replace", out=out)
            self.assertEqual(dataset(out), self.expected(*large))
        finally:
            subprocess.run(["umount", disk])


if __name__ == "__main__":
    skipping.main()
