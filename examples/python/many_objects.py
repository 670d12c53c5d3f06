"""Breaks many objects on all cores, by the standard library: a process for each core, one thread in each.

usage: many_objects.py OUT MESH...
"""

import pathlib
import sys
from multiprocessing import Pool

import numpy as np

import pysherd


def break_object(job: tuple[str, str]) -> tuple[str, int]:
    mesh, out = job
    pysherd.limit_threads(1)
    fractures = [f.points(512) for f in pysherd.voxelize(mesh, resolution=64).fractures(pieces=range(2, 6), seeds=range(2))]
    np.savez(pathlib.Path(out) / (pathlib.Path(mesh).stem + ".npz"), *[np.column_stack(p) for p in fractures])
    return mesh, len(fractures)


if __name__ == "__main__":
    pathlib.Path(sys.argv[1]).mkdir(parents=True, exist_ok=True)
    with Pool() as pool:
        for mesh, count in pool.imap_unordered(break_object, [(mesh, sys.argv[1]) for mesh in sys.argv[2:]]):
            print(f"{mesh}: {count} fractures")
