"""The order of an endless stream of fractures, and options that are drawn for it: no PyTorch is needed."""
import itertools
import json
import subprocess
import warnings

import numpy as np
import pytest
from conftest import AMPHORA, OnlyDlpack, SHERD, cube

import pysherd
from pysherd import _core
from pysherd._drawn import Drawn
from pysherd._layouts import LAYOUTS
from pysherd._library import Solids, library_of
from pysherd._order import Order, share_of


def shares(ranks, workers, items=None):
    return [share_of(items, rank, ranks, worker, workers) for rank in range(ranks) for worker in range(workers)]


def slots_of(order, share, count, epoch=0):
    return [order.item(epoch, number) for number in itertools.islice(order.numbers(share), count)]


@pytest.mark.parametrize("repeats, mix, ranks, workers", [(1, 1, 1, 1), (1, 4, 2, 3), (8, 16, 2, 4), (3, 2, 1, 5)])
def test_no_item_comes_twice_and_all_come(repeats, mix, ranks, workers):
    order, count = Order(7, 5, repeats, mix, True), 20 * repeats * mix
    slots = [slot for share in shares(ranks, workers) for slot in slots_of(order, share, count, epoch=2)]
    numbers = [slot.number for slot in slots]
    assert sorted(numbers) == list(range(count * ranks * workers))
    assert len({slot.seed for slot in slots}) == len(slots) and all(slot == order.item(2, slot.number) for slot in slots)


def test_meshes_come_equally_often_and_in_another_order_each_time():
    order = Order(10, 0, 3, 4, True)
    visits = [order.item(0, number).mesh for group in range(0, 3 * 100, 12) for number in range(group, group + 4)]
    passes = [visits[i : i + 10] for i in range(0, 100, 10)]
    assert all(sorted(each) == list(range(10)) for each in passes) and len({tuple(each) for each in passes}) == 10
    plain = [Order(4, 0, 2, 1, False).item(0, n).mesh for n in range(64)]
    passes = [plain[i : i + 8 : 2] for i in range(0, 64, 8)]
    assert plain[:8] == [0, 0, 1, 1, 2, 2, 3, 3] and len({tuple(each) for each in passes}) > 1
    assert all(each == [(each[0] + i) % 4 for i in range(4)] for each in passes)


@pytest.mark.parametrize("shuffle", [False, True])
def test_every_stream_comes_to_every_mesh(shuffle):
    """Also where the numbers of meshes and of streams have a common divisor, or are a number and its powers."""
    for meshes in range(1, 7):
        order, seen = Order(meshes, 0, 2, 1, shuffle), {}
        for streams in [*range(1, 2 * meshes + 1), meshes**2, meshes**3]:
            for stream in range(streams):
                share = share_of(None, 0, 1, stream, streams)
                seen[streams, stream] = {slot.mesh for slot in slots_of(order, share, 2 * 16 * meshes)}
        assert all(each == set(range(meshes)) for each in seen.values()), (meshes, seen)


def test_a_process_breaks_some_meshes_in_turn():
    order, (share,) = Order(100, 0, 3, 4, True), shares(1, 1)
    meshes = [slot.mesh for slot in slots_of(order, share, 24)]
    assert meshes[:4] * 3 == meshes[:12] and meshes[12:16] * 3 == meshes[12:] and len(set(meshes)) == 8


def test_epochs_and_seeds_change_all_fractures():
    first, second = Order(10, 0, 1, 1, True), Order(10, 1, 1, 1, True)
    of = [{order.item(epoch, n).seed for n in range(50)} for order, epoch in ((first, 0), (first, 1), (second, 0))]
    assert len(set.union(*of)) == 150 and max(set.union(*of)) < 2**63


