#!/usr/bin/python3
"""The tools that measure (tools/bench/): small runs of each, and their arithmetic against files written by hand.

SHERD_BIN names the program, in a build whose programs of tests/bench lie in tests/bench beside it.  No time is checked.
"""
import importlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import skipping

SHERD = pathlib.Path(os.environ["SHERD_BIN"])
PROGRAMS = SHERD.parent / "tests" / "bench"
TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools" / "bench"
CUBE = ([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)],
        [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
         (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])
sys.path.insert(0, str(TOOLS))


def tool(name):
    return importlib.import_module(name)


def run(command, **more):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, **more)


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))


class Counts(Folder):
    def test_the_ball_is_one(self):
        path = self.folder / "ball.obj"
        tool("bench_counts").ball(path, 3)
        words = [line.split() for line in path.read_text().splitlines()]
        corners = np.array([w[1:] for w in words if w[0] == "v"], float)
        a, b, c = (corners[np.array([w[1:] for w in words if w[0] == "f"], int)[:, i] - 1] for i in range(3))
        self.assertEqual(len(a), 20 * 4 ** 3)
        np.testing.assert_allclose(np.linalg.norm(corners, axis=1), 1, atol=1e-8)
        self.assertAlmostEqual((a * np.cross(b, c)).sum() / 6, 4 / 3 * np.pi, delta=0.05)  # faces outwards

    def test_inclusive_counts_are_sums_over_calls(self):
        profile = self.folder / "profile"
        profile.write_text("events: Ir\nfn=(1) main\n1 5\ncfn=(2) sherd::voxelize(sherd::Mesh const&)\ncalls=1 0\n2 100\n"
                           "cfn=(3) sherd::readMesh(std::string)\ncalls=1 0\n3 30\n\nfn=(2)\n4 60\ncfn=(4) std::sort(int)\n"
                           "calls=4 0\n5 40\n\nfn=(3)\n6 30\n\nfn=(4)\n7 40\n\nfn=(5) other\n8 7\ncfn=(2)\ncalls=1 0\n9 3\n"
                           "totals: 145\n")
        counts = tool("bench_counts").inclusive(profile)
        self.assertEqual((counts["total"], counts["voxelize"], counts["read"], counts["grow"]), (145, 103, 30, 0))
        self.assertEqual(counts["other"], 145 - 103 - 30)

    @skipping.skip_unless(shutil.which("valgrind"), "VALGRIND", "there is no valgrind")
    def test_each_stage_of_a_small_run_is_found(self):
        done = run([TOOLS / "bench_counts.py", "--quick", SHERD])
        self.assertEqual(done.returncode, 0, done.stderr)
        header, _, *rows = done.stdout.splitlines()
        self.assertEqual(len(rows), 2)
        for row in rows:
            counts = dict(zip(cells(header)[1:], (float(cell.replace(",", "")) for cell in cells(row)[1:])))
            self.assertEqual(counts.pop("preview"), 0)
            total = counts.pop("total")
            self.assertGreater(min(counts.values()), 0.1, row)  # a stage whose function has another name now has none
            self.assertAlmostEqual(total, sum(counts.values()), delta=0.5)


