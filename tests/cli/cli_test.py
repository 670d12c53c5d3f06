#!/usr/bin/python3
"""The program end to end: what it writes, and what it says when it is used wrongly.

SHERD_BIN names the program.  The meshes are made here.  Needs Debian's python3-numpy and python3-openvdb.

A full disk is a limit on the size of files and, where this process may mount one, a tiny tmpfs.
"""
import hashlib
import json
import math
import os
import pty
import resource
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest

import numpy as np

import manifests
import skipping

# A shell starts jobs in the background with SIGINT ignored, and the program would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

SHERD = os.environ["SHERD_BIN"]
SCHEMA = "sherd-report/1"


def sphere(rows=24, columns=48, center=(0.0, 0.0, 0.0), radius=1.0):
    """Vertices and triangles of a closed ball, counter-clockwise seen from outside."""
    v = [(0, 0, 1)]
    for i in range(1, rows):
        for j in range(columns):
            t, p = math.pi * i / rows, 2 * math.pi * j / columns
            v.append((math.sin(t) * math.cos(p), math.sin(t) * math.sin(p), math.cos(t)))
    v.append((0, 0, -1))

    def at(i, j):
        return 1 + (i - 1) * columns + j % columns

    f = [(0, at(1, j), at(1, j + 1)) for j in range(columns)]
    for i in range(1, rows - 1):
        for j in range(columns):
            f += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    f += [(at(rows - 1, j), len(v) - 1, at(rows - 1, j + 1)) for j in range(columns)]
    return [tuple(c + radius * x for c, x in zip(center, p)) for p in v], f


def joined(*meshes):
    v, f = [], []
    for mv, mf in meshes:
        f += [tuple(i + len(v) for i in t) for t in mf]
        v += mv
    return v, f


def all_contacts(fragment):
    """The contacts of a fragment of a manifest, those too that are thinner than a voxel."""
    return fragment["contacts"] + fragment.get("thin_contacts", [])


def write_obj(path, mesh):
    with open(path, "w") as out:
        out.writelines(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in mesh[0])
        out.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in mesh[1])


def write_spread_seeds(path, count, center, radius):
    """Seeds on a spiral around a ball at six tenths of its radius: each fragment has a blunt shape."""
    with open(path, "w") as out:
        seeds = []
        for i in range(count):
            z, turn = 1 - (2 * i + 1) / count, i * math.pi * (3 - math.sqrt(5))
            at = (math.sqrt(1 - z * z) * math.cos(turn), math.sqrt(1 - z * z) * math.sin(turn), z)
            seeds.append({"fragment": i + 1, "position": [c + 0.6 * radius * a for c, a in zip(center, at)]})
        json.dump({"schema": "sherd-seeds/1", "seeds": seeds}, out)


def write_stl(path, mesh):
    v, f = mesh
    with open(path, "wb") as out:
        out.write(bytes(80) + struct.pack("<I", len(f)))
        for t in f:
            out.write(struct.pack("<12fH", 0, 0, 0, *[x for i in t for x in v[i]], 0))


def tree(folder):
    """Every file below, with the SHA-256 of its bytes; folders end in a slash."""
    found = {}
    for at, folders, files in os.walk(folder):
        for name in folders:
            found[os.path.relpath(os.path.join(at, name), folder) + "/"] = ""
        for name in files:
            path = os.path.join(at, name)
            with open(path, "rb") as data:
                found[os.path.relpath(path, folder)] = hashlib.sha256(data.read()).hexdigest()
    return found


