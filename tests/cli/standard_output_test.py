#!/usr/bin/python3
"""A standard output that takes nothing: status 5 and a sentence, and what a command would have replaced is as it was.

SHERD_BIN names the program.
"""
import json
import os
import shutil
import subprocess
import unittest

import skipping
from cli_test import CommandLine, sphere, tree

COMMANDS = ("fracture", "dataset", "assemblage", "merge", "inspect", "convert", "evaluate", "render", "view", "devices")


class StandardOutput(CommandLine):
    def both_refuse(self, *arguments):
        """Full and closed."""
        with open("/dev/full", "w") as full:
            runs = [self.run_sherd(*arguments, stdout=full),
                    self.run_sherd(*arguments, stdout=None, preexec_fn=lambda: os.close(1))]
        for run in runs:
            self.assertEqual(run.returncode, 5, run.stderr)
            self.assertRegex(run.stderr, r"(?m)^sherd: standard output: (no space left on device|bad file descriptor)$")

    def test_help_and_version(self):
        for arguments in ["--help"], ["--version"], *([command, "--help"] for command in COMMANDS):
            with self.subTest(arguments=arguments):
                self.both_refuse(*arguments)

    def test_a_fracture_is_not_replaced(self):
        self.assertEqual(self.fracture("--quiet").returncode, 0)
        before = tree(self.tmp)
        for more in [], ["--json"]:
            with self.subTest(more=more):
                self.both_refuse("fracture", self.ball, "-o", self.out, "--pieces", "5", "--resolution", "32", *more)
                self.assertEqual(tree(self.tmp), before)

    def two_objects(self):
        path = self.path("two.obj")
        with open(path, "w") as out:
            first = 1
            for i in range(2):
                v, f = sphere(center=(3 * i, 0, 0))
                out.write(f"o part{i}\n")
                out.writelines("v %g %g %g\n" % p for p in v)
                out.writelines("f %d %d %d\n" % tuple(k + first for k in t) for t in f)
                first += len(v)
        return path

    def test_objects_are_replaced_all_or_none(self):
        arguments = ["fracture", self.two_objects(), "-o", self.out, "--split-objects", "--resolution", "32", "--pieces"]
        before = tree(self.tmp)
        for more in [], ["--json"]:
            self.both_refuse(*arguments, "2", *more)
            self.assertEqual(tree(self.tmp), before)  # no folder at all
        reported = self.run_sherd(*arguments, "2", "--json")
        self.assertEqual(reported.returncode, 0, reported.stderr)
        self.assertEqual([one["fragments"] for one in json.loads(reported.stdout)], [2, 2])
        before = tree(self.tmp)
        self.assertIn("out/part1/manifest.json", before)
        for more in [], ["--json"]:
            self.both_refuse(*arguments, "3", *more)
            self.assertEqual(tree(self.tmp), before)

    def test_files_are_not_replaced(self):
        pieces = self.path("pieces")
        self.assertEqual(self.fracture("--voxel-format", "npy", out=pieces).returncode, 0)
        labels = next(n for n in tree(pieces) if n.endswith(".npy"))
        table, plot, mesh, voxels = (self.path(name, b"what was there") for name in ("a.csv", "a.svg", "a.ply", "a.rle"))
        before = tree(self.tmp)
        for arguments in (["evaluate", pieces, "--samples", "100", "--csv", table, "--plot", plot], ["convert", self.ball, mesh],
                          ["convert", self.ball, mesh, "--json"], ["convert", os.path.join(pieces, labels), voxels]):
            with self.subTest(arguments=arguments):
                self.both_refuse(*arguments)
                self.assertEqual(tree(self.tmp), before)

    def test_one_file_is_not_written_twice(self):
        pieces, both = self.path("pieces"), self.path("both", b"what was there")
        self.assertEqual(self.fracture(out=pieces).returncode, 0)
        before = tree(self.tmp)
        for plot in both, os.path.join(self.tmp, "pieces", "..", "both"):
            self.refused(2, self.run_sherd("evaluate", pieces, "--samples", "100", "--csv", both, "--plot", plot), "is named by --csv too")
        self.assertEqual(tree(self.tmp), before)

    def test_a_dataset_goes_on(self):
        """A dataset keeps what is done; only the last line is lost."""
        library = self.path("library")
        os.mkdir(library)
        os.symlink(self.ball, os.path.join(library, "ball.obj"))
        arguments = ["dataset", library, "-o", self.out, "--resolution", "24", "--pieces", "2..3", "--repeats", "1..1"]
        with open("/dev/full", "w") as full:
            self.assertEqual(self.run_sherd(*arguments, stdout=full).returncode, 5)
        self.assertFalse([n for n in tree(self.out) if ".sherd-" in n])
        run = self.run_sherd(*arguments, "--resume", "--verify")
        self.assertEqual(run.returncode, 0, run.stderr)


