#!/usr/bin/python3
"""Count the instructions of four fixed runs by callgrind, and print them as a table in Markdown.

usage: bench_counts.py [--quick] [--repeats N] SHERD [BEFORE]

Counts do not depend on what else the machine does, as seconds do: two runs of one program differ by less than a
thousandth.  So a change is judged by the counts of the programs without it (BEFORE) and with it, on one machine.  They
leave out what instructions cost: cache misses, system calls, and how well threads share the work.

    vessel             data/amphora.ply at 64 voxels in 8 pieces: labels, level sets and meshes
    vessel, preview    the same with the default files
    ball               a ball of 20,480 triangles at 128 voxels in 10 pieces: a solid, so most of it is volume
    dataset            two fractures of data/amphora.ply at 64 voxels in 10 pieces each, by `sherd dataset`

A stage has the instructions of all calls of its function (STAGES), in millions; "other" are the dynamic linker, reading
the command line, checks, manifests and checksums.  The built-in device runs kernels for x86-64-v3, which valgrind knows,
with one thread.  Environment and paths are the same in each run, since their lengths move the stack.

--quick runs the first and the third on a ball of 320 triangles, in seconds; --repeats runs each N times and prints the
spread.
Needs Debian's valgrind.
"""
import argparse
import collections
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"
STAGES = {"read": ("sherd::readMesh(",),
          "voxelize": ("sherd::voxelize(",),
          "grow": ("sherd::growTogether(",),
          "extract": ("sherd::intactSurface(", "sherd::Extraction::Extraction(", "sherd::Extraction::next("),
          "write": ("sherd::FractureWriting::write(",),
          "preview": ("sherd::renderFragments(",)}
COMMON = ["--seed", "1", "--device", "x86-64-v3", "--threads", "1", "--quiet"]
FILES = ["--write", "labels,vdb,mesh"]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", type=pathlib.Path, help="the program")
    parser.add_argument("before", type=pathlib.Path, nargs="?", help="the program without a change")
    parser.add_argument("--quick", action="store_true", help="on a small mesh, in seconds")
    parser.add_argument("--repeats", type=int, default=1, help="runs of each (default 1)")
    return parser.parse_args()


def ball(path, rounds):
    """A sphere of 20 * 4^rounds triangles.  Square roots only, so that its bytes are the same everywhere."""
    def unit(v):
        length = sum(x * x for x in v) ** 0.5
        return tuple(x / length for x in v)

    golden = (1 + 5 ** 0.5) / 2
    corners = [unit(v) for x in (-1, 1) for y in (-golden, golden) for v in ((x, y, 0), (0, x, y), (y, 0, x))]
    least = min(sum((a - b) ** 2 for a, b in zip(corners[0], c)) for c in corners[1:])
    near = [[sum((a - b) ** 2 for a, b in zip(c, d)) < 1.01 * least and c != d for d in corners] for c in corners]
    faces = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                if near[i][j] and near[j][k] and near[i][k]:
                    a, b, c = corners[i], corners[j], corners[k]
                    volume = (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                              a[2] * (b[0] * c[1] - b[1] * c[0]))
                    faces.append((i, j, k) if volume > 0 else (i, k, j))
    for _ in range(rounds):
        middles, finer = {}, []

        def middle(i, j):
            key = (min(i, j), max(i, j))
            if key not in middles:
                middles[key] = len(corners)
                corners.append(unit([a + b for a, b in zip(corners[i], corners[j])]))
            return middles[key]

        for i, j, k in faces:
            ij, jk, ki = middle(i, j), middle(j, k), middle(k, i)
            finer += [(i, ij, ki), (j, jk, ij), (k, ki, jk), (ij, jk, ki)]
        faces = finer
    with path.open("w") as text:
        text.writelines("v %.9f %.9f %.9f\n" % c for c in corners)
        text.writelines("f %d %d %d\n" % (i + 1, j + 1, k + 1) for i, j, k in faces)


