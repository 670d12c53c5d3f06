#!/usr/bin/python3
"""Random changes of words, and cuts, of six `.vdb` files: each is read or refused with a sentence, within the memory allowed.

usage: vdb_damage.py SHERD [DAMAGES] [PYTHON]    (2000 damages; an interpreter that has pysherd, else Python is left out)

Every damage goes through `sherd inspect` and through one of the others in turn: fracture, --density-attribute, pysherd.voxelize and
pysherd.load.  At the end ten damaged files lie among ten good meshes in a library.
"""
import collections
import json
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile

SHERD = os.path.abspath(sys.argv[1])
DAMAGES = int(sys.argv[2]) if len(sys.argv) > 2 else 2000
PYTHON = sys.argv[3] if len(sys.argv) > 3 else None
DATA = pathlib.Path(__file__).resolve().parents[2] / "data"
LIMIT = "1G"
BOX = "124 143 578 586 156 162 348 387 137 175 268 284".split()  # triangles of corners 4x + 2y + z + 1
RESIDENT = (1024 + 200) * 1024  # kB: the limit, and 200 MB
ENVIRONMENT = {**os.environ, "OCL_ICD_VENDORS": "pocl.icd"}
# Reads names from its input, and answers each with what became of it.
READER = """
import os, pathlib, sys, warnings
import pysherd
warnings.simplefilter("ignore")
for line in sys.stdin:
    how, path = line.rstrip("\\n").split(" ", 1)
    try:
        if how == "load":
            [fragment.vertices for fragment in pysherd.load(path)]
        else:
            pysherd.voxelize(path, resolution=24)
        print("read", flush=True)
    except (pysherd.InputError, pysherd.FileError):
        print("refused", flush=True)
    except Exception as error:
        print("wrong", type(error).__name__, str(error)[:200], flush=True)
"""