def test_ranks_have_as_many_items_as_each_other():
    for items, ranks, workers in ((10, 3, 2), (7, 1, 4), (4, 4, 2), (1000, 7, 3)):
        each = [sum(share.items for share in shares(ranks, workers, items)[r * workers : (r + 1) * workers]) for r in range(ranks)]
        assert set(each) == {items // ranks}
    with pytest.raises(pysherd.UsageError, match="^items: 2 in all processes are fewer than the 4 ranks"):
        share_of(2, 0, 4, 0, 1)


@pytest.mark.parametrize("items", [1, 7, 24, 100, 997])
@pytest.mark.parametrize("repeats, mix", [(1, 1), (8, 16), (3, 2), (100, 1)])
def test_an_epoch_has_the_same_items_whatever_the_processes(items, repeats, mix):
    """0 to items - 1, each once; of ranks that do not divide them those that all have as many of.  A state goes on in the middle."""
    order = Order(5, 1, repeats, mix, True)
    for ranks, workers in ((1, 1), (1, 2), (1, 5), (2, 1), (3, 4), (7, 2)):
        if items < ranks:
            continue
        each = [list(order.numbers(share)) for share in shares(ranks, workers, items)]
        assert sorted(sum(each, [])) == list(range(items // ranks * ranks))
        assert all(len(own) == share.items for own, share in zip(each, shares(ranks, workers, items)))
        assert max(map(len, each)) - min(map(len, each)) <= 1
        for own, share in zip(each, shares(ranks, workers, items)):
            assert list(order.numbers(share, 3)) == own[3:]
            visits = {number // (mix * repeats) * mix + number % mix for number in own}
            assert len(visits) <= len(own) / repeats + 2 + mix  # whole but for the first and the last, and those that the end cuts off
    (alone,) = shares(1, 1, items)
    assert list(order.numbers(alone)) == list(range(items))


def test_other_meshes_take_the_places_of_those_that_fail():
    order = Order(6, 3, 4, 1, True)
    slots = [list(itertools.islice(order.attempts(0, number), 200)) for number in range(8)]
    assert all(slot.number == number for number, own in enumerate(slots) for slot in own)
    assert [slot.mesh for slot in slots[0]] == [slot.mesh for slot in slots[3]] != [slot.mesh for slot in slots[4]]  # a visit's are the same
    assert all({slot.mesh for slot in own} == set(range(6)) for own in slots) and len({slot.seed for own in slots for slot in own}) == 8 * 200


def test_drawn_values_are_those_of_a_dataset(tmp_path):
    """Of each fracture in the index: its seed, and the values that the program drew."""
    if not SHERD:
        pytest.skip("SHERD_BIN does not name the program")
    drawn = {"roughness": "0%..2%", "extra_seeds": "0..5", "sampler": "uniform|poisson", "min_share": "0..0.02"}
    options = [part for keyword, text in drawn.items() for part in ("--" + keyword.replace("_", "-"), text)]
    (tmp_path / "library").mkdir()
    (tmp_path / "library" / "a.ply").write_bytes(AMPHORA.read_bytes())
    subprocess.run([SHERD, "dataset", tmp_path / "library", "-o", tmp_path / "out", "--resolution", "16", "--repeats", "2..2", "--pieces", "2..4",
                    "--quiet", *options], check=True)  # fmt: skip
    rows = [json.loads(line) for line in (tmp_path / "out" / "index.jsonl").read_text().splitlines()]
    rows = [row for row in rows if row["fracture"] != "whole"]
    assert len({row["seed"] for row in rows}) == 6
    for row in rows:
        assert dict(Drawn(drawn).texts(int(row["seed"]))) == {k: str(v) for k, v in row["options"].items()}


def test_pieces_are_drawn_evenly():
    drawn = Drawn({"pieces": "2..5", "resolution": 32})
    counts = np.bincount([int(dict(drawn.texts(seed))["pieces"]) for seed in range(4000)], minlength=6)
    assert counts[:2].sum() == 0 and np.abs(counts[2:] - 1000).max() < 4 * np.sqrt(750)  # four standard deviations
    assert Drawn({"pieces": range(2, 6)}).texts(3) == [option for option in drawn.texts(3) if option[0] == "pieces"]
    assert drawn.pieces == (2, 5) and Drawn({}).pieces == (8, 8)


@pytest.mark.parametrize("options, named", [
    ({"piece": 3}, "piece: FractureDataset() has no such keyword; the nearest is pieces"), ({"mesh_format": "ply"}, "mesh_format"),
    ({"seed": 3}, "seed"), ({"pieces": "5..2"}, "pieces: '5..2' is empty"), ({"pieces": "0..2"}, "pieces"), ({"pieces": range(2, 9, 2)}, "pieces"),
    ({"pieces": (2, 5)}, "pieces: '2,5' is not a whole number in 1..65534; a range is '2..5'"), ({"pieces": [2, 3, 5]}, "pieces: '2,3,5' is not"),
    ({"min_share": (0, 0.02)}, "min_share: .* a range is '0..0.02'"), ({"sampler": ("uniform", "poisson")}, "sampler: .* a choice is 'uniform|poisson'"),
    ({"point_sampler": "poisson", "point_rule": "per-triangle"}, "point_rule"), ({"roughness": "0..900"}, "roughness"), ({"resolution": "16..32"}, "resolution"), ({"sampler": "uniform|even"}, "sampler"),
])  # fmt: skip
def test_options_are_refused_by_name(options, named):
    with pytest.raises(pysherd.UsageError, match="^" + named.replace("(", "\\(").replace(")", "\\)").replace("|", "\\|")):
        Drawn(options)
    assert Drawn({"roughness": (1, 0.7)}).texts(0) == [("roughness", "1,0.7")]  # a value of two numbers


def test_an_option_that_does_nothing_is_warned_of():
    with pytest.warns(pysherd.SherdWarning, match="metric does nothing"):
        Drawn({"metric": "manhattan"})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Drawn({"metric": "manhattan", "growth": "nearest|euclid"})  # it does in some
        Drawn({"point_sampler": "poisson"})


def test_a_library_is_that_of_the_program(tmp_path):
    (tmp_path / "b" / "c").mkdir(parents=True)
    for name in ("z.ply", "b/c/a.ply", "b/.hidden.ply", "notes.md"):
        (tmp_path / name).write_bytes(AMPHORA.read_bytes())
    assert [mesh.key for mesh in library_of(tmp_path)] == ["b/c/a.ply", "z.ply"]
    (tmp_path / "list.txt").write_text("# two\nz.ply\n")
    assert [mesh.key for mesh in library_of(tmp_path / "list.txt")] == ["z.ply"]
    assert [mesh.key for mesh in library_of([AMPHORA, cube()])] == [str(AMPHORA), "1"]
    assert len(library_of(cube())) == 1 and len(library_of(str(AMPHORA))) == 1
    (tmp_path / "empty").mkdir()
    for bad, of in ((tmp_path / "empty", pysherd.FileError), (tmp_path / "absent", pysherd.FileError), ([], pysherd.InputError), (3, pysherd.UsageError),
                    ([cube(), np.zeros(3)], pysherd.InputError)):  # fmt: skip
        with pytest.raises(of):
            library_of(bad)


def test_one_mesh_in_memory_is_one():
    """Whatever voxelize takes: an array is not read slice by slice, and a pair of lists is one mesh."""
    volume, (vertices, faces) = np.ones((3, 12, 12), np.uint8), cube()
    for whole in (volume, OnlyDlpack(volume)):
        (mesh,) = library_of(whole)
        assert mesh.given.shape == (3, 12, 12)
    lists = vertices.tolist(), faces.tolist()
    rows = [tuple(row) for row in vertices], list(faces)
    for pair in ((vertices, faces), [vertices, faces], lists, list(lists), rows, (OnlyDlpack(vertices), faces.tolist())):
        (mesh,) = library_of(pair)
        assert np.array_equal(mesh.given[0], vertices) and np.array_equal(mesh.given[1], faces)
    for several in ([volume, volume], (cube(), cube(2)), [lists, lists], [OnlyDlpack(volume), lists], ["a.ply", "b.ply"], np.array(["abc", "abd"])):
        assert len(library_of(several)) == 2
    for bad, named in ((np.ones((2, 4, 4, 4), bool), "volume: shape"), (vertices, "volume: shape"), ([vertices[:, :2], faces], "vertices: shape"),
                       ((vertices, 3), "faces: "), ((lists[0], []), "faces: ")):  # fmt: skip
        with pytest.raises(pysherd.InputError, match=named):
            library_of(bad)


def test_arrays_are_copied():
    vertices, faces = cube()
    (mesh,) = library_of([(vertices, faces)])
    vertices[:] = 0
    assert mesh.given[0].max() == 1


def test_solids_go_when_they_take_too_much():
    solids = Solids(library_of([cube(1 + i) for i in range(6)]), [("resolution", "16")], 0, "builtin")
    solids[0]
    one = solids.bytes
    assert len(solids) == 1 and one > 10_000
    solids = Solids(library_of([cube(1 + i) for i in range(6)]), [("resolution", "16")], 3 * one + one // 2, "builtin")
    for mesh in (0, 1, 2, 0, 3):
        solids[mesh]
        assert solids.bytes <= 3 * one + one // 2
    kept = solids[0], solids[2], solids[3]
    assert len(solids) == 3 and all(solids[i] is k for i, k in zip((0, 2, 3), kept))  # 1 was used longest ago


def test_points_of_fragments_by_the_loaders_rules():
    """GARF and RPF: `least` and a share of the rest, cut off; Jigsaw: rounded up, then at least 30."""
    areas = np.array([5.0, 3.0, 1.99, 0.01])
    assert LAYOUTS["garf"].counts(areas, 5000) == [20 + 2460 + 1, 20 + 1476, 20 + 979, 20 + 4]  # of 4920, and 1 cut off
    assert sum(LAYOUTS["jigsaw"].counts(areas, 5000)) == 5000 and LAYOUTS["jigsaw"].counts(areas, 5000)[3] == 30
    assert LAYOUTS["mpa"].counts(areas, 1000) == [1000] * 4 and sum(LAYOUTS["points"].counts(areas, 100)) == 100


def test_points_have_the_counts_that_are_asked_for(fracture):
    counts = [7 * i for i in range(len(fracture))]
    positions, normals, neighbor, fragment = pysherd._jobs.finish(_core.points(fracture._core, [("points", "1")], counts))
    assert np.bincount(fragment, minlength=len(fracture) + 1)[1:].tolist() == counts
    all_points = fracture.points(max(counts))
    for i in (2, 5):  # the same points as with that number on all fragments
        own = fracture.points(counts[i])
        assert np.array_equal(positions[fragment == i + 1], own.positions[own.fragment == i + 1])
    assert len(all_points.positions) == max(counts) * len(fracture)


def test_the_box_of_a_solid_is_that_of_its_surface():
    solid = pysherd.voxelize(AMPHORA, resolution=64)
    pysherd._jobs.finish(_core.keep_surface(solid._core))
    low, high = map(np.array, solid._core.surface_box)
    (whole,) = pysherd.fracture(solid, pieces=1, surface="smooth")
    assert np.allclose(whole.vertices.min(axis=0), low, atol=1e-9) and np.allclose(whole.vertices.max(axis=0), high, atol=1e-9)
