"""Promise 5: the same input, options and seed give the same bytes, whatever runs them.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.
"""
import hashlib
import os
import pathlib
import subprocess
import tempfile
import unittest

import skipping
from manifests import check_below

SHERD = os.environ["SHERD_BIN"]
AMPHORA = pathlib.Path(os.environ["SHERD_DATA"]) / "amphora.ply"


def run(out, *args, seed="11", **env):
    result = subprocess.run([SHERD, "fracture", AMPHORA, "-o", out, "--pieces", "9", "--seed", seed, "--resolution", "96", *args],
                   check=True, env={**os.environ, **env}, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    check_below(out)
    return result.stderr.decode()


def tree(folder):
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest()
            for p in sorted(pathlib.Path(folder).rglob("*")) if p.is_file()}


class Determinism(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory()
        cls.first = pathlib.Path(cls.temp.name) / "first"
        run(cls.first)

    @classmethod
    def tearDownClass(cls):
        cls.temp.cleanup()

    def same(self, *args, **env):
        out = pathlib.Path(self.temp.name) / self.id()
        printed = run(out, *args, **env)
        one, two = tree(self.first), tree(out)
        self.assertEqual(one.keys(), two.keys())
        self.assertGreater(len(one), 20)
        self.assertEqual({k for k in one if one[k] != two[k]}, set())
        return printed

    def test_again(self):
        self.same()

    def test_one_pocl_thread(self):
        self.same("--device", "pocl", POCL_MAX_PTHREAD_COUNT="1")

    def test_two_pocl_threads(self):
        self.same("--device", "pocl", POCL_MAX_PTHREAD_COUNT="2")

    def test_each_set_of_instructions(self):
        devices = subprocess.run([SHERD, "devices"], capture_output=True, text=True, check=True).stdout
        here = [name for name in ("x86-64-v4", "x86-64-v3", "x86-64-v2") if f"builtin / {name}:" in devices]
        if len(here) < 2:
            skipping.skip(self, "OPENCL", "the processor has one set, or the build none")
        for name in here:
            with self.subTest(name):
                self.same("--device", name)

    def test_one_tbb_thread(self):
        self.same("--threads", "1")

    def test_two_tbb_threads(self):
        self.same("--threads", "2")

    def test_another_seed_is_another_fracture(self):
        out = pathlib.Path(self.temp.name) / "other"
        run(out, seed="12")
        self.assertNotEqual((self.first / "labels.rle").read_bytes(), (out / "labels.rle").read_bytes())

    def test_rusticl_gives_the_same_bytes(self):
        """Mesa's rusticl on llvmpipe: another compiler, another runtime."""
        env = {"OCL_ICD_VENDORS": "rusticl.icd", "RUSTICL_ENABLE": "llvmpipe"}
        devices = subprocess.run([SHERD, "devices"], env={**os.environ, **env}, capture_output=True, text=True)
        if "llvmpipe" not in devices.stdout:
            skipping.skip(self, "RUSTICL", "Debian's mesa-opencl-icd is not installed")
        self.assertIn("ends long loops early", self.same("--device", "llvmpipe", **env))


if __name__ == "__main__":
    skipping.main()
