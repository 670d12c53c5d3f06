#!/usr/bin/python3
"""The same crack at two resolutions: fractures of meshes with random seeds, at 96 and at 256 voxels.

usage: same_crack.py SHERD [--meshes FOLDER] [--repeats N] [--resolutions A,B] [--only NAME,...] [--again] [CASE ...]

With --again meshes are broken into 8 pieces by seeds, and the third again by each case: its parts are compared.

Meshes are those of FOLDER that are closed and resolved by 96 voxels (MESHES below), the repository's own and generated ones: 20 in all.
A fragment agrees where its centroid moves by at most a hundredth of the longest side; a pair, where as many fragments come out and all agree.
Prints what does not agree, with what the program says about the solid, and a table.  Some four seconds for each pair on two cores.
"""
import argparse
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

# Closed meshes of one body whose walls 96 voxels resolve.
MESHES = ["armadillo.obj", "bunny.off", "bunny_closed_high_res.stl", "dragon.obj", "lucy.ply", "vase_goblet.stl", "boot.obj", "flange.stl.gz",
          "screw-big.obj", "nut-big.obj", "springer.obj", "3DBenchy.ply", "ADIS16480.STL", "self_intersectA.obj"]

# Options of each case; {ray} is an impact's ray to a point inside.
CASES = {
    "seeds": ["--pieces", "8"],
    "sequential": ["--pieces", "8", "--growth", "sequential"],
    "stone": ["--pieces", "8", "--material", "stone"],
    "impact": ["--pieces", "12", "--impact", "{ray}"],
    "impact,energy": ["--pieces", "40", "--impact", "{ray},energy=1"],
    "impact, sequential": ["--pieces", "20", "--growth", "sequential", "--impact", "{ray},energy=1"],
    "impact, glass": ["--pieces", "20", "--material", "glass", "--impact", "{ray},12"],
}
MORE_CASES = {
    "glass": ["--pieces", "12", "--material", "glass"],
    "wood": ["--pieces", "12", "--material", "wood"],
    "50 splits": ["--pieces", "50", "--growth", "sequential"],
    "impacts": ["--pieces", "20", "--impacts", "2"],
}


def written(path, vertices, faces):
    lines = ["v %.9g %.9g %.9g" % v for v in vertices] + ["f " + " ".join(str(i + 1) for i in f) for f in faces]
    path.write_text("\n".join(lines) + "\n")


def turned(profile, steps=64):
    """The solid of a closed profile of (radius, height) about the y axis."""
    n = len(profile)
    vertices = [(r * math.cos(2 * math.pi * s / steps), y, r * math.sin(2 * math.pi * s / steps)) for s in range(steps) for r, y in profile]
    faces = [((s * n + i), (s * n + (i + 1) % n), ((s + 1) % steps * n + (i + 1) % n), ((s + 1) % steps * n + i))
             for s in range(steps) for i in range(n)]
    return vertices, [f[::-1] for f in faces]


def extruded(outline, depth):
    n = len(outline)
    vertices = [(x, y, 0.0) for x, y in outline] + [(x, y, depth) for x, y in outline]
    return vertices, [tuple(range(n))[::-1], tuple(range(n, 2 * n))] + [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]


def generated(folder):
    """Writes a block, a plate, a torus, a bowl and an angle; returns their paths."""
    shapes = {
        "block.obj": extruded([(0, 0), (1.0, 0), (1.0, 0.83), (0, 0.83)], 0.71),
        "plate.obj": extruded([(0, 0), (1.0, 0), (1.0, 0.8), (0, 0.8)], 0.05),
        "torus.obj": turned([(1 + 0.37 * math.cos(a * math.pi / 16), 0.37 * math.sin(a * math.pi / 16)) for a in range(32)]),
        "bowl.obj": turned([(1e-3 + math.sin(a * math.pi / 32), -math.cos(a * math.pi / 32)) for a in range(17)] +
                           [(1e-3 + 0.9 * math.sin(a * math.pi / 32), -0.9 * math.cos(a * math.pi / 32)) for a in range(16, -1, -1)]),
        "angle.obj": extruded([(0, 0), (1.0, 0), (1.0, 0.27), (0.31, 0.27), (0.31, 0.9), (0, 0.9)], 0.47),
    }
    for name, (vertices, faces) in shapes.items():
        written(folder / name, vertices, faces)
    return [folder / name for name in shapes]


def broken(sherd, mesh, seed, resolution, folder, options):
    """The manifest of a fracture, or None, and what is printed."""
    run = subprocess.run([sherd, "fracture", mesh, "-o", folder, "--seed", str(seed), "--resolution", str(resolution),
                          "--write", "labels", "--json", *options], capture_output=True, text=True)
    if run.returncode:
        return None, run.stderr
    return json.loads((folder / "manifest.json").read_text()), json.loads(run.stdout)


def broken_again(sherd, mesh, seed, resolution, folder, options):
    """The same of a fracture whose third fragment is broken again: the manifest has its parts alone."""
    whole, printed = broken(sherd, mesh, seed, resolution, folder / "whole", ["--pieces", "8", "--write", "labels,mesh"])
    if whole is None:
        return None, printed
    run = subprocess.run([sherd, "fracture", folder / "whole", "--only", "3", "-o", folder / "parts", "--seed", str(seed + 1), "--write", "labels",
                          "--json", *options], capture_output=True, text=True)
    if run.returncode:
        return None, run.stderr
    manifest = json.loads((folder / "parts" / "manifest.json").read_text())
    kept = {f["id"] for f in whole["fragments"]} - {3}
    manifest["side"] = longest_side(manifest)
    manifest["fragments"] = [f for f in manifest["fragments"] if f["id"] not in kept]
    return manifest, printed