class CommandLine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.data = tempfile.mkdtemp(prefix="sherd-cli-data-")
        cls.addClassCleanup(shutil.rmtree, cls.data)
        cls.ball = os.path.join(cls.data, "ball.obj")
        write_obj(cls.ball, sphere())

    def setUp(self):
        self.tmp = tempfile.mkdtemp(prefix="sherd-cli-")
        self.addCleanup(shutil.rmtree, self.tmp)
        self.out = os.path.join(self.tmp, "out")

    def path(self, name, data=None):
        path = os.path.join(self.tmp, name)
        if data is not None:
            with open(path, "wb") as file:
                file.write(data)
        return path

    def run_sherd(self, *arguments, **more):
        more = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "timeout": 120, **more}
        result = subprocess.run([SHERD, *arguments], **more)
        manifests.check_run(arguments, result.returncode, more.get("cwd"))
        return result

    def fracture(self, *arguments, mesh=None, out=None, pieces=3, **more):
        return self.run_sherd("fracture", mesh or self.ball, "-o", out or self.out, "--pieces", str(pieces),
                              "--resolution", "32", *arguments, **more)

    def done(self, *arguments, **more):
        result = self.fracture(*arguments, **more)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def manifest(self, folder=None):
        with open(os.path.join(folder or self.out, "manifest.json")) as file:
            return json.load(file)

    def written(self, kinds, *arguments, **more):
        """The manifest of a fracture with files of these kinds."""
        self.done("--write", kinds, *arguments, **more)
        return self.manifest(more.get("out"))

    def refused(self, status, result, *words):
        """One sentence on stderr, nothing on stdout, the right exit status."""
        self.assertEqual(result.returncode, status, result.stderr)
        self.assertEqual(result.stdout or "", "")
        self.assertRegex(result.stderr, r"\Asherd: [^\n]{8,}[^\n.]\n\Z")
        for word in words:
            self.assertIn(word, result.stderr)

    def nothing_written(self):
        self.assertFalse(os.path.lexists(self.out))


class Help(CommandLine):
    def test_version(self):
        result = self.run_sherd("--version")
        self.assertRegex(result.stdout, r"\Asherd \d+\.\d+\.\d+ \((Apache-2\.0|GPL-3\.0-or-later)\)\n\Z")
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_help_names_the_commands_and_statuses(self):
        result = self.run_sherd("--help")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for word in ("fracture", "inspect", "devices", "130 interrupted"):
            self.assertIn(word, result.stdout)

    def test_help_of_fracture_shows_defaults_and_ranges(self):
        result = self.run_sherd("fracture", "--help")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for word in ("--pieces", "=8", "1..65534", "--seed", "=0", "--resolution", "=auto", "auto|8..4096", "--voxel-size",
                     "mesh's own unit", "--write", "labels,vdb,mesh,preview", "--device", "=auto", "--json", "--quiet"):
            self.assertIn(word, result.stdout)