def sherd(*arguments):
    """Status, peak memory in kB, and what it says."""
    with tempfile.TemporaryFile("w+", errors="surrogateescape") as said:
        process = subprocess.Popen([SHERD, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=said, env=ENVIRONMENT)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        return process.returncode, usage.ru_maxrss, said.read()


def run(*arguments):
    status, _, said = sherd(*arguments)
    if status != 0:
        sys.exit(f"vdb_damage.py: {' '.join(map(str, arguments))}: {status} {said}")


def good_files(folder):
    """Level set, fog, half, several grids, Blosc and zip; and a folder of a fracture."""
    files = {}

    def fracture(name, found, *options):
        out = folder / name
        run("fracture", DATA / "amphora.ply", "-o", out, "--pieces", 2, "--resolution", 24, "--write", "labels,vdb", "--quiet", *options)
        files[name] = (out / found).read_bytes()

    first = "fragments/amphora_001.vdb"
    fracture("level set", first, "--vdb-compress", "none")
    fracture("fog", first, "--vdb-compress", "none", "--write", "labels,vdb,fog")
    fracture("half", first, "--half")
    fracture("several", "fragments.vdb", "--vdb", "single")
    fracture("blosc", first)
    fracture("zip", "fragments.vdb", "--vdb", "single", "--vdb-compress", "zip")
    return files


def damaged(bytes_, random_):
    at = random_.randrange(len(bytes_))
    if random_.random() < 0.2:
        return bytes_[:at]
    if random_.random() < 0.3:
        at = min(at, random_.randrange(2500))  # names, counts and transforms lie at the beginning
    word = random_.choice([0, 1, 0xFFFFFFFF, 0x7FFFFFFF, 0x80000000, 0x7FC00000, 0xFF800000, random_.getrandbits(32), random_.getrandbits(32)])
    changed = bytearray(bytes_)
    changed[at:at + 4] = struct.pack("<I", word)[:len(changed[at:at + 4])]
    return bytes(changed)


class Python:
    """A process that reads with pysherd, begun again where it ends."""

    def __init__(self):
        self.process = None

    def read(self, how, path):
        if self.process is None:
            self.process = subprocess.Popen([PYTHON, "-B", "-c", READER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=ENVIRONMENT)
        self.process.stdin.write(f"{how} {path}\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline().strip()
        if not answer:
            answer, self.process = f"ended with {self.process.wait()}", None
        return answer


def library(folder, files, refused):
    """Ten good meshes and ten damaged files: ten fractures and ten named failures, and the same again with --resume."""
    objects, out = folder / "library", folder / "dataset"
    objects.mkdir()
    for i in range(10):
        corners = [(x * (i + 1), y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        (objects / f"good_{i}.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners)
                                               + "".join(f"f {' '.join(face)}\n" for face in BOX))
        (objects / f"damaged_{i}.vdb").write_bytes(refused[i])
    for options in (), ("--resume",):
        status, _, said = sherd("dataset", objects, "-o", out, "--pieces", "2..2", "--repeats", "1..1", "--resolution", 24, "--write", "labels", *options)
        lines = [json.loads(line) for line in (out / "failures.jsonl").read_text().splitlines()] if (out / "failures.jsonl").exists() else []
        good = len(list(out.glob("**/manifest.json")))
        print(f"library {' '.join(options)}: status {status}, {good} fractures, {len(lines)} failures", said.splitlines()[-1:] or "")
        named = sum(f"damaged_{i}" in said or any(f"damaged_{i}" in json.dumps(line) for line in lines) for i in range(10))
        if good != 10 or named != 10:
            return 1
    return 0


def main():
    random_ = random.Random(57)
    counts, wrong, refused = collections.Counter(), [], []
    python = Python()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="sherd-vdb-"))
    files = good_files(folder)
    peak = 0
    stranger = folder / "blosc"  # its first fragment's file is replaced
    fragment = stranger / "fragments" / "amphora_001.vdb"
    for i in range(DAMAGES):
        name = list(files)[i % len(files)]
        bytes_ = damaged(files[name], random_)
        path = folder / "damaged.vdb"
        path.write_bytes(bytes_)
        grid = "density" if name == "fog" else "surface" if name in ("level set", "half", "blosc") else "surface_1"
        ways = [("inspect", path)]
        out = folder / "out"
        other = i // len(files) % 5
        if other == 0:
            ways.append(("fracture", path, "-o", out, "--pieces", 3, "--resolution", 24, "--grid", grid, "--write", "labels", "--max-memory", LIMIT, "--quiet"))
        elif other == 1:
            ways.append(("fracture", DATA / "amphora.ply", "-o", out, "--pieces", 3, "--resolution", 24, "--write", "labels", "--quiet",
                         "--max-memory", LIMIT, "--density-attribute", f"{path}:{grid}"))
        elif other == 2:
            fragment.write_bytes(bytes_)
            ways.append(("fracture", stranger / "manifest.json", "-o", out, "--only", 1, "--pieces", 2, "--write", "labels", "--max-memory", LIMIT, "--quiet"))
        elif other == 3:
            ways.append(("render", path, "-o", folder / "image.png", "--size", "32x32"))
        for way in ways:
            status, memory, said = sherd(*way)
            peak = max(peak, memory)
            counts[way[0], status] += 1
            if status not in (0, 3) or memory > RESIDENT:
                kept = folder / f"kept_{len(wrong)}.vdb"
                kept.write_bytes(bytes_)
                wrong.append((status, memory, way[0], name, kept, said.strip()[-300:]))
            if way[0] == "inspect" and status == 3:
                refused.append(bytes_)
            if out.exists():
                shutil.rmtree(out)
        if PYTHON and other == 4:
            shutil.copy(path, fragment)
            for how, what in ("voxelize", path), ("load", stranger):
                answer = python.read(how, what)
                counts["python " + how, answer.split(" ")[0]] += 1
                if answer not in ("read", "refused"):
                    kept = folder / f"kept_{len(wrong)}.vdb"
                    kept.write_bytes(bytes_)
                    wrong.append((how, name, kept, answer))
    for (what, status), count in sorted(counts.items(), key=str):
        print(f"{what:>16} {status}: {count}")
    print(f"peak of a process {peak / 1024:.0f} MiB, {len(wrong)} of {DAMAGES} damages went wrong")
    for found in wrong:
        print(*found)
    failed = library(folder, files, refused)
    if not wrong and not failed:
        shutil.rmtree(folder)
    sys.exit(1 if wrong or failed else 0)


main()
