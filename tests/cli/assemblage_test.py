#!/usr/bin/python3
"""Assemblages: fragments of several objects, mixed.  NumPy puts them back together and compares them with the objects' own fractures.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy.
"""
import json
import os
import shutil
import signal
import subprocess
import time
import unittest

import numpy as np

import skipping
from cli_test import SHERD, CommandLine, joined, sphere, tree, write_obj
from dataset_test import dataset

RESOLUTION = 24
MESHES = 8


def torus(tube, rows=36, columns=18):
    a, b = np.meshgrid(2 * np.pi * np.arange(rows) / rows, 2 * np.pi * np.arange(columns) / columns, indexing="ij")
    ring = 1 + tube * np.cos(b)
    vertices = np.stack([ring * np.cos(a), ring * np.sin(a), tube * np.sin(b)], -1).reshape(-1, 3)
    i = np.arange(rows * columns).reshape(rows, columns)
    right, up, both = np.roll(i, -1, 0), np.roll(i, -1, 1), np.roll(i, (-1, -1), (0, 1))
    return vertices, np.concatenate([np.stack([i, right, both], -1).reshape(-1, 3), np.stack([i, both, up], -1).reshape(-1, 3)])


def read_ply(path):
    """Vertices, triangles and neighbors of a mesh that the program wrote."""
    types = {"float": "<f4", "double": "<f8", "int": "<i4", "uchar": "u1", "ushort": "<u2"}
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + 11
    counts, rows = {}, {}
    for words in (line.split() for line in data[:end].decode().split("\n")):
        if words[:1] == ["element"]:
            name = words[1]
            counts[name], rows[name] = int(words[2]), []
        elif words[:2] == ["property", "list"]:
            rows[name] += [("count", types[words[2]]), ("corners", types[words[3]], 3)]
        elif words[:1] == ["property"]:
            rows[name].append((words[2], types[words[1]]))
    vertices = np.frombuffer(data, rows["vertex"], counts["vertex"], end)
    faces = np.frombuffer(data, rows["face"], counts["face"], end + vertices.nbytes)
    assert (faces["count"] == 3).all()
    return np.stack([vertices[axis] for axis in "xyz"], -1).astype(float), faces["corners"], faces["neighbor"]


def read_obj(path):
    with open(path) as file:
        lines = [line.split() for line in file]
    vertices = np.array([[float(x) for x in words[1:4]] for words in lines if words[:1] == ["v"]])
    return vertices, np.array([[int(corner.split("/")[0]) - 1 for corner in words[1:4]] for words in lines if words[:1] == ["f"]])


