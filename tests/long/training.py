#!/usr/bin/env python3
"""Trains examples/python/train.py on shapes made here, with three seeds, and tests it on others.

usage: training.py [STEPS]    (default 300: some five minutes on two cores; with a Python that has pysherd and PyTorch)

Fails if the loss of a run does not fall, or if the F1 on the held-out shapes is not above that of a guess by three standard errors
over the seeds.
"""
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np

TRAIN = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python" / "train.py"
SEEDS = 3


def grid_faces(rows, columns):
    """Faces of a closed grid of vertices: columns go around, the first and the last row are single points in all columns."""
    r, c = np.meshgrid(np.arange(rows - 1), np.arange(columns), indexing="ij")
    a, b, d, e = r * columns + c, r * columns + (c + 1) % columns, (r + 1) * columns + c, (r + 1) * columns + (c + 1) % columns
    return np.concatenate([np.stack([a, b, e], -1).reshape(-1, 3), np.stack([a, e, d], -1).reshape(-1, 3)])


def lathe(profile, columns=48):
    """Rotates a profile of (radius, height), from axis to axis, about z."""
    angle = 2 * np.pi * np.arange(columns) / columns
    radius, height = np.array(profile).T
    points = np.stack([np.outer(radius, np.cos(angle)), np.outer(radius, np.sin(angle)), np.repeat(height[:, None], columns, 1)], -1)
    return points.reshape(-1, 3), grid_faces(len(radius), columns)


def vessel(random):
    """A vessel with a wall, of a random outline."""
    height = np.linspace(0, 1, 24)
    outline = 0.35 + 0.15 * sum(random.uniform(-1, 1) * np.sin((k + 1) * np.pi * height + random.uniform(0, 6)) / (k + 1) for k in range(3))
    outline = np.maximum(outline, 0.15)
    wall = random.uniform(0.05, 0.09)
    inner = np.stack([np.maximum(outline - wall, 0.02), height], -1)[height > wall][::-1]
    return lathe([(0, 0), *np.stack([outline, height], -1), *inner, (0, inner[-1][1])])


def lump(random):
    """A ball with bumps."""
    angle = np.linspace(0, np.pi, 32)
    vertices, faces = lathe(np.stack([np.sin(angle), -np.cos(angle)], -1))
    direction = random.standard_normal((6, 3))
    wave = sum(np.sin(vertices @ d * 2 + p) for d, p in zip(direction, random.uniform(0, 6, 6)))
    return vertices * (1 + 0.06 * wave)[:, None] * random.uniform(0.5, 1, 3), faces


def box(random):
    """A box of random sides."""
    vertices = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * random.uniform(0.3, 1, 3)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))])


def write(folder, shapes, seed, count):
    folder.mkdir()
    random = np.random.default_rng(seed)
    for shape in shapes:
        for i in range(count):
            vertices, faces = shape(random)
            lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in vertices] + [f"f {a} {b} {c}" for a, b, c in faces + 1]
            (folder / f"{shape.__name__}_{i}.obj").write_text("\n".join(lines) + "\n")


def main():
    steps = sys.argv[1] if len(sys.argv) > 1 else "300"
    with tempfile.TemporaryDirectory() as work:
        seen, unseen = pathlib.Path(work) / "seen", pathlib.Path(work) / "unseen"
        write(seen, [vessel, lump, box], 1, 8)
        write(unseen, [vessel, lump, box], 2, 4)
        runs = []
        for seed in range(SEEDS):
            done = subprocess.run([sys.executable, "-B", TRAIN, seen, unseen, steps, str(seed)], stdout=subprocess.PIPE, check=True)
            runs.append(json.loads(done.stdout))
            print(f"seed {seed}: loss {runs[-1]['loss'][0]:.3f} to {runs[-1]['loss'][1]:.3f}, "
                  f"F1 {runs[-1]['f1']:.3f}, of a guess {runs[-1]['chance']:.3f}", flush=True)  # fmt: skip
    above = [run["f1"] - run["chance"] for run in runs]
    error = statistics.stdev(above) / math.sqrt(SEEDS)
    print(f"F1 above a guess: {statistics.mean(above):.3f}, standard error {error:.3f}")
    assert all(run["loss"][1] < run["loss"][0] for run in runs), "the loss does not fall"
    assert statistics.mean(above) > 3 * error, "F1 is not above that of a guess"


if __name__ == "__main__":
    main()
