#!/usr/bin/python3
"""The layouts hdf5 and pfpp, by readers that go by the steps of the loaders (training_readers.py), against the layout bb.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy and python3-h5py.
"""
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import h5py
import numpy as np

import skipping
from cli_test import SHERD, sphere, tree, write_obj
from dataset_safety_test import sealed, unsealed
from dataset_test import Dataset, dataset
from ply_file import read_ply, columns
from training_readers import Garf, PuzzleFusion, Rpf, parts_of, rotation_of

HDF5 = "fractures.hdf5"
QUICK = ("--resolution", "20", "--pieces", "2..4", "--repeats", "2..1", "--points", "0")


def appears(process, folder, *ends, within=""):
    """Wait for a file of a running process, or its end."""
    while process.poll() is None:
        for at, _, names in os.walk(folder):
            if any(name.endswith(ends) and within in os.path.join(at, name) for name in names):
                return
        time.sleep(0.002)


class Layouts(Dataset):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        os.makedirs(os.path.join(cls.library, "vases", "bowl"))
        for i in range(4):
            write_obj(os.path.join(cls.library, "vases", "bowl", f"{i}.obj"), sphere(10, 20, radius=1 + i / 8))

    def lists(self, subset):
        """The objects of a subset by split, from the dataset's own lists, as they are in paths."""
        out = {}
        for split in "train", "val", "test":
            keys = self.file(f"{split}.txt").decode().split("\n")[:-1]
            paths = [os.path.splitext(key)[0] for key in keys]
            paths = [path if "/" in path else f"library/{path}" for path in paths]
            out[split] = [path for path in paths if path.startswith(subset + "/")]
        return out


