#!/usr/bin/python3
"""What the program does when a call fails that never fails: a full disk, no memory, a device that refuses.

SHERD_BIN names the program, SHERD_FAULTS the module that lets the n-th call of a kind fail (tests/faults/faults.h).
Every kind of call is counted first.  Of these calls, at most SHERD_FAULTS_EACH (8 by default; all: every one) are made to fail, one
a run, spread evenly from the first to the last.

Not covered: allocations below PoCL and LLVM, which end the process when one of theirs fails, and below Blosc and OpenVDB's
sdfToFogVolume, which use what they did not get; those of less than 4096 bytes, of which there are too many (nlohmann's
JSON, too, allocates when a list is destroyed, and ends the process where it cannot; these are small); standard output,
which cli_test.py fills.  Sherd never calls fsync.
"""
import concurrent.futures
import errno
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
import unittest.mock

import skipping
from cli_test import SHERD, sphere, tree, write_obj
from manifests import check_run

MODULE = os.environ["SHERD_FAULTS"]
EACH = os.environ.get("SHERD_FAULTS_EACH", "8")
FILES = ("write", "open", "close", "rename", "mkdir")
NO_MEMORY = r"not enough memory; try|: no memory for \d+x\d+ pixels; try a|OpenEXR cannot encode it: "
OUT_OF_RESOURCES = -5  # as OpenCL numbers them
BUILD_PROGRAM_FAILURE = -11
EVERYTHING = ("--write", "labels,vdb,mesh,preview,seeds,boundaries,cost,fog,solid,scene,usd,graph,houdini,viewer,proxy", "--voxel-format", "rle,npy,npz,vox,qstack,bing", "--mesh-format",
              "ply,obj,glb,stl", "--points", "20", "--point-format", "ply,xyz,npz", "--sdf-samples", "20",
              "--correspondences", "5", "--vdb", "both", "--triangles", "100")


