#!/usr/bin/python3
"""Measure how well `neighbor` separates original surface from cracks, compared with labels from distances.

usage: neighbor_study.py SHERD [options]

Makes cups of revolution with walls of several thicknesses, breaks them, and computes the ground truth of each face analytically: it
belongs to the cup if the cup is nearer than the crack, the bisecting plane of two seeds.  Faces whose centroids lie
within half a voxel of a contact boundary are left out, because both are near there.  It compares

- `neighbor`, as written by Sherd per face;
- labels by distance, as in data sets without such a record: a face is original within a share of the box's
  longest side from the intact surface.

Prints a table in Markdown: the share of wrong faces among those of cracks, and among those of the original surface.

Needs Debian's python3-numpy and python3-scipy.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np
import scipy.spatial

from mesh_file import read_mesh

RADIUS, HEIGHT, SEGMENTS = 1.0, 1.5, 512
SHARES = (0.025, 0.01, 0.005)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("--walls", type=float, nargs="+", default=[2, 3, 4, 6, 8], metavar="VOXELS")
    parser.add_argument("--seeds", type=int, default=5, help="random seeds 1..SEEDS (default 5)")
    parser.add_argument("--pieces", type=int, default=8)
    parser.add_argument("--resolution", type=int, default=128, help="voxels along the longest side (default 128)")
    return parser.parse_args()


def section(wall):
    """The cup's outline from axis to axis: radius and height."""
    return np.array([(0, 0), (RADIUS, 0), (RADIUS, HEIGHT), (RADIUS - wall, HEIGHT), (RADIUS - wall, wall), (0, wall)])


def write_cup(file, wall):
    outline = section(wall)
    angles = 2 * np.pi * np.arange(SEGMENTS) / SEGMENTS
    rings = [np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(SEGMENTS, z)]) for r, z in outline[1:-1]]
    vertices = np.vstack(rings + [[[0, 0, outline[0][1]], [0, 0, outline[-1][1]]]])
    bottom, top = len(vertices) - 2, len(vertices) - 1
    faces = []
    for i in range(SEGMENTS):
        j = (i + 1) % SEGMENTS
        faces.append((bottom, j, i))
        for ring in range(len(rings) - 1):
            a, b = ring * SEGMENTS, (ring + 1) * SEGMENTS
            faces += [(a + i, a + j, b + j), (a + i, b + j, b + i)]
        last = (len(rings) - 1) * SEGMENTS
        faces.append((last + i, last + j, top))
    with open(file, "w") as out:
        out.writelines("v %.9f %.9f %.9f\n" % tuple(v) for v in vertices)
        out.writelines("f %d %d %d\n" % tuple(i + 1 for i in f) for f in faces)


def to_cup(points, wall):
    outline = section(wall)
    at = np.column_stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]])
    distances = []
    for start, end in zip(outline[:-1], outline[1:]):
        along = end - start
        t = np.clip((at - start) @ along / (along @ along), 0, 1)
        distances.append(np.linalg.norm(at - start - t[:, None] * along, axis=1))
    return np.min(distances, axis=0)


def near_contact_boundaries(vertices, triangles, neighbor, centers, distance):
    """Which centers lie within a distance of an edge between the original surface and a crack."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    kinds = np.repeat(np.where(neighbor == 0, 1, 2), 3)
    unique, of = np.unique(edges, axis=0, return_inverse=True)
    kind = np.zeros(len(unique), int)
    np.bitwise_or.at(kind, of.ravel(), kinds)
    a, b = vertices[unique[kind == 3]].swapaxes(0, 1)
    if len(a) == 0:
        return np.zeros(len(centers), bool)
    steps = np.linspace(0, 1, 17)[:, None, None]
    tree = scipy.spatial.cKDTree((a + steps * (b - a)).reshape(-1, 3))
    return tree.query(centers)[0] < distance


def faces_of(sherd, mesh, wall, seed, options):
    """Per face away from contact boundaries: true crack, recorded crack, distance to the cup."""
    with tempfile.TemporaryDirectory(prefix="sherd-neighbor-") as folder:
        subprocess.run([sherd, "fracture", mesh, "--pieces", str(options.pieces), "--seed", str(seed), "--resolution",
                        str(options.resolution), "--write", "mesh", "-o", folder, "--quiet"], check=True)
        manifest = json.loads((pathlib.Path(folder) / "manifest.json").read_text())
        voxel = manifest["grid"]["voxel_size"]
        seeds = {f["id"]: np.array(f["seeds"][0]) for f in manifest["fragments"]}
        for fragment in manifest["fragments"]:
            vertices, triangles, neighbor = read_mesh(pathlib.Path(folder) / fragment["files"]["mesh"])
            centers = vertices[triangles].mean(axis=1)
            kept = ~near_contact_boundaries(vertices, triangles, neighbor, centers, 0.5 * voxel)
            centers, neighbor = centers[kept], neighbor[kept]
            own = seeds[fragment["id"]]
            planes = [np.abs((centers - (own + there) / 2) @ (there - own)) / np.linalg.norm(there - own)
                      for other, there in seeds.items() if other != fragment["id"]]
            cup = to_cup(centers, wall)
            yield np.column_stack([cup >= np.min(planes, axis=0), neighbor != 0, cup])


def percent(wrong, of):
    return "%.3g %%" % (100.0 * np.count_nonzero(wrong & of) / np.count_nonzero(of))


def main():
    options = arguments()
    names = ["`neighbor`"] + ["distance, %g of the box" % share for share in SHARES]
    print("| wall, voxels | faces | of cracks |" + "".join(" %s |" % name for name in names))
    print("|---|---|---|" + "---|" * len(names))
    side = 2 * RADIUS
    for voxels in options.walls:
        wall = voxels * side / options.resolution
        with tempfile.TemporaryDirectory(prefix="sherd-neighbor-") as folder:
            mesh = str(pathlib.Path(folder) / "cup.obj")
            write_cup(mesh, wall)
            table = np.vstack([rows for seed in range(1, options.seeds + 1)
                               for rows in faces_of(options.sherd, mesh, wall, seed, options)])
        crack, recorded, cup = table[:, 0] > 0, table[:, 1] > 0, table[:, 2]
        answers = [recorded] + [cup > share * side for share in SHARES]
        cells = ["%s / %s" % (percent(crack & ~a, crack), percent(~crack & a, ~crack)) for a in answers]
        print("| %g | %d | %d | %s |" % (voxels, len(table), np.count_nonzero(crack), " | ".join(cells)), flush=True)


if __name__ == "__main__":
    main()
