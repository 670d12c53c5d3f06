#!/usr/bin/python3
"""Search fragments for the voxel grid of the solid that they come from, without learning.

usage: grid_study.py SHERD MESH... [--options "--preset training"]

Rotates every MESH at random, anew for each fracture, so that its own planes and axes are not those of the grid, breaks it by
`sherd fracture` into 8 pieces with as many random seeds as give 40 fragments, puts each fragment into a random pose, and looks at

- up to 700 of its vertices, and 700 points sampled on it by area:
- *found*: the direction d of greatest power |mean exp(2 pi i x.d / h)|^2, h the voxel size, over 60,000 directions, of which the
  30 best are refined, lies within one degree of an axis of the grid.  Of random directions 0.05 % do.
- *power*: that along the three axes of the grid, divided by that along the axes of 400 random frames, both as geometric means
  over directions and fragments, which a plane across one of the directions does not decide: it has a power of hundreds, grid
  or not.  It is 1 if the grid left nothing.  The standard error is over the fragments.

Prints a row for each mesh and one for all, in Markdown.  Needs Debian's python3-numpy.
"""
import argparse
import json
import pathlib
import shlex
import sys
import tempfile

import numpy as np

import mesh_file
from realism_study import run

SAMPLE, DIRECTIONS, BEST, FRAMES = 700, 60000, 30, 400


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("meshes", nargs="+", type=pathlib.Path, metavar="MESH", help="closed meshes, .obj or .ply")
    parser.add_argument("--options", default="", help="further options of sherd fracture, one string")
    parser.add_argument("--fragments", type=int, default=40, help="of each mesh, at least (default 40)")
    parser.add_argument("--pieces", type=int, default=8, help="of a fracture (default 8)")
    parser.add_argument("--resolution", type=int, default=64, help="voxels along the longest side (default 64)")
    return parser.parse_args()


def rotation(random):
    """A uniform rotation: the rows of an orthogonal matrix."""
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.sign(np.linalg.det(q))


def vertices_and_faces(sherd, mesh, folder):
    """The vertices of a mesh, and its faces as lines of an .obj file."""
    run(sherd, "convert", mesh, folder / "plain.obj")
    vertices, faces = [], []
    for line in open(folder / "plain.obj"):
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append(words[1:4])
        elif words[:1] == ["f"]:
            faces.append("f " + " ".join(word.split("/")[0] for word in words[1:]) + "\n")
    return np.array(vertices, float), "".join(faces)


def write_rotated(vertices, faces, path, random):
    rows = vertices @ rotation(random).T
    path.write_text("".join("v %.9g %.9g %.9g\n" % tuple(row) for row in rows) + faces)
    return path


def powers(points, directions):
    """Of each direction |mean exp(2 pi i x.d)|^2, times the number of points: 1 in the mean for points without a grid."""
    phase = (2 * np.pi * points).astype(np.float32) @ directions.T.astype(np.float32)
    return (np.cos(phase).mean(axis=0) ** 2 + np.sin(phase).mean(axis=0) ** 2) * len(points)


def hemisphere(count):
    i = np.arange(count) + 0.5
    z, angle = i / count, np.pi * (1 + 5 ** 0.5) * i
    return np.column_stack([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z])


def strongest(points, directions):
    """The direction of the greatest power."""
    power = powers(points, directions)
    best, most = None, -1.0
    for k in np.argsort(power)[-BEST:]:
        d, value, step = directions[k], power[k], 0.006
        while step > 0.0002:
            side = np.cross(d, [1, 0, 0] if abs(d[0]) < 0.6 else [0, 1, 0])
            side /= np.linalg.norm(side)
            ring = d + step * np.array([np.cos(a) * side + np.sin(a) * np.cross(d, side) for a in np.arange(8) * np.pi / 4])
            ring /= np.linalg.norm(ring, axis=1)[:, None]
            around = powers(points, ring)
            if around.max() > value:
                d, value = ring[around.argmax()], around.max()
            else:
                step /= 2
        if value > most:
            best, most = d, value
    return best


def measure(points, random, directions):
    """Whether the grid was found; the mean logarithm of its power; that of random frames.  The unit is the voxel."""
    if len(points) > SAMPLE:
        points = points[random.choice(len(points), SAMPLE, replace=False)]
    pose = rotation(random)
    points = (points - points.mean(axis=0)) @ pose.T
    found = np.abs(pose.T @ strongest(points, directions)).max() > np.cos(np.radians(1.0))
    frames = np.vstack([rotation(random) for _ in range(FRAMES)])
    return found, np.log(powers(points, pose.T)).mean(), np.log(powers(points, frames)).mean()


def observe(options, mesh, number):
    """[fragments] measures of the vertices and of the points of a mesh's fragments."""
    random, directions = np.random.default_rng(number), hemisphere(DIRECTIONS)
    rows = []
    with tempfile.TemporaryDirectory(prefix="sherd-grid-") as folder:
        folder = pathlib.Path(folder)
        vertices, faces = vertices_and_faces(options.sherd, mesh, folder)
        seed = 0
        while len(rows) < options.fragments:
            seed += 1
            out = folder / str(seed)
            source = write_rotated(vertices, faces, folder / "rotated.obj", random)
            run(options.sherd, "fracture", source, "-o", out, "--pieces", options.pieces, "--seed", seed, "--resolution",
                options.resolution, "--write", "mesh,points", "--mesh-format", "ply", "--points", SAMPLE,
                *shlex.split(options.options))
            manifest = json.loads((out / "manifest.json").read_text())
            h = manifest["grid"]["voxel_size"]
            for fragment in manifest["fragments"]:
                if len(rows) == options.fragments or fragment.get("withheld"):
                    continue
                name = f"*_{fragment['id']:03}.ply"
                meshed = mesh_file.read_mesh(next((out / "meshes").glob(name)))[0]
                ply = mesh_file.read_ply(next((out / "points").glob(name)))["vertex"]
                sampled = np.column_stack([ply[axis] for axis in "xyz"]).astype(float)
                if len(meshed) < 100:
                    continue
                rows.append((*measure(meshed / h, random, directions), *measure(sampled / h, random, directions)))
    return np.array(rows, float)


def row(name, rows):
    cells = [name, str(len(rows))]
    for first in (0, 3):
        above = rows[:, first + 1] - rows[:, first + 2]
        ratio, error = np.exp(above.mean()), above.std(ddof=1) / np.sqrt(len(rows))
        cells += [f"{int(rows[:, first].sum())}", f"{ratio:.2f} +- {ratio * error:.2f}"]
    print("| " + " | ".join(cells) + " |", flush=True)


def main():
    options = arguments()
    print("| mesh | fragments | vertices: found | power | points: found | power |\n|---|---|---|---|---|---|")
    everything = []
    for number, mesh in enumerate(options.meshes):
        everything.append(observe(options, mesh, number))
        row(mesh.stem, everything[-1])
    row("all", np.vstack(everything))


if __name__ == "__main__":
    sys.exit(main())
