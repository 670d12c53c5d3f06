"""Items of several objects: fragments of all of them, side by side."""
import numpy as np
import pytest
from conftest import AMPHORA, cube
from scipy.spatial import cKDTree
from streams import CUBES

import pysherd
from pysherd.torch import FractureDataset, collate


def stream(layout="fragments", objects="2..4", meshes=(*CUBES, AMPHORA), items=6, **options):
    return FractureDataset(list(meshes), layout=layout, objects=objects, items=items, **{"resolution": 24, "pieces": "2..4", **options})


def test_fragments_are_of_objects_side_by_side():
    counts = set()
    for item in stream(items=16):
        object_ = item["object"]
        assert item["fragments"] == len(object_) == len(item["positions"])
        assert len(item["name"].split(";")) == object_.max() + 1 == len(set(object_))
        counts.add(object_.max() + 1)
        for k in range(object_.max() + 1):
            own = np.flatnonzero(object_ == k)
            at = item["positions"][own].reshape(-1, 3)
            assert np.abs(at - (1.5 * k, 0, 0)).max() <= 0.51  # the surface of voxels goes beyond the box a little
            ids = set(np.unique(item["neighbor"][own])) - {0}
            assert ids <= set(own + 1)
            for i in own:  # cracks lie at the fragment that is named
                for other in set(np.unique(item["neighbor"][i])) - {0}:
                    crack = item["positions"][i][item["neighbor"][i] == other]
                    assert np.median(cKDTree(item["positions"][other - 1]).query(crack)[0]) < 0.1
    assert counts == {2, 3, 4}


def test_ids_say_nothing_of_the_object():
    # One after another are of one object as often as chance has it, within four standard errors; one object after the other would be 1.
    differences = []
    for item in stream(items=120, pieces="2..5", resolution=16, points=8):
        object_ = item["object"]
        n, counts = len(object_), np.bincount(object_)
        differences.append(np.mean(object_[1:] == object_[:-1]) - (counts * (counts - 1)).sum() / (n * (n - 1)))
    assert abs(np.mean(differences)) < 4 * np.std(differences) / np.sqrt(len(differences))


def test_meshes_are_of_one_item_once():
    for item in stream(objects=3, items=12, meshes=[*CUBES[:2], AMPHORA]):
        assert len({name.split("/")[0] for name in item["name"].split(";")}) == 3
    assert all(item["name"].count(";") == 3 for item in stream(objects=4, items=4, meshes=CUBES[:2]))  # where there are no more


def test_missing_fragments_leave_a_neighbor():
    for item in stream(objects=3, items=16, pieces="4..7", missing=0.5):
        count = item["fragments"]
        for k in range(3):
            own = set(np.flatnonzero(item["object"] == k) + 1)
            others = set(range(1, count + 1)) - own
            for i in own:
                neighbors = set(np.unique(item["neighbor"][i - 1])) - {0}
                assert not neighbors & others  # also not by the number of one that is missing
                assert len(own) == 1 or neighbors & own


def test_points_are_as_many_as_without():
    (several,), (one,) = list(stream("points", 3, items=1, points=1000)), list(stream("points", 1, items=1, points=1000))
    assert len(several["positions"]) == len(one["positions"]) == 1000
    assert np.bincount(several["object"]).tolist() == [334, 333, 333]


def test_the_first_is_the_object_of_an_item_with_one():
    for several, one in zip(stream(objects=2), stream(objects=1)):
        own = several["object"] == 0
        assert (several["positions"][own] == one["positions"]).all() and several["mesh"] == one["mesh"]


def test_layouts_of_loaders_hold_them_all():
    for layout, key in (("garf", "graph"), ("pfpp", "graph")):
        item = list(stream(layout, 2, items=1))[0]
        parts = item["num_parts"]
        graph = item[key]
        assert parts >= 4 and not graph[parts:].any() and graph[:parts, :parts].any(axis=1).all()
    assert len(collate(list(stream("rpf", 2)))["num_parts"]) == 6


def test_the_same_in_any_order_of_processes():
    items = list(stream())
    parts = [list(FractureDataset([*CUBES, AMPHORA], layout="fragments", objects="2..4", items=6, resolution=24, pieces="2..4", rank=r, world_size=2))
             for r in range(2)]  # fmt: skip
    by_index = {item["index"]: item for part in parts for item in part}
    assert all((by_index[item["index"]]["positions"] == item["positions"]).all() for item in items)


def test_what_cannot_be_is_refused():
    for objects in (0, "0..2", "3..2", "a", 2.5, "2..2000", None, [2]):
        with pytest.raises(pysherd.UsageError, match="^objects: "):
            FractureDataset(cube(), objects=objects)
    with pytest.raises(pysherd.UsageError, match="^pieces: layout garf holds 2 to 20 fragments, not 10 of 3 objects"):
        FractureDataset(cube(), layout="garf", pieces=10, objects=3)
    with pytest.raises(pysherd.UsageError, match="^objects: layout voxels has the voxels of one object"):
        FractureDataset(cube(), layout="voxels", objects=2)
