#!/usr/bin/python3
"""Limits of the system on memory and threads: a command works, or ends with one sentence, never by a signal.

SHERD_BIN names the program.  SHERD_LIMITS=all tries many limits for every command (tools/test_long.sh); without it few of them.
"""
import os
import resource
import shutil
import subprocess
import tempfile
import unittest

import skipping

SHERD = os.environ["SHERD_BIN"]
ALL = os.environ.get("SHERD_LIMITS") == "all"
NOBODY = 64321  # whom no other test runs as: it must have no processes
STATUSES = {0, 1, 2, 3, 4, 5}


def block(path):
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    quads = (0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)
    with open(path, "w") as out:
        out.writelines("v %d %d %d\n" % corner for corner in corners)
        out.writelines("f %d %d %d %d\n" % tuple(i + 1 for i in quad) for quad in quads)
    return path


class LimitsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        os.chmod(cls.folder, 0o777)
        at = cls.path
        os.mkdir(at("library"))
        for name in "a", "b":
            block(at("library", name + ".obj"))
        cls.program = shutil.copy(SHERD, at("sherd"))  # where every user may run it
        subprocess.run([cls.program, "fracture", at("library", "a.obj"), "-o", at("done"), "--pieces", "3", "--resolution", "24", "--quiet",
                        "--write", "labels,vdb,mesh"], check=True)
        cls.commands = {
            "fracture": ["fracture", at("library", "a.obj"), "-o", at("out"), "--pieces", "3", "--resolution", "24", "--points", "100",
                         "--write", "labels,vdb,mesh,preview"],
            "dataset": ["dataset", at("library"), "-o", at("set"), "--pieces", "2..3", "--repeats", "2", "--resolution", "24"],
            "packed": ["dataset", at("library"), "-o", at("set"), "--pieces", "2", "--repeats", "1", "--resolution", "24", "--layout", "packed"],
            "statistics": ["evaluate", at("done"), "--statistics"],
            "evaluate": ["evaluate", at("done")],
            "inspect": ["inspect", at("library", "a.obj")],
            "manifest": ["inspect", at("done", "manifest.json")],
            "convert": ["convert", at("library", "a.obj"), at("b.ply")],
            "render": ["render", at("done"), "-o", at("image.png")],
            "view": ["view", at("done"), "-o", at("page.html")],
        }

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def path(cls, *names):
        return os.path.join(cls.folder, *names)

    def ends_orderly(self, name, kind, limit, user=None):
        def limited():
            resource.setrlimit(kind, (limit, limit))
            if user is not None:
                os.setgroups([])
                os.setgid(user)
                os.setuid(user)
        for left in "set", "out":
            shutil.rmtree(self.path(left), ignore_errors=True)
        run = subprocess.run([self.program, *self.commands[name]], capture_output=True, text=True, preexec_fn=limited)
        if run.returncode == 127 and "error while loading shared libraries" in run.stderr:
            return None  # the system's own sentence
        with self.subTest(command=name, kind=kind, limit=limit):
            self.assertIn(run.returncode, STATUSES, run.stderr)
            if run.returncode != 0:
                errors = [line for line in run.stderr.splitlines() if "warning:" not in line and "objects," not in line]
                self.assertLessEqual(len(errors), 3 if "set" in str(self.commands[name]) else 1, run.stderr)
                self.assertTrue(all(line.startswith("sherd: ") for line in errors), run.stderr)
                self.assertNotIn("internal error", run.stderr)
                self.assertNotIn("terminate", run.stderr)
        left = [name for _, _, names in os.walk(self.folder) for name in names if name.endswith(".tmp")]
        self.assertEqual(left, [])
        return run

    def sweep(self, kind, few, many):
        for name in self.commands if ALL else ("fracture", "dataset", "statistics"):
            for limit in many if ALL else few:
                self.ends_orderly(name, kind, limit)

    def test_addresses(self):
        self.sweep(resource.RLIMIT_AS, [160_000_000, 230_000_000], range(120_000_000, 800_000_001, 10_000_000))

    def test_data(self):
        self.sweep(resource.RLIMIT_DATA, [5_000_000, 50_000_000], range(5_000_000, 400_000_001, 5_000_000))

    def test_threads(self):
        if os.geteuid() != 0:
            self.skipTest("only root can run as a user without other processes")
        said = set()
        for name in self.commands if ALL else ("fracture", "dataset", "statistics"):
            for limit in range(1, 16) if ALL else (1, 5, 6):
                run = self.ends_orderly(name, resource.RLIMIT_NPROC, limit, NOBODY)
                said.update(run.stderr.splitlines())
        sentence = "sherd: no thread can be started; allow this process more memory or threads (ulimit -v, -d, -u)"
        self.assertIn(sentence, said)


if __name__ == "__main__":
    skipping.main()
