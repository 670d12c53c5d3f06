#!/usr/bin/python3
"""Compare the growths: difference from Voronoi cells, flatness of cracks, connectivity, time.

usage: growth_study.py SHERD RESULTS.csv MESH... [options]

Breaks a ball, made here, and every MESH by each growth from the same seeds.  For each fracture it measures

- the share of voxels whose fragment is not that of `--growth nearest --isolated keep`, the Voronoi cells;
- the rms distance of cracks from planes: for each two fragments that share 50 voxel faces or more, a plane is fitted to
  these faces' centers, with equal weights.  Voxel faces of an exact plane have some 0.25;
- fragments of more than one connected component, and their surplus components;
- voxels disconnected from their fragment's seed in the first pass;
- seconds of growth.

RESULTS.csv gets a row per fracture; existing rows are not run again.  Prints a table in Markdown per mesh.

Needs Debian's python3-numpy and python3-scipy.
"""
import argparse
import csv
import itertools
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import scipy.ndimage

GROWTHS = {
    "nearest keep": ["--growth", "nearest", "--isolated", "keep"],  # first: the reference for the others
    "nearest": ["--growth", "nearest"],
    "euclid": ["--growth", "euclid"],
    "chain": ["--growth", "chain"],
    "flood": ["--growth", "flood"],
    "flood 26": ["--growth", "flood", "--neighborhood", "26"],
    "flood 26 keep": ["--growth", "flood", "--neighborhood", "26", "--isolated", "keep"],
}
COLUMNS = ["mesh", "resolution", "pieces", "seed", "growth", "fragments", "voxels", "differing", "square", "faces", "split",
           "loose_parts", "freed", "seconds"]
FEWEST_FACES = 50


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("results", type=pathlib.Path, help="CSV file, made or continued")
    parser.add_argument("meshes", nargs="*", type=pathlib.Path, metavar="MESH", help="a closed mesh, beside the ball")
    parser.add_argument("--pieces", type=int, default=10)
    parser.add_argument("--seeds", type=int, default=10, help="random seeds 1..SEEDS (default 10)")
    parser.add_argument("--resolution", type=int, default=128, help="voxels along the longest side (default 128)")
    return parser.parse_args()


def icosphere(levels):
    """Vertices and triangles of a unit ball: an icosahedron, each triangle split in four `levels` times."""
    golden = (1 + 5**0.5) / 2
    vertices = [np.roll((0, a, b * golden), k) for k in range(3) for a in (-1, 1) for b in (-1, 1)]
    edge = [{j for j in range(12) if 0 < np.linalg.norm(vertices[i] - vertices[j]) < 2.1} for i in range(12)]
    triangles = [(i, j, k) for i, j, k in itertools.combinations(range(12), 3) if {j, k} <= edge[i] and k in edge[j]]
    triangles = [t if np.linalg.det([vertices[i] for i in t]) > 0 else t[::-1] for t in triangles]
    for _ in range(levels):
        middle = {}

        def between(i, j):
            key = (min(i, j), max(i, j))
            if key not in middle:
                middle[key] = len(vertices)
                vertices.append((vertices[i] + vertices[j]) / 2)
            return middle[key]

        split = []
        for i, j, k in triangles:
            a, b, c = between(i, j), between(j, k), between(k, i)
            split += [(i, a, c), (a, j, b), (c, b, k), (a, b, c)]
        triangles = split
        vertices = [v / np.linalg.norm(v) for v in vertices]
    return vertices, triangles


def write_obj(file, vertices, triangles):
    file.write_text("".join("v %.9g %.9g %.9g\n" % tuple(v) for v in vertices) +
                    "".join("f %d %d %d\n" % (i + 1, j + 1, k + 1) for i, j, k in triangles))


