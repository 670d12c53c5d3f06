#!/usr/bin/python3
"""A ctrl-C while another program reads the mesh: both end at once.

Environment: SHERD_BIN is the program.
"""
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

import skipping

# A shell starts jobs in the background with SIGINT ignored, and the program would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

SHERD = os.environ["SHERD_BIN"]


class Interrupt(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "a.fbx").write_text("x")
        # In place of sherd-assimp: prints its process id, then reads for ever.
        self.started = self.folder / "started"
        program = self.folder / "program"
        program.write_text(f"#!/bin/sh\necho $$ > {self.started}.new\nmv {self.started}.new {self.started}\n"
                           "exec sleep 1000\n")
        program.chmod(0o700)
        self.environment = dict(os.environ, SHERD_ASSIMP=str(program))

    def start(self, *arguments):
        """A process group of its own, as a terminal's foreground job is."""
        sherd = subprocess.Popen([SHERD, *arguments], env=self.environment, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, text=True, start_new_session=True)
        deadline = time.monotonic() + 60
        while not self.started.exists():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)
        return sherd, int(self.started.read_text())

    def assert_gone(self, process):
        deadline = time.monotonic() + 10
        while pathlib.Path(f"/proc/{process}").exists():
            self.assertLess(time.monotonic(), deadline, "the other program runs on")
            time.sleep(0.02)

    def test_fracture_ends_with_130(self):
        out = self.folder / "out"
        sherd, reader = self.start("fracture", str(self.folder / "a.fbx"), "-o", str(out))
        begin = time.monotonic()
        os.killpg(sherd.pid, signal.SIGINT)
        _, errors = sherd.communicate(timeout=60)
        self.assertEqual(sherd.returncode, 130, errors)
        self.assertIn("interrupted", errors)
        self.assertLess(time.monotonic() - begin, 20)
        self.assert_gone(reader)
        self.assertFalse(out.exists())

    def test_a_signal_to_sherd_alone_ends_both(self):
        sherd, reader = self.start("fracture", str(self.folder / "a.fbx"), "-o", str(self.folder / "out"))
        begin = time.monotonic()
        sherd.send_signal(signal.SIGTERM)
        _, errors = sherd.communicate(timeout=60)
        self.assertEqual(sherd.returncode, 130, errors)
        self.assertLess(time.monotonic() - begin, 20)
        self.assert_gone(reader)

    def test_inspect_ends_too(self):
        sherd, reader = self.start("inspect", str(self.folder / "a.fbx"))
        os.killpg(sherd.pid, signal.SIGINT)
        sherd.communicate(timeout=60)
        self.assertEqual(sherd.returncode, 130)
        self.assert_gone(reader)


if __name__ == "__main__":
    skipping.main()