class OneFile(Layouts):
    def both(self, *arguments):
        """The same fractures as a tree of .ply files and as one HDF5 file."""
        bb = self.path("bb")
        self.done("--layout", "bb", "--mesh-format", "ply", "--write", "mesh", *arguments, out=bb)
        self.done("--layout", "hdf5", *arguments)
        return bb, os.path.join(self.out, HDF5)

    def read_tree(self, folder):
        """Meshes and neighbors of a fracture of the tree, by number."""
        own, fracture = os.path.split(folder)
        out = []
        for i in range(len(os.listdir(folder))):
            _, vertex, face = read_ply(os.path.join(folder, f"piece_{i}.ply"))
            neighbor = np.load(os.path.join(own, "neighbor", fracture, f"piece_{i}.npy")).astype(int)
            out.append((columns(vertex, "x", "y", "z"), face["vertex_indices"], neighbor))
        return out

    def test_three_loaders_read_what_the_tree_has(self):
        bb, path = self.both("--split", "3/2/1", *QUICK)
        seen = 0
        for subset in "library", "vases":
            for split, objects in self.lists(subset).items():
                garf = Garf(path, subset, split)
                expected = [f"{o}/fractured_{i}" for o in objects for i in range(len(os.listdir(os.path.join(bb, o, "neighbor"))))]
                self.assertEqual(sorted(garf.listed), sorted(expected))
                for i in range(len(garf.data_list)):
                    item, pieces = garf[i], self.read_tree(os.path.join(bb, garf.data_list[i]))
                    self.assertEqual(len(item["meshes"]), len(pieces))
                    for (vertices, faces), shared, (v, f, neighbor) in zip(item["meshes"], item["shared_faces"], pieces):
                        np.testing.assert_array_equal(vertices, v)
                        np.testing.assert_array_equal(faces, f)
                        np.testing.assert_array_equal(shared, neighbor - 1)
                        seen += 1
        self.assertGreater(seen, 60)
        for split in "train", "val", "test":
            listed = [o for subset in ("library", "vases") for o in self.lists(subset)[split]]
            rpf, tora = Rpf(path, split), Rpf(path, split, tora=True)
            self.assertEqual({os.path.dirname(os.path.dirname(f)) for f in rpf.listed}, set(listed))
            self.assertEqual(rpf.listed, tora.listed)
            self.assertEqual(rpf.fragments, tora.fragments)
            self.assertEqual(len(rpf.fragments), len(rpf.listed))
            for i, name in enumerate(rpf.fragments):
                pieces = self.read_tree(os.path.join(bb, os.path.dirname(name)))
                for meshes in rpf[i], tora[i]:
                    self.assertEqual(len(meshes), len(pieces))
                    for (vertices, faces), (v, f, _) in zip(meshes, pieces):
                        np.testing.assert_array_equal(vertices, v)
                        np.testing.assert_array_equal(faces, f)

    def test_labels_are_the_contacts_and_pieces_make_up_the_whole(self):
        self.done("--layout", "hdf5", *QUICK)
        garf = Garf(os.path.join(self.out, HDF5), "vases", "train")
        contacts = {}
        for row in self.rows():
            path = "/".join(row["files"][0].split("/")[:-2]) if row["fracture"] != "whole" else None
            for other, _ in row["contacts"]:
                contacts.setdefault(path, set()).add((row["id"] - 1, other - 1))
        for i in range(len(garf.data_list)):
            item = garf[i]
            edges = {(a, b) for a, b in np.argwhere(item["graph"])}
            self.assertEqual(edges, contacts[item["name"]])
            with h5py.File(garf.path, "r") as file:
                whole = np.array(file[os.path.dirname(item["name"])]["complete"]["vertices"])
            self.assertAlmostEqual(np.ptp(whole, axis=0).max(), 1, delta=0.05)
            volume = 0
            for k, ((vertices, faces), shared) in enumerate(zip(item["meshes"], item["shared_faces"])):
                a, b, c = (vertices[faces[:, j]].astype(float) for j in range(3))
                volume += np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
                for j in set(shared[shared >= 0]):  # both sides of a crack have the same vertices
                    own = {tuple(p) for p in vertices[faces[shared == j]].reshape(-1, 3)}
                    other, labels = item["meshes"][j], item["shared_faces"][j]
                    self.assertEqual(own, {tuple(p) for p in other[0][other[1][labels == k]].reshape(-1, 3)})
            with h5py.File(garf.path, "r") as file:
                group = file[os.path.dirname(item["name"])]["complete"]
                a, b, c = (np.array(group["vertices"]).astype(float)[np.array(group["faces"])[:, j]] for j in range(3))
            self.assertAlmostEqual(volume, np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6, delta=0.01 * volume)

    def test_types_filters_and_nothing_else(self):
        self.done("--layout", "hdf5", "--removal", "--redundant-pieces", "2", *QUICK)
        kinds = {"vertices": "float32", "faces": "int32", "shared_faces": "int16"}
        with h5py.File(os.path.join(self.out, HDF5), "r") as file:
            self.assertEqual(set(file), {"library", "vases", "data_split"})
            self.assertEqual(set(file["data_split"]), {"library", "vases", "fractures"})
            paths = [p.decode() for subset in ("library", "vases") for s in file["data_split"][subset].values() for p in s[:]]
            self.assertEqual(len(paths), len(set(paths)))
            for path in paths:
                fracture = file[path]
                self.assertLessEqual(set(fracture), {"pieces", "pieces_names", "removal_masks", "removal_order", "redundant_pieces"})
                count = len(fracture["pieces"])
                self.assertEqual(list(fracture["pieces"]), [f"{i:02}" for i in range(count)])
                self.assertEqual(len(fracture["pieces_names"]), count)
                for piece in fracture["pieces"].values():
                    self.assertEqual({name: piece[name].dtype.name for name in piece}, kinds)
                    for array in piece.values():
                        self.assertEqual((array.shuffle, array.compression), (True, "gzip"))
                masks = fracture["removal_masks"]
                self.assertEqual((masks.dtype, masks.shape), (np.dtype(bool), (count - 1, count)))
                self.assertEqual(h5py.check_enum_dtype(masks.id.get_type().dtype) or
                                 {k: masks.id.get_type().enum_valueof(k) for k in (b"FALSE", b"TRUE")}, {b"FALSE": 0, b"TRUE": 1})
            found = []
            file.visititems(lambda name, item: found.append(name) if len(item.attrs) else None)
            self.assertEqual(found, [])

    def test_equal_runs_give_equal_bytes(self):
        self.done("--layout", "hdf5", "--removal", *QUICK, "--threads", "1")
        time.sleep(1.1)  # a time in it would be another one
        again = self.path("again")
        self.done("--layout", "hdf5", "--removal", *QUICK, "--threads", "2", out=again)
        self.assertEqual(dataset(again), dataset(self.out))

    def test_removal_leaves_connected_parts(self):
        self.done("--layout", "hdf5", "--removal", "--pieces", "5..6", "--repeats", "3", "--resolution", "24")
        path = os.path.join(self.out, HDF5)
        for removal in 1, 2, 3:
            garf = Garf(path, "vases", "train", num_removal=removal)
            whole = Garf(path, "vases", "train")
            self.assertGreater(len(garf.data_list), 3)
            for i in range(len(garf.data_list)):
                item = garf[i]
                self.assertEqual(len(item["removal_pieces"]), removal)
                left = [int(n[6:]) for n in item["pieces"] if n not in item["removal_pieces"]]
                every = whole[whole.data_list.index(item["name"])]
                self.assertEqual([m[0].tobytes() for m in item["meshes"]], [every["meshes"][k][0].tobytes() for k in left])
                reached, front = {left[0]}, [left[0]]
                while front:
                    new = {int(k) for k in np.flatnonzero(item["graph"][front.pop()])} & set(left) - reached
                    reached |= new
                    front += new
                self.assertEqual(reached, set(left))

    def test_redundant_pieces_are_other_objects_of_the_split(self):
        self.done("--layout", "hdf5", "--redundant-pieces", "2", "--split", "1/1/0", *QUICK)
        path, drawn = os.path.join(self.out, HDF5), set()
        for split in "train", "val":
            for subset in "library", "vases":
                objects = [o for s in ("library", "vases") for o in self.lists(s)[split]]
                garf = Garf(path, subset, split, num_redundancy=2)
                for i in range(len(garf.data_list)):
                    item = garf[i]
                    self.assertEqual(len(item["meshes"]), len(item["pieces"]) + 2)
                    for piece in item["redundant_pieces"]:
                        foreign = piece.split("/fractured_")[0]
                        self.assertIn(foreign, objects)
                        self.assertNotEqual(foreign, item["name"].split("/fractured_")[0])
                    self.assertEqual(len(set(item["redundant_pieces"])), 2)
                    drawn |= set(item["redundant_pieces"])
        self.assertGreater(len(drawn), 10)

    def test_faces_to_missing_fragments_have_the_number_of_parts(self):
        bb, path = self.both("--missing", "1", "--pieces", "4", "--repeats", "2", "--resolution", "20")
        seen = 0
        for split in "train", "val", "test":
            garf = Garf(path, "vases", split)
            for i in range(len(garf.data_list)):
                item, pieces = garf[i], self.read_tree(os.path.join(bb, garf.data_list[i]))
                self.assertEqual(len(pieces), 3)
                for shared, (_, _, neighbor) in zip(item["shared_faces"], pieces):
                    np.testing.assert_array_equal(shared, np.where(neighbor > 3, 3, neighbor - 1))
                    seen += (shared == 3).any()
        self.assertGreater(seen, 0)

    def test_decimated_meshes_have_labels(self):
        options = ("--pieces", "3", "--repeats", "2", "--resolution", "24", "--adaptivity", "0", "--match", "vases/bowl/*", "--split", "1/0/0")
        self.done("--layout", "hdf5", "--triangles", "300", *options, "--verify")
        full = self.path("full")
        self.done("--layout", "hdf5", *options, out=full)
        few, many = (Garf(os.path.join(out, HDF5), "vases", "train") for out in (self.out, full))
        self.assertEqual(few.data_list, many.data_list)
        for i in range(len(few.data_list)):
            a, b = few[i], many[i]
            np.testing.assert_array_equal(a["graph"], b["graph"])
            for (vertices, faces), shared, (_, others) in zip(a["meshes"], a["shared_faces"], b["meshes"]):
                self.assertLess(len(faces), min(400, len(others)))
                self.assertEqual(len(shared), len(faces))
                edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
                self.assertEqual(set(np.unique(edges, axis=0, return_counts=True)[1]), {2})  # closed
        faces = [row["faces"] for row in self.rows() if row["fracture"] != "whole"]
        self.assertLess(max(faces), 400)

    def test_a_library_may_use_names_of_the_file(self):
        library = self.path("named")
        for name in "fractures/a", "data_split/b", "plain/c":
            os.makedirs(os.path.join(library, os.path.dirname(name)))
            write_obj(os.path.join(library, name + ".obj"), sphere(8, 16))
        self.done("--layout", "hdf5", "--split", "1/0/0", *QUICK, library=library)
        path = os.path.join(self.out, HDF5)
        with h5py.File(path, "r") as file:
            self.assertEqual(set(file["data_split"]), {"fractures", "fractures_", "data_split_", "plain"})
        self.assertEqual(len(Rpf(path, "train").fragments), 3 * 4)


