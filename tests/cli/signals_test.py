#!/usr/bin/python3
"""Ctrl-C and its like at random moments of every command.

SHERD_BIN names the program, SHERD_SIGNALS says how many signals are sent (default 40).

A signal ends a command with status 130, what was there stays byte for byte, and nothing else is left; or it comes too late, and all is done
with status 0.  After the signal no thread takes more than a second of a processor on average.  Seconds by the clock are only printed, as other
programs take theirs of the machine; ten of them mean that the command hangs.
"""
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest

import numpy as np

import skipping
from cli_test import SHERD, CommandLine, joined, sphere, tree, write_obj

SIGNALS = int(os.environ.get("SHERD_SIGNALS", "40"))
MOST_CPU = 1.0  # seconds per thread
HANGS = 10.0  # seconds
LONG = 0.4  # seconds of a processor
IN_TIME = 0.5  # of them: a signal that comes sooner ends the command, whatever else the machine does meanwhile
SEED = 22
TICKS = os.sysconf("SC_CLK_TCK")
SENT = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
OF_THE_RUN = ("out/journal/", "out/run.json", "out/report.html")  # of a dataset: what it took, and how it was made


def blocks(process, number):
    """Whether main() has begun to wait for the signal, which before would simply kill.  All signals are blocked for a moment while any
    thread is made."""
    with open(f"/proc/{process}/status") as status:
        blocked = int(next((line for line in status if line.startswith("SigBlk")), "SigBlk: 0").split()[1], 16)
    return blocked >> (number - 1) & 1 and not blocked >> (signal.SIGUSR1 - 1) & 1


def used(process):
    """Seconds of a processor so far, and threads."""
    with open(f"/proc/{process}/stat") as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS, int(fields[17])


def open_cup(path, side=40):
    """A bowl without thickness."""
    u = np.linspace(0.05, 1.0, side)
    a = np.linspace(0.0, 2 * np.pi, 2 * side, endpoint=False)
    v = [(r * np.cos(t), r * r, r * np.sin(t)) for r in u for t in a]
    n = len(a)
    f = []
    for i in range(side - 1):
        for j in range(n):
            p, q = i * n + j, i * n + (j + 1) % n
            f += [(p, q, q + n), (p, q + n, p + n)]
    write_obj(path, (v, f))


