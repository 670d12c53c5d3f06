"""The data set in one process: its order, epochs, states, and meshes that cannot be broken."""
import os
import pickle
import shutil
import subprocess
import warnings

import numpy as np
import pytest
from conftest import AMPHORA, cube
from streams import CUBES, equal, fractures, loaded, stream
from torch.utils.data import DataLoader
from torch.utils.data._utils import worker as torch_worker

import pysherd
from pysherd.torch import FractureDataset


def test_a_stream_is_a_function_of_its_seed():
    first, again, other = (list(stream(items=20, seed=seed)) for seed in (3, 3, 4))
    assert all(map(equal, first, again)) and not set(fractures(first)) & set(fractures(other))
    assert len(set(fractures(first))) == 20 and {item["mesh"] for item in first} == set(range(5))


@pytest.mark.parametrize("options", [{"roughness": "0..2", "extra_seeds": "0..3"}, {"preset": "training", "surface": "smooth"}])
def test_an_item_is_the_fracture_of_its_seed(options):
    data = stream([AMPHORA], items=3, resolution=24, layout="fragments", **options)
    for item in data:
        f = data.fracture(item["index"])
        again = pysherd.fracture(AMPHORA, **f.options)
        points = again.points(64).positions.reshape(-1, 64, 3)
        assert f.seed == item["seed"] and np.allclose((points - item["center"]) / item["size"], item["positions"], atol=1e-6)


def test_points_are_those_of_the_program(tmp_path):
    data = stream([AMPHORA], items=2, resolution=24, layout="fragments", pieces=4, preset="training")
    for item in data:
        subprocess.run([os.environ["SHERD_BIN"], "fracture", AMPHORA, "-o", tmp_path / "out", "--preset", "training", "--resolution", "24", "--pieces", "4",
                        "--seed", str(item["seed"]), "--points", "64", "--point-format", "npz"], check=True, capture_output=True)  # fmt: skip
        files = sorted((tmp_path / "out" / "points").iterdir())
        assert len(files) == item["fragments"]
        for path, own, normals, neighbor in zip(files, item["positions"], item["normals"], item["neighbor"]):
            points = np.load(path)
            assert np.allclose((points["positions"] - item["center"]) / item["size"], own, atol=1e-6)
            assert np.allclose(points["normals"], normals, atol=1e-6) and np.array_equal(points["neighbor"], neighbor)
        shutil.rmtree(tmp_path / "out")


def test_epochs_have_other_fractures():
    data, seen = stream(items=10), set()
    for epoch in range(3):
        data.set_epoch(epoch)
        items = fractures(data)
        assert not seen & set(items)
        seen |= set(items)
    data.set_epoch(0)
    assert fractures(data) == fractures(stream(items=10))
    data.set_epoch(3)
    state = data.state_dict()
    assert (state["epoch"], state["position"]) == (3, 0)


def test_an_endless_stream_has_no_length():
    data = iter(stream())
    assert len(set(fractures(next(data) for _ in range(100)))) == 100
    with pytest.raises(TypeError):
        len(stream())
    assert len(stream(items=10)) == 10 == len(DataLoader(stream(items=10), batch_size=None)) and len(stream(items=10, rank=0, world_size=3)) == 3


@pytest.mark.parametrize("taken", [0, 1, 7, 20])
def test_a_state_resumes_where_it_was_taken(taken):
    data = stream(items=20, repeats=3, mix=2)
    data.set_epoch(5)
    items = iter(data)
    before = [next(items) for _ in range(taken)]
    state = pickle.loads(pickle.dumps(data.state_dict()))
    fresh = stream(items=20, repeats=3, mix=2)
    fresh.load_state_dict(state)
    assert fresh.state_dict() == state
    rest = list(fresh)
    assert len(before) + len(rest) == 20 and all(map(equal, items, rest))
    assert len(list(fresh)) == 20  # the next iteration is a whole epoch


def test_a_state_after_batches_is_exact():
    whole = fractures(stream(items=24))
    data, seen = stream(items=24), []
    for number, batch in enumerate(DataLoader(data, batch_size=4)):
        seen += list(zip(batch["mesh"].tolist(), batch["seed"].tolist()))
        if number == 2:
            break
    fresh = stream(items=24)
    fresh.load_state_dict(data.state_dict())
    assert seen + fractures(fresh) == whole


