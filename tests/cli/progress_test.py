#!/usr/bin/python3
"""sherd fracture --progress: lines that a host program reads.

SHERD_BIN names the program.  Every line parses, the whole never falls and ends at 1; a standard error that is closed, full or never read
neither stops the run nor changes what it writes; Ctrl-C ends it as without.
"""
import fcntl
import json
import os
import signal
import subprocess
import time
import unittest

from cli_test import SHERD, CommandLine, joined, sphere, tree, write_obj

STAGES = {"read", "device", "voxelize", "guides", "grow", "erode", "unite", "cut", "extract", "write", "distances", "render", "done"}
HANGS = 10.0  # seconds by the clock, of which other programs take theirs


class Progress(CommandLine):
    def lines(self, stderr):
        """The objects, after a check of each and of their order; and the other lines."""
        events, others = [], []
        for line in stderr.splitlines():
            (events if line.startswith("{") else others).append(line)
        events = [json.loads(line) for line in events]
        for event in events:
            self.assertEqual(set(event), {"stage", "fraction", "overall"})
            self.assertIn(event["stage"], STAGES)
            self.assertTrue(0 <= event["fraction"] <= 1 and 0 <= event["overall"] <= 1, event)
        overall = [event["overall"] for event in events]
        self.assertEqual(overall, sorted(overall))
        return events, others

    def expect_whole(self, stderr, *stages):
        events, others = self.lines(stderr)
        self.assertEqual(events[-1], {"stage": "done", "fraction": 1, "overall": 1})
        self.assertEqual([e["stage"] for e in events].count("done"), 1)
        self.assertEqual(events[0], {"stage": "read", "fraction": 0, "overall": 0})
        self.assertLessEqual(set(stages), {e["stage"] for e in events})
        self.assertGreater(len({e["overall"] for e in events}), 4)
        return others

    def test_every_stage(self):
        for surface, extra in (("smooth", []), ("exact", ["cut"]), ("labels", [])):
            with self.subTest(surface=surface):
                result = self.done("--progress", "--surface", surface, "--erode-iterations", "1", "--roughness", "1")
                others = self.expect_whole(result.stderr, "device", "voxelize", "grow", "erode", "extract", "write", "render", *extra)
                self.assertEqual(others, [])
                self.assertIn("3 fragments of ball.obj", result.stdout)

    def test_the_union_of_bodies_has_a_share(self):
        mesh = self.path("two.obj")
        write_obj(mesh, joined(sphere(16, 24), sphere(16, 24, (1, 0.1, 0.2))))
        result = self.done("--progress", "--surface", "exact", mesh=mesh)
        self.expect_whole(result.stderr, "unite", "cut")
        events, _ = self.lines(result.stderr)
        first = {e["stage"]: e["overall"] for e in reversed(events)}
        self.assertGreater(first["cut"], first["unite"] + 0.05)

    def test_with_json_quiet_and_warnings(self):
        result = self.done("--progress", "--json", "--quiet")
        self.assertEqual(self.expect_whole(result.stderr), [])
        self.assertEqual(json.loads(result.stdout)["fragments"], 3)
        result = self.done("--progress", "--quiet", "--plain-meshes", "--mesh-format", "stl")
        self.assertEqual(result.stdout, "")
        self.assertEqual(len(self.expect_whole(result.stderr)), 1)
        result = self.done("--quiet")
        self.assertEqual(result.stderr, "")

    def test_objects_are_one_run(self):
        mesh = self.path("objects.obj")
        v, f = joined(sphere(8, 12), sphere(8, 12, (5, 0, 0)), sphere(8, 12, (10, 0, 0)))
        with open(mesh, "w") as out:
            out.writelines("v %g %g %g\n" % p for p in v)
            for i in range(3):
                out.write(f"o part{i}\n")
                out.writelines("f %d %d %d\n" % tuple(k + 1 for k in t) for t in f[i * len(f) // 3:(i + 1) * len(f) // 3])
        result = self.done("--progress", "--split-objects", mesh=mesh)
        self.expect_whole(result.stderr)

    def test_what_is_refused_is_not_done(self):
        """And an error of one of several objects."""
        self.done()
        before = tree(self.out)
        result = self.fracture("--progress", "--min-share", "0.9", pieces=5)
        self.assertNotEqual(result.returncode, 0)
        events, others = self.lines(result.stderr)
        self.assertEqual(len(others), 1)
        self.assertNotIn("done", [e["stage"] for e in events])
        self.assertLess(events[-1]["overall"], 1)
        self.assertEqual(tree(self.out), before)

    def test_again_and_volumes(self):
        self.done("--write", "labels,vdb,mesh")
        result = self.run_sherd("fracture", os.path.join(self.out, "manifest.json"), "-o", self.path("again"), "--only", "1", "--pieces", "2",
                                "--progress")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.expect_whole(result.stderr, "grow", "extract", "write")

    # --- a standard error that nobody reads

    def ran(self, **more):
        """Runs with --progress."""
        process = subprocess.Popen([SHERD, "fracture", self.ball, "-o", self.out, "--pieces", "3", "--resolution", "32", "--progress", "--quiet"],
                                   stdout=subprocess.PIPE, **more)
        self.assertEqual(process.communicate(timeout=120)[0], b"")
        self.assertEqual(process.returncode, 0)

    def test_nobody_reads(self):
        self.done("--quiet", out=self.path("without"))
        expected = tree(self.path("without"))
        reader, writer = os.pipe()
        self.addCleanup(os.close, reader)
        os.set_blocking(writer, False)
        with self.assertRaises(BlockingIOError):
            while True:
                os.write(writer, bytes(4096))
        os.set_blocking(writer, True)
        with self.subTest("a pipe that is full"):
            self.ran(stderr=writer)
            self.assertEqual(tree(self.out), expected)
        os.close(writer)
        with self.subTest("a pipe that is closed"):
            end, writer = os.pipe()
            os.close(end)
            self.ran(stderr=writer)
            os.close(writer)
            self.assertEqual(tree(self.out), expected)
        with self.subTest("closed"):
            self.ran(preexec_fn=lambda: os.close(2))
            self.assertEqual(tree(self.out), expected)
        with self.subTest("a full disk"), open("/dev/full", "wb") as full:
            self.ran(stderr=full)
            self.assertEqual(tree(self.out), expected)

    def test_room_is_left_for_warnings(self):
        """Of a pipe of 64 KiB that nobody reads, progress takes less than a third, and so a warning at the end does not wait."""
        reader, writer = os.pipe()
        self.addCleanup(os.close, reader)
        fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 1 << 16)
        os.write(writer, b"x" * (17 << 10))
        process = subprocess.Popen([SHERD, "fracture", self.ball, "-o", self.out, "--pieces", "3", "--resolution", "32", "--progress", "--quiet",
                                    "--plain-meshes", "--mesh-format", "stl"], stderr=writer)
        os.close(writer)
        self.assertEqual(process.wait(timeout=120), 0)
        left = os.read(reader, 1 << 16).lstrip(b"x").decode().splitlines()
        self.assertEqual(len(left), 1)
        self.assertIn("sherd: warning: --plain-meshes does nothing", left[0])

    # --- a host's Esc

    def test_signals_at_every_stage(self):
        """As each stage begins, also of exact surfaces: status 130, and the folder as it was."""
        mesh = self.path("fine.obj")
        write_obj(mesh, sphere(120, 240))
        os.mkdir(self.out)
        self.slowest = (0.0, "")
        for surface in "exact", "smooth":
            for stage in ("read", "voxelize", "grow", "erode", "cut", "extract", "write", "render"):
                if stage == "cut" and surface != "exact":
                    continue
                for number in (signal.SIGINT, signal.SIGTERM):
                    with self.subTest(surface=surface, stage=stage, signal=number):
                        self.interrupted(mesh, surface, stage, number)
        print("\nafter a signal at most %.2f s by the clock (%s)" % self.slowest)

    def interrupted(self, mesh, surface, stage, number):
        process = subprocess.Popen([SHERD, "fracture", mesh, "-o", self.out, "--pieces", "12", "--resolution", "160", "--surface", surface,
                                    "--erode-iterations", "1", "--progress", "--quiet"], stderr=subprocess.PIPE, text=True)
        seen = []
        for line in process.stderr:
            seen.append(line)
            if json.loads(line)["stage"] == stage:
                break
        else:
            self.fail(f"no stage {stage} in {seen}")
        sent = time.monotonic()
        process.send_signal(number)
        rest = process.stderr.read()
        process.stderr.close()
        self.assertEqual(process.wait(timeout=120), 130)
        seconds = time.monotonic() - sent
        self.assertLess(seconds, HANGS)
        events, others = self.lines("".join(seen) + rest)
        self.assertEqual(others, [f"sherd: interrupted; {self.out} is as it was before"])
        self.assertNotIn("done", [e["stage"] for e in events])
        self.assertEqual(os.listdir(self.out), [])
        self.slowest = max(self.slowest, (seconds, f"{surface} {stage}"))


if __name__ == "__main__":
    unittest.main()
