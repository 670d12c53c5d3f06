"""Items that are volumes of voxels, the parts of a library, and functions of items."""
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest
import torch
from conftest import AMPHORA, cube
from scipy import ndimage
from streams import CUBES

import pysherd
from pysherd.torch import FractureDataset, collate

SIDE = 40


def stream(layout, meshes=AMPHORA, items=4, **options):
    return FractureDataset(meshes, layout=layout, items=items, **{"resolution": SIDE, "pieces": "2..6", **options})


def test_voxels_are_the_labels_in_a_cube():
    data = stream("voxels")
    items = list(data)
    for item in items:
        f, labels = data.fracture(item["index"]), item["labels"]
        assert labels.shape == (SIDE,) * 3 and labels.dtype == np.int32 and item["fragments"] == len(f)
        at = np.argwhere(labels)
        world = item["origin"] + item["voxel_size"] * at
        own = np.rint((world - f.origin) / f.voxel_size).astype(int)
        assert np.abs(f.origin + f.voxel_size * own - world).max() < 1e-9
        assert (f.labels[tuple(own.T)] == labels[tuple(at.T)]).all() and len(at) == (f.labels > 0).sum()
        low, high = at.min(axis=0), SIDE - 1 - at.max(axis=0)
        assert np.abs(low - high).max() <= 1
    assert collate(items)["labels"].shape == (4, SIDE, SIDE, SIDE)


def test_eroded_voxels_are_in_no_fragment():
    (item,) = stream("voxels", items=1, erode_iterations=1)
    assert set(np.unique(item["labels"])) == set(range(item["fragments"] + 1))


def test_completion_takes_one_fragment_away():
    data = stream("completion", items=12)
    missing = []
    for item in data:
        f = data.fracture(item["index"])
        assert all(item[key].dtype == np.uint8 and item[key].shape == (SIDE,) * 3 for key in ("kept", "missing", "whole"))
        assert (item["kept"] + item["missing"] == item["whole"]).all()
        sizes = [int((f.labels == i + 1).sum()) for i in range(len(f))]
        assert item["missing"].sum() == sizes[item["fragment"] - 1] and item["fragment"] != 1 + np.argmax(sizes)
        assert ndimage.label(item["missing"])[1] == 1
        missing.append(item["fragment"])
    assert len(set(missing)) > 2
    assert all((a["kept"] == b["kept"]).all() for a, b in zip(data, stream("completion", items=12)))


def test_cubes_are_as_large_as_their_objects():
    shapes = {item["labels"].shape[0] for item in stream("voxels", resolution=45)}
    assert shapes == {48}


def test_what_volumes_do_not_have_is_refused():
    with pytest.raises(pysherd.UsageError, match="^points: layout voxels has voxels and no points"):
        stream("voxels", points=100)
    with pytest.raises(pysherd.UsageError, match="^pieces: layout completion takes one of 2 fragments"):
        stream("completion", pieces="1..3")


def test_parts_are_those_of_the_program(tmp_path):
    folder = tmp_path / "library"
    for i in range(24):
        os.makedirs(folder / f"f{i % 3}", exist_ok=True)
        shutil.copy(AMPHORA, folder / f"f{i % 3}" / f"m{i}.ply")
    out = tmp_path / "out"
    subprocess.run([sys.executable, "-m", "pysherd", "dataset", folder, "-o", out, "--pieces", "2..2", "--repeats", "1..1", "--resolution", "16",
                    "--write", "labels", "--split", "50/30/20", "--quiet"], check=True)  # fmt: skip
    found = []
    for split in ("train", "val", "test"):
        data = FractureDataset(folder, split=split, splits="50/30/20", resolution=16, pieces=2)
        own = sorted(mesh.key for mesh in data._meshes)
        assert own == sorted((out / f"{split}.txt").read_text().split()), split
        found += own
    assert len(found) == len(set(found)) == 24


def test_a_part_without_meshes_and_other_ratios_are_refused():
    with pytest.raises(pysherd.InputError, match="^split: none of 1 meshes falls into"):
        for split in ("train", "val"):
            FractureDataset(cube(), split=split)
    for splits in ("80", "0/0/0", "8/1/1/0", "a/b/c", 3, (8, 1, 1), "-1/1/1"):
        with pytest.raises(pysherd.UsageError, match="^splits: "):
            FractureDataset(cube(), split="train", splits=splits)


def test_validation_is_the_same_each_time():
    data = stream("points", CUBES, split="train", points=50, resolution=16)
    first, again = list(data), list(data)
    assert all((a["positions"] == b["positions"]).all() for a, b in zip(first, again))


def named(item):
    return {"name": item["name"], "largest": float(np.abs(item["positions"]).max())}


@pytest.mark.parametrize("workers", (0, 2))
def test_items_are_transformed(workers):
    data = stream("points", points=64, transform=named)
    loader = torch.utils.data.DataLoader(data, batch_size=None, num_workers=workers, multiprocessing_context="spawn" if workers else None)
    items = list(loader)
    assert len(items) == 4 and all(set(item) == {"name", "largest"} for item in items)
    with pytest.raises(pysherd.UsageError, match="^transform: 3 is no function"):
        stream("points", transform=3)