class Matches(Layouts):
    def test_both_stages(self):
        bb = self.path("bb")
        options = ("--pieces", "2..6", "--repeats", "2", "--resolution", "32", "--split", "1/1/0", "--adaptivity", "0")
        self.done("--layout", "pfpp", *options, "--points", "1000")
        self.done("--layout", "bb", "--mesh-format", "ply", "--write", "mesh", *options, "--points", "0", out=bb)
        self.assertEqual(set(os.listdir(self.out)) - {"run.json", "report.html"},
                         {"pc_data", "matching_data", "journal", "dataset.json", "index.csv", "index.jsonl", "failures.jsonl", "recipe.json",
                          "train.txt", "val.txt", "test.txt"})
        rows = {}
        for row in self.rows():
            if row["fracture"] != "whole":
                rows.setdefault(row["files"][0], []).append(row)
        ids, kinds = set(), set()
        for subset in "library", "vases":
            for split in "train", "val":
                folder = os.path.join(self.out, "pc_data", subset, split)
                items = PuzzleFusion(folder, os.path.join(self.out, "matching_data", subset)) if os.path.isdir(folder) else []
                for i in range(len(items.data_list) if items else 0):
                    sample = items[i]
                    ids.add(sample["data_id"])
                    self.check_points(sample, bb, rows[f"pc_data/{subset}/{split}/{sample['data_id']:05}.npz"])
                    kinds.add(self.check_matches(sample))
        self.assertEqual(len(ids), 7 * 10)
        self.assertEqual(kinds, {"one", "several"})

    def check_points(self, sample, bb, rows):
        count = sample["num_parts"]
        self.assertEqual(len(rows), count)
        self.assertEqual(sample["part_valids"].tolist(), [1.0] * count + [0.0] * (20 - count))
        self.assertEqual((sample["part_valids"].dtype, sample["part_pcs_gt"].dtype), (np.float32, np.float32))
        self.assertEqual(sample["part_pcs_gt"].shape, (count, 1000, 3))
        path = sample["mesh_file_path"]
        self.assertEqual(sample["category"].item(), path.split("/")[1].lower())
        graph = np.zeros((20, 20), bool)
        for row in rows:
            for other, _ in row["contacts"]:
                graph[row["id"] - 1, other - 1] = True
        self.assertEqual(sample["graph"].dtype, np.dtype(bool))
        np.testing.assert_array_equal(sample["graph"], graph)
        spread = sample["part_pcs_gt"].max((1, 2)) - sample["part_pcs_gt"].min((1, 2))
        self.assertEqual(np.flatnonzero(sample["ref_part"]).tolist(), [spread.argmax()])
        for i, points in enumerate(sample["part_pcs_gt"]):  # on the piece of the tree
            _, vertex, _ = read_ply(os.path.join(bb, path, f"piece_{i}.ply"))
            corners = columns(vertex, "x", "y", "z")
            self.assertTrue((points.min(0) >= corners.min(0) - 1e-6).all() and (points.max(0) <= corners.max(0) + 1e-6).all())
            nearest = np.sqrt(((points[::50, None] - corners[None]) ** 2).sum(2).min(1))
            self.assertLess(nearest.max(), 2 / 32)  # voxels, the length of its triangles
        # The poses put the parts together.
        for i in range(count):
            own = sample["part_pcs"][i] @ rotation_of(sample["part_rots"][i]).T + sample["part_trans"][i]
            self.assertLess(np.abs(own - sample["assembled"][i]).max(), 1e-6)
        back = (sample["assembled"] + sample["init_pose_t"]) @ rotation_of(sample["init_pose_r"]).T
        self.assertLess(np.abs(back - sample["part_pcs_gt"]).max(), 1e-6)

    def check_matches(self, sample):
        count, at = sample["num_parts"], sample["gt_pc_by_area"]
        self.assertEqual((at.shape, sample["critical_pcs_idx"].shape), ((5000, 3), (5000,)))
        self.assertEqual((sample["n_pcs"].shape, sample["n_critical_pcs"].shape), ((20,), (20,)))
        self.assertEqual(sample["n_pcs"].sum(), 5000)
        self.assertGreaterEqual(sample["n_pcs"][:count].min(), 30)
        self.assertEqual(sample["n_pcs"][count:].sum() + sample["n_critical_pcs"][count:].sum(), 0)
        points, critical = parts_of(sample, at), parts_of(sample, sample["critical_pcs_idx"])
        critical = [c[:n] for c, n in zip(critical, sample["n_critical_pcs"])]
        self.assertEqual(len(sample["edges"]), len(sample["correspondences"]))
        edges = set()
        for (j, i), pairs in zip(sample["edges"], sample["correspondences"]):
            self.assertLess(i, j)
            self.assertTrue(sample["graph"][i, j])
            edges.add((i, j))
            self.assertGreaterEqual(len(pairs), 3)
            for side in 0, 1:
                self.assertEqual(len(set(pairs[:, side])), len(pairs))
            a, b = points[i][critical[i]][pairs[:, 0]], points[j][critical[j]][pairs[:, 1]]
            # The points of a side have gaps of about sqrt(area / points); mutual neighbors are not much farther apart.
            self.assertLess(np.median(np.linalg.norm(a - b, axis=1)), 0.03)
            self.assertLess(np.linalg.norm(a - b, axis=1).max(), 0.15)
        touching = {(i, j) for i, j in np.argwhere(sample["graph"]) if i < j}
        self.assertLessEqual(edges, touching)
        # Only contacts of a few points are without an edge.
        self.assertGreaterEqual(len(edges), 0.7 * len(touching))
        # In test mode the poses put the points by area where they were.
        for i, own in enumerate(parts_of(sample, sample["part_pcs_by_area"])):
            own = own @ rotation_of(sample["part_rots"][i]).T + sample["part_trans"][i]
            self.assertLess(np.abs(own - parts_of(sample, sample["anchored"])[i]).max(), 1e-6)
        return "one" if len(edges) == 1 else "several"

    def test_points_on_cracks_are_those_that_face_another_part(self):
        """Two halves of a ball: a point is critical exactly where both halves have surface."""
        library = self.path("one")
        os.mkdir(library)
        write_obj(os.path.join(library, "ball.obj"), sphere(24, 48))
        self.done("--layout", "pfpp", "--pieces", "2", "--repeats", "4", "--resolution", "32", "--split", "1/0/0", library=library)
        items = PuzzleFusion(os.path.join(self.out, "pc_data/library/train"), os.path.join(self.out, "matching_data/library"))
        self.assertEqual(len(items.data_list), 4)
        for i in range(4):
            sample = items[i]
            for points, idx, n in zip(parts_of(sample, sample["gt_pc_by_area"]), parts_of(sample, sample["critical_pcs_idx"]),
                                      sample["n_critical_pcs"]):
                radius = np.linalg.norm(points, axis=1)
                inside = radius < 0.5 - 2 / 32  # two voxels below the ball's surface
                self.assertEqual(set(np.flatnonzero(inside)) - set(idx[:n]), set())
                self.assertLess(np.mean(radius[idx[:n]] > 0.5 + 1 / 32), 0.01)

    def test_object_arrays_name_nothing_but_numpy(self):
        import pickletools
        import zipfile
        self.done("--layout", "pfpp", "--match", "ball*", "--pieces", "5", "--repeats", "1", "--resolution", "24", "--points", "10")
        found = [n for n in tree(self.out) if n.startswith("matching_data") and n.endswith(".npz")]
        with zipfile.ZipFile(os.path.join(self.out, found[0])) as archive:
            data = archive.read("correspondence.npy")
        body = data[10 + int.from_bytes(data[8:10], "little"):]
        named = {arg for op, arg, _ in pickletools.genops(body) if op.name in ("GLOBAL", "STACK_GLOBAL")}
        self.assertEqual(named, {"numpy.core.multiarray _reconstruct", "numpy ndarray", "numpy dtype"})
        array = np.load(os.path.join(self.out, found[0]), allow_pickle=True)["correspondence"]
        for table in array:
            self.assertEqual((table.dtype, table.ndim, table.shape[1]), (np.dtype(np.int64), 2, 2))
            table += 0  # it is writeable, as after numpy.save

    def test_numbers_stay_when_objects_are_added(self):
        library = self.path("growing")
        shutil.copytree(self.library, library)
        options = ("--layout", "pfpp", *QUICK[:-2], "--points", "10")
        self.done(*options, library=library)
        before = {n: f for n, f in tree(self.out).items() if n.endswith(".npz")}
        write_obj(os.path.join(library, "another.obj"), sphere(8, 16))
        self.done(*options, "--resume", library=library)
        after = {n: f for n, f in tree(self.out).items() if n.endswith(".npz")}
        self.assertEqual({n: after.get(n) for n in before}, before)
        self.assertEqual(len(after), len(before) * 8 // 7)


class Whole(Layouts):
    """What is left when runs are cut, joined and spoiled."""
    FEW = "--resolution", "20", "--pieces", "2..3", "--repeats", "1"
    OPTIONS = {"hdf5": ("--layout", "hdf5", "--removal", "--redundant-pieces", "1", *FEW, "--points", "0"),
               "pfpp": ("--layout", "pfpp", *FEW, "--points", "20")}

    def test_shards_join_to_the_same_files(self):
        for layout, options in self.OPTIONS.items():
            with self.subTest(layout=layout):
                whole, shards = self.path(layout + "-whole"), self.path(layout + "-shards")
                self.done(*options, out=whole)
                for number in 1, 2, 3:
                    self.done(*options, "--shard", f"{number}/3", "--resume", out=shards)
                    if layout == "hdf5":
                        path = os.path.join(shards, f"fractures_{number}_of_3.hdf5")
                        self.assertFalse([n for n in tree(shards) if n.endswith(".part")])
                        listed = [f for split in ("train", "val", "test") for f in Rpf(path, split).fragments]
                        self.assertGreater(len(listed), 0)
                merged = self.run_sherd("merge", shards)
                self.assertEqual(merged.returncode, 0, merged.stderr)
                self.assertEqual(dataset(shards), dataset(whole))
                before = tree(shards)
                self.assertEqual(self.run_sherd("merge", shards).returncode, 0)
                self.done(*options, "--shard", "2/3", "--resume", out=shards)
                self.assertEqual(dataset(shards), dataset(whole))
                self.assertEqual(before.keys() - tree(shards).keys(), {"journal/SHA256SUMS"})  # which merge writes

    def test_objects_may_be_added(self):
        options = self.OPTIONS["hdf5"]
        library, fresh = self.path("growing"), self.path("fresh")
        shutil.copytree(self.library, library)
        os.remove(os.path.join(library, "vases", "egg.stl"))
        self.done(*options, library=library)
        shutil.copy(os.path.join(self.library, "vases", "egg.stl"), os.path.join(library, "vases"))
        self.done(*options, "--resume", library=library)
        self.done(*options, out=fresh)
        self.assertEqual(dataset(self.out), dataset(fresh))

    def test_a_file_that_was_cut_is_made_anew(self):
        options = self.OPTIONS["hdf5"]
        self.done(*options)
        before = dataset(self.out)
        path, record = os.path.join(self.out, HDF5), os.path.join(self.out, HDF5 + ".json")

        def cut():
            os.truncate(path, os.path.getsize(path) * 2 // 3)

        def spoil(text):
            def do():
                with open(record, "w") as file:
                    file.write(text)
            return do

        for what in (cut, lambda: os.remove(path), lambda: os.remove(record), spoil("{"), spoil("[]"), spoil('{"schema":"sherd-hdf5/1"}'),
                     spoil('{"schema":"sherd-hdf5/1","states":[3,{"bytes":-1}]}'),
                     spoil(f'{{"schema":"sherd-hdf5/1","states":[{{"bytes":{os.path.getsize(path)},"sha256":"","objects":["ball.obj"]}}]}}')):
            what()
            run = self.done(*options, "--resume")
            self.assertIn("are made again", run.stderr)
            self.assertEqual(dataset(self.out), before)
        run = self.done(*options, "--resume", "--verify")
        self.assertNotIn("made again", run.stderr)
        self.assertRegex(run.stdout, r"all \d+ files are whole")

    def test_verifying_finds_what_was_changed(self):
        options = self.OPTIONS["hdf5"]
        self.done(*options)
        path = os.path.join(self.out, HDF5)
        with open(path, "rb") as file:
            good = file.read()
        for at in 3, len(good) // 2, len(good) - 9:
            with open(path, "wb") as file:
                file.write(good[:at] + bytes([good[at] ^ 1]) + good[at + 1:])
            run = self.dataset(*options, "--resume", "--verify")
            self.assertEqual(run.returncode, 3, run.stderr)
            # One sentence on the file, which names the way out, and none on each of its fractures.
            self.assertEqual(run.stderr.count("differs from what was written; remove it"), 1, run.stderr)
            self.assertNotIn("is missing", run.stderr)
            self.assertIn("1 file is not as it was written", run.stderr)
        os.remove(path)
        self.done(*options, "--resume", "--verify")
        with open(path, "rb") as file:
            self.assertEqual(file.read(), good)
        for text in b"", b"\x89HDF\r\n\x1a\n" + b"\xff" * 4000, os.urandom(3000):  # of any size, beside a record of its size
            with open(path, "wb") as file:
                file.write(text)
            with open(path + ".json") as file:
                record = json.load(file)
            record["states"][0]["bytes"] = len(text)
            with open(path + ".json", "w") as file:
                json.dump(record, file)
            run = self.dataset(*options, "--resume", "--verify")
            self.assertEqual(run.returncode, 3, run.stderr)

    def test_a_damaged_shard_is_not_merged(self):
        for number in "12":
            self.done(*self.OPTIONS["hdf5"], "--shard", number + "/2", "--resume")
        path = os.path.join(self.out, "fractures_1_of_2.hdf5")
        with open(path, "r+b") as file:
            file.seek(os.path.getsize(path) // 2)
            byte = file.read(1)[0]
            file.seek(-1, os.SEEK_CUR)
            file.write(bytes([byte ^ 1]))
        self.refused(3, self.run_sherd("merge", self.out), path, "remove it, and a resumed run")
        os.remove(path)
        self.done(*self.OPTIONS["hdf5"], "--shard", "1/2", "--resume")
        self.assertEqual(self.run_sherd("merge", self.out).returncode, 0)

    def test_a_part_that_was_cut_or_changed(self):
        options = (*self.OPTIONS["hdf5"], "--threads", "1")
        whole = self.path("whole")
        self.done(*options, out=whole)
        self.killed(options)
        parts = [os.path.join(self.out, n) for n in tree(self.out) if n.endswith(".part")]
        self.assertGreater(len(parts), 2)
        killed = self.path("killed")
        shutil.copytree(self.out, killed)
        with open(os.path.join(self.out, "journal", "vases", "egg.jsonl")) as journal:
            text = journal.read()
        recorded = [part for part in parts if "egg" not in part or os.path.relpath(part, self.out) in text]
        for part in recorded[0], recorded[-1]:
            for spoil in (lambda: os.truncate(part, 100), lambda: os.remove(part)):
                spoil()
                self.assertIn("made again", self.done(*options, "--resume").stderr)
                self.assertEqual(dataset(self.out), dataset(whole))
                shutil.rmtree(self.out)
                shutil.copytree(killed, self.out)
        with open(parts[0], "r+b") as file:  # with its size
            file.seek(-1, os.SEEK_END)
            last = file.read()
            file.seek(-1, os.SEEK_END)
            file.write(bytes([last[0] ^ 1]))
        run = self.dataset(*options, "--resume")
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("differs from what was written", run.stderr)
        os.remove(parts[0])
        self.done(*options, "--resume")
        self.assertEqual(dataset(self.out), dataset(whole))

    def test_a_mesh_that_was_replaced(self):
        """Its journal is removed, and what the file has of it is not mixed with the new one."""
        options = self.OPTIONS["hdf5"]
        library, fresh = self.path("replaced"), self.path("fresh")
        shutil.copytree(self.library, library)
        self.done(*options, library=library)
        write_obj(os.path.join(library, "ball.obj"), sphere(14, 28))
        os.remove(os.path.join(self.out, "journal", "ball.jsonl"))
        self.done(*options, "--resume", library=library)
        self.done(*options, library=library, out=fresh)
        now, expected = dataset(self.out), dataset(fresh)
        self.assertEqual({n for n in expected if now[n] != expected[n]}, set())

    def test_damaged_journals_and_plans_are_named(self):
        options = self.OPTIONS["hdf5"]
        self.done(*options, "--match", "vases/bowl/[01]*")
        os.remove(os.path.join(self.out, HDF5 + ".json"))
        journal, plan = os.path.join(self.out, "journal/vases/bowl/0.jsonl"), os.path.join(self.out, "dataset.json")

        def spoiled(path, change):
            with open(path) as file:
                text = file.read()
            with open(path, "w") as file:
                file.write(change(text))
            run = self.run_sherd("merge", self.out)
            with open(path, "w") as file:
                file.write(text)
            return run

        def on_line(number, change):
            def of(text):
                lines = [json.loads(line) for line in unsealed(text)]
                change(lines[number])
                return sealed([json.dumps(line) for line in lines])
            return of

        for change in (lambda line: line.update(fragments=[]), lambda line: [f.update(withheld=True) for f in line["fragments"]],
                       lambda line: line.update(files=[], fragments=[{**f, "files": []} for f in line["fragments"]])):
            self.refused(3, spoiled(journal, on_line(2, change)), "0.jsonl: is damaged", "remove the file")
        self.refused(3, spoiled(plan, lambda text: text.replace("--redundant-pieces=1", "--redundant-pieces=99")), "dataset.json: is damaged")
        self.refused(3, self.run_sherd("merge", self.out), "are missing; resume the run")

    def killed(self, options):
        """A run that was killed between its first and its last part."""
        process = subprocess.Popen([SHERD, "dataset", self.library, "-o", self.out, *options], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        appears(process, self.out, ".part", within="egg")
        process.send_signal(signal.SIGKILL)
        self.assertEqual(process.wait(), -signal.SIGKILL)

    def test_ctrl_c_leaves_what_is_finished(self):
        for layout, options in self.OPTIONS.items():
            with self.subTest(layout=layout):
                out, whole = self.path(layout), self.path(layout + "-whole")
                process = subprocess.Popen([SHERD, "dataset", self.library, "-o", out, *options], stdout=subprocess.DEVNULL,
                                           stderr=subprocess.PIPE, text=True)
                appears(process, out, ".part", ".npz")
                process.send_signal(signal.SIGINT)
                _, errors = process.communicate(timeout=60)
                self.assertEqual(process.returncode, 130, errors)
                self.assertFalse([n for n in tree(out) if ".sherd-" in n])
                self.done(*options, "--resume", out=out)
                self.done(*options, out=whole)
                self.assertEqual(dataset(out), dataset(whole))

    def test_a_full_disk_stops_cleanly_and_resumes(self):
        for layout, options in self.OPTIONS.items():
            whole = self.path(layout + "-whole")
            self.done(*options, out=whole)
            sizes = {n: os.path.getsize(os.path.join(whole, n)) for n in tree(whole) if n[-1] != "/"}
            rooms = [sum(sizes.values()) // 2]
            if layout == "hdf5":  # for parts, and not for the joined file beside them
                rooms.append(sum(s for n, s in sizes.items() if n.startswith("journal/")) + sizes[HDF5] * 3 // 2)
            for room in rooms:
                with self.subTest(layout=layout, room=room):
                    disk = self.path(f"{layout}-{room}")
                    os.makedirs(disk)
                    if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={room // 4096 * 4096}", "tmpfs", disk],
                                      stderr=subprocess.DEVNULL).returncode:
                        skipping.skip(self, "MOUNT", "this process may not mount")
                    try:
                        out = os.path.join(disk, "out")
                        run = self.dataset(*options, out=out)
                        self.assertEqual(run.returncode, 5, run.stderr)
                        self.assertIn("no space left", run.stderr)
                        self.assertFalse([n for n in tree(out) if ".sherd-" in n])
                        self.assertEqual(subprocess.run(["mount", "-o", "remount,size=200m", disk]).returncode, 0)
                        self.done(*options, "--resume", out=out)
                        self.assertEqual(dataset(out), dataset(whole))
                    finally:
                        subprocess.run(["umount", disk])

    def test_two_runs_at_once(self):
        options = self.OPTIONS["hdf5"]
        whole = self.path("whole")
        self.done(*options, out=whole)
        runs = [subprocess.Popen([SHERD, "dataset", self.library, "-o", self.out, *options, "--shard", f"{i}/2", "--resume"],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for i in (1, 2)]
        for run in runs:
            _, errors = run.communicate(timeout=120)
            self.assertEqual(run.returncode, 0, errors)
        self.assertEqual(self.run_sherd("merge", self.out).returncode, 0)
        self.assertEqual(dataset(self.out), dataset(whole))


class Refused(Layouts):
    def test_options_that_contradict(self):
        for options, sentence in ((("--layout", "hdf5", "--compress", "zip"), "compresses arrays by itself"),
                                  (("--layout", "hdf5", "--redundant-pieces", "65"), "0..64"),
                                  (("--layout", "hdf5", "--triangles", "100,200"), "one number of triangles"),
                                  (("--layout", "pfpp", "--compress", "zstd"), "no compressed files"),
                                  (("--layout", "pfpp", "--pieces", "2..21"), "2 to 20 pieces"),
                                  (("--layout", "pfpp", "--pieces", "1..3"), "2 to 20 pieces"),
                                  (("--layout", "pfpp", "--points", "0"), "holds points")):
            with self.subTest(options=options):
                self.refused(2, self.run_sherd("dataset", self.library, "-o", self.out, *options), sentence)
                self.assertFalse(os.path.exists(self.out))

    def test_options_that_do_nothing(self):
        for options, sentence in ((("--layout", "hdf5", "--points", "10"), "--points does nothing with --layout hdf5"),
                                  (("--layout", "pfpp", "--write", "labels"), "--write does nothing with --layout pfpp"),
                                  (("--layout", "bb", "--removal"), "--removal does nothing without --layout hdf5")):
            with self.subTest(options=options):
                self.fresh()
                self.assertIn(sentence, self.done("--match", "ball*", *options).stderr)

    def fresh(self):
        self.out = os.path.join(tempfile.mkdtemp(dir=self.tmp), "out")

    def test_without_the_library(self):
        hidden = "for f in $(ldconfig -p | sed -n 's/.*libhdf5[_a-z]*\\.so\\.[0-9]* .*=> //p'); do mount --bind /dev/null $(realpath $f); done"
        if subprocess.run(["unshare", "-m", "sh", "-c", hidden], stderr=subprocess.DEVNULL).returncode:
            skipping.skip(self, "MOUNT", "this process may not mount")
        for layout, expected in ("hdf5", 2), ("bb", 0):
            run = subprocess.run(["unshare", "-m", "sh", "-c", hidden + '; exec "$@"', "sh", SHERD, "dataset", self.library, "-o", self.out,
                                  "--layout", layout, *QUICK[:-2]], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            if expected:
                self.refused(2, run, "the HDF5 library cannot be opened")
            else:
                self.assertEqual(run.returncode, 0, run.stderr)


if __name__ == "__main__":
    skipping.main()