def test_a_state_of_each_worker(monkeypatch):
    """As torchdata's StatefulDataLoader does: a state of each worker, loaded into a data set of that worker."""

    def of_worker(data, worker):
        monkeypatch.setattr(torch_worker, "_worker_info", torch_worker.WorkerInfo(id=worker, num_workers=3, seed=0, dataset=data))
        return iter(data)

    for worker in range(3):
        data, fresh = stream(items=20), stream(items=20)
        items = of_worker(data, worker)
        before = [next(items) for _ in range(4)]
        fresh.load_state_dict(data.state_dict())
        assert fractures(of_worker(fresh, worker)) == fractures(items) and len(before) == 4
        fresh.load_state_dict(data.state_dict())
        with pytest.raises(pysherd.UsageError, match="as many processes as before"):
            of_worker(fresh, (worker + 1) % 3)
    pysherd.limit_threads(0)


def test_a_state_of_another_stream_is_refused():
    state = stream(items=20).state_dict()
    for other in (stream(items=21), stream(items=20, seed=1), stream(CUBES[:4], items=20), stream(items=20, roughness=1), stream(items=20, layout="mpa")):
        with pytest.raises(pysherd.UsageError, match="another stream"):
            other.load_state_dict(state)
    data = stream(items=20)
    data.load_state_dict(state)
    data.set_epoch(1)  # another epoch begins at its start
    assert len(list(data)) == 20


def test_a_state_of_other_meshes_in_memory_is_refused(tmp_path):
    """Though their positions in the list are the same; the content of files is not compared."""
    volume = np.ones((12, 12, 12), np.uint8)
    vertices, faces = cube()
    solid, finer, other = (pysherd.voxelize(mesh, resolution=n) for mesh, n in ((cube(), 12), (cube(), 16), (cube(2), 12)))
    (tmp_path / "a.ply").write_bytes(AMPHORA.read_bytes())
    for mesh, others in (((vertices, faces), [(2 * vertices, faces), (vertices, faces[::-1]), (vertices[:, ::-1], faces), volume]),
                         (volume, [volume.reshape(6, 12, 24), np.ones((12, 12, 13), bool)]), (solid, [finer, other, cube()])):  # fmt: skip
        state = FractureDataset([mesh], pieces=2, items=4).state_dict()
        FractureDataset([mesh], pieces=2, items=4).load_state_dict(pickle.loads(pickle.dumps(state)))
        pickle.loads(pickle.dumps(FractureDataset([mesh], pieces=2, items=4))).load_state_dict(state)
        for one in others:
            with pytest.raises(pysherd.UsageError, match="another stream"):
                FractureDataset([one], pieces=2, items=4).load_state_dict(state)
    state = stream(tmp_path, items=4).state_dict()
    (tmp_path / "a.ply").write_bytes(AMPHORA.read_bytes() + b" ")
    stream(tmp_path, items=4).load_state_dict(state)


def test_a_state_that_workers_have_is_warned_of():
    data = stream(items=4)
    loaded(data, 1)
    with pytest.warns(pysherd.SherdWarning, match="StatefulDataLoader"):
        data.state_dict()


def test_solids_are_broken_as_they_are():
    solid = pysherd.voxelize(cube(), resolution=20)
    items = list(FractureDataset([solid], points=64, pieces=3, items=2))
    f = pysherd.fracture(solid, pieces=3, seed=items[0]["seed"], surface="smooth")
    assert np.allclose(items[0]["positions"] * items[0]["size"] + items[0]["center"], f.points(64, share_points=True).positions, atol=1e-6)
    with pytest.raises(pysherd.UsageError, match="resolution"):
        FractureDataset([solid], resolution=20)
    assert fractures(loaded(FractureDataset([solid], pieces=3, items=4), 2, multiprocessing_context="spawn"))


