"""Whatever is given for whatever argument of the data set: it is used, or refused by name."""
import inspect
import itertools
import os

import pytest
import torch
from conftest import AMPHORA, cube
from streams import fractures, stream
from test_hostile import HOSTILE, spelled, tried

import pysherd
from pysherd._drawn import ACCEPTED
from pysherd.torch import FractureDataset, collate, collate_fragments

OWN = [name for name, p in inspect.signature(FractureDataset).parameters.items() if p.kind is p.KEYWORD_ONLY]


@pytest.mark.parametrize("value", HOSTILE)
def test_arguments(value):
    made, mesh = HOSTILE[value], cube()
    assert {"layout", "points", "items", "seed", "shuffle", "on_error", "threads", "rank", "world_size"} <= set(OWN)
    for keyword in OWN:
        if keyword != "device" or not isinstance(made(), str):
            tried(lambda: FractureDataset(mesh, **{keyword: made()}), "rank" if keyword == "world_size" else keyword)
    for keyword in ACCEPTED:
        tried(lambda: FractureDataset(mesh, **{keyword: made()}), keyword)
    data = FractureDataset(mesh, points=64, resolution=8, pieces=2)
    tried(lambda: FractureDataset(made()), None)
    tried(lambda: FractureDataset([made()]), None)
    tried(lambda: data.set_epoch(made()), "epoch")
    tried(lambda: data.fracture(made()), "index")
    tried(lambda: data.fracture(0, epoch=made()), "epoch")
    tried(lambda: data.load_state_dict(made()), "state_dict")
    tried(lambda: data.load_state_dict({**data.state_dict(), "position": made()}), "state_dict: position")
    pysherd.limit_threads(0)


def test_meshes_without_an_end():
    with pytest.raises(pysherd.UsageError, match="^meshes: an iterator of more than 1048576"):
        FractureDataset(itertools.repeat("a.ply"))
    for of in (collate, collate_fragments):
        for items in ([], 3, None, [3], {}, itertools.count(), "ab"):
            with pytest.raises(pysherd.UsageError, match="^items: "):
                of(items)


def test_paths_of_any_bytes(tmp_path):
    folder = os.path.join(os.fsencode(tmp_path), b"f\xff")
    os.mkdir(folder)
    with open(os.path.join(folder, b"m\xe9.ply"), "wb") as file:
        file.write(AMPHORA.read_bytes())
    for path in (*spelled(folder), *spelled(os.path.join(folder, b"m\xe9.ply")), [os.path.join(folder, b"m\xe9.ply")]):
        (item,) = list(stream(path, items=1, resolution=16))
        assert b"m\xe9.ply" in os.fsencode(item["name"])
    loader = torch.utils.data.DataLoader(stream(folder, items=2, resolution=16), batch_size=None, num_workers=1)
    assert len(set(fractures(loader))) == 2