def spread(count):
    """Some of 1..count, the first and the last among them."""
    most = count if EACH == "all" else min(count, int(EACH))
    return sorted({1 + i * (count - 1) // max(1, most - 1) for i in range(most)})


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.tmp = tempfile.mkdtemp(prefix="sherd-faults-")
        cls.addClassCleanup(shutil.rmtree, cls.tmp)
        cls.ball = os.path.join(cls.tmp, "ball.obj")
        write_obj(cls.ball, sphere(12, 24))
        cls.before = os.path.join(cls.tmp, "before")  # a finished fracture of other pieces, and a stranger's file
        cls.whole = os.path.join(cls.tmp, "whole")
        for out, pieces in ((cls.before, 3), (cls.whole, 2)):
            done = cls.sherd(cls, *cls.fracture(cls, out, pieces))
            assert done.returncode == 0, done.stderr
        with open(os.path.join(cls.before, "notes.txt"), "w") as notes:
            notes.write("mine")

    def fracture(self, out, pieces=2):
        return ("fracture", self.ball, "-o", out, "--pieces", str(pieces), "--resolution", "24", *EVERYTHING)

    def sherd(self, *arguments, stdout=subprocess.PIPE, **fault):
        settings = {"SHERD_FAULT" + ("_" + name.upper() if name != "kind" else ""): str(value)
                    for name, value in fault.items()}
        if fault:
            settings["LD_PRELOAD"] = MODULE
        run = subprocess.run([SHERD, *arguments], env={**os.environ, **settings}, stdout=stdout,
                             stderr=subprocess.PIPE, text=True, timeout=120)
        check_run(arguments, run.returncode)
        return run

    def calls(self, *arguments, **fault):
        """How many calls of a kind a run makes."""
        count = os.path.join(self.tmp, f"count-{os.getpid()}-{id(fault)}")
        done = self.sherd(*arguments, **fault, at=0, count=count)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(count) as file:
            return int(file.read())

    def each(self, make, statuses, says, **fault):
        """Let one call after another fail in runs into folders of their own, two at a time.

        make(folder) gives the arguments.  The folder is made ready by self.ready, and must be as that was afterwards.
        A run may do without what it was refused: then it must have done what others do.  (Clearing up needs memory, too:
        .sherd-partial may then stay, and the next run clears it away.)
        """
        def fresh(name):
            folder = os.path.join(self.tmp, name)
            self.ready(folder)
            return folder

        def fail(number):
            folder = fresh(f"{fault['kind']}-{number}")
            was = tree(folder)
            result = self.sherd(*make(os.path.join(folder, "out")), **fault, below=folder, at=number)
            now = tree(folder)
            shutil.rmtree(folder)
            return number, result, was, now

        counted = fresh("counted")
        total = self.calls(*make(os.path.join(counted, "out")), **fault, below=counted)
        whole = tree(counted)
        shutil.rmtree(counted)
        self.assertGreater(total, 0)
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for number, result, was, now in pool.map(fail, spread(total)):
                with self.subTest(**fault, number=number, of=total):
                    self.assertIn(result.returncode, statuses, result.stderr)
                    if result.returncode == 0:
                        done = {name: file for name, file in now.items() if ".sherd-partial" not in name}
                        self.assertEqual(done, whole)
                        continue
                    self.assertRegex(result.stderr, r"\Asherd: [^\n]{8,}[^\n.]\n\Z")
                    self.assertRegex(result.stderr, says)
                    self.assertEqual(result.stdout, "")
                    self.assertEqual(now, was)

    def ready(self, folder):
        os.mkdir(folder)

    def ready_with_fracture(self, folder):
        os.mkdir(folder)
        shutil.copytree(self.before, os.path.join(folder, "out"))


class Files(Faults):
    def test_an_absent_folder_stays_absent(self):
        for kind in FILES:
            self.each(self.fracture, {5}, "no space left on device", kind=kind, error=errno.ENOSPC)

    def test_an_earlier_fracture_stays(self):
        self.ready = self.ready_with_fracture
        for kind in FILES:
            self.each(self.fracture, {5}, "input/output error", kind=kind, error=errno.EIO)

    def test_short_and_interrupted_writes_go_on(self):
        for number, fault in enumerate(({"kind": "short"}, {"kind": "write", "error": errno.EINTR, "at": 3})):
            out = os.path.join(self.tmp, f"goes-on-{number}")
            result = self.sherd(*self.fracture(out), below=out, **fault)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(tree(out), tree(self.whole))

    def test_datasets_report_it_and_go_on(self):
        library = os.path.join(self.tmp, "library")
        os.mkdir(library)
        shutil.copy(self.ball, library)

        def made(folder):  # what a run records of itself differs from run to run
            return {name: file for name, file in tree(folder).items() if not name.startswith(("run", "report", "journal/"))}

        for layout in "sherd", "packed":
            def dataset(out, *more):
                return ("dataset", library, "-o", out, "--pieces", "2", "--repeats", "3", "--resolution", "24", "--layout", layout, *more)

            whole, short = (os.path.join(self.tmp, f"{layout}-{name}") for name in ("whole", "short"))
            self.assertEqual(self.sherd(*dataset(whole)).returncode, 0)
            result = self.sherd(*dataset(short), kind="short", below=short)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(made(short), made(whole))
            for kind in FILES:
                counted = os.path.join(self.tmp, "counted")
                total = self.calls(*dataset(counted), kind=kind, below=counted)
                shutil.rmtree(counted)
                for number in spread(total):
                    out = os.path.join(self.tmp, f"{layout}-{kind}-{number}")
                    result = self.sherd(*dataset(out), kind=kind, error=errno.ENOSPC, below=out, at=number)
                    with self.subTest(layout=layout, kind=kind, number=number, of=total):
                        if result.returncode != 0:  # threads that write may need fewer calls another time
                            self.assertEqual(result.returncode, 5, result.stderr)
                            self.assertRegex(result.stderr, "no space left on device")
                            again = self.sherd(*dataset(out, *(["--resume"] if os.path.exists(out) else [])))
                            self.assertEqual(again.returncode, 0, again.stderr)
                        self.assertEqual(made(out), made(whole))
                    shutil.rmtree(out)

    def test_pictures_and_tables(self):
        for command in (lambda out: ("render", self.whole, "-o", out + ".png", "--size", "64x64"),
                        lambda out: ("render", self.whole, "-o", out + ".exr", "--size", "64x64"),
                        lambda out: ("view", self.whole, "-o", out + ".html"),
                        lambda out: ("evaluate", self.whole, "--samples", "50", "--csv", out + ".csv"),
                        lambda out: ("evaluate", self.whole, "--samples", "50", "--plot", out + ".svg")):
            for kind in ("write", "open", "close", "rename"):
                self.each(command, {5}, "no space left on device", kind=kind, error=errno.ENOSPC)


class Replacing(Faults):
    """What a standard output that takes nothing leaves, where undoing is not as easy as elsewhere."""

    def refused(self, folder, arguments, **fault):
        with open("/dev/full", "w") as full:
            done = self.sherd(*arguments, stdout=full, **fault, below=folder)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertRegex(done.stderr, r"\Asherd: standard output: no space left on device(; [^\n]*[^\n.])?\n\Z")
        return done.stderr

    def file(self):
        folder = tempfile.mkdtemp(dir=self.tmp)
        path = os.path.join(folder, "old.stl")
        with open(path, "w") as out:
            out.write("what was there")
        return folder, path, ("convert", self.ball, path)

    def test_a_file_system_without_swaps_and_links(self):
        folder, path, convert = self.file()
        was = tree(folder)
        self.refused(folder, convert, kind="plain", at=0)
        self.assertEqual(tree(folder), was)
        self.assertEqual(self.sherd(*convert, kind="plain", at=0, below=folder).returncode, 0)
        now = tree(folder)
        self.assertEqual(list(now), ["old.stl"])
        self.assertNotEqual(now, was)
        # Swaps alone: what is there keeps a second name.
        with open(path, "w") as out:
            out.write("what was there")
        self.refused(folder, convert, kind="rename", at=1, error=errno.EINVAL)
        self.assertEqual(tree(folder), was)

    def test_a_file_that_cannot_be_put_back_is_named(self):
        folder, path, convert = self.file()
        was = tree(folder)["old.stl"]
        said = self.refused(folder, convert, kind="rename", at=2, error=errno.EIO)
        aside = re.search(r"; (\S+) is replaced, and what was there before is (\S+)\n", said)
        self.assertEqual(aside.group(1), path)
        self.assertEqual(tree(folder)[os.path.relpath(aside.group(2), folder)], was)

    def test_a_folder_that_cannot_be_put_back_is_named(self):
        def copied():
            folder = tempfile.mkdtemp(dir=self.tmp)
            shutil.copytree(self.before, os.path.join(folder, "out"))
            return folder, self.fracture(os.path.join(folder, "out"))

        def visible(found):
            return {name: file for name, file in found.items() if ".sherd-partial" not in name}

        folder, arguments = copied()
        was = tree(folder)
        renames = self.calls(*arguments, kind="rename", below=folder)
        new = tree(folder)
        for after, sentence in ((1, "it holds the new fracture"), (2, "the next run, or sherd inspect, restores the earlier fracture")):
            folder, arguments = copied()
            said = self.refused(folder, arguments, kind="rename", at=renames + after, error=errno.EIO)
            self.assertIn("out is not as it was before: ", said)
            self.assertIn(sentence, said)
            self.assertEqual(self.sherd("inspect", os.path.join(folder, "out")).returncode, 0)
            self.assertEqual(visible(tree(folder)), new if after == 1 else was)

    def test_a_signal_ends_what_waits_after_the_result(self):
        """The last step, which removes what was there before, never ends: the result is whole, and printed."""
        folder, path, convert = self.file()
        waits = os.path.join(self.tmp, "waits")
        env = {**os.environ, "LD_PRELOAD": MODULE, "SHERD_FAULT": "unlink", "SHERD_FAULT_AT": "1", "SHERD_FAULT_WAIT": waits,
               "SHERD_FAULT_BELOW": folder}
        process = subprocess.Popen([SHERD, *convert], env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertIn("old.stl", process.stdout.readline())
        until = time.monotonic() + 60
        while not os.path.exists(waits) and time.monotonic() < until:  # or it would be what ends the process that waits
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        try:
            _, said = process.communicate(timeout=30)
        finally:
            process.kill()
        self.assertEqual((process.returncode, said), (0, ""))
        with open(path, "rb") as file:
            self.assertNotEqual(file.read(14), b"what was there")


class Memory(Faults):
    def test_fracture(self):
        self.ready = self.ready_with_fracture

        def without_fog(out):  # see above
            return [argument.replace(",fog", "") for argument in self.fracture(out)]

        for smallest in (4096, 1 << 16):
            self.each(without_fog, {0, 1, 5}, NO_MEMORY, kind="memory", bytes=smallest)

    def test_render_and_evaluate(self):
        for command in (lambda out: ("render", self.whole, "-o", out + ".png", "--size", "64x64"),
                        lambda out: ("render", self.whole, "-o", out + ".exr", "--size", "64x64"),
                        lambda out: ("view", self.whole, "-o", out + ".html"),
                        lambda out: ("evaluate", self.whole, "--samples", "50", "--csv", out + ".csv")):
            self.each(command, {0, 1, 5}, NO_MEMORY, kind="memory", bytes=4096)


    def test_a_library_goes_on_and_tries_the_object_again(self):
        library = os.path.join(self.tmp, "of_two")
        os.mkdir(library)
        for name in "a.obj", "b.obj":
            shutil.copy(self.ball, os.path.join(library, name))

        def dataset(out, *more):
            return ("dataset", library, "-o", os.path.join(self.tmp, out), "--pieces", "2", "--repeats", "1", "--resolution", "24", "--write", "labels", *more)

        def files(out):
            return {name: sum for name, sum in tree(os.path.join(self.tmp, out)).items() if not name.startswith(("journal/", "run", "report"))}

        total = self.calls(*dataset("whole_library"), kind="memory", bytes=20000)
        for tenth in 2, 4, 6:  # an object's work, its images too
            out = f"short_{tenth}"
            result = self.sherd(*dataset(out), kind="memory", bytes=20000, at=total * tenth // 10)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertRegex(result.stderr, r"sherd: [ab]\.obj failed: not enough memory")
            self.assertEqual(self.sherd(*dataset(out, "--resume")).returncode, 0)
            self.assertEqual(files(out), files("whole_library"))


class Device(Faults):
    """An OpenCL driver that fails."""

    def fracture(self, out, pieces=2):
        return (*Faults.fracture(self, out, pieces), "--device", "pocl")

    def test_an_absent_folder_stays_absent(self):
        # Where a program was refused, what is asked of it next fails with a number of its own.
        self.each(self.fracture, {4}, r"with OpenCL error -\d+", kind="device", error=OUT_OF_RESOURCES)

    def test_kernels_that_do_not_build_are_explained(self):
        out = os.path.join(self.tmp, "unbuilt")
        for fault, says in (({"kind": "source"}, r"do not build.*error: .*broken\.cl:7:\d+: .*missing"),
                            ({"kind": "device", "error": BUILD_PROGRAM_FAILURE, "at": 3},
                             r"do not build.* -11 \(CL_BUILD_PROGRAM_FAILURE\) and gave no reason; try ")):
            result = self.sherd(*self.fracture(out), **{"at": 1, **fault})
            self.assertEqual(result.returncode, 4, result.stderr)
            # Clang counts its errors before
            self.assertRegex(result.stderr, r"\A(1 error generated\.\n)?sherd: [^\n]{8,}[^\n.]\n\Z")
            self.assertRegex(result.stderr, says)
            self.assertFalse(os.path.lexists(out))

    def test_a_library_goes_on_and_tries_the_object_again(self):
        library = os.path.join(self.tmp, "of_three")
        os.mkdir(library)
        for name in "a.obj", "b.obj", "c.obj":
            shutil.copy(self.ball, os.path.join(library, name))

        def dataset(out, *more):
            return ("dataset", library, "-o", os.path.join(self.tmp, out), "--pieces", "2", "--repeats", "1", "--resolution", "24", "--write", "labels",
                    "--device", "pocl", *more)

        def files(out):
            return {name: sum for name, sum in tree(os.path.join(self.tmp, out)).items() if not name.startswith(("journal/", "run", "report"))}

        total = self.calls(*dataset("untroubled"), kind="device", error=OUT_OF_RESOURCES)
        result = self.sherd(*dataset("troubled"), kind="device", error=OUT_OF_RESOURCES, at=total * 2 // 3)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r"sherd: [abc]\.obj failed: [^\n]* OpenCL error -\d+")
        self.assertIn("1 object failed: ", result.stdout)
        again = self.sherd(*dataset("troubled", "--resume", "--verify"))
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(files("troubled"), files("untroubled"))

    def test_a_disk_that_fills_up_while_kernels_are_compiled(self):
        cache, out = (os.path.join(self.tmp, name) for name in ("cache", "unwritten"))
        with unittest.mock.patch.dict(os.environ, POCL_CACHE_DIR=cache):
            # the first file is the source, which PoCL writes; the next are LLVM's, which ends the process
            for at in (2, 3):
                result = self.sherd(*self.fracture(out), kind="write", at=at, error=errno.ENOSPC, below=cache)
                self.assertEqual((result.returncode, result.stdout), (4, ""), result.stderr)
                self.assertRegex(result.stderr, r"(?s)No space left on device.*\nsherd: the OpenCL driver ended the program[^\n]+\n\Z")
                self.assertFalse(os.path.lexists(out))


if __name__ == "__main__":
    skipping.main()