class ControlCharacters(CommandLine):
    """Names are shown as text, whatever they hold: no byte of a name moves the cursor or changes a terminal's title."""

    NAME = b"a\x1b]0;x\x07\x1b[31m\n\r\tb\x7f\xc2\x9bc\x9bd\xc3\xa9"
    SHOWN = "a\\u001b]0;x\\u0007\\u001b[31m\\u000a\\u000d\\u0009b\\u007f\\u009bc\\x9bd\u00e9"

    def run_raw(self, *arguments):
        return subprocess.run([os.environ["SHERD_BIN"], *arguments], capture_output=True)

    def shows(self, *arguments, status=0, shown=SHOWN):
        run = self.run_raw(*arguments)
        self.assertEqual(run.returncode, status, run.stderr)
        both = run.stdout + run.stderr
        text = both.decode()  # valid
        raw = [c for c in text if c != "\n" and (ord(c) < 0x20 or 0x7f <= ord(c) < 0xa0)]
        self.assertEqual(raw, [], text)
        self.assertIn(shown, text)
        return text

    def named(self, end, of):
        path = os.path.join(os.fsencode(self.tmp), self.NAME + end)
        shutil.copy(of, path)
        return path

    def test_of_files(self):
        mesh = self.named(b".obj", self.ball)
        out = os.path.join(os.fsencode(self.tmp), self.NAME)
        text = self.shows("fracture", mesh, "-o", out, "--pieces", "3", "--resolution", "24", "--write", "labels,vdb,mesh")
        self.assertEqual(text.count("\n"), 5, text)  # no name breaks a line
        self.shows("evaluate", out)
        self.shows("evaluate", out, "--statistics")
        self.shows("convert", mesh, os.path.join(os.fsencode(self.tmp), b"b.ply"))
        self.shows("view", out, "-o", out + b".html")
        self.shows("inspect", out + b"/absent.obj", status=3)
        self.shows("fracture", mesh + b".absent", "-o", "x", status=3)
        self.shows("fracture", "--config", mesh + b".toml", "-o", "x", status=3)
        self.shows(b"frac" + self.NAME, status=2)
        self.shows("fracture", mesh, "-o", "x", "--growth", b"a\x1b[31m", status=2, shown="a\\u001b[31m")

    def test_of_a_library(self):
        library = self.path("library")
        os.mkdir(library)
        shutil.copy(self.ball, os.path.join(os.fsencode(library), self.NAME + b".obj"))
        with open(os.path.join(os.fsencode(library), self.NAME + b".stl"), "w") as bad:
            bad.write("solid nothing")
        self.shows("dataset", library, "-o", self.path("set"), "--pieces", "2", "--repeats", "1", "--resolution", "24")

    def test_within_files(self):
        path = self.path("named.obj")
        with open(self.ball) as ball, open(path, "wb") as out:
            out.write(b"o " + self.NAME.replace(b"\n", b"").replace(b"\r", b"") + b"\n" + ball.read().encode())
        for arguments in ["inspect", path], ["fracture", path, "-o", self.out, "--pieces", "2", "--resolution", "24", "--split-objects"]:
            run = self.run_raw(*arguments)
            self.assertEqual(run.returncode, 0, run.stderr)
            text = (run.stdout + run.stderr).decode()
            self.assertEqual([c for c in text if c != "\n" and (ord(c) < 0x20 or 0x7f <= ord(c) < 0xa0)], [], text)

    def test_json_keeps_its_meaning(self):
        mesh = self.named(b".obj", self.ball)
        run = self.run_raw("inspect", mesh, "--json")
        self.assertEqual(json.loads(run.stdout)["file"], mesh.decode(errors="replace"))
        self.assertEqual([c for c in run.stdout.decode() if c != "\n" and (ord(c) < 0x20 or 0x7f <= ord(c) < 0xa0)], [])


if __name__ == "__main__":
    skipping.main()
