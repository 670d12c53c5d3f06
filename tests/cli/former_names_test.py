#!/usr/bin/python3
"""What version 0.1 named otherwise: its options still work, with a warning, and its folders are read.

SHERD_BIN names the program, SHERD_DATA the folder of bundled meshes.
"""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

SHERD = os.environ["SHERD_BIN"]
MESH = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")
COMMON = ("--pieces", "3", "--resolution", "32", "--quiet")


def contents(folder):
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(pathlib.Path(folder).rglob("*")) if f.is_file()}


class FormerNames(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def sherd(self, *arguments):
        run = subprocess.run([SHERD, *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run

    def same(self, former, current, names, command=("fracture", MESH, "-o")):
        """Both option lists write the same files, and the first one warns of each name in `names`."""
        a, b = self.folder / "a", self.folder / "b"
        run = self.sherd(*command, a, *COMMON, *former)
        for name in names:
            self.assertRegex(run.stderr, f"warning: .*{name}.* is now ")
        self.assertEqual(run.stderr.count("is now"), len(names), run.stderr)
        self.assertNotIn("is now", self.sherd(*command, b, *COMMON, *current).stderr)
        self.assertEqual(contents(a), contents(b))

    def test_an_option(self):
        self.same(("--erode-iterations", "2", "--erode-crumbs", "keep"), ("--erode-iterations", "2", "--erode-islands", "keep"),
                  ["--erode-crumbs"])

    def test_an_option_and_its_value_with_an_equals_sign(self):
        self.same(("--erode-iterations=2", "--erode-crumbs=wear"), ("--erode-iterations=2", "--erode-islands=erode"),
                  ["--erode-crumbs", "--erode-islands wear"])

    def test_a_value_of_a_list(self):
        self.same(("--write", "mesh,rims,labels"), ("--write", "mesh,boundaries,labels"), ["--write rims"])

    def test_padding(self):
        self.sherd("fracture", MESH, "-o", self.folder / "out", *COMMON)
        for name, file in (("cube-centred", "a.npy"), ("cube-centered", "b.npy")):
            run = self.sherd("convert", self.folder / "out/labels.rle", self.folder / file, "--pad", name)
            self.assertEqual("is now" in run.stderr, name == "cube-centred")
        np.testing.assert_array_equal(np.load(self.folder / "a.npy"), np.load(self.folder / "b.npy"))

    def test_a_configuration_file(self):
        (self.folder / "library").mkdir()
        shutil.copy(MESH, self.folder / "library")
        text = 'pieces = 2\nresolution = 32\nerode-iterations = 1\nwrite = "mesh"\n'
        (self.folder / "former.toml").write_text(text + 'erode-crumbs = "keep"\n')
        (self.folder / "current.toml").write_text(text + 'erode-islands = "keep"\n')
        for name in "former", "current":
            run = self.sherd("dataset", self.folder / "library", "-o", self.folder / name, "--config", self.folder / f"{name}.toml")
            self.assertEqual("--erode-crumbs is now --erode-islands" in run.stderr, name == "former", run.stderr)
        def index(name):
            return (self.folder / name / "index.csv").read_bytes()
        self.assertEqual(index("former"), index("current"))


class FormerFolders(unittest.TestCase):
    def test_a_fracture_of_schema_1_is_read(self):
        with tempfile.TemporaryDirectory() as work:
            current, former = pathlib.Path(work, "current"), pathlib.Path(work, "former")
            subprocess.run([SHERD, "fracture", MESH, "-o", current, *COMMON], check=True)
            shutil.copytree(current, former)
            manifest = json.loads((former / "manifest.json").read_text())
            manifest["schema"] = "sherd/1"
            manifest["parts"] = manifest.pop("components")
            manifest["grid"]["worn_voxels"] = manifest["grid"].pop("eroded_voxels")
            (former / "manifest.json").write_text(json.dumps(manifest))
            for file in (former / "meshes").glob("*.ply"):
                head, body = file.read_bytes().split(b"end_header\n", 1)
                file.write_bytes(head.replace(b"int neighbor", b"int facing") + b"end_header\n" + body)

            def output(*arguments):
                return subprocess.run([SHERD, *map(str, arguments)], capture_output=True, check=True, cwd=work).stdout

            def evaluated(folder):
                found = json.loads(output("evaluate", folder, "--json"))
                return {key: value for key, value in found.items() if not isinstance(value, str)}
            self.assertEqual(evaluated(former), evaluated(current))
            for folder in former, current:
                output("render", folder, "-o", f"{folder.name}.png")
                output("fracture", folder / "manifest.json", "--only", "1", "-o", f"{folder.name}-1", "--pieces", "2", "--quiet")
            self.assertEqual(pathlib.Path(work, "former.png").read_bytes(), pathlib.Path(work, "current.png").read_bytes())
            again, before = contents(pathlib.Path(work, "former-1")), contents(pathlib.Path(work, "current-1"))
            self.assertEqual(set(again), set(before))
            for name in again:
                if name != "manifest.json":  # which has the checksum of the other manifest
                    self.assertEqual(again[name], before[name], name)
            # A fracture of schema 1 is ours to be replaced.
            output("fracture", MESH, "-o", former, *COMMON)
            self.assertEqual(json.loads((former / "manifest.json").read_text())["schema"], "sherd/2")


if __name__ == "__main__":
    unittest.main()
