#!/usr/bin/python3
"""Break a mesh as one would with Python packages alone; run by bench_peers.py.

usage: python_stack.py MESH.ply FOLDER PIECES SEED RESOLUTION FRACTURES

pyopenvdb makes a level set of the mesh, once for all fractures; NumPy gives each inside voxel its nearest of PIECES random
seeds; scikit-image's marching cubes makes a mesh of each label's voxels.  Writes FOLDER/0/piece_0.ply, ...

Needs Debian's python3-openvdb and python3-skimage.
"""
import pathlib
import sys

import numpy as np
import pyopenvdb
from skimage.measure import marching_cubes

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "studies"))
from mesh_file import read_ply  # noqa: E402

MARGIN = 4  # voxels around the mesh


def level_set(path, resolution):
    """Distances over a box around the mesh, the world position of its first voxel, and the voxel size."""
    ply = read_ply(path)
    vertices = np.column_stack([ply["vertex"][axis] for axis in "xyz"]).astype(float)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = (high - low).max() / resolution
    grid = pyopenvdb.FloatGrid.createLevelSetFromPolygons(vertices - low, triangles=ply["face"]["vertex_indices"].astype(np.uint32),
                                                          transform=pyopenvdb.createLinearTransform(size), halfWidth=3)
    distances = np.empty(np.ceil((high - low) / size).astype(int) + 2 * MARGIN, np.float32)
    grid.copyToArray(distances, ijk=(-MARGIN,) * 3)
    return distances, low - MARGIN * size, size


def nearest_seeds(inside, pieces, random):
    """The number 1..pieces of the nearest seed of each inside voxel, else 0."""
    voxels = np.argwhere(inside)
    seeds = voxels[random.choice(len(voxels), pieces, replace=False)]
    voxels = voxels.astype(np.float32)
    best, owner = np.full(len(voxels), np.inf, np.float32), np.zeros(len(voxels), np.uint16)
    for i, seed in enumerate(seeds):
        distance = ((voxels - seed) ** 2).sum(axis=1)
        nearer = distance < best
        best[nearer], owner[nearer] = distance[nearer], i + 1
    labels = np.zeros(inside.shape, np.uint16)
    labels[inside] = owner
    return labels


def mesh_of(labels, label):
    """Vertices in voxels and triangles around the voxels of one label."""
    where = np.argwhere(labels == label)
    low, high = where.min(axis=0) - 1, where.max(axis=0) + 2
    box = labels[tuple(slice(a, b) for a, b in zip(low, high))] == label
    vertices, faces, _, _ = marching_cubes(box.astype(np.float32), 0.5, gradient_direction="ascent")  # faces outwards
    return vertices + low, faces


def write_ply(path, vertices, faces):
    records = np.empty(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    records["count"], records["corners"] = 3, faces
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\n"
              f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(header.encode() + vertices.astype("<f4").tobytes() + records.tobytes())


def main(mesh, folder, pieces, seed, resolution, fractures):
    distances, origin, size = level_set(pathlib.Path(mesh), int(resolution))
    for fracture in range(int(fractures)):
        out = pathlib.Path(folder) / str(fracture)
        out.mkdir(parents=True)
        labels = nearest_seeds(distances < 0, int(pieces), np.random.default_rng(int(seed) + fracture))
        for label in range(1, int(pieces) + 1):
            vertices, faces = mesh_of(labels, label)
            write_ply(out / f"piece_{label - 1}.ply", origin + size * vertices, faces)


if __name__ == "__main__":
    if len(sys.argv) != 7:
        sys.exit(__doc__)
    main(*sys.argv[1:])
