#!/usr/bin/env python3
"""Measures items a second of pysherd.torch.FractureDataset, beside reading the same fractures from the disk, in turn.

usage: stream_speed.py MESH    (with a Python that has pysherd and PyTorch, such as that of build/python/venv-torch)

Each item has 5000 points, in the layout "garf".  From the disk come as many fractures: PLY meshes in the layout of Breaking Bad, read and
sampled by trimesh as the loaders do, and by NumPy alone; and `.npz` files of sampled points.  Files are in the page cache.  Figures are medians
of the rounds: items a second, and milliseconds of the processor for an item without workers.
"""
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import trimesh
from torch.utils.data import DataLoader, Dataset

import pysherd
from pysherd.torch import FractureDataset, collate

ROUNDS, ITEMS, POINTS = 5, 64, 5000
SHERD = [sys.executable, "-m", "pysherd"]


def read_ply(path):
    """Vertices and triangles of a binary PLY file as `--plain-meshes` writes it."""
    header, _, data = path.read_bytes().partition(b"end_header\n")
    counts = {line.split()[1]: int(line.split()[2]) for line in header.decode().splitlines() if line.startswith("element")}
    real = "<f8" if b"property double x" in header else "<f4"
    vertices = np.frombuffer(data, real, 3 * counts["vertex"]).reshape(-1, 3)
    faces = np.frombuffer(data, np.dtype([("n", "u1"), ("v", "<i4", 3)]), counts["face"], vertices.nbytes)["v"]
    return vertices, faces


def sampled(vertices, faces, count, random):
    """Points uniform by area, and their normals."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    cross = np.cross(b - a, c - a)
    area = np.linalg.norm(cross, axis=1)
    chosen = np.searchsorted(np.cumsum(area) / area.sum(), random.random(count)).clip(max=len(faces) - 1)
    u, v = np.sqrt(random.random((count, 1))), random.random((count, 1))
    return (1 - u) * a[chosen] + u * (1 - v) * b[chosen] + u * v * c[chosen], cross[chosen] / area[chosen, None]


class Meshes(Dataset):
    """All meshes of a fracture, with points on each by its share."""

    def __init__(self, folder, sample):
        self.fractures = sorted({path.parent for path in pathlib.Path(folder).rglob("piece_*.ply")})
        self.sample = sample

    def __len__(self):
        return ITEMS

    def __getitem__(self, index):
        files = sorted(self.fractures[index % len(self.fractures)].iterdir())
        parts = [self.sample(path, POINTS // len(files), np.random.default_rng(index)) for path in files]
        joined = [np.concatenate(part).astype(np.float32) for part in zip(*parts)]
        return {"pointclouds": np.resize(joined[0], (POINTS, 3)), "pointclouds_normals": np.resize(joined[1], (POINTS, 3))}


def by_numpy(path, count, random):
    return sampled(*read_ply(path), count, random)


def by_trimesh(path, count, random):
    mesh = trimesh.load(path)
    points, faces = trimesh.sample.sample_surface(mesh, count)
    return points, mesh.face_normals[faces]


class Points(Dataset):
    def __init__(self, folder):
        self.files = sorted(pathlib.Path(folder).glob("*.npz"))

    def __len__(self):
        return ITEMS

    def __getitem__(self, index):
        with np.load(self.files[index % len(self.files)]) as arrays:
            return dict(arrays)


def written(mesh, resolution, folder):
    """Writes the fractures for both readers."""
    (folder / "library").mkdir(parents=True)
    (folder / "library" / mesh.name).symlink_to(mesh.resolve())
    subprocess.run([*SHERD, "dataset", folder / "library", "-o", folder / "bb", "--layout", "bb", "--mesh-format", "ply", "--plain-meshes", "--write", "mesh",
                    "--pieces", "2..8", "--repeats", "5..5", "--resolution", str(resolution), "--quiet"], check=True)  # fmt: skip
    (folder / "npz").mkdir()
    for number, item in enumerate(stream(mesh, resolution, 35)):
        np.savez(folder / "npz" / f"{number:05}.npz", **{key: value for key, value in item.items() if isinstance(value, np.ndarray)})


def stream(mesh, resolution, items):
    return FractureDataset([mesh], layout="garf", resolution=resolution, pieces="2..8", items=items)


def rate(loader):
    """Items a second, and processor milliseconds, of a second time through: workers have started, and have voxelized the mesh."""
    for _ in loader:
        pass
    start, own = time.perf_counter(), time.process_time()
    items = sum(1 for _ in loader) * loader.batch_size
    return items / (time.perf_counter() - start), 1000 * (time.process_time() - own) / items


def main():
    mesh = pathlib.Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as work:
        for resolution in (64, 128):
            folder = pathlib.Path(work) / str(resolution)
            written(mesh, resolution, folder)
            sets = {"stream": stream(mesh, resolution, ITEMS), "PLY by trimesh": Meshes(folder / "bb", by_trimesh),
                    "PLY by NumPy": Meshes(folder / "bb", by_numpy), "npz points": Points(folder / "npz")}  # fmt: skip
            loaders = {(name, workers): DataLoader(data, batch_size=8, num_workers=workers, persistent_workers=workers > 0, collate_fn=collate)
                       for workers in (0, 2) for name, data in sets.items()}  # fmt: skip
            rates = {key: [] for key in loaders}
            pysherd.limit_threads(1)
            for _ in range(ROUNDS):
                for key, loader in loaders.items():
                    rates[key].append(rate(loader))
            for (name, workers), found in rates.items():
                each, own = zip(*found)
                taken = f", {statistics.median(own):.1f} ms" if workers == 0 else ""
                print(f"{resolution} voxels, {workers} workers, {name}: {statistics.median(each):.0f} items/s ({min(each):.0f} to {max(each):.0f}){taken}")
            del loaders


if __name__ == "__main__":
    main()
