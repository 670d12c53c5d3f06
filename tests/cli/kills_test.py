#!/usr/bin/python3
"""What a run that was killed leaves: the earlier fracture or the new one, whole, for whatever opens the folder next.

SHERD_BIN names the program, SHERD_FAULTS the module that kills it before its n-th call of a kind (tests/faults/faults.h).
A fracture that replaces another is killed before each rename in turn, and before some of all calls that change the folder.
After each kill, copies of the folder are inspected, given to a run that fails on its input, and broken into again.
With SHERD_KILLS=all it is killed before every call that changes the folder, of a fracture with more files, and what
recovers the folder is killed before each such call, too.
"""
import concurrent.futures
import fcntl
import json
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import unittest

import skipping
from cli_test import SHERD, sphere, tree, write_obj
from manifests import check_run

MODULE = os.environ["SHERD_FAULTS"]
ALL = os.environ.get("SHERD_KILLS", "") == "all"
EARLIER = ("--pieces", "3", "--points", "20", "--write", "labels,mesh,seeds")
FRESH = ("--pieces", "2", "--write", "labels,vdb,mesh")
MANY = ("--pieces", "4", "--points", "20", "--sdf-samples", "20", "--mesh-format", "ply,obj,glb", "--write",
        "labels,vdb,mesh,preview,seeds,boundaries,solid,scene,usd,graph,houdini,viewer,proxy")


