#!/usr/bin/python3
"""What is skipped is reported as skipped, and fails where it is required.

SHERD_BIN names the program, SHERD_DATA the folder with amphora.ply.
"""
import os
import pathlib
import subprocess
import sys
import unittest

import skipping

HERE = pathlib.Path(__file__).parent
SKIPPED = 77  # as tests/CMakeLists.txt has it


class Skipping(unittest.TestCase):
    def run_test(self, name, *arguments, **environment):
        kept = {key: value for key, value in os.environ.items() if not key.startswith("SHERD_REQUIRE_")}
        run = subprocess.run([sys.executable, "-B", HERE / name, *arguments], env={**kept, **environment}, capture_output=True, text=True)
        return run.returncode, run.stderr

    def test_without_blender(self):
        for name in "blender_test.py", "blender_files_test.py":
            status, printed = self.run_test(name, BLENDER_BIN="/nonexistent")
            self.assertEqual(status, SKIPPED, printed)
            self.assertIn("skipped: ", printed)

    def test_blender_may_be_required(self):
        status, printed = self.run_test("blender_files_test.py", BLENDER_BIN="/nonexistent", SHERD_REQUIRE_BLENDER="1")
        self.assertEqual(status, 1, printed)

    def test_a_test_that_passes_and_one_that_is_not_there(self):
        self.assertEqual(self.run_test("cli_test.py", "Help.test_version")[0], 0)
        self.assertEqual(self.run_test("cli_test.py", "Help.test_that_nobody_wrote")[0], 1)

    def test_ctest_knows_the_status(self):
        self.assertIn(f"SKIP_RETURN_CODE {SKIPPED}", (HERE.parent / "CMakeLists.txt").read_text())


if __name__ == "__main__":
    skipping.main()
