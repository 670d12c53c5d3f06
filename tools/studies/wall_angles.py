#!/usr/bin/python3
"""How far cracks lean from the normals of a thin wall: the mean angle over the area of cracks.

    tools/studies/wall_angles.py sherd data/amphora.ply [--pieces 30] [--resolution 192] [--runs 5] [--compare "--seeds-on volume" "--seeds-on wall"] [OPTION ...]

Breaks the mesh with some seeds, by each set of options that is compared.  A crack's normals are those of its triangles, the wall's those of the
triangle of the original surface that is nearest.  Cracks that cross the wall at right angles have 0.
"""
import argparse
import json
import pathlib
import shlex
import subprocess
import tempfile

import numpy as np
from scipy.spatial import cKDTree

from mesh_file import read_mesh


def triangles_of(vertices, triangles):
    """Centers, unit normals and areas."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    return (a + b + c) / 3, normal / np.maximum(length, 1e-300)[:, None], length / 2


def lean(folder):
    """Angles in degrees of the triangles of cracks, and their areas."""
    manifest = json.loads((folder / "manifest.json").read_text())
    center, normal, area, neighbor = [], [], [], []
    for fragment in manifest["fragments"]:
        vertices, triangles, own = read_mesh(folder / fragment["files"]["mesh"])
        for values, new in zip((center, normal, area, neighbor), (*triangles_of(vertices, triangles), own)):
            values.append(new)
    center, normal, area, neighbor = (np.concatenate(each) for each in (center, normal, area, neighbor))
    original = (neighbor == 0) & (area > 0)
    crack = (neighbor > 0) & (area > 0)
    nearest = cKDTree(center[original]).query(center[crack])[1]
    cosine = np.abs((normal[crack] * normal[original][nearest]).sum(1))
    return np.degrees(np.arcsin(np.clip(cosine, 0, 1))), area[crack]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd")
    parser.add_argument("mesh")
    parser.add_argument("--pieces", default="30")
    parser.add_argument("--resolution", default="192")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--compare", nargs="+", default=["--seeds-on volume", "--seeds-on wall"])
    arguments, more = parser.parse_known_args()
    for options in arguments.compare:
        angles, areas = [], []
        for seed in range(arguments.runs):
            with tempfile.TemporaryDirectory() as folder:
                out = pathlib.Path(folder) / "out"
                subprocess.run([arguments.sherd, "fracture", arguments.mesh, "-o", out, "--pieces", arguments.pieces, "--seed", str(seed), "--resolution",
                                arguments.resolution, "--write", "mesh", "--quiet", *shlex.split(options), *more], check=True)
                angle, area = lean(out)
                angles.append(angle)
                areas.append(area)
        angles, areas = np.concatenate(angles), np.concatenate(areas)
        order = np.argsort(angles)
        median = angles[order][np.searchsorted(np.cumsum(areas[order]), areas.sum() / 2)]
        print(f"{options:40} mean {np.average(angles, weights=areas):5.2f}, median {median:5.2f}, above 10: {100 * areas[angles > 10].sum() / areas.sum():5.1f} %",
              flush=True)


if __name__ == "__main__":
    main()
