#!/usr/bin/python3
"""`sherd convert` and `sherd inspect` of voxel files, against readers and writers made from docs/formats.md.

SHERD_BIN names the program, SHERD_TEST_DATA, where set, a folder of meshes beside which `samples` has the authors' files.
"""
import gzip
import io
import json
import os
import subprocess
import tempfile
import unittest

import numpy as np

import skipping
import voxel_formats as vf

SHERD = os.environ["SHERD_BIN"]
SAMPLES = os.path.join(os.path.dirname(os.path.normpath(os.environ.get("SHERD_TEST_DATA", "/none/x"))), "samples")


def random_labels(seed, dims, low, high):
    """Boxes of labels with gaps; two corners are full, so that the box is tight."""
    random = np.random.default_rng(seed)
    labels = np.zeros(dims, np.uint16)
    for _ in range(40):
        a = [random.integers(n) for n in dims]
        b = [i + random.integers(1, 9) for i in a]
        labels[tuple(slice(i, j) for i, j in zip(a, b))] = random.integers(low, high + 1) * random.integers(0, 4).clip(0, 1)
    labels[0, 0, 0] = labels[-1, -1, -1] = high
    return labels


class ConvertTest(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)

    def path(self, name):
        return os.path.join(self._folder.name, name)

    def put(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)
        return self.path(name)

    def got(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def sherd(self, *arguments, code=0):
        run = subprocess.run([SHERD, *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(run.returncode, code, run.stderr)
        self.assertNotIn("internal", run.stderr)
        return run

    def converted(self, name, to, *options):
        """The bytes of a new file, and the sentences of losses."""
        run = self.sherd("convert", self.path(name), self.path(to), *options)
        return self.got(to), run.stderr.splitlines()

    def refused(self, *arguments, code=3):
        run = self.sherd(*arguments, code=code)
        self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
        self.assertTrue(run.stderr.startswith("sherd: "))
        return run.stderr

    def reported(self, name):
        return json.loads(self.sherd("inspect", self.path(name), "--json").stdout)


class VoxelBytes(ConvertTest):
    CASES = [((7, 5, 6), 2, 9), ((1, 1, 1), 2, 2), ((4, 1, 30), 2, 5), ((31, 40, 9), 2, 256), ((130, 3, 128), 2, 6)]

    def test_every_format_is_written_as_described(self):
        for seed, case in enumerate(self.CASES):
            labels = random_labels(seed, *case)
            self.put("in.rle", vf.write_rle(labels))
            with self.subTest(case=case):
                for to, want in (("a.rle", vf.write_rle(labels)), ("a.bing", vf.write_bing(labels)),
                                 ("a.qstack", vf.write_qstack(labels)), ("a.vox", vf.write_vox(labels))):
                    data, losses = self.converted("in.rle", to)
                    self.assertEqual(data, want, to)
                    self.assertEqual(losses, [], to)
                np.testing.assert_array_equal(vf.read_qstack(self.got("a.qstack")), labels)
                np.testing.assert_array_equal(vf.read_vox(self.got("a.vox"))[0], np.where(labels, labels - 1, 0))
                for to in ("a.npy", "a.npz"):
                    self.converted("in.rle", to)
                    array = np.load(self.path(to))
                    array = array["labels"] if to == "a.npz" else array
                    self.assertEqual(array.dtype, np.dtype("<u2"))
                    np.testing.assert_array_equal(array, labels)

    def test_every_format_is_read_as_described(self):
        for seed, case in enumerate(self.CASES):
            labels = random_labels(seed + 50, *case)
            np.save(self.path("in.npy"), labels)
            np.savez(self.path("in.npz"), labels=labels)
            np.savez_compressed(self.path("packed.npz"), labels=labels, other=np.zeros(3))
            for name, data in (("in.rle", vf.write_rle(labels)), ("old.rle", vf.write_rle(labels, old=True)),
                               ("in.bing", vf.write_bing(labels)), ("in.qstack", vf.write_qstack(labels)),
                               ("in.vox", vf.write_vox(labels))):
                self.put(name, data)
            for name in ("in.rle", "old.rle", "in.bing", "in.qstack", "in.vox", "in.npy", "in.npz", "packed.npz"):
                with self.subTest(case=case, name=name):
                    data, losses = self.converted(name, "out.rle")
                    want = vf.cube(labels, True) if name == "in.bing" else labels
                    np.testing.assert_array_equal(vf.read_rle(data), want)
                    self.assertEqual(losses, [])

    def test_solid_of_no_fragment_has_a_color_of_its_own(self):
        labels = random_labels(3, (9, 8, 7), 1, 255)
        labels[1, 1, 1] = 1
        self.put("in.rle", vf.write_rle(labels))
        data, losses = self.converted("in.rle", "a.vox")
        colors, palette = vf.read_vox(data)
        np.testing.assert_array_equal(colors, labels)
        self.assertEqual(len(np.unique(palette[:40], axis=0)), 40)
        self.assertEqual(losses, [])
        np.testing.assert_array_equal(vf.read_rle(self.converted("a.vox", "b.rle")[0]), labels)

    def test_more_fragments_than_colors_are_told(self):
        labels = random_labels(3, (30, 30, 30), 2, 3000)
        self.put("in.rle", vf.write_rle(labels))
        data, losses = self.converted("in.rle", "a.vox")
        self.assertEqual(len(losses), 1)
        self.assertIn("255 colors", losses[0])
        np.testing.assert_array_equal(vf.read_vox(data)[0] > 0, labels > 0)

    def test_margins_are_told(self):
        labels = np.zeros((5, 5, 5), np.uint16)
        labels[2:4, 2, 2] = 2
        self.put("in.rle", vf.write_rle(labels))
        data, losses = self.converted("in.rle", "a.vox")
        self.assertEqual(vf.read_vox(data)[0].shape, (2, 1, 1))
        self.assertIn("margin", losses[0])


class Arrays(ConvertTest):
    def test_arrays_of_every_integer_type_and_order_are_read(self):
        labels = random_labels(5, (5, 6, 7), 2, 100)
        self.put("want.rle", vf.write_rle(labels))
        for kind in ("u1", "<u2", ">u2", "<u4", ">u8", "i1", "<i2", ">i4", "<i8"):
            for order in "CF":
                version = ((1, 0), (2, 0), (3, 0))[len(kind) % 2 + (order == "C")]
                out = io.BytesIO()
                np.lib.format.write_array(out, np.array(labels.astype(kind), order=order), version=version)
                self.put("a.npy", out.getvalue())
                data, _ = self.converted("a.npy", "a.rle")
                self.assertEqual(data, self.got("want.rle"), (kind, order, version))

    def test_large_arrays_in_fortrans_order_are_turned(self):
        labels = np.zeros((410, 405, 415), "u1", order="F")  # more than are turned at a time
        random = np.random.default_rng(1)
        for n in labels.shape, (3, 405, 415), (410, 3, 415), (410, 405, 3):
            labels[tuple(random.integers(k, size=5000) for k in n)] = random.integers(1, 255, 5000)
        np.save(self.path("a.npy"), labels)
        np.testing.assert_array_equal(vf.read_rle(self.converted("a.npy", "a.rle")[0]), labels)

    def test_masks_are_labels(self):
        np.save(self.path("a.npy"), np.ones((2, 2, 2), bool))
        np.testing.assert_array_equal(vf.read_rle(self.converted("a.npy", "a.rle")[0]), np.ones((2, 2, 2)))

    def test_what_are_no_labels_is_refused(self):
        for array in (np.zeros((2, 2)), np.zeros((2, 2, 2)), np.zeros((2, 2), int), np.full((2, 2, 2), -1),
                      np.full((2, 2, 2), 65536), np.zeros((0, 2, 2), int), np.zeros((1, 1, 1), complex),
                      np.zeros((2, 2, 2), [("a", "u1")])):
            np.save(self.path("a.npy"), array)
            self.refused("convert", self.path("a.npy"), self.path("b.rle"))
        np.savez(self.path("a.npz"), something=np.zeros((2, 2, 2), int))
        self.assertIn("labels", self.refused("convert", self.path("a.npz"), self.path("b.rle")))
        self.assertFalse(os.path.exists(self.path("b.rle")))

    def test_the_place_goes_through(self):
        labels = random_labels(6, (4, 5, 9), 2, 7)
        place = {"origin": np.array([1.5, -2, 3e7]), "voxel_size": np.float64(0.01),
                 "index_min": np.array([-4, 5, 6], np.int32)}
        np.savez_compressed(self.path("a.npz"), labels=labels, **place)
        self.assertEqual(self.converted("a.npz", "b.npz", "--pad", "cube")[1], [])
        with np.load(self.path("b.npz")) as back:
            self.assertEqual({k: v.dtype.str for k, v in back.items()},
                             {"labels": "<u2", "origin": "<f8", "voxel_size": "<f8", "index_min": "<i4"})
            self.assertEqual([back[k].shape for k in ("origin", "voxel_size", "index_min")], [(3,), (), (3,)])
            for key, value in place.items():
                np.testing.assert_array_equal(back[key], value)
            np.testing.assert_array_equal(back["labels"], vf.cube(labels, False))
        self.converted("a.npz", "c.npz", "--pad", "cube-centered")
        with np.load(self.path("c.npz")) as back:
            np.testing.assert_allclose(back["origin"], place["origin"] - 0.01 * np.array([2, 2, 0]), rtol=1e-15)
            np.testing.assert_array_equal(back["index_min"], place["index_min"] - [2, 2, 0])
            np.testing.assert_array_equal(back["labels"], vf.cube(labels, True))
        self.assertIn("origin", self.converted("a.npz", "b.rle")[1][0])
        reported = self.reported("a.npz")
        self.assertEqual((reported["origin"], reported["voxel_size"], reported["index_min"]), ([1.5, -2, 3e7], 0.01, [-4, 5, 6]))

    def test_a_place_is_given_by_options(self):
        self.put("a.rle", vf.write_rle(random_labels(6, (4, 5, 9), 2, 7)))
        self.converted("a.rle", "b.npz", "--voxel-size", "0.5", "--origin", "-1,2,3")
        with np.load(self.path("b.npz")) as back:
            self.assertEqual((list(back["origin"]), float(back["voxel_size"])), ([-1, 2, 3], 0.5))
        self.refused("convert", self.path("a.rle"), self.path("c.npz"), "--voxel-size", "0.5", code=2)
        self.refused("convert", self.path("a.rle"), self.path("c.npz"), "--origin", "1,2,3", code=2)
        for wrong in ("1,2", "1,2,x", "nan,0,0"):
            self.refused("convert", self.path("a.rle"), self.path("c.npz"), "--voxel-size", "1", "--origin", wrong, code=2)
        self.assertFalse(os.path.exists(self.path("c.npz")))

    def test_damaged_archives_are_refused(self):
        np.savez_compressed(self.path("a.npz"), labels=random_labels(6, (4, 5, 9), 2, 7))
        raw = self.got("a.npz")
        middle = len(raw) // 2 - 60
        self.put("b.npz", raw[:middle] + bytes([raw[middle] ^ 255]) + raw[middle + 1:])
        self.refused("inspect", self.path("b.npz"))
        self.put("b.npz", b"PK\x05\x06" + bytes(18))
        self.refused("convert", self.path("b.npz"), self.path("b.rle"))


class Scenes(ConvertTest):
    """Files as MagicaVoxel itself writes them: a palette, layers, several models, turned."""
    EXTRA = vf._chunk(b"LAYR", bytes(12)) + vf._chunk(b"RGBA", bytes(1024)) + vf._chunk(b"MATL", b"anything")

    def labels_of(self, chunks):
        self.put("a.vox", vf.vox_file(chunks, 200))
        return vf.read_rle(self.converted("a.vox", "a.rle")[0])

    def test_the_color_is_the_label(self):
        labels = self.labels_of(vf.model((3, 4, 5), [[2, 3, 4, 9], [0, 0, 0, 200]]) + self.EXTRA)
        self.assertEqual((labels.shape, labels[2, 4, 3], labels[0, 0, 0]), ((3, 5, 4), 9, 200))

    def test_a_file_with_color_0_for_empty_voxels_has_labels_for_colors(self):
        labels = self.labels_of(vf.model((126,) * 3, [[0, 0, 0, 0], [1, 1, 1, 2], [2, 2, 2, 3]]))
        self.assertEqual([labels[0, 0, 0], labels[1, 1, 1]], [2, 3])

    def test_models_are_moved_and_turned(self):
        voxels = np.array([[0, 0, 0, 1], [1, 0, 0, 2], [2, 0, 0, 3], [0, 3, 0, 4], [0, 0, 1, 5], [2, 3, 4, 6]])
        size = np.array([3, 4, 5])
        for first in range(3):
            for second in {0, 1, 2} - {first}:
                rows, shapes, groups = [], b"", []
                for signs in range(8):
                    rotation = np.zeros((3, 3), int)
                    for row, column in enumerate((first, second, 3 - first - second)):
                        rotation[row, column] = -1 if signs >> row & 1 else 1
                    shift = np.array([20 * signs + 8, -8, 4])
                    at = np.floor((voxels[:, :3] + 0.5 - size // 2) @ rotation.T + shift + [2, 1, 0])
                    rows.append(np.c_[at.astype(int), voxels[:, 3]])
                    groups.append(10 + 10 * signs)
                    shapes += (vf.transform(groups[-1], groups[-1] + 1, _r=str(first | second << 2 | signs << 4),
                                            _t=" ".join(map(str, shift))) +
                               vf.group(groups[-1] + 1, [groups[-1] + 2]) +
                               vf.transform(groups[-1] + 2, groups[-1] + 3) + vf.shape(groups[-1] + 3, 0))
                rows = np.concatenate(rows)[:, [0, 2, 1, 3]]
                rows[:, :3] -= rows[:, :3].min(axis=0)
                want = np.zeros(rows[:, :3].max(axis=0) + 1, np.uint16)
                want[tuple(rows[:, :3].T)] = rows[:, 3]
                labels = self.labels_of(vf.model(size, voxels) + vf.transform(0, 1, _t="2 1 0") +
                                        vf.group(1, groups) + shapes + self.EXTRA)
                np.testing.assert_array_equal(labels, want)

    def test_models_without_places_are_refused(self):
        self.put("a.vox", vf.vox_file(vf.model((1, 1, 1), [[0, 0, 0, 1]]) * 2))
        self.refused("convert", self.path("a.vox"), self.path("a.rle"))

    def test_a_voxel_outside_of_its_model_is_refused(self):
        self.put("a.vox", vf.vox_file(vf.model((1, 1, 1), [[0, 1, 0, 1]])))
        self.refused("inspect", self.path("a.vox"))


class Inspect(ConvertTest):
    def test_each_format_is_told(self):
        labels = random_labels(9, (6, 7, 8), 2, 5)
        counts = {str(k): int(v) for k, v in zip(*np.unique(labels, return_counts=True))}
        self.put("a.rle", vf.write_rle(labels))
        for ending in ("rle", "npy", "npz", "vox", "qstack", "bing"):
            self.converted("a.rle", "b." + ending)
            reported = self.reported("b." + ending)
            self.assertEqual((reported["kind"], reported["format"]), ("voxels", ending))
            self.assertEqual(reported["dims"], [8, 8, 8] if ending == "bing" else [6, 7, 8])
            got = dict(reported["voxels_per_label"])
            if ending == "bing":
                got["0"] -= 8 ** 3 - 6 * 7 * 8
            self.assertEqual(got, counts)
            self.assertIn("voxels", self.sherd("inspect", self.path("b." + ending)).stdout)


class Output(ConvertTest):
    def setUp(self):
        super().setUp()
        self.put("a.rle", vf.write_rle(random_labels(1, (5, 5, 5), 2, 5)))

    def test_the_report_is_one_object(self):
        run = self.sherd("convert", self.path("a.rle"), self.path("b.qstack"), "--json")
        reported = json.loads(run.stdout)
        self.assertEqual((reported["schema"], reported["command"], reported["kind"], reported["dims"], reported["losses"]),
                         ("sherd-report/1", "convert", "voxels", [5, 5, 5], []))

    def test_nothing_is_written_onto_folders_and_devices(self):
        os.mkdir(self.path("folder.rle"))
        self.refused("convert", self.path("a.rle"), self.path("folder.rle"), code=5)
        os.symlink("/dev/null", self.path("device.rle"))
        self.refused("convert", self.path("a.rle"), self.path("device.rle"), code=5)
        self.assertTrue(os.path.islink(self.path("device.rle")))
        self.refused("convert", self.path("a.rle"), self.path("none/b.rle"), code=5)

    def test_a_failure_leaves_the_old_file(self):
        self.put("b.vox", b"old")
        self.put("empty.rle", vf.write_rle(np.zeros((2, 2, 2), np.uint16)))
        self.refused("convert", self.path("empty.rle"), self.path("b.vox"), code=5)
        self.put("cut.rle", self.got("a.rle")[:-1])
        self.refused("convert", self.path("cut.rle"), self.path("b.vox"))
        self.assertEqual(self.got("b.vox"), b"old")
        self.assertEqual(sorted(os.listdir(self._folder.name)), ["a.rle", "b.vox", "cut.rle", "empty.rle"])

    def test_unknown_extensions_are_refused(self):
        self.refused("convert", self.path("a.rle"), self.path("b.docx"), code=2)
        self.put("a.docx", b"")
        self.refused("convert", self.path("a.docx"), self.path("b.rle"))
        self.refused("convert", self.path("none.rle"), self.path("b.rle"))

    def test_a_file_may_be_converted_onto_itself(self):
        before = self.got("a.rle")
        self.converted("a.rle", "a.rle")
        self.assertEqual(self.got("a.rle"), before)

    def test_a_huge_empty_box_is_not_made_dense(self):
        self.put("huge.rle", np.array([2**31 - 1, 2**31 - 1, 1], "<u4").tobytes() +
                 np.array([(0, 2**32 - 1)] * 3, [("a", "<u2"), ("b", "<u4")]).tobytes())
        self.refused("convert", self.path("huge.rle"), self.path("b.npy"))
        self.put("huge.rle", np.array([65536, 65536, 1], "<u4").tobytes() +
                 np.array([(0, 2**32 - 1), (1, 1)], [("a", "<u2"), ("b", "<u4")]).tobytes())
        for ending in ("bing", "qstack"):
            run = subprocess.run([SHERD, "convert", self.path("huge.rle"), self.path("b." + ending)], capture_output=True,
                                 text=True, timeout=60)
            self.assertIn(run.returncode, (3, 5), run.stderr)
        self.assertFalse(os.path.exists(self.path("b.bing")))


@skipping.skip_unless(os.path.isdir(SAMPLES), "SAMPLES", "no samples of the authors'")
class Samples(ConvertTest):
    def test_padding_is_as_the_authors_readers(self):
        self.sherd("convert", os.path.join(SAMPLES, "AL_12B_grid_128r.rle"), self.path("a.npy"), "--pad", "cube")
        with gzip.open(os.path.join(SAMPLES, "AL_12B_grid_128r.npy.gz")) as file:
            theirs = np.frombuffer(file.read(), "u1").reshape(128, 128, 128)
        ours = np.load(self.path("a.npy"))
        ours[:, :110] = ours[:, 109::-1]  # their reader turns y round before it pads
        np.testing.assert_array_equal(ours, theirs)

    def test_the_vessel_is_written_as_described(self):
        with open(os.path.join(SAMPLES, "AL_12B_grid_128r.rle"), "rb") as file:
            raw = file.read()
        labels = vf.read_rle(raw)
        self.put("a.rle", raw)
        for to, want in (("a.bing", vf.write_bing(labels)), ("a.qstack", vf.write_qstack(labels))):
            self.assertEqual(self.converted("a.rle", to)[0], want, to)


if __name__ == "__main__":
    skipping.main()