class Signals(CommandLine):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.random = random.Random(SEED)
        cls.base = os.path.join(cls.data, "base")  # what each command finds
        os.makedirs(os.path.join(cls.base, "library", "more"))
        at = cls.at
        write_obj(at("ball.obj"), sphere())
        write_obj(at("fine.obj"), sphere(rows=200, columns=400))
        write_obj(at("pair.obj"), joined(sphere(), sphere(center=(1.5, 0, 0), radius=0.8)))
        with open(at("objects.obj"), "w") as out:
            first = 0
            for i in range(4):
                v, f = sphere(center=(3 * i, 0, 0))
                out.write(f"o part{i}\n")
                out.writelines("v %g %g %g\n" % p for p in v)
                out.writelines("f %d %d %d\n" % tuple(k + 1 + first for k in t) for t in f)
                first += len(v)
        open_cup(at("cup.obj"))
        x, y, z = np.indices((64, 64, 64))
        holes = (np.sin(x / 2) + np.sin(y / 2) + np.sin(z / 2) > 0).astype(np.uint16)
        np.save(at("sponge.npy"), holes)
        np.save(at("labels.npy"), (holes * (1 + (x * 7 + y * 5 + z * 3) % 50)).repeat(2, axis=2).astype(np.uint16))
        for name in "a.obj", "b.obj", "more/c.obj":
            shutil.copy(at("ball.obj"), at(os.path.join("library", name)))
        for arguments in (["fracture", "ball.obj", "-o", "old", "--pieces", "12", "--resolution", "48"],
                          ["fracture", "ball.obj", "-o", "pieces", "--pieces", "8", "--resolution", "96"]):
            run = subprocess.run([SHERD, *arguments, "--surface", "smooth"], cwd=cls.base, capture_output=True, text=True)
            assert run.returncode == 0, run.stderr
        for name in "old.csv", "old.png", "old.stl", "old.rle":
            with open(at(name), "w") as file:
                file.write("what was there\n")

    @classmethod
    def at(cls, name):
        return os.path.join(cls.base, name)

    COMMANDS = {
        "voxels to a surface": ["fracture", "sponge.npy", "-o", "out", "--pieces", "5"],
        "a shell": ["fracture", "cup.obj", "-o", "old", "--fill", "shell", "--shell-thickness", "0.1", "--pieces", "6", "--resolution", "200"],
        "objects": ["fracture", "objects.obj", "-o", "out", "--split-objects", "--pieces", "3", "--resolution", "72", "--json"],
        "fragments again": ["fracture", "pieces/manifest.json", "-o", "old", "--only", "1,2,3,4,5,6", "--pieces", "5"],
        "chains, worn": ["fracture", "ball.obj", "-o", "old", "--growth", "chain", "--erode-iterations", "3", "--erode-probability", "0.5",
                         "--pieces", "20", "--resolution", "96"],
        "an OpenCL driver": ["fracture", "ball.obj", "-o", "out", "--growth", "chain", "--resolution", "96", "--device", "pocl"],
        "many pieces": ["fracture", "ball.obj", "-o", "out", "--pieces", "300", "--resolution", "96"],
        "exact surfaces": ["fracture", "fine.obj", "-o", "old", "--surface", "exact", "--pieces", "10", "--resolution", "96"],
        "points": ["fracture", "pair.obj", "-o", "old", "--points", "20000", "--sdf-samples", "20000", "--pieces", "6", "--resolution", "96"],
        "a dataset": ["dataset", "library", "-o", "out", "--resolution", "32", "--pieces", "2..4", "--repeats", "2..1", "--points", "64"],
        "archives": ["dataset", "library", "-o", "out", "--resolution", "32", "--pieces", "2..4", "--repeats", "2..1", "--points", "64", "--layout",
                     "packed"],
        "a forecast": ["dataset", "library", "-o", "out", "--resolution", "24", "--pieces", "2..3", "--repeats", "1..1", "--dry-run"],
        "figures": ["evaluate", "pieces", "--samples", "10000", "--csv", "old.csv"],
        "a picture": ["render", "pieces", "-o", "old.png", "--size", "1000x750"],
        "a page": ["view", "pieces", "-o", "old.png", "--max-size", "200K"],
        "a look": ["inspect", "fine.obj"],
        "a mesh": ["convert", "fine.obj", "old.stl", "--ascii"],
        "voxels": ["convert", "labels.npy", "old.rle"],
    }

    def fresh(self):
        """A copy of what each command finds, and an empty folder for temporaries."""
        self.work, self.temporaries = self.path("work"), self.path("temporaries")
        for folder in self.work, self.temporaries:
            shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.base, self.work)
        os.mkdir(self.temporaries)

    def start(self, arguments):
        return subprocess.Popen([SHERD, *arguments], cwd=self.work, env={**os.environ, "TMPDIR": self.temporaries}, text=True,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)

    def whole(self, arguments):
        """What an undisturbed run leaves, its seconds by the clock and of a processor."""
        self.fresh()
        begin, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        process = self.start(arguments)
        _, errors = process.communicate(timeout=600)
        self.assertEqual(process.returncode, 0, errors)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return tree(self.work), time.monotonic() - begin, cpu

    def interrupted(self, arguments, number, moment):
        """Status, messages, seconds of a processor before the signal (None where it came too late), per thread after it, and by the clock
        after it."""
        process = self.start(arguments)
        begin = time.monotonic()
        while process.poll() is None and not blocks(process.pid, number):
            time.sleep(0.001)
        time.sleep(max(0.0, moment - (time.monotonic() - begin)))
        try:
            before, threads = used(process.pid)
        except (FileNotFoundError, IndexError):
            before, threads = 0.0, 0
        if process.poll() is None:
            process.send_signal(number)
        sent = time.monotonic()
        messages = process.stderr  # a line or two: no pipe is filled
        while True:
            pid, status, resources = os.wait4(process.pid, os.WNOHANG) if process.returncode is None else (process.pid, None, None)
            if pid:
                break
            if time.monotonic() - sent > HANGS:
                process.kill()
                process.wait()
                self.fail(f"{' '.join(arguments)}: still there {HANGS} s after the signal at {moment:.3f} s")
            time.sleep(0.005)
        wall = time.monotonic() - sent
        said = messages.read()
        messages.close()
        if resources is None:  # it had ended before
            return process.returncode, said, None, 0.0, 0.0
        process.returncode = os.waitstatus_to_exitcode(status)
        cpu = resources.ru_utime + resources.ru_stime - before
        return process.returncode, said, before if threads else None, cpu / max(threads, 1), wall

    def check_dataset(self, arguments, whole):
        """Nothing half written; and the same command with --resume makes the rest."""
        out = os.path.join(self.work, "out")
        self.assertEqual([n for n in tree(self.work) if os.path.basename(n.rstrip("/")).startswith(".sherd-")], [])
        for name in tree(out):
            if name.startswith("journal/") and name.endswith(".jsonl"):
                with open(os.path.join(out, name)) as lines:
                    for line in lines.read().split("\n")[:-1]:
                        self.assertIsInstance(json.loads(line), dict)
        process = self.start([*arguments, "--resume"])
        _, errors = process.communicate(timeout=600)
        self.assertEqual(process.returncode, 0, errors)
        self.assertEqual(*({k: v for k, v in files.items() if not k.startswith(OF_THE_RUN)} for files in (tree(self.work), whole)))

    def test_at_any_moment(self):
        for arguments in self.COMMANDS.values():
            self.whole(arguments)  # kernels are built, files are in memory
        wholes = {name: self.whole(arguments) for name, arguments in self.COMMANDS.items()}
        before = tree(self.base)
        walls, cpus, statuses, in_time = [], [], [], set()
        for i in range(SIGNALS):
            name = list(self.COMMANDS)[i % len(self.COMMANDS)]
            arguments, (whole, seconds, all_cpu) = self.COMMANDS[name], wholes[name]
            number = self.random.choice(SENT)
            # Each command gets its first signal long before it would be done.
            moment = self.random.uniform(0.0, seconds * (IN_TIME if i < len(self.COMMANDS) else 1.0))
            with self.subTest(command=name, moment=f"{moment:.3f} of {seconds:.3f} s", signal=number.name):
                self.fresh()
                status, said, until, cpu, wall = self.interrupted(arguments, number, moment)
                walls.append((wall, name)), cpus.append((cpu, name)), statuses.append(status)
                if until is not None and all_cpu > LONG and until < IN_TIME * all_cpu:
                    self.assertEqual(status, 130, said)
                    in_time.add(name)
                self.assertIn(status, (0, 130), said)
                self.assertLessEqual(cpu, MOST_CPU)
                self.assertEqual(os.listdir(self.temporaries), [])
                if status == 130:
                    self.assertEqual(said.count("sherd: interrupted"), 1, said)
                if arguments[0] == "dataset" and "--dry-run" not in arguments:
                    self.check_dataset(arguments, whole)
                elif status == 130:
                    self.assertEqual(tree(self.work), before)
                else:
                    self.assertEqual(tree(self.work), whole)
        # Enough of them were at work, on a machine with other work too.
        self.assertGreater(len(in_time), min(SIGNALS, len(self.COMMANDS)) / 3)
        print(f"\n{len(statuses)} signals, {statuses.count(130)} ended with 130; after the signal at most {max(walls)[0]:.2f} s by the clock "
              f"({max(walls)[1]}), {max(cpus)[0]:.2f} s of a processor per thread ({max(cpus)[1]})")

    def test_what_is_ignored_stays_ignored(self):
        """nohup: the program goes on."""
        self.fresh()
        process = subprocess.Popen(["/bin/sh", "-c", 'trap "" HUP; exec "$0" "$@"', SHERD, *self.COMMANDS["a look"]], cwd=self.work,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        while process.poll() is None and not blocks(process.pid, signal.SIGINT):
            time.sleep(0.001)
        process.send_signal(signal.SIGHUP)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, errors)


if __name__ == "__main__":
    skipping.main()
