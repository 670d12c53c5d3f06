#!/usr/bin/python3
"""Exact pieces of bodies that overlap add up to their union as Manifold computes it, and each piece is one body by its reading.

usage: manifold_union.py COUNT [SEED]    (needs manifold3d 3 and NumPy; SHERD_BIN names the program, KEEP a prefix of files of what fails)

Random boxes, wedges and balls, two to seven at a time, rotated or not, broken with --surface exact in planes and as stone.  Manifold's
union is of doubles: sums of volumes may differ from its by 1e-9 of the box.  Bodies on a grid may meet in edges, where sheets of the
union are parted by 3e-5 of the longest side, up to 2.5e-4: by 1e-4.
"""
import itertools
import json
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile

import manifold3d
import numpy as np

SHERD = os.environ["SHERD_BIN"]


def box(sides):
    corners = np.array(list(itertools.product(*((-s / 2, s / 2) for s in sides))))
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])


def wedge(sides):
    x, y, z = (s / 2 for s in sides)
    corners = np.array([(-x, -y, -z), (x, -y, -z), (-x, y, -z), (-x, -y, z), (x, -y, z), (-x, y, z)])
    return corners, np.array([(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)])


def ball(sides):
    n, radius = 12, min(sides) / 2
    corners = [(0, 0, radius)]
    for i in range(1, n):
        a = math.pi * i / n
        corners += [(radius * math.sin(a) * math.cos(2 * math.pi * k / n), radius * math.sin(a) * math.sin(2 * math.pi * k / n), radius * math.cos(a))
                    for k in range(n)]
    corners.append((0, 0, -radius))
    at = lambda i, k: 1 + (i - 1) * n + k % n  # noqa: E731
    faces = [(0, at(1, k), at(1, k + 1)) for k in range(n)] + [(len(corners) - 1, at(n - 1, k + 1), at(n - 1, k)) for k in range(n)]
    for i in range(1, n - 1):
        faces += [t for k in range(n) for t in ((at(i, k), at(i + 1, k), at(i + 1, k + 1)), (at(i, k), at(i + 1, k + 1), at(i, k + 1)))]
    return np.array(corners), np.array(faces)


def rotation(draw):
    q = np.array([draw.gauss(0, 1) for _ in range(4)])
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def bodies_of(draw):
    """On a grid of quarters, so that faces, edges and vertices fall together, or anywhere."""
    is_grid, bodies = draw.random() < 0.5, []
    for _ in range(draw.randint(2, 7)):
        sides = [draw.randint(1, 6) / 4 if is_grid else draw.uniform(0.3, 1.5) for _ in range(3)]
        vertices, faces = draw.choice((box, box, wedge, ball))(sides)
        if not is_grid:
            vertices = vertices @ rotation(draw).T
        bodies.append((vertices + [draw.randint(-4, 4) / 4 if is_grid else draw.uniform(-1, 1) for _ in range(3)], faces))
    return is_grid, bodies


def solid(vertices, faces):
    mesh = manifold3d.Mesh64(np.array(vertices, np.float64), np.array(faces, np.uint64))
    mesh.merge()
    return manifold3d.Manifold(mesh)


def read_ply(path):
    with open(path, "rb") as file:
        raw = file.read()
    end = raw.index(b"end_header\n") + 11
    counts = {w[1]: int(w[2]) for w in (line.split() for line in raw[:end].decode().splitlines()) if w[0] == "element"}
    assert b"property double x" in raw[:end]
    vertices = np.frombuffer(raw, "<f8", 3 * counts["vertex"], end).reshape(-1, 3)
    faces = np.frombuffer(raw, np.dtype([("n", "u1"), ("v", "<u4", 3)]), counts["face"], end + 24 * counts["vertex"])
    assert (faces["n"] == 3).all()
    return vertices, faces["v"].astype(np.int64)


def touch(parts, near):
    """Whether bodies meet in vertices or edges, where they are not united, or were parted there (docs/guarantees.md)."""
    return any(a.min_gap(b, 2 * near) < near for a, b in itertools.combinations(parts, 2))


def faults_of(mesh, expected, box, is_grid, arguments, folder):
    box_volume = float(np.prod(box))
    out = os.path.join(folder, "out")
    run = subprocess.run([SHERD, "fracture", mesh, "-o", out, "--surface", "exact", "--plain-meshes", "--precision", "double", "--write", "mesh", "--quiet",
                          *arguments], capture_output=True, text=True, env={**os.environ, "OCL_ICD_VENDORS": "pocl.icd"})
    if run.returncode:
        return [] if "voxel" in run.stderr else [run.stderr.strip()]
    with open(os.path.join(out, "manifest.json")) as file:
        manifest = json.load(file)
    if {f["surface"] for f in manifest["fragments"]} != {"exact"}:
        return None
    found, volume = [], 0.0
    for fragment in manifest["fragments"]:
        vertices, faces = read_ply(os.path.join(out, fragment["files"]["mesh"]))
        a, b, c = (vertices[faces[:, k]] for k in range(3))
        volume += np.einsum("ij,ij->", a, np.cross(b, c)) / 6
        parts = [p for p in solid(vertices, faces).decompose() if p.volume() > 1e-12 * box_volume]
        if len(parts) != 1 and not (is_grid and touch(parts, 1e-3 * max(box))):
            found.append(f"fragment {fragment['id']}: {len(parts)} bodies")
    lost = sum(w in run.stderr for w in ("dropped", "left out"))
    if abs(volume - expected) > (1e-4 if is_grid else 1e-9) * box_volume and not lost:
        found.append(f"volume {volume!r}, the union has {expected!r}")
    return found


def main():
    draw = random.Random(int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    runs = fell_back = bad = 0
    with tempfile.TemporaryDirectory() as folder:
        while runs < int(sys.argv[1]):
            is_grid, bodies = bodies_of(draw)
            mesh = os.path.join(folder, "bodies.obj")
            with open(mesh, "w") as out:
                first = 1
                for i, (vertices, faces) in enumerate(bodies):
                    out.write(f"o body{i}\n")
                    out.writelines("v %r %r %r\n" % tuple(map(float, v)) for v in vertices)
                    out.writelines("f %d %d %d\n" % tuple(int(k) + first for k in t) for t in faces)
                    first += len(vertices)
            union = manifold3d.Manifold.batch_boolean([solid(*body) for body in bodies], manifold3d.OpType.Add)
            every = np.vstack([v for v, _ in bodies])
            for material in ((), ("--material", "stone")):
                arguments = ("--pieces", str(draw.randint(1, 14)), "--resolution", str(draw.choice((32, 48, 64))), "--seed", str(draw.randrange(99)), *material)
                runs += 1
                found = faults_of(mesh, union.volume(), every.max(0) - every.min(0), is_grid, arguments, folder)
                if found is None:
                    fell_back += 1
                elif found:
                    bad += 1
                    print(" ".join(arguments), found)
                    if os.environ.get("KEEP"):
                        shutil.copy(mesh, f"{os.environ['KEEP']}_{bad}.obj")
    print(f"{runs} runs, {fell_back} fell back, {bad} with faults")
    sys.exit(bad > 0)


main()
