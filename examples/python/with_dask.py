"""Breaks many objects with Dask, on this machine or a cluster: solids and fractures are pickled between processes.

usage: with_dask.py OUT MESH...
"""

import pathlib
import sys

import dask.bag
import numpy as np

import pysherd


def sample(mesh: str) -> list[tuple[str, pysherd.Points]]:
    solid = pysherd.voxelize(mesh, resolution=64)
    return [(f"{solid.name}_{f.seed}", f.points(512)) for f in solid.fractures(pieces=5, seeds=range(4))]


def store(named: tuple[str, pysherd.Points], out: str) -> int:
    np.savez(pathlib.Path(out) / f"{named[0]}.npz", *named[1])
    return len(named[1].positions)


if __name__ == "__main__":
    out = pathlib.Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    counts = dask.bag.from_sequence(sys.argv[2:], partition_size=1).map(sample).flatten().map(store, out=str(out))
    print(sum(counts.compute(scheduler="processes")), "points")