class Fracture(CommandLine):
    def test_writes_what_the_manifest_lists_and_nothing_else(self):
        self.done()
        with open(os.path.join(self.out, "manifest.json")) as file:
            manifest = json.load(file)
        self.assertEqual(manifest["schema"], "sherd/2")
        files = {name for name in tree(self.out) if not name.endswith("/")}
        self.assertEqual(files, set(manifest["files"]) | {"manifest.json"})
        self.assertEqual(len(manifest["files"]), 1 + 3 + 3 + 1)
        self.assertEqual([f["id"] for f in manifest["fragments"]], [1, 2, 3])
        self.assertAlmostEqual(sum(f["share"] for f in manifest["fragments"]), 1.0, places=12)
        self.assertNotIn("pieces_asked", manifest)

    def test_same_seed_same_bytes(self):
        self.done("--seed", "5")
        self.done("--seed", "5", "--threads", "1", out=self.path("again"))
        self.done("--seed", "6", out=self.path("other"))
        self.assertEqual(tree(self.out), tree(self.path("again")))
        self.assertNotEqual(tree(self.out), tree(self.path("other")))

    def test_writes_only_what_was_asked_for(self):
        self.done("--write", "labels,mesh")
        self.assertEqual({n.split("/")[0] for n in tree(self.out)}, {"manifest.json", "labels.rle", "meshes"})

    def test_labels_fill_the_grid_and_agree_with_the_manifest(self):
        self.done("--write", "labels")
        with open(os.path.join(self.out, "manifest.json")) as file:
            manifest = json.load(file)
        with open(os.path.join(self.out, "labels.rle"), "rb") as file:
            raw = file.read()
        dims = np.frombuffer(raw, "<u4", 3)
        runs = np.frombuffer(raw, np.dtype([("label", "<u2"), ("run", "<u4")]), offset=12)
        self.assertEqual(list(dims), manifest["grid"]["dims"])
        self.assertEqual(int(runs["run"].sum()), int(dims.prod()))
        counts = np.bincount(runs["label"], runs["run"], 5).astype(int)
        self.assertEqual(list(counts[2:]), [f["voxels"] for f in manifest["fragments"]])
        self.assertEqual(counts[1], 0)

    def test_level_sets_are_openvdbs(self):
        import pyopenvdb as vdb
        self.done("--seed", "18446744073709551615")
        with open(os.path.join(self.out, "manifest.json")) as file:
            manifest = json.load(file)
        for fragment in manifest["fragments"]:
            path = os.path.join(self.out, fragment["files"]["vdb"])
            self.assertTrue(vdb.readMetadata(path)["creator"].startswith("sherd "))
            grid = vdb.read(path, "surface")
            self.assertEqual(grid.gridClass, vdb.GridClass.LEVEL_SET)
            self.assertGreater(grid.background, 0)
            self.assertEqual(grid["piece"], f"piece{fragment['id']}")
            self.assertEqual(grid["fragment_id"], fragment["id"])
            self.assertEqual(list(grid["pivot"]), fragment["centroid"])
            self.assertEqual(grid["volume"], fragment["volume"])
            self.assertEqual(grid["seed"], "18446744073709551615")
            self.assertEqual(grid["source"], "ball.obj")

    def test_json_is_exactly_one_object(self):
        report = json.loads(self.done("--json", "--seed", "9").stdout)
        self.assertEqual(report["schema"], SCHEMA)
        self.assertEqual((report["seed"], report["fragments"], report["components"]), (9, 3, 1))
        self.assertAlmostEqual(report["volume_out"] / report["volume_in"], 1.0, delta=0.02)
        self.assertGreaterEqual(report["seconds"]["total"], report["seconds"]["write"])

    def test_quiet_says_nothing(self):
        result = self.done("--quiet")
        self.assertEqual((result.stdout, result.stderr), ("", ""))

    def test_no_progress_off_a_terminal(self):
        self.assertEqual(self.done().stderr, "")

    def test_progress_on_a_terminal(self):
        master, slave = pty.openpty()
        result = self.fracture("--json", stderr=slave)
        os.close(slave)
        seen = os.read(master, 100000).decode()
        os.close(master)
        self.assertEqual(result.returncode, 0)
        self.assertIn("%", seen)
        self.assertTrue(seen.endswith("\r\x1b[K"))
        json.loads(result.stdout)

    def test_voxel_size_sets_the_grid(self):
        result = self.run_sherd("fracture", self.ball, "-o", self.out, "--voxel-size", "0.125", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)["voxel_size"], 0.125)
        with open(os.path.join(self.out, "manifest.json")) as file:
            manifest = json.load(file)
        options = manifest["options"]
        self.assertEqual((options["pieces"], options["seed"], options["voxel_size"]), (8, 0, 0.125))
        self.assertNotIn("resolution", options)
        self.assertEqual(manifest["grid"]["resolution"], 16)

    def test_more_parts_than_pieces_warns(self):
        mesh = self.path("two.obj")
        write_obj(mesh, joined(sphere(), sphere(center=(4, 0, 0)), sphere(center=(2, 0, 0), radius=0.1)))
        result = self.run_sherd("fracture", mesh, "-o", self.out, "--pieces", "1", "--resolution", "96")
        self.assertEqual(result.returncode, 0, result.stderr)
        warnings = result.stderr.splitlines()
        self.assertEqual(len(warnings), 2)
        self.assertRegex(warnings[0], r"^sherd: warning: .*2 components")
        self.assertRegex(warnings[1], r"^sherd: warning: .*1 component under 27 voxels")
        with open(os.path.join(self.out, "manifest.json")) as file:
            manifest = json.load(file)
        self.assertEqual((manifest["pieces_asked"], manifest["components"], manifest["small_components"]["count"]), (1, 2, 1))