def volume(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def matrix(q):
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


class Assemblage(CommandLine):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.library = os.path.join(cls.data, "collection")
        os.makedirs(cls.library)
        for i in range(MESHES):
            r = np.random.default_rng(i)
            points, faces = torus(0.2 + 0.04 * i) if i % 2 else sphere()
            stretched = np.asarray(points) * r.uniform(0.5, 1, 3) * 10 ** r.uniform(-2, 2) + r.uniform(-3, 3, 3)
            write_obj(os.path.join(cls.library, f"object_{i}.obj"), (stretched, faces))

    def assemblage(self, *arguments, out=None, library=None, **more):
        given = {"--resolution": str(RESOLUTION), "--split": "1/0/0", "--pieces": "3..6", "--write": "mesh", "--precision": "double"}
        every = [a for pair in given.items() if pair[0] not in arguments for a in pair]
        return self.run_sherd("assemblage", library or self.library, "-o", out or self.out, *every, *arguments, **more)

    def done(self, *arguments, **more):
        run = self.assemblage(*arguments, **more)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run

    def fails(self, status, *expected, arguments=(), **more):
        run = self.assemblage(*arguments, **more)
        self.assertEqual(run.returncode, status, run.stderr)
        for text in expected:
            self.assertIn(text, run.stderr)

    def fractures(self, out=None):
        """The rows of each fracture, by (object, fracture); without the intact objects."""
        found = {}
        with open(os.path.join(out or self.out, "index.jsonl")) as lines:
            for row in map(json.loads, lines):
                if row["fracture"] != "whole":
                    found.setdefault((row["object"], row["fracture"]), []).append(row)
        return found

    def manifest_of(self, key):
        return self.manifest(os.path.join(self.out, "objects", *key))


class Truth(Assemblage):
    def test_fragments_are_those_of_each_object_alone(self):
        self.done("--items", "4", "--intruders", "2", "--objects", "2..4")
        compared = 0
        for key, rows in self.fractures().items():
            objects = self.manifest_of(key)["assemblage"]
            for number, object_ in enumerate(objects):
                alone = self.path("alone")
                shutil.rmtree(alone, ignore_errors=True)
                run = self.run_sherd("fracture", os.path.join(self.library, object_["mesh"]), "-o", alone, "--pieces", str(object_["pieces"]), "--seed",
                                     str(object_["seed"]), "--resolution", str(RESOLUTION), "--surface", "smooth", "--write", "mesh", "--precision", "double")
                self.assertEqual(run.returncode, 0, run.stderr)
                own = [row for row in rows if row["mesh_number"] == number]
                expected = [read_ply(os.path.join(alone, f["files"]["mesh"])) for f in self.manifest(alone)["fragments"]]
                self.assertEqual(len(own), len(expected))
                side = 1 / object_["scale"]
                for row in own:
                    if row["withheld"]:
                        continue
                    points, faces, _ = read_ply(os.path.join(self.out, row["files"][0]))
                    # a random pose, and back by the truth
                    posed = (points - row["center"]) @ matrix(row["rotation"]).T
                    self.assertGreater(np.abs(posed - points).max(), 1e-3)
                    back = posed @ matrix(row["truth_rotation"]).T + row["truth_translation"]
                    original = (back - row["translation"]) / row["scale"]
                    errors = [np.abs(original - e[0]).max() / side if len(e[0]) == len(points) else 1 for e in expected]
                    self.assertLess(min(errors), 1e-6, (key, object_["mesh"], row["id"]))
                    # Rounding chooses the diagonal of a quad whose two are equal.
                    self.assertLess((expected[int(np.argmin(errors))][1] != faces).any(1).mean(), 0.02)
                    compared += 1
        self.assertGreater(compared, 40)

    def test_a_thousand_draws(self):
        self.done("--items", "250", "--repeats", "4", "--missing", "0.4", "--intruders", "0.1", "--resolution", "12", "--write", "mesh", "--objects", "2..5")
        fractures = self.fractures()
        self.assertEqual(len(fractures), 1000)
        counts, ratios, places, intruders, largest, farness = np.zeros(6, int), [], [], 0, [], []
        for rows in fractures.values():
            ids = [row["id"] for row in rows]
            self.assertEqual(ids, list(range(1, len(rows) + 1)))
            by_id = {row["id"]: row for row in rows}
            kept = {row["id"] for row in rows if not row["withheld"]}
            self.assertEqual(kept, set(range(1, len(kept) + 1)))
            main = {row["mesh"] for row in rows if not row["intruder"]}
            counts[len(main)] += 1
            self.assertEqual(len(main), len({row["mesh_number"] for row in rows if not row["intruder"]}))
            self.assertFalse(main & {row["mesh"] for row in rows if row["intruder"]})
            for row in rows:
                neighbors = {c[0] for c in row["contacts"]}
                self.assertTrue(all(by_id[n]["mesh_number"] == row["mesh_number"] for n in neighbors))
                self.assertTrue(all(row["id"] in {c[0] for c in by_id[n]["contacts"]} for n in neighbors))
                if row["withheld"]:
                    continue
                if row["intruder"]:
                    self.assertFalse(neighbors & kept)
                    farness.append(min(abs(np.log(row["volume"] / by_id[k]["volume"])) for k in kept if not by_id[k]["intruder"]))
                    intruders += 1
                    places.append((row["id"] - 0.5) / len(kept))
                elif sum(by_id[k]["mesh_number"] == row["mesh_number"] for k in kept) > 1:
                    self.assertTrue(neighbors & kept, row)  # the rule
            numbers = [by_id[k]["mesh_number"] for k in sorted(kept)]
            ratios.append(np.mean([a == b for a, b in zip(numbers, numbers[1:])]))
            share = np.bincount(numbers) / len(numbers)
            largest.append((np.bincount(numbers) * (np.bincount(numbers) - 1)).sum() / (len(numbers) * (len(numbers) - 1)))
        # Each number of objects as often, of 250 assemblages: within four standard deviations of a quarter.
        self.assertEqual(counts[:2].sum(), 0)
        self.assertLess(np.abs(counts[2:] / 4 - 62.5).max(), 4 * np.sqrt(250 * 0.25 * 0.75))
        # Ids say nothing of the object: neighbors in the order are of one object as often as chance has it, and intruders stand anywhere.
        difference = np.array(ratios) - np.array(largest)
        self.assertLess(abs(difference.mean()), 4 * difference.std() / np.sqrt(len(difference)))
        self.assertGreater(intruders, 900)
        self.assertLess(np.mean(np.array(farness) > np.log(2)), 0.05)  # where no piece of the object is of like size
        self.assertLess(abs(np.mean(places) - 0.5), 4 * np.sqrt(1 / 12 / intruders))

    def test_intruders_are_of_like_size(self):
        self.done("--items", "30", "--intruders", "2")
        ratios = []
        for key, rows in self.fractures().items():
            manifest = self.manifest_of(key)
            volumes = {row["id"]: volume(*read_ply(os.path.join(self.out, row["files"][0]))[:2]) for row in rows if not row["withheld"]}
            for number, object_ in enumerate(manifest["assemblage"]):
                own = [row for row in rows if row["mesh_number"] == number]
                self.assertEqual(object_.get("intruder", False), own[0]["intruder"])
                if not object_.get("intruder"):
                    continue
                (kept,) = [row["id"] for row in own if not row["withheld"]]
                like = object_["like"]
                self.assertFalse(next(r for r in rows if r["id"] == like["id"])["intruder"])
                self.assertAlmostEqual(volumes[kept] / volumes[like["id"]], like["ratio"], delta=1e-5 * like["ratio"])
                ratios.append(like["ratio"])
        self.assertEqual(len(ratios), 60)
        self.assertLess(np.mean(np.abs(np.log(ratios)) > np.log(2)), 0.1)  # where no piece of the object is of like size
        self.assertTrue(0.2 <= min(ratios) and max(ratios) <= 5)
        self.assertGreater(np.std(np.log(ratios)), 0.05)  # no twin

    def test_labels_are_those_of_the_meshes(self):
        self.done("--items", "2", "--write", "mesh,labels,vdb", "--missing", "1", "--intruders", "1", "--verify")
        for key, rows in self.fractures().items():
            with open(os.path.join(self.out, "objects", *key, "labels.rle"), "rb") as file:
                data = file.read()
            runs = np.frombuffer(data, np.dtype([("label", "<u2"), ("run", "<u4")]), offset=12)
            labels = np.repeat(runs["label"], runs["run"]).reshape(np.frombuffer(data, "<u4", 3))
            grid = self.manifest_of(key)["grid"]
            for row in rows:
                if row["withheld"]:
                    self.assertFalse((labels == row["id"] + 1).any())
                    continue
                at = np.argwhere(labels == row["id"] + 1)
                self.assertEqual(len(at), row["voxels"])
                places = at * grid["voxel_size"] + grid["origin"]
                points = read_ply(os.path.join(self.out, row["files"][0]))[0]
                self.assertLess(np.abs(places.min(0) - points.min(0)).max(), 1.5 * grid["voxel_size"])
                self.assertLess(np.abs(places.max(0) - points.max(0)).max(), 1.5 * grid["voxel_size"])


class Run(Assemblage):
    OPTIONS = ("--items", "12", "--missing", "0.3", "--intruders", "1", "--repeats", "2", "--write", "mesh,labels")

    def test_same_bytes_with_any_threads_and_shards(self):
        self.done(*self.OPTIONS, "--threads", "1")
        expected = dataset(self.out)
        self.assertGreater(len(expected), 200)
        other = self.path("two")
        self.done(*self.OPTIONS, "--threads", "2", out=other)
        self.assertEqual(dataset(other), expected)
        sharded = self.path("sharded")
        for shard in ("2/3", "1/3", "3/3"):
            self.done(*self.OPTIONS, "--shard", shard, "--resume", out=sharded)
        merged = self.run_sherd("merge", sharded)
        self.assertEqual(merged.returncode, 0, merged.stderr)
        self.assertEqual(dataset(sharded), expected)
        # `sherd dataset` with the same options is the same.
        plain = self.path("plain")
        run = self.run_sherd("dataset", self.library, "-o", plain, "--objects", "2..5", "--poses", "--resolution", str(RESOLUTION), "--split", "1/0/0", "--pieces",
                             "3..6", "--precision", "double", *self.OPTIONS)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(dataset(plain), expected)

    def test_an_interrupted_run_goes_on(self):
        self.done(*self.OPTIONS)
        expected = dataset(self.out)
        other = self.path("other")
        stops = 0

        def recorded():
            journal = os.path.join(other, "journal")
            return sum(file.stat().st_size for file in os.scandir(journal) if file.name.endswith(".jsonl")) if os.path.isdir(journal) else 0

        for _ in range(20):
            arguments = [SHERD, "assemblage", self.library, "-o", other, "--resolution", str(RESOLUTION), "--split", "1/0/0", "--pieces", "3..6", "--precision",
                         "double", *self.OPTIONS, *(["--resume"] if stops else [])]
            before = recorded()
            sherd = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            while sherd.poll() is None and recorded() == before:
                time.sleep(0.01)
            sherd.send_signal(signal.SIGINT)
            said = sherd.communicate()[1]
            if sherd.returncode == 0:
                break
            self.assertEqual(sherd.returncode, 130, said)
            stops += os.path.exists(os.path.join(other, "dataset.json"))
        if sherd.returncode != 0:
            self.done(*self.OPTIONS, "--resume", out=other)
        self.assertGreater(stops, 0)
        self.assertEqual(dataset(other), expected)

    def test_other_meshes_are_refused_when_it_goes_on(self):
        library = self.path("library")
        shutil.copytree(self.library, library)
        self.done("--items", "3", library=library)
        write_obj(os.path.join(library, "another.obj"), sphere())
        self.fails(2, "drawn among other meshes", arguments=("--items", "3", "--resume"), library=library)
        # Another content of a mesh: those that have failed or are not done are made anew.
        os.remove(os.path.join(library, "another.obj"))
        self.done("--items", "3", "--resume", library=library)

    def test_objects_are_of_one_split(self):
        self.done("--items", "40", "--split", "1/1/1", "--objects", "2..3", "--pieces", "2..3")
        splits = {}
        for rows in self.fractures().values():
            (split,) = {row["split"] for row in rows}
            for row in rows:
                self.assertEqual(splits.setdefault(row["mesh"], split), split)
        listed = {}
        for name in ("train", "val", "test"):
            with open(os.path.join(self.out, f"{name}.txt")) as lines:
                listed.update({line.strip(): name for line in lines})
        self.assertEqual(len(listed), 40)
        self.assertTrue(all(listed[key] == rows[0]["split"] for (key, _), rows in self.fractures().items()))


class Layouts(Assemblage):
    def check_frame(self, out):
        """Poses and places are those of the files: the center is that of mass, and a fragment lies in its object."""
        for row in (row for rows in self.fractures(out).values() for row in rows if not row["withheld"]):
            vertices, triangles = read_obj(os.path.join(out, row["files"][0]))
            corners = vertices[triangles]
            weights = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
            center = (corners.sum(1) / 4 * weights[:, None]).sum(0) / weights.sum()
            self.assertLess(np.abs(center - row["center"]).max(), 1e-5)
            own = (vertices - row["translation"]) * (1 / row["scale"])
            object_ = read_obj(os.path.join(self.library, row["mesh"]))[0]
            voxel = np.ptp(object_, axis=0).max() / RESOLUTION
            self.assertTrue((own > object_.min(0) - voxel).all() and (own < object_.max(0) + voxel).all(), row["mesh"])

    def test_every_layout_has_them(self):
        for layout in ("sherd", "packed", "paper", "bb", "hdf5", "pfpp"):
            out = self.path(layout)
            options = ["--items", "2", "--objects", "2", "--intruders", "1", "--layout", layout, "--verify"]
            run = self.run_sherd("assemblage", self.library, "-o", out, "--resolution", str(RESOLUTION), "--split", "1/0/0", "--pieces", "3..4", *options)
            self.assertEqual(run.returncode, 0, (layout, run.stderr))
            rows = [row for all in self.fractures(out).values() for row in all]
            self.assertTrue(all(row["mesh_number"] in (0, 1, 2) and "rotation" in row for row in rows), layout)
            if layout == "pfpp":
                for name in tree(out):
                    if name.startswith("pc_data") and name.endswith(".npz"):
                        item = np.load(os.path.join(out, name))
                        graph = item["graph"][: int(item["num_parts"]), : int(item["num_parts"])]
                        self.assertEqual((~graph.any(1)).sum(), 1)  # the intruder touches none
                        self.assertEqual(len(np.unique(np.round(item["part_pcs_gt"].mean((1, 2)), 6))), int(item["num_parts"]))
            if layout == "bb":
                self.check_frame(out)
                # The first object is around 0, with a longest side of 1.
                for (key, _), own in self.fractures(out).items():
                    first = []
                    for row in own:
                        if row["mesh_number"] == 0 and not row["withheld"]:
                            with open(os.path.join(out, row["files"][0])) as lines:
                                first += [[float(x) for x in line.split()[1:4]] for line in lines if line.startswith("v ")]
                    box = np.ptp(np.array(first), axis=0)
                    self.assertAlmostEqual(box.max(), 1, delta=2 / RESOLUTION)
                    self.assertLess(np.abs(np.mean([np.min(first, 0), np.max(first, 0)], 0)).max(), 1 / RESOLUTION)


class Wrong(Assemblage):
    def test_too_few_objects(self):
        one = self.path("one")
        os.makedirs(one)
        self.fails(3, "contains no mesh", library=one)
        write_obj(os.path.join(one, "a.obj"), sphere())
        self.fails(3, "needs 2 objects of one split", "train has 1", library=one)
        write_obj(os.path.join(one, "b.obj"), sphere())
        self.fails(3, "needs 3 objects of one split, those of intruders included", arguments=("--intruders", "1"), library=one)
        self.done("--objects", "2..5", library=one)  # 2 of each

    def test_options_that_cannot_be(self):
        for arguments, text in ((("--objects", "5..2"), "ascends"), (("--objects", "0"), "1..1000"), (("--objects", "1", "--items", "3"), "two objects"),
                                (("--intruders", "1.5"), "whole number"), (("--distinct", "0.1"), "compared"), (("--voxel-size", "0.1"), "resolution"),
                                (("--repeats", "1..2"), "equally often"), (("--recenter",), "recenter"),
                                (("--pieces", "300"), "max-fragments"), (("--layout", "pfpp", "--pieces", "9", "--objects", "3"), "20 pieces")):
            self.fails(2, text, arguments=arguments)
            self.assertFalse(os.path.exists(self.out))

    def test_more_intruders_than_further_objects(self):
        self.done("--objects", "3", "--intruders", "7", "--items", "4")
        for rows in self.fractures().values():
            intruders = [row["mesh"] for row in rows if row["intruder"] and not row["withheld"]]
            self.assertEqual((len(intruders), len(set(intruders))), (7, MESHES - 3))

    def test_a_mesh_that_cannot_be_scaled(self):
        library = self.path("library")
        os.makedirs(library)
        points, faces = sphere()
        write_obj(os.path.join(library, "a.obj"), (points, faces))
        write_obj(os.path.join(library, "b.obj"), (np.asarray(points) * 1e-312, faces))
        self.fails(3, "failed: b.obj: has no size", arguments=("--objects", "2"), library=library)

    def test_an_object_that_fails_is_named(self):
        library = self.path("library")
        shutil.copytree(self.library, library)
        with open(os.path.join(library, "object_0.obj"), "w") as file:
            file.write("f 1 2 3\n")
        run = self.assemblage("--items", "12", "--objects", "2", library=library)
        self.assertEqual(run.returncode, 0, run.stderr)
        with open(os.path.join(self.out, "failures.jsonl")) as lines:
            failures = [json.loads(line) for line in lines]
        self.assertTrue(0 < len(failures) < 12)
        self.assertTrue(all(f["reason"].count("object_0.obj") == 1 for f in failures), failures)
        used = {row["mesh"] for rows in self.fractures().values() for row in rows}
        self.assertNotIn("object_0.obj", used)
        # Once it is mended, what has failed is made.
        shutil.copy(os.path.join(self.library, "object_0.obj"), library)
        self.done("--items", "12", "--objects", "2", "--resume", library=library)
        self.assertEqual(len(self.fractures()), 12)


if __name__ == "__main__":
    skipping.main()
