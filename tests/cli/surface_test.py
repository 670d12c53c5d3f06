#!/usr/bin/python3
"""`sherd fracture --surface`, smoothing, `--triangles` and `--preset`: the meshes, and what the manifest says.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy.
"""
import json
import os
import shutil

import numpy as np

import skipping
from cli_test import CommandLine, tree
from ply_file import read_triangles

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")

BARE = {"of": "smooth", "interface": "shared", "adaptivity": "auto", "triangles": [],
        "smooth": {"method": "taubin", "iterations": 0, "weight": 0.5, "boundary_iterations": 0, "boundary_weight": 0.5}}

# Section 4.1 of the paper, at 128 voxels along the longest side: trunc(0.048 * 128) = 6.
PAPER = {
    "pieces": 5, "seed": 0, "resolution": 128, "fill": "auto",
    "seeds": {"sampler": "uniform", "on": "volume", "extra": 0, "extra_per_piece": 2, "merge_metric": "chebyshev",
              "random_impacts": 0, "impacts": []},
    "grow": {"growth": "flood", "neighborhood": 6, "roughness": 0.0, "hurst": 0.8, "roughness_window": 0.0, "outer_steps": 6,
             "isolated": "regrow"},
    "min_share": 0.0, "balance": 0, "share_tries": 64, "erode": {"iterations": 0}, "missing": 0.0,
    "surface": {"of": "labels", "interface": "shared", "adaptivity": 0.0, "triangles": [],
                "smooth": {"method": "laplacian", "iterations": 6, "weight": 0.9, "boundary_iterations": 6,
                           "boundary_weight": 0.2}},
}