def longest_side(manifest):
    if "side" in manifest:
        return manifest["side"]

    low = [min(f["bbox"]["min"][a] for f in manifest["fragments"]) for a in range(3)]
    high = [max(f["bbox"]["max"][a] for f in manifest["fragments"]) for a in range(3)]
    return max(h - l for l, h in zip(low, high))


def ray_to(sherd, mesh, draw, temp):
    """A ray from afar to a point inside the mesh, as an impact's target."""
    manifest, printed = broken(sherd, mesh, 1, 96, temp, ["--pieces", "4"])
    if manifest is None:
        sys.exit(f"{mesh.name}: {printed}")
    end = draw.choice(manifest["fragments"])["seeds"][0]
    direction = [draw.gauss(0, 1) for _ in range(3)]
    size = math.hypot(*direction)
    far = 3 * longest_side(manifest)
    start = [e - far * d / size for e, d in zip(end, direction)]
    return "ray:" + ",".join("%.17g" % c for c in start + direction)


class Tally:
    def __init__(self):
        self.pairs = self.agreeing_pairs = self.fragments = self.agreeing = self.equal_counts = 0
        self.worst = []

    def line(self, name):
        share = 100 * self.agreeing / max(self.fragments, 1)
        return (f"| {name} | {self.agreeing} of {self.fragments}, {share:.0f} % | {self.agreeing_pairs} of {self.pairs} | "
                f"{self.equal_counts} of {self.pairs} | {100 * statistics.median(self.worst or [0]):.2f} % |")


def compared(name, mesh, seed, ends, tally):
    """Adds a pair to the tally, and prints what does not agree."""
    (coarse, of_coarse), (fine, of_fine) = ends
    if coarse is None or fine is None:
        print(f"{name}: {mesh.name} seed {seed}: left out, {(of_coarse if coarse is None else of_fine).strip()}", flush=True)
        return
    side = longest_side(fine)
    moves = [math.dist(a["centroid"], b["centroid"]) / side for a, b in zip(coarse["fragments"], fine["fragments"])]
    agree = sum(m <= 0.01 for m in moves)
    count = max(len(coarse["fragments"]), len(fine["fragments"]))
    tally.pairs += 1
    tally.fragments += count
    tally.agreeing += agree
    tally.agreeing_pairs += agree == count
    tally.equal_counts += len(coarse["fragments"]) == len(fine["fragments"])
    tally.worst.append(max(moves))
    if agree == count:
        return
    thin = [report["report"]["walls"].get("thinnest_voxels", 0) for report in (of_coarse, of_fine)]
    lost = 1 - of_coarse["report"]["solid_volume"] / of_fine["report"]["solid_volume"]
    print(f"{name}: {mesh.name} seed {seed}: {count - agree} of {count} fragments move, by {100 * max(moves):.1f} % at most; components "
          f"{of_coarse['components']} and {of_fine['components']}, thinnest walls {thin[0]:.2g} and {thin[1]:.2g} voxels, "
          f"{100 * lost:.1f} % of the volume between them", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sherd")
    parser.add_argument("--meshes", type=pathlib.Path)
    parser.add_argument("--repeats", type=int, default=1)
    parser.add_argument("--resolutions", default="96,256")
    parser.add_argument("--only", default="", help="names of meshes")
    parser.add_argument("--again", action="store_true", help="break a fragment again")
    parser.add_argument("cases", nargs="*")
    args = parser.parse_intermixed_args()
    resolutions = [int(r) for r in args.resolutions.split(",")]
    all_cases = {**CASES, **MORE_CASES}
    cases = {name: all_cases[name] for name in args.cases or CASES}
    tallies = {name: Tally() for name in cases}
    with tempfile.TemporaryDirectory() as temp:
        temp = pathlib.Path(temp)
        meshes = [pathlib.Path(__file__).parents[2] / "data" / "amphora.ply", *generated(temp)]
        meshes += [args.meshes / name for name in MESHES] if args.meshes else []
        for mesh in meshes:
            if args.only and mesh.name not in args.only.split(","):
                continue
            draw = random.Random(mesh.name)
            for repeat in range(args.repeats):
                seed, ray = draw.randrange(1, 10**6), ray_to(args.sherd, mesh, draw, temp / f"ray-{mesh.name}-{repeat}")
                for name, options in cases.items():
                    options = [o.replace("{ray}", ray) for o in options]
                    ends = []
                    for resolution in resolutions:
                        with tempfile.TemporaryDirectory() as out:
                            ends.append((broken_again if args.again else broken)(args.sherd, mesh, seed, resolution, pathlib.Path(out) / "out", options))
                    compared(name, mesh, seed, ends, tallies[name])
    print("\n| options | fragments that agree | pairs | equal counts | median of the largest move |\n|---|---|---|---|---|")
    for name, tally in tallies.items():
        print(tally.line(name))


main()
