#!/usr/bin/python3
"""How far cracks lean from the normals of a thin wall: the mean angle over voxel faces of cracks at its surface.

    tools/wall_angles.py sherd data/amphora.ply [--pieces 30] [--resolution 192] [OPTION ...]

Breaks the mesh with five seeds by --seeds-on volume and by --seeds-on wall.  A crack's normal is the difference of the two seeds; the wall's is
the gradient of the solid, smoothed over 7 voxels, at voxels of its surface.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np


def smoothed(values):
    for axis in range(3):
        for width in (3, 3, 3):
            values = sum(np.roll(values, k, axis) for k in range(-(width // 2), width // 2 + 1)) / width
    return values


def lean(folder):
    """Angles in degrees, one for each voxel face of a crack at the surface."""
    manifest = json.loads((folder / "manifest.json").read_text())
    labels = np.pad(np.load(folder / "labels.npy").astype(np.int32), 4)
    seed = {f["id"]: np.array(f["seeds"][0]) for f in manifest["fragments"]}
    solid = labels > 0
    normal = np.stack(np.gradient(smoothed(solid.astype(np.float32))), -1)
    inner = solid.copy()
    for axis in range(3):
        for k in (-1, 1):
            inner &= np.roll(solid, k, axis)
    surface, angles = solid & ~inner, []
    for axis in range(3):
        a, b = labels, np.roll(labels, -1, axis)
        at = np.argwhere((a > 0) & (b > 0) & (a != b) & surface)
        own, other = a[tuple(at.T)], b[tuple(at.T)]
        crack = np.array([seed[i - 1] - seed[j - 1] for i, j in zip(own, other)])  # a label is an id + 1
        wall = normal[tuple(at.T)]
        good = np.linalg.norm(wall, axis=1) > 0.02
        cosine = np.abs((crack * wall).sum(1)[good]) / np.linalg.norm(crack[good], axis=1) / np.linalg.norm(wall[good], axis=1)
        angles.append(np.degrees(np.arcsin(np.clip(cosine, 0, 1))))
    return np.concatenate(angles)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd")
    parser.add_argument("mesh")
    parser.add_argument("--pieces", default="30")
    parser.add_argument("--resolution", default="192")
    arguments, more = parser.parse_known_args()
    for place in "volume", "wall":
        angles = []
        for seed in range(5):
            with tempfile.TemporaryDirectory() as folder:
                out = pathlib.Path(folder) / "out"
                subprocess.run([arguments.sherd, "fracture", arguments.mesh, "-o", out, "--pieces", arguments.pieces, "--seed", str(seed), "--resolution",
                                arguments.resolution, "--seeds-on", place, "--write", "labels", "--voxel-format", "npy", "--quiet", *more], check=True)
                angles.append(lean(out))
        angles = np.concatenate(angles)
        print(f"{place:7} mean {angles.mean():5.2f}, median {np.median(angles):5.2f}, above 10: {100 * (angles > 10).mean():5.1f} %")


if __name__ == "__main__":
    main()
