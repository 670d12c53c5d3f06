"""Streams of small objects, for the tests of this folder."""
import numpy as np
from conftest import cube
from torch.utils.data import DataLoader

from pysherd.torch import FractureDataset

CUBES = [cube(1 + i) for i in range(5)]


def stream(meshes=CUBES, **options):
    return FractureDataset(meshes, **{"points": 64, "resolution": 12, "pieces": "2..4", **options})


def fractures(items):
    """What makes items different."""
    return [(int(item["mesh"]), int(item["seed"])) for item in items]


def loaded(data, workers=0, **options):
    return list(DataLoader(data, batch_size=None, num_workers=workers, **options))


def equal(one, other):
    return one.keys() == other.keys() and all(np.array_equal(one[key], other[key]) for key in one)