def spread(count, most):
    """Some of 1..count, the first and the last among them."""
    most = count if ALL else min(count, most)
    return sorted({1 + i * (count - 1) // max(1, most - 1) for i in range(most)})


def shown(folder):
    """What of a folder is not hidden."""
    return {name: file for name, file in tree(folder).items() if not name.startswith(".sherd")}


def files(found):
    """Those of a tree without empty folders, which whatever only reads leaves."""
    return {name: file for name, file in found.items() if not name.endswith("/")}


class Kills(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.tmp = tempfile.mkdtemp(prefix="sherd-kills-")
        cls.addClassCleanup(shutil.rmtree, cls.tmp)
        cls.ball = os.path.join(cls.tmp, "ball.obj")
        write_obj(cls.ball, sphere(8, 16))
        cls.fresh = MANY if ALL else FRESH
        cls.earlier = os.path.join(cls.tmp, "earlier")
        cls.first = os.path.join(cls.tmp, "first")
        cls.made(cls.earlier, EARLIER)
        cls.made(cls.first, cls.fresh)
        cls.add_others(cls.earlier)
        cls.was = tree(cls.earlier)
        replaced = os.path.join(cls.tmp, "replaced")
        shutil.copytree(cls.earlier, replaced)
        cls.made(replaced, cls.fresh)
        cls.whole = tree(replaced)

    @classmethod
    def made(cls, folder, options):
        done = cls.sherd(cls.fracture(folder, options))
        assert done.returncode == 0, done.stderr

    @staticmethod
    def add_others(folder):
        """Files that no fracture made, one of them beside those that one did."""
        for name in ("notes.txt", os.path.join("meshes", "mine.ply")):
            with open(os.path.join(folder, name), "w") as file:
                file.write("mine")

    @classmethod
    def fracture(cls, out, options, mesh=None):
        return ["fracture", mesh or cls.ball, "-o", out, "--resolution", "16", *options]

    @staticmethod
    def sherd(arguments, **fault):
        settings = {"SHERD_FAULT" + ("_" + name.upper() if name != "kind" else ""): str(value)
                    for name, value in fault.items()}
        if fault:
            settings["LD_PRELOAD"] = MODULE
        run = subprocess.run([SHERD, *arguments], env={**os.environ, **settings}, stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, text=True, timeout=300)
        check_run(arguments, run.returncode)
        return run

    def calls(self, arguments, below, kind):
        count = os.path.join(self.tmp, f"count-{kind}")
        done = self.sherd(arguments, kind=kind, at=0, below=below, count=count)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(count) as file:
            return int(file.read())

    def copied(self, source, name):
        folder = os.path.join(self.tmp, name)
        if source:
            shutil.copytree(source, folder, symlinks=True)
        return folder

    def kill(self, arguments, below, kind, number):
        done = self.sherd(arguments, kind=kind, at=number, kill=1, below=below)
        self.assertEqual(done.returncode, -signal.SIGKILL, done.stderr)

    def one_of_both(self, folder, states, of=lambda shown: shown):
        """Which fracture a folder holds, byte for byte."""
        states, now = [of(state) for state in states], of(shown(folder))
        self.assertIn(now, states)
        return states.index(now)

    def look(self, killed, states):
        """What finds the folder next, each in a copy of its own."""
        inspected = self.copied(killed, os.path.basename(killed) + "-inspected")
        report = self.sherd(["inspect", inspected, "--json"])
        if report.returncode == 0:
            held = self.one_of_both(inspected, states, files)
            with open(os.path.join(inspected, "manifest.json")) as file:
                self.assertEqual(len(json.loads(report.stdout)["fragments"]), len(json.load(file)["fragments"]))
        else:  # only where there was none before
            self.assertEqual((report.returncode, states[0]), (3, {}), report.stderr)
            self.assertRegex(report.stderr, r"\Asherd: [^\n]{8,}[^\n.]\n\Z")
            held = 0

        failed = self.copied(killed, os.path.basename(killed) + "-failed")
        result = self.sherd(self.fracture(failed, self.fresh, mesh=os.path.join(self.tmp, "absent.obj")))
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertEqual(self.one_of_both(failed, states), held)
        self.assertEqual(tree(failed), shown(failed))

        result = self.sherd(self.fracture(killed, self.fresh))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(tree(killed), states[1])
        for folder in (inspected, failed):
            shutil.rmtree(folder)
        return held

    def each(self, source, states, kind, most):
        """Kill runs before one call after another, two at a time.  Returns which fracture was found after each."""
        counted = self.copied(source, f"{kind}-counted")
        total = self.calls(self.fracture(counted, self.fresh), counted, kind)
        self.assertEqual(tree(counted), states[1])
        shutil.rmtree(counted)

        def one(number):
            folder = self.copied(source, f"{kind}-{number}")
            self.kill(self.fracture(folder, self.fresh), folder, kind, number)
            if not os.path.isdir(folder):
                os.mkdir(folder)
            try:
                return number, self.look(folder, states), None
            except AssertionError as problem:
                return number, None, problem
            finally:
                shutil.rmtree(folder)

        found = []
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for number, held, problem in pool.map(one, spread(total, most)):
                with self.subTest(kind=kind, number=number, of=total):
                    if problem:
                        raise problem
                    found.append(held)
        print(f"{kind}: {len(found)} kills at {total} calls; then the earlier fracture {found.count(0)} times, "
              f"the new one {found.count(1)} times")
        return found

    def test_an_earlier_fracture_or_the_new_one_is_whole(self):
        states = [self.was, self.whole]
        self.each(self.earlier, states, "rename", 1000)
        self.assertEqual(set(self.each(self.earlier, states, "write", 12)), {0})  # nothing has been moved then
        found = self.each(self.earlier, states, "change", 12)
        self.assertEqual(found, sorted(found))  # one call decides
        self.assertEqual((found[0], found[-1]), (0, 1))

    def test_a_signal_while_files_are_written_and_moved(self):
        """SIGINT before one call after another: all is as it was, with status 130, or all is new, with status 0."""
        statuses = {}
        for kind in "write", "change":
            counted = self.copied(self.earlier, f"signal-{kind}")
            total = self.calls(self.fracture(counted, self.fresh), counted, kind)
            shutil.rmtree(counted)
            for number in spread(total, 12):
                with self.subTest(kind=kind, number=number, of=total):
                    folder = self.copied(self.earlier, f"signal-{kind}-{number}")
                    done = self.sherd(self.fracture(folder, self.fresh), kind=kind, at=number, signal=int(signal.SIGINT), below=folder)
                    self.assertIn(done.returncode, (0, 130), done.stderr)
                    self.assertEqual(tree(folder), self.was if done.returncode else self.whole)
                    statuses.setdefault(kind, []).append(done.returncode)
                    shutil.rmtree(folder)
        # A signal is heard while files are written, and the last moves are not undone for one.
        self.assertEqual(set(statuses["write"][:3]), {130})
        print(f"signals: {[(kind, seen.count(130), len(seen)) for kind, seen in statuses.items()]} ended with 130")

    def test_a_first_fracture_is_whole_or_absent(self):
        found = self.each(None, [{}, tree(self.first)], "change", 6)
        self.assertEqual(found, sorted(found))

    def test_what_recovers_a_folder_may_be_killed_too(self):
        total = self.calls(self.fracture(self.copied(self.earlier, "again"), self.fresh), os.path.join(self.tmp, "again"),
                           "rename")
        with open(os.path.join(self.earlier, "manifest.json")) as manifest:
            moved = len(json.load(manifest)["files"])
        # All of the new fracture is in place but its manifest; all of the old one is aside.
        for number in (total, total - 3) if not ALL else range(total - moved - 3, total + 1):
            killed = self.copied(self.earlier, "killed")
            self.kill(self.fracture(killed, self.fresh), killed, "rename", number)
            for recovers in (["inspect"], ["fracture", os.path.join(self.tmp, "absent.obj"), "-o"]):
                step, result = 0, None
                while result is None or result.returncode == -signal.SIGKILL:
                    step += 1 if ALL else 3
                    folder = self.copied(killed, "recovered")
                    result = self.sherd([*recovers, folder], kind="change", at=step, kill=1, below=folder)
                    self.assertIn(result.returncode, (-signal.SIGKILL, 0, 3), result.stderr)
                    # And the next one is killed early, whatever is left to do.
                    self.sherd(["inspect", folder], kind="change", at=2, kill=1, below=folder)
                    report = self.sherd(["inspect", folder])
                    self.assertEqual(report.returncode, 0, report.stderr)
                    self.assertEqual(files(shown(folder)), files(self.was))
                    shutil.rmtree(folder)
                self.assertGreater(step, 3)
            shutil.rmtree(killed)

    def half_replaced(self, name):
        folder = self.copied(self.earlier, name)
        total = self.calls(self.fracture(self.copied(self.earlier, name + "-counted"), self.fresh),
                           os.path.join(self.tmp, name + "-counted"), "rename")
        self.kill(self.fracture(folder, self.fresh), folder, "rename", total)
        self.assertNotIn("manifest.json", tree(folder))
        return folder

    def test_whatever_reads_a_fracture_finds_it_whole(self):
        half = self.half_replaced("half")
        for number, command in enumerate((("evaluate", "DIR", "--samples", "20"), ("evaluate", "DIR/meshes", "--samples", "20"),
                                          ("render", "DIR", "-o", os.path.join(self.tmp, "x.png"), "--size", "32x32"),
                                          ("render", "DIR/manifest.json", "-o", os.path.join(self.tmp, "y.png"), "--size", "32x32"),
                                          ("inspect", "DIR/manifest.json"))):
            folder = self.copied(half, f"half-{number}")
            os.remove(os.path.join(folder, "meshes", "mine.ply"))  # which is no mesh
            result = self.sherd([argument.replace("DIR", folder) for argument in command])
            self.assertEqual(result.returncode, 0, result.stderr)
            self.add_others(folder)
            self.assertEqual(shown(folder), self.was)

    def test_whatever_writes_beside_a_fracture_finds_it_whole(self):
        """Its files may be hidden by the kill, and are not replaced all the same."""
        half = self.half_replaced("beside")
        mesh = next(name for name in self.was if name.startswith("meshes/") and name.endswith("_001.ply"))
        result = self.sherd(["convert", self.ball, os.path.join(half, mesh)])
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("is listed by the fracture", result.stderr)
        self.assertEqual(shown(half), self.was)

    def test_two_may_read_at_once(self):
        half = self.half_replaced("two")
        partial = os.open(os.path.join(half, ".sherd-partial"), os.O_RDONLY)
        fcntl.flock(partial, fcntl.LOCK_EX)  # the other reader
        threading.Timer(0.4, os.close, [partial]).start()
        result = self.sherd(["inspect", half])
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(shown(half), self.was)

    def test_a_file_is_replaced_or_not(self):
        folder = os.path.join(self.tmp, "file")
        path = os.path.join(folder, "old.stl")
        convert = ["convert", self.ball, path]

        def ready():
            shutil.rmtree(folder, ignore_errors=True)
            os.mkdir(folder)
            with open(path, "w") as out:
                out.write("what was there")
            return tree(folder)["old.stl"]

        was = ready()
        total = self.calls(convert, folder, "change")
        new = tree(folder)["old.stl"]
        self.assertEqual(list(tree(folder)), ["old.stl"])
        found = []
        for number in range(1, total + 1):
            ready()
            self.kill(convert, folder, "change", number)
            found.append(tree(folder)["old.stl"])
        self.assertEqual(found, [was] + [new] * (total - 1))

    def test_what_cannot_be_undone_is_reported_and_kept(self):
        half = self.half_replaced("locked")
        before = tree(half)
        result = self.sherd(["inspect", half], kind="rename", at=2, error=28, below=half)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertRegex(result.stderr, r"\Asherd: [^\n]*: a killed run left its fracture half replaced, which cannot be undone: "
                                        r"[^\n]*no space left on device\n\Z")
        self.assertNotEqual(tree(half), before)
        self.assertNotIn("manifest.json", tree(half))
        self.assertEqual(self.sherd(["inspect", half]).returncode, 0)
        self.assertEqual(tree(half), self.was)

    def test_a_dataset_goes_on_after_a_kill(self):
        library = os.path.join(self.tmp, "library")
        os.mkdir(library)
        for name in ("a.obj", "b.obj"):
            shutil.copy(self.ball, os.path.join(library, name))

        def dataset(out, layout, *more):
            return ["dataset", library, "-o", out, "--pieces", "2", "--repeats", "2", "--resolution", "16", "--layout", layout,
                    *more]

        def made(folder):  # what a run records of itself differs from run to run
            return {name: file for name, file in tree(folder).items() if not name.startswith(("run", "report", "journal/"))}

        for layout in ("sherd", "packed", "hdf5", "pfpp"):
            whole = os.path.join(self.tmp, layout)
            total = self.calls(dataset(whole, layout), whole, "change")
            for number in spread(total * 3 // 4, 3):  # threads that write at once may need a few calls less another time
                out = os.path.join(self.tmp, f"{layout}-{number}")
                self.kill(dataset(out, layout), out, "change", number)
                result = self.sherd(dataset(out, layout, "--resume"))
                with self.subTest(layout=layout, number=number, of=total):
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertEqual(made(out), made(whole))


    def test_shards_are_joined_after_a_kill(self):
        library, shards, whole = (os.path.join(self.tmp, name) for name in ("objects", "shards", "whole"))
        os.mkdir(library)
        for name in ("a.obj", "b.obj"):
            shutil.copy(self.ball, os.path.join(library, name))
        for number in 1, 2:
            done = self.sherd(["dataset", library, "-o", shards, "--pieces", "2", "--repeats", "1", "--resolution", "16", "--layout", "hdf5",
                               "--shard", f"{number}/2", "--resume"])
            self.assertEqual(done.returncode, 0, done.stderr)
        shutil.copytree(shards, whole)

        def merged(folder):  # the report has the date of its run, and its checksum is in a list
            found = {name: file for name, file in tree(folder).items() if name != "report.html"}
            sums = os.path.join(folder, "journal", "SHA256SUMS")
            with open(sums) as lines:
                found["journal/SHA256SUMS"] = [line for line in lines if not line.endswith(" report.html\n")]
            return found

        total = self.calls(["merge", whole], whole, "change")
        for number in range(1, total + 1):
            out = os.path.join(self.tmp, f"merged-{number}")
            shutil.copytree(shards, out)
            self.kill(["merge", out], out, "change", number)
            result = self.sherd(["merge", out])
            with self.subTest(number=number, of=total):
                self.assertEqual(result.returncode, 0, result.stderr)
                found, expected = merged(out), merged(whole)
                self.assertEqual({n for n in found.keys() | expected.keys() if found.get(n) != expected.get(n)}, set())


if __name__ == "__main__":
    skipping.main()