class Resolution(CommandLine):
    """A pane of 64 x 64 x 0.7: its wall has a voxel and a half at 1.5 * 64 / 0.7 = 137.1, and the next multiple of 8 is 144."""

    def setUp(self):
        super().setUp()
        vertices = [(x, y, z) for x in (0, 64) for y in (0, 64) for z in (0, 0.7)]
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        self.pane = self.path("pane.obj", "".join(
            ["v %g %g %g\n" % v for v in vertices] + ["f %d %d %d %d\n" % tuple(i + 1 for i in f) for f in faces]).encode())

    def broken(self, name, *arguments, mesh=None):
        out = self.path(name)
        done = self.run_sherd("fracture", mesh or self.pane, "-o", out, "--pieces", "2", "--write", "labels", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return out, done.stdout

    def test_is_chosen_for_the_mesh(self):
        out, said = self.broken("chosen")
        self.assertIn("resolution 144, chosen automatically: walls would be down to 1.4 voxels at 128\n", said)
        manifest = self.manifest(out)
        self.assertEqual((manifest["options"]["resolution"], manifest["grid"]["resolution"]), ("auto", 144))
        self.assertEqual(manifest["report"]["resolution"]["automatic"], True)
        self.assertNotIn("resolution_to_hold", manifest["report"]["walls"])
        asked, _ = self.broken("asked", "--resolution", "auto")
        self.assertEqual(tree(asked), tree(out))
        given, said = self.broken("given", "--resolution", "144")
        self.assertNotIn("automatically", said)
        self.assertEqual(tree(given)["labels.rle"], tree(out)["labels.rle"])
        self.assertEqual(self.manifest(given)["options"]["resolution"], 144)
        for folder, how in ((out, "auto"), (given, "given")):
            seen = json.loads(self.run_sherd("inspect", folder, "--json").stdout)
            self.assertEqual((seen["resolution"], seen["resolution_is"]), (144, how))

    def test_stays_where_it_was(self):
        for name, arguments, mesh in (("ball", (), self.ball), ("paper", ("--preset", "paper"), self.pane),
                                      ("shell", ("--fill", "shell"), self.pane)):
            out, said = self.broken(name, *arguments, mesh=mesh)
            self.assertEqual(self.manifest(out)["grid"]["resolution"], 128, name)
            self.assertEqual("automatically" in said, name != "paper")

    def test_is_chosen_for_each_object_of_a_dataset(self):
        library = self.path("library")
        os.mkdir(library)
        shutil.copy(self.pane, library)
        shutil.copy(self.ball, library)
        done = self.run_sherd("dataset", library, "-o", self.out, "--pieces", "2", "--repeats", "1", "--write", "labels")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = {}
        for at, _, files in os.walk(self.out):
            if "manifest.json" in files:
                manifest = self.manifest(at)
                self.assertEqual(manifest["options"]["resolution"], "auto")
                found[manifest["source"]["file"]] = manifest["grid"]["resolution"]
        self.assertEqual(found, {"pane.obj": 144, "ball.obj": 128})

    def test_short_memory_names_the_one_to_ask_for(self):
        self.refused(2, self.run_sherd("fracture", self.pane, "-o", self.out, "--max-memory", "210M", "--adaptivity", "0", "--seeds-on", "volume"),
                     "a resolution of ", "one of 144, which the mesh's walls need,", " may be used (--resolution, --write, --max-memory)\n")
        self.nothing_written()

    def test_a_shell_is_no_thicker_than_the_mesh_is_long(self):
        for thickness in ("64.1", "1e9"):
            self.refused(2, self.run_sherd("fracture", self.pane, "-o", self.out, "--shell-thickness", thickness), "to 64, the mesh")


class WrongUse(CommandLine):
    def test_no_command(self):
        self.refused(2, self.run_sherd())

    def test_unknown_command(self):
        self.refused(2, self.run_sherd("fractur"))

    def test_no_mesh(self):
        self.refused(2, self.run_sherd("fracture", "-o", self.out))

    def test_no_output(self):
        self.refused(2, self.run_sherd("fracture", self.ball))

    def test_values_out_of_range(self):
        for wrong in (["--pieces", "0"], ["--pieces", "-1"], ["--pieces", "65535"], ["--pieces", "many"],
                      ["--pieces", "3.5"], ["--pieces", "99999999999999999999"],
                      ["--resolution", "0"], ["--resolution", "7"], ["--resolution", "4097"], ["--resolution", "1e9"],
                      ["--voxel-size", "0"], ["--voxel-size", "-1"], ["--voxel-size", "nan"], ["--voxel-size", "inf"],
                      ["--seed", "-1"], ["--seed", "18446744073709551616"], ["--seed", ""],
                      ["--threads", "0"], ["--write", "labels,all"], ["--device", "no-such-device"],
                      ["--resolution", "64", "--voxel-size", "0.1"], ["--frobnicate"]):
            with self.subTest(wrong=wrong):
                status = 4 if wrong[0] == "--device" else 2
                self.refused(status, self.run_sherd("fracture", self.ball, "-o", self.out, *wrong))
                self.nothing_written()

    def test_decimal_means_decimal(self):
        self.done("--seed", "010", "--write", "labels")
        with open(os.path.join(self.out, "manifest.json")) as file:
            self.assertEqual(json.load(file)["options"]["seed"], 10)

    def test_voxel_sizes_that_cannot_be(self):
        for size in ("1e-9", "1e9"):
            result = self.run_sherd("fracture", self.ball, "-o", self.out, "--voxel-size", size)
            self.refused(result.returncode, result)
            self.assertIn(result.returncode, (2, 3))
            self.nothing_written()

    def test_more_pieces_than_voxels(self):
        self.refused(2, self.run_sherd("fracture", self.ball, "-o", self.out, "--resolution", "8", "--pieces", "5000"))
        self.nothing_written()

    def test_bad_meshes(self):
        ball = sphere()
        write_stl(self.path("ball.stl"), ball)
        with open(self.path("ball.stl"), "rb") as file:
            stl = file.read()
        with open(self.ball, "rb") as file:
            obj = file.read()
        cases = {
            "absent": (self.path("absent.obj"), "absent.obj"),
            "a folder": (self.data, self.data),
            "a folder that is named like a mesh": (self.path("folder.obj"), "folder.obj"),
            "unknown format": (self.path("ball.xyz", obj), "ball.xyz"),
            "no extension": (self.path("ball", obj), "ball"),
            "empty": (self.path("empty.obj", b""), "empty.obj"),
            "truncated STL": (self.path("cut.stl", stl[:len(stl) // 2]), "cut.stl"),
            "truncated by a byte": (self.path("byte.stl", stl[:-1]), "byte.stl"),
            "nowhere finite": (self.path("inf.stl", stl[:80] + struct.pack("<I12f", 1, *[math.inf] * 12) + b"\0\0"), "inf.stl"),
        }
        os.mkdir(self.path("folder.obj"))
        for name, (mesh, word) in cases.items():
            with self.subTest(name):
                self.refused(3, self.fracture(mesh=mesh), word)
                self.nothing_written()


    def test_vertices_that_are_not_finite_are_dropped(self):
        ball = sphere()
        write_stl(self.path("ball.stl"), ball)
        with open(self.path("ball.stl"), "rb") as file:
            stl = file.read()
        for name, value in (("nan", math.nan), ("inf", math.inf)):
            with self.subTest(name):
                mesh = self.path(name + ".stl", stl[:96] + struct.pack("<f", value) + stl[100:])
                done = self.fracture("--json", mesh=mesh)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn("1 vertices are not finite", done.stderr)
                self.assertEqual(json.loads(done.stdout)["report"]["boundary_edges"], 3)


class Folder(CommandLine):
    def test_absent_parents_are_made(self):
        self.done(out=os.path.join(self.out, "a", "b"))
        self.assertIn("manifest.json", tree(os.path.join(self.out, "a", "b")))

    def test_empty_is_filled(self):
        os.mkdir(self.out)
        self.done()

    def test_ours_is_replaced_and_foreign_files_stay(self):
        self.done(pieces=5)
        with open(os.path.join(self.out, "notes.txt"), "w") as file:
            file.write("mine")
        self.done("--write", "labels,vdb", pieces=2)
        names = set(tree(self.out))
        self.assertEqual(names, {"manifest.json", "labels.rle", "fragments/", "fragments/ball_001.vdb",
                                 "fragments/ball_002.vdb", "notes.txt"})

    def test_a_manifest_cannot_make_it_remove_files_of_others(self):
        self.done()
        manifest = os.path.join(self.out, "manifest.json")
        with open(manifest) as file:
            listed = json.load(file)
        mine = ("notes.txt", "meshes/mine.ply", "meshes/notes.txt", "photos/me.png")
        listed["files"] += mine
        os.mkdir(os.path.join(self.out, "photos"))
        for name in (*mine, "manifest.json"):
            with open(os.path.join(self.out, name), "w") as file:
                file.write(json.dumps(listed) if name == "manifest.json" else "mine")
        result = self.done("--json", pieces=2)
        self.assertEqual(set(mine) - set(tree(self.out)), set())
        self.assertNotIn("meshes/ball_003.ply", tree(self.out))
        self.assertRegex(result.stderr, r"\Asherd: warning: [^\n]*'notes.txt', 'meshes/mine.ply', 'meshes/notes.txt', "
                                        r"'photos/me.png'[^\n]* stay\n\Z")
        self.assertEqual([f"sherd: warning: {warning}\n" for warning in json.loads(result.stdout)["warnings"]],
                         [result.stderr])
        self.assertEqual(self.done(pieces=2).stderr, "")  # it is not listed any more

    def test_foreign_is_refused_before_the_work(self):
        os.mkdir(self.out)
        with open(os.path.join(self.out, "notes.txt"), "w") as file:
            file.write("mine")
        before = tree(self.out)
        self.refused(5, self.fracture(mesh=self.path("absent.obj")), "notes.txt")
        self.assertEqual(tree(self.out), before)

    def test_a_file_is_refused(self):
        self.refused(5, self.fracture(out=self.path("file", b"x")), "file")
        self.refused(5, self.fracture(out=self.path("file", b"x") + "/out"), "file")

    def test_unwritable_is_refused(self):
        # root may write where the bits forbid it, but nobody can make a folder in /proc
        self.refused(5, self.fracture(out="/proc/sherd-out"), "/proc")
        if os.geteuid() != 0:
            os.mkdir(self.out, 0o555)
            self.refused(5, self.fracture(), self.out)

    def test_a_finished_fracture_survives_a_failing_one(self):
        self.done()
        before = tree(self.out)
        self.refused(3, self.fracture(mesh=self.path("bad.obj", b"v 1 2 3\n")))
        self.assertEqual(tree(self.out), before)


class FullDisk(CommandLine):
    def test_file_size_limit(self):
        # PoCL writes about 1 MB of its own, and LLVM ends the process when it cannot: the limit lies between that and
        # the one mesh of 10 MB
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (3_000_000, 3_000_000))
        arguments = ["fracture", self.ball, "-o", self.out, "--pieces", "1", "--resolution", "256", "--write", "mesh", "--surface", "smooth",
                     "--adaptivity", "0"]
        self.refused(5, self.run_sherd(*arguments, preexec_fn=limit), self.out, "file too large after 3")
        self.nothing_written()

    def test_tiny_tmpfs(self):
        os.mkdir(self.out)
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", self.out], capture_output=True)
        if mount.returncode != 0:
            skipping.skip(self, "MOUNT", "no tmpfs can be mounted here; test_file_size_limit alone stands for a full disk")
        self.addCleanup(subprocess.run, ["umount", self.out], check=True)
        self.refused(5, self.fracture(), self.out, "no space left")
        self.assertEqual(tree(self.out), {})
        inside = os.path.join(self.out, "a", "b")
        self.refused(5, self.fracture(out=inside), inside, "no space left")
        self.assertEqual(tree(self.out), {})

    def test_standard_output_full(self):
        with open("/dev/full", "w") as full:
            self.refused(5, self.run_sherd("--version", stdout=full), "standard output")
            self.refused(5, self.run_sherd("inspect", self.ball, stdout=full), "standard output")

    def test_standard_output_closed(self):
        self.refused(5, self.run_sherd("--version", preexec_fn=lambda: os.close(1)), "standard output")
        read, write = os.pipe()
        os.close(read)
        self.refused(5, self.run_sherd("--version", stdout=write), "standard output")
        os.close(write)


class Interruption(CommandLine):
    RESOLUTION = 160

    def start(self, out, resolution=RESOLUTION):
        return subprocess.Popen([SHERD, "fracture", self.ball, "-o", out, "--resolution", str(resolution)],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def wait_until(self, sherd, reached):
        """Whether a run came to a point before it ended."""
        until = time.monotonic() + 60
        while time.monotonic() < until and sherd.poll() is None:
            if reached():
                return True
            time.sleep(0.0005)
        return False

    def listens(self, sherd, number):
        """Whether main() has begun to watch for a signal, which before that kills, as it does any program.  All signals are blocked for a
        moment while a thread begins: SIGUSR1 is not meant."""
        with open(f"/proc/{sherd.pid}/status") as status:
            blocked = next(line for line in status if line.startswith("SigBlk")).split()[1]
        return int(blocked, 16) >> (number - 1) & 1 and not int(blocked, 16) >> (signal.SIGUSR1 - 1) & 1

    def interrupt(self, number, seconds, out, resolution=RESOLUTION):
        sherd = self.start(out, resolution)
        self.wait_until(sherd, lambda: self.listens(sherd, number))
        time.sleep(seconds)
        sherd.send_signal(number)
        said, err = sherd.communicate(timeout=60)
        return sherd.returncode, said, err

    @staticmethod
    def is_writing(out):
        """Whether pieces lie in the hidden folder, which are moved when all are there."""
        try:
            return bool(os.listdir(os.path.join(out, ".sherd-partial", "new", "fragments")))
        except FileNotFoundError:
            return False

    def assert_interrupted(self, status, said, err):
        self.assertEqual((status, said), (130, ""), err)
        self.assertRegex(err, r"\Asherd: interrupted[^\n]*\n\Z")

    def test_nothing_is_left_half_written(self):
        self.done()  # the device's kernels are built
        started = time.monotonic()
        whole = self.path("whole")
        self.assertEqual(self.run_sherd("fracture", self.ball, "-o", whole, "--resolution", str(self.RESOLUTION)).returncode, 0)
        length = time.monotonic() - started
        statuses = []
        for i in range(12):
            number = (signal.SIGINT, signal.SIGTERM)[i % 2]
            out = self.path(f"out{i}")
            status, said, err = self.interrupt(number, length * i / 12, out)
            statuses.append(status)
            if status == 0:
                self.assertEqual(tree(out), tree(whole))
                continue
            self.assertFalse(os.path.lexists(out))
            if status != -number:  # before main() begins the signal itself ends the process
                self.assert_interrupted(status, said, err)
        self.assertGreaterEqual(statuses.count(130), 6, statuses)

    def test_a_signal_while_pieces_are_written(self):
        """Until three were hit: the machine may take a run past its writing between a look and the signal."""
        self.done()
        before, hits = tree(self.out), 0
        for _ in range(30):
            sherd = self.start(self.out)
            if self.wait_until(sherd, lambda: self.is_writing(self.out)):
                sherd.send_signal(signal.SIGINT)
            said, err = sherd.communicate(timeout=60)
            if sherd.returncode == 0:
                shutil.rmtree(self.out)
                self.done()
                continue
            self.assert_interrupted(sherd.returncode, said, err)
            self.assertEqual(tree(self.out), before)
            hits += 1
            if hits == 3:
                return
        self.fail(f"{hits} of 30 runs were hit while they wrote")

    def test_an_old_fracture_survives(self):
        self.done()
        before = tree(self.out)
        for seconds in (0.0, 0.1, 0.3):
            status, said, err = self.interrupt(signal.SIGINT, seconds, self.out, 400)
            self.assert_interrupted(status, said, err)
            self.assertEqual(tree(self.out), before)

    def test_a_killed_run_is_cleared_up_by_the_next(self):
        self.done(out=self.path("whole"))
        hits = 0
        for _ in range(30):
            sherd = self.start(self.out)
            if self.wait_until(sherd, lambda: self.is_writing(self.out)):
                sherd.kill()
            sherd.communicate()
            hits += sherd.returncode == -signal.SIGKILL
            self.done()
            self.assertEqual(tree(self.out), tree(self.path("whole")))
            if hits == 3:
                return
        self.fail(f"{hits} of 30 runs were killed while they wrote")


class Inspect(CommandLine):
    def report(self, path):
        result = self.run_sherd("inspect", path, "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        report = json.loads(result.stdout)
        self.assertEqual((report["schema"], report["command"]), (SCHEMA, "inspect"))
        text = self.run_sherd("inspect", path)
        self.assertEqual((text.returncode, text.stderr), (0, ""))
        self.assertGreater(len(text.stdout.splitlines()), 2)
        return report

    def test_mesh(self):
        report = self.report(self.ball)
        self.assertEqual((report["vertices"], report["triangles"]), (2 + 23 * 48, 2 * 23 * 48))
        self.assertEqual((self.edges(report), report["components"]), ((True, 0, 0, 0), 1))
        self.assertAlmostEqual(report["volume"], 4 / 3 * math.pi, delta=0.05)
        for low, high in zip(report["box_min"], report["box_max"]):
            self.assertAlmostEqual(high - low, 2, delta=0.01)

    @staticmethod
    def edges(report):
        return tuple(report[key] for key in ("closed", "boundary_edges", "non_manifold_edges", "misoriented_edges"))

    def test_edges_have_their_kinds(self):
        """A missing triangle, a flipped one, and a fin of two triangles of which one stands on an edge of the mesh."""
        v, f = sphere()
        fin = [(f[0][0], f[0][1], len(v)), (f[0][1], len(v) + 1, len(v))]
        for name, mesh, edges in (("open", (v, f[1:]), (False, 3, 0, 0)), ("flipped", (v, [f[0][::-1], *f[1:]]), (False, 0, 0, 3)),
                                  ("fin", ([*v, (0, 0, 0), (0, 0.1, 0.2)], [*f, *fin]), (False, 3, 1, 0)),
                                  ("double", (v, [*f, f[0], f[0][::-1]]), (True, 0, 3, 0))):
            path = self.path(name + ".obj")
            write_obj(path, mesh)
            self.assertEqual(self.edges(self.report(path)), edges, name)
        result = self.done("--surface", "exact", mesh=self.path("fin.obj"))
        self.assertIn("fin.obj: 1 hole was closed without faces that are left\n", result.stderr, "the fin encloses nothing")

    def test_what_a_fracture_wrote(self):
        self.done()
        with open(os.path.join(self.out, "manifest.json")) as file:
            manifest = json.load(file)
        labels = self.report(os.path.join(self.out, "labels.rle"))
        self.assertEqual(labels["dims"], manifest["grid"]["dims"])
        self.assertEqual({k: v for k, v in labels["voxels_per_label"].items() if k != "0"},
                         {str(f["id"] + 1): f["voxels"] for f in manifest["fragments"]})
        grid = self.report(os.path.join(self.out, "fragments/ball_002.vdb"))["grids"][0]
        self.assertEqual((grid["name"], grid["class"]), ("surface", "level set"))
        self.assertEqual(grid["metadata"]["piece"], "piece2")
        self.assertTrue(self.report(os.path.join(self.out, "meshes/ball_001.ply"))["closed"])
        for path in (self.out, os.path.join(self.out, "manifest.json")):
            report = self.report(path)
            self.assertEqual([f["voxels"] for f in report["fragments"]], [f["voxels"] for f in manifest["fragments"]])

    def test_wrong_use(self):
        self.done()
        with open(os.path.join(self.out, "fragments/ball_001.vdb"), "rb") as file:
            vdb = file.read()
        for path in (self.path("absent.rle"), self.path("absent.vdb"), self.path("absent"), self.data,
                     self.path("a.rle", b"abc"), self.path("a.vdb", b"abc"), self.path("cut.vdb", vdb[:-9]),
                     self.path("a.json", b"{"), self.path("b.json", b'{"schema": "sherd/2"}'),
                     self.path("c.json", b'{"schema": "sherd/2", "grid": 3, "fragments": 4}')):
            with self.subTest(path):
                self.refused(3, self.run_sherd("inspect", path), path)


class Devices(CommandLine):
    def test_json(self):
        result = self.run_sherd("devices", "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        report = json.loads(result.stdout)
        self.assertEqual((report["schema"], report["command"]), (SCHEMA, "devices"))
        self.assertEqual(sum(d["chosen"] for d in report["devices"]), min(1, len(report["devices"])))

    def test_text(self):
        result = self.run_sherd("devices")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("OpenCL", result.stdout)


if __name__ == "__main__":
    skipping.main()