def test_solids_take_a_preset_and_a_surface():
    """Those of the data set, else those that the solid was voxelized with."""
    plain, exact = pysherd.voxelize(cube(), resolution=20), pysherd.voxelize(cube(), resolution=20, preset="training", surface="exact")
    options = {"points": 64, "pieces": 3, "items": 2}
    for solid, own, preset, surface in ((plain, {"preset": "training"}, "training", None), (exact, {}, "training", "exact"),
                                        (exact, {"surface": "smooth", "preset": "paper"}, "paper", "smooth")):  # fmt: skip
        data = FractureDataset([solid], **options, **own)
        item = next(iter(data))
        f = data.fracture(item["index"])
        same = {"preset": preset, "surface": surface}
        expected = pysherd.fracture(cube(), resolution=20, pieces=3, seed=item["seed"], **same)
        assert {keyword: f.options.get(keyword) for keyword in same} == same
        assert np.array_equal(f.labels, expected.labels) and np.array_equal(f[0].faces, expected[0].faces)
    for solid, own in ((plain, {"voxel_size": 0.1}), (exact, {"fill": "winding"}),
                       (pysherd.voxelize(cube(), resolution=20, surface="smooth"), {"surface": "exact"})):  # fmt: skip
        with pytest.raises(pysherd.UsageError, match=f"^{next(iter(own))}: .*voxelize"):
            FractureDataset([solid], **own)


def test_a_data_set_can_be_pickled():
    data = stream(items=6)
    first = next(iter(data))
    again = pickle.loads(pickle.dumps(data))
    assert len(again._breaker.solids) == 0 < len(data._breaker.solids)
    assert equal(next(iter(again)), first) and again._shared.is_shared()


@pytest.fixture
def damaged(tmp_path):
    for name in ("a.ply", "c.ply"):
        (tmp_path / name).write_bytes(AMPHORA.read_bytes())
    (tmp_path / "b.ply").write_text("ply\nthis is none\n")
    return tmp_path


def test_a_mesh_that_cannot_be_broken_is_skipped_with_a_warning(damaged):
    data = stream(damaged, items=60, resolution=16)
    with pytest.warns(pysherd.SherdWarning) as caught:
        items = list(data)
    texts = [str(w.message) for w in caught if "b.ply" in str(w.message)]
    assert len(items) == 60 and {item["mesh"] for item in items} == {0, 2} and len(texts) == 1
    assert texts[0].endswith("skipped, as of 1 of 3 meshes until now") and data.skipped.keys() == {"b.ply"}
    assert data.skipped["b.ply"] > 8  # more than a visit
    assert len(set(fractures(items))) == 60 and sorted(item["index"] for item in items) == list(range(60))
    for item in items[::9]:
        assert data.fracture(item["index"]).seed == item["seed"]


def test_a_state_after_a_skip_is_exact(damaged):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data = stream(damaged, items=30, resolution=16, repeats=2, mix=2)
        items = iter(data)
        before = fractures(next(items) for _ in range(11))
        fresh = stream(damaged, items=30, resolution=16, repeats=2, mix=2)
        fresh.load_state_dict(data.state_dict())
        assert before + fractures(fresh) == fractures(stream(damaged, items=30, resolution=16, repeats=2, mix=2))


@pytest.mark.parametrize("workers", [0, 2])
def test_a_mesh_that_cannot_be_broken_is_an_error_if_wanted(damaged, workers):
    with pytest.raises(pysherd.FileError, match="b.ply"):
        loaded(stream(damaged, items=100, resolution=16, on_error="raise"), workers)


def test_nothing_that_can_be_broken_is_an_error(tmp_path):
    for name in "ab":
        (tmp_path / f"{name}.ply").write_text("ply\nthis is none\n")
    with pytest.raises(pysherd.InputError, match="none of 2 meshes"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        list(stream(tmp_path))
    with pytest.raises(pysherd.FileError, match="contains no mesh"):
        (tmp_path / "empty").mkdir()
        stream(tmp_path / "empty")


def test_objects_of_too_many_components_are_skipped():
    far = np.concatenate([cube()[0] + 2 * i for i in range(21)]), np.concatenate([cube()[1] + 8 * i for i in range(21)])
    with pytest.warns(pysherd.SherdWarning, match="has 21 connected components, and layout mpa holds 2 to 20"):
        items = list(stream([far, cube()], layout="mpa", items=5, resolution=128))
    assert {float(item["part_valids"].sum()) <= 4 for item in items} == {True}
    with pytest.raises(pysherd.InputError, match="21 fragments|21 connected"):
        list(stream([far], layout="mpa", items=5, resolution=128, on_error="raise"))


def test_a_file_that_goes_away_is_skipped(tmp_path):
    for name in "ab":
        (tmp_path / f"{name}.ply").write_bytes(AMPHORA.read_bytes())
    data = stream(tmp_path, items=10, resolution=16)
    (tmp_path / "a.ply").unlink()
    with pytest.warns(pysherd.SherdWarning, match="a.ply"):
        assert {item["mesh"] for item in data} == {1}
