"""The data set under DataLoader: workers, ranks, interrupts, forks, and memory."""
import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from conftest import AMPHORA, run
from streams import CUBES, equal, fractures, loaded, stream
from torch.utils.data import ChainDataset, DataLoader

import pysherd
from pysherd._layouts import LAYOUTS
from pysherd.torch import collate


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_workers_have_no_item_twice(method):
    data = stream(items=30, repeats=1, mix=1)
    alone = list(data)  # a parent that has broken objects itself
    items = loaded(data, 4, multiprocessing_context=method)
    assert sorted(fractures(items)) == sorted(fractures(alone))
    by_seed = {int(item["seed"]): item for item in items}
    assert all(np.array_equal(by_seed[item["seed"]]["positions"], item["positions"]) for item in alone)
    assert sorted(fractures(loaded(stream(items=30, repeats=1, mix=1), 3))) == sorted(fractures(alone))


@pytest.mark.parametrize("items", [13, 24])
def test_workers_and_ranks_have_the_same_items(items):
    """Those of one process: 0 to items - 1, whatever the workers; of two ranks as many of them as both have."""
    alone = sorted((item["index"], *one) for item, one in ((item, fractures([item])[0]) for item in stream(items=items)))
    assert [index for index, _, _ in alone] == list(range(items))
    for workers in (1, 3):
        own = loaded(stream(items=items), workers)
        assert sorted((item["index"], *one) for item, one in zip(own, fractures(own))) == alone
    ranks = [loaded(stream(items=items, rank=rank, world_size=2), 2) for rank in range(2)]
    assert sorted((item["index"], *fractures([item])[0]) for rank in ranks for item in rank) == alone[: items // 2 * 2]


@pytest.mark.filterwarnings("ignore::pysherd.SherdWarning")
def test_workers_have_the_same_items_where_a_mesh_fails(tmp_path):
    (tmp_path / "a.ply").write_text("ply\nthis is none\n")
    for name in "bc":
        (tmp_path / f"{name}.ply").write_bytes(AMPHORA.read_bytes())
    of = {}
    for workers in (0, 2):
        of[workers] = sorted((item["index"], *fractures([item])[0]) for item in loaded(stream(tmp_path, items=20, resolution=16, repeats=3), workers))
    assert of[0] == of[2] and [index for index, _, _ in of[0]] == list(range(20))


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_every_layout_under_every_start_of_workers(method):
    """One worker takes all, since a process that is spawned imports PyTorch."""
    data = [stream(CUBES[:1], layout=layout, points=None, items=1, pieces=3) for layout in LAYOUTS]
    loader = DataLoader(ChainDataset(data), batch_size=None, num_workers=1, multiprocessing_context=method, timeout=100)
    items = list(loader)
    assert len(items) == len(LAYOUTS) and all(map(equal, (plain(item) for item in items), (plain(next(iter(own))) for own in data)))


def plain(item):
    """With arrays for the tensors that workers give."""
    return {key: np.asarray(value) for key, value in item.items()}


def test_batches_under_workers():
    batches = list(DataLoader(stream(layout="garf", points=500, items=12), batch_size=3, num_workers=2, collate_fn=collate))
    assert [batch["pointclouds"].shape for batch in batches] == [(3, 500, 3)] * 4 and isinstance(batches[0]["name"], list)


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_workers_that_persist_go_to_the_next_epoch(method):
    data = stream(items=8)
    loader = DataLoader(data, batch_size=None, num_workers=2, persistent_workers=True, multiprocessing_context=method)
    seen = []
    for epoch in range(3):
        data.set_epoch(epoch)
        seen += fractures(loader)
    assert len(set(seen)) == 24


@pytest.mark.parametrize("persist", [False, True])
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_one_worker_uses_a_state_once(method, persist):
    """It was loaded in the process that trains, of which each epoch's worker is a copy."""
    data, whole = stream(items=9), fractures(stream(items=9))
    first = stream(items=9)
    items = iter(first)
    before = [next(items) for _ in range(4)]
    data.load_state_dict(first.state_dict())
    loader = DataLoader(data, batch_size=None, num_workers=1, multiprocessing_context=method, persistent_workers=persist)
    assert fractures(before) + fractures(loader) == whole
    assert fractures(loader) == whole == fractures(data)
    data.load_state_dict(first.state_dict())
    data.load_state_dict(first.state_dict())
    if not persist:  # a worker that persists was copied before
        assert fractures(before) + fractures(loader) == whole == fractures(loader)


def test_fewer_meshes_than_workers():
    assert len(set(fractures(loaded(stream(CUBES[:1], items=12, repeats=1), 4)))) == 12


@pytest.mark.filterwarnings("ignore::pysherd.SherdWarning")
@pytest.mark.parametrize("workers", [2, 4])
def test_one_bad_mesh_ends_no_worker(tmp_path, workers):
    """Without shuffling, meshes and workers of a common divisor."""
    (tmp_path / "a.ply").write_text("ply\nthis is none\n")
    (tmp_path / "b.ply").write_bytes(AMPHORA.read_bytes())
    data = stream(tmp_path, items=3 * workers, resolution=16, repeats=1, mix=1, shuffle=False)
    assert [item["mesh"] for item in loaded(data, workers)] == [1] * 3 * workers


GROUP = """
import sys, torch, torch.distributed as dist, torch.multiprocessing as mp
from torch.nn.parallel import DistributedDataParallel
from torch.utils.data import DataLoader
sys.path.insert(0, {tests!r})

def train(rank, data, file, method):
    from conftest import cube
    from pysherd.torch import FractureDataset
    dist.init_process_group("gloo", init_method="file://" + file, rank=rank, world_size=2)
    torch.manual_seed(0)
    net = DistributedDataParallel(torch.nn.Linear(3, 1))
    own = []
    for epoch in range(2):
        data.set_epoch(epoch)
        for batch in DataLoader(data, batch_size=3, num_workers=2, multiprocessing_context=method):
            own += [(epoch, *one) for one in zip(batch["mesh"].tolist(), batch["seed"].tolist())]
            net.zero_grad()
            net(batch["positions"]).square().mean().backward()
    all, gradients = [None, None], [None, None]
    dist.all_gather_object(all, own)
    dist.all_gather_object(gradients, net.module.weight.grad)
    assert len(all[0]) == len(all[1]) == 2 * 13 and len(set(all[0] + all[1])) == 52, all
    assert torch.equal(*gradients)
    dist.barrier()
    if rank == 0:
        print("no item twice")

if __name__ == "__main__":
    from conftest import cube
    from pysherd.torch import FractureDataset
    data = FractureDataset([cube(1 + i) for i in range(3)], points=64, resolution=12, pieces="2..4", items=27)
    mp.spawn(train, args=(data, {file!r}, {method!r}), nprocs=2)
"""


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_distributed_ranks_have_no_item_twice(tmp_path, method):
    """Two processes under gloo, two workers each, two epochs; 27 items are 13 for each rank."""
    (tmp_path / "group.py").write_text(GROUP.format(tests=str(pathlib.Path(__file__).parents[1]), file=str(tmp_path / "store"), method=method))
    done = subprocess.run([sys.executable, "-B", tmp_path / "group.py"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0 and "no item twice" in done.stdout, done.stderr


def test_ranks_that_are_given():
    ranks = [fractures(stream(items=20, rank=rank, world_size=3)) for rank in range(3)]
    assert [len(rank) for rank in ranks] == [6] * 3 and len(set(sum(ranks, []))) == 18


def test_a_group_of_more_ranks_than_items(monkeypatch):
    """The group may begin after the data set was made."""
    data = stream(items=2)
    monkeypatch.setattr("pysherd.torch._group_ranks", lambda: (1, 3))
    for use in (len, iter):
        with pytest.raises(pysherd.UsageError, match="^items: 2 .* 3 ranks"):
            use(data)


INTERRUPTED = """
import sys
sys.path.insert(0, {tests!r})

if __name__ == "__main__":
    from conftest import AMPHORA
    from torch.utils.data import DataLoader
    from pysherd.torch import FractureDataset
    data = FractureDataset(AMPHORA, resolution={resolution}, growth="chain", roughness=2, pieces=60)
    for item in DataLoader(data, batch_size=None, num_workers={workers}, multiprocessing_context={method}):
        print("item", flush=True)
"""


@pytest.mark.parametrize("workers, method", [(0, None), (2, "fork"), (2, "spawn")])
def test_an_interrupt_ends_all_processes(tmp_path, workers, method):
    """Ctrl-C reaches the process and its workers alike."""
    code = INTERRUPTED.format(tests=str(pathlib.Path(__file__).parents[1]), workers=workers, method=repr(method), resolution=200)
    (tmp_path / "long.py").write_text(code)
    process = subprocess.Popen([sys.executable, "-B", tmp_path / "long.py"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               start_new_session=True)  # fmt: skip
    assert process.stdout.readline() == "item\n"
    start = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode in (1, -signal.SIGINT) and "KeyboardInterrupt" in errors
    assert time.monotonic() - start < 10  # of a busy machine: a second for the fracture, and what PyTorch takes to join its workers
    with pytest.raises(ProcessLookupError):  # no worker is left
        for _ in range(100):
            os.killpg(process.pid, 0)
            time.sleep(0.1)


AFTER_OPENCL = """
import pysherd
from torch.utils.data import DataLoader
from pysherd.torch import FractureDataset
try:
    pysherd.fracture({mesh!r}, pieces=2, resolution=16, device="pocl")
except pysherd.DeviceError:
    print("no driver")
print(len(list(DataLoader(FractureDataset({mesh!r}, pieces=2, resolution=16, items=4), num_workers=2))), "items")
try:
    list(DataLoader(FractureDataset({mesh!r}, pieces=2, resolution=16, items=4, device="pocl"), num_workers=2))
except pysherd.DeviceError as e:
    print("refused:", e)
"""


def test_workers_of_a_process_that_used_opencl():
    result = run(AFTER_OPENCL.format(mesh=str(AMPHORA)), env={**os.environ, "OCL_ICD_VENDORS": "pocl.icd"})
    assert "4 items" in result.stdout, result.stderr
    assert "no driver" in result.stdout or "refused: " in result.stdout and "spawn" in result.stdout



MANY = """
import gc, os, pathlib, sys
import numpy as np
sys.path.insert(0, {tests!r})
from conftest import cube
from pysherd.torch import FractureDataset

def resident():
    gc.collect()
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20

random = np.random.default_rng(0)
meshes = [(cube()[0] * random.uniform(0.3, 1, 3), cube()[1]) for _ in range({count})]
data = FractureDataset(meshes, points=64, resolution=12, pieces="2..4", repeats=1, mix=4, cache_bytes=8 << 20, shuffle=False)
items = iter(data)
for part in range(4):
    for _ in range({count} // 4):
        next(items)
    print(resident(), data._breaker.solids.bytes / 2**20, len(data._breaker.solids))
"""


def test_many_small_objects_leave_memory_flat():
    """The solids of all would take far more than those that are kept."""
    count = int(os.environ.get("SHERD_PYTHON_FRACTURES", "800"))
    code = MANY.format(tests=str(pathlib.Path(__file__).parents[1]), count=count)
    result = run(code, env={**os.environ, "MALLOC_ARENA_MAX": "1"}, timeout=max(600, count // 5))
    assert result.returncode == 0, result.stderr
    print(result.stdout)
    parts = [tuple(map(float, line.split())) for line in result.stdout.splitlines()]
    assert all(kept <= 8 for _, kept, _ in parts) and parts[0][2] < count / 8
    assert parts[-1][0] - parts[0][0] < 4