def runs(quick):
    """Name and arguments of each run, in a folder with vessel.ply, ball.obj and the folder `library`."""
    vessel, small, large = ("ball.obj", "16", "24") if quick else ("vessel.ply", "64", "128")
    one = ["fracture", vessel, "-o", "out", "--pieces", "8", "--resolution", small, *COMMON]
    made = {"vessel": one + FILES,
            "vessel, preview": one,
            "ball": ["fracture", "ball.obj", "-o", "out", "--pieces", "10", "--resolution", large, *COMMON, *FILES],
            "dataset": ["dataset", "library", "-o", "out", "--pieces", "10", "--repeats", "2", "--resolution", small, *COMMON]}
    return {name: command for name, command in made.items() if not quick or name in ("vessel", "ball")}


def inclusive(profile):
    """The instructions of the whole program, and those of each stage with all that its functions call.

    A call's cost is written behind its `calls=` line, so sums over calls are exact, also for functions that are reached in
    several ways.  None of these functions calls itself.
    """
    names, costs, total, called, costs_next = {}, collections.Counter(), 0, None, False
    for line in profile.read_text().splitlines():
        if costs_next:
            costs[called] += int(line.split()[-1])
            costs_next = False
        elif line.startswith("cfn="):
            number, name = re.match(r"cfn=\((\d+)\)(?: (.*))?", line).groups()
            called = names.setdefault(number, name)
        elif line.startswith("fn="):
            number, name = re.match(r"fn=\((\d+)\)(?: (.*))?", line).groups()
            names.setdefault(number, name)
        elif line.startswith("calls="):
            costs_next = True
        elif line.startswith("totals:"):
            total = int(line.split()[1])
    counts = {stage: sum(cost for name, cost in costs.items() if name.startswith(prefixes))
              for stage, prefixes in STAGES.items()}
    return {"total": total, **counts, "other": total - sum(counts.values())}


def counted(program, command, meshes, repeats):
    """Counts of one run, and the largest difference of totals among its repeats."""
    all_counts = []
    for _ in range(repeats):
        with tempfile.TemporaryDirectory(prefix="sherd-counts-", dir="/tmp") as folder:  # of one length
            folder = pathlib.Path(folder)
            shutil.copytree(meshes, folder, dirs_exist_ok=True)
            (folder / "sherd").symlink_to(program.resolve())
            done = subprocess.run(["setarch", "-R", "valgrind", "--tool=callgrind", "--callgrind-out-file=profile", "./sherd", *command],
                                  cwd=folder, capture_output=True, text=True,
                                  env={"PATH": "/usr/bin:/bin", "HOME": str(folder), "OCL_ICD_VENDORS": "none"})
            if done.returncode != 0:
                sys.exit(f"bench_counts.py: {program} {' '.join(command)} failed:\n{done.stderr}")
            all_counts.append(inclusive(folder / "profile"))
    totals = [counts["total"] for counts in all_counts]
    return all_counts[0], max(totals) - min(totals)


def line(name, cells):
    return "| " + " | ".join([name, *cells]) + " |"


def main():
    options = arguments()
    columns = ["total", *STAGES, "other"]
    print(line("millions of instructions", columns) + "\n|" + "---|" * (len(columns) + 1))
    with tempfile.TemporaryDirectory() as meshes:
        meshes = pathlib.Path(meshes)
        ball(meshes / "ball.obj", 2 if options.quick else 5)
        (meshes / "library").mkdir()
        shutil.copy(DATA / "amphora.ply", meshes / "vessel.ply")
        shutil.copy(DATA / "amphora.ply", meshes / "library" / "vessel.ply")
        spreads = []
        for name, command in runs(options.quick).items():
            counts, spread = counted(options.sherd, command, meshes, options.repeats)
            spreads.append(spread / counts["total"])
            print(line(name, [f"{counts[c] / 1e6:,.1f}" for c in columns]), flush=True)
            if options.before is None:
                continue
            before, spread = counted(options.before, command, meshes, options.repeats)
            spreads.append(spread / before["total"])
            print(line(f"{name}, before", [f"{before[c] / 1e6:,.1f}" for c in columns]))
            print(line(f"{name}, ratio", [f"{counts[c] / before[c]:.3f}" if before[c] else "" for c in columns]), flush=True)
    if options.repeats > 1:
        print(f"\nTotals of {options.repeats} runs of the same differ by at most {1e6 * max(spreads):.2f} millionths.")


if __name__ == "__main__":
    main()