class Peers(Folder):
    def test_closed_meshes(self):
        vertices, faces = CUBE
        flipped = [tuple(reversed(faces[0])), *faces[1:]]
        for name, mesh in (("closed", faces), ("open", faces[1:]), ("flipped", flipped), ("empty", [])):
            (self.folder / f"{name}.obj").write_text("".join("v %d %d %d\n" % v for v in vertices) +
                                                     "".join("f %d %d %d\n" % tuple(i + 1 for i in f) for f in mesh))
        # Each face has vertices of its own, which are equal.
        (self.folder / "soup.obj").write_text("".join("v %d %d %d\n" % vertices[i] for f in faces for i in f) +
                                              "".join(f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}\n" for i in range(len(faces))))
        done = run([sys.executable, TOOLS / "bench_peers.py", "--closed", self.folder, "*.obj"])
        self.assertEqual(done.stdout.split(), ["5", "2"], done.stderr)

    def test_a_missing_program_is_a_row(self):
        done = run([TOOLS / "bench_peers.py", SHERD, self.folder / "absent", "--pieces", 3, "--resolution", 32, "--fractures", 2,
                    "--blender", "no-blender"])
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [cells(line) for line in done.stdout.splitlines() if line.startswith("|")]
        by_name = {row[0]: row for row in rows}
        self.assertIn("no-blender is missing", by_name["Cell Fracture"][1])
        self.assertIn("absent is missing", by_name["LevelSetFracture"][1])
        self.assertEqual({len(row) for row in rows}, {8})
        self.assertEqual((by_name["Sherd"][1:3], by_name["Sherd"][7]), (["1", "3"], "3/3"))
        self.assertEqual((by_name["Sherd, dataset"][1:3], by_name["Sherd, dataset"][7]), (["2", "6"], "6/6"))

    @skipping.skip_unless((PROGRAMS / "level_set_fracture").exists(), "BENCH", "the benchmarks are not built")
    def test_level_set_fracture_gives_pieces_that_fill_the_mesh(self):
        done = run([PROGRAMS / "level_set_fracture", os.path.join(os.environ["SHERD_DATA"], "amphora.ply"), self.folder, 4, 1, 64, 2])
        self.assertEqual(done.returncode, 0, done.stderr)
        whole = json.loads(run([SHERD, "inspect", os.path.join(os.environ["SHERD_DATA"], "amphora.ply"), "--json"]).stdout)["volume"]
        for fracture in ("0", "1"):
            report = json.loads(run([SHERD, "evaluate", self.folder / fracture, "--json"]).stdout)
            self.assertEqual([f["quality"]["closed"] for f in report["fragments"]], [True] * 4)
            self.assertAlmostEqual(sum(f["volume"] for f in report["fragments"]) / whole, 1, delta=0.05)


class Ratios(Folder):
    def test_are_of_medians(self):
        runs = [(f"{name}/real_time", kind, time, unit) for name, kind, time, unit in (
            ("grow/device/128/0", "mean", 9, "ms"), ("grow/device/128/0", "median", 2, "ms"),
            ("grow/serial_queue/128", "median", 4000, "us"), ("extract/shared", "median", 30, "ms"))]
        path = self.folder / "results.json"
        path.write_text(json.dumps({"benchmarks": [
            {"run_name": name, "aggregate_name": kind, "real_time": time, "time_unit": unit} for name, kind, time, unit in runs]}))
        rows = run([TOOLS / "bench_ratios.py", path]).stdout.splitlines()[2:]
        self.assertEqual([cells(row)[1:] for row in rows], [["2.0 ms", "4.0 ms", "0.50"]])  # no row without the other


@skipping.skip_unless((PROGRAMS / "device_bench").exists(), "BENCH", "the benchmarks are not built")
class Devices(Folder):
    """tools/bench/bench_gpu.sh as it lies in an unpacked archive, where it builds nothing."""

    def setUp(self):
        super().setUp()
        shutil.copy(TOOLS / "bench_gpu.sh", self.folder)
        (self.folder / "programs").mkdir()
        (self.folder / "programs" / "device_bench").symlink_to(PROGRAMS / "device_bench")
        tests = self.folder / "programs" / "sherd_kernel_tests"  # the real ones have tests of their own
        tests.write_text("#!/bin/sh\necho \"[  PASSED  ] $((GTEST_SHARD_INDEX == 0 ? 3 : 0)) tests.\"\n")
        tests.chmod(0o755)

    def bench(self, *arguments, drivers):
        return run([self.folder / "bench_gpu.sh", *arguments], env={**os.environ, "OCL_ICD_VENDORS": drivers})

    def test_no_device_is_a_sentence_and_status_4(self):
        done = self.bench(drivers=str(self.folder / "none"))
        if "NVIDIA" not in done.stderr:
            self.assertIn("no OpenCL device can be used", done.stderr)
        self.assertEqual((done.returncode, done.stdout), (4, ""))

    def test_wrong_arguments_are_refused(self):
        self.assertEqual(self.bench("--sec", drivers="none").returncode, 2)
        self.assertIn("usage: bench_gpu.sh", self.bench("--help", drivers="none").stdout)

    def test_failed_kernel_tests_are_status_1(self):
        self.need_device()
        (self.folder / "programs" / "sherd_kernel_tests").write_text("#!/bin/sh\necho '[  FAILED  ] 1 test'; exit 1\n")
        done = self.bench("--seconds", 1, drivers=os.environ.get("OCL_ICD_VENDORS", "pocl.icd"))
        self.assertEqual(done.returncode, 1)
        self.assertEqual(cells(done.stdout.splitlines()[-1])[:3], ["kernel tests", "", "FAILED"])

    def need_device(self):
        if not run([PROGRAMS / "device_bench", "--list"]).stdout.strip():
            skipping.skip(self, "OPENCL", "there is no OpenCL device")

    def test_a_device_is_measured(self):
        self.need_device()
        done = self.bench("--seconds", 4, drivers=os.environ.get("OCL_ICD_VENDORS", "pocl.icd"))
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [cells(line) for line in done.stdout.splitlines() if line.startswith("|")]
        self.assertEqual({len(row) for row in rows}, {len(rows[0])})
        self.assertEqual(rows[0][-1][:7], "x86-64-")  # the built-in device is the last column
        self.assertGreater(float(rows[2][2].replace(",", "")), 0)
        self.assertEqual(rows[-1][:3], ["kernel tests", "", "3 passed"])


if __name__ == "__main__":
    skipping.main()