def volume(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def directed_edges(faces):
    return np.concatenate([faces[:, [k, (k + 1) % 3]] for k in range(3)])


class SurfaceCase(CommandLine):
    def broken(self, *options, **more):
        return self.written("labels,mesh", *options, **more)

    def mesh(self, file):
        vertices, faces, neighbor = read_triangles(os.path.join(self.out, file))
        edges = directed_edges(faces)
        there = set(map(tuple, edges))
        self.assertEqual(len(there), len(edges), file)  # once each way: closed, edge-manifold
        self.assertEqual(there, {(b, a) for a, b in there}, file)
        self.assertGreater(volume(vertices, faces), 0)
        return vertices, faces, neighbor


class Labels(SurfaceCase):
    def test_default_is_exact(self):
        self.assertEqual(self.broken()["options"]["surface"], {**BARE, "of": "exact"})
        self.assertEqual(self.broken("--surface", "smooth")["options"]["surface"], BARE)

    def test_labels_are_the_voxels(self):
        manifest = self.broken("--surface", "labels")
        self.assertEqual(manifest["options"]["surface"], {**BARE, "of": "labels"})
        h, start = manifest["grid"]["voxel_size"], np.array(manifest["grid"]["origin"])
        for fragment in manifest["fragments"]:
            vertices, faces, neighbor = self.mesh(fragment["files"]["mesh"])
            corners = (vertices - start) / h + 0.5
            off = np.abs(corners - np.round(corners)).max()
            self.assertLess(off, 1 / 64 + 1e-4)  # single precision, and sheets set apart
            touching = (np.abs(corners - np.round(corners)).max(axis=1) > 1e-3).sum()
            # No vertex moved apart sweeps more than 1/64 over the twelve halves of faces it may have.
            self.assertAlmostEqual(fragment["volume"] / h**3, fragment["voxels"], delta=0.1 + touching * 6 / 64)
            self.assertEqual(set(neighbor), {0} | {c["id"] for c in fragment["contacts"]})

    def test_a_boundary_of_no_weight_stays(self):
        """Figure 8 of the paper: fragments still fit, the original surface is smooth."""
        self.broken("--surface", "labels")
        bare = {f["id"]: self.mesh(f["files"]["mesh"]) for f in self.manifest()["fragments"]}
        self.broken("--surface", "labels", "--smooth-iterations", "4", "--smooth-boundary-iterations", "4",
                    "--smooth-boundary-weight", "0")
        for fragment in self.manifest()["fragments"]:
            vertices, faces, neighbor = self.mesh(fragment["files"]["mesh"])
            before = bare[fragment["id"]]
            np.testing.assert_array_equal(faces, before[1])
            np.testing.assert_array_equal(neighbor, before[2])
            boundary = np.zeros(len(vertices), bool)
            boundary[faces[neighbor != 0].ravel()] = True
            moved = (vertices != before[0]).any(axis=1)
            self.assertFalse((moved & boundary).any())
            self.assertGreater((moved & ~boundary).sum(), 0.5 * (~boundary).sum())

    def test_smoothing_is_told_as_done(self):
        smooth = self.broken("--smoothing", "laplacian", "--smooth-iterations", "0.1k", "--smooth-weight", "0.5",
                             "--smooth-boundary-iterations", "2", "--smooth-boundary-weight", "1")["options"]["surface"]
        self.assertEqual(smooth, {**BARE, "smooth": {"method": "laplacian", "iterations": 3, "weight": 0.5,
                                                     "boundary_iterations": 2, "boundary_weight": 1.0}})  # 0.1 of 32 voxels

    def test_taubins_smoothing_keeps_the_volume(self):
        """Of a ball; the plain Laplacian takes a part of it with as many steps."""
        whole = self.broken(pieces=1)["fragments"][0]["volume"]
        kept = {}
        for method, steps in (("taubin", "10"), ("laplacian", "20")):
            manifest = self.broken("--smoothing", method, "--smooth-iterations", steps, pieces=1)
            self.assertEqual(manifest["options"]["surface"]["smooth"]["method"], method)
            kept[method] = manifest["fragments"][0]["volume"] / whole
        # No wave grows by more than lambda mu k^2 / 4 each time: 0.066 %, of a volume three times that.
        self.assertLess(abs(kept["taubin"] - 1), 1.00066**30 - 1)
        self.assertLess(kept["laplacian"], kept["taubin"] - 0.02)

    def test_weights_that_let_short_waves_grow_are_refused(self):
        for option in ("--smooth-weight", "--smooth-boundary-weight"):
            self.refused(2, self.fracture(option, "0.7", option.replace("weight", "iterations"), "2"))
            self.nothing_written()
            self.done("--write", "labels", "--smoothing", "laplacian", option, "0.7")
            shutil.rmtree(self.out)

    def test_worn_fragments(self):
        manifest = self.broken("--surface", "labels", "--erode-iterations", "2")
        for fragment in manifest["fragments"]:
            neighbor = self.mesh(fragment["files"]["mesh"])[2]
            self.assertLessEqual(set(neighbor), set(range(4)) - {fragment["id"]})
            self.assertGreater((neighbor != 0).sum(), 0)


class Triangles(SurfaceCase):
    def test_a_file_for_each_number(self):
        for surface in ("smooth", "labels"):
            manifest = self.broken("--triangles", "2000,400", "--surface", surface, pieces=4)
            self.assertEqual(manifest["options"]["surface"]["triangles"], [2000, 400])
            files = []
            for fragment in manifest["fragments"]:
                whole = self.mesh(fragment["files"]["mesh"])
                reported = fragment["decimated"]
                self.assertEqual([t["asked"] for t in reported], [2000, 400])
                for entry in reported:
                    self.assertEqual(entry["file"],
                                     f"meshes/ball_{fragment['id']:03}_t{entry['asked']}.ply")
                    vertices, faces, neighbor = self.mesh(entry["file"])
                    self.assertEqual(len(faces), entry["triangles"])
                    self.assertLessEqual(len(faces), entry["asked"])
                    self.assertEqual(set(neighbor), set(whole[2]))
                    self.assertLess(abs(volume(vertices, faces) / fragment["volume"] - 1), 0.05)
                    files.append(entry["file"])
            self.assertLessEqual(set(files), set(manifest["files"]))
            self.assertEqual(len([n for n in tree(self.out) if n.startswith("meshes/")]), 1 + 4 * 3)

    def test_what_cannot_be_reached_is_told(self):
        for fragment in self.broken("--triangles", "4", pieces=20)["fragments"]:
            entry, = fragment["decimated"]
            self.assertEqual(len(self.mesh(entry["file"])[1]), entry["triangles"])
            self.assertGreater(entry["triangles"], 4)  # three regions meet in more than four places

    def test_none_without_meshes_or_numbers(self):
        self.assertNotIn("decimated", self.broken()["fragments"][0])
        self.done("--write", "labels", "--triangles", "100")
        self.assertNotIn("decimated", self.manifest()["fragments"][0])


class Preset(SurfaceCase):
    def preset(self, *options):
        result = self.run_sherd("fracture", *options, self.ball, "-o", self.out, "--write", "labels", "--pieces", "5")
        self.assertEqual(result.returncode, 0, result.stderr)
        return self.manifest()["options"]

    def test_paper(self):
        self.assertEqual(self.preset("--preset", "paper"), PAPER)

    def test_an_option_that_is_given_wins_wherever_it_stands(self):
        given = ["--resolution", "48", "--extra-seeds", "3", "--growth", "euclid", "--smooth-boundary-weight", "0",
                 "--erode-iterations", "1", "--seed", "9"]
        before, after = self.preset(*given, "--preset", "paper"), self.preset("--preset", "paper", *given)
        self.assertEqual(before, after)
        self.assertEqual((before["resolution"], before["seed"], before["erode"]["iterations"]), (48, 9, 1))
        self.assertEqual(before["seeds"], {**PAPER["seeds"], "extra": 3, "extra_per_piece": 0})
        self.assertEqual(before["grow"]["growth"], "euclid")
        self.assertEqual(before["surface"]["of"], "labels")
        self.assertEqual(before["surface"]["smooth"],
                         {"method": "laplacian", "iterations": 2, "weight": 0.9, "boundary_iterations": 2,
                          "boundary_weight": 0.0})  # trunc(0.048 * 48)

    def test_a_voxel_size_beats_the_presets_resolution(self):
        options = self.preset("--voxel-size", "0.05", "--preset", "paper")
        self.assertEqual((options.get("voxel_size"), options.get("resolution")), (0.05, None))


TRAINING = ("--extra-seeds", "2n", "--size-spread", "1", "--min-share", "0.002", "--interface", "independent",
            "--write", "labels,mesh", "--mesh-format", "ply")
DRAWN = ("roughness", "missing", "mismatch", "scan-noise")
WITHOUT = ("--roughness", "0", "--missing", "0", "--mismatch", "0%", "--scan-noise", "0%")


class Training(SurfaceCase):
    """`--preset training`: what a network could learn instead of how fragments fit is not there."""

    def broke(self, *options, mesh=None, resolution="32"):
        out = self.path(f"out{len(os.listdir(self.tmp))}")
        result = self.run_sherd("fracture", mesh or self.ball, "-o", out, "--resolution", resolution, "--pieces", "6", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return out

    def drawn(self, out):
        """The drawn options of a fracture, by its manifest."""
        with open(os.path.join(out, "manifest.json")) as file:
            options = json.load(file)["options"]
        surface = options["surface"]
        return {"roughness": options["grow"]["roughness"], "missing": options["missing"],
                "mismatch": surface.get("mismatch", "0%"), "scan-noise": surface.get("scan_noise", "0%")}

    def test_is_the_same_as_its_options(self):
        out = self.broke("--preset", "training")
        given = [word for name, value in self.drawn(out).items() for word in (f"--{name}", str(value))]
        preset = tree(out)
        self.assertEqual(preset, tree(self.broke(*TRAINING, *given)))
        self.assertEqual(tree(self.broke("--preset", "training", *WITHOUT)), tree(self.broke(*TRAINING)))
        self.assertFalse([name for name in preset if name.endswith((".vdb", ".png"))])

    def test_draws_by_the_seed_within_its_ranges(self):
        most = {"roughness": 1.4, "missing": 0.2, "mismatch": 0.3, "scan-noise": 0.1}
        values = {name: [] for name in DRAWN}
        for seed in range(12):
            for name, value in self.drawn(self.broke("--preset", "training", "--seed", str(seed))).items():
                values[name].append(float(str(value).rstrip("%")))
        for name, all_ in values.items():
            self.assertLessEqual(max(all_), most[name])
            self.assertGreater(len(set(all_)), 10)
            # Uniform over the range: 12 values have a mean of half of it, to a standard deviation of 0.083.
            self.assertAlmostEqual(np.mean(all_) / most[name], 0.5, delta=0.35)

    def test_draws_nothing_that_contradicts_what_is_given(self):
        for given, without in ((("--surface", "exact"), {"scan-noise"}), (("--adaptivity", "0.5"), {"mismatch", "scan-noise"}), (("--mismatch", "0%"), {"mismatch"})):
            with self.subTest(given=given):
                values = self.drawn(self.broke("--preset", "training", *given))
                self.assertEqual({name for name, value in values.items() if value == "0%"}, without)
        self.assertEqual(self.drawn(self.broke("--preset", "training", "--material", "stone"))["roughness"], "1%")
        out = self.broke("--preset", "training")
        again = self.path("again")
        run = self.run_sherd("fracture", out, "--only", "2", "-o", again, "--pieces", "2", "--preset", "training")
        self.assertEqual(run.returncode, 0, run.stderr)

    def test_draws_nothing_that_contradicts_what_a_dataset_draws(self):
        for given, without in ((("--adaptivity", "0..0.5"), {"mismatch", "scan-noise"}), (("--surface", "smooth|exact"), {"scan-noise"})):
            with self.subTest(given=given):
                data = self.path(f"out{len(os.listdir(self.tmp))}")
                run = self.run_sherd("dataset", self.ball, "-o", data, "--preset", "training", "--resolution", "24", "--pieces", "3", "--repeats", "2", *given)
                self.assertEqual(run.returncode, 0, run.stderr)
                with open(os.path.join(data, "index.jsonl")) as file:
                    drawn = [json.loads(line)["options"] for line in file]
                self.assertEqual({name for options in drawn for name in options}, {*DRAWN, given[0][2:]} - without)

    def test_a_datasets_fractures_draw_the_same(self):
        data = self.path("data")
        run = self.run_sherd("dataset", self.ball, "-o", data, "--preset", "training", "--resolution", "32", "--pieces", "6", "--repeats", "2")
        self.assertEqual(run.returncode, 0, run.stderr)
        with open(os.path.join(data, "index.jsonl")) as file:
            lines = [json.loads(line) for line in file]
        drawn = {line["seed"]: line["options"] for line in lines if line["fracture"] != "whole"}
        self.assertEqual(len(drawn), 2)
        for seed, options in drawn.items():
            self.assertEqual(set(options), set(DRAWN))
            values = self.drawn(self.broke("--preset", "training", "--seed", str(seed)))
            for name, value in options.items():
                self.assertAlmostEqual(float(value.rstrip("%")), float(str(values[name]).rstrip("%")), delta=1e-9)

    def test_options_that_are_given_win(self):
        given = ("--extra-seeds", "3n", "--mesh-format", "obj", "--min-share", "0.01")
        others = [word for i, word in enumerate(TRAINING) if TRAINING[i - i % 2] not in given]
        self.assertEqual(tree(self.broke(*given, *WITHOUT, "--preset", "training")), tree(self.broke(*others, *given)))

    def meshes(self, out):
        with open(os.path.join(out, "manifest.json")) as file:
            fragments = json.load(file)["fragments"]
        return fragments, [read_triangles(os.path.join(out, f["files"]["mesh"])) for f in fragments]

    def shared(self, out):
        """The share of the vertices of cracks that are another fragment's, bit for bit."""
        all_, same = 0, 0
        keys = [{tuple(v) for v in vertices} for vertices, _, _ in self.meshes(out)[1]]
        for i, (vertices, faces, neighbor) in enumerate(self.meshes(out)[1]):
            others = set().union(*keys[:i], *keys[i + 1:])
            cracked = np.unique(faces[neighbor != 0])
            all_ += len(cracked)
            same += sum(tuple(vertices[v]) in others for v in cracked)
        self.assertGreater(all_, 300)
        return same / all_

    def test_no_vertex_is_a_neighbors(self):
        for mesh in self.ball, AMPHORA:
            for seed in "0", "1", "2":
                with self.subTest(mesh=mesh, seed=seed):
                    self.assertEqual(self.shared(self.broke("--preset", "training", "--seed", seed, mesh=mesh)), 0)
        self.assertEqual(self.shared(self.broke("--preset", "training", "--interface", "shared", *WITHOUT)), 1)

    def test_a_surface_that_shares_vertices_is_reported(self):
        words = "--surface makes neighbors share vertices"
        for surface, more, given in (
            ("labels", (), False), ("labels", ("--scan-noise", "0%"), True), ("exact", (), True), ("smooth", (), False),
            ("labels", ("--interface", "shared"), False),
        ):
            with self.subTest(surface=surface, more=more):
                out = self.path(f"out{len(os.listdir(self.tmp))}")
                run = self.run_sherd("fracture", self.ball, "-o", out, "--resolution", "24", "--pieces", "3", "--preset", "training", "--surface", surface, *more)
                self.assertEqual(run.returncode, 0, run.stderr)
                self.assertEqual(words in run.stderr, given, run.stderr)

    def flatness(self, out):
        """Of each contact the extent across its plane relative to its largest, by principal axes."""
        found = []
        for vertices, faces, neighbor in self.meshes(out)[1]:
            for other in set(neighbor[neighbor != 0]):
                at = vertices[np.unique(faces[neighbor == other])]
                if len(at) >= 12:
                    extents = np.linalg.svd(at - at.mean(0), compute_uv=False)
                    found.append(extents[2] / extents[0])
        return found

    def test_cracks_are_no_planes_and_sizes_are_uneven(self):
        """Medians and means of 8 fractures, beside those of the default."""
        ratios, largest = {}, {}
        for name, preset in ("default", ()), ("training", ("--preset", "training")):
            ratios[name], largest[name] = [], []
            for seed in range(8):
                out = self.broke("--write", "labels,mesh", "--seed", str(seed), *preset)
                ratios[name] += self.flatness(out)
                shares = [f["share"] for f in self.meshes(out)[0]]
                self.assertGreaterEqual(min(shares), 0.002 if preset else 0)
                largest[name].append(max(shares))
        self.assertLess(np.median(ratios["default"]), 0.02)
        self.assertGreater(np.median(ratios["training"]), 0.05)
        self.assertGreater(np.mean(largest["training"]), np.mean(largest["default"]))

    def test_meshes_are_closed_bodies(self):
        for fragment in self.broken("--preset", "training")["fragments"]:
            vertices, faces, _ = self.mesh(fragment["files"]["mesh"])
            self.assertAlmostEqual(volume(vertices, faces) / fragment["volume"], 1, delta=1e-4)


class WrongValues(SurfaceCase):
    def test_one_sentence_and_status_2(self):
        wrong = {"--surface": ("", "Labels", "cubes"), "--preset": ("", "Paper", "release"),
                 "--smoothing": ("", "Taubin", "cotangent"),
                 "--smooth-iterations": ("", "-1", "1001", "1.5", "k", "1.5k", "-0.1k", "nan", "0.1n"),
                 "--smooth-boundary-iterations": ("", "-1", "nank", "2 k"),
                 "--smooth-weight": ("", "-0.1", "1.1", "nan"), "--smooth-boundary-weight": ("x", "2"),
                 "--triangles": ("", "3", "-4", "1e3", "100,x", "100,100", "1000000001")}
        for option, texts in wrong.items():
            for text in texts:
                with self.subTest(option=option, text=text):
                    self.refused(2, self.fracture(option + "=" + text))
                    self.nothing_written()


class SameBytes(SurfaceCase):
    def test_whatever_runs_them(self):
        trees = []
        for i, threads in enumerate(("1", "2", "2")):
            out = self.path(f"out{i}")
            result = self.run_sherd("fracture", AMPHORA, "-o", out, "--preset", "paper", "--resolution", "64",
                                    "--write", "mesh", "--triangles", "1000,200", "--threads", threads)
            self.assertEqual(result.returncode, 0, result.stderr)
            trees.append(tree(out))
        self.assertEqual(len([n for n in trees[0] if n.endswith(".ply")]), 8 * 3)
        self.assertEqual(trees[0], trees[1])
        self.assertEqual(trees[1], trees[2])


if __name__ == "__main__":
    skipping.main()