def fracture(options, mesh, seed, growth):
    """Fragment ids [x, y, z], 0 outside (see docs/formats.md), and the report."""
    with tempfile.TemporaryDirectory(prefix="sherd-growth-") as folder:
        done = subprocess.run([options.sherd, "fracture", mesh, "-o", folder, "--pieces", str(options.pieces), "--seed",
                               str(seed), "--resolution", str(options.resolution), "--write", "labels", "--json", "--quiet",
                               *GROWTHS[growth]], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            sys.exit(f"growth_study.py: {done.stderr.strip()}")
        raw = (pathlib.Path(folder) / "labels.rle").read_bytes()
    dims = np.frombuffer(raw, "<u4", 3)
    runs = np.frombuffer(raw, [("label", "<u2"), ("length", "<u4")], offset=12)
    labels = np.repeat(runs["label"].astype(np.int32) - 1, runs["length"]).reshape(dims)
    return np.maximum(labels, 0), json.loads(done.stdout)


def flatness(labels):
    """Sum of squared distances of crack faces from their planes, and the number of these faces."""
    pairs, positions = [], []
    for axis in range(3):
        a, b = np.delete(labels, -1, axis), np.delete(labels, 0, axis)
        at = np.argwhere((a != b) & (a > 0) & (b > 0))
        low, high = a[tuple(at.T)], b[tuple(at.T)]
        pairs.append(np.minimum(low, high) * 65536 + np.maximum(low, high))
        positions.append(at + 0.5 * (np.arange(3) == axis))
    pairs, positions = np.concatenate(pairs), np.concatenate(positions)
    square, faces = 0.0, 0
    for pair in np.unique(pairs):
        crack = positions[pairs == pair]
        if len(crack) >= FEWEST_FACES:
            square += np.linalg.svd(crack - crack.mean(axis=0), compute_uv=False)[-1]**2
            faces += len(crack)
    return square, faces


def parts(labels):
    """Number of fragments of several connected components, and of surplus components."""
    several = [scipy.ndimage.label(labels[box] == k + 1)[1]
               for k, box in enumerate(scipy.ndimage.find_objects(labels)) if box is not None]
    return sum(n > 1 for n in several), sum(n - 1 for n in several)


def observe(options, mesh, seed):
    """A row per growth."""
    voronoi = None
    for growth in GROWTHS:
        labels, report = fracture(options, mesh, seed, growth)
        voronoi = labels if voronoi is None else voronoi
        square, faces = flatness(labels)
        split, loose = parts(labels)
        freed = report.get("disconnected_voxels") or [0]
        values = [mesh.name, options.resolution, options.pieces, seed, growth, report["fragments"], report["voxels"],
                  int((labels != voronoi).sum()), round(square, 3), faces, split, loose, freed[0], report["seconds"]["grow"]]
        yield dict(zip(COLUMNS, map(str, values)))


def observe_all(options, meshes):
    rows = []
    if options.results.exists():
        with options.results.open(newline="") as text:
            rows = list(csv.DictReader(text))
    fresh = not options.results.exists()
    with options.results.open("a", newline="") as text:
        writer = csv.DictWriter(text, COLUMNS)
        if fresh:
            writer.writeheader()
        for seed in range(1, options.seeds + 1):
            for mesh in meshes:
                case = [mesh.name, str(options.resolution), str(options.pieces), str(seed)]
                if len([row for row in rows if [row[c] for c in COLUMNS[:4]] == case]) == len(GROWTHS):
                    continue
                new = list(observe(options, mesh, seed))
                writer.writerows(new)
                text.flush()
                rows += new
    return [row for row in rows if row["resolution"] == str(options.resolution) and row["pieces"] == str(options.pieces)
            and int(row["seed"]) <= options.seeds]


def table(rows, mesh):
    lines = ["| growth | not as Voronoi: mean (worst) | off planes, rms | disconnected at first: mean (worst) | fragments of several components "
             "| surplus components | seconds, least (median) |", "|---" * 7 + "|"]
    for growth in GROWTHS:
        of = {c: np.array([float(row[c]) for row in rows if row["growth"] == growth and row["mesh"] == mesh])
              for c in COLUMNS[5:]}
        differing, freed = of["differing"] / of["voxels"], of["freed"] / of["voxels"]
        lines.append(f"| {growth} | {differing.mean():.2%} ({differing.max():.2%}) "
                     f"| {np.sqrt(of['square'].sum() / of['faces'].sum()):.2f} | {freed.mean():.3%} ({freed.max():.3%}) "
                     f"| {of['split'].sum():.0f} of {of['fragments'].sum():.0f} | {of['loose_parts'].sum():.0f} "
                     f"| {of['seconds'].min():.3f} ({np.median(of['seconds']):.3f}) |")
    return "\n".join(lines)


def main():
    options = arguments()
    with tempfile.TemporaryDirectory(prefix="sherd-growth-") as folder:
        ball = pathlib.Path(folder) / "ball.obj"
        write_obj(ball, *icosphere(5))
        meshes = [ball, *options.meshes]
        rows = observe_all(options, meshes)
    for mesh in meshes:
        print(f"{mesh.name}: {sum(row['mesh'] == mesh.name for row in rows) // len(GROWTHS)} seeds, {options.pieces} pieces, "
              f"{options.resolution} voxels along the longest side\n\n{table(rows, mesh.name)}\n")


if __name__ == "__main__":
    main()
